//! What a periodic motion does over one period, found from the motion itself: turning points and corners are closed in
//! on between the rows.

use crate::Error;
use crate::simulation::{Simulation, Snapshot, Variable};

/// The fewest rows of a period.
const FEWEST_ROWS: f64 = 1000.0;
/// A turn is closed in on by parting the time around it this often, into so many pieces, of which the two beside the
/// extreme value are kept: the time is then known to a millionth of a row.
const LEVELS: usize = 10;
const PIECES: u32 = 8;

/// What a motion does over one period.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct OverPeriod {
    /// Half of the difference between the output's largest and smallest value, in its unit.
    pub amplitude: f64,
    /// Half of the difference between the largest and the smallest displacement of each degree of freedom, m, from the
    /// rows.
    pub extents: Vec<f64>,
    /// The part of the time for which contacts are in each state, in the order of
    /// [`ContactState::ALL`](crate::contact::ContactState::ALL), from the rows.
    pub shares: [f64; 4],
}

/// Follows the motion of a simulation over a period (s) in rows of `interval` (s), or shorter ones.
///
/// # Errors
/// A step fails.
pub(super) fn over_period(
    simulation: &Simulation,
    output: &Variable,
    period: f64,
    interval: f64,
) -> Result<OverPeriod, Error> {
    let from = simulation.save();
    let mut simulation = Simulation::resume(from.clone())?;
    let start = simulation.time();
    let rows = (period / interval).ceil().max(FEWEST_ROWS);
    let time = |row: f64| start + row / rows * period;
    let mut values = vec![simulation.read(output)?];
    let mut extents: Vec<[f64; 2]> = simulation.displacement().iter().map(|x| [*x; 2]).collect();
    let mut states = [0.0; 4];
    let mut row = 0.0;
    while row < rows {
        row += 1.0;
        simulation.advance_to(time(row))?;
        values.push(simulation.read(output)?);
        for (extent, x) in extents.iter_mut().zip(simulation.displacement()) {
            *extent = [extent[0].min(*x), extent[1].max(*x)];
        }
        for state in simulation.contact_states() {
            states[*state as usize - 1] += 1.0;
        }
    }
    let all = states.iter().sum::<f64>().max(1.0);
    let mut turns = Turns { from: &from, simulation, output };
    let span = |row: usize| [time(row as f64 - 1.0), time(row as f64 + 1.0)];
    let most = turns.most(&values, &span, 1.0)?;
    let least = turns.most(&values, &span, -1.0)?;
    Ok(OverPeriod {
        amplitude: 0.5 * (most + least),
        extents: extents.iter().map(|[low, high]| 0.5 * (high - low)).collect(),
        shares: states.map(|count| count / all),
    })
}

/// Looks between the rows of a motion.
struct Turns<'a> {
    from: &'a Snapshot,
    simulation: Simulation,
    output: &'a Variable,
}

impl Turns<'_> {
    /// The largest value of the output times `sign`, from the values of the rows and the times (s) on both sides of each.
    fn most(
        &mut self,
        values: &[f64],
        span: &dyn Fn(usize) -> [f64; 2],
        sign: f64,
    ) -> Result<f64, Error> {
        let mut most = values.iter().fold(f64::NEG_INFINITY, |most, value| most.max(sign * value));
        // The period ends where it begins, so the motion goes on after the last row as after the first.
        let next = values.iter().skip(2).chain(&values[1..2]);
        for (row, (two, after)) in values.windows(2).zip(next).enumerate() {
            let [before, here, after] = [two[0], two[1], *after].map(|value| sign * value);
            // Beyond a row the value may rise by what it has changed towards it.
            let slack = (here - before).abs().max((after - here).abs());
            if here >= before && here >= after && here + slack > most {
                most = most.max(self.close_in(span(row + 1), sign)?);
            }
        }
        Ok(most)
    }

    /// The largest value of the output times `sign` between two times, s, between which it has one turn.
    fn close_in(&mut self, [mut from, mut to]: [f64; 2], sign: f64) -> Result<f64, Error> {
        let mut most = f64::NEG_INFINITY;
        self.simulation.restore(self.from)?;
        self.simulation.advance_to(from)?;
        for _ in 0..LEVELS {
            let begin = self.simulation.save();
            let piece = (to - from) / f64::from(PIECES);
            let mut best = (sign * self.simulation.read(self.output)?, 0);
            for i in 1..=PIECES {
                self.simulation.advance_to(from + f64::from(i) * piece)?;
                let value = sign * self.simulation.read(self.output)?;
                if value > best.0 {
                    best = (value, i);
                }
            }
            most = most.max(best.0);
            let low = f64::from(best.1.saturating_sub(1));
            let high = f64::from((best.1 + 1).min(PIECES));
            (from, to) = (from + low * piece, from + high * piece);
            self.simulation.restore(&begin)?;
            self.simulation.advance_to(from)?;
        }
        Ok(most)
    }
}
