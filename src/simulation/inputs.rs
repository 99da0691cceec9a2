//! Inputs over time from a CSV file, given as an importer gives them: set before each communication
//! step and held over it.

use super::{Simulation, Variable, assign, variables};
use crate::Error;
use crate::scene::{Between, Scene, Table, TimeTable, meant_input};
use crate::simulation::catalogue::Causality;
use std::path::Path;

/// Two times that differ by this part of themselves are one, as FMPy has it.
const CLOSE: f64 = 1e-9;

/// The inputs of one scene over time.
pub struct Inputs {
    columns: Vec<(Variable, Table)>,
    /// Where values jump, s, in ascending order.
    jumps: Vec<f64>,
}

impl Inputs {
    /// Reads a CSV file: `time`, then columns named after inputs of the scene; linear between rows.
    ///
    /// # Errors
    /// The file cannot be read, a line makes no sense, or a column is no input of the scene.
    pub fn read(path: &Path, scene: &Scene) -> Result<Self, Error> {
        let table = TimeTable::read(path)?;
        let mut inputs = variables(scene);
        inputs.retain(|variable| variable.template.causality == Causality::Input);
        let mut columns = Vec::new();
        for (i, name) in table.names.iter().enumerate() {
            let Some(variable) = inputs.iter().find(|input| input.name == *name) else {
                return Err(Error::argument(format!(
                    "column `{name}` of {} is no input of {}; {}",
                    path.display(),
                    scene.name,
                    meant_input(name, &scene.input_names())
                )));
            };
            columns.push((variable.clone(), table.column(i, Between::Linear)));
        }
        // The times are the same in every column.
        let jumps = columns.first().map_or_else(Vec::new, |(_, table)| table.jumps().collect());
        Ok(Self { columns, jumps })
    }

    /// Gives the scene the values that the run starts with, at time `t` (s).
    ///
    /// # Errors
    /// An impossible value.
    pub fn assign(&self, scene: &mut Scene, t: f64) -> Result<(), Error> {
        self.columns.iter().try_for_each(|(input, table)| {
            assign(scene, &input.name, table.at(self.after_jump(t))).map_err(|e| at(t, &e))
        })
    }

    /// Gives the simulation the values for a step that begins at time `t` (s).
    ///
    /// # Errors
    /// An impossible value.
    pub fn write(&self, simulation: &mut Simulation, t: f64) -> Result<(), Error> {
        self.columns.iter().try_for_each(|(input, table)| {
            simulation.write(input, table.at(self.after_jump(t))).map_err(|e| at(t, &e))
        })
    }

    /// The first time after `t` (s) at which a value jumps, and where a communication step therefore
    /// has to end.
    #[must_use]
    pub fn next_jump(&self, t: f64) -> f64 {
        let is_later = |jump: &&f64| **jump > t && !is_close(**jump, t);
        self.jumps.iter().find(is_later).copied().unwrap_or(f64::INFINITY)
    }

    /// The time itself or, if rounding errors have left it just before a jump, the jump's.
    fn after_jump(&self, t: f64) -> f64 {
        let near = self.jumps.iter().find(|jump| is_close(**jump, t));
        near.map_or(t, |jump| f64::max(t, *jump))
    }
}

/// Are two times one but for rounding errors?
#[must_use]
pub fn is_close(a: f64, b: f64) -> bool {
    (a - b).abs() <= CLOSE * f64::max(a.abs(), b.abs())
}

fn at(t: f64, error: &Error) -> Error {
    Error::step(format!("with the inputs at {t} s, {error}"))
}
