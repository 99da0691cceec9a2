//! `amontons study report`: one page that joins stability, loudness, robustness and sensitivity of a scene.
//!
//! | file | contents |
//! | --- | --- |
//! | `assumptions` | the scatter that is assumed where none is given |
//! | `sliding` | uniform sliding: modes, modes over µ, sensitivities |
//! | `numbers` | the numbers of modes over µ |
//! | `changes` | changes of the most effective parameters, computed anew |
//! | `after` | the probability of growth and the motion after these changes |
//! | `answers` | the answers at the start of the page |
//! | `sections` | the sections of the page |
//! | `rows` | the key numbers |

mod after;
mod answers;
mod assumptions;
mod changes;
mod numbers;
mod rows;
mod sections;
mod sliding;

use super::arguments::{ObservationOptions, StudyArguments};
use super::folder::Folder;
use super::loudness::searched;
use super::robustness::{self, Scatter};
use super::{prepared, prepared_again};
use after::{After, Changed};
use amontons::Error;
use amontons::scene::Scene;
use amontons::simulation::at_instant;
use amontons_analysis::instant::signals_left_out;
use amontons_analysis::robustness::{
    Both, Design, Estimate, FEWEST_SCRAMBLINGS, Parameter, Pushes, both, check_size, parameters,
    push_velocity,
};
use amontons_analysis::stability::{Linearised, modes};
use amontons_analysis::study::loudness::{
    Loudness, LoudnessQuestion, Ways, loudness, measured_points,
};
use amontons_analysis::study::{Journal, ObservationSettings, Push, Watch};
use amontons_cli::interrupt::{self, Interrupted};
use amontons_cli::progress::Progress;
use amontons_cli::say;
use amontons_cli::shards::ShardArguments;
use amontons_cli::words::{digits, four};
use amontons_pictures::report::{self, Page};
use assumptions::{Assumptions, Plan};
use changes::Change;
use clap::Args;
use serde_json::json;
use sliding::Sliding;

/// The largest number of candidates that are pushed, as `study loudness` has it.
const CANDIDATES: usize = 20;

/// Parts of the work: motions, draws, and what follows changes.
const PARTS: [[f64; 2]; 3] = [[0.0, 0.6], [0.6, 0.8], [0.8, 1.0]];

#[derive(Args)]
pub struct ReportArguments {
    #[command(flatten)]
    pub common: StudyArguments,
    #[command(flatten)]
    pub shared: ShardArguments,
    #[command(flatten)]
    pub scatter: Scatter,
    /// Number of draws in each of 16 scramblings, a power of two; more make intervals narrower [default: 1024, or for a large
    /// scene fewer, and then perhaps without Sobol indices]
    #[arg(long, value_name = "N")]
    pub points: Option<u64>,
    #[command(flatten)]
    pub options: ObservationOptions,
}

/// All that the page tells, and what it was found with.
struct Report<'a> {
    arguments: &'a ReportArguments,
    /// The scene as its user has it.
    scene: &'a Scene,
    /// The scene at t = 0, without signals.
    still: &'a Scene,
    observation: &'a ObservationSettings,
    assumptions: &'a Assumptions,
    parameters: &'a [Parameter],
    plan: Plan,
    sliding: Sliding,
    loudness: Result<Loud, String>,
    robustness: Result<Both, String>,
    after: After,
}

/// Loudness, and the starts that it was found from.
struct Loud {
    ways: Ways,
    push: f64,
    found: Loudness,
}

/// The motions that are followed.
struct Motions {
    scene: Scene,
    ways: Ways,
    question: LoudnessQuestion,
}

impl Motions {
    /// Refused for a scene with signals or without an equilibrium: the inner error is the reason.
    ///
    /// # Errors
    /// Returns [`Interrupted`] if the user ends the search for candidates.
    fn of(scene: &Scene) -> Result<Result<Self, String>, Interrupted> {
        if !scene.signals.is_empty() {
            return Ok(Err(format!(
                "{} has signals, and loudness is that of motions which start from uniform sliding under a constant drive",
                scene.name
            )));
        }
        let mut scene = scene.clone();
        scene.rest();
        let points = match measured_points(&scene, &[]) {
            Ok(points) => points,
            Err(error) => return Ok(Err(error.to_string())),
        };
        let ways = match searched(&scene, CANDIDATES) {
            Ok(ways) => ways,
            Err(error) if error.is::<Interrupted>() => return Err(Interrupted),
            Err(error) => return Ok(Err(error.to_string())),
        };
        let push = Push::of(&scene).velocity;
        Ok(Ok(Self { scene, ways, question: LoudnessQuestion { push, points } }))
    }

    fn found(
        &self,
        observation: &ObservationSettings,
        journal: &Journal,
        watch: Watch<'_>,
    ) -> Result<Option<Loudness>, Error> {
        loudness(&self.scene, &self.ways, &self.question, observation, journal, watch)
    }
}

pub fn run(arguments: &ReportArguments) -> Result<(), Box<dyn std::error::Error>> {
    let ReportArguments { common, shared, scatter, options, .. } = arguments;
    let (scene, source, observation) = prepared(common, options)?;
    let still = at_instant(&scene, 0.0)?;
    still.check()?;
    scatter.check(&scene)?;
    // Said before the folder is made.
    let here = Linearised::of(&still);
    let states = here.uniform_sliding()?;
    if here.equilibrium().is_ok() && modes(here.linear()?, &states)?.all().next().is_none() {
        return Err(Error::analysis(format!(
            "{}: no motion is possible in uniform sliding, so there is nothing to report; `amontons-stability states` lists other \
             contact states",
            scene.name
        ))
        .into());
    }
    let assumptions = Assumptions::of(&scene, &scatter.uncertain)?;
    let parameters = parameters(&scene, &assumptions.uncertain)?;
    let plan = Plan::of(&still, parameters.len(), arguments.points);
    check_size(FEWEST_SCRAMBLINGS, plan.points)?;
    robustness::tell_notes(common, &scene, &parameters);
    let velocity = scatter.pushes.as_ref().map(push_velocity).transpose()?;
    let motions = Motions::of(&scene)?;
    let described: Vec<_> = parameters.iter().map(Parameter::described).collect();
    let settings = json!({
        "look": observation,
        "push": motions.as_ref().ok().map(|motions| motions.question.push),
        "uncertain": described,
        "seed": scatter.seed,
        "indices": plan.has_indices,
        "pushes": scatter.described(common, options),
    });
    // Without pieces in the journal: it takes seconds, and its changes are pieces of what follows.
    let bar = Progress::in_uneven_parts("uniform sliding");
    let scene_of_thread = still.clone();
    let sliding = interrupt::left_behind(bar, move |watch| Sliding::of(&scene_of_thread, watch));
    let Some(sliding) = sliding.transpose()?.flatten() else {
        return Err(Box::new(Interrupted));
    };
    let mut folder = Folder::open_shared(common, *shared, "report", (&scene, &source), settings)?;
    let design = Design {
        scene: &still,
        parameters: &parameters,
        state: None,
        scramblings: FEWEST_SCRAMBLINGS,
        points: plan.points,
        seed: scatter.seed,
        has_indices: plan.has_indices,
    };
    let prepare = |scene: &mut Scene| prepared_again(scene, common, options);
    let pushes = velocity.as_ref().map(|velocity| Pushes {
        scene: &still,
        parameters: &parameters,
        velocity,
        prepare: &prepare,
        runs: scatter.runs,
        seed: scatter.seed,
        name: "run",
    });
    let found = folder.found(|journal, watch| {
        // Workers share the pieces of all parts in one round, but those of a motion after a change.
        let part =
            |[from, to]: [f64; 2]| move |part: f64| (watch.progress)(from + (to - from) * part);
        let [first, second, third] = PARTS.map(part);
        let [first, second, third] = [
            Watch { progress: &first, ..watch },
            Watch { progress: &second, ..watch },
            Watch { progress: &third, ..watch },
        ];
        let loud = match &motions {
            Ok(motions) => known(motions.found(&observation, journal, first), watch)?,
            Err(reason) => Some(Err(reason.clone())),
        };
        let robust = known(both(&design, None, pushes.as_ref(), journal, second), watch)?;
        let changed = Changed {
            scene: &scene,
            still: &still,
            changes: changes(&sliding),
            given: &scatter.uncertain,
            plan,
            seed: scatter.seed,
            motions: motions.as_ref().ok().filter(|_| !matches!(loud, Some(Err(_)))),
            observation: &observation,
        };
        let known_loud = loud.as_ref().and_then(|loud| loud.as_ref().ok());
        let after = changed.found(known_loud, journal, third)?;
        Ok(loud.zip(robust).zip(after))
    })?;
    let Some(((loud, robustness), after)) = found else { return Ok(()) };
    let loudness = motions.and_then(|Motions { ways, question, .. }| {
        Ok(Loud { ways, push: question.push, found: loud? })
    });
    let report = Report {
        arguments,
        scene: &scene,
        still: &still,
        observation: &observation,
        assumptions: &assumptions,
        parameters: &parameters,
        plan,
        sliding,
        loudness,
        robustness,
        after,
    };
    let page = report.page();
    folder.write_csv(&rows::HEAD, rows::rows(&report))?;
    folder.write_json(report.as_json())?;
    let path = folder.path().join("report.html");
    report::write(&page, &path)?;
    for answer in &page.answers {
        say!("{}", answer.question);
        answer.text.iter().for_each(|said| say!("  {said}"));
    }
    say!("\nthe page is {}", path.display());
    Ok(())
}

/// The result of a part of the study, or the reason why it is unknown: a part that fails is told in its place, and the others stay.
/// `None` if the watch ended it, or if pieces of other workers are missing.
///
/// # Errors
/// Returns the error of a file that cannot be written.
fn known<T>(
    found: Result<Option<T>, Error>,
    watch: Watch<'_>,
) -> Result<Option<Result<T, String>>, Error> {
    match found {
        Ok(found) => Ok(found.map(Ok)),
        Err(error) if error.is_file() => Err(error),
        Err(_) if watch.is_over() => Ok(None),
        Err(error) => Ok(Some(Err(error.to_string()))),
    }
}

/// The changes that were computed anew.
fn changes(sliding: &Sliding) -> &[Change] {
    let changes = sliding.found.as_ref().ok().and_then(|found| found.changes.as_ref().ok());
    changes.map_or(&[], Vec::as_slice)
}

/// A number to four digits, with a minus sign that is one.
fn number(value: f64) -> String {
    // Powers of ten keep the sign of command lines.
    if value < 0.0 { format!("−{}", four(-value)) } else { four(value) }
}

/// A probability and the ends of its interval, in per cent.
fn per_cent(Estimate { value, low, high }: &Estimate) -> [String; 3] {
    [value, low, high].map(|part| digits(100.0 * part, 3))
}

impl Report<'_> {
    /// The probabilities, where they are known.
    fn probabilities(&self) -> Option<&Both> {
        self.robustness.as_ref().ok()
    }

    fn page(&self) -> Page {
        let scene = self.scene;
        let mut lead = Vec::new();
        if !scene.description.is_empty() {
            lead.push(format!("{}.", scene.description.trim_end_matches('.')));
        }
        lead.extend(signals_left_out(scene, 0.0).map(|said| format!("Signals: {said}.")));
        Page {
            title: format!("{}: does it squeal?", scene.name),
            lead,
            answers: answers::answers(self),
            sections: sections::SECTIONS.iter().map(|section| section(self)).collect(),
            footer: format!(
                "Made by amontons {}. SI units: m, s, kg, N; growth rates in 1/s.",
                env!("CARGO_PKG_VERSION")
            ),
        }
    }

    fn as_json(&self) -> serde_json::Value {
        let (loudness, unknown) = match &self.loudness {
            Ok(loud) => (Some(&loud.found), None),
            Err(reason) => (None, Some(reason)),
        };
        json!({
            "sliding": self.sliding.as_json(),
            "loudness": loudness,
            "loudness_unknown": unknown,
            "points": self.plan.points,
            "robustness": self.probabilities().map(|both| &both.eigenvalues),
            "runs": self.probabilities().map(|both| &both.runs),
            "robustness_unknown": self.robustness.as_ref().err(),
            "after_changes": self.after.as_json(),
        })
    }
}
