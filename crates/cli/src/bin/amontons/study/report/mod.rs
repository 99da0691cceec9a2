//! `amontons study report`: one page that joins stability, loudness, robustness and sensitivity of a scene.
//!
//! | file | contents |
//! | --- | --- |
//! | `assumptions` | the scatter that is assumed where none is given |
//! | `sliding` | uniform sliding: modes, modes over µ, sensitivities |
//! | `changes` | changes of the most effective parameters, computed anew |
//! | `answers` | the answers at the start of the page |
//! | `sections` | the sections of the page |
//! | `rows` | the key numbers |

mod answers;
mod assumptions;
mod changes;
mod rows;
mod sections;
mod sliding;

use super::arguments::{ObservationOptions, StudyArguments};
use super::folder::Folder;
use super::robustness::{self, Scatter};
use super::{prepared, prepared_again};
use amontons::Error;
use amontons::scene::Scene;
use amontons::simulation::at_instant;
use amontons_analysis::instant::signals_left_out;
use amontons_analysis::robustness::{
    Both, Design, FEWEST_SCRAMBLINGS, Parameter, Pushes, both, check_size, parameters,
    push_velocity,
};
use amontons_analysis::stability::{Linearised, modes};
use amontons_analysis::study::loudness::{
    Loudness, LoudnessQuestion, MeasuredPoint, Ways, loudness, measured_points, ways,
};
use amontons_analysis::study::{Journal, ObservationSettings, Push, Watch};
use amontons_cli::say;
use amontons_cli::shards::ShardArguments;
use amontons_pictures::report::{self, Page};
use assumptions::{Assumptions, Plan};
use clap::Args;
use serde_json::json;
use sliding::Sliding;

/// The largest number of candidates that are pushed, as `study loudness` has it.
const CANDIDATES: usize = 20;

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
    robustness: Both,
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
    /// Refused for a scene with signals or without an equilibrium: the reason.
    fn of(scene: &Scene) -> Result<Self, String> {
        if !scene.signals.is_empty() {
            return Err(format!(
                "{} has signals, and loudness is that of motions which start from uniform sliding under a constant drive",
                scene.name
            ));
        }
        let mut scene = scene.clone();
        scene.rest();
        let found = || -> Result<(Ways, Vec<MeasuredPoint>), Error> {
            Ok((ways(&scene, CANDIDATES, Watch::IDLE)?, measured_points(&scene, &[])?))
        };
        let (ways, points) = found().map_err(|error| error.to_string())?;
        let push = Push::of(&scene).velocity;
        Ok(Self { scene, ways, question: LoudnessQuestion { push, points } })
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
    let motions = Motions::of(&scene);
    let described: Vec<_> = parameters.iter().map(Parameter::described).collect();
    let settings = json!({
        "look": observation,
        "push": motions.as_ref().ok().map(|motions| motions.question.push),
        "uncertain": described,
        "seed": scatter.seed,
        "indices": plan.has_indices,
        "pushes": scatter.described(common, options),
    });
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
        // Workers share the pieces of both parts in one round.
        let half = |from: f64| move |part: f64| (watch.progress)(from + 0.5 * part);
        let (first, second) = (half(0.0), half(0.5));
        let loud = match &motions {
            Ok(motions) => {
                motions.found(&observation, journal, Watch { progress: &first, ..watch })?.map(Some)
            }
            Err(_) => Some(None),
        };
        let second = Watch { progress: &second, ..watch };
        let robust = both(&design, None, pushes.as_ref(), journal, second)?;
        Ok(loud.zip(robust))
    })?;
    let Some((loud, robustness)) = found else { return Ok(()) };
    let loudness = motions.map(|Motions { ways, question, .. }| Loud {
        ways,
        push: question.push,
        found: loud.expect("motions that can be followed were followed"),
    });
    let report = Report {
        arguments,
        scene: &scene,
        still: &still,
        observation: &observation,
        assumptions: &assumptions,
        parameters: &parameters,
        plan,
        sliding: Sliding::of(&still)?,
        loudness,
        robustness,
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

impl Report<'_> {
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
            "robustness": self.robustness.eigenvalues,
            "runs": self.robustness.runs,
        })
    }
}
