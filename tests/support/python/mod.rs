//! A Python with the packages that `tests/support/python/requirements.txt` pins, made once per target folder.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Command;

/// The packages, each with its version.
const REQUIREMENTS: &str = include_str!("requirements.txt");

/// The interpreter of the virtual environment; makes the environment where it is missing, or of
/// other requirements or another Python.
pub fn interpreter() -> PathBuf {
    // Cargo gives integration tests the folder `tmp` below its target folder.
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).parent().expect("it has a parent");
    let environment = target.join("python");
    let interpreter = environment.join("bin").join("python");
    let stamp = environment.join("made-of.txt");
    let wanted = format!("{}\n{REQUIREMENTS}", version());

    fs::create_dir_all(target).expect("the target folder can be made");
    // Several test programs may come here at once; the lock falls with the file's end.
    let lock_path = target.join("python.lock");
    let lock = File::create(&lock_path)
        .unwrap_or_else(|error| panic!("cannot write {}: {error}", lock_path.display()));
    lock.lock().unwrap_or_else(|error| panic!("cannot lock {}: {error}", lock_path.display()));
    if fs::read_to_string(&stamp).is_ok_and(|found| found == wanted) {
        return interpreter;
    }
    make(&environment, &interpreter);
    // Last, so that an environment left half-made is made anew.
    fs::write(&stamp, wanted)
        .unwrap_or_else(|error| panic!("cannot write {}: {error}", stamp.display()));
    interpreter
}

fn make(environment: &Path, interpreter: &Path) {
    if environment.exists() {
        fs::remove_dir_all(environment)
            .unwrap_or_else(|error| panic!("cannot remove {}: {error}", environment.display()));
    }
    run(
        Command::new("python3").args(["-m", "venv"]).arg(environment),
        "python3 makes no virtual environment; install its module venv (Debian, Ubuntu: \
         apt install python3-venv)",
    );
    let requirements = environment.join("requirements.txt");
    fs::write(&requirements, REQUIREMENTS)
        .unwrap_or_else(|error| panic!("cannot write {}: {error}", requirements.display()));
    run(
        Command::new(interpreter)
            .args(["-m", "pip", "install", "--quiet", "--no-input", "--disable-pip-version-check"])
            .arg("--requirement")
            .arg(&requirements),
        "pip cannot install tests/support/python/requirements.txt; it needs Python 3.11 or later and a \
         package index (PIP_INDEX_URL names another one, PIP_FIND_LINKS a folder of wheels)",
    );
}

/// The version that `python3` states.
fn version() -> String {
    run(
        Command::new("python3").arg("--version"),
        "python3 cannot be run; install Python 3.11 or later as python3 on the PATH",
    )
}

/// Runs a command to its end; `advice` is told where that fails.
fn run(command: &mut Command, advice: &str) -> String {
    let output = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}\n{advice}"));
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    assert!(
        output.status.success(),
        "{command:?}: {}\n{}{}{advice}",
        output.status,
        text(&output.stdout),
        text(&output.stderr),
    );
    text(&output.stdout)
}
