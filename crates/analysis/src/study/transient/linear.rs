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
use super::rows::{Drives, ExplainedInterval, Level, Rows};
use super::trace::Trace;
use crate::stability::Linearised;
use crate::study::basis::{Basis, scheme_step};
use amontons::contact::ContactState;
use amontons::numerics::max_norm;
use amontons::scene::Scene;
use nalgebra::Complex;
use std::collections::HashMap;
use std::f64::consts::{LN_10, TAU};
use std::ops::Range;

/// Masses that move by less than this part of the largest displacement from row to row stand still.
const STANDS: f64 = 1e-12;
/// The first rows of a mode are preferred to more, coarser rows if they show this part of the largest change.
const SHORTER: f64 = 0.9;
/// A stretch of fewer rows is not analysed, nor a line through fewer points.
const FEWEST_ROWS: usize = 16;
const FEWEST_POINTS: usize = 8;
/// A mode that is nowhere this part of the largest of its time does not matter for what the motion is.
const FAINT: f64 = 3e-2;
/// A mode that is not found over fewer periods may be found over more.
pub(super) const ENOUGH_PERIODS: f64 = 3.0;
/// A mode whose rate is larger than this in parts of its angular frequency is gone in rounding before a period is
/// over.
const GONE: f64 = 4.0;
/// For a mode that does not oscillate, the logarithm of its change below which it is nearly a straight line: a
/// difference of rows that removes straight lines then removes nearly all of it.
const FLAT: f64 = 0.85;
/// Accuracy of rates and frequencies that are straight to rounding, in parts of |λ|.
pub(super) const FINEST: f64 = 1e-9;

/// The growth and decay of modes that a run has shown.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Found {
    /// Changes by a factor of ten or more.
    pub(super) phases: Vec<Phase>,
    /// Changes by less.
    pub(super) slow: Vec<Slow>,
    /// Stretches in which the modes explain the motion: all that matter follow their exponentials.
    pub(super) explained: Vec<ExplainedInterval>,
    /// Modes that oscillate too slowly for the run to show them.
    pub(super) too_slow: Option<TooSlow>,
}

/// Modes that a run is too short for, from its beginning or from the last edge of a signal on: it holds too few of their periods,
/// or, of one that does not oscillate, cannot tell it from a straight line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TooSlow {
    /// Time from which on the run is too short, s.
    pub(super) from: f64,
    pub(super) count: usize,
    /// The frequency, Hz, of the one that takes longest; 0 where it does not oscillate.
    pub(super) slowest: f64,
    /// Time that the slowest one takes to show itself, s.
    pub(super) length: f64,
}

/// A change of a mode by a factor of less than ten.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Slow {
    pub(super) phase: Phase,
    /// `true` if it lasts from the beginning of the run, or from an edge of a signal, to where a contact changes its
    /// state or the run ends.
    pub(super) is_whole: bool,
    /// `true` if another mode grows beside it.
    pub(super) is_beside_growth: bool,
}

/// A degree of freedom's displacement or velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Observed {
    pub(super) dof: usize,
    pub(super) is_velocity: bool,
}

/// Follows a run row by row.
pub(super) struct Follower {
    here: Linearised,
    names: Vec<String>,
    /// The largest displacement at rest, m.
    largest: f64,
    interval: f64,
    /// The step of the paper's scheme, s; `None` of exact motion.
    step: Option<f64>,
    drives: Drives,
    /// `true` if the next stretch begins with the run or at an edge of a signal.
    is_woken: bool,
    known: HashMap<Vec<ContactState>, Option<Basis>>,
    stretch: Option<Rows>,
    finished: Vec<Traced>,
}

/// The modes of a stretch over its time.
struct Traced {
    states: Vec<ContactState>,
    modes: Vec<Trace>,
    /// The stretch, if the modes that matter follow their exponentials all the time.
    explained: Option<ExplainedInterval>,
}

impl Follower {
    /// For a run of a scene with this linearised model, with rows each `interval`, s.
    pub(super) fn of(scene: &Scene, here: Linearised, equilibrium: &[f64], interval: f64) -> Self {
        Self {
            here,
            names: scene.dof_names(),
            largest: max_norm(equilibrium),
            interval,
            step: scheme_step(scene),
            drives: Drives::of(&scene.signals),
            is_woken: true,
            known: HashMap::new(),
            stretch: None,
            finished: Vec::new(),
        }
    }

    /// `true` if the next row is beyond an edge of a signal. A new stretch begins there.
    #[allow(clippy::cast_precision_loss)]
    pub(super) fn passes_edge(&mut self, row: usize) -> bool {
        let passes = self.drives.passes_edge(row as f64 * self.interval);
        if passes {
            self.close(true);
            self.is_woken = true;
        }
        passes
    }

    /// Takes over the linearised model from here on.
    pub(super) fn renew(&mut self, here: &Linearised) {
        if self.here.model() != here.model() {
            self.here = here.clone();
            self.known.clear();
        }
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
        let continues = |rows: &Rows| rows.changes == changes && rows.states == states;
        if !self.stretch.as_ref().is_some_and(continues) {
            // A surface that is turned round at an edge is followed at once.
            #[allow(clippy::cast_precision_loss)]
            let is_at_edge = self.drives.next_edge <= row as f64 * self.interval * (1.0 + 1e-12);
            self.close(is_at_edge);
            self.stretch = Some(Rows::of(states, changes, self.is_woken, row));
            self.is_woken = false;
        }
        if let Some(rows) = &mut self.stretch {
            rows.push(row, displacement, velocity);
        }
    }

    /// Looks at the stretch that ends here, at an edge of a signal or not.
    fn close(&mut self, is_at_edge: bool) {
        let Some(rows) = self.stretch.take() else { return };
        if rows.levels[0].kept.len() < FEWEST_ROWS {
            return;
        }
        let (interval, largest) = (self.interval, self.largest);
        let drives = self.drives.frequencies.clone();
        let Some(basis) = self.basis(&rows.states) else {
            // A mass that a surface carries along slips again.
            let stands = drives.is_empty() && rows.fastest() * interval <= STANDS * largest;
            if stands && self.holds_all(&rows.states) {
                let explained = Some(ExplainedInterval { rests: true, ..rows.explained(interval) });
                self.finished.push(Traced { states: rows.states, modes: Vec::new(), explained });
            }
            return;
        };
        let mut traced = basis.trace(&rows, &drives, interval, largest);
        // Beyond an edge the modes go on.
        traced.modes.iter_mut().for_each(|mode| mode.lasts &= !is_at_edge);
        self.finished.push(traced);
    }

    /// `true` if contacts in these states leave the masses no motion of their own.
    fn holds_all(&self, states: &[ContactState]) -> bool {
        let reduced = self.here.linear().ok().and_then(|linear| linear.reduced(states));
        reduced.is_some_and(|reduced| reduced.motions.ncols() == 0)
    }

    fn basis(&mut self, states: &[ContactState]) -> Option<&Basis> {
        let Self { here, step, known, .. } = self;
        let of = |states: &Vec<ContactState>| Basis::of(here.linear().ok()?, states, *step);
        known.entry(states.to_vec()).or_insert_with_key(of).as_ref()
    }

    /// All that was found once the run is over; amplitudes are those of the output where it is a displacement or
    /// a velocity, and else of the displacement that moves most in the mode.
    pub(super) fn found(mut self, observed: Option<Observed>) -> Found {
        let last = self.stretch.as_ref().filter(|rows| rows.is_woken);
        let last = last.map(|rows| (rows.states.clone(), [rows.first, rows.last]));
        self.close(false);
        let mut found = Found::default();
        let modes = self.joined();
        let mut told: Vec<Complex<f64>> = Vec::new();
        for mode in &modes {
            let phase = mode.phase(observed, &self.names);
            let change = mode.change();
            if change.abs() >= LN_10 {
                told.push(mode.eigenvalue);
                found.phases.push(phase);
            } else if change.abs() > 0.0 && phase.rate.abs() > phase.rate_error && mode.matters {
                let grows_beside = |other: &Trace| {
                    let is_beside = other.span[0] < mode.span[1] && mode.span[0] < other.span[1];
                    is_beside && other.eigenvalue != mode.eigenvalue && other.fit.slope > 0.0
                };
                let is_beside_growth = modes.iter().any(grows_beside);
                let is_whole = mode.is_woken && mode.lasts;
                told.push(mode.eigenvalue);
                found.slow.push(Slow { phase, is_whole, is_beside_growth });
            }
        }
        found.explained = self.finished.iter().filter_map(|traced| traced.explained).collect();
        found.too_slow = last.and_then(|(states, rows)| self.too_slow(&states, rows, &told));
        found
    }

    /// The modes of a stretch from one row to another that were not found and may be once there are more periods.
    #[allow(clippy::cast_precision_loss)]
    fn too_slow(
        &mut self,
        states: &[ContactState],
        rows: [usize; 2],
        told: &[Complex<f64>],
    ) -> Option<TooSlow> {
        let [from, to] = rows.map(|row| row as f64 * self.interval);
        let all = &self.basis(states)?.modes;
        let fastest = all.iter().map(|members| members.eigenvalue.norm()).fold(0.0, f64::max);
        let is_slow = |lambda: &Complex<f64>| {
            let is_short = if lambda.im > 0.0 {
                lambda.re.abs() < GONE * lambda.im && lambda.im * (to - from) < TAU * ENOUGH_PERIODS
            } else {
                lambda.re.abs() > FINEST * fastest && lambda.re.abs() * (to - from) < FLAT
            };
            is_short && !told.contains(lambda)
        };
        let slow = all.iter().map(|members| members.eigenvalue).filter(is_slow);
        let needs = |lambda: Complex<f64>| match lambda.im / TAU {
            0.0 => [0.0, LN_10 / lambda.re.abs()],
            frequency => [frequency, ENOUGH_PERIODS / frequency],
        };
        let needs: Vec<[f64; 2]> = slow.map(needs).collect();
        let [slowest, length] = needs.iter().copied().max_by(|a, b| a[1].total_cmp(&b[1]))?;
        Some(TooSlow { from, count: needs.len(), slowest, length })
    }

    /// The modes of all stretches; a mode that continues unchanged over an edge is one.
    fn joined(&mut self) -> Vec<Trace> {
        let mut found: Vec<Trace> = Vec::new();
        // The traces of the stretch before, by their place in `found`.
        let mut before: (Vec<ContactState>, Range<usize>) = (Vec::new(), 0..0);
        for Traced { states, modes, .. } in &mut self.finished {
            let mut begin = found.len();
            for mode in modes.drain(..) {
                let last = (before.0 == *states).then_some(before.1.clone());
                let continues =
                    |place: &usize| found[*place].continues_in(&mode, 2.5 * self.interval);
                match last.into_iter().flatten().find(continues) {
                    Some(place) => {
                        begin -= 1;
                        let whole = found.remove(place).joined(&mode);
                        before.1.end -= 1;
                        found.push(whole);
                    }
                    None => found.push(mode),
                }
            }
            before = (states.clone(), begin..found.len());
        }
        found
    }
}

/// One mode as some rows of a stretch show it. The default is a mode that they do not show.
#[derive(Default)]
struct SeenMode {
    traces: Vec<Trace>,
    /// `true` where the mode is a fair part of the motion at some time.
    matters: bool,
    /// `true` where it follows one exponential for as long as it is seen.
    is_straight: bool,
    /// `true` where it is followed to the last of these rows.
    lasts: bool,
}

impl SeenMode {
    /// The largest change of the logarithm of the amplitude along one straight line, in modulus.
    fn change(&self) -> f64 {
        self.traces.iter().fold(0.0, |most, trace| f64::max(most, trace.change().abs()))
    }
}

impl Basis {
    /// The modes of a stretch whose rows are each `interval`, s, driven with the frequencies (Hz) of `drives`; `largest`: of
    /// the displacements at rest, m.
    #[allow(clippy::cast_precision_loss)]
    fn trace(&self, rows: &Rows, drives: &[f64], interval: f64, largest: f64) -> Traced {
        let begin = rows.first as f64 * interval;
        let seen_modes = |level: &Level| self.seen_modes(level, begin, drives, interval, largest);
        let mut levels: Vec<Vec<SeenMode>> = rows.levels.iter().map(seen_modes).collect();
        let whole = levels.iter().last().into_iter().flatten();
        let is_explained = whole.into_iter().all(|seen| seen.is_straight || !seen.matters);
        let explained = rows.explained(interval);
        let mut traced = Traced {
            states: rows.states.clone(),
            modes: Vec::new(),
            explained: is_explained.then_some(explained),
        };
        for mode in 0..self.modes.len() {
            // A mode that fades early is seen best in the first rows.
            let most = levels.iter().map(|seen| seen[mode].change()).fold(0.0, f64::max);
            let is_best = |seen: &Vec<SeenMode>| {
                !seen[mode].lasts && seen[mode].change() >= SHORTER * most && most > 0.0
            };
            let best = levels.iter().position(is_best).unwrap_or(levels.len() - 1);
            let mut traces = std::mem::take(&mut levels[best][mode].traces);
            traces.iter_mut().for_each(|trace| trace.is_woken = rows.is_woken);
            traced.modes.append(&mut traces);
        }
        traced
    }

    /// Each mode as the rows of a level show it.
    #[allow(clippy::cast_precision_loss)]
    fn seen_modes(
        &self,
        Level { step, kept }: &Level,
        begin: f64,
        drives: &[f64],
        interval: f64,
        largest: f64,
    ) -> Vec<SeenMode> {
        let step = *step as f64 * interval;
        let coefficients: Vec<_> = kept.iter().map(|kept| self.coefficients(kept)).collect();
        // The largest displacement of a row or before.
        let mut level = largest;
        let levels: Vec<f64> = kept
            .iter()
            .map(|kept| {
                level = f64::max(level, max_norm(&kept[..kept.len() / 2]));
                level
            })
            .collect();
        let curves: Vec<Option<Curve>> =
            self.modes.iter().map(|mode| mode.curve(&coefficients, drives, step)).collect();
        let strongest = |i: usize| {
            curves
                .iter()
                .flatten()
                .filter_map(|curve| curve.values.get(i))
                .fold(0.0, |most, w| f64::max(most, w.norm()))
        };
        let strongest: Vec<f64> = (0..coefficients.len()).map(strongest).collect();
        let seen_mode = |curve: &Option<Curve>| {
            curve.as_ref().map_or_else(SeenMode::default, |curve| {
                let is_seen = |i: &usize| {
                    let last = (i + curve.reach).min(levels.len() - 1);
                    curve.values[*i].norm() > ROUNDING * curve.noise * levels[last]
                };
                let rows: Vec<usize> = (0..curve.values.len()).filter(is_seen).collect();
                curve.seen(&rows, &strongest, begin, step)
            })
        };
        curves.iter().map(seen_mode).collect()
    }
}

impl Curve<'_> {
    /// The mode as the rows show it in which it is seen; `strongest` is the amplitude of the strongest mode of each row, m.
    #[allow(clippy::cast_precision_loss)]
    fn seen(&self, rows: &[usize], strongest: &[f64], begin: f64, step: f64) -> SeenMode {
        let matters = rows.iter().any(|&i| self.values[i].norm() >= FAINT * strongest[i]);
        let mut seen = SeenMode { traces: Vec::new(), matters, is_straight: true, lasts: false };
        for run in rows.chunk_by(|a, b| a + 1 == *b) {
            let found = self.straight(run[0]..run[0] + run.len(), begin, step);
            seen.is_straight &= found.iter().all(|(range, _)| range.len() == run.len());
            for (range, fit) in found {
                let is_end = range.end == self.values.len();
                seen.lasts |= is_end;
                let ends = [range.start, range.end - 1 + if is_end { self.reach } else { 0 }];
                let span = ends.map(|i| begin + i as f64 * step);
                let lambda = self.members.eigenvalue;
                let is_brief = lambda.im > 0.0 && (span[1] - span[0]) * lambda.im < TAU;
                if range.len() < FEWEST_POINTS || is_brief {
                    continue;
                }
                seen.traces.push(Trace {
                    eigenvalue: lambda,
                    shape: self.shape.clone(),
                    dof: self.dof,
                    span,
                    fit,
                    frequency: self.frequency(range, begin, step),
                    matters,
                    is_woken: false,
                    lasts: is_end,
                });
            }
        }
        seen
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use amontons::scene::{Method, parse};

    const RATE: f64 = 10.0;
    const FREQUENCY: f64 = 11.0;

    /// A mass that decays as exp(−10 t) at 11 Hz: tenfold within 2.5 periods.
    fn follower(drives: &[f64]) -> Follower {
        let sine = |frequency: &f64| {
            format!(
                "[[signal]]\ninput = \"mass.m.fx\"\nsine = {{ amplitude = 1.0, frequency = {frequency:?} }}\n"
            )
        };
        of(&drives.iter().map(sine).collect::<String>())
    }

    /// A follower of a scene with these signals.
    fn of(signals: &str) -> Follower {
        let omega_squared = (TAU * FREQUENCY).powi(2) + RATE * RATE;
        let text = format!(
            "[[mass]]\nname = \"m\"\nmass = 1.0\nlocked = [\"y\"]\n[[spring]]\nname = \"k\"\n\
             between = [\"m\", \"ground\"]\ndirection = \"x\"\nstiffness = {omega_squared:?}\n[[damper]]\n\
             name = \"d\"\nbetween = [\"m\", \"ground\"]\ndirection = \"x\"\ndamping = {:?}\n\
             [integrator]\nstep = 1e-3\n[experiment]\nstop_time = 1.0\noutput_interval = 1e-3\n{signals}",
            2.0 * RATE
        );
        let mut scene = parse("decaying", &text).unwrap();
        scene.method = Method::EventDriven;
        Follower::of(&scene, Linearised::of(&scene), &[0.0], 1e-3)
    }

    /// A exp(−10 t) cos(ω t) beside a straight line, over `rows` rows of 1 ms.
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
            let mut follower = follower(&[]);
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
        let mut follower = follower(&drives);
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
        let mut follower = follower(&[]);
        follow(&mut follower, 6000, 1.0, [1.0, 0.0]);
        let found = follower.found(OBSERVED);
        let [phase] = &found.phases[..] else { panic!("{found:?}") };
        assert!((2.5..2.9).contains(&phase.span[1]) && phase.rate_error < 1e-3, "{phase:?}");
    }

    #[test]
    fn a_decay_of_the_first_rows_is_found_in_a_run_of_any_length() {
        let mut follower = follower(&[]);
        follow(&mut follower, 300_000, 1.0, [0.0, 0.0]);
        let found = follower.found(OBSERVED);
        let [phase] = &found.phases[..] else { panic!("{found:?}") };
        assert!((phase.rate + RATE).abs() <= phase.rate_error.min(1e-3), "{phase:?}");
        assert!(phase.span[0] == 0.0 && phase.amplitude[1] < 1e-10, "{phase:?}");
    }

    #[test]
    fn no_line_goes_over_an_edge_at_which_the_mode_jumps_and_one_does_where_nothing_happens() {
        // Both edges of a pulse, which this motion knows nothing of.
        let edge =
            "[[signal]]\ninput = \"mass.m.fx\"\npulse = { value = 1.0, start = 0.1, end = 0.2 }\n";
        for jump in [1.0, 1.15] {
            let mut follower = of(edge);
            for row in 0..600_u16 {
                let t = 1e-3 * f64::from(row);
                let lambda = Complex::new(-RATE, TAU * FREQUENCY);
                let x = (lambda * t).exp() * if t > 0.2 { jump } else { 1.0 };
                let row = usize::from(row);
                follower.passes_edge(row);
                follower.row(row, &[], 0, &[x.re], &[(lambda * x).re]);
            }
            let found = follower.found(OBSERVED);
            let count = if jump == 1.0 { 1 } else { 2 };
            let all = found.phases.iter().chain(found.slow.iter().map(|slow| &slow.phase));
            let all: Vec<&Phase> = all.collect();
            assert_eq!(all.len(), count, "{found:?}");
            for phase in all {
                assert!((phase.rate + RATE).abs() <= phase.rate_error.min(1e-4), "{phase:?}");
            }
        }
    }

    #[test]
    fn less_than_tenfold_is_slow_and_another_motion_is_not_explained() {
        let mut slow = follower(&[]);
        follow(&mut slow, 150, 1.0, [0.0, 0.0]);
        let found = slow.found(OBSERVED);
        assert_eq!(found.phases, []);
        assert!(
            (found.slow[0].phase.rate + RATE).abs() <= found.slow[0].phase.rate_error,
            "{found:?}"
        );
        // This is that mass, driven at 3 Hz.
        let mut driven = follower(&[]);
        for row in 0..500_u16 {
            let (sin, cos) = libm::sincos(TAU * 3.0 * 1e-3 * f64::from(row));
            driven.row(usize::from(row), &[], 0, &[sin], &[TAU * 3.0 * cos]);
        }
        let found = driven.found(OBSERVED);
        assert_eq!(found.phases, []);
    }
}
