//! States of each contact over time.

use amontons::contact::ContactState;
use serde::Serialize;

/// The most pieces of a run, for each of which the states that a contact takes in it are given: finer details do not
/// show in a picture.
const PIECES: usize = 300;

/// The states of one contact over time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StateTimeline {
    /// The contact, as `contact[1]`.
    pub contact: String,
    /// Stretches one after the other.
    pub stretches: Vec<StateInterval>,
}

/// A stretch of time over which a contact takes the same states, by turns if they are several.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StateInterval {
    /// Beginning, s.
    pub from: f64,
    /// End, s.
    pub to: f64,
    /// States in the order of [`ContactState::ALL`].
    pub states: Vec<ContactState>,
}

/// The courses of the contacts of these names from their states in steps of `interval` (s). States of a row hold
/// until the next.
pub(super) fn courses(
    names: &[String],
    states: &[Vec<ContactState>],
    interval: f64,
) -> Vec<StateTimeline> {
    let course = |(name, states): (&String, &Vec<ContactState>)| {
        // The last row ends the run.
        let held = &states[..states.len().saturating_sub(1)];
        let pieces = held.len().min(PIECES);
        let begin = |piece: usize| piece * held.len() / pieces;
        let mut stretches: Vec<StateInterval> = Vec::new();
        for piece in 0..pieces {
            let rows = begin(piece)..begin(piece + 1);
            let [from, to] = [rows.start, rows.end].map(|row| row as f64 * interval);
            let is_taken = |state: &ContactState| held[rows.clone()].contains(state);
            let taken: Vec<ContactState> = ContactState::ALL.into_iter().filter(is_taken).collect();
            match stretches.last_mut() {
                Some(last) if last.states == taken => last.to = to,
                _ => stretches.push(StateInterval { from, to, states: taken }),
            }
        }
        StateTimeline { contact: name.clone(), stretches }
    };
    names.iter().zip(states).map(course).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use ContactState::{Slide, Stick};

    #[test]
    fn a_contact_that_sticks_by_turns_has_one_stretch_of_both_states() {
        let rows: Vec<ContactState> =
            (0..=3000).map(|row| if row >= 1500 && row % 3 == 0 { Stick } else { Slide }).collect();
        let names = ["contact[1]".to_owned()];
        let found = courses(&names, &[rows], 1e-3);
        let [course] = &found[..] else { panic!("{found:?}") };
        let [first, second] = &course.stretches[..] else { panic!("{course:?}") };
        assert_eq!((first.from, &first.states[..]), (0.0, &[Slide][..]));
        assert_eq!(&second.states[..], [Slide, Stick]);
        // Pieces are 10 ms long.
        assert!((first.to - 1.5).abs() <= 1e-2 && first.to == second.from);
        assert!((second.to - 3.0).abs() < 1e-12);
        assert_eq!(courses(&names, &[vec![Slide]], 1e-3)[0].stretches, []);
    }
}
