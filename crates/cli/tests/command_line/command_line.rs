//! The program as its user meets it.

use crate::program::{self, folder, run, text};
use amontons::scene::BUILTIN;
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

fn amontons(folder: &Path, arguments: &[&str]) -> Output {
    run(env!("CARGO_BIN_EXE_amontons"), folder, arguments)
}

/// Set 1's file with one piece of text replaced.
fn scene_file(folder: &Path, from: &str, to: &str) -> PathBuf {
    let scene = text(&amontons(folder, &["scenes", "show", "set1"]).stdout);
    assert!(scene.contains(from), "{from}");
    let path = folder.join("mine.toml");
    fs::write(&path, scene.replacen(from, to, 1)).unwrap();
    path
}

/// Runs a command that must fail with this exit code and these words on standard error.
fn assert_refused(folder: &Path, arguments: &[&str], code: i32, words: &[&str]) {
    program::assert_refused(&amontons(folder, arguments), code, words);
}

#[test]
fn export_writes_the_fmu_and_says_what_went_in() {
    let folder = folder();
    let output = amontons(folder.path(), &["export", "set1"]);
    let printed = text(&output.stdout);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(folder.path().join("set1.fmu").is_file());
    for words in ["ring of 2 modules", "10 inputs", "critical step", "state Sl-Sl", "set1.fmu"] {
        assert!(printed.contains(words), "{printed}");
    }
}

#[test]
fn a_file_of_ones_own_starts_from_a_built_in_one() {
    let folder = folder();
    let path = scene_file(folder.path(), "m1 = 0.3 ", "m1 = [0.3, 0.35] ");
    let output = amontons(folder.path(), &["export", path.to_str().unwrap(), "-o", "brake 1.fmu"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(folder.path().join("brake 1.fmu").is_file());
}

#[test]
fn simulate_prints_rows_that_start_at_zero_and_end_at_the_stop_time() {
    let folder = folder();
    let run = ["simulate", "set1", "--stop-time", "0.0105", "--output-interval", "1e-3"];
    let printed = text(&amontons(folder.path(), &run).stdout);
    let lines: Vec<&str> = printed.lines().collect();
    assert!(lines[0].starts_with("time,module[1].x1,module[1].x2"), "{}", lines[0]);
    let times: Vec<&str> = lines[1..].iter().map(|line| line.split(',').next().unwrap()).collect();
    assert_eq!(times.len(), 12);
    assert_eq!((times[0], times[3], times[11]), ("0.0", "0.003", "0.0105"));
    // Rows closer to each other than an internal step, and a stop just behind a row.
    let rows = |stop: &str, interval: &str| {
        let run = ["simulate", "set1", "--stop-time", stop, "--output-interval", interval];
        text(&amontons(folder.path(), &run).stdout).lines().count() - 1
    };
    assert_eq!(rows("0.001", "2e-7"), 5001);
    assert_eq!(rows("0.0100004", "1e-3"), 12);
    assert_eq!(rows("0.1", "0.01"), 11);
}

#[test]
fn set_changes_what_the_fmu_would_change_and_step_the_grid() {
    let folder = folder();
    let run = |extra: &[&str]| {
        let arguments = [&["simulate", "set1", "--stop-time", "0.01"], extra].concat();
        text(&amontons(folder.path(), &arguments).stdout)
    };
    let plain = run(&[]);
    assert_eq!(plain, run(&["--set", "friction.coefficient=1.96", "--step", "1e-6"]));
    assert_ne!(plain, run(&["--set", "module[2].k5=3.1e5"]));
    assert_ne!(plain, run(&["--step", "2e-6"]));
}

#[test]
fn inputs_from_a_file_act_between_the_rows_and_are_refused_by_name_and_line() {
    let folder = folder();
    let simulate = |table: &str| {
        fs::write(folder.path().join("in.csv"), table).unwrap();
        let times = ["--stop-time", "0.003", "--output-interval", "1e-3"];
        amontons(folder.path(), &[&["simulate", "set1", "--input", "in.csv"], &times[..]].concat())
    };
    // Rows at the intervals and where the input jumps; friction follows µ from the next row on.
    let output = simulate("time,friction.coefficient\n0,1\n0.0015,1\n0.0015,0.5\n");
    assert!(output.status.success(), "{}", text(&output.stderr));
    let printed = text(&output.stdout);
    let times: Vec<&str> = printed.lines().map(|line| line.split(',').next().unwrap()).collect();
    assert_eq!(times, ["time", "0.0", "0.001", "0.0015", "0.002", "0.003"]);
    for (table, code, words) in [
        (
            "time,friction.coeficient\n0,1\n",
            2,
            &["not an input", "mean \"friction.coefficient\"?"][..],
        ),
        ("time,module[1].x1\n0,1\n", 2, &["module[1].x1", "not an input of set1"]),
        ("time,friction.coefficient\n0,1\n1,x\n", 3, &["in.csv", "line 3", "`x`"]),
        ("time,friction.coefficient\n0,1\n0.002,-1\n", 4, &["at 0.002 s", "not be negative"]),
        ("time,friction.coefficient,time\n0,1,0\n", 3, &["two columns", "`time`"]),
        ("t,friction.coefficient\n0,1\n", 3, &["must be `time`"]),
    ] {
        program::assert_refused(&simulate(table), code, words);
    }
    assert_refused(folder.path(), &["simulate", "set1", "--input", "gone.csv"], 1, &["gone.csv"]);
}

#[test]
fn scenes_are_listed_and_shown() {
    let folder = folder();
    let list = text(&amontons(folder.path(), &["scenes"]).stdout);
    assert_eq!(list.lines().count(), BUILTIN.len());
    let shown = amontons(folder.path(), &["scenes", "show", "set2"]).stdout;
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/set2.toml");
    assert_eq!(shown, fs::read(file).unwrap());
    let schema = amontons(folder.path(), &["scenes", "schema"]).stdout;
    assert!(serde_json::from_slice::<serde_json::Value>(&schema).is_ok());
    assert_refused(folder.path(), &["scenes", "show", "set3"], 2, &["set3", "set1, set2, ring12"]);
}

/// Two masses, with values of many sizes.
const PAD_ON_DISC: &str = r#"
[slider]
velocity = -0.1
angle = 0.0
[friction]
coefficient = 0.5
[[mass]]
name = "pad"
mass = 0.02
force = [0.0, -50.0]
[[mass]]
name = "disc"
mass = 2500.0
locked = ["x"]
[[spring]]
name = "support"
between = ["pad", "ground"]
direction = "x"
stiffness = 2.5e6
[[spring]]
name = "loose"
between = ["pad", "ground"]
direction = "y"
stiffness = 0.0
[[spring]]
name = "bearing"
between = ["disc", "ground"]
direction = "y"
stiffness = 4e5
[[damper]]
name = "shim"
between = ["pad", "ground"]
direction = "x"
damping = 0.5
[[contact]]
name = "lining"
mass = "pad"
on = "disc"
friction = 0.4
[integrator]
step = 1.0e-6
"#;

/// A scene's picture as SVG; its description says in words what is to be seen.
fn drawn(folder: &Path, scene: &str) -> String {
    let output = amontons(folder, &["scenes", "draw", scene, "-o", "drawn.svg"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    fs::read_to_string(folder.join("drawn.svg")).unwrap()
}

#[test]
fn a_ring_is_drawn_with_what_each_spring_joins() {
    let folder = folder();
    let svg = drawn(folder.path(), "set1");
    for words in [
        "<title>The paper's Set 1",
        "mass m1[2] 0.3 kg",
        "mass m2[1] 0.7 kg",
        "spring k1 55 kN/m from m1[1] to m1[2] at 0°",
        "spring k2 60 kN/m from m1[2] to m1[1] at 90°",
        "spring k3 22 kN/m, preload 5 mm from m1[1] to ground at 90°",
        "spring k4 60 kN/m from m1[2] to ground at 0°",
        "spring k5 300 kN/m from m1[1] to m2[1] at 90°",
        "spring k6 250 kN/m from m1[2] to m2[2] at 0°",
        "contact c[2] µ = 1.96, v = 0.025 m/s of m2[2] on a slider at 29°",
    ] {
        assert!(svg.replace("&apos;", "'").contains(words), "{words} is missing in: {svg}");
    }
    let path = scene_file(folder.path(), "k3 = 22e3 ", "k3 = [0.0, 22e3] ");
    let svg = drawn(folder.path(), path.to_str().unwrap());
    assert!(
        svg.contains("spring k3[2] 22 kN/m, preload 5 mm from m1[2]") && !svg.contains("k3[1]"),
        "{svg}"
    );
    let path = scene_file(folder.path(), "modules = 2", "modules = 1");
    let svg = drawn(folder.path(), path.to_str().unwrap());
    assert!(svg.contains("spring k3 ") && !svg.contains("spring k1 "), "{svg}");
}

#[test]
fn a_network_is_drawn_with_its_names_and_values() {
    let folder = folder();
    fs::write(folder.path().join("two.toml"), PAD_ON_DISC).unwrap();
    let output = amontons(folder.path(), &["scenes", "draw", "two.toml", "-o", "two.png"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let png = fs::read(folder.path().join("two.png")).unwrap();
    assert!(png.starts_with(b"\x89PNG\r\n\x1a\n"));
    let svg = drawn(folder.path(), "two.toml");
    for words in [
        "mass pad 20 g",
        "mass disc 2.5 t, locked along its first axis",
        "spring support 2.5 MN/m from pad to ground at 0°",
        "spring bearing 400 kN/m from disc to ground at 90°",
        "damper shim 0.5 N s/m from pad to ground at 0°",
        "contact lining µ = 0.4, v = −0.1 m/s of pad on disc at 0°",
    ] {
        assert!(svg.contains(words), "{words} is missing in: {svg}");
    }
    assert!(!svg.contains("loose"), "{svg}");
}

#[test]
fn what_cannot_be_drawn_is_refused_with_what_would_be_right() {
    let folder = folder();
    let refused = |scene: &str, file: &str, words: &[&str]| {
        assert_refused(folder.path(), &["scenes", "draw", scene, "-o", file], 1, words);
        assert!(!folder.path().join(file).exists());
    };
    // The ending comes before all else.
    refused("nothing", "a.pdf", &["a.pdf", ".svg or .png"]);
    let path = scene_file(folder.path(), "modules = 2", "modules = 30");
    refused(path.to_str().unwrap(), "a.svg", &["a.svg", "60 masses", "up to 40"]);
}

#[test]
fn impossible_scenes_are_refused_with_what_would_be_right() {
    let cases: &[(&str, &str, &[&str])] = &[
        ("k1 = 55e3", "k1 = 55e3\nk7 = 1", &["mine.toml:20:1", "`k7` is not a key of [ring]"]),
        ("m1 = 0.3 ", "m1 = -0.3 ", &["mine.toml:17:6", "ring.m1 = -0.3: must be above zero"]),
        ("m1 = 0.3 ", "m1 = [0.3] ", &["ring.m1", "1 value,", "2 modules"]),
        ("m1 = 0.3 ", "m1 = nan ", &["ring.m1", "finite"]),
        ("modules = 2", "modules = 0", &["ring.modules = 0", "1 to 100000"]),
        ("module = 1", "module = 3", &["initial[1].module = 3", "1 to 2"]),
        (
            "v1 = 1.0e-7",
            "v1 = 1\n[[initial]]\nmodule = 1",
            &["initial[2].module = 1", "more than one [[initial]]"],
        ),
        ("angle = 0.5", "angle = 30.0", &["slider.angle = 30", "0.5236"]),
        ("v1 = 1.0e-7", "x4 = -1.0e-7", &["initial[1].x4", "inside the slider"]),
        ("step = 1.0e-6", "step = 2.0e-3", &["critical step", "3.0196e-4", "Sl-Sl, coalesced"]),
        (
            "angle = 0.5             # θ, rad\n\n[friction]\ncoefficient = 1.96",
            "angle = -0.5\n\n[friction]\ncoefficient = 5",
            &["no equilibrium", "contact[1] jams from 3.577224 on"],
        ),
        ("angle = 0.5", "angle = \"steep\"", &["mine.toml:7:9", "slider.angle"]),
    ];
    for (from, to, words) in cases {
        let folder = folder();
        let path = scene_file(folder.path(), from, to);
        let path = path.to_str().unwrap();
        fs::write(folder.path().join("kept.fmu"), "an older one").unwrap();
        assert_refused(folder.path(), &["export", path, "-o", "kept.fmu"], 3, words);
        assert_eq!(fs::read(folder.path().join("kept.fmu")).unwrap(), b"an older one");
        assert_refused(folder.path(), &["simulate", path], 3, words);
    }
}

#[test]
fn a_step_that_does_not_go_with_the_stiffness_is_warned_of() {
    let folder = folder();
    let warned = |step: &str| {
        let run = ["simulate", "set1", "--stop-time", "1e-6", "--step", step];
        text(&amontons(folder.path(), &run).stderr)
    };
    assert_eq!(warned("1e-6"), "");
    let warning = warned("1e-7");
    for words in ["warning: integrator.step = 1e-7 s", "3.0196e-4 s", "N/m"] {
        assert!(warning.contains(words), "{warning}");
    }
}

#[test]
fn arguments_that_make_no_sense_are_refused_with_what_would_be_right() {
    let folder = folder();
    let refused = |arguments: &[&str], code, words: &[&str]| {
        assert_refused(folder.path(), arguments, code, words);
    };
    refused(&["export", "nothing"], 1, &["nothing", "set1, set2, ring12"]);
    refused(&["export", "."], 1, &["is a folder", "set1, set2, ring12"]);
    refused(&["export"], 2, &["SCENE"]);
    refused(&["simulate", "set1", "--stop-time", "-1"], 2, &["above zero"]);
    refused(&["simulate", "set1", "--set", "module[1].k9=1"], 2, &["module[1].k9", "module[1].k1"]);
    refused(&["simulate", "set1", "--set", "module[1].k2"], 2, &["NAME=VALUE"]);
    refused(&["simulate", "set1", "--set", "module[1].x1=0"], 2, &["module[1].x1", "output"]);
    refused(
        &["simulate", "set1", "--set", "module[1].perload=0"],
        2,
        &["did you mean module[1].preload?"],
    );
    refused(&["simulate", "set1", "--set", "module[1].m1=0"], 3, &["module[1].m1", "above zero"]);
    refused(&["simulate", "set1", "-o", "no/such/place.csv"], 1, &["no/such/place.csv"]);
    refused(&["export", "set1", "-o", "."], 1, &["cannot use"]);
}

#[test]
fn what_is_not_a_regular_file_is_written_through_and_not_replaced() {
    let folder = folder();
    let real = folder.path().join("real.csv");
    fs::write(&real, "old").unwrap();
    std::os::unix::fs::symlink("real.csv", folder.path().join("link.csv")).unwrap();
    let run = ["simulate", "set1", "--stop-time", "0.001", "-o"];
    let output = amontons(folder.path(), &[&run[..], &["link.csv"]].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(folder.path().join("link.csv").is_symlink());
    assert!(fs::read_to_string(&real).unwrap().starts_with("time,"));
    let output = amontons(folder.path(), &[&run[..], &["/dev/null"]].concat());
    assert!(output.status.success() && !Path::new("/dev/null").is_file());
}

#[test]
fn a_folder_or_file_does_not_hide_a_built_in_scene() {
    let folder = folder();
    fs::create_dir(folder.path().join("set2")).unwrap();
    assert!(amontons(folder.path(), &["export", "set2"]).status.success());
    assert!(amontons(folder.path(), &["export", "set1", "-o", "set1"]).status.success());
    assert!(amontons(folder.path(), &["export", "set1"]).status.success());
    assert_refused(folder.path(), &["export", "./set1"], 3, &["./set1 is not a text file"]);
}

#[test]
fn two_exports_of_a_scene_are_equal_byte_for_byte() {
    let folder = folder();
    for name in ["a.fmu", "b.fmu"] {
        assert!(amontons(folder.path(), &["export", "set1", "-o", name]).status.success());
    }
    let read = |name| fs::read(folder.path().join(name)).unwrap();
    assert!(read("a.fmu") == read("b.fmu"));
}

#[test]
fn a_name_that_has_two_values_is_refused_with_both() {
    let folder = folder();
    let both = ["--set", "friction.coefficient=0.4", "--set", "friction.coefficient=0.6"];
    for command in [&["simulate"][..], &["accuracy"], &["study", "transient"]] {
        let words = ["friction.coefficient twice", "0.4", "0.6"];
        assert_refused(folder.path(), &[command, &["set1"], &both].concat(), 2, &words);
    }
}

#[test]
fn a_decimal_comma_is_answered_by_the_number_that_is_meant() {
    let folder = folder();
    for (arguments, meant) in [
        (&["simulate", "set1", "--set", "friction.coefficient=0,45"][..], "=0.45"),
        (&["simulate", "set1", "--sweep", "friction.coefficient=0,4:0.5/3"], "write 0.4"),
        (&["study", "continuation", "set1", "--friction", "0.4:0,5:0.1"], "write 0.5"),
    ] {
        assert_refused(folder.path(), arguments, 2, &[meant]);
    }
}

#[test]
fn studies_of_one_scene_with_other_values_do_not_share_a_folder() {
    let folder = folder();
    let study = |values: &[&str]| {
        let all = [&["study", "transient", "set1", "--stop-time", "0.05"], values].concat();
        amontons(folder.path(), &all)
    };
    let history = |name: &str| fs::read(folder.path().join(name).join("history.csv")).unwrap();
    let other = ["--set", "friction.coefficient=1.5"];
    assert!(study(&[]).status.success());
    let first = history("set1-transient");
    for _ in 0..2 {
        // The second time it finds its own again.
        let second = study(&other);
        let note = text(&second.stderr);
        assert!(second.status.success(), "{note}");
        for word in [
            "set.friction.coefficient is not given in that study and 1.5 in this one",
            "set1-transient-2",
        ] {
            assert!(note.contains(word), "{note}");
        }
    }
    assert!(history("set1-transient") == first && history("set1-transient-2") != first);
    assert!(!folder.path().join("set1-transient-3").exists());
    // A folder that is named is this study's, or is dropped by name.
    let named = [&other[..], &["-o", "set1-transient"]].concat();
    program::assert_refused(&study(&named), 1, &["another study", "-o", "--anew"]);
    assert!(history("set1-transient") == first);
    assert!(study(&[&named[..], &["--anew"]].concat()).status.success());
    assert_eq!(history("set1-transient"), history("set1-transient-2"));
    // Results that no journal explains may be a person's own.
    fs::create_dir(folder.path().join("set2-transient")).unwrap();
    fs::write(folder.path().join("set2-transient/results.csv"), "mine\n").unwrap();
    let output = amontons(folder.path(), &["study", "transient", "set2", "--stop-time", "0.05"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(fs::read(folder.path().join("set2-transient/results.csv")).unwrap(), b"mine\n");
    assert!(folder.path().join("set2-transient-2/results.csv").is_file());
}

#[test]
fn long_work_says_how_far_it_is_where_nobody_looks() {
    let folder = folder();
    let mut command = Command::new(env!("CARGO_BIN_EXE_amontons"));
    command.args(["simulate", "set1", "--stop-time", "1000", "-o", "out.csv"]);
    let mut run = command.current_dir(folder.path()).stderr(Stdio::piped()).spawn().unwrap();
    let lines = BufReader::new(run.stderr.take().unwrap()).lines();
    let line = lines.map(Result::unwrap).find(|line| !line.starts_with("warning: ")).unwrap();
    run.kill().unwrap();
    run.wait().unwrap();
    assert!(line.starts_with("the run: ") && line.ends_with(" left"), "{line}");
    assert!(line.contains(" %, about "), "{line}");
}

#[test]
fn a_limit_cycle_skips_friction_above_the_static_one_with_a_note() {
    let folder = folder();
    let path = scene_file(folder.path(), "coefficient = 1.96", "static = 0.4\ncoefficient = 0.3");
    let all = ["study", "limit-cycle", path.to_str().unwrap(), "--parameter"];
    let range = |range| {
        let looks = ["--window", "0.2", "--interval", "2e-4", "-o", "found"];
        amontons(folder.path(), &[&all[..], &[range], &looks].concat())
    };
    let output = range("friction.coefficient=0.3:0.6:0.1");
    let note = text(&output.stderr);
    assert!(output.status.success(), "{note}");
    assert!(
        note.contains("2 values of friction.coefficient from 0.5 to 0.6 are skipped"),
        "{note}"
    );
    let table = fs::read_to_string(folder.path().join("found/results.csv")).unwrap();
    let values: Vec<&str> =
        table.lines().skip(1).map(|row| row.split(',').next().unwrap()).collect();
    assert_eq!(values, ["0.3", "0.4"]);
    program::assert_refused(&range("friction.coefficient=0.5:0.6:0.1"), 3, &["friction.static"]);
}

/// Message about a scene file that must be refused within some seconds, most of which are allowed for machines under
/// load, and with 280 MiB of address space beside the program's own file, which grows with the libraries that it carries.
#[cfg(unix)]
fn refused_with_little(folder: &Path, scene: &str, input: Stdio) -> String {
    let program = env!("CARGO_BIN_EXE_amontons");
    let begun = std::time::Instant::now();
    let kibibytes = 280 * 1024 + fs::metadata(program).unwrap().len() / 1024;
    let command = format!("ulimit -v {kibibytes}; exec '{program}' simulate {scene}");
    let output =
        Command::new("sh").args(["-c", &command]).current_dir(folder).stdin(input).output();
    let output = output.unwrap();
    assert_eq!(output.status.code(), Some(3), "{scene}: {}", text(&output.stderr));
    assert!(begun.elapsed().as_secs() < 5, "{scene}: {:?}", begun.elapsed());
    text(&output.stderr)
}

#[cfg(unix)]
#[test]
fn what_is_larger_than_any_scene_is_refused_before_it_takes_memory() {
    let folder = folder();
    let refused = |scene: &str, words: &str| {
        let message = refused_with_little(folder.path(), scene, Stdio::null());
        assert!(message.contains(words), "{message}");
    };
    // A hundred megabytes; nothing of them is read.
    let large = fs::File::create(folder.path().join("large.toml")).unwrap();
    large.set_len(100_000_000).unwrap();
    refused("large.toml", "larger than 64 MB");
    refused("/dev/zero", "larger than 64 MB");
    let masses = "[[mass]]\n".repeat(1_000_001);
    fs::write(folder.path().join("masses.toml"), masses).unwrap();
    refused("masses.toml", "has 1000001 [[mass]]: a network has at most 1000000");
    let list = format!("mass = [{}", "{},".repeat(5_000_000));
    fs::write(folder.path().join("list.toml"), list).unwrap();
    refused("list.toml", "more than 8000000 values, the limit for scene files");
    for (file, shape) in [("keys.toml", ["key", " = 1\n"]), ("headers.toml", ["[k", "]\n"])] {
        let [before, after] = shape;
        let keys: Vec<String> = (0..4_200_000).map(|i| format!("{before}{i}{after}")).collect();
        fs::write(folder.path().join(file), keys.concat()).unwrap();
        refused(file, "more than 100000 different keys, but scene files know only about a hundred");
    }
    // An input without an end.
    let mut endless = Command::new("yes").stdout(Stdio::piped()).spawn().unwrap();
    let lines = endless.stdout.take().unwrap();
    let message = refused_with_little(folder.path(), "/dev/stdin", lines.into());
    assert!(message.contains("larger than 64 MB"), "{message}");
    endless.wait().unwrap();
}

#[cfg(unix)]
#[test]
fn a_long_text_of_nothing_but_errors_is_refused_by_its_first_ones() {
    let folder = folder();
    let refused = |name: &str, content: String, words: &str| {
        fs::write(folder.path().join(name), content).unwrap();
        let message = refused_with_little(folder.path(), name, Stdio::null());
        assert!(message.contains(words) && message.len() < 20_000, "{}", message.len());
    };
    refused("lines.toml", "= ] \"\n".repeat(200_000), "lines.toml:1:");
    let name = "a".repeat(30_000_000);
    refused("signs.toml", format!("{name}{}", "=".repeat(200_000)), "signs.toml:1:");
    let keys: Vec<String> = (0..100_000).map(|i| format!("key{i} = 1\n")).collect();
    refused("keys.toml", keys.concat(), " problems or more in keys.toml");
}

#[cfg(unix)]
#[test]
fn tables_of_any_size_are_read_no_further_than_their_bound() {
    let folder = folder();
    let input = ["simulate", "set1", "--stop-time", "0.01", "--input"];
    assert_refused(
        folder.path(),
        &[&input[..], &["/dev/zero"]].concat(),
        3,
        &["larger than 256 MB"],
    );
    let signal = "\n[[signal]]\ninput = \"module[1].f1\"\ntable = { file = \"push.csv\" }\n";
    let path = scene_file(folder.path(), "[integrator]", &format!("{signal}[integrator]"));
    let table = fs::File::create(folder.path().join("push.csv")).unwrap();
    table.set_len(300_000_000).unwrap();
    let words = ["push.csv", "is too large", "256 MB together"];
    assert_refused(folder.path(), &["simulate", path.to_str().unwrap()], 3, &words);
}

#[test]
fn times_that_no_run_can_have_are_refused_with_what_can() {
    let folder = folder();
    let refused = |arguments: &[&str], code: i32, words: &[&str]| {
        let all = [&["simulate", "set1", "-o", "out.csv"], arguments].concat();
        let output = amontons(folder.path(), &all);
        program::assert_refused(&output, code, words);
        let longest = text(&output.stderr).split(|c: char| !c.is_ascii_digit()).map(str::len).max();
        assert!(longest < Some(20), "{}", text(&output.stderr));
        assert!(!folder.path().join("out.csv.partial").exists());
    };
    let step = "integrator.step = 1e-300: needs 6.0e300 steps up to experiment.stop_time = 6";
    refused(&["--step", "1e-300"], 3, &[step, "choose a step of at least 7.0e-16 s"]);
    refused(&["--step", "1e-321"], 3, &["integrator.step = 1e-321: needs more than 1e308 steps"]);
    refused(&["--step", "1e-300", "--integrator", "event-driven"], 3, &[step]);
    refused(
        &["--stop-time", "1e308"],
        3,
        &["more than 1e9 rows up to experiment.stop_time = 1e308"],
    );
    let long = ["--stop-time", "1e308", "--output-interval", "1e307"];
    refused(&long, 3, &["integrator.step = 1e-6: needs more than 1e308 steps"]);
    refused(&["--output-interval", "1e-300"], 3, &["more than 1e9 rows", "longer interval"]);
    for value in ["0", "-1", "nan", "inf"] {
        for option in ["--step", "--stop-time", "--output-interval"] {
            refused(&[option, value], 2, &["must be a number above zero, in seconds"]);
        }
    }
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_names_the_file_that_its_rows_are_in() {
    let interrupted = |arguments: &[&str], words: &str| {
        let folder = folder();
        let mut command = Command::new(env!("CARGO_BIN_EXE_amontons"));
        command.current_dir(folder.path()).args(["simulate", "set1", "-o", "out.csv"]);
        let child = command.args(arguments).stderr(Stdio::piped()).spawn().unwrap();
        std::thread::sleep(std::time::Duration::from_secs(2));
        let id = child.id().to_string();
        assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
        let begun = std::time::Instant::now();
        let output = child.wait_with_output().unwrap();
        assert!(begun.elapsed().as_secs() < 5, "{:?}", begun.elapsed());
        program::assert_refused(&output, 130, &["interrupted at", words, "out.csv.partial"]);
        assert!(!folder.path().join("out.csv").exists());
        fs::read_to_string(folder.path().join("out.csv.partial")).unwrap()
    };
    let rows = interrupted(&["--stop-time", "1e4"], "s of 10000 s");
    // Whole rows, more than a buffer of them.
    assert!(rows.lines().count() > 100 && rows.ends_with('\n'));
    let columns = |line: &str| line.split(',').count();
    assert!(rows.lines().all(|line| columns(line) == columns(rows.lines().next().unwrap())));
    // Within the first row.
    let rows = interrupted(&["--step", "1e-14", "--stop-time", "10"], "at 0 s of 10 s");
    assert_eq!(rows.lines().count(), 2);
}

/// Who reads no further than the first lines, as `| head` does, once ended a study with a panic.
#[test]
fn a_study_whose_reader_has_gone_writes_its_files_and_succeeds() {
    let folder = folder();
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let continuation =
        ["study", "continuation", "set2", "--friction", "0.1:0.2:0.1", "-o", "found"];
    let output = Command::new(env!("CARGO_BIN_EXE_amontons"))
        .args(continuation)
        .current_dir(folder.path())
        .stdout(writer)
        .stderr(Stdio::piped())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(folder.path().join("found/study.json").is_file());
}
