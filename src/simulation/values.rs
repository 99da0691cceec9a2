//! What each variable of the catalogue reads and writes.

use super::Simulation;
use super::catalogue::{Kind, Quantity, Template, Variable, variables};
use crate::Error;
use crate::model::ring::MODULE_DOFS;
use crate::scene::{Scene, Structure};
use std::collections::HashSet;

/// Where a scene keeps the value of a variable, as a reference, or with `mut` one to write to; leaves
/// the function with `None` for an output.
macro_rules! place {
    ($scene:expr, $variable:expr $(, $mut:ident)?) => {{
        let (scene, i) = ($scene, $variable.index);
        let &Template { quantity, component, .. } = $variable.template;
        match (quantity, &$($mut)? scene.structure) {
            (Quantity::SliderVelocity, _) => &$($mut)? scene.slider.velocity,
            (Quantity::SliderAngle, _) => &$($mut)? scene.slider.angle,
            (Quantity::FrictionCoefficient, _) => &$($mut)? scene.friction_coefficient,
            (Quantity::DampingAlpha, _) => &$($mut)? scene.damping.alpha,
            (Quantity::DampingBeta, _) => &$($mut)? scene.damping.beta,
            (Quantity::IntegratorStep, _) => &$($mut)? scene.step,
            (quantity, Structure::Ring(modules)) => {
                let module = &$($mut)? modules[i];
                match quantity {
                    Quantity::Mass => &$($mut)? module.mass[component],
                    Quantity::Stiffness => &$($mut)? module.stiffness[component],
                    Quantity::Preload => &$($mut)? module.preload,
                    Quantity::ExternalForce => &$($mut)? module.force[component],
                    Quantity::InitialDisplacement => &$($mut)? module.displacement[component],
                    Quantity::InitialVelocity => &$($mut)? module.velocity[component],
                    _ => return None,
                }
            }
            (quantity, Structure::Network(network)) => match quantity {
                Quantity::Mass => &$($mut)? network.masses[i].mass,
                Quantity::Stiffness => &$($mut)? network.springs[i].stiffness,
                Quantity::Preload => &$($mut)? network.springs[i].preload,
                Quantity::DamperDamping => &$($mut)? network.dampers[i].damping,
                Quantity::ExternalForce => &$($mut)? network.masses[i].force[component],
                Quantity::InitialDisplacement => &$($mut)? network.masses[i].displacement[component],
                Quantity::InitialVelocity => &$($mut)? network.masses[i].velocity[component],
                Quantity::OwnVelocity => match &$($mut)? network.contacts[i].velocity {
                    Some(velocity) => velocity,
                    None => return None,
                },
                Quantity::OwnFriction => match &$($mut)? network.contacts[i].friction {
                    Some(friction) => friction,
                    None => return None,
                },
                _ => return None,
            },
        }
    }};
}

/// The value of a parameter or input in a scene; `None` for an output.
#[must_use]
pub fn read_scene(scene: &Scene, variable: &Variable) -> Option<f64> {
    Some(*place!(scene, variable))
}

/// The place of a parameter or input in a scene; `None` for an output.
fn place_in<'a>(scene: &'a mut Scene, variable: &Variable) -> Option<&'a mut f64> {
    Some(place!(scene, variable, mut))
}

/// Writes a parameter or input into a scene; [`Scene::check`] says whether it is possible.
///
/// # Errors
/// The variable is an output.
pub fn write_scene(scene: &mut Scene, variable: &Variable, value: f64) -> Result<(), Error> {
    let place = place_in(scene, variable).ok_or_else(|| {
        Error::variable(format!("{} cannot be set: it is an output", variable.name))
    })?;
    *place = value;
    Ok(())
}

/// Gives a parameter or input of a scene, known by its name, another value.
///
/// # Errors
/// There is no such parameter or input (those with like names are listed), or it cannot have this
/// value.
pub fn assign(scene: &mut Scene, name: &str, value: f64) -> Result<(), Error> {
    let settable: Vec<Variable> =
        variables(scene).into_iter().filter(Variable::is_settable).collect();
    if let Some(variable) = settable.iter().find(|variable| variable.name == name) {
        check_value(variable, value)?;
        return write_scene(scene, variable, value);
    }
    let group = |name: &str| name.rsplit_once('.').map(|(group, _)| group.to_owned());
    let mut like: Vec<&str> = settable.iter().map(|variable| &*variable.name).collect();
    if like.iter().any(|known| group(known) == group(name)) {
        like.retain(|known| group(known) == group(name));
    } else {
        // One module stands for all, and so does one part of a network for its kind.
        let mut kinds = HashSet::new();
        let kind = |name: &str| {
            let (kind, key) = (name.split('.').next(), name.rsplit('.').next());
            format!("{kind:?}{key:?}")
        };
        let is_ring = scene.network().is_none();
        like.retain(|known| match is_ring {
            true => !known.contains('[') || known.contains("[1]"),
            false => kinds.insert(kind(known)),
        });
    }
    Err(Error::variable(format!(
        "there is no parameter or input {name}; there are {}",
        like.join(", ")
    )))
}

impl Simulation {
    /// The present value of any variable of this scene; integers and items of enumerations as
    /// whole numbers.
    ///
    /// # Errors
    /// Contact forces that have no solution.
    pub fn read(&mut self, variable: &Variable) -> Result<f64, Error> {
        let index = variable.index;
        let component = variable.template.component;
        let dof = match self.scene.structure {
            Structure::Ring(_) => MODULE_DOFS * index + component,
            // Locked degrees of freedom have no variables.
            Structure::Network(_) => self.numbering.dof(index, component).unwrap_or(0),
        };
        Ok(match variable.template.quantity {
            Quantity::Displacement => self.motion.displacement[dof],
            Quantity::Velocity => self.motion.velocity[dof],
            Quantity::ContactState => f64::from(self.contact_forces()?[index].state as u8),
            Quantity::NormalForce => self.contact_forces()?[index].normal_force,
            Quantity::FrictionForce => self.contact_forces()?[index].friction_force,
            Quantity::SlipVelocity => self.contact_forces()?[index].slip_velocity,
            // What the contacts do to the masses they undo to the slider.
            Quantity::TangentialReaction => {
                -self.contact_forces()?.iter().map(|force| force.friction_force).sum::<f64>()
            }
            Quantity::NormalReaction => {
                -self.contact_forces()?.iter().map(|force| force.normal_force).sum::<f64>()
            }
            Quantity::StateChanges => {
                let count = u32::try_from(self.motion.statistics.state_changes);
                f64::from(count.map_or(i32::MAX, |count| i32::try_from(count).unwrap_or(i32::MAX)))
            }
            _ => read_scene(&self.scene, variable).expect("every other quantity is a scene's"),
        })
    }

    /// Gives an input or a tunable parameter another value, from now on.
    ///
    /// # Errors
    /// The variable may not change during a run, or cannot have this value; nothing is changed.
    pub fn write(&mut self, variable: &Variable, value: f64) -> Result<(), Error> {
        if !variable.is_tunable() {
            return Err(Error::variable(format!(
                "{} cannot be set during a run: only inputs and tunable parameters can",
                variable.name
            )));
        }
        check_value(variable, value)?;
        write_scene(&mut self.scene, variable, value)?;
        self.stale.drive = true;
        self.stale.contact_forces = true;
        self.stale.limit |= matches!(
            variable.template.quantity,
            Quantity::FrictionCoefficient | Quantity::OwnFriction | Quantity::DampingBeta
        );
        Ok(())
    }
}

/// Refuses a value that the variable can never have.
///
/// # Errors
/// The variable, the value, and what would be right.
pub fn check_value(variable: &Variable, value: f64) -> Result<(), Error> {
    let wish = match variable.template.kind {
        _ if !value.is_finite() => "a finite number".to_owned(),
        Kind::Real { min: Some(min), .. } if value < min => format!("≥ {min}"),
        _ => return Ok(()),
    };
    Err(Error::variable(format!("{} = {value}: must be {wish}", variable.name)))
}
