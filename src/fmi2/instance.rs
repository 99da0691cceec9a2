//! One instance of the FMU, in safe Rust.

use super::lifecycle::{Call, Phase};
use super::logger::{Category, Logger};
use super::types::fmi2Status;
use crate::Error;
use crate::scene::{self, Rule, Scene, Selection};
use crate::simulation::catalogue::Kind;
use crate::simulation::{
    self, Given, Progress, Simulation, Snapshot, Variable, check_value, fingerprint, from_bytes,
    newly_broken, read_scene, to_bytes, write_scene,
};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::path::Path;

/// The file among the FMU's resources that holds the scene.
pub(crate) const SCENE_FILE: &str = "scene.toml";

/// One instance: a scene that is being set up, then a simulation of it.
pub(super) struct Instance {
    pub(super) logger: Logger,
    phase: Phase,
    guid: String,
    variables: Vec<Variable>,
    /// The scene as the FMU carries it.
    original: Scene,
    /// The scene with the importer's values, until a simulation is made of it.
    scene: Scene,
    start_time: f64,
    stop_time: Option<f64>,
    is_experiment_set_up: bool,
    simulation: Option<Simulation>,
}

/// A saved instance.
#[derive(Clone)]
pub(super) struct SavedInstance {
    phase: Phase,
    start_time: f64,
    stop_time: Option<f64>,
    values: Values,
}

#[derive(Clone)]
enum Values {
    BeforeStart(Box<Scene>),
    Running(Box<Snapshot>),
}

impl Values {
    fn scene(&self) -> &Scene {
        match self {
            Self::BeforeStart(scene) => scene,
            Self::Running(snapshot) => snapshot.scene(),
        }
    }
}

/// What bytes hold of a saved instance.
#[derive(Serialize, Deserialize)]
struct Record<'a> {
    phase: Phase,
    start_time: f64,
    stop_time: Option<f64>,
    given: Given,
    /// Of one that runs.
    progress: Option<Cow<'a, Progress>>,
}

/// The two types of number that cross the boundary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Number {
    Real,
    Integer,
}

impl Instance {
    /// An instance of the scene in `resources`, if the importer's GUID is that scene's.
    pub(super) fn new(
        resources: &Path,
        guid: &str,
        logger: Logger,
    ) -> Result<Self, (Error, Logger)> {
        let read = || {
            let path = resources.join(SCENE_FILE);
            let (scene, source) = scene::read(&path)?;
            let expected = fingerprint(&source);
            if guid == expected {
                Ok((scene, expected))
            } else {
                Err(Error::package(format!(
                    "the GUID {guid} of the model description does not belong to this library and \
                     its {SCENE_FILE}, whose GUID is {expected}; export the FMU anew"
                )))
            }
        };
        match read() {
            Err(error) => Err((error, logger)),
            Ok((scene, guid)) => Ok(Self {
                logger,
                phase: Phase::Instantiated,
                guid,
                variables: simulation::variables(&scene),
                original: scene.clone(),
                scene,
                start_time: 0.0,
                stop_time: None,
                is_experiment_set_up: false,
                simulation: None,
            }),
        }
    }

    /// Refuses a call that the present phase does not allow.
    #[inline]
    pub(super) fn require(&self, call: Call) -> Result<(), Error> {
        if call.is_allowed_in(self.phase) { Ok(()) } else { Err(self.not_allowed(call)) }
    }

    #[cold]
    fn not_allowed(&self, call: Call) -> Error {
        Error::call(format!(
            "{call} is not allowed in phase {:?}; it is in {}",
            self.phase,
            call.phases()
        ))
    }

    /// Takes note of a failed call. A caught panic leaves nothing to rely on.
    pub(super) fn fail(&mut self, panicked: bool) {
        if panicked {
            self.phase = Phase::Poisoned;
        } else if self.phase != Phase::Poisoned {
            self.phase = Phase::Error;
        }
    }

    /// A tolerance counts where the scene leaves method and step to it, and nowhere else.
    pub(super) fn setup_experiment(
        &mut self,
        tolerance: Option<f64>,
        start: f64,
        stop: Option<f64>,
    ) -> Result<(), Error> {
        if !start.is_finite() || stop.is_some_and(|stop| stop.is_nan() || stop < start) {
            let stop = stop.map_or_else(|| "none".to_owned(), |stop| stop.to_string());
            return Err(Error::call(format!("start time {start} and stop time {stop} do not fit")));
        }
        if let Selection::Auto { tolerance: default } = self.original.selection {
            let tolerance = tolerance.unwrap_or(default);
            if let Some(wish) = Rule::TOLERANCE.broken_by(tolerance) {
                return Err(Error::call(format!("tolerance = {tolerance:e}: {wish}")));
            }
            self.scene.selection = Selection::Auto { tolerance };
        }
        self.start_time = start;
        self.stop_time = stop;
        self.is_experiment_set_up = true;
        self.simulation = None;
        Ok(())
    }

    pub(super) fn enter_initialization_mode(&mut self) {
        if !self.is_experiment_set_up {
            self.warn("fmi2SetupExperiment was not called; the run starts at time 0");
        }
        self.phase = Phase::InitializationMode;
    }

    pub(super) fn exit_initialization_mode(&mut self) -> Result<(), Error> {
        self.start()?;
        self.phase = Phase::StepComplete;
        if let Some(selected) = self.start()?.selected() {
            if self.logger.wants(Category::Events) {
                self.inform(&format!("chosen: {selected}"));
            }
            if let Some(shortfall) = selected.shortfall() {
                self.warn(&shortfall);
            }
        }
        if self.logger.wants(Category::Events) {
            let equilibrium = self.start()?.reference().clone();
            let forces: Vec<String> =
                equilibrium.normal_force.iter().map(|force| format!("{force:.6}")).collect();
            self.inform(&format!(
                "initialized at the equilibrium with normal forces {} N",
                forces.join(", ")
            ));
        }
        Ok(())
    }

    pub(super) fn terminate(&mut self) {
        self.phase = Phase::Terminated;
    }

    pub(super) fn reset(&mut self) {
        self.scene.clone_from(&self.original);
        self.simulation = None;
        self.start_time = 0.0;
        self.stop_time = None;
        self.is_experiment_set_up = false;
        self.phase = Phase::Instantiated;
    }

    /// The simulation; made of the values so far if there is none yet.
    fn start(&mut self) -> Result<&mut Simulation, Error> {
        if self.simulation.is_none() {
            self.simulation = Some(Simulation::new(self.scene.clone(), self.start_time)?);
        }
        Ok(self.simulation.as_mut().expect("just made"))
    }

    fn is_set_up(&self) -> bool {
        matches!(self.phase, Phase::Instantiated | Phase::InitializationMode)
    }

    /// The place of a variable of that type in the list.
    fn find(&self, reference: u32, number: Number) -> Result<usize, Error> {
        let place = reference as usize;
        let fits = self.variables.get(place).is_some_and(|variable| {
            matches!(variable.template.kind, Kind::Real { .. }) == (number == Number::Real)
        });
        if fits {
            return Ok(place);
        }
        Err(Error::variable(format!("value reference {reference} is not one of a {number:?}")))
    }

    pub(super) fn get(&mut self, reference: u32, number: Number) -> Result<f64, Error> {
        let place = self.find(reference, number)?;
        let in_scene =
            self.is_set_up().then(|| read_scene(&self.scene, &self.variables[place])).flatten();
        let value = match in_scene {
            Some(value) => value,
            None => {
                self.start()?;
                let simulation = self.simulation.as_mut().expect("just made");
                simulation.read(&self.variables[place])?
            }
        };
        if value.is_finite() {
            return Ok(value);
        }
        Err(Error::step(format!("{} is not a finite number", self.variables[place].name)))
    }

    /// May the variable be set now, to this value? Asked of all values before any is set.
    pub(super) fn check_set(
        &self,
        reference: u32,
        value: f64,
        number: Number,
    ) -> Result<(), Error> {
        let variable = &self.variables[self.find(reference, number)?];
        check_value(variable, value)?;
        let possible =
            if self.is_set_up() { variable.is_settable() } else { variable.is_tunable() };
        if possible {
            return Ok(());
        }
        Err(Error::variable(format!(
            "{} cannot be set {}",
            variable.name,
            if self.is_set_up() { "at all: it is an output" } else { "after initialization" }
        )))
    }

    pub(super) fn set(&mut self, reference: u32, value: f64, number: Number) -> Result<(), Error> {
        let variable = &self.variables[self.find(reference, number)?];
        if self.is_set_up() {
            self.simulation = None;
            return write_scene(&mut self.scene, variable, value);
        }
        let simulation = self.simulation.as_mut().expect("made when initialization ended");
        simulation.write(variable, value)
    }

    pub(super) fn do_step(&mut self, current: f64, size: f64) -> Result<fmi2Status, Error> {
        let listening = self.logger.wants(Category::Events);
        let stop = self.stop_time;
        let simulation = self.simulation.as_mut().expect("made when initialization ended");
        if !current.is_finite() || !size.is_finite() || size < 0.0 {
            return Err(Error::call(format!("cannot step from {current} s by {size} s")));
        }
        let target = current + size;
        if !simulation.same_time(current, simulation.time()) {
            return Err(Error::call(format!(
                "asked to step from {current} s, but the instance is at {} s",
                simulation.time()
            )));
        }
        if let Some(stop) = stop.filter(|&stop| target > stop)
            && !simulation.same_time(target, stop)
        {
            return Err(Error::call(format!(
                "asked to step to {target} s, beyond the stop time {stop} s of the experiment"
            )));
        }
        let before = simulation.statistics();
        simulation.advance_to(target)?;
        let changes = simulation.statistics().state_changes() - before.state_changes();
        let broken = newly_broken(simulation, before);
        if listening && changes > 0 {
            self.inform(&format!("{changes} changes of contact state up to {target} s"));
        }
        for assumption in broken {
            self.warn(&assumption);
        }
        if size == 0.0 {
            self.warn("a step of length zero: nothing was done");
            return Ok(fmi2Status::fmi2Warning);
        }
        Ok(fmi2Status::fmi2OK)
    }

    /// The time up to which all steps succeeded, s.
    pub(super) fn last_successful_time(&self) -> f64 {
        self.simulation.as_ref().map_or(self.start_time, Simulation::time)
    }

    pub(super) fn save(&self) -> SavedInstance {
        SavedInstance {
            phase: self.phase,
            start_time: self.start_time,
            stop_time: self.stop_time,
            values: match self.simulation.as_ref().filter(|_| !self.is_set_up()) {
                Some(simulation) => Values::Running(Box::new(simulation.save())),
                None => Values::BeforeStart(Box::new(self.scene.clone())),
            },
        }
    }

    /// A saved instance as bytes.
    pub(super) fn serialize(&self, saved: &SavedInstance) -> Result<Vec<u8>, Error> {
        let scene = saved.values.scene();
        self.check_size(scene)?;
        let record = Record {
            phase: saved.phase,
            start_time: saved.start_time,
            stop_time: saved.stop_time,
            given: Given::of(scene, &self.variables),
            progress: match &saved.values {
                Values::BeforeStart(_) => None,
                Values::Running(snapshot) => Some(Cow::Borrowed(snapshot.progress())),
            },
        };
        Ok(to_bytes(&record, &self.guid))
    }

    /// A saved instance from its bytes.
    pub(super) fn deserialize(&self, bytes: &[u8]) -> Result<SavedInstance, Error> {
        let record: Record<'_> = from_bytes(bytes, &self.guid)?;
        let scene = record.given.put_into(&self.original, &self.variables)?;
        Ok(SavedInstance {
            phase: record.phase,
            start_time: record.start_time,
            stop_time: record.stop_time,
            values: match record.progress {
                None => Values::BeforeStart(Box::new(scene)),
                Some(progress) => {
                    Values::Running(Box::new(Snapshot::new(scene, progress.into_owned())))
                }
            },
        })
    }

    pub(super) fn restore(&mut self, saved: &SavedInstance) -> Result<(), Error> {
        self.check_size(saved.values.scene())?;
        match &saved.values {
            Values::BeforeStart(scene) => {
                self.scene.clone_from(&**scene);
                self.simulation = None;
            }
            Values::Running(snapshot) => match &mut self.simulation {
                Some(simulation) => simulation.restore(snapshot)?,
                None => self.simulation = Some(Simulation::resume((**snapshot).clone())?),
            },
        }
        self.phase = saved.phase;
        self.is_experiment_set_up = true;
        self.start_time = saved.start_time;
        self.stop_time = saved.stop_time;
        Ok(())
    }

    fn check_size(&self, scene: &Scene) -> Result<(), Error> {
        if scene.has_parts_of(&self.original) {
            return Ok(());
        }
        Err(Error::saved_state("the saved state is of another structure"))
    }

    pub(super) fn warn(&self, message: &str) {
        self.logger.log(fmi2Status::fmi2Warning, Category::Warning, message);
    }

    fn inform(&self, message: &str) {
        self.logger.log(fmi2Status::fmi2OK, Category::Events, message);
    }
}
