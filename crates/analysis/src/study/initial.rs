//! Runs from other initial values.

use super::observation::{ObservationSettings, output};
use crate::assign::assign;
use amontons::Error;
use amontons::scene::{Scene, nearest};
use amontons::simulation::{Simulation, variables};

const PREFIX: &str = "initial.";

/// The full name of an initial value of a scene, which may be given without `initial.`.
///
/// # Errors
/// Returns an error if there is none of that name; it gives the nearest name, or all names.
pub fn initial_value(scene: &Scene, name: &str) -> Result<String, Error> {
    let names: Vec<String> = variables(scene)
        .into_iter()
        .filter(|variable| variable.is_settable())
        .filter_map(|variable| variable.name.strip_prefix(PREFIX).map(str::to_owned))
        .collect();
    let short = name.strip_prefix(PREFIX).unwrap_or(name);
    if names.iter().any(|known| known == short) {
        return Ok(format!("{PREFIX}{short}"));
    }
    if names.is_empty() {
        return Err(Error::argument(format!("{} has no initial values to vary", scene.name)));
    }
    let help = match nearest(short, names.iter().map(String::as_str)) {
        Some(near) => format!("did you mean {PREFIX}{near}?"),
        None => {
            // The value of one module or mass, where that is known, stands for all.
            let group = |name: &str| name.rsplit_once('.').map(|(group, _)| group.to_owned());
            let wanted =
                Some(group(short)).filter(|of| names.iter().any(|name| group(name) == *of));
            let of = wanted.unwrap_or_else(|| group(&names[0]));
            let like: Vec<String> = names
                .iter()
                .filter(|name| group(name) == of)
                .map(|name| format!("{PREFIX}{name}"))
                .collect();
            format!("there are, for example, {}", like.join(", "))
        }
    };
    Err(Error::argument(format!("{} has no initial value {name}; {help}", scene.name)))
}

/// The scene with other initial values; the rest stays as it is.
pub(super) fn starting_from(scene: &Scene, values: &[(&str, f64)]) -> Result<Scene, Error> {
    let mut scene = scene.clone();
    for (name, value) in values {
        assign(&mut scene, name, *value)?;
    }
    scene.check()?;
    Ok(scene)
}

/// The first `duration` (s) of the run from another initial value: the output that is observed, one row for each
/// interval, from time 0 on; in its unit. `None` if the watch ended it.
///
/// # Errors
/// Returns an error if there is no such initial value or output, a value is impossible, or a run fails.
#[allow(clippy::cast_possible_truncation, clippy::cast_precision_loss, clippy::cast_sign_loss)]
pub fn history(
    scene: &Scene,
    (name, value): (&str, f64),
    observation: &ObservationSettings,
    duration: f64,
    is_over: &dyn Fn() -> bool,
) -> Result<Option<Vec<f64>>, Error> {
    let scene = starting_from(scene, &[(&initial_value(scene, name)?, value)])?;
    let output = output(&scene, &observation.of)?;
    let mut simulation = Simulation::new(scene, 0.0)?;
    let mut rows = vec![simulation.read(&output)?];
    for row in 1..=(duration / observation.interval).round() as u64 {
        if row.is_multiple_of(256) && is_over() {
            return Ok(None);
        }
        simulation.advance_to(row as f64 * observation.interval)?;
        rows.push(simulation.read(&output)?);
    }
    Ok(Some(rows))
}

#[cfg(test)]
mod tests {
    use super::*;
    use amontons::scene::builtin;

    #[test]
    fn initial_values_are_known_by_either_name_and_others_by_the_nearest() {
        let scene = builtin("set2").unwrap().scene();
        for name in ["initial.module[1].v2", "module[1].v2"] {
            assert_eq!(initial_value(&scene, name), Ok("initial.module[1].v2".to_owned()));
        }
        for (name, word) in [
            ("modul[1].v2", "did you mean initial.module[1].v2?"),
            ("module[2].v9", "for example, initial.module[2].x1, initial.module[2].x2"),
            ("slider.velocity", "for example, initial.module[1].x1"),
        ] {
            let error = initial_value(&scene, name).unwrap_err();
            assert!(error.is_argument() && error.to_string().contains(word), "{error}");
        }
    }
}
