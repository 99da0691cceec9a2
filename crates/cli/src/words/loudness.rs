//! Loudness in words: the ways out of uniform sliding, their table, and the motions that they lead to.

use super::four;
use amontons_analysis::study::Kind;
use amontons_analysis::study::loudness::{
    FoundMotion, Loudness, Measured, PointMotion, Row, Unexamined, Ways,
};
use amontons_export::documentation::counted;

/// Names of the columns of the table.
pub const HEAD: [&str; 11] = [
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
];

/// The sentence on columns whose names do not say what they hold.
pub const COLUMNS: &str = "rms: root mean square of the speed of the fastest point; normal: that along the normal of a contact's surface; J a \
                           cycle: energy that friction feeds in during one period";

/// The sentence on a scene in which no start leads anywhere.
pub const NO_WAY: &str = "no small motion grows; a larger one may still exist, since stick-slip needs no growing mode: `amontons study \
                          continuation` looks for motions over µ";

/// Sentences on the starts: growing modes, or candidates and those that are left out. `push` is the velocity of a start along a
/// growing mode, m/s.
#[must_use]
pub fn starts(ways: &Ways, found: &Loudness, push: f64) -> Vec<String> {
    let mut said = vec![match (found.grows, found.rows.len()) {
        (true, count) => format!(
            "{} of uniform sliding; each starts with a velocity amplitude of {} m/s",
            counted(count, "growing mode", "growing modes"),
            four(push)
        ),
        (false, 0) if ways.unexamined.is_some() => "no mode of uniform sliding grows".to_owned(),
        (false, 0) => {
            "no mode of uniform sliding grows, and there is no candidate to push".to_owned()
        }
        (false, count) => format!(
            "no mode of uniform sliding grows; {} for a second motion, pushed along the growing mode of another contact state",
            counted(count, "candidate", "candidates")
        ),
    }];
    match ways.unexamined {
        Some(Unexamined::Contacts(contacts)) => said.push(format!(
            "candidates were not looked for: {contacts} contacts have too many contact states"
        )),
        Some(Unexamined::Candidates(left)) => said.push(format!(
            "{left} more candidates were not pushed, those that need the most energy; `amontons study loudness --candidates {}` \
             includes them",
            ways.ways.len() + left
        )),
        None => {}
    }
    if found.rows.is_empty() {
        said.push(NO_WAY.to_owned());
    }
    said
}

/// The cells of a row under [`HEAD`].
#[must_use]
pub fn cells(row: &Row, found: &Loudness) -> [String; 11] {
    let dash = || "-".to_owned();
    let attempt = row.attempt();
    let motion = attempt.motion.map(|motion| &found.motions[motion]);
    let measured = motion.and_then(|motion| motion.measured.as_ref());
    let normal = measured.and_then(Measured::loudest_along_normal);
    let energy = measured.and_then(|measured| measured.power.as_ref()?.energy);
    let frequency = motion.and_then(|motion| motion.ending.frequency);
    [
        row.way.name(),
        row.way.states.clone(),
        format!("{:.2}", row.way.frequency),
        four(row.way.growth_rate),
        row.growth_rank.to_string(),
        attempt.motion.map_or_else(dash, |motion| (motion + 1).to_string()),
        frequency.map_or_else(dash, |frequency| format!("{frequency:.2}")),
        measured.map_or_else(dash, |measured| four(measured.loudest().rms)),
        normal.and_then(|point| point.normal_rms).map_or_else(dash, four),
        energy.map_or_else(dash, four),
        row.loudness_rank.map_or_else(|| unranked(row), |rank| rank.to_string()),
    ]
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

/// The name of a motion, counted from 0: its kind, its period and the ways into it.
#[must_use]
pub fn motion_title(place: usize, motion: &FoundMotion, found: &Loudness) -> String {
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
    let kind = match motion.ending.kind {
        Kind::Equilibrium => "rest",
        kind => kind.name(),
    };
    let period = motion.ending.period;
    let period = period.map_or_else(String::new, |period| format!(", period {} s", four(period)));
    format!("motion {}: {kind}{period}; from {}", place + 1, names.join(", "))
}

/// Lines on what was measured of a motion: its nearest mode, contact states, points and powers.
#[must_use]
pub fn motion_lines(motion: &FoundMotion) -> Vec<String> {
    let Some(measured) = &motion.measured else { return Vec::new() };
    let mut lines = state_lines(motion, measured);
    lines.extend(measured.points.iter().map(point));
    lines.extend(power_lines(measured));
    lines
}

/// Lines on the nearest and the strongest mode of a motion, and on the states that its contacts take.
#[must_use]
pub fn state_lines(motion: &FoundMotion, measured: &Measured) -> Vec<String> {
    let mut lines = Vec::new();
    if let Some(nearest) = &motion.nearest {
        lines.push(format!(
            "its frequency is nearest to that of mode {} ({:.2} Hz), which has {:.0} % of the kinetic energies of all modes",
            nearest.numbers(),
            nearest.frequency,
            100.0 * nearest.share
        ));
    }
    if let Some(strongest) = motion.strongest() {
        lines.push(format!(
            "mode {} ({:.2} Hz) has the largest share, {:.0} %",
            strongest.numbers(),
            strongest.frequency,
            100.0 * strongest.share
        ));
    }
    let states = measured.states.iter();
    let states = states.map(|taken| format!("{} {:.1} %", taken.states, 100.0 * taken.share));
    lines.push(format!("contact states: {}", states.collect::<Vec<_>>().join(", ")));
    lines
}

/// Names of the columns of a table of points.
pub const POINT_HEAD: [&str; 6] = [
    "Point",
    "Amplitude [m]",
    "Speed, rms [m/s]",
    "Speed, at most [m/s]",
    "Along the normal, rms [m/s]",
    "Along the normal, at most [m/s]",
];

/// The cells of a point under [`POINT_HEAD`].
#[must_use]
pub fn point_cells(point: &PointMotion) -> [String; 6] {
    let normal = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), four);
    [
        point.point.clone(),
        four(point.amplitude),
        four(point.rms),
        four(point.peak),
        normal(point.normal_rms),
        normal(point.normal_peak),
    ]
}

fn point(point: &PointMotion) -> String {
    let normal = point.normal_rms.zip(point.normal_peak);
    let normal = normal.map_or_else(String::new, |(rms, peak)| {
        format!("; along the normal {} and {} m/s", four(rms), four(peak))
    });
    format!(
        "{}: amplitude {} m, speed {} m/s rms and {} m/s at most{normal}",
        point.point,
        four(point.amplitude),
        four(point.rms),
        four(point.peak)
    )
}

/// Lines on the time over which a motion was measured, and on powers.
#[must_use]
pub fn power_lines(measured: &Measured) -> Vec<String> {
    let over = if measured.is_period { "one period" } else { "a window; the motion has no period" };
    let mut lines = vec![format!(
        "measured over {} s, {over}; rms to {:.0e} of itself",
        four(measured.span),
        measured.rms_error.max(1e-15)
    )];
    let Some(power) = &measured.power else {
        lines.push(
            "powers are unknown: a structure with circulatory forces has no energy ledger"
                .to_owned(),
        );
        return lines;
    };
    let contacts = power.contacts.iter().map(|one| {
        let energy =
            one.energy.map_or_else(String::new, |energy| format!(", {} J a cycle", four(energy)));
        format!("{}: friction feeds in {} W{energy}", one.contact, four(one.power))
    });
    lines.extend(contacts);
    lines.push(format!(
        "all contacts {} W; dampers take {} W, impacts {} W",
        four(power.friction),
        four(power.damping),
        four(power.impact)
    ));
    lines.push(format!(
        "check: the contacts miss the energy ledger by {:.0e}, and the balance by {:.0e}, of the largest power",
        power.mismatch.max(1e-16),
        power.unbalanced.max(1e-16)
    ));
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The page of a report tells it too, and the command of reports has no such option.
    #[test]
    fn an_option_is_told_with_the_command_that_has_it() {
        let unexamined = Some(Unexamined::Candidates(3));
        let ways = Ways { grows: false, ways: Vec::new(), unexamined: unexamined.clone() };
        let found = Loudness {
            grows: false,
            rows: Vec::new(),
            motions: Vec::new(),
            unexamined,
            findings: Vec::new(),
        };
        let said = starts(&ways, &found, 0.1).join("; ");
        assert!(said.contains("`amontons study loudness --candidates 3` includes them"), "{said}");
    }
}
