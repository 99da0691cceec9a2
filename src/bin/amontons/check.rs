//! `amontons check`, and the process in which it runs a library.

use crate::interrupt::{self, Interrupted};
use amontons::Error;
use amontons::check::{self, Glibc, Options, Rule, Run};
use amontons::progress::Progress;
use clap::Args;
use std::error;
use std::fmt::{self, Write as _};
use std::io::{Write, stdout};
use std::path::PathBuf;
use std::sync::Once;
use std::time::Duration;

const NOTES: &str = "Exit codes: 0 nothing found, 1 something found, 2 not readable as an FMU, 130 \
interrupted. A finding is a line: its rule, the file (and line), what is wrong. Lines that begin with note: \
say what could not be examined.\n\nThe run takes place in a process of its own with limits of time, memory \
and file size. That is no sandbox: a library can do what its user can. --no-run reads files only.";

#[derive(Args)]
#[command(after_help = NOTES, after_long_help = format!("{NOTES}\n\nRules:\n{}", rules()))]
pub struct Check {
    /// The FMU
    #[arg(required_unless_present = "rules")]
    file: Option<PathBuf>,
    /// List all rules
    #[arg(long, conflicts_with = "file")]
    rules: bool,
    /// Read files only: nothing of the FMU is run
    #[arg(long)]
    no_run: bool,
    /// How long the run may take, s
    #[arg(long, value_name = "SECONDS", default_value = "60", value_parser = clap::value_parser!(u64).range(1..=86400),
        conflicts_with = "no_run")]
    timeout: u64,
    /// The newest glibc that a library for Linux may need
    #[arg(long, value_name = "VERSION", default_value_t)]
    glibc: Glibc,
}

#[derive(Args)]
pub struct RunLibrary {
    folder: PathBuf,
    library: String,
    timeout: u64,
    #[arg(long)]
    supervisor: Option<u32>,
}

/// How an examination ends that is not without findings.
#[derive(Debug)]
pub enum Failed {
    /// Rules are broken, so many times.
    Found(usize),
    /// It is no FMU.
    Unreadable(Error),
}

impl Failed {
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Found(_) => 1,
            Self::Unreadable(_) => 2,
        }
    }
}

impl fmt::Display for Failed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Found(1) => f.write_str("1 finding"),
            Self::Found(count) => write!(f, "{count} findings"),
            Self::Unreadable(error) => error.fmt(f),
        }
    }
}

impl error::Error for Failed {}

pub fn run(arguments: &Check) -> Result<(), Box<dyn error::Error>> {
    let Some(file) = &arguments.file else {
        stdout().lock().write_all(rules().as_bytes())?;
        return Ok(());
    };
    let run = if arguments.no_run {
        None
    } else {
        let timeout = Duration::from_secs(arguments.timeout);
        Some(Run { program: std::env::current_exe()?, timeout })
    };
    let options = Options { glibc: arguments.glibc, run };
    let shown = Progress::new("the check", 0);
    // Until something has to be cleared away, Ctrl-C ends the program at once.
    let listen = Once::new();
    let watch = &mut |stage: &str| {
        listen.call_once(interrupt::listen);
        shown.say(stage);
        interrupt::stopped()
    };
    let report = check::check(file, &options, watch);
    shown.finish();
    let report = report.map_err(Failed::Unreadable)?.ok_or(Interrupted)?;
    write!(stdout().lock(), "{report}")?;
    match report.count() {
        0 => {
            eprintln!("no findings");
            Ok(())
        }
        count => Err(Failed::Found(count).into()),
    }
}

pub fn run_library(arguments: &RunLibrary) -> Result<(), Box<dyn error::Error>> {
    let timeout = Duration::from_secs(arguments.timeout);
    let RunLibrary { folder, library, supervisor, .. } = arguments;
    Ok(check::run_library(folder, library, timeout, *supervisor)?)
}

/// All rules, a line each.
fn rules() -> String {
    let width = Rule::ALL.iter().map(|rule| rule.id().len()).max().unwrap_or(0);
    Rule::ALL.iter().fold(String::new(), |mut text, rule| {
        let _ = writeln!(text, "{:width$}  {}", rule.id(), rule.line());
        text
    })
}
