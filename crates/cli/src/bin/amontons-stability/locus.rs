//! `amontons-stability locus`.

use crate::arguments::Locus as LocusArguments;
use crate::labels::{LOCATED, at_frequency, significant, turn};
use crate::{AnalysedScene, Failure, check_effect, configured, state, with};
use amontons::Error;
use amontons::contact::ContactState;
use amontons::model::LumpedModel;
use amontons::scene::Scene;
use amontons_analysis::assign::assign;
use amontons_analysis::patterns::in_words;
use amontons_analysis::stability::Linearised;
use amontons_analysis::stability::candidates::equilibrium_ranges;
use amontons_analysis::stability::locus::{ALL_FREQUENCIES, Locus, Root, locus};
use amontons_analysis::sweep::range::MAX_VALUES;
use amontons_analysis::sweep::{FRICTION, Possible, axis};
use amontons_cli::arguments::Values;
use amontons_cli::progress::Progress;
use amontons_pictures::picture::{self, Chart, locus_chart};
use std::f64::consts::TAU;
use std::io::Write;

/// The loci to follow: one, or one over µ for each value of another parameter.
struct Family<'a> {
    given: &'a AnalysedScene,
    /// Notes on values that are left out.
    notes: Vec<String>,
    states: Vec<ContactState>,
    /// Bounds of the frequencies, Hz.
    frequencies: [f64; 2],
    /// The parameter along x.
    name: &'a str,
    values: &'a [f64],
    /// The other parameter.
    other: Option<&'a str>,
    members: Vec<Member>,
}

/// A locus, and the value of the other parameter that it was made with.
struct Member {
    at: Option<f64>,
    locus: Locus,
    /// Ranges of the parameter in which uniform sliding has an equilibrium; `None` for other states, where it is
    /// unknown.
    equilibrium: Option<Vec<[f64; 2]>>,
}

/// Limit of the number of loci in one picture.
const MAX_DRAWN: usize = 24;

pub fn run(arguments: &LocusArguments, out: &mut dyn Write) -> Result<(), Failure> {
    arguments.plot.as_deref().map_or(Ok(()), picture::check_name)?;
    let (name, Values(values), other) = match (&arguments.friction, &arguments.parameter) {
        (Some(friction), parameter) => (FRICTION, friction, parameter.as_ref()),
        (None, Some((name, values))) => (name.as_str(), values, None),
        (None, None) => unreachable!("the command line asks for one of them"),
    };
    let (other, others) = match other {
        Some((other, Values(others))) => (Some(other.as_str()), Some(others)),
        None => (None, None),
    };
    if other == Some(name) {
        return Err(Failure::Usage(format!("{name} is given twice; name another --parameter")));
    }
    let varied: Vec<&str> = [name].into_iter().chain(other).collect();
    let given = configured(&arguments.common, None, &varied)?;
    let scene = &given.scene;
    let count = others.map_or(1, Vec::len);
    if values.len() as f64 * count as f64 > MAX_VALUES {
        return Err(Failure::Usage(format!(
            "{} × {count} values are too many; a locus has at most {MAX_VALUES:e}",
            values.len()
        )));
    }
    if arguments.plot.is_some() && count > MAX_DRAWN {
        return Err(Failure::Usage(format!(
            "a picture shows at most {MAX_DRAWN} loci, not {count}; choose a larger step, or leave out --plot"
        )));
    }
    let is_uniform = arguments.state.is_none();
    if is_uniform {
        Linearised::of(scene).uniform_sliding().or_else(|error| {
            // Another velocity may be among the values.
            if varied.iter().any(|name| name.ends_with("velocity")) {
                Ok(Vec::new())
            } else {
                Err(error)
            }
        })?;
    }
    for (name, values) in [Some((name, values)), other.zip(others)].into_iter().flatten() {
        let seen = |value: f64| {
            let mut scene = scene.clone();
            assign(&mut scene, name, value)?;
            let here = Linearised::of(&scene);
            let friction: Option<Vec<_>> = here.linear().ok().map(|it| it.friction().collect());
            let LumpedModel { mass, stiffness, damping, dampers, contacts, .. } =
                here.model().clone();
            let directions = contacts.into_iter().map(|contact| (contact.normal, contact.tangent));
            Ok((mass, stiffness, damping, dampers, directions.collect::<Vec<_>>(), friction))
        };
        let wish = "eigenvalues depend on masses, stiffnesses, damping, slider.angle and \
                    friction.coefficient, and on velocities and loads where friction falls with the slip velocity";
        check_effect(name, values, seen, wish)?;
    }
    let mut notes = Vec::new();
    let mut values = values.clone();
    for &at in others.map_or(&[0.0][..], Vec::as_slice) {
        let mut scene = scene.clone();
        if let Some(other) = other {
            assign(&mut scene, other, at)?;
        }
        let possible = Possible::of(&scene, name, &values)?;
        notes.extend(possible.note(name));
        values = possible.values;
        if values.len() < 2 {
            let only = format!(
                "only the value {} of {name} is possible; a locus needs at least two values",
                values[0]
            );
            return Err(Failure::Usage(only));
        }
        if is_uniform {
            let (kept, note) = sliding_values(&scene, name, &values)?;
            values = kept;
            notes.extend(note);
        }
    }
    for note in &notes {
        eprintln!("note: {note}");
    }
    let first = with(scene, name, values[0])?;
    let states = state(arguments.state.as_deref(), scene, &Linearised::of(&first))?;
    let mut family = Family {
        given: &given,
        notes,
        states,
        frequencies: arguments.frequencies.unwrap_or(ALL_FREQUENCIES),
        name,
        values: &values,
        other,
        members: Vec::new(),
    };
    let progress = Progress::in_parts("the locus");
    match others {
        None => family.follow(None, is_uniform, &|part| progress.set_part(part))?,
        Some(others) => {
            for (place, &at) in others.iter().enumerate() {
                let done =
                    |part: f64| progress.set_part((place as f64 + part) / others.len() as f64);
                family.follow(Some(at), is_uniform, &done)?;
            }
        }
    }
    progress.finish();
    if arguments.csv {
        family.print_csv(out)?;
    } else {
        family.print_events(out)?;
    }
    match &arguments.plot {
        Some(path) => Ok(family.chart().write(path)?),
        None => Ok(()),
    }
}

impl Family<'_> {
    /// Adds the locus for one value of the other parameter.
    fn follow(
        &mut self,
        at: Option<f64>,
        is_uniform: bool,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<(), Failure> {
        let scene = match self.other.zip(at) {
            Some((other, at)) => with(&self.given.scene, other, at)?,
            None => self.given.scene.clone(),
        };
        let here = |value: f64| Ok::<_, Error>(Linearised::of(&with(&scene, self.name, value)?));
        let has_equilibrium = |value: f64| {
            let here = here(value)?;
            // Other contacts may be closed at other values.
            let states = if is_uniform { self.states.clone() } else { here.resting_state() };
            here.equilibrium_in(&states).map(|_| ())
        };
        let equilibrium = equilibrium_ranges(&has_equilibrium, self.values);
        let needs_all = here(self.values[0])?.model().needs_equilibrium();
        if needs_all && equilibrium != [[self.values[0], self.values[self.values.len() - 1]]] {
            return Err(self.explain_missing_slopes(&equilibrium, has_equilibrium));
        }
        let done = |done: usize, all: usize| progress(done as f64 / all as f64);
        let locus = locus(&here, &self.states, self.values, self.frequencies, &done)?;
        if self.frequencies != ALL_FREQUENCIES && locus.followed().next().is_none() {
            let [from, to] = self.frequencies;
            return Err(Failure::Usage(format!(
                "no mode has a frequency from {from} to {to} Hz; widen --frequencies, or leave it out"
            )));
        }
        let equilibrium = is_uniform.then_some(equilibrium);
        self.members.push(Member { at, locus, equilibrium });
        Ok(())
    }

    /// Explains that eigenvalues cannot be followed because no equilibrium exists about which to linearise friction.
    fn explain_missing_slopes(
        &self,
        ranges: &[[f64; 2]],
        has_equilibrium: impl Fn(f64) -> Result<(), Error>,
    ) -> Failure {
        let lost = self.values.iter().find_map(|value| has_equilibrium(*value).err());
        let why = lost.map_or_else(String::new, |error| format!(" ({error})"));
        let widest = ranges.iter().max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])));
        let wish = match widest {
            Some([from, to]) => format!("; there is one from {from} to {to}: give that range"),
            None => String::new(),
        };
        let name = self.name;
        let what = match self.given.scene.contact_law().friction.info().is_constant() {
            true => "friction across the sliding",
            false => "friction that depends on the slip velocity",
        };
        Failure::Usage(format!(
            "{what} is linearised about an equilibrium, which is missing for some \
             values of {name}{why}{wish}"
        ))
    }

    fn print_events(&self, out: &mut dyn Write) -> Result<(), Failure> {
        let [first, .., last] = self.values else { unreachable!("a range has two ends") };
        let states = in_words(&self.states, &self.given.scene);
        let bounds = match self.frequencies {
            ALL_FREQUENCIES => String::new(),
            [from, to] => format!(", modes from {from} to {to} Hz"),
        };
        writeln!(
            out,
            "{}: state {states}, {} from {first} to {last}{bounds}",
            self.given.scene.name, self.name
        )?;
        write!(out, "{}", self.given.head())?;
        for note in &self.notes {
            writeln!(out, "{note}")?;
        }
        for Member { at, locus, equilibrium } in &self.members {
            if let (Some(other), Some(at)) = (self.other, at) {
                writeln!(out, "\n{other} = {at}")?;
            }
            if let Some(ranges) = equilibrium {
                print_equilibrium(ranges, [*first, *last], out)?;
            }
            print_events(locus, out)?;
        }
        Ok(())
    }

    fn print_csv(&self, out: &mut dyn Write) -> Result<(), Failure> {
        let first = self.other.map_or_else(String::new, |other| format!("{other},"));
        writeln!(out, "{first}{},mode,growth_rate,real_hz,imaginary_hz", self.name)?;
        for Member { at, locus, .. } in &self.members {
            let first = at.map_or_else(String::new, |at| format!("{at:?},"));
            for (i, value) in locus.values.iter().enumerate() {
                let followed = locus.followed().map(|(mode, branch)| (mode, branch[i]));
                for (mode, Root { lambda, .. }) in
                    followed.filter(|(_, root)| locus.contains(*root))
                {
                    writeln!(
                        out,
                        "{first}{value:?},{},{:?},{:?},{:?}",
                        mode + 1,
                        lambda.re,
                        lambda.re / TAU,
                        lambda.im / TAU
                    )?;
                }
            }
        }
        Ok(())
    }

    /// Fig. 2(a) and (b): real and imaginary parts of λ/2π.
    fn chart(&self) -> Chart {
        let states = in_words(&self.states, &self.given.scene);
        let title = match self.other {
            None => format!("{}: eigenvalues in state {states}", self.given.scene.name),
            Some(other) => {
                format!("{}: eigenvalues in state {states}, by {other}", self.given.scene.name)
            }
        };
        let label = |at: Option<f64>| Some(format!("{} = {}", self.other?, at?));
        let loci = self.members.iter().map(|member| (label(member.at), &member.locus));
        locus_chart(title, axis(&self.given.scene, self.name), &loci.collect::<Vec<_>>())
    }
}

/// Values of a parameter at which every contact slides, with a note on the others if there are any.
fn sliding_values(
    scene: &Scene,
    name: &str,
    values: &[f64],
) -> Result<(Vec<f64>, Option<String>), Failure> {
    let mut kept = Vec::new();
    let mut first: Option<(f64, Vec<ContactState>)> = None;
    for &value in values {
        let Ok(states) = Linearised::of(&with(scene, name, value)?).uniform_sliding() else {
            continue;
        };
        let turns = |before: &[ContactState]| {
            let both = before.iter().zip(&states);
            both.filter(|(a, b)| ![**a, **b].contains(&ContactState::Detached)).any(|(a, b)| a != b)
        };
        match &first {
            Some((from, before)) if turns(before) => {
                return Err(Failure::Usage(format!(
                    "uniform sliding is {} at {name} = {from} and {} at {value}: give a range in which no surface \
                     turns, or name a contact state with --state",
                    in_words(before, scene),
                    in_words(&states, scene)
                )));
            }
            Some(_) => {}
            None => first = Some((value, states)),
        }
        kept.push(value);
    }
    let missing: Vec<String> =
        values.iter().filter(|value| !kept.contains(value)).map(f64::to_string).collect();
    if kept.len() < 2 {
        // The reason is the same for all values.
        let reason = Linearised::of(&with(scene, name, values[0])?).uniform_sliding();
        reason?;
        return Err(Failure::Usage(format!(
            "fewer than two values of {name} leave every contact sliding"
        )));
    }
    let note = (!missing.is_empty()).then(|| {
        format!("{name} = {} is left out: a surface stands still there", missing.join(", "))
    });
    Ok((kept, note))
}

/// Prints the ranges in which uniform sliding has an equilibrium, unless it has one everywhere.
fn print_equilibrium(
    ranges: &[[f64; 2]],
    [first, last]: [f64; 2],
    out: &mut dyn Write,
) -> Result<(), Failure> {
    if ranges.is_empty() {
        writeln!(out, "  note: uniform sliding has no equilibrium anywhere in this range")?;
    }
    if !ranges.is_empty() && ranges != [[first, last]] {
        let range = |range: &[f64; 2]| {
            let [from, to] = range.map(|value| significant(value, LOCATED));
            format!("from {from} to {to}")
        };
        let ranges: Vec<String> = ranges.iter().map(range).collect();
        let ranges = ranges.join(" and ");
        writeln!(out, "  note: uniform sliding has an equilibrium {ranges} only")?;
    }
    Ok(())
}

fn print_events(locus: &Locus, out: &mut dyn Write) -> Result<(), Failure> {
    if locus.is_damped {
        writeln!(
            out,
            "  single dampers or falling friction prevent modes from merging exactly; closest approaches:"
        )?;
    } else {
        writeln!(
            out,
            "  modes merge or part exactly, also with proportional damping (C = α M + β K):"
        )?;
    }
    for event in &locus.approaches {
        let [a, b] = event.modes.map(|mode| mode + 1);
        writeln!(
            out,
            "    {}  modes {a} and {b} are {} Hz apart {}",
            significant(event.value, 6),
            significant(event.distance_hz, 4),
            at_frequency(event.frequency_hz),
        )?;
    }
    for event in &locus.coalescences {
        let [a, b] = event.modes.map(|mode| mode + 1);
        writeln!(
            out,
            "    {}  modes {a} and {b} {} {}",
            significant(event.value, LOCATED),
            if event.merge { "merge" } else { "part" },
            at_frequency(event.frequency_hz),
        )?;
    }
    if locus.coalescences.is_empty() && locus.approaches.is_empty() {
        writeln!(out, "    none")?;
    }
    writeln!(out, "  critical values:")?;
    for event in &locus.crossings {
        writeln!(out, "    {}  {}", significant(event.value, LOCATED), turn(event))?;
    }
    if locus.crossings.is_empty() {
        let points = || locus.followed().flat_map(|(_, branch)| branch.iter().copied());
        let grows = points().any(|root| locus.contains(root) && locus.grows(root));
        let is_bounded = locus.frequencies != ALL_FREQUENCIES;
        let found = match (grows, is_bounded) {
            (true, false) => "a mode grows everywhere",
            (false, false) => "no mode grows",
            (true, true) => "a mode grows wherever its frequency is in the range",
            (false, true) => "no mode grows while its frequency is in the range",
        };
        writeln!(out, "    none found: {found}")?;
    }
    for value in &locus.undecided {
        let value = significant(*value, LOCATED);
        writeln!(out, "  note: the numbering of modes may have changed at {value}")?;
    }
    Ok(())
}
