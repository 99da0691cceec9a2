//! The random direction of a push.
//!
//! Independent normal draws of all velocities, in coordinates in which they have the same kinetic energy, have the same energy on average in
//! every direction along which no closed contact opens or closes ([`Held`]). The size of a push is that of the fastest point: a mass, or
//! a node of a superelement. Rotations and modal coordinates have other units, and move with it.

use super::normal::quantile;
use super::sobol::random;
use crate::stability::Linearised;
use crate::study::{Held, closed_normals, loudness::translations};
use amontons::Error;
use amontons::scene::Scene;
use nalgebra::DVector;

/// The place of the numbers of a direction among those that a run draws.
const DIRECTION: u64 = 3;

/// A random direction of the velocities of all degrees of freedom, that of run `number`, in which the fastest point moves with 1. No
/// closed contact moves along its normal.
///
/// # Errors
/// Returns an error if closed contacts hold every direction, if no point can move, or if the mass matrix is not positive definite.
pub(super) fn direction(scene: &Scene, seed: u64, number: u64) -> Result<Vec<f64>, Error> {
    let here = Linearised::of(scene);
    let dofs = here.model().dofs();
    let mut held = Held::none(&here.model().mass)?;
    closed_normals(&here).into_iter().for_each(|normal| held.hold(normal));
    if held.is_all() {
        return Err(Error::argument(
            "the scene cannot be pushed: closed contacts hold every direction of motion; leave out --pushes",
        ));
    }
    let draw = |dof: usize| quantile(random(seed, &[number, DIRECTION, dof as u64]));
    let mut along = held.velocity(DVector::from_iterator(dofs, (0..dofs).map(draw)));
    let fastest = fastest_point(scene, &along);
    if fastest == 0.0 {
        return Err(Error::argument(
            "the scene cannot be pushed: no mass and no node of it can move, so a push has no velocity; leave out --pushes",
        ));
    }
    along.iter_mut().for_each(|part| *part /= fastest);
    Ok(along)
}

/// The speed of the fastest mass or node, with these velocities of all degrees of freedom, m/s; 0 without masses and nodes.
fn fastest_point(scene: &Scene, velocity: &[f64]) -> f64 {
    let square = |dofs: &Vec<usize>| dofs.iter().map(|dof| velocity[*dof].powi(2)).sum::<f64>();
    translations(scene).iter().map(square).fold(0.0, f64::max).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use amontons::scene::{Freedom, SuperelementMatrices, builtin, parse, read};

    /// The shares of the kinetic energy in each degree of freedom, for some directions.
    fn shares(scene: &Scene, draws: u64, each: impl Fn(&[f64])) -> Vec<f64> {
        let mass = Linearised::of(scene).model().mass.clone();
        let mut sums = vec![0.0; mass.rows()];
        for number in 0..draws {
            let along = direction(scene, 1, number).unwrap();
            assert!((fastest_point(scene, &along) - 1.0).abs() < 1e-12);
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

    /// A node of 1 kg on a belt with a rotation and a modal coordinate, whose inertias of 1e-4 make both a hundred times as fast as its
    /// motion along the belt.
    #[test]
    fn the_size_of_a_push_is_the_velocity_of_a_node_and_not_that_of_rotations_and_modal_coordinates()
     {
        let freedoms = [(1, 1), (1, 2), (1, 6), (1, 0)];
        let freedoms = freedoms.map(|(node, direction)| Freedom { node, direction }).to_vec();
        let diagonal = |values: [f64; 4]| {
            let mut matrix = vec![0.0; 16];
            values.into_iter().enumerate().for_each(|(i, value)| matrix[5 * i] = value);
            matrix
        };
        let (mass, stiffness) = (diagonal([1.0, 1.0, 1e-4, 1e-4]), diagonal([1e6, 1e6, 1e2, 1e2]));
        let matrices =
            SuperelementMatrices::new(freedoms, mass, stiffness, diagonal([0.0; 4])).unwrap();
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("s.superelement"), matrices.to_bytes()).unwrap();
        let text = "slider = { velocity = 0.2, angle = 0.0 }\nfriction = { coefficient = 0.3 }\n\
             integrator = { step = 1e-6 }\n\
             superelement = [{ name = \"s\", file = \"s.superelement\" }]\n\
             contact = [{ name = \"belt\", mass = \"s.1\", normal = [0.0, 1.0, 0.0], tangent = [1.0, 0.0, 0.0] }]\n\
             load = [{ superelement = \"s\", nodes = [1], force = [0.0, -100.0, 0.0] }]\n";
        let path = folder.path().join("scene.toml");
        std::fs::write(&path, text).unwrap();
        let scene = read(&path).unwrap().0;
        for number in 0..20 {
            let along = direction(&scene, 1, number).unwrap();
            assert!((along[0].abs() - 1.0).abs() < 1e-12 && along[1] == 0.0, "{along:?}");
            assert!(along[2].abs() > 1.0 && along[3].abs() > 1.0, "{along:?}");
        }
    }
}
