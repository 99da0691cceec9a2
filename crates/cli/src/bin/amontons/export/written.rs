//! The runs of a scene that an export writes beside the FMU or into its documentation.

use amontons::scene::Scene;
use amontons_analysis::watch::Watch;
use amontons_cli::interrupt::{self, Interrupted};
use amontons_cli::progress::Progress;
use amontons_export::documentation::{CrossCheck, ReferenceRun, cross_check, reference_run};
use std::error::Error;
use std::path::{Path, PathBuf};

/// Makes the reference run of the documentation page.
///
/// # Errors
/// Returns an error if the scene is invalid, or [`Interrupted`] if the user has ended the command.
pub fn run(scene: &Scene) -> Result<ReferenceRun, Box<dyn Error>> {
    watched("the reference run", |watch| reference_run(scene, watch))
}

/// Makes the cross-check run that is written beside the FMU.
///
/// # Errors
/// Returns an error if the scene is invalid or a step fails, or [`Interrupted`] if the user has ended the command.
pub fn check(scene: &Scene) -> Result<CrossCheck, Box<dyn Error>> {
    watched("the cross-check's run", |watch| cross_check(scene, watch))
}

fn watched<T>(
    what: &str,
    work: impl FnOnce(Watch<'_>) -> Result<Option<T>, amontons::Error>,
) -> Result<T, Box<dyn Error>> {
    let done = interrupt::watched(&Progress::in_parts(what), work)?;
    done.ok_or_else(|| Interrupted.into())
}

/// Names and contents of the files of a cross-check, for an FMU at this path.
pub fn files(check: &CrossCheck, fmu: &Path) -> Vec<(PathBuf, String)> {
    let stem = fmu.file_stem().unwrap_or_default().to_string_lossy();
    let named =
        |end: &str, text: &String| (fmu.with_file_name(format!("{stem}{end}")), text.clone());
    let mut files = vec![named("_ref.csv", &check.reference), named("_ref.opt", &check.options)];
    files.extend(check.inputs.as_ref().map(|inputs| named("_in.csv", inputs)));
    files
}
