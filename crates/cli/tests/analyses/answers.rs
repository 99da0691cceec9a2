//! Every analysis with every kind of scene. Each answer is compared with a computation of the tests' own, or it is
//! refused with a reason, or it says what it leaves out. `docs/answers.md` is the table; a cell that becomes another one
//! fails here, and `AMONTONS_WRITE=1 cargo test --release --test analyses answers:: -- --ignored` writes it anew.

mod cases;
mod oracle;

use crate::parallel::on_each;
use crate::program::{folder, run, text};
use amontons::scene::{Scene, read};
use amontons_analysis::assign::assign;
use cases::{Case, cases, of_laws};
use oracle::{Motion, Oracle, State};
use serde_json::Value;
use std::fmt::Write as _;
use std::path::Path;
use std::time::Instant;

/// An analysis answers in one of these ways.
#[derive(Debug)]
enum Answer {
    /// The oracle says the same.
    Right,
    /// The oracle says the same of what is answered, and the program says what is not.
    Limited(String),
    /// The program says why it does not answer.
    Refused(String),
}

/// An analysis of a scene in a folder. An error is the reason why the program refuses it.
type Analysis = fn(&Case, &Path) -> Result<Answer, String>;

const ANALYSES: [(&str, Analysis); 12] = [
    ("run", simulated),
    ("sweep", swept),
    ("states", states),
    ("locus over µ", locus_over_friction),
    ("locus over v", locus_over_velocity),
    ("bistable", bistable),
    ("map", mapped),
    ("limit cycle", limit_cycle),
    ("transient", transient),
    ("perturbation", perturbation),
    ("continuation", continuation),
    ("basin", basin),
];

/// The end of the page, written by hand: commands and scenes that the table does not have.
const MORE: &str = include_str!("answers/more.md");

const MOTIONS: &str = env!("CARGO_BIN_EXE_amontons");
const EIGENVALUES: &str = env!("CARGO_BIN_EXE_amontons-stability");

impl Case {
    fn scene(&self, folder: &Path) -> Scene {
        read(&folder.join("scene.toml")).unwrap().0
    }

    /// The oracle of this scene with other values.
    fn oracle(&self, folder: &Path, values: &[(&str, f64)]) -> Oracle {
        let mut scene = self.scene(folder);
        for (name, value) in values {
            assign(&mut scene, name, *value).unwrap();
        }
        Oracle::of(&scene)
    }

    fn range(&self) -> String {
        format!("{:?}:{:?}/2", self.friction[0], self.friction[1])
    }

    /// Compares what a motion ends in.
    fn compare(&self, what: &str, kind: &str, amplitude: f64, oracle: &Oracle) {
        self.compare_end(what, kind, amplitude, oracle.end(self.time, self.step));
    }

    fn compare_end(&self, what: &str, kind: &str, amplitude: f64, end: oracle::End) {
        let what = format!("{}, {what}: {kind} {amplitude:?}, the oracle has {end:?}", self.name);
        match kind {
            "equilibrium" => assert!(end.rests, "{what}"),
            "unbounded" => assert!(!end.rests && end.amplitude > 1.0, "{what}"),
            // The amplitude of a motion that neither grows nor decays is arbitrary.
            _ if end.is_neutral => {}
            "periodic" | "quasi-periodic" | "irregular" | "undecided" => {
                // Over a window the extent of a motion without a period varies.
                let near = if kind == "periodic" { self.near } else { self.near.max(0.3) };
                assert!((amplitude / end.amplitude - 1.0).abs() <= near, "{what}");
                assert!(!end.rests, "{what}");
            }
            _ => panic!("{what}"),
        }
    }
}

/// Runs a program on the scene: its standard output and error, or the reason why it refuses.
fn ask(program: &str, folder: &Path, arguments: &[&str]) -> Result<(String, String), String> {
    let output = run(program, folder, arguments);
    let (out, err) = (text(&output.stdout), text(&output.stderr));
    match output.status.code() {
        Some(0) => Ok((out, err)),
        Some(2..=4) => {
            let reason = err.lines().find_map(|line| line.strip_prefix("error: "));
            Err(reason.unwrap_or_else(|| panic!("{err}")).to_owned())
        }
        code => panic!("{arguments:?}: {code:?} {err}"),
    }
}

/// Finds the line in which the program says what it leaves out.
fn limits(said: &str) -> Answer {
    let has = |line: &str, words: &[&str]| words.iter().any(|words| line.contains(words));
    // A list of values that have not settled has commas; rows of its table are looked at one by one.
    let is_limit = |line: &&str| {
        has(line, &["left out", "ignored", "unknown"])
            || has(line, &["not settled", "only uniform sliding"]) && !line.contains(',')
    };
    match said.lines().find(is_limit) {
        Some(line) => Answer::Limited(line.trim().to_owned()),
        None => Answer::Right,
    }
}

fn csv(text: &str) -> Vec<Vec<String>> {
    text.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

/// A number of a table, or none where the table has none.
fn number(text: &str) -> f64 {
    if text.is_empty() {
        return f64::NAN;
    }
    text.parse().unwrap_or_else(|_| panic!("{text} is no number"))
}

/// The eigenvalues with a frequency, 1/s, that are not in both; those of the oracle with a frequency above `1e-6` of the
/// largest.
fn assert_same_modes(what: &str, found: &[[f64; 2]], oracle: &Oracle, states: &[State]) {
    let all = oracle.eigenvalues(states);
    let largest = all.iter().map(|value| value.norm()).fold(0.0, f64::max);
    let expected: Vec<[f64; 2]> = all
        .iter()
        .filter(|value| value.im > 1e-5 * largest)
        .map(|value| [value.re, value.im])
        .collect();
    let far = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
    assert_eq!(found.len(), expected.len(), "{what}: {found:?} {expected:?}");
    // Eigenvalues that merge are known to the root of rounding.
    let mut left = expected.clone();
    for value in found {
        let nearest =
            (0..left.len()).min_by(|i, j| far(&left[*i], value).total_cmp(&far(&left[*j], value)));
        let nearest = left.swap_remove(nearest.unwrap());
        assert!(far(&nearest, value) <= 2e-6 * largest, "{what}: {value:?} {expected:?}");
    }
}

fn simulated(case: &Case, folder: &Path) -> Result<Answer, String> {
    // Long enough for contacts to change their states, short enough for neighbours to stay neighbours.
    let scene = case.scene(folder);
    let interval = 20.0 * scene.experiment.output_interval;
    let push = format!("{}={:?}", case.initial[0], case.push);
    let (stop, every) = (format!("{:?}", 20.0 * interval), format!("{interval:?}"));
    let arguments = [
        "simulate",
        "scene.toml",
        "--set",
        &push,
        "--stop-time",
        &stop,
        "--output-interval",
        &every,
    ];
    let (out, err) = ask(MOTIONS, folder, &arguments)?;
    let table = csv(&out);
    let names = scene.dof_names();
    let columns: Vec<usize> = names
        .iter()
        .map(|name| table[0].iter().position(|column| column == name).unwrap())
        .collect();
    let oracle = case.oracle(folder, &[(case.initial[0], case.push)]);
    let steps = (interval / case.step).round() as usize;
    let [coarse, fine] = [1, 2].map(|part| oracle.rows(20, interval, part * steps));
    let size = fine.iter().map(|row| row.amax()).fold(0.0, f64::max);
    for (i, (coarse, fine)) in coarse.iter().zip(&fine).enumerate() {
        let found = columns.iter().map(|column| number(&table[i + 2][*column]));
        let off = found.zip(fine.iter()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let own = (coarse - fine).amax();
        assert!(
            own <= 0.1 * size,
            "{}: the oracle is too coarse at row {i}, {own} {size}",
            case.name
        );
        // The program's scheme is of first order in its step, too.
        assert!(off <= 5.0 * own + 5e-3 * size, "{}: row {i}, {off} {own} {size}", case.name);
    }
    Ok(limits(&err))
}

fn swept(case: &Case, folder: &Path) -> Result<Answer, String> {
    let range = format!("friction.coefficient={}", case.range());
    let (out, err) = ask(MOTIONS, folder, &["simulate", "scene.toml", "--sweep", &range])?;
    let table = csv(&out);
    let settled = column(&table, "settled");
    for row in &table[1..] {
        let mu = number(&row[0]);
        let end = case.oracle(folder, &[("friction.coefficient", mu)]).end(case.time, case.step);
        let amplitude = number(&row[1]);
        // A motion that grows without bound is the larger the later it is observed.
        if end.amplitude > 1.0 {
            assert!(row[settled] == "no" && amplitude > 1.0, "{}: {row:?} {end:?}", case.name);
        } else if !end.rests {
            case.compare_end(&format!("sweep at {mu}"), "periodic", amplitude, end);
        }
    }
    Ok(match table[1..].iter().find(|row| row[settled] != "yes") {
        Some(row) => Answer::Limited(format!("the column `settled` says `{}`", row[settled])),
        None => limits(&err),
    })
}

fn states(case: &Case, folder: &Path) -> Result<Answer, String> {
    let oracle = case.oracle(folder, &[]);
    let compare = |arguments: &[&str]| -> Result<Answer, String> {
        let (out, err) = ask(EIGENVALUES, folder, arguments)?;
        let found: Value = serde_json::from_str(&out).unwrap();
        let found = found["states"].as_object().unwrap();
        assert!(!found.is_empty());
        for (name, state) in found {
            // R-Sl has a hyphen of its own.
            let names: Vec<String> =
                name.replace("R-Sl", "R_Sl").split('-').map(|s| s.replace('_', "-")).collect();
            let states: Vec<State> = names.iter().map(|name| State::named(name)).collect();
            let modes = state["eigenvalues_hz"].as_array().unwrap().iter();
            let modes: Vec<[f64; 2]> = modes
                .map(|pair| [0, 1].map(|i| pair[i].as_f64().unwrap() * std::f64::consts::TAU))
                .collect();
            if !oracle.is_a_state(&states) {
                continue;
            }
            assert_same_modes(&format!("{}, {name}", case.name), &modes, &oracle, &states);
        }
        Ok(limits(&err))
    };
    match compare(&["states", "scene.toml", "--format", "json"]) {
        Err(reason) if reason.contains("--state") => {
            compare(&["states", "scene.toml", "--format", "json", "--state", "Sl"])?;
            Ok(Answer::Limited(reason))
        }
        answer => answer,
    }
}

fn locus(case: &Case, folder: &Path, name: &str, arguments: &[&str]) -> Result<Answer, String> {
    let (out, err) = ask(EIGENVALUES, folder, arguments)?;
    let table = csv(&out);
    let mut values: Vec<f64> = table[1..].iter().map(|row| number(&row[0])).collect();
    values.dedup();
    assert!(values.len() >= 2, "{out}");
    for value in values {
        let of_value = table[1..].iter().filter(|row| number(&row[0]) == value);
        let modes: Vec<[f64; 2]> = of_value
            .map(|row| [number(&row[2]), number(&row[4]) * std::f64::consts::TAU])
            .filter(|mode| mode[1] > 0.0)
            .collect();
        let oracle = case.oracle(folder, &[(name, value)]);
        let what = format!("{}, locus at {value}", case.name);
        assert_same_modes(&what, &modes, &oracle, &oracle.sliding());
    }
    Ok(limits(&err))
}

fn locus_over_friction(case: &Case, folder: &Path) -> Result<Answer, String> {
    let range = case.range();
    let arguments = ["locus", "scene.toml", "--friction", &range, "--csv"];
    locus(case, folder, "friction.coefficient", &arguments)
}

fn locus_over_velocity(case: &Case, folder: &Path) -> Result<Answer, String> {
    let arguments = ["locus", "scene.toml", "--parameter", "slider.velocity=0.05:0.4/3", "--csv"];
    locus(case, folder, "slider.velocity", &arguments)
}

fn bistable(case: &Case, folder: &Path) -> Result<Answer, String> {
    let range = format!("{:?}:{:?}", case.friction[0], case.friction[1]);
    let (out, err) = ask(EIGENVALUES, folder, &["bistable", "scene.toml", "--friction", &range])?;
    // From where to where uniform sliding is said to be stable.
    let mut stable = Vec::new();
    for line in out.lines().filter(|line| line.trim_start().starts_with("is stable")) {
        let numbers: Vec<f64> =
            line.split([' ', ',']).filter_map(|word| word.parse().ok()).collect();
        match numbers[..] {
            [] => stable.push(case.friction),
            _ => stable.extend(numbers.chunks(2).map(|two| [two[0], two[1]])),
        }
    }
    for i in 0..=200 {
        let mu = case.friction[0] + (case.friction[1] - case.friction[0]) * f64::from(i) / 200.0;
        let oracle = case.oracle(folder, &[("friction.coefficient", mu)]);
        let states = oracle.sliding();
        let Some(growth) = oracle.clear_growth(&states) else { continue };
        let is_stable = stable.iter().any(|[from, to]| (*from..=*to).contains(&mu));
        assert_eq!(is_stable, growth < 0.0, "{}, µ = {mu}: {growth}\n{out}", case.name);
    }
    Ok(limits(&err))
}

fn mapped(case: &Case, folder: &Path) -> Result<Answer, String> {
    let (name, [low, high]) = case.other;
    let x = format!("friction.coefficient={}", case.range());
    let y = format!("{name}={low:?}:{high:?}/2");
    let arguments = ["map", "scene.toml", "--x", &x, "--y", &y, "--csv", "--plot", "map.svg"];
    let (out, err) = ask(EIGENVALUES, folder, &arguments)?;
    let table = csv(&out);
    assert_eq!(table.len(), 5);
    for row in &table[1..] {
        let oracle = case
            .oracle(folder, &[("friction.coefficient", number(&row[0])), (name, number(&row[1]))]);
        if row[2].contains("no equilibrium") {
            return Ok(Answer::Limited(row[2].clone()));
        }
        if let Some(growth) = oracle.clear_growth(&oracle.sliding()) {
            assert_eq!(row[2] == "unstable", growth > 0.0, "{}: {row:?} {growth}", case.name);
        }
    }
    Ok(limits(&err))
}

/// A study of a scene: its folder's results.csv by columns.
fn study(folder: &Path, arguments: &[&str]) -> Result<(Vec<Vec<String>>, String), String> {
    let mut all = vec!["study"];
    all.extend(arguments);
    all.extend(["-o", "results", "--anew"]);
    let (out, err) = ask(MOTIONS, folder, &all)?;
    let table = csv(&std::fs::read_to_string(folder.join("results/results.csv")).unwrap());
    Ok((table, out + &err))
}

/// The place of a column by its name.
fn column(table: &[Vec<String>], name: &str) -> usize {
    table[0].iter().position(|column| column == name).unwrap()
}

fn is_open(kind: &str) -> bool {
    kind == "unsettled"
}

/// A study that answers leaves out motions that have not settled, and what it says itself.
fn limits_of_motions(table: &[Vec<String>], said: &str) -> Answer {
    let kind = column(table, "kind");
    if table[1..].iter().any(|row| is_open(&row[kind])) {
        return Answer::Limited("not settled, as the table says".to_owned());
    }
    limits(said)
}

fn limit_cycle(case: &Case, folder: &Path) -> Result<Answer, String> {
    let range = format!("friction.coefficient={}", case.range());
    let (table, said) = study(folder, &["limit-cycle", "scene.toml", "--parameter", &range])?;
    let [kind, amplitude] = ["kind", "amplitude"].map(|name| column(&table, name));
    for row in table[1..].iter().filter(|row| !is_open(&row[kind])) {
        let oracle = case.oracle(folder, &[("friction.coefficient", number(&row[0]))]);
        let what = format!("limit cycle at {}", row[0]);
        case.compare(&what, &row[kind], number(&row[amplitude]), &oracle);
    }
    Ok(limits_of_motions(&table, &said))
}

fn transient(case: &Case, folder: &Path) -> Result<Answer, String> {
    let (_, said) = study(folder, &["transient", "scene.toml"])?;
    let study: Value =
        serde_json::from_str(&std::fs::read_to_string(folder.join("results/study.json")).unwrap())
            .unwrap();
    let oracle = case.oracle(folder, &[]);
    let all = oracle.eigenvalues(&oracle.sliding());
    let findings = study["results"]["findings"].as_array().unwrap();
    // If contacts change their states, a growth is that of a cycle, which eigenvalues do not describe.
    let is_linear = |finding: &&Value| {
        finding["taken"].as_array().is_some_and(|taken| taken.len() == 1)
            && finding["band"].is_null()
    };
    for finding in findings.iter().filter(is_linear) {
        let [rate, frequency, error] =
            ["rate", "frequency", "rate_error"].map(|name| finding[name].as_f64().unwrap());
        let far = |value: &nalgebra::Complex<f64>| {
            (value.re - rate).hypot(value.im - frequency * std::f64::consts::TAU)
        };
        let nearest = all.iter().map(far).fold(f64::INFINITY, f64::min);
        let tolerance = 1e-4 * frequency + 10.0 * error;
        assert!(nearest <= tolerance, "{}: {finding} {nearest}\n{all:?}", case.name);
    }
    Ok(limits(&said))
}

fn perturbation(case: &Case, folder: &Path) -> Result<Answer, String> {
    let sizes = format!("{:?}:{:?}/2", 0.1 * case.push, case.push);
    let arguments =
        ["perturbation", "scene.toml", "--direction", case.initial[0], "--amplitude", &sizes];
    let (table, said) = study(folder, &arguments)?;
    let [kind, amplitude] = ["kind", "final_amplitude"].map(|name| column(&table, name));
    for row in table[1..].iter().filter(|row| !is_open(&row[kind])) {
        let oracle = case.oracle(folder, &[(case.initial[0], number(&row[0]))]);
        case.compare(&format!("push of {}", row[0]), &row[kind], number(&row[amplitude]), &oracle);
    }
    Ok(limits_of_motions(&table, &said))
}

fn continuation(case: &Case, folder: &Path) -> Result<Answer, String> {
    let range = case.range();
    let arguments = ["continuation", "scene.toml", "--friction", &range, "--resolution", "0.01"];
    let (table, said) = study(folder, &arguments)?;
    let [kind, amplitude] = ["kind", "amplitude"].map(|name| column(&table, name));
    let row = |way: &str, mu: f64| {
        table[1..].iter().find(|row| row[0] == way && number(&row[1]) == mu).unwrap()
    };
    let [low, high] = case.friction;
    let compare = |what: &str, row: &[String], end: oracle::End| {
        if !is_open(&row[kind]) {
            case.compare_end(what, &row[kind], number(&row[amplitude]), end);
        }
    };
    let at = |mu: f64| case.oracle(folder, &[("friction.coefficient", mu)]);
    // Upwards from rest with a small push.
    let mut rising = at(low);
    rising.start.iter_mut().for_each(|start| start.fill(0.0));
    rising.start[1][0] = 1e-3 * case.push;
    compare("rising, first", row("rising", low), rising.end(case.time, case.step));
    let mut falling = Motion::of(&at(high), case.step);
    let first = falling.end(case.time);
    compare("falling, first", row("falling", high), first);
    // A motion that has grown without bound has no state from which to continue.
    if first.amplitude > 1.0 {
        let mut again = at(low);
        again.start.iter_mut().for_each(|start| start.fill(0.0));
        again.start[1][0] = 1e-3 * case.push;
        falling = Motion::of(&again, case.step);
    }
    // Downwards slowly, as a motion that stays may go.
    for i in (1..=20).filter(|_| first.amplitude <= 1.0) {
        falling.with_friction(high + (low - high) * f64::from(i) / 20.0);
        falling.end(0.02 * case.time);
    }
    let last = row("falling", low);
    let mut end = falling.end(case.time);
    if !is_open(&last[kind]) && (last[kind] == "equilibrium") != end.rests {
        // Both ways end in the same motion: in its place stands the one that rest gives way to, followed downwards.
        let value = |part: i32| low + (high - low) * f64::from(part) / 100.0;
        let grows = |part: &i32| {
            let there = at(value(*part));
            there.growth(&there.sliding()) > 0.0
        };
        if let Some(first) = (1..100).find(grows) {
            let mut rest = at(value(first));
            rest.start.iter_mut().for_each(|start| start.fill(0.0));
            rest.start[1][0] = 1e-3 * case.push;
            let mut motion = Motion::of(&rest, case.step);
            motion.end(2.0 * case.time);
            for part in (0..first).rev() {
                motion.with_friction(value(part));
                motion.end(0.1 * case.time);
            }
            end = motion.end(case.time);
        }
    }
    compare("falling, last", last, end);
    Ok(limits_of_motions(&table, &said))
}

fn basin(case: &Case, folder: &Path) -> Result<Answer, String> {
    let [x, y] = case.initial.map(|name| format!("{name}=0:{:?}/2", case.push));
    let (table, said) = study(folder, &["basin", "scene.toml", "--x", &x, "--y", &y])?;
    let kind = column(&table, "kind");
    for row in table[1..].iter().filter(|row| !is_open(&row[kind])) {
        // Nothing moves without a push, whatever a small one would do.
        let start = [number(&row[0]), number(&row[1])];
        if start == [0.0; 2] {
            continue;
        }
        let values = [(case.initial[0], start[0]), (case.initial[1], start[1])];
        let end = case.oracle(folder, &values).end(case.time, case.step);
        assert_eq!(row[kind] == "equilibrium", end.rests, "{}: {row:?} {end:?}", case.name);
    }
    Ok(limits_of_motions(&table, &said))
}

/// The page of all answers: a row for each kind of scene, and below it what is refused or left out, in words.
fn page(answers: &[(&str, Vec<Answer>)]) -> String {
    let mut page = String::from(
        "# What each analysis answers\n\n\
         Every analysis is tried with every kind of scene. **right**: the answer is the same as that of a computation \
         which the tests have of their own (matrices from the elements, eigenvalues by another library, Moreau and Jean's \
         time stepping). **limited**: what is answered is right in this sense, and the program says what is not. \
         **refused**: the program says why it does not answer. The test `answers` holds this table and writes it.\n\n",
    );
    let names: Vec<&str> = ANALYSES.iter().map(|(name, _)| *name).collect();
    let _ = writeln!(
        page,
        "| scene | {} |\n| --- |{}",
        names.join(" | "),
        " --- |".repeat(names.len())
    );
    let mut reasons: Vec<String> = Vec::new();
    for (name, answers) in answers {
        let cells = answers.iter().map(|answer| {
            let (word, reason) = match answer {
                Answer::Right => return "right".to_owned(),
                Answer::Limited(reason) => ("limited", reason),
                Answer::Refused(reason) => ("refused", reason),
            };
            let reason = without_numbers(reason);
            let place = reasons.iter().position(|known| *known == reason).unwrap_or_else(|| {
                reasons.push(reason);
                reasons.len() - 1
            });
            format!("{word} ({})", place + 1)
        });
        let cells: Vec<String> = cells.collect();
        let _ = writeln!(page, "| {name} | {} |", cells.join(" | "));
    }
    page.push_str("\nWhat the program says, with … for numbers:\n\n");
    for (i, reason) in reasons.iter().enumerate() {
        let _ = writeln!(page, "{}. {reason}", i + 1);
    }
    page + MORE
}

/// A message without the numbers of one scene.
fn without_numbers(message: &str) -> String {
    let is_number = |word: &str| {
        let word = word.trim_matches(|c: char| "(),;:".contains(c));
        word.starts_with(|c: char| c.is_ascii_digit() || c == '-' || c == '+')
            && word.contains(|c: char| c.is_ascii_digit())
    };
    let words = message.split(' ').map(|word| if is_number(word) { "…" } else { word });
    words.collect::<Vec<_>>().join(" ")
}

#[test]
#[ignore = "long: each analysis of each kind of scene"]
fn each_analysis_of_each_kind_of_scene_is_right_or_refused_or_says_what_it_leaves_out() {
    let only = std::env::var("AMONTONS_CASE").unwrap_or_default();
    let cases: Vec<Case> = cases().into_iter().filter(|case| case.name.contains(&only)).collect();
    // The last analyses take longest. They go first, so that no processor is left alone with one at the end.
    let cells: Vec<(usize, (&str, Analysis))> = ANALYSES
        .into_iter()
        .rev()
        .flat_map(|analysis| (0..cases.len()).map(move |row| (row, analysis)))
        .collect();
    let results = on_each(&cells, |&(row, (name, analysis))| {
        let (case, folder) = (&cases[row], folder());
        std::fs::write(folder.path().join("scene.toml"), &case.file).unwrap();
        let began = Instant::now();
        let answer = std::panic::catch_unwind(|| {
            analysis(case, folder.path()).unwrap_or_else(Answer::Refused)
        });
        println!("{}, {name}: {:.1} s, {answer:?}", case.name, began.elapsed().as_secs_f64());
        answer.map_err(|_| format!("{}: {name}", case.name))
    });
    let mut answers: Vec<_> = cases.iter().map(|case| (case.name, Vec::new())).collect();
    let mut wrong = Vec::new();
    for ((row, _), result) in cells.iter().zip(results).rev() {
        match result {
            Ok(answer) => answers[*row].1.push(answer),
            Err(cell) => wrong.push(cell),
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    if only.is_empty() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/answers.md");
        let now = page(&answers);
        if std::env::var_os("AMONTONS_WRITE").is_some() {
            std::fs::write(&path, &now).unwrap();
        }
        assert!(
            std::fs::read_to_string(&path).unwrap_or_default() == now,
            "docs/answers.md says:\n{now}"
        );
    }
}

/// Compares the fastest growth rate that `amontons-stability modes` prints.
fn modes(case: &Case, folder: &Path) -> Result<Answer, String> {
    let (out, err) = ask(EIGENVALUES, folder, &["modes", "scene.toml"])?;
    let rates = out.lines().filter_map(|line| line.split_once("growth rate ")?.1.split_once(' '));
    let fastest = rates.map(|(rate, _)| number(rate)).fold(f64::NEG_INFINITY, f64::max);
    case.compare_growth(folder, "modes", fastest);
    Ok(limits(&err))
}

/// Compares the output `stability.growth_rate` at the start of a run.
fn monitored(case: &Case, folder: &Path) -> Result<Answer, String> {
    let with = format!("effects.stability = true\n{}", case.file);
    std::fs::write(folder.join("monitored.toml"), with).unwrap();
    let arguments = ["simulate", "monitored.toml", "--stop-time", "0.01"];
    let (out, err) = ask(MOTIONS, folder, &arguments)?;
    let table = csv(&out);
    let rate = number(&table[1][column(&table, "stability.growth_rate")]);
    case.compare_growth(folder, "stability.growth_rate", rate);
    Ok(limits(&err))
}

/// Compares the growth rate in the page that an FMU carries.
fn page_of_fmu(case: &Case, folder: &Path) -> Result<Answer, String> {
    let (_, err) = ask(MOTIONS, folder, &["export", "scene.toml", "-o", "scene.fmu"])?;
    let file = std::fs::File::open(folder.join("scene.fmu")).unwrap();
    let mut archive = zip::ZipArchive::new(file).unwrap();
    let page = archive.by_name("documentation/index.html").unwrap();
    let page = std::io::read_to_string(page).unwrap();
    let after = |words: &str| Some(number(page.split_once(words)?.1.split(' ').next()?));
    let rate = after("the fastest by ").or_else(|| after("the slowest by ").map(|rate| -rate));
    case.compare_growth(folder, "page", rate.unwrap());
    Ok(limits(&err))
}

impl Case {
    /// Compares a growth rate of uniform sliding, 1/s, that is printed with five digits.
    fn compare_growth(&self, folder: &Path, what: &str, found: f64) {
        let oracle = self.oracle(folder, &[]);
        let expected = oracle.growth(&oracle.sliding());
        let off = (found / expected - 1.0).abs();
        assert!(off < 1e-4, "{}, {what}: {found}, the oracle has {expected}", self.name);
    }
}

#[test]
fn whatever_takes_eigenvalues_knows_the_law_of_friction_and_what_each_contact_has_of_its_own() {
    let analyses: [(&str, Analysis); 8] = [
        ("states", states),
        ("locus over µ", locus_over_friction),
        ("locus over v", locus_over_velocity),
        ("bistable", bistable),
        ("map", mapped),
        ("modes", modes),
        ("monitor", monitored),
        ("page", page_of_fmu),
    ];
    // Over v eigenvalues change only where friction depends on it.
    let is_refused =
        |case: &Case, name: &str| name == "locus over v" && !case.name.starts_with("Stribeck");
    let wrong = on_each(&of_laws(), |case| {
        let folder = folder();
        std::fs::write(folder.path().join("scene.toml"), &case.file).unwrap();
        let mut wrong = Vec::new();
        for (name, analysis) in analyses {
            let answer = std::panic::catch_unwind(|| analysis(case, folder.path()));
            let is_right = match &answer {
                Ok(Ok(Answer::Right)) => true,
                Ok(Err(_)) => is_refused(case, name),
                _ => false,
            };
            if !is_right {
                wrong.push(format!("{}, {name}: {answer:?}", case.name));
            }
        }
        wrong
    });
    let wrong = wrong.concat();
    assert!(wrong.is_empty(), "{wrong:#?}");
}
