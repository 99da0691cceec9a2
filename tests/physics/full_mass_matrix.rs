//! A full mass matrix, which no scene has: models that are given to the library directly.

use crate::judge::blocks::pads;
use crate::judge::{METHODS, Run, assert_near, off, scene};
use amontons::contact::ContactLaw;
use amontons::contact::ContactState::{self, Detached, Slide, Stick};
use amontons::integrator::{Inputs, Motion, choose};
use amontons::model::{Contact, Damping, Direction, LumpedModel, SparseMatrix};
use amontons::scene::{Method, Scene, builtin};
use nalgebra::{DMatrix, DVector};

fn sparse(matrix: &DMatrix<f64>) -> SparseMatrix {
    let n = matrix.nrows();
    let entries = (0..n).flat_map(|i| (0..n).map(move |j| (i, j, matrix[(i, j)])));
    SparseMatrix::from_entries(n, entries.filter(|entry| entry.2 != 0.0).collect())
}

/// A uniform rod that lies along a slider, as the heights of its two ends and its way along: M is full
/// because it turns. Both ends may touch.
fn rod(mass: f64, weight: f64) -> LumpedModel {
    let part = mass / 6.0;
    let full = DMatrix::from_row_slice(3, 3, &[2.0, 1.0, 0.0, 1.0, 2.0, 0.0, 0.0, 0.0, 6.0]);
    let end = |dof| Contact::new(Direction::unit(dof), Direction::unit(2));
    LumpedModel {
        mass: sparse(&(full * part)),
        stiffness: SparseMatrix::zero(3),
        damping: Damping { alpha: 0.0, beta: 0.0 },
        dampers: SparseMatrix::zero(3),
        load: vec![-0.5 * weight, -0.5 * weight, 0.0],
        contacts: vec![end(0), end(1)],
        law: ContactLaw::default(),
    }
}

#[test]
fn a_rod_that_falls_on_one_end_is_thrown_on_the_other_by_one_and_a_half_times_its_velocity() {
    let (mass, g, mu, belt): (f64, f64, f64, f64) = (1.6, 10.0, 0.3, 1.635);
    let (low, high) = (0.05_f64, 0.2);
    // It falls freely; the end that lands stops with m v/4, and the other one goes on with 1.5 v and 1.5 g,
    // while a quarter of the weight lies on the first. Then both stop, with m w/6 and m w/3.
    let first = (2.0 * low / g).sqrt();
    let v = g * first;
    let falls = ((2.25 * v * v + 3.0 * g * (high - low)).sqrt() - 1.5 * v) / (1.5 * g);
    let second = first + falls;
    let w = 1.5 * v + 1.5 * g * falls;
    // Along the slider friction has µ of each of these.
    let [a, b] = [0.25 * mu * v, 0.5 * mu * w];
    let landed = a + 0.25 * mu * g * falls + b;
    let third = second + (belt - landed) / (mu * g);
    let expected = |t: f64| -> ([f64; 3], [ContactState; 2], [f64; 2]) {
        if t < first {
            let fallen = 0.5 * g * t * t;
            return ([low - fallen, high - fallen, 0.0], [Detached; 2], [0.0; 2]);
        }
        if t < second {
            let s = t - first;
            let y = high - low - 1.5 * v * s - 0.75 * g * s * s;
            let x = a * s + 0.125 * mu * g * s * s;
            return ([0.0, y, x], [Slide, Detached], [0.25 * mass * g, 0.0]);
        }
        let way = a * falls + 0.125 * mu * g * falls * falls;
        let s = t.min(third) - second;
        let slid = way + landed * s + 0.5 * mu * g * s * s;
        let state = if t < third { Slide } else { Stick };
        let x = slid + belt * (t - third).max(0.0);
        ([0.0, 0.0, x], [state; 2], [0.5 * mass * g; 2])
    };
    assert!(landed < belt && third < 1.0);
    for method in METHODS {
        let h = off(method, 1e-5, 1e-2);
        let model = rod(mass, mass * g);
        let drive = Inputs::uniform(model.load.clone(), 2, belt, mu);
        let mut integrator = choose(&model, method).unwrap();
        let mut motion = Motion::new(vec![low, high, 0.0], vec![0.0; 3], vec![Detached; 2]);
        let mut forces = [amontons::contact::ContactForce::detached(0.0); 2];
        for row in 1..=100 {
            integrator.advance(&mut motion, &drive, h, off(method, 1000.0, 1.0) as u64).unwrap();
            let t = 0.01 * f64::from(row);
            let (place, states, normal) = expected(t);
            // The scheme lands up to a step late, at up to w; so late friction begins, and ends.
            let tolerance = off(method, 4.0 * h * (w + belt), 1e-14);
            for (found, expected) in motion.displacement.iter().zip(place) {
                assert_near(*found, expected, tolerance);
            }
            assert_eq!(motion.contacts, states, "{method:?} at {t} s");
            integrator.contact_forces(&motion, &drive, &mut forces).unwrap();
            if states[0] != states[1] {
                assert_near(forces[0].normal_force, normal[0], 1e-12 * mass * g);
            }
            let total = forces[0].normal_force + forces[1].normal_force;
            assert_near(total, normal[0] + normal[1], 1e-12 * mass * g);
        }
    }
}

/// The structure in coordinates y with x = P y.
fn in_coordinates(model: &LumpedModel, p: &DMatrix<f64>) -> LumpedModel {
    let n = model.dofs();
    let transformed = |matrix: &SparseMatrix| {
        let dense = DMatrix::from_fn(n, n, |i, j| matrix.get(i, j));
        sparse(&(p.transpose() * dense * p))
    };
    let row = |direction: &Direction| {
        let mut dense = DVector::zeros(n);
        direction.0.iter().for_each(|&(dof, value)| dense[dof] = value);
        let row = p.transpose() * dense;
        Direction(row.iter().copied().enumerate().filter(|part| part.1 != 0.0).collect())
    };
    let contact = |contact: &Contact| Contact {
        normal: row(&contact.normal),
        tangent: row(&contact.tangent),
        ..contact.clone()
    };
    LumpedModel {
        mass: transformed(&model.mass),
        stiffness: transformed(&model.stiffness),
        damping: model.damping,
        dampers: transformed(&model.dampers),
        load: (p.transpose() * DVector::from_column_slice(&model.load)).as_slice().to_vec(),
        contacts: model.contacts.iter().map(contact).collect(),
        law: ContactLaw::default(),
    }
}

/// Runs a scene under the judge and its model in coordinates y beside it; x and P y must stay alike. The
/// states of contacts met on the way.
fn beside(scene: &Scene, p: &DMatrix<f64>, end: f64) -> Vec<ContactState> {
    let mut run = Run::new(scene.clone(), Method::EventDriven);
    let model = in_coordinates(&run.model, p);
    assert!(model.mass.as_diagonal().is_none());
    let inverse = p.clone().try_inverse().unwrap();
    let acting = run.acting(0.0);
    let load = p.transpose() * &acting.force;
    let mut drive = Inputs::uniform(load.as_slice().to_vec(), model.contacts.len(), 0.0, 0.0);
    drive.slider_velocity.clone_from(&acting.slider_velocity);
    drive.friction.clone_from(&acting.friction);
    let place = &inverse * run.total(&run.now[0]);
    let mut motion = Motion::new(
        place.as_slice().to_vec(),
        (&inverse * &run.now[1]).as_slice().to_vec(),
        run.states(),
    );
    let mut integrator = choose(&model, Method::EventDriven).unwrap();
    let mut met = Vec::new();
    while run.time() < end {
        run.step();
        run.judge_step();
        run.judge_report();
        integrator.advance(&mut motion, &drive, run.h(), 1).unwrap();
        assert_eq!(motion.contacts, run.states(), "at {} s", run.time());
        for state in run.states() {
            if !met.contains(&state) {
                met.push(state);
            }
        }
        let found = [&motion.displacement, &motion.velocity].map(|y| p * DVector::from(y.clone()));
        for (found, expected) in found.iter().zip([run.total(&run.now[0]), run.now[1].clone()]) {
            let off = (found - &expected).amax();
            assert!(off <= 1e-10 * expected.amax(), "at {} s {off:e} of {expected:?}", run.time());
        }
    }
    met
}

#[test]
fn a_structure_moves_the_same_in_coordinates_that_make_its_mass_matrix_full() {
    let mut set1 = Scene { step: 1e-4, ..builtin("set1").unwrap().scene() };
    (set1.friction_coefficient, set1.static_friction) = (1.96, Some(2.4));
    for (module, velocity) in
        set1.modules_mut().iter_mut().zip([[0.5, 0.2, -0.4, 1.5], [-0.3, 0.0, 0.4, 0.1]])
    {
        module.velocity = velocity;
    }
    for scene in [set1, scene(&pads(2, 2.0, 1e-4))] {
        let n = LumpedModel::from(&scene).dofs();
        // The first two degrees of freedom of a module or a pad belong to the arm that carries the others.
        let relative =
            DMatrix::from_fn(n, n, |i, j| f64::from(u8::from(i == j || (i % 4 < 2 && j == i + 2))));
        let mixed = DMatrix::from_fn(n, n, |i, j| {
            if i == j { 1.0 } else { 0.1 * f64::sin((7 * i + 3 * j) as f64) }
        });
        for p in [relative, mixed] {
            let met = beside(&scene, &p, 0.1);
            assert_eq!([Slide, Stick, Detached].map(|state| met.contains(&state)), [true; 3]);
        }
    }
}
