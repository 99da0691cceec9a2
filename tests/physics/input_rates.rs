//! Inputs that change over a step at a rate that an importer gives: closed forms, and signals that do the same.

use amontons::contact::ContactState;
use amontons::scene::{Method, Scene, builtin, parse};
use amontons::simulation::{Simulation, Variable, variables};

const OMEGA: f64 = 20.0;

/// A mass on a spring, ω = 20 rad/s, that touches nothing; followed by `more`.
fn oscillator(more: &str) -> Scene {
    let text = format!(
        "{more}\n[[mass]]\nname = \"a\"\nmass = 0.5\nlocked = [\"y\"]\n[[spring]]\nname = \"k\"\n\
         between = [\"a\", \"ground\"]\ndirection = \"x\"\nstiffness = 200.0\n[integrator]\n\
         method = \"event-driven\"\nstep = 1e-3"
    );
    parse("oscillator", &text).unwrap()
}

/// A block that is pressed on a belt with 10 N, held by a spring of 50 N/m and sticking at first.
fn block(more: &str) -> Scene {
    block_from(-0.12, more)
}

/// The block with another initial position, m.
fn block_from(x: f64, more: &str) -> Scene {
    let text = format!(
        "[slider]\nvelocity = 0.1\nangle = 0.0\n[friction]\ncoefficient = 0.6\n{more}\n\
         [[mass]]\nname = \"a\"\nmass = 2.0\nforce = [0.0, -10.0]\n\
         [[spring]]\nname = \"k\"\nbetween = [\"a\", \"ground\"]\ndirection = \"x\"\nstiffness = 50.0\n\
         [[contact]]\nname = \"belt\"\nmass = \"a\"\n[[initial]]\nmass = \"a\"\nvx = 0.1\nx = {x}\n\
         [integrator]\nstep = 1e-4\n"
    );
    parse("block", &text).unwrap()
}

fn variable(simulation: &Simulation, name: &str) -> Variable {
    variables(simulation.scene()).into_iter().find(|variable| variable.name == name).unwrap()
}

fn read(simulation: &mut Simulation, name: &str) -> f64 {
    let variable = variable(simulation, name);
    simulation.read(&variable).unwrap()
}

fn set_rate(simulation: &mut Simulation, name: &str, rate: f64) {
    let variable = variable(simulation, name);
    simulation.set_rate(&variable, rate).unwrap();
}

/// The response of the oscillator at rest to F = r t: x = r/k (t − sin(ωt)/ω).
#[test]
fn a_force_that_grows_over_one_long_step_moves_an_oscillator_by_the_closed_form() {
    let mut simulation = Simulation::new(oscillator(""), 0.0).unwrap();
    set_rate(&mut simulation, "mass.a.fx", 30.0);
    simulation.advance_to(0.5).unwrap();
    let expected = 30.0 / 200.0 * (0.5 - (OMEGA * 0.5).sin() / OMEGA);
    assert!((read(&mut simulation, "mass.a.x") - expected).abs() < 1e-13);
    assert_eq!(read(&mut simulation, "mass.a.fx"), 15.0);
    // From here on it keeps what it has reached: the motion is that about F/k.
    let (x, v) = (read(&mut simulation, "mass.a.x"), read(&mut simulation, "mass.a.vx"));
    simulation.advance_to(0.7).unwrap();
    let (rest, t) = (15.0 / 200.0, 0.2 * OMEGA);
    let expected = rest + (x - rest) * t.cos() + v / OMEGA * t.sin();
    assert!((read(&mut simulation, "mass.a.x") - expected).abs() < 1e-13);
    assert_eq!(read(&mut simulation, "mass.a.fx"), 15.0);
}

#[test]
fn rates_do_what_a_signal_does() {
    for method in [Method::ForwardIncrement, Method::EventDriven] {
        for (input, rate) in [
            ("slider.velocity", 0.4),
            ("friction.coefficient", -0.5),
            ("mass.a.fx", 20.0),
            ("mass.a.fy", -15.0),
        ] {
            let end = 0.6;
            let signal = format!(
                "[[signal]]\ninput = \"{input}\"\nramp = {{ to = {}, end = {end} }}\n",
                rate * end
            );
            let run = |more: &str, rate: Option<f64>| {
                let mut simulation =
                    Simulation::new(Scene { method, ..block_from(-0.03, more) }, 0.0).unwrap();
                let mut met = Vec::new();
                for step in 1..=6 {
                    if let Some(rate) = rate {
                        set_rate(&mut simulation, input, rate);
                    }
                    simulation.advance_to(0.1 * f64::from(step)).unwrap();
                    met.push(["mass.a.x", "mass.a.vx"].map(|name| read(&mut simulation, name)));
                }
                met
            };
            let (rates, signals) = (run("", Some(rate)), run(&signal, None));
            assert_ne!(rates, run("", None), "{input} has no effect");
            for (rates, signals) in rates.iter().flatten().zip(signals.iter().flatten()) {
                assert!((rates - signals).abs() < 1e-9, "{input}: {rates} {signals}");
            }
        }
    }
}

/// A stuck mass follows the slider: T = k x + m v̇. An importer that only sets v anew each step cannot say so.
#[test]
fn friction_that_holds_a_mass_on_an_accelerating_slider_accelerates_it() {
    for method in [Method::ForwardIncrement, Method::EventDriven] {
        let mut simulation = Simulation::new(Scene { method, ..block("") }, 0.0).unwrap();
        for _ in 0..10 {
            let time = simulation.time();
            set_rate(&mut simulation, "slider.velocity", 0.25);
            let before = simulation.contact_forces().unwrap()[0];
            simulation.advance_to(time + 0.01).unwrap();
            let after = simulation.contact_forces().unwrap()[0];
            assert_eq!([before.state, after.state], [ContactState::Stick; 2]);
            let x = read(&mut simulation, "mass.a.x");
            let reference = simulation.reference().friction_force[0];
            let expected = reference + 50.0 * x + 2.0 * 0.25;
            let error = (after.friction_force - expected).abs();
            assert!(error < 1e-11, "{method:?}: {} {expected}", after.friction_force);
        }
        let (t, v) = (simulation.time(), read(&mut simulation, "slider.velocity"));
        assert!((v - (0.1 + 0.25 * t)).abs() < 1e-15);
    }
}

/// Importers read forces between setting a velocity and the step. A ring read there as if it slid, whatever the change:
/// a drive coupled with it came out wrong by a factor of seven.
#[test]
fn a_velocity_that_is_set_anew_does_not_loosen_what_sticks_before_the_step() {
    for method in [Method::ForwardIncrement, Method::EventDriven] {
        let mut scenes = vec![block("")];
        for name in ["set1", "set2"] {
            let mut scene = builtin(name).unwrap().scene();
            scene.modules_mut()[0].velocity[0] = 0.05;
            scenes.push(scene);
        }
        for scene in scenes {
            let mut simulation = Simulation::new(Scene { method, ..scene.clone() }, 0.0).unwrap();
            let velocity = variable(&simulation, "slider.velocity");
            let mut met = 0;
            for step in 1..=2000 {
                simulation.advance_to(1e-4 * f64::from(step)).unwrap();
                let before = simulation.contact_forces().unwrap().to_vec();
                let now = simulation.read(&velocity).unwrap();
                simulation.write(&velocity, now + 1e-9).unwrap();
                let after = simulation.contact_forces().unwrap().to_vec();
                simulation.write(&velocity, now).unwrap();
                for (before, after) in before.iter().zip(&after) {
                    if before.state == ContactState::Stick {
                        let forces = [before, after].map(|of| (of.state, of.friction_force));
                        assert_eq!(forces[1].0, ContactState::Stick, "{} {method:?}", scene.name);
                        let error = (forces[1].1 - forces[0].1).abs();
                        assert!(error < 1e-12 * before.normal_force, "{error}");
                        met += 1;
                    }
                }
            }
            assert!(met > 10, "{} {method:?}", scene.name);
        }
    }
}

#[test]
fn a_rate_of_zero_is_none() {
    let run = |rate: Option<f64>| {
        let mut simulation = Simulation::new(block_from(-0.03, ""), 0.0).unwrap();
        for step in 1..=60 {
            for name in ["slider.velocity", "mass.a.fx", "friction.coefficient"] {
                rate.into_iter().for_each(|rate| set_rate(&mut simulation, name, rate));
            }
            simulation.advance_to(0.01 * f64::from(step)).unwrap();
        }
        simulation.save()
    };
    assert_eq!(run(Some(0.0)), run(None));
}

#[test]
fn a_value_that_is_set_anew_keeps_a_rate_that_was_set_for_the_step_ahead_and_ends_one_behind() {
    let mut simulation = Simulation::new(oscillator(""), 0.0).unwrap();
    let force = variable(&simulation, "mass.a.fx");
    simulation.set_rate(&force, 30.0).unwrap();
    simulation.write(&force, 2.0).unwrap();
    simulation.advance_to(0.1).unwrap();
    assert_eq!(simulation.read(&force).unwrap(), 5.0);
    let v = variable(&simulation, "mass.a.vx");
    let jerk = |simulation: &mut Simulation| {
        let (x, at) = (read(simulation, "mass.a.x"), read(simulation, "mass.a.fx"));
        simulation.rates(&[&v]).unwrap()[0] - (at - 200.0 * x) / 0.5
    };
    assert!(jerk(&mut simulation).abs() < 1e-12);
    simulation.write(&force, 1.0).unwrap();
    simulation.advance_to(0.2).unwrap();
    assert_eq!(simulation.read(&force).unwrap(), 1.0);
}

#[test]
fn a_saved_state_brings_its_rates_along() {
    for method in [Method::ForwardIncrement, Method::EventDriven] {
        let mut simulation = Simulation::new(Scene { method, ..block("") }, 0.0).unwrap();
        simulation.advance_to(0.1).unwrap();
        set_rate(&mut simulation, "slider.velocity", 0.25);
        set_rate(&mut simulation, "mass.a.fx", 3.0);
        let ahead = simulation.save();
        let mut resumed = Simulation::resume(ahead.clone()).unwrap();
        let mut other = Simulation::new(Scene { method, ..block("") }, 0.0).unwrap();
        other.restore(&ahead).unwrap();
        for run in [&mut simulation, &mut resumed, &mut other] {
            run.advance_to(0.2).unwrap();
        }
        let behind = simulation.save();
        assert_eq!((&resumed.save(), &other.save()), (&behind, &behind));
        // The contact forces of this instant include the effect of inputs that were changing until now.
        let forces = simulation.contact_forces().unwrap().to_vec();
        let mut resumed = Simulation::resume(behind).unwrap();
        assert_eq!(resumed.contact_forces().unwrap(), forces);
        // And going back takes them away again.
        simulation.restore(&ahead).unwrap();
        assert_eq!(simulation.save(), ahead);
    }
}

#[test]
fn rates_of_what_is_no_input_and_rates_that_lead_nowhere_are_refused() {
    let mut simulation = Simulation::new(block(""), 0.0).unwrap();
    for (name, rate, part) in [
        ("mass.a.x", 1.0, "it is not an input"),
        ("mass.a.mass", 1.0, "it is not an input"),
        ("mass.a.fx", f64::NAN, "must be finite"),
    ] {
        let variable = variable(&simulation, name);
        let error = simulation.set_rate(&variable, rate).unwrap_err();
        assert!(error.is_variable() && error.to_string().contains(part), "{error}");
    }
    set_rate(&mut simulation, "mass.a.fx", 1.0);
    simulation.advance_to(0.1).unwrap();
    // µ would be below zero before the step ends. Nothing is lost by that, nor how fast the force changed up to now.
    set_rate(&mut simulation, "friction.coefficient", -2.0);
    let before = simulation.save();
    let error = simulation.advance_to(0.5).unwrap_err().to_string();
    assert!(error.contains("friction.coefficient = -0.2"), "{error}");
    assert_eq!(simulation.save(), before);
    simulation.advance_to(0.2).unwrap();
}
