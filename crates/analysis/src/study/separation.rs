//! Separation of neighbouring motions. A motion whose state does not come back is irregular where they part
//! exponentially, and quasi-periodic where they stay near over many windows; where neither can be shown, its kind
//! stays undecided.
//!
//! 1. A neighbour starts about [`APART`] away in the distance of [`recurrence`](super::recurrence): the velocity of the
//!    k-th of n degrees of freedom differs by k/n of it.
//! 2. Both are followed over 4 windows, then 8, 16 and 32. The distance is read where both have the same contact
//!    states; farther away than [`PARTED`] or nearer than [`NEAR`] the neighbour is brought back to [`APART`], and
//!    the growth so far is kept. g_1 and g_2 are the largest growths of the distance near the ends of the first and
//!    of the second half.
//! 3. After each of these times, the first that applies:
//!
//!    | condition | answer |
//!    | --- | --- |
//!    | a growth of 1e6 at any time | exponential |
//!    | no distance at all at any time | together |
//!    | from 8 windows on g_2 ≤ 1e-2 and g_2 / g_1 ≤ 0.1 | together |
//!    | g_2 / g_1 ≥ 30 and g_2 > 100 | exponential |
//!    | g_2 / g_1 ≤ 6 and g_2 > 1e-2, where only a fast parting is looked for | unknown |
//!    | 32 windows, g_2 / g_1 ≤ 0.5 | together |
//!    | 32 windows, g_2 / g_1 ≤ 6 | regular |
//!    | 32 windows | unknown |
//!
//! A distance in proportion to time has g_2 / g_1 = 2. One that grows as exp(σ t) has exp(σ t/2) after the time t, so
//! neighbours that part exponentially at a rate below ln 6 / (16 windows) count as regular.

use super::recurrence::{Scale, State, begin_fast};
use amontons::Error;
use amontons::simulation::Simulation;

/// Initial distance of neighbouring motions, in parts of the motion's size.
const APART: f64 = 1e-9;
/// Neighbours beyond the larger distance, or below the smaller one, are brought back to the first one along the line
/// through both. Farther away they are no neighbours, and much nearer the difference is lost in rounding.
const PARTED: f64 = 1e-3;
const NEAR: f64 = 1e-2 * APART;
/// Windows over which neighbours are followed, and over how many at the most where that does not tell how they part.
const WINDOWS_APART: u64 = 4;
pub(super) const MOST_WINDOWS_APART: u64 = 32;
/// From one half of that time to the next, neighbours that part exponentially move away by at least this factor; those
/// of a regular motion, whose distance grows in proportion to time at most, by less than [`REGULAR`].
const EXPONENTIAL: f64 = 30.0;
const REGULAR: f64 = 6.0;
/// Neighbours whose distance has shrunk to this part come together, if it still shrinks by [`SHRINKING`] from one
/// half to the next. Irregular ones come nearer for a while only, so that is asked after this many windows.
const TOGETHER: f64 = 1e-2;
const SHRINKING: f64 = 0.1;
const LEAST_WINDOWS_TOGETHER: u64 = 8;
/// Slower ones have shrunk to this part from the first half of the longest time to the second.
const SLOWLY: f64 = 0.5;

/// The separation of neighbouring motions over time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum NeighbourSeparation {
    /// Exponentially, at about this rate, 1/s.
    Exponential(f64),
    /// The distance grows in proportion to time, or not at all.
    Regular,
    /// The neighbours come together: the motion follows its drive and has no phase of its own.
    Together,
    /// The separation cannot be determined.
    Unknown,
}

/// Follows a motion and a neighbour of it over [`WINDOWS_APART`] windows of `rows` rows, then twice as long, and so
/// on, until it is known that they part exponentially, or they do not over all of them. Slow parting shows over many
/// windows alone, so fewer never tell that a motion is regular: where only a fast one is looked for (not `is_long`),
/// neighbours that stay near over the first windows leave it unknown.
///
/// # Errors
/// Returns an error if a step fails.
#[allow(clippy::cast_precision_loss)]
pub(super) fn parting(
    simulation: &Simulation,
    interval: f64,
    frequency: f64,
    (rows, is_long): (u64, bool),
    is_over: &dyn Fn() -> bool,
) -> Result<NeighbourSeparation, Error> {
    let mut motion = Simulation::resume(simulation.save())?;
    let scale = begin_fast(&mut motion, interval, frequency, rows)?;
    let Some(mut neighbour) = neighbour(&mut motion, interval, (&scale, rows), is_over)? else {
        return Ok(NeighbourSeparation::Unknown);
    };
    let start = motion.time();
    let mut windows = WINDOWS_APART;
    // By how much the distance had grown when it was last brought back, and its largest growth over a while at the end of the
    // first half, and of the whole, which is the first half of the next; logarithms.
    let mut before = 0.0;
    let (mut early, mut late) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
    let mut row = 0;
    loop {
        let half = windows * rows / 2;
        while row < 2 * half {
            row += 1;
            if row.is_multiple_of(256) && is_over() {
                return Ok(NeighbourSeparation::Unknown);
            }
            let after = row as f64 * interval;
            motion.advance_to(start + after)?;
            neighbour.advance_to(start + after)?;
            let distance = scale.distance(&motion, &State::of(&neighbour));
            // The rest of the difference is lost in rounding.
            if distance == 0.0 {
                return Ok(NeighbourSeparation::Together);
            }
            // Between an event of one and the same event of the other they are as far apart as the event changes the motion.
            if neighbour.contact_states() != motion.contact_states() {
                continue;
            }
            let grown = before + libm::log(distance / APART);
            if grown >= libm::log(PARTED / APART) {
                return Ok(NeighbourSeparation::Exponential(grown / after));
            }
            if !(NEAR..=PARTED).contains(&distance) {
                neighbour.set_apart_from(&motion, APART / distance);
                before = grown;
            }
            if row <= half && row > half - half / 4 {
                early = early.max(grown);
            }
            if row > 2 * half - half / 4 {
                late = late.max(grown);
            }
        }
        // No number, and so no answer, where contact states differed all the while.
        let is_seen = early > f64::NEG_INFINITY && late > f64::NEG_INFINITY;
        let grown = if is_seen { libm::exp(late - early) } else { f64::NAN };
        if windows >= LEAST_WINDOWS_TOGETHER && late <= libm::log(TOGETHER) && grown <= SHRINKING {
            return Ok(NeighbourSeparation::Together);
        }
        if grown >= EXPONENTIAL && late > libm::log(100.0) {
            return Ok(NeighbourSeparation::Exponential((late - early) / (half as f64 * interval)));
        }
        if grown <= REGULAR && !is_long && late > libm::log(TOGETHER) {
            return Ok(NeighbourSeparation::Unknown);
        }
        if 2 * windows > MOST_WINDOWS_APART {
            return Ok(match grown {
                ..=SLOWLY => NeighbourSeparation::Together,
                ..=REGULAR => NeighbourSeparation::Regular,
                _ => NeighbourSeparation::Unknown,
            });
        }
        windows *= 2;
        (early, late) = (late, f64::NEG_INFINITY);
    }
}

/// A neighbour of a motion, each of whose velocities was pushed where the push lives longer than a row, over a window
/// at the most. Both are advanced until then. A contact that sticks undoes a push at once, and so does one that is
/// pressed down. `None` if no push has lived, or the watch ended the search.
fn neighbour(
    motion: &mut Simulation,
    interval: f64,
    (scale, rows): (&Scale, u64),
    is_over: &dyn Fn() -> bool,
) -> Result<Option<Simulation>, Error> {
    let start = motion.time();
    let count = motion.velocity().len();
    let mut neighbour = Simulation::resume(motion.save())?;
    let mut is_apart = vec![false; count];
    // A state that undoes a push continues to do so until a contact changes its state.
    let mut tried_in = None;
    for row in 1..=rows {
        if is_over() || is_apart.iter().all(|apart| *apart) {
            break;
        }
        if tried_in.as_deref() != Some(motion.contact_states()) {
            tried_in = Some(motion.contact_states().to_vec());
            for dof in (0..count).filter(|dof| !is_apart[*dof]) {
                // Equal masses that move alike, pushed by equal parts, would part in no other way.
                let part = (dof + 1) as f64 / count as f64;
                neighbour.push(dof, part * APART * scale.velocity);
            }
        }
        let time = start + row as f64 * interval;
        motion.advance_to(time)?;
        neighbour.advance_to(time)?;
        for (dof, apart) in is_apart.iter_mut().enumerate() {
            let velocity = motion.velocity()[dof] - neighbour.velocity()[dof];
            let displacement = motion.displacement()[dof] - neighbour.displacement()[dof];
            *apart |= scale.part([displacement, velocity]) > NEAR / count as f64;
        }
    }
    Ok((!is_over() && is_apart.contains(&true)).then_some(neighbour))
}
