//! FMPy as an importer: exports the built-in scenes and those of single effects with each integrator and runs the Python tests in
//! `tests/fmpy/` on them, one test here for each file there.

use crate::python;
use amontons::scene::{BUILTIN, parse};
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::Mutex;
use tempfile::TempDir;

const AMONTONS: &str = env!("CARGO_BIN_EXE_amontons");

/// Runs the tests of one Python file with each integrator; pytest's report is the message of a failure.
fn pytest(file: &str) {
    for integrator in ["forward-increment", "event-driven"] {
        pytest_with(integrator, file);
    }
}

fn pytest_with(integrator: &str, file: &str) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join("fmpy");
    // One for each test, so that nothing but the interpreter and the FMUs are shared.
    let scratch = TempDir::new_in(env!("CARGO_TARGET_TMPDIR")).expect("a folder can be made there");
    let mut pytest = Command::new(python::interpreter());
    pytest
        // No bytecode and no cache: the tests leave nothing among the sources.
        .args(["-B", "-m", "pytest", "-p", "no:cacheprovider", "--strict-markers", "--tb=short"])
        .args([OsStr::new("--rootdir"), folder.as_os_str()])
        .args([OsStr::new("--basetemp"), scratch.path().join("pytest").as_os_str()])
        .arg(folder.join(file))
        .env("AMONTONS", AMONTONS)
        .env("AMONTONS_FMUS", fmus(integrator))
        .env("AMONTONS_INTEGRATOR", integrator)
        // Packages may bring plugins of their own.
        .env("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")
        .env_remove("PYTEST_ADDOPTS")
        .env_remove("SOURCE_DATE_EPOCH");
    succeed(&mut pytest);
}

/// The files in `scenes/effects/` that this integrator takes: exact motion needs a µ that is the same at all slip
/// velocities.
fn effects(integrator: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/effects");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let is_taken = |file: &PathBuf| {
        let scene = parse("effect", &std::fs::read_to_string(file).unwrap()).unwrap();
        integrator != "event-driven" || scene.contact_law().friction.info().is_constant()
    };
    files.filter(is_taken).collect()
}

/// The folder of an integrator's FMUs, which are made once for all tests.
fn fmus(integrator: &str) -> PathBuf {
    static ARE_MADE: Mutex<Vec<String>> = Mutex::new(Vec::new());
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fmpy").join(integrator);
    let mut made = ARE_MADE.lock().expect("another test could not export");
    if !made.iter().any(|name| name == integrator) {
        export(integrator, &folder);
        made.push(integrator.to_owned());
    }
    folder
}

/// Writes `set1.fmu` and so on, of all built-in scenes and those of single effects, into a folder that has nothing else.
fn export(integrator: &str, folder: &Path) {
    if folder.exists() {
        std::fs::remove_dir_all(folder).expect("what an earlier run has left can be removed");
    }
    std::fs::create_dir_all(folder).expect("a folder can be made there");
    let builtin = BUILTIN.iter().map(|scene| OsString::from(scene.name));
    for scene in builtin.chain(effects(integrator).into_iter().map(PathBuf::into_os_string)) {
        let name = Path::new(&scene).file_stem().expect("it has a name");
        let file = folder.join(name).with_extension("fmu");
        let mut export = Command::new(AMONTONS);
        export.arg("export").arg(scene).args(["--integrator", integrator, "-o"]).arg(file);
        if integrator == "event-driven" {
            // Long ones do as well; the tests want many.
            export.args(["--step", "1e-5"]);
        }
        // The FMUs carry no date, whatever builds them.
        succeed(export.env_remove("SOURCE_DATE_EPOCH"));
    }
}

fn succeed(command: &mut Command) {
    let Output { status, stdout, stderr } =
        command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    assert!(
        status.success(),
        "{command:?}: {status}\n{}{}",
        String::from_utf8_lossy(&stdout),
        String::from_utf8_lossy(&stderr),
    );
}

#[test]
fn fmpy_finds_no_problems() {
    pytest("test_validate.py");
}

#[test]
fn the_model_description_holds_what_validators_do_not_look_at() {
    pytest("test_model_description.py");
}

#[test]
fn the_archive_is_one_that_every_importer_can_read() {
    pytest("test_archive.py");
}

#[test]
fn the_library_exports_all_functions_of_co_simulation() {
    pytest("test_library.py");
}

#[test]
fn an_fmu_gives_the_doubles_of_the_program() {
    pytest("test_doubles.py");
}

#[test]
fn inputs_and_signals_give_the_doubles_of_the_program() {
    pytest("test_inputs.py");
}

#[test]
fn roles_are_those_that_the_scene_gives() {
    pytest("test_roles.py");
}

#[test]
fn the_files_of_a_cross_check_lead_fmpy_to_their_doubles() {
    pytest("test_cross_check.py");
}

#[test]
fn communication_steps_do_not_change_the_doubles() {
    pytest("test_communication_steps.py");
}

#[test]
fn saved_states_lead_to_the_same_doubles() {
    pytest("test_state.py");
}

#[test]
fn derivatives_for_coupling_are_those_of_differences() {
    pytest("test_derivatives.py");
}

#[test]
fn the_importers_tolerance_chooses_where_the_scene_leaves_it_to_it() {
    pytest("test_tolerance.py");
}

#[test]
fn instances_do_not_disturb_each_other() {
    pytest("test_instances.py");
}

#[test]
fn what_makes_no_sense_is_refused_with_a_reason() {
    pytest("test_refusals.py");
}

#[test]
fn a_step_that_fails_says_where_and_why_and_the_instance_comes_back() {
    pytest("test_failures.py");
}

#[test]
fn what_a_run_needs_and_its_scene_leaves_out_is_warned_of_once() {
    pytest("test_warnings.py");
}

#[test]
fn resources_are_found_however_an_importer_names_them() {
    pytest("test_resources.py");
}

#[test]
fn the_paper_is_seen_through_an_importer() {
    pytest("test_physics.py");
}

/// A file of tests that nothing here runs would hold nothing.
#[test]
fn every_python_file_is_run() {
    let source = include_str!("fmpy.rs");
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join("fmpy");
    for entry in std::fs::read_dir(folder).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if name.starts_with("test_") {
            assert!(source.contains(&format!("pytest({name:?})")), "{name}");
        }
    }
}
