//! Archives that break one rule: bytes of their headers are changed.

use super::fmu::{assert_breaks, check, rules, sound};
use std::io::{Cursor, Write};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

const CENTRAL: &[u8] = b"PK\x01\x02";
const LOCAL: &[u8] = b"PK\x03\x04";

/// Positions of the headers of this kind.
fn headers(bytes: &[u8], kind: &[u8]) -> Vec<usize> {
    (0..bytes.len() - 4).filter(|&at| &bytes[at..at + 4] == kind).collect()
}

/// Writes two bytes at a place of the last entry's header.
fn put(bytes: &mut [u8], kind: &[u8], offset: usize, value: u16) {
    let at = *headers(bytes, kind).last().unwrap() + offset;
    bytes[at..at + 2].copy_from_slice(&value.to_le_bytes());
}

fn sound_bytes() -> Vec<u8> {
    sound().pack()
}

#[test]
fn headers_say_what_fmi_allows() {
    let mut version = sound_bytes();
    put(&mut version, CENTRAL, 6, 45);
    assert_breaks("zip-version", &version, &["--no-run"]);

    let mut method = sound_bytes();
    put(&mut method, CENTRAL, 10, 12);
    put(&mut method, LOCAL, 8, 12);
    assert_breaks("zip-method", &method, &["--no-run"]);

    let mut encrypted = sound_bytes();
    put(&mut encrypted, CENTRAL, 8, 1);
    assert_breaks("zip-method", &encrypted, &["--no-run"]);

    let mut descriptor = sound_bytes();
    for (kind, flags, method) in [(CENTRAL, 8, 10), (LOCAL, 6, 8)] {
        put(&mut descriptor, kind, flags, 8);
        put(&mut descriptor, kind, method, 0);
    }
    let (code, printed) = check(&descriptor, &["--no-run"]);
    // What is deflated does not unpack as stored.
    assert_eq!((code, rules(&printed)), (1, ["zip-damaged", "zip-data-descriptor"].into()));

    let mut link = sound_bytes();
    put(&mut link, CENTRAL, 40, 0o120_777);
    assert_breaks("zip-link", &link, &["--no-run"]);
}

#[test]
fn entries_of_zip64_are_told() {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in sound().0 {
        let options = SimpleFileOptions::default().large_file(name == "resources/a.txt");
        writer.start_file(name, options).unwrap();
        writer.write_all(&content).unwrap();
    }
    assert_breaks("zip-version", &writer.finish().unwrap().into_inner(), &["--no-run"]);
}

#[test]
fn names_stay_inside_the_archive() {
    for name in
        ["resources/../../escape.txt", "/etc/escape.txt", "C:/escape.txt", "resources\\a.txt"]
    {
        // Both names have one length, so that the name can be changed in both headers.
        let plain = format!("resources/{}", "n".repeat(name.len() - 10));
        let mut bytes = sound().add(&plain, b"a").pack();
        for at in (0..bytes.len() - name.len()).rev() {
            if &bytes[at..at + name.len()] == plain.as_bytes() {
                bytes[at..at + name.len()].copy_from_slice(name.as_bytes());
            }
        }
        assert_breaks("zip-path", &bytes, &["--no-run"]);
        // Nor does the run write what would climb out; `check` looks at what is left.
        assert!(rules(&check(&bytes, &[]).1).contains("zip-path"));
    }
}

#[test]
fn names_that_some_hosts_read_otherwise_get_a_hint() {
    for name in ["resources//b.txt", "resources/./b.txt", "resources/\u{7}.txt"] {
        let (code, printed) = check(&sound().add(name, b"a").pack(), &["--no-run"]);
        assert!(code == 0 && printed.starts_with("hint: zip-path "), "{printed}");
    }
}

#[test]
fn contents_are_what_the_headers_say() {
    let mut checksum = sound_bytes();
    put(&mut checksum, CENTRAL, 16, 0xdead);
    put(&mut checksum, LOCAL, 14, 0xdead);
    assert_breaks("zip-damaged", &checksum, &["--no-run"]);

    let mut headers_differ = sound_bytes();
    put(&mut headers_differ, LOCAL, 14, 0xdead);
    assert_breaks("zip-damaged", &headers_differ, &["--no-run"]);

    let mut content = sound_bytes();
    let at = headers(&content, LOCAL)[3] + 30 + "sources/decay.c".len() + 100;
    content[at] ^= 0xff;
    assert_breaks("zip-damaged", &content, &["--no-run"]);
}

#[test]
fn what_is_in_it_has_its_place() {
    assert_breaks("zip-unknown-entry", &sound().add("readme.txt", b"a").pack(), &["--no-run"]);
    let duplicate = sound().add("resources/A.txt", b"a");
    assert_breaks("zip-duplicate", &duplicate.pack(), &["--no-run"]);
    let mut nested = sound();
    for (name, _) in &mut nested.0 {
        *name = format!("decay/{name}");
    }
    let printed = assert_breaks("model-description-missing", &nested.pack(), &[]);
    assert!(printed.contains("decay/modelDescription.xml"), "{printed}");
}

#[test]
fn a_bomb_is_not_unpacked() {
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    writer.start_file("modelDescription.xml", options).unwrap();
    writer.write_all(b"<a/>").unwrap();
    let zeros = vec![0; 1 << 20];
    writer.start_file("resources/zeros", options).unwrap();
    for _ in 0..300 {
        writer.write_all(&zeros).unwrap();
    }
    let bomb = writer.finish().unwrap().into_inner();
    assert_breaks("zip-bomb", &bomb, &[]);

    // One that lies about its size is cut off where its lie ends.
    let mut lie = sound().add("resources/zeros", &vec![0; 1 << 24]).pack();
    put(&mut lie, CENTRAL, 24, 100);
    put(&mut lie, CENTRAL, 26, 0);
    put(&mut lie, LOCAL, 22, 100);
    put(&mut lie, LOCAL, 24, 0);
    assert_breaks("zip-damaged", &lie, &["--no-run"]);
}

#[test]
fn contents_that_lie_in_one_place_are_not_unpacked() {
    let mut bytes = sound_bytes();
    let last = *headers(&bytes, CENTRAL).last().unwrap();
    let end = headers(&bytes, b"PK\x05\x06")[0];
    let header = bytes[last..end].to_vec();
    bytes.splice(end..end, header.repeat(50));
    let end = end + 50 * header.len();
    // The counts of entries and the size of the directory.
    for (offset, more) in [(8, 50), (10, 50), (12, 50 * header.len())] {
        let at = end + offset;
        let stated = usize::from(u16::from_le_bytes([bytes[at], bytes[at + 1]]));
        bytes[at..at + 2].copy_from_slice(&u16::try_from(stated + more).unwrap().to_le_bytes());
    }
    let (code, printed) = check(&bytes, &["--no-run"]);
    assert_eq!((code, rules(&printed)), (3, ["zip-bomb", "zip-duplicate"].into()), "{printed}");
    assert!(printed.contains("entries overlap"), "{printed}");
}

#[test]
fn what_is_no_archive_is_no_fmu() {
    let mut size_of_directory = sound_bytes();
    put(&mut size_of_directory, b"PK\x05\x06", 14, 1);
    for bytes in [&b""[..], b"PK", b"not a zip archive", &sound_bytes()[..5000], &size_of_directory]
    {
        assert_eq!(check(bytes, &[]), (2, String::new()));
    }
}
