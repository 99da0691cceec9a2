//! Stability of the contact states of a scene: modes, and how they change over a parameter.
//!
//! | file | what it finds |
//! | --- | --- |
//! | `parallel` | work shared among threads, its results in order |
//! | `modes` | eigenvalues and shapes of one contact state |
//! | `states` | the eigenvalues of all contact states |
//! | `linearity_limit` | how large a mode may become before a contact leaves sliding |
//! | `locus` | modes over a parameter: where they merge, where they begin to grow |
//! | `linearised` | a scene's model as eigenvalues need it |
//! | `named` | the contact states that a user names |
//! | `growth` | ranges of a parameter in which modes grow |
//! | `state_energy` | how large a motion must be before contacts can be in another state |
//! | `candidates` | ranges of µ that can be bi-stable |
//! | `map` | the verdict over two parameters |
//! | `sensitivity` | derivatives of growth rates, frequencies and critical µ by the parameters |

pub mod candidates;
mod growth;
mod linearised;
mod linearity_limit;
pub mod locus;
pub mod map;
mod modes;
mod named;
pub mod parallel;
mod sensitivity;
mod state_energy;
mod states;

pub use linearised::Linearised;
pub use linearity_limit::{LinearityLimit, linearity_limit};
pub use modes::{Mode, Modes, modes};
pub use named::named_states;
pub use parallel::{is_on_this_thread, on_this_thread};
pub(crate) use sensitivity::group_derivatives;
pub use sensitivity::{
    CriticalFriction, Merging, ModeSensitivity, Parameter, Sensitivities, critical_at,
    critical_friction, sensitivities,
};
pub use state_energy::{StateEnergy, state_energy};
pub use states::{MAX_CONTACTS, StateClasses, spectra_of};
