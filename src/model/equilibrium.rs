//! Static equilibrium in uniform sliding.

use super::banded::{self, Singular};
use super::closing::{Condensed, Others, Unheld};
use super::missing::{held_by_rounding, mechanism};
use super::{Entry, LumpedModel, SparseMatrix, ring};
use crate::Error;
use crate::contact::ContactState;
use crate::numerics::max_norm;
use serde::{Deserialize, Serialize};

/// A closed contact pulls, or an open one is inside its surface, from this part of the largest force or of the terms of
/// its gap on.
const COARSE: f64 = 1e-9;
/// Largest number of degrees of freedom of which full matrices are made.
const MOST_DENSE: usize = 800;
/// Rounding of the forces of springs that is more than this part of the largest force decides about an equilibrium.
const MOST_ROUNDED: f64 = 1e-3;
/// A gap below this part of its terms is the rounding of zero.
const FINE: f64 = 1e-12;

/// A static equilibrium in uniform sliding: each contact is closed and slides, or is open.
///
/// ```
/// use amontons::assembly::equilibrium;
/// use amontons::model::LumpedModel;
///
/// let scene = amontons::scene::builtin("set1").expect("a built-in scene").scene();
/// let model = LumpedModel::from(&scene);
/// let equilibrium = equilibrium(&scene, &model)?;
/// for (normal, friction) in equilibrium.normal_force.iter().zip(&equilibrium.friction_force) {
///     // The surface moves along the tangent, and T = µ N.
///     assert!((friction - scene.friction().kinetic * normal).abs() < 1e-9 * normal);
/// }
/// # Ok::<(), amontons::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Equilibrium {
    /// Displacement X, m, from the unloaded position; one value for each degree of freedom.
    pub displacement: Vec<f64>,
    /// Normal force N ≥ 0 of each contact, N.
    pub normal_force: Vec<f64>,
    /// Friction force T of each contact, on the mass along the tangent, N.
    pub friction_force: Vec<f64>,
    /// Gap of each contact, m: exactly 0 where it is closed.
    pub gap: Vec<f64>,
}

impl LumpedModel {
    /// The equilibrium in uniform sliding, K X = F + Σ (G_N + s µ G_T)ᵀ N, 0 ≤ g ⊥ N ≥ 0 with the gaps g of the
    /// contacts, where s is the sign of the velocity of the contact's surface: with v > 0 it is in Sl, with v < 0 in
    /// R-Sl. With v = 0 it does not slide; it starts stuck, without friction force (s = 0). Contacts that cannot open
    /// are closed, g = 0, whatever the sign of N.
    ///
    /// Friction may allow several such equilibria ([`uniqueness`](Self::uniqueness)): that with all contacts closed is
    /// taken where it is one of them.
    ///
    /// Equal modules of a ring move as one, so one is solved for all: they then are in equal states to the last bit,
    /// which a solution of the whole, with its rounding, would not give.
    ///
    /// # Errors
    /// Returns an error with the friction coefficient above which the structure jams, and the contact that does, as
    /// `name` calls it; or that the load pulls a structure off that springs do not hold; or with the contact that would
    /// have to pull although it cannot open.
    pub fn equilibrium(&self, name: &dyn Fn(usize) -> String) -> Result<Equilibrium, Error> {
        let Some(one) = ring::one_of_equal_modules(self) else {
            return self.sliding_equilibrium(name);
        };
        let count = self.contacts.len();
        let alone = one.sliding_equilibrium(name)?;
        Ok(Equilibrium {
            displacement: alone.displacement.repeat(count),
            normal_force: alone.normal_force.repeat(count),
            friction_force: alone.friction_force.repeat(count),
            gap: alone.gap.repeat(count),
        })
    }

    fn sliding_equilibrium(&self, name: &dyn Fn(usize) -> String) -> Result<Equilibrium, Error> {
        let slopes: Vec<f64> = self.sliding_ratios().collect();
        if let Some(contact) = self.contacts.iter().position(|contact| contact.gap > 0.0)
            && !self.law.detachment
        {
            return Err(Error::equilibrium(format!(
                "no equilibrium: {} has a gap, but contacts cannot open in this scene; leave the gap out, or let contacts \
                 open (effects.detachment)",
                name(contact)
            )));
        }
        let found = match self.solve(&slopes, &self.load) {
            // Friction that can stick follows |N|, which this linear solution does not include.
            Ok(found) if found.pulled_contact().is_none() || self.may_pull(&slopes) => found,
            _ if self.law.detachment => self.equilibrium_with_openings(&slopes, name)?,
            found => return Err(self.explain_pulling(&slopes, &found, name)),
        };
        if self.is_held_by_rounding(&found) {
            return Err(held_by_rounding(max_norm(&found.displacement)));
        }
        Ok(found)
    }

    /// `true` where rounding of the products K X is of the size of the forces, so that it decides where the structure comes
    /// to rest: springs do not hold it in some motion, and neither do closed contacts.
    fn is_held_by_rounding(&self, found: &Equilibrium) -> bool {
        let mut terms = vec![0.0; self.dofs()];
        for (row, column, value) in self.stiffness.entries() {
            terms[row] += (value * found.displacement[column]).abs();
        }
        let forces = max_norm(&self.load).max(max_norm(&found.normal_force));
        f64::EPSILON * max_norm(&terms) > MOST_ROUNDED * forces
    }

    /// The equilibrium in which some contacts are open.
    fn equilibrium_with_openings(
        &self,
        slopes: &[f64],
        name: &dyn Fn(usize) -> String,
    ) -> Result<Equilibrium, Error> {
        if self.dofs() > MOST_DENSE {
            return self.equilibrium_by_turns(slopes).ok_or_else(|| {
                Error::equilibrium(format!(
                    "no equilibrium in sliding was found: of a structure with more than {MOST_DENSE} degrees of freedom the \
                     contacts are opened and closed in turn, and this does not end; reduce the structure to at most \
                     {MOST_DENSE}, lower the friction coefficient, or press the contacts on",
                ))
            });
        }
        let condensed = Condensed::new(self);
        let problem = condensed.with_friction(slopes).map_err(|Unheld| mechanism())?;
        match problem.closed() {
            Some(closed) => {
                let found = self.with_closed(&closed, slopes).map_err(|Singular| mechanism())?;
                found.ok_or_else(|| {
                    Error::equilibrium(
                        "no equilibrium: the contacts that the load closes cannot be told from those that it opens within \
                         rounding; stiffnesses that differ too much, or contacts that hold the same motion twice, do this: \
                         leave such contacts out, or bring the stiffnesses nearer to each other",
                    )
                })
            }
            None => Err(self.explain_jamming(&condensed, slopes, name)),
        }
    }

    /// The equilibrium in which some contacts are open, by opening those that pull and closing those that are inside
    /// their surfaces, in turn, on sparse matrices; `None` where this does not end.
    fn equilibrium_by_turns(&self, slopes: &[f64]) -> Option<Equilibrium> {
        const MOST_TURNS: usize = 100;
        let mut closed = vec![true; self.contacts.len()];
        for _ in 0..MOST_TURNS {
            if let Some(found) = self.with_closed(&closed, slopes).ok()? {
                return Some(found);
            }
            let found = self.solve_closed(&closed, slopes, &self.load, self.gaps()).ok()?;
            for (i, closed) in closed.iter_mut().enumerate() {
                *closed = if *closed { found.normal_force[i] >= 0.0 } else { found.gap[i] < 0.0 };
            }
        }
        None
    }

    /// The equilibrium with these contacts closed; `None` where one of them pulls, or an open one is inside its surface,
    /// by more than rounding.
    fn with_closed(
        &self,
        closed: &[bool],
        slopes: &[f64],
    ) -> Result<Option<Equilibrium>, Singular> {
        let mut found = self.solve_closed(closed, slopes, &self.load, self.gaps())?;
        let pressed = found.normal_force.iter().fold(0.0, |most, force| f64::max(most, *force));
        for (i, contact) in self.contacts.iter().enumerate() {
            let terms =
                contact.normal.0.iter().map(|&(dof, n)| (n * found.displacement[dof]).abs());
            let length = terms.fold(contact.gap, |sum, term| sum + term);
            let (force, gap) = (&mut found.normal_force[i], &mut found.gap[i]);
            if *force < -COARSE * pressed || *gap < -COARSE * length {
                return Ok(None);
            }
            // A contact that only touches is closed.
            *force = force.max(0.0);
            if *gap <= FINE * length {
                *gap = 0.0;
            }
            found.friction_force[i] = slopes[i] * *force;
        }
        Ok(Some(found))
    }

    /// Other equilibria than this one, in which other contacts are closed, as far as they are known. Contacts that can
    /// open are examined; the others have one equilibrium.
    ///
    /// Without friction there is one if K is symmetric and has no negative eigenvalue. With friction there is one if it is
    /// weak enough (the symmetric part of the matrix of the complementarity problem is positive definite). Of up to ten
    /// contacts all patterns are tried, of more some.
    #[must_use]
    pub fn uniqueness(&self, found: &Equilibrium) -> Uniqueness {
        let slopes: Vec<f64> = self.sliding_ratios().collect();
        // Without friction the energy of the springs has one least value.
        let has_energy = || {
            let k = &self.stiffness;
            slopes.iter().all(|slope| *slope == 0.0)
                && k.entries()
                    .all(|(i, j, value)| (k.get(j, i) - value).abs() <= FINE * value.abs())
                && self.dofs() <= MOST_DENSE
                && has_no_negative_energy(k, self.dofs())
        };
        if !self.law.detachment || self.contacts.is_empty() || has_energy() {
            return Uniqueness::One;
        }
        if self.dofs() > MOST_DENSE {
            return Uniqueness::Unknown;
        }
        let Ok(problem) = Condensed::new(self).with_friction(&slopes) else {
            return Uniqueness::Unknown;
        };
        let closed: Vec<bool> = found.gap.iter().map(|gap| *gap == 0.0).collect();
        match problem.others(&closed) {
            Others::None => Uniqueness::One,
            Others::Unknown => Uniqueness::Unknown,
            Others::Closed(closed) => match self.with_closed(&closed, &slopes) {
                Ok(Some(other)) if !self.is_held_by_rounding(&other) => Uniqueness::Several(other),
                _ => Uniqueness::Unknown,
            },
        }
    }

    /// `true` if contacts may pull in the equilibrium, with these signed coefficients of friction.
    fn may_pull(&self, slopes: &[f64]) -> bool {
        let has_friction = slopes.iter().any(|slope| *slope != 0.0);
        let drives = self.law.follows_size() && has_friction;
        !(self.law.detachment || drives)
    }

    /// Changes of the contact forces of the equilibrium in uniform sliding: (dN, dT) of each contact, N, for changes of
    /// the load, N, of the signed friction coefficients `slopes` = T/N, and of the gaps dg, m, in this equilibrium. Open
    /// contacts stay open. The map is linear: K dX = dF + Σ (G_N + s µ G_T)ᵀ dN + G_Tᵀ N d(s µ), G_N dX = −dg.
    ///
    /// # Errors
    /// Returns an error if there is no equilibrium.
    pub fn equilibrium_change(
        &self,
        mut load: Vec<f64>,
        slopes: &[f64],
        slope_changes: &[f64],
        gap_changes: &[f64],
        here: &Equilibrium,
    ) -> Result<Vec<[f64; 2]>, Error> {
        let weakened = || here.normal_force.iter().zip(slope_changes).map(|(force, by)| force * by);
        for (contact, change) in self.contacts.iter().zip(weakened()) {
            contact.tangent.add_to(&mut load, change);
        }
        let closed: Vec<bool> = (0..self.contacts.len()).map(|i| here.is_closed(i)).collect();
        let gaps = gap_changes.iter().copied();
        let found = self.solve_closed(&closed, slopes, &load, gaps).map_err(|_| {
            Error::equilibrium("the equilibrium has no derivative where a structure jams")
        })?;
        let forces = found.normal_force.into_iter().zip(found.friction_force);
        Ok(forces.zip(weakened()).map(|((n, t), own)| [n, t + own]).collect())
    }

    /// The gaps of the contacts where nothing is displaced, m.
    fn gaps(&self) -> impl Iterator<Item = f64> + Clone {
        self.contacts.iter().map(|contact| contact.gap)
    }

    /// Solves for the equilibrium with all contacts closed and sliding, with the signed friction coefficients `slopes`
    /// = T/N, under this load, N.
    pub(super) fn solve(&self, slopes: &[f64], load: &[f64]) -> Result<Equilibrium, Singular> {
        self.solve_closed(&vec![true; self.contacts.len()], slopes, load, self.gaps())
    }

    /// Solves for the equilibrium with these contacts closed and sliding, and the others open, whatever the signs of
    /// forces and gaps. `apart` are the gaps of the contacts, m, where nothing is displaced.
    fn solve_closed(
        &self,
        closed: &[bool],
        slopes: &[f64],
        load: &[f64],
        apart: impl Iterator<Item = f64> + Clone,
    ) -> Result<Equilibrium, Singular> {
        let dofs = self.dofs();
        let mut entries: Vec<Entry> = self.stiffness.entries().collect();
        let mut load = load.to_vec();
        // In the unit of a stiffness the border is of the size of the rest, which pivoting needs.
        let unit = entries.iter().fold(0.0_f64, |unit, entry| unit.max(entry.2.abs()));
        let contacts = self.contacts.iter().zip(slopes).zip(apart.clone());
        for (((contact, slope), apart), _) in contacts.zip(closed).filter(|c| *c.1) {
            let multiplier = load.len();
            for &(dof, value) in &contact.normal.0 {
                entries.push((multiplier, dof, unit * value));
                entries.push((dof, multiplier, -unit * value));
            }
            for &(dof, value) in &contact.tangent.0 {
                entries.push((dof, multiplier, -unit * (slope * value)));
            }
            load.push(0.0 - unit * apart);
        }
        let mut displacement = banded::solve(load.len(), &entries, &load)?;
        let mut multipliers = displacement.split_off(dofs).into_iter();
        let normal_force: Vec<f64> = closed
            .iter()
            .map(|closed| if *closed { unit * multipliers.next().unwrap_or(0.0) } else { 0.0 })
            .collect();
        let friction_force = slopes.iter().zip(&normal_force).map(|(slope, n)| slope * n).collect();
        let gap = self.contacts.iter().zip(closed).zip(apart).map(|((contact, closed), apart)| {
            if *closed { 0.0 } else { apart + contact.normal.dot(&displacement) }
        });
        let gap = gap.collect();
        Ok(Equilibrium { displacement, normal_force, friction_force, gap })
    }
}

/// `true` if qᵀ K q ≥ 0 for all q, but for rounding, of a symmetric K. Cholesky's factors decide; a motion without
/// stiffness has no stiffness to the others either.
fn has_no_negative_energy(stiffness: &SparseMatrix, n: usize) -> bool {
    let mut lower = vec![0.0; n * n];
    for (row, column, value) in stiffness.entries().filter(|entry| entry.1 <= entry.0) {
        lower[row * n + column] += value;
    }
    let own: Vec<f64> = (0..n).map(|row| lower[row * n + row]).collect();
    for row in 0..n {
        for column in 0..=row {
            let known =
                (0..column).fold(0.0, |sum, k| sum + lower[row * n + k] * lower[column * n + k]);
            let rest = lower[row * n + column] - known;
            let pivot = lower[column * n + column];
            lower[row * n + column] = if row == column {
                if rest < -COARSE * own[row].abs() || own[row] < 0.0 {
                    return false;
                }
                if rest > COARSE * own[row] { rest.sqrt() } else { 0.0 }
            } else if pivot > 0.0 {
                rest / pivot
            } else if rest.abs() <= (COARSE * own[row] * own[column]).abs().sqrt() {
                0.0
            } else {
                return false;
            };
        }
    }
    true
}

/// Answer to the question how many equilibria in uniform sliding there are.
#[derive(Clone, Debug, PartialEq)]
pub enum Uniqueness {
    /// There is one.
    One,
    /// There is another one, in which other contacts are closed.
    Several(Equilibrium),
    /// No other one was found, which proves nothing.
    Unknown,
}

impl Equilibrium {
    /// `true` if a contact is closed; one that only touches is.
    #[must_use]
    pub fn is_closed(&self, contact: usize) -> bool {
        self.gap[contact] == 0.0
    }

    /// The state of each contact of the model whose equilibrium this is: Dt where it is open; otherwise Sl or R-Sl by the
    /// velocity of its surface, and St where that is zero.
    #[must_use]
    pub fn states(&self, model: &LumpedModel) -> Vec<ContactState> {
        let contacts = model.contacts.iter().zip(&self.gap);
        contacts
            .map(
                |(contact, gap)| {
                    if *gap > 0.0 { ContactState::Detached } else { contact.resting_state() }
                },
            )
            .collect()
    }

    /// The first contact that would have to pull, with its normal force.
    pub(super) fn pulled_contact(&self) -> Option<(usize, f64)> {
        let mut normal = self.normal_force.iter().copied().enumerate();
        normal.find(|&(_, force)| force.is_nan() || force < 0.0)
    }
}

#[cfg(test)]
mod tests;
