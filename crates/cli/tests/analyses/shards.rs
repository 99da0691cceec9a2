//! Several workers that share a study have the results of one machine, to the last byte.

use crate::program::{assert_refused, folder, run, text};
use std::collections::BTreeMap;
use std::fs;
use std::ops::RangeInclusive;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

const AMONTONS: &str = env!("CARGO_BIN_EXE_amontons");
const STABILITY: &str = env!("CARGO_BIN_EXE_amontons-stability");

/// A command without its folder, and the command that merges.
struct Shared {
    program: &'static str,
    arguments: &'static [&'static str],
    merge: &'static [&'static str],
}

const LIMIT_CYCLE: Shared = Shared {
    program: AMONTONS,
    arguments: &[
        "study",
        "limit-cycle",
        "set1",
        "--set=friction.coefficient=1.5",
        "--parameter=slider.velocity=0.05:0.25:0.1",
        "--resolution=0.1",
    ],
    merge: &["study", "merge", "out"],
};

const PERTURBATION: Shared = Shared {
    program: AMONTONS,
    arguments: &[
        "study",
        "perturbation",
        "set2",
        "--direction=module[1].v2",
        "--amplitude=0.05:0.25/3",
        "--resolution=0.1",
        "--pictures=png",
    ],
    merge: &["study", "merge", "out"],
};

const LOUDNESS: Shared = Shared {
    program: AMONTONS,
    arguments: &["study", "loudness", "set2", "--set=friction.coefficient=1.96"],
    merge: &["study", "merge", "out"],
};

const REPORT: Shared = Shared {
    program: AMONTONS,
    arguments: &[
        "study",
        "report",
        "disc_brake",
        "--points=64",
        "--pushes=uniform(0,0.1)",
        "--runs=4",
    ],
    merge: &["study", "merge", "out"],
};

const BASIN: Shared = Shared {
    program: AMONTONS,
    arguments: &[
        "study",
        "basin",
        "set2",
        "--step=2e-5",
        "--x=module[1].v2=-0.3:0.3/11",
        "--y=module[2].v2=-0.3:0.3/12",
        "--islands=4",
    ],
    merge: &["study", "merge", "out"],
};

const DESIGN: Shared = Shared {
    program: AMONTONS,
    arguments: &[
        "study",
        "design",
        "set1",
        "--vary=module[*].k6=±5%",
        "--friction=0:1.3",
        "--starts=3",
        "--points=2",
        "--runs=4",
    ],
    merge: &["study", "merge", "out"],
};

/// Friction of 3.9 jams: it is left out.
const SWEEP: Shared = Shared {
    program: AMONTONS,
    arguments: &[
        "simulate",
        "set1",
        "--set=slider.angle=-0.5",
        "--stop-time=0.02",
        "--sweep=friction.coefficient=0.3:3.9/9",
    ],
    merge: &["study", "merge", "out"],
};

const MAP: Shared = Shared {
    program: STABILITY,
    arguments: &[
        "map",
        "set2",
        "--x=friction.coefficient=0.2:2/5",
        "--y=slider.angle=-0.2:0.2/9",
        "--plot=map.svg",
    ],
    merge: &["merge", "out"],
};

const TRACED_MAP: Shared = Shared {
    arguments: &[
        "map",
        "set2",
        "--x=friction.coefficient=0.2:2/41",
        "--y=slider.angle=-0.2:0.2/30",
        "--islands=4",
        "--plot=map.svg",
    ],
    ..MAP
};

type Files = BTreeMap<String, Vec<u8>>;

impl Shared {
    fn run(&self, folder: &Path, more: &[&str]) -> Output {
        run(self.program, folder, &[self.arguments, more].concat())
    }

    fn shard(&self, folder: &Path, shard: &str) -> String {
        let output = self.run(folder, &["-o", "out", "--shard", shard]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stdout)
    }

    fn merge(&self, folder: &Path) -> Output {
        run(self.program, folder, self.merge)
    }

    /// Runs all shards of all rounds, and merges: the files, and the number of rounds.
    fn by_workers(&self, folder: &Path, workers: usize) -> (Files, usize) {
        for round in 1..50 {
            for number in 1..=workers {
                self.shard(folder, &format!("{number}/{workers}"));
            }
            let merged = self.merge(folder);
            if merged.status.success() {
                return (files_of(&folder.join("out")), round);
            }
            assert_eq!(merged.status.code(), Some(5), "{}", text(&merged.stderr));
            let told = text(&merged.stdout);
            assert!(
                told.contains("this round is complete") && told.contains("next round"),
                "{told}"
            );
        }
        panic!("there is always a next round");
    }

    /// The files that one machine writes.
    fn by_one(&self, folder: &Path) -> Files {
        let output = |more: &[&str]| {
            let output = self.run(folder, more);
            assert!(output.status.success(), "{}", text(&output.stderr));
            output.stdout
        };
        match self.arguments[0] {
            "study" => {
                output(&["-o", "out"]);
                files_of(&folder.join("out"))
            }
            "simulate" => {
                output(&["-o", "results.csv"]);
                files_of(folder)
            }
            _ => {
                let points = output(&["--csv"]);
                let drawn = fs::read(folder.join("map.svg")).unwrap();
                [("results.csv".to_owned(), points), ("map.svg".to_owned(), drawn)].into()
            }
        }
    }

    /// Checks that 1, 2 and 7 workers write the files of one machine: one worker in one round, several in the given number of
    /// rounds.
    fn assert_shared(&self, files: &[&str], rounds: RangeInclusive<usize>) {
        let [one, all @ ..] = [0; 4].map(|_| folder());
        let whole = self.by_one(one.path());
        assert_eq!(whole.keys().collect::<Vec<_>>(), files);
        for (workers, folder) in [1, 2, 7].into_iter().zip(all) {
            let (found, taken) = self.by_workers(folder.path(), workers);
            assert_same(&found, &whole);
            let expected = if workers == 1 { 1..=1 } else { rounds.clone() };
            assert!(expected.contains(&taken), "{workers} workers: {taken} rounds");
            // Merging once more changes nothing.
            assert!(self.merge(folder.path()).status.success());
            assert_same(&files_of(&folder.path().join("out")), &whole);
        }
    }
}

/// The files of a folder but for journals.
fn files_of(folder: &Path) -> Files {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let is_result =
        |path: &std::path::PathBuf| path.is_file() && path.extension().unwrap() != "jsonl";
    let name = |path: &Path| path.file_name().unwrap().to_str().unwrap().to_owned();
    entries.filter(is_result).map(|path| (name(&path), fs::read(&path).unwrap())).collect()
}

fn assert_same(found: &Files, whole: &Files) {
    assert_eq!(found.keys().collect::<Vec<_>>(), whole.keys().collect::<Vec<_>>());
    for (name, bytes) in found {
        assert!(*bytes == whole[name], "{name}: {}", String::from_utf8_lossy(bytes));
    }
}

fn lines(path: &Path) -> Vec<String> {
    fs::read_to_string(path).unwrap().lines().map(str::to_owned).collect()
}

#[test]
fn workers_that_share_a_limit_cycle_study_have_the_bytes_of_one_machine() {
    let values = ["0.05", "0.15", "0.25"];
    let of = |value| ["normal", "tangential"].map(|side| format!("portrait-{value}-{side}.svg"));
    let portraits = values.map(of).concat();
    let first = ["limit-cycle.svg"].into_iter();
    let files = first.chain(portraits.iter().map(String::as_str));
    let files: Vec<&str> = files.chain(["results.csv", "study.json"]).collect();
    // Values, thresholds, portraits: who begins a bisection ends it.
    LIMIT_CYCLE.assert_shared(&files, 3..=3);
}

#[test]
fn workers_that_share_a_perturbation_study_have_the_bytes_of_one_machine() {
    let files = ["histories.png", "perturbation.png", "results.csv", "study.json"];
    PERTURBATION.assert_shared(&files, 2..=9);
}

#[test]
fn workers_that_share_the_loudness_of_candidates_have_the_bytes_of_one_machine() {
    LOUDNESS.assert_shared(&["loudness.svg", "results.csv", "study.json"], 1..=1);
}

#[test]
fn workers_that_share_a_design_have_the_bytes_of_one_machine() {
    let files =
        ["growth.csv", "growth.svg", "results.csv", "study.json", "trade-off.csv", "trade-off.svg"];
    // Starts, then the trade-off and the runs.
    DESIGN.assert_shared(&files, 2..=2);
}

#[test]
fn workers_that_share_a_report_have_the_bytes_of_one_machine() {
    REPORT.assert_shared(&["report.html", "results.csv", "study.json"], 1..=1);
}

#[test]
fn workers_that_share_a_basin_have_the_bytes_of_one_machine() {
    BASIN.assert_shared(&["basin.svg", "results.csv", "study.json"], 3..=6);
}

#[test]
fn workers_that_share_a_sweep_have_the_bytes_of_one_machine() {
    SWEEP.assert_shared(&["results.csv"], 1..=1);
}

#[test]
fn workers_that_share_a_map_have_the_bytes_of_one_machine() {
    MAP.assert_shared(&["map.svg", "results.csv"], 1..=1);
}

#[test]
fn workers_that_share_a_traced_map_have_the_bytes_of_one_machine() {
    TRACED_MAP.assert_shared(&["map.svg", "results.csv"], 2..=6);
}

#[test]
fn killed_workers_are_told_as_missing_and_go_on_from_what_they_have() {
    let (one, all) = (folder(), folder());
    let whole = BASIN.by_one(one.path());
    // The first round has the 36 points in five pieces.
    assert!(
        BASIN
            .shard(all.path(), "1/2")
            .contains("done, 3 of 5 pieces are in out/shards/1-of-2.jsonl")
    );
    let journal = all.path().join("out/shards/1-of-2.jsonl");
    let before = lines(&journal);
    assert_eq!(before.len(), 1 + 3);
    let bytes = fs::read(&journal).unwrap();
    fs::write(&journal, &bytes[..bytes.len() - 40]).unwrap();
    let merged = BASIN.merge(all.path());
    assert_eq!(merged.status.code(), Some(5), "{}", text(&merged.stderr));
    let told = text(&merged.stdout);
    assert!(told.contains("3 of 5 pieces of this round are missing"), "{told}");
    assert!(told.contains("run these shards of 2 again: 1-2"), "{told}");
    // Only the piece that was cut off is computed again.
    BASIN.shard(all.path(), "1/2");
    assert_eq!(lines(&journal)[..3], before[..3]);
    assert_eq!(lines(&journal).len(), before.len());
    let told = text(&BASIN.merge(all.path()).stdout);
    assert!(told.contains("2 of 5 pieces") && told.contains("again: 2;"), "{told}");
    // Others go on in their place, and compute only what is missing.
    let (found, _) = BASIN.by_workers(all.path(), 7);
    let others = lines(&all.path().join("out/shards/1-of-7.jsonl"));
    assert!(others.iter().all(|line| !before[1..].contains(line)));
    assert_same(&found, &whole);
}

#[test]
fn a_worker_that_is_killed_at_work_and_one_that_is_interrupted_are_started_again() {
    let (one, all) = (folder(), folder());
    let study = Shared {
        arguments: &[
            "study",
            "limit-cycle",
            "set1",
            "--set=friction.coefficient=1.5",
            "--parameter=slider.velocity=0.01:0.25:0.01",
            "--resolution=0.5",
            "--portrait=0.1",
        ],
        ..LIMIT_CYCLE
    };
    let whole = study.by_one(one.path());
    for (shard, file, signal) in [("1/2", "1-of-2.jsonl", "-KILL"), ("2/2", "2-of-2.jsonl", "-INT")]
    {
        let mut command = Command::new(AMONTONS);
        command.current_dir(all.path()).args(study.arguments).args(["-o", "out", "--shard", shard]);
        let child = command.stderr(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        let journal = all.path().join("out/shards").join(file);
        let count = || fs::read_to_string(&journal).map_or(0, |text| text.lines().count());
        let begin = Instant::now();
        while count() < 3 && begin.elapsed() < Duration::from_secs(60) {
            std::thread::sleep(Duration::from_millis(2));
        }
        // Merging is possible while a worker runs.
        assert_eq!(study.merge(all.path()).status.code(), Some(5));
        let id = child.id().to_string();
        assert!(Command::new("kill").args([signal, &id]).status().unwrap().success());
        let output = child.wait_with_output().unwrap();
        assert!(!output.status.success(), "it was done");
        if signal == "-INT" {
            let words = ["finished piece", "kept in out/shards/2-of-2.jsonl", "same command"];
            assert_refused(&output, 130, &words);
        }
    }
    let (found, _) = study.by_workers(all.path(), 2);
    assert_same(&found, &whole);
}

#[test]
fn the_same_command_without_a_shard_does_the_rest() {
    let (one, all) = (folder(), folder());
    let whole = PERTURBATION.by_one(one.path());
    PERTURBATION.shard(all.path(), "2/3");
    let theirs = lines(&all.path().join("out/shards/2-of-3.jsonl"));
    let output = PERTURBATION.run(all.path(), &["-o", "out"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_same(&files_of(&all.path().join("out")), &whole);
    let journal = lines(&all.path().join("out/journal.jsonl"));
    assert_eq!(journal[1..theirs.len()], theirs[1..]);
    // Beginning anew discards the pieces of the workers too.
    let output = PERTURBATION.run(all.path(), &["-o", "out", "--anew"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(!all.path().join("out/shards/2-of-3.jsonl").exists());
}

#[test]
fn a_worker_alone_does_the_rest_of_all_rounds() {
    for study in [&LIMIT_CYCLE, &SWEEP] {
        let (one, all) = (folder(), folder());
        let whole = study.by_one(one.path());
        study.shard(all.path(), "2/3");
        study.shard(all.path(), "1/1");
        let [theirs, rest] = ["2-of-3.jsonl", "1-of-1.jsonl"]
            .map(|name| lines(&all.path().join("out/shards").join(name)));
        assert!(theirs.len() > 1 && theirs[1..].iter().all(|line| !rest.contains(line)));
        assert_eq!(study.merge(all.path()).status.code(), Some(0));
        assert_same(&files_of(&all.path().join("out")), &whole);
    }
}

#[test]
fn pieces_of_another_study_command_or_program_are_not_mixed_in() {
    let here = folder();
    let path = here.path();
    let scene = run(AMONTONS, path, &["scenes", "show", "set1"]).stdout;
    fs::write(path.join("own.toml"), &scene).unwrap();
    let study = Shared {
        arguments: &[
            "simulate",
            "own.toml",
            "--stop-time=0.01",
            "--sweep=slider.velocity=0.1:0.3/3",
        ],
        ..SWEEP
    };
    study.shard(path, "1/2");
    // Another command, and another value.
    let observed = Shared {
        arguments: &[
            "simulate",
            "own.toml",
            "--stop-time=0.01",
            "--sweep=slider.velocity=0.1:0.3/3",
            "--of=module[1].x1",
        ],
        ..SWEEP
    };
    let other = |study: &Shared| study.run(path, &["-o", "out", "--shard", "2/2"]);
    assert_refused(
        &other(&observed),
        1,
        &["another study", "settings.of is not given", "module[1].x1"],
    );
    let other_range = Shared {
        arguments: &[
            "simulate",
            "own.toml",
            "--stop-time=0.01",
            "--sweep=slider.velocity=0.1:0.4/4",
        ],
        ..SWEEP
    };
    let words =
        ["1-of-2.jsonl belongs to another command", "0.1:0.3/3", "0.1:0.4/4", "remove out/shards"];
    assert_refused(&other(&other_range), 1, &words);
    // A scene that has changed since, one that is not there, another program.
    fs::write(path.join("own.toml"), [&scene[..], b"\n# changed\n"].concat()).unwrap();
    let words = ["1-of-2.jsonl", "file differs", "same scene file", "amontons simulate own.toml"];
    assert_refused(&study.merge(path), 1, &words);
    fs::remove_file(path.join("own.toml")).unwrap();
    let words = ["own.toml", "the folder in which they were started"];
    assert_refused(&study.merge(path), 1, &words);
    let program = Shared { program: STABILITY, merge: MAP.merge, ..SWEEP };
    assert_refused(&program.merge(path), 2, &["use `amontons study merge out`"]);
    // Two machines that do not agree.
    fs::write(path.join("own.toml"), &scene).unwrap();
    let [journal, copy] =
        ["1-of-2.jsonl", "1-of-3.jsonl"].map(|name| path.join("out/shards").join(name));
    let text = fs::read_to_string(&journal).unwrap();
    fs::write(&copy, text.replacen("\"amplitudes\":[", "\"amplitudes\":[7.0,", 1)).unwrap();
    let words =
        ["1-of-2.jsonl and ", "1-of-3.jsonl have different results for slider.velocity = 0."];
    assert_refused(&study.merge(path), 1, &words);
}

#[test]
fn the_example_runs_rounds_until_the_results_are_written() {
    let (one, all) = (folder(), folder());
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/shards");
    let study = fs::read_to_string(example.join("study.sh")).unwrap();
    let small = study.replace("workers=64", "workers=3").replace("1.2/121", "1.2/5");
    let small = small.replace("8e-3/113", "8e-3/6");
    let programs = Path::new(AMONTONS).parent().unwrap().display();
    let path = format!("export PATH=\"{programs}:$PATH\"\n{small}");
    let bash = |folder: &Path, arguments: &[&str]| {
        let output = run("bash", folder, arguments);
        assert!(output.status.success(), "{}", text(&output.stderr));
    };
    for folder in [&one, &all] {
        fs::write(folder.path().join("study.sh"), &path).unwrap();
    }
    bash(one.path(), &["-c", ". ./study.sh; study"]);
    bash(all.path(), &[example.join("rounds.sh").to_str().unwrap(), "xargs"]);
    let [one, all] = [one, all].map(|folder| files_of(&folder.path().join("plane")));
    assert_same(&all, &one);
}

#[test]
fn shards_that_make_no_sense_are_refused_with_what_would() {
    let here = folder();
    let refused = |study: &Shared, more: &[&str], code, words: &[&str]| {
        assert_refused(&study.run(here.path(), more), code, words);
    };
    for shard in ["0/3", "4/3", "x", "1", "-1/3", "1/0", "1.5/3"] {
        let given = format!("--shard={shard}");
        refused(&BASIN, &["-o", "out", &given], 2, &["from 1/N to N/N, such as 3/64"]);
    }
    for study in [&LIMIT_CYCLE, &SWEEP, &MAP] {
        refused(study, &["--shard=1/3"], 2, &["--shard needs -o DIR", "all workers share"]);
    }
    for study in [&SWEEP, &MAP] {
        let words = ["-o names the folder", "results.csv", "sweep.csv is the name of a file"];
        refused(study, &["--shard=1/3", "-o", "sweep.csv"], 2, &words);
    }
    refused(&MAP, &["-o", "out"], 2, &["needs --shard I/N", "--csv"]);
    refused(&BASIN, &["-o", "out", "--shard=1/3", "--anew"], 2, &["--anew would discard", "out"]);
    let run_alone = Shared { arguments: &["simulate", "set1"], ..SWEEP };
    refused(&run_alone, &["-o", "out", "--shard=1/3"], 2, &["--shard needs --sweep"]);
    assert_refused(
        &BASIN.merge(here.path()),
        1,
        &["no pieces of workers in out/shards", "--shard I/N"],
    );
    assert!(!here.path().join("out").exists());
    fs::write(here.path().join("out"), "").unwrap();
    refused(&BASIN, &["-o", "out", "--shard=1/3"], 1, &["out"]);
}
