//! Jumps between cycles that look alike.
//!
//! A way takes steps of µ that change its motion by up to 5 %, and so passes a jump by 1 % unseen. Such a jump leaves a trace
//! where it is not the same in both directions: beside it the ways have two motions. There each way is followed once more, in
//! small steps that change its motion by no more than 0.5 %. Two motions at the same value differ from there on.

use super::follow::Run;
use super::followed::{Difference, Followed};
use crate::Error;

impl Run<'_> {
    /// Follows both ways closely where they have two cycles at one of two neighbouring values, or two at both that look alike.
    /// `false` if the watch ended it.
    pub(super) fn find_small_jumps(&self, ways: &mut [Followed]) -> Result<bool, Error> {
        for place in [0, 1] {
            let values = self.values(ways[place].way);
            for step in 1..values.len() {
                let two = [values[step - 1], values[step]]
                    .map(|value| ways[place].differs(&ways[1 - place], value));
                let [Some(before), Some(after)] = two else { continue };
                // Motions that are the same, or differ clearly, at both leave no such trace.
                if before == after && before != Difference::Small {
                    continue;
                }
                let Some(stretch) = self.follow_closely(&ways[place], &values[step - 1..])? else {
                    return Ok(false);
                };
                ways[place].take_over(stretch);
            }
        }
        Ok(true)
    }

    /// A way once more from the first of some values, in small steps, up to the value at which it has the motion that it had
    /// before. `None` if the watch ended it.
    fn follow_closely(&self, way: &Followed, values: &[f64]) -> Result<Option<Followed>, Error> {
        let label = format!("{} closely", way.label);
        let Some(first) = way.at(values[0]) else { return Ok(None) };
        let mut stretch =
            Followed { looks_closely: true, ..Followed::way(way.way, label, first.clone()) };
        let is_other = |stretch: &Followed| {
            let last = stretch.passed.last().map(|last| last.point.friction);
            let difference = last.and_then(|last| stretch.differs(way, last));
            stretch.goes_on() && difference.is_some_and(|difference| difference != Difference::None)
        };
        Ok(self.advance_through(&mut stretch, &values[1..], is_other)?.then_some(stretch))
    }
}
