//! Rules on ELF libraries alone: versions of symbols, search paths, executable stack.

use super::library::is_usual;
use super::platforms::Platform;
use crate::options::Glibc;
use crate::report::Report;
use crate::rules::{Class, Rule};
use object::elf::{DT_NEEDED, DT_RPATH, DT_RUNPATH, PF_X, PT_GNU_STACK, STB_GLOBAL, SymbolBind};
use object::read::elf::{ElfFile, FileHeader, ProgramHeader, Sym};
use object::{Endianness, File};
use std::collections::{BTreeMap, HashSet};

/// Limit of the number of undefined symbols that are looked up.
const MOST_SYMBOLS: usize = 100_000;

type Exports<'a> = &'a dyn Fn(&str) -> Option<HashSet<String>>;

pub(super) fn examine<Elf: FileHeader<Endian = Endianness>>(
    file: &ElfFile<'_, Elf>,
    platform: &Platform,
    (path, floor): (&str, Option<Glibc>),
    beside: Exports<'_>,
    report: &mut Report,
) {
    stack(file, path, report);
    for entry in entries(file) {
        if matches!(entry.0, Tag::RunPath) {
            for folder in entry.1.split(':').filter(|folder| below_origin(folder).is_none()) {
                let folder = if folder.is_empty() { "the current folder" } else { folder };
                let message = format!(
                    "searches {folder} for libraries; search paths must begin with $ORIGIN, the library's own folder"
                );
                report.add(Rule::RunPath, path, message);
            }
        }
    }
    let versions = Versions::read(file);
    glibc(&versions, path, floor, report);
    undefined(file, platform, path, &versions, beside, report);
}

/// Folders in which the loader searches for other libraries, relative to the folder of this library.
pub(super) fn search_folders(file: &File<'_>) -> Vec<String> {
    let entries = match file {
        File::Elf32(file) => entries(file),
        File::Elf64(file) => entries(file),
        _ => Vec::new(),
    };
    let paths = entries.iter().filter(|(tag, _)| matches!(tag, Tag::RunPath));
    paths
        .flat_map(|(_, folders)| folders.split(':').filter_map(below_origin))
        .map(str::to_owned)
        .collect()
}

/// Returns the part of a search path after `$ORIGIN`; `None` if the path does not begin with it.
fn below_origin(folder: &str) -> Option<&str> {
    let rest = folder.strip_prefix("$ORIGIN").or_else(|| folder.strip_prefix("${ORIGIN}"))?;
    (rest.is_empty() || rest.starts_with('/')).then_some(rest)
}

enum Tag {
    Needed,
    RunPath,
}

/// Entries of the dynamic section that hold names.
fn entries<Elf: FileHeader<Endian = Endianness>>(file: &ElfFile<'_, Elf>) -> Vec<(Tag, String)> {
    let Ok(table) = file.elf_dynamic_table() else { return Vec::new() };
    let name = |entry| Some(String::from_utf8_lossy(table.string(entry).ok()?).into_owned());
    let entry = |entry: object::read::elf::Dynamic| match entry.tag {
        DT_NEEDED => Some((Tag::Needed, name(entry)?)),
        DT_RPATH | DT_RUNPATH => Some((Tag::RunPath, name(entry)?)),
        _ => None,
    };
    table.iter().filter_map(entry).collect()
}

fn stack<Elf: FileHeader<Endian = Endianness>>(
    file: &ElfFile<'_, Elf>,
    path: &str,
    report: &mut Report,
) {
    let endian = file.endian();
    let header =
        file.elf_program_headers().iter().find(|header| header.p_type(endian) == PT_GNU_STACK);
    let why = match header {
        None => "has no GNU_STACK header, so its stack is executable",
        Some(header) if header.p_flags(endian).contains(PF_X) => "asks for an executable stack",
        Some(_) => return,
    };
    let message = format!("{why}; hardened hosts refuse to load it (link with -z noexecstack)");
    report.add(Rule::ExecutableStack, path, message);
}

/// Versions of symbols that a library needs: by index, the needed library and the version's name; and the undefined
/// symbols, each with the index of its version.
struct Versions {
    needed: BTreeMap<u16, (String, String)>,
    symbols: Vec<(String, Option<u16>)>,
}

impl Versions {
    /// Reads the undefined symbols that are not weak, and their versions.
    fn read<Elf: FileHeader<Endian = Endianness>>(file: &ElfFile<'_, Elf>) -> Self {
        let (endian, data) = (file.endian(), file.data());
        let sections = file.elf_section_table();
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let table = sections.versions(endian, data).ok().flatten().unwrap_or_default();
        let symbols = file.elf_dynamic_symbol_table();
        let mut needed = BTreeMap::new();
        if let Ok(Some((mut libraries, link))) = sections.gnu_verneed(endian, data)
            && let Ok(strings) = sections.strings(endian, data, link)
        {
            while let Ok(Some((library, mut versions))) = libraries.next() {
                while let Ok(Some(version)) = versions.next() {
                    let names = (library.file(endian, strings), version.name(endian, strings));
                    if let (Ok(library), Ok(name)) = names {
                        let index = version.vna_other(endian).index();
                        needed.insert(index.0, (text(library), text(name)));
                    }
                }
            }
        }
        let wanted = |symbol: &Elf::Sym| {
            let bind: SymbolBind = symbol.st_bind();
            symbol.is_undefined(endian) && bind == STB_GLOBAL && symbol.st_name(endian) != 0
        };
        let symbols = symbols
            .enumerate()
            .filter(|(_, symbol)| wanted(symbol))
            .filter_map(|(index, symbol)| {
                let version = table.version_index(endian, index).index().0;
                let name =
                    symbols.symbol_name(endian, symbol).ok().filter(|name| is_usual(name))?;
                Some((text(name), (version > 1).then_some(version)))
            })
            .take(MOST_SYMBOLS)
            .collect();
        Self { needed, symbols }
    }
}

/// Reports a newer glibc than the floor asked for as a defect; if no floor is asked for, one newer than the default as
/// a hint.
fn glibc(versions: &Versions, path: &str, asked: Option<Glibc>, report: &mut Report) {
    let floor = asked.unwrap_or_default();
    let version = |name: &str| match name {
        // Relative relocations, which glibc reads since version 2.36.
        "GLIBC_ABI_DT_RELR" => Some(Glibc(2, 36)),
        _ => name.strip_prefix("GLIBC_").and_then(|name| name.parse().ok()),
    };
    let highest = versions
        .needed
        .iter()
        .filter_map(|(index, (_, name))| Some((version(name)?, index, name)))
        .max_by_key(|(version, ..)| *version);
    let Some((highest, index, name)) = highest.filter(|(highest, ..)| *highest > floor) else {
        return;
    };
    let symbols: Vec<_> = versions
        .symbols
        .iter()
        .filter(|(_, version)| *version == Some(*index))
        .map(|(symbol, _)| symbol.as_str())
        .take(4)
        .collect();
    let message = format!(
        "needs glibc {highest} ({name}{}{}); hosts with glibc {floor} cannot load it",
        if symbols.is_empty() { "" } else { ", for " },
        symbols.join(", ")
    );
    let class = if asked.is_some() { Class::Defect } else { Rule::GlibcFloor.class() };
    report.add_as(class, Rule::GlibcFloor, path, message);
}

fn undefined<Elf: FileHeader<Endian = Endianness>>(
    file: &ElfFile<'_, Elf>,
    platform: &Platform,
    path: &str,
    versions: &Versions,
    beside: Exports<'_>,
    report: &mut Report,
) {
    let mut provided = HashSet::new();
    for (_, library) in entries(file).into_iter().filter(|(tag, _)| matches!(tag, Tag::Needed)) {
        if platform.has(&library) {
            continue;
        }
        // The exports of a library that is not in the archive are unknown, so undefined symbols cannot be judged.
        let Some(exports) = beside(&library) else { return };
        provided.extend(exports);
    }
    // Every symbol of a system library carries a version.
    let lacking: Vec<_> = versions
        .symbols
        .iter()
        .filter(|(name, version)| version.is_none() && !provided.contains(name))
        .map(|(name, _)| name.as_str())
        .collect();
    if !lacking.is_empty() {
        let some = lacking[..lacking.len().min(5)].join(", ");
        let more = if lacking.len() > 5 {
            format!(" and {} more", lacking.len() - 5)
        } else {
            String::new()
        };
        let message = format!(
            "has undefined symbols that no linked library provides: {some}{more} (the linker option -z defs reports them)"
        );
        report.add(Rule::SymbolUndefined, path, message);
    }
}
