//! Mode shapes in motion: an SVG that moves by itself, without scripts.
//!
//! Each mode is drawn three times: at rest, pale; moving; and still, which replaces the moving one
//! for readers who prefer less motion. Where nothing can move, the moving one is still as well.

use super::axes::{LARGE, MEDIUM, SMALL};
use super::canvas::{Drawing, Point, WIDTH, svg_head};
use super::mode_shapes::{HAND, Mass, ModeLayout, NOTES, PlacedMode};
use super::palette::{GREY, INK, PALE};
use plotters::style::{RGBColor, WHITE};
use quick_xml::escape::escape;
use std::f64::consts::TAU;
use std::fmt::Write;

/// Duration of a cycle, whatever the mode.
const CYCLE: &str = "2s";
/// Positions in a cycle; lines between them are within one percent of the motion.
const SAMPLES: u32 = 24;

pub(super) fn svg(layout: &ModeLayout<'_>) -> String {
    let mut svg = svg_head(layout, &format!("0 0 {WIDTH} {}", layout.height()));
    svg += "<style>\n\
            path { fill: none; stroke-linecap: round; stroke-linejoin: round; }\n\
            @media (prefers-reduced-motion: reduce) {\n\
            .moving { display: none; }\n\
            .still { display: inline; }\n\
            }\n</style>\n";
    svg += "<rect width=\"100%\" height=\"100%\" fill=\"#FFFFFF\"/>\n";
    svg += &text(layout.title(), layout.title_at(), LARGE);
    for cell in &layout.cells {
        svg += &mode(cell);
    }
    for (line, note) in (0..).zip(NOTES) {
        svg += &text(note, layout.note_at(line), SMALL);
    }
    svg + "</svg>\n"
}

fn text(text: &str, [x, y]: Point, size: f64) -> String {
    // Sizes are those of the drawing library, which counts a line's height.
    let size = size / 1.24;
    format!(
        "<text x=\"{x:.1}\" y=\"{y:.1}\" dy=\"0.35em\" font-family=\"sans-serif\" \
         font-size=\"{size:.1}\" fill=\"{}\">{}</text>\n",
        hex(INK),
        escape(text)
    )
}

fn mode(cell: &PlacedMode<'_>) -> String {
    let mut svg = format!("<g>\n{}", text(cell.title, cell.title_at, MEDIUM));
    let mut rest = lines(&cell.springs(|mass| mass.rest));
    for mass in &cell.masses {
        rest += &path(&mass.outline(mass.rest));
    }
    svg += &drawn(&rest, PALE, 1.0, "");
    svg += &drawn(&lines(&cell.fixed()), GREY, 2.5, "");
    for moves in [true, false] {
        let class = if moves { "\"moving\"" } else { "\"still\" display=\"none\"" };
        let _ = writeln!(svg, "<g class={class}>");
        let springs = |phase| lines(&cell.springs(|mass| mass.at(phase)));
        let motion = if moves { over_a_cycle("animate", "d", springs) } else { String::new() };
        svg += &drawn(&springs(0.0), GREY, 1.5, &motion);
        for mass in &cell.masses {
            svg += &body(mass, moves);
        }
        svg += "</g>\n";
    }
    svg + "</g>\n"
}

fn body(mass: &Mass, moves: bool) -> String {
    let [x, y] = mass.at(0.0);
    let mut svg = format!("<g transform=\"translate({x:.1} {y:.1})\">");
    if moves {
        svg += &over_a_cycle("animateTransform", "transform\" type=\"translate", |phase| {
            let [x, y] = mass.at(phase);
            format!("{x:.1} {y:.1}")
        });
    }
    let (half, side) = (mass.half, 2.0 * mass.half);
    let _ = write!(
        svg,
        "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{side:.1}\" height=\"{side:.1}\" \
         transform=\"rotate({:.2})\" fill=\"{}\"/>",
        -half,
        -half,
        mass.turned.to_degrees(),
        hex(mass.colour)
    );
    if let Some(phase) = mass.phase {
        let [x, y] = mass.hand(phase);
        let hand = format!("M0 0L{x:.1} {y:.1}");
        let motion = if moves {
            format!(
                "<animateTransform attributeName=\"transform\" type=\"rotate\" dur=\"{CYCLE}\" \
                 repeatCount=\"indefinite\" from=\"0\" to=\"-360\"/>"
            )
        } else {
            String::new()
        };
        let _ = write!(svg, "<circle r=\"{HAND}\" fill=\"#FFFFFF\"/>");
        svg += &drawn(&hand, WHITE, HAND, &motion);
    }
    svg + "</g>\n"
}

fn over_a_cycle(element: &str, attribute: &str, value: impl Fn(f64) -> String) -> String {
    let phase = |sample| TAU * f64::from(sample % SAMPLES) / f64::from(SAMPLES);
    let values: Vec<String> = (0..=SAMPLES).map(|sample| value(phase(sample))).collect();
    format!(
        "<{element} attributeName=\"{attribute}\" dur=\"{CYCLE}\" repeatCount=\"indefinite\" \
         values=\"{}\"/>",
        values.join(";")
    )
}

fn drawn(path: &str, colour: RGBColor, width: f64, inside: &str) -> String {
    let stroke = hex(colour);
    format!("<path d=\"{path}\" stroke=\"{stroke}\" stroke-width=\"{width}\">{inside}</path>\n")
}

fn lines(lines: &[[Point; 2]]) -> String {
    lines.iter().map(|line| path(line)).collect()
}

fn path(points: &[Point]) -> String {
    let mut text = String::new();
    for (place, [x, y]) in points.iter().enumerate() {
        let _ = write!(text, "{}{x:.1} {y:.1}", if place == 0 { 'M' } else { 'L' });
    }
    text
}

fn hex(RGBColor(red, green, blue): RGBColor) -> String {
    format!("#{red:02X}{green:02X}{blue:02X}")
}
