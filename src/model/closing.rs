//! Which contacts are closed in the equilibrium: K X = F + (G_N + s µ G_T)ᵀ N with 0 ≤ g ⊥ N ≥ 0, g = gap + G_N X.
//!
//! The displacements are eliminated, which leaves a linear complementarity problem w = q + M z of the contacts, with
//! z = N and w = g. Where springs do not hold the structure in all its motions, as many contacts as there are motions
//! left are closed first: these have z = g and w = N.
//!
//! Displacements and forces are scaled so that the stiffnesses of single degrees of freedom and of single contacts are
//! near to 1: translations and rotations then have numbers of one size.

use super::LumpedModel;
use crate::numerics::{Lemke, max_norm};

/// A pivot below this part of a stiffness of 1 is the rounding of zero.
const NOTHING: f64 = 1e-13;
/// Motions with a pivot below this part of a stiffness of 1 are held by contacts rather than by springs: the gaps would
/// be differences of large numbers.
const WEAK: f64 = 1e-6;
/// Largest number of contacts of which all patterns are tried.
pub(super) const MOST_TRIED: usize = 10;
/// Values of a solution below this part of its largest are rounding.
const ROUNDING: f64 = 1e-10;

/// The reason why there is no complementarity problem.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Unheld;

/// The contacts of a model without its displacements, for any friction.
pub(super) struct Condensed {
    contacts: usize,
    /// Number of motions that the springs hold weakly, or do not hold.
    motions: usize,
    /// For each of these motions the force along it, which is zero: that of the load, then those of a unit of each
    /// motion, of each N and of each T.
    balances: Vec<Vec<f64>>,
    /// For each contact its gap, likewise.
    gaps: Vec<Vec<f64>>,
}

impl Condensed {
    /// Eliminates the displacements of a model.
    pub(super) fn new(model: &LumpedModel) -> Self {
        let (n, m) = (model.dofs(), model.contacts.len());
        let entries = || model.stiffness.entries();
        let largest = entries().fold(0.0, |most, entry| f64::max(most, entry.2.abs()));
        let scale = |dof: usize| {
            let own = model.stiffness.get(dof, dof).abs();
            1.0 / if own > 0.0 { own } else { f64::max(largest, f64::MIN_POSITIVE) }.sqrt()
        };
        let scales: Vec<f64> = (0..n).map(scale).collect();
        let length = |parts: &[(usize, f64)]| {
            let square = parts.iter().fold(0.0, |sum, &(dof, part)| {
                let scaled = part * scales[dof];
                sum + scaled * scaled
            });
            square.sqrt()
        };
        let lengths: Vec<f64> = model.contacts.iter().map(|c| length(&c.normal.0)).collect();
        // K X − (forces) as rows: K, then the load, N and T.
        let mut rows = vec![vec![0.0; n + 1 + 2 * m]; n];
        for (row, column, value) in entries() {
            rows[row][column] += scales[row] * value * scales[column];
        }
        for (dof, load) in model.load.iter().enumerate() {
            rows[dof][n] = scales[dof] * load;
        }
        for (i, contact) in model.contacts.iter().enumerate() {
            for (place, direction) in
                [(n + 1 + i, &contact.normal), (n + 1 + m + i, &contact.tangent)]
            {
                for &(dof, part) in &direction.0 {
                    rows[dof][place] += scales[dof] * part / lengths[i];
                }
            }
        }
        let pivots = eliminate(&mut rows, n, WEAK);
        let (mut is_row_left, mut is_column_left) = (vec![true; n], vec![true; n]);
        for &(row, column) in &pivots {
            (is_row_left[row], is_column_left[column]) = (false, false);
        }
        let free: Vec<usize> = (0..n).filter(|&column| is_column_left[column]).collect();
        let balance = |row: &Vec<f64>| {
            let motions = free.iter().map(|&column| -row[column]);
            [row[n]].into_iter().chain(motions).chain(row[n + 1..].iter().copied()).collect()
        };
        let left = rows.iter().zip(&is_row_left).filter(|(_, is_left)| **is_left);
        let balances = left.map(|(row, _)| balance(row)).collect();
        let mut gaps = Vec::with_capacity(m);
        for (contact, length) in model.contacts.iter().zip(&lengths) {
            let mut gap = vec![0.0; 1 + free.len() + 2 * m];
            gap[0] = contact.gap / length;
            let mut along = vec![0.0; n];
            for &(dof, part) in &contact.normal.0 {
                along[dof] += part * scales[dof] / length;
            }
            for (place, &column) in free.iter().enumerate() {
                gap[1 + place] = along[column];
            }
            for &(row, column) in pivots.iter().filter(|p| along[p.1] != 0.0) {
                let (row, factor) = (&rows[row], along[column]);
                gap[0] += factor * row[n];
                for (place, &column) in free.iter().enumerate() {
                    gap[1 + place] -= factor * row[column];
                }
                for (gap, force) in gap[1 + free.len()..].iter_mut().zip(&row[n + 1..]) {
                    *gap += factor * force;
                }
            }
            gaps.push(gap);
        }
        Self { contacts: m, motions: free.len(), balances, gaps }
    }

    /// The complementarity problem with these signed coefficients of friction T/N.
    ///
    /// # Errors
    /// Returns an error if neither springs nor contacts hold the structure in all its motions.
    pub(super) fn with_friction(&self, slopes: &[f64]) -> Result<Complementarity, Unheld> {
        let (m, d) = (self.contacts, self.motions);
        // Each row: the constant, a unit of each z, and of each motion.
        let combined = |row: &Vec<f64>| -> Vec<f64> {
            let (motions, forces) = row[1..].split_at(d);
            let forces = (0..m).map(|i| forces[i] + slopes[i] * forces[m + i]);
            [row[0]].into_iter().chain(forces).chain(motions.iter().copied()).collect()
        };
        let mut balances: Vec<Vec<f64>> = self.balances.iter().map(combined).collect();
        let mut rows: Vec<Vec<f64>> = self.gaps.iter().map(combined).collect();
        let mut is_swapped = vec![false; m];
        let mut motions: Vec<usize> = (m + 1..=m + d).collect();
        while !motions.is_empty() {
            let hold = |least| best_hold(&rows, &balances, &motions, &is_swapped, least);
            let strong = hold(WEAK);
            if strong.is_none()
                && let Some((k, j)) = best_spring(&balances, &motions)
            {
                // No contact holds this motion.
                let motion = motions.swap_remove(j);
                let moved = solved(&balances.swap_remove(k), motion);
                rows.iter_mut().chain(&mut balances).for_each(|row| replace(row, motion, &moved));
                continue;
            }
            // Near the friction at which a structure jams a contact hardly holds it.
            let (i, k, j) = strong.or_else(|| hold(NOTHING)).ok_or(Unheld)?;
            // N of the contact from the balance along one motion, then this motion from the contact's gap.
            let mut force = solved(&balances.swap_remove(k), 1 + i);
            let motion = motions.swap_remove(j);
            rows.iter_mut().chain(&mut balances).for_each(|row| replace(row, 1 + i, &force));
            let by = rows[i][motion];
            let mut moved = solved(&rows[i], motion);
            // The gap takes the place of N as z.
            moved[1 + i] = 1.0 / by;
            rows.iter_mut().chain(&mut balances).for_each(|row| replace(row, motion, &moved));
            replace(&mut force, motion, &moved);
            rows[i] = force;
            is_swapped[i] = true;
        }
        rows.iter_mut().for_each(|row| row.truncate(1 + m));
        Ok(Complementarity { rows, is_swapped })
    }
}

/// The balance and the place in `motions` with which a spring holds a motion best; `None` if none does.
fn best_spring(balances: &[Vec<f64>], motions: &[usize]) -> Option<(usize, usize)> {
    let size = |&(k, j): &(usize, usize)| balances[k][motions[j]].abs();
    let all = (0..balances.len()).flat_map(|k| (0..motions.len()).map(move |j| (k, j)));
    let best = all.max_by(|a, b| size(a).total_cmp(&size(b)))?;
    (size(&best) > NOTHING).then_some(best)
}

/// The contact, the balance and the place in `motions` with which a contact holds a motion best; `None` if none does by
/// more than `least`.
fn best_hold(
    rows: &[Vec<f64>],
    balances: &[Vec<f64>],
    motions: &[usize],
    is_swapped: &[bool],
    least: f64,
) -> Option<(usize, usize, usize)> {
    let (mut most, mut best) = (least, None);
    for (i, row) in rows.iter().enumerate().filter(|(i, _)| !is_swapped[*i]) {
        for (k, balance) in balances.iter().enumerate() {
            for (j, &motion) in motions.iter().enumerate() {
                let size = (row[motion] * balance[1 + i]).abs();
                if size > most {
                    (most, best) = (size, Some((i, k, j)));
                }
            }
        }
    }
    best
}

/// Gauss–Jordan's elimination of the first `n` columns with complete pivoting, as far as there are pivots above
/// `least`; the other columns are right-hand sides. Returns the row and the column of each pivot.
fn eliminate(rows: &mut [Vec<f64>], n: usize, least: f64) -> Vec<(usize, usize)> {
    let mut pivots: Vec<(usize, usize)> = Vec::with_capacity(n);
    let (mut row_is_done, mut column_is_done) = (vec![false; n], vec![false; n]);
    let mut own = Vec::new();
    for _ in 0..n {
        let mut best = (least, None);
        for (i, row) in rows.iter().enumerate().filter(|(i, _)| !row_is_done[*i]) {
            for (j, value) in row[..n].iter().enumerate() {
                if value.abs() > best.0 && !column_is_done[j] {
                    best = (value.abs(), Some((i, j)));
                }
            }
        }
        let Some((pivot, column)) = best.1 else { break };
        (row_is_done[pivot], column_is_done[column]) = (true, true);
        pivots.push((pivot, column));
        let by = rows[pivot][column];
        rows[pivot].iter_mut().for_each(|value| *value /= by);
        own.clone_from(&rows[pivot]);
        for (i, row) in rows.iter_mut().enumerate() {
            let factor = row[column];
            if i != pivot && factor != 0.0 {
                row.iter_mut().zip(&own).for_each(|(value, own)| *value -= factor * own);
            }
        }
    }
    pivots
}

/// A row that is zero, or equal to a variable that does not stand in it, solved for the variable of one place.
fn solved(row: &[f64], place: usize) -> Vec<f64> {
    let by = -row[place];
    let mut found: Vec<f64> = row.iter().map(|value| value / by).collect();
    found[place] = 0.0;
    found
}

/// Replaces the variable of one place in a row by a row that is equal to it; what the latter is short of is zero.
fn replace(row: &mut [f64], place: usize, by: &[f64]) {
    let factor = std::mem::replace(&mut row[place], 0.0);
    if factor != 0.0 {
        row.iter_mut().zip(by).for_each(|(value, by)| *value += factor * by);
    }
}

/// The linear complementarity problem w = q + M z, 0 ≤ w ⊥ z ≥ 0, of the contacts.
pub(super) struct Complementarity {
    /// q and M by rows.
    rows: Vec<Vec<f64>>,
    /// `true` where z is the gap and w the force, instead of the other way round.
    is_swapped: Vec<bool>,
}

/// The forces of the closed contacts of a pattern, and the gaps of the open ones.
enum Values {
    One(Vec<f64>),
    /// The conditions contradict each other.
    None,
    Undetermined,
}

/// `true` if no value is below zero but for rounding.
fn is_solution(values: &[f64]) -> bool {
    let nothing = -ROUNDING * max_norm(values);
    values.iter().all(|value| *value >= nothing)
}

/// Knowledge of other solutions than one.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Others {
    /// There are none.
    None,
    /// There is one in which these contacts are closed.
    Closed(Vec<bool>),
    /// None was found, which proves nothing.
    Unknown,
}

impl Complementarity {
    /// The contacts that are closed in a solution; `None` if none is found, which proves that there is none only where
    /// all patterns are tried ([`MOST_TRIED`]).
    pub(super) fn closed(&self) -> Option<Vec<bool>> {
        let found = self.pivoted(|_| 1.0);
        // Friction can end the algorithm before it finds a solution; another covering vector takes another way.
        found.or_else(|| match self.patterns() {
            Some(mut patterns) => patterns.find(|closed| self.forces(closed).is_some()),
            None => self.pivoted_by_covers().next(),
        })
    }

    /// The closed contacts of the solutions that are found from several covering vectors.
    fn pivoted_by_covers(&self) -> impl Iterator<Item = Vec<bool>> + '_ {
        let covers = (0..COVERS).map(|cover| {
            move |place: usize| {
                // Weights from 1/8 to 8 in an order that differs from cover to cover.
                let turn = (place * (2 * cover + 1) + cover) % 7;
                [1.0, 8.0, 0.125, 4.0, 0.25, 2.0, 0.5][turn]
            }
        });
        covers.filter_map(|cover| self.pivoted(cover))
    }

    /// Looks for solutions whose closed contacts are others than these. Contacts that carry no force and have no
    /// gap count as either.
    pub(super) fn others(&self, closed: &[bool]) -> Others {
        if self.is_definite() {
            return Others::None;
        }
        let differs = |found: &Vec<bool>| self.differ(found, closed);
        if let Some(patterns) = self.patterns() {
            let mut none = Others::None;
            for pattern in patterns {
                match self.values(&pattern) {
                    Values::Undetermined => none = Others::Unknown,
                    Values::One(values) if is_solution(&values) && differs(&pattern) => {
                        return Others::Closed(pattern);
                    }
                    Values::One(_) | Values::None => {}
                }
            }
            return none;
        }
        let mut found = self.pivoted_by_covers();
        found.find(differs).map_or(Others::Unknown, Others::Closed)
    }

    /// Lemke's algorithm with the weight of each row in the covering vector.
    fn pivoted(&self, cover: impl Fn(usize) -> f64) -> Option<Vec<bool>> {
        let m = self.rows.len();
        let mut lemke = Lemke::with_room(m);
        let tableau = lemke.begin(m);
        for (i, row) in self.rows.iter().enumerate() {
            let by = cover(i);
            tableau.extend(row.iter().map(|value| value / by));
            tableau.push(1.0);
        }
        lemke.run().then(|| {
            let pairs = self.is_swapped.iter().enumerate();
            pairs.map(|(i, swapped)| lemke.value(i).is_some() != *swapped).collect()
        })
    }

    /// All patterns of closed contacts, all closed first; `None` if they are too many to try.
    fn patterns(&self) -> Option<impl Iterator<Item = Vec<bool>> + use<>> {
        let m = self.rows.len();
        let pattern = move |bits: usize| (0..m).map(|i| bits >> i & 1 == 1).collect();
        (m <= MOST_TRIED).then(|| (0..1_usize << m).rev().map(pattern))
    }

    /// The force of each contact in a pattern that solves the problem, in units of its own; `None` if it does not.
    pub(super) fn forces(&self, closed: &[bool]) -> Option<Vec<f64>> {
        let Values::One(values) = self.values(closed) else { return None };
        let forces =
            values.iter().zip(closed).map(|(value, closed)| if *closed { *value } else { 0.0 });
        is_solution(&values).then(|| forces.collect())
    }

    /// The force of each closed contact and the gap of each open one.
    fn values(&self, closed: &[bool]) -> Values {
        let m = self.rows.len();
        let basic: Vec<bool> = closed.iter().zip(&self.is_swapped).map(|(a, b)| a != b).collect();
        // z of the basic contacts from w = 0, then w of the others.
        let solved_for: Vec<usize> = (0..m).filter(|&i| basic[i]).collect();
        let size = solved_for.len();
        let row = |&i: &usize| -> Vec<f64> {
            let row = &self.rows[i];
            solved_for.iter().map(|&j| row[1 + j]).chain([-row[0]]).collect()
        };
        let mut rows: Vec<Vec<f64>> = solved_for.iter().map(row).collect();
        let largest = rows.iter().fold(0.0, |most, row| f64::max(most, row[size].abs()));
        let pivots = eliminate(&mut rows, size, NOTHING);
        if pivots.len() < size {
            let mut left =
                rows.iter().enumerate().filter(|(i, _)| pivots.iter().all(|p| p.0 != *i));
            let is_balanced = left.all(|(_, row)| row[size].abs() <= ROUNDING * largest);
            return if is_balanced { Values::Undetermined } else { Values::None };
        }
        let mut values = vec![0.0; m];
        for &(row, column) in &pivots {
            values[solved_for[column]] = rows[row][size];
        }
        for i in (0..m).filter(|&i| !basic[i]) {
            let row = &self.rows[i];
            values[i] = solved_for.iter().fold(row[0], |sum, &j| sum + row[1 + j] * values[j]);
        }
        Values::One(values)
    }

    /// `true` if some contact is closed in one pattern and open in the other by more than rounding.
    fn differ(&self, one: &[bool], other: &[bool]) -> bool {
        let [a, b] = [one, other].map(|closed| self.values(closed));
        let (Values::One(a), Values::One(b)) = (a, b) else { return one != other };
        let nothing = ROUNDING.sqrt() * f64::max(max_norm(&a), max_norm(&b));
        (0..one.len()).any(|i| one[i] != other[i] && (a[i].abs() > nothing || b[i].abs() > nothing))
    }

    /// `true` if zᵀ M z > 0 for all z: there is then one solution. Cholesky's factors decide.
    fn is_definite(&self) -> bool {
        let m = self.rows.len();
        let mut lower = vec![0.0; m * m];
        for i in 0..m {
            for j in 0..=i {
                let value = 0.5 * (self.rows[i][1 + j] + self.rows[j][1 + i]);
                let known = (0..j).fold(0.0, |sum, k| sum + lower[i * m + k] * lower[j * m + k]);
                let rest = value - known;
                if i != j {
                    lower[i * m + j] = rest / lower[j * m + j];
                } else if rest > ROUNDING * value.abs() {
                    lower[i * m + i] = rest.sqrt();
                } else {
                    return false;
                }
            }
        }
        true
    }
}

/// Number of covering vectors from which other solutions are sought.
const COVERS: usize = 12;
