//! `amontons-stability bistable`.

use crate::arguments::Bistable;
use crate::{configured, progress};
use amontons::Error;
use amontons::contact::Joined;
use amontons::model::{LumpedModel, equilibrium};
use amontons::stability::candidates::{bistability, uniform_sliding};
use amontons::stability::{MAX_CONTACTS, StateClasses};

/// Intervals of the range; modes are followed through them, onsets found by bisection inside.
const INTERVALS: u32 = 200;

pub fn run(arguments: &Bistable) -> Result<(), Error> {
    let [first, last] = arguments.friction;
    let scene = configured(&arguments.common, Some(first))?;
    let model = LumpedModel::from(&scene);
    equilibrium(&scene, &model)?;
    let values: Vec<f64> = (0..=INTERVALS)
        .map(|i| first + (last - first) * (f64::from(i) / f64::from(INTERVALS)))
        .collect();
    let classes = StateClasses::of(&model)?.representatives.len();
    debug_assert!(model.contacts.len() <= MAX_CONTACTS);
    let bar = progress(classes);
    let velocity = scene.slider.velocity;
    let found = bistability(&model, velocity, &values, &|done| bar.set_position(done as u64))?;
    bar.finish_and_clear();

    let sliding = uniform_sliding(&model, velocity);
    println!("{}: µ from {first} to {last}\n", scene.name);
    println!("Uniform sliding ({})", Joined(&sliding));
    if found.uniform.is_empty() {
        let all = if found.stable.is_empty() { "grows" } else { "is stable" };
        println!("  {all} in the whole range");
    }
    for crossing in &found.uniform {
        println!(
            "  µ = {:.9}  mode {} ({:.2} Hz) {}",
            crossing.value,
            crossing.mode + 1,
            crossing.frequency_hz,
            if crossing.becomes_unstable { "begins to grow" } else { "ceases to grow" }
        );
    }
    println!(
        "\nCandidates: states that grow where uniform sliding does not (a transient confirms)"
    );
    if found.candidates.is_empty() {
        println!("  none");
        return Ok(());
    }
    println!(
        "  {:12} {:>6}  {:>27}  {:>13}  {:>27}",
        "state", "alike", "range of µ", "onset at [Hz]", "at the end [Hz], [1/s]"
    );
    for candidate in &found.candidates {
        println!(
            "  {:12} {:>6}  {}{:.9} … {:.9}  {:>13.2}  {:>13.2} {:>+13.4}",
            Joined(&candidate.states).to_string(),
            candidate.alike,
            if candidate.begins { "   " } else { "  <" },
            candidate.range[0],
            candidate.range[1],
            candidate.frequency_hz,
            candidate.at_end[0],
            candidate.at_end[1],
        );
    }
    println!("\n< grows already where the range of stable sliding begins");
    Ok(())
}
