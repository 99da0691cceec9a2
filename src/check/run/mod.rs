//! Runs the library for this host in a process of its own, which may crash, hang and end as it likes.
//!
//! The FMU's files are unpacked into a private folder that goes with the run. The process has limits of
//! memory, time and file size, its output goes into a file, and at its end so does all that it began. That
//! protects from accidents; it is no sandbox: what a library does with files and the network of its user,
//! it does.

mod child;
mod growth;
mod journal;
mod library;
mod location;
mod plan;
mod process;

use super::archive::{Archive, is_safe};
use super::options::Run;
use super::report::Report;
use super::rules::Rule;
use super::xml;
use crate::Error;
use std::fs::{self, File};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// The program's word for [`run_library`].
pub const COMMAND: &str = "run-library";

const JOURNAL: &str = "journal";
const OUTPUT: &str = "output";

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
        |error: &dyn std::error::Error| Error::package(format!("cannot run the library: {error}"));
    let folder =
        tempfile::Builder::new().prefix("fmu-check-").tempdir().map_err(|error| failed(&error))?;
    if let Err(error) = unpack(archive, library, &folder.path().join("fmu")) {
        report.note(format!("{library} is not run: {error}"));
        return Ok(Some(()));
    }
    let mut child = start(folder.path(), library, options).map_err(|error| failed(&error))?;
    let end = wait(&mut child, folder.path(), options.timeout, watch);
    let left = process::end_group(child.id());
    let read = |name: &str| {
        let text = fs::read(folder.path().join(name)).unwrap_or_default();
        // The folder has another name in every run.
        String::from_utf8_lossy(&text).replace(&*folder.path().to_string_lossy(), "/…")
    };
    let told = journal::read(&read(JOURNAL), library, report);
    let output = read(OUTPUT).trim().to_owned();
    let stage = &told.stage;
    let said = if output.is_empty() {
        String::new()
    } else {
        format!("; it printed: {}", last_line(&output))
    };
    let (rule, message) = match end {
        End::Stopped => return Ok(None),
        End::Late => {
            let seconds = options.timeout.as_secs_f64();
            (Rule::TimeLimit, format!("is not done after {seconds} s, in {stage}"))
        }
        End::Large => {
            let gibibytes = process::MOST_MEMORY >> 30;
            (Rule::MemoryLimit, format!("takes more than {gibibytes} GiB of memory, in {stage}"))
        }
        End::Status(status) => match process::signal(status) {
            Some(signal) if told.done => {
                (Rule::Crash, format!("crashes at the end of the process ({signal}){said}"))
            }
            Some(signal) => (Rule::Crash, format!("crashes in {stage} ({signal}){said}")),
            None if !told.done => {
                let code = status.code().unwrap_or_default();
                (Rule::Exit, format!("ends the process in {stage} (exit code {code}){said}"))
            }
            None if left => {
                (Rule::LeavesProcesses, "leaves a process running behind its end".to_owned())
            }
            None if !output.is_empty() => {
                let first = output.lines().next().unwrap_or_default();
                (Rule::Prints, format!("prints to standard output or error: {first}"))
            }
            None => return Ok(Some(())),
        },
    };
    report.add(rule, library, message);
    Ok(Some(()))
}

fn last_line(output: &str) -> &str {
    output.lines().next_back().unwrap_or_default()
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

fn start(folder: &Path, library: &str, options: &Run) -> std::io::Result<Child> {
    let output = File::create(folder.join(OUTPUT))?;
    let work = folder.join("work");
    fs::create_dir(&work)?;
    let mut command = Command::new(&options.program);
    command
        .arg(COMMAND)
        // What a thread keeps for its next request counts as in use; without it the heap is counted exactly.
        .env("GLIBC_TUNABLES", "glibc.malloc.tcache_count=0")
        .args([
            folder.as_os_str(),
            library.as_ref(),
            options.timeout.as_secs().to_string().as_ref(),
        ])
        .current_dir(work)
        .stdin(Stdio::null())
        .stdout(output.try_clone()?)
        .stderr(output);
    process::group(&mut command);
    command.spawn()
}

enum End {
    Status(ExitStatus),
    Late,
    Large,
    Stopped,
}

fn wait(child: &mut Child, folder: &Path, timeout: Duration, watch: Watch<'_>) -> End {
    const OFTEN: Duration = Duration::from_millis(5);
    const TOLD: Duration = Duration::from_millis(200);
    let begin = Instant::now();
    let mut told = begin;
    let end = loop {
        match child.try_wait() {
            Ok(Some(status)) => return End::Status(status),
            Ok(None) => {}
            Err(_) => break End::Stopped,
        }
        if begin.elapsed() > timeout {
            break End::Late;
        }
        if process::memory(child.id()).is_some_and(|bytes| bytes > process::MOST_MEMORY) {
            break End::Large;
        }
        if told.elapsed() > TOLD {
            told = Instant::now();
            let journal = fs::read_to_string(folder.join(JOURNAL)).unwrap_or_default();
            if watch(journal::stage(&journal).unwrap_or_default()).is_break() {
                break End::Stopped;
            }
        }
        std::thread::sleep(OFTEN);
    };
    process::end(child);
    end
}

/// What the process does that [`COMMAND`] begins: runs a library of the FMU that is unpacked in `folder`.
///
/// # Errors
/// The journal, through which it tells all else, cannot be written.
pub fn run_library(folder: &Path, library: &str, timeout: Duration) -> Result<(), Error> {
    let path = folder.join(JOURNAL);
    let journal = journal::Journal::create(&path).map_err(|error| Error::file(&path, &error))?;
    child::run(folder, library, timeout, &journal);
    journal.at("the end of the process");
    journal.done();
    Ok(())
}
