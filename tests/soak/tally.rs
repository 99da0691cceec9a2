//! The counts of a soak.

use crate::judge::LetOff;
use crate::outcome::{Outcome, Report};
use amontons::scene::Method;
use std::collections::BTreeMap;
use std::fmt;

/// Outcomes of the runs of one integrator.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    runs: u64,
    steps: u64,
    pub kept: u64,
    cut_short: u64,
    ended_hops: u64,
    refused: BTreeMap<String, u64>,
    no_solution: u64,
    early: BTreeMap<String, u64>,
    broke: BTreeMap<String, u64>,
    let_off: LetOff,
}

fn sum(counts: &BTreeMap<String, u64>) -> u64 {
    counts.values().sum()
}

impl Tally {
    pub fn add(&mut self, report: &Report) {
        self.runs += 1;
        self.steps += u64::from(report.steps);
        self.cut_short += u64::from(report.cut_short);
        self.ended_hops += report.ended_hops;
        self.let_off += report.let_off;
        let class = report.outcome.class();
        let counts = match &report.outcome {
            Outcome::Kept => {
                self.kept += 1;
                return;
            }
            Outcome::NoSolution(_) => {
                self.no_solution += 1;
                return;
            }
            Outcome::Refused(_) => &mut self.refused,
            Outcome::Early(_) => &mut self.early,
            Outcome::Broke(_) => &mut self.broke,
        };
        *counts.entry(class).or_default() += 1;
    }

    pub fn merge(&mut self, other: Self) {
        let counts = [
            (&mut self.refused, other.refused),
            (&mut self.early, other.early),
            (&mut self.broke, other.broke),
        ];
        for (own, more) in counts {
            more.into_iter().for_each(|(class, count)| *own.entry(class).or_default() += count);
        }
        self.runs += other.runs;
        self.steps += other.steps;
        self.kept += other.kept;
        self.cut_short += other.cut_short;
        self.ended_hops += other.ended_hops;
        self.no_solution += other.no_solution;
        self.let_off += other.let_off;
    }

    pub fn broke(&self) -> u64 {
        sum(&self.broke)
    }

    pub fn early(&self) -> u64 {
        sum(&self.early)
    }

    /// Runs that were to come to their end.
    pub fn to_end(&self) -> u64 {
        self.kept + self.broke() + self.early()
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{} runs of {} judged steps: {} kept the law, {} were refused, {} have proven no solution, {} ended \
             early, {} broke the law",
            self.runs,
            self.steps,
            self.kept,
            sum(&self.refused),
            self.no_solution,
            self.early(),
            self.broke()
        )?;
        let kinds =
            [("refused", &self.refused), ("ended early", &self.early), ("broke", &self.broke)];
        for (kind, counts) in kinds {
            let mut sorted: Vec<_> = counts.iter().collect();
            sorted.sort_by_key(|(_, count)| std::cmp::Reverse(**count));
            for (class, count) in sorted {
                writeln!(f, "    {kind} {count} times: {class}")?;
            }
        }
        writeln!(
            f,
            "    {} runs were judged in part, for time; {} hops were ended; let off: {:?}",
            self.cut_short, self.ended_hops, self.let_off
        )
    }
}

/// Both integrators' counts, each with its name.
pub type Tallies = [(Method, Tally); 2];
