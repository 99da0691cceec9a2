//! Spectra of histories: values of one quantity at equal intervals of time. Plain numbers in, numbers out.
//!
//! | file | what it finds |
//! | --- | --- |
//! | `transform` | the discrete Fourier transform, fast and at one frequency |
//! | `window` | the weights that keep one line's power out of the others' |
//! | `peak` | where a spectrum is largest |
//! | `lines` | all lines of a spectrum, and what part of the power they have |
//! | `demodulation` | amplitude and phase of one line over time |
//! | `spectrogram` | spectra of a history piece by piece |
//!
//! The loops are our own and sines come from libm: the same doubles on each machine.

mod demodulation;
mod lines;
mod peak;
mod spectrogram;
mod transform;
mod window;

pub use demodulation::{Phasor, demodulate};
pub use lines::{Line, Lines, lines};
pub use peak::cycles;
pub(crate) use peak::largest;
pub use spectrogram::{LEAST_DB, Spectrogram};
pub use window::Window;
