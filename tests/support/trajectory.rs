//! Runs as rows of displacements, and how far two are apart.

use amontons::integrator::Statistics;
use amontons::scene::Scene;
use amontons::simulation::Simulation;

/// Displacements every millisecond up to `stop` (s), and what was counted.
pub fn run(scene: Scene, stop: f64) -> (Vec<f64>, Statistics) {
    let mut simulation = Simulation::new(scene, 0.0).unwrap();
    let mut trajectory = Vec::new();
    let mut row = 1;
    while f64::from(row) * 1e-3 <= stop + 1e-9 {
        simulation.advance_to(f64::from(row) * 1e-3).unwrap();
        trajectory.extend_from_slice(simulation.displacement());
        row += 1;
    }
    (trajectory, simulation.statistics())
}

/// The largest difference against the amplitude.
pub fn difference(a: &[f64], b: &[f64]) -> f64 {
    let amplitude = a.iter().fold(0.0, |most, x| f64::max(most, x.abs()));
    let apart = a.iter().zip(b).fold(0.0, |most, (a, b)| f64::max(most, (a - b).abs()));
    apart / amplitude
}
