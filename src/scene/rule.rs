//! Rules for the numbers of a scene, shared by the reader, the schema and the FMU's variables.

use std::f64::consts::FRAC_PI_2;

/// Rule for a value. Every rule requires a finite number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// Any finite number.
    Finite,
    /// A number ≥ 0.
    NotNegative,
    /// A number > 0.
    Positive,
    /// A displacement along the outward normal of the slider, ≥ 0.
    NotInsideSlider,
    /// An angle from −π/2 to π/2 rad.
    QuarterTurn,
    /// A number > 0 and < 1.
    Fraction,
}

impl Rule {
    /// Rule for a mass, kg.
    pub const MASS: Self = Self::Positive;
    /// Rule for a stiffness, N/m.
    pub const STIFFNESS: Self = Self::NotNegative;
    /// Rule for a friction coefficient.
    pub const FRICTION: Self = Self::NotNegative;
    /// Rule for the slip velocity over which friction falls, m/s.
    pub const STRIBECK_VELOCITY: Self = Self::Positive;
    /// Rule for the damping coefficients α, 1/s, and β, s, and for a damper, N s/m.
    pub const DAMPING: Self = Self::NotNegative;
    /// Rule for a frequency, Hz.
    pub const FREQUENCY: Self = Self::NotNegative;
    /// Rule for a time or a time step, s.
    pub const TIME: Self = Self::Positive;
    /// Rule for a tolerance: a relative error.
    pub const TOLERANCE: Self = Self::Fraction;
    /// Rule for the slider's inclination under a ring, rad.
    pub const INCLINATION: Self = Self::QuarterTurn;
    /// Rule for the initial displacement of a mass on the slider along its normal, m.
    pub const GAP: Self = Self::NotInsideSlider;
    /// Rule for the gap of a contact in the unloaded position, m.
    pub const OPENING: Self = Self::NotNegative;

    /// Returns the requirement, in words, if `value` breaks the rule.
    #[must_use]
    pub fn broken_by(self, value: f64) -> Option<&'static str> {
        if !value.is_finite() {
            return Some("must be a finite number");
        }
        let kept = match self {
            Self::Finite => true,
            Self::NotNegative | Self::NotInsideSlider => value >= 0.0,
            Self::Positive => value > 0.0,
            Self::QuarterTurn => value.abs() <= FRAC_PI_2,
            Self::Fraction => value > 0.0 && value < 1.0,
        };
        if kept { None } else { Some(self.wish()) }
    }

    fn wish(self) -> &'static str {
        match self {
            Self::Finite => "must be a finite number",
            Self::NotNegative => "must not be negative",
            Self::Positive => "must be above zero",
            Self::NotInsideSlider => {
                "starts inside the slider; a displacement along the normal must be ≥ 0"
            }
            Self::QuarterTurn => "must be between −π/2 and π/2 rad (30° are 0.5236)",
            Self::Fraction => "must be above 0 and below 1",
        }
    }
}

/// Transform that writes a rule into the schema of a number, or of a value that holds numbers: as bounds that every
/// tool understands, and in words.
#[cfg(feature = "schema")]
pub(super) struct Bounds(Rule);

#[cfg(feature = "schema")]
impl Rule {
    /// Returns the transform for a field's attribute, `schemars(transform = Rule::MASS.bounds())`.
    pub(super) fn bounds(self) -> Bounds {
        Bounds(self)
    }
}

#[cfg(feature = "schema")]
impl schemars::transform::Transform for Bounds {
    fn transform(&mut self, schema: &mut schemars::Schema) {
        // The type of an optional value is number or null.
        let is_number = |kind: &serde_json::Value| {
            kind == "number"
                || kind.as_array().is_some_and(|kinds| kinds.contains(&"number".into()))
        };
        if schema.get("type").is_some_and(is_number) {
            let bounds: &[(&str, f64)] = match self.0 {
                Rule::Finite => return,
                Rule::NotNegative | Rule::NotInsideSlider => &[("minimum", 0.0)],
                Rule::Positive => &[("exclusiveMinimum", 0.0)],
                Rule::QuarterTurn => &[("minimum", -FRAC_PI_2), ("maximum", FRAC_PI_2)],
                Rule::Fraction => &[("exclusiveMinimum", 0.0), ("exclusiveMaximum", 1.0)],
            };
            for (keyword, bound) in bounds {
                schema.insert((*keyword).to_owned(), (*bound).into());
            }
            schema.insert("errorMessage".to_owned(), self.0.wish().into());
        }
        schemars::transform::transform_subschemas(self, schema);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_rule_holds_to_its_very_edge() {
        let least = f64::from_bits(1);
        for (rule, good, bad) in [
            (Rule::NotNegative, [0.0, -0.0, f64::MAX], [-least, -1.0, f64::NAN]),
            (Rule::Positive, [least, 1.0, f64::MAX], [0.0, -0.0, f64::INFINITY]),
            (Rule::NotInsideSlider, [0.0, -0.0, 1.0], [-least, -1.0, f64::NAN]),
            (Rule::Fraction, [least, 0.5, 1.0 - f64::EPSILON], [0.0, 1.0, f64::NAN]),
            (Rule::QuarterTurn, [FRAC_PI_2, -FRAC_PI_2, 0.0], [1.58, -1.58, f64::NAN]),
            (Rule::Finite, [0.0, -1.0, f64::MAX], [f64::NAN, f64::INFINITY, f64::NEG_INFINITY]),
        ] {
            assert!(good.iter().all(|&value| rule.broken_by(value).is_none()), "{rule:?}");
            assert!(bad.iter().all(|&value| rule.broken_by(value).is_some()), "{rule:?}");
        }
    }
}
