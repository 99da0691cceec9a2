//! Jumps between periodic motions that look alike.
//!
//! A way takes steps of µ that change its motion by up to 5 %, and so passes a jump by 1 % unseen. Such a jump leaves a trace
//! where it is not the same in both directions: beside it the ways have two motions. There each way is followed once more, in
//! small steps. Two periodic motions that are known exactly then count as two from 0.5 % on.

use super::follow::PlanRun;
use super::followed::{Followed, Reached, are_alike};
use crate::study::difference::is_exact;
use amontons::Error;

impl PlanRun<'_> {
    /// Follows both ways closely from each value on at which, or at the next one, they have two periodic motions, until no such
    /// value is left at which that was not done. Returns the motions that a way was on before and has not met again, each with
    /// the place of the way. `None` if the watch ended it.
    pub(super) fn find_small_jumps(
        &self,
        ways: &mut [Followed],
    ) -> Result<Option<Vec<(usize, Reached)>>, Error> {
        let mut lost = Vec::new();
        let mut is_close = [0, 1].map(|_| vec![false; self.plan.values.len()]);
        loop {
            let before = is_close.clone();
            for place in [0, 1] {
                let values = self.values(ways[place].way);
                for step in 1..values.len() {
                    let mut pair = values[step - 1..=step].iter();
                    let has_trace = pair.any(|v| ways[place].is_other_than(&ways[1 - place], *v));
                    let Some(first) = ways[place].at(values[step - 1]) else { break };
                    if is_close[place][step] || !has_trace {
                        continue;
                    }
                    let Some(stretch) =
                        self.follow_closely(&ways[place], first, &values[step..])?
                    else {
                        return Ok(None);
                    };
                    let passed = stretch.passed.iter().map(|reached| reached.point.friction);
                    for friction in passed.skip(1) {
                        if let Some(step) = values.iter().position(|value| *value == friction) {
                            is_close[place][step] = true;
                        }
                    }
                    let left = ways[place].take_over(stretch);
                    lost.extend(left.into_iter().map(|reached| (place, reached)));
                }
            }
            if is_close == before {
                return Ok(Some(lost));
            }
        }
    }

    /// Follows a way once more from the motion that it has reached through some values, in small steps, up to the
    /// first of them at which it has the motion that it had before. `None` if the watch ended it.
    fn follow_closely(
        &self,
        way: &Followed,
        first: &Reached,
        values: &[f64],
    ) -> Result<Option<Followed>, Error> {
        let label = format!("{} closely after {:?}", way.label, first.point.friction);
        let mut stretch =
            Followed { looks_closely: true, ..Followed::way(way.way, label, first.clone()) };
        let is_other = |stretch: &Followed| {
            let last = stretch.passed.last();
            let before = last.and_then(|last| way.at(last.point.friction));
            let is_back = match [last, before].map(|reached| reached.and_then(Reached::ending)) {
                [Some(a), Some(b)] => are_alike(a, b) && is_exact(a) == is_exact(b),
                _ => false,
            };
            stretch.can_continue() && !is_back
        };
        Ok(self.advance_through(&mut stretch, values, is_other)?.then_some(stretch))
    }
}
