//! Floquet multipliers of a periodic motion: the eigenvalues of its monodromy matrix.
//!
//! The monodromy matrix maps small changes of the state (x, ẋ) at one instant to those one period later. It is the
//! product of the fundamental matrices (exp(A_k τ_k), unless a sine drives friction) and the saltation matrices of all
//! segments. Where contacts hold directions, changes are lost: the matrix has the rank of the segment in which most are
//! held, and as many multipliers are exactly zero as are held there. The others are eigenvalues of the matrix in the
//! space that this segment leaves.

use super::chain::{Chain, Linear, Segment, Unsolved, is_tangential};
use super::flow::{Flow, Stage};
use super::matrix::{null_space, product, times};
use amontons::contact::ContactState;
use amontons::integrator::Event;
use amontons::stability::eigenvalues;
use nalgebra::{Complex, DMatrix, DVector};

/// Saltation matrices of several events at one instant that differ by less, in any order of the events, are the same.
const SAME: f64 = 1e-7;

/// Multipliers, and what is known of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Multipliers {
    /// The multipliers that are not zero by rank, the largest first.
    pub values: Vec<Complex<f64>>,
    /// Number of further multipliers, which are exactly zero.
    pub zeros: usize,
    /// `true` if several events at one instant have no derivative together, since their order matters.
    pub ambiguous: bool,
    /// The multiplier of the direction along a motion without a drive, which is left out of `values`: 1 but for
    /// rounding. `None` under a drive.
    pub along: Option<f64>,
}

/// The multipliers of a chain that is solved; `None` where its eigenvalues were not found.
///
/// # Errors
/// Returns why the derivative does not exist.
pub fn multipliers(chain: &Chain, flow: &mut Flow) -> Result<Option<Multipliers>, Unsolved> {
    let linear = chain.linear(flow)?;
    let (count, motion) = (linear.len(), 2 * flow.dofs());
    let held: Vec<Vec<DVector<f64>>> =
        chain.segments.iter().map(|segment| flow.held_rows(&segment.states)).collect();
    let most = (0..count).max_by_key(|&k| held[k].len()).unwrap_or(0);
    let mut ambiguous = false;
    let units = flow.units()[..motion].to_vec();
    let mut whole = DMatrix::identity(motion, motion);
    for k in (0..count).map(|k| (most + k) % count) {
        let (across, is_one) = across(chain, flow, k, &linear[k])?;
        ambiguous |= !is_one;
        // The places of time are not changed by the motion.
        let part = |matrix: &DMatrix<f64>| matrix.view((0, 0), (motion, motion)).into_owned();
        whole = product(&part(&across), &product(&part(&linear[k].flow), &whole));
    }
    let scaled = DMatrix::from_fn(motion, motion, |i, j| whole[(i, j)] * units[j] / units[i]);
    let mut rows: Vec<DVector<f64>> =
        held[most].iter().map(|row| row.component_mul(&DVector::from_row_slice(&units))).collect();
    let zeros = motion - null_space(&rows, motion).ncols();
    // The monodromy matrix maps the rate of the motion to itself, so the others are those of the space across it.
    let mut along = None;
    if !flow.is_driven() {
        let Segment { states, start, .. } = &chain.segments[most];
        let rate = Flow::rate(&*flow.field(states, start)?, start);
        let rate = DVector::from_fn(motion, |i, _| rate[i] / units[i]);
        along = Some(rate.dot(&times(&scaled, &rate)) / rate.dot(&rate));
        rows.push(rate);
    }
    let basis = null_space(&rows, motion);
    let free = product(&basis.transpose(), &product(&scaled, &basis));
    if free.is_empty() {
        return Ok(Some(Multipliers { values: Vec::new(), zeros, ambiguous, along }));
    }
    let Some(mut values) = eigenvalues(free) else { return Ok(None) };
    let conjugates_last = |value: &Complex<f64>| value.im < 0.0;
    values.sort_by(|a, b| {
        b.norm().total_cmp(&a.norm()).then(conjugates_last(a).cmp(&conjugates_last(b)))
    });
    Ok(Some(Multipliers { values, zeros, ambiguous, along }))
}

/// The saltation matrix at the end of a segment; `false` if it depends on the order of events at one instant.
fn across(
    chain: &Chain,
    flow: &mut Flow,
    k: usize,
    linear: &Linear,
) -> Result<(DMatrix<f64>, bool), Unsolved> {
    let segment = &chain.segments[k];
    let vanishes = |row: &DVector<f64>| {
        let terms = row.iter().zip(&linear.before).map(|(a, b)| (a * b).abs()).sum::<f64>();
        row.dot(&linear.before).abs() <= SAME * terms
    };
    let y = &linear.before;
    let field = flow.field(&segment.states, y)?;
    let mut events: Vec<Cause> = Vec::new();
    for (place, stage) in segment.stages.iter().enumerate() {
        for &(contact, event) in &stage.events {
            // What a first event causes in turn is a part of it.
            let is_caused = place > 0
                && !flow.event_row(&field, y, contact, event).is_some_and(|row| vanishes(&row));
            if is_caused || events.iter().any(|known| known.contact == contact) {
                continue;
            }
            let impact = stage.impact.clone().filter(|_| event == Event::Touch);
            events.push(Cause { contact, event, impact });
        }
    }
    if segment.stages.iter().all(|stage| stage.impact.is_none()) {
        let next = &chain.segments[(k + 1) % chain.segments.len()].states;
        for (contact, (before, after)) in segment.states.iter().zip(next).enumerate() {
            let has_one = events.iter().any(|known| known.contact == contact);
            let event = implied(*before, *after).filter(|_| !has_one);
            let Some(event) = event else { continue };
            let Some(row) = flow.event_row(&field, y, contact, event) else { continue };
            if vanishes(&row) {
                events.push(Cause { contact, event, impact: None });
            }
        }
    }
    if events.len() < 2 {
        return Ok((linear.saltation(), true));
    }
    let next = &chain.segments[(k + 1) % chain.segments.len()].states;
    let backwards: Vec<Cause> = events.iter().rev().cloned().collect();
    let mut found: Vec<DMatrix<f64>> = Vec::new();
    for order in [events, backwards] {
        match one_by_one(flow, &segment.states, next, &order, linear) {
            Ok(Some(matrix)) => found.push(matrix),
            Ok(None) => return Ok((linear.saltation(), false)),
            Err(failure) => return Err(failure),
        }
    }
    // Only changes that the contacts let happen before count.
    let motion = 2 * flow.dofs();
    let allowed = null_space(&flow.held_rows(&segment.states), motion);
    let on_allowed = |matrix: &DMatrix<f64>| {
        product(&matrix.view((0, 0), (motion, motion)).into_owned(), &allowed)
    };
    let [forth, back] = [0, 1].map(|order: usize| on_allowed(&found[order]));
    let is_one = (&forth - &back).amax() <= SAME * forth.amax().max(1.0);
    Ok((if is_one { found.swap_remove(0) } else { linear.saltation() }, is_one))
}

/// An event of one contact, among several at one instant.
#[derive(Clone)]
struct Cause {
    contact: usize,
    event: Event,
    /// The impact in which a contact that touches takes part.
    impact: Option<Vec<ContactState>>,
}

/// The event of a contact that changes its state so. A contact in step with another one has it too, although the law may
/// give it the new state without.
pub(super) fn implied(before: ContactState, after: ContactState) -> Option<Event> {
    match (before, after) {
        (a, b) if a == b => None,
        (ContactState::Detached, _) => Some(Event::Touch),
        (_, ContactState::Detached) => Some(Event::Lift),
        (ContactState::Stick, slip) => Some(Event::Slip(slip)),
        _ => Some(Event::Stop),
    }
}

/// The product of the saltation matrices of events that follow each other in this order, each of which changes the state
/// of its own contact alone; `None` where one of them is met tangentially or has no function.
fn one_by_one(
    flow: &mut Flow,
    before: &[ContactState],
    after: &[ContactState],
    order: &[Cause],
    linear: &Linear,
) -> Result<Option<DMatrix<f64>>, Unsolved> {
    let mut states = before.to_vec();
    let mut y = linear.before.clone();
    let mut whole = DMatrix::identity(flow.size(), flow.size());
    for Cause { contact, event, impact } in order {
        let (contact, event) = (*contact, *event);
        let field = flow.field(&states, &y)?;
        let Some(row) = flow.event_row(&field, &y, contact, event) else { return Ok(None) };
        let rate = Flow::rate(&field, &y);
        let slope = row.dot(&rate);
        if is_tangential(&row, &rate, slope) {
            return Ok(None);
        }
        let mut then = states.clone();
        then[contact] = after[contact];
        let impact = impact.clone().map(|mut impact| {
            // Contacts that land later have impacts of their own.
            for (i, struck) in impact.iter_mut().enumerate() {
                let lands_later =
                    order.iter().any(|other| other.contact == i && other.event == Event::Touch)
                        && states[i] == ContactState::Detached;
                if i != contact && lands_later {
                    *struck = ContactState::Detached;
                }
            }
            impact
        });
        let stage = Stage { events: vec![(contact, event)], impact, states: then.clone() };
        let reset = flow.reset(&states, &stage, &y)?;
        let next = times(&reset, &y);
        let rate_after = Flow::rate(&*flow.field(&then, &next)?, &next);
        let alone = Linear {
            flow: DMatrix::identity(0, 0),
            before: y,
            rate,
            rate_after,
            row,
            times: 0,
            slope,
            reset,
        };
        whole = product(&alone.saltation(), &whole);
        (states, y) = (then, next);
    }
    Ok(Some(whole))
}
