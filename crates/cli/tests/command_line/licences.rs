//! The licences that go into every FMU: those of all that its library is linked with, in the words of their authors.

use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
const KEPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../licenses/THIRD-PARTY.txt");
/// Beginnings of the names of licence files, one per line; a release uses the same list.
const NAMES: &str = include_str!("../../../../licenses/names.txt");
/// Notes by hand, on what is no crate.
const NOTES: [&str; 2] = [
    include_str!("../../../../licenses/RUST.txt"),
    include_str!("../../../../licenses/RUNTIMES.txt"),
];
/// Cargo's names of the platforms that an FMU may be for.
const TARGETS: [&str; 2] = ["x86_64-unknown-linux-gnu", "x86_64-pc-windows-gnu"];

/// A crate that the library is linked with.
struct Crate {
    name: String,
    version: String,
    licence: String,
    folder: PathBuf,
}

pub fn cargo(arguments: &[&str]) -> String {
    let mut cargo = Command::new(env!("CARGO"));
    let output = cargo.current_dir(ROOT).args(arguments).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    assert!(output.status.success(), "{cargo:?}\n{}", text(output.stderr));
    text(output.stdout)
}

/// Names and versions of the crates linked into the library, by cargo's own resolution: no programs that run while it
/// is built (macros, build scripts), none that only tests or tools need.
fn linked() -> Vec<(String, String)> {
    let tree = |target: &str| {
        cargo(&[
            "tree",
            "--locked",
            "--package",
            "amontons",
            "--no-default-features",
            "--edges",
            "normal,no-proc-macro",
            "--prefix",
            "none",
            "--format",
            "{p}",
            "--target",
            target,
        ])
    };
    let mut found: Vec<(String, String)> = TARGETS
        .iter()
        .flat_map(|target| {
            let tree = tree(target);
            let crates = tree.lines().map(|line| {
                let mut words = line.split_whitespace();
                let [name, version] = [words.next(), words.next()].map(|word| word.unwrap());
                (name.to_owned(), version.trim_start_matches('v').to_owned())
            });
            crates.collect::<Vec<_>>()
        })
        .filter(|(name, _)| name != "amontons")
        .collect();
    found.sort();
    found.dedup();
    found
}

fn crates() -> Vec<Crate> {
    let metadata = cargo(&["metadata", "--locked", "--format-version", "1"]);
    let metadata: Value = serde_json::from_str(&metadata).unwrap();
    let packages = metadata["packages"].as_array().unwrap();
    let of = |(name, version): (String, String)| {
        let is_it = |package: &&Value| package["name"] == name && package["version"] == version;
        let package = packages.iter().find(is_it).unwrap_or_else(|| panic!("{name} {version}"));
        let manifest = PathBuf::from(package["manifest_path"].as_str().unwrap());
        let licence = package["license"].as_str().unwrap_or_else(|| panic!("{name} names none"));
        // The sign that crates had before SPDX's own word.
        let licence = licence.replace('/', " OR ");
        Crate { name, version, licence, folder: manifest.parent().unwrap().to_owned() }
    };
    linked().into_iter().map(of).collect()
}

/// The licence files of a crate: their names and texts, lines ended as everywhere here.
fn texts(one: &Crate) -> Vec<(String, String)> {
    let files = fs::read_dir(&one.folder).unwrap().map(|entry| entry.unwrap().path());
    let is_licence = |path: &PathBuf| {
        let name = path.file_name().unwrap().to_string_lossy().to_uppercase();
        path.is_file() && NAMES.lines().any(|known| name.starts_with(known))
    };
    let mut found: Vec<(String, String)> = files
        .filter(is_licence)
        .map(|path| {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            let text = fs::read_to_string(&path).unwrap().replace("\r\n", "\n");
            (name, text.trim_matches('\n').to_owned())
        })
        .collect();
    found.sort();
    assert!(!found.is_empty(), "{} {} brings no licence: {:?}", one.name, one.version, one.folder);
    found
}

/// The whole file: a list of the crates, then each text once, with the crates that have it.
fn collected() -> String {
    let crates = crates();
    let mut numbers: BTreeMap<String, usize> = BTreeMap::new();
    let mut parts: Vec<(String, Vec<String>)> = Vec::new();
    let mut list = String::new();
    for one in &crates {
        let mut places = Vec::new();
        for (file, text) in texts(one) {
            let next = parts.len();
            let number = *numbers.entry(text.clone()).or_insert(next);
            if number == next {
                parts.push((text, Vec::new()));
            }
            parts[number].1.push(format!("{} {}: {file}", one.name, one.version));
            places.push(format!("[{}]", number + 1));
        }
        list += &format!("{} {}: {}  {}\n", one.name, one.version, one.licence, places.join(" "));
    }
    let mut whole = format!(
        "What the library in this FMU is linked with\n===========================================\n\n\
         The library is Amontons, licensed as {}: see LICENSE-MIT.txt and LICENSE-APACHE.txt beside this file. It is\n\
         linked with these crates from https://crates.io, each with its licence (SPDX) and the texts that it brings,\n\
         with the Rust standard library and with parts of compilers' run-time libraries, whose notes come last.\n\n{list}",
        env!("CARGO_PKG_LICENSE")
    );
    for (number, (text, users)) in parts.iter().enumerate() {
        let line = "-".repeat(80);
        whole +=
            &format!("\n{line}\n[{}] {}\n{line}\n\n{text}\n", number + 1, users.join("\n    "));
    }
    for note in NOTES {
        whole += &format!("\n{}\n{note}", "-".repeat(80));
    }
    whole
}

#[test]
fn the_licences_in_an_fmu_are_those_of_what_its_library_is_linked_with() {
    let now = collected();
    if fs::read_to_string(KEPT).unwrap() != now {
        let anew = Path::new(env!("CARGO_TARGET_TMPDIR")).join("THIRD-PARTY.txt");
        fs::write(&anew, now).unwrap();
        panic!(
            "what the library is linked with has changed; look at the new licences and write them anew with\n  \
             cp {} licenses/THIRD-PARTY.txt",
            anew.display()
        );
    }
}

/// The file as people read it, without the sources: nothing that Cargo.lock fixes is missing or old.
#[test]
fn every_crate_is_listed_with_its_version_its_licence_and_a_text() {
    let kept = fs::read_to_string(KEPT).unwrap();
    let lock = fs::read_to_string(Path::new(ROOT).join("Cargo.lock")).unwrap();
    let linked = linked();
    assert!(linked.len() > 20, "{linked:?}");
    for (name, version) in linked {
        assert!(lock.contains(&format!("name = \"{name}\"\nversion = \"{version}\"\n")), "{name}");
        let start = format!("\n{name} {version}: ");
        let line = kept.split_once(&start).map(|(_, rest)| rest.lines().next().unwrap());
        let line = line.unwrap_or_else(|| panic!("{name} {version} is not listed"));
        let (licence, texts) = line.split_once("  ").unwrap();
        assert!(!licence.is_empty() && texts.starts_with('['), "{name}: {line}");
        for text in texts.split(' ') {
            assert!(kept.contains(&format!("\n{text} ")), "{name}: {text}");
        }
    }
}

/// Licences under which an FMU may be used: none of them requires the source of a program that is linked with it.
#[test]
fn every_licence_is_one_that_asks_for_no_more_than_its_notice() {
    const FREE: [&str; 7] =
        ["MIT", "Apache-2.0", "BSD-3-Clause", "BSL-1.0", "Unlicense", "Zlib", "0BSD"];
    for Crate { name, licence, .. } in crates() {
        let words = licence.split([' ', '(', ')']).filter(|word| !word.is_empty());
        for word in words.filter(|word| !["OR", "AND"].contains(word)) {
            assert!(FREE.contains(&word), "{name} is licensed as {licence}");
        }
    }
}

/// Output of a line of Python that runs among the scripts of a release, or the error with which it ends.
fn release(code: &str) -> Result<String, String> {
    let mut python = Command::new("python3");
    python.args(["-B", "-c", &format!("import build, licences, pathlib\n{code}")]);
    let output = python.current_dir(format!("{ROOT}/release")).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    if output.status.success() { Ok(text(output.stdout)) } else { Err(text(output.stderr)) }
}

#[test]
fn a_release_brings_a_text_for_every_crate_in_its_programs_and_the_notes_on_what_is_no_crate() {
    for platform in ["LINUX", "WINDOWS"] {
        let whole = release(&format!("print(licences.third_party(build.{platform}))")).unwrap();
        let line = format!("\n{}\n", "=".repeat(80));
        let mut sections = whole.split(&line);
        let listed = sections.next().unwrap().lines().filter_map(|line| line.strip_prefix("  "));
        let sections: Vec<&str> = sections.collect();
        let with_text: Vec<&str> =
            sections.iter().flat_map(|text| text.lines().next().unwrap().split(", ")).collect();
        let listed: Vec<&str> = listed.map(|line| line.split(':').next().unwrap()).collect();
        assert!(listed.len() > 80, "{listed:?}");
        for one in listed {
            assert!(with_text.contains(&one), "{one} has no text");
        }
        // The licence of the font of the plots; its package has another licence.
        assert!(whole.contains("SIL OPEN FONT LICENSE"), "{platform}");
        for note in NOTES {
            assert!(sections.iter().any(|section| section.trim() == note.trim()), "{note}");
        }
    }
}

#[test]
fn a_release_fails_on_a_crate_without_a_text_unless_its_licence_has_one_for_all() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("crate-without-licence");
    fs::create_dir_all(&folder).unwrap();
    let texts = |licence: &str| {
        let folder = folder.display();
        release(&format!(
            "print(*licences.texts('one 1.2.3', pathlib.Path('{folder}'), '{licence}', ['A. Body <a@b.c>']))"
        ))
    };
    let text = texts("MIT").unwrap();
    assert!(text.contains("Copyright (c) A. Body <a@b.c>\n\nPermission is hereby granted, free"));
    assert!(!text.contains("Amontons"), "{text}");
    let error = texts("Zlib").unwrap_err();
    assert!(error.contains("one 1.2.3, licensed as Zlib, brings no text"), "{error}");
}
