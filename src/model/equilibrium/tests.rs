use super::*;
use crate::model::{Contact, Direction, SparseMatrix};
use crate::scene::{Scene, builtin};

fn number(contact: usize) -> String {
    format!("contact[{}]", contact + 1)
}

fn set1() -> Scene {
    builtin("set1").unwrap().scene()
}

fn equilibrium(scene: &Scene) -> Result<Equilibrium, Error> {
    crate::assembly::equilibrium(scene, &LumpedModel::from(scene))
}

#[test]
fn forces_balance_and_contacts_are_closed() {
    let mut scene = set1();
    scene.modules_mut()[1].preload *= 1.3;
    let model = LumpedModel::from(&scene);
    let found = equilibrium(&scene).unwrap();
    let mut contact = vec![0.0; model.dofs()];
    for (i, c) in model.contacts.iter().enumerate() {
        assert!(found.normal_force[i] > 0.0);
        assert_eq!(found.friction_force[i], 1.96 * found.normal_force[i]);
        c.normal.add_to(&mut contact, found.normal_force[i]);
        c.tangent.add_to(&mut contact, found.friction_force[i]);
    }
    for (dof, contact) in contact.iter().enumerate() {
        let residual =
            model.load[dof] + contact - model.stiffness.row_times(dof, &found.displacement);
        assert!(residual.abs() < 1e-9, "{dof}: {residual}");
    }
    for module in 0..2 {
        assert!(found.displacement[4 * module + 3].abs() < 1e-16);
    }
}

#[test]
fn one_module_solved_for_all_is_the_equilibrium_of_the_whole() {
    let scene = set1();
    let whole = LumpedModel::from(&scene).sliding_equilibrium(&number).unwrap();
    let one = equilibrium(&scene).unwrap();
    for (a, b) in whole.normal_force.iter().zip(&one.normal_force) {
        assert!((a - b).abs() < 1e-12 * b.abs());
    }
}

#[test]
fn the_sign_of_the_velocity_turns_friction() {
    let mut scene = set1();
    scene.slider.velocity = -0.025;
    assert!(equilibrium(&scene).unwrap().friction_force[0] < 0.0);
    scene.slider.velocity = 0.0;
    assert_eq!(equilibrium(&scene).unwrap().friction_force[0], 0.0);
}

/// A mass with K = [[a, b], [b, c]] in (x_t, x_n), pushed down by P: N (a − µ b) = P a for
/// x_n = 0, so it jams from µ = a/b on if b > 0.
fn wedge(friction: f64, surface_velocity: f64) -> LumpedModel {
    let contact = Contact {
        friction: friction.into(),
        surface_velocity,
        ..Contact::new(Direction::unit(1), Direction::unit(0))
    };
    LumpedModel {
        mass: SparseMatrix::diagonal(&[1.0, 1.0]),
        stiffness: SparseMatrix::from_entries(
            2,
            vec![(0, 0, 4.0), (0, 1, 1.0), (1, 0, 1.0), (1, 1, 2.0)],
        ),
        damping: crate::model::Damping::default(),
        dampers: SparseMatrix::zero(2),
        load: vec![0.0, -3.0],
        contacts: vec![contact],
        law: crate::contact::ContactLaw::default(),
    }
}

#[test]
fn normal_force_follows_the_closed_form_up_to_jamming() {
    for mu in [0.0, 1.0, 3.9] {
        let normal = wedge(mu, 1.0).sliding_equilibrium(&number).unwrap().normal_force[0];
        assert!((normal - 3.0 * 4.0 / (4.0 - mu)).abs() < 1e-12 * normal);
    }
}

#[test]
fn jamming_is_told_with_the_coefficient_from_which_on_it_happens() {
    let message = wedge(5.0, 1.0).sliding_equilibrium(&number).unwrap_err().to_string();
    assert!(message.contains("contact[1] jams from 4.000000 on"), "{message}");
    // Pulled the other way the same wedge opens itself: it never jams.
    assert!(wedge(5.0, -1.0).sliding_equilibrium(&number).is_ok());
}

#[test]
fn a_contact_that_the_load_opens_is_open() {
    let mut scene = set1();
    scene.modules_mut()[1].preload = -5e-3;
    let model = LumpedModel::from(&scene);
    let found = equilibrium(&scene).unwrap();
    assert!(found.normal_force[0] > 0.0 && found.gap[0] == 0.0, "{found:?}");
    assert!(found.normal_force[1] == 0.0 && found.gap[1] > 1e-4, "{found:?}");
    assert_eq!(found.states(&model), [ContactState::Slide, ContactState::Detached]);
    assert_balanced(&model, &found);
    // Contacts that cannot open pull instead.
    scene.effects.detachment = false;
    let message = equilibrium(&scene).unwrap_err().to_string();
    assert!(message.contains("contact[2] opens under the load"), "{message}");
}

#[test]
fn a_contact_that_only_friction_presses_on_is_an_equilibrium() {
    // Without friction the load opens contact 2; with it the slider's drag closes it.
    let mut scene = set1();
    scene.slider.angle = -0.5;
    scene.modules_mut()[1].preload = -2e-3;
    scene.friction_coefficient = 0.0;
    assert!(equilibrium(&scene).unwrap().gap[1] > 0.0);
    scene.friction_coefficient = 1.96;
    assert!(equilibrium(&scene).unwrap().normal_force[1] > 10.0);
}

/// The forces of springs, loads and contacts add up to zero, and the law of contact holds.
fn assert_balanced(model: &LumpedModel, found: &Equilibrium) {
    let mut sum = model.load.clone();
    let size = sum.iter().chain(&found.normal_force).fold(0.0, |most, f| f64::max(most, f.abs()));
    for (i, (contact, slope)) in model.contacts.iter().zip(model.sliding_ratios()).enumerate() {
        contact.normal.add_to(&mut sum, found.normal_force[i]);
        contact.tangent.add_to(&mut sum, slope * found.normal_force[i]);
        let gap = contact.gap + contact.normal.dot(&found.displacement);
        assert!((gap - found.gap[i]).abs() < 1e-9 * (1e-6 + gap.abs()), "{gap} {found:?}");
        let (n, g) = (found.normal_force[i], found.gap[i]);
        assert!(n >= 0.0 && g >= 0.0 && (n == 0.0 || g == 0.0), "{i}: {n} {g}");
    }
    for (dof, sum) in sum.iter().enumerate() {
        let rest = sum - model.stiffness.row_times(dof, &found.displacement);
        assert!(rest.abs() < 1e-8 * size, "{dof}: {rest}");
    }
}

/// Masses in a row on springs of 1 N/m to the ground along both axes and to their neighbours along y, each above the
/// slider by a gap and pressed by a load, m and N; degrees of freedom x, y.
fn row(gaps: &[f64], loads: &[f64], friction: f64, ground: f64) -> LumpedModel {
    let n = 2 * gaps.len();
    let mut entries = Vec::new();
    for i in 0..gaps.len() {
        entries.extend([(2 * i, 2 * i, 1.0), (2 * i + 1, 2 * i + 1, ground)]);
        // Friction bends the mass down, as in a wedge.
        entries.extend([(2 * i, 2 * i + 1, 0.1 * ground), (2 * i + 1, 2 * i, 0.1 * ground)]);
        if i > 0 {
            let (a, b) = (2 * i - 1, 2 * i + 1);
            entries.extend([(a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)]);
        }
    }
    let contacts = gaps.iter().enumerate().map(|(i, gap)| Contact {
        friction: friction.into(),
        surface_velocity: 1.0,
        gap: *gap,
        ..Contact::new(Direction::unit(2 * i + 1), Direction::unit(2 * i))
    });
    LumpedModel {
        mass: SparseMatrix::diagonal(&vec![1.0; n]),
        stiffness: SparseMatrix::from_entries(n, entries),
        damping: crate::model::Damping::default(),
        dampers: SparseMatrix::zero(n),
        load: loads.iter().flat_map(|load| [0.0, *load]).collect(),
        contacts: contacts.collect(),
        law: crate::contact::ContactLaw::default(),
    }
}

#[test]
fn a_gap_closes_where_the_load_is_larger_than_the_spring() {
    // 3 N against 100 N/m over 10 mm leave 2 N; 0.5 N close half the gap.
    let mut model = row(&[0.01], &[-3.0], 0.0, 100.0);
    model.stiffness = SparseMatrix::diagonal(&[1.0, 100.0]);
    let found = model.equilibrium(&number).unwrap();
    assert!((found.normal_force[0] - 2.0).abs() < 1e-12 && found.gap == [0.0], "{found:?}");
    assert_eq!(found.displacement[1], -0.01);
    model.load[1] = -0.5;
    let found = model.equilibrium(&number).unwrap();
    assert!(found.normal_force == [0.0] && (found.gap[0] - 0.005).abs() < 1e-15, "{found:?}");
    // 1 N closes it and no more: a contact that only touches is closed.
    model.load[1] = -1.0;
    let found = model.equilibrium(&number).unwrap();
    assert!(found.gap == [0.0] && found.normal_force[0] < 1e-12, "{found:?}");
}

#[test]
fn a_hundred_contacts_obey_the_law_whether_springs_hold_the_structure_or_not() {
    let wave = |i: usize| f64::sin(1.7 * i as f64);
    let gaps: Vec<f64> = (0..100).map(|i| 0.5 * (1.0 + wave(i))).collect();
    let loads: Vec<f64> = (0..100).map(|i| wave(3 * i + 1) - 0.2).collect();
    for (ground, friction) in [(0.3, 0.4), (0.0, 0.0), (1e-9, 0.4)] {
        let model = row(&gaps, &loads, friction, ground);
        let found = model.equilibrium(&number).unwrap();
        let open = found.gap.iter().filter(|gap| **gap > 0.0).count();
        assert!((5..95).contains(&open), "{open}");
        assert_balanced(&model, &found);
    }
}

#[test]
fn a_load_that_pulls_a_loose_structure_off_is_told() {
    let model = row(&[0.1, 0.0], &[1.0, -0.5], 0.0, 0.0);
    let message = model.equilibrium(&number).unwrap_err().to_string();
    assert!(message.contains("pulls the structure off its contacts"), "{message}");
}

/// A free body of eight nodes on three contacts in a plane, held by springs within that plane alone. A load outside of the three
/// tips it over: rounding of its stiffness, which is singular, once held it, some 10¹¹ m away.
#[test]
fn rounding_of_a_stiffness_holds_no_structure() {
    let mut random = 1_u64;
    let mut next = || {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (random >> 40) as f64 / 16_777_216.0
    };
    let mut told = 0;
    for _ in 0..1500 {
        let (nodes, unit) = (8, 1e5 * next());
        // Three contacts below, and the node that is loaded beyond the line from the first to the second.
        let mut places: Vec<[f64; 3]> =
            (0..nodes).map(|_| [next(), 1.0 + next(), next()]).collect();
        places[0] = [0.0, 0.0, 0.0];
        places[1] = [1.0, 0.0, 0.0];
        places[3] = [0.3 + 0.4 * next(), -0.5 - next(), next()];
        let mut entries = Vec::new();
        for a in 0..nodes {
            for b in 0..a {
                let along: Vec<f64> = (0..3).map(|i| places[a][i] - places[b][i]).collect();
                let square: f64 = along.iter().map(|d| d * d).sum();
                for i in 0..3 {
                    for j in 0..3 {
                        let part = unit * along[i] * along[j] / square;
                        entries
                            .extend([(3 * a + i, 3 * a + j, part), (3 * b + i, 3 * b + j, part)]);
                        entries
                            .extend([(3 * a + i, 3 * b + j, -part), (3 * b + i, 3 * a + j, -part)]);
                    }
                }
            }
        }
        entries.extend([(0, 0, unit), (1, 1, unit), (3, 3, unit), (4, 4, unit)]);
        let mut model = row(&[0.0; 3], &[0.0; 3], 0.2, 1.0);
        model.stiffness = SparseMatrix::from_entries(3 * nodes, entries);
        model.mass = SparseMatrix::diagonal(&vec![1.0; 3 * nodes]);
        model.dampers = SparseMatrix::zero(3 * nodes);
        model.load = vec![0.0; 3 * nodes];
        model.load[3 * 3 + 2] = -30.0;
        for (node, contact) in model.contacts.iter_mut().enumerate() {
            contact.normal = Direction::unit(3 * node + 2);
            contact.tangent = Direction::unit(3 * node);
        }
        let message = model.equilibrium(&number).unwrap_err().to_string();
        told += usize::from(message.contains("rounding of its stiffness decides"));
    }
    assert!(told > 0);
    // A link of 10¹⁴ N/m between two masses, of which a spring of 10⁴ N/m holds one, is stiff and not loose.
    let mut stiff = row(&[], &[], 0.0, 0.0);
    stiff.mass = SparseMatrix::diagonal(&[1.0, 1.0]);
    let link = 1e14;
    let entries = vec![(0, 0, 1e4 + link), (0, 1, -link), (1, 0, -link), (1, 1, link)];
    stiff.stiffness = SparseMatrix::from_entries(2, entries);
    stiff.dampers = SparseMatrix::zero(2);
    stiff.load = vec![0.0, 100.0];
    let found = stiff.equilibrium(&number).unwrap();
    assert!(found.displacement.iter().all(|x| (x - 0.01).abs() < 1e-4), "{found:?}");
}

#[test]
fn a_second_equilibrium_is_told_with_its_contacts() {
    // N (4 − µ) = −12 N for a load that lifts: beyond µ = 4 the wedge holds itself, and it may also be open.
    let mut model = wedge(5.0, 1.0);
    model.load[1] = 3.0;
    let found = model.equilibrium(&number).unwrap();
    assert!((found.normal_force[0] - 12.0).abs() < 1e-12, "{found:?}");
    let Uniqueness::Several(other) = model.uniqueness(&found) else { panic!() };
    // 2 − 1/4 N/m along the normal.
    assert!(other.normal_force == [0.0] && (other.gap[0] - 3.0 / 1.75).abs() < 1e-12);
    assert_eq!(wedge(3.9, 1.0).uniqueness(&found), Uniqueness::One);
    let set1 = set1();
    let model = LumpedModel::from(&set1);
    assert_eq!(model.uniqueness(&equilibrium(&set1).unwrap()), Uniqueness::One);
}

/// A full stiffness matrix of 300 degrees of freedom, on which 100 contacts press.
#[test]
fn a_full_matrix_with_a_hundred_contacts_is_solved() {
    let (n, m) = (300_usize, 100);
    let wave = |i: usize| libm::sin(1.3 * i as f64 * (1.0 + 0.01 * i as f64));
    let mut entries = Vec::new();
    for i in 0..n {
        for j in 0..n {
            let apart = i.abs_diff(j) as f64;
            entries.push((i, j, 1e6 * libm::exp(-0.2 * apart) * libm::cos(0.3 * apart)));
        }
    }
    let mut model = row(&vec![0.0; m], &vec![0.0; m], 0.3, 1.0);
    model.stiffness = SparseMatrix::from_entries(n, entries);
    model.mass = SparseMatrix::diagonal(&vec![1.0; n]);
    model.dampers = SparseMatrix::zero(n);
    model.load = (0..n).map(|i| 50.0 * (wave(i) - 0.3)).collect();
    for (i, contact) in model.contacts.iter_mut().enumerate() {
        contact.gap = 1e-6 * (1.0 + wave(7 * i));
    }
    let found = model.equilibrium(&number).unwrap();
    let open = found.gap.iter().filter(|gap| **gap > 0.0).count();
    assert!((20..80).contains(&open), "{open}");
    assert_balanced(&model, &found);
    assert_ne!(model.uniqueness(&found), Uniqueness::Several(found));
}

#[test]
fn a_large_structure_opens_contacts_too() {
    let gaps = vec![0.1; 500];
    let loads: Vec<f64> = (0..500).map(|i| if i % 50 < 25 { 0.3 } else { -0.6 }).collect();
    let model = row(&gaps, &loads, 0.2, 0.5);
    assert!(model.dofs() > MOST_DENSE);
    let found = model.equilibrium(&number).unwrap();
    assert!(found.gap.iter().any(|gap| *gap > 0.0) && found.gap.contains(&0.0));
    assert_balanced(&model, &found);
}

#[test]
fn a_mechanism_is_told_apart() {
    let mut scene = set1();
    for module in scene.modules_mut() {
        module.stiffness[3] = 0.0;
        module.stiffness[5] = 0.0;
        module.stiffness[0] = 0.0;
    }
    let message = equilibrium(&scene).unwrap_err().to_string();
    assert!(message.contains("without straining a spring"), "{message}");
}

#[test]
fn a_stiffness_with_negative_energy_has_two_equilibria_without_friction() {
    // −1000 N/m under 1 N: closed with 1 N, or 1 mm open.
    let mut model = row(&[0.0], &[-1.0], 0.0, 1.0);
    model.stiffness = SparseMatrix::diagonal(&[1.0, -1000.0]);
    let found = model.equilibrium(&number).unwrap();
    assert_eq!(found.normal_force, [1.0]);
    let Uniqueness::Several(other) = model.uniqueness(&found) else { panic!() };
    assert!((other.gap[0] - 1e-3).abs() < 1e-15, "{other:?}");
    // A motion that no spring holds is no such case.
    let model = row(&[0.0; 3], &[-1.0; 3], 0.0, 0.0);
    assert_eq!(model.uniqueness(&model.equilibrium(&number).unwrap()), Uniqueness::One);
}

#[test]
fn a_large_structure_whose_contacts_find_no_rest_is_not_said_to_need_contacts_that_pull() {
    // All contacts are pulled off, and nothing holds the structure along y.
    let model = row(&[0.0; 500], &[1.0; 500], 0.0, 0.0);
    let message = model.equilibrium(&number).unwrap_err().to_string();
    assert!(message.contains("was found") && !message.contains("would have to pull"), "{message}");
}
