//! Another method and step, written into a scene file.

use amontons::Error;
use amontons::scene::{Method, Preset, Source};
use serde::Serialize;

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

/// Makes these the keys of `[integrator]`.
fn set_keys<const N: usize>(
    source: &mut Source,
    keys: [(&str, toml_edit::Value); N],
) -> Result<(), Error> {
    let mut document: toml_edit::DocumentMut =
        source.text.parse().map_err(|error| Error::scene(format!("{error}")))?;
    let table = document
        .get_mut("integrator")
        .and_then(toml_edit::Item::as_table_like_mut)
        .ok_or_else(|| Error::scene("[integrator] is missing"))?;
    for key in ["method", "step", "preset", "tolerance"] {
        if keys.iter().all(|(kept, _)| *kept != key) {
            table.remove(key);
        }
    }
    for (key, mut value) in keys {
        // The text behind the old value is kept behind the new one.
        let old = table.get(key).and_then(toml_edit::Item::as_value);
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
    use amontons::scene::{Scene, Selection, builtin, parse};

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
}
