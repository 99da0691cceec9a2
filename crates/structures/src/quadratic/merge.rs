//! One list of modes from several shifts.

use super::Mode;
use super::disc::{Disc, nearness};
use super::shifted::norm;
use faer::c64;

/// The largest part of a unit vector outside the span of others that counts as an error of the vectors.
const OUTSIDE: f64 = 1e-3;
/// Eigenvalues nearer to each other than this part of the nearness are one of several vectors.
const EQUAL: f64 = 1e-5;

/// The modes of all shifts so far.
///
/// A mode of a new shift is a known one if its eigenvalue is near and its vector is in the span of the vectors of all near
/// modes. Each known mode stands for at most one of each shift, so multiple and defective eigenvalues keep their multiplicity.
#[derive(Default)]
pub(super) struct Merged {
    modes: Vec<Merging>,
    discs: usize,
}

struct Merging {
    mode: Mode,
    nearness: f64,
    /// The number of the last disc that showed it.
    disc: usize,
}

impl Merged {
    /// Takes in the modes of a disc.
    pub(super) fn add(&mut self, disc: Disc) {
        self.discs += 1;
        for mut mode in disc.modes {
            let nearness = nearness(disc.centre, mode.eigenvalue);
            let distance = |other: &Merging| (other.mode.eigenvalue - mode.eigenvalue).norm();
            let near: Vec<usize> = (0..self.modes.len())
                .filter(|&other| {
                    let other = &self.modes[other];
                    distance(other) <= nearness.max(other.nearness)
                })
                .collect();
            let same = near
                .iter()
                .copied()
                .filter(|&other| self.modes[other].disc != self.discs)
                .min_by(|&a, &b| distance(&self.modes[a]).total_cmp(&distance(&self.modes[b])));
            let vectors = near.iter().map(|&other| &*self.modes[other].mode.vector);
            let rest = part_outside(&mode.vector, vectors);
            let length = norm(&rest);
            let equal = !near.is_empty()
                && near.iter().all(|&other| distance(&self.modes[other]) <= EQUAL * nearness);
            if equal && length > OUTSIDE {
                // Orthonormal vectors of one eigenvalue keep the errors of their span small.
                mode.vector = rest.into_iter().map(|value| value / length).collect();
            }
            match same {
                Some(same) if length <= OUTSIDE => {
                    let known = &mut self.modes[same];
                    known.disc = self.discs;
                    // Of several, one alone would not keep the span.
                    if nearness < known.nearness && near.len() == 1 {
                        (known.mode, known.nearness) = (mode, nearness);
                    }
                }
                _ => self.modes.push(Merging { mode, nearness, disc: self.discs }),
            }
        }
    }

    /// The modes, by imaginary and then by real part.
    pub(super) fn finish(self) -> Vec<Mode> {
        let mut modes: Vec<Mode> = self.modes.into_iter().map(|merging| merging.mode).collect();
        modes.sort_by(|a, b| {
            let (a, b) = (a.eigenvalue, b.eigenvalue);
            a.im.total_cmp(&b.im).then(a.re.total_cmp(&b.re))
        });
        modes
    }
}

/// The part of a unit vector outside the span of other unit vectors.
fn part_outside<'a>(vector: &[c64], others: impl Iterator<Item = &'a [c64]>) -> Vec<c64> {
    let mut basis: Vec<Vec<c64>> = vec![];
    let take_off = |basis: &[Vec<c64>], vector: &mut [c64]| {
        for direction in basis.iter().chain(basis) {
            let part: c64 = direction.iter().zip(&*vector).map(|(a, b)| a.conj() * b).sum();
            vector.iter_mut().zip(direction).for_each(|(value, a)| *value -= part * a);
        }
    };
    for other in others {
        let mut direction = other.to_vec();
        take_off(&basis, &mut direction);
        let length = norm(&direction);
        if length > OUTSIDE {
            direction.iter_mut().for_each(|value| *value /= length);
            basis.push(direction);
        }
    }
    let mut rest = vector.to_vec();
    take_off(&basis, &mut rest);
    rest
}
