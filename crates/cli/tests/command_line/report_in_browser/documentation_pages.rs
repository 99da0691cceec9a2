//! The page in every FMU as its readers see it: wide and on a phone, in light and in dark.

use super::{DESKTOP, PHONE};
use crate::browser::Browser;
use std::fs;
use std::io::{Cursor, Read};
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

fn folder() -> TempDir {
    tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).unwrap()
}

/// The folder of the documentation of a scene's FMU.
fn unpacked(folder: &Path, scene: &str) -> PathBuf {
    let mut export = Command::new(env!("CARGO_BIN_EXE_amontons"));
    let output = export.args(["export", scene, "-o", "made.fmu"]).current_dir(folder).output();
    let output = output.unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let bytes = fs::read(folder.join("made.fmu")).unwrap();
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).unwrap();
    let mut page = Vec::new();
    archive.by_name("documentation/index.html").unwrap().read_to_end(&mut page).unwrap();
    let path = folder.join("index.html");
    fs::write(&path, page).unwrap();
    path
}

#[test]
#[cfg_attr(not(has_chromium), ignore = "Chromium is not installed (Debian: apt install chromium)")]
fn the_page_fits_its_window_and_every_letter_can_be_read() {
    let folder = folder();
    let none = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/effects/none.toml");
    let mut browser = Browser::start();
    for scene in ["set1", "ring12", "corner", "disc_brake", none.to_str().unwrap()] {
        let path = unpacked(folder.path(), scene);
        for width in [DESKTOP, PHONE] {
            browser.open(&path, width);
            browser.eval("document.querySelectorAll('details').forEach(d => d.open = true)");
            browser.settle();
            // Not `innerWidth`: a phone's grows with what is too wide.
            let page = browser.number("document.documentElement.scrollWidth");
            assert!(page <= f64::from(width), "{scene}: the page is {page} px wide at {width}");
            // Content that is wider than the window scrolls in a box that the keyboard reaches.
            let lost = browser.text(
                "[...document.querySelectorAll('body *')].filter(e => e.getBoundingClientRect().right > innerWidth + 1 \
                 && !e.closest('[tabindex=\"0\"]')).map(e => e.outerHTML.slice(0, 80)).join()",
            );
            assert_eq!(lost, "", "{scene} at {width}");
            // Letters of pictures have the size at which they are shown.
            let small = browser.text(
                "[...document.querySelectorAll('svg text')].filter(t => { const s = t.ownerSVGElement; \
                 return parseFloat(t.getAttribute('font-size')) * s.getBoundingClientRect().width / s.viewBox.baseVal.width < 9 })\
                 .map(t => t.textContent).join()",
            );
            assert_eq!(small, "", "{scene} at {width}");
            let pictures = browser.number("document.querySelectorAll('figure svg').length");
            assert!(pictures >= 2.0, "{scene}: {pictures} pictures");
        }
    }
    assert_eq!(browser.complaints, Vec::<String>::new());
}

/// The contrast of two colours as WCAG 2 has it: texts want 4.5, lines 3.
const CONTRAST: &str = "const light = c => { const [r, g, b] = c.match(/[\\d.]+/g).map(Number).map(v => v / 255)\
    .map(v => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4); return 0.2126 * r + 0.7152 * g + 0.0722 * b };\
    const contrast = (a, b) => { const [x, y] = [light(a), light(b)].sort((p, q) => q - p); return (x + 0.05) / (y + 0.05) };";

#[test]
#[cfg_attr(not(has_chromium), ignore = "Chromium is not installed (Debian: apt install chromium)")]
fn pictures_have_the_colours_of_the_scheme() {
    let folder = folder();
    let path = unpacked(folder.path(), "set1");
    let mut browser = Browser::start();
    browser.open(&path, DESKTOP);
    let mut grounds = Vec::new();
    for scheme in ["light", "dark"] {
        browser.prefer(scheme);
        browser.settle();
        grounds.push(browser.text("getComputedStyle(document.body).backgroundColor"));
        let faint = browser.text(&format!(
            "(() => {{ {CONTRAST} const ground = getComputedStyle(document.body).backgroundColor; \
             return [...document.querySelectorAll('svg *')].map(e => [e, getComputedStyle(e)]).filter(([e, s]) => \
             e.tagName === 'text' && contrast(s.fill, ground) < 4.5 \
             || e.tagName === 'polyline' && s.stroke !== 'none' && e.getAttribute('stroke') !== '#E6E6E6' \
             && contrast(s.stroke, ground) < 2.9).map(([e]) => e.outerHTML.slice(0, 90)).join() }})()"
        ));
        assert_eq!(faint, "", "{scheme}");
    }
    assert_ne!(grounds[0], grounds[1]);
}
