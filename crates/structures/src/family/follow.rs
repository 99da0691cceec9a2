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
    /// Where the growth rate changes its sign.
    #[must_use]
    pub fn crossings(&self) -> Vec<Crossing> {
        let pairs = self
            .points
            .windows(2)
            .filter(|pair| (pair[0].eigenvalue.re > 0.0) != (pair[1].eigenvalue.re > 0.0));
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
#[must_use]
pub fn follow(modes: &[Vec<&Mode>]) -> Vec<Branch> {
    let mut branches: Vec<Branch> = Vec::new();
    // For each mode of the value before, its branch.
    let mut before: Vec<usize> = Vec::new();
    for (value, now) in modes.iter().enumerate() {
        let mut similar = Vec::new();
        for (old, &branch) in before.iter().enumerate() {
            for (new, mode) in now.iter().enumerate() {
                let assurance = assurance(&modes[value - 1][old].vector, &mode.vector);
                if assurance >= SAME {
                    similar.push((assurance, branch, new));
                }
            }
        }
        similar.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut own: Vec<Option<usize>> = vec![None; now.len()];
        let mut taken = vec![false; branches.len()];
        for (assurance, branch, new) in similar {
            if own[new].is_none() && !taken[branch] {
                own[new] = Some(branch);
                taken[branch] = true;
                let eigenvalue = now[new].eigenvalue;
                let point = Point { value, mode: new, eigenvalue, assurance: Some(assurance) };
                branches[branch].points.push(point);
            }
        }
        before = own
            .into_iter()
            .enumerate()
            .map(|(new, branch)| {
                branch.unwrap_or_else(|| {
                    let eigenvalue = now[new].eigenvalue;
                    let point = Point { value, mode: new, eigenvalue, assurance: None };
                    branches.push(Branch { points: vec![point] });
                    branches.len() - 1
                })
            })
            .collect();
    }
    branches
}

/// The modal assurance criterion |xᴴ y|² / (‖x‖² ‖y‖²): 1 for vectors of one shape, 0 for orthogonal ones.
fn assurance(x: &[c64], y: &[c64]) -> f64 {
    let product: c64 = x.iter().zip(y).map(|(x, y)| x.conj() * y).sum();
    let norm = |x: &[c64]| x.iter().map(|x| x.norm_sqr()).sum::<f64>();
    product.norm_sqr() / (norm(x) * norm(y))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mode(re: f64, im: f64, vector: [f64; 3]) -> Mode {
        let vector = vector.map(|part| c64::new(part, 0.0)).to_vec();
        Mode { eigenvalue: c64::new(re, im), vector, backward: 0.0, bound: None }
    }

    /// Two modes whose frequencies cross keep their shapes; a third leaves, and a fourth comes.
    #[test]
    fn modes_are_followed_by_their_shapes_where_their_frequencies_cross() {
        let all = [
            vec![mode(-1.0, 9.0, [1.0, 0.0, 0.0]), mode(-3.0, 10.0, [0.0, 1.0, 0.0])],
            vec![mode(-1.0, 10.0, [0.1, 2.0, 0.0]), mode(-0.5, 10.5, [3.0, 0.1, 0.0])],
            vec![mode(1.0, 11.0, [2.0, 0.2, 0.1]), mode(-2.0, 12.0, [0.0, 0.1, 1.0])],
        ];
        let lists: Vec<Vec<&Mode>> = all.iter().map(|modes| modes.iter().collect()).collect();
        let branches = follow(&lists);
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
}
