//! Rules on a library of any format: platform and file format, exported functions, needed libraries.

use super::functions::FUNCTIONS;
use super::platforms::Platform;
use super::{MOST_BYTES, elf};
use crate::archive::{Archive, Entry, plain};
use crate::options::Glibc;
use crate::report::Report;
use crate::rules::Rule;
use object::read::macho::{FatArch, MachOFatFile32, MachOFatFile64};
use object::read::{File, FileKind, NameOrOrdinal};
use object::{BinaryFormat, Object, ObjectKind, ObjectSegment};
use std::collections::{BTreeSet, HashSet};

/// Limit of the number of processors for which one library file is read.
const MOST_PARTS: usize = 16;

/// A library of a platform and the other files of its folder.
pub(super) struct PlatformLibrary<'a> {
    pub(super) path: &'a str,
    pub(super) platform: &'static Platform,
    pub(super) archive: &'a Archive,
    /// Other entries in the library's folder.
    pub(super) beside: &'a [&'a Entry],
}

impl PlatformLibrary<'_> {
    /// Examines the library. Returns `true` if it is a shared library of its platform.
    pub(super) fn examine(
        &self,
        content: &[u8],
        floor: Option<Glibc>,
        report: &mut Report,
    ) -> bool {
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
        if fitting.iter().any(|part| {
            matches!(
                part.kind(),
                ObjectKind::Executable | ObjectKind::Relocatable | ObjectKind::Core
            )
        }) {
            self.wrong_format("not a shared library but a program or an object file", report);
            return false;
        }
        let reach = fitting.iter().flat_map(|part| part.segments()).map(|segment| {
            let (place, size) = segment.file_range();
            place.saturating_add(size)
        });
        let (reach, length) = (reach.max().unwrap_or(0), content.len() as u64);
        if reach > length {
            let message = format!("cut off (it has {length} bytes, but its headers state {reach})");
            self.wrong_format(&message, report);
            return false;
        }
        for part in fitting {
            self.functions(part, report);
            self.needed(part, report);
            let beside = |name: &str| self.other_exports(part, name);
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
        let processors: Vec<_> = processors.iter().map(|name| format!("{name:?}")).collect();
        let wanted = processors.join(" or ");
        let message = format!("is {found}; {folder} requires {format:?} for {wanted}");
        report.add(Rule::LibraryFormat, self.path, message);
    }

    fn functions(&self, file: &File<'_>, report: &mut Report) {
        let mut exported: HashSet<&str> = HashSet::new();
        let read = for_each_export(file, |name| {
            exported.extend(FUNCTIONS.iter().copied().find(|function| function.as_bytes() == name));
        });
        if let Err(error) = read {
            self.wrong_format(
                &format!("damaged: its table of exports cannot be read ({error})"),
                report,
            );
            return;
        }
        let lacking: Vec<_> =
            FUNCTIONS.iter().copied().filter(|name| !exported.contains(name)).collect();
        if lacking.is_empty() {
            return;
        }
        let message = if lacking.len() == FUNCTIONS.len() {
            "exports no function of FMI 2.0 for co-simulation".to_owned()
        } else {
            format!(
                "does not export {}; FMI requires all functions, even those that only return fmi2Error",
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
            let is_beside = self.beside(name).is_some();
            let found = match file.format() {
                BinaryFormat::Pe => is_beside,
                BinaryFormat::MachO => is_beside && library.starts_with('@'),
                _ => self.found(file, name).is_some(),
            };
            if found {
                continue;
            }
            let why = if is_beside {
                "which lies beside it, but the loader does not search there (link with -rpath '$ORIGIN' or @loader_path)"
            } else if name.to_ascii_lowercase().starts_with("vcruntime")
                || name.to_ascii_lowercase().starts_with("msvcp")
            {
                "which belongs to the Visual C++ runtime package, not to Windows (link with /MT)"
            } else {
                "which not every host has; link it statically or put it beside the library"
            };
            report.add(Rule::NeededLibrary, self.path, format!("needs {library}, {why}"));
        }
    }

    /// Returns another library in the same folder.
    fn beside(&self, name: &str) -> Option<&Entry> {
        let path = format!("binaries/{}/{name}", self.platform.folder);
        self.beside.iter().find(|entry| entry.name.eq_ignore_ascii_case(&path)).copied()
    }

    /// Returns another library at the places where the loader searches.
    fn found(&self, file: &File<'_>, name: &str) -> Option<&Entry> {
        elf::search_folders(file).iter().find_map(|folder| {
            self.archive.find(&plain(&format!("binaries/{}{folder}/{name}", self.platform.folder))?)
        })
    }

    /// Names that another library in the archive exports; `None` if it is not there or cannot be read.
    fn other_exports(&self, file: &File<'_>, name: &str) -> Option<HashSet<String>> {
        let entry = self.found(file, name).or_else(|| self.beside(name))?;
        let content = self.archive.content(entry, MOST_BYTES).ok()?;
        let mut names = HashSet::new();
        for_each_export(&File::parse(&*content).ok()?, |name| {
            if is_usual(name) {
                names.insert(String::from_utf8_lossy(name).into_owned());
            }
        })
        .ok()?;
        Some(names)
    }
}

/// `true` if a name is no longer than the names that compilers make; longer names are ignored.
pub(super) fn is_usual(name: &[u8]) -> bool {
    name.len() <= 4096
}

/// Calls `each` with every name that a library exports, as far as its table can be read.
fn for_each_export(file: &File<'_>, mut each: impl FnMut(&[u8])) -> Result<(), object::Error> {
    let underscore = file.format() == BinaryFormat::MachO;
    for export in file.exports()? {
        if let NameOrOrdinal::Name(name) = export?.name() {
            each(name.strip_prefix(b"_").filter(|_| underscore).unwrap_or(name));
        }
    }
    Ok(())
}

/// Returns the libraries in a file: one, or one for each processor.
fn parts(content: &[u8]) -> Result<Vec<File<'_>>, String> {
    fn fat<'a, Arch: FatArch>(arches: &[Arch], content: &'a [u8]) -> Vec<File<'a>> {
        let part = |arch: &Arch| File::parse(arch.data(content).ok()?).ok();
        arches.iter().take(MOST_PARTS).filter_map(part).collect()
    }
    let unreadable = |error: object::Error| format!("not readable ({error})");
    match FileKind::parse(content).map_err(|_| "not a library".to_owned())? {
        FileKind::MachOFat32 => MachOFatFile32::parse(content)
            .map(|file| fat(file.arches(), content))
            .map_err(unreadable),
        FileKind::MachOFat64 => MachOFatFile64::parse(content)
            .map(|file| fat(file.arches(), content))
            .map_err(unreadable),
        _ => File::parse(content).map(|file| vec![file]).map_err(unreadable),
    }
}
