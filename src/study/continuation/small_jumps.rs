//! Jumps between periodic motions that look alike.
//!
//! A way takes steps of µ that change its motion by up to 5 %, and so passes a jump by 1 % unseen. Such a jump leaves a trace
//! where it is not the same in both directions: beside it the ways have two motions. There each way is followed once more, in
//! small steps that change its motion by no more than 0.5 %. Two motions at the same value differ from there on.

use super::follow::Run;
use super::followed::{Followed, Reached, are_alike};
use crate::Error;

impl Run<'_> {
    /// Follows both ways closely from each value on at which, or at the next one, they have two periodic motions. `false` if the
    /// watch ended it.
    pub(super) fn find_small_jumps(&self, ways: &mut [Followed]) -> Result<bool, Error> {
        for place in [0, 1] {
            let values = self.values(ways[place].way);
            let mut step = 1;
            while step < values.len() {
                let are_two = |value| ways[place].is_other_than(&ways[1 - place], value);
                let has_trace = match [values[step - 1], values[step]].map(are_two) {
                    [Some(before), Some(after)] => before || after,
                    _ => false,
                };
                if !has_trace {
                    step += 1;
                    continue;
                }
                let Some(stretch) = self.follow_closely(&ways[place], &values[step - 1..])? else {
                    return Ok(false);
                };
                let last = stretch.passed.last().map(|last| last.point.friction);
                step += values[step..].iter().take_while(|value| Some(**value) != last).count() + 1;
                ways[place].take_over(stretch);
            }
        }
        Ok(true)
    }

    /// A way once more from the first of some values, in small steps, up to the next of them at which it has the motion that it
    /// had before. `None` if the watch ended it.
    fn follow_closely(&self, way: &Followed, values: &[f64]) -> Result<Option<Followed>, Error> {
        let Some(first) = way.at(values[0]) else { return Ok(None) };
        let label = format!("{} closely after {:?}", way.label, values[0]);
        let mut stretch =
            Followed { looks_closely: true, ..Followed::way(way.way, label, first.clone()) };
        let is_other = |stretch: &Followed| {
            let last = stretch.passed.last();
            let before = last.and_then(|last| way.at(last.point.friction));
            let endings = [last, before].map(|reached| reached.and_then(Reached::ending));
            stretch.goes_on() && !matches!(endings, [Some(a), Some(b)] if are_alike(a, b))
        };
        Ok(self.advance_through(&mut stretch, &values[1..], is_other)?.then_some(stretch))
    }
}
