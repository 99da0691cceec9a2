//! What accuracy costs, as a page in an FMU's documentation: one file, without scripts.

use crate::accuracy::{COLUMNS, LEGEND, Row, Study};
use quick_xml::escape::escape;
use std::fmt::Write as _;

const STYLE: &str = "\
:root { color-scheme: light dark }
body { font: 16px/1.5 system-ui, sans-serif; max-width: 74rem; margin: 0 auto; padding: 1.5rem 1rem }
h1 { font-size: 1.4rem; line-height: 1.25; margin: 0 0 .25rem; overflow-wrap: anywhere }
dt { font-weight: 600 }
dd { margin: 0 0 .4rem; overflow-wrap: anywhere }
div { overflow-x: auto; margin: 1.25rem 0 }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; white-space: nowrap }
caption { text-align: left; padding-bottom: .4rem }
th, td { padding: .25rem .6rem; text-align: right; border-bottom: 1px solid #8886 }
th:first-child, td:first-child { text-align: left; padding-left: 0 }
th:first-child { position: sticky; left: 0; background: Canvas }
thead th { border-bottom-width: 2px }
tbody th { font-weight: 400 }
footer { margin-top: 1.5rem; font-size: .875rem; opacity: .8 }
";

/// The page: what `amontons accuracy` prints of a study, but for the times. `rows` come with the order of the
/// error from the row before; `notes` are what is to be said beside those of the study.
#[must_use]
pub fn accuracy_page(study: &Study, rows: &[(Row, Option<f64>)], notes: &[String]) -> String {
    let title = escape(study.title()).into_owned();
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n"
    );
    let mut add = |text: &str| page.push_str(text);
    add(&format!("<p>{}</p>\n<dl>\n", escape(&*study.scene().description)));
    for (what, text) in study.facts() {
        add(&format!("<dt>{}</dt><dd>{}</dd>\n", escape(what), escape(text)));
    }
    add("</dl>\n<div tabindex=\"0\" role=\"region\" aria-labelledby=\"errors\">\n<table>\n\
         <caption id=\"errors\">Errors by method and step, against the reference</caption>\n<thead>\n<tr>");
    for column in COLUMNS {
        add(&format!("<th scope=\"col\">{}</th>", escape(column)));
    }
    add("</tr>\n</thead>\n<tbody>\n");
    for (row, order) in rows {
        add("<tr>");
        for (i, cell) in study.cells(row, *order).into_iter().enumerate() {
            let cell = escape(cell);
            match i {
                0 => add(&format!("<th scope=\"row\">{cell}</th>")),
                _ => add(&format!("<td>{cell}</td>")),
            }
        }
        add("</tr>\n");
    }
    add("</tbody>\n</table>\n</div>\n");
    let all: Vec<Row> = rows.iter().map(|(row, _)| *row).collect();
    for note in notes.iter().chain(&study.notes(&all)) {
        add(&format!("<p>Note: {}</p>\n", escape(note)));
    }
    let legend = LEGEND.replace('\n', " ");
    writeln!(page, "<p>{}</p>", escape(legend)).expect("a string takes all");
    writeln!(
        page,
        "<footer>Amontons {}. <code>amontons accuracy</code> prints this table with computing times.</footer>\n\
         </body>\n</html>",
        env!("CARGO_PKG_VERSION")
    )
    .expect("a string takes all");
    page
}
