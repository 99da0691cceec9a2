//! The probability that a contact state is unstable.

use super::draws::{Design, Piece, Verdict, verdict};
use super::histogram::{Class, families, histogram};
use super::interval::{Estimate, of_counts};
use super::sensitivity::{Index, Sums, indices, indices_of_share};
use super::sobol::MOST_POINTS;
use crate::journal::Journal;
use crate::watch::Watch;
use amontons::Error;
use serde::Serialize;

/// The fewest scramblings: with fewer, Student's t makes intervals wide.
pub const FEWEST_SCRAMBLINGS: u64 = 16;
/// The most scramblings.
const MOST_SCRAMBLINGS: u64 = 1024;
/// Draws are kept in memory: this many take a few gigabytes.
const MOST_DRAWS: u64 = 1 << 24;
/// The fewest points of a scrambling.
const FEWEST_POINTS: u64 = 16;
/// The most families of frequencies that are told apart.
const MOST_FAMILIES: usize = 12;

/// Probabilities and indices from the draws of a scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Robustness {
    /// The largest growth rate with the scene's own values, 1/s; `None` if there is no equilibrium.
    pub nominal_growth: Option<f64>,
    /// Number of all draws.
    pub draws: u64,
    /// The probability that the state is unstable.
    pub unstable: Estimate,
    /// The probability that it is stable.
    pub stable: Estimate,
    /// The probability that there is no equilibrium in sliding.
    pub no_equilibrium: Estimate,
    /// Ranges of frequencies, Hz, with the probability that a mode grows in each.
    pub bands: Vec<Band>,
    /// The indices of the largest growth rate, for each parameter; `None` if they were not asked for, if a point has no
    /// equilibrium, or if the rate does not vary.
    pub of_growth: Option<Vec<Index>>,
    /// The indices of 1 if the state is unstable and 0 if not; `None` if they were not asked for, or if fewer than 32 points are
    /// unstable, or stable.
    pub of_instability: Option<Vec<Index>>,
    /// The histogram of the largest growth rate, 1/s.
    pub histogram: Vec<Class>,
}

/// A range of frequencies.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Band {
    /// Its ends, Hz: a band that was asked for holds its lower end alone, a family that was found holds both.
    pub frequencies: [f64; 2],
    /// The probability that a mode grows with a frequency in this range.
    pub unstable: Estimate,
}

/// Refuses a design of too few or too many draws.
///
/// # Errors
/// Returns an error that says how many there may be.
pub fn check_size(scramblings: u64, points: u64) -> Result<(), Error> {
    if !(FEWEST_SCRAMBLINGS..=MOST_SCRAMBLINGS).contains(&scramblings) {
        return Err(Error::argument(format!(
            "{scramblings} scramblings are not possible: intervals follow from how far independent scramblings differ; give \
             {FEWEST_SCRAMBLINGS} to {MOST_SCRAMBLINGS} --scramblings"
        )));
    }
    if !points.is_power_of_two() || !(FEWEST_POINTS..=MOST_POINTS).contains(&points) {
        return Err(Error::argument(format!(
            "{points} points are not possible: a net has a power of two; give --points from {FEWEST_POINTS} to \
             {MOST_POINTS}, such as {}",
            points.min(MOST_POINTS).next_power_of_two().max(FEWEST_POINTS)
        )));
    }
    if scramblings * points > MOST_DRAWS {
        return Err(Error::argument(format!(
            "{scramblings} scramblings of {points} points are {} draws, but at most {MOST_DRAWS} are kept; give fewer --points or \
             --scramblings",
            scramblings * points
        )));
    }
    Ok(())
}

/// The probability that the state of a design is unstable, with its intervals, and which parameters that is due to. `bands`
/// are ranges of frequencies, Hz; without them, growing modes are sorted into families by their frequencies. `None` if the
/// watch ended the work: finished pieces are in the journal.
///
/// # Errors
/// Returns an error if there are too few or too many draws, if a draw is impossible or cannot be analysed, or if the journal
/// cannot be written.
pub fn robustness(
    design: &Design<'_>,
    bands: Option<&[[f64; 2]]>,
    journal: &Journal,
    watch: Watch<'_>,
) -> Result<Option<Robustness>, Error> {
    check_size(design.scramblings, design.points)?;
    let Verdict { growth: nominal_growth, .. } = verdict(design.scene, design.state)?;
    let Some(scramblings) = design.pieces(journal, watch)? else { return Ok(None) };
    let probability = |is_such: &dyn Fn(Option<f64>) -> bool| {
        let count = |pieces: &Vec<Piece>| {
            let growth = pieces.iter().flat_map(|piece| &piece.growth);
            growth.filter(|growth| is_such(**growth)).count() as u64
        };
        of_counts(&scramblings.iter().map(count).collect::<Vec<_>>(), design.points)
    };
    let all = || scramblings.iter().flatten();
    let growth: Vec<f64> = all().flat_map(|piece| piece.growth.iter().flatten().copied()).collect();
    let sums_of = |sums: fn(&Piece) -> Option<&Sums>| {
        let merged = |pieces: &Vec<Piece>| {
            let mut merged = Sums::default();
            for piece in pieces {
                merged.merge(sums(piece)?);
            }
            Some(merged)
        };
        scramblings.iter().map(merged).collect::<Option<Vec<Sums>>>()
    };
    let of_growth = sums_of(|piece| piece.of_growth.as_ref());
    let of_instability = sums_of(|piece| piece.of_instability.as_ref());
    Ok(Some(Robustness {
        nominal_growth,
        draws: design.scramblings * design.points,
        unstable: probability(&|growth| growth.is_some_and(|growth| growth > 0.0)),
        stable: probability(&|growth| growth.is_some_and(|growth| growth <= 0.0)),
        no_equilibrium: probability(&|growth| growth.is_none()),
        bands: in_bands(&scramblings, design.points, bands),
        of_growth: of_growth.and_then(|sums| indices(&sums)),
        of_instability: of_instability.and_then(|sums| indices_of_share(&sums)),
        histogram: histogram(&growth),
    }))
}

/// The probability of growth in each band, or in each family of frequencies.
fn in_bands(scramblings: &[Vec<Piece>], points: u64, bands: Option<&[[f64; 2]]>) -> Vec<Band> {
    let found = || {
        let draws = scramblings.iter().flatten().flat_map(|piece| &piece.growing);
        let mut found = families(&draws.flatten().copied().collect::<Vec<_>>());
        // A crowd of families is one range.
        if found.len() > MOST_FAMILIES {
            found = vec![[found[0][0], found[found.len() - 1][1]]];
        }
        found
    };
    let has_upper_end = bands.is_none();
    let bands = bands.map_or_else(found, <[_]>::to_vec);
    let band = |[low, high]: [f64; 2]| {
        let holds =
            |value: &f64| *value >= low && (*value < high || has_upper_end && *value <= high);
        let count = |pieces: &Vec<Piece>| {
            let draws = pieces.iter().flat_map(|piece| &piece.growing);
            draws.filter(|growing| growing.iter().any(holds)).count() as u64
        };
        let counts: Vec<u64> = scramblings.iter().map(count).collect();
        Band { frequencies: [low, high], unstable: of_counts(&counts, points) }
    };
    bands.into_iter().map(band).collect()
}
