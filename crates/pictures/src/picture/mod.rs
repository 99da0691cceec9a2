//! Pictures: curves, rasters and lanes over a common axis, bars, maps of classes, the modes of a ring in motion, and
//! structures of masses and links.
//!
//! Each kind of picture is plain data with a `write`; the name's ending says what is written,
//! `.svg` or `.png`. A picture appears whole or not at all, and the same data give the same bytes.

mod axes;
mod bars;
mod beside;
mod canvas;
mod chart;
mod class;
mod colours;
mod file;
mod image;
mod legend;
mod locus;
mod map;
mod mesh_shapes;
mod mode_shapes;
mod moving;
pub(crate) mod number;
mod palette;
mod structure;
mod units;

pub use bars::{Bar, BarGroup, Bars};
pub use chart::{Band, Chart, Lane, LaneInterval, Mark, Marker, Panel, Raster, Series, Style};
pub use class::Class;
pub use file::check_name;
pub use locus::{locus_chart, numbered_locus_chart};
pub use map::Map;
pub use mesh_shapes::{MeshShape, MeshShapes};
pub use mode_shapes::{ModeShape, ModeShapes};
pub use number::{prefixed, significant};
pub use palette::PALETTE;
pub use structure::{ForceMark, Link, LinkKind, MassMark, SliderMark, Structure};
