//! Section 1: parameters, loci, and the eigenvalues of all contact states.

use super::claims::{claim, half_digit, is_about};
use super::{couplings, modes, scene};
use amontons::Error;
use amontons::contact::parse_states;
use amontons::model::LumpedModel;
use amontons::scene::Scene;
use amontons::stability::Spectrum;
use amontons_analysis::stability::StateClasses;
use amontons_analysis::study::Watch;
use amontons_analysis::sweep::range::decimal;
use amontons_pictures::report::{Cell, Claim, Content, Figure, Line, Section, Table};
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// Tolerance for values that the paper rounds to two digits; 7 of 192 values are rounded the other way.
pub const ROUNDING: f64 = 0.006;
/// Friction coefficient of Tables 2 and 3.
pub const FRICTION: f64 = 1.96;

/// A table of the paper: states, and (growth rate, frequency), both divided by 2π, Hz.
#[derive(serde::Deserialize)]
struct Printed {
    states: BTreeMap<String, Vec<[f64; 2]>>,
}

const PRINTED: [(&str, &str, &str); 2] = [
    ("set1", "Table 2", include_str!("../../tests/data/table2.json")),
    ("set2", "Table 3", include_str!("../../tests/data/table3.json")),
];

pub fn section(watch: Watch<'_>) -> Result<Option<Section>, Error> {
    let mut section = Section {
        text: vec![
            "Eigenvalues λ of the linear motion within one contact state: Re λ is the growth rate, Im λ/2π the frequency. \
             The paper prints Re λ/2π in Hz in place of the growth rate in 1/s, which is 2π times as large."
                .to_owned(),
        ],
        ..Section::default()
    };
    let modes = modes::found()?;
    section.claims.extend(modes.claims);
    section.tables.push(modes.shapes);
    let mut loci = Vec::new();
    for name in ["set1", "set2"] {
        loci.push(couplings::uniform(&scene(name, &[])?.0)?);
        (watch.progress)(0.4 * loci.len() as f64);
    }
    section.claims.extend(couplings::claims(&loci[0], &loci[1]));
    for ((name, letter), locus) in [("set1", 'a'), ("set2", 'b')].into_iter().zip(&loci) {
        section.figures.push(Figure {
            caption: format!("Fig. 2({letter}): eigenvalues of {name} in uniform sliding over µ"),
            command: Some(format!("amontons-stability locus {name} --friction 0:3.5:0.005")),
            content: Content::Chart(couplings::chart(name, locus)),
        });
    }
    for (name, table, printed) in PRINTED {
        let printed: Printed = serde_json::from_str(printed).expect("the file is a table");
        let (claim, found) = compared(name, table, &printed)?;
        section.claims.push(claim);
        section.tables.push(found);
    }
    section.claims.push(second_stiffness()?);
    section.claims.extend(one_stuck(&[eigenvalues_of("set1")?, eigenvalues_of("set2")?]));
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

/// The eigenvalues (Re, Im)/2π, Hz, on which the claims about contact states depend.
struct Eigenvalues {
    sliding: Vec<[f64; 2]>,
    stuck: [Vec<[f64; 2]>; 2],
}

fn eigenvalues_of(name: &str) -> Result<Eigenvalues, Error> {
    let model = LumpedModel::from(&scene(name, &[])?.0);
    let of = |state| eigenvalues(&model, state);
    Ok(Eigenvalues { sliding: of("Sl-Sl")?, stuck: [of("Sl-St")?, of("St-Sl")?] })
}

/// The claims on states with one contact stuck, and on sliding beside them.
fn one_stuck([set1, set2]: &[Eigenvalues; 2]) -> Vec<Claim> {
    let growing = |values: &[[f64; 2]]| -> Vec<[f64; 2]> {
        values.iter().filter(|value| value[0] > 0.0).copied().collect()
    };
    let told = |values: &[[f64; 2]]| {
        let all: Vec<String> = values
            .iter()
            .map(|[re, im]| format!("{im:.2} Hz with a growth rate of {:+.2} 1/s", TAU * re))
            .collect();
        if all.is_empty() { "none".to_owned() } else { all.join(", ") }
    };
    let are_about = |values: &[[f64; 2]], printed: &[&str]| {
        values.len() == printed.len()
            && values.iter().zip(printed).all(|(value, printed)| is_about(value[1], printed))
    };
    let sliding = growing(&set1.sliding);
    let stuck = set1.stuck.each_ref().map(|values| growing(values));
    let lower: Vec<[f64; 2]> =
        set1.sliding.iter().filter(|value| is_about(value[1], "170")).copied().collect();
    let other = set2.stuck.each_ref().map(|values| growing(values));
    vec![
        claim(
            "At µ = 1.96 uniform sliding of Set 1 has one instability, at about 219 Hz.",
            format!(
                "modes that grow: {} (holds if it is one, within {} Hz)",
                told(&sliding),
                half_digit("219")
            ),
            are_about(&sliding, &["219"]),
            None,
        ),
        claim(
            "With one contact stuck Set 1 has two unstable modes, at about 168 and 217 Hz.",
            format!(
                "modes that grow: {} in Sl-St; {} in St-Sl (holds if they are two, each within {} Hz)",
                told(&stuck[0]),
                told(&stuck[1]),
                half_digit("168")
            ),
            stuck.iter().all(|values| are_about(values, &["168", "217"])),
            None,
        ),
        claim(
            "The mode of Set 1 at about 170 Hz is stable in uniform sliding.",
            format!(
                "modes within {} Hz: {} (holds if there are some and none grows)",
                half_digit("170"),
                told(&lower)
            ),
            !lower.is_empty() && lower.iter().all(|value| value[0] < 0.0),
            None,
        ),
        claim(
            "Set 2 at µ = 1.96 becomes unstable if one of the two masses sticks.",
            format!("modes that grow: {} in Sl-St; {} in St-Sl", told(&other[0]), told(&other[1])),
            other.iter().all(|values| !values.is_empty())
                && set2.sliding.iter().all(|value| value[0] < 0.0),
            None,
        ),
    ]
}

/// The eigenvalues of a state, (Re, Im)/2π, Hz.
fn eigenvalues(model: &LumpedModel, state: &str) -> Result<Vec<[f64; 2]>, Error> {
    let spectrum = Spectrum::of(model.linear()?, &parse_states(state, model.contacts.len())?)?;
    Ok(spectrum.oscillating.iter().map(|value| [value.re / TAU, value.im / TAU]).collect())
}

/// Largest distance of the printed values of a state from the eigenvalues, Hz; infinite if their numbers differ.
fn worst(found: &[[f64; 2]], printed: &[[f64; 2]]) -> f64 {
    let mut left = found.to_vec();
    let mut worst: f64 = if left.len() == printed.len() { 0.0 } else { f64::INFINITY };
    for value in printed {
        let distance =
            |other: &[f64; 2]| (other[0] - value[0]).abs().max((other[1] - value[1]).abs());
        let near =
            (0..left.len()).min_by(|&a, &b| distance(&left[a]).total_cmp(&distance(&left[b])));
        // Each eigenvalue is matched with one printed value.
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

/// A claim and a table that compare all states with the printed ones.
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
            text: format!("{:+.2} ({re:+.2}), {im:.2}", TAU * re).replace('-', "−"),
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
    let value = "growth rate [1/s] (Re λ/2π [Hz], as printed), frequency [Hz]";
    let head = ["state", "states alike", value, "worst difference [Hz]"].map(str::to_owned);
    let caption = format!(
        "{table}, computed: eigenvalues of {name} at µ = 1.96; those that grow are highlighted. Exchanging the \
         modules makes states alike."
    );
    Ok((claim, Table { caption, head: head.to_vec(), rows }))
}

/// One contact state of each symmetry class, with the number of states in the class.
fn classes(model: &LumpedModel) -> Result<Vec<(String, usize)>, Error> {
    let classes = StateClasses::of(model)?;
    let named = |(class, states): (usize, &Vec<_>)| {
        (amontons::contact::JoinedStates(states).to_string(), classes.members(class).count())
    };
    Ok(classes.representatives.iter().enumerate().map(named).collect())
}

/// The claim on k2 of Set 2.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn claims_on_stuck_contacts_fail_where_a_mode_is_missing_moved_or_one_too_many() {
        let real = || [eigenvalues_of("set1").unwrap(), eigenvalues_of("set2").unwrap()];
        let held = |sets: &[Eigenvalues; 2]| -> Vec<bool> {
            one_stuck(sets).iter().map(|claim| claim.verdict.holds()).collect()
        };
        assert_eq!(held(&real()), [true; 4]);
        let [set1, set2] = real();
        // Its lower pair is stable in sliding in either set.
        assert_eq!(held(&[set2, set1]), [false, false, true, false]);
        // The mode at 217 Hz in one of the two states is moved to just beyond half a hertz.
        let mut moved = real();
        moved[0].stuck[1]
            .iter_mut()
            .filter(|value| value[0] > 0.0 && value[1] > 200.0)
            .for_each(|value| value[1] += 0.1);
        assert_eq!(held(&moved), [true, false, true, true]);
        let mut grows = real();
        grows[0]
            .sliding
            .iter_mut()
            .filter(|value| (value[1] - 172.4).abs() < 0.1)
            .for_each(|value| value[0] = 0.1);
        assert_eq!(held(&grows)[..3], [false, true, false]);
    }

    #[test]
    fn a_table_with_one_wrong_digit_does_not_hold() {
        for (name, table, text) in PRINTED {
            let mut printed: Printed = serde_json::from_str(text).unwrap();
            assert!(compared(name, table, &printed).unwrap().0.verdict.holds());
            printed.states.get_mut("Sl-St").unwrap()[3][0] += 0.02;
            assert!(!compared(name, table, &printed).unwrap().0.verdict.holds(), "{table}");
        }
    }
}
