//! Values of a parameter that a scene can have with its other values.

use crate::assign::assign;
use amontons::Error;
use amontons::scene::Scene;

/// The values of a range that are possible, and those that are skipped.
#[derive(Clone, Debug, PartialEq)]
pub struct Possible {
    /// The values to look at, ascending as they were given.
    pub values: Vec<f64>,
    /// Values with which some contact's static friction would be below its kinetic one, and why that is impossible.
    pub skipped: Vec<(f64, String)>,
}

impl Possible {
    /// Splits a range of a parameter or input: values at which some contact's static friction would be below its kinetic
    /// one are skipped, for the coefficients that a range does not vary stay as they are.
    ///
    /// # Errors
    /// Returns an error if there is no such parameter or input, if it cannot have one of the values whatever the
    /// others are, or if all values would be skipped.
    pub fn of(scene: &Scene, name: &str, values: &[f64]) -> Result<Self, Error> {
        let mut possible = Self { values: Vec::new(), skipped: Vec::new() };
        let mut first = None;
        for &value in values {
            let mut scene = scene.clone();
            assign(&mut scene, name, value)?;
            match scene.check() {
                Err(error) if scene.has_static_below_kinetic_friction() => {
                    possible.skipped.push((value, error.to_string()));
                    first.get_or_insert(error);
                }
                _ => possible.values.push(value),
            }
        }
        match first {
            Some(error) if possible.values.is_empty() => Err(error),
            _ => Ok(possible),
        }
    }

    /// A line for people on the values that are skipped; none where all are possible.
    #[must_use]
    pub fn note(&self, name: &str) -> Option<String> {
        let ((first, why), (last, _)) = (self.skipped.first()?, self.skipped.last()?);
        Some(match self.skipped.len() {
            1 => format!("{name} = {first} is skipped: {why}"),
            count => format!(
                "{count} values of {name} from {first} to {last} are skipped; the reason for the first: {why}"
            ),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use amontons::scene::builtin;

    #[test]
    fn only_values_with_static_friction_below_kinetic_are_skipped() {
        let mut scene = builtin("set1").unwrap().scene();
        let values = [0.2, 0.4, 0.5, 0.6];
        let all = Possible::of(&scene, "friction.coefficient", &values).unwrap();
        assert_eq!((&*all.values, all.note("µ")), (&values[..], None));

        scene.static_friction = Some(0.4);
        let some = Possible::of(&scene, "friction.coefficient", &values).unwrap();
        assert_eq!(some.values, [0.2, 0.4]);
        let note = some.note("friction.coefficient").unwrap();
        assert!(note.starts_with("2 values of friction.coefficient from 0.5 to 0.6 are"), "{note}");
        assert!(note.contains("friction.static = 0.4"), "{note}");
        let one = Possible::of(&scene, "friction.coefficient", &values[..3]).unwrap();
        assert!(one.note("µ").unwrap().starts_with("µ = 0.5 is skipped: friction.static = 0.4"));

        scene.friction_coefficient = 0.3;
        let static_ = Possible::of(&scene, "friction.static", &[0.1, 0.3, 0.5]).unwrap();
        assert_eq!(static_.values, [0.3, 0.5]);
        assert!(Possible::of(&scene, "friction.coefficient", &values[2..]).is_err());
        // No other value is skipped: of these each command says what it says.
        assert!(Possible::of(&scene, "friction.coefficient", &[-1.0, 0.2]).is_err());
        assert!(Possible::of(&scene, "module[1].m1", &[0.0, 1.0]).is_err());
    }
}
