//! The limits of the page, and the commands that give the same numbers.

use super::super::Report;
use super::super::number as four;
use amontons_analysis::study::loudness::Unexamined;
use amontons_pictures::report::Section;

pub fn section(report: &Report<'_>) -> Section {
    Section {
        heading: "Limits, and how to repeat it".to_owned(),
        text: vec!["These commands give the numbers of this page, and more of them.".to_owned()],
        points: points(report),
        commands: commands(report),
        ..Section::default()
    }
}

fn points(report: &Report<'_>) -> Vec<String> {
    let mut points = vec![
        "Eigenvalues are those of small motions about uniform sliding. They say nothing of large ones.".to_owned(),
        "A motion that no growing mode and no candidate leads to is not found; stick-slip needs neither. The command \
         amontons study continuation looks for motions over µ, amontons study perturbation after pushes of all sizes."
            .to_owned(),
    ];
    if let Ok(loud) = &report.loudness {
        if loud.found.grows {
            points.push(format!(
                "Each growing mode has one start, with a velocity of {} m/s. A larger start may lead to another motion. Contact \
                 states other than uniform sliding were not searched for candidates, since a mode grows.",
                four(loud.push)
            ));
        }
        match loud.ways.unexamined {
            Some(Unexamined::Contacts(contacts)) => points.push(format!(
                "Candidates were not looked for: {contacts} contacts have too many contact states."
            )),
            Some(Unexamined::Candidates(left)) => {
                points.push(format!(
                    "{left} more candidates, which need the most energy, were not pushed."
                ));
            }
            None => {}
        }
    }
    let [has_draws, has_runs] = has(report);
    if has_draws {
        points.push(
            "Probabilities are those of growing modes of uniform sliding in draws that are independent of each other. Parts of one \
             batch, which vary together, are not."
                .to_owned(),
        );
    }
    if !has_runs {
        points.push(
            "The probability that a push makes the scene squeal was not computed: --pushes 'uniform(0,0.1)' does that.".to_owned(),
        );
    }
    points.push(
        "Velocities are those of the structure. The sound in a room, and its level in dB, are not computed.".to_owned(),
    );
    points
}

/// `true` if there are probabilities from eigenvalues, and if there are some from runs.
fn has(report: &Report<'_>) -> [bool; 2] {
    let both = report.probabilities();
    [
        both.is_some_and(|both| both.eigenvalues.is_some()),
        both.is_some_and(|both| both.runs.is_some()),
    ]
}

/// The scene as a command line has it, with its changed values.
pub fn scene_words(report: &Report<'_>) -> String {
    let common = &report.arguments.common;
    let set = common.set.iter().map(|(name, value)| format!(" --set '{name}={value}'"));
    quoted(&common.scene) + &set.collect::<String>()
}

fn commands(report: &Report<'_>) -> Vec<String> {
    let common = &report.arguments.common;
    let scene = scene_words(report);
    let mut look = report.arguments.options.words();
    look += &common.integrator.words();
    let mut all = vec![format!("amontons-stability states {scene}")];
    if let Ok(over) = &report.sliding.over_friction {
        let [from, to] = [over.locus.values[0], over.end];
        // The locus itself does not take the scene's µ.
        let others =
            common.set.iter().filter(|(name, _)| name != amontons_analysis::assign::FRICTION);
        let others: String =
            others.map(|(name, value)| format!(" --set '{name}={value}'")).collect();
        let count = over.locus.values.len();
        all.push(format!(
            "amontons-stability locus {}{others} --friction {from}:{to}/{count}",
            quoted(&common.scene)
        ));
        all.push(format!("amontons-stability sensitivity {scene} --critical {from}:{to}"));
    } else {
        all.push(format!("amontons-stability sensitivity {scene}"));
    }
    if report.loudness.is_ok() {
        all.push(format!("amontons study loudness {scene}{look}"));
    }
    let scatter = &report.arguments.scatter;
    if has(report).contains(&true) {
        let pushes = scatter.pushes.as_ref();
        let pushes = pushes.map_or_else(String::new, |pushes| {
            format!(" --pushes '{pushes}' --runs {}{look}", scatter.runs)
        });
        all.push(format!(
            "amontons study robustness {scene}{} --points {}{} --seed {}{pushes}",
            report.assumptions.options(),
            report.plan.points,
            if report.plan.has_indices { "" } else { " --no-indices" },
            scatter.seed
        ));
    }
    all
}

/// A name as a shell takes it.
fn quoted(name: &str) -> String {
    let is_plain = |letter: char| letter.is_alphanumeric() || "._-/".contains(letter);
    if name.chars().all(is_plain) {
        name.to_owned()
    } else {
        format!("'{}'", name.replace('\'', "'\\''"))
    }
}
