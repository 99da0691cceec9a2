//! The answers at the start of a page, each with a link to the section that shows it.

use super::markup::{add, breakable, text};
use super::{Answer, Page};
use amontons::Error;

/// The section before all others; nothing where there are no answers.
///
/// # Errors
/// Returns an error if an answer names a section that the page does not have.
pub(super) fn answers(page: &Page) -> Result<String, Error> {
    if page.answers.is_empty() {
        return Ok(String::new());
    }
    let mut html = String::from(
        "<section class=\"answers\" aria-labelledby=\"answers\">\n<h2 id=\"answers\">In short</h2>\n",
    );
    for Answer { question, text: said, section } in &page.answers {
        let place = page.sections.iter().position(|one| one.heading == *section);
        let place = place.ok_or_else(|| {
            Error::picture(format!("the answer to {question:?} names a section {section:?}, which the page does not have"))
        })?;
        add(&mut html, format_args!("<h3>{}</h3>\n", text(question)));
        for (number, one) in said.iter().enumerate() {
            let link = if number + 1 == said.len() {
                format!(" <a href=\"#section-{}\">{}</a>", place + 1, text(section))
            } else {
                String::new()
            };
            add(&mut html, format_args!("<p>{}{link}</p>\n", breakable(one)));
        }
    }
    Ok(html + "</section>\n")
}
