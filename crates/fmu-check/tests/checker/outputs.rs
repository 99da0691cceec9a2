//! The formats of reports, several FMUs at once, and exit codes.

use super::fmu::{Files, PROGRAM, check, library, sound, with_library};
use super::program::{folder, run, text};
use fmu_check::{Part, Rule};
use quick_xml::Reader;
use quick_xml::events::Event;
use serde_json::{Value, json};
use std::fs;

/// A violation and a hint, each at a line of its own.
fn broken() -> Files {
    sound().edit("start=\"1.5\"", "start=\"9\"").edit("23:59:59Z", "23:59:59+01:00")
}

/// Runs the program in a folder with these FMUs, on all of them. Returns its exit code, and both its outputs.
fn check_all(fmus: &[(&str, &[u8])], arguments: &[&str]) -> (i32, String, String) {
    let folder = folder();
    for (name, content) in fmus {
        fs::write(folder.path().join(name), content).unwrap();
    }
    let names: Vec<&str> = fmus.iter().map(|(name, _)| *name).collect();
    let output = run(PROGRAM, folder.path(), &[&names, arguments].concat());
    (output.status.code().unwrap(), text(&output.stdout), text(&output.stderr))
}

#[test]
fn each_class_has_its_exit_code_and_the_gravest_counts() {
    let (sound, broken) = (sound().pack(), broken().pack());
    let hint = self::sound().add("readme.txt", b"a").pack();
    let crash = with_library(library(&["-DFAULT_crash"])).pack();
    let all: [(&str, &[u8]); 5] = [
        ("sound.fmu", &sound),
        ("hint.fmu", &hint),
        ("crash.fmu", &crash),
        ("broken.fmu", &broken),
        ("none.fmu", b"no zip"),
    ];
    for (until, strict, code, said) in [
        (1, false, 0, "no findings"),
        (2, false, 0, "no findings, 1 hint"),
        (2, true, 4, "error: no findings, 1 hint"),
        (3, true, 3, "error: 1 defect, 1 hint"),
        (4, false, 1, "error: 1 violation, 2 defects, 2 hints"),
        (5, false, 2, "error: none.fmu is not an FMU: it is not a zip archive"),
    ] {
        let arguments: &[&str] = if strict { &["--strict"] } else { &[] };
        let (got, _, errors) = check_all(&all[..until], arguments);
        assert_eq!((got, errors.trim_end()), (code, said), "{until}");
    }
}

#[test]
fn lines_about_one_of_several_fmus_begin_with_its_path() {
    let (sound, broken) = (sound().pack(), broken().pack());
    let (_, printed, _) = check_all(&[("a.fmu", &sound), ("b.fmu", &broken)], &["--no-run"]);
    let lines: Vec<&str> = printed.lines().collect();
    assert_eq!(lines.len(), 2, "{printed}");
    assert!(lines[0].starts_with("b.fmu: violation: start-outside-bounds "), "{printed}");
    assert!(lines[1].starts_with("b.fmu: hint: generation-date "), "{printed}");
}

#[test]
fn json_is_one_object_for_one_fmu_and_an_array_for_several() {
    let broken = broken().pack();
    let (code, printed, _) = check_all(&[("a.fmu", &broken)], &["--no-run", "--format", "json"]);
    let wanted = json!({
        "file": "a.fmu", "violations": 1, "defects": 0, "hints": 1,
        "findings": [
            {
                "class": "hint", "rule": "generation-date", "place": "modelDescription.xml", "line": 2,
                "message": "generationDateAndTime 2024-12-31T23:59:59+01:00 should be in UTC, such as 2024-12-31T23:59:59Z",
                "section": "2.2.1", "since": "2.0.1",
            },
            {
                "class": "violation", "rule": "start-outside-bounds", "place": "modelDescription.xml", "line": 49,
                "message": "start 9 of module[1].u is above max 5", "section": "2.2.7", "since": "2.0.1",
            },
        ],
        "more": [], "notes": [],
    });
    assert_eq!((code, serde_json::from_str::<Value>(&printed).unwrap()), (1, wanted));
    let (code, printed, _) =
        check_all(&[("a.fmu", &broken), ("b.fmu", b"")], &["--no-run", "--format", "json"]);
    let all: Value = serde_json::from_str(&printed).unwrap();
    assert_eq!(code, 2);
    assert_eq!(all[0]["findings"][1]["rule"], "start-outside-bounds");
    assert_eq!(all[1]["file"], "b.fmu");
    assert!(all[1]["error"].as_str().unwrap().contains("not a zip archive"), "{all}");
}

#[test]
fn json_counts_the_findings_that_it_does_not_list() {
    let many: String = (0..25)
        .map(|number| format!("<Category name=\"logAll\" description=\"{number}\"/>"))
        .collect();
    let many = sound().edit("<Category name=\"logStatusError\"/>", &many).pack();
    let (_, printed) = check(&many, &["--no-run", "--format", "json"]);
    let report: Value = serde_json::from_str(&printed).unwrap();
    assert_eq!(report["violations"], 25);
    assert_eq!(report["findings"].as_array().unwrap().len(), 20);
    let more = json!([{ "class": "violation", "rule": "category-duplicate", "count": 5 }]);
    assert_eq!(report["more"], more);
}

#[test]
fn sarif_describes_every_rule_and_places_every_finding() {
    let (_, printed, _) =
        check_all(&[("a b.fmu", &broken().pack())], &["--no-run", "--format", "sarif"]);
    let document: Value = serde_json::from_str(&printed).unwrap();
    assert_eq!(document["version"], "2.1.0");
    let run = &document["runs"][0];
    let rules = run["tool"]["driver"]["rules"].as_array().unwrap();
    assert_eq!(rules.len(), Rule::ALL.len());
    for rule in rules {
        for text in [&rule["shortDescription"]["text"], &rule["help"]["text"]] {
            assert!(text.as_str().is_some_and(|text| !text.is_empty()), "{rule}");
        }
    }
    let results = run["results"].as_array().unwrap();
    assert_eq!(results.len(), 2);
    for (result, id, level, line) in [
        (&results[0], "generation-date", "note", 2),
        (&results[1], "start-outside-bounds", "error", 49),
    ] {
        assert_eq!((&result["ruleId"], &result["level"]), (&json!(id), &json!(level)));
        let index = usize::try_from(result["ruleIndex"].as_u64().unwrap()).unwrap();
        assert_eq!(rules[index]["id"], id);
        let place = &result["locations"][0]["physicalLocation"];
        assert_eq!(place["artifactLocation"]["uri"], "a%20b.fmu");
        assert_eq!(place["region"]["startLine"], line);
        assert!(result["message"]["text"].as_str().unwrap().starts_with("modelDescription.xml:"));
        assert!(result["partialFingerprints"]["primaryLocationLineHash"].is_string());
    }
}

/// The elements of a document, each with its attributes as text.
fn elements(xml: &str) -> Vec<(String, String)> {
    let mut reader = Reader::from_str(xml);
    let mut found = Vec::new();
    loop {
        match reader.read_event().unwrap() {
            Event::Start(start) | Event::Empty(start) => {
                let name = start.name().as_ref().to_owned();
                found.push((name, start.attributes_raw().to_owned()));
            }
            Event::Eof => return found,
            _ => {}
        }
    }
}

#[test]
fn junit_has_a_case_for_each_rule_and_skips_those_of_a_run_that_did_not_take_place() {
    let (_, printed, _) = check_all(
        &[("a.fmu", &broken().pack()), ("b.fmu", b"")],
        &["--no-run", "--format", "junit"],
    );
    let elements = elements(&printed);
    let count = |wanted: &str| elements.iter().filter(|(name, _)| name == wanted).count();
    assert_eq!(count("testcase"), Rule::ALL.len() + 1);
    assert_eq!((count("testsuite"), count("failure"), count("error")), (2, 1, 1));
    let of_run = Rule::ALL.iter().filter(|rule| rule.part() == Part::Run).count();
    assert_eq!(count("skipped"), of_run);
    let suite = &elements.iter().find(|(name, _)| name == "testsuite").unwrap().1;
    let counts =
        format!("tests=\"{}\" failures=\"1\" errors=\"0\" skipped=\"{of_run}\"", Rule::ALL.len());
    assert!(suite.contains(&counts), "{suite}");
    let failure = elements.iter().position(|(name, _)| name == "failure").unwrap();
    assert!(elements[failure - 1].1.contains("start-outside-bounds"), "{printed}");
    // With --strict the hint fails too.
    let (_, strict, _) =
        check_all(&[("a.fmu", &broken().pack())], &["--no-run", "--strict", "--format", "junit"]);
    assert_eq!(strict.matches("<failure").count(), 2, "{strict}");
}

#[test]
fn what_an_fmu_says_stays_well_formed_in_every_format() {
    let odd = sound().edit("name=\"rate\"", "name=\"&lt;&amp;&quot;]]&gt;&#x9;\u{202e}\"").pack();
    for format in ["json", "sarif"] {
        let (_, printed) = check(&odd, &["--no-run", "--format", format]);
        serde_json::from_str::<Value>(&printed).unwrap();
    }
    let (_, printed) = check(&odd, &["--no-run", "--format", "junit"]);
    assert!(!elements(&printed).is_empty());
}
