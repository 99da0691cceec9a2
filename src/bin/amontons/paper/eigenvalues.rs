//! Section 1: parameters, loci, and the eigenvalues of all contact states.

use super::claims::{claim, is_about};
use super::scene;
use amontons::Error;
use amontons::contact::parse_states;
use amontons::model::LumpedModel;
use amontons::picture::{Chart, Mark, Panel, Series};
use amontons::report::{Cell, Claim, Content, Figure, Line, Section, Table};
use amontons::scene::Scene;
use amontons::stability::candidates::uniform_sliding;
use amontons::stability::locus::{Locus, Root, locus};
use amontons::stability::{Mode, Spectrum, StateClasses, modes};
use amontons::study::Watch;
use amontons::sweep::range::decimal;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// What the paper prints, rounded to two digits; of 192 values seven are rounded the other way.
const ROUNDING: f64 = 0.006;
/// µ of Tables 2 and 3.
const FRICTION: f64 = 1.96;
/// Fig. 2(c), Hz.
const FREQUENCIES: [f64; 6] = [34.00, 65.99, 163.90, 186.56, 215.24, 225.79];

/// A table as the paper prints it: states, and (growth rate, frequency), both divided by 2π, Hz.
#[derive(serde::Deserialize)]
struct Printed {
    states: BTreeMap<String, Vec<[f64; 2]>>,
}

const PRINTED: [(&str, &str, &str); 2] = [
    ("set1", "Table 2", include_str!("../../../../tests/data/table2.json")),
    ("set2", "Table 3", include_str!("../../../../tests/data/table3.json")),
];

pub fn section(watch: Watch<'_>) -> Result<Option<Section>, Error> {
    let mut section = Section {
        text: vec![
            "Eigenvalues λ of the linear motion within one contact state; Re λ above zero means growth. The paper \
             prints Re λ/2π and Im λ/2π, both in Hz."
                .to_owned(),
        ],
        ..Section::default()
    };
    section.claims.push(frequencies()?);
    let (shapes, phases) = mode_shapes()?;
    section.claims.push(phases);
    section.tables.push(shapes);
    let mut loci = Vec::new();
    for name in ["set1", "set2"] {
        loci.push(uniform(&scene(name, &[])?.0)?);
        (watch.progress)(0.4 * loci.len() as f64);
    }
    section.claims.extend(couplings(&loci[0], &loci[1]));
    for ((name, letter), locus) in [("set1", 'a'), ("set2", 'b')].into_iter().zip(&loci) {
        section.figures.push(Figure {
            caption: format!("Fig. 2({letter}): eigenvalues of {name} in uniform sliding over µ"),
            command: Some(format!("amontons-stability locus {name} --friction 0:3.5:0.005")),
            content: Content::Chart(chart(name, locus)),
        });
    }
    for (name, table, printed) in PRINTED {
        let printed: Printed = serde_json::from_str(printed).expect("the file is a table");
        let (claim, found) = compared(name, table, &printed)?;
        section.claims.push(claim);
        section.tables.push(found);
    }
    section.claims.push(second_stiffness()?);
    section.claims.push(moved_modes()?);
    section.claims.push(stuck()?);
    section.tables.insert(0, parameters()?);
    Ok(Some(section))
}

/// Table 1, from the scenes.
fn parameters() -> Result<Table, Error> {
    let scenes = [scene("set1", &[])?.0, scene("set2", &[])?.0];
    let row = |name: &str, value: &dyn Fn(&Scene) -> String| -> Vec<Cell> {
        let values = scenes.iter().map(|scene| value(scene).into());
        std::iter::once(name.into()).chain(values).collect()
    };
    let module = |scene: &Scene| scene.modules()[0];
    let mut rows = vec![row("m1, m2 [kg]", &|scene| {
        format!("{}, {}", module(scene).mass[0], module(scene).mass[1])
    })];
    for i in 0..6 {
        rows.push(row(&format!("k{} [kN/m]", i + 1), &|scene| {
            decimal(1e-3 * module(scene).stiffness[i]).to_string()
        }));
    }
    rows.push(row("θ [rad]", &|scene| scene.slider.angle.to_string()));
    rows.push(row("δ [m]", &|scene| module(scene).preload.to_string()));
    rows.push(row("v [m/s]", &|scene| scene.slider.velocity.to_string()));
    rows.push(row("β [s]", &|scene| scene.damping.beta.to_string()));
    let head = ["", "set1", "set2"].map(str::to_owned).to_vec();
    Ok(Table {
        caption: "Table 1: parameters as the built-in scenes have them".to_owned(),
        head,
        rows,
    })
}

/// Fig. 2(c).
fn frequencies() -> Result<Claim, Error> {
    let (scene, _) = scene("set1", &[("damping.beta", 0.0)])?;
    let model = LumpedModel::from(&scene);
    let spectrum = Spectrum::of(&model, &uniform_sliding(&model, scene.slider.velocity)?, 0.0)?;
    let found: Vec<f64> = spectrum.oscillating.iter().map(|value| value.im / TAU).collect();
    let pairs = found.iter().zip(FREQUENCIES);
    let holds = found.len() == FREQUENCIES.len()
        && pairs.clone().all(|(found, paper)| (found - paper).abs() <= ROUNDING);
    let found: Vec<String> = found.iter().map(|hz| format!("{hz:.2}")).collect();
    Ok(claim(
        "Fig. 2(c): without friction the six modes of Set 1 have 34.00, 65.99, 163.90, 186.56, 215.24 and 225.79 Hz.",
        format!("{} Hz (holds if none is off by more than {ROUNDING} Hz)", found.join(", ")),
        holds,
        None,
    ))
}

/// The real modes without friction and damping.
fn real_modes(name: &str) -> Result<(Scene, Vec<Mode>), Error> {
    let (scene, _) = scene(name, &[("damping.beta", 0.0)])?;
    let model = LumpedModel::from(&scene);
    let states = uniform_sliding(&model, scene.slider.velocity)?;
    let modes = modes(&model, &states, 0.0)?.all().cloned().collect();
    Ok((scene, modes))
}

/// Fig. 2(c): displacements of each mode, the largest 1.
fn mode_shapes() -> Result<(Table, Claim), Error> {
    let (scene, modes) = real_modes("set1")?;
    // The largest is 1, so that nothing is left of a common phase.
    let shape = |mode: &Mode| -> Vec<f64> { mode.shape.iter().map(|part| part.re).collect() };
    let shapes: Vec<Vec<f64>> = modes.iter().map(shape).collect();
    let rows = scene.dof_names().into_iter().enumerate().map(|(dof, name)| {
        let parts =
            shapes.iter().map(|shape| format!("{:+.3}", shape[dof]).replace('-', "−").into());
        std::iter::once(name.into()).chain(parts).collect()
    });
    let head = modes
        .iter()
        .enumerate()
        .map(|(mode, found)| format!("mode {} ({:.2} Hz)", mode + 1, found.frequency_hz()));
    let table = Table {
        caption: "Fig. 2(c): mode shapes of Set 1 without friction, the largest displacement 1; contacts stay closed"
            .to_owned(),
        head: std::iter::once(String::new()).chain(head).collect(),
        rows: rows.collect(),
    };
    // Of the upper masses: x1 and x2 of each module.
    let in_phase = |shape: &Vec<f64>| shape[0] * shape[4] + shape[1] * shape[5] > 0.0;
    let phases: Vec<bool> = shapes.iter().map(in_phase).collect();
    let told: Vec<String> = phases
        .iter()
        .enumerate()
        .map(|(mode, is_in)| {
            format!("{}: {}", mode + 1, if *is_in { "in phase" } else { "out of phase" })
        })
        .collect();
    let claim = claim(
        "The upper masses of the two modules move in phase in modes 3 and 4, out of phase in modes 5 and 6.",
        told.join(", "),
        phases.len() == 6 && phases[2] && phases[3] && !phases[4] && !phases[5],
        None,
    );
    Ok((table, claim))
}

/// What the lower k2 does.
fn moved_modes() -> Result<Claim, Error> {
    let hz = |modes: &[Mode]| modes.iter().map(Mode::frequency_hz).collect::<Vec<f64>>();
    let (set1, set2) = (hz(&real_modes("set1")?.1), hz(&real_modes("set2")?.1));
    let change: Vec<f64> = set1.iter().zip(&set2).map(|(a, b)| b - a).collect();
    let told: Vec<String> =
        change.iter().map(|change| format!("{change:+.2}").replace('-', "−")).collect();
    Ok(claim(
        "The lower k2 of Set 2 moves modes 5 and 6 and leaves modes 3 and 4.",
        format!(
            "modes 1 to 6 move by {} Hz (holds if 3 and 4 by less than {ROUNDING} Hz, 5 and 6 by more than 1 Hz)",
            told.join(", ")
        ),
        change.len() == 6
            && change[2..4].iter().all(|change| change.abs() < ROUNDING)
            && change[4..].iter().all(|change| change.abs() > 1.0),
        None,
    ))
}

/// Set 2 with one contact stuck.
fn stuck() -> Result<Claim, Error> {
    let model = LumpedModel::from(&scene("set2", &[])?.0);
    let growing: Vec<String> = eigenvalues(&model, "Sl-St")?
        .iter()
        .filter(|value| value[0] > 0.0)
        .map(|value| format!("{:+.2} ± {:.2} i Hz", value[0], value[1]))
        .collect();
    Ok(claim(
        "Set 2 at µ = 1.96 becomes unstable if one of the two masses sticks.",
        format!("eigenvalues of Sl-St that grow: {}", growing.join(", ")),
        !growing.is_empty(),
        None,
    ))
}

fn uniform(scene: &Scene) -> Result<Locus, Error> {
    let model = LumpedModel::from(scene);
    let states = uniform_sliding(&model, scene.slider.velocity)?;
    let values: Vec<f64> = (0..=700).map(|i| 0.005 * f64::from(i)).collect();
    locus(&|mu| Ok((Cow::Borrowed(&model), mu)), &states, &values, &|_, _| {})
}

/// Where two modes (from 1) merge: µ and Hz.
fn merging(locus: &Locus, modes: [usize; 2]) -> Option<[f64; 2]> {
    let is_it = |event: &&amontons::stability::locus::Coalescence| {
        event.merge && event.modes.map(|mode| mode + 1) == modes
    };
    locus.coalescences.iter().find(is_it).map(|event| [event.value, event.frequency_hz])
}

/// Does a mode grow at this µ?
fn grows(locus: &Locus, friction: f64) -> Vec<usize> {
    let place = locus.values.partition_point(|value| *value < friction - 1e-9);
    let modes = 0..locus.branches.len();
    modes.filter(|mode| locus.branches[*mode][place].lambda.re > 0.0).map(|mode| mode + 1).collect()
}

/// Numbers of modes in words.
fn listed(modes: &[usize]) -> String {
    let modes: Vec<String> = modes.iter().map(ToString::to_string).collect();
    if modes.is_empty() { "none".to_owned() } else { modes.join(", ") }
}

fn couplings(set1: &Locus, set2: &Locus) -> Vec<Claim> {
    let pairs = [[3, 4], [5, 6]].map(|modes| [merging(set1, modes), merging(set2, modes)]);
    let told = |merge: &Option<[f64; 2]>| {
        merge.map_or("nowhere".to_owned(), |[mu, hz]| format!("µ = {mu:.4} ({hz:.1} Hz)"))
    };
    let [[low1, low2], [high1, high2]] = &pairs;
    let both = |a: &Option<[f64; 2]>, b: &Option<[f64; 2]>, hz: f64| {
        a.iter().chain(b).filter(|merge| is_about(merge[1], hz)).count() == 2
    };
    let mu = |merge: &Option<[f64; 2]>| merge.map_or(f64::NAN, |merge| merge[0]);
    vec![
        claim(
            "In both sets modes 3 and 4 merge, and modes 5 and 6, at about 170 and 215 Hz.",
            format!(
                "Set 1: modes 3 and 4 at {}, 5 and 6 at {}; Set 2: at {} and {}",
                told(low1),
                told(high1),
                told(low2),
                told(high2)
            ),
            both(low1, low2, 170.0) && both(high1, high2, 215.0),
            None,
        ),
        claim(
            "In Set 1 modes 5 and 6 merge at a lower µ than modes 3 and 4, in Set 2 at a higher one.",
            format!(
                "Set 1: {:.4} against {:.4}; Set 2: {:.4} against {:.4}",
                mu(high1),
                mu(low1),
                mu(high2),
                mu(low2)
            ),
            mu(high1) < mu(low1) && mu(high2) > mu(low2),
            None,
        ),
        claim(
            "At µ = 1.5 uniform sliding of Set 1 is unstable, by mode 6.",
            format!("modes that grow: {}", listed(&grows(set1, 1.5))),
            grows(set1, 1.5) == [6],
            None,
        ),
        claim(
            "At µ = 1.96 uniform sliding of Set 1 is unstable, that of Set 2 is stable.",
            format!(
                "modes that grow: {} in Set 1, {} in Set 2",
                listed(&grows(set1, FRICTION)),
                listed(&grows(set2, FRICTION))
            ),
            !grows(set1, FRICTION).is_empty() && grows(set2, FRICTION).is_empty(),
            None,
        ),
    ]
}

fn chart(name: &str, locus: &Locus) -> Chart {
    let curves = |part: fn(&Root) -> f64| {
        let curve = |(mode, branch): (usize, &Vec<Root>)| Series {
            label: Some(format!("mode {}", mode + 1)),
            points: locus.values.iter().zip(branch).map(|(&mu, root)| [mu, part(root)]).collect(),
            colour: mode,
            ..Series::default()
        };
        locus.branches.iter().enumerate().map(curve).collect()
    };
    let mark = |x: f64| Mark { x, label: Some(format!("{x:.4}")) };
    let panel = |y_label: &str, series, marks, zero_line| Panel {
        y_label: y_label.to_owned(),
        series,
        marks,
        zero_line,
        ..Panel::default()
    };
    let crossings = locus.crossings.iter().map(|crossing| mark(crossing.value)).collect();
    let merging = locus.coalescences.iter().map(|merging| mark(merging.value)).collect();
    Chart {
        title: format!("{name}: eigenvalues in uniform sliding"),
        x_label: "Friction coefficient µ [–]".to_owned(),
        panels: vec![
            panel("Re λ / 2π [Hz]", curves(|root| root.lambda.re / TAU), crossings, true),
            panel("Im λ / 2π [Hz]", curves(|root| root.lambda.im / TAU), merging, false),
        ],
        logarithmic: false,
    }
}

/// The eigenvalues of a state, (Re, Im)/2π, Hz.
fn eigenvalues(model: &LumpedModel, state: &str) -> Result<Vec<[f64; 2]>, Error> {
    let spectrum = Spectrum::of(model, &parse_states(state, model.contacts.len())?, FRICTION)?;
    Ok(spectrum.oscillating.iter().map(|value| [value.re / TAU, value.im / TAU]).collect())
}

/// How far the worst of the printed values of a state is from the eigenvalues, Hz; infinite if their number differs.
fn worst(found: &[[f64; 2]], printed: &[[f64; 2]]) -> f64 {
    let mut left = found.to_vec();
    let mut worst: f64 = if left.len() == printed.len() { 0.0 } else { f64::INFINITY };
    for value in printed {
        let distance =
            |other: &[f64; 2]| (other[0] - value[0]).abs().max((other[1] - value[1]).abs());
        let near =
            (0..left.len()).min_by(|&a, &b| distance(&left[a]).total_cmp(&distance(&left[b])));
        // Each eigenvalue stands for one printed value.
        worst = worst.max(near.map_or(f64::INFINITY, |near| distance(&left.swap_remove(near))));
    }
    worst
}

fn worst_of_table(model: &LumpedModel, printed: &Printed) -> Result<f64, Error> {
    let mut most: f64 = 0.0;
    for (state, values) in &printed.states {
        most = most.max(worst(&eigenvalues(model, state)?, values));
    }
    Ok(most)
}

/// A table of all states beside the printed one.
fn compared(name: &str, table: &str, printed: &Printed) -> Result<(Claim, Table), Error> {
    let model = LumpedModel::from(&scene(name, &[])?.0);
    let count: usize = printed.states.values().map(Vec::len).sum();
    let most = worst_of_table(&model, printed)?;
    let mut rows = Vec::new();
    for (states, alike) in classes(&model)? {
        let found = eigenvalues(&model, &states)?;
        let known = printed.states.get(&states);
        let difference =
            known.map_or("–".to_owned(), |known| format!("{:.4}", worst(&found, known)));
        let line = |[re, im]: &[f64; 2]| Line {
            text: format!("{re:+.2} ± {im:.2} i").replace('-', "−"),
            emphasised: *re > 0.0,
        };
        let lines = found.iter().map(line).collect();
        rows.push(vec![states.into(), alike.to_string().into(), Cell { lines }, difference.into()]);
    }
    let claim = claim(
        &format!("{table}: the {count} eigenvalues of all contact states at µ = 1.96."),
        format!("the worst of {count} is off by {most:.4} Hz (holds up to {ROUNDING} Hz)"),
        most <= ROUNDING,
        None,
    );
    let head = ["state", "states alike", "λ/2π [Hz]", "worst difference [Hz]"].map(str::to_owned);
    let caption = format!(
        "{table}, computed: eigenvalues of {name} at µ = 1.96; those that grow stand out. Exchanging the modules \
         makes states alike."
    );
    Ok((claim, Table { caption, head: head.to_vec(), rows }))
}

/// The contact states that differ, and how many are alike.
fn classes(model: &LumpedModel) -> Result<Vec<(String, usize)>, Error> {
    let classes = StateClasses::of(model)?;
    let named = |(class, states): (usize, &Vec<_>)| {
        (amontons::contact::Joined(states).to_string(), classes.size(class))
    };
    Ok(classes.representatives.iter().enumerate().map(named).collect())
}

/// Set 2's k2.
fn second_stiffness() -> Result<Claim, Error> {
    let printed: Printed = serde_json::from_str(PRINTED[1].2).expect("the file is a table");
    let with = |k2: f64| {
        let values = [("module[1].k2", k2), ("module[2].k2", k2)];
        worst_of_table(&LumpedModel::from(&scene("set2", &values)?.0), &printed)
    };
    let (as_printed, as_used) = (with(53e3)?, with(53.617e3)?);
    Ok(claim(
        "Set 2 is Set 1 with k2 = 53 kN/m.",
        format!(
            "with 53 kN/m the worst value of Table 3 is off by {as_printed:.2} Hz, with 53.617 kN/m by {as_used:.4} Hz"
        ),
        as_printed <= ROUNDING,
        Some(
            "the paper's own Table 3 belongs to 53.617 kN/m, so that is what set2 has; 53 is probably rounded",
        ),
    ))
}
