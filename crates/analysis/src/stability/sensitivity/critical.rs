//! Derivatives of the friction coefficients at which modes begin or cease to grow.

use super::{Parameter, StateDerivatives, neighbours};
use crate::assign::{FRICTION, assign};
use crate::stability::locus::{Crossing, locus};
use crate::stability::parallel::collect;
use crate::stability::{Linearised, modes};
use amontons::Error;
use amontons::contact::ContactState;
use amontons::scene::Scene;
use nalgebra::Complex;
use std::f64::consts::TAU;

/// Number of intervals at whose ends modes are looked at to find those that begin to grow.
const INTERVALS: u32 = 200;
/// Without damping a mode begins to grow where it merges with another one; both places are the same to this part of µ.
const AT_MERGING: f64 = 1e-6;

/// Derivatives of a critical µ by parameters, one for each copy of the mode.
pub type Derivatives = Vec<(Parameter, Vec<f64>)>;

/// A common friction coefficient µ at which a mode begins or ceases to grow.
#[derive(Clone, Debug, PartialEq)]
pub struct CriticalFriction {
    /// This µ.
    pub value: f64,
    /// The frequency of the mode there, Hz; zero where it diverges.
    pub frequency_hz: f64,
    /// `true` if the mode grows above the value; `false` if it grows below.
    pub becomes_unstable: bool,
    /// `true` if two modes merge at this µ, and one of them begins to grow therefore.
    pub is_merging: bool,
    /// Number of modes that do so at once.
    pub copies: usize,
    /// The parameters with ∂µ/∂p of this µ, per unit of the parameter: as many values as copies, the largest first. Or the
    /// reason why there are none.
    pub derivatives: Result<Derivatives, Error>,
}

/// The common friction coefficients between two values at which modes with frequencies between two bounds (Hz) of a contact
/// state begin or cease to grow, with their derivatives by all parameters. They are those of a locus over two hundred
/// steps; a split of one growing mode into two that diverge is none.
///
/// `done` hears how many pieces of the work are done, and of how many.
///
/// # Errors
/// Returns an error if no contact has the common friction coefficient, or if a state cannot be analysed.
pub fn critical_friction(
    scene: &Scene,
    states: &[ContactState],
    [from, to]: [f64; 2],
    frequencies: [f64; 2],
    done: &dyn Fn(usize, usize),
) -> Result<Vec<CriticalFriction>, Error> {
    let model_at = |value: f64| Ok(Linearised::of(&with_friction(scene, value)?));
    let part = |i: u32| f64::from(i) / f64::from(INTERVALS);
    let values: Vec<f64> = (0..=INTERVALS).map(|i| from + (to - from) * part(i)).collect();
    critical_at(scene, states, &locus(&model_at, states, &values, frequencies, done)?.crossings)
}

/// The scene with another common friction coefficient.
///
/// # Errors
/// Returns an error if it is impossible.
fn with_friction(scene: &Scene, value: f64) -> Result<Scene, Error> {
    let mut scene = scene.clone();
    assign(&mut scene, FRICTION, value)?;
    scene.check()?;
    Ok(scene)
}

/// The critical friction coefficients at crossings of a locus over the common friction coefficient, with their derivatives; modes
/// that cross together are one.
///
/// # Errors
/// Returns an error if a scene with this µ is impossible.
pub fn critical_at(
    scene: &Scene,
    states: &[ContactState],
    crossings: &[Crossing],
) -> Result<Vec<CriticalFriction>, Error> {
    let mut apart: Vec<Crossing> = Vec::new();
    for &crossing in crossings {
        let is_same = |it: &Crossing| {
            it.value == crossing.value
                && (it.frequency_hz - crossing.frequency_hz).abs() <= 1e-9 * it.frequency_hz
        };
        if !apart.iter().any(is_same) {
            apart.push(crossing);
        }
    }
    collect(
        apart.len(),
        &|i| Ok(of_crossing(&with_friction(scene, apart[i].value)?, states, apart[i])),
        &|_| {},
    )
}

/// A critical µ with its derivatives; the scene has this µ.
fn of_crossing(scene: &Scene, states: &[ContactState], crossing: Crossing) -> CriticalFriction {
    let found = derivatives_of(scene, states, crossing);
    let copies = found.iter().flat_map(|(_, all)| all.first()).map(|it| it.1.len()).next();
    CriticalFriction {
        value: crossing.value,
        frequency_hz: crossing.frequency_hz,
        becomes_unstable: crossing.becomes_unstable,
        is_merging: found.as_ref().is_ok_and(|found| found.0),
        copies: copies.unwrap_or(1),
        derivatives: found.map(|found| found.1),
    }
}

/// `true` if two modes merge at a critical µ, and its derivatives.
fn derivatives_of(
    scene: &Scene,
    states: &[ContactState],
    crossing: Crossing,
) -> Result<(bool, Derivatives), Error> {
    let here = Linearised::of(scene);
    let state = StateDerivatives::of(&here, states, &|_| true)?;
    let all: Vec<Complex<f64>> =
        modes(here.linear()?, states)?.all().map(|mode| mode.eigenvalue).collect();
    let wanted = Complex::new(0.0, TAU * crossing.frequency_hz);
    let distance = |it: &Complex<f64>| (it - wanted).norm();
    let nearest = all.iter().copied().min_by(|a, b| distance(a).total_cmp(&distance(b)));
    let nearest = nearest.ok_or_else(|| Error::analysis("the contact state has no mode"))?;
    let shaped = state.shaped(&neighbours(&all, &[nearest]), &|| Ok(()), &|_, _| {})?;
    let distance_of = |it: &&super::Shaped| (it.eigenvalue - nearest).norm();
    let one = shaped.iter().min_by(|a, b| distance_of(a).total_cmp(&distance_of(b)));
    let one = one.ok_or_else(|| Error::analysis("the shapes of a critical mode were not found"))?;
    // Damping parts the place at which modes merge from that at which one begins to grow.
    let may_merge = !one.is_regular() || state.matrices.is_undamped();
    let point = if may_merge { state.double_point(one, &shaped, &all, AT_MERGING) } else { None };
    let merging = point.and_then(|point| state.merging(point));
    let rate = one.by_friction.re;
    let derivative = |place: usize| match &merging {
        Some(merging) => merging.derivatives[place].clone(),
        None => {
            let all = one.derivatives(&state.changes[place]).unwrap_or_default();
            let mut moved: Vec<f64> = all.iter().map(|by| -by.re / rate).collect();
            moved.sort_by(|a, b| b.total_cmp(a));
            moved
        }
    };
    let places = (0..state.parameters.len()).filter(|place| Some(*place) != state.friction);
    let derivatives = places.map(|place| (state.parameters[place].clone(), derivative(place)));
    let derivatives: Derivatives = derivatives.collect();
    if derivatives.iter().flat_map(|it| &it.1).any(|by| !by.is_finite())
        || derivatives.iter().any(|it| it.1.is_empty())
    {
        return Err(Error::analysis(format!(
            "the growth rate of the mode at {:.4} Hz only touches zero there, or it merges with others in a way that is not \
             resolved",
            crossing.frequency_hz
        )));
    }
    Ok((merging.is_some(), derivatives))
}
