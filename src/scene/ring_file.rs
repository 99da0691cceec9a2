//! `[ring]` of a scene file, and `[[initial]]` of its modules.

#[cfg(feature = "schema")]
use super::Rule;
use super::per_module::PerModule;
use super::ring::not_a_ring;
use super::{MAX_MODULES, Module, Problem};
use serde::Deserialize;

/// The ring of modules; each value is one number for all modules, or a list with one number for each module.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(extend(
    "dependencies" = { "k1": ["k2"], "k2": ["k1"] },
)))]
#[serde(deny_unknown_fields)]
pub(super) struct Ring {
    /// Number of modules.
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = MAX_MODULES)))]
    modules: usize,
    /// Mass m1, kg.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::MASS.bounds()))]
    m1: PerModule,
    /// Mass m2, which slides on the slider, kg.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::MASS.bounds()))]
    m2: PerModule,
    /// Stiffness from m1 to the next m1, horizontal, N/m; without `k1` and `k2` the modules are not linked.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::STIFFNESS.bounds()))]
    k1: Option<PerModule>,
    /// Stiffness from m1 to the next m1, vertical, N/m.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::STIFFNESS.bounds()))]
    k2: Option<PerModule>,
    /// Stiffness from m1 to ground, vertical, N/m.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::STIFFNESS.bounds()))]
    k3: PerModule,
    /// Stiffness from m1 to ground, horizontal, N/m.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::STIFFNESS.bounds()))]
    k4: PerModule,
    /// Stiffness from m1 to m2, vertical, N/m.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::STIFFNESS.bounds()))]
    k5: PerModule,
    /// Stiffness from m1 to m2, horizontal, N/m.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::STIFFNESS.bounds()))]
    k6: PerModule,
    /// Preload: downward displacement of the ground end of k3, m; none by default.
    preload: Option<PerModule>,
}

/// Initial displacement and velocity of one module, relative to the equilibrium.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct ModuleInitial {
    /// Number of the module, counted from 1.
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = MAX_MODULES)))]
    pub(super) module: usize,
    /// Displacement of m1, horizontal, m.
    #[serde(default)]
    x1: f64,
    /// Displacement of m1, vertical, m.
    #[serde(default)]
    x2: f64,
    /// Displacement of m2 along the slider, m.
    #[serde(default)]
    x3: f64,
    /// Displacement of m2 away from the slider, m.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::GAP.bounds()))]
    #[serde(default)]
    x4: f64,
    /// Velocity of m1, horizontal, m/s.
    #[serde(default)]
    v1: f64,
    /// Velocity of m1, vertical, m/s.
    #[serde(default)]
    v2: f64,
    /// Velocity of m2 along the slider, m/s.
    #[serde(default)]
    v3: f64,
    /// Velocity of m2 away from the slider, m/s.
    #[serde(default)]
    v4: f64,
}

impl Ring {
    /// Reports a ring that has one of `k1` and `k2` without the other.
    pub(super) fn lone_link(&self) -> Option<Problem> {
        let is_lone = self.k1.is_some() != self.k2.is_some();
        is_lone.then(|| Problem::new("ring", "has only one of `k1` and `k2`; give both or neither"))
    }

    /// `true` if links join the modules.
    pub(super) fn has_links(&self) -> bool {
        self.k1.is_some() && self.k2.is_some()
    }

    /// `true` if the table gives a preload.
    pub(super) fn has_preload(&self) -> bool {
        self.preload.is_some()
    }

    /// Makes the modules, at rest in their equilibrium.
    pub(super) fn modules(&self) -> Result<Vec<Module>, Vec<Problem>> {
        if self.modules == 0 || self.modules > MAX_MODULES {
            return Err(vec![not_a_ring(self.modules)]);
        }
        let none = PerModule::Same(0.0);

        let keys = [
            ("m1", &self.m1),
            ("m2", &self.m2),
            ("k1", self.k1.as_ref().unwrap_or(&none)),
            ("k2", self.k2.as_ref().unwrap_or(&none)),
            ("k3", &self.k3),
            ("k4", &self.k4),
            ("k5", &self.k5),
            ("k6", &self.k6),
            ("preload", self.preload.as_ref().unwrap_or(&none)),
        ];
        let wrong_length = |(key, values): (&str, &PerModule)| {
            let length = values.length().filter(|&length| length != self.modules)?;
            let values = if length == 1 { "value" } else { "values" };
            let message =
                format!("lists {length} {values}, but the ring has {} modules", self.modules);
            let help = "give one number for all modules, or one for each module";
            Some(Problem::new(format!("ring.{key}"), message).help(help))
        };
        let problems: Vec<Problem> = keys.into_iter().filter_map(wrong_length).collect();
        if !problems.is_empty() {
            return Err(problems);
        }
        let module = |i: usize| {
            let [m1, m2, k1, k2, k3, k4, k5, k6, preload] =
                keys.map(|(_, values)| values.of(i).expect("the lengths were just checked"));
            Module {
                mass: [m1, m2],
                stiffness: [k1, k2, k3, k4, k5, k6],
                preload,
                force: [0.0; 4],
                displacement: [0.0; 4],
                velocity: [0.0; 4],
            }
        };
        Ok((0..self.modules).map(module).collect())
    }
}

impl ModuleInitial {
    /// Gives the module its initial displacement and velocity.
    pub(super) fn apply(&self, module: &mut Module) {
        module.displacement = [self.x1, self.x2, self.x3, self.x4];
        module.velocity = [self.v1, self.v2, self.v3, self.v4];
    }
}
