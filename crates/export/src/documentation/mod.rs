//! Documentation of an FMU: its pages, its icon, and a reference run beside it.
//!
//! | file | contents |
//! | --- | --- |
//! | `page` | the page at which the documentation begins, put together |
//! | `facts` | facts of the scene, in words |
//! | `stability` | stability at the start, in words: whether the scene may squeal |
//! | `locus` | the friction from which on modes grow |
//! | `run` | a run of the scene, which gives the page's values |
//! | `reference` | that run as a chart and a table |
//! | `variables` | the variables, by kind and one by one |
//! | `importing` | instructions for importers of the FMU |
//! | `coupling` | the values that a coupled FMU gives and takes |
//! | `accuracy` | the cost of accuracy, as a page of its own |
//! | `cross_check` | files of a reference run, as cross-checks of tools want them |
//! | `markup` | the frame of a page, and pictures in it |
//!
//! One scene gives one sequence of bytes.

mod accuracy;
mod coupling;
mod cross_check;
mod facts;
mod importing;
mod locus;
mod markup;
mod page;
mod reference;
mod run;
mod stability;
mod variables;

pub use accuracy::accuracy_page;
pub use cross_check::{CrossCheck, cross_check};
pub use facts::{contents, counted, normal_forces, size};
pub use run::{ReferenceRun, reference_run};

use crate::package::Documentation;
use amontons::Error;
use amontons::scene::{Scene, Source};
use amontons::simulation::Simulation;
use amontons_pictures::picture::Structure;

/// The most contact states whose names are written out.
const NAMED: usize = 8;

/// Input of the documentation.
#[derive(Clone, Copy)]
pub struct Subject<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Files of the scene, word for word, with packed superelements in place of matrix files.
    pub source: &'a Source,
    /// The scene at its start.
    pub start: &'a Simulation,
    /// A run of it.
    pub run: &'a ReferenceRun,
}

/// The documentation of a scene's FMU. `accuracy` is the page of [`accuracy_page`], where there is one.
///
/// # Errors
/// Returns an error if a picture cannot be drawn.
pub fn documentation(
    subject: Subject<'_>,
    accuracy: Option<String>,
) -> Result<Documentation, Error> {
    let structure = drawn(subject.scene);
    let index = page::index(subject, structure.as_ref(), accuracy.is_some())?;
    let icon = structure.map(|structure| structure.icon()).transpose()?;
    Ok(Documentation { index, accuracy, icon })
}

/// The scene's structure, if one picture can show it.
fn drawn(scene: &Scene) -> Option<Structure> {
    let structure = Structure::from(scene);
    (structure.masses.len() <= Structure::MOST_MASSES).then_some(structure)
}

/// `true` if there are contacts, and a law of friction by which they rub.
fn can_squeal(scene: &Scene) -> bool {
    scene.contact_count() > 0 && scene.friction_law.info().sticks
}
