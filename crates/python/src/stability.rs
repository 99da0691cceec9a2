//! Stability of contact states: eigenvalues, loci, candidates, verdicts.

use crate::array::{complexes, reals};
use crate::errors::raised;
use crate::interrupt::watched;
use crate::scene::Scene;
use amontons::Error;
use amontons::contact::{ContactState, JoinedStates};
use amontons::simulation::at_instant;
use amontons::stability::Spectrum;
use amontons_analysis::assign::assign;
use amontons_analysis::instant::{require_undriven, signals_left_out};
use amontons_analysis::stability::candidates::bistability;
use amontons_analysis::stability::locus as loci;
use amontons_analysis::stability::{Linearised, StateClasses, map, named_states};
use amontons_analysis::sweep::FRICTION;
use nalgebra::Complex;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::borrow::Cow;

/// Refuses an instant that is no time.
pub fn check_instant(at: f64) -> Result<(), Error> {
    if at.is_finite() {
        Ok(())
    } else {
        Err(Error::argument(format!("at = {at} is no time; give seconds")))
    }
}

/// The scene with another value of a parameter at time `at` (s), as eigenvalues need it.
fn changed(scene: &Scene, (name, value): (&str, f64), at: f64) -> Result<Linearised, Error> {
    let mut changed = scene.scene.clone();
    assign(&mut changed, name, value)?;
    let changed = at_instant(&changed, at)?;
    changed.check()?;
    Ok(Linearised::of(&changed))
}

/// The scene with this friction coefficient at time `at` (s), as eigenvalues need it.
fn linearised(scene: &Scene, friction: Option<f64>, at: f64) -> Result<Cow<'_, Linearised>, Error> {
    check_instant(at)?;
    match friction {
        Some(friction) => {
            require_undriven(&scene.scene, FRICTION)?;
            changed(scene, (FRICTION, friction), at).map(Cow::Owned)
        }
        None if scene.scene.signals.is_empty() => Ok(Cow::Borrowed(scene.linearised())),
        None => {
            let here = at_instant(&scene.scene, at)?;
            here.check()?;
            Ok(Cow::Owned(Linearised::of(&here)))
        }
    }
}

/// The contact state of this name, or uniform sliding.
fn states_of(
    name: Option<&str>,
    scene: &Scene,
    here: &Linearised,
) -> Result<Vec<ContactState>, Error> {
    match name {
        Some(name) => named_states(name, &scene.scene, here),
        None => here.uniform_sliding(),
    }
}

fn all(spectrum: Spectrum) -> Vec<Complex<f64>> {
    let real = spectrum.real.into_iter().map(|value| Complex::new(value, 0.0));
    spectrum.oscillating.into_iter().chain(real).collect()
}

/// Eigenvalues of a contact state, 1/s: those with a positive imaginary part by frequency, then the real ones.
#[pyfunction]
#[pyo3(signature = (scene, state=None, friction=None, at=0.0))]
pub fn eigenvalues<'py>(
    py: Python<'py>,
    scene: &Scene,
    state: Option<&str>,
    friction: Option<f64>,
    at: f64,
) -> PyResult<Bound<'py, PyAny>> {
    let found = py.detach(|| {
        let here = linearised(scene, friction, at)?;
        let states = states_of(state, scene, &here)?;
        Spectrum::of(here.linear()?, &states)
    });
    complexes(py, &all(found.map_err(raised)?))
}

/// Eigenvalues of a contact state, 1/s, and the shapes of their modes, one row for each mode.
#[pyfunction]
#[pyo3(signature = (scene, state=None, friction=None, at=0.0))]
pub fn modes<'py>(
    py: Python<'py>,
    scene: &Scene,
    state: Option<&str>,
    friction: Option<f64>,
    at: f64,
) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
    let (values, shapes, dofs) = py
        .detach(|| {
            let here = linearised(scene, friction, at)?;
            let states = states_of(state, scene, &here)?;
            let found = amontons_analysis::stability::modes(here.linear()?, &states)?;
            let values: Vec<_> = found.all().map(|mode| mode.eigenvalue).collect();
            let shapes: Vec<_> = found.all().flat_map(|mode| mode.shape.iter().copied()).collect();
            Ok((values, shapes, here.model().dofs()))
        })
        .map_err(raised)?;
    let shape = [values.len(), dofs];
    let shapes = complexes(py, &shapes)?.call_method1("reshape", (shape,))?;
    Ok((complexes(py, &values)?, shapes))
}

/// All contact states with their eigenvalues, 1/s.
#[pyfunction]
#[pyo3(signature = (scene, friction=None, at=0.0, progress=None))]
#[allow(clippy::needless_pass_by_value)]
pub fn states<'py>(
    py: Python<'py>,
    scene: &Scene,
    friction: Option<f64>,
    at: f64,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<Vec<(String, Bound<'py, PyAny>)>> {
    let found = watched(py, progress.as_ref(), |watch| {
        let here = linearised(scene, friction, at)?;
        let classes = StateClasses::of(here.model())?;
        let spectra = classes.spectra(here.linear()?, watch)?;
        let found = classes
            .states
            .iter()
            .map(|(states, class)| (JoinedStates(states).to_string(), spectra[*class].clone()));
        Ok(found.collect::<Vec<_>>())
    })?
    .map_err(raised)?;
    found.into_iter().map(|(name, spectrum)| Ok((name, complexes(py, &all(spectrum))?))).collect()
}

/// Modes of a contact state followed over the values of a parameter.
#[pyfunction]
#[pyo3(signature = (scene, name, values, state=None, at=0.0, progress=None))]
#[allow(clippy::needless_pass_by_value)]
pub fn locus<'py>(
    py: Python<'py>,
    scene: &Scene,
    name: &str,
    values: Vec<f64>,
    state: Option<&str>,
    at: f64,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    require_undriven(&scene.scene, name).map_err(raised)?;
    let found = watched(py, progress.as_ref(), |watch| {
        let with = |value: f64| changed(scene, (name, value), at);
        check_instant(at)?;
        let first = values.first().ok_or_else(|| Error::argument("a locus needs values"))?;
        let states = states_of(state, scene, &with(*first)?)?;
        let at = |value: f64| watch.check().and_then(|()| with(value));
        #[allow(clippy::cast_precision_loss)]
        let done = |done: usize, of: usize| (watch.progress)(done as f64 / of as f64);
        loci::locus(&at, &states, &values, loci::ALL_FREQUENCIES, &done)
    })?
    .map_err(raised)?;
    let result = PyDict::new(py);
    let branches = found.branches.len();
    let flat: Vec<Complex<f64>> = found.branches.iter().flatten().map(|root| root.lambda).collect();
    result.set_item(
        "eigenvalue",
        complexes(py, &flat)?.call_method1("reshape", ([branches, values.len()],))?,
    )?;
    let crossings = found.crossings.iter().map(|crossing| {
        (crossing.value, crossing.mode, crossing.frequency_hz, crossing.becomes_unstable)
    });
    result.set_item("crossings", crossings.collect::<Vec<_>>())?;
    let mergings = found
        .coalescences
        .iter()
        .map(|merging| (merging.value, merging.modes, merging.frequency_hz, merging.merge));
    result.set_item("mergings", mergings.collect::<Vec<_>>())?;
    result.set_item("undecided", found.undecided)?;
    Ok(result)
}

/// Derivatives of the eigenvalues of a contact state by all parameters: one row for each mode, also for those that come
/// several times.
#[pyfunction]
#[pyo3(signature = (scene, state=None, friction=None, at=0.0, progress=None))]
#[allow(clippy::needless_pass_by_value)]
pub fn sensitivities<'py>(
    py: Python<'py>,
    scene: &Scene,
    state: Option<&str>,
    friction: Option<f64>,
    at: f64,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let found = watched(py, progress.as_ref(), |watch| {
        let here = linearised(scene, friction, at)?;
        let states = states_of(state, scene, &here)?;
        #[allow(clippy::cast_precision_loss)]
        let done = |done: usize, of: usize| (watch.progress)(done as f64 / of as f64);
        amontons_analysis::stability::sensitivities(&here, &states, loci::ALL_FREQUENCIES, &done)
    })?
    .map_err(raised)?;
    let nowhere = Complex::new(f64::NAN, f64::NAN);
    let (mut eigenvalues, mut derivatives) = (Vec::new(), Vec::new());
    let (mut places, mut distances) = (Vec::new(), Vec::new());
    for mode in &found.modes {
        for copy in 0..mode.copies {
            eigenvalues.push(mode.eigenvalue);
            let merging = mode.merging.as_ref();
            places.push(merging.map_or(f64::NAN, |merging| merging.friction));
            distances.push(merging.map_or(f64::NAN, |merging| merging.distance));
            match &mode.derivatives {
                Some(all) => derivatives.extend(all.iter().map(|by| by[copy])),
                None => derivatives.extend(found.parameters.iter().map(|_| nowhere)),
            }
        }
    }
    let shape = [eigenvalues.len(), found.parameters.len()];
    let result = PyDict::new(py);
    result.set_item("eigenvalue", complexes(py, &eigenvalues)?)?;
    let derivatives = complexes(py, &derivatives)?.call_method1("reshape", (shape,))?;
    result.set_item("derivative", derivatives)?;
    result.set_item("merging_friction", reals(py, places.into_iter())?)?;
    result.set_item("merging_distance", reals(py, distances.into_iter())?)?;
    let names = found.parameters.iter().map(|parameter| parameter.name.clone());
    result.set_item("parameter", names.collect::<Vec<_>>())?;
    result.set_item("value", reals(py, found.parameters.iter().map(|it| it.value))?)?;
    Ok(result)
}

/// Ranges of µ in which uniform sliding is stable, and those in which modes of other states grow meanwhile.
#[pyfunction]
#[pyo3(signature = (scene, range, at=0.0, progress=None))]
#[allow(clippy::needless_pass_by_value)]
pub fn candidates<'py>(
    py: Python<'py>,
    scene: &Scene,
    range: [f64; 2],
    at: f64,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    require_undriven(&scene.scene, FRICTION).map_err(raised)?;
    let found = watched(py, progress.as_ref(), |watch| {
        check_instant(at)?;
        bistability(&at_instant(&scene.scene, at)?, range, watch)
    })?
    .map_err(raised)?;
    let result = PyDict::new(py);
    result.set_item("range", found.range)?;
    result.set_item("equilibrium", found.equilibrium)?;
    result.set_item("stable", found.stable)?;
    let crossings = found.uniform.iter().map(|crossing| {
        (crossing.value, crossing.mode, crossing.frequency_hz, crossing.becomes_unstable)
    });
    result.set_item("crossings", crossings.collect::<Vec<_>>())?;
    let rows = found.candidates.iter().map(|candidate| {
        let row = PyDict::new(py);
        row.set_item("state", JoinedStates(&candidate.states).to_string())?;
        row.set_item("alike", candidate.alike)?;
        row.set_item("range", candidate.range)?;
        row.set_item("begins", candidate.begins)?;
        row.set_item("frequency", candidate.frequency_hz)?;
        row.set_item("frequency_at_end", candidate.at_end[0])?;
        row.set_item("growth_rate_at_end", candidate.at_end[1])?;
        row.set_item("energy", candidate.reach.map(|reach| reach.energy))?;
        row.set_item("push", candidate.reach.map(|reach| reach.push))?;
        Ok(row)
    });
    result.set_item("candidates", rows.collect::<PyResult<Vec<_>>>()?)?;
    Ok(result)
}

/// The equilibrium in uniform sliding: displacements (m), normal and friction forces (N), gaps (m).
#[pyfunction]
#[pyo3(signature = (scene, at=0.0))]
pub fn equilibrium<'py>(
    py: Python<'py>,
    scene: &Scene,
    at: f64,
) -> PyResult<Vec<Bound<'py, PyAny>>> {
    let found =
        py.detach(|| linearised(scene, None, at)?.equilibrium().cloned()).map_err(raised)?;
    let parts = [found.displacement, found.normal_force, found.friction_force, found.gap];
    parts.into_iter().map(|values| reals(py, values.into_iter())).collect()
}

/// The verdict on uniform sliding, in words.
#[pyfunction]
#[pyo3(signature = (scene, at=0.0))]
pub fn verdict(py: Python<'_>, scene: &Scene, at: f64) -> PyResult<String> {
    let found = py.detach(|| {
        check_instant(at)?;
        map::verdict(&at_instant(&scene.scene, at)?)
    });
    Ok(found.map_err(raised)?.to_string())
}

/// A sentence on the signals that an analysis at an instant (s) leaves out; None for a scene without signals.
#[pyfunction]
pub fn left_out(scene: &Scene, at: f64) -> Option<String> {
    signals_left_out(&scene.scene, at)
}

/// Refuses a parameter that signals change: an analysis over its values would add them.
#[pyfunction]
pub fn check_undriven(scene: &Scene, name: &str) -> PyResult<()> {
    require_undriven(&scene.scene, name).map_err(raised)
}
