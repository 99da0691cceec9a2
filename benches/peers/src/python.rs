//! Peers in Python: SciPy, in a virtual environment made below the target folder, and Siconos, which
//! Debian packages for its own Python.

use crate::peer::Outcome;
use crate::scenes::{Problem, ROWS};
use serde::Deserialize;
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

pub const SCIPY: &str = "SciPy DOP853 with events";
pub const SICONOS: &str = "Siconos, Moreau–Jean";

const DEBIANS_PYTHON: &str = "/usr/bin/python3";
const HERE: &str = env!("CARGO_MANIFEST_DIR");

/// One line of a script: a run that it has timed itself.
#[derive(Deserialize)]
struct Answer {
    setting: String,
    displacements: Vec<f64>,
    events: Option<u64>,
    touch_downs: Option<u64>,
    slices: Vec<f64>,
    turns: usize,
}

/// What came out of one setting of a script.
pub struct Timed {
    pub setting: String,
    pub outcome: Outcome,
    pub turns: usize,
}

/// The interpreter with SciPy; the environment is made where it is missing or half-made.
///
/// # Errors
/// No Python 3 with its venv module, or no package index.
pub fn scipy(folder: &Path) -> Result<PathBuf, String> {
    let environment = folder.join("python");
    let interpreter = environment.join("bin/python");
    let wanted = fs::read_to_string(Path::new(HERE).join("requirements.txt"))
        .map_err(|error| format!("requirements.txt: {error}"))?;
    let stamp = environment.join("made-of.txt");
    if fs::read_to_string(&stamp).is_ok_and(|found| found == wanted) {
        return Ok(interpreter);
    }
    let run = |command: &mut Command| match command.output() {
        Ok(output) if output.status.success() => Ok(()),
        Ok(output) => Err(String::from_utf8_lossy(&output.stderr).trim().to_owned()),
        Err(error) => Err(format!("{command:?}: {error}")),
    };
    run(Command::new("python3").args(["-m", "venv", "--clear"]).arg(&environment))?;
    let requirements = format!("{HERE}/requirements.txt");
    let pip = ["-m", "pip", "install", "--quiet", "--no-input", "--requirement", &requirements];
    run(Command::new(&interpreter).args(pip))?;
    fs::write(&stamp, wanted).map_err(|error| format!("{}: {error}", stamp.display()))?;
    Ok(interpreter)
}

/// The interpreter with Siconos.
///
/// # Errors
/// It is not installed.
pub fn siconos() -> Result<PathBuf, String> {
    let mut import = Command::new(DEBIANS_PYTHON);
    import.args(["-c", "import siconos.kernel, siconos.numerics"]);
    match import.stdout(Stdio::null()).stderr(Stdio::null()).status() {
        Ok(status) if status.success() => Ok(DEBIANS_PYTHON.into()),
        _ => Err("not installed; on Debian: \
                  apt-get update && apt-get install --no-install-recommends python3-siconos"
            .into()),
    }
}

/// Runs a script on a problem, in one thread, and gives every setting to `each` as it comes.
///
/// # Errors
/// The script fails; what it says goes to standard error.
pub fn run(
    interpreter: &Path,
    script: &str,
    problem: &Problem,
    quick: bool,
    folder: &Path,
    mut each: impl FnMut(Timed),
) -> Result<(), String> {
    let file = folder.join("problem.json");
    let text = serde_json::to_string(problem).expect("it is plain data");
    fs::write(&file, text).map_err(|error| format!("{}: {error}", file.display()))?;
    let mut command = Command::new(interpreter);
    command.arg(Path::new(HERE).join(script)).arg(&file).arg(ROWS.to_string());
    command.arg(if quick { "quick" } else { "whole" });
    for threads in ["OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"] {
        command.env(threads, "1");
    }
    let mut process =
        command.stdout(Stdio::piped()).spawn().map_err(|error| format!("{command:?}: {error}"))?;
    let output = BufReader::new(process.stdout.take().expect("it is piped"));
    for line in output.lines() {
        let line = line.map_err(|error| error.to_string())?;
        // Libraries of the peers write lines of their own.
        let Ok(answer) = serde_json::from_str::<Answer>(&line) else { continue };
        let Answer { setting, displacements, events, touch_downs, slices, turns } = answer;
        let outcome = Outcome { displacements, events, touch_downs, slices };
        each(Timed { setting, outcome, turns });
    }
    let status = process.wait().map_err(|error| error.to_string())?;
    if status.success() { Ok(()) } else { Err(format!("{script} ended with {status}")) }
}
