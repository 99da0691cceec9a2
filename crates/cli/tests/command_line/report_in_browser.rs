//! Reports as their readers use them: in a browser, with mouse and keyboard, wide and on a phone.

mod documentation_pages;

use crate::browser::Browser;
use crate::sample_report;
use std::path::PathBuf;
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
    for width in [DESKTOP, PHONE] {
        browser.open(&path, width);
        let count = browser.number("document.querySelectorAll('figure').length");
        assert!(count >= 7.0);
        let empty = browser.text(
            "[...document.querySelectorAll('figure')].filter(f => !f.querySelector('svg polyline, svg circle, svg image'))\
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
