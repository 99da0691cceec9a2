//! This module tells a motion that attracts others from one of a family in which motions of every size persist.
//!
//! A linear motion that nothing damps keeps its size, so other motions converge to none of its sizes. They do
//! converge to two linear motions: one that signals drive while everything else decays, and the largest one of a
//! family. A larger motion than that makes a contact change its state and loses energy, until it is as small.

use super::basis::{Basis, Members, scheme_step};
use super::linear::{GrowthRate, MORE_THAN_ROUNDING, growth};
use super::observation::ObservationSettings;
use super::recurrence::{begin_fast, distance_per_step};
use crate::stability::Linearised;
use amontons::Error;
use amontons::numerics::euclidean_norm;
use amontons::simulation::Simulation;
use std::f64::consts::TAU;

/// Least part p of the motion by which it is made smaller, 2 p, before a mode is pushed by 4 p of the size of
/// the motion's velocities both ways, to see if the motion is the largest of its family. With the paper's scheme p is
/// at least the distance that the motion moves in a step.
const LARGER: f64 = 1e-5;

/// A mode of more than this part of the largest one in a sum counts.
const FAIR: f64 = 1e-3;

/// A mode that neither grows nor decays.
struct Neutral {
    /// rad/s.
    pulsation: f64,
    /// Amplitude of each degree of freedom, in parts of the largest.
    shape: Vec<f64>,
}

/// `true` if a settled motion is one of a family of motions with every size near its own. Its strongest frequency is
/// `frequency`, Hz. It is one of a family if it is linear, but for contacts that reach their limit for an instant,
/// and a mode that neither grows nor decays can be larger and smaller with no contact changing its state.
///
/// # Errors
/// Returns an error if a step fails.
pub(super) fn is_one_of_many(
    simulation: &Simulation,
    observation: &ObservationSettings,
    frequency: Option<f64>,
    is_over: &dyn Fn() -> bool,
) -> Result<bool, Error> {
    if simulation.is_driven_on() && growth(simulation).is_some_and(GrowthRate::is_decaying) {
        return Ok(false);
    }
    let Some(frequency) = frequency else { return Ok(true) };
    let mut motion = Simulation::resume(simulation.save())?;
    let fastest =
        begin_fast(&mut motion, observation.interval, frequency, observation.rows())?.velocity;
    // The paper's scheme sees a change of state at the end of a step only.
    let part = LARGER.max(distance_per_step(simulation, frequency));
    // No contact is at its limit then, so it is the mode that brings it there.
    motion.scale_motion(1.0 - 2.0 * part);
    if changes_states(&motion, observation, is_over)? {
        return Ok(false);
    }
    let Some(modes) = neutral_modes(simulation) else { return Ok(true) };
    for mode in &modes {
        // `fastest` is a norm over all degrees of freedom, and so is what the push is divided by.
        let push = 4.0 * part * fastest / euclidean_norm(mode.shape.iter().copied());
        if !is_limited(&motion, mode, push, observation, is_over)? {
            return Ok(true);
        }
    }
    Ok(false)
}

/// `true` if a contact changes its state when a mode gets larger or smaller by a push, m/s. Where a mode stands still
/// a push does not change its size, so it is pushed a quarter of its period later, too.
fn is_limited(
    smaller: &Simulation,
    mode: &Neutral,
    push: f64,
    observation: &ObservationSettings,
    is_over: &dyn Fn() -> bool,
) -> Result<bool, Error> {
    for quarter in [0.0, 0.25] {
        for push in [push, -push] {
            let mut motion = Simulation::resume(smaller.save())?;
            motion.advance_to(motion.time() + quarter * TAU / mode.pulsation)?;
            for (dof, part) in mode.shape.iter().enumerate() {
                motion.push(dof, push * part);
            }
            if changes_states(&motion, observation, is_over)? {
                return Ok(true);
            }
        }
    }
    Ok(false)
}

/// `true` if a contact changes its state within a window.
fn changes_states(
    motion: &Simulation,
    observation: &ObservationSettings,
    is_over: &dyn Fn() -> bool,
) -> Result<bool, Error> {
    let mut motion = Simulation::resume(motion.save())?;
    let (start, before) = (motion.time(), motion.statistics().state_changes());
    for row in 1..=observation.rows() {
        if row.is_multiple_of(256) && is_over() {
            break;
        }
        #[allow(clippy::cast_precision_loss)]
        motion.advance_to(start + row as f64 * observation.interval)?;
        if motion.statistics().state_changes() > before {
            return Ok(true);
        }
    }
    Ok(false)
}

/// The modes of the present contact states.
fn basis(simulation: &Simulation) -> Option<Basis> {
    let step = scheme_step(simulation.scene());
    let here = Linearised::now(simulation);
    Basis::of(here.linear().ok()?, simulation.contact_states(), step)
}

/// The modes of the present contact states that oscillate and neither grow nor decay. `None` where they are not known.
fn neutral_modes(simulation: &Simulation) -> Option<Vec<Neutral>> {
    let basis = basis(simulation)?;
    let is_neutral = |rate: f64| rate.abs() <= MORE_THAN_ROUNDING * basis.pace;
    let groups = basis.modes.iter().filter(|group| {
        is_neutral(group.eigenvalue.re) && group.eigenvalue.im > MORE_THAN_ROUNDING * basis.pace
    });
    let modes = groups.flat_map(|group| {
        // Without growth or decay all degrees of freedom swing in one phase.
        let shapes = group.members.iter().map(|(_, shape)| {
            let largest = shape.iter().max_by(|a, b| a.norm().total_cmp(&b.norm()));
            let turn = largest.map_or(1.0.into(), |largest| largest.conj() / largest.norm());
            shape.iter().map(|part| (part * turn).re).collect()
        });
        let pulsation = group.eigenvalue.im;
        parted(shapes.collect()).into_iter().map(move |shape| Neutral { pulsation, shape })
    });
    Some(modes.collect())
}

/// Number of frequencies of a motion that is a sum of modes, counting those that are a fair part of it; `None` where
/// the modes are not known.
pub(super) fn frequencies_of_sum(simulation: &Simulation) -> Option<usize> {
    let basis = basis(simulation)?;
    let state = [simulation.displacement(), simulation.velocity()].concat();
    let coefficients = basis.coefficients(&state);
    let oscillates = |group: &&Members| group.eigenvalue.im > MORE_THAN_ROUNDING * basis.pace;
    let size = |group: &Members| {
        group
            .members
            .iter()
            .fold(0.0, |most, (place, _)| f64::max(most, coefficients[*place].norm()))
    };
    let sizes: Vec<f64> = basis.modes.iter().filter(oscillates).map(size).collect();
    let most = sizes.iter().copied().fold(0.0, f64::max);
    Some(sizes.into_iter().filter(|size| *size > FAIR * most).count())
}

/// Combinations of the shapes of one eigenvalue, each of which moves as few degrees of freedom as may be: equal parts
/// of a structure that do not touch each other swing on their own. By Gauss–Jordan elimination; the largest part of
/// each is 1.
fn parted(mut shapes: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let largest = |shape: &[f64]| {
        let parts = shape.iter().enumerate();
        parts.max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs())).map_or(0, |(dof, _)| dof)
    };
    for i in 0..shapes.len() {
        let dof = largest(&shapes[i]);
        let pivot = shapes[i].clone();
        for (_, other) in shapes.iter_mut().enumerate().filter(|(j, _)| *j != i) {
            let factor = other[dof] / pivot[dof];
            other.iter_mut().zip(&pivot).for_each(|(other, part)| *other -= factor * part);
        }
    }
    for shape in &mut shapes {
        let most = shape[largest(shape)];
        // Rounding errors of the elimination would push parts that do not move.
        shape.iter_mut().for_each(|part| {
            *part = if part.abs() <= MORE_THAN_ROUNDING * most.abs() { 0.0 } else { *part / most };
        });
    }
    shapes
}
