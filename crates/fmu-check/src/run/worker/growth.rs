//! Measurement of the growth of memory from one instance to the next.

use super::Subject;
use super::library::{self, Library};
use super::plan::Plan;
use crate::rules::Rule;
use crate::run::process;
use std::time::{Duration, Instant};

/// Size of a measurement: rounds before the first count, in which caches fill, then number of counts and rounds per
/// count.
struct MeasurementSize {
    before: u32,
    counts: u32,
    rounds: u32,
}

const SIZES: [MeasurementSize; 2] = [
    MeasurementSize { before: 16, counts: 5, rounds: 8 },
    MeasurementSize { before: 8, counts: 4, rounds: 2 },
];

/// Growth of the heap per round that is reported, bytes.
const LEAST: i64 = 100;
/// Growth of the address space per round that is reported, bytes; address space comes in pages.
const LEAST_ADDRESSES: i64 = 4096;

/// Makes, runs and frees instances for no longer than `room`, and reports growth of memory.
pub(super) fn watch(subject: &Subject<'_>, room: Duration) {
    subject.at("repeated instantiation");
    let begin = Instant::now();
    if round(subject).is_none() {
        return;
    }
    let one = begin.elapsed();
    let Some(size) =
        SIZES.iter().find(|size| one * (size.before + size.counts * size.rounds) <= room)
    else {
        let note = format!(
            "memory growth is not examined: one instance takes {:.1} s, too long to repeat it",
            one.as_secs_f64()
        );
        subject.journal.note(&note);
        return;
    };
    let run = |count: u32| (0..count).try_for_each(|_| round(subject));
    let mut used = Vec::new();
    let mut mapped = Vec::new();
    let mut files = Vec::new();
    let mut counted = || {
        run(size.before)?;
        for count in 0..=size.counts {
            if count > 0 {
                run(size.rounds)?;
            }
            used.extend(library::heap().and_then(|bytes| i64::try_from(bytes).ok()));
            files.extend(process::open_files().and_then(|count| i64::try_from(count).ok()));
            mapped.extend(process::addresses().and_then(|bytes| i64::try_from(bytes).ok()));
        }
        Some(())
    };
    if counted().is_none() {
        return;
    }
    if used.is_empty() && mapped.is_empty() {
        subject
            .journal
            .note("memory growth is not examined: this system does not report memory use");
        return;
    }
    // A leak grows between all counts; growth between some counts only is due to the allocator.
    let least = |bytes: &[i64]| {
        bytes.windows(2).map(|pair| pair[1] - pair[0]).min().unwrap_or(0) / i64::from(size.rounds)
    };
    let (heap, addresses, files) = (least(&used), least(&mapped), least(&files));
    let what = if heap >= LEAST {
        format!("the heap grows by {heap} bytes")
    } else if addresses >= LEAST_ADDRESSES {
        format!("the address space grows by {addresses} bytes")
    } else if files > 0 {
        format!("the number of open files grows by {files}")
    } else {
        return;
    };
    let message = format!("{what} with every instance that is made, run for a step and freed");
    subject.journal.finding(Rule::MemoryGrowth, &message);
}

/// Runs one instance from loading the library to unloading it; `None` if a call fails.
fn round(subject: &Subject<'_>) -> Option<()> {
    let library = Library::load(&subject.path).ok()?;
    let Plan { tolerance, start, stop, step, .. } = subject.plan;
    let location = subject.location();
    let instance = library.instantiate(&subject.arguments(&location))?;
    instance.setup(tolerance, start, stop).ok()?;
    instance.enter_initialization().ok()?;
    instance.exit_initialization().ok()?;
    instance.step(start, step).ok()?;
    instance.terminate().ok()
}
