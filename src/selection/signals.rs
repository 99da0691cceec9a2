//! Errors of integrators that signals, values over time, cause.

use crate::numerics::range;
use crate::scene::{Between, Method, Scene, Shape, Signal, Table};
use std::f64::consts::TAU;

/// Tolerance for a time at the beginning of a step, in parts of the step.
const ON_THE_GRID: f64 = 1e-6;
/// Largest angle of a sine in one step of event-driven motion, rad.
const MOST_RADIANS: f64 = 1e5;

/// The relative error that a signal causes. Event-driven motion follows signals as they are, and stops at their edges. The
/// paper's scheme holds them over a step, and an edge within a step comes late.
pub(super) fn error(
    signal: &Signal,
    scene: &Scene,
    method: Method,
    step: f64,
    frequency: f64,
) -> f64 {
    if method == Method::EventDriven {
        return match &signal.shape {
            Shape::Sine(sine) if TAU * sine.frequency * step > MOST_RADIANS => f64::INFINITY,
            _ => 0.0,
        };
    }
    let stop = scene.experiment.stop_time;
    let late = |time: f64| {
        let off = (time / step - (time / step).round()).abs();
        if time <= 0.0 || time >= stop || off <= ON_THE_GRID { 0.0 } else { step }
    };
    let jump = |time: f64| frequency * late(time);
    // The part of a change that a step holds back.
    let straight = |start: f64, end: f64| step / (end - start);
    match &signal.shape {
        Shape::Constant(_) => 0.0,
        Shape::Pulse(pulse) => jump(pulse.start) + pulse.end.map_or(0.0, jump),
        Shape::Ramp(ramp) => straight(ramp.start, ramp.end),
        Shape::Sine(sine) => {
            TAU * sine.frequency * step + jump(sine.start) + sine.end.map_or(0.0, jump)
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

/// The straight pieces of a table, each with its start and end (s) and the part of the table's range that it covers.
fn range_parts(table: &Table) -> impl Iterator<Item = (f64, f64, f64)> + '_ {
    let [least, most] = range(table.points.iter().map(|point| point[1]));
    let range = most - least;
    let pieces = table.points.windows(2).filter(move |two| two[1][0] > two[0][0] && range > 0.0);
    pieces.map(move |two| (two[0][0], two[1][0], (two[1][1] - two[0][1]).abs() / range))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Pulse, Ramp, Sine, builtin};

    fn of(shape: Shape, method: Method, step: f64) -> f64 {
        let scene = builtin("set1").unwrap().scene();
        error(&Signal { input: "module[1].f1".to_owned(), shape }, &scene, method, step, 1e3)
    }

    #[test]
    fn edges_cost_exact_motion_nothing_wherever_they_are() {
        let exact = |shape, step| of(shape, Method::EventDriven, step);
        let pulse = || Shape::Pulse(Pulse { value: 1.0, start: 0.25, end: Some(0.5) });
        assert_eq!([0.05, 0.1].map(|step| exact(pulse(), step)), [0.0; 2]);
        let scheme = |step| of(pulse(), Method::ForwardIncrement, step);
        assert_eq!([0.05, 0.1].map(scheme), [0.0, 1e3 * 0.1]);
        let ramp = || Shape::Ramp(Ramp { from: 0.0, to: 1.0, start: 0.0, end: 0.3 });
        assert_eq!([0.1, 0.2].map(|step| exact(ramp(), step)), [0.0; 2]);
        assert!(of(ramp(), Method::ForwardIncrement, 0.1) > 0.3);
    }

    #[test]
    fn a_sine_costs_nothing_where_it_is_followed_and_first_order_where_it_is_held() {
        let sine = || {
            let sine = Sine { amplitude: 1.0, frequency: 3.0, phase: 0.0, start: 0.0, end: None };
            Shape::Sine(sine)
        };
        let exact = |step| of(sine(), Method::EventDriven, step);
        assert_eq!(exact(1e-3), 0.0);
        // One step cannot follow any number of periods.
        assert_eq!(exact(1e4), f64::INFINITY);
        let held = |step| of(sine(), Method::ForwardIncrement, step);
        assert!((held(1e-3) / held(5e-4) - 2.0).abs() < 1e-9);
    }
}
