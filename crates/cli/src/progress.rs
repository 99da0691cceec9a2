//! The progress of a long command: a bar on a terminal, lines at intervals elsewhere.
//!
//! A thread of its own updates both, so that work that takes long between two calls of [`Progress::set`] is shown too.

use indicatif::{HumanDuration, ProgressBar, ProgressState, ProgressStyle};
use std::fmt;
use std::io::{IsTerminal, Write, stderr};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{JoinHandle, spawn};
use std::time::{Duration, Instant};

/// Time of the first line if standard error is no terminal.
const FIRST: Duration = Duration::from_secs(2);
/// Time between two lines.
const EVERY: Duration = Duration::from_secs(10);
/// Total for work whose done part is known.
const PARTS: u64 = 1000;
/// Interval between two updates of a bar.
const TICK: Duration = Duration::from_millis(200);

/// The progress of a piece of work on standard error: a bar on a terminal, elsewhere a line after two seconds and then
/// every ten. It ends with [`Progress::finish`] or when dropped.
pub struct Progress {
    shown: Shown,
}

enum Shown {
    Bar(ProgressBar),
    Lines(Arc<Lines>, Mutex<Option<JoinHandle<()>>>),
}

impl Progress {
    /// Shows the beginning of the work `what`, of `total` pieces, or of an unknown number if `total` is 0.
    ///
    /// # Panics
    /// Panics if the system cannot start another thread.
    #[must_use]
    pub fn new(what: &str, total: u64) -> Self {
        Self::shown(what, total, true)
    }

    /// Shows the beginning of the work `what`, whose done part is known ([`Progress::set_part`]).
    ///
    /// # Panics
    /// Panics if the system cannot start another thread.
    #[must_use]
    pub fn in_parts(what: &str) -> Self {
        Self::new(what, PARTS)
    }

    /// Shows the beginning of the work `what`, whose done part is known but whose parts take unequal times, so that no
    /// remaining time is shown.
    ///
    /// # Panics
    /// Panics if the system cannot start another thread.
    #[must_use]
    pub fn in_uneven_parts(what: &str) -> Self {
        Self::shown(what, PARTS, false)
    }

    fn shown(what: &str, total: u64, is_even: bool) -> Self {
        if stderr().is_terminal() {
            Self { shown: Shown::Bar(bar(what, total, is_even)) }
        } else {
            Self::lines(what, total, is_even, [FIRST, EVERY], Box::new(stderr()))
        }
    }

    fn lines(
        what: &str,
        total: u64,
        is_even: bool,
        times: [Duration; 2],
        mut out: Box<dyn Write + Send>,
    ) -> Self {
        let lines = Arc::new(Lines {
            total,
            is_even,
            done: AtomicU64::new(0),
            begun: Instant::now(),
            state: Mutex::new(State { what: what.to_owned(), is_over: false }),
            over: Condvar::new(),
        });
        let told = Arc::clone(&lines);
        let thread = spawn(move || told.tell(times, &mut *out));
        Self { shown: Shown::Lines(lines, Mutex::new(Some(thread))) }
    }

    /// Sets the number of pieces done. Any thread may call it.
    pub fn set(&self, done: u64) {
        match &self.shown {
            Shown::Bar(bar) => bar.set_position(done),
            Shown::Lines(lines, _) => lines.done.store(done, Ordering::Relaxed),
        }
    }

    /// Sets the part of the work done, from 0 to 1.
    #[allow(clippy::cast_possible_truncation, clippy::cast_precision_loss, clippy::cast_sign_loss)]
    pub fn set_part(&self, part: f64) {
        let total = match &self.shown {
            Shown::Bar(bar) => bar.length().unwrap_or(0),
            Shown::Lines(lines, _) => lines.total,
        };
        self.set((part * total as f64) as u64);
    }

    /// Changes the name of the current work.
    pub fn say(&self, what: &str) {
        match &self.shown {
            Shown::Bar(bar) => bar.set_message(what.to_owned()),
            Shown::Lines(lines, _) => what.clone_into(&mut lines.state().what),
        }
    }

    /// Ends the progress: removes the bar, or stops the lines.
    pub fn finish(&self) {
        match &self.shown {
            Shown::Bar(bar) => bar.finish_and_clear(),
            Shown::Lines(lines, thread) => {
                lines.state().is_over = true;
                lines.over.notify_all();
                let thread = thread.lock().unwrap_or_else(PoisonError::into_inner).take();
                // An error of the thread does not end the work.
                let _ = thread.map(JoinHandle::join);
            }
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.finish();
    }
}

fn bar(what: &str, total: u64, is_even: bool) -> ProgressBar {
    let (bar, template) = match total {
        total if total > 0 && !is_even => {
            (ProgressBar::new(total), "{bar:40} {percent:>3} %  {elapsed}  {msg}")
        }
        0 => (ProgressBar::new_spinner(), "{spinner} {msg}  {elapsed}"),
        total => (ProgressBar::new(total), "{bar:40} {percent:>3} %  {left}  {msg}"),
    };
    let style = ProgressStyle::with_template(template).expect("the template is fixed");
    // Before anything is done the remaining time is unknown.
    let style = style.with_key("left", |state: &ProgressState, out: &mut dyn fmt::Write| {
        if state.pos() > 0 {
            let _ = write!(out, "{:#} left", HumanDuration(state.eta()));
        }
    });
    let bar = bar.with_style(style).with_message(what.to_owned());
    bar.enable_steady_tick(TICK);
    bar
}

/// The state that the thread that writes lines shares with the work.
struct Lines {
    total: u64,
    /// `true` if the time so far predicts the remaining time.
    is_even: bool,
    done: AtomicU64,
    begun: Instant,
    state: Mutex<State>,
    over: Condvar,
}

struct State {
    what: String,
    is_over: bool,
}

impl Lines {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Writes lines until the work is over.
    fn tell(&self, [first, every]: [Duration; 2], out: &mut dyn Write) {
        let mut wait = first;
        loop {
            let waited = self.over.wait_timeout_while(self.state(), wait, |state| !state.is_over);
            let (state, _) = waited.unwrap_or_else(PoisonError::into_inner);
            if state.is_over {
                return;
            }
            let what = state.what.clone();
            drop(state);
            let passed = self.begun.elapsed().as_secs_f64();
            let done = [self.done.load(Ordering::Relaxed), self.total];
            let line = line(&what, done, passed, self.is_even) + "\n";
            // One write for each line, so that no other output divides it. A closed standard error is ignored; the
            // result of the work goes elsewhere.
            let _ = out.write_all(line.as_bytes());
            wait = every;
        }
    }
}

/// The progress after `passed` seconds, in words. The remaining time is estimated from the time so far if the pieces
/// take similar times.
#[allow(clippy::cast_precision_loss)]
fn line(what: &str, [done, total]: [u64; 2], passed: f64, is_even: bool) -> String {
    if done == 0 || total == 0 {
        return format!("{what}: {} so far", duration(passed));
    }
    let part = (done as f64 / total as f64).min(1.0);
    if !is_even {
        return format!("{what}: {:.0} %, {} so far", (100.0 * part).floor(), duration(passed));
    }
    let left = duration(passed * (1.0 - part) / part);
    format!("{what}: {:.0} %, about {left} left", (100.0 * part).floor())
}

/// Formats a time in a unit that suits its size.
fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 100.0 => format!("{s:.0} s"),
        s if s < 6000.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.0} h", s / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io;
    use std::sync::mpsc::{Sender, channel};

    struct Wire(Sender<String>);

    impl Write for Wire {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let text = String::from_utf8_lossy(bytes).into_owned();
            self.0.send(text).map_err(|_| io::ErrorKind::BrokenPipe.into()).map(|()| bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn work_that_tells_nothing_is_told_all_the_same_and_short_work_is_not() {
        let (sender, lines) = channel();
        let times = [Duration::from_millis(20), Duration::from_millis(40)];
        let begun = Instant::now();
        let long = Progress::lines("a map", 4, true, times, Box::new(Wire(sender)));
        // Each line is written in one piece, with its end.
        let mut text = lines.recv().unwrap();
        assert!(text.ends_with('\n'), "{text}");
        assert!(begun.elapsed() >= times[0]);
        std::thread::scope(|scope| scope.spawn(|| long.set_part(0.5)).join().unwrap());
        while text.matches('\n').count() < 2 {
            text += &lines.recv().unwrap();
        }
        assert!(begun.elapsed() >= times[0] + times[1]);
        long.finish();
        assert_eq!(text, "a map: 0 s so far\na map: 50 %, about 0 s left\n");
        drop(long);
        assert!(lines.try_iter().next().is_none());

        let (sender, lines) = channel();
        Progress::lines("a map", 4, true, [Duration::from_secs(60); 2], Box::new(Wire(sender)))
            .finish();
        assert!(lines.recv().is_err());
    }

    #[test]
    fn what_is_left_follows_from_what_has_passed() {
        assert_eq!(line("basin", [37, 100], 23.5, true), "basin: 37 %, about 40 s left");
        assert_eq!(line("basin", [1, 100], 23.5, true), "basin: 1 %, about 39 min left");
        assert_eq!(line("basin", [1, 1000], 23.5, true), "basin: 0 %, about 7 h left");
        assert_eq!(line("basin", [0, 100], 23.5, true), "basin: 24 s so far");
        assert_eq!(line("check", [3, 0], 23.5, true), "check: 24 s so far");
        // The remaining time is not shown for pieces of unequal duration.
        assert_eq!(line("study", [37, 100], 23.5, false), "study: 37 %, 24 s so far");
    }
}
