//! The motion in one contact state as a power series in time.
//!
//! # Number of powers
//!
//! With |c_k| for the sum of the magnitudes of c_k over the degrees of freedom, powers are added in pairs until
//!
//! ```text
//! |c_{n−1}| + |c_n| ≤ ε/2 · (|c_0| + |c_1| + |c_2| + |c_3|)
//! ```
//!
//! with n odd and above the powers of waves, or n is [`ORDER`] = 28. The recursion makes each power from the two
//! before it, so the powers behind n are smaller still: one oscillation of angle θ = ω τ has
//! c_{k+2} = −θ² c_k / ((k + 1)(k + 2)), and all omitted ones together are less than 2 % of the last pair at n = 28.
//! The forces have the powers up to n − 2; their omitted ones are K times displacements of that size.
//!
//! # Span
//!
//! If the pair n = 28 is still too large, the span is shortened to p τ with the largest p = 0.9^j for which
//!
//! ```text
//! p^27 (|c_27| + |c_28| p) ≤ ε/2 · (|c_0| + |c_1| p + |c_2| p² + |c_3| p³),
//! ```
//!
//! and c_k is multiplied by p^k: nothing is computed anew. A series covers θ = 2.8 to 3.25 of one undamped mode, and
//! r τ ≈ 3 of one that decays as exp(−r t). Up to there Σ |c_k| is at most about 20 times the size of the motion,
//! which is the factor on the rounding of its terms.
//!
//! Where the friction coefficient of a contact changes, a power of the friction force takes all lower ones of N, so that
//! two small powers say nothing of the next. All powers up to n = 28 are then computed, the size on the right is that of
//! all below n = 27, and the span is also one over which the powers of µ N beyond those of the forces are rounding.
//!
//! The size is that of all degrees of freedom together: a displacement far smaller than the others has their absolute
//! error, not its own relative one.

use super::law::{Actions, StateLaw, held_dofs};
use super::reduced::{MOST_PLACES, MOST_STATES, ReducedLaws};
use super::roots;
use super::waves::Waves;
use crate::contact::{ContactState, Friction};
use crate::integrator::dynamics::Dynamics;
use crate::integrator::{Inputs, StepFailure};
use crate::model::{Contact, Damping, Direction};

/// The highest power of the displacements.
pub(super) const ORDER: usize = 28;
/// The highest power of the forces.
pub(super) const FORCE_ORDER: usize = ORDER - 2;
/// Largest magnitude of the last two powers relative to the first four together.
const TRUNCATION: f64 = 0.5 * f64::EPSILON;
/// Factor by which a span that the series does not cover is shortened repeatedly.
const SHORTER: f64 = 0.9;
/// Factor on the last power but one after one shortening by [`SHORTER`]: 0.9^27.
const LEFT_OF_LAST: f64 = {
    let (mut left, mut power) = (1.0, 1);
    while power < ORDER {
        left *= SHORTER;
        power += 1;
    }
    left
};
/// Largest number of shortenings: to 5e-19 of the span.
const MOST_SHORTENINGS: usize = 400;
/// Factor by which a span whose powers are not finite is shortened before they are computed anew, and the number of
/// such trials.
const MUCH_SHORTER: f64 = 1e-4;
const MOST_TRIALS: usize = 4;

/// Factors of the power k.
struct Power {
    /// k + 1.
    ahead: f64,
    /// 1 / ((k + 1) (k + 2)).
    integrated_twice: f64,
}
const POWERS: [Power; FORCE_ORDER + 1] = {
    let mut powers = [const { Power { ahead: 1.0, integrated_twice: 0.5 } }; FORCE_ORDER + 1];
    let (mut k, mut ahead) = (0, 1.0);
    while k < powers.len() {
        powers[k] = Power { ahead, integrated_twice: 1.0 / (ahead * (ahead + 1.0)) };
        (k, ahead) = (k + 1, ahead + 1.0);
    }
    powers
};

/// The power series x(s) = Σ c_k s^k and the contact forces over a span of time, in which s goes from 0 to 1.
///
/// Coefficients are stored in rows with the places of [`StateLaw`].
pub(super) struct Series {
    dofs: usize,
    /// Number of places of a row: those of the law, for small structures rounded up to a multiple of 4.
    places: usize,
    pub(super) law: StateLaw,
    /// The full matrices of a small structure; `None` for a large one.
    reduced: Option<ReducedLaws>,
    /// The states of the contacts, and the accelerations of their sliders.
    states: Vec<ContactState>,
    slider: Vec<f64>,
    /// For each place 1 where the states leave a degree of freedom free, or else 0, and the acceleration (m/s²) with
    /// which a slider moves it.
    is_free: Vec<f64>,
    carried: Vec<f64>,
    /// The degrees of freedom that sliders move, each with the contact.
    carriers: Vec<(usize, usize)>,
    /// The waves, and one power of the slider accelerations that they cause.
    pub(super) waves: Waves,
    swung: Vec<f64>,
    /// Rows of the powers of waves; only for small structures.
    wave_rows: Vec<f64>,
    /// The friction coefficients that change.
    friction_changes: Vec<FrictionChange>,
    /// c_k, m, row by row; zero beyond the degrees of freedom.
    displacement: Vec<f64>,
    /// λ_k, N, row by row in the places of multipliers.
    forces: Vec<f64>,
    /// At least Σ |λ_k| from k = 1 on, N: a bound of the change of forces from the beginning.
    swing: Vec<f64>,
    /// The highest power in use.
    order: usize,
    /// The covered time, s.
    span: f64,
    /// x + β ẋ and ẋ of one power, or at the end of the span; rates of outer forces times the span, N.
    stretch: Vec<f64>,
    velocity: Vec<f64>,
    outer_rate: Vec<f64>,
    zeros: Vec<f64>,
}

/// The change of the friction coefficients of a contact over the span.
struct FrictionChange {
    contact: usize,
    /// The direction in which the contact slips; `None` if it does not.
    direction: Option<f64>,
    /// The powers of µ_k and µ_s; those of power 0 are the values at the beginning.
    powers: [Polynomial; 2],
}

impl FrictionChange {
    /// The powers of the coefficient that acts in the contact's state, µ_k in slip.
    fn acting(&self) -> &Polynomial {
        &self.powers[usize::from(self.direction.is_none())]
    }

    /// Power k of what the change adds to the product of the acting coefficient and N, whose powers below k are known, N.
    fn product(&self, k: usize, normal: impl Fn(usize) -> f64) -> f64 {
        let friction = self.acting();
        (1..=k).fold(0.0, |sum, j| sum + friction[j] * normal(k - j))
    }
}

/// The conditions at the beginning of a series: outer forces, N, accelerations of the sliders, m/s², friction
/// coefficients, and the time since the beginning of the step, s.
#[derive(Clone, Copy)]
pub(super) struct SeriesStart<'a> {
    pub(super) outer: &'a [f64],
    pub(super) slider: &'a [f64],
    pub(super) friction: &'a [Friction],
    pub(super) passed: f64,
}

/// Converts a small number to a double.
pub(super) fn index(k: usize) -> f64 {
    f64::from(u32::try_from(k).unwrap_or(u32::MAX))
}

impl Series {
    pub(super) fn new(dynamics: &Dynamics) -> Self {
        Self::with_slots(dynamics, MOST_STATES)
    }

    /// A series with memory for the matrices of up to `slots` states; without any, small structures are treated as
    /// large ones are.
    fn with_slots(dynamics: &Dynamics, slots: usize) -> Self {
        let (dofs, contacts) = (dynamics.acceleration.len(), dynamics.contacts.len());
        let law = StateLaw::new(dynamics);
        let is_small = law.width() <= MOST_PLACES && slots > 0;
        let places = if is_small { law.width().next_multiple_of(4).max(4) } else { law.width() };
        let states =
            u32::try_from(contacts).ok().and_then(|contacts| 4_usize.checked_pow(contacts));
        let slots = slots.min(states.unwrap_or(usize::MAX));
        // The values without contacts; contact states are set when they change.
        let mut is_free = vec![0.0; places];
        is_free[..dofs].fill(1.0);
        Self {
            dofs,
            places,
            law,
            reduced: is_small.then(|| ReducedLaws::new(dynamics, places, slots)),
            states: Vec::with_capacity(contacts),
            slider: Vec::with_capacity(contacts),
            is_free,
            carried: vec![0.0; places],
            carriers: Vec::with_capacity(contacts),
            waves: Waves::new(),
            swung: vec![0.0; contacts],
            wave_rows: Vec::new(),
            friction_changes: Vec::with_capacity(contacts),
            displacement: vec![0.0; (ORDER + 1) * places],
            forces: vec![0.0; (FORCE_ORDER + 1) * places],
            swing: vec![0.0; places],
            order: 0,
            span: 0.0,
            stretch: vec![0.0; places],
            velocity: vec![0.0; places],
            outer_rate: vec![0.0; dofs],
            zeros: vec![0.0; dofs.max(contacts)],
        }
    }

    /// Reserves memory for `count` waves.
    pub(super) fn expect_waves(&mut self, count: usize) {
        self.waves.make_room(count);
        if self.reduced.is_some() && count > 0 {
            self.wave_rows.resize((FORCE_ORDER + 1) * self.places, 0.0);
        }
    }

    /// Discards the matrices; to be called after a change of damping.
    pub(super) fn forget(&mut self) {
        if let Some(reduced) = &mut self.reduced {
            reduced.clear();
        }
    }

    /// Expands the series from (x, ẋ) under the conditions at its beginning, and the rates and waves of the drive. It
    /// covers up to `most` (s), and next to nothing where its numbers have left their range.
    pub(super) fn expand(
        &mut self,
        dynamics: &Dynamics,
        states: &[ContactState],
        inputs: &Inputs,
        now: SeriesStart<'_>,
        (x, v): (&[f64], &[f64]),
        most: f64,
    ) {
        self.hold(dynamics, states, now.slider);
        self.span = most;
        for _ in 0..MOST_TRIALS {
            let (first, others) = self.displacement.split_at_mut(self.places);
            first[..self.dofs].copy_from_slice(x);
            for (c, v) in others.iter_mut().zip(v) {
                *c = v * self.span;
            }
            self.waves.expand(&inputs.waves, now.passed, self.span);
            self.note_friction_changes(inputs, now.friction);
            match (self.reduced.is_some() && !self.is_rubbed(), self.waves.powers() > 0) {
                (true, false) => self.by_matrices::<false>(dynamics, inputs, now),
                (true, true) => self.by_matrices::<true>(dynamics, inputs, now),
                (false, _) => self.large(dynamics, inputs, now),
            }
            let last = &self.displacement[(self.order - 1) * self.places..][..2 * self.places];
            if last.iter().all(|c| c.is_finite()) {
                break;
            }
            self.span *= MUCH_SHORTER;
        }
        if self.order == ORDER {
            self.shorten();
        }
        self.law.add_shared(&self.states, &mut self.forces[..self.places]);
    }

    /// Notes the friction coefficients that change.
    fn note_friction_changes(&mut self, inputs: &Inputs, now: &[Friction]) {
        self.friction_changes.clear();
        let is_steady = |rates: &[f64; 2]| *rates == [0.0; 2];
        if inputs.friction_rate.iter().all(is_steady)
            && inputs.waves.iter().all(|wave| wave.friction.is_empty())
        {
            return;
        }
        for (contact, state) in self.states.iter().enumerate() {
            let mut powers = [[0.0; ORDER + 1]; 2];
            let mut is_driven = false;
            for (part, powers) in powers.iter_mut().enumerate() {
                powers[1] = self.span * inputs.friction_rate[contact][part];
                is_driven |= self.waves.add_friction(&inputs.waves, (contact, part), powers);
                is_driven |= powers[1] != 0.0;
            }
            if is_driven {
                [powers[0][0], powers[1][0]] = [now[contact].kinetic, now[contact].static_];
                let direction = state.sliding_direction();
                self.friction_changes.push(FrictionChange { contact, direction, powers });
            }
        }
    }

    /// The failure of the first contact whose µ_k becomes negative, or whose µ_s falls below its µ_k, within this part of
    /// the span; its time is that since the beginning of the series.
    pub(super) fn impossible_friction(&self, part: f64) -> Option<StepFailure> {
        /// Beyond the rounding of a sine that just reaches zero.
        const NOTHING: f64 = 1e-12;
        let falls = |powers: &Polynomial| {
            roots::first_negative(powers, [0.0; 3]).filter(|time| *time < part)
        };
        let failure = |change: &FrictionChange| {
            let contact = change.contact;
            let [mut kinetic, mut above] = change.powers;
            for (above, kinetic) in above.iter_mut().zip(&kinetic) {
                *above -= kinetic;
            }
            kinetic[0] += NOTHING;
            above[0] += NOTHING;
            let negative = falls(&kinetic).map(|time| (time, None));
            let weak = falls(&above).map(|time| (time, Some(value(&kinetic, time))));
            let first = negative.into_iter().chain(weak).min_by(|a, b| a.0.total_cmp(&b.0));
            first.map(|(time, coefficient)| {
                let after = time * self.span;
                match coefficient {
                    None => StepFailure::NegativeFriction { contact, after },
                    Some(coefficient) => {
                        StepFailure::WeakStaticFriction { contact, after, coefficient }
                    }
                }
            })
        };
        self.friction_changes.iter().find_map(failure)
    }

    /// `true` if a friction coefficient of the contact changes over the span.
    pub(super) fn changes_friction(&self, contact: usize) -> bool {
        self.friction_change(contact).is_some()
    }

    /// `true` if forces of friction have powers of their own: those of a coefficient that changes in slip.
    fn is_rubbed(&self) -> bool {
        self.friction_changes.iter().any(|change| change.direction.is_some())
    }

    /// Sets the degrees of freedom that the contacts hold.
    fn hold(&mut self, dynamics: &Dynamics, states: &[ContactState], slider: &[f64]) {
        if self.states == states && self.slider == slider {
            return;
        }
        self.states.clear();
        self.states.extend_from_slice(states);
        self.slider.clear();
        self.slider.extend_from_slice(slider);
        self.is_free[..self.dofs].fill(1.0);
        self.carried.fill(0.0);
        self.carriers.clear();
        held_dofs(dynamics, states, |dof, by| {
            self.is_free[dof] = 0.0;
            self.carried[dof] = by.map_or(0.0, |contact| slider[contact]);
            self.carriers.extend(by.map(|contact| (dof, contact)));
        });
    }

    /// The recursion with matrices of as many rows as there are places, with or without waves.
    fn by_matrices<const WAVES: bool>(
        &mut self,
        dynamics: &Dynamics,
        inputs: &Inputs,
        now: SeriesStart<'_>,
    ) {
        match self.places {
            4 => self.small::<4, 2, WAVES>(dynamics, inputs, now),
            8 => self.small::<8, 4, WAVES>(dynamics, inputs, now),
            12 => self.small::<12, 6, WAVES>(dynamics, inputs, now),
            _ => self.small::<16, 8, WAVES>(dynamics, inputs, now),
        }
    }

    /// The recursion with matrices of N rows, P pairs of rows.
    fn small<const N: usize, const P: usize, const WAVES: bool>(
        &mut self,
        dynamics: &Dynamics,
        inputs: &Inputs,
        now: SeriesStart<'_>,
    ) {
        self.order = 0;
        let SeriesStart { outer, slider, friction, .. } = now;
        let mut rate = self.small_rate::<N>(dynamics, inputs, friction);
        let waves = if WAVES { self.waves.powers() } else { 0 };
        self.write_wave_rows(dynamics, inputs, friction);
        let Some(reduced) = &mut self.reduced else { return };
        let matrices = reduced.of(dynamics, &mut self.law, &self.states, friction, (outer, slider));
        let Damping { alpha, beta } = dynamics.damping;
        let is_damped = alpha != 0.0 || !dynamics.dampers.is_empty();
        let displacement = self.displacement.as_chunks_mut::<N>().0;
        let forces = self.forces.as_chunks_mut::<N>().0;
        let swings = &self.wave_rows.as_chunks::<N>().0[..waves];
        if let Some(first) = swings.get(1) {
            rate = std::array::from_fn(|i| rate[i] + first[i]);
        }
        let (is_free, carried) = (first::<N>(&self.is_free), first::<N>(&self.carried));
        let (per_span, square) = (1.0 / self.span, self.span * self.span);
        let may_end = self.friction_changes.is_empty();
        let (mut negligible, mut swing) = (0.0, [0.0; N]);
        for (k, (row, power)) in forces.iter_mut().zip(&POWERS).enumerate() {
            let (known, new) = displacement.split_at_mut(k + 2);
            let ([.., c, next], [new, ..]) = (known, new) else { return };
            self.order = k + 2;
            let start = match k {
                0 => matrices.load(),
                1 => rate,
                _ => swings.get(k).copied().unwrap_or([0.0; N]),
            };
            // The motion that a slider imposes has no powers beyond the second, unless it oscillates.
            let all = k <= 2 + waves;
            let factor = power.ahead * per_span;
            let damped = beta * factor;
            let stretch = std::array::from_fn(|i| c[i] + damped * next[i]);
            let mut sum = matrices.add_springs::<N, P>(&stretch, all, start);
            if is_damped {
                sum = matrices.add_dampers::<N, P>(&next.map(|c| factor * c), all, sum);
            }
            *row = sum;
            let factor = square * power.integrated_twice;
            *new = std::array::from_fn(|i| factor * sum[i] * is_free[i]);
            if k > 0 && k < waves {
                let (waves, swung) = (&self.waves, &mut self.swung);
                waves.write_accelerations(&inputs.waves, (k, power.ahead), self.span, swung);
                for &(dof, contact) in &self.carriers {
                    new[dof] += factor * swung[contact];
                }
            }
            if k == 0 {
                *new = std::array::from_fn(|i| new[i] + factor * carried[i]);
                negligible = TRUNCATION * (size(c) + size(next) + size(new));
                continue;
            }
            if k == 1 {
                // A motion at rest without forces is started by force rates alone.
                negligible += TRUNCATION * size(new);
            }
            for (swing, force) in swing.iter_mut().zip(sum) {
                *swing += force.abs();
            }
            if may_end && k % 2 == 1 && k >= waves && size(next) + size(new) <= negligible {
                break;
            }
        }
        self.swing.copy_from_slice(&swing);
    }

    /// Row of the rates of the outer forces, times the span.
    #[inline]
    fn small_rate<const N: usize>(
        &mut self,
        dynamics: &Dynamics,
        inputs: &Inputs,
        friction: &[Friction],
    ) -> [f64; N] {
        let mut row = [0.0; N];
        if inputs.force_rate.iter().any(|rate| *rate != 0.0) {
            let zeros = &self.zeros;
            self.law.set(dynamics, &self.states, friction);
            let acting = Actions {
                stretch: &zeros[..self.dofs],
                velocity: &zeros[..self.dofs],
                outer: &inputs.force_rate,
                slider: &zeros[..self.states.len()],
            };
            self.law.apply(dynamics, acting, &mut row);
        }
        row.map(|value| self.span * value)
    }

    /// Writes the rows of the powers of the waves.
    fn write_wave_rows(&mut self, dynamics: &Dynamics, inputs: &Inputs, friction: &[Friction]) {
        let Self { law, waves, wave_rows, outer_rate, swung, zeros, dofs, places, span, .. } = self;
        if waves.powers() == 0 {
            return;
        }
        law.set(dynamics, &self.states, friction);
        wave_rows.resize((FORCE_ORDER + 1) * *places, 0.0);
        let rows = wave_rows.chunks_exact_mut(*places).zip(&POWERS).enumerate();
        for (k, (row, power)) in rows.take(waves.powers()).skip(1) {
            outer_rate.fill(0.0);
            waves.add_forces(&inputs.waves, k, outer_rate);
            waves.write_accelerations(&inputs.waves, (k, power.ahead), *span, swung);
            let zeros = &zeros[..*dofs];
            let acting =
                Actions { stretch: zeros, velocity: zeros, outer: outer_rate, slider: swung };
            law.apply(dynamics, acting, row);
        }
    }

    /// The recursion with sparse matrices.
    fn large(&mut self, dynamics: &Dynamics, inputs: &Inputs, now: SeriesStart<'_>) {
        let is_rubbed = self.is_rubbed();
        let Self { law, stretch, velocity, zeros, outer_rate, dofs, span, waves, swung, .. } = self;
        law.set(dynamics, &self.states, now.friction);
        let may_end = self.friction_changes.is_empty();
        let places = self.places;
        let (per_span, square) = (1.0 / *span, *span * *span);
        let mut negligible = 0.0;
        self.swing.fill(0.0);
        for (k, power) in POWERS.iter().enumerate() {
            let (past, rows) = self.forces.split_at_mut(k * places);
            let row = &mut rows[..places];
            let (known, new) = self.displacement.split_at_mut((k + 2) * places);
            let (c, next) = known[k * places..].split_at(places);
            let new = &mut new[..places];
            self.order = k + 2;
            for dof in 0..*dofs {
                velocity[dof] = power.ahead * per_span * next[dof];
                stretch[dof] = c[dof] + dynamics.damping.beta * velocity[dof];
            }
            let swings = (1..waves.powers()).contains(&k);
            let rubs = is_rubbed && k > 0;
            if k == 1 {
                for (scaled, rate) in outer_rate.iter_mut().zip(&inputs.force_rate) {
                    *scaled = *span * rate;
                }
            } else if swings || rubs {
                outer_rate.fill(0.0);
            }
            if rubs {
                let changes = &self.friction_changes;
                add_friction(changes, &dynamics.contacts, law, (past, places), k, outer_rate);
            }
            if swings {
                waves.add_forces(&inputs.waves, k, outer_rate);
                waves.write_accelerations(&inputs.waves, (k, power.ahead), *span, swung);
            }
            let [no_force, no_acceleration] = [*dofs, self.slider.len()].map(|n| &zeros[..n]);
            let outer = match k {
                0 => now.outer,
                1 => &*outer_rate,
                _ if swings || rubs => &*outer_rate,
                _ => no_force,
            };
            let slider = match k {
                0 => now.slider,
                _ if swings => &*swung,
                _ => no_acceleration,
            };
            law.apply(dynamics, Actions { stretch, velocity, outer, slider }, row);
            let factor = square * power.integrated_twice;
            for ((new, row), is_free) in new.iter_mut().zip(&*row).zip(&self.is_free) {
                *new = factor * row * is_free;
            }
            if swings {
                for &(dof, contact) in &self.carriers {
                    new[dof] += factor * swung[contact];
                }
            }
            if k == 0 {
                for (new, carried) in new.iter_mut().zip(&self.carried) {
                    *new += factor * carried;
                }
                negligible = TRUNCATION * (size(c) + size(next) + size(new));
                continue;
            }
            if k == 1 {
                negligible += TRUNCATION * size(new);
            }
            for (swing, force) in self.swing.iter_mut().zip(&*row) {
                *swing += force.abs();
            }
            if may_end && k % 2 == 1 && k >= waves.powers() && size(next) + size(new) <= negligible
            {
                break;
            }
        }
    }

    /// Shortens the span to the part that the powers cover up to rounding.
    fn shorten(&mut self) {
        let size = |k: usize| size(&self.displacement[k * self.places..][..self.places]);
        let last = [ORDER - 1, ORDER].map(size);
        let first: [f64; ORDER - 1] = std::array::from_fn(size);
        // Where friction changes, the first powers may be nothing and later ones not.
        let first = if self.friction_changes.is_empty() { &first[..4] } else { &first };
        let (mut part, mut power) = (1.0, 1.0);
        for _ in 0..MOST_SHORTENINGS {
            let is_covered = power * (last[0] + last[1] * part) <= TRUNCATION * value(first, part);
            if is_covered && self.covers_friction(part) {
                break;
            }
            part *= SHORTER;
            power *= LEFT_OF_LAST;
        }
        if part == 1.0 {
            return;
        }
        self.span *= part;
        let scale = |rows: &mut [f64]| {
            let mut power = 1.0;
            for row in rows.chunks_exact_mut(self.places) {
                row.iter_mut().for_each(|c| *c *= power);
                power *= part;
            }
        };
        scale(&mut self.displacement);
        scale(&mut self.forces);
        self.waves.shorten(part);
        for powers in self.friction_changes.iter_mut().flat_map(|change| &mut change.powers) {
            let mut power = 1.0;
            for value in powers {
                *value *= power;
                power *= part;
            }
        }
    }

    /// `true` if the powers of µ N that forces leave out are negligible over this part of the span, at every contact whose
    /// friction changes.
    fn covers_friction(&self, part: f64) -> bool {
        self.friction_changes.iter().all(|change| {
            let [normal, _] = self.law.places(change.contact);
            let friction = change.acting().map(f64::abs);
            let forces: [f64; FORCE_ORDER + 1] =
                std::array::from_fn(|k| self.forces[k * self.places + normal].abs());
            let whole = value(&friction, part) * value(&forces, part);
            let kept = |k: usize| (0..=k).fold(0.0, |sum, j| sum + friction[j] * forces[k - j]);
            let kept: [f64; FORCE_ORDER + 1] = std::array::from_fn(kept);
            // The difference of sums of positive terms is exact to a few of their roundings.
            whole - value(&kept, part) <= 16.0 * f64::EPSILON * whole
        })
    }

    /// The covered time, s.
    pub(super) fn span(&self) -> f64 {
        self.span
    }

    /// The degree of freedom whose numbers are the first to leave their range: that of the lowest power that is not
    /// finite, or where all are finite, that of the largest number of the highest power.
    #[cold]
    pub(super) fn first_out_of_range(&self) -> usize {
        let powers = self.displacement.chunks_exact(self.places).take(self.order + 1);
        let mut powers = powers.map(|row| &row[..self.dofs]);
        if let Some(dof) = powers.clone().find_map(|row| row.iter().position(|c| !c.is_finite())) {
            return dof;
        }
        let largest = |row: &[f64]| {
            let sizes = row.iter().map(|c| c.abs()).enumerate();
            sizes.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or_default()
        };
        powers.next_back().map(largest).unwrap_or_default().0
    }

    /// The highest power in use of the displacements.
    pub(super) fn order(&self) -> usize {
        self.order
    }

    /// The state of a contact.
    pub(super) fn state(&self, contact: usize) -> ContactState {
        self.states[contact]
    }

    /// Evaluates x and ẋ at `s` of the span.
    pub(super) fn evaluate(&mut self, s: f64, x: &mut [f64], v: &mut [f64]) {
        match self.places {
            4 => self.evaluate_rows::<4>(s),
            8 => self.evaluate_rows::<8>(s),
            12 => self.evaluate_rows::<12>(s),
            16 => self.evaluate_rows::<16>(s),
            _ => {
                self.stretch.fill(0.0);
                self.velocity.fill(0.0);
                for c in self.displacement.chunks_exact(self.places).take(self.order + 1).rev() {
                    for ((x, v), c) in self.stretch.iter_mut().zip(&mut self.velocity).zip(c) {
                        *v = *v * s + *x;
                        *x = *x * s + c;
                    }
                }
            }
        }
        x.copy_from_slice(&self.stretch[..self.dofs]);
        for (v, by_span) in v.iter_mut().zip(&self.velocity) {
            *v = by_span / self.span;
        }
    }

    fn evaluate_rows<const N: usize>(&mut self, s: f64) {
        let (mut x, mut v) = ([0.0; N], [0.0; N]);
        for c in self.displacement.as_chunks::<N>().0[..=self.order].iter().rev() {
            for i in 0..N {
                v[i] = v[i] * s + x[i];
                x[i] = x[i] * s + c[i];
            }
        }
        self.stretch[..N].copy_from_slice(&x);
        self.velocity[..N].copy_from_slice(&v);
    }

    /// The largest acceleration at the beginning times half the square of the span, m.
    pub(super) fn largest_bend(&self) -> f64 {
        self.largest(2)
    }

    /// The power k of the displacements, m.
    pub(super) fn power(&self, k: usize) -> &[f64] {
        &self.displacement[k * self.places..][..self.places]
    }

    /// The largest magnitude in power k of the displacements, m.
    pub(super) fn largest(&self, k: usize) -> f64 {
        self.power(k)
            .iter()
            .fold(0.0, |largest, c| if c.abs() > largest { c.abs() } else { largest })
    }

    /// Writes the powers of the displacement along a direction, m; returns the number of powers.
    pub(super) fn along(&self, direction: &Direction, polynomial: &mut Polynomial) -> usize {
        let terms = self.order + 1;
        self.gather_along(&self.displacement, direction, &mut polynomial[..terms]);
        terms
    }

    /// Writes the powers of the velocity along a direction times the span, m; returns the number of powers.
    pub(super) fn moved(&self, direction: &Direction, polynomial: &mut Polynomial) -> usize {
        let terms = self.order;
        let polynomial = &mut polynomial[..terms];
        self.gather_along(&self.displacement[self.places..], direction, polynomial);
        for (value, power) in polynomial.iter_mut().zip(&POWERS) {
            *value *= power.ahead;
        }
        terms
    }

    /// Writes the powers of N of a contact, N; returns their number.
    pub(super) fn normal_force(&self, contact: usize, polynomial: &mut Polynomial) -> usize {
        let [normal, _] = self.law.places(contact);
        let terms = self.order - 1;
        self.gather(&self.forces, normal, &mut polynomial[..terms]);
        terms
    }

    /// Writes the powers of T of a closed contact, N; returns their number. `law` must be set to the states of the
    /// series.
    pub(super) fn friction_force(&self, contact: usize, polynomial: &mut Polynomial) -> usize {
        if self.states[contact] != ContactState::Stick {
            let terms = self.normal_force(contact, polynomial);
            let slope = self.law.slope(contact);
            let change = self.friction_change(contact);
            // From the last power down: a power of T needs all of N below it.
            for k in (0..terms).rev() {
                let added =
                    change.map_or(0.0, |change| change.product(k, |power| polynomial[power]));
                let direction = change.and_then(|change| change.direction).unwrap_or(1.0);
                polynomial[k] = slope * polynomial[k] + direction * added;
            }
            return terms;
        }
        let [_, tangent] = self.law.places(contact);
        let terms = self.order - 1;
        self.gather(&self.forces, tangent, &mut polynomial[..terms]);
        terms
    }

    /// Writes the powers of µN − s T of a contact that sticks, N; returns their number.
    pub(super) fn reserve(
        &self,
        contact: usize,
        friction: f64,
        sign: f64,
        polynomial: &mut Polynomial,
    ) -> usize {
        let [normal, tangent] = self.law.places(contact);
        let terms = self.order - 1;
        let (forces, places) = (&*self.forces, self.places);
        let mut row = 0;
        for value in &mut polynomial[..terms] {
            *value = friction * forces[row + normal] - sign * forces[row + tangent];
            row += places;
        }
        if let Some(change) = self.friction_change(contact) {
            for (k, value) in polynomial[..terms].iter_mut().enumerate() {
                *value += change.product(k, |power| forces[power * places + normal]);
            }
        }
        terms
    }

    /// The change of the friction coefficients of a contact; `None` if they stay.
    fn friction_change(&self, contact: usize) -> Option<&FrictionChange> {
        let changes = &self.friction_changes;
        let place = changes.binary_search_by_key(&contact, |change| change.contact);
        place.ok().map(|place| &changes[place])
    }

    /// Normal force N of a contact at the beginning, N.
    pub(super) fn first_normal_force(&self, contact: usize) -> f64 {
        self.forces[self.law.places(contact)[0]]
    }

    /// Forces (N, T) of a contact at the beginning, N.
    pub(super) fn first_forces(&self, contact: usize) -> [f64; 2] {
        let [normal, tangent] = self.law.places(contact).map(|place| self.forces[place]);
        match self.states[contact] {
            ContactState::Detached => [0.0; 2],
            ContactState::Stick => [normal, tangent],
            _ => [normal, self.law.slope(contact) * normal],
        }
    }

    /// Lower bound of N of a contact over the span, N.
    pub(super) fn least_normal_force(&self, contact: usize) -> f64 {
        let [normal, _] = self.law.places(contact);
        self.forces[normal] - self.swing[normal]
    }

    /// Lower bound of µ N of a contact that sticks over the span, N; `friction` is µ at the beginning.
    pub(super) fn least_limit(&self, contact: usize, friction: f64) -> f64 {
        let lost = self.friction_change(contact).map_or(0.0, |change| size(&change.acting()[1..]));
        f64::max(friction - lost, 0.0) * self.least_normal_force(contact)
    }

    /// Upper bound of |T| of a contact that sticks over the span, N.
    pub(super) fn most_stuck_force(&self, contact: usize) -> f64 {
        let [_, tangent] = self.law.places(contact);
        self.forces[tangent].abs() + self.swing[tangent]
    }

    /// Collects the values of one place, power by power.
    fn gather(&self, rows: &[f64], mut place: usize, values: &mut [f64]) {
        let places = self.places;
        for value in values {
            *value = rows[place];
            place += places;
        }
    }

    /// Collects the values along a direction, power by power.
    fn gather_along(&self, rows: &[f64], direction: &Direction, values: &mut [f64]) {
        if let Some(dof) = direction.as_unit() {
            return self.gather(rows, dof, values);
        }
        for (value, row) in values.iter_mut().zip(rows.chunks_exact(self.places)) {
            *value = direction.dot(row);
        }
    }
}

/// Adds power k of the forces that changes of friction coefficients cause at contacts that slide, N. `past` has the
/// powers of the forces below k, in rows of this many places.
fn add_friction(
    changes: &[FrictionChange],
    contacts: &[Contact],
    law: &StateLaw,
    (past, places): (&[f64], usize),
    k: usize,
    outer: &mut [f64],
) {
    for change in changes {
        let Some(direction) = change.direction else { continue };
        let [normal, _] = law.places(change.contact);
        let force = direction * change.product(k, |power| past[power * places + normal]);
        contacts[change.contact].tangent.add_to(outer, force);
    }
}

/// The value of a polynomial.
fn value(powers: &[f64], at: f64) -> f64 {
    powers.iter().rev().fold(0.0, |sum, power| sum * at + power)
}

/// Memory for a polynomial of the series.
pub(super) type Polynomial = [f64; ORDER + 1];

/// The first N values of a row as an array.
fn first<const N: usize>(row: &[f64]) -> &[f64; N] {
    row.first_chunk().expect("rows have N places")
}

/// Σ |c|.
fn size(row: &[f64]) -> f64 {
    roots::sum_of_sizes(row)
}

#[cfg(test)]
mod tests;
