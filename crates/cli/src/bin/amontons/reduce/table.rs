//! The report on a superelement, as text and as JSON.

use amontons::decimal::to_significant;
use amontons_structures::symmetric::{Certificate, Request, Structure, Superelement, frequency};
use serde::Serialize;
use std::io::{self, Write};

/// Intervals are printed in units of one by this, Hz, rounded outwards.
const SHOWN: f64 = 1e5;

/// Errors from the first number on and below the second, %, are printed as plain decimals.
const PLAIN: (f64, f64) = (0.01, 1000.0);

/// An error of a frequency that is worth a remark, as a part of it.
const NOTED: f64 = 0.01;

/// All that is said of a superelement.
#[derive(Serialize)]
pub struct Report {
    degrees_of_freedom: usize,
    retained: usize,
    /// Frequencies of the kept modes, with the retained nodes held, Hz.
    kept_modes_hz: Vec<f64>,
    kept_up_to_hz: f64,
    left_out_modes: usize,
    /// Parts of the mass that the kept modes move along x, y and z.
    moved_mass: [Option<f64>; 3],
    free: Certified,
    contacts_stuck: Certified,
}

/// A certificate.
#[derive(Serialize)]
pub struct Certified {
    /// Where modes were counted, Hz.
    counted_below_hz: f64,
    full_count: usize,
    superelement_count: usize,
    is_complete: bool,
    modes: Vec<Mode>,
}

#[derive(Serialize)]
struct Mode {
    superelement_hz: Option<f64>,
    /// Contains an eigenfrequency of the full matrices.
    full_interval_hz: [f64; 2],
    is_rigid: bool,
    largest_relative_error: Option<f64>,
}

impl Certified {
    pub fn new(certificate: &Certificate) -> Self {
        let modes = certificate.intervals.iter().enumerate().map(|(mode, interval)| Mode {
            superelement_hz: certificate.frequencies.get(mode).copied(),
            full_interval_hz: interval.frequencies(),
            is_rigid: certificate.is_rigid(mode),
            largest_relative_error: certificate.error(mode),
        });
        Self {
            counted_below_hz: to_significant(certificate.limit, 12),
            full_count: certificate.full,
            superelement_count: certificate.reduced,
            is_complete: certificate.is_complete(),
            modes: modes.collect(),
        }
    }

    fn print(&self, title: &str, kept_up_to: f64, out: &mut dyn Write) -> io::Result<()> {
        let Self { counted_below_hz, full_count, superelement_count, modes, .. } = self;
        writeln!(
            out,
            "\n{title}: {full_count} modes of the full matrices below {counted_below_hz} Hz, {superelement_count} of the superelement"
        )?;
        if self.is_complete {
            writeln!(out, "none is missing (counted by the signs of the pivots of K − ω²M)")?;
        } else {
            writeln!(
                out,
                "NOT COMPLETE: keep more modes (--modes-to above {kept_up_to} Hz), or ask for another --frequency"
            )?;
        }
        let rigid = modes.iter().filter(|mode| mode.is_rigid).count();
        if rigid > 0 {
            writeln!(out, "{rigid} of them are motions of a rigid body or a mechanism, at 0 Hz")?;
        }
        if modes.len() > rigid {
            writeln!(
                out,
                "{:>5}  {:>18}  {:>32}  {:>9}",
                "mode", "superelement, Hz", "full matrices, Hz", "error, %"
            )?;
        }
        for (number, mode) in (1..).zip(modes).filter(|(_, mode)| !mode.is_rigid) {
            let own = mode.superelement_hz.map_or_else(|| "–".into(), |own| format!("{own:.5}"));
            let [low, high] = mode.full_interval_hz;
            let interval = format!(
                "{:.5} to {:.5}",
                (SHOWN * low).floor() / SHOWN,
                (SHOWN * high).ceil() / SHOWN
            );
            let error = mode.largest_relative_error.map_or_else(|| "–".into(), percent);
            writeln!(out, "{number:>5}  {own:>18}  {interval:>32}  {error:>9}")?;
        }
        let worst = modes.iter().filter_map(|mode| mode.largest_relative_error).fold(0.0, f64::max);
        if worst > NOTED {
            writeln!(
                out,
                "the largest error is {} %; keep more modes with --modes-to above {kept_up_to} Hz for a smaller one",
                percent(worst)
            )?;
        }
        Ok(())
    }
}

/// A part in percent, rounded up to two digits; as a plain decimal from 0.01 to 1000 %.
fn percent(part: f64) -> String {
    let percent = 100.0 * part;
    let second_digit = |value: f64| libm::floor(libm::log10(value)) - 1.0;
    let unit = libm::pow(10.0, second_digit(percent));
    let rounded = (percent / unit).ceil() * unit;
    if !(PLAIN.0..PLAIN.1).contains(&rounded) {
        return format!("{rounded:.1e}");
    }
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let places = (-second_digit(rounded)).max(0.0) as usize;
    format!("{rounded:.places$}")
}

impl Report {
    /// `true` if no mode is missing, free and with contact nodes held.
    pub const fn is_complete(&self) -> bool {
        self.free.is_complete && self.contacts_stuck.is_complete
    }

    pub fn new(
        structure: &Structure,
        superelement: &Superelement,
        request: &Request,
        free: Certified,
        contacts_stuck: Certified,
    ) -> Self {
        let (degrees_of_freedom, retained) = (structure.freedoms().len(), request.retained.len());
        Self {
            degrees_of_freedom,
            retained,
            kept_modes_hz: superelement.modes.iter().map(|&value| frequency(value)).collect(),
            kept_up_to_hz: request.modes_to,
            left_out_modes: degrees_of_freedom - retained - superelement.modes.len(),
            moved_mass: superelement.moved_mass,
            free,
            contacts_stuck,
        }
    }

    pub fn json(&self) -> String {
        let mut text =
            serde_json::to_string_pretty(self).expect("numbers and texts can be written");
        text.push('\n');
        text
    }

    pub fn print(&self, out: &mut dyn Write) -> io::Result<()> {
        let kept = self.kept_modes_hz.len();
        writeln!(
            out,
            "{} degrees of freedom become {}: {} retained and {kept} modes up to {} Hz with these held",
            self.degrees_of_freedom,
            self.retained + kept,
            self.retained,
            self.kept_up_to_hz
        )?;
        let shares = ["x", "y", "z"].iter().zip(self.moved_mass).filter_map(|(axis, share)| {
            share.map(|share| format!("{:.1} % along {axis}", 100.0 * share))
        });
        let shares: Vec<String> = shares.collect();
        if shares.is_empty() {
            writeln!(
                out,
                "left out: {} modes above {} Hz",
                self.left_out_modes, self.kept_up_to_hz
            )?;
        } else {
            writeln!(
                out,
                "left out: {} modes above {} Hz; the kept ones move {} of the mass between the retained nodes",
                self.left_out_modes,
                self.kept_up_to_hz,
                shares.join(", ")
            )?;
        }
        self.free.print("free", self.kept_up_to_hz, out)?;
        self.contacts_stuck.print(
            "contact nodes held, as contacts that stick hold them",
            self.kept_up_to_hz,
            out,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::percent;

    #[test]
    fn errors_are_plain_decimals_unless_they_are_tiny_or_huge() {
        for (part, text) in [
            (0.0695, "7.0"),
            (0.0701, "7.1"),
            (0.00735, "0.74"),
            (1.39e-4, "0.014"),
            (0.1195, "12"),
            (1.201, "130"),
            (9.96e-3, "1.0"),
            (8.95e-5, "9.0e-3"),
            (8.25e-13, "8.3e-11"),
            (12.3, "1.3e3"),
        ] {
            assert_eq!(percent(part), text, "{part}");
        }
    }
}
