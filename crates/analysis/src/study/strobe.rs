//! A driven run at the ends of periods of its drive, as under a stroboscope.
//!
//! A motion that follows its drive comes back after a whole number of the drive's periods. These instants show it where
//! windows do not, as windows that are shorter than the drive's period.

use super::Watch;
use amontons::Error;
use amontons::integrator::Motion;
use amontons::numerics::max_norm;
use amontons::simulation::Simulation;
use std::f64::consts::TAU;
use std::ops::ControlFlow;

/// Most periods of the drive after which a motion may come back.
const MOST_PERIODS: u32 = 16;
/// Returns within this factor of the nearest one are as near, and so are those that differ by rounding, in parts of the
/// displacements.
const ABOUT: f64 = 4.0;
const ROUNDING: f64 = 1e-12;

/// Runs on over [`MOST_PERIODS`] periods of the drive (s), or as many as `longest` (s) holds, but at least one. Returns the
/// time, s, after which the motion at the end has come back most nearly: a whole number of these periods. `None` if the
/// watch ended it.
///
/// # Errors
/// Returns an error if a step fails.
pub(super) fn nearest_return(
    simulation: &mut Simulation,
    drive: f64,
    longest: f64,
    watch: Watch<'_>,
) -> Result<Option<f64>, Error> {
    let start = simulation.time();
    let numbers = (1..=MOST_PERIODS).map(f64::from);
    let numbers: Vec<f64> = numbers.filter(|n| *n <= f64::max(longest / drive, 1.0)).collect();
    let mut motions = vec![simulation.motion().clone()];
    for n in &numbers {
        let go_on =
            || if watch.is_over() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        if simulation.advance_while(start + n * drive, go_on)?.is_break() || watch.is_over() {
            return Ok(None);
        }
        motions.push(simulation.motion().clone());
    }
    let last = simulation.motion();
    let apart = |a: &[f64], b: &[f64]| {
        a.iter().zip(b).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()))
    };
    // m; velocities by the drive's angular frequency.
    let distance = |motion: &Motion| {
        let place = apart(&motion.displacement, &last.displacement);
        place.max(apart(&motion.velocity, &last.velocity) * drive / TAU)
    };
    let distances: Vec<f64> = motions.iter().rev().skip(1).map(distance).collect();
    let nearest = distances.iter().copied().fold(f64::INFINITY, f64::min);
    let enough = ABOUT * nearest.max(ROUNDING * max_norm(&last.displacement));
    let shortest = numbers.iter().zip(&distances).find(|(_, distance)| **distance <= enough);
    Ok(Some(shortest.map_or(1.0, |(n, _)| *n) * drive))
}
