//! The page at which an FMU's documentation begins.

use super::{Subject, facts, importing, markup, reference, stability, variables};
use amontons::Error;
use amontons_pictures::picture::Structure;
use amontons_pictures::report::{add, text};

/// The page. `structure` is the picture; `accuracy` is `true` if there is a page on that beside this one.
///
/// # Errors
/// Returns an error if a picture cannot be drawn.
pub(super) fn index(
    subject: Subject<'_>,
    structure: Option<&Structure>,
    accuracy: bool,
) -> Result<String, Error> {
    let scene = subject.scene;
    let mut html = String::from("<header>\n");
    add(&mut html, format_args!("<h1>{}</h1>\n", text(&scene.name)));
    if !scene.description.is_empty() {
        add(&mut html, format_args!("<p class=\"lead\">{}</p>\n", text(&scene.description)));
    }
    html.push_str("</header>\n");
    let start = subject.start;
    let mut sections = vec![
        ("scene", "The scene", model(subject, structure)?),
        ("squeal", "Will it squeal?", stability::section(start.scene(), start.reference())?),
        ("import", "How to import it", importing::section(subject)),
        ("run", "A reference run", reference::section(scene, subject.run)?),
        ("variables", "Variables", variables::section(scene)),
        ("file", "Scene file", file(subject)),
    ];
    if accuracy {
        let content = "<p>Errors of each method and step against a reference: \
                       <a href=\"accuracy.html\">accuracy</a>.</p>\n";
        sections.push(("accuracy", "Accuracy", content.to_owned()));
    }
    sections.push(("licences", "Licences", LICENCES.to_owned()));
    html.push_str("<nav aria-label=\"Contents\">\n<ul>\n");
    for (id, heading, _) in &sections {
        add(&mut html, format_args!("<li><a href=\"#{id}\">{heading}</a></li>\n"));
    }
    html.push_str("</ul>\n</nav>\n<main id=\"main\">\n");
    for (id, heading, content) in &sections {
        markup::section(&mut html, id, heading, content);
    }
    html.push_str("</main>\n");
    Ok(markup::page(&scene.name, &html))
}

const LICENCES: &str = "\
<p>The program in this FMU is Amontons, under the <a href=\"licenses/LICENSE-MIT.txt\">MIT licence</a> or the \
<a href=\"licenses/LICENSE-APACHE.txt\">Apache License 2.0</a>, at your option. It is linked with other libraries, \
whose licences are in <a href=\"licenses/THIRD-PARTY.txt\">THIRD-PARTY.txt</a>. The scene belongs to its author.</p>
";

fn model(subject: Subject<'_>, structure: Option<&Structure>) -> Result<String, Error> {
    let mut html = String::new();
    match structure {
        Some(structure) => {
            let caption = "Masses, springs, dampers and contacts. The drawing is not to scale.";
            markup::figure(&mut html, "drawing", &structure.svg()?, caption);
        }
        None => markup::paragraphs(
            &mut html,
            &[format!(
                "There is no drawing of this scene: a drawing shows at most {} masses.",
                Structure::MOST_MASSES
            )],
        ),
    }
    markup::facts(&mut html, &facts::facts(subject));
    Ok(html)
}

fn file(subject: Subject<'_>) -> String {
    let source = subject.source;
    let mut html = String::from(
        "<p>The FMU reads this file from its folder <code>resources</code> when it is instantiated. <code>amontons \
         export</code> and <code>amontons simulate</code> accept it too.</p>\n\
         <details>\n<summary>scene.toml</summary>\n",
    );
    markup::listing(&mut html, "scene.toml", &source.text);
    html.push_str("</details>\n");
    let tables = source.tables.iter().map(|(name, _)| name.clone());
    let matrices = source.binaries.iter();
    let matrices = matrices.map(|(name, bytes)| format!("{name} ({})", facts::size(bytes.len())));
    let names: Vec<String> = tables.chain(matrices).collect();
    if !names.is_empty() {
        markup::paragraphs(
            &mut html,
            &[format!("Other files in the same folder: {}.", names.join(", "))],
        );
    }
    html
}
