//! Periodic motions under friction coefficients that sines drive agree with closed forms and with differences of runs.

use crate::orbits::{after, follow, has_multipliers_of_differences, near, orbit, solved};
use amontons::contact::ContactState;
use amontons::integrator::{Event, StepFailure};
use amontons::scene::{Scene, parse};
use amontons::simulation::Simulation;
use amontons_analysis::orbit::{BranchEnd, Flow};
use amontons_analysis::study::{
    self, FoundOrbit, From, Journal, ObservationRequest, ObservationSettings, Unfound, Watch,
};
use nalgebra::DVector;
use std::f64::consts::TAU;

/// A block of 1 kg on a belt (velocity, m/s), pressed on by 10 N, on a spring of 100 N/m and a damper of 0.5 N s/m.
fn block(velocity: f64, rest: &str) -> Scene {
    let text = format!(
        "[slider]\nvelocity = {velocity:?}\nangle = 0.0\n\
         [[mass]]\nname = \"block\"\nmass = 1.0\nforce = [0.0, -10.0]\n\
         [[spring]]\nname = \"k\"\nbetween = [\"block\", \"ground\"]\ndirection = \"x\"\nstiffness = 100.0\n\
         [[damper]]\nname = \"d\"\nbetween = [\"block\", \"ground\"]\ndirection = \"x\"\ndamping = 0.5\n\
         [[contact]]\nname = \"c\"\nmass = \"block\"\n\
         [integrator]\nmethod = \"event-driven\"\nstep = 0.02\n{rest}"
    );
    parse("block", &text).unwrap()
}

fn sine(input: &str, amplitude: f64, frequency: f64) -> String {
    format!(
        "[[signal]]\ninput = \"{input}\"\nsine = {{ amplitude = {amplitude:?}, frequency = {frequency:?} }}\n"
    )
}

/// The built-in disc brake with one lining aslant: the disc cannot follow its tangent, so that friction forces change normal
/// forces at once. Sines drive the friction coefficient and the velocity of one lining.
fn aslant_brake() -> Scene {
    let mut text = std::fs::read_to_string("../../scenes/disc_brake.toml").unwrap();
    for (old, new) in [
        ("angle = 0.0 ", "friction = 0.5\nangle = 0.3 "),
        ("velocity = 0.05 ", "velocity = 5.0 "),
        ("velocity = -0.05 ", "velocity = -5.0 "),
        ("step = 1.0e-6", "method = \"event-driven\"\nstep = 2e-5"),
    ] {
        assert!(text.contains(old), "{old}");
        text = text.replace(old, new);
    }
    let drives = [
        sine("friction.coefficient", 0.3, 700.0),
        sine("contact.upper_lining.friction", 0.2, 900.0),
        sine("contact.lower_lining.velocity", 0.01, 300.0),
    ];
    parse("aslant", &format!("{text}\n{}", drives.concat())).unwrap()
}

/// While the block slides, its friction is the force (µ + a sin ω t) N.
#[test]
fn a_sine_on_friction_moves_a_sliding_block_as_a_force_does() {
    let frequency = 1.25;
    let friction = "[friction]\ncoefficient = 0.3\n";
    let scene = block(3.0, &format!("{friction}{}", sine("friction.coefficient", 0.2, frequency)));
    let orbit = orbit(&mut after(scene, 40.0), Some(1.0 / frequency), 1.0);
    let omega = TAU * frequency;
    let response = 0.2 * 10.0 / (100.0 - omega * omega).hypot(0.5 * omega);
    near(orbit.extents[0], response, 1e-12);
    near(orbit.largest_multiplier(), (-0.25 / frequency).exp(), 1e-13);
    assert!(orbit.events.is_empty());
}

/// The derivative of the flow by all places of the state, those of the sines too, where the normal forces depend on the
/// state and on friction at once; and the flow itself against the integrator.
#[test]
fn the_derivative_of_the_flow_under_driven_friction_is_that_of_differences() {
    let scene = aslant_brake();
    let mut simulation = after(scene, 2.03e-3);
    let states = simulation.motion().contacts.clone();
    assert_eq!(states, [ContactState::Slide, ContactState::ReverseSlide]);
    let mut flow = Flow::of(&mut simulation).unwrap();
    let start = flow.state(simulation.motion(), 0.0);
    let time = 3e-4;
    let (motion, instants) = flow.run(&simulation.motion().clone(), 0.0, time, |_| true).unwrap();
    assert!(instants.iter().all(|instant| !instant.is_change()), "{instants:?}");
    let end = flow.propagate(&states, &start, time).unwrap();
    let by_run = flow.state(&motion, time);
    let units = flow.units().to_vec();
    let scaled = |y: &DVector<f64>| DVector::from_fn(y.len(), |i, _| y[i] / units[i]);
    let size = scaled(&by_run).amax();
    assert!(scaled(&(&end - &by_run)).amax() < 1e-13 * size, "{end} {by_run}");
    let matrix = flow.propagator(&states, &start, time).unwrap();
    assert!(scaled(&(&matrix * &start - &end)).amax() < 1e-13 * size, "{matrix}");
    let one = 2 * flow.dofs();
    for place in (0..flow.size()).filter(|place| *place != one) {
        let off = 1e-4 * units[place];
        let [low, high] = [-off, off].map(|off| {
            let mut start = start.clone();
            start[place] += off;
            flow.propagate(&states, &start, time).unwrap()
        });
        let by_differences = scaled(&((high - low) / (2.0 * off))) * units[place];
        let column = scaled(&matrix.column(place).into_owned()) * units[place];
        let apart = (&by_differences - &column).amax();
        assert!(apart < 1e-8 * column.amax().max(1e-3), "{place}: {by_differences} {column}");
    }
}

/// A block on resting ground under a force and friction coefficients that sines drive, with the frequency of the force in Hz;
/// followed by `more`.
fn driven_block(frequency: f64, more: &str) -> Scene {
    let drives = [
        sine("mass.block.fx", 12.0, frequency),
        sine("friction.coefficient", 0.1, 2.0 * frequency),
        sine("friction.static", 0.15, frequency),
    ];
    let friction = "[friction]\ncoefficient = 0.3\nstatic = 0.6\n";
    block(0.0, &format!("{friction}{}{more}", drives.concat()))
}

/// It sticks at both ends of its way, and lets go at the limit µ_s(t) N.
#[test]
fn a_block_that_sticks_at_a_limit_that_sines_move_has_multipliers_of_differences() {
    let period = 1.0 / 0.7;
    let (orbit, chain, mut flow) =
        solved(&mut after(driven_block(0.7, ""), 40.0 * period), Some(period), 1.0).unwrap();
    let has = |wanted: fn(&Event) -> bool| {
        orbit.events.iter().flat_map(|event| &event.events).any(|(_, event)| wanted(event))
    };
    assert!(has(|event| *event == Event::Stop) && has(|event| matches!(event, Event::Slip(_))));
    has_multipliers_of_differences(&orbit, &chain, &mut flow, &[0, 2]);
}

/// The orbit that a run of a scene leads to, observed in windows of this length (s), for this time (s) at most.
fn of_run(mut scene: Scene, window: f64, longest: Option<f64>) -> Result<FoundOrbit, Unfound> {
    let window = Some(window);
    let request = ObservationRequest { window, longest, ..ObservationRequest::default() };
    let observation = ObservationSettings::paced(&mut scene, &request).unwrap();
    let found = study::orbit(&scene, &observation, &From::Run, &Journal::forgotten(), Watch::IDLE);
    found.map(Option::unwrap)
}

/// Windows of 1 s hold no period, or just one, and begin where the block sticks. The search for a period then divided by the
/// speed of a block at rest, or ended without a period.
#[test]
fn a_driven_motion_whose_windows_do_not_show_its_period_is_found_all_the_same() {
    for frequency in [0.5, 0.7, 0.75, 1.0] {
        let found = of_run(driven_block(frequency, ""), 1.0, None).unwrap();
        let orbit = found.orbit;
        near(orbit.period, 1.0 / frequency, 1e-12);
        assert_eq!(orbit.is_stable(), Some(true));
        let run = after(driven_block(frequency, ""), 80.0 / frequency);
        assert!((run.displacement()[0] - orbit.displacement[0]).abs() < 1e-12, "{frequency}");
        assert!((run.velocity()[0] - orbit.velocity[0]).abs() < 1e-11, "{frequency}");
    }
}

/// Newton's method finds the periodic motion that the run will come to; after two or three windows it is not there yet.
#[test]
fn a_run_that_has_not_come_to_a_periodic_motion_has_none() {
    let unfound = of_run(driven_block(0.5, ""), 1.0, Some(3.0)).unwrap_err();
    let message = unfound.error.to_string();
    for part in ["has not settled", "--longest", "motion of 2.000000e0 s near it", "away from it"] {
        assert!(message.contains(part), "{part}: {message}");
    }
}

/// A sine of 0.1 Hz without amplitude made the period 10 s, with ten times the events. On a branch over its amplitude the
/// period is 10 s from the beginning on.
#[test]
fn a_sine_without_amplitude_has_no_part_in_the_period_of_an_orbit() {
    let scene = driven_block(1.0, &sine("mass.block.fx", 0.0, 0.1));
    let plain = of_run(driven_block(1.0, ""), 10.0, None).unwrap().orbit;
    let found = of_run(scene.clone(), 10.0, None).unwrap().orbit;
    near(found.period, 1.0, 1e-12);
    assert_eq!(found.events.len(), plain.events.len());
    near(found.extents[0], plain.extents[0], 1e-12);
    let (_, chain, _) = solved(&mut after(scene.clone(), 40.0), Some(1.0), 1.0).unwrap();
    let branch = follow(&scene, "signal[4].amplitude", [0.0, 0.5], &chain);
    assert_eq!(branch.ends, [BranchEnd::Range; 2]);
    for point in [branch.points.first(), branch.points.last()] {
        near(point.unwrap().orbit.period, 10.0, 1e-12);
    }
}

/// The instant at which a run of a flow fails counts from the simulation's time 0.
#[test]
fn a_run_of_a_flow_tells_when_a_sine_takes_static_friction_below_kinetic_friction() {
    let drive = sine("friction.coefficient", 0.5, 1.25);
    let friction = "[friction]\ncoefficient = 0.3\nstatic = 0.6\n";
    let mut simulation = Simulation::new(block(0.0, &format!("{friction}{drive}")), 0.0).unwrap();
    let mut flow = Flow::of(&mut simulation).unwrap();
    let start = simulation.motion().clone();
    let failure = flow.run(&start, 0.0, 1.0, |_| true).unwrap_err();
    let StepFailure::WeakStaticFriction { after, coefficient, .. } = failure else {
        panic!("{failure:?}")
    };
    near(after, 0.6_f64.asin() / (TAU * 1.25), 1e-9);
    near(coefficient, 0.6, 1e-11);
}

/// A force lifts the block off, and it lands with another friction coefficient. A strut aslant joins both directions, so
/// that the instants of lift-off and landing depend on all of the motion.
#[test]
fn landings_with_friction_that_a_sine_drives_have_multipliers_of_differences() {
    let frequency = 2.0;
    let drives = [
        sine("mass.block.fy", 14.0, frequency),
        sine("friction.coefficient", 0.2, 2.0 * frequency),
    ];
    let rest = "[friction]\ncoefficient = 0.4\n[[spring]]\nname = \"strut\"\n\
        between = [\"block\", \"ground\"]\ndirection = 0.8\nstiffness = 40.0\n";
    let scene = block(2.0, &format!("{rest}{}", drives.concat()));
    let mut simulation = after(scene, 40.0);
    let (orbit, chain, mut flow) = solved(&mut simulation, Some(1.0 / frequency), 1.0).unwrap();
    assert!(
        orbit
            .events
            .iter()
            .flat_map(|event| &event.events)
            .any(|(_, event)| *event == Event::Touch)
    );
    has_multipliers_of_differences(&orbit, &chain, &mut flow, &[0, 2]);
}

/// A sliding block answers in proportion to the amplitude.
#[test]
fn a_branch_over_the_amplitude_of_driven_friction_has_the_linear_response() {
    let frequency = 1.25;
    let friction = "[friction]\ncoefficient = 0.3\n";
    let scene = block(3.0, &format!("{friction}{}", sine("friction.coefficient", 0.2, frequency)));
    let period = 1.0 / frequency;
    let (_, chain, _) = solved(&mut after(scene.clone(), 40.0), Some(period), 1.0).unwrap();
    let branch = follow(&scene, "signal[1].amplitude", [0.01, 0.3], &chain);
    assert_eq!(branch.ends, [BranchEnd::Range; 2]);
    assert_eq!(branch.points[0].parameter, 0.01);
    let omega = TAU * frequency;
    for point in &branch.points {
        let force = 10.0 * point.parameter;
        let response = force / (100.0 - omega * omega).hypot(0.5 * omega);
        let off = (point.orbit.extents[0] - response).abs();
        assert!(off < 1e-13, "{} {off:e}", point.parameter);
    }
}

/// From friction that nothing drives to friction that sines drive: both ends of the branch are the orbits of runs.
#[test]
fn a_branch_over_the_amplitude_of_driven_friction_joins_the_orbits_of_runs() {
    let with = |amplitude: f64| {
        let drives =
            [sine("mass.block.fx", 12.0, 0.7), sine("friction.coefficient", amplitude, 1.4)];
        block(0.0, &format!("[friction]\ncoefficient = 0.3\nstatic = 0.6\n{}", drives.concat()))
    };
    let period = 1.0 / 0.7;
    let found = |amplitude: f64| {
        let mut simulation = after(with(amplitude), 40.0 * period);
        let (orbit, chain, _) = solved(&mut simulation, Some(period), 1.0).unwrap();
        (orbit, chain)
    };
    let [first, last] = [0.0, 0.2].map(found);
    let branch = follow(&with(0.0), "signal[2].amplitude", [0.0, 0.2], &first.1);
    assert_eq!(branch.ends, [BranchEnd::Range; 2]);
    for (point, (orbit, _)) in
        [branch.points.first(), branch.points.last()].iter().zip([first, last])
    {
        let found = &point.unwrap().orbit;
        near(found.extents[0], orbit.extents[0], 1e-10);
        near(found.largest_multiplier(), orbit.largest_multiplier(), 1e-8);
    }
}
