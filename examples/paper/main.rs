//! The paper's figures and tables from the built-in scenes, with its claims beside the computed results:
//!
//! ```text
//! cargo run --release --example paper -- -o report
//! ```
//!
//! It shows uses of the libraries besides runs: eigenvalues, studies, their pictures, and a page with all of them.

mod branches;
mod claims;
mod couplings;
mod eigenvalues;
mod growth;
mod growth_claims;
mod limit_cycles;
mod measures;
mod modes;
mod motion;
mod perturbations;

use amontons::Error;
use amontons::scene::{Scene, named};
use amontons_analysis::assign::assign;
use amontons_analysis::study::{ObservationRequest, ObservationSettings, Watch};
use amontons_cli::exit;
use amontons_cli::interrupt::{self, Interrupted};
use amontons_cli::progress::Progress;
use amontons_cli::say;
use amontons_pictures::report::{Cell, Page, Section, Table, write};
use clap::Parser;
use std::fs;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

/// Compute the paper's figures and tables and compare its claims with the results, as one HTML page
#[derive(Parser)]
struct Arguments {
    /// Folder for the page, index.html; created if it does not exist
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

/// Function that computes a section; it returns `None` if the user has ended the work.
type Work = fn(Watch<'_>) -> Result<Option<Section>, Error>;

/// The sections, each with its approximate computing time in seconds.
const SECTIONS: [(&str, f64, Work); 5] = [
    ("Eigenvalues (Fig. 2, Tables 1 to 3)", 0.1, eigenvalues::section),
    ("Limit cycles over the slider's velocity (Fig. 3)", 2.0, limit_cycles::section),
    ("Growth of a small perturbation (Fig. 4)", 0.3, growth::section),
    ("Small and large perturbations (Fig. 5)", 1.5, perturbations::section),
    ("Branches over the friction coefficient (Figs. 6 and 7)", 30.0, branches::section),
];

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(exit::code(&*error))
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), Box<dyn std::error::Error>> {
    let folder = &arguments.output;
    fs::create_dir_all(folder).map_err(|error| Error::file(folder, &error))?;
    let path = folder.join("index.html");
    // An output folder that cannot be written is reported before the work.
    let pending = amontons_analysis::output::AtomicFile::create(&path)?;
    if let Some(partial) = pending.partial() {
        let _ = fs::remove_file(partial);
    }
    interrupt::listen();
    let bar = Progress::in_parts(SECTIONS[0].0);
    let all: f64 = SECTIONS.iter().map(|(_, share, _)| share).sum();
    let (mut done, mut sections, mut times) = (0.0, Vec::new(), Vec::new());
    for (heading, share, work) in SECTIONS {
        let progress = |part: f64| bar.set_part((done + share * part) / all);
        bar.say(heading);
        let start = Instant::now();
        let section = work(Watch { go_on: &interrupt::stopped, progress: &progress });
        let Some(section) = section? else {
            bar.finish();
            eprintln!("note: interrupted, so no page was written");
            return Err(Box::new(Interrupted));
        };
        done += share;
        times.push((heading, start.elapsed().as_secs_f64()));
        sections.push(Section { heading: heading.to_owned(), ..section });
    }
    bar.finish();
    sections.push(time(&times));
    let page = Page {
        title: "A lumped model with frictional contact: the paper and the computed results"
            .to_owned(),
        lead: LEAD.iter().map(|text| (*text).to_owned()).collect(),
        sections,
        footer: format!(
            "Made by amontons {} with: cargo run --release --example paper",
            env!("CARGO_PKG_VERSION")
        ),
        ..Page::default()
    };
    write(&page, &path)?;
    claims::print(&page);
    let total: f64 = times.iter().map(|(_, seconds)| seconds).sum();
    say!("{} in {total:.1} s", path.display());
    Ok(())
}

const LEAD: [&str; 2] = [
    "The paper studies two masses on springs that rub on a moving slider: the contact states in which modes grow, the \
     motion to which this growth leads, and the range of the friction coefficient in which rest and squeal coexist. \
     This page recomputes each figure and table from the built-in scenes set1 and set2 and compares each claim of the \
     paper with the computed result.",
    "Verdicts are computed: a claim holds if the computed numbers meet the condition that is stated with them. \
     Nothing is adjusted to make a claim hold. “About” in the paper is taken as within half of the last digit that it \
     prints, and zeros at the end of a whole number do not count as digits: about 168 Hz is 167.5 to \
     168.5 Hz, about 170 Hz is 165 to 175 Hz. Motions are exact between events; where the paper's own scheme is used, \
     the page says so.",
];

/// A built-in scene with other values and with the method and step of studies, and its observation settings.
fn scene(name: &str, values: &[(&str, f64)]) -> Result<(Scene, ObservationSettings), Error> {
    let mut scene = named(name)?.scene();
    for (name, value) in values {
        assign(&mut scene, name, *value)?;
    }
    let observation = ObservationSettings::paced(&mut scene, &ObservationRequest::default())?;
    Ok((scene, observation))
}

fn time(times: &[(&str, f64)]) -> Section {
    let row = |name: &str, seconds: f64| -> Vec<Cell> {
        vec![name.into(), format!("{seconds:.2}").into()]
    };
    let mut rows: Vec<Vec<Cell>> =
        times.iter().map(|(name, seconds)| row(name, *seconds)).collect();
    rows.push(row("all", times.iter().map(|(_, seconds)| seconds).sum()));
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    Section {
        heading: "Time".to_owned(),
        tables: vec![Table {
            caption: format!("Computing time on {cores} cores of the machine that made this page"),
            head: vec!["section".to_owned(), "seconds".to_owned()],
            rows,
        }],
        ..Section::default()
    }
}
