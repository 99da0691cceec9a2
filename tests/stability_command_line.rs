//! The stability analyser as its user meets it.
#![cfg(feature = "tools")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn stability(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_amontons-stability"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).unwrap()
}

/// What a command that must succeed prints.
fn printed(arguments: &[&str]) -> String {
    let folder = folder();
    let output = stability(folder.path(), arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    text(&output.stdout)
}

/// A number behind a piece of text.
fn number_after(printed: &str, before: &str) -> f64 {
    let rest = printed.split_once(before).unwrap_or_else(|| panic!("{before}: {printed}")).1;
    rest.split_whitespace().next().unwrap().parse().unwrap()
}

#[test]
fn states_as_json_hold_the_printed_eigenvalues_of_both_tables() {
    for (scene, table) in
        [("set1", include_str!("data/table2.json")), ("set2", include_str!("data/table3.json"))]
    {
        let arguments = ["states", scene, "--friction", "1.96", "--format", "json"];
        let found: serde_json::Value = serde_json::from_str(&printed(&arguments)).unwrap();
        let table: serde_json::Value = serde_json::from_str(table).unwrap();
        for (state, values) in table["states"].as_object().unwrap() {
            let state_found = &found["states"][state];
            let eigenvalues = state_found["eigenvalues_hz"].as_array().unwrap();
            assert_eq!(eigenvalues.len(), values.as_array().unwrap().len(), "{state}");
            let mut grows = false;
            for value in values.as_array().unwrap() {
                let distance = |found: &serde_json::Value| -> f64 {
                    let part = |i: usize| found[i].as_f64().unwrap() - value[i].as_f64().unwrap();
                    part(0).abs().max(part(1).abs())
                };
                let nearest = eigenvalues.iter().map(distance).fold(f64::MAX, f64::min);
                assert!(nearest < 0.006, "{state}: {value}");
                grows |= value[0].as_f64().unwrap() > 0.0;
            }
            assert_eq!(state_found["unstable"], grows, "{state}");
            assert_eq!(state_found["has_equilibrium"], *state == "Sl-Sl", "{state}");
        }
    }
}

#[test]
fn the_table_is_laid_out_as_the_paper_lays_it_out() {
    let printed = printed(&["states", "set1", "--friction", "1.96"]);
    let line = printed.lines().find(|line| line.starts_with("Sl ")).unwrap();
    let cells: Vec<&str> =
        line.split("  ").map(str::trim).filter(|cell| !cell.is_empty()).collect();
    let first = ["Sl", "-0.18 ± 43.52i", "-0.11 ± 34.59i", "-0.28 ± 54.57i", "-7.29 ± 44.65i"];
    assert_eq!(cells, first);
    assert!(printed.contains("*2.68 ± 219.38i"), "{printed}");
}

#[test]
fn the_locus_prints_both_coalescences_in_the_papers_order() {
    let set1 = printed(&["locus", "set1", "--friction", "0:3.5:0.005"]);
    let set2 = printed(&["locus", "set2", "--friction", "0:3.5:0.005"]);
    let place = |printed: &str, words: &str| printed.find(words).unwrap();
    assert!(place(&set1, "modes 5 and 6 merge") < place(&set1, "modes 3 and 4 merge"));
    assert!(place(&set2, "modes 3 and 4 merge") < place(&set2, "modes 5 and 6 merge"));
}

#[test]
fn the_locus_over_another_parameter_agrees_with_the_one_over_friction() {
    let over_mu = printed(&["locus", "set1", "--friction", "0:1:0.01"]);
    let at = number_after(&over_mu, "damped or not (C = α M + β K):\n");
    // At the µ of the merging, k2 has its own value where the modes merge.
    let mu = format!("friction.coefficient={at}");
    let over_k2 =
        printed(&["locus", "set1", "--parameter", "module[1].k2=59e3:61e3:50", "--set", &mu]);
    // k2 of one module alone: with two modules both links are between the same masses.
    let k2 = number_after(&over_k2, "damped or not (C = α M + β K):\n");
    assert!((k2 - 60e3).abs() < 1e-2, "{over_k2}");
}

#[test]
fn set_2_can_be_bistable_between_the_onset_of_its_stuck_states_and_its_own() {
    let printed = printed(&["bistable", "set2", "--friction", "0:2.5"]);
    assert!(printed.contains("begins to grow") && printed.contains("Sl-St"), "{printed}");
    // Confirmed by a transient of the paper: Set 2 squeals at µ = 1.96 after a large kick.
    let turn = number_after(&printed, "µ = ");
    let onset = number_after(&printed, "Sl-St             2     ");
    assert!(onset < 1.96 && 1.96 < turn, "{printed}");
}

#[test]
fn pictures_are_written_as_their_ending_asks() {
    let folder = folder();
    let commands: [&[&str]; 4] = [
        &["locus", "set1", "--friction", "0:3.5:0.05", "--plot", "locus.svg"],
        &["modes", "set1", "--friction", "0", "--plot", "modes.svg"],
        &[
            "map",
            "set2",
            "--x",
            "friction.coefficient=0:3:8",
            "--y",
            "slider.angle=0.3:0.7:4",
            "--plot",
            "map.png",
        ],
        &["modes", "ring12", "--plot", "modes.png"],
    ];
    for arguments in commands {
        let output = stability(folder.path(), arguments);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let path = folder.path().join(arguments.last().unwrap());
        assert!(fs::metadata(&path).unwrap().len() > 5_000, "{}", path.display());
    }
}

#[test]
fn one_module_different_modules_and_long_rings_work() {
    let folder = folder();
    let scene = include_str!("../scenes/set1.toml");
    for (name, from, to, words) in [
        ("one.toml", "modules = 2", "modules = 1", "4 states, 4 solved"),
        ("unlike.toml", "m1 = 0.3 ", "m1 = [0.3, 0.4] ", "16 states, 16 solved"),
        ("three.toml", "modules = 2", "modules = 3", "64 states, 20 solved"),
        ("long.toml", "modules = 2", "modules = 1000", "only uniform sliding"),
    ] {
        let path = folder.path().join(name);
        fs::write(&path, scene.replacen(from, to, 1)).unwrap();
        let output = stability(folder.path(), &["states", name]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        assert!(text(&output.stderr).contains(words), "{}", text(&output.stderr));
    }
}

#[test]
fn arguments_that_make_no_sense_are_refused_with_what_would_be_right() {
    let cases: &[(&[&str], i32, &[&str])] = &[
        (&["states", "nothing"], 1, &["nothing", "set1, set2, ring12"]),
        (&["states", "set1", "--friction", "-1"], 3, &["friction.coefficient", "negative"]),
        (&["states", "set1", "--state", "Sl-Up"], 2, &["Sl-Up", "Sl-St"]),
        (&["locus", "set1"], 2, &["--friction"]),
        (&["locus", "set1", "--friction", "0:3.5"], 2, &["A:B:STEP"]),
        (&["locus", "set1", "--friction", "3:0:0.1"], 2, &["below the last"]),
        (&["locus", "set1", "--parameter", "module[1].k9=1:2:0.1"], 2, &["k9", "module[1].k1"]),
        (&["locus", "set1", "--friction", "0:1:0.1", "--plot", "a.pdf"], 1, &[".svg", ".png"]),
        (&["bistable", "set1", "--friction", "2"], 2, &["A:B"]),
        (&["bistable", "set1", "--friction=-1:1"], 3, &["friction.coefficient", "negative"]),
        (&["bistable", "set1", "--friction", "0:1", "--set", "slider.velocity=0"], 3, &["stands"]),
        (
            &["bistable", "set1", "--friction", "0:1", "--set", "module[1].preload=-0.1"],
            3,
            &["contact[1] opens"],
        ),
        (&["bistable", "ring12", "--friction", "0:1"], 3, &["12 contacts", "8"]),
        (&["map", "set1", "--x", "k=0:1:1", "--y", "k=0:1:2", "--plot", "m.svg"], 2, &["from 2"]),
    ];
    let folder = folder();
    for (arguments, code, words) in cases {
        let output = stability(folder.path(), arguments);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(*code), "{arguments:?}: {message}");
        for word in *words {
            assert!(message.contains(word), "{word} is missing in: {message}");
        }
        assert!(!message.contains("panicked"), "{message}");
    }
}
