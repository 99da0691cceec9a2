//! The paper's scheme as a plain loop in C with full matrices, the one of `crates/export/benches/dense_loop.c`,
//! compiled here.

use crate::peer::{Candidate, Outcome, Stopwatch};
use crate::scenes::{CONTACTS, DOFS, Problem, ROWS};
use libloading::Library;
use std::array::from_fn;
use std::env::consts::DLL_SUFFIX;
use std::path::Path;
use std::process::Command;
use std::rc::Rc;

pub const WHO: &str = "plain C, paper's scheme";

/// `struct problem` of `dense_loop.c`.
#[repr(C)]
struct CProblem {
    mass: [f64; DOFS],
    stiffness: [[f64; DOFS]; DOFS],
    damping: [[f64; DOFS]; DOFS],
    force: [f64; DOFS],
    slider_velocity: f64,
    friction: f64,
    step: f64,
}

/// The loop with `cc -O3`, and with `-march=native` besides, with so many steps a row each.
///
/// # Errors
/// No C compiler.
pub fn candidates(
    problem: &Problem,
    steps_a_row: &[u32],
    folder: &Path,
) -> Result<Vec<Candidate>, String> {
    assert!(problem.tangent == [2, 6] && problem.normal == [3, 7], "dense_loop.c has these");
    let mut candidates = Vec::new();
    for (name, flags) in [("-O3", &["-O3"][..]), ("-O3 -march=native", &["-O3", "-march=native"])] {
        let library = Rc::new(compile(flags, &folder.join(name.replace(' ', "")))?);
        for &steps in steps_a_row {
            let (library, problem) = (Rc::clone(&library), problem.clone());
            let setting = format!("{name}, h = {:.1e} s", 1e-3 / f64::from(steps));
            let run = Box::new(move || run(&library, &problem, steps));
            candidates.push(Candidate { who: WHO, setting, run });
        }
    }
    Ok(candidates)
}

fn compile(flags: &[&str], library: &Path) -> Result<Library, String> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../crates/export/benches/dense_loop.c");
    let library = library.with_extension(&DLL_SUFFIX[1..]);
    let mut compiler = Command::new("cc");
    compiler.args(flags).args(["-fPIC", "-shared", "-o"]).args([&library, &source]);
    match compiler.status() {
        Ok(status) if status.success() => {}
        Ok(_) => return Err(format!("cc does not compile {}", source.display())),
        Err(error) => return Err(format!("no C compiler as cc: {error}")),
    }
    // SAFETY: loading it runs no code of its own.
    unsafe { Library::new(&library) }.map_err(|error| error.to_string())
}

fn run(library: &Library, problem: &Problem, steps: u32) -> Outcome {
    type Function = unsafe extern "C" fn(
        &CProblem,
        &mut [f64; DOFS],
        &mut [f64; DOFS],
        &mut [i32; CONTACTS],
        u64,
    ) -> u64;
    // SAFETY: this is the function's type in the C file.
    let function = unsafe { library.get::<Function>(b"dense_loop") }.expect("it is in there");
    let damping = |i: usize, j: usize| {
        let mass = if i == j { problem.mass[i] } else { 0.0 };
        problem.alpha * mass + problem.beta * problem.stiffness[i][j]
    };
    let c_problem = CProblem {
        mass: problem.mass,
        stiffness: problem.stiffness,
        damping: from_fn(|i| from_fn(|j| damping(i, j))),
        force: problem.force,
        slider_velocity: problem.slider_velocity,
        friction: problem.friction,
        step: 1e-3 / f64::from(steps),
    };
    let (mut x, mut v) = (problem.displacement, problem.velocity);
    let mut states = [1; CONTACTS]; // Sl.
    let mut events = 0;
    let mut displacements = Vec::with_capacity(ROWS * DOFS);
    let mut watch = Stopwatch::start();
    for row in 1..=ROWS {
        // SAFETY: it reads the problem, and reads and writes the vectors and states.
        events += unsafe { function(&c_problem, &mut x, &mut v, &mut states, steps.into()) };
        displacements.extend_from_slice(&x);
        watch.row(row);
    }
    Outcome { displacements, events: Some(events), touch_downs: None, slices: watch.slices() }
}
