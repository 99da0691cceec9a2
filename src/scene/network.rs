//! A network: masses in a plane, joined by springs and dampers in any way, as data.

/// Largest number of masses, springs, dampers or contacts of a network.
pub const MAX_PARTS: usize = 1_000_000;

/// Name of the fixed surroundings, in place of a mass.
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
    pub contacts: Vec<ContactDefinition>,
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

/// A spring between two masses, or a mass and the ground (`None`).
///
/// With its direction d, its elongation is e = d·(u_a − u_b) − p for ends a, b and preload p: its
/// second end is moved by p along d, so that at u = 0 it pulls the first with +k p d.
#[derive(Clone, Debug, PartialEq)]
pub struct Spring {
    /// Name of the spring.
    pub name: String,
    /// Masses at the ends of the spring, by index; `None` for the ground.
    pub between: [Option<usize>; 2],
    /// Angle of the spring's direction against the horizontal, rad.
    pub direction: f64,
    /// Stiffness k, N/m.
    pub stiffness: f64,
    /// Preload p, m; `None` if the spring has none.
    pub preload: Option<f64>,
}

/// A damper between two masses, or a mass and the ground (`None`).
#[derive(Clone, Debug, PartialEq)]
pub struct Damper {
    /// Name of the damper.
    pub name: String,
    /// Masses at the ends of the damper, by index; `None` for the ground.
    pub between: [Option<usize>; 2],
    /// Angle of the damper's direction against the horizontal, rad.
    pub direction: f64,
    /// Damping coefficient, N s/m.
    pub damping: f64,
}

/// A frictional contact of a mass with the rigid slider, or with a mass that carries the sliding
/// surface.
///
/// With the tangent t = (cos, sin) and the outward normal n = (−sin, cos) of its angle, the gap is
/// gap + n·(u_mass − u_on) ≥ 0 and the slip velocity v − t·(u̇_mass − u̇_on).
#[derive(Clone, Debug, PartialEq)]
pub struct ContactDefinition {
    /// Name of the contact.
    pub name: String,
    /// Index of the mass that slides.
    pub mass: usize,
    /// Index of the mass that carries the sliding surface; `None` if the velocity of the surface is prescribed.
    pub on: Option<usize>,
    /// Angle of the tangent against the horizontal, rad; `None` for the slider's.
    pub angle: Option<f64>,
    /// Gap in the unloaded position, m, at least 0.
    pub gap: f64,
    /// Velocity v of the sliding surface along the tangent, m/s; `None` for the slider's.
    pub velocity: Option<f64>,
    /// Friction coefficient µ; `None` for the common one.
    pub friction: Option<f64>,
    /// Static friction coefficient µ_s ≥ µ; `None` for the contact's own µ, or else the common µ_s.
    pub static_friction: Option<f64>,
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
