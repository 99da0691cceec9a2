//! Bounds of what M̃⁻¹ K̃ and M̃⁻¹ D̃ can be in any contact state, for models whose states are too many
//! or too large to look at one by one.

use crate::contact::{ContactState, all_states};
use crate::model::{Contact, LumpedModel, SparseMatrix};
use nalgebra::{DMatrix, DVector};

/// Up to this many contacts that share masses are looked at in all their states.
const MAX_GROUP: usize = 4;

/// What no mode of any contact state exceeds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sizes {
    /// Of the stiffness, 1/s²: |s| for the eigenvalues s of M̃⁻¹ K̃ or, with single dampers, |uᴴ K u|
    /// for the shapes u of the modes, masses scaled to one.
    pub(super) square: f64,
    /// Of the single dampers, 1/s: |uᴴ D u|.
    pub(super) dampers: f64,
}

/// Bounds over all contact states, cheap to ask again as µ changes.
///
/// *Contacts that share no mass, along degrees of freedom, and no single dampers*: in every contact
/// state the entries of M̃⁻¹ K̃ are in size at most those of the non-negative matrix B: the rows of
/// M⁻¹ |K|, the tangential rows with µ times the normal row added. Its spectral radius is at most
/// maxᵢ (B d)ᵢ / dᵢ for any positive d (Collatz and Wielandt); a few powers of B make a good d.
///
/// *Otherwise*: with masses scaled to one, K̃ acts as P K, where P projects obliquely, along the
/// contact forces, onto the motions that a state allows; so |s| ≤ ‖P‖ ‖K‖. ‖K‖ ≤ maxᵢ (B d)ᵢ / dᵢ for
/// B = M⁻¹ |K|, and likewise for D; ‖P‖ is the largest over groups of contacts that share masses. For
/// a contact alone it is √(1 + µ² W_TT / W_NN) where normal and tangent are not coupled; in general
/// 1/σ_min(Uᵀ V) with orthonormal U, V that span the directions without force and the motions.
#[derive(Clone, Debug)]
pub(super) struct FrequencyBound {
    /// (B d)ᵢ / dᵢ: the part without µ, the factor of µ, and whose µ.
    rows: Vec<(f64, f64, usize)>,
    /// ‖D‖, 1/s.
    dampers: f64,
    /// Contacts that share masses; `None` where `rows` have µ in them.
    groups: Option<Vec<Group>>,
}

/// Contacts that share masses.
#[derive(Clone, Debug)]
struct Group {
    contacts: Vec<usize>,
    /// Their directions in the coordinates √m x of the masses that they touch, normal then tangent.
    directions: Vec<[DVector<f64>; 2]>,
}

impl FrequencyBound {
    /// The bounds for a model, sharpest near the given µ; `None` where none is known: a full mass
    /// matrix, or more than four contacts that share masses.
    pub(super) fn new(model: &LumpedModel, friction: f64) -> Option<Self> {
        let mass = model.mass.as_diagonal()?;
        if model.dampers.is_empty()
            && let Some(dragged_by) = uncoupled(model)
        {
            let friction: Vec<f64> = model.contacts.iter().map(|c| c.friction(friction)).collect();
            let rows = collatz_wielandt(&model.stiffness, &mass, &dragged_by, &friction);
            return Some(Self { rows, dampers: 0.0, groups: None });
        }
        let alone = vec![None; mass.len()];
        let rows = collatz_wielandt(&model.stiffness, &mass, &alone, &[]);
        let dampers = collatz_wielandt(&model.dampers, &mass, &alone, &[]);
        let dampers = dampers.iter().fold(0.0, |largest, row| f64::max(largest, row.0));
        Some(Self { rows, dampers, groups: Some(groups(&model.contacts, &mass)?) })
    }

    /// The bound of the single dampers against that of the stiffness, s: the same at every µ.
    pub(super) fn dampers_against_stiffness(&self) -> f64 {
        if self.dampers == 0.0 {
            return 0.0;
        }
        // With single dampers µ is in the groups alone, which stretch both.
        self.dampers / self.rows.iter().fold(0.0, |largest, row| f64::max(largest, row.0))
    }

    /// The bounds at this µ; `model` is the one they were made for, but for its contacts' own values.
    pub(super) fn at(&self, model: &LumpedModel, friction: f64) -> Sizes {
        let mu = |contact: usize| model.contacts.get(contact).map_or(0.0, |c| c.friction(friction));
        let square = self.rows.iter().fold(0.0, |largest, &(own, drag, contact)| {
            f64::max(largest, if drag == 0.0 { own } else { own + mu(contact) * drag })
        });
        let groups = self.groups.as_deref().unwrap_or_default();
        let stretch =
            groups.iter().fold(1.0, |stretch, group| f64::max(stretch, group.stretch(&mu)));
        Sizes { square: stretch * square, dampers: stretch * self.dampers }
    }
}

/// A frequency that no mode without friction exceeds, rad/s, in any contact state: contacts that hold only
/// take freedom away. `None` for a full mass matrix. In a fixed order of plain operations, so that it is the
/// same double on each machine.
pub(super) fn frictionless(model: &LumpedModel) -> Option<f64> {
    let mass = model.mass.as_diagonal()?;
    let rows = collatz_wielandt(&model.stiffness, &mass, &vec![None; mass.len()], &[]);
    Some(rows.iter().fold(0.0, |largest, row| f64::max(largest, row.0)).sqrt())
}

/// The normal degree of freedom and the contact of each degree of freedom that is a tangent, if all
/// contacts lie along degrees of freedom of their own.
fn uncoupled(model: &LumpedModel) -> Option<Vec<Option<(usize, usize)>>> {
    let mut dragged_by = vec![None; model.dofs()];
    let mut used = vec![false; model.dofs()];
    for (i, contact) in model.contacts.iter().enumerate() {
        let (tangent, normal) = (contact.tangent.as_unit()?, contact.normal.as_unit()?);
        for dof in [tangent, normal] {
            if std::mem::replace(&mut used[dof], true) {
                return None;
            }
        }
        dragged_by[tangent] = Some((normal, i));
    }
    Some(dragged_by)
}

/// (B d)ᵢ / dᵢ of B = M⁻¹ |matrix| with the dragged rows added; see [`FrequencyBound`].
fn collatz_wielandt(
    matrix: &SparseMatrix,
    mass: &[f64],
    dragged_by: &[Option<(usize, usize)>],
    friction: &[f64],
) -> Vec<(f64, f64, usize)> {
    let row = |dof: usize, d: &[f64]| {
        matrix.row(dof).fold(0.0, |sum, (column, value)| sum + value.abs() * d[column])
    };
    let apply = |d: &[f64]| -> Vec<(f64, f64, usize)> {
        let parts = (0..mass.len()).zip(mass).zip(dragged_by);
        let parts = parts.map(|((dof, mass), dragged)| {
            let (drag, contact) = dragged.map_or((0.0, 0), |(normal, i)| (row(normal, d), i));
            (row(dof, d) / mass, drag / mass, contact)
        });
        parts.collect()
    };
    let mut d = vec![1.0; mass.len()];
    for _ in 0..30 {
        let total = |&(own, drag, i): &(f64, f64, usize)| {
            if drag == 0.0 { own } else { own + friction[i] * drag }
        };
        let next: Vec<f64> = apply(&d).iter().map(total).collect();
        let largest = next.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        // The floor keeps d positive, as the theorem wants it, where a row is zero.
        d = next.into_iter().map(|value| (value / largest).max(1e-6)).collect();
    }
    let rows = apply(&d).into_iter().zip(&d);
    rows.map(|((own, drag, contact), d)| (own / d, drag / d, contact)).collect()
}

/// The contacts in groups that share no degree of freedom; `None` if a group is too large.
fn groups(contacts: &[Contact], mass: &[f64]) -> Option<Vec<Group>> {
    let dofs_of = |contact: &Contact| -> Vec<usize> {
        contact.normal.0.iter().chain(&contact.tangent.0).map(|part| part.0).collect()
    };
    // Every contact begins alone; whoever meets on a degree of freedom merges.
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
                if members[to].len() > MAX_GROUP {
                    return None;
                }
            }
        }
    }
    let group = |contacts_of_group: Vec<usize>| {
        let mut dofs: Vec<usize> =
            contacts_of_group.iter().flat_map(|&contact| dofs_of(&contacts[contact])).collect();
        dofs.sort_unstable();
        dofs.dedup();
        let scaled = |direction: &crate::model::Direction| {
            let mut vector = DVector::zeros(dofs.len());
            for &(dof, value) in &direction.0 {
                let place = dofs.binary_search(&dof).expect("it was collected");
                vector[place] += value / mass[dof].sqrt();
            }
            vector
        };
        let directions = contacts_of_group
            .iter()
            .map(|&contact| [scaled(&contacts[contact].normal), scaled(&contacts[contact].tangent)])
            .collect();
        Group { contacts: contacts_of_group, directions }
    };
    Some(members.into_iter().filter(|members| !members.is_empty()).map(group).collect())
}

impl Group {
    /// The largest ‖P‖ over the group's contact states.
    fn stretch(&self, mu: &dyn Fn(usize) -> f64) -> f64 {
        if let [[normal, tangent]] = &self.directions[..] {
            return alone(normal, tangent, mu(self.contacts[0]));
        }
        let count = u32::try_from(self.contacts.len()).expect("few");
        all_states(count).map(|states| self.stretch_in(&states, mu)).fold(1.0, f64::max)
    }

    fn stretch_in(&self, states: &[ContactState], mu: &dyn Fn(usize) -> f64) -> f64 {
        let (mut constraints, mut forces) = (Vec::new(), Vec::new());
        for (i, state) in states.iter().enumerate() {
            let [normal, tangent] = &self.directions[i];
            if let Some(sign) = state.sliding_direction() {
                constraints.push(normal.clone());
                forces.push(normal + tangent * (sign * mu(self.contacts[i])));
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
