//! The modes of uniform sliding in a motion.
//!
//! A motion is projected on the modes of uniform sliding, row by row, as x = 2 Re Σ c_k u_k. Without its mean a
//! coefficient has the velocity 2 Re (c_k − c̄_k) λ_k u_k, and the mode the mean of the kinetic energy of this
//! velocity. A share is that of one mode in the sum of all; modes of one eigenvalue are taken together. Modes that merge
//! are nearly parallel: both then have large shares, which cancel in the motion.

use super::super::basis::Basis;
use crate::stability::{Linearised, modes};
use amontons::Error;
use amontons::model::SparseMatrix;
use nalgebra::{Complex, DMatrix, DVector};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// The most rows in which a motion is projected.
const MOST_ROWS: u64 = 1000;
/// Models of more degrees of freedom are not projected: V⁻¹ would take longer than the motion.
const MOST_DOFS: usize = 1000;
/// Frequencies nearer than this number by the window's length (s) are not told apart, Hz.
const RESOLUTION: f64 = 4.0;
/// Eigenvalues this near, in parts of themselves, are those of one group.
const EQUAL: f64 = 1e-6;

/// The part of one mode, or of the modes of one eigenvalue, in a motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModeShare {
    /// The numbers of the modes among all modes of uniform sliding, from 1.
    pub modes: Vec<usize>,
    /// Frequency of the modes, Hz.
    pub frequency: f64,
    /// Growth rate of the modes, 1/s.
    pub growth_rate: f64,
    /// Share of the kinetic energy, from 0 to 1.
    pub share: f64,
}

impl ModeShare {
    /// The numbers of the modes in words: "3", "3 and 4".
    #[must_use]
    pub fn numbers(&self) -> String {
        self.modes.iter().map(ToString::to_string).collect::<Vec<_>>().join(" and ")
    }
}

/// The modes of uniform sliding, ready to project motions on.
pub(super) struct ModalShares {
    basis: Basis,
    groups: Vec<Group>,
}

struct Group {
    share: ModeShare,
    /// Places of the coefficients.
    places: Vec<usize>,
    oscillates: bool,
    /// Wᵀ M W of the columns Re λu and Im λu of all members.
    gram: DMatrix<f64>,
}

impl ModalShares {
    /// The modes of uniform sliding of a scene; `None` where they do not span the motions.
    ///
    /// # Errors
    /// Returns an error if there is no uniform sliding, or if modes are not found.
    pub(super) fn of(here: &Linearised) -> Result<Option<Self>, Error> {
        if here.model().dofs() > MOST_DOFS {
            return Ok(None);
        }
        let states = here.uniform_sliding()?;
        let Some(basis) = Basis::of(here.linear()?, &states, None) else { return Ok(None) };
        let found = modes(here.linear()?, &states)?;
        let mass = &here.model().mass;
        let groups = basis.modes.iter().map(|members| {
            let lambda = members.eigenvalue;
            let is_of = |other: Complex<f64>| (other - lambda).norm() <= EQUAL * lambda.norm();
            let numbers = (1..).zip(found.all()).filter(|(_, mode)| is_of(mode.eigenvalue));
            let columns: Vec<Vec<f64>> = members
                .members
                .iter()
                .flat_map(|(_, shape)| {
                    let part = |of: fn(Complex<f64>) -> f64| {
                        shape.iter().map(|u| of(lambda * u)).collect::<Vec<f64>>()
                    };
                    [part(|value| value.re), part(|value| value.im)]
                })
                .collect();
            Group {
                share: ModeShare {
                    modes: numbers.map(|(number, _)| number).collect(),
                    frequency: lambda.im / TAU,
                    growth_rate: lambda.re,
                    share: 0.0,
                },
                places: members.members.iter().map(|(place, _)| *place).collect(),
                oscillates: lambda.im > 1e-9 * lambda.norm(),
                gram: gram(mass, &columns),
            }
        });
        let groups = groups.collect();
        Ok(Some(Self { basis, groups }))
    }

    /// An empty course of coefficients, over this many rows.
    pub(super) fn course(&self, rows: u64) -> Course<'_> {
        Course { modal: self, every: rows.div_ceil(MOST_ROWS), noted: Vec::new() }
    }
}

/// Wᵀ M W.
fn gram(mass: &SparseMatrix, columns: &[Vec<f64>]) -> DMatrix<f64> {
    let weighted: Vec<Vec<f64>> = columns
        .iter()
        .map(|column| (0..column.len()).map(|row| mass.row_times(row, column)).collect())
        .collect();
    DMatrix::from_fn(columns.len(), columns.len(), |i, j| {
        columns[i].iter().zip(&weighted[j]).map(|(a, b)| a * b).sum()
    })
}

/// The coefficients of a motion from row to row.
pub(super) struct Course<'a> {
    modal: &'a ModalShares,
    every: u64,
    noted: Vec<DVector<Complex<f64>>>,
}

impl Course<'_> {
    /// Notes one of the rows.
    pub(super) fn note(&mut self, row: u64, displacement: &[f64], velocity: &[f64]) {
        if row.is_multiple_of(self.every) {
            let kept = [displacement, velocity].concat();
            self.noted.push(self.modal.basis.coefficients(&kept));
        }
    }

    /// The shares of all modes, the largest first.
    pub(super) fn shares(&self) -> Vec<ModeShare> {
        let count = self.noted.len().max(1) as f64;
        let energy = |group: &Group| {
            let mean = |place: &usize| -> Complex<f64> {
                self.noted.iter().map(|row| row[*place]).sum::<Complex<f64>>() / count
            };
            let means: Vec<Complex<f64>> = group.places.iter().map(mean).collect();
            let mut sum = 0.0;
            for row in &self.noted {
                let parts = group.places.iter().zip(&means).flat_map(|(place, mean)| {
                    let c = row[*place] - mean;
                    // A conjugate pair counts twice.
                    if group.oscillates { [2.0 * c.re, -2.0 * c.im] } else { [c.re, -c.im] }
                });
                let q = DVector::from_iterator(2 * group.places.len(), parts);
                sum += 0.5 * q.dot(&(&group.gram * &q));
            }
            sum / count
        };
        let energies: Vec<f64> = self.modal.groups.iter().map(energy).collect();
        let all: f64 = energies.iter().sum();
        let shared = self.modal.groups.iter().zip(&energies).map(|(group, energy)| ModeShare {
            share: if all > 0.0 { energy / all } else { 0.0 },
            ..group.share.clone()
        });
        let mut shares: Vec<ModeShare> = shared.collect();
        shares.sort_by(|a, b| b.share.total_cmp(&a.share));
        shares
    }
}

/// The mode whose frequency is nearest to that of a motion (Hz), which was observed in windows of this length (s). Of those
/// that are not told apart it is the one that grows most.
pub(super) fn nearest(
    shares: &[ModeShare],
    frequency: Option<f64>,
    window: f64,
) -> Option<ModeShare> {
    let frequency = frequency?;
    let miss = |share: &ModeShare| (share.frequency - frequency).abs();
    let oscillating = || shares.iter().filter(|share| share.frequency > 0.0);
    let least = oscillating().map(miss).fold(f64::INFINITY, f64::min);
    let alike = oscillating().filter(|share| miss(share) <= least + RESOLUTION / window);
    alike.max_by(|a, b| a.growth_rate.total_cmp(&b.growth_rate)).cloned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stability::Modes;
    use amontons::scene::builtin;

    /// Set 2 with little friction, and its modes in uniform sliding.
    fn set2() -> (Linearised, Modes) {
        let mut scene = builtin("set2").unwrap().scene();
        scene.friction_coefficient = 0.3;
        let here = Linearised::of(&scene);
        let found = modes(here.linear().unwrap(), &here.uniform_sliding().unwrap()).unwrap();
        (here, found)
    }

    /// x = Re(u e^{λt}) over its period, without growth beside its oscillation.
    #[test]
    fn a_motion_of_one_mode_has_the_share_one_of_that_mode() {
        let (here, found) = set2();
        let modal = ModalShares::of(&here).unwrap().unwrap();
        for (number, mode) in (1..).zip(&found.oscillating) {
            let mut course = modal.course(64);
            for row in 1..=64 {
                let turn = Complex::from_polar(1e-3, TAU * row as f64 / 64.0);
                let x: Vec<f64> = mode.shape.iter().map(|u| (turn * u).re).collect();
                let v: Vec<f64> =
                    mode.shape.iter().map(|u| (turn * mode.eigenvalue * u).re).collect();
                course.note(row, &x, &v);
            }
            let first = &course.shares()[0];
            assert!(first.modes.contains(&number) && first.share > 1.0 - 1e-9, "{first:?}");
        }
    }

    /// One mode turns three times as often as the other, so that their products have no mean.
    #[test]
    fn two_modes_share_a_motion_as_their_kinetic_energies() {
        let (here, found) = set2();
        let modal = ModalShares::of(&here).unwrap().unwrap();
        let (slow, fast) = (&found.oscillating[0], &found.oscillating[3]);
        let mut course = modal.course(64);
        let mut energies = [0.0; 2];
        for row in 1..=64_u32 {
            let turn = |turns: f64, size: f64| {
                Complex::from_polar(size, turns * TAU * f64::from(row) / 64.0)
            };
            let parts = [(slow, turn(1.0, 3e-3)), (fast, turn(3.0, 1e-3))];
            let (mut x, mut v) = (vec![0.0; 8], vec![0.0; 8]);
            for ((mode, turn), energy) in parts.into_iter().zip(&mut energies) {
                for (dof, u) in mode.shape.iter().enumerate() {
                    let velocity = (turn * mode.eigenvalue * u).re;
                    x[dof] += (turn * u).re;
                    v[dof] += velocity;
                    *energy += here.model().mass.get(dof, dof) * velocity * velocity;
                }
            }
            course.note(u64::from(row), &x, &v);
        }
        let shares = course.shares();
        for (number, energy) in [1, 4].into_iter().zip(energies) {
            let share = shares.iter().find(|share| share.modes.contains(&number)).unwrap().share;
            let expected = energy / energies.iter().sum::<f64>();
            assert!((share - expected).abs() < 1e-9, "{number}: {share} {expected}");
        }
    }

    #[test]
    fn of_two_modes_that_are_not_told_apart_the_growing_one_is_meant() {
        let share = |number, frequency, growth_rate| ModeShare {
            modes: vec![number],
            frequency,
            growth_rate,
            share: 0.5,
        };
        let all = [share(1, 100.0, -3.0), share(2, 100.5, 3.0), share(3, 130.0, 9.0)];
        let of = |frequency| nearest(&all, Some(frequency), 2.0).unwrap().modes;
        assert_eq!((of(99.9), of(129.0)), (vec![2], vec![3]));
        assert_eq!(nearest(&all, None, 2.0), None);
        // A window that is long enough tells them apart.
        assert_eq!(nearest(&all, Some(99.9), 100.0).unwrap().modes, [1]);
    }
}
