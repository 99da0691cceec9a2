//! Values over time from a CSV file.

use super::{Between, Table, text};
use crate::Error;
use crate::error::Short;
use std::path::Path;

/// A CSV file of values over time: a header whose first column is `time` (s), comma-separated, times in ascending
/// order. FMPy reads the same files as inputs.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeTable {
    /// Names of the columns, except the time.
    pub names: Vec<String>,
    times: Vec<f64>,
    /// Values row by row.
    values: Vec<f64>,
}

impl TimeTable {
    /// Reads a CSV file.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read, or the errors of [`parse`](Self::parse).
    pub fn read(path: &Path) -> Result<Self, Error> {
        let place = path.display().to_string();
        let bytes =
            text::read(path, text::MAX_TABLES).map_err(|error| Error::file(path, &error))?;
        let bytes = bytes.ok_or_else(|| {
            Error::scene(format!(
                "{place} is larger than {}, the limit for tables of inputs; leave out rows",
                text::megabytes(text::MAX_TABLES)
            ))
        })?;
        let text = text::decode(&place, CSV_FILE, bytes)?;
        Self::parse(&text).map_err(|message| Error::scene(format!("{place}: {message}")))
    }

    /// Reads the text of a CSV file.
    ///
    /// # Errors
    /// Returns the first error in the text: line, column, the text there, and what would be right.
    pub fn parse(text: &str) -> Result<Self, String> {
        let mut reader =
            csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
        let headers = reader.headers().map_err(|error| explained(&error))?.clone();
        let Some(("time", names)) =
            headers.iter().next().map(|first| (first, headers.iter().skip(1)))
        else {
            return Err(not_a_header(&headers));
        };
        let names: Vec<String> = names.map(str::to_owned).collect();
        if names.is_empty() {
            return Err("line 1: there is no column besides `time`".to_owned());
        }
        if let Some(nameless) = names.iter().position(String::is_empty) {
            return Err(format!("line 1: column {} has no name", nameless + 2));
        }
        let is_twice = |(i, name): &(usize, &String)| *name == "time" || names[..*i].contains(name);
        if let Some((_, twice)) = names.iter().enumerate().find(is_twice) {
            return Err(format!("line 1: two columns are named `{twice}`"));
        }
        let mut table = Self { names, times: Vec::new(), values: Vec::new() };
        let mut record = csv::StringRecord::new();
        while reader.read_record(&mut record).map_err(|error| explained(&error))? {
            let line = record.position().map_or(0, csv::Position::line);
            for (name, field) in headers.iter().zip(&record) {
                let value = field.parse().ok().filter(|value: &f64| value.is_finite());
                let value = value.ok_or_else(|| match field {
                    "" => format!("line {line}, column `{name}`: the value is missing"),
                    _ => format!(
                        "line {line}, column `{name}`: `{field}` is not a finite number{}",
                        if field.contains(',') { DECIMALS } else { "" }
                    ),
                })?;
                if name == "time" { &mut table.times } else { &mut table.values }.push(value);
            }
            if let [.., before, now] = table.times[..]
                && now < before
            {
                return Err(format!(
                    "line {line}: time {} s comes after {} s; sort the rows by time",
                    Short(now),
                    Short(before)
                ));
            }
        }
        if table.times.is_empty() { Err("the table has no rows".to_owned()) } else { Ok(table) }
    }

    /// Returns a column (from 0, not counting the time) as points over time.
    ///
    /// # Panics
    /// Panics if there is no such column.
    #[must_use]
    pub fn column(&self, column: usize, between: Between) -> Table {
        let values = self.values[column..].iter().step_by(self.names.len());
        Table { points: self.times.iter().zip(values).map(|(t, v)| [*t, *v]).collect(), between }
    }
}

fn not_a_header(headers: &csv::StringRecord) -> String {
    let first = headers.get(0).unwrap_or_default();
    let help = if headers.len() == 1 && first.contains([';', '\t']) {
        "separate the columns by commas, and write decimals with a point"
    } else {
        "the first line names the columns, as in time,slider.velocity"
    };
    format!("line 1: the first column is `{first}`, but must be `time` (in s); {help}")
}

/// Name of the expected file type, for messages.
pub(super) const CSV_FILE: &str = "a CSV file";
const DECIMALS: &str = "; decimals are written with a point";

/// Explains an error of the CSV reader, without the reader's own record number.
fn explained(error: &csv::Error) -> String {
    match error.kind() {
        csv::ErrorKind::UnequalLengths { pos, expected_len, len } => format!(
            "line {}: there are {len} values, but the header has {expected_len}{DECIMALS}",
            pos.as_ref().map_or(0, csv::Position::line)
        ),
        _ => error.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_become_points_over_time() {
        let table = TimeTable::parse("time,\"a\", b\r\n0,1,2\n\n0.5,-3e2,4\n0.5,5,6\n").unwrap();
        assert_eq!(table.names, ["a", "b"]);
        let b = table.column(1, Between::Linear);
        assert_eq!(b.points, [[0.0, 2.0], [0.5, 4.0], [0.5, 6.0]]);
    }

    #[test]
    fn what_is_wrong_is_said_with_its_line_and_column() {
        for (text, words) in [
            ("", "line 1: the first column is ``, but must be `time`"),
            ("t,a\n0,1\n", "line 1: the first column is `t`, but must be `time` (in s)"),
            ("time;a\n0,1;2\n", "separate the columns by commas"),
            ("0,1\n1,2\n", "the first line names the columns"),
            ("time\n0\n", "no column besides `time`"),
            ("time,a,a\n0,1,1\n", "two columns are named `a`"),
            ("time,a,time\n0,1,0\n", "two columns are named `time`"),
            ("time,a,\n0,1,\n", "column 3 has no name"),
            ("time,a\n", "has no rows"),
            ("time,a\n0,1\n1,1 N\n", "line 3, column `a`: `1 N` is not a finite number"),
            ("time,a\n0,1\n1,nan\n", "line 3, column `a`: `nan` is not a finite number"),
            ("time,a\n0,\n", "line 2, column `a`: the value is missing"),
            (
                "time,a\n0,1\n1,5,2\n",
                "line 3: there are 3 values, but the header has 2; decimals are",
            ),
            ("time,a\n0,\"1,5\"\n", "`1,5` is not a finite number; decimals are written with a"),
            ("time,a\n0,1\n2,1\n1,1\n", "line 4: time 1 s comes after 2 s"),
        ] {
            let message = TimeTable::parse(text).unwrap_err();
            assert!(message.contains(words), "{text:?}: {message}");
        }
    }
}
