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
use super::rules::Rule;
use library::PlatformLibrary;
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
    for entry in &archive.entries {
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
    if folders.is_empty() && !has_sources {
        report.add(
            Rule::LibraryMissing,
            "binaries/",
            "there is neither a library nor a source file",
        );
    }
    let mut host = None;
    for (folder, entries) in folders {
        let Some(platform) = Platform::of(folder) else {
            foreign_folder(folder, report);
            continue;
        };
        let path = format!("binaries/{folder}/{identifier}.{}", platform.extension);
        let Some(entry) = archive.find(&path) else {
            lacking(&path, platform, &entries, report);
            continue;
        };
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
        if HOST == Some(folder) {
            host = Some(path);
        } else {
            report.note(format!("{path} is read but not run: it is for another system"));
        }
    }
    host
}

fn foreign_folder(folder: &str, report: &mut Report) {
    // Folders named as in FMI 3.0, such as x86_64-linux, are for platforms that FMI 2.0 does not name.
    if folder
        .split_once('-')
        .is_some_and(|(processor, system)| !processor.is_empty() && !system.is_empty())
    {
        report
            .note(format!("binaries/{folder}/ is not examined: FMI 2.0 defines no such platform"));
    } else {
        let known: Vec<_> = platforms::PLATFORMS.iter().map(|platform| platform.folder).collect();
        let message = format!("is not a platform of FMI 2.0; use one of {}", known.join(", "));
        report.add(Rule::PlatformFolder, format!("binaries/{folder}/"), message);
    }
}

fn lacking(path: &str, platform: &Platform, entries: &[&Entry], report: &mut Report) {
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
