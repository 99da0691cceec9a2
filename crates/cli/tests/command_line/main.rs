//! The program as its user meets it, and what it writes: FMUs, their pages, reports.

mod book;
mod browser;
mod build;
#[path = "../../../../tests/support/callgrind.rs"]
mod callgrind;
mod check;
mod command_line;
mod documentation;
mod effects_command;
mod instructions;
mod licences;
#[path = "../../../../tests/support/oscillator.rs"]
mod oscillator;
mod paper;
#[path = "../../../../tests/support/parallel.rs"]
mod parallel;
#[path = "../../../../tests/support/program.rs"]
mod program;
#[path = "../../../../tests/support/python/mod.rs"]
mod python;
mod report_in_browser;
#[path = "../../../../tests/support/sample_report.rs"]
mod sample_report;
mod shipped_scenes;
mod tolerance;
