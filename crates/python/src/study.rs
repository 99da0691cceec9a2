//! Studies: as a whole on this machine's cores, or in pieces that many workers compute.
//!
//! A study asks for pieces of work by their keys, round by round. [`Study::plan`] tells the pieces that the next round
//! lacks, or the result where nothing is missing; [`Study::work`] computes some of them.

use crate::design::{self, Design};
use crate::errors::{ArgumentError, raised};
use crate::interrupt::watched;
use crate::loudness::Loudness;
use crate::robustness::Robustness;
use crate::scene::Scene;
use amontons::Error;
use amontons::scene::{Experiment, IntegratorChoice};
use amontons::selection::resolve;
use amontons::simulation::at_instant;
use amontons_analysis::instant::require_undriven;
use amontons_analysis::orbit::OrbitStart;
use amontons_analysis::regions::usual_islands;
use amontons_analysis::stability::candidates::bistability;
use amontons_analysis::study::basin::{Axis, Coverage, basin};
use amontons_analysis::study::perturbation::{Direction, perturbation};
use amontons_analysis::study::transient::transient;
use amontons_analysis::study::{
    BranchQuestion, From, Journal, ObservationRequest, ObservationSettings, Plan, Push, Question,
    Watch, branches, continuation, derive_pace, initial_value, limit_cycles, orbit, pace, set_pace,
    settled_motion,
};
use amontons_analysis::sweep::{FRICTION, Possible};
use pyo3::prelude::*;
use serde::Deserialize;
use serde_json::{Value, json};
use std::collections::HashSet;

/// A study of a scene.
#[pyclass(frozen, module = "amontons._core")]
pub struct Study {
    scene: amontons::scene::Scene,
    request: Request,
}

/// The kind of a study, and all that a user asks of it.
#[derive(Clone, Debug, Deserialize)]
struct Request {
    of: Option<String>,
    interval: Option<f64>,
    window: Option<f64>,
    longest: Option<f64>,
    /// The scene's own choice.
    #[serde(skip)]
    integrator: IntegratorChoice,
    #[serde(flatten)]
    kind: Kind,
}

/// A name and values of it.
type Values = (String, Vec<f64>);

#[derive(Clone, Debug, Deserialize)]
#[serde(tag = "study", rename_all = "kebab-case")]
enum Kind {
    Motion,
    LimitCycles { parameter: String, values: Vec<f64>, resolution: f64 },
    Perturbations { parameter: String, values: Vec<f64>, resolution: f64 },
    Basin { x: Values, y: Values, islands: Option<usize>, every_point: bool },
    Continuation { values: Vec<f64>, resolution: Option<f64> },
    Orbit { start: Start },
    Branches { parameter: String, range: [f64; 2], starts: Vec<Start>, points: usize },
    Transient { stop_time: Option<f64>, output_interval: Option<f64> },
    Robustness(Robustness),
    Loudness(Loudness),
    Design(Design),
}

/// The motion from which an orbit is looked for.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Start {
    Run,
    Mode(usize),
    Between(String, [f64; 2]),
    Orbit(Box<OrbitStart>),
}

impl Start {
    fn from(&self, scene: &amontons::scene::Scene) -> Result<From, Error> {
        Ok(match self {
            Self::Run => From::Run,
            Self::Mode(number) => From::Mode(*number),
            Self::Between(name, ends) => From::boundary(scene, name, *ends)?,
            Self::Orbit(known) => {
                known.check(scene)?;
                From::Orbit(known.clone())
            }
        })
    }
}

#[pymethods]
impl Study {
    /// A study that is asked for as JSON.
    #[new]
    fn new(scene: &Scene, request: &str) -> PyResult<Self> {
        let mut request: Request = serde_json::from_str(request)
            .map_err(|error| ArgumentError::new_err(format!("this is no study: {error}")))?;
        request.integrator = scene.integrator.clone();
        Ok(Self { scene: scene.scene.clone(), request })
    }

    /// The whole study on this machine's cores, as JSON.
    #[pyo3(signature = (progress=None))]
    #[allow(clippy::needless_pass_by_value)]
    fn run(&self, py: Python<'_>, progress: Option<Bound<'_, PyAny>>) -> PyResult<String> {
        let journal = Journal::forgotten();
        let found = watched(py, progress.as_ref(), |watch| {
            self.request.found(&self.scene, &journal, watch)
        })?;
        let found = found.map_err(raised)?;
        Ok(found.map(|found| found.to_string()).expect("nothing has ended the study"))
    }

    /// With the pieces that are known, by key and JSON: the result as JSON, the keys of all pieces that the study asks for,
    /// and of those that are missing.
    fn plan(
        &self,
        py: Python<'_>,
        known: Vec<(String, String)>,
    ) -> PyResult<(Option<String>, Vec<String>, Vec<String>)> {
        let journal = journal(known)?.shared(|_| false);
        let found = watched(py, None, |watch| self.request.found(&self.scene, &journal, watch))?;
        let found = found.map_err(raised)?;
        Ok((found.map(|found| found.to_string()), journal.asked(), journal.missing()))
    }

    /// Computes the missing pieces that are `ours`, and those of later rounds to which they lead. `others`: the missing
    /// pieces of this round that other workers compute. The new pieces by key and JSON.
    #[pyo3(signature = (known, ours, others, progress=None))]
    #[allow(clippy::needless_pass_by_value)]
    fn work(
        &self,
        py: Python<'_>,
        known: Vec<(String, String)>,
        ours: HashSet<String>,
        others: HashSet<String>,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Vec<(String, String)>> {
        let before: HashSet<String> = known.iter().map(|(key, _)| key.clone()).collect();
        let journal =
            journal(known)?.shared(move |key| ours.contains(key) || !others.contains(key));
        let found = watched(py, progress.as_ref(), |watch| {
            self.request.found(&self.scene, &journal, watch).map(|_| ())
        })?;
        found.map_err(raised)?;
        let new = journal.pieces().into_iter().filter(|(key, _)| !before.contains(key));
        Ok(new.map(|(key, piece)| (key, piece.to_string())).collect())
    }
}

fn journal(known: Vec<(String, String)>) -> PyResult<Journal> {
    let piece = |(key, piece): (String, String)| {
        serde_json::from_str::<Value>(&piece).map(|piece| (key, piece)).map_err(|error| {
            ArgumentError::new_err(format!("a piece of a study is damaged: {error}"))
        })
    };
    Ok(Journal::of(known.into_iter().map(piece).collect::<PyResult<Vec<_>>>()?))
}

impl Request {
    /// The settings with which motions are observed.
    fn observation(&self, scene: &amontons::scene::Scene) -> Result<ObservationSettings, Error> {
        let request = ObservationRequest {
            of: self.of.as_deref(),
            interval: self.interval,
            window: self.window,
            longest: self.longest,
        };
        ObservationSettings::of(scene, &request)
    }

    /// The result; `None` if the watch ended the study, or where pieces are missing.
    fn found(
        &self,
        given: &amontons::scene::Scene,
        journal: &Journal,
        watch: Watch<'_>,
    ) -> Result<Option<Value>, Error> {
        let mut scene = given.clone();
        if let Kind::Transient { stop_time, output_interval } = &self.kind {
            self.integrator.apply(&mut scene)?;
            resolve(&mut scene);
            let experiment = Experiment {
                stop_time: stop_time.unwrap_or(scene.experiment.stop_time),
                output_interval: output_interval.unwrap_or(scene.experiment.output_interval),
            };
            let found = transient(&scene, experiment, self.of.as_deref(), watch)?;
            return Ok(Some(json!(found)));
        }
        let prepare = |scene: &mut amontons::scene::Scene| {
            let observation = self.observation(scene)?;
            derive_pace(scene, &self.integrator, &observation, pace)?;
            Ok(observation)
        };
        if let Kind::Robustness(asked) = &self.kind
            && !asked.has_runs()
        {
            let found = asked.found(&scene, &prepare, journal, watch)?;
            return Ok(found.map(|found| json!({ "result": found })));
        }
        if let Kind::Design(asked) = &self.kind {
            let asked = asked.request()?;
            let mut ready = asked.ready(&scene)?;
            if asked.has_runs() {
                let observation = self.observation(&ready.scene)?;
                set_pace(&mut ready.scene, &self.integrator, &observation, pace)?;
            }
            let found = design::found(&ready, given, &prepare, journal, watch)?;
            return Ok(found.map(|found| json!({ "result": found })));
        }
        let observation = self.observation(&scene)?;
        // A basin keeps the scene's own method.
        let default =
            if matches!(self.kind, Kind::Basin { .. }) { |_: &mut _, _: &_| {} } else { pace };
        set_pace(&mut scene, &self.integrator, &observation, default)?;
        let found = match &self.kind {
            Kind::Motion => {
                settled_motion(scene.clone(), &observation, watch)?.map(|(_, ending)| json!(ending))
            }
            Kind::LimitCycles { parameter, values, resolution } => {
                let possible = Possible::of(&scene, parameter, values)?;
                let note = possible.note(parameter);
                let question = Question {
                    name: parameter.clone(),
                    values: possible.values,
                    resolution: *resolution,
                    portraits: Some(Vec::new()),
                    contacts: 0,
                };
                limit_cycles(&scene, &prepare, &question, journal, watch)?
                    .map(|found| json!({ "values": question.values, "note": note, "found": found }))
            }
            Kind::Perturbations { parameter, values, resolution } => {
                let direction = Direction {
                    name: initial_value(&scene, parameter)?,
                    amplitudes: values.clone(),
                    resolution: *resolution,
                };
                perturbation(&scene, &direction, &observation, journal, watch)?
                    .map(|found| json!(found))
            }
            Kind::Basin { x, y, islands, every_point } => {
                let axis =
                    |(name, values): &Values| Axis { name: name.clone(), values: values.clone() };
                let usual = usual_islands([x.1.len(), y.1.len()]);
                let islands = islands.map_or(usual, |side| [side; 2]);
                let coverage =
                    if *every_point { Coverage::EveryPoint } else { Coverage::Traced(islands) };
                basin(&scene, [&axis(x), &axis(y)], &observation, coverage, journal, watch)?
                    .map(|found| json!(found))
            }
            Kind::Continuation { values, resolution } => {
                let possible = Possible::of(&scene, FRICTION, values)?;
                let (note, values) = (possible.note(FRICTION), possible.values);
                let [first, second, ..] = values[..] else {
                    return Err(Error::argument("a continuation needs at least two values"));
                };
                let resolution = resolution.unwrap_or(0.01 * (second - first));
                let push = Push::of(&scene);
                require_undriven(&scene, FRICTION)?;
                let range = [first, values[values.len() - 1]];
                let known = bistability(&at_instant(&scene, 0.0)?, range, watch);
                let candidates = known.as_ref().map_or(&[][..], |known| &known.candidates);
                let plan = Plan {
                    scene: &scene,
                    observation: &observation,
                    values: &values,
                    resolution,
                    push,
                    candidates,
                };
                continuation(&plan, journal, watch)?
                    .map(|found| json!({ "values": values, "note": note, "branches": found }))
            }
            Kind::Orbit { start } => {
                let found = orbit(&scene, &observation, &start.from(&scene)?, journal, watch)
                    .map_err(|unfound| unfound.error)?;
                found.map(|found| {
                    json!({
                        "orbit": found.orbit,
                        "stable": found.orbit.is_stable(),
                        "ending": found.ending,
                        "boundary": found.boundary,
                    })
                })
            }
            Kind::Branches { parameter, range, starts, points } => {
                let starts = starts.iter().zip(1..).map(|(start, number): (_, u32)| {
                    Ok((format!("start {number}"), start.from(&scene)?))
                });
                let question = BranchQuestion {
                    name: parameter.clone(),
                    range: *range,
                    starts: starts.collect::<Result<_, Error>>()?,
                    most_points: *points,
                };
                branches(&scene, &observation, &question, journal, watch)?.map(|found| json!(found))
            }
            Kind::Robustness(asked) => asked.found(&scene, &prepare, journal, watch)?,
            Kind::Loudness(asked) => asked.found(&scene, &observation, journal, watch)?,
            Kind::Transient { .. } | Kind::Design(_) => unreachable!("it is made above"),
        };
        let pace = json!({ "method": scene.method, "step": scene.step });
        Ok(found.map(|found| json!({ "look": observation, "pace": pace, "result": found })))
    }
}
