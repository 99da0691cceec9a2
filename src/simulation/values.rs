//! What each variable of the catalogue reads and writes.

use super::Simulation;
use super::catalogue::{Kind, Quantity, Template, Variable};
use crate::Error;
use crate::contact::ContactForce;
use crate::scene::{Problem, Rule, Scene, Structure};

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
            (Quantity::StaticFriction, _) => match &$($mut)? scene.static_friction {
                Some(friction) => friction,
                None => return None,
            },
            (Quantity::StribeckVelocity, _) => match &$($mut)? scene.stribeck_velocity {
                Some(velocity) => velocity,
                None => return None,
            },
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
                Quantity::Preload => match &$($mut)? network.springs[i].preload {
                    Some(preload) => preload,
                    None => return None,
                },
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
                Quantity::OwnStaticFriction => match &$($mut)? network.contacts[i].static_friction {
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

impl Simulation {
    /// The present value of any variable of this scene; integers and items of enumerations as
    /// whole numbers.
    ///
    /// # Errors
    /// Contact forces that have no solution.
    pub fn read(&mut self, variable: &Variable) -> Result<f64, Error> {
        let index = variable.index;
        let dof = || super::dof(&self.scene, &self.numbering, variable);
        Ok(match variable.template.quantity {
            Quantity::Displacement => self.motion.displacement[dof()],
            Quantity::Velocity => self.motion.velocity[dof()],
            Quantity::ContactState => f64::from(self.contact_forces()?[index].state as u8),
            Quantity::NormalForce => self.contact_forces()?[index].normal_force,
            Quantity::FrictionForce => self.contact_forces()?[index].friction_force,
            Quantity::SlipVelocity => self.contact_forces()?[index].slip_velocity,
            Quantity::TangentialReaction => self.reaction(|force| force.friction_force)?,
            Quantity::NormalReaction => self.reaction(|force| force.normal_force)?,
            Quantity::StateChanges => count(self.motion.statistics.state_changes()),
            Quantity::ReversedSlips => count(self.motion.statistics.reversed_slips),
            Quantity::PulledContacts => count(self.motion.statistics.pulled_contacts),
            Quantity::Energy => {
                self.energy().map_or(f64::NAN, |energy| energy.parts()[variable.template.component])
            }
            Quantity::GrowthRate => self.outlook()?.growth_rate,
            Quantity::ModeFrequency => self.outlook()?.frequency,
            Quantity::ModeCount => f64::from(self.outlook()?.modes),
            _ => read_scene(&self.scene, variable).expect("every other quantity is a scene's"),
        })
    }

    /// What the contacts do to the slider, N: the opposite of what they do to the masses.
    fn reaction(&mut self, part: impl Fn(&ContactForce) -> f64) -> Result<f64, Error> {
        self.contact_forces()?;
        let forces = self.contact_forces.iter().enumerate();
        let on_slider = forces.filter(|(contact, _)| self.scene.is_on_slider(*contact));
        Ok(-on_slider.map(|(_, force)| part(force)).sum::<f64>())
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
        // Before a run the scene as a whole is checked; now there is nobody after this.
        if let Some(wish) = rule(variable).broken_by(value) {
            return Err(Error::variable(impossible(variable, value, wish)));
        }
        write_scene(&mut self.scene, variable, value)?;
        if let Some(driven) = &mut self.driven {
            driven.write(variable, value)?;
        }
        self.stale.by(variable);
        Ok(())
    }
}

/// A count as a variable has it: up to the largest of its type.
fn count(count: u64) -> f64 {
    f64::from(i32::try_from(count).unwrap_or(i32::MAX))
}

/// Refuses a value that is outside of what the model description declares.
///
/// # Errors
/// The variable, the value, and what would be right.
pub fn check_value(variable: &Variable, value: f64) -> Result<(), Error> {
    let is_declared = match variable.template.kind {
        Kind::Real { min: Some(min), .. } => value >= min,
        _ => true,
    };
    match rule(variable).broken_by(value) {
        Some(wish) if !is_declared || !value.is_finite() => {
            Err(Error::variable(impossible(variable, value, wish)))
        }
        _ => Ok(()),
    }
}

/// Refuses values that no run can have; how they go together is for the scene as a whole, and for each step.
///
/// # Errors
/// The first such variable, its value, and what would be right.
pub(super) fn check_given(scene: &Scene, variables: &[Variable]) -> Result<(), Error> {
    for variable in variables {
        let Some(value) = read_scene(scene, variable) else { continue };
        if let Some(wish) = rule(variable).broken_by(value) {
            return Err(Error::saved_state(format!(
                "the saved state has {}",
                impossible(variable, value, wish)
            )));
        }
    }
    if let Some(wish) = Rule::TIME.broken_by(scene.step) {
        return Err(Error::saved_state(format!(
            "the saved state has a step of {}: {wish}",
            scene.step
        )));
    }
    Ok(())
}

/// What every scene asks of a parameter's or input's value.
#[must_use]
pub fn rule(variable: &Variable) -> Rule {
    match variable.template.quantity {
        Quantity::Mass => Rule::MASS,
        Quantity::Stiffness => Rule::STIFFNESS,
        Quantity::FrictionCoefficient
        | Quantity::StaticFriction
        | Quantity::OwnFriction
        | Quantity::OwnStaticFriction => Rule::FRICTION,
        Quantity::DampingAlpha | Quantity::DampingBeta | Quantity::DamperDamping => Rule::DAMPING,
        Quantity::StribeckVelocity => Rule::STRIBECK_VELOCITY,
        Quantity::IntegratorStep => Rule::TIME,
        // x4 of a module.
        Quantity::InitialDisplacement if variable.template.component == 3 => Rule::GAP,
        _ => Rule::Finite,
    }
}

fn impossible(variable: &Variable, value: f64, wish: &str) -> String {
    Problem::new(&*variable.name, wish).of(value).to_string()
}
