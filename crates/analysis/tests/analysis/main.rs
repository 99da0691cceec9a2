//! The analyses agree with closed forms, with the paper and with other methods.

mod bistable;
mod driven_friction;
mod effects_of_contact;
mod faint_parts;
mod kinds_of_motion;
mod linearity_limit;
mod network_stability;
mod orbits;
#[path = "../../../../tests/support/quadratic.rs"]
mod quadratic;
mod stability_monitor;
mod superelements;
mod two_contacts_on_one_mass;
mod verdicts;
