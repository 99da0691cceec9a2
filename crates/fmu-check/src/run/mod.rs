//! Runs the library for this host in a process of its own, which may crash, hang and end as it likes.
//!
//! The FMU's files are unpacked into a private folder that goes with the run. A supervisor begins the process, the
//! worker, and ends it with its time or memory, or when nobody waits for it any more; at its end so does all that
//! it began. The worker has limits of memory, time and file size, and its output goes into a file. That protects
//! from accidents; it is no sandbox: what a library does with files and the network of its user, it does.

mod journal;
mod process;
mod supervisor;
mod worker;

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

/// The program's word for [`run_library`].
pub const COMMAND: &str = "run-library";

const JOURNAL: &str = "journal";

/// How often a process is asked whether it is done.
const OFTEN: Duration = Duration::from_millis(5);

/// Told of the stage that a run has reached; says whether to go on.
pub type Watch<'a> = &'a mut dyn FnMut(&str) -> ControlFlow<()>;

/// Runs `library`, a file of the archive; none where `watch` has ended it.
pub(super) fn examine(
    archive: &Archive,
    library: &str,
    options: &Run,
    watch: Watch<'_>,
    report: &mut Report,
) -> Result<Option<()>, Error> {
    let failed =
        |error: &dyn std::fmt::Display| Error::new(format!("cannot run the library: {error}"));
    // From here on there is something to clear away.
    if watch("unpacking").is_break() {
        return Ok(None);
    }
    let folder =
        tempfile::Builder::new().prefix("fmu-check-").tempdir().map_err(|error| failed(&error))?;
    if let Err(error) = unpack(archive, library, &folder.path().join("fmu")) {
        report.note(format!("{library} is not run: {error}"));
        return Ok(Some(()));
    }
    let journal = folder.path().join(JOURNAL);
    let mut child = supervise(folder.path(), library, options).map_err(|error| failed(&error))?;
    let Some(status) = wait(&mut child, &journal, watch).map_err(|error| failed(&error))? else {
        return Ok(None);
    };
    if !status.success() {
        return Err(failed(&format!("what supervises it has ended early ({status})")));
    }
    // The folder has another name in every run.
    let told = journal::text(&journal).replace(&*folder.path().to_string_lossy(), "/…");
    journal::report(&told, library, report);
    Ok(Some(()))
}

/// What a library may need, and nothing else: itself with what lies beside it, and the resources.
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
            return Err(format!("{} would not stay in its folder", entry.name));
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

/// Begins a supervisor; it goes on for as long as its standard input is open.
fn supervise(folder: &Path, library: &str, options: &Run) -> io::Result<Child> {
    command(&options.program, folder, library, options.timeout)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .spawn()
}

/// What begins one of the processes of [`run_library`]. It has a group of its own: Ctrl-C is for the one that asked.
fn command(program: &Path, folder: &Path, library: &str, timeout: Duration) -> Command {
    let mut command = Command::new(program);
    let seconds = timeout.as_secs().to_string();
    command.arg(COMMAND).args([folder.as_os_str(), library.as_ref(), seconds.as_ref()]);
    process::group(&mut command);
    command
}

/// How it ended; none where `watch` has ended it.
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
                // This closes its standard input first.
                supervisor.wait()?;
                return Ok(None);
            }
        }
        std::thread::sleep(OFTEN);
    }
}

/// What the processes do that [`COMMAND`] begins: the supervisor of a run of a library of the FMU that is unpacked in
/// `folder`, or its worker, which is told the `supervisor`'s process.
///
/// # Errors
/// The journal, through which they tell all else, cannot be written; the worker cannot be begun.
pub fn run_library(
    folder: &Path,
    library: &str,
    timeout: Duration,
    supervisor: Option<u32>,
) -> Result<(), Error> {
    if let Some(supervisor) = supervisor {
        process::end_with(supervisor);
    }
    let path = folder.join(JOURNAL);
    let journal = Journal::open(&path).map_err(|error| Error::file(&path, &error))?;
    if supervisor.is_none() {
        return supervisor::run(folder, library, timeout, &journal)
            .map_err(|error| Error::new(format!("cannot run the library: {error}")));
    }
    worker::run(folder, library, timeout, &journal);
    journal.at("the end of the process");
    journal.done();
    Ok(())
}
