//! The part of the law that depends on the history of a contact: static and kinetic friction.
//!
//! The law at one instant allows a contact that slips its kinetic friction, whether or not the contact should have been
//! released. So for a contact that has begun to slip the force needed to hold it is computed, and for one that holds
//! the force that could have stopped it: one that stuck is held by up to µ_s N either way, one that slipped by up to µ
//! N against its slip, and µ_s N against slipping back; one that lands, by µ N.

use super::Run;
use super::singular::nearest;
use amontons::contact::ContactState::{self, Detached, ReverseSlide, Slide, Stick};
use amontons::contact::Friction;
use nalgebra::DVector;

/// State of a contact before the step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Before {
    Open,
    Stuck,
    /// It slipped, with friction on the mass in this direction (±1).
    Slipped(f64),
}

/// Forces and slip of a contact, with the sizes that count as zero.
#[derive(Clone, Copy, Debug)]
pub(super) struct Doing {
    /// (N, T), or impulses.
    pub force: [f64; 2],
    /// The slip, slider against mass, that the forces leave: a velocity, of impulses, or an acceleration.
    pub slip: f64,
    /// Values of the slip and of the forces that count as zero.
    pub nothing: [f64; 2],
}

/// The state that a normal force (N, or N s) and a slip show, where this much of each is nothing.
pub(super) fn state_of(normal: f64, slip: f64, nothing: [f64; 2]) -> ContactState {
    if normal <= nothing[1] {
        Detached
    } else if slip.abs() <= nothing[0] {
        Stick
    } else if slip > 0.0 {
        Slide
    } else {
        ReverseSlide
    }
}

impl Before {
    /// The most that T/N may be in a direction, where the contact holds.
    fn limit(self, direction: f64, friction: Friction) -> f64 {
        match self {
            Self::Open => friction.kinetic,
            Self::Slipped(slipped) if slipped == direction => friction.kinetic,
            Self::Slipped(_) | Self::Stuck => friction.static_,
        }
    }
}

impl Run {
    /// By how much a contact holds with more than it may, or slips although it could have held, all others
    /// going on in their states; and whether it slips.
    pub(super) fn missed(
        &mut self,
        contact: usize,
        before: Before,
        doing: &Doing,
        states: &[ContactState],
        friction: &[Friction],
    ) -> (f64, bool) {
        let Doing { force: [normal, tangential], slip, nothing } = *doing;
        let limit = |direction| before.limit(direction, friction[contact]);
        if slip.abs() <= nothing[0] {
            let over = |direction: f64| direction * tangential - limit(direction) * normal;
            return (over(1.0).max(over(-1.0)) - nothing[1], false);
        }
        let direction = slip.signum();
        let was_stopped = before != Before::Open && before != Before::Slipped(direction);
        if normal <= nothing[1] || !was_stopped {
            return (0.0, true);
        }
        // The force needed to hold the contact: a force along the tangent that removes the slip.
        let (mut states, mut friction) = (states.to_vec(), friction.to_vec());
        (states[contact], friction[contact]) = (Slide, Friction::from(0.0));
        let place = self.held(&states, &friction);
        let held = &self.memory.held[place];
        let tangent = self.directions.column(2 * contact + 1);
        let more = slip / tangent.dot(&(&held.mobility * tangent));
        let pressed = more * held.multipliers.row(2 * contact).transpose().dot(&tangent);
        let (normal, tangential) = (normal + pressed, tangential + more);
        let limit = limit(direction);
        (limit * normal - direction * tangential - (1.0 + limit) * nothing[1], true)
    }

    /// `true` if another contact shares masses with this one.
    pub(super) fn shares_masses(&self, contact: usize) -> bool {
        let rows = self.directions.columns(2 * contact, 2);
        let delassus = rows.transpose() * &self.inverse_mass * &self.directions;
        let others = (0..delassus.ncols()).filter(|column| column / 2 != contact);
        others.fold(0.0, |most: f64, column| most.max(delassus.column(column).amax())) > 0.0
    }

    /// Distance of a vector, as forces on the masses, from the forces that closed contacts can give, each with the
    /// limits of its friction backward and forward: a distance from a cone, by the active set of Lawson and Hanson
    /// (Solving Least Squares Problems, 1974, ch. 23).
    ///
    /// Contacts that cannot open also pull.
    pub(super) fn distance_from_cone(
        &self,
        vector: &DVector<f64>,
        limits: &[Option<[f64; 2]>],
    ) -> f64 {
        let mut edges: Vec<DVector<f64>> = Vec::new();
        let law = self.model.law;
        for (i, limits) in limits.iter().enumerate() {
            let [normal, tangent] = [0, 1].map(|k| self.directions.column(2 * i + k));
            let Some([from, to]) = *limits else { continue };
            for limit in if to > from { vec![from, to] } else { vec![from] } {
                edges.push(normal + tangent * limit);
                if !law.detachment {
                    // Friction follows N with its sign where its direction is frozen, and else |N|.
                    let pulled = if law.has_fixed_state() { -limit } else { limit };
                    edges.push(tangent * pulled - normal);
                }
            }
        }
        for edge in &mut edges {
            edge.normalize_mut();
        }
        let mut parts = vec![0.0; edges.len()];
        let mut used: Vec<usize> = Vec::new();
        // Edges that have led no nearer since the last one that did: where edges depend on each other, rounding would
        // choose the same again and again.
        let mut rejected: Vec<usize> = Vec::new();
        let mut rest = vector.clone();
        while rejected.len() + used.len() < edges.len() {
            let unused = (0..edges.len()).filter(|e| !used.contains(e) && !rejected.contains(e));
            let gained = unused.map(|edge| (edge, edges[edge].dot(&rest)));
            let best = gained.max_by(|a, b| a.1.total_cmp(&b.1));
            let Some((edge, _)) = best.filter(|best| best.1 > 1e-14 * vector.norm()) else { break };
            let old = (parts.clone(), used.clone());
            used.push(edge);
            while !used.is_empty() {
                let columns: Vec<_> = used.iter().map(|&edge| &edges[edge]).collect();
                let Some(wanted) = nearest(&columns, vector) else { break };
                let to_zero = used.iter().zip(&wanted).filter(|(_, wanted)| **wanted <= 0.0);
                let steps = to_zero.map(|(&edge, wanted)| {
                    (edge, parts[edge] / (parts[edge] - wanted).max(f64::MIN_POSITIVE))
                });
                let first = steps.min_by(|a, b| a.1.total_cmp(&b.1));
                let step = first.map_or(1.0, |(_, step)| step);
                for (&edge, wanted) in used.iter().zip(&wanted) {
                    parts[edge] += step * (wanted - parts[edge]);
                }
                let Some((first, _)) = first else { break };
                // Whatever rounding has left of it.
                parts[first] = 0.0;
                used.retain(|&edge| parts[edge] > 0.0);
            }
            (0..edges.len()).filter(|edge| !used.contains(edge)).for_each(|edge| parts[edge] = 0.0);
            let sum = edges.iter().zip(&parts).map(|(edge, part)| edge * *part);
            let now = vector - sum.fold(DVector::zeros(vector.len()), |sum, edge| sum + edge);
            if now.norm() < rest.norm() {
                rest = now;
                rejected.clear();
            } else {
                (parts, used) = old;
                rejected.push(edge);
            }
        }
        rest.amax()
    }
}
