use super::*;
use crate::contact::{FrictionRange, all_states};
use ContactState::{Detached, ReverseSlide, Slide, Stick};
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;

/// Contacts with this W and µ.
fn with_law(rows: &[f64], friction: f64) -> ContactProblem {
    let contacts = rows.len().isqrt() / 2;
    let mut problem = ContactProblem::new(Delassus::from_rows(contacts, rows));
    problem.constraints.fill(ContactConstraint::Law(FrictionRange::of(friction)));
    problem
}

/// Two contacts whose normals are coupled: W_NN = [[2, 1], [1, 2]], tangents alone; µ = 0.5.
fn coupled() -> ContactProblem {
    #[rustfmt::skip]
    let rows = [
        2.0, 0.0, 1.0, 0.0,
        0.0, 1.0, 0.0, 0.0,
        1.0, 0.0, 2.0, 0.0,
        0.0, 0.0, 0.0, 1.0,
    ];
    with_law(&rows, 0.5)
}

#[track_caller]
fn assert_near(found: &[[f64; 2]], expected: &[[f64; 2]]) {
    for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }
}

#[test]
fn coupled_contacts_have_the_forces_of_the_direct_solution_whatever_state_they_come_from() {
    for present in all_states(2) {
        let mut problem = coupled();
        problem.free = vec![[-3.0, 0.1], [-3.6, -9.0]];
        problem.solve(&present).unwrap();
        // [[2, 1], [1, 2]] N = (3, 3.6): N = (0.8, 1.4); the first sticks, the second slips.
        assert_near(&problem.forces, &[[0.8, -0.1], [1.4, 0.7]]);
        assert_eq!(problem.states, [Stick, Slide]);
    }
}

#[test]
fn a_contact_that_its_neighbour_lifts_opens() {
    let mut problem = coupled();
    // Alone the second would press with 0.5; the first's 2 N lift it.
    problem.free = vec![[-4.0, 0.0], [-1.0, 0.0]];
    problem.solve(&[Slide; 2]).unwrap();
    assert_near(&problem.forces, &[[2.0, 0.0], [0.0, 0.0]]);
    assert_eq!(problem.states[1], Detached);
}

/// W of two contacts at the same place of one mass: it has rank two, not four.
#[rustfmt::skip]
fn redundant() -> [f64; 16] {
    [
        1.0, 0.0, 1.0, 0.0,
        0.0, 1.0, 0.0, 1.0,
        1.0, 0.0, 1.0, 0.0,
        0.0, 1.0, 0.0, 1.0,
    ]
}

#[test]
fn redundant_sticking_contacts_share_the_load() {
    let mut problem = with_law(&redundant(), 0.5);
    problem.free = vec![[-2.0, 0.3]; 2];
    problem.solve(&[Stick; 2]).unwrap();
    let total: f64 = problem.forces.iter().map(|force| force[0]).sum();
    let friction: f64 = problem.forces.iter().map(|force| force[1]).sum();
    assert!((total - 2.0).abs() < 1e-12 && (friction + 0.3).abs() < 1e-12);
}

#[test]
fn a_load_that_one_of_two_surfaces_can_just_hold_is_shared_inside_the_limits_of_both() {
    // A mass of 1 kg on a flat surface and on a steep one, pushed against the steep one as far as friction of the flat one holds.
    let (sin, cos) = (libm::sin(0.25), libm::cos(0.25));
    #[rustfmt::skip]
    let rows = [
        1.0, 0.0, cos, sin,
        0.0, 1.0, -sin, cos,
        cos, -sin, 1.0, 0.0,
        sin, cos, 0.0, 1.0,
    ];
    let mut problem = with_law(&rows, 0.2);
    let [normal, tangential] = [-30.0, 6.0];
    problem.free = vec![
        [normal, tangential],
        [cos * normal - sin * tangential, sin * normal + cos * tangential],
    ];
    problem.solve(&[Stick; 2]).unwrap();
    let constraint = problem.constraints[0];
    assert!(problem.solve_inside(0, &[Stick; 2], |_| constraint));
    for [normal, tangential] in &problem.forces {
        assert!(*normal > 1.0 && tangential.abs() < 0.19 * normal, "{:?}", problem.forces);
    }
    problem.accelerate(0);
    for acceleration in &problem.accelerations {
        assert!(acceleration.value.iter().all(|a| a.abs() < 1e-11), "{acceleration:?}");
    }
}

#[test]
fn a_load_at_the_limit_of_all_contacts_has_no_share_inside() {
    let mut problem = with_law(&redundant(), 0.5);
    problem.free = vec![[-2.0, 1.0]; 2];
    problem.forces = vec![[2.0, -1.0], [0.0, 0.0]];
    let constraint = problem.constraints[0];
    assert!(!problem.solve_inside(0, &[Stick; 2], |_| constraint));
    // They stay as they were.
    assert_eq!(problem.forces, [[2.0, -1.0], [0.0, 0.0]]);
}

/// A light mass below a heavy one: an iteration of Gauss–Seidel reduces the error by a part of 10⁻⁵.
fn stack() -> ContactProblem {
    let r = 1.0 - 1e-5;
    #[rustfmt::skip]
    let rows = [
        1.0, 0.0, -r, 0.0,
        0.0, 1.0, 0.0, 0.0,
        -r, 0.0, 1.0, 0.0,
        0.0, 0.0, 0.0, 1.0,
    ];
    with_law(&rows, 0.5)
}

#[test]
fn what_converges_slowly_is_solved_at_once() {
    let mut problem = stack();
    problem.free = vec![[0.0, 0.1], [-1.0, 0.1]];
    problem.solve(&[Detached; 2]).unwrap();
    // N₁ = r N₂, (1 − r²) N₂ = 1.
    let r: f64 = 1.0 - 1e-5;
    let upper = 1.0 / (1.0 - r * r);
    assert!((problem.forces[1][0] / upper - 1.0).abs() < 1e-11);
    assert!((problem.forces[0][0] / (r * upper) - 1.0).abs() < 1e-11);
}

#[test]
fn forces_that_grow_from_sweep_to_sweep_are_solved_at_once() {
    // Friction couples the two contacts in a ring with a gain above one, and presses both on.
    #[rustfmt::skip]
    let rows = [
        1.0, 0.0, 0.0, 3.0,
        0.0, 9.5, 3.0, 0.0,
        0.0, 3.0, 1.0, 0.0,
        3.0, 0.0, 0.0, 9.5,
    ];
    let mut problem = with_law(&rows, 0.5);
    problem.constraints = vec![ContactConstraint::Slipping { direction: -1.0, friction: 0.5 }; 2];
    problem.free = vec![[-1.0, 0.0]; 2];
    // N₁ − 1.5 N₂ = 1 and N₂ − 1.5 N₁ = 1 have no solution above zero, nor has one of the two contacts alone.
    let failure = problem.solve(&[ReverseSlide; 2]).unwrap_err();
    assert_eq!(failure, StepFailure::Wedged { contact: 0 });
    // Where the second would open by itself there are two: it is open, or what the first one does holds it.
    problem.free = vec![[-1.0, 0.0], [2.0, 0.0]];
    problem.solve(&[ReverseSlide, Detached]).unwrap();
    assert_near(&problem.forces, &[[1.0, -0.5], [0.0, 0.0]]);
    problem.solve(&[ReverseSlide; 2]).unwrap();
    assert_near(&problem.forces, &[[1.6, -0.8], [0.4, -0.2]]);
}

#[test]
fn that_a_contact_jams_beside_too_many_others_proves_nothing() {
    // Each contact touches the next one's normal a little, and the first, which slips, presses itself on:
    // 1 − 3 · 0.4 < 0. That is proven of nine, though not all of their 4⁹ states are gone through, and of very many it is not.
    let failure = |contacts: usize| {
        let mut rows = DMatrix::identity(2 * contacts, 2 * contacts);
        (rows[(0, 1)], rows[(1, 0)]) = (-0.4, -0.4);
        for contact in 1..contacts {
            let (one, next) = (2 * contact - 2, 2 * contact);
            (rows[(one, next)], rows[(next, one)]) = (1e-3, 1e-3);
        }
        let mut problem = with_law(rows.as_slice(), 0.2);
        problem.constraints[0] = ContactConstraint::Slipping { direction: 1.0, friction: 3.0 };
        problem.free = vec![[-1.0, 0.0]; contacts];
        problem.solve(&vec![Stick; contacts]).unwrap_err()
    };
    assert_eq!(failure(3), StepFailure::Wedged { contact: 0 });
    assert_eq!(failure(9), StepFailure::Wedged { contact: 0 });
    assert_eq!(failure(40), StepFailure::NoneFound { contact: 0 });
}

/// A mass of 5 kg that surfaces at −0.2 and 0.02 rad hold, and that cannot open from them. Both move on, so that both contacts
/// slip in the same direction (±1), whatever pulls at it.
struct TwoSurfaces {
    /// Normal and tangent of each.
    directions: [[[f64; 2]; 2]; 2],
}

impl TwoSurfaces {
    const MASS: f64 = 5.0;
    /// Under this friction Gauss–Seidel diverges, and no forces hold the mass against some pulls.
    const FRICTION: f64 = 0.6;
    /// Each of the two presses or pulls.
    const SIGNS: [[f64; 2]; 4] = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];

    fn new() -> Self {
        let along = |angle: f64| [[-angle.sin(), angle.cos()], [angle.cos(), angle.sin()]];
        Self { directions: [-0.2, 0.02].map(along) }
    }

    /// Pulls (N) in all directions, each with both directions of slip.
    fn pulls() -> impl Iterator<Item = ([f64; 2], f64)> {
        let pull = |turn: i32| {
            let (sin, cos) = (f64::from(turn) * 0.27).sin_cos();
            [20.0 * cos, 20.0 * sin]
        };
        (0..24).flat_map(move |turn| [-1.0, 1.0].map(|slip| (pull(turn), slip)))
    }

    /// The contact problem under this pull, with surfaces of this acceleration (m/s²).
    fn problem(&self, pull: [f64; 2], acceleration: f64) -> ContactProblem {
        let dot = |a: [f64; 2], b: [f64; 2]| (a[0] * b[0] + a[1] * b[1]) / Self::MASS;
        let all = self.directions.as_flattened();
        let rows: Vec<f64> = all.iter().flat_map(|a| all.iter().map(|b| dot(*a, *b))).collect();
        let mut problem = with_law(&rows, Self::FRICTION);
        let free = |[normal, tangent]: [[f64; 2]; 2]| {
            [dot(normal, pull), dot(tangent, pull) - acceleration]
        };
        problem.free = self.directions.map(free).to_vec();
        problem
    }

    /// |N| of both contacts, if they press and pull as these signs have it; there are no such forces where one is negative.
    fn sizes(&self, signs: [f64; 2], pull: [f64; 2], slip: f64) -> [f64; 2] {
        let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
        let [first, second] = [0, 1].map(|i| {
            let [normal, tangent] = self.directions[i];
            [0, 1].map(|k| signs[i] * normal[k] + slip * Self::FRICTION * tangent[k])
        });
        let both = cross(first, second);
        [cross(second, pull) / both, cross(pull, first) / both]
    }
}

#[test]
fn a_mass_that_two_surfaces_hold_and_cannot_open_from_is_solved_at_once() {
    let (held, friction) = (TwoSurfaces::new(), TwoSurfaces::FRICTION);
    let (mut solved, mut wedged) = (0, 0);
    for (pull, velocity) in TwoSurfaces::pulls() {
        for slips in [false, true] {
            let mut problem = held.problem(pull, 100.0 * velocity);
            problem.constraints.fill(if slips {
                ContactConstraint::HeldSlipping { direction: velocity, friction }
            } else {
                ContactConstraint::Held(FrictionRange::of(friction))
            });
            let has_forces = TwoSurfaces::SIGNS
                .map(|signs| held.sizes(signs, pull, velocity).iter().all(|size| *size >= 0.0));
            if has_forces == [false; 4] {
                wedged += 1;
                let failure = problem.solve(&[Stick; 2]).unwrap_err();
                assert!(matches!(failure, StepFailure::Wedged { .. }), "{failure:?}");
                continue;
            }
            solved += 1;
            problem.solve(&[Stick; 2]).unwrap();
            // All forces together are nothing, and friction is that of contacts which slip, pressed or pulled.
            let mut sum = pull;
            for (force, pair) in problem.forces.iter().zip(held.directions) {
                let [normal, tangential] = *force;
                assert!((tangential - velocity * friction * normal.abs()).abs() < 1e-9);
                for axis in 0..2 {
                    sum[axis] += normal * pair[0][axis] + tangential * pair[1][axis];
                }
            }
            assert!(sum.iter().all(|part| part.abs() < 1e-9), "{sum:?}");
        }
    }
    assert!(solved > 10 && wedged > 10, "{solved} {wedged}");
}

#[test]
fn of_the_signs_of_held_contacts_that_have_forces_the_present_ones_stay() {
    let (held, friction) = (TwoSurfaces::new(), TwoSurfaces::FRICTION);
    let mut several = 0;
    for (pull, velocity) in TwoSurfaces::pulls() {
        let sizes = |signs: [f64; 2]| held.sizes(signs, pull, velocity);
        let mut have_forces = TwoSurfaces::SIGNS.to_vec();
        have_forces.retain(|signs| sizes(*signs).iter().all(|size| *size > 1e-3));
        several += usize::from(have_forces.len() > 1);
        for signs in have_forces {
            let mut problem = held.problem(pull, 0.0);
            problem
                .constraints
                .fill(ContactConstraint::HeldSlipping { direction: velocity, friction });
            problem.pulls = signs.map(|sign| sign < 0.0).to_vec();
            problem.solve(&[Slide; 2]).unwrap();
            for ((force, sign), size) in problem.forces.iter().zip(signs).zip(sizes(signs)) {
                assert!((force[0] - sign * size).abs() < 1e-9, "{signs:?}: {:?}", problem.forces);
            }
        }
    }
    assert!(several > 3, "{several}");
}

#[test]
fn of_several_solutions_the_present_one_goes_on() {
    // A mass in a flat wedge of two surfaces that go opposite ways: sticking in one keeps it off the other.
    let (mass, angle, friction) = (1.0, 0.1_f64, 0.3);
    let (sin, cos) = angle.sin_cos();
    let directions = [[-sin, cos], [cos, sin], [sin, cos], [cos, -sin]];
    let dot = |a: [f64; 2], b: [f64; 2]| (a[0] * b[0] + a[1] * b[1]) / mass;
    let rows: Vec<f64> = directions.iter().flat_map(|a| directions.map(|b| dot(*a, b))).collect();
    let mut problem = with_law(&rows, friction);
    problem.constraints = vec![
        ContactConstraint::Slipping { direction: 1.0, friction },
        ContactConstraint::Slipping { direction: -1.0, friction },
    ];
    problem.free = vec![[-50.0 * cos, -50.0 * sin], [-50.0 * cos, 50.0 * sin]];
    problem.solve(&[Slide, ReverseSlide]).unwrap();
    let pressed = 25.0 / (cos + friction * sin);
    assert_near(&problem.forces, &[[pressed, 0.3 * pressed], [pressed, -0.3 * pressed]]);
    problem.solve(&[Slide, Detached]).unwrap();
    assert_eq!(problem.states, [Slide, Detached]);
    assert_eq!(problem.forces[1], [0.0; 2]);
}

#[test]
fn static_friction_that_jams_a_contact_does_not_hold_it() {
    // On a line, α = 0.5: cos α − µ sin α is negative for µ_s = 2, and positive for µ_k = 1.
    let (sin, cos) = 0.5_f64.sin_cos();
    let rows = [cos * cos, cos * sin, cos * sin, sin * sin];
    let mut problem = with_law(&rows, 1.0);
    let range = FrictionRange { backward: 2.0, forward: 2.0, kinetic: 1.0 };
    problem.constraints = vec![ContactConstraint::Law(range)];
    problem.free = vec![[-3.0 * cos, -3.0 * sin + 0.4]];
    problem.solve(&[Stick]).unwrap();
    let pressed = 3.0 / (cos - sin);
    assert_near(&problem.forces, &[[pressed, -pressed]]);
}

#[test]
fn what_acts_on_a_contact_and_is_no_finite_number_is_reported_with_it() {
    let mut problem = coupled();
    problem.free = vec![[-3.0, 0.1], [f64::NEG_INFINITY, 0.0]];
    let failure = problem.solve(&[Slide; 2]);
    assert_eq!(failure, Err(StepFailure::NotFinite { contact: 1 }));
}

/// Random contacts on random masses.
#[derive(Clone, Debug)]
struct RandomContacts {
    directions: DMatrix<f64>,
    delassus: DMatrix<f64>,
    free: DVector<f64>,
    friction: Vec<f64>,
    present: Vec<ContactState>,
}

/// Up to `most` contacts on `dofs` degrees of freedom, or on twice as many as there are contacts; masses over e⁸. On
/// surfaces that move, or that stand: then the masses have velocities alone.
fn scenes(most: usize, has_few_dofs: bool) -> impl Strategy<Value = RandomContacts> {
    let dofs = move |contacts: usize| {
        if has_few_dofs { 1..=contacts } else { 2 * contacts..=2 * contacts }
    };
    (1..=most)
        .prop_flat_map(move |contacts| (Just(contacts), dofs(contacts), any::<bool>()))
        .prop_flat_map(|(contacts, dofs, stands)| {
            let values = |count, range| prop::collection::vec(range, count);
            (
                values(2 * contacts * dofs, -1.0..1.0),
                values(dofs, -4.0..4.0),
                values(dofs, -1.0..1.0),
                values(contacts, if stands { 0.0..f64::MIN_POSITIVE } else { -1.0..1.0 }),
                values(contacts, 0.0..3.0),
                prop::collection::vec(0..4_usize, contacts),
            )
        })
        .prop_map(|(directions, masses, velocity, surface, friction, present)| {
            let (contacts, dofs) = (friction.len(), masses.len());
            let directions = DMatrix::from_vec(2 * contacts, dofs, directions);
            let inverse = DMatrix::from_diagonal(&DVector::from_iterator(
                dofs,
                masses.iter().map(|mass| mass.exp()),
            ));
            let mut free = &directions * DVector::from_vec(velocity);
            for (contact, surface) in surface.iter().enumerate() {
                free[2 * contact + 1] -= surface;
            }
            RandomContacts {
                delassus: &directions * inverse * directions.transpose(),
                directions,
                free,
                friction,
                present: present.into_iter().map(|place| ContactState::ALL[place]).collect(),
            }
        })
        .prop_filter("each contact has masses", |scene| {
            scene.directions.row_iter().all(|row| row.amax() > 1e-3)
        })
}

impl RandomContacts {
    fn problem(&self) -> ContactProblem {
        let symmetric = 0.5 * (&self.delassus + self.delassus.transpose());
        let rows: Vec<f64> = symmetric.transpose().iter().copied().collect();
        let mut problem = with_law(&rows, 0.0);
        for (constraint, friction) in problem.constraints.iter_mut().zip(&self.friction) {
            *constraint = ContactConstraint::Law(FrictionRange::of(*friction));
        }
        problem.free = self.free.as_slice().chunks(2).map(|free| [free[0], free[1]]).collect();
        problem
    }

    /// Residual of the law under forces (N, T of each contact), in parts of the terms that it compares.
    fn missed(&self, forces: &DVector<f64>) -> f64 {
        let acceleration = &self.delassus * forces + &self.free;
        let terms = self.delassus.abs() * forces.abs() + self.free.abs();
        let terms = terms.map(|size| size.max(1e-200));
        let mut worst = 0.0_f64;
        for (contact, friction) in self.friction.iter().enumerate() {
            let (n, t) = (2 * contact, 2 * contact + 1);
            let unit = terms[n] / self.delassus[(n, n)];
            let (normal, tangential) = (forces[n] / unit, forces[t] / unit);
            let (lift, slip) = (acceleration[n] / terms[n], acceleration[t] / terms[t]);
            let mut parts =
                vec![-normal, -lift, normal.min(lift), tangential.abs() - friction * normal];
            // Either it does not slip, or friction is at its limit against the slip.
            parts.push(slip.abs().min((tangential + friction * normal * slip.signum()).abs()));
            worst = parts.into_iter().fold(worst, f64::max);
        }
        worst
    }

    /// The forces that obey the law in states whose equations are regular.
    fn regular_solutions(&self) -> impl Iterator<Item = DVector<f64>> {
        let contacts = self.friction.len();
        all_states(u32::try_from(contacts).unwrap()).filter_map(move |states| {
            let mut columns = Vec::new();
            let mut rows = Vec::new();
            for (contact, state) in states.iter().enumerate() {
                let mut column = DVector::zeros(2 * contacts);
                column[2 * contact] = 1.0;
                if let Some(direction) = state.sliding_direction() {
                    column[2 * contact + 1] = direction * self.friction[contact];
                }
                if *state != Detached {
                    columns.push(column);
                    rows.push(2 * contact);
                }
                if *state == Stick {
                    let mut column = DVector::zeros(2 * contacts);
                    column[2 * contact + 1] = 1.0;
                    columns.push(column);
                    rows.push(2 * contact + 1);
                }
            }
            let forces = if columns.is_empty() {
                DVector::zeros(2 * contacts)
            } else {
                let basis = DMatrix::from_columns(&columns);
                let matrix = (&self.delassus * &basis).select_rows(&rows);
                let right = -self.free.select_rows(&rows);
                let svd = matrix.clone().svd(false, false);
                let is_regular = svd.singular_values.min() > 1e-9 * svd.singular_values.max();
                basis * matrix.lu().solve(&right).filter(|_| is_regular)?
            };
            (self.missed(&forces) <= 1e-12).then_some(forces)
        })
    }

    /// `true` if another motion than that under these forces obeys the law, in a state whose equations are regular.
    /// Another one has an acceleration that differs by more than a part of the terms that it is the sum of.
    fn has_another_motion(&self, forces: &DVector<f64>, part: f64) -> bool {
        let acceleration = |forces: &DVector<f64>| &self.delassus * forces + &self.free;
        let taken = acceleration(forces);
        self.regular_solutions().any(|other| {
            let terms = self.delassus.abs() * other.abs() + self.free.abs();
            let off = (acceleration(&other) - &taken).abs();
            off.iter().zip(&terms).any(|(off, terms)| *off > part * terms.max(1e-200))
        })
    }
}

fn judge(scene: &RandomContacts) -> Result<(), TestCaseError> {
    let mut problem = scene.problem();
    match problem.solve(&scene.present) {
        Ok(_) => {
            let forces: Vec<f64> = problem.forces.iter().flatten().copied().collect();
            let missed = scene.missed(&DVector::from_vec(forces));
            prop_assert!(missed <= 1e-10, "misses the law by {missed:e}: {:?}", problem.forces);
        }
        // That none obeys the law is for another search to say.
        Err(StepFailure::Wedged { .. }) => prop_assert!(scene.regular_solutions().next().is_none()),
        Err(failure) => prop_assert!(false, "{failure:?}"),
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn any_contacts_with_masses_of_their_own_obey_the_law(scene in scenes(6, false)) {
        judge(&scene)?;
        // Where W is positive definite and nothing is said to slip, the law has a solution.
        prop_assert!(scene.problem().solve(&scene.present).is_ok());
    }

    #[test]
    fn any_contacts_that_share_few_degrees_of_freedom_obey_the_law_or_have_no_forces(
        scene in scenes(6, true),
    ) {
        judge(&scene)?;
    }

    #[test]
    fn another_solution_is_told_where_the_law_has_one_with_another_motion(
        scene in prop_oneof![scenes(3, false), scenes(3, true)],
    ) {
        let mut problem = scene.problem();
        if problem.solve(&scene.present).is_err() {
            return Ok(());
        }
        let taken = DVector::from_vec(problem.forces.iter().flatten().copied().collect());
        if problem.has_another_solution() {
            // Contacts that share few degrees of freedom may stick all together, in a state with many forces.
            let is_regular = scene.directions.ncols() >= scene.directions.nrows();
            prop_assert!(!is_regular || scene.has_another_motion(&taken, 1e-9));
        } else {
            prop_assert!(!scene.has_another_motion(&taken, 1e-6));
        }
        let after = DVector::from_vec(problem.forces.iter().flatten().copied().collect());
        prop_assert_eq!(taken, after);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    /// There is a solution here, too, among up to 4¹⁰ states.
    #[test]
    fn many_contacts_with_masses_of_their_own_obey_the_law(scene in scenes(10, false)) {
        let mut problem = scene.problem();
        let solved = problem.solve(&scene.present);
        prop_assert!(solved.is_ok(), "{solved:?}");
        let forces = problem.forces.iter().flatten().copied().collect();
        prop_assert!(scene.missed(&DVector::from_vec(forces)) <= 1e-10, "{:?}", problem.forces);
    }
}

/// Seventeen contacts that slip have 2¹⁷ states. Each is pushed into its surface by its own friction, a_N = −N − 1 and what
/// little its neighbours lift: the sum of all a_N is negative whatever the forces.
#[test]
fn many_contacts_that_jam_are_proven_to_have_no_forces() {
    const COUNT: usize = 17;
    let mut rows = vec![0.0; 4 * COUNT * COUNT];
    for i in 0..COUNT {
        let mut set = |row: usize, column: usize, value| rows[row * 2 * COUNT + column] = value;
        set(2 * i, 2 * i, 1.0);
        set(2 * i, 2 * i + 1, -2.0);
        set(2 * i + 1, 2 * i, -2.0);
        set(2 * i + 1, 2 * i + 1, 5.0);
        if i > 0 {
            set(2 * i, 2 * i - 2, 0.01);
            set(2 * i - 2, 2 * i, 0.01);
        }
    }
    let mut problem = with_law(&rows, 1.0);
    problem.constraints.fill(ContactConstraint::Slipping { direction: 1.0, friction: 1.0 });
    problem.free.fill([-1.0, 0.0]);
    assert!(matches!(problem.solve(&[Slide; COUNT]), Err(StepFailure::Wedged { .. })));
    // Pulled away they are free.
    problem.free.fill([1.0, 0.0]);
    assert!(problem.solve(&[Slide; COUNT]).is_ok());
}
