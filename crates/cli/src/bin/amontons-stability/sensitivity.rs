//! `amontons-stability sensitivity`.

use crate::arguments::Sensitivity;
use crate::labels::{LOCATED, at_frequency, significant};
use crate::{AnalysedScene, Failure, configured, friction, state};
use amontons::Error;
use amontons::decimal::to_significant;
use amontons_analysis::instant::require_undriven;
use amontons_analysis::patterns::in_words;
use amontons_analysis::stability::locus::ALL_FREQUENCIES;
use amontons_analysis::stability::{
    CriticalFriction, Linearised, Merging, ModeSensitivity, Parameter, Sensitivities,
    critical_friction, sensitivities,
};
use amontons_analysis::sweep::FRICTION;
use amontons_cli::arguments::Format;
use amontons_cli::progress::Progress;
use amontons_pictures::picture::{self, Bar, BarGroup, Bars};
use serde_json::{Map, Value, json};
use std::cmp::Ordering;
use std::collections::HashSet;
use std::f64::consts::TAU;
use std::io::{self, Write};

/// A change of a parameter that tables and pictures show the consequences of.
const CHANGE: f64 = 0.01;
/// A change below this part of the largest one is rounding of zero.
const ROUNDING: f64 = 1e-11;
/// Changes that are equal to this number of digits have no order.
const SAME_DIGITS: usize = 8;
/// Number of modes of a picture.
const MOST_DRAWN: usize = 6;

/// The results to be printed.
struct SensitivityReport<'a> {
    given: &'a AnalysedScene,
    state: String,
    found: Sensitivities,
    /// `None` if they were not asked for.
    critical: Option<Vec<CriticalFriction>>,
    first: usize,
    /// Bounds of the frequencies, Hz, if they are given.
    frequencies: Option<[f64; 2]>,
}

pub fn run(arguments: &Sensitivity, out: &mut dyn Write) -> Result<(), Failure> {
    arguments.plot.as_deref().map_or(Ok(()), picture::check_name)?;
    let given = configured(&arguments.common, arguments.point.friction, &[])?;
    let scene = &given.scene;
    if arguments.critical.is_some() {
        require_undriven(scene, FRICTION)?;
    }
    let here = Linearised::of(scene);
    let states = state(arguments.point.state.as_deref(), scene, &here)?;
    let frequencies = arguments.frequencies.unwrap_or(ALL_FREQUENCIES);
    let bar = Progress::in_parts("the derivatives");
    let found =
        sensitivities(&here, &states, frequencies, &|done, all| bar.set_part(part(done, all)));
    bar.finish();
    let found = found?;
    if found.modes.is_empty() {
        let [low, high] = frequencies;
        return Err(Error::argument(format!(
            "no mode of the state {} has a frequency from {low} to {high} Hz; without --frequencies all are listed",
            in_words(&states, scene)
        ))
        .into());
    }
    let critical = match arguments.critical {
        None => None,
        Some(range) => {
            let bar = Progress::in_parts("the critical friction coefficients");
            let found = critical_friction(scene, &states, range, frequencies, &|done, all| {
                bar.set_part(part(done, all));
            });
            bar.finish();
            Some(found?)
        }
    };
    let state = in_words(&states, scene);
    let report = SensitivityReport {
        given: &given,
        state,
        found,
        critical,
        first: arguments.first.get(),
        frequencies: arguments.frequencies,
    };
    if let Some(path) = &arguments.plot {
        report.bars().write(path)?;
    }
    match arguments.format {
        Format::Json => writeln!(out, "{:#}", report.as_json())?,
        Format::Csv => report.print_csv(out)?,
        Format::Table => report.print_table(out)?,
    }
    Ok(())
}

/// A parameter with the effect of a change of it by one part in a hundred of its size or, if it is zero, by its unit.
struct Effect<'a> {
    parameter: &'a Parameter,
    /// Changes of the growth rate, 1/s, and of the frequency, Hz, or of a critical µ; one for each copy.
    changes: Vec<[f64; 2]>,
}

impl<'a> Effect<'a> {
    /// The effect of a parameter with these derivatives by it.
    fn of(parameter: &'a Parameter, derivatives: impl Iterator<Item = [f64; 2]>) -> Self {
        // A parameter that is zero has no part in a hundred: its unit stands for it.
        let by = if parameter.value == 0.0 { 1.0 } else { CHANGE * parameter.value.abs() };
        Self { parameter, changes: derivatives.map(|it| it.map(|part| by * part)).collect() }
    }

    /// `true` if the change is one unit of the parameter.
    fn is_by_unit(&self) -> bool {
        self.parameter.value == 0.0
    }

    /// The largest change of each quantity.
    fn size(&self) -> [f64; 2] {
        let most =
            |part: usize| self.changes.iter().fold(0.0, |most, it| f64::max(most, it[part].abs()));
        [most(0), most(1)]
    }

    /// The change that is largest.
    fn largest(&self) -> [f64; 2] {
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

impl SensitivityReport<'_> {
    /// The modes, the fastest growing first.
    fn by_growth(&self) -> Vec<&ModeSensitivity> {
        let mut modes: Vec<&ModeSensitivity> = self.found.modes.iter().collect();
        let order = |a: &&ModeSensitivity, b: &&ModeSensitivity| -> Ordering {
            b.growth_rate().total_cmp(&a.growth_rate())
        };
        modes.sort_by(order);
        modes
    }

    /// The effects on a mode's growth rate and frequency; rounding is told by the size of the eigenvalue too.
    fn effects(&self, mode: &ModeSensitivity) -> Vec<Effect<'_>> {
        let derivatives = mode.derivatives.iter().flatten();
        let of = |(parameter, values): (_, &Vec<nalgebra::Complex<f64>>)| {
            let change = |value: &nalgebra::Complex<f64>| [value.re, value.im / TAU];
            Effect::of(parameter, values.iter().map(change))
        };
        let effects = self.found.parameters.iter().zip(derivatives).map(of).collect();
        sorted(effects, mode.eigenvalue.norm())
    }

    /// The effects on the µ of a merging.
    fn merging_effects(&self, merging: &Merging) -> Vec<Effect<'_>> {
        let all = self.found.parameters.iter().zip(&merging.derivatives);
        let all = all.filter(|(_, values)| !values.is_empty());
        let of = |(parameter, values): (_, &Vec<f64>)| {
            Effect::of(parameter, values.iter().map(|value| [*value, 0.0]))
        };
        sorted(all.map(of).collect(), merging.friction)
    }

    /// The effects on a critical µ.
    fn critical_effects(critical: &CriticalFriction) -> Vec<Effect<'_>> {
        let all = critical.derivatives.iter().flatten();
        let all = all.map(|it| Effect::of(&it.0, it.1.iter().map(|value| [*value, 0.0])));
        sorted(all.collect(), critical.value)
    }

    fn title(&self) -> String {
        let scene = &self.given.scene;
        format!("{}: state {}, {}", scene.name, self.state, friction(scene))
    }

    fn print_table(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "{}", self.title())?;
        write!(out, "{}", self.given.head())?;
        for mode in self.by_growth() {
            let growth = significant(mode.growth_rate(), 5);
            write!(
                out,
                "\n{:.4} Hz, growth rate {growth} 1/s{}",
                mode.frequency_hz(),
                copies(mode.copies)
            )?;
            if let Some(merging) = &mode.merging {
                writeln!(out, ", {}", place(merging))?;
                let head = format!("change of this µ, for +{} % of the parameter", 100.0 * CHANGE);
                self.print_effects(&self.merging_effects(merging), &head, None, out)?;
            } else if mode.derivatives.is_none() {
                writeln!(out, ", {}", without_derivatives(mode))?;
            } else {
                writeln!(out)?;
                let head = format!("growth rate [1/s], for +{} % of the parameter", 100.0 * CHANGE);
                self.print_effects(&self.effects(mode), &head, Some("frequency [Hz]"), out)?;
                if mode.holds_within < CHANGE {
                    writeln!(
                        out,
                        "  another eigenvalue is near: the derivatives may hold only for changes much smaller than {} of a parameter",
                        significant(mode.holds_within, 2)
                    )?;
                }
            }
        }
        for critical in self.critical.iter().flatten() {
            let turn = if critical.becomes_unstable { "begin" } else { "cease" };
            writeln!(
                out,
                "\nµ = {}: {} to grow {}{}",
                significant(critical.value, LOCATED),
                if critical.copies > 1 {
                    format!("{} modes {turn}", critical.copies)
                } else {
                    format!("a mode {turn}s")
                },
                at_frequency(critical.frequency_hz),
                if critical.is_merging && critical.frequency_hz > 0.0 {
                    ", where it merges with another one"
                } else {
                    ""
                },
            )?;
            let head = format!("change of this µ, for +{} % of the parameter", 100.0 * CHANGE);
            match &critical.derivatives {
                Ok(_) => self.print_effects(&Self::critical_effects(critical), &head, None, out)?,
                Err(reason) => writeln!(out, "  no derivatives: {reason}")?,
            }
        }
        if self.critical.as_ref().is_some_and(Vec::is_empty) {
            let bounds = self.frequencies.map_or(String::new(), |[low, high]| {
                format!(", at frequencies from {low} to {high} Hz")
            });
            writeln!(out, "\nno mode begins or ceases to grow in the range of --critical{bounds}")?;
        }
        if !self.found.without_effect.is_empty() {
            let mut names: Vec<String> =
                self.found.without_effect.iter().map(|name| any_place(name)).collect();
            let mut seen = HashSet::new();
            names.retain(|name| seen.insert(name.clone()));
            writeln!(out, "\nwithout effect: {}", names.join(", "))?;
        }
        if !self.found.without_derivative.is_empty() {
            let names = self.found.without_derivative.join(", ");
            writeln!(out, "\nwithout derivative, since the surface stands still: {names}")?;
        }
        Ok(())
    }

    fn print_effects(
        &self,
        effects: &[Effect<'_>],
        head: &str,
        second: Option<&str>,
        out: &mut dyn Write,
    ) -> io::Result<()> {
        let shown = &effects[..effects.len().min(self.first)];
        let width = shown.iter().map(|it| it.parameter.name.chars().count()).max().unwrap_or(0);
        let values: Vec<String> = shown.iter().map(|it| value(it.parameter)).collect();
        let value_width = values.iter().map(|it| it.chars().count()).max().unwrap_or(0);
        let columns = format!("  {:width$}  {:value_width$}", "", "");
        match second {
            Some(second) => writeln!(out, "{columns}  {second:>15}  {head}")?,
            None => writeln!(out, "{columns}  {head}")?,
        }
        for (effect, value) in shown.iter().zip(&values) {
            write!(out, "  {:width$}  {value:>value_width$}", effect.parameter.name)?;
            // Equal modes that the parameter does not part have one effect.
            let mut changes: Vec<[String; 2]> =
                effect.changes.iter().map(|change| change.map(signed)).collect();
            changes.dedup();
            let several = |part: usize| {
                let all: Vec<&str> = changes.iter().map(|change| &*change[part]).collect();
                all.join(" and ")
            };
            if second.is_some() {
                write!(out, "  {:>15}", several(1))?;
            }
            let unit = effect.parameter.unit;
            let by = match (effect.is_by_unit(), unit) {
                (false, _) => String::new(),
                (true, "") => " for +1".into(),
                (true, unit) => format!(" for +1 {unit}"),
            };
            writeln!(out, "  {}{by}", several(0))?;
        }
        Ok(())
    }

    fn print_csv(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(
            out,
            "of,frequency_hz,growth_rate,friction,distance,parameter,value,copy,derivative,frequency_derivative_hz"
        )?;
        let parameters = &self.found.parameters;
        for mode in &self.found.modes {
            let head = format!("{:?},{:?}", mode.frequency_hz(), mode.growth_rate());
            let derivatives = mode.derivatives.iter().flatten();
            for (Parameter { name, value, .. }, all) in parameters.iter().zip(derivatives) {
                for (copy, by) in (1..).zip(all) {
                    let by = format!("{:?},{:?}", by.re, by.im / TAU);
                    writeln!(out, "mode,{head},,,{name},{value:?},{copy},{by}")?;
                }
            }
            if let Some(merging) = &mode.merging {
                let place = format!("{:?},{:?}", merging.friction, merging.distance);
                for (parameter, all) in parameters.iter().zip(&merging.derivatives) {
                    let Parameter { name, value, .. } = parameter;
                    for (copy, by) in (1..).zip(all) {
                        writeln!(out, "merging,{head},{place},{name},{value:?},{copy},{by:?},")?;
                    }
                }
            }
        }
        for critical in self.critical.iter().flatten() {
            let head = format!("{:?},0.0,{:?},", critical.frequency_hz, critical.value);
            for (Parameter { name, value, .. }, all) in critical.derivatives.iter().flatten() {
                for (copy, by) in (1..).zip(all) {
                    writeln!(out, "critical,{head},{name},{value:?},{copy},{by:?},")?;
                }
            }
        }
        Ok(())
    }

    fn as_json(&self) -> Value {
        let parameters = self.found.parameters.iter().map(|Parameter { name, value, unit }| {
            (name.clone(), json!({ "value": value, "unit": unit }))
        });
        let names = || self.found.parameters.iter().map(|parameter| parameter.name.clone());
        let modes = self.found.modes.iter().map(|mode| {
            let derivatives = mode.derivatives.as_ref().map(|all| {
                let each = names().zip(all).map(|(name, values)| {
                    let parts = |part: fn(&nalgebra::Complex<f64>) -> f64| {
                        values.iter().map(part).collect::<Vec<f64>>()
                    };
                    let value = json!({
                        "growth_rate": parts(|by| by.re),
                        "frequency_hz": parts(|by| by.im / TAU),
                    });
                    (name, value)
                });
                each.collect::<Map<String, Value>>()
            });
            let merging = mode.merging.as_ref().map(|merging| {
                let each = names().zip(&merging.derivatives);
                let each = each.filter(|(_, by)| !by.is_empty());
                let each = each.map(|(name, by)| (name, json!(by)));
                json!({
                    "friction": merging.friction,
                    "distance": merging.distance,
                    "is_exact": merging.is_exact,
                    "frequency_hz": merging.eigenvalue.im / TAU,
                    "growth_rate": merging.eigenvalue.re,
                    "derivatives": each.collect::<Map<String, Value>>(),
                })
            });
            json!({
                "frequency_hz": mode.frequency_hz(),
                "growth_rate": mode.growth_rate(),
                "copies": mode.copies,
                "derivatives": derivatives,
                "holds_within": mode.holds_within,
                "merging": merging,
            })
        });
        let critical = self.critical.as_ref().map(|all| {
            let each = all.iter().map(|critical| {
                let derivatives = critical.derivatives.iter().flatten();
                let derivatives =
                    derivatives.map(|(parameter, by)| (parameter.name.clone(), json!(by)));
                json!({
                    "friction": critical.value,
                    "frequency_hz": critical.frequency_hz,
                    "becomes_unstable": critical.becomes_unstable,
                    "is_merging": critical.is_merging,
                    "copies": critical.copies,
                    "derivatives": derivatives.collect::<Map<String, Value>>(),
                })
            });
            each.collect::<Vec<Value>>()
        });
        json!({
            "scene": self.given.scene.name,
            "at": self.given.at,
            "state": self.state,
            "parameters": parameters.collect::<Map<String, Value>>(),
            "without_effect": self.found.without_effect,
            "without_derivative": self.found.without_derivative,
            "modes": modes.collect::<Vec<Value>>(),
            "critical": critical,
        })
    }

    /// The most effective parameters of the modes that grow fastest, and of each critical µ.
    fn bars(&self) -> Bars {
        let bars = |effects: &[Effect<'_>]| {
            let shown = effects.iter().take(self.first);
            let bar = |effect: &Effect<'_>| Bar {
                label: effect.parameter.name.clone(),
                value: effect.largest()[0],
            };
            shown.map(bar).collect::<Vec<Bar>>()
        };
        let modes = self.by_growth();
        let modes = modes.into_iter().take(MOST_DRAWN).map(|mode| {
            let hz = mode.frequency_hz();
            match &mode.merging {
                Some(merging) => BarGroup {
                    title: format!("Mode at {hz:.2} Hz, {}", place(merging)),
                    axis: "Change of this µ for +1 % [–]".into(),
                    bars: bars(&self.merging_effects(merging)),
                },
                None => BarGroup {
                    title: format!(
                        "Mode at {hz:.2} Hz, growth rate {} 1/s",
                        significant(mode.growth_rate(), 4)
                    ),
                    axis: "Change of the growth rate for +1 % [1/s]".into(),
                    bars: bars(&self.effects(mode)),
                },
            }
        });
        let critical = self.critical.iter().flatten().map(|critical| BarGroup {
            title: format!(
                "Critical µ = {} {}",
                significant(critical.value, 6),
                at_frequency(critical.frequency_hz)
            ),
            axis: "Change of the critical µ for +1 % [–]".into(),
            bars: bars(&Self::critical_effects(critical)),
        });
        let groups = modes.chain(critical).filter(|group| !group.bars.is_empty()).collect();
        Bars { title: self.title(), groups }
    }
}

/// The place of a merging, as "merges with another mode at µ = 1.2, at a distance of 1e-3".
fn place(merging: &Merging) -> String {
    let (at, distance) = (significant(merging.friction, 9), significant(merging.distance, 3));
    let verb = match (merging.is_exact, merging.is_real) {
        (true, false) => "merges with another mode",
        (true, true) => "begins or ceases to oscillate",
        (false, _) => "comes nearest to another mode",
    };
    format!("{verb} at µ = {at}, at a distance of {distance}")
}

/// The reason for which a mode has no derivatives.
fn without_derivatives(mode: &ModeSensitivity) -> &'static str {
    if mode.eigenvalue.norm() == 0.0 {
        "a free motion, which no spring holds: it has no derivatives"
    } else {
        "equal to another mode with the same shape: it has no derivatives"
    }
}

/// The name of a value of all modules: `module[*].f1`.
fn any_place(name: &str) -> String {
    match (name.split_once('['), name.split_once(']')) {
        (Some((kind, _)), Some((_, key))) => format!("{kind}[*]{key}"),
        _ => name.to_owned(),
    }
}

/// A parameter's value with its unit.
fn value(Parameter { value, unit, .. }: &Parameter) -> String {
    if unit.is_empty() { format!("{value}") } else { format!("{value} {unit}") }
}

/// A number with its sign.
fn signed(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let text = significant(value.abs(), 4);
    format!("{}{text}", if value < 0.0 { '-' } else { '+' })
}

/// Text for modes with one eigenvalue.
fn copies(count: usize) -> String {
    if count == 1 { String::new() } else { format!(", {count} modes") }
}

/// The part of the work that is done.
#[allow(clippy::cast_precision_loss)]
fn part(done: usize, all: usize) -> f64 {
    done as f64 / all.max(1) as f64
}
