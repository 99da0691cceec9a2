//! The pages `tests/wrong_scenes/*.md`: wrong scenes, each above the message that its user gets.

use std::fs;
use std::path::{Path, PathBuf};

/// A wrong scene.
pub struct Case<'a> {
    pub name: &'a str,
    /// File names with their contents: the scene, and tables and matrices beside it.
    pub files: Vec<(String, &'a str)>,
    /// The message, with file names alone in place of paths.
    pub message: &'a str,
}

/// The pages with their texts.
pub fn pages() -> Vec<(PathBuf, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/wrong_scenes");
    let files = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let pages = files.filter(|path| path.extension().is_some_and(|extension| extension == "md"));
    pages.map(|path| (path.clone(), fs::read_to_string(path).unwrap())).collect()
}

/// The scenes of a page's text.
pub fn cases(page: &str) -> Vec<Case<'_>> {
    page.split("\n## ").skip(1).map(case).collect()
}

/// Reads a section: a name, and fenced blocks.
fn case(section: &str) -> Case<'_> {
    let (name, body) = section.split_once('\n').unwrap();
    let mut case = Case { name, files: Vec::new(), message: "" };
    for block in body.split("```").skip(1).step_by(2) {
        match block.split_once('\n').unwrap() {
            ("toml", scene) => case.files.push((format!("{name}.toml"), scene)),
            ("text", message) => case.message = message,
            (kind, table) => {
                let file = ["csv ", "mtx "].iter().find_map(|start| kind.strip_prefix(start));
                let file = file.expect("a block of a kind that is known");
                case.files.push((file.to_owned(), table));
            }
        }
    }
    case
}
