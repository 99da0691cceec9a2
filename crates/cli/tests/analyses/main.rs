//! The programs' analyses agree with independent computations, and report their limits to the user.

mod accuracy_command;
mod answers;
#[path = "../../../../tests/support/driven_block.rs"]
mod driven_block;
mod modes_on_meshes;
#[path = "../../../../tests/support/parallel.rs"]
mod parallel;
#[path = "../../../../tests/support/program.rs"]
mod program;
#[path = "../../../../tests/support/python/mod.rs"]
mod python;
mod sensitivity;
mod shards;
mod stability_command_line;
mod structures;
mod study_basin;
mod study_continuation;
mod study_design;
mod study_limit_cycle;
mod study_loudness;
mod study_orbit;
mod study_perturbation;
mod study_report;
mod study_report_cases;
mod study_report_changes;
mod study_robustness;
mod sweep;
mod transient;
