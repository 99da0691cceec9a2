//! The model description as XML: reading it and checking it against the schema.

mod schema;
mod shape;
mod tree;
pub(super) mod values;

pub(super) use schema::{CAUSALITIES, VARIABILITIES};
pub(super) use tree::{Element, MOST_BYTES};

use super::report::Report;
use super::rules::Rule;

/// Path of the model description in an FMU.
pub(super) const PATH: &str = "modelDescription.xml";

/// Returns the root element of an FMI 2.0 model description; `None` if the examination cannot continue.
pub(super) fn read(bytes: &[u8], report: &mut Report) -> Option<Element> {
    let root = tree::read(bytes, report)?;
    if root.name != "fmiModelDescription" {
        let message = format!("the root element is <{}>, not <fmiModelDescription>", root.name);
        report.add(Rule::FmiVersion, root.place(), message);
        return None;
    }
    match root.attribute("fmiVersion") {
        Some("2.0") | None => {}
        Some(version) => {
            let message =
                format!("fmiVersion is {version}; every revision of FMI 2.0 requires 2.0");
            report.add(Rule::FmiVersion, root.place(), message);
            if !version.starts_with("2.0") {
                report.note(format!(
                    "the FMU states FMI version {version}; only FMI 2.0 is examined"
                ));
                return None;
            }
        }
    }
    shape::examine(&root, "", report);
    Some(root)
}
