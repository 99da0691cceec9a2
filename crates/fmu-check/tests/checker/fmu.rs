//! A sound FMU of another maker, and how it is broken: a model description and a library of one C file.

use super::program::{folder, run, text};
use fmu_check::{Class, Rule};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::{Cursor, Write};
use std::path::Path;
use std::process::Command;
use std::sync::{Mutex, OnceLock};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

pub const PROGRAM: &str = env!("CARGO_BIN_EXE_fmu-check");
pub const LIBRARY: &str = "binaries/linux64/decay.so";
const XML: &str = include_str!("model.xml");
const SOURCE: &str = include_str!("decay.c");

/// Compiles the model with more flags of the compiler; each library once.
pub fn library(flags: &[&str]) -> Vec<u8> {
    static MADE: OnceLock<Mutex<BTreeMap<String, Vec<u8>>>> = OnceLock::new();
    let mut made = MADE.get_or_init(Mutex::default).lock().unwrap();
    let key = flags.join(" ");
    made.entry(key).or_insert_with(|| compile(SOURCE, flags)).clone()
}

/// The functions of FMI, as the model's source has them.
pub fn functions() -> Vec<String> {
    let words = SOURCE.split(|c: char| !c.is_ascii_alphanumeric() && c != '_');
    let names: BTreeSet<&str> = words.filter(|word| word.starts_with("fmi2")).collect();
    names.into_iter().map(str::to_owned).collect()
}

/// Compiles a source to a shared library.
pub fn compile(source: &str, flags: &[&str]) -> Vec<u8> {
    let folder = folder();
    let [from, to] = ["a.c", "a.so"].map(|name| folder.path().join(name));
    fs::write(&from, source).unwrap();
    let mut cc = Command::new("cc");
    cc.args(["-O1", "-fPIC", "-shared", "-fvisibility=hidden", "-w", "-o"]).arg(&to).arg(&from);
    let output = cc.args(flags).output().unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    fs::read(to).unwrap()
}

/// The files of an FMU.
#[derive(Clone)]
pub struct Files(pub Vec<(String, Vec<u8>)>);

/// The sound one.
pub fn sound() -> Files {
    with_library(library(&[]))
}

pub fn with_library(library: Vec<u8>) -> Files {
    let file = |name: &str, content: &[u8]| (name.to_owned(), content.to_vec());
    Files(vec![
        file("modelDescription.xml", XML.as_bytes()),
        (LIBRARY.to_owned(), library),
        file("resources/a.txt", b"needed\n"),
        file("sources/decay.c", SOURCE.as_bytes()),
    ])
}

impl Files {
    /// Other text in the model description, at its one place.
    pub fn edit(mut self, from: &str, to: &str) -> Self {
        let xml = String::from_utf8(self.0[0].1.clone()).unwrap();
        assert_eq!(xml.matches(from).count(), 1, "{from}");
        self.0[0].1 = xml.replace(from, to).into_bytes();
        self
    }

    pub fn add(mut self, name: &str, content: &[u8]) -> Self {
        self.0.push((name.to_owned(), content.to_vec()));
        self
    }

    pub fn rename(mut self, from: &str, to: &str) -> Self {
        let file = self.0.iter_mut().find(|(name, _)| name == from).unwrap();
        to.clone_into(&mut file.0);
        self
    }

    pub fn pack(&self) -> Vec<u8> {
        let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
        let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
        for (name, content) in &self.0 {
            writer.start_file(name.as_str(), options).unwrap();
            writer.write_all(content).unwrap();
        }
        writer.finish().unwrap().into_inner()
    }
}

/// Runs the program on an FMU, without valgrind. Returns its exit code and its output.
pub fn check(fmu: &[u8], arguments: &[&str]) -> (i32, String) {
    let plainly: &[&str] = if arguments.contains(&"--no-run") { &[] } else { &["--no-valgrind"] };
    check_with(fmu, &[arguments, plainly].concat())
}

/// Runs the program on an FMU, with valgrind where it is installed. Returns its exit code and its output.
pub fn check_with(fmu: &[u8], arguments: &[&str]) -> (i32, String) {
    let folder = folder();
    fs::write(folder.path().join("a.fmu"), fmu).unwrap();
    let output = run(PROGRAM, folder.path(), &[&["a.fmu"], arguments].concat());
    let errors = text(&output.stderr);
    assert!(!errors.contains("panicked"), "{errors}");
    let left: Vec<_> = fs::read_dir(folder.path()).unwrap().collect();
    assert_eq!(left.len(), 1, "{left:?}");
    (output.status.code().unwrap(), text(&output.stdout))
}

/// The rules that findings of any class name.
pub fn rules(printed: &str) -> BTreeSet<&str> {
    let findings = printed.lines().filter(|line| !line.starts_with("note: "));
    findings.map(|line| line.split(' ').nth(1).unwrap()).collect()
}

/// Names a folder in which all broken FMUs are kept.
pub const KEEP: &str = "KEEP_BROKEN_FMUS";

/// An FMU must break this rule and no other, and the exit code must be that of the rule's class; what is printed of it.
pub fn assert_breaks(rule: &str, fmu: &[u8], arguments: &[&str]) -> String {
    if let Some(folder) = std::env::var_os(KEEP) {
        let mut hasher = DefaultHasher::new();
        fmu.hash(&mut hasher);
        let name = format!("{rule}-{:016x}.fmu", hasher.finish());
        fs::write(Path::new(&folder).join(name), fmu).unwrap();
    }
    let (code, printed) = check(fmu, arguments);
    assert_eq!(rules(&printed), BTreeSet::from([rule]), "{rule} was to be broken: {printed}");
    let class = Rule::named(rule).unwrap().class();
    let wanted = match class {
        Class::Violation => 1,
        Class::Defect => 3,
        Class::Hint => 0,
    };
    assert_eq!(code, wanted, "{printed}");
    let lines = printed.lines().filter(|line| !line.starts_with("note: "));
    for line in lines {
        assert!(line.starts_with(&format!("{class}: {rule} ")), "{printed}");
    }
    printed
}
