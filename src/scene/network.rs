//! A network: masses in a plane and superelements, joined by springs and dampers in any way, as data.

use super::Superelement;

/// Largest number of masses, springs, dampers or contacts of a network.
pub const MAX_PARTS: usize = 1_000_000;

/// Name of the fixed surroundings, in place of a mass.
pub const GROUND: &str = "ground";

/// Masses, superelements, springs, dampers and contacts, each with a name.
///
/// Degrees of freedom: those of the masses, then those of the superelements, each in the order of its rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Network {
    /// The masses.
    pub masses: Vec<Mass>,
    /// The superelements.
    pub superelements: Vec<Superelement>,
    /// The springs.
    pub springs: Vec<Spring>,
    /// The dampers.
    pub dampers: Vec<Damper>,
    /// The contacts.
    pub contacts: Vec<ContactDefinition>,
    /// Names of the sets of contacts.
    pub contact_sets: Vec<String>,
    /// Coordinates of superelements that the FMU shows and, for nodes, pushes.
    pub shown: Coordinates,
    /// Coordinates of superelements with initial values of their own.
    pub started: Coordinates,
}

/// A point of the structure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Point {
    /// A mass, by its place in [`Network::masses`].
    Mass(usize),
    /// A node of a superelement.
    Node(NodeAt),
}

/// A node of a superelement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct NodeAt {
    /// Place of the superelement in [`Network::superelements`].
    pub superelement: usize,
    /// Number of the node.
    pub node: u64,
}

/// A modal coordinate of a superelement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ModeAt {
    /// Place of the superelement in [`Network::superelements`].
    pub superelement: usize,
    /// Place among the modal coordinates of the superelement, from 0.
    pub mode: usize,
}

/// Chosen coordinates of superelements.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Coordinates {
    /// Nodes, with all of their degrees of freedom.
    pub nodes: Vec<NodeAt>,
    /// Modal coordinates.
    pub modes: Vec<ModeAt>,
}

/// A direction of space: x to the right, y up, z towards the viewer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Line {
    /// Angle in the plane against the horizontal, counterclockwise, rad.
    Angle(f64),
    /// Components of any length but zero.
    Vector([f64; 3]),
}

impl Line {
    /// The unit vector of the direction.
    #[must_use]
    pub fn vector(self) -> [f64; 3] {
        match self {
            Self::Angle(angle) => {
                let [cos, sin] = direction(angle);
                [cos, sin, 0.0]
            }
            Self::Vector(vector) => unit(vector),
        }
    }

    /// The angle, rad; `None` for a direction given by components.
    #[must_use]
    pub fn angle(self) -> Option<f64> {
        match self {
            Self::Angle(angle) => Some(angle),
            Self::Vector(_) => None,
        }
    }

    /// The angle of the direction as it appears in the plane, rad.
    #[must_use]
    pub fn angle_in_plane(self) -> f64 {
        match self {
            Self::Angle(angle) => angle,
            Self::Vector([x, y, _]) => libm::atan2(y, x),
        }
    }
}

/// A vector divided by its length.
pub(super) fn unit(vector: [f64; 3]) -> [f64; 3] {
    let largest = vector.iter().fold(0.0_f64, |most, part| most.max(part.abs()));
    let scaled = vector.map(|part| part / largest);
    let length = dot(scaled, scaled).sqrt();
    scaled.map(|part| part / length)
}

/// The scalar product of two vectors.
pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// A mass that moves in the plane, along axes x and y of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Mass {
    /// Name of the mass.
    pub name: String,
    /// Mass, kg.
    pub mass: f64,
    /// Counterclockwise rotation of the mass's axes against those of space (right and up), rad.
    pub angle: f64,
    /// `true` for each axis along which the mass cannot move.
    pub locked: [bool; 2],
    /// Constant loads along the mass's axes, N; part of the load of the equilibrium.
    pub load: [f64; 2],
    /// External forces along the mass's axes, N; not part of the equilibrium.
    pub force: [f64; 2],
    /// Initial displacements along the mass's axes from the equilibrium, m.
    pub displacement: [f64; 2],
    /// Initial velocities along the mass's axes, m/s.
    pub velocity: [f64; 2],
}

/// A spring between two points, or a point and the ground (`None`).
///
/// With its direction d, its elongation is e = d·(u_a − u_b) − p for ends a, b and preload p: its
/// second end is moved by p along d, so that at u = 0 it pulls the first with +k p d.
#[derive(Clone, Debug, PartialEq)]
pub struct Spring {
    /// Name of the spring.
    pub name: String,
    /// Points at the ends of the spring; `None` for the ground.
    pub between: [Option<Point>; 2],
    /// The spring's direction.
    pub direction: Line,
    /// Stiffness k, N/m.
    pub stiffness: f64,
    /// Preload p, m; `None` if the spring has none.
    pub preload: Option<f64>,
}

/// A damper between two points, or a point and the ground (`None`).
#[derive(Clone, Debug, PartialEq)]
pub struct Damper {
    /// Name of the damper.
    pub name: String,
    /// Points at the ends of the damper; `None` for the ground.
    pub between: [Option<Point>; 2],
    /// The damper's direction.
    pub direction: Line,
    /// Damping coefficient, N s/m.
    pub damping: f64,
}

/// A frictional contact of a point with the rigid slider, or with a point that carries the sliding
/// surface.
///
/// With the tangent t and the outward normal n, (cos, sin) and (−sin, cos) of its angle unless given, the gap is
/// gap + n·(u_mass − u_on) ≥ 0 and the slip velocity v − t·(u̇_mass − u̇_on).
#[derive(Clone, Debug, PartialEq)]
pub struct ContactDefinition {
    /// Name of the contact.
    pub name: String,
    /// The set of contacts that it belongs to, by its place in [`Network::contact_sets`].
    pub set: Option<usize>,
    /// The point that slides.
    pub mass: Point,
    /// The point that carries the sliding surface; `None` if the velocity of the surface is prescribed.
    pub on: Option<Point>,
    /// Angle of the tangent against the horizontal, rad; `None` for the slider's.
    pub angle: Option<f64>,
    /// Outward normal and tangent, of any length but zero, in place of an angle.
    pub axes: Option<[[f64; 3]; 2]>,
    /// Gap in the unloaded position, m, at least 0.
    pub gap: f64,
    /// Velocity v of the sliding surface along the tangent, m/s; `None` for the slider's.
    pub velocity: Option<f64>,
    /// Friction coefficient µ; `None` for the common one.
    pub friction: Option<f64>,
    /// Static friction coefficient µ_s ≥ µ; `None` for the contact's own µ, or else the common µ_s.
    pub static_friction: Option<f64>,
    /// `true` if the FMU has variables of the contact.
    pub is_shown: bool,
}

impl Network {
    /// The row of a node's degree of freedom in its superelement (1, 2, 3: displacements, 4, 5, 6: rotations); `None`
    /// if there is none.
    #[must_use]
    pub fn node_row(&self, NodeAt { superelement, node }: NodeAt, direction: u8) -> Option<usize> {
        self.superelements.get(superelement)?.matrices.row(node, direction)
    }

    /// The row of a modal coordinate in its superelement; `None` if there is none.
    #[must_use]
    pub fn mode_row(&self, ModeAt { superelement, mode }: ModeAt) -> Option<usize> {
        let freedoms = self.superelements.get(superelement)?.matrices.freedoms();
        let modes = freedoms.iter().enumerate().filter(|(_, one)| one.direction == 0);
        modes.map(|(row, _)| row).nth(mode)
    }

    /// The name of a point, as a scene file has it: `pad`, `pad.17`.
    #[must_use]
    pub fn point_name(&self, point: Point) -> String {
        match point {
            Point::Mass(mass) => {
                self.masses.get(mass).map_or_else(String::new, |mass| mass.name.clone())
            }
            Point::Node(NodeAt { superelement, node }) => {
                let name = self.superelements.get(superelement).map_or("", |one| &*one.name);
                format!("{name}.{node}")
            }
        }
    }
}

impl Point {
    /// The place of the mass; `None` for a node.
    #[must_use]
    pub fn mass(self) -> Option<usize> {
        match self {
            Self::Mass(mass) => Some(mass),
            Self::Node(_) => None,
        }
    }
}

impl ContactDefinition {
    /// Outward normal and tangent as unit vectors; `slider` is the slider's angle, rad.
    #[must_use]
    pub fn directions(&self, slider: f64) -> [[f64; 3]; 2] {
        match self.axes {
            Some(axes) => axes.map(unit),
            None => {
                let [cos, sin] = direction(self.angle.unwrap_or(slider));
                [[-sin, cos, 0.0], [cos, sin, 0.0]]
            }
        }
    }
}

impl Mass {
    /// Returns those of two values along the mass's axes whose axes are not locked.
    pub(crate) fn free<T>(&self, values: [T; 2]) -> impl Iterator<Item = T> + use<T> {
        values.into_iter().zip(self.locked).filter_map(|(value, locked)| (!locked).then_some(value))
    }
}

/// Returns (cos, sin) of an angle, rad, with the same bits on every machine. Results are exact for quarter turns,
/// although no double is a quarter turn: a component smaller than 1e-15 becomes zero, and the other ±1.
#[must_use]
pub fn direction(angle: f64) -> [f64; 2] {
    let (cos, sin) = (libm::cos(angle), libm::sin(angle));
    if cos.abs() < 1e-15 {
        [0.0, sin.signum()]
    } else if sin.abs() < 1e-15 {
        [cos.signum(), 0.0]
    } else {
        [cos, sin]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    #[test]
    fn quarter_turns_are_exact_and_other_angles_are_what_they_are() {
        assert_eq!(direction(0.0), [1.0, 0.0]);
        assert_eq!(direction(FRAC_PI_2), [0.0, 1.0]);
        assert_eq!(direction(-FRAC_PI_2), [0.0, -1.0]);
        assert_eq!(direction(PI), [-1.0, 0.0]);
        assert_eq!(direction(1e-3), [libm::cos(1e-3), libm::sin(1e-3)]);
    }
}
