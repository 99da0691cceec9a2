//! Colours that readers with any colour vision can tell apart.

use plotters::style::RGBColor;

/// Okabe and Ito's colours, the ones that stand out on white first: blue, vermilion, bluish green,
/// reddish purple, orange, sky blue, black, yellow. Pictures name them by their place here.
pub const PALETTE: [[u8; 3]; 8] = [
    [0x00, 0x72, 0xB2],
    [0xD5, 0x5E, 0x00],
    [0x00, 0x9E, 0x73],
    [0xCC, 0x79, 0xA7],
    [0xE6, 0x9F, 0x00],
    [0x56, 0xB4, 0xE9],
    [0x00, 0x00, 0x00],
    [0xF0, 0xE4, 0x42],
];

/// Text, axes and zero lines.
pub(super) const INK: RGBColor = RGBColor(0x22, 0x22, 0x22);
/// Colour of marks, springs and other parts that are not to catch the eye first.
pub(super) const GREY: RGBColor = RGBColor(0x66, 0x66, 0x66);
/// Rest positions.
pub(super) const PALE: RGBColor = RGBColor(0xBB, 0xBB, 0xBB);
/// Grids.
pub(super) const GRID: RGBColor = RGBColor(0xE6, 0xE6, 0xE6);

/// The colour at a place of the palette, which repeats.
pub(super) fn colour(place: usize) -> RGBColor {
    let [red, green, blue] = PALETTE[place % PALETTE.len()];
    RGBColor(red, green, blue)
}

/// The colour at a place of the palette, so pale that text and curves stand out on it.
pub(super) fn tint(place: usize) -> RGBColor {
    mixed(place, [1, 4])
}

/// The colour at a place of the palette, pale enough to stay behind other curves.
pub(super) fn muted(place: usize) -> RGBColor {
    mixed(place, [3, 2])
}

/// A mixture of a colour of the palette and of white; the two numbers of parts add up to five.
fn mixed(place: usize, [parts, white]: [u16; 2]) -> RGBColor {
    let pale =
        |byte: u8| u8::try_from((parts * u16::from(byte) + white * 255 + 2) / 5).unwrap_or(u8::MAX);
    let RGBColor(red, green, blue) = colour(place);
    RGBColor(pale(red), pale(green), pale(blue))
}

/// Lengths of dashes and gaps, px, for colours that come again; none is a line without gaps.
pub(super) fn dashes(place: usize) -> &'static [f64] {
    const DASHES: [&[f64]; 4] = [&[], &[12.0, 4.0], &[2.0, 3.0], &[10.0, 3.0, 2.0, 3.0]];
    DASHES[place / PALETTE.len() % DASHES.len()]
}
