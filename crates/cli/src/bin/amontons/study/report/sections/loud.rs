//! How loud: the motions that growing modes or candidates lead to.

use super::super::Report;
use super::{cell, figure, sentence, table};
use crate::study::heading;
use amontons_analysis::study::loudness::FoundMotion;
use amontons_cli::charts::loudness::chart;
use amontons_cli::words::loudness as words;
use amontons_pictures::report::{Cell, Content, Section};

pub const HEADING: &str = "How loud is it, and at which frequencies?";

/// Names of the columns of the table of starts: those of the command, in full.
const HEAD: [&str; 11] = [
    "Start along",
    "Contact states",
    "Mode [Hz]",
    "Growth rate [1/s]",
    "Rank by growth",
    "Motion",
    "Motion [Hz]",
    "Speed, rms [m/s]",
    "Along the normal, rms [m/s]",
    "Energy a cycle [J]",
    "Rank by loudness",
];
const CAPTION: &str = "Growth on the left; on the right the motion that it leads to, with the speed of its fastest point, the velocity along \
                       the normal of a contact, and the energy that friction feeds in during one period";

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
        "Measured points are the masses and nodes with a contact, and the nodes that the scene shows: amontons study loudness --points \
         measures others."
            .to_owned(),
    );
    section.text.push(
        "Loudness here is a velocity of the structure, not a sound level: that needs a radiating surface, a distance and a reference."
            .to_owned(),
    );
    section.text.extend(found.findings.iter().map(|said| sentence(said)));
    let typeset = |text: String| if text == "-" { "–".to_owned() } else { text };
    let row = |row: &_| words::cells(row, found).map(|text| cell(typeset(text), false)).to_vec();
    let rows: Vec<Vec<Cell>> = found.rows.iter().map(row).collect();
    section.key_tables.push(table(CAPTION, &HEAD, rows));
    for (place, motion) in found.motions.iter().enumerate() {
        let title = sentence(&words::motion_title(place, motion, found));
        match &motion.measured {
            None => section.points.push(title),
            Some(measured) => {
                let rows = measured.points.iter();
                let rows = rows.map(|one| words::point_cells(one).map(Cell::from).to_vec());
                section.tables.push(table(
                    title.trim_end_matches('.'),
                    &words::POINT_HEAD,
                    rows.collect(),
                ));
                section.points.extend(lines(place, motion));
            }
        }
    }
    let caption = "Growth rates of modes over their frequencies (above), and the speeds of the motions that they lead to (below). A mode \
                   has the colour of its motion.";
    section.figures.push(figure(caption, Content::Chart(chart(report.scene, found))));
    section
}

/// The lines on a motion besides those on its points.
fn lines(place: usize, motion: &FoundMotion) -> Vec<String> {
    let Some(measured) = &motion.measured else { return Vec::new() };
    let lines =
        words::state_lines(motion, measured).into_iter().chain(words::power_lines(measured));
    lines.map(|line| format!("Motion {}: {line}.", place + 1)).collect()
}
