//! What each variable of the catalogue reads and writes.

use super::Simulation;
#[cfg(feature = "tools")]
use super::catalogue::variables;
use super::catalogue::{Kind, Quantity, Template, Variable};
use crate::Error;
use crate::contact::ContactForce;
#[cfg(feature = "tools")]
use crate::scene::{Lack, nearest};
use crate::scene::{Problem, Rule, Scene, Structure};
#[cfg(feature = "tools")]
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

/// Gives a parameter or input of a scene, known by its name, another value.
///
/// # Errors
/// There is no such parameter or input (the nearest name is given, or those with like names), or it
/// cannot have this value.
#[cfg(feature = "tools")]
pub fn assign(scene: &mut Scene, name: &str, value: f64) -> Result<(), Error> {
    let settable: Vec<Variable> =
        variables(scene).into_iter().filter(Variable::is_settable).collect();
    if let Some(variable) = settable.iter().find(|variable| variable.name == name) {
        let rule = match variable.template.quantity {
            Quantity::SliderAngle => scene.inclination_rule(),
            _ => rule(variable),
        };
        return match rule.broken_by(value) {
            None => write_scene(scene, variable, value),
            Some(wish) => Err(Error::scene(impossible(variable, value, wish))),
        };
    }
    if let Some(output) = variables(scene).iter().find(|variable| variable.name == name) {
        return Err(Error::argument(format!("{} cannot be set: it is an output", output.name)));
    }
    if name == "integrator.step" {
        return Err(Error::argument(format!(
            "integrator.step cannot be set: integrator.{} chooses it; give --integrator and --step",
            scene.selection
        )));
    }
    if let Some(Lack { reason, help }) = scene.lack(name) {
        return Err(Error::argument(format!("{name} cannot be set: {reason}; {help}")));
    }
    if let Some(meant) = nearest(name, settable.iter().map(|variable| &*variable.name)) {
        return Err(Error::argument(format!(
            "there is no parameter or input {name}; did you mean {meant}?"
        )));
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
    Err(Error::argument(format!(
        "there is no parameter or input {name}; there are, for example, {}",
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
fn rule(variable: &Variable) -> Rule {
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

#[cfg(all(test, feature = "tools"))]
mod tests {
    use super::*;
    use crate::scene::{builtin, parse};

    #[test]
    fn the_file_the_command_line_and_the_fmu_refuse_the_same_values() {
        let text = builtin("set1").unwrap().text;
        let scene = parse("set1", text).unwrap();
        let mut in_file = 0;
        for variable in variables(&scene).iter().filter(|variable| variable.is_settable()) {
            for value in [-100.0, -1.0, 0.0, 1.0, 100.0, f64::NAN, f64::INFINITY] {
                let name = &variable.name;
                let mut changed = scene.clone();
                write_scene(&mut changed, variable, value).unwrap();
                let problems = changed.problems();
                let is_possible = problems.is_empty();
                assert_eq!(assign(&mut scene.clone(), name, value).is_ok(), is_possible, "{name}");
                // The model description has bounds that may be touched.
                assert!(check_value(variable, value).is_ok() || !is_possible, "{name} = {value}");
                if value < 0.0 || !value.is_finite() {
                    let declared =
                        matches!(variable.template.kind, Kind::Real { min: Some(_), .. });
                    let is_bad = declared || !value.is_finite();
                    assert_eq!(check_value(variable, value).is_err(), is_bad, "{name} = {value}");
                }
                let Some(key) = name.strip_prefix("module[1].") else { continue };
                let is_key = |line: &&str| line.split(" =").next() == Some(key);
                let Some(line) = text.lines().find(is_key) else { continue };
                let mine = text.replacen(line, &format!("{key} = {value:?}"), 1);
                assert_eq!(parse("mine", &mine).is_ok(), is_possible, "{key} = {value}");
                in_file += 1;
            }
        }
        assert_eq!(in_file, 9 * 7);
    }

    #[test]
    fn values_of_a_network_are_refused_by_the_rules_of_its_file() {
        let text = "[slider]\nvelocity = 0.1\nangle = 2.0\n[friction]\ncoefficient = 0.5\n\
            [integrator]\nstep = 1e-6\n[[mass]]\nname = \"a\"\nmass = 1.0\n[[spring]]\nname = \"k\"\n\
            between = [\"a\", \"ground\"]\ndirection = \"x\"\nstiffness = 1.0\n[[damper]]\n\
            name = \"d\"\nbetween = [\"a\", \"ground\"]\ndirection = \"y\"\ndamping = 1.0\n\
            [[contact]]\nname = \"c\"\nmass = \"a\"\nvelocity = 0.2\nfriction = 0.3\n";
        let mut scene = parse("mine", text).unwrap();
        let mut refused = Vec::new();
        for variable in variables(&scene).iter().filter(|variable| variable.is_settable()) {
            for value in [-1.0, 0.0, 1.0, f64::NAN] {
                let name = &variable.name;
                // Where a displacement leads is a matter of the contacts, not of one value.
                if name.starts_with("initial.") {
                    continue;
                }
                let mut changed = scene.clone();
                write_scene(&mut changed, variable, value).unwrap();
                assert_eq!(read_scene(&changed, variable).unwrap().to_bits(), value.to_bits());
                let problems = changed.problems();
                let assigned = assign(&mut scene.clone(), name, value);
                assert_eq!(assigned.is_ok(), problems.is_empty(), "{name} = {value}");
                if value == -1.0 && !problems.is_empty() {
                    assert_eq!(problems[0].path, *name);
                    refused.push(name.clone());
                }
            }
        }
        let refused: HashSet<&str> = refused.iter().map(String::as_str).collect();
        for name in ["mass.a.mass", "spring.k.stiffness", "damper.d.damping", "contact.c.friction"]
        {
            assert!(refused.contains(name), "{name}");
        }
        let error = assign(&mut scene, "mass.a.mas", 1.0).unwrap_err().to_string();
        assert!(error.contains("did you mean mass.a.mass?"), "{error}");
    }
}
