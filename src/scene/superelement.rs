//! Superelements: structures as matrices, with a name for each degree of freedom.

use super::Problem;
use std::fmt;
use std::path::Path;
use std::sync::Arc;

/// End of the names of packed files, without the point.
pub const PACKED: &str = "superelement";
/// Largest number of degrees of freedom of a superelement, whose matrices have no zeros.
pub const MAX_FREEDOMS: usize = 3000;

/// Names of the directions 1 to 6.
pub(super) const AXES: [&str; 6] = ["x", "y", "z", "rx", "ry", "rz"];

/// A degree of freedom of a superelement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Freedom {
    /// Number of the node, or of the mode if it is a modal coordinate.
    pub node: u64,
    /// 1, 2, 3: displacement along x, y, z, m; 4, 5, 6: rotation about x, y, z, rad; 0: modal coordinate.
    pub direction: u8,
}

/// The matrices of a superelement in SI units, n × n by rows, with a name for each row. They are shared, since scenes
/// are copied often and matrices do not change.
#[derive(Clone, PartialEq)]
pub struct SuperelementMatrices(Arc<Matrices>);

#[derive(PartialEq)]
struct Matrices {
    freedoms: Vec<Freedom>,
    mass: Vec<f64>,
    stiffness: Vec<f64>,
    damping: Vec<f64>,
}

impl SuperelementMatrices {
    /// Makes a superelement of its matrices, n × n by rows. `mass` is symmetric and positive definite. `stiffness`
    /// includes the circulatory part, and `damping` the gyroscopic part and all damping; both may be unsymmetric, and
    /// `damping` is empty if there is none.
    ///
    /// # Errors
    /// Returns all that is wrong, with the keys `freedoms`, `mass`, `stiffness` and `damping` as paths: no rows, too
    /// many, a row named twice or in no known direction, another size, numbers that are not finite, a mass matrix that
    /// is unsymmetric or not positive definite.
    pub fn new(
        freedoms: Vec<Freedom>,
        mass: Vec<f64>,
        stiffness: Vec<f64>,
        damping: Vec<f64>,
    ) -> Result<Self, Vec<Problem>> {
        let matrices = Matrices { freedoms, mass, stiffness, damping };
        let problems = matrices.problems();
        if problems.is_empty() { Ok(Self(Arc::new(matrices))) } else { Err(problems) }
    }

    /// The same degrees of freedom with matrices of zeros: nothing of the superelement is then left in a model.
    #[must_use]
    pub fn emptied(&self) -> Self {
        let Matrices { freedoms, mass, .. } = &*self.0;
        let zeros = vec![0.0; mass.len()];
        let freedoms = freedoms.clone();
        Self(Arc::new(Matrices {
            freedoms,
            mass: zeros.clone(),
            stiffness: zeros,
            damping: vec![],
        }))
    }

    /// Number n of degrees of freedom.
    #[must_use]
    pub fn dofs(&self) -> usize {
        self.0.freedoms.len()
    }

    /// The degrees of freedom, in the order of the rows.
    #[must_use]
    pub fn freedoms(&self) -> &[Freedom] {
        &self.0.freedoms
    }

    /// The mass matrix, symmetric, kg; n × n by rows.
    #[must_use]
    pub fn mass(&self) -> &[f64] {
        &self.0.mass
    }

    /// The stiffness matrix with the circulatory part, N/m; n × n by rows.
    #[must_use]
    pub fn stiffness(&self) -> &[f64] {
        &self.0.stiffness
    }

    /// The matrix of velocities: damping and gyroscopic part, N s/m; n × n by rows, empty if there is none.
    #[must_use]
    pub fn damping(&self) -> &[f64] {
        &self.0.damping
    }

    /// The row of a node's (or mode's) degree of freedom; `None` if the superelement does not have it.
    #[must_use]
    pub fn row(&self, node: u64, direction: u8) -> Option<usize> {
        self.0.freedoms.iter().position(|one| *one == Freedom { node, direction })
    }

    /// `true` if the stiffness has no circulatory part.
    #[must_use]
    pub fn is_conservative(&self) -> bool {
        is_symmetric(&self.0.stiffness, self.dofs())
    }
}

impl fmt::Debug for SuperelementMatrices {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "SuperelementMatrices({} degrees of freedom)", self.dofs())
    }
}

impl Matrices {
    fn problems(&self) -> Vec<Problem> {
        let n = self.freedoms.len();
        if n == 0 {
            return vec![Problem::new("freedoms", "there is no degree of freedom")];
        }
        if n > MAX_FREEDOMS {
            return vec![
                Problem::new("freedoms", too_many(n))
                    .help("reduce the structure first, with `amontons reduce`"),
            ];
        }
        let mut problems = Vec::new();
        let mut sorted: Vec<(Freedom, usize)> = self.freedoms.iter().copied().zip(1..).collect();
        sorted.sort_unstable();
        let twice = sorted.windows(2).find(|pair| pair[0].0 == pair[1].0);
        if let Some([(Freedom { node, direction }, first), (_, second)]) = twice {
            let message =
                format!("rows {first} and {second} are both direction {direction} of node {node}");
            problems.push(
                Problem::new("freedoms", message).help("give each row its own node and direction"),
            );
        }
        if let Some(row) = self.freedoms.iter().position(|one| one.direction > 6) {
            let Freedom { node, direction } = self.freedoms[row];
            let message = format!("row {} is direction {direction} of node {node}", row + 1);
            let help = "directions are 1 to 3 (displacements), 4 to 6 (rotations) and 0 (a mode)";
            problems.push(Problem::new("freedoms", message).help(help));
        }
        for (key, matrix, may_lack) in [
            ("mass", &self.mass, false),
            ("stiffness", &self.stiffness, false),
            ("damping", &self.damping, true),
        ] {
            if matrix.len() != n * n && !(may_lack && matrix.is_empty()) {
                let message = format!(
                    "has {} values, but {n} degrees of freedom need {}",
                    matrix.len(),
                    n * n
                );
                problems.push(Problem::new(key, message));
            } else if let Some(at) = matrix.iter().position(|value| !value.is_finite()) {
                let message =
                    format!("row {}, column {} must be a finite number", at / n + 1, at % n + 1);
                problems.push(Problem::new(key, message).of(matrix[at]));
            }
        }
        if problems.is_empty() {
            problems.extend(self.bad_mass(n));
        }
        problems
    }

    /// Reports a mass matrix that is unsymmetric or not positive definite.
    fn bad_mass(&self, n: usize) -> Option<Problem> {
        let mass = &self.mass;
        let is_unlike = |(i, j): &(usize, usize)| mass[i * n + j] != mass[j * n + i];
        if let Some((i, j)) = (0..n).flat_map(|i| (0..i).map(move |j| (i, j))).find(is_unlike) {
            let message = format!(
                "must be symmetric, but row {}, column {} is {:e} and row {}, column {} is {:e}",
                i + 1,
                j + 1,
                mass[i * n + j],
                j + 1,
                i + 1,
                mass[j * n + i]
            );
            return Some(Problem::new("mass", message));
        }
        let row = unsupported_row(mass, n)?;
        let Freedom { node, direction } = self.freedoms[row];
        let message = format!(
            "must be positive definite, but gives no mass to some motion of node {node}, direction {direction} (row {})",
            row + 1
        );
        Some(
            Problem::new("mass", message)
                .help("give each degree of freedom a mass, or leave out those that have none"),
        )
    }
}

pub(super) fn too_many(n: usize) -> String {
    format!("{n} degrees of freedom are too many: a superelement has at most {MAX_FREEDOMS}")
}

/// The first row at which Cholesky's factor of a symmetric matrix has no positive pivot; `None` if the matrix is
/// positive definite.
fn unsupported_row(matrix: &[f64], n: usize) -> Option<usize> {
    let mut lower = vec![0.0; n * n];
    for i in 0..n {
        let (above, row) = lower.split_at_mut(i * n);
        for j in 0..i {
            let other = &above[j * n..=j * n + j];
            let known = row[..j].iter().zip(other).fold(0.0, |sum, (a, b)| sum + a * b);
            row[j] = (matrix[i * n + j] - known) / other[j];
        }
        let known = row[..i].iter().fold(0.0, |sum, a| sum + a * a);
        let pivot = matrix[i * n + i] - known;
        // Below rounding nothing is left of the row's mass.
        if pivot.is_nan() || pivot <= f64::EPSILON * matrix[i * n + i].abs() {
            return Some(i);
        }
        row[i] = pivot.sqrt();
    }
    None
}

pub(super) fn is_symmetric(matrix: &[f64], n: usize) -> bool {
    (0..n).all(|i| (0..i).all(|j| matrix[i * n + j] == matrix[j * n + i]))
}

/// A superelement of a network.
#[derive(Clone, Debug, PartialEq)]
pub struct Superelement {
    /// Name of the superelement.
    pub name: String,
    /// Its matrices.
    pub matrices: SuperelementMatrices,
    /// Constant load on each degree of freedom, N (N m for rotations); part of the load of the equilibrium.
    pub load: Vec<f64>,
    /// External force on each degree of freedom, N (N m for rotations); not part of the equilibrium.
    pub force: Vec<f64>,
    /// Initial displacement of each degree of freedom from the equilibrium, m (rad for rotations).
    pub displacement: Vec<f64>,
    /// Initial velocity of each degree of freedom, m/s (rad/s for rotations).
    pub velocity: Vec<f64>,
    /// The largest damping ratio above 1 that its table gives a mode; `None` without one, and if the matrices are packed.
    pub overdamped: Option<f64>,
}

impl Superelement {
    /// A superelement without loads that starts at rest in the equilibrium.
    #[must_use]
    pub fn new(name: impl Into<String>, matrices: SuperelementMatrices) -> Self {
        let zeros = vec![0.0; matrices.dofs()];
        let [load, force, displacement] = [zeros.clone(), zeros.clone(), zeros.clone()];
        let (name, velocity) = (name.into(), zeros);
        Self { name, matrices, load, force, displacement, velocity, overdamped: None }
    }

    /// The FMU's name of a node: `superelement.pad.node[17]`.
    pub(super) fn node_name(&self, node: u64) -> String {
        format!("superelement.{}.node[{node}]", self.name)
    }

    /// The FMU's names of the degrees of freedom, in order; modes are counted from 1.
    pub(super) fn row_names(&self) -> impl Iterator<Item = String> + '_ {
        let mut modes = 0;
        self.matrices.freedoms().iter().map(move |Freedom { node, direction }| {
            match AXES.get(usize::from(*direction).wrapping_sub(1)) {
                Some(axis) => format!("{}.{axis}", self.node_name(*node)),
                None => {
                    modes += 1;
                    format!("superelement.{}.mode[{modes}]", self.name)
                }
            }
        })
    }
}

/// A `[[superelement]]` whose matrices are in files of other programs, as its table has it. Paths are relative to the
/// folder of the scene file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SuperelementFiles {
    /// Name of the superelement.
    pub name: String,
    /// Folder that `amontons reduce` wrote, with `stiffness.mtx`, `mass.mtx` and `freedoms.csv`; in place of `stiffness`
    /// and `mass`.
    pub folder: Option<String>,
    /// File of the stiffness matrix.
    pub stiffness: Option<String>,
    /// File of the mass matrix.
    pub mass: Option<String>,
    /// CSV file of nodes and directions of the rows.
    pub freedoms: Option<String>,
    /// File of a damping matrix.
    pub damping: Option<String>,
    /// File of the gyroscopic matrix, which is added to the damping.
    pub gyroscopic: Option<String>,
    /// File of the circulatory matrix, which is added to the stiffness.
    pub circulatory: Option<String>,
    /// Mass-proportional damping α of the superelement, 1/s.
    pub alpha: f64,
    /// Stiffness-proportional damping β of the superelement, s; without the circulatory part.
    pub beta: f64,
    /// Damping ratios of the modes of the free superelement, by frequency: none, one for all modes, or one for each of
    /// the first modes.
    pub damping_ratio: Vec<f64>,
    /// Units of the files.
    pub units: UnitFactors,
}

/// Units of matrix files, as factors to SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnitFactors {
    /// The unit of length, m.
    pub length: f64,
    /// The unit of mass, kg.
    pub mass: f64,
    /// The unit of time, s.
    pub time: f64,
}

impl Default for UnitFactors {
    /// SI units.
    fn default() -> Self {
        Self { length: 1.0, mass: 1.0, time: 1.0 }
    }
}

/// A reader of matrix files, which programs give a [`Folder`](super::Folder). The library inside an FMU has none, since an FMU carries
/// packed superelements.
pub trait MatrixFiles {
    /// Reads the files of one superelement; `folder` is that of the scene file.
    ///
    /// # Errors
    /// Returns all that is wrong; the path of each problem is a key of the table (`stiffness`), or empty for the
    /// table itself.
    fn read(
        &self,
        folder: &Path,
        files: &SuperelementFiles,
    ) -> Result<SuperelementMatrices, Vec<Problem>>;
}
