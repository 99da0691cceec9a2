//! The modes of a ring of modules, side by side: in motion as SVG, at rest as PNG.

use super::axes::{LARGE, MEDIUM, SMALL};
use super::canvas::{self, Align, Canvas, Drawing, Failure, Point, WIDTH};
use super::file::{Format, save};
use super::moving;
use super::palette::{GREY, PALE, colour};
use amontons::Error;
use nalgebra::Complex;
use plotters::backend::DrawingBackend;
use plotters::style::{RGBColor, WHITE};
use std::f64::consts::FRAC_PI_2;
use std::path::Path;

/// Degrees of freedom of a module.
const DOFS: usize = 4;
const MARGIN: f64 = 15.0;
const HEAD: f64 = 42.0;
/// Lines below the modes that say how to read them.
pub(super) const NOTES: [&str; 3] = [
    "Upper squares: m1; lower squares: m2 on its slider; pale squares: at rest. The links at the left \
     and right ends are the same.",
    "Hands show the phase, one turn per cycle: masses with parallel hands move in phase, with \
     opposite hands in antiphase. A mass without a hand rests.",
    "All modes are drawn with the same amplitude and frequency, without growth or decay.",
];
const NOTE_ROW: f64 = 19.0;
/// Width of hands and radius of what they turn about, px.
pub(super) const HAND: f64 = 1.8;
/// Below this part of the largest motion a mass is at rest, and its phase means nothing.
const AT_REST: f64 = 0.01;

/// Modes of a ring of equal or different modules.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ModeShapes {
    /// Title of the picture.
    pub title: String,
    /// θ, rad: the slider's tangent is t = (cos θ, sin θ).
    pub angle: f64,
    /// The modes in rows, from the left.
    pub modes: Vec<ModeShape>,
}

/// One mode.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ModeShape {
    /// Name of the mode, with its frequency and growth rate.
    pub title: String,
    /// Four values a module: m1 to the right and up, m2 along the slider's tangent and normal.
    pub shape: Vec<Complex<f64>>,
}

impl ModeShapes {
    /// Writes the modes as the path's ending asks: `.svg` moves, but not for readers who prefer
    /// less motion; `.png`, and what they see, is the shape at the time of its largest motion.
    ///
    /// # Errors
    /// Another ending, no modes, shapes that are not four finite values for each of the same
    /// modules, or a file that cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        let layout = ModeLayout::of(self).map_err(|failure| canvas::cannot_draw(path, &failure))?;
        match Format::of(path)? {
            Format::Svg => save(path, moving::svg(&layout).as_bytes()),
            Format::Png => canvas::write(&layout, path),
        }
    }
}

/// Modes with places for everything, px.
pub(super) struct ModeLayout<'a> {
    modes: &'a ModeShapes,
    pub(super) cells: Vec<PlacedMode<'a>>,
    height: f64,
}

/// One mode and its place in the picture.
pub(super) struct PlacedMode<'a> {
    pub(super) title: &'a str,
    /// Left end of the title, at its middle height.
    pub(super) title_at: Point,
    left: f64,
    right: f64,
    ground: f64,
    /// m1 and m2 of each module in turn.
    pub(super) masses: Vec<Mass>,
}

/// A mass, where it rests and how it moves.
pub(super) struct Mass {
    pub(super) rest: Point,
    /// x(t) = Re(motion · exp(iωt)), px, with y downwards and the largest motion at t = 0.
    motion: [Complex<f64>; 2],
    /// Half of the mass's side, px.
    pub(super) half: f64,
    /// Turned by this, rad, clockwise.
    pub(super) turned: f64,
    /// The phase of its motion along its largest, rad, if it moves: 0 where it is farthest to the
    /// right, as far as it moves the way of the mass that moves most.
    pub(super) phase: Option<f64>,
    pub(super) colour: RGBColor,
}

impl<'a> ModeLayout<'a> {
    #[allow(clippy::cast_precision_loss)]
    fn of(modes: &'a ModeShapes) -> Result<Self, Failure> {
        let count = modes.modes.first().map_or(0, |mode| mode.shape.len() / DOFS);
        if count == 0 {
            return Err(Failure("there is no mode of at least one module".into()));
        }
        let finite = |value: &Complex<f64>| value.re.is_finite() && value.im.is_finite();
        for ModeShape { title, shape } in &modes.modes {
            if shape.len() != DOFS * count || !shape.iter().all(finite) {
                return Err(Failure(format!(
                    "the shape of {title:?} must have {} finite values, four a module",
                    DOFS * count
                )));
            }
        }
        // Rings of many modules need the room.
        let columns = match count {
            ..=5 => 3,
            6..=10 => 2,
            _ => 1,
        };
        let across = (WIDTH - 2.0 * MARGIN) / f64::from(columns);
        let spacing = ((across - 20.0) / count as f64).min(150.0);
        let down = 88.0 + 1.62 * spacing.clamp(55.0, 90.0);
        let cells = modes.modes.iter().enumerate().map(|(place, mode)| {
            let (row, column) = (place / columns as usize, place % columns as usize);
            let corner = [MARGIN + column as f64 * across, HEAD + row as f64 * down];
            PlacedMode::of(mode, modes.angle, corner, across, spacing)
        });
        let rows = modes.modes.len().div_ceil(columns as usize);
        let height = HEAD + rows as f64 * down + NOTE_ROW * NOTES.len() as f64 + 12.0;
        Ok(Self { modes, cells: cells.collect(), height: height.ceil() })
    }

    /// Left end of a line of the notes, at its middle height.
    pub(super) fn note_at(&self, line: u8) -> Point {
        let lines = f64::from(u8::try_from(NOTES.len()).unwrap_or(u8::MAX));
        [MARGIN + 5.0, self.height - 8.0 - NOTE_ROW * (lines - f64::from(line) - 0.5)]
    }

    pub(super) fn title_at(&self) -> Point {
        [MARGIN + 5.0, 0.5 * HEAD]
    }
}

impl<'a> PlacedMode<'a> {
    #[allow(clippy::cast_precision_loss)]
    fn of(mode: &'a ModeShape, angle: f64, corner: Point, across: f64, spacing: f64) -> Self {
        let count = mode.shape.len() / DOFS;
        let height = spacing.clamp(55.0, 90.0);
        let half = (0.2 * spacing).clamp(3.0, 13.0);
        let left = corner[0] + 0.5 * (across - spacing * count as f64);
        let ground = corner[1] + 34.0;
        let (sin, cos) = (libm::sin(angle), libm::cos(angle));
        let mut masses = Vec::with_capacity(2 * count);
        for (module, values) in mode.shape.chunks_exact(DOFS).enumerate() {
            let [x1, x2, x3, x4] = [values[0], values[1], values[2], values[3]];
            let x = left + (module as f64 + 0.5) * spacing;
            let mass = |y, motion, turned, place| Mass {
                rest: [x, y],
                motion,
                half,
                turned,
                phase: None,
                colour: colour(place),
            };
            let upper = ground + 0.62 * height;
            masses.push(mass(upper, [x1, -x2], 0.0, 0));
            let lower = [x3 * cos - x4 * sin, -(x3 * sin + x4 * cos)];
            masses.push(mass(upper + height, lower, -angle, 1));
        }
        set_going(&mut masses, 1.35 * half);
        let title_at = [corner[0] + 5.0, corner[1] + 12.0];
        let right = left + spacing * count as f64;
        Self { title: &mode.title, title_at, left, right, ground, masses }
    }

    /// Springs at a time of the cycle, as lines from point to point, ground and ring included.
    pub(super) fn springs(&self, place: impl Fn(&Mass) -> Point) -> Vec<[Point; 2]> {
        let modules: Vec<&[Mass]> = self.masses.chunks_exact(2).collect();
        let mut lines = Vec::new();
        for pair in &modules {
            let upper = place(&pair[0]);
            lines.push([[pair[0].rest[0], self.ground], upper]);
            lines.push([upper, place(&pair[1])]);
        }
        for next in modules.windows(2) {
            lines.push([place(&next[0][0]), place(&next[1][0])]);
        }
        if let [first, .., last] = modules[..] {
            // The link from the last to the first is cut half-way and leaves on both sides.
            let (first, last) = (place(&first[0]), place(&last[0]));
            let middle = 0.5 * (first[1] + last[1]);
            lines.push([[self.left, middle], first]);
            lines.push([last, [self.right, middle]]);
        }
        lines
    }

    /// The parts that stand still: the ground above each module and the slider below, px.
    pub(super) fn fixed(&self) -> Vec<[Point; 2]> {
        let mut lines = Vec::new();
        for pair in self.masses.chunks_exact(2) {
            let (x, half) = (pair[0].rest[0], pair[0].half);
            lines.push([[x - half, self.ground], [x + half, self.ground]]);
            let along = 2.6 * half;
            let ends = [-along, along].map(|at| pair[1].corner(pair[1].rest, [at, half + 1.0]));
            lines.push(ends);
        }
        lines
    }
}

/// Scales motions so that the largest is `reach` px, begins the cycle at the time of the largest
/// motion of all masses together, and finds their phases.
fn set_going(masses: &mut [Mass], reach: f64) {
    let square = |mass: &Mass| mass.motion.iter().map(|value| value * value).sum::<Complex<f64>>();
    // A motion is Re((p + iq) exp(iψ) exp(iωt)) with p and q at right angles, p the longer, and ψ
    // half the argument of the sum of squares; for all masses together as for one.
    let turn = |square: Complex<f64>| Complex::from_polar(1.0, -0.5 * square.arg());
    let start = turn(masses.iter().map(square).sum());
    let longest = |mass: &Mass| {
        let norm = mass.motion[0].norm_sqr() + mass.motion[1].norm_sqr();
        (0.5 * (norm + square(mass).norm())).sqrt()
    };
    let Some(most) = masses.iter().max_by(|a, b| longest(a).total_cmp(&longest(b))) else {
        return;
    };
    let size = longest(most);
    if size == 0.0 {
        return;
    }
    let axis = |mass: &Mass| mass.motion.map(|value| (value * turn(square(mass))).re);
    let rightwards = |[x, y]: [f64; 2]| if x < 0.0 { [-x, -y] } else { [x, y] };
    let along = rightwards(axis(most));
    for mass in masses {
        mass.motion = mass.motion.map(|value| value * start * (reach / size));
        if longest(mass) > AT_REST * reach {
            let own = axis(mass);
            // All axes are taken in one direction: else two masses that move together might seem to move oppositely.
            let back = own[0] * along[0] + own[1] * along[1] < 0.0;
            let phase = 0.5 * square(mass).arg();
            mass.phase = Some(phase + if back { 2.0 * FRAC_PI_2 } else { 0.0 });
        }
    }
}

impl Mass {
    /// Position of the mass at a phase of the cycle, rad.
    pub(super) fn at(&self, phase: f64) -> Point {
        let turn = Complex::new(libm::cos(phase), libm::sin(phase));
        [0, 1].map(|axis| self.rest[axis] + (self.motion[axis] * turn).re)
    }

    /// A point given from the mass's middle in its own directions.
    fn corner(&self, middle: Point, [x, y]: Point) -> Point {
        let (sin, cos) = (libm::sin(self.turned), libm::cos(self.turned));
        [middle[0] + x * cos - y * sin, middle[1] + x * sin + y * cos]
    }

    /// Outline of the mass, closed.
    pub(super) fn outline(&self, middle: Point) -> [Point; 5] {
        let h = self.half;
        [[-h, -h], [h, -h], [h, h], [-h, h], [-h, -h]].map(|at| self.corner(middle, at))
    }

    /// The end of its hand, from its middle, at a phase: to the right where it is farthest.
    pub(super) fn hand(&self, phase: f64) -> Point {
        [0.8 * self.half * libm::cos(phase), -0.8 * self.half * libm::sin(phase)]
    }
}

impl Drawing for ModeLayout<'_> {
    fn title(&self) -> &str {
        &self.modes.title
    }

    fn description(&self) -> String {
        let modules = self.cells.first().map_or(0, |cell| cell.masses.len() / 2);
        let titles: Vec<&str> = self.modes.modes.iter().map(|mode| &*mode.title).collect();
        format!(
            "The shapes of {} modes of a ring of {modules} modules, each of two masses: {}. {}",
            titles.len(),
            titles.join("; "),
            NOTES.join(" ")
        )
    }

    fn height(&self) -> f64 {
        self.height
    }

    fn paint<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Result<(), Failure> {
        canvas.text(self.title(), self.title_at(), LARGE, Align::Left)?;
        for cell in &self.cells {
            canvas.text(cell.title, cell.title_at, MEDIUM, Align::Left)?;
            for line in cell.springs(|mass| mass.rest) {
                canvas.line(&line, PALE, 1.0, &[])?;
            }
            for mass in &cell.masses {
                canvas.line(&mass.outline(mass.rest), PALE, 1.0, &[])?;
            }
            for line in cell.fixed() {
                canvas.line(&line, GREY, 2.5, &[])?;
            }
            for line in cell.springs(|mass| mass.at(0.0)) {
                canvas.line(&line, GREY, 1.5, &[])?;
            }
            for mass in &cell.masses {
                let middle = mass.at(0.0);
                canvas.fill(&mass.outline(middle), mass.colour)?;
                if let Some(phase) = mass.phase {
                    let [x, y] = mass.hand(phase);
                    let hand = [middle, [middle[0] + x, middle[1] + y]];
                    canvas.line(&hand, WHITE, HAND, &[])?;
                    canvas.dot(middle, HAND, WHITE)?;
                }
            }
        }
        for (line, note) in (0..).zip(NOTES) {
            canvas.text(note, self.note_at(line), SMALL, Align::Left)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mass(motion: [Complex<f64>; 2]) -> Mass {
        let (rest, half, turned, phase) = ([0.0; 2], 1.0, 0.0, None);
        Mass { rest, motion, half, turned, phase, colour: colour(0) }
    }

    #[test]
    fn the_cycle_starts_at_the_largest_motion_and_phases_are_against_it() {
        let i = Complex::new(0.0, 1.0);
        let turn = Complex::from_polar(1.0, 0.7);
        let zero = Complex::new(0.0, 0.0);
        let mut masses =
            [[turn * 4.0, turn * 3.0], [turn * -2.0, zero], [zero, turn * i], [zero; 2]].map(mass);
        set_going(&mut masses, 10.0);
        // Up to the sign: both ends of a motion are the farthest from rest.
        let [x, y] = masses[0].at(0.0);
        let sign = x.signum();
        assert!((x - 8.0 * sign).abs() < 1e-12 && (y - 6.0 * sign).abs() < 1e-12);
        assert!((masses[0].phase.unwrap().cos() - sign).abs() < 1e-12, "to the right at phase 0");
        let turned = |mass: &Mass| {
            let difference = mass.phase.unwrap() - masses[0].phase.unwrap();
            difference.rem_euclid(4.0 * FRAC_PI_2)
        };
        assert!((turned(&masses[1]) - 2.0 * FRAC_PI_2).abs() < 1e-12, "opposite");
        assert!((turned(&masses[2]) - FRAC_PI_2).abs() < 1e-12, "a quarter ahead");
        assert_eq!(masses[3].phase, None);
    }

    #[test]
    fn the_lower_mass_moves_along_the_slider() {
        let zero = Complex::new(0.0, 0.0);
        let shape = vec![zero, zero, Complex::new(1.0, 0.0), zero];
        let mode = ModeShape { title: String::new(), shape };
        let modes = ModeShapes { title: String::new(), angle: 0.5, modes: vec![mode] };
        let layout = ModeLayout::of(&modes).unwrap_or_else(|Failure(reason)| panic!("{reason}"));
        let [upper, lower] = &layout.cells[0].masses[..] else { panic!("two masses") };
        assert_eq!(upper.at(1.0), upper.rest);
        let [x, y] = lower.at(0.0);
        let slope = (y - lower.rest[1]) / (x - lower.rest[0]);
        assert!((slope + 0.5_f64.tan()).abs() < 1e-12, "up to the right: y is downwards");
    }
}
