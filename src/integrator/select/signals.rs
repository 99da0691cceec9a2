//! What integrators make of values over time.

use crate::scene::{Between, Method, Scene, Shape, Signal, Table};
use std::f64::consts::TAU;

/// What a time may be off from the beginning of a step, in parts of it.
const ON_THE_GRID: f64 = 1e-6;
/// What the square of the angle of a sine in a step costs where each step follows its tangent: measured 0.2.
const CURVED: f64 = 0.5;

/// The relative error that a signal causes: an edge within a step comes late, and so does all that is held
/// over it; where forces and velocities change linearly over a step, what is left is their curvature.
pub(super) fn error(
    signal: &Signal,
    scene: &Scene,
    method: Method,
    step: f64,
    frequency: f64,
) -> f64 {
    let is_held = method == Method::ForwardIncrement || signal.drives_friction();
    let stop = scene.experiment.stop_time;
    let late = |time: f64| {
        let off = (time / step - (time / step).round()).abs();
        if time <= 0.0 || time >= stop || off <= ON_THE_GRID { 0.0 } else { step }
    };
    let jump = |time: f64| frequency * late(time);
    // How much of a change over `length` (s) a step holds back, or goes on beyond where it ends.
    let slope = |length: f64| step / length;
    let straight = |start: f64, end: f64| match is_held {
        true => slope(end - start),
        false => (jump(start) + jump(end)) * slope(end - start).min(1.0),
    };
    match &signal.shape {
        Shape::Constant(_) => 0.0,
        Shape::Pulse(pulse) => jump(pulse.start) + pulse.end.map_or(0.0, jump),
        Shape::Ramp(ramp) => straight(ramp.start, ramp.end),
        Shape::Sine(sine) => {
            let angle = TAU * sine.frequency * step;
            let within = if is_held { angle } else { CURVED * angle * angle };
            within + jump(sine.start) + sine.end.map_or(0.0, jump)
        }
        Shape::Table(table) if table.between == Between::Constant => {
            table.points.iter().fold(0.0, |sum, [time, _]| sum + jump(*time))
        }
        Shape::Table(table) => {
            let jumps = table.jumps().fold(0.0, |sum, time| sum + jump(time));
            jumps
                + range_parts(table).fold(0.0, |most, (start, end, part)| {
                    f64::max(most, part * straight(start, end))
                })
        }
    }
}

/// The straight pieces of a table, from when to when (s), with the part of its range that each goes through.
fn range_parts(table: &Table) -> impl Iterator<Item = (f64, f64, f64)> + '_ {
    let values = || table.points.iter().map(|point| point[1]);
    let range = values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min);
    let pieces = table.points.windows(2).filter(move |two| two[1][0] > two[0][0] && range > 0.0);
    pieces.map(move |two| (two[0][0], two[1][0], (two[1][1] - two[0][1]).abs() / range))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Pulse, Ramp, Sine, builtin};

    fn of(input: &str, shape: Shape, method: Method, step: f64) -> f64 {
        let scene = builtin("set1").unwrap().scene();
        error(&Signal { input: input.to_owned(), shape }, &scene, method, step, 1e3)
    }

    #[test]
    fn edges_on_the_grid_cost_exact_motion_nothing() {
        let exact = |shape, step| of("module[1].f1", shape, Method::EventDriven, step);
        let pulse = || Shape::Pulse(Pulse { value: 1.0, start: 0.25, end: Some(0.5) });
        assert_eq!(exact(pulse(), 0.05), 0.0);
        assert_eq!(exact(pulse(), 0.1), 1e3 * 0.1);
        let ramp = || Shape::Ramp(Ramp { from: 0.0, to: 1.0, start: 0.0, end: 0.3 });
        assert_eq!(exact(ramp(), 0.1), 0.0);
        // Held over a step, friction is behind by half of it however the step is placed.
        assert!(of("friction.coefficient", ramp(), Method::EventDriven, 0.1) > 0.3);
        assert!(of("module[1].f1", ramp(), Method::ForwardIncrement, 0.1) > 0.3);
    }

    #[test]
    fn a_sine_costs_second_order_along_a_line_and_first_where_it_is_held() {
        let sine = || {
            let sine = Sine { amplitude: 1.0, frequency: 3.0, phase: 0.0, start: 0.0, end: None };
            Shape::Sine(sine)
        };
        let ratio = |input: &str| {
            let of = |step| of(input, sine(), Method::EventDriven, step);
            of(1e-3) / of(5e-4)
        };
        assert!((ratio("module[1].f1") - 4.0).abs() < 1e-9);
        assert!((ratio("friction.coefficient") - 2.0).abs() < 1e-9);
    }
}
