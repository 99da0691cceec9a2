//! Modes on meshes, side by side: the surface as it is deformed, seen from a fixed direction, in colours of the amplitude.

use super::axes::{LARGE, LEFT, MEDIUM, SMALL};
use super::canvas::{self, Align, Canvas, Drawing, Failure, Point, WIDTH};
use super::colours::{COLOURS, scale};
use super::palette::INK;
use amontons::Error;
use plotters::backend::DrawingBackend;
use plotters::style::RGBColor;
use std::path::Path;

const MARGIN: f64 = 16.0;
const TITLE: f64 = 42.0;
/// Height of the title of a mode, px.
const NAME: f64 = 26.0;
/// Height of the scale of colours with its numbers, px.
const SCALE: f64 = 56.0;
/// The largest motion is drawn as long as this part of the extent of the mesh.
const DEFORMED: f64 = 0.07;
/// Each face is drawn as at least this many by this many flat patches, and as more where there are few faces or few modes.
const FEWEST: usize = 4;
const MOST: usize = 12;
/// The number of patches of a mesh of few faces.
const PATCHES: usize = 8000;
/// Modes in a row.
const ACROSS: usize = 3;
/// Direction to the eye: in the picture x goes to the lower right, y to the upper right and z up.
const EYE: [f64; 3] = [0.5, -0.62, 0.605];
/// Direction to the light.
const LIGHT: [f64; 3] = [0.1, -0.45, 0.89];

/// Modes on a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshShapes {
    /// Title of the picture.
    pub title: String,
    /// The places of the nodes: x, y and z.
    pub points: Vec<[f64; 3]>,
    /// The faces that can be seen: three or four corners each, as positions in `points`, against the clock as seen from outside.
    pub faces: Vec<Vec<usize>>,
    /// The modes in rows, from the left.
    pub modes: Vec<MeshShape>,
}

/// One mode on a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshShape {
    /// Name of the mode, with its frequency.
    pub title: String,
    /// The displacement of each node along x, y and z at one time of the cycle, in any unit.
    pub real: Vec<[f64; 3]>,
    /// The displacement a quarter of a cycle earlier; all zero where the nodes move in phase.
    pub imaginary: Vec<[f64; 3]>,
}

impl MeshShape {
    /// The displacement of each node when the motion as a whole is largest.
    fn largest(&self) -> Vec<[f64; 3]> {
        let pairs = || self.real.iter().flatten().zip(self.imaginary.iter().flatten());
        // Σ (a cos φ − b sin φ)² is largest where tan 2φ = −2 Σ ab / Σ (a² − b²).
        let even: f64 = pairs().map(|(a, b)| a * a - b * b).sum();
        let odd: f64 = pairs().map(|(a, b)| -2.0 * a * b).sum();
        let phase = 0.5 * libm::atan2(odd, even);
        let (sin, cos) = (libm::sin(phase), libm::cos(phase));
        let turned = |(a, b): (&[f64; 3], &[f64; 3])| [0, 1, 2].map(|i| a[i] * cos - b[i] * sin);
        self.real.iter().zip(&self.imaginary).map(turned).collect()
    }

    /// The amplitude of each node: the root of the sum of the squared amplitudes along x, y and z.
    fn amplitudes(&self) -> Vec<f64> {
        let sum = |values: &[f64; 3]| values.iter().map(|value| value * value).sum::<f64>();
        self.real.iter().zip(&self.imaginary).map(|(a, b)| (sum(a) + sum(b)).sqrt()).collect()
    }
}

impl MeshShapes {
    /// Writes the picture as the path's ending asks, `.svg` or `.png`.
    ///
    /// # Errors
    /// Another ending, no modes, no faces, faces or shapes that do not fit the points, numbers that are not finite, or a file
    /// that cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        let layout = Layout::of(self).map_err(|failure| canvas::cannot_draw(path, &failure))?;
        canvas::write(&layout, path)
    }

    fn check(&self) -> Result<(), Failure> {
        let fail = |message: String| Err(Failure(message));
        let count = self.points.len();
        if self.modes.is_empty() || self.faces.is_empty() {
            return fail("there is no mode, or the mesh has no face".into());
        }
        let fits = |face: &Vec<usize>| {
            matches!(face.len(), 3 | 4) && face.iter().all(|&corner| corner < count)
        };
        if let Some(face) = self.faces.iter().find(|face| !fits(face)) {
            return fail(format!(
                "a face has the corners {face:?}; three or four of {count} points can be drawn"
            ));
        }
        let finite = |values: &[[f64; 3]]| values.iter().flatten().all(|value| value.is_finite());
        if !finite(&self.points) {
            return fail("a place of a node is not finite".into());
        }
        for MeshShape { title, real, imaginary } in &self.modes {
            if [real.len(), imaginary.len()] != [count; 2] || !finite(real) || !finite(imaginary) {
                return fail(format!(
                    "the mode {title:?} needs a finite displacement of each of {count} nodes"
                ));
            }
        }
        Ok(())
    }
}

/// Modes with places for everything, px.
struct Layout<'a> {
    shapes: &'a MeshShapes,
    /// Columns of modes.
    columns: usize,
    /// Width and height of the place of a mode, without its title.
    cell: [f64; 2],
    /// px in a unit of length.
    zoom: f64,
    /// The middle of the mesh in the plane of the picture.
    middle: [f64; 2],
    /// The length of the largest motion, in units of length.
    reach: f64,
}

impl<'a> Layout<'a> {
    #[allow(clippy::cast_precision_loss)]
    fn of(shapes: &'a MeshShapes) -> Result<Self, Failure> {
        shapes.check()?;
        let columns = shapes.modes.len().min(ACROSS);
        let across = (WIDTH - 2.0 * MARGIN) / columns as f64;
        let used = || shapes.faces.iter().flatten().map(|&corner| shapes.points[corner]);
        let range = |value: &dyn Fn([f64; 3]) -> f64| {
            used().map(value).fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| {
                [low.min(at), high.max(at)]
            })
        };
        let extent =
            [0, 1, 2].map(|axis| range(&|place| place[axis])).map(|[low, high]| high - low);
        let reach = DEFORMED * extent.iter().map(|length| length * length).sum::<f64>().sqrt();
        let plane = [0, 1].map(|axis| range(&|place| View::project(place)[axis]));
        let size = plane.map(|[low, high]| high - low + 2.0 * reach);
        if size.iter().any(|&length| length <= 0.0) {
            return Err(Failure("all nodes of the mesh are in one place".into()));
        }
        let zoom = ((across - MARGIN) / size[0]).min(1.0 * across / size[1]);
        Ok(Self {
            shapes,
            columns,
            cell: [across, zoom * size[1]],
            zoom,
            middle: plane.map(|[low, high]| 0.5 * (low + high)),
            reach,
        })
    }

    /// The patches of a mode, the farthest first.
    fn patches(&self, mode: &MeshShape, corner: Point) -> Vec<Patch> {
        let displacement = mode.largest();
        let amplitudes = mode.amplitudes();
        let greatest = amplitudes.iter().copied().fold(0.0, f64::max);
        let unit = |length: f64| if length > 0.0 { 1.0 / length } else { 0.0 };
        let long = displacement.iter().map(|value| dot(*value, *value).sqrt()).fold(0.0, f64::max);
        let scale = self.reach * unit(long);
        let place = |node: usize| {
            let (rest, moved) = (self.shapes.points[node], displacement[node]);
            [0, 1, 2].map(|axis| rest[axis] + scale * moved[axis])
        };
        let centre = [corner[0] + 0.5 * self.cell[0], corner[1] + NAME + 0.5 * self.cell[1]];
        let on_paper = |place: [f64; 3]| {
            let [right, up] = View::project(place);
            [
                centre[0] + self.zoom * (right - self.middle[0]),
                centre[1] - self.zoom * (up - self.middle[1]),
            ]
        };
        let fine = (PATCHES / self.shapes.faces.len()).isqrt().max(FEWEST);
        // Fewer modes are drawn larger, with patches of one size on the paper.
        let fine = (fine * ACROSS / self.columns).min(MOST);
        let mut patches = Vec::new();
        for face in &self.shapes.faces {
            let corners: Vec<[f64; 3]> = face.iter().map(|&node| place(node)).collect();
            let parts: Vec<f64> =
                face.iter().map(|&node| amplitudes[node] * unit(greatest)).collect();
            let last = corners.len() - 1;
            let normal = cross(minus(corners[1], corners[0]), minus(corners[last], corners[0]));
            let light = dot(normal, LIGHT).abs() * unit(dot(normal, normal).sqrt());
            split(fine, &corners, &parts, |corners, part, edges| {
                let depth =
                    corners.iter().map(|&at| dot(at, EYE)).sum::<f64>() / corners.len() as f64;
                patches.push(Patch {
                    depth,
                    corners: corners.iter().map(|&at| on_paper(at)).collect(),
                    part,
                    light: 0.62 + 0.38 * light,
                    edges: edges.to_vec(),
                });
            });
        }
        patches.sort_by(|a, b| a.depth.total_cmp(&b.depth));
        patches
    }
}

/// A flat piece of a face.
struct Patch {
    /// How near to the eye.
    depth: f64,
    corners: Vec<Point>,
    /// The amplitude, as a part of the largest.
    part: f64,
    /// The share of light that it gives back.
    light: f64,
    /// For the side after each corner, `true` if it is a side of the face.
    edges: Vec<bool>,
}

/// The view from the eye.
struct View;

impl View {
    /// A place in the plane of the picture: to the right and up.
    fn project(place: [f64; 3]) -> [f64; 2] {
        let flat = (EYE[0] * EYE[0] + EYE[1] * EYE[1]).sqrt();
        let right = [-EYE[1] / flat, EYE[0] / flat, 0.0];
        [dot(place, right), dot(place, cross(EYE, right))]
    }
}

/// Cuts a face into `n` by `n` patches, and hands each with its mean amplitude and which of its sides are sides of the face.
#[allow(clippy::cast_precision_loss)]
fn split(
    n: usize,
    corners: &[[f64; 3]],
    parts: &[f64],
    mut take: impl FnMut(&[[f64; 3]], f64, &[bool]),
) {
    // A triangle is a quadrilateral whose last two corners are one: only its lines towards that corner meet.
    let at = |corner: usize| corner.min(corners.len() - 1);
    let blend = |i: usize, j: usize| {
        let (u, v) = (i as f64 / n as f64, j as f64 / n as f64);
        [(1.0 - u) * (1.0 - v), u * (1.0 - v), u * v, (1.0 - u) * v]
    };
    let place = |i: usize, j: usize| {
        let weights = blend(i, j);
        [0, 1, 2].map(|axis| (0..4).map(|corner| weights[corner] * corners[at(corner)][axis]).sum())
    };
    let part = |i: usize, j: usize| {
        let weights = blend(i, j);
        (0..4).map(|corner| weights[corner] * parts[at(corner)]).sum::<f64>()
    };
    for i in 0..n {
        for j in 0..n {
            let ring = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
            let corners = ring.map(|(i, j)| place(i, j));
            let mean = 0.25 * ring.iter().map(|&(i, j)| part(i, j)).sum::<f64>();
            take(&corners, mean, &[j == 0, i + 1 == n, j + 1 == n, i == 0]);
        }
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|axis| a[axis] - b[axis])
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn shaded(RGBColor(red, green, blue): RGBColor, light: f64) -> RGBColor {
    let byte = |byte: u8| (f64::from(byte) * light).round().clamp(0.0, 255.0) as u8;
    RGBColor(byte(red), byte(green), byte(blue))
}

impl Drawing for Layout<'_> {
    fn title(&self) -> &str {
        &self.shapes.title
    }

    fn description(&self) -> String {
        let names: Vec<&str> = self.shapes.modes.iter().map(|mode| mode.title.as_str()).collect();
        format!("The deformed mesh, coloured by amplitude, for {}.", names.join("; "))
    }

    #[allow(clippy::cast_precision_loss)]
    fn height(&self) -> f64 {
        let rows = self.shapes.modes.len().div_ceil(self.columns);
        (TITLE + rows as f64 * (NAME + self.cell[1]) + SCALE).ceil()
    }

    #[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    fn paint<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Result<(), Failure> {
        canvas.text(&self.shapes.title, [MARGIN, 0.5 * TITLE], LARGE, Align::Left)?;
        let colours = scale();
        let colour =
            |part: f64| colours[(part.clamp(0.0, 1.0) * (COLOURS - 1) as f64).round() as usize];
        for (place, mode) in self.shapes.modes.iter().enumerate() {
            let corner = [
                MARGIN + (place % self.columns) as f64 * self.cell[0],
                TITLE + (place / self.columns) as f64 * (NAME + self.cell[1]),
            ];
            let middle = [corner[0] + 0.5 * self.cell[0], corner[1] + 0.5 * NAME];
            canvas.text(&mode.title, middle, MEDIUM, Align::Centre)?;
            for patch in self.patches(mode, corner) {
                canvas.fill(&patch.corners, shaded(colour(patch.part), patch.light))?;
                let line = shaded(colour(patch.part), 0.55 * patch.light);
                for (side, _) in patch.edges.iter().enumerate().filter(|(_, is_edge)| **is_edge) {
                    let end = (side + 1) % patch.corners.len();
                    canvas.line(&[patch.corners[side], patch.corners[end]], line, 0.6, &[])?;
                }
            }
        }
        let top = self.height() - SCALE + 10.0;
        let (left, width) = (LEFT, 240.0);
        for (place, &colour) in colours.iter().enumerate() {
            let edge = |place: usize| left + width * place as f64 / COLOURS as f64;
            canvas.rectangle([edge(place), top, edge(place + 1) + 0.5, top + 14.0], colour)?;
        }
        for (at, text) in [(0.0, "0"), (0.5, "0.5"), (1.0, "1")] {
            let x = left + at * width;
            canvas.line(&[[x, top + 14.0], [x, top + 18.0]], INK, 1.0, &[])?;
            canvas.text(text, [x, top + 28.0], SMALL, Align::Centre)?;
        }
        let beside = [left + width + 20.0, top + 7.0];
        canvas.text(
            "amplitude, as a part of the largest of the mode; motion enlarged",
            beside,
            SMALL,
            Align::Left,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mode_is_shown_when_its_motion_is_largest() {
        // A motion along x whose largest is at −30°: cos(ωt − 30°) = Re((cos 30° − i sin 30°) exp(iωt)).
        let (a, b) = (0.75_f64.sqrt(), -0.5);
        let mode = MeshShape {
            title: String::new(),
            real: vec![[a, 0.0, 0.0]],
            imaginary: vec![[b, 0.0, 0.0]],
        };
        assert!((mode.largest()[0][0].abs() - 1.0).abs() < 1e-15);
        assert!((mode.amplitudes()[0] - 1.0).abs() < 1e-15);
    }

    #[test]
    fn up_is_up_and_what_is_nearer_to_the_eye_is_painted_last() {
        assert!(View::project([0.0, 0.0, 1.0])[1] > 0.7);
        assert!(View::project([0.0, 0.0, 1.0])[0].abs() < 1e-15);
        assert!((dot(EYE, EYE) - 1.0).abs() < 1e-3);
        let face = |z: f64| [[0.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, z], [0.0, 1.0, z]];
        let points: Vec<[f64; 3]> = [face(1.0), face(0.0)].concat();
        let rest = vec![[0.0; 3]; 8];
        let shapes = MeshShapes {
            title: String::new(),
            points,
            faces: vec![vec![0, 1, 2, 3], vec![4, 5, 6, 7]],
            modes: vec![MeshShape { title: String::new(), real: rest.clone(), imaginary: rest }],
        };
        let layout = Layout::of(&shapes).unwrap();
        let patches = layout.patches(&shapes.modes[0], [0.0, 0.0]);
        assert_eq!(patches.len(), 2 * MOST * MOST);
        // The upper face hides the part of the lower one behind it.
        assert!(patches.is_sorted_by(|a, b| a.depth <= b.depth));
        assert!(patches.last().unwrap().corners[0][1] < patches[0].corners[0][1] + layout.cell[1]);
    }

    #[test]
    fn data_that_do_not_fit_are_refused() {
        let mode =
            MeshShape { title: "A".into(), real: vec![[0.0; 3]; 3], imaginary: vec![[0.0; 3]; 3] };
        let whole = MeshShapes {
            title: String::new(),
            points: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            faces: vec![vec![0, 1, 2]],
            modes: vec![mode],
        };
        assert!(Layout::of(&whole).is_ok());
        let mut far = whole.clone();
        far.faces[0][2] = 3;
        let mut short = whole.clone();
        short.modes[0].real.pop();
        let mut infinite = whole.clone();
        infinite.modes[0].imaginary[1][2] = f64::INFINITY;
        let mut one = whole.clone();
        one.points = vec![[0.0; 3]; 3];
        let none = MeshShapes { modes: Vec::new(), ..whole };
        for (shapes, words) in [
            (far, "corners [0, 1, 3]"),
            (short, "\"A\" needs a finite displacement of each of 3 nodes"),
            (infinite, "finite displacement"),
            (one, "in one place"),
            (none, "no mode"),
        ] {
            let Failure(message) = Layout::of(&shapes).err().unwrap();
            assert!(message.contains(words), "{message}");
        }
    }
}
