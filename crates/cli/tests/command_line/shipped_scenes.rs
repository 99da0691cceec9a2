//! The built-in scenes: each of them runs, and does what its closed form says.

use crate::program::{folder, run, text};
use amontons::contact::ContactState::{self, Detached, ReverseSlide, Slide, Stick};
use amontons::model::LumpedModel;
use amontons::scene::{BUILTIN, Method, Scene, builtin};
use amontons::simulation::{Simulation, variables};
use amontons_analysis::assign::assign;
use amontons_analysis::stability::Linearised;
use amontons_analysis::stability::locus::{ALL_FREQUENCIES, Locus, locus};
use amontons_analysis::warning::step_warning;
use amontons_export::package::{self, Library};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::path::Path;

/// A built-in scene with some values changed, by the names of the FMU.
fn scene(name: &str, values: &[(&str, f64)]) -> Scene {
    let mut scene = builtin(name).unwrap().scene();
    for (name, value) in values {
        assign(&mut scene, name, *value).unwrap();
    }
    scene
}

fn simulation(scene: &Scene) -> Simulation {
    Simulation::new(scene.clone(), 0.0).unwrap()
}

fn read(simulation: &mut Simulation, name: &str) -> f64 {
    let variables = variables(simulation.scene());
    let variable = variables.iter().find(|variable| variable.name == name).unwrap();
    simulation.read(variable).unwrap()
}

/// Values of a variable at every internal step up to `end`, s, with their times.
fn history(simulation: &mut Simulation, name: &str, end: f64) -> Vec<(f64, f64)> {
    let variables = variables(simulation.scene());
    let variable = variables.iter().find(|variable| variable.name == name).unwrap();
    let step = simulation.scene().step;
    let mut points = Vec::new();
    while simulation.time() < end - 0.5 * step {
        let next = simulation.time() + step;
        simulation.advance_to(next).unwrap();
        points.push((simulation.time(), simulation.read(variable).unwrap()));
    }
    points
}

/// Times at which a contact changes its state, with the new states.
fn state_changes(simulation: &mut Simulation, contact: &str, end: f64) -> Vec<(f64, f64)> {
    let name = format!("contact.{contact}.state");
    let mut now = read(simulation, &name);
    let mut states = history(simulation, &name, end);
    states.retain(|&(_, state)| std::mem::replace(&mut now, state) != state);
    states
}

fn number(state: ContactState) -> f64 {
    f64::from(state as u8)
}

/// The locus of uniform sliding over µ.
fn over_friction(scene: &Scene, states: &[ContactState], last: f64) -> Locus {
    let model = LumpedModel::from(scene);
    let values: Vec<f64> = (0..=100).map(|i| 0.01 * last * f64::from(i)).collect();
    let model_at = |mu: f64| Ok(Linearised::from(model.clone().with_friction(mu)));
    locus(&model_at, states, &values, ALL_FREQUENCIES, &|_, _| {}).unwrap()
}

/// Asserts that a value is as near to the expected one as told.
#[track_caller]
fn assert_near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} is not {expected} ± {tolerance:e}");
}

#[test]
fn every_scene_packages_starts_runs_and_has_a_step_that_goes_with_it() {
    for builtin in BUILTIN {
        let scene = builtin.scene();
        assert!(
            package::fmu(&scene, &builtin.text.into(), None, Library::carried())
                .unwrap()
                .starts_with(b"PK"),
            "{}",
            builtin.name
        );
        assert_eq!(step_warning(&scene), None, "{}", builtin.name);
        let mut simulation = simulation(&scene);
        simulation.advance_to(1000.0 * scene.step).unwrap();
        assert_eq!(simulation.statistics().steps, 1000, "{}", builtin.name);
        assert!(simulation.contact_forces().unwrap().iter().all(|f| f.normal_force >= 0.0));
    }
}

#[test]
fn every_scene_is_explained_with_a_drawing_of_what_it_is_now() {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let readme = std::fs::read_to_string(scenes.join("README.md")).unwrap();
    let folder = folder();
    // The description of the picture in words; the positions of its parts may change with the layout.
    let words =
        |svg: &str| svg.split("<desc>").nth(1).unwrap().split("</desc>").next().unwrap().to_owned();
    for builtin in BUILTIN {
        let figure = format!("figures/{}.svg", builtin.name);
        for part in [format!("\n## {}\n", builtin.name), format!("]({figure})")] {
            assert!(readme.contains(&part), "{part} is missing in scenes/README.md");
        }
        let draw = ["scenes", "draw", builtin.name, "-o", "now.svg"];
        let output = run(env!("CARGO_BIN_EXE_amontons"), folder.path(), &draw);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let [kept, now] = [scenes.join(&figure), folder.path().join("now.svg")]
            .map(|file| words(&std::fs::read_to_string(file).unwrap()));
        assert_eq!(kept, now, "draw scenes/{figure} anew: amontons scenes draw {}", builtin.name);
    }
}

// ---- belt: m = 1, k = 100, µ = 0.4, N = 10, v = 0.1 ----

const BELT_OMEGA: f64 = 10.0;
const BELT_VELOCITY: f64 = 0.1;

#[test]
fn a_mass_on_a_belt_slips_where_the_spring_carries_friction_and_then_just_touches_the_belt() {
    let mut simulation = simulation(&scene("belt", &[]));
    let (h, offset) = (simulation.scene().step, 0.4 * 10.0 / 100.0);
    assert_near(simulation.reference().displacement[0], offset, 1e-15);
    assert_eq!(read(&mut simulation, "contact.belt.state"), number(Stick));
    let slips = state_changes(&mut simulation, "belt", 0.5)[0];
    assert_eq!(slips.1, number(Slide));
    // It goes with the belt from the slack spring on.
    assert_near(slips.0, offset / BELT_VELOCITY, 2.0 * h);

    simulation.advance_to(1.0).unwrap();
    let last = history(&mut simulation, "mass.block.x", 3.0);
    let largest = last.iter().fold(f64::MIN, |most, point| most.max(point.1));
    let least = last.iter().fold(f64::MAX, |least, point| least.min(point.1));
    let expected = BELT_VELOCITY / BELT_OMEGA;
    // The scheme keeps v² + ω² x² − h ω² x v, so the amplitude is off in second order; where it slips
    // is off by up to v h, along the motion.
    let tolerance = expected * (h * BELT_OMEGA).powi(2);
    assert_near(largest, expected, tolerance);
    assert_near(least, -expected, tolerance);
}

#[test]
fn a_larger_oscillation_on_a_belt_is_caught_by_it_and_let_go_at_its_velocity() {
    let from = -0.06_f64;
    let values = [("initial.mass.block.x", from), ("initial.mass.block.vx", 0.0)];
    let scene = scene("belt", &values);
    let (h, reach) = (scene.step, BELT_VELOCITY / BELT_OMEGA);
    // It slides as x = from cos ωt until it is as fast as the belt, and goes with it up to x = 0.
    let caught = (reach / -from).asin() / BELT_OMEGA;
    let let_go = caught + (from * from - reach * reach).sqrt() / BELT_VELOCITY;
    let changes = state_changes(&mut simulation(&scene), "belt", let_go + 0.1);
    assert_eq!([changes[0].1, changes[1].1], [Stick, Slide].map(number), "{changes:?}");
    assert_near(changes[0].0, caught, 2.0 * h);
    assert_near(changes[1].0, let_go, 4.0 * h);
}

// ---- den_hartog: m = 1, k = 400, µ N = 3, force 10 sin(2π 2.5 t) ----

/// Den Hartog's motion without stops (1931): x = X at t = 0, at its largest, and −X half a period
/// later, under the force F cos(Ωt + φ). In units of F / k, with ω t = τ, r = Ω / ω, f = µN / F:
/// x = f (1 − cos τ) + (b / r) sin τ + Q cos(rτ + φ) with Q = 1 / (1 − r²).
struct WithoutStops {
    r: f64,
    f: f64,
    /// Q = 1 / (1 − r²).
    q: f64,
    /// S = sin(π/r) / (r (1 + cos(π/r))).
    s: f64,
}

impl WithoutStops {
    fn new(r: f64, f: f64) -> Self {
        let s = (PI / r).sin() / (r * (1.0 + (PI / r).cos()));
        Self { r, f, q: 1.0 / (1.0 - r * r), s }
    }

    /// X = √(Q² − (f S)²).
    fn amplitude(&self) -> f64 {
        (self.q * self.q - (self.f * self.s).powi(2)).sqrt()
    }

    /// φ: sin φ = −f S / Q, cos φ = X / Q.
    fn phase(&self) -> f64 {
        (-self.f * self.s / self.q).atan2(self.amplitude() / self.q)
    }

    /// ẋ / ω and ẍ / ω² at τ.
    fn motion(&self, tau: f64) -> [f64; 2] {
        let (free, forced) = (self.q * self.r * self.phase().sin(), self.r * tau + self.phase());
        let (sin, cos) = tau.sin_cos();
        [
            self.f * sin + free * cos - self.q * self.r * forced.sin(),
            self.f * cos - free * sin - self.q * self.r * self.r * forced.cos(),
        ]
    }
}

#[test]
fn den_hartogs_mass_swings_without_stops_in_his_amplitude_and_phase() {
    let (omega, drive, force, stiffness) = (20.0, TAU * 2.5, 10.0, 400.0);
    let exact = WithoutStops::new(drive / omega, 0.3);
    // It does not stop on the way down, which takes τ = π / r, and reverses without a stop.
    let half = PI / exact.r;
    assert!((1..1000).all(|i| exact.motion(1e-3 * half * f64::from(i))[0] < 0.0));
    assert!(exact.motion(0.0)[0].abs() < 1e-15 && exact.motion(half)[0].abs() < 1e-12);
    assert!(exact.motion(0.0)[1] < -2.0 * exact.f, "friction that turns round cannot hold it");
    let amplitude = exact.amplitude() * force / stiffness;

    for step in [1e-4, 2.5e-5] {
        let mut simulation = simulation(&scene("den_hartog", &[("integrator.step", step)]));
        assert_eq!(read(&mut simulation, "contact.rail.state"), number(Stick));
        // After 40 of its periods of 0.4 s it has forgotten how it began.
        simulation.advance_to(16.0).unwrap();
        let points = history(&mut simulation, "mass.block.x", 16.4);
        let (time, largest) =
            points.into_iter().reduce(|a, b| if b.1 > a.1 { b } else { a }).unwrap();
        // Friction turns round up to a step late, which is a velocity of 2µN h / m, or 0.24 ω h of the
        // largest, and the next half periods remember it.
        assert_near(largest, amplitude, 0.5 * omega * step * amplitude);
        // sin(Ωt) = cos(Ωt − π/2), which is at φ when x is largest.
        let phase = (drive * time - FRAC_PI_2).rem_euclid(TAU) - exact.phase().rem_euclid(TAU);
        assert_near(phase, 0.0, 2.0 * drive * step);
    }

    // Exact motion takes the sine as straight within a step, which is of second order, as is what a step
    // may miss of the largest; it remembers nothing that rounding does not.
    for step in [1e-3, 1e-4] {
        let scene = Scene {
            method: Method::EventDriven,
            ..scene("den_hartog", &[("integrator.step", step)])
        };
        let mut simulation = simulation(&scene);
        simulation.advance_to(40.0).unwrap();
        let points = history(&mut simulation, "mass.block.x", 40.4);
        let largest = points.iter().fold(0.0, |most, point| f64::max(most, point.1));
        assert_near(largest, amplitude, 0.5 * (drive * step).powi(2) * amplitude);
    }
}

// ---- hoffmann ----

/// The two λ² of Hoffmann's model grow and decay as ± ω e^{±iφ}: the growth rate and the frequency,
/// rad/s, of λ² = −(a ± i b).
fn growth_and_frequency(a: f64, b: f64) -> (f64, f64) {
    let size = a.hypot(b);
    ((0.5 * (size - a)).sqrt(), (0.5 * (size + a)).sqrt())
}

/// Trace and discriminant of M̃⁻¹ K̃ of a mass m on springs K whose surface has the mass m_b and the
/// stiffness k3, by hand: m ẍ + µ m_b ÿ + k_xx x + (k_xy + µ k3) y = 0 and
/// (m + m_b) ÿ + k_xy x + (k_yy + k3) y = 0, since N = −k3 y − m_b ÿ.
fn two_modes([m, mb]: [f64; 2], [kxx, kxy, kyy, k3]: [f64; 4], mu: f64) -> (f64, f64) {
    let y = [kxy / (m + mb), (kyy + k3) / (m + mb)];
    let x = [(kxx - mu * mb * y[0]) / m, (kxy + mu * k3 - mu * mb * y[1]) / m];
    (x[0] + y[1], (x[0] - y[1]).powi(2) + 4.0 * x[1] * y[0])
}

/// k_xx, k_xy, k_yy of springs of 11 N/m at 30° and 20 N/m at 150°, and k3.
fn hoffmanns_stiffness() -> [f64; 4] {
    let (cc, cs, ss) = (0.75, 0.75_f64.sqrt() * 0.5, 0.25);
    [31.0 * cc, (11.0 - 20.0) * cs, 31.0 * ss, 20.0]
}

#[test]
fn hoffmanns_modes_merge_where_the_discriminant_of_their_closed_form_vanishes() {
    let scene = scene("hoffmann", &[]);
    let found = over_friction(&scene, &[Slide], 1.0);
    let [merging] = found.coalescences[..] else { panic!("{found:?}") };
    let discriminant = |mu| two_modes([1.0, 0.01], hoffmanns_stiffness(), mu).1;
    assert!(discriminant(merging.value - 1e-9) > 0.0 && discriminant(merging.value + 1e-9) < 0.0);
    assert_eq!(found.crossings.len(), 1);
    assert!(scene.friction_coefficient > merging.value);
}

#[test]
fn hoffmanns_modes_merge_at_his_friction_where_the_surface_is_light() {
    let [kxx, kxy, kyy, k3] = hoffmanns_stiffness();
    // Without a surface's mass: µ = (k12 + (k11 − k22)² / (4 k12)) / k3 with k12 = −k_xy.
    let expected = (-kxy + (kxx - kyy - k3).powi(2) / (-4.0 * kxy)) / k3;
    let misses = [1e-4, 1e-5].map(|mass| {
        let found =
            over_friction(&scene("hoffmann", &[("mass.surface.mass", mass)]), &[Slide], 1.0);
        found.coalescences[0].value - expected
    });
    // The surface's inertia takes part in proportion to its mass: N = −k3 y − m_b ÿ, ω² m_b ≈ 27 m_b.
    assert!(misses[1].abs() < 27.0 / 20.0 * 1e-5, "{misses:?}");
    assert_near(misses[0] / misses[1], 10.0, 0.01);
}

#[test]
fn hoffmanns_mass_grows_at_the_rate_of_its_closed_form() {
    let scene = scene("hoffmann", &[]);
    let (trace, discriminant) =
        two_modes([1.0, 0.01], hoffmanns_stiffness(), scene.friction_coefficient);
    let (rate, omega) = growth_and_frequency(0.5 * trace, 0.5 * (-discriminant).sqrt());
    for method in [Method::ForwardIncrement, Method::EventDriven] {
        let mut simulation = simulation(&Scene { method, ..scene.clone() });
        // By then the decaying mode is gone; five periods later it still slides.
        simulation.advance_to(20.0).unwrap();
        let before = ["x", "y"].map(|axis| read(&mut simulation, &format!("mass.block.{axis}")));
        simulation.advance_to(20.0 + 5.0 * TAU / omega).unwrap();
        let after = ["x", "y"].map(|axis| read(&mut simulation, &format!("mass.block.{axis}")));
        assert_eq!(simulation.statistics().state_changes(), 0);
        let expected = (rate * 5.0 * TAU / omega).exp();
        // The remaining part of the decaying mode: e^{−2·20·rate}.
        let tolerance = expected * 4.0 * (-40.0 * rate).exp();
        for (before, after) in before.into_iter().zip(after) {
            assert_near(after / before, expected, tolerance);
        }
    }
}

// ---- corner: 30 N on the wall, 50 N on the floor ----

#[test]
fn the_forces_of_a_shaft_in_a_corner_are_those_of_its_closed_form() {
    let [fx, fy] = [30.0, 50.0];
    for mu in [0.0, 0.3, 0.59] {
        let simulation = simulation(&scene("corner", &[("friction.coefficient", mu)]));
        // The floor draws it to the right, the wall down: N = fy + µ W, W = fx − µ N.
        let [floor, wall] = [fy + mu * fx, fx - mu * fy].map(|force| force / (1.0 + mu * mu));
        let found = simulation.reference();
        for (found, expected) in found.normal_force.iter().zip([floor, wall]) {
            assert_near(*found, expected, 1e-12 * fy);
        }
        for (friction, normal) in found.friction_force.iter().zip(&found.normal_force) {
            assert_near(*friction, mu * normal, 1e-12 * fy);
        }
        assert!(found.displacement.iter().all(|x| x.abs() < 1e-15), "{found:?}");
    }
    let climbs = scene("corner", &[("friction.coefficient", 0.61)]);
    // The wall is open: kx x = µ fy − fx.
    let found = simulation(&climbs).reference().clone();
    assert_near(found.normal_force[0], fy, 1e-12 * fy);
    assert_eq!(found.normal_force[1], 0.0);
    assert_near(found.gap[1], (0.61 * fy - fx) / 5e3, 1e-15);
}

#[test]
fn a_shaft_knocked_off_the_wall_comes_back_after_its_flight_and_stays() {
    let mut simulation = simulation(&scene("corner", &[]));
    let (h, [fx, fy], mu) = (simulation.scene().step, [30.0, 50.0], 0.3);
    let (mass, kx, speed) = (2.0, 5e3, 0.1);
    // It slides along the floor, m ẍ + kx x = µ fy − fx, from x = 0 at its speed back to x = 0.
    let omega = f64::sqrt(kx / mass);
    let pull = (fx - mu * fy) / mass;
    let flight = 2.0 / omega * (speed * omega / pull).atan();
    assert_eq!(read(&mut simulation, "contact.wall.state"), number(Detached));
    assert_near(read(&mut simulation, "contact.floor.normal_force"), fy, 1e-12 * fy);
    let changes = state_changes(&mut simulation, "wall", 0.1);
    let [(landed, into)] = changes[..] else { panic!("{changes:?}") };
    assert_eq!(into, number(Slide));
    assert_near(landed, flight, 2.0 * h);
    // The touch-down takes all its speed; what is left are the forces of rest.
    for (name, expected) in [("mass.shaft.x", 0.0), ("mass.shaft.vx", 0.0), ("mass.shaft.vy", 0.0)]
    {
        assert_eq!(read(&mut simulation, name), expected, "{name}");
    }
    let floor = (fy + mu * fx) / (1.0 + mu * mu);
    assert_near(read(&mut simulation, "contact.floor.normal_force"), floor, 1e-9 * floor);
}

// ---- disc_brake: half of it is Hoffmann's model, with half of the disc as its surface ----

/// One pad's k_xx, k_xy, k_yy, with the strut at 45°, and half of the disc's stiffness, N/m.
const PAD: [f64; 4] = [15e6, 5e6, 25e6, 20e6];
/// A pad, and half of the disc, kg.
const HALVES: [f64; 2] = [0.3, 0.6];
const BRAKING: [ContactState; 2] = [Slide, ReverseSlide];

#[test]
fn the_pads_of_a_brake_press_themselves_on() {
    let simulation = simulation(&scene("disc_brake", &[]));
    let [kxx, kxy, ..] = PAD;
    let (mu, piston) = (0.6, 2000.0);
    // Both stay where the disc is; along it k_xx x = µ N, and N = piston + k_xy x.
    let normal = piston * kxx / (kxx - mu * kxy);
    let found = simulation.reference();
    for (contact, sense) in [1.0, -1.0].into_iter().enumerate() {
        assert_near(found.normal_force[contact], normal, 1e-12 * normal);
        assert_near(found.friction_force[contact], sense * mu * normal, 1e-12 * normal);
        assert_near(found.displacement[2 * contact], mu * normal / kxx, 1e-15);
    }
}

#[test]
fn a_brakes_wobbling_modes_merge_at_three_minus_the_root_of_six() {
    let merging = 3.0 - 6.0_f64.sqrt();
    let found = over_friction(&scene("disc_brake", &[]), &BRAKING, 1.0);
    let [merges] = found.coalescences[..] else { panic!("{found:?}") };
    assert_near(merges.value, merging, 1e-9);
    // There σ is half of the trace.
    let (trace, discriminant) = two_modes(HALVES, PAD, merging);
    assert_near(discriminant, 0.0, 1e-12 * trace * trace);
    // Re λ = −β σ / 2.
    let sigma = 0.5 * trace;
    let omega = (sigma - (0.5e-6 * sigma).powi(2)).sqrt();
    // The error is the square root of that of the merging.
    assert_near(merges.frequency_hz, omega / TAU, 1e-3);
}

#[test]
fn a_brake_begins_to_squeal_where_damping_no_longer_holds_its_merged_modes() {
    let beta = 1e-6;
    // λ² + βσλ + σ = 0 with σ = a ± ib has λ = iω where b = βω a and ω² = a / (1 − β²a).
    let excess = |mu: f64| {
        let (trace, discriminant) = two_modes(HALVES, PAD, mu);
        let a = 0.5 * trace;
        0.5 * (-discriminant).max(0.0).sqrt() - beta * a * (a / (1.0 - beta * beta * a)).sqrt()
    };
    let (mut below, mut above) = (3.0 - 6.0_f64.sqrt(), 0.6);
    assert!(excess(below) < 0.0 && excess(above) > 0.0);
    while above - below > 1e-12 {
        let middle = 0.5 * (below + above);
        if excess(middle) < 0.0 { below = middle } else { above = middle }
    }
    let found = over_friction(&scene("disc_brake", &[]), &BRAKING, 1.0);
    let [onset] = found.crossings[..] else { panic!("{found:?}") };
    assert_near(onset.value, below, 1e-9);
}

#[test]
fn a_brake_squeals_above_its_critical_friction_and_is_silent_below() {
    for (mu, squeals) in [(0.5, false), (0.6, true)] {
        let mut simulation = simulation(&scene("disc_brake", &[("friction.coefficient", mu)]));
        simulation.advance_to(0.1).unwrap();
        let states = simulation.statistics().state_changes();
        let size = history(&mut simulation, "mass.disc.y", 0.101);
        let size = size.iter().fold(0.0, |most, point| f64::max(most, point.1.abs()));
        // The push of 0.1 mm/s alone gives less than v / ω = 16 nm.
        assert_eq!((states > 0, size > 1.6e-8), (squeals, squeals), "{mu}: {states}, {size}");
    }
}

// ---- drive: seen from the nut of its screw, a damped mass on a spring ----

#[test]
fn a_table_goes_at_the_speed_of_its_nut_and_gives_way_to_a_reaction() {
    let [speed, mass, stiffness, damping, reaction]: [f64; 5] = [0.1, 4.0, 4e6, 400.0, -400.0];
    let mut simulation = simulation(&scene("drive", &[]));
    let slip = "contact.guide.slip_velocity";
    simulation.advance_to(1e-3).unwrap();
    assert_near(read(&mut simulation, slip), speed, 1e-15);
    let variables = variables(simulation.scene());
    let force = variables.iter().find(|variable| variable.name == "mass.table.fx").unwrap();
    simulation.write(force, reaction).unwrap();
    // m ü + c u̇ + k u = F from rest.
    let decay = 0.5 * damping / mass;
    let omega = (stiffness / mass - decay * decay).sqrt();
    for t in [1e-4, 1e-3, 5e-3, 2e-2] {
        simulation.advance_to(1e-3 + t).unwrap();
        let gives_way = reaction / (mass * omega) * (-decay * t).exp() * (omega * t).sin();
        assert_near(read(&mut simulation, slip), speed + gives_way, 1e-12);
    }
    simulation.advance_to(1.0).unwrap();
    assert_near(read(&mut simulation, slip), speed, 1e-12);
    assert_near(read(&mut simulation, "mass.table.x"), reaction / stiffness, 1e-15);
}
