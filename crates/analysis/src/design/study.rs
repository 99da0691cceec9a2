//! The design, its trade-off with the growth rate, and its verification.

use super::limits::{Effort, Structure};
use super::search::{OverRange, Survey};
use super::solver::{Aim, Solved};
use super::vary::Varied;
use super::verify::{Checked, Worst, verified};
use crate::journal::Journal;
use crate::robustness::{Pushes, random};
use crate::stability::parallel::{collect, on_this_thread};
use crate::watch::Watch;
use amontons::Error;
use amontons::contact::ContactState;
use amontons::decimal::to_significant;
use amontons::scene::Scene;
use serde::{Deserialize, Serialize};
use std::sync::{Mutex, PoisonError};

/// The part of the way from the scene's growth rate to the limit by which a design is better than the limit asks: its changes are
/// then rounded to four digits.
const SURPLUS: f64 = 2e-3;
/// Digits of changes: the first of these with which the limit is kept.
const DIGITS: [usize; 4] = [4, 6, 9, 17];

/// The usual number of spectra and derivatives of a search from one start for each contact state, over a range and at one value of
/// the friction coefficient: half of the progress of a start.
const USUAL: f64 = 6000.0;
const USUAL_AT_ONE_VALUE: f64 = 100.0;

/// The question of a design.
pub struct DesignQuestion<'a> {
    /// The scene, without signals.
    pub scene: &'a Scene,
    /// The values that may change.
    pub varied: &'a [Varied],
    /// The contact states in which no mode may grow, one entry for each contact.
    pub patterns: &'a [Vec<ContactState>],
    /// `true` if the one contact state is uniform sliding: the equilibrium must then be in it over the whole range.
    pub is_uniform: bool,
    /// The range of the common friction coefficient; both ends may be equal.
    pub range: [f64; 2],
    /// No mode may have a growth rate above the negative of this, 1/s.
    pub margin: f64,
    /// Number of starts of the search: the scene itself, all values at their lower bounds, all at their upper ones, random ones.
    pub starts: usize,
    /// The seed of the other starts.
    pub seed: u64,
    /// Number of points of the trade-off between those of the scene and of the least growth rate.
    pub points: usize,
    /// Runs after pushes that verify the design: their scene is replaced by the scene and by the design.
    pub pushes: Option<Pushes<'a>>,
}

/// A change of the scene with its effect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reached {
    /// The relative change of each value that may change.
    pub changes: Vec<f64>,
    /// The size of the change: the root of the sum of the squares of cost times relative change over all values.
    pub size: f64,
    /// The mode that grows fastest over the range.
    pub worst: Worst,
}

/// The ends of the searches from one start.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Start {
    /// The end of the search for the smallest change that keeps the limit. It may not keep it.
    pub smallest: Reached,
    /// The end of the search for the least growth rate.
    pub least: Reached,
}

/// The results of a design.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FoundDesign {
    /// The mode of the scene that grows fastest over the range.
    pub before: Worst,
    /// The change with the least growth rate that was found within the bounds.
    pub least: Reached,
    /// `true` if `design` keeps the limit.
    pub is_kept: bool,
    /// The smallest change that keeps the limit; if none was found, that with the least growth rate. Changes have four digits.
    pub design: Reached,
    /// Number of starts of which the search kept the limit, and of those that ended at a change of the same size, to 1 %.
    pub agreeing: [usize; 2],
    /// The searches from all starts.
    pub starts: Vec<Start>,
    /// Smallest changes for growth rates between that of the scene and the least one, by size.
    pub trade_off: Vec<Reached>,
    /// The largest growth rates of the scene and of the design, 1/s, over friction coefficients of the range.
    pub growth: Vec<Growth>,
    /// The verification of `design`.
    pub checked: Checked,
}

/// The largest growth rates at a friction coefficient.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Growth {
    /// The friction coefficient.
    pub friction: f64,
    /// That of the scene, 1/s.
    pub before: f64,
    /// That of the design, 1/s.
    pub after: f64,
}

impl Reached {
    fn of(over: &OverRange<'_>, Solved { changes, worst }: Solved) -> Self {
        Self { size: over.size(&changes), changes, worst: Worst::of(over, &worst) }
    }
}

impl DesignQuestion<'_> {
    fn over<'a>(&'a self, watch: Watch<'a>, effort: &'a Effort<'a>) -> OverRange<'a> {
        let structure = Structure {
            scene: self.scene,
            varied: self.varied,
            patterns: self.patterns,
            is_uniform: self.is_uniform,
            watch,
            effort,
        };
        OverRange { structure, range: self.range }
    }

    /// The usual number of spectra and derivatives of a search from one start.
    #[allow(clippy::cast_precision_loss)]
    fn usual_effort(&self) -> f64 {
        let values = if self.range[0] < self.range[1] { USUAL } else { USUAL_AT_ONE_VALUE };
        values * self.patterns.len() as f64
    }

    /// The start of a search with this number.
    fn start(&self, number: usize) -> Vec<f64> {
        let coordinate = |(place, one): (u64, &Varied)| {
            let [low, high] = one.bounds;
            low + (high - low) * random(self.seed, &[number as u64, place])
        };
        let corner = |end: usize| self.varied.iter().map(|one| one.bounds[end]).collect();
        match number {
            0 => vec![0.0; self.varied.len()],
            1 => corner(0),
            2 => corner(1),
            _ => (0..).zip(self.varied).map(coordinate).collect(),
        }
    }
}

/// The smallest change after which no mode of the chosen contact states has a growth rate above a limit over a range of friction
/// coefficients. `None` if the watch ended the work: finished pieces are in the journal.
///
/// # Errors
/// Returns an error if the scene cannot be analysed over the range, if a state has no derivatives, or if the journal cannot be
/// written.
pub fn design(
    question: &DesignQuestion<'_>,
    journal: &Journal,
    watch: Watch<'_>,
) -> Result<Option<FoundDesign>, Error> {
    // Searches on several threads report by turns, and none takes back what another one has reported.
    let most = Mutex::new(0.0);
    let progress = |part: f64| {
        let mut most = most.lock().unwrap_or_else(PoisonError::into_inner);
        if part > *most {
            *most = part;
            (watch.progress)(part);
        }
    };
    match found(question, journal, Watch { progress: &progress, ..watch }) {
        Err(_) if watch.is_over() => Ok(None),
        found => found,
    }
}

fn found(
    question: &DesignQuestion<'_>,
    journal: &Journal,
    watch: Watch<'_>,
) -> Result<Option<FoundDesign>, Error> {
    let part = |from: f64, to: f64| move |part: f64| (watch.progress)(from + (to - from) * part);
    // Where there are runs, they take most of the time.
    let [first, second] = if question.pushes.is_some() { [0.3, 0.4] } else { [0.75, 0.95] };
    let (of_scene, of_starts) = (part(0.0, 0.02), part(0.02, first));
    let (of_trade, of_checks) = (part(first, second), part(second, 1.0));
    let (usual, idle) = (question.usual_effort(), |_: f64| {});
    // One look at the scene takes a small part of a search.
    let (effort, effort_of_scene) =
        (Effort::new(usual, &idle), Effort::new(0.05 * usual, &of_scene));
    let over = question.over(watch, &effort);
    let scene_itself = vec![0.0; question.varied.len()];
    let Survey { worst: before, rates: before_rates } =
        question.over(watch, &effort_of_scene).survey(&scene_itself)?;
    let itself = Reached::of(&over, Solved { changes: scene_itself, worst: before });
    if before.eigenvalue.re <= -question.margin {
        let checks = Watch { progress: &part(0.02, 1.0), ..watch };
        let verified = verified(question, &over, &itself, journal, checks)?;
        return Ok(verified.map(|checked| FoundDesign {
            before: itself.worst.clone(),
            least: itself.clone(),
            is_kept: true,
            design: itself.clone(),
            agreeing: [0; 2],
            starts: Vec::new(),
            trade_off: Vec::new(),
            growth: Vec::new(),
            checked,
        }));
    }
    let is_undamped = question.margin == 0.0 && over.is_undamped()?;
    // A growth rate that makes others comparable: the way from that of the scene to the limit.
    let unit = before.eigenvalue.re + question.margin;
    // Without a margin structures are allowed that nothing damps: they have no growth rate below zero.
    let surplus = if question.margin > 0.0 { SURPLUS * unit } else { 0.0 };
    let limit = -question.margin - surplus;
    let smallest = Aim { limit, unit, is_small: true, is_undamped };
    let least = Aim { is_small: false, ..smallest };
    let parts = Mutex::new(vec![0.0; question.starts]);
    let of_start = |number: usize, part: f64| {
        let mut parts = parts.lock().unwrap_or_else(PoisonError::into_inner);
        parts[number] = f64::max(parts[number], part);
        #[allow(clippy::cast_precision_loss)]
        of_starts(parts.iter().sum::<f64>() / parts.len() as f64);
    };
    let work = |number: usize| {
        let searched = || {
            let progress = |part: f64| of_start(number, part);
            let effort = Effort::new(usual, &progress);
            let over = question.over(watch, &effort);
            let start = over.possible(question.start(number))?;
            let mut kept = over.solve(smallest, &start)?;
            let least = over.solve(least, &kept.changes)?;
            let keeps = |it: &Solved| it.worst.eigenvalue.re <= -question.margin;
            if keeps(&least) && !keeps(&kept) {
                kept = over.solve(smallest, &least.changes)?;
            }
            let [smallest, least] = [kept, least].map(|solved| Reached::of(&over, solved));
            Ok(Some(Start { smallest, least }))
        };
        let found = journal.piece(&format!("start {}", number + 1), || on_this_thread(searched))?;
        of_start(number, 1.0);
        Ok(found)
    };
    let starts = collect(question.starts, &work, &|_| {})?;
    let Some(starts) = starts.into_iter().collect::<Option<Vec<Start>>>() else { return Ok(None) };
    let all = || starts.iter().flat_map(|start| [&start.smallest, &start.least]);
    let by_growth = |a: &&Reached, b: &&Reached| a.worst.growth.total_cmp(&b.worst.growth);
    let least =
        all().min_by(by_growth).cloned().ok_or_else(|| Error::argument("there is no start"))?;
    let is_kept = |reached: &&Reached| reached.worst.growth <= -question.margin;
    let by_size = |a: &&Reached, b: &&Reached| a.size.total_cmp(&b.size);
    let kept = all().filter(is_kept).min_by(by_size).cloned();
    let agreeing = {
        let smallest = || starts.iter().map(|start| &start.smallest).filter(is_kept);
        let size = kept.as_ref().map_or(0.0, |kept| kept.size);
        [smallest().count(), smallest().filter(|it| it.size <= 1.01 * size).count()]
    };
    let chosen = kept.as_ref().unwrap_or(&least);
    let (design, after_rates) = rounded(&over, chosen, -question.margin)?;
    let trade = Watch { progress: &of_trade, ..watch };
    let trade_off = journal.piece("trade-off", || {
        trade_off(question, smallest, [&itself, &design, &least], trade).map(Some)
    })?;
    // Workers share the runs in the round of the trade-off.
    let runs = Watch { progress: &of_checks, ..watch };
    let checked = verified(question, &over, &design, journal, runs)?;
    let Some((trade_off, checked)) = trade_off.zip(checked) else { return Ok(None) };
    let both = before_rates.into_iter().zip(after_rates);
    let growth = over.finer().into_iter().zip(both);
    let growth = growth.map(|(friction, (before, after))| Growth { friction, before, after });
    Ok(Some(FoundDesign {
        before: itself.worst,
        least,
        is_kept: design.worst.growth <= -question.margin,
        design,
        agreeing,
        starts,
        trade_off,
        growth: growth.collect(),
        checked,
    }))
}

/// A change with four digits, or with as many as it takes to keep a limit (1/s) that it keeps. A change of a millionth of its
/// range is 0. With it, the largest growth rate at each value of µ.
fn rounded(
    over: &OverRange<'_>,
    reached: &Reached,
    limit: f64,
) -> Result<(Reached, Vec<f64>), Error> {
    let to = |digits: usize| {
        let pairs = over.structure.varied.iter().zip(&reached.changes);
        let changes = pairs.map(|(one, &change)| {
            let [low, high] = one.bounds;
            let is_small = change.abs() <= 1e-6 * (high - low);
            if is_small { 0.0 } else { to_significant(change, digits).clamp(low, high) }
        });
        let changes: Vec<f64> = changes.collect();
        let Survey { worst, rates } = over.survey(&changes)?;
        Ok((Reached::of(over, Solved { changes, worst }), rates))
    };
    for digits in DIGITS {
        match to(digits) {
            Err(error) if over.structure.watch.is_over() => return Err(error),
            Ok((found, rates)) if found.worst.growth <= limit.max(reached.worst.growth) => {
                return Ok((found, rates));
            }
            // Rounded values may also be impossible together.
            _ => {}
        }
    }
    Ok((reached.clone(), over.survey(&reached.changes)?.rates))
}

/// Smallest changes for growth rates between that of the scene and the least one, by size. The scene itself, the design and the
/// change with the least growth rate are among them.
///
/// It is one piece of work: each point starts from the one before, which leads along the curve from one local minimum to the next, so
/// no point can be found without those before.
///
/// # Errors
/// Returns an error if a state cannot be analysed, or if the watch has ended the work.
fn trade_off(
    question: &DesignQuestion<'_>,
    aim: Aim,
    [before, design, least]: [&Reached; 3],
    watch: Watch<'_>,
) -> Result<Vec<Reached>, Error> {
    let [from, to] = [before.worst.growth, least.worst.growth];
    let mut found = vec![before.clone()];
    if from <= to {
        return Ok(found);
    }
    #[allow(clippy::cast_precision_loss)]
    let count = question.points as f64;
    for number in 1..=question.points {
        #[allow(clippy::cast_precision_loss)]
        let number = number as f64;
        let progress = |part: f64| (watch.progress)((number - 1.0 + part) / count);
        let effort = Effort::new(question.usual_effort(), &progress);
        let over = question.over(watch, &effort);
        let part = number / (count + 1.0);
        let limit = from + (to - from) * part;
        let aim = Aim { limit, unit: from - to, ..aim };
        let last = &found[found.len() - 1];
        let mut ends = Vec::new();
        for start in [&last.changes, &design.changes] {
            ends.push(Reached::of(&over, over.solve(aim, start)?));
        }
        let is_above = |it: &Reached| it.worst.growth - limit > 1e-6 * (from - to);
        ends.sort_by(|a, b| is_above(a).cmp(&is_above(b)).then(a.size.total_cmp(&b.size)));
        found.extend(ends.into_iter().next());
        progress(1.0);
    }
    found.extend([design.clone(), least.clone()]);
    found.sort_by(|a, b| a.size.total_cmp(&b.size).then(a.worst.growth.total_cmp(&b.worst.growth)));
    // A larger change that is no better is no part of the trade-off.
    let mut best = f64::INFINITY;
    found.retain(|it| {
        let is_better = it.worst.growth < best - 1e-6 * (from - to);
        best = best.min(it.worst.growth);
        is_better
    });
    Ok(found)
}
