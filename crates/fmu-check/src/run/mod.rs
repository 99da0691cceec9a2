//! Runs the library for this host in processes of their own, so that a crash, a hang or an exit does not affect the
//! checker.
//!
//! The FMU's files are unpacked into a private folder that is removed after the run. A supervisor starts a process for
//! each way in which the library is tried, the worker. It ends the worker when the limit of time or memory is reached or
//! when the checker has ended, and then ends all processes that the worker started. The worker has limits of memory, time
//! and file size, and its output is written to a file. These limits protect from accidents; they are no sandbox: the
//! library has all permissions of its user on files and the network.

mod journal;
mod process;
mod supervisor;
mod trial;
mod valgrind;
mod worker;

pub(crate) use trial::Trial;

use super::archive::{Archive, is_safe};
use super::options::Run;
use super::report::Report;
use super::xml;
use crate::Error;
use journal::Journal;
use std::fs::{self, File};
use std::io;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// The subcommand by which a program calls [`run_in_process`](crate::command::run_in_process).
pub const COMMAND: &str = "run-library";

const JOURNAL: &str = "journal";

/// Interval between two checks of a process's state.
const OFTEN: Duration = Duration::from_millis(5);

/// Function that is called with the stage of a run; it returns whether the examination continues.
pub type Watch<'a> = &'a mut dyn FnMut(&str) -> ControlFlow<()>;

/// Runs `library`, a file of the archive. Returns `None` if `watch` has ended the run.
pub(super) fn examine(
    archive: &Archive,
    library: &str,
    options: &Run,
    watch: Watch<'_>,
    report: &mut Report,
) -> Result<Option<()>, Error> {
    let failed =
        |error: &dyn std::fmt::Display| Error::new(format!("cannot run the library: {error}"));
    // From here on there are files to remove.
    if watch("unpacking").is_break() {
        return Ok(None);
    }
    let folder =
        tempfile::Builder::new().prefix("fmu-check-").tempdir().map_err(|error| failed(&error))?;
    // The system names files by their real paths.
    let real = folder.path().canonicalize().map_err(|error| failed(&error))?;
    if let Err(error) = unpack(archive, library, &real.join("fmu")) {
        report.note(format!("{library} is not run: {error}"));
        return Ok(Some(()));
    }
    let journal = real.join(JOURNAL);
    let mut child = supervise(&real, library, options).map_err(|error| failed(&error))?;
    let Some(status) = wait(&mut child, &journal, watch).map_err(|error| failed(&error))? else {
        return Ok(None);
    };
    if !status.success() {
        return Err(failed(&format!("the process that supervises it ended early ({status})")));
    }
    // The folder has another name in each run, so findings do not show it.
    let told = journal::text(&journal).replace(&*real.to_string_lossy(), "/…");
    journal::report(&told, library, report);
    Ok(Some(()))
}

/// Unpacks the files that a library may need: the library, the other files of its folder, the resources and the model
/// description.
fn unpack(archive: &Archive, library: &str, folder: &Path) -> Result<(), String> {
    let beside = library.rsplit_once('/').map_or("", |(folder, _)| folder);
    for entry in archive.entries.iter().filter(|entry| !entry.is_folder()) {
        let is_below = |folder: &str| {
            entry.name.strip_prefix(folder).is_some_and(|rest| rest.starts_with('/'))
        };
        if entry.name != xml::PATH && !is_below("resources") && !is_below(beside) {
            continue;
        }
        if !is_safe(entry) {
            return Err(format!(
                "the entry {} has a name that is unsafe, or is not a regular file",
                entry.name
            ));
        }
        let path = folder.join(&entry.name);
        let unpack = |path: PathBuf| -> Result<(), String> {
            let parent = path.parent().unwrap_or(folder);
            fs::create_dir_all(parent).map_err(|error| error.to_string())?;
            let mut file = File::create_new(&path).map_err(|error| error.to_string())?;
            archive.unpack(entry, &mut file)
        };
        unpack(path).map_err(|error| format!("{}: {error}", entry.name))?;
    }
    Ok(())
}

/// Starts a supervisor; it runs until the worker has ended or its standard input is closed.
fn supervise(folder: &Path, library: &str, options: &Run) -> io::Result<Child> {
    let mut command = Command::new(&options.program);
    arguments(&mut command, folder, library, options.timeout);
    if !options.valgrind {
        command.arg("--no-valgrind");
    }
    command.stdin(Stdio::piped()).stdout(Stdio::null()).spawn()
}

/// Adds the arguments of a process of [`run_library`]. The process has its own group, so Ctrl-C reaches the checker
/// alone.
fn arguments(command: &mut Command, folder: &Path, library: &str, timeout: Duration) {
    let seconds = timeout.as_secs().to_string();
    command.arg(COMMAND).args([folder.as_os_str(), library.as_ref(), seconds.as_ref()]);
    process::group(command);
}

/// Waits for the supervisor and returns its exit status; `None` if `watch` has ended the run.
fn wait(
    supervisor: &mut Child,
    journal: &Path,
    watch: Watch<'_>,
) -> io::Result<Option<ExitStatus>> {
    const TOLD: Duration = Duration::from_millis(200);
    let mut told = Instant::now();
    loop {
        if let Some(status) = supervisor.try_wait()? {
            return Ok(Some(status));
        }
        if told.elapsed() > TOLD {
            told = Instant::now();
            let state = journal::state(&journal::text(journal));
            if watch(&state.stage).is_break() {
                // Waiting first closes the supervisor's standard input, which ends it.
                supervisor.wait()?;
                return Ok(None);
            }
        }
        std::thread::sleep(OFTEN);
    }
}

/// The task of a process of [`COMMAND`].
pub(crate) enum Task {
    /// Supervises all trials, with valgrind or without.
    Supervise { valgrind: bool },
    /// Makes one trial until the supervisor, whose process id is given, has ended.
    Try { trial: Trial, supervisor: u32 },
}

/// Runs a process of [`COMMAND`] for the FMU that is unpacked in `folder`.
///
/// # Errors
/// Returns an error if the journal, which holds all results, cannot be written or if a worker cannot be started.
pub(crate) fn run_library(
    folder: &Path,
    library: &str,
    timeout: Duration,
    task: &Task,
) -> Result<(), Error> {
    if let Task::Try { supervisor, .. } = task {
        process::end_with(*supervisor);
    }
    let path = folder.join(JOURNAL);
    let journal = Journal::open(&path).map_err(|error| Error::file(&path, &error))?;
    match *task {
        Task::Supervise { valgrind } => {
            supervisor::run(folder, library, timeout, valgrind, &journal)
                .map_err(|error| Error::new(format!("cannot run the library: {error}")))
        }
        Task::Try { trial, .. } => {
            if worker::run(folder, library, trial, timeout, &journal).is_some() {
                journal.made();
            }
            journal.done();
            Ok(())
        }
    }
}
