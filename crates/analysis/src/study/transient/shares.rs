//! The contact states that a run has taken over a span of time, and their eigenvalues.

use super::{Eigenvalue, Finding, Phase, StateShare};
use crate::stability::Linearised;
use amontons::contact::{ContactState, JoinedStates};
use amontons::stability::Spectrum;
use std::collections::HashMap;
use std::f64::consts::TAU;

/// Contact states of less than this part of the time are not listed, nor more than the following number.
const LEAST_SHARE: f64 = 1e-2;
const MOST_STATES: usize = 6;

/// The eigenvalues of the states that a run has taken, each found once.
pub(super) struct Shares<'a> {
    /// The linearised scene from each of some rows on, the first at the beginning.
    linear: &'a [(usize, Linearised)],
    states: &'a [Vec<ContactState>],
    interval: f64,
    /// Spectra by the place of the linearised scene, and the states.
    known: HashMap<(usize, Vec<ContactState>), Spectrum>,
}

impl<'a> Shares<'a> {
    pub(super) fn of(
        linear: &'a [(usize, Linearised)],
        states: &'a [Vec<ContactState>],
        interval: f64,
    ) -> Self {
        Self { linear, states, interval, known: HashMap::new() }
    }

    pub(super) fn beside(&mut self, phase: &Phase) -> Finding {
        let resting = self.nearest(&self.linear[self.place(phase)].1.resting_state(), phase);
        let taken = self.taken(phase.span).into_iter().map(|(states, share)| StateShare {
            eigenvalue: self.nearest(&states, phase),
            states: JoinedStates(&states).to_string(),
            share,
        });
        Finding { taken: taken.collect(), resting, phase: phase.clone() }
    }

    /// The states over a span of time (s) with their shares, longest first.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    fn taken(&self, span: [f64; 2]) -> Vec<(Vec<ContactState>, f64)> {
        let rows = self.states.first().map_or(0, Vec::len);
        let [from, to] = span.map(|time| (time / self.interval).round() as usize);
        let rows = from.min(rows)..(to + 1).min(rows);
        let mut counts: HashMap<Vec<ContactState>, usize> = HashMap::new();
        for row in rows.clone() {
            *counts.entry(self.states.iter().map(|course| course[row]).collect()).or_default() += 1;
        }
        let mut found: Vec<_> = counts.into_iter().collect();
        let order =
            |states: &[ContactState]| states.iter().map(|state| *state as u8).collect::<Vec<_>>();
        found.sort_by(|(a, first), (b, second)| {
            second.cmp(first).then_with(|| order(a).cmp(&order(b)))
        });
        let share = |(states, count)| (states, count as f64 / rows.len() as f64);
        let shares = found.into_iter().map(share);
        shares.take_while(|(_, share)| *share >= LEAST_SHARE).take(MOST_STATES).collect()
    }

    /// The place of the linearised scene with the values that act where a phase begins.
    fn place(&self, phase: &Phase) -> usize {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let first = (phase.span[0] / self.interval).round() as usize;
        self.linear.partition_point(|(row, _)| *row <= first).max(1) - 1
    }

    /// The eigenvalue of these states that is nearest to the phase: of those that oscillate if it does, else of those
    /// that do not.
    fn nearest(&mut self, states: &[ContactState], phase: &Phase) -> Option<Eigenvalue> {
        let place = self.place(phase);
        let here = &self.linear[place].1;
        let spectrum = self.known.entry((place, states.to_vec())).or_insert_with(|| {
            // A state that contradicts itself has no eigenvalues.
            here.linear().and_then(|linear| Spectrum::of(linear, states)).unwrap_or_default()
        });
        let apart = |rate: f64, im: f64| libm::hypot(rate - phase.rate, im - TAU * phase.frequency);
        let (oscillating, real) = match phase.frequency {
            0.0 => (&[][..], &spectrum.real[..]),
            _ => (&spectrum.oscillating[..], &[][..]),
        };
        let all = oscillating.iter().map(|value| [value.re, value.im]);
        all.chain(real.iter().map(|rate| [*rate, 0.0]))
            .min_by(|a, b| apart(a[0], a[1]).total_cmp(&apart(b[0], b[1])))
            .map(|[rate, im]| Eigenvalue { rate, frequency: im / TAU })
    }
}
