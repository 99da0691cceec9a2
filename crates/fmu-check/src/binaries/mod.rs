//! Rules on the libraries of every platform, which are read as files and not loaded.

mod elf;
mod functions;
mod library;
mod platforms;

pub(super) use platforms::HOST;

use super::archive::{Archive, Entry};
use super::description::Description;
use super::options::Glibc;
use super::report::Report;
use super::rules::{Class, Rule};
use library::PlatformLibrary;
use object::BinaryFormat;
use platforms::Platform;
use std::collections::BTreeMap;

/// Limit of the size of a library that is read, bytes.
const MOST_BYTES: u64 = 512 << 20;

/// Examines the libraries of all platforms. Returns the path of the library for this host if it may be loaded.
pub(super) fn examine(
    description: &Description<'_>,
    archive: &Archive,
    floor: Option<Glibc>,
    report: &mut Report,
) -> Option<String> {
    let mut folders: BTreeMap<&str, Vec<&Entry>> = BTreeMap::new();
    // A folder without a file holds no implementation; FMI 2.0 does not forbid it.
    for entry in archive.entries.iter().filter(|entry| !entry.is_folder()) {
        if let Some((folder, _)) =
            entry.name.strip_prefix("binaries/").and_then(|rest| rest.split_once('/'))
        {
            folders.entry(folder).or_default().push(entry);
        }
    }
    let identifier = description.identifier()?;
    let has_sources = archive
        .entries
        .iter()
        .any(|entry| entry.name.starts_with("sources/") && !entry.is_folder());
    // Under a name with backslashes, which is reported with the archive, a library may lie there for some hosts.
    let has_others = archive.entries.iter().any(|entry| entry.name.starts_with("binaries\\"));
    if folders.is_empty() && !has_sources && !has_others {
        report.add(
            Rule::LibraryMissing,
            "binaries/",
            "there is neither a library nor a source file",
        );
    }
    let mut hosts = BTreeMap::new();
    for (folder, entries) in folders {
        let Some(platform) = Platform::of(folder) else {
            foreign_folder(folder, report);
            continue;
        };
        let path = format!("binaries/{folder}/{identifier}.{}", platform.extension);
        let Some(entry) = find(&path, platform, archive, &entries, report) else {
            lacking(&path, platform, &entries, report);
            continue;
        };
        let path = entry.name.clone();
        let content = match archive.content(entry, MOST_BYTES) {
            Ok(content) => content,
            // Damaged entries are reported by the rules on the archive.
            Err(error) => {
                report.note(format!("{path} is not examined: {error}"));
                continue;
            }
        };
        let beside: Vec<_> = entries.into_iter().filter(|beside| beside.name != path).collect();
        let file = PlatformLibrary { path: &path, platform, archive, beside: &beside };
        if !file.examine(&content, floor, report) {
            continue;
        }
        if HOST.contains(&folder) {
            hosts.insert(folder, path);
        } else {
            report.note(format!("{path} is read but not run: it is for another system"));
        }
    }
    HOST.iter().find_map(|folder| hosts.remove(folder))
}

/// Returns the library of this path. On Windows, where file names ignore case, a name in other letters is found too, with
/// a hint.
fn find<'a>(
    path: &str,
    platform: &Platform,
    archive: &'a Archive,
    entries: &[&'a Entry],
    report: &mut Report,
) -> Option<&'a Entry> {
    if let Some(entry) = archive.find(path) {
        return Some(entry);
    }
    let alike = |entry: &&&Entry| entry.name.eq_ignore_ascii_case(path);
    let entry = entries.iter().find(alike).filter(|_| platform.format == BinaryFormat::Pe)?;
    let message = format!("is named {}; only systems that ignore case find it", entry.name);
    report.add_as(Class::Hint, Rule::LibraryMissing, path, message);
    Some(entry)
}

fn foreign_folder(folder: &str, report: &mut Report) {
    // FMI 2.0.4 recommends the names of FMI 3.0, such as aarch64-linux, for platforms that it does not name itself.
    if folder
        .split_once('-')
        .is_some_and(|(processor, system)| !processor.is_empty() && !system.is_empty())
    {
        report.note(format!("binaries/{folder}/ is not examined: it is for a platform of FMI 3.0"));
    } else {
        let known: Vec<_> = platforms::PLATFORMS.iter().map(|platform| platform.folder).collect();
        let message = format!(
            "is not a platform of FMI 2.0, so hosts do not look there; use one of {}",
            known.join(", ")
        );
        report.add(Rule::PlatformFolder, format!("binaries/{folder}/"), message);
    }
}

fn lacking(path: &str, platform: &Platform, entries: &[&Entry], report: &mut Report) {
    const OBJECTS: [&str; 4] = [".lib", ".a", ".obj", ".o"];
    // Libraries of objects, which a compiler links, are an implementation too.
    let is_object = |entry: &&Entry| OBJECTS.iter().any(|ending| entry.name.ends_with(ending));
    if entries.iter().all(is_object) {
        let folder = platform.folder;
        report.note(format!(
            "binaries/{folder}/ holds object libraries only, which are not examined"
        ));
        return;
    }
    let ending = format!(".{}", platform.extension);
    let others: Vec<_> = entries
        .iter()
        .filter(|entry| entry.name.ends_with(&ending))
        .map(|entry| &*entry.name)
        .collect();
    let message = match others[..] {
        [] => "is missing".to_owned(),
        _ => format!(
            "is missing; the folder holds {}, but the library must be named after modelIdentifier",
            others.join(", ")
        ),
    };
    report.add(Rule::LibraryMissing, path, message);
}
