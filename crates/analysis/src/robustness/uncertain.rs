//! The parameters of a scene that scatter.

use super::distribution::{Distribution, Draws};
use super::sobol::DIMENSIONS;
use crate::assign::{rule_of, value_of};
use crate::instant::require_undriven;
use amontons::Error;
use amontons::scene::{Rule, Scene};
use amontons::simulation::catalogue::Kind;
use amontons::simulation::{Variable, variables, write_scene};
use serde::Serialize;
use std::f64::consts::FRAC_PI_2;

/// Values that people call small are told from here on.
const TOLD: f64 = 1e-9;

/// The word before a distribution with which all parameters of a name scatter together.
const TOGETHER: &str = "together ";

/// A name, in which `*` stands for any part, and a distribution: `module[*].k6=uniform(±10%)`.
#[derive(Clone, Debug, PartialEq)]
pub struct Uncertain {
    /// The name or pattern.
    pub name: String,
    /// The distribution of each parameter of this name.
    pub distribution: Distribution,
    /// `true` if all parameters of this name change by the same part of their values: `module[*].k6=together normal(±10%)`.
    pub is_together: bool,
}

impl Uncertain {
    /// Reads `NAME=DISTRIBUTION`.
    ///
    /// # Errors
    /// Returns the mistake, for the message of the command line.
    pub fn parse(text: &str) -> Result<Self, String> {
        let (name, distribution) = text.split_once('=').ok_or_else(|| {
            "write it as NAME=DISTRIBUTION, such as friction.coefficient=normal(0.4,0.05)"
                .to_owned()
        })?;
        let distribution = distribution.trim();
        let (is_together, distribution) = match distribution.strip_prefix(TOGETHER) {
            Some(distribution) => (true, distribution),
            None => (false, distribution),
        };
        let distribution = Distribution::parse(distribution)?;
        Ok(Self { name: name.trim().to_owned(), distribution, is_together })
    }

    /// The distribution as it is written.
    #[must_use]
    pub fn written(&self) -> String {
        format!("{}{}", if self.is_together { TOGETHER } else { "" }, self.distribution)
    }

    /// `true` if a parameter has the name, or one of the pattern.
    #[must_use]
    pub fn is_of(&self, parameter: &str) -> bool {
        matches(&self.name, parameter)
    }
}

/// A parameter of a scene that scatters, or several that scatter together.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// Its name, or the pattern of those that scatter together.
    name: String,
    /// Its variable, or those that scatter together: each with its value as a part of the parameter's.
    variables: Vec<(Variable, f64)>,
    /// The distribution as it is written.
    pub distribution: String,
    /// The value that the scene gives.
    pub nominal: f64,
    /// `true` if the distribution is a part of the scene's value.
    pub is_relative: bool,
    draws: Draws,
}

/// A parameter that scatters, as results have it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Described {
    /// Its name.
    pub name: String,
    /// Its distribution as it is written.
    pub distribution: String,
    /// The value that the scene gives.
    pub nominal: f64,
    /// The probability of impossible values, which were cut off.
    pub cut_off: f64,
}

impl Parameter {
    /// The name of the parameter.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its name, distribution and nominal value.
    #[must_use]
    pub fn described(&self) -> Described {
        Described {
            name: self.name().to_owned(),
            distribution: self.distribution.clone(),
            nominal: self.nominal,
            cut_off: self.draws.cut_off,
        }
    }

    /// The value at a probability above 0 and below 1.
    #[must_use]
    pub fn at(&self, probability: f64) -> f64 {
        self.draws.at(probability)
    }

    /// A sentence on values that were cut off; `None` if their probability is below 1e-9.
    #[must_use]
    pub fn note(&self) -> Option<String> {
        (self.draws.cut_off > TOLD).then(|| {
            format!(
                "{} of {} is cut off where values become impossible, with a probability of {:.2e}",
                self.distribution,
                self.name(),
                self.draws.cut_off
            )
        })
    }
}

/// The parameters of a scene that scatter, each name in the order in which it is given.
///
/// # Errors
/// Returns an error if the scene lacks a parameter, if one is given twice, if a signal drives one, if its distribution has
/// impossible values, or if there are more than 128.
pub fn parameters(scene: &Scene, uncertain: &[Uncertain]) -> Result<Vec<Parameter>, Error> {
    let known = settable(scene);
    let mut found: Vec<(Parameter, &str)> = Vec::new();
    for one in uncertain {
        let name = &*one.name;
        let variables = matching(scene, &known, name, "be uncertain")?;
        for variable in &variables {
            let own = &variable.name;
            let has = |before: &Parameter| before.variables.iter().any(|it| it.0.name == *own);
            if let Some((_, other)) = found.iter().find(|(before, _)| has(before)) {
                let both =
                    if *other == name { name.to_owned() } else { format!("{other} and {name}") };
                return Err(Error::argument(format!(
                    "{own} is given two distributions, by {both}; give it one --uncertain"
                )));
            }
        }
        let groups: Vec<Vec<(&Variable, f64)>> = if one.is_together {
            vec![valued(scene, &variables)?]
        } else {
            variables.iter().map(|it| valued(scene, &[it])).collect::<Result<_, Error>>()?
        };
        for group in groups {
            found.push((scattering(scene, one, &group)?, name));
        }
    }
    if found.len() > DIMENSIONS / 2 {
        return Err(Error::argument(format!(
            "{} parameters would scatter, but at most {} may; give names with fewer parts than *",
            found.len(),
            DIMENSIONS / 2
        )));
    }
    Ok(found.into_iter().map(|(parameter, _)| parameter).collect())
}

/// Variables with their values in the scene.
fn valued<'a>(
    scene: &Scene,
    variables: &[&'a Variable],
) -> Result<Vec<(&'a Variable, f64)>, Error> {
    variables.iter().map(|variable| Ok((*variable, value_of(scene, &variable.name)?))).collect()
}

/// The parameter of a variable, or of several that scatter together.
fn scattering(
    scene: &Scene,
    uncertain: &Uncertain,
    group: &[(&Variable, f64)],
) -> Result<Parameter, Error> {
    let Uncertain { name, distribution, is_together } = uncertain;
    // A part of zero is zero: another value stands for all.
    let (first, nominal) = *group.iter().find(|one| one.1 != 0.0).unwrap_or(&group[0]);
    let own = if *is_together { name } else { &first.name };
    let differs = group.iter().any(|one| one.1 != nominal);
    if differs && !distribution.is_relative() {
        return Err(Error::argument(format!(
            "the values of {name} differ, so that they scatter together by parts of themselves only; give a distribution such as \
             normal(±5%)"
        )));
    }
    let draws = distribution
        .draws(nominal, bounds(rule_of(scene, first)))
        .map_err(|why| Error::argument(format!("{distribution} of {own} {why}")))?;
    let part = |value: f64| if value == nominal { 1.0 } else { value / nominal };
    Ok(Parameter {
        name: own.clone(),
        variables: group.iter().map(|(it, value)| ((*it).clone(), part(*value))).collect(),
        distribution: uncertain.written(),
        nominal,
        is_relative: distribution.is_relative(),
        draws,
    })
}

/// All variables of a scene that have a value of their own.
pub(crate) fn settable(scene: &Scene) -> Vec<Variable> {
    variables(scene).into_iter().filter(Variable::is_settable).collect()
}

/// The variables of a name or pattern, among those that are `known`, whose values an analysis of eigenvalues may change. `verb` is
/// what is asked of them, for messages: `be uncertain`.
///
/// # Errors
/// Returns an error if there is none, or if eigenvalues do not depend on one, a signal drives one, or one is a switch.
pub(crate) fn matching<'a>(
    scene: &Scene,
    known: &'a [Variable],
    name: &str,
    verb: &str,
) -> Result<Vec<&'a Variable>, Error> {
    check_kind(name, verb)?;
    let matching: Vec<&Variable> =
        known.iter().filter(|variable| matches(name, &variable.name)).collect();
    if matching.is_empty() {
        return Err(missing(scene, name, verb));
    }
    for variable in &matching {
        let own = &variable.name;
        require_undriven(scene, own)?;
        if !matches!(variable.template.kind, Kind::Real { .. }) {
            return Err(Error::argument(format!(
                "{own} cannot {verb}: it is a switch, not a number"
            )));
        }
    }
    Ok(matching)
}

/// The scene with these values of variables.
///
/// # Errors
/// Returns an error if a value is impossible, or if values are impossible together.
pub(super) fn written<'a>(
    scene: &Scene,
    values: impl Iterator<Item = (&'a Variable, f64)>,
) -> Result<Scene, Error> {
    let mut scene = scene.clone();
    for (variable, value) in values {
        write_scene(&mut scene, variable, value)?;
    }
    scene.check()?;
    Ok(scene)
}

/// Values in words: `friction.coefficient = 0.4, module[1].k6 = 1e5`.
pub(super) fn listed<'a>(values: impl Iterator<Item = (&'a str, f64)>) -> String {
    let all: Vec<String> = values.map(|(name, value)| format!("{name} = {value:?}")).collect();
    all.join(", ")
}

/// The scene with these values of its parameters.
///
/// # Errors
/// Returns an error if values are impossible together; it has the values.
pub fn scene_with(scene: &Scene, parameters: &[Parameter], values: &[f64]) -> Result<Scene, Error> {
    let pairs = parameters.iter().zip(values).flat_map(|(parameter, value)| {
        parameter.variables.iter().map(move |(variable, part)| (variable, part * value))
    });
    written(scene, pairs).map_err(|error| {
        Error::scene(format!(
            "a draw is impossible: {error}; the draw has {}. Give distributions whose values are possible together",
            drawn(parameters, values)
        ))
    })
}

/// The values of a draw in words.
pub(super) fn drawn(parameters: &[Parameter], values: &[f64]) -> String {
    listed(parameters.iter().map(Parameter::name).zip(values.iter().copied()))
}

/// Refuses names of values that eigenvalues do not depend on.
fn check_kind(name: &str, verb: &str) -> Result<(), Error> {
    let kind = [("initial.", "initial values"), ("signal[", "signals")];
    match kind.into_iter().find(|(start, _)| name.starts_with(start)) {
        Some((_, kind)) => Err(Error::argument(format!(
            "{name} cannot {verb}: eigenvalues do not depend on {kind}; give parameters of the scene"
        ))),
        None => Ok(()),
    }
}

/// The error that no parameter has a name or pattern.
fn missing(scene: &Scene, name: &str, verb: &str) -> Error {
    // One part stands for all.
    match (value_of(scene, &name.replace('*', "1")), name.contains('*')) {
        (Err(error), false) => error,
        (Err(error), true) => Error::argument(format!(
            "no parameter or input of {} matches {name}: {error}",
            scene.name
        )),
        (Ok(_), _) => Error::argument(format!(
            "{name} cannot {verb}: eigenvalues do not depend on it; give parameters of the scene"
        )),
    }
}

/// `true` if a name is that of a pattern, in which `*` stands for any text without a point.
pub(crate) fn matches(pattern: &str, name: &str) -> bool {
    match pattern.split_once('*') {
        None => pattern == name,
        Some((before, after)) => name.strip_prefix(before).is_some_and(|rest| {
            let ends = rest.char_indices().map(|(place, _)| place).chain([rest.len()]);
            ends.take_while(|end| !rest[..*end].contains('.'))
                .any(|end| matches(after, &rest[end..]))
        }),
    }
}

/// The bounds of a rule; a bound that is not possible itself has no probability.
fn bounds(rule: Rule) -> [f64; 2] {
    match rule {
        Rule::Finite => [f64::NEG_INFINITY, f64::INFINITY],
        Rule::NotNegative | Rule::Positive | Rule::NotInsideSlider => [0.0, f64::INFINITY],
        Rule::QuarterTurn => [-FRAC_PI_2, FRAC_PI_2],
        Rule::Fraction => [0.0, 1.0],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use amontons::scene::{builtin, parse};

    fn of(scene: &Scene, given: &[&str]) -> Result<Vec<Parameter>, Error> {
        let given: Vec<_> = given.iter().map(|text| Uncertain::parse(text).unwrap()).collect();
        parameters(scene, &given)
    }

    #[test]
    fn a_star_stands_for_all_parts_each_with_a_draw_of_its_own() {
        let scene = builtin("set1").unwrap().scene();
        let found =
            of(&scene, &["friction.coefficient=normal(1.5,0.1)", "module[*].k6=uniform(±10%)"]);
        let found = found.unwrap();
        let names: Vec<&str> = found.iter().map(Parameter::name).collect();
        assert_eq!(names, ["friction.coefficient", "module[1].k6", "module[2].k6"]);
        let drawn = scene_with(&scene, &found, &[0.5, 1e5, 2e5]).unwrap();
        assert_eq!(drawn.friction_coefficient, 0.5);
        assert_eq!(value_of(&drawn, "module[1].k6"), Ok(1e5));
        assert_eq!(value_of(&drawn, "module[2].k6"), Ok(2e5));
        assert!(matches("spring.*.stiffness", "spring.k1.stiffness"));
        assert!(!matches("spring.*", "spring.k1.stiffness") && !matches("k*", "ak"));
        let springs = Uncertain::parse("module[*].k6=uniform(±10%)").unwrap();
        assert!(springs.is_of("module[2].k6") && !springs.is_of("module[2].k5"));
    }

    #[test]
    fn values_that_scatter_together_change_by_one_part_of_themselves() {
        let mut scene = builtin("set1").unwrap().scene();
        scene.modules_mut()[1].stiffness[5] = 0.25 * scene.modules()[0].stiffness[5];
        let own = scene.modules()[0].stiffness[5];
        let found = of(&scene, &["module[*].k6=together normal(±10%)"]).unwrap();
        assert_eq!((found.len(), found[0].name(), found[0].nominal), (1, "module[*].k6", own));
        assert_eq!(found[0].distribution, "together normal(±10%)");
        let drawn = scene_with(&scene, &found, &[2.0 * own]).unwrap();
        assert_eq!(value_of(&drawn, "module[1].k6"), Ok(2.0 * own));
        assert_eq!(value_of(&drawn, "module[2].k6"), Ok(0.5 * own));
        // A spring of zero stays one.
        scene.modules_mut()[0].stiffness[5] = 0.0;
        let found = of(&scene, &["module[*].k6=together normal(±10%)"]).unwrap();
        let drawn = scene_with(&scene, &found, &[own]).unwrap();
        assert_eq!(value_of(&drawn, "module[1].k6"), Ok(0.0));
        assert_eq!(value_of(&drawn, "module[2].k6"), Ok(own));
        let error = of(&scene, &["module[*].k6=together uniform(1,2)"]).unwrap_err().to_string();
        assert!(error.contains("the values of module[*].k6 differ"), "{error}");
    }

    #[test]
    fn what_cannot_scatter_is_refused_with_the_reason() {
        let scene = builtin("set1").unwrap().scene();
        for (given, words) in [
            (&["friction.coeficient=uniform(0,1)"][..], "did you mean friction.coefficient?"),
            (&["module[*].k9=uniform(0,1)"], "no parameter or input of set1 matches module[*].k9"),
            (&["module[1].x1=uniform(0,1)"], "module[1].x1 cannot be set: it is an output"),
            (&["initial.module[1].v1=uniform(0,1)"], "do not depend on initial values"),
            (&["signal[1].amplitude=uniform(0,1)"], "do not depend on signals"),
            (
                &["module[*].k6=uniform(±1%)", "module[2].k6=normal(±1%)"],
                "module[2].k6 is given two distributions, by module[*].k6 and module[2].k6",
            ),
            (
                &["module[1].m1=uniform(-1,1)"],
                "uniform(-1,1) of module[1].m1 reaches -1, which is impossible: values are not below 0",
            ),
            (&["slider.angle=uniform(0,2)"], "uniform(0,2) of slider.angle reaches 2"),
        ] {
            let error = of(&scene, given).unwrap_err();
            assert!(error.is_argument() && error.to_string().contains(words), "{error}");
        }
        let note = of(&scene, &["module[1].k6=normal(4,1)"]).unwrap()[0].note().unwrap();
        assert!(
            note.starts_with("normal(4,1) of module[1].k6 is cut off") && note.ends_with("3.17e-5")
        );
        let mut long = scene;
        let module = long.modules()[0];
        long.modules_mut().resize(129, module);
        let error = of(&long, &["module[*].k6=uniform(±1%)"]).unwrap_err().to_string();
        assert!(error.starts_with("129 parameters would scatter, but at most 128 may"), "{error}");
    }

    #[test]
    fn a_parameter_that_a_signal_drives_does_not_scatter() {
        let text = builtin("belt").unwrap().text;
        let signal = "[[signal]]\ninput = \"friction.coefficient\"\nconstant = { value = 0.1 }\n";
        let scene = parse("mine", &format!("{text}{signal}")).unwrap();
        let error = of(&scene, &["friction.coefficient=uniform(0,1)"]).unwrap_err().to_string();
        assert!(error.contains("signal[1] of mine drives friction.coefficient"), "{error}");
    }

    #[test]
    fn values_that_are_impossible_together_are_told_with_the_draw() {
        let mut scene = builtin("set1").unwrap().scene();
        scene.static_friction = Some(2.0);
        let found = of(&scene, &["friction.coefficient=uniform(1,3)"]).unwrap();
        assert!(scene_with(&scene, &found, &[1.5]).is_ok());
        let error = scene_with(&scene, &found, &[2.5]).unwrap_err().to_string();
        assert!(error.starts_with("a draw is impossible: friction.static = 2"), "{error}");
        assert!(error.contains("the draw has friction.coefficient = 2.5"), "{error}");
    }
}
