//! Section 2: Fig. 3.

use super::claims::claim;
use super::measures::three_pieces;
use super::scene;
use amontons::Error;
use amontons::contact::ContactState;
use amontons::scene::Scene;
use amontons_analysis::study::{
    Change, Journal, LimitCycles, MotionBracket, ObservationRequest, ObservationSettings, Outcome,
    Portrait, Question, Watch, limit_cycles,
};
use amontons_cli::charts::limit_cycle::Results;
use amontons_pictures::report::{Claim, Content, Figure, Section};

/// Friction coefficient of the figure.
const FRICTION: f64 = 1.5;
/// Slider velocities whose orbits the figure shows, m/s.
const SHOWN: [f64; 3] = [0.05, 0.15, 0.25];
/// Step of the slider velocity, m/s, and number of steps.
const STEP: f64 = 0.01;
const LAST: i32 = 40;
/// Bounds of the paper's three ranges, m/s.
const BOUNDS: [f64; 2] = [0.1, 0.2];
/// Limit of the deviation of amplitudes from straight pieces, as part of the largest amplitude.
const NEARLY_STRAIGHT: f64 = 0.02;
/// Slopes are different if they differ by more than this part of the first slope, which is the steepest.
const OTHER_SLOPE: f64 = 0.1;
/// Limit of the relative difference between the velocities of the slider and of a mass that moves with it.
const ROUNDING: f64 = 1e-9;
/// Distance from the slider above which a mass is detached, m: far below the drawn size, far above rounding.
const AWAY: f64 = 1e-12;
/// Limit of the relative difference of amplitudes that count as equal: a motion settles to some 1e-3 of its amplitude.
const SAME: f64 = 2e-3;

pub fn section(watch: Watch<'_>) -> Result<Option<Section>, Error> {
    let (scene, observation) = scene("set1", &[("friction.coefficient", FRICTION)])?;
    let question = Question {
        name: "slider.velocity".to_owned(),
        values: (1..=LAST).map(|i| f64::from(i) / 100.0).collect(),
        resolution: 1e-3,
        portraits: Some(SHOWN.to_vec()),
        contacts: 2,
    };
    let prepare =
        |scene: &mut Scene| ObservationSettings::paced(scene, &ObservationRequest::default());
    let found = limit_cycles(&scene, &prepare, &question, &Journal::forgotten(), watch)?;
    let Some(found) = found else { return Ok(None) };
    let results =
        Results { scene: &scene, of: &observation.of, question: &question, found: &found };
    let command = format!(
        "amontons study limit-cycle set1 --set friction.coefficient={FRICTION} \
         --parameter slider.velocity=0.01:0.4:0.01 --portrait 0.05 --portrait 0.15 --portrait 0.25"
    );
    let mut figures = vec![Figure {
        caption: "Fig. 3(a): amplitude, frequency and contact states of the limit cycle of Set 1 at µ = 1.5 over the \
                  slider's velocity"
            .to_owned(),
        command: Some(command),
        content: Content::Chart(results.chart()),
    }];
    for portrait in &found.portraits {
        for (letter, direction) in [('b', "tangential"), ('c', "normal")] {
            figures.push(Figure {
                caption: format!(
                    "Fig. 3({letter}): {direction} motion of the masses in contact at v = {} m/s",
                    portrait.value
                ),
                command: None,
                content: Content::Chart(results.portrait(portrait, direction)),
            });
        }
    }
    Ok(Some(Section { claims: claims(&question, &found), figures, ..Section::default() }))
}

/// The settled cycle at a slider velocity: amplitude, m, and the contact states that it visits, also between rows.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cycle {
    velocity: f64,
    amplitude: f64,
    taken: [bool; 4],
}

impl Cycle {
    fn takes(&self, state: ContactState) -> bool {
        self.taken[state as usize - 1]
    }
}

fn claims(question: &Question, found: &LimitCycles) -> Vec<Claim> {
    let cycle = |(velocity, outcome): (&f64, &Outcome)| {
        let ending = outcome.settled().filter(|ending| ending.kind.is_cycle())?;
        Some(Cycle { velocity: *velocity, amplitude: ending.amplitude, taken: ending.taken })
    };
    let all: Option<Vec<Cycle>> = question.values.iter().zip(&found.outcomes).map(cycle).collect();
    // Unless the motion is known at every value, no rule is applied to any.
    let cycles = all.unwrap_or_default();
    let threshold = |change: Change| {
        let is_it = |threshold: &&MotionBracket| threshold.changes.contains(&change);
        let threshold = found.thresholds.iter().find(is_it);
        threshold.map_or(f64::NAN, |threshold| 0.5 * (threshold.between[0] + threshold.between[1]))
    };
    let orbits: Vec<Orbits> = found.portraits.iter().map(Orbits::of).collect();
    let mut claims = vec![
        regime(
            "At v = 0.05 m/s the masses stick and slip, and do not detach.",
            (SHOWN[0], [true, false]),
            (&cycles, &orbits),
        ),
        regime(
            "At v = 0.15 m/s the masses stick, slip and detach.",
            (SHOWN[1], [true, true]),
            (&cycles, &orbits),
        ),
        regime(
            "At v = 0.25 m/s the masses slip and detach, and do not stick.",
            (SHOWN[2], [false, true]),
            (&cycles, &orbits),
        ),
    ];
    let detaches = threshold(Change::Appears(ContactState::Detached));
    let slips = threshold(Change::Vanishes(ContactState::Stick));
    claims.extend(ranges(&cycles, [detaches, slips]));
    claims.extend(slopes(&cycles));
    claims.push(independent(&cycles));
    claims
}

/// The motion of the masses in a portrait: whether they move with the slider for a time, and whether they leave it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Orbits {
    velocity: f64,
    /// The largest part of an orbit's points at which a mass has the slider's velocity.
    with_slider: f64,
    /// The largest distance of a mass from the slider, m.
    away: f64,
}

impl Orbits {
    fn of(portrait: &Portrait) -> Self {
        let with_slider = portrait.orbits.iter().map(|orbit| {
            let moves_with = |point: &&[f64; 2]| {
                (point[1] - orbit.slider_velocity).abs() <= ROUNDING * orbit.slider_velocity.abs()
            };
            let count = orbit.tangential.iter().filter(moves_with).count();
            count as f64 / orbit.tangential.len() as f64
        });
        let away = portrait.orbits.iter().flat_map(|orbit| &orbit.normal).map(|point| point[0]);
        Self {
            velocity: portrait.value,
            with_slider: with_slider.fold(0.0, f64::max),
            away: away.fold(0.0, f64::max),
        }
    }
}

/// The claim on one velocity; `sticks` and `detaches` are the paper's statements for it.
fn regime(
    paper: &str,
    (velocity, [sticks, detaches]): (f64, [bool; 2]),
    (cycles, orbits): (&[Cycle], &[Orbits]),
) -> Claim {
    let cycle = cycles.iter().find(|cycle| cycle.velocity == velocity);
    let orbit = orbits.iter().find(|orbit| orbit.velocity == velocity);
    let states: Vec<String> = ContactState::ALL
        .iter()
        .filter(|state| cycle.is_some_and(|cycle| cycle.takes(**state)))
        .map(ToString::to_string)
        .collect();
    let [with_slider, away] = orbit.map_or([f64::NAN; 2], |orbit| [orbit.with_slider, orbit.away]);
    let expected = [true, false, sticks, detaches];
    claim(
        paper,
        format!(
            "states taken: {}; a mass moves with the slider in {:.1} % of the orbit and is up to {away:.2e} m away from it \
             (holds if the states and the orbit agree with this)",
            states.join(", "),
            100.0 * with_slider
        ),
        cycle.is_some_and(|cycle| cycle.taken == expected)
            && (with_slider > 0.0) == sticks
            && (away > AWAY) == detaches
            && orbit.is_some(),
        None,
    )
}

/// The claims on the three ranges of the velocity, at each value.
fn ranges(cycles: &[Cycle], [detaches, slips]: [f64; 2]) -> Vec<Claim> {
    let within =
        |from: f64, to: f64| cycles.iter().filter(move |c| from < c.velocity && c.velocity < to);
    let all = |from: f64, to: f64, [sticks, leaves]: [bool; 2]| {
        let is_so = |cycle: &Cycle| {
            cycle.takes(ContactState::Slide)
                && cycle.takes(ContactState::Stick) == sticks
                && cycle.takes(ContactState::Detached) == leaves
        };
        within(from, to).count() > 0 && within(from, to).all(is_so)
    };
    let [first, second] = BOUNDS;
    let holds = "holds if this is so at each value of v in the range";
    vec![
        claim(
            "For 0 < v < 0.1 m/s the masses only stick and slip.",
            format!("contacts detach from {detaches:.5} m/s on ({holds})"),
            all(0.0, first, [true, false]),
            Some(
                "the paper reads the bound off a plot at the change of slope; the first short detachment occurs \
                 before the slope changes",
            ),
        ),
        claim(
            "For 0.1 < v < 0.2 m/s the masses stick, slip and detach.",
            format!(
                "contacts detach from {detaches:.5} m/s on and stick up to {slips:.5} m/s ({holds})"
            ),
            all(first, second, [true, true]),
            None,
        ),
        claim(
            "For v > 0.2 m/s the masses slip and detach, and do not stick.",
            format!("contacts stick up to {slips:.5} m/s ({holds})"),
            all(second, f64::INFINITY, [false, true]),
            None,
        ),
    ]
}

/// The claims on the three slopes of Fig. 3(a).
fn slopes(cycles: &[Cycle]) -> Vec<Claim> {
    let points: Vec<[f64; 2]> =
        cycles.iter().map(|cycle| [cycle.velocity, cycle.amplitude]).collect();
    let fit = three_pieces(&points);
    let largest = points.iter().map(|point| point[1]).fold(0.0, f64::max);
    let [worst, of_two] =
        fit.as_ref().map_or([f64::NAN; 2], |fit| [fit.worst / largest, fit.worst_of_two / largest]);
    let slopes = fit.as_ref().map_or([f64::NAN; 3], |fit| fit.slopes);
    let knots = fit.as_ref().map_or([f64::NAN; 2], |fit| fit.knots);
    let differ = |a: f64, b: f64| (a - b).abs() > OTHER_SLOPE * slopes[0].abs();
    let mut claims = vec![claim(
        "The amplitude over v has three nearly straight portions with different slopes.",
        format!(
            "the best three pieces have slopes of {:.3e}, {:.3e} and {:.3e} s and are off by {:.1} % of the largest amplitude \
             at most, the best two by {:.1} % (holds up to {} % where two pieces do not, and neighbouring slopes differ by \
             more than {} % of the first)",
            slopes[0],
            slopes[1],
            slopes[2],
            100.0 * worst,
            100.0 * of_two,
            100.0 * NEARLY_STRAIGHT,
            100.0 * OTHER_SLOPE
        ),
        worst <= NEARLY_STRAIGHT
            && of_two > NEARLY_STRAIGHT
            && differ(slopes[0], slopes[1])
            && differ(slopes[1], slopes[2]),
        None,
    )];
    for ((knot, bound), which) in knots.into_iter().zip(BOUNDS).zip(["first", "second"]) {
        claims.push(claim(
            &format!("The {which} change of slope lies at v of about {bound} m/s."),
            format!("the best three pieces meet at {knot:.3} m/s (holds within {STEP} m/s, the step of v)"),
            (knot - bound).abs() <= STEP * (1.0 + 1e-9),
            None,
        ));
    }
    claims
}

/// The claim that the motion does not depend on the velocity beyond sticking.
fn independent(cycles: &[Cycle]) -> Claim {
    let beyond: Vec<&Cycle> = cycles.iter().filter(|cycle| cycle.velocity >= SHOWN[2]).collect();
    let amplitudes = || beyond.iter().map(|cycle| cycle.amplitude);
    let least = amplitudes().fold(f64::INFINITY, f64::min);
    let most = amplitudes().fold(0.0, f64::max);
    claim(
        "Where nothing sticks the limit cycle does not depend on v.",
        format!(
            "from {} to {} m/s amplitudes lie between {least:.5e} and {most:.5e} m (holds if they differ by less than \
             {SAME} of themselves, and nothing sticks)",
            SHOWN[2],
            STEP * f64::from(LAST)
        ),
        beyond.len() > 1
            && most / least - 1.0 <= SAME
            && !beyond.iter().any(|cycle| cycle.takes(ContactState::Stick)),
        None,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The motion that the paper describes, at each velocity.
    fn as_printed() -> Vec<Cycle> {
        let cycle = |i: i32| {
            let v = STEP * f64::from(i);
            let amplitude = 4e-3 * v.min(0.1) + 2e-3 * (v.clamp(0.1, 0.2) - 0.1);
            Cycle { velocity: v, amplitude, taken: [true, false, v < 0.205, v > 0.105] }
        };
        (1..=LAST).map(cycle).collect()
    }

    fn held(claims: &[Claim]) -> Vec<bool> {
        claims.iter().map(|claim| claim.verdict.holds()).collect()
    }

    #[test]
    fn claims_on_ranges_hold_as_printed_and_fail_by_one_value() {
        assert_eq!(held(&ranges(&as_printed(), [0.1, 0.2])), [true; 3]);
        for (place, state, expected) in [
            (7, 3, [false, true, true]),
            (14, 2, [true, false, true]),
            (29, 2, [true, true, false]),
        ] {
            let mut cycles = as_printed();
            cycles[place].taken[state] ^= true;
            assert_eq!(held(&ranges(&cycles, [0.1, 0.2])), expected);
        }
        assert_eq!(held(&ranges(&[], [f64::NAN; 2])), [false; 3]);
    }

    #[test]
    fn claims_on_slopes_hold_as_printed_and_fail_for_other_curves() {
        assert_eq!(held(&slopes(&as_printed())), [true; 3]);
        let curve = |amplitude: &dyn Fn(f64) -> f64| -> Vec<Cycle> {
            as_printed()
                .into_iter()
                .map(|c| Cycle { amplitude: amplitude(c.velocity), ..c })
                .collect()
        };
        // Curves of two pieces, of waves, and with bends two steps too late.
        assert!(!held(&slopes(&curve(&|v| 4e-3 * v.min(0.15))))[0]);
        assert!(!held(&slopes(&curve(&|v| 1.0 + (40.0 * v).sin())))[0]);
        let late = slopes(&curve(&|v| 4e-3 * v.min(0.12) + 2e-3 * (v.clamp(0.12, 0.22) - 0.12)));
        assert_eq!(held(&late), [true, false, false]);
        assert_eq!(held(&slopes(&[])), [false; 3]);
    }

    #[test]
    fn a_cycle_that_depends_on_v_or_sticks_is_not_independent() {
        assert!(independent(&as_printed()).verdict.holds());
        let mut larger = as_printed();
        larger[35].amplitude *= 1.0 + 2.0 * SAME;
        assert!(!independent(&larger).verdict.holds());
        let mut sticks = as_printed();
        sticks[35].taken[2] = true;
        assert!(!independent(&sticks).verdict.holds());
        assert!(!independent(&[]).verdict.holds());
    }

    #[test]
    fn a_regime_needs_both_the_states_and_the_orbit() {
        let holds = |[sticks, detaches]: [bool; 2], with_slider: f64, away: f64| {
            let orbit = Orbits { velocity: 0.15, with_slider, away };
            regime("", (0.15, [sticks, detaches]), (&as_printed(), &[orbit])).verdict.holds()
        };
        assert!(holds([true, true], 0.1, 1e-4));
        assert!(!holds([true, true], 0.0, 1e-4) && !holds([true, true], 0.1, 0.0));
        assert!(!holds([false, true], 0.0, 1e-4) && !holds([true, false], 0.1, 0.0));
        assert!(!regime("", (0.15, [true, true]), (&as_printed(), &[])).verdict.holds());
        assert!(!regime("", (0.15, [true, false]), (&[], &[])).verdict.holds());
    }
}
