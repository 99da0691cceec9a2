//! One instance of the FMU, in safe Rust.

mod derivatives;
mod saved;

use super::lifecycle::{Call, Noted, Permission, Phase};
use super::logger::{Category, Logger};
use super::types::fmi2Status;
use crate::Error;
use crate::error::Short;
use crate::scene::{self, Rule};
use crate::simulation::catalogue::{Causality, Kind, Quantity, Variability, fmu_variables};
use crate::simulation::{Parameters, Simulation, Variable, check_value, fingerprint, newly_broken};
use serde::{Deserialize, Serialize};
use std::ffi::CStr;
use std::path::Path;
use std::sync::Arc;

pub(super) use saved::SavedInstance;

/// Name of the file among the FMU's resources that holds the scene.
pub const SCENE_FILE: &str = "scene.toml";

/// Default of the strict mode, in which an instance refuses calls that FMI forbids and hosts nevertheless make.
pub const STRICT: bool = false;

/// An instance of the FMU: a scene that is being set up, then a simulation of it.
pub(super) struct Instance {
    pub(super) logger: Logger,
    setup: Setup,
    guid: Arc<str>,
    /// Variables of the scene, then the FMU's own; a value reference is an index of this list.
    variables: Vec<Variable>,
    /// The scene's parameters and inputs with the values that the FMU carries.
    original: Parameters,
    /// The scene's parameters and inputs with the importer's values, until the simulation is made from them.
    parameters: Parameters,
    /// `true` if the present call was tolerated although FMI forbids it.
    pub(super) tolerated: bool,
    /// Tolerated calls of which the importer has been warned.
    told: Noted,
    /// The simulation. Before the end of initialization it only serves to read values, and has no effect on the run.
    simulation: Option<Simulation>,
    /// `true` if initialization has ended.
    has_started: bool,
}

/// Settings of the importer, except the values of variables.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Setup {
    phase: Phase,
    /// Start time, s.
    start_time: f64,
    /// Stop time, s; `None` if the importer has not given one.
    stop_time: Option<f64>,
    /// Rates of change during the first step, per second, of inputs by their index in the list of variables.
    rates: Vec<(usize, f64)>,
    is_experiment_set_up: bool,
    /// `true` if the instance refuses calls that FMI forbids and hosts nevertheless make.
    strict: bool,
}

impl Default for Setup {
    fn default() -> Self {
        Self {
            phase: Phase::Instantiated,
            start_time: 0.0,
            stop_time: None,
            rates: Vec::new(),
            is_experiment_set_up: false,
            strict: STRICT,
        }
    }
}

/// Refuses a start time (s) that is not finite, and a stop time (s) before it.
fn check_experiment(start: f64, stop: Option<f64>) -> Result<(), Error> {
    if start.is_finite() && stop.is_none_or(|stop| stop >= start) {
        return Ok(());
    }
    let stop = stop.map_or_else(|| "none".to_owned(), |stop| Short(stop).to_string());
    Err(Error::call(format!(
        "start time {} and stop time {stop} are invalid: the start time must be finite, and the stop time must \
         not be before it",
        Short(start)
    )))
}

/// The types of number in calls of the C interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Number {
    Real,
    Integer,
    /// Boolean: 0 is false, all other values are true.
    Boolean,
}

impl Number {
    /// The type in which a variable is read and set.
    fn of(variable: &Variable) -> Self {
        match variable.template.kind {
            Kind::Real { .. } => Self::Real,
            Kind::Integer | Kind::Enumeration { .. } => Self::Integer,
            Kind::Boolean => Self::Boolean,
        }
    }
}

impl Instance {
    /// Makes an instance of the scene in `resources`, if the importer's GUID is that scene's.
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
            Ok((scene, guid)) => {
                let variables = fmu_variables(&scene);
                let original = Parameters::of(scene);
                Ok(Self {
                    logger,
                    setup: Setup::default(),
                    guid: guid.into(),
                    variables,
                    // One layout for both: states from bytes are then restored without a comparison of scenes.
                    parameters: original.clone(),
                    original,
                    tolerated: false,
                    told: Noted::default(),
                    simulation: None,
                    has_started: false,
                })
            }
        }
    }

    /// Refuses a call that the present phase does not allow. A tolerated call is answered with a warning, or refused
    /// if the instance is strict.
    #[inline]
    pub(super) fn require(&mut self, call: Call) -> Result<(), Error> {
        self.require_of(call, "")
    }

    /// Refuses a call that the present phase does not allow; `name` names the object of the call, for the message.
    #[inline]
    fn require_of(&mut self, call: Call, name: &str) -> Result<(), Error> {
        match call.in_phase(self.setup.phase) {
            Permission::Allowed => Ok(()),
            Permission::Tolerated => self.tolerate(call, name),
            Permission::Refused => Err(Error::call(format!(
                "{call} is not allowed in phase {:?}; {}{}",
                self.setup.phase,
                call.phases(),
                if self.setup.phase == Phase::Error {
                    "; call fmi2Reset or restore a saved state first"
                } else {
                    ""
                }
            ))),
        }
    }

    /// Warns of each tolerated call once, since a host that makes one repeats it in every step.
    #[cold]
    fn tolerate(&mut self, call: Call, name: &str) -> Result<(), Error> {
        let message = format!(
            "{call}{name} in phase {:?}: FMI requires {}",
            self.setup.phase,
            call.requirement()
        );
        if self.setup.strict {
            return Err(Error::call(message));
        }
        let message = message + call.consequence();
        self.tolerated = true;
        if self.logger.wants(Category::Warning) && self.told.note(call) {
            self.warn(&message);
        }
        Ok(())
    }

    pub(super) fn set_debug_logging(&mut self, on: bool, names: &[&CStr]) -> Result<(), Error> {
        let unknown = Logger::unknown(names);
        if unknown.is_none() || !self.setup.strict {
            // The categories change first, since the warning may belong to one that is turned on.
            self.logger.enable(on, names);
        }
        unknown.map_or(Ok(()), |name| self.require_of(Call::UnknownCategory, &format!(" {name:?}")))
    }

    /// Records a failed call. After a caught panic the state of the instance is unreliable.
    pub(super) fn fail(&mut self, panicked: bool) {
        if panicked {
            self.setup.phase = Phase::Poisoned;
        } else if self.setup.phase != Phase::Poisoned {
            self.setup.phase = Phase::Error;
        }
    }

    /// Sets up the experiment. The tolerance is used only if the scene leaves the choice of method and step to it.
    pub(super) fn setup_experiment(
        &mut self,
        tolerance: Option<f64>,
        start: f64,
        stop: Option<f64>,
    ) -> Result<(), Error> {
        check_experiment(start, stop)?;
        if let Some(default) = self.original.tolerance() {
            let tolerance = tolerance.unwrap_or(default);
            if let Some(wish) = Rule::TOLERANCE.broken_by(tolerance) {
                return Err(Error::call(format!("tolerance = {tolerance:e}: {wish}")));
            }
            self.parameters.set_tolerance(tolerance);
        }
        self.setup.start_time = start;
        self.setup.stop_time = stop;
        self.setup.is_experiment_set_up = true;
        self.simulation = None;
        Ok(())
    }

    pub(super) fn enter_initialization_mode(&mut self) -> Result<(), Error> {
        if !self.setup.is_experiment_set_up {
            self.require(Call::EnterUnprepared)?;
        }
        self.setup.phase = Phase::InitializationMode;
        Ok(())
    }

    pub(super) fn exit_initialization_mode(&mut self) -> Result<(), Error> {
        self.start()?;
        self.start_rates()?;
        self.has_started = true;
        self.setup.phase = Phase::StepComplete;
        if let Some(selected) = self.start()?.selected() {
            if self.logger.wants(Category::Events) {
                self.inform(&format!("chosen by the tolerance: {selected}"));
            }
            if let Some(shortfall) = selected.shortfall() {
                self.warn(&shortfall);
            }
        }
        if let Some(velocity) = self.standing_slider()? {
            self.warn(&format!(
                "initialized with {velocity} = 0: equilibrium without friction; an equilibrium in sliding needs the \
                 velocity before initialization ends"
            ));
        }
        if self.logger.wants(Category::Events) {
            let equilibrium = self.start()?.reference().clone();
            let forces: Vec<String> =
                equilibrium.normal_force.iter().map(|force| format!("{force:.6}")).collect();
            let contacts = if forces.is_empty() {
                " without contacts".to_owned()
            } else {
                format!(" with normal forces {} N", forces.join(", "))
            };
            self.inform(&format!("initialized at the equilibrium{contacts}"));
        }
        Ok(())
    }

    /// The name of a slider velocity that the importer has set to zero, where the scene's contacts slide and rub: most
    /// likely an input that is linked to another FMU and does not have its value yet.
    fn standing_slider(&mut self) -> Result<Option<String>, Error> {
        let stands = |variable: &&Variable| {
            let quantity = variable.template.quantity;
            matches!(quantity, Quantity::SliderVelocity | Quantity::OwnVelocity)
                && self.parameters.get(variable) == Some(0.0)
                && self.original.get(variable) != Some(0.0)
        };
        let Some(velocity) = self.variables.iter().find(stands).map(|v| v.name.to_string()) else {
            return Ok(None);
        };
        let model = self.start()?.model();
        let rubs = model.contacts.iter().any(|contact| contact.friction.kinetic != 0.0);
        Ok(rubs.then_some(velocity))
    }

    pub(super) fn terminate(&mut self) {
        self.setup.phase = Phase::Terminated;
    }

    pub(super) fn reset(&mut self) {
        self.parameters.clone_from(&self.original);
        self.simulation = None;
        self.has_started = false;
        self.setup = Setup::default();
        self.told = Noted::default();
    }

    /// The simulation; it is made from the present values if there is none yet.
    fn start(&mut self) -> Result<&mut Simulation, Error> {
        if self.simulation.is_none() {
            self.simulation =
                Some(Simulation::with(self.parameters.clone(), self.setup.start_time)?);
        }
        Ok(self.simulation.as_mut().expect("just made"))
    }

    fn is_set_up(&self) -> bool {
        matches!(self.setup.phase, Phase::Instantiated | Phase::InitializationMode)
    }

    /// Index of a variable of this type in the list.
    fn find(&self, reference: u32, number: Number) -> Result<usize, Error> {
        let place = reference as usize;
        if self.variables.get(place).is_some_and(|variable| Number::of(variable) == number) {
            return Ok(place);
        }
        Err(Error::variable(format!(
            "there is no {number:?} variable with value reference {reference}"
        )))
    }

    pub(super) fn get(&mut self, reference: u32, number: Number) -> Result<f64, Error> {
        let place = self.find(reference, number)?;
        if self.variables[place].template.quantity == Quantity::Strict {
            return Ok(f64::from(u8::from(self.setup.strict)));
        }
        // Before a run has begun, values that were set can be read even if no simulation can be made from them.
        let before_start = self.is_set_up() || self.simulation.is_none();
        let set = before_start.then(|| self.parameters.get(&self.variables[place])).flatten();
        let value = match set {
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

    /// Refuses to set the variable to this value if the phase or the value forbids it. All values are checked before
    /// any is set.
    pub(super) fn check_set(
        &mut self,
        reference: u32,
        value: f64,
        number: Number,
    ) -> Result<(), Error> {
        let variable = &self.variables[self.find(reference, number)?];
        check_value(variable, value)?;
        let what = match (variable.causality, variable.variability) {
            (Causality::Input, _) => Call::SetInput,
            (Causality::Output, _) => Call::SetOutput,
            (Causality::Parameter, Variability::Tunable) => Call::SetTunable,
            (Causality::Parameter, _) => Call::SetFixed,
        };
        if what.in_phase(self.setup.phase) != Permission::Refused {
            return self.require(what);
        }
        Err(Error::variable(format!(
            "{} cannot be set {}",
            variable.name,
            if what == Call::SetOutput {
                "at all: it is an output"
            } else {
                "after initialization"
            }
        )))
    }

    pub(super) fn set(&mut self, reference: u32, value: f64, number: Number) -> Result<(), Error> {
        let variable = &self.variables[self.find(reference, number)?];
        if variable.template.quantity == Quantity::Strict {
            self.setup.strict = value != 0.0;
            return Ok(());
        }
        if self.is_set_up() {
            self.simulation = None;
            return self.parameters.set(variable, value);
        }
        let simulation = self.simulation.as_mut().expect("made when initialization ended");
        simulation.write(variable, value)
    }

    pub(super) fn do_step(&mut self, current: f64, size: f64) -> Result<(), Error> {
        let listening = self.logger.wants(Category::Events);
        let stop = self.setup.stop_time;
        let simulation = self.simulation.as_mut().expect("made when initialization ended");
        if !current.is_finite() || !size.is_finite() || size < 0.0 {
            return Err(Error::call(format!(
                "cannot step from {current} s by {size} s: both must be finite, and the step must not be negative"
            )));
        }
        let target = current + size;
        if !simulation.same_time(current, simulation.time()) {
            return Err(Error::call(format!(
                "fmi2DoStep begins at {} s, but the instance is at {} s",
                Short(current),
                Short(simulation.time())
            )));
        }
        if let Some(stop) = stop.filter(|&stop| target > stop)
            && !simulation.same_time(target, stop)
        {
            return Err(Error::call(format!(
                "fmi2DoStep ends at {} s, after the stop time {} s of the experiment",
                Short(target),
                Short(stop)
            )));
        }
        let before = simulation.statistics();
        simulation.advance_to(target)?;
        let changes = simulation.statistics().state_changes() - before.state_changes();
        let broken = newly_broken(simulation, before);
        if listening && changes > 0 {
            let time = Short(target);
            self.inform(&format!("changes of contact state in the step to {time} s: {changes}"));
        }
        for assumption in broken {
            self.warn(&assumption);
        }
        if size == 0.0 {
            self.require(Call::StepOfLengthZero)?;
        }
        Ok(())
    }

    /// The time up to which all steps succeeded, s.
    pub(super) fn last_successful_time(&self) -> f64 {
        self.simulation.as_ref().map_or(self.setup.start_time, Simulation::time)
    }

    pub(super) fn warn(&self, message: &str) {
        self.logger.log(fmi2Status::fmi2Warning, Category::Warning, message);
    }

    fn inform(&self, message: &str) {
        self.logger.log(fmi2Status::fmi2OK, Category::Events, message);
    }
}
