//! `amontons-stability bistable`.

use crate::arguments::Bistable;
use crate::labels::{LOCATED, significant, turn};
use crate::{Failure, configured};
use amontons::contact::Joined;
use amontons::progress::Progress;
use amontons::stability::candidates::{Bistability, Candidate, bistability};
use amontons::stability::{Linearised, StateClasses};
use amontons::sweep::FRICTION;
use std::io::Write;

pub fn run(arguments: &Bistable, out: &mut dyn Write) -> Result<(), Failure> {
    let [first, last] = arguments.friction;
    let given = configured(&arguments.common, Some(first), &[FRICTION])?;
    let scene = &given.scene;
    let here = Linearised::of(scene);
    let classes = StateClasses::of(here.model())?.representatives.len() as u64;
    let bar = Progress::new("the contact states", classes);
    let found = bistability(scene, [first, last], &|done| bar.set(done as u64))?;
    bar.finish();

    let sliding = here.uniform_sliding()?;
    writeln!(out, "{}: µ from {first} to {last}", scene.name)?;
    if found.range[1] < last {
        let greatest = found.range[1];
        let note = format!(
            "friction.coefficient from {greatest} to {last} is left out: there static friction would be below \
             kinetic friction"
        );
        eprintln!("note: {note}");
        writeln!(out, "{note}")?;
    }
    writeln!(out, "{}", given.head())?;
    writeln!(out, "Uniform sliding ({})", Joined(&sliding))?;
    print_uniform(&found, found.range, out)?;
    print_candidates(&found.candidates, found.widest, out)
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
    Ok(())
}

fn print_candidates(
    candidates: &[Candidate],
    widest: f64,
    out: &mut dyn Write,
) -> Result<(), Failure> {
    writeln!(
        out,
        "\nCandidates: states that grow where uniform sliding does not (a transient confirms)"
    )?;
    if candidates.is_empty() {
        writeln!(out, "  none")?;
        return print_width(widest, out);
    }
    writeln!(
        out,
        "  {:12} {:>6}  {:>27}  {:>13}  {:>27}",
        "state", "alike", "range of µ", "onset at [Hz]", "at the end [Hz], [1/s]"
    )?;
    // A mode that does not oscillate diverges.
    let hz = |frequency: f64| match frequency {
        0.0 => "real".to_owned(),
        frequency => format!("{frequency:.2}"),
    };
    for candidate in candidates {
        writeln!(
            out,
            "  {:12} {:>6}  {:>3}{} … {}  {:>13}  {:>13} {:>+13.4}",
            Joined(&candidate.states).to_string(),
            candidate.alike,
            if candidate.begins { "" } else { "<" },
            significant(candidate.range[0], LOCATED),
            significant(candidate.range[1], LOCATED),
            hz(candidate.frequency_hz),
            hz(candidate.at_end[0]),
            candidate.at_end[1],
        )?;
    }
    if candidates.iter().any(|candidate| !candidate.begins) {
        writeln!(out, "\n< grows already where the range of stable sliding begins")?;
    }
    print_width(widest, out)
}

/// Says how closely the states were looked at.
fn print_width(widest: f64, out: &mut dyn Write) -> Result<(), Failure> {
    if widest > 0.0 {
        let widest = significant(widest, 2);
        writeln!(
            out,
            "\nEach state was looked at every {widest} of µ: a mode that grows over less may be missed; a \
             narrower --friction looks closer"
        )?;
    }
    Ok(())
}
