use super::*;
use crate::model::{Contact, LumpedModel, SparseMatrix};
use crate::numerics::max_norm;
use crate::scene::builtin;
use proptest::prelude::*;

/// A structure, the motion that its series begin with, and what drives it.
#[derive(Debug)]
struct Case {
    model: LumpedModel,
    inputs: Inputs,
    x: Vec<f64>,
    v: Vec<f64>,
}

impl Case {
    fn new(model: LumpedModel, friction: f64, values: impl Fn(usize) -> f64) -> Self {
        let dofs = model.dofs();
        let vector = |size: f64, from| (0..dofs).map(|i| size * values(from + i)).collect();
        let force = vector(20.0, 0);
        let mut inputs = Inputs::uniform(force, model.contacts.len(), 0.1, friction);
        inputs.force_rate = vector(1e3, 20);
        inputs.slider_acceleration.fill(0.5);
        Self { inputs, x: vector(1e-4, 40), v: vector(1e-2, 60), model }
    }

    fn series(&self, slots: usize) -> (Dynamics, Series) {
        let dynamics = Dynamics::new(&self.model).unwrap();
        let series = Series::with_slots(&dynamics, slots);
        (dynamics, series)
    }

    fn expand(&self, (dynamics, series): &mut (Dynamics, Series), states: &[ContactState]) {
        let start = (&*self.x, &*self.v);
        let Inputs { force, slider_acceleration, friction, .. } = &self.inputs;
        let now = SeriesStart { outer: force, slider: slider_acceleration, friction, passed: 0.0 };
        series.expand(dynamics, states, &self.inputs, now, start, 1e-3);
    }
}

fn set1() -> Case {
    let scene = builtin("set1").unwrap().scene();
    Case::new(LumpedModel::from(&scene), 1.5, |i| (1.7 * index(i)).sin())
}

/// Masses of two degrees of freedom each, springs and dampers between any two masses, a contact of the
/// first mass with the slider and an inclined one between the last two.
fn network() -> impl Strategy<Value = Case> {
    let masses = prop::collection::vec(0.2..2.0, 2..=4);
    let values = prop::collection::vec(-1.0..1.0, 80);
    let parts = prop::collection::vec((0_usize..8, 0_usize..8, 1e3..1e6), 4..12);
    (masses, values, parts, 0.0..0.4, 0.0..1e-5, prop::sample::select(vec![0.0, 3.0])).prop_map(
        |(masses, values, parts, friction, beta, alpha)| {
            let dofs = 2 * masses.len();
            let mass: Vec<f64> = masses.iter().flat_map(|m| [*m; 2]).collect();
            let between = |&(a, b, k): &(usize, usize, f64)| {
                let (a, b) = (a % dofs, b % dofs);
                [(a, a, k), (b, b, k), (a, b, -k), (b, a, -k)]
            };
            let grounded = (0..dofs).map(|dof| (dof, dof, 1e4));
            let stiffness = grounded.chain(parts.iter().flat_map(between)).collect();
            let dampers = parts[..2].iter().flat_map(between).map(|(a, b, k)| (a, b, 1e-5 * k));
            let inclined = |x: f64, y: f64| {
                let (a, b) = (dofs - 4, dofs - 2);
                Direction(vec![(a, -x), (a + 1, -y), (b, x), (b + 1, y)])
            };
            let contacts = vec![
                Contact::new(Direction::unit(1), Direction::unit(0)),
                Contact::new(inclined(-0.6, 0.8), inclined(0.8, 0.6)),
            ];
            let model = LumpedModel {
                mass: SparseMatrix::diagonal(&mass),
                stiffness: SparseMatrix::from_entries(dofs, stiffness),
                damping: Damping { alpha, beta },
                dampers: if alpha > 0.0 {
                    SparseMatrix::from_entries(dofs, dampers.collect())
                } else {
                    SparseMatrix::zero(dofs)
                },
                load: vec![0.0; dofs],
                contacts,
                law: crate::contact::ContactLaw::default(),
            };
            Case::new(model, friction, move |i| values[i % values.len()])
        },
    )
}

fn all_pairs() -> impl Iterator<Item = [ContactState; 2]> {
    ContactState::ALL.into_iter().flat_map(|a| ContactState::ALL.map(|b| [a, b]))
}

/// Equal but for the rounding of values of this size.
fn is_close(a: &[f64], b: &[f64], size: f64) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-11 * size)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(64) })]

    #[test]
    fn matrices_that_were_kept_leave_no_trace(case in network(), order in prop::collection::vec(0_usize..16, 60)) {
        let states: Vec<_> = all_pairs().collect();
        // Room for all states, for three, and for one; and a series that never met another state.
        let mut kept = [64, 3, 1].map(|slots| case.series(slots));
        for state in order.into_iter().map(|i| states[i]) {
            let mut fresh = case.series(64);
            case.expand(&mut fresh, &state);
            for kept in &mut kept {
                case.expand(kept, &state);
                prop_assert_eq!(kept.1.order, fresh.1.order);
                let end = fresh.1.order * fresh.1.places;
                prop_assert_eq!(&kept.1.displacement[..end], &fresh.1.displacement[..end]);
                let end = end - fresh.1.places;
                prop_assert_eq!(&kept.1.forces[..end], &fresh.1.forces[..end]);
            }
        }
    }

    #[test]
    fn full_matrices_give_what_sparse_ones_do(case in network()) {
        let [mut full, mut sparse] = [64, 0].map(|slots| case.series(slots));
        prop_assert!(full.1.reduced.is_some() && sparse.1.reduced.is_none());
        for states in all_pairs() {
            case.expand(&mut full, &states);
            case.expand(&mut sparse, &states);
            let spans = [full.1.span, sparse.1.span];
            prop_assert!((spans[0] - spans[1]).abs() <= 1e-12 * spans[0], "{:?}", spans);
            let mut ends = Vec::new();
            for (_, series) in [&mut full, &mut sparse] {
                let (mut x, mut v) = (case.x.clone(), case.v.clone());
                series.evaluate(0.8, &mut x, &mut v);
                let width = series.law.width();
                let mut forces = vec![0.0; width];
                for row in series.forces.chunks(series.places).take(series.order - 1) {
                    forces.iter_mut().zip(row).for_each(|(sum, force)| *sum += force);
                }
                let in_places = |i: usize| {
                    series.law.places(i).into_iter().take(match states[i] {
                        ContactState::Detached => 0,
                        ContactState::Stick => 2,
                        _ => 1,
                    })
                };
                let forces: Vec<f64> = (0..2).flat_map(in_places).map(|at| forces[at]).collect();
                ends.push([x, v, forces]);
            }
            // A contact force is what is left of the forces that act on the masses: their rounding is in it.
            let acting = max_norm(&case.inputs.force);
            let [x, v, forces] = ends[0].each_ref().map(|values| max_norm(values));
            let scales = [x, v, acting.max(forces)];
            for ((full, sparse), size) in ends[0].iter().zip(&ends[1]).zip(scales) {
                prop_assert!(is_close(full, sparse, size), "{:?}: {:?} {:?}", states, full, sparse);
            }
        }
    }
}

#[test]
fn another_drive_friction_or_damping_finds_no_old_matrix() {
    let mut case = set1();
    let mut kept = case.series(64);
    let state = [ContactState::Stick, ContactState::Slide];
    let mut last = Vec::new();
    for change in 0..5 {
        match change {
            1 => case.inputs.friction[1] = 0.7.into(),
            2 => {
                case.model.damping.beta *= 3.0;
                kept.0.damping = case.model.damping;
                kept.1.forget();
            }
            3 => case.inputs.force[0] += 1.0,
            4 => case.inputs.slider_acceleration[0] = -2.0,
            _ => {}
        }
        let mut fresh = case.series(64);
        case.expand(&mut fresh, &state);
        case.expand(&mut kept, &state);
        let end = fresh.1.order * fresh.1.places;
        assert_eq!(kept.1.displacement[..end], fresh.1.displacement[..end], "{change}");
        assert_ne!(last, kept.1.displacement[..end], "{change}");
        last = kept.1.displacement[..end].to_vec();
    }
}

#[test]
fn larger_structures_keep_no_matrices() {
    for (name, is_small) in [("set1", true), ("disc_brake", true), ("ring12", false)] {
        let dynamics = Dynamics::new(&LumpedModel::from(&builtin(name).unwrap().scene())).unwrap();
        let series = Series::new(&dynamics);
        assert_eq!(series.law.width() <= MOST_PLACES, is_small, "{name}");
        assert_eq!(series.reduced.is_some(), is_small, "{name}");
    }
}
