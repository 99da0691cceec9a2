//! From a motion that nearly comes back to a periodic one.

use super::chain::{Chain, Unsolved};
use super::check::{Difference, compare};
use super::extremes::extremes;
use super::flow::{Flow, Instant};
use super::multipliers::{Multipliers, implied, multipliers};
use super::{Orbit, OrbitEvent, OrbitStart};
use amontons::contact::ContactState;
use amontons::integrator::{Event, EventRecord, Motion, StepFailure};
use amontons::numerics::max_norm;
use amontons::simulation::Simulation;
use std::borrow::Cow;

/// Most sequences of events that are solved for one orbit.
const MOST_SEQUENCES: usize = 24;
/// Most events of one period.
const MOST_EVENTS: usize = 2000;
/// Most periods of the drive in one of the motion, and the other way round.
const MOST_PERIODS: u32 = 64;
/// A return may come this much sooner or later than expected, in parts of the period.
const EARLY: f64 = 0.75;
const LATE: f64 = 1.25;

/// A motion that nearly comes back.
#[derive(Clone, Debug)]
pub struct Start {
    /// The motion.
    pub motion: Motion,
    /// The time of the flow at which it is there, s; of no meaning without a drive.
    pub time: f64,
    /// The period, s, as far as it is known; under a drive exactly. `None`: the nearest return within `longest`.
    pub period: Option<f64>,
    /// How long a return may take, s, where the period is not known, and the time in which it is looked for.
    pub longest: f64,
}

/// The reason why there is no orbit.
#[derive(Clone, Debug, PartialEq)]
pub enum NoOrbit {
    /// A step of the integrator, or a contact problem, failed.
    Failed(StepFailure),
    /// No contact changes its state, and nothing drives the motion: its size is not determined by itself.
    Linear,
    /// No instant of the run comes back.
    NoReturn,
    /// One period has too many events.
    TooManyEvents {
        /// The most.
        most: usize,
    },
    /// Contacts hold more directions than their masses have, and an event among them has no function.
    Overheld,
    /// Sines drive the motion that have no common period, or none that is known.
    NoCommonPeriod,
    /// The eigenvalues of the monodromy matrix were not found.
    NoMultipliers,
    /// The iteration ended at a distance from a periodic motion.
    NotConverged {
        /// The largest gap that was left, in parts of the motion's size.
        residual: f64,
        /// The time of the instant at which the motion is tangential, s, if that is the reason.
        grazing: Option<f64>,
        /// Number of sequences of events that were solved.
        sequences: usize,
        /// The motion with this gap; `None` if no sequence was solved to its end.
        best: Option<Box<OrbitStart>>,
    },
}

impl From<StepFailure> for NoOrbit {
    fn from(failure: StepFailure) -> Self {
        Self::Failed(failure)
    }
}

impl NoOrbit {
    /// The motion at which Newton's method ended, if that is the reason.
    #[must_use]
    pub fn best(self) -> Option<Box<OrbitStart>> {
        match self {
            Self::NotConverged { best, .. } => best,
            _ => None,
        }
    }

    /// The reason in words, with the names that things have in the scene of the simulation.
    #[must_use]
    pub fn words(&self, simulation: &Simulation) -> String {
        match self {
            Self::Failed(failure) => {
                format!("the motion cannot be followed: {}", simulation.reason(*failure))
            }
            Self::Linear => {
                "no contact changes its state and nothing drives the motion: it is linear, and periodic motions of every \
                 size are beside it"
                    .to_owned()
            }
            Self::NoReturn => {
                "no change of contact state of the run comes back: contacts may change their states in its beginning \
                 only, or the motion is not periodic"
                    .to_owned()
            }
            Self::TooManyEvents { most } => {
                format!("one period has more than {most} changes of contact state")
            }
            Self::Overheld => {
                "contacts hold more directions than their masses have, and the instant at which they part has no \
                 derivative"
                    .to_owned()
            }
            Self::NoCommonPeriod => {
                "the sines that drive it have no common period that is short enough to be followed".to_owned()
            }
            Self::NoMultipliers => "the eigenvalues of its monodromy matrix were not found".to_owned(),
            Self::NotConverged { residual, grazing, sequences, .. } => {
                let ended = format!(
                    "Newton's method ended at a gap of {residual:.1e} of the motion's size, after {sequences} sequences of \
                     events; there may be none with these values, and `amontons study branches` shows where one ends"
                );
                match grazing {
                    Some(time) => format!(
                        "{ended}; {time:.6e} s after its beginning the motion meets an event tangentially, where it has no \
                         derivative"
                    ),
                    None => ended,
                }
            }
        }
    }
}

/// Solves for the periodic motion near a start. `goes_on` is asked before each sequence of events.
///
/// # Errors
/// Returns why no orbit was found. `None` where `goes_on` has ended the search.
pub fn search(
    flow: &mut Flow,
    start: &Start,
    goes_on: &dyn Fn() -> bool,
) -> Result<Option<(Orbit, Chain)>, NoOrbit> {
    let mut start = start.clone();
    if flow.is_driven() {
        // The motion may come back sooner than a sine that it does not feel.
        let multiples = (1..=MOST_PERIODS).map(f64::from);
        let period = start.period.and_then(|period| {
            multiples.map(|n| n * period).find(|period| flow.returns_after(*period))
        });
        start.period = Some(period.ok_or(NoOrbit::NoCommonPeriod)?);
    }
    let mut best = Best { residual: f64::INFINITY, grazing: None, chain: None };
    let mut tried = 0;
    for sequences in 1..=MOST_SEQUENCES {
        tried = sequences;
        if !goes_on() {
            return Ok(None);
        }
        let mut chain = match closed(flow, &start, sequences > 1) {
            Err(NoOrbit::NoReturn) if sequences > 1 => break,
            chain => chain?,
        };
        if chain.segments.len() > MOST_EVENTS {
            return Err(NoOrbit::TooManyEvents { most: MOST_EVENTS });
        }
        let outcome = chain.solve(flow);
        let residual = chain.largest_gap(flow).unwrap_or(f64::INFINITY);
        let grazing = match outcome {
            Ok(_) => {
                let shorter = chain.of_shortest_period(flow.dofs()).filter(|_| !flow.is_driven());
                if let Some(shorter) = shorter {
                    chain = shorter;
                    let _ = chain.solve(flow);
                }
                if let Some(shorter) = shorter_drive(&chain, flow)? {
                    start.period = Some(shorter);
                    continue;
                }
                if let Difference::None { defect, closure } = compare(&chain, flow)? {
                    return Ok(Some((orbit(&chain, flow, [defect, closure])?, chain)));
                }
                None
            }
            Err(Unsolved::Failed(failure)) => return Err(failure.into()),
            Err(Unsolved::Unknown { .. }) => return Err(NoOrbit::Overheld),
            Err(Unsolved::Grazes { segment }) => {
                let before = chain.segments[..=segment].iter();
                Some(before.map(|segment| segment.duration).sum())
            }
            Err(Unsolved::Stalled) => None,
        };
        if residual < best.residual || best.grazing.is_none() && best.residual.is_infinite() {
            best = Best { residual, grazing, chain: Some(chain.clone()) };
        }
        let first = &chain.segments[0];
        start.motion = flow.motion(&first.start, &first.states);
        start.time = flow.time_of(chain.turn);
        start.period = start.period.filter(|_| flow.is_driven()).or(Some(chain.period()));
    }
    let Best { residual, grazing, chain } = best;
    let best = match chain {
        Some(chain) => Some(Box::new(begun_with_drive(&chain, flow)?.1)),
        None => None,
    };
    Err(NoOrbit::NotConverged { residual, grazing, sequences: tried, best })
}

/// The chain with the smallest gap so far, and its place where it is tangential ([`NoOrbit::NotConverged`]).
struct Best {
    residual: f64,
    grazing: Option<f64>,
    chain: Option<Chain>,
}

/// The chain that begins at time 0 if sines drive it, and its beginning.
fn begun_with_drive<'a>(
    chain: &'a Chain,
    flow: &mut Flow,
) -> Result<(Cow<'a, Chain>, OrbitStart), StepFailure> {
    let chain = if flow.is_driven() && chain.turn != 0.0 {
        Cow::Owned(chain.begun_later(flow, -flow.time_of(chain.turn))?)
    } else {
        Cow::Borrowed(chain)
    };
    let first = &chain.segments[0];
    let mut motion = flow.motion(&first.start, &first.states);
    clear_rounding(flow, &mut motion);
    let Motion { displacement, velocity, contacts, .. } = motion;
    let start = OrbitStart { period: chain.period(), displacement, velocity, states: contacts };
    Ok((chain, start))
}

/// The shortest period under a drive after which a motion repeats itself, if that is a part of the chain's.
fn shorter_drive(chain: &Chain, flow: &mut Flow) -> Result<Option<f64>, StepFailure> {
    if !flow.is_driven() {
        return Ok(None);
    }
    for parts in (2..=MOST_PERIODS).rev() {
        let period = chain.period() / f64::from(parts);
        if !flow.returns_after(period) {
            continue;
        }
        let later = chain.begun_later(flow, period)?;
        let [now, then] = [&chain.segments[0], &later.segments[0]];
        if now.states == then.states && chain.size(flow.dofs(), &(&then.start - &now.start)) < 1e-8
        {
            return Ok(Some(period));
        }
    }
    Ok(None)
}

/// The chain of a run from the start until it nearly comes back. Under a drive `again` runs one period before: contacts
/// then have the states in which the motion really passes the phase of the start.
fn closed(flow: &mut Flow, start: &Start, again: bool) -> Result<Chain, NoOrbit> {
    let Start { motion, time, period, longest } = start;
    if let (true, Some(period)) = (flow.is_driven(), *period) {
        let few = |records: &[EventRecord]| records.len() <= MOST_EVENTS;
        let motion = if again { flow.run(motion, *time, period, few)?.0 } else { motion.clone() };
        let (_, mut instants) = flow.run(&motion, *time, period, few)?;
        instants.retain(|instant| instant.time > 0.0 || instant.is_change());
        return Ok(Chain::of_run(flow, &motion, *time, &instants, Some(period))?);
    }
    let duration = period.map_or(*longest, |period| (1.0 + LATE) * period);
    let (_, instants) =
        flow.run(motion, 0.0, duration, |records| records.len() <= 4 * MOST_EVENTS)?;
    if instants.is_empty() {
        return Err(NoOrbit::Linear);
    }
    let (from, to) = nearest_return(flow, &instants, *period).ok_or(NoOrbit::NoReturn)?;
    let shifted: Vec<Instant> = instants[from + 1..=to]
        .iter()
        .map(|instant| Instant { time: instant.time - instants[from].time, ..instant.clone() })
        .collect();
    Ok(Chain::of_run(flow, &instants[from].after, 0.0, &shifted, None)?)
}

/// The two instants of a run with the same events whose states are nearest to each other. Where the period is not known,
/// the shortest of the returns that are about as near.
fn nearest_return(
    flow: &Flow,
    instants: &[Instant],
    period: Option<f64>,
) -> Option<(usize, usize)> {
    /// Returns within this factor of the nearest are as near.
    const ABOUT: f64 = 4.0;
    let n = flow.dofs();
    let scale = |values: fn(&Motion) -> &[f64]| {
        let sizes = instants.iter().flat_map(|instant| values(&instant.after));
        sizes.fold(f64::MIN_POSITIVE, |most: f64, value| most.max(value.abs()))
    };
    let scales = [scale(|motion| &motion.displacement), scale(|motion| &motion.velocity)];
    let distance = |a: &Motion, b: &Motion| {
        let parts = (0..n).map(|i| {
            let place = (a.displacement[i] - b.displacement[i]).abs() / scales[0];
            place.max((a.velocity[i] - b.velocity[i]).abs() / scales[1])
        });
        parts.fold(0.0, f64::max)
    };
    let mut found: Vec<(f64, f64, usize, usize)> = Vec::new();
    for (from, first) in instants.iter().enumerate() {
        for (to, last) in instants.iter().enumerate().skip(from + 1) {
            let time = last.time - first.time;
            let is_due = period.is_none_or(|p| EARLY * p <= time && time <= LATE * p);
            if !is_due || !first.is_like(last) {
                if period.is_some_and(|p| time > LATE * p) {
                    break;
                }
                continue;
            }
            found.push((distance(&first.after, &last.after), time, from, to));
        }
    }
    let nearest = found.iter().map(|entry| entry.0).fold(f64::INFINITY, f64::min);
    let alike = found.iter().filter(|entry| entry.0 <= ABOUT * nearest.max(1e-9));
    alike.min_by(|a, b| a.1.total_cmp(&b.1)).map(|&(.., from, to)| (from, to))
}

/// Puts gaps that are zero but for rounding to zero, with their rates where contacts are closed: otherwise a run that
/// begins there would begin with a contact that is open, or inside its surface.
fn clear_rounding(flow: &Flow, motion: &mut Motion) {
    /// The largest rounding of a gap, in parts of the largest displacement.
    const ROUNDING: f64 = 1e-12;
    let least = ROUNDING * max_norm(&motion.displacement);
    for (contact, state) in flow.model.contacts.iter().zip(&motion.contacts) {
        // A gap between masses is a difference, whose rounding a run expects.
        let &[(dof, part)] = contact.normal.0.as_slice() else { continue };
        let closed = 0.0 - contact.gap / part;
        if (motion.displacement[dof] - closed).abs() <= least {
            motion.displacement[dof] = closed;
            if *state != ContactState::Detached {
                motion.velocity[dof] = 0.0;
            }
        }
    }
}

/// The orbit of a chain that is solved and confirmed.
///
/// # Errors
/// Returns why its multipliers do not exist.
pub(super) fn orbit(
    chain: &Chain,
    flow: &mut Flow,
    [defect, closure]: [f64; 2],
) -> Result<Orbit, NoOrbit> {
    let found = multipliers(chain, flow).map_err(|unsolved| match unsolved {
        Unsolved::Failed(failure) => NoOrbit::Failed(failure),
        _ => NoOrbit::Overheld,
    })?;
    let Multipliers { values, zeros, ambiguous, along } = found.ok_or(NoOrbit::NoMultipliers)?;
    let driven = flow.is_driven();
    let (chain, start) = begun_with_drive(chain, flow)?;
    let multipliers = values.iter().map(|value| [value.re, value.im]).collect();
    let extents =
        extremes(&chain, flow)?.iter().map(|[least, most]| 0.5 * (most - least)).collect();
    let mut time = 0.0;
    let mut events = Vec::new();
    for (k, segment) in chain.segments.iter().enumerate() {
        time += segment.duration;
        if segment.stages.is_empty() {
            continue;
        }
        let next = &chain.segments[(k + 1) % chain.segments.len()];
        let mut own: Vec<(usize, Event)> =
            segment.stages.iter().flat_map(|stage| stage.events.iter().copied()).collect();
        // The law may give a contact its new state together with another one that has an event.
        for contact in 0..next.states.len() {
            if own.iter().all(|event| event.0 != contact) {
                let event = implied(segment.states[contact], next.states[contact]);
                own.extend(event.map(|event| (contact, event)));
            }
        }
        own.sort_by_key(|event| event.0);
        events.push(OrbitEvent { time, events: own, states: next.states.clone() });
    }
    let OrbitStart { period, displacement, velocity, states } = start;
    Ok(Orbit {
        period,
        displacement,
        velocity,
        states,
        events,
        extents,
        multipliers,
        along,
        zeros,
        ambiguous,
        defect,
        closure,
        driven,
        energy: None,
    })
}
