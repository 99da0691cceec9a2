//! Basins: which points of a plane of two initial values end in which attractor.
//!
//! First a few points, spread over the plane, are followed until they are settled. What they end in has habits: how
//! much each displacement and each velocity varies over short windows. Any other point is decided as soon as it has the
//! habits of one attractor and of no other, or as it slides without a change of contact state and decays where nothing can grow; one
//! that never does is followed until it is settled.
//!
//! Unless all points are asked for, those that the picture needs are run, and the others are filled in ([`Coverage`]).

use super::attractor::attractors;
use super::initial::{initial_value, starting_from};
use super::long_term::{Kind, LongTermMotion};
use super::observation::ObservationSettings;
use super::settling::Settling;
use super::work::Work;
use super::{Journal, Watch};
use crate::regions::{Found, lines, trace, usual_islands};
use crate::spectral::Window;
use crate::stability::Linearised;
use crate::stability::parallel::collect;
use amontons::Error;
use amontons::contact::ContactState;
use amontons::integrator::EventDriven;
use amontons::model::LumpedModel;
use amontons::scene::Scene;
use amontons::simulation::Simulation;
use amontons::stability::Spectrum;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// Points along each axis that are followed until they are settled, first of all.
const FIRST: usize = 6;
/// Number of short windows in a window; with a window of 50 periods of the slowest mode, a short window has ten
/// periods.
pub const SHORT_WINDOWS: u32 = 5;
/// Number of short windows whose habits are an attractor's: those of the four windows in which a motion was found
/// settled. In the first of them a motion that converges to a periodic one may still be on its way; for a periodic
/// motion only those of the last window are used.
const HABITUAL: usize = 4 * SHORT_WINDOWS as usize;
const OF_A_CYCLE: usize = SHORT_WINDOWS as usize;
/// A point has the habits of an attractor if it keeps to them, up to `ALIKE` times the largest displacement or
/// velocity, over `KEPT` short windows. Cycles of one size and nearly one frequency differ by more.
const ALIKE: f64 = 2e-3;
const KEPT: usize = 2;
/// The part of the longest time that a point takes which is decided early, as an estimate for the remaining work.
const EARLY: f64 = 0.05;
/// Points that are one piece of work.
const PIECE: usize = 8;
/// The part of the points that a traced plane runs, and the rounds that it runs them in, as estimates for the
/// remaining work.
const TRACED: f64 = 0.1;
const ROUNDS: f64 = 3.0;

/// The points of a plane that are run, and the time for which they are run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coverage {
    /// The points of some columns and rows are run, and those that show where basins meet; the others are filled in. An
    /// island of this width and height, in points, is found wherever it lies; a smaller one, or a tongue that is
    /// narrower, can be missed ([`usual_islands`]).
    Traced([usize; 2]),
    /// Every point is run.
    EveryPoint,
    /// Every point is run until it has settled; none is decided early.
    EveryPointSettled,
}

/// An initial value along an axis of the plane.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Axis {
    /// Name of the initial value.
    pub name: String,
    /// Values, ascending; m or m/s.
    pub values: Vec<f64>,
}

/// The result of one point.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cell {
    /// The attractor of the point; `None` if it has not settled, or failed.
    pub attractor: Option<usize>,
    /// `true` if the point was run; `false` if it is filled in, since it lies midway between points that end in its
    /// attractor.
    pub run: bool,
    /// `true` if it was decided before it had settled.
    pub early: bool,
    /// The reason of a failure.
    pub failure: Option<String>,
}

/// The attractors of all points of a plane.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Basin {
    /// One ending of each attractor: rest first, then cycles by amplitude.
    pub attractors: Vec<LongTermMotion>,
    /// A row for each value of y, from the first on; in it a cell for each value of x.
    pub rows: Vec<Vec<Cell>>,
}

/// The knowledge of a point, as it is noted.
#[derive(Clone, Debug, Serialize, Deserialize)]
enum PointOutcome {
    /// The point has the habits of this one of the attractors of the first points.
    Early(usize),
    /// The point was followed until it was settled, or for as long as may be; with its habits.
    Settled(Box<LongTermMotion>, Vec<[f64; 2]>),
    Failed(String),
}

/// An attractor of the first points.
struct KnownAttractor {
    ending: LongTermMotion,
    /// The smallest and the largest size of each displacement and velocity.
    habits: Vec<[f64; 2]>,
}

/// The knowledge that is available before a point is followed.
#[derive(Default)]
struct Knowledge {
    /// The attractors that the first points end in.
    attractors: Vec<KnownAttractor>,
    /// The states of all contacts at rest, where they end there and it is stable.
    resting: Option<Vec<ContactState>>,
}

/// A plane of more points would take days.
const MOST_POINTS: usize = 1_000_000;

/// Refuses a plane of too many points, before the work on it.
///
/// # Errors
/// Returns an error if it has more than a million points.
pub fn check_points([x, y]: [&Axis; 2]) -> Result<(), Error> {
    let [columns, rows] = [x, y].map(|axis| axis.values.len());
    match columns * rows {
        points if points > MOST_POINTS => Err(Error::argument(format!(
            "{columns} by {rows} values are {points} points, but a plane has at most {MOST_POINTS}; give fewer values"
        ))),
        _ => Ok(()),
    }
}

/// Finds what each point of the plane ends in. The scene's other initial values stay as they are. `None` if the watch
/// ended it: what was finished is in the journal, which continues with the same coverage.
///
/// # Errors
/// No such initial value, one for both axes, a plane without a point that can run, or a journal that cannot be
/// written.
pub fn basin(
    scene: &Scene,
    [x, y]: [&Axis; 2],
    observation: &ObservationSettings,
    coverage: Coverage,
    journal: &Journal,
    watch: Watch<'_>,
) -> Result<Option<Basin>, Error> {
    check_points([x, y])?;
    let names = [initial_value(scene, &x.name)?, initial_value(scene, &y.name)?];
    if names[0] == names[1] {
        return Err(Error::argument(format!(
            "both axes vary {}; choose another initial value for one of them",
            names[0]
        )));
    }
    let plane = Plane { scene, names, axes: [x, y], observation, journal, watch };
    let mut found: Vec<Option<PointOutcome>> = vec![None; x.values.len() * y.values.len()];
    let mut knowledge = Knowledge::default();
    let mut part = 0.0;
    if coverage != Coverage::EveryPointSettled {
        let first = plane.first_points();
        let others = if matches!(coverage, Coverage::Traced(_)) { TRACED } else { 1.0 };
        #[allow(clippy::cast_precision_loss)]
        let [own, all] = [first.len(), found.len()].map(|count| count as f64);
        part = own / (own + EARLY * others * all);
        let Some(()) = plane.run("first", &first, &knowledge, [0.0, part], &mut found)? else {
            return Ok(None);
        };
        let ends: Vec<&PointOutcome> =
            first.iter().filter_map(|&place| found[place].as_ref()).collect();
        knowledge = Knowledge::of(scene, &ends);
    }
    let filled = if let Coverage::Traced(islands) = coverage {
        plane.trace(islands, &knowledge, part, &mut found)?
    } else {
        let all: Vec<usize> = (0..found.len()).collect();
        let done = plane.run("all", &all, &knowledge, [part, 1.0], &mut found)?;
        done.map(|()| vec![None; found.len()])
    };
    let Some(filled) = filled else { return Ok(None) };
    let mut ends = found.iter().flatten();
    if let Some(PointOutcome::Failed(reason)) = ends.next()
        && ends.all(|end| matches!(end, PointOutcome::Failed(_)))
    {
        return Err(Error::scene(format!("no point of the plane can run: {reason}")));
    }
    let (attractors, cells) = cells(&knowledge.attractors, &found);
    let filled_in = |attractor| Cell { attractor, run: false, early: false, failure: None };
    let cells = cells.into_iter().zip(filled);
    let cells = cells.map(|(cell, attractor)| cell.unwrap_or_else(|| filled_in(attractor)));
    let cells: Vec<Cell> = cells.collect();
    let rows = cells.chunks(x.values.len()).map(<[Cell]>::to_vec).collect();
    Ok(Some(Basin { attractors, rows }))
}

/// The plane and how its points are followed.
struct Plane<'a> {
    scene: &'a Scene,
    names: [String; 2],
    axes: [&'a Axis; 2],
    observation: &'a ObservationSettings,
    journal: &'a Journal,
    watch: Watch<'a>,
}

/// A point on its way.
struct Trajectory {
    settling: Settling,
    meter: VariationMeter,
    changes: u64,
    /// Sizes over the last short windows, and over how many of them it kept to which habits.
    sizes: VecDeque<Vec<f64>>,
    kept: (Option<usize>, usize),
    /// The size over the last short window, where no contact changed its state and all rested.
    calm: Option<f64>,
}

impl Plane<'_> {
    fn size(&self) -> [usize; 2] {
        self.axes.map(|axis| axis.values.len())
    }

    /// The places of the first points, row by row from 0 on. They are among those that the usual tracing runs anyway.
    fn first_points(&self) -> Vec<usize> {
        let (size, islands) = (self.size(), usual_islands(self.size()));
        let [columns, rows] = [0, 1].map(|axis| {
            let lines = lines(size[axis], islands[axis]);
            spread(lines.len()).into_iter().map(|line| lines[line]).collect::<Vec<_>>()
        });
        let of_row = |row: &usize| {
            let row = *row;
            columns.iter().map(move |column| row * size[0] + column)
        };
        rows.iter().flat_map(of_row).collect()
    }

    /// Runs those of these points that were not run before, and notes what they end in; `None` if the watch ended it. `parts`: the
    /// progress before and after, as parts of all work.
    fn run(
        &self,
        name: &str,
        places: &[usize],
        knowledge: &Knowledge,
        parts: [f64; 2],
        found: &mut [Option<PointOutcome>],
    ) -> Result<Option<()>, Error> {
        let [x, y] = self.axes;
        let point =
            |place: usize| [x.values[place % x.values.len()], y.values[place / x.values.len()]];
        let due = places.iter().copied().filter(|place| found[*place].is_none());
        let (due, points): (Vec<usize>, Vec<[f64; 2]>) =
            due.map(|place| (place, point(place))).unzip();
        let pieces: Vec<&[[f64; 2]]> = points.chunks(PIECE).collect();
        let meter = Work::of(points.len(), parts, self.watch);
        let work = |i: usize| {
            let (points, count) = (pieces[i], pieces[i].len());
            let key = format!("{name}, {:?} to {:?}, {count}", points[0], points[count - 1]);
            meter.piece(count, |told| {
                self.journal.piece(&key, || {
                    Ok(points.iter().map(|&point| self.ending(point, knowledge, told)).collect())
                })
            })
        };
        let ends: Option<Vec<Vec<PointOutcome>>> =
            collect(pieces.len(), &work, &|_| {})?.into_iter().collect();
        let Some(ends) = ends else { return Ok(None) };
        for (place, end) in due.into_iter().zip(ends.into_iter().flatten()) {
            found[place] = Some(end);
        }
        Ok(Some(()))
    }

    /// Runs the points that show where basins meet, and islands of this size; the attractors that the others are filled
    /// in with, or `None` if the watch ended it. This part of all work is done before.
    fn trace(
        &self,
        islands: [usize; 2],
        knowledge: &Knowledge,
        mut part: f64,
        found: &mut [Option<PointOutcome>],
    ) -> Result<Option<Vec<Option<usize>>>, Error> {
        let mut round = 0;
        trace(self.size(), islands, &mut |places| {
            round += 1;
            // The last of the expected rounds takes half of the remaining work, as any further one does: it may not
            // be the last.
            let begin = part;
            part += (1.0 - part) / f64::max(ROUNDS + 1.0 - f64::from(round), 2.0);
            let name = format!("round {round}");
            let done = self.run(&name, places, knowledge, [begin, part], found)?;
            let ends = || {
                let (_, cells) = cells(&knowledge.attractors, found);
                let end = |cell: Option<Cell>| -> Found<usize> { cell.map(|cell| cell.attractor) };
                cells.into_iter().map(end).collect()
            };
            Ok(done.map(|()| ends()))
        })
    }

    /// Runs a point and gives its end, which may be that it fails; `None` if the watch ended the run.
    fn ending(
        &self,
        point: [f64; 2],
        knowledge: &Knowledge,
        told: &dyn Fn(f64),
    ) -> Option<PointOutcome> {
        self.follow(point, knowledge, told)
            .unwrap_or_else(|error| Some(PointOutcome::Failed(error.to_string())))
    }

    /// Follows a point until it is decided; `None` if the watch ended it.
    fn follow(
        &self,
        [x, y]: [f64; 2],
        knowledge: &Knowledge,
        told: &dyn Fn(f64),
    ) -> Result<Option<PointOutcome>, Error> {
        let scene = starting_from(self.scene, &[(&self.names[0], x), (&self.names[1], y)])?;
        let mut simulation = Simulation::new(scene, 0.0)?;
        let mut trajectory = Trajectory::new(Settling::new(&simulation, self.observation)?);
        #[allow(clippy::cast_possible_truncation)]
        let rows = self.observation.rows() as usize / SHORT_WINDOWS as usize;
        #[allow(clippy::cast_precision_loss)]
        let short = rows as f64 * self.observation.interval;
        let weights = Window::Hann.weights(rows);
        loop {
            let mut found = None;
            for (row, weight) in weights.iter().enumerate() {
                if row % 256 == 0 && self.watch.is_over() {
                    return Ok(None);
                }
                simulation.advance_to(trajectory.settling.next_time())?;
                found = trajectory.note(&mut simulation, *weight, &|| self.watch.is_over())?;
                if found.is_some() {
                    break;
                }
            }
            if self.watch.is_over() {
                return Ok(None);
            }
            if let Some(found) = found.or_else(|| trajectory.judge(&simulation, knowledge)) {
                told(1.0 - (simulation.time() - short) / self.observation.longest);
                return Ok(Some(found));
            }
            told(short / self.observation.longest);
        }
    }
}

impl Trajectory {
    fn new(settling: Settling) -> Self {
        Self {
            settling,
            meter: VariationMeter::default(),
            changes: 0,
            sizes: VecDeque::new(),
            kept: (None, 0),
            calm: None,
        }
    }

    /// Takes note of a row, which has this weight in its short window; the ending if the motion has now settled.
    fn note(
        &mut self,
        simulation: &mut Simulation,
        weight: f64,
        is_over: &dyn Fn() -> bool,
    ) -> Result<Option<PointOutcome>, Error> {
        self.meter.note(simulation.displacement(), simulation.velocity(), weight);
        let Some(ending) = self.settling.note(simulation, is_over)? else { return Ok(None) };
        let last = if ending.kind == Kind::Periodic { OF_A_CYCLE } else { HABITUAL };
        let habits = habits(self.sizes.iter().rev().take(last));
        Ok(Some(PointOutcome::Settled(Box::new(ending), habits)))
    }

    /// Judges the motion at the end of a short window; the attractor if it is decided.
    fn judge(
        &mut self,
        simulation: &Simulation,
        Knowledge { attractors, resting, .. }: &Knowledge,
    ) -> Option<PointOutcome> {
        let sizes = self.meter.take();
        let changes = simulation.statistics().state_changes();
        let is_calm = changes == self.changes
            && resting.as_ref().is_some_and(|states| states == simulation.contact_states());
        self.changes = changes;
        let size = sizes.iter().sum::<f64>();
        let before = std::mem::replace(&mut self.calm, is_calm.then_some(size));
        let alike = if self.calm.is_some_and(|size| before.is_some_and(|before| size < before)) {
            self.kept.1 = KEPT;
            attractors.iter().position(|known| known.ending.kind == Kind::Equilibrium)
        } else {
            // Two that have the same habits are not told apart by them.
            let mut alike = (0..attractors.len()).filter(|place| attractors[*place].has(&sizes));
            let alike = alike.next().filter(|_| alike.next().is_none());
            self.kept.1 = if alike == self.kept.0 { self.kept.1 + 1 } else { 1 };
            alike
        };
        self.kept.0 = alike;
        self.sizes.push_back(sizes);
        if self.sizes.len() > HABITUAL {
            self.sizes.pop_front();
        }
        alike.filter(|_| self.kept.1 >= KEPT).map(PointOutcome::Early)
    }
}

impl KnownAttractor {
    /// `true` if these are the sizes of a short window of this attractor.
    fn has(&self, sizes: &[f64]) -> bool {
        if !self.ending.kind.is_cycle() {
            return false;
        }
        let half = sizes.len() / 2;
        let parts = [0..half, half..sizes.len()];
        parts.into_iter().all(|part| {
            let habits = &self.habits[part.clone()];
            let margin = ALIKE * habits.iter().fold(0.0, |most, habit| f64::max(most, habit[1]));
            let mut pairs = sizes[part].iter().zip(habits);
            pairs.all(|(size, [low, high])| (low - margin..=high + margin).contains(size))
        })
    }
}

/// Variation of displacements and velocities: weighted sums over a short window. Weights that begin and end at zero
/// make it nearly independent of the phase at which the window began.
#[derive(Default)]
struct VariationMeter {
    weight: f64,
    sums: Vec<[f64; 2]>,
}

impl VariationMeter {
    fn note(&mut self, displacement: &[f64], velocity: &[f64], weight: f64) {
        self.sums.resize(displacement.len() + velocity.len(), [0.0; 2]);
        self.weight += weight;
        for (sum, value) in self.sums.iter_mut().zip(displacement.iter().chain(velocity)) {
            sum[0] += weight * value;
            sum[1] += weight * value * value;
        }
    }

    /// Root mean square about the mean of each displacement and then each velocity; begins anew.
    fn take(&mut self) -> Vec<f64> {
        let Self { weight, sums } = std::mem::take(self);
        let size = |[sum, squares]: &[f64; 2]| {
            let mean = sum / weight;
            (squares / weight - mean * mean).max(0.0).sqrt()
        };
        sums.iter().map(size).collect()
    }
}

/// The smallest and the largest of each size.
fn habits<'a>(windows: impl Iterator<Item = &'a Vec<f64>>) -> Vec<[f64; 2]> {
    let mut habits: Vec<[f64; 2]> = Vec::new();
    for sizes in windows {
        habits.resize(sizes.len(), [f64::INFINITY, 0.0]);
        for (habit, size) in habits.iter_mut().zip(sizes) {
            *habit = [habit[0].min(*size), habit[1].max(*size)];
        }
    }
    habits
}

impl Knowledge {
    /// Collects what the first points, which end so, tell of all others.
    fn of(scene: &Scene, found: &[&PointOutcome]) -> Self {
        let attractors = what_is_known(found);
        let rests = attractors.iter().any(|known| known.ending.kind == Kind::Equilibrium);
        Self { attractors, resting: rests.then(|| stable_rest(scene)).flatten() }
    }
}

/// The attractors that points have ended in, with the habits of all that ended in each.
fn what_is_known(found: &[&PointOutcome]) -> Vec<KnownAttractor> {
    let settled = found.iter().filter_map(|found| match found {
        PointOutcome::Settled(ending, habits) => Some((&**ending, habits)),
        _ => None,
    });
    let settled: Vec<(&LongTermMotion, &Vec<[f64; 2]>)> = settled.collect();
    let (endings, places) = attractors(settled.iter().map(|(ending, _)| Some(*ending)));
    let mut known: Vec<KnownAttractor> =
        endings.into_iter().map(|ending| KnownAttractor { ending, habits: Vec::new() }).collect();
    for ((_, habits), place) in settled.iter().zip(places) {
        let Some(place) = place else { continue };
        let own = &mut known[place].habits;
        own.resize(habits.len(), [f64::INFINITY, 0.0]);
        for (own, habit) in own.iter_mut().zip(*habits) {
            *own = [own[0].min(habit[0]), own[1].max(habit[1])];
        }
    }
    known
}

/// The state in which all contacts rest, if nothing grows in it and a motion without a change of state is linear and
/// free: a motion that decays there continues to do so.
fn stable_rest(scene: &Scene) -> Option<Vec<ContactState>> {
    let model = LumpedModel::from(scene);
    if !scene.signals.is_empty() || EventDriven::new(&model).is_err() {
        return None;
    }
    let here = Linearised::of(scene);
    let states = here.resting_state();
    let spectrum = Spectrum::of(here.linear().ok()?, &states).ok()?;
    (spectrum.growth_rate() < 0.0).then_some(states)
}

/// Places spread over `count` places, none at an end where it can be helped.
fn spread(count: usize) -> Vec<usize> {
    let some = count.min(FIRST);
    (0..some).map(|i| (2 * i + 1) * count / (2 * some)).collect()
}

/// All attractors, and the cell of each point that was run.
fn cells(
    known: &[KnownAttractor],
    found: &[Option<PointOutcome>],
) -> (Vec<LongTermMotion>, Vec<Option<Cell>>) {
    let first = known.iter().map(|known| Some(&known.ending));
    let settled = found.iter().map(|found| match found {
        Some(PointOutcome::Settled(ending, _)) => Some(&**ending),
        _ => None,
    });
    let (attractors, places) = attractors(first.chain(settled));
    let (first, settled) = places.split_at(known.len());
    let cell = |attractor, early, failure| Cell { attractor, run: true, early, failure };
    let cells = found.iter().zip(settled).map(|(found, &place)| {
        found.as_ref().map(|found| match found {
            PointOutcome::Early(known) => cell(first[*known], true, None),
            PointOutcome::Settled(..) => cell(place, false, None),
            PointOutcome::Failed(why) => cell(None, false, Some(why.clone())),
        })
    });
    (attractors, cells.collect())
}
