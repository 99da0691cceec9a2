//! A run under the eyes of a judge: what is derived from its trajectory alone.
//!
//! M, C, K, the load and the directions of the contacts are the model's; forces come from Newton's
//! law on the masses, and the law of contact from `contact::residual`. No result of an integrator is
//! taken for granted but positions and velocities.

// Each test program uses a part of it.
#![allow(dead_code)]

use amontons::contact::residual::{Instant, Scales, Violation, residual};
use amontons::contact::{ContactForce, ContactState, Friction};
use amontons::integrator::{Integrator, SparseForwardIncrement};
use amontons::model::LumpedModel;
use amontons::scene::{Scene, Signal, parse};
use amontons::simulation::catalogue::Quantity;
use amontons::simulation::{Simulation, Variable, assign, variables, write_scene};
use nalgebra::{DMatrix, DVector};

/// The integrators; every case is run with each of them.
pub const METHODS: [Method; 1] = [Method::ForwardIncrement];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    ForwardIncrement,
}

impl Method {
    /// The scene, to be run with this integrator.
    pub fn scene(self, text: &str) -> Scene {
        let scene = parse("case", text).unwrap();
        match self {
            Self::ForwardIncrement => scene,
        }
    }

    /// The integrator alone, for a model that no scene makes.
    pub fn integrator(self, model: &LumpedModel) -> Box<dyn Integrator> {
        match self {
            Self::ForwardIncrement => Box::new(SparseForwardIncrement::new(model).unwrap()),
        }
    }

    /// What a result may be off: an integrator of first order by `first`, which is proportional to
    /// its step and derived beside each case.
    pub fn off(self, first: f64) -> f64 {
        match self {
            Self::ForwardIncrement => first,
        }
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
    /// Displacements from the equilibrium, m, and velocities, m/s, now and a step before.
    pub now: [DVector<f64>; 2],
    pub before: [DVector<f64>; 2],
    variables: [Vec<Variable>; 2],
    mass: DMatrix<f64>,
    pub stiffness: DMatrix<f64>,
    damping: DMatrix<f64>,
    /// Gᵀ: normal and tangent of each contact, by columns.
    directions: DMatrix<f64>,
    /// The forces (N, T) that fit a sum of contact forces, where those of all contacts follow from it.
    fit: Option<DMatrix<f64>>,
    signals: Vec<(Variable, Signal)>,
    acting: Scene,
    scales: Scales,
    /// What was reported when the last step began.
    reported: Option<Vec<ContactForce>>,
    /// Do closed contacts have a gap of exactly zero?
    is_exact: bool,
    /// Else, how much is forgiven as a part of the scales, and the gap of it, m.
    drift: f64,
    gap_drift: f64,
    /// The step that was judged last.
    judged: u64,
}

/// What acts at one time.
pub struct Acting {
    /// N, one a degree of freedom: the load and the external forces.
    pub force: DVector<f64>,
    /// m/s, one a contact.
    pub slider_velocity: Vec<f64>,
    /// Friction coefficients, one pair a contact.
    pub friction: Vec<Friction>,
}

impl Run {
    pub fn new(scene: Scene, method: Method) -> Self {
        let simulation = Simulation::new(scene, 0.0).unwrap();
        Self::of(simulation, method)
    }

    pub fn of(simulation: Simulation, method: Method) -> Self {
        let scene = simulation.scene().clone();
        let model = LumpedModel::from(&scene);
        let (n, contacts) = (model.dofs(), model.contacts.len());
        let all = variables(&scene);
        let of = |quantity| -> Vec<Variable> {
            all.iter().filter(|v| v.template.quantity == quantity).cloned().collect()
        };
        // By mass or module, then by axis: the order of the degrees of freedom.
        let by_dof = |quantity| {
            let mut found = of(quantity);
            found.sort_by_key(|variable| (variable.index, variable.template.component));
            assert_eq!(found.len(), n);
            found
        };
        let dense = |m: &amontons::model::SparseMatrix| DMatrix::from_fn(n, n, |i, j| m.get(i, j));
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
        let determined = contacts > 0 && directions.rank(1e-9) == 2 * contacts;
        let fit = determined.then(|| directions.clone().pseudo_inverse(1e-9).unwrap());
        let signals = scene.signals.iter().map(|signal| {
            let input = all.iter().find(|variable| variable.name == signal.input).unwrap();
            (input.clone(), signal.clone())
        });
        let signals = signals.collect();
        let largest = |values: &[f64]| values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let reference = simulation.reference();
        let force = largest(&model.load).max(largest(&reference.normal_force));
        let springs = stiffness.diagonal().iter().copied().fold(0.0, f64::max);
        let contacts = model.contacts.iter();
        let velocity = contacts.map(|contact| contact.velocity(scene.slider.velocity).abs());
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
        let variables = [by_dof(Quantity::Displacement), by_dof(Quantity::Velocity)];
        let zero = || [DVector::zeros(n), DVector::zeros(n)];
        let mut run = Self {
            simulation,
            model,
            method,
            steps: 0,
            now: zero(),
            before: zero(),
            variables,
            mass,
            stiffness,
            damping,
            directions,
            fit,
            signals,
            acting: scene,
            scales,
            reported: None,
            is_exact,
            drift: 0.0,
            gap_drift: 0.0,
            judged: 0,
        };
        run.look();
        run.before = run.now.clone();
        run
    }

    pub fn h(&self) -> f64 {
        self.acting.step
    }

    pub fn time(&self) -> f64 {
        self.steps as f64 * self.h()
    }

    /// The displacement and velocity of a degree of freedom, `mass.block.x`.
    pub fn of_dof(&self, name: &str) -> [f64; 2] {
        let dof = self.variables[0].iter().position(|variable| variable.name == name).unwrap();
        [self.now[0][dof], self.now[1][dof]]
    }

    /// Reads positions and velocities. The fastest so far, or the slider, is the scale of velocities.
    fn look(&mut self) {
        for (values, variables) in self.now.iter_mut().zip(&self.variables) {
            for (value, variable) in values.iter_mut().zip(variables) {
                *value = self.simulation.read(variable).unwrap();
            }
        }
        self.scales.velocity = self.scales.velocity.max(self.now[1].amax());
    }

    /// One internal step.
    pub fn step(&mut self) {
        self.jump(1);
    }

    /// Several internal steps; `before` is where the last one begins.
    pub fn jump(&mut self, count: u64) {
        if count > 1 {
            self.reported = None;
            self.steps += count - 1;
            self.simulation.advance_to(self.time()).unwrap();
            self.look();
        }
        std::mem::swap(&mut self.now, &mut self.before);
        self.steps += 1;
        self.simulation.advance_to(self.time()).unwrap();
        self.look();
    }

    /// The states that the integrator reports.
    pub fn states(&mut self) -> Vec<ContactState> {
        self.forces().iter().map(|force| force.state).collect()
    }

    /// The contact forces that the integrator reports.
    pub fn forces(&mut self) -> Vec<ContactForce> {
        self.simulation.contact_forces().unwrap().to_vec()
    }

    /// What acts in the step that begins at `time`.
    pub fn acting(&mut self, time: f64) -> Acting {
        if !self.signals.is_empty() {
            self.acting = self.simulation.scene().clone();
            for (input, signal) in &self.signals {
                let given = amontons::simulation::read_scene(&self.acting, input).unwrap();
                // A slider's velocity is that of the step's end.
                let at = if input.name.ends_with("velocity") { time + self.h() } else { time };
                let added = signal.shape.at(at, 1e-6 * self.h());
                write_scene(&mut self.acting, input, given + added).unwrap();
            }
        }
        let scene = &self.acting;
        let external = DVector::from_iterator(self.model.dofs(), scene.external_forces());
        let (v, kinetic) = (scene.slider.velocity, scene.friction_coefficient);
        let friction = Friction { kinetic, static_: scene.static_friction.unwrap_or(kinetic) };
        let contacts = &self.model.contacts;
        Acting {
            force: DVector::from_column_slice(&self.model.load) + external,
            slider_velocity: contacts.iter().map(|contact| contact.velocity(v)).collect(),
            friction: contacts.iter().map(|contact| contact.coefficients(friction)).collect(),
        }
    }

    /// Displacements from the unloaded position.
    pub fn total(&self, displacement: &DVector<f64>) -> DVector<f64> {
        displacement + DVector::from_column_slice(&self.simulation.reference().displacement)
    }

    /// Newton's law over the last step: the forces that the contacts must have given to the masses,
    /// M Δẋ/h − F + C ẋ + K x, N, and the rounding errors of that sum.
    ///
    /// The scheme of the paper has the forces of springs and dampers at the beginning of the step.
    fn needed(&mut self) -> (DVector<f64>, f64) {
        let Method::ForwardIncrement = self.method;
        let acting = self.acting(self.time() - self.h());
        let [x, v] = &self.before;
        let terms = [
            &self.mass * (&self.now[1] - v) / self.h(),
            -acting.force,
            &self.damping * v,
            &self.stiffness * self.total(x),
        ];
        // The sums lose digits of what they cancel.
        let speed = v.amax().max(self.now[1].amax());
        let lost = [
            terms[1].amax(),
            self.mass.amax() * speed / self.h(),
            self.damping.amax() * speed,
            self.stiffness.amax() * self.total(x).amax(),
        ];
        let lost = lost.into_iter().fold(0.0, f64::max);
        (terms.into_iter().sum(), ROUNDING * lost)
    }

    /// Gap, opening velocity and slip velocity of a contact.
    fn kinematics(&self, contact: usize, slider_velocity: f64) -> [f64; 3] {
        let [x, v] = &self.now;
        let normal = self.directions.column(2 * contact);
        let tangent = self.directions.column(2 * contact + 1);
        [normal.dot(x), normal.dot(v), slider_velocity - tangent.dot(v)]
    }

    fn law(&self, instant: &Instant, friction: Friction) -> Violation {
        residual(instant, friction, &self.scales)
    }

    /// What the tolerance of the multipliers leaves, a part of 1e-13 of the largest in the last sweep,
    /// where contacts between masses share one: a velocity each step, and the gaps that add up.
    fn add_drift(&mut self, forces: &DVector<f64>) {
        if !self.is_exact {
            let lightest = self.mass.diagonal().iter().copied().fold(f64::MAX, f64::min);
            let velocity = 2e-12 * forces.amax() * self.h() / lightest;
            let steps = self.steps - std::mem::replace(&mut self.judged, self.steps);
            self.gap_drift += velocity * self.h() * steps as f64;
            self.drift = velocity / self.scales.velocity + self.gap_drift / self.scales.length;
        }
    }

    /// Was a contact open, by more than rounding, when the last step began?
    fn was_open(&self, contact: usize) -> bool {
        let gap = self.directions.column(2 * contact).dot(&self.before[0]);
        gap > 1e-12 * self.scales.length
    }

    /// Did a contact land in the last step?
    pub fn has_landed(&self) -> bool {
        let is_open = |contact: usize| {
            let gap = self.directions.column(2 * contact).dot(&self.now[0]);
            gap > 1e-12 * self.scales.length
        };
        (0..self.model.contacts.len()).any(|i| self.was_open(i) && !is_open(i))
    }

    /// Judges the last step: forces by Newton's law, on the motion at its end. Returns the forces
    /// (N, T) of the contacts, none where they do not follow from the motion.
    ///
    /// A contact that was open when the step began is judged by its gap alone, not by its opening
    /// velocity: that of the paper's scheme is the mean over the way to the slider, and vanishes a
    /// step later.
    #[track_caller]
    pub fn judge_step(&mut self) -> Option<Vec<[f64; 2]>> {
        let (needed, rounding) = self.needed();
        self.compare_with_report(&needed, rounding);
        let fit = self.fit.as_ref()?;
        let forces = fit * &needed;
        let time = self.time();
        // What no contact can have given.
        let rest = (&needed - &self.directions * &forces).amax();
        assert!(rest <= 10.0 * rounding, "at {time} s the masses miss Newton's law by {rest} N");
        self.add_drift(&forces);
        let acting = self.acting(time - self.h());
        let pairs = forces.as_slice().chunks_exact(2).map(|pair| [pair[0], pair[1]]);
        let pairs: Vec<[f64; 2]> = pairs.collect();
        for (i, &[normal_force, friction_force]) in pairs.iter().enumerate() {
            let [gap, mut gap_velocity, slip_velocity] =
                self.kinematics(i, acting.slider_velocity[i]);
            if self.was_open(i) {
                gap_velocity = 0.0;
            }
            let instant =
                Instant { gap, gap_velocity, slip_velocity, normal_force, friction_force };
            let found = self.law(&instant, acting.friction[i]);
            let allowed = 1e-12 + 10.0 * rounding / self.scales.force + self.drift;
            assert!(
                found.size <= allowed,
                "contact {i} after {time} s: {found}, allowed {allowed:.1e}; {instant:?}"
            );
        }
        Some(pairs)
    }

    /// Where nothing happened in the last step, what the integrator reported at its beginning is what
    /// Newton's law needs.
    #[track_caller]
    fn compare_with_report(&mut self, needed: &DVector<f64>, rounding: f64) {
        let Some(reported) = self.reported.take() else { return };
        let now = self.forces();
        // Caught in this step and to slip on in the next one the contact slides, but did stick.
        let caught = |force: &ContactForce| {
            force.state.sliding_direction().is_some() && force.slip_velocity == 0.0
        };
        let same_state = reported
            .iter()
            .zip(&now)
            .all(|(old, new)| old.state == new.state && !caught(old) && !caught(new));
        let time = self.time();
        // A contact that sticks to a slider that speeds up needs a force that no instant knows.
        let times = [time - 2.0 * self.h(), time - self.h(), time];
        let velocities = times.map(|t| self.acting(t).slider_velocity);
        let steady = velocities.iter().all(|velocity| *velocity == velocities[0]);
        // Just landed: what is left of the impact comes in this step.
        let landing = (0..reported.len()).any(|i| {
            let normal = self.directions.column(2 * i);
            let rounding = 1e-12 * normal.abs().dot(&self.before[1].abs());
            !self.was_open(i) && normal.dot(&self.before[1]).abs() > rounding
        });
        if !same_state || !steady || landing || self.has_landed() {
            return;
        }
        let pairs = reported.iter().flat_map(|force| [force.normal_force, force.friction_force]);
        let forces = DVector::from_iterator(2 * reported.len(), pairs);
        let rest = (needed - &self.directions * &forces).amax();
        // Where masses share contacts the multipliers stop at 1e-13 of the largest in a step, and what
        // that leaves, up to a hundred times as much where they converge slowly, comes in the next.
        let allowed = if self.is_exact {
            10.0 * rounding + 1e-12 * forces.amax()
        } else {
            1000.0 * rounding + 1e-9 * forces.amax()
        };
        assert!(
            rest <= allowed,
            "at {time} s Newton's law misses what is reported by {rest} N: {reported:?}"
        );
    }

    /// Judges what the integrator reports now by the same law, with the motion of now. Where the
    /// slider's velocity has changed since the last step, the motion is not that of the law yet.
    #[track_caller]
    pub fn judge_report(&mut self) {
        let time = self.time();
        let old = self.acting(time - self.h());
        let acting = self.acting(time);
        if old.slider_velocity != acting.slider_velocity {
            return;
        }
        for (i, force) in self.forces().into_iter().enumerate() {
            let [gap, mut gap_velocity, slip_velocity] =
                self.kinematics(i, acting.slider_velocity[i]);
            if self.was_open(i) {
                gap_velocity = 0.0;
            }
            let (normal_force, friction_force) = (force.normal_force, force.friction_force);
            let instant =
                Instant { gap, gap_velocity, slip_velocity, normal_force, friction_force };
            let found = self.law(&instant, acting.friction[i]);
            assert!(
                found.size <= 1e-11 + self.drift,
                "contact {i} reports at {time} s: {found}; {instant:?} {force:?}"
            );
            let off = (force.slip_velocity - slip_velocity).abs();
            assert!(off <= 1e-12 * self.now[1].amax().max(1.0), "{force:?} {instant:?}");
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

    /// Kinetic and elastic energy, J; the load is no part of it.
    pub fn energy(&self) -> f64 {
        let [x, v] = &self.now;
        let x = self.total(x);
        0.5 * v.dot(&(&self.mass * v)) + 0.5 * x.dot(&(&self.stiffness * &x))
    }

    pub fn damping_power(&self) -> f64 {
        self.now[1].dot(&(&self.damping * &self.now[1]))
    }
}

/// A scene's input or parameter with another value.
pub fn with(mut scene: Scene, values: &[(&str, f64)]) -> Scene {
    for (name, value) in values {
        assign(&mut scene, name, *value).unwrap();
    }
    scene
}

/// Asserts that a value is as near to the expected one as told.
#[track_caller]
pub fn assert_near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} is not {expected} ± {tolerance:e}");
}
