//! What pictures and reports hold, and what is refused.

mod picture;
mod report;
#[path = "../../../../tests/support/sample_report.rs"]
mod sample_report;
