//! The kernels of the paper's scheme: how many there are, and that the choice among them leaves no trace.

use amontons::contact::ContactState::{self, Slide};
use amontons::contact::{ContactLaw, Friction, Law};
use amontons::integrator::{
    Inputs, Integrator, Motion, RingForwardIncrement, Statistics, choose, dense, kernels, sparse,
};
use amontons::model::{Damping, LumpedModel, SparseMatrix};
use amontons::scene::{Method, builtin, parse};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

#[test]
fn a_structure_has_few_kernels() {
    let all = kernels();
    let mut count = BTreeMap::new();
    for kernel in &all {
        *count.entry(kernel.structure).or_insert(0) += 1;
    }
    assert_eq!(count.len(), 4, "rings, lone modules, sparse and dense networks: {count:?}");
    // The kernels of rings hold the law of friction, with a fixed direction or not, beside whether contacts open and
    // whether there is damping. Those of networks are the same for all laws.
    let most =
        |structure| if ["ring", "modules"].contains(structure) { 8 * Law::ALL.len() } else { 32 };
    assert!(count.iter().all(|(structure, &kernels)| kernels <= most(structure)), "{count:?}");
    let different: BTreeSet<_> = all.iter().map(|kernel| format!("{kernel:?}")).collect();
    assert_eq!(different.len(), all.len());
}

/// A chain of masses on inclined springs, of so many degrees of freedom; the last mass rubs.
fn chain(dofs: usize, contact: bool) -> LumpedModel {
    let mut text =
        "[slider]\nvelocity = 0.05\nangle = 0.1\n[friction]\ncoefficient = 0.4\nstatic = 0.6\n\
                    [integrator]\nstep = 1e-5\n"
            .to_owned();
    let masses = dofs.div_ceil(2);
    for i in 0..masses {
        let lock = if i == 0 && dofs % 2 == 1 { "locked = [\"x\"]\n" } else { "" };
        let before = if i == 0 { "ground".to_owned() } else { format!("m{}", i - 1) };
        let mass = 0.2 + 0.07 * i as f64;
        let _ = write!(
            text,
            "[[mass]]\nname = \"m{i}\"\nmass = {mass}\nforce = [0.0, -9.0]\n{lock}\
             [[spring]]\nname = \"a{i}\"\nbetween = [\"m{i}\", \"{before}\"]\ndirection = 0.3\nstiffness = 3e4\n\
             [[spring]]\nname = \"b{i}\"\nbetween = [\"m{i}\", \"ground\"]\ndirection = 1.9\nstiffness = 2e4\n"
        );
    }
    let last = masses - 1;
    if contact {
        let _ = write!(text, "[[contact]]\nname = \"c\"\nmass = \"m{last}\"\n");
    }
    LumpedModel::from(&parse("chain", &text).unwrap())
}

fn of_scene(name: &str) -> LumpedModel {
    LumpedModel::from(&builtin(name).unwrap().scene())
}

/// A motion that slides, sticks and opens where it can.
fn moved(integrator: &mut dyn Integrator, model: &LumpedModel) -> Motion {
    let contacts = model.contacts.len();
    let friction = Friction::with_static(0.4, 0.6);
    let drive = Inputs::uniform(model.load.clone(), contacts, 0.05, friction);
    let velocity = (0..model.dofs()).map(|i| 0.02 * (i as f64 - 1.3)).collect();
    let mut motion = Motion::new(vec![0.0; model.dofs()], velocity, vec![Slide; contacts]);
    for _ in 0..3 {
        integrator.advance(&mut motion, &drive, 1e-5, 2_000).unwrap();
    }
    motion
}

/// All that a motion is, as bits.
fn bits(motion: &Motion) -> (Vec<u64>, Vec<ContactState>, Statistics) {
    let numbers = motion.displacement.iter().chain(&motion.velocity);
    (numbers.map(|x| x.to_bits()).collect(), motion.contacts.clone(), motion.statistics)
}

/// The model without damping, with Rayleigh damping, and with discrete dampers as well.
fn damped(model: &LumpedModel) -> [LumpedModel; 3] {
    let mut none = model.clone();
    none.damping = Damping { alpha: 0.0, beta: 0.0 };
    none.dampers = SparseMatrix::zero(model.dofs());
    let mut rayleigh = none.clone();
    rayleigh.damping = Damping { alpha: 3.0, beta: 2e-5 };
    let mut dampers = rayleigh.clone();
    let entries = model.stiffness.entries().map(|(i, j, k)| (i, j, 1e-4 * k));
    dampers.dampers = SparseMatrix::from_entries(model.dofs(), entries.collect());
    [none, rayleigh, dampers]
}

#[test]
fn full_matrices_give_the_doubles_of_sparse_ones() {
    let chains = (1..=16).flat_map(|dofs| [chain(dofs, false), chain(dofs, true)]);
    let scenes = ["corner", "disc_brake", "hoffmann", "stick_slip", "den_hartog", "belt"];
    let mut changes = 0;
    for model in chains.chain(scenes.map(of_scene)) {
        for model in damped(&model) {
            let a = moved(&mut *dense(&model).unwrap().expect("few degrees of freedom"), &model);
            let b = moved(&mut *sparse(&model).unwrap(), &model);
            assert_eq!(bits(&a), bits(&b));
            changes += a.statistics.state_changes();
            assert!(a.contacts.is_empty() || a.statistics.sweeps >= a.statistics.steps);
        }
    }
    assert!(changes > 100, "{changes}");
}

#[test]
fn a_full_mass_matrix_that_is_diagonal_after_all_moves_as_a_diagonal_one() {
    // Two equal masses whose coupling is too small to matter: only the kernel differs.
    let diagonal = chain(4, true);
    let mut full = diagonal.clone();
    let tiny = [(0, 2, 1e-300), (2, 0, 1e-300)];
    full.mass = SparseMatrix::from_entries(4, diagonal.mass.entries().chain(tiny).collect());
    for (diagonal, full) in damped(&diagonal).iter().zip(damped(&full)) {
        assert!(dense(&full).unwrap().is_none());
        let a = moved(&mut *choose(diagonal, Method::ForwardIncrement).unwrap(), diagonal);
        let b = moved(&mut *choose(&full, Method::ForwardIncrement).unwrap(), &full);
        assert_eq!((&a.contacts, a.statistics), (&b.contacts, b.statistics));
        let numbers = |motion: &Motion| [&motion.displacement[..], &motion.velocity].concat();
        for (a, b) in numbers(&a).iter().zip(numbers(&b)) {
            // M⁻¹ comes from M's factors: it is a last digit off.
            assert!((a - b).abs() < 1e-12 * a.abs().max(1e-3), "{a} {b}");
        }
    }
}

#[test]
fn damping_that_is_changed_acts_as_if_it_had_been_there_from_the_start() {
    for dofs in [2, 5] {
        let [none, rayleigh, _] = damped(&chain(dofs, true));
        for make in [
            |model: &LumpedModel| dense(model).unwrap().unwrap(),
            |model: &LumpedModel| sparse(model).unwrap(),
        ] {
            let mut changed = make(&none);
            let undamped = bits(&moved(&mut *changed, &none));
            changed.set_damping(rayleigh.damping);
            let expected = bits(&moved(&mut *make(&rayleigh), &rayleigh));
            assert_eq!(bits(&moved(&mut *changed, &none)), expected);
            assert_ne!(undamped, expected);
            changed.set_damping(none.damping);
            assert_eq!(bits(&moved(&mut *changed, &none)), undamped);
        }
    }
}

#[test]
fn only_contacts_that_share_masses_and_change_their_states_take_more_than_one_sweep() {
    // Two separate pads; then two pads on a disc, whose contacts are solved together.
    let pads = LumpedModel::from(&builtin("set1").unwrap().scene());
    let apart = moved(&mut *sparse(&pads).unwrap(), &pads).statistics;
    // When static friction releases a contact, the contacts are solved once more.
    assert!(apart.state_changes() > 0 && apart.sweeps <= apart.steps + apart.state_changes());
    let brake = of_scene("disc_brake");
    let coupled = moved(&mut *sparse(&brake).unwrap(), &brake).statistics;
    assert!(coupled.state_changes() > 0 && coupled.most_sweeps > 2, "{coupled:?}");
    let more = coupled.sweeps - coupled.steps;
    assert!(more <= coupled.state_changes() * coupled.most_sweeps, "{coupled:?}");
}

/// Three modules on an inclined slider, linked or not, damped or not.
fn ring(law: ContactLaw, links: f64, beta: f64) -> LumpedModel {
    let mut scene = builtin("set1").unwrap().scene();
    scene.modules_mut().extend_from_within(..1);
    for (i, module) in scene.modules_mut().iter_mut().enumerate() {
        module.stiffness[0] *= links * (1.0 + 0.1 * i as f64);
        module.stiffness[1] *= links;
    }
    scene.damping = Damping { alpha: 1e4 * beta, beta };
    LumpedModel { law, ..LumpedModel::from(&scene) }
}

#[test]
fn the_kernels_of_rings_and_of_networks_agree_on_every_part_of_the_law_of_contact() {
    let switches = [false, true];
    for (&friction, sticking) in Law::ALL.iter().flat_map(|law| switches.map(|on| (law, on))) {
        for (detachment, links, beta) in
            [(false, 0.0, 0.0), (false, 1.0, 3e-5), (true, 0.0, 3e-5), (true, 1.0, 0.0)]
        {
            let law = ContactLaw { friction, sticking, detachment };
            let model = ring(law, links, beta);
            let drive = Inputs::uniform(
                model.load.clone(),
                3,
                0.05,
                Friction { kinetic: 0.9, static_: 1.2, stribeck_velocity: 0.02 },
            );
            let of_ring = RingForwardIncrement::new(&model).unwrap();
            let boxed: [Box<dyn Integrator>; 3] =
                [Box::new(of_ring), dense(&model).unwrap().unwrap(), sparse(&model).unwrap()];
            let [ring, dense, sparse] = boxed.map(|mut integrator| {
                // Pressed on, for at N = 0 the two would have to agree on what is open; pulled where nothing opens.
                let pressed = if detachment { -1e-4 } else { 1e-4 };
                let velocity = |i| if i % 4 == 3 { 0.0 } else { 0.01 * f64::from(i - 6) };
                let mut motion = Motion::new(
                    [0.0, pressed, 0.0, 0.0].repeat(3),
                    (0..12).map(velocity).collect(),
                    vec![Slide; 3],
                );
                integrator.advance(&mut motion, &drive, 1e-6, 20_000).unwrap();
                motion
            });
            assert_eq!(bits(&dense), bits(&sparse), "{law:?}");
            // In other orders of summation; a chaotic motion takes rounding some way.
            let size = ring.velocity.iter().fold(0.0, |size, v| f64::max(size, v.abs()));
            for (a, b) in ring.velocity.iter().zip(&dense.velocity) {
                assert!((a - b).abs() < 1e-9 * size, "{law:?}: {a} {b}");
            }
            assert_eq!(ring.contacts, dense.contacts, "{law:?}");
            let counted = |motion: &Motion| {
                let Statistics { entered, touch_downs, .. } = motion.statistics;
                let Statistics { reversed_slips, pulled_contacts, .. } = motion.statistics;
                [entered.iter().sum(), touch_downs, reversed_slips, pulled_contacts]
            };
            assert_eq!(counted(&ring), counted(&dense), "{law:?}");
            let [changes, _, reversed, pulled] = counted(&ring);
            // Each part was there to be missed.
            let has_fixed_state = law.has_fixed_state() && friction.info().sticks;
            assert_eq!(reversed > 0, has_fixed_state, "{law:?}: {reversed}");
            assert!(detachment || law.has_fixed_state() || changes > 4, "{law:?}: {changes}");
            assert_eq!(pulled > 0, !detachment, "{law:?}");
        }
    }
}
