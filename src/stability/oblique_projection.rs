//! Inclination by friction of the projection P of accelerations onto the motions that a contact state allows.
//!
//! With masses scaled to one, closed contacts hold the directions G: normals, and the tangents of those that stick.
//! Their forces act along F, which is n ± µ t for a contact that slides. P = 1 − F (Gᵀ F)⁻¹ Gᵀ; ‖P‖ = √(1 + tan² θ),
//! where θ is the largest angle between span F and span G. Contacts that share no mass, directly or through others,
//! incline P independently, so ‖P‖ is the largest over groups of them.
//!
//! | group | tan θ over all its states |
//! | --- | --- |
//! | a contact alone | the closed form of [`alone`] |
//! | up to four contacts | the largest of the 4ⁿ states |
//! | directions of rank two | a contact alone: two that hold together leave no motion, or act as one |
//! | any other | [`Coupling`] |

use crate::contact::{ContactState, all_states};
use crate::model::{Contact, Direction};
use crate::numerics::bisect;
use nalgebra::{DMatrix, DVector};

/// Largest number of contacts that share masses and are examined in all their states.
const MAX_ENUMERATED: usize = 4;

/// A group of contacts that share masses.
#[derive(Clone, Debug)]
pub(super) struct ContactGroup {
    contacts: Vec<usize>,
    /// Their directions in the coordinates √m x of the masses that they touch, normal then tangent.
    directions: Vec<[DVector<f64>; 2]>,
    states: States,
}

/// The way in which the states of a group are examined.
#[derive(Clone, Copy, Debug)]
enum States {
    Each,
    OneContactAtATime,
    Together(Coupling),
}

/// Bound of tan θ over all states of any number of contacts.
///
/// Split the coordinates into private ones, q, and shared ones, so that the private parts of the contacts are
/// orthogonal to each other. Write a force of a state as r + z: r = Σ f n of the contacts that slide, and what
/// sticks; z = Σ ±µ f t of those that slide. r lies in span G, so the angle between r + z and span G is at most that
/// between r + z and r: tan² θ ≤ (|z|² |r|² − (z·r)²) / (|r|² + z·r)². Measure f by φ² = Σ |n_q|² f², over the contacts
/// that slide, and take φ = 1. Then |r_q| ≥ 1, |z_q| ≤ p, z_q·r_q ≥ −c, and the shared part of z is at most √Λ long,
/// whatever the signs and whichever contacts slide: leaving some out takes rows and columns out of a Gram matrix, and signs
/// do not change its eigenvalues. The shared part of r is arbitrary; let |r|² = 1 + ξ². The fraction grows
/// with |z|² ≤ p² + Λ, and falls as z·r rises above −|z|² (below, it is not larger than there). As z·r ≥ −c − √Λ ξ,
///
/// tan² θ ≤ max over ξ of (p² + Λ + p² ξ²) / (1 − c − √Λ ξ + ξ²)²,
///
/// if the bracket is positive for all ξ, that is Λ < 4 (1 − c). Else no bound is known, and friction may jam contacts.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Coupling {
    /// At µ = 1: the largest |t_q|² / |n_q|², which is p².
    own: f64,
    /// At µ = 1: the largest |n_q·t_q| / |n_q|², which is c.
    lean: f64,
    /// At µ = 1: Λ, the largest eigenvalue of tᵢ·tⱼ / (|nᵢ_q| |nⱼ_q|) of the shared parts of the tangents.
    shared: f64,
}

impl Coupling {
    /// The largest ‖P‖ where no contact has more friction than µ; infinite where no bound is known.
    fn stretch(self, mu: f64) -> f64 {
        let (own, lean, shared) = (mu * mu * self.own, mu * self.lean, mu * mu * self.shared);
        let (room, root) = (1.0 - lean, shared.sqrt());
        // Rounding must not produce a bound where none exists.
        if shared >= 4.0 * room * (1.0 - 1e-9) {
            return f64::INFINITY;
        }
        // Sign of the derivative of the fraction, which has one root between zero and √Λ.
        let rises = |xi: f64| {
            own * xi * xi * xi + (2.0 * (own + shared) - own * room) * xi < (own + shared) * root
        };
        let [xi, _] = bisect(0.0, root, rises);
        let bracket = room - root * xi + xi * xi;
        (1.0 + (own + shared + own * xi * xi) / (bracket * bracket)).sqrt()
    }
}

/// The contacts in groups that share no degree of freedom. A group without a bound for its states has an infinite ‖P‖
/// wherever there is friction.
pub(super) fn groups(contacts: &[Contact], mass: &[f64]) -> Vec<ContactGroup> {
    let dofs_of = |contact: &Contact| -> Vec<usize> {
        contact.normal.0.iter().chain(&contact.tangent.0).map(|part| part.0).collect()
    };
    // Every contact begins alone; contacts that meet on a degree of freedom merge.
    let mut group_of: Vec<usize> = (0..contacts.len()).collect();
    let mut members: Vec<Vec<usize>> = (0..contacts.len()).map(|contact| vec![contact]).collect();
    let mut first_on = vec![None; mass.len()];
    for (i, contact) in contacts.iter().enumerate() {
        for dof in dofs_of(contact) {
            let Some(other) = first_on[dof].replace(i) else { continue };
            let (from, to): (usize, usize) = (group_of[i], group_of[other]);
            if from != to {
                let moved = std::mem::take(&mut members[from]);
                moved.iter().for_each(|&contact| group_of[contact] = to);
                members[to].extend(moved);
            }
        }
    }
    let group = |contacts_of_group: Vec<usize>| {
        let mut dofs: Vec<usize> =
            contacts_of_group.iter().flat_map(|&contact| dofs_of(&contacts[contact])).collect();
        dofs.sort_unstable();
        dofs.dedup();
        let scaled = |direction: &Direction| {
            let mut vector = DVector::zeros(dofs.len());
            for &(dof, value) in &direction.0 {
                let place = dofs.binary_search(&dof).expect("it was collected");
                vector[place] += value / mass[dof].sqrt();
            }
            vector
        };
        let directions: Vec<_> = contacts_of_group
            .iter()
            .map(|&contact| [scaled(&contacts[contact].normal), scaled(&contacts[contact].tangent)])
            .collect();
        let states = States::of(&directions);
        ContactGroup { contacts: contacts_of_group, directions, states }
    };
    members.into_iter().filter(|members| !members.is_empty()).map(group).collect()
}

impl States {
    fn of(directions: &[[DVector<f64>; 2]]) -> Self {
        if directions.len() <= MAX_ENUMERATED {
            return Self::Each;
        }
        if let Some(coupling) = private(directions) {
            return Self::Together(coupling);
        }
        let all: Vec<DVector<f64>> = directions.iter().flatten().cloned().collect();
        let size = all[0].len();
        if size - null_space(&all, size).ncols() == 2 {
            return Self::OneContactAtATime;
        }
        Self::Together(beside_tangents(directions))
    }
}

/// The coupling with the degrees of freedom that only one contact touches as private coordinates; `None` where a normal
/// has no such component.
fn private(directions: &[[DVector<f64>; 2]]) -> Option<Coupling> {
    let mut users = vec![0_usize; directions[0][0].len()];
    for [normal, tangent] in directions {
        let parts = users.iter_mut().zip(normal.iter().zip(tangent.iter()));
        parts.for_each(|(users, (n, t))| *users += usize::from(*n != 0.0 || *t != 0.0));
    }
    let own =
        |v: &DVector<f64>| DVector::from_fn(v.len(), |i, _| if users[i] == 1 { v[i] } else { 0.0 });
    let (mut ratio, mut lean, mut shared) = (0.0, 0.0, Vec::new());
    for [normal, tangent] in directions {
        let (n, t) = (own(normal), own(tangent));
        let square = n.dot(&n);
        if square == 0.0 {
            return None;
        }
        ratio = f64::max(ratio, t.dot(&t) / square);
        lean = f64::max(lean, n.dot(&t).abs() / square);
        shared.push((tangent - t) / square.sqrt());
    }
    Some(Coupling { own: ratio, lean, shared: largest_eigenvalue(&shared) })
}

/// The coupling with the complement of all tangents as private coordinates. There the Gram matrix of the normals need
/// only be bounded below by a diagonal: |Σ f n_q|² ≥ Σ e f². No part of a tangent is private.
fn beside_tangents(directions: &[[DVector<f64>; 2]]) -> Coupling {
    let tangents: Vec<DVector<f64>> = directions.iter().map(|[_, t]| t.clone()).collect();
    let beside = null_space(&tangents, tangents[0].len());
    let normals: Vec<DVector<f64>> = directions.iter().map(|[n, _]| beside.tr_mul(n)).collect();
    let lengths: Vec<f64> = normals.iter().map(|n| n.norm()).collect();
    let gram = DMatrix::from_fn(normals.len(), normals.len(), |i, j| {
        normals[i].dot(&normals[j]) / (lengths[i] * lengths[j])
    });
    // Rounding is of the order of 1e-14.
    let least = if gram.iter().all(|value| value.is_finite()) {
        gram.symmetric_eigenvalues().min() - 1e-12
    } else {
        0.0
    };
    if least <= 0.0 {
        return Coupling { own: 0.0, lean: 0.0, shared: f64::INFINITY };
    }
    let scaled = tangents.iter().zip(&lengths).map(|(t, length)| t / (length * least.sqrt()));
    Coupling { own: 0.0, lean: 0.0, shared: largest_eigenvalue(&scaled.collect::<Vec<_>>()) }
}

/// The largest eigenvalue of the Gram matrix of these vectors, which is that of Σ v vᵀ.
fn largest_eigenvalue(vectors: &[DVector<f64>]) -> f64 {
    let used: Vec<usize> =
        (0..vectors[0].len()).filter(|&i| vectors.iter().any(|v| v[i] != 0.0)).collect();
    let matrix = if used.len() < vectors.len() {
        let entry = |i, j| vectors.iter().map(|v| v[used[i]] * v[used[j]]).sum();
        DMatrix::from_fn(used.len(), used.len(), entry)
    } else {
        DMatrix::from_fn(vectors.len(), vectors.len(), |i, j| vectors[i].dot(&vectors[j]))
    };
    // Rounding is of the order of 1e-14.
    if matrix.is_empty() { 0.0 } else { matrix.symmetric_eigenvalues().max() * (1.0 + 1e-12) }
}

impl ContactGroup {
    /// The largest ‖P‖ over the group's contact states, with the friction of each contact; infinite where no bound is
    /// known.
    pub(super) fn stretch(&self, mu: &dyn Fn(usize) -> f64) -> f64 {
        let most = |of: &dyn Fn(usize) -> f64| (0..self.contacts.len()).map(of).fold(0.0, f64::max);
        let mu = |i: usize| mu(self.contacts[i]);
        let one = |i: usize| alone(&self.directions[i][0], &self.directions[i][1], mu(i));
        match self.states {
            States::Each if self.contacts.len() == 1 => one(0),
            States::Each => {
                let count = u32::try_from(self.contacts.len()).expect("few");
                all_states(count).map(|states| self.stretch_in(&states, &mu)).fold(1.0, f64::max)
            }
            States::OneContactAtATime => most(&one),
            States::Together(coupling) => match most(&|i| mu(i).abs()) {
                0.0 => 1.0,
                mu => coupling.stretch(mu),
            },
        }
    }

    fn stretch_in(&self, states: &[ContactState], mu: &dyn Fn(usize) -> f64) -> f64 {
        let (mut constraints, mut forces) = (Vec::new(), Vec::new());
        for (i, state) in states.iter().enumerate() {
            let [normal, tangent] = &self.directions[i];
            if let Some(sign) = state.sliding_direction() {
                constraints.push(normal.clone());
                forces.push(normal + tangent * (sign * mu(i)));
            } else if *state == ContactState::Stick {
                constraints.extend([normal.clone(), tangent.clone()]);
                forces.extend([normal.clone(), tangent.clone()]);
            }
        }
        let size = self.directions[0][0].len();
        let (motions, tests) = (null_space(&constraints, size), null_space(&forces, size));
        // A state that determines no motion, or leaves none, sets no limit.
        if motions.ncols() != tests.ncols() || motions.ncols() == 0 {
            return 1.0;
        }
        1.0 / (tests.transpose() * motions).singular_values().min()
    }
}

/// ‖P‖ of a contact that shares its masses with no other: ‖F‖ ‖G_N‖ / |G_N F|, F = G_N ± µ G_T.
fn alone(normal: &DVector<f64>, tangent: &DVector<f64>, mu: f64) -> f64 {
    let (nn, nt, tt) = (normal.dot(normal), normal.dot(tangent), tangent.dot(tangent));
    [1.0, -1.0].into_iter().fold(1.0, |stretch, sign| {
        let force = (nn + 2.0 * sign * mu * nt + mu * mu * tt).max(0.0).sqrt();
        f64::max(stretch, force * nn.sqrt() / (nn + sign * mu * nt).abs())
    })
}

/// An orthonormal basis, by columns, of the vectors on which all `rows` vanish.
fn null_space(rows: &[DVector<f64>], size: usize) -> DMatrix<f64> {
    let square =
        rows.iter().fold(DMatrix::zeros(size, size), |sum, row| sum + row * row.transpose());
    let eigen = square.symmetric_eigen();
    let largest = eigen.eigenvalues.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let null = (0..size).filter(|&i| eigen.eigenvalues[i] <= 1e-12 * largest);
    let columns: Vec<DVector<f64>> = null.map(|i| eigen.eigenvectors.column(i).into()).collect();
    DMatrix::from_fn(size, columns.len(), |i, j| columns[j][i])
}
