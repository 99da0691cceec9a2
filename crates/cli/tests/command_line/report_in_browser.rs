//! Reports as their readers use them: in a browser, with mouse and keyboard, wide and on a phone.

mod documentation_pages;

use crate::browser::Browser;
use crate::sample_report;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

const DESKTOP: u32 = 1280;
const PHONE: u32 = 390;

/// The sample as a file, and a browser.
fn sample() -> (Browser, PathBuf, TempDir) {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).unwrap();
    let path = folder.path().join("report.html");
    amontons_pictures::report::write(&sample_report::page(), &path).unwrap();
    (Browser::start(), path, folder)
}

#[test]
#[cfg_attr(not(has_chromium), ignore = "Chromium is not installed (Debian: apt install chromium)")]
fn every_figure_is_drawn_wide_and_on_a_phone() {
    let (mut browser, path, _folder) = sample();
    assert_fits(&mut browser, &path, 7.0);
}

/// The page of `study report`, which has tables of more columns than the sample.
#[test]
#[cfg_attr(not(has_chromium), ignore = "Chromium is not installed (Debian: apt install chromium)")]
fn the_page_of_a_scene_is_drawn_wide_and_on_a_phone() {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).unwrap();
    let program = env!("CARGO_BIN_EXE_amontons");
    let arguments = ["study", "report", "disc_brake", "--points=16", "-o", "out"];
    let output = crate::program::run(program, folder.path(), &arguments);
    assert!(output.status.success(), "{}", crate::program::text(&output.stderr));
    assert_fits(&mut Browser::start(), &folder.path().join("out/report.html"), 5.0);
}

/// Every figure of a page is drawn, at least `figures` of them, and no part of the page is lost, wide and on a phone.
fn assert_fits(browser: &mut Browser, path: &Path, figures: f64) {
    for width in [DESKTOP, PHONE] {
        browser.open(path, width);
        let count = browser.number("document.querySelectorAll('figure').length");
        assert!(count >= figures);
        let empty = browser.text(
            "[...document.querySelectorAll('figure')].filter(f => !f.querySelector('svg polyline, svg circle, svg image, svg rect'))\
             .map(f => f.id).join()",
        );
        assert_eq!(empty, "", "nothing is drawn at {width}");
        // Not `innerWidth`: a phone's grows with what is too wide.
        let page = browser.number("document.documentElement.scrollWidth");
        assert!(page <= f64::from(width), "the page is {page} px wide at {width}");
        // Content that is wider than the window scrolls in a box that the keyboard reaches.
        let lost = browser.text(
            "[...document.querySelectorAll('body *')].filter(e => e.getBoundingClientRect().right > innerWidth + 1 \
             && !e.closest('[tabindex=\"0\"]')).map(e => e.outerHTML.slice(0, 80)).join()",
        );
        assert_eq!(lost, "", "at {width}");
        let small = browser.text(
            "[...document.querySelectorAll('body *')].filter(e => !e.closest('svg,style') && e.childNodes.length \
             && [...e.childNodes].some(n => n.nodeType === 3 && n.data.trim()) \
             && parseFloat(getComputedStyle(e).fontSize) < 12).map(e => e.outerHTML.slice(0, 60)).join()",
        );
        assert_eq!(small, "", "letters at {width}");
    }
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
#[cfg_attr(not(has_chromium), ignore = "Chromium is not installed (Debian: apt install chromium)")]
fn the_scheme_is_the_readers() {
    let (mut browser, path, _folder) = sample();
    browser.open(&path, DESKTOP);
    let mut colours = ["light", "dark"].map(|scheme| {
        browser.prefer(scheme);
        let ground = browser.text("getComputedStyle(document.body).backgroundColor");
        (ground, browser.text("getComputedStyle(document.querySelector('figure svg text')).fill"))
    });
    let [light, dark] = &mut colours;
    assert!(light.0 != dark.0 && light.1 != dark.1, "{light:?}, {dark:?}");
}
