use super::analysis::Analysis;
use super::factors::Factors;
use super::shifted::norm;
use crate::random;
use crate::{Quadratic, Sparse};
use faer::{Mat, c64};
use std::f64::consts::PI;

/// A random sparse problem with unsymmetric patterns whose units mix.
fn problem(size: usize) -> Quadratic {
    let [mass, damping, stiffness] = [(1, 1e-3), (2, 1.0), (3, 1e6)].map(|(seed, unit)| {
        let numbers = random::vector(seed, size * size);
        let entries = (0..size * size).filter_map(|place| {
            let (row, column) = (place % size, place / size);
            let diagonal = if row == column { 3.0 } else { 0.0 };
            let kept = row == column || numbers[place].im > 0.8;
            kept.then(|| (row, column, unit * (diagonal + numbers[place].re)))
        });
        Sparse::from_entries(size, size, entries).unwrap()
    });
    Quadratic::new(mass, damping, stiffness).unwrap()
}

#[test]
fn factors_solve_and_have_the_determinant_of_the_dense_matrix() {
    for size in [1, 2, 3, 10, 60] {
        let problem = problem(size);
        let analysis = Analysis::new(&problem).unwrap();
        for lambda in [c64::new(3.0, 1e4), c64::new(-5.0, 0.0), c64::new(-2e5, 1e5)] {
            let factors = Factors::new(&analysis, lambda).unwrap();
            let mut dense = Mat::zeros(size, size);
            for column in 0..size {
                let mut unit = vec![c64::default(); size];
                unit[column] = c64::new(1.0, 0.0);
                for (row, value) in problem.apply(lambda, false, &unit).into_iter().enumerate() {
                    // Determinants of large matrices leave the range of doubles.
                    dense[(row, column)] = value / problem.norm(lambda);
                }
            }
            let expected = dense.determinant();
            let log = expected.norm().ln() + size as f64 * problem.norm(lambda).ln();
            let turn = (factors.determinant.phase - expected.arg()) / (2.0 * PI);
            assert!((factors.determinant.log - log).abs() < 1e-11 * log.abs().max(1.0));
            assert!((turn - turn.round()).abs() < 1e-12);
            for transposed in [false, true] {
                let right = random::vector(9, size);
                let mut x = right.clone();
                factors.solve(transposed, &mut x);
                let mut residual = problem.apply(lambda, transposed, &x);
                residual.iter_mut().zip(&right).for_each(|(value, right)| *value -= right);
                assert!(norm(&residual) < 1e-14 * problem.norm(lambda) * norm(&x));
            }
        }
    }
}

#[test]
fn each_value_of_the_factors_has_one_place() {
    let analysis = Analysis::new(&problem(40)).unwrap();
    let mut targets: Vec<usize> = analysis.terms.iter().map(|term| term.target).collect();
    targets.sort_unstable();
    assert!(targets.windows(2).all(|pair| pair[0] < pair[1]));
    assert!(*targets.last().unwrap() < analysis.size);
    let columns: usize = analysis.supernodes.iter().map(|supernode| supernode.width()).sum();
    assert_eq!(columns, 40);
}
