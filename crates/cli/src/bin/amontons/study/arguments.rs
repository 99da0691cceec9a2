//! The arguments of `amontons study`.

use super::basin::Basin;
use super::limit_cycle::LimitCycle;
use super::perturbation::Perturbation;
use crate::arguments::{Integrator, positive};
use amontons_analysis::study::Wish;
use amontons_analysis::sweep::range::assignment;
use clap::{Args, Subcommand, ValueEnum};
use serde::Serialize;
use std::path::PathBuf;

#[derive(Subcommand)]
pub enum Study {
    /// Follow what a scene ends in over the friction coefficient, upwards and downwards: branches, folds, ranges with
    /// two motions
    Continuation(super::continuation::Arguments),
    /// Amplitude, frequency and contact states of limit cycles over a parameter, and where they change (Fig. 3)
    LimitCycle(LimitCycle),
    /// One run: growth and decay of its motion, band by band, beside eigenvalues; spectrogram and contact states
    ///
    /// It writes history.csv (the output and the contacts' states), results.csv (each growth and decay) and study.json.
    /// Ctrl-C ends the run, and what it has done is looked at and written (exit code 130). A run takes a second or
    /// so, so the same command runs it anew.
    Transient(super::transient::Arguments),
    /// What perturbations of one initial value end in, and the thresholds between
    Perturbation(Perturbation),
    /// Which points of a plane of two initial values end in which attractor
    Basin(Basin),
}

/// What all studies take.
#[derive(Args)]
pub struct Common {
    /// A scene file (TOML), or the name of a built-in scene
    pub scene: String,
    /// Give a parameter or input another value; the names are those of the FMU
    #[arg(long, value_name = "NAME=VALUE", value_parser = assignment)]
    pub set: Vec<(String, f64)>,
    /// Unless given, exact motion from look to look; what that does not take keeps the scene's own method. A basin
    /// takes the scene's own method
    #[command(flatten)]
    pub integrator: Integrator,
    /// Folder for results, pictures and the journal of finished work [default: the scene's name and the study's, here,
    /// with a number where another study has that]
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// How to write pictures
    #[arg(long, value_enum, default_value = "svg")]
    pub pictures: Pictures,
    /// Begin anew: drop what the folder's journal holds, of another study too where -o names the folder
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

/// How a study looks at motions, in place of what it derives from the scene.
#[derive(Args, Serialize)]
pub struct Looking {
    /// The output whose amplitude and frequency are looked at [default: the first displacement]
    #[arg(long, value_name = "NAME")]
    pub of: Option<String>,
    /// How long one looks at a motion to know it, s [default: 50 periods of the slowest mode]
    #[arg(long, value_name = "S", value_parser = positive, allow_hyphen_values = true)]
    pub window: Option<f64>,
    /// Time between two looks, s [default: a twentieth of the fastest mode's period]
    #[arg(long, value_name = "S", value_parser = positive, allow_hyphen_values = true)]
    pub interval: Option<f64>,
    /// How long a motion may take to settle, s [default: 60 windows after the last edge of a signal]
    #[arg(long, value_name = "S", value_parser = positive, allow_hyphen_values = true)]
    pub longest: Option<f64>,
}

impl Looking {
    pub fn wish(&self) -> Wish<'_> {
        Wish {
            of: self.of.as_deref(),
            interval: self.interval,
            window: self.window,
            longest: self.longest,
        }
    }
}
