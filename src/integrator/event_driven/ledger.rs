//! Energy ledger of event-driven motion: the events that [`EventDriven`](super::EventDriven) reports to an observer,
//! and the observer that writes a ledger.

use super::series::{ORDER, Polynomial, Series, index};
use super::watch::Event;
use crate::contact::{ContactState, Friction};
use crate::integrator::dynamics::Dynamics;
use crate::integrator::ledger::half_form;
use crate::integrator::{Inputs, Motion, VisitLog};
use crate::model::{Damping, LumpedModel};

/// ∫ u^k du for u from 0 to 1: 1 / (k + 1).
const INTEGRATED: [f64; 2 * ORDER] = {
    let mut integrated = [1.0; 2 * ORDER];
    let (mut k, mut power) = (0, 1.0);
    while k < integrated.len() {
        integrated[k] = 1.0 / power;
        (k, power) = (k + 1, power + 1.0);
    }
    integrated
};

/// A part of a series over which the motion is about to advance.
pub struct Segment<'a> {
    pub(super) dynamics: &'a Dynamics,
    pub(super) series: &'a mut Series,
    /// Outer forces, N, and slider velocities, m/s, at the beginning of the part.
    pub(super) force: &'a [f64],
    pub(super) surface: &'a [f64],
    /// Slider accelerations at the beginning of the part, m/s².
    pub(super) acceleration: &'a [f64],
    /// Friction coefficients at the beginning of the part.
    pub(super) friction: &'a [Friction],
    pub(super) inputs: &'a Inputs,
    /// Length of the part relative to the span of the series.
    pub(super) part: f64,
}

/// An impact whose impulses have acted; the multipliers are the impulses.
pub struct Impact<'a> {
    pub(super) dynamics: &'a Dynamics,
    /// The velocities of the sliders, m/s.
    pub(super) surface: &'a [f64],
}

/// Observer of the events of a motion. It is a type parameter, so that the usual motion without an observer has no
/// extra cost.
pub trait MotionObserver: Send {
    fn passes(&mut self, segment: Segment<'_>, motion: &mut Motion);

    fn is_struck(&mut self, impact: Impact<'_>, motion: &mut Motion);

    /// Sees the velocities before (`sign` 1) and after (−1) hops are ended.
    fn sees_hops_end(&mut self, motion: &mut Motion, sign: f64);

    /// Sees the events of an instant, one place for each contact, and the motion before they act.
    fn sees_events(&mut self, _events: &[Option<Event>], _motion: &Motion) {}

    /// Sees the motion after the events of an instant, in the states that follow them.
    fn sees_states(&mut self, _motion: &Motion) {}

    /// The log of contact states, if the observer keeps one.
    fn visits(&self) -> Option<&VisitLog> {
        None
    }

    /// The work of friction on the masses at each contact, J, if the observer writes a ledger.
    fn friction_work(&self) -> Option<&[f64]> {
        None
    }
}

/// The observer that logs contact states.
impl MotionObserver for VisitLog {
    fn passes(&mut self, segment: Segment<'_>, motion: &mut Motion) {
        self.stay(&motion.contacts, segment.part * segment.series.span());
    }

    fn is_struck(&mut self, _: Impact<'_>, _: &mut Motion) {}

    fn sees_hops_end(&mut self, _: &mut Motion, _: f64) {}

    fn visits(&self) -> Option<&VisitLog> {
        Some(self)
    }
}

/// The observer that writes the ledger and logs contact states.
impl MotionObserver for (Writer, VisitLog) {
    fn passes(&mut self, segment: Segment<'_>, motion: &mut Motion) {
        self.1.stay(&motion.contacts, segment.part * segment.series.span());
        self.0.passes(segment, motion);
    }

    fn is_struck(&mut self, impact: Impact<'_>, motion: &mut Motion) {
        self.0.is_struck(impact, motion);
    }

    fn sees_hops_end(&mut self, motion: &mut Motion, sign: f64) {
        self.0.sees_hops_end(motion, sign);
    }

    fn visits(&self) -> Option<&VisitLog> {
        Some(&self.1)
    }

    fn friction_work(&self) -> Option<&[f64]> {
        self.0.friction_work()
    }
}

/// The observer that ignores all events.
impl MotionObserver for () {
    #[inline(always)]
    fn passes(&mut self, _: Segment<'_>, _: &mut Motion) {}

    #[inline(always)]
    fn is_struck(&mut self, _: Impact<'_>, _: &mut Motion) {}

    #[inline(always)]
    fn sees_hops_end(&mut self, _: &mut Motion, _: f64) {}
}

/// Observer that writes the ledger of the motion. Between events all integrands are products of polynomials, so its
/// entries are exact but for rounding.
pub(in crate::integrator) struct Writer {
    model: LumpedModel,
    /// Powers of dx/du over a part of a series in which u goes from 0 to 1, m; row by row, one value for each degree of
    /// freedom.
    moved: Vec<f64>,
    /// Powers of C dx/du, N s, in the rows of `moved`.
    damped: Vec<f64>,
    /// One power of the wave forces, N.
    wave: Vec<f64>,
    /// Friction force T of one contact, N, and displacement of its slider relative to the mass, m.
    friction: Polynomial,
    slipped: Polynomial,
    /// Work of friction on the masses at each contact since the writer was made, J.
    work: Vec<f64>,
}

impl Writer {
    pub(in crate::integrator) fn new(model: &LumpedModel) -> Self {
        let room = || vec![0.0; ORDER * model.dofs()];
        Self {
            // Gyroscopic forces do no work, and the work of the others is a form of the symmetric part.
            model: LumpedModel { dampers: model.dampers.symmetric_part(), ..model.clone() },
            moved: room(),
            damped: room(),
            wave: vec![0.0; model.dofs()],
            friction: [0.0; ORDER + 1],
            slipped: [0.0; ORDER + 1],
            work: vec![0.0; model.contacts.len()],
        }
    }

    /// Returns ∫ ẋᵀ C ẋ dt over the present part, which takes `time` (s).
    fn damping(&mut self, Damping { alpha, beta }: Damping, time: f64) -> f64 {
        let LumpedModel { mass, stiffness, dampers, .. } = &self.model;
        let dofs = self.model.dofs();
        if alpha == 0.0 && beta == 0.0 && dampers.is_empty() {
            return 0.0;
        }
        for (damped, moved) in self.damped.chunks_exact_mut(dofs).zip(self.moved.chunks_exact(dofs))
        {
            for (row, damped) in damped.iter_mut().enumerate() {
                *damped = alpha * mass.row_times(row, moved)
                    + beta * stiffness.row_times(row, moved)
                    + dampers.row_times(row, moved);
            }
        }
        let mut sum = 0.0;
        for (i, moved) in self.moved.chunks_exact(dofs).enumerate() {
            // C is symmetric: each pair of powers counts twice.
            for (j, damped) in self.damped.chunks_exact(dofs).enumerate().take(i) {
                sum += 2.0 * INTEGRATED[i + j] * dot(moved, damped);
            }
            sum += INTEGRATED[2 * i] * dot(moved, &self.damped[i * dofs..]);
        }
        sum / time
    }
}

impl MotionObserver for Writer {
    fn passes(&mut self, segment: Segment<'_>, motion: &mut Motion) {
        let Some(ledger) = &mut motion.ledger else { return };
        let Segment { dynamics, series, force, surface, acceleration, inputs, part, .. } = segment;
        let (dofs, time) = (force.len(), part * series.span());
        let powers = series.order();
        self.moved.resize(powers * dofs, 0.0);
        self.damped.resize(powers * dofs, 0.0);
        let mut power = 1.0;
        for (k, moved) in self.moved.chunks_exact_mut(dofs).enumerate() {
            power *= part;
            let factor = index(k + 1) * power;
            for (moved, c) in moved.iter_mut().zip(series.power(k + 1)) {
                *moved = factor * c;
            }
        }
        ledger.damping += self.damping(dynamics.damping, time);

        // The forces are f + ḟ t and the waves; the first two are evaluated once for each power.
        let mut work = 0.0;
        for (k, moved) in self.moved.chunks_exact(dofs).enumerate() {
            for (dof, moved) in moved.iter().enumerate() {
                let constant = (force[dof] + ledger.balance[dof]) * INTEGRATED[k];
                let rising = time * inputs.force_rate[dof] * INTEGRATED[k + 1];
                work += moved * (constant + rising);
            }
        }
        let mut power = 1.0;
        for i in 1..series.waves.powers() {
            power *= part;
            self.wave.fill(0.0);
            series.waves.add_forces(&inputs.waves, i, &mut self.wave);
            for (k, moved) in self.moved.chunks_exact(dofs).enumerate() {
                work += power * INTEGRATED[i + k] * dot(moved, &self.wave);
            }
        }
        ledger.forces += work;

        series.law.set(dynamics, &motion.contacts, segment.friction);
        for (i, contact) in dynamics.contacts.iter().enumerate() {
            if motion.contacts[i] == ContactState::Detached {
                continue;
            }
            let terms = series.friction_force(i, &mut self.friction);
            let mut power = 1.0;
            for friction in &mut self.friction[..terms] {
                *friction *= power;
                power *= part;
            }
            let friction = &self.friction[..terms];
            let mut carried: Polynomial = [0.0; ORDER + 1];
            carried[0] = time * surface[i];
            carried[1] = time * time * acceleration[i];
            series.waves.add_velocity(&inputs.waves, i, (time, part), &mut carried);
            let carried = &carried[..series.waves.powers().max(2)];
            let slipped = &mut self.slipped[..powers];
            for (slipped, moved) in slipped.iter_mut().zip(self.moved.chunks_exact(dofs)) {
                *slipped = -contact.tangent.dot(moved);
            }
            for (slipped, carried) in slipped.iter_mut().zip(carried) {
                *slipped += carried;
            }
            let [slider, lost] = [carried, slipped].map(|way| integral(friction, way));
            ledger.slider += slider;
            ledger.friction += lost;
            self.work[i] += slider - lost;
        }
    }

    fn is_struck(&mut self, Impact { dynamics, surface }: Impact<'_>, motion: &mut Motion) {
        let Some(ledger) = &mut motion.ledger else { return };
        let problem = &dynamics.problem;
        for (i, contact) in dynamics.contacts.iter().enumerate() {
            let [approach, slip] = problem.free[i];
            let before = [approach, slip + surface[i]];
            let after = [&contact.normal, &contact.tangent].map(|row| row.dot(&motion.velocity));
            let mean = [0, 1].map(|part| 0.5 * (before[part] + after[part]));
            ledger.add_impulses(problem.forces[i], mean, surface[i]);
            self.work[i] += problem.forces[i][1] * mean[1];
        }
    }

    fn sees_hops_end(&mut self, motion: &mut Motion, sign: f64) {
        let Some(ledger) = &mut motion.ledger else { return };
        ledger.impact += sign * half_form(&self.model.mass, &motion.velocity);
    }

    fn friction_work(&self) -> Option<&[f64]> {
        Some(&self.work)
    }
}

/// ∫ a b du for u from 0 to 1.
fn integral(a: &[f64], b: &[f64]) -> f64 {
    let mut sum = 0.0;
    for (i, a) in a.iter().enumerate() {
        sum += a * dot(b, &INTEGRATED[i..]);
    }
    sum
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |sum, (a, b)| sum + a * b)
}
