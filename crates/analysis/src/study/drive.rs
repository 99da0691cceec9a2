//! This module analyses the signals of a scene in the long run: the time from which on they only repeat themselves,
//! and their period.

use amontons::scene::{Constant, Scene, Shape, Signal, Sine};
use amontons::simulation::Simulation;

/// Frequencies are multiples of a common one if they meet them to this part: some roundings of the numbers that a person
/// writes.
const SAME: f64 = 1e-12;
/// A common period of two sines that holds more than this number of periods of either is not looked for.
const MOST_PERIODS: f64 = 100_000.0;

/// The time, s, from which on each signal is constant or a sine that never ends.
pub(super) fn last_edge(scene: &Scene) -> f64 {
    let last = |shape: &Shape| {
        let mut last = f64::NEG_INFINITY;
        loop {
            match shape.next_edge(last, 0.0) {
                f64::INFINITY => return last,
                next => last = next,
            }
        }
    };
    scene.signals.iter().map(|signal| last(&signal.shape)).fold(0.0, f64::max)
}

/// The shortest time, s, after which all signals of a simulation that still change repeat themselves. `None` where they do
/// not, or only after more than 100,000 periods of one of them, and where none changes.
pub(super) fn period(simulation: &Simulation) -> Option<f64> {
    let time = simulation.time();
    let mut common: Option<f64> = None;
    for signal in simulation.scene().signals.iter() {
        match &signal.shape {
            shape if shape.constant_until(time, 0.0) == f64::INFINITY => {}
            Shape::Sine(Sine { frequency, start, end: None, .. }) if start <= &time => {
                let own = 1.0 / frequency;
                common = Some(common.map_or(Some(own), |period| common_period(period, own))?);
            }
            _ => return None,
        }
    }
    common
}

/// The scene with a constant zero in place of each sine of amplitude 0, so that its phase is no part of the state of a
/// motion. The sine whose value the parameter `name` is stays a sine: other values of the parameter may give it an
/// amplitude.
pub(super) fn without_silent_sines(scene: &Scene, name: Option<&str>) -> Scene {
    let quiet = |(place, signal): (usize, &Signal)| {
        let own = format!("signal[{}].", place + 1);
        let is_silent = matches!(signal.shape, Shape::Sine(Sine { amplitude: 0.0, .. }));
        if !is_silent || name.is_some_and(|name| name.starts_with(&own)) {
            return signal.clone();
        }
        Signal { shape: Shape::Constant(Constant { value: 0.0 }), ..signal.clone() }
    };
    Scene { signals: scene.signals.iter().enumerate().map(quiet).collect(), ..scene.clone() }
}

/// `true` if the drive of a simulation repeats itself from each window (s) to the next: it is constant, or has a
/// period that is no longer than the window.
pub(super) fn is_repeated(simulation: &Simulation, window: f64) -> bool {
    !simulation.is_driven_on() || period(simulation).is_some_and(|period| period <= window)
}

/// The shortest time that holds a whole number of both periods, by the continued fraction of their ratio.
fn common_period(a: f64, b: f64) -> Option<f64> {
    let ratio = a / b;
    // Numerators and denominators of the last two convergents.
    let ([mut p, mut q], [mut p_before, mut q_before]) = ([ratio.floor(), 1.0], [1.0, 0.0]);
    let mut rest = ratio - p;
    while (p / q / ratio - 1.0).abs() > SAME {
        if rest <= 0.0 {
            return None;
        }
        let whole = (1.0 / rest).floor();
        rest = 1.0 / rest - whole;
        (p, p_before) = (whole * p + p_before, p);
        (q, q_before) = (whole * q + q_before, q);
        if p.max(q) > MOST_PERIODS {
            return None;
        }
    }
    // q periods a last as long as p periods b.
    Some(q * a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use amontons::scene::{builtin, parse};

    #[test]
    fn a_sine_without_amplitude_takes_no_part_in_the_drive() {
        let text = builtin("den_hartog").unwrap().text;
        let sine =
            "[[signal]]\ninput = \"mass.block.fx\"\nsine = { amplitude = 0.0, frequency = 0.1 }";
        let mut scene = parse("silent", &format!("{text}\n{sine}")).unwrap();
        let of = |scene: &Scene| {
            let simulation = Simulation::new(scene.clone(), 0.0).unwrap();
            (period(&simulation), is_repeated(&simulation, 1.0))
        };
        assert_eq!(of(&scene), (Some(0.4), true));
        let silenced = |scene: &Scene, name| {
            matches!(without_silent_sines(scene, name).signals[1].shape, Shape::Constant(_))
        };
        assert!(silenced(&scene, None) && silenced(&scene, Some("signal[1].amplitude")));
        assert!(!silenced(&scene, Some("signal[2].amplitude")));
        crate::assign::assign(&mut scene, "signal[1].amplitude", 0.0).unwrap();
        // Nothing drives it at all.
        assert_eq!(of(&scene), (None, true));
    }

    #[test]
    fn two_periods_have_the_common_one_of_their_ratio() {
        let of = |f: f64, g: f64| common_period(1.0 / f, 1.0 / g);
        let is = |found: Option<f64>, wanted: f64| (found.unwrap() / wanted - 1.0).abs() < 1e-11;
        assert!(is(of(5.0, 5.3125), 3.2) && is(of(5.3125, 5.0), 3.2));
        assert!(is(of(4.44, 5.55), 1.0 / 1.11) && is(of(0.9, 0.9), 1.0 / 0.9));
        assert!(is(of(2.0, 6.0), 0.5) && is(of(6.0, 2.0), 0.5) && is(of(10.0, 10.01), 100.0));
        assert_eq!(of(1.0, 2.0_f64.sqrt()), None);
    }
}
