//! Calls with arrays beside memory that cannot be accessed.

use super::experiment::{by_type, references};
use super::library::{Library, Side, function};
use super::plan::Role;
use super::{ReportedFailure, Subject};
use crate::description::Kind;
use crate::rules::Rule;

impl Subject<'_> {
    /// Reads all variables and sets all Real inputs with arrays that nothing may leave.
    pub(super) fn arrays(&self, library: &Library) -> Result<(), ReportedFailure> {
        let instance = self.instance(library)?;
        self.initialize(&instance)?;
        for side in [Side::End, Side::Begin] {
            let place = match side {
                Side::End => "end",
                Side::Begin => "begin",
            };
            let stage = |call: &str| {
                format!(
                    "{call} with arrays that {place} at memory without access; the caller's references and values to set can only be read"
                )
            };
            for variables in by_type(&self.plan.variables) {
                let kind = variables[0].kind;
                let call = function("Get", kind);
                self.at_risk(Rule::ArrayBounds, &stage(&call));
                // What cannot be read is reported where all variables are read.
                let _ = instance.read_guarded(kind, &references(variables), side);
            }
            let inputs = self
                .plan
                .variables
                .iter()
                .filter(|variable| variable.role == Role::Input && variable.kind == Kind::Real);
            let (references, values): (Vec<u32>, Vec<f64>) = inputs
                .filter_map(|input| Some((input.reference, input.start.as_ref()?.real()?)))
                .unzip();
            if !references.is_empty() {
                self.at_risk(Rule::ArrayBounds, &stage("fmi2SetReal"));
                let _ = instance.write_guarded(&references, &values, side);
            }
        }
        Ok(())
    }
}
