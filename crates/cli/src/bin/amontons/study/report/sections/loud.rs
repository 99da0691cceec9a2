//! How loud: the motions that growing modes or candidates lead to.

use super::super::Report;
use super::{cell, figure, sentence, table};
use crate::study::heading;
use amontons_cli::charts::loudness::chart;
use amontons_cli::words::loudness as words;
use amontons_pictures::report::{Cell, Content, Section};

pub const HEADING: &str = "How loud is it, and at which frequencies?";

pub fn section(report: &Report<'_>) -> Section {
    let mut section = Section { heading: HEADING.to_owned(), ..Section::default() };
    let loud = match &report.loudness {
        Err(reason) => {
            section.text.push(format!("Loudness is not known: {reason}."));
            return section;
        }
        Ok(loud) => loud,
    };
    let found = &loud.found;
    let starts = words::starts(&loud.ways, found, loud.push);
    section.text.extend(starts.iter().map(|said| sentence(said)));
    if found.rows.is_empty() {
        return section;
    }
    section
        .text
        .push(sentence(&format!("Runs: {}", heading(&[(report.scene, report.observation)]))));
    section.text.push(
        "Loudness here is a velocity of the structure, not a sound level: that needs a radiating surface, a distance and a reference."
            .to_owned(),
    );
    section.text.extend(found.findings.iter().map(|said| sentence(said)));
    let row = |row: &_| words::cells(row, found).map(|text| cell(text, false)).to_vec();
    let rows: Vec<Vec<Cell>> = found.rows.iter().map(row).collect();
    let caption =
        format!("Growth on the left, the motion that it leads to on the right. {}", words::COLUMNS);
    section.tables.push(table(sentence(&caption), &words::HEAD, rows));
    for (place, motion) in found.motions.iter().enumerate() {
        let lines = words::motion_lines(motion);
        let title = words::motion_title(place, motion, found);
        let title = if lines.is_empty() {
            sentence(&title)
        } else {
            format!("{}: ", sentence(&title).trim_end_matches('.'))
        };
        section.points.push(title + &lines.join("; "));
    }
    let caption = "Growth rates of modes over their frequencies (above), and the speeds of the motions that they lead to (below). A mode \
                   has the colour of its motion.";
    section.figures.push(figure(caption, Content::Chart(chart(report.scene, found))));
    section
}
