//! The windows of a motion: the size and the lines of each, and the trend over several of them ([`Windows::judge`]).
//!
//! With the sizes S_n of the windows since the last edge of a signal, and r = S_n / S_{n−1} − 1:
//!
//! | property | condition |
//! | --- | --- |
//! | the size is steady ([`is_steady`]) | \|r\| ≤ 1e-3 over the last three changes; if all go one way, by more than 1e-7, they must get smaller and, as a geometric series, have at most 2e-3 left to go |
//! | sizes a, b, c tend to zero ([`tends_to_zero`]) | they fall by ever less, and Aitken's limit c − (c − b)² / ((c − b) − (b − a)) is within 0.2 c of zero |
//! | decay to rest | the last three sizes tend to zero, and so do the three that end one window earlier, without a change of state in the last three windows |
//! | decay like a power of time | the sizes after 1/8, 1/4 and 1/2 of 16, 24, 32, … windows tend to zero, and so do those after 1/4, 1/2 and all of them; and the last is at most half of that after 1/8 |
//! | even growth | each of the last three factors is above 1.01, and their logarithms differ by at most a factor of 1.2 |
//! | no trend over m windows | the means of both halves differ by at most the standard deviation; that is at most half the mean of the later half; and the size rises m/4 to 2m/3 times |
//!
//! Lines are steady over four windows if each strong line of the last has its frequency and amplitude in the first
//! and the third of them, too, and no fainter line grows. If no contact changed its state in these windows, the
//! motion is linear, and no line may only grow or only decay.

use super::beat::has_two_frequencies;
use super::linear::GrowthRate;
use crate::spectral::{Line, Lines, Window, lines};
use crate::statistics::{mean, variance};
use crate::sweep::steady::{ROUNDING, STANDING, is_steady, tends_to_zero, weighted_deviation};

/// Lines of at least this part of the strongest one, in amplitudes, must be the same.
const STRONG: f64 = 1e-2;
/// Strong lines are the same if they differ by less than this part of the resolution in frequency, and by less than
/// `SAME_LINE` in amplitude.
const SAME_PLACE: f64 = 0.1;
const SAME_LINE: f64 = 1e-2;
/// Lines of at least this part of the strongest one must not grow. Fainter ones are not looked at.
const FAINT: f64 = 1e-4;
/// A faint line grows if it is larger in each of the last three windows than in the one before, and in all by more
/// than `GROWN` of its amplitude plus `SIDE_LOBES` of that of the strongest line. Side lobes of the Blackman–Harris
/// window are at −92 dB, 2.5e-5.
const GROWN: f64 = 0.01;
const SIDE_LOBES: f64 = 3e-5;
/// A size that falls like a power of time tends to zero after at least `FADING_WINDOWS` windows in which it has
/// fallen to `CREEP` of what it was after an eighth of them.
const FADING_WINDOWS: usize = 16;
const CREEP: f64 = 0.5;
/// A motion whose lines change from window to window has settled if its size has no trend over the first number of
/// windows. In the last window that is looked at, the other numbers count too.
const IRREGULAR_WINDOWS: [usize; 3] = [12, 24, 48];

/// A window that was observed.
struct SeenWindow {
    /// Deviation of the mixture from its mean, weighted root mean square, m, and `true` if a contact changed its state.
    size: f64,
    changed: bool,
    mixture: Vec<f64>,
    /// Found when they are needed.
    lines: Option<Lines>,
}

/// The trend of a motion over the last window and those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Trend {
    /// The motion rests, or decays to rest.
    Rests,
    /// Size and lines of the motion stay.
    Steady,
    /// The size of the motion varies without a trend.
    Varies,
    /// The motion grows, and nothing can stop it.
    Unbounded,
    /// None of these yet.
    Open,
}

/// Properties of a motion and its scene that are needed to judge a window.
#[derive(Clone, Copy)]
pub(super) struct Surroundings<'a> {
    /// The largest displacement, m, of the motion, and of the equilibrium or what loads would bend
    /// ([`deflections`](super::linear::deflections)).
    pub(super) largest: f64,
    pub(super) at_rest: f64,
    /// `true` where signals still drive the motion.
    pub(super) is_driven: bool,
    /// `true` if the drive in each window repeats that in the one before
    /// ([`is_repeated`](super::drive::is_repeated)).
    pub(super) is_repeated: bool,
    /// `true` where loads and surfaces no longer matter ([`is_far`](super::linear::is_far)).
    pub(super) is_far: bool,
    /// `true` where contacts are in states in which the scene can rest.
    pub(super) may_rest: bool,
    /// `true` where no contact can change its state, so that motions are linear at any size.
    pub(super) stays_linear: bool,
    /// Computes the [`growth`](super::linear::growth) in the present contact states.
    pub(super) growth: &'a dyn Fn() -> Option<GrowthRate>,
}

/// The windows of a motion since the last edge of a signal.
pub(super) struct Windows {
    /// Time between two rows, s.
    interval: f64,
    /// Weights of the rows of a window.
    weights: Vec<f64>,
    seen: Vec<SeenWindow>,
}

impl Windows {
    /// No windows yet; each will have `rows` rows, `interval` (s) apart.
    pub(super) fn new(rows: usize, interval: f64) -> Self {
        Self { interval, weights: Window::BlackmanHarris.weights(rows), seen: Vec::new() }
    }

    /// Number of windows.
    pub(super) fn count(&self) -> usize {
        self.seen.len()
    }

    /// Begins anew.
    pub(super) fn clear(&mut self) {
        self.seen.clear();
    }

    /// The size of the motion in the last window, and in the one before.
    pub(super) fn last_sizes(&self) -> [Option<f64>; 2] {
        let mut sizes = self.seen.iter().rev().map(|seen| seen.size);
        [sizes.next(), sizes.next()]
    }

    /// The lines of the last window, the strongest first; `None` before there is one.
    pub(super) fn last_lines(&mut self) -> Option<&Lines> {
        let interval = self.interval;
        self.seen.last_mut().map(|last| last.lines(interval))
    }

    /// The lines of the last window, if they have been found already.
    pub(super) fn known_lines(&self) -> Option<&Lines> {
        self.seen.last().and_then(|last| last.lines.as_ref())
    }

    /// Number of windows that a motion has stood still for without a change of state, the one that has ended
    /// included; 1 for any other motion. The drive must have repeated itself over that time.
    #[allow(clippy::cast_precision_loss)]
    pub(super) fn still(&self, changed: bool) -> f64 {
        let is_still = |seen: &&SeenWindow| seen.size == 0.0 && !seen.changed;
        let before = self.seen.iter().rev().take_while(is_still).count();
        1.0 + if changed { 0.0 } else { before as f64 }
    }

    /// `true` if all strong lines of the last window are combinations of two frequencies.
    pub(super) fn has_two_frequencies(&self) -> bool {
        self.known_lines().is_some_and(has_two_frequencies)
    }

    /// Looks at the window that has ended with the ones before it. It has these values of the [`mixture`], and in it
    /// contacts changed their states or did not; `is_last`: no other one follows.
    ///
    /// [`mixture`]: crate::sweep::steady::mixture
    pub(super) fn judge(
        &mut self,
        mixture: Vec<f64>,
        changed: bool,
        is_last: bool,
        around: Surroundings<'_>,
    ) -> Trend {
        let size = weighted_deviation(&mixture, &self.weights);
        self.seen.push(SeenWindow { size, changed, mixture, lines: None });
        // Older windows are needed for their sizes only.
        if let Some(old) = self.seen.len().checked_sub(5) {
            (self.seen[old].mixture, self.seen[old].lines) = (Vec::new(), None);
        }
        // The equilibrium counts, too: the rest of a motion at rest is rounding of forces.
        let nothing = ROUNDING * around.largest.max(around.at_rest);
        let is_rounding = size <= nothing;
        let is_free = !around.is_driven;
        // A motion that stands still while a sine pulls at it is held by friction, which is as it was after each
        // period.
        if size == 0.0 && !changed && around.is_repeated {
            return Trend::Rests;
        }
        // Friction that is at its limit for an instant of each period may let a contact go and hold it again, by rounding.
        let flickers = around.is_driven && around.is_repeated && changed && is_rounding;
        let has_been = || self.seen.iter().rev().take(4).all(|seen| seen.size <= nothing);
        if flickers && self.seen.len() >= 4 && has_been() {
            let is_growing = (around.growth)().is_some_and(GrowthRate::is_growing);
            return if is_growing { Trend::Open } else { Trend::Rests };
        }
        // A motion that a sine keeps pushing gets no smaller, so it rests only if it already does.
        let is_resting = is_rounding || is_free && rests(&self.seen);
        if around.is_repeated && around.may_rest && (is_resting || is_free && is_calm(&self.seen)) {
            let growth = (around.growth)();
            let is_growing = growth.is_some_and(GrowthRate::is_growing);
            let is_decaying = growth.is_some_and(GrowthRate::is_decaying);
            // A calm motion has only its eigenvalues to say that it decays.
            if is_decaying || !is_growing && is_resting {
                return Trend::Rests;
            }
        }
        let sizes = self.sizes();
        if around.is_driven && around.is_repeated && around.may_rest && fades(&sizes) {
            return Trend::Rests;
        }
        if is_free && (is_unbounded(around) || around.is_far && grows_evenly(&sizes)) {
            return Trend::Unbounded;
        }
        if is_steady(&sizes) && self.has_steady_lines() {
            return Trend::Steady;
        }
        // A beat that is longer than some windows has a trend over these, and none over more.
        let lengths = if is_last { &IRREGULAR_WINDOWS[..] } else { &IRREGULAR_WINDOWS[..1] };
        let varies = |windows: &usize| has_no_trend(&sizes, *windows);
        if changed && lengths.iter().any(varies) { Trend::Varies } else { Trend::Open }
    }

    /// `true` if the lines of the last windows are the same and none grows.
    fn has_steady_lines(&mut self) -> bool {
        let Some(first) = self.seen.len().checked_sub(4) else { return false };
        for seen in &mut self.seen[first..] {
            seen.lines(self.interval);
        }
        // Then the motion is linear, and a line that changes at all ends elsewhere.
        let unchanged = self.seen[first..].iter().all(|seen| !seen.changed);
        let windows: Vec<&Lines> =
            self.seen[first..].iter().filter_map(|seen| seen.lines.as_ref()).collect();
        let [oldest, .., last] = windows[..] else { return false };
        let Some(strongest) = last.lines.first() else { return false };
        last.lines.iter().all(|line| {
            let strong = line.amplitude >= STRONG * strongest.amplitude;
            let stays = |other: &&Lines| {
                near(line, other, SAME_PLACE)
                    .is_some_and(|other| (other / line.amplitude - 1.0).abs() <= SAME_LINE)
            };
            let before: Vec<f64> =
                windows.iter().map(|window| near(line, window, 1.0).unwrap_or(0.0)).collect();
            let feigned = SIDE_LOBES * strongest.amplitude;
            // Not through all windows: at first what a push has brought besides may decay faster.
            let last = &before[1..];
            let grows = last.windows(2).all(|two| two[1] > two[0])
                && last[2] > (1.0 + GROWN) * last[0] + feigned;
            if unchanged && goes_one_way(&before) {
                return false;
            }
            if strong { [oldest, windows[2]].iter().all(stays) } else { !grows }
        })
    }

    /// Variation of the size of a motion over its last windows, logarithm of the largest by the smallest.
    pub(super) fn scatter(&self) -> f64 {
        let last = || self.seen.iter().rev().take(4).map(|seen| seen.size);
        let (least, most) = (last().fold(f64::INFINITY, f64::min), last().fold(0.0, f64::max));
        if least > 0.0 && most > 0.0 { libm::log(most / least) } else { 0.0 }
    }

    /// `true` if the size of a motion varies less and less. Then the size may become constant, and the motion
    /// periodic.
    pub(super) fn varies_less(&self) -> bool {
        varies_less(&self.sizes())
    }

    fn sizes(&self) -> Vec<f64> {
        self.seen.iter().map(|seen| seen.size).collect()
    }
}

impl SeenWindow {
    /// Lines of the window, found when they are first needed.
    fn lines(&mut self, interval: f64) -> &Lines {
        self.lines.get_or_insert_with(|| lines(&self.mixture, interval, FAINT))
    }
}

/// `true` if no contact has changed its state over two windows, in the last of which the motion got smaller.
fn is_calm(seen: &[SeenWindow]) -> bool {
    matches!(seen, [.., before, last] if !before.changed && !last.changed && last.size < before.size)
}

/// `true` if the size of a motion varies less and less: its standard deviation falls through the last three quarters
/// of the windows, to less than 0.8 of that in the first of them, or there are fewer than three windows. Then the
/// size may become constant, and the motion periodic.
fn varies_less(sizes: &[f64]) -> bool {
    const LESS: f64 = 0.8;
    let parts: Vec<f64> = sizes
        .rchunks_exact((sizes.len() / 4).max(1))
        .take(3)
        .map(variance)
        .map(f64::sqrt)
        .collect();
    let [last, middle, first] = parts[..] else { return true };
    last < middle && middle < first && last < LESS * first
}

/// `true` if a motion has grown by about the same factor over each of the last three windows.
fn grows_evenly(sizes: &[f64]) -> bool {
    const FACTOR: f64 = 1.01;
    const SAME: f64 = 1.2;
    let Some(first) = sizes.len().checked_sub(4) else { return false };
    let factors: Vec<f64> = sizes[first..].windows(2).map(|two| two[1] / two[0]).collect();
    let least = factors.iter().copied().fold(f64::INFINITY, f64::min);
    let most = factors.iter().copied().fold(0.0, f64::max);
    least > FACTOR && libm::log(most) <= SAME * libm::log(least)
}

/// `true` if a motion grows that nothing can stop, since its contacts cannot change their states.
fn is_unbounded(around: Surroundings<'_>) -> bool {
    around.stays_linear && (around.growth)().is_some_and(GrowthRate::is_growing)
}

/// `true` if a motion decays to rest: no contact changes its state any more, and the limit of its size, by Aitken's
/// extrapolation, is near zero, twice one after the other.
fn rests(seen: &[SeenWindow]) -> bool {
    let Some(first) = seen.len().checked_sub(4) else { return false };
    let last = &seen[first..];
    let tends = |three: &[SeenWindow]| tends_to_zero([three[0].size, three[1].size, three[2].size]);
    last[1..].iter().all(|seen| !seen.changed) && last.windows(3).all(tends)
}

/// `true` if sizes tend to zero like a power of time, as over times that double. This includes the creep of a mass by
/// ever shorter slips.
fn fades(sizes: &[f64]) -> bool {
    let windows = sizes.len();
    let after = |part: usize| sizes[windows / part - 1];
    windows >= FADING_WINDOWS
        && windows.is_multiple_of(8)
        && tends_to_zero([after(8), after(4), after(2)])
        && tends_to_zero([after(4), after(2), after(1)])
        && after(1) <= CREEP * after(8)
}

/// `true` if amplitudes only grow, or only decay, by more than [`STANDING`] each time.
fn goes_one_way(amplitudes: &[f64]) -> bool {
    let ratios = amplitudes.windows(2).map(|two| two[1] / two[0] - 1.0);
    ratios.clone().all(|ratio| ratio > STANDING) || ratios.clone().all(|ratio| ratio < -STANDING)
}

/// `true` if the size, though it varies, has no trend over the last `windows`.
fn has_no_trend(sizes: &[f64], windows: usize) -> bool {
    let Some(first) = sizes.len().checked_sub(windows) else { return false };
    let (a, b) = sizes[first..].split_at(windows / 2);
    let spread = variance(&sizes[first..]).sqrt();
    let rises = sizes[first..].windows(2).filter(|two| two[1] > two[0]).count();
    // A drift goes one way, what varies goes both.
    (mean(a) - mean(b)).abs() <= spread
        && (windows / 4..=2 * windows / 3).contains(&rises)
        && spread <= 0.5 * mean(b)
}

/// The amplitude of the line of a window that is within this part of the resolution of another line.
fn near(line: &Line, window: &Lines, part: f64) -> Option<f64> {
    let at = |other: &&Line| (other.frequency - line.frequency).abs() <= part * window.resolution;
    window.lines.iter().find(at).map(|other| other.amplitude)
}

#[cfg(test)]
#[allow(clippy::cast_precision_loss)]
mod tests {
    use super::*;
    use amontons::numerics::max_norm;
    use std::f64::consts::TAU;

    const FREE: Surroundings<'static> = Surroundings {
        largest: 1.0,
        at_rest: 0.0,
        is_driven: false,
        is_repeated: true,
        is_far: false,
        may_rest: true,
        stays_linear: false,
        growth: &|| None,
    };

    /// 2 s with a row each 0.2 ms.
    const ROWS: usize = 10_000;
    const INTERVAL: f64 = 2e-4;

    /// A made-up motion over one of these windows.
    fn over(window: usize, motion: impl Fn(f64) -> f64) -> Vec<f64> {
        (0..ROWS).map(|row| motion((window * ROWS + row) as f64 * INTERVAL)).collect()
    }

    /// The number of windows after which a made-up motion has settled, and how.
    fn known(changes: bool, motion: impl Fn(f64) -> f64) -> Option<(usize, Trend)> {
        const MOST: usize = 20;
        let mut windows = Windows::new(ROWS, INTERVAL);
        (0..MOST).find_map(|window| {
            let mixture = over(window, &motion);
            let largest = max_norm(&mixture);
            let around = Surroundings { largest, ..FREE };
            match windows.judge(mixture, changes, false, around) {
                Trend::Open => None,
                course => Some((windows.count(), course)),
            }
        })
    }

    fn sine(frequency: f64, t: f64) -> f64 {
        (TAU * frequency * t).sin()
    }

    #[test]
    fn what_has_a_trend_over_some_windows_may_have_none_over_more() {
        // A beat of 24 windows beside some scatter, and a decay of the same extent.
        let scattered = |size: &dyn Fn(f64) -> f64| -> Vec<f64> {
            let scatter = |i: i32| 0.05 * f64::from(i * i % 11) / 11.0;
            (0..60).map(|i| size(f64::from(i)) + scatter(i)).collect()
        };
        let beats = scattered(&|i| 1.0 + 0.2 * (TAU * i / 24.0).cos());
        let decays = scattered(&|i| 0.8 + 0.4 * (-i / 20.0).exp());
        let [few, _, most] = IRREGULAR_WINDOWS;
        assert_eq!([few, most].map(|windows| has_no_trend(&beats, windows)), [false, true]);
        assert_eq!([few, most].map(|windows| has_no_trend(&decays, windows)), [false, false]);
        // A beat that dies has no trend, and varies less and less.
        let beat = |i: f64| (TAU * i / 14.0).cos();
        let dies = |i: f64| 1.0 + 0.5 * (-i / 100.0).exp() * beat(i);
        assert!(varies_less(&(0..60).map(f64::from).map(dies).collect::<Vec<_>>()));
        assert!(!varies_less(&beats));
    }

    #[test]
    fn what_decays_rests() {
        assert_eq!(known(false, |t| (-0.05 * t).exp() * sine(40.0, t)).unwrap().1, Trend::Rests);
        assert_eq!(known(false, |_| 7.0), Some((1, Trend::Rests)));
    }

    #[test]
    fn what_grows_evenly_far_beyond_all_loads_grows_without_bound() {
        let last = |is_far: bool, rate: &dyn Fn(f64) -> f64| {
            let mut windows = Windows::new(ROWS, INTERVAL);
            let mut course = Trend::Open;
            for window in 0..6 {
                let growing = over(window, |t| rate(t).exp() * sine(40.0, t));
                course = windows.judge(growing, true, false, Surroundings { is_far, ..FREE });
            }
            course
        };
        assert_eq!(last(true, &|t| 0.5 * t), Trend::Unbounded);
        assert_eq!(last(false, &|t| 0.5 * t), Trend::Open);
        assert_eq!(last(true, &|t| 2.0 * (0.3 * t).sin()), Trend::Open);
    }

    #[test]
    fn what_signals_drive_on_does_not_rest_however_it_decays() {
        let mut windows = Windows::new(ROWS, INTERVAL);
        for window in 0..8 {
            let decaying = over(window, |t| (-0.5 * t).exp() * sine(40.0, t));
            let driven = Surroundings { is_driven: true, is_repeated: false, ..FREE };
            assert_eq!(windows.judge(decaying, false, false, driven), Trend::Open);
        }
    }

    #[test]
    fn sums_of_sines_are_steady() {
        let one = |t| sine(219.38, t) + 0.1 * sine(438.76, t);
        let two = |t| sine(219.38, t) + 0.3 * sine(167.81, t) + 0.02 * sine(219.38 - 167.81, t);
        let three = |t| two(t) + 0.1 * sine(91.237, t);
        let found = [known(true, one), known(true, two), known(true, three)];
        assert_eq!(found, [Some((4, Trend::Steady)); 3]);
    }

    #[test]
    fn noise_varies_without_a_trend() {
        let noise = |t: f64| {
            let mut bits = t.to_bits().wrapping_mul(0x9E37_79B9_7F4A_7C15);
            bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            (bits >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        assert_eq!(known(true, noise).unwrap().1, Trend::Varies);
    }

    #[test]
    fn what_still_grows_or_decays_is_not_settled_however_slowly() {
        // By 0.05 % a window, far less than what a cycle may vary, for 20 windows.
        for rate in [2.5e-4, -2.5e-4] {
            assert_eq!(known(true, |t| (rate * t).exp() * sine(200.0, t)), None, "{rate}");
        }
        assert_eq!(known(false, |t| (2.5e-4 * t).exp() * sine(200.0, t)), None);
        // Nor where a line beside the main one does, of a motion without events, by 0.2 % a window.
        let beside = |t: f64| sine(200.0, t) + 0.05 * (-1e-3 * t).exp() * sine(91.3, t);
        assert_eq!(known(false, beside), None);
        // A size that converges is steady.
        let ends = |t: f64| (1.0 - (-t).exp()) * sine(200.0, t);
        let (windows, course) = known(true, ends).unwrap();
        assert!((5..8).contains(&windows) && course == Trend::Steady, "{windows}");
    }

    #[test]
    fn a_calm_motion_rests_or_grows_without_bound_as_its_eigenvalues_say() {
        let last = |rate: f64, growth: f64, stays_linear: bool| {
            let mut windows = Windows::new(ROWS, INTERVAL);
            let growth = || Some(GrowthRate { rate: growth, relative: growth });
            let around = Surroundings { stays_linear, growth: &growth, ..FREE };
            let courses = (0..4).map(|window| {
                let motion = over(window, |t| (rate * t).exp() * sine(200.0, t));
                windows.judge(motion, false, false, around)
            });
            courses.last()
        };
        // By 0.02 % a window: far too slow to be seen to end.
        assert_eq!(last(-1e-4, -1e-7, false), Some(Trend::Rests));
        assert_eq!(last(-1e-4, 1e-7, false), Some(Trend::Open));
        assert_eq!(last(1e-4, 1e-7, true), Some(Trend::Unbounded));
        assert_eq!(last(1e-4, 1e-7, false), Some(Trend::Open));
    }

    #[test]
    fn a_plateau_on_which_a_faint_line_grows_is_not_settled() {
        // From 2e-4 to 1e-2 of the strong line over the twenty windows, in which the size is the same to 1e-4.
        let faint = |t: f64| 2e-4 * (0.1 * t).exp() * sine(167.0, t);
        assert_eq!(known(true, |t| sine(219.2, t) + faint(t)), None);
        assert!(known(true, |t| sine(219.2, t) + 2e-4 * sine(167.0, t)).is_some());
    }

    #[test]
    fn a_window_that_holds_no_whole_number_of_periods_has_the_same_size_wherever_it_begins() {
        let weights = Window::BlackmanHarris.weights(2000);
        let size = |phase: f64| {
            let wave = |i: i32| {
                let part = (21.4 * f64::from(i) / 2000.0 + phase).fract();
                if part < 0.8 { part } else { 4.0 * (1.0 - part) }
            };
            weighted_deviation(&(0..2000).map(wave).collect::<Vec<_>>(), &weights)
        };
        for i in 1..20 {
            // The expected size is that of a triangle from 0 to 0.8: 0.8 / √12.
            let off = size(0.05 * f64::from(i)) / (0.8 / 12.0_f64.sqrt()) - 1.0;
            assert!(off.abs() < 1e-4, "{i}: {off}");
        }
    }
}
