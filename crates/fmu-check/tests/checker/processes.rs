//! Nothing that a run begins outlives it, however it ends.

use super::fmu::{PROGRAM, library, with_library};
use super::program::folder;
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Processes of runs whose files lie below a folder: that is a word of their command line, which children keep.
fn processes(folder: &Path) -> Vec<(i32, String)> {
    let folder = folder.to_str().unwrap();
    let read = |entry: fs::DirEntry| {
        let id = entry.file_name().to_str()?.parse().ok()?;
        let line = fs::read(entry.path().join("cmdline")).ok()?;
        Some((id, String::from_utf8_lossy(&line).replace('\0', " ")))
    };
    let all = fs::read_dir("/proc").unwrap().filter_map(|entry| read(entry.ok()?));
    all.filter(|(_, line)| line.contains(folder)).collect()
}

fn wait_until(what: &str, mut is_so: impl FnMut() -> bool) {
    let begin = Instant::now();
    while !is_so() {
        assert!(begin.elapsed() < Duration::from_secs(30), "{what}");
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// A check of a library that has left a daemon behind and hangs; with the folder of its files.
fn hanging(arguments: &[&str]) -> (TempDir, Child) {
    let folder = folder();
    let fmu = with_library(library(&["-DFAULT_daemon", "-DFAULT_hang"])).pack();
    fs::write(folder.path().join("a.fmu"), fmu).unwrap();
    let mut check = Command::new(PROGRAM);
    check.arg("a.fmu").args(arguments).current_dir(folder.path());
    let child = check
        .env("TMPDIR", folder.path())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    // Each instance leaves one, and the first that is to be refused is refused before.
    wait_until("supervisor, worker and daemon run", || processes(folder.path()).len() >= 3);
    (folder, child)
}

fn assert_none_is_left(folder: &Path) {
    wait_until("a process is left", || processes(folder).is_empty());
}

#[test]
fn a_run_ends_with_the_program_that_is_killed() {
    let (folder, mut check) = hanging(&[]);
    check.kill().unwrap();
    check.wait().unwrap();
    assert_none_is_left(folder.path());
}

#[test]
fn a_library_ends_with_its_supervisor_that_is_killed() {
    let (folder, mut check) = hanging(&[]);
    let supervisors: Vec<i32> = processes(folder.path())
        .into_iter()
        .filter(|(_, line)| !line.contains("--supervisor"))
        .map(|(id, _)| id)
        .collect();
    assert_eq!(supervisors.len(), 1);
    kill(Pid::from_raw(supervisors[0]), Signal::SIGKILL).unwrap();
    assert_eq!(check.wait().unwrap().code(), Some(2));
    // No process ends one of another session; here the test does.
    let worker = |line: &str| line.contains("--supervisor");
    wait_until("the worker is left", || {
        processes(folder.path()).iter().filter(|(_, line)| worker(line)).count() <= 1
    });
    for (id, _) in processes(folder.path()) {
        kill(Pid::from_raw(id), Signal::SIGKILL).unwrap();
    }
}

#[test]
fn ctrl_c_and_the_time_limit_end_all_and_leave_no_files() {
    for (arguments, interrupt, code) in [(&[][..], true, 130), (&["--timeout", "1"], false, 3)] {
        let (folder, mut check) = hanging(arguments);
        if interrupt {
            kill(Pid::from_raw(check.id().cast_signed()), Signal::SIGINT).unwrap();
        }
        assert_eq!(check.wait().unwrap().code(), Some(code));
        assert_eq!(processes(folder.path()), []);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
