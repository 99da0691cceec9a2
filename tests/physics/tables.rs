//! The paper's printed numbers: Tables 2 and 3, and the six frequencies of Fig. 2(c), from the
//! reduced matrices by eqs. (4)–(6) as they stand.

use crate::quadratic;
use amontons::contact::{ContactState, JoinedStates, all_states};
use amontons::model::LumpedModel;
use amontons::scene::builtin;
use nalgebra::Complex;
use std::f64::consts::TAU;

/// Half a unit of the last printed digit is 0.005 Hz; seven of the 192 printed numbers miss that by
/// up to 0.0005 Hz.
const TOLERANCE_HZ: f64 = 0.006;

/// The eigenvalues with positive imaginary part, Hz, by frequency.
fn eigenvalues_hz(model: &LumpedModel, states: &[ContactState], mu: f64) -> Vec<Complex<f64>> {
    let values = quadratic::eigenvalues(model, states, mu);
    let mut upper: Vec<_> = values.iter().map(|v| v / TAU).filter(|v| v.im > 0.0).collect();
    upper.sort_by(|a, b| a.im.total_cmp(&b.im));
    upper
}

/// Every printed eigenvalue against the nearest of its state, none used twice.
fn assert_table(scene: &str, table: &str) {
    let table: serde_json::Value = serde_json::from_str(table).unwrap();
    let model = LumpedModel::from(&builtin(scene).unwrap().scene());
    let mut compared = 0;
    for states in all_states(2) {
        let name = JoinedStates(&states).to_string();
        let mut found = eigenvalues_hz(&model, &states, 1.96);
        let printed = table["states"][&name].as_array().unwrap();
        assert_eq!(found.len(), printed.len(), "{name}");
        for pair in printed {
            let (re, im) = (pair[0].as_f64().unwrap(), pair[1].as_f64().unwrap());
            let misses = found.iter().map(|v| (v.re - re).abs().max((v.im - im).abs()));
            let (nearest, miss) = misses.enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
            assert!(miss < TOLERANCE_HZ, "{name}: {re} ± {im}i is missed by {miss} Hz");
            found.remove(nearest);
            compared += 1;
        }
    }
    assert_eq!(compared, 96);
}

#[test]
fn all_96_eigenvalues_of_table_2_are_reproduced() {
    assert_table("set1", include_str!("../data/table2.json"));
}

#[test]
fn all_96_eigenvalues_of_table_3_are_reproduced() {
    assert_table("set2", include_str!("../data/table3.json"));
}

#[test]
fn the_six_real_modes_have_the_frequencies_of_figure_2c() {
    let mut model = LumpedModel::from(&builtin("set1").unwrap().scene());
    model.damping.beta = 0.0;
    let found = eigenvalues_hz(&model, &[ContactState::Slide; 2], 0.0);
    let printed = [34.00, 65.99, 163.90, 186.56, 215.24, 225.79];
    assert_eq!(found.len(), printed.len());
    for (found, printed) in found.iter().zip(printed) {
        assert!((found.im - printed).abs() < 0.005, "{printed}: {found}");
    }
}
