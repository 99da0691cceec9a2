//! The paper's ring of modules (Fig. 1) as a lumped model, whose degrees of freedom are those of
//! [`crate::model::ring`].
//!
//! | spring | joins | direction |
//! | --- | --- | --- |
//! | k1, k2 | m1 of this module and m1 of the next | horizontal, vertical |
//! | k3, k4 | m1 and ground | vertical, horizontal |
//! | k5, k6 | m1 and m2 of this module | vertical, horizontal |
//!
//! With two modules the ring has two links between the same masses; with one it has none.
//! The preload moves the ground end of k3 down by δ: a load −k3 δ on x2.

use super::elements::{Elongation, difference, spring};
use crate::model::ring::MODULE_DOFS;
use crate::model::{Contact, Direction, LumpedModel, SparseMatrix};
use crate::scene::{Module, Scene, direction};

/// The degree of freedom of a module that its preload acts on: x2.
pub(super) const PRELOADED: usize = 1;

/// The model of a scene that is a ring of these modules.
pub(super) fn model(scene: &Scene, modules: &[Module]) -> LumpedModel {
    let count = modules.len();
    let dofs = MODULE_DOFS * count;
    let axes = Axes::new(scene.slider.angle);
    let mut stiffness = Vec::new();
    for (i, module) in modules.iter().enumerate() {
        let [k1, k2, k3, k4, k5, k6] = module.stiffness;
        let next = (i + 1) % count;
        if next != i {
            spring(&mut stiffness, k1, &difference(upper_x(i), upper_x(next)));
            spring(&mut stiffness, k2, &difference(upper_y(i), upper_y(next)));
        }
        spring(&mut stiffness, k3, &upper_y(i));
        spring(&mut stiffness, k4, &upper_x(i));
        spring(&mut stiffness, k5, &difference(upper_y(i), axes.lower_y(i)));
        spring(&mut stiffness, k6, &difference(upper_x(i), axes.lower_x(i)));
    }
    let mass: Vec<f64> =
        modules.iter().flat_map(|Module { mass: [m1, m2], .. }| [*m1, *m1, *m2, *m2]).collect();
    let contact = |i| Contact {
        normal: Direction::unit(MODULE_DOFS * i + 3),
        tangent: Direction::unit(MODULE_DOFS * i + 2),
        transverse: None,
        gap: 0.0,
        friction: scene.friction_of(i),
        surface_velocity: scene.surface_velocity(i),
    };
    let mut model = LumpedModel {
        mass: SparseMatrix::diagonal(&mass),
        stiffness: SparseMatrix::from_entries(dofs, stiffness),
        damping: scene.damping,
        dampers: SparseMatrix::zero(dofs),
        load: vec![0.0; dofs],
        contacts: (0..count).map(contact).collect(),
        law: scene.contact_law(),
    };
    load(modules, &mut model.load);
    model
}

/// Writes the preload's forces, N, into `load`, one value for each degree of freedom.
pub(super) fn load(modules: &[Module], load: &mut [f64]) {
    for (module, load) in modules.iter().zip(load.chunks_exact_mut(MODULE_DOFS)) {
        load[PRELOADED] = preload_force(module, module.preload);
    }
}

/// The force, N, of a preload (m) of that module.
pub(super) fn preload_force(module: &Module, preload: f64) -> f64 {
    -module.stiffness[2] * preload
}

fn upper_x(module: usize) -> Elongation {
    vec![(MODULE_DOFS * module, 1.0)]
}

fn upper_y(module: usize) -> Elongation {
    vec![(MODULE_DOFS * module + 1, 1.0)]
}

/// The slider's directions.
struct Axes {
    cos: f64,
    sin: f64,
}

impl Axes {
    fn new(angle: f64) -> Self {
        let [cos, sin] = direction(angle);
        Self { cos, sin }
    }

    /// Horizontal displacement of m2.
    fn lower_x(&self, module: usize) -> Elongation {
        vec![(MODULE_DOFS * module + 2, self.cos), (MODULE_DOFS * module + 3, -self.sin)]
    }

    /// Vertical displacement of m2.
    fn lower_y(&self, module: usize) -> Elongation {
        vec![(MODULE_DOFS * module + 2, self.sin), (MODULE_DOFS * module + 3, self.cos)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin;

    fn ring(modules: usize) -> LumpedModel {
        let mut scene = builtin("set1").unwrap().scene();
        let module = scene.modules()[0];
        *scene.modules_mut() = vec![module; modules];
        LumpedModel::from(&scene)
    }

    #[test]
    fn two_modules_are_linked_twice_and_one_not_at_all() {
        let [k1, k4, k6] = [55e3, 60e3, 250e3];
        assert_eq!(ring(2).stiffness.get(0, 4), -2.0 * k1);
        assert_eq!(ring(3).stiffness.get(0, 4), -k1);
        assert_eq!(ring(3).stiffness.get(0, 8), -k1);
        assert_eq!(ring(1).stiffness.get(0, 0), k4 + k6);
    }

    #[test]
    fn stiffness_is_symmetric() {
        let stiffness = ring(3).stiffness;
        for (i, j, value) in stiffness.entries() {
            assert_eq!(value, stiffness.get(j, i));
        }
    }

    #[test]
    fn a_common_translation_strains_the_ground_springs_alone() {
        // Both masses of every module moved by (1, 0) in space: m2's x3 = cos θ, x4 = −sin θ.
        let model = ring(3);
        let (cos, sin) = (0.5_f64.cos(), 0.5_f64.sin());
        let shift: Vec<f64> = [1.0, 0.0, cos, -sin].repeat(3);
        for dof in 0..model.dofs() {
            let expected = if dof % 4 == 0 { 60e3 } else { 0.0 };
            assert!((model.stiffness.row_times(dof, &shift) - expected).abs() < 1e-9);
        }
    }
}
