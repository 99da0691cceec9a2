//! A tolerance in place of method and step: presets keep what they promise on scenes that the rule was not made
//! on.

use crate::program::{assert_refused, folder, run, text};
use amontons::scene::{BUILTIN, Method, Preset, Scene, Selection, builtin, parse};
use amontons::selection::{Selected, select};
use amontons::simulation::Simulation;
use amontons_analysis::warning::warnings;
use std::io::{Cursor, Read};
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Duration;

fn amontons(folder: &Path, arguments: &[&str]) -> Output {
    run(env!("CARGO_BIN_EXE_amontons"), folder, arguments)
}

/// Output of a command that must succeed.
fn printed(folder: &Path, arguments: &[&str]) -> String {
    let output = amontons(folder, arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    text(&output.stdout)
}

/// A built-in scene over another experiment, s.
fn scene(name: &str, stop: f64, preset: Preset) -> Scene {
    let mut scene = builtin(name).unwrap().scene();
    scene.experiment.stop_time = stop;
    scene.selection = Selection::Preset(preset);
    scene
}

/// Displacements after each output interval, row by row.
fn rows(scene: &Scene) -> Vec<Vec<f64>> {
    let mut simulation = Simulation::new(scene.clone(), 0.0).unwrap();
    let experiment = scene.experiment;
    let mut rows = vec![simulation.displacement().to_vec()];
    for i in 1.. {
        let time = f64::from(i) * experiment.output_interval;
        if time > experiment.stop_time * (1.0 + 1e-9) {
            return rows;
        }
        simulation.advance_to(time).unwrap();
        rows.push(simulation.displacement().to_vec());
    }
    rows
}

/// Root mean square of all differences, in parts of the reference's deviation from its means.
fn error(run: &[Vec<f64>], reference: &[Vec<f64>]) -> f64 {
    assert_eq!(run.len(), reference.len());
    let pairs = run.iter().zip(reference).flat_map(|(a, b)| a.iter().zip(b));
    let apart: f64 = pairs.map(|(a, b)| (a - b).powi(2)).sum();
    let dofs = 0..reference[0].len();
    let deviation = dofs.map(|dof| {
        let mean = reference.iter().map(|x| x[dof]).sum::<f64>() / reference.len() as f64;
        reference.iter().map(|x| (x[dof] - mean).powi(2)).sum::<f64>()
    });
    (apart / deviation.sum::<f64>()).sqrt()
}

/// The error of a scene whose tolerance chooses, against exact motion in steps that are three times shorter than
/// any it has; those agree with themselves ten times better than is promised.
#[track_caller]
fn assert_kept(scene: &Scene) -> Selected {
    let simulation = Simulation::new(scene.clone(), 0.0).unwrap();
    let selected = simulation.selected().unwrap();
    assert!(selected.is_kept() && warnings(&simulation).is_empty(), "{selected:?}");
    let finer = |parts: f64| {
        let step = scene.experiment.output_interval / parts;
        rows(&scene.with_integrator(Method::EventDriven, step))
    };
    let reference = finer(6.0);
    assert!(error(&finer(3.0), &reference) < 0.1 * selected.tolerance);
    let error = error(&rows(scene), &reference);
    assert!(error <= selected.tolerance, "{}: {error:e} {selected:?}", scene.name);
    selected
}

#[test]
fn presets_keep_what_they_promise_on_scenes_that_the_rule_was_not_made_on() {
    let mut methods = Vec::new();
    for (name, stop) in [("ring12", 0.05), ("ring12", 0.5), ("belt", 3.0), ("disc_brake", 0.1)] {
        for preset in Preset::ALL {
            methods.push(assert_kept(&scene(name, stop, preset)).method);
        }
    }
    // Both methods have been held to it.
    assert!(methods.contains(&Method::ForwardIncrement) && methods.contains(&Method::EventDriven));
}

/// A chain of 24 masses on springs, each of which rubs: as many degrees of freedom as take sparse matrices.
fn chain(selection: Selection, stop: f64) -> Scene {
    let mut text = String::from(
        "[slider]\nvelocity = 0.05\nangle = 0.0\n[friction]\ncoefficient = 0.4\n[damping]\nbeta = 2e-5\n\
         [integrator]\nstep = 1e-5\n[experiment]\noutput_interval = 5e-4\n",
    );
    for i in 0..24 {
        let mass = 0.2 + 0.01 * f64::from(i % 5);
        text += &format!(
            "[[mass]]\nname = \"m{i}\"\nmass = {mass}\nforce = [0.0, -20.0]\n[[spring]]\nname = \"h{i}\"\n\
             between = [\"m{i}\", \"ground\"]\ndirection = \"x\"\nstiffness = 2e4\n[[spring]]\nname = \"v{i}\"\n\
             between = [\"m{i}\", \"ground\"]\ndirection = \"y\"\nstiffness = 5e4\n[[contact]]\nname = \"c{i}\"\n\
             mass = \"m{i}\"\n"
        );
        if i > 0 {
            let before = i - 1;
            text += &format!(
                "[[spring]]\nname = \"l{i}\"\nbetween = [\"m{before}\", \"m{i}\"]\ndirection = \"x\"\n\
                 stiffness = 3e4\n"
            );
        }
    }
    text += "[[initial]]\nmass = \"m3\"\nvx = 0.3\n";
    let mut scene = parse("chain", &text).unwrap();
    scene.selection = selection;
    scene.experiment.stop_time = stop;
    scene
}

#[test]
fn a_network_of_many_masses_is_held_to_it_too() {
    for tolerance in [0.03, 1e-2, 1e-3, 1e-6] {
        assert_kept(&chain(Selection::Auto { tolerance }, 0.05));
    }
}

#[test]
fn the_scheme_is_chosen_where_it_is_cheaper_and_nowhere_else() {
    // A large structure over a short time at a coarse tolerance.
    let method = |name, stop, preset| {
        let scene = scene(name, stop, preset);
        select(&scene, preset.tolerance()).method
    };
    assert_eq!(method("ring12", 0.05, Preset::Preview), Method::ForwardIncrement);
    assert_eq!(method("ring12", 0.05, Preset::Design), Method::EventDriven);
    assert_eq!(method("ring12", 5.0, Preset::Preview), Method::EventDriven);
    for builtin in BUILTIN.iter().filter(|builtin| builtin.name != "ring12") {
        for preset in Preset::ALL {
            let stop = builtin.scene().experiment.stop_time;
            assert_eq!(method(builtin.name, stop, preset), Method::EventDriven, "{}", builtin.name);
        }
    }
}

/// A block on a belt with static friction, driven by this signal.
fn driven(input: &str, shape: &str, selection: Selection) -> Scene {
    let text =
        std::fs::read_to_string("../../tests/hard_scenes/preset_sine_slider_static.toml").unwrap();
    let (text, _) = text.split_once("[[signal]]").unwrap();
    let mut scene =
        parse("driven", &format!("{text}[[signal]]\ninput = \"{input}\"\n{shape}\n")).unwrap();
    scene.selection = selection;
    scene
}

#[test]
fn presets_keep_what_they_promise_on_signals_of_every_shape() {
    // Signals of velocities (m/s), thirty times as large ones of forces (N), and a tenth of them of friction.
    for (input, size) in
        [("slider.velocity", 1.0), ("mass.block.fx", 30.0), ("friction.coefficient", 0.1)]
    {
        let [a, b, c, d] = [0.2, 0.25, 0.4, 0.5].map(|value| size * value);
        let shapes = [
            format!("ramp = {{ to = {d:?}, start = 0.1234, end = 1.2345 }}"),
            format!("pulse = {{ value = {b:?}, start = 0.3333, end = 2.2222 }}"),
            format!("sine = {{ amplitude = {d:?}, frequency = 0.7 }}"),
            format!(
                "sine = {{ amplitude = {d:?}, frequency = 3.7, start = 0.0777, end = 3.0333 }}"
            ),
            format!(
                "table = {{ points = [[0, 0], [0.777, {c:?}], [1.111, -{c:?}], [1.111, {a:?}]] }}"
            ),
            format!(
                "table = {{ points = [[0, 0], [0.777, {c:?}], [2.111, -{c:?}]], between = \"constant\" }}"
            ),
        ];
        for shape in shapes {
            for preset in Preset::ALL {
                // Friction acts where the belt moves.
                let belt = "\n[[signal]]\ninput = \"slider.velocity\"\n\
                            sine = { amplitude = 0.5, frequency = 0.7 }";
                let more = if input.starts_with("friction") { belt } else { "" };
                let scene = driven(input, &format!("{shape}{more}"), Selection::Preset(preset));
                // None asks for a shorter step than the output interval.
                let Selected { method, step, .. } = assert_kept(&scene);
                assert_eq!((method, step), (Method::EventDriven, 0.01), "{shape}");
            }
        }
    }
}

#[test]
fn what_nothing_keeps_is_said_with_what_is_kept() {
    let mut scene = scene("belt", 3.0, Preset::Design);
    scene.selection = Selection::Auto { tolerance: 1e-15 };
    let simulation = Simulation::new(scene, 0.0).unwrap();
    let selected = simulation.selected().unwrap();
    assert!(!selected.is_kept() && selected.error < 1e-11, "{selected:?}");
    let warnings = warnings(&simulation);
    assert!(warnings.len() == 1 && warnings[0].contains("1e-15"), "{warnings:?}");
    assert!(warnings[0].contains(&format!("{:.0e}", selected.error)), "{warnings:?}");
}

#[test]
fn a_preset_in_a_file_and_on_the_command_line_runs_what_it_chooses() {
    let folder = folder();
    let shown = printed(folder.path(), &["scenes", "show", "ring12"]);
    let written = shown.replacen("step = 1.0e-6 ", "preset = \"preview\" ", 1);
    assert_ne!(shown, written);
    std::fs::write(folder.path().join("mine.toml"), written).unwrap();
    let run = |arguments: &[&str]| {
        let times = ["--stop-time", "0.004"];
        printed(folder.path(), &[&["simulate"], arguments, &times].concat())
    };
    let Selected { method, step, .. } = select(&builtin("ring12").unwrap().scene(), 1e-2);
    let (method, step) = (method.to_string(), format!("{step:e}"));
    let expected = run(&["ring12", "--integrator", &method, "--step", &step]);
    // However much of the experiment is run.
    assert_eq!(expected, run(&["mine.toml"]));
    assert_eq!(expected, run(&["ring12", "--preset", "preview"]));
    assert_ne!(expected, run(&["ring12"]));
    // The choice of both by a preset or a tolerance gives way if both the integrator and the step are given.
    assert_eq!(expected, run(&["mine.toml", "--integrator", &method, "--step", &step]));
}

#[test]
fn what_contradicts_itself_is_refused() {
    let folder = folder();
    let refused = |arguments: &[&str], words: &[&str]| {
        assert_refused(&amontons(folder.path(), arguments), 2, words);
    };
    refused(&["simulate", "set1", "--preset", "design", "--step", "1e-6"], &["--preset", "--step"]);
    refused(&["simulate", "set1", "--preset", "desing"], &["preview", "design", "reference"]);
    let shown = printed(folder.path(), &["scenes", "show", "set1"]);
    let auto = shown.replacen("step = 1.0e-6 ", "method = \"auto\" ", 1);
    std::fs::write(folder.path().join("auto.toml"), auto).unwrap();
    refused(&["simulate", "auto.toml", "--step", "1e-6"], &["method = \"auto\"", "--integrator"]);
    refused(&["simulate", "auto.toml", "--integrator", "event-driven"], &["--step"]);
    refused(&["simulate", "auto.toml", "--set", "integrator.step=1e-6"], &["chooses it", "auto"]);
    // If the output cannot be written, nothing is measured.
    let nowhere = ["export", "set1", "--with-accuracy", "-o", "nowhere/set1.fmu"];
    assert_refused(&amontons(folder.path(), &nowhere), 1, &["there is no folder nowhere"]);
}

/// A file in an FMU.
fn file(fmu: &[u8], name: &str) -> String {
    let mut archive = zip::ZipArchive::new(Cursor::new(fmu)).unwrap();
    let mut content = String::new();
    archive.by_name(name).unwrap().read_to_string(&mut content).unwrap();
    content
}

/// Exports to a file of that name, and gives the FMU and what was printed.
fn export(folder: &Path, name: &str, arguments: &[&str]) -> (Vec<u8>, String) {
    let said = printed(folder, &[&["export"], arguments, &["-o", name]].concat());
    (std::fs::read(folder.join(name)).unwrap(), said)
}

#[test]
fn a_preset_of_an_export_stands_in_the_scene_of_the_fmu() {
    let folder = folder();
    let (fmu, said) = export(folder.path(), "a.fmu", &["set2", "--preset", "design"]);
    assert!(said.contains("preset = \"design\"") && said.contains("event-driven"), "{said}");
    let scene = parse("set2", &file(&fmu, "resources/scene.toml")).unwrap();
    assert_eq!(scene.selection, Selection::Preset(Preset::Design));
    let description = file(&fmu, "modelDescription.xml");
    assert!(!description.contains("integrator.step") && !description.contains("tolerance="));
}

/// A line of HTML with a space in place of each tag.
fn without_tags(line: &str) -> String {
    let parts = line.split('<').map(|part| part.split_once('>').map_or(part, |(_, text)| text));
    parts.collect::<Vec<&str>>().join(" ")
}

#[test]
fn the_page_in_an_fmu_has_the_table_of_the_command_and_the_same_bytes_each_time() {
    let folder = folder();
    let mine = printed(folder.path(), &["scenes", "show", "corner"]);
    let mine = mine.replacen("description = \"", "description = \"A & B <i>: ", 1);
    std::fs::write(folder.path().join("mine.toml"), mine).unwrap();
    let arguments = ["mine.toml", "--with-accuracy"];
    let (fmu, _) = export(folder.path(), "a.fmu", &arguments);
    assert!(fmu == export(folder.path(), "b.fmu", &arguments).0, "not the same bytes");
    let page = file(&fmu, "documentation/accuracy.html");
    assert!(file(&fmu, "documentation/index.html").contains("href=\"accuracy.html\""));
    assert!(page.contains("A &amp; B &lt;i&gt;: "), "{page}");
    // All but the times is what the command prints.
    let table = printed(folder.path(), &["accuracy", "mine.toml"]);
    let words = |line: &str| line.split_whitespace().map(str::to_owned).collect::<Vec<String>>();
    let is_row = |line: &&str| line.starts_with("forward-incr") || line.starts_with("event-driven");
    let printed: Vec<Vec<String>> = table.lines().filter(is_row).map(words).collect();
    let is_row = |line: &&str| line.starts_with("<tr><th scope=\"row\"");
    let written = page.lines().filter(is_row).map(|line| words(&without_tags(line)));
    let written: Vec<Vec<String>> = written.collect();
    assert!(printed.len() > 10 && printed.len() == written.len(), "{page}");
    for (printed, written) in printed.iter().zip(&written) {
        assert_eq!(printed[..printed.len() - 1], written[..]);
    }
    // Not where it was not asked for.
    let (plain, _) = export(folder.path(), "c.fmu", &["mine.toml"]);
    let names = zip::ZipArchive::new(Cursor::new(&plain)).unwrap();
    assert!(names.file_names().all(|name| !name.unwrap().ends_with("accuracy.html")));
    assert!(!file(&plain, "documentation/index.html").contains("accuracy.html"));
}

#[test]
fn an_export_that_is_interrupted_writes_nothing() {
    let folder = folder();
    let mut command = Command::new(env!("CARGO_BIN_EXE_amontons"));
    command.args(["export", "ring12", "--with-accuracy", "-o", "a.fmu"]).current_dir(folder.path());
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    std::thread::sleep(Duration::from_secs(1));
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_refused(&output, 130, &["interrupted"]);
    assert!(output.stdout.is_empty());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}
