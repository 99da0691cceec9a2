//! Drawing of runs of links, px.

use super::labels::{Request, half_size};
use super::layout::{End, Run, STUB};
use super::plane::{across, along, dot, scaled, sub, unit, way};
use super::plot::{Plot, SheetStyle};
use super::{LinkKind, symbols};
use crate::picture::canvas::Point;
use crate::picture::palette::INK;

impl Plot<'_> {
    /// Links side by side, from bar to bar.
    pub(super) fn run(&mut self, run: &Run) {
        let (way, stub) = match run.end {
            End::Mass(other) => (unit(sub(self.middles[other], self.middles[run.mass])), 0.0),
            _ => {
                let [x, y] = run.way.map(f64::abs);
                let step = (x * self.scale[0] + y * self.scale[1]) / (x + y);
                ([run.way[0], -run.way[1]], STUB * step)
            }
        };
        let start = self.leave(run.mass, way, run);
        let tip = along(self.middles[run.mass], way, stub);
        let half = 0.5 * self.spread(run, way);
        let end = match run.end {
            End::Mass(other) => self.leave(other, scaled(way, -1.0), run),
            End::Ground => {
                symbols::ground(tip, way, half + 16.0, &mut self.shapes);
                tip
            }
            End::Name(other) => {
                let end = along(tip, way, -14.0);
                symbols::bar(end, way, half, &mut self.shapes);
                symbols::arrow([end, tip], INK, &mut self.shapes);
                let name = &self.structure.masses[other].name;
                let texts = vec![vec![format!("to {name}")], vec!["to".into(), name.clone()]];
                let side = across(way);
                self.request(texts, [end, tip], 5.0, &[way, side, scaled(side, -1.0)]);
                end
            }
        };
        self.links(run, [start, end]);
    }

    /// Point from which links leave a mass along a direction: at its edge, or at a bar before it.
    fn leave(&mut self, mass: usize, way: Point, run: &Run) -> Point {
        let middle = self.middles[mass];
        let [a, b] = self.axes(mass).map(|axis| dot(axis, way).abs());
        let edge = along(middle, way, self.half / a.max(b));
        // A face that is wide enough needs no bar.
        let outermost = 0.5 * self.spread(run, way);
        if run.links.len() == 1 || (a.max(b) > 0.9999 && outermost < 0.85 * self.half) {
            return edge;
        }
        let short = 6.0_f64.min(0.1 * self.scale[0]);
        let end = along(middle, way, self.support(mass, way) + short);
        symbols::bar(end, way, outermost, &mut self.shapes);
        self.shapes.push(symbols::line(&[edge, end], INK, 1.6));
        end
    }

    /// Distance between the first and the last link of a run. The label of an inner one stands between it and the
    /// next.
    #[allow(clippy::cast_precision_loss)]
    fn spread(&self, run: &Run, way: Point) -> f64 {
        let SheetStyle { amplitude, size, .. } = self.style;
        let widths = run.links.iter().filter_map(|&place| {
            let link = &self.structure.links[place];
            Some(2.0 * half_size(self.written(&link.name, &link.label).first()?, true, size)[0])
        });
        let step = match run.links.len() {
            ..3 => 3.6 * amplitude,
            _ if way[0].abs() > 0.5 => 2.0 * amplitude + size + 10.0,
            _ => 2.0 * amplitude + 10.0 + widths.fold(24.0, f64::max),
        };
        step * (run.links.len() - 1) as f64
    }

    /// Side by side; the first is the upper or left one.
    #[allow(clippy::cast_precision_loss)]
    fn links(&mut self, run: &Run, ends: [Point; 2]) {
        let forth = unit(sub(ends[1], ends[0]));
        let side = across(forth);
        // Downwards, or to the right.
        let down = if side[1].abs() > 0.3 { side[1] > 0.0 } else { side[0] > 0.0 };
        let side = if down { side } else { scaled(side, -1.0) };
        let (amplitude, spread) = (self.style.amplitude, self.spread(run, forth));
        let steps = (run.links.len() - 1).max(1) as f64;
        for (at, &place) in run.links.iter().enumerate() {
            let offset = spread * (at as f64 / steps - 0.5);
            let line = ends.map(|end| along(end, side, offset));
            let link = &self.structure.links[place];
            match link.kind {
                LinkKind::Spring => symbols::spring(line, amplitude, &mut self.shapes),
                LinkKind::Damper => symbols::dashpot(line, amplitude, &mut self.shapes),
            }
            let acts = way(-link.direction);
            if link.preload != 0.0 {
                // The first end feels it along the direction, the second one against it.
                let first = link.ends[0] == Some(run.mass);
                let along_link = dot(acts, forth) >= -1e-9;
                let pulls = (link.preload > 0.0) == (first == along_link);
                symbols::preload(line, pulls, &mut self.shapes);
            }
            let turned = dot(acts, across(forth)).abs() > 0.05;
            // Above or to the right; but two links have theirs at their outer sides.
            let upright = side[1].abs() <= 0.3;
            let outer = if run.links.len() == 2 { offset > 0.0 } else { upright };
            let outwards = if outer { side } else { scaled(side, -1.0) };
            self.requests.push(Request {
                texts: self.written(&link.name, &link.label),
                line,
                reach: amplitude,
                outs: vec![outwards, scaled(outwards, -1.0)],
                acts: turned.then_some(acts),
            });
        }
    }
}
