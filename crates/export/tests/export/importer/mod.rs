//! The importer in C (`tests/host/`): three FMUs, unpacked, and the program that is compiled to know them.

pub mod sanitized;

use crate::python;
use amontons::scene::{builtin, parse};
use amontons::simulation::catalogue::{Causality, Kind};
use amontons::simulation::{Variable, fingerprint, variables};
use amontons_export::package::{self, Library};
use std::ffi::OsString;
use std::fmt::Write as _;
use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

/// A name that a URI can only hold with percent signs.
const FOLDER: &str = "Prüfstand № 1 – 50 %";

/// Built-in scenes, what C calls their FMUs, and an initial velocity of each.
const FMUS: [(&str, &str, &str); 3] = [
    ("set1", "SET1", "initial.module[1].v2"),
    ("ring12", "RING12", "initial.module[1].v2"),
    // The quickest to begin with: a mass, a spring, a contact, and with exact motion no critical step to be found.
    ("stick_slip", "STICK_SLIP", "initial.mass.block.vx"),
];

/// The compiled importer, and the folder of what it loads.
pub struct Importer {
    _folder: TempDir,
    program: PathBuf,
}

impl Importer {
    /// With the library that the program carries.
    pub fn new() -> Self {
        Self::with(None, &[])
    }

    /// With another build of the library, if one is given, and more for the linker.
    pub fn with(library: Option<&Path>, link: &[OsString]) -> Self {
        let folder = TempDir::new_in(env!("CARGO_TARGET_TMPDIR")).expect("there is room");
        let headers = headers();
        let mut about = String::new();
        for (name, constant, parameter) in FMUS {
            let place = folder.path().join(FOLDER).join(name);
            about += &unpack(name, constant, parameter, &place, library);
        }
        fs::write(folder.path().join("about.h"), about).expect("there is room");
        fs::write(folder.path().join("functions.h"), functions(&headers)).expect("there is room");
        let program = folder.path().join("importer");
        let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/host");
        let mut compiler = Command::new("cc");
        compiler
            .args(["-std=c11", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O1", "-g"])
            // dlopen, threads and mallinfo2 are not ISO C's.
            .args(["-D_GNU_SOURCE", "-pthread", "-I"])
            .arg(folder.path())
            .arg("-I")
            .arg(headers)
            .arg("-I")
            .arg(&sources);
        for entry in fs::read_dir(&sources).expect("it is there") {
            let path = entry.expect("it can be read").path();
            if path.extension().is_some_and(|extension| extension == "c") {
                compiler.arg(path);
            }
        }
        compiler.arg("-o").arg(&program).args(link).args(["-ldl", "-lm"]);
        succeed(&mut compiler);
        Self { _folder: folder, program }
    }

    /// The program by itself.
    pub fn command(&self, arguments: &str) -> Command {
        self.under(&[], arguments)
    }

    /// The program under another one.
    pub fn under(&self, other: &[&str], arguments: &str) -> Command {
        let mut command = match other.split_first() {
            Some((first, rest)) => {
                let mut command = Command::new(first);
                command.args(rest).arg(&self.program);
                command
            }
            None => Command::new(&self.program),
        };
        command.args(arguments.split_whitespace());
        command
    }
}

/// Runs a command that has to succeed, and shows what it prints.
pub fn succeed(command: &mut Command) -> String {
    let (succeeded, text) = run(command);
    assert!(succeeded, "{command:?}\n{text}");
    print!("{text}");
    text
}

/// Runs a command that has to fail, for the reason that it tells.
pub fn fail(command: &mut Command) -> String {
    let (succeeded, text) = run(command);
    assert!(!succeeded, "{command:?} is content\n{text}");
    text
}

fn run(command: &mut Command) -> (bool, String) {
    let Output { status, stdout, stderr } =
        command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let text = String::from_utf8_lossy(&stdout).into_owned() + &String::from_utf8_lossy(&stderr);
    (status.success(), text)
}

/// The folder of FMI's own headers, which FMPy brings.
fn headers() -> PathBuf {
    let find = "import importlib.util; print(importlib.util.find_spec('fmpy').origin)";
    let (succeeded, text) = run(Command::new(python::interpreter()).args(["-c", find]));
    assert!(succeeded, "{text}");
    Path::new(text.trim()).with_file_name("c-code")
}

/// The functions that an FMU for co-simulation has, as FMI's header declares them, as a macro over them all.
fn functions(headers: &Path) -> String {
    let header = fs::read_to_string(headers.join("fmi2Functions.h")).expect("FMPy brings it");
    // The sections appear twice: names for a prefix come first, the exports after them.
    let exports = &header[header.find("FMI2_Export fmi2").expect("it exports functions")..];
    let (common, rest) = exports.split_once("for Model Exchange").expect("it has that section");
    let (_, co_simulation) = rest.split_once("for Co-Simulation").expect("it has that section");
    let mut text = "#define FUNCTIONS(F)".to_owned();
    let mut count = 0;
    for line in common.lines().chain(co_simulation.lines()) {
        if line.trim_start().starts_with("FMI2_Export") {
            let name =
                line.split_whitespace().last().expect("there is a name").trim_end_matches(';');
            write!(text, " \\\n    F({name})").expect("a String takes it");
            count += 1;
        }
    }
    // 25 common ones and 9 of co-simulation: the header was read right.
    assert_eq!(count, 34, "{text}");
    text + "\n"
}

/// Unpacks a scene's FMU, and tells C about it.
fn unpack(
    name: &str,
    constant: &str,
    parameter: &str,
    place: &Path,
    library: Option<&Path>,
) -> String {
    let mut text = builtin(name).expect("it is built in").text.to_owned();
    if name == "stick_slip" {
        text = text.replacen("[integrator]", "[integrator]\nmethod = \"event-driven\"", 1);
    }
    let scene = parse(name, &text).expect("it is a scene");
    let bytes = package::fmu(&scene, &text.as_str().into(), None, Library::carried())
        .expect("it can be packaged");
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).expect("it is an archive");
    archive.extract(place).expect("there is room");
    let file = place.join("binaries").join("linux64").join(format!("{name}.so"));
    if let Some(other) = library {
        fs::copy(other, &file).expect("there is room");
    }
    let variables = variables(&scene);
    let reference = |name: &str| {
        variables.iter().position(|variable| variable.name == name).expect("it has that variable")
    };
    let is_output = |variable: &Variable| {
        variable.causality == Causality::Output
            && matches!(variable.template.kind, Kind::Real { .. })
    };
    let outputs: Vec<String> = (0..variables.len())
        .filter(|&reference| is_output(&variables[reference]))
        .map(|reference| reference.to_string())
        .collect();
    format!(
        "static const fmi2ValueReference {constant}_OUTPUTS[] = {{{}}};\n\
         const struct about {constant} = {{\n    \"{name}\",\n    \"{}\",\n    \"{}\",\n    \"{}\",\n    \
         {}, {}, {}, {}, {}, {}, {constant}_OUTPUTS,\n}};\n",
        outputs.join(", "),
        file.display(),
        uri(&place.join("resources")),
        fingerprint(&text.as_str().into()),
        variables.len(),
        reference("slider.velocity"),
        reference("friction.coefficient"),
        reference(parameter),
        reference("statistics.state_changes"),
        outputs.len(),
    )
}

/// The URI of a folder, in which percent signs stand for all but letters, digits and what RFC 3986 leaves alone.
fn uri(path: &Path) -> String {
    let mut uri = "file://".to_owned();
    for &byte in path.as_os_str().as_encoded_bytes() {
        if byte.is_ascii_alphanumeric() || b"/-._~".contains(&byte) {
            uri.push(char::from(byte));
        } else {
            write!(uri, "%{byte:02X}").expect("a String takes it");
        }
    }
    uri
}
