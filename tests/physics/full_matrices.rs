//! A brake pad with full matrices, whose contact nodes all share masses: its squeal, with the law of contact judged after every step.

use crate::brake_pad::{Size, scene};
use crate::judge::{LetOff, METHODS, Run, off};
use amontons::integrator::Statistics;
use amontons::scene::{Method, Scene, Structure};
use std::mem::take;

const FRICTION: f64 = 0.4;
/// Velocity with which the modes of the pad start, m√kg/s, so that contacts soon stick and open.
const START: f64 = 0.03;

/// Judges a pad up to `end` (s).
#[track_caller]
fn judged(size: Size, method: Method, step: f64, end: f64) -> (LetOff, Statistics) {
    let mut scene = Scene { step, ..scene(size, FRICTION) };
    if let Structure::Network(network) = &mut scene.structure {
        network.superelements[0].velocity[3 * size.contacts()..].fill(START);
    }
    let mut run = Run::new(scene, method);
    run.judged_until(end);
    let let_off = take(&mut run.let_off);
    // The last bits of the matrices, and with them the sequence of many events, depend on the processor.
    let allowed = off(method, 0.01, 0.25) * let_off.steps as f64;
    assert!(let_off.total() as f64 <= allowed, "{let_off:?}");
    (let_off, run.simulation.statistics())
}

#[test]
fn contacts_of_a_pad_stick_open_and_land_by_the_law() {
    for method in METHODS {
        let (let_off, statistics) = judged(Size::SMALL, method, off(method, 1e-7, 1e-5), 1e-3);
        let [_, _, sticks, opens] = statistics.entered;
        assert!(sticks > 10 && opens > 10 && statistics.touch_downs > 10, "{statistics:?}");
        assert!(let_off.releases > 0, "{let_off:?}");
        if method == Method::EventDriven {
            assert!(let_off.changes > 50 && let_off.impacts > 10, "{let_off:?}");
        }
    }
}

#[test]
#[ignore = "long: takes half a minute"]
fn a_hundred_contacts_stick_and_open_by_the_law() {
    for method in METHODS {
        let (let_off, statistics) =
            judged(Size::LARGE, method, off(method, 1e-7, 1e-6), off(method, 3e-4, 1.5e-4));
        let [_, _, sticks, opens] = statistics.entered;
        assert!(sticks > 3 && opens > 3, "{method}: {statistics:?} {let_off:?}");
    }
}
