//! Velocities, powers and contact states of a motion that has settled.
//!
//! They are found over one period or, where the motion has none, over a window. Powers follow from the energy ledger,
//! whose entries are exact between events but for rounding in event-driven motion. Velocities are looked at in rows at
//! equal times, at least [`FEWEST_ROWS`] of them and [`ROWS_A_ROW`] for each row of the observation.

use super::super::long_term::{Kind, LongTermMotion};
use super::super::observation::ObservationSettings;
use super::points::MeasuredPoint;
use super::shares::{ModalShares, ModeShare};
use amontons::Error;
use amontons::contact::JoinedStates;
use amontons::scene::Scene;
use amontons::simulation::Simulation;
use serde::{Deserialize, Serialize};

/// The fewest rows of a span. Half of them are taken alone, too, to tell the error of the mean square.
const FEWEST_ROWS: f64 = 2000.0;
/// Rows for each row of the observation, of which the fastest mode's period has 20: a peak between two of 80 rows is missed
/// by less than 1e-3.
const ROWS_A_ROW: f64 = 4.0;
/// States that contacts take together for less than this part of the time are not listed, nor more than this number.
const LEAST_SHARE: f64 = 1e-3;
const MOST_STATES: usize = 8;

/// The motion of one point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PointMotion {
    /// The name of the point.
    pub point: String,
    /// Half of the largest peak-to-peak displacement along its axes, m.
    pub amplitude: f64,
    /// Root mean square of its speed, m/s.
    pub rms: f64,
    /// The largest speed, m/s.
    pub peak: f64,
    /// Root mean square of its velocity along the normal of its contact's surface, m/s, of several contacts the largest;
    /// `None` of a point without a contact.
    pub normal_rms: Option<f64>,
    /// The largest velocity along the normal, m/s.
    pub normal_peak: Option<f64>,
}

/// The power of the friction of one contact.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactPower {
    /// The name of the contact.
    pub contact: String,
    /// Mean power that friction feeds into the structure, W: the mean of T u_T, of impacts too, with the friction force T
    /// on the masses and their velocity u_T along the tangent.
    pub power: f64,
    /// The same in one period, J; `None` of a motion without a period.
    pub energy: Option<f64>,
}

/// Mean powers over the span, W.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Power {
    /// The power that friction feeds into the structure at each contact.
    pub contacts: Vec<ContactPower>,
    /// The power that friction feeds into the structure, by the ledger: work of the sliders less the loss in friction.
    pub friction: f64,
    /// The power that dampers take.
    pub damping: f64,
    /// The power that normal impulses of impacts take.
    pub impact: f64,
    /// The power of outer forces on the structure.
    pub forces: f64,
    /// Difference between the sum of all contacts and the ledger, in parts of the largest power.
    pub mismatch: f64,
    /// friction + forces − damping − impact, in parts of the largest power: the change of the stored energy over the span,
    /// which is zero after a period.
    pub unbalanced: f64,
    /// `friction` in one period, J; `None` of a motion without a period.
    pub energy: Option<f64>,
}

/// States that all contacts take at one time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TakenStates {
    /// The states, as `Sl-St`.
    pub states: String,
    /// Part of the time.
    pub share: f64,
}

/// The measured quantities of a motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// Time over which the motion was measured, s.
    pub span: f64,
    /// `true` if the span is the period of the motion; otherwise it is a window.
    pub is_period: bool,
    /// The points, in the order in which they were asked for.
    pub points: Vec<PointMotion>,
    /// Error of the root mean squares, in parts of them: the change if half of the rows are left out, at most.
    pub rms_error: f64,
    /// Powers; `None` of a structure with circulatory forces, which has no energy ledger.
    pub power: Option<Power>,
    /// States that contacts take, the longest first.
    pub states: Vec<TakenStates>,
    /// Modes of uniform sliding by their share of the kinetic energy, the largest first.
    pub shares: Vec<ModeShare>,
}

impl Measured {
    /// The point with the largest root mean square of the speed.
    ///
    /// # Panics
    /// Panics without points; a motion is measured at one at least.
    #[must_use]
    pub fn loudest(&self) -> &PointMotion {
        let points = self.points.iter();
        points.reduce(|a, b| if b.rms > a.rms { b } else { a }).expect("there is a point")
    }

    /// The point with the largest root mean square of the velocity along the normal; `None` if no point has a contact.
    #[must_use]
    pub fn loudest_along_normal(&self) -> Option<&PointMotion> {
        let points = self.points.iter().filter(|point| point.normal_rms.is_some());
        points.reduce(|a, b| if b.normal_rms > a.normal_rms { b } else { a })
    }
}

/// Sum of squares and largest magnitude of one quantity over all rows, and the sum over every other row.
#[derive(Clone, Copy, Default)]
struct Squares {
    all: f64,
    half: f64,
    largest: f64,
}

impl Squares {
    fn note(&mut self, square: f64, is_even: bool) {
        self.all += square;
        self.half += if is_even { square } else { 0.0 };
        self.largest = self.largest.max(square);
    }

    fn rms(&self, rows: f64) -> f64 {
        (self.all / rows).sqrt()
    }

    /// Change of the root mean square if every other row is left out, in parts of it.
    fn error(&self) -> f64 {
        if self.all > 0.0 { ((2.0 * self.half / self.all).sqrt() - 1.0).abs() } else { 0.0 }
    }
}

/// Measures the motion from where the simulation is, and returns the shares of all modes beside. The simulation has settled in
/// `ending`.
///
/// # Errors
/// Returns an error if a step fails.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
pub(super) fn measure(
    settled: &Simulation,
    points: &[MeasuredPoint],
    observation: &ObservationSettings,
    ending: &LongTermMotion,
    modal: Option<&ModalShares>,
) -> Result<(Measured, Vec<ModeShare>), Error> {
    let period = ending.period.filter(|_| ending.kind == Kind::Periodic);
    let span = period.unwrap_or(observation.window);
    let mut simulation = metered(settled)?;
    let rows = (ROWS_A_ROW * span / observation.interval).ceil().max(FEWEST_ROWS);
    let rows = 2 * (rows / 2.0).ceil() as u64;
    let mut speeds = vec![Squares::default(); points.len()];
    let mut normals: Vec<Vec<Squares>> =
        points.iter().map(|point| vec![Squares::default(); point.normals.len()]).collect();
    let mut course = modal.map(|modal| modal.course(rows));
    for row in 1..=rows {
        simulation.advance_to(row as f64 / rows as f64 * span)?;
        let (v, is_even) = (simulation.velocity(), row.is_multiple_of(2));
        for ((point, speed), normals) in points.iter().zip(&mut speeds).zip(&mut normals) {
            speed.note(point.dofs.iter().map(|dof| v[*dof] * v[*dof]).sum(), is_even);
            for (normal, squares) in point.normals.iter().zip(normals) {
                let along: f64 = normal.iter().map(|(dof, part)| part * v[*dof]).sum();
                squares.note(along * along, is_even);
            }
        }
        if let Some(course) = &mut course {
            course.note(row, simulation.displacement(), v);
        }
    }
    let rows = rows as f64;
    let motion = |((point, speed), normals): ((&MeasuredPoint, &Squares), &Vec<Squares>)| {
        let normal = normals.iter().max_by(|a, b| a.all.total_cmp(&b.all));
        let extents = point.dofs.iter().filter_map(|dof| ending.extents.get(*dof));
        PointMotion {
            point: point.name.clone(),
            amplitude: extents.copied().fold(0.0, f64::max),
            rms: speed.rms(rows),
            peak: speed.largest.sqrt(),
            normal_rms: normal.map(|normal| normal.rms(rows)),
            normal_peak: normal.map(|normal| normal.largest.sqrt()),
        }
    };
    let shares = course.map(|course| course.shares()).unwrap_or_default();
    let measured = Measured {
        span,
        is_period: period.is_some(),
        points: points.iter().zip(&speeds).zip(&normals).map(motion).collect(),
        rms_error: speeds.iter().map(Squares::error).fold(0.0, f64::max),
        power: power(&simulation, span, period.is_some()),
        states: states(&simulation),
        shares: shares.iter().filter(|share| share.share >= LEAST_SHARE).cloned().collect(),
    };
    Ok((measured, shares))
}

/// A simulation that goes on from a settled one, at time 0, with a log of contact states and a ledger, if the structure can
/// have one.
fn metered(settled: &Simulation) -> Result<Simulation, Error> {
    let mut scene: Scene = settled.nominal().scene();
    scene.effects.energy = settled.model().stiffness.is_symmetric();
    let mut simulation = Simulation::new(scene, 0.0)?;
    simulation.go_on_from(settled.motion());
    simulation.record_visits()?;
    Ok(simulation)
}

/// The mean powers since the ledger began, `span` (s) ago.
fn power(simulation: &Simulation, span: f64, is_period: bool) -> Option<Power> {
    let energy = simulation.energy()?;
    let work = simulation.friction_work()?;
    let [friction, damping, impact, forces] =
        [energy.slider - energy.friction, energy.damping, energy.impact, energy.forces]
            .map(|energy| energy / span);
    let largest = [friction, damping, impact, forces].map(f64::abs).into_iter().fold(0.0, f64::max);
    let part = |difference: f64| if largest > 0.0 { (difference / largest).abs() } else { 0.0 };
    let of_contact = |(contact, work): (usize, &f64)| ContactPower {
        contact: simulation.scene().contact_name(contact),
        power: work / span,
        energy: is_period.then_some(*work),
    };
    Some(Power {
        mismatch: part(work.iter().sum::<f64>() / span - friction),
        unbalanced: part(friction + forces - damping - impact),
        contacts: work.iter().enumerate().map(of_contact).collect(),
        friction,
        damping,
        impact,
        forces,
        energy: is_period.then_some(friction * span),
    })
}

/// The states that contacts have taken, the longest first.
fn states(simulation: &Simulation) -> Vec<TakenStates> {
    let Some(log) = simulation.visits() else { return Vec::new() };
    let mut visits: Vec<_> = log.visits().iter().collect();
    visits.sort_by(|a, b| b.time.total_cmp(&a.time));
    let taken = visits.into_iter().map(|visit| TakenStates {
        states: JoinedStates(&visit.states).to_string(),
        share: visit.time / log.time(),
    });
    taken.filter(|taken| taken.share >= LEAST_SHARE).take(MOST_STATES).collect()
}
