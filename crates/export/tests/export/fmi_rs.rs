//! The crate fmi-rs as a second importer: what it finds in Set 1's FMU, and that it gets the
//! doubles of the library itself. So does Set 1 with its stability watched.

use amontons::scene::{Scene, builtin, parse};
use amontons::simulation::catalogue::{Causality, fmu_variables};
use amontons::simulation::{Simulation, Variable, variables, write_scene};
use amontons_export::package::{self, Library};
use fmi_rs::fmi2::builder::FMU2Builder;
use fmi_rs::sim::fmi2::cs::simulate;
use fmi_rs::sim::fmi2::recorder::Recorder;
use fmi_rs::sim::fmi2::{SimulationSettings, Trajectories};
use std::path::PathBuf;
use std::sync::Arc;
use tempfile::TempDir;

const STOP_TIME: f64 = 0.05;
const OUTPUT_INTERVAL: f64 = 1e-3;

/// Set 1's file; with its stability watched if so.
fn set1(watched: bool) -> String {
    let effects = if watched { "\n[effects]\nstability = true\n" } else { "" };
    format!("{}{effects}", builtin("set1").unwrap().text)
}

fn scene(text: &str) -> Scene {
    parse("set1", text).unwrap()
}

/// A scene's FMU as a file, in a folder that goes with it.
fn fmu(text: &str) -> (TempDir, PathBuf) {
    let folder = TempDir::new_in(env!("CARGO_TARGET_TMPDIR")).unwrap();
    let path = folder.path().join("set1.fmu");
    std::fs::write(
        &path,
        package::fmu(&scene(text), &text.into(), None, Library::carried()).unwrap(),
    )
    .unwrap();
    (folder, path)
}

fn outputs(scene: &Scene) -> Vec<Variable> {
    let is_output = |v: &Variable| v.causality == Causality::Output;
    variables(scene).into_iter().filter(is_output).collect()
}

/// Times, and every output as the bits of a double, row by row.
type Table = (Vec<f64>, Vec<Vec<u64>>);

/// The run through fmi-rs.
fn imported(text: &str, values: &[(&str, f64)]) -> Table {
    let (_folder, path) = fmu(text);
    let FMU2Builder { unzipdir, model_description, .. } = FMU2Builder::new(&path).unwrap();
    let model_description = Arc::new(model_description);
    let names = outputs(&scene(text));
    let indices = names
        .iter()
        .map(|variable| model_description.variable_index_by_name(&variable.name).unwrap())
        .collect();
    let settings = SimulationSettings {
        unzipdir: unzipdir.path().to_owned(),
        model_description: model_description.clone(),
        start_time: 0.0,
        stop_time: STOP_TIME,
        logging_on: false,
        set_stop_time: true,
        output_interval: OUTPUT_INTERVAL,
        log_time_scale: false,
        tolerance: 1e-9,
        set_tolerance: false,
        start_values: values
            .iter()
            .map(|(name, value)| ((*name).to_owned(), format!("{value:?}")))
            .collect(),
        log_fmi_calls: false,
        input_file: None,
        early_return_allowed: false,
        event_mode_used: false,
        log_file: None,
        initial_fmu_state_file: None,
        final_fmu_state_file: None,
    };
    // fmi-rs asks for an Arc of what cannot be shared.
    #[allow(clippy::arc_with_non_send_sync)]
    let recorder = Arc::new(Recorder::new(Trajectories::new(model_description, indices)));
    simulate(&settings, None, recorder.clone()).unwrap();
    let recorded = Arc::into_inner(recorder).unwrap().into_trajectories();
    recorded.validate().unwrap();
    let bits = |row: &Vec<_>| {
        row.iter()
            .map(|value: &fmi_rs::sim::fmi2::VariableValue| {
                value.to_f64().expect("all outputs are numbers").to_bits()
            })
            .collect()
    };
    let rows = recorded.rows.iter().map(bits).collect();
    (recorded.time, rows)
}

/// The run without an importer, at the times given.
fn native(text: &str, values: &[(&str, f64)], times: &[f64]) -> Table {
    let mut scene = scene(text);
    let known = variables(&scene);
    for (name, value) in values {
        let variable = known.iter().find(|variable| variable.name == *name).unwrap();
        write_scene(&mut scene, variable, *value).unwrap();
    }
    let outputs = outputs(&scene);
    let mut simulation = Simulation::new(scene, 0.0).unwrap();
    let rows = times
        .iter()
        .map(|&time| {
            simulation.advance_to(time).unwrap();
            outputs.iter().map(|output| simulation.read(output).unwrap().to_bits()).collect()
        })
        .collect();
    (times.to_vec(), rows)
}

#[test]
fn fmi_rs_finds_no_problem_in_the_model_description() {
    for watched in [false, true] {
        let text = set1(watched);
        let (_folder, path) = fmu(&text);
        let description = FMU2Builder::new(&path).unwrap().model_description;
        let problems: Vec<String> =
            description.validate().into_iter().map(|problem| problem.message).collect();
        assert_eq!(problems, [""; 0]);
        assert_eq!(description.modelName, "set1");
        let scene = scene(&text);
        assert_eq!(description.modelVariables.len(), fmu_variables(&scene).len());
        assert_eq!(description.outputs.len(), outputs(&scene).len());
    }
}

#[test]
fn fmi_rs_gets_the_doubles_of_the_library() {
    for (watched, values) in [
        (false, vec![]),
        (false, vec![("initial.module[1].v2", 0.3)]),
        (true, vec![("initial.module[1].v2", 0.3)]),
        (
            false,
            vec![
                ("initial.module[2].v1", -0.2),
                ("friction.coefficient", 1.1),
                ("slider.velocity", 0.06),
                ("module[1].k2", 61.7e3),
            ],
        ),
    ] {
        let text = set1(watched);
        let imported = imported(&text, &values);
        assert_eq!(imported.0.len(), 51);
        assert_eq!(imported.1[0].len(), outputs(&scene(&text)).len());
        assert_eq!(imported, native(&text, &values, &imported.0), "{values:?}");
    }
}

#[test]
fn the_comparison_notices_another_number() {
    let text = set1(false);
    let imported = imported(&text, &[("initial.module[1].v2", 0.3)]);
    let others = [("initial.module[1].v2", 0.3), ("module[1].k2", 60e3 + 1e-7)];
    let off = native(&text, &others, &imported.0);
    assert_eq!(imported.0, off.0);
    assert_ne!(imported.1, off.1);
}
