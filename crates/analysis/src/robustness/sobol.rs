//! Sobol's sequence with Owen's nested uniform scrambling.
//!
//! Direction numbers: Joe and Kuo, Constructing Sobol sequences with better two-dimensional projections, SIAM J. Sci.
//! Comput. 30 (2008), 2635–2654. Scrambling: Owen, Randomly permuted (t,m,s)-nets and (t,s)-sequences (1995). A scrambled
//! point is uniform in the unit cube, and the first 2^m points are still a net.

/// The most coordinates of a point.
pub const DIMENSIONS: usize = 256;
/// The first digits of a coordinate are scrambled by a tree of digits, and the others are drawn: no two of the first
/// 2^20 points have the same first digits.
const DEPTH: u32 = 20;
/// The most points of a scrambling.
pub const MOST_POINTS: u64 = 1 << DEPTH;
/// Digits of a coordinate in all: half a digit more, and it is still a double.
const DIGITS: u32 = 52;

const JOE_KUO: &str = include_str!("joe_kuo.txt");

/// Sobol's sequence.
pub struct Sobol {
    /// For each coordinate the direction numbers, the first digit highest.
    directions: Vec<[u32; 32]>,
}

impl Sobol {
    /// The sequence with this number of coordinates, at most [`DIMENSIONS`].
    #[must_use]
    pub fn new(dimensions: usize) -> Self {
        let first = std::iter::once(std::array::from_fn(|place| 1 << (31 - place)));
        let lines = JOE_KUO.lines().filter(|line| !line.starts_with('#'));
        let directions = first.chain(lines.map(directions)).take(dimensions).collect();
        Self { directions }
    }

    /// A coordinate of a point, in parts of 2^32.
    fn coordinate(&self, index: u64, dimension: usize) -> u32 {
        let (mut left, mut found) = (index, 0);
        while left != 0 {
            found ^= self.directions[dimension][left.trailing_zeros() as usize];
            left &= left - 1;
        }
        found
    }
}

/// The direction numbers of a line `d s a m_1 … m_s`.
fn directions(line: &str) -> [u32; 32] {
    let numbers: Vec<u32> = line.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    let (degree, polynomial, first) = (numbers[1] as usize, numbers[2], &numbers[3..]);
    let mut found = [0; 32];
    for place in 0..32 {
        found[place] = if place < degree {
            first[place] << (31 - place)
        } else {
            let mut value = found[place - degree] ^ (found[place - degree] >> degree);
            for term in 1..degree {
                if polynomial >> (degree - 1 - term) & 1 == 1 {
                    value ^= found[place - term];
                }
            }
            value
        };
    }
    found
}

/// Sobol's sequence in one scrambling.
pub struct Scrambled<'a> {
    sobol: &'a Sobol,
    /// A key for each coordinate.
    keys: Vec<u64>,
}

impl<'a> Scrambled<'a> {
    /// The scrambling of this number that belongs to a seed. Scramblings of different numbers or seeds are independent.
    #[must_use]
    pub fn new(sobol: &'a Sobol, seed: u64, scrambling: u64) -> Self {
        let key = |dimension| key(seed, &[scrambling, dimension as u64]);
        Self { sobol, keys: (0..sobol.directions.len()).map(key).collect() }
    }

    /// A coordinate of a point, above 0 and below 1.
    #[must_use]
    pub fn coordinate(&self, index: u64, dimension: usize) -> f64 {
        let key = self.keys[dimension];
        let digits = self.sobol.coordinate(index, dimension) >> (32 - DEPTH);
        let mut found = digits;
        for place in 0..DEPTH {
            // A digit is turned round or not for all points that have the same digits before it: a node of a tree.
            let node = u64::from((1 << place) | digits >> (DEPTH - place));
            let turned = mixed(key ^ node.wrapping_mul(ODD)) >> 63;
            found ^= u32::from(turned == 1) << (DEPTH - 1 - place);
        }
        let rest = mixed(!key ^ u64::from(digits).wrapping_mul(ODD)) >> (64 - (DIGITS - DEPTH));
        unit(u64::from(found) << (DIGITS - DEPTH) | rest)
    }
}

/// A number above 0 and below 1 that looks random, by a seed and the numbers of its place.
#[must_use]
pub fn random(seed: u64, places: &[u64]) -> f64 {
    unit(mixed(key(seed, places)) >> (64 - DIGITS))
}

/// The middle of an interval of 2^−52.
#[allow(clippy::cast_precision_loss)]
fn unit(digits: u64) -> f64 {
    (digits as f64 + 0.5) / (1_u64 << DIGITS) as f64
}

fn key(seed: u64, places: &[u64]) -> u64 {
    places.iter().fold(mixed(seed ^ ODD), |key, place| mixed(key.wrapping_add(ODD) ^ mixed(*place)))
}

/// An odd number without a pattern: the golden ratio's digits.
const ODD: u64 = 0x9e37_79b9_7f4a_7c15;

/// A permutation of 64 bits that looks random: Stafford's mix 13, as in SplitMix64.
fn mixed(mut bits: u64) -> u64 {
    bits = (bits ^ bits >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ bits >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ bits >> 31
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_points_are_those_that_joe_and_kuo_print() {
        // The first ten points of their example in three dimensions, as a set: theirs come in the order of a Gray code.
        let theirs = [
            [0.0, 0.0, 0.0],
            [0.5, 0.5, 0.5],
            [0.75, 0.25, 0.25],
            [0.25, 0.75, 0.75],
            [0.375, 0.375, 0.625],
            [0.875, 0.875, 0.125],
            [0.625, 0.125, 0.875],
            [0.125, 0.625, 0.375],
        ];
        let sobol = Sobol::new(3);
        let point =
            |index| [0, 1, 2].map(|i| f64::from(sobol.coordinate(index, i)) / 2_f64.powi(32));
        let mut ours: Vec<[f64; 3]> = (0..8).map(point).collect();
        let mut theirs = theirs.to_vec();
        for points in [&mut ours, &mut theirs] {
            points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        }
        assert_eq!(ours, theirs);
    }

    #[test]
    fn each_coordinate_of_a_scrambled_net_has_one_point_in_each_stripe() {
        let sobol = Sobol::new(DIMENSIONS);
        for (scrambling, dimension) in [(0, 0), (1, 1), (2, 17), (3, 128), (4, 255)] {
            let points = Scrambled::new(&sobol, 7, scrambling);
            let mut hit = vec![0; 512];
            for index in 0..512 {
                hit[(512.0 * points.coordinate(index, dimension)) as usize] += 1;
            }
            assert!(hit.iter().all(|&count| count == 1), "{dimension}");
        }
    }

    #[test]
    fn each_point_of_a_scrambling_is_uniform_and_two_points_are_not_alike() {
        let sobol = Sobol::new(2);
        let count = 20_000;
        // Means and products of coordinates of the points 0 and 5 over the scramblings: 1/2 and, of independent ones, 1/4.
        let mut sums = [0.0; 4];
        for scrambling in 0..count {
            let points = Scrambled::new(&sobol, 3, scrambling);
            let [x, y] = [0, 1].map(|dimension| points.coordinate(0, dimension));
            let other = points.coordinate(5, 0);
            for (sum, value) in sums.iter_mut().zip([x, y, x * y, other]) {
                *sum += value;
            }
        }
        // Four standard deviations of a mean: those of x are 1/√12, those of x y are 0.22.
        let allowed = 4.0 / f64::sqrt(12.0 * count as f64);
        for (sum, expected) in sums.iter().zip([0.5, 0.5, 0.25, 0.5]) {
            assert!((sum / count as f64 - expected).abs() < allowed, "{sums:?}");
        }
    }

    #[test]
    fn the_error_of_a_scrambled_net_falls_faster_than_that_of_independent_draws() {
        // The mean of x y z: its variance falls like N^−3 but for logarithms, that of independent draws like 1/N.
        let sobol = Sobol::new(3);
        let deviation = |points: u64| {
            let square = |scrambling| {
                let net = Scrambled::new(&sobol, 1, scrambling);
                let value = |i| (0..3).map(|d| net.coordinate(i, d)).product::<f64>();
                let mean = (0..points).map(value).sum::<f64>() / points as f64;
                (mean - 0.125) * (mean - 0.125)
            };
            ((0..50).map(square).sum::<f64>() / 50.0).sqrt()
        };
        // A factor of 8 if they were independent.
        assert!(deviation(16) > 60.0 * deviation(1024), "{} {}", deviation(16), deviation(1024));
    }
}
