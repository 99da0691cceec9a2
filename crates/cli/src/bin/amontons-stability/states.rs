//! `amontons-stability states`.

use crate::arguments::States;
use crate::{AnalysedScene, Failure, configured, friction, state};
use amontons::Error;
use amontons::contact::{ContactState, JoinedStates};
use amontons::model::{Equilibrium, LinearModel};
use amontons::scene::Scene;
use amontons::stability::Spectrum;
use amontons_analysis::patterns::{self, Pattern, in_words, told_apart};
use amontons_analysis::stability::candidates::closed_at_rest;
use amontons_analysis::stability::{
    Linearised, LinearityLimit, MAX_CONTACTS, StateClasses, linearity_limit, modes, spectra_of,
};
use amontons_analysis::watch::Watch;
use amontons_cli::arguments::Format;
use amontons_cli::progress::Progress;
use serde_json::{Map, Value, json};
use std::f64::consts::TAU;
use std::io::Write;

/// Limit of the number of contacts for which departures are printed; each mode needs the forces of all contacts.
const MAX_LEAVING: usize = 32;

/// A contact state and the results for it.
struct Row {
    states: Vec<ContactState>,
    spectrum: Spectrum,
    has_equilibrium: bool,
    /// Number of states that symmetry makes equal to this one if it is the first of them; else zero.
    alike: usize,
    /// The stays of a run in these states; `None` if the states are not those of a run.
    stays: Option<Pattern>,
}

/// The results to be printed.
struct StatesReport {
    given: AnalysedScene,
    rows: Vec<Row>,
    /// The state of all contacts at rest.
    resting: Vec<ContactState>,
    equilibrium: Result<Equilibrium, Error>,
    /// Departures, or the reason why there are none.
    departures: Result<Vec<(ModeLimit, Option<LinearityLimit>)>, String>,
}

/// A mode of uniform sliding whose departure is printed.
struct ModeLimit {
    frequency_hz: f64,
    growth_rate: f64,
    /// |λ|, 1/s.
    rate: f64,
}

pub fn run(arguments: &States, out: &mut dyn Write) -> Result<(), Failure> {
    let given = configured(&arguments.common, arguments.point.friction, &[])?;
    let scene = &given.scene;
    let here = Linearised::of(scene);
    if let Err(error) = here.equilibrium() {
        eprintln!("note: {error}");
    }
    let equilibrium_states = here.equilibrium_states();
    let has_equilibrium = |states: &[ContactState]| equilibrium_states.as_deref() == Ok(states);
    let rows: Vec<Row> = match &arguments.patterns {
        Some(path) => {
            let mut run = patterns::read(path, scene)?;
            if run.len() > arguments.first {
                eprintln!(
                    "note: the first {} of {} contact states; --first gives another number",
                    arguments.first,
                    run.len()
                );
                run.truncate(arguments.first);
            }
            let model = here.linear()?;
            let states: Vec<&[ContactState]> = run.iter().map(|it| &*it.visit.states).collect();
            let spectra = spectra_shown(&states, model)?;
            let rows = run.into_iter().zip(spectra).map(|(stays, spectrum)| {
                let states = stays.visit.states.clone();
                let has_equilibrium = has_equilibrium(&states);
                Row { has_equilibrium, states, spectrum, alike: 1, stays: Some(stays) }
            });
            rows.collect()
        }
        None => {
            let found = spectra(arguments.point.state.as_deref(), scene, &here)?;
            let rows = found.into_iter().map(|(states, spectrum, alike)| Row {
                has_equilibrium: has_equilibrium(&states),
                states,
                spectrum,
                alike,
                stays: None,
            });
            rows.collect()
        }
    };
    let report = StatesReport {
        rows,
        departures: match scene.contact_count() {
            0..=MAX_LEAVING => departures(&here).map_err(|error| error.to_string()),
            _ => Err(format!("they are computed for up to {MAX_LEAVING} contacts")),
        },
        equilibrium: here.equilibrium().cloned(),
        resting: equilibrium_states.unwrap_or_else(|_| here.resting_state()),
        given,
    };
    match arguments.format {
        Format::Json => writeln!(out, "{:#}", report.as_json())?,
        Format::Csv => report.print_csv(out)?,
        Format::Table => report.print_table(out)?,
    }
    Ok(())
}

/// The states asked for, one or all, with their spectra and the number of equal states ([`Row::alike`]).
fn spectra(
    name: Option<&str>,
    scene: &Scene,
    here: &Linearised,
) -> Result<Vec<(Vec<ContactState>, Spectrum, usize)>, Error> {
    let model = here.linear()?;
    let contacts = here.model().contacts.len();
    if name.is_some() || contacts > MAX_CONTACTS {
        let states = state(name, scene, here)?;
        let mut all = vec![states];
        if name.is_none() {
            // The equilibrium's state goes after sliding with all contacts closed, where it is another one.
            let sliding = closed_at_rest(here.model());
            if sliding != all[0] {
                all.insert(0, sliding);
            }
            let also = if all.len() > 1 { " and the equilibrium's state" } else { "" };
            eprintln!(
                "note: {contacts} contacts: only uniform sliding{also} is examined; name other states with --state or take those of a run \
                 with --patterns"
            );
        }
        let spectra = spectra_shown(&all, model)?;
        return Ok(all
            .into_iter()
            .zip(spectra)
            .map(|(states, found)| (states, found, 1))
            .collect());
    }
    let classes = StateClasses::of(here.model())?;
    let spectra = spectra_shown(&classes.representatives, model)?;
    eprintln!("{} states, {} solved", classes.states.len(), spectra.len());
    let found = classes.states.iter().map(|(states, class)| {
        let (states, class) = (states.clone(), *class);
        let is_first = states == classes.representatives[class];
        let alike = if is_first { classes.members(class).count() } else { 0 };
        (states, spectra[class].clone(), alike)
    });
    Ok(found.collect())
}

/// The spectrum of each pattern, with progress on the terminal.
fn spectra_shown(
    patterns: &[impl AsRef<[ContactState]> + Sync],
    model: LinearModel<'_>,
) -> Result<Vec<Spectrum>, Error> {
    let bar = Progress::in_parts("the contact states");
    let watch = Watch { progress: &|part| bar.set_part(part), ..Watch::IDLE };
    let found = spectra_of(patterns, model, watch);
    bar.finish();
    found
}

/// The departure of each mode of uniform sliding: where it makes a contact leave its state, so that the linear model no
/// longer holds.
fn departures(here: &Linearised) -> Result<Vec<(ModeLimit, Option<LinearityLimit>)>, Error> {
    let model = here.linear()?;
    let sliding = here.uniform_sliding()?;
    let equilibrium = here.equilibrium()?;
    let found = modes(model, &sliding)?;
    let leaving = found.all().map(|mode| {
        let leaving = ModeLimit {
            frequency_hz: mode.frequency_hz(),
            growth_rate: mode.growth_rate(),
            rate: mode.eigenvalue.norm(),
        };
        (leaving, linearity_limit(model, equilibrium, mode))
    });
    Ok(leaving.collect())
}

impl StatesReport {
    fn as_json(&self) -> Value {
        let states: Map<String, Value> = self
            .rows
            .iter()
            .map(|Row { states, spectrum, has_equilibrium, stays, .. }| {
                let oscillating = spectrum.oscillating.iter().map(|v| [v.re / TAU, v.im / TAU]);
                let mut value = json!({
                    "eigenvalues_hz": oscillating.collect::<Vec<_>>(),
                    "real_hz": spectrum.real.iter().map(|v| v / TAU).collect::<Vec<_>>(),
                    "unstable": spectrum.unstable(),
                    "has_equilibrium": has_equilibrium,
                });
                if let Some(Pattern { share, visit }) = stays {
                    value["share"] = json!(share);
                    value["time"] = json!(visit.time);
                    value["entered"] = json!(visit.entered);
                }
                (JoinedStates(states).to_string(), value)
            })
            .collect();
        let names = self.given.scene.dof_names();
        let departures = self.departures.iter().flatten().filter_map(|(mode, limit)| {
            let limit = limit.as_ref()?;
            Some(json!({
                "frequency_hz": mode.frequency_hz,
                "growth_rate": mode.growth_rate,
                "amplitude": limit.amplitude,
                "of": names[limit.dof],
                "speed": limit.amplitude * mode.rate,
                "contact": self.given.scene.contact_name(limit.contact),
                "into": limit.into.to_string(),
            }))
        });
        json!({
            "scene": self.given.scene.name,
            "friction": self.given.scene.has_common_friction().then_some(self.given.scene.friction_coefficient),
            "states": states,
            "departures": departures.collect::<Vec<_>>(),
            "at": self.given.at,
            "left_out": self.given.left_out,
            "equilibrium_error": self.equilibrium.as_ref().err().map(Error::to_string),
        })
    }

    fn print_csv(&self, out: &mut dyn Write) -> Result<(), Failure> {
        writeln!(out, "state,kind,real_hz,imaginary_hz,growth_rate,unstable")?;
        for row in &self.rows {
            let name = JoinedStates(&row.states);
            for v in &row.spectrum.oscillating {
                let (re, im) = (v.re / TAU, v.im / TAU);
                writeln!(out, "{name},oscillating,{re:?},{im:?},{:?},{}", v.re, v.re > 0.0)?;
            }
            for v in &row.spectrum.real {
                writeln!(out, "{name},real,{:?},0.0,{v:?},{}", v / TAU, *v > 0.0)?;
            }
        }
        Ok(())
    }

    fn print_table(&self, out: &mut dyn Write) -> Result<(), Failure> {
        let (name, friction) = (&self.given.scene.name, friction(&self.given.scene));
        writeln!(out, "{name}: eigenvalues / 2π [Hz] at {friction}; * grows")?;
        writeln!(out, "{}", self.given.head())?;
        let is_of_run = self.rows.iter().any(|row| row.stays.is_some());
        if self.rows.len() == 16 && self.given.scene.network().is_none() && !is_of_run {
            print_paper_table(&self.rows, out)?;
        } else {
            print_list(&self.rows, &self.given.scene, out)?;
        }
        if self.equilibrium.is_ok() {
            let is_shown = self.rows.iter().any(|row| row.has_equilibrium);
            let note = if is_shown { "" } else { ", which is not among the states above" };
            writeln!(out, "Equilibrium: {}{note}\n", in_words(&self.resting, &self.given.scene))?;
        }
        self.print_departures(out)
    }

    fn print_departures(&self, out: &mut dyn Write) -> Result<(), Failure> {
        let departures = match &self.departures {
            Ok(departures) => departures,
            Err(error) => {
                writeln!(out, "Departures from uniform sliding are unknown: {error}")?;
                return Ok(());
            }
        };
        writeln!(
            out,
            "Departures from uniform sliding: largest amplitude of each mode before a contact stops sliding"
        )?;
        let names = self.given.scene.dof_names();
        for (ModeLimit { frequency_hz, rate, .. }, limit) in departures {
            let frequency = match frequency_hz {
                0.0 => "real".to_owned(),
                frequency_hz => format!("{frequency_hz:.2} Hz"),
            };
            let Some(LinearityLimit { contact, into, amplitude, dof }) = limit else {
                writeln!(out, "  {frequency:>11}  stops no contact from sliding")?;
                continue;
            };
            writeln!(
                out,
                "  {frequency:>11}  {amplitude:.3e} m of {} ({:.3e} m/s): {} into {into}",
                names[*dof],
                amplitude * rate,
                self.given.scene.contact_name(*contact),
            )?;
        }
        Ok(())
    }
}

/// Eigenvalues of a state in the format of the paper.
fn cells(spectrum: &Spectrum) -> Vec<String> {
    let mark = |growth: f64| if growth > 0.0 { '*' } else { ' ' };
    let oscillating = spectrum
        .oscillating
        .iter()
        .map(|v| format!("{}{} ± {:.2}i", mark(v.re), rate(v.re / TAU), v.im / TAU));
    let real = spectrum.real.iter().map(|v| format!("{}{} (real)", mark(*v), rate(v / TAU)));
    oscillating.chain(real).collect()
}

/// A rate in Hz; small values have digits of their own.
fn rate(hz: f64) -> String {
    if hz == 0.0 || hz.abs() >= 0.005 { format!("{hz:.2}") } else { format!("{hz:.1e}") }
}

/// Prints the table for two contacts: module 1 across, module 2 down, as in Tables 2 and 3.
fn print_paper_table(rows: &[Row], out: &mut dyn Write) -> Result<(), Failure> {
    const WIDTH: usize = 22;
    let cell = |first: ContactState, second: ContactState| {
        let row = rows.iter().find(|row| row.states == [first, second]).expect("all states");
        cells(&row.spectrum)
    };
    write!(out, "{:9}", "Module 1")?;
    for first in ContactState::ALL {
        write!(out, "{:>WIDTH$}", first.to_string())?;
    }
    writeln!(out, "\nModule 2")?;
    for second in ContactState::ALL {
        let columns = ContactState::ALL.map(|first| cell(first, second));
        let lines = columns.iter().map(Vec::len).max().unwrap_or(0);
        for line in 0..lines {
            let name = if line == 0 { second.to_string() } else { String::new() };
            write!(out, "{name:9}")?;
            for column in &columns {
                write!(out, "{:>WIDTH$}", column.get(line).map_or("-", |cell| cell))?;
            }
            writeln!(out)?;
        }
        writeln!(out)?;
    }
    Ok(())
}

/// Prints the states that symmetry does not make equal to an earlier one.
fn print_list(rows: &[Row], scene: &Scene, out: &mut dyn Write) -> Result<(), Failure> {
    let shown: Vec<&Row> = rows.iter().filter(|row| row.alike > 0).collect();
    let states: Vec<&[ContactState]> = shown.iter().map(|row| &*row.states).collect();
    for (row, states) in shown.iter().zip(told_apart(&states, scene)) {
        let note = if row.alike > 1 { format!(" ({} alike)", row.alike) } else { String::new() };
        let stays = row.stays.as_ref().map_or_else(String::new, |Pattern { share, visit }| {
            let percent = 100.0 * share;
            let stays = if visit.entered == 1 { "stay" } else { "stays" };
            format!(": {percent:.2} % of the time in {} {stays}", visit.entered)
        });
        writeln!(out, "{states}{note}{stays}")?;
        for cell in cells(&row.spectrum) {
            writeln!(out, "  {cell}")?;
        }
    }
    writeln!(out)?;
    Ok(())
}
