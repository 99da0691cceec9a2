//! The files from which a scene is made.

use super::time_table::CSV_FILE;
use super::{TimeTable, text};
use std::path::Path;

/// Texts of a scene's files: all that an FMU needs to read the scene again.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Source {
    /// Text of the scene file.
    pub text: String,
    /// Names and texts of the CSV files that the scene file names, which lie in the same folder.
    pub tables: Vec<(String, String)>,
}

impl From<&str> for Source {
    /// Source of a scene that names no other files.
    fn from(text: &str) -> Self {
        Self { text: text.to_owned(), tables: Vec::new() }
    }
}

/// The folder of a scene file, with the CSV files that have been read from it.
pub struct Folder<'a> {
    path: Option<&'a Path>,
    /// Names and texts of the files.
    pub(super) texts: Vec<(String, String)>,
    /// Tables of the files, or the problems found in them, in the same order as the texts.
    tables: Vec<Result<TimeTable, String>>,
}

impl<'a> Folder<'a> {
    /// Makes a folder; `None` for a scene that is not from a file.
    #[must_use]
    pub fn new(path: Option<&'a Path>) -> Self {
        Self { path, texts: Vec::new(), tables: Vec::new() }
    }

    /// Reads the table in a file of the folder.
    ///
    /// # Errors
    /// Returns what is wrong with the file's name or content, and what would be right.
    pub(super) fn table(&mut self, name: &str) -> Result<&TimeTable, String> {
        if !is_plain(name) {
            // The file can then be stored in an FMU under the same name.
            return Err("must be the name of a .csv file beside the scene, without folders".into());
        }
        let Some(folder) = self.path else {
            return Err("only a scene that is read from a file can name a CSV file".into());
        };
        let known = self.texts.iter().position(|(known, _)| known.eq_ignore_ascii_case(name));
        let place = match known {
            Some(place) if self.texts[place].0 == name => place,
            // Some systems would take the two files for one when the FMU is unpacked.
            Some(place) => {
                return Err(format!(
                    "differs from {} only in upper and lower case; write both names alike",
                    self.texts[place].0
                ));
            }
            None => {
                let before: usize = self.texts.iter().map(|(_, text)| text.len()).sum();
                let most = text::MAX_TABLES.saturating_sub(before as u64);
                let bytes = text::read(&folder.join(name), most)
                    .map_err(|error| format!("cannot be read: {error}"))?;
                let bytes = bytes.ok_or_else(|| {
                    format!(
                        "is too large: the CSV files of a scene have at most {} together; leave out rows",
                        text::megabytes(text::MAX_TABLES)
                    )
                })?;
                let text =
                    text::decode(name, CSV_FILE, bytes).map_err(|error| error.to_string())?;
                self.tables.push(TimeTable::parse(&text));
                self.texts.push((name.to_owned(), text));
                self.tables.len() - 1
            }
        };
        self.tables[place].as_ref().map_err(Clone::clone)
    }
}

/// `true` if the name is a plain CSV file name, which means the same on every machine and cannot lead to another folder.
fn is_plain(name: &str) -> bool {
    let is_csv = Path::new(name).extension().is_some_and(|end| end.eq_ignore_ascii_case("csv"));
    is_csv && !name.starts_with('.') && !name.contains(['/', '\\', ':', '\0'])
}

#[cfg(test)]
mod tests {
    use super::*;
    #[test]
    fn only_files_beside_the_scene_are_read() {
        let mut folder = Folder::new(None);
        for name in ["../a.csv", "/a.csv", "b/a.csv", "b\\a.csv", "c:a.csv", ".csv", "a.txt", ""] {
            assert!(folder.table(name).unwrap_err().contains("without folders"), "{name}");
        }
        for name in ["a.csv", "Messung 3 für µ.CSV", "a.b.csv"] {
            assert!(folder.table(name).unwrap_err().contains("read from a file"), "{name}");
        }
    }
}
