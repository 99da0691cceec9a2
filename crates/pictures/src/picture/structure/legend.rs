//! What the symbols of a structure mean: a sample and a few words for each that occurs.

use super::plane::add;
use super::symbols::{self, Shape};
use super::{LinkKind, Structure};
use crate::picture::axes::SMALL;
use crate::picture::canvas::{Point, WIDTH, text_width};
use crate::picture::palette::INK;

const ROW: f64 = 26.0;
const MARGIN: f64 = 20.0;
/// Width of a sample, px.
const SAMPLE: f64 = 34.0;

/// Samples and words in rows, px from the legend's upper left corner.
pub(super) struct Legend {
    pub(super) shapes: Vec<Shape>,
    /// Left ends of texts at their middle heights.
    pub(super) words: Vec<(String, Point)>,
    pub(super) height: f64,
}

/// Which symbols occur that the structure itself does not show.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Used {
    pub(super) acts: bool,
    pub(super) named: bool,
    pub(super) repeated: bool,
}

impl Legend {
    pub(super) fn of(structure: &Structure, used: Used) -> Self {
        let kind = |kind| structure.links.iter().any(|link| link.kind == kind);
        let grounded = structure.links.iter().any(|link| link.ends.contains(&None));
        let mut legend = Self { shapes: Vec::new(), words: Vec::new(), height: 0.0 };
        let mut x = MARGIN;
        let [from, to, middle] = [[2.0, 0.0], [SAMPLE - 2.0, 0.0], [0.5 * SAMPLE, 0.0]];
        let mut entry = |there: bool, words: &str, draw: &dyn Fn(&mut Vec<Shape>)| {
            if there {
                legend.add(&mut x, words, draw);
            }
        };
        entry(kind(LinkKind::Spring), "spring", &|shapes| symbols::spring([from, to], 6.0, shapes));
        entry(kind(LinkKind::Damper), "damper", &|shapes| {
            symbols::dashpot([from, to], 6.0, shapes);
        });
        entry(grounded, "fixed", &|shapes| {
            symbols::ground([middle[0], -4.0], [0.0, 1.0], 13.0, shapes);
        });
        let rigid = structure.sliders.iter().any(|slider| slider.on.is_none());
        let moves = structure.sliders.iter().any(|slider| slider.velocity != 0.0);
        let words = if moves { "slider and its motion" } else { "slider" };
        let (up, arrow) = if moves { (-11.0, Some([1.0, 0.0])) } else { (-4.0, None) };
        entry(rigid, words, &|shapes| {
            symbols::slider([middle[0], up], [0.0, 1.0], 15.0, true, arrow, shapes);
        });
        let on = structure.sliders.iter().any(|slider| slider.on.is_some());
        entry(on, "surface of another mass", &|shapes| {
            symbols::slider([middle[0], -2.0], [0.0, 1.0], 15.0, false, None, shapes);
        });
        let locked = structure.masses.iter().any(|mass| mass.locked != [false; 2]);
        entry(locked, "guide: no motion towards it", &|shapes| {
            symbols::guide([middle[0], -9.0], [0.0, 1.0], 14.0, shapes);
        });
        let pushed = !structure.forces.is_empty();
        entry(pushed, "force", &|shapes| {
            symbols::arrow(from, to, symbols::force_colour(), shapes);
        });
        let preloaded = structure.links.iter().any(|link| link.preload != 0.0);
        entry(preloaded, "preload, as its end pushes or pulls", &|shapes| {
            shapes.push(symbols::line(&[from, to], symbols::spring_colour()));
            symbols::preload([middle, to], true, shapes);
        });
        entry(structure.signals, "~ with a signal added over time", &|_| {});
        entry(used.acts, "acts in this direction, wherever it is drawn", &|shapes| {
            symbols::acts(middle, [1.0, 0.0], 9.0, shapes);
        });
        entry(used.named, "goes on at the mass named", &|shapes| {
            symbols::arrow(from, to, INK, shapes);
        });
        entry(used.repeated, "like links may be named once", &|_| {});
        legend
    }

    fn add(&mut self, x: &mut f64, words: &str, draw: &dyn Fn(&mut Vec<Shape>)) {
        // The reader's own font may be a little wider.
        let width = SAMPLE + 28.0 + 1.05 * text_width(words, SMALL);
        if *x > MARGIN && *x + width - 20.0 > WIDTH - MARGIN {
            *x = MARGIN;
            self.height += ROW;
        }
        if self.height == 0.0 {
            self.height = ROW;
        }
        let middle = self.height - 0.5 * ROW;
        let mut shapes = Vec::new();
        draw(&mut shapes);
        let sample = if shapes.is_empty() { 0.0 } else { SAMPLE + 8.0 };
        self.shapes.extend(shapes.iter().map(|shape| shape.moved([*x, middle])));
        self.words.push((words.into(), add([*x, middle], [sample, 0.0])));
        *x += width;
    }
}
