//! Superelements of a scene from matrix files, in SI units.
//!
//! | file | contents |
//! | --- | --- |
//! | `files` | the matrices of the files, their rows numbered alike |
//! | `units` | from the units of the files to SI units |
//! | `modal` | damping by ratios of the modes |
//! | `eigen` | the modes of a symmetric matrix, the same to the last bit on every machine |

mod eigen;
mod files;
mod modal;
mod units;

use amontons::scene::{MatrixFiles, Problem, SuperelementFiles, SuperelementMatrices};
use files::Parts;
use std::cell::RefCell;
use std::path::Path;
use units::Scales;
pub use units::length_per_unit;

/// Entries of a symmetric matrix may differ from those across the diagonal by this part of the largest entry: files hold
/// rounded numbers.
const ROUNDING: f64 = 1e-9;

/// The reader of all formats of matrix files.
pub struct Files;

impl MatrixFiles for Files {
    fn read(
        &self,
        folder: &Path,
        files: &SuperelementFiles,
    ) -> Result<SuperelementMatrices, Vec<Problem>> {
        let Parts { freedoms, mut mass, mut stiffness, damping, gyroscopic, circulatory } =
            files::read(folder, files)?;
        let n = freedoms.len();
        let mut problems = Vec::new();
        let help = "give the part that is not symmetric as `circulatory`";
        problems.extend(mean_of_triangles(&mut stiffness, n, "stiffness", help));
        problems.extend(mean_of_triangles(
            &mut mass,
            n,
            "mass",
            "write both matrices of one model",
        ));
        problems.extend(gyroscopic.as_ref().and_then(|matrix| not_skew(matrix, n)));
        if !problems.is_empty() {
            return Err(problems);
        }
        let scales = Scales::new(files.units, &freedoms);
        scales.mass(&mut mass);
        scales.stiffness(&mut stiffness);
        let mut all_damping: Option<Vec<f64>> = None;
        for mut part in [damping, gyroscopic].into_iter().flatten() {
            scales.damping(&mut part);
            add(&mut all_damping, part);
        }
        let SuperelementFiles { alpha, beta, damping_ratio, .. } = files;
        if *alpha != 0.0 || *beta != 0.0 {
            let both = mass.iter().zip(&stiffness);
            add(&mut all_damping, both.map(|(m, k)| alpha * m + beta * k).collect());
        }
        if damping_ratio.iter().any(|ratio| *ratio != 0.0) {
            add(&mut all_damping, modal::damping(&mass, &stiffness, n, damping_ratio)?);
        }
        if let Some(mut part) = circulatory {
            scales.stiffness(&mut part);
            stiffness.iter_mut().zip(part).for_each(|(k, part)| *k += part);
        }
        SuperelementMatrices::new(freedoms, mass, stiffness, all_damping.unwrap_or_default())
    }
}

/// The same reader, which keeps the tables of the superelements that it has read.
#[derive(Debug, Default)]
pub struct RecordedFiles(RefCell<Vec<SuperelementFiles>>);

impl RecordedFiles {
    /// The superelements whose matrices are in files of other programs, in the order of the scene.
    #[must_use]
    pub fn into_tables(self) -> Vec<SuperelementFiles> {
        self.0.into_inner()
    }
}

impl MatrixFiles for RecordedFiles {
    fn read(
        &self,
        folder: &Path,
        files: &SuperelementFiles,
    ) -> Result<SuperelementMatrices, Vec<Problem>> {
        let matrices = Files.read(folder, files)?;
        self.0.borrow_mut().push(files.clone());
        Ok(matrices)
    }
}

/// Adds a matrix to a sum that may be empty.
fn add(sum: &mut Option<Vec<f64>>, part: Vec<f64>) {
    match sum {
        None => *sum = Some(part),
        Some(sum) => sum.iter_mut().zip(part).for_each(|(sum, part)| *sum += part),
    }
}

fn largest(matrix: &[f64]) -> f64 {
    matrix.iter().fold(0.0, |most, value| most.max(value.abs()))
}

/// Gives both triangles of a matrix that is symmetric but for rounding their mean. Reports one that is not.
fn mean_of_triangles(
    matrix: &mut [f64],
    n: usize,
    key: &'static str,
    help: &'static str,
) -> Option<Problem> {
    let budget = ROUNDING * largest(matrix);
    for row in 0..n {
        for column in 0..row {
            let [below, above] = [matrix[row * n + column], matrix[column * n + row]];
            if (below - above).abs() > budget {
                let message = format!(
                    "must be symmetric, but row {}, column {} is {below:e} and row {}, column {} is {above:e}",
                    row + 1,
                    column + 1,
                    column + 1,
                    row + 1
                );
                return Some(Problem::new(key, message).help(help));
            }
            let mean = below + 0.5 * (above - below);
            (matrix[row * n + column], matrix[column * n + row]) = (mean, mean);
        }
    }
    None
}

/// Reports a matrix that does not change its sign when it is transposed.
fn not_skew(matrix: &[f64], n: usize) -> Option<Problem> {
    let budget = ROUNDING * largest(matrix);
    let places = (0..n).flat_map(|row| (0..=row).map(move |column| (row, column)));
    let is_wrong = |(row, column): &(usize, usize)| {
        (matrix[row * n + column] + matrix[column * n + row]).abs() > budget
    };
    places.into_iter().find(is_wrong).map(|(row, column)| {
        let [below, above] = [matrix[row * n + column], matrix[column * n + row]];
        let message = format!(
            "gyroscopic forces do no work, so row {}, column {} must be the negative of row {}, column {}, but they are {below:e} \
             and {above:e}",
            row + 1,
            column + 1,
            column + 1,
            row + 1
        );
        Problem::new("gyroscopic", message)
            .help("give a matrix of velocities with other parts as `damping`")
    })
}

#[cfg(test)]
mod tests;
