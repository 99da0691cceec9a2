//! The cost of accuracy, as a page in an FMU's documentation: one file, without scripts.

use super::markup;
use amontons_analysis::accuracy::{COLUMNS, ConvergenceStudy, LEGEND, Row};
use amontons_pictures::report::{add, plain_table, text};

/// The page: what `amontons accuracy` prints of a study, but for the times. `rows` come with the order of the
/// error from the row before; `notes` are what is to be said beside those of the study.
#[must_use]
pub fn accuracy_page(
    study: &ConvergenceStudy,
    rows: &[(Row, Option<f64>)],
    notes: &[String],
) -> String {
    let title = study.title();
    let mut html = String::from("<header>\n");
    add(&mut html, format_args!("<h1>{}</h1>\n", text(&title)));
    add(&mut html, format_args!("<p class=\"lead\">{}</p>\n", text(&study.scene().description)));
    html.push_str("<p><a href=\"index.html\">The FMU</a></p>\n</header>\n<main id=\"main\">\n");
    markup::facts(&mut html, &study.facts());
    let cells = rows.iter().map(|(row, order)| {
        study.cells(row, *order).into_iter().map(|cell| text(&cell)).collect::<Vec<_>>().into_iter()
    });
    plain_table(
        &mut html,
        "errors",
        "Errors by method and step, against the reference",
        &COLUMNS.map(str::to_owned),
        cells,
    );
    let all: Vec<Row> = rows.iter().map(|(row, _)| *row).collect();
    for note in notes.iter().chain(&study.notes(&all)) {
        add(&mut html, format_args!("<p>Note: {}</p>\n", text(note)));
    }
    markup::paragraphs(&mut html, &[LEGEND.replace('\n', " ")]);
    html.push_str(
        "<p><code>amontons accuracy</code> prints this table with computing times.</p>\n</main>\n",
    );
    markup::page(&title, &html)
}
