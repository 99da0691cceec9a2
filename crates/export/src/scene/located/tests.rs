//! Kinds of types that a file can be made of, apart from what a scene is today.

use super::read;
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("oneOf" = [{ "required": ["ring"] }, { "required": ["spring"] }]))]
#[allow(dead_code)]
struct Document {
    ring: Option<f64>,
    #[serde(default)]
    spring: Vec<Spring>,
    law: Option<Law>,
    support: Option<Support>,
    drive: Option<Drive>,
    #[serde(default)]
    names: BTreeMap<String, f64>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[allow(dead_code)]
struct Spring {
    /// The two masses.
    between: [String; 2],
    /// Along x or y.
    #[serde(default)]
    along: Axis,
    pair: Option<(f64, String)>,
    #[schemars(range(min = 1, max = 8))]
    order: Option<u8>,
}

#[derive(Default, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
enum Axis {
    /// To the right.
    #[default]
    Horizontal,
    /// Up.
    Vertical,
}

#[derive(Deserialize, JsonSchema)]
#[serde(untagged)]
#[allow(dead_code)]
enum Law {
    Named(Axis),
    Constant { coefficient: f64 },
    Stribeck { resting: f64, moving: f64 },
}

#[derive(Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
#[allow(dead_code)]
enum Support {
    Ground,
    Elastic { stiffness: f64 },
}

#[derive(Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
#[allow(dead_code)]
enum Drive {
    Speed(f64),
    Force(f64),
}

/// The first lines of the problems, and the helps.
fn messages(text: &str) -> Vec<String> {
    let Err(error) = read("file", text, |_: Document| Ok(())) else { return Vec::new() };
    let message = error.to_string();
    let is_told = |line: &&str| {
        let line = line.trim();
        let is_drawing = line.starts_with(|c: char| c == '|' || c.is_ascii_digit());
        !is_drawing
            && !line.starts_with("-->")
            && !line.is_empty()
            && !line.contains(" problems in ")
    };
    message.lines().filter(is_told).map(|line| line.trim().to_owned()).collect()
}

#[test]
fn what_is_right_passes() {
    for text in [
        "ring = 1",
        "ring = 1\n[names]\nany = 1.0",
        "[[spring]]\nbetween = [\"a\", \"b\"]\nalong = \"vertical\"\npair = [1.0, \"x\"]\norder = 8",
        "ring = 1\nlaw = \"vertical\"",
        "ring = 1\nlaw = { coefficient = 1 }",
        "ring = 1\nlaw.resting = 1\nlaw.moving = 2",
        "ring = 1\n[support]\nkind = \"elastic\"\nstiffness = 1.0",
        "ring = 1\ndrive.force = 1.0",
    ] {
        assert!(messages(text).is_empty(), "{text}: {:?}", messages(text));
    }
}

#[test]
fn each_kind_of_type_has_its_messages() {
    let cases: &[(&str, &[&str])] = &[
        (
            "",
            &[
                "the file has neither `ring` nor `spring`",
                "= help: give one of them: `ring = …`",
                "or `[[spring]]`",
            ],
        ),
        (
            "ring = 1\n[[spring]]\nbetween = [\"a\", \"b\"]",
            &[
                "the file has both `ring` and `spring`",
                "= help: give one of them and remove the other",
            ],
        ),
        (
            "[[spring]]\nbetween = [\"a\"]",
            &["spring[1].between: has 1 item, must have 2", "= help: The two masses"],
        ),
        (
            "[[spring]]\nbetween = [\"a\", 2]",
            &["spring[1].between[2]: must be a text, not 2", "= help: write it in quotes"],
        ),
        (
            "[[spring]]\nbetween = [\"a\", \"b\"]\nalong = \"vertikal\"",
            &[
                "spring[1].along = \"vertikal\": must be \"horizontal\" or \"vertical\"",
                "= help: did you mean \"vertical\"?",
            ],
        ),
        (
            "[[spring]]\nbetween = [\"a\", \"b\"]\norder = 9",
            &["spring[1].order = 9: must be from 1 to 8"],
        ),
        (
            "[[spring]]\nalong = \"vertical\"",
            &[
                "[[spring]] is missing the key `between`",
                "= help: add `between = …` (The two masses)",
            ],
        ),
        (
            "[[spring]]\nbetween = [\"a\", \"b\"]\npair = [1.0]",
            &["spring[1].pair: has 1 item, must have 2"],
        ),
        (
            "ring = 1\nlaw = { resting = 1, coefficient = 1 }",
            &[
                "[law] has both `coefficient` and `resting`",
                "= help: give one of them and remove the other",
            ],
        ),
        (
            "ring = 1\nlaw = {}",
            &[
                "[law] has neither `coefficient` nor `resting`",
                "= help: give one of them: `coefficient = …`",
                "or `resting = …`",
            ],
        ),
        (
            "ring = 1\nlaw = { resting = 1 }",
            &["[law] is missing the key `moving`", "= help: add `moving = …`"],
        ),
        (
            "ring = 1\n[support]\nkind = \"elastik\"\nstiffness = 1.0",
            &[
                "support.kind = \"elastik\": must be \"ground\" or \"elastic\"",
                "= help: did you mean \"elastic\"?",
            ],
        ),
        (
            "ring = 1\n[support]\nstiffness = 1.0",
            &[
                "[support] is missing the key `kind`",
                "= help: add `kind` = \"ground\" or \"elastic\"",
            ],
        ),
        (
            "ring = 1\n[support]\nkind = \"ground\"\nstiffness = 1.0",
            &["`stiffness` is not a key of [support]", "= help: its only key is `kind`"],
        ),
        (
            "ring = 1\n[names]\nany = true",
            &["names.any: must be a number, not true", "= help: write it as in `any = 0.5`"],
        ),
    ];
    for (text, expected) in cases {
        assert_eq!(messages(text), *expected, "{text}");
    }
}

/// A file of another kind took a minute to be refused: each error looked through the text, and at all before it.
#[test]
fn a_long_text_of_wrong_lines_is_refused_as_soon_as_a_short_one() {
    const LINES: usize = 20_000;
    let error = read::<Document, _>("long", &"\"a\": {\n".repeat(LINES), Ok).err().unwrap();
    let message = error.to_string();
    assert!(message.contains(&format!("{LINES} problems in long")), "{message}");
    assert!(message.ends_with(&format!("and {} more", LINES - 20)), "{message}");
}
