//! What systems differ in: limits of a process, and its end with all that it began.
//!
//! On Linux all means all. Elsewhere it is what stays in the process's group, and on Windows the process alone.

use std::process::{Child, ExitStatus};
use std::time::Duration;
#[cfg(target_os = "linux")]
use std::time::Instant;

/// Bytes of memory that the process may use, as far as the watcher sees it.
pub(super) const MOST_MEMORY: u64 = 2 << 30;
/// Bytes of address space that it may reserve.
#[cfg(unix)]
const MOST_ADDRESSES: u64 = 16 << 30;
/// Bytes that it may write into one file.
#[cfg(unix)]
const MOST_WRITTEN: u64 = 256 << 20;

/// Limits this process, and all that it begins.
#[cfg(unix)]
pub(super) fn limit(timeout: Duration) {
    use nix::sys::resource::{Resource, setrlimit};
    // Of all its threads together.
    let threads = std::thread::available_parallelism().map_or(1, |count| count.get() as u64);
    let seconds = timeout.as_secs().saturating_add(5).saturating_mul(threads);
    for (resource, most) in [
        (Resource::RLIMIT_AS, MOST_ADDRESSES),
        (Resource::RLIMIT_FSIZE, MOST_WRITTEN),
        (Resource::RLIMIT_CORE, 0),
        // Should nobody watch any more.
        (Resource::RLIMIT_CPU, seconds),
    ] {
        // A limit that is already lower cannot be raised, and need not be.
        let _ = setrlimit(resource, most, most);
    }
}

/// Limits are left to the watcher.
#[cfg(not(unix))]
pub(super) fn limit(_timeout: Duration) {}

/// Puts what is to be run into a group of its own.
#[cfg(unix)]
pub(super) fn group(command: &mut std::process::Command) {
    use std::os::unix::process::CommandExt;
    command.process_group(0);
}

#[cfg(not(unix))]
pub(super) fn group(_command: &mut std::process::Command) {}

/// Lets this process end as soon as the one that began it does.
#[cfg(target_os = "linux")]
pub(super) fn end_with(parent: u32) {
    use nix::sys::{prctl, signal::Signal};
    let _ = prctl::set_pdeathsig(Signal::SIGKILL);
    // It may have ended before that.
    if std::os::unix::process::parent_id() != parent {
        std::process::exit(1);
    }
}

/// Elsewhere the limit of its processor time ends it.
#[cfg(not(target_os = "linux"))]
pub(super) fn end_with(_parent: u32) {}

/// From now on what this process's children leave behind becomes its own child.
#[cfg(target_os = "linux")]
pub(super) fn adopt_orphans() {
    let _ = nix::sys::prctl::set_child_subreaper(true);
}

#[cfg(not(target_os = "linux"))]
pub(super) fn adopt_orphans() {}

/// Ends a process and all in its group.
pub(super) fn end(child: &mut Child) {
    end_group(child.id());
    // It may have ended by itself.
    let _ = child.kill();
    let _ = child.wait();
}

/// Ends a group; was there anything?
#[cfg(unix)]
fn end_group(id: u32) -> bool {
    use nix::sys::signal::{Signal, killpg};
    let Ok(group) = i32::try_from(id) else { return false };
    killpg(nix::unistd::Pid::from_raw(group), Signal::SIGKILL).is_ok()
}

#[cfg(not(unix))]
fn end_group(_id: u32) -> bool {
    false
}

/// Ends all that this process's only child, which has ended, left behind; did anything run on?
#[cfg(target_os = "linux")]
pub(super) fn end_rest(_child: u32) -> bool {
    use nix::sys::signal::{Signal, kill};
    /// For what ends by itself, as it is used no more.
    const GRACE: Duration = Duration::from_millis(200);
    /// What does not obey by then never will.
    const LONGEST: Duration = Duration::from_secs(5);
    let begin = Instant::now();
    let mut found = false;
    // What a child leaves behind becomes one itself.
    while any_child() && begin.elapsed() < LONGEST {
        if begin.elapsed() > GRACE {
            found = true;
            for child in children() {
                let _ = kill(child, Signal::SIGKILL);
            }
        }
        std::thread::sleep(super::OFTEN);
    }
    found
}

#[cfg(not(target_os = "linux"))]
pub(super) fn end_rest(child: u32) -> bool {
    end_group(child)
}

/// Buries the children that have ended; is there another?
#[cfg(target_os = "linux")]
fn any_child() -> bool {
    use nix::sys::wait::{WaitPidFlag, WaitStatus, waitpid};
    loop {
        match waitpid(None, Some(WaitPidFlag::WNOHANG)) {
            Ok(WaitStatus::StillAlive) => return true,
            Ok(_) => {}
            Err(_) => return false,
        }
    }
}

#[cfg(target_os = "linux")]
fn children() -> Vec<nix::unistd::Pid> {
    let own = std::process::id().to_string();
    let processes = std::fs::read_dir("/proc").into_iter().flatten().flatten();
    processes
        .filter_map(|entry| {
            let id = entry.file_name().to_str()?.parse().ok()?;
            let stat = std::fs::read_to_string(entry.path().join("stat")).ok()?;
            // The name, in brackets, may have anything in it; behind it are the state and the parent.
            let parent = stat.rsplit_once(')')?.1.split_ascii_whitespace().nth(1)?;
            (parent == own).then(|| nix::unistd::Pid::from_raw(id))
        })
        .collect()
}

/// The signal that ended a process, by its name.
#[cfg(unix)]
pub(super) fn signal(status: ExitStatus) -> Option<String> {
    use std::os::unix::process::ExitStatusExt;
    let number = status.signal()?;
    Some(
        nix::sys::signal::Signal::try_from(number)
            .map_or(number.to_string(), |name| name.to_string()),
    )
}

/// An exception that ended a process, by its code.
#[cfg(not(unix))]
pub(super) fn signal(status: ExitStatus) -> Option<String> {
    // Windows ends a process that has failed with codes of this kind.
    let code = status.code()?;
    (code < 0).then(|| format!("{:#x}", code.cast_unsigned()))
}

/// Bytes of memory that a process uses, where the system tells.
pub(super) fn memory(id: u32) -> Option<u64> {
    pages(&format!("/proc/{id}/statm"), 1)
}

/// Bytes of address space that this process has, where the system tells.
pub(super) fn addresses() -> Option<u64> {
    pages("/proc/self/statm", 0)
}

fn pages(path: &str, column: usize) -> Option<u64> {
    const PAGE: u64 = 4096;
    let text = std::fs::read_to_string(path).ok()?;
    text.split_ascii_whitespace().nth(column)?.parse::<u64>().ok().map(|pages| pages * PAGE)
}
