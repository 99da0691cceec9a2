//! The libraries of every platform, read and not loaded.

mod elf;
mod functions;
mod platforms;

pub(super) use platforms::HOST;

use super::archive::{Archive, Entry};
use super::description::Description;
use super::options::Glibc;
use super::report::Report;
use super::rules::Rule;
use functions::FUNCTIONS;
use object::read::macho::{FatArch, MachOFatFile32, MachOFatFile64};
use object::read::{File, FileKind, NameOrOrdinal};
use object::{BinaryFormat, Object};
use platforms::Platform;
use std::collections::{BTreeMap, BTreeSet, HashSet};

/// A library of more bytes is not read.
const MOST_BYTES: u64 = 512 << 20;

/// Examines the libraries of all platforms; the name of the one for this host, if it may be loaded.
pub(super) fn examine(
    description: &Description<'_>,
    archive: &Archive,
    floor: Glibc,
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
            // What is damaged is told as that.
            Err(error) => {
                report.note(format!("{path} is not examined: {error}"));
                continue;
            }
        };
        let beside: Vec<_> = entries.into_iter().filter(|beside| beside.name != path).collect();
        let file = Library { path: &path, platform, archive, beside: &beside };
        if !file.examine(&content, floor, report) {
            continue;
        }
        if HOST == Some(folder) {
            host = Some(path);
        } else {
            report.note(format!("{path} is read, not run: it is for another system than this"));
        }
    }
    host
}

fn foreign_folder(folder: &str, report: &mut Report) {
    // FMI 3.0's names, as x86_64-linux, stand for platforms that FMI 2.0 has no name for.
    if folder
        .split_once('-')
        .is_some_and(|(processor, system)| !processor.is_empty() && !system.is_empty())
    {
        report.note(format!("binaries/{folder}/ is not examined: FMI 2.0 has no such platform"));
    } else {
        let known: Vec<_> = platforms::PLATFORMS.iter().map(|platform| platform.folder).collect();
        let message = format!("is no platform of FMI 2.0, which has {}", known.join(", "));
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
        [] => "is not there".to_owned(),
        _ => format!(
            "is not there, but {}; the library is called as modelIdentifier says",
            others.join(", ")
        ),
    };
    report.add(Rule::LibraryMissing, path, message);
}

struct Library<'a> {
    path: &'a str,
    platform: &'static Platform,
    archive: &'a Archive,
    beside: &'a [&'a Entry],
}

impl Library<'_> {
    /// Whether it is a library of its platform.
    fn examine(&self, content: &[u8], floor: Glibc, report: &mut Report) -> bool {
        let parts = match parts(content) {
            Ok(parts) => parts,
            Err(what) => {
                self.wrong_format(&what, report);
                return false;
            }
        };
        let fitting: Vec<_> = parts
            .iter()
            .filter(|part| {
                part.format() == self.platform.format
                    && self.platform.processors.contains(&part.architecture())
            })
            .collect();
        if fitting.is_empty() {
            let found: Vec<_> = parts
                .iter()
                .map(|part| format!("{:?} for {:?}", part.format(), part.architecture()))
                .collect();
            self.wrong_format(&found.join(", "), report);
            return false;
        }
        for part in fitting {
            self.functions(part, report);
            self.needed(part, report);
            let beside = |name: &str| self.beside_exports(name);
            match part {
                File::Elf32(file) => {
                    elf::examine(file, self.platform, (self.path, floor), &beside, report);
                }
                File::Elf64(file) => {
                    elf::examine(file, self.platform, (self.path, floor), &beside, report);
                }
                _ => {}
            }
        }
        true
    }

    fn wrong_format(&self, found: &str, report: &mut Report) {
        let Platform { folder, format, processors, .. } = self.platform;
        let message = format!("is {found}; {folder} wants {format:?} for {:?}", processors[0]);
        report.add(Rule::LibraryFormat, self.path, message);
    }

    fn functions(&self, file: &File<'_>, report: &mut Report) {
        let exported = exports(file);
        let lacking: Vec<_> =
            FUNCTIONS.iter().copied().filter(|name| !exported.contains(*name)).collect();
        if lacking.is_empty() {
            return;
        }
        let message = if lacking.len() == FUNCTIONS.len() {
            "exports no function of FMI 2.0 for co-simulation".to_owned()
        } else {
            format!(
                "does not export {}; importers ask for it also where it only answers fmi2Error",
                lacking.join(", ")
            )
        };
        report.add(Rule::FunctionMissing, self.path, message);
    }

    fn needed(&self, file: &File<'_>, report: &mut Report) {
        let needed: BTreeSet<String> = file
            .import_libraries()
            .into_iter()
            .flatten()
            .filter_map(|library| Some(String::from_utf8_lossy(library.ok()?.name()).into_owned()))
            .filter(|name| !name.is_empty())
            .collect();
        for library in needed.iter().filter(|library| !self.platform.has(library)) {
            let name = library.rsplit('/').next().unwrap_or(library);
            let is_beside = self.is_beside(name);
            let found = match file.format() {
                BinaryFormat::Pe => is_beside,
                BinaryFormat::MachO => is_beside && library.starts_with('@'),
                _ => is_beside && elf::looks_beside(file),
            };
            if found {
                continue;
            }
            let why = if is_beside {
                "which lies beside it, where the loader does not look (link with -rpath '$ORIGIN' or @loader_path)"
            } else if name.to_ascii_lowercase().starts_with("vcruntime")
                || name.to_ascii_lowercase().starts_with("msvcp")
            {
                "which is no part of Windows but of Visual C++'s runtime package (link with /MT)"
            } else {
                "which not every host has; link it statically or put it beside the library"
            };
            report.add(Rule::NeededLibrary, self.path, format!("needs {library}, {why}"));
        }
    }

    fn is_beside(&self, name: &str) -> bool {
        self.beside_entry(name).is_some()
    }

    fn beside_entry(&self, name: &str) -> Option<&Entry> {
        let path = format!("binaries/{}/{name}", self.platform.folder);
        self.beside.iter().find(|entry| entry.name.eq_ignore_ascii_case(&path)).copied()
    }

    /// What a library beside this one exports.
    fn beside_exports(&self, name: &str) -> Option<HashSet<String>> {
        let content = self.archive.content(self.beside_entry(name)?, MOST_BYTES).ok()?;
        Some(exports(&File::parse(&*content).ok()?))
    }
}

fn exports(file: &File<'_>) -> HashSet<String> {
    let underscore = file.format() == BinaryFormat::MachO;
    let name = |export: object::Export<'_>| {
        let NameOrOrdinal::Name(name) = export.name() else { return None };
        let name = String::from_utf8_lossy(name).into_owned();
        Some(if underscore {
            name.strip_prefix('_').map_or(name.clone(), str::to_owned)
        } else {
            name
        })
    };
    file.exports().into_iter().flatten().filter_map(|export| name(export.ok()?)).collect()
}

/// The libraries in a file: one, or one per processor.
fn parts(content: &[u8]) -> Result<Vec<File<'_>>, String> {
    fn fat<'a, Arch: FatArch>(arches: &[Arch], content: &'a [u8]) -> Vec<File<'a>> {
        let part = |arch: &Arch| File::parse(arch.data(content).ok()?).ok();
        arches.iter().filter_map(part).collect()
    }
    let unreadable = |error: object::Error| format!("not readable ({error})");
    match FileKind::parse(content).map_err(|_| "no library at all".to_owned())? {
        FileKind::MachOFat32 => MachOFatFile32::parse(content)
            .map(|file| fat(file.arches(), content))
            .map_err(unreadable),
        FileKind::MachOFat64 => MachOFatFile64::parse(content)
            .map(|file| fat(file.arches(), content))
            .map_err(unreadable),
        _ => File::parse(content).map(|file| vec![file]).map_err(unreadable),
    }
}
