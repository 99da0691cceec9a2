//! The paper's ring of modules, as data.

use super::rule::{Problems, Rule};
use serde::{Deserialize, Serialize};

/// The most modules a ring may have.
pub const MAX_MODULES: usize = 100_000;

/// One module: two masses, its springs, and the links to the next module.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Module {
    /// m1 and m2, kg.
    pub mass: [f64; 2],
    /// k1 … k6, N/m; what each joins stands with the model, in `model::ring`.
    pub stiffness: [f64; 6],
    /// Preload δ: how far the ground end of k3 is moved down, m.
    pub preload: f64,
    /// External forces along x1 … x4, N.
    pub force: [f64; 4],
    /// Initial x1 … x4 relative to the equilibrium, m.
    pub displacement: [f64; 4],
    /// Initial velocities of x1 … x4, m/s.
    pub velocity: [f64; 4],
}

/// Names the impossible values of a ring.
pub(super) fn check(modules: &[Module], problems: &mut Problems) {
    for (i, module) in modules.iter().enumerate() {
        let i = i + 1;
        for (j, mass) in module.mass.into_iter().enumerate() {
            problems.check(|| format!("module[{i}].m{}", j + 1), mass, Rule::Positive);
        }
        for (j, stiffness) in module.stiffness.into_iter().enumerate() {
            problems.check(|| format!("module[{i}].k{}", j + 1), stiffness, Rule::NotNegative);
        }
        problems.check(|| format!("module[{i}].preload"), module.preload, Rule::Finite);
        for j in 0..4 {
            let (force, velocity) = (module.force[j], module.velocity[j]);
            problems.check(|| format!("module[{i}].f{}", j + 1), force, Rule::Finite);
            let rule = if j == 3 { Rule::NotInsideSlider } else { Rule::Finite };
            let name = || format!("initial.module[{i}].x{}", j + 1);
            problems.check(name, module.displacement[j], rule);
            problems.check(|| format!("initial.module[{i}].v{}", j + 1), velocity, Rule::Finite);
        }
    }
    if modules.is_empty() || modules.len() > MAX_MODULES {
        problems.add(format!(
            "ring.modules = {}: a ring has 1 to {MAX_MODULES} modules",
            modules.len()
        ));
    }
}
