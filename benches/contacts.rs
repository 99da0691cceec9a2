//! What contacts on one body cost: `cargo bench --bench contacts` prints one table.
//!
//! Pads lie around a disc on springs, each with a velocity of its own, so that all contacts share the disc's mass. They
//! bounce, stick and slide for 10 ms, or for exact motion some thousand events. The table has the time of a step of the
//! paper's scheme and that of an event of exact motion, against those of one pad; the growth is the exponent from the
//! row before, where 1 is in proportion to the number of contacts.

#[path = "../tests/support/disc.rs"]
mod disc;

use amontons::scene::{Method, Scene};
use amontons::simulation::Simulation;
use std::time::Instant;

/// Of a run.
const MOST_EVENTS: u64 = 5000;

fn main() {
    println!("contacts    step   µs    / one  growth     event   µs    / one  growth    events");
    let mut first: Option<[f64; 2]> = None;
    let mut before: Option<[f64; 2]> = None;
    for pads in [1, 2, 4, 8, 16, 32, 64, 128] {
        let scheme =
            run(&Scene { method: Method::ForwardIncrement, step: 1e-5, ..pads_alone(pads) });
        let exact = run(&Scene { method: Method::EventDriven, step: 1e-4, ..pads_alone(pads) });
        let (Ok((seconds, steps, _)), Ok((exact_seconds, _, events))) = (&scheme, &exact) else {
            println!("{pads:8} {scheme:?} {exact:?}");
            continue;
        };
        let now = [1e6 * seconds / *steps as f64, 1e6 * exact_seconds / (*events).max(1) as f64];
        let one = *first.get_or_insert(now);
        let growth =
            |i: usize| before.map_or(f64::NAN, |before: [f64; 2]| (now[i] / before[i]).log2());
        println!(
            "{pads:8} {:12.2} {:8.1} {:7.2} {:14.2} {:8.1} {:7.2} {events:9}",
            now[0],
            now[0] / one[0],
            growth(0),
            now[1],
            now[1] / one[1],
            growth(1)
        );
        before = Some(now);
    }
}

/// The scene without its ledger of energy, which costs time of its own.
fn pads_alone(pads: u32) -> Scene {
    let mut scene = disc::disc(pads);
    scene.effects.energy = false;
    scene
}

/// Seconds of computing, steps and events of a run, the shortest of three.
fn run(scene: &Scene) -> Result<(f64, u64, u64), amontons::Error> {
    let mut shortest: Option<(f64, u64, u64)> = None;
    for _ in 0..3 {
        let mut simulation = Simulation::new(scene.clone(), 0.0)?;
        let start = Instant::now();
        for part in 1..=100 {
            simulation.advance_to(1e-4 * f64::from(part))?;
            if simulation.statistics().events > MOST_EVENTS {
                break;
            }
        }
        let seconds = start.elapsed().as_secs_f64();
        let statistics = simulation.statistics();
        if shortest.is_none_or(|(least, ..)| seconds < least) {
            shortest = Some((seconds, statistics.steps, statistics.events));
        }
        if seconds > 5.0 {
            break;
        }
    }
    Ok(shortest.expect("three runs"))
}
