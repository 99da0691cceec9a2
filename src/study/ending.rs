//! What a motion ends in: rest, or a cycle of which kind.
//!
//! A motion is looked at window by window. It is *settled* when it rests, or when its size and its lines are the
//! same in windows that follow each other, and no faint line grows. What is compared is a mixture of all
//! displacements, so that nothing hides where one output does not see it.

use super::look::{Look, output};
use crate::Error;
use crate::accuracy::half_range;
use crate::integrator::Statistics;
use crate::simulation::{Simulation, Variable};
use crate::spectral::{Line, Lines, lines};
use serde::{Deserialize, Serialize};

/// The size of a settled motion differs by less than this from one window to the next, relative.
const SAME_SIZE: f64 = 1e-3;
/// Drifting one way all the time it must not have further to go than this, relative.
const LEFT_TO_GO: f64 = 2e-3;
/// A drift that does not slow down must be below this, relative: rounding.
const STANDING: f64 = 1e-7;
/// Lines of more than this part of the strongest one must be the same.
const STRONG: f64 = 1e-2;
/// By this part of their resolution, and by this part of their amplitude.
const SAME_PLACE: f64 = 0.1;
const SAME_LINE: f64 = 1e-2;
/// Lines of more than this part of the strongest one must not grow.
const FAINT: f64 = 1e-4;
/// Growth: through three windows each time, and by this factor in all.
const GROWN: f64 = 1.3;
/// A motion decays to rest if it, going on as it does, ends below this part of what is left of it.
const REST: f64 = 0.2;
/// A motion whose lines never stay has settled as irregular when over so many windows its size has no trend.
const IRREGULAR_WINDOWS: usize = 12;
/// Lines of more than this part of the strongest one tell the kinds of motion apart. Weaker ones may be high
/// multiples, as kinks have them, which rows this far apart show at another frequency.
const TELLING: f64 = 1e-2;
/// Lines of more than this part of the strongest one are told.
const TOLD: f64 = 1e-3;
/// The highest order of a combination of two frequencies, and of a subharmonic.
const HIGHEST_ORDER: i32 = 12;
const SUBHARMONICS: i32 = 8;
/// How well a frequency meets a multiple, in parts of the lines' resolution.
const MEETS: f64 = 0.01;
/// What part of the power the lines of a motion that is not irregular have.
const IN_LINES: f64 = 0.98;

/// What kind of motion it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// It rests, or decays to rest.
    Equilibrium,
    /// All lines are multiples of one frequency.
    Periodic,
    /// All lines are combinations of two frequencies.
    QuasiPeriodic,
    /// Neither: more frequencies, or chaos.
    Irregular,
    /// It had not settled when it was left.
    Unsettled,
}

impl Kind {
    /// As a table has it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Equilibrium => "equilibrium",
            Self::Periodic => "periodic",
            Self::QuasiPeriodic => "quasi-periodic",
            Self::Irregular => "irregular",
            Self::Unsettled => "unsettled",
        }
    }

    /// Does it go on moving for ever?
    #[must_use]
    pub const fn is_cycle(self) -> bool {
        matches!(self, Self::Periodic | Self::QuasiPeriodic | Self::Irregular)
    }
}

/// What a motion ends in, as its last window shows it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ending {
    /// What kind of motion it is.
    pub kind: Kind,
    /// Half of what lies between the output's smallest and largest value, turns between the rows included; in its
    /// unit. Of an equilibrium what is left of the motion.
    pub amplitude: f64,
    /// Of the output's strongest line, Hz; `None` where nothing oscillates.
    pub frequency: Option<f64>,
    /// s after which a periodic motion comes again.
    pub period: Option<f64>,
    /// The output's strongest lines, the strongest first: frequency, Hz, and amplitude in its unit.
    pub lines: Vec<[f64; 2]>,
    /// How much of the time contacts are in each state, all contacts together, in the order of
    /// [`ContactState::ALL`](crate::contact::ContactState::ALL).
    pub shares: [f64; 4],
    /// Was each state taken at all, also between the rows?
    pub taken: [bool; 4],
    /// s from where the motion was first looked at.
    pub time: f64,
    /// How fast the motion still grew or, below zero, decayed at the end, 1/s.
    pub rate: f64,
}

impl Ending {
    /// Does it rest, or was it left on its way to rest?
    #[must_use]
    pub fn rests(&self) -> bool {
        let states = self.taken.iter().filter(|taken| **taken).count();
        self.kind == Kind::Equilibrium
            || self.kind == Kind::Unsettled && self.rate < 0.0 && states <= 1
    }
}

/// A motion that is looked at until it is settled.
pub(crate) struct Settling {
    look: Look,
    output: Variable,
    /// Rows since the clock's zero, and those that a window began with.
    row: u64,
    began: u64,
    followed: Vec<f64>,
    mixture: Vec<f64>,
    states: [u64; 4],
    taken: [bool; 4],
    before: Statistics,
    seen: Vec<Seen>,
}

/// A window that was looked at.
struct Seen {
    /// Deviation of the mixture from its mean, root mean square, and whether a contact changed its state.
    size: f64,
    changed: bool,
    mixture: Vec<f64>,
    /// Found when they are needed.
    lines: Option<Lines>,
}

impl Settling {
    /// Looks at a simulation from where it is.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    pub(crate) fn new(simulation: &Simulation, look: &Look) -> Result<Self, Error> {
        let row = (simulation.time() / look.interval).round() as u64;
        let mut settling = Self {
            look: look.clone(),
            output: output(simulation.scene(), &look.of)?,
            row,
            began: row,
            followed: Vec::new(),
            mixture: Vec::new(),
            states: [0; 4],
            taken: [false; 4],
            before: simulation.statistics(),
            seen: Vec::new(),
        };
        settling.note_states(simulation);
        settling.states = [0; 4];
        Ok(settling)
    }

    /// When the next row is due, s.
    #[allow(clippy::cast_precision_loss)]
    pub(crate) fn next_time(&self) -> f64 {
        (self.row + 1) as f64 * self.look.interval
    }

    /// Takes note of the row that is due; what the motion ends in, once that is known.
    pub(crate) fn note(&mut self, simulation: &mut Simulation) -> Result<Option<Ending>, Error> {
        self.row += 1;
        self.followed.push(simulation.read(&self.output)?);
        self.mixture.push(mixture(simulation.displacement()));
        self.note_states(simulation);
        if self.followed.len() as u64 == self.look.rows() {
            self.close(simulation)
        } else {
            Ok(None)
        }
    }

    fn note_states(&mut self, simulation: &Simulation) {
        for state in simulation.contact_states() {
            self.states[*state as usize - 1] += 1;
            self.taken[*state as usize - 1] = true;
        }
    }

    /// The end of a window.
    fn close(&mut self, simulation: &Simulation) -> Result<Option<Ending>, Error> {
        let now = simulation.statistics();
        for ((taken, now), before) in
            self.taken.iter_mut().zip(now.entered).zip(self.before.entered)
        {
            *taken |= now > before;
        }
        let size = deviation(&self.mixture);
        let changed = now.state_changes() > self.before.state_changes();
        self.seen.push(Seen {
            size,
            changed,
            mixture: std::mem::take(&mut self.mixture),
            lines: None,
        });
        let kind = self.settled(simulation);
        let is_last = self.seen.len() >= self.look.windows();
        if kind.is_none() && !is_last {
            self.followed.clear();
            self.states = [0; 4];
            self.taken = [false; 4];
            self.before = now;
            self.note_states(simulation);
            self.states = [0; 4];
            // Older ones are not looked at again, but for their size.
            if let Some(old) = self.seen.len().checked_sub(4) {
                (self.seen[old].mixture, self.seen[old].lines) = (Vec::new(), None);
            }
            return Ok(None);
        }
        Ok(Some(self.ending(kind.unwrap_or((Kind::Unsettled, None)))))
    }

    #[allow(clippy::cast_precision_loss)]
    fn ending(&self, (kind, base): (Kind, Option<f64>)) -> Ending {
        let found = lines(&self.followed, self.look.interval, TOLD);
        let all = self.states.iter().sum::<u64>().max(1) as f64;
        Ending {
            kind,
            amplitude: half_range(&self.followed),
            frequency: found.lines.first().map(|line| line.frequency),
            period: base.map(|base| 1.0 / base),
            lines: found
                .lines
                .iter()
                .take(8)
                .map(|line| [line.frequency, line.amplitude])
                .collect(),
            shares: self.states.map(|count| count as f64 / all),
            taken: self.taken,
            time: (self.row - self.began) as f64 * self.look.interval,
            rate: match &self.seen[..] {
                [.., before, last] if before.size > 0.0 && last.size > 0.0 => {
                    (last.size / before.size).ln() / self.look.window
                }
                _ => 0.0,
            },
        }
    }

    /// The kind of the motion, once it is settled, and the frequency of which all lines of a periodic one are
    /// multiples, Hz.
    fn settled(&mut self, simulation: &Simulation) -> Option<(Kind, Option<f64>)> {
        let last = self.seen.last()?;
        let largest = simulation.displacement().iter().fold(0.0, |most, x| f64::max(most, x.abs()));
        if last.size <= 1e-14 * largest {
            return Some((Kind::Equilibrium, None));
        }
        if rests(&self.seen) {
            return Some((Kind::Equilibrium, None));
        }
        let sizes: Vec<f64> = self.seen.iter().map(|seen| seen.size).collect();
        if is_steady(&sizes) && self.has_steady_lines() {
            return Some(self.kind());
        }
        has_no_trend(&sizes).then_some((Kind::Irregular, None))
    }

    /// Are the lines of the last windows the same, and does none grow?
    fn has_steady_lines(&mut self) -> bool {
        let interval = self.look.interval;
        let Some(first) = self.seen.len().checked_sub(4) else { return false };
        for seen in &mut self.seen[first..] {
            if seen.lines.is_none() {
                seen.lines = Some(lines(&seen.mixture, interval, FAINT));
            }
        }
        // Then the motion is linear, and a line that changes at all ends elsewhere.
        let unchanged = self.seen[first..].iter().all(|seen| !seen.changed);
        let windows: Vec<&Lines> =
            self.seen[first..].iter().filter_map(|seen| seen.lines.as_ref()).collect();
        let [oldest, .., last] = windows[..] else { return false };
        let Some(strongest) = last.lines.first() else { return false };
        last.lines.iter().all(|line| {
            let strong = line.amplitude >= STRONG * strongest.amplitude;
            let stays = |other: &&Lines| {
                near(line, other, SAME_PLACE)
                    .is_some_and(|other| (other / line.amplitude - 1.0).abs() <= SAME_LINE)
            };
            let before: Vec<f64> =
                windows.iter().map(|window| near(line, window, 1.0).unwrap_or(0.0)).collect();
            let grows =
                before.windows(2).all(|two| two[1] > two[0]) && before[3] > GROWN * before[0];
            if unchanged && goes_one_way(&before) {
                return false;
            }
            if strong { [oldest, windows[2]].iter().all(stays) } else { !grows }
        })
    }

    /// The kind of a motion with steady lines: as the mixture and the output have them, since in a mixture of many
    /// displacements some lines are faint.
    fn kind(&self) -> (Kind, Option<f64>) {
        let Some(Seen { lines: Some(mixture), .. }) = self.seen.last() else {
            return (Kind::Irregular, None);
        };
        let followed = lines(&self.followed, self.look.interval, TELLING);
        let telling = [telling(mixture), telling(&followed)].concat();
        let share = mixture.share.min(if followed.lines.is_empty() { 1.0 } else { followed.share });
        kind_of(&telling, share, mixture.resolution)
    }
}

/// Advances a simulation until its motion is settled; `None` if the watch ended it.
///
/// # Errors
/// As [`Simulation::advance_to`].
pub(crate) fn settle(
    simulation: &mut Simulation,
    look: &Look,
    is_over: &dyn Fn() -> bool,
) -> Result<Option<Ending>, Error> {
    let mut settling = Settling::new(simulation, look)?;
    loop {
        if settling.row.is_multiple_of(256) && is_over() {
            return Ok(None);
        }
        simulation.advance_to(settling.next_time())?;
        if let Some(ending) = settling.note(simulation)? {
            return Ok(Some(ending));
        }
    }
}

/// A sum of all displacements with factors that no symmetry of a structure has.
#[allow(clippy::cast_precision_loss)]
fn mixture(displacement: &[f64]) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_8;
    let factor = |i: usize| 0.5 + (i as f64 * GOLDEN).fract();
    displacement.iter().enumerate().fold(0.0, |sum, (i, x)| sum + factor(i) * x)
}

/// From the mean, root mean square.
#[allow(clippy::cast_precision_loss)]
fn deviation(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().fold(0.0, |sum, x| sum + x) / count;
    (values.iter().fold(0.0, |sum, x| sum + (x - mean) * (x - mean)) / count).sqrt()
}

/// Does a motion decay to rest? No contact changes its state any more, and the limit of its size, by Aitken's
/// extrapolation, is near zero: twice one after the other.
fn rests(seen: &[Seen]) -> bool {
    let Some(first) = seen.len().checked_sub(4) else { return false };
    let last = &seen[first..];
    let tends_to_zero = |three: &[Seen]| {
        let [a, b, c] = [three[0].size, three[1].size, three[2].size];
        let (before, after) = (b - a, c - b);
        let limit = c - after * after / (after - before);
        after < 0.0 && before < after && limit.abs() <= REST * c
    };
    last[1..].iter().all(|seen| !seen.changed) && last.windows(3).all(tends_to_zero)
}

/// Does the size stay, over the last four windows?
fn is_steady(sizes: &[f64]) -> bool {
    let Some(first) = sizes.len().checked_sub(4) else { return false };
    let last = &sizes[first..];
    let change: Vec<f64> = last.windows(2).map(|two| two[1] / two[0] - 1.0).collect();
    if change.iter().any(|change| change.abs() > SAME_SIZE) {
        return false;
    }
    let one_way =
        change.iter().all(|change| *change > 0.0) || change.iter().all(|change| *change < 0.0);
    if !one_way || change.iter().all(|change| change.abs() <= STANDING) {
        return true;
    }
    let slowing = change[2].abs() / change[1].abs();
    change[1].abs() < change[0].abs()
        && slowing < 1.0
        && change[2].abs() * slowing / (1.0 - slowing) <= LEFT_TO_GO
}

/// Do amplitudes only grow, or only decay, by more than rounding?
fn goes_one_way(amplitudes: &[f64]) -> bool {
    let ratios = amplitudes.windows(2).map(|two| two[1] / two[0] - 1.0);
    ratios.clone().all(|ratio| ratio > STANDING) || ratios.clone().all(|ratio| ratio < -STANDING)
}

/// Has the size, though it varies, no trend over many windows?
#[allow(clippy::cast_precision_loss)]
fn has_no_trend(sizes: &[f64]) -> bool {
    let Some(first) = sizes.len().checked_sub(IRREGULAR_WINDOWS) else { return false };
    let (a, b) = sizes[first..].split_at(IRREGULAR_WINDOWS / 2);
    let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
    let spread = deviation(&sizes[first..]);
    let rises = sizes[first..].windows(2).filter(|two| two[1] > two[0]).count();
    // A drift goes one way, what varies goes both.
    (mean(a) - mean(b)).abs() <= spread && (3..=8).contains(&rises) && spread <= 0.5 * mean(b)
}

/// The amplitude of the line of a window that is within this part of the resolution of another line.
fn near(line: &Line, window: &Lines, part: f64) -> Option<f64> {
    let at = |other: &&Line| (other.frequency - line.frequency).abs() <= part * window.resolution;
    window.lines.iter().find(at).map(|other| other.amplitude)
}

/// The frequencies of the lines that tell the kinds of motion apart, Hz, the strongest first.
fn telling(found: &Lines) -> Vec<f64> {
    let strongest = found.lines.first().map_or(0.0, |line| line.amplitude);
    let is_telling = |line: &&Line| line.amplitude >= TELLING * strongest;
    found.lines.iter().filter(is_telling).map(|line| line.frequency).collect()
}

/// What the lines of a steady motion tell: their frequencies, the strongest first, what part of the power they
/// have, and how well they are known, all in Hz. With the kind, the frequency of which all are multiples.
fn kind_of(telling: &[f64], share: f64, resolution: f64) -> (Kind, Option<f64>) {
    let Some(&main) = telling.first() else { return (Kind::Equilibrium, None) };
    if share < IN_LINES {
        return (Kind::Irregular, None);
    }
    let meets = MEETS * resolution;
    let multiple =
        |base: f64, of: f64| (of - (of / base).round() * base).abs() <= meets * (1.0 + of / base);
    for part in 1..=SUBHARMONICS {
        let base = main / f64::from(part);
        // Not so many that anything would do.
        if base > 2.0 * resolution && telling.iter().all(|&of| multiple(base, of)) {
            return (Kind::Periodic, Some(base));
        }
    }
    let Some(&second) = telling.iter().find(|&&of| !multiple(main, of)) else {
        return (Kind::Irregular, None);
    };
    let combines = |of: f64| {
        (-HIGHEST_ORDER..=HIGHEST_ORDER).any(|n| {
            let rest = of - f64::from(n) * main;
            let m = (rest / second).round();
            let order = f64::from(n.abs()) + m.abs();
            order <= f64::from(HIGHEST_ORDER) && (rest - m * second).abs() <= meets * (1.0 + order)
        })
    };
    let is_of_two = telling.iter().all(|&of| combines(of));
    (if is_of_two { Kind::QuasiPeriodic } else { Kind::Irregular }, None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Method, builtin};
    use crate::simulation::assign;
    use crate::study::Wish;
    use std::f64::consts::TAU;

    /// What a built-in scene with other values ends in, by exact motion.
    fn ending(name: &str, values: &[(&str, f64)]) -> Ending {
        let mut scene = builtin(name).unwrap().scene();
        for (name, value) in values {
            assign(&mut scene, name, *value).unwrap();
        }
        let look = Look::of(&scene, &Wish::default()).unwrap();
        (scene.method, scene.step) = (Method::EventDriven, look.interval);
        let mut simulation = Simulation::new(scene, 0.0).unwrap();
        settle(&mut simulation, &look, &|| false).unwrap().unwrap()
    }

    #[test]
    fn look_at_them() {
        for (name, values) in [
            ("set1", &[][..]),
            ("set1", &[("friction.coefficient", 1.5), ("slider.velocity", 0.15)]),
            ("set1", &[("friction.coefficient", 2.2)]),
            ("set1", &[("friction.coefficient", 2.02)]),
            ("set1", &[("friction.coefficient", 1.0)]),
            ("set2", &[]),
            ("set2", &[("friction.coefficient", 1.7)]),
            ("set2", &[("initial.module[1].v2", 1e-4)]),
            ("set2", &[("friction.coefficient", 2.05), ("initial.module[1].v2", 1e-4)]),
            ("belt", &[]),
            ("stick_slip", &[]),
            ("den_hartog", &[]),
            ("hoffmann", &[]),
            ("corner", &[]),
            ("disc_brake", &[]),
            ("ring12", &[]),
        ] {
            let t = std::time::Instant::now();
            let e = ending(name, values);
            println!(
                "{name} {values:?} {:?} {:.4e} {:?} {:?} {:?} {} s, {:?}\n   {:?}",
                e.kind,
                e.amplitude,
                e.frequency,
                e.shares,
                e.taken,
                e.time,
                t.elapsed(),
                e.lines
            );
        }
    }
}
