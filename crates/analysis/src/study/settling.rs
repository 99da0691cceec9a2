//! Detection of settled motions.
//!
//! A motion is looked at window by window, in rows at equal times. It is *settled* when it rests, grows without bound,
//! or has a size and lines that are the same in windows that follow each other while no faint line grows, or when its
//! size varies without a trend. Then its kind is decided. The rules in their order, and the thresholds, are in
//! [`long_term`](super::long_term).

use super::beat::{beat, is_fading};
use super::drive::{is_repeated, last_edge, period};
use super::fading::{ObservedCycle, lasting};
use super::family::{frequencies_of_sum, is_one_of_many};
use super::linear::{
    GrowthRate, deflections, growth, has_linear_friction, has_states_of_rest, is_far, may_pull,
    stays_linear,
};
use super::long_term::{Kind, LongTermMotion};
use super::observation::{ObservationSettings, output, unit};
use super::period::{OverSpan, over_span};
use super::recurrence::{
    Closure, Search, closure, is_closing, long_closure, longest_step, may_wobble, short_period,
};
use super::separation::{NeighbourSeparation, parting};
use super::windows::{Surroundings, Trend, Windows};
use crate::accuracy::half_range;
use crate::spectral::lines;
use crate::sweep::steady::{ROUNDING, mixture};
use amontons::Error;
use amontons::integrator::Statistics;
use amontons::numerics::max_norm;
use amontons::scene::Method;
use amontons::simulation::{Simulation, Variable};

/// Lines of the output of at least this part of the strongest one are listed, in amplitudes.
const TOLD: f64 = 1e-3;
/// Number of windows before the last one from which lines of a motion without a period are determined too, since they
/// may lie near each other.
const MORE_WINDOWS: usize = 3;
/// Windows from one look at how neighbouring motions part to the next, counted from the last edge of a signal.
const WINDOWS_BETWEEN: usize = 12;
/// Windows after which a period is looked for again where none was found. The search takes up to 64 periods of the
/// strongest line, more than a window has of a motion at the slowest mode's frequency.
const WINDOWS_IN_VAIN: usize = 4;

/// A motion that is observed until it is settled.
pub(crate) struct Settling {
    observation: ObservationSettings,
    output: Variable,
    /// Rows since the clock's zero, and those that a window began with.
    row: u64,
    began: u64,
    followed: Vec<f64>,
    /// The output over the windows before, [`MORE_WINDOWS`] at the most.
    past: Vec<f64>,
    mixture: Vec<f64>,
    /// The smallest and the largest displacement of each degree of freedom in the window, m.
    extents: Vec<[f64; 2]>,
    states: [u64; 4],
    taken: [bool; 4],
    /// `true` if a contact that cannot open has pulled in the window: friction then follows the size of its force.
    pulled: bool,
    /// `true` of a window in which contacts were in the states of rest and their forces linear.
    linear: bool,
    before: Statistics,
    /// Time from which on signals only repeat themselves, s.
    last_edge: f64,
    /// The largest deflection of the structure by the forces at rest, m: [`deflections`].
    deflection: f64,
    /// Number of windows that have ended.
    windows: usize,
    /// Windows since the last edge.
    seen: Windows,
    /// The closure at the end of each window since the motion was steady.
    closures: Vec<Closure>,
    /// The beats of all windows whose kind was asked for.
    beats: Vec<f64>,
    /// `true` if all strong lines combined two frequencies when the kind was last asked for.
    is_of_two: bool,
    /// The longest step of the paper's scheme, s, that can tell the kind; `None` where the scene's step can.
    longest_step: Option<f64>,
    /// Number of windows that had ended when the state was last seen not to come back.
    looked_in_vain: usize,
}

impl Settling {
    /// Looks at a simulation from where it is.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    pub(crate) fn new(
        simulation: &Simulation,
        observation: &ObservationSettings,
    ) -> Result<Self, Error> {
        let row = (simulation.time() / observation.interval).round() as u64;
        let mut settling = Self {
            observation: observation.clone(),
            output: output(simulation.scene(), &observation.of)?,
            row,
            began: row,
            followed: Vec::new(),
            past: Vec::new(),
            mixture: Vec::new(),
            extents: Vec::new(),
            states: [0; 4],
            taken: [false; 4],
            pulled: false,
            linear: false,
            before: simulation.statistics(),
            last_edge: last_edge(simulation.scene()),
            deflection: max_norm(&deflections(simulation)),
            windows: 0,
            #[allow(clippy::cast_possible_truncation)]
            seen: Windows::new(observation.rows() as usize, observation.interval),
            closures: Vec::new(),
            beats: Vec::new(),
            is_of_two: false,
            longest_step: None,
            looked_in_vain: 0,
        };
        settling.begin_window(simulation);
        Ok(settling)
    }

    fn begin_window(&mut self, simulation: &Simulation) {
        #[allow(clippy::cast_possible_truncation)]
        let room = MORE_WINDOWS * self.observation.rows() as usize;
        self.past.append(&mut self.followed);
        self.past.drain(..self.past.len().saturating_sub(room));
        self.mixture.clear();
        self.extents.clear();
        self.extents.resize(simulation.displacement().len(), [f64::INFINITY, f64::NEG_INFINITY]);
        self.taken = [false; 4];
        self.before = simulation.statistics();
        self.pulled = false;
        self.note_states(simulation);
        // The state that a window begins in is taken, but counted in the window before.
        self.states = [0; 4];
    }

    /// Time at which the next row is due, s.
    #[allow(clippy::cast_precision_loss)]
    pub(crate) fn next_time(&self) -> f64 {
        (self.row + 1) as f64 * self.observation.interval
    }

    /// Takes note of the row that is due; what the motion ends in, once that is known. A watch that says that it is
    /// over leaves the kind of a motion open.
    pub(crate) fn note(
        &mut self,
        simulation: &mut Simulation,
        is_over: &dyn Fn() -> bool,
    ) -> Result<Option<LongTermMotion>, Error> {
        self.row += 1;
        self.followed.push(simulation.read(&self.output)?);
        self.mixture.push(mixture(simulation.displacement()));
        for (extent, x) in self.extents.iter_mut().zip(simulation.displacement()) {
            *extent = [extent[0].min(*x), extent[1].max(*x)];
        }
        self.note_states(simulation);
        if !self.pulled && may_pull(simulation.scene()) {
            self.pulled = simulation.contact_forces()?.iter().any(|force| force.normal_force < 0.0);
        }
        if self.followed.len() as u64 == self.observation.rows() {
            self.close(simulation, is_over)
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

    /// `true` if the window that has ended is the last one that the motion may take.
    fn is_last(&self) -> bool {
        self.windows >= self.observation.windows()
    }

    /// The end of a window.
    fn close(
        &mut self,
        simulation: &Simulation,
        is_over: &dyn Fn() -> bool,
    ) -> Result<Option<LongTermMotion>, Error> {
        self.windows += 1;
        let now = simulation.statistics();
        for ((taken, now), before) in
            self.taken.iter_mut().zip(now.entered).zip(self.before.entered)
        {
            *taken |= now > before;
        }
        let changed = self.pulled || now.state_changes() > self.before.state_changes();
        let may_rest = has_states_of_rest(simulation);
        let may_be_linear = !self.pulled && may_rest && has_linear_friction(simulation.scene());
        self.linear = !changed && may_be_linear;
        let mixture = std::mem::take(&mut self.mixture);
        let still = self.seen.still(changed);
        let course = self.seen.judge(
            mixture,
            changed,
            self.is_last(),
            Surroundings {
                largest: max_norm(simulation.displacement()),
                at_rest: max_norm(&simulation.reference().displacement).max(self.deflection),
                is_driven: simulation.is_driven_on(),
                is_repeated: is_repeated(simulation, still * self.observation.window),
                is_far: is_far(simulation),
                may_rest,
                stays_linear: stays_linear(simulation),
                growth: &|| growth(simulation),
            },
        );
        // A motion that a surface carries along, or that flies on, is transient.
        let is_transient = !changed && !may_rest && !simulation.is_driven_on();
        // A window that contains the last edge of a signal shows transient motion, too.
        let began = (self.row - self.observation.rows()) as f64 * self.observation.interval;
        let waits = began < self.last_edge;
        let is_open = is_transient || waits && course != Trend::Unbounded;
        let course = if is_open { Trend::Open } else { course };
        let follows = course != Trend::Rests && !is_open && self.follows(simulation, is_over)?;
        let kind = match course {
            _ if follows => Some((Kind::QuasiPeriodic, None)),
            Trend::Rests => Some((Kind::Equilibrium, None)),
            Trend::Unbounded => Some((Kind::Unbounded, None)),
            Trend::Steady | Trend::Varies => {
                self.kind(simulation, course == Trend::Varies, is_over)?
            }
            Trend::Open => None,
        };
        let (kind, parting) = match kind {
            Some(known) => known,
            None if self.is_last() => (Kind::Unsettled, None),
            None => {
                if waits {
                    self.seen.clear();
                    self.beats.clear();
                    self.followed.clear();
                }
                self.begin_window(simulation);
                return Ok(None);
            }
        };
        let mut ending = self.ending(kind, simulation.is_driven_on());
        let is_driven = ending.linear && simulation.is_driven_on();
        if may_be_linear && kind.is_cycle() || is_driven {
            let strongest = self.seen.known_lines().and_then(|found| found.lines.first());
            let frequency = strongest.map(|line| line.frequency);
            ending.linear = is_one_of_many(simulation, &self.observation, frequency, is_over)?;
        }
        ending.longest_step = self.longest_step.filter(|_| kind == Kind::Undecided);
        if kind == Kind::QuasiPeriodic {
            // A mode of a sum may be too faint for the mixture's lines in which two frequencies were seen.
            let is_sum = ending.linear && !simulation.is_driven_on();
            let more = is_sum && frequencies_of_sum(simulation).is_none_or(|count| count > 2);
            ending.two_frequencies = self.is_of_two && !more;
            ending.follows = follows;
        }
        if ending.linear && kind == Kind::Unsettled && !simulation.is_driven_on() {
            // Two windows may differ by noise; eigenvalues do not.
            let goes = |growth: &GrowthRate| growth.is_growing() || growth.is_decaying();
            ending.rate = growth(simulation).filter(goes).map_or(0.0, |growth| growth.rate);
        }
        ending.parting = parting;
        match kind {
            Kind::Equilibrium => ending.come_to_rest(simulation.contact_states()),
            // Lines of one window need not be those of the next.
            Kind::Unsettled if !ending.is_known() => ending.frequency = None,
            _ => {}
        }
        let closure = self.closures.last().filter(|_| kind.is_cycle());
        let span = match kind {
            Kind::Periodic => closure.map(|closure| closure.period),
            _ => kind.is_cycle().then_some(self.observation.window),
        };
        let over =
            span.map(|span| over_span(simulation, &self.output, span, self.observation.interval));
        let over = over.transpose()?;
        if let Some(found) = over.as_ref().filter(|_| kind == Kind::Periodic) {
            // A window need not hold enough periods to tell the slowest line.
            if let Some(found) = found.lines_of_period(TOLD) {
                ending.take_lines(&found);
            }
        }
        if let Some(closure) = closure {
            ending.come_back(*closure);
        }
        if let Some(OverSpan { amplitude, extents, shares, .. }) = over {
            (ending.amplitude, ending.extents, ending.shares) = (amplitude, extents, shares);
            if let (Kind::Periodic, Some(period)) = (kind, ending.period) {
                let shown = ObservedCycle {
                    interval: self.observation.interval,
                    window: self.observation.window,
                    longest: self.observation.longest,
                    elapsed: ending.time.min(simulation.time() - self.last_edge),
                    period,
                    output: &self.output,
                    shares,
                };
                if let Some(lasting) = lasting(simulation, &shown, is_over)? {
                    ending.shares = lasting.shares;
                    ending.taken = lasting.shares.map(|share| share > 0.0);
                    ending.fading = lasting.fading;
                }
            }
            let largest = ending.largest_extent();
            if unit(&self.output) == "m" && ending.amplitude <= ROUNDING * largest {
                ending.amplitude = 0.0;
            }
        }
        Ok(Some(ending))
    }

    /// `true` if the motion follows signals that have no common period, as neighbours that come together show. This
    /// is checked at intervals of some windows.
    fn follows(
        &mut self,
        simulation: &Simulation,
        is_over: &dyn Fn() -> bool,
    ) -> Result<bool, Error> {
        let is_due = self.is_last() || self.seen.count().is_multiple_of(WINDOWS_BETWEEN);
        let repeats = || short_period(simulation, self.observation.window).is_some();
        if !is_due || !simulation.is_driven_on() || repeats() {
            return Ok(false);
        }
        let main = self.seen.last_lines().and_then(|found| found.lines.first());
        let Some(main) = main.map(|line| line.frequency) else { return Ok(false) };
        Ok(self.parting(simulation, main, false, is_over)? == NeighbourSeparation::Together)
    }

    /// Separation of neighbouring motions ([`parting`]). The paper's scheme, which sees events at whole steps only,
    /// cannot show that they come together: so near they have the same events even where exact motions part.
    fn parting(
        &self,
        simulation: &Simulation,
        frequency: f64,
        is_long: bool,
        is_over: &dyn Fn() -> bool,
    ) -> Result<NeighbourSeparation, Error> {
        let (interval, rows) = (self.observation.interval, self.observation.rows());
        let is_exact = simulation.scene().method == Method::EventDriven;
        Ok(match parting(simulation, interval, frequency, (rows, is_long), is_over)? {
            NeighbourSeparation::Together if !is_exact => NeighbourSeparation::Unknown,
            parting => parting,
        })
    }

    /// The kind of a motion that has settled, with the rate at which neighbours part; `None` while its state still
    /// comes nearer to where it was, from window to window.
    fn kind(
        &mut self,
        simulation: &Simulation,
        varies: bool,
        is_over: &dyn Fn() -> bool,
    ) -> Result<Option<(Kind, Option<f64>)>, Error> {
        let interval = self.observation.interval;
        let Some(found) = self.seen.last_lines() else { return Ok(None) };
        self.beats.push(beat(found));
        let main = found.lines.first().map(|line| line.frequency);
        let Some(main) = main else { return Ok(Some((Kind::Undecided, None))) };
        self.longest_step = longest_step(simulation, main);
        if self.longest_step.is_some() {
            return Ok(Some((Kind::Undecided, None)));
        }
        // A long search is made now and then.
        let is_last = self.is_last();
        let is_due = is_last || self.seen.count().is_multiple_of(WINDOWS_BETWEEN);
        if !is_due && period(simulation).is_some_and(|period| period > self.observation.window) {
            return Ok(None);
        }
        let looked_in_vain = self.windows < self.looked_in_vain + WINDOWS_IN_VAIN;
        if !is_due && looked_in_vain {
            return Ok(None);
        }
        let search = closure(simulation, interval, main, self.observation.rows(), is_over)?;
        let was_cut_short = matches!(search, Search::CutShort);
        if !matches!(search, Search::Found(_)) {
            self.closures.clear();
            self.looked_in_vain = self.windows;
        }
        if let Search::Found(found) = search {
            self.closures.push(found);
            let is_near = found.is_closed || is_closing(&self.closures);
            if is_near && found.is_shortest {
                return Ok(Some((Kind::Periodic, None)));
            }
            // It may come back nearer for long where a motion converges slowly.
            if !is_last {
                return Ok(None);
            }
        }
        // The kind of a motion that still converges may be found later.
        if !is_due {
            return Ok(None);
        }
        let is_of_two = !varies && self.seen.has_two_frequencies();
        self.is_of_two = is_of_two;
        let is_long = is_of_two || is_last;
        let parting = self.parting(simulation, main, is_long, is_over)?;
        // Neighbours that come together follow the signals, so the motion comes back after one or several of their periods.
        let repeats = short_period(simulation, self.observation.window).is_some();
        if parting == NeighbourSeparation::Together && repeats {
            let rows = self.observation.rows();
            let found = long_closure(simulation, interval, main, rows, is_over)?;
            if let Some(found) = found.filter(|found| found.is_closed && found.is_shortest) {
                self.closures.push(found);
                return Ok(Some((Kind::Periodic, None)));
            }
        }
        // A motion of more than two frequencies may still converge, unless its size has been constant for long.
        let has_come = is_of_two || self.closures.is_empty() && !self.seen.varies_less();
        let last = self.closures.last();
        let is_open = last.is_some_and(|last| may_wobble(simulation, main, last.distance));
        let kind = match parting {
            NeighbourSeparation::Exponential(_) => Kind::Irregular,
            NeighbourSeparation::Unknown => Kind::Undecided,
            _ if is_open || was_cut_short || !has_come => Kind::Undecided,
            _ if is_fading(&self.beats) => {
                return Ok(is_last.then_some((Kind::Unsettled, None)));
            }
            // Neighbours of a quasi-periodic motion keep their distance, unless signals without a period lead all of them.
            NeighbourSeparation::Together if repeats || !simulation.is_driven_on() => {
                Kind::Undecided
            }
            NeighbourSeparation::Regular | NeighbourSeparation::Together => Kind::QuasiPeriodic,
        };
        if !is_last && kind == Kind::Undecided {
            return Ok(None);
        }
        if kind != Kind::Undecided {
            self.closures.clear();
        }
        let rate = match parting {
            NeighbourSeparation::Exponential(rate) => Some(rate),
            _ => None,
        };
        Ok(Some((kind, rate)))
    }

    fn ending(&self, kind: Kind, driven: bool) -> LongTermMotion {
        let found = match kind {
            Kind::QuasiPeriodic | Kind::Irregular | Kind::Undecided => {
                lines(&[&self.past[..], &self.followed].concat(), self.observation.interval, TOLD)
            }
            _ => lines(&self.followed, self.observation.interval, TOLD),
        };
        let all = self.states.iter().sum::<u64>().max(1) as f64;
        let mut ending = LongTermMotion {
            kind,
            amplitude: half_range(&self.followed),
            frequency: None,
            period: None,
            closure: None,
            two_frequencies: false,
            follows: false,
            longest_step: None,
            parting: None,
            lines: Vec::new(),
            shares: self.states.map(|count| count as f64 / all),
            taken: self.taken,
            fading: [false; 4],
            time: (self.row - self.began) as f64 * self.observation.interval,
            rate: match self.seen.last_sizes() {
                [Some(last), Some(before)] if !driven && before > 0.0 && last > 0.0 => {
                    libm::log(last / before) / self.observation.window
                }
                _ => 0.0,
            },
            size: self.seen.last_sizes()[0].unwrap_or(0.0),
            scatter: self.seen.scatter(),
            linear: self.linear,
            extents: self.extents.iter().map(|[low, high]| 0.5 * (high - low)).collect(),
        };
        ending.take_lines(&found);
        ending
    }
}

/// Advances a simulation until its motion is settled; `None` if the watch ended it.
///
/// # Errors
/// Returns an error if the motion fails ([`Simulation::advance_to`]).
pub(crate) fn run_to_steady_state(
    simulation: &mut Simulation,
    observation: &ObservationSettings,
    is_over: &dyn Fn() -> bool,
) -> Result<Option<LongTermMotion>, Error> {
    run_and_tell(simulation, observation, is_over, &|_| {})
}

/// Advances a simulation as [`run_to_steady_state`] does. `reached` hears the time as a part of the longest one for a motion to
/// settle.
///
/// # Errors
/// Returns an error if the motion fails ([`Simulation::advance_to`]).
pub(crate) fn run_and_tell(
    simulation: &mut Simulation,
    observation: &ObservationSettings,
    is_over: &dyn Fn() -> bool,
    reached: &dyn Fn(f64),
) -> Result<Option<LongTermMotion>, Error> {
    let mut settling = Settling::new(simulation, observation)?;
    let start = simulation.time();
    loop {
        if settling.row.is_multiple_of(256) {
            if is_over() {
                return Ok(None);
            }
            reached((simulation.time() - start) / observation.longest);
        }
        simulation.advance_to(settling.next_time())?;
        if let Some(ending) = settling.note(simulation, is_over)? {
            // A watch that is over may have left the kind open.
            return Ok((!is_over()).then_some(ending));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assign::assign;
    use crate::study::ObservationRequest;
    use amontons::scene::builtin;

    /// The ending of a built-in scene with other values, by exact motion.
    fn ending(name: &str, values: &[(&str, f64)]) -> LongTermMotion {
        let mut scene = builtin(name).unwrap().scene();
        for (name, value) in values {
            assign(&mut scene, name, *value).unwrap();
        }
        let observation = ObservationSettings::of(&scene, &ObservationRequest::default()).unwrap();
        (scene.method, scene.step) = (Method::EventDriven, observation.interval);
        let mut simulation = Simulation::new(scene, 0.0).unwrap();
        run_to_steady_state(&mut simulation, &observation, &|| false).unwrap().unwrap()
    }

    #[test]
    fn set_1_ends_in_two_frequencies_that_have_no_common_one() {
        // The paper's Fig. 4, at about 170 and 215 Hz there.
        let ending = ending("set1", &[]);
        assert_eq!((ending.kind, ending.period), (Kind::QuasiPeriodic, None));
        assert_eq!(ending.frequency, Some(ending.lines[0][0]));
        for frequency in [167.0, 219.2] {
            let line = ending.lines.iter().find(|line| (line[0] - frequency).abs() < 0.5);
            assert!(line.is_some(), "{frequency} {:?}", ending.lines);
        }
        // Fig. 4: slip, stick and detachment.
        assert_eq!(ending.taken, [true, false, true, true]);
        assert!((ending.shares.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn set_1_at_a_lower_friction_has_one_frequency() {
        let values = [("friction.coefficient", 1.5), ("slider.velocity", 0.05)];
        let ending = ending("set1", &values);
        assert_eq!(ending.kind, Kind::Periodic);
        let period = ending.period.unwrap() * ending.frequency.unwrap();
        assert!((period - period.round()).abs() < 1e-4, "{period}");
    }

    #[test]
    fn what_decays_ends_at_rest() {
        let of_set2 = ending("set2", &[("friction.coefficient", 1.7)]);
        assert_eq!((of_set2.kind, of_set2.taken), (Kind::Equilibrium, [true, false, false, false]));
        assert!(ending("set1", &[("friction.coefficient", 0.5)]).rests());
    }

    #[test]
    fn a_growing_mode_hidden_beside_a_decaying_one_is_not_rest() {
        // Both modules alike but for a part in 5000: what is alike decays, what is not grows by 0.4 1/s.
        let values = [
            ("friction.coefficient", 1.2),
            ("initial.module[1].v1", 0.005),
            ("initial.module[2].v1", 0.005_001),
        ];
        let ending = ending("set1", &values);
        assert!(!ending.rests() && ending.taken[2], "{ending:?}");
    }

    #[test]
    fn signals_that_go_on_drive_a_scene() {
        let is_driven = |name: &str| {
            let scene = builtin(name).unwrap().scene();
            Simulation::new(scene, 0.0).unwrap().is_driven_on()
        };
        assert!(is_driven("den_hartog") && !is_driven("set1"));
    }
}
