//! Reads a scene file and reports everything that is wrong with it, each problem with its line.

mod located;
mod rewrite;

use rewrite::pack;
pub use rewrite::{set_initial, set_integrator, set_preset};

use crate::superelement::Files;
use amontons::Error;
use amontons::scene::{MatrixFiles, Scene, SceneFile, SceneTables, Source, builtin, builtin_names};
use std::path::Path;

/// Reads and checks a scene file; its name becomes the file's stem. In the source, packed superelements have taken the place of
/// the matrix files that the scene names.
///
/// # Errors
/// Returns all errors of the file, each with its line and column, its key, and a remedy.
pub fn read(path: &Path) -> Result<(Scene, Source), Error> {
    read_with(path, &Files)
}

fn read_with(path: &Path, matrices: &dyn MatrixFiles) -> Result<(Scene, Source), Error> {
    let file = SceneFile::open(path)?;
    let mut file = SceneFile { folder: file.folder.with_matrices(matrices), ..file };
    let scene = scene_of(&mut file)?;
    let mut source = file.into_source();
    pack(&mut source)?;
    Ok((scene, source))
}

/// Makes a scene from the text of a scene file that names no other files.
///
/// # Errors
/// Returns all errors of the text, as [`read`] reports them; the scene's name stands for the file's.
pub fn parse(name: &str, text: &str) -> Result<Scene, Error> {
    scene_of(&mut SceneFile::of(name, text))
}

fn scene_of(file: &mut SceneFile<'_>) -> Result<Scene, Error> {
    let SceneFile { name, place, text, folder } = file;
    located::read(place, text, |tables: SceneTables| tables.scene(name, folder))
}

/// The scene that a command line names, with its files: a built-in scene's name, or a path.
/// A file that is named like a built-in scene is `./name`.
///
/// # Errors
/// Returns an error if there is no such scene, or if [`read`] would refuse it.
pub fn find(argument: &str) -> Result<(Scene, Source), Error> {
    find_with(argument, &Files)
}

/// The scene that a command line names, as [`find`] finds it, with another reader of the matrix files of its superelements.
///
/// # Errors
/// Returns an error if there is no such scene, or if the reader or [`read`] would refuse it.
pub fn find_with(argument: &str, matrices: &dyn MatrixFiles) -> Result<(Scene, Source), Error> {
    let path = Path::new(argument);
    match builtin(argument) {
        Some(builtin) => Ok((builtin.scene(), builtin.text.into())),
        None if path.is_dir() => Err(Error::unusable_file(format!(
            "{argument} is a folder; give a scene file, or a built-in scene; {}",
            builtin_names()
        ))),
        None if path.exists() => read_with(path, matrices),
        None => Err(Error::unusable_file(format!(
            "no file {argument} and no built-in scene of that name; {}",
            builtin_names()
        ))),
    }
}

/// The JSON Schema of scene files, for editors; [`read`] holds files to it.
#[must_use]
pub fn schema() -> String {
    format!("{:#}\n", located::schema::<SceneTables>())
}
