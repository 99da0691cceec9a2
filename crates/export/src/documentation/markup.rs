//! The frame of a page without scripts, and pictures in it.

use amontons_pictures::report::{BASE_STYLE, add, sheet, text};

/// Style of these pages, besides that of all pages. Pictures are drawn for white ground; their colours are mapped to
/// those of the page's own scheme.
const STYLE: &str = include_str!("page.css");

/// A page. What stands between head and footer is HTML.
pub(super) fn page(title: &str, body: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; \
         img-src data:; base-uri 'none'; form-action 'none'\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{}</title>\n\
         <link rel=\"icon\" href=\"data:,\">\n<style>\n{BASE_STYLE}{STYLE}</style>\n</head>\n<body>\n\
         <a class=\"skip\" href=\"#main\">Skip to the content</a>\n{body}\
         <footer><p>Amontons {}</p></footer>\n</body>\n</html>\n",
        text(title),
        env!("CARGO_PKG_VERSION"),
    )
}

/// A section with its heading.
pub(super) fn section(html: &mut String, id: &str, heading: &str, content: &str) {
    add(
        html,
        format_args!(
            "<section aria-labelledby=\"{id}\">\n<h2 id=\"{id}\">{}</h2>\n{content}</section>\n",
            text(heading)
        ),
    );
}

/// Paragraphs of plain text.
pub(super) fn paragraphs<T: AsRef<str>>(html: &mut String, all: &[T]) {
    for one in all {
        add(html, format_args!("<p>{}</p>\n", text(one.as_ref())));
    }
}

/// A picture (SVG) with its caption.
pub(super) fn figure(html: &mut String, id: &str, svg: &str, caption: &str) {
    html.push_str("<figure>\n");
    sheet(html, id, svg);
    add(html, format_args!("<figcaption id=\"{id}\">{}</figcaption>\n</figure>\n", text(caption)));
}

/// Facts as pairs of a word and a text.
pub(super) fn facts(html: &mut String, facts: &[(&str, String)]) {
    html.push_str("<dl>\n");
    for (what, fact) in facts {
        add(html, format_args!("<dt>{}</dt><dd>{}</dd>\n", text(what), text(fact)));
    }
    html.push_str("</dl>\n");
}

/// Lines of a program or a file, as they are.
pub(super) fn listing(html: &mut String, what: &str, lines: &str) {
    add(
        html,
        format_args!(
            "<pre tabindex=\"0\" role=\"region\" aria-label=\"{}\">{}</pre>\n",
            text(what),
            text(lines)
        ),
    );
}
