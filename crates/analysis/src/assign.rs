//! A value of a scene, by its variable's name.

use amontons::Error;
use amontons::scene::{MissingFeature, Problem, Rule, Scene, Shape, Signal, did_you_mean};
use amontons::simulation::catalogue::Quantity;
use amontons::simulation::{Parameters, Variable, rule, variables, write_scene};
use std::collections::HashSet;

/// The name of the common friction coefficient.
pub const FRICTION: &str = "friction.coefficient";

/// The value that a scene gives to a parameter, an input, or a value of a signal ([`assign`]).
///
/// # Errors
/// Returns the error of [`assign`] if there is none of that name.
pub fn value_of(scene: &Scene, name: &str) -> Result<f64, Error> {
    let parameters = Parameters::of(scene.clone());
    if let Some((_, value)) = parameters.iter().find(|(variable, _)| variable.name == name) {
        return Ok(value);
    }
    if let Some(value) = signal_value(&mut scene.signals.to_vec(), name) {
        return Ok(*value);
    }
    assign(&mut scene.clone(), name, 0.0).map(|()| 0.0)
}

/// The place of `signal[N].amplitude`, `.frequency` or `.phase` of a sine, or `signal[N].value` of a constant signal or a
/// pulse, with signals counted from 1 in the order of the file.
fn signal_value<'a>(signals: &'a mut [Signal], name: &str) -> Option<&'a mut f64> {
    let (number, key) = name.strip_prefix("signal[")?.split_once("].")?;
    let place: usize = number.parse::<usize>().ok()?.checked_sub(1)?;
    match (&mut signals.get_mut(place)?.shape, key) {
        (Shape::Sine(sine), "amplitude") => Some(&mut sine.amplitude),
        (Shape::Sine(sine), "frequency") => Some(&mut sine.frequency),
        (Shape::Sine(sine), "phase") => Some(&mut sine.phase),
        (Shape::Constant(constant), "value") => Some(&mut constant.value),
        (Shape::Pulse(pulse), "value") => Some(&mut pulse.value),
        _ => None,
    }
}

/// Gives a parameter or input of a scene, known by its name, another value; or a value of one of its signals, such as
/// `signal[1].frequency`, which no FMU has as a variable.
///
/// # Errors
/// Returns an error if there is no such parameter or input (the nearest name is given, or those with like names), or
/// if it cannot have this value.
pub fn assign(scene: &mut Scene, name: &str, value: f64) -> Result<(), Error> {
    let settable: Vec<Variable> =
        variables(scene).into_iter().filter(Variable::is_settable).collect();
    if let Some(variable) = settable.iter().find(|variable| variable.name == name) {
        return match rule_of(scene, variable).broken_by(value) {
            None => write_scene(scene, variable, value),
            Some(wish) => {
                Err(Error::scene(Problem::new(&*variable.name, wish).of(value).to_string()))
            }
        };
    }
    let mut signals = scene.signals.to_vec();
    if let Some(place) = signal_value(&mut signals, name) {
        *place = value;
        scene.signals = signals.into();
        return scene.check();
    }
    if name.starts_with("signal[") {
        return Err(Error::argument(format!(
            "{} has no {name}: a sine has signal[N].amplitude, .frequency and .phase, a constant or a pulse has \
             signal[N].value, with N from 1 in the order of the file; other signals have no such values, and analyses at \
             one instant leave all signals out",
            scene.name
        )));
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
    if let Some(MissingFeature { reason, help }) = scene.explain_missing(name) {
        return Err(Error::argument(format!("{name} cannot be set: {reason}; {help}")));
    }
    if let Some(help) = did_you_mean(name, settable.iter().map(|variable| &*variable.name)) {
        return Err(Error::argument(format!("there is no parameter or input {name}; {help}")));
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

/// The rule that values of a parameter or input of a scene keep, whatever its other values are.
#[must_use]
pub fn rule_of(scene: &Scene, variable: &Variable) -> Rule {
    match variable.template.quantity {
        Quantity::SliderAngle => scene.inclination_rule(),
        _ => rule(variable),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use amontons::scene::{builtin, parse};
    use amontons::simulation::catalogue::Kind;
    use amontons::simulation::{Parameters, check_value};

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
    fn a_signal_has_values_that_can_be_set_and_others_that_are_named() {
        let mut scene = builtin("den_hartog").unwrap().scene();
        assert_eq!(value_of(&scene, "signal[1].frequency"), Ok(2.5));
        assign(&mut scene, "signal[1].frequency", 3.0).unwrap();
        assert_eq!(value_of(&scene, "signal[1].frequency"), Ok(3.0));
        let error = assign(&mut scene.clone(), "signal[1].frequency", -1.0).unwrap_err();
        assert!(error.to_string().contains("signal[1].sine.frequency"), "{error}");
        for name in ["signal[2].frequency", "signal[0].phase", "signal[1].value"] {
            let error = assign(&mut scene, name, 1.0).unwrap_err().to_string();
            assert!(error.contains("signal[N].amplitude"), "{name}: {error}");
        }
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
                // The consequence of an initial displacement depends on all contacts, not on one value.
                if name.starts_with("initial.") {
                    continue;
                }
                let mut changed = scene.clone();
                write_scene(&mut changed, variable, value).unwrap();
                let found = Parameters::of(changed.clone()).get(variable).unwrap();
                assert_eq!(found.to_bits(), value.to_bits());
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
