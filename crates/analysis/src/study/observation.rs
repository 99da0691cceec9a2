//! Settings of the observation of a motion: the output, the time between rows and the windows.

use super::drive::last_edge;
pub(super) use crate::sweep::observed::{ROWS_A_PERIOD, frequencies};
pub use crate::sweep::observed::{displacements, first_displacement, output, unit};
use amontons::Error;
use amontons::error::Short;
use amontons::integrator::EventDriven;
use amontons::model::LumpedModel;
use amontons::scene::{IntegratorChoice, Method, Scene, Selection};
use amontons::selection::{Selected, resolve};
use serde::Serialize;

/// Periods of the slowest mode in a window. The resolution of lines is then 4/50 of its frequency: nearer ones are
/// not told apart.
const PERIODS: f64 = 50.0;
/// The fewest periods in a window that a person may ask for.
const FEWEST_PERIODS: f64 = 5.0;
/// The most rows of a window, whatever lies between the slowest and the fastest mode.
const MOST_ROWS: f64 = 100_000.0;
/// The most rows of a window that a person may ask for; the spectrum of more would take all memory.
const MOST_WISHED_ROWS: f64 = 5e6;
/// The fewest rows that a window may have, which its spectrum needs.
const FEWEST_ROWS: f64 = 64.0;
/// Windows that a motion may take to settle, after as many as signals take to their last edge, but no more than these.
const LONGEST: f64 = 60.0;
const MOST_WAITED: f64 = 1000.0;

/// Settings with which a motion is observed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ObservationSettings {
    /// The output whose amplitude and frequency are given, by its name in the FMU.
    pub of: String,
    /// Time between two rows, s.
    pub interval: f64,
    /// Length of a window over which a motion is observed, s: a whole number of intervals.
    pub window: f64,
    /// The longest time that a motion may take to settle, s: a whole number of windows.
    pub longest: f64,
}

/// Settings that a person asks for; `None` is derived from the scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObservationRequest<'a> {
    /// The output that is observed ([`ObservationSettings::of`]).
    pub of: Option<&'a str>,
    /// Time between two rows, s ([`ObservationSettings::interval`]).
    pub interval: Option<f64>,
    /// Length of a window, s ([`ObservationSettings::window`]).
    pub window: Option<f64>,
    /// The longest time that a motion may take to settle, s ([`ObservationSettings::longest`]).
    pub longest: Option<f64>,
}

impl ObservationSettings {
    /// Derives the settings from a scene: its first displacement; rows a twentieth of the fastest mode's period
    /// apart, rounded down to a 1, 2 or 5; windows of 50 periods of the slowest mode at rest in sliding, rounded up;
    /// 60 windows after the last edge of a signal. A scene without modes is observed as its experiment says.
    ///
    /// If rows are asked for that lie farther apart than the fastest mode allows, rows are taken at a whole part of
    /// the interval that is short enough, so that no frequency is mistaken for another one.
    ///
    /// # Errors
    /// Returns an error if there is no such output, a window has fewer than 64 rows or five periods, or the last edge
    /// of a signal is more than 1000 windows away.
    pub fn of(scene: &Scene, request: &ObservationRequest<'_>) -> Result<Self, Error> {
        let of = match request.of {
            Some(name) => output(scene, name)?.name,
            None => first_displacement(scene)?,
        };
        let frequencies = frequencies(scene);
        let needed = frequencies.map(|[_, fastest]| round_down(1.0 / (ROWS_A_PERIOD * fastest)));
        let interval = match (request.interval, needed) {
            (Some(wished), Some(needed)) => wished / (wished / needed * (1.0 - 1e-9)).ceil(),
            (Some(wished), None) => wished,
            (None, Some(needed)) => needed,
            (None, None) => scene.experiment.output_interval,
        };
        let wanted = request.window.unwrap_or_else(|| match frequencies {
            Some([slowest, _]) => round_up(PERIODS / slowest).min(MOST_ROWS * interval),
            None => scene.experiment.stop_time,
        });
        let rows = (wanted / interval).round();
        if rows < FEWEST_ROWS {
            return Err(Error::argument(format!(
                "a window of {} s has {rows} rows, {} s apart, too few for its spectrum; give a \
                 --window of {} s or more, or a shorter --interval",
                Short(wanted),
                Short(interval),
                Short(FEWEST_ROWS * interval)
            )));
        }
        if rows > MOST_WISHED_ROWS {
            return Err(Error::argument(format!(
                "a window of {} s has {rows:.3e} rows, {} s apart, more than fit into memory; give a --window \
                 of {} s or less, or a longer --interval",
                Short(wanted),
                Short(interval),
                Short(MOST_WISHED_ROWS * interval)
            )));
        }
        let window = rows * interval;
        if let Some([slowest, _]) =
            frequencies.filter(|[slowest, _]| window * slowest < FEWEST_PERIODS)
        {
            return Err(Error::argument(format!(
                "a window of {window} s has {:.1} periods of the slowest mode ({slowest:.4} Hz), too few to \
                 identify the kind of motion; give a --window of {} s or more",
                window * slowest,
                round_up(FEWEST_PERIODS / slowest)
            )));
        }
        let edge = last_edge(scene);
        let waits = (edge / window).ceil();
        let windows = match request.longest {
            Some(longest) => (longest / window).round().max(1.0),
            None if waits <= MOST_WAITED => waits + LONGEST,
            None => {
                return Err(Error::argument(format!(
                    "the final motion can be found only after the last edge of the scene's signals, at {} s, more than \
                     {MOST_WAITED} windows of {} s after the start; give a --longest beyond it, or end the signals sooner",
                    Short(edge),
                    Short(window)
                )));
            }
        };
        Ok(Self { of, interval, window, longest: windows * window })
    }

    /// Looks at a scene as [`of`](Self::of) does, and gives it the method and step of [`pace`].
    ///
    /// # Errors
    /// Returns an error in the same cases as [`of`](Self::of).
    pub fn paced(scene: &mut Scene, request: &ObservationRequest<'_>) -> Result<Self, Error> {
        let observation = Self::of(scene, request)?;
        pace(scene, &observation);
        Ok(observation)
    }

    /// Rows in a window.
    #[must_use]
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    pub fn rows(&self) -> u64 {
        (self.window / self.interval).round() as u64
    }

    /// Windows that a motion may take to settle.
    #[must_use]
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    pub fn windows(&self) -> usize {
        (self.longest / self.window).round() as usize
    }
}

/// A function that gives a scene the method and step in which its motion is computed, and returns the settings with
/// which it is observed.
///
/// A study over a parameter calls it for each value: other stiffnesses and masses have other frequencies.
pub type Prepare<'a> = &'a (dyn Fn(&mut Scene) -> Result<ObservationSettings, Error> + Sync);

/// Gives a scene the method and step that studies take unless told otherwise: exact motion from row to row, which is
/// the quickest way to where a motion ends, and the truest. What exact motion does not take, as Stribeck's law, keeps its
/// own.
pub fn pace(scene: &mut Scene, observation: &ObservationSettings) {
    if EventDriven::new(&LumpedModel::from(&*scene)).is_ok() {
        (scene.method, scene.step) = (Method::EventDriven, observation.interval);
        scene.selection = Selection::Given;
    }
}

/// Sets the method and step of a study: those that are chosen; exact motion from row to row if only that method is; and
/// those that `default` sets if nothing is chosen. A tolerance chooses the step once, for the scene as it is given, so
/// that all runs have the same step; that choice is returned.
///
/// # Errors
/// Returns an error if the scene cannot have this choice ([`IntegratorChoice::apply`]).
pub fn set_pace(
    scene: &mut Scene,
    choice: &IntegratorChoice,
    observation: &ObservationSettings,
    default: fn(&mut Scene, &ObservationSettings),
) -> Result<Option<Selected>, Error> {
    if !derive_pace(scene, choice, observation, default)? {
        choice.apply(scene)?;
    }
    Ok(resolve(scene))
}

/// Derives the step of a scene from the settings of its observation, as [`set_pace`] does, unless it is chosen. Returns
/// `false` if it is.
///
/// # Errors
/// Returns an error if the scene cannot have this choice.
pub fn derive_pace(
    scene: &mut Scene,
    choice: &IntegratorChoice,
    observation: &ObservationSettings,
    default: fn(&mut Scene, &ObservationSettings),
) -> Result<bool, Error> {
    match choice {
        IntegratorChoice { method: None, step: None, preset: None } => default(scene, observation),
        IntegratorChoice { method: Some(Method::EventDriven), step: None, preset: None } => {
            scene.set_integrator(choice.method, Some(observation.interval))?;
        }
        _ => return Ok(false),
    }
    Ok(true)
}

/// The largest 1, 2 or 5 times a power of ten that is not above a value.
fn round_down(value: f64) -> f64 {
    let power = libm::log10(value).floor();
    let digits = [5, 2, 1].map(|digit| format!("{digit}e{power}").parse().unwrap_or(value));
    digits.into_iter().find(|round| *round <= value * (1.0 + 1e-12)).unwrap_or(value)
}

/// The smallest that is not below it.
fn round_up(value: f64) -> f64 {
    let down = round_down(value);
    if down >= value * (1.0 - 1e-12) { down } else { round_down(2.5 * down) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use amontons::scene::builtin;

    #[test]
    fn intervals_and_windows_are_round_numbers() {
        for (value, down, up) in
            [(2.2e-4, 2e-4, 5e-4), (1.15, 1.0, 2.0), (5.0, 5.0, 5.0), (7.0, 5.0, 10.0)]
        {
            assert_eq!([round_down(value), round_up(value)], [down, up]);
        }
    }

    #[test]
    fn set_1_is_looked_at_for_two_seconds_at_a_time() {
        // Its slowest mode in sliding has 43.52 Hz (Table 2), its fastest in any state some 232 Hz.
        let scene = builtin("set1").unwrap().scene();
        let observation = ObservationSettings::of(&scene, &ObservationRequest::default()).unwrap();
        assert_eq!(
            (observation.interval, observation.window, observation.longest),
            (2e-4, 2.0, 120.0)
        );
        assert_eq!(
            (observation.rows(), observation.windows(), &*observation.of),
            (10_000, 60, "module[1].x1")
        );
        let wrong = ObservationSettings::of(
            &scene,
            &ObservationRequest { of: Some("modul[1].x1"), ..ObservationRequest::default() },
        )
        .unwrap_err();
        assert!(wrong.is_argument() && wrong.to_string().contains("did you mean"), "{wrong}");
        let short = ObservationSettings::of(
            &scene,
            &ObservationRequest { window: Some(1e-3), ..ObservationRequest::default() },
        )
        .unwrap_err();
        assert!(short.is_argument(), "{short}");
    }
}
