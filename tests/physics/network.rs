//! Networks: the same doubles as the ring where they are one, and closed forms where they are not.

use amontons::contact::ContactState;
use amontons::model::LumpedModel;
use amontons::scene::{Scene, builtin, parse};
use amontons::simulation::{Simulation, Variable, variables};
use std::fmt::Write;

/// A built-in ring, written down as a network: masses m1, m2 of each module, one contact each.
fn as_network(name: &str, modify: impl FnOnce(&mut Scene)) -> (Scene, Scene) {
    let mut ring = builtin(name).unwrap().scene();
    modify(&mut ring);
    let mut text = format!(
        "[slider]\nvelocity = {:?}\nangle = {:?}\n[friction]\ncoefficient = {:?}\n\
         [damping]\nalpha = {:?}\nbeta = {:?}\n[integrator]\nstep = {:?}\n",
        ring.slider.velocity,
        ring.slider.angle,
        ring.friction_coefficient,
        ring.damping.alpha,
        ring.damping.beta,
        ring.step,
    );
    let modules = ring.modules();
    for (i, module) in modules.iter().enumerate() {
        let [m1, m2] = module.mass;
        let angle = ring.slider.angle;
        let _ = write!(
            text,
            "[[mass]]\nname = \"upper{i}\"\nmass = {m1:?}\n\
             [[mass]]\nname = \"lower{i}\"\nmass = {m2:?}\nangle = {angle:?}\n\
             [[contact]]\nname = \"c{i}\"\nmass = \"lower{i}\"\n"
        );
        let next = (i + 1) % modules.len();
        let spring = |j: usize, other: String, direction: &str, preload: f64| {
            let k = module.stiffness[j - 1];
            format!(
                "[[spring]]\nname = \"k{j}_{i}\"\nbetween = [\"upper{i}\", \"{other}\"]\n\
                 direction = \"{direction}\"\nstiffness = {k:?}\npreload = {preload:?}\n"
            )
        };
        // In another order than the ring's: it must leave no trace.
        text += &spring(6, format!("lower{i}"), "x", 0.0);
        text += &spring(3, "ground".to_owned(), "y", -module.preload);
        if modules.len() > 1 {
            text += &spring(1, format!("upper{next}"), "x", 0.0);
            text += &spring(2, format!("upper{next}"), "y", 0.0);
        }
        text += &spring(5, format!("lower{i}"), "y", 0.0);
        text += &spring(4, "ground".to_owned(), "x", 0.0);
        let ([x1, x2, x3, x4], [v1, v2, v3, v4]) = (module.displacement, module.velocity);
        let _ = write!(
            text,
            "[[initial]]\nmass = \"upper{i}\"\nx = {x1:?}\ny = {x2:?}\nvx = {v1:?}\nvy = {v2:?}\n\
             [[initial]]\nmass = \"lower{i}\"\nx = {x3:?}\ny = {x4:?}\nvx = {v3:?}\nvy = {v4:?}\n"
        );
    }
    (parse("chain", &text).unwrap(), ring)
}

fn variable(scene: &Scene, name: &str) -> Variable {
    let mut all = variables(scene).into_iter();
    all.find(|variable| variable.name == name).unwrap_or_else(|| panic!("no variable {name}"))
}

fn value(simulation: &mut Simulation, name: &str) -> f64 {
    let variable = variable(&simulation.scene().clone(), name);
    simulation.read(&variable).unwrap()
}

#[test]
fn a_ring_written_as_a_network_has_the_same_model_equilibrium_and_motion() {
    let modified = |scene: &mut Scene| {
        scene.modules_mut()[0].velocity = [0.3, 0.0, 0.0, 0.4];
        scene.modules_mut()[1].displacement[3] = 1e-4;
        scene.damping.alpha = 1.5;
    };
    let one = |scene: &mut Scene| {
        scene.modules_mut().truncate(1);
        scene.modules_mut()[0].velocity[0] = 0.2;
    };
    let unequal = |scene: &mut Scene| {
        scene.slider.angle = 0.0;
        scene.modules_mut()[0].stiffness[0] *= 1.1;
        scene.modules_mut()[1].preload *= 1.3;
        scene.modules_mut()[0].velocity[0] = 0.1;
    };
    let scenes = [
        as_network("set1", modified),
        as_network("ring12", modified),
        as_network("set1", one),
        as_network("set2", unequal),
    ];
    for (network, ring) in scenes {
        let [a, b] = [&network, &ring].map(LumpedModel::from);
        assert_eq!(a, b);
        let mut a = Simulation::new(network, 0.0).unwrap();
        let mut b = Simulation::new(ring, 0.0).unwrap();
        assert_eq!(a.reference(), b.reference());
        for _ in 0..10 {
            let time = a.time() + 1e4 * a.scene().step;
            a.advance_to(time).unwrap();
            b.advance_to(time).unwrap();
        }
        assert_eq!(a.statistics(), b.statistics());
        assert!(a.statistics().steps == 100_000 && a.statistics().state_changes() > 0);
        assert_eq!(a.contact_forces().unwrap(), b.contact_forces().unwrap());
        for (i, module) in (1..=b.scene().modules().len()).enumerate() {
            for (upper, lower, axis) in
                [("x1", "x3", "x"), ("x2", "x4", "y"), ("v1", "v3", "vx"), ("v2", "v4", "vy")]
            {
                let ours = value(&mut a, &format!("mass.upper{i}.{axis}"));
                assert_eq!(
                    ours.to_bits(),
                    value(&mut b, &format!("module[{module}].{upper}")).to_bits()
                );
                let ours = value(&mut a, &format!("mass.lower{i}.{axis}"));
                assert_eq!(
                    ours.to_bits(),
                    value(&mut b, &format!("module[{module}].{lower}")).to_bits()
                );
            }
        }
    }
}

const HEAD: &str = "[slider]\nvelocity = 0.1\nangle = 0.0\n[friction]\ncoefficient = 0.5\n\
                    [integrator]\nstep = 1e-6\n";

fn scene(text: &str) -> Scene {
    parse("test", &format!("{HEAD}{text}")).unwrap()
}

#[test]
fn an_oscillator_with_a_damper_follows_the_closed_form() {
    let (m, d, k, v) = (2.0_f64, 3.0, 800.0, 0.7);
    let scene = scene(&format!(
        "[[mass]]\nname = \"m\"\nmass = {m:?}\nlocked = [\"y\"]\n\
         [[spring]]\nname = \"k\"\nbetween = [\"m\", \"ground\"]\ndirection = \"x\"\nstiffness = {k:?}\n\
         [[damper]]\nname = \"d\"\nbetween = [\"ground\", \"m\"]\ndirection = 0\ndamping = {d:?}\n\
         [[initial]]\nmass = \"m\"\nvx = {v:?}\n"
    ));
    let mut simulation = Simulation::new(scene, 0.0).unwrap();
    let rate = 0.5 * d / m;
    let omega = (k / m - rate * rate).sqrt();
    for time in [0.05, 0.2, 0.5] {
        simulation.advance_to(time).unwrap();
        let expected = v / omega * (-rate * time).exp() * (omega * time).sin();
        let found = value(&mut simulation, "mass.m.x");
        // First order in h ω = 2e-5.
        assert!((found - expected).abs() < 2e-5 * v / omega, "{time}: {found} {expected}");
    }
}

#[test]
fn two_contacts_on_one_mass_have_their_own_friction_and_velocity() {
    // A block between two jaws that press with P; each rubs with its own µ and v.
    let scene = scene(
        "[[mass]]\nname = \"block\"\nmass = 1.0\n\
         [[mass]]\nname = \"jaw\"\nmass = 1.0\nlocked = [\"x\"]\nforce = [0.0, -10.0]\n\
         [[spring]]\nname = \"hold\"\nbetween = [\"block\", \"ground\"]\ndirection = \"x\"\nstiffness = 1e3\n\
         [[spring]]\nname = \"soft\"\nbetween = [\"jaw\", \"ground\"]\ndirection = \"y\"\nstiffness = 1.0\n\
         [[contact]]\nname = \"lower\"\nmass = \"block\"\nvelocity = 0.2\nfriction = 0.3\n\
         [[contact]]\nname = \"upper\"\nmass = \"jaw\"\non = \"block\"\nvelocity = -0.4\nfriction = 0.7\n",
    );
    let mut simulation = Simulation::new(scene, 0.0).unwrap();
    let reference = simulation.reference().clone();
    assert!((reference.normal_force[0] - 10.0).abs() < 1e-9);
    assert!((reference.friction_force[0] - 3.0).abs() < 1e-9, "{reference:?}");
    // The upper surface is the block's own: v < 0 drags the jaw back and the block on.
    assert!((reference.friction_force[1] + 7.0).abs() < 1e-9);
    assert!((reference.displacement[0] - (3.0 + 7.0) / 1e3).abs() < 1e-12);
    simulation.advance_to(0.01).unwrap();
    let forces = simulation.contact_forces().unwrap().to_vec();
    assert_eq!(forces[0].state, ContactState::Slide);
    assert_eq!(forces[1].state, ContactState::ReverseSlide);
    assert!((forces[0].slip_velocity - 0.2).abs() < 1e-12);
    assert!((forces[1].slip_velocity + 0.4).abs() < 1e-12);
    // Inputs of their own act on their contact alone.
    let variable = variable(&simulation.scene().clone(), "contact.upper.friction");
    simulation.write(&variable, 0.1).unwrap();
    assert!((value(&mut simulation, "contact.upper.friction_force") + 1.0).abs() < 1e-9);
    assert!((value(&mut simulation, "contact.lower.friction_force") - 3.0).abs() < 1e-9);
}

#[test]
fn a_contact_on_a_mass_keeps_the_momentum_of_both() {
    // Soft springs hold the pair; over the run they give less than the tolerance.
    let scene = scene(
        "[[mass]]\nname = \"pad\"\nmass = 0.5\nangle = 0.3\nforce = [0.0, -50.0]\n\
         [[mass]]\nname = \"disc\"\nmass = 2.0\n\
         [[spring]]\nname = \"px\"\nbetween = [\"pad\", \"disc\"]\ndirection = 0.3\nstiffness = 100.0\n\
         [[spring]]\nname = \"dx\"\nbetween = [\"disc\", \"ground\"]\ndirection = \"x\"\nstiffness = 1e-6\n\
         [[spring]]\nname = \"dy\"\nbetween = [\"disc\", \"ground\"]\ndirection = \"y\"\nstiffness = 1e-6\n\
         [[contact]]\nname = \"c\"\nmass = \"pad\"\non = \"disc\"\nangle = 0.3\n\
         [[initial]]\nmass = \"pad\"\nx = 0.001\ny = 0.002\nvx = 0.3\n",
    );
    let mut simulation = Simulation::new(scene, 0.0).unwrap();
    let momentum = |simulation: &mut Simulation| {
        let (x, y) = (value(simulation, "mass.pad.vx"), value(simulation, "mass.pad.vy"));
        let (c, s) = (0.3_f64.cos(), 0.3_f64.sin());
        [
            0.5 * (c * x - s * y) + 2.0 * value(simulation, "mass.disc.vx"),
            0.5 * (s * x + c * y) + 2.0 * value(simulation, "mass.disc.vy"),
        ]
    };
    let before = momentum(&mut simulation);
    // While the contact is open, the constant force of the pad has nothing to meet.
    simulation.advance_to(0.05).unwrap();
    let after = momentum(&mut simulation);
    assert!(simulation.statistics().touch_downs > 0, "{:?}", simulation.statistics());
    for (a, b) in before.iter().zip(after) {
        assert!((a - b).abs() < 1e-9, "{before:?} {after:?}");
    }
}

#[test]
fn a_motion_that_nothing_holds_has_no_equilibrium() {
    // Nothing holds the mass along y.
    let scene = scene(
        "[[mass]]\nname = \"a\"\nmass = 1.0\n[[spring]]\nname = \"k\"\n\
         between = [\"a\", \"ground\"]\ndirection = \"x\"\nstiffness = 1.0\n",
    );
    let error = Simulation::new(scene, 0.0).err().unwrap();
    assert!(error.is_equilibrium() && error.to_string().contains("without straining"), "{error}");
}

#[test]
fn a_chain_of_ten_thousand_masses_is_made_in_seconds() {
    let mut text = HEAD.to_owned();
    for i in 0..10_000 {
        let other = if i == 0 { "ground".to_owned() } else { format!("m{}", i - 1) };
        let _ = write!(text, "[[mass]]\nname = \"m{i}\"\nmass = 0.01\n");
        for (axis, k) in [("x", 1e4), ("y", 2e4)] {
            let _ = write!(
                text,
                "[[spring]]\nname = \"k{axis}{i}\"\nbetween = [\"m{i}\", \"{other}\"]\n\
                 direction = \"{axis}\"\nstiffness = {k:?}\n"
            );
            if i % 100 == 0 {
                let _ = write!(
                    text,
                    "[[spring]]\nname = \"g{axis}{i}\"\nbetween = [\"m{i}\", \"ground\"]\n\
                     direction = \"{axis}\"\nstiffness = 1e3\npreload = -1e-3\n"
                );
            }
        }
    }
    for i in [100, 5000, 9900] {
        let _ = write!(text, "[[contact]]\nname = \"c{i}\"\nmass = \"m{i}\"\nangle = 0.1\n");
    }
    let start = std::time::Instant::now();
    let mut simulation = Simulation::new(parse("long", &text).unwrap(), 0.0).unwrap();
    let made = start.elapsed();
    simulation.advance_to(1e-3).unwrap();
    println!("made in {made:?}, 1000 steps in {:?}", start.elapsed() - made);
    // Ten times what an idle machine takes without optimization; O(n³) would take hours.
    assert!(made.as_secs() < 30, "{made:?}");
}
