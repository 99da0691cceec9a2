//! Functions of complex numbers without the platform's own mathematical library, whose last bits differ between
//! platforms: an FMU's outputs must not.

use nalgebra::Complex;

/// Modulus |z|.
pub(super) fn modulus(z: Complex<f64>) -> f64 {
    libm::hypot(z.re, z.im)
}

/// The number of this modulus, at this angle, rad.
pub(super) fn from_polar(modulus: f64, angle: f64) -> Complex<f64> {
    let (sin, cos) = libm::sincos(angle);
    Complex::new(modulus * cos, modulus * sin)
}

/// Square root with Re ≥ 0; on the cut, below zero, the root with the sign of Im z.
pub(super) fn root(z: Complex<f64>) -> Complex<f64> {
    let larger = (0.5 * z.re.abs() + 0.5 * modulus(z)).sqrt();
    if larger == 0.0 {
        return Complex::new(0.0, z.im);
    }
    let smaller = 0.5 * z.im.abs() / larger;
    let (re, im) = if z.re >= 0.0 { (larger, smaller) } else { (smaller, larger) };
    Complex::new(re, im.copysign(z.im))
}

/// Logarithm ln z, with −π ≤ Im ≤ π.
pub(super) fn logarithm(z: Complex<f64>) -> Complex<f64> {
    Complex::new(libm::log(modulus(z)), libm::atan2(z.im, z.re))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers of all quadrants, on the axes and of far apart sizes.
    fn numbers() -> impl Iterator<Item = Complex<f64>> {
        const PARTS: [f64; 9] = [0.0, 1.0, -1.0, 2.5, -2.5, 1e-9, -1e-9, 3e7, -3e7];
        PARTS.into_iter().flat_map(|re| PARTS.map(|im| Complex::new(re, im)))
    }

    #[test]
    fn a_root_times_itself_is_the_number_and_lies_on_the_right() {
        for z in numbers() {
            let found = root(z);
            assert!((found * found - z).norm() <= 4.0 * f64::EPSILON * z.norm(), "{z} {found}");
            assert!(found.re >= 0.0 && found.im * z.im >= 0.0, "{z} {found}");
        }
        assert_eq!(root(Complex::new(-4.0, 0.0)), Complex::new(0.0, 2.0));
        assert_eq!(root(Complex::new(-4.0, -0.0)), Complex::new(0.0, -2.0));
        assert_eq!(root(Complex::new(3.0, 4.0)), Complex::new(2.0, 1.0));
    }

    #[test]
    fn a_number_is_at_its_modulus_and_angle() {
        for z in numbers() {
            let found = from_polar(modulus(z), z.im.atan2(z.re));
            assert!((found - z).norm() <= 4.0 * f64::EPSILON * z.norm(), "{z} {found}");
        }
    }

    #[test]
    fn e_to_the_logarithm_is_the_number() {
        for z in numbers().filter(|z| *z != Complex::ZERO) {
            assert!((logarithm(z).exp() - z).norm() <= 2e-14 * z.norm(), "{z}");
        }
    }
}
