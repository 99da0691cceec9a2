//! `amontons-stability bistable`.

use crate::arguments::Bistable;
use crate::labels::{LOCATED, significant, turn};
use crate::{Failure, configured, require_constant_friction};
use amontons::contact::Joined;
use amontons::model::LumpedModel;
use amontons::progress::Progress;
use amontons::stability::StateClasses;
use amontons::stability::candidates::{Bistability, Candidate, bistability, uniform_sliding};
use std::io::Write;

pub fn run(arguments: &Bistable, out: &mut dyn Write) -> Result<(), Failure> {
    let [first, last] = arguments.friction;
    let scene = configured(&arguments.common, Some(first))?;
    require_constant_friction(&scene)?;
    let model = LumpedModel::from(&scene);
    let bar =
        Progress::new("the contact states", StateClasses::of(&model)?.representatives.len() as u64);
    let found = bistability(&scene, [first, last], &|done| bar.set(done as u64))?;
    bar.finish();

    let sliding = uniform_sliding(&model, scene.slider.velocity)?;
    writeln!(out, "{}: µ from {first} to {last}\n", scene.name)?;
    writeln!(out, "Uniform sliding ({})", Joined(&sliding))?;
    print_uniform(&found, [first, last], out)?;
    print_candidates(&found.candidates, out)
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

fn print_candidates(candidates: &[Candidate], out: &mut dyn Write) -> Result<(), Failure> {
    writeln!(
        out,
        "\nCandidates: states that grow where uniform sliding does not (a transient confirms)"
    )?;
    if candidates.is_empty() {
        writeln!(out, "  none")?;
        return Ok(());
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
    Ok(())
}
