//! The arguments of `amontons study`.

use super::basin::Basin;
use super::limit_cycle::LimitCycle;
use super::loudness::Loudness;
use super::perturbation::Perturbation;
use crate::arguments::{Integrator, positive};
use amontons_analysis::study::ObservationRequest;
use amontons_analysis::sweep::range::assignment;
use clap::{Args, Subcommand, ValueEnum};
use serde::Serialize;
use std::path::PathBuf;

#[derive(Subcommand)]
pub enum Study {
    /// Follow the motions of a scene over the friction coefficient, upwards and downwards: branches, jumps, ranges
    /// with two motions
    Continuation(super::continuation::ContinuationArguments),
    /// Amplitude, frequency and contact states of limit cycles over a parameter, and the values at which they change
    /// (Fig. 3)
    LimitCycle(LimitCycle),
    /// Growth rates of modes beside the loudness of the motions that they lead to
    ///
    /// Each growing mode of uniform sliding starts a motion, which is followed until it has settled and is measured:
    /// velocities, powers, contact states. Where no mode grows, candidates for a second motion are pushed. The study writes
    /// results.csv (a row for each mode), study.json and a picture.
    Loudness(Loudness),
    /// One periodic motion, stable or not: its period, its events, its Floquet multipliers
    ///
    /// The motion is solved for by Newton's method, not waited for. The study writes results.csv (the events of one
    /// period), study.json, and orbit.json, from which another study can start.
    Orbit(super::orbit::OrbitArguments),
    /// Periodic motions over a parameter, stable and unstable: folds, bifurcations, changes of the sequence of events
    ///
    /// Each branch begins with a periodic motion and is followed to both sides by pseudo-arclength. The study writes
    /// results.csv (the points), specials.csv (the special points), study.json and a picture.
    Branches(super::branches::BranchesArguments),
    /// Growth and decay of the motion in one run, band by band, beside eigenvalues; spectrogram and contact states
    ///
    /// The study writes history.csv (the output and the contact states), results.csv (each growth and decay) and
    /// study.json. Ctrl-C ends the run; the part up to then is analysed and written (exit code 130). A run takes about
    /// a second, so the same command starts again from the beginning.
    Transient(super::transient::TransientArguments),
    /// Attractors reached from perturbations of one initial value, and the thresholds between them
    Perturbation(Perturbation),
    /// Basins of attraction in a plane of two initial values
    Basin(Basin),
    /// The probability that a scene is unstable when its parameters scatter, and which of them it is due to
    ///
    /// Draws are points of scrambled Sobol nets. The study writes results.csv (probabilities and Sobol indices, with intervals of
    /// 95 %), histogram.csv (the largest growth rate), study.json and pictures; with --pushes also runs.csv.
    Robustness(super::robustness::RobustnessArguments),
    /// The smallest change of a scene after which no mode grows over a range of friction coefficients
    ///
    /// The change is sought from several starts by sequential quadratic programs with exact derivatives, and verified by
    /// eigenvalues on a finer grid and by runs after pushes. The study writes results.csv (each value before and after),
    /// trade-off.csv (growth rate against change), growth.csv, study.json and pictures.
    Design(super::design::DesignArguments),
    /// One page that answers for a scene: does it squeal, at which frequencies, how loud, how probable, what to change
    ///
    /// It joins eigenvalues, loudness, robustness and sensitivities. Where --uncertain is not given the scatter of parameters is assumed:
    /// friction ±10 %, masses and stiffnesses ±5 % (standard deviations). The study writes report.html, which needs no network and
    /// prints as PDF from a browser, results.csv (the key numbers) and study.json.
    Report(super::report::ReportArguments),
    /// Put the pieces of all workers of a study together (--shard), tell what is missing, or write the results
    ///
    /// It may be run at any time and any number of times, while workers run or after they were killed, in the folder in
    /// which they were started. If pieces are missing, it tells how many and what to do next (exit code 5). If none is,
    /// it writes what one machine writes: for a study its files, for a sweep results.csv.
    Merge(super::merge::Merge),
}

/// Arguments of all studies.
#[derive(Args)]
pub struct StudyArguments {
    /// A scene file (TOML), or the name of a built-in scene
    pub scene: String,
    /// Give a parameter or input another value; the names are those of the FMU
    #[arg(long, value_name = "NAME=VALUE", value_parser = assignment)]
    pub set: Vec<(String, f64)>,
    /// By default the motion is event-driven with a step of one observation interval; a scene that the event-driven
    /// integrator cannot run keeps its own method, and so does a basin
    #[command(flatten)]
    pub integrator: Integrator,
    /// Folder for results, pictures and the journal of finished work [default: SCENE-STUDY in the current folder, with
    /// a number if that folder holds another study]
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Format of the pictures
    #[arg(long, value_enum, default_value = "svg")]
    pub pictures: Pictures,
    /// Start from the beginning and discard the folder's journal, even that of another study if -o names the folder
    #[arg(long)]
    pub anew: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Pictures {
    Svg,
    Png,
}

impl Pictures {
    pub fn ending(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::Png => "png",
        }
    }
}

/// Settings with which a study observes motions, in place of those that it derives from the scene.
#[derive(Args, Serialize)]
pub struct ObservationOptions {
    /// Output whose amplitude and frequency are evaluated [default: the first displacement]
    #[arg(long, value_name = "NAME")]
    pub of: Option<String>,
    /// Length of the window in which a motion is classified, s [default: 50 periods of the slowest mode]
    #[arg(long, value_name = "S", value_parser = positive, allow_hyphen_values = true)]
    pub window: Option<f64>,
    /// Time between two observations, s [default: a twentieth of the fastest mode's period]
    #[arg(long, value_name = "S", value_parser = positive, allow_hyphen_values = true)]
    pub interval: Option<f64>,
    /// Longest time for a motion to settle, s [default: 60 windows after the last edge of a signal]
    #[arg(long, value_name = "S", value_parser = positive, allow_hyphen_values = true)]
    pub longest: Option<f64>,
}

impl ObservationOptions {
    /// The options as a command line has them; nothing where none is given.
    pub fn words(&self) -> String {
        let of = self.of.as_ref().map_or_else(String::new, |of| format!(" --of '{of}'"));
        let times =
            [("window", self.window), ("interval", self.interval), ("longest", self.longest)];
        let times =
            times.into_iter().filter_map(|(name, value)| Some(format!(" --{name} {}", value?)));
        of + &times.collect::<String>()
    }

    pub fn request(&self) -> ObservationRequest<'_> {
        ObservationRequest {
            of: self.of.as_deref(),
            interval: self.interval,
            window: self.window,
            longest: self.longest,
        }
    }
}

/// The first given option that acts on runs alone, so that eigenvalues do not depend on it.
pub fn only_of_runs(common: &StudyArguments, options: &ObservationOptions) -> Option<&'static str> {
    let ObservationOptions { of, window, interval, longest } = options;
    let integrator = &common.integrator;
    let all = [
        ("--of", of.is_some()),
        ("--window", window.is_some()),
        ("--interval", interval.is_some()),
        ("--longest", longest.is_some()),
        ("--integrator", integrator.integrator.is_some()),
        ("--step", integrator.step.is_some()),
        ("--preset", integrator.preset.is_some()),
    ];
    all.into_iter().find(|(_, is_given)| *is_given).map(|(name, _)| name)
}
