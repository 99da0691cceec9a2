//! The stability analyser as its user meets it.

use crate::program::{assert_refused, folder, run, text};
use std::collections::BTreeSet;
use std::f64::consts::TAU;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn stability(folder: &Path, arguments: &[&str]) -> Output {
    run(env!("CARGO_BIN_EXE_amontons-stability"), folder, arguments)
}

/// Output of a command that must succeed.
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
    for (scene, table) in [
        ("set1", include_str!("../../../../tests/data/table2.json")),
        ("set2", include_str!("../../../../tests/data/table3.json")),
    ] {
        let arguments = ["states", scene, "--friction", "1.96", "--format", "json"];
        let found: serde_json::Value = serde_json::from_str(&printed(&arguments)).unwrap();
        let table: serde_json::Value = serde_json::from_str(table).unwrap();
        for (state, values) in table["states"].as_object().unwrap() {
            let state_found = &found["states"][state];
            let mut eigenvalues = state_found["eigenvalues_hz"].as_array().unwrap().clone();
            assert_eq!(eigenvalues.len(), values.as_array().unwrap().len(), "{state}");
            let mut grows = false;
            for value in values.as_array().unwrap() {
                let distance = |found: &serde_json::Value| -> f64 {
                    let part = |i: usize| found[i].as_f64().unwrap() - value[i].as_f64().unwrap();
                    part(0).abs().max(part(1).abs())
                };
                let nearest = (0..eigenvalues.len())
                    .min_by(|&a, &b| {
                        distance(&eigenvalues[a]).total_cmp(&distance(&eigenvalues[b]))
                    })
                    .unwrap();
                // None stands for two.
                let nearest = eigenvalues.swap_remove(nearest);
                assert!(distance(&nearest) < 0.006, "{state}: {value}");
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
    let at = number_after(&over_mu, "proportional damping (C = α M + β K):\n");
    // At the µ of the merging, k2 has its own value where the modes merge.
    let mu = format!("friction.coefficient={at}");
    let over_k2 =
        printed(&["locus", "set1", "--parameter", "module[1].k2=59e3:61e3:50", "--set", &mu]);
    // k2 of one module alone: with two modules both links are between the same masses.
    let k2 = number_after(&over_k2, "proportional damping (C = α M + β K):\n");
    assert!((k2 - 60e3).abs() < 1e-2, "{over_k2}");
}

/// A scene that friction jams diverges: its modes do not oscillate, and beyond there is no equilibrium.
#[test]
fn a_divergence_is_called_one_and_the_lost_equilibrium_is_noted() {
    let arguments = ["locus", "set2", "--set", "slider.angle=-0.5", "--friction", "0:6:0.1"];
    let printed = printed(&arguments);
    let at = number_after(&printed, "critical values:\n");
    assert!(printed.contains("mode 1 begins to grow without oscillating"), "{printed}");
    let last = number_after(&printed, "an equilibrium from 0.000000000 to ");
    assert!((last - at).abs() < 1e-8, "{printed}");
}

#[test]
fn a_map_needs_neither_a_picture_nor_a_table() {
    let x = "friction.coefficient=1:2/3";
    let printed = printed(&["map", "set2", "--x", x, "--y", "slider.angle=0.1:0.3/3"]);
    assert!(printed.contains("9 points of friction.coefficient and slider.angle"), "{printed}");
    let count = |line: &str| line.split_whitespace().last().unwrap().parse::<usize>().ok();
    let verdicts = printed.lines().skip(1).filter_map(count).sum::<usize>();
    assert_eq!(verdicts, 9, "{printed}");
}

#[test]
fn a_map_can_be_had_as_data() {
    let x = "friction.coefficient=0:1.96/2";
    let printed = printed(&["map", "set2", "--x", x, "--y", "slider.velocity=-0.1:0.1/3", "--csv"]);
    let verdicts: Vec<&str> = printed.lines().skip(1).collect();
    assert_eq!(verdicts[0], "0.0,-0.1,stable");
    assert_eq!(verdicts[2], "0.0,0.0,no equilibrium in sliding");
    assert_eq!(verdicts[5], "1.96,0.1,candidate");
}

#[test]
fn a_traced_map_says_how_many_verdicts_are_filled_in() {
    let plane = ["--x", "friction.coefficient=0:3/41", "--y", "module[1].k6=2e5:3e5/30"];
    let all = [&["map", "set2"], &plane[..], &["--csv"]].concat();
    let traced = [&all[..], &["--islands", "4"]].concat();
    let folder = folder();
    let [all, traced] = [all, traced].map(|arguments| stability(folder.path(), &arguments));
    assert_eq!(text(&traced.stdout), text(&all.stdout));
    assert_eq!(text(&all.stderr), "");
    let note = text(&traced.stderr);
    let filled_in = number_after(&note, "note: ");
    assert!((600.0..1230.0).contains(&filled_in), "{note}");
    let words = format!(
        "{filled_in} of 1230 verdicts were not computed but filled in; an island of less than 4 by 4"
    );
    assert!(note.contains(&words), "{note}");
}

#[test]
fn double_modes_of_a_ring_are_waves_around_it() {
    let folder = folder();
    let scene = include_str!("../../../../scenes/set1.toml").replace("modules = 2", "modules = 3");
    fs::write(folder.path().join("ring.toml"), scene).unwrap();
    let output = stability(folder.path(), &["modes", "ring.toml", "--friction", "1"]);
    let printed = text(&output.stdout);
    assert_eq!(printed.matches(", 0 waves around the ring").count(), 3);
    assert_eq!(printed.matches(", 1 wave around the ring").count(), 6);
    for residual in printed.split("residual ").skip(1) {
        let residual = residual.split([',', '\n']).next().unwrap();
        assert!(residual.parse::<f64>().unwrap() < 1e-12, "{residual}");
    }
}

#[test]
fn the_six_real_modes_of_figure_2c_are_printed() {
    let printed = printed(&["modes", "set1", "--friction", "0", "--set", "damping.beta=0"]);
    for (i, expected) in [34.00, 65.99, 163.90, 186.56, 215.24, 225.79].into_iter().enumerate() {
        let found = number_after(&printed, &format!("\nmode {}: ", i + 1));
        assert!((found - expected).abs() < 0.005, "{expected}: {found}");
    }
}

#[test]
fn a_locus_reaches_the_end_of_its_range_on_the_grid_or_not() {
    for (range, last) in [("0:0.35:0.1", "0.35"), ("0:0.3:0.1", "0.3"), ("0:0.5:0.5", "0.5")] {
        let printed = printed(&["locus", "set1", "--friction", range, "--csv"]);
        assert!(printed.lines().last().unwrap().starts_with(&format!("{last},6,")), "{printed}");
    }
}

#[test]
fn states_without_an_equilibrium_say_so() {
    let folder = folder();
    let jams = ["--set", "slider.angle=-0.5", "--set", "friction.coefficient=5"];
    let arguments = [&["states", "set1", "--format", "json"], &jams[..]].concat();
    let output = stability(folder.path(), &arguments);
    assert!(text(&output.stderr).contains("contact[1] jams"), "{}", text(&output.stderr));
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(found["equilibrium_error"].as_str().unwrap().contains("contact[1] jams"));
    assert_eq!(found["states"]["Sl-Sl"]["has_equilibrium"], false);
}

#[test]
fn the_equilibrium_with_an_open_contact_is_among_the_states() {
    let loose = ["--set", "module[2].preload=-5e-3"];
    let json = printed(&[&["states", "set1", "--format", "json"], &loose[..]].concat());
    let found: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(found["states"]["Sl-Dt"]["has_equilibrium"], true);
    assert_eq!(found["states"]["Sl-Sl"]["has_equilibrium"], false);
    let table = printed(&[&["states", "set1"], &loose[..]].concat());
    assert!(table.contains("Equilibrium: Sl-Dt\n"), "{table}");
}

#[test]
fn at_a_slider_that_stands_still_all_contacts_rest_stuck_and_nothing_slides() {
    let still = ["--set", "slider.velocity=0"];
    let table = printed(&[&["states", "set1"], &still[..]].concat());
    assert!(table.contains("no surface moves, so no contact slides"), "{table}");
    let json = printed(&[&["states", "set1", "--format", "json"], &still[..]].concat());
    let found: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(found["states"]["St-St"]["has_equilibrium"], true);
    assert_eq!(found["departures"], serde_json::json!([]));
}

#[test]
fn departures_are_in_the_json_as_in_the_table() {
    let found: serde_json::Value =
        serde_json::from_str(&printed(&["states", "set2", "--format", "json"])).unwrap();
    let first = &found["departures"][0];
    // The lowest mode swings along the slider: it sticks where its speed reaches the slider's. Both
    // modules do alike, so the first is named.
    assert_eq!((first["into"].as_str(), first["of"].as_str()), (Some("St"), Some("module[1].x3")));
    assert_eq!(first["contact"], "contact[1]");
    assert!((first["speed"].as_f64().unwrap() - 0.025).abs() < 1e-12);
}

#[cfg(unix)]
#[test]
fn a_reader_that_has_seen_enough_is_no_error() {
    let program = env!("CARGO_BIN_EXE_amontons-stability");
    let line =
        format!("set -o pipefail; '{program}' locus set1 --friction 0:3:0.001 --csv | head -1");
    let output = Command::new("bash").args(["-c", &line]).output().unwrap();
    assert!(output.status.success() && output.stderr.is_empty(), "{}", text(&output.stderr));
}

#[test]
fn set_2_can_be_bistable_between_the_onset_of_its_stuck_states_and_its_own() {
    let printed = printed(&["bistable", "set2", "--friction", "0:2.5"]);
    assert!(printed.contains("begins to grow") && printed.contains("Sl-St"), "{printed}");
    // Confirmed by a transient of the paper: Set 2 squeals at µ = 1.96 after a large kick.
    let turn = number_after(&printed, "µ = ");
    let onset = number_after(&printed, "Sl-St             2  ");
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
            "friction.coefficient=0:3/8",
            "--y",
            "slider.angle=0.3:0.7/4",
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
    let scene = include_str!("../../../../scenes/set1.toml");
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
fn many_contacts_are_examined_in_sliding_with_all_closed_and_in_the_equilibrium() {
    let folder = folder();
    let scene = include_str!("../../../../scenes/set1.toml");
    let scene = scene.replacen("modules = 2", "modules = 9", 1);
    let key = scene.lines().find(|line| line.starts_with("preload")).unwrap();
    let usual = key.split(['=', '#']).nth(1).unwrap().trim();
    let preloads = format!("preload = [-5e-3{}]", format!(", {usual}").repeat(8));
    fs::write(folder.path().join("lifted.toml"), scene.replacen(key, &preloads, 1)).unwrap();
    let output = stability(folder.path(), &["states", "lifted.toml", "--format", "json"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("uniform sliding and the equilibrium's state is"));
    let found: serde_json::Value = serde_json::from_str(&text(&output.stdout)).unwrap();
    let states = found["states"].as_object().unwrap();
    let sliding = ["Sl"; 9].join("-");
    let lifted = sliding.replacen("Sl", "Dt", 1);
    assert_eq!(states.len(), 2, "{:?}", states.keys());
    assert_eq!(states[&sliding]["has_equilibrium"], false);
    assert_eq!(states[&lifted]["has_equilibrium"], true);
}

/// Growth rate (1/s) of scenes/effects/stribeck.toml on a belt with velocity `v`, m/s.
fn stribeck_growth_rate(v: f64) -> f64 {
    let (m, n, d, mu, mu_s, v_s) = (1.0, 10.0, 6.0, 0.2, 0.4, 0.1);
    (n * (mu_s - mu) / v_s * f64::exp(-v / v_s) - d) / (2.0 * m)
}

const STRIBECK: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/effects/stribeck.toml");

#[test]
fn friction_that_falls_with_the_slip_velocity_drives_with_its_slope() {
    for (v, grows) in [(0.1, true), (0.11, true), (0.13, false), (0.4, false)] {
        let expected = stribeck_growth_rate(v);
        assert_eq!(expected > 0.0, grows);
        let velocity = format!("slider.velocity={v}");
        let json = printed(&["states", STRIBECK, "--set", &velocity, "--format", "json"]);
        let found: serde_json::Value = serde_json::from_str(&json).unwrap();
        let sliding = &found["states"]["Sl"];
        assert_eq!(
            (&sliding["has_equilibrium"], &sliding["unstable"]),
            (&true.into(), &grows.into())
        );
        let value = |part: usize| TAU * sliding["eigenvalues_hz"][0][part].as_f64().unwrap();
        assert!((value(0) - expected).abs() < 1e-10, "{} {expected}", value(0));
        let omega = f64::sqrt(1e4 - expected * expected);
        assert!((value(1) - omega).abs() < 1e-10, "{} {omega}", value(1));
        let modes = printed(&["modes", STRIBECK, "--set", &velocity]);
        let growth = number_after(&modes, "growth rate ");
        // Five digits are printed.
        assert!((growth - expected).abs() < 1e-4 * expected.abs(), "{modes}");
    }
    // The scene's comment.
    assert!((stribeck_growth_rate(0.1) - 0.679).abs() < 5e-4);
}

/// Velocity at which the damping of scenes/effects/stribeck.toml, d + N dµ/dv, is zero.
fn stribeck_critical_velocity() -> f64 {
    let (n, d, mu, mu_s, v_s) = (10.0, 6.0, 0.2, 0.4, 0.1);
    v_s * f64::ln(n * (mu_s - mu) / (v_s * d))
}

fn stribeck_critical_friction() -> f64 {
    let (n, d, v, mu_s, v_s) = (10.0, 6.0, 0.1, 0.4, 0.1);
    mu_s - d * v_s * f64::exp(v / v_s) / n
}

#[test]
fn a_law_that_falls_has_the_critical_velocity_at_which_its_slope_meets_the_damper() {
    for range in ["0.05:0.3:0.05", "0.01:0.3:0.01", "0:0.3:0.1"] {
        let range = format!("slider.velocity={range}");
        let printed = printed(&["locus", STRIBECK, "--parameter", &range]);
        let found = number_after(&printed, "critical values:\n");
        assert!((found - stribeck_critical_velocity()).abs() < 1e-9, "{printed}");
        assert!(printed.contains("mode 1 ceases to grow"), "{printed}");
        // Nothing slides on a belt that stands still.
        assert_eq!(printed.contains("slider.velocity = 0 is left out"), range.contains("=0:"));
    }
}

/// µ_s and v_s stay where µ is varied: closed form 0.4 − 0.06 e = 0.2369.
#[test]
fn a_law_that_falls_loses_rest_where_friction_leaves_its_slope_too_steep() {
    assert!((stribeck_critical_friction() - 0.2369).abs() < 5e-5);
    let folder = folder();
    for range in ["0.1:0.3:0.05", "0.1:0.6:0.05"] {
        let output = stability(folder.path(), &["locus", STRIBECK, "--friction", range]);
        let printed = text(&output.stdout);
        let found = number_after(&printed, "critical values:\n");
        assert!((found - stribeck_critical_friction()).abs() < 1e-9, "{printed}");
        let is_cut = range.ends_with("0.6:0.05");
        for told in [&printed, &text(&output.stderr)] {
            let note = "4 values of friction.coefficient from 0.45 to 0.6 are skipped";
            assert_eq!(told.contains(note), is_cut, "{told}");
        }
    }
    for range in ["0.1:0.3", "0.1:0.6"] {
        let printed = printed(&["bistable", STRIBECK, "--friction", range]);
        let found = number_after(&printed, "µ = ");
        assert!((found - stribeck_critical_friction()).abs() < 1e-9, "{printed}");
        assert!(printed.contains("ceases to grow"), "{printed}");
        assert_eq!(printed.contains("above 0.4 is left out"), range.ends_with("0.6"));
    }
    let map = printed(&[
        "map",
        STRIBECK,
        "--x",
        "friction.coefficient=0.2:0.5/4",
        "--y",
        "slider.velocity=0.1:0.2/2",
        "--csv",
    ]);
    let verdicts: Vec<&str> = map.lines().skip(1).map(|l| l.rsplit(',').next().unwrap()).collect();
    let impossible = "static below kinetic friction";
    assert_eq!(
        verdicts,
        ["unstable", "stable", "stable", impossible, "stable", "stable", "stable", impossible]
    );
}

#[test]
fn static_friction_bounds_the_range_of_friction_and_changes_no_onset() {
    let folder = folder();
    let with = include_str!("../../../../scenes/set2.toml").replacen(
        "[damping]",
        "static = 2.2\n\n[damping]",
        1,
    );
    fs::write(folder.path().join("static.toml"), with).unwrap();
    let output = stability(folder.path(), &["bistable", "static.toml", "--friction", "1.5:2.5"]);
    let found = text(&output.stdout);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(found.contains("above 2.2 is left out"), "{found}");
    let without = printed(&["bistable", "set2", "--friction", "1.5:2.2"]);
    let onset = |printed: &str| number_after(printed, "µ = ");
    assert!((onset(&found) - onset(&without)).abs() < 1e-9, "{found} {without}");
}

#[test]
fn each_command_says_what_it_leaves_out_of_signals_and_when_it_looks() {
    let folder = folder();
    let ramp = "\n[[signal]]\ninput = \"friction.coefficient\"\n\
                ramp = { from = 0.0, to = 1.0, start = 0.0, end = 2.0 }\n";
    let scene = format!("{}{ramp}", include_str!("../../../../scenes/set2.toml"));
    fs::write(folder.path().join("ramp.toml"), scene).unwrap();
    let map = "map ramp.toml --x slider.angle=0.4:0.5/2 --y damping.beta=1e-5:2e-5/2 --plot m.svg";
    for command in [
        "states ramp.toml",
        "modes ramp.toml",
        "locus ramp.toml --parameter slider.angle=0.4:0.5:0.1",
        map,
    ] {
        for (at, when) in [("", "t = 0 s"), (" --at 1", "t = 1 s")] {
            let line = format!("{command}{at}");
            let output = stability(folder.path(), &line.split(' ').collect::<Vec<_>>());
            assert!(output.status.success(), "{}", text(&output.stderr));
            for told in [text(&output.stdout), text(&output.stderr)] {
                let added = if at.is_empty() { "0 to" } else { "0.5 to" };
                let words = format!("{when}, where its signals add {added} friction.coefficient");
                assert!(told.contains(&words), "{line}: {told}");
            }
        }
    }
    // µ of the instant: the modes are those of a scene that has it always.
    let state = |arguments: &str| {
        let arguments: Vec<&str> = arguments.split(' ').collect();
        let output = stability(folder.path(), &arguments);
        let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        found
    };
    let driven = state("states ramp.toml --at 1 --format json");
    let mu = driven["friction"].as_f64().unwrap();
    let plain = state(&format!("states set2 --friction {mu} --format json"));
    assert_eq!(driven["states"], plain["states"]);
    assert_eq!((&driven["at"], plain["at"].is_null()), (&1.0.into(), true));
    assert_ne!(driven["states"], state("states ramp.toml --format json")["states"]);
    // A quantity that a signal drives cannot be varied.
    for command in [
        "bistable ramp.toml --friction 0:1",
        "locus ramp.toml --friction 0:1:0.5",
        "map ramp.toml --x friction.coefficient=0:1/2 --y damping.beta=1e-5:2e-5/2 --csv",
    ] {
        let output = stability(folder.path(), &command.split(' ').collect::<Vec<_>>());
        assert_refused(&output, 2, &["signal[1] of ramp drives friction.coefficient"]);
    }
}

#[test]
fn candidates_are_confirmed_or_it_is_said_what_was_tried() {
    let printed = printed(&["bistable", "set2", "--friction", "2:2.06", "--confirm"]);
    // The paper's Figs. 6 and 7: Set 2 squeals beside rest there, but its contacts, which are alike, stick together.
    let line = printed.lines().find(|line| line.contains("Sl-St (")).unwrap();
    assert!(
        line.contains("not confirmed") && line.contains("a second motion still exists"),
        "{printed}"
    );
    let below = self::printed(&["bistable", "set2", "--friction", "1.5:1.6", "--confirm"]);
    let line = below.lines().find(|line| line.contains("Sl-St (")).unwrap();
    // Stick-slip needs more friction there, as continuation shows.
    for words in ["not confirmed by pushes of", "m/s at µ = 1.52", "for 120 s", "came to rest"] {
        assert!(line.contains(words), "{words}: {below}");
    }
}

#[test]
fn only_the_states_that_a_scene_leaves_its_contacts_are_looked_at() {
    let folder = folder();
    let set1 = include_str!("../../../../scenes/set1.toml");
    let without = |effects: &str| format!("{set1}\n[effects]\n{effects}\n");
    let (slide, back, stick, open) = ("Sl", "R-Sl", "St", "Dt");
    for (scene, each) in [
        (set1.to_owned(), &[slide, back, stick, open][..]),
        (without("sticking = false"), &[slide, back, open]),
        (without("detachment = false"), &[slide, back, stick]),
        (without("sticking = false\ndetachment = false"), &[slide, back]),
    ] {
        fs::write(folder.path().join("some.toml"), scene).unwrap();
        let output = stability(folder.path(), &["states", "some.toml", "--format", "json"]);
        let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let found: BTreeSet<&str> =
            found["states"].as_object().unwrap().keys().map(String::as_str).collect();
        let pairs = each.iter().flat_map(|a| each.iter().map(move |b| format!("{a}-{b}")));
        let expected: BTreeSet<String> = pairs.collect();
        assert!(found.iter().copied().eq(expected.iter()), "{found:?} {expected:?}");
        let solved = format!("{} states", expected.len());
        assert!(text(&output.stderr).contains(&solved), "{}", text(&output.stderr));
    }
}

#[test]
fn arguments_that_make_no_sense_are_refused_with_what_would_be_right() {
    let cases: &[(&[&str], i32, &[&str])] = &[
        (&["states", "nothing"], 1, &["nothing", "set1, set2, ring12"]),
        (&["states", "set1", "--friction", "-1"], 3, &["friction.coefficient", "negative"]),
        (&["states", "set1", "--state", "Sl-Up"], 2, &["Sl-Up", "Sl-St"]),
        (&["states", "set1", "--friction", "1e300"], 3, &["mass matrix", "singular"]),
        (&["locus", "set1"], 2, &["--friction"]),
        (
            &["locus", "set1", "--parameter", "slider.velocity=-1:1:0.1"],
            2,
            &["slider.velocity has no effect on this analysis", "slider.angle"],
        ),
        (
            &["locus", "set1", "--parameter", "module[1].k1=1:9:1", "--set", "slider.velocity=0"],
            3,
            &["no surface moves"],
        ),
        (&["locus", "set1", "--friction", "0:3.5"], 2, &["A:B:STEP"]),
        (&["locus", "set1", "--friction", "3:0:0.1"], 2, &["below the last"]),
        (&["locus", "set1", "--parameter", "module[1].k9=1:2:0.1"], 2, &["k9", "module[1].k1"]),
        (&["locus", "set1", "--friction", "0:1:0.1", "--plot", "a.pdf"], 1, &[".svg", ".png"]),
        (&["bistable", "set1", "--friction", "2"], 2, &["A:B"]),
        (&["bistable", "set1", "--friction", "-1:1"], 3, &["friction.coefficient", "negative"]),
        (
            &["bistable", "set1", "--friction", "0:1", "--set", "slider.velocity=0"],
            3,
            &["no surface moves"],
        ),
        (
            &["bistable", "set1", "--friction", "5:6", "--set", "slider.angle=-0.5"],
            3,
            &["contact[1] jams"],
        ),
        (&["bistable", "ring12", "--friction", "0:1"], 3, &["12 contacts", "8"]),
        (
            &["locus", STRIBECK, "--friction", "0.5:1:0.1"],
            3,
            &["friction.static = 0.4", "at least the kinetic"],
        ),
        (&["bistable", STRIBECK, "--friction", "0.5:1"], 3, &["friction.static = 0.4"]),
        (
            &["locus", STRIBECK, "--parameter", "slider.velocity=-0.2:0.2:0.1"],
            2,
            &["R-Sl at slider.velocity = -0.2 and Sl at 0.1", "no surface turns"],
        ),
        (
            &["locus", STRIBECK, "--parameter", "mass.block.fy=-10:20:5"],
            2,
            &["linearised about an equilibrium", "from -10 to 10"],
        ),
        (&["states", "set1", "--at", "-1"], 2, &["--at", "negative"]),
        (
            &[
                "map",
                "set1",
                "--x",
                "damping.beta=0:1/3",
                "--y",
                "damping.beta=0:1/2",
                "--plot",
                "m.svg",
            ],
            2,
            &["two parameters"],
        ),
        (
            &[
                "map",
                "set1",
                "--x",
                "damping.beta=0:1/9999",
                "--y",
                "slider.angle=0:1/9999",
                "--plot",
                "m.svg",
            ],
            2,
            &["too many"],
        ),
        (&["map", "set1", "--x", "k=0:1/1", "--y", "k=0:1/2", "--plot", "m.svg"], 2, &["from 2"]),
        (
            &["map", "set1", "--x", "k=0:1/2", "--y", "k=0:1/2", "--islands", "3"],
            2,
            &["1, 2, 4, 8"],
        ),
    ];
    let folder = folder();
    for (arguments, code, words) in cases {
        assert_refused(&stability(folder.path(), arguments), *code, words);
    }
}
