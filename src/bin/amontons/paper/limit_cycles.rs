//! Section 2: Fig. 3.

use super::claims::{claim, is_about};
use super::scene;
use crate::study::limit_cycle::Told;
use amontons::Error;
use amontons::contact::ContactState;
use amontons::report::{Claim, Content, Figure, Section};
use amontons::study::{
    Change, Ending, Journal, LimitCycles, Outcome, Question, Watch, limit_cycles,
};

/// µ of the figure.
const FRICTION: f64 = 1.5;
/// Slider velocities whose orbits it shows, m/s.
const SHOWN: [f64; 3] = [0.05, 0.15, 0.25];
/// Velocities in steps of a hundredth of a metre per second, up to this many.
const LAST: i32 = 40;
/// Amplitudes that differ by less than this part are one: a motion settles to some 1e-3.
const SAME: f64 = 2e-3;

pub fn section(watch: Watch<'_>) -> Result<Option<Section>, Error> {
    let (scene, look) = scene("set1", &[("friction.coefficient", FRICTION)])?;
    let question = Question {
        name: "slider.velocity".to_owned(),
        values: (1..=LAST).map(|i| f64::from(i) / 100.0).collect(),
        resolution: 1e-3,
        portraits: Some(SHOWN.to_vec()),
        contacts: 2,
    };
    let found = limit_cycles(&scene, &look, &question, &Journal::forgotten(), watch)?;
    let Some(found) = found else { return Ok(None) };
    let told = Told { scene: &scene, look: &look, question: &question, found: &found };
    let command = format!(
        "amontons study limit-cycle set1 --set friction.coefficient={FRICTION} \
         --parameter slider.velocity=0.01:0.4:0.01 --portrait 0.05 --portrait 0.15 --portrait 0.25"
    );
    let mut figures = vec![Figure {
        caption: "Fig. 3(a): amplitude, frequency and contact states of the limit cycle of Set 1 at µ = 1.5 over the \
                  slider's velocity"
            .to_owned(),
        command: Some(command),
        content: Content::Chart(told.chart()),
    }];
    for portrait in &found.portraits {
        for (letter, direction) in [('b', "tangential"), ('c', "normal")] {
            figures.push(Figure {
                caption: format!(
                    "Fig. 3({letter}): {direction} motion of the masses in contact at v = {} m/s",
                    portrait.value
                ),
                command: None,
                content: Content::Chart(told.portrait(portrait, direction)),
            });
        }
    }
    Ok(Some(Section { claims: claims(&question, &found), figures, ..Section::default() }))
}

fn claims(question: &Question, found: &LimitCycles) -> Vec<Claim> {
    let ending = |velocity: f64| {
        let place = question.values.iter().position(|value| *value == velocity)?;
        found.outcomes[place].settled()
    };
    let states = |ending: Option<&Ending>| -> Vec<String> {
        let taken = |ending: &Ending| {
            let states = ContactState::ALL.iter().zip(ending.taken);
            states.filter(|(_, taken)| *taken).map(|(state, _)| state.to_string()).collect()
        };
        ending.map_or_else(Vec::new, taken)
    };
    let regime = |paper: &str, velocity: f64, expected: &[&str]| {
        let ending = ending(velocity);
        let shares = ending.map_or([f64::NAN; 4], |ending| ending.shares);
        let found = format!(
            "states taken: {}; of the time {:.1} % slip, {:.1} % stick, {:.1} % detached",
            states(ending).join(", "),
            100.0 * shares[0],
            100.0 * shares[2],
            100.0 * shares[3]
        );
        claim(paper, found, states(ending) == expected, None)
    };
    let at = |change: Change| {
        let threshold =
            found.thresholds.iter().find(|threshold| threshold.changes.contains(&change));
        threshold.map_or(f64::NAN, |threshold| 0.5 * (threshold.between[0] + threshold.between[1]))
    };
    let detaches = at(Change::Appears(ContactState::Detached));
    let slips = at(Change::Vanishes(ContactState::Stick));
    vec![
        regime(
            "At v = 0.05 m/s the masses stick and slip, and do not detach.",
            SHOWN[0],
            &["Sl", "St"],
        ),
        regime("At v = 0.15 m/s they stick, slip and detach.", SHOWN[1], &["Sl", "St", "Dt"]),
        regime("At v = 0.25 m/s they slip and detach, and do not stick.", SHOWN[2], &["Sl", "Dt"]),
        independent(question, found),
        claim(
            "The first slope of the amplitude changes, and detachment begins, at about 0.1 m/s.",
            format!("contacts detach from {detaches:.5} m/s on"),
            is_about(detaches, 0.1),
            Some(
                "the paper reads the value off a plot where the slope changes; the first short detachment comes \
                  before the slope tells",
            ),
        ),
        claim(
            "The second slope changes, and sticking ends, at about 0.2 m/s.",
            format!("contacts stick up to {slips:.5} m/s"),
            is_about(slips, 0.2),
            None,
        ),
    ]
}

/// Beyond sticking the motion does not depend on the velocity.
fn independent(question: &Question, found: &LimitCycles) -> Claim {
    let beyond =
        question.values.iter().zip(&found.outcomes).filter(|(value, _)| **value >= SHOWN[2]);
    let amplitudes: Vec<f64> = beyond
        .map(|(_, outcome)| match outcome {
            Outcome::Ending(ending) if outcome.settled().is_some() && !ending.taken[2] => {
                ending.amplitude
            }
            _ => f64::NAN,
        })
        .collect();
    let least = amplitudes.iter().copied().fold(f64::INFINITY, f64::min);
    let most = amplitudes.iter().copied().fold(0.0, f64::max);
    let spread =
        if amplitudes.iter().all(|a| a.is_finite()) { most / least - 1.0 } else { f64::NAN };
    claim(
        "Where nothing sticks the limit cycle does not depend on v.",
        format!(
            "from 0.25 to {} m/s amplitudes lie between {least:.5e} and {most:.5e} m (holds if they differ by less than \
             {SAME} of themselves, and nothing sticks)",
            f64::from(LAST) / 100.0
        ),
        spread <= SAME,
        None,
    )
}
