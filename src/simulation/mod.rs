//! A simulation: a model together with its motion. It can be advanced, read, written, saved and restored.

mod assumptions;
pub mod catalogue;
mod clock;
mod derivatives;
mod failure;
mod fingerprint;
mod monitor;
mod parameters;
mod rates;
mod signals;
mod snapshot;
mod start;
mod values;

pub use assumptions::broken_assumptions;
pub(crate) use assumptions::newly_broken;
pub use catalogue::{Variable, variables};
pub use fingerprint::fingerprint;
pub(crate) use parameters::ParameterValues;
pub use parameters::Parameters;
pub(crate) use rates::check_rate;
pub use signals::at_instant;
pub use snapshot::{Progress, Snapshot};
pub(crate) use snapshot::{from_bytes, to_bytes};
pub use values::{check_value, rule, write_scene};

use crate::Error;
use crate::assembly::{self, Numbering};
use crate::contact::{ContactForce, ContactState, Friction};
use crate::error::Short;
use crate::integrator::{
    self, Energy, Inputs, Integrator, Ledger, Motion, Records, Statistics, VisitLog,
};
use crate::model::ring::MODULE_DOFS;
use crate::model::{Equilibrium, LumpedModel};
use crate::scene::{Method, Scene, Structure};
use crate::selection::{Selected, select};
use crate::stability::StepGuard;
use catalogue::{Quantity, superelement_row};
use clock::{Clock, StepPlan};
use monitor::StabilityMonitor;
use serde::{Deserialize, Serialize};
use signals::{DrivenInputs, InputEffect, moved_contacts};
use start::{check_closed, check_outside, initial_motion};
use std::ops::ControlFlow;

/// Number of steps between two checks that the motion is finite.
const CHUNK: u64 = 1 << 16;
/// Number of steps times degrees of freedom between two calls that ask whether to continue: well below a second.
const UNASKED: u64 = 1_000_000;

/// A simulation: a scene and its motion.
///
/// ```
/// use amontons::scene::parse;
/// use amontons::simulation::Simulation;
///
/// let scene = parse(
///     "oscillator",
///     "[integrator]\nmethod = \"event-driven\"\nstep = 1e-3\n\
///      [[mass]]\nname = \"m\"\nmass = 1.0\nlocked = [\"y\"]\n\
///      [[spring]]\nname = \"k\"\nbetween = [\"m\", \"ground\"]\ndirection = \"x\"\nstiffness = 100.0\n\
///      [[initial]]\nmass = \"m\"\nx = 0.01\n",
/// )?;
/// let mut simulation = Simulation::new(scene, 0.0)?;
/// // Half a period of ω = 10 rad/s.
/// simulation.advance_to(std::f64::consts::PI / 10.0)?;
/// assert!((simulation.displacement()[0] + 0.01).abs() < 1e-14);
/// # Ok::<(), amontons::Error>(())
/// ```
pub struct Simulation {
    /// The scene with its effective values.
    scene: Scene,
    /// The nominal values of parameters and inputs, which may have changed since the start.
    nominal: Parameters,
    /// The inputs that signals or rates drive, whose effective values may differ from the nominal ones.
    driven: Option<DrivenInputs>,
    /// Method and step chosen by a tolerance when this simulation was made; `None` after it was resumed.
    selected: Option<Selected>,
    model: LumpedModel,
    /// Numbers of the degrees of freedom of a network's masses.
    numbering: Numbering,
    /// Guard of the critical step, for a method that has one.
    guard: Option<StepGuard>,
    integrator: Box<dyn Integrator>,
    reference: ReferencePosition,
    motion: Motion,
    clock: Clock,
    inputs: Inputs,
    contact_forces: Vec<ContactForce>,
    /// Stability monitor, in a scene that requests it.
    monitor: Option<StabilityMonitor>,
    /// Results that a change of values has made out of date.
    stale: Stale,
}

#[derive(Clone, Copy, Debug, Default)]
struct Stale {
    inputs: bool,
    limit: bool,
    contact_forces: bool,
}

impl Stale {
    /// Marks the results that depend on a variable as out of date.
    fn by(&mut self, variable: &Variable) {
        self.inputs = true;
        self.contact_forces = true;
        self.limit |= variable.sets_limit();
    }
}

/// Reference position of the displacements: the equilibrium at initialization, and its load.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct ReferencePosition {
    equilibrium: Equilibrium,
    load: Vec<f64>,
}

impl Simulation {
    /// Makes a simulation of the scene, at `start_time` (s) and in its initial position. If a tolerance chooses
    /// method and step, the choice is made now and kept.
    ///
    /// # Errors
    /// Returns an error for impossible values, a scene without an equilibrium, or a step above the critical one.
    pub fn new(scene: Scene, start_time: f64) -> Result<Self, Error> {
        Self::with(Parameters::of(scene), start_time)
    }

    /// Makes a simulation of a scene with these values, at `start_time` (s); otherwise like [`new`](Self::new).
    ///
    /// # Errors
    /// Returns the errors of [`new`](Self::new).
    pub fn with(mut nominal: Parameters, start_time: f64) -> Result<Self, Error> {
        let mut scene = nominal.scene();
        scene.check()?;
        let tolerance = scene.selection.tolerance();
        let selected = tolerance.map(|tolerance| select(&scene, tolerance));
        if let Some(Selected { method, step, .. }) = selected {
            nominal.set_choice(method, step);
            (scene.method, scene.step) = (method, step);
        }
        let clock = Clock::at(start_time);
        let mut driven = DrivenInputs::of(&scene, &nominal);
        if let Some(driven) = &mut driven {
            driven.bring_to([clock.time(); 2], &nominal, &mut scene, |_| {})?;
        }
        let mut model = LumpedModel::from(&scene);
        let equilibrium = assembly::equilibrium(&scene, &model)?;
        model.count_from(&equilibrium);
        let reference = ReferencePosition { equilibrium, load: model.load.clone() };
        let mut motion = initial_motion(&scene, &model);
        check_closed(&scene, &model, &motion)?;
        check_outside(&scene, &model, &motion)?;
        if scene.effects.energy {
            motion.ledger = Some(Ledger::new(&model, &reference.equilibrium, &motion));
        }
        let made = Self::assemble(scene, nominal, driven, model, reference, motion, clock)?;
        Ok(Self { selected, ..made })
    }

    fn assemble(
        scene: Scene,
        nominal: Parameters,
        driven: Option<DrivenInputs>,
        model: LumpedModel,
        reference: ReferencePosition,
        motion: Motion,
        clock: Clock,
    ) -> Result<Self, Error> {
        check_friction(&model, &scene, clock.time())?;
        let mut guard =
            (scene.method == Method::ForwardIncrement).then(|| StepGuard::new(&model, scene.step));
        if let Some(guard) = &mut guard {
            guard.check(&model)?;
        }
        let records = Records { ledger: scene.effects.energy, visits: false };
        let mut integrator = integrator::choose_recording(&model, scene.method, records)?;
        let mut inputs = Inputs::uniform(vec![0.0; model.dofs()], model.contacts.len(), 0.0, 0.0);
        let numbering = scene.network().map_or_else(Numbering::default, Numbering::of);
        if let Some(driven) = &driven {
            inputs.waves =
                driven.waves(|variable| input_effect(&scene, &numbering, &model, variable));
            integrator.expect_waves(inputs.waves.len());
        }
        let contact_forces = vec![ContactForce::detached(0.0); model.contacts.len()];
        let stale = Stale { inputs: true, limit: false, contact_forces: true };
        Ok(Self {
            monitor: scene.effects.stability.then(StabilityMonitor::default),
            scene,
            nominal,
            driven,
            selected: None,
            model,
            numbering,
            guard,
            integrator,
            reference,
            motion,
            clock,
            inputs,
            contact_forces,
            stale,
        })
    }

    /// Present time, s.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.clock.time()
    }

    /// Returns `true` if two times (s) differ by at most half an internal step, so that they mean the same point of
    /// this run up to rounding.
    #[must_use]
    pub fn same_time(&self, a: f64, b: f64) -> bool {
        Clock::same(a, b, self.scene.step)
    }

    /// The scene with its effective values: the nominal ones plus the present contributions of signals and rates.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The nominal values of parameters and inputs, without the contributions of signals.
    #[must_use]
    pub fn nominal(&self) -> &Parameters {
        &self.nominal
    }

    /// Method and step chosen by the scene's tolerance; `None` if they are given, and after [`resume`](Self::resume),
    /// which keeps the earlier choice.
    #[must_use]
    pub fn selected(&self) -> Option<Selected> {
        self.selected
    }

    /// Displacements from the equilibrium, m, one for each degree of freedom.
    #[must_use]
    pub fn displacement(&self) -> &[f64] {
        &self.motion.displacement
    }

    /// Velocities, m/s, one for each degree of freedom.
    #[must_use]
    pub fn velocity(&self) -> &[f64] {
        &self.motion.velocity
    }

    /// The state of each contact during the last step.
    #[must_use]
    pub fn contact_states(&self) -> &[ContactState] {
        &self.motion.contacts
    }

    /// `true` if signals change an input now or later.
    #[must_use]
    pub fn is_driven_on(&self) -> bool {
        let until = |driven: &DrivenInputs| driven.constant_until(self.time());
        self.driven.as_ref().map_or(f64::INFINITY, until) < f64::INFINITY
    }

    /// The model with the present values of the scene.
    #[must_use]
    pub fn model(&self) -> &LumpedModel {
        &self.model
    }

    /// Position, velocity and contact states now.
    #[must_use]
    pub fn motion(&self) -> &Motion {
        &self.motion
    }

    /// The inputs of the motion at the present instant. Sines that event-driven motion follows are among the waves,
    /// with their phases now; forces and slider velocities include their present values.
    ///
    /// # Errors
    /// Returns an error if signals lead to an impossible value.
    pub fn inputs_now(&mut self) -> Result<&Inputs, Error> {
        let now = self.clock.grid_time(self.scene.step);
        self.stale.inputs = true;
        self.update_inputs([now, now])?;
        if let Some(driven) = &self.driven {
            driven.bring_waves(now, &self.model, &mut self.inputs.waves);
        }
        Ok(&self.inputs)
    }

    /// Adds to the velocity of a degree of freedom, m/s, like an impulse. An energy ledger does not account for it.
    pub fn push(&mut self, dof: usize, velocity: f64) {
        self.motion.velocity[dof] += velocity;
        self.stale.contact_forces = true;
    }

    /// Multiplies displacements from the equilibrium and velocities by a factor. An energy ledger does not account for it.
    pub fn scale_motion(&mut self, factor: f64) {
        let Motion { displacement, velocity, .. } = &mut self.motion;
        displacement.iter_mut().chain(velocity).for_each(|value| *value *= factor);
        self.stale.contact_forces = true;
    }

    /// Multiplies the difference between the displacements and velocities of this motion and those of another motion
    /// of this scene by a factor. The other motion and the contact states do not change.
    pub fn set_apart_from(&mut self, other: &Self, factor: f64) {
        let Motion { displacement, velocity, .. } = &mut self.motion;
        let others = other.motion.displacement.iter().chain(&other.motion.velocity);
        for (value, other) in displacement.iter_mut().chain(velocity).zip(others) {
            *value = other + factor * (*value - other);
        }
        self.stale.contact_forces = true;
    }

    /// Goes on from another motion of this scene, with as many degrees of freedom and contacts, at the present time. Its
    /// counters begin here, and so does its ledger in a scene that requests energy.
    pub fn go_on_from(&mut self, motion: &Motion) {
        let Motion { displacement, velocity, contacts, .. } = motion.clone();
        self.motion = Motion::new(displacement, velocity, contacts);
        if self.scene.effects.energy {
            let ledger = Ledger::new(&self.model, &self.reference.equilibrium, &self.motion);
            self.motion.ledger = Some(ledger);
        }
        self.stale.contact_forces = true;
    }

    /// Counters since the start.
    #[must_use]
    pub fn statistics(&self) -> Statistics {
        self.motion.statistics
    }

    /// The parts of the energy, and the work and dissipation since the start; `None` unless the scene requests energy.
    #[must_use]
    pub fn energy(&self) -> Option<Energy> {
        self.motion.ledger.as_ref().map(|ledger| ledger.energy(&self.model, &self.motion))
    }

    /// The equilibrium from which displacements are measured.
    #[must_use]
    pub fn reference(&self) -> &Equilibrium {
        &self.reference.equilibrium
    }

    /// Begins a log of the contact states that the motion goes through from now on ([`visits`](Self::visits)). It does not
    /// change the motion.
    ///
    /// # Errors
    /// Returns the errors of [`choose_recording`](integrator::choose_recording).
    pub fn record_visits(&mut self) -> Result<(), Error> {
        let records = Records { ledger: self.scene.effects.energy, visits: true };
        self.integrator = integrator::choose_recording(&self.model, self.scene.method, records)?;
        self.integrator.expect_waves(self.inputs.waves.len());
        Ok(())
    }

    /// The contact states since [`record_visits`](Self::record_visits); `None` if it was not called.
    #[must_use]
    pub fn visits(&self) -> Option<&VisitLog> {
        self.integrator.visits()
    }

    /// The work of friction on the masses at each contact, J, counted like the entries of the ledger since the simulation or
    /// its log of visits was made; `None` unless the scene requests energy. The sum of all contacts is slider − friction of
    /// [`energy`](Self::energy).
    #[must_use]
    pub fn friction_work(&self) -> Option<&[f64]> {
        self.integrator.friction_work()
    }

    /// Advances to time `target` (s). Inputs are held, except for the contributions of signals: each step uses their
    /// values at its beginning or, for a slider's velocity, at its end.
    ///
    /// # Errors
    /// Returns an error for a target in the past, a step above the critical one with the present values, a step that
    /// fails or leaves the range of numbers, or signals that lead to an impossible value. The motion must not be used
    /// afterwards.
    pub fn advance_to(&mut self, target: f64) -> Result<(), Error> {
        self.advance(target, CHUNK, || ControlFlow::Continue(())).map(|_| ())
    }

    /// Advances to time `target` (s) like [`advance_to`](Self::advance_to), and asks at intervals whether to
    /// continue. If the answer is `Break`, the motion stops before the target and must not be used afterwards.
    ///
    /// # Errors
    /// Returns the errors of [`advance_to`](Self::advance_to).
    #[allow(clippy::cast_possible_truncation)]
    pub fn advance_while(
        &mut self,
        target: f64,
        go_on: impl FnMut() -> ControlFlow<()>,
    ) -> Result<ControlFlow<()>, Error> {
        let most = (UNASKED / self.model.dofs().max(1) as u64).clamp(1, CHUNK);
        self.advance(target, most, go_on)
    }

    /// Advances to time `target` (s), with up to `most` steps between two calls that ask whether to continue.
    fn advance(
        &mut self,
        target: f64,
        most: u64,
        mut go_on: impl FnMut() -> ControlFlow<()>,
    ) -> Result<ControlFlow<()>, Error> {
        let mut plan = self.plan_to(target)?;
        loop {
            let prepared = self.prepare(&plan).map_err(|error| self.stopped(&error, &plan))?;
            let Some(Steps { count, edge }) = prepared else { break };
            let step = length_to(edge, &plan);
            let count = count.min(most);
            self.integrator.advance(&mut self.motion, &self.inputs, step, count).map_err(
                |failure| {
                    let begun = plan.next_step()[0] - self.time();
                    self.failed(failure.later(begun), target)
                },
            )?;
            if let Some(edge) = edge {
                plan.take_part(edge);
                continue;
            }
            plan.take(count);
            self.check_taken(&plan)?;
            if !plan.is_done() && go_on().is_break() {
                return Ok(ControlFlow::Break(()));
            }
        }
        self.finish_plan(&plan);
        Ok(ControlFlow::Continue(()))
    }

    /// Refuses a time (s) to which this run cannot advance.
    ///
    /// # Errors
    /// Returns an error for a time in the past, or one that is farther ahead than steps can be counted.
    pub fn check_reachable(&self, target: f64) -> Result<(), Error> {
        match self.clock.plan_to(target, self.scene.step) {
            Some(_) => Ok(()),
            None => Err(self.unreachable(target)),
        }
    }

    /// The steps to time `target` (s).
    fn plan_to(&mut self, target: f64) -> Result<StepPlan, Error> {
        let plan = self.clock.plan_to(target, self.scene.step);
        let plan = plan.ok_or_else(|| self.unreachable(target))?;
        if !plan.is_done() {
            self.begin_rates(plan.arrival.grid_time(self.scene.step))?;
        }
        Ok(plan)
    }

    /// Brings everything up to date for the next steps of a plan. Returns the steps that can be taken without another
    /// update, if any are left.
    fn prepare(&mut self, plan: &StepPlan) -> Result<Option<Steps>, Error> {
        if plan.is_done() {
            return Ok(None);
        }
        let mut count = plan.left();
        let mut edge = None;
        // For most short steps nothing has changed.
        if self.driven.is_some() || self.stale.inputs || self.stale.limit {
            let [time, end] = plan.next_step();
            edge = self.driven.as_ref().and_then(|driven| driven.edge_between(time, end));
            let end = edge.unwrap_or(end);
            self.update_inputs([time, end])?;
            self.update_rates([time, end], length_to(edge, plan));
            self.check_limit(time)?;
            if let Some(driven) = &self.driven {
                let is_part = edge.is_some() || plan.is_within();
                count = if is_part { 1 } else { plan.steps_before(driven.constant_until(time)) };
            }
        }
        Ok(Some(Steps { count: count.min(CHUNK - plan.done % CHUNK), edge }))
    }

    /// Checks at intervals, and at the end, that the motion is finite.
    fn check_taken(&self, plan: &StepPlan) -> Result<(), Error> {
        if plan.done.is_multiple_of(CHUNK) || plan.is_done() {
            self.check_finite(plan.arrival.time())?;
        }
        Ok(())
    }

    fn finish_plan(&mut self, plan: &StepPlan) {
        self.clock = plan.arrival;
        if plan.done > 0 {
            self.end_rates();
        }
        self.stale.contact_forces = true;
    }

    /// Present state and forces of every contact.
    ///
    /// # Errors
    /// Returns an error if the contacts are coupled in a way that has no solution.
    pub fn contact_forces(&mut self) -> Result<&[ContactForce], Error> {
        if self.stale.contact_forces {
            let now = self.clock.grid_time(self.scene.step);
            // An impossible value of a signal is reported by the next step.
            let _ = self.update_inputs([now, now]);
            if let Some(driven) = &self.driven {
                for (i, acceleration) in self.inputs.slider_acceleration.iter_mut().enumerate() {
                    *acceleration = driven.slider_acceleration(now, i);
                }
            }
            self.integrator
                .contact_forces(&self.motion, &self.inputs, &mut self.contact_forces)
                .map_err(|failure| self.failed(failure, self.time()))?;
            self.stale.contact_forces = false;
        }
        Ok(&self.contact_forces)
    }

    /// Brings drive and damping up to date for a step between these times (s). The drive is the change of the load
    /// since the reference, the contact forces that balanced it there, and the external forces; at the reference only
    /// the contacts' part is not zero.
    fn update_inputs(&mut self, span: [f64; 2]) -> Result<(), Error> {
        let stale = &mut self.stale;
        let brought = match &mut self.driven {
            Some(driven) => {
                let scene = &mut self.scene;
                driven.bring_to(span, &self.nominal, scene, |variable| stale.by(variable))
            }
            None => Ok(()),
        };
        if !std::mem::replace(&mut stale.inputs, false) {
            return brought;
        }
        let scene = &self.scene;
        assembly::load(scene, &self.numbering, &mut self.model.load);
        let loads = self.model.load.iter().zip(&self.reference.load);
        let force = self.inputs.force.iter_mut().zip(scene.external_forces());
        for ((force, external), (now, then)) in force.zip(loads) {
            *force = (now - then) + external;
        }
        let Equilibrium { normal_force, friction_force, .. } = &self.reference.equilibrium;
        let balanced = normal_force.iter().zip(friction_force);
        for (contact, (normal, friction)) in self.model.contacts.iter().zip(balanced) {
            contact.normal.add_to(&mut self.inputs.force, -normal);
            contact.tangent.add_to(&mut self.inputs.force, -friction);
        }
        assembly::update_contacts(&mut self.model, scene);
        for (i, contact) in self.model.contacts.iter().enumerate() {
            self.inputs.slider_velocity[i] = contact.surface_velocity;
            let rubs = self.model.rubs(contact);
            self.inputs.friction[i] = if rubs { contact.friction } else { Friction::from(0.0) };
        }
        self.model.damping = scene.damping;
        self.integrator.set_damping(scene.damping);
        brought
    }

    /// Brings the rates of change during a step between these times (s) up to date.
    fn update_rates(&mut self, span: [f64; 2], step: f64) {
        let Some(driven) = &self.driven else { return };
        let model = &self.model;
        driven.bring_waves(span[0], model, &mut self.inputs.waves);
        self.inputs.friction_rate.fill([0.0; 2]);
        for (changes, rate) in driven.friction_rates(span[0]) {
            for &(contact, change) in changes {
                if model.rubs(&model.contacts[contact]) {
                    let own = &mut self.inputs.friction_rate[contact];
                    *own = [0, 1].map(|part| own[part] + change[part] * rate);
                }
            }
        }
        for (i, acceleration) in self.inputs.slider_acceleration.iter_mut().enumerate() {
            *acceleration = driven.slider_change(span, i) / step;
        }
        let (scene, numbering) = (&self.scene, &self.numbering);
        self.inputs.force_rate.fill(0.0);
        for (variable, rate) in driven.load_rates(span[0]) {
            let force_rate = &mut self.inputs.force_rate;
            if variable.template.quantity == Quantity::Preload {
                assembly::add_preload(scene, numbering, variable.index, rate, force_rate);
            } else {
                force_rate[dof(scene, numbering, variable)] += rate;
            }
        }
    }

    /// Refuses a step that the present values make impossible.
    fn check_limit(&mut self, time: f64) -> Result<(), Error> {
        if self.stale.limit {
            let scene = &self.scene;
            assembly::update_contacts(&mut self.model, scene);
            check_friction(&self.model, scene, time)?;
            if let Some(guard) = &mut self.guard {
                guard.check(&self.model).map_err(|error| limit_left(scene, time, &error))?;
            }
        }
        self.stale.limit = false;
        Ok(())
    }

    fn check_finite(&self, target: f64) -> Result<(), Error> {
        if are_finite(&self.motion.displacement) && are_finite(&self.motion.velocity) {
            return Ok(());
        }
        Err(self.left_range(target))
    }
}

/// Returns `true` if all values are finite. The test has no branch for each value, which would slow short steps down:
/// the product of a value and zero is zero, of either sign, only for a finite value.
fn are_finite(values: &[f64]) -> bool {
    values.iter().fold(0, |any, value| any | (value * 0.0).to_bits()) << 1 == 0
}

/// The degree of freedom whose displacement or velocity a variable is; `None` for variables of other quantities.
#[must_use]
pub fn dof_of(scene: &Scene, variable: &Variable) -> Option<usize> {
    matches!(variable.template.quantity, Quantity::Displacement | Quantity::Velocity).then(|| {
        let numbering = scene.network().map(Numbering::of).unwrap_or_default();
        dof(scene, &numbering, variable)
    })
}

/// The degree of freedom to which a variable belongs.
fn dof(scene: &Scene, numbering: &Numbering, variable: &Variable) -> usize {
    let (index, component) = (variable.index, variable.template.component);
    // Locked degrees of freedom, and those that a node does not have, have no variables.
    match &scene.structure {
        Structure::Ring(_) => MODULE_DOFS * index + component,
        Structure::Network(network) => match superelement_row(network, variable.template, index) {
            Some((superelement, row)) => numbering.row(superelement, row).unwrap_or(0),
            None => numbering.dof(index, component).unwrap_or(0),
        },
    }
}

/// Steps that can be taken without an update in between.
struct Steps {
    count: u64,
    /// Time of a signal's edge within the first of them, at which event-driven motion stops, s.
    edge: Option<f64>,
}

/// Length (s) of the next step of a plan, or of its part up to an edge.
fn length_to(edge: Option<f64>, plan: &StepPlan) -> f64 {
    let [time, end] = plan.next_step();
    match edge {
        Some(edge) => edge - time,
        None if plan.is_within() => end - time,
        None => plan.step,
    }
}

/// The degrees of freedom and contacts on which an input acts.
fn input_effect(
    scene: &Scene,
    numbering: &Numbering,
    model: &LumpedModel,
    variable: &Variable,
) -> InputEffect {
    let pushes = match variable.template.quantity {
        Quantity::ExternalForce => vec![(dof(scene, numbering, variable), 1.0)],
        Quantity::Preload => {
            let mut force = vec![0.0; model.dofs()];
            assembly::add_preload(scene, numbering, variable.index, 1.0, &mut force);
            force.into_iter().enumerate().filter(|(_, force)| *force != 0.0).collect()
        }
        _ => Vec::new(),
    };
    InputEffect { pushes, moves: moved_contacts(scene, variable) }
}

/// Error message for values that have made the step too long; the step itself may be fixed by now.
fn limit_left(scene: &Scene, time: f64, error: &Error) -> Error {
    let (friction, damping) = (scene.friction_coefficient, scene.damping);
    let damping = match damping.beta {
        0.0 => String::new(),
        beta => format!(" and damping.beta = {beta:?}"),
    };
    let with = format!("with friction.coefficient = {friction:?}{damping}");
    error.in_words(format!("at {} s, {with}, {error}", Short(time)))
}

/// Refuses a static friction coefficient that inputs or signals have brought below the kinetic one.
fn check_friction(model: &LumpedModel, scene: &Scene, time: f64) -> Result<(), Error> {
    for (i, contact) in model.contacts.iter().enumerate() {
        let Friction { kinetic, static_, .. } = contact.friction;
        // Equal sums of signals differ by rounding.
        if static_ < kinetic * (1.0 - 1e-12) {
            return Err(Error::step(format!(
                "at {} s the static friction coefficient of {} is {}, below its kinetic one of {}; raise it, or lower the \
                 kinetic one",
                Short(time),
                scene.contact_name(i),
                Short(static_),
                Short(kinetic)
            )));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_number_that_is_not_finite_is_found_among_many() {
        let mut values = vec![0.0, -0.0, 1.0, -1.0, f64::MAX, f64::MIN, f64::MIN_POSITIVE, 5e-324];
        assert!(are_finite(&values) && are_finite(&[]));
        for place in 0..values.len() {
            for bad in [f64::INFINITY, f64::NEG_INFINITY, f64::NAN, -f64::NAN] {
                let good = std::mem::replace(&mut values[place], bad);
                assert!(!are_finite(&values), "{bad} at {place}");
                values[place] = good;
            }
        }
    }
}
