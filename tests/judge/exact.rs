//! The judge of exact motion: the matrix exponential of each contact state, and the law at each event.
//!
//! Between two changes of state the motion is linear, and x and ẋ at the end follow from those at the
//! beginning by the exponential of a matrix that is built here from M, C, K, the directions of the
//! contacts and their states. No series, no root and no Delassus block of the integrator is used.
//!
//! A step in which something changes is taken again from its beginning, as long as up to the change: the
//! interval that holds it is halved until it is next to nothing. On both of its sides the law must hold,
//! of forces on velocities and, where those vanish, of forces on accelerations; what happens in it is
//! nothing, or an impact that obeys the law of impulses on the velocities after it.

use super::{Acting, ROUNDING, Run};
use amontons::contact::ContactForce;
use amontons::contact::ContactState::{self, Detached, ReverseSlide, Slide, Stick};
use amontons::contact::Friction;
use amontons::contact::residual::{Instant, Scales, residual};
use amontons::model::LumpedModel;
use amontons::simulation::{Simulation, Snapshot};
use nalgebra::{DMatrix, DVector};

/// A step asked for that is shorter than this part of the internal step is not taken.
const SHORTEST: f64 = 1.01e-6;
/// One that is nearer to a whole one than this part of it is taken as whole.
const NEAREST: f64 = 1.01e-9;
/// How near a change of state is looked at, as a part of the step.
const NEAR: f64 = 1e-13;
/// What the law may be missed by, as a part of the scales; beside what the motion loses by rounding.
const LAW: f64 = 1e-10;
/// Velocities that are this part of their scale are zero for all that can be said.
const STANDS: f64 = 1e-10;
/// More changes in one step than this are not followed one by one.
const MOST_CHANGES: usize = 60;
/// How many exponentials are kept.
const KEPT: usize = 256;

/// What one contact state makes of a force f on the masses and of the accelerations of the sliders.
pub(super) struct Held {
    states: Vec<ContactState>,
    friction: Vec<Friction>,
    /// λ, (N, T) of each contact, from f: 2 c × n.
    multipliers: DMatrix<f64>,
    /// λ from the sliders' accelerations: 2 c × c.
    carried: DMatrix<f64>,
    /// ẍ from f: n × n.
    mobility: DMatrix<f64>,
    /// ẍ from the sliders' accelerations: n × c.
    follows: DMatrix<f64>,
}

/// What is kept of exponentials: what they are of, and what they are.
type Kept = Vec<(Vec<f64>, DMatrix<f64>)>;

#[derive(Default)]
pub(super) struct Memory {
    held: Vec<Held>,
    kept: Kept,
    probe: Option<Simulation>,
}

/// Position and velocity at one instant.
pub type Place = [DVector<f64>; 2];

/// What acts over a step: forces and slider velocities change linearly.
struct Span {
    start: Acting,
    /// N/s.
    rate: DVector<f64>,
    /// m/s².
    acceleration: DVector<f64>,
    /// Is this so, or does a slider's velocity bend within the step?
    is_straight: bool,
}

impl Span {
    fn force(&self, t: f64) -> DVector<f64> {
        &self.start.force + &self.rate * t
    }

    fn slider(&self, contact: usize, t: f64) -> f64 {
        self.start.slider_velocity[contact] + self.acceleration[contact] * t
    }
}

/// A change of state.
#[derive(Clone, Debug)]
pub struct Change {
    /// s.
    pub time: f64,
    /// Did a contact land?
    pub has_landed: bool,
    /// Displacements and velocities before and after.
    pub before: Place,
    pub after: Place,
}

/// What has happened up to some time in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Count {
    changes: u64,
    touch_downs: u64,
    /// More of them wherever contacts are solved anew.
    sweeps: u64,
}

impl Count {
    pub(super) fn of(simulation: &Simulation) -> Self {
        let statistics = simulation.statistics();
        let (changes, touch_downs) = (statistics.state_changes, statistics.touch_downs);
        Self { changes, touch_downs, sweeps: statistics.sweeps }
    }
}

/// The state of a step that began in `start` after `t` (s).
struct Look {
    t: f64,
    count: Count,
    place: Place,
}

impl Held {
    fn new(run: &Run, states: &[ContactState], friction: &[Friction]) -> Self {
        let (n, contacts) = (run.model.dofs(), states.len());
        // Unknowns: N of each closed contact, which brings T = ±µN where it slides, and T of each stuck
        // one; rows: the directions that are held.
        let (mut rows, mut expands, mut sliders) = (Vec::new(), Vec::new(), Vec::new());
        for (i, &state) in states.iter().enumerate() {
            if state == Detached {
                continue;
            }
            let slope = state.sliding_direction().unwrap_or(0.0) * friction[i].kinetic;
            rows.push(2 * i);
            sliders.push(None);
            expands.push(vec![(2 * i, 1.0), (2 * i + 1, slope)]);
            if state == Stick {
                rows.push(2 * i + 1);
                sliders.push(Some(i));
                expands.push(vec![(2 * i + 1, 1.0)]);
            }
        }
        let unknowns = rows.len();
        let inverse = &run.inverse_mass;
        let held = run.directions.select_columns(&rows).transpose();
        let mut expand = DMatrix::zeros(2 * contacts, unknowns);
        for (column, parts) in expands.iter().enumerate() {
            parts.iter().for_each(|&(row, value)| expand[(row, column)] = value);
        }
        let mut surface = DMatrix::zeros(unknowns, contacts);
        for (row, slider) in sliders.into_iter().enumerate() {
            if let Some(contact) = slider {
                surface[(row, contact)] = 1.0;
            }
        }
        let pushes = &run.directions * &expand;
        let matrix = &held * inverse * &pushes;
        let solved = solve(&matrix);
        let multipliers = -(&expand * &solved * &held * inverse);
        let carried = &expand * &solved * surface;
        let mobility = inverse * (DMatrix::identity(n, n) + &run.directions * &multipliers);
        let follows = inverse * &run.directions * &carried;
        let (states, friction) = (states.to_vec(), friction.to_vec());
        Self { states, friction, multipliers, carried, mobility, follows }
    }
}

/// The inverse, or where contacts are redundant, the least of them.
fn solve(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    if matrix.is_empty() {
        return matrix.transpose();
    }
    let largest = matrix.amax();
    let singular = matrix.clone().svd(true, true);
    let rank = singular.rank(1e-9 * largest);
    if rank == matrix.nrows() {
        matrix.clone().try_inverse().unwrap()
    } else {
        singular.pseudo_inverse(1e-9 * largest).unwrap()
    }
}

/// The highest frequency of the masses on their own springs, 1/s; 1 without springs.
pub(super) fn fastest(model: &LumpedModel) -> f64 {
    let squares = (0..model.dofs()).map(|i| model.stiffness.get(i, i) / model.mass.get(i, i));
    let square = squares.fold(0.0, f64::max);
    if square > 0.0 { square.sqrt() } else { 1.0 }
}

impl Run {
    /// The place in `memory.held` of a contact state.
    fn held(&mut self, states: &[ContactState], friction: &[Friction]) -> usize {
        let known = self.memory.held.iter();
        let found = known.clone().position(|h| h.states == states && h.friction == friction);
        found.unwrap_or_else(|| {
            let held = Held::new(self, states, friction);
            self.memory.held.push(held);
            self.memory.held.len() - 1
        })
    }

    /// What acts over the step that begins at `time`.
    fn span(&mut self, time: f64) -> Span {
        let h = self.h();
        let at = |run: &mut Self, t: f64| run.acting_at([time, t]).slider_velocity;
        let [middle, end] = [0.5, 1.0].map(|part| at(self, time + part * h));
        let rate = self.force_rate(time);
        let start = self.acting_at([time, time]);
        let contacts = start.slider_velocity.len();
        let change = |i: usize| end[i] - start.slider_velocity[i];
        let acceleration = DVector::from_fn(contacts, |i, _| change(i) / h);
        let bends = |i: usize| (middle[i] - start.slider_velocity[i] - 0.5 * change(i)).abs();
        let scale = self.scales.velocity;
        let is_straight = (0..contacts).all(|i| bends(i) <= 1e-12 * scale.max(end[i].abs()));
        Span { start, rate, acceleration, is_straight }
    }

    /// Where the motion goes in `t` (s) from `from`, where `begin` (s) of the step have passed, without
    /// a change of state; and the rounding errors of that, as a velocity.
    fn follow(
        &mut self,
        held: usize,
        from: &Place,
        span: &Span,
        [begin, t]: [f64; 2],
    ) -> (Place, f64) {
        let n = self.model.dofs();
        let omega = self.fastest;
        let rest = span.force(begin) - &self.stiffness * self.total(&DVector::zeros(n));
        let state = &self.memory.held[held];
        let constant = &state.mobility * &rest + &state.follows * &span.acceleration;
        let linear = &state.mobility * &span.rate;
        // Two more unknowns, a constant and the time, of the size of the velocities that they make.
        let size = (constant.norm() / omega).max(linear.norm() / (omega * omega));
        let size = if size > 0.0 { size } else { 1.0 };
        let mut key = vec![held as f64, t, size];
        key.extend(constant.iter().chain(linear.iter()));
        let known = self.memory.kept.iter().position(|(known, _)| *known == key);
        let place = known.unwrap_or_else(|| {
            let mut matrix = DMatrix::zeros(2 * n + 2, 2 * n + 2);
            matrix.view_mut((0, n), (n, n)).fill_diagonal(omega);
            let part = |block: &DMatrix<f64>, factor: f64| -(&state.mobility * block) * factor;
            matrix.view_mut((n, 0), (n, n)).copy_from(&part(&self.stiffness, 1.0 / omega));
            matrix.view_mut((n, n), (n, n)).copy_from(&part(&self.damping, 1.0));
            matrix.view_mut((n, 2 * n), (n, 1)).copy_from(&(&constant / size));
            matrix.view_mut((n, 2 * n + 1), (n, 1)).copy_from(&(&linear / (size * omega)));
            matrix[(2 * n + 1, 2 * n)] = omega;
            if self.memory.kept.len() >= KEPT {
                self.memory.kept.clear();
            }
            self.memory.kept.push((key, (matrix * t).exp()));
            self.memory.kept.len() - 1
        });
        let start = from[0].iter().map(|x| omega * x).chain(from[1].iter().copied());
        let start = DVector::from_iterator(2 * n + 2, start.chain([size, 0.0]));
        let end = &self.memory.kept[place].1 * &start;
        let reached = [end.rows(0, n) / omega, end.rows(n, n).into_owned()];
        let largest = |z: &DVector<f64>| z.rows(0, 2 * n).amax();
        let turns = omega * t;
        let loads = self.model.load.iter().fold(0.0_f64, |most, load| most.max(load.abs()));
        let lost = largest(&start).max(largest(&end)).max(size * turns.min(1.0))
            + t * loads * self.inverse_mass.amax();
        // Times are known to the last digit of the time since the start.
        let late = 4.0 * f64::EPSILON * self.time() * omega;
        let fastest = largest(&start).max(largest(&end)).max(size);
        (reached, 10.0 * ROUNDING * (1.0 + turns) * lost + late * fastest)
    }

    /// The step that began with `self.start`, `t` (s) after its beginning, and the forces reported then.
    fn look(&mut self, t: f64) -> (Look, Vec<ContactForce>) {
        let start: &Snapshot = &self.start.as_ref().unwrap().0;
        let probe =
            self.memory.probe.get_or_insert_with(|| Simulation::resume(start.clone()).unwrap());
        probe.restore(start).unwrap();
        if t > 0.0 {
            probe.advance_to(probe.time() + t).unwrap();
        }
        let place = [probe.displacement(), probe.velocity()].map(DVector::from_column_slice);
        let count = Count::of(probe);
        let forces = probe.contact_forces().unwrap().to_vec();
        (Look { t, count, place }, forces)
    }

    /// Judges the last step of an integrator whose motion is exact.
    #[track_caller]
    pub(super) fn judge_exact_step(&mut self) {
        let h = self.h();
        self.changes.clear();
        self.segments.clear();
        let span = self.span(self.time() - h);
        let end = Look { t: h, count: Count::of(&self.simulation), place: self.now.clone() };
        if !span.is_straight {
            return;
        }
        let (_, _, count) = self.start.as_ref().unwrap();
        let mut from = Look { t: 0.0, count: *count, place: self.before.clone() };
        for _ in 0..MOST_CHANGES {
            if from.count == end.count {
                self.judge_segment(&span, &from, &end);
                return;
            }
            let [before, after] = self.bracket(&from, &end);
            if before.t > from.t {
                self.judge_segment(&span, &from, &before);
            }
            self.judge_event(&span, &before, &after);
            self.changes.push(Change {
                time: self.time() - h + after.t,
                has_landed: after.count.touch_downs > before.count.touch_downs,
                before: before.place,
                after: after.place.clone(),
            });
            from = after;
        }
    }

    /// The integral over the last step of what `f` makes of a motion and its contact forces: Gauss's
    /// formula of five points between changes of state.
    pub fn integral<const N: usize>(
        &mut self,
        f: impl Fn(&Self, &Place, &[ContactForce]) -> [f64; N],
    ) -> [f64; N] {
        let (near, far) = (0.538_469_310_105_683, 0.906_179_845_938_664);
        let [inner, outer] = [0.478_628_670_499_366_5, 0.236_926_885_056_189_1];
        let middle = 2.0 - 2.0 * (inner + outer);
        let rule = [(-far, outer), (-near, inner), (0.0, middle), (near, inner), (far, outer)];
        let mut sum = [0.0; N];
        for [from, to] in self.segments.clone() {
            let half = 0.5 * (to - from);
            for (at, weight) in rule {
                let t = from + half * (1.0 + at);
                if t < SHORTEST * self.h() {
                    continue;
                }
                let (look, forces) = self.look(t);
                let values = f(self, &look.place, &forces);
                sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * half * value);
            }
        }
        sum
    }

    /// How near a change of state is looked at, s.
    fn near(&self) -> f64 {
        (NEAR * self.h()).max(8.0 * f64::EPSILON * self.time())
    }

    /// The last time known to be before the next change of state, and the first known to be after it.
    fn bracket(&mut self, from: &Look, end: &Look) -> [Look; 2] {
        let copy = |look: &Look| Look { place: look.place.clone(), ..*look };
        let (mut before, mut after) = (copy(from), copy(end));
        // Signals take a time that is as near to an edge of theirs for the edge.
        let nearest = if self.signals.is_empty() { NEAREST } else { SHORTEST };
        let (shortest, longest) = (SHORTEST * self.h(), (1.0 - nearest) * self.h());
        let near = self.near();
        while after.t - before.t > near {
            let middle = 0.5 * (before.t + after.t);
            if middle < shortest || middle > longest {
                break;
            }
            let (look, _) = self.look(middle);
            if look.count == from.count {
                before = look;
            } else {
                after = look;
            }
        }
        [before, after]
    }

    /// Judges the motion between two times of a step without a change of state between them, and the law
    /// at both.
    #[track_caller]
    fn judge_segment(&mut self, span: &Span, from: &Look, to: &Look) {
        let time = self.time() - self.h();
        if to.t - from.t < 10.0 * NEAR * self.h() {
            return;
        }
        self.segments.push([from.t, to.t]);
        let now = self.states();
        let is_whole = from.t == 0.0 && to.t == self.h();
        let states = if is_whole && self.start.as_ref().unwrap().1 == now {
            now
        } else {
            let (_, forces) = self.look((0.5 * (from.t + to.t)).max(SHORTEST * self.h()));
            forces.iter().map(|force| force.state).collect()
        };
        let held = self.held(&states, &span.start.friction);
        let (expected, lost) = self.follow(held, &from.place, span, [from.t, to.t - from.t]);
        for (i, factor) in [self.fastest, 1.0].into_iter().enumerate() {
            let off = (&expected[i] - &to.place[i]) * factor;
            assert!(
                off.amax() <= lost,
                "from {} to {} s in {states:?} the motion is {:?} and not {:?}: {:e}, allowed {lost:e}",
                time + from.t,
                time + to.t,
                to.place,
                expected,
                off.amax(),
            );
        }
        // Either end is known as near as a change is looked at.
        self.lasts = to.t - from.t - 2.0 * self.near();
        self.judge_instant(span, from, held, false);
        self.lasts = f64::INFINITY;
        self.judge_instant(span, to, held, true);
    }

    /// The force on the masses without that of contacts, and its rounding errors, N.
    fn outer(&self, span: &Span, look: &Look) -> (DVector<f64>, f64) {
        let [x, v] = &look.place;
        let total = self.total(x);
        let parts = [span.force(look.t), -(&self.damping * v), -(&self.stiffness * &total)];
        let lost =
            parts[0].amax() + self.damping.amax() * v.amax() + self.stiffness.amax() * total.amax();
        (parts.into_iter().sum(), ROUNDING * lost)
    }

    /// Judges the law at one instant in a contact state: on the velocities, and where they vanish, on the
    /// accelerations. At the end of its time a slip may have come to an end.
    #[track_caller]
    fn judge_instant(&mut self, span: &Span, look: &Look, held: usize, is_end: bool) {
        let (force, lost) = self.outer(span, look);
        let state = &self.memory.held[held];
        let forces = &state.multipliers * &force + &state.carried * &span.acceleration;
        let lost = lost * state.multipliers.amax().max(1.0);
        let accelerations = &state.mobility * &force + &state.follows * &span.acceleration;
        let places = (0..span.acceleration.len()).map(|i| [forces[2 * i], forces[2 * i + 1]]);
        for (i, pair) in places.enumerate() {
            let slider = [span.slider(i, look.t), span.acceleration[i]];
            self.at = (look.t - self.h(), is_end);
            self.judge_contact(
                i,
                &look.place,
                &accelerations,
                pair,
                slider,
                span.start.friction[i],
                lost,
            );
        }
    }

    /// Judges one contact with its forces (N, T) on a motion, under a slider of this velocity and
    /// acceleration.
    #[track_caller]
    #[allow(clippy::too_many_arguments)]
    pub(super) fn judge_contact(
        &self,
        contact: usize,
        [x, v]: &Place,
        acceleration: &DVector<f64>,
        [normal_force, friction_force]: [f64; 2],
        slider: [f64; 2],
        friction: Friction,
        lost: f64,
    ) {
        let [normal, tangent] = [0, 1].map(|k| self.directions.column(2 * contact + k));
        let along =
            |motion: &DVector<f64>, slider: f64| [normal.dot(motion), slider - tangent.dot(motion)];
        let [mut gap_velocity, mut slip_velocity] = along(v, slider[0]);
        let lands = self.at.1 && normal_force == 0.0 && gap_velocity < 0.0;
        if lands {
            gap_velocity = 0.0;
        }
        let own = normal.dot(&(&self.inverse_mass * normal));
        // However small it is, friction is against it.
        let slips_now = slip_velocity;
        if slip_velocity.abs() <= 10.0 * lost * own * self.h() {
            // What rounding of the forces makes of it in a step.
            slip_velocity = 0.0;
        }
        let [gap_acceleration, slip_acceleration] = along(acceleration, slider[1]);
        let gap = normal.dot(x);
        let on = |velocities: [f64; 2], scales: Scales| {
            let [gap_velocity, slip_velocity] = velocities;
            let gap = if scales == self.scales { gap } else { 0.0 };
            let instant =
                Instant { gap, gap_velocity, slip_velocity, normal_force, friction_force };
            residual(&instant, friction, &scales)
        };
        let drift = self.exact_drift();
        let allowed = LAW + drift + lost / self.scales.force;
        let story = || {
            format!(
                "contact {contact} at {} s {:+e} s: gap {gap:e} m, {gap_velocity:e} m/s, \
                 {gap_acceleration:e} m/s²; slip {slip_velocity:e} m/s, {slip_acceleration:e} m/s²; \
                 N = {normal_force} N, T = {friction_force} N, {friction:?}",
                self.time(),
                self.at.0
            )
        };
        let found = on([gap_velocity, slip_velocity], self.scales);
        assert!(found.size <= allowed, "{found}, allowed {allowed:.1e}: {}", story());
        let stands = STANDS + drift;
        if lands
            || gap > stands * self.scales.length
            || gap_velocity.abs() > stands * self.scales.velocity
        {
            return;
        }
        // Contacts that throw each other off come to rest in ever shorter bounces: however slow one is, it
        // may be open for as long as it takes to come back, or until another one lands.
        let comes_back = normal_force == 0.0 && gap_velocity > 0.0 && gap_acceleration < 0.0;
        let in_time = self.lasts * -gap_acceleration <= 2.0 * (1.0 + 1e-3) * gap_velocity;
        if comes_back && (in_time || self.at.1) {
            return;
        }
        // What the largest force would do here.
        let own = own * self.scales.force;
        let scales = Scales { velocity: own, ..self.scales };
        let ends = self.at.1 && friction_force != 0.0;
        let slips = own * if ends { friction_force } else { slips_now }.signum();
        let now = on([gap_acceleration, slips], scales);
        let next = on([gap_acceleration, slip_acceleration], scales);
        let found = if slip_velocity.abs() > stands * self.scales.velocity || now.size <= next.size
        {
            now
        } else {
            next
        };
        // A velocity that is nothing to rounding may have had the wrong sign for as long as it takes to
        // become something: v = j t²/2, a = j t.
        let jerk = tangent.dot(&(&self.inverse_mass * (&self.stiffness * v))).abs();
        let nothing = 2.0 * ROUNDING * own * self.h();
        let allowed = allowed + 2.0 * (2.0 * nothing * jerk).sqrt() / own;
        assert!(
            found.size <= allowed,
            "accelerations: {found}, allowed {allowed:.1e}: {}",
            story()
        );
    }

    /// What rounding leaves of the gap and the velocities of closed contacts between masses, which no step
    /// puts where they belong: a bit of the velocity each.
    fn exact_drift(&self) -> f64 {
        if self.is_exact {
            return 0.0;
        }
        let steps = self.simulation.statistics().steps as f64;
        let velocity = f64::EPSILON * steps * self.scales.velocity;
        velocity / self.scales.velocity + velocity * self.time() / self.scales.length
    }

    /// Judges what happens between two neighbouring times: nothing, or an impact.
    #[track_caller]
    fn judge_event(&mut self, span: &Span, before: &Look, after: &Look) {
        let passed = after.t - before.t;
        let change = &after.place[1] - &before.place[1];
        let fastest = before.place[1].amax().max(after.place[1].amax()).max(self.scales.velocity);
        let (force, _) = self.outer(span, before);
        // Contacts add no more than holds all others, several times.
        let gained = passed * 10.0 * (force.amax() + self.scales.force) * self.inverse_mass.amax();
        // Of contacts between masses the integrator ends bounces that are slower than 1e-11 of the fastest
        // velocity, which are not told from rounding; each that lands may do so.
        let ended = if self.is_exact { 1e-12 } else { 1e-10 };
        let rounding = ended * fastest + gained;
        let moved = (&after.place[0] - &before.place[0]).amax();
        let time = self.time() - self.h() + after.t;
        let late = 4.0 * f64::EPSILON * time;
        // How often contacts bounce off each other before they lie still is a matter of rounding, which is
        // a part of the displacements, however small what the springs give is.
        let length = self.scales.length.max(before.place[0].amax());
        assert!(
            moved <= (fastest + gained) * (passed + late) + 1e-12 * length,
            "at {time} s it moves by {moved} m at once"
        );
        // A start may press a closed contact further.
        let approaches = (0..span.acceleration.len()).any(|i| {
            let normal = self.directions.column(2 * i);
            let [x, v] = &before.place;
            normal.dot(x) <= STANDS * self.scales.length && normal.dot(v) < -STANDS * fastest
        });
        if after.count.touch_downs == before.count.touch_downs && !approaches {
            assert!(change.amax() <= rounding, "at {time} s velocities jump by {}", change.amax());
            return;
        }
        // Several impacts that are not told apart add up to impulses that no law holds for.
        if passed > self.near() && after.count.touch_downs > before.count.touch_downs + 1 {
            return;
        }
        let Some(fit) = &self.fit else { return };
        let momentum = &self.mass * &change;
        let impulses = fit * &momentum;
        let rest = (&momentum - &self.directions * &impulses).amax();
        let largest = self.mass.amax() * rounding;
        assert!(rest <= largest, "at {time} s momentum changes by {rest} N s without contacts");
        let length = self.scales.length.max(fastest * passed);
        let scales =
            Scales { velocity: fastest, force: impulses.amax().max(f64::MIN_POSITIVE), length };
        let allowed = LAW + self.exact_drift() + 10.0 * largest / scales.force;
        for i in 0..span.acceleration.len() {
            let [normal, tangent] = [0, 1].map(|k| self.directions.column(2 * i + k));
            let [x, v] = &after.place;
            let instant = Instant {
                gap: normal.dot(x),
                gap_velocity: normal.dot(v),
                slip_velocity: span.slider(i, after.t) - tangent.dot(v),
                normal_force: impulses[2 * i],
                friction_force: impulses[2 * i + 1],
            };
            let found = residual(&instant, span.start.friction[i], &scales);
            assert!(
                found.size <= allowed,
                "impact at {time} s, contact {i}: {found}, allowed {allowed:.1e}; {instant:?}"
            );
        }
    }

    /// Judges what is reported now: forces that hold the motion, under the law.
    #[track_caller]
    pub(super) fn judge_exact_report(&mut self) {
        let time = self.time();
        let span = self.span(time);
        let reported = self.forces();
        // One that is at its limit and does not slip yet is about to.
        let friction = &span.start.friction;
        let slides = |(i, force): (usize, &ContactForce)| {
            let limit = friction[i].static_ * force.normal_force * (1.0 - 1e-13);
            match force.state {
                Stick if force.friction_force >= limit => Slide,
                Stick if force.friction_force <= -limit => ReverseSlide,
                state => state,
            }
        };
        let states: Vec<ContactState> = reported.iter().enumerate().map(slides).collect();
        let held = self.held(&states, &span.start.friction);
        let count = Count::of(&self.simulation);
        let look = Look { t: 0.0, count, place: self.now.clone() };
        let (force, lost) = self.outer(&span, &look);
        let state = &self.memory.held[held];
        let pairs = reported.iter().flat_map(|force| [force.normal_force, force.friction_force]);
        let given = DVector::from_iterator(2 * reported.len(), pairs);
        let mut acceleration = span.acceleration.clone();
        if !span.is_straight {
            acceleration.fill(0.0);
        }
        let needed = &state.multipliers * &force + &state.carried * &acceleration;
        let lost = lost * state.multipliers.amax().max(1.0);
        let off = (&self.directions * (&given - &needed)).amax();
        let allowed = 10.0 * lost + 1e-11 * needed.amax();
        if span.is_straight {
            assert!(
                off <= allowed,
                "at {time} s {off:e} N are missing, allowed {allowed:e}: {reported:?} {needed:?}"
            );
        }
        let accelerations = &self.inverse_mass * (&force + &self.directions * &given);
        self.at = (0.0, false);
        for (i, force) in reported.iter().enumerate() {
            let slider = [span.slider(i, 0.0), acceleration[i]];
            let pair = [force.normal_force, force.friction_force];
            self.judge_contact(
                i,
                &self.now,
                &accelerations,
                pair,
                slider,
                span.start.friction[i],
                lost,
            );
            let slip = slider[0] - self.directions.column(2 * i + 1).dot(&self.now[1]);
            let off = (force.slip_velocity - slip).abs();
            let drift = self.exact_drift() * self.scales.velocity;
            assert!(off <= 1e-12 * self.now[1].amax().max(1.0) + drift, "{force:?}, {slip}");
        }
    }
}
