//! Calls with arrays beside memory that cannot be accessed.

use super::experiment::{by_type, references};
use super::library::{Library, Side, function};
use super::plan::{Role, Variable};
use super::{Ended, Subject};
use crate::rules::Rule;

impl Subject<'_> {
    /// Reads all variables, then sets all inputs but strings, with arrays that nothing may leave.
    pub(super) fn arrays(&self, library: &Library) -> Result<(), Ended> {
        let instance = self.instance(library)?;
        self.initialize(&instance)?;
        let at = |call: &str, side: Side| {
            let place = match side {
                Side::Begin => "begin",
                Side::End => "end",
            };
            let stage = format!(
                "{call} with arrays that {place} at memory without access; the host's references and values to set can only be read"
            );
            self.at_risk(Rule::ArrayBounds, &stage);
        };
        let sides = [Side::End, Side::Begin];
        for variables in by_type(&self.plan.variables) {
            for side in sides {
                let (kind, call) = (variables[0].kind, function("Get", variables[0].kind));
                at(&call, side);
                let read = instance.read_guarded(kind, &references(variables), side);
                // Where all variables are read, the reason is reported.
                read.map_err(|_| Ended::Failed)?;
            }
        }
        let is_set =
            |variable: &&Variable| variable.role == Role::Input && variable.start.is_some();
        let inputs: Vec<Variable> = self.plan.variables.iter().filter(is_set).cloned().collect();
        for inputs in by_type(&inputs) {
            let values: Vec<_> = inputs
                .iter()
                .filter_map(|input| Some((input.reference, input.start.as_ref()?)))
                .collect();
            for side in sides {
                let (kind, call) = (inputs[0].kind, function("Set", inputs[0].kind));
                at(&call, side);
                self.called(&call, instance.write_guarded(kind, &values, side))?;
            }
        }
        Ok(())
    }
}
