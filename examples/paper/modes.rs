//! The modes without friction (Fig. 2c), and the effect of a lower k2 on them.

use super::claims::claim;
use super::eigenvalues::ROUNDING;
use super::scene;
use amontons::Error;
use amontons::model::LumpedModel;
use amontons::scene::Scene;
use amontons_analysis::stability::{Linearised, Mode, modes};
use amontons_pictures::report::{Cell, Claim, Table};

/// Frequencies in Fig. 2(c), Hz.
const FREQUENCIES: [f64; 6] = [34.00, 65.99, 163.90, 186.56, 215.24, 225.79];
/// Displacements of two masses are the same or opposite if they differ by no more than this part of the mode's largest
/// displacement: symmetry makes them so up to rounding.
const SAME: f64 = 1e-6;
/// Two shapes are very similar if their modal assurance criterion (the square of the cosine of the angle between them)
/// is not below this value, the customary bound for shapes of one mode.
const SIMILAR: f64 = 0.9;

pub struct Found {
    pub claims: Vec<Claim>,
    pub shapes: Table,
}

/// The claims on Fig. 2(c), and its shapes.
///
/// # Errors
/// Returns an error if a scene is invalid.
pub fn found() -> Result<Found, Error> {
    let (scene, set1) = real_modes("set1")?;
    let (_, set2) = real_modes("set2")?;
    let claims = vec![frequencies(&set1), phases(&set1), alike(&set1, &set2), moved(&set1, &set2)];
    Ok(Found { claims, shapes: shapes(&scene, &set1) })
}

/// The real modes without friction and damping.
fn real_modes(name: &str) -> Result<(Scene, Vec<Mode>), Error> {
    let (scene, _) = scene(name, &[("damping.beta", 0.0)])?;
    let here = Linearised::from(LumpedModel::from(&scene).with_friction(0.0));
    let modes = modes(here.linear()?, &here.uniform_sliding()?)?.all().cloned().collect();
    Ok((scene, modes))
}

fn hz(modes: &[Mode]) -> Vec<f64> {
    modes.iter().map(Mode::frequency_hz).collect()
}

/// The real parts of a mode's shape; its largest displacement is 1, so that no common phase is left.
fn shape(mode: &Mode) -> Vec<f64> {
    mode.shape.iter().map(|part| part.re).collect()
}

fn frequencies(modes: &[Mode]) -> Claim {
    let found = hz(modes);
    let holds = found.len() == FREQUENCIES.len()
        && found.iter().zip(FREQUENCIES).all(|(found, paper)| (found - paper).abs() <= ROUNDING);
    let found: Vec<String> = found.iter().map(|hz| format!("{hz:.2}")).collect();
    claim(
        "Fig. 2(c): without friction the six modes of Set 1 have 34.00, 65.99, 163.90, 186.56, 215.24 and 225.79 Hz.",
        format!("{} Hz (holds if none is off by more than {ROUNDING} Hz)", found.join(", ")),
        holds,
        None,
    )
}

/// `Some(true)` if the upper masses of both modules move in phase, `Some(false)` if they move in opposition, `None` if
/// neither holds.
fn in_phase(mode: &Mode) -> Option<bool> {
    let shape = shape(mode);
    // Degrees of freedom x1 and x2 of each module.
    let worst =
        |sign: f64| (0..2).map(|i| (shape[i] - sign * shape[4 + i]).abs()).fold(0.0, f64::max);
    if worst(1.0) <= SAME { Some(true) } else { (worst(-1.0) <= SAME).then_some(false) }
}

fn phases(modes: &[Mode]) -> Claim {
    let phases: Vec<Option<bool>> = modes.iter().map(in_phase).collect();
    let word = |phase: &Option<bool>| match phase {
        Some(true) => "in phase",
        Some(false) => "out of phase",
        None => "neither",
    };
    let told: Vec<String> = phases
        .iter()
        .zip(1..)
        .map(|(phase, number)| format!("{number}: {}", word(phase)))
        .collect();
    claim(
        "The upper masses of the two modules move in phase in modes 3 and 4, out of phase in modes 5 and 6.",
        format!(
            "{} (holds if displacements are the same, or opposite, to {SAME} of the mode's largest)",
            told.join(", ")
        ),
        phases.len() == 6 && phases[2..4] == [Some(true); 2] && phases[4..] == [Some(false); 2],
        None,
    )
}

/// The square of the cosine of the angle between two shapes.
fn assurance(a: &Mode, b: &Mode) -> f64 {
    let product =
        |a: &Mode, b: &Mode| -> f64 { shape(a).iter().zip(shape(b)).map(|(a, b)| a * b).sum() };
    product(a, b).powi(2) / (product(a, a) * product(b, b))
}

fn alike(set1: &[Mode], set2: &[Mode]) -> Claim {
    let all: Vec<f64> = set1.iter().zip(set2).map(|(a, b)| assurance(a, b)).collect();
    let told: Vec<String> = all.iter().map(|value| format!("{value:.4}")).collect();
    claim(
        "The mode shapes of Set 2 are very similar to those of Set 1.",
        format!(
            "modal assurance criterion of modes 1 to 6: {} (holds if none is below {SIMILAR}, the customary bound for shapes of one mode)",
            told.join(", ")
        ),
        all.len() == 6 && set2.len() == 6 && all.iter().all(|value| *value >= SIMILAR),
        None,
    )
}

fn moved(set1: &[Mode], set2: &[Mode]) -> Claim {
    let change: Vec<f64> = hz(set1).iter().zip(hz(set2)).map(|(a, b)| b - a).collect();
    let told: Vec<String> =
        change.iter().map(|change| format!("{change:+.2}").replace('-', "−")).collect();
    claim(
        "The lower k2 of Set 2 moves modes 5 and 6 and leaves modes 3 and 4.",
        format!(
            "modes 1 to 6 move by {} Hz (holds if 3 and 4 by less than {ROUNDING} Hz, 5 and 6 by more than 1 Hz)",
            told.join(", ")
        ),
        change.len() == 6
            && change[2..4].iter().all(|change| change.abs() < ROUNDING)
            && change[4..].iter().all(|change| change.abs() > 1.0),
        None,
    )
}

/// The table of Fig. 2(c): displacements of each mode, the largest 1.
fn shapes(scene: &Scene, modes: &[Mode]) -> Table {
    let shapes: Vec<Vec<f64>> = modes.iter().map(shape).collect();
    let rows = scene.dof_names().into_iter().enumerate().map(|(dof, name)| -> Vec<Cell> {
        let parts =
            shapes.iter().map(|shape| format!("{:+.3}", shape[dof]).replace('-', "−").into());
        std::iter::once(name.into()).chain(parts).collect()
    });
    let head = modes
        .iter()
        .zip(1..)
        .map(|(mode, number)| format!("mode {number} ({:.2} Hz)", mode.frequency_hz()));
    Table {
        caption: "Fig. 2(c): mode shapes of Set 1 without friction, the largest displacement 1; contacts stay closed"
            .to_owned(),
        head: std::iter::once(String::new()).chain(head).collect(),
        rows: rows.collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn claims_on_modes_fail_for_the_modes_of_another_set() {
        let (set1, set2) = (real_modes("set1").unwrap().1, real_modes("set2").unwrap().1);
        assert!(frequencies(&set1).verdict.holds() && !frequencies(&set2).verdict.holds());
        assert!(!moved(&set1, &set1).verdict.holds());
        let turned: Vec<Mode> = set1.iter().rev().cloned().collect();
        assert!(phases(&set1).verdict.holds() && !phases(&turned).verdict.holds());
        assert!(alike(&set1, &set2).verdict.holds() && !alike(&set1, &turned).verdict.holds());
        assert!(!alike(&set1, &[]).verdict.holds() && !frequencies(&[]).verdict.holds());
    }
}
