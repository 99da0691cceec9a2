//! FMUs in the ways of other exporters, which the standard allows: none of them may be condemned.

use super::fmu::{Files, LIBRARY, assert_breaks, check, functions, library, sound};
use super::formats::{ARM64, X86_64, assert_passes, macho, pe};
use std::io::Write;
use zip::write::{SimpleFileOptions, StreamWriter};
use zip::{CompressionMethod, ZipWriter};

/// An archive as programs write it that cannot go back to the header: the sizes follow each content.
fn streamed(files: &Files, method: CompressionMethod) -> Vec<u8> {
    let options = SimpleFileOptions::default().compression_method(method);
    let mut writer: ZipWriter<StreamWriter<Vec<u8>>> = ZipWriter::new_stream(Vec::new());
    writer.add_directory("resources/", options).unwrap();
    for (name, content) in &files.0 {
        writer.start_file(name.as_str(), options).unwrap();
        writer.write_all(content).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

#[test]
fn deflated_entries_may_have_data_descriptors_and_stored_ones_not() {
    let deflated = streamed(&sound(), CompressionMethod::Deflated);
    assert_eq!(check(&deflated, &[]), (0, String::new()));
    let stored = streamed(&sound(), CompressionMethod::Stored);
    let printed = assert_breaks("zip-data-descriptor", &stored, &["--no-run"]);
    assert!(!printed.contains("resources/:"), "{printed}");
}

#[test]
fn paths_of_sources_may_begin_with_the_present_folder() {
    let listed = sound().edit(
        "<File name=\"decay.c\"/>",
        "<File name=\"./decay.c\"/><File name=\"./util/../util/x.c\"/>",
    );
    let lacking = listed.clone().add("sources/x.c", b"");
    let printed = assert_breaks("source-file-missing", &lacking.pack(), &["--no-run"]);
    assert_eq!(printed.lines().count(), 1, "{printed}");
    assert_eq!(check(&listed.add("sources/util/x.c", b"").pack(), &[]), (0, String::new()));
}

#[test]
fn a_source_fmu_needs_no_library() {
    let mut files = sound();
    files.0.retain(|(name, _)| name != LIBRARY);
    let (code, printed) = check(&files.pack(), &[]);
    assert_eq!(code, 0, "{printed}");
    assert!(printed.starts_with("note: nothing is run: "), "{printed}");
    // With neither, there is no implementation.
    files.0.retain(|(name, _)| name != "sources/decay.c");
    let files = files
        .edit("    <SourceFiles>\n      <File name=\"decay.c\"/>\n    </SourceFiles>\n", "")
        .add("binaries/linux64/", b"");
    let printed = assert_breaks("library-missing", &files.pack(), &["--no-run"]);
    assert!(printed.contains("neither a library nor a source file"), "{printed}");
}

#[test]
fn model_exchange_may_stand_beside_co_simulation() {
    for (identifier, library) in
        [("decay", None), ("decay_me", Some("binaries/linux64/decay_me.so"))]
    {
        let exchange =
            format!("<ModelExchange modelIdentifier=\"{identifier}\"/>\n  <CoSimulation");
        let mut files = sound().edit("<CoSimulation", &exchange);
        if let Some(path) = library {
            files = files.add(path, &super::fmu::library(&[]));
        }
        assert_eq!(check(&files.pack(), &[]), (0, String::new()), "{identifier}");
    }
}

#[test]
fn several_platforms_lie_in_one_fmu() {
    let all = functions();
    let apple = macho(ARM64, &all, &["/usr/lib/libSystem.B.dylib"]);
    let intel = macho(X86_64, &all, &[]);
    let files = sound()
        .add("binaries/win64/decay.dll", &pe(&all, &["KERNEL32.dll"]))
        .add("binaries/darwin64/decay.dylib", &intel)
        .add("binaries/aarch64-darwin/decay.dylib", &apple);
    assert_passes(&files);
    let (_, printed) = check(&files.pack(), &["--no-run"]);
    assert!(printed.contains("note: binaries/aarch64-darwin/decay.dylib is read"), "{printed}");
    let wrong = sound().add("binaries/aarch64-darwin/decay.dylib", &intel);
    assert_breaks("library-format", &wrong.pack(), &["--no-run"]);
}

#[test]
fn libraries_that_every_windows_has_may_be_needed() {
    let needed = ["imagehlp.dll", "dhcpcsvc.DLL", "MSVCRT.dll", "WINSPOOL.DRV", "bthprops.cpl"];
    let set = ["api-ms-win-crt-heap-l1-1-0.dll", "ext-ms-win-ntuser-window-l1-1-0.dll"];
    let files = sound().add("binaries/win64/decay.dll", &pe(&functions(), &needed));
    assert_passes(&files);
    assert_passes(&sound().add("binaries/win64/decay.dll", &pe(&functions(), &set)));
}

#[test]
fn a_platform_folder_may_be_empty_or_hold_object_libraries_only() {
    let empty = sound().add("binaries/linux32/", b"").add("binaries/win32/VisualStudio15/", b"");
    assert_eq!(check(&empty.pack(), &[]), (0, String::new()));
    let objects = sound()
        .add("binaries/win32/VisualStudio8/decay.lib", b"a")
        .add("binaries/linux32/gcc3.1/decay.a", b"a");
    let (code, printed) = check(&objects.pack(), &[]);
    assert_eq!(code, 0, "{printed}");
    assert!(printed.lines().all(|line| line.contains("object libraries only")), "{printed}");
}

#[test]
fn names_on_windows_may_differ_in_case() {
    let dll = pe(&functions(), &[]);
    let (code, printed) =
        check(&sound().add("binaries/win64/Decay.dll", &dll).pack(), &["--no-run"]);
    assert_eq!(code, 0, "{printed}");
    assert!(
        printed.starts_with("hint: library-missing binaries/win64/decay.dll: is named "),
        "{printed}"
    );
    assert!(printed.contains("Decay.dll is read but not run"), "{printed}");
    let linux = sound().rename(LIBRARY, "binaries/linux64/Decay.so");
    assert_breaks("library-missing", &linux.pack(), &[]);
}

#[test]
fn the_top_level_may_be_an_entry() {
    assert_eq!(check(&sound().add("./", b"").pack(), &["--no-run"]), (0, String::new()));
}

#[test]
fn symbols_that_a_host_may_provide_get_a_hint() {
    let files = super::fmu::with_library(library(&["-DFAULT_undefined"]));
    assert_breaks("symbol-undefined", &files.pack(), &["--no-run"]);
}
