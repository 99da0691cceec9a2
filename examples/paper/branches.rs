//! Section 5: Figs. 6 and 7.

use super::claims::{claim, half_digit, is_about};
use super::scene;
use amontons::Error;
use amontons::scene::{Method, Scene};
use amontons_analysis::stability::candidates::{Bistability, bistability};
use amontons_analysis::study::{
    Continuation, Journal, Jump, ObservationSettings, Plan, Point, Push, Watch, continuation,
};
use amontons_cli::charts::continuation::{chart, describe};
use amontons_pictures::report::{Claim, Content, Figure, Section, Table};

/// Friction coefficients of both figures, in hundredths: 1.5 to 2.5 in steps of 0.01.
const FRICTION: [i32; 2] = [150, 250];
/// Tolerance for the bounds of a jump, in µ.
const RESOLUTION: f64 = 1e-5;
/// Step of the paper's scheme with which the jumps are computed again, s.
const STEP: f64 = 2e-5;

pub fn section(watch: Watch<'_>) -> Result<Option<Section>, Error> {
    let mut section = Section {
        text: vec![
            "The paper's pseudo-continuation: each value of µ starts from the state in which the value before has \
             ended, with a small push; upwards and downwards. Where the motion jumps, the value is bisected. Falling \
             values are pushed too, which the paper does not do: otherwise a cycle that has lost its stability is \
             followed until rounding errors have grown."
                .to_owned(),
        ],
        ..Section::default()
    };
    for (place, (name, figure)) in [("set2", 6), ("set1", 7)].into_iter().enumerate() {
        let part = |part: f64| (watch.progress)(0.5 * (place as f64 + part));
        let watch = Watch { go_on: watch.go_on, progress: &part };
        let (scene, observation) = scene(name, &[])?;
        let values: Vec<f64> = (FRICTION[0]..=FRICTION[1]).map(|i| f64::from(i) / 100.0).collect();
        let Some(found) = follow(&scene, &observation, &values, watch)? else { return Ok(None) };
        let known = bistability(&scene, [values[0], values[values.len() - 1]], Watch::IDLE)?;
        section.figures.push(Figure {
            caption: format!("Fig. {figure}: motions of {name} over rising and falling µ"),
            command: Some(format!(
                "amontons study continuation {name} --friction 1.5:2.5:0.01 --resolution 1e-5"
            )),
            content: Content::Chart(chart(&scene, &observation, &found, Some(&known))),
        });
        let branches = Branches::of(&found, &known);
        let claims = if name == "set2" { subcritical(&branches) } else { two_branches(&branches) };
        section.claims.extend(claims);
        section.text.push(ranges(name, &found));
        let Some(table) = both_integrators(name, &scene, &observation, &found, watch)? else {
            return Ok(None);
        };
        section.tables.push(table);
    }
    Ok(Some(section))
}

fn follow(
    scene: &Scene,
    observation: &ObservationSettings,
    values: &[f64],
    watch: Watch<'_>,
) -> Result<Option<Continuation>, Error> {
    let push = Push::of(scene);
    let plan = Plan { scene, observation, values, resolution: RESOLUTION, push, candidates: &[] };
    continuation(&plan, &Journal::forgotten(), watch)
}

/// Describes all ranges with two motions.
fn ranges(name: &str, found: &Continuation) -> String {
    let told = found.bistable.iter().map(|range| {
        format!("{} from {:.5} to {:.5}", range.words(), range.range[0], range.range[1])
    });
    format!("{name}, by µ: {}.", told.collect::<Vec<_>>().join("; "))
}

/// The results for both directions of µ on which the claims depend.
#[derive(Clone, Debug)]
struct Branches {
    /// The first and the last value upwards: µ, and `true` if the motion rests and if it is a cycle; `None` for a run
    /// that failed.
    ends: [Option<(f64, [bool; 2])>; 2],
    /// Ranges with two motions that a jump bounds on either side, and `true` if one of the two is rest.
    ranges: Vec<([f64; 2], bool)>,
    /// Friction coefficient at which a mode of uniform sliding begins to grow; NaN if none does.
    onset: f64,
}

impl Branches {
    fn of(found: &Continuation, known: &Bistability) -> Self {
        let end = |point: &Point| {
            let ending = point.ending.as_ref().ok()?;
            Some((point.friction, [ending.rests(), ending.kind.is_cycle()]))
        };
        let onset = known.uniform.iter().find(|crossing| crossing.becomes_unstable);
        let bounded = found.bistable.iter().filter(|range| range.bounded == [true; 2]);
        Self {
            ends: [found.rising.first(), found.rising.last()].map(|point| point.and_then(end)),
            ranges: bounded.map(|range| (range.range, range.rests)).collect(),
            onset: onset.map_or(f64::NAN, |crossing| crossing.value),
        }
    }
}

/// The claims on Fig. 6.
fn subcritical(found: &Branches) -> Vec<Claim> {
    let Branches { ends: [first, last], ranges, onset } = found;
    let rest = ranges.iter().find(|(_, rests)| *rests).map(|(range, _)| range);
    let high = rest.map_or(f64::NAN, |range| range[1]);
    let told = |end: &Option<(f64, [bool; 2])>| {
        end.map_or("the run failed".to_owned(), |(friction, kind)| {
            let kind = match kind {
                [true, _] => "at rest",
                [_, true] => "in a cycle",
                _ => "in a motion that is not known",
            };
            format!("upwards the motion at µ = {friction} ends {kind}")
        })
    };
    vec![
        claim(
            "At µ = 1.5 the equilibrium of Set 2 in steady sliding is stable.",
            format!("{}; a mode of uniform sliding begins to grow at {onset:.5}", told(first)),
            first.is_some_and(|(friction, [rests, _])| {
                friction == 1.5 && friction < *onset && rests
            }),
            None,
        ),
        claim(
            "At µ = 2.5 a small perturbation of Set 2 leads to a limit cycle.",
            format!("{}; a mode of uniform sliding begins to grow at {onset:.5}", told(last)),
            last.is_some_and(|(friction, [_, cycles])| {
                friction == 2.5 && friction > *onset && cycles
            }),
            None,
        ),
        claim(
            "Set 2 has a range of µ in which rest and a limit cycle exist side by side.",
            rest.map_or("none was found".to_owned(), |range| {
                format!("rest and a cycle from µ = {:.5} to {:.5}", range[0], range[1])
            }),
            rest.is_some(),
            None,
        ),
        claim(
            "At µ = 1.96 Set 2 is bistable.",
            rest.map_or("there is no such range".to_owned(), |range| {
                format!("the range goes from {:.5} to {:.5}", range[0], range[1])
            }),
            rest.is_some_and(|range| range[0] < 1.96 && 1.96 < range[1]),
            None,
        ),
        claim(
            "Upwards rest ends where uniform sliding becomes unstable.",
            format!(
                "rest ends at {high:.5}, a mode of uniform sliding begins to grow at {onset:.5} (holds if they are no more than \
                 {:.0e} apart)",
                2.0 * RESOLUTION
            ),
            (high - onset).abs() <= 2.0 * RESOLUTION,
            None,
        ),
    ]
}

/// The claims on Fig. 7.
fn two_branches(found: &Branches) -> Vec<Claim> {
    let ranges = found.ranges.iter().filter(|(_, rests)| !rests);
    let cycles: Vec<[f64; 2]> = ranges.map(|(range, _)| *range).collect();
    let told: Vec<String> =
        cycles.iter().map(|[from, to]| format!("{from:.5} to {to:.5}")).collect();
    let told = if told.is_empty() { "none".to_owned() } else { told.join(", ") };
    let near_two = cycles.iter().find(|[from, to]| is_about(0.5 * (from + to), "2.0"));
    vec![
        claim(
            "Set 1 has several limit cycles side by side in a range of µ; the initial state decides which it takes.",
            format!("ranges with two cycles: {told}"),
            !cycles.is_empty(),
            None,
        ),
        claim(
            "Set 1 changes between two unstable branches at µ of about 2, at another value upwards than downwards.",
            format!(
                "ranges with two cycles: {told} (holds if the middle of one, bounded by a jump upwards and one downwards, is \
                 within {} of 2: the text prints such values of µ to a tenth)",
                half_digit("2.0")
            ),
            near_two.is_some(),
            None,
        ),
        claim(
            "Set 1 has one transition between two unstable branches.",
            format!(
                "{} were found; the text does not say which of them the figure shows",
                cycles.len()
            ),
            cycles.len() == 1,
            None,
        ),
    ]
}

/// A table of the jumps that both integrators find; `None` if the watch ended the work.
fn both_integrators(
    name: &str,
    scene: &Scene,
    observation: &ObservationSettings,
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
    let Some(found) = follow(&scheme, observation, &values, watch)? else { return Ok(None) };
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

#[cfg(test)]
mod tests {
    use super::*;

    const REST: [bool; 2] = [true, false];
    const CYCLE: [bool; 2] = [false, true];

    fn followed(ranges: &[([f64; 2], bool)], ends: [[bool; 2]; 2]) -> Branches {
        let ends = [Some((1.5, ends[0])), Some((2.5, ends[1]))];
        Branches { ends, ranges: ranges.to_vec(), onset: 2.0626 }
    }

    fn held(claims: &[Claim]) -> Vec<bool> {
        claims.iter().map(|claim| claim.verdict.holds()).collect()
    }

    #[test]
    fn each_claim_on_fig_6_can_fail() {
        let ends = [REST, CYCLE];
        let as_printed = followed(&[([1.93, 2.0626], true)], ends);
        assert_eq!(held(&subcritical(&as_printed)), [true; 5]);
        let exchanged = followed(&[([1.93, 2.0626], true)], [CYCLE, REST]);
        assert_eq!(held(&subcritical(&exchanged))[..2], [false; 2]);
        let away = followed(&[([1.97, 2.07], true)], ends);
        assert_eq!(held(&subcritical(&away))[2..], [true, false, false]);
        assert_eq!(
            held(&subcritical(&followed(&[([1.93, 2.0626], false)], ends)))[2..],
            [false; 3]
        );
        let no_onset = Branches { onset: f64::NAN, ..as_printed };
        assert_eq!(held(&subcritical(&no_onset)), [false, false, true, true, false]);
        let failed = Branches { ends: [None, None], ..no_onset };
        assert_eq!(held(&subcritical(&failed))[..2], [false; 2]);
    }

    #[test]
    fn each_claim_on_fig_7_can_fail() {
        let of =
            |ranges: &[([f64; 2], bool)]| held(&two_branches(&followed(ranges, [CYCLE, CYCLE])));
        assert_eq!(of(&[([1.99, 2.03], false)]), [true; 3]);
        assert_eq!(of(&[([1.8, 1.9], false)]), [true, false, true]);
        assert_eq!(of(&[([1.8, 1.9], false), ([1.99, 2.03], false)]), [true, true, false]);
        assert_eq!(of(&[([1.99, 2.03], true)]), [false; 3]);
        assert_eq!(of(&[]), [false; 3]);
    }
}
