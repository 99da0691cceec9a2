//! Errors, the table, the verdict and the numbers as CSV.

use crate::ours;
use crate::peer::Outcome;
use std::fmt::Write as _;
use std::path::Path;

/// One line of a table.
#[derive(Clone, Debug)]
pub struct Row {
    pub who: &'static str,
    pub setting: String,
    /// Relative rms of all displacements in all rows.
    pub error: f64,
    pub events: Option<u64>,
    pub touch_downs: Option<u64>,
    /// The shortest of each slice in all turns, s.
    pub seconds: f64,
    /// Turns that were timed.
    pub turns: usize,
}

impl Row {
    pub fn new(
        who: &'static str,
        setting: String,
        outcome: &Outcome,
        turns: usize,
        exact: &[f64],
    ) -> Self {
        Self {
            who,
            setting,
            error: error(&outcome.displacements, exact),
            events: outcome.events,
            touch_downs: outcome.touch_downs,
            seconds: outcome.slices.iter().sum(),
            turns,
        }
    }

    fn is_ours(&self) -> bool {
        [ours::EVENT_DRIVEN, ours::SCHEME].contains(&self.who)
    }
}

/// √(Σ (x − exact)² / Σ exact²).
pub fn error(x: &[f64], exact: &[f64]) -> f64 {
    assert_eq!(x.len(), exact.len(), "rows are missing");
    let square = |sum, x: f64| sum + x * x;
    let apart = x.iter().zip(exact).map(|(x, exact)| x - exact).fold(0.0, square);
    (apart / exact.iter().copied().fold(0.0, square)).sqrt()
}

/// The quickest of these that is at least so accurate.
fn quickest<'a>(rows: impl Iterator<Item = &'a Row>, accuracy: f64) -> Option<&'a Row> {
    rows.filter(|row| row.error <= accuracy).min_by(|a, b| a.seconds.total_cmp(&b.seconds))
}

/// How many times as long as our quickest run that is as accurate; `None` where there is none.
fn ratio(row: &Row, rows: &[Row]) -> Option<f64> {
    let ours = quickest(rows.iter().filter(|row| row.is_ours()), row.error)?;
    Some(row.seconds / ours.seconds)
}

fn count(count: Option<u64>) -> String {
    count.map_or_else(|| "–".to_owned(), |count| count.to_string())
}

/// The table as text.
pub fn table(rows: &[Row]) -> String {
    let mut text = format!(
        "{:26} {:32} {:>8} {:>7} {:>11} {:>10} {:>9} {:>6}\n",
        "who", "setting", "error", "events", "touch-downs", "ms/s", "to ours", "turns"
    );
    for row in rows {
        let ratio = ratio(row, rows).map_or_else(|| "–".to_owned(), |ratio| format!("{ratio:.2}"));
        let _ = writeln!(
            text,
            "{:26} {:32} {:8.1e} {:>7} {:>11} {:10.2} {:>9} {:6}",
            row.who,
            row.setting,
            row.error,
            count(row.events),
            count(row.touch_downs),
            1e3 * row.seconds,
            ratio,
            row.turns,
        );
    }
    text
}

/// Who is the quickest to reach each accuracy, and by how much.
pub fn verdict(rows: &[Row]) -> String {
    let mut text = String::new();
    for digits in 2..=10 {
        let accuracy = 10_f64.powi(-digits);
        let ours = quickest(rows.iter().filter(|row| row.is_ours()), accuracy);
        let theirs = quickest(rows.iter().filter(|row| !row.is_ours()), accuracy);
        let name =
            |row: &Row| format!("{} ({}) in {:.2} ms", row.who, row.setting, 1e3 * row.seconds);
        let line = match (ours, theirs) {
            (None, None) => "nobody".to_owned(),
            (Some(ours), None) => format!("{}; no peer", name(ours)),
            (None, Some(theirs)) => format!("NOT OURS: {}; we do not reach it", name(theirs)),
            (Some(ours), Some(theirs)) if ours.seconds <= theirs.seconds => {
                let times = theirs.seconds / ours.seconds;
                format!("{}; next {}, {times:.1} times as long", name(ours), name(theirs))
            }
            (Some(ours), Some(theirs)) => {
                let times = ours.seconds / theirs.seconds;
                format!("NOT OURS: {}; {}, {times:.1} times as long", name(theirs), name(ours))
            }
        };
        let _ = writeln!(text, "  1e-{digits:<3} {line}");
    }
    text
}

/// The table of the book, in Markdown: for each accuracy our time, scene by scene, and how many times as
/// long each peer takes.
pub fn summary(scenes: &[(&str, Vec<Row>)]) -> String {
    let mut peers: Vec<&str> = Vec::new();
    for row in scenes.iter().flat_map(|(_, rows)| rows).filter(|row| !row.is_ours()) {
        if !peers.contains(&row.who) {
            peers.push(row.who);
        }
    }
    let names: Vec<&str> = scenes.iter().map(|(name, _)| *name).collect();
    let mut text = format!("| error ({}) | Amontons |", names.join(", "));
    for peer in &peers {
        let _ = write!(text, " {peer} |");
    }
    text += &format!("\n|{}\n", " --- |".repeat(2 + peers.len()));
    for digits in 2..=10 {
        let accuracy = 10_f64.powi(-digits);
        // One entry a scene; `of` says what stands there for the quickest of ours and of theirs.
        let cell = |who: &dyn Fn(&Row) -> bool, of: &dyn Fn(&Row, &Row) -> String| {
            let entry = |(_, rows): &(&str, Vec<Row>)| {
                let ours = quickest(rows.iter().filter(|row| row.is_ours()), accuracy)?;
                Some(of(ours, quickest(rows.iter().filter(|row| who(row)), accuracy)?))
            };
            let entries = scenes.iter().map(|scene| entry(scene).unwrap_or_else(|| "–".to_owned()));
            let entries: Vec<String> = entries.collect();
            if entries.iter().all(|entry| entry == "–") {
                "–".to_owned()
            } else {
                entries.join(", ")
            }
        };
        let ours = cell(&Row::is_ours, &|ours, _| format!("{:.1}", 1e3 * ours.seconds));
        let _ = write!(text, "| 1e-{digits} | {ours} ms |");
        for peer in &peers {
            let ratio = |ours: &Row, theirs: &Row| {
                let ratio = theirs.seconds / ours.seconds;
                if ratio < 10.0 { format!("{ratio:.1}") } else { format!("{ratio:.0}") }
            };
            let _ = write!(text, " {} |", cell(&|row| row.who == *peer, &ratio));
        }
        text.push('\n');
    }
    text
}

/// Writes all numbers of all scenes.
pub fn write_csv(scenes: &[(&str, Vec<Row>)], path: &Path) -> csv::Result<()> {
    let mut writer = csv::Writer::from_path(path)?;
    let header =
        ["scene", "who", "setting", "error", "events", "touch-downs", "ms", "turns", "to ours"];
    writer.write_record(header)?;
    for (scene, rows) in scenes {
        for row in rows {
            let number = |number: Option<u64>| number.map_or_else(String::new, |n| n.to_string());
            writer.write_record([
                *scene,
                row.who,
                &row.setting,
                &format!("{:e}", row.error),
                &number(row.events),
                &number(row.touch_downs),
                &(1e3 * row.seconds).to_string(),
                &row.turns.to_string(),
                &ratio(row, rows).map_or_else(String::new, |ratio| ratio.to_string()),
            ])?;
        }
    }
    writer.flush()?;
    Ok(())
}
