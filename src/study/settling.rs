//! Whether a motion has settled.
//!
//! A motion is looked at window by window. It is *settled* when it rests, or when its size and its lines are the
//! same in windows that follow each other, and no faint line grows. What is compared is a mixture of all
//! displacements, so that nothing hides where one output does not see it.

use super::drive::{is_repeated, last_edge, period};
use super::ending::{Ending, Kind};
use super::family::{frequencies_of_sum, is_one_of_many};
use super::linear::{
    Growth, deflection, growth, has_linear_friction, has_states_of_rest, is_far, may_pull,
    stays_linear,
};
use super::look::{Look, output, unit};
use super::period::{OverSpan, over_span};
use super::recurrence::{
    Closure, Parting, Search, beat, closure, has_two_frequencies, is_closing, is_fading,
    longest_step, may_wobble, parting,
};
use crate::Error;
use crate::accuracy::half_range;
use crate::integrator::Statistics;
use crate::simulation::{Simulation, Variable};
use crate::spectral::{Line, Lines, Window, lines};
use crate::sweep::steady::{ROUNDING, STANDING, is_steady, mixture, weighted_deviation};

/// Lines of more than this part of the strongest one must be the same.
const STRONG: f64 = 1e-2;
/// By this part of their resolution, and by this part of their amplitude.
const SAME_PLACE: f64 = 0.1;
const SAME_LINE: f64 = 1e-2;
/// Lines of more than this part of the strongest one must not grow.
const FAINT: f64 = 1e-4;
/// Growth: through the last three windows each time, and in all by more than this part and what the strongest line's side
/// lobes, in parts of it, can feign.
const GROWN: f64 = 0.01;
const SIDE_LOBES: f64 = 3e-5;
/// A motion decays to rest if it, going on as it does, ends below this part of what is left of it.
const REST: f64 = 0.2;
/// A motion whose lines change from window to window has settled if its size has no trend over the first number of windows. In
/// the last window that is looked at, the other numbers count too.
const IRREGULAR_WINDOWS: [usize; 3] = [12, 24, 48];
/// Lines of more than this part of the strongest one are told.
const TOLD: f64 = 1e-3;
/// Lines of a motion without a period are told from so many windows before the last one too, since they may lie near each
/// other.
const MORE_WINDOWS: usize = 3;
/// Windows from one look at how neighbouring motions part to the next.
const WINDOWS_BETWEEN: usize = 12;
/// Windows after which a period is looked for again where none was found: that takes longer than a window.
const WINDOWS_IN_VAIN: usize = 4;

/// A motion that is looked at until it is settled.
pub(crate) struct Settling {
    look: Look,
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
    /// s, from when on signals only repeat themselves.
    last_edge: f64,
    /// How far the forces at rest would bend the structure, m: [`deflection`].
    deflection: f64,
    /// How many windows have ended.
    windows: usize,
    /// Those since the last edge.
    seen: Vec<Seen>,
    /// How the state came back at the end of each window since the motion was steady.
    closures: Vec<Closure>,
    /// Of all windows whose kind was asked for.
    beats: Vec<f64>,
    /// `true` if all strong lines combined two frequencies when the kind was last asked for.
    is_of_two: bool,
    /// The longest step of the paper's scheme, s, that can tell the kind; `None` where the scene's step can.
    longest_step: Option<f64>,
    /// How many windows had ended when the state was last seen not to come back.
    looked_in_vain: usize,
    /// Of the rows of a window.
    weights: Vec<f64>,
}

/// A window that was looked at.
struct Seen {
    /// Deviation of the mixture from its mean, root mean square of the weighted values, and whether a contact changed
    /// its state.
    size: f64,
    changed: bool,
    mixture: Vec<f64>,
    /// Found when they are needed.
    lines: Option<Lines>,
}

/// What a window says of a motion, together with those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Course {
    /// It rests, or decays to rest.
    Rests,
    /// Its size and its lines stay.
    Steady,
    /// Its size varies without a trend.
    Varies,
    /// It grows, and nothing can stop it.
    Unbounded,
    /// None of these yet.
    Open,
}

/// What a motion is held against.
#[derive(Clone, Copy)]
struct Surroundings<'a> {
    /// The largest displacement, m, of the motion, and of the equilibrium or what loads would bend ([`deflection`]).
    largest: f64,
    at_rest: f64,
    /// `true` where signals still drive the motion.
    is_driven: bool,
    /// `true` where what drives it does in each window what it has done in the last one ([`is_repeated`]).
    is_repeated: bool,
    /// `true` where loads and surfaces no longer matter ([`is_far`]).
    is_far: bool,
    /// `true` where contacts are in states in which the scene can rest.
    may_rest: bool,
    /// `true` where no contact can change its state, so that motions are linear at any size.
    stays_linear: bool,
    /// Computes the [`growth`] in the present contact states.
    growth: &'a dyn Fn() -> Option<Growth>,
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
            past: Vec::new(),
            mixture: Vec::new(),
            extents: Vec::new(),
            states: [0; 4],
            taken: [false; 4],
            pulled: false,
            linear: false,
            before: simulation.statistics(),
            last_edge: last_edge(simulation.scene()),
            deflection: deflection(simulation),
            windows: 0,
            seen: Vec::new(),
            closures: Vec::new(),
            beats: Vec::new(),
            is_of_two: false,
            longest_step: None,
            looked_in_vain: 0,
            #[allow(clippy::cast_possible_truncation)]
            weights: Window::BlackmanHarris.weights(look.rows() as usize),
        };
        settling.begin_window(simulation);
        Ok(settling)
    }

    fn begin_window(&mut self, simulation: &Simulation) {
        #[allow(clippy::cast_possible_truncation)]
        let room = MORE_WINDOWS * self.look.rows() as usize;
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

    /// When the next row is due, s.
    #[allow(clippy::cast_precision_loss)]
    pub(crate) fn next_time(&self) -> f64 {
        (self.row + 1) as f64 * self.look.interval
    }

    /// Takes note of the row that is due; what the motion ends in, once that is known. A watch that says that it is over
    /// leaves the kind of a motion open.
    pub(crate) fn note(
        &mut self,
        simulation: &mut Simulation,
        is_over: &dyn Fn() -> bool,
    ) -> Result<Option<Ending>, Error> {
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
        if self.followed.len() as u64 == self.look.rows() {
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

    /// How many windows a motion has stood still for without a change of state, the one that has ended included; 1 of any
    /// other motion. Over so long the drive must have repeated itself.
    #[allow(clippy::cast_precision_loss)]
    fn still(&self, changed: bool) -> f64 {
        let is_still = |seen: &&Seen| seen.size == 0.0 && !seen.changed;
        let before = self.seen.iter().rev().take_while(is_still).count();
        1.0 + if changed { 0.0 } else { before as f64 }
    }

    /// Is the window that has ended the last one that the motion may take?
    fn is_last(&self) -> bool {
        self.windows >= self.look.windows()
    }

    /// The end of a window.
    fn close(
        &mut self,
        simulation: &Simulation,
        is_over: &dyn Fn() -> bool,
    ) -> Result<Option<Ending>, Error> {
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
        let largest = |x: &[f64]| x.iter().fold(0.0, |most, x| f64::max(most, x.abs()));
        let course = self.judge(
            changed,
            Surroundings {
                largest: largest(simulation.displacement()),
                at_rest: largest(&simulation.reference().displacement).max(self.deflection),
                is_driven: simulation.is_driven_on(),
                is_repeated: is_repeated(simulation, self.still(changed) * self.look.window),
                is_far: is_far(simulation),
                may_rest,
                stays_linear: stays_linear(simulation),
                growth: &|| growth(simulation),
            },
        );
        // What a surface carries along, or flies on, comes to an end.
        let goes_on = !changed && !may_rest && !simulation.is_driven_on();
        // A window with the last edge of a signal in it shows what comes to an end, too.
        let began = (self.row - self.look.rows()) as f64 * self.look.interval;
        let waits = began < self.last_edge;
        let is_open = goes_on || waits && course != Course::Unbounded;
        let course = if is_open { Course::Open } else { course };
        let kind = match course {
            Course::Rests => Some((Kind::Equilibrium, None)),
            Course::Unbounded => Some((Kind::Unbounded, None)),
            Course::Steady | Course::Varies => {
                self.kind(simulation, course == Course::Varies, is_over)?
            }
            Course::Open => None,
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
            let strongest = self.seen.last().and_then(|seen| seen.lines.as_ref()?.lines.first());
            let frequency = strongest.map(|line| line.frequency);
            ending.linear = is_one_of_many(simulation, &self.look, frequency, is_over)?;
        }
        ending.longest_step = self.longest_step.filter(|_| kind == Kind::Undecided);
        if kind == Kind::QuasiPeriodic {
            // A mode of a sum may be too faint for the mixture's lines in which two frequencies were seen.
            let is_sum = ending.linear && !simulation.is_driven_on();
            let more = is_sum && frequencies_of_sum(simulation).is_none_or(|count| count > 2);
            ending.two_frequencies = self.is_of_two && !more;
        }
        if ending.linear && kind == Kind::Unsettled && !simulation.is_driven_on() {
            // Two windows may differ by noise; eigenvalues do not.
            let goes = |growth: &Growth| growth.is_growing() || growth.is_decaying();
            ending.rate = growth(simulation).filter(goes).map_or(0.0, |growth| growth.rate);
        }
        ending.parting = parting;
        match kind {
            Kind::Equilibrium => ending.come_to_rest(),
            // Lines of one window need not be those of the next.
            Kind::Unsettled if !ending.is_known() => ending.frequency = None,
            _ => {}
        }
        let closure = self.closures.last().filter(|_| kind.is_cycle());
        let span = match kind {
            Kind::Periodic => closure.map(|closure| closure.period),
            _ => kind.is_cycle().then_some(self.look.window),
        };
        let over = span.map(|span| over_span(simulation, &self.output, span, self.look.interval));
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
            let largest = ending.extents.iter().copied().fold(0.0, f64::max);
            if unit(&self.output) == "m" && ending.amplitude <= ROUNDING * largest {
                ending.amplitude = 0.0;
            }
        }
        Ok(Some(ending))
    }

    /// Looks at the window that has ended, in which contacts changed their states or did not, with the last ones.
    fn judge(&mut self, changed: bool, around: Surroundings<'_>) -> Course {
        let size = weighted_deviation(&self.mixture, &self.weights);
        let mixture = std::mem::take(&mut self.mixture);
        self.seen.push(Seen { size, changed, mixture, lines: None });
        // Older ones are not looked at again, but for their size.
        if let Some(old) = self.seen.len().checked_sub(5) {
            (self.seen[old].mixture, self.seen[old].lines) = (Vec::new(), None);
        }
        // Against the equilibrium, too: what is left of a motion at rest is rounding of forces.
        let nothing = ROUNDING * around.largest.max(around.at_rest);
        let is_rounding = size <= nothing;
        let is_free = !around.is_driven;
        // What does not move at all while a sine pulls at it is held by friction, which is as it was after each period.
        if size == 0.0 && !changed && around.is_repeated {
            return Course::Rests;
        }
        // Friction that is at its limit for an instant of each period may let a contact go and hold it again, by rounding.
        let flickers = around.is_driven && around.is_repeated && changed && is_rounding;
        let has_been = || self.seen.iter().rev().take(4).all(|seen| seen.size <= nothing);
        if flickers && self.seen.len() >= 4 && has_been() {
            let is_growing = (around.growth)().is_some_and(Growth::is_growing);
            return if is_growing { Course::Open } else { Course::Rests };
        }
        // What a sine keeps pushing gets no smaller, so only what rests already does.
        let is_resting = is_rounding || is_free && rests(&self.seen);
        if around.is_repeated && around.may_rest && (is_resting || is_free && is_calm(&self.seen)) {
            let growth = (around.growth)();
            let is_growing = growth.is_some_and(Growth::is_growing);
            let is_decaying = growth.is_some_and(Growth::is_decaying);
            // A calm motion has only its eigenvalues to say that it decays.
            if is_decaying || !is_growing && is_resting {
                return Course::Rests;
            }
        }
        let sizes: Vec<f64> = self.seen.iter().map(|seen| seen.size).collect();
        if is_free && (is_unbounded(around) || around.is_far && grows_evenly(&sizes)) {
            return Course::Unbounded;
        }
        if is_steady(&sizes) && self.has_steady_lines() {
            return Course::Steady;
        }
        // A beat that is longer than some windows has a trend over these, and none over more.
        let lengths = if self.is_last() { &IRREGULAR_WINDOWS[..] } else { &IRREGULAR_WINDOWS[..1] };
        let varies = |windows: &usize| has_no_trend(&sizes, *windows);
        if changed && lengths.iter().any(varies) { Course::Varies } else { Course::Open }
    }

    /// The kind of a motion that has settled, with the rate at which neighbours part; `None` while its state still comes
    /// nearer to where it was, from window to window.
    fn kind(
        &mut self,
        simulation: &Simulation,
        varies: bool,
        is_over: &dyn Fn() -> bool,
    ) -> Result<Option<(Kind, Option<f64>)>, Error> {
        let interval = self.look.interval;
        let Some(last) = self.seen.last_mut() else { return Ok(None) };
        let found = last.lines.take().unwrap_or_else(|| lines(&last.mixture, interval, FAINT));
        self.beats.push(beat(&found));
        let main = found.lines.first().map(|line| line.frequency);
        last.lines = Some(found);
        let Some(main) = main else { return Ok(Some((Kind::Undecided, None))) };
        self.longest_step = longest_step(simulation, main);
        if self.longest_step.is_some() {
            return Ok(Some((Kind::Undecided, None)));
        }
        // A long search is made now and then.
        let is_last = self.is_last();
        let is_due = is_last || self.seen.len().is_multiple_of(WINDOWS_BETWEEN);
        if !is_due && period(simulation).is_some_and(|period| period > self.look.window) {
            return Ok(None);
        }
        let looked_in_vain = self.windows < self.looked_in_vain + WINDOWS_IN_VAIN;
        if !is_due && looked_in_vain {
            return Ok(None);
        }
        let search = closure(simulation, interval, main, self.look.rows(), is_over)?;
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
        // What cannot be told of a motion that still converges may be told later.
        if !is_due {
            return Ok(None);
        }
        let is_of_two = !varies && self.has_two_frequencies();
        self.is_of_two = is_of_two;
        let is_long = is_of_two || is_last;
        let parting = parting(simulation, interval, main, (self.look.rows(), is_long), is_over)?;
        // What has more frequencies than two may yet converge, unless its size has stayed as it is for long.
        let has_come = is_of_two || self.closures.is_empty() && !varies_less(&self.seen);
        let last = self.closures.last();
        let is_open = last.is_some_and(|last| may_wobble(simulation, main, last.distance));
        let kind = match parting {
            Parting::Exponential(_) => Kind::Irregular,
            Parting::Regular if is_open || was_cut_short || !has_come => Kind::Undecided,
            Parting::Regular if is_fading(&self.beats) => {
                return Ok(is_last.then_some((Kind::Unsettled, None)));
            }
            Parting::Regular => Kind::QuasiPeriodic,
            Parting::Unknown => Kind::Undecided,
        };
        if !is_last && kind == Kind::Undecided {
            return Ok(None);
        }
        if kind != Kind::Undecided {
            self.closures.clear();
        }
        let rate = match parting {
            Parting::Exponential(rate) => Some(rate),
            Parting::Regular | Parting::Unknown => None,
        };
        Ok(Some((kind, rate)))
    }

    /// Are all strong lines of the last window combinations of two frequencies?
    fn has_two_frequencies(&self) -> bool {
        self.seen.last().and_then(|seen| seen.lines.as_ref()).is_some_and(has_two_frequencies)
    }

    fn ending(&self, kind: Kind, driven: bool) -> Ending {
        let found = match kind {
            Kind::QuasiPeriodic | Kind::Irregular | Kind::Undecided => {
                lines(&[&self.past[..], &self.followed].concat(), self.look.interval, TOLD)
            }
            _ => lines(&self.followed, self.look.interval, TOLD),
        };
        let all = self.states.iter().sum::<u64>().max(1) as f64;
        let mut ending = Ending {
            kind,
            amplitude: half_range(&self.followed),
            frequency: None,
            period: None,
            closure: None,
            two_frequencies: false,
            longest_step: None,
            parting: None,
            lines: Vec::new(),
            shares: self.states.map(|count| count as f64 / all),
            taken: self.taken,
            time: (self.row - self.began) as f64 * self.look.interval,
            rate: match &self.seen[..] {
                [.., before, last] if !driven && before.size > 0.0 && last.size > 0.0 => {
                    libm::log(last.size / before.size) / self.look.window
                }
                _ => 0.0,
            },
            size: self.seen.last().map_or(0.0, |last| last.size),
            scatter: scatter(&self.seen),
            linear: self.linear,
            extents: self.extents.iter().map(|[low, high]| 0.5 * (high - low)).collect(),
        };
        ending.take_lines(&found);
        ending
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
            let feigned = SIDE_LOBES * strongest.amplitude;
            // Not through all windows: at first what a push has brought besides may decay faster.
            let last = &before[1..];
            let grows = last.windows(2).all(|two| two[1] > two[0])
                && last[2] > (1.0 + GROWN) * last[0] + feigned;
            if unchanged && goes_one_way(&before) {
                return false;
            }
            if strong { [oldest, windows[2]].iter().all(stays) } else { !grows }
        })
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
        if let Some(ending) = settling.note(simulation, is_over)? {
            // A watch that is over may have left the kind open.
            return Ok((!is_over()).then_some(ending));
        }
    }
}

/// Has no contact changed its state over two windows, in the last of which the motion got smaller?
fn is_calm(seen: &[Seen]) -> bool {
    matches!(seen, [.., before, last] if !before.changed && !last.changed && last.size < before.size)
}

/// By how much the size of a motion differs over its last windows, logarithm of the largest by the smallest.
fn scatter(seen: &[Seen]) -> f64 {
    let last = || seen.iter().rev().take(4).map(|seen| seen.size);
    let (least, most) = (last().fold(f64::INFINITY, f64::min), last().fold(0.0, f64::max));
    if least > 0.0 && most > 0.0 { libm::log(most / least) } else { 0.0 }
}

/// Does the size of a motion vary less and less? Then it may come to stay, and the motion to one with a period.
#[allow(clippy::cast_precision_loss)]
fn varies_less(seen: &[Seen]) -> bool {
    const LESS: f64 = 0.8;
    let sizes: Vec<f64> = seen.iter().map(|seen| seen.size).collect();
    let parts: Vec<f64> =
        sizes.rchunks_exact((sizes.len() / 4).max(1)).take(3).map(deviation).collect();
    let [last, middle, first] = parts[..] else { return true };
    last < middle && middle < first && last < LESS * first
}

/// Has a motion grown by about the same factor over each of the last windows?
fn grows_evenly(sizes: &[f64]) -> bool {
    const FACTOR: f64 = 1.01;
    const SAME: f64 = 1.2;
    let Some(first) = sizes.len().checked_sub(4) else { return false };
    let factors: Vec<f64> = sizes[first..].windows(2).map(|two| two[1] / two[0]).collect();
    let least = factors.iter().copied().fold(f64::INFINITY, f64::min);
    let most = factors.iter().copied().fold(0.0, f64::max);
    least > FACTOR && libm::log(most) <= SAME * libm::log(least)
}

/// Does a motion grow that nothing can stop, since its contacts cannot change their states?
fn is_unbounded(around: Surroundings<'_>) -> bool {
    around.stays_linear && (around.growth)().is_some_and(Growth::is_growing)
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

/// Do amplitudes only grow, or only decay, by more than rounding?
fn goes_one_way(amplitudes: &[f64]) -> bool {
    let ratios = amplitudes.windows(2).map(|two| two[1] / two[0] - 1.0);
    ratios.clone().all(|ratio| ratio > STANDING) || ratios.clone().all(|ratio| ratio < -STANDING)
}

/// Has the size, though it varies, no trend over the last `windows`?
#[allow(clippy::cast_precision_loss)]
fn has_no_trend(sizes: &[f64], windows: usize) -> bool {
    let Some(first) = sizes.len().checked_sub(windows) else { return false };
    let (a, b) = sizes[first..].split_at(windows / 2);
    let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
    let spread = deviation(&sizes[first..]);
    let rises = sizes[first..].windows(2).filter(|two| two[1] > two[0]).count();
    // A drift goes one way, what varies goes both.
    (mean(a) - mean(b)).abs() <= spread
        && (windows / 4..=2 * windows / 3).contains(&rises)
        && spread <= 0.5 * mean(b)
}

/// The amplitude of the line of a window that is within this part of the resolution of another line.
fn near(line: &Line, window: &Lines, part: f64) -> Option<f64> {
    let at = |other: &&Line| (other.frequency - line.frequency).abs() <= part * window.resolution;
    window.lines.iter().find(at).map(|other| other.amplitude)
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

    const FREE: Surroundings<'static> = Surroundings {
        largest: 1.0,
        at_rest: 0.0,
        is_driven: false,
        is_repeated: true,
        is_far: false,
        may_rest: true,
        stays_linear: false,
        growth: &|| None,
    };

    /// The number of windows of two seconds after which a made-up motion has settled, and how.
    fn known(changes: bool, motion: impl Fn(f64) -> f64) -> Option<(usize, Course)> {
        let scene = builtin("set1").unwrap().scene();
        let look = Look::of(&scene, &Wish::default()).unwrap();
        let simulation = Simulation::new(scene, 0.0).unwrap();
        let mut settling = Settling::new(&simulation, &look).unwrap();
        for window in 0..20 {
            let time = |row: u64| (window * look.rows() + row) as f64 * look.interval;
            settling.mixture = (0..look.rows()).map(time).map(&motion).collect();
            settling.followed = settling.mixture.clone();
            let largest = settling.mixture.iter().fold(0.0, |most, x| f64::max(most, x.abs()));
            match settling.judge(changes, Surroundings { largest, ..FREE }) {
                Course::Open => {}
                course => return Some((settling.seen.len(), course)),
            }
        }
        None
    }

    fn sine(frequency: f64, t: f64) -> f64 {
        (TAU * frequency * t).sin()
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
    fn what_has_a_trend_over_some_windows_may_have_none_over_more() {
        // A beat of 24 windows beside some scatter, and a decay of the same extent.
        let scattered = |size: &dyn Fn(f64) -> f64| -> Vec<f64> {
            let scatter = |i: i32| 0.05 * f64::from(i * i % 11) / 11.0;
            (0..60).map(|i| size(f64::from(i)) + scatter(i)).collect()
        };
        let beats = scattered(&|i| 1.0 + 0.2 * (TAU * i / 24.0).cos());
        let decays = scattered(&|i| 0.8 + 0.4 * (-i / 20.0).exp());
        let [few, _, most] = IRREGULAR_WINDOWS;
        assert_eq!([few, most].map(|windows| has_no_trend(&beats, windows)), [false, true]);
        assert_eq!([few, most].map(|windows| has_no_trend(&decays, windows)), [false, false]);
        // A beat that dies has no trend, and varies less and less.
        let seen = |sizes: Vec<f64>| -> Vec<Seen> {
            let seen = |size| Seen { size, changed: true, mixture: Vec::new(), lines: None };
            sizes.into_iter().map(seen).collect()
        };
        let beat = |i: f64| (TAU * i / 14.0).cos();
        let dies = |i: f64| 1.0 + 0.5 * (-i / 100.0).exp() * beat(i);
        assert!(varies_less(&seen((0..60).map(f64::from).map(dies).collect())));
        assert!(!varies_less(&seen(beats)));
    }

    #[test]
    fn what_decays_ends_at_rest() {
        let of_set2 = ending("set2", &[("friction.coefficient", 1.7)]);
        assert_eq!((of_set2.kind, of_set2.taken), (Kind::Equilibrium, [true, false, false, false]));
        assert!(ending("set1", &[("friction.coefficient", 0.5)]).rests());
        assert_eq!(known(false, |t| (-0.05 * t).exp() * sine(40.0, t)).unwrap().1, Course::Rests);
        assert_eq!(known(false, |_| 7.0), Some((1, Course::Rests)));
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
    fn what_grows_evenly_far_beyond_all_loads_grows_without_bound() {
        let scene = builtin("set1").unwrap().scene();
        let look = Look::of(&scene, &Wish::default()).unwrap();
        let simulation = Simulation::new(scene, 0.0).unwrap();
        let last = |is_far: bool, rate: &dyn Fn(f64) -> f64| {
            let mut settling = Settling::new(&simulation, &look).unwrap();
            let mut course = Course::Open;
            for window in 0..6 {
                let time = |row: u64| (window * look.rows() + row) as f64 * look.interval;
                let growing = |t: f64| rate(t).exp() * sine(40.0, t);
                settling.mixture = (0..look.rows()).map(time).map(growing).collect();
                course = settling.judge(true, Surroundings { is_far, ..FREE });
            }
            course
        };
        assert_eq!(last(true, &|t| 0.5 * t), Course::Unbounded);
        assert_eq!(last(false, &|t| 0.5 * t), Course::Open);
        assert_eq!(last(true, &|t| 2.0 * (0.3 * t).sin()), Course::Open);
    }

    #[test]
    fn what_signals_drive_on_does_not_rest_however_it_decays() {
        let scene = builtin("set1").unwrap().scene();
        let look = Look::of(&scene, &Wish::default()).unwrap();
        let simulation = Simulation::new(scene, 0.0).unwrap();
        let mut settling = Settling::new(&simulation, &look).unwrap();
        for window in 0..8 {
            let time = |row: u64| (window * look.rows() + row) as f64 * look.interval;
            let decaying = |t: f64| (-0.5 * t).exp() * sine(40.0, t);
            settling.mixture = (0..look.rows()).map(time).map(decaying).collect();
            let driven = Surroundings { is_driven: true, is_repeated: false, ..FREE };
            assert_eq!(settling.judge(false, driven), Course::Open);
        }
        let driven = builtin("den_hartog").unwrap().scene();
        assert!(Simulation::new(driven, 0.0).unwrap().is_driven_on());
        assert!(!simulation.is_driven_on());
    }

    #[test]
    fn sums_of_sines_are_steady() {
        let one = |t| sine(219.38, t) + 0.1 * sine(438.76, t);
        let two = |t| sine(219.38, t) + 0.3 * sine(167.81, t) + 0.02 * sine(219.38 - 167.81, t);
        let three = |t| two(t) + 0.1 * sine(91.237, t);
        let found = [known(true, one), known(true, two), known(true, three)];
        assert_eq!(found, [Some((4, Course::Steady)); 3]);
    }

    #[test]
    fn noise_varies_without_a_trend() {
        let noise = |t: f64| {
            let mut bits = t.to_bits().wrapping_mul(0x9E37_79B9_7F4A_7C15);
            bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            (bits >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        assert_eq!(known(true, noise).unwrap().1, Course::Varies);
    }

    #[test]
    fn what_still_grows_or_decays_is_not_settled_however_slowly() {
        // By 0.05 % a window, far less than what a cycle may vary, for 20 windows.
        for rate in [2.5e-4, -2.5e-4] {
            assert_eq!(known(true, |t| (rate * t).exp() * sine(200.0, t)), None, "{rate}");
        }
        assert_eq!(known(false, |t| (2.5e-4 * t).exp() * sine(200.0, t)), None);
        // Nor where a line beside the main one does, of a motion without events, by 0.2 % a window.
        let beside = |t: f64| sine(200.0, t) + 0.05 * (-1e-3 * t).exp() * sine(91.3, t);
        assert_eq!(known(false, beside), None);
        // What comes to its end is.
        let ends = |t: f64| (1.0 - (-t).exp()) * sine(200.0, t);
        let (windows, course) = known(true, ends).unwrap();
        assert!((5..8).contains(&windows) && course == Course::Steady, "{windows}");
    }

    #[test]
    fn a_calm_motion_rests_or_grows_without_bound_as_its_eigenvalues_say() {
        let last = |rate: f64, growth: f64, stays_linear: bool| {
            let scene = builtin("set1").unwrap().scene();
            let look = Look::of(&scene, &Wish::default()).unwrap();
            let simulation = Simulation::new(scene, 0.0).unwrap();
            let mut settling = Settling::new(&simulation, &look).unwrap();
            let growth = || Some(Growth { rate: growth, relative: growth });
            let around = Surroundings { stays_linear, growth: &growth, ..FREE };
            let courses = (0..4).map(|window| {
                let time = |row: u64| (window * look.rows() + row) as f64 * look.interval;
                let motion = |t: f64| (rate * t).exp() * sine(200.0, t);
                settling.mixture = (0..look.rows()).map(time).map(motion).collect();
                settling.judge(false, around)
            });
            courses.last()
        };
        // By 0.02 % a window: far too slow to be seen to end.
        assert_eq!(last(-1e-4, -1e-7, false), Some(Course::Rests));
        assert_eq!(last(-1e-4, 1e-7, false), Some(Course::Open));
        assert_eq!(last(1e-4, 1e-7, true), Some(Course::Unbounded));
        assert_eq!(last(1e-4, 1e-7, false), Some(Course::Open));
    }

    #[test]
    fn a_plateau_on_which_a_faint_line_grows_is_not_settled() {
        // From 2e-4 to 1e-2 of the strong line over the twenty windows, in which the size is the same to 1e-4.
        let faint = |t: f64| 2e-4 * (0.1 * t).exp() * sine(167.0, t);
        assert_eq!(known(true, |t| sine(219.2, t) + faint(t)), None);
        assert!(known(true, |t| sine(219.2, t) + 2e-4 * sine(167.0, t)).is_some());
    }

    #[test]
    fn a_window_that_holds_no_whole_number_of_periods_has_the_same_size_wherever_it_begins() {
        let weights = Window::BlackmanHarris.weights(2000);
        let size = |phase: f64| {
            let wave = |i: i32| {
                let part = (21.4 * f64::from(i) / 2000.0 + phase).fract();
                if part < 0.8 { part } else { 4.0 * (1.0 - part) }
            };
            weighted_deviation(&(0..2000).map(wave).collect::<Vec<_>>(), &weights)
        };
        for i in 1..20 {
            // Of a triangle from 0 to 0.8: that over √12.
            let off = size(0.05 * f64::from(i)) / (0.8 / 12.0_f64.sqrt()) - 1.0;
            assert!(off.abs() < 1e-4, "{i}: {off}");
        }
    }
}
