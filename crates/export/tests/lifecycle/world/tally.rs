//! A tally of the calls that were made.

use crate::draw::Kind;
use crate::standard::{DISCARD, ERROR, OK, Phase, WARNING};
use std::collections::{BTreeMap, BTreeSet};

/// A tally of the calls that were made.
#[derive(Default)]
pub struct Tally {
    pub calls: u64,
    by_status: BTreeMap<(&'static str, i32), u64>,
    /// Function, kind of argument, phase, and `true` in strict mode.
    pub met: BTreeSet<(&'static str, Kind, Phase, bool)>,
}

impl Tally {
    pub(super) fn count(&mut self, function: &'static str, status: i32) {
        self.calls += 1;
        *self.by_status.entry((function, status)).or_default() += 1;
    }

    pub fn print(&self) {
        println!("{:30} {:>9} {:>9} {:>9} {:>9}", "calls", "OK", "Warning", "Discard", "Error");
        let functions: BTreeSet<_> = self.by_status.keys().map(|(function, _)| *function).collect();
        let mut sums = [0; 4];
        for function in functions {
            let of = |status| self.by_status.get(&(function, status)).copied().unwrap_or(0);
            let counts = [OK, WARNING, DISCARD, ERROR].map(of);
            println!(
                "{function:30} {:9} {:9} {:9} {:9}",
                counts[0], counts[1], counts[2], counts[3]
            );
            sums = std::array::from_fn(|i| sums[i] + counts[i]);
        }
        println!("{:30} {:9} {:9} {:9} {:9}", self.calls, sums[0], sums[1], sums[2], sums[3]);
    }
}
