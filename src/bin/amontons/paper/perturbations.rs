//! Section 4: Fig. 5.

use super::claims::claim;
use super::scene;
use crate::study::perturbation::{endings, histories, thinned};
use amontons::Error;
use amontons::picture::{Chart, Panel, Series};
use amontons::report::{Claim, Content, Figure, Section};
use amontons::scene::Scene;
use amontons::study::perturbation::{Direction, Perturbations, perturbation};
use amontons::study::{Journal, Look, Watch, history};

/// Initial velocities of the upper mass of module 1, vertical, m/s.
const FIRST: f64 = 1e-4;
const LAST: f64 = 0.3;
const COUNT: u32 = 31;
/// Of what is shown, s.
const DURATION: f64 = 2.0;

pub fn section(watch: Watch<'_>) -> Result<Option<Section>, Error> {
    let (scene, look) = scene("set2", &[])?;
    let at = |i: u32| FIRST + (LAST - FIRST) * f64::from(i) / f64::from(COUNT - 1);
    let direction = Direction {
        name: "initial.module[1].v2".to_owned(),
        amplitudes: (0..COUNT).map(at).collect(),
        resolution: 1e-4,
    };
    let found = perturbation(&scene, &direction, &look, &Journal::forgotten(), watch)?;
    let Some(found) = found else { return Ok(None) };
    let mut section = Section { claims: claims(&found), ..Section::default() };
    let is_over = || (watch.go_on)().is_break();
    let Some(small_and_large) = histories_of(&scene, &direction, &look, &is_over)? else {
        return Ok(None);
    };
    section.figures.push(small_and_large);
    if let Some(threshold) = found.thresholds.first() {
        let chart = histories(&scene, &direction, &look, (&found, threshold), &is_over)?;
        let Some(chart) = chart else { return Ok(None) };
        section.figures.push(Figure {
            caption: "Beside Fig. 5: Set 2 at µ = 1.96 after two perturbations that nearly agree: one decays, one reaches the \
                      limit cycle"
                .to_owned(),
            command: Some(format!(
                "amontons study perturbation set2 --direction '{}' --amplitude {FIRST}:{LAST}/{COUNT} --resolution 1e-4",
                direction.name
            )),
            content: Content::Chart(chart),
        });
    }
    section.figures.push(Figure {
        caption:
            "What Set 2 at µ = 1.96 ends in over the initial velocity of the upper mass of module 1"
                .to_owned(),
        command: None,
        content: Content::Chart(endings(&scene, &direction, &look, &found)),
    });
    Ok(Some(section))
}

/// Fig. 5: the first two seconds after the smallest and after the largest perturbation.
fn histories_of(
    scene: &Scene,
    direction: &Direction,
    look: &Look,
    is_over: &dyn Fn() -> bool,
) -> Result<Option<Figure>, Error> {
    let mut panels = Vec::new();
    for (colour, amplitude) in [FIRST, LAST].into_iter().enumerate() {
        let rows = history(scene, (&direction.name, amplitude), look, DURATION, is_over)?;
        let Some(rows) = rows else { return Ok(None) };
        panels.push(Panel {
            y_label: format!("{} [m]", look.of),
            series: vec![Series {
                label: Some(format!("from {amplitude} m/s")),
                points: thinned(&rows, look.interval),
                colour,
                ..Series::default()
            }],
            zero_line: true,
            ..Panel::default()
        });
    }
    Ok(Some(Figure {
        caption:
            "Fig. 5: Set 2 at µ = 1.96 after a small perturbation (a) and after a large one (b)"
                .to_owned(),
        command: Some("amontons simulate set2 --set 'initial.module[1].v2=1e-4'".to_owned()),
        content: Content::Chart(Chart {
            title: "set2: a small and a large perturbation".to_owned(),
            x_label: "Time [s]".to_owned(),
            panels,
            logarithmic: false,
        }),
    }))
}

fn claims(found: &Perturbations) -> Vec<Claim> {
    let settled = |run: Option<&amontons::study::perturbation::Run>| {
        run.and_then(|run| Some((run.amplitude, run.ending.clone()?)))
    };
    let (small, large) = (settled(found.runs.first()), settled(found.runs.last()));
    let thresholds: Vec<String> = found
        .thresholds
        .iter()
        .map(|threshold| format!("{:.6}", 0.5 * (threshold.between[0] + threshold.between[1])))
        .collect();
    let told = |run: &Option<(f64, amontons::study::Ending)>| {
        run.as_ref().map_or("the run failed".to_owned(), |(initial, ending)| {
            format!(
                "an initial velocity of {initial} m/s ends in: {}, ±{:.3e} m",
                ending.kind.name(),
                ending.amplitude
            )
        })
    };
    vec![
        claim(
            "At µ = 1.96 Set 2 returns to rest after a small perturbation (Fig. 5a).",
            told(&small),
            small.as_ref().is_some_and(|(_, ending)| ending.rests()),
            None,
        ),
        claim(
            "After a large one that makes a contact stick it reaches a stable orbit (Fig. 5b).",
            format!(
                "{}, with contacts that stick; thresholds: {} m/s",
                told(&large),
                thresholds.join(", ")
            ),
            large.is_some_and(|(_, ending)| ending.kind.is_cycle() && ending.taken[2]),
            None,
        ),
    ]
}
