//! The largest growth rates of a scene with given values of its parameters, for programs that draw these values by
//! themselves.

use super::draws::{Verdict, unanalysed, verdict};
use super::uncertain::{listed, matching, settable, written};
use crate::stability::parallel::collect;
use crate::watch::Watch;
use amontons::Error;
use amontons::scene::Scene;
use amontons::simulation::Variable;

/// Rows that are one piece of work.
const ROWS: usize = 64;

/// The largest growth rate (1/s) of a contact state, or of uniform sliding, for each row of values; NaN where there is no
/// equilibrium in sliding. `values` has the rows one behind the other, each with a value for every name. The scene has no
/// signals.
///
/// # Errors
/// Returns an error if the scene lacks a parameter, if one is named twice, if values are impossible or cannot be analysed, or
/// if the watch ended the work.
pub fn growth_rates(
    scene: &Scene,
    names: &[String],
    values: &[f64],
    state: Option<&str>,
    watch: Watch<'_>,
) -> Result<Vec<f64>, Error> {
    let variables = named(scene, names)?;
    if !values.len().is_multiple_of(names.len()) {
        return Err(Error::argument(format!(
            "{} values are no rows of {} parameters: give each row a value for every name",
            values.len(),
            names.len()
        )));
    }
    let rows: Vec<&[f64]> = values.chunks_exact(names.len()).collect();
    let row = |number: usize| {
        watch.check()?;
        let values = rows[number];
        let what = format!("row {}", number + 1);
        let told = || listed(names.iter().map(String::as_str).zip(values.iter().copied()));
        let scene = written(scene, variables.iter().zip(values.iter().copied()));
        let scene = scene.map_err(|error| {
            Error::scene(format!("{what} is impossible: {error}; {what} has {}", told()))
        })?;
        let found = verdict(&scene, state).map_err(|error| unanalysed(&error, &what, &told()))?;
        let Verdict { growth, .. } = found;
        Ok(growth.unwrap_or(f64::NAN))
    };
    let work = |piece: usize| -> Result<Vec<f64>, Error> {
        (piece * ROWS..rows.len().min((piece + 1) * ROWS)).map(row).collect()
    };
    let pieces = rows.len().div_ceil(ROWS);
    Ok(collect(pieces, &work, &watch.parts(pieces))?.concat())
}

/// Refuses names of which growth rates cannot be computed.
///
/// # Errors
/// Returns an error as [`growth_rates`] does for names.
pub fn check_names(scene: &Scene, names: &[String]) -> Result<(), Error> {
    named(scene, names).map(|_| ())
}

/// The variables of these names, each of which is named once.
fn named(scene: &Scene, names: &[String]) -> Result<Vec<Variable>, Error> {
    if names.is_empty() {
        return Err(Error::argument(
            "growth rates need the name of a parameter, such as friction.coefficient",
        ));
    }
    let known = settable(scene);
    let one = |(place, name): (usize, &String)| {
        if names[..place].contains(name) {
            return Err(Error::argument(format!("{name} is named twice; name it once")));
        }
        match &matching(scene, &known, name, "have rows of values")?[..] {
            [variable] if variable.name == *name => Ok((*variable).clone()),
            _ => Err(Error::argument(format!(
                "{name} stands for several parameters; name each of them, with a column of its own"
            ))),
        }
    };
    names.iter().enumerate().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assign::assign;
    use crate::stability::Linearised;
    use amontons::scene::builtin;
    use amontons::stability::Spectrum;

    fn rates(scene: &Scene, names: &[&str], values: &[f64]) -> Result<Vec<f64>, Error> {
        let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
        growth_rates(scene, &names, values, None, Watch::IDLE)
    }

    #[test]
    fn each_row_has_the_largest_growth_rate_of_its_own_scene_and_a_jam_has_none() {
        let scene = builtin("set1").unwrap().scene();
        let rows: Vec<[f64; 2]> =
            (0..100).map(|i| [1.0 + 0.01 * f64::from(i), 2e5 + 1e3 * f64::from(i)]).collect();
        let found = rates(&scene, &["friction.coefficient", "module[2].k6"], rows.as_flattened());
        for ([friction, k6], found) in rows.into_iter().zip(found.unwrap()) {
            let mut scene = scene.clone();
            scene.friction_coefficient = friction;
            assign(&mut scene, "module[2].k6", k6).unwrap();
            let here = Linearised::of(&scene);
            let states = here.uniform_sliding().unwrap();
            let spectrum = Spectrum::of(here.linear().unwrap(), &states).unwrap();
            assert_eq!(found, spectrum.growth_rate());
        }
        // Tilted backwards, the slider jams from some friction on.
        let mut tilted = scene;
        tilted.slider.angle = -0.5;
        let found = rates(&tilted, &["friction.coefficient"], &[0.3, 3.9]).unwrap();
        assert!(found[0].is_finite() && found[1].is_nan(), "{found:?}");
    }

    #[test]
    fn rows_that_cannot_be_are_told_with_their_number_and_values() {
        let scene = builtin("set1").unwrap().scene();
        let refused = |names: &[&str], values: &[f64], words: &[&str]| {
            let error = rates(&scene, names, values).unwrap_err().to_string();
            assert!(words.iter().all(|word| error.contains(word)), "{error}");
        };
        let mu = "friction.coefficient";
        refused(
            &[mu],
            &[1.0, -0.5],
            &["row 2 is impossible", "row 2 has friction.coefficient = -0.5"],
        );
        refused(&[mu], &[f64::NAN], &["row 1 is impossible"]);
        refused(
            &["slider.velocity"],
            &[0.0],
            &["row 1 cannot be analysed: no surface moves", "row 1 has slider.velocity = 0.0"],
        );
        refused(&[mu, "module[1].k6"], &[1.0], &["1 values are no rows of 2 parameters"]);
        refused(&[], &[], &["need the name of a parameter"]);
        refused(&[mu, mu], &[1.0, 1.0], &["named twice"]);
        refused(&["module[*].k6"], &[1.0], &["stands for several parameters"]);
        refused(&["friction.cofficient"], &[1.0], &["did you mean friction.coefficient?"]);
        let initial = "initial.module[1].v1 cannot have rows of values: eigenvalues do not depend on initial values";
        refused(&["initial.module[1].v1"], &[1.0], &[initial]);
        refused(&["module[1].x1"], &[1.0], &["module[1].x1 cannot be set: it is an output"]);
        assert_eq!(rates(&scene, &[mu], &[]), Ok(Vec::new()));
    }
}
