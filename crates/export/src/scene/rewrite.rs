//! Another method and step, other initial values, or packed matrices, written into a scene file.

use amontons::Error;
use amontons::scene::{
    Coordinates, Freedom, Method, ModeAt, Network, NodeAt, PACKED, Preset, Scene, Source,
    Structure, Superelement,
};
use serde::Serialize;
use toml_edit::{ArrayOfTables, DocumentMut, Item, Table, TableLike};

/// Writes another method and step (s) into the scene file; all else stays as it is, comments included.
///
/// # Errors
/// Returns an error if the file is not TOML, or has no table `[integrator]`.
pub fn set_integrator(source: &mut Source, method: Method, step: f64) -> Result<(), Error> {
    set_keys(source, [("method", word(method)?), ("step", step.into())])
}

/// Writes a preset in place of method and step into the scene file; all else stays as it is, comments included.
///
/// # Errors
/// Returns an error if the file is not TOML, or has no table `[integrator]`.
pub fn set_preset(source: &mut Source, preset: Preset) -> Result<(), Error> {
    set_keys(source, [("preset", word(preset)?)])
}

/// Writes the scene's initial values into its file in place of all `[[initial]]`; all else stays as it is, comments
/// included. The scene then has variables for the initial values of the nodes and modes that the file names.
///
/// # Errors
/// Returns an error if the file is not TOML.
pub fn set_initial(source: &mut Source, scene: &mut Scene) -> Result<(), Error> {
    let mut document = parsed(source)?;
    let mut tables = ArrayOfTables::new();
    let mut add = |key: &str, of: toml_edit::Value, values: &[(&str, f64)]| {
        let mut table = Table::new();
        table.insert(key, of.into());
        for (key, value) in values.iter().filter(|(_, value)| *value != 0.0) {
            table.insert(key, toml_edit::value(*value));
        }
        if table.len() > 1 {
            tables.push(table);
        }
    };
    match &scene.structure {
        Structure::Ring(modules) => {
            for (module, number) in modules.iter().zip(1..) {
                let [x1, x2, x3, x4] = module.displacement;
                let [v1, v2, v3, v4] = module.velocity;
                let places = [("x1", x1), ("x2", x2), ("x3", x3), ("x4", x4)];
                let speeds = [("v1", v1), ("v2", v2), ("v3", v3), ("v4", v4)];
                add("module", number.into(), &[places, speeds].concat());
            }
        }
        Structure::Network(network) => {
            for mass in &network.masses {
                let ([x, y], [vx, vy]) = (mass.displacement, mass.velocity);
                let values = [("x", x), ("y", y), ("vx", vx), ("vy", vy)];
                add("mass", mass.name.as_str().into(), &values);
            }
            for one in &network.superelements {
                for (key, of, values) in superelement_initial(one) {
                    let values: Vec<(&str, f64)> =
                        values.iter().map(|(key, value)| (&**key, *value)).collect();
                    add(key, of.into(), &values);
                }
            }
        }
    }
    document.insert("initial", tables.into());
    if let Structure::Network(network) = &mut scene.structure {
        network.started = started(network);
    }
    source.text = document.to_string();
    Ok(())
}

/// Keys of `[[superelement]]` that say how its matrices are made of files.
const MATRIX_KEYS: [&str; 11] = [
    "folder",
    "stiffness",
    "mass",
    "freedoms",
    "damping",
    "gyroscopic",
    "circulatory",
    "alpha",
    "beta",
    "damping_ratio",
    "units",
];

/// Names the packed superelements of the source in place of the matrix files from which they were made; all else stays as it is,
/// comments included.
///
/// # Errors
/// Returns an error if the file is not TOML.
pub(super) fn pack(source: &mut Source) -> Result<(), Error> {
    if source.binaries.is_empty() {
        return Ok(());
    }
    let mut document = parsed(source)?;
    match document.get_mut("superelement") {
        Some(Item::ArrayOfTables(tables)) => {
            tables.iter_mut().for_each(|table| name_packed(table));
        }
        Some(Item::Value(toml_edit::Value::Array(tables))) => {
            let tables = tables.iter_mut().filter_map(toml_edit::Value::as_inline_table_mut);
            tables.for_each(|table| name_packed(table));
        }
        _ => {}
    }
    source.text = document.to_string();
    Ok(())
}

/// Names the packed file in the table of one superelement.
fn name_packed(table: &mut dyn TableLike) {
    let name = table.get("name").and_then(Item::as_str).map(str::to_owned);
    if let Some(name) = name.filter(|_| !table.contains_key("file")) {
        for key in MATRIX_KEYS {
            table.remove(key);
        }
        table.insert("file", toml_edit::value(format!("{name}.{PACKED}")));
    }
}

/// The nodes and modes of a network that do not start at rest in the equilibrium, in the order of [`superelement_initial`].
fn started(network: &Network) -> Coordinates {
    let mut started = Coordinates::default();
    for (superelement, one) in network.superelements.iter().enumerate() {
        let rows = one.matrices.freedoms().iter().zip(one.displacement.iter().zip(&one.velocity));
        let rows = rows.map(|(freedom, (place, speed))| (freedom, *place != 0.0 || *speed != 0.0));
        let modes = rows.clone().filter(|(freedom, _)| freedom.direction == 0).enumerate();
        let modes = modes.filter(|(_, (_, moves))| *moves);
        started.modes.extend(modes.map(|(mode, _)| ModeAt { superelement, mode }));
        let mut nodes: Vec<(u64, bool)> = Vec::new();
        for (Freedom { node, .. }, moves) in rows.filter(|(freedom, _)| freedom.direction != 0) {
            match nodes.iter_mut().find(|(known, _)| known == node) {
                Some((_, known)) => *known |= moves,
                None => nodes.push((*node, moves)),
            }
        }
        let nodes = nodes.into_iter().filter(|(_, moves)| *moves);
        started.nodes.extend(nodes.map(|(node, _)| NodeAt { superelement, node }));
    }
    started
}

/// An `[[initial]]`: the key that names what moves, its name, and the values by their keys.
type InitialTable = (&'static str, String, Vec<(String, f64)>);

/// The initial values of a superelement, node by node and mode by mode.
fn superelement_initial(one: &Superelement) -> Vec<InitialTable> {
    let mut all: Vec<InitialTable> = Vec::new();
    let mut modes = 0;
    for (row, freedom) in one.matrices.freedoms().iter().enumerate() {
        let (value, rate) = (one.displacement[row], one.velocity[row]);
        let axes = ["x", "y", "z", "rx", "ry", "rz"];
        match axes.get(usize::from(freedom.direction).wrapping_sub(1)) {
            None => {
                modes += 1;
                let values = vec![("q".to_owned(), value), ("v".to_owned(), rate)];
                all.push(("mode", format!("{}.{modes}", one.name), values));
            }
            Some(axis) => {
                let name = format!("{}.{}", one.name, freedom.node);
                let values = [((*axis).to_owned(), value), (format!("v{axis}"), rate)];
                match all.iter_mut().find(|(key, of, _)| *key == "node" && *of == name) {
                    Some((_, _, known)) => known.extend(values),
                    None => all.push(("node", name, values.to_vec())),
                }
            }
        }
    }
    all
}

/// The scene file as TOML.
fn parsed(source: &Source) -> Result<DocumentMut, Error> {
    source.text.parse().map_err(|error| Error::scene(format!("{error}")))
}

/// Makes these the keys of `[integrator]`.
fn set_keys<const N: usize>(
    source: &mut Source,
    keys: [(&str, toml_edit::Value); N],
) -> Result<(), Error> {
    let mut document = parsed(source)?;
    let table = document
        .get_mut("integrator")
        .and_then(Item::as_table_like_mut)
        .ok_or_else(|| Error::scene("[integrator] is missing"))?;
    for key in ["method", "step", "preset", "tolerance"] {
        if keys.iter().all(|(kept, _)| *kept != key) {
            table.remove(key);
        }
    }
    for (key, mut value) in keys {
        // The text behind the old value is kept behind the new one.
        let old = table.get(key).and_then(Item::as_value);
        if let Some(decor) = old.map(|old| old.decor().clone()) {
            *value.decor_mut() = decor;
        }
        table.insert(key, value.into());
    }
    source.text = document.to_string();
    Ok(())
}

/// A word as a file has it.
fn word(value: impl Serialize) -> Result<toml_edit::Value, Error> {
    value
        .serialize(toml_edit::ser::ValueSerializer::new())
        .map_err(|error| Error::scene(error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use amontons::scene::{Selection, builtin, parse};

    #[test]
    fn another_integrator_is_written_into_the_file_and_nothing_else_is_touched() {
        let set1 = builtin("set1").unwrap();
        let mut source = Source::from(set1.text);
        set_integrator(&mut source, Method::EventDriven, 2e-3).unwrap();
        let scene = parse("set1", &source.text).unwrap();
        let expected = Scene { method: Method::EventDriven, step: 2e-3, ..set1.scene() };
        assert_eq!(scene, expected);
        let lines = |text: &str| -> Vec<String> {
            let kept = |line: &&str| !line.starts_with("step") && !line.starts_with("method");
            text.lines().filter(kept).map(str::to_owned).collect()
        };
        assert_eq!(lines(&source.text), lines(set1.text));
        // Comments of the lines that changed stay as well.
        assert_eq!(source.text.matches('#').count(), set1.text.matches('#').count());

        // However the table is written.
        for text in ["integrator = { step = 1e-6 }", "integrator.step = 1e-6"] {
            let mut source = Source::from(text);
            set_integrator(&mut source, Method::ForwardIncrement, 1e-4).unwrap();
            assert!(source.text.contains("1e-4") || source.text.contains("0.0001"), "{source:?}");
            assert!(source.text.contains("forward-increment"), "{source:?}");
        }
    }

    #[test]
    fn packed_superelements_are_named_in_place_of_the_files_of_matrices() {
        let binaries = vec![("pad.superelement".to_owned(), Vec::new())];
        let mut source = Source {
            text: "# a brake\n[[superelement]]\nname = \"pad\"\nfolder = \"a/b\"\nunits = { mass = 1e3 }\nbeta = 1e-8\n\
                   [[superelement]]\nname = \"disc\"\nfile = \"d.superelement\"\n# end\n[[mass]]\nname = \"m\"\n"
                .into(),
            binaries: binaries.clone(),
            ..Source::default()
        };
        pack(&mut source).unwrap();
        assert_eq!(
            source.text,
            "# a brake\n[[superelement]]\nname = \"pad\"\nfile = \"pad.superelement\"\n\
             [[superelement]]\nname = \"disc\"\nfile = \"d.superelement\"\n# end\n[[mass]]\nname = \"m\"\n"
        );
        let text = "superelement = [{ name = \"pad\", stiffness = \"k\", mass = \"m\" }]\n".into();
        let mut source = Source { text, binaries, ..Source::default() };
        pack(&mut source).unwrap();
        let words: Vec<&str> = source.text.split_whitespace().collect();
        assert_eq!(
            words.join(" "),
            "superelement = [{ name = \"pad\", file = \"pad.superelement\" }]"
        );
    }

    #[test]
    fn a_preset_takes_the_place_of_method_and_step_and_gives_it_back() {
        let set1 = builtin("set1").unwrap();
        let mut source = Source::from(set1.text);
        set_preset(&mut source, Preset::Design).unwrap();
        let chosen = parse("set1", &source.text).unwrap();
        assert_eq!(chosen.selection, Selection::Preset(Preset::Design));
        set_integrator(&mut source, set1.scene().method, set1.scene().step).unwrap();
        assert_eq!(parse("set1", &source.text).unwrap(), set1.scene());

        let mut source = Source::from("integrator = { method = \"auto\", tolerance = 1e-3 }");
        set_preset(&mut source, Preset::Preview).unwrap();
        assert!(source.text.contains("preview") && !source.text.contains("auto"), "{source:?}");
    }
    #[test]
    fn initial_values_take_the_place_of_those_in_the_file_and_read_back_as_the_same_doubles() {
        for name in ["set2", "set1", "corner", "belt"] {
            let builtin = builtin(name).unwrap();
            let mut scene = builtin.scene();
            match &mut scene.structure {
                Structure::Ring(modules) => {
                    modules[0].velocity = [0.1 + 0.2, 0.0, -1e-300, 1.0 / 3.0];
                    modules[1].displacement = [1e-5, -2.0 / 3.0, 0.0, 1e22];
                }
                Structure::Network(network) => {
                    network.masses[0].velocity = [-1.0 / 3.0, 0.0];
                    network.masses[0].displacement = [5e-324, 0.0];
                }
            }
            let mut source = Source::from(builtin.text);
            set_initial(&mut source, &mut scene).unwrap();
            assert_eq!(parse(name, &source.text).unwrap(), scene, "{}", source.text);
            let is_kept = |line: &str| source.text.lines().any(|kept| kept == line);
            let mut others = builtin.text.lines().take_while(|line| !line.contains("[[initial]]"));
            assert_eq!(others.find(|line| !is_kept(line)), None, "{}", source.text);
        }
        // However the file writes them.
        let mut source =
            Source::from("initial = [{ module = 1, v2 = 0.5 }]\n[integrator]\nstep = 1e-6\n");
        set_initial(&mut source, &mut builtin("set2").unwrap().scene()).unwrap();
        assert_eq!(source.text.matches("v2 = 0.3").count(), 1, "{}", source.text);
        assert!(!source.text.contains("0.5"), "{}", source.text);
    }
}
