//! The canvas of pictures: one set of strokes, fills and texts, for SVG and for bitmaps.
//!
//! All lengths are in px of a picture 900 px wide. The drawing library knows whole pixels only, so
//! it is given a larger picture: an SVG is told its true size afterwards, a bitmap is reduced, which
//! also smooths its edges.

use super::file::{Format, save};
use super::palette::INK;
use amontons::Error;
use plotters::backend::{BitMapBackend, DrawingBackend, SVGBackend};
use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind, IntoDrawingArea};
use plotters::element::{Circle, PathElement, Polygon};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{
    Color, FontStyle, IntoFont, IntoTextStyle, RGBColor, ShapeStyle, TextStyle, WHITE,
};
use quick_xml::escape::{escape, unescape};
use std::cell::RefCell;
use std::path::Path;
use std::sync::Once;

/// Every picture is this wide, px, unless its texts need more.
pub(super) const WIDTH: f64 = 900.0;
/// A font of every system; in bitmaps it is the one that this program carries.
const FONT: &str = "sans-serif";
/// An SVG's coordinates are tenths of a px.
const SVG_UNIT: u32 = 10;
/// Bitmaps have two pixels a px, for screens and print, each the mean of two by two.
const PNG_UNIT: u32 = 4;
/// Small ones have half a pixel a px, the mean of four by four.
const SMALL_UNIT: u32 = 2;

pub(super) type Point = [f64; 2];

/// The reason why a picture cannot be drawn.
#[derive(Debug)]
pub(super) struct Failure(pub(super) String);

impl<E: std::error::Error + Send + Sync> From<DrawingAreaErrorKind<E>> for Failure {
    fn from(error: DrawingAreaErrorKind<E>) -> Self {
        Self(error.to_string())
    }
}

/// A picture that can paint itself.
pub(super) trait Drawing {
    fn title(&self) -> &str;

    /// Description of the picture in words, for readers who cannot see it.
    fn description(&self) -> String;

    /// Width of the drawing, px.
    fn width(&self) -> f64 {
        WIDTH
    }

    /// Height of the drawing, px.
    fn height(&self) -> f64;

    fn paint<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Result<(), Failure>;
}

/// The drawing as the text of an SVG, for what embeds it.
pub(super) fn svg_text(drawing: &impl Drawing) -> Result<String, Error> {
    svg(drawing).map_err(|failure| cannot_draw_titled(drawing.title(), &failure))
}

/// The drawing as a PNG half as wide as an SVG of it, px.
pub(super) fn small_png(drawing: &impl Drawing) -> Result<Vec<u8>, Error> {
    bitmap(drawing, SMALL_UNIT, 2).map_err(|failure| cannot_draw_titled(drawing.title(), &failure))
}

/// Draws and writes as the path's ending asks.
pub(super) fn write(drawing: &impl Drawing, path: &Path) -> Result<(), Error> {
    let content = match Format::of(path)? {
        Format::Svg => svg(drawing).map(String::into_bytes),
        Format::Png => png(drawing),
    };
    save(path, &content.map_err(|failure| cannot_draw(path, &failure))?)
}

/// The error for a picture that has no file of its own.
pub(super) fn cannot_draw_titled(title: &str, Failure(reason): &Failure) -> Error {
    Error::picture(format!("cannot draw {title:?}: {reason}"))
}

pub(super) fn cannot_draw(path: &Path, Failure(reason): &Failure) -> Error {
    Error::picture(format!("cannot draw {}: {reason}", path.display()))
}

/// The start of an SVG file up to what is drawn; `height` in px, the view box as given.
pub(super) fn svg_head(drawing: &impl Drawing, view_box: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" width=\"{}\" height=\"{}\" \
         viewBox=\"{view_box}\">\n<title>{}</title>\n<desc>{}</desc>\n",
        drawing.width(),
        drawing.height(),
        escape(drawing.title()),
        escape(drawing.description())
    )
}

fn svg(drawing: &impl Drawing) -> Result<String, Failure> {
    let size = size(drawing, SVG_UNIT);
    let mut text = String::new();
    let backend = SVGBackend::with_string(&mut text, size);
    let images = paint(drawing, backend, SVG_UNIT, false)?;
    let body = text.split_once('>').map_or("", |(_head, body)| body.trim_start());
    // The first element is the white ground.
    let (ground, body) = body.split_once('\n').unwrap_or((body, ""));
    let head = svg_head(drawing, &format!("0 0 {} {}", size.0, size.1));
    Ok(head + ground + "\n" + &images + &with_lengths(body))
}

/// An SVG's elements, each text with its length in the font that this program carries: the reader's own font, which is
/// wider or narrower, is made to fit.
fn with_lengths(body: &str) -> String {
    let mut parts = body.split("<text ");
    let mut found = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        found += "<text ";
        found += &text_length(part).map_or_else(String::new, |length| {
            format!("textLength=\"{length}\" lengthAdjust=\"spacingAndGlyphs\" ")
        });
        found += part;
    }
    found
}

/// The length, in the SVG's units, of the text element of which the attributes begin here.
fn text_length(element: &str) -> Option<f64> {
    let (attributes, rest) = element.split_once('>')?;
    let size: f64 = attributes.split_once("font-size=\"")?.1.split_once('"')?.0.parse().ok()?;
    let text = unescape(rest.split_once("</text>")?.0.trim()).ok()?;
    // The drawing library writes its own size so.
    let length = text_width(&text, 1.24 * size);
    (length > 0.0).then(|| length.round())
}

fn png(drawing: &impl Drawing) -> Result<Vec<u8>, Failure> {
    bitmap(drawing, PNG_UNIT, 1)
}

/// A PNG that was drawn with `unit` pixels for each px and then halved `halvings` times.
fn bitmap(drawing: &impl Drawing, unit: u32, halvings: u32) -> Result<Vec<u8>, Failure> {
    let (width, height) = size(drawing, unit);
    let mut pixels = vec![0; 3 * width as usize * height as usize];
    paint(drawing, BitMapBackend::with_buffer(&mut pixels, (width, height)), unit, true)?;
    let [mut width, mut height] = [width, height].map(|length| length as usize);
    for _ in 0..halvings {
        pixels = reduce(&pixels, 3 * width);
        (width, height) = (width / 2, height / 2);
    }
    encoded(width, height, &pixels, None)
}

/// A PNG of a byte for each pixel's place in a palette, or of three bytes for its colour.
#[allow(clippy::cast_possible_truncation)]
pub(super) fn encoded(
    width: usize,
    height: usize,
    pixels: &[u8],
    palette: Option<Vec<u8>>,
) -> Result<Vec<u8>, Failure> {
    let mut content = Vec::new();
    let mut encoder = png::Encoder::new(&mut content, width as u32, height as u32);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_color(png::ColorType::Rgb);
    if let Some(palette) = palette {
        encoder.set_color(png::ColorType::Indexed);
        encoder.set_palette(palette);
    }
    let failed = |error: png::EncodingError| Failure(error.to_string());
    encoder.write_header().and_then(|mut w| w.write_image_data(pixels)).map_err(failed)?;
    Ok(content)
}

/// The means of two by two pixels of three bytes; `row` bytes are a row of them.
fn reduce(pixels: &[u8], row: usize) -> Vec<u8> {
    let mut reduced = Vec::with_capacity(pixels.len() / 4);
    for rows in pixels.chunks_exact(2 * row) {
        for column in (0..row).step_by(6) {
            for at in column..column + 3 {
                let four = [at, at + 3, at + row, at + row + 3];
                let sum: u16 = four.iter().map(|&place| u16::from(rows[place])).sum();
                reduced.push(u8::try_from((sum + 2) / 4).unwrap_or(u8::MAX));
            }
        }
    }
    reduced
}

fn size(drawing: &impl Drawing, unit: u32) -> (u32, u32) {
    (whole(drawing.width()) * unit, whole(drawing.height()) * unit)
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn whole(length: f64) -> u32 {
    length.ceil() as u32
}

/// Paints, and returns the elements of an SVG that the drawing library lacks.
fn paint<B: DrawingBackend>(
    drawing: &impl Drawing,
    backend: B,
    unit: u32,
    bitmap: bool,
) -> Result<String, Failure> {
    register_font();
    let (area, images) = (backend.into_drawing_area(), RefCell::default());
    let canvas = Canvas { area, unit: f64::from(unit), bitmap, images };
    canvas.area.fill(&WHITE)?;
    drawing.paint(&canvas)?;
    canvas.area.present()?;
    Ok(canvas.images.take())
}

fn register_font() {
    static REGISTERED: Once = Once::new();
    REGISTERED.call_once(|| {
        let font = plotters::style::register_font(FONT, FontStyle::Normal, notosans::REGULAR_TTF);
        assert!(font.is_ok(), "the font that this program carries is a font");
    });
}

/// Width of a text, px; exact in bitmaps, approximate in SVGs, whose font is the reader's.
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    register_font();
    // Measured large: the library counts whole pixels.
    let large = 100.0;
    let width = (FONT, large).into_font().box_size(text).map_or(0, |(width, _)| width);
    f64::from(width) * size / large
}

/// Position of a text relative to its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Align {
    Left,
    Centre,
    Right,
}

pub(super) struct Canvas<B: DrawingBackend> {
    pub(super) area: DrawingArea<B, Shift>,
    unit: f64,
    pub(super) bitmap: bool,
    /// Elements of an SVG for its images.
    pub(super) images: RefCell<String>,
}

impl<B: DrawingBackend> Canvas<B> {
    /// A length or coordinate in the drawing library's pixels.
    #[allow(clippy::cast_possible_truncation)]
    pub(super) fn pixels(&self, length: f64) -> i32 {
        (length * self.unit).round() as i32
    }

    fn place(&self, [x, y]: Point) -> (i32, i32) {
        (self.pixels(x), self.pixels(y))
    }

    pub(super) fn pen(&self, colour: RGBColor, width: f64) -> ShapeStyle {
        colour.stroke_width(self.pixels(width).unsigned_abs().max(1))
    }

    pub(super) fn font(&self, size: f64) -> TextStyle<'static> {
        (FONT, size * self.unit).with_color(INK).into_text_style(&self.area)
    }

    /// A line of text, its middle at the point's height.
    pub(super) fn text(
        &self,
        text: &str,
        at: Point,
        size: f64,
        align: Align,
    ) -> Result<(), Failure> {
        let across = match align {
            Align::Left => HPos::Left,
            Align::Centre => HPos::Center,
            Align::Right => HPos::Right,
        };
        let style = self.font(size).pos(Pos::new(across, VPos::Center));
        Ok(self.area.draw_text(text, &style, self.place(at))?)
    }

    /// A line through points; lengths of dashes and gaps, px, in turn.
    pub(super) fn line(
        &self,
        points: &[Point],
        colour: RGBColor,
        width: f64,
        dashes: &[f64],
    ) -> Result<(), Failure> {
        if dashes.is_empty() {
            return self.stroke(points, colour, width);
        }
        dashed(points, dashes).iter().try_for_each(|dash| self.stroke(dash, colour, width))
    }

    fn stroke(&self, points: &[Point], colour: RGBColor, width: f64) -> Result<(), Failure> {
        let mut places: Vec<(i32, i32)> = points.iter().map(|&point| self.place(point)).collect();
        places.dedup();
        let style = self.pen(colour, width);
        if !self.bitmap {
            return Ok(self.area.draw(&PathElement::new(places, style))?);
        }
        // The library's own thick lines tear at sharp bends, so joints are drawn round.
        let radius = self.pixels(0.5 * width);
        for pair in places.windows(2) {
            self.area.draw(&PathElement::new(pair, style))?;
        }
        for &joint in places.iter().skip(1).take(places.len().saturating_sub(2)) {
            self.area.draw(&Circle::new(joint, radius, colour.filled()))?;
        }
        Ok(())
    }

    /// A filled polygon.
    pub(super) fn fill(&self, corners: &[Point], colour: RGBColor) -> Result<(), Failure> {
        let places: Vec<(i32, i32)> = corners.iter().map(|&corner| self.place(corner)).collect();
        Ok(self.area.draw(&Polygon::new(places, colour.filled()))?)
    }

    /// A filled rectangle: left, top, right, bottom.
    pub(super) fn rectangle(
        &self,
        [left, top, right, bottom]: [f64; 4],
        colour: RGBColor,
    ) -> Result<(), Failure> {
        self.fill(&[[left, top], [right, top], [right, bottom], [left, bottom]], colour)
    }

    /// A rectangle (left, top, right, bottom) of stripes one below the other, the colours by turns: the first stripe
    /// of the first colour begins at the height `origin`, and each is as high as `stripe`.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    pub(super) fn striped(
        &self,
        [left, top, right, bottom]: [f64; 4],
        colours: &[RGBColor],
        origin: f64,
        stripe: f64,
    ) -> Result<(), Failure> {
        if let [colour] = colours {
            return self.rectangle([left, top, right, bottom], *colour);
        }
        let mut place = ((top - origin) / stripe + 1e-6).floor();
        while origin + place * stripe < bottom - 1e-6 {
            let [upper, lower] = [place, place + 1.0].map(|edge| origin + edge * stripe);
            let colour = colours[place.rem_euclid(colours.len() as f64) as usize];
            self.rectangle([left, upper.max(top), right, lower.min(bottom)], colour)?;
            place += 1.0;
        }
        Ok(())
    }

    /// A filled circle.
    pub(super) fn dot(&self, at: Point, radius: f64, colour: RGBColor) -> Result<(), Failure> {
        let radius = self.pixels(radius);
        Ok(self.area.draw(&Circle::new(self.place(at), radius, colour.filled()))?)
    }
}

/// Cuts a line into its dashes.
fn dashed(points: &[Point], dashes: &[f64]) -> Vec<Vec<Point>> {
    let mut found = Vec::new();
    let Some(&first) = points.first() else { return found };
    let (mut turn, mut left) = (0, dashes[0]);
    let mut dash = vec![first];
    for pair in points.windows(2) {
        let [from, to] = [pair[0], pair[1]];
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        let mut done = 0.0;
        while length - done > left {
            done += left;
            let part = done / length;
            let at = [0, 1].map(|axis| from[axis] + part * (to[axis] - from[axis]));
            if turn % 2 == 0 {
                dash.push(at);
                found.push(std::mem::take(&mut dash));
            } else {
                dash = vec![at];
            }
            turn += 1;
            left = dashes[turn % dashes.len()];
        }
        left -= length - done;
        if turn % 2 == 0 {
            dash.push(to);
        }
    }
    if dash.len() > 1 {
        found.push(dash);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dashes_go_round_corners_and_leave_gaps() {
        let bent = [[0.0, 0.0], [5.0, 0.0], [5.0, 5.0]];
        let dashes = dashed(&bent, &[3.0, 1.0]);
        let expected: [&[Point]; 3] = [
            &[[0.0, 0.0], [3.0, 0.0]],
            &[[4.0, 0.0], [5.0, 0.0], [5.0, 2.0]],
            &[[5.0, 3.0], [5.0, 5.0]],
        ];
        assert_eq!(dashes, expected);
    }

    #[test]
    fn reduced_pixels_are_means_of_two_by_two() {
        let upper = [0, 10, 20, 4, 10, 20];
        let lower = [4, 10, 20, 8, 10, 24];
        assert_eq!(reduce(&[upper, lower].concat(), 6), [4, 10, 21]);
    }
}
