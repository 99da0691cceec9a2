//! The files from which a scene is made.

use super::superelement::{MatrixFiles, PACKED, SuperelementFiles, SuperelementMatrices};
use super::time_table::CSV_FILE;
use super::{Problem, TimeTable, text};
use std::path::Path;

/// Texts of a scene's files: all that an FMU needs to read the scene again.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Source {
    /// Text of the scene file.
    pub text: String,
    /// Names and texts of the CSV files that the scene file names, which lie in the same folder.
    pub tables: Vec<(String, String)>,
    /// Names and packed forms of the superelements: the files that the scene file names, or `NAME.superelement` for a
    /// superelement of this name whose matrices are in other files.
    pub binaries: Vec<(String, Vec<u8>)>,
}

impl From<&str> for Source {
    /// Source of a scene that names no other files.
    fn from(text: &str) -> Self {
        Self { text: text.to_owned(), tables: Vec::new(), binaries: Vec::new() }
    }
}

/// The folder of a scene file, with the files that have been read from it.
pub struct Folder<'a> {
    path: Option<&'a Path>,
    matrices: Option<&'a dyn MatrixFiles>,
    /// Names and texts of the CSV files.
    pub(super) texts: Vec<(String, String)>,
    /// Tables over time that were asked for, or the problems found in them, by the place of their texts.
    tables: Vec<(usize, Result<TimeTable, String>)>,
    /// Names and packed forms of superelements.
    pub(super) binaries: Vec<(String, Vec<u8>)>,
}

impl<'a> Folder<'a> {
    /// Makes a folder; `None` for a scene that is not from a file.
    #[must_use]
    pub fn new(path: Option<&'a Path>) -> Self {
        Self { path, matrices: None, texts: Vec::new(), tables: Vec::new(), binaries: Vec::new() }
    }

    /// Reads matrix files with this reader; without one, only packed superelements can be read.
    #[must_use]
    pub fn with_matrices(self, matrices: &'a dyn MatrixFiles) -> Self {
        Self { matrices: Some(matrices), ..self }
    }

    /// Reads the table over time in a file of the folder.
    ///
    /// # Errors
    /// Returns what is wrong with the file's name or content, and what would be right.
    pub(super) fn table(&mut self, name: &str) -> Result<&TimeTable, String> {
        let text = self.text_place(name)?;
        let known = self.tables.iter().position(|(place, _)| *place == text);
        let place = known.unwrap_or_else(|| {
            self.tables.push((text, TimeTable::parse(&self.texts[text].1)));
            self.tables.len() - 1
        });
        self.tables[place].1.as_ref().map_err(Clone::clone)
    }

    /// Reads the text of a CSV file of the folder.
    ///
    /// # Errors
    /// Returns what is wrong with the file's name or content, and what would be right.
    pub(super) fn csv(&mut self, name: &str) -> Result<&str, String> {
        let place = self.text_place(name)?;
        Ok(&self.texts[place].1)
    }

    /// The place of a CSV file's text, which is read at its first use.
    fn text_place(&mut self, name: &str) -> Result<usize, String> {
        if !is_plain(name, "csv") {
            // The file can then be stored in an FMU under the same name.
            return Err("must be the name of a .csv file beside the scene, without folders".into());
        }
        let Some(folder) = self.path else {
            return Err("only a scene that is read from a file can name a CSV file".into());
        };
        if let Some(place) = known_as(name, &self.texts)? {
            return Ok(place);
        }
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
        let text = text::decode(name, CSV_FILE, bytes).map_err(|error| error.to_string())?;
        self.texts.push((name.to_owned(), text));
        Ok(self.texts.len() - 1)
    }

    /// Reads a packed superelement of the folder.
    ///
    /// # Errors
    /// Returns what is wrong with the file's name or content, and what would be right.
    pub(super) fn packed(&mut self, name: &str) -> Result<SuperelementMatrices, String> {
        if !is_plain(name, PACKED) {
            return Err(format!(
                "must be the name of a .{PACKED} file beside the scene, without folders"
            ));
        }
        let Some(folder) = self.path else {
            return Err("only a scene that is read from a file can name a superelement".into());
        };
        let known = known_as(name, &self.binaries)?;
        let before: usize = self.binaries.iter().map(|(_, bytes)| bytes.len()).sum();
        let left = match known {
            Some(_) => MAX_PACKED,
            None => MAX_ALL_PACKED.saturating_sub(before as u64).min(MAX_PACKED),
        };
        let bytes = text::read(&folder.join(name), left)
            .map_err(|error| format!("cannot be read: {error}"))?;
        let bytes = bytes.ok_or_else(|| {
            format!(
                "is too large: a superelement has at most {}, and those of a scene have at most {} together; reduce to \
                 fewer degrees of freedom",
                text::megabytes(MAX_PACKED),
                text::megabytes(MAX_ALL_PACKED)
            )
        })?;
        let matrices = SuperelementMatrices::from_bytes(&bytes)?;
        match known {
            // The name may be that of the packed form of a superelement with matrices in other files.
            Some(place) if self.binaries[place].1 != bytes => {
                return Err(
                    "has other matrices than the superelement of this name, which the FMU would carry in a file of the same \
                     name; give one of them another name"
                        .into(),
                );
            }
            Some(_) => {}
            None => self.binaries.push((name.to_owned(), bytes)),
        }
        Ok(matrices)
    }

    /// Reads a superelement from matrix files.
    ///
    /// # Errors
    /// Returns all that is wrong with the files; the path of each problem is a key of the table, or empty.
    pub(super) fn matrices(
        &mut self,
        files: &SuperelementFiles,
    ) -> Result<SuperelementMatrices, Vec<Problem>> {
        let refused = |message: &str| Err(vec![Problem::new("", message)]);
        let Some(folder) = self.path else {
            return refused("only a scene that is read from a file can name files of matrices");
        };
        let Some(reader) = self.matrices else {
            return refused(
                "files of matrices are read by the programs alone; an FMU has a packed superelement, `file`",
            );
        };
        let matrices = reader.read(folder, files)?;
        let (name, bytes) = (format!("{}.{PACKED}", files.name), matrices.to_bytes());
        match known_as(&name, &self.binaries) {
            Ok(None) => self.binaries.push((name, bytes)),
            Ok(Some(place)) if self.binaries[place].1 == bytes => {}
            _ => {
                let message = format!("another superelement has its matrices in {name}");
                let help = "give this superelement another name";
                return Err(vec![Problem::new("name", message).of(&files.name).help(help)]);
            }
        }
        Ok(matrices)
    }
}

/// Largest size of a packed superelement, in bytes.
const MAX_PACKED: u64 = 256_000_000;
/// Largest size of the packed superelements of a scene together, in bytes.
const MAX_ALL_PACKED: u64 = 1_000_000_000;

/// The place of a file that has been read; `None` if it has not.
///
/// # Errors
/// Refuses a name that some systems would take for another one when the FMU is unpacked.
fn known_as<T>(name: &str, files: &[(String, T)]) -> Result<Option<usize>, String> {
    let known = files.iter().position(|(known, _)| known.eq_ignore_ascii_case(name));
    match known.map(|place| (place, &files[place].0)) {
        Some((_, other)) if other != name => Err(format!(
            "differs from {other} only in upper and lower case; write both names alike"
        )),
        known => Ok(known.map(|(place, _)| place)),
    }
}

/// `true` if the name is a plain file name with this ending, which means the same on every machine and cannot lead to
/// another folder.
fn is_plain(name: &str, ending: &str) -> bool {
    let is_kind = Path::new(name).extension().is_some_and(|end| end.eq_ignore_ascii_case(ending));
    is_kind && !name.starts_with('.') && !name.contains(['/', '\\', ':', '\0'])
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

    /// A reader that gives one mass of 2 kg whatever the files are.
    struct OneMass;

    fn one_mass(stiffness: f64) -> SuperelementMatrices {
        let freedoms = vec![super::super::Freedom { node: 1, direction: 1 }];
        SuperelementMatrices::new(freedoms, vec![2.0], vec![stiffness], Vec::new()).unwrap()
    }

    impl MatrixFiles for OneMass {
        fn read(
            &self,
            _: &Path,
            _: &SuperelementFiles,
        ) -> Result<SuperelementMatrices, Vec<Problem>> {
            Ok(one_mass(100.0))
        }
    }

    #[test]
    fn a_packed_file_is_never_taken_for_the_matrices_of_another_superelement() {
        let path = std::env::temp_dir().join(format!("amontons-packed-{}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        let put = |stiffness: f64| {
            std::fs::write(path.join("pad.superelement"), one_mass(stiffness).to_bytes()).unwrap();
        };
        let files = SuperelementFiles {
            name: "pad".into(),
            folder: None,
            stiffness: None,
            mass: None,
            freedoms: None,
            damping: None,
            gyroscopic: None,
            circulatory: None,
            alpha: 0.0,
            beta: 0.0,
            damping_ratio: Vec::new(),
            units: Default::default(),
        };
        let folder = || Folder::new(Some(&path)).with_matrices(&OneMass);
        put(300.0);
        let mut one = folder();
        one.matrices(&files).unwrap();
        let message = one.packed("pad.superelement").unwrap_err();
        assert!(message.contains("other matrices"), "{message}");
        let mut other = folder();
        assert_eq!(other.packed("pad.superelement").unwrap().stiffness(), [300.0]);
        assert!(other.packed("pad.superelement").is_ok());
        assert!(other.matrices(&files).is_err());
        // The same matrices in both are no clash.
        put(100.0);
        let mut same = folder();
        same.matrices(&files).unwrap();
        assert_eq!(same.packed("pad.superelement").unwrap().stiffness(), [100.0]);
        std::fs::remove_dir_all(&path).unwrap();
    }
}
