//! The kind of a settled motion, decided in the whole state.
//!
//! A periodic motion is one whose state comes back: displacements and velocities of all masses together, over a whole
//! period, and not only one output of it. A motion that does not come back is irregular where neighbouring motions
//! part exponentially, and quasi-periodic where they do not and its spectrum consists of combinations of two
//! frequencies. Where neither can be shown, the kind stays undecided.

use super::ending::Kind;
use super::push::Push;
use crate::Error;
use crate::scene::Method;
use crate::simulation::{Simulation, Snapshot};
use crate::spectral::{Line, Lines};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// A period is looked for up to this many periods of the strongest line.
const MOST_PERIODS: f64 = 64.0;
/// The most windows over which a period is looked for: the strongest line may be that of a slow beat.
const MOST_WINDOWS: f64 = 2.0;
/// Rows pass a state that comes back exactly at this distance or less, in parts of the motion's size: half of the way
/// between two rows.
const NEAR: f64 = 0.4;
/// A state that comes back to within this part of the motion's size may belong to a periodic motion.
const COMES_BACK: f64 = 2e-3;
/// A state that comes back to within this part belongs to one.
const CLOSED: f64 = 1e-6;
/// How far apart neighbouring motions start, in parts of the motion's size.
const APART: f64 = 1e-9;
/// Beyond this distance they are no neighbours any more.
const PARTED: f64 = 1e-3;
/// Windows over which neighbours are followed.
const WINDOWS_APART: u64 = 4;
/// From one half of that time to the next, neighbours that part exponentially move away by at least this factor; those
/// of a regular motion, whose distance grows in proportion to time at most, by less than [`REGULAR`].
const EXPONENTIAL: f64 = 30.0;
const REGULAR: f64 = 6.0;

/// Lines of more than this part of the strongest one tell the kinds of motion apart. Weaker ones may be high
/// multiples, as kinks have them, which rows this far apart show at another frequency.
const TELLING: f64 = 1e-2;
/// The highest order of a combination of two frequencies.
const HIGHEST_ORDER: i32 = 12;
/// From one window to the next a state that converges comes back nearer each time, by about the same factor: the
/// factors of the last windows differ by less than this.
const SAME_FACTOR: f64 = 1.5;
/// A convergence that goes on does not slow down: over three windows the difference between the factor and one falls to no
/// less than this part.
const SAME_SPEED: f64 = 0.9;
/// Shorter returns of a periodic motion are as far away in each window, but for this part.
const SAME_RETURN: f64 = 0.02;
/// How well a frequency meets a multiple, in parts of the lines' resolution.
const MEETS: f64 = 0.01;

/// How a motion comes back to where it was.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Closure {
    /// s after which the state comes back.
    pub period: f64,
    /// How far the state then is from where it was, root mean square over a period, in parts of the motion's size.
    pub distance: f64,
    /// How far, likewise over this period, it is from where it was at the nearest of its shorter returns, which were not
    /// near enough for a period. `None` if there are none.
    pub shorter: Option<f64>,
}

/// Displacements and velocities of a motion, by the sizes of which distances between states are measured.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    /// The largest half-range of a displacement, m, and of a velocity, m/s.
    displacement: f64,
    velocity: f64,
}

impl Scale {
    /// Distance between two states, in parts of the motion's size.
    fn distance(&self, a: &Simulation, b: &State) -> f64 {
        let apart = |a: &[f64], b: &[f64]| {
            a.iter().zip(b).fold(0.0, |sum, (a, b)| sum + (a - b) * (a - b)).sqrt()
        };
        let displacement = apart(a.displacement(), &b.displacement) / self.displacement;
        let velocity = apart(a.velocity(), &b.velocity) / self.velocity;
        displacement.max(velocity)
    }
}

/// A copy of a state.
struct State {
    displacement: Vec<f64>,
    velocity: Vec<f64>,
}

impl State {
    fn of(simulation: &Simulation) -> Self {
        Self {
            displacement: simulation.displacement().to_vec(),
            velocity: simulation.velocity().to_vec(),
        }
    }

    /// Where a simulation is, along the direction in which this state moves, m²/s: zero where it passes this state.
    fn passed(&self, simulation: &Simulation) -> f64 {
        let pairs = simulation.displacement().iter().zip(&self.displacement);
        pairs.zip(&self.velocity).fold(0.0, |sum, ((a, b), v)| sum + (a - b) * v)
    }
}

/// A motion from a saved state on, at times after that state.
struct Course<'a> {
    from: &'a Snapshot,
    start: f64,
}

impl Course<'_> {
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

/// Finds the shortest period after which the motion of a simulation comes back. The search ends after [`MOST_PERIODS`]
/// periods of the strongest line, of `frequency` (Hz), or after [`MOST_WINDOWS`] windows, if that is sooner: a window has
/// `rows` rows that are `interval` (s) apart. The result is `None` where the motion does not come back in that time, or
/// where it `is_over` that anyone waits for it.
///
/// # Errors
/// A step fails.
pub(super) fn closure(
    simulation: &Simulation,
    interval: f64,
    frequency: f64,
    rows: u64,
    is_over: &dyn Fn() -> bool,
) -> Result<Option<Closure>, Error> {
    let mut start = Simulation::resume(simulation.save())?;
    let scale = begin_fast(&mut start, interval, frequency, rows)?;
    if scale.displacement <= 0.0 || scale.velocity <= 0.0 {
        return Ok(None);
    }
    let (from, origin) = (start.save(), State::of(&start));
    let course = Course { from: &from, start: start.time() };
    let rows = (MOST_PERIODS / (frequency * interval)).min(MOST_WINDOWS * rows as f64);
    let mut before = (0.0, 0.0);
    // The row before, wherever a return may be at hand.
    let mut saved = None;
    let mut has_left = false;
    let mut nearest: Option<(f64, Return)> = None;
    let mut row = 0.0;
    while row < rows {
        row += 1.0;
        if row % 256.0 == 0.0 && is_over() {
            return Ok(None);
        }
        course.bring(&mut start, row * interval)?;
        let (distance, passed) = (scale.distance(&start, &origin), origin.passed(&start));
        let had_left = has_left;
        has_left |= distance > NEAR;
        let (last_distance, last_passed) = std::mem::replace(&mut before, (distance, passed));
        let row_before = saved.take();
        if distance <= 3.0 * NEAR {
            saved = Some(start.save());
        }
        let Some(row_before) = row_before else { continue };
        if !had_left || last_passed > 0.0 || passed <= 0.0 || last_distance.min(distance) > NEAR {
            continue;
        }
        let span = [(row - 1.0) * interval, row * interval];
        let period = passage(&course, &row_before, &origin, (span, [last_passed, passed]))?;
        let mut there = Simulation::resume(row_before)?;
        course.bring(&mut there, period)?;
        let away = scale.distance(&there, &origin);
        let there = Return { after: period, state: there.save() };
        if away <= 4.0 * COMES_BACK {
            let over = |there: &Return| distance_over(&course, there, period, interval, scale);
            let distance = over(&there)?;
            if distance <= COMES_BACK {
                let shorter = nearest.as_ref().map(|(_, there)| over(there)).transpose()?;
                return Ok(Some(Closure { period, distance, shorter }));
            }
        }
        if nearest.as_ref().is_none_or(|(least, _)| away < *least) {
            nearest = Some((away, there));
        }
    }
    Ok(None)
}

/// Does the state come back nearer from window to window, by about the same factor each time? One that only passes near
/// where a periodic motion has ceased to exist comes nearer by ever less.
pub(super) fn is_closing(closures: &[Closure]) -> bool {
    let Some(first) = closures.len().checked_sub(4) else { return false };
    let last = &closures[first..];
    let same = last.windows(2).all(|two| have_same_period(&two[0], &two[1]));
    let factors: Vec<f64> = last.windows(2).map(|two| two[1].distance / two[0].distance).collect();
    let [least, most] = [
        factors.iter().copied().fold(f64::INFINITY, f64::min),
        factors.iter().copied().fold(0.0, f64::max),
    ];
    let goes_on = 1.0 - factors[2] >= SAME_SPEED * (1.0 - factors[0]);
    same && most < 0.95 && most <= SAME_FACTOR * least && goes_on
}

fn have_same_period(a: &Closure, b: &Closure) -> bool {
    (a.period / b.period - 1.0).abs() < 1e-2
}

/// Is the period that was found the shortest? A motion that winds itself round a periodic one comes back best after
/// several of that one's periods; then its shorter returns come nearer, too.
pub(super) fn has_no_shorter_period(closures: &[Closure]) -> bool {
    match closures {
        [.., Closure { shorter: None, .. }] => true,
        [.., a, b] if have_same_period(a, b) => {
            let (Some(before), Some(now)) = (a.shorter, b.shorter) else { return false };
            (now / before - 1.0).abs() <= SAME_RETURN
        }
        _ => false,
    }
}

/// The way of one step of the paper's scheme, which sees events at whole steps only, in parts of the size of a motion with
/// this frequency (Hz). 0 of exact motion.
pub(super) fn way_of_a_step(simulation: &Simulation, frequency: f64) -> f64 {
    match simulation.scene().method {
        Method::EventDriven => 0.0,
        Method::ForwardIncrement => TAU * frequency * simulation.scene().step,
    }
}

/// Are the steps of the paper's scheme too long to tell a motion that comes back from one that nearly does?
pub(super) fn is_too_coarse(simulation: &Simulation, frequency: f64) -> bool {
    way_of_a_step(simulation, frequency) > COMES_BACK
}

/// Is a motion that comes back this well periodic, as it stands?
pub(super) fn is_closed(simulation: &Simulation, frequency: f64, closure: Closure) -> bool {
    closure.distance <= CLOSED.max(way_of_a_step(simulation, frequency))
}

/// Moves on over two periods of the strongest line to find how large the motion is, then to where it is nearly as
/// fast as it becomes, from which a return is seen best.
pub(super) fn begin_fast(
    simulation: &mut Simulation,
    interval: f64,
    frequency: f64,
    window: u64,
) -> Result<Scale, Error> {
    let start = simulation.time();
    let speed = |simulation: &Simulation| {
        simulation.velocity().iter().fold(0.0, |sum, v| sum + v * v).sqrt()
    };
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
    let half = |ranges: &[[f64; 2]]| {
        ranges.iter().fold(0.0, |most, [low, high]| f64::max(most, 0.5 * (high - low)))
    };
    let (displacements, velocities) = ranges.split_at(ranges.len() / 2);
    let scale = Scale { displacement: half(displacements), velocity: half(velocities) };
    for _ in 0..rows as usize {
        if speed(simulation) >= 0.8 * fastest {
            break;
        }
        row += 1.0;
        simulation.advance_to(start + row * interval)?;
    }
    Ok(scale)
}

/// When the motion passes the state that it came from, s after that: between two times on either side, by false
/// position from what was saved at the first of them.
fn passage(
    course: &Course<'_>,
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

/// How far a motion is from itself after a return, root mean square over a period (s), in parts of its size.
fn distance_over(
    course: &Course<'_>,
    there: &Return,
    period: f64,
    interval: f64,
    scale: Scale,
) -> Result<f64, Error> {
    let (mut now, mut later) = (course.begin()?, Simulation::resume(there.state.clone())?);
    let rows = (period / interval).ceil().max(1.0);
    let (mut sum, mut row) = (0.0, 0.0);
    while row < rows {
        row += 1.0;
        let after = row / rows * period;
        course.bring(&mut now, after)?;
        course.bring(&mut later, there.after + after)?;
        let distance = scale.distance(&later, &State::of(&now));
        sum += distance * distance;
    }
    Ok((sum / rows).sqrt())
}

/// How neighbouring motions part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Parting {
    /// Exponentially, at about this rate, 1/s.
    Exponential(f64),
    /// In proportion to time, or not at all.
    Regular,
    /// It cannot be told.
    Unknown,
}

/// Follows a motion and a neighbour of it over [`WINDOWS_APART`] windows of `rows` rows.
///
/// # Errors
/// A step fails.
pub(super) fn parting(
    simulation: &Simulation,
    interval: f64,
    frequency: f64,
    rows: u64,
    is_over: &dyn Fn() -> bool,
) -> Result<Parting, Error> {
    let mut motion = Simulation::resume(simulation.save())?;
    let scale = begin_fast(&mut motion, interval, frequency, rows)?;
    let mut neighbour = Simulation::resume(motion.save())?;
    neighbour.push(Push::of(motion.scene()).dof, APART * scale.velocity);
    let (start, half) = (motion.time(), WINDOWS_APART * rows / 2);
    // The largest distance in the last eighth of the first half, and of the whole.
    let (mut early, mut late) = (0.0_f64, 0.0_f64);
    for row in 1..=2 * half {
        if row.is_multiple_of(256) && is_over() {
            return Ok(Parting::Unknown);
        }
        #[allow(clippy::cast_precision_loss)]
        let after = row as f64 * interval;
        motion.advance_to(start + after)?;
        neighbour.advance_to(start + after)?;
        let distance = scale.distance(&motion, &State::of(&neighbour));
        if distance > PARTED {
            return Ok(Parting::Exponential(libm::log(distance / APART) / after));
        }
        if row <= half && row > half - half / 4 {
            early = early.max(distance);
        }
        if row > 2 * half - half / 4 {
            late = late.max(distance);
        }
    }
    #[allow(clippy::cast_precision_loss)]
    let apart = half as f64 * interval;
    Ok(match late / early {
        grown if grown >= EXPONENTIAL && late > 100.0 * APART => {
            Parting::Exponential(libm::log(grown) / apart)
        }
        grown if grown <= REGULAR || late <= 100.0 * APART => Parting::Regular,
        _ => Parting::Unknown,
    })
}

/// Are all telling lines, the strongest first, combinations of two frequencies?
pub(super) fn has_two_frequencies(found: &Lines) -> bool {
    let Some(strongest) = found.lines.first() else { return false };
    let main = strongest.frequency;
    let meets = MEETS * found.resolution;
    let is_multiple =
        |of: f64| (of - (of / main).round() * main).abs() <= meets * (1.0 + of / main);
    // A second frequency that has only just set in may be fainter than the lines that must combine.
    let mut frequencies = found.lines.iter().map(|line| line.frequency);
    let Some(second) = frequencies.find(|of| !is_multiple(*of)) else { return false };
    let combines = |of: f64| {
        (-HIGHEST_ORDER..=HIGHEST_ORDER).any(|n| {
            let rest = of - f64::from(n) * main;
            let m = (rest / second).round();
            let order = f64::from(n.abs()) + m.abs();
            order <= f64::from(HIGHEST_ORDER) && (rest - m * second).abs() <= meets * (1.0 + order)
        })
    };
    let is_telling = |line: &&Line| line.amplitude >= TELLING * strongest.amplitude;
    found.lines.iter().filter(is_telling).all(|line| combines(line.frequency))
}

/// The kind of a motion that does not come back, from how neighbours part and whether its lines are combinations of
/// two frequencies.
pub(super) const fn kind_without_period(parting: Parting, has_two_frequencies: bool) -> Kind {
    match parting {
        Parting::Exponential(_) => Kind::Irregular,
        Parting::Regular if has_two_frequencies => Kind::QuasiPeriodic,
        Parting::Regular | Parting::Unknown => Kind::Undecided,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frequencies_are_combinations_of_two_or_not() {
        let difference = 219.38 - 167.81;
        let has_two = |lines: &[(f64, f64)]| {
            let line = |&(frequency, amplitude)| Line { frequency, amplitude };
            let lines = lines.iter().map(line).collect();
            has_two_frequencies(&Lines { lines, share: 1.0, resolution: 1.0 })
        };
        assert!(has_two(&[(219.38, 1.0), (167.81, 0.3), (difference, 0.1)]));
        assert!(!has_two(&[(219.38, 1.0), (167.81, 0.3), (difference, 0.1), (91.237, 0.1)]));
        // The second one may be faint, and so may be others that are no combinations.
        assert!(has_two(&[(219.38, 1.0), (438.76, 0.1), (167.81, 3e-3), (91.237, 2e-3)]));
        // One frequency is no combination of two.
        assert!(!has_two(&[(219.38, 1.0), (438.76, 0.1)]) && !has_two(&[]));
    }
}
