//! Circulatory and gyroscopic forces: K and D that are not symmetric, against closed forms.
//!
//! Two equal masses of 1 kg, whose displacements are the parts of a complex number: with a gyroscopic g and a circulatory p
//! z̈ + i g ż + (k − i p) z = 0, so z = exp(λ t) with λ² + i g λ + k − i p = 0.

use amontons::contact::ContactLaw;
use amontons::integrator::{Inputs, Ledger, Method, Motion, Records, choose, choose_recording};
use amontons::model::{Damping, LumpedModel, SparseMatrix};
use amontons::stability::{Spectrum, critical_step};
use nalgebra::Complex;

const K: f64 = 1e6;
const LEDGER: Records = Records { ledger: true, visits: false };

fn model(gyroscopic: f64, circulatory: f64) -> LumpedModel {
    let matrix = |diagonal: f64, beside: f64| {
        let entries = vec![(0, 0, diagonal), (1, 1, diagonal), (0, 1, beside), (1, 0, -beside)];
        SparseMatrix::from_entries(2, entries)
    };
    LumpedModel {
        mass: SparseMatrix::diagonal(&[1.0, 1.0]),
        stiffness: matrix(K, circulatory),
        damping: Damping::default(),
        dampers: matrix(0.0, -gyroscopic),
        load: vec![0.0; 2],
        contacts: Vec::new(),
        law: ContactLaw::default(),
    }
}

/// The two λ of the complex equation.
fn rates(gyroscopic: f64, circulatory: f64) -> [Complex<f64>; 2] {
    let half = Complex::new(0.0, -0.5 * gyroscopic);
    let root = (half * half - Complex::new(K, -circulatory)).sqrt();
    [half + root, half - root]
}

const CASES: [(f64, f64); 3] = [(300.0, 0.0), (0.0, 2e4), (300.0, 2e4)];

#[test]
fn eigenvalues_are_those_of_the_complex_equation() {
    for (g, p) in CASES {
        let model = model(g, p);
        let found = Spectrum::of(model.linear().unwrap(), &[]).unwrap().oscillating;
        let mut expected = rates(g, p).map(|rate| Complex::new(rate.re, rate.im.abs()));
        expected.sort_by(|a, b| a.im.total_cmp(&b.im).then(a.re.total_cmp(&b.re)));
        assert_eq!(found.len(), 2);
        for rate in expected {
            assert!(
                found.iter().any(|one| (one - rate).norm() < 1e-9 * rate.norm()),
                "{found:?} {rate}"
            );
        }
    }
}

#[test]
fn event_driven_motion_follows_the_exponential() {
    for (g, p) in CASES {
        let model = model(g, p);
        for rate in rates(g, p) {
            let mut motion =
                Motion::new(vec![1e-3, 0.0], vec![1e-3 * rate.re, 1e-3 * rate.im], Vec::new());
            let mut integrator = choose(&model, Method::EventDriven).unwrap();
            let inputs = Inputs::uniform(vec![0.0; 2], 0, 0.0, 0.0);
            integrator.advance(&mut motion, &inputs, 1e-4, 100).unwrap();
            let expected = (rate * 0.01).exp() * 1e-3;
            let found = Complex::new(motion.displacement[0], motion.displacement[1]);
            assert!(
                (found - expected).norm() < 1e-12 * expected.norm(),
                "{g} {p}: {found} {expected}"
            );
        }
    }
}

/// The largest growth of the scheme in a step, ln |z| / h, from the motion of many steps.
fn growth_of_scheme(model: &LumpedModel, step: f64) -> f64 {
    let mut integrator = choose(model, Method::ForwardIncrement).unwrap();
    let inputs = Inputs::uniform(vec![0.0; 2], 0, 0.0, 0.0);
    let mut motion = Motion::new(vec![1e-3, 3e-4], vec![0.1, -0.7], Vec::new());
    let size = |motion: &Motion| {
        let parts = motion
            .displacement
            .iter()
            .map(|x| K * x * x)
            .chain(motion.velocity.iter().map(|v| v * v));
        parts.sum::<f64>().sqrt()
    };
    // The slower mode has faded beside the faster one.
    integrator.advance(&mut motion, &inputs, step, 20_000).unwrap();
    let before = size(&motion);
    integrator.advance(&mut motion, &inputs, step, 20_000).unwrap();
    (size(&motion) / before).ln() / (step * 20_000.0)
}

#[test]
fn a_critical_step_admits_the_growth_of_the_physics_and_a_thousandth_of_the_frequency() {
    for (g, p) in CASES {
        let model = model(g, p);
        let critical = critical_step(&model).unwrap().step;
        let admitted = rates(g, p).map(|rate| rate.re.max(0.0) + 1e-3 * rate.norm());
        let [least, most] = [f64::min, f64::max].map(|of| of(admitted[0], admitted[1]));
        let below = growth_of_scheme(&model, 0.9 * critical);
        let above = growth_of_scheme(&model, 1.3 * critical);
        assert!(below < most, "{g} {p}: {below} with {critical} s, where {most} is admitted");
        assert!(above > least, "{g} {p}: {above} with {critical} s, where {least} is admitted");
    }
}

#[test]
fn gyroscopic_forces_do_no_work_and_circulatory_ones_have_no_ledger() {
    let refused = choose_recording(&model(0.0, 2e4), Method::EventDriven, LEDGER).err().unwrap();
    assert!(refused.to_string().contains("circulatory"), "{refused}");
    let mut model = model(300.0, 0.0);
    model.damping.alpha = 5.0;
    let reference = model.equilibrium(&|_| String::new()).unwrap();
    for (method, step, tolerance) in
        [(Method::EventDriven, 1e-4, 1e-12), (Method::ForwardIncrement, 1e-7, 1e-3)]
    {
        let mut motion = Motion::new(vec![1e-3, 0.0], vec![0.0, 0.3], Vec::new());
        motion.ledger = Some(Ledger::new(&model, &reference, &motion));
        let start = motion.ledger.as_ref().unwrap().energy(&model, &motion);
        let mut integrator = choose_recording(&model, method, LEDGER).unwrap();
        let inputs = Inputs::uniform(vec![0.0; 2], 0, 0.0, 0.0);
        integrator.advance(&mut motion, &inputs, step, (0.01 / step).round() as u64).unwrap();
        let energy = motion.ledger.as_ref().unwrap().energy(&model, &motion);
        let most = start.kinetic + start.elastic;
        assert!(energy.residual.abs() < tolerance * most, "{energy:?}");
        assert!(energy.damping > 0.01 * most, "{energy:?}");
    }
}
