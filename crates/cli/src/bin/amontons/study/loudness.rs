//! `amontons study loudness`.

use super::arguments::{ObservationOptions, StudyArguments};
use super::folder::{Folder, quoted};
use super::{heading, prepared};
use crate::arguments::positive;
use amontons::error::Short;
use amontons::scene::Scene;
use amontons_analysis::study::loudness::{
    Attempt, Loudness as Found, LoudnessQuestion, Measured, Row, Ways, check_undriven, loudness,
    measured_points, ways,
};
use amontons_analysis::study::{ObservationSettings, Push};
use amontons_cli::charts::loudness::chart;
use amontons_cli::interrupt::{self, Interrupted};
use amontons_cli::progress::Progress;
use amontons_cli::say;
use amontons_cli::shards::ShardArguments;
use amontons_cli::words::loudness as words;
use clap::Args;
use serde_json::json;
use std::error::Error;
use std::fmt::Display;

#[derive(Args)]
pub struct Loudness {
    #[command(flatten)]
    common: StudyArguments,
    #[command(flatten)]
    shared: ShardArguments,
    #[command(flatten)]
    options: ObservationOptions,
    /// Largest velocity amplitude of the start along each growing mode, m/s [default: a thousandth of the fastest surface's velocity]
    #[arg(long, value_name = "M/S", value_parser = positive, allow_hyphen_values = true)]
    push: Option<f64>,
    /// Points whose motion is measured: module[1].m2 in a ring, a mass such as pad or a node such as pad.17 in a network
    /// [default: all masses with a contact, on both sides, and the nodes that the scene shows]
    #[arg(long, value_name = "NAME,..", value_delimiter = ',')]
    points: Vec<String>,
    /// Largest number of candidates that are pushed, those that need the least energy first
    #[arg(long, value_name = "N", default_value_t = 20)]
    candidates: usize,
}

pub fn run(arguments: &Loudness) -> Result<(), Box<dyn Error>> {
    let Loudness { common, shared, options, push, points, candidates } = arguments;
    let (mut scene, source, observation) = prepared(common, options)?;
    check_undriven(&scene)?;
    scene.rest();
    let points = measured_points(&scene, points)?;
    let found = searched(&scene, *candidates)?;
    let push = push.unwrap_or_else(|| Push::of(&scene).velocity);
    let names: Vec<&str> = points.iter().map(|point| &*point.name).collect();
    let settings = json!({ "push": push, "points": names, "look": observation });
    let question = LoudnessQuestion { push, points: points.clone() };
    let mut folder = Folder::open_shared(common, *shared, "loudness", (&scene, &source), settings)?;
    let results = folder.found(|journal, watch| {
        loudness(&scene, &found, &question, &observation, journal, watch)
    })?;
    let Some(results) = results else { return Ok(()) };
    folder.write_csv(&HEAD, results.rows.iter().map(|row| csv(row, &results)))?;
    folder.write_json(json!({ "push": push, "points": names, "found": results }))?;
    print(&scene, &found, &results, (&observation, push));
    if results.rows.is_empty() {
        say!("\nresults are in {}", folder.path().display());
        return Ok(());
    }
    folder.draw("loudness", &chart(&scene, &results))?;
    say!("\nresults and the picture are in {}", folder.path().display());
    Ok(())
}

/// The ways out of uniform sliding, under a bar: with many contacts candidates take a while.
///
/// # Errors
/// Returns an error as [`ways`] does, or [`Interrupted`] if the user ends the search.
pub(super) fn searched(scene: &Scene, most: usize) -> Result<Ways, Box<dyn Error>> {
    let bar = Progress::in_parts("the candidates");
    let found = interrupt::watched(&bar, |watch| ways(scene, most, watch));
    if found.is_err() && interrupt::stopped().is_break() {
        return Err(Box::new(Interrupted));
    }
    Ok(found?)
}

const HEAD: [&str; 23] = [
    "way",
    "states",
    "frequency",
    "growth_rate",
    "growth_rank",
    "push",
    "kind",
    "motion",
    "motion_frequency",
    "period",
    "point",
    "velocity_rms",
    "velocity_peak",
    "amplitude",
    "normal_point",
    "normal_velocity_rms",
    "normal_velocity_peak",
    "power_of_friction",
    "energy_per_cycle",
    "power_of_dampers",
    "nearest_mode",
    "share",
    "loudness_rank",
];

fn csv(row: &Row, found: &Found) -> [String; 23] {
    let value = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:?}"));
    let place = |place: Option<usize>| place.map_or_else(String::new, |place| place.to_string());
    let Attempt { push, ending, motion, .. } = row.attempt();
    let found = motion.map(|motion| &found.motions[motion]);
    let measured = found.and_then(|found| found.measured.as_ref());
    let nearest = found.and_then(|found| found.nearest.as_ref());
    let loudest = measured.map(Measured::loudest);
    let normal = measured.and_then(Measured::loudest_along_normal);
    let power = measured.and_then(|measured| measured.power.as_ref());
    let ending = ending.as_ref();
    [
        row.way.name(),
        row.way.states.clone(),
        format!("{:?}", row.way.frequency),
        format!("{:?}", row.way.growth_rate),
        row.growth_rank.to_string(),
        format!("{push:?}"),
        ending.map_or("failed", |ending| ending.kind.name()).to_owned(),
        place(motion.map(|motion| motion + 1)),
        value(ending.and_then(|ending| ending.frequency)),
        value(ending.and_then(|ending| ending.period)),
        loudest.map_or_else(String::new, |point| quoted(&point.point)),
        value(loudest.map(|point| point.rms)),
        value(loudest.map(|point| point.peak)),
        value(loudest.map(|point| point.amplitude)),
        normal.map_or_else(String::new, |point| quoted(&point.point)),
        value(normal.and_then(|point| point.normal_rms)),
        value(normal.and_then(|point| point.normal_peak)),
        value(power.map(|power| power.friction)),
        value(power.and_then(|power| power.energy)),
        value(power.map(|power| power.damping)),
        nearest.map_or_else(String::new, |nearest| nearest.numbers()),
        value(nearest.map(|nearest| nearest.share)),
        place(row.loudness_rank),
    ]
}

fn print(
    scene: &Scene,
    ways: &Ways,
    found: &Found,
    (observation, push): (&ObservationSettings, f64),
) {
    say!("{}: µ = {}", scene.name, Short(scene.friction_coefficient));
    say!("{}", heading(&[(scene, observation)]));
    words::starts(ways, found, push).iter().for_each(|said| say!("{said}"));
    if found.rows.is_empty() {
        return;
    }
    table(found);
    for (place, motion) in found.motions.iter().enumerate() {
        say!("\n{}", words::motion_title(place, motion, found));
        words::motion_lines(motion).iter().for_each(|line| say!("  {line}"));
    }
    if !found.findings.is_empty() {
        say!("\ngrowth and loudness");
        found.findings.iter().for_each(|finding| say!("  {finding}"));
    }
}

/// The table: growth on the left, the motion on the right.
fn table(found: &Found) {
    say!("\n{}", line(&words::HEAD));
    found.rows.iter().for_each(|row| say!("{}", line(&words::cells(row, found))));
    say!("\n{}", words::COLUMNS);
}

fn line(cells: &[impl Display; 11]) -> String {
    let [way, states, frequency, rate, rank, motion, of_motion, rms, normal, energy, loudness] =
        cells;
    format!(
        "{way:<13}  {states:<8} {frequency:>9} {rate:>10} {rank:>5}   {motion:>6} {of_motion:>9} {rms:>11} {normal:>11} \
         {energy:>11} {loudness:>9}"
    )
}
