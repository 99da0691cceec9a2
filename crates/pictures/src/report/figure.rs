//! A figure: a place for the script to draw in, its caption, its data.

use super::data::drawn;
use super::listing::listings;
use super::markup::{add, plain_table, text};
use super::{Content, Figure};
use amontons::Error;
use std::borrow::Cow;

/// # Errors
/// Those of [`drawn`].
pub(super) fn figure(figure: &Figure, number: usize) -> Result<String, Error> {
    let id = format!("figure-{number}");
    let title = match &figure.content {
        Content::Chart(chart) => &chart.title,
        Content::Map(map) => &map.title,
    };
    let shown = figure.content.in_prefixed_units();
    let data = drawn(&shown)?;
    let mut html = format!("<figure id=\"{id}\" aria-labelledby=\"{id}-title\">\n");
    add(&mut html, format_args!("<h3 id=\"{id}-title\">{}</h3>\n", text(title)));
    html += "<noscript><p class=\"hint\">This figure needs JavaScript. Its data are in the table below.</p></noscript>\n\
             <div class=\"stage\"></div>\n<figcaption>\n";
    add(&mut html, format_args!("<p>{}</p>\n", text(&figure.caption)));
    if let Some(command) = &figure.command {
        add(
            &mut html,
            format_args!("<p class=\"command\">Made by <code>{}</code></p>\n", text(command)),
        );
    }
    if data.is_thinned() {
        html += "<p class=\"hint\">Long curves keep some 4000 of their points here: what the whole figure shows. A zoom \
                 shows no more of them.</p>\n";
    }
    html += "</figcaption>\n<details>\n<summary>The data as a table</summary>\n";
    let listings = listings(&figure.content);
    for (place, listing) in listings.tables.iter().enumerate() {
        let id = format!("{id}-data-{}", place + 1);
        let rows = listing.rows.iter().map(|row| row.iter().map(|cell| text(cell)));
        plain_table(&mut html, &id, &text(&listing.caption()), &listing.head, rows);
    }
    for note in &listings.notes {
        add(&mut html, format_args!("<p>{}</p>\n", text(note)));
    }
    add(
        &mut html,
        format_args!(
            "</details>\n<script type=\"application/json\">{}</script>\n</figure>\n",
            embedded(
                &serde_json::to_string(&data).map_err(|error| Error::picture(error.to_string()))?
            )
        ),
    );
    Ok(html)
}

/// JSON within HTML: a script element ends at `</script`, and `<!--` hides that end. JSON has `<` in texts alone, where
/// it may be written by its number.
fn embedded(json: &str) -> String {
    json.replace('<', "\\u003c")
}

impl Content {
    /// As it is drawn: in units with prefixes where those make numbers short.
    fn in_prefixed_units(&self) -> Cow<'_, Self> {
        let (chart, map) = match self {
            Self::Chart(chart) => (Some(chart.in_prefixed_units()), None),
            Self::Map(map) => (None, Some(map.in_prefixed_units())),
        };
        match (chart, map) {
            (Some(Cow::Owned(chart)), _) => Cow::Owned(Self::Chart(chart)),
            (_, Some(Cow::Owned(map))) => Cow::Owned(Self::Map(map)),
            _ => Cow::Borrowed(self),
        }
    }
}
