//! Inputs over time from a CSV file, given as an importer gives them: set before each communication
//! step and held over it.

use crate::assign::assign;
use amontons::Error;
use amontons::error::Short;
use amontons::scene::{Between, MissingFeature, Scene, Table, TimeTable, meant_input};
use amontons::simulation::catalogue::Causality;
use amontons::simulation::{Simulation, Variable, variables};
use std::path::Path;

/// Two times that differ by this part of themselves are one, as FMPy has it.
const CLOSE: f64 = 1e-9;

/// The inputs of one scene over time.
pub struct Inputs {
    columns: Vec<(Variable, Table)>,
    /// Times at which values jump, s, in ascending order.
    jumps: Vec<f64>,
}

impl Inputs {
    /// Reads a CSV file: `time`, then columns named after inputs of the scene; linear between rows.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read, a line is invalid, or a column is no input of the scene.
    pub fn read(path: &Path, scene: &Scene) -> Result<Self, Error> {
        let table = TimeTable::read(path)?;
        let mut inputs = variables(scene);
        inputs.retain(|variable| variable.causality == Causality::Input);
        let mut columns = Vec::new();
        for (i, name) in table.names.iter().enumerate() {
            let Some(variable) = inputs.iter().find(|input| input.name == *name) else {
                let help = match scene.explain_missing_input(name) {
                    Some(MissingFeature { reason, help }) => format!("{reason}; {help}"),
                    None => meant_input(name, &scene.input_names()),
                };
                let (path, scene) = (path.display(), &scene.name);
                return Err(Error::argument(format!(
                    "column `{name}` of {path} is not an input of {scene}; {help}"
                )));
            };
            columns.push((variable.clone(), table.column(i, Between::Linear)));
        }
        // The times are the same in every column.
        let jumps = columns.first().map_or_else(Vec::new, |(_, table)| table.jumps().collect());
        Ok(Self { columns, jumps })
    }

    /// The names of the inputs that it gives.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().map(|(input, _)| &*input.name)
    }

    /// Gives the scene the values that the run starts with, at time `t` (s).
    ///
    /// # Errors
    /// Returns an error if a value is impossible.
    pub fn assign(&self, scene: &mut Scene, t: f64) -> Result<(), Error> {
        self.columns.iter().try_for_each(|(input, table)| {
            assign(scene, &input.name, self.value(table, t)).map_err(|e| at(t, &e))
        })
    }

    /// Gives the simulation the values for a step that begins at time `t` (s).
    ///
    /// # Errors
    /// Returns an error if a value is impossible.
    pub fn write(&self, simulation: &mut Simulation, t: f64) -> Result<(), Error> {
        self.columns.iter().try_for_each(|(input, table)| {
            simulation.write(input, self.value(table, t)).map_err(|e| at(t, &e))
        })
    }

    /// The first time after `t` (s) at which a value jumps, and where a communication step therefore
    /// has to end.
    #[must_use]
    pub fn next_jump(&self, t: f64) -> f64 {
        let past = self.jumps.partition_point(|jump| *jump <= t || is_close(*jump, t));
        self.jumps.get(past).copied().unwrap_or(f64::INFINITY)
    }

    /// A column's value at time `t` (s): up to the first row that row's, and behind a jump that rounding
    /// errors have left the time just before.
    fn value(&self, table: &Table, t: f64) -> f64 {
        if let Some([_, first]) = table.points.first().filter(|[start, _]| t <= *start) {
            return *first;
        }
        let next = self.jumps.get(self.jumps.partition_point(|jump| *jump < t));
        let reached = next.filter(|jump| is_close(**jump, t)).map_or(t, |jump| f64::max(t, *jump));
        table.at(reached, 0.0)
    }
}

/// `true` if two times are equal but for rounding errors.
#[must_use]
pub fn is_close(a: f64, b: f64) -> bool {
    (a - b).abs() <= CLOSE * f64::max(a.abs(), b.abs())
}

fn at(t: f64, error: &Error) -> Error {
    Error::step(format!("with the inputs at {} s, {error}", Short(t)))
}
