//! Effects of parameters on growth rates, frequencies and critical µ: in order, in words and as bars.

use super::{at_frequency, significant};
use amontons::decimal::to_significant;
use amontons_analysis::stability::{
    CriticalFriction, Merging, ModeSensitivity, Parameter, Sensitivities,
};
use amontons_pictures::picture::{Bar, BarGroup, Bars};
use std::cmp::Ordering;
use std::f64::consts::TAU;

/// A change of a parameter that tables and pictures show the consequences of.
pub const CHANGE: f64 = 0.01;
/// A change below this part of the largest one is rounding of zero.
const ROUNDING: f64 = 1e-11;
/// Changes that are equal to this number of digits have no order.
const SAME_DIGITS: usize = 8;
/// Number of modes of a picture.
const MOST_DRAWN: usize = 6;

/// A parameter with the effect of a change of it by one part in a hundred of its size or, if it is zero, by its unit.
pub struct Effect<'a> {
    /// The parameter.
    pub parameter: &'a Parameter,
    /// Changes of the growth rate, 1/s, and of the frequency, Hz, or of a critical µ; one for each copy.
    pub changes: Vec<[f64; 2]>,
}

impl<'a> Effect<'a> {
    /// The effect of a parameter with these derivatives by it.
    fn of(parameter: &'a Parameter, derivatives: impl Iterator<Item = [f64; 2]>) -> Self {
        // A parameter that is zero has no part in a hundred: its unit stands for it.
        let by = if parameter.value == 0.0 { 1.0 } else { CHANGE * parameter.value.abs() };
        Self { parameter, changes: derivatives.map(|it| it.map(|part| by * part)).collect() }
    }

    /// `true` if the change is one unit of the parameter.
    #[must_use]
    pub fn is_by_unit(&self) -> bool {
        self.parameter.value == 0.0
    }

    /// The largest change of each quantity.
    fn size(&self) -> [f64; 2] {
        let most =
            |part: usize| self.changes.iter().fold(0.0, |most, it| f64::max(most, it[part].abs()));
        [most(0), most(1)]
    }

    /// The change that is largest.
    #[must_use]
    pub fn largest(&self) -> [f64; 2] {
        let by_size = |a: &&[f64; 2], b: &&[f64; 2]| a[0].abs().total_cmp(&b[0].abs());
        self.changes.iter().max_by(by_size).copied().unwrap_or_default()
    }
}

/// The effects without those of rounding of a quantity of this size, the largest first and parameters that are zero last; those
/// that are equal but for rounding in the order of the parameters.
fn sorted(mut effects: Vec<Effect<'_>>, size: f64) -> Vec<Effect<'_>> {
    let changes = || effects.iter().flat_map(|effect| &effect.changes);
    let largest = changes().map(|change| change[0].abs().max(TAU * change[1].abs()));
    let floor = ROUNDING * largest.fold(size, f64::max);
    for change in effects.iter_mut().flat_map(|effect| &mut effect.changes) {
        for (part, unit) in change.iter_mut().zip([1.0, TAU]) {
            if unit * part.abs() <= floor {
                *part = 0.0;
            }
        }
    }
    let order = |effect: &Effect<'_>| {
        let [first, second] = effect.size().map(|size| to_significant(size, SAME_DIGITS));
        (!effect.is_by_unit(), first, second)
    };
    effects.sort_by(|a, b| order(b).partial_cmp(&order(a)).unwrap_or(Ordering::Equal));
    effects
}

/// The modes, the fastest growing first.
#[must_use]
pub fn by_growth(found: &Sensitivities) -> Vec<&ModeSensitivity> {
    let mut modes: Vec<&ModeSensitivity> = found.modes.iter().collect();
    let order = |a: &&ModeSensitivity, b: &&ModeSensitivity| -> Ordering {
        b.growth_rate().total_cmp(&a.growth_rate())
    };
    modes.sort_by(order);
    modes
}

/// The effects on a mode's growth rate and frequency; rounding is told by the size of the eigenvalue too.
#[must_use]
pub fn mode_effects<'a>(found: &'a Sensitivities, mode: &ModeSensitivity) -> Vec<Effect<'a>> {
    let derivatives = mode.derivatives.iter().flatten();
    let of = |(parameter, values): (_, &Vec<nalgebra::Complex<f64>>)| {
        let change = |value: &nalgebra::Complex<f64>| [value.re, value.im / TAU];
        Effect::of(parameter, values.iter().map(change))
    };
    let effects = found.parameters.iter().zip(derivatives).map(of).collect();
    sorted(effects, mode.eigenvalue.norm())
}

/// The effects on the µ of a merging.
#[must_use]
pub fn merging_effects<'a>(found: &'a Sensitivities, merging: &Merging) -> Vec<Effect<'a>> {
    let all = found.parameters.iter().zip(&merging.derivatives);
    let all = all.filter(|(_, values)| !values.is_empty());
    let of = |(parameter, values): (_, &Vec<f64>)| {
        Effect::of(parameter, values.iter().map(|value| [*value, 0.0]))
    };
    sorted(all.map(of).collect(), merging.friction)
}

/// The effects on a critical µ.
#[must_use]
pub fn critical_effects(critical: &CriticalFriction) -> Vec<Effect<'_>> {
    let all = critical.derivatives.iter().flatten();
    let all = all.map(|it| Effect::of(&it.0, it.1.iter().map(|value| [*value, 0.0])));
    sorted(all.collect(), critical.value)
}

/// The most effective parameters of modes and of each critical µ; `first` parameters of each.
#[must_use]
pub fn bars<'a>(
    title: String,
    found: &Sensitivities,
    modes: impl IntoIterator<Item = &'a ModeSensitivity>,
    critical: &[CriticalFriction],
    first: usize,
) -> Bars {
    let bars = |effects: &[Effect<'_>]| {
        // One unit of a parameter that is zero is no part of it.
        let shown = effects.iter().filter(|effect| !effect.is_by_unit()).take(first);
        let bar = |effect: &Effect<'_>| Bar {
            label: effect.parameter.name.clone(),
            value: effect.largest()[0],
        };
        shown.map(bar).collect::<Vec<Bar>>()
    };
    let modes = modes.into_iter().take(MOST_DRAWN).map(|mode| {
        let hz = mode.frequency_hz();
        match &mode.merging {
            Some(merging) => BarGroup {
                title: format!("Mode at {hz:.2} Hz, {}", place(merging)),
                axis: "Change of this µ for +1 % [–]".into(),
                bars: bars(&merging_effects(found, merging)),
            },
            None => BarGroup {
                title: format!(
                    "Mode at {hz:.2} Hz, growth rate {} 1/s",
                    significant(mode.growth_rate(), 4)
                ),
                axis: "Change of the growth rate for +1 % [1/s]".into(),
                bars: bars(&mode_effects(found, mode)),
            },
        }
    });
    let critical = critical.iter().map(|critical| BarGroup {
        title: format!(
            "Critical µ = {} {}",
            significant(critical.value, 6),
            at_frequency(critical.frequency_hz)
        ),
        axis: "Change of the critical µ for +1 % [–]".into(),
        bars: bars(&critical_effects(critical)),
    });
    let groups = modes.chain(critical).filter(|group| !group.bars.is_empty()).collect();
    Bars { title, groups }
}

/// The place of a merging, as "merges with another mode at µ = 1.2, at a distance of 1e-3".
#[must_use]
pub fn place(merging: &Merging) -> String {
    let (at, distance) = (significant(merging.friction, 9), significant(merging.distance, 3));
    let verb = match (merging.is_exact, merging.is_real) {
        (true, false) => "merges with another mode",
        (true, true) => "begins or ceases to oscillate",
        (false, _) => "comes nearest to another mode",
    };
    format!("{verb} at µ = {at}, at a distance of {distance}")
}

/// The reason for which a mode has no derivatives.
#[must_use]
pub fn without_derivatives(mode: &ModeSensitivity) -> &'static str {
    if mode.eigenvalue.norm() == 0.0 {
        "a free motion, which no spring holds: it has no derivatives"
    } else {
        "equal to another mode with the same shape: it has no derivatives"
    }
}

/// A parameter's value with its unit.
#[must_use]
pub fn value(Parameter { value, unit, .. }: &Parameter) -> String {
    if unit.is_empty() { format!("{value}") } else { format!("{value} {unit}") }
}

/// A number with its sign.
#[must_use]
pub fn signed(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let text = significant(value.abs(), 4);
    format!("{}{text}", if value < 0.0 { '-' } else { '+' })
}
