//! The bounds of all contact states against each state, or against many of them where they are too many.

use super::complex::modulus;
use super::critical_step::{bound, limits, over_all_states, squares};
use super::eigenvalues::by_schur;
use super::frequency_bound::{FrequencyBound, Sizes};
use crate::contact::{ContactLaw, ContactState, all_states};
use crate::model::{Contact, Damping, Direction, LinearModel, LumpedModel, SparseMatrix};
use proptest::prelude::*;
use std::f64::consts::TAU;
use std::time::Instant;

/// The arrangement of the contacts of a random structure.
#[derive(Clone, Copy, Debug)]
pub(super) enum ContactShape {
    /// A disc and pads around it, each on springs of its own.
    Disc,
    /// A disc and pads around it, with springs between pads, contacts that lie askew, and masses that differ along x and y.
    Tangled,
    /// Masses in a row, each on the one before it.
    Chain,
    /// One mass on the ground.
    OneMass,
}

/// Numbers between 0 and 1, one after the other.
struct Numbers<I>(I);

impl<I: Iterator<Item = f64>> Numbers<I> {
    fn between(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.0.next().expect("there are enough")
    }
}

pub(super) fn any_numbers() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(0.0..1.0_f64, 200)
}

pub(super) fn model(shape: ContactShape, contacts: usize, numbers: &[f64]) -> LumpedModel {
    let mut numbers = Numbers(numbers.iter().copied().cycle());
    let bodies = if matches!(shape, ContactShape::OneMass) { 1 } else { contacts + 1 };
    let askew = if matches!(shape, ContactShape::Tangled) { 1.0 } else { 0.0 };
    let first = numbers.between(0.3, 3.0);
    let mut mass = vec![first; 2];
    for _ in 1..bodies {
        let m = numbers.between(0.2, 0.4);
        mass.extend([m, m * (1.0 + askew * numbers.between(0.0, 0.3))]);
    }
    let mut entries = Vec::new();
    let mut spring = |from: usize, to: Option<usize>, angle: f64, k: f64| {
        let (sin, cos) = angle.sin_cos();
        let mut ends = vec![(2 * from, cos), (2 * from + 1, sin)];
        ends.extend(to.into_iter().flat_map(|to| [(2 * to, -cos), (2 * to + 1, -sin)]));
        for &(i, a) in &ends {
            entries.extend(ends.iter().map(|&(j, b)| (i, j, k * a * b)));
        }
    };
    for body in 0..bodies {
        let angle = numbers.between(0.0, TAU);
        spring(body, None, angle, numbers.between(1e5, 5e5));
        spring(body, None, angle + numbers.between(0.6, 1.5), numbers.between(1e5, 5e5));
        if askew > 0.0 && body > 1 {
            spring(body, Some(body - 1), numbers.between(0.0, TAU), numbers.between(1e4, 2e5));
        }
    }
    let mut contact = |i: usize| {
        let along = TAU * i as f64 / contacts as f64 + askew * numbers.between(-0.3, 0.3);
        let (on, from, along) = match shape {
            ContactShape::Chain => (i + 1, Some(i), 0.1 * along),
            ContactShape::OneMass => (0, None, numbers.between(0.0, TAU)),
            _ => (i + 1, Some(0), along),
        };
        let direction = |angle: f64| {
            let (sin, cos) = angle.sin_cos();
            let mut parts = vec![(2 * on, cos), (2 * on + 1, sin)];
            parts.extend(from.into_iter().flat_map(|b| [(2 * b, -cos), (2 * b + 1, -sin)]));
            Direction(parts)
        };
        let normal = along + 0.25 * TAU + askew * numbers.between(-0.2, 0.2);
        Contact::new(direction(normal), direction(along))
    };
    let contacts = (0..contacts).map(&mut contact).collect();
    LumpedModel {
        stiffness: SparseMatrix::from_entries(mass.len(), entries),
        dampers: SparseMatrix::zero(mass.len()),
        load: vec![0.0; mass.len()],
        mass: SparseMatrix::diagonal(&mass),
        damping: Damping { alpha: 0.0, beta: 0.0 },
        contacts,
        law: ContactLaw::default(),
    }
}

fn sizes(model: LinearModel<'_>) -> Option<Sizes> {
    let sizes = FrequencyBound::new(model)?.at(model);
    sizes.largest_square().is_finite().then_some(sizes)
}

/// Returns the largest |s| of a contact state, after checking that every s is inside the bound.
fn enclosed(model: LinearModel<'_>, states: &[ContactState], sizes: Sizes) -> f64 {
    let ellipse = sizes.ellipse.expect("there are no dampers");
    squares(model, states, by_schur).unwrap().into_iter().fold(0.0, |most, s| {
        let size = modulus(s);
        assert!(ellipse.encloses(s), "{states:?}: {s} is outside of {ellipse:?}");
        assert!(size <= sizes.largest_square() * (1.0 + 1e-9), "{states:?}: {s} {sizes:?}");
        f64::max(most, size)
    })
}

/// States of very many contacts: of one kind, of two in turn, and at random.
fn sampled(contacts: usize, numbers: &[f64]) -> Vec<Vec<ContactState>> {
    let kinds = ContactState::ALL;
    let mut states: Vec<Vec<ContactState>> = Vec::new();
    for a in kinds {
        for b in kinds {
            states.push((0..contacts).map(|i| if i % 2 == 0 { a } else { b }).collect());
            states.push((0..contacts).map(|i| if 2 * i < contacts { a } else { b }).collect());
            // Friction along one direction of space, whatever the angle of the contact is.
            states.push(
                (0..contacts)
                    .map(|i| if (4 * i / contacts).is_multiple_of(2) { a } else { b })
                    .collect(),
            );
        }
    }
    for first in 0..10 {
        let place = |i: usize| (first * 17 + i * (first + 1)) % numbers.len();
        let pick = |i: usize| if numbers[place(i)] < 0.5 { 1 } else { 2 } + usize::from(numbers[place(i + 1)] < 0.3);
        states.push((0..contacts).map(|i| kinds[pick(i)]).collect());
    }
    states
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn all_eigenvalues_of_all_states_lie_in_the_ellipse(
        numbers in any_numbers(),
        shape in prop::sample::select(vec![ContactShape::Disc, ContactShape::Tangled, ContactShape::Chain, ContactShape::OneMass]),
        contacts in 2_usize..=5,
        mu in 0.0..0.9,
    ) {
        let model = model(shape, contacts, &numbers).with_friction(mu);
        let model = model.linear().unwrap();
        if let Some(sizes) = sizes(model) {
            for states in all_states(u32::try_from(contacts).unwrap()) {
                enclosed(model, &states, sizes);
            }
            let exact = over_all_states(model).unwrap().step;
            let known = bound(model).unwrap();
            prop_assert!(known <= exact, "{} {}", known, exact);
        } else {
            // With little friction there is always a bound.
            prop_assert!(mu > 0.05, "{:?} {} has no bound at {}", shape, contacts, mu);
        }
    }

    #[test]
    fn a_disc_has_a_bound_near_the_exact_limit(numbers in any_numbers(), mu in 0.0..0.6) {
        let model = model(ContactShape::Disc, 5, &numbers).with_friction(mu);
        let model = model.linear().unwrap();
        let sizes = sizes(model).unwrap();
        let states = all_states(5);
        let largest = states.fold(0.0, |most, s| f64::max(most, enclosed(model, &s, sizes)));
        let exact = over_all_states(model).unwrap().step;
        let frequency = (sizes.largest_square() / largest).sqrt();
        let step = exact / bound(model).unwrap();
        println!("{mu:.3}: frequencies {frequency:.3}, step {step:.3}");
        prop_assert!(frequency <= 2.0 && step < 10.0, "{} {}", frequency, step);
    }
}

#[test]
fn many_contacts_on_one_body_have_a_bound_and_128_take_no_time() {
    let numbers: Vec<f64> = (1..200).map(|i| (0.618_034 * f64::from(i)).fract()).collect();
    for shape in [ContactShape::Disc, ContactShape::Tangled, ContactShape::OneMass] {
        for (contacts, mu) in [(8, 0.1), (8, 0.4), (32, 0.1), (32, 0.4), (128, 0.1), (128, 0.3)] {
            let model = model(shape, contacts, &numbers).with_friction(mu);
            let model = model.linear().unwrap();
            let start = Instant::now();
            let sizes = sizes(model).unwrap();
            assert!(start.elapsed().as_secs_f64() < 0.5);
            let known = bound(model).unwrap();
            assert!(known > 0.0);
            if contacts == 128 {
                continue;
            }
            let (mut largest, mut step) = (0.0, f64::INFINITY);
            for states in sampled(contacts, &numbers) {
                largest = f64::max(largest, enclosed(model, &states, sizes));
                step = limits(model, &states).unwrap().iter().fold(step, |s, l| s.min(l.0));
            }
            let frequency = (sizes.largest_square() / largest).sqrt();
            println!(
                "{shape:?} {contacts} {mu}: frequency {frequency:.3}, step {:.3}",
                step / known
            );
            assert!(known <= step && frequency < 2.0);
        }
    }
}
