//! A run under the eyes of a judge: what is derived from its trajectory alone.
//!
//! M, C, K, the load and the directions of the contacts are the model's; forces come from Newton's
//! law on the masses, and the law of contact from `contact::residual`. No result of an integrator is
//! taken for granted but positions and velocities.

pub mod blocks;
mod exact;
mod let_off;
mod reduced;
mod rule;
mod scheme;
mod singular;

pub use exact::Change;
pub use let_off::LetOff;

use amontons::Error;
use amontons::assembly::{self, Numbering};
use amontons::contact::residual::{Instant, Scales, Violation};
use amontons::contact::{ContactForce, ContactState, Friction};
use amontons::integrator::Statistics;
use amontons::model::{self, LumpedModel};
use amontons::scene::{Method, Scene, Shape, Signal, Sine, parse};
use amontons::simulation::{Simulation, Snapshot, Variable, variables, write_scene};
use nalgebra::{DMatrix, DVector};
use reduced::residual_under;
use std::f64::consts::TAU;

/// The integrators; every case is run with each of them, unless it says why not.
pub const METHODS: [Method; 2] = [Method::ForwardIncrement, Method::EventDriven];

/// Tolerance of a result: for the paper's scheme, of first order, `first`, which is proportional to its step and
/// derived beside each case; for the event-driven integrator `rounding`.
pub fn off(method: Method, first: f64, rounding: f64) -> f64 {
    match method {
        Method::ForwardIncrement => first,
        Method::EventDriven => rounding,
    }
}

/// Rounding: a sum of terms is off by this part of the largest.
const ROUNDING: f64 = 1e-13;

/// A run that is watched at every internal step.
pub struct Run {
    pub simulation: Simulation,
    pub model: LumpedModel,
    pub method: Method,
    /// Steps taken.
    pub steps: u64,
    /// The time that was reached, and how long the last step was, s.
    reached: f64,
    length: f64,
    /// Displacements from the equilibrium, m, and velocities, m/s, now and a step before.
    pub now: [DVector<f64>; 2],
    pub before: [DVector<f64>; 2],
    /// Names of the degrees of freedom.
    names: Vec<String>,
    mass: DMatrix<f64>,
    inverse_mass: DMatrix<f64>,
    pub stiffness: DMatrix<f64>,
    damping: DMatrix<f64>,
    /// Gᵀ: normal and tangent of each contact, by columns.
    directions: DMatrix<f64>,
    /// The gap of each contact in the equilibrium, m.
    apart: Vec<f64>,
    /// The forces (N, T) that fit a sum of contact forces, where those of all contacts follow from it.
    fit: Option<DMatrix<f64>>,
    signals: Vec<(Variable, Signal)>,
    acting: Scene,
    numbering: Numbering,
    scales: Scales,
    /// Missing the law by less than this part of the scales is forgiven: rounding of masses and stiffnesses that
    /// differ by many orders of magnitude.
    forgiven: f64,
    /// Forces that were reported when the last step began.
    reported: Option<Vec<ContactForce>>,
    /// `true` if closed contacts have a gap of exactly zero.
    is_exact: bool,
    /// Tolerance of contacts that are not exact, as a part of the scales, and that of the gap, m.
    drift: f64,
    gap_drift: f64,
    /// The step that was judged last.
    judged: u64,
    /// State of the simulation when the last step began.
    start: Option<(Snapshot, Vec<ContactState>, Statistics)>,
    /// The present instant, measured from the end of the step, s, and `true` if a contact state ends there.
    at: (f64, bool),
    /// Time for which the contact states continue from there, s, if it is known.
    lasts: f64,
    /// The highest frequency of the masses on their own springs, 1/s.
    fastest: f64,
    memory: exact::Memory,
    /// The changes of state in the last step that was judged, and the spans of time between them, s from
    /// the beginning of the step; known for exact motion.
    pub changes: Vec<Change>,
    segments: Vec<[f64; 2]>,
    /// Counts of the events that could not be judged so far.
    pub let_off: LetOff,
}

/// The actions on the masses at one time.
pub struct Acting {
    /// Load and external forces, N, one value for each degree of freedom.
    pub force: DVector<f64>,
    /// Velocities of the sliders, m/s, one value for each contact.
    pub slider_velocity: Vec<f64>,
    /// Friction coefficients, one pair for each contact.
    pub friction: Vec<Friction>,
}

impl Run {
    pub fn new(scene: Scene, method: Method) -> Self {
        Self::of(Simulation::new(Scene { method, ..scene }, 0.0).unwrap())
    }

    pub fn of(simulation: Simulation) -> Self {
        let scene = simulation.nominal().scene();
        let method = scene.method;
        let mut model = LumpedModel::from(&scene);
        let (n, contacts) = (model.dofs(), model.contacts.len());
        let all = variables(&scene);
        let dense = |m: &model::SparseMatrix| DMatrix::from_fn(n, n, |i, j| m.get(i, j));
        let (mass, stiffness) = (dense(&model.mass), dense(&model.stiffness));
        let damping = &mass * model.damping.alpha
            + &stiffness * model.damping.beta
            + if model.dampers.is_empty() { DMatrix::zeros(n, n) } else { dense(&model.dampers) };
        let mut directions = DMatrix::zeros(n, 2 * contacts);
        for (i, contact) in model.contacts.iter().enumerate() {
            for (column, direction) in [(2 * i, &contact.normal), (2 * i + 1, &contact.tangent)] {
                direction.0.iter().for_each(|&(dof, value)| directions[(dof, column)] = value);
            }
        }
        let apart = simulation.reference().gap.clone();
        let determined = contacts > 0 && singular::rank(&directions, 1e-9) == 2 * contacts;
        let fit = determined.then(|| singular::pseudo_inverse(&directions, 1e-9));
        let signals = scene.signals.iter().map(|signal| {
            let input = all.iter().find(|variable| variable.name == signal.input).unwrap();
            (input.clone(), signal.clone())
        });
        let signals: Vec<(Variable, Signal)> = signals.collect();
        let largest = |values: &[f64]| values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let reference = simulation.reference();
        let force = largest(&model.load).max(largest(&reference.normal_force));
        let springs = stiffness.diagonal().iter().copied().fold(0.0, f64::max);
        let contacts = model.contacts.iter();
        let velocity = contacts.map(|contact| contact.surface_velocity.abs());
        let mut velocity = velocity.fold(f64::MIN_POSITIVE, f64::max);
        // Contacts between masses close to the tolerance of the multipliers, a force: of ẋ = F/√(km).
        let is_exact = model.contacts.iter().all(|contact| {
            contact.normal.as_unit().is_some() && contact.tangent.as_unit().is_some()
        });
        if !is_exact {
            let lightest = mass.diagonal().iter().copied().fold(f64::MAX, f64::min);
            velocity = velocity.max(force / (springs * lightest).sqrt());
        }
        let scales = Scales { length: force / springs, velocity, force };
        // The unloaded position and the displacement to the equilibrium give the same gaps.
        let place = DVector::from_column_slice(&reference.displacement);
        for (i, contact) in model.contacts.iter().enumerate() {
            let normal = directions.column(2 * i);
            let terms = contact.gap + normal.abs().dot(&place.abs()) + scales.length;
            assert!((contact.gap + normal.dot(&place) - apart[i]).abs() <= 1e-6 * terms);
        }
        model.count_from(reference);
        let zero = || [DVector::zeros(n), DVector::zeros(n)];
        let mut run = Self {
            simulation,
            fastest: exact::fastest(&model),
            start: None,
            at: (0.0, false),
            lasts: f64::INFINITY,
            memory: exact::Memory::default(),
            changes: Vec::new(),
            segments: Vec::new(),
            let_off: LetOff::default(),
            model,
            method,
            steps: 0,
            reached: 0.0,
            length: scene.step,
            now: zero(),
            before: zero(),
            names: scene.dof_names(),
            inverse_mass: mass.clone().try_inverse().unwrap(),
            mass,
            stiffness,
            damping,
            directions,
            apart,
            fit,
            signals,
            numbering: scene.network().map_or_else(Numbering::default, Numbering::of),
            acting: scene,
            scales,
            forgiven: 0.0,
            reported: None,
            is_exact,
            drift: 0.0,
            gap_drift: 0.0,
            judged: 0,
        };
        run.read();
        run.before = run.now.clone();
        run
    }

    /// Forgives missing the law by less than this part of the scales, which then are those of the largest motion so
    /// far.
    pub fn forgive(&mut self, part: f64) {
        self.forgiven = part;
        self.widen();
    }

    /// Takes over larger forces and displacements as scales.
    fn widen(&mut self) {
        let [x, v] = &self.now;
        let force = (&self.stiffness * x).amax().max((&self.damping * v).amax());
        let force = force.max(self.outer_force().amax());
        self.scales.force = self.scales.force.max(force).max(f64::MIN_POSITIVE);
        let strained = self.scales.force / self.stiffness.diagonal().amax();
        self.scales.length = self.scales.length.max(x.amax()).max(strained);
    }

    /// Length of the last step, s: an internal one, or a part of one.
    pub fn h(&self) -> f64 {
        self.length
    }

    pub fn time(&self) -> f64 {
        self.reached
    }

    pub(super) fn internal_step(&self) -> f64 {
        self.acting.step
    }

    /// Distance from an edge of a signal below which a time counts as the edge, s, as in the simulation.
    fn slack(&self) -> f64 {
        (1e-6 * self.internal_step()).min(1e-9)
    }

    /// The displacement and velocity of a degree of freedom, `mass.block.x`.
    pub fn of_dof(&self, name: &str) -> [f64; 2] {
        let dof = self.names.iter().position(|other| other == name).unwrap();
        [self.now[0][dof], self.now[1][dof]]
    }

    /// Reads positions and velocities. The fastest so far, or the slider, is the scale of velocities.
    fn read(&mut self) {
        let simulation = &self.simulation;
        let place = [simulation.displacement(), simulation.velocity()];
        self.now = place.map(DVector::from_column_slice);
        self.scales.velocity = self.scales.velocity.max(self.now[1].amax());
        if self.forgiven > 0.0 {
            self.widen();
        }
    }

    /// One internal step.
    pub fn step(&mut self) {
        self.jump(1);
    }

    /// Takes several internal steps; `before` is where the last one begins.
    pub fn jump(&mut self, count: u64) {
        self.try_jump(count).unwrap();
    }

    /// Takes several internal steps, or returns the error of one whose contact forces are not found.
    pub fn try_jump(&mut self, count: u64) -> Result<(), Error> {
        if count > 1 {
            self.reported = None;
            self.steps += count - 1;
            self.simulation.advance_to(self.steps as f64 * self.internal_step())?;
            self.read();
        }
        self.steps += 1;
        let start = (self.steps - 1) as f64 * self.internal_step();
        self.try_step(start, self.steps as f64 * self.internal_step())
    }

    /// One internal step, parted where exact motion meets an edge of a signal, for what drives it is smooth over the
    /// parts alone. `judge` judges each part.
    pub fn try_parts(&mut self, mut judge: impl FnMut(&mut Self)) -> Result<(), Error> {
        self.steps += 1;
        let end = self.steps as f64 * self.internal_step();
        loop {
            let time = self.time();
            let slack = self.slack();
            let edges = self.signals.iter().map(|(_, signal)| signal.shape.next_edge(time, slack));
            let edge = edges.fold(f64::INFINITY, f64::min);
            let is_parted = self.method == Method::EventDriven && edge + slack < end;
            self.try_step(time, if is_parted { edge } else { end })?;
            judge(self);
            if !is_parted {
                return Ok(());
            }
        }
    }

    /// A step from one time to another, s.
    fn try_step(&mut self, from: f64, to: f64) -> Result<(), Error> {
        // A whole step has its length to the last digit.
        let step = self.internal_step();
        let is_whole = ((to - from) / step - 1.0).abs() < 1e-6;
        (self.length, self.reached) = (if is_whole { step } else { to - from }, to);
        let states = self.simulation.contact_states().to_vec();
        self.start = Some((self.simulation.save(), states, self.simulation.statistics()));
        std::mem::swap(&mut self.now, &mut self.before);
        self.simulation.advance_to(to)?;
        self.read();
        self.simulation.contact_forces()?;
        Ok(())
    }

    /// The states that the integrator reports.
    pub fn states(&mut self) -> Vec<ContactState> {
        self.forces().iter().map(|force| force.state).collect()
    }

    /// The contact forces that the integrator reports.
    pub fn forces(&mut self) -> Vec<ContactForce> {
        self.simulation.contact_forces().unwrap().to_vec()
    }

    /// The actions in the step that begins at `time`, as the paper's scheme takes them: the velocity of a slider is
    /// that of the step's end.
    pub fn acting(&mut self, time: f64) -> Acting {
        self.acting_at([time, time + self.h()])
    }

    /// The actions: the velocities of sliders at the second time, all else at the first.
    fn acting_at(&mut self, times: [f64; 2]) -> Acting {
        let slack = self.slack();
        let is_exact = self.method == Method::EventDriven;
        self.drive(|signal, is_velocity| {
            let t = times[usize::from(is_velocity)];
            // Up to an edge, exact motion continues as before the edge.
            signal.shape.onward(if is_exact { times[0] } else { t }, t, slack)
        });
        let force = self.outer_force();
        let contacts = &self.model.contacts;
        let has_fixed_state = self.model.law.has_fixed_state();
        let friction = |contact: &model::Contact| {
            // A direction that is frozen is that of the surface; one that stands still has none.
            let stands = has_fixed_state && contact.surface_velocity == 0.0;
            if stands { Friction::from(0.0) } else { contact.friction }
        };
        Acting {
            force,
            slider_velocity: contacts.iter().map(|contact| contact.surface_velocity).collect(),
            friction: contacts.iter().map(friction).collect(),
        }
    }

    /// Load, preloads and external forces that act, N.
    fn outer_force(&self) -> DVector<f64> {
        let mut force = vec![0.0; self.model.dofs()];
        assembly::load(&self.acting, &self.numbering, &mut force);
        let external = self.acting.external_forces();
        DVector::from_iterator(force.len(), force.iter().zip(external).map(|(a, b)| a + b))
    }

    /// Rates of the external forces and of the velocities of the sliders from `time` on, N/s and m/s², without those of
    /// sines.
    fn rates(&mut self, time: f64) -> [DVector<f64>; 2] {
        let contacts = self.model.contacts.len();
        let slack = self.slack();
        let [with, without] = [1.0, 0.0].map(|part| {
            self.drive(|signal, _| match &signal.shape {
                Shape::Sine(_) => 0.0,
                shape => part * shape.rate(time, slack),
            });
            let velocities = self.model.contacts.iter().map(|contact| contact.surface_velocity);
            [self.outer_force(), DVector::from_iterator(contacts, velocities)]
        });
        let [force, velocity] = with;
        [force - &without[0], velocity - &without[1]]
    }

    /// The sines of forces and slider velocities that act from `time` on.
    fn swings(&mut self, time: f64) -> Vec<exact::Swing> {
        let slack = self.slack();
        let sines: Vec<(Signal, Sine)> = self
            .signals
            .iter()
            .filter_map(|(_, signal)| match signal.shape {
                Shape::Sine(sine) if sine.is_on(time + slack) => Some((signal.clone(), sine)),
                _ => None,
            })
            .collect();
        let swing = |(driving, sine): (Signal, Sine)| {
            let [with, without] = [1.0, 0.0].map(|part| {
                self.drive(|signal, _| if *signal == driving { part } else { 0.0 });
                let velocities = self.model.contacts.iter().map(|contact| contact.surface_velocity);
                let moves = DVector::from_iterator(self.model.contacts.len(), velocities);
                (self.outer_force(), moves)
            });
            let phase = sine.phase_at(time);
            exact::Swing {
                pulsation: TAU * sine.frequency,
                start: [phase.sin(), phase.cos()].map(|part| sine.amplitude * part),
                pushes: with.0 - without.0,
                moves: with.1 - without.1,
            }
        };
        sines.into_iter().map(swing).collect()
    }

    /// Adds to the inputs that have signals.
    fn drive(&mut self, added: impl Fn(&Signal, bool) -> f64) {
        if self.signals.is_empty() {
            return;
        }
        let mut acting = self.simulation.nominal().clone();
        for (input, signal) in &self.signals {
            let sum = acting.get(input).unwrap() + added(signal, input.name.ends_with("velocity"));
            acting.set(input, sum).unwrap();
        }
        self.acting = acting.scene();
        assembly::update_contacts(&mut self.model, &self.acting);
    }

    /// Displacements from the unloaded position.
    pub fn total(&self, displacement: &DVector<f64>) -> DVector<f64> {
        displacement + DVector::from_column_slice(&self.simulation.reference().displacement)
    }

    /// Gap, opening velocity and slip velocity of a contact.
    fn kinematics(&self, contact: usize, slider_velocity: f64) -> [f64; 3] {
        let [x, v] = &self.now;
        let normal = self.directions.column(2 * contact);
        let tangent = self.directions.column(2 * contact + 1);
        [self.gap(contact, x), normal.dot(v), slider_velocity - tangent.dot(v)]
    }

    /// The gap of a contact at these displacements from the equilibrium, m.
    pub fn gap(&self, contact: usize, displacement: &DVector<f64>) -> f64 {
        self.apart[contact] + self.directions.column(2 * contact).dot(displacement)
    }

    fn law(&self, surface: f64, instant: &Instant, friction: Friction) -> Violation {
        residual_under(self.model.law, surface, instant, friction, &self.scales)
    }

    /// Was a contact open, by more than rounding, when the last step began?
    fn was_open(&self, contact: usize) -> bool {
        self.gap(contact, &self.before[0]) > 1e-12 * self.scales.length
    }

    /// The opening velocity of a contact (m/s) at the end of a step of the scheme, which has the mean velocity over the way to the
    /// surface in the step that a contact lands in.
    fn without_landing(&self, contact: usize, opening: f64) -> f64 {
        let gap_before = self.gap(contact, &self.before[0]);
        if self.was_open(contact) { 0.0 } else { opening + gap_before.max(0.0) / self.h() }
    }

    /// Did a contact land in the last step?
    pub fn has_landed(&self) -> bool {
        let is_open = |contact: usize| self.gap(contact, &self.now[0]) > 1e-12 * self.scales.length;
        (0..self.model.contacts.len()).any(|i| self.was_open(i) && !is_open(i))
    }

    /// Judges the last step. Returns the forces (N, T) of the contacts over it, where they follow from
    /// the motion.
    #[track_caller]
    pub fn judge_step(&mut self) -> Option<Vec<[f64; 2]>> {
        match self.method {
            Method::ForwardIncrement => self.judge_scheme_step(),
            Method::EventDriven => {
                self.judge_exact_step();
                None
            }
        }
    }

    /// Judges what the integrator reports now by the same law, with the motion of now. Where the
    /// slider's velocity has changed since the last step, the motion is not that of the law yet.
    #[track_caller]
    pub fn judge_report(&mut self) {
        if self.method == Method::EventDriven {
            return self.judge_exact_report();
        }
        let time = self.time();
        let old = self.acting(time - self.h());
        let acting = self.acting(time);
        if old.slider_velocity != acting.slider_velocity {
            return;
        }
        for (i, force) in self.forces().into_iter().enumerate() {
            let [gap, mut gap_velocity, slip_velocity] =
                self.kinematics(i, acting.slider_velocity[i]);
            gap_velocity = self.without_landing(i, gap_velocity);
            let (normal_force, friction_force) = (force.normal_force, force.friction_force);
            let instant =
                Instant { gap, gap_velocity, slip_velocity, normal_force, friction_force };
            let sticks = force.state == ContactState::Stick;
            let friction = self.friction_at(acting.friction[i], slip_velocity, sticks);
            let found = self.law(acting.slider_velocity[i], &instant, friction);
            assert!(
                found.size <= 1e-11 + self.drift + self.forgiven,
                "contact {i} reports at {time} s: {found}; {instant:?} {force:?}"
            );
            let off = (force.slip_velocity - slip_velocity).abs();
            let drift = (self.drift + self.forgiven) * self.scales.velocity;
            let allowed = 1e-12 * self.now[1].amax().max(1.0) + drift;
            assert!(off <= allowed, "{force:?} {instant:?}, allowed {allowed:e}");
        }
        self.reported = Some(self.forces());
    }

    /// Steps on until `end` (s), each step judged, what is reported judged as well.
    #[track_caller]
    pub fn judged_until(&mut self, end: f64) {
        while self.time() < end - 0.5 * self.h() {
            self.step();
            self.judge_step();
            self.judge_report();
        }
    }

    /// Energy that the loads put into the stiffest spring, J.
    #[allow(dead_code, reason = "random scenes alone are measured by it")]
    pub fn energy_at_rest(&self) -> f64 {
        let force = self.scales.force.max(self.outer_force().amax());
        force * force / self.stiffness.diagonal().amax()
    }

    /// Kinetic and elastic energy, J; the load is no part of it.
    pub fn energy(&self) -> f64 {
        let [x, v] = &self.now;
        let x = self.total(x);
        0.5 * v.dot(&(&self.mass * v)) + 0.5 * x.dot(&(&self.stiffness * &x))
    }

    pub fn damping_power(&self) -> f64 {
        self.power_of_damping(&self.now[1])
    }

    pub fn power_of_damping(&self, velocity: &DVector<f64>) -> f64 {
        velocity.dot(&(&self.damping * velocity))
    }
}

/// The scene of a text.
pub fn scene(text: &str) -> Scene {
    parse("case", text).unwrap()
}

/// Gives an input or parameter of a scene another value.
pub fn assign(scene: &mut Scene, name: &str, value: f64) {
    let variable = variables(scene).into_iter().find(|variable| variable.name == name);
    let variable = variable.unwrap_or_else(|| panic!("{} has no {name}", scene.name));
    write_scene(scene, &variable, value).unwrap();
    scene.check().unwrap();
}

/// A scene's input or parameter with another value.
pub fn with(mut scene: Scene, values: &[(&str, f64)]) -> Scene {
    for (name, value) in values {
        assign(&mut scene, name, *value);
    }
    scene
}

/// Asserts that a value is as near to the expected one as told.
#[track_caller]
pub fn assert_near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} is not {expected} ± {tolerance:e}");
}
