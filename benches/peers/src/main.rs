//! What accuracy costs, with Amontons and with others, on the same problems: one simulated second of
//! three scenes, error against time. From the root of the repository:
//!
//! ```sh
//! cargo run --release --manifest-path benches/peers/Cargo.toml
//! ```
//!
//! Errors are relative rms of the eight displacements in rows a millisecond apart, against our
//! event-driven integrator at half of the step that is timed. M, C, K, load, contacts, start and
//! equilibrium are those of our model for every peer. Times are for one thread, without set-up; the runs
//! in this program take turns, after one that warms up, and the shortest of each slice counts. SciPy and
//! Siconos time themselves in the same way. Read the ratios: they carry over to another machine better than times do.

mod dense;
mod diffsol;
mod ours;
mod peer;
mod picture;
mod python;
mod scenes;
mod table;

use clap::{Parser, ValueEnum};
use peer::{Candidate, Outcome};
use scenes::{Case, Problem};
use std::path::{Path, PathBuf};
use std::{env, fs};
use table::Row;

/// Turns of a run: as many as fit into so many seconds, but at most so many. One that takes longer has its
/// first run for its time.
const BUDGET: f64 = 1.0;
const MOST_TURNS: usize = 30;

const NOTES: &str = "\
Error: relative rms of the displacements. Events: changes of a contact's state. ms/s: per simulated second.
To ours: against our quickest run that is as accurate. Set-up is left out: equilibrium, matrices, imports.
C, diffsol and SciPy have springs and dampers as explicit forces; Siconos in its implicit matrices.
SciPy and Siconos are driven from Python, whose own time is inside: all evaluations; two calls a step.
Tuned: diffsol and SciPy with absolute tolerances of the motion's size (all but their default rows); SciPy
with max_step short enough to see every event; C for this machine's processor (-march=native).";

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Peer {
    /// The paper's scheme as a plain loop in C.
    C,
    /// The Rust crate, tsit45 with roots.
    Diffsol,
    /// DOP853 with events.
    Scipy,
    /// Moreau–Jean time stepping.
    Siconos,
}

/// Amontons and others on the same problems: error against time.
#[derive(Parser)]
struct Options {
    /// Who is compared with Amontons; all unless given.
    #[arg(long, value_enum, value_delimiter = ',')]
    peers: Vec<Peer>,
    /// Which scenes, flutter, impacts or kick; all unless given.
    #[arg(long, value_delimiter = ',')]
    scenes: Vec<String>,
    /// Leave out what takes long.
    #[arg(long)]
    quick: bool,
    /// Where the numbers and the picture go; the folder peers below the target folder unless given.
    #[arg(long)]
    out: Option<PathBuf>,
}

fn main() {
    let options = Options::parse();
    if let Err(error) = compare(&options) {
        eprintln!("error: {error}");
        std::process::exit(1);
    }
}

fn compare(options: &Options) -> Result<(), String> {
    // The program lies in a folder of its profile's name below the target folder.
    let program = env::current_exe().map_err(|error| error.to_string())?;
    let work = program.ancestors().nth(2).expect("it lies in two folders").join("peers");
    let out = options.out.as_ref().unwrap_or(&work);
    for folder in [&work, out] {
        fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    }
    let cases = scenes::all();
    if let Some(wrong) = options.scenes.iter().find(|name| cases.iter().all(|c| c.name != **name)) {
        let names: Vec<_> = cases.iter().map(|case| case.name).collect();
        return Err(format!("there is no scene {wrong}, only {}", names.join(", ")));
    }
    let wide = if cfg!(target_feature = "avx2") {
        "with AVX2"
    } else {
        "portable; RUSTFLAGS=\"-C target-cpu=native\" builds it for this machine, the peer's best"
    };
    println!("{NOTES}\nRust code, ours and diffsol: {wide}.\n");
    let wanted = |case: &Case| {
        options.scenes.is_empty() || options.scenes.iter().any(|name| name == case.name)
    };
    let mut tables = Vec::new();
    for case in cases.into_iter().filter(wanted) {
        println!("{}: {}\n", case.name, case.about);
        let (rows, missing) = rows(&case, options, &work);
        print!("{}", table::table(&rows));
        for (who, why) in missing {
            println!("{who:26} {why}");
        }
        println!();
        tables.push((case.name, rows));
    }
    println!("Who is the quickest to reach an accuracy:");
    for (name, rows) in &tables {
        println!("{name}\n{}", table::verdict(rows));
    }
    let [numbers, drawing, summary] =
        ["peers.csv", "peers.svg", "peers.md"].map(|name| out.join(name));
    table::write_csv(&tables, &numbers)
        .map_err(|error| format!("{}: {error}", numbers.display()))?;
    picture::write(&tables, &drawing)?;
    fs::write(&summary, table::summary(&tables))
        .map_err(|error| format!("{}: {error}", summary.display()))?;
    println!("{}\n{}\n{}", numbers.display(), drawing.display(), summary.display());
    Ok(())
}

/// All rows of a scene, and who is not there and how to get it.
fn rows(case: &Case, options: &Options, work: &Path) -> (Vec<Row>, Vec<(&'static str, String)>) {
    let asked = |peer| options.peers.is_empty() || options.peers.contains(&peer);
    let mut missing = Vec::new();
    let problem = Problem::from(&case.scene);
    let exact = ours::reference(&case.scene);
    assert_eq!(
        (exact.events, exact.touch_downs),
        (Some(case.events), Some(case.touch_downs)),
        "events and touch-downs of the reference are not those of this scene"
    );

    let ladder =
        if options.quick { &[10, 100, 1000][..] } else { &[10, 100, 1000, 10_000, 100_000] };
    let mut candidates = ours::candidates(&case.scene, ladder);
    if asked(Peer::C) {
        match dense::candidates(&problem, ladder, work) {
            Ok(more) => candidates.extend(more),
            Err(why) => missing.push((dense::WHO, why)),
        }
    }
    if asked(Peer::Diffsol) {
        candidates.extend(diffsol::candidates(&problem));
    }
    let mut rows: Vec<Row> = take_turns(candidates)
        .into_iter()
        .map(|(candidate, outcome, turns)| {
            Row::new(candidate.who, candidate.setting, &outcome, turns, &exact.displacements)
        })
        .collect();

    let scripts = [
        (Peer::Scipy, python::SCIPY, "scipy_dop853.py"),
        (Peer::Siconos, python::SICONOS, "siconos_moreau.py"),
    ];
    for (peer, who, script) in scripts.into_iter().filter(|(peer, ..)| asked(*peer)) {
        let interpreter = if peer == Peer::Scipy { python::scipy(work) } else { python::siconos() };
        let done = interpreter.and_then(|interpreter| {
            python::run(&interpreter, script, &problem, options.quick, work, |timed| {
                let python::Timed { setting, outcome, turns } = timed;
                rows.push(Row::new(who, setting, &outcome, turns, &exact.displacements));
            })
        });
        if let Err(why) = done {
            missing.push((who, why));
        }
    }
    (rows, missing)
}

/// Every candidate with its outcome, the shortest of each slice in it, and the number of runs.
fn take_turns(candidates: Vec<Candidate>) -> Vec<(Candidate, Outcome, usize)> {
    let mut all: Vec<_> = candidates
        .into_iter()
        .map(|mut candidate| {
            let mut outcome = (candidate.run)();
            let seconds: f64 = outcome.slices.iter().sum();
            let turns = MOST_TURNS.min((BUDGET / seconds) as usize);
            if turns > 0 {
                outcome.slices.fill(f64::INFINITY); // It was to warm up.
            }
            (candidate, outcome, turns)
        })
        .collect();
    for turn in 0..MOST_TURNS {
        for (candidate, best, _) in all.iter_mut().filter(|(.., turns)| turn < *turns) {
            for (best, slice) in best.slices.iter_mut().zip((candidate.run)().slices) {
                *best = best.min(slice);
            }
        }
    }
    all.into_iter().map(|(candidate, best, turns)| (candidate, best, turns.max(1))).collect()
}
