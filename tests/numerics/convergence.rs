//! Orders, invariants and limits of the scheme, against closed forms.

use amontons::contact::{ContactLaw, ContactState};
use amontons::integrator::{Inputs, Motion, sparse};
use amontons::model::{Contact, Damping, Direction, LumpedModel, SparseMatrix};
use amontons::scene::{Scene, builtin};
use amontons::simulation::{Simulation, variables};
use amontons::stability::critical_step;
use nalgebra::{DMatrix, DVector};

fn set1() -> Scene {
    builtin("set1").unwrap().scene()
}

fn read(simulation: &mut Simulation, name: &str) -> f64 {
    let variables = variables(simulation.scene());
    let variable = variables.iter().find(|variable| variable.name == name).unwrap();
    simulation.read(variable).unwrap()
}

/// x1 … x3 of both modules after `end` seconds.
fn upper(scene: &Scene, end: f64) -> Vec<f64> {
    let mut simulation = Simulation::new(scene.clone(), 0.0).unwrap();
    simulation.advance_to(end).unwrap();
    let names = (1..=2).flat_map(|i| (1..=3).map(move |j| format!("module[{i}].x{j}")));
    names.map(|name| read(&mut simulation, &name)).collect()
}

/// The slopes of log error against log step between neighbouring steps.
fn orders(errors: &[(f64, f64)]) -> Vec<f64> {
    errors.windows(2).map(|w| (w[0].1 / w[1].1).ln() / (w[0].0 / w[1].0).ln()).collect()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

#[test]
fn uniform_sliding_converges_at_first_order_to_the_matrix_exponential() {
    let end = 0.05;
    let mut scene = set1();
    scene.modules_mut()[0].velocity = [1e-3, 2e-3, 0.0, 0.0];
    let model = LumpedModel::from(&scene);
    let reduced = model.linear().unwrap().reduced(&[ContactState::Slide; 2]).unwrap();
    let size = reduced.mass.nrows();
    let inverse = reduced.mass.try_inverse().unwrap();
    let mut flow = DMatrix::zeros(2 * size, 2 * size);
    flow.view_mut((0, size), (size, size)).fill_with_identity();
    flow.view_mut((size, 0), (size, size)).copy_from(&(-&inverse * &reduced.stiffness));
    flow.view_mut((size, size), (size, size)).copy_from(&(-&inverse * &reduced.damping));
    // u are the degrees of freedom that sliding leaves, in their order: x1, x2, x3 of each module.
    let mut start = DVector::zeros(2 * size);
    start[size] = 1e-3;
    start[size + 1] = 2e-3;
    let exact = (flow * end).exp() * start;

    let errors: Vec<(f64, f64)> = [1e-5, 5e-6, 2.5e-6, 1.25e-6]
        .map(|step| {
            (
                step,
                distance(&upper(&Scene { step, ..scene.clone() }, end), &exact.as_slice()[..size]),
            )
        })
        .to_vec();
    for order in orders(&errors) {
        assert!((0.95..1.05).contains(&order), "{errors:?}");
    }
}

#[test]
fn stick_slip_and_impacts_converge_at_first_order() {
    let end = 0.02;
    let mut scene = set1();
    scene.modules_mut()[0].velocity[0] = 0.05;
    scene.modules_mut()[1].velocity[3] = 0.3;
    let reference = upper(&Scene { step: 2e-9, ..scene.clone() }, end);
    // Events fall on the grid, at a random part of a step: errors scatter about the order, so the
    // mean slope over a factor of 64 is measured.
    let error = |step: f64| distance(&upper(&Scene { step, ..scene.clone() }, end), &reference);
    let mean = |step: f64| (0..8).map(|i| error(step * (1.0 + 0.01 * f64::from(i)))).sum::<f64>();
    let order = (mean(1.28e-5) / mean(2e-7)).log2() / 6.0;
    assert!((0.9..1.1).contains(&order), "{order}");
}

/// Three masses in a row between walls, without contacts.
fn row_of_masses(damping: Damping) -> LumpedModel {
    let (k, m) = (1e4, [0.5, 1.0, 0.25]);
    let entries =
        (0..3).flat_map(|i| [(i, i, 2.0 * k)].into_iter().chain((i > 0).then(|| (i, i - 1, -k))));
    let lower: Vec<_> = entries.collect();
    let upper: Vec<_> = lower.iter().filter(|e| e.0 != e.1).map(|&(i, j, v)| (j, i, v)).collect();
    LumpedModel {
        mass: SparseMatrix::diagonal(&m),
        stiffness: SparseMatrix::from_entries(3, [lower, upper].concat()),
        damping,
        dampers: SparseMatrix::zero(3),
        load: vec![0.0; 3],
        contacts: vec![],
        law: ContactLaw::default(),
    }
}

fn at_rest(dofs: usize, contacts: Vec<ContactState>) -> Motion {
    Motion::new(vec![0.0; dofs], vec![0.0; dofs], contacts)
}

fn no_drive(dofs: usize) -> Inputs {
    Inputs::uniform(vec![0.0; dofs], 0, 0.0, 0.0)
}

#[test]
fn below_the_critical_step_motion_stays_bounded_and_above_it_does_not() {
    for damping in [Damping::default(), Damping { alpha: 3.0, beta: 1e-3 }] {
        let model = row_of_masses(damping);
        let limit = critical_step(&model).unwrap().step;
        let largest = |step: f64, steps: u64| {
            let mut motion = at_rest(3, vec![]);
            motion.velocity[1] = 1.0;
            let mut integrator = sparse(&model).unwrap();
            integrator.advance(&mut motion, &no_drive(3), step, steps).unwrap();
            motion.displacement.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()))
        };
        assert!(largest(0.99 * limit, 20_000) < 0.1);
        assert!(largest(1.01 * limit, 200) > 1e6);
    }
}

#[test]
fn without_damping_the_scheme_keeps_its_own_energy() {
    let model = row_of_masses(Damping::default());
    let step = 0.5 * critical_step(&model).unwrap().step;
    let mut motion = at_rest(3, vec![]);
    motion.velocity = vec![1.0, -0.5, 0.2];
    let mut integrator = sparse(&model).unwrap();
    let energies = |motion: &Motion| {
        let (x, v) = (&motion.displacement, &motion.velocity);
        let force: Vec<f64> = (0..3).map(|i| model.stiffness.row_times(i, x)).collect();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let kinetic: f64 = (0..3).map(|i| 0.5 * model.mass.get(i, i) * v[i] * v[i]).sum();
        let energy = kinetic + 0.5 * dot(x, &force);
        (energy, energy - 0.5 * step * dot(v, &force))
    };
    let (start, kept) = energies(&motion);
    let mut swing = 0.0_f64;
    for _ in 0..10_000 {
        integrator.advance(&mut motion, &no_drive(3), step, 1).unwrap();
        let (energy, own) = energies(&motion);
        assert!((own - kept).abs() < 1e-11 * kept);
        swing = swing.max((energy - start).abs());
    }
    // The true energy is not kept: it swings by a good part of itself.
    assert!(swing > 0.1 * start);
}

/// A free mass of 1 kg above a slider at rest, pushed down by `weight`.
fn free_mass(weight: f64) -> (LumpedModel, Inputs) {
    let model = LumpedModel {
        mass: SparseMatrix::diagonal(&[1.0, 1.0]),
        stiffness: SparseMatrix::from_entries(2, vec![]),
        damping: Damping::default(),
        dampers: SparseMatrix::zero(2),
        load: vec![0.0; 2],
        contacts: vec![Contact::new(Direction::unit(1), Direction::unit(0))],
        law: ContactLaw::default(),
    };
    (model, Inputs::uniform(vec![0.0, -weight], 1, 0.0, 0.3))
}

#[test]
fn a_touch_down_is_an_inelastic_impact_with_friction() {
    // It lands with v_N = −√(2 g y); friction takes µ |v_N| of the tangential velocity in the
    // impact, then µ g a second until the mass stands still.
    let (model, drive) = free_mass(10.0);
    let mut integrator = sparse(&model).unwrap();
    let mut motion = at_rest(2, vec![ContactState::Detached]);
    (motion.displacement, motion.velocity) = (vec![0.0, 0.05], vec![1.0, 0.0]);
    let step = 1e-6;
    integrator.advance(&mut motion, &drive, step, 90_000).unwrap();
    assert_eq!((motion.velocity[0], motion.contacts[0]), (1.0, ContactState::Detached));
    integrator.advance(&mut motion, &drive, step, 20_000).unwrap();
    let fall = (2.0 * 0.05 / 10.0_f64).sqrt();
    let expected = 1.0 - 0.3 * 10.0 * fall - 0.3 * 10.0 * (0.11 - fall);
    assert!((motion.velocity[0] - expected).abs() < 1e-4, "{motion:?} {expected}");
    assert_eq!((motion.displacement[1], motion.velocity[1]), (0.0, 0.0));
    assert_eq!(motion.statistics.touch_downs, 1);
    integrator.advance(&mut motion, &drive, step, 1_000_000).unwrap();
    assert_eq!((motion.velocity[0], motion.contacts[0]), (0.0, ContactState::Stick));
}

#[test]
fn a_mass_at_rest_under_friction_does_not_creep() {
    let (model, mut drive) = free_mass(10.0);
    drive.force[0] = 2.9; // below µ N = 3
    let mut integrator = sparse(&model).unwrap();
    let mut motion = at_rest(2, vec![ContactState::Stick]);
    integrator.advance(&mut motion, &drive, 1e-3, 100_000).unwrap();
    assert_eq!((motion.displacement, motion.velocity), (vec![0.0; 2], vec![0.0; 2]));
}

#[test]
fn the_equilibrium_is_an_exact_fixed_point_even_where_it_is_unstable() {
    let mut scene = set1();
    scene.modules_mut()[0].velocity[0] = 0.0;
    let mut simulation = Simulation::new(scene, 0.0).unwrap();
    simulation.advance_to(0.5).unwrap();
    for variable in ["module[1].x1", "module[2].v3", "module[2].x4"] {
        assert_eq!(read(&mut simulation, variable), 0.0);
    }
}

#[test]
fn equal_modules_pushed_equally_stay_equal_to_the_last_bit() {
    let mut scene = set1();
    let module = scene.modules()[1];
    scene.modules_mut().resize(5, module);
    for module in scene.modules_mut() {
        module.velocity = [0.3, 0.2, 0.0, 0.0];
    }
    let mut simulation = Simulation::new(scene, 0.0).unwrap();
    simulation.advance_to(0.1).unwrap();
    assert!(simulation.statistics().state_changes() > 5);
    for quantity in ["x1", "x2", "x3", "x4", "v3"] {
        let first = read(&mut simulation, &format!("module[1].{quantity}"));
        for module in 2..=5 {
            assert_eq!(read(&mut simulation, &format!("module[{module}].{quantity}")), first);
        }
    }
}
