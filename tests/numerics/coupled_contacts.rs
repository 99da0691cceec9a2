//! Contacts that masses couple, against a brute-force search of all contact
//! states, and the general integrator against the one for rings.

use amontons::contact::{ContactLaw, ContactState, Friction, all_states};
use amontons::integrator::{Inputs, Integrator, Motion, RingForwardIncrement, sparse};
use amontons::model::{Contact, Damping, Direction, Entry, LumpedModel, SparseMatrix};
use amontons::scene::builtin;
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;

const STEP: f64 = 1e-4;

/// Masses with a full mass matrix, a contact on every pair of degrees of freedom.
fn model(contacts: usize, coupling: &[f64]) -> LumpedModel {
    let dofs = 2 * contacts;
    let mut entries: Vec<Entry> = Vec::new();
    let mut coupling = coupling.iter().cycle();
    for i in 0..dofs {
        entries.push((i, i, 1.0));
        for j in 0..i {
            // Diagonally dominant, so positive definite.
            let value =
                0.98 / f64::from(u8::try_from(dofs - 1).unwrap()) * coupling.next().unwrap();
            entries.extend([(i, j, value), (j, i, value)]);
        }
    }
    LumpedModel {
        mass: SparseMatrix::from_entries(dofs, entries),
        stiffness: SparseMatrix::diagonal(&vec![50.0; dofs]),
        damping: Damping { alpha: 0.1, beta: 1e-4 },
        dampers: SparseMatrix::zero(dofs),
        load: vec![0.0; dofs],
        contacts: (0..contacts)
            .map(|i| Contact::new(Direction::unit(2 * i + 1), Direction::unit(2 * i)))
            .collect(),
        law: ContactLaw::default(),
    }
}

fn closed(contacts: usize, velocity: &[f64]) -> Motion {
    let mut velocity: Vec<f64> = velocity.iter().copied().cycle().take(2 * contacts).collect();
    velocity.chunks_exact_mut(2).for_each(|v| v[1] = 0.0);
    Motion::new(vec![0.0; 2 * contacts], velocity, vec![ContactState::Slide; contacts])
}

/// The velocities after one step, from the contact states that contradict none of their own assumptions:
/// each gives linear equations for velocities and forces. With static friction there may be several.
fn by_enumeration(model: &LumpedModel, motion: &Motion, drive: &Inputs) -> Vec<DVector<f64>> {
    let (n, m) = (model.dofs(), model.contacts.len());
    let dense = |matrix: &SparseMatrix| DMatrix::from_fn(n, n, |i, j| matrix.get(i, j));
    let (mass, stiffness) = (dense(&model.mass), dense(&model.stiffness));
    let damping = &mass * model.damping.alpha + &stiffness * model.damping.beta;
    let (x, v) =
        (DVector::from(motion.displacement.clone()), DVector::from(motion.velocity.clone()));
    let impulse = (DVector::from(drive.force.clone()) - damping * &v - stiffness * x) * STEP;
    let Friction { kinetic, static_, .. } = drive.friction[0];
    all_states(u32::try_from(m).unwrap())
        .filter_map(|states| {
            // Unknowns: v⁺, then N and T of each contact.
            let mut a = DMatrix::zeros(n + 2 * m, n + 2 * m);
            let mut b = DVector::zeros(n + 2 * m);
            a.view_mut((0, 0), (n, n)).copy_from(&mass);
            b.rows_mut(0, n).copy_from(&(&mass * &v + &impulse));
            for (i, state) in states.iter().enumerate() {
                let (tangent, normal) = (2 * i, 2 * i + 1);
                let (row, force) = (n + 2 * i, n + 2 * i);
                a[(normal, force)] = -STEP;
                a[(tangent, force + 1)] = -STEP;
                match state {
                    ContactState::Detached => {
                        a[(row, force)] = 1.0;
                        a[(row + 1, force + 1)] = 1.0;
                    }
                    ContactState::Stick => {
                        a[(row, normal)] = 1.0;
                        a[(row + 1, tangent)] = 1.0;
                        b[row + 1] = drive.slider_velocity[0];
                    }
                    sliding => {
                        a[(row, normal)] = 1.0;
                        a[(row + 1, force + 1)] = 1.0;
                        a[(row + 1, force)] = -kinetic * sliding.sliding_direction().unwrap();
                    }
                }
            }
            let solution = a.lu().solve(&b)?;
            let consistent = states.iter().enumerate().all(|(i, state)| {
                let (slip, lift) =
                    (drive.slider_velocity[0] - solution[2 * i], solution[2 * i + 1]);
                let (normal, force) = (solution[n + 2 * i], solution[n + 2 * i + 1]);
                match state {
                    ContactState::Detached => lift >= 0.0,
                    ContactState::Stick => normal >= 0.0 && force.abs() <= static_ * normal,
                    ContactState::Slide => normal >= 0.0 && slip >= 0.0,
                    ContactState::ReverseSlide => normal >= 0.0 && slip <= 0.0,
                }
            });
            consistent.then(|| solution.rows(0, n).into_owned())
        })
        .collect()
}

proptest! {
    // Also with strong friction on masses that are coupled almost singularly, where Gauss–Seidel does not converge.
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn the_step_finds_the_state_that_brute_force_finds(
        contacts in 2_usize..=3,
        coupling in prop::collection::vec(-1.0..1.0, 15),
        velocity in prop::collection::vec(-0.02..0.02, 6),
        force in prop::collection::vec(-100.0..60.0, 6),
        friction in 0.0..3.0,
    ) {
        let model = model(contacts, &coupling);
        let mut motion = closed(contacts, &velocity);
        let drive = Inputs::uniform(force[..2 * contacts].to_vec(), contacts, 0.005, friction);
        let candidates = by_enumeration(&model, &motion, &drive);
        let mut integrator = sparse(&model).unwrap();
        integrator.advance(&mut motion, &drive, STEP, 1).unwrap();
        let found = DVector::from(motion.velocity.clone());
        prop_assert!(
            candidates.iter().any(|candidate| (candidate - &found).amax() < 1e-11),
            "{found} is none of {candidates:?}"
        );
    }

    // A contact that is released loads its neighbours, and they may push it back.
    #[test]
    fn with_static_friction_it_finds_a_state_that_contradicts_nothing(
        contacts in 2_usize..=3,
        coupling in prop::collection::vec(-1.0..1.0, 15),
        velocity in prop::collection::vec(-0.02..0.02, 6),
        stuck in any::<bool>(),
        force in prop::collection::vec(-100.0..60.0, 6),
        kinetic in 0.0..3.0,
        part in 1.0..3.0,
    ) {
        let model = model(contacts, &coupling);
        let mut motion = closed(contacts, &velocity);
        if stuck {
            motion.velocity.chunks_exact_mut(2).for_each(|v| v[0] = 0.005);
            motion.contacts.fill(ContactState::Stick);
        }
        let friction = Friction::with_static(kinetic, part * kinetic);
        let drive = Inputs::uniform(force[..2 * contacts].to_vec(), contacts, 0.005, friction);
        let candidates = by_enumeration(&model, &motion, &drive);
        let mut integrator = sparse(&model).unwrap();
        integrator.advance(&mut motion, &drive, STEP, 1).unwrap();
        let found = DVector::from(motion.velocity.clone());
        prop_assert!(
            candidates.iter().any(|candidate| (candidate - &found).amax() < 1e-11),
            "{found} is none of {candidates:?}"
        );
    }
}

#[test]
fn two_contacts_that_hold_one_mass_in_a_groove_converge_and_keep_it_there() {
    // A mass in a V of two sliders at ±60°: both normals hold it, both tangents are redundant.
    let (s, c) = (0.75_f64.sqrt(), 0.5);
    let model = LumpedModel {
        mass: SparseMatrix::diagonal(&[2.0, 2.0]),
        stiffness: SparseMatrix::diagonal(&[100.0, 100.0]),
        damping: Damping { alpha: 0.0, beta: 1e-3 },
        dampers: SparseMatrix::zero(2),
        load: vec![0.0; 2],
        contacts: vec![
            Contact::new(Direction(vec![(0, s), (1, c)]), Direction(vec![(0, c), (1, -s)])),
            Contact::new(Direction(vec![(0, -s), (1, c)]), Direction(vec![(0, c), (1, s)])),
        ],
        law: ContactLaw::default(),
    };
    let drive = Inputs::uniform(vec![3.0, -20.0], 2, 0.0, 0.3);
    let mut motion = Motion::new(vec![0.0; 2], vec![0.0; 2], vec![ContactState::Stick; 2]);
    let mut integrator = sparse(&model).unwrap();
    integrator.advance(&mut motion, &drive, STEP, 10_000).unwrap();
    assert!(motion.statistics.most_sweeps > 2, "{:?}", motion.statistics);
    for x in motion.displacement.iter().chain(&motion.velocity) {
        assert!(x.abs() < 1e-12, "{motion:?}");
    }
    let mut forces = [amontons::contact::ContactForce::detached(0.0); 2];
    integrator.contact_forces(&motion, &drive, &mut forces).unwrap();
    // Both contacts together balance the load.
    let mut balance = drive.force.clone();
    for (contact, force) in model.contacts.iter().zip(&forces) {
        contact.normal.add_to(&mut balance, force.normal_force);
        contact.tangent.add_to(&mut balance, force.friction_force);
    }
    assert!(balance.iter().all(|rest| rest.abs() < 1e-9), "{balance:?} {forces:?}");
}

#[test]
fn a_ring_moves_the_same_through_the_general_integrator() {
    let mut scene = builtin("set1").unwrap().scene();
    scene.modules_mut().extend_from_within(..1);
    let model = LumpedModel::from(&scene);
    let equilibrium = model.equilibrium(&|contact| contact.to_string()).unwrap();
    let mut drive = Inputs::uniform(vec![0.0; model.dofs()], 3, 0.025, 1.96);
    for (i, contact) in model.contacts.iter().enumerate() {
        contact.normal.add_to(&mut drive.force, -equilibrium.normal_force[i]);
        contact.tangent.add_to(&mut drive.force, -equilibrium.friction_force[i]);
    }
    // Each contact with its own µ and v, and then all with the same.
    let mut own = drive.clone();
    (own.friction[1], own.slider_velocity[2]) = (1.2.into(), -0.03);
    let mut start = closed(6, &[0.0]);
    start.contacts = vec![ContactState::Slide; 3];
    start.velocity[0] = 0.3;
    start.velocity[7] = 0.4;
    let run = |integrator: &mut dyn Integrator, drive: &Inputs| {
        let mut motion = start.clone();
        integrator.advance(&mut motion, drive, 1e-5, 5_000).unwrap();
        motion
    };
    for drive in [&drive, &own] {
        let ring = run(&mut RingForwardIncrement::new(&model).unwrap(), drive);
        let general = run(&mut *sparse(&model).unwrap(), drive);
        assert!(ring.statistics.state_changes() > 10 && ring.statistics.touch_downs > 0);
        assert_eq!(ring.statistics.state_changes(), general.statistics.state_changes());
        assert_eq!((ring.statistics.most_sweeps, general.statistics.most_sweeps), (1, 1));
        for (a, b) in ring.displacement.iter().zip(&general.displacement) {
            assert!((a - b).abs() < 1e-14, "{a} {b}");
        }
    }
}
