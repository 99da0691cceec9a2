//! The page around figures: head, sections, claims, tables.

use super::figure::figure;
use super::{Cell, Claim, Page, Section, Table, Verdict, answers, summary};
use amontons::Error;
use quick_xml::escape::escape;
use std::fmt::Write as _;
use uuid::Uuid;

/// Style of all pages: colours on light and dark ground, texts, tables, figures.
pub const BASE_STYLE: &str = include_str!("page/base.css");
/// Style of reports: the summary and the claims.
const STYLE: &str = include_str!("page/page.css");

/// Text as it stands between tags and in attributes.
pub fn text(plain: &str) -> String {
    escape(plain).into_owned()
}

/// Words of fewer letters fit on a line of a narrow screen.
const LONG: usize = 16;

/// Text between tags, in which long names such as `contact.upper_lining.friction` may break after a point or an underscore.
pub(super) fn breakable(plain: &str) -> String {
    let word = |word: &str| {
        if word.chars().count() < LONG {
            return text(word);
        }
        let letters: Vec<char> = word.chars().collect();
        let mut html = String::new();
        let mut from = 0;
        for place in 1..letters.len() - 1 {
            let is_join = matches!(letters[place], '.' | '_');
            if is_join && letters[place - 1] != '.' && letters[place + 1].is_alphabetic() {
                html += &text(&letters[from..=place].iter().collect::<String>());
                html += "<wbr>";
                from = place + 1;
            }
        }
        html + &text(&letters[from..].iter().collect::<String>())
    };
    plain.split(' ').map(word).collect::<Vec<_>>().join(" ")
}

/// # Errors
/// Returns an error in the cases of [`super::html`].
pub(super) fn page(page: &Page) -> Result<String, Error> {
    let body = body(page)?;
    // Only the style that bears the page's own mark counts. The mark is made from all there is on the page, so no text
    // in it can know its own.
    let nonce = Uuid::new_v5(&Uuid::NAMESPACE_OID, body.as_bytes()).simple().to_string();
    Ok(format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; \
         style-src 'nonce-{nonce}'; img-src data:; base-uri 'none'; form-action 'none'\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{}</title>\n<link rel=\"icon\" href=\"data:,\">\n<style nonce=\"{nonce}\">\n{BASE_STYLE}{STYLE}</style>\n\
         </head>\n<body>\n{body}</body>\n</html>\n",
        text(&page.title),
    ))
}

fn body(page: &Page) -> Result<String, Error> {
    let mut html =
        String::from("<a class=\"skip\" href=\"#main\">Skip to the content</a>\n<header>\n");
    add(&mut html, format_args!("<h1>{}</h1>\n", text(&page.title)));
    paragraphs(&mut html, &page.lead);
    html += "</header>\n<main id=\"main\">\n";
    html += &answers::answers(page)?;
    html += &summary::summary(page);
    html += &contents(page);
    let (mut claims, mut figures, mut tables) = (0, 0, 0);
    for (place, one) in page.sections.iter().enumerate() {
        let number = place + 1;
        add(
            &mut html,
            format_args!(
                "<section id=\"section-{number}\" aria-labelledby=\"heading-{number}\">\n\
             <h2 id=\"heading-{number}\">{}</h2>\n",
                text(&one.heading)
            ),
        );
        section(&mut html, one, [&mut claims, &mut figures, &mut tables])?;
        html += "</section>\n";
    }
    html += "</main>\n";
    if !page.footer.is_empty() {
        add(&mut html, format_args!("<footer><p>{}</p></footer>\n", text(&page.footer)));
    }
    Ok(html)
}

/// A string takes all that is written to it.
pub fn add(html: &mut String, what: std::fmt::Arguments<'_>) {
    html.write_fmt(what).expect("a string takes all");
}

fn paragraphs(html: &mut String, all: &[String]) {
    for one in all {
        add(html, format_args!("<p>{}</p>\n", breakable(one)));
    }
}

/// A picture (SVG) in a box that scrolls where the page is narrower than the picture can be read. `label` is the id of
/// the element that names it.
pub fn sheet(html: &mut String, label: &str, svg: &str) {
    add(
        html,
        format_args!(
            "<div class=\"sheet\" tabindex=\"0\" role=\"region\" aria-labelledby=\"{label}\">\n{}</div>\n",
            inlined(svg)
        ),
    );
}

/// An SVG within HTML: its ground is the page's, and what is the same everywhere need not be said.
fn inlined(svg: &str) -> String {
    let (head, body) = svg.split_once("</desc>\n").unwrap_or(("", svg));
    // The first element is the white ground.
    let body = match body.split_once('\n') {
        Some((ground, rest)) if ground.starts_with("<rect") => rest,
        _ => body,
    };
    let body = body
        .replace(" opacity=\"1\"", "")
        .replace(" font-family=\"sans-serif\"", "")
        .replace(" \"/>", "\"/>");
    if head.is_empty() { body } else { format!("{head}</desc>\n{body}") }
}

fn contents(page: &Page) -> String {
    let mut html = String::from(
        "<nav aria-labelledby=\"contents\">\n<h2 id=\"contents\">Contents</h2>\n<ol>\n",
    );
    for (place, section) in page.sections.iter().enumerate() {
        let number = place + 1;
        let heading = text(&section.heading);
        add(&mut html, format_args!("<li><a href=\"#section-{number}\">{heading}</a></li>\n"));
    }
    html + "</ol>\n</nav>\n"
}

/// `numbers` are how many claims, figures and tables the sections before have.
fn section(
    html: &mut String,
    section: &Section,
    [claims, figures, tables]: [&mut usize; 3],
) -> Result<(), Error> {
    paragraphs(html, &section.text);
    for one in &section.key_tables {
        *tables += 1;
        table(html, one, *tables)?;
    }
    if !section.claims.is_empty() {
        claim_table(html, &section.heading, &section.claims, *claims);
        *claims += section.claims.len();
    }
    for one in &section.figures {
        *figures += 1;
        html.push_str(&figure(one, *figures)?);
    }
    for one in &section.tables {
        *tables += 1;
        table(html, one, *tables)?;
    }
    points(html, &section.points);
    if !section.commands.is_empty() {
        html.push_str("<pre class=\"commands\">");
        section.commands.iter().for_each(|one| add(html, format_args!("{}\n", text(one))));
        html.push_str("</pre>\n");
    }
    Ok(())
}

fn points(html: &mut String, all: &[String]) {
    if all.is_empty() {
        return;
    }
    html.push_str("<ul>\n");
    all.iter().for_each(|one| add(html, format_args!("<li>{}</li>\n", breakable(one))));
    html.push_str("</ul>\n");
}

/// A verdict by a symbol and words.
pub(super) fn verdict(verdict: &Verdict) -> &'static str {
    match verdict {
        Verdict::Holds => "<span class=\"holds\"><span aria-hidden=\"true\">✓ </span>holds</span>",
        Verdict::Differs { .. } => {
            "<span class=\"differs\"><span aria-hidden=\"true\">≠ </span>differs</span>"
        }
        Verdict::Unknown { .. } => {
            "<span class=\"unknown\"><span aria-hidden=\"true\">? </span>unknown</span>"
        }
    }
}

/// The reason why a claim does not hold, or the evidence that would decide it, as HTML; `None` for one that holds.
pub(super) fn reason(verdict: &Verdict) -> Option<String> {
    match verdict {
        Verdict::Holds => None,
        Verdict::Differs { reason } => {
            Some(format!("Reason: {}", text(reason.as_deref().unwrap_or("not known"))))
        }
        Verdict::Unknown { decided_by } => Some(format!("Needed to decide: {}", text(decided_by))),
    }
}

/// The roles are named because a narrow screen shows rows as blocks, and some browsers then forget them.
fn claim_table(html: &mut String, heading: &str, claims: &[Claim], before: usize) {
    add(
        html,
        format_args!(
            "<table class=\"claims\" role=\"table\">\n<caption class=\"unseen\">Claims: {}</caption>\n\
         <thead role=\"rowgroup\"><tr role=\"row\">",
            text(heading)
        ),
    );
    for name in ["No.", "The paper says", "Result", "Verdict"] {
        add(html, format_args!("<th scope=\"col\" role=\"columnheader\">{name}</th>"));
    }
    html.push_str("</tr></thead>\n<tbody role=\"rowgroup\">\n");
    for (place, claim) in claims.iter().enumerate() {
        let number = before + place + 1;
        add(
            html,
            format_args!(
                "<tr role=\"row\" id=\"claim-{number}\"><th scope=\"row\" role=\"rowheader\">{number}</th>\
             <td role=\"cell\" data-name=\"The paper says\">{}</td>\
             <td role=\"cell\" data-name=\"Result\">{}</td>\
             <td role=\"cell\" data-name=\"Verdict\">{}",
                text(&claim.paper),
                text(&claim.found),
                verdict(&claim.verdict),
            ),
        );
        if let Some(why) = reason(&claim.verdict) {
            add(html, format_args!("<br>{why}"));
        }
        html.push_str("</td></tr>\n");
    }
    html.push_str("</tbody>\n</table>\n");
}

fn table(html: &mut String, table: &Table, number: usize) -> Result<(), Error> {
    let columns = table.head.len();
    if let Some((place, row)) = table.rows.iter().enumerate().find(|(_, row)| row.len() != columns)
    {
        return Err(Error::picture(format!(
            "row {} of the table {:?} has {} cells for {columns} columns",
            place + 1,
            table.caption,
            row.len(),
        )));
    }
    let id = format!("table-{number}");
    plain_table(
        html,
        &id,
        &text(&table.caption),
        &table.head,
        table.rows.iter().map(|row| row.iter().map(cell)),
    );
    Ok(())
}

fn cell(cell: &Cell) -> String {
    let lines = cell.lines.iter().map(|line| match line.emphasised {
        true => format!("<strong>{}</strong>", breakable(&line.text)),
        false => breakable(&line.text),
    });
    lines.collect::<Vec<_>>().join("<br>")
}

/// A table in a box of its own that scrolls where it is wider than the page. The caption and the cells are HTML.
pub fn plain_table(
    html: &mut String,
    id: &str,
    caption: &str,
    head: &[String],
    rows: impl Iterator<Item = impl Iterator<Item = String>>,
) {
    add(
        html,
        format_args!(
            "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-labelledby=\"{id}\">\n<table>\n\
         <caption id=\"{id}\"><span>{caption}</span></caption>\n<thead><tr>"
        ),
    );
    for name in head {
        add(html, format_args!("<th scope=\"col\">{}</th>", text(name)));
    }
    html.push_str("</tr></thead>\n<tbody>\n");
    for row in rows {
        html.push_str("<tr>");
        for (column, cell) in row.enumerate() {
            match column {
                0 => add(html, format_args!("<th scope=\"row\">{cell}</th>")),
                _ => add(html, format_args!("<td>{cell}</td>")),
            }
        }
        html.push_str("</tr>\n");
    }
    html.push_str("</tbody>\n</table>\n</div>\n");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_names_break_after_points_and_underscores_and_numbers_do_not() {
        assert_eq!(
            breakable("contact.upper_lining.friction <10 %"),
            "contact.<wbr>upper_<wbr>lining.<wbr>friction &lt;10 %"
        );
        assert_eq!(breakable("module[1].k6 at 1087.907 Hz"), "module[1].k6 at 1087.907 Hz");
        assert_eq!(
            breakable("0.12345678901234567890 … uniform(0.1,0.2222)"),
            "0.12345678901234567890 … uniform(0.1,0.2222)"
        );
    }
}
