//! The lumped model: mass, stiffness, damping, load, contact directions. No time here.
//!
//! M ẍ + C ẋ + K x = F + Σ (G_Nᵀ N + G_Tᵀ T) over the contacts (paper, eq. 1), C = α M + β K + D.

mod assembly;
mod banded;
mod equilibrium;
pub mod network;
mod reduced;
pub mod ring;
mod sparse;

pub use equilibrium::{Equilibrium, equilibrium};
pub use network::Numbering;
pub use reduced::ReducedMatrices;
pub use sparse::{Entry, SparseMatrix};

use crate::contact::{ContactLaw, Friction};
pub use crate::scene::Damping;
use crate::scene::{RubbingPlace, Scene, Structure};

/// A structure of masses and springs with frictional contacts, linear but for its contacts.
#[derive(Clone, Debug, PartialEq)]
pub struct LumpedModel {
    /// M, symmetric positive definite, kg; n × n.
    pub mass: SparseMatrix,
    /// K, symmetric, N/m; n × n.
    pub stiffness: SparseMatrix,
    /// α and β of C = α M + β K + D.
    pub damping: Damping,
    /// D, of single dampers, symmetric, N s/m; n × n, without entries where there are none.
    pub dampers: SparseMatrix,
    /// F, the constant load, N; length n.
    pub load: Vec<f64>,
    /// The contacts.
    pub contacts: Vec<Contact>,
    /// The law that they obey.
    pub law: ContactLaw,
}

/// A frictional contact: the two rows that it adds to G (paper, eq. 7).
#[derive(Clone, Debug, PartialEq)]
pub struct Contact {
    /// G_N: the gap is G_N x, positive where the contact is open.
    pub normal: Direction,
    /// G_T: the tangential displacement is G_T x.
    pub tangent: Direction,
    /// What it does not share with the other contacts.
    pub own: OwnValues,
    /// Its friction in uniform sliding, where µ depends on the slip velocity.
    pub steady: Option<Steady>,
}

/// Friction in uniform sliding where µ depends on the slip velocity v_r.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steady {
    /// µ(v).
    pub friction: f64,
    /// dµ/d|v_r| at v, s/m.
    pub slope: f64,
    /// N of the equilibrium, N; zero until that is known ([`LumpedModel::linearise`]).
    pub normal_force: f64,
}

/// Values that a contact has for itself; `None` where it has the common one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OwnValues {
    /// µ, of a contact that slips.
    pub friction_coefficient: Option<f64>,
    /// µ_s, of one that does not.
    pub static_friction: Option<f64>,
    /// v, the velocity of the sliding surface along the tangent, m/s.
    pub slider_velocity: Option<f64>,
}

impl From<&RubbingPlace> for OwnValues {
    fn from(place: &RubbingPlace) -> Self {
        Self {
            friction_coefficient: place.friction,
            static_friction: place.static_friction,
            slider_velocity: place.velocity,
        }
    }
}

impl Contact {
    /// A contact with these directions and nothing of its own.
    #[must_use]
    pub fn new(normal: Direction, tangent: Direction) -> Self {
        Self { normal, tangent, own: OwnValues::default(), steady: None }
    }

    /// µ of this contact in uniform sliding, where the others have `common`.
    #[must_use]
    pub fn friction(&self, common: f64) -> f64 {
        let own = || self.own.friction_coefficient.unwrap_or(common);
        self.steady.map_or_else(own, |steady| steady.friction)
    }

    /// What friction adds to damping along the tangent of a contact that slides, N s/m: N dµ/d|v_r|, below
    /// zero where friction falls with the slip velocity. None without [`LumpedModel::linearise`].
    #[must_use]
    pub fn weakening(&self) -> f64 {
        self.steady.map_or(0.0, |steady| steady.normal_force * steady.slope)
    }

    /// Both coefficients of this contact, where the others have `common`. The common static one belongs
    /// to the common kinetic one: a contact with a µ of its own has that for both unless it has its own
    /// µ_s as well.
    #[must_use]
    pub fn coefficients(&self, common: Friction) -> Friction {
        let own = &self.own;
        Friction {
            kinetic: self.own.friction_coefficient.unwrap_or(common.kinetic),
            static_: own.static_friction.or(own.friction_coefficient).unwrap_or(common.static_),
            stribeck_velocity: common.stribeck_velocity,
        }
    }

    /// v at this contact, m/s, where the others have `common`.
    #[must_use]
    pub fn velocity(&self, common: f64) -> f64 {
        self.own.slider_velocity.unwrap_or(common)
    }

    /// µ in uniform sliding with the sign of the friction force: the sign of v, none where the
    /// surface stands still.
    #[must_use]
    pub fn sliding_slope(&self, common_friction: f64, common_velocity: f64) -> f64 {
        self.sliding_sign(common_velocity) * self.friction(common_friction)
    }

    /// The sign of the friction force in uniform sliding: that of v, 0 where the surface stands still.
    #[must_use]
    pub fn sliding_sign(&self, common_velocity: f64) -> f64 {
        let velocity = self.velocity(common_velocity);
        if velocity == 0.0 { 0.0 } else { velocity.signum() }
    }
}

/// A direction in the space of the degrees of freedom, as its non-zero components.
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

impl From<&Scene> for LumpedModel {
    fn from(scene: &Scene) -> Self {
        let mut model = match &scene.structure {
            Structure::Ring(modules) => ring::model(scene, modules),
            Structure::Network(network) => network::model(scene, network),
        };
        model.update_contacts(scene);
        model
    }
}

/// Writes the loads of the scene as it is now, N, into `load`, one value a degree of freedom;
/// `numbering` is the scene's.
pub fn load(scene: &Scene, numbering: &Numbering, load: &mut [f64]) {
    match &scene.structure {
        Structure::Ring(modules) => ring::load(modules, load),
        Structure::Network(network) => network::load(network, numbering, load),
    }
}

/// Adds the forces, N, of a preload (m) to `load`, one value a degree of freedom. `index` is the place of
/// the module or spring that has it, `numbering` the scene's.
pub fn add_preload(
    scene: &Scene,
    numbering: &Numbering,
    index: usize,
    preload: f64,
    load: &mut [f64],
) {
    match &scene.structure {
        Structure::Ring(modules) => {
            load[ring::MODULE_DOFS * index + ring::PRELOADED] +=
                ring::preload_force(&modules[index], preload);
        }
        Structure::Network(network) => {
            network::add_preload(network, numbering, &network.springs[index], preload, load);
        }
    }
}

impl LumpedModel {
    /// Takes over µ and v of the contacts as they are in the scene now.
    pub fn update_contacts(&mut self, scene: &Scene) {
        let places = scene.network().map_or(&[][..], |network| &network.contacts);
        for (contact, place) in self.contacts.iter_mut().zip(places) {
            contact.own = OwnValues::from(place);
        }
        let Some(falls) = self.law.friction.about().falls else { return };
        for contact in &mut self.contacts {
            let (friction, slip) =
                (contact.coefficients(scene.friction()), contact.velocity(scene.slider.velocity));
            contact.steady = Some(Steady {
                friction: (falls.friction)(friction, slip),
                slope: (falls.slope)(friction, slip),
                normal_force: 0.0,
            });
        }
    }

    /// Gives contacts whose µ depends on the slip velocity the most that it can be in slip, for whoever asks
    /// what may happen; [`update_contacts`](Self::update_contacts) takes it back.
    pub fn raise_friction(&mut self, scene: &Scene) {
        let Some(falls) = self.law.friction.about().falls else { return };
        for contact in &mut self.contacts {
            let friction = (falls.most)(contact.coefficients(scene.friction()));
            contact.steady = contact.steady.map(|steady| Steady { friction, ..steady });
        }
    }

    /// Takes over the normal forces about which friction that depends on the slip velocity is linearised.
    pub fn linearise(&mut self, equilibrium: &Equilibrium) {
        for (contact, force) in self.contacts.iter_mut().zip(&equilibrium.normal_force) {
            if let Some(steady) = &mut contact.steady {
                steady.normal_force = *force;
            }
        }
    }

    /// Is there damping besides α M + β K? Then a contact state's modes have no common eigenvectors.
    #[must_use]
    pub fn has_single_damping(&self) -> bool {
        !self.dampers.is_empty() || self.contacts.iter().any(|contact| contact.weakening() != 0.0)
    }

    /// Number of degrees of freedom, n.
    #[must_use]
    pub fn dofs(&self) -> usize {
        self.load.len()
    }
}
