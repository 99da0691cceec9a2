//! What each effect costs in a step: `cargo bench --bench effects` prints a table for a network and one for a
//! ring.
//!
//! Instructions are counted by callgrind, which wants valgrind installed: those of a run less those of one of
//! half as many steps, so that they are the same at each run of the benchmark. Times stand beside them as
//! multiples of the first row's, all from one run: it is cut into short slices, in which the rows take turns,
//! and the shortest counts, as other work on the machine makes a time only longer.
//!
//! All contacts slide throughout. A network without contacts has none of their code; a ring always has contacts,
//! and has the least of them where they neither open nor rub. A new effect is a new row: a name and the parts of a
//! scene file that it is made of.

#[path = "../tests/support/callgrind.rs"]
mod callgrind;
#[path = "../tests/support/oscillator.rs"]
mod oscillator;

use amontons::scene::parse;
use amontons::simulation::Simulation;
use std::hint::black_box;
use std::time::{Duration, Instant};

/// Steps of a counted run, and of a slice of a timed one.
const COUNTED: u64 = 20_000;
const TIMED: u64 = 20_000;
const SLICES: usize = 100;

/// Parts of scenes.
const RAYLEIGH: &str = "[damping]\nalpha = 1.0\nbeta = 3e-5\n";
const DAMPER: &str =
    "[[damper]]\nname = \"d\"\nbetween = [\"m\", \"ground\"]\ndirection = 1.1\ndamping = 2.0\n";
const CONTACT: &str = "[[contact]]\nname = \"c\"\nmass = \"m\"\n";
/// Keys of `[ring]`, the last table of [`RING`].
const LINKS: &str = "k1 = 55e3\nk2 = 60e3\n";
const NONE: &str = "[friction]\nlaw = \"none\"\n";
const COULOMB: &str = "[friction]\ncoefficient = 0.3\n";
const STATIC: &str = "[friction]\ncoefficient = 0.3\nstatic = 0.5\n";
/// It falls so slowly that no vibration grows.
const STRIBECK: &str = "[friction]\ncoefficient = 0.3\nstatic = 0.5\nstribeck_velocity = 1e3\n";
/// Its keys follow.
const EFFECTS: &str = "[effects]\n";
const FROZEN: &str = "sticking = false\n";
const HELD: &str = "detachment = false\n";
const ENERGY: &str = "energy = true\n";
const STABILITY: &str = "stability = true\n";

/// Two of the modules of Set 1 that nothing links; a ring has no single dampers and no step without contacts.
const RING: &str = r#"
[slider]
velocity = 0.025
angle = 0.5
[integrator]
step = 1e-6
[[initial]]
module = 1
v1 = 1e-7
[ring]
modules = 2
m1 = 0.3
m2 = 0.7
k3 = 22e3
k4 = 60e3
k5 = 300e3
k6 = 250e3
preload = 5e-3
"#;

/// What is added to a structure: a name, and parts of the scene file.
type Row = (&'static str, &'static [&'static str]);

const ON_A_NETWORK: &[Row] = &[
    ("nothing", &[]),
    ("Rayleigh damping", &[RAYLEIGH]),
    ("a single damper", &[DAMPER]),
    ("energy", &[EFFECTS, ENERGY]),
    ("stability", &[EFFECTS, STABILITY]),
    ("contact that neither opens nor rubs", &[CONTACT, NONE, EFFECTS, HELD]),
    ("contact without friction", &[CONTACT, NONE]),
    ("contact, Coulomb friction", &[CONTACT, COULOMB]),
    ("contact, static friction", &[CONTACT, STATIC]),
    ("contact, Stribeck friction", &[CONTACT, STRIBECK]),
    ("contact, Coulomb, without sticking", &[CONTACT, COULOMB, EFFECTS, FROZEN]),
    ("contact, Coulomb, without detachment", &[CONTACT, COULOMB, EFFECTS, HELD]),
    ("contact, Coulomb, energy", &[CONTACT, COULOMB, EFFECTS, ENERGY]),
    ("contact, Coulomb, stability", &[CONTACT, COULOMB, EFFECTS, STABILITY]),
    ("all together", &[RAYLEIGH, DAMPER, CONTACT, STRIBECK, EFFECTS, ENERGY, STABILITY]),
];

const ON_A_RING: &[Row] = &[
    ("contacts that neither open nor rub", &[NONE, EFFECTS, HELD]),
    ("Rayleigh damping", &[RAYLEIGH, NONE, EFFECTS, HELD]),
    ("links", &[LINKS, NONE, EFFECTS, HELD]),
    ("energy", &[NONE, EFFECTS, HELD, ENERGY]),
    ("stability", &[NONE, EFFECTS, HELD, STABILITY]),
    ("detachment", &[NONE]),
    ("detachment, Coulomb friction", &[COULOMB]),
    ("detachment, static friction", &[STATIC]),
    ("detachment, Stribeck friction", &[STRIBECK]),
    ("detachment, Coulomb, without sticking", &[COULOMB, EFFECTS, FROZEN]),
    ("Coulomb friction, without detachment", &[COULOMB, EFFECTS, HELD]),
    ("all together", &[LINKS, RAYLEIGH, STRIBECK, EFFECTS, ENERGY, STABILITY]),
];

const EXACT_ON_A_NETWORK: &[Row] = &[
    ("nothing", &[]),
    ("energy", &[EFFECTS, ENERGY]),
    ("contact, Coulomb friction", &[CONTACT, COULOMB]),
    ("contact, Coulomb, energy", &[CONTACT, COULOMB, EFFECTS, ENERGY]),
];

const EXACT_ON_A_RING: &[Row] = &[
    ("detachment, Coulomb friction", &[COULOMB]),
    ("detachment, Coulomb, energy", &[COULOMB, EFFECTS, ENERGY]),
];

/// Scenes that have a base in common, each with what is added to it.
struct Table {
    title: &'static str,
    base: &'static str,
    is_event_driven: bool,
    rows: &'static [Row],
}

impl Table {
    /// The scene file of a row.
    fn text(&self, row: usize) -> String {
        let text = format!("{}{}", self.base, self.rows[row].1.concat());
        let method = "[integrator]\nmethod = \"event-driven\"";
        if self.is_event_driven { text.replace("[integrator]", method) } else { text }
    }
}

const TABLES: [Table; 4] = [
    Table {
        title: "a network: one mass, two springs",
        base: oscillator::SCENE,
        is_event_driven: false,
        rows: ON_A_NETWORK,
    },
    Table {
        title: "a ring: two modules of Set 1",
        base: RING,
        is_event_driven: false,
        rows: ON_A_RING,
    },
    Table {
        title: "the network, event-driven",
        base: oscillator::SCENE,
        is_event_driven: true,
        rows: EXACT_ON_A_NETWORK,
    },
    Table {
        title: "the ring, event-driven",
        base: RING,
        is_event_driven: true,
        rows: EXACT_ON_A_RING,
    },
];

/// The plain loop of `tests/support/oscillator.rs`, which the network without effects is compared with.
const BY_HAND: &str = "by hand";

fn main() {
    if let Some((task, steps)) = callgrind::task() {
        counted(&task, steps);
        return;
    }
    for (place, table) in TABLES.iter().enumerate() {
        println!("{:42} instructions a step    time, of the first", table.title);
        if place == 0 {
            let count = callgrind::instructions_per_step(BY_HAND, COUNTED, &[]);
            println!("  {:40} {count:18.1}", "the same as a plain loop, by hand");
        }
        let times = times(table);
        for (row, (name, _)) in table.rows.iter().enumerate() {
            let count = callgrind::instructions_per_step(&format!("{place} {row}"), COUNTED, &[]);
            let ratio = times[row].as_secs_f64() / times[0].as_secs_f64();
            println!("  {name:40} {count:18.1} {ratio:21.2}");
        }
        println!("  (the first takes {:.1} ns)", 1e9 * times[0].as_secs_f64() / TIMED as f64);
    }
}

/// What callgrind counts.
fn counted(task: &str, steps: u64) {
    if task == BY_HAND {
        black_box(oscillator::by_hand(steps));
        return;
    }
    let place = |part: &str| part.parse::<usize>().expect("a place in a table");
    let (table, row) = task.split_once(' ').expect("a table and a row");
    black_box(oscillator::simulated(&TABLES[place(table)].text(place(row)), steps));
}

/// The shortest time of [`TIMED`] steps of each row.
fn times(table: &Table) -> Vec<Duration> {
    let run = |(row, (name, _)): (usize, &Row)| -> Simulation {
        let scene = parse(name, &table.text(row)).unwrap_or_else(|error| panic!("{name}: {error}"));
        Simulation::new(scene, 0.0).unwrap_or_else(|error| panic!("{name}: {error}"))
    };
    let mut runs: Vec<Simulation> = table.rows.iter().enumerate().map(run).collect();
    let mut shortest = vec![Duration::MAX; runs.len()];
    for _ in 0..SLICES {
        for (run, shortest) in runs.iter_mut().zip(&mut shortest) {
            let end = run.time() + TIMED as f64 * run.scene().step;
            let start = Instant::now();
            run.advance_to(end).expect("it is stable");
            *shortest = start.elapsed().min(*shortest);
        }
    }
    for (run, (name, _)) in runs.iter().zip(table.rows) {
        assert_eq!(run.statistics().state_changes(), 0, "{name} does not slide throughout");
    }
    shortest
}
