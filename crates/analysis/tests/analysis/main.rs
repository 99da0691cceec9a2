//! What the analyses find is what closed forms, the paper and other methods say.

mod bistable;
mod departure;
mod effects_of_contact;
mod kinds_of_motion;
mod network_stability;
#[path = "../../../../tests/support/quadratic.rs"]
mod quadratic;
mod stability_monitor;
mod two_contacts_on_one_mass;
mod verdicts;
