//! What all eigenvalues of a brake cost: `cargo bench --bench matrices`.
//!
//! SciPy (`matrices_scipy.py`, in the Python environment of the tests) writes the matrices of a brake of 5,148 degrees of freedom
//! as a MATLAB file. Both sides find the eigenvalues nearest to the same shifts, one thread each; the run fails where one that
//! SciPy finds differs by more than 1e-9 of the shift. Then all eigenvalues of a rectangle are found and counted.

use amontons_analysis::stability::on_this_thread;
use amontons_analysis::watch::Watch;
use amontons_matrices::{Location, open};
use amontons_structures::quadratic::{Eigenvalues, Options, Rectangle, count, eigenvalues};
use amontons_structures::{Quadratic, Sparse};
use faer::c64;
use serde_json::Value;
use std::f64::consts::TAU;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

#[path = "../../../tests/support/python/mod.rs"]
mod python;

/// The frequencies of the shifts, Hz.
const SHIFTS: [f64; 2] = [12000.0, 30000.0];
/// Eigenvalues that SciPy finds about each shift.
const COUNT: usize = 30;
/// How far an eigenvalue may be from SciPy's, in parts of the largest shift.
const TOLERANCE: f64 = 1e-9;

fn main() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    scipy(folder, &["make".into()]);
    let begun = Instant::now();
    let matrix = |name: &str| {
        let location = Location { path: folder.join("brake.mat"), name: Some(name.to_owned()) };
        Sparse::new(&open(&location).expect("SciPy has written it")).expect("it is square")
    };
    let damping = matrix("D").sum(1.0, &matrix("G"), 1.0);
    let problem = Quadratic::new(matrix("M"), damping, matrix("K")).expect("all are of one size");
    println!("{} degrees of freedom, read in {:.2} s", problem.size(), since(begun));

    let rectangle =
        Rectangle::new([-2000.0, 500.0], [TAU * 500.0, TAU * 20000.0]).expect("it is one");
    let shifts: Vec<c64> = SHIFTS.iter().map(|shift| c64::new(0.0, TAU * shift)).collect();
    let options = Options { shifts: shifts.clone(), bounds: false, ..Options::default() };
    let begun = Instant::now();
    let found = on_this_thread(|| eigenvalues(&problem, &rectangle, &options, Watch::IDLE))
        .expect("the shifts are no eigenvalues");
    let seconds = since(begun);
    compare(folder, &found, &shifts, seconds);

    let begun = Instant::now();
    let found = eigenvalues(&problem, &rectangle, &Options::default(), Watch::IDLE)
        .expect("the rectangle can be searched");
    let worst = found.inside().map(|mode| mode.backward).fold(0.0, f64::max);
    println!(
        "all {} in the rectangle, with bounds: {:.2} s, {} factorisations, backward errors up to {worst:.0e}",
        found.inside().count(),
        since(begun),
        found.factorizations
    );
    let begun = Instant::now();
    let counted = count(&problem, &rectangle, &found.found(), &found.rough, Watch::IDLE)
        .expect("nothing ends it");
    println!(
        "count: {:.2} s, {} factorisations, {:?}",
        since(begun),
        counted.factorizations,
        counted.outcome
    );
}

fn since(begun: Instant) -> f64 {
    begun.elapsed().as_secs_f64()
}

fn compare(folder: &Path, found: &Eigenvalues, shifts: &[c64], seconds: f64) {
    let mut words = vec!["solve".to_owned(), COUNT.to_string()];
    words.extend(shifts.iter().flat_map(|shift| [shift.re.to_string(), shift.im.to_string()]));
    let answer = scipy(folder, &words);
    let answer: Value = serde_json::from_slice(&answer).expect("it answers in JSON");
    let mut compared = 0;
    for value in answer["values"].as_array().expect("a list") {
        let part = |at: usize| value[at].as_f64().expect("a number");
        let value = c64::new(part(0), part(1));
        let is_trusted =
            found.trusted.iter().any(|disc| (value - disc.centre).norm() < disc.radius);
        if is_trusted {
            let distances = found.modes.iter().map(|mode| (mode.eigenvalue - value).norm());
            let distance = distances.fold(f64::INFINITY, f64::min);
            assert!(distance <= TOLERANCE * TAU * SHIFTS[1], "{value} is {distance} away");
            compared += 1;
        }
    }
    let times = answer["seconds"].as_object().expect("a time for each order");
    let best = times.values().filter_map(Value::as_f64).fold(f64::INFINITY, f64::min);
    println!(
        "{} eigenvalues about {} shifts: {seconds:.2} s; SciPy, {COUNT} about each: {best:.2} s, {:.1} times as long ({compared} compared)",
        found.modes.len(),
        shifts.len(),
        best / seconds
    );
}

/// Runs `matrices_scipy.py` with one thread.
fn scipy(folder: &Path, words: &[String]) -> Vec<u8> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/matrices_scipy.py");
    let (work, rest) = words.split_first().expect("there is a word");
    let mut command = Command::new(python::interpreter());
    command.arg("-B").arg(script).arg(work).arg(folder).args(rest);
    for threads in ["OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"] {
        command.env(threads, "1");
    }
    let output = command.output().expect("the interpreter was just made");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    output.stdout
}
