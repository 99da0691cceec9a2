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
            "no mode of the state {} has a frequency from {low} to {high} Hz; `amontons-stability modes` lists them",
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
    let report =
        SensitivityReport { given: &given, state, found, critical, first: arguments.first };
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

/// A parameter with what a change of it by one part in a hundred does.
struct Effect<'a> {
    parameter: &'a Parameter,
    /// Changes of the growth rate, 1/s, and of the frequency, Hz, or of a critical µ; one for each copy.
    changes: Vec<[f64; 2]>,
}

impl Effect<'_> {
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

/// The effects without those of rounding, the largest first; those that are equal but for rounding in the order of the
/// parameters.
fn sorted(mut effects: Vec<Effect<'_>>) -> Vec<Effect<'_>> {
    let changes = || effects.iter().flat_map(|effect| &effect.changes);
    let largest = changes().map(|change| change[0].abs().max(TAU * change[1].abs()));
    let floor = ROUNDING * largest.fold(0.0, f64::max);
    for change in effects.iter_mut().flat_map(|effect| &mut effect.changes) {
        for (part, unit) in change.iter_mut().zip([1.0, TAU]) {
            if unit * part.abs() <= floor {
                *part = 0.0;
            }
        }
    }
    let order = |effect: &Effect<'_>| effect.size().map(|size| to_significant(size, SAME_DIGITS));
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

    /// The effects on a mode's growth rate and frequency.
    fn effects(&self, mode: &ModeSensitivity) -> Vec<Effect<'_>> {
        let derivatives = mode.derivatives.iter().flatten();
        let of = |(parameter, values): (_, &Vec<nalgebra::Complex<f64>>)| {
            let parameter: &Parameter = parameter;
            let by = CHANGE * parameter.value;
            let change = |value: &nalgebra::Complex<f64>| [by * value.re, by * value.im / TAU];
            Effect { parameter, changes: values.iter().map(change).collect() }
        };
        sorted(self.found.parameters.iter().zip(derivatives).map(of).collect())
    }

    /// The effects on the µ of a merging.
    fn merging_effects(&self, merging: &Merging) -> Vec<Effect<'_>> {
        let of = |(parameter, value): (_, &Option<f64>)| {
            let parameter: &Parameter = parameter;
            Some(Effect { parameter, changes: vec![[CHANGE * parameter.value * (*value)?, 0.0]] })
        };
        let derivatives = &merging.derivatives;
        sorted(self.found.parameters.iter().zip(derivatives).filter_map(of).collect())
    }

    /// The effects on a critical µ.
    fn critical_effects(&self, critical: &CriticalFriction) -> Vec<Effect<'_>> {
        let of = |(name, values): &(String, Vec<f64>)| {
            let parameter = self.found.parameters.iter().find(|it| it.name == *name)?;
            let by = CHANGE * parameter.value;
            let changes = values.iter().map(|value| [by * value, 0.0]).collect();
            Some(Effect { parameter, changes })
        };
        sorted(critical.derivatives.iter().filter_map(of).collect())
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
                writeln!(out, ", merges with another mode {}", place(merging))?;
                let head = format!("changes of this µ for +{} % of the parameter", 100.0 * CHANGE);
                self.print_effects(&self.merging_effects(merging), &head, None, out)?;
            } else if mode.derivatives.is_none() {
                writeln!(
                    out,
                    ", has merged with another mode in a way that no µ describes: it has no derivatives"
                )?;
            } else {
                writeln!(out)?;
                let head = format!("growth rate [1/s], for +{} % of the parameter", 100.0 * CHANGE);
                self.print_effects(&self.effects(mode), &head, Some("frequency [Hz]"), out)?;
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
                if critical.is_merging { ", where it merges with another one" } else { "" },
            )?;
            let head = format!("changes of this µ for +{} % of the parameter", 100.0 * CHANGE);
            self.print_effects(&self.critical_effects(critical), &head, None, out)?;
        }
        if self.critical.as_ref().is_some_and(Vec::is_empty) {
            writeln!(out, "\nno mode begins or ceases to grow in the range of --critical")?;
        }
        if !self.found.without_effect.is_empty() {
            let mut names: Vec<String> =
                self.found.without_effect.iter().map(|name| any_place(name)).collect();
            let mut seen = HashSet::new();
            names.retain(|name| seen.insert(name.clone()));
            writeln!(out, "\nwithout effect: {}", names.join(", "))?;
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
            let several = |part: usize| {
                let all = effect.changes.iter().map(|change| signed(change[part]));
                let mut all: Vec<String> = all.collect();
                all.dedup();
                all.join(" and ")
            };
            if second.is_some() {
                write!(out, "  {:>15}", several(1))?;
            }
            writeln!(out, "  {}", several(0))?;
        }
        Ok(())
    }

    fn print_csv(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(
            out,
            "of,frequency_hz,growth_rate,parameter,value,copy,derivative,frequency_derivative_hz"
        )?;
        for mode in &self.found.modes {
            let head = format!("{:?},{:?}", mode.frequency_hz(), mode.growth_rate());
            let derivatives = mode.derivatives.iter().flatten();
            for (Parameter { name, value, .. }, all) in
                self.found.parameters.iter().zip(derivatives)
            {
                for (copy, by) in (1..).zip(all) {
                    writeln!(
                        out,
                        "mode,{head},{name},{value:?},{copy},{:?},{:?}",
                        by.re,
                        by.im / TAU
                    )?;
                }
            }
            let merging = mode.merging.iter().flat_map(|it| &it.derivatives);
            for (Parameter { name, value, .. }, by) in self.found.parameters.iter().zip(merging) {
                if let Some(by) = by {
                    writeln!(out, "merging,{head},{name},{value:?},1,{by:?},")?;
                }
            }
        }
        for critical in self.critical.iter().flatten() {
            for (name, all) in &critical.derivatives {
                let of = self.found.parameters.iter().find(|it| it.name == *name);
                let value = of.map_or(f64::NAN, |it| it.value);
                for (copy, by) in (1..).zip(all) {
                    let hz = critical.frequency_hz;
                    writeln!(out, "critical,{hz:?},0.0,{name},{value:?},{copy},{by:?},")?;
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
                let each = each.filter_map(|(name, by)| Some((name, json!((*by)?))));
                json!({
                    "friction": merging.friction,
                    "distance": merging.distance,
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
                "merging": merging,
            })
        });
        let critical = self.critical.as_ref().map(|all| {
            let each = all.iter().map(|critical| {
                let derivatives = critical.derivatives.iter();
                let derivatives = derivatives.map(|(name, by)| (name.clone(), json!(by)));
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
                    title: format!("Mode at {hz:.2} Hz, merges {}", place(merging)),
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
            bars: bars(&self.critical_effects(critical)),
        });
        let groups = modes.chain(critical).filter(|group| !group.bars.is_empty()).collect();
        Bars { title: self.title(), groups }
    }
}

/// The place of a merging, as "at µ = 1.20 (distance 1.2e-3)".
fn place(merging: &Merging) -> String {
    let (at, distance) = (significant(merging.friction, 9), significant(merging.distance, 3));
    format!("near µ = {at}, at a distance of {distance}")
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
