//! Growth and decay mode by mode while no contact changes its state.
//!
//! Between two changes the motion is linear and its whole state (x, v) is known, so the part of each mode is known at
//! each row: s = Σ a_k (r_k, λ_k r_k), a solution of linear equations. Each a_k then follows its own exponential,
//! whatever the other modes do, so a growth is seen however fast it is, and from whichever output. What is straight
//! is measured: rate and frequency are those of a_k over time, and a motion that is not the mode's is not straight.
//!
//! A state that is not the one at rest has its own equilibrium, which may move as a straight line (a mass that sticks
//! goes with the slider), and a load that has changed shifts the one at rest. A sine among the signals makes an oscillation
//! that does not decay. A difference of several rows leaves neither such lines nor such oscillations, and of an
//! exponential a multiple.

use super::curve::Curve;
use super::growth::{Phase, ROUNDING};
use super::straight::Fit;
use crate::contact::ContactState;
use crate::model::LumpedModel;
use crate::study::basis::Basis;
use nalgebra::Complex;
use std::collections::HashMap;
use std::f64::consts::{LN_10, TAU};

/// The most rows that are kept of a stretch; of a longer one every other is dropped, again and again.
const MOST_ROWS: usize = 512;
/// A stretch of fewer rows is not looked at, nor a line through fewer points.
const FEWEST_ROWS: usize = 16;
const FEWEST_POINTS: usize = 8;
/// A mode that is nowhere this part of the largest of its time does not matter for what the motion is.
const FAINT: f64 = 3e-2;
/// How well rates and frequencies are known that are straight to rounding, in parts of |λ|.
pub(super) const FINEST: f64 = 1e-9;

/// The growth and decay of modes that a run has shown.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Found {
    /// Changes by a factor of ten or more.
    pub(super) phases: Vec<Phase>,
    /// Changes by less, over the whole of a stretch.
    pub(super) slow: Vec<Phase>,
    /// Where the modes explain the motion: all that matter follow their exponentials; s.
    pub(super) explained: Vec<[f64; 2]>,
}

/// A degree of freedom's displacement or velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Observed {
    pub(super) dof: usize,
    pub(super) is_velocity: bool,
}

/// Follows a run row by row.
pub(super) struct Follower {
    model: LumpedModel,
    friction: f64,
    names: Vec<String>,
    /// The largest displacement at rest, m.
    largest: f64,
    interval: f64,
    /// The frequencies of the sines among the signals, Hz, each once.
    drives: Vec<f64>,
    known: HashMap<Vec<ContactState>, Option<Basis>>,
    stretch: Option<Rows>,
    finished: Vec<Traced>,
}

/// The rows of one stretch.
struct Rows {
    states: Vec<ContactState>,
    /// Changes of state up to here.
    changes: u64,
    first: usize,
    last: usize,
    /// Each so many rows one is kept.
    step: usize,
    /// Displacements, then velocities.
    kept: Vec<Vec<f64>>,
}

impl Rows {
    fn push(&mut self, row: usize, displacement: &[f64], velocity: &[f64]) {
        self.last = row;
        if !(row - self.first).is_multiple_of(self.step) {
            return;
        }
        if self.kept.len() == MOST_ROWS {
            let mut place = 0;
            self.kept.retain(|_| {
                place += 1;
                place % 2 == 1
            });
            self.step *= 2;
            if !(row - self.first).is_multiple_of(self.step) {
                return;
            }
        }
        self.kept.push([displacement, velocity].concat());
    }
}

/// The modes of a stretch over its time.
struct Traced {
    span: [f64; 2],
    modes: Vec<Trace>,
    /// `true` where the modes that matter follow their exponentials all the time.
    is_explained: bool,
}

/// The growth or decay of one mode in a stretch.
struct Trace {
    eigenvalue: Complex<f64>,
    /// The amplitude of each degree of freedom, in parts of the largest.
    shape: Vec<f64>,
    dof: usize,
    span: [f64; 2],
    fit: Fit,
    /// And how far it may be off, Hz.
    frequency: [f64; 2],
    /// `true` where the mode is a fair part of the motion at some time.
    matters: bool,
}

impl Follower {
    /// For a run of a model that is linearised about its equilibrium, with rows each `interval` (s) and degrees of
    /// freedom of these names, driven with the frequencies of `drives` (Hz, each once).
    pub(super) fn of(
        model: LumpedModel,
        friction: f64,
        names: Vec<String>,
        equilibrium: &[f64],
        interval: f64,
        drives: Vec<f64>,
    ) -> Self {
        let largest = most(equilibrium);
        let (known, finished) = (HashMap::new(), Vec::new());
        Self { model, friction, names, largest, interval, drives, known, stretch: None, finished }
    }

    /// Takes the next row: the contacts' states, how often they have changed since the start, displacements from the
    /// equilibrium (m) and velocities (m/s).
    pub(super) fn row(
        &mut self,
        row: usize,
        states: &[ContactState],
        changes: u64,
        displacement: &[f64],
        velocity: &[f64],
    ) {
        let goes_on = |rows: &Rows| rows.changes == changes && rows.states == states;
        if !self.stretch.as_ref().is_some_and(goes_on) {
            self.close();
            let states = states.to_vec();
            let (step, kept) = (1, Vec::new());
            self.stretch = Some(Rows { states, changes, first: row, last: row, step, kept });
        }
        if let Some(rows) = &mut self.stretch {
            rows.push(row, displacement, velocity);
        }
    }

    fn close(&mut self) {
        let Some(rows) = self.stretch.take() else { return };
        if rows.kept.len() < FEWEST_ROWS {
            return;
        }
        let Self { model, friction, known, drives, .. } = self;
        let basis = known
            .entry(rows.states.clone())
            .or_insert_with_key(|states| Basis::of(model, states, *friction));
        let Some(basis) = basis else { return };
        let traced = basis.trace(&rows, drives, self.interval, self.largest);
        self.finished.push(traced);
    }

    /// All that was found once the run is over; amplitudes are those of the output where it is a displacement or
    /// a velocity, and else of the displacement that moves most in the mode.
    pub(super) fn found(mut self, observed: Option<Observed>) -> Found {
        self.close();
        let mut found = Found::default();
        for Traced { span, modes, is_explained } in &self.finished {
            for mode in modes {
                let phase = mode.phase(observed, &self.names);
                let change = mode.fit.slope * (phase.span[1] - phase.span[0]);
                if change.abs() >= LN_10 {
                    found.phases.push(phase);
                } else if change.abs() > 0.0 && phase.rate.abs() > phase.rate_error && mode.matters
                {
                    found.slow.push(phase);
                }
            }
            if *is_explained {
                found.explained.push(*span);
            }
        }
        found
    }
}

impl Trace {
    fn phase(&self, observed: Option<Observed>, names: &[String]) -> Phase {
        let (factor, displacement) = match observed {
            Some(Observed { dof, is_velocity }) => {
                let per_time = if is_velocity {
                    libm::hypot(self.eigenvalue.re, self.eigenvalue.im)
                } else {
                    1.0
                };
                (self.shape[dof] * per_time, None)
            }
            None => (1.0, Some(names[self.dof].clone())),
        };
        let mut phase = Phase::of(None, self.span, &self.fit, self.frequency);
        phase.amplitude = phase.amplitude.map(|amplitude| factor * amplitude);
        phase.rate_error += FINEST * libm::hypot(self.eigenvalue.re, self.eigenvalue.im);
        phase.displacement = displacement;
        phase
    }
}

impl Basis {
    #[allow(clippy::cast_precision_loss)]
    fn trace(&self, rows: &Rows, drives: &[f64], interval: f64, largest: f64) -> Traced {
        let begin = rows.first as f64 * interval;
        let step = rows.step as f64 * interval;
        let span = [begin, rows.last as f64 * interval];
        let coefficients: Vec<_> = rows.kept.iter().map(|kept| self.coefficients(kept)).collect();
        // The largest displacement of a row or before.
        let mut level = largest;
        let levels: Vec<f64> = rows
            .kept
            .iter()
            .map(|kept| {
                level = f64::max(level, most(&kept[..kept.len() / 2]));
                level
            })
            .collect();
        let curves: Vec<Curve> =
            self.modes.iter().filter_map(|mode| mode.curve(&coefficients, drives, step)).collect();
        let strongest = |i: usize| {
            curves
                .iter()
                .filter_map(|curve| curve.values.get(i))
                .fold(0.0, |most, w| f64::max(most, w.norm()))
        };
        let strongest: Vec<f64> = (0..coefficients.len()).map(strongest).collect();
        let mut traced = Traced { span, modes: Vec::new(), is_explained: true };
        for curve in &curves {
            let is_seen = |i: &usize| {
                let last = (i + curve.reach).min(levels.len() - 1);
                curve.values[*i].norm() > ROUNDING * curve.noise * levels[last]
            };
            let seen: Vec<usize> = (0..curve.values.len()).filter(is_seen).collect();
            let matters = seen.iter().any(|&i| curve.values[i].norm() >= FAINT * strongest[i]);
            for run in seen.chunk_by(|a, b| a + 1 == *b) {
                let found = curve.straight(run[0]..run[0] + run.len(), begin, step);
                traced.is_explained &=
                    !matters || found.iter().all(|(range, _)| range.len() == run.len());
                for (range, fit) in found {
                    let is_end = range.end == curve.values.len();
                    let ends = [range.start, range.end - 1 + if is_end { curve.reach } else { 0 }];
                    let span = ends.map(|i| begin + i as f64 * step);
                    let lambda = curve.members.eigenvalue;
                    if range.len() < FEWEST_POINTS || (span[1] - span[0]) * lambda.im < TAU {
                        continue;
                    }
                    traced.modes.push(Trace {
                        eigenvalue: lambda,
                        shape: curve.shape.clone(),
                        dof: curve.dof,
                        span,
                        fit,
                        frequency: curve.frequency(range, begin, step),
                        matters,
                    });
                }
            }
        }
        traced
    }
}

/// The largest modulus.
pub(super) fn most(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| f64::max(most, value.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::parse;

    const RATE: f64 = 10.0;
    const FREQUENCY: f64 = 11.0;

    /// A mass that decays as exp(−10 t) at 11 Hz: tenfold within 2.5 periods.
    fn follower(drives: Vec<f64>) -> Follower {
        let omega_squared = (TAU * FREQUENCY).powi(2) + RATE * RATE;
        let text = format!(
            "[[mass]]\nname = \"m\"\nmass = 1.0\nlocked = [\"y\"]\n[[spring]]\nname = \"k\"\n\
             between = [\"m\", \"ground\"]\ndirection = \"x\"\nstiffness = {omega_squared:?}\n[[damper]]\n\
             name = \"d\"\nbetween = [\"m\", \"ground\"]\ndirection = \"x\"\ndamping = {:?}\n\
             [integrator]\nstep = 1e-3\n[experiment]\nstop_time = 1.0\noutput_interval = 1e-3\n",
            2.0 * RATE
        );
        let scene = parse("decaying", &text).unwrap();
        Follower::of(LumpedModel::from(&scene), 0.0, scene.dof_names(), &[0.0], 1e-3, drives)
    }

    /// A exp(−10 t) cos(ω t) beside a straight line, over so many rows of 1 ms.
    #[allow(clippy::cast_precision_loss)]
    fn follow(follower: &mut Follower, rows: usize, amplitude: f64, line: [f64; 2]) {
        for row in 0..rows {
            let t = 1e-3 * row as f64;
            let lambda = Complex::new(-RATE, TAU * FREQUENCY);
            let x = (lambda * t).exp() * amplitude;
            let state = [x.re + line[0] + line[1] * t, (lambda * x).re + line[1]];
            follower.row(row, &[], 0, &state[..1], &state[1..]);
        }
    }

    const OBSERVED: Option<Observed> = Some(Observed { dof: 0, is_velocity: false });

    #[test]
    fn a_decay_of_three_periods_is_found_beside_a_line_a_thousand_times_as_large() {
        for line in [[0.0, 0.0], [1e-3, 0.0], [1e-3, -5e-3]] {
            let mut follower = follower(Vec::new());
            follow(&mut follower, 280, 1e-6, line);
            let found = follower.found(OBSERVED);
            let [phase] = &found.phases[..] else { panic!("{found:?}") };
            assert!((phase.rate + RATE).abs() <= phase.rate_error.min(1e-4), "{phase:?}");
            let error = phase.frequency_error.min(1e-4);
            assert!((phase.frequency - FREQUENCY).abs() <= error, "{phase:?}");
            for (amplitude, time) in phase.amplitude.iter().zip(phase.span) {
                let exact = 1e-6 * libm::exp(-RATE * time);
                assert!((amplitude / exact - 1.0).abs() < 1e-4, "{phase:?}");
            }
            assert_eq!(found.explained.len(), 1);
        }
    }

    #[test]
    fn a_decay_is_found_beside_driven_oscillations_a_thousand_times_as_large() {
        // One of the drives is within a tenth of the mode's own frequency.
        let drives = [3.0, 10.5];
        let mut follower = follower(drives.to_vec());
        for row in 0..280_u16 {
            let t = 1e-3 * f64::from(row);
            let lambda = Complex::new(-RATE, TAU * FREQUENCY);
            let own = (lambda * t).exp() * 1e-6;
            let mut state = [own.re, (lambda * own).re];
            for frequency in drives {
                let (sin, cos) = libm::sincos(TAU * frequency * t + 0.4);
                state[0] += 1e-3 * sin;
                state[1] += 1e-3 * TAU * frequency * cos;
            }
            follower.row(usize::from(row), &[], 0, &state[..1], &state[1..]);
        }
        let found = follower.found(OBSERVED);
        let [phase] = &found.phases[..] else { panic!("{found:?}") };
        assert!((phase.rate + RATE).abs() <= phase.rate_error.min(1e-4), "{phase:?}");
        let error = phase.frequency_error.min(1e-4);
        assert!((phase.frequency - FREQUENCY).abs() <= error, "{phase:?}");
        assert!((phase.amplitude[0] / 1e-6 - 1.0).abs() < 1e-4, "{phase:?}");
        assert_eq!(found.explained.len(), 1);
    }

    #[test]
    fn rounding_is_not_followed() {
        // After 2.76 s the decay is at 1e-12 of the line.
        let mut follower = follower(Vec::new());
        follow(&mut follower, 6000, 1.0, [1.0, 0.0]);
        let found = follower.found(OBSERVED);
        let [phase] = &found.phases[..] else { panic!("{found:?}") };
        assert!((2.5..2.9).contains(&phase.span[1]) && phase.rate_error < 1e-3, "{phase:?}");
    }

    #[test]
    fn less_than_tenfold_is_slow_and_another_motion_is_not_explained() {
        let mut slow = follower(Vec::new());
        follow(&mut slow, 150, 1.0, [0.0, 0.0]);
        let found = slow.found(OBSERVED);
        assert_eq!(found.phases, []);
        assert!((found.slow[0].rate + RATE).abs() <= found.slow[0].rate_error, "{found:?}");
        // The same mass driven at 3 Hz.
        let mut driven = follower(Vec::new());
        for row in 0..500_u16 {
            let (sin, cos) = libm::sincos(TAU * 3.0 * 1e-3 * f64::from(row));
            driven.row(usize::from(row), &[], 0, &[sin], &[TAU * 3.0 * cos]);
        }
        let found = driven.found(OBSERVED);
        assert_eq!(found.phases, []);
    }
}
