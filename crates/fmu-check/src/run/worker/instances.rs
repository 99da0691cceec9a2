//! Two instances in one process, which must not affect each other.

use super::experiment::{OutputHistory, by_type};
use super::library::{Instance, Library, Refused, Value};
use super::plan::{Plan, Role, Variable};
use super::variables::others;
use super::{Ended, Subject};
use crate::rules::Rule;

impl Subject<'_> {
    /// Makes two instances that take turns, with other values in one of them, and compares each with a run on its own.
    pub(super) fn instances(&self, library: &Library) -> Result<(), Ended> {
        let Some(first) = self.reference(library)? else { return Ok(()) };
        let again = self.fresh(library)?;
        if let Some(difference) = self.difference(&first, &again, Value::is_same) {
            let message = format!("in the run of the second instance of a process, {difference}");
            self.journal.finding(Rule::InstancesDiffer, &message);
            return Ok(());
        }
        // A library may refuse values, if only in a step.
        let accepts = self.accepts_other_values(library)?;
        let alone = self.initialized(library, accepts)?;
        let alone = self.steps(&alone, 0, self.plan.steps)?;
        let one = self.initialized(library, false)?;
        let other = self.initialized(library, accepts)?;
        let (mut of_one, mut of_other) = (OutputHistory::new(), OutputHistory::new());
        let middle = self.plan.steps.div_ceil(2);
        for number in 0..middle {
            of_one.extend(self.steps(&one, number, number + 1)?);
            of_other.extend(self.steps(&other, number, number + 1)?);
        }
        self.at("fmi2FreeInstance of one of two instances");
        drop(other);
        of_one.extend(self.steps(&one, middle, self.plan.steps)?);
        let difference = self
            .difference(&first, &of_one, Value::is_same)
            .or_else(|| self.difference(&alone, &of_other, Value::is_same));
        if let Some(difference) = difference {
            let message = format!("in the run of two instances that take turns, {difference}");
            self.journal.finding(Rule::InstancesDiffer, &message);
        }
        Ok(())
    }

    /// `true` if a whole run with other values of inputs and parameters succeeds.
    fn accepts_other_values(&self, library: &Library) -> Result<bool, Ended> {
        let instance = self.instance(library)?;
        self.at("a run with other values of inputs and parameters");
        let mut steps = 0..self.plan.steps;
        let run = self.initialize_with(&instance, true).and_then(|()| {
            steps.try_for_each(|number| instance.step(self.time(number), self.plan.step))
        });
        Ok(run.is_ok())
    }

    /// Makes an initialized instance, with other values of inputs and parameters or without.
    fn initialized<'a>(
        &self,
        library: &'a Library,
        with_others: bool,
    ) -> Result<Instance<'a>, Ended> {
        let instance = self.instance(library)?;
        self.at("initialization of an instance");
        let up = self.initialize_with(&instance, with_others);
        self.called("the initialization of an instance", up).map(|()| instance)
    }

    /// Initializes an instance, with other values of inputs and parameters or without.
    pub(super) fn initialize_with(
        &self,
        instance: &Instance<'_>,
        with_others: bool,
    ) -> Result<(), Refused> {
        let Plan { tolerance, start, stop, .. } = self.plan;
        let set = |is_input: bool| {
            let is_set = |variable: &&Variable| {
                with_others
                    && variable.role.keeps_value()
                    && (variable.role == Role::Input) == is_input
            };
            let variables: Vec<_> = self.plan.variables.iter().filter(is_set).cloned().collect();
            by_type(&variables).try_for_each(|variables| instance.write(&others(variables)))
        };
        instance.setup(tolerance, start, stop)?;
        set(false)?;
        instance.enter_initialization()?;
        set(true)?;
        instance.exit_initialization()
    }
}
