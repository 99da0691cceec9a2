//! Section 5: Figs. 6 and 7.

use super::claims::{claim, is_about};
use super::scene;
use crate::study::continuation::{chart, describe};
use amontons::Error;
use amontons::report::{Claim, Content, Figure, Section, Table};
use amontons::scene::{Method, Scene};
use amontons::stability::candidates::{Bistability, bistability};
use amontons::study::{Continuation, Journal, Jump, Look, Plan, Push, Watch, continuation};

/// µ of both figures: 1.5 to 2.5 in steps of 0.01.
const FRICTION: [i32; 2] = [150, 250];
/// Bounds of a jump, in µ.
const RESOLUTION: f64 = 1e-5;
/// The step of the paper's scheme with which jumps are found again, s.
const STEP: f64 = 2e-5;

pub fn section(watch: Watch<'_>) -> Result<Option<Section>, Error> {
    let mut section = Section {
        text: vec![
            "The paper's pseudo-continuation: each value of µ starts from the state in which the value before has \
             ended, with a small push; upwards and downwards. Where the motion jumps, the value is bisected. Falling \
             values are pushed too, which the paper does not do: else a cycle that has lost its stability is followed \
             for as long as rounding takes to grow."
                .to_owned(),
        ],
        ..Section::default()
    };
    for (place, (name, figure)) in [("set2", 6), ("set1", 7)].into_iter().enumerate() {
        let part = |part: f64| (watch.progress)(0.5 * (place as f64 + part));
        let watch = Watch { go_on: watch.go_on, progress: &part };
        let (scene, look) = scene(name, &[])?;
        let values: Vec<f64> = (FRICTION[0]..=FRICTION[1]).map(|i| f64::from(i) / 100.0).collect();
        let Some(found) = follow(&scene, &look, &values, watch)? else { return Ok(None) };
        let known = bistability(&scene, [values[0], values[values.len() - 1]], &|_| {})?;
        section.figures.push(Figure {
            caption: format!("Fig. {figure}: what {name} ends in over rising and falling µ"),
            command: Some(format!(
                "amontons study continuation {name} --friction 1.5:2.5:0.01 --resolution 1e-5"
            )),
            content: Content::Chart(chart(&scene, &look, &found, Some(&known))),
        });
        let claims =
            if name == "set2" { subcritical(&found, &known) } else { two_branches(&found) };
        section.claims.extend(claims);
        section.text.push(ranges(name, &found));
        let Some(table) = both_integrators(name, &scene, &look, &found, watch)? else {
            return Ok(None);
        };
        section.tables.push(table);
    }
    Ok(Some(section))
}

fn follow(
    scene: &Scene,
    look: &Look,
    values: &[f64],
    watch: Watch<'_>,
) -> Result<Option<Continuation>, Error> {
    let push = Push::of(scene);
    let plan = Plan { scene, look, values, resolution: RESOLUTION, push, ranges: &[] };
    continuation(&plan, &Journal::forgotten(), watch)
}

/// All ranges with two motions in words.
fn ranges(name: &str, found: &Continuation) -> String {
    let told = found.bistable.iter().map(|range| {
        let what = if range.rests { "rest and a cycle" } else { "two cycles" };
        format!("{what} from {:.5} to {:.5}", range.range[0], range.range[1])
    });
    format!("{name}, by µ: {}.", told.collect::<Vec<_>>().join("; "))
}

/// Fig. 6.
fn subcritical(found: &Continuation, known: &Bistability) -> Vec<Claim> {
    let rest = found.bistable.iter().find(|range| range.rests && range.bounded == [true; 2]);
    let onset = known.uniform.iter().find(|crossing| crossing.becomes_unstable);
    let onset = onset.map_or(f64::NAN, |crossing| crossing.value);
    let high = rest.map_or(f64::NAN, |range| range.range[1]);
    vec![
        claim(
            "Set 2 has a range of µ in which rest and a limit cycle exist side by side.",
            rest.map_or("none was found".to_owned(), |range| {
                format!("rest and a cycle from µ = {:.5} to {:.5}", range.range[0], range.range[1])
            }),
            rest.is_some(),
            None,
        ),
        claim(
            "At µ = 1.96 Set 2 is bistable.",
            rest.map_or("there is no such range".to_owned(), |range| {
                format!("the range goes from {:.5} to {:.5}", range.range[0], range.range[1])
            }),
            rest.is_some_and(|range| range.range[0] < 1.96 && 1.96 < range.range[1]),
            None,
        ),
        claim(
            "Upwards rest ends where uniform sliding becomes unstable.",
            format!(
                "rest ends at {high:.5}, a mode of uniform sliding begins to grow at {onset:.5}"
            ),
            (high - onset).abs() <= 2.0 * RESOLUTION,
            None,
        ),
    ]
}

/// Fig. 7.
fn two_branches(found: &Continuation) -> Vec<Claim> {
    let cycles: Vec<[f64; 2]> =
        found.bistable.iter().filter(|range| !range.rests).map(|range| range.range).collect();
    let told: Vec<String> =
        cycles.iter().map(|[from, to]| format!("{from:.5} to {to:.5}")).collect();
    let near_two = cycles.iter().find(|[from, to]| is_about(0.5 * (from + to), 2.0));
    vec![
        claim(
            "Set 1 changes between two unstable branches at µ of about 2, at another value upwards than downwards.",
            format!("ranges with two cycles: {}", told.join(", ")),
            near_two.is_some(),
            None,
        ),
        claim(
            "The text speaks of one such transition.",
            format!(
                "{} were found; which of them the figure shows the text does not say",
                cycles.len()
            ),
            cycles.len() == 1,
            None,
        ),
    ]
}

/// Jumps by both integrators.
fn both_integrators(
    name: &str,
    scene: &Scene,
    look: &Look,
    exact: &Continuation,
    watch: Watch<'_>,
) -> Result<Option<Table>, Error> {
    let scheme = Scene { method: Method::ForwardIncrement, step: STEP, ..scene.clone() };
    // From a little before the first jump to a little beyond the last.
    let at = || exact.jumps.iter().map(Jump::at);
    let hundredth = |value: f64| (100.0 * value).round() as i32;
    let first = hundredth(at().fold(f64::INFINITY, f64::min)) - 2;
    let last = hundredth(at().fold(0.0, f64::max)) + 2;
    let values: Vec<f64> = (first..=last).map(|i| f64::from(i) / 100.0).collect();
    let Some(found) = follow(&scheme, look, &values, watch)? else { return Ok(None) };
    let rows = exact.jumps.iter().enumerate().map(|(place, jump)| {
        let other = found.jumps.get(place).filter(|other| other.way == jump.way);
        let apart = other.map_or(f64::INFINITY, |other| (other.at() / jump.at() - 1.0).abs());
        vec![
            jump.way.name().into(),
            format!("{} becomes {}", describe(&jump.endings[0]), describe(&jump.endings[1])).into(),
            format!("{:.5}", jump.at()).into(),
            other.map_or("–".to_owned(), |other| format!("{:.5}", other.at())).into(),
            format!("{apart:.1e}").into(),
        ]
    });
    let rows = rows.collect();
    let head = ["µ", "what changes", "exact motion", "paper's scheme", "apart"].map(str::to_owned);
    let caption = format!(
        "Not in the paper: jumps of {name} by exact motion, and by the paper's scheme with a step of {STEP} s, whose \
         error halves with the step"
    );
    Ok(Some(Table { caption, head: head.to_vec(), rows }))
}
