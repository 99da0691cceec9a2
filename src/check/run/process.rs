//! What systems differ in: limits of a process, and its end with all that it began.

use std::process::{Child, ExitStatus};
use std::time::Duration;

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
    let seconds = timeout.as_secs() + 5;
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

/// Ends a process and all in its group.
pub(super) fn end(child: &mut Child) {
    #[cfg(unix)]
    end_group(child.id());
    // It may have ended by itself.
    let _ = child.kill();
    let _ = child.wait();
}

/// Ends what a process that has ended left in its group; was there anything?
#[cfg(unix)]
pub(super) fn end_group(id: u32) -> bool {
    use nix::sys::signal::{Signal, killpg};
    let Ok(group) = i32::try_from(id) else { return false };
    killpg(nix::unistd::Pid::from_raw(group), Signal::SIGKILL).is_ok()
}

#[cfg(not(unix))]
pub(super) fn end_group(_id: u32) -> bool {
    false
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
