//! Texts beside the points of a chart, where nothing else is.

use super::axes::{Frame, RIGHT, SMALL};
use super::canvas::{Align, Point, text_width};

const HEIGHT: f64 = 15.0;
/// Distance between a point and its text, px.
const AWAY: f64 = 9.0;
/// Lines are checked in pieces not longer than this, px.
const PIECE: f64 = 4.0;

/// A text with its place, px.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SideText {
    pub(super) text: String,
    pub(super) at: Point,
    pub(super) align: Align,
}

/// A rectangle: left, top, right, bottom.
type Area = [f64; 4];

fn meet(a: Area, b: Area) -> bool {
    a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3]
}

/// Texts beside points, each at the first of eight places that is free of the lines and of other texts; those
/// without one are left out.
pub(super) fn texts(
    frame: &Frame<'_>,
    points: &[(Point, &str)],
    lines: &[Vec<Point>],
) -> Vec<SideText> {
    let mut taken: Vec<Area> = lines.iter().flat_map(|line| pieces(line)).collect();
    taken.extend(points.iter().map(|&([x, y], _)| [x - 4.0, y - 4.0, x + 4.0, y + 4.0]));
    let mut placed = Vec::new();
    for &([x, y], text) in points.iter().filter(|(_, text)| !text.is_empty()) {
        let width = 1.1 * text_width(text, SMALL);
        let (near, far) = (0.7 * AWAY, AWAY + 0.5 * HEIGHT);
        let places = [
            (near, -near - 3.0, Align::Left),
            (AWAY, 0.0, Align::Left),
            (-near, near + 3.0, Align::Right),
            (near, near + 3.0, Align::Left),
            (0.0, -far, Align::Centre),
            (0.0, far, Align::Centre),
            (-AWAY, 0.0, Align::Right),
            (-near, -near - 3.0, Align::Right),
        ];
        let free = places.into_iter().find_map(|(dx, dy, align)| {
            let at = [x + dx, y + dy];
            let left = at[0]
                - match align {
                    Align::Left => 0.0,
                    Align::Centre => 0.5 * width,
                    Align::Right => width,
                };
            let area = [left, at[1] - 0.5 * HEIGHT, left + width, at[1] + 0.5 * HEIGHT];
            let inside = area[0] > frame.left
                && area[2] < RIGHT
                && area[1] > frame.top
                && area[3] < frame.bottom;
            (inside && !taken.iter().any(|&other| meet(area, other))).then_some((at, align, area))
        });
        if let Some((at, align, area)) = free {
            taken.push(area);
            placed.push(SideText { text: text.to_owned(), at, align });
        }
    }
    placed
}

/// A line as small areas.
fn pieces(line: &[Point]) -> Vec<Area> {
    let mut areas = Vec::new();
    for pair in line.windows(2) {
        let [from, to] = [pair[0], pair[1]];
        let count = ((to[0] - from[0]).hypot(to[1] - from[1]) / PIECE).ceil().max(1.0);
        let mut done = 0.0;
        while done <= count {
            let [x, y] = [0, 1].map(|axis| from[axis] + done / count * (to[axis] - from[axis]));
            areas.push([x - 1.5, y - 1.5, x + 1.5, y + 1.5]);
            done += 1.0;
        }
    }
    areas
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::axes::LEFT;

    #[test]
    fn texts_keep_off_lines_and_each_other_and_the_rest_is_left_out() {
        let frame = Frame {
            left: LEFT,
            top: 0.0,
            bottom: 300.0,
            x: [0.0, 1.0],
            y: [0.0, 1.0],
            y_label: "",
            x_label: None,
            grid: false,
            y_axis: true,
            logarithmic: false,
        };
        let line = vec![[200.0, 150.0], [400.0, 150.0]];
        let alone = texts(&frame, &[(line[0], "1 µs")], std::slice::from_ref(&line));
        assert_eq!(alone.len(), 1);
        assert!((alone[0].at[1] - 150.0).abs() > 0.5 * HEIGHT);
        // A dozen at one point find eight places at most.
        let crowd = texts(&frame, &vec![(line[0], "1 µs"); 12], &[line]);
        assert!((2..8).contains(&crowd.len()), "{}", crowd.len());
    }
}
