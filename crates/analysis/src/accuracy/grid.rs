//! Times at which runs are observed, and the ladder of steps that goes with them.

use amontons::Error;
use amontons::decimal::one_two_five;
use amontons::error::Short;
use amontons::scene::{Method, Scene};

/// The fewest instants at which a window is observed.
const FEWEST: u64 = 200;
/// The most displacements that are kept of a run.
const MOST_KEPT: f64 = 2e7;
/// Steps are the interval divided by 1, 2, 5, 10, …; these are the largest numbers of rows for the paper's scheme and
/// for the event-driven integrator, whose step matters little.
const SCHEME_ROWS: usize = 11;
const EVENT_DRIVEN_ROWS: usize = 4;
/// The most work of a row: steps times degrees of freedom, of which those of a network cost more.
const MOST_WORK: f64 = 1e9;
const NETWORK: f64 = 30.0;

/// Equal intervals, at whose ends a run is observed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Their length, s.
    pub interval: f64,
    /// Number of intervals.
    pub intervals: u64,
}

/// A method with a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepCandidate {
    /// The method.
    pub method: Method,
    /// Step of the method, s.
    pub step: f64,
    /// The number of steps in an interval.
    pub steps: u64,
}

impl StepCandidate {
    /// The scene with this method and step.
    #[must_use]
    pub fn scene(&self, scene: &Scene) -> Scene {
        scene.with_integrator(self.method, self.step)
    }
}

impl Grid {
    /// The grid of a scene: its stop time in equal intervals, not longer than its output interval, nor than
    /// the critical step, if that is known: so often is seen whatever moves.
    #[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    pub(super) fn of(scene: &Scene, critical: Option<f64>) -> Result<Self, Error> {
        let stop = scene.experiment.stop_time;
        // A whole number but for rounding is that number. Casts saturate.
        let parts = |whole: f64, part: f64| (whole / part * (1.0 - 1e-9)).ceil().max(1.0);
        let outputs = parts(stop, scene.experiment.output_interval);
        let longest = critical.unwrap_or(f64::INFINITY).min(stop / FEWEST as f64);
        let count = outputs * parts(stop / outputs, longest);
        let kept = count * scene.external_forces().count() as f64;
        if kept > MOST_KEPT {
            return Err(Error::argument(format!(
                "a window of {} s has {kept:.1e} displacement values to compare, more than the limit of \
                 {MOST_KEPT:e}; choose a shorter --stop-time, or a longer output_interval in the scene's [experiment]",
                Short(stop)
            )));
        }
        Ok(Self { interval: stop / count, intervals: count as u64 })
    }

    /// The end of an interval (from 1), s; 0 is the start.
    #[must_use]
    #[allow(clippy::cast_precision_loss)]
    pub fn time(&self, interval: u64) -> f64 {
        interval as f64 * self.interval
    }

    /// A method with the step that divides an interval into `steps` steps.
    #[must_use]
    #[allow(clippy::cast_precision_loss)]
    pub fn candidate(&self, method: Method, steps: u64) -> StepCandidate {
        StepCandidate { method, step: self.interval / steps as f64, steps }
    }

    #[allow(clippy::cast_precision_loss)]
    pub(super) fn candidates(&self, scene: &Scene, critical: Option<f64>) -> Vec<StepCandidate> {
        let dofs = scene.external_forces().count() as f64;
        let cost = if scene.network().is_some() { NETWORK * dofs } else { dofs };
        let work = |candidate: &StepCandidate| (candidate.steps * self.intervals) as f64 * cost;
        let of = |method| divisors().map(move |steps| self.candidate(method, steps));
        let scheme = of(Method::ForwardIncrement)
            .filter(|candidate| critical.is_some_and(|critical| candidate.step <= critical))
            .take_while(|candidate| work(candidate) <= MOST_WORK)
            .take(SCHEME_ROWS);
        scheme.chain(of(Method::EventDriven).take(EVENT_DRIVEN_ROWS)).collect()
    }
}

/// The numbers of steps in an interval: 1, 2, 5, 10, …
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn divisors() -> impl Iterator<Item = u64> {
    one_two_five().take(3 * SCHEME_ROWS).map(|steps| steps as u64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use amontons::scene::builtin;

    #[test]
    fn steps_are_short_decimals_that_divide_the_interval() {
        let scene = builtin("set1").unwrap().scene();
        let grid = Grid::of(&scene, Some(3.02e-4)).unwrap();
        assert_eq!((grid.interval, grid.intervals), (2e-4, 30_000));
        let candidates = grid.candidates(&scene, Some(1.5e-4));
        let steps =
            candidates.iter().filter(|candidate| candidate.method == Method::ForwardIncrement);
        let steps: Vec<f64> = steps.map(|candidate| candidate.step).collect();
        assert_eq!(steps[..4], [1e-4, 4e-5, 2e-5, 1e-5]);
    }

    #[test]
    fn a_window_that_is_no_whole_number_of_intervals_is_parted_evenly() {
        let mut scene = builtin("set1").unwrap().scene();
        (scene.experiment.stop_time, scene.experiment.output_interval) = (0.5, 0.15);
        let grid = Grid::of(&scene, None).unwrap();
        assert!(grid.intervals >= FEWEST && grid.intervals.is_multiple_of(4), "{grid:?}");
        assert!((grid.time(grid.intervals) - 0.5).abs() < 1e-15);
        // Not longer than the critical step.
        assert!(Grid::of(&scene, Some(3e-4)).unwrap().interval <= 3e-4);
        scene.experiment.stop_time = 1e7;
        assert!(Grid::of(&scene, None).unwrap_err().is_argument());
    }
}
