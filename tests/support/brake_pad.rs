//! A brake pad as finite-element programs hand it over: reduced matrices without zeros (Craig and Bampton), whose contact
//! nodes all share masses.
//!
//! The pad is a lattice of masses and springs on a grid. The nodes of its lowest layer keep their three displacements; the others
//! follow them as in statics, plus some modes of the pad with these nodes fixed. The matrices are made by nalgebra, whose last bits
//! depend on the processor, so the model serves for what a motion obeys and for time, not for digits.

use amontons::model::LumpedModel;
use amontons::scene::{
    ContactDefinition, Coordinates, Freedom, ModeAt, Network, NodeAt, Point, Scene, Structure,
    Superelement, SuperelementMatrices, parse,
};
use nalgebra::{Cholesky, DMatrix, DVector, SymmetricEigen};

/// Layers of the lattice above one another.
const LAYERS: usize = 3;
/// Distance of neighbours, m.
const SPACING: f64 = 5e-3;
/// Stiffness of the lattice, Pa, and its density, kg/m³.
const MODULUS: f64 = 6e8;
const DENSITY: f64 = 2.5e3;
/// Stiffnesses that hold each node of the uppermost layer along and across the sliding, and along the normal, N/m.
const HOLDERS: [f64; 3] = [4e4, 4e4, 1e4];
/// Pressure on the back, Pa, and velocity of the slider, m/s.
const PRESSURE: f64 = 1e6;
pub const VELOCITY: f64 = 0.2;

/// The number of nodes along and across the sliding, and of modes beside them.
#[derive(Clone, Copy, Debug)]
pub struct Size {
    pub along: usize,
    pub across: usize,
    pub modes: usize,
}

// A test or a benchmark uses one of them.
#[allow(dead_code)]
impl Size {
    /// 300 degrees of freedom with 96 contacts.
    pub const LARGE: Self = Self { along: 12, across: 8, modes: 12 };
    /// 48 degrees of freedom with 12 contacts.
    pub const SMALL: Self = Self { along: 4, across: 3, modes: 12 };

    pub fn contacts(self) -> usize {
        self.along * self.across
    }
}

/// The model of [`scene`].
#[allow(dead_code)]
pub fn pad(size: Size, friction: f64) -> LumpedModel {
    LumpedModel::from(&scene(size, friction))
}

/// The pad on a slider that moves along x; contact nodes lie on a slightly curved surface, so that normals and tangents have three
/// components. Contact `i` is that of node `i`, and all coordinates are shown.
pub fn scene(size: Size, friction: f64) -> Scene {
    let (mass, stiffness, load) = Lattice::new(size).reduced(size);
    let count = size.contacts() as u64;
    let freedom = |node, direction| Freedom { node, direction };
    let of_nodes = (1..=count).flat_map(|node| [1, 2, 3].map(|axis| freedom(node, axis)));
    let of_modes = (1..=size.modes as u64).map(|mode| freedom(mode, 0));
    let by_rows = |matrix: &DMatrix<f64>| matrix.transpose().as_slice().to_vec();
    let matrices = SuperelementMatrices::new(
        of_nodes.chain(of_modes).collect(),
        by_rows(&mass),
        by_rows(&stiffness),
        Vec::new(),
    );
    let mut pad = Superelement::new("pad", matrices.expect("a structure"));
    pad.load = load.as_slice().to_vec();
    let nodes = (1..=count).map(|node| NodeAt { superelement: 0, node });
    let contacts = nodes.clone().zip(0..).map(|(at, place)| {
        let (i, j) = (place % size.along, place / size.along);
        let from_middle =
            |at: usize, count: usize| (at as f64 - 0.5 * (count as f64 - 1.0)) / count as f64;
        let (a, b) = (0.05 * from_middle(i, size.along), 0.04 * from_middle(j, size.across));
        // The projection of the sliding direction on the plane across the normal.
        let square = 1.0 + a * a + b * b;
        ContactDefinition {
            name: format!("node{}", at.node),
            set: None,
            mass: Point::Node(at),
            on: None,
            angle: None,
            axes: Some([[-a, -b, 1.0], [1.0 - a * a / square, -a * b / square, a / square]]),
            gap: 0.0,
            velocity: None,
            friction: None,
            static_friction: None,
            is_shown: true,
        }
    });
    let modes = (0..size.modes).map(|mode| ModeAt { superelement: 0, mode });
    let network = Network {
        contacts: contacts.collect(),
        shown: Coordinates { nodes: nodes.collect(), modes: modes.collect() },
        superelements: vec![pad],
        ..Network::default()
    };
    // Text has no matrices: a block takes the place of the pad in it.
    let text = format!(
        "[slider]\nvelocity = {VELOCITY:?}\nangle = 0.0\n[friction]\ncoefficient = {friction:?}\n\
         [damping]\nalpha = 20.0\nbeta = 2e-8\n[integrator]\nstep = 1e-7\n\
         [[mass]]\nname = \"block\"\nmass = 1.0\n[[contact]]\nname = \"c\"\nmass = \"block\"\n"
    );
    let scene = parse("pad", &text).expect("a scene");
    Scene { structure: Structure::Network(network), ..scene }
}

struct Lattice {
    /// Of one node, kg, by its number.
    mass: Vec<f64>,
    stiffness: DMatrix<f64>,
    load: DVector<f64>,
}

impl Lattice {
    fn new(size: Size) -> Self {
        let Size { along, across, .. } = size;
        let nodes = along * across * LAYERS;
        let place = |node: usize| [node % along, node / along % across, node / (along * across)];
        let mut stiffness = DMatrix::zeros(3 * nodes, 3 * nodes);
        for a in 0..nodes {
            for b in a + 1..nodes {
                let [from, to] = [a, b].map(place);
                let d: [f64; 3] = std::array::from_fn(|axis| to[axis] as f64 - from[axis] as f64);
                let square: f64 = d.iter().map(|d| d * d).sum();
                if d.iter().any(|d| d.abs() > 1.0) {
                    continue;
                }
                let spring = MODULUS * SPACING * 0.4 / square;
                for i in 0..3 {
                    for j in 0..3 {
                        let part = spring * d[i] * d[j] / square;
                        for (row, column, sign) in
                            [(a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)]
                        {
                            stiffness[(3 * row + i, 3 * column + j)] += sign * part;
                        }
                    }
                }
            }
        }
        let mut load = DVector::zeros(3 * nodes);
        for node in (0..nodes).filter(|&node| place(node)[2] == LAYERS - 1) {
            for (axis, holder) in HOLDERS.into_iter().enumerate() {
                stiffness[(3 * node + axis, 3 * node + axis)] += holder;
            }
            // More at the edge that the slider comes from, and less towards the other.
            let share = 1.0 + 0.3 * (place(node)[0] as f64 / along as f64 - 0.5);
            load[3 * node + 2] = -PRESSURE * SPACING * SPACING * share;
        }
        // Friction material below, a back plate of steel above.
        let mass = (0..nodes).map(|node| {
            let heavier = if place(node)[2] == LAYERS - 1 { 2.0 } else { 1.0 };
            heavier * DENSITY * SPACING.powi(3)
        });
        Self { mass: mass.collect(), stiffness, load }
    }

    /// M, K and F of the contact nodes and of the lowest modes beside them.
    fn reduced(&self, size: Size) -> (DMatrix<f64>, DMatrix<f64>, DVector<f64>) {
        let kept = 3 * size.contacts();
        let inner = self.stiffness.nrows() - kept;
        let between = self.stiffness.view((kept, 0), (inner, kept)).into_owned();
        let inside = self.stiffness.view((kept, kept), (inner, inner)).into_owned();
        let mass = DVector::from_fn(inner, |i, _| self.mass[(kept + i) / 3]);
        let statics = -Cholesky::new(inside.clone()).expect("the pad is held").solve(&between);
        let scaled =
            DMatrix::from_fn(inner, inner, |i, j| inside[(i, j)] / (mass[i] * mass[j]).sqrt());
        let modes = SymmetricEigen::new(scaled);
        let mut order: Vec<usize> = (0..inner).collect();
        order.sort_by(|&a, &b| modes.eigenvalues[a].total_cmp(&modes.eigenvalues[b]));
        let n = kept + size.modes;
        let mut shapes = DMatrix::zeros(inner, n);
        shapes.view_mut((0, 0), (inner, kept)).copy_from(&statics);
        for (k, &mode) in order.iter().take(size.modes).enumerate() {
            for i in 0..inner {
                shapes[(i, kept + k)] = modes.eigenvectors[(i, mode)] / mass[i].sqrt();
            }
        }
        let mut heavy = shapes.clone();
        for (i, mut row) in heavy.row_iter_mut().enumerate() {
            row *= mass[i];
        }
        let mut reduced_mass = shapes.transpose() * heavy;
        for i in 0..kept {
            reduced_mass[(i, i)] += self.mass[i / 3];
        }
        let mut reduced_stiffness = DMatrix::zeros(n, n);
        let corner = self.stiffness.view((0, 0), (kept, kept)) + between.transpose() * &statics;
        reduced_stiffness.view_mut((0, 0), (kept, kept)).copy_from(&corner);
        for (k, &mode) in order.iter().take(size.modes).enumerate() {
            reduced_stiffness[(kept + k, kept + k)] = modes.eigenvalues[mode];
        }
        let mut load = shapes.transpose() * self.load.rows(kept, inner);
        for i in 0..kept {
            load[i] += self.load[i];
        }
        let symmetric = |matrix: DMatrix<f64>| 0.5 * (&matrix + matrix.transpose());
        (symmetric(reduced_mass), symmetric(reduced_stiffness), load)
    }
}
