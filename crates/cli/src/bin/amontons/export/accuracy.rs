//! The page on accuracy in the documentation of an FMU, computed by runs of the scene.

use crate::reference::{self, REFERENCE_SHARE};
use amontons::scene::Scene;
use amontons_analysis::accuracy::{Row, StepCandidate, short};
use amontons_analysis::watch::Watch;
use amontons_cli::interrupt::{self, Interrupted, stopped};
use amontons_export::documentation::accuracy_page;
use std::error::Error;

/// Runs the scene with both methods and writes the page.
///
/// # Errors
/// Returns an error if the scene cannot be run or the user has ended the command ([`Interrupted`]).
pub fn page(scene: &Scene) -> Result<String, Box<dyn Error>> {
    interrupt::listen();
    let bar = reference::bar();
    let study = reference::study(scene, None, &bar)?;
    bar.say("methods and steps");
    let ladder = study.candidates();
    let share = (1.0 - REFERENCE_SHARE) / ladder.len().max(1) as f64;
    let (mut rows, mut notes): (Vec<(Row, Option<f64>)>, _) = (Vec::new(), Vec::new());
    for (start, candidate) in ladder.into_iter().enumerate() {
        let progress =
            |passed: f64| bar.set_part(REFERENCE_SHARE + share * (start as f64 + passed));
        match study.row(candidate, Watch { go_on: &stopped, progress: &progress }) {
            Ok(None) => return Err(Interrupted.into()),
            Ok(Some(row)) => {
                let order = rows.last().and_then(|(before, _)| study.order(before, &row));
                rows.push((row, order));
            }
            Err(error) => {
                let StepCandidate { method, step, .. } = candidate;
                notes.push(format!(
                    "{method} with a step of {} s is left out: {error}",
                    short(step)
                ));
            }
        }
    }
    bar.finish();
    Ok(accuracy_page(&study, &rows, &notes))
}
