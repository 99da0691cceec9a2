//! What is made of scene files: what the reader says of them, and the FMUs that importers load.

mod effects_variables;
mod fmi_rs;
mod fuzz;
mod host;
mod importer;
mod page;
#[path = "../../../../tests/support/python/mod.rs"]
mod python;
mod scene_schema;
mod wrong_scenes;
