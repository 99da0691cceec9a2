//! The data of a figure as the page's script reads them: thinned, rounded, checked.

use super::Content;
use super::thin::{is_ascending, kept, rounded};
use crate::picture::{
    Band, COLOURS, Chart, Class, Lane, Map, Marker, Panel, Raster, Series, Style, scale, shown,
};
use amontons::Error;
use serde::Serialize;

/// Stretches of a lane that need no thinning, and parts of the x axis that take one class each beyond that.
const STRETCHES: usize = 2000;
/// Columns and rows of a raster.
const RASTER: [usize; 2] = [600, 300];
/// Columns and rows of a map.
const MAP: usize = 400;

/// A chart, or a map as a chart of one panel.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Drawn<'a> {
    x_label: &'a str,
    logarithmic: bool,
    panels: Vec<DrawnPanel<'a>>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct DrawnPanel<'a> {
    y_label: &'a str,
    zero_line: bool,
    series: Vec<DrawnSeries<'a>>,
    marks: Vec<DrawnMark<'a>>,
    bands: &'a [Band],
    raster: Option<DrawnRaster<'a>>,
    lanes: Vec<DrawnLane<'a>>,
    classes: &'a [Class],
    cells: Option<DrawnCells>,
}

/// A curve. What is not finite is null in JSON.
#[derive(Serialize)]
struct DrawnSeries<'a> {
    label: Option<&'a str>,
    colour: usize,
    style: Style,
    marker: Option<Marker>,
    /// Does x never go back?
    ascending: bool,
    /// Are points left out, so that what is between two of them is not known?
    thinned: bool,
    x: Vec<f64>,
    y: Vec<f64>,
    labels: Vec<&'a str>,
}

#[derive(Serialize)]
struct DrawnMark<'a> {
    x: f64,
    label: Option<&'a str>,
}

#[derive(Serialize)]
struct DrawnRaster<'a> {
    x: [f64; 2],
    y: [f64; 2],
    range: [f64; 2],
    label: &'a str,
    /// Six hexadecimal digits for each of the 255 colours.
    colours: String,
    columns: usize,
    /// Lowest first; two hexadecimal digits a cell: 0 to 254 from the first to the last colour, 255 for none.
    rows: Vec<String>,
}

#[derive(Serialize)]
struct DrawnLane<'a> {
    name: &'a str,
    /// From, to and class in turn.
    stretches: Vec<(f64, f64, usize)>,
}

#[derive(Serialize)]
struct DrawnCells {
    x: [f64; 2],
    y: [f64; 2],
    columns: usize,
    /// Lowest first: class and how many cells of it follow, in turn.
    rows: Vec<Vec<usize>>,
}

impl Drawn<'_> {
    /// Are curves thinned?
    pub(super) fn is_thinned(&self) -> bool {
        self.panels.iter().any(|panel| panel.series.iter().any(|series| series.thinned))
    }
}

/// The data of a figure.
///
/// # Errors
/// Those of the picture's own `write`, but for its file.
pub(super) fn drawn(content: &Content) -> Result<Drawn<'_>, Error> {
    match content {
        Content::Chart(chart) => of_chart(chart),
        Content::Map(map) => of_map(map),
    }
}

fn of_chart(chart: &Chart) -> Result<Drawn<'_>, Error> {
    chart.check()?;
    let panels = chart.panels.iter().map(|panel| of_panel(chart, panel));
    Ok(Drawn { x_label: &chart.x_label, logarithmic: chart.logarithmic, panels: panels.collect() })
}

fn of_panel<'a>(chart: &'a Chart, panel: &'a Panel) -> DrawnPanel<'a> {
    let shown = |value: f64| value.is_finite() && (!chart.logarithmic || value > 0.0);
    let marks = panel.marks.iter().filter(|mark| shown(mark.x));
    DrawnPanel {
        y_label: &panel.y_label,
        zero_line: panel.zero_line,
        series: panel.series.iter().map(|series| of_series(series, chart.logarithmic)).collect(),
        marks: marks
            .map(|mark| DrawnMark { x: rounded(mark.x), label: mark.label.as_deref() })
            .collect(),
        bands: &panel.bands,
        raster: panel.raster.as_ref().map(of_raster),
        lanes: panel.lanes.iter().map(|lane| of_lane(lane)).collect(),
        classes: &panel.classes,
        cells: None,
    }
}

fn of_series(series: &Series, logarithmic: bool) -> DrawnSeries<'_> {
    let mut places = kept(series, logarithmic);
    // The script looks values up along x, so what only goes back is turned round.
    let backwards = || series.points.iter().rev().copied().collect::<Vec<_>>();
    let descending = !is_ascending(&series.points) && is_ascending(&backwards());
    if descending {
        places.reverse();
    }
    let values =
        |axis: usize| places.iter().map(|&place| rounded(series.points[place][axis])).collect();
    DrawnSeries {
        label: series.label.as_deref(),
        colour: series.colour,
        style: series.style,
        marker: series.marker,
        thinned: places.len() < series.points.len(),
        ascending: descending || is_ascending(&series.points),
        x: values(0),
        y: values(1),
        labels: places.iter().filter_map(|&place| Some(&**series.labels.get(place)?)).collect(),
    }
}

/// Where `parts` parts of `count` places begin and end.
fn parts(count: usize, parts: usize) -> Vec<std::ops::Range<usize>> {
    let parts = parts.min(count);
    (0..parts).map(|part| part * count / parts..(part + 1) * count / parts).collect()
}

fn of_raster(raster: &Raster) -> DrawnRaster<'_> {
    let columns = raster.rows.first().map_or(0, Vec::len);
    let across = parts(columns, RASTER[0]);
    let [low, high] = raster.colours();
    let last = (COLOURS - 1) as f64;
    let level = |value: f64| match value.is_finite() {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        true => (last * ((value - low) / (high - low)).clamp(0.0, 1.0)).round() as u8,
        false => 255,
    };
    let rows = parts(raster.rows.len(), RASTER[1]).into_iter().map(|rows| {
        let cells = across.iter().map(|columns| {
            let values =
                raster.rows[rows.clone()].iter().flat_map(|row| &row[columns.clone()]).copied();
            // `max` passes over what is not a number, so a cell is empty where all are.
            format!("{:02x}", level(values.fold(f64::NAN, f64::max)))
        });
        cells.collect()
    });
    DrawnRaster {
        x: raster.x,
        y: raster.y,
        range: raster.colours(),
        label: &raster.label,
        colours: colours(),
        columns: across.len(),
        rows: rows.collect(),
    }
}

fn colours() -> String {
    let texts = scale()
        .into_iter()
        .map(|colour| format!("{:02x}{:02x}{:02x}", colour.0, colour.1, colour.2));
    texts.collect()
}

/// Of a lane of many stretches the one that each of equal parts of the axis shows, as in a picture.
#[allow(clippy::cast_precision_loss)]
fn of_lane(lane: &Lane) -> DrawnLane<'_> {
    let finite = lane.stretches.iter().filter(|s| s.from.is_finite() && s.to.is_finite());
    let whole: Vec<(f64, f64, usize)> = finite.map(|s| (s.from, s.to, s.class)).collect();
    let mut stretches = if whole.len() > STRETCHES { most_of_each_part(&whole) } else { whole };
    for stretch in &mut stretches {
        (stretch.0, stretch.1) = (rounded(stretch.0), rounded(stretch.1));
    }
    DrawnLane { name: &lane.name, stretches }
}

#[allow(clippy::cast_precision_loss)]
fn most_of_each_part(whole: &[(f64, f64, usize)]) -> Vec<(f64, f64, usize)> {
    let start = whole.iter().map(|stretch| stretch.0).fold(f64::INFINITY, f64::min);
    let end = whole.iter().map(|stretch| stretch.1).fold(f64::NEG_INFINITY, f64::max);
    let width = (end - start) / STRETCHES as f64;
    let part = |x: f64| (x - start) / width;
    let spans: Vec<[f64; 2]> = whole.iter().map(|&(from, to, _)| [part(from), part(to)]).collect();
    let classes: Vec<Option<usize>> = shown(&spans, STRETCHES)
        .into_iter()
        .map(|found| found.map(|place| whole[place].2))
        .collect();
    let mut first = 0;
    let runs = classes.chunk_by(|a, b| a == b).filter_map(|run| {
        let ends = [first, first + run.len()].map(|place| start + width * place as f64);
        first += run.len();
        run[0].map(|class| (ends[0], ends[1], class))
    });
    runs.collect()
}

fn of_map(map: &Map) -> Result<Drawn<'_>, Error> {
    map.check()?;
    let columns = map.cells[0].len();
    let across = nearest(columns);
    let rows = nearest(map.cells.len()).into_iter().map(|row| {
        let classes: Vec<usize> = across.iter().map(|&column| map.cells[row][column]).collect();
        classes.chunk_by(|a, b| a == b).flat_map(|run| [run[0], run.len()]).collect()
    });
    let cells = DrawnCells { x: map.x, y: map.y, columns: across.len(), rows: rows.collect() };
    let panel = DrawnPanel {
        y_label: &map.y_label,
        zero_line: false,
        series: Vec::new(),
        marks: Vec::new(),
        bands: &[],
        raster: None,
        lanes: Vec::new(),
        classes: &map.classes,
        cells: Some(cells),
    };
    Ok(Drawn { x_label: &map.x_label, logarithmic: false, panels: vec![panel] })
}

/// The places of rows or columns of a map that stay: evenly apart, with the first and the last, whose middles are the
/// ends of the axis.
fn nearest(count: usize) -> Vec<usize> {
    let kept = count.min(MAP);
    (0..kept).map(|place| (place * (count - 1) + (kept - 1) / 2) / (kept - 1).max(1)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_many_stretches_the_longer_are_seen_and_one_that_stands_alone() {
        // Nine tenths of the time in class 1, then a long stretch with an impact in it.
        let often = (0..10_000).flat_map(|i| {
            let at = f64::from(i);
            [(at, at + 0.1, 0), (at + 0.1, at + 1.0, 1)]
        });
        let then = [(10_000.0, 15_000.0, 1), (15_000.0, 15_000.01, 2), (15_000.01, 20_000.0, 1)];
        let whole: Vec<(f64, f64, usize)> = often.chain(then).collect();
        let seen = most_of_each_part(&whole);
        assert!(seen.len() <= STRETCHES);
        assert_eq!((seen[0].0, seen[seen.len() - 1].1), (0.0, 20_000.0));
        let length = |class: usize| -> f64 {
            seen.iter()
                .filter(|stretch| stretch.2 == class)
                .map(|stretch| stretch.1 - stretch.0)
                .sum()
        };
        assert!(length(1) > 0.9 * 20_000.0, "{}", length(1));
        let impact: Vec<_> = seen.iter().filter(|stretch| stretch.2 == 2).collect();
        assert_eq!(impact.len(), 1);
        assert!((impact[0].0 - 15_000.0).abs() <= 10.0);
    }

    #[test]
    fn a_map_keeps_its_first_and_last_column() {
        for count in [1, 2, 399, 400, 401, 1000, 1777] {
            let kept = nearest(count);
            assert_eq!(kept.len(), count.min(400));
            assert_eq!([kept[0], kept[kept.len() - 1]], [0, count - 1]);
            assert!(kept.is_sorted());
        }
    }

    #[test]
    fn a_narrow_peak_of_a_raster_stays() {
        let mut rows = vec![vec![0.0; 5000]; 1000];
        rows[617][3141] = 1.0;
        rows[0][0] = f64::NAN;
        let raster =
            Raster { x: [0.0, 1.0], y: [0.0, 1.0], rows, range: [0.0, 1.0], label: "".into() };
        let drawn = of_raster(&raster);
        assert_eq!((drawn.columns, drawn.rows.len()), (600, 300));
        let cells =
            |text: &String| text.as_bytes().chunks(2).map(<[u8]>::to_vec).collect::<Vec<_>>();
        let peaks = drawn.rows.iter().flat_map(cells).filter(|cell| cell == b"fe").count();
        assert_eq!(peaks, 1);
    }
}
