//! Times of the eigenvalues of a quadratic problem and of their count, and their errors:
//! `quadratic MASS DAMPING STIFFNESS RE0 RE1 IM0 IM1 [bounds] [alone] [SHIFT…]`.
//!
//! A shift is an imaginary part; `bounds` computes left vectors as well, and `alone` uses one thread.

use amontons_analysis::stability::on_this_thread;
use amontons_analysis::watch::Watch;
use amontons_matrices::{Location, open};
use amontons_structures::quadratic::{Mode, Options, Rectangle, count, eigenvalues};
use amontons_structures::{Quadratic, Sparse};
use faer::c64;
use std::time::Instant;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let work = || run(&arguments).unwrap_or_else(|error| eprintln!("{error}"));
    if arguments.iter().any(|word| word == "alone") { on_this_thread(work) } else { work() }
}

fn run(arguments: &[String]) -> Result<(), Box<dyn std::error::Error>> {
    let [mass, damping, stiffness, re0, re1, im0, im1, rest @ ..] = arguments else {
        return Err(
            "usage: quadratic MASS DAMPING STIFFNESS RE0 RE1 IM0 IM1 [bounds] [alone] [SHIFT…]"
                .into(),
        );
    };
    let read = |name: &String| -> Result<Sparse, Box<dyn std::error::Error>> {
        Ok(Sparse::new(&open(&name.parse::<Location>()?)?)?)
    };
    let problem = Quadratic::new(read(mass)?, read(damping)?, read(stiffness)?)?;
    let rectangle = Rectangle::new([re0.parse()?, re1.parse()?], [im0.parse()?, im1.parse()?])?;
    let shifts = rest.iter().filter_map(|word| word.parse().ok()).map(|im| c64::new(0.0, im));
    let options = Options {
        bounds: rest.iter().any(|word| word == "bounds"),
        shifts: shifts.collect(),
        ..Options::default()
    };
    let start = Instant::now();
    let found = eigenvalues(&problem, &rectangle, &options, Watch::IDLE)?;
    println!(
        "search: {:.2} s, {} inside of {} found, {} factorisations, {} solutions",
        start.elapsed().as_secs_f64(),
        found.inside().count(),
        found.modes.len(),
        found.factorizations,
        found.solves
    );
    for disc in &found.trusted {
        println!("  disc about {:.1} of radius {:.1}", disc.centre, disc.radius);
    }
    let largest = |value: fn(&Mode) -> f64| found.inside().map(value).fold(0.0, f64::max);
    let bound = largest(|mode| mode.bound.unwrap_or(f64::NAN) / mode.eigenvalue.norm());
    println!("errors: backward {:.1e}, relative bound {bound:.1e}", largest(|mode| mode.backward));
    let start = Instant::now();
    let count = count(&problem, &found.edges, &found.found(), &found.rough, Watch::IDLE)?;
    println!("count: {:.2} s, {count:?}", start.elapsed().as_secs_f64());
    Ok(())
}
