//! Two instances in one process, which must not affect each other.

use super::experiment::OutputHistory;
use super::library::{Instance, Library};
use super::plan::{Plan, Role};
use super::{ReportedFailure, Subject};
use crate::rules::Rule;

impl Subject<'_> {
    /// Makes two instances that take turns, with other values in one of them, and compares each with a run on its own.
    pub(super) fn instances(&self, library: &Library) -> Result<(), ReportedFailure> {
        let Some(first) = self.reference(library)? else { return Ok(()) };
        let again = self.fresh(library)?;
        if let Some(difference) = self.difference(&first, &again) {
            let message = format!("in the run of the second instance of a process, {difference}");
            self.journal.finding(Rule::InstancesDiffer, &message);
            return Ok(());
        }
        let changed = self.changed(library)?;
        let changed = self.steps(&changed, 0, self.plan.steps)?;
        let one = self.instance(library)?;
        self.initialize(&one)?;
        let other = self.changed(library)?;
        let (mut of_one, mut of_other) = (OutputHistory::new(), OutputHistory::new());
        let middle = self.plan.steps.div_ceil(2);
        for number in 0..middle {
            of_one.extend(self.steps(&one, number, number + 1)?);
            of_other.extend(self.steps(&other, number, number + 1)?);
        }
        self.at("fmi2FreeInstance of one of two instances");
        drop(other);
        of_one.extend(self.steps(&one, middle, self.plan.steps)?);
        let half = changed.len().min(of_other.len());
        let difference = self
            .difference(&first, &of_one)
            .or_else(|| self.difference(&changed[..half], &of_other[..half]));
        if let Some(difference) = difference {
            let message = format!("in the run of two instances that take turns, {difference}");
            self.journal.finding(Rule::InstancesDiffer, &message);
        }
        Ok(())
    }

    /// Makes an initialized instance with other values of inputs and parameters, if the library accepts them.
    fn changed<'a>(&self, library: &'a Library) -> Result<Instance<'a>, ReportedFailure> {
        let instance = self.instance(library)?;
        let Plan { tolerance, start, stop, .. } = self.plan;
        self.at("initialization with other values");
        let set = |is_input: bool| {
            let variables = self.plan.variables.iter().filter(|variable| {
                variable.role.keeps_value() && (variable.role == Role::Input) == is_input
            });
            variables
                .filter_map(|variable| Some((variable.reference, variable.other.as_ref()?)))
                .try_for_each(|(reference, other)| instance.write(reference, other))
        };
        let is_up = instance
            .setup(tolerance, start, stop)
            .and_then(|()| set(false))
            .and_then(|()| instance.enter_initialization())
            .and_then(|()| set(true))
            .and_then(|()| instance.exit_initialization())
            .is_ok();
        if is_up {
            return Ok(instance);
        }
        drop(instance);
        let instance = self.instance(library)?;
        self.initialize(&instance)?;
        Ok(instance)
    }
}
