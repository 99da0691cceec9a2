//! `amontons study loudness`.

use super::arguments::{ObservationOptions, StudyArguments};
use super::folder::{Folder, quoted};
use super::{heading, prepared};
use crate::arguments::positive;
use amontons::decimal::to_significant;
use amontons::error::Short;
use amontons::scene::Scene;
use amontons_analysis::study::loudness::{
    Attempt, FoundMotion, Loudness as Found, LoudnessQuestion, Measured, Row, Unexamined, Ways,
    check_undriven, loudness, measured_points, ways,
};
use amontons_analysis::study::{Kind, ObservationSettings, Push};
use amontons_cli::charts::loudness::chart;
use amontons_cli::interrupt::{self, Interrupted};
use amontons_cli::progress::Progress;
use amontons_cli::say;
use amontons_cli::shards::ShardArguments;
use amontons_export::documentation::counted;
use clap::Args;
use serde_json::json;
use std::error::Error;

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
fn searched(scene: &Scene, most: usize) -> Result<Ways, Box<dyn Error>> {
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

/// A number to four digits.
fn four(value: f64) -> String {
    let rounded = to_significant(value, 4);
    if rounded != 0.0 && !(1e-2..1e4).contains(&rounded.abs()) {
        format!("{rounded:.3e}")
    } else {
        Short(rounded).to_string()
    }
}

fn print(
    scene: &Scene,
    ways: &Ways,
    found: &Found,
    (observation, push): (&ObservationSettings, f64),
) {
    say!("{}: µ = {}", scene.name, Short(scene.friction_coefficient));
    say!("{}", heading(&[(scene, observation)]));
    match (found.grows, found.rows.len()) {
        (true, count) => say!(
            "{} of uniform sliding; each starts with a velocity amplitude of {} m/s",
            counted(count, "growing mode", "growing modes"),
            four(push)
        ),
        (false, 0) if ways.unexamined.is_some() => say!("no mode of uniform sliding grows"),
        (false, 0) => say!("no mode of uniform sliding grows, and there is no candidate to push"),
        (false, count) => say!(
            "no mode of uniform sliding grows; {} for a second motion, pushed along the growing mode of another contact state",
            counted(count, "candidate", "candidates")
        ),
    }
    match ways.unexamined {
        Some(Unexamined::Contacts(contacts)) => {
            say!(
                "candidates were not looked for: {contacts} contacts have too many contact states"
            );
        }
        Some(Unexamined::Candidates(left)) => say!(
            "{left} more candidates were not pushed, those that need the most energy; --candidates {} includes them",
            ways.ways.len() + left
        ),
        None => {}
    }
    if found.rows.is_empty() {
        say!(
            "small motions die out; a larger one may still exist, since stick-slip needs no growing mode: `amontons study \
             continuation` looks for motions over µ"
        );
        return;
    }
    table(found);
    for (place, motion) in found.motions.iter().enumerate() {
        print_motion(place, motion, found);
    }
    if !found.findings.is_empty() {
        say!("\ngrowth and loudness");
        found.findings.iter().for_each(|finding| say!("  {finding}"));
    }
}

/// The table: growth on the left, the motion on the right.
fn table(found: &Found) {
    say!(
        "\n{:<13}  {:<8} {:>9} {:>10} {:>5}   {:>6} {:>9} {:>11} {:>11} {:>11} {:>9}",
        "way",
        "states",
        "f [Hz]",
        "rate [1/s]",
        "rank",
        "motion",
        "f [Hz]",
        "rms [m/s]",
        "normal",
        "J a cycle",
        "loudness",
    );
    for row in &found.rows {
        let dash = || "-".to_owned();
        let attempt = row.attempt();
        let motion = attempt.motion.map(|motion| &found.motions[motion]);
        let measured = motion.and_then(|motion| motion.measured.as_ref());
        let normal = measured.and_then(Measured::loudest_along_normal);
        let energy = measured.and_then(|measured| measured.power.as_ref()?.energy);
        let frequency = motion.and_then(|motion| motion.ending.frequency);
        say!(
            "{:<13}  {:<8} {:>9.2} {:>10} {:>5}   {:>6} {:>9} {:>11} {:>11} {:>11} {:>9}",
            row.way.name(),
            row.way.states,
            row.way.frequency,
            four(row.way.growth_rate),
            row.growth_rank,
            attempt.motion.map_or_else(dash, |motion| (motion + 1).to_string()),
            frequency.map_or_else(dash, |frequency| format!("{frequency:.2}")),
            measured.map_or_else(dash, |measured| four(measured.loudest().rms)),
            normal.and_then(|point| point.normal_rms).map_or_else(dash, four),
            energy.map_or_else(dash, four),
            row.loudness_rank.map_or_else(|| unranked(row), |rank| rank.to_string()),
        );
    }
    say!(
        "\nrms: root mean square of the speed of the fastest point; normal: that along the normal of a contact's surface; J a \
         cycle: energy that friction feeds in during one period"
    );
}

/// The reason why a row has no rank of loudness.
fn unranked(row: &Row) -> String {
    match row.attempt().ending.as_ref().map(|ending| ending.kind) {
        None => "failed",
        Some(Kind::Equilibrium) => "rests",
        Some(Kind::Unbounded) => "unbounded",
        Some(_) => "unknown",
    }
    .to_owned()
}

fn print_motion(place: usize, motion: &FoundMotion, found: &Found) {
    let leads = |row: &Row| {
        let attempt = row.attempts.iter().find(|attempt| attempt.motion == Some(place))?;
        let push = if found.grows {
            String::new()
        } else {
            format!(" pushed by {} m/s", four(attempt.push))
        };
        Some(format!("{}{push}", row.way.name()))
    };
    let names: Vec<String> = found.rows.iter().filter_map(leads).collect();
    let FoundMotion { ending, measured, nearest } = motion;
    let kind = match ending.kind {
        Kind::Equilibrium => "rest",
        kind => kind.name(),
    };
    let period =
        ending.period.map_or_else(String::new, |period| format!(", period {} s", four(period)));
    say!("\nmotion {}: {kind}{period}; from {}", place + 1, names.join(", "));
    let Some(measured) = measured else { return };
    if let Some(nearest) = nearest {
        say!(
            "  its frequency is nearest to that of mode {} ({:.2} Hz), which has {:.0} % of the kinetic energies of all modes",
            nearest.numbers(),
            nearest.frequency,
            100.0 * nearest.share
        );
    }
    if let Some(strongest) = motion.strongest() {
        say!(
            "  mode {} ({:.2} Hz) has the largest share, {:.0} %",
            strongest.numbers(),
            strongest.frequency,
            100.0 * strongest.share
        );
    }
    let states = measured.states.iter();
    let states = states.map(|taken| format!("{} {:.1} %", taken.states, 100.0 * taken.share));
    say!("  contact states: {}", states.collect::<Vec<_>>().join(", "));
    for point in &measured.points {
        let normal = point.normal_rms.zip(point.normal_peak);
        let normal = normal.map_or_else(String::new, |(rms, peak)| {
            format!("; along the normal {} and {} m/s", four(rms), four(peak))
        });
        say!(
            "  {}: amplitude {} m, speed {} m/s rms and {} m/s at most{normal}",
            point.point,
            four(point.amplitude),
            four(point.rms),
            four(point.peak)
        );
    }
    let over = if measured.is_period { "one period" } else { "a window; the motion has no period" };
    say!(
        "  measured over {} s, {over}; rms to {:.0e} of itself",
        four(measured.span),
        measured.rms_error.max(1e-15)
    );
    let Some(power) = &measured.power else {
        say!("  powers are unknown: a structure with circulatory forces has no energy ledger");
        return;
    };
    for one in &power.contacts {
        let energy =
            one.energy.map_or_else(String::new, |energy| format!(", {} J a cycle", four(energy)));
        say!("  {}: friction feeds in {} W{energy}", one.contact, four(one.power));
    }
    say!(
        "  all contacts {} W; dampers take {} W, impacts {} W",
        four(power.friction),
        four(power.damping),
        four(power.impact)
    );
    say!(
        "  check: the contacts miss the energy ledger by {:.0e}, and the balance by {:.0e}, of the largest power",
        power.mismatch.max(1e-16),
        power.unbalanced.max(1e-16)
    );
}
