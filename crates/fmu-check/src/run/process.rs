//! Functions that depend on the operating system: limits of a process, and the end of a process with all that it
//! started.
//!
//! On Linux, all processes that it started are ended; on other Unix systems those in its process group, on Windows the
//! process alone.

use std::process::{Child, ExitStatus};
use std::time::Duration;
#[cfg(target_os = "linux")]
use std::time::Instant;

/// Limit of the memory that the process may use, bytes, checked by the supervisor.
pub(super) const MOST_MEMORY: u64 = 2 << 30;
/// Limit of the address space that the process may reserve, bytes.
#[cfg(unix)]
const MOST_ADDRESSES: u64 = 16 << 30;
/// Limit of the size of each file that the process may write, bytes.
#[cfg(unix)]
const MOST_WRITTEN: u64 = 256 << 20;

/// Limits this process and all processes that it starts.
#[cfg(unix)]
pub(super) fn limit(timeout: Duration) {
    use nix::sys::resource::{Resource, setrlimit};
    // The limit of processor time holds for all threads together.
    let threads = std::thread::available_parallelism().map_or(1, |count| count.get() as u64);
    let seconds = timeout.as_secs().saturating_add(5).saturating_mul(threads);
    for (resource, most) in [
        (Resource::RLIMIT_AS, MOST_ADDRESSES),
        (Resource::RLIMIT_FSIZE, MOST_WRITTEN),
        (Resource::RLIMIT_CORE, 0),
        // This limit ends the process if the supervisor has ended.
        (Resource::RLIMIT_CPU, seconds),
    ] {
        // A limit that is already lower cannot be raised and need not be.
        let _ = setrlimit(resource, most, most);
    }
}

/// A no-op: on this system the supervisor alone enforces limits.
#[cfg(not(unix))]
pub(super) fn limit(_timeout: Duration) {}

/// Puts the process to be started into its own process group.
#[cfg(unix)]
pub(super) fn group(command: &mut std::process::Command) {
    use std::os::unix::process::CommandExt;
    command.process_group(0);
}

#[cfg(not(unix))]
pub(super) fn group(_command: &mut std::process::Command) {}

/// Makes this process end when its parent ends.
#[cfg(target_os = "linux")]
pub(super) fn end_with(parent: u32) {
    use nix::sys::{prctl, signal::Signal};
    let _ = prctl::set_pdeathsig(Signal::SIGKILL);
    // The parent may have ended before the call.
    if std::os::unix::process::parent_id() != parent {
        std::process::exit(1);
    }
}

/// A no-op: on this system the limit of processor time ends the process.
#[cfg(not(target_os = "linux"))]
pub(super) fn end_with(_parent: u32) {}

/// Makes this process the parent of processes whose own parent, a descendant of it, has ended.
#[cfg(target_os = "linux")]
pub(super) fn adopt_orphans() {
    let _ = nix::sys::prctl::set_child_subreaper(true);
}

#[cfg(not(target_os = "linux"))]
pub(super) fn adopt_orphans() {}

/// Ends a process and all processes in its group.
pub(super) fn end(child: &mut Child) {
    end_group(child.id());
    // The process may have ended by itself.
    let _ = child.kill();
    let _ = child.wait();
}

/// Ends a process group. Returns `true` if the group had processes.
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

/// Ends all processes that this process's only child, which has ended, left behind. Returns `true` if any outlived the
/// grace period.
#[cfg(target_os = "linux")]
pub(super) fn end_rest(_child: u32) -> bool {
    use nix::sys::signal::{Signal, kill};
    /// Time allowed for processes that end by themselves.
    const GRACE: Duration = Duration::from_millis(200);
    /// Time after which processes that cannot be ended are left alone.
    const LONGEST: Duration = Duration::from_secs(5);
    let begin = Instant::now();
    let mut found = false;
    // The children of an ended child become children of this process.
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

/// Collects the children that have ended. Returns `true` if another child is still running.
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
            // The name, in brackets, may contain any character; the state and the parent follow it.
            let parent = stat.rsplit_once(')')?.1.split_ascii_whitespace().nth(1)?;
            (parent == own).then(|| nix::unistd::Pid::from_raw(id))
        })
        .collect()
}

/// Name of the signal that ended a process.
#[cfg(unix)]
pub(super) fn signal(status: ExitStatus) -> Option<String> {
    use std::os::unix::process::ExitStatusExt;
    status.signal().map(signal_name)
}

/// Name of a signal.
pub(super) fn signal_name(number: i32) -> String {
    #[cfg(unix)]
    if let Ok(signal) = nix::sys::signal::Signal::try_from(number) {
        return signal.to_string();
    }
    number.to_string()
}

/// Code of the exception that ended a process.
#[cfg(not(unix))]
pub(super) fn signal(status: ExitStatus) -> Option<String> {
    // Windows ends a failed process with a negative code.
    let code = status.code()?;
    (code < 0).then(|| format!("{:#x}", code.cast_unsigned()))
}

/// Memory that a process uses, bytes; `None` if the system does not report it.
pub(super) fn memory(id: u32) -> Option<u64> {
    pages(&format!("/proc/{id}/statm"), 1)
}

/// Address space of this process, bytes; `None` if the system does not report it.
pub(super) fn addresses() -> Option<u64> {
    pages("/proc/self/statm", 0)
}

/// Number of files that this process has open; `None` if the system does not report it.
pub(super) fn open_files() -> Option<u64> {
    std::fs::read_dir("/proc/self/fd").ok().map(|entries| entries.count() as u64)
}

fn pages(path: &str, column: usize) -> Option<u64> {
    const PAGE: u64 = 4096;
    let text = std::fs::read_to_string(path).ok()?;
    text.split_ascii_whitespace().nth(column)?.parse::<u64>().ok().map(|pages| pages * PAGE)
}
