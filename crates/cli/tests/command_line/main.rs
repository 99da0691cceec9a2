//! The program as its user meets it, and what it writes: FMUs, their pages, reports.

mod browser;
mod check;
mod command_line;
mod documentation;
mod effects_command;
mod licences;
mod paper;
#[path = "../../../../tests/support/program.rs"]
mod program;
mod report_in_browser;
#[path = "../../../../tests/support/sample_report.rs"]
mod sample_report;
mod shipped_scenes;
mod tolerance;
