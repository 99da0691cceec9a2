//! The cost of squeal of a reduced finite-element structure: `cargo bench --bench superelement` prints one table.
//!
//! A brake pad with 300 degrees of freedom and 96 contacts that share masses squeals from its equilibrium in sliding, until contacts
//! stick and open. The products alone are those with K and M⁻¹ that a step of the paper's scheme, or each power of a series of
//! exact motion, cannot do without; a series is counted with as many powers as its undamped highest mode takes. Where a C compiler
//! is found, the paper's scheme in plain C (superelement.c) takes the same steps.

#[path = "../tests/support/brake_pad.rs"]
mod brake_pad;

use amontons::contact::ContactState;
use amontons::integrator::{Inputs, Method, Motion, choose};
use amontons::model::{LumpedModel, SparseMatrix};
use amontons::stability::{Spectrum, critical_step};
use brake_pad::{Size, VELOCITY, pad};
use nalgebra::DMatrix;
use std::hint::black_box;
use std::process::Command;
use std::time::Instant;

const FRICTION: f64 = 0.5;
const SCHEME_STEP: f64 = 5e-7;
const EXACT_STEP: f64 = 1e-5;
/// End of the first stretch, in which all contacts slide, and of the second one, in which they stick and open, s.
const STRETCHES: [f64; 2] = [1.2e-3, 2.6e-3];

fn main() {
    let size = Size::LARGE;
    let model = pad(size, FRICTION);
    let equilibrium =
        model.equilibrium(&|contact| contact.to_string()).expect("all contacts press");
    let (spectrum, seconds) = timed(|| {
        Spectrum::of(model.linear_about(&equilibrium), &vec![ContactState::Slide; size.contacts()])
    });
    let spectrum = spectrum.expect("eigenvalues");
    let growing = spectrum.fastest_growing().expect("a motion");
    println!("{} degrees of freedom, {} contacts", model.dofs(), size.contacts());
    println!(
        "eigenvalues of one state   {:9.0} ms   growth {:.0} /s at {:.0} Hz",
        1e3 * seconds,
        growing.re,
        growing.im / std::f64::consts::TAU
    );
    let mut gyroscopic = model.clone();
    let around =
        (0..size.contacts()).flat_map(|i| [(3 * i, 3 * i + 2, 0.1), (3 * i + 2, 3 * i, -0.1)]);
    gyroscopic.dampers = SparseMatrix::from_entries(model.dofs(), around.collect());
    let (damped, seconds) = timed(|| {
        Spectrum::of(
            gyroscopic.linear_about(&equilibrium),
            &vec![ContactState::Slide; size.contacts()],
        )
    });
    damped.expect("eigenvalues");
    println!("   with gyroscopic forces  {:9.0} ms", 1e3 * seconds);
    let (critical, seconds) = timed(|| critical_step(&model).expect("a step"));
    println!("critical step              {:9.0} ms   {critical}", 1e3 * seconds);

    let product = products_alone(&model);
    let highest = spectrum.oscillating.last().map_or(0.0, |mode| mode.im);
    let mut velocities = vec![0.0; model.dofs()];
    velocities[3 * size.contacts()..].fill(1e-4);
    let start = Motion::new(
        equilibrium.displacement,
        velocities,
        vec![ContactState::Slide; size.contacts()],
    );
    let inputs = Inputs::uniform(model.load.clone(), size.contacts(), VELOCITY, FRICTION);
    let mut states = Vec::new();
    println!("a product with K and with M⁻¹ {:6.1} µs", 1e6 * product);
    println!("                                   time s /products   steps  events");
    for (method, step) in
        [(Method::ForwardIncrement, SCHEME_STEP), (Method::EventDriven, EXACT_STEP)]
    {
        let mut integrator = choose(&model, method).expect("an integrator");
        let (mut motion, mut at) = (start.clone(), 0.0);
        for (end, name) in STRETCHES.into_iter().zip(["all slide", "stick and open"]) {
            let count = ((end - at) / step).round() as u64;
            let before = motion.statistics;
            let (advanced, seconds) =
                timed(|| integrator.advance(&mut motion, &inputs, step, count));
            advanced.expect("a motion");
            let events = motion.statistics.events - before.events;
            let products = match method {
                Method::ForwardIncrement => count as f64,
                // Between events that follow each other at once a series covers less, and has fewer powers.
                Method::EventDriven => {
                    let length = (end - at) / (count + events) as f64;
                    (count + events) as f64 * powers(highest * length)
                }
            };
            println!(
                "{method:18} {name:14} {seconds:7.3} {:9.2} {count:7} {events:7}",
                seconds / (products * product)
            );
            if method == Method::ForwardIncrement {
                states.push((count, seconds, motion.velocity.clone()));
            }
            at = end;
        }
    }
    for flags in ["-O3", "-O3 -march=native -ffast-math"] {
        compare_with_c(&model, &start, flags, &states);
    }
}

/// The result and its seconds of the processor, which other programs do not lengthen; by the clock where the system does not count
/// them.
fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let clock = Instant::now();
    let before = processor();
    let result = work();
    let passed = clock.elapsed().as_secs_f64();
    let used = before.zip(processor()).map(|(before, after)| after - before);
    (result, used.unwrap_or(passed))
}

fn processor() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/schedstat").ok()?;
    text.split(' ').next()?.parse::<f64>().ok().map(|nanoseconds| 1e-9 * nanoseconds)
}

/// Seconds of a product with K and one with M⁻¹, the mean of many.
fn products_alone(model: &LumpedModel) -> f64 {
    let inverse = sparse(&dense(&model.mass).try_inverse().expect("masses"));
    let mut vector = vec![1.0; model.dofs()];
    let mut forces = vector.clone();
    const ROUNDS: u32 = 5000;
    let ((), seconds) = timed(|| {
        for _ in 0..ROUNDS {
            model.stiffness.each_product(black_box(&vector), |row, value| forces[row] = value);
            inverse.each_product(black_box(&forces), |row, value| {
                vector[row] = 1.0 + 1e-30 * value;
            });
        }
    });
    seconds / f64::from(ROUNDS)
}

/// Number of powers of an oscillation of this angle (rad) down to rounding.
fn powers(angle: f64) -> f64 {
    let (mut term, mut count) = (1.0, 0.0);
    while term > 0.5 * f64::EPSILON && count < 27.0 {
        count += 1.0;
        term *= angle / count;
    }
    count
}

fn dense(matrix: &SparseMatrix) -> DMatrix<f64> {
    DMatrix::from_fn(matrix.rows(), matrix.rows(), |i, j| matrix.get(i, j))
}

fn sparse(matrix: &DMatrix<f64>) -> SparseMatrix {
    let places = (0..matrix.nrows()).flat_map(|i| (0..matrix.nrows()).map(move |j| (i, j)));
    SparseMatrix::from_entries(
        matrix.nrows(),
        places.map(|(i, j)| (i, j, matrix[(i, j)])).collect(),
    )
}

/// Runs the scheme in C over the same stretches, each from the start.
fn compare_with_c(model: &LumpedModel, start: &Motion, flags: &str, ours: &[(u64, f64, Vec<f64>)]) {
    let folder = std::env::temp_dir().join("amontons-superelement");
    std::fs::create_dir_all(&folder).expect("a folder");
    let (program, file) = (folder.join("superelement"), folder.join("model.bin"));
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/superelement.c");
    let compiled = Command::new("cc")
        .args(flags.split(' '))
        .arg("-o")
        .arg(&program)
        .arg(source)
        .arg("-lm")
        .status();
    if !compiled.is_ok_and(|status| status.success()) {
        println!("plain C: no compiler cc");
        return;
    }
    let (n, m) = (model.dofs(), model.contacts.len());
    let (mass, stiffness) = (dense(&model.mass), dense(&model.stiffness));
    let inverse = mass.clone().try_inverse().expect("masses");
    let damping = &mass * model.damping.alpha + &stiffness * model.damping.beta;
    let mut rows = DMatrix::zeros(2 * m, n);
    for (i, contact) in model.contacts.iter().enumerate() {
        contact.normal.0.iter().for_each(|&(dof, value)| rows[(2 * i, dof)] = value);
        contact.tangent.0.iter().for_each(|&(dof, value)| rows[(2 * i + 1, dof)] = value);
    }
    let response = &inverse * rows.transpose();
    let coupling = &rows * &response;
    let (mut steps, mut seconds) = (0, 0.0);
    for (stretch, (count, own, velocity)) in ours.iter().enumerate() {
        steps += count;
        let head = [n as f64, m as f64, steps as f64, SCHEME_STEP, FRICTION, VELOCITY];
        let mut numbers = head.to_vec();
        for matrix in [&stiffness, &damping, &inverse, &rows, &response, &coupling] {
            numbers.extend(matrix.transpose().iter());
        }
        numbers.extend(model.load.iter().chain(&start.displacement).chain(&start.velocity));
        let bytes: Vec<u8> = numbers.iter().flat_map(|value| value.to_le_bytes()).collect();
        std::fs::write(&file, bytes).expect("a file");
        let output = Command::new(&program).arg(&file).output().expect("the program runs");
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        let mut values = text.split_whitespace().map(|word| word.parse::<f64>().expect("a number"));
        let total = values.next().expect("seconds");
        let sweeps = values.next().expect("a count");
        let most = velocity.iter().fold(0.0, |most, v| f64::max(most, v.abs()));
        let apart = values.zip(velocity).fold(0.0, |most, (a, b)| f64::max(most, (a - b).abs()));
        println!(
            "plain C, {flags}: stretch {}: {:.3} s, ours {own:.3} s, ratio {:.2}; {sweeps} iterations; velocities apart by {:.1e}",
            stretch + 1,
            total - seconds,
            (total - seconds) / own,
            apart / most
        );
        seconds = total;
    }
}
