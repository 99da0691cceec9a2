//! `[[signal]]` of a scene file.

use super::network_check::quoted;
use super::source::Folder;
use super::{Between, Constant, Problem, Pulse, Ramp, Shape, Signal, Sine, Table};
use serde::Deserialize;

/// A value over time that is added to an input.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(extend("oneOf" = [
    { "required": ["constant"] },
    { "required": ["ramp"] },
    { "required": ["pulse"] },
    { "required": ["sine"] },
    { "required": ["table"] },
])))]
#[serde(deny_unknown_fields)]
pub(super) struct SignalTable {
    /// The input to which the signal is added, as the FMU names it: "slider.velocity", "module[1].f1".
    input: String,
    /// Constant value at all times.
    constant: Option<Constant>,
    /// Linear change from one value to another.
    ramp: Option<Ramp>,
    /// Constant value from a start time on, or between two times.
    pulse: Option<Pulse>,
    /// Sine from a start time on, or between two times.
    sine: Option<Sine>,
    /// Points over time, given here or in a CSV file beside the scene.
    table: Option<PointTable>,
}

/// Points over time, given here or in a CSV file beside the scene.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(extend(
    "oneOf" = [{ "required": ["points"] }, { "required": ["file"] }],
)))]
#[serde(deny_unknown_fields)]
struct PointTable {
    /// Time (s) and value of each point, in order of time; if two points have the same time, the second holds from then on.
    points: Option<Vec<[f64; 2]>>,
    /// Name of a CSV file beside the scene, whose first column is `time` (s).
    file: Option<String>,
    /// Column of the file; by default the column with the input's name, or else the only column besides the time.
    column: Option<String>,
    /// Interpolation between the points.
    #[serde(default)]
    between: Between,
}

/// Reports signals without exactly one shape, and tables without exactly one of `points` and `file`.
pub(super) fn without_one_shape(tables: &[SignalTable]) -> impl Iterator<Item = Problem> + '_ {
    let of = |(i, signal): (usize, &SignalTable)| {
        let SignalTable { constant, ramp, pulse, sine, table, .. } = signal;
        let given =
            [constant.is_some(), ramp.is_some(), pulse.is_some(), sine.is_some(), table.is_some()];
        let path = format!("signal[{}]", i + 1);
        if given.iter().filter(|is_given| **is_given).count() != 1 {
            let needs = "needs exactly one of `constant`, `ramp`, `pulse`, `sine` and `table`";
            return Some(Problem::new(path, needs));
        }
        let has_none_or_both = |table: &PointTable| table.points.is_some() == table.file.is_some();
        table
            .as_ref()
            .is_some_and(has_none_or_both)
            .then(|| Problem::new(format!("{path}.table"), "needs either `points` or `file`"))
    };
    tables.iter().enumerate().filter_map(of)
}

/// Makes the signals; problems found in them are added to `problems`.
pub(super) fn signals(
    tables: Vec<SignalTable>,
    folder: &mut Folder<'_>,
    problems: &mut Vec<Problem>,
) -> Vec<Signal> {
    let one = |(i, signal): (usize, SignalTable)| {
        let shapes = [
            signal.constant.map(Shape::Constant),
            signal.ramp.map(Shape::Ramp),
            signal.pulse.map(Shape::Pulse),
            signal.sine.map(Shape::Sine),
        ];
        // `without_one_shape` reports a signal without exactly one shape.
        let shape = match (shapes.into_iter().flatten().next(), signal.table) {
            (Some(shape), _) => Some(shape),
            (None, Some(table)) => {
                let path = format!("signal[{}].table", i + 1);
                let table = table.read(&path, &signal.input, folder);
                table.map_err(|problem| problems.push(problem)).ok().map(Shape::Table)
            }
            (None, None) => None,
        };
        // A substitute keeps the indices of the other signals; the scene is refused anyway.
        let shape = shape.unwrap_or(Shape::Constant(Constant { value: 0.0 }));
        Signal { input: signal.input, shape }
    };
    tables.into_iter().enumerate().map(one).collect()
}

impl PointTable {
    fn read(self, path: &str, input: &str, folder: &mut Folder<'_>) -> Result<Table, Problem> {
        let Self { points, file, column, between } = self;
        let wrong = |key: &str, message| Problem::new(format!("{path}.{key}"), message);
        let Some(file) = file else {
            if let Some(column) = column {
                let problem = wrong(
                    "column",
                    "names a column of a file, but the table gives `points`".to_owned(),
                );
                return Err(problem.of(quoted(&column)).help("leave it out"));
            }
            return Ok(Table { points: points.unwrap_or_default(), between });
        };
        let table =
            folder.table(&file).map_err(|message| wrong("file", message).of(quoted(&file)))?;
        let wanted = column.as_deref().unwrap_or(input);
        let place = match table.names.iter().position(|name| name == wanted) {
            None if column.is_none() && table.names.len() == 1 => Some(0),
            place => place,
        };
        let place = place.ok_or_else(|| {
            let message = format!("{file} has no column `{wanted}`");
            let help = format!("its columns are {}", table.names.join(", "));
            match &column {
                Some(column) => wrong("column", message).of(quoted(column)),
                None => wrong("file", message).of(quoted(&file)),
            }
            .help(help)
        })?;
        Ok(table.column(place, between))
    }
}
