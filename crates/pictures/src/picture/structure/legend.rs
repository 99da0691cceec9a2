//! The legend of a structure: a sample and a few words for each symbol that occurs.

use super::plane::add;
use super::symbols::{self, Shape};
use super::{LinkKind, Structure};
use crate::picture::axes::SMALL;
use crate::picture::canvas::{Align, Canvas, Failure, Point, WIDTH, text_width};
use crate::picture::palette::INK;
use plotters::backend::DrawingBackend;

const ROW: f64 = 26.0;
const MARGIN: f64 = 20.0;
/// Width of a sample, px.
const SAMPLE: f64 = 34.0;
/// Line from end to end of a sample, at its middle height.
const LINE: [Point; 2] = [[2.0, 0.0], [SAMPLE - 2.0, 0.0]];
const MIDDLE: Point = [0.5 * SAMPLE, 0.0];
const DOWN: Point = [0.0, 1.0];

/// Samples and words in rows, px from the legend's upper left corner.
#[derive(Default)]
pub(super) struct StructureLegend {
    shapes: Vec<Shape>,
    /// Left ends of texts at their middle heights.
    words: Vec<(&'static str, Point)>,
    /// Height of its rows so far.
    pub(super) height: f64,
    /// Width of the widest row, with the margin at its left.
    pub(super) width: f64,
    /// Position at which the next sample begins.
    x: f64,
}

/// Symbols that occur and that the structure itself does not show.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct UsedSymbols {
    pub(super) acts: bool,
    pub(super) named: bool,
}

impl StructureLegend {
    pub(super) fn of(structure: &Structure, used: UsedSymbols) -> Self {
        let Structure { masses, links, sliders, forces, signals, .. } = structure;
        let is_there = |kind| links.iter().any(|link| link.kind == kind);
        let moves = sliders.iter().any(|slider| slider.velocity != 0.0);
        let (up, arrow) = if moves { (11.0, Some([1.0, 0.0])) } else { (4.0, None) };
        let slider = if moves { "slider and its motion" } else { "slider" };
        let mut legend = Self::default();
        let mut add = |there: bool, words, draw: &dyn Fn(&mut Vec<Shape>)| {
            if there {
                legend.add(words, draw);
            }
        };
        add(is_there(LinkKind::Spring), "spring", &|s| symbols::spring(LINE, 6.0, s));
        add(is_there(LinkKind::Damper), "damper", &|s| symbols::dashpot(LINE, 6.0, s));
        let grounded = links.iter().any(|link| link.ends.contains(&None));
        add(grounded, "fixed", &|s| symbols::ground(above(4.0), DOWN, 13.0, s));
        let rigid = sliders.iter().any(|slider| slider.on.is_none());
        add(rigid, slider, &|s| symbols::slider(above(up), DOWN, 15.0, true, arrow, s));
        let on = sliders.iter().any(|slider| slider.on.is_some());
        let surface = |s: &mut Vec<Shape>| symbols::slider(above(2.0), DOWN, 15.0, false, None, s);
        add(on, "surface of another mass", &surface);
        let locked = masses.iter().any(|mass| mass.locked != [false; 2]);
        let guide = |s: &mut Vec<Shape>| symbols::guide(above(9.0), DOWN, 14.0, s);
        add(locked, "guide: no motion towards it", &guide);
        let force = |s: &mut Vec<Shape>| symbols::arrow(LINE, symbols::force_colour(), s);
        add(!forces.is_empty(), "force", &force);
        let preloaded = links.iter().any(|link| link.preload != 0.0);
        add(preloaded, "preload, as its end pushes or pulls", &|s| {
            s.push(symbols::line(&LINE, symbols::spring_colour(), 1.6));
            symbols::preload([MIDDLE, LINE[1]], true, s);
        });
        add(*signals, "~ with a signal added over time", &|_| {});
        let acts = |s: &mut Vec<Shape>| symbols::acts(MIDDLE, [1.0, 0.0], 9.0, s);
        add(used.acts, "acts in this direction, wherever it is drawn", &acts);
        add(used.named, "continues at the named mass", &|s| symbols::arrow(LINE, INK, s));
        legend
    }

    fn add(&mut self, words: &'static str, draw: &dyn Fn(&mut Vec<Shape>)) {
        // The reader's own font may be a little wider.
        let width = SAMPLE + 28.0 + 1.05 * text_width(words, SMALL);
        if self.words.is_empty() || self.x + width - 20.0 > WIDTH - MARGIN {
            (self.x, self.height) = (MARGIN, self.height + ROW);
        }
        let corner = [self.x, self.height - 0.5 * ROW];
        let mut shapes = Vec::new();
        draw(&mut shapes);
        let sample = if shapes.is_empty() { 0.0 } else { SAMPLE + 8.0 };
        self.shapes.extend(shapes.iter().map(|shape| shape.placed(1.0, corner)));
        self.words.push((words, add(corner, [sample, 0.0])));
        self.x += width;
        self.width = self.width.max(self.x - 20.0);
    }

    /// Paints it with its upper end at a height.
    pub(super) fn paint<B: DrawingBackend>(
        &self,
        top: f64,
        canvas: &Canvas<B>,
    ) -> Result<(), Failure> {
        for shape in &self.shapes {
            shape.placed(1.0, [0.0, top]).paint(canvas)?;
        }
        for (words, at) in &self.words {
            canvas.text(words, add(*at, [0.0, top]), SMALL, Align::Left)?;
        }
        Ok(())
    }
}

/// The point at this height above the middle of a sample.
fn above(height: f64) -> Point {
    add(MIDDLE, [0.0, -height])
}
