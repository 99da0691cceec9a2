//! A network of masses, superelements, springs, dampers and contacts as a lumped model.
//!
//! Degrees of freedom: mass by mass, x then y along the mass's own axes, locked ones left out, then superelement by
//! superelement in the order of its rows, whose matrices are blocks of M, K and D. A
//! mass whose axes are turned by φ stands at u = x (cos φ, sin φ) + y (−sin φ, cos φ).
//!
//! A spring in direction d elongates by d·(u_a − u_b) − p and adds k b bᵀ to K, b being its
//! elongation without the preload p; the preload and the constant forces on the masses are the load.
//! A damper adds likewise to D. A contact with tangent t and outward normal n has the rows
//! G_N = n·(u_mass − u_on) and G_T = t·(u_mass − u_on), and the gap that the scene gives it.

use super::elements::{Elongation, difference, spring};
use crate::model::{Contact, Direction, Entry, LumpedModel, SparseMatrix};
use crate::scene::{Network, NodeAt, Point, Scene, Spring, Superelement, direction};

/// Numbers of the degrees of freedom: those of each mass along x and y, `None` for a locked one, and the first of each
/// superelement.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Numbering {
    places: Vec<[Option<usize>; 2]>,
    starts: Vec<usize>,
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
        let start = |one: &Superelement| {
            dofs += one.matrices.dofs();
            dofs - one.matrices.dofs()
        };
        let starts = network.superelements.iter().map(start).collect();
        Self { places, starts, dofs }
    }

    /// The degree of freedom of a mass along its x (0) or y (1).
    #[must_use]
    pub fn dof(&self, mass: usize, axis: usize) -> Option<usize> {
        self.places.get(mass)?[axis]
    }

    /// The degree of freedom of a superelement's row.
    #[must_use]
    pub fn row(&self, superelement: usize, row: usize) -> Option<usize> {
        Some(self.starts.get(superelement)? + row)
    }

    /// The displacement of a point along a direction of space, as a combination of degrees of freedom. Those that a node
    /// does not have stand still. Loads are written in every step of some runs, so nothing is allocated.
    fn along(
        &self,
        network: &Network,
        point: Point,
        d: [f64; 3],
    ) -> impl Iterator<Item = (usize, f64)> + use<> {
        let parts = match point {
            Point::Mass(mass) => {
                let [cos, sin] = direction(network.masses[mass].angle);
                let [x, y] = self.places[mass];
                [(x, d[0] * cos + d[1] * sin), (y, d[1] * cos - d[0] * sin), (None, 0.0)]
            }
            Point::Node(at) => {
                [1, 2, 3].map(|axis: u8| (self.node(network, at, axis), d[usize::from(axis) - 1]))
            }
        };
        let parts = parts.into_iter().filter(|part| part.1 != 0.0);
        parts.filter_map(|(dof, part)| Some((dof?, part)))
    }

    fn node(&self, network: &Network, at: NodeAt, direction: u8) -> Option<usize> {
        self.row(at.superelement, network.node_row(at, direction)?)
    }

    /// d·(u_a − u_b); an end that is `None` stands still.
    fn elongation(&self, network: &Network, ends: [Option<Point>; 2], d: [f64; 3]) -> Elongation {
        let [a, b] = ends
            .map(|end| end.into_iter().flat_map(|point| self.along(network, point, d)).collect());
        difference(a, b)
    }
}

/// The model of a scene that is a network.
pub(super) fn model(scene: &Scene, network: &Network) -> LumpedModel {
    let Network { masses, superelements, springs, dampers, contacts, .. } = network;
    let numbering = Numbering::of(network);
    let dofs = numbering.dofs;
    let (mut stiffness, mut damping) = (Vec::new(), Vec::new());
    for part in springs {
        let elongation = numbering.elongation(network, part.between, part.direction.vector());
        spring(&mut stiffness, part.stiffness, &elongation);
    }
    for part in dampers {
        let elongation = numbering.elongation(network, part.between, part.direction.vector());
        spring(&mut damping, part.damping, &elongation);
    }
    let contacts = contacts.iter().enumerate().map(|(i, place)| {
        let [n, t] = place.directions(scene.slider.angle);
        let ends = [Some(place.mass), place.on];
        let row = |d| Direction(numbering.elongation(network, ends, d));
        let across = || row(cross(n, t));
        let transverse = scene.transverse_damping.then(across).filter(|row| !row.0.is_empty());
        Contact {
            normal: row(n),
            tangent: row(t),
            transverse,
            gap: place.gap,
            friction: scene.friction_of(i),
            surface_velocity: scene.surface_velocity(i),
        }
    });
    let diagonal = masses.iter().flat_map(|mass| mass.free([mass.mass; 2])).enumerate();
    let mut mass: Vec<Entry> = diagonal.map(|(dof, mass)| (dof, dof, mass)).collect();
    for (one, &start) in superelements.iter().zip(&numbering.starts) {
        let matrices = &one.matrices;
        add_block(&mut mass, matrices.mass(), start, matrices.dofs());
        add_block(&mut stiffness, matrices.stiffness(), start, matrices.dofs());
        add_block(&mut damping, matrices.damping(), start, matrices.dofs());
    }
    let mut model = LumpedModel {
        mass: SparseMatrix::from_entries(dofs, mass),
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

/// Adds a matrix of `size` rows, given by rows, whose first degree of freedom is `start`.
fn add_block(entries: &mut Vec<Entry>, values: &[f64], start: usize, size: usize) {
    let rows = values.chunks_exact(size).enumerate();
    entries.extend(rows.flat_map(|(row, values)| {
        let of_column = move |(column, &value)| (start + row, start + column, value);
        values.iter().enumerate().map(of_column)
    }));
}

/// The vector product of two vectors.
fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Writes the constant forces and the preloads, N, into `load`, one value for each degree of freedom.
pub(super) fn load(network: &Network, numbering: &Numbering, load: &mut [f64]) {
    let constant = network.masses.iter().flat_map(|mass| mass.free(mass.load));
    let of_nodes = network.superelements.iter().flat_map(|one| one.load.iter().copied());
    let constant = constant.chain(of_nodes);
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
    let d = spring.direction.vector();
    for (end, sign) in spring.between.into_iter().zip([1.0, -1.0]) {
        let force = sign * spring.stiffness * preload;
        let parts = end.into_iter().flat_map(|point| numbering.along(network, point, d));
        parts.for_each(|(dof, part)| load[dof] += force * part);
    }
}
