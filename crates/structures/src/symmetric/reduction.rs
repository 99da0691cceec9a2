//! Reduction to a superelement: Craig and Bampton's.

use super::bounds::frequency;
use super::factor::{Factors, Pattern, gigabytes};
use super::lanczos::dense;
use super::modes::below;
use super::structure::Structure;
use crate::sparse::Sparse;
use amontons::Error;
use amontons_analysis::watch::Watch;
use amontons_matrices::{Entry, Freedom, Matrix, Symmetry};
use faer::Mat;

/// The degrees of freedom and modes that a superelement keeps.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// The rows of the retained degrees of freedom, in ascending order.
    pub retained: Vec<usize>,
    /// Modes of the structure with its retained degrees of freedom held are kept up to this frequency, Hz.
    pub modes_to: f64,
    /// The memory that may be used for factors and vectors, bytes.
    pub memory: usize,
}

/// A structure in few coordinates: first the retained degrees of freedom in their order, then one for each mode that it has
/// while these are held.
pub struct Superelement {
    /// The stiffness matrix in these coordinates.
    pub stiffness: Mat<f64>,
    /// The mass matrix in these coordinates.
    pub mass: Mat<f64>,
    /// The rows of the retained degrees of freedom in the full matrices.
    pub retained: Vec<usize>,
    /// The squares of the angular frequencies of the modes that were kept, 1/s².
    pub modes: Vec<f64>,
    /// The motion of all degrees of freedom for a unit of each coordinate: one row for each row of the full matrices.
    pub basis: Mat<f64>,
    /// How much of a translation of the inner nodes along x, y and z the kept modes can make, as a part of its kinetic energy;
    /// `None` where nothing moves along that axis.
    pub moved_mass: [Option<f64>; 3],
}

impl Superelement {
    /// The stiffness and the mass matrix, with the names of their rows: retained degrees of freedom keep theirs, and modes are
    /// scalar points with numbers above those of all nodes of the structure.
    #[must_use]
    pub fn matrices(&self, structure: &Structure) -> [Matrix; 2] {
        let freedoms = self.freedoms(structure);
        [&self.stiffness, &self.mass].map(|dense| Matrix {
            symmetry: Symmetry::Symmetric,
            ..matrix(dense, freedoms.clone())
        })
    }

    /// TᵀAT for another matrix of the structure, such as its damping, and the basis T of the superelement.
    ///
    /// # Errors
    /// Returns an error if the matrix is not of the structure's size.
    pub fn reduced(&self, structure: &Structure, full: &Matrix) -> Result<Matrix, Error> {
        let order = self.basis.nrows();
        if full.rows != order || full.columns != order {
            return Err(Error::analysis(format!(
                "a matrix has {} rows and {} columns; the structure has {order} degrees of freedom",
                full.rows, full.columns
            )));
        }
        let reduced = self.basis.transpose() * Sparse::new(full)?.times(self.basis.as_ref());
        Ok(matrix(&reduced, self.freedoms(structure)))
    }

    /// The modes of the free superelement up to a frequency in Hz, those of a rigid body among them: the frequency of each, Hz,
    /// and the motion of all rows of the full matrices, of which the largest has the magnitude 1.
    ///
    /// # Errors
    /// Returns an error if the modes cannot be computed.
    pub fn free_modes(&self, limit: f64) -> Result<Vec<(f64, Vec<f64>)>, Error> {
        let (values, vectors) = dense(&self.stiffness, &self.mass)?;
        let kept = values.iter().take_while(|&&value| frequency(value) <= limit).count();
        let shapes = &self.basis * vectors.subcols(0, kept);
        let modes = values.iter().take(kept).enumerate().map(|(mode, &value)| {
            let shape: Vec<f64> = shapes.col(mode).iter().copied().collect();
            // The sign is that of the largest value, so that it does not depend on the machine.
            let larger = |a: f64, &b: &f64| if b.abs() > a.abs() { b } else { a };
            let largest = shape.iter().fold(0.0, larger);
            let scale = if largest == 0.0 { 1.0 } else { largest };
            (frequency(value), shape.into_iter().map(|value| value / scale).collect())
        });
        Ok(modes.collect())
    }

    fn freedoms(&self, structure: &Structure) -> Vec<Freedom> {
        let last = structure.freedoms.iter().map(|freedom| freedom.node).max().unwrap_or(0);
        let modes = (1..=self.modes.len() as u64)
            .map(|mode| Freedom { node: last.saturating_add(mode), direction: 0 });
        self.retained.iter().map(|&row| structure.freedoms[row]).chain(modes).collect()
    }
}

/// A dense matrix with its entries that are not zero.
fn matrix(dense: &Mat<f64>, freedoms: Vec<Freedom>) -> Matrix {
    let places =
        (0..dense.ncols()).flat_map(|column| (0..dense.nrows()).map(move |row| (row, column)));
    let entries = places
        .map(|(row, column)| Entry { row, column, value: dense[(row, column)] })
        .filter(|entry| entry.value != 0.0);
    Matrix {
        name: None,
        rows: dense.nrows(),
        columns: dense.ncols(),
        entries: entries.collect(),
        symmetry: Symmetry::General,
        freedoms: Some(freedoms),
    }
}

/// Reduces a structure: static shapes of the retained degrees of freedom, and the modes with these held.
///
/// Source: R. R. Craig and M. C. C. Bampton, Coupling of substructures for dynamic analyses, AIAA Journal 6 (1968).
///
/// # Errors
/// Returns an error if a row is not of the structure, if the rest of the structure is not held by the retained degrees of
/// freedom, if more memory is needed than may be used, or if the work has been ended.
pub fn reduce(
    structure: &Structure,
    request: &Request,
    watch: Watch<'_>,
) -> Result<Superelement, Error> {
    let (full_stiffness, full_mass) = (&structure.stiffness, &structure.mass);
    let order = full_stiffness.rows();
    let retained = &request.retained;
    let mut is_retained = vec![false; order];
    for pair in retained.windows(2) {
        if pair[0] >= pair[1] {
            return Err(Error::argument("retained rows must be in ascending order, each once"));
        }
    }
    for &row in retained {
        *is_retained.get_mut(row).ok_or_else(|| {
            Error::argument(format!("row {} is retained, but there are {order}", row + 1))
        })? = true;
    }
    let inner: Vec<usize> = (0..order).filter(|&row| !is_retained[row]).collect();
    if retained.is_empty() || inner.is_empty() {
        return Err(Error::analysis(format!(
            "{} of {order} degrees of freedom are retained; retain some, and leave some to reduce",
            retained.len()
        )));
    }
    let stiffness = full_stiffness.part(&inner, &inner);
    let mass = full_mass.part(&inner, &inner);
    let stiffness_across = full_stiffness.part(&inner, retained);
    let mass_across = full_mass.part(&inner, retained);

    let counted = below(&stiffness, &mass, request.modes_to, request.memory, watch)?;
    if let Some(first) = counted.bounds.first() {
        if first.value.abs() <= counted.rounding {
            return Err(Error::analysis(
                "with the retained nodes held, a part of the structure can still move freely; retain at least three nodes of each \
                 part that are not on one line",
            ));
        }
        if first.value <= first.distance {
            return Err(Error::analysis(format!(
                "the lowest modes cannot be told from 0 beside {} Hz; ask for a lower frequency",
                request.modes_to
            )));
        }
    }
    let modes = counted.modes;
    let (held, kept) = (retained.len(), modes.values.len());
    // The static shapes, their products with K and M, the modes and the basis.
    let needed = size_of::<f64>().saturating_mul(order).saturating_mul(5 * held + 3 * kept);
    if needed > request.memory {
        return Err(Error::analysis(format!(
            "{held} retained degrees of freedom and {kept} modes need {} of memory, and {} are allowed; retain fewer nodes, or allow \
             more with --memory",
            gigabytes(needed),
            gigabytes(request.memory)
        )));
    }
    watch.check()?;

    // Static shapes: K_ii Ψ = −K_ib.
    let pattern = Pattern::new(&stiffness, request.memory)?;
    let mut shapes = stiffness_across.dense();
    Factors::new(&pattern, &stiffness).solve(shapes.as_mut());
    shapes *= faer::Scale(-1.0);
    watch.check()?;

    let inertia = mass.times(shapes.as_ref()) + mass_across.dense();
    let static_stiffness = full_stiffness.part(retained, retained).dense()
        + stiffness_across.transposed().times(shapes.as_ref());
    let static_mass = full_mass.part(retained, retained).dense()
        + mass_across.transposed().times(shapes.as_ref())
        + shapes.transpose() * &inertia;
    let coupling = modes.vectors.transpose() * &inertia;
    let reduced = |block: &Mat<f64>,
                   across: &dyn Fn(usize, usize) -> f64,
                   modal: &dyn Fn(usize) -> f64| {
        Mat::from_fn(held + kept, held + kept, |row, column| match (row < held, column < held) {
            (true, true) => 0.5 * (block[(row, column)] + block[(column, row)]),
            (false, true) => across(row - held, column),
            (true, false) => across(column - held, row),
            (false, false) if row == column => modal(row - held),
            (false, false) => 0.0,
        })
    };
    let mut basis = Mat::zeros(order, held + kept);
    for (column, &row) in retained.iter().enumerate() {
        basis[(row, column)] = 1.0;
    }
    for (at, &row) in inner.iter().enumerate() {
        for column in 0..held {
            basis[(row, column)] = shapes[(at, column)];
        }
        for mode in 0..kept {
            basis[(row, held + mode)] = modes.vectors[(at, mode)];
        }
    }
    let moved_mass = [1, 2, 3].map(|direction| {
        let along = Mat::from_fn(inner.len(), 1, |at, _| {
            f64::from(u8::from(structure.freedoms[inner[at]].direction == direction))
        });
        let momentum = mass.times(along.as_ref());
        let total = (along.transpose() * &momentum)[(0, 0)];
        let parts = modes.vectors.transpose() * &momentum;
        (total > 0.0).then(|| parts.squared_norm_l2() / total)
    });
    Ok(Superelement {
        stiffness: reduced(&static_stiffness, &|_, _| 0.0, &|mode| modes.values[mode]),
        mass: reduced(&static_mass, &|mode, column| coupling[(mode, column)], &|_| 1.0),
        retained: retained.clone(),
        modes: modes.values,
        basis,
        moved_mass,
    })
}
