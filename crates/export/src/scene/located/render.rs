//! Problems with the lines that they are in, as plain text.

use super::Located;
use amontons::scene::{MAX_PROBLEMS, and_more};
use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
use std::ops::Range;

/// All problems of a text, each with the error, file:line:column, the line with the place underlined, and the remedy.
/// `are_all` is `true` if `problems` are all that were looked for; otherwise there may be more.
pub(super) fn report(place: &str, text: &str, problems: &[Located], are_all: bool) -> String {
    let reports = problems.iter().take(MAX_PROBLEMS).map(|problem| {
        let annotation = AnnotationKind::Primary.span(in_one_line(text, &problem.span));
        let snippet = Snippet::source(text).path(place).annotation(annotation);
        let title = Level::ERROR.no_name().primary_title(&*problem.title);
        let mut group = title.element(snippet);
        if !problem.help.is_empty() {
            group = group.element(Level::HELP.message(&*problem.help));
        }
        Renderer::plain().render(&[group])
    });
    let count = problems.len();
    let more = if are_all { "" } else { " or more" };
    let head = (count > 1).then(|| format!("{count} problems{more} in {place}"));
    let parts: Vec<String> = head.into_iter().chain(reports).chain(and_more(count)).collect();
    parts.join("\n\n")
}

/// The part of a span that is in its first line, as a place between two characters if it is empty.
fn in_one_line(text: &str, span: &Range<usize>) -> Range<usize> {
    let at_character = |mut at: usize| {
        at = at.min(text.len());
        while !text.is_char_boundary(at) {
            at -= 1;
        }
        at
    };
    let (start, end) = (at_character(span.start), at_character(span.end));
    let line = text[start..].find(['\r', '\n']).map_or(text.len(), |length| start + length);
    start..end.clamp(start, line)
}
