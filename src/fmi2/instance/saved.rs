//! Saved instances, in memory and as bytes.

use super::{Instance, Setup, check_experiment};
use crate::Error;
use crate::fmi2::lifecycle::Phase;
use crate::simulation::{
    ParameterValues, Parameters, Progress, Simulation, Snapshot, check_rate, from_bytes, to_bytes,
};
use std::sync::Arc;

/// A saved instance.
#[derive(Clone)]
pub(in crate::fmi2) struct SavedInstance {
    /// Fingerprint of the FMU to which the saved instance belongs.
    guid: Arc<str>,
    setup: Setup,
    run: SavedRun,
}

#[derive(Clone)]
enum SavedRun {
    BeforeStart(Box<Parameters>),
    Running(Box<Snapshot>),
}

/// Content of a saved instance's bytes: its setup, its nominal values and, if it runs, its progress.
type Record = (Setup, ParameterValues, Option<Progress>);

/// Refuses a phase that contradicts the presence or absence of a motion, and times that no experiment has.
fn check(setup: &Setup, has_motion: bool) -> Result<(), Error> {
    let is_possible = match setup.phase {
        Phase::Instantiated | Phase::InitializationMode => !has_motion,
        Phase::StepComplete | Phase::Terminated => has_motion,
        Phase::Error => true,
        Phase::Poisoned => false,
    };
    if !is_possible {
        return Err(Error::saved_state(format!(
            "the saved state contradicts itself: phase {:?} {} a motion",
            setup.phase,
            if has_motion { "with" } else { "without" }
        )));
    }
    check_experiment(setup.start_time, setup.stop_time)
        .map_err(|error| Error::saved_state(format!("in the saved state, {error}")))
}

impl Instance {
    pub(in crate::fmi2) fn save(&self) -> SavedInstance {
        SavedInstance {
            guid: Arc::clone(&self.guid),
            setup: self.setup.clone(),
            run: match self.simulation.as_ref().filter(|_| self.has_started) {
                Some(simulation) => SavedRun::Running(Box::new(simulation.save())),
                None => SavedRun::BeforeStart(Box::new(self.parameters.clone())),
            },
        }
    }

    /// Writes a saved instance as bytes.
    pub(in crate::fmi2) fn serialize(&self, saved: &SavedInstance) -> Result<Vec<u8>, Error> {
        self.check_owner(saved)?;
        let (parameters, progress) = match &saved.run {
            SavedRun::BeforeStart(parameters) => (&**parameters, None),
            SavedRun::Running(snapshot) => (snapshot.nominal(), Some(snapshot.progress())),
        };
        Ok(to_bytes(&(&saved.setup, parameters.values(), progress), &self.guid))
    }

    /// Reads a saved instance from its bytes.
    pub(in crate::fmi2) fn deserialize(&self, bytes: &[u8]) -> Result<SavedInstance, Error> {
        let (setup, values, progress): Record = from_bytes(bytes, &self.guid)?;
        for &(place, rate) in &setup.rates {
            let variable = self.variables.get(place);
            let variable = variable.ok_or_else(|| {
                Error::saved_state("the saved state has a rate of a variable that does not exist")
            })?;
            check_rate(variable, rate)?;
        }
        check(&setup, progress.is_some())?;
        let parameters = self.original.with_values(values)?;
        let run = match progress {
            None => SavedRun::BeforeStart(Box::new(parameters)),
            Some(progress) => {
                let snapshot = Snapshot::new(parameters, progress);
                snapshot.check(setup.phase == Phase::Error)?;
                SavedRun::Running(Box::new(snapshot))
            }
        };
        Ok(SavedInstance { guid: Arc::clone(&self.guid), setup, run })
    }

    pub(in crate::fmi2) fn restore(&mut self, saved: &SavedInstance) -> Result<(), Error> {
        self.check_owner(saved)?;
        match &saved.run {
            SavedRun::BeforeStart(parameters) => {
                self.parameters.clone_from(parameters);
                self.simulation = None;
            }
            SavedRun::Running(snapshot) => match &mut self.simulation {
                Some(simulation) => simulation.restore(snapshot)?,
                None => self.simulation = Some(Simulation::resume((**snapshot).clone())?),
            },
        }
        self.has_started = matches!(saved.run, SavedRun::Running(_));
        self.setup.clone_from(&saved.setup);
        Ok(())
    }

    /// Refuses the saved state of another FMU.
    fn check_owner(&self, saved: &SavedInstance) -> Result<(), Error> {
        if saved.guid == self.guid {
            return Ok(());
        }
        Err(Error::saved_state("the saved state belongs to another FMU"))
    }
}

#[cfg(test)]
mod tests;
