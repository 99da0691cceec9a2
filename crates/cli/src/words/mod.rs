//! Words that several commands tell: sentences and cells on loudness, robustness and sensitivity.
//!
//! | file | contents |
//! | --- | --- |
//! | `loudness` | ways out of uniform sliding, and the motions that they lead to |
//! | `robustness` | probabilities, indices, runs after pushes |
//! | `sensitivity` | effects of parameters, in order and as bars |

pub mod loudness;
pub mod robustness;
pub mod sensitivity;

pub use amontons_pictures::picture::significant;

use amontons::decimal::to_significant;
use amontons::error::Short;

/// A number to some digits, without zeros at its end.
#[must_use]
pub fn digits(value: f64, count: usize) -> String {
    Short(to_significant(value, count)).to_string()
}

/// A number to four digits.
#[must_use]
pub fn four(value: f64) -> String {
    let rounded = to_significant(value, 4);
    if rounded != 0.0 && !(1e-2..1e4).contains(&rounded.abs()) {
        format!("{rounded:.3e}")
    } else {
        Short(rounded).to_string()
    }
}

/// Describes the motion of a mode at a frequency (Hz); zero is a real eigenvalue.
#[must_use]
pub fn at_frequency(frequency_hz: f64) -> String {
    if frequency_hz == 0.0 {
        "without oscillating (real, divergence)".into()
    } else {
        format!("at {frequency_hz:.3} Hz")
    }
}
