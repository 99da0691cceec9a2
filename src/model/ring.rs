//! The paper's ring of modules (Fig. 1) as a lumped model.
//!
//! Degrees of freedom of module i (from 0), at 4 i + 0 … 3:
//!
//! * x1, x2: mass m1, horizontal (right) and vertical (up);
//! * x3, x4: mass m2, along the slider's tangent t = (cos θ, sin θ) and outward normal
//!   n = (−sin θ, cos θ); the contact is closed at x4 = 0.
//!
//! | spring | joins | direction |
//! | --- | --- | --- |
//! | k1, k2 | m1 of this module and m1 of the next | horizontal, vertical |
//! | k3, k4 | m1 and ground | vertical, horizontal |
//! | k5, k6 | m1 and m2 of this module | vertical, horizontal |
//!
//! With two modules the ring has two links between the same masses; with one it has none.
//! The preload moves the ground end of k3 down by δ: a load −k3 δ on x2.

use super::{Contact, Direction, Entry, Equilibrium, LumpedModel, SparseMatrix};
use crate::Error;
use crate::scene::{Module, Scene};

/// Degrees of freedom of a module.
pub const MODULE_DOFS: usize = 4;

impl From<&Scene> for LumpedModel {
    fn from(scene: &Scene) -> Self {
        let count = scene.modules.len();
        let dofs = MODULE_DOFS * count;
        let axes = Axes::new(scene.slider.angle);
        let mut stiffness = Vec::new();
        for (i, module) in scene.modules.iter().enumerate() {
            let [k1, k2, k3, k4, k5, k6] = module.stiffness;
            let next = (i + 1) % count;
            spring(&mut stiffness, k1, &difference(upper_x(i), upper_x(next)));
            spring(&mut stiffness, k2, &difference(upper_y(i), upper_y(next)));
            spring(&mut stiffness, k3, &upper_y(i));
            spring(&mut stiffness, k4, &upper_x(i));
            spring(&mut stiffness, k5, &difference(upper_y(i), axes.lower_y(i)));
            spring(&mut stiffness, k6, &difference(upper_x(i), axes.lower_x(i)));
        }
        let mass: Vec<f64> = scene
            .modules
            .iter()
            .flat_map(|Module { mass: [m1, m2], .. }| [*m1, *m1, *m2, *m2])
            .collect();
        let mut model = Self {
            mass: SparseMatrix::diagonal(&mass),
            stiffness: SparseMatrix::from_entries(dofs, stiffness),
            damping: scene.damping,
            load: vec![0.0; dofs],
            contacts: (0..count)
                .map(|i| Contact {
                    tangent: Direction::unit(MODULE_DOFS * i + 2),
                    normal: Direction::unit(MODULE_DOFS * i + 3),
                })
                .collect(),
        };
        load(scene, &mut model.load);
        model
    }
}

/// Writes the preload's forces, N, into `load`, one value a degree of freedom.
pub fn load(scene: &Scene, load: &mut [f64]) {
    for (module, load) in scene.modules.iter().zip(load.chunks_exact_mut(MODULE_DOFS)) {
        load[1] = -module.stiffness[2] * module.preload;
    }
}

/// The equilibrium in uniform sliding of the scene's own µ and v; `model` is the scene's.
///
/// Equal modules move as one, so one is solved for all: they then are in equal states to the last
/// bit, which a solution of the whole, with its rounding, would not give.
///
/// # Errors
/// As [`LumpedModel::sliding_equilibrium`].
pub fn equilibrium(scene: &Scene, model: &LumpedModel) -> Result<Equilibrium, Error> {
    let (friction, velocity) = (scene.friction_coefficient, scene.slider.velocity);
    let statics = |module: &Module| (module.stiffness, module.preload);
    let first = statics(&scene.modules[0]);
    if !scene.modules.iter().all(|module| statics(module) == first) {
        return model.sliding_equilibrium(friction, velocity);
    }
    let count = scene.modules.len();
    let one = Scene { modules: scene.modules[..1].to_vec(), ..scene.clone() };
    let alone = LumpedModel::from(&one).sliding_equilibrium(friction, velocity)?;
    Ok(Equilibrium {
        displacement: alone.displacement.repeat(count),
        normal_force: alone.normal_force.repeat(count),
        friction_force: alone.friction_force.repeat(count),
    })
}

/// The elongation of a spring as a combination of degrees of freedom.
type Elongation = Vec<(usize, f64)>;

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
    /// From the `libm` crate: the platform's own sine differs from machine to machine.
    fn new(angle: f64) -> Self {
        Self { cos: libm::cos(angle), sin: libm::sin(angle) }
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

fn difference(mut a: Elongation, b: Elongation) -> Elongation {
    a.extend(b.into_iter().map(|(dof, value)| (dof, -value)));
    a
}

/// Adds k b bᵀ for a spring k with elongation b.
fn spring(entries: &mut Vec<Entry>, k: f64, elongation: &Elongation) {
    for &(i, a) in elongation {
        for &(j, b) in elongation {
            entries.push((i, j, k * (a * b)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin;

    fn ring(modules: usize) -> LumpedModel {
        let mut scene = builtin("set1").unwrap().scene();
        scene.modules = vec![scene.modules[0]; modules];
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
