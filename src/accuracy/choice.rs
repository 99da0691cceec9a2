//! The cheapest method and step that keep a tolerance, by what is measured.

use super::{Row, Rung, Study, Watch};
use crate::Error;
use crate::scene::Method;

/// A shorter step that leaves more than this of the error gains nothing.
const NO_GAIN: f64 = 0.7;

/// A row that was looked at for a tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compared {
    /// The row.
    pub row: Row,
    /// The error that a tolerance is held against; `None` where a scene that moves has no cycle to compare.
    pub error: Option<f64>,
    /// What the run costs, as [`Cost`](crate::integrator::Cost) counts it.
    pub operations: f64,
}

impl Compared {
    /// Is its error within the tolerance?
    #[must_use]
    pub fn keeps(&self, tolerance: f64) -> bool {
        self.error.is_some_and(|error| error <= tolerance)
    }
}

/// What a tolerance leads to.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The cheapest row that keeps the tolerance; where none does, the most accurate one.
    pub taken: Compared,
    /// Of the other method the row that comes nearest to it: the cheapest that keeps the tolerance, or the
    /// most accurate one that was looked at before it got dearer than the one taken.
    pub other: Option<Compared>,
}

impl Study {
    /// A row with the error that a tolerance is held against: the rms error or, where the reference itself
    /// does not keep its phase ([`is_chaotic`](Self::is_chaotic)), the larger one of amplitude and frequency.
    /// What does not move is exact; what has lost the frequency that the reference has, no match for it.
    #[must_use]
    pub fn compared(&self, row: Row) -> Compared {
        let errors = row.errors;
        let error = match (self.scale, self.is_chaotic()) {
            (None, _) => Some(0.0),
            (Some(_), false) => errors.rms,
            (Some(_), true) => {
                let frequency = match self.cycle.frequency {
                    Some(_) => errors.frequency,
                    None => Some(0.0),
                };
                errors
                    .amplitude
                    .zip(frequency)
                    .map(|(amplitude, frequency)| amplitude.max(frequency))
            }
        };
        #[allow(clippy::cast_precision_loss)]
        let events = row.statistics.state_changes() as f64;
        let operations = self.operations(row.rung, events);
        Compared { row, error, operations }
    }

    fn operations(&self, rung: Rung, events: f64) -> f64 {
        self.cost.run(rung.method, rung.step, self.scene.experiment.stop_time, events)
    }

    /// Chooses method and step by a tolerance, from runs of this scene: `None` if the watch ended it. Nothing
    /// depends on times, so the same scene gives the same choice each time.
    ///
    /// # Errors
    /// Neither method can run the scene: the first failure.
    pub fn choose(&self, tolerance: f64, watch: Watch<'_>) -> Result<Option<Choice>, Error> {
        let (mut compared, mut failure): (Vec<Compared>, _) = (Vec::new(), None);
        #[allow(clippy::cast_precision_loss)]
        let events = self.reference.statistics.state_changes() as f64;
        // Exact motion first: it says from where on a step of the scheme is too dear.
        for method in [Method::EventDriven, Method::ForwardIncrement] {
            let mut last = f64::INFINITY;
            for rung in self.long_ladder(method) {
                let kept = compared.iter().find(|one| one.keeps(tolerance));
                if kept.is_some_and(|kept| self.operations(rung, events) >= kept.operations) {
                    break;
                }
                match self.row(rung, &mut *watch) {
                    Ok(None) => return Ok(None),
                    Ok(Some(row)) => compared.push(self.compared(row)),
                    Err(error) => {
                        failure.get_or_insert(error);
                        continue;
                    }
                }
                let latest = compared[compared.len() - 1];
                let error = latest.error.unwrap_or(f64::INFINITY);
                let gains = error <= NO_GAIN * last || method == Method::ForwardIncrement;
                last = error;
                if latest.keeps(tolerance) || !gains {
                    break;
                }
            }
        }
        let best = |among: &dyn Fn(&&Compared) -> bool| {
            let all = || compared.iter().filter(among);
            let cheapest = all().filter(|one| one.keeps(tolerance));
            let cheapest = cheapest.min_by(|a, b| a.operations.total_cmp(&b.operations));
            let error = |one: &Compared| one.error.unwrap_or(f64::INFINITY);
            cheapest.or_else(|| all().min_by(|a, b| error(a).total_cmp(&error(b)))).copied()
        };
        match best(&|_| true) {
            Some(taken) => {
                let other = best(&|one| one.row.rung.method != taken.row.rung.method);
                Ok(Some(Choice { taken, other }))
            }
            None => Err(failure.unwrap_or_else(|| Error::step("no method can run the scene"))),
        }
    }
}
