//! Lanes: rows of coloured stretches over x, such as the states of contacts over time.

use super::{Chart, Panel};
use crate::picture::axes::{Frame, LEFT, MEDIUM, RIGHT, SMALL};
use crate::picture::canvas::{Align, Canvas, Failure, text_width};
use crate::picture::class::Class;
use crate::picture::legend::Entry;
use crate::picture::palette::INK;
use plotters::backend::DrawingBackend;
use serde::Serialize;

/// Height of the heading above its frame, px.
pub(super) const HEADING: f64 = 24.0;
/// A lane's height, px, as long as all fit into `MOST`; it is never less than `LEAST`.
const HEIGHT: f64 = 26.0;
const MOST: f64 = 400.0;
const LEAST: f64 = 2.0;
/// Names stand no closer than this above each other, px.
const NAME: f64 = 17.0;
/// Space between names and the frame, and at their left, px.
const BESIDE: f64 = 10.0;
const EDGE: f64 = 8.0;
/// Longer names are cut, px.
const LONGEST: f64 = 250.0;

/// A row of stretches.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Lane {
    /// Name of the lane, written at its left.
    pub name: String,
    /// The stretches of the lane; the space between them, or where they are not finite, stays empty.
    pub stretches: Vec<LaneInterval>,
}

/// A range of x in which a lane is of one class.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct LaneInterval {
    /// Beginning of the stretch, in the unit of the x axis.
    pub from: f64,
    /// End of the stretch, in the unit of the x axis.
    pub to: f64,
    /// Index of its class in the panel's `classes`.
    pub class: usize,
}

/// Height of a panel of lanes, px.
#[allow(clippy::cast_precision_loss)]
pub(super) fn height(lanes: &[Lane]) -> f64 {
    let count = lanes.len() as f64;
    // In whole px, or light lines would shine through between lanes.
    count * (MOST / count).floor().clamp(LEAST, HEIGHT)
}

/// Left end of frames that leaves room for the names, px.
pub(super) fn left(lanes: &[Lane]) -> f64 {
    let widths = lanes.iter().map(|lane| 1.1 * text_width(&lane.name, SMALL));
    let widest = widths.fold(0.0, f64::max).min(LONGEST);
    (EDGE + widest + BESIDE).ceil().max(LEFT)
}

/// Refuses what cannot be drawn.
pub(super) fn check(panel: &Panel) -> Result<(), Failure> {
    let wrong = |what: String| Err(Failure(format!("the panel {:?} {what}", panel.y_label)));
    let others = !panel.series.is_empty() || panel.raster.is_some();
    if others && !panel.lanes.is_empty() {
        return wrong("has lanes, so it can have neither series nor a raster".into());
    }
    for lane in &panel.lanes {
        for (place, LaneInterval { from, to, class }) in lane.stretches.iter().enumerate() {
            let what = format!("has a stretch {place} in the lane {:?}", lane.name);
            if *class >= panel.classes.len() {
                let count = panel.classes.len();
                return wrong(format!(
                    "{what} of class {class}, but there are {count} classes, counted from 0"
                ));
            }
            if from > to {
                return wrong(format!("{what} from {from} to {to}, which must ascend"));
            }
        }
    }
    Ok(())
}

pub(super) fn entries(panel: &Panel) -> impl Iterator<Item = Entry> {
    panel.classes.iter().map(Class::entry)
}

/// Description of the lanes in words, for readers who cannot see them.
pub(super) fn words(panel: &Panel) -> String {
    let list = |names: Vec<String>| names.join(", ");
    let lanes = panel.lanes.iter().map(|lane| format!("“{}”", lane.name));
    let classes = panel.classes.iter().map(|class| format!("“{}”", class.name));
    format!("lanes {}, each divided into {}", list(lanes.collect()), list(classes.collect()))
}

/// The heading, which stands where its base is.
pub(super) fn paint_heading<B: DrawingBackend>(
    canvas: &Canvas<B>,
    heading: &str,
    left: f64,
    top: f64,
) -> Result<(), Failure> {
    canvas.text(heading, [left, top + 0.5 * HEADING], MEDIUM, Align::Left)
}

/// Names and stretches.
#[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss)]
pub(super) fn paint<B: DrawingBackend>(
    canvas: &Canvas<B>,
    chart: &Chart,
    frame: &Frame<'_>,
    panel: &Panel,
) -> Result<(), Failure> {
    let height = (frame.bottom - frame.top) / panel.lanes.len() as f64;
    let gap = if height > 8.0 { 3.0 } else { 0.0 };
    let every = (NAME / height).ceil().max(1.0) as usize;
    let columns = (RIGHT - frame.left) as usize;
    for (place, lane) in panel.lanes.iter().enumerate() {
        let top = frame.top + height * place as f64;
        if place % every == 0 {
            let name = shortened(&lane.name);
            let at = [frame.left - BESIDE, top + 0.5 * height];
            canvas.text(&name, at, SMALL, Align::Right)?;
        }
        let spans = lane.stretches.iter().map(|stretch| {
            let end = |value: f64| frame.at_x(chart.scaled(value)) - frame.left;
            [end(stretch.from), end(stretch.to)]
        });
        let shown = shown(&spans.collect::<Vec<_>>(), columns);
        let classes: Vec<Option<usize>> =
            shown.iter().map(|found| found.map(|place| lane.stretches[place].class)).collect();
        let mut start = 0;
        for run in classes.chunk_by(|a, b| a == b) {
            let (left, end) = (start, start + run.len());
            start = end;
            let Some(class) = run[0] else { continue };
            // A little under the next one, so that no light line shines through between them.
            let under = if classes.get(end).copied().flatten().is_some() { 0.5 } else { 0.0 };
            let [left, right] = [left as f64, end as f64 + under].map(|x| frame.left + x);
            let corners = [left, top + gap, right, top + height - gap];
            let colours = panel.classes[class].colours();
            // One stripe for each colour, so that the narrowest stretch has them all.
            #[allow(clippy::cast_precision_loss)]
            let stripe = (corners[3] - corners[1]) / colours.len() as f64;
            canvas.striped(corners, &colours, corners[1], stripe)?;
        }
    }
    // The frame has no y axis of its own.
    canvas.line(&[[frame.left, frame.top], [frame.left, frame.bottom]], INK, 1.0, &[])
}

/// The span that each column shows: the one that covers most of it. Spans are in columns. A span that would be
/// visible nowhere has the column of its middle, if the one that is shown there has others.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_precision_loss)]
fn shown(spans: &[[f64; 2]], columns: usize) -> Vec<Option<usize>> {
    let mut shown: Vec<Option<usize>> = vec![None; columns];
    let mut most = vec![0.0; columns];
    let within = |[from, to]: [f64; 2]| to >= 0.0 && from <= columns as f64;
    for (place, &[from, to]) in spans.iter().enumerate().filter(|(_, span)| within(**span)) {
        let last = (to.ceil() as usize).min(columns);
        for column in from.floor() as usize..last {
            let common = to.min(column as f64 + 1.0) - from.max(column as f64);
            if common > most[column] {
                (most[column], shown[column]) = (common, Some(place));
            }
        }
    }
    let mut count = vec![0_usize; spans.len()];
    shown.iter().flatten().for_each(|&place| count[place] += 1);
    for (place, &[from, to]) in spans.iter().enumerate().filter(|(_, span)| within(**span)) {
        let middle = (0.5 * (from + to)) as usize;
        let column = middle.min(columns - 1);
        let free = shown[column].is_none_or(|other| count[other] > 1);
        if count[place] == 0 && free {
            if let Some(other) = shown[column] {
                count[other] -= 1;
            }
            (shown[column], count[place]) = (Some(place), 1);
        }
    }
    shown
}

/// A name without what has no room.
fn shortened(name: &str) -> String {
    let fits = |text: &str| 1.1 * text_width(text, SMALL) <= LONGEST;
    if fits(name) {
        return name.to_owned();
    }
    let mut short: String = name.to_owned();
    while short.pop().is_some() && !fits(&format!("{short}…")) {}
    short + "…"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_shows_what_covers_most_of_it_and_short_spans_are_not_lost() {
        let spans = [[0.0, 2.4], [2.4, 4.0], [5.0, 5.5]];
        assert_eq!(shown(&spans, 6), [Some(0), Some(0), Some(1), Some(1), None, Some(2)]);
        // An event within a long span, one without length, and one beyond the picture.
        let spans = [[0.0, 6.0], [1.4, 1.5], [3.0, 3.0], [-4.0, -2.0]];
        assert_eq!(shown(&spans, 6), [0, 1, 0, 2, 0, 0].map(Some));
        // More spans than columns: the columns keep what covers most of them.
        let spans = [[0.0, 0.6], [0.6, 1.0], [1.0, 1.6], [1.6, 2.0]];
        assert_eq!(shown(&spans, 2), [Some(0), Some(2)]);
        assert_eq!(shown(&[[f64::NAN, 1.0], [0.0, f64::NAN]], 1), [None]);
    }

    #[test]
    fn names_that_are_too_long_are_cut() {
        assert_eq!(shortened("contact 1"), "contact 1");
        let cut = shortened(&"guide ".repeat(20));
        assert!(cut.ends_with('…') && cut.starts_with("guide guide"), "{cut}");
        assert!(text_width(&cut, SMALL) < LONGEST);
    }
}
