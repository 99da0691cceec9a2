//! A scene as an FMU: model description, library and scene in one archive.
//!
//! The same scene and version give the same bytes: no time of day, no machine in them. Where
//! `SOURCE_DATE_EPOCH` is set, it is the time that the FMU carries.

mod accuracy_page;
mod archive;
mod date;
mod library;
mod model_description;

pub use accuracy_page::accuracy_page;
pub use library::PLATFORM;
pub use model_description::{identifier, model_description};

use crate::Error;
use crate::fmi2::SCENE_FILE;
use crate::scene::{Scene, Source};
use archive::Archive;
use date::Date;

/// The FMU of a scene; `source` is what it was read from, and `page`, if there is one, is the page (HTML) at
/// which its documentation begins.
///
/// # Errors
/// `SOURCE_DATE_EPOCH` is set to something that is not a time.
pub fn fmu(scene: &Scene, source: &Source, page: Option<&str>) -> Result<Vec<u8>, Error> {
    let date = Date::from_environment()?;
    let library = format!("binaries/{PLATFORM}/{}.{}", identifier(&scene.name), library::EXTENSION);
    let mut archive = Archive::new(date)?;
    archive.add("modelDescription.xml", model_description(scene, source, date).as_bytes())?;
    archive.add(&library, library::BYTES)?;
    archive.add(&format!("resources/{SCENE_FILE}"), source.text.as_bytes())?;
    for (name, table) in &source.tables {
        archive.add(&format!("resources/{name}"), table.as_bytes())?;
    }
    if let Some(page) = page {
        archive.add("documentation/index.html", page.as_bytes())?;
    }
    archive.add("documentation/licenses/LICENSE-MIT.txt", include_bytes!("../../LICENSE-MIT"))?;
    archive
        .add("documentation/licenses/LICENSE-APACHE.txt", include_bytes!("../../LICENSE-APACHE"))?;
    archive.finish()
}
