//! Error against time, both in powers of ten, a panel a scene. A line joins the settings of a peer that
//! are worth their time; every setting has its dot.

use crate::table::Row;
use plotters::coord::combinators::IntoLogRange;
use plotters::prelude::{
    ChartBuilder, Circle, DrawingAreaErrorKind, IntoDrawingArea, IntoFont, LineSeries, PathElement,
    RGBColor, SVGBackend, SeriesLabelPosition, WHITE,
};
use plotters::style::Color;
use std::path::Path;

const SIZE: (u32, u32) = (1500, 620);
/// Told apart by readers who do not see all colours (Okabe and Ito).
const COLOURS: [RGBColor; 6] = [
    RGBColor(213, 94, 0),
    RGBColor(230, 159, 0),
    RGBColor(0, 114, 178),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 86, 86),
];

type Failure = DrawingAreaErrorKind<std::io::Error>;

/// Writes the picture as SVG.
///
/// # Errors
/// The file cannot be written.
pub fn write(scenes: &[(&str, Vec<Row>)], path: &Path) -> Result<(), String> {
    draw(scenes, path).map_err(|failure| format!("{}: {failure}", path.display()))
}

fn draw(scenes: &[(&str, Vec<Row>)], path: &Path) -> Result<(), Failure> {
    let mut names: Vec<&str> = Vec::new();
    for row in scenes.iter().flat_map(|(_, rows)| rows) {
        if !names.contains(&row.who) {
            names.push(row.who);
        }
    }
    let area = SVGBackend::new(path, SIZE).into_drawing_area();
    area.fill(&WHITE)?;
    for ((scene, rows), area) in scenes.iter().zip(area.split_evenly((1, scenes.len()))) {
        let mut chart = ChartBuilder::on(&area)
            .caption(scene, ("sans-serif", 20).into_font())
            .margin(12)
            .x_label_area_size(46)
            .y_label_area_size(56)
            .build_cartesian_2d((1e-15..10.0).log_scale(), (0.01..1e5).log_scale())?;
        chart
            .configure_mesh()
            .x_desc("relative rms error of the displacements")
            .y_desc("ms a simulated second")
            .x_labels(6)
            .label_style(("sans-serif", 14))
            .x_label_formatter(&|x| format!("{x:.0e}"))
            .y_label_formatter(&|y| format!("{y:.0e}"))
            .light_line_style(WHITE)
            .draw()?;
        for (name, colour) in names.iter().zip(COLOURS.iter().cycle()) {
            let own = rows.iter().filter(|row| row.who == *name);
            let mut points: Vec<(f64, f64)> =
                own.map(|row| (row.error, 1e3 * row.seconds)).collect();
            points.sort_by(|a, b| a.1.total_cmp(&b.1));
            let line = colour.stroke_width(2);
            chart
                .draw_series(LineSeries::new(best(&points), line))?
                .label(*name)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], line));
            chart.draw_series(points.into_iter().map(|p| Circle::new(p, 4, colour.filled())))?;
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::LowerLeft)
            .label_font(("sans-serif", 14))
            .background_style(WHITE.mix(0.85))
            .draw()?;
    }
    area.present()
}

/// Those of these, sorted by time, that are more accurate than all quicker ones, by more than rounding.
fn best(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut least = f64::INFINITY;
    let better = |point: &&(f64, f64)| {
        let better = point.0 < 0.99 * least;
        least = least.min(point.0);
        better
    };
    points.iter().filter(better).copied().collect()
}
