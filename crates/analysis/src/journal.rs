//! Finished pieces of work in a file, one for each line, as JSON.
//!
//! The first line identifies the study by all that a piece depends on. A piece has a key, such as the value of the
//! parameter that it was made for; so a study may also be given a wider range, and computes only new pieces. A last
//! line without an end, as a full disk or a switched off machine leaves it, is dropped.
//!
//! Several workers can share a study: each computes some of the pieces that the study asks for ([`Journal::shared`]),
//! and a study in which a piece is missing ends as one that was interrupted does. With the pieces of all workers it
//! goes further, to its results or to pieces that depend on those before.

use amontons::Error;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::fs::{File, TryLockError};
use std::io::{ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard};

/// The pieces of a study that are finished.
pub struct Journal {
    /// Path of the file; `None` for a journal that is not kept.
    path: Option<PathBuf>,
    /// Beginning of the keys of all pieces that are asked for.
    prefix: String,
    /// `true` for the key of a piece that this worker computes.
    is_ours: Arc<dyn Fn(&str) -> bool + Send + Sync>,
    pages: Arc<Mutex<Pages>>,
}

#[derive(Default)]
struct Pages {
    file: Option<File>,
    done: HashMap<String, Value>,
    /// Keys of all pieces that the study has asked for.
    asked: BTreeSet<String>,
}

impl Journal {
    /// A journal that is forgotten when it is dropped.
    #[must_use]
    pub fn forgotten() -> Self {
        Self::of([])
    }

    /// A journal with these pieces, by their keys, that is forgotten when it is dropped.
    #[must_use]
    pub fn of(pieces: impl IntoIterator<Item = (String, Value)>) -> Self {
        let done = pieces.into_iter().collect();
        Self::new(None, Pages { done, ..Pages::default() })
    }

    fn new(path: Option<PathBuf>, pages: Pages) -> Self {
        let pages = Arc::new(Mutex::new(pages));
        Self { path, prefix: String::new(), is_ours: Arc::new(|_| true), pages }
    }

    /// The same journal for one analysis of a study that has several. The key of each of its pieces begins with `name`, so that two
    /// analyses may use equal keys.
    #[must_use]
    pub fn named(&self, name: &str) -> Self {
        let Self { path, prefix, is_ours, pages } = self;
        Self {
            path: path.clone(),
            prefix: format!("{prefix}{name}: "),
            is_ours: Arc::clone(is_ours),
            pages: Arc::clone(pages),
        }
    }

    /// Returns the same journal for one of several workers: a study then computes a missing piece only if `is_ours` is true
    /// of its key.
    #[must_use]
    pub fn shared(self, is_ours: impl Fn(&str) -> bool + Send + Sync + 'static) -> Self {
        Self { is_ours: Arc::new(is_ours), ..self }
    }

    /// Adds finished pieces, by their keys, without writing them to the file.
    pub fn learn(&self, pieces: impl IntoIterator<Item = (String, Value)>) {
        self.pages().done.extend(pieces);
    }

    /// The finished pieces by their keys.
    #[must_use]
    pub fn pieces(&self) -> BTreeMap<String, Value> {
        let pages = self.pages();
        pages.done.iter().map(|(key, piece)| (key.clone(), piece.clone())).collect()
    }

    /// Keys of the pieces that a study has asked for so far, known or not, in the order of their text.
    #[must_use]
    pub fn asked(&self) -> Vec<String> {
        self.pages().asked.iter().cloned().collect()
    }

    /// Keys of the pieces that a study has asked for so far and that are not finished, in the order of their text.
    #[must_use]
    pub fn missing(&self) -> Vec<String> {
        let Pages { asked, done, .. } = &*self.pages();
        asked.iter().filter(|key| !done.contains_key(*key)).cloned().collect()
    }

    /// Adds finished pieces, by their keys, to the file too, unless they are there.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
    pub fn adopt(&self, pieces: impl IntoIterator<Item = (String, Value)>) -> Result<(), Error> {
        let pages = &mut *self.pages();
        let pieces = pieces.into_iter().filter(|(key, _)| !pages.done.contains_key(key));
        let new: Vec<(String, Value)> = pieces.collect();
        if let (Some(file), Some(path), false) = (&mut pages.file, &self.path, new.is_empty()) {
            let lines: String = new.iter().map(|(key, piece)| line(key, piece)).collect();
            append(file, &lines).map_err(|error| Error::file(path, &error))?;
        }
        pages.done.extend(new);
        Ok(())
    }

    /// Opens the journal in a file, with the finished pieces of this study; a new one is begun where there is none,
    /// or with `anew`.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written, another program is writing it, it is of another study, or it
    /// is no journal.
    pub fn open(path: &Path, study: &Value, anew: bool) -> Result<Self, Error> {
        let failed = |error: std::io::Error| Error::file(path, &error);
        let options = File::options().read(true).write(true).create(true).truncate(false).clone();
        let mut file = options.open(path).map_err(failed)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                return Err(Error::unusable_file(format!(
                    "{} is being written by another study; wait for it, or give another folder with -o",
                    path.display()
                )));
            }
            // A file system without locks.
            Err(TryLockError::Error(_)) => {}
        }
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(failed)?;
        // Data after the last end of a line was cut off.
        let whole = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
        let (mut done, mut kept) = (HashMap::new(), 0);
        let has_lines = !anew && whole > 0;
        if has_lines && let Some(pieces) = read(path, &bytes[..whole], study)? {
            (done, kept) = (pieces, whole);
        }
        file.set_len(kept as u64).map_err(failed)?;
        file.seek(SeekFrom::End(0)).map_err(failed)?;
        if kept == 0 {
            append(&mut file, &format!("{}\n", json!({ "study": study }))).map_err(failed)?;
        }
        Ok(Self::new(Some(path.to_owned()), Pages { file: Some(file), done, ..Pages::default() }))
    }

    /// Number of finished pieces.
    #[must_use]
    pub fn len(&self) -> usize {
        self.pages().done.len()
    }

    /// `true` if no piece is finished.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The piece of work with this key: as it is noted here, or made and noted now. `None` where it was ended
    /// before it was finished, or where it is missing and another worker computes it.
    ///
    /// # Errors
    /// Returns an error if the work fails, or if the journal cannot be written; pieces that were noted before are
    /// kept.
    pub fn piece<T: Serialize + DeserializeOwned>(
        &self,
        key: &str,
        work: impl FnOnce() -> Result<Option<T>, Error>,
    ) -> Result<Option<T>, Error> {
        let key = &*format!("{}{key}", self.prefix);
        // In a statement of its own: the lock is not held during the work.
        let known = {
            let pages = &mut *self.pages();
            pages.asked.insert(key.to_owned());
            pages.done.get(key).cloned()
        };
        if let Some(value) = known {
            let path = self.path.as_deref().unwrap_or(Path::new(""));
            return serde_json::from_value(value).map(Some).map_err(|_| damaged(path));
        }
        if !(self.is_ours)(key) {
            return Ok(None);
        }
        let Some(piece) = work()? else { return Ok(None) };
        let value = serde_json::to_value(&piece).map_err(|error| {
            Error::unusable_file(format!("cannot record the result of {key}: {error}"))
        })?;
        let pages = &mut *self.pages();
        if let (Some(file), Some(path)) = (&mut pages.file, &self.path) {
            append(file, &line(key, &value)).map_err(|error| {
                Error::unusable_file(format!(
                    "cannot write {}: {error}; the results that were finished before are kept there, and the same \
                     command continues from them",
                    path.display()
                ))
            })?;
        }
        pages.done.insert(key.to_owned(), value);
        Ok(Some(piece))
    }

    fn pages(&self) -> MutexGuard<'_, Pages> {
        // A worker that panicked has noted nothing half.
        self.pages.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

/// Whose a journal's file is.
#[derive(Clone, Debug, PartialEq)]
pub enum Owner {
    /// There is no journal, or one without a first line.
    Nobody,
    /// The journal is that of this study.
    This,
    /// Another study's.
    Another {
        /// The difference between the studies.
        why: String,
        /// `true` if any of its pieces is finished.
        has_pieces: bool,
    },
}

impl Owner {
    /// Whose the journal in a file is: this study's, or another's.
    #[must_use]
    pub fn of(path: &Path, study: &Value) -> Self {
        let Ok(text) = std::fs::read(path) else { return Self::Nobody };
        // A line that is not whole was cut off.
        let Some(end) = text.iter().position(|byte| *byte == b'\n') else { return Self::Nobody };
        let has_pieces = text[end + 1..].contains(&b'\n');
        let head: Option<Value> = serde_json::from_slice(&text[..end]).ok();
        match head.as_ref().and_then(|head| head.get("study")) {
            Some(known) if known == study => Self::This,
            Some(known) => Self::Another { why: difference(known, study), has_pieces },
            None => Self::Another {
                why: "its journal was not written by a study of this version".to_owned(),
                has_pieces: true,
            },
        }
    }
}

/// A journal as a reader finds it that may not write it, while another program may.
pub struct Found {
    /// The study that its first line identifies.
    pub study: Value,
    /// The finished pieces by their keys.
    pub pieces: BTreeMap<String, Value>,
}

impl Found {
    /// The journal in a file, up to a line that is not whole, as a program that is writing or was killed leaves it;
    /// `None` if there is no file, or none with a first line.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read.
    pub fn at(path: &Path) -> Result<Option<Self>, Error> {
        let bytes = match std::fs::read(path) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            read => read.map_err(|error| Error::file(path, &error))?,
        };
        let mut lines = bytes.split_inclusive(|byte| *byte == b'\n');
        let mut next = || {
            let line = lines.next().filter(|line| line.ends_with(b"\n"))?;
            serde_json::from_slice::<Value>(line).ok()
        };
        let Some(study) = next().and_then(|mut head| head.get_mut("study").map(Value::take)) else {
            return Ok(None);
        };
        let pieces = std::iter::from_fn(|| entry(next()?)).collect();
        Ok(Some(Self { study, pieces }))
    }
}

/// The line of a piece.
fn line(key: &str, piece: &Value) -> String {
    format!("{}\n", json!({ "key": key, "piece": piece }))
}

/// The key and the piece of a line; `None` if it has none.
fn entry(mut line: Value) -> Option<(String, Value)> {
    let piece = line.get_mut("piece").map(Value::take);
    line.get("key").and_then(Value::as_str).map(str::to_owned).zip(piece)
}

/// Adds lines, of which the last is there as a whole or cut off.
fn append(file: &mut File, lines: &str) -> std::io::Result<()> {
    file.write_all(lines.as_bytes())?;
    match file.sync_data() {
        // Outputs such as a pipe cannot be synchronised to a disk.
        Err(error) if error.kind() == ErrorKind::InvalidInput => Ok(()),
        synced => synced,
    }
}

/// The pieces in whole lines of a journal of this study; `None` of one of another study without pieces.
fn read(path: &Path, bytes: &[u8], study: &Value) -> Result<Option<HashMap<String, Value>>, Error> {
    let mut lines = serde_json::Deserializer::from_slice(bytes).into_iter::<Value>();
    let head = lines.next().and_then(Result::ok).ok_or_else(|| damaged(path))?;
    let known = head.get("study").ok_or_else(|| damaged(path))?;
    if known != study {
        // Nothing is lost with it.
        if lines.next().is_none() {
            return Ok(None);
        }
        return Err(Error::unusable_file(format!(
            "{} belongs to another study: {}; choose another folder with -o, or discard its journal with --anew",
            path.display(),
            difference(known, study)
        )));
    }
    lines
        .map(|line| line.ok().and_then(entry).ok_or_else(|| damaged(path)))
        .collect::<Result<_, _>>()
        .map(Some)
}

/// The first difference between two studies: its name, the value there, in a file, and the value here.
#[must_use]
pub fn difference(there: &Value, here: &Value) -> String {
    let (mut path, mut two) = (String::new(), [there, here]);
    while let [Value::Object(a), Value::Object(b)] = two {
        // The kind of study says more than the settings that go with it, and these more than the values that follow
        // from them.
        let first = ["study", "scene", "set", "settings"].into_iter();
        let keys = first.chain(a.keys().chain(b.keys()).map(String::as_str));
        let mut keys = keys.filter(|key| a.get(*key) != b.get(*key));
        let Some(key) = keys.next() else { break };
        path = if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
        two = [a, b].map(|object| object.get(key).unwrap_or(&Value::Null));
    }
    let told = |value: &Value| match value {
        Value::Null => Some("not given".to_owned()),
        Value::Bool(_) | Value::Number(_) => Some(value.to_string()),
        Value::String(text) if text.len() <= LONGEST => Some(text.clone()),
        _ => None,
    };
    match [told(two[0]), told(two[1])] {
        [Some(there), Some(here)] => {
            format!("{path} is {there} in that study and {here} in this one")
        }
        _ => format!("{path} differs"),
    }
}

/// The longest text of a study that is quoted.
const LONGEST: usize = 60;

fn damaged(path: &Path) -> Error {
    Error::unusable_file(format!(
        "{} is damaged, or was not written by a study of this version; choose another folder with -o, or discard its journal with --anew",
        path.display()
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    fn made(journal: &Journal, key: &str, value: f64) -> (bool, Option<f64>) {
        let worked = Cell::new(false);
        let piece = journal.piece(key, || {
            worked.set(true);
            Ok(Some(value))
        });
        (worked.get(), piece.unwrap())
    }

    #[test]
    fn what_is_noted_is_the_same_double_when_it_is_read_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal.jsonl");
        let study = json!({ "kind": "test" });
        let values = [0.1 + 0.2, 1.0 / 3.0, 5e-324, 1.797_693_134_862_315_7e308, -0.0];
        let journal = Journal::open(&path, &study, false).unwrap();
        for value in values {
            assert_eq!(made(&journal, &format!("{value:e}"), value), (true, Some(value)));
        }
        drop(journal);
        let again = Journal::open(&path, &study, false).unwrap();
        for value in values {
            let (worked, found) = made(&again, &format!("{value:e}"), 7.0);
            assert!(!worked && found.unwrap().to_bits() == value.to_bits());
        }
    }

    #[test]
    fn named_analyses_of_one_study_do_not_mix_their_pieces() {
        let journal = Journal::forgotten();
        assert_eq!(made(&journal, "a", 1.0), (true, Some(1.0)));
        assert_eq!(made(&journal.named("changed"), "a", 2.0), (true, Some(2.0)));
        assert_eq!(made(&journal.named("changed"), "a", 3.0), (false, Some(2.0)));
        assert_eq!(made(&journal, "changed: a", 3.0), (false, Some(2.0)));
        let shared = journal.shared(|key| !key.starts_with("other: "));
        assert_eq!(made(&shared.named("other"), "a", 4.0), (false, None));
    }

    #[test]
    fn a_line_that_was_cut_off_is_made_again_and_those_before_it_are_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal.jsonl");
        let study = json!({ "kind": "test" });
        let journal = Journal::open(&path, &study, false).unwrap();
        made(&journal, "a", 1.0);
        made(&journal, "b", 2.0);
        drop(journal);
        let bytes = std::fs::read(&path).unwrap();
        for cut in 1..bytes.len() {
            std::fs::write(&path, &bytes[..cut]).unwrap();
            let again = Journal::open(&path, &study, false).unwrap();
            let lines = bytes[..cut].iter().filter(|byte| **byte == b'\n').count();
            assert_eq!(again.len(), lines.saturating_sub(1), "{cut}");
            assert_eq!(made(&again, "b", 2.0), (lines < 3, Some(2.0)));
        }
    }

    #[test]
    fn another_study_is_not_mixed_in_and_what_is_there_is_not_lost() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal.jsonl");
        made(&Journal::open(&path, &json!({ "window": 1.0 }), false).unwrap(), "a", 1.0);
        let other = Journal::open(&path, &json!({ "window": 2.0 }), false).map(|_| ()).unwrap_err();
        assert!(
            other.is_file()
                && other.to_string().contains("window is 1.0 in that study and 2.0 in this one")
        );
        assert_eq!(Owner::of(&path, &json!({ "window": 1.0 })), Owner::This);
        let why = "window is 1.0 in that study and 2.0 in this one".to_owned();
        let another = Owner::Another { why, has_pieces: true };
        assert_eq!(Owner::of(&path, &json!({ "window": 2.0 })), another);
        assert_eq!(Owner::of(&folder.path().join("none"), &json!({})), Owner::Nobody);
        assert_eq!(Journal::open(&path, &json!({ "window": 1.0 }), false).unwrap().len(), 1);
        assert_eq!(Journal::open(&path, &json!({ "window": 2.0 }), true).unwrap().len(), 0);
        std::fs::write(&path, "speed,amplitude\n").unwrap();
        assert!(Journal::open(&path, &json!({}), false).map(|_| ()).unwrap_err().is_file());
        assert!(matches!(Owner::of(&path, &json!({})), Owner::Another { .. }));
    }

    #[test]
    fn in_what_two_studies_differ_is_told_with_both_values() {
        let there =
            json!({ "a": 1, "file": "x".repeat(100), "set": {}, "settings": { "of": null } });
        let mut here = there.clone();
        here["file"] = json!("another");
        assert_eq!(difference(&there, &here), "file differs");
        here["settings"]["of"] = json!("block.x");
        assert_eq!(
            difference(&there, &here),
            "settings.of is not given in that study and block.x in this one"
        );
        here["set"] = json!({ "friction.coefficient": 0.5 });
        assert_eq!(
            difference(&there, &here),
            "set.friction.coefficient is not given in that study and 0.5 in this one"
        );
    }

    #[test]
    fn two_studies_do_not_write_one_journal() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal.jsonl");
        let _first = Journal::open(&path, &json!({}), false).unwrap();
        assert!(Journal::open(&path, &json!({}), false).map(|_| ()).unwrap_err().is_file());
    }

    #[test]
    fn a_full_disk_keeps_what_was_finished_and_says_so() {
        let journal = Journal::forgotten();
        made(&journal, "a", 1.0);
        let full = File::options().write(true).open("/dev/full").unwrap();
        journal.pages().file = Some(full);
        let journal = Journal { path: Some("/dev/full".into()), ..journal };
        let error = journal.piece("b", || Ok(Some(2.0))).unwrap_err();
        assert!(error.is_file() && error.to_string().contains("kept"), "{error}");
        assert_eq!(made(&journal, "a", 7.0), (false, Some(1.0)));
    }

    #[test]
    fn workers_that_share_a_study_compute_each_piece_once_and_name_those_that_are_missing() {
        let sum = |journal: &Journal| {
            let terms = ["1", "2", "3"].map(|key| journal.piece(key, || Ok(Some(1.0))).unwrap());
            let [Some(a), Some(b), Some(c)] = terms else { return None };
            journal.piece("sum", || Ok(Some(a + b + c))).unwrap()
        };
        let odd = Journal::forgotten().shared(|key| key != "2");
        assert_eq!((sum(&odd), odd.len()), (None, 2));
        assert_eq!(
            (odd.asked(), odd.missing()),
            (["1", "2", "3"].map(str::to_owned).to_vec(), vec!["2".to_owned()])
        );
        let even = Journal::of(odd.pieces()).shared(|key| key == "2");
        assert_eq!((sum(&even), even.missing()), (None, vec!["sum".to_owned()]));
        odd.learn(even.pieces());
        assert_eq!((sum(&odd), odd.missing()), (Some(3.0), vec![]));
    }

    #[test]
    fn a_journal_that_another_program_writes_is_read_up_to_its_last_whole_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal.jsonl");
        assert!(Found::at(&path).unwrap().is_none());
        let journal = Journal::open(&path, &json!({ "kind": "test" }), false).unwrap();
        journal.adopt(["a", "b"].map(|key| (key.to_owned(), json!(1.0)))).unwrap();
        // A second adoption adds no line.
        journal.adopt([("a".to_owned(), json!(1.0))]).unwrap();
        let whole = std::fs::read(&path).unwrap();
        assert_eq!(whole.iter().filter(|byte| **byte == b'\n').count(), 3);
        for cut in 0..=whole.len() {
            std::fs::write(&path, &whole[..cut]).unwrap();
            let lines = whole[..cut].iter().filter(|byte| **byte == b'\n').count();
            let found = Found::at(&path).unwrap();
            assert_eq!(found.map(|found| found.pieces.len()), lines.checked_sub(1), "{cut}");
        }
        // A network file system may show zeros where another machine's bytes are to come.
        let mut zeros = whole.clone();
        zeros[whole.len() - 9..whole.len() - 1].fill(0);
        std::fs::write(&path, zeros).unwrap();
        assert_eq!(Found::at(&path).unwrap().unwrap().pieces.len(), 1);
    }

    #[test]
    fn work_that_was_ended_is_not_noted() {
        let journal = Journal::forgotten();
        assert_eq!(journal.piece::<f64>("a", || Ok(None)), Ok(None));
        assert_eq!(made(&journal, "a", 3.0), (true, Some(3.0)));
    }
}
