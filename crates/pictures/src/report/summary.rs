//! The summary: how many claims hold, which, and what differs. All of it is counted from the verdicts.

use super::markup::{add, reason, text};
use super::{Claim, Page, Verdict};

/// The section before all others; nothing where there are no claims.
pub(super) fn summary(page: &Page) -> String {
    let all = || page.sections.iter().flat_map(|section| &section.claims).zip(1..);
    let count = all().count();
    if count == 0 {
        return String::new();
    }
    let holding = held(all().map(|(claim, _)| claim));
    let is_unknown = |claim: &Claim| matches!(claim.verdict, Verdict::Unknown { .. });
    let unknown = match all().filter(|(claim, _)| is_unknown(claim)).count() {
        0 => String::new(),
        1 => " One is unknown.".to_owned(),
        unknown => format!(" {unknown} are unknown."),
    };
    let mut html =
        String::from("<section aria-labelledby=\"summary\">\n<h2 id=\"summary\">Summary</h2>\n");
    add(
        &mut html,
        format_args!(
            "<p class=\"count\"><strong>{holding} of {count}</strong> {}.{unknown}</p>\n<ul class=\"verdicts\">\n",
            if count == 1 { "claim holds" } else { "claims hold" },
        ),
    );
    let mut before = 0;
    for (place, section) in page.sections.iter().enumerate() {
        let claims = &section.claims;
        if !claims.is_empty() {
            add(
                &mut html,
                format_args!(
                    "<li><a href=\"#section-{}\">{}</a>: {} of {} <span class=\"links\">",
                    place + 1,
                    text(&section.heading),
                    held(claims.iter()),
                    claims.len(),
                ),
            );
            for (claim, number) in claims.iter().zip(before + 1..) {
                html += &link(claim, number);
            }
            html += "</span></li>\n";
        }
        before += claims.len();
    }
    html += "</ul>\n";
    html += &not_holding(all());
    html + "</section>\n"
}

fn held<'a>(claims: impl Iterator<Item = &'a Claim>) -> usize {
    claims.filter(|claim| claim.verdict.holds()).count()
}

fn link(claim: &Claim, number: usize) -> String {
    let (class, symbol, word) = match claim.verdict {
        Verdict::Holds => ("holds", "✓", "holds"),
        Verdict::Differs { .. } => ("differs", "≠", "differs"),
        Verdict::Unknown { .. } => ("unknown", "?", "is not decided"),
    };
    let paper = text(&claim.paper);
    format!(
        "<a class=\"{class}\" href=\"#claim-{number}\" title=\"{paper}\" \
         aria-label=\"Claim {number} {word}: {paper}\">{symbol} {number}</a> "
    )
}

fn not_holding<'a>(all: impl Iterator<Item = (&'a Claim, usize)>) -> String {
    let mut items = String::new();
    for (claim, number) in all {
        if let Some(why) = reason(&claim.verdict) {
            add(
                &mut items,
                format_args!(
                    "<li><a href=\"#claim-{number}\">Claim {number}</a>: {} <span class=\"why\">{}</span></li>\n",
                    text(&claim.paper),
                    why,
                ),
            );
        }
    }
    match items.is_empty() {
        true => items,
        false => format!("<h3>Claims that differ or are unknown</h3>\n<ul>\n{items}</ul>\n"),
    }
}
