//! Marks: places on the x axis, their lines and labels.

use super::{Chart, Mark};
use crate::picture::axes::{Frame, RIGHT, SMALL};
use crate::picture::canvas::{Align, Canvas, Failure, text_width};
use crate::picture::palette::GREY;
use plotters::backend::DrawingBackend;
use plotters::style::WHITE;

pub(super) const MARK_ROW: f64 = 18.0;
/// Rows of marks' labels that a panel has room for.
const MARK_ROWS: u32 = 8;

/// A mark's label.
pub(super) struct MarkLabel<'a> {
    text: &'a str,
    x: f64,
    pub(super) row: u32,
    /// `true` if the label ends at its line, because the frame does.
    ends: bool,
}

/// Labels to the right of their lines, or at the right end to the left, in rows such that neither
/// labels nor lines cross a label.
pub(super) fn mark_labels<'a>(
    chart: &Chart,
    frame: &Frame<'_>,
    marks: &'a [Mark],
) -> Vec<MarkLabel<'a>> {
    let finite = marks.iter().filter(|mark| chart.scaled(mark.x).is_finite());
    let place = |mark: &Mark| frame.at_x(chart.scaled(mark.x));
    let mut labelled: Vec<(f64, &str)> =
        finite.filter_map(|mark| Some((place(mark), mark.label.as_deref()?))).collect();
    labelled.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut edge = f64::INFINITY;
    let (mut ending, mut starting) = (Vec::new(), Vec::new());
    for (x, text) in labelled {
        let width = 1.1 * text_width(text, SMALL) + 12.0;
        if (x + width > RIGHT + 10.0 || x > edge) && x > width {
            edge = edge.min(x - width);
            ending.push(([x - width, x], MarkLabel { text, x, row: 0, ends: true }));
        } else {
            starting.push(([x, x + width], MarkLabel { text, x, row: 0, ends: false }));
        }
    }
    let mut placed: Vec<([f64; 2], MarkLabel<'a>)> = Vec::new();
    // A line stands at its label's outer end and goes down past the labels placed before it, so
    // the labels farthest in the direction of writing come first.
    for (span, mut label) in ending.into_iter().rev().chain(starting) {
        let meets = |other: &[f64; 2]| span[0] < other[1] && other[0] < span[1];
        let below = placed.iter().filter(|(other, _)| meets(other)).map(|(_, label)| label.row);
        label.row = below.max().map_or(0, |row| row + 1);
        if label.row < MARK_ROWS {
            placed.push((span, label));
        }
    }
    placed.into_iter().map(|(_, label)| label).collect()
}

/// Lines over the frame, with a white edge where they lie on other colours.
pub(super) fn paint_marks<B: DrawingBackend>(
    canvas: &Canvas<B>,
    chart: &Chart,
    frame: &Frame<'_>,
    marks: &[Mark],
    edged: bool,
) -> Result<(), Failure> {
    let marks = marks.iter().map(|mark| chart.scaled(mark.x));
    for x in marks.filter(|x| x.is_finite()).map(|x| frame.at_x(x)) {
        let line = [[x, frame.top], [x, frame.bottom]];
        if edged {
            canvas.line(&line, WHITE, 3.0, &[])?;
        }
        canvas.line(&line, GREY, 1.0, &[5.0, 4.0])?;
    }
    Ok(())
}

pub(super) fn paint_label<B: DrawingBackend>(
    canvas: &Canvas<B>,
    frame: &Frame<'_>,
    label: &MarkLabel<'_>,
) -> Result<(), Failure> {
    let bottom = frame.top - MARK_ROW * f64::from(label.row);
    let (x, middle) = (label.x, bottom - 0.5 * MARK_ROW);
    canvas.line(&[[x, bottom - MARK_ROW + 2.0], [x, frame.top]], GREY, 1.0, &[])?;
    if label.ends {
        canvas.text(label.text, [x - 4.0, middle], SMALL, Align::Right)
    } else {
        canvas.text(label.text, [x + 4.0, middle], SMALL, Align::Left)
    }
}
