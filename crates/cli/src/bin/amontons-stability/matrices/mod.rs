//! `amontons-stability matrices`.

mod chart;
mod found;
mod table;

use crate::Failure;
use crate::arguments::Matrices;
use amontons_analysis::watch::Watch;
use amontons_cli::arguments::Format;
use amontons_cli::interrupt::watched;
use amontons_cli::progress::Progress;
use amontons_pictures::picture;
use amontons_structures::family::{Family, Follower};
use amontons_structures::quadratic::{
    Eigenvalues, Mode, Options, Outcome, Rectangle, count, eigenvalues, eigenvalues_again,
};
use found::{Found, Value};
use std::f64::consts::TAU;
use std::io::Write;
use std::time::{Duration, Instant};

/// The share of the work at one value that the search takes.
const SEARCH: f64 = 0.5;

pub fn run(arguments: &Matrices, out: &mut dyn Write) -> Result<(), Failure> {
    arguments.plot.as_deref().map_or(Ok(()), picture::check_name)?;
    let family = family(arguments)?;
    let [lowest, highest] = arguments.frequency;
    let rectangle = Rectangle::new(arguments.growth, [TAU * lowest, TAU * highest])?;
    let loaded = family.load()?;
    let progress = Progress::in_uneven_parts("the search for eigenvalues");
    let (mut searched, mut counted) = (Work::default(), Work::default());
    let mut follower = Follower::default();
    let mut size = 0;
    let mut look = |place: usize, watch: Watch<'_>| -> Result<Value, Failure> {
        let problem = loaded.member(place)?;
        size = problem.size();
        let first = |part: f64| (watch.progress)(SEARCH * part);
        let second = |part: f64| (watch.progress)(SEARCH + (1.0 - SEARCH) * part);
        let watch_search = Watch { progress: &first, ..watch };
        let watch_count = Watch { progress: &second, ..watch };
        let options = Options::default();
        let begun = Instant::now();
        let mut found = eigenvalues(&problem, &rectangle, &options, watch_search)?;
        searched.add(begun, found.factorizations);
        let mut counting = |found: &Eigenvalues| {
            let begun = Instant::now();
            let count = count(&problem, &rectangle, &found.found(), &found.rough, watch_count)?;
            counted.add(begun, count.factorizations);
            Ok::<_, Failure>(count)
        };
        let mut count = counting(&found)?;
        if matches!(count.outcome, Outcome::Missing(_)) {
            let begun = Instant::now();
            found = eigenvalues_again(&problem, &found, &options, watch_search)?;
            searched.add(begun, found.factorizations);
            count = counting(&found)?;
        }
        let modes: Vec<Mode> = found.inside().cloned().collect();
        let value = family.parameter().map(|parameter| parameter.values[place]);
        let value = Value::new(value, &modes, &count);
        follower.push(modes, &problem.masses());
        Ok(value)
    };
    #[allow(clippy::cast_precision_loss)]
    let values = watched(&progress, |watch| -> Result<Vec<Value>, Failure> {
        let values = family.count() as f64;
        let at = |place: usize| {
            let shown = |part: f64| (watch.progress)((place as f64 + part) / values);
            look(place, Watch { progress: &shown, ..watch })
        };
        (0..family.count()).map(at).collect()
    })?;
    eprintln!("note: {searched} to find the modes, {counted} to count them");
    let asked = [arguments.growth, arguments.frequency];
    let found = Found::new(&family, size, asked, values, &follower.finish());
    match arguments.format {
        Format::Table => table::print(&found, out)?,
        Format::Csv => table::print_csv(&found, out)?,
        Format::Json => writeln!(out, "{}", found.json())?,
    }
    if let Some(path) = &arguments.plot {
        chart::chart(&found).write(path)?;
    }
    if found.is_complete() { Ok(()) } else { Err(Failure::NotShown) }
}

/// The structure of the command line.
fn family(arguments: &Matrices) -> Result<Family, Failure> {
    let Some(path) = &arguments.description else {
        if arguments.mass.is_empty() || arguments.stiffness.is_empty() {
            return Err(Failure::Usage(
                "give a file that describes the structure, or its matrices with --mass and --stiffness".into(),
            ));
        }
        if arguments.parameter.is_some() {
            return Err(Failure::Usage(
                "--parameter needs a file that describes how the matrices depend on it".into(),
            ));
        }
        let (mass, damping) = (&arguments.mass, &arguments.damping);
        let freedoms = arguments.freedoms.clone();
        return Ok(Family::of_files(mass, damping, &arguments.stiffness, freedoms));
    };
    let mut family = Family::read(path)?;
    if let Some((name, values)) = &arguments.parameter {
        family.set_values(name, values.0.clone())?;
    }
    Ok(family)
}

/// Factorisations, and the time of the work that they belong to.
#[derive(Default)]
struct Work {
    factorizations: usize,
    time: Duration,
}

impl Work {
    fn add(&mut self, begun: Instant, factorizations: usize) {
        self.time += begun.elapsed();
        self.factorizations += factorizations;
    }
}

impl std::fmt::Display for Work {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:.2} s with {} factorisations", self.time.as_secs_f64(), self.factorizations)
    }
}
