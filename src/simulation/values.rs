//! What each variable of the catalogue reads and writes.

use super::Simulation;
#[cfg(feature = "tools")]
use super::catalogue::variables;
use super::catalogue::{Kind, Quantity, Variable};
use crate::Error;
use crate::model::ring::MODULE_DOFS;
#[cfg(feature = "tools")]
use crate::scene::nearest;
use crate::scene::{Problem, Rule, Scene};

/// The value of a parameter or input in a scene; `None` for an output.
#[must_use]
pub fn read_scene(scene: &Scene, variable: &Variable) -> Option<f64> {
    let component = variable.template.component;
    let module = scene.modules.get(variable.index)?;
    Some(match variable.template.quantity {
        Quantity::SliderVelocity => scene.slider.velocity,
        Quantity::SliderAngle => scene.slider.angle,
        Quantity::FrictionCoefficient => scene.friction_coefficient,
        Quantity::DampingAlpha => scene.damping.alpha,
        Quantity::DampingBeta => scene.damping.beta,
        Quantity::IntegratorStep => scene.step,
        Quantity::Mass => module.mass[component],
        Quantity::Stiffness => module.stiffness[component],
        Quantity::Preload => module.preload,
        Quantity::ExternalForce => module.force[component],
        Quantity::InitialDisplacement => module.displacement[component],
        Quantity::InitialVelocity => module.velocity[component],
        Quantity::Displacement
        | Quantity::Velocity
        | Quantity::ContactState
        | Quantity::NormalForce
        | Quantity::FrictionForce
        | Quantity::SlipVelocity
        | Quantity::TangentialReaction
        | Quantity::NormalReaction
        | Quantity::StateChanges => return None,
    })
}

/// Writes a parameter or input into a scene; [`Scene::check`] says whether it is possible.
///
/// # Errors
/// The variable is an output.
pub fn write_scene(scene: &mut Scene, variable: &Variable, value: f64) -> Result<(), Error> {
    let component = variable.template.component;
    let module = &mut scene.modules[variable.index];
    *match variable.template.quantity {
        Quantity::SliderVelocity => &mut scene.slider.velocity,
        Quantity::SliderAngle => &mut scene.slider.angle,
        Quantity::FrictionCoefficient => &mut scene.friction_coefficient,
        Quantity::DampingAlpha => &mut scene.damping.alpha,
        Quantity::DampingBeta => &mut scene.damping.beta,
        Quantity::IntegratorStep => &mut scene.step,
        Quantity::Mass => &mut module.mass[component],
        Quantity::Stiffness => &mut module.stiffness[component],
        Quantity::Preload => &mut module.preload,
        Quantity::ExternalForce => &mut module.force[component],
        Quantity::InitialDisplacement => &mut module.displacement[component],
        Quantity::InitialVelocity => &mut module.velocity[component],
        Quantity::Displacement
        | Quantity::Velocity
        | Quantity::ContactState
        | Quantity::NormalForce
        | Quantity::FrictionForce
        | Quantity::SlipVelocity
        | Quantity::TangentialReaction
        | Quantity::NormalReaction
        | Quantity::StateChanges => {
            return Err(Error::variable(format!(
                "{} cannot be set: it is an output",
                variable.name
            )));
        }
    } = value;
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
        return match rule(variable).broken_by(value) {
            None => write_scene(scene, variable, value),
            Some(wish) => Err(Error::scene(impossible(variable, value, wish))),
        };
    }
    if let Some(output) = variables(scene).iter().find(|variable| variable.name == name) {
        return Err(Error::argument(format!("{} cannot be set: it is an output", output.name)));
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
        // One module stands for all.
        like.retain(|known| !known.contains('[') || known.contains("[1]"));
    }
    Err(Error::argument(format!(
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
        let dof = MODULE_DOFS * index + variable.template.component;
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
            Quantity::FrictionCoefficient | Quantity::DampingBeta
        );
        Ok(())
    }
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

/// What the scene asks of a parameter's or input's value.
fn rule(variable: &Variable) -> Rule {
    match variable.template.quantity {
        Quantity::Mass => Rule::MASS,
        Quantity::Stiffness => Rule::STIFFNESS,
        Quantity::FrictionCoefficient => Rule::FRICTION,
        Quantity::DampingAlpha | Quantity::DampingBeta => Rule::DAMPING,
        Quantity::IntegratorStep => Rule::TIME,
        Quantity::SliderAngle => Rule::ANGLE,
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
}
