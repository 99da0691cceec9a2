//! Images: colours in cells of equal size, in SVGs as an embedded PNG.

use super::canvas::{Canvas, Failure, encoded};
use super::colours::{COLOURS, scale};
use plotters::backend::DrawingBackend;
use plotters::element::BitMapElement;
use plotters::style::RGBColor;

/// The place in the palette of what has no value.
const NONE: u8 = COLOURS as u8;

/// Cells in rows, the highest first.
pub(super) struct Image {
    width: usize,
    /// Places in the palette.
    cells: Vec<u8>,
}

impl Image {
    /// Rows of parts of the scale of colours, the lowest row first: 0 is its first colour, 1 its last; what is
    /// not a number has none.
    pub(super) fn new(rows: &[Vec<f64>]) -> Self {
        let cells = rows.iter().rev().flatten().map(|&part| place(part)).collect();
        Self { width: rows.first().map_or(0, Vec::len), cells }
    }

    fn height(&self) -> usize {
        self.cells.len() / self.width
    }

    fn png(&self) -> Result<Vec<u8>, Failure> {
        let palette: Vec<u8> = palette().iter().flat_map(|&RGBColor(r, g, b)| [r, g, b]).collect();
        encoded(self.width, self.height(), &self.cells, Some(palette))
    }
}

/// A part of the scale as a place in it.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn place(part: f64) -> u8 {
    if part.is_nan() {
        return NONE;
    }
    (part.clamp(0.0, 1.0) * f64::from(NONE - 1)).round() as u8
}

fn palette() -> Vec<RGBColor> {
    let mut colours = scale();
    colours.push(RGBColor(255, 255, 255));
    colours
}

impl<B: DrawingBackend> Canvas<B> {
    /// Fills a rectangle (left, top, right, bottom) with an image. In SVGs it lies below all that is drawn, so
    /// it has to be painted before.
    #[allow(clippy::cast_sign_loss)]
    pub(super) fn image(&self, corners: [f64; 4], image: &Image) -> Result<(), Failure> {
        let [left, top, right, bottom] = corners.map(|length| self.pixels(length));
        let (width, height) = ((right - left) as usize, (bottom - top) as usize);
        if !self.bitmap {
            let data = base64(&image.png()?);
            *self.images.borrow_mut() += &format!(
                "<image x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\" \
                 preserveAspectRatio=\"none\" image-rendering=\"pixelated\" \
                 href=\"data:image/png;base64,{data}\"/>\n"
            );
            return Ok(());
        }
        let palette = palette();
        let mut pixels = Vec::with_capacity(3 * width * height);
        for y in 0..height {
            let row = y * image.height() / height * image.width;
            for x in 0..width {
                let cell = image.cells[row + x * image.width / width];
                let RGBColor(red, green, blue) = palette[usize::from(cell)];
                pixels.extend([red, green, blue]);
            }
        }
        #[allow(clippy::cast_possible_truncation)]
        let size = (width as u32, height as u32);
        match BitMapElement::with_owned_buffer((left, top), size, pixels) {
            Some(element) => Ok(self.area.draw(&element)?),
            None => Ok(()),
        }
    }
}

/// Bytes as text (RFC 4648).
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let byte = |place: usize| usize::from(three.get(place).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for digit in 0..4 {
            let known = digit <= three.len();
            let value = bits >> (18 - 6 * digit) & 63;
            text.push(if known { char::from(DIGITS[value]) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_of_bytes_is_that_of_rfc_4648() {
        let examples = ["", "f", "fo", "foo", "foob", "fooba", "foobar"];
        let expected = ["", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"];
        assert_eq!(examples.map(|example| base64(example.as_bytes())), expected);
    }

    #[test]
    fn rows_stand_from_top_to_bottom_and_values_beyond_the_scale_have_its_ends() {
        let image = Image::new(&[vec![0.0, 1.0], vec![-1.0, 9.0], vec![f64::NAN, 0.5]]);
        assert_eq!(image.cells, [NONE, 127, 0, 254, 0, 254]);
    }
}
