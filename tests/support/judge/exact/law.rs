//! The law of contact on exact motion: on velocities and accelerations at an instant, on what happens at a
//! change of state, and on what is reported.

use super::motion::{Place, Span};
use super::{Observation, SHORTEST, SLOW};
use crate::judge::reduced::residual_under;
use crate::judge::rule::{Before, Doing, state_of};
use crate::judge::{ROUNDING, Run};
use amontons::contact::ContactForce;
use amontons::contact::ContactState::{self, Detached, ReverseSlide, Slide, Stick};
use amontons::contact::Friction;
use amontons::contact::residual::{Instant, Scales};
use nalgebra::DVector;

/// Tolerance of the law, as a part of the scales, besides the rounding errors of the motion.
const LAW: f64 = 1e-10;
/// Velocities below this part of their scale count as zero.
const STANDS: f64 = 1e-10;

impl Run {
    /// Judges the law at one instant in a contact state: on the velocities, and where they vanish, on the
    /// accelerations. At the end of its time a slip may have come to an end.
    #[track_caller]
    pub(super) fn judge_instant(
        &mut self,
        span: &Span,
        observation: &Observation,
        held: usize,
        is_end: bool,
    ) {
        let (force, lost) = self.outer(span, observation);
        let sliders = span.acceleration(observation.t);
        let state = &self.memory.held[held];
        let forces = &state.multipliers * &force + &state.carried * &sliders;
        let lost = lost * state.multipliers.amax().max(1.0);
        let accelerations = &state.mobility * &force + &state.follows * &sliders;
        if self.fit.is_none() {
            return self.judge_redundant_instant(span, observation, held, &forces, lost);
        }
        let places = (0..sliders.len()).map(|i| [forces[2 * i], forces[2 * i + 1]]);
        for (i, pair) in places.enumerate() {
            let slider = [span.slider(i, observation.t), sliders[i], self.frozen(span, i)];
            self.at = (observation.t - self.h(), is_end);
            self.judge_contact(
                i,
                &observation.place,
                &accelerations,
                pair,
                slider,
                span.start.friction[i],
                lost,
            );
        }
    }

    /// Judges an instant at which the forces of redundant contacts do not follow from the motion: no gap is negative,
    /// and some forces that obey the law in these states do what these forces do.
    #[track_caller]
    fn judge_redundant_instant(
        &mut self,
        span: &Span,
        observation: &Observation,
        held: usize,
        forces: &DVector<f64>,
        lost: f64,
    ) {
        let states = self.memory.held[held].states.clone();
        let friction = &span.start.friction;
        let time = self.time() - self.h() + observation.t;
        let small = LAW + self.exact_drift() + self.forgiven;
        for (i, state) in states.iter().enumerate() {
            let gap = self.gap(i, &observation.place[0]);
            let is_off = if *state == Detached { gap < 0.0 } else { true };
            let allowed = small * self.scales.length;
            assert!(!is_off || gap.abs() <= allowed, "contact {i} at {time} s: gap {gap:e} m");
        }
        let range = |(i, state): (usize, &ContactState)| match state {
            Detached => None,
            Stick => Some([-friction[i].static_, friction[i].static_]),
            Slide => Some([friction[i].kinetic; 2]),
            ReverseSlide => Some([-friction[i].kinetic; 2]),
        };
        let limits: Vec<Option<[f64; 2]>> = states.iter().enumerate().map(range).collect();
        let rest = self.distance_from_cone(&(&self.directions * forces), &limits);
        let allowed = 10.0 * small * self.scales.force + 10.0 * lost;
        assert!(rest <= allowed, "at {time} s no contacts give {rest:e} N, allowed {allowed:e}");
    }

    /// Judges the states that follow on a change: a contact that does not slip yet but is about to could not
    /// have held.
    #[track_caller]
    pub(super) fn judge_onset(&mut self, span: &Span, observation: &Observation, held: usize) {
        if !self.has_whole_law() || self.fit.is_none() {
            return;
        }
        let (force, lost) = self.outer(span, observation);
        let state = &self.memory.held[held];
        let states = state.states.clone();
        let sliders = span.acceleration(observation.t);
        let forces = &state.multipliers * &force + &state.carried * &sliders;
        let accelerations = &state.mobility * &force + &state.follows * &sliders;
        let lost = lost * state.multipliers.amax().max(1.0);
        let drift = self.exact_drift();
        let allowed = (LAW + drift + self.forgiven) * self.scales.force + lost;
        for i in 0..span.steady.len() {
            let [normal, tangent] = [0, 1].map(|k| self.directions.column(2 * i + k));
            let slip_velocity = span.slider(i, observation.t) - tangent.dot(&observation.place[1]);
            if slip_velocity.abs() > (STANDS + drift + self.forgiven) * self.scales.velocity {
                continue;
            }
            let own = normal.dot(&(&self.inverse_mass * normal));
            let doing = Doing {
                force: [forces[2 * i], forces[2 * i + 1]],
                slip: sliders[i] - tangent.dot(&accelerations),
                nothing: [own * allowed, allowed],
            };
            if doing.slip * doing.force[1] < 0.0 {
                // A slip that comes to its end still has a small velocity.
                continue;
            }
            let friction = span.start.friction[i];
            let (missed, slips) =
                self.missed(i, Before::Stuck, &doing, &states, &span.start.friction);
            self.let_off.releases += u64::from(slips);
            if missed > 0.0 && slips && self.shares_masses(i) {
                self.let_off.coupled += 1;
                continue;
            }
            let time = self.time() - self.h() + observation.t;
            assert!(missed <= 0.0, "contact {i} at {time} s: {missed:e} N, {doing:?} {friction:?}");
        }
    }

    /// Judges one contact with its forces (N, T) on a motion, under a slider of this velocity and
    /// acceleration, and with a velocity of the sign that frozen friction has.
    #[track_caller]
    #[allow(clippy::too_many_arguments)]
    fn judge_contact(
        &self,
        contact: usize,
        [x, v]: &Place,
        acceleration: &DVector<f64>,
        [normal_force, friction_force]: [f64; 2],
        slider: [f64; 3],
        friction: Friction,
        lost: f64,
    ) {
        let [normal, tangent] = [0, 1].map(|k| self.directions.column(2 * contact + k));
        let along =
            |motion: &DVector<f64>, slider: f64| [normal.dot(motion), slider - tangent.dot(motion)];
        let [mut gap_velocity, mut slip_velocity] = along(v, slider[0]);
        let lands = self.at.1 && normal_force == 0.0 && gap_velocity < 0.0;
        if lands {
            gap_velocity = 0.0;
        }
        let own = normal.dot(&(&self.inverse_mass * normal));
        // However small it is, friction is against it.
        let slips_now = slip_velocity;
        if slip_velocity.abs() <= 10.0 * lost * own * self.h() {
            // Rounding of the forces can make such a slip velocity in a step.
            slip_velocity = 0.0;
        }
        let [gap_acceleration, slip_acceleration] = along(acceleration, slider[1]);
        let gap = self.gap(contact, x);
        let on = |velocities: [f64; 2], scales: Scales| {
            let [gap_velocity, slip_velocity] = velocities;
            let gap = if scales == self.scales { gap } else { 0.0 };
            let instant =
                Instant { gap, gap_velocity, slip_velocity, normal_force, friction_force };
            residual_under(self.model.law, slider[2], &instant, friction, &scales)
        };
        let drift = self.exact_drift();
        let allowed = LAW + drift + self.forgiven + lost / self.scales.force;
        let story = || {
            format!(
                "contact {contact} at {} s {:+e} s: gap {gap:e} m, {gap_velocity:e} m/s, \
                 {gap_acceleration:e} m/s²; slip {slip_velocity:e} m/s, {slip_acceleration:e} m/s²; \
                 N = {normal_force} N, T = {friction_force} N, {friction:?}",
                self.time(),
                self.at.0
            )
        };
        let found = on([gap_velocity, slip_velocity], self.scales);
        assert!(found.size <= allowed, "{found}, allowed {allowed:.1e}: {}", story());
        let stands = STANDS + drift + self.forgiven;
        if lands
            || gap > stands * self.scales.length
            || gap_velocity.abs() > stands * self.scales.velocity
        {
            return;
        }
        // Contacts that throw each other off come to rest in ever shorter bounces: however slow one is, it
        // may be open for as long as it takes to come back, or until another one lands. It has come back
        // when its gap says so, a difference of displacements. Where states lead to each other at one instant, a
        // step that ends there decides later, but within a small part of itself.
        let is_free = normal_force == 0.0 && gap_acceleration < 0.0;
        let fall = -2.0 * gap_acceleration * (gap.max(0.0) + f64::EPSILON * x.amax());
        let root = (gap_velocity * gap_velocity + fall).sqrt();
        // A report does not know how long that is, and the judge of the next step does.
        let in_time = if self.lasts.is_finite() {
            self.lasts < SHORTEST * self.internal_step()
                || self.lasts * -gap_acceleration <= (1.0 + 1e-3) * (gap_velocity + root)
        } else {
            gap > 0.0
        };
        if is_free && (in_time || self.at.1) {
            return;
        }
        // The acceleration that the largest force would cause here.
        let own = own * self.scales.force;
        let scales = Scales { velocity: own, ..self.scales };
        // A slip that lasts too short to be distinguished from zero may be at its end from the beginning.
        let nothing = stands * self.scales.velocity;
        let is_brief = slip_velocity.abs().max(self.lasts * slip_acceleration.abs()) <= nothing;
        let ends = (self.at.1 || is_brief) && friction_force != 0.0;
        let slips = own * if ends { friction_force } else { slips_now }.signum();
        let now = on([gap_acceleration, slips], scales);
        let next = on([gap_acceleration, slip_acceleration], scales);
        let found = if slip_velocity.abs() > stands * self.scales.velocity || now.size <= next.size
        {
            now
        } else {
            next
        };
        // A velocity that is nothing to rounding may have had the wrong sign for as long as it takes to
        // become something: v = j t²/2, a = j t.
        let jerk = tangent.dot(&(&self.inverse_mass * (&self.stiffness * v))).abs();
        let nothing = 2.0 * ROUNDING * own * self.h();
        let allowed = allowed + 2.0 * (2.0 * nothing * jerk).sqrt() / own;
        assert!(
            found.size <= allowed,
            "accelerations: {found}, allowed {allowed:.1e}: {}",
            story()
        );
    }

    /// A velocity of a slider with the sign that its frozen friction has over the step.
    fn frozen(&self, span: &Span, contact: usize) -> f64 {
        span.slider(contact, 0.0) + span.slider(contact, self.h())
    }

    /// Rounding error of the gap and the velocities of closed contacts between masses, which no step projects onto the
    /// constraints: a bit of the velocity for each step.
    fn exact_drift(&self) -> f64 {
        if self.is_exact {
            return 0.0;
        }
        let steps = self.simulation.statistics().steps as f64;
        let velocity = f64::EPSILON * steps * self.scales.velocity;
        velocity / self.scales.velocity + velocity * self.time() / self.scales.length
    }

    /// Largest velocities (m/s), and their change by contacts and loads between two times.
    fn gained(&self, span: &Span, before: &Observation, after: &Observation) -> [f64; 2] {
        let fastest = before.place[1].amax().max(after.place[1].amax()).max(self.scales.velocity);
        let (force, _) = self.outer(span, before);
        // Contacts add no more than holds all others, several times.
        let holds = 10.0 * (force.amax() + self.scales.force) * self.inverse_mass.amax();
        [fastest, (after.t - before.t) * holds]
    }

    /// By how much velocities change between two neighbouring times, and by how much they may without an
    /// impact.
    pub(super) fn moved(
        &self,
        span: &Span,
        before: &Observation,
        after: &Observation,
    ) -> (f64, f64) {
        let [fastest, gained] = self.gained(span, before, after);
        // Some thousand bits: closed contacts are put where they belong at each change. Of inclined ones that
        // bounce off each other, one bounce more or less.
        let bounces = (0..span.steady.len()).any(|i| {
            let normal = self.directions.column(2 * i);
            let opening = |observation: &Observation| normal.dot(&observation.place[1]).abs();
            let fast = opening(before).max(opening(after));
            fast > 1e-4 * SLOW * fastest && fast < 1e2 * SLOW * fastest
        });
        let rounding = match (self.is_exact, bounces) {
            (true, _) => 1e-12,
            (false, false) => 1e-11,
            (false, true) => SLOW,
        };
        let rounding = rounding + self.forgiven;
        ((&after.place[1] - &before.place[1]).amax(), rounding * fastest + gained)
    }

    /// Judges what happens between two neighbouring times: nothing, or an impact. The contact states are
    /// those before it.
    #[track_caller]
    pub(super) fn judge_event(
        &mut self,
        span: &Span,
        before: &Observation,
        after: &Observation,
        states: &[ContactState],
    ) {
        self.let_off.changes += 1;
        let passed = after.t - before.t;
        let [fastest, gained] = self.gained(span, before, after);
        let (changed, rounding) = self.moved(span, before, after);
        let moved = (&after.place[0] - &before.place[0]).amax();
        let time = self.time() - self.h() + after.t;
        let late = 4.0 * f64::EPSILON * time;
        // The number of bounces before contacts come to rest depends on rounding, which is a part of the displacements,
        // however small the spring forces are.
        let length = self.scales.length.max(before.place[0].amax());
        let bits = if self.is_exact { 1e-12 } else { SLOW } + self.forgiven;
        assert!(
            moved <= (fastest + gained) * (passed + late) + bits * length,
            "at {time} s it moves by {moved} m at once"
        );
        // A start may press a closed contact further.
        let approaches = (0..span.steady.len()).any(|i| {
            let normal = self.directions.column(2 * i);
            let [x, v] = &before.place;
            self.gap(i, x) <= STANDS * self.scales.length && normal.dot(v) < -STANDS * fastest
        });
        let landed = after.statistics.touch_downs - before.statistics.touch_downs;
        if landed == 0 && !approaches {
            assert!(changed <= rounding, "at {time} s velocities jump by {changed}");
            return;
        }
        self.let_off.impacts += 1;
        let momentum = &self.mass * (&after.place[1] - &before.place[1]);
        let lost = self.mass.amax() * rounding;
        let scales = Scales {
            velocity: fastest,
            force: momentum.amax().max(f64::MIN_POSITIVE),
            length: self.scales.length.max(fastest * passed),
        };
        let allowed = LAW + self.exact_drift() + self.forgiven + 10.0 * lost / scales.force;
        let nothing = [allowed * fastest, allowed * scales.force];
        let contacts = 0..span.steady.len();
        let kinematics: Vec<[f64; 3]> = contacts
            .clone()
            .map(|i| {
                let [normal, tangent] = [0, 1].map(|k| self.directions.column(2 * i + k));
                let [x, v] = &after.place;
                [self.gap(i, x), normal.dot(v), span.slider(i, after.t) - tangent.dot(v)]
            })
            .collect();
        let Some(fit) = &self.fit else {
            let limits = contacts.map(|i| {
                let [gap, opening, slip] = kinematics[i];
                let Friction { kinetic, static_, .. } = span.start.friction[i];
                let is_closed =
                    gap <= nothing[0] / fastest * scales.length && opening <= nothing[0];
                let range = if slip.abs() <= nothing[0] {
                    [-static_, static_]
                } else {
                    [slip.signum() * kinetic; 2]
                };
                is_closed.then_some(self.edges(range, self.frozen(span, i)))
            });
            let limits: Vec<Option<[f64; 2]>> = limits.collect();
            let rest = self.distance_from_cone(&momentum, &limits);
            assert!(rest <= nothing[1], "impact at {time} s: no contacts give {rest} N s of it");
            for (i, [gap, opening, _]) in kinematics.into_iter().enumerate() {
                // A contact that lands next may be as near as rounding permits; if it did not land, its gap would be
                // judged.
                let is_open = gap > ROUNDING * scales.length || after.states[i] == Detached;
                assert!(
                    is_open || opening >= -nothing[0],
                    "contact {i} at {time} s: {opening} m/s"
                );
            }
            return;
        };
        let impulses = fit * &momentum;
        let rest = (&momentum - &self.directions * &impulses).amax();
        assert!(rest <= lost, "at {time} s momentum changes by {rest} N s without contacts");
        let shown = |i: usize| state_of(impulses[2 * i], kinematics[i][2], nothing);
        let after_it: Vec<ContactState> = contacts.clone().map(shown).collect();
        for i in contacts {
            let [gap, gap_velocity, slip_velocity] = kinematics[i];
            let [normal_force, friction_force] = [impulses[2 * i], impulses[2 * i + 1]];
            let instant =
                Instant { gap, gap_velocity, slip_velocity, normal_force, friction_force };
            let friction = span.start.friction[i];
            let surface = self.frozen(span, i);
            let found = residual_under(self.model.law, surface, &instant, friction, &scales);
            assert!(
                found.size <= allowed,
                "impact at {time} s, contact {i}: {found}, allowed {allowed:.1e}; {instant:?}"
            );
            if !self.has_whole_law() {
                continue;
            }
            let before = match (states[i], states[i].sliding_direction()) {
                (_, Some(direction)) => Before::Slipped(direction),
                (Stick, _) => Before::Stuck,
                _ => Before::Open,
            };
            let doing =
                Doing { force: [normal_force, friction_force], slip: slip_velocity, nothing };
            let (missed, slips) = self.missed(i, before, &doing, &after_it, &span.start.friction);
            if missed > 0.0 && slips && self.shares_masses(i) {
                self.let_off.coupled += 1;
                continue;
            }
            assert!(
                missed <= 0.0,
                "impact at {time} s, contact {i}: {missed:e} N s, {before:?} {doing:?}"
            );
        }
    }

    /// Judges what is reported now: forces that hold the motion, under the law.
    #[track_caller]
    pub(in crate::judge) fn judge_exact_report(&mut self) {
        let time = self.time();
        let last = self.acting_at([time - self.h(), time]);
        let mut span = self.span(time);
        if last.slider_velocity != span.start.slider_velocity {
            // A slider that jumps leaves what sticks to it behind, which no instant knows.
            return;
        }
        // The rates of the sliders at this instant, also if they bend later.
        [_, span.steady] = self.rates(time);
        span.start.friction = self.acting_at([time, time]).friction;
        let reported = self.forces();
        // One that is at its limit and does not slip yet is about to.
        let friction = &span.start.friction;
        let slides = |(i, force): (usize, &ContactForce)| {
            let limit = friction[i].static_ * force.normal_force * (1.0 - 1e-13);
            match force.state {
                Stick if force.friction_force >= limit => Slide,
                Stick if force.friction_force <= -limit => ReverseSlide,
                state => state,
            }
        };
        let states: Vec<ContactState> = reported.iter().enumerate().map(slides).collect();
        let held = self.held(&states, &span.start.friction);
        if self.memory.held[held].is_undetermined {
            self.let_off.undetermined += 1;
            return;
        }
        let statistics = self.simulation.statistics();
        let observation =
            Observation { t: 0.0, statistics, states: states.clone(), place: self.now.clone() };
        let (force, lost) = self.outer(&span, &observation);
        let state = &self.memory.held[held];
        let pairs = reported.iter().flat_map(|force| [force.normal_force, force.friction_force]);
        let given = DVector::from_iterator(2 * reported.len(), pairs);
        let acceleration = &span.acceleration(0.0);
        let needed = &state.multipliers * &force + &state.carried * acceleration;
        let lost = lost * state.multipliers.amax().max(1.0);
        let off = (&self.directions * (&given - &needed)).amax();
        let allowed = 20.0 * lost + 1e-11 * needed.amax() + self.forgiven * self.scales.force;
        assert!(
            off <= allowed,
            "at {time} s {off:e} N are missing, allowed {allowed:e}: {reported:?} {needed:?}"
        );
        let accelerations = &self.inverse_mass * (&force + &self.directions * &given);
        self.at = (0.0, false);
        for (i, force) in reported.iter().enumerate() {
            // A frozen direction is that of the last step, at whose beginning the surface had it.
            let frozen = force.state.sliding_direction().unwrap_or(0.0);
            let slider = [span.slider(i, 0.0), acceleration[i], frozen];
            let pair = [force.normal_force, force.friction_force];
            self.judge_contact(
                i,
                &self.now,
                &accelerations,
                pair,
                slider,
                span.start.friction[i],
                lost,
            );
            let slip = slider[0] - self.directions.column(2 * i + 1).dot(&self.now[1]);
            let off = (force.slip_velocity - slip).abs();
            let drift = (self.exact_drift() + self.forgiven) * self.scales.velocity;
            assert!(off <= 1e-12 * self.now[1].amax().max(1.0) + drift, "{force:?}, {slip}");
        }
    }
}
