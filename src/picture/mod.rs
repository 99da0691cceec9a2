//! Pictures: curves over a common axis, maps of classes, the modes of a ring in motion, and
//! structures of masses and links.
//!
//! Each kind of picture is plain data with a `write`; the name's ending says what is written,
//! `.svg` or `.png`. A picture appears whole or not at all, and the same data give the same bytes.

mod axes;
mod band;
mod beside;
mod canvas;
mod chart;
mod file;
mod lanes;
mod legend;
mod map;
mod mode_shapes;
mod moving;
mod palette;
mod raster;
mod structure;

pub use band::Band;
pub use chart::{Chart, Mark, Panel, Series, Style};
pub use file::check_name;
pub use lanes::{Lane, Stretch};
pub use map::{Class, Map};
pub use mode_shapes::{ModeShape, ModeShapes};
pub use palette::PALETTE;
pub use raster::Raster;
pub use structure::{Link, LinkKind, MassMark, SliderMark, Structure};
