//! The values of a scene that may change, and how far.
//!
//! A change x is relative: the value v becomes v + x |v|. Where the scene's value is 0, x is a part of the largest value that
//! is allowed.

use crate::assign::{FRICTION, rule_of, value_of};
use crate::robustness::{matches, matching, settable};
use crate::sweep::range::{ends, number};
use amontons::Error;
use amontons::decimal::to_significant;
use amontons::error::Short;
use amontons::scene::{Problem, Scene};
use amontons::simulation::catalogue::Quantity;
use amontons::simulation::{Variable, write_scene};
use serde::Serialize;
use std::fmt;

/// The notation of a range.
const WISH: &str = "write it as NAME=±20%, NAME=-10%:30% or NAME=A:B";

/// A name, in which `*` stands for any part, and the range of its values: `module[*].k6=±20%`.
#[derive(Clone, Debug, PartialEq)]
pub struct Vary {
    /// The name or pattern.
    pub name: String,
    /// The range of values.
    pub range: Range,
}

/// A range of values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// From one relative change to another: 0.2 is 20 % more than the scene's value.
    Relative([f64; 2]),
    /// From one value to another.
    Values([f64; 2]),
}

impl Vary {
    /// Reads `NAME=±20%`, `NAME=-10%:30%` or `NAME=A:B`.
    ///
    /// # Errors
    /// Returns the mistake, for the message of the command line.
    pub fn parse(text: &str) -> Result<Self, String> {
        let (name, range) = text.split_once('=').ok_or_else(|| WISH.to_owned())?;
        let range = range.trim();
        let percent = |text: &str| -> Result<f64, String> {
            Ok(number(text.trim().strip_suffix('%').ok_or(WISH)?)? / 100.0)
        };
        let range = match range.split_once(':') {
            Some((low, high)) if low.trim().ends_with('%') => {
                Range::Relative([percent(low)?, percent(high)?])
            }
            Some(_) => Range::Values(ends(range)?),
            None => {
                let part = range.strip_prefix('±').or_else(|| range.strip_prefix("+-"));
                let part = percent(part.unwrap_or(range))?;
                Range::Relative([-part, part])
            }
        };
        if let Range::Relative([low, high]) = range
            && !(low <= 0.0 && high >= 0.0 && low < high)
        {
            return Err(format!(
                "{text} is no range around the scene's own value: give one from less to more, such as -10%:30%"
            ));
        }
        Ok(Self { name: name.trim().to_owned(), range })
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let part = |part: f64| Short(to_significant(100.0 * part, 12));
        match self {
            Self::Relative([low, high]) if *low == -*high => write!(f, "±{}%", part(*high)),
            Self::Relative([low, high]) => write!(f, "{}%:{}%", part(*low), part(*high)),
            Self::Values([low, high]) => write!(f, "{}:{}", Short(*low), Short(*high)),
        }
    }
}

/// A value that may change, or several that change together by the same part.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Varied {
    /// Its name, or the pattern of the values that change together.
    pub name: String,
    /// The least and the largest relative change.
    pub bounds: [f64; 2],
    /// The factor by which the change counts.
    pub cost: f64,
    /// The values.
    pub parts: Vec<Part>,
}

/// A value of the scene that changes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Part {
    /// Its name.
    pub name: String,
    /// Its unit; empty for a number without one.
    pub unit: &'static str,
    /// The value that the scene gives.
    pub nominal: f64,
    /// The size of a change of 1.
    pub scale: f64,
    /// The least and the largest value.
    pub values: [f64; 2],
    #[serde(skip)]
    variable: Variable,
}

impl Part {
    /// The value after a relative change, to twelve digits; without one it is the scene's own to the last bit.
    #[must_use]
    pub fn at(&self, change: f64) -> f64 {
        let [low, high] = self.values;
        match change {
            0.0 => self.nominal,
            _ => to_significant(self.nominal + self.scale * change, 12).clamp(low, high),
        }
    }

    /// `true` if the value takes energy out of a motion.
    pub(super) fn damps(&self) -> bool {
        let quantity = self.variable.template.quantity;
        matches!(quantity, Quantity::DampingAlpha | Quantity::DampingBeta | Quantity::DamperDamping)
    }
}

impl Varied {
    /// The factor of the square of the change in the square of the size of all changes: each value counts.
    #[allow(clippy::cast_precision_loss)]
    pub(super) fn weight(&self) -> f64 {
        self.cost * self.cost * self.parts.len() as f64
    }
}

/// The values of a scene that may change, each by itself, or with `together` those of a pattern by one part. `costs` are the
/// factors of names and patterns, 1 for those that are not named.
///
/// # Errors
/// Returns an error if nothing may change, if the scene lacks a value, if one is named twice, if it cannot change, or if its
/// range has impossible values or lacks the scene's own.
pub fn varied(
    scene: &Scene,
    given: &[Vary],
    together: bool,
    costs: &[(String, f64)],
) -> Result<Vec<Varied>, Error> {
    if given.is_empty() {
        return Err(Error::argument(
            "nothing may change: give --vary NAME=RANGE, such as --vary 'module[*].k6=±20%' or --vary damping.beta=0:1e-4",
        ));
    }
    let known = settable(scene);
    let mut found: Vec<Varied> = Vec::new();
    for Vary { name, range } in given {
        let mut one = Varied {
            name: name.clone(),
            bounds: [f64::NEG_INFINITY, f64::INFINITY],
            cost: 1.0,
            parts: Vec::new(),
        };
        for variable in matching(scene, &known, name, "vary")? {
            if variable.name == FRICTION {
                return Err(Error::argument(format!(
                    "{FRICTION} cannot be varied: a design is one for all values of --friction"
                )));
            }
            let known = found.iter().chain([&one]).flat_map(|one| &one.parts);
            if known.into_iter().any(|part| part.name == variable.name) {
                return Err(Error::argument(format!(
                    "{} is varied twice; give it one --vary",
                    variable.name
                )));
            }
            let (part, [low, high]) = part(scene, variable.clone(), *range)?;
            if together {
                one.bounds = [one.bounds[0].max(low), one.bounds[1].min(high)];
                one.parts.push(part);
            } else {
                let name = part.name.clone();
                found.push(Varied { name, bounds: [low, high], cost: 1.0, parts: vec![part] });
            }
        }
        if !one.parts.is_empty() {
            found.push(one);
        }
    }
    if let Some(one) = found.iter().find(|one| one.bounds[0] >= one.bounds[1]) {
        return Err(Error::argument(format!(
            "the values of {} have no common change within the range; leave out --together, or give a percentage",
            one.name
        )));
    }
    for (name, cost) in costs {
        if !(1e-3..=1e3).contains(cost) {
            return Err(Error::argument(format!(
                "the cost {cost} of {name} is not possible: give a factor from 0.001 to 1000, such as 10 for a change that \
                 is ten times as hard to make"
            )));
        }
        let matching = found.iter_mut().filter(|one| {
            one.name == *name || one.parts.iter().all(|part| matches(name, &part.name))
        });
        let count = matching.map(|one| one.cost = *cost).count();
        if count == 0 {
            return Err(Error::argument(format!(
                "{name} of --cost is not varied; --vary has {}",
                found.iter().map(|one| &*one.name).collect::<Vec<_>>().join(", ")
            )));
        }
    }
    Ok(found)
}

/// A value that changes, and the bounds of its relative change.
fn part(scene: &Scene, variable: Variable, range: Range) -> Result<(Part, [f64; 2]), Error> {
    let nominal = value_of(scene, &variable.name)?;
    let refused = |why: String| Err(Error::argument(format!("{range} of {} {why}", variable.name)));
    let (scale, values) = match range {
        Range::Values([low, high]) => {
            let scale = if nominal == 0.0 { low.abs().max(high.abs()) } else { nominal.abs() };
            if !(low..=high).contains(&nominal) {
                return refused(format!(
                    "does not contain the scene's own value, {}: the search starts there, and changes are counted from it",
                    Short(nominal)
                ));
            }
            (scale, [low, high])
        }
        Range::Relative(_) if nominal == 0.0 => {
            return refused(
                "is a part of 0, the scene's value; give values, such as 0:1e-4".to_owned(),
            );
        }
        Range::Relative([low, high]) => {
            let scale = nominal.abs();
            (scale, [nominal + scale * low, nominal + scale * high])
        }
    };
    for value in values {
        if let Some(wish) = rule_of(scene, &variable).broken_by(value) {
            let problem = Problem::new(&*variable.name, wish).of(value);
            return refused(format!("reaches {}, which is impossible: {problem}", Short(value)));
        }
    }
    let part = Part {
        name: variable.name.clone(),
        unit: variable.unit(),
        nominal,
        scale,
        values,
        variable,
    };
    Ok((part, values.map(|value| (value - nominal) / scale)))
}

/// The scene after these relative changes.
///
/// # Errors
/// Returns an error if values are impossible together.
pub fn scene_at(scene: &Scene, varied: &[Varied], changes: &[f64]) -> Result<Scene, Error> {
    let mut scene = scene.clone();
    for (one, change) in varied.iter().zip(changes) {
        for part in &one.parts {
            write_scene(&mut scene, &part.variable, part.at(*change))?;
        }
    }
    scene.check()?;
    Ok(scene)
}
