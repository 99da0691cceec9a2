//! FMUs.

use crate::errors::raised;
use crate::interrupt::watched;
use crate::scene::Scene;
use amontons::Error;
use amontons::scene::{IntegratorChoice, Selection};
use amontons::simulation::Simulation;
use amontons_analysis::output::{AtomicFile, check_folder};
use amontons_export::documentation::{Subject, documentation, reference_run};
use amontons_export::package::{self, Library};
use amontons_export::scene as files;
use pyo3::prelude::*;
use std::io::Write;
use std::path::PathBuf;

/// Writes the FMU of a scene; with the platforms that are given, or all.
#[pyfunction]
#[pyo3(signature = (scene, path, platforms=None, progress=None))]
#[allow(clippy::needless_pass_by_value)]
pub fn export(
    py: Python<'_>,
    scene: &Scene,
    path: PathBuf,
    platforms: Option<Vec<String>>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<()> {
    if let Some((name, _)) = scene.values.first() {
        return Err(raised(Error::argument(format!(
            "an FMU has the values of its scene file, and {name} has another one here; change it in the file, or set it \
             in the importer"
        ))));
    }
    let libraries: Vec<Library> = match platforms {
        None => Library::carried().to_vec(),
        Some(names) => names
            .iter()
            .map(|name| Library::of(name).map_err(|wish| raised(Error::argument(wish))))
            .collect::<PyResult<_>>()?,
    };
    let written = watched(py, progress.as_ref(), |watch| {
        check_folder(&path)?;
        let mut source = scene.source.clone();
        if scene.integrator != IntegratorChoice::default() {
            match scene.scene.selection {
                Selection::Preset(preset) => files::set_preset(&mut source, preset)?,
                _ => files::set_integrator(&mut source, scene.scene.method, scene.scene.step)?,
            }
        }
        let start = Simulation::new(scene.scene.clone(), 0.0)?;
        let Some(run) = reference_run(&scene.scene, watch)? else { return Ok(()) };
        let subject = Subject { scene: &scene.scene, source: &source, start: &start, run: &run };
        let documentation = documentation(subject, None)?;
        let fmu = package::fmu(&scene.scene, &source, Some(&documentation), &libraries)?;
        let mut file = AtomicFile::create(&path)?;
        file.write_all(&fmu).map_err(|error| Error::file(&path, &error))?;
        file.complete()
    })?;
    written.map_err(raised)
}
