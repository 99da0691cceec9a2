//! The scenes of single effects (`scenes/effects/`): each does what the closed form in its comment says.

use amontons::contact::ContactState::{self, Detached, ReverseSlide, Slide, Stick};
use amontons::scene::{Method, Scene, parse};
use amontons::simulation::Simulation;

const DAMPING: &str = include_str!("../../scenes/effects/damping.toml");
const LINKS: &str = include_str!("../../scenes/effects/links.toml");
const MODULES: &str = include_str!("../../scenes/effects/modules.toml");

fn simulation(text: &str) -> Simulation {
    Simulation::new(parse("effect", text).unwrap(), 0.0).unwrap()
}

/// The lines of a text but those that begin with one of these.
fn without(text: &str, beginnings: &[&str]) -> String {
    let is_kept = |line: &&str| !beginnings.iter().any(|beginning| line.starts_with(beginning));
    text.lines().filter(is_kept).map(|line| format!("{line}\n")).collect()
}

// ---- damping: m = 2, k = 800, k_c = 600, α = 0.4, β = 1e-3, d = 0.6 ----

/// Displacements of both masses at time `t` (s), the modes decaying with δ (1/s) of together and against.
fn decayed(decay: [f64; 2], t: f64) -> [f64; 2] {
    let modes = [(400.0, decay[0]), (1000.0, decay[1])].map(|(square, delta): (f64, f64)| {
        let omega = (square - delta * delta).sqrt();
        let (sin, cos) = (omega * t).sin_cos();
        0.005 * (-delta * t).exp() * (cos + delta / omega * sin)
    });
    [modes[0] + modes[1], modes[0] - modes[1]]
}

#[test]
fn each_part_of_the_damping_decays_by_its_own_decrement_and_none_where_it_is_not_given() {
    let damper = DAMPING.split("[[damper]]").nth(1).unwrap().split("\n\n").next().unwrap();
    let bare = DAMPING.replace(&format!("[[damper]]{damper}"), "");
    for (text, decay) in [
        (DAMPING.to_owned(), [0.4, 1.0]),
        (without(DAMPING, &["alpha"]), [0.2, 0.8]),
        (without(DAMPING, &["beta"]), [0.2, 0.5]),
        (bare.clone(), [0.4, 0.7]),
        (without(&bare, &["alpha", "beta", "[damping]"]), [0.0, 0.0]),
    ] {
        let mut simulation = simulation(&text);
        for i in 1..=60 {
            let t = 0.05 * f64::from(i);
            simulation.advance_to(t).unwrap();
            for (found, expected) in simulation.displacement().iter().zip(decayed(decay, t)) {
                assert!((found - expected).abs() < 1e-14, "{decay:?} at {t} s: {found} {expected}");
            }
        }
    }
}

// ---- links: ω² = 4000 of all alike, 6250 of waves ----

/// Displacement of m1 under a load (N/s) that grows from t = 0 up to 0.05 s, over 2 kg.
fn ramped(square: f64, rate: f64, t: f64) -> f64 {
    let omega = square.sqrt();
    let up = |t: f64| (t - (omega * t).sin() / omega) / square;
    rate / 2.0 * (up(t) - if t > 0.05 { up(t - 0.05) } else { 0.0 })
}

#[test]
fn a_driven_preload_sets_off_the_waves_of_linked_modules_and_moves_one_alone() {
    let rate = -1000.0 * 2e-3 / 0.05;
    // Without links all of the load is on the module itself.
    let alone = without(LINKS, &["k1", "k2"]);
    for (text, wave) in [(LINKS, 6250.0), (&*alone, 4000.0)] {
        let mut simulation = simulation(text);
        for i in 1..=100 {
            let t = 0.01 * f64::from(i);
            simulation.advance_to(t).unwrap();
            let (all, waves) = (ramped(4000.0, rate, t) / 3.0, ramped(wave, rate, t) / 3.0);
            let expected = [all + 2.0 * waves, all - waves, all - waves];
            for (module, expected) in simulation.displacement().chunks(4).zip(expected) {
                assert!((module[1] - expected).abs() < 1e-13, "{wave} at {t} s: {module:?}");
                assert!(module[0].abs() + module[2].abs() < 1e-13, "{module:?} slide evenly");
            }
        }
        assert_eq!(simulation.contact_states(), [Slide; 3]);
    }
}

#[test]
fn the_scheme_follows_a_driven_preload_in_second_order_where_nothing_rubs_or_damps() {
    // There it is the central difference of displacements, whose force is that of the middle.
    let scheme = LINKS.replace("method = \"event-driven\"\n", "");
    let error = |step: &str| {
        let text = scheme.replace("1.0e-2           # s\n\n[exp", &format!("{step}\n\n[exp"));
        let mut simulation = simulation(&text);
        assert_eq!(simulation.scene().method, Method::ForwardIncrement);
        simulation.advance_to(0.1).unwrap();
        let rate = -1000.0 * 2e-3 / 0.05;
        let expected = (ramped(4000.0, rate, 0.1) + 2.0 * ramped(6250.0, rate, 0.1)) / 3.0;
        (simulation.displacement()[1] - expected).abs()
    };
    let (coarse, fine) = (error("1.0e-5"), error("5.0e-6"));
    assert!((coarse / fine - 4.0).abs() < 0.05, "{coarse:e} {fine:e}");
}

// ---- modules ----

/// The scene with one of its modules alone, counted from 1.
fn alone(module: usize) -> String {
    let parts: Vec<&str> = MODULES.split("[[initial]]").collect();
    let own = format!("module = {module}\n");
    let mut text = parts[0].replace("modules = 3", "modules = 1");
    for part in &parts[1..] {
        let (initial, rest) = part.split_once("\n\n").unwrap();
        if initial.contains(&own) {
            text += &format!("[[initial]]{}\n\n", initial.replace(&own, "module = 1\n"));
        }
        if rest.contains("[integrator]") {
            text += rest;
        }
    }
    text
}

#[test]
fn modules_that_nothing_links_move_to_the_last_bit_as_each_does_alone() {
    let mut together = simulation(MODULES);
    let mut each: Vec<Simulation> = (1..=3).map(|module| simulation(&alone(module))).collect();
    let mut seen: Vec<ContactState> = Vec::new();
    for i in 1..=2000 {
        let t = 1e-4 * f64::from(i);
        together.advance_to(t).unwrap();
        for (module, alone) in each.iter_mut().enumerate() {
            alone.advance_to(t).unwrap();
            let own = 4 * module..4 * module + 4;
            let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<u64>>();
            assert_eq!(bits(&together.displacement()[own.clone()]), bits(alone.displacement()));
            assert_eq!(bits(&together.velocity()[own]), bits(alone.velocity()));
            assert_eq!(together.contact_states()[module], alone.contact_states()[0]);
        }
        seen.extend(together.contact_states());
    }
    // Else there were little to compare.
    assert!([Slide, ReverseSlide, Stick, Detached].iter().all(|state| seen.contains(state)));
    let moves = |scene: &Scene| scene.modules().iter().any(|m| m.velocity != [0.0; 4]);
    assert!(moves(each[0].scene()) && moves(each[1].scene()) && !moves(each[2].scene()));
    assert!(each[2].displacement().iter().all(|x| *x == 0.0));
}
