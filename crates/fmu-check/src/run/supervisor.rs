//! The supervisor: the process between the checker and the workers that run the library. It ends a worker at the time
//! limit, together with all processes that the library started, also if the checker has ended.

use super::journal::{self, Journal};
use super::trial::Trial;
use super::{OFTEN, process, valgrind};
use crate::rules::Rule;
use clap::ValueEnum as _;
use std::fs::{self, File};
use std::io;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// File of what the worker prints.
const OUTPUT: &str = "output";
/// Number of trials that may reach a limit before the others are left out.
const MOST_LIMITS: u32 = 2;

enum WorkerEnd {
    Status(ExitStatus),
    Late,
    Large,
    /// The checker has ended, or the worker's state cannot be read.
    Unwanted,
}

/// Makes all trials, each in a worker, and writes a finding about a worker's end, if there is one, into the journal. If
/// the first trial fails, no other is made.
pub(super) fn run(
    folder: &Path,
    library: &str,
    timeout: Duration,
    with_valgrind: bool,
    journal: &Journal,
) -> io::Result<()> {
    process::adopt_orphans();
    // The checker holds the other end of standard input; the system closes it however the checker ends.
    let unwanted = Arc::new(AtomicBool::new(false));
    let told = Arc::clone(&unwanted);
    std::thread::spawn(move || {
        let _ = io::copy(&mut io::stdin().lock(), &mut io::sink());
        told.store(true, Ordering::Relaxed);
    });
    // Other trials make several runs; a library that takes long for two takes as long for each.
    let mut limit = timeout;
    let mut limits = 0;
    let mut trials = Trial::value_variants().iter();
    for &trial in trials.by_ref() {
        let is_valgrind = trial == Trial::Valgrind;
        if is_valgrind && !(with_valgrind && valgrind::is_there(journal)) {
            continue;
        }
        journal.trial(trial);
        // A folder of its own: nobody knows what an earlier trial has made of another.
        let work = folder.join(format!("work-{}", name(trial)));
        let begin = Instant::now();
        let mut worker = start(folder, &work, library, trial, limit)?;
        let end = wait(&mut worker, limit, &unwanted);
        if !matches!(end, WorkerEnd::Status(_)) {
            process::end(&mut worker);
        }
        let left = process::end_rest(worker.id());
        let output = fs::read(folder.join(OUTPUT)).unwrap_or_default();
        let output = String::from_utf8_lossy(&output);
        let state = journal::state(&journal.text());
        if is_valgrind {
            let is_late = matches!(end, WorkerEnd::Late);
            valgrind::report(folder, library, state.made, is_late, journal);
        } else if let Some((rule, message)) = judge(&end, &state, left, output.trim(), limit) {
            // Values beside the start values may ask for more than a run takes.
            if trial.sets_values() && matches!(rule, Rule::TimeLimit | Rule::MemoryLimit) {
                journal.note(&format!("the library is not tried to the end: {message}"));
            } else {
                journal.finding(rule, &message);
            }
        }
        report_files(&work, journal);
        match end {
            WorkerEnd::Unwanted => return Ok(()),
            WorkerEnd::Late | WorkerEnd::Large => limits += 1,
            WorkerEnd::Status(_) => {}
        }
        if trial == Trial::Plain {
            if !state.made {
                return Ok(());
            }
            limit = timeout + 10 * begin.elapsed();
        }
        if limits == MOST_LIMITS {
            break;
        }
    }
    let rest: Vec<String> = trials.map(|trial| name(*trial)).collect();
    if !rest.is_empty() {
        journal.note(&format!(
            "after {MOST_LIMITS} trials that reached a limit, others are left out: {}",
            rest.join(", ")
        ));
    }
    Ok(())
}

/// The name of a trial, as a worker is told it.
fn name(trial: Trial) -> String {
    let value = trial.to_possible_value().expect("every trial has a name");
    value.get_name().to_owned()
}

/// Reports the files that a worker has left in its working folder.
fn report_files(work: &Path, journal: &Journal) {
    // The library may have removed the folder.
    let Ok(entries) = fs::read_dir(work) else { return };
    let mut names: Vec<String> =
        entries.flatten().map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    if let [first, rest @ ..] = &names[..] {
        let more =
            if rest.is_empty() { String::new() } else { format!(" and {} more", rest.len()) };
        let message = format!("writes into the working folder of the host: {first}{more}");
        journal.finding(Rule::WritesFiles, &message);
    }
}

fn start(
    folder: &Path,
    work: &Path,
    library: &str,
    trial: Trial,
    timeout: Duration,
) -> io::Result<Child> {
    let output = File::create(folder.join(OUTPUT))?;
    fs::create_dir(work)?;
    let program = std::env::current_exe()?;
    let mut command = if trial == Trial::Valgrind {
        valgrind::command(folder, &program)
    } else {
        Command::new(program)
    };
    super::arguments(&mut command, folder, library, timeout);
    command
        // Memory in a thread's cache counts as in use; without the cache the heap is counted exactly.
        .env("GLIBC_TUNABLES", "glibc.malloc.tcache_count=0")
        .args([format!("--trial={}", name(trial)), format!("--supervisor={}", std::process::id())])
        .current_dir(work)
        .stdin(Stdio::null())
        .stdout(output.try_clone()?)
        .stderr(output)
        .spawn()
}

fn wait(worker: &mut Child, timeout: Duration, unwanted: &AtomicBool) -> WorkerEnd {
    let begin = Instant::now();
    loop {
        match worker.try_wait() {
            Ok(Some(status)) => return WorkerEnd::Status(status),
            Ok(None) => {}
            Err(_) => return WorkerEnd::Unwanted,
        }
        if unwanted.load(Ordering::Relaxed) {
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
            let seconds = timeout.as_secs();
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
            Some(signal) => (state.rule, format!("crashes during {stage} ({signal}){}", said())),
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
