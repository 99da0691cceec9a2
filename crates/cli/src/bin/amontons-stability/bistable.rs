//! `amontons-stability bistable`.

use crate::arguments::Bistable;
use crate::labels::{LOCATED, significant, turn};
use crate::{Failure, configured};
use amontons::contact::JoinedStates;
use amontons::scene::Scene;
use amontons_analysis::stability::candidates::{Bistability, Candidate, bistability};
use amontons_analysis::stability::{Linearised, StateEnergy};
use amontons_analysis::study::Watch;
use amontons_analysis::study::confirm::{Attempt, Tried, confirm};
use amontons_analysis::sweep::FRICTION;
use amontons_cli::progress::Progress;
use std::io::Write;

pub fn run(arguments: &Bistable, out: &mut dyn Write) -> Result<(), Failure> {
    let [first, last] = arguments.friction;
    let given = configured(&arguments.common, Some(first), &[FRICTION])?;
    let scene = &given.scene;
    let here = Linearised::of(scene);
    let bar = Progress::in_parts("the contact states");
    let found = bistability(
        scene,
        [first, last],
        Watch { progress: &|part| bar.set_part(part), ..Watch::IDLE },
    )?;
    bar.finish();

    let sliding = here.uniform_sliding()?;
    writeln!(out, "{}: µ from {first} to {last}", scene.name)?;
    if found.range[1] < last {
        let greatest = found.range[1];
        let note = format!(
            "friction.coefficient above {greatest} is left out: there static friction would be below \
             kinetic friction"
        );
        eprintln!("note: {note}");
        writeln!(out, "{note}")?;
    }
    writeln!(out, "{}", given.head())?;
    writeln!(out, "Uniform sliding ({})", JoinedStates(&sliding))?;
    print_uniform(&found, found.range, out)?;
    print_candidates(&found.candidates, found.widest, out)?;
    if arguments.confirm {
        confirm_candidates(scene, &found.candidates, out)?;
    }
    Ok(())
}

fn print_uniform(
    found: &Bistability,
    [first, last]: [f64; 2],
    out: &mut dyn Write,
) -> Result<(), Failure> {
    for [from, to] in &found.equilibrium {
        if *from > first || *to < last {
            let [from, to] = [from, to].map(|mu| significant(*mu, LOCATED));
            writeln!(out, "  has an equilibrium from µ = {from} to {to} only")?;
        }
    }
    if let Some((mu, states)) = &found.other {
        let (mu, states) = (significant(*mu, LOCATED), JoinedStates(states));
        writeln!(
            out,
            "  has an equilibrium with other contacts closed ({states}) at µ = {mu}, which is left out"
        )?;
    }
    if found.uniform.is_empty() {
        let all = if found.stable.is_empty() {
            "grows"
        } else if found.stable == found.equilibrium {
            "is stable"
        } else {
            "grows in some ranges and is stable in others,"
        };
        writeln!(out, "  {all} wherever it has an equilibrium")?;
    }
    for crossing in &found.uniform {
        writeln!(out, "  µ = {}  {}", significant(crossing.value, LOCATED), turn(crossing))?;
    }
    let is_everywhere = found.stable == found.equilibrium || found.uniform.is_empty();
    for [from, to] in found.stable.iter().filter(|_| !is_everywhere) {
        let [from, to] = [from, to].map(|mu| significant(*mu, LOCATED));
        writeln!(out, "  is stable from µ = {from} to {to}")?;
    }
    if found.stable.is_empty() && !found.uniform.is_empty() {
        writeln!(out, "  is stable nowhere: another mode grows")?;
    }
    Ok(())
}

fn print_candidates(
    candidates: &[Candidate],
    widest: f64,
    out: &mut dyn Write,
) -> Result<(), Failure> {
    writeln!(
        out,
        "\nCandidates: contact states with a growing mode where uniform sliding is stable (--confirm tests them)"
    )?;
    if candidates.is_empty() {
        writeln!(
            out,
            "  none; a second motion may still exist, since stick-slip, for example, needs no contact state with a \
             growing mode; `amontons study continuation` looks for motions"
        )?;
        return print_width(widest, out);
    }
    writeln!(
        out,
        "  {:12} {:>6}  {:>27}  {:>13}  {:>27}  {:>10}  {:>10}",
        "state",
        "alike",
        "range of µ",
        "onset at [Hz]",
        "at the end [Hz], [1/s]",
        "needs [J]",
        "push [m/s]"
    )?;
    // A mode that does not oscillate diverges.
    let hz = |frequency: f64| match frequency {
        0.0 => "real".to_owned(),
        frequency => format!("{frequency:.2}"),
    };
    for candidate in candidates {
        let needs = |part: fn(&StateEnergy) -> f64| match &candidate.reach {
            Some(reach) => significant(part(reach), 3),
            None => "never".to_owned(),
        };
        writeln!(
            out,
            "  {:12} {:>6}  {:>3}{} … {}  {:>13}  {:>13} {:>+13.4}  {:>10}  {:>10}",
            JoinedStates(&candidate.states).to_string(),
            candidate.alike,
            if candidate.begins { "" } else { "<" },
            significant(candidate.range[0], LOCATED),
            significant(candidate.range[1], LOCATED),
            hz(candidate.frequency_hz),
            hz(candidate.at_end[0]),
            candidate.at_end[1],
            needs(|reach| reach.energy),
            needs(|reach| reach.push),
        )?;
    }
    if candidates.iter().any(|candidate| !candidate.begins) {
        writeln!(
            out,
            "\n< the state already grows at the lower end of the range of stable sliding"
        )?;
    }
    writeln!(
        out,
        "\n`needs` is an energy that ranks the states, the least first: with it, contacts that stick or reverse have \
         the velocities of their surfaces, and the normal force of each contact that opens falls to zero while the \
         others slide. `push` is the velocity of the heaviest degree of freedom with this energy. Neither is a \
         threshold: friction feeds smaller motions until they are as large, and an impact that lifts a mass off opens \
         its contact with less energy"
    )?;
    print_width(widest, out)
}

/// Limit of the number of candidates that are confirmed: each takes fifteen runs, or more where small pushes may
/// suffice.
const MOST_CONFIRMED: usize = 20;

fn confirm_candidates(
    scene: &Scene,
    candidates: &[Candidate],
    out: &mut dyn Write,
) -> Result<(), Failure> {
    let all: Vec<&Candidate> =
        candidates.iter().filter(|candidate| candidate.reach.is_some()).collect();
    if all.is_empty() {
        writeln!(
            out,
            "\nNothing to confirm: no candidate can be reached by a push; a second motion may still exist, and \
             `amontons study continuation` looks for it"
        )?;
        return Ok(());
    }
    let first = &all[..all.len().min(MOST_CONFIRMED)];
    let bar = Progress::in_parts("pushing the scene");
    let watch = Watch { progress: &|part| bar.set_part(part), ..Watch::IDLE };
    let tried = confirm(scene, first, watch)?.unwrap_or_default();
    bar.finish();
    writeln!(
        out,
        "\nConfirmation by pushes from the equilibrium along the mode of each candidate"
    )?;
    for (candidate, tried) in first.iter().zip(&tried) {
        let (states, hz) = (JoinedStates(&candidate.states), candidate.frequency_hz);
        write!(out, "  {states} ({hz:.2} Hz): ")?;
        match &tried.met {
            Some(Attempt { friction, push, ending: Ok(ending), .. }) => writeln!(
                out,
                "confirmed at µ = {} by a push of {} m/s: {}, {:.4e} of {}{}",
                significant(*friction, 6),
                significant(*push, 3),
                ending.kind.name(),
                ending.amplitude,
                tried.of,
                ending.frequency.map_or_else(String::new, |hz| format!(" at {hz:.2} Hz")),
            )?,
            _ => print_not_met(tried, out)?,
        }
    }
    if first.len() < all.len() {
        writeln!(
            out,
            "  the other {} were not tried: these {MOST_CONFIRMED} need the least energy; a narrower --friction has \
             fewer candidates",
            all.len() - first.len()
        )?;
    }
    Ok(())
}

/// Prints the attempts to confirm a candidate without success.
fn print_not_met(tried: &Tried, out: &mut dyn Write) -> Result<(), Failure> {
    let list = |value: fn(&Attempt) -> f64, digits: usize| {
        let mut all: Vec<f64> = tried.attempts.iter().map(value).collect();
        all.sort_by(f64::total_cmp);
        all.dedup();
        all.iter().map(|value| significant(*value, digits)).collect::<Vec<_>>().join(", ")
    };
    let [rested, other, unsettled, failed] = tried.count();
    let second =
        tried.attempts.iter().find(|attempt| attempt.moves()).map_or_else(String::new, |attempt| {
            format!(
                "; a second motion still exists: a push of {} m/s at µ = {} leads to it",
                significant(attempt.push, 3),
                significant(attempt.friction, 6)
            )
        });
    writeln!(
        out,
        "not confirmed by pushes of {} m/s at µ = {}, each run until the motion had settled or for {} s; {rested} \
         came to rest, {other} ended in a motion that does not have all of these states at the same time, {unsettled} \
         had not settled, {failed} failed{second}",
        list(|attempt| attempt.push, 3),
        list(|attempt| attempt.friction, 4),
        tried.longest,
    )?;
    Ok(())
}

/// Prints the spacing in µ at which each contact state was examined.
fn print_width(widest: f64, out: &mut dyn Write) -> Result<(), Failure> {
    if widest > 0.0 {
        let widest = significant(widest, 2);
        writeln!(
            out,
            "\nEach state was examined in steps of µ up to {widest}: a mode that grows only within a smaller range, \
             without coming near another mode, may be missed; a narrower --friction takes smaller steps"
        )?;
    }
    Ok(())
}
