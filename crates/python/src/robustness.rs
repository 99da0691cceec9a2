//! The study of robustness, and growth rates for values that a tool draws.

use crate::array::reals;
use crate::errors::raised;
use crate::interrupt::watched;
use crate::scene::Scene;
use crate::stability::check_instant;
use amontons::Error;
use amontons::simulation::at_instant;
use amontons_analysis::instant::signals_left_out;
use amontons_analysis::robustness::{
    self, Design, Distribution, Parameter, Pushes, Uncertain, both, check_runs, check_size,
    parameters, push_velocity,
};
use amontons_analysis::study::{Journal, Prepare, Watch};
use pyo3::prelude::*;
use serde::Deserialize;
use serde_json::{Value, json};

/// All that a user asks of a study of robustness.
#[derive(Clone, Debug, Deserialize)]
pub struct Robustness {
    /// Names or patterns, each with its distribution.
    uncertain: Vec<(String, String)>,
    state: Option<String>,
    points: u64,
    scramblings: u64,
    seed: u64,
    /// Ranges of frequencies, Hz.
    bands: Option<Vec<[f64; 2]>>,
    indices: bool,
    /// The distribution of the largest velocity of pushes, m/s.
    pushes: Option<String>,
    runs: u64,
}

impl Robustness {
    /// `true` if draws are run, so that the scene needs a method and a step.
    pub fn has_runs(&self) -> bool {
        self.pushes.is_some()
    }

    /// The result; `None` if the watch ended the study, or where pieces are missing. The scene is ready to run if there are
    /// runs; `prepare` makes that of a draw ready again.
    pub fn found(
        &self,
        given: &amontons::scene::Scene,
        prepare: Prepare<'_>,
        journal: &Journal,
        watch: Watch<'_>,
    ) -> Result<Option<Value>, Error> {
        let parameters = self.parameters(given)?;
        check_size(self.scramblings, self.points)?;
        let velocity = match &self.pushes {
            None => None,
            Some(text) => {
                check_runs(given, self.runs)?;
                Some(push_velocity(&distribution(text, "pushes")?)?)
            }
        };
        let scene = at_instant(given, 0.0)?;
        scene.check()?;
        let design = Design {
            scene: &scene,
            parameters: &parameters,
            state: self.state.as_deref(),
            scramblings: self.scramblings,
            points: self.points,
            seed: self.seed,
            has_indices: self.indices,
        };
        let pushes = velocity.as_ref().map(|velocity| Pushes {
            scene: &scene,
            parameters: &parameters,
            velocity,
            prepare,
            runs: self.runs,
            seed: self.seed,
            name: "run",
        });
        let found = both(&design, self.bands.as_deref(), pushes.as_ref(), journal, watch)?;
        let described: Vec<_> = parameters.iter().map(Parameter::described).collect();
        let notes = parameters.iter().filter_map(Parameter::note);
        let notes: Vec<String> = notes.chain(signals_left_out(given, 0.0)).collect();
        Ok(found.map(|found| json!({ "parameters": described, "notes": notes, "found": found })))
    }

    fn parameters(&self, scene: &amontons::scene::Scene) -> Result<Vec<Parameter>, Error> {
        let uncertain = self.uncertain.iter().map(|(name, text)| {
            Uncertain::parse(&format!("{name}={text}"))
                .map_err(|why| Error::argument(format!("{name}: {why}")))
        });
        let found = parameters(scene, &uncertain.collect::<Result<Vec<_>, Error>>()?)?;
        if found.is_empty() && self.pushes.is_none() {
            return Err(Error::argument(
                "nothing varies: give uncertain parameters, such as {'friction.coefficient': 'normal(±10%)'}, or pushes",
            ));
        }
        Ok(found)
    }
}

fn distribution(text: &str, of: &str) -> Result<Distribution, Error> {
    Distribution::parse(text).map_err(|why| Error::argument(format!("{of}: {why}")))
}

/// The largest growth rate of each row of values, 1/s; NaN where there is no equilibrium in sliding.
#[pyfunction]
#[pyo3(signature = (scene, names, values, state=None, at=0.0, progress=None))]
#[allow(clippy::needless_pass_by_value)]
pub fn growth_rates<'py>(
    py: Python<'py>,
    scene: &Scene,
    names: Vec<String>,
    values: Vec<f64>,
    state: Option<&str>,
    at: f64,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let found = watched(py, progress.as_ref(), |watch| {
        check_instant(at)?;
        // A signal that drives a parameter is told before it is taken out.
        robustness::check_names(&scene.scene, &names)?;
        let here = at_instant(&scene.scene, at)?;
        here.check()?;
        robustness::growth_rates(&here, &names, &values, state, watch)
    })?;
    reals(py, found.map_err(raised)?.into_iter())
}
