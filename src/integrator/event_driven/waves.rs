//! Power series in time of the waves that drive a motion.
//!
//! A wave A sin(ω t + φ) has the powers A sin(φ + k π/2) θ^k / k! over a span of angle θ = ω τ, with φ at the
//! beginning of the span. They end with the first θ^k / k! ≤ ε/2.

use super::series::{FORCE_ORDER, ORDER, Polynomial};
use crate::integrator::Wave;

/// Largest angle of a wave that a series covers, rad: 2.5²⁶/26! = 5.5e-17 is below ε/2, so powers end with the
/// highest one of forces.
const REACH: f64 = 2.5;
/// The power of a wave below this part of its amplitude is the last one.
const NEGLIGIBLE: f64 = 0.5 * f64::EPSILON;

/// The powers of all waves over the span of a series, in which s goes from 0 to 1.
pub(super) struct Waves {
    /// One polynomial for each wave.
    values: Vec<Polynomial>,
    /// Number of powers; zero where no wave has an amplitude.
    powers: usize,
}

impl Waves {
    pub(super) fn new() -> Self {
        Self { values: Vec::new(), powers: 0 }
    }

    /// Reserves memory for `count` waves.
    pub(super) fn make_room(&mut self, count: usize) {
        self.values.resize(count, [0.0; ORDER + 1]);
    }

    /// Returns the time (s) that a series may cover, up to `most`.
    pub(super) fn reach(waves: &[Wave], most: f64) -> f64 {
        waves.iter().fold(most, |most, wave| {
            if wave.amplitude == 0.0 { most } else { most.min(REACH / wave.pulsation) }
        })
    }

    /// Expands the powers over `span` (s), which begins `passed` (s) after the beginning of the step.
    pub(super) fn expand(&mut self, waves: &[Wave], passed: f64, span: f64) {
        self.make_room(waves.len());
        self.powers = 0;
        for (wave, values) in waves.iter().zip(&mut self.values) {
            values.fill(0.0);
            if wave.amplitude == 0.0 {
                continue;
            }
            let angle = wave.pulsation * span;
            let phase = wave.phase_after(passed);
            let (sin, cos) = (libm::sin(phase), libm::cos(phase));
            // The derivatives of a sine.
            let turns = [sin, cos, -sin, -cos];
            let (mut factor, mut power) = (1.0, 0.0);
            for (k, value) in values[..=FORCE_ORDER].iter_mut().enumerate() {
                *value = wave.amplitude * factor * turns[k % 4];
                self.powers = self.powers.max(k + 1);
                // The last power is for the rate alone.
                if factor <= NEGLIGIBLE {
                    break;
                }
                power += 1.0;
                factor *= angle / power;
            }
        }
    }

    /// Adapts the powers to a span that is shortened to this part.
    pub(super) fn shorten(&mut self, part: f64) {
        for values in &mut self.values {
            let mut power = 1.0;
            for value in values {
                *value *= power;
                power *= part;
            }
        }
    }

    /// Number of powers; zero where no wave has an amplitude.
    pub(super) fn powers(&self) -> usize {
        self.powers
    }

    /// Adds power `k` of the forces to `outer` (N).
    pub(super) fn add_forces(&self, waves: &[Wave], k: usize, outer: &mut [f64]) {
        for (wave, values) in waves.iter().zip(&self.values) {
            for &(dof, force) in &wave.pushes {
                outer[dof] += force * values[k];
            }
        }
    }

    /// Writes power `k` of the slider accelerations that waves cause (m/s²); `span` is that of the series, s.
    // Kept out of the loops of a series, whose sums stay in registers where nothing oscillates.
    #[inline(never)]
    pub(super) fn write_accelerations(
        &self,
        waves: &[Wave],
        (k, ahead): (usize, f64),
        span: f64,
        sliders: &mut [f64],
    ) {
        sliders.fill(0.0);
        for (wave, values) in waves.iter().zip(&self.values) {
            for &contact in &wave.moves {
                sliders[contact] += ahead * values[k + 1] / span;
            }
        }
    }

    /// Adds the powers, from the first on, of a contact's µ_k or µ_s (`part` 0 or 1); `false` if no wave drives it.
    pub(super) fn add_friction(
        &self,
        waves: &[Wave],
        (contact, part): (usize, usize),
        polynomial: &mut Polynomial,
    ) -> bool {
        let mut is_driven = false;
        for (wave, values) in waves.iter().zip(&self.values) {
            let Ok(own) = wave.friction.binary_search_by_key(&contact, |driven| driven.0) else {
                continue;
            };
            let factor = wave.friction[own].1[part];
            is_driven |= factor * wave.amplitude != 0.0;
            for (sum, value) in polynomial.iter_mut().zip(values).take(self.powers).skip(1) {
                *sum += factor * value;
            }
        }
        is_driven
    }

    /// Adds the powers of a slider's velocity (m/s) from the second on: power k times `factor` · `ratio`ᵏ.
    pub(super) fn add_velocity(
        &self,
        waves: &[Wave],
        contact: usize,
        (factor, ratio): (f64, f64),
        polynomial: &mut [f64],
    ) {
        for (wave, values) in waves.iter().zip(&self.values) {
            if wave.moves.binary_search(&contact).is_err() {
                continue;
            }
            let mut factor = factor * ratio * ratio;
            for (sum, value) in polynomial.iter_mut().zip(values).take(self.powers).skip(2) {
                *sum += factor * value;
                factor *= ratio;
            }
        }
    }
}
