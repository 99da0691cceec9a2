//! What a scene is made from.

use super::time_table::CSV_FILE;
#[cfg(feature = "tools")]
use super::{Method, Preset};
use super::{TimeTable, text};
#[cfg(feature = "tools")]
use crate::Error;
#[cfg(feature = "tools")]
use serde::Serialize;
use std::path::Path;

/// A scene's files, word for word: all that an FMU needs to read it again.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Source {
    /// The scene file.
    pub text: String,
    /// Names and texts of the CSV files that it names, which lie in the same folder.
    pub tables: Vec<(String, String)>,
}

impl From<&str> for Source {
    /// A scene that names no other files.
    fn from(text: &str) -> Self {
        Self { text: text.to_owned(), tables: Vec::new() }
    }
}

#[cfg(feature = "tools")]
impl Source {
    /// Writes another method and step (s) into the scene file; all else stays as it is, comments included.
    ///
    /// # Errors
    /// The file is not TOML, or has no table `[integrator]`.
    pub fn set_integrator(&mut self, method: Method, step: f64) -> Result<(), Error> {
        self.set_keys([("method", word(method)?), ("step", step.into())])
    }

    /// Writes a preset in place of method and step into the scene file, as
    /// [`set_integrator`](Self::set_integrator).
    ///
    /// # Errors
    /// The same.
    pub fn set_preset(&mut self, preset: Preset) -> Result<(), Error> {
        self.set_keys([("preset", word(preset)?)])
    }

    /// Makes these the keys of `[integrator]`.
    fn set_keys<const N: usize>(
        &mut self,
        keys: [(&str, toml_edit::Value); N],
    ) -> Result<(), Error> {
        let mut document: toml_edit::DocumentMut =
            self.text.parse().map_err(|error| Error::scene(format!("{error}")))?;
        let table = document
            .get_mut("integrator")
            .and_then(toml_edit::Item::as_table_like_mut)
            .ok_or_else(|| Error::scene("[integrator] is missing"))?;
        for key in ["method", "step", "preset", "tolerance"] {
            if keys.iter().all(|(kept, _)| *kept != key) {
                table.remove(key);
            }
        }
        for (key, mut value) in keys {
            // What stands behind the old value goes on to stand behind the new one.
            let old = table.get(key).and_then(toml_edit::Item::as_value);
            if let Some(decor) = old.map(|old| old.decor().clone()) {
                *value.decor_mut() = decor;
            }
            table.insert(key, value.into());
        }
        self.text = document.to_string();
        Ok(())
    }
}

/// A word as a file has it.
#[cfg(feature = "tools")]
fn word(value: impl Serialize) -> Result<toml_edit::Value, Error> {
    value
        .serialize(toml_edit::ser::ValueSerializer::new())
        .map_err(|error| Error::scene(error.to_string()))
}

/// The folder of a scene file, and what has been read there so far.
pub(super) struct Folder<'a> {
    path: Option<&'a Path>,
    /// Names and texts of the files.
    pub(super) texts: Vec<(String, String)>,
    /// What they say.
    tables: Vec<Result<TimeTable, String>>,
}

impl<'a> Folder<'a> {
    /// A folder; `None` for a scene that is not from a file.
    pub(super) fn new(path: Option<&'a Path>) -> Self {
        Self { path, texts: Vec::new(), tables: Vec::new() }
    }

    /// The table in a file of the folder.
    ///
    /// # Errors
    /// What is wrong with its name or content, and what would be right.
    pub(super) fn table(&mut self, name: &str) -> Result<&TimeTable, String> {
        if !is_plain(name) {
            // So it can travel inside an FMU, under the same name.
            return Err("must be the name of a .csv file beside the scene, without folders".into());
        }
        let Some(folder) = self.path else {
            return Err("only a scene that is a file itself can name another".into());
        };
        let known = self.texts.iter().position(|(known, _)| known.eq_ignore_ascii_case(name));
        let place = match known {
            Some(place) if self.texts[place].0 == name => place,
            // Some systems would take the two for one when the FMU is unpacked.
            Some(place) => return Err(format!("is {} but for its case", self.texts[place].0)),
            None => {
                let before: usize = self.texts.iter().map(|(_, text)| text.len()).sum();
                let most = text::MAX_TABLES.saturating_sub(before as u64);
                let bytes = text::read(&folder.join(name), most)
                    .map_err(|error| format!("cannot be read: {error}"))?;
                let bytes = bytes.ok_or_else(|| {
                    format!(
                        "is too large: the CSV files of a scene have at most {} together; take rows that are further \
                         apart",
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

/// A file name that means the same on every machine, and cannot lead elsewhere.
fn is_plain(name: &str) -> bool {
    let is_csv = Path::new(name).extension().is_some_and(|end| end.eq_ignore_ascii_case("csv"));
    is_csv && !name.starts_with('.') && !name.contains(['/', '\\', ':', '\0'])
}

#[cfg(test)]
mod tests {
    use super::*;
    #[cfg(feature = "tools")]
    use crate::scene::{Scene, Selection, builtin, parse};

    #[cfg(feature = "tools")]
    #[test]
    fn another_integrator_is_written_into_the_file_and_nothing_else_is_touched() {
        let set1 = builtin("set1").unwrap();
        let mut source = Source::from(set1.text);
        source.set_integrator(Method::EventDriven, 2e-3).unwrap();
        let scene = parse("set1", &source.text).unwrap();
        let expected = Scene { method: Method::EventDriven, step: 2e-3, ..set1.scene() };
        assert_eq!(scene, expected);
        let lines = |text: &str| -> Vec<String> {
            let kept = |line: &&str| !line.starts_with("step") && !line.starts_with("method");
            text.lines().filter(kept).map(str::to_owned).collect()
        };
        assert_eq!(lines(&source.text), lines(set1.text));
        // Comments of the lines that changed stay as well.
        assert_eq!(source.text.matches('#').count(), set1.text.matches('#').count());

        // However the table is written.
        for text in ["integrator = { step = 1e-6 }", "integrator.step = 1e-6"] {
            let mut source = Source::from(text);
            source.set_integrator(Method::ForwardIncrement, 1e-4).unwrap();
            assert!(source.text.contains("1e-4") || source.text.contains("0.0001"), "{source:?}");
            assert!(source.text.contains("forward-increment"), "{source:?}");
        }
    }

    #[cfg(feature = "tools")]
    #[test]
    fn a_preset_takes_the_place_of_method_and_step_and_gives_it_back() {
        let set1 = builtin("set1").unwrap();
        let mut source = Source::from(set1.text);
        source.set_preset(Preset::Design).unwrap();
        let chosen = parse("set1", &source.text).unwrap();
        assert_eq!(chosen.selection, Selection::Preset(Preset::Design));
        source.set_integrator(set1.scene().method, set1.scene().step).unwrap();
        assert_eq!(parse("set1", &source.text).unwrap(), set1.scene());

        let mut source = Source::from("integrator = { method = \"auto\", tolerance = 1e-3 }");
        source.set_preset(Preset::Preview).unwrap();
        assert!(source.text.contains("preview") && !source.text.contains("auto"), "{source:?}");
    }

    #[test]
    fn only_files_beside_the_scene_are_read() {
        let mut folder = Folder::new(None);
        for name in ["../a.csv", "/a.csv", "b/a.csv", "b\\a.csv", "c:a.csv", ".csv", "a.txt", ""] {
            assert!(folder.table(name).unwrap_err().contains("without folders"), "{name}");
        }
        for name in ["a.csv", "Messung 3 für µ.CSV", "a.b.csv"] {
            assert!(folder.table(name).unwrap_err().contains("a file itself"), "{name}");
        }
    }
}
