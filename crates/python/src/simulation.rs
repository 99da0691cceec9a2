//! A motion that is advanced step by step.

use crate::array::reals;
use crate::errors::{Error, raised};
use crate::run::no_variable;
use crate::scene::Scene;
use amontons::simulation::{Parameters, Progress, Snapshot, Variable, variables};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::ops::ControlFlow;
use std::sync::{Mutex, MutexGuard, TryLockError};

/// The beginning of a saved state. What follows depends on the version.
const MARK: &[u8] = concat!("amontons ", env!("CARGO_PKG_VERSION"), "\n").as_bytes();

/// A scene in motion. One thread uses it at a time.
#[pyclass(frozen, module = "amontons._core")]
pub struct Simulation {
    /// Identity of the scene, to which saved states belong.
    identity: String,
    /// All variables by their names.
    variables: HashMap<String, Variable>,
    /// `None` after a step that failed or was interrupted.
    running: Mutex<Option<amontons::simulation::Simulation>>,
}

/// Content of a saved state: the identity of the scene, all values that can be set, and the motion.
#[derive(Serialize, Deserialize)]
struct Saved {
    identity: String,
    values: Vec<f64>,
    progress: Progress,
}

impl Simulation {
    /// Does something short with the running simulation.
    fn with<T>(
        &self,
        work: impl FnOnce(&mut amontons::simulation::Simulation) -> PyResult<T>,
    ) -> PyResult<T> {
        work(self.slot()?.as_mut().ok_or_else(lost)?)
    }

    /// The place of the simulation. Nobody waits for it: who waited with the interpreter's lock would keep the thread that
    /// has the place from ever taking that lock.
    fn slot(&self) -> PyResult<MutexGuard<'_, Option<amontons::simulation::Simulation>>> {
        match self.running.try_lock() {
            Ok(running) => Ok(running),
            Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => Err(Error::new_err(
                "this simulation is in use by another thread; give each thread a simulation of its own",
            )),
        }
    }

    fn variable(&self, name: &str) -> PyResult<&Variable> {
        self.variables
            .get(name)
            .ok_or_else(|| raised(no_variable(name, self.variables.keys().map(String::as_str))))
    }
}

fn lost() -> PyErr {
    Error::new_err(
        "this simulation has failed or was interrupted within a step, so its motion is lost; restore a saved state, or \
         make a new one",
    )
}

#[pymethods]
impl Simulation {
    #[new]
    fn new(py: Python<'_>, scene: &Scene, identity: String, start_time: f64) -> PyResult<Self> {
        if !start_time.is_finite() {
            let error = format!("a simulation cannot start at {start_time} s; give a finite time");
            return Err(raised(amontons::Error::argument(error)));
        }
        let made =
            py.detach(|| amontons::simulation::Simulation::new(scene.resolved(), start_time));
        let named =
            variables(&scene.scene).into_iter().map(|variable| (variable.name.clone(), variable));
        Ok(Self {
            identity,
            variables: named.collect(),
            running: Mutex::new(Some(made.map_err(raised)?)),
        })
    }

    #[getter]
    fn time(&self) -> PyResult<f64> {
        self.with(|simulation| Ok(simulation.time()))
    }

    #[getter]
    fn step(&self) -> PyResult<f64> {
        self.with(|simulation| Ok(simulation.scene().step))
    }

    /// Advances to a time, s.
    fn advance_to(&self, py: Python<'_>, time: f64) -> PyResult<()> {
        let running = &mut *self.slot()?;
        py.detach(|| {
            let simulation = running.as_mut().ok_or_else(lost)?;
            let mut interrupted = None;
            let go_on = || match Python::attach(|py| py.check_signals()) {
                Ok(()) => ControlFlow::Continue(()),
                Err(error) => {
                    interrupted = Some(error);
                    ControlFlow::Break(())
                }
            };
            simulation.check_reachable(time).map_err(raised)?;
            let advanced = simulation.advance_while(time, go_on);
            if interrupted.is_some() || advanced.is_err() {
                *running = None;
            }
            match interrupted {
                Some(error) => Err(error),
                None => advanced.map(|_| ()).map_err(raised),
            }
        })
    }

    /// The value of a variable.
    fn read(&self, name: &str) -> PyResult<f64> {
        let variable = self.variable(name)?;
        self.with(|simulation| simulation.read(variable).map_err(raised))
    }

    /// The values of variables.
    #[allow(clippy::needless_pass_by_value)]
    fn read_all<'py>(&self, py: Python<'py>, names: Vec<String>) -> PyResult<Bound<'py, PyAny>> {
        let variables: Vec<&Variable> =
            names.iter().map(|name| self.variable(name)).collect::<PyResult<_>>()?;
        let values: Vec<f64> = self.with(|simulation| {
            variables
                .into_iter()
                .map(|variable| simulation.read(variable).map_err(raised))
                .collect()
        })?;
        reals(py, values.into_iter())
    }

    /// Gives an input or a tunable parameter another value from now on.
    fn set(&self, name: &str, value: f64) -> PyResult<()> {
        let variable = self.variable(name)?;
        self.with(|simulation| simulation.write(variable, value).map_err(raised))
    }

    /// Displacements from the equilibrium (m) and velocities (m/s), one for each degree of freedom.
    fn motion<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let two = self.with(|simulation| {
            Ok([simulation.displacement().to_vec(), simulation.velocity().to_vec()])
        })?;
        let [displacement, velocity] = two.map(|values| reals(py, values.into_iter()));
        Ok((displacement?, velocity?))
    }

    /// The states of the contacts, as the paper writes them.
    fn contact_states(&self) -> PyResult<Vec<String>> {
        self.with(|simulation| {
            Ok(simulation.contact_states().iter().map(ToString::to_string).collect())
        })
    }

    /// All that the simulation needs to continue from here.
    fn save<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = self.with(|simulation| {
            let values = simulation.nominal().iter().map(|(_, value)| value).collect();
            let progress = simulation.save().into_progress();
            let saved = Saved { identity: self.identity.clone(), values, progress };
            let content = postcard::to_stdvec(&saved).expect("a vector takes all bytes");
            Ok([MARK, &crc32fast::hash(&content).to_le_bytes(), &*content].concat())
        })?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Continues from a saved state of this scene.
    fn restore(&self, scene: &Scene, state: &[u8]) -> PyResult<()> {
        let wrong = |why: &str| Error::new_err(format!("the saved state {why}"));
        let Some((checksum, content)) =
            state.strip_prefix(MARK).and_then(|state| state.split_at_checked(size_of::<u32>()))
        else {
            return Err(wrong("is damaged, or was written by another version of Amontons"));
        };
        if crc32fast::hash(content).to_le_bytes() != checksum {
            return Err(wrong("is damaged"));
        }
        let Ok(saved) = postcard::from_bytes::<Saved>(content) else {
            return Err(wrong("is damaged"));
        };
        if saved.identity != self.identity {
            return Err(wrong(
                "belongs to another scene, or to one with other values or another integrator",
            ));
        }
        let mut nominal = Parameters::of(scene.resolved());
        let variables: Vec<Variable> =
            nominal.iter().map(|(variable, _)| variable.clone()).collect();
        if variables.len() != saved.values.len() {
            return Err(wrong("belongs to another scene"));
        }
        for (variable, value) in variables.iter().zip(saved.values) {
            nominal.set(variable, value).map_err(raised)?;
        }
        let snapshot = Snapshot::new(nominal, saved.progress);
        let resumed = amontons::simulation::Simulation::resume(snapshot).map_err(raised)?;
        *self.slot()? = Some(resumed);
        Ok(())
    }
}
