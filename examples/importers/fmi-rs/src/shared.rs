//! Functions that correspond to those of the importers in Python: the check of FMUs before a run, the summary of a run,
//! and its comparison with a run without an importer.

use fmi_rs::fmi2::PLATFORM;
use fmi_rs::fmi2::builder::FMU2Builder;
use fmi_rs::model_description::fmi2::{Causality, ScalarVariable, VariableType};
use std::error::Error;
use std::path::{Path, PathBuf};

/// Values over time.
#[derive(Default)]
pub struct Run {
    /// Times of the rows, s.
    pub times: Vec<f64>,
    /// Names of the columns.
    pub names: Vec<String>,
    /// The values of each row.
    pub rows: Vec<Vec<f64>>,
}

/// An FMU file that this machine can run, unpacked.
pub struct Fmu {
    pub file: PathBuf,
    pub builder: FMU2Builder,
}

impl Fmu {
    pub fn open(file: &Path) -> Result<Self, Box<dyn Error>> {
        let name = file.display();
        must_exist(file)?;
        if file.is_dir() {
            return Err(format!("{name}: this is a folder, not an FMU").into());
        }
        let builder = FMU2Builder::new(&file)
            .map_err(|error| format!("{name}: this is not an FMU: {error}"))?;
        let folder = builder.unzipdir.path().join("binaries");
        if !folder.join(PLATFORM).is_dir() {
            let folders = std::fs::read_dir(folder).into_iter().flatten().flatten();
            let has: Vec<_> =
                folders.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
            let has = if has.is_empty() { "none".into() } else { has.join(", ") };
            return Err(
                format!("{name}: the FMU has no library for {PLATFORM}; it has {has}").into()
            );
        }
        Ok(Self { file: file.to_owned(), builder })
    }

    /// The outputs of the FMU, in the order of its model description.
    pub fn outputs(&self) -> impl Iterator<Item = &ScalarVariable> {
        let variables = self.builder.model_description.modelVariables.iter();
        variables.filter(|variable| variable.causality == Causality::Output)
    }

    /// Returns an error if the FMU has no such real variable.
    pub fn must_have(&self, name: &str, causalities: &[Causality]) -> Result<(), String> {
        let mut variables = self.builder.model_description.modelVariables.iter();
        if variables.any(|v| {
            v.name == name
                && causalities.contains(&v.causality)
                && matches!(v.variableType, VariableType::Real { .. })
        }) {
            return Ok(());
        }
        let what = if causalities == [Causality::Output] { "output" } else { "parameter or input" };
        Err(format!("{name}: {} has no such {what}", self.file.display()))
    }
}

impl Run {
    /// Reads the CSV file of a run without an importer.
    pub fn read(file: &Path) -> Result<Self, Box<dyn Error>> {
        let name = file.display();
        must_exist(file)?;
        let lines = std::fs::File::open(file).map_err(|error| format!("{name}: {error}"))?;
        let table = || -> Result<Self, Box<dyn Error>> {
            let mut reader = csv::Reader::from_reader(lines);
            let names = reader.headers()?.iter().skip(1).map(str::to_owned).collect();
            let mut run = Self { names, ..Self::default() };
            for record in reader.records() {
                let values: Result<Vec<f64>, _> = record?.iter().map(str::parse).collect();
                let mut values = values?;
                run.times.push(values.remove(0));
                run.rows.push(values);
            }
            Ok(run)
        };
        table().map_err(|error| format!("{name}: this is not a CSV file of a run: {error}").into())
    }

    /// Returns the column of this index.
    fn column(&self, place: usize) -> Vec<f64> {
        self.rows.iter().map(|row| row[place]).collect()
    }

    /// Prints a summary of the run; `scene` is the prefix of the scene's outputs, `speed` the slider's velocity.
    pub fn show(&self, scene: &str, speed: &str, reaction: &str) {
        let own = |ends: &[&str]| -> Vec<(&String, Vec<f64>)> {
            let is_meant =
                |name: &str| name.starts_with(scene) && ends.iter().any(|end| name.ends_with(end));
            let names = self.names.iter().enumerate().filter(|(_, name)| is_meant(name));
            names.map(|(place, name)| (name, self.column(place))).collect()
        };
        let line = |what: &str, value: String| println!("  {what:18} {value}");
        let extremes = |what: &str, columns: &[(&String, Vec<f64>)], unit: &str| {
            let all = || columns.iter().flat_map(|(_, column)| column).copied();
            let (low, high) = (all().reduce(f64::min), all().reduce(f64::max));
            if let (Some(low), Some(high)) = (low, high) {
                line(what, format!("{} to {} {unit}", digits(low, 6), digits(high, 6)));
            }
        };
        let Some(end) = self.times.last() else { return };
        line("rows", format!("{}, to {} s", self.times.len(), digits(*end, 6)));
        if let Some(place) = self.names.iter().position(|name| name == speed) {
            extremes("slider velocity", &[(&self.names[place], self.column(place))], "m/s");
        }
        extremes("reaction on slider", &own(&[reaction]), "N");
        extremes("normal forces", &own(&[".normal_force"]), "N");
        let third = (self.times.len() / 3).max(1);
        if let Some((name, motion)) = own(&[".v1", ".vx", ".vy"]).first() {
            let most = |part: &[f64]| digits(part.iter().map(|v| v.abs()).fold(0.0, f64::max), 3);
            let (early, late) = (most(&motion[..third]), most(&motion[motion.len() - third..]));
            line(name, format!("at most {early} m/s in the first third, {late} in the last"));
        }
        if let Some((_, changes)) = own(&["statistics.state_changes"]).first() {
            let all = changes[changes.len() - 1];
            let late = all - changes[changes.len() - third];
            line("contact states", format!("{all} changes, {late} of them in the last third"));
        }
    }

    /// Describes the differences from the expected run, bit by bit; empty if the runs are equal.
    pub fn differences(&self, expected: &Self) -> Vec<String> {
        if expected.times.len() < 2 || expected.times.len() != self.times.len() {
            return vec![format!("{} rows instead of {}", self.times.len(), expected.times.len())];
        }
        let only_in_one = |one: &Self, other: &Self| {
            let names = one.names.iter().filter(|name| !other.names.contains(name));
            names.map(|name| format!("{name} is only in one of the two")).collect::<Vec<_>>()
        };
        let mut found = [only_in_one(self, expected), only_in_one(expected, self)].concat();
        let mut compare = |name: &str, here: &[f64], there: &[f64]| {
            let pairs = here.iter().zip(there).zip(&expected.times);
            let mut wrong = pairs.filter(|((here, there), _)| {
                !(there.is_finite() && here.to_bits() == there.to_bits())
            });
            if let Some(((here, there), time)) = wrong.next() {
                let (rows, first) = (1 + wrong.count(), format!("{here:?} instead of {there:?}"));
                found.push(format!("{name} in {rows} rows, first at {time:?} s: {first}"));
            }
        };
        compare("time", &self.times, &expected.times);
        for (place, name) in self.names.iter().enumerate() {
            if let Some(there) = expected.names.iter().position(|known| known == name) {
                compare(name, &self.column(place), &expected.column(there));
            }
        }
        found
    }
}

fn must_exist(file: &Path) -> Result<(), String> {
    let missing = || format!("{}: there is no such file", file.display());
    file.exists().then_some(()).ok_or_else(missing)
}

/// Formats a number with this many significant digits without trailing zeros, like `%g` in C.
fn digits(value: f64, digits: usize) -> String {
    let rounded = format!("{value:.*e}", digits - 1);
    let Some((mantissa, exponent)) = rounded.split_once('e') else { return rounded };
    let exponent: isize = exponent.parse().unwrap_or(0);
    let short = |number: &str| match number.contains('.') {
        true => number.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => number.to_owned(),
    };
    // The decimals that the digits before the point leave.
    match (digits - 1).checked_add_signed(-exponent) {
        Some(places) if exponent >= -4 => short(&format!("{value:.places$}")),
        _ => format!("{}e{exponent:+03}", short(mantissa)),
    }
}
