//! The analyser on networks: contacts with friction and velocity of their own, single dampers, masses
//! that only their contact carries.

use amontons::contact::ContactState::{Detached, ReverseSlide, Slide, Stick};
use amontons::model::LumpedModel;
use amontons::scene::{Scene, builtin, parse};
use amontons::stability::Spectrum;
use amontons_analysis::stability::candidates::{bistability, closed_at_rest};
use amontons_analysis::stability::locus::{ALL_FREQUENCIES, locus};
use amontons_analysis::stability::{Linearised, linearity_limit, modes};
use amontons_analysis::watch::Watch;

const MASS: f64 = 2.0;
const STIFFNESS: f64 = 800.0;

/// A mass pressed on the slider by its load alone, held along it by a spring.
fn pressed(contact: &str, more: &str) -> (Scene, LumpedModel) {
    turned(0.0, contact, more)
}

/// The mass of [`pressed`] with its axes turned, which couples them.
fn turned(angle: f64, contact: &str, more: &str) -> (Scene, LumpedModel) {
    let load = [-10.0 * angle.sin(), -10.0 * angle.cos()];
    let text = format!(
        "[slider]\nvelocity = 0.1\nangle = 0.0\n[friction]\ncoefficient = 0.5\n\
         [integrator]\nstep = 1e-5\n\
         [[mass]]\nname = \"pad\"\nmass = {MASS:?}\nangle = {angle:?}\n\
         force = {load:?}\n\
         [[spring]]\nname = \"hold\"\nbetween = [\"pad\", \"ground\"]\ndirection = \"x\"\n\
         stiffness = {STIFFNESS:?}\n[[contact]]\nname = \"c\"\nmass = \"pad\"\n{contact}{more}"
    );
    let scene = parse("pressed", &text).unwrap();
    let model = LumpedModel::from(&scene);
    (scene, model)
}

/// A second mass like the first, whose surface moves as told.
const SECOND: &str = "[[mass]]\nname = \"b\"\nmass = 1.0\nforce = [0.0, -3.0]\n[[spring]]\n\
    name = \"kb\"\nbetween = [\"b\", \"ground\"]\ndirection = \"x\"\nstiffness = 100.0\n[[contact]]\n\
    name = \"cb\"\nmass = \"b\"\n";

const DAMPER: &str =
    "[[damper]]\nname = \"d\"\nbetween = [\"pad\", \"ground\"]\ndirection = \"x\"\ndamping = 3.0\n";

#[test]
fn each_contact_slides_by_the_sign_of_its_own_velocity() {
    let (mut scene, _) = pressed("", &format!("{SECOND}velocity = -0.2\n"));
    let mut sliding = |velocity: f64| {
        scene.slider.velocity = velocity;
        Linearised::of(&scene).uniform_sliding()
    };
    assert_eq!(sliding(0.1).unwrap(), [Slide, ReverseSlide]);
    assert_eq!(sliding(-0.1).unwrap(), [ReverseSlide; 2]);
    // The second contact slides all the same.
    let error = sliding(0.0).unwrap_err().to_string();
    assert!(error.contains("surface under contact 1 stands still"), "{error}");
}

#[test]
fn a_contact_whose_surface_stands_still_rests_stuck_and_does_not_slide() {
    let (_, model) = pressed("", &format!("{SECOND}velocity = 0.0\n"));
    assert_eq!(closed_at_rest(&model), [Slide, Stick]);
    let error = Linearised::from(model).uniform_sliding().unwrap_err().to_string();
    assert!(error.contains("surface under contact 2 stands still"), "{error}");
}

#[test]
fn a_mass_that_only_its_contact_carries_flies_off_and_does_not_grow() {
    for damper in ["", DAMPER] {
        let (_, model) = turned(0.2, "", damper);
        let found = Spectrum::of(model.linear().unwrap(), &[Detached]).unwrap();
        assert_eq!((&found.real[..], found.unstable()), (&[0.0, 0.0][..], false), "{damper}");
        let rate = if damper.is_empty() { 0.0 } else { -0.5 * 3.0 / MASS };
        let omega = (STIFFNESS / MASS - rate * rate).sqrt();
        let [lambda] = found.oscillating[..] else { panic!("{found:?}") };
        assert!((lambda.re - rate).abs() < 1e-9 && (lambda.im - omega).abs() < 1e-9, "{lambda}");
        assert!(!modes(model.linear().unwrap(), &[Detached]).unwrap().unstable());
    }
}

#[test]
fn a_mode_that_no_damper_sees_neither_grows_nor_decays() {
    for angle in [0.1, 0.2, 0.3, 0.5, 0.7, 1.1] {
        let up = "[[spring]]\nname = \"up\"\nbetween = [\"pad\", \"ground\"]\ndirection = \"y\"\n\
                  stiffness = 5000.0\n";
        let (_, model) = turned(angle, "", &format!("{up}{DAMPER}"));
        let found = Spectrum::of(model.linear().unwrap(), &[Detached]).unwrap();
        let [damped, free] = found.oscillating[..] else { panic!("{found:?}") };
        assert!((damped.re + 0.5 * 3.0 / MASS).abs() < 1e-9, "{damped}");
        assert!(free.re == 0.0 && (free.im - (5000.0_f64 / MASS).sqrt()).abs() < 1e-9, "{free}");
    }
}

#[test]
fn a_contacts_own_friction_stands_in_for_the_common_one() {
    let inclined = "[[spring]]\nname = \"s\"\nbetween = [\"pad\", \"ground\"]\ndirection = 0.9\n\
                    stiffness = 500.0\n";
    let (common, _) = pressed("", inclined);
    let (own, _) = pressed("friction = 0.8\n", inclined);
    let spectrum = |scene: &Scene, friction_coefficient: f64| {
        let scene = Scene { friction_coefficient, ..scene.clone() };
        Spectrum::of(Linearised::of(&scene).linear().unwrap(), &[Slide]).unwrap()
    };
    assert_eq!(spectrum(&own, 0.1), spectrum(&common, 0.8));
    assert_ne!(spectrum(&common, 0.1), spectrum(&common, 0.8));
}

#[test]
fn a_mode_leaves_sliding_by_the_contacts_own_velocity_and_friction() {
    // Along a slider without coupling the normal force stays, so only the slip velocity can vanish: at
    // the amplitude v / ω.
    for (contact, mu, velocity, into) in [
        ("", 0.5, 0.1, Stick),
        ("velocity = 0.3\n", 0.5, 0.3, Stick),
        ("velocity = 0.3\nfriction = 0.0\n", 0.5, 0.3, ReverseSlide),
        ("velocity = -0.3\nfriction = 0.0\n", 0.5, 0.3, Slide),
        ("friction = 0.2\n", 0.0, 0.1, Stick),
    ] {
        let (scene, _) = pressed(contact, "");
        let here = Linearised::of(&Scene { friction_coefficient: mu, ..scene });
        let linear = here.linear().unwrap();
        let mode = &modes(linear, &here.uniform_sliding().unwrap()).unwrap().oscillating[0];
        let found = linearity_limit(linear, here.equilibrium().unwrap(), mode).unwrap();
        let expected = velocity / (STIFFNESS / MASS).sqrt();
        assert_eq!(found.into, into, "{contact}");
        assert!((found.amplitude - expected).abs() < 1e-12, "{contact}");
    }
}

#[test]
fn one_pressed_mass_is_stable_at_any_friction_damped_or_not() {
    // One free coordinate, K̃ = k whatever µ is.
    for damper in ["", DAMPER] {
        let (scene, _) = pressed("", damper);
        let found = bistability(&scene, [0.0, 1.0], Watch::IDLE).unwrap();
        assert!(found.candidates.is_empty() && found.stable == [[0.0, 1.0]], "{found:?}");
    }
}

#[test]
fn a_damper_on_one_direction_makes_hoffmanns_model_flutter_earlier() {
    // The paradox of damping: SciPy, on the first-order form of the same four equations, has the
    // growth rate vanish at 0.19756985620.
    let text = builtin("hoffmann").unwrap().text;
    let damper = "[[damper]]\nname = \"d\"\nbetween = [\"block\", \"ground\"]\ndirection = \"x\"\n\
                  damping = 0.05\n";
    let scene = parse("damped", &format!("{text}{damper}")).unwrap();
    let values: Vec<f64> = (0..=100).map(|i| 0.01 * f64::from(i)).collect();
    let model_at = |mu| Ok(Linearised::of(&Scene { friction_coefficient: mu, ..scene.clone() }));
    let found = locus(&model_at, &[Slide], &values, ALL_FREQUENCIES, &|_, _| {}).unwrap();
    let [onset] = found.crossings[..] else { panic!("{found:?}") };
    assert!((onset.value - 0.19756985620).abs() < 1e-9, "{onset:?}");
    assert!(found.coalescences.is_empty() && found.approaches.len() == 1);
}

/// The built-in disc brake with friction that falls: numbers of a NumPy program that assembles M, C and K and the
/// equilibrium from the scene's file by itself (C has N dµ/dv along each tangent).
#[test]
fn a_disc_brake_whose_friction_falls_is_stable_where_an_independent_program_says_so() {
    let scene = |more: &str| {
        let text = builtin("disc_brake").unwrap().text;
        let with = text.replacen("coefficient = 0.6 ", &format!("{more}\ncoefficient = 0.6 "), 1);
        assert_ne!(with, text);
        parse("brake", &with).unwrap()
    };
    let mut steep = scene("static = 0.6\nstribeck_velocity = 0.05");
    steep.friction_coefficient = 0.4;
    let here = Linearised::of(&steep);
    let sliding = here.uniform_sliding().unwrap();
    assert_eq!(sliding, [Slide, ReverseSlide]);
    let growth = Spectrum::of(here.linear().unwrap(), &sliding).unwrap().growth_rate();
    assert!((growth / 5803.454543507425 - 1.0).abs() < 1e-9, "{growth}");
    let found = bistability(&steep, [0.3, 0.9], Watch::IDLE).unwrap();
    assert_eq!((found.range, found.stable), ([0.3, 0.6], vec![]));

    let gentle = scene("static = 0.7\nstribeck_velocity = 0.0055");
    let found = bistability(&gentle, [0.0, 0.7], Watch::IDLE).unwrap();
    let expected = [
        // Another mode still grows here.
        (0.21583257517012022, 1024.6921928754648, false),
        (0.43172053504634733, 1041.2693620642524, false),
        (0.5408676458071934, 1076.7506201940503, true),
    ];
    assert_eq!(found.uniform.len(), 3, "{:?}", found.uniform);
    for (found, (value, hz, begins)) in found.uniform.iter().zip(expected) {
        assert!((found.value - value).abs() < 1e-9, "{found:?}");
        assert!((found.frequency_hz - hz).abs() < 1e-5, "{found:?}");
        assert_eq!(found.becomes_unstable, begins);
    }
    assert_eq!(found.stable, [[found.uniform[1].value, found.uniform[2].value]]);
}
