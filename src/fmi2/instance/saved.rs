//! Saved instances, in memory and as bytes.

use super::{Instance, check_experiment};
use crate::Error;
use crate::fmi2::lifecycle::Phase;
use crate::scene::Scene;
use crate::simulation::catalogue::Per;
use crate::simulation::{
    Given, Progress, Simulation, Snapshot, Variable, check_rate, from_bytes, to_bytes,
};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::sync::Arc;

/// A saved instance.
#[derive(Clone)]
pub(in crate::fmi2) struct SavedInstance {
    /// Of the FMU that it belongs to.
    guid: Arc<str>,
    phase: Phase,
    start_time: f64,
    stop_time: Option<f64>,
    rates: Vec<(usize, f64)>,
    is_experiment_set_up: bool,
    strict: bool,
    values: Values,
}

#[derive(Clone)]
enum Values {
    BeforeStart(Box<Scene>),
    Running(Box<Snapshot>),
}

impl Values {
    fn scene(&self) -> &Scene {
        match self {
            Self::BeforeStart(scene) => scene,
            Self::Running(snapshot) => snapshot.scene(),
        }
    }
}

/// What bytes hold of a saved instance.
#[derive(Serialize, Deserialize)]
struct Record<'a> {
    phase: Phase,
    start_time: f64,
    stop_time: Option<f64>,
    rates: Cow<'a, [(usize, f64)]>,
    is_experiment_set_up: bool,
    strict: bool,
    given: Given,
    /// Of one that runs.
    progress: Option<Cow<'a, Progress>>,
}

impl Record<'_> {
    /// Refuses a phase without what belongs to it, and times that no experiment has.
    fn check(&self) -> Result<(), Error> {
        let is_possible = match self.phase {
            Phase::Instantiated | Phase::InitializationMode => self.progress.is_none(),
            Phase::StepComplete | Phase::Terminated => self.progress.is_some(),
            Phase::Error => true,
            Phase::Poisoned => false,
        };
        if !is_possible {
            return Err(Error::saved_state(format!(
                "the saved state contradicts itself: phase {:?} {} a motion",
                self.phase,
                if self.progress.is_some() { "with" } else { "without" }
            )));
        }
        check_experiment(self.start_time, self.stop_time)
            .map_err(|error| Error::saved_state(format!("in the saved state {error}")))
    }
}

impl Instance {
    pub(in crate::fmi2) fn save(&self) -> SavedInstance {
        SavedInstance {
            guid: Arc::clone(&self.guid),
            phase: self.phase,
            start_time: self.start_time,
            stop_time: self.stop_time,
            rates: self.rates.clone(),
            is_experiment_set_up: self.is_experiment_set_up,
            strict: self.strict,
            values: match self.simulation.as_ref().filter(|_| self.has_started) {
                Some(simulation) => Values::Running(Box::new(simulation.save())),
                None => Values::BeforeStart(Box::new(self.scene.clone())),
            },
        }
    }

    /// The variables but for the FMU's own.
    fn variables_of_scene(&self) -> &[Variable] {
        let own = self.variables.iter().rev().take_while(|own| own.template.per == Per::Fmu);
        &self.variables[..self.variables.len() - own.count()]
    }

    /// A saved instance as bytes.
    pub(in crate::fmi2) fn serialize(&self, saved: &SavedInstance) -> Result<Vec<u8>, Error> {
        let scene = saved.values.scene();
        self.check_owner(saved)?;
        let record = Record {
            phase: saved.phase,
            start_time: saved.start_time,
            stop_time: saved.stop_time,
            rates: Cow::Borrowed(&saved.rates),
            is_experiment_set_up: saved.is_experiment_set_up,
            strict: saved.strict,
            given: Given::of(scene, self.variables_of_scene()),
            progress: match &saved.values {
                Values::BeforeStart(_) => None,
                Values::Running(snapshot) => Some(Cow::Borrowed(snapshot.progress())),
            },
        };
        Ok(to_bytes(&record, &self.guid))
    }

    /// A saved instance from its bytes.
    pub(in crate::fmi2) fn deserialize(&self, bytes: &[u8]) -> Result<SavedInstance, Error> {
        let record: Record<'_> = from_bytes(bytes, &self.guid)?;
        for &(place, rate) in &*record.rates {
            let variable = self.variables.get(place);
            let variable =
                variable.ok_or_else(|| Error::saved_state("a rate is of no variable"))?;
            check_rate(variable, rate)?;
        }
        record.check()?;
        let scene = record.given.put_into(&self.original, self.variables_of_scene())?;
        let failed = record.phase == Phase::Error;
        let saved = SavedInstance {
            guid: Arc::clone(&self.guid),
            phase: record.phase,
            start_time: record.start_time,
            stop_time: record.stop_time,
            rates: record.rates.into_owned(),
            is_experiment_set_up: record.is_experiment_set_up,
            strict: record.strict,
            values: match record.progress {
                None => Values::BeforeStart(Box::new(scene)),
                Some(progress) => {
                    Values::Running(Box::new(Snapshot::new(scene, progress.into_owned())))
                }
            },
        };
        if let Values::Running(snapshot) = &saved.values {
            snapshot.check(self.variables_of_scene(), failed)?;
        }
        Ok(saved)
    }

    pub(in crate::fmi2) fn restore(&mut self, saved: &SavedInstance) -> Result<(), Error> {
        self.check_owner(saved)?;
        match &saved.values {
            Values::BeforeStart(scene) => {
                self.scene.clone_from(&**scene);
                self.simulation = None;
            }
            Values::Running(snapshot) => match &mut self.simulation {
                Some(simulation) => simulation.restore(snapshot)?,
                None => self.simulation = Some(Simulation::resume((**snapshot).clone())?),
            },
        }
        self.has_started = matches!(saved.values, Values::Running(_));
        self.phase = saved.phase;
        self.is_experiment_set_up = saved.is_experiment_set_up;
        self.strict = saved.strict;
        self.start_time = saved.start_time;
        self.stop_time = saved.stop_time;
        self.rates.clone_from(&saved.rates);
        Ok(())
    }

    /// Refuses the state of another FMU.
    fn check_owner(&self, saved: &SavedInstance) -> Result<(), Error> {
        if saved.guid == self.guid {
            debug_assert!(saved.values.scene().has_parts_of(&self.original));
            return Ok(());
        }
        Err(Error::saved_state("the saved state is of another FMU"))
    }
}

#[cfg(test)]
mod tests;
