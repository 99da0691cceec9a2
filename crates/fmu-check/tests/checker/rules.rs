//! The list of rules, their examinations, and what the README says of both.

use crate::fmu::{KEEP, PROGRAM, check, sound};
use crate::program::{assert_refused, folder, run, text};
use crate::python;
use fmu_check::{Class, Rule};
use std::fs;
use std::process::Command;

#[test]
fn a_sound_fmu_of_another_maker_passes() {
    assert_eq!(check(&sound().pack(), &[]), (0, String::new()));
}

#[test]
fn all_rules_are_listed() {
    let folder = folder();
    let listed = text(&run(PROGRAM, folder.path(), &["--rules"]).stdout);
    let help = text(&run(PROGRAM, folder.path(), &["--help"]).stdout);
    assert_eq!(listed.lines().count(), Rule::ALL.len());
    for (line, rule) in listed.lines().zip(Rule::ALL) {
        let mut words = line.split_ascii_whitespace();
        let (section, since) = (rule.section().unwrap_or("-"), rule.since().unwrap_or("-"));
        for word in [rule.id(), rule.class().word(), section, since] {
            assert_eq!(words.next(), Some(word), "{line}");
        }
        assert!(line.ends_with(rule.line()), "{line}");
        assert!(help.contains(line), "{line}");
    }
}

#[test]
fn every_rule_has_an_fmu_that_breaks_it() {
    let tests = [
        include_str!("archive.rs"),
        include_str!("description.rs"),
        include_str!("exporters.rs"),
        include_str!("libraries.rs"),
        include_str!("trials.rs"),
    ];
    for rule in Rule::ALL {
        let name = format!("\"{}\"", rule.id());
        assert!(
            tests.iter().any(|test| test.contains(&name)),
            "no test has {name}, with the quotes"
        );
    }
}

const PAGE: &str = include_str!("../../../../docs/checking-rules.md");

#[test]
fn the_page_of_rules_has_each_with_its_class_and_section() {
    let rows = Rule::ALL.iter().map(|rule| {
        let (section, since) = (rule.section().unwrap_or("-"), rule.since().unwrap_or("-"));
        let (id, class, line) = (rule.id(), rule.class(), rule.line());
        format!("| `{id}` | {class} | {section} | {since} | {line} |\n")
    });
    let table: String = rows.collect();
    assert!(PAGE.contains(&table), "docs/checking-rules.md must have this table:\n{table}");
}

#[test]
fn the_page_of_rules_says_for_every_violation_which_sentence_it_breaks() {
    let (_, sentences) = PAGE.split_once("## What the standard asks").unwrap();
    let named = |rule: &Rule| sentences.contains(&format!("`{}`", rule.id()));
    for rule in Rule::ALL.iter().filter(|rule| rule.class() == Class::Violation) {
        assert!(named(rule), "docs/checking-rules.md has no sentence for {}", rule.id());
    }
    // Nor does it name a rule that is none.
    for cell in sentences.lines().filter_map(|line| line.strip_prefix("| ")?.split(" | ").nth(1)) {
        for id in cell.split('`').skip(1).step_by(2) {
            assert!(Rule::named(id).is_some(), "{id} in docs/checking-rules.md is no rule");
        }
    }
}

#[test]
fn what_cannot_be_read_is_said_on_standard_error() {
    let folder = folder();
    assert_refused(&run(PROGRAM, folder.path(), &["none.fmu"]), 2, &["none.fmu"]);
    assert_refused(&run(PROGRAM, folder.path(), &["--strict"]), 2, &["FILE"]);
    assert_refused(&run(PROGRAM, folder.path(), &["a.fmu", "--glibc", "x"]), 2, &["2.17"]);
}

#[test]
#[ignore = "breaks all FMUs again, and installs FMPy"]
fn fmpy_names_a_problem_in_as_few_of_the_broken_fmus_as_the_readme_says() {
    const VALIDATE: &str = "
import pathlib, sys
from fmpy.validation import validate_fmu

def is_named(path):
    try:
        return bool(validate_fmu(str(path)))
    except Exception:
        return True

print(sum(map(is_named, pathlib.Path(sys.argv[1]).glob('*.fmu'))))
";
    let folder = folder();
    let tests =
        Command::new(std::env::current_exe().unwrap()).env(KEEP, folder.path()).output().unwrap();
    assert!(tests.status.success(), "{}", text(&tests.stdout));
    let all = fs::read_dir(folder.path()).unwrap().count();
    let mut python = Command::new(python::interpreter());
    let output = python.args(["-c", VALIDATE]).arg(folder.path()).output().unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    let named: usize = text(&output.stdout).trim().parse().unwrap();
    println!("FMPy names a problem in {named} of the {all} broken FMUs");
    assert!(3 * named < all, "no longer less than a third, as README.md says");
}
