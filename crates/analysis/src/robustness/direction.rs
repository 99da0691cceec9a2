//! The random direction of a push.
//!
//! With M = L Lᵀ, a velocity v = L⁻ᵀ ξ of independent normal draws ξ has the same kinetic energy |ξ|²/2 on average in every
//! direction. Closed contacts hold their normals n: nᵀ v = (L⁻¹ n)ᵀ ξ is to vanish, so ξ is projected at right angles to all
//! L⁻¹ n. What is left has the same energy on average in every direction along which no contact opens or closes.

use super::normal::quantile;
use super::sobol::random;
use crate::stability::Linearised;
use crate::study::closed_normals;
use amontons::Error;
use amontons::model::{Direction, SparseMatrix};
use amontons::numerics::max_norm;
use amontons::scene::Scene;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// The place of the numbers of a direction among those that a run draws.
const DIRECTION: u64 = 3;
/// A vector this small, in parts of what it was before a projection, is rounding.
const ROUNDING: f64 = 1e-9;

/// L of M = L Lᵀ.
enum Root {
    /// The square roots of a diagonal M.
    Diagonal(Vec<f64>),
    Full(Cholesky<f64, Dyn>),
}

impl Root {
    fn of(mass: &SparseMatrix) -> Result<Self, Error> {
        if let Some(diagonal) = mass.as_diagonal() {
            return Ok(Self::Diagonal(diagonal.iter().map(|mass| mass.sqrt()).collect()));
        }
        let full = DMatrix::from_fn(mass.rows(), mass.rows(), |i, j| mass.get(i, j));
        Cholesky::new(full).map(Self::Full).ok_or_else(|| {
            Error::argument(
                "the scene cannot be pushed: its mass matrix is not positive definite; leave out --pushes",
            )
        })
    }

    /// L⁻¹ n.
    fn scaled(&self, normal: &Direction, dofs: usize) -> DVector<f64> {
        let mut vector = DVector::zeros(dofs);
        for &(dof, part) in &normal.0 {
            vector[dof] += part;
        }
        match self {
            Self::Diagonal(roots) => {
                vector.iter_mut().zip(roots).for_each(|(part, root)| *part /= root);
            }
            Self::Full(factor) => {
                factor.l_dirty().solve_lower_triangular_mut(&mut vector);
            }
        }
        vector
    }

    /// L⁻ᵀ ξ.
    fn velocity(&self, mut draws: DVector<f64>) -> Vec<f64> {
        match self {
            Self::Diagonal(roots) => {
                draws.iter_mut().zip(roots).for_each(|(part, root)| *part /= root);
            }
            Self::Full(factor) => {
                factor.l_dirty().tr_solve_lower_triangular_mut(&mut draws);
            }
        }
        draws.iter().copied().collect()
    }
}

/// A random direction of the velocities of all degrees of freedom, the largest 1: that of run `number`. No closed contact
/// moves along its normal.
///
/// # Errors
/// Returns an error if closed contacts hold every direction, or if the mass matrix is not positive definite.
pub(super) fn direction(scene: &Scene, seed: u64, number: u64) -> Result<Vec<f64>, Error> {
    let here = Linearised::of(scene);
    let dofs = here.model().dofs();
    let root = Root::of(&here.model().mass)?;
    let mut held: Vec<DVector<f64>> = Vec::new();
    for normal in closed_normals(&here) {
        let mut vector = root.scaled(normal, dofs);
        let before = vector.norm();
        remove(&held, &mut vector);
        // A normal that others hold already adds none.
        let after = vector.norm();
        if after > ROUNDING * before {
            held.push(vector / after);
        }
    }
    let draw = |dof: usize| quantile(random(seed, &[number, DIRECTION, dof as u64]));
    let mut draws = DVector::from_iterator(dofs, (0..dofs).map(draw));
    remove(&held, &mut draws);
    let mut along = root.velocity(draws);
    if held.len() >= dofs {
        return Err(Error::argument(
            "the scene cannot be pushed: closed contacts hold every direction of motion; leave out --pushes",
        ));
    }
    let largest = max_norm(&along);
    along.iter_mut().for_each(|part| *part /= largest);
    Ok(along)
}

/// Removes the parts of a vector along vectors of length 1 at right angles; twice, against rounding.
fn remove(held: &[DVector<f64>], vector: &mut DVector<f64>) {
    for _ in 0..2 {
        for unit in held {
            let part = unit.dot(vector);
            vector.axpy(-part, unit, 1.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use amontons::scene::{builtin, parse};

    /// The shares of the kinetic energy in each degree of freedom, for some directions.
    fn shares(scene: &Scene, draws: u64, each: impl Fn(&[f64])) -> Vec<f64> {
        let mass = Linearised::of(scene).model().mass.clone();
        let mut sums = vec![0.0; mass.rows()];
        for number in 0..draws {
            let along = direction(scene, 1, number).unwrap();
            assert_eq!(max_norm(&along), 1.0);
            each(&along);
            let energy = |dof: usize| along[dof] * mass.row_times(dof, &along);
            let all: f64 = (0..along.len()).map(energy).sum();
            sums.iter_mut().enumerate().for_each(|(dof, sum)| *sum += energy(dof) / all);
        }
        sums.into_iter().map(|sum| sum / draws as f64).collect()
    }

    #[test]
    fn a_push_has_no_part_into_a_surface_and_as_much_energy_in_each_degree_of_freedom() {
        const DRAWS: u64 = 20_000;
        let found = shares(&builtin("set1").unwrap().scene(), DRAWS, |_| {});
        let free: Vec<f64> = found.into_iter().filter(|share| *share > 0.0).collect();
        // Two contacts hold one degree of freedom each. The share of one of six squares of normal draws has the variance 5/144.
        assert_eq!(free.len(), 6);
        let allowed = 4.0 * (5.0 / 144.0 / DRAWS as f64).sqrt();
        assert!(free.iter().all(|share| (share - 1.0 / 6.0).abs() < allowed), "{free:?}");
    }

    /// A block of 2 kg on an incline of 0.5 rad, which a spring and its weight press on, and a free one of 3 kg beside it;
    /// `more` is beside the contact.
    fn incline(more: &str) -> Scene {
        let text = format!(
            "slider = {{ velocity = 0.5, angle = 0.5 }}\nfriction = {{ coefficient = 0.1 }}\n\
             integrator = {{ step = 1e-6 }}\n\
             mass = [{{ name = \"block\", mass = 2.0, force = [0.0, -5.0] }}, {{ name = \"free\", mass = 3.0 }}]\n\
             spring = [{{ name = \"kx\", between = [\"block\", \"free\"], direction = \"x\", stiffness = 100.0 }},\n\
             {{ name = \"ky\", between = [\"block\", \"ground\"], direction = \"y\", stiffness = 100.0 }},\n\
             {{ name = \"fx\", between = [\"free\", \"ground\"], direction = \"x\", stiffness = 100.0 }},\n\
             {{ name = \"fy\", between = [\"free\", \"ground\"], direction = \"y\", stiffness = 100.0 }}]\n\
             contact = [{{ name = \"belt\", mass = \"block\" }}{more}]\n"
        );
        parse("incline", &text).unwrap()
    }

    /// The block moves along the incline alone: cos² of its energy is in x and sin² in y, and one of three directions of equal
    /// energy is its own.
    #[test]
    fn on_an_inclined_contact_the_push_is_along_the_surface_with_its_share_of_the_energy() {
        const DRAWS: u64 = 20_000;
        let scene = incline("");
        let model = Linearised::of(&scene).model().clone();
        let found = shares(&scene, DRAWS, |along| {
            assert!(model.contacts[0].normal.dot(along).abs() < 1e-14);
        });
        let third = 1.0 / 3.0;
        let (cos, sin) = (0.5_f64.cos().powi(2), 0.5_f64.sin().powi(2));
        // The share of one of three squares of normal draws has the variance 4/45.
        let allowed = 4.0 * (4.0 / 45.0 / DRAWS as f64).sqrt();
        for (share, expected) in found.iter().zip([third * cos, third * sin, third, third]) {
            assert!((share - expected).abs() < allowed, "{found:?}");
        }
    }

    #[test]
    fn a_contact_that_a_gap_keeps_open_holds_no_push() {
        let scene = incline(", { name = \"stop\", mass = \"free\", gap = 1.0 }");
        let found = shares(&scene, 1000, |_| {});
        // A third in each direction of the free mass, and in that of the block along the incline.
        assert!(found[2..].iter().all(|share| (share - 1.0 / 3.0).abs() < 0.05), "{found:?}");
    }

    /// One mass of 2 kg and one of 1 kg whose coupling is 0.5 kg.
    #[test]
    fn draws_of_a_full_mass_matrix_have_its_inverse_as_covariance() {
        const DRAWS: u32 = 20_000;
        let mass =
            SparseMatrix::from_entries(2, vec![(0, 0, 2.0), (0, 1, 0.5), (1, 0, 0.5), (1, 1, 1.0)]);
        let root = Root::of(&mass).unwrap();
        let mut sums = [0.0; 3];
        for number in 0..DRAWS {
            let draw = |dof: u64| quantile(random(7, &[u64::from(number), DIRECTION, dof]));
            let v = root.velocity(DVector::from_vec(vec![draw(0), draw(1)]));
            for (sum, product) in sums.iter_mut().zip([v[0] * v[0], v[0] * v[1], v[1] * v[1]]) {
                *sum += product / f64::from(DRAWS);
            }
        }
        // The determinant is 1.75.
        for (sum, expected) in sums.into_iter().zip([1.0 / 1.75, -0.5 / 1.75, 2.0 / 1.75]) {
            assert!((sum - expected).abs() < 0.04, "{sum} {expected}");
        }
        // nᵀ M⁻¹ n.
        let square = root.scaled(&Direction::unit(1), 2).norm_squared();
        assert!((square - 2.0 / 1.75).abs() < 1e-15, "{square}");
    }
}
