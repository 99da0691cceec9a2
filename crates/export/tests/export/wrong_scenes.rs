//! The reader's messages on wrong scene files. Each page `tests/wrong_scenes/*.md` has scenes, each above the whole
//! message that its user gets; `AMONTONS_WRITE=1 cargo test --release --locked --test export wrong_scenes` writes the
//! messages anew.

use crate::page::{cases, pages};
use amontons::scene::BUILTIN;
use amontons::simulation::Simulation;
use amontons_export::scene::{parse, read};
use proptest::prelude::*;
use std::fs;
use std::path::Path;

/// The message on the first of these files, a wrong scene, with the names of files in place of their paths.
#[track_caller]
fn message(files: &[(String, impl AsRef<[u8]>)]) -> String {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).unwrap();
    for (name, content) in files {
        fs::write(folder.path().join(name), content).unwrap();
    }
    let error = read(&folder.path().join(&files[0].0)).expect_err("the scene is wrong");
    error.to_string().replace(&format!("{}/", folder.path().display()), "") + "\n"
}

#[test]
fn every_wrong_scene_gets_its_message() {
    let (mut wrong, mut count) = (Vec::new(), 0);
    for (path, text) in pages() {
        let mut sections: Vec<String> = text.split("\n## ").map(str::to_owned).collect();
        for (case, section) in cases(&text).iter().zip(&mut sections[1..]) {
            count += 1;
            let (found, expected) = (message(&case.files), case.message);
            if found != expected {
                wrong.push(format!("{}\n{found}\nbut expected is\n{expected}", case.name));
                let block = |message: &str| format!("```text\n{message}```");
                *section = section.replacen(&block(expected), &block(&found), 1);
            }
        }
        if std::env::var_os("AMONTONS_WRITE").is_some() {
            fs::write(path, sections.join("\n## ")).unwrap();
        }
    }
    assert!(count >= 105, "{count}");
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn a_file_that_is_not_in_utf_8_is_refused_with_its_encoding() {
    let utf_16: Vec<u8> = "\u{feff}[slider]\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
    let cases: [(&[u8], &str); 3] = [
        (
            b"\x7fELF\x02\x01\x01\0\0\0\xc3(",
            "a.toml is not a text file; give a scene file (TOML)\n",
        ),
        (&utf_16, "a.toml is UTF-16; save it as UTF-8\n"),
        (
            b"[slider]\nvelocity = 0.025\nangle = 0.5 # in \xb0\n",
            "a.toml:3:18: the byte 0xb0 is not UTF-8; save the file as UTF-8\n",
        ),
    ];
    for (bytes, expected) in cases {
        assert_eq!(message(&[("a.toml".to_owned(), bytes)]), expected);
    }
}

#[test]
fn carriage_returns_change_no_message() {
    for (_, text) in pages() {
        for mut case in cases(&text) {
            let (name, scene) = case.files.remove(0);
            let mut files = vec![(name, scene.replace('\n', "\r\n"))];
            files.extend(case.files.into_iter().map(|(name, table)| (name, table.to_owned())));
            assert_eq!(message(&files), case.message, "{}", case.name);
        }
    }
}

#[test]
fn a_byte_order_mark_before_a_mistake_counts_as_a_column() {
    let scene = "\u{feff}[slyder]\nvelocity = 0.025\n";
    let found = message(&[("a.toml".to_owned(), scene)]);
    let expected = "`slyder` is not a key of the file\n --> a.toml:1:2\n  |\n1 | [slyder]\n  |  ^^^^^^\n  |\n  = help: \
                    did you mean `slider`?\n";
    assert!(found.contains(expected), "{found}");
}

#[test]
fn a_contact_that_starts_open_where_none_can_open_is_refused_by_its_name() {
    let text = include_str!("../../../../scenes/effects/detachment.toml");
    for key in ["y = 1e-3", "vy = 0.1", "vy = -0.1"] {
        let open = format!("{text}[[initial]]\nmass = \"foot\"\n{key}\n");
        let error = Simulation::new(parse("open", &open).unwrap(), 0.0).err().expect("it is open");
        assert!(error.is_scene());
        assert_eq!(
            error.to_string(),
            "contact.floor starts away from its surface, or moves along its normal, and contacts \
             cannot open in this scene; change its initial values, or let contacts open \
             (effects.detachment)"
        );
    }
}

/// The library inside an FMU reads by `amontons::scene::read`, which explains less and must refuse as much.
#[test]
fn what_is_explained_here_is_refused_by_the_plain_reader_too() {
    for (_, page) in pages() {
        for case in cases(&page) {
            let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).unwrap();
            for (name, content) in &case.files {
                fs::write(folder.path().join(name), content).unwrap();
            }
            let read = amontons::scene::read(&folder.path().join(&case.files[0].0));
            assert!(read.is_err_and(|error| error.is_scene()), "{}", case.name);
        }
    }
}

#[test]
fn a_folder_is_not_a_scene() {
    let message = read(Path::new("tests/wrong_scenes")).unwrap_err().to_string();
    assert!(message.contains("cannot use tests/wrong_scenes: Is a directory"), "{message}");
}

/// The scenes that the program carries, and the network that the README writes out.
fn right_scenes() -> Vec<&'static str> {
    let blocks = include_str!("../../../../README.md").split("```toml\n").skip(1);
    let written = blocks.map(|block| block.split("```").next().unwrap_or(block));
    BUILTIN.iter().map(|builtin| builtin.text).chain(written).collect()
}

#[test]
fn the_scenes_of_program_and_readme_are_right() {
    let texts = right_scenes();
    assert!(texts.iter().any(|text| text.contains("[[damper]]")));
    for text in texts {
        parse("readme", text).unwrap();
    }
}

/// One slip in a file.
#[derive(Clone, Debug)]
enum Slip {
    Delete(usize),
    Repeat(usize),
    Swap(usize, usize),
    Byte(usize, u8),
    Value(usize, &'static str),
}

fn slip() -> impl Strategy<Value = Slip> {
    let line = 0_usize..60;
    let values = [
        "nan",
        "-inf",
        "inf",
        "1e999",
        "-0",
        "0",
        "-1",
        "99999999999999999999",
        "4.9e-324",
        "0x7fff",
        "\"0.5\"",
        "\"µ\"",
        "true",
        "[]",
        "[[1], 2]",
        "{}",
        "{ a = 1 }",
        "1979-05-27",
        "[1, 2]",
    ];
    prop_oneof![
        line.clone().prop_map(Slip::Delete),
        line.clone().prop_map(Slip::Repeat),
        (line.clone(), line.clone()).prop_map(|(a, b)| Slip::Swap(a, b)),
        (0_usize..2000, any::<u8>()).prop_map(|(at, byte)| Slip::Byte(at, byte)),
        (0_usize..2000, prop::sample::select(b"[]{}=.,\"'#\n\r \t-_0e".to_vec()))
            .prop_map(|(at, byte)| Slip::Byte(at, byte)),
        (line, prop::sample::select(values.to_vec()))
            .prop_map(|(at, value)| Slip::Value(at, value)),
    ]
}

fn with_slips(text: &str, slips: &[Slip]) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    for slip in slips {
        if let Slip::Byte(at, byte) = *slip {
            let length = bytes.len();
            bytes[at % length] = byte;
            continue;
        }
        let mut lines: Vec<Vec<u8>> =
            bytes.split(|&byte| byte == b'\n').map(<[u8]>::to_vec).collect();
        let count = lines.len();
        match *slip {
            Slip::Delete(at) => drop(lines.remove(at % count)),
            Slip::Repeat(at) => lines.insert(at % count, lines[at % count].clone()),
            Slip::Swap(a, b) => lines.swap(a % count, b % count),
            Slip::Value(at, value) => {
                let line = &mut lines[at % count];
                if let Some(equals) = line.iter().position(|&byte| byte == b'=') {
                    line.truncate(equals + 1);
                    line.extend_from_slice(value.as_bytes());
                }
            }
            Slip::Byte(..) => {}
        }
        bytes = lines.join(&b'\n');
        if bytes.is_empty() {
            bytes.push(b'\n');
        }
    }
    bytes
}

proptest! {
    // A failure prints the slips, which make the same file again.
    #![proptest_config(ProptestConfig {
        cases: 1000,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn a_file_with_slips_is_a_scene_or_has_problems_with_their_places(
        scene in prop::sample::select(right_scenes()),
        slips in prop::collection::vec(slip(), 1..6),
    ) {
        let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).unwrap();
        let path = folder.path().join("mine.toml");
        let bytes = with_slips(scene, &slips);
        fs::write(&path, &bytes).unwrap();
        if let Err(error) = read(&path) {
            let message = error.to_string();
            let is_text = std::str::from_utf8(&bytes).is_ok() && !bytes.contains(&0);
            let place = if is_text { "mine.toml:" } else { "mine.toml" };
            prop_assert!(message.contains(place), "{message}");
        }
    }
}
