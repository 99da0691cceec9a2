//! The supervisor: the process between the checker and the worker that runs the library. It ends the worker at the time
//! limit, together with all processes that the library started, also if the checker has ended.

use super::journal::{self, Journal};
use super::{JOURNAL, OFTEN, process};
use crate::rules::Rule;
use std::fs::{self, File};
use std::io;
use std::path::Path;
use std::process::{Child, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

const OUTPUT: &str = "output";

enum WorkerEnd {
    Status(ExitStatus),
    Late,
    Large,
    /// The checker has ended, or the worker's state cannot be read.
    Unwanted,
}

/// Runs a worker to its end and writes a finding about that end, if there is one, into the journal.
pub(super) fn run(
    folder: &Path,
    library: &str,
    timeout: Duration,
    journal: &Journal,
) -> io::Result<()> {
    process::adopt_orphans();
    let mut worker = start(folder, library, timeout)?;
    let end = wait(&mut worker, timeout);
    if !matches!(end, WorkerEnd::Status(_)) {
        process::end(&mut worker);
    }
    let left = process::end_rest(worker.id());
    let output = fs::read(folder.join(OUTPUT)).unwrap_or_default();
    let output = String::from_utf8_lossy(&output);
    let state = journal::state(&journal::text(&folder.join(JOURNAL)));
    if let Some((rule, message)) = judge(&end, &state, left, output.trim(), timeout) {
        journal.finding(rule, &message);
    }
    Ok(())
}

fn start(folder: &Path, library: &str, timeout: Duration) -> io::Result<Child> {
    let output = File::create(folder.join(OUTPUT))?;
    let work = folder.join("work");
    fs::create_dir(&work)?;
    super::command(&std::env::current_exe()?, folder, library, timeout)
        // Memory in a thread's cache counts as in use; without the cache the heap is counted exactly.
        .env("GLIBC_TUNABLES", "glibc.malloc.tcache_count=0")
        .arg(format!("--supervisor={}", std::process::id()))
        .current_dir(work)
        .stdin(Stdio::null())
        .stdout(output.try_clone()?)
        .stderr(output)
        .spawn()
}

fn wait(worker: &mut Child, timeout: Duration) -> WorkerEnd {
    static UNWANTED: AtomicBool = AtomicBool::new(false);
    // The checker holds the other end of standard input; the system closes it however the checker ends.
    std::thread::spawn(|| {
        let _ = io::copy(&mut io::stdin().lock(), &mut io::sink());
        UNWANTED.store(true, Ordering::Relaxed);
    });
    let begin = Instant::now();
    loop {
        match worker.try_wait() {
            Ok(Some(status)) => return WorkerEnd::Status(status),
            Ok(None) => {}
            Err(_) => return WorkerEnd::Unwanted,
        }
        if UNWANTED.load(Ordering::Relaxed) {
            return WorkerEnd::Unwanted;
        }
        if begin.elapsed() > timeout {
            return WorkerEnd::Late;
        }
        if process::memory(worker.id()).is_some_and(|bytes| bytes > process::MOST_MEMORY) {
            return WorkerEnd::Large;
        }
        std::thread::sleep(OFTEN);
    }
}

/// Returns the rule that a worker's end breaks, with the message; `None` if it breaks none.
fn judge(
    end: &WorkerEnd,
    state: &journal::State,
    left: bool,
    output: &str,
    timeout: Duration,
) -> Option<(Rule, String)> {
    let stage = &state.stage;
    let said = || {
        output.lines().next_back().map(|last| format!("; it printed: {last}")).unwrap_or_default()
    };
    Some(match end {
        WorkerEnd::Unwanted => return None,
        WorkerEnd::Late => {
            let seconds = timeout.as_secs_f64();
            (Rule::TimeLimit, format!("does not finish within {seconds} s; stopped during {stage}"))
        }
        WorkerEnd::Large => {
            let gibibytes = process::MOST_MEMORY >> 30;
            (
                Rule::MemoryLimit,
                format!("uses more than {gibibytes} GiB of memory; stopped during {stage}"),
            )
        }
        WorkerEnd::Status(status) => match process::signal(*status) {
            Some(signal) if state.done => (
                Rule::Crash,
                format!("crashes after the run, as the process ends ({signal}){}", said()),
            ),
            Some(signal) => (Rule::Crash, format!("crashes during {stage} ({signal}){}", said())),
            None if !state.done => {
                let code = status.code().unwrap_or_default();
                (
                    Rule::Exit,
                    format!("ends the process during {stage} (exit code {code}){}", said()),
                )
            }
            None if left => (
                Rule::LeavesProcesses,
                "leaves a process running after the run has ended".to_owned(),
            ),
            None => {
                let first = output.lines().next()?;
                (Rule::Prints, format!("prints to standard output or standard error: {first}"))
            }
        },
    })
}
