//! `[ring]` of a scene file.

use super::file::Initial;
use super::per_module::PerModule;
use super::{MAX_MODULES, Module};
use crate::Error;
use serde::Deserialize;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Ring {
    modules: usize,
    m1: PerModule,
    m2: PerModule,
    k1: PerModule,
    k2: PerModule,
    k3: PerModule,
    k4: PerModule,
    k5: PerModule,
    k6: PerModule,
    preload: PerModule,
}

impl Ring {
    /// The modules at their equilibrium.
    pub(super) fn modules(&self) -> Result<Vec<Module>, Error> {
        if self.modules == 0 || self.modules > MAX_MODULES {
            return Err(Error::scene(format!(
                "ring.modules = {}: a ring has 1 to {MAX_MODULES} modules",
                self.modules
            )));
        }
        let value = |key: &str, values: &PerModule, i: usize| match values.length() {
            Some(length) if length != self.modules => Err(Error::scene(format!(
                "ring.{key} lists {length} values, but the ring has {} modules; \
                 give one number for all, or one a module",
                self.modules
            ))),
            _ => Ok(values.of(i).expect("the length was just checked")),
        };
        (0..self.modules)
            .map(|i| {
                Ok(Module {
                    mass: [value("m1", &self.m1, i)?, value("m2", &self.m2, i)?],
                    stiffness: [
                        value("k1", &self.k1, i)?,
                        value("k2", &self.k2, i)?,
                        value("k3", &self.k3, i)?,
                        value("k4", &self.k4, i)?,
                        value("k5", &self.k5, i)?,
                        value("k6", &self.k6, i)?,
                    ],
                    preload: value("preload", &self.preload, i)?,
                    force: [0.0; 4],
                    displacement: [0.0; 4],
                    velocity: [0.0; 4],
                })
            })
            .collect()
    }
}

/// Gives a module its initial displacement and velocity.
pub(super) fn apply(initial: &Initial, modules: &mut [Module]) -> Result<(), Error> {
    let count = modules.len();
    let wish =
        || Error::scene("[[initial]] of a ring gives its module, and any of x1 … x4, v1 … v4");
    if initial.mass.is_some() || initial.along_axes().iter().any(Option::is_some) {
        return Err(wish());
    }
    let number = initial.module.ok_or_else(wish)?;
    let module = number.checked_sub(1).and_then(|i| modules.get_mut(i)).ok_or_else(|| {
        Error::scene(format!("initial.module = {number}: the ring has modules 1 to {count}"))
    })?;
    let [displacement, velocity] = initial.of_module();
    module.displacement = displacement.map(Option::unwrap_or_default);
    module.velocity = velocity.map(Option::unwrap_or_default);
    Ok(())
}
