//! How bundles of links are drawn, px.

use super::course::{Bundle, Course, GROUND, NAME};
use super::labels::{Request, half_size};
use super::plane::{across, add, along, dot, length, scaled, sub, unit, way};
use super::plot::Plot;
use super::text::written;
use super::{LinkKind, symbols};
use crate::picture::canvas::Point;
use crate::picture::palette::INK;

impl Plot<'_> {
    /// Links side by side, from bar to bar.
    pub(super) fn bundle(&mut self, bundle: &Bundle) {
        let flip = |[x, y]: Point| [x, -y];
        match bundle.course {
            Course::Straight([a, b]) => {
                let [from, to] = [self.middles[a], self.middles[b]];
                let forth = unit(sub(to, from));
                let back = scaled(forth, -1.0);
                let start = self.leave(a, forth, bundle);
                let end = self.leave(b, back, bundle);
                self.links(bundle, a, start, end);
            }
            Course::Ground(mass, way) => {
                let way = flip(way);
                let start = self.leave(mass, way, bundle);
                let away = self.stretched(GROUND, way);
                let end = along(self.middles[mass], way, away);
                let half = 0.5 * self.spread(bundle, way) + 16.0;
                symbols::ground(end, way, half, &mut self.shapes);
                self.links(bundle, mass, start, end);
            }
            Course::Named(pair, ways) => {
                for (place, (mass, way)) in pair.into_iter().zip(ways).enumerate() {
                    let way = flip(way);
                    let start = self.leave(mass, way, bundle);
                    let tip = along(self.middles[mass], way, self.stretched(NAME, way));
                    let end = along(tip, way, -14.0);
                    if bundle.links.len() > 1 {
                        let half = 0.5 * self.spread(bundle, way);
                        symbols::bar(end, way, half, &mut self.shapes);
                    }
                    symbols::arrow(end, tip, INK, &mut self.shapes);
                    self.links(bundle, mass, start, end);
                    let other = &self.structure.masses[pair[1 - place]].name;
                    self.requests.push(Request {
                        texts: vec![vec![format!("to {other}")], vec!["to".into(), other.clone()]],
                        spots: around(tip, way, 4.0),
                        acts: None,
                        of: (tip, 3.0),
                    });
                }
            }
        }
    }

    /// Where links begin that leave a mass along a way: at its edge, or at a bar before it.
    fn leave(&mut self, mass: usize, way: Point, bundle: &Bundle) -> Point {
        let middle = self.middles[mass];
        let edge = along(middle, way, self.edge(mass, way));
        // A face that is wide enough needs no bar.
        let faces = self.axes(mass).iter().any(|axis| dot(*axis, way).abs() > 0.9999);
        let outermost = 0.5 * self.spread(bundle, way);
        if bundle.links.len() == 1 || (faces && outermost < 0.85 * self.half) {
            return edge;
        }
        let short = 6.0_f64.min(0.1 * self.scale[0]);
        let end = along(middle, way, self.support(mass, way) + short);
        symbols::bar(end, way, outermost, &mut self.shapes);
        self.shapes.push(symbols::line(&[edge, end], INK));
        end
    }

    /// Between the first and the last link of a bundle.
    #[allow(clippy::cast_precision_loss)]
    fn spread(&self, bundle: &Bundle, way: Point) -> f64 {
        let count = bundle.links.len();
        let amplitude = self.style.amplitude;
        let step = if count < 3 {
            3.6 * amplitude
        } else if way[0].abs() > 0.5 {
            2.0 * amplitude + self.style.size + 10.0
        } else {
            let inner = bundle.links[1..count - 1].iter().map(|&place| {
                let text = self
                    .texts(place)
                    .first()
                    .map_or(0.0, |lines| half_size(lines, true, self.style.size)[0]);
                2.0 * text + 2.0 * amplitude + 10.0
            });
            inner.fold(24.0, f64::max)
        };
        step * (count - 1) as f64
    }

    /// How a link may be written.
    fn texts(&self, place: usize) -> Vec<Vec<String>> {
        let link = &self.structure.links[place];
        written(&link.name, &link.label, self.style.values)
    }

    /// Side by side, from the mass at their start.
    #[allow(clippy::cast_precision_loss)]
    fn links(&mut self, bundle: &Bundle, mass: usize, start: Point, end: Point) {
        let forth = unit(sub(end, start));
        // Upwards, or to the right: there a single link has its name.
        let side = across(forth);
        let side = if side[1] > 0.3 || (side[1].abs() <= 0.3 && side[0] < 0.0) {
            scaled(side, -1.0)
        } else {
            side
        };
        let count = bundle.links.len();
        let amplitude = self.style.amplitude;
        let spread = self.spread(bundle, forth);
        for (at, &place) in bundle.links.iter().enumerate() {
            let offset = if count > 1 {
                // The first of a bundle is at its upper or left end.
                let step = spread / (count - 1) as f64;
                let first = if side[1].abs() > 0.3 { 0.5 } else { -0.5 };
                first * spread - 2.0 * first * step * at as f64
            } else {
                0.0
            };
            let [from, to] = [start, end].map(|end| along(end, side, offset));
            let link = &self.structure.links[place];
            match link.kind {
                LinkKind::Spring => symbols::spring([from, to], amplitude, &mut self.shapes),
                LinkKind::Damper => symbols::dashpot([from, to], amplitude, &mut self.shapes),
            }
            let acts = way(-link.direction);
            if link.preload != 0.0 {
                // The first end feels it along the direction, the second one against it.
                let first = link.ends[0] == Some(mass);
                let along_link = dot(acts, forth) >= -1e-9;
                let pulls = (link.preload > 0.0) == (first == along_link);
                symbols::preload([from, to], pulls, &mut self.shapes);
            }
            let turned = dot(acts, across(forth)).abs() > 0.05;
            let middle = scaled(add(from, to), 0.5);
            // Of many, all have theirs on the same side.
            let outwards = if offset < -1e-9 && count == 2 { scaled(side, -1.0) } else { side };
            let mut spots = Vec::new();
            let back = scaled(outwards, -1.0);
            for (out, gap) in [(outwards, 4.0), (back, 4.0), (outwards, 10.0)] {
                for part in [0.0, 0.12, -0.12, 0.25, -0.25, 0.38, -0.38] {
                    let foot = along(middle, forth, part * length(sub(to, from)));
                    spots.push([along(foot, out, amplitude + gap), out]);
                }
            }
            let texts = self.texts(place);
            if !texts.is_empty() {
                let acts = turned.then_some(acts);
                self.requests.push(Request { texts, spots, acts, of: (middle, amplitude) });
            }
        }
    }
}

/// Spots beyond a tip and beside it.
fn around(tip: Point, way: Point, gap: f64) -> Vec<[Point; 2]> {
    let side = across(way);
    let back = along(tip, way, -7.0);
    let mut spots = vec![[along(tip, way, gap), way]];
    for side in [side, scaled(side, -1.0)] {
        spots.push([along(back, side, gap + 5.0), side]);
        spots.push([along(tip, side, gap + 2.0), unit(add(way, side))]);
    }
    spots
}
