//! A rectangle of the complex plane.

use amontons::Error;
use faer::c64;

/// The part of the complex plane in which eigenvalues are wanted. It has its edges.
///
/// If it touches the real axis (its lowest imaginary part is 0), real eigenvalues belong to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    real: [f64; 2],
    imaginary: [f64; 2],
}

/// Edges go outwards by at most this part of the shorter side.
const OUTWARDS: f64 = 0.01;
/// The number of places of an edge that are tried.
const PLACES: u32 = 50;

impl Rectangle {
    /// Takes the lowest and highest real and imaginary parts, 1/s and rad/s for matrices that belong to seconds.
    ///
    /// # Errors
    /// Returns an error if a bound is not finite, if a lower one is not below its upper one, or if the lowest imaginary part
    /// is negative.
    pub fn new(real: [f64; 2], imaginary: [f64; 2]) -> Result<Self, Error> {
        for (name, [low, high]) in [("real", real), ("imaginary", imaginary)] {
            if !(low < high && low.is_finite() && high.is_finite()) {
                return Err(Error::argument(format!(
                    "the {name} parts of the rectangle go from {low} to {high}; they must be finite, and the first below the second"
                )));
            }
        }
        if imaginary[0] < 0.0 {
            return Err(Error::argument(format!(
                "the lowest imaginary part of the rectangle is {}; it must not be negative, since the eigenvalues below the real axis are the conjugates of those above it",
                imaginary[0]
            )));
        }
        Ok(Self { real, imaginary })
    }

    /// The lowest and the highest real part.
    #[must_use]
    pub fn real(&self) -> [f64; 2] {
        self.real
    }

    /// The lowest and the highest imaginary part.
    #[must_use]
    pub fn imaginary(&self) -> [f64; 2] {
        self.imaginary
    }

    /// `true` if the number is in the rectangle or on its edges.
    #[must_use]
    pub fn contains(&self, number: c64) -> bool {
        let within = |value: f64, [low, high]: [f64; 2]| low <= value && value <= high;
        within(number.re, self.real) && within(number.im, self.imaginary)
    }

    /// The lengths of the sides along the real and the imaginary axis.
    pub(super) fn sides(&self) -> [f64; 2] {
        [self.real[1] - self.real[0], self.imaginary[1] - self.imaginary[0]]
    }

    /// The centre.
    pub(super) fn centre(&self) -> c64 {
        let middle = |[low, high]: [f64; 2]| low + 0.5 * (high - low);
        c64::new(middle(self.real), middle(self.imaginary))
    }

    /// The corners, from the lower right one against the clock.
    pub(super) fn corners(&self) -> [c64; 4] {
        let ([left, right], [low, high]) = (self.real, self.imaginary);
        [(right, low), (right, high), (left, high), (left, low)].map(|(re, im)| c64::new(re, im))
    }

    /// The rectangle with all places that [`Self::cleared`] can give its edges.
    pub(super) fn enlarged(&self) -> Self {
        let [width, height] = self.sides();
        let out = OUTWARDS * width.min(height);
        let mut larger = *self;
        larger.real = [self.real[0] - out, self.real[1] + out];
        larger.imaginary = [(self.imaginary[0] - out).max(0.0), self.imaginary[1] + out];
        larger
    }

    /// The rectangle whose edges have gone outwards until no eigenvalue is near them, and the least distance that was kept.
    ///
    /// An edge stays if no eigenvalue is nearer to it than 10⁻⁴ of the shorter side, and goes outwards by at most 1 % of it.
    /// One on the real axis stays.
    #[must_use]
    pub fn cleared(&self, eigenvalues: &[c64]) -> (Self, f64) {
        let [width, height] = self.sides();
        let out = OUTWARDS * width.min(height);
        let wanted = out / f64::from(2 * PLACES);
        let larger = self.enlarged();
        let mut near: Vec<c64> =
            eigenvalues.iter().flat_map(|&value| [value, value.conj()]).collect();
        near.retain(|value| {
            let within =
                |value: f64, [low, high]: [f64; 2]| low - out <= value && value <= high + out;
            within(value.re, larger.real) && within(value.im, larger.imaginary)
        });
        let (mut moved, mut least) = (*self, f64::INFINITY);
        let mut clear = |edge: &mut f64, direction: f64, part: fn(&c64) -> f64| {
            let mut best = (*edge, 0.0);
            for place in 0..PLACES {
                let candidate = *edge + direction * out * f64::from(place) / f64::from(PLACES);
                let distance = near
                    .iter()
                    .map(|value| (part(value) - candidate).abs())
                    .fold(f64::INFINITY, f64::min);
                if distance > best.1 {
                    best = (candidate, distance);
                }
                if distance >= wanted {
                    break;
                }
            }
            *edge = best.0;
            least = least.min(best.1);
        };
        clear(&mut moved.real[0], -1.0, |value| value.re);
        clear(&mut moved.real[1], 1.0, |value| value.re);
        if self.imaginary[0] > 0.0 {
            clear(&mut moved.imaginary[0], -1.0, |value| value.im);
        }
        clear(&mut moved.imaginary[1], 1.0, |value| value.im);
        moved.imaginary[0] = moved.imaginary[0].max(0.0);
        (moved, least)
    }
}
