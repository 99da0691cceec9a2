//! Reports: what a page holds, and what is refused.

use crate::sample_report::{HOSTILE, page};
use amontons_pictures::picture::{Chart, Panel, Series};
use amontons_pictures::report::{Content, Figure, Page, Section, Table, Verdict, html, write};
use quick_xml::escape::escape;

fn sample() -> String {
    html(&page()).unwrap()
}

/// The parts of a text between two others.
fn between<'a>(text: &'a str, from: &str, to: &str) -> Vec<&'a str> {
    text.split(from).skip(1).map(|after| after.split(to).next().unwrap()).collect()
}

#[test]
fn a_page_has_every_claim_caption_and_table() {
    let html = sample();
    let has = |text: &str| assert!(html.contains(&*escape(text)), "{text} is missing");
    let page = page();
    has(&page.title);
    has(&page.footer);
    for answer in &page.answers {
        has(&answer.question);
        answer.text.iter().for_each(|text| has(text));
    }
    assert!(html.contains("<a href=\"#section-"), "an answer has a link");
    for section in &page.sections {
        section.points.iter().chain(&section.commands).for_each(|text| has(text));
        has(&section.heading);
        section.text.iter().for_each(|text| has(text));
        for claim in &section.claims {
            has(&claim.paper);
            has(&claim.found);
        }
        for figure in &section.figures {
            has(&figure.caption);
            has(figure.command.as_ref().unwrap());
        }
        for table in &section.tables {
            has(&table.caption);
            table.head.iter().for_each(|name| has(name));
            table
                .rows
                .iter()
                .flatten()
                .flat_map(|cell| &cell.lines)
                .for_each(|line| has(&line.text));
        }
    }
    assert_eq!(
        html.matches("<strong>2.68 ± 219.38 i</strong>").count(),
        4,
        "what grows stands out"
    );
    assert!(!html.contains("<strong>−"), "what decays does not");
}

#[test]
fn the_summary_counts_the_verdicts() {
    assert!(sample().contains("<strong>4 of 6</strong> claims hold"));
    let mut page = page();
    page.sections[1].claims[0].verdict = Verdict::Differs { reason: None };
    let html = html(&page).unwrap();
    assert!(html.contains("<strong>3 of 6</strong> claims hold"));
    assert!(html.contains("</a>: 1 of 2"), "of the section, too");
}

#[test]
fn a_difference_has_its_reason_or_says_that_none_is_known() {
    let html = sample();
    assert!(html.contains("Reason: the frequency at µ = 2 is given, not that at the onset"));
    assert!(html.contains("Reason: not known"));
}

#[test]
fn what_is_not_known_neither_holds_nor_differs_and_says_what_would_decide_it() {
    let mut page = page();
    let decided_by = "the colours of the <printed> picture".to_owned();
    page.sections[1].claims[0].verdict = Verdict::Unknown { decided_by };
    let html = html(&page).unwrap();
    assert!(html.contains("<strong>3 of 6</strong> claims hold. One is unknown."));
    assert_eq!(
        html.matches("Needed to decide: the colours of the &lt;printed&gt; picture").count(),
        2
    );
    assert_eq!(html.matches("? </span>unknown</span>").count(), 1);
    assert!(!sample().contains("is unknown."));
}

#[test]
fn links_lead_to_what_there_is_and_no_two_places_have_one_name() {
    let html = sample();
    let names = between(&html, " id=\"", "\"");
    for name in &names {
        assert_eq!(names.iter().filter(|other| other == &name).count(), 1, "{name}");
    }
    let links =
        [between(&html, "href=\"#", "\""), between(&html, "aria-labelledby=\"", "\"")].concat();
    assert!(links.len() > 20);
    for link in links {
        assert!(names.contains(&link), "{link}");
    }
}

#[test]
fn texts_are_never_markup() {
    let html = sample();
    assert!(!html.contains("alert(1)</script>"));
    assert!(!html.contains("<!--"));
    assert!(!html.contains("<script"), "nothing runs");
    let mut page = page();
    let Content::Chart(chart) = &mut page.sections[0].figures[0].content else { unreachable!() };
    chart.panels[0].series[0].label = Some(HOSTILE.into());
    let with_label = amontons_pictures::report::html(&page).unwrap();
    assert!(!with_label.contains("<script"), "texts in pictures neither");
    assert!(with_label.contains(&*escape(HOSTILE)), "and they are shown as they are");
}

#[test]
fn a_page_refers_to_nothing_outside_it() {
    let html = sample();
    // The name of SVG's elements is no address.
    let rest = html.replace("\"http://www.w3.org/2000/svg\"", "");
    for wrong in ["http:", "https:", "src=", "@import", "url(http", "fetch(", "import("] {
        assert!(!rest.contains(wrong), "{wrong}");
    }
    let policy = between(&html, "Content-Security-Policy\" content=\"", "\"")[0];
    assert!(policy.starts_with("default-src 'none';"), "{policy}");
    assert!(!policy.contains("unsafe"), "{policy}");
}

#[test]
fn the_same_data_give_the_same_page_of_a_size_that_opens_at_once() {
    let html = sample();
    assert_eq!(html, sample());
    assert!(html.len() < 3_000_000, "{} bytes", html.len());
}

#[test]
fn long_curves_are_thinned() {
    let html = sample();
    for points in between(&html, " points=\"", "\"") {
        assert!(points.split_whitespace().count() < 4100);
    }
    for table in between(&html, "<table>", "</table>") {
        assert!(table.matches("<tr>").count() <= 51, "with its head");
    }
    assert!(html.contains("of 100001 points, evenly selected"));
}

#[test]
fn what_cannot_be_drawn_is_refused_by_name() {
    let with = |section| Page { sections: vec![section], ..Page::default() };
    let chart = Chart {
        title: "Nothing".into(),
        panels: [("Frequency", 1.0), ("Growth", f64::NAN)]
            .map(|(name, y)| Panel {
                y_label: name.into(),
                series: vec![Series { points: vec![[1.0, y]], ..Series::default() }],
                ..Panel::default()
            })
            .into(),
        ..Chart::default()
    };
    let figure = Figure { caption: String::new(), command: None, content: Content::Chart(chart) };
    let error = html(&with(Section { figures: vec![figure], ..Section::default() })).unwrap_err();
    assert!(error.is_picture());
    assert!(
        error.to_string().contains("Nothing") && error.to_string().contains("Growth"),
        "{error}"
    );
    let table = Table {
        caption: "Values".into(),
        head: vec!["a".into(), "b".into()],
        rows: vec![vec!["1".into()]],
    };
    let error = html(&with(Section { tables: vec![table], ..Section::default() })).unwrap_err();
    assert!(
        error.to_string().contains("row 1 of the table \"Values\" has 1 cells for 2"),
        "{error}"
    );
}

#[test]
fn an_answer_that_no_section_shows_is_refused() {
    let mut page = page();
    page.answers[0].section = "Elsewhere".into();
    let error = html(&page).unwrap_err();
    assert!(
        error.is_picture() && error.to_string().contains("names a section \"Elsewhere\""),
        "{error}"
    );
}

#[test]
fn the_values_of_a_structure_and_of_bars_stand_below_them_as_tables() {
    let html = sample();
    for cell in ["<td>55 kN/m</td><td>pad to ground</td>", "<td>pad on disc</td>", "<td>−0.75</td>"]
    {
        assert!(html.contains(cell), "{cell}");
    }
}

#[test]
fn key_tables_stand_before_figures_and_other_tables_behind_them() {
    let mut page = page();
    let section = page.sections.iter_mut().find(|one| !one.tables.is_empty()).unwrap();
    section.key_tables = vec![Table { caption: "Key values".into(), ..section.tables[0].clone() }];
    let (heading, last) = (section.heading.clone(), section.tables[0].caption.clone());
    let html = html(&page).unwrap();
    let section = &html[html.find(&format!(">{heading}</h2>")).unwrap()..];
    let place = |text: &str| section.find(text).unwrap();
    assert!(place("Key values") < place("<figure") && place("<figure") < place(&escape(&*last)));
}

#[test]
fn a_page_appears_whole_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("report.html");
    write(&page(), &path).unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), sample());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is left beside it");
    let error = write(&page(), &folder.path().join("none/report.html")).unwrap_err();
    assert!(error.is_file());
}

/// The contrast of two colours by WCAG 2: 1 to 21.
fn contrast(a: &str, b: &str) -> f64 {
    let luminance = |colour: &str| {
        let linear = |at: usize| {
            let value = f64::from(u8::from_str_radix(&colour[at..at + 2], 16).unwrap()) / 255.0;
            if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * linear(1) + 0.7152 * linear(3) + 0.0722 * linear(5)
    };
    let (a, b) = (luminance(a) + 0.05, luminance(b) + 0.05);
    (a / b).max(b / a)
}

#[test]
fn colours_stand_out_on_light_and_on_dark_ground() {
    let html = sample();
    let colours = |name: &str| -> Vec<String> {
        let pair = between(&html, &format!("  --{name}: light-dark("), ")")[0];
        pair.split(", ").map(String::from).collect()
    };
    // The colours for browsers without light-dark().
    let alone = |name: &str| between(&html, &format!("  --{name}: #"), ";")[0].to_owned();
    for scheme in [0, 1] {
        let of = |name: &str| colours(name)[scheme].clone();
        for text in ["ink", "soft", "link", "good", "bad"] {
            for ground in ["ground", "raised"] {
                let found = contrast(&of(text), &of(ground));
                assert!(found >= 4.5, "{text} on {ground}: {found:.2}");
            }
        }
        for place in 0..8 {
            let found = contrast(&of(&format!("colour-{place}")), &of("ground"));
            assert!(found >= 3.0, "colour {place} in scheme {scheme}: {found:.2}");
        }
    }
    let names =
        html.lines().filter_map(|line| line.strip_prefix("  --")?.split_once(": light-dark("));
    let names: Vec<&str> = names.map(|(name, _)| name).collect();
    assert!(names.len() > 15, "{names:?}");
    for name in names {
        assert_eq!(format!("#{}", alone(name)), colours(name)[0], "{name}");
    }
}
