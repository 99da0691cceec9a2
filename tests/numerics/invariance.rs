//! Properties that hold for any scene: the contact law in the outputs, equal doubles however a run is split, inputs
//! that act when they change.

use amontons::contact::ContactState;
use amontons::scene::{Method, Module, Scene, builtin};
use amontons::simulation::catalogue::Quantity;
use amontons::simulation::{Simulation, variables};
use proptest::prelude::*;

const METHODS: [Method; 2] = [Method::ForwardIncrement, Method::EventDriven];

fn any_module() -> impl Strategy<Value = Module> {
    (
        prop::array::uniform2(0.1..2.0),
        prop::array::uniform6(1e4..5e5),
        1e-3..2e-2,
        prop::array::uniform4(-0.5..0.5),
    )
        .prop_map(|(mass, stiffness, preload, velocity)| Module {
            mass,
            stiffness,
            preload,
            force: [0.0; 4],
            displacement: [0.0; 4],
            velocity,
        })
}

fn any_scene() -> impl Strategy<Value = Scene> {
    let modules = prop::collection::vec(any_module(), 1..=4);
    (prop::sample::select(METHODS.to_vec()), modules, 0.0..3.0, -0.3..0.3, -1.0..1.0, 0.0..1e-4)
        .prop_map(|(method, modules, friction_coefficient, velocity, angle, beta)| {
            let mut scene = builtin("set1").unwrap().scene();
            scene.method = method;
            *scene.modules_mut() = modules;
            scene.friction_coefficient = friction_coefficient;
            (scene.slider.velocity, scene.slider.angle) = (velocity, angle);
            scene.damping.beta = beta;
            scene.step = 1e-5;
            scene
        })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn every_state_obeys_the_law_of_contact(scene in any_scene()) {
        // Jamming is a refusal, tested elsewhere.
        let Ok(mut simulation) = Simulation::new(scene.clone(), 0.0) else {
            return Err(TestCaseError::reject("no equilibrium"));
        };
        let all = variables(&scene);
        let value = |simulation: &mut Simulation, quantity: Quantity, component: usize, i: usize| {
            let variable = all.iter().find(|v| {
                v.template.quantity == quantity && v.template.component == component && v.index == i
            });
            simulation.read(variable.unwrap()).unwrap()
        };
        for row in 1..=200 {
            simulation.advance_to(f64::from(row) * 3e-5).unwrap();
            let forces = simulation.contact_forces().unwrap().to_vec();
            for (i, force) in forces.into_iter().enumerate() {
                // A contact that is open in the equilibrium has a gap there, from which displacements count.
                let away = value(&mut simulation, Quantity::Displacement, 3, i);
                let gap = simulation.reference().gap[i] + away;
                let velocity = value(&mut simulation, Quantity::Velocity, 2, i);
                let limit = scene.friction_coefficient * force.normal_force;
                prop_assert!(gap >= 0.0, "penetration {gap}");
                prop_assert!(force.normal_force >= 0.0);
                prop_assert!(gap == 0.0 || force.normal_force == 0.0, "a force at a distance");
                prop_assert!(force.friction_force.abs() <= limit);
                prop_assert!(force.friction_force * force.slip_velocity >= 0.0, "friction feeds");
                prop_assert_eq!(force.slip_velocity, scene.slider.velocity - velocity);
                match force.state {
                    ContactState::Slide => prop_assert_eq!(force.friction_force, limit),
                    ContactState::ReverseSlide => prop_assert_eq!(force.friction_force, -limit),
                    ContactState::Stick => prop_assert_eq!(force.slip_velocity, 0.0),
                    ContactState::Detached => prop_assert_eq!(force.normal_force, 0.0),
                }
            }
        }
    }

    #[test]
    fn a_run_is_the_same_however_it_is_split(
        scene in any_scene(),
        mut splits in prop::collection::vec(1_u32..2000, 1..20),
    ) {
        let Ok(mut straight) = Simulation::new(scene.clone(), 0.0) else {
            return Err(TestCaseError::reject("no equilibrium"));
        };
        let mut split = Simulation::new(scene.clone(), 0.0).unwrap();
        splits.sort_unstable();
        for count in splits {
            split.advance_to(f64::from(count) * scene.step).unwrap();
            // Looking changes nothing.
            split.contact_forces().unwrap();
        }
        let end = 2000.0 * scene.step;
        straight.advance_to(end).unwrap();
        split.advance_to(end).unwrap();
        prop_assert!(straight.save() == split.save());
    }
}

#[test]
fn inputs_act_from_the_moment_they_change() {
    let scene = builtin("set1").unwrap().scene();
    let all = variables(&scene);
    let find = |name: &str| all.iter().find(|variable| variable.name == name).unwrap();
    let mut simulation = Simulation::new(scene, 0.0).unwrap();
    simulation.advance_to(0.01).unwrap();

    let normal = simulation.read(find("contact[1].normal_force")).unwrap();
    simulation.write(find("module[1].f4"), -25.0).unwrap();
    let pressed = simulation.read(find("contact[1].normal_force")).unwrap();
    assert!((pressed - normal - 25.0).abs() < 1e-9);

    // A deeper preload presses m1 down; after it has settled, every newton arrives at the contacts.
    simulation.write(find("friction.coefficient"), 0.0).unwrap();
    simulation.write(find("damping.beta"), 1e-3).unwrap();
    simulation.write(find("module[1].f4"), 0.0).unwrap();
    simulation.advance_to(3.0).unwrap();
    let before = simulation.read(find("slider.normal_reaction")).unwrap();
    for module in ["module[1].preload", "module[2].preload"] {
        simulation.write(find(module), 6e-3).unwrap();
    }
    simulation.advance_to(6.0).unwrap();
    let after = simulation.read(find("slider.normal_reaction")).unwrap();
    assert!((after / before - 6.0 / 5.0).abs() < 1e-6, "{before} {after}");

    let error = simulation.write(find("module[1].k2"), 1.0).unwrap_err();
    assert!(error.is_variable() && error.to_string().contains("module[1].k2"), "{error}");
}

#[test]
fn a_change_of_damping_that_makes_the_step_too_large_is_refused_when_it_acts() {
    let mut scene = builtin("set1").unwrap().scene();
    scene.step = 1e-4;
    let all = variables(&scene);
    let beta = all.iter().find(|variable| variable.name == "damping.beta").unwrap();
    let mut simulation = Simulation::new(scene.clone(), 0.0).unwrap();
    simulation.write(beta, 0.1).unwrap();
    assert!(simulation.advance_to(0.01).unwrap_err().is_step_too_large());
    // Mended, the same run goes on.
    simulation.write(beta, scene.damping.beta).unwrap();
    simulation.advance_to(0.01).unwrap();
}
