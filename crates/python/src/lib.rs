//! The compiled part of the Python package `amontons`.
//!
//! It gives Python what the crates of Amontons have, with as little of its own as can be: arguments are Python's
//! numbers and texts, results are NumPy arrays, and JSON where a result has
//! many parts. The Python sources beside it, in `python/amontons`, are what users see.
//!
//! | file | contents |
//! | --- | --- |
//! | `array` | NumPy arrays of results |
//! | `errors` | exceptions with the texts of the crates' errors |
//! | `interrupt` | long work without the interpreter's lock, which Ctrl-C ends |
//! | `scene` | scenes, which never change |
//! | `stability` | eigenvalues, loci, candidates, verdicts |
//! | `run` | one run as arrays |
//! | `simulation` | a motion that is advanced step by step |
//! | `robustness` | the study of robustness; growth rates for values that a tool draws |
//! | `loudness` | the study of loudness |
//! | `design` | the study of designs |
//! | `study` | studies, as a whole or in pieces for many workers |
//! | `export` | FMUs |

mod array;
mod design;
mod errors;
mod export;
mod interrupt;
mod loudness;
mod robustness;
mod run;
mod scene;
mod simulation;
mod stability;
mod study;

/// Compiled part of the package `amontons`.
#[pyo3::pymodule(gil_used = false)]
mod _core {
    /// Version of Amontons.
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");

    #[pymodule_export]
    use crate::export::export;
    #[pymodule_export]
    use crate::interrupt::on_this_thread;
    #[pymodule_export]
    use crate::robustness::growth_rates;
    #[pymodule_export]
    use crate::run::run;
    #[pymodule_export]
    use crate::scene::{Scene, builtin_names};
    #[pymodule_export]
    use crate::simulation::Simulation;
    #[pymodule_export]
    use crate::stability::{
        candidates, check_undriven, eigenvalues, equilibrium, left_out, locus, modes,
        sensitivities, states, verdict,
    };
    #[pymodule_export]
    use crate::study::Study;
}
