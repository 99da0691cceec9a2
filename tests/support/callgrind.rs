//! Counts instructions: the program that is running starts itself once more under valgrind's callgrind.

use std::env;
use std::process::Command;

/// The variable that tells the program under callgrind what to do: a name and a number of steps.
const TASK: &str = "AMONTONS_COUNTED_RUN";

/// Task and number of steps for which this program was started; `None` if no instructions are counted.
pub fn task() -> Option<(String, u64)> {
    let task = env::var(TASK).ok()?;
    let (name, steps) = task.rsplit_once(' ')?;
    Some((name.to_owned(), steps.parse().ok()?))
}

/// Instructions a step of the task `name`: those of a run of twice as many steps less those of one, so that
/// nothing of the start is in them. The program is started with `arguments` and has to do its [`task`].
pub fn instructions_per_step(name: &str, steps: u64, arguments: &[&str]) -> f64 {
    let [once, twice] = [steps, 2 * steps].map(|steps| instructions(name, steps, arguments));
    (twice - once) as f64 / steps as f64
}

fn instructions(name: &str, steps: u64, arguments: &[&str]) -> u64 {
    let program = env::current_exe().expect("a running program has a path");
    let run = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(program)
        .args(arguments)
        .env(TASK, format!("{name} {steps}"))
        .output()
        .expect("valgrind counts instructions and is missing: apt-get install valgrind");
    let report = String::from_utf8_lossy(&run.stderr);
    assert!(run.status.success(), "{report}{}", String::from_utf8_lossy(&run.stdout));
    let collected = report.lines().find_map(|line| line.split_once("Collected : "));
    let (_, count) = collected.unwrap_or_else(|| panic!("callgrind says nothing:\n{report}"));
    count.trim().parse().expect("it counts one event")
}
