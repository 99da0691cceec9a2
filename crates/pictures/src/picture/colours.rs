//! The scale of colours for values.

use plotters::style::RGBColor;

/// Number of colours of the scale; one more would not be visible.
pub(super) const COLOURS: usize = 255;

/// The way from dark to light, as Oklab's lightness, a and b: from blue to yellow, which eyes without red or
/// green receptors tell apart; those without blue ones, and greyscale prints, have the lightness.
const WAY: [[f64; 3]; 5] = [
    [0.24, 0.03, -0.10],
    [0.41, 0.01, -0.13],
    [0.56, -0.06, -0.06],
    [0.72, -0.10, 0.05],
    [0.93, -0.04, 0.17],
];

/// Colours from that of the smallest value to that of the largest, equally far apart in Oklab.
#[allow(clippy::cast_precision_loss)]
pub(super) fn scale() -> Vec<RGBColor> {
    let far = |pair: &[[f64; 3]]| {
        let squares = [0, 1, 2].map(|axis| (pair[1][axis] - pair[0][axis]).powi(2));
        squares.iter().sum::<f64>().sqrt()
    };
    let all: f64 = WAY.windows(2).map(far).sum();
    let at = |place: usize| {
        let mut left = all * place as f64 / (COLOURS - 1) as f64;
        for pair in WAY.windows(2) {
            let length = far(pair);
            if left <= length {
                return [0, 1, 2].map(|i| pair[0][i] + left / length * (pair[1][i] - pair[0][i]));
            }
            left -= length;
        }
        WAY[WAY.len() - 1]
    };
    (0..COLOURS).map(|place| srgb(at(place))).collect()
}

/// A colour of Oklab in the bytes of screens (B. Ottosson, A perceptual color space for image processing,
/// 2020; IEC 61966-2-1 for the curve). Its power is not the system's, so the bytes are the same everywhere.
fn srgb([lightness, a, b]: [f64; 3]) -> RGBColor {
    let cone = |from_a: f64, from_b: f64| (lightness + from_a * a + from_b * b).powi(3);
    let long = cone(0.396_337_777_4, 0.215_803_757_3);
    let medium = cone(-0.105_561_345_8, -0.063_854_172_8);
    let short = cone(-0.089_484_177_5, -1.291_485_548_0);
    let byte = |of: [f64; 3]| {
        let linear = of[0] * long + of[1] * medium + of[2] * short;
        let value = match linear {
            ..=0.003_130_8 => 12.92 * linear,
            _ => 1.055 * libm::pow(linear, 1.0 / 2.4) - 0.055,
        };
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let byte = (255.0 * value).round().clamp(0.0, 255.0) as u8;
        byte
    };
    RGBColor(
        byte([4.076_741_662_1, -3.307_711_591_3, 0.230_969_929_2]),
        byte([-1.268_438_004_6, 2.609_757_401_1, -0.341_319_396_5]),
        byte([-0.004_196_086_3, -0.703_418_614_7, 1.707_614_701_0]),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// CIE's lightness L* of a colour, 0 for black to 100 for white.
    fn lightness(RGBColor(red, green, blue): RGBColor) -> f64 {
        let linear = |byte: u8| match f64::from(byte) / 255.0 {
            value if value <= 0.04045 => value / 12.92,
            value => ((value + 0.055) / 1.055).powf(2.4),
        };
        let luminance = 0.2126 * linear(red) + 0.7152 * linear(green) + 0.0722 * linear(blue);
        116.0 * luminance.cbrt() - 16.0
    }

    #[test]
    fn oklab_of_white_and_of_the_primaries_is_theirs() {
        assert_eq!(srgb([1.0, 0.0, 0.0]), RGBColor(255, 255, 255));
        assert_eq!(srgb([0.627_96, 0.224_86, 0.125_85]), RGBColor(255, 0, 0));
        assert_eq!(srgb([0.452_01, -0.032_46, -0.311_53]), RGBColor(0, 0, 255));
    }

    #[test]
    fn values_are_told_apart_by_lightness_alone() {
        let found: Vec<f64> = scale().into_iter().map(lightness).collect();
        let (first, last) = (found[0], found[COLOURS - 1]);
        assert!(first < 15.0 && last > 90.0, "{first} to {last}");
        // Over a tenth of the scale lightness rises as over any other, up to a third.
        let even = 0.1 * (last - first);
        for rise in found.windows(26).map(|part| part[25] - part[0]) {
            assert!((rise / even - 1.0).abs() < 1.0 / 3.0, "{rise} beside {even}");
        }
    }
}
