//! A motion recorded row by row, with the changes of contact state between rows.

use amontons::Error;
use amontons::contact::ContactState;
use amontons::scene::Scene;
use amontons::simulation::Simulation;
use amontons_analysis::study::Watch;

/// Time between two rows, s: 200 rows in a period of the fastest mode, shorter than any sticking in the paper's
/// motions.
pub const INTERVAL: f64 = 2e-5;
/// Number of rows between two checks whether the work is to end.
const ROWS_AT_ONCE: usize = 1000;
/// Size of a push, as part of the largest velocity of the motion.
const PUSH: f64 = 0.01;

/// Rows of a motion of two contacts.
pub struct Motion {
    simulation: Simulation,
    /// Displacement of the first degree of freedom, m; one row each [`INTERVAL`], from time 0 on.
    pub history: Vec<f64>,
    /// States of the contacts in each row.
    pub states: Vec<[ContactState; 2]>,
    /// Number of changes of contact state up to each row, including changes between rows.
    pub changes: Vec<u64>,
}

impl Motion {
    /// Starts the motion of a scene of two contacts.
    ///
    /// # Errors
    /// Returns an error if the scene is invalid.
    pub fn new(scene: &Scene) -> Result<Self, Error> {
        let simulation = Simulation::new(Scene { step: INTERVAL, ..scene.clone() }, 0.0)?;
        let mut motion =
            Self { simulation, history: Vec::new(), states: Vec::new(), changes: Vec::new() };
        motion.note();
        Ok(motion)
    }

    /// Records up to time `end` (s). Returns `false` if the watch ended the work.
    ///
    /// # Errors
    /// Returns an error if the run fails.
    pub fn record(&mut self, end: f64, watch: Watch<'_>) -> Result<bool, Error> {
        for row in self.history.len()..=Self::row(end) {
            if row % ROWS_AT_ONCE == 0 {
                if (watch.go_on)().is_break() {
                    return Ok(false);
                }
                (watch.progress)(row as f64 * INTERVAL / end);
            }
            self.simulation.advance_to(row as f64 * INTERVAL)?;
            self.note();
        }
        Ok(true)
    }

    /// Adds [`PUSH`] times the largest velocity of the motion to the first velocity.
    pub fn push(&mut self) {
        let fastest =
            self.simulation.velocity().iter().fold(0.0, |most, v| f64::max(most, v.abs()));
        self.simulation.push(0, PUSH * fastest);
    }

    /// Index of the row at a time (s).
    pub fn row(time: f64) -> usize {
        (time / INTERVAL).round() as usize
    }

    /// The displacements between two times (s); fewer if the record ends before.
    pub fn between(&self, from: f64, to: f64) -> &[f64] {
        let end = Self::row(to).min(self.history.len());
        &self.history[Self::row(from).min(end)..end]
    }

    /// The states between two times (s); fewer if the record ends before.
    pub fn states_between(&self, from: f64, to: f64) -> &[[ContactState; 2]] {
        let end = Self::row(to).min(self.states.len());
        &self.states[Self::row(from).min(end)..end]
    }

    /// Number of changes of state between two times (s) that the rows do not show.
    pub fn hidden_changes(&self, from: f64, to: f64) -> u64 {
        let rows = self.states_between(from, to);
        let differ = |pair: &[[ContactState; 2]]| {
            u64::from(pair[0][0] != pair[1][0]) + u64::from(pair[0][1] != pair[1][1])
        };
        let seen: u64 = rows.windows(2).map(differ).sum();
        match rows.len() {
            0 => 0,
            count => {
                let first = Self::row(from);
                self.changes[first + count - 1] - self.changes[first] - seen
            }
        }
    }

    /// Time of the first change of state, s; `None` if there is none.
    pub fn first_change(&self) -> Option<f64> {
        let row = self.changes.iter().position(|changes| *changes > 0)?;
        Some(row as f64 * INTERVAL)
    }

    fn note(&mut self) {
        let states = self.simulation.contact_states();
        self.history.push(self.simulation.displacement()[0]);
        self.states.push([states[0], states[1]]);
        self.changes.push(self.simulation.statistics().entered.iter().sum());
    }
}
