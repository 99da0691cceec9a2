//! A value of a scene, by its variable's name.

use amontons::Error;
use amontons::scene::{MissingFeature, Problem, Scene, did_you_mean};
use amontons::simulation::catalogue::Quantity;
use amontons::simulation::{Variable, rule, variables, write_scene};
use std::collections::HashSet;

/// Gives a parameter or input of a scene, known by its name, another value.
///
/// # Errors
/// Returns an error if there is no such parameter or input (the nearest name is given, or those with like names), or
/// if it cannot have this value.
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
            Some(wish) => {
                Err(Error::scene(Problem::new(&*variable.name, wish).of(value).to_string()))
            }
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
