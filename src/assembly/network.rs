//! A network of masses, springs, dampers and contacts as a lumped model.
//!
//! Degrees of freedom: mass by mass, x then y along the mass's own axes, locked ones left out. A
//! mass whose axes are turned by φ stands at u = x (cos φ, sin φ) + y (−sin φ, cos φ).
//!
//! A spring in direction d elongates by d·(u_a − u_b) − p and adds k b bᵀ to K, b being its
//! elongation without the preload p; the preload and the constant forces on the masses are the load.
//! A damper adds likewise to D. A contact with tangent t and outward normal n has the rows
//! G_N = n·(u_mass − u_on) and G_T = t·(u_mass − u_on).

use super::elements::{Elongation, difference, spring};
use crate::model::{Contact, Direction, LumpedModel, SparseMatrix};
use crate::scene::{Mass, Network, Scene, Spring, direction};

/// Numbers of the degrees of freedom of each mass along x and y; `None` for a locked one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Numbering {
    places: Vec<[Option<usize>; 2]>,
    dofs: usize,
}

impl Numbering {
    /// The numbering of a network's degrees of freedom.
    #[must_use]
    pub fn of(network: &Network) -> Self {
        let mut dofs = 0;
        let mut number = |locked: bool| {
            (!locked).then(|| {
                dofs += 1;
                dofs - 1
            })
        };
        let places = network.masses.iter().map(|mass| mass.locked.map(&mut number)).collect();
        Self { places, dofs }
    }

    /// The degree of freedom of a mass along its x (0) or y (1).
    #[must_use]
    pub fn dof(&self, mass: usize, axis: usize) -> Option<usize> {
        self.places.get(mass)?[axis]
    }

    /// The displacement of a mass along a direction of space, as a combination of degrees of freedom.
    fn along<'a>(
        &'a self,
        masses: &[Mass],
        mass: usize,
        [dx, dy]: [f64; 2],
    ) -> impl Iterator<Item = (usize, f64)> + use<'a> {
        let [cos, sin] = direction(masses[mass].angle);
        let parts = [dx * cos + dy * sin, dy * cos - dx * sin];
        let parts = self.places[mass].into_iter().zip(parts);
        parts.filter(|part| part.1 != 0.0).filter_map(|(dof, part)| Some((dof?, part)))
    }

    /// d·(u_a − u_b); an end that is `None` stands still.
    fn elongation(&self, masses: &[Mass], ends: [Option<usize>; 2], d: [f64; 2]) -> Elongation {
        let [a, b] = ends.map(|end| {
            end.map_or_else(Vec::new, |mass| self.along(masses, mass, d).collect::<Vec<_>>())
        });
        difference(a, b)
    }
}

/// The model of a scene that is a network.
pub(super) fn model(scene: &Scene, network: &Network) -> LumpedModel {
    let Network { masses, springs, dampers, contacts } = network;
    let numbering = Numbering::of(network);
    let dofs = numbering.dofs;
    let (mut stiffness, mut damping) = (Vec::new(), Vec::new());
    for part in springs {
        let d = direction(part.direction);
        let elongation = numbering.elongation(masses, part.between, d);
        spring(&mut stiffness, part.stiffness, &elongation);
    }
    for part in dampers {
        let d = direction(part.direction);
        spring(&mut damping, part.damping, &numbering.elongation(masses, part.between, d));
    }
    let contacts = contacts.iter().enumerate().map(|(i, place)| {
        let [cos, sin] = direction(place.angle.unwrap_or(scene.slider.angle));
        let ends = [Some(place.mass), place.on];
        let row = |d| Direction(numbering.elongation(masses, ends, d));
        Contact {
            normal: row([-sin, cos]),
            tangent: row([cos, sin]),
            transverse: None,
            gap: 0.0,
            friction: scene.friction_of(i),
            surface_velocity: scene.surface_velocity(i),
        }
    });
    let mass: Vec<f64> = masses.iter().flat_map(|mass| mass.free([mass.mass; 2])).collect();
    let mut model = LumpedModel {
        mass: SparseMatrix::diagonal(&mass),
        stiffness: SparseMatrix::from_entries(dofs, stiffness),
        damping: scene.damping,
        dampers: SparseMatrix::from_entries(dofs, damping),
        load: vec![0.0; dofs],
        contacts: contacts.collect(),
        law: scene.contact_law(),
    };
    load(network, &numbering, &mut model.load);
    model
}

/// Writes the constant forces and the preloads, N, into `load`, one value for each degree of freedom.
pub(super) fn load(network: &Network, numbering: &Numbering, load: &mut [f64]) {
    let constant = network.masses.iter().flat_map(|mass| mass.free(mass.load));
    load.iter_mut().zip(constant).for_each(|(load, constant)| *load = constant);
    for spring in &network.springs {
        if let Some(preload) = spring.preload.filter(|preload| *preload != 0.0) {
            add_preload(network, numbering, spring, preload, load);
        }
    }
}

/// Adds the forces, N, of a preload (m) of that spring to `load`.
pub(super) fn add_preload(
    network: &Network,
    numbering: &Numbering,
    spring: &Spring,
    preload: f64,
    load: &mut [f64],
) {
    let d = direction(spring.direction);
    for (end, sign) in spring.between.into_iter().zip([1.0, -1.0]) {
        let force = sign * spring.stiffness * preload;
        let parts = end.into_iter().flat_map(|mass| numbering.along(&network.masses, mass, d));
        parts.for_each(|(dof, part)| load[dof] += force * part);
    }
}
