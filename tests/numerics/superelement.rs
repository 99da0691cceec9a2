//! Full matrices with many contacts that share masses: the law of contact in squeal, and that large matrices give the doubles of
//! small ones.

#[path = "../support/brake_pad.rs"]
mod brake_pad;

use amontons::contact::residual::{Instant, Scales, residual};
use amontons::contact::{ContactForce, ContactState};
use amontons::integrator::{Inputs, Method, Motion, choose};
use amontons::model::{Damping, LumpedModel, SparseMatrix};
use amontons::stability::{StepGuard, critical_step};
use brake_pad::{Size, VELOCITY, pad};
use nalgebra::{Complex, DMatrix, DVector};

const FRICTION: f64 = 0.4;

/// The pad in sliding equilibrium, with its modes at this velocity (of √kg m, m√kg/s).
fn start(model: &LumpedModel, size: Size, velocity: f64) -> (Motion, Inputs) {
    let equilibrium = model.equilibrium(&|contact| contact.to_string()).unwrap();
    let mut velocities = vec![0.0; model.dofs()];
    velocities[3 * size.contacts()..].fill(velocity);
    let states = vec![ContactState::Slide; size.contacts()];
    let inputs = Inputs::uniform(model.load.clone(), size.contacts(), VELOCITY, FRICTION);
    (Motion::new(equilibrium.displacement, velocities, states), inputs)
}

#[test]
fn contacts_of_a_pad_open_and_stick_as_the_law_wants() {
    let size = Size::SMALL;
    let model = pad(size, FRICTION);
    for (method, step, tolerance) in
        [(Method::EventDriven, 1e-5, 1e-8), (Method::ForwardIncrement, 1e-7, 1e-4)]
    {
        let (mut motion, inputs) = start(&model, size, 0.03);
        let mut integrator = choose(&model, method).unwrap();
        let mut forces = vec![ContactForce::detached(0.0); size.contacts()];
        for _ in 0..50 {
            integrator.advance(&mut motion, &inputs, step, (2e-5 / step).round() as u64).unwrap();
            integrator.contact_forces(&motion, &inputs, &mut forces).unwrap();
            for (contact, force) in model.contacts.iter().zip(&forces) {
                let instant = Instant {
                    gap: contact.normal.dot(&motion.displacement),
                    gap_velocity: contact.normal.dot(&motion.velocity),
                    slip_velocity: VELOCITY - contact.tangent.dot(&motion.velocity),
                    normal_force: force.normal_force,
                    friction_force: force.friction_force,
                };
                let scales = Scales { length: 1e-6, velocity: VELOCITY, force: 10.0 };
                let violation = residual(&instant, contact.friction, &scales);
                assert!(violation.size < tolerance, "{method}: {violation} {instant:?}");
            }
        }
        let [_, _, sticks, opens] = motion.statistics.entered;
        assert!(sticks > 10 && opens > 10, "{method}: {:?}", motion.statistics);
    }
}

#[test]
fn both_methods_give_one_motion() {
    let size = Size::SMALL;
    let model = pad(size, FRICTION);
    let ends =
        [(Method::EventDriven, 1e-5), (Method::ForwardIncrement, 1e-8)].map(|(method, step)| {
            let (mut motion, inputs) = start(&model, size, 1e-3);
            let mut integrator = choose(&model, method).unwrap();
            integrator.advance(&mut motion, &inputs, step, (2e-4 / step).round() as u64).unwrap();
            motion.velocity
        });
    let most = ends[0].iter().fold(0.0, |most, v| f64::max(most, v.abs()));
    for (exact, found) in ends[0].iter().zip(&ends[1]) {
        assert!((exact - found).abs() < 1e-2 * most, "{exact} {found} of {most}");
    }
}

#[test]
fn a_step_of_the_scheme_is_compared_with_the_states_in_which_all_contacts_are_alike() {
    let model = pad(Size::SMALL, FRICTION);
    let critical = critical_step(&model).unwrap();
    // The highest mode of the free pad, by another way: vibrations of the largest Rayleigh quotient.
    let mass = dense(&model.mass);
    let operator = mass.try_inverse().unwrap() * dense(&model.stiffness);
    let mut shape = DVector::from_fn(model.dofs(), |i, _| 1.0 + (i % 7) as f64);
    let mut square = 0.0;
    for _ in 0..3000 {
        let next = &operator * &shape;
        square = next.norm() / shape.norm();
        shape = next.normalize();
    }
    let limit = 2.0 / f64::sqrt(square);
    assert!(critical.step < limit && critical.step > 0.5 * limit, "{critical} {limit}");
    assert!(critical.to_string().contains("all contacts are alike"), "{critical}");
    assert!(StepGuard::new(&model, 0.99 * critical.step).check(&model).is_ok());
    assert!(StepGuard::new(&model, 1.01 * critical.step).check(&model).is_err());
}

fn dense(matrix: &SparseMatrix) -> DMatrix<f64> {
    DMatrix::from_fn(matrix.rows(), matrix.rows(), |i, j| matrix.get(i, j))
}

#[test]
fn products_of_large_full_matrices_are_those_of_their_rows() {
    for rows in [32, 40, 47, 100] {
        // Full but for a diagonal part, as the matrices of a superelement with modes.
        let value = |i: usize, j: usize| ((7 * i + 13 * j) % 29) as f64 / 3.0 - 4.0;
        let entries = (0..rows).flat_map(|i| (0..rows).map(move |j| (i, j)));
        let entries = entries.filter(|&(i, j)| (i < rows - 10 && j < rows - 10) || i == j);
        let matrix =
            SparseMatrix::from_entries(rows, entries.map(|(i, j)| (i, j, value(i, j))).collect());
        assert!(matrix.is_full());
        let vector: Vec<f64> = (0..rows).map(|i| 1.0 / (3.0 + i as f64)).collect();
        let mut found = Vec::new();
        matrix.each_product(&vector, |row, product| found.push((row, product)));
        let expected: Vec<_> = (0..rows).map(|row| (row, matrix.row_times(row, &vector))).collect();
        assert_eq!(found, expected);
        let mut sums = vec![0.0; rows];
        matrix.add_product(&vector, &mut sums);
        assert_eq!(sums, expected.iter().map(|one| one.1).collect::<Vec<_>>());
    }
}

/// A run begins in the state of the equilibrium, of which gaps leave some contacts open. At 0.999 of a critical step that was taken from
/// states with all contacts alike, a run squealed about an equilibrium in which every mode decays.
#[test]
fn the_scheme_invents_no_growth_in_the_state_of_the_equilibrium() {
    let size = Size::SMALL;
    let mut random = 1_u64;
    let mut next = || {
        random =
            random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (random >> 40) as f64 / 16_777_216.0
    };
    let mut mixed = 0;
    for _ in 0..200 {
        let mut model = pad(size, 0.2 + 0.4 * next());
        model.damping = Damping { alpha: 0.0, beta: 0.0 };
        let n = model.dofs();
        [model.mass, model.stiffness] = [6, 60].map(|count| {
            let mut sum = DMatrix::identity(n, n);
            for _ in 0..count {
                let one = DVector::from_fn(n, |_, _| 2.0 * next() - 1.0);
                sum += &one * one.transpose();
            }
            let entries = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
            SparseMatrix::from_entries(n, entries.map(|(i, j)| (i, j, sum[(i, j)])).collect())
        });
        for contact in &mut model.contacts {
            contact.gap = if next() < 0.4 { 1.0 } else { 0.0 };
        }
        let Ok(equilibrium) = model.equilibrium(&|contact| contact.to_string()) else { continue };
        let states = equilibrium.states(&model);
        mixed += usize::from(states.iter().any(|state| *state != states[0]));
        let critical = critical_step(&model).unwrap().step;
        assert!(StepGuard::new(&model, 0.999 * critical).check(&model).is_ok());
        assert!(StepGuard::new(&model, 1.001 * critical).check(&model).is_err(), "{states:?}");
        let step = 0.999 * critical;
        let reduced = model.linear_about(&equilibrium).reduced(&states).unwrap();
        let squares = reduced.mass.try_inverse().unwrap() * reduced.stiffness;
        for square in squares.complex_eigenvalues().iter().filter(|square| square.im > 0.0) {
            // z² − (2 − h² s) z + 1 = 0 and λ² + s = 0.
            let half = Complex::new(1.0, 0.0) - square * (0.5 * step * step);
            let root = (half * half - 1.0).sqrt();
            let growth = [half + root, half - root].map(|z| z.norm().ln() / step);
            let invented = growth[0].max(growth[1]) - square.sqrt().im.abs();
            let most = 1.001e-3 * square.norm().sqrt();
            assert!(invented <= most, "{invented} 1/s, and {most} may be: {states:?}");
        }
    }
    assert!(mixed > 20, "{mixed}");
}
