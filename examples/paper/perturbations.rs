//! Section 4: Fig. 5.

use super::claims::claim;
use super::measures::{half_ranges, spread};
use super::motion::Motion;
use super::scene;
use amontons::Error;
use amontons::contact::ContactState;
use amontons::scene::Scene;
use amontons_analysis::assign::assign;
use amontons_analysis::study::perturbation::{Direction, Run, Threshold, perturbation};
use amontons_analysis::study::{Journal, ObservationSettings, Watch, history};
use amontons_cli::charts::perturbation::{endings, histories, thinned};
use amontons_pictures::picture::{Chart, Panel, Series};
use amontons_pictures::report::{Claim, Content, Figure, Section};

/// Initial velocities of the upper mass of module 1, vertical, m/s.
const FIRST: f64 = 1e-4;
const LAST: f64 = 0.3;
const COUNT: u32 = 31;
/// Duration of the histories that are shown, s.
const DURATION: f64 = 2.0;
/// Duration of the observation of a run for its claim, and of the observation after a push, s.
const LONG: f64 = 4.0;
const AFTER_PUSH: f64 = 2.0;
/// Length of the pieces of which half ranges are taken, s, and limit of their deviation from the mean for a stable
/// orbit.
const PIECE: f64 = 0.1;
const STEADY: f64 = 0.01;

pub fn section(watch: Watch<'_>) -> Result<Option<Section>, Error> {
    let (scene, observation) = scene("set2", &[])?;
    let at = |i: u32| FIRST + (LAST - FIRST) * f64::from(i) / f64::from(COUNT - 1);
    let direction = Direction {
        name: "initial.module[1].v2".to_owned(),
        amplitudes: (0..COUNT).map(at).collect(),
        resolution: 1e-4,
    };
    let found = perturbation(&scene, &direction, &observation, &Journal::forgotten(), watch)?;
    let Some(found) = found else { return Ok(None) };
    let ending = |run: Option<&Run>| run.and_then(|run| run.ending.clone());
    let rests = ending(found.runs.first()).is_some_and(|ending| ending.rests());
    let cycles = ending(found.runs.last()).is_some_and(|ending| ending.kind.is_cycle());
    let middle = |threshold: &Threshold| 0.5 * (threshold.between[0] + threshold.between[1]);
    let thresholds: Vec<String> =
        found.thresholds.iter().map(|threshold| format!("{:.6}", middle(threshold))).collect();
    let mut runs = Vec::new();
    for velocity in [FIRST, LAST] {
        let Some(run) = seen(&scene, &direction.name, velocity, watch)? else { return Ok(None) };
        runs.push(run);
    }
    let claims = claims(&[runs[0], runs[1]], [rests, cycles], &thresholds.join(", "));
    let mut section = Section { claims, ..Section::default() };
    let is_over = || (watch.go_on)().is_break();
    let Some(small_and_large) = histories_of(&scene, &direction, &observation, &is_over)? else {
        return Ok(None);
    };
    section.figures.push(small_and_large);
    if let Some(threshold) = found.thresholds.first() {
        let chart = histories(&scene, &direction, &observation, (&found, threshold), &is_over)?;
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
            "Attractors of Set 2 at µ = 1.96 over the initial velocity of the upper mass of module 1"
                .to_owned(),
        command: None,
        content: Content::Chart(endings(&scene, &direction, &observation, &found)),
    });
    Ok(Some(section))
}

/// The histories of Fig. 5: the first two seconds after the smallest and after the largest perturbation.
fn histories_of(
    scene: &Scene,
    direction: &Direction,
    observation: &ObservationSettings,
    is_over: &dyn Fn() -> bool,
) -> Result<Option<Figure>, Error> {
    let mut panels = Vec::new();
    for (colour, amplitude) in [FIRST, LAST].into_iter().enumerate() {
        let rows = history(scene, (&direction.name, amplitude), observation, DURATION, is_over)?;
        let Some(rows) = rows else { return Ok(None) };
        panels.push(Panel {
            y_label: format!("{} [m]", observation.of),
            series: vec![Series {
                label: Some(format!("from {amplitude} m/s")),
                points: thinned(&rows, observation.interval),
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

/// The quantities measured from a run after one of the perturbations.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Seen {
    /// Initial velocity of the upper mass of module 1, m/s.
    velocity: f64,
    /// Time at which a contact first changes its state, s; `None` if none does.
    changes: Option<f64>,
    /// `true` if a contact sticks within the first [`PIECE`] s.
    sticks: bool,
    /// Half ranges of the first and of the last piece of [`PIECE`] s, m.
    amplitudes: [f64; 2],
    /// Largest deviation of half ranges from their mean over the last second, as part of the mean.
    spread: f64,
    /// Relative change of the half range between the last second before a push and the end of the observation after it.
    after_push: f64,
}

/// Measures the run after one of the perturbations; `None` if the watch ended the work.
fn seen(
    scene: &Scene,
    direction: &str,
    velocity: f64,
    watch: Watch<'_>,
) -> Result<Option<Seen>, Error> {
    let mut scene = scene.clone();
    assign(&mut scene, direction, velocity)?;
    let mut motion = Motion::new(&scene)?;
    // The progress of the section already includes its first part, so these runs report none.
    let quiet = Watch { progress: &|_| {}, ..watch };
    if !motion.record(LONG, quiet)? {
        return Ok(None);
    }
    motion.push();
    if !motion.record(LONG + AFTER_PUSH, quiet)? {
        return Ok(None);
    }
    let ranges = half_ranges(&motion.history, Motion::row(PIECE));
    let pieces = |time: f64| (time / PIECE).round() as usize;
    let before = &ranges[pieces(LONG - 1.0)..pieces(LONG)];
    let last = ranges[pieces(LONG + AFTER_PUSH) - 1];
    let sticks = |states: &[ContactState; 2]| states.contains(&ContactState::Stick);
    Ok(Some(Seen {
        velocity,
        changes: motion.first_change().filter(|time| *time < LONG),
        sticks: motion.states_between(0.0, PIECE).iter().any(sticks),
        amplitudes: [ranges[0], ranges[pieces(LONG) - 1]],
        spread: spread(before),
        after_push: (last * before.len() as f64 / before.iter().sum::<f64>() - 1.0).abs(),
    }))
}

/// The claims on Fig. 5; `rests` and `cycles` are the study's results for the smallest and the largest perturbation.
fn claims([small, large]: &[Seen; 2], [rests, cycles]: [bool; 2], thresholds: &str) -> Vec<Claim> {
    vec![
        claim(
            "At µ = 1.96 Set 2 oscillates around the equilibrium after a small perturbation, and comes to rest (Fig. 5a).",
            format!(
                "from {} m/s {}; within {LONG} s the amplitude falls from {:.2e} to {:.2e} m (holds if no contact changes its \
                 state, the amplitude falls tenfold, and the study of perturbations finds that the motion ends at rest)",
                small.velocity,
                small.changes.map_or("no contact changes its state".to_owned(), |time| format!(
                    "a contact changes its state at {time:.3} s"
                )),
                small.amplitudes[0],
                small.amplitudes[1]
            ),
            rests && small.changes.is_none() && small.amplitudes[1] <= 0.1 * small.amplitudes[0],
            None,
        ),
        claim(
            "A large perturbation of Set 2 that makes a contact stick leads to a stable orbit (Fig. 5b).",
            format!(
                "from {} m/s a contact {} within {PIECE} s; half ranges are {:.3e} m in the end, with a spread of {:.1e} over the \
                 last second, and differ by {:.1e} {AFTER_PUSH} s after a push of 1 % of the largest velocity (holds if it sticks, \
                 both are below {STEADY}, and the study of perturbations finds a cycle); thresholds between rest and a cycle: \
                 {thresholds} m/s",
                large.velocity,
                if large.sticks { "sticks" } else { "does not stick" },
                large.amplitudes[1],
                large.spread,
                large.after_push
            ),
            cycles && large.sticks && large.spread <= STEADY && large.after_push <= STEADY,
            None,
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_claim_on_fig_5_can_fail() {
        let (scene, _) = scene("set2", &[]).unwrap();
        let seen = |velocity: f64| {
            seen(&scene, "initial.module[1].v2", velocity, Watch::IDLE).unwrap().unwrap()
        };
        let (small, large) = (seen(FIRST), seen(LAST));
        let held = |runs: [Seen; 2], kinds: [bool; 2]| -> Vec<bool> {
            claims(&runs, kinds, "").iter().map(|claim| claim.verdict.holds()).collect()
        };
        assert_eq!(held([small, large], [true; 2]), [true; 2]);
        assert_eq!(held([large, small], [true; 2]), [false; 2]);
        assert_eq!(held([small, large], [false; 2]), [false; 2]);
        assert_eq!(held([small, Seen { after_push: 0.1, ..large }], [true; 2]), [true, false]);
        assert_eq!(held([Seen { changes: Some(0.1), ..small }, large], [true; 2]), [false, true]);
    }
}
