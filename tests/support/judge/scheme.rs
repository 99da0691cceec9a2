//! The judge of the paper's scheme: Newton's law over one step.

use super::rule::{Before, Doing, state_of};
use super::{Acting, ROUNDING, Run};
use amontons::contact::residual::Instant;
use amontons::contact::{ContactForce, ContactState, Friction};
use nalgebra::DVector;

impl Run {
    /// Newton's law over the last step: the forces that the contacts must have given to the masses,
    /// M Δẋ/h − F + C ẋ + K x, N, and the rounding errors of that sum.
    ///
    /// The scheme of the paper has the forces of springs and dampers at the beginning of the step.
    fn needed(&mut self) -> (DVector<f64>, f64) {
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

    /// Adds the error that the tolerance of the multipliers leaves, a part of 1e-13 of the largest in the last
    /// iteration, where contacts between masses share one: a velocity each step, and the gaps that add up.
    fn add_drift(&mut self, forces: &DVector<f64>) {
        if !self.is_exact {
            let lightest = self.mass.diagonal().iter().copied().fold(f64::MAX, f64::min);
            let velocity = 2e-12 * forces.amax() * self.h() / lightest;
            let steps = self.steps - std::mem::replace(&mut self.judged, self.steps);
            self.gap_drift += velocity * self.h() * steps as f64;
            self.drift = velocity / self.scales.velocity + self.gap_drift / self.scales.length;
        }
    }

    /// Judges the last step: forces by Newton's law, on the motion at its end. Returns the forces
    /// (N, T) of the contacts, none where they do not follow from the motion.
    ///
    /// A contact that was open when the step began is judged by its gap alone, not by its opening
    /// velocity: that of the paper's scheme is the mean over the way to the slider, and vanishes a
    /// step later.
    #[track_caller]
    pub(super) fn judge_scheme_step(&mut self) -> Option<Vec<[f64; 2]>> {
        let (needed, rounding) = self.needed();
        self.compare_with_report(&needed, rounding);
        self.let_off.steps += 1;
        let Some(fit) = &self.fit else {
            self.judge_redundant(&needed, rounding);
            return None;
        };
        let forces = fit * &needed;
        let time = self.time();
        // The part of the forces that no contact can give.
        let rest = (&needed - &self.directions * &forces).amax();
        let allowed = 10.0 * rounding + self.forgiven * self.scales.force;
        assert!(rest <= allowed, "at {time} s the masses miss Newton's law by {rest} N");
        self.add_drift(&forces);
        let old = self.acting((time - 2.0 * self.h()).max(-self.h())).slider_velocity;
        let acting = self.acting(time - self.h());
        let pairs = forces.as_slice().chunks_exact(2).map(|pair| [pair[0], pair[1]]);
        let pairs: Vec<[f64; 2]> = pairs.collect();
        let small = 1e-12 + self.drift + self.forgiven;
        let nothing = [small * self.scales.velocity, small * self.scales.force];
        let shown = |(i, pair): (usize, &[f64; 2])| {
            state_of(pair[0], self.kinematics(i, acting.slider_velocity[i])[2], nothing)
        };
        let states: Vec<ContactState> = pairs.iter().enumerate().map(shown).collect();
        for (i, &[normal_force, friction_force]) in pairs.iter().enumerate() {
            let [gap, mut gap_velocity, slip_velocity] =
                self.kinematics(i, acting.slider_velocity[i]);
            gap_velocity = self.without_landing(i, gap_velocity);
            let instant =
                Instant { gap, gap_velocity, slip_velocity, normal_force, friction_force };
            let friction = self.friction_over_step(i, &acting, old[i]);
            let found = self.law(acting.slider_velocity[i], &instant, friction);
            let allowed = 1e-12 + 10.0 * rounding / self.scales.force + self.drift + self.forgiven;
            assert!(
                found.size <= allowed,
                "contact {i} after {time} s: {found}, allowed {allowed:.1e}; {instant:?}"
            );
            if !self.has_whole_law() {
                continue;
            }
            let own = self.directions.column(2 * i);
            let own = own.dot(&(&self.inverse_mass * own));
            let nothing = 10.0 * (allowed * self.scales.force);
            let doing = Doing {
                force: [normal_force, friction_force],
                slip: slip_velocity / self.h(),
                nothing: [own * nothing, nothing],
            };
            let before = self.was(i, old[i]);
            let mut all = acting.friction.clone();
            all[i] = friction;
            let (missed, slips) = self.missed(i, before, &doing, &states, &all);
            let lets_go = slips && before == Before::Stuck;
            self.let_off.releases += u64::from(lets_go);
            if missed > 0.0 && slips && self.shares_masses(i) {
                // If it had held, another one might have changed its state, and that have set it free.
                self.let_off.coupled += 1;
                continue;
            }
            assert!(
                missed <= 0.0,
                "contact {i} after {time} s: {missed:e} N, {before:?} {doing:?} {friction:?}"
            );
        }
        Some(pairs)
    }

    /// The friction of a contact over the last step, before which its slider had this velocity.
    fn friction_over_step(&self, contact: usize, acting: &Acting, old: f64) -> Friction {
        let sticks = self.was(contact, old) == Before::Stuck;
        let along = self.directions.column(2 * contact + 1).dot(&self.before[1]);
        let slip = acting.slider_velocity[contact] - along;
        self.friction_at(acting.friction[contact], slip, sticks)
    }

    /// State of a contact before the last step, at the end of which its slider had this velocity.
    fn was(&self, contact: usize, slider: f64) -> Before {
        let slip = slider - self.directions.column(2 * contact + 1).dot(&self.before[1]);
        let rounding = (1e-12 + self.drift) * self.scales.velocity;
        let nothing = rounding + self.forgiven * self.scales.velocity;
        let (_, states, _) = self.start.as_ref().unwrap();
        // A slip far below the fastest velocity may still be a slip; the contact state decides.
        let slipped =
            slip.abs() > rounding && states[contact].sliding_direction() == Some(slip.signum());
        // A start may have it leave the slider.
        let opens = self.directions.column(2 * contact).dot(&self.before[1]) > nothing;
        if self.was_open(contact) || opens {
            Before::Open
        } else if slip.abs() <= nothing && !slipped {
            Before::Stuck
        } else {
            Before::Slipped(slip.signum())
        }
    }

    /// Judges the last step where the forces of redundant contacts do not follow from the motion: some that
    /// obey the law must give it.
    #[track_caller]
    fn judge_redundant(&mut self, needed: &DVector<f64>, rounding: f64) {
        let time = self.time();
        let old = self.acting((time - 2.0 * self.h()).max(-self.h())).slider_velocity;
        let acting = self.acting(time - self.h());
        let nothing = 1e-12 + 10.0 * rounding / self.scales.force + self.drift + self.forgiven;
        let limits = acting.slider_velocity.iter().enumerate().map(|(i, &slider)| {
            let friction = self.friction_over_step(i, &acting, old[i]);
            let [gap, opening, slip] = self.kinematics(i, slider);
            let opens = !self.was_open(i) && opening > nothing * self.scales.velocity;
            let is_closed = gap <= nothing * self.scales.length && !opens;
            let along = self.directions.column(2 * i + 1).dot(&self.before[1]);
            let slipping = self.friction_at(acting.friction[i], slider - along, false);
            let range = if slip.abs() <= nothing * self.scales.velocity {
                [-friction.static_, friction.static_]
            } else {
                // For redundant contacts the motion does not show which of them stuck.
                let limits = [slipping.kinetic, friction.kinetic].map(|mu| slip.signum() * mu);
                [limits[0].min(limits[1]), limits[0].max(limits[1])]
            };
            is_closed.then_some(self.edges(range, slider))
        });
        let limits: Vec<Option<[f64; 2]>> = limits.collect();
        let rest = self.distance_from_cone(needed, &limits);
        let allowed = 10.0 * nothing * self.scales.force;
        assert!(
            rest <= allowed,
            "at {time} s no contacts give {rest:e} N, allowed {allowed:e}, of {needed:?} within {limits:?}"
        );
    }

    /// Checks that the forces that the integrator reported at the beginning of the last step are those that Newton's
    /// law needs, if nothing happened in the step.
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
        let missing = &self.directions * &forces - needed;
        // Forces that turn a slip round within the step are not those of the whole step.
        let end = &self.now[1] + &self.inverse_mass * &missing * self.h();
        let turns = reported.iter().enumerate().any(|(i, old)| {
            let slip = velocities[0][i] - self.directions.column(2 * i + 1).dot(&end);
            slip * old.slip_velocity < 0.0
        });
        if turns {
            return;
        }
        let rest = missing.amax();
        // If masses share contacts, the multipliers stop at 1e-13 of the largest in a step, and the remaining error, up
        // to a hundred times as much where they converge slowly, appears in the next.
        let allowed = if self.is_exact {
            10.0 * rounding + 1e-12 * forces.amax()
        } else {
            1000.0 * rounding + 1e-9 * forces.amax()
        } + 100.0 * self.forgiven * self.scales.force;
        assert!(
            rest <= allowed,
            "at {time} s Newton's law misses what is reported by {rest} N: {reported:?}"
        );
    }
}
