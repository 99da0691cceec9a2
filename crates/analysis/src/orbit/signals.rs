//! The signals under which a scene has periodic motions.

use amontons::Error;
use amontons::error::Short;
use amontons::scene::{Scene, Shape, Sine};
use std::f64::consts::TAU;

/// Refuses a scene with a signal that is neither constant from a time (s) on nor a sine without an end.
///
/// # Errors
/// Returns an error that names the signal and says what would be right.
pub fn check_signals(scene: &Scene, time: f64) -> Result<(), Error> {
    for (place, signal) in scene.signals.iter().enumerate() {
        let fault = match &signal.shape {
            shape if shape.constant_until(time, 0.0) == f64::INFINITY => continue,
            Shape::Sine(Sine { start, end: None, .. }) if *start <= time => continue,
            Shape::Sine(sine @ Sine { end: None, .. }) => format!(
                "is a sine that begins at {} s, so from {} s on the drive does not repeat itself; start = 0.0 and \
                 phase = {:?} in its place are the same sine from the beginning on",
                Short(sine.start),
                Short(time),
                sine.phase_at(0.0).rem_euclid(TAU)
            ),
            _ => format!(
                "still changes after {} s, and not as a sine without an end: such a drive does not repeat itself",
                Short(time)
            ),
        };
        return Err(Error::scene(format!("signal[{}] on {} {fault}", place + 1, signal.input)));
    }
    Ok(())
}
