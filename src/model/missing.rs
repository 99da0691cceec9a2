//! The reason why there is no equilibrium, in words.

use super::banded::Singular;
use super::closing::{Condensed, MOST_TRIED};
use super::{Equilibrium, LumpedModel};
use crate::Error;
use crate::numerics::{bisect, max_norm};
use std::fmt;

impl LumpedModel {
    /// Explains why no contacts that can open carry the load at these µ. Looks for the largest part of them at which
    /// some do: where the equilibrium is lost, a normal force that grows without bound is jamming.
    pub(super) fn explain_jamming(
        &self,
        condensed: &Condensed,
        slopes: &[f64],
        name: &dyn Fn(usize) -> String,
    ) -> Error {
        let exists = |part: f64| {
            let part: Vec<f64> = slopes.iter().map(|slope| part * slope).collect();
            let problem = condensed.with_friction(&part).ok()?;
            problem.forces(&problem.closed()?)
        };
        // Of more contacts, not all patterns are tried: that none is found does not prove that there is none.
        let (grid, none) = match self.contacts.len() {
            0..=MOST_TRIED => (GRID, "no equilibrium in sliding"),
            _ => (COARSE_GRID, "no equilibrium in sliding was found"),
        };
        let Some(Lost { last, start, part }) = lost(grid, exists) else {
            return Error::equilibrium(format!(
                "{none}: the load pulls the structure off its contacts, and springs do not hold it in all \
                 its motions; press it on by a preload or a force, or hold it by a spring",
            ));
        };
        let jams = jammed(&last, &start);
        let limit = Limit::of(slopes, jams.unwrap_or(0), part);
        match jams {
            Some(contact) => limit.jams(&name(contact)),
            None => Error::equilibrium(format!(
                "{none} with {limit}: none is found from {:.6} on, where a contact opens or closes; \
                 lower the coefficient, or press the contacts on",
                limit.value
            )),
        }
    }

    /// Explains why contacts that cannot open have no equilibrium in which none pulls at these µ. Looks for the largest
    /// part of them that has one: where the equilibrium is lost, a normal force that falls to zero is a contact that
    /// would open, one that grows without bound is jamming.
    pub(super) fn explain_pulling(
        &self,
        slopes: &[f64],
        found: &Result<Equilibrium, Singular>,
        name: &dyn Fn(usize) -> String,
    ) -> Error {
        let solve = |part: f64| {
            let part: Vec<f64> = slopes.iter().map(|slope| part * slope).collect();
            self.solve(&part, &self.load)
        };
        if solve(0.0).is_err() {
            return mechanism();
        }
        let exists = |part: f64| {
            let found = solve(part).ok().filter(|found| found.pulled_contact().is_none())?;
            Some(found.normal_force)
        };
        let Some(Lost { last, start, part }) = lost(GRID, exists) else {
            let pulled = found.as_ref().ok().and_then(Equilibrium::pulled_contact);
            let (contact, force) = pulled.unwrap_or((0, 0.0));
            return Error::equilibrium(format!(
                "no equilibrium in sliding: {} opens under the load \
                 (it would have to pull with {:.4} N); press it on by a preload or a force",
                name(contact),
                -force
            ));
        };
        let jams = jammed(&last, &start);
        let lightest = last.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1));
        let contact = jams.or(lightest.map(|(contact, _)| contact)).unwrap_or(0);
        let (limit, name) = (Limit::of(slopes, contact, part), name(contact));
        match jams {
            Some(_) => limit.jams(&name),
            None => Error::equilibrium(format!(
                "no equilibrium in sliding with {limit}: friction lifts {name} off from {:.6} on; press it on, or lower the \
                 coefficient",
                limit.value
            )),
        }
    }
}

/// The error of a structure that neither springs nor contacts hold, or that contacts hold twice.
pub(super) fn mechanism() -> Error {
    Error::equilibrium(
        "no equilibrium: the structure can move without straining a spring, or its contacts \
         are redundant; restrain every motion by a stiffness above zero, and only once",
    )
}

/// The error of a structure that the load carries off to this distance, m.
pub(super) fn held_by_rounding(distance: f64) -> Error {
    Error::equilibrium(format!(
        "no equilibrium: the load would move the structure by {distance:.1e} m, where rounding of its stiffness decides what holds it; \
         springs do not hold it in all its motions, or their stiffnesses differ too much: press it on its contacts by a preload or a \
         force, or hold it by a spring"
    ))
}

/// Normal forces beside the place where an equilibrium is lost as friction grows.
struct Lost {
    /// The largest part of the friction coefficients with an equilibrium.
    part: f64,
    /// Forces there.
    last: Vec<f64>,
    /// Forces below.
    start: Vec<f64>,
}

/// Number of parts of the friction coefficients at which an equilibrium is sought.
const GRID: u32 = 256;
/// Number of those parts where each search takes long.
const COARSE_GRID: u32 = 32;

/// Looks for the largest part of the friction coefficients, below all of them, at which there are normal forces; `None`
/// if there are none at any of `grid` parts.
fn lost(grid: u32, exists: impl Fn(f64) -> Option<Vec<f64>>) -> Option<Lost> {
    let mut below = (0..grid).rev().map(|i| f64::from(i) / f64::from(grid));
    let (known, start) = below.find_map(|part| Some((part, exists(part)?)))?;
    let [part, _] = bisect(known, 1.0, |part| exists(part).is_some());
    let last = exists(part).unwrap_or_else(|| start.clone());
    Some(Lost { part, last, start })
}

/// A force that has grown by this factor within a part of the grid grows without bound. Nearer to the limit than that
/// rounding decides whether there is a solution.
const GROWN: f64 = 1e4;

/// The contact whose normal force grows without bound, beside the largest force before, where an equilibrium is lost. A
/// contact that was open before and has closed has no such force.
fn jammed(last: &[f64], start: &[f64]) -> Option<usize> {
    let usual = max_norm(start);
    let (contact, most) = last.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1))?;
    (usual > 0.0 && *most > GROWN * usual).then_some(contact)
}

/// A friction coefficient that is too large, and its limit.
struct Limit {
    friction: f64,
    /// The largest possible coefficient.
    value: f64,
    /// Contacts of different µ share a limit only where they keep their proportions.
    differ: bool,
}

impl Limit {
    fn of(slopes: &[f64], contact: usize, part: f64) -> Self {
        let friction = slopes.get(contact).map_or(0.0, |slope| slope.abs());
        let differ = slopes.iter().any(|slope| slope.abs() != friction);
        Self { friction, value: part * friction, differ }
    }

    fn jams(&self, name: &str) -> Error {
        Error::equilibrium(format!(
            "no equilibrium in sliding with {self}: {name} jams \
             from {:.6} on, where friction draws it into the slider; \
             lower the coefficient or turn slider.angle",
            self.value
        ))
    }
}

impl fmt::Display for Limit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let common = if self.differ { " (and the others in proportion)" } else { "" };
        write!(f, "a friction coefficient of {}{common}", self.friction)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_open_contact_neither_jams_nor_hides_one_that_does() {
        // Contact 1 stays open, contact 2 jams.
        assert_eq!(jammed(&[0.0, 1e12], &[0.0, 3.0]), Some(1));
        assert_eq!(jammed(&[1e12, 0.0], &[3.0, 0.0]), Some(0));
        // Contact 1 has just touched, with less force than the other has.
        assert_eq!(jammed(&[1e-3, 3.1], &[0.0, 3.0]), None);
        assert_eq!(jammed(&[1e-3, 0.0], &[0.0, 0.0]), None);
    }
}
