//! The eigenvalues of a draw, and the pieces of work in which draws are made.

use super::sensitivity::{Role, Sums, sums_over};
use super::sobol::{Scrambled, Sobol};
use super::uncertain::{Parameter, drawn, scene_with};
use crate::journal::Journal;
use crate::stability::parallel::collect;
use crate::stability::{Linearised, named_states};
use crate::watch::Watch;
use amontons::Error;
use amontons::scene::Scene;
use amontons::stability::Spectrum;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Draws that are one piece of work.
const PIECE: u64 = 256;

/// The eigenvalues of one draw, in short.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// The largest growth rate, 1/s; `None` if there is no equilibrium in sliding.
    pub growth: Option<f64>,
    /// Frequencies of the growing modes, Hz, ascending; 0 of those that do not oscillate.
    pub growing: Vec<f64>,
}

/// The verdict on a scene in a contact state: that of this name, or uniform sliding.
///
/// # Errors
/// Returns an error if there is no such state, or if it cannot be analysed.
pub fn verdict(scene: &Scene, state: Option<&str>) -> Result<Verdict, Error> {
    let here = Linearised::of(scene);
    match here.equilibrium() {
        Err(error) if error.is_equilibrium() => {
            return Ok(Verdict { growth: None, growing: Vec::new() });
        }
        Err(error) => return Err(error),
        Ok(_) => {}
    }
    let states = match state {
        None => here.uniform_sliding()?,
        Some(name) => named_states(name, scene, &here)?,
    };
    let spectrum = Spectrum::of(here.linear()?, &states)?;
    let growth = spectrum.growth_rate();
    if growth == f64::NEG_INFINITY {
        return Err(Error::analysis(
            "no motion is possible in this contact state; name another one with --state",
        ));
    }
    let straight = spectrum.real.iter().filter(|rate| **rate > 0.0).map(|_| 0.0);
    let swinging = spectrum.oscillating.iter().filter(|value| value.re > 0.0);
    Ok(Verdict {
        growth: Some(growth),
        growing: straight.chain(swinging.map(|value| value.im / TAU)).collect(),
    })
}

/// The error of values that cannot be analysed, with these values in words; `what` has them.
pub(super) fn unanalysed(error: &Error, what: &str, values: &str) -> Error {
    let text = format!("{what} cannot be analysed: {error}; {what} has {values}");
    if error.is_argument() { Error::argument(text) } else { Error::analysis(text) }
}

/// Draws of a scene, all of which are made in the same way.
pub struct Design<'a> {
    /// The scene whose parameters scatter, without signals.
    pub scene: &'a Scene,
    /// The parameters that scatter.
    pub parameters: &'a [Parameter],
    /// Name of the contact state; `None` for uniform sliding.
    pub state: Option<&'a str>,
    /// Number of independent scramblings.
    pub scramblings: u64,
    /// Number of points of each scrambling, a power of two.
    pub points: u64,
    /// The seed of all scramblings.
    pub seed: u64,
    /// `true` if the points are evaluated that Sobol indices need.
    pub has_indices: bool,
}

/// The draws of one piece of work.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Piece {
    /// The largest growth rate of each draw, 1/s; `None` of a draw without equilibrium.
    pub growth: Vec<Option<f64>>,
    /// Frequencies of the growing modes of each draw, Hz.
    pub growing: Vec<Vec<f64>>,
    /// Sums for the indices of the largest growth rate, if each point has one.
    pub of_growth: Option<Sums>,
    /// Sums for the indices of 1 if the draw is unstable and 0 if not.
    pub of_instability: Option<Sums>,
}

impl Design<'_> {
    /// The pieces of each scrambling in the order of the points; `None` if the watch ended the work.
    ///
    /// # Errors
    /// Returns an error if a draw is impossible or cannot be analysed, or if the journal cannot be written.
    pub fn pieces(
        &self,
        journal: &Journal,
        watch: Watch<'_>,
    ) -> Result<Option<Vec<Vec<Piece>>>, Error> {
        let sobol = Sobol::new(2 * self.parameters.len());
        // Growth rates are summed from that of the scene: their squares keep their digits.
        let own = verdict(self.scene, self.state)?.growth.unwrap_or(0.0);
        let size = PIECE.min(self.points);
        let of_one = self.points / size;
        let work = |place: usize| {
            let (scrambling, from) = (place as u64 / of_one, place as u64 % of_one * size);
            let key = format!("scrambling {}, draws {from} to {}", scrambling + 1, from + size - 1);
            journal.piece(&key, || {
                self.piece(
                    &Scrambled::new(&sobol, self.seed, scrambling),
                    from..from + size,
                    own,
                    watch,
                )
            })
        };
        let count = usize::try_from(self.scramblings * of_one).unwrap_or(usize::MAX);
        let found = collect(count, &work, &watch.parts(count))?;
        let Some(found) = found.into_iter().collect::<Option<Vec<Piece>>>() else {
            return Ok(None);
        };
        let each = usize::try_from(of_one).unwrap_or(usize::MAX);
        Ok(Some(found.chunks(each).map(<[Piece]>::to_vec).collect()))
    }

    fn piece(
        &self,
        points: &Scrambled<'_>,
        numbers: std::ops::Range<u64>,
        own: f64,
        watch: Watch<'_>,
    ) -> Result<Option<Piece>, Error> {
        let mut found = Piece {
            growth: Vec::new(),
            growing: Vec::new(),
            of_growth: None,
            of_instability: None,
        };
        let mut values = vec![0.0; self.parameters.len()];
        let mut is_over = false;
        let mut evaluate = |role: Role, at: &[f64]| {
            is_over |= watch.is_over();
            if is_over {
                return Ok([None; 2]);
            }
            for ((value, parameter), at) in values.iter_mut().zip(self.parameters).zip(at) {
                *value = parameter.at(*at);
            }
            let scene = scene_with(self.scene, self.parameters, &values)?;
            let Verdict { growth, growing } = verdict(&scene, self.state)
                .map_err(|error| unanalysed(&error, "a draw", &drawn(self.parameters, &values)))?;
            let is_unstable = growth.is_some_and(|growth| growth > 0.0);
            if role == Role::Draw {
                found.growth.push(growth);
                found.growing.push(growing);
            }
            Ok([growth.map(|growth| growth - own), Some(f64::from(u8::from(is_unstable)))])
        };
        let dimensions = self.parameters.len();
        if self.has_indices {
            let sums = sums_over(points, dimensions, numbers, &mut evaluate)?;
            [found.of_growth, found.of_instability] = sums;
        } else {
            for number in numbers {
                let at: Vec<f64> = (0..dimensions).map(|d| points.coordinate(number, d)).collect();
                evaluate(Role::Draw, &at)?;
            }
        }
        Ok((!is_over).then_some(found))
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Uncertain, parameters};
    use super::*;
    use amontons::scene::builtin;

    /// Half of the values between zero and the smallest double are rounded to zero, with which no surface moves.
    #[test]
    fn a_draw_that_cannot_be_analysed_is_told_with_its_values() {
        let scene = builtin("set1").unwrap().scene();
        let given = ["friction.coefficient=uniform(1,2)", "slider.velocity=uniform(0,5e-324)"];
        let given = given.map(|text| Uncertain::parse(text).unwrap());
        let scattering = parameters(&scene, &given).unwrap();
        let design = Design {
            scene: &scene,
            parameters: &scattering,
            state: None,
            scramblings: 16,
            points: 16,
            seed: 1,
            has_indices: false,
        };
        let error = design.pieces(&Journal::forgotten(), Watch::IDLE).unwrap_err();
        let told = error.to_string();
        assert!(told.starts_with("a draw cannot be analysed: no surface moves"), "{told}");
        assert!(told.contains("a draw has friction.coefficient = 1."), "{told}");
        assert!(told.contains("slider.velocity = 0.0"), "{told}");
    }
}
