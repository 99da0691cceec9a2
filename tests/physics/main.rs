//! Motions agree with closed forms, obey the law of contact after every step, and keep the balance of energy.

#[path = "../support/brake_pad.rs"]
mod brake_pad;
#[path = "../support/disc.rs"]
mod disc;
mod effects_scenes;
mod energy_ledger;
mod full_mass_matrix;
mod full_matrices;
mod gaps;
mod hard_contact;
mod hard_energy;
mod hard_friction;
mod hard_random;
mod hard_scenes;
mod input_rates;
#[path = "../support/judge/mod.rs"]
mod judge;
mod long_runs;
mod network;
#[path = "../support/quadratic.rs"]
mod quadratic;
mod signals;
mod static_friction;
mod superelements;
mod tables;
#[path = "../support/trajectory.rs"]
mod trajectory;
