//! A scene as an FMU: model description, library and scene in one archive.
//!
//! One scene and version give one sequence of bytes: no time of day, no machine in them. Where
//! `SOURCE_DATE_EPOCH` is set, it is the time that the FMU carries.

mod archive;
mod date;
mod library;
mod model_description;

pub use library::Library;
pub use model_description::{identifier, model_description};

use amontons::Error;
use amontons::fmi2::SCENE_FILE;
use amontons::scene::{Scene, Source};
use archive::Archive;
use date::Date;

/// Documentation of an FMU for people.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Documentation {
    /// The page (HTML) at which the documentation begins.
    pub index: String,
    /// The page on what accuracy costs, where that was asked for.
    pub accuracy: Option<String>,
    /// The icon (PNG) that importers show, if there is one.
    pub icon: Option<Vec<u8>>,
}

/// The FMU of a scene; `source` is the text that it was read from. An FMU that is for people has a documentation. It
/// runs on the platforms of `libraries`.
///
/// # Errors
/// `SOURCE_DATE_EPOCH` is set to something that is not a time.
pub fn fmu(
    scene: &Scene,
    source: &Source,
    documentation: Option<&Documentation>,
    libraries: &[Library],
) -> Result<Vec<u8>, Error> {
    let date = Date::from_environment()?;
    let mut archive = Archive::new(date.as_ref());
    let date = date.as_ref().map(|date| date.text.as_str());
    archive.add("modelDescription.xml", model_description(scene, source, date).as_bytes())?;
    for Library { platform, extension, bytes } in libraries {
        let name = identifier(&scene.name);
        archive.add(&format!("binaries/{platform}/{name}.{extension}"), bytes)?;
    }
    archive.add(&format!("resources/{SCENE_FILE}"), source.text.as_bytes())?;
    for (name, table) in &source.tables {
        archive.add(&format!("resources/{name}"), table.as_bytes())?;
    }
    for (name, matrices) in &source.binaries {
        archive.add(&format!("resources/{name}"), matrices)?;
    }
    if let Some(Documentation { index, accuracy, icon }) = documentation {
        if let Some(icon) = icon {
            archive.add("model.png", icon)?;
        }
        archive.add("documentation/index.html", index.as_bytes())?;
        if let Some(accuracy) = accuracy {
            archive.add("documentation/accuracy.html", accuracy.as_bytes())?;
        }
    }
    archive
        .add("documentation/licenses/LICENSE-MIT.txt", include_bytes!("../../../../LICENSE-MIT"))?;
    archive.add(
        "documentation/licenses/LICENSE-APACHE.txt",
        include_bytes!("../../../../LICENSE-APACHE"),
    )?;
    archive.add(
        "documentation/licenses/THIRD-PARTY.txt",
        include_bytes!("../../../../licenses/THIRD-PARTY.txt"),
    )?;
    archive.finish()
}
