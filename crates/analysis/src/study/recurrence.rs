//! A search for the period after which the state of a settled motion comes back, if it does.
//!
//! A periodic motion is one whose state comes back: displacements and velocities of all masses together, over a whole
//! period, and not only one output of it. Distances between two states are
//!
//! ```text
//! max(|Δx| / X, |Δẋ| / V)
//! ```
//!
//! with Euclidean norms over the degrees of freedom, of which X and V are those of the half-ranges of all displacements
//! and of all velocities over two periods of the strongest line. So equal oscillators that move alike are as far apart
//! as one of them, however many they are.
//!
//! 1. The search begins with a state z_0 in which the motion has 0.8 of its largest speed.
//! 2. Candidates T are the multiples of the drive's period; then, if none of these closes, each time at which the
//!    motion passes the plane (x − x_0) · ẋ_0 = 0 upwards near z_0, once it has been farther away than [`NEAR`].
//! 3. A candidate is a return if the distance of z(t) and z(t + T), root mean square over T, is at most 2e-3.
//!    It is closed up to 1e-6 of the largest half-range, or the way of four steps of the paper's scheme, ω h each, or the rounding of forces.
//!    A window later it must be as near, or it is the passage of an unstable periodic motion.
//! 4. If it is not closed, 2 T to 16 T are tried: the return may be that after a part of the period.
//! 5. It is the shortest period if the nearest return before it keeps its distance over a window: that of a motion
//!    that winds itself round a periodic one changes.

use super::drive;
use super::linear::deflections;
use amontons::Error;
use amontons::numerics::{euclidean_norm, max_norm};
use amontons::scene::Method;
use amontons::simulation::{Simulation, Snapshot};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// A period is looked for up to this many periods of the strongest line.
const MOST_PERIODS: f64 = 64.0;
/// The most windows over which a period is looked for: the strongest line may be that of a slow beat.
const MOST_WINDOWS: f64 = 100.0;
/// Rows pass a state that comes back exactly at this distance or less, in parts of the motion's size: in half a row,
/// at least 20 of which are in a period of the fastest mode, each degree of freedom moves by at most π/20 = 0.16 of its
/// size, and so do all of them together.
const NEAR: f64 = 0.4;
/// A state that comes back to within this part of the motion's size may belong to a periodic motion.
const COMES_BACK: f64 = 2e-3;
/// A state that comes back to within this part belongs to one.
pub(super) const CLOSED: f64 = 1e-6;
/// Events of the paper's scheme come up to a step too early or too late, several of them in a period. A state that
/// comes back within the way of 4 steps belongs to a periodic motion; of one within the way of 10 steps that cannot
/// be told.
const WOBBLE: f64 = 4.0;
const MOST_WOBBLE: f64 = 10.0;
/// Rounding changes a force by this part of it: some ε.
const FORCE_ROUNDING: f64 = 1e-15;
/// Rows between two questions whether anyone still waits.
const ROWS_AT_ONCE: f64 = 256.0;
/// A state that converges comes back nearer from window to window over this many windows. A small part of the motion
/// that does not come back is at random distances, of which six fall evenly once in some 1e5 times.
const CLOSING_WINDOWS: usize = 6;
/// It comes nearer by about the same factor each time: the largest factor is at most this times the smallest.
const SAME_FACTOR: f64 = 1.5;
/// A convergence does not slow down if the difference of the factor from 1 is, at the last window, still this part of
/// what it was at the first.
const SAME_SPEED: f64 = 0.9;
/// A shorter return of a periodic motion is as far away one or more periods later, to this part of its distance.
const SAME_RETURN: f64 = 0.02;
/// A state that comes back as near as this is at the distance of rounding, and does not leave again.
const SAME_STATE: f64 = 1e-9;
/// A return that is not near enough may be that after a part of the period, up to a sixteenth: then the state comes
/// back after the whole period to this part of that distance or less.
const MOST_PARTS: u32 = 16;
const NEARER: f64 = 0.1;

/// The return of a motion to its earlier state.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Closure {
    /// Time after which the state comes back, s.
    pub period: f64,
    /// Distance of the state then from the earlier one, root mean square over a period, in parts of the motion's
    /// size.
    pub distance: f64,
    /// `true` if it is the shortest period. A motion that winds itself round a periodic one comes back best after
    /// several of that one's periods; then its shorter returns come nearer, too, from one of these periods to the
    /// next.
    pub is_shortest: bool,
    /// `true` if the state comes back so near that the motion is periodic as it stands.
    pub is_closed: bool,
}

/// Displacements and velocities of a motion, by the sizes of which distances between states are measured.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    /// Euclidean norm of the half-ranges of all displacements, m, and of all velocities, m/s.
    displacement: f64,
    pub(super) velocity: f64,
    /// The half-range of the displacement or velocity that varies most, in parts of these norms; the smaller one.
    largest: f64,
}

impl Scale {
    /// A displacement, m, or a velocity, m/s, in parts of the motion's size, whichever is more of it.
    pub(super) fn part(&self, [displacement, velocity]: [f64; 2]) -> f64 {
        (displacement / self.displacement).abs().max((velocity / self.velocity).abs())
    }

    /// Distance between two states, in parts of the motion's size.
    pub(super) fn distance(&self, a: &Simulation, b: &State) -> f64 {
        let apart = |a: &[f64], b: &[f64]| euclidean_norm(a.iter().zip(b).map(|(a, b)| a - b));
        let displacement = apart(a.displacement(), &b.displacement) / self.displacement;
        let velocity = apart(a.velocity(), &b.velocity) / self.velocity;
        displacement.max(velocity)
    }
}

/// A copy of a state.
pub(super) struct State {
    displacement: Vec<f64>,
    velocity: Vec<f64>,
}

impl State {
    pub(super) fn of(simulation: &Simulation) -> Self {
        Self {
            displacement: simulation.displacement().to_vec(),
            velocity: simulation.velocity().to_vec(),
        }
    }

    /// Square of the norm of all velocities, m²/s².
    fn squared_speed(&self) -> f64 {
        self.velocity.iter().fold(0.0, |sum, v| sum + v * v)
    }

    /// Position of a simulation along the direction in which this state moves, m²/s: zero where it passes this state.
    fn passed(&self, simulation: &Simulation) -> f64 {
        let pairs = simulation.displacement().iter().zip(&self.displacement);
        pairs.zip(&self.velocity).fold(0.0, |sum, ((a, b), v)| sum + (a - b) * v)
    }
}

/// A motion from a saved state on, at times after that state.
struct ResumedMotion<'a> {
    from: &'a Snapshot,
    start: f64,
}

impl ResumedMotion<'_> {
    fn begin(&self) -> Result<Simulation, Error> {
        Simulation::resume(self.from.clone())
    }

    /// Brings a simulation to a time (s) after the saved state.
    fn bring(&self, simulation: &mut Simulation, after: f64) -> Result<(), Error> {
        simulation.advance_to(self.start + after)
    }
}

/// A state near the one that a course began in, s after it.
struct Return {
    after: f64,
    state: Snapshot,
}

/// Finds the shortest period after which the motion of a simulation comes back: first among the multiples of the
/// period of what drives it, then wherever the state passes near where it was. A window has `rows` rows that are
/// `interval` (s) apart. The search ends after [`MOST_PERIODS`] periods of the drive and of the strongest line, of
/// `frequency` (Hz).
///
/// # Errors
/// Returns an error if a step fails.
pub(super) fn closure(
    simulation: &Simulation,
    interval: f64,
    frequency: f64,
    rows: u64,
    is_over: &dyn Fn() -> bool,
) -> Result<Search, Error> {
    let window = rows as f64 * interval;
    let most = MOST_WINDOWS * window;
    let own = MOST_PERIODS / frequency;
    // Signals without a common period that is so short drive a motion that does not come back for longer still.
    let period = short_period(simulation, window);
    let is_whole = own <= most && period.is_none_or(|period| MOST_PERIODS * period <= most);
    let found = seek(simulation, interval, frequency, (rows, COMES_BACK), is_over, |seeker| {
        let mut found = None;
        if let Some(period) = period {
            let longest = own.max(MOST_PERIODS * period).min(most);
            // A drive much faster than the motion does not carry it far in one of its periods.
            found = seeker.among_multiples(period, [0.9 / frequency, longest])?;
        }
        // A motion that does not feel the drive may come back sooner, and nearer.
        if found.is_none_or(|found| !found.is_closed) {
            let elsewhere = seeker.anywhere(own.min(most))?;
            found = elsewhere.filter(|there| there.is_closed || found.is_none()).or(found);
        }
        Ok(found)
    })?;
    Ok(match found {
        Some(found) => Search::Found(found),
        None if is_whole => Search::NoReturn,
        None => Search::CutShort,
    })
}

/// Finds the period of a motion that neighbouring motions come to: since it has no phase of its own, it comes back
/// after some multiple of the period of its drive. The search covers [`MOST_WINDOWS`] windows, and so has time for
/// few returns: only for those that may be exact. For the arguments and errors see [`closure`].
pub(super) fn long_closure(
    simulation: &Simulation,
    interval: f64,
    frequency: f64,
    rows: u64,
    is_over: &dyn Fn() -> bool,
) -> Result<Option<Closure>, Error> {
    let Some(period) = drive::period(simulation) else { return Ok(None) };
    let longest = MOST_WINDOWS * rows as f64 * interval;
    seek(simulation, interval, frequency, (rows, CLOSED), is_over, |seeker| {
        seeker.among_multiples(period, [0.9 / frequency, longest])
    })
}

/// Begins a search for a period where the motion is fast, among returns that come as near as `enough` over the whole
/// period; `None` without a search if it does not move.
fn seek(
    simulation: &Simulation,
    interval: f64,
    frequency: f64,
    (rows, enough): (u64, f64),
    is_over: &dyn Fn() -> bool,
    search: impl FnOnce(&PeriodFinder<'_>) -> Result<Option<Closure>, Error>,
) -> Result<Option<Closure>, Error> {
    let mut start = Simulation::resume(simulation.save())?;
    let scale = begin_fast(&mut start, interval, frequency, rows)?;
    if scale.displacement <= 0.0 || scale.velocity <= 0.0 {
        return Ok(None);
    }
    let (begin, origin) = (Return { after: 0.0, state: start.save() }, State::of(&start));
    let course = ResumedMotion { from: &begin.state, start: start.time() };
    let window = rows as f64 * interval;
    // Rounding of forces moves the state, too.
    let rounding = FORCE_ROUNDING * euclidean_norm(deflections(simulation)) / scale.displacement;
    let exact = CLOSED * scale.largest;
    let inexact = rounding.max(WOBBLE * distance_per_step(simulation, frequency));
    let closed = exact.max(inexact);
    let enough = enough.max(closed).min(COMES_BACK);
    let begin = &begin;
    search(&PeriodFinder {
        course,
        begin,
        origin,
        scale,
        interval,
        window,
        enough,
        closed,
        inexact,
        is_over,
    })
}

/// The common period, s, of signals that drive a motion for ever, if it is as short as a search for it may last.
pub(super) fn short_period(simulation: &Simulation, window: f64) -> Option<f64> {
    let is_short = |period: &f64| simulation.is_driven_on() && *period <= MOST_WINDOWS * window;
    drive::period(simulation).filter(is_short)
}

/// The result of a search for a period.
pub(super) enum Search {
    Found(Closure),
    /// The motion does not come back within [`MOST_PERIODS`] periods of the drive and of its strongest line.
    NoReturn,
    /// The motion does not come back within [`MOST_WINDOWS`] windows, which are too few to hold all these periods.
    CutShort,
}

/// Looks for a period.
struct PeriodFinder<'a> {
    course: ResumedMotion<'a>,
    /// The state that the search begins in, and a copy of it.
    begin: &'a Return,
    origin: State,
    scale: Scale,
    /// Time between two rows, and length of a window, s.
    interval: f64,
    window: f64,
    /// A return that is so near over the whole period may be one of a periodic motion.
    enough: f64,
    /// A return that is so near over the whole period is one.
    closed: f64,
    /// A periodic motion may come back no nearer, for rounding and late events of the paper's scheme.
    inexact: f64,
    is_over: &'a dyn Fn() -> bool,
}

impl PeriodFinder<'_> {
    /// Looks after each multiple of a period (s) between two times (s).
    fn among_multiples(
        &self,
        period: f64,
        [shortest, longest]: [f64; 2],
    ) -> Result<Option<Closure>, Error> {
        let mut motion = self.course.begin()?;
        let mut nearest: Option<(f64, Return)> = None;
        let multiples = (1_u32..).map(|n| f64::from(n) * period);
        let multiples = multiples.skip_while(|after| *after < shortest);
        for after in multiples.take_while(|after| *after <= longest * (1.0 + 1e-9)) {
            let there = self.bring(&mut motion, after)?;
            let away = self.scale.distance(&motion, &self.origin);
            if let Some(found) = self.closure_at(&there, away, nearest.as_ref())? {
                return Ok(Some(found));
            }
            if (self.is_over)() {
                return Ok(None);
            }
            keep_nearest(&mut nearest, away, there);
        }
        Ok(None)
    }

    /// Looks wherever the state passes near where it was, up to a time (s).
    fn anywhere(&self, longest: f64) -> Result<Option<Closure>, Error> {
        let Self { course, origin, scale, interval, .. } = self;
        let mut motion = course.begin()?;
        let mut before = (0.0, 0.0);
        // The row before, wherever a return may be at hand: an impact between them may bring the state near at once.
        let mut saved = None;
        let mut has_left = false;
        let mut nearest: Option<(f64, Return)> = None;
        let mut row = 0.0;
        while row * interval < longest {
            row += 1.0;
            if row % ROWS_AT_ONCE == 0.0 && (self.is_over)() {
                return Ok(None);
            }
            course.bring(&mut motion, row * interval)?;
            let (distance, passed) = (scale.distance(&motion, origin), origin.passed(&motion));
            let had_left = has_left;
            has_left |= distance > NEAR;
            let (last_distance, last_passed) = std::mem::replace(&mut before, (distance, passed));
            let row_before = saved.take();
            if has_left && passed <= 0.0 {
                saved = Some(motion.save());
            }
            let Some(row_before) = row_before else { continue };
            if !had_left || last_passed > 0.0 || passed <= 0.0 || last_distance.min(distance) > NEAR
            {
                continue;
            }
            let span = [(row - 1.0) * interval, row * interval];
            let after = passage(course, &row_before, origin, (span, [last_passed, passed]))?;
            let mut there = Simulation::resume(row_before)?;
            course.bring(&mut there, after)?;
            let away = scale.distance(&there, origin);
            let there = Return { after, state: there.save() };
            if let Some(found) = self.closure_at(&there, away, nearest.as_ref())? {
                return Ok(Some(found));
            }
            keep_nearest(&mut nearest, away, there);
        }
        Ok(None)
    }

    /// The closure at a return that is so far away, or at one of its multiples, if it is near enough for a period.
    fn closure_at(
        &self,
        there: &Return,
        away: f64,
        nearest: Option<&(f64, Return)>,
    ) -> Result<Option<Closure>, Error> {
        // Over the whole period it may be nearer than at its end.
        if away > 4.0 * self.enough.max(self.closed) {
            return Ok(None);
        }
        let part = there.after;
        let distance = self.distance_over([self.begin, there], part, self.enough)?;
        if distance > self.enough {
            return Ok(None);
        }
        if distance > self.closed {
            let mut motion = Simulation::resume(there.state.clone())?;
            let mut before = there.state.clone();
            let mut best: Option<(Return, f64)> = None;
            for parts in (2..=MOST_PARTS).map(f64::from) {
                let near = self.bring(&mut motion, parts * part)?;
                let most = NEARER * best.as_ref().map_or(distance, |(_, distance)| *distance);
                let before = std::mem::replace(&mut before, near.state);
                // Over the whole period it may be nearer than at its end.
                if self.scale.distance(&motion, &self.origin) > 4.0 * most {
                    continue;
                }
                // What has not come back after a part of the period delays the passage there by a little.
                // A state at rest has no such time.
                let late = match self.origin.squared_speed() {
                    0.0 => 0.0,
                    square => self.origin.passed(&motion) / square,
                };
                let whole = self.bring(&mut Simulation::resume(before)?, near.after - late)?;
                let nearer = self.distance_over([self.begin, &whole], whole.after, most)?;
                if nearer <= most {
                    best = Some((whole, nearer));
                    if nearer <= self.closed {
                        break;
                    }
                }
            }
            if let Some((whole, nearer)) = best {
                return self.closure(&whole, nearer, Some(there)).map(Some);
            }
        }
        self.closure(there, distance, nearest.map(|(_, nearest)| nearest)).map(Some)
    }

    /// The closure at a return after a period, over which it is so far from where it was, with the nearest of the
    /// shorter returns.
    fn closure(
        &self,
        there: &Return,
        distance: f64,
        shorter: Option<&Return>,
    ) -> Result<Closure, Error> {
        let period = there.after;
        let is_shortest = match shorter {
            None => true,
            Some(shorter) => self.stays_away(shorter, there, distance)?,
        };
        let is_closed = distance <= self.closed && self.stays_near(there, distance)?;
        Ok(Closure { period, distance, is_shortest, is_closed })
    }

    /// `true` if the return after a period comes as near a window later. A motion that passes an unstable periodic one
    /// is near it for a while, and leaves it again.
    fn stays_near(&self, there: &Return, distance: f64) -> Result<bool, Error> {
        if distance <= SAME_STATE {
            return Ok(true);
        }
        let most = (2.0 * distance).max(self.inexact);
        let period = there.after;
        let later = period * (self.window / period).ceil();
        let mut motion = Simulation::resume(there.state.clone())?;
        let from = self.bring(&mut motion, later)?;
        let to = self.bring(&mut motion, later + period)?;
        Ok(self.distance_over([&from, &to], period, most)? <= most)
    }

    /// `true` if a shorter return is as far away some periods later. The motion is at `distance` from itself after
    /// `there`, a period.
    fn stays_away(&self, shorter: &Return, there: &Return, distance: f64) -> Result<bool, Error> {
        let period = there.after;
        let before = self.distance_over([self.begin, shorter], period, f64::INFINITY)?;
        let periods = (self.window / period).ceil();
        // Both ends of the return have moved by no more than this distance a period.
        if 2.0 * periods * distance <= SAME_RETURN * before {
            return Ok(true);
        }
        // From a state that is the same if the motion is periodic.
        let later = period * periods;
        let mut motion = Simulation::resume(there.state.clone())?;
        let from = self.bring(&mut motion, later)?;
        let to = self.bring(&mut motion, later + shorter.after)?;
        let now = self.distance_over([&from, &to], period, f64::INFINITY)?;
        Ok((now / before - 1.0).abs() <= SAME_RETURN)
    }

    /// Brings a motion to a time (s) after the state that the search began in, unless no one waits for it any more.
    fn bring(&self, motion: &mut Simulation, after: f64) -> Result<Return, Error> {
        let mut row = ((motion.time() - self.course.start) / self.interval).floor();
        while (row + ROWS_AT_ONCE) * self.interval < after && !(self.is_over)() {
            row += ROWS_AT_ONCE;
            self.course.bring(motion, row * self.interval)?;
        }
        self.course.bring(motion, after)?;
        Ok(Return { after, state: motion.save() })
    }

    /// Distance of a motion from itself between two of its states on, root mean square over a time (s), in parts of
    /// its size. Where that is more than `most`, a value between `most` and the distance.
    fn distance_over(&self, states: [&Return; 2], span: f64, most: f64) -> Result<f64, Error> {
        let [mut now, mut later] = [
            Simulation::resume(states[0].state.clone())?,
            Simulation::resume(states[1].state.clone())?,
        ];
        let rows = (span / self.interval).ceil().max(1.0);
        let (mut sum, mut row) = (0.0, 0.0);
        while row < rows && sum <= rows * most * most {
            row += 1.0;
            if row % ROWS_AT_ONCE == 0.0 && (self.is_over)() {
                break;
            }
            let after = row / rows * span;
            self.course.bring(&mut now, states[0].after + after)?;
            self.course.bring(&mut later, states[1].after + after)?;
            let distance = self.scale.distance(&later, &State::of(&now));
            sum += distance * distance;
        }
        Ok((sum / rows).sqrt())
    }
}

/// Takes a return for the nearest one if it is nearer.
fn keep_nearest(nearest: &mut Option<(f64, Return)>, away: f64, there: Return) {
    if nearest.as_ref().is_none_or(|(least, _)| away < *least) {
        *nearest = Some((away, there));
    }
}

/// `true` if the state comes back nearer from window to window, by about the same factor below 0.95 each time, over
/// [`CLOSING_WINDOWS`] windows with periods within 1 %. A motion that only passes near the place where a periodic motion has ceased
/// to exist comes nearer by ever less.
pub(super) fn is_closing(closures: &[Closure]) -> bool {
    let Some(first) = closures.len().checked_sub(CLOSING_WINDOWS) else { return false };
    let last = &closures[first..];
    let same = last.windows(2).all(|two| have_same_period(&two[0], &two[1]));
    let factors: Vec<f64> = last.windows(2).map(|two| two[1].distance / two[0].distance).collect();
    let [least, most] = [
        factors.iter().copied().fold(f64::INFINITY, f64::min),
        factors.iter().copied().fold(0.0, f64::max),
    ];
    let keeps_speed = 1.0 - factors[factors.len() - 1] >= SAME_SPEED * (1.0 - factors[0]);
    same && most < 0.95 && most <= SAME_FACTOR * least && keeps_speed
}

fn have_same_period(a: &Closure, b: &Closure) -> bool {
    (a.period / b.period - 1.0).abs() < 1e-2
}

/// The distance that a motion with this frequency (Hz) moves in one step of the paper's scheme, which sees events at
/// whole steps only, in parts of the motion's size. 0 of exact motion.
pub(super) fn distance_per_step(simulation: &Simulation, frequency: f64) -> f64 {
    match simulation.scene().method {
        Method::EventDriven => 0.0,
        Method::ForwardIncrement => TAU * frequency * simulation.scene().step,
    }
}

/// The longest step of the paper's scheme, s, that tells a motion that comes back from one that nearly does, where
/// its steps are longer.
pub(super) fn longest_step(simulation: &Simulation, frequency: f64) -> Option<f64> {
    (distance_per_step(simulation, frequency) > COMES_BACK).then(|| COMES_BACK / (TAU * frequency))
}

/// `true` if a motion that comes back to such a distance may be one that the paper's scheme does not let come back
/// nearer.
pub(super) fn may_wobble(simulation: &Simulation, frequency: f64, distance: f64) -> bool {
    distance <= MOST_WOBBLE * distance_per_step(simulation, frequency)
}

/// Moves on over two periods of the strongest line to find how large the motion is, then to where it is nearly as
/// fast as it becomes, from which a return is seen best. That is looked for over a window: the
/// strongest line may have a shorter period than the motion, which may rest for longer than two of these.
pub(super) fn begin_fast(
    simulation: &mut Simulation,
    interval: f64,
    frequency: f64,
    window: u64,
) -> Result<Scale, Error> {
    let start = simulation.time();
    let speed = |simulation: &Simulation| euclidean_norm(simulation.velocity().iter().copied());
    let rows = (2.0 / (frequency * interval)).ceil().min(window as f64);
    let mut ranges = vec![[f64::INFINITY, f64::NEG_INFINITY]; 2 * simulation.displacement().len()];
    let mut fastest = 0.0;
    let mut row = 0.0;
    loop {
        let values = simulation.displacement().iter().chain(simulation.velocity());
        for (range, value) in ranges.iter_mut().zip(values) {
            *range = [range[0].min(*value), range[1].max(*value)];
        }
        fastest = f64::max(fastest, speed(simulation));
        if row >= rows {
            break;
        }
        row += 1.0;
        simulation.advance_to(start + row * interval)?;
    }
    let halves: Vec<f64> = ranges.iter().map(|[low, high]| 0.5 * (high - low)).collect();
    let (displacements, velocities) = halves.split_at(halves.len() / 2);
    let [displacement, velocity] =
        [displacements, velocities].map(|halves| euclidean_norm(halves.iter().copied()));
    let largest = (max_norm(displacements) / displacement).min(max_norm(velocities) / velocity);
    let scale = Scale { displacement, velocity, largest };
    for _ in 0..window {
        if speed(simulation) >= 0.8 * fastest {
            break;
        }
        row += 1.0;
        simulation.advance_to(start + row * interval)?;
    }
    Ok(scale)
}

/// Time at which the motion passes the state that it came from, s after that: between two times on either side, by
/// false position from what was saved at the first of them.
fn passage(
    course: &ResumedMotion<'_>,
    before: &Snapshot,
    origin: &State,
    (mut times, mut passed): ([f64; 2], [f64; 2]),
) -> Result<f64, Error> {
    const MOST_TRIALS: usize = 60;
    let mut time = times[1];
    for _ in 0..MOST_TRIALS {
        let part = (passed[0] / (passed[0] - passed[1])).clamp(0.0, 1.0);
        let next = times[0] + part * (times[1] - times[0]);
        let is_found = (next - time).abs() <= 1e-15 * next.abs();
        time = next;
        if is_found || !(times[0] < time && time < times[1]) {
            break;
        }
        let mut simulation = Simulation::resume(before.clone())?;
        course.bring(&mut simulation, time)?;
        match origin.passed(&simulation) {
            0.0 => break,
            // The far end's value is halved, so that neither end stays for good (Illinois).
            value if value < 0.0 => (times[0], passed) = (time, [value, 0.5 * passed[1]]),
            value => (times[1], passed) = (time, [0.5 * passed[0], value]),
        }
    }
    Ok(time)
}
