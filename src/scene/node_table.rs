//! CSV files of nodes: one line for each node, with values under named columns.

/// Largest number of lines of a file.
const MAX_LINES: usize = 100_000;

/// A CSV file of nodes.
pub(super) struct NodeTable {
    /// The lines, in order.
    pub(super) rows: Vec<NodeRow>,
}

/// A line of the file.
pub(super) struct NodeRow {
    /// Number of the line, from 1.
    pub(super) line: u64,
    /// Number of the node.
    pub(super) node: u64,
    /// Text under `on`, if the file has that column and the line has a text there.
    pub(super) on: Option<String>,
    /// Values under the other columns, in the order in which they were asked for.
    values: Vec<Option<f64>>,
}

impl NodeRow {
    /// The value of one column.
    pub(super) fn value(&self, column: usize) -> Option<f64> {
        self.values[column]
    }

    /// The values of three columns, if there are any of them.
    ///
    /// # Errors
    /// Refuses lines with one or two of the three.
    pub(super) fn vector(&self, first: usize, name: &str) -> Result<Option<[f64; 3]>, String> {
        match self.values[first..first + 3] {
            [Some(x), Some(y), Some(z)] => Ok(Some([x, y, z])),
            [None, None, None] => Ok(None),
            _ => Err(format!("line {}: the {name} needs all of its three components", self.line)),
        }
    }
}

impl NodeTable {
    /// Reads the text of a CSV file whose columns are `node`, possibly `on`, and some of `columns`.
    ///
    /// # Errors
    /// Returns the first error in the text, with its line.
    pub(super) fn parse(text: &str, has_on: bool, columns: &[&str]) -> Result<Self, String> {
        let mut reader =
            csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
        let headers = reader.headers().map_err(|error| error.to_string())?.clone();
        let on = if has_on { "node, on, " } else { "node, " };
        let known = format!("{on}{}", columns.join(", "));
        let is_known =
            |name: &str| name == "node" || (has_on && name == "on") || columns.contains(&name);
        if let Some(unknown) = headers.iter().find(|name| !is_known(name)) {
            return Err(format!("line 1: there is no column `{unknown}`; the columns are {known}"));
        }
        let place = |name: &str| headers.iter().position(|header| header == name);
        for (at, name) in headers.iter().enumerate() {
            if place(name) != Some(at) {
                return Err(format!("line 1: two columns are named `{name}`"));
            }
        }
        let Some(node_at) = place("node") else {
            return Err(format!("line 1: the column `node` is missing; the columns are {known}"));
        };
        let (on_at, places) = (place("on"), columns.iter().map(|name| place(name)));
        let places: Vec<Option<usize>> = places.collect();
        let mut rows = Vec::new();
        let mut record = csv::StringRecord::new();
        while reader.read_record(&mut record).map_err(|error| error.to_string())? {
            let line = record.position().map_or(0, csv::Position::line);
            if rows.len() == MAX_LINES {
                return Err(format!("line {line}: there are more than {MAX_LINES} lines"));
            }
            let field = |at: usize| record.get(at).unwrap_or_default();
            let node = field(node_at).parse().map_err(|_| {
                format!(
                    "line {line}, column `node`: `{}` is not the number of a node",
                    field(node_at)
                )
            })?;
            let number = |(at, name): (&Option<usize>, &&str)| match at.map(field) {
                None | Some("") => Ok(None),
                Some(text) => match text.parse() {
                    Ok(value) if f64::is_finite(value) => Ok(Some(value)),
                    _ => Err(format!(
                        "line {line}, column `{name}`: `{text}` is not a finite number"
                    )),
                },
            };
            let values = places.iter().zip(columns).map(number).collect::<Result<Vec<_>, _>>()?;
            let on = on_at.map(field).filter(|text| !text.is_empty()).map(str::to_owned);
            rows.push(NodeRow { line, node, on, values });
        }
        if rows.is_empty() { Err("the table has no rows".to_owned()) } else { Ok(Self { rows }) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_stand_under_their_columns_in_any_order_and_may_be_missing() {
        let text = "gap,node,on,nx,ny,nz\n1e-4,17,disc.3,0,0,1\n,18,,,,\n";
        let table = NodeTable::parse(text, true, &["nx", "ny", "nz", "gap", "friction"]).unwrap();
        let [first, second] = &table.rows[..] else { panic!("two lines") };
        assert_eq!((first.node, first.on.as_deref(), first.line), (17, Some("disc.3"), 2));
        assert_eq!(first.vector(0, "normal"), Ok(Some([0.0, 0.0, 1.0])));
        assert_eq!((first.value(3), first.value(4)), (Some(1e-4), None));
        assert_eq!((second.on.as_deref(), second.vector(0, "normal")), (None, Ok(None)));
    }

    #[test]
    fn what_is_wrong_is_said_with_its_line() {
        let parse = |text| NodeTable::parse(text, false, &["area"]).err().unwrap();
        for (text, words) in [
            ("node,arae\n1,2\n", "line 1: there is no column `arae`; the columns are node, area"),
            ("area\n2\n", "line 1: the column `node` is missing"),
            ("node,node\n1,2\n", "two columns are named `node`"),
            ("node,area\n1.5,2\n", "line 2, column `node`: `1.5` is not the number of a node"),
            ("node,area\n1,2\n2,2 mm\n", "line 3, column `area`: `2 mm` is not a finite number"),
            ("node,area\n", "no rows"),
        ] {
            assert!(parse(text).contains(words), "{}", parse(text));
        }
    }
}
