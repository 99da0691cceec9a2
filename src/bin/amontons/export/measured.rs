//! What is measured for an FMU: the method and step that keep a tolerance, and the table in its documentation.

use crate::interrupt::{self, Interrupted, REFERENCE_SHARE, stopped};
use amontons::accuracy::{Choice, Compared, Row, Rung, Study, short};
use amontons::documentation::accuracy_page;
use amontons::scene::Scene;
use std::error::Error;

/// What was measured.
pub struct Measured {
    /// What a tolerance was kept by.
    pub choice: Option<Choice>,
    /// The page on accuracy for the documentation.
    pub page: Option<String>,
}

/// Runs the scene with both methods, for a tolerance, for the page, or for both.
///
/// # Errors
/// What is wrong with the scene; [`Interrupted`].
pub fn measure(
    scene: &Scene,
    tolerance: Option<f64>,
    with_page: bool,
) -> Result<Measured, Box<dyn Error>> {
    if tolerance.is_none() && !with_page {
        return Ok(Measured { choice: None, page: None });
    }
    interrupt::listen();
    let bar = interrupt::reference();
    let study = interrupt::study(scene, None, &bar)?;
    bar.say("methods and steps");
    let (mut runs, mut last) = (0.0, 0.0);
    let watch = &mut |passed: f64| {
        // How many runs it takes is not known before.
        if passed < last {
            runs += 1.0;
        }
        last = passed;
        let part = 1.0 - 0.8_f64.powf(runs + passed);
        bar.set_part(REFERENCE_SHARE + (1.0 - REFERENCE_SHARE) * part);
        stopped()
    };
    let mut measured = || -> Result<Measured, Box<dyn Error>> {
        let choice = match tolerance {
            Some(tolerance) => Some(study.choose(tolerance, watch)?.ok_or(Interrupted)?),
            None => None,
        };
        let page = with_page.then(|| page(&study, watch)).transpose()?;
        Ok(Measured { choice, page })
    };
    let measured = measured();
    bar.finish();
    measured
}

fn page(
    study: &Study,
    watch: &mut dyn FnMut(f64) -> std::ops::ControlFlow<()>,
) -> Result<String, Box<dyn Error>> {
    let (mut rows, mut notes): (Vec<(Row, Option<f64>)>, _) = (Vec::new(), Vec::new());
    for rung in study.ladder() {
        match study.row(rung, &mut *watch) {
            Ok(None) => return Err(Interrupted.into()),
            Ok(Some(row)) => {
                let order = rows.last().and_then(|(before, _)| study.order(before, &row));
                rows.push((row, order));
            }
            Err(error) => {
                let Rung { method, step, .. } = rung;
                notes.push(format!("{method} with {} s is left out: {error}", short(step)));
            }
        }
    }
    Ok(accuracy_page(study, &rows, &notes))
}

/// Why a method and a step were taken, in lines.
pub fn reasons(choice: &Choice, scene: &Scene, tolerance: f64) -> Vec<String> {
    let line = |compared: &Compared, verdict: &str| {
        let rung = compared.row.rung;
        let error = compared.error.map_or_else(|| "unknown".to_owned(), |e| format!("{e:.1e}"));
        format!(
            "{:17}  step {:>9} s, error {error}, {:.1e} operations{verdict}",
            rung.method.to_string(),
            short(rung.step),
            compared.operations
        )
    };
    let head = format!("{tolerance:e}, held against runs of {} s:", scene.experiment.stop_time);
    let mut lines = vec![head, line(&choice.taken, ": taken")];
    lines.extend(choice.other.as_ref().map(|other| {
        let verdict = match (other.keeps(tolerance), choice.taken.keeps(tolerance)) {
            (true, _) => ": dearer",
            (false, true) => ": not accurate enough",
            (false, false) => ": not accurate enough",
        };
        line(other, verdict)
    }));
    lines
}
