//! Reading and writing of the catalogue's variables.

use super::Simulation;
use super::catalogue::{
    Kind, Per, Quantity, Template, Variable, output, parameter_or_input, superelement_row,
};
use super::parameters::not_settable;
use crate::Error;
use crate::contact::ContactForce;
use crate::scene::{Mass, Network, Problem, Rule, Scene, Structure, Superelement};

/// Reference to a parameter or input in a scene; `None` for an output, and for a value that the scene does not have.
pub(super) fn place_in<'a>(scene: &'a mut Scene, variable: &Variable) -> Option<&'a mut f64> {
    let i = variable.index;
    let &Template { quantity, component, .. } = variable.template;
    // The parts of a structure: those of a ring, and those of a network.
    let structure = &mut scene.structure;
    Some(match quantity {
        Quantity::SliderVelocity => &mut scene.slider.velocity,
        Quantity::SliderAngle => &mut scene.slider.angle,
        Quantity::FrictionCoefficient => &mut scene.friction_coefficient,
        Quantity::StaticFriction => return scene.static_friction.as_mut(),
        Quantity::StribeckVelocity => return scene.stribeck_velocity.as_mut(),
        Quantity::DampingAlpha => &mut scene.damping.alpha,
        Quantity::DampingBeta => &mut scene.damping.beta,
        Quantity::IntegratorStep => &mut scene.step,
        Quantity::Mass => match structure {
            Structure::Ring(modules) => &mut modules[i].mass[component],
            Structure::Network(network) => &mut network.masses[i].mass,
        },
        Quantity::Stiffness => match structure {
            Structure::Ring(modules) => &mut modules[i].stiffness[component],
            Structure::Network(network) => &mut network.springs[i].stiffness,
        },
        Quantity::Preload => match structure {
            Structure::Ring(modules) => &mut modules[i].preload,
            Structure::Network(network) => return network.springs[i].preload.as_mut(),
        },
        Quantity::ExternalForce => match structure {
            Structure::Ring(modules) => &mut modules[i].force[component],
            Structure::Network(network) => {
                return of_point(network, variable, |mass| &mut mass.force, |one| &mut one.force);
            }
        },
        Quantity::InitialDisplacement => match structure {
            Structure::Ring(modules) => &mut modules[i].displacement[component],
            Structure::Network(network) => {
                return of_point(
                    network,
                    variable,
                    |mass| &mut mass.displacement,
                    |one| &mut one.displacement,
                );
            }
        },
        Quantity::InitialVelocity => match structure {
            Structure::Ring(modules) => &mut modules[i].velocity[component],
            Structure::Network(network) => {
                return of_point(
                    network,
                    variable,
                    |mass| &mut mass.velocity,
                    |one| &mut one.velocity,
                );
            }
        },
        Quantity::DamperDamping => &mut network_of(structure)?.dampers[i].damping,
        Quantity::OwnVelocity => return network_of(structure)?.contacts[i].velocity.as_mut(),
        Quantity::OwnFriction => return network_of(structure)?.contacts[i].friction.as_mut(),
        Quantity::OwnStaticFriction => {
            return network_of(structure)?.contacts[i].static_friction.as_mut();
        }
        Quantity::Strict | output!() => return None,
    })
}

/// The value of a mass, or of a superelement's degree of freedom, to which a variable belongs.
fn of_point<'a>(
    network: &'a mut Network,
    variable: &Variable,
    of_mass: fn(&mut Mass) -> &mut [f64; 2],
    of_superelement: fn(&mut Superelement) -> &mut Vec<f64>,
) -> Option<&'a mut f64> {
    match superelement_row(network, variable.template, variable.index) {
        Some((place, row)) => of_superelement(&mut network.superelements[place]).get_mut(row),
        None => {
            let mass = network.masses.get_mut(variable.index)?;
            of_mass(mass).get_mut(variable.template.component)
        }
    }
}

fn network_of(structure: &mut Structure) -> Option<&mut Network> {
    match structure {
        Structure::Ring(_) => None,
        Structure::Network(network) => Some(network),
    }
}

/// Writes a parameter or input into a scene; [`Scene::check`] checks the value afterwards.
///
/// # Errors
/// Returns an error if the variable is an output.
pub fn write_scene(scene: &mut Scene, variable: &Variable, value: f64) -> Result<(), Error> {
    *place_in(scene, variable).ok_or_else(|| not_settable(variable))? = value;
    Ok(())
}

impl Simulation {
    /// Present value of any variable of this scene; integers and items of enumerations are returned as whole numbers.
    ///
    /// # Errors
    /// Returns an error if the contact forces have no solution.
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
            Quantity::GrowthRate => self.stability_indicator()?.growth_rate,
            Quantity::ModeFrequency => self.stability_indicator()?.frequency,
            Quantity::ModeCount => f64::from(self.stability_indicator()?.modes),
            parameter_or_input!() => {
                self.nominal.get(variable).expect("it is a parameter or input")
            }
        })
    }

    /// Force of the contacts on the slider, N: the opposite of their force on the masses.
    fn reaction(&mut self, part: impl Fn(&ContactForce) -> f64) -> Result<f64, Error> {
        self.contact_forces()?;
        let forces = self.contact_forces.iter().enumerate();
        let on_slider = forces.filter(|(contact, _)| self.scene.is_on_slider(*contact));
        Ok(-on_slider.map(|(_, force)| part(force)).sum::<f64>())
    }

    /// Sets an input or a tunable parameter, from now on.
    ///
    /// # Errors
    /// Returns an error if the variable must not change during a run, or cannot have this value; nothing is changed then.
    pub fn write(&mut self, variable: &Variable, value: f64) -> Result<(), Error> {
        if !variable.is_tunable() {
            return Err(Error::variable(format!(
                "{} cannot be set during a run: only inputs and tunable parameters can",
                variable.name
            )));
        }
        check_value(variable, value)?;
        // Before a run the scene is checked as a whole; during a run this is the only check of the rule.
        if let Some(wish) = rule(variable).broken_by(value) {
            return Err(Error::variable(impossible(variable, value, wish)));
        }
        self.nominal.set(variable, value)?;
        write_scene(&mut self.scene, variable, value)?;
        if let Some(driven) = &mut self.driven {
            driven.value_is_set(variable, value);
        }
        self.stale.by(variable);
        Ok(())
    }
}

/// Value of a counter as a variable of integer type; it saturates at the largest integer.
fn count(count: u64) -> f64 {
    f64::from(i32::try_from(count).unwrap_or(i32::MAX))
}

/// Refuses a value outside of the range that the model description declares.
///
/// # Errors
/// Returns an error that names the variable, the value, and what would be right.
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

/// Rule that the value of a parameter or input satisfies in every scene.
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
        // Component 3 is x4 of a module.
        Quantity::InitialDisplacement
            if (variable.template.component, variable.template.per) == (3, Per::Module) =>
        {
            Rule::GAP
        }
        Quantity::SliderVelocity
        | Quantity::SliderAngle
        | Quantity::Preload
        | Quantity::ExternalForce
        | Quantity::InitialDisplacement
        | Quantity::InitialVelocity
        | Quantity::OwnVelocity
        | Quantity::Strict
        | output!() => Rule::Finite,
    }
}

/// Message for an impossible value of a variable, with what would be right.
pub(super) fn impossible(variable: &Variable, value: f64, wish: &str) -> String {
    Problem::new(&*variable.name, wish).of(value).to_string()
}
