//! `amontons-stability sensitivity`.

use crate::arguments::Sensitivity;
use crate::labels::{LOCATED, at_frequency, significant};
use crate::{AnalysedScene, Failure, configured, friction, state};
use amontons::Error;
use amontons_analysis::instant::require_undriven;
use amontons_analysis::patterns::in_words;
use amontons_analysis::stability::locus::ALL_FREQUENCIES;
use amontons_analysis::stability::{
    CriticalFriction, Linearised, Parameter, Sensitivities, critical_friction, sensitivities,
};
use amontons_analysis::sweep::FRICTION;
use amontons_cli::arguments::Format;
use amontons_cli::progress::Progress;
use amontons_cli::words::sensitivity::{
    CHANGE, Effect, bars, by_growth, critical_effects, merging_effects, mode_effects, place,
    signed, value, without_derivatives,
};
use amontons_pictures::picture::{self, Bars};
use serde_json::{Map, Value, json};
use std::collections::HashSet;
use std::f64::consts::TAU;
use std::io::{self, Write};

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

impl SensitivityReport<'_> {
    /// The most effective parameters of the modes that grow fastest, and of each critical µ.
    fn bars(&self) -> Bars {
        let critical = self.critical.as_deref().unwrap_or_default();
        bars(self.title(), &self.found, by_growth(&self.found), critical, self.first)
    }

    fn title(&self) -> String {
        let scene = &self.given.scene;
        format!("{}: state {}, {}", scene.name, self.state, friction(scene))
    }

    fn print_table(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "{}", self.title())?;
        write!(out, "{}", self.given.head())?;
        for mode in by_growth(&self.found) {
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
                self.print_effects(&merging_effects(&self.found, merging), &head, None, out)?;
            } else if mode.derivatives.is_none() {
                writeln!(out, ", {}", without_derivatives(mode))?;
            } else {
                writeln!(out)?;
                let head = format!("growth rate [1/s], for +{} % of the parameter", 100.0 * CHANGE);
                self.print_effects(
                    &mode_effects(&self.found, mode),
                    &head,
                    Some("frequency [Hz]"),
                    out,
                )?;
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
                Ok(_) => self.print_effects(&critical_effects(critical), &head, None, out)?,
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
}

/// The name of a value of all modules: `module[*].f1`.
fn any_place(name: &str) -> String {
    match (name.split_once('['), name.split_once(']')) {
        (Some((kind, _)), Some((_, key))) => format!("{kind}[*]{key}"),
        _ => name.to_owned(),
    }
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
