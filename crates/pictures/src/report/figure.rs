//! A figure of a report: its picture, its caption, its data as tables.

use super::listing::listings;
use super::markup::{add, breakable, plain_table, sheet, text};
use super::thin::kept;
use super::{Content, Figure};
use crate::picture::{Chart, Series};
use amontons::Error;

/// The HTML of a figure; `number` counts from 1.
///
/// # Errors
/// Returns an error if the picture cannot be drawn.
pub(super) fn figure(figure: &Figure, number: usize) -> Result<String, Error> {
    let id = format!("figure-{number}");
    let (title, svg) = match &figure.content {
        Content::Chart(chart) => (&chart.title, thinned(chart).svg()?),
        Content::Map(map) => (&map.title, map.svg()?),
        Content::Structure(structure) => (&structure.title, structure.svg()?),
        Content::Bars(bars) => (&bars.title, bars.svg()?),
    };
    let mut html = format!("<figure id=\"{id}\" aria-labelledby=\"{id}-title\">\n");
    add(&mut html, format_args!("<h3 class=\"unseen\" id=\"{id}-title\">{}</h3>\n", text(title)));
    sheet(&mut html, &format!("{id}-title"), &svg);
    add(&mut html, format_args!("<figcaption>\n<p>{}</p>\n", text(&figure.caption)));
    if let Some(command) = &figure.command {
        add(
            &mut html,
            format_args!("<p class=\"command\">Made by <code>{}</code></p>\n", text(command)),
        );
    }
    html += "</figcaption>\n<details>\n<summary>The data as a table</summary>\n";
    let listings = listings(&figure.content);
    for (place, listing) in listings.tables.iter().enumerate() {
        let id = format!("{id}-data-{}", place + 1);
        let rows = listing.rows.iter().map(|row| row.iter().map(|cell| breakable(cell)));
        plain_table(&mut html, &id, &text(&listing.caption()), &listing.head, rows);
    }
    for note in &listings.notes {
        add(&mut html, format_args!("<p>{}</p>\n", text(note)));
    }
    html += "</details>\n</figure>\n";
    Ok(html)
}

/// The chart with those points of its curves that can be told apart.
fn thinned(chart: &Chart) -> Chart {
    let mut thinned = chart.clone();
    for series in thinned.panels.iter_mut().flat_map(|panel| &mut panel.series) {
        let kept = kept(series, chart.logarithmic);
        let points = kept.iter().map(|&place| series.points[place]).collect();
        let labels = kept.iter().filter_map(|&place| series.labels.get(place).cloned()).collect();
        *series = Series { points, labels, ..std::mem::take(series) };
    }
    thinned
}
