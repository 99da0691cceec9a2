//! What the program finds out about scenes is what other ways to it say, and how its user is told.

mod accuracy_command;
mod answers;
#[path = "../../../../tests/support/driven_block.rs"]
mod driven_block;
#[path = "../../../../tests/support/program.rs"]
mod program;
mod stability_command_line;
mod study_basin;
mod study_continuation;
mod study_limit_cycle;
mod study_perturbation;
mod sweep;
mod transient;
