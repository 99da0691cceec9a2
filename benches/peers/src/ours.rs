//! Amontons through its library: the event-driven integrator and the paper's scheme.

use crate::peer::{Candidate, Outcome, Stopwatch};
use crate::scenes::{DOFS, ROWS};
use amontons::scene::{Method, Scene};
use amontons::simulation::Simulation;

pub const EVENT_DRIVEN: &str = "Amontons, event-driven";
pub const SCHEME: &str = "Amontons, paper's scheme";

/// The event-driven integrator, whose step hardly matters, and the scheme with so many steps a row.
pub fn candidates(scene: &Scene, steps_a_row: &[u32]) -> Vec<Candidate> {
    let candidate = |who, method, step| {
        let scene = Scene { method, step, ..scene.clone() };
        Candidate { who, setting: format!("h = {step:.1e} s"), run: Box::new(move || run(&scene)) }
    };
    let scheme = steps_a_row.iter().map(|&steps| 1e-3 / f64::from(steps));
    [candidate(EVENT_DRIVEN, Method::EventDriven, 1e-3)]
        .into_iter()
        .chain(scheme.map(|step| candidate(SCHEME, Method::ForwardIncrement, step)))
        .collect()
}

/// What all are measured by: the event-driven integrator with half the step that is timed.
pub fn reference(scene: &Scene) -> Outcome {
    run(&Scene { method: Method::EventDriven, step: 5e-4, ..scene.clone() })
}

fn run(scene: &Scene) -> Outcome {
    let mut simulation = Simulation::new(scene.clone(), 0.0).expect("the scene is possible");
    let mut displacements = Vec::with_capacity(ROWS * DOFS);
    let mut watch = Stopwatch::start();
    for row in 1..=ROWS {
        simulation.advance_to(1e-3 * row as f64).expect("it can be simulated");
        displacements.extend_from_slice(simulation.displacement());
        watch.row(row);
    }
    let statistics = simulation.statistics();
    Outcome {
        displacements,
        events: Some(statistics.state_changes()),
        touch_downs: Some(statistics.touch_downs),
        slices: watch.slices(),
    }
}
