//! The command line of the checker. The program `fmu-check` consists of this command; `amontons check` is the same
//! command among others.

use crate::output::{self, Examined};
use crate::run::{Task, Trial, run_library};
use crate::{Class, Error, Format, Glibc, Options, Report, Rule, Run, Watch, check};
use clap::Args;
use std::fmt::Write as _;
use std::io::{self, Write as _, stdout};
use std::path::PathBuf;
use std::time::Duration;

const NOTES: &str = "Exit codes: 0 nothing but hints and notes, 1 at least one violation, 3 no violation but a defect, \
4 only hints, with --strict, 2 a file cannot be read as an FMU or its library cannot be started, 130 interrupted. Of \
several FMUs the gravest counts: 2, then 1, 3, 4. Each finding is one line: its class, the rule, the file (and line), \
what is wrong, and the section of the standard. A \"violation\" contradicts a sentence of FMI 2.0; a \"defect\" makes the \
FMU fail; a \"hint\" names what the standard recommends or what is wrong on some hosts only. A line that begins with \
\"note:\" says what could not be examined.\n\nThe library runs in processes of their own with limits on time, memory \
and file size. This is not a sandbox: the library can do whatever its user can. With --no-run, files are only read \
and the library is not run.";

/// The arguments of an examination.
#[derive(Args, Clone, Debug)]
#[command(after_help = NOTES, after_long_help = format!("{NOTES}\n\nRules:\n{}", rules()))]
pub struct Arguments {
    /// The FMUs to check
    #[arg(required_unless_present = "rules", value_name = "FILE")]
    files: Vec<PathBuf>,
    /// List all rules, each with its class, section of FMI 2.0.5 and version since which it holds
    #[arg(long, conflicts_with = "files")]
    rules: bool,
    /// Format of the report
    #[arg(long, value_enum, default_value_t)]
    format: Format,
    /// Only read files; do not run the library
    #[arg(long)]
    no_run: bool,
    /// Time limit of each trial of the library, s
    #[arg(long, value_name = "SECONDS", default_value = "60", value_parser = clap::value_parser!(u64).range(1..=86400),
        conflicts_with = "no_run")]
    timeout: u64,
    /// Do not run the library under valgrind, which is done where it is installed
    #[arg(long, conflicts_with = "no_run")]
    no_valgrind: bool,
    /// The newest glibc that a Linux library may need; one that needs a newer version is then a defect. Without this
    /// option, a library that needs a newer one than 2.17 gets a hint
    #[arg(long, value_name = "VERSION")]
    glibc: Option<Glibc>,
    /// Let hints fail the check too
    #[arg(long)]
    strict: bool,
}

/// The arguments of the processes in which a library runs: an examination starts them, no user does.
#[derive(Args, Clone, Debug)]
pub struct LibraryRun {
    folder: PathBuf,
    library: String,
    timeout: u64,
    #[arg(long, requires = "supervisor")]
    trial: Option<Trial>,
    #[arg(long, requires = "trial")]
    supervisor: Option<u32>,
    #[arg(long)]
    no_valgrind: bool,
}

/// The numbers of findings of each class in all FMUs that were examined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.text())]
pub struct Found {
    /// Contradictions to the standard.
    pub violations: usize,
    /// Failures of the FMU.
    pub defects: usize,
    /// Recommendations that are not followed.
    pub hints: usize,
    /// `true` if hints count as failures.
    pub strict: bool,
}

impl Found {
    fn add(&mut self, report: &Report) {
        self.violations += report.count(Class::Violation);
        self.defects += report.count(Class::Defect);
        self.hints += report.count(Class::Hint);
    }

    fn exit_code(self) -> u8 {
        match self {
            Self { violations: 1.., .. } => 1,
            Self { defects: 1.., .. } => 3,
            Self { hints: 1.., strict: true, .. } => 4,
            Self { .. } => 0,
        }
    }

    fn text(self) -> String {
        let parts =
            [(self.violations, "violation"), (self.defects, "defect"), (self.hints, "hint")];
        let counted = parts.iter().filter(|(count, _)| *count > 0).map(|(count, word)| {
            let plural = if *count == 1 { "" } else { "s" };
            format!("{count} {word}{plural}")
        });
        let counted: Vec<_> = counted.collect();
        match counted[..] {
            [] => "no findings".to_owned(),
            _ if self.violations + self.defects == 0 => format!("no findings, {}", counted[0]),
            _ => counted.join(", "),
        }
    }
}

/// Reasons for which the command ends with another exit code than 0.
#[derive(Debug, thiserror::Error)]
pub enum Failed {
    /// FMUs break rules.
    #[error(transparent)]
    Found(#[from] Found),
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
            Self::Found(found) => found.exit_code(),
            Self::Output(_) => 1,
            Self::Unreadable(_) => 2,
            Self::Interrupted => 130,
        }
    }
}

/// Examines FMUs and prints the reports, or lists the rules. The library runs in this program, started anew with the
/// subcommand [`COMMAND`](crate::COMMAND); the program must hand that to [`run_in_process`].
///
/// # Errors
/// Returns an error if an FMU breaks a rule or cannot be read, or if `watch` has ended the examination.
pub fn run(arguments: &Arguments, watch: Watch<'_>) -> Result<(), Failed> {
    if arguments.rules {
        stdout().lock().write_all(rules().as_bytes())?;
        return Ok(());
    }
    let run = if arguments.no_run {
        None
    } else {
        let program = std::env::current_exe().map_err(|error| {
            Error::new(format!(
                "cannot run the library: the path of this program is unknown: {error}"
            ))
        })?;
        let timeout = Duration::from_secs(arguments.timeout);
        Some(Run { program, timeout, valgrind: !arguments.no_valgrind })
    };
    let options = Options { glibc: arguments.glibc, run };
    let Arguments { files, format, strict, .. } = arguments;
    let mut found = Found { strict: *strict, ..Found::default() };
    let mut all = Vec::new();
    for file in files {
        let result = check(file, &options, watch).transpose();
        let result = result.ok_or(Failed::Interrupted)?;
        if let Ok(report) = &result {
            found.add(report);
            if *format == Format::Text {
                write!(stdout().lock(), "{}", output::text(file, report, files.len() > 1))?;
            }
        }
        all.push(Examined { file, result });
    }
    write!(stdout().lock(), "{}", output::document(*format, &all, *strict))?;
    let mut errors = all.into_iter().filter_map(|examined| examined.result.err());
    if let Some(first) = errors.next() {
        errors.for_each(|error| eprintln!("error: {error}"));
        return Err(first.into());
    }
    if found.exit_code() > 0 {
        return Err(found.into());
    }
    eprintln!("{found}");
    Ok(())
}

/// Runs the library of an unpacked FMU, as the subcommand [`COMMAND`](crate::COMMAND) of the program does.
///
/// # Errors
/// Returns an error if the journal of the run cannot be written or the process cannot be started.
pub fn run_in_process(arguments: &LibraryRun) -> Result<(), Error> {
    let LibraryRun { folder, library, timeout, trial, supervisor, no_valgrind } = arguments;
    let task = match (*trial, *supervisor) {
        (Some(trial), Some(supervisor)) => Task::Try { trial, supervisor },
        _ => Task::Supervise { valgrind: !no_valgrind },
    };
    run_library(folder, library, Duration::from_secs(*timeout), &task)
}

/// Returns all rules as text, one per line: name, class, section of FMI 2.0.5 and version since which it holds (or
/// dashes), and requirement.
fn rules() -> String {
    let width = Rule::ALL.iter().map(|rule| rule.id().len()).max().unwrap_or(0);
    Rule::ALL.iter().fold(String::new(), |mut text, rule| {
        let (section, since) = (rule.section().unwrap_or("-"), rule.since().unwrap_or("-"));
        let (id, class, line) = (rule.id(), rule.class(), rule.line());
        let _ = writeln!(text, "{id:width$}  {class:9}  {section:5}  {since:5}  {line}");
        text
    })
}
