//! A network: masses in a plane, joined by springs and dampers in any way, as data.

/// The most masses, springs, dampers or contacts a network may have.
pub const MAX_PARTS: usize = 1_000_000;

/// What stands for the fixed surroundings where a mass could be named.
pub const GROUND: &str = "ground";

/// Masses, springs, dampers and contacts, each with a name.
///
/// Parts refer to masses by their place in `masses`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Network {
    /// The masses.
    pub masses: Vec<Mass>,
    /// The springs.
    pub springs: Vec<Spring>,
    /// The dampers.
    pub dampers: Vec<Damper>,
    /// The contacts.
    pub contacts: Vec<RubbingPlace>,
}

/// A mass that moves in the plane, along axes x and y of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Mass {
    /// Its name.
    pub name: String,
    /// kg.
    pub mass: f64,
    /// How far its axes are turned counterclockwise against those of space (right and up), rad.
    pub angle: f64,
    /// Which of its axes it cannot move along.
    pub locked: [bool; 2],
    /// Constant load along its axes, N; part of the load of the equilibrium.
    pub load: [f64; 2],
    /// External forces along its axes, N; no part of the equilibrium.
    pub force: [f64; 2],
    /// Initial displacements along its axes from the equilibrium, m.
    pub displacement: [f64; 2],
    /// Initial velocities along its axes, m/s.
    pub velocity: [f64; 2],
}

/// A spring between two masses, or a mass and the ground (`None`).
///
/// With its direction d, its elongation is e = d·(u_a − u_b) − p for ends a, b and preload p: its
/// second end is moved by p along d, so that at u = 0 it pulls the first with +k p d.
#[derive(Clone, Debug, PartialEq)]
pub struct Spring {
    /// Its name.
    pub name: String,
    /// Its ends.
    pub between: [Option<usize>; 2],
    /// The angle of its direction against the horizontal, rad.
    pub direction: f64,
    /// k, N/m.
    pub stiffness: f64,
    /// p, m, if it has one.
    pub preload: Option<f64>,
}

/// A damper between two masses, or a mass and the ground (`None`).
#[derive(Clone, Debug, PartialEq)]
pub struct Damper {
    /// Its name.
    pub name: String,
    /// Its ends.
    pub between: [Option<usize>; 2],
    /// The angle of its direction against the horizontal, rad.
    pub direction: f64,
    /// N s/m.
    pub damping: f64,
}

/// A frictional contact of a mass with the rigid slider, or with a mass that carries the sliding
/// surface.
///
/// With the tangent t = (cos, sin) and the outward normal n = (−sin, cos) of its angle, the gap is
/// n·(u_mass − u_on) ≥ 0 and the slip velocity v − t·(u̇_mass − u̇_on).
#[derive(Clone, Debug, PartialEq)]
pub struct RubbingPlace {
    /// Its name.
    pub name: String,
    /// The mass that rubs.
    pub mass: usize,
    /// The mass that carries the sliding surface; `None`: the surface moves as it is told.
    pub on: Option<usize>,
    /// Angle of the tangent against the horizontal, rad, if not the slider's.
    pub angle: Option<f64>,
    /// Velocity v of the sliding surface along the tangent, m/s, if not the slider's.
    pub velocity: Option<f64>,
    /// Friction coefficient µ, if not the common one.
    pub friction: Option<f64>,
    /// Static friction coefficient µ_s ≥ µ, if not the contact's own µ, or else the common one.
    pub static_friction: Option<f64>,
}

impl Mass {
    /// Of two values along its axes, those along which it can move.
    pub(crate) fn free<T>(&self, values: [T; 2]) -> impl Iterator<Item = T> + use<T> {
        values.into_iter().zip(self.locked).filter_map(|(value, locked)| (!locked).then_some(value))
    }
}

/// (cos, sin) of an angle, rad; the same on every machine, and exact for quarter turns, which no
/// double is: what is smaller than 1e-15 becomes zero, and the other ±1.
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
