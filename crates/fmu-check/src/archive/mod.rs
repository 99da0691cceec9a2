//! Rules on the archive: its headers, its names, its size when unpacked and its top level.

mod reader;

pub(super) use reader::{Archive, Entry};

use super::report::Report;
use super::rules::{Class, Rule};
use rawzip::CompressionMethod;
use std::collections::HashMap;
use std::io;

/// Limit of the unpacked size of an archive, bytes.
const MOST_BYTES: u64 = 4 << 30;
/// Unpacked size above which the archive must not unpack to more than [`MOST_RATIO`] times its packed size, bytes.
const FREE_BYTES: u64 = 256 << 20;
const MOST_RATIO: u64 = 200;

/// Names that FMI 2.0 and its layered standards define at the top level of an FMU.
const TOP_LEVEL: [&str; 8] = [
    "modelDescription.xml",
    "model.png",
    "documentation/",
    "sources/",
    "binaries/",
    "resources/",
    "terminalsAndIcons/",
    "extra/",
];

const UNIX_TYPE: u32 = 0o170_000;
const UNIX_FILE: u32 = 0o100_000;
const UNIX_FOLDER: u32 = 0o040_000;

/// Examines headers, names and contents. Returns `true` if the contents may be unpacked for further examination.
pub(super) fn examine(archive: &Archive, report: &mut Report) -> bool {
    for entry in &archive.entries {
        header(entry, report);
        name(entry, report);
    }
    duplicates(archive, report);
    top_level(archive, report);
    let total: u64 = archive.entries.iter().fold(0, |sum, entry| sum.saturating_add(entry.size));
    if total > MOST_BYTES || total > FREE_BYTES && total / MOST_RATIO > archive.len() {
        let message = format!(
            "its {} bytes would unpack to {total}; the limits are {MOST_BYTES} and, above {FREE_BYTES}, {MOST_RATIO} times the size of the archive",
            archive.len()
        );
        report.add(Rule::ZipBomb, "the archive", message);
        return false;
    }
    // Entries that overlap would unpack the same bytes several times.
    let packed = archive.entries.iter().fold(0_u64, |sum, entry| sum.saturating_add(entry.packed));
    if packed > archive.len() {
        let message = format!(
            "entries overlap: their packed contents have {packed} bytes in total, but the archive has only {}",
            archive.len()
        );
        report.add(Rule::ZipBomb, "the archive", message);
        return false;
    }
    for entry in &archive.entries {
        let readable = is_readable(entry.method) && !entry.is_encrypted;
        if readable && let Err(error) = archive.unpack(entry, &mut io::sink()) {
            report.add(Rule::ZipDamaged, &entry.name, error);
        }
    }
    true
}

fn header(entry: &Entry, report: &mut Report) {
    if entry.zip64 {
        report.add(
            Rule::ZipVersion,
            &entry.name,
            "is a zip64 entry, which needs version 4.5 of zip; FMI allows 2.0",
        );
    } else if entry.version > 20 {
        let (major, minor) = (entry.version / 10, entry.version % 10);
        let message = format!("needs version {major}.{minor} of zip; FMI allows 2.0");
        report.add(Rule::ZipVersion, &entry.name, message);
    }
    if entry.is_encrypted {
        report.add(Rule::ZipMethod, &entry.name, "is encrypted; FMI 2.0 does not allow encryption");
    } else if !is_readable(entry.method) {
        let message = format!(
            "uses compression method {}; FMI allows 0 (stored) and 8 (deflate)",
            entry.method.as_u16()
        );
        report.add(Rule::ZipMethod, &entry.name, message);
    }
    // Readers of a stream cannot see where stored content ends if the sizes follow it.
    if entry.has_data_descriptor && entry.method == CompressionMethod::STORE && !entry.is_folder() {
        let message = "is stored, and its sizes are in a data descriptor after the content (general purpose bit 3); deflate it or write the sizes into the local header";
        report.add(Rule::ZipDataDescriptor, &entry.name, message);
    }
    let kind = entry.mode.map_or(0, |mode| mode & UNIX_TYPE);
    if !matches!(kind, 0 | UNIX_FILE | UNIX_FOLDER) {
        let what =
            if kind == 0o120_000 { "a symbolic link" } else { "neither a file nor a folder" };
        report.add(Rule::ZipLink, &entry.name, format!("is {what}; pack the file itself"));
    }
}

fn is_readable(method: CompressionMethod) -> bool {
    matches!(method, CompressionMethod::STORE | CompressionMethod::DEFLATE)
}

fn name(entry: &Entry, report: &mut Report) {
    let name = &entry.name;
    let drive = name.as_bytes().get(1) == Some(&b':');
    let has_part = |part: &str| name.trim_end_matches('/').split('/').any(|other| other == part);
    let (class, problem) = if name.contains('\\') {
        (Class::Violation, "has a backslash; folders are separated by /")
    } else if name.starts_with('/') || drive {
        (Class::Violation, "is an absolute path")
    } else if has_part("..") {
        (Class::Violation, "leads out of the archive with ..")
    } else if !entry.is_utf8 {
        (Class::Hint, "is not in UTF-8, so hosts read it differently")
    } else if has_part("") || has_part(".") && name != "./" {
        (Class::Hint, "has an empty part or the part ., which some hosts do not unpack")
    } else if name.chars().any(char::is_control) {
        (Class::Hint, "has a control character, which some systems do not allow")
    } else {
        return;
    };
    report.add_as(class, Rule::ZipPath, name, format!("the name {problem}"));
}

/// `true` if an entry may be unpacked as a file or folder below a private folder.
pub(super) fn is_safe(entry: &Entry) -> bool {
    let mut none = Report::default();
    name(entry, &mut none);
    none.findings.is_empty()
        && entry.mode.is_none_or(|mode| matches!(mode & UNIX_TYPE, 0 | UNIX_FILE | UNIX_FOLDER))
}

/// Returns a path without `.` and `..`; `None` if it leaves the archive.
pub(super) fn plain(path: &str) -> Option<String> {
    let mut parts = Vec::new();
    for part in path.split('/') {
        match part {
            "" | "." => {}
            ".." => drop(parts.pop()?),
            part => parts.push(part),
        }
    }
    Some(parts.join("/"))
}

fn duplicates(archive: &Archive, report: &mut Report) {
    let mut seen: HashMap<String, &str> = HashMap::new();
    for entry in &archive.entries {
        let Some(first) = seen.insert(entry.name.to_lowercase(), &entry.name) else { continue };
        let message = if first == entry.name {
            "occurs more than once in the archive".to_owned()
        } else {
            format!("has the same name as {first} on systems that ignore case")
        };
        report.add(Rule::ZipDuplicate, &entry.name, message);
    }
}

fn top_level(archive: &Archive, report: &mut Report) {
    const DESCRIPTION: &str = "modelDescription.xml";
    if archive.find(DESCRIPTION).is_none() {
        let nested =
            archive.entries.iter().find(|entry| entry.name.ends_with("/modelDescription.xml"));
        let message = match nested {
            Some(entry) => format!(
                "is not at the top level but at {}; pack the folder's content, not the folder",
                entry.name
            ),
            None => "is missing from the archive".to_owned(),
        };
        report.add(Rule::ModelDescriptionMissing, DESCRIPTION, message);
        return;
    }
    for entry in &archive.entries {
        let known = TOP_LEVEL.iter().any(|known| match known.strip_suffix('/') {
            Some(_) => entry.name.starts_with(known),
            None => entry.name == *known,
        });
        // Names that are not safe paths are reported by the rule on names.
        if !known && entry.name != "./" && is_safe(entry) {
            let message = "is not part of the structure that FMI 2.0 describes: hosts ignore it; files that the model needs belong in resources/, other data in extra/";
            report.add(Rule::ZipUnknownEntry, &entry.name, message);
        }
    }
}
