//! The examples of README and book run, what they are said to print they print, and links lead somewhere.
//!
//! A block of code in `docs/` or `README.md` has one of these kinds:
//!
//! | block | what the tests do with it |
//! | --- | --- |
//! | `sh` | runs it with `bash -e`; the blocks of a page in order, in one folder that is empty at first |
//! | `sh,long` | makes the page one of the long suite |
//! | | `$AMONTONS` in it is the folder of the repository |
//! | `toml` with the first line `# name.toml` | writes this file into the folder and reads it as a scene; commands have to read one |
//! | | with `[[superelement]]`, whose matrices may not be there yet |
//! | `python` with the first line `# name.py` | writes this file into the folder |
//! | `toml,part` | reads it as TOML |
//! | `text` directly after `sh` | looks for each line in what the commands print; `…` stands for anything |
//! | any kind with `ignore` | nothing |

use crate::parallel::on_each;
use crate::program::folder;
use crate::python;
use std::collections::BTreeSet;
use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

struct Block<'a> {
    /// Line of the page at which it begins.
    line: usize,
    kind: &'a str,
    text: String,
    /// Only empty lines separate it from the block before.
    follows: bool,
}

/// README and the pages of the book.
fn pages() -> Vec<PathBuf> {
    let mut found = vec![PathBuf::from("README.md")];
    let mut folders = vec![PathBuf::from("docs")];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(Path::new(ROOT).join(&folder)).unwrap() {
            let path = folder.join(entry.unwrap().file_name());
            if Path::new(ROOT).join(&path).is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|end| end == "md") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

fn read(page: &Path) -> String {
    fs::read_to_string(Path::new(ROOT).join(page)).unwrap()
}

fn blocks(page: &str) -> Vec<Block<'_>> {
    let mut found = Vec::new();
    let mut lines = page.lines().enumerate();
    let mut follows = false;
    while let Some((number, line)) = lines.next() {
        let Some(kind) = line.trim_start().strip_prefix("```") else {
            follows &= line.trim().is_empty();
            continue;
        };
        let inside = lines.by_ref().map(|(_, line)| line);
        let text = inside.take_while(|line| line.trim() != "```").map(|line| format!("{line}\n"));
        found.push(Block { line: number + 1, kind: kind.trim(), text: text.collect(), follows });
        follows = true;
    }
    found
}

fn is_long(page: &Path) -> bool {
    blocks(&read(page)).iter().any(|block| block.kind == "sh,long")
}

/// Words of a line, so that columns may be set closer.
fn words(line: &str) -> String {
    line.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// `true` if the parts of an expected line between `…` are in a printed one, in order.
fn matches(expected: &str, printed: &str) -> bool {
    let mut parts = expected.split('…').map(str::trim);
    let first = parts.next().unwrap_or_default();
    let Some(mut rest) = printed.strip_prefix(first) else { return false };
    let mut last = first;
    for part in parts {
        let Some((_, after)) = rest.split_once(part) else { return false };
        (rest, last) = (after, part);
    }
    // A line that ends with `…` may go on.
    rest.is_empty() || (last.is_empty() && expected.contains('…'))
}

/// Runs a page's examples. Returns what is wrong with them.
fn wrong_in(page: &Path) -> Vec<String> {
    let text = read(page);
    let folder = folder();
    let mut wrong = Vec::new();
    let mut printed: Option<Vec<String>> = None;
    for block in blocks(&text) {
        let place = format!("{}:{}", page.display(), block.line);
        let mut say = |what: String| wrong.push(format!("{place}: {what}"));
        let first = block.text.lines().next().unwrap_or_default();
        let file = first.strip_prefix("# ").filter(|name| {
            let end = Path::new(name).extension();
            end.is_some_and(|end| end == block.kind || (end == "py" && block.kind == "python"))
        });
        match (block.kind, file) {
            ("sh" | "sh,long", _) => match commands(&block.text, folder.path()) {
                Ok(lines) => printed = Some(lines),
                Err(what) => {
                    say(what);
                    // What follows needs what these commands leave.
                    return wrong;
                }
            },
            ("text", _) => {
                if let Some(printed) = printed.as_ref().filter(|_| block.follows) {
                    for line in block.text.lines().map(words).filter(|line| !line.is_empty()) {
                        if !printed.iter().any(|printed| matches(&line, printed)) {
                            say(format!("the commands do not print: {line}"));
                        }
                    }
                }
            }
            ("toml" | "python", Some(name)) => {
                fs::write(folder.path().join(name), &block.text).unwrap();
                if block.kind == "toml"
                    && !block.text.contains("[[superelement]]")
                    && let Err(error) = amontons::scene::parse(name, &block.text)
                {
                    say(format!("{name} is no scene: {error}"));
                }
            }
            ("toml,part", _) => {
                if let Err(error) = block.text.parse::<toml::Table>() {
                    say(format!("no TOML: {error}"));
                }
            }
            (kind, _) if kind.ends_with(",ignore") => {}
            (kind, _) => say(format!("a block `{kind}` says neither what to run nor to ignore it")),
        }
        if !block.kind.starts_with("sh") && block.kind != "text" {
            printed = None;
        }
    }
    wrong
}

/// Runs commands. Returns the lines that they print.
fn commands(script: &str, folder: &Path) -> Result<Vec<String>, String> {
    let programs = Path::new(env!("CARGO_BIN_EXE_amontons")).parent().unwrap();
    let interpreter = python::interpreter();
    let before = env::var_os("PATH").unwrap_or_default();
    let folders = [programs, interpreter.parent().unwrap()].map(Path::to_owned);
    let path = env::join_paths(folders.into_iter().chain(env::split_paths(&before))).unwrap();
    let mut bash = Command::new("bash");
    let output = bash.args(["-e", "-c", script]).current_dir(folder);
    let output = output.env("PATH", path).env("AMONTONS", ROOT).output();
    let output = output.map_err(|error| error.to_string())?;
    let all =
        [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
    if !output.status.success() {
        return Err(format!("{}\n{}", output.status, all.concat()));
    }
    Ok(all.concat().lines().map(words).collect())
}

fn assert_pages_run(long: bool) {
    let pages: Vec<PathBuf> = pages().into_iter().filter(|page| is_long(page) == long).collect();
    let wrong = on_each(&pages, |page| wrong_in(page)).concat();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_examples_of_readme_and_book_run() {
    assert_pages_run(false);
}

#[test]
#[ignore = "long: pages of the book whose examples are studies"]
fn the_long_examples_of_the_book_run() {
    assert_pages_run(true);
}

/// The place to which a heading can be linked, as GitHub and mdBook name it.
fn anchor(heading: &str) -> String {
    let kept = heading.chars().filter(|c| c.is_alphanumeric() || "_- ".contains(*c));
    kept.flat_map(char::to_lowercase).map(|c| if c == ' ' { '-' } else { c }).collect()
}

/// Lines of a page outside of blocks of code.
fn prose(page: &str) -> Vec<String> {
    let mut inside = false;
    let outside = page.lines().filter(|line| {
        let is_fence = line.trim_start().starts_with("```");
        inside ^= is_fence;
        !inside && !is_fence
    });
    outside.map(str::to_owned).collect()
}

fn anchors(page: &str) -> BTreeSet<String> {
    let lines = prose(page);
    let headings = lines.iter().filter_map(|line| {
        line.trim_start_matches('#').strip_prefix(' ').filter(|_| line.starts_with('#'))
    });
    headings.map(anchor).collect()
}

#[test]
fn links_of_readme_and_book_lead_somewhere() {
    let others = ["CONTRIBUTING.md", "scenes/README.md", "examples/importers/README.md"];
    let pages: Vec<PathBuf> = pages().into_iter().chain(others.map(PathBuf::from)).collect();
    let mut wrong = Vec::new();
    for page in &pages {
        let text = read(page);
        for line in prose(&text) {
            // Without pieces of code.
            let line = line.split('`').step_by(2).collect::<String>();
            let targets = line.split("](").skip(1).filter_map(|rest| rest.split(')').next());
            for target in targets.filter(|target| !target.contains("://")) {
                let (file, place) = target.split_once('#').unwrap_or((target, ""));
                let path = match file {
                    "" => page.clone(),
                    file => page.parent().unwrap().join(file),
                };
                let whole = Path::new(ROOT).join(&path);
                let is_outside = page.starts_with("docs")
                    && !whole.canonicalize().is_ok_and(|path| {
                        path.starts_with(Path::new(ROOT).join("docs").canonicalize().unwrap())
                    });
                if !whole.exists() {
                    wrong.push(format!("{}: {target} does not exist", page.display()));
                } else if is_outside {
                    wrong.push(format!("{}: {target} is not in the book", page.display()));
                } else if !place.is_empty()
                    && !anchors(&fs::read_to_string(&whole).unwrap()).contains(place)
                {
                    wrong.push(format!("{}: {target} is no heading", page.display()));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_book_lists_each_of_its_pages_once() {
    let summary = read(Path::new("docs/SUMMARY.md"));
    let listed = summary.split("](").skip(1).map(|rest| rest.split(')').next().unwrap().to_owned());
    let mut listed: Vec<String> = listed.collect();
    listed.sort();
    let of_docs =
        |page: PathBuf| page.strip_prefix("docs").ok().map(|page| page.display().to_string());
    let pages: Vec<String> =
        pages().into_iter().filter_map(of_docs).filter(|page| page != "SUMMARY.md").collect();
    assert_eq!(listed, pages);
}
