//! What the reader says of scene files that are wrong: `tests/wrong_scenes/*.toml`, each beside the
//! whole message that its user gets.
#![cfg(feature = "tools")]

use amontons::scene::{BUILTIN, parse, read};
use amontons::simulation::Simulation;
use proptest::prelude::*;
use std::fs;
use std::path::Path;

#[test]
fn every_wrong_scene_gets_its_message() {
    let mut wrong = Vec::new();
    let mut count = 0;
    for entry in fs::read_dir("tests/wrong_scenes").unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        count += 1;
        let expected = fs::read_to_string(path.with_extension("txt")).unwrap_or_default();
        let found = read(&path).expect_err("the scene is wrong").to_string() + "\n";
        if found != expected {
            wrong.push(format!("{}\n{found}\nbut expected is\n{expected}", path.display()));
        }
    }
    assert!(count >= 83, "{count}");
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn a_contact_that_starts_open_where_none_can_open_is_refused_by_its_name() {
    let text = include_str!("../scenes/effects/detachment.toml");
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

#[test]
fn a_folder_is_not_a_scene() {
    let message = read(Path::new("tests/wrong_scenes")).unwrap_err().to_string();
    assert!(message.contains("cannot use tests/wrong_scenes: Is a directory"), "{message}");
}

/// The scenes that the program carries and those that the README writes out, a network among them.
fn right_scenes() -> Vec<&'static str> {
    let blocks = include_str!("../README.md").split("```toml\n").skip(1);
    let written = blocks.map(|block| block.split("```").next().unwrap_or(block));
    BUILTIN.iter().map(|builtin| builtin.text).chain(written).collect()
}

#[test]
fn the_scenes_that_the_readme_writes_out_are_right() {
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
