//! Modes of matrices as text and as CSV.

use super::found::{Found, Line, Value};
use crate::labels::{at_frequency, significant};
use std::io::{self, Write};

pub fn print(found: &Found, out: &mut dyn Write) -> io::Result<()> {
    let ([slowest, fastest], [lowest, highest]) = (found.growth_rates, found.frequencies_hz);
    writeln!(
        out,
        "{} degrees of freedom, growth rates from {slowest} to {fastest} 1/s, frequencies from {lowest} to {highest} Hz",
        found.degrees_of_freedom
    )?;
    for value in &found.values {
        print_value(found, value, out)?;
    }
    if found.values.len() > 1 {
        print_crossings(found, out)?;
    }
    Ok(())
}

fn print_value(found: &Found, value: &Value, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out)?;
    if let (Some(parameter), Some(at)) = (&found.parameter, value.value) {
        let unit =
            if parameter.unit.is_empty() { String::new() } else { format!(" {}", parameter.unit) };
        write!(out, "{} = {at}{unit}: ", parameter.name)?;
    }
    writeln!(
        out,
        "{} modes, {}; * grows, ? not known whether it grows",
        value.modes.len(),
        value.count
    )?;
    if value.modes.is_empty() {
        return Ok(());
    }
    writeln!(
        out,
        "{:>5}  {:>14}  {:>16}  {:>10}  {:>14}  {:>12}",
        "mode", "frequency, Hz", "growth rate, 1/s", "damping, %", "backward error", "± λ, 1/s"
    )?;
    for (number, mode) in (1..).zip(&value.modes) {
        let Line { frequency_hz, growth_rate, damping_ratio, backward_error, error_bound, grows } =
            mode;
        let damping =
            damping_ratio.map_or_else(|| "–".into(), |ratio| significant(100.0 * ratio, 4));
        let bound = error_bound.map_or_else(|| "–".into(), |bound| format!("{bound:.0e}"));
        let star = match grows {
            Some(true) => " *",
            Some(false) => "",
            None => " ?",
        };
        writeln!(
            out,
            "{number:>5}  {frequency_hz:>14.4}  {growth_rate:>16.5}  {damping:>10}  {backward_error:>14.0e}  {bound:>12}{star}"
        )?;
    }
    Ok(())
}

fn print_crossings(found: &Found, out: &mut dyn Write) -> io::Result<()> {
    let Some(parameter) = &found.parameter else { return Ok(()) };
    writeln!(
        out,
        "\nmodes followed over {} by their shapes: {}",
        parameter.name,
        found.branches.len()
    )?;
    let mut any = false;
    for branch in &found.branches {
        for turn in &branch.crossings {
            any = true;
            let [from, to] = turn.between;
            writeln!(
                out,
                "  {} = {} (a straight line from {from} to {to}): a mode {} {}",
                parameter.name,
                significant(turn.value, 5),
                if turn.begins_to_grow { "begins to grow" } else { "ceases to grow" },
                at_frequency(turn.frequency_hz),
            )?;
        }
    }
    if !any {
        writeln!(out, "  no growth rate changes its sign between two values")?;
    }
    Ok(())
}

pub fn print_csv(found: &Found, out: &mut dyn Write) -> io::Result<()> {
    let name = found.parameter.as_ref().map(|parameter| parameter.name.as_str());
    if let Some(name) = name {
        write!(out, "{name},branch,")?;
    }
    writeln!(
        out,
        "mode,frequency_hz,growth_rate,damping_ratio,backward_error,error_bound,grows,complete"
    )?;
    let text = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
    for value in &found.values {
        for (number, mode) in (1..).zip(&value.modes) {
            if let (Some(_), Some(at)) = (name, value.value) {
                write!(out, "{at},{},", branch_of(found, at, number))?;
            }
            writeln!(
                out,
                "{number},{},{},{},{},{},{},{}",
                mode.frequency_hz,
                mode.growth_rate,
                text(mode.damping_ratio),
                mode.backward_error,
                text(mode.error_bound),
                mode.grows.map_or("unknown".into(), |grows| grows.to_string()),
                value.is_complete
            )?;
        }
    }
    Ok(())
}

/// The number of the branch of a mode, from 1; empty for one value.
fn branch_of(found: &Found, value: f64, mode: usize) -> String {
    let place = found.branches.iter().position(|branch| {
        branch.points.iter().any(|point| point.value == value && point.mode == mode)
    });
    place.map_or_else(String::new, |place| (place + 1).to_string())
}
