//! The energy ledger: what is dissipated and done, in closed form, and that it adds up.

use amontons::integrator::Energy;
use amontons::model::LumpedModel;
use amontons::scene::Method::{EventDriven, ForwardIncrement};
use amontons::scene::{Method, Scene, builtin, parse};
use amontons::simulation::{Simulation, Variable, variables};

/// A scene with a ledger.
fn with_ledger(mut scene: Scene, method: Method, step: f64) -> Scene {
    scene.effects.energy = true;
    Scene { method, step, ..scene }
}

fn of(text: &str, method: Method, step: f64) -> Simulation {
    let text = format!("{text}\n[integrator]\nstep = 1.0\n");
    Simulation::new(with_ledger(parse("mine", &text).unwrap(), method, step), 0.0).unwrap()
}

fn energy(simulation: &Simulation) -> Energy {
    simulation.energy().expect("the scene asks for it")
}

/// A step for either method, and what it may be off by: `slope` (J/s) times the step of the scheme.
fn tolerances(slope: f64, exact: f64) -> [(Method, f64, f64); 2] {
    [(ForwardIncrement, 1e-5, 1e-5 * slope), (EventDriven, 1e-2, exact)]
}

fn assert_near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} for {expected} ± {tolerance:e}");
}

fn variable(scene: &Scene, name: &str) -> Variable {
    variables(scene).into_iter().find(|variable| variable.name == name).unwrap()
}

/// Sum of the absolute energies of a ledger.
fn turnover(energy: &Energy) -> f64 {
    let Energy { damping, friction, impact, slider, forces, kinetic, elastic, .. } = energy;
    [damping, friction, impact, slider, forces, kinetic, elastic]
        .iter()
        .fold(0.0, |sum, e| sum + e.abs())
}

/// 0.5 kg on 200 N/m: 20 rad/s.
fn oscillator(more: &str) -> String {
    format!(
        "[[mass]]\nname = \"a\"\nmass = 0.5\nlocked = [\"y\"]\n[[spring]]\nname = \"k\"\n\
        between = [\"a\", \"ground\"]\ndirection = \"x\"\nstiffness = 200.0\npreload = 0.0\n{more}"
    )
}

/// 1 kg that weighs 10 N on a belt, held by 100 N/m; µ = 0.4.
fn block(velocity: f64, initial: &str) -> String {
    format!(
        "[slider]\nvelocity = {velocity:?}\nangle = 0.0\n[friction]\ncoefficient = 0.4\n\
        [[mass]]\nname = \"block\"\nmass = 1.0\nforce = [0.0, -10.0]\n[[spring]]\nname = \"hold\"\n\
        between = [\"block\", \"ground\"]\ndirection = \"x\"\nstiffness = 100.0\n\
        [[contact]]\nname = \"belt\"\nmass = \"block\"\n[[initial]]\nmass = \"block\"\n{initial}"
    )
}

#[test]
fn a_damper_takes_what_a_free_oscillator_loses() {
    let start = "[[initial]]\nmass = \"a\"\nx = 0.01\n";
    let damper = "[[damper]]\nname = \"d\"\nbetween = [\"a\", \"ground\"]\ndirection = \"x\"\n\
        damping = 4.0\n";
    // δ = 4 1/s in each of the three: d/2m, α/2, β ω²/2.
    let decay: f64 = 4.0;
    let frequency = (400.0 - decay * decay).sqrt();
    for more in [damper, "[damping]\nalpha = 8.0\n", "[damping]\nbeta = 0.02\n"] {
        for (method, step, tolerance) in tolerances(0.5, 1e-15) {
            let mut simulation = of(&oscillator(&format!("{start}{more}")), method, step);
            for row in 1..=20 {
                let t = 0.05 * f64::from(row);
                simulation.advance_to(t).unwrap();
                let (sin, cos) = (frequency * t).sin_cos();
                let decayed = (-decay * t).exp();
                let x = 0.01 * decayed * (cos + decay / frequency * sin);
                let v = -0.01 * decayed * 400.0 / frequency * sin;
                let left = 0.25 * v * v + 100.0 * x * x;
                assert_near(energy(&simulation).damping, 0.01 - left, tolerance);
            }
            simulation.advance_to(6.0).unwrap();
            // All of it, with the scheme as well: it started at rest, and its residual went with it.
            assert_near(energy(&simulation).damping, 0.01, 1e-14);
            assert_eq!(energy(&simulation).forces, 0.0);
        }
    }
}

#[test]
fn friction_takes_its_force_times_the_slip_and_the_belt_gives_its_force_times_its_way() {
    for (method, step, tolerance) in tolerances(0.5, 1e-13) {
        let mut simulation = of(&block(1.0, "x = 0.02\n"), method, step);
        for row in 1..=40 {
            let t = 0.05 * f64::from(row);
            simulation.advance_to(t).unwrap();
            // It swings about the equilibrium under a constant friction of 4 N.
            let moved = 0.02 * (10.0 * t).cos() - 0.02;
            let Energy { friction, slider, impact, kinetic, elastic, .. } = energy(&simulation);
            assert_near(slider, 4.0 * t, 1e-10);
            assert_near(friction, 4.0 * (t - moved), tolerance);
            assert_near(impact, 0.0, 1e-18);
            // The spring, and the friction that the equilibrium has, over the way that is left.
            assert_near(kinetic + elastic, 0.02 + 4.0 * 0.02 + 4.0 * moved, tolerance);
        }
    }
}

#[test]
fn a_contact_that_sticks_dissipates_nothing_and_its_belt_strains_the_spring() {
    for (method, step, tolerance) in tolerances(0.25, 1e-15) {
        // Stuck from the slack spring on, until it carries µN after 0.4 s.
        let mut simulation = of(&block(0.1, "x = -0.04\nvx = 0.1\n"), method, step);
        for row in 1..=39 {
            let t = 0.01 * f64::from(row);
            simulation.advance_to(t).unwrap();
            let Energy { friction, slider, .. } = energy(&simulation);
            assert_near(friction, 0.0, 1e-16);
            assert_near(slider, 0.5 * 100.0 * (0.1 * t).powi(2), tolerance);
        }
    }
}

#[test]
fn a_belt_that_speeds_up_with_a_stuck_mass_does_its_work_without_friction() {
    let ramp = "[[signal]]\ninput = \"slider.velocity\"\n\
        ramp = { from = -0.5, to = 0.0, end = 1.0 }\n";
    let text = block(0.5, &format!("x = 0.0\n{ramp}"));
    for (method, step, tolerance) in tolerances(0.1, 1e-15) {
        let mut simulation = of(&text, method, step);
        for row in 1..=30 {
            let t = 0.01 * f64::from(row);
            simulation.advance_to(t).unwrap();
            let Energy { friction, slider, .. } = energy(&simulation);
            let (x, v) = (0.25 * t * t, 0.5 * t);
            assert_near(slider, 0.5 * v * v + 50.0 * x * x, tolerance);
            assert_near(friction, 0.0, 1e-12 * slider);
        }
    }
}

#[test]
fn an_impact_takes_the_energy_of_a_dropped_mass_and_brakes_it_by_friction() {
    // 1 kg falls 5 mm onto a standing slider at 10 m/s², and slides on; a spring of 1 N/m holds it.
    let (height, fast, mu): (f64, f64, f64) = (5e-3, 0.8, 0.4);
    let text = block(0.0, &format!("y = {height:?}\nvx = {fast:?}\n"))
        .replace("stiffness = 100.0", "stiffness = 1.0");
    let (falls, lands) = ((0.2 * height).sqrt(), (20.0 * height).sqrt());
    let (flown, before) = (fast * falls.sin(), fast * falls.cos());
    let after = before - mu * lands;
    assert!(after > 0.0);
    let taken = mu * lands * 0.5 * (before + after);
    for (method, step, tolerance) in tolerances(20.0, 1e-14) {
        let mut simulation = of(&text, method, step);
        for t in [0.02, 0.03, 0.04, 0.08, 0.1] {
            simulation.advance_to(t).unwrap();
            let energy = energy(&simulation);
            assert_eq!(energy.slider, 0.0);
            if t < falls {
                assert_eq!([energy.impact, energy.friction], [0.0; 2]);
                continue;
            }
            // On from there about the place where the spring carries µN.
            let (sin, cos) = (t - falls).sin_cos();
            let slid = (flown + 4.0) * cos + after * sin - 4.0 - flown;
            assert_near(energy.impact, 0.5 * lands * lands, tolerance);
            assert_near(energy.friction, taken + 4.0 * slid, tolerance);
        }
    }
}

#[test]
fn forces_do_their_work_whoever_gives_them() {
    let signal = |shape: &str| oscillator(&format!("[[signal]]\ninput = \"mass.a.fx\"\n{shape}\n"));
    let [constant, ramp] = ["constant = { value = 3.0 }", "ramp = { to = 8.0, end = 4.0 }"];
    for (method, step, tolerance) in tolerances(10.0, 1e-14) {
        let mut held = of(&signal(constant), method, step);
        let mut rising = of(&signal(ramp), method, step);
        let mut given = of(&oscillator(""), method, step);
        let scene = given.scene().clone();
        let [force, preload] = ["mass.a.fx", "spring.k.preload"].map(|name| variable(&scene, name));
        let (mut work, mut last) = (0.0, 0.0);
        for row in 1..=40_u32 {
            let t = 0.02 * f64::from(row);
            let (sin, cos) = (20.0 * t).sin_cos();
            held.advance_to(t).unwrap();
            assert_near(energy(&held).forces, 3.0 * 0.015 * (1.0 - cos), tolerance);
            rising.advance_to(t).unwrap();
            // c t against ẋ = c/k (1 − cos ω t), c = 2 N/s.
            let expected = 0.02 * (0.5 * t * t - t * sin / 20.0 - (cos - 1.0) / 400.0);
            assert_near(energy(&rising).forces, expected, tolerance);
            // An importer's force and preload count with what acts in the step.
            let values = [f64::from(row % 5) - 2.0, 1e-3 * f64::from(row % 3)];
            given.write(&force, values[0]).unwrap();
            given.write(&preload, values[1]).unwrap();
            given.advance_to(t).unwrap();
            let x = given.displacement()[0];
            work += (values[0] + 200.0 * values[1]) * (x - last);
            last = x;
            assert_near(energy(&given).forces, work, tolerance);
        }
        assert!(work.abs() > 1e-3, "{work} proves nothing");
    }
}

/// Set 1 where it detaches, pushed.
fn set1() -> Scene {
    let mut scene = builtin("set1").unwrap().scene();
    (scene.friction_coefficient, scene.slider.velocity) = (1.5, 0.15);
    scene.modules_mut()[0].velocity = [0.01, 0.0, 0.0, 0.0];
    scene
}

/// Two pads on a disc, inclined, and a block that rubs on one of them; with damping of each kind, and with
/// forces, a slider and friction that change.
fn network() -> Scene {
    let text = "[slider]\nvelocity = 0.3\nangle = 0.3\n[friction]\ncoefficient = 0.6\nstatic = 0.8\n\
        [damping]\nalpha = 3.0\nbeta = 1e-5\n\
        [[mass]]\nname = \"disc\"\nmass = 1.0\nangle = 0.4\n\
        [[mass]]\nname = \"pad\"\nmass = 0.4\nforce = [3.0, -20.0]\n\
        [[mass]]\nname = \"block\"\nmass = 0.2\nforce = [0.0, -6.0]\n\
        [[spring]]\nname = \"dx\"\nbetween = [\"disc\", \"ground\"]\ndirection = \"x\"\nstiffness = 4e4\n\
        [[spring]]\nname = \"dy\"\nbetween = [\"disc\", \"ground\"]\ndirection = \"y\"\nstiffness = 9e4\n\
        [[spring]]\nname = \"px\"\nbetween = [\"pad\", \"ground\"]\ndirection = 0.2\nstiffness = 2e4\n\
        [[spring]]\nname = \"bx\"\nbetween = [\"block\", \"pad\"]\ndirection = \"x\"\nstiffness = 5e3\n\
        [[damper]]\nname = \"d\"\nbetween = [\"pad\", \"disc\"]\ndirection = \"y\"\ndamping = 2.0\n\
        [[contact]]\nname = \"lining\"\nmass = \"pad\"\non = \"disc\"\nangle = 0.1\nvelocity = 0.2\n\
        [[contact]]\nname = \"top\"\nmass = \"block\"\non = \"pad\"\nangle = 0.05\nvelocity = -0.05\nfriction = 0.3\n\
        [[initial]]\nmass = \"pad\"\nvx = 0.4\n[[initial]]\nmass = \"block\"\nvy = 0.2\n\
        [[signal]]\ninput = \"mass.pad.fy\"\nsine = { amplitude = 25.0, frequency = 60.0 }\n\
        [[signal]]\ninput = \"contact.lining.velocity\"\nramp = { to = 0.3, end = 0.02 }\n\
        [integrator]\nstep = 1e-5";
    parse("network", text).unwrap()
}

/// Scenes with steps of the scheme, and how long they run (s).
fn scenes() -> [(Scene, f64, f64); 5] {
    let builtin = |name| builtin(name).unwrap().scene();
    [
        (set1(), 2e-6, 0.1),
        (network(), 2e-6, 0.1),
        (builtin("corner"), 1e-5, 0.1),
        (builtin("disc_brake"), 2e-6, 0.02),
        (builtin("hoffmann"), 1e-3, 60.0),
    ]
}

/// ½ h ẋ·(K x + Gᵀ λ₀), J.
fn lag(simulation: &Simulation, model: &LumpedModel, h: f64) -> f64 {
    let (x, v) = (simulation.displacement(), simulation.velocity());
    let mut force: Vec<f64> = (0..x.len()).map(|row| model.stiffness.row_times(row, x)).collect();
    let reference = simulation.reference();
    for (i, contact) in model.contacts.iter().enumerate() {
        contact.normal.add_to(&mut force, reference.normal_force[i]);
        contact.tangent.add_to(&mut force, reference.friction_force[i]);
    }
    0.5 * h * force.iter().zip(v).fold(0.0, |sum, (force, v)| sum + force * v)
}

#[test]
fn exact_motion_adds_up_to_the_last_digits() {
    for (scene, _, stop) in scenes() {
        let name = scene.name.clone();
        let stop = if name == "set1" { 1.0 } else { stop };
        let mut plain =
            Simulation::new(Scene { method: EventDriven, step: 1e-3, ..scene.clone() }, 0.0)
                .unwrap();
        let mut simulation = Simulation::new(with_ledger(scene, EventDriven, 1e-3), 0.0).unwrap();
        let (mut last, mut worst) = (energy(&simulation), 0.0);
        for row in 1..=50 {
            let t = stop * f64::from(row) / 50.0;
            plain.advance_to(t).unwrap();
            simulation.advance_to(t).unwrap();
            let now = energy(&simulation);
            let before = [last.damping, last.friction, last.impact];
            for (now, before) in [now.damping, now.friction, now.impact].into_iter().zip(before) {
                assert!(now >= before - 1e-15, "{name}: {now} after {before} at {t} s");
            }
            worst = f64::max(worst, now.residual.abs() / turnover(&now));
            last = now;
        }
        let touch_downs = simulation.statistics().touch_downs;
        println!("{name}: {worst:e} {touch_downs} {last:?}");
        assert!(worst < 1e-11, "{name}: {worst:e}");
        assert!(
            last.friction > 0.0 && (last.impact > 0.0) == (touch_downs > 0),
            "{name}: {last:?}"
        );
        // Whoever watches changes nothing.
        assert_eq!(plain.displacement(), simulation.displacement(), "{name}");
        assert_eq!(plain.statistics(), simulation.statistics(), "{name}");
    }
}

#[test]
fn the_schemes_residual_is_a_half_step_of_power_to_the_last_digits() {
    for (scene, step, stop) in scenes() {
        let name = scene.name.clone();
        let model = LumpedModel::from(&scene);
        let mut simulation =
            Simulation::new(with_ledger(scene, ForwardIncrement, step), 0.0).unwrap();
        let start = lag(&simulation, &model, step);
        let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
        for row in 1..=50 {
            simulation.advance_to(stop * f64::from(row) / 50.0).unwrap();
            let now = energy(&simulation);
            let off = now.residual - (lag(&simulation, &model, step) - start);
            worst = worst.max(off.abs() / turnover(&now));
            largest = largest.max(now.residual.abs() / turnover(&now));
        }
        println!("{name}: {worst:e} of {largest:e} {:?}", energy(&simulation));
        assert!(worst < 1e-11, "{name}: {worst:e}");
        assert!(largest > 1e3 * worst, "{name}: {largest:e} proves nothing");
    }
}

#[test]
fn the_schemes_residual_halves_with_the_step() {
    for (scene, step, _) in scenes().into_iter().take(4) {
        let name = scene.name.clone();
        let steps = [step, 0.5 * step, 0.25 * step];
        let residuals = steps.map(|step| {
            let mut simulation =
                Simulation::new(with_ledger(scene.clone(), ForwardIncrement, step), 0.0).unwrap();
            let row = |row| {
                simulation.advance_to(1e-4 * f64::from(row)).unwrap();
                energy(&simulation).residual.abs()
            };
            (1..=100).map(row).fold(0.0, f64::max)
        });
        println!("{name}: {residuals:?}");
        for two in residuals.windows(2) {
            let order = (two[0] / two[1]).log2();
            assert!((0.9..1.1).contains(&order), "{name}: {residuals:?}");
        }
    }
}

#[test]
fn both_methods_write_the_same_ledger_in_the_limit() {
    for (scene, step, _) in scenes().into_iter().take(4) {
        let name = scene.name.clone();
        let run = |method, step| {
            let scene = with_ledger(scene.clone(), method, step);
            let mut simulation = Simulation::new(scene, 0.0).unwrap();
            simulation.advance_to(0.01).unwrap();
            energy(&simulation)
        };
        let exact = run(EventDriven, 1e-4);
        let errors = [4.0 * step, step, 0.25 * step].map(|step| {
            let scheme = run(ForwardIncrement, step).parts();
            let apart = scheme.iter().zip(exact.parts()).map(|(a, b)| (a - b).abs());
            apart.fold(0.0, f64::max) / turnover(&exact)
        });
        println!("{name}: {errors:?} {exact:?}");
        for two in errors.windows(2) {
            assert!((2.5..6.5).contains(&(two[0] / two[1])), "{name}: {errors:?}");
        }
    }
}

#[test]
fn a_ledger_is_the_same_however_the_run_is_split_and_after_a_restore() {
    for (method, step) in [(ForwardIncrement, 1e-5), (EventDriven, 2.5e-4)] {
        for scene in [set1(), network()] {
            let scene = with_ledger(scene, method, step);
            let slider = variables(&scene).into_iter().find(|v| v.name.ends_with(".velocity"));
            let slider = slider.unwrap();
            let mut straight = Simulation::new(scene.clone(), 0.0).unwrap();
            let mut split = Simulation::new(scene.clone(), 0.0).unwrap();
            let change = |simulation: &mut Simulation| {
                simulation.write(&slider, 0.17).unwrap();
            };
            for count in [1, 2, 3, 50, 51, 100] {
                let time = 2.5e-4 * f64::from(count);
                split.advance_to(time).unwrap();
                split.contact_forces().unwrap();
                if count == 50 {
                    change(&mut split);
                }
                let saved = split.save();
                split.advance_to(time + 2e-3).unwrap();
                split.restore(&saved).unwrap();
                split.advance_to(time + 5e-4).unwrap();
                split = Simulation::resume(saved).unwrap();
            }
            straight.advance_to(2.5e-4 * 50.0).unwrap();
            change(&mut straight);
            for run in [&mut straight, &mut split] {
                run.advance_to(0.05).unwrap();
            }
            assert!(straight.save() == split.save());
            assert_eq!(energy(&straight), energy(&split));
            assert!(energy(&straight).friction > 0.0);
            // A slider whose velocity jumps between steps leaves no gap in the balance.
            let part = energy(&straight).residual.abs() / turnover(&energy(&straight));
            assert!(part < if method == EventDriven { 1e-13 } else { 1e-3 }, "{part:e}");
            // It starts anew with the run.
            let fresh = Simulation::new(scene, 0.0).unwrap();
            assert_eq!(energy(&fresh).parts()[2..], [0.0; 6]);
            split.restore(&fresh.save()).unwrap();
            assert_eq!(energy(&split), energy(&fresh));
        }
    }
}

#[test]
fn a_scene_that_does_not_ask_for_it_has_nothing_of_it() {
    for scene in [set1(), network()] {
        let energies = |scene: &Scene| {
            let all = variables(scene);
            all.into_iter().filter(|variable| variable.name.starts_with("energy.")).count()
        };
        let asking = with_ledger(scene.clone(), scene.method, scene.step);
        assert_eq!([energies(&scene), energies(&asking)], [0, 8]);
        let [plain, asking] = [scene, asking].map(|scene| {
            let mut simulation = Simulation::new(scene, 0.0).unwrap();
            simulation.advance_to(1e-3).unwrap();
            simulation
        });
        assert_eq!(plain.energy(), None);
        assert_eq!(plain.displacement(), asking.displacement());
    }
}

#[test]
fn what_an_importer_reads_is_the_ledger() {
    for scene in [set1(), network()] {
        let scene = with_ledger(scene, EventDriven, 1e-3);
        let mut simulation = Simulation::new(scene.clone(), 0.0).unwrap();
        simulation.advance_to(0.1).unwrap();
        let found = energy(&simulation);
        for (name, expected) in [
            ("kinetic", found.kinetic),
            ("elastic", found.elastic),
            ("damping", found.damping),
            ("friction", found.friction),
            ("impact", found.impact),
            ("slider", found.slider),
            ("forces", found.forces),
            ("residual", found.residual),
        ] {
            let variable = variable(&scene, &format!("energy.{name}"));
            assert_eq!(simulation.read(&variable).unwrap(), expected, "{name}");
        }
    }
}

#[test]
fn the_shipped_scene_lands_sticks_at_once_and_then_lives_on_the_belt() {
    let scene = parse("energy", include_str!("../../scenes/effects/energy.toml")).unwrap();
    let interval = scene.experiment.output_interval;
    let mut simulation = Simulation::new(scene, 0.0).unwrap();
    let lands = 1e-3_f64.sqrt();
    for row in 1..=400 {
        let t = interval * f64::from(row);
        simulation.advance_to(t).unwrap();
        let now = energy(&simulation);
        // 10 N · 5 mm.
        assert_near(now.impact, if t < lands { 0.0 } else { 0.05 }, 1e-15);
        assert!(now.residual.abs() < 1e-14, "{now:?} at {t} s");
        assert_eq!(now.forces != 0.0, t > 1.0 + 1e-9, "{now:?} at {t} s");
        let stuck = t - lands;
        if (0.0..0.5).contains(&stuck) {
            // The impulse of 0.1 N s that gives it the belt's velocity, then spring and damper.
            assert_near(now.friction, 0.1 * (0.1 - 0.5 * 0.1), 1e-15);
            assert_near(now.slider, 0.01 + 0.5 * stuck * stuck + 0.005 * stuck, 1e-14);
        }
    }
    let Energy { slider, friction, damping, .. } = energy(&simulation);
    assert!(friction > 1.0 && damping > 0.02 && slider > friction);
}
