//! The lumped model, independent of time: mass, stiffness, damping, load, contact directions.
//!
//! M ẍ + C ẋ + K x = F + Σ (G_Nᵀ N + G_Tᵀ T) over the contacts (paper, eq. 1), C = α M + β K + D.

mod banded;
mod closing;
mod equilibrium;
mod linear;
mod missing;
mod panels;
mod reduced;
pub mod ring;
mod sparse;

pub use equilibrium::{Equilibrium, Uniqueness};
pub use linear::{LinearModel, SlidingFriction};
pub use reduced::ReducedMatrices;
pub use sparse::{Entry, SparseMatrix};

use crate::contact::{ContactLaw, ContactState, Friction};

/// A structure of masses and springs with frictional contacts, linear but for its contacts.
///
/// ```
/// use amontons::model::LumpedModel;
///
/// let scene = amontons::scene::builtin("set1").expect("a built-in scene").scene();
/// let model = LumpedModel::from(&scene);
/// assert_eq!((model.dofs(), model.contacts.len()), (8, 2));
/// assert_eq!(model.stiffness.get(0, 1), model.stiffness.get(1, 0));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct LumpedModel {
    /// Mass matrix M, symmetric positive definite, kg; n × n.
    pub mass: SparseMatrix,
    /// Stiffness matrix K, N/m; n × n; symmetric but for circulatory forces.
    pub stiffness: SparseMatrix,
    /// Rayleigh coefficients α and β of C = α M + β K + D.
    pub damping: Damping,
    /// Matrix D of discrete dampers, N s/m; n × n, without entries where there are none; symmetric but for gyroscopic forces.
    pub dampers: SparseMatrix,
    /// Constant load F, N; length n.
    pub load: Vec<f64>,
    /// The contacts.
    pub contacts: Vec<Contact>,
    /// The law of contact.
    pub law: ContactLaw,
}

/// Rayleigh damping, C = α M + β K.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Damping {
    /// Mass-proportional part α, 1/s.
    pub alpha: f64,
    /// Stiffness-proportional part β, s.
    pub beta: f64,
}

/// A frictional contact: the two rows that it adds to G (paper, eq. 7), its friction, and the surface that it
/// rubs on.
#[derive(Clone, Debug, PartialEq)]
pub struct Contact {
    /// Normal direction G_N: the gap is `gap` + G_N x, positive where the contact is open.
    pub normal: Direction,
    /// Tangential direction G_T: the tangential displacement is G_T x.
    pub tangent: Direction,
    /// The direction across the sliding and along the surface, if friction across it is asked for in eigenvalues.
    pub transverse: Option<Direction>,
    /// Gap in the position from which the displacements x count, m, at least 0: 0 for a contact that is closed there.
    pub gap: f64,
    /// Parameters of the contact's friction.
    pub friction: Friction,
    /// Velocity v of the sliding surface along the tangent, m/s.
    pub surface_velocity: f64,
}

impl Contact {
    /// A closed contact without friction, on a surface that stands still.
    #[must_use]
    pub fn new(normal: Direction, tangent: Direction) -> Self {
        Self {
            normal,
            tangent,
            transverse: None,
            gap: 0.0,
            friction: Friction::from(0.0),
            surface_velocity: 0.0,
        }
    }

    /// The gap at these displacements, m.
    #[must_use]
    pub fn gap_at(&self, displacement: &[f64]) -> f64 {
        self.gap + self.normal.dot(displacement)
    }

    /// The displacement along a normal of one degree of freedom at which the contact is closed, m: its gap is then an exact
    /// zero.
    pub(crate) fn closed_place(&self) -> f64 {
        0.0 - self.gap
    }

    /// The state in which the contact, closed, can be at rest in the frame of the structure: it slides by the sign of the
    /// velocity of its surface, and sticks where that is zero.
    #[must_use]
    pub fn resting_state(&self) -> ContactState {
        match self.surface_velocity {
            v if v > 0.0 => ContactState::Slide,
            v if v < 0.0 => ContactState::ReverseSlide,
            _ => ContactState::Stick,
        }
    }

    /// The sign of the friction force in uniform sliding: that of v, 0 where the surface stands still.
    #[must_use]
    pub fn sliding_sign(&self) -> f64 {
        if self.surface_velocity == 0.0 { 0.0 } else { self.surface_velocity.signum() }
    }
}

/// A direction in the space of the degrees of freedom, as its non-zero components.
///
/// ```
/// use amontons::model::Direction;
///
/// let direction = Direction(vec![(0, 0.5), (2, 0.25)]);
/// assert_eq!(direction.dot(&[2.0, 7.0, 4.0]), 2.0);
/// assert_eq!(Direction::unit(1).as_unit(), Some(1));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Direction(pub Vec<(usize, f64)>);

impl Direction {
    /// The direction of one degree of freedom.
    #[must_use]
    pub fn unit(dof: usize) -> Self {
        Self(vec![(dof, 1.0)])
    }

    /// The degree of freedom, if this is the direction of just one.
    #[must_use]
    pub fn as_unit(&self) -> Option<usize> {
        match self.0[..] {
            [(dof, 1.0)] => Some(dof),
            _ => None,
        }
    }

    /// The component of `vector` along this direction.
    #[must_use]
    pub fn dot(&self, vector: &[f64]) -> f64 {
        self.0.iter().fold(0.0, |sum, &(dof, value)| sum + value * vector[dof])
    }

    /// Adds `factor` times this direction to `vector`.
    pub fn add_to(&self, vector: &mut [f64], factor: f64) {
        for &(dof, value) in &self.0 {
            vector[dof] += factor * value;
        }
    }
}

impl LumpedModel {
    /// This structure with this friction at every contact.
    #[must_use]
    pub fn with_friction(mut self, friction: impl Into<Friction>) -> Self {
        let friction = friction.into();
        self.contacts.iter_mut().for_each(|contact| contact.friction = friction);
        self
    }

    /// `false` if friction has a fixed direction and the contact's surface stands still: the contact then has no
    /// friction.
    #[must_use]
    pub fn rubs(&self, contact: &Contact) -> bool {
        !self.law.has_fixed_direction() || contact.surface_velocity != 0.0
    }

    /// µ of a contact in uniform sliding: that of the law at the velocity of its surface, and zero where the contact
    /// does not [rub](Self::rubs).
    #[must_use]
    pub fn sliding_friction(&self, contact: &Contact) -> f64 {
        if self.rubs(contact) {
            self.law.friction.at_slip(contact.friction, contact.surface_velocity)
        } else {
            0.0
        }
    }

    /// T/N of each contact in uniform sliding: µ with the sign of the surface's velocity, 0 where the surface stands
    /// still.
    pub fn sliding_ratios(&self) -> impl Iterator<Item = f64> {
        self.contacts.iter().map(|contact| contact.sliding_sign() * self.sliding_friction(contact))
    }

    /// Lets displacements count from an equilibrium of this model: contacts then have its gaps.
    pub fn count_from(&mut self, equilibrium: &Equilibrium) {
        for (contact, gap) in self.contacts.iter_mut().zip(&equilibrium.gap) {
            contact.gap = *gap;
        }
    }

    /// Number of degrees of freedom, n.
    #[must_use]
    pub fn dofs(&self) -> usize {
        self.load.len()
    }
}
