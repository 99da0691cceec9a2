//! The command line of the checker. The program `fmu-check` consists of this command; `amontons check` is the same
//! command among others.

use crate::{Error, Glibc, Options, Rule, Run, Watch, check, run_library};
use clap::Args;
use std::fmt::Write as _;
use std::io::{self, Write as _, stdout};
use std::path::PathBuf;
use std::time::Duration;

const NOTES: &str = "Exit codes: 0 no findings, 1 at least one finding, 2 the file cannot be read as an FMU or \
its library cannot be started, 130 interrupted. Each finding is one line: the rule, the file (and line), and what \
is wrong. A line that begins with \"hint:\" names something that is wrong on some hosts only; with --strict it \
counts as a finding. A line that begins with \"note:\" says what could not be examined.\n\nThe library runs in a \
process of its own with limits on time, memory and file size. This is not a sandbox: the library can do whatever \
its user can. With --no-run, files are only read and the library is not run.";

/// The arguments of an examination.
#[derive(Args, Clone, Debug)]
#[command(after_help = NOTES, after_long_help = format!("{NOTES}\n\nRules:\n{}", rules()))]
pub struct Arguments {
    /// The FMU to check
    #[arg(required_unless_present = "rules")]
    file: Option<PathBuf>,
    /// List all rules
    #[arg(long, conflicts_with = "file")]
    rules: bool,
    /// Only read files; do not run the library
    #[arg(long)]
    no_run: bool,
    /// Time limit of the run, s
    #[arg(long, value_name = "SECONDS", default_value = "60", value_parser = clap::value_parser!(u64).range(1..=86400),
        conflicts_with = "no_run")]
    timeout: u64,
    /// The newest glibc that a Linux library may need; without this option, a library that needs a newer one than 2.17
    /// gets a hint
    #[arg(long, value_name = "VERSION")]
    glibc: Option<Glibc>,
    /// Count hints as findings
    #[arg(long)]
    strict: bool,
}

/// The arguments of the processes in which a library runs: an examination starts them, no user does.
#[derive(Args, Clone, Debug)]
pub struct LibraryRun {
    folder: PathBuf,
    library: String,
    timeout: u64,
    #[arg(long)]
    supervisor: Option<u32>,
}

/// Reasons for which the command ends with another exit code than 0.
#[derive(Debug, thiserror::Error)]
pub enum Failed {
    /// The FMU breaks rules: the number of findings.
    #[error("{0} finding{plural}", plural = if *.0 == 1 { "" } else { "s" })]
    Found(usize),
    /// The file cannot be read or is not an FMU, or its library cannot be started.
    #[error(transparent)]
    Unreadable(#[from] Error),
    /// The watch has ended the examination.
    #[error("interrupted")]
    Interrupted,
    /// The report cannot be written to standard output.
    #[error(transparent)]
    Output(#[from] io::Error),
}

impl Failed {
    /// The exit code of a program that ends for this reason.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Found(_) | Self::Output(_) => 1,
            Self::Unreadable(_) => 2,
            Self::Interrupted => 130,
        }
    }
}

/// Examines an FMU and prints the report, or lists the rules. The library runs in this program, started anew with the
/// subcommand [`COMMAND`](crate::COMMAND); the program must hand that to [`run_in_process`].
///
/// # Errors
/// Returns an error if the FMU breaks a rule or cannot be read, or if `watch` has ended the examination.
pub fn run(arguments: &Arguments, watch: Watch<'_>) -> Result<(), Failed> {
    let Some(file) = &arguments.file else {
        stdout().lock().write_all(rules().as_bytes())?;
        return Ok(());
    };
    let run = if arguments.no_run {
        None
    } else {
        let program = std::env::current_exe().map_err(|error| {
            Error::new(format!(
                "cannot run the library: the path of this program is unknown: {error}"
            ))
        })?;
        Some(Run { program, timeout: Duration::from_secs(arguments.timeout) })
    };
    let options = Options { glibc: arguments.glibc, run };
    let report = check(file, &options, watch)?.ok_or(Failed::Interrupted)?;
    write!(stdout().lock(), "{report}")?;
    let (found, hints) = (report.count(), report.hints.len());
    let failing = if arguments.strict { found + hints } else { found };
    if failing > 0 {
        return Err(Failed::Found(failing));
    }
    match hints {
        0 => eprintln!("no findings"),
        1 => eprintln!("no findings, 1 hint"),
        hints => eprintln!("no findings, {hints} hints"),
    }
    Ok(())
}

/// Runs the library of an unpacked FMU, as the subcommand [`COMMAND`](crate::COMMAND) of the program does.
///
/// # Errors
/// Returns an error if the journal of the run cannot be written or the process cannot be started.
pub fn run_in_process(arguments: &LibraryRun) -> Result<(), Error> {
    let LibraryRun { folder, library, timeout, supervisor } = arguments;
    run_library(folder, library, Duration::from_secs(*timeout), *supervisor)
}

/// Returns all rules as text, one per line.
fn rules() -> String {
    let width = Rule::ALL.iter().map(|rule| rule.id().len()).max().unwrap_or(0);
    Rule::ALL.iter().fold(String::new(), |mut text, rule| {
        let _ = writeln!(text, "{:width$}  {}", rule.id(), rule.line());
        text
    })
}
