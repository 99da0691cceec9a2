//! The reader reports mistakes in scene files, and importers load the FMUs that are made of them.

mod effects_variables;
mod fuzz;
mod host;
mod importer;
mod page;
#[path = "../../../../tests/support/python/mod.rs"]
mod python;
mod scene_schema;
mod superelements;
mod wrong_scenes;
