//! Derivatives of the friction coefficients at which modes begin or cease to grow.

use super::{Multiple, Shaped, StateDerivatives, multiple};
use crate::assign::{FRICTION, assign};
use crate::stability::locus::{Crossing, locus};
use crate::stability::parallel::collect;
use crate::stability::{Linearised, modes};
use amontons::Error;
use amontons::contact::ContactState;
use amontons::scene::Scene;
use std::f64::consts::TAU;

/// Number of intervals at whose ends modes are looked at to find those that begin to grow.
const INTERVALS: u32 = 200;
/// A mode that begins to grow within this part of µ of a merging does so because of it.
const AT_MERGING: f64 = 1e-8;

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
    /// ∂µ/∂p of this µ, per unit of the parameter: as many values as copies, the largest first.
    pub derivatives: Vec<(String, Vec<f64>)>,
}

/// The common friction coefficients between two values at which modes with frequencies between two bounds (Hz) of a contact
/// state begin or cease to grow, with their derivatives by all parameters. A mode that grows only within a two-hundredth of
/// the range may be missed.
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
    let with = |value: f64| {
        let mut scene = scene.clone();
        assign(&mut scene, FRICTION, value)?;
        scene.check()?;
        Ok(scene)
    };
    let model_at = |value: f64| Ok(Linearised::of(&with(value)?));
    let part = |i: u32| f64::from(i) / f64::from(INTERVALS);
    let values: Vec<f64> = (0..=INTERVALS).map(|i| from + (to - from) * part(i)).collect();
    let crossings = locus(&model_at, states, &values, frequencies, done)?.crossings;
    let mut apart: Vec<Crossing> = Vec::new();
    for crossing in crossings {
        let is_same = |it: &Crossing| {
            it.value == crossing.value
                && (it.frequency_hz - crossing.frequency_hz).abs() <= 1e-9 * it.frequency_hz
        };
        if !apart.iter().any(is_same) {
            apart.push(crossing);
        }
    }
    collect(apart.len(), &|i| of_crossing(&with(apart[i].value)?, states, apart[i]), &|_| {})
}

/// The derivatives of a critical µ; the scene has this µ.
fn of_crossing(
    scene: &Scene,
    states: &[ContactState],
    crossing: Crossing,
) -> Result<CriticalFriction, Error> {
    let here = Linearised::of(scene);
    let state = StateDerivatives::of(&here, states)?;
    let all = multiple(modes(here.linear()?, states)?.all().map(|mode| mode.eigenvalue));
    let wanted = nalgebra::Complex::new(0.0, TAU * crossing.frequency_hz);
    let distance = |it: &Multiple| (it.eigenvalue - wanted).norm();
    let nearest = all.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
    let nearest = *nearest.ok_or_else(|| Error::analysis("the contact state has no mode"))?;
    let shaped: Vec<Shaped> =
        all.iter().map(|one| state.shapes(*one)).collect::<Result<_, Error>>()?;
    let one = shaped.iter().find(|it| it.eigenvalue == nearest.eigenvalue).expect("it is of them");
    let names = state.parameters.iter().map(|parameter| &parameter.name);
    let others = names.zip(&state.changes).filter(|(name, _)| *name != FRICTION);
    let point = state.double_point(one, &shaped, AT_MERGING);
    let derivatives = match &point {
        Some(point) => {
            let friction = &state.changes[state.friction.expect("a merging is one over µ")];
            others.map(|(name, by)| (name.clone(), vec![point.moves(by, friction).re])).collect()
        }
        None => {
            let rate = one.by_friction.re;
            others
                .map(|(name, by)| {
                    let all = one.derivatives(by).unwrap_or_default();
                    let mut moved: Vec<f64> = all.iter().map(|by| -by.re / rate).collect();
                    moved.sort_by(|a, b| b.total_cmp(a));
                    (name.clone(), moved)
                })
                .collect()
        }
    };
    Ok(CriticalFriction {
        value: crossing.value,
        frequency_hz: crossing.frequency_hz,
        becomes_unstable: crossing.becomes_unstable,
        is_merging: point.is_some(),
        copies: one.copies,
        derivatives,
    })
}
