//! Modes followed from one value of a parameter to the next.

use crate::quadratic::Mode;
use faer::c64;

/// Two vectors belong to one mode if their modal assurance criterion is at least this.
const SAME: f64 = 0.5;

/// A mode over the values of the parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Branch {
    /// The points, at neighbouring values.
    pub points: Vec<Point>,
}

/// A mode at one value of the parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// The place of the value in the list.
    pub value: usize,
    /// The place of the mode in the list of modes at this value.
    pub mode: usize,
    /// λ, 1/s.
    pub eigenvalue: c64,
    /// `true` if the mode grows, `false` if it decays; `None` if its growth rate is within its error bound, or if that is
    /// not known.
    pub grows: Option<bool>,
    /// The modal assurance criterion with the vector at the value before, from 0 to 1; `None` at the first point.
    pub assurance: Option<f64>,
}

/// A change of the sign of a growth rate between two values of the parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// The places of the two values in the list.
    pub between: [usize; 2],
    /// How far the straight line between the two growth rates meets 0, as a part of the way from 0 to 1.
    pub part: f64,
    /// `true` if the mode begins to grow.
    pub begins: bool,
    /// The angular frequency there by the straight line, rad/s.
    pub frequency: f64,
}

impl Branch {
    /// Where the growth rate changes its sign. Points at which it is not known whether the mode grows are left out.
    #[must_use]
    pub fn crossings(&self) -> Vec<Crossing> {
        let decided: Vec<&Point> = self.points.iter().filter(|it| it.grows.is_some()).collect();
        let pairs = decided.windows(2).filter(|pair| pair[0].grows != pair[1].grows);
        pairs
            .map(|pair| {
                let [before, after] = [pair[0].eigenvalue, pair[1].eigenvalue];
                let part = before.re / (before.re - after.re);
                Crossing {
                    between: [pair[0].value, pair[1].value],
                    part,
                    begins: after.re > 0.0,
                    frequency: before.im + part * (after.im - before.im),
                }
            })
            .collect()
    }
}

/// Joins the modes of neighbouring values to branches, those with the most similar vectors first. A mode whose vector is
/// similar to none before begins a branch.
#[derive(Debug, Default)]
pub struct Follower {
    branches: Vec<Branch>,
    /// The modes of the value before, each with the place of its branch.
    before: Vec<(usize, Mode)>,
    values: usize,
}

impl Follower {
    /// Takes the modes of the next value. `weights` are those of the degrees of freedom in the comparison of shapes: the
    /// diagonal of the mass matrix makes it independent of units, and of how rotations are measured beside displacements.
    pub fn push(&mut self, modes: Vec<Mode>, weights: &[f64]) {
        let mut similar = Vec::new();
        for (branch, last) in &self.before {
            for (new, mode) in modes.iter().enumerate() {
                let assurance = assurance(&last.vector, &mode.vector, weights);
                if assurance >= SAME {
                    let closeness = assurance * alike(last.eigenvalue, mode.eigenvalue);
                    similar.push((closeness, assurance, *branch, new));
                }
            }
        }
        similar.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut own: Vec<Option<usize>> = vec![None; modes.len()];
        let mut taken = vec![false; self.branches.len()];
        for (_, assurance, branch, new) in similar {
            if own[new].is_none() && !taken[branch] {
                own[new] = Some(branch);
                taken[branch] = true;
                let point = point(self.values, new, &modes[new], Some(assurance));
                self.branches[branch].points.push(point);
            }
        }
        let mut before = Vec::with_capacity(modes.len());
        for (new, mode) in modes.into_iter().enumerate() {
            let branch = own[new].unwrap_or_else(|| {
                let point = point(self.values, new, &mode, None);
                self.branches.push(Branch { points: vec![point] });
                self.branches.len() - 1
            });
            before.push((branch, mode));
        }
        self.before = before;
        self.values += 1;
    }

    /// The branches, in the order in which they begin.
    #[must_use]
    pub fn finish(self) -> Vec<Branch> {
        self.branches
    }
}

fn point(value: usize, place: usize, mode: &Mode, assurance: Option<f64>) -> Point {
    Point { value, mode: place, eigenvalue: mode.eigenvalue, grows: grows(mode), assurance }
}

/// `true` if a mode grows, `false` if it decays; `None` if its growth rate is within its error bound, or if that is not known.
#[must_use]
pub fn grows(mode: &Mode) -> Option<bool> {
    let rate = mode.eigenvalue.re;
    mode.bound.filter(|bound| rate.abs() > *bound).map(|_| rate > 0.0)
}

/// How far the velocities of two modes of one shape agree with their displacements, from 0 to 1. Two eigenvalues can share a
/// vector: a rigid body that a damper slows down has 0 and another one.
fn alike(a: c64, b: c64) -> f64 {
    let scale = a.norm_sqr().max(b.norm_sqr());
    if scale == 0.0 {
        return 1.0;
    }
    let product = a.conj() * b + scale;
    product.norm_sqr() / ((a.norm_sqr() + scale) * (b.norm_sqr() + scale))
}

/// The modal assurance criterion |xᴴ W y|² / (xᴴ W x yᴴ W y): 1 for vectors of one shape, 0 for orthogonal ones.
fn assurance(x: &[c64], y: &[c64], weights: &[f64]) -> f64 {
    let product: c64 = x.iter().zip(y).zip(weights).map(|((x, y), w)| x.conj() * y * *w).sum();
    let norm = |x: &[c64]| x.iter().zip(weights).map(|(x, w)| x.norm_sqr() * w).sum::<f64>();
    product.norm_sqr() / (norm(x) * norm(y))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn followed<const N: usize>(all: [Vec<Mode>; N]) -> Vec<Branch> {
        let mut follower = Follower::default();
        all.into_iter().for_each(|modes| follower.push(modes, &[1.0; 3]));
        follower.finish()
    }

    fn mode(re: f64, im: f64, vector: [f64; 3]) -> Mode {
        let vector = vector.map(|part| c64::new(part, 0.0)).to_vec();
        Mode { eigenvalue: c64::new(re, im), vector, backward: 0.0, bound: Some(1e-3) }
    }

    /// Two modes whose frequencies cross keep their shapes; a third leaves, and a fourth comes.
    #[test]
    fn modes_are_followed_by_their_shapes_where_their_frequencies_cross() {
        let all = [
            vec![mode(-1.0, 9.0, [1.0, 0.0, 0.0]), mode(-3.0, 10.0, [0.0, 1.0, 0.0])],
            vec![mode(-1.0, 10.0, [0.1, 2.0, 0.0]), mode(-0.5, 10.5, [3.0, 0.1, 0.0])],
            vec![mode(1.0, 11.0, [2.0, 0.2, 0.1]), mode(-2.0, 12.0, [0.0, 0.1, 1.0])],
        ];
        let branches = followed(all);
        let values = |branch: &Branch| -> Vec<f64> {
            branch.points.iter().map(|point| point.eigenvalue.im).collect()
        };
        let values: Vec<Vec<f64>> = branches.iter().map(values).collect();
        assert_eq!(values, [vec![9.0, 10.5, 11.0], vec![10.0, 10.0], vec![12.0]]);
        let crossings = branches[0].crossings();
        assert_eq!(crossings.len(), 1);
        assert_eq!((crossings[0].between, crossings[0].begins), ([1, 2], true));
        assert!((crossings[0].part - 1.0 / 3.0).abs() < 1e-15);
        assert!((crossings[0].frequency - (10.5 + 0.5 / 3.0)).abs() < 1e-13);
    }

    #[test]
    fn modes_that_share_a_vector_are_told_apart_by_their_eigenvalues() {
        let all = [
            vec![mode(-20.0, 0.0, [1.0, 0.0, 0.0]), mode(0.0, 0.0, [1.0, 0.0, 0.0])],
            vec![mode(1e-6, 0.0, [1.0, 0.0, 0.0]), mode(-40.0, 0.0, [1.0, 0.0, 0.0])],
        ];
        let branches = followed(all);
        let ends: Vec<f64> = branches.iter().map(|branch| branch.points[1].eigenvalue.re).collect();
        assert_eq!(ends, [-40.0, 1e-6]);
        // 10⁻⁶ is within its error bound, so nothing begins to grow.
        assert!(branches.iter().all(|branch| branch.crossings().is_empty()));
    }
}
