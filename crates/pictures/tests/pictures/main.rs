//! Pictures and reports are complete, and data that cannot be drawn are refused.

mod picture;
mod report;
#[path = "../../../../tests/support/sample_report.rs"]
mod sample_report;
