//! Periodic motions, their multipliers and their branches agree with closed forms, with numbers of other programs, and
//! with differences of runs.

use amontons::integrator::{Event, Motion, StepFailure};
use amontons::scene::{Scene, builtin, parse};
use amontons::simulation::Simulation;
use amontons_analysis::assign::{assign, value_of};
use amontons_analysis::orbit::{
    Branch, BranchEnd, Chain, Continued, Flow, NoOrbit, Orbit, OrbitEnergy, SpecialKind, Start,
    branch, search,
};
use nalgebra::DMatrix;
use std::f64::consts::PI;

/// The orbit near the motion of a simulation now, with its chain of segments.
pub fn solved(
    simulation: &mut Simulation,
    period: Option<f64>,
    longest: f64,
) -> Result<(Orbit, Chain, Flow), NoOrbit> {
    let motion = simulation.motion().clone();
    let mut flow = Flow::of(simulation).unwrap();
    let start = Start { motion, time: 0.0, period, longest };
    let (orbit, chain) = search(&mut flow, &start, &|| true)?.unwrap();
    assert!(orbit.defect < 1e-12, "defect {:e}", orbit.defect);
    Ok((orbit, chain, flow))
}

pub fn orbit(simulation: &mut Simulation, period: Option<f64>, longest: f64) -> Orbit {
    solved(simulation, period, longest).unwrap().0
}

/// A built-in scene in exact motion, with values.
fn scene(name: &str, step: f64, values: &[(&str, f64)]) -> Scene {
    let mut scene = builtin(name).unwrap().scene();
    scene.set_integrator(Some(amontons::scene::Method::EventDriven), Some(step)).unwrap();
    for (name, value) in values {
        assign(&mut scene, name, *value).unwrap();
    }
    scene
}

pub fn after(scene: Scene, time: f64) -> Simulation {
    let mut simulation = Simulation::new(scene, 0.0).unwrap();
    simulation.advance_to(time).unwrap();
    simulation
}

/// The branch over a parameter of the scene that begins with the orbit near a simulation's motion.
fn followed(scene: &Scene, name: &str, range: [f64; 2], simulation: &mut Simulation) -> Branch {
    let (_, chain, _) = solved(simulation, None, 20.0 * 0.01).unwrap();
    follow(scene, name, range, &chain)
}

pub fn follow(scene: &Scene, name: &str, range: [f64; 2], chain: &Chain) -> Branch {
    let flow_at = |value: f64| {
        let mut scene = scene.clone();
        assign(&mut scene, name, value)?;
        Flow::of(&mut Simulation::new(scene, 0.0)?)
    };
    let here = value_of(scene, name).unwrap().clamp(range[0], range[1]);
    let continued = Continued { flow_at: &flow_at, range, most_points: 400, goes_on: &|_| true };
    branch(&continued, chain, here).unwrap().unwrap()
}

pub fn near(found: f64, wanted: f64, part: f64) {
    assert!((found - wanted).abs() <= part * wanted.abs(), "{found} is not {wanted}");
}

/// A chain of two masses on the ground; a force 20 sin(ω t + π/2) on the first, the second rubs on resting ground.
fn two_masses(omega: f64) -> Scene {
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
    parse("two_masses", &text).unwrap()
}

/// Case A of two masses: other programs give these numbers, multipliers by differences.
#[test]
fn a_driven_chain_that_only_reverses_its_slip_has_the_orbit_of_other_programs() {
    let period = 2.0 * PI / 0.618;
    let orbit = orbit(&mut after(two_masses(0.618), 30.0 * period), Some(period), period);
    assert_eq!(orbit.events.len(), 2);
    near(orbit.events[0].time / period, 0.249_364_356, 3e-9);
    near(orbit.events[1].time / period, 0.749_364_356, 1e-9);
    near(orbit.extents[0], 302.856_51, 2e-8);
    near(orbit.extents[1], 489.244_76, 1e-8);
    let wanted = [[0.961_91, 0.0], [0.860_27, 0.0], [-0.553_41, 0.506_27], [-0.553_41, -0.506_27]];
    assert_eq!(orbit.multipliers.len(), 4);
    for (found, wanted) in orbit.multipliers.iter().zip(wanted) {
        assert!((found[0] - wanted[0]).hypot(found[1] - wanted[1]) < 1e-5, "{found:?} {wanted:?}");
    }
    assert_eq!(orbit.is_stable(), Some(true));
    // The gap and its rate, which the contact holds for the whole period.
    assert_eq!(orbit.zeros, 2);
}

/// Case B of two masses.
#[test]
fn a_driven_chain_that_sticks_twice_loses_one_direction() {
    let period = 2.0 * PI / 0.293;
    let orbit = orbit(&mut after(two_masses(0.293), 10.0 * period), Some(period), period);
    let times: Vec<f64> = orbit.events.iter().map(|event| event.time / period).collect();
    let wanted = [0.035_932_480_2, 0.132_034_828_9, 0.535_932_480_2, 0.632_034_828_9];
    assert_eq!(times.len(), 4);
    for (found, wanted) in times.iter().zip(wanted) {
        assert!((found - wanted).abs() < 1e-10, "{found} {wanted}");
    }
    near(orbit.extents[0], 24.934_22, 2e-7);
    near(orbit.extents[1], 24.336_72, 2e-7);
    let wanted = [[0.618_60, 0.0], [-0.008_72, 0.342_44], [-0.008_72, -0.342_44]];
    for (found, wanted) in orbit.multipliers.iter().zip(wanted) {
        assert!((found[0] - wanted[0]).hypot(found[1] - wanted[1]) < 1e-5, "{found:?} {wanted:?}");
    }
    assert_eq!((orbit.multipliers.len(), orbit.zeros), (3, 3));
}

/// Den Hartog (1931): with a = P/k, x_f = µ N/k and β = ω/ω₀ the motion without stops has the amplitude
/// a √(V² − (x_f/a)² U²), V = 1/(1 − β²), U = sin(π/β) / (β (1 + cos(π/β))).
#[test]
fn den_hartogs_oscillator_has_the_amplitude_of_its_closed_form() {
    let scene = scene("den_hartog", 1e-2, &[]);
    let orbit = orbit(&mut after(scene, 40.0), Some(0.4), 0.4);
    let beta = 2.0 * PI * 2.5 / 20.0;
    let (a, slack) = (10.0 / 400.0, 0.3);
    let v = 1.0 / (1.0 - beta * beta);
    let u = (PI / beta).sin() / (beta * (1.0 + (PI / beta).cos()));
    near(orbit.extents[0], a * (v * v - slack * slack * u * u).sqrt(), 1e-12);
}

/// A block on a belt with m = 1 kg, ω₀ = 10 rad/s, µ_s − µ_k = 0.2 under 10 N: a = 0.02 m.
fn belt(velocity: f64, zeta: f64) -> Scene {
    let text = format!(
        "[slider]\nvelocity = {velocity:?}\nangle = 0.0\n[friction]\ncoefficient = 0.3\nstatic = 0.5\n\
         [[mass]]\nname = \"block\"\nmass = 1.0\nforce = [0.0, -10.0]\n\
         [[spring]]\nname = \"k\"\nbetween = [\"block\", \"ground\"]\ndirection = \"x\"\nstiffness = 100.0\n\
         [[damper]]\nname = \"c\"\nbetween = [\"block\", \"ground\"]\ndirection = \"x\"\ndamping = {:?}\n\
         [[contact]]\nname = \"belt\"\nmass = \"block\"\n\
         [[initial]]\nmass = \"block\"\nvx = {velocity:?}\n\
         [integrator]\nmethod = \"event-driven\"\nstep = 0.01\n",
        2.0 * zeta * 10.0
    );
    parse("belt", &text).unwrap()
}

#[test]
fn stick_slip_without_damping_has_its_closed_period_and_no_multiplier_but_one() {
    let velocity = 0.1;
    let orbit = orbit(&mut after(belt(velocity, 0.0), 10.0), None, 4.0);
    let wanted = (PI + 2.0 * (velocity / 0.2_f64).atan()) / 10.0 + 2.0 * 0.02 / velocity;
    near(orbit.period, wanted, 1e-13);
    assert!((orbit.along.unwrap() - 1.0).abs() < 1e-9);
    // One direction is along the motion; stick and the closed contact take the other three.
    assert_eq!((orbit.multipliers.len(), orbit.zeros), (0, 3));
}

/// The slip arc of the block returns tangentially to the velocity of the belt at these values of v/(ω₀ a): there the
/// branch ends, with a multiplier that is not 1.
#[test]
fn stick_slip_ends_where_slip_returns_tangentially_to_the_belt() {
    for (zeta, wanted) in [(0.01, 2.739_240_416_787_7), (0.05, 1.098_092_624_115_9)] {
        let speed = 0.2;
        let scene = belt(0.5 * wanted * speed, zeta);
        let (_, chain, _) = solved(&mut after(scene.clone(), 20.0), None, 4.0).unwrap();
        let branch = follow(&scene, "slider.velocity", [0.02, 2.0 * wanted * speed], &chain);
        let last = branch.points.last().unwrap();

        near(last.parameter / speed, wanted, 1e-10);
        assert!(
            matches!(branch.ends, [BranchEnd::Range, BranchEnd::Grazing(..)]),
            "{:?}",
            branch.ends
        );
        assert!(branch.specials.is_empty(), "{:?}", branch.specials);
        assert!(last.orbit.largest_multiplier() < 0.5);
    }
}

/// A mass on a spring, lifted to the distance d above a stop, under A sin(ω t): it reaches the stop where
/// A = d √((k − m ω²)² + (c ω)²).
#[test]
fn a_forced_mass_grazes_a_stop_on_the_curve_of_its_linear_response() {
    let (mass, k, c, amplitude): (f64, f64, f64, f64) = (1.0, 100.0, 1.0, 3.0);
    for omega in [4.0, 8.0, 12.0, 17.0] {
        let d = amplitude / ((k - mass * omega * omega).powi(2) + (c * omega).powi(2)).sqrt();
        let text = format!(
            "[slider]\nvelocity = 0.0\nangle = 0.0\n[friction]\ncoefficient = 0.0\n\
             [[mass]]\nname = \"m\"\nmass = {mass:?}\nforce = [0.0, -1.0]\n\
             [[spring]]\nname = \"k\"\nbetween = [\"m\", \"ground\"]\ndirection = \"y\"\nstiffness = {k:?}\n\
             [[damper]]\nname = \"c\"\nbetween = [\"m\", \"ground\"]\ndirection = \"y\"\ndamping = {c:?}\n\
             [[spring]]\nname = \"side\"\nbetween = [\"m\", \"ground\"]\ndirection = \"x\"\nstiffness = 50.0\n\
             [[damper]]\nname = \"slow\"\nbetween = [\"m\", \"ground\"]\ndirection = \"x\"\ndamping = 1.0\n\
             [[contact]]\nname = \"stop\"\nmass = \"m\"\n\
             [inputs]\nforces = \"input\"\n\
             [[signal]]\ninput = \"mass.m.fy\"\nsine = {{ amplitude = {amplitude:?}, frequency = {:?} }}\n\
             [integrator]\nmethod = \"event-driven\"\nstep = 0.01\n",
            omega / (2.0 * PI)
        );
        let mut scene = parse("stop", &text).unwrap_or_else(|error| panic!("{error}"));
        let (load, lift) = (1.0, "mass.m.fy");
        assign(&mut scene, lift, load + 2.0 * k * d).unwrap();
        let period = 2.0 * PI / omega;
        let mut simulation = after(scene.clone(), (40.0 / period).ceil() * period);
        let (orbit, chain, _) = solved(&mut simulation, Some(period), period).unwrap();
        assert!(orbit.events.is_empty());
        near(orbit.extents[1], d, 1e-12);
        let branch = follow(&scene, lift, [load + 0.9 * k * d, load + 3.0 * k * d], &chain);
        // The change that is nearest to the motion in the air; or the branch ends there.
        let change = branch.specials.last().map(|special| special.parameter);
        let first = change.unwrap_or(branch.points[0].parameter);
        near((first - load) / k, d, 1e-12);
    }
}

/// A mass on a spring at a distance from a stop, under a sine: as a gap of the contact, and as a force that lifts the mass
/// off a stop on which it lies.
#[test]
fn a_stop_at_a_gap_has_the_orbit_of_a_mass_that_a_force_holds_off_its_stop() {
    let (gap, k, omega) = (0.03, 100.0, 13.0);
    let text = |load: f64, gap: f64| {
        format!(
            "[slider]\nvelocity = 0.5\nangle = 0.0\n[friction]\ncoefficient = 0.3\n\
             [[mass]]\nname = \"m\"\nmass = 1.0\nforce = [0.0, {load:?}]\n\
             [[spring]]\nname = \"k\"\nbetween = [\"m\", \"ground\"]\ndirection = \"y\"\nstiffness = {k:?}\n\
             [[damper]]\nname = \"c\"\nbetween = [\"m\", \"ground\"]\ndirection = \"y\"\ndamping = 1.0\n\
             [[spring]]\nname = \"side\"\nbetween = [\"m\", \"ground\"]\ndirection = \"x\"\nstiffness = 50.0\n\
             [[damper]]\nname = \"slow\"\nbetween = [\"m\", \"ground\"]\ndirection = \"x\"\ndamping = 2.0\n\
             [[contact]]\nname = \"stop\"\nmass = \"m\"\ngap = {gap:?}\n\
             [inputs]\nforces = \"input\"\n\
             [[signal]]\ninput = \"mass.m.fy\"\nsine = {{ amplitude = 3.0, frequency = {:?} }}\n\
             [integrator]\nmethod = \"event-driven\"\nstep = 0.01\n",
            omega / (2.0 * PI)
        )
    };
    let period = 2.0 * PI / omega;
    let found = |scene: Scene| {
        let mut simulation = after(scene, (60.0 / period).ceil() * period);
        let own = simulation.reference().gap[0];
        (own, solved(&mut simulation, Some(period), period).unwrap())
    };
    let (own, (with_gap, chain, mut flow)) = found(parse("gap", &text(0.0, gap)).unwrap());
    assert_eq!(own, gap);
    let mut lifted = parse("lifted", &text(-1.0, 0.0)).unwrap();
    assign(&mut lifted, "mass.m.fy", 1.0 + k * gap).unwrap();
    let (own, (with_force, ..)) = found(lifted);
    assert_eq!(own, 0.0);
    let lands = |orbit: &Orbit| {
        orbit.events.iter().flat_map(|instant| &instant.events).any(|of| of.1 == Event::Touch)
    };
    assert!(lands(&with_gap) && with_gap.events.len() == with_force.events.len());
    for (a, b) in with_gap.extents.iter().zip(&with_force.extents) {
        near(*a, *b, 1e-9);
    }
    for (a, b) in with_gap.multipliers.iter().zip(&with_force.multipliers) {
        assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 1e-9, "{a:?} {b:?}");
    }
    has_multipliers_of_differences(&with_gap, &chain, &mut flow, &[0, 1, 2, 3]);
}

/// Central differences of runs of the event-driven integrator over a period, in the directions that contacts leave free
/// at the start; the start is in the middle of a segment.
fn by_differences(flow: &mut Flow, chain: &Chain, free: &[usize]) -> Vec<(f64, f64)> {
    let segments = chain.segments.iter().enumerate();
    let (place, longest) = segments.max_by(|a, b| a.1.duration.total_cmp(&b.1.duration)).unwrap();
    let states = longest.states.clone();
    let middle = flow.propagate(&states, &longest.start, 0.5 * longest.duration).unwrap();
    let before: f64 = chain.segments[..place].iter().map(|segment| segment.duration).sum();
    let time = flow.time_of(chain.turn) + before + 0.5 * longest.duration;
    let (dofs, period) = (flow.dofs(), chain.period());
    let scales = chain.scales;
    let mut run = |place: usize, off: f64| -> Motion {
        let mut y = middle.clone();
        y[place] += off;
        let motion = flow.motion(&y, &states);
        flow.run(&motion, time, period, |_| true).unwrap().0
    };
    let unit = |place: usize| scales[usize::from(place >= dofs)];
    let value = |motion: &Motion, place: usize| {
        if place < dofs { motion.displacement[place] } else { motion.velocity[place - dofs] }
    };
    let mut matrix = DMatrix::zeros(free.len(), free.len());
    for (column, &place) in free.iter().enumerate() {
        let off = 1e-6 * unit(place);
        let [low, high] = [-off, off].map(|off| run(place, off));
        for (row, &other) in free.iter().enumerate() {
            let change = value(&high, other) - value(&low, other);
            matrix[(row, column)] = change / (2.0 * off) * unit(place) / unit(other);
        }
    }
    let values = amontons::stability::eigenvalues(matrix).unwrap();
    let mut values: Vec<(f64, f64)> = values.iter().map(|value| (value.re, value.im)).collect();
    values.sort_by(|a, b| b.0.hypot(b.1).total_cmp(&a.0.hypot(a.1)));
    values
}

/// Holds the multipliers of an orbit, and that along it, against central differences in these places of the state.
pub fn has_multipliers_of_differences(
    orbit: &Orbit,
    chain: &Chain,
    flow: &mut Flow,
    free: &[usize],
) {
    let mut differences = by_differences(flow, chain, free);
    let mut wanted: Vec<[f64; 2]> = orbit.multipliers.clone();
    wanted.extend(orbit.along.map(|along| [along, 0.0]));
    for [re, im] in wanted {
        let off = |found: &&(f64, f64)| (found.0 - re).hypot(found.1 - im);
        let nearest = differences.iter().min_by(|a, b| off(a).total_cmp(&off(b))).copied().unwrap();
        assert!(off(&&nearest) < 1e-5, "{re} {im}: {differences:?}");
        differences.retain(|value| *value != nearest);
    }
    assert!(differences.iter().all(|value| value.0.hypot(value.1) < 1e-5), "{differences:?}");
}

/// Set 1 at v = 0.3 m/s slides, lifts off and lands; its contacts are never closed both.
#[test]
fn multipliers_of_lift_off_and_landing_are_those_of_differences() {
    let scene = scene("set1", 2e-4, &[("friction.coefficient", 1.5), ("slider.velocity", 0.3)]);
    let (orbit, chain, mut flow) = solved(&mut after(scene, 4.0), None, 0.1).unwrap();
    let longest = chain.segments.iter().max_by(|a, b| a.duration.total_cmp(&b.duration)).unwrap();
    let closed: Vec<usize> = (0..2)
        .filter(|contact| longest.states[*contact] != amontons::contact::ContactState::Detached)
        .map(|contact| 4 * contact + 3)
        .collect();
    let free: Vec<usize> = (0..16).filter(|place| !closed.contains(&(place % 8))).collect();
    assert!(orbit.along.is_some_and(|along| (along - 1.0).abs() < 1e-9), "{:?}", orbit.along);
    has_multipliers_of_differences(&orbit, &chain, &mut flow, &free);
}

/// Amplitude of the first displacement, m, and period, s, of a run over its next four periods of about this length.
fn next_periods(simulation: &mut Simulation, period: f64) -> [f64; 2] {
    const ROWS: usize = 4000;
    let (begin, apart) = (simulation.time(), 5.5 * period / ROWS as f64);
    let rows = (0..=ROWS).map(|row| {
        simulation.advance_to(begin + apart * row as f64).unwrap();
        simulation.displacement()[0]
    });
    let rows: Vec<f64> = rows.collect();
    let least = rows.iter().copied().fold(f64::INFINITY, f64::min);
    let most = rows.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mean = f64::midpoint(least, most);
    let rises = (1..rows.len()).filter(|&i| rows[i - 1] < mean && mean <= rows[i]);
    let rises: Vec<f64> =
        rises.map(|i| apart * (i as f64 - (rows[i] - mean) / (rows[i] - rows[i - 1]))).collect();
    assert!(rises.len() > 4, "{rises:?}");
    [0.5 * (most - least), (rises[4] - rises[0]) / 4.0]
}

/// Set 2 at µ = 1.96 rests or squeals, by its push. Between the two is an unstable orbit: two runs whose pushes differ in
/// the last digits stay near it, until one comes to rest and the other squeals.
#[test]
fn the_unstable_orbit_of_set_2_is_on_the_boundary_between_rest_and_squeal() {
    let run = |push: f64| {
        let scene = scene("set2", 2e-4, &[("initial.module[1].v2", push)]);
        Simulation::new(scene, 0.0).unwrap()
    };
    let mut orbit_of_run = run(0.232_832_485_487_8);
    let orbit = orbit(&mut orbit_of_run, None, 2.0);
    assert_eq!(orbit.is_stable(), Some(false));
    assert_eq!(orbit.multipliers.iter().filter(|value| value[0].hypot(value[1]) > 1.0).count(), 1);
    // `study orbit set2 --between 'module[1].v2=0.1:0.5'` bisects to these.
    for (push, comes_to_rest) in [(0.232_832_485_487_77, true), (0.232_832_485_487_95, false)] {
        let mut run = run(push);
        for time in [0.5, 0.8, 1.1] {
            run.advance_to(time).unwrap();
            let [amplitude, period] = next_periods(&mut run, orbit.period);
            let off = [amplitude / orbit.extents[0] - 1.0, period / orbit.period - 1.0];
            assert!(off.iter().all(|off| off.abs() < 2e-5), "{off:?} at {time} s, push {push}");
        }
        run.advance_to(20.0).unwrap();
        let largest = (0..100).map(|i| {
            run.advance_to(20.0 + f64::from(i) * orbit.period / 100.0).unwrap();
            run.displacement()[0].abs()
        });
        let largest = largest.fold(0.0, f64::max) / orbit.extents[0];
        assert!(
            if comes_to_rest { largest < 0.5 } else { largest > 1.2 },
            "{largest}, push {push}"
        );
    }
}

#[test]
fn the_branch_of_set_2_turns_at_both_folds_and_begins_at_the_largest_neutral_cycle() {
    let scene = scene("set2", 2e-4, &[("initial.module[1].v2", 0.5)]);
    let branch =
        followed(&scene, "friction.coefficient", [1.9, 2.2], &mut after(scene.clone(), 4.0));
    let folds: Vec<f64> = branch
        .specials
        .iter()
        .filter(|special| special.kind == SpecialKind::Fold)
        .map(|special| special.parameter)
        .collect();
    // A quasi-static sweep loses the motions here: falling at 1.93184, rising at 2.07496.
    assert_eq!(folds.len(), 2, "{folds:?}");
    let (low, high) = (folds[0].min(folds[1]), folds[0].max(folds[1]));
    assert!((low - 1.931_84).abs() < 1e-4 && (high - 2.074_96).abs() < 1e-4, "{folds:?}");
    let linear = branch.ends.iter().position(|end| *end == BranchEnd::Linear).unwrap();
    let first = if linear == 0 { &branch.points[0] } else { branch.points.last().unwrap() };
    // The eigenvalue, and the amplitude at which its mode makes a contact stick.
    near(first.parameter, 2.062_565_530_6, 1e-8);
    near(first.orbit.extents[0], 1.183_000e-4, 1e-5);
    for fold in branch.specials.iter().filter(|special| special.kind == SpecialKind::Fold) {
        let nearest = fold.orbit.multipliers.iter().map(|[re, im]| (re - 1.0).hypot(*im));
        assert!(nearest.fold(f64::INFINITY, f64::min) < 1e-3);
    }
}

#[test]
fn the_motion_of_set_1_changes_its_events_at_two_velocities_and_slides_beyond() {
    let values = [("friction.coefficient", 1.5), ("slider.velocity", 0.3)];
    let scene = scene("set1", 2e-4, &values);
    let branch = followed(&scene, "slider.velocity", [0.01, 0.4], &mut after(scene.clone(), 4.0));
    assert_eq!(branch.ends, [BranchEnd::Range; 2]);
    let changes: Vec<f64> = branch
        .specials
        .iter()
        .filter(|special| matches!(special.kind, SpecialKind::Sequence(_)))
        .map(|special| special.parameter)
        .collect();
    for wanted in [0.0697, 0.2082] {
        assert!(changes.iter().any(|found| (found - wanted).abs() < 1e-4), "{changes:?}");
    }
    // Where no contact sticks the motion does not depend on the velocity.
    let last = branch.points.last().unwrap();
    near(last.orbit.extents[0], 6.534_83e-4, 1e-6);
    assert!(last.orbit.events.iter().all(|event| {
        event.events.iter().all(|(_, event)| matches!(event, Event::Lift | Event::Touch))
    }));
}

/// At 0.2082 m/s a contact stops tangentially: the parameter neither rises nor falls along the branch there. Its rounding once
/// made a fold of that place, behind which the branch was followed back to where it came from.
#[test]
fn a_branch_goes_on_behind_a_tangential_event_in_the_same_sense() {
    let values = [("friction.coefficient", 1.5), ("slider.velocity", 0.19)];
    let scene = scene("set1", 2e-4, &values);
    let (_, chain, _) = solved(&mut after(scene.clone(), 4.0), None, 0.2).unwrap();
    for k in 12..18 {
        let range = [0.15 - 0.001 * f64::from(k), 0.22];
        let branch = follow(&scene, "slider.velocity", range, &chain);
        let kinds: Vec<_> = branch.specials.iter().map(|special| special.kind).collect();
        assert!(
            kinds.iter().all(|kind| matches!(kind, SpecialKind::Sequence(_))),
            "{range:?}: {kinds:?}"
        );
        assert_eq!(branch.ends, [BranchEnd::Range; 2]);
        assert_eq!(branch.points.last().unwrap().parameter, 0.22);
        near(branch.specials.last().unwrap().parameter, 0.208_220_810_715, 1e-11);
    }
}

/// The place was where a magnitude passes 1 + 1e-9, beyond rounding. A multiplier that passes slowly is there 7e-9 of the
/// parameter later.
#[test]
fn a_pair_of_multipliers_has_magnitude_one_where_its_passage_is_located() {
    let scene = scene("set1", 2e-4, &[("friction.coefficient", 1.86)]);
    let range = [1.8, 1.95];
    let branch = followed(&scene, "friction.coefficient", range, &mut after(scene.clone(), 6.0));
    let [special] = &branch.specials[..] else { panic!("{:?}", branch.specials.len()) };
    assert_eq!(special.kind, SpecialKind::NeimarkSacker);
    let off = special.orbit.largest_multiplier() - 1.0;
    assert!(off.abs() < 1e-12, "{off:e} at {}", special.parameter);
}

#[test]
fn what_is_no_orbit_is_named() {
    // A free oscillation has periodic motions of every size beside it.
    let mut scene = scene("set2", 2e-4, &[]);
    scene.rest();
    assign(&mut scene, "initial.module[1].v1", 1e-6).unwrap();
    let mut simulation = Simulation::new(scene, 0.0).unwrap();
    assert_eq!(solved(&mut simulation, None, 0.1).map(|_| ()), Err(NoOrbit::Linear));
    let mut paper = builtin("set1").unwrap().scene();
    paper.set_integrator(Some(amontons::scene::Method::ForwardIncrement), Some(1e-6)).unwrap();
    let error = Flow::of(&mut Simulation::new(paper, 0.0).unwrap()).err().unwrap().to_string();
    assert!(error.contains("event-driven"), "{error}");
}

/// A contact that is always closed holds its gap and its rate, although no event puts them to zero.
#[test]
fn a_driven_motion_without_any_event_is_an_orbit() {
    let text = "[slider]\nvelocity = 0.1\nangle = 0.0\n[friction]\ncoefficient = 0.3\n\
        [[mass]]\nname = \"block\"\nmass = 1.0\nforce = [0.0, -10.0]\n\
        [[spring]]\nname = \"k\"\nbetween = [\"block\", \"ground\"]\ndirection = \"x\"\nstiffness = 100.0\n\
        [[damper]]\nname = \"d\"\nbetween = [\"block\", \"ground\"]\ndirection = \"x\"\ndamping = 0.5\n\
        [[contact]]\nname = \"c\"\nmass = \"block\"\n\
        [[signal]]\ninput = \"mass.block.fx\"\nsine = { amplitude = 0.01, frequency = 1.0 }\n\
        [integrator]\nmethod = \"event-driven\"\nstep = 0.02\n";
    let orbit = orbit(&mut after(parse("sliding", text).unwrap(), 40.0), Some(1.0), 1.0);
    let omega = 2.0 * PI;
    let response = 0.01 / ((100.0 - omega * omega).powi(2) + (0.5 * omega).powi(2)).sqrt();
    near(orbit.extents[0], response, 1e-12);
    near(orbit.largest_multiplier(), (-0.25_f64).exp(), 1e-13);
    assert_eq!((orbit.multipliers.len(), orbit.zeros), (2, 2));
}

/// The contacts of the brake are between masses: what they hold are differences.
#[test]
fn contacts_between_masses_hold_their_directions_too() {
    let (orbit, ..) = solved(&mut after(scene("disc_brake", 2e-5, &[]), 1.0), None, 0.05).unwrap();
    assert_eq!(orbit.is_stable(), Some(true));
    assert!((orbit.along.unwrap() - 1.0).abs() < 1e-9);
    // Both gaps with their rates, and the slip of the one that sticks.
    assert_eq!((orbit.multipliers.len(), orbit.zeros), (4, 5));
}

/// Over this range an event passes the instant at which the period of the drive begins.
#[test]
fn a_branch_goes_on_where_an_event_passes_the_beginning_of_the_period() {
    let scene = scene("den_hartog", 1e-2, &[]);
    let (_, chain, _) = solved(&mut after(scene.clone(), 40.0), Some(0.4), 0.4).unwrap();
    let branch = follow(&scene, "friction.coefficient", [0.05, 0.98], &chain);
    assert_eq!(branch.ends, [BranchEnd::Range; 2]);
    // Sticking begins once; nothing else is special.
    assert_eq!(branch.specials.len(), 1, "{:?}", branch.specials);
    assert!(matches!(branch.specials[0].kind, SpecialKind::Sequence(Some((0, Event::Stop)))));
}

/// A slip that starts from rest under A sin(ω t) needs A > µ N: at 3 N the motion ends.
#[test]
fn a_branch_over_the_amplitude_of_a_force_ends_where_friction_holds_the_mass() {
    let scene = scene("den_hartog", 1e-2, &[]);
    let (_, chain, _) = solved(&mut after(scene.clone(), 40.0), Some(0.4), 0.4).unwrap();
    let branch = follow(&scene, "signal[1].amplitude", [1.0, 20.0], &chain);
    assert_eq!(branch.ends, [BranchEnd::NotConverged, BranchEnd::Range]);
    let first = &branch.points[0];
    assert!((3.0..3.001).contains(&first.parameter), "{}", first.parameter);
    assert!(first.orbit.extents[0] < 1e-9);
}

/// The orbit near the motion of a scene after a time (s), with the energy of one period.
fn with_energy(mut scene: Scene, time: f64, period: Option<f64>) -> (Orbit, OrbitEnergy) {
    scene.effects.energy = true;
    let mut simulation = after(scene, time);
    let orbit = orbit(&mut simulation, period, period.unwrap_or(4.0));
    let energy = OrbitEnergy::of(&orbit, &mut simulation).unwrap().unwrap();
    assert!(energy.residual.abs() < 1e-9 * (energy.slider + energy.forces), "{energy:?}");
    (orbit, energy)
}

/// In one period the block slips as far as the belt moves: friction takes µ N v T.
#[test]
fn friction_takes_the_way_of_the_belt_from_each_period_of_stick_slip() {
    for zeta in [0.0, 0.05] {
        let velocity = 0.1;
        let (orbit, energy) = with_energy(belt(velocity, zeta), 10.0, None);
        near(energy.friction, 0.3 * 10.0 * velocity * orbit.period, 1e-11);
        near(energy.slider, energy.friction + energy.damping, 1e-11);
        assert_eq!(energy.damping > 0.0, zeta > 0.0);
        assert_eq!((energy.impact, energy.forces), (0.0, 0.0));
    }
}

/// Without stops friction takes µ N over four amplitudes, all of it from the force that drives the motion.
#[test]
fn friction_takes_four_amplitudes_of_way_from_the_force_of_den_hartogs_oscillator() {
    let (orbit, energy) = with_energy(scene("den_hartog", 1e-2, &[]), 40.0, Some(0.4));
    near(energy.friction, 3.0 * 4.0 * orbit.extents[0], 1e-11);
    near(energy.forces, energy.friction, 1e-11);
    assert_eq!((energy.impact, energy.slider, energy.damping), (0.0, 0.0, 0.0));
}

/// The orbit begins just after an event, so a period that began there could miss a landing at its end.
#[test]
fn the_energy_of_a_period_with_impacts_has_each_of_them_once() {
    let values = [("friction.coefficient", 1.5), ("slider.velocity", 0.3)];
    let mut scene = scene("set1", 2e-4, &values);
    scene.effects.energy = true;
    let mut simulation = after(scene, 4.0);
    let orbit = orbit(&mut simulation, None, 0.1);
    let energy = OrbitEnergy::of(&orbit, &mut simulation).unwrap().unwrap();
    assert!(energy.residual.abs() < 1e-9 * energy.slider, "{energy:?}");
    assert!(energy.impact > 1e-3 * energy.slider, "{energy:?}");
}

#[test]
fn a_scene_without_a_ledger_has_no_energy_of_a_period() {
    let mut simulation = after(scene("den_hartog", 1e-2, &[]), 40.0);
    let orbit = orbit(&mut simulation, Some(0.4), 0.4);
    assert_eq!(OrbitEnergy::of(&orbit, &mut simulation).unwrap(), None);
}

#[test]
fn a_failed_step_is_told_with_the_name_of_its_contact() {
    let simulation = Simulation::new(scene("set2", 2e-4, &[]), 0.0).unwrap();
    assert_eq!(
        NoOrbit::Failed(StepFailure::Wedged { contact: 1 }).words(&simulation),
        "the motion cannot be followed: friction wedges contact[2]: no contact force satisfies its law; lower \
         friction.coefficient"
    );
}
