//! The commands whose output and exit code are kept.

use crate::program::{folder, run, text};
use amontons::scene::builtin;
use amontons_export::package::model_description;
use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::Path;
use zip::write::SimpleFileOptions;

/// A command line, how many lines of what it prints are kept, and what of them.
type Command = (&'static str, usize, View);

/// Turns a line into the part of it that is kept.
type View = fn(&str) -> String;

/// No line: only how it ends.
const NONE: usize = 0;
const ALL: usize = usize::MAX;

pub const COMMANDS: [(&str, &[Command]); 4] = [
    (
        "runs",
        &[
            ("amontons simulate belt --stop-time 0.1 --output-interval 0.02", ALL, whole),
            ("amontons simulate set1 --stop-time 1e-3 --output-interval 2.5e-4", ALL, whole),
            ("amontons simulate set1 --preset preview --stop-time 0.02", 4, whole),
            (
                "amontons simulate set2 --integrator event-driven --step 2e-4 --stop-time 0.1",
                4,
                whole,
            ),
            ("amontons simulate set1 --stop-time 2e-3 --input steady.csv", 4, whole),
            (
                "amontons simulate set2 --sweep friction.coefficient=1.5:1.9/3 --stop-time 0.2",
                ALL,
                whole,
            ),
            ("amontons simulate belt --stop-time 0.1 -o belt.csv", NONE, whole),
            ("show belt.csv", 3, whole),
            ("amontons effects stick_slip", ALL, without_times),
            ("amontons effects set1", ALL, without_times),
            ("amontons accuracy belt --stop-time 0.5 --format csv", ALL, without_times),
            ("amontons accuracy corner --stop-time 0.02 --format json", 45, without_times),
            ("amontons study limit-cycle belt -o cycle", ALL, rounded),
            ("show cycle/results.csv", ALL, rounded),
            ("show cycle/study.json", 20, rounded),
            ("amontons scenes", ALL, whole),
            ("amontons scenes show corner", 12, whole),
            ("amontons scenes schema", 20, whole),
        ],
    ),
    (
        "eigenvalues",
        &[
            ("amontons-stability modes hoffmann", ALL, rounded),
            ("amontons-stability modes set2 --state Sl-St", ALL, rounded),
            ("amontons-stability bistable set2 --friction 1.5:2.2", ALL, rounded),
            ("amontons-stability bistable disc_brake --friction 0.3:0.7", ALL, rounded),
            ("amontons-stability locus hoffmann --friction 0:0.5/50", ALL, rounded),
            ("amontons-stability locus hoffmann --friction 0:0.5/5 --csv", ALL, rounded),
            ("amontons-stability locus set1 --friction 1.5:2.5/20", ALL, rounded),
            ("amontons-stability sensitivity disc_brake --critical 0.3:1 --first 4", ALL, rounded),
            ("amontons-stability states set2", ALL, rounded),
            ("amontons-stability states disc_brake --format csv", 20, rounded),
            ("amontons-stability states corner --format json", 30, rounded),
            ("amontons-stability states den_hartog --at 0.1", ALL, rounded),
            (
                "amontons-stability map set1 --x friction.coefficient=0:2/3 --y module[1].k2=5e4:6e4/3",
                ALL,
                rounded,
            ),
        ],
    ),
    (
        "helps",
        &[
            ("amontons --version", ALL, whole),
            ("amontons --help", ALL, whole),
            ("amontons export --help", 10, whole),
            ("amontons simulate --help", ALL, whole),
            ("amontons accuracy --help", ALL, whole),
            ("amontons effects --help", ALL, whole),
            ("amontons reduce --help", ALL, whole),
            ("amontons study --help", ALL, whole),
            ("amontons-stability matrices --help", ALL, whole),
            ("amontons study continuation --help", 5, whole),
            ("amontons study limit-cycle --help", 5, whole),
            ("amontons study transient --help", 5, whole),
            ("amontons study loudness --help", 5, whole),
            ("amontons study perturbation --help", 5, whole),
            ("amontons study basin --help", 5, whole),
            ("amontons study robustness --help", ALL, whole),
            ("amontons study report --help", ALL, whole),
            ("amontons study merge --help", ALL, whole),
            ("amontons check --help", 20, whole),
            ("amontons scenes --help", ALL, whole),
            ("amontons-stability --version", ALL, whole),
            ("amontons-stability --help", ALL, whole),
            ("amontons-stability states --help", ALL, whole),
            ("amontons-stability locus --help", ALL, whole),
            ("amontons-stability sensitivity --help", ALL, whole),
            ("amontons-stability modes --help", ALL, whole),
            ("amontons-stability bistable --help", ALL, whole),
            ("amontons-stability map --help", ALL, whole),
            ("amontons-stability merge --help", ALL, whole),
        ],
    ),
    (
        "codes",
        &[
            ("amontons", NONE, whole),
            ("amontons nonsense", NONE, whole),
            ("amontons simulate", NONE, whole),
            ("amontons simulate gone.toml", NONE, whole),
            ("amontons simulate bad.toml", NONE, whole),
            ("amontons simulate set1 --step 1", NONE, rounded),
            ("amontons simulate set1 --set nonsense=1", NONE, whole),
            ("amontons simulate set1 --set friction.coefficient=-1", NONE, whole),
            ("amontons simulate set1 --set slider.angle=0.5 --set slider.angle=0.6", NONE, whole),
            ("amontons simulate set1 --stop-time -1", NONE, whole),
            ("amontons simulate set1 --input gone.csv", NONE, whole),
            ("amontons simulate set1 --stop-time 0.01 --input negative.csv", NONE, whole),
            ("amontons simulate set1 --preset design --step 1e-6", NONE, whole),
            ("amontons simulate set1 --stop-time 0.01 -o nowhere/a.csv", NONE, whole),
            ("amontons scenes show nope", NONE, whole),
            ("amontons scenes draw set1 -o a.txt", NONE, whole),
            ("amontons scenes draw set1 -o a.svg", NONE, whole),
            ("amontons effects nope", NONE, whole),
            ("amontons accuracy set1 --of nope", NONE, whole),
            ("amontons export set1 -o a.fmu", 4, whole),
            ("amontons check", NONE, whole),
            ("amontons check --rules", NONE, whole),
            ("amontons check gone.fmu", NONE, whole),
            ("amontons check text.fmu", NONE, whole),
            ("amontons check a.fmu --timeout 0", NONE, whole),
            ("amontons check a.fmu --glibc x", NONE, whole),
            ("amontons check a.fmu --no-run", NONE, whole),
            ("amontons check a.fmu", NONE, whole),
            ("amontons check foreign.fmu", ALL, whole),
            ("amontons check bare.fmu", ALL, without_host),
            ("amontons check wrong.fmu", ALL, without_host),
            ("amontons study", NONE, whole),
            ("amontons study limit-cycle set1 --parameter nope=1:2/3", NONE, whole),
            ("amontons study basin belt", NONE, whole),
            ("amontons study merge gone", NONE, whole),
            (
                "amontons simulate set1 --sweep slider.velocity=1:2/3 -o out --shard 4/3",
                NONE,
                whole,
            ),
            (
                "amontons simulate set1 --stop-time 0.01 --sweep slider.velocity=1:2/3 -o out --shard 1/2",
                ALL,
                whole,
            ),
            ("amontons study merge out", ALL, whole),
            ("amontons-stability merge out", NONE, whole),
            ("amontons-stability", NONE, whole),
            ("amontons-stability nonsense", NONE, whole),
            ("amontons-stability states gone.toml", NONE, whole),
            ("amontons-stability states bad.toml", NONE, whole),
            ("amontons-stability states set1 --state Xx", NONE, whole),
            ("amontons-stability states den_hartog", NONE, whole),
            ("amontons-stability locus set1", NONE, whole),
            ("amontons-stability locus set1 --friction 1", NONE, whole),
            ("amontons-stability locus set1 --friction 0:1/3 --plot a.txt", NONE, whole),
            ("amontons-stability modes drive --plot a.svg", NONE, whole),
            ("amontons-stability bistable set1 --friction 2:1", NONE, whole),
            ("amontons-stability bistable drive --friction 0:1", NONE, whole),
            (
                "amontons-stability map set1 --x slider.angle=0:1/3 --y slider.angle=0:1/3",
                NONE,
                whole,
            ),
        ],
    ),
];

/// Runs commands one after another in a folder of their own; what they print and how they end.
pub fn page(commands: &[Command]) -> String {
    let folder = folder();
    write_files(folder.path());
    let mut page = String::new();
    for (line, count, view) in commands {
        let (program, arguments) = line.split_once(' ').unwrap_or((line, ""));
        let arguments: Vec<&str> = arguments.split_whitespace().collect();
        let _ = writeln!(page, "$ {line}");
        let (printed, end) = match program {
            "show" => {
                (fs::read_to_string(folder.path().join(arguments[0])).unwrap(), String::new())
            }
            "amontons" => end(env!("CARGO_BIN_EXE_amontons"), folder.path(), &arguments),
            _ => end(env!("CARGO_BIN_EXE_amontons-stability"), folder.path(), &arguments),
        };
        for line in printed.lines().take(*count) {
            let _ = writeln!(page, "| {}", view(line));
        }
        if printed.lines().count() > *count && *count > NONE {
            page += "| …\n";
        }
        for line in end.lines() {
            let _ = writeln!(page, "{}", view(line));
        }
        page.push('\n');
    }
    page
}

/// The text that a program prints, and then the first lines of its messages with its exit code.
fn end(program: &str, folder: &Path, arguments: &[&str]) -> (String, String) {
    let output = run(program, folder, arguments);
    let mut end = String::new();
    for line in text(&output.stderr).lines() {
        // Lines of progress may stand between.
        if ["error: ", "warning: ", "note: "].iter().any(|word| line.starts_with(word)) {
            // The reason why a file cannot be used is the system's message.
            let is_of_system = line.contains("(os error");
            let told = line.rsplit_once(": ").filter(|_| is_of_system).map_or(line, |it| it.0);
            let _ = writeln!(end, "{told}");
        }
    }
    let _ = match output.status.code() {
        Some(code) => writeln!(end, "exit code {code}"),
        None => writeln!(end, "ended by a signal"),
    };
    (text(&output.stdout), end)
}

/// The files that the commands name.
fn write_files(folder: &Path) {
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
    write("bad.toml", "nonsense = 1\n");
    write("text.fmu", "text");
    write("negative.csv", "time,friction.coefficient\n0,1\n0.002,-1\n");
    write(
        "steady.csv",
        "time,friction.coefficient,module[1].f2\n0,1.9,0\n1e-3,1.5,-4\n2e-3,1.5,2\n",
    );
    let set1 = builtin("set1").unwrap();
    let description = model_description(&set1.scene(), &set1.text.into(), None);
    let wrong = description
        .replacen("name=\"slider.angle\"", "name=\"friction.coefficient\"", 1)
        .replacen("variability=\"fixed\"", "variability=\"continuous\"", 1);
    let archive = |name: &str, entry: &str, text: &str| {
        let mut archive = zip::ZipWriter::new(fs::File::create(folder.join(name)).unwrap());
        archive.start_file(entry, SimpleFileOptions::default()).unwrap();
        archive.write_all(text.as_bytes()).unwrap();
        archive.finish().unwrap();
    };
    archive("foreign.fmu", "readme.txt", "no FMU");
    archive("bare.fmu", "modelDescription.xml", &description);
    archive("wrong.fmu", "modelDescription.xml", &wrong);
}

/// All of a line.
fn whole(line: &str) -> String {
    line.to_owned()
}

/// A line without the name of this kind of machine.
fn without_host(line: &str) -> String {
    line.split(" in binaries/").next().unwrap_or_default().to_owned()
}

/// A line of `effects` or `accuracy` without times. What a logarithm of the system's or eigenvalues make is rounded.
fn without_times(line: &str) -> String {
    if ["forward-increment,", "event-driven,"].iter().any(|method| line.starts_with(method)) {
        let mut columns: Vec<&str> = line.split(',').collect();
        columns.pop();
        let order = rounded(columns.pop().unwrap());
        return format!("{},{order},…", columns.join(","));
    }
    if let Some((before, _)) = line.split_once("\"seconds_per_second\": ") {
        return format!("{before}\"seconds_per_second\": …");
    }
    if ["\"order\"", "\"critical_step\""].iter().any(|key| line.contains(key)) {
        return rounded(line);
    }
    let words: Vec<&str> = line.split_whitespace().collect();
    let is_time = |place: usize| matches!(words.get(place + 1), Some(&("µs" | "%")));
    if !(0..words.len()).any(is_time) {
        return line.to_owned();
    }
    let kept = words.iter().enumerate().map(|(i, word)| if is_time(i) { "…" } else { word });
    kept.collect::<Vec<_>>().join(" ")
}

/// Number of digits that are kept of a number, since machines differ in the last ones.
const DIGITS: usize = 6;
/// Below, a number is nothing but rounding errors.
const NOTHING: f64 = 1e-9;

/// A line with all longer numbers rounded, and without residuals.
fn rounded(line: &str) -> String {
    let (line, residual) = match line.split_once(", residual ") {
        Some((before, after)) => {
            let end = after.find(',').unwrap_or(after.len());
            (before, format!(", residual …{}", &after[end..]))
        }
        None => (line, String::new()),
    };
    let mut text = String::new();
    let mut rest = line;
    while let Some(c) = rest.chars().next() {
        let is_in_word = text.ends_with(|c: char| c.is_alphanumeric() || "._".contains(c));
        let number = if is_in_word { "" } else { number_at(rest) };
        if number.is_empty() {
            text.push(c);
            rest = &rest[c.len_utf8()..];
        } else {
            text += &short(number);
            rest = &rest[number.len()..];
        }
    }
    text + &residual
}

/// The number that a text begins with.
fn number_at(text: &str) -> &str {
    let digits =
        |text: &str| text.len() - text.trim_start_matches(|c: char| c.is_ascii_digit()).len();
    let sign = usize::from(text.starts_with(['-', '+']));
    let whole = digits(&text[sign..]);
    if whole == 0 {
        return "";
    }
    let mut end = sign + whole;
    if text[end..].starts_with('.') {
        end += 1 + digits(&text[end + 1..]);
    }
    if let Some(exponent) = text[end..].strip_prefix('e') {
        let sign = usize::from(exponent.starts_with(['-', '+']));
        let power = digits(&exponent[sign..]);
        end += if power > 0 { 1 + sign + power } else { 0 };
    }
    &text[..end]
}

fn short(number: &str) -> String {
    let mantissa = number.split('e').next().unwrap_or_default();
    let digits = mantissa.chars().filter(char::is_ascii_digit).collect::<String>();
    let value: f64 = number.parse().unwrap();
    let is_whole = !number.contains(['.', 'e']);
    if is_whole || digits.trim_start_matches('0').len() <= DIGITS {
        number.to_owned()
    } else if value.abs() < NOTHING {
        "≈0".to_owned()
    } else {
        format!("{value:.*e}", DIGITS - 1)
    }
}

#[test]
fn a_line_is_kept_without_times_and_last_digits() {
    assert_eq!(rounded("a,0.12345678,-12.5,module[1].x1"), "a,1.23457e-1,-12.5,module[1].x1");
    assert_eq!(rounded("1000000 of +2.0000000000000004"), "1000000 of 2.00000e0");
    assert_eq!(rounded("[-1.2345678e-17, 1e-17]"), "[≈0, 1e-17]");
    assert_eq!(rounded("mode 1, residual 4e-17, 1 wave"), "mode 1, residual …, 1 wave");
    assert_eq!(without_times("a step takes 0.057 µs here"), "a step takes … µs here");
    assert_eq!(without_times("sticking  on  -2 %  ẋ = v"), "sticking on … % ẋ = v");
    assert_eq!(without_times("event-driven,0.12345678,1.0,2e-5"), "event-driven,0.12345678,1.0,…");
    assert_eq!(without_times("event-driven,3,,2e-5"), "event-driven,3,,…");
    assert_eq!(without_host("note: no library in binaries/linux64/"), "note: no library");
}
