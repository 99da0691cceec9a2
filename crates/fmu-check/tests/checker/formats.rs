//! Libraries of other systems than this, written byte by byte as their formats want it.

use super::fmu::{
    Files, LIBRARY, assert_breaks, check, functions, library, rules, sound, with_library,
};

const WIN64: &str = "binaries/win64/decay.dll";
const DARWIN64: &str = "binaries/darwin64/decay.dylib";

/// Appends numbers of 32 bits.
fn words(bytes: &mut Vec<u8>, words: &[u32]) {
    bytes.extend(words.iter().flat_map(|word| word.to_le_bytes()));
}

fn put(bytes: &mut [u8], at: usize, value: &[u8]) {
    bytes[at..at + value.len()].copy_from_slice(value);
}

fn word(length: usize) -> u32 {
    u32::try_from(length).unwrap()
}

/// A library for 64-bit Windows (Microsoft's PE format) that exports and needs these.
pub fn pe(exports: &[String], needed: &[&str]) -> Vec<u8> {
    const BASE: usize = 0x1000;
    let (tables, count) = (40, exports.len());
    let imports = tables + 10 * count;
    let mut strings = imports + 20 * (needed.len() + 1);
    let (mut texts, mut places) = (Vec::new(), Vec::new());
    for text in exports.iter().map(String::as_str).chain(needed.iter().copied()) {
        places.push(word(BASE + strings));
        texts.extend(text.bytes().chain([0]));
        strings += text.len() + 1;
    }
    // The table of exports: its header, addresses, names, ordinals.
    let mut section = Vec::new();
    let at = |offset: usize| word(BASE + tables + offset * count);
    words(&mut section, &[0, 0, 0, places[0], 1, word(count), word(count), at(0), at(4), at(8)]);
    words(&mut section, &vec![0x100; count]);
    words(&mut section, &places[..count]);
    section.extend((0..count).flat_map(|ordinal| u16::try_from(ordinal).unwrap().to_le_bytes()));
    for place in &places[count..] {
        words(&mut section, &[0, 0, 0, *place, 0]);
    }
    section.extend([0; 20]);
    section.extend(texts);

    let mut bytes = vec![0; 512];
    put(&mut bytes, 0, b"MZ");
    put(&mut bytes, 60, &64_u32.to_le_bytes());
    put(&mut bytes, 64, b"PE\0\0");
    // x86-64, one section, an optional header of 240 bytes, a DLL.
    put(&mut bytes, 68, &[0x64, 0x86, 1, 0]);
    put(&mut bytes, 84, &[240, 0, 0x22, 0x20]);
    put(&mut bytes, 88, &[0x0b, 0x02]);
    put(&mut bytes, 88 + 32, &[0, 0x10, 0, 0, 0, 2, 0, 0]);
    put(&mut bytes, 88 + 108, &[16]);
    let mut directories = Vec::new();
    words(
        &mut directories,
        &[word(BASE), word(strings), word(BASE + imports), word(strings - imports)],
    );
    put(&mut bytes, 88 + 112, &directories);
    put(&mut bytes, 328, b".rdata");
    let mut header = Vec::new();
    words(&mut header, &[word(section.len()), word(BASE), word(section.len()), 512]);
    put(&mut bytes, 336, &header);
    bytes.extend(section);
    bytes
}

pub const X86_64: u32 = 0x0100_0007;
pub const ARM64: u32 = 0x0100_000c;

/// A library for macOS (Apple's Mach-O format) that exports and needs these.
pub fn macho(processor: u32, exports: &[String], needed: &[&str]) -> Vec<u8> {
    let mut commands = Vec::new();
    for library in needed {
        let size = (24 + library.len() + 8) / 8 * 8;
        words(&mut commands, &[0xc, word(size), 24, 0, 0, 0]);
        commands.extend(library.bytes());
        commands.resize(commands.len() + size - 24 - library.len(), 0);
    }
    let symbols = 32 + commands.len() + 24;
    let texts = symbols + 16 * exports.len();
    let (mut table, mut names) = (Vec::new(), vec![0]);
    for name in exports {
        // Absolute and external.
        words(&mut table, &[word(names.len()), 0x03, 0, 0]);
        names.extend(format!("_{name}\0").bytes());
    }
    words(
        &mut commands,
        &[2, 24, word(symbols), word(exports.len()), word(texts), word(names.len())],
    );
    let mut bytes = Vec::new();
    let count = word(needed.len() + 1);
    words(&mut bytes, &[0xfeed_facf, processor, 3, 6, count, word(commands.len()), 0, 0]);
    [bytes, commands, table, names].concat()
}

/// Libraries for several processors in one file.
fn universal(parts: &[(u32, Vec<u8>)]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut at = 4096;
    let mut header = vec![0xcafe_babe_u32, word(parts.len())];
    for (processor, part) in parts {
        header.extend([*processor, 3, word(at), word(part.len()), 12]);
        at += part.len().next_multiple_of(4096);
    }
    bytes.extend(header.iter().flat_map(|word| word.to_be_bytes()));
    for (_, part) in parts {
        bytes.resize(bytes.len().next_multiple_of(4096), 0);
        bytes.extend(part);
    }
    bytes
}

fn but_reset() -> Vec<String> {
    functions().into_iter().filter(|name| name != "fmi2Reset").collect()
}

fn windows(library: &[u8]) -> Files {
    sound().add(WIN64, library)
}

fn mac(library: &[u8]) -> Files {
    sound().add(DARWIN64, library)
}

pub fn assert_passes(fmu: &Files) {
    let (code, printed) = check(&fmu.pack(), &["--no-run"]);
    assert_eq!((code, rules(&printed)), (0, [].into()), "{printed}");
    assert!(printed.contains("is read but not run"), "{printed}");
}

fn assert_found(rule: &str, words: &str, fmu: &Files) {
    let printed = assert_breaks(rule, &fmu.pack(), &["--no-run"]);
    assert!(printed.contains(words), "{words}: {printed}");
}

#[test]
fn libraries_for_windows_are_read() {
    let all = functions();
    let sound = pe(&all, &["KERNEL32.dll", "api-ms-win-crt-heap-l1-1-0.dll"]);
    assert_passes(&windows(&sound));
    assert_found(
        "function-missing",
        "does not export fmi2Reset;",
        &windows(&pe(&but_reset(), &[])),
    );
    assert_found("function-missing", "exports no function", &windows(&pe(&["a".to_owned()], &[])));
    let runtime = windows(&pe(&all, &["VCRUNTIME140.dll"]));
    assert_found("needed-library", "/MT", &runtime);
    assert_passes(&runtime.add("binaries/win64/vcruntime140.dll", &sound));
    let mut program = sound.clone();
    program[87] = 0;
    assert_found("library-format", "not a shared library", &windows(&program));
    let mut arm = sound.clone();
    put(&mut arm, 68, &[0x64, 0xaa]);
    assert_found("library-format", "Aarch64; win64 requires Pe for X86_64", &windows(&arm));
    assert_found("library-format", "not readable", &windows(&sound[..300]));
    assert_found("library-format", "cut off (it has 600 bytes", &windows(&sound[..600]));
}

#[test]
fn libraries_for_macos_are_read() {
    let all = functions();
    let sound = macho(X86_64, &all, &["/usr/lib/libSystem.B.dylib"]);
    assert_passes(&mac(&sound));
    assert_found(
        "function-missing",
        "does not export fmi2Reset;",
        &mac(&macho(X86_64, &but_reset(), &[])),
    );
    let homebrew = macho(X86_64, &all, &["/opt/homebrew/lib/libomp.dylib"]);
    assert_found("needed-library", "not every host has", &mac(&homebrew));
    let beside = mac(&macho(X86_64, &all, &["@loader_path/libomp.dylib"]));
    assert_found("needed-library", "not every host has", &beside);
    assert_passes(&beside.add("binaries/darwin64/libomp.dylib", &sound));
    let mut program = sound.clone();
    program[12] = 2;
    assert_found("library-format", "not a shared library", &mac(&program));
    assert_found("library-format", "MachO for PowerPc", &mac(&macho(18, &all, &[])));
    let two =
        |arm: &[String]| universal(&[(X86_64, sound.clone()), (ARM64, macho(ARM64, arm, &[]))]);
    assert_passes(&mac(&two(&all)));
    assert_found("function-missing", "does not export fmi2Reset;", &mac(&two(&but_reset())));
    assert_found("library-format", "damaged", &mac(&sound[..100]));
}

#[test]
fn libraries_that_are_cut_off_or_damaged_anywhere_are_told_or_read() {
    let elf = library(&[]);
    let pe = pe(&functions(), &["KERNEL32.dll"]);
    let macho = macho(X86_64, &functions(), &["/usr/lib/libSystem.B.dylib"]);
    let examine = |elf: &[u8], pe: &[u8], macho: &[u8]| {
        let fmu = with_library(elf.to_vec()).add(WIN64, pe).add(DARWIN64, macho).pack();
        let (code, printed) = check(&fmu, &["--no-run"]);
        assert!(matches!(code, 0 | 1), "{printed}");
        (code, printed)
    };
    for part in 0..64 {
        let cut = |bytes: &[u8]| bytes[..bytes.len() * part / 64].to_vec();
        let (code, printed) = examine(&cut(&elf), &cut(&pe), &cut(&macho));
        assert_eq!(code, 1);
        for path in [LIBRARY, WIN64, DARWIN64] {
            let is_told = |line: &str| line.contains(path) && !line.starts_with("note: ");
            assert!(printed.lines().any(is_told), "{part} of 64 of {path}: {printed}");
        }
    }
    for at in (4..512).step_by(3) {
        let damaged = |bytes: &[u8], value| {
            let mut bytes = bytes.to_vec();
            put(&mut bytes, at, &[value; 3]);
            bytes
        };
        for value in [0xff, 0x7f] {
            examine(&damaged(&elf, value), &damaged(&pe, value), &damaged(&macho, value));
        }
    }
}
