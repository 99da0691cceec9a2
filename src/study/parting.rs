//! How neighbouring motions part. A motion whose state does not come back is irregular where they part exponentially, and
//! quasi-periodic where they stay near over many windows; where neither can be shown, its kind stays undecided.

use super::push::Push;
use super::recurrence::{State, begin_fast};
use crate::Error;
use crate::simulation::Simulation;

/// How far apart neighbouring motions start, in parts of the motion's size.
const APART: f64 = 1e-9;
/// Beyond this distance they are no neighbours any more.
const PARTED: f64 = 1e-3;
/// At this distance they have come together.
const TOGETHER: f64 = 1e-2 * APART;
/// Windows over which neighbours are followed, and over how many at the most where that does not tell how they part.
const WINDOWS_APART: u64 = 4;
pub(super) const MOST_WINDOWS_APART: u64 = 32;
/// From one half of that time to the next, neighbours that part exponentially move away by at least this factor; those
/// of a regular motion, whose distance grows in proportion to time at most, by less than [`REGULAR`].
const EXPONENTIAL: f64 = 30.0;
const REGULAR: f64 = 6.0;

/// How neighbouring motions part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Parting {
    /// Exponentially, at about this rate, 1/s.
    Exponential(f64),
    /// In proportion to time, or not at all.
    Regular,
    /// They come together: the motion has no say in where it is, and follows what drives it.
    Together,
    /// It cannot be told.
    Unknown,
}

/// Follows a motion and a neighbour of it over [`WINDOWS_APART`] windows of `rows` rows, then twice as long, and so on, until
/// it is known that they part exponentially, or they do not over all of them. Slow parting shows over many windows alone, so
/// fewer never tell that a motion is regular: where only a fast one is looked for (not `is_long`), neighbours that stay near
/// over the first windows leave it unknown.
///
/// # Errors
/// A step fails.
#[allow(clippy::cast_precision_loss)]
pub(super) fn parting(
    simulation: &Simulation,
    interval: f64,
    frequency: f64,
    (rows, is_long): (u64, bool),
    is_over: &dyn Fn() -> bool,
) -> Result<Parting, Error> {
    let mut motion = Simulation::resume(simulation.save())?;
    let scale = begin_fast(&mut motion, interval, frequency, rows)?;
    let mut neighbour = Simulation::resume(motion.save())?;
    neighbour.push(Push::of(motion.scene()).dof, APART * scale.velocity);
    let start = motion.time();
    let mut windows = WINDOWS_APART;
    // The largest distance over a while at the end of the first half, and of the whole, which is the first half of the next.
    let (mut early, mut late) = (0.0_f64, 0.0_f64);
    let mut row = 0;
    loop {
        let half = windows * rows / 2;
        while row < 2 * half {
            row += 1;
            if row.is_multiple_of(256) && is_over() {
                return Ok(Parting::Unknown);
            }
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
        if late <= TOGETHER {
            return Ok(Parting::Together);
        }
        match late / early {
            grown if grown >= EXPONENTIAL && late > 100.0 * APART => {
                return Ok(Parting::Exponential(libm::log(grown) / (half as f64 * interval)));
            }
            grown if grown <= REGULAR && !is_long => return Ok(Parting::Unknown),
            grown if 2 * windows > MOST_WINDOWS_APART => {
                let is_regular = grown <= REGULAR;
                return Ok(if is_regular { Parting::Regular } else { Parting::Unknown });
            }
            _ => {}
        }
        windows *= 2;
        (early, late) = (late, 0.0);
    }
}
