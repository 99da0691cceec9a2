//! What each effect costs in a step: `cargo bench --bench effects` prints a table for a network and one for a
//! ring.
//!
//! Instructions are counted by callgrind, which wants valgrind installed: those of a run less those of one of
//! half as many steps, so that they are the same at each run of the benchmark. Times stand beside them as
//! multiples of the first row's, all from one run: it is cut into short slices, in which the rows take turns,
//! and the shortest counts, as other work on the machine makes a time only longer.
//!
//! All rows slide, except where there is nothing to rub on. A new effect is a new row: a name and the parts of
//! a scene file that it is made of.

#[path = "../tests/callgrind/mod.rs"]
mod callgrind;
#[path = "../tests/oscillator/mod.rs"]
mod oscillator;

use amontons::scene::{Scene, parse};
use amontons::simulation::Simulation;
use std::hint::black_box;
use std::time::{Duration, Instant};

/// Steps of a counted run, and of a slice of a timed one.
const COUNTED: u64 = 100_000;
const TIMED: u64 = 20_000;
const SLICES: usize = 100;

/// Parts of scenes.
const RAYLEIGH: &str = "[damping]\nalpha = 1.0\nbeta = 3e-5\n";
const DAMPER: &str =
    "[[damper]]\nname = \"d\"\nbetween = [\"m\", \"ground\"]\ndirection = 1.1\ndamping = 2.0\n";
const CONTACT: &str = "[[contact]]\nname = \"c\"\nmass = \"m\"\n";
const SMOOTH: &str = "[friction]\ncoefficient = 0.0\n";
const COULOMB: &str = "[friction]\ncoefficient = 0.3\n";
const STATIC: &str = "[friction]\ncoefficient = 0.3\nstatic = 0.5\n";

/// Two of the modules of Set 1, which have no single dampers and no step without contacts.
const RING: &str = r#"
[slider]
velocity = 0.025
angle = 0.5
[ring]
modules = 2
m1 = 0.3
m2 = 0.7
k1 = 55e3
k2 = 60e3
k3 = 22e3
k4 = 60e3
k5 = 300e3
k6 = 250e3
preload = 5e-3
[integrator]
step = 1e-6
[[initial]]
module = 1
v1 = 1e-7
"#;

/// What is added to a structure: a name, and parts of the scene file.
type Row = (&'static str, &'static [&'static str]);

const ON_A_NETWORK: &[Row] = &[
    ("nothing: a mass on two springs", &[]),
    ("Rayleigh damping", &[RAYLEIGH]),
    ("a single damper", &[DAMPER]),
    ("contact without friction", &[CONTACT, SMOOTH]),
    ("contact, Coulomb friction", &[CONTACT, COULOMB]),
    ("contact, static friction", &[CONTACT, STATIC]),
    ("all together", &[RAYLEIGH, DAMPER, CONTACT, STATIC]),
];

const ON_A_RING: &[Row] = &[
    ("contact without friction", &[SMOOTH]),
    ("Coulomb friction", &[COULOMB]),
    ("static friction", &[STATIC]),
    ("Rayleigh damping, no friction", &[RAYLEIGH, SMOOTH]),
    ("all together", &[RAYLEIGH, STATIC]),
];

/// The tables: what they are of, the scene without effects, and its rows.
const TABLES: [(&str, &str, &[Row]); 2] = [
    ("a network: one mass, two springs", oscillator::SCENE, ON_A_NETWORK),
    ("a ring: two modules of Set 1", RING, ON_A_RING),
];

/// The plain loop of `tests/oscillator`, which the network without effects is compared with.
const BY_HAND: &str = "by hand";

fn main() {
    if let Some((task, steps)) = callgrind::task() {
        counted(&task, steps);
        return;
    }
    for (table, (title, base, rows)) in TABLES.into_iter().enumerate() {
        println!("{title:42} instructions a step    time, of the first");
        if table == 0 {
            let count = callgrind::instructions_per_step(BY_HAND, COUNTED, &[]);
            println!("  {:40} {count:18.1}", "the same as a plain loop, by hand");
        }
        let times = times(base, rows);
        for (row, (name, _)) in rows.iter().enumerate() {
            let count = callgrind::instructions_per_step(&format!("{table} {row}"), COUNTED, &[]);
            let ratio = times[row].as_secs_f64() / times[0].as_secs_f64();
            println!("  {name:40} {count:18.1} {ratio:21.2}");
        }
        println!("  (the first takes {:.1} ns)", 1e9 * times[0].as_secs_f64() / TIMED as f64);
    }
}

fn text(base: &str, parts: &[&str]) -> String {
    format!("{base}{}", parts.concat())
}

/// What callgrind counts.
fn counted(task: &str, steps: u64) {
    if task == BY_HAND {
        black_box(oscillator::by_hand(steps));
        return;
    }
    let place = |part: &str| part.parse::<usize>().expect("a place in a table");
    let (table, row) = task.split_once(' ').expect("a table and a row");
    let (_, base, rows) = TABLES[place(table)];
    black_box(oscillator::simulated(&text(base, rows[place(row)].1), steps));
}

/// The shortest time of [`TIMED`] steps of each row.
fn times(base: &str, rows: &[Row]) -> Vec<Duration> {
    let scene = |(name, parts): &Row| -> Scene {
        parse(name, &text(base, parts)).unwrap_or_else(|error| panic!("{name}: {error}"))
    };
    let mut runs: Vec<Simulation> = rows
        .iter()
        .map(|row| Simulation::new(scene(row), 0.0).unwrap_or_else(|e| panic!("{}: {e}", row.0)))
        .collect();
    let mut shortest = vec![Duration::MAX; rows.len()];
    for _ in 0..SLICES {
        for (run, shortest) in runs.iter_mut().zip(&mut shortest) {
            let end = run.time() + TIMED as f64 * run.scene().step;
            let start = Instant::now();
            run.advance_to(end).expect("it is stable");
            *shortest = start.elapsed().min(*shortest);
        }
    }
    shortest
}
