//! Reports as their readers use them: in a browser, with mouse and keyboard, wide and on a phone.

mod documentation_pages;

use crate::browser::Browser;
use crate::sample_report;
use std::path::PathBuf;
use tempfile::TempDir;

const DESKTOP: u32 = 1280;
const PHONE: u32 = 390;

/// A browser that shows the sample.
struct Shown {
    browser: Browser,
    /// Where the file is; it goes with this.
    folder: TempDir,
    path: PathBuf,
}

fn shown(width: u32) -> Shown {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).unwrap();
    let path = folder.path().join("report.html");
    amontons_pictures::report::write(&sample_report::page(), &path).unwrap();
    let mut browser = Browser::start();
    browser.open(&path, width);
    Shown { browser, folder, path }
}

/// What a reader does.
type Act = fn(&mut Browser);

/// The figure of this title as an expression.
fn figure(title: &str) -> String {
    format!(
        "[...document.querySelectorAll('figure')].find(f => f.querySelector('h3').textContent === {title:?})"
    )
}

fn squares() -> String {
    figure(sample_report::SQUARES)
}

/// Numbers on the x axis of the figure with the squares.
fn first_and_last_tick(browser: &mut Browser) -> Vec<f64> {
    let ticks = format!(
        "JSON.stringify([...{}.querySelectorAll('text.at-middle:not(.axis-label)')].map(t => Number(t.textContent)))",
        squares()
    );
    let all: Vec<f64> = serde_json::from_str(&browser.text(&ticks)).unwrap();
    vec![all[0], all[all.len() - 1]]
}

fn live(browser: &mut Browser) -> String {
    browser.text(&format!("{}.querySelector('.live').textContent", squares()))
}

#[test]
fn every_figure_is_drawn_wide_and_on_a_phone() {
    let Shown { mut browser, path, folder: _folder } = shown(DESKTOP);
    for width in [DESKTOP, PHONE] {
        browser.open(&path, width);
        let count = browser.number("document.querySelectorAll('figure').length");
        assert!(count >= 7.0);
        let empty = browser.text(
            "[...document.querySelectorAll('figure')].filter(f => !f.querySelector('.plot path[class*=colour], .plot image'))\
             .map(f => f.id).join()",
        );
        assert_eq!(empty, "", "nothing is drawn at {width}");
        let broken = browser.text(
            "[...document.querySelectorAll('.plot *')].filter(e => [...e.attributes].some(a => /NaN|Infinity|undefined/.test(a.value)))\
             .map(e => e.outerHTML.slice(0, 90)).join()",
        );
        assert_eq!(broken, "", "coordinates at {width}");
        // Not `innerWidth`: a phone's grows with what is too wide.
        let page = browser.number("document.documentElement.scrollWidth");
        assert!(page <= f64::from(width), "the page is {page} px wide at {width}");
        let wide = browser.text(
            "[...document.querySelectorAll('.plot svg')].filter(s => s.getBoundingClientRect().right > innerWidth)\
             .map(s => s.closest('figure').id).join()",
        );
        assert_eq!(wide, "", "charts have the width there is");
        let small = browser.text(
            "[...document.querySelectorAll('body *')].filter(e => !e.closest('noscript,script,style') && e.childNodes.length \
             && [...e.childNodes].some(n => n.nodeType === 3 && n.data.trim()) \
             && parseFloat(getComputedStyle(e).fontSize) < 12).map(e => e.outerHTML.slice(0, 60)).join()",
        );
        assert_eq!(small, "", "letters at {width}");
    }
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
fn texts_of_axes_stay_inside_and_apart() {
    let Shown { mut browser, path, folder: _folder } = shown(PHONE);
    for width in [PHONE, 768, DESKTOP] {
        browser.open(&path, width);
        let outside = browser.text(
            "[...document.querySelectorAll('.plot text')].filter(t => { const [a, b] = [t, t.closest('svg')]\
             .map(e => e.getBoundingClientRect()); return a.left < b.left - 1 || a.right > b.right + 1 || a.top < b.top - 1 \
             || a.bottom > b.bottom + 1 }).map(t => t.textContent).join()",
        );
        assert_eq!(outside, "", "at {width}");
        let meeting = browser.text(
            "[...document.querySelectorAll('.plot svg')].flatMap(s => { const all = [...s.querySelectorAll('text')]\
             .map(t => [t.textContent, t.getBoundingClientRect()]); return all.flatMap(([t, a], i) => all.slice(i + 1)\
             .filter(([, b]) => a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 4 && b.top < a.bottom - 4)\
             .map(([u]) => t + ' | ' + u)) }).join('; ')",
        );
        assert_eq!(meeting, "", "at {width}");
    }
}

#[test]
fn arrow_keys_read_the_values_of_a_curve() {
    let mut browser = shown(DESKTOP).browser;
    browser.eval(&format!("{}.querySelector('.plot').focus()", squares()));
    browser.key("Home");
    assert_eq!(live(&mut browser), "Number: 0; square: 0; line: 0");
    for _ in 0..7 {
        browser.key("ArrowRight");
    }
    assert_eq!(live(&mut browser), "Number: 7; square: 49; line: 140");
    browser.key("ArrowLeft");
    assert_eq!(live(&mut browser), "Number: 6; square: 36; line: 120");
    browser.key("End");
    assert_eq!(live(&mut browser), "Number: 50; square: 2500; line: 1000");
    let seen = browser.text(&format!("{}.querySelector('.values').textContent", squares()));
    assert!(seen.contains("square: 2500"), "and shown: {seen}");
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
fn what_is_read_from_a_thinned_curve_are_its_own_points() {
    let mut browser = shown(DESKTOP).browser;
    let figure = figure(sample_report::TRANSIENT);
    browser.eval(&format!("{figure}.querySelector('.plot').focus()"));
    browser.key("Home");
    let mut last = 0.0;
    for _ in 0..15 {
        browser.key("ArrowRight");
        let said = browser.text(&format!("{figure}.querySelector('.live').textContent"));
        let number = |after: &str| -> f64 {
            let text = said.split(after).nth(1).unwrap_or_else(|| panic!("{after} in {said}"));
            text.split(';').next().unwrap().replace('−', "-").parse().unwrap()
        };
        let (t, value) = (number("Time [s]: "), number("]: ẋ1: "));
        assert!(t > last + 0.04, "a hundredth of the range at a time: {last}, {t}");
        last = t;
        // Five digits; samples stand at multiples of 50 µs, so t is exact.
        let exact = sample_report::wave(t);
        assert!((value - exact).abs() <= 6e-5 * exact.abs(), "{value} for {exact} at {t}");
    }
}

#[test]
fn the_pointer_reads_the_nearest_point() {
    let mut browser = shown(DESKTOP).browser;
    let at = place_of(&mut browser, 30.2);
    browser.mouse("mouseMoved", at, 0);
    let seen = browser.text(&format!("{}.querySelector('.values').textContent", squares()));
    assert!(seen.contains("Number: 30") && seen.contains("square: 900"), "{seen}");
}

/// Where x is in the window, in the middle of the frame, which goes from 0 to 50.
fn place_of(browser: &mut Browser, x: f64) -> [f64; 2] {
    let figure = squares();
    browser.eval(&format!("{figure}.scrollIntoView({{ block: 'center', behavior: 'instant' }})"));
    let frame = format!("{figure}.querySelector('rect.frame').getBoundingClientRect()");
    let [left, width, top, height] =
        ["left", "width", "top", "height"].map(|part| browser.number(&format!("{frame}.{part}")));
    [left + width * x / 50.0, top + 0.5 * height]
}

#[test]
fn a_drag_zooms_and_escape_a_double_click_and_a_button_go_back() {
    let mut browser = shown(DESKTOP).browser;
    assert_eq!(first_and_last_tick(&mut browser), [0.0, 50.0]);
    let back: [(&str, Act); 3] = [
        ("Escape", |browser| browser.key("Escape")),
        ("a double click", |browser| {
            let at = place_of(browser, 25.0);
            for clicks in [1, 2] {
                browser.mouse("mousePressed", at, clicks);
                browser.mouse("mouseReleased", at, clicks);
            }
        }),
        ("the button", |browser| {
            let press = format!(
                "[...{}.querySelectorAll('button')].find(b => b.textContent === 'Whole range').click()",
                squares()
            );
            browser.eval(&press);
        }),
    ];
    for (name, back) in back {
        let [from, to] = [10.0, 20.0].map(|x| place_of(&mut browser, x));
        browser.mouse("mouseMoved", from, 0);
        browser.mouse("mousePressed", from, 1);
        browser.mouse("mouseMoved", to, 0);
        browser.mouse("mouseReleased", to, 1);
        let ticks = first_and_last_tick(&mut browser);
        assert!(ticks[0] >= 9.9 && ticks[1] <= 20.1 && ticks[1] - ticks[0] >= 8.0, "{ticks:?}");
        assert!(live(&mut browser).starts_with("Shown: Number from "), "it is said");
        back(&mut browser);
        assert_eq!(first_and_last_tick(&mut browser), [0.0, 50.0], "{name}");
    }
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
fn plus_and_minus_zoom_about_the_crosshair() {
    let mut browser = shown(DESKTOP).browser;
    browser.eval(&format!("{}.querySelector('.plot').focus()", squares()));
    browser.key("End");
    for _ in 0..2 {
        browser.key("+");
    }
    let ticks = first_and_last_tick(&mut browser);
    assert!(ticks[0] >= 37.5 && ticks[1] == 50.0, "a quarter up to the crosshair: {ticks:?}");
    for _ in 0..2 {
        browser.key("-");
    }
    assert_eq!(first_and_last_tick(&mut browser), [0.0, 50.0]);
}

#[test]
fn a_button_of_the_legend_switches_its_curve_off_and_on() {
    let mut browser = shown(DESKTOP).browser;
    let button = format!(
        "[...{}.querySelectorAll('.legend button')].find(b => b.textContent === 'square')",
        squares()
    );
    let curves = format!("{}.querySelectorAll('.plot path.curve').length", squares());
    assert_eq!(
        [browser.text(&format!("{button}.ariaPressed")), curves_of(&mut browser, &curves)],
        ["true", "2"]
    );
    browser.eval(&format!("{button}.click()"));
    assert_eq!(
        [browser.text(&format!("{button}.ariaPressed")), curves_of(&mut browser, &curves)],
        ["false", "1"]
    );
    browser.eval(&format!("{}.querySelector('.plot').focus()", squares()));
    browser.key("End");
    assert_eq!(live(&mut browser), "Number: 50; line: 1000", "and it is not read");
    browser.eval(&format!("{button}.click()"));
    assert_eq!(curves_of(&mut browser, &curves), "2");
}

fn curves_of(browser: &mut Browser, expression: &str) -> String {
    browser.number(expression).to_string()
}

#[test]
fn limit_cycles_and_maps_are_read_point_by_point() {
    let mut browser = shown(DESKTOP).browser;
    for (title, words) in [
        (
            "Limit cycles, µ = 1.5",
            ["v = 0.05 m/s", "Displacement x3 [µm]: ", "Velocity ẋ3 [m/s]: "],
        ),
        (
            "Where perturbations lead",
            ["Initial displacement x1 [mm]: ", "Initial velocity ẋ1 [m/s]: ", "equilibrium"],
        ),
    ] {
        let figure = figure(title);
        browser.eval(&format!("{figure}.querySelector('.plot').focus()"));
        browser.key("ArrowRight");
        let live = format!("{figure}.querySelector('.live').textContent");
        let first = browser.text(&live);
        for word in words {
            assert!(first.contains(word), "{word} is missing in {first}");
        }
        browser.key("ArrowRight");
        browser.key("ArrowUp");
        assert_ne!(browser.text(&live), first);
    }
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
fn the_scheme_is_the_readers_and_can_be_switched() {
    let mut browser = shown(DESKTOP).browser;
    let ground = "getComputedStyle(document.body).backgroundColor";
    browser.prefer("light");
    let light = browser.text(ground);
    browser.prefer("dark");
    let dark = browser.text(ground);
    assert_ne!(light, dark);
    browser.eval("document.querySelector('.scheme').click()");
    assert_eq!(browser.text(ground), light);
    browser.eval("document.querySelector('.scheme').click()");
    assert_eq!(browser.text(ground), dark);
}

#[test]
fn without_its_script_a_page_says_where_the_data_are() {
    let Shown { mut browser, path, folder: _folder } = shown(DESKTOP);
    browser.call("Emulation.setScriptExecutionDisabled", &serde_json::json!({ "value": true }));
    browser.load(&path, DESKTOP);
    // What stands in `noscript` is made of elements only where no script runs.
    assert_eq!(browser.number("document.querySelectorAll('figure noscript p').length"), 8.0);
    assert_eq!(
        browser.number("document.querySelectorAll('figure details table').length > 7 ? 1 : 0"),
        1.0
    );
}

#[test]
fn gaps_stay_open_and_points_have_their_markers() {
    let mut browser = shown(DESKTOP).browser;
    let figure = figure(sample_report::MARKED);
    let path = |browser: &mut Browser, class: &str| {
        browser.text(&format!("{figure}.querySelector('.plot .{class}').getAttribute('d')"))
    };
    let curve = path(&mut browser, "curve");
    // Two lines and a point alone; nothing is drawn from one to the next.
    assert_eq!([curve.matches('M').count(), curve.matches('L').count()], [3, 2], "{curve}");
    let markers = path(&mut browser, "marker.triangle");
    assert_eq!(markers.matches('M').count(), 5, "{markers}");
    let legend = |what: &str| format!("{figure}.querySelectorAll('.legend {what}').length");
    assert_eq!(browser.number(&legend(".marker.triangle")), 1.0);
    // One state has one colour, two by turns have two.
    assert_eq!(browser.number(&legend(".area")), 3.0);
    let areas = format!("{figure}.querySelectorAll('.plot .area').length");
    assert!(browser.number(&areas) >= 3.0);
    assert_eq!(browser.complaints, Vec::<String>::new());
}
