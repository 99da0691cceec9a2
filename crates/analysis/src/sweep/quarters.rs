//! The size of each displacement over the four quarters of a window, from which a motion is judged.

use super::steady::{ROUNDING, drifts, is_steady};
use crate::spectral::Window;

/// Weighted sums over the rows of a quarter, of what a displacement is more than in the quarter's first row, and its extent.
#[derive(Clone, Copy, Default)]
struct Sums {
    first: f64,
    linear: f64,
    square: f64,
    /// The smallest and the largest value, m.
    extent: [f64; 2],
}

/// The displacements of a run, row by row, as far as their sizes ask for it.
#[derive(Clone)]
pub(super) struct Quarters {
    /// Rows that come before the first quarter, since a window need not have a multiple of four.
    before: usize,
    row: usize,
    /// Weights of the rows in a quarter.
    weights: Vec<f64>,
    /// The sums of the quarters for each displacement.
    sums: Vec<[Sums; 4]>,
    /// The smallest and the largest value of each displacement in the window, m.
    extents: Vec<[f64; 2]>,
}

impl Quarters {
    /// Begins a window that will have `rows` rows.
    pub fn new(rows: usize) -> Self {
        let weights = Window::BlackmanHarris.weights(rows / 4);
        Self { before: rows % 4, row: 0, weights, sums: Vec::new(), extents: Vec::new() }
    }

    /// Number of rows of a quarter.
    pub fn rows(&self) -> usize {
        self.weights.len()
    }

    /// Takes the displacements (m) of the next row.
    pub fn note(&mut self, displacement: &[f64]) {
        self.sums.resize(displacement.len(), <[Sums; 4]>::default());
        self.extents.resize(displacement.len(), [f64::INFINITY, f64::NEG_INFINITY]);
        for (extent, x) in self.extents.iter_mut().zip(displacement) {
            *extent = [extent[0].min(*x), extent[1].max(*x)];
        }
        let row = self.row.checked_sub(self.before);
        self.row += 1;
        let Some(row) = row.filter(|row| *row < 4 * self.rows()) else { return };
        let (quarter, place) = (row / self.rows(), row % self.rows());
        for (x, sums) in displacement.iter().zip(&mut self.sums) {
            let sums = &mut sums[quarter];
            if place == 0 {
                (sums.first, sums.extent) = (*x, [*x; 2]);
            }
            sums.extent = [sums.extent[0].min(*x), sums.extent[1].max(*x)];
            let off = x - sums.first;
            sums.linear += self.weights[place] * off;
            sums.square += self.weights[place] * off * off;
        }
    }

    /// `true` if everything rests: no displacement varies by more than `least` (m).
    pub fn rest(&self, least: f64) -> bool {
        self.extents.iter().all(|[low, high]| high - low <= least)
    }

    /// `true` if the size of each displacement is constant; `false` where some are not and all of these grow, or all
    /// of them decay, from each quarter to the next; `None` where neither is so, for example for a beat. A
    /// displacement smaller than `least` (m) rests. A quarter that
    /// holds few periods has another root mean square with each phase, so the largest and smallest values must go the same way.
    pub fn settled(&self, least: f64) -> Option<bool> {
        let whole: f64 = self.weights.iter().sum();
        let size = |sums: &Sums| {
            let mean = sums.linear / whole;
            (sums.square / whole - mean * mean).max(0.0).sqrt()
        };
        let sizes: Vec<[f64; 4]> =
            self.sums.iter().map(|quarters| quarters.each_ref().map(size)).collect();
        let largest = sizes.iter().flatten().copied().fold(0.0, f64::max);
        let least = least.max(ROUNDING * largest);
        let stays =
            |sizes: &&[f64; 4]| sizes.iter().all(|size| *size <= least) || is_steady(&sizes[..]);
        let range = |sums: &Sums| sums.extent[1] - sums.extent[0];
        let ranges = self.sums.iter().map(|quarters| quarters.each_ref().map(range));
        let mut moving = sizes.iter().zip(ranges).filter(|(sizes, _)| !stays(sizes)).peekable();
        let Some((first, _)) = moving.peek() else { return Some(true) };
        let grows = |sizes: &[f64; 4]| sizes[3] > sizes[0];
        let way = grows(first);
        let goes = |sizes: &[f64; 4]| drifts(sizes) && grows(sizes) == way;
        moving.all(|(sizes, ranges)| goes(sizes) && goes(&ranges)).then_some(false)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// The result for two displacements over 4003 rows.
    fn said(motion: impl Fn(f64) -> [f64; 2]) -> Option<bool> {
        let mut quarters = Quarters::new(4003);
        (0..4003).for_each(|row| quarters.note(&motion(f64::from(row) / 1000.0)));
        quarters.settled(1e-15)
    }

    #[test]
    fn a_small_displacement_that_grows_beside_a_large_one_has_not_settled() {
        let fast = |t: f64| (TAU * 50.0 * t).sin();
        assert_eq!(said(|t| [1.0 + fast(t), 1e-6 * fast(t + 0.3)]), Some(true));
        assert_eq!(said(|t| [1.0 + fast(t), 1e-6 * (0.4 * t).exp() * fast(t)]), Some(false));
        assert_eq!(said(|t| [(-0.1 * t).exp() * fast(t), (-0.4 * t).exp() * fast(t)]), Some(false));
    }

    #[test]
    fn one_that_falls_while_another_rises_may_be_a_beat() {
        let fast = |t: f64| (TAU * 50.0 * t).sin();
        let slow = |t: f64| 0.2 * t;
        assert_eq!(said(|t| [slow(t).cos() * fast(t), slow(t).sin() * fast(t)]), None);
        assert_eq!(said(|_| [1.0, 0.0]), Some(true));
    }

    /// The root mean square of some 1.45 periods falls from quarter to quarter, since each begins in another phase.
    #[test]
    fn a_steady_motion_of_few_periods_in_a_quarter_is_not_said_to_decay() {
        for phase in [0.0, 0.4, 0.8, 1.2, 1.6, 2.0, 2.4, 2.8] {
            let slow = |t: f64| (TAU * 1.45 * t + phase).sin();
            assert_ne!(said(|t| [slow(t), 0.5 * slow(t)]), Some(false), "{phase}");
        }
    }

    #[test]
    fn what_drifts_does_not_rest_though_its_size_in_each_quarter_is_small() {
        let mut quarters = Quarters::new(8);
        quarters.note(&[0.5, 1.0]);
        quarters.note(&[0.5, 1.0 + 1e-15]);
        assert!(quarters.rest(1e-14));
        quarters.note(&[0.5, 1.0 + 1e-9]);
        assert!(!quarters.rest(1e-14));
    }
}
