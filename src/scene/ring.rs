//! The paper's ring of modules, as data.

use super::check::{Checks, Owner};
use super::{Problem, Rule};

/// Largest number of modules of a ring.
pub const MAX_MODULES: usize = 100_000;

/// One module: two masses, its springs, and the links to the next module.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Module {
    /// Masses m1 and m2, kg.
    pub mass: [f64; 2],
    /// Stiffnesses k1 … k6, N/m; `assembly::ring` lists what each joins.
    pub stiffness: [f64; 6],
    /// Preload δ: downward displacement of the ground end of k3, m.
    pub preload: f64,
    /// External forces along x1 … x4, N.
    pub force: [f64; 4],
    /// Initial x1 … x4, relative to the equilibrium, m.
    pub displacement: [f64; 4],
    /// Initial velocities of x1 … x4, m/s.
    pub velocity: [f64; 4],
}

/// Problem of a ring whose number of modules is out of range.
pub(super) fn not_a_ring(modules: usize) -> Problem {
    Problem::new("ring.modules", format!("a ring has 1 to {MAX_MODULES} modules")).of(modules)
}

/// Reports impossible values of a ring.
pub(super) fn check(modules: &[Module], checks: &mut Checks<'_>) {
    for (i, module) in modules.iter().enumerate() {
        let own = Owner::Module(i);
        let initial = Owner::InitialOfModule(i);
        for (key, mass) in ["m1", "m2"].into_iter().zip(module.mass) {
            checks.value(own, key, mass, Rule::MASS);
        }
        for (key, stiffness) in
            ["k1", "k2", "k3", "k4", "k5", "k6"].into_iter().zip(module.stiffness)
        {
            checks.value(own, key, stiffness, Rule::STIFFNESS);
        }
        checks.value(own, "preload", module.preload, Rule::Finite);
        for (key, force) in ["f1", "f2", "f3", "f4"].into_iter().zip(module.force) {
            checks.value(own, key, force, Rule::Finite);
        }
        let rules = [Rule::Finite, Rule::Finite, Rule::Finite, Rule::GAP];
        let displacement = module.displacement.into_iter().zip(rules);
        for (key, (displacement, rule)) in ["x1", "x2", "x3", "x4"].into_iter().zip(displacement) {
            checks.value(initial, key, displacement, rule);
        }
        for (key, velocity) in ["v1", "v2", "v3", "v4"].into_iter().zip(module.velocity) {
            checks.value(initial, key, velocity, Rule::Finite);
        }
    }
    if modules.is_empty() || modules.len() > MAX_MODULES {
        checks.problems.push(not_a_ring(modules.len()));
    }
}
