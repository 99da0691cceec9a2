//! Libraries that break one rule by what they do in a run.

use super::fmu::{Files, assert_breaks, check, check_with, library, rules, with_library};
use std::collections::BTreeSet;

#[test]
fn each_fault_of_a_run_is_found_by_its_rule_alone() {
    for (rule, fault, words) in [
        ("load", "load", "TLS"),
        ("types-platform", "types", "standard32"),
        ("version", "version", "2.1"),
        ("instantiate", "refuses", "the licence is missing"),
        ("wrong-guid", "guid", "guid"),
        ("null-callbacks", "null", "NULL"),
        ("resource-location", "location", "resource location file:/…/fmu/resources"),
        ("resource-location", "space", "%20"),
        ("call-failed", "fails", "no convergence"),
        ("call-failed", "fatal", "fmi2DoStep at 0 s returns fmi2Fatal"),
        (
            "start-differs",
            "start",
            "rate is 0.75 after initialization, but its start value is 0.25",
        ),
        ("output-not-finite", "nan", "x is NaN at 0.25 s"),
        ("reset-differs", "reset", "after fmi2Reset after fmi2Terminate, x is "),
        ("state-differs", "state", "x is "),
        ("serialized-state-differs", "serialized", "x is "),
        ("call-failed", "unreadable", "fmi2GetReal of der(x) returns fmi2Error"),
        (
            "call-failed",
            "steps",
            "fmi2DoStep at 0.0625 s returns fmi2Error; its last log message: the step",
        ),
        ("output-not-finite", "follows", "if inputs have other values in every second step"),
        (
            "call-failed",
            "boolean",
            "fmi2GetBoolean of moving returns the value -1, which is neither",
        ),
        ("call-failed", "kills", "fmi2SetReal returns fmi2Fatal with another value of rate set"),
        ("value-lost", "only_first", ", and no later call set it"),
        ("reset-differs", "reset_value", "after fmi2Reset after a step with other values, x is "),
        ("state-differs", "state_input", "whose step 1 is step 6 of the first run, x is "),
        ("state-differs", "state_rate", "whose step 1 is step 6 of the first run, x is "),
        ("free-state", "free_no_state", "crashes during fmi2FreeFMUstate of NULL (SIGSEGV)"),
        ("free-state", "pointer", "does not set the pointer"),
        ("process-settings", "folder", "changes the working folder of the process from /"),
        ("memory-growth", "files", "the number of open files grows by 1"),
        (
            "value-lost",
            "value",
            "rate is 0.25, although fmi2SetReal accepted 0.2525 after the first step",
        ),
        (
            "refusal-silent",
            "silent",
            "fmi2SetReal returns fmi2Error with another value of rate set before",
        ),
        ("reset-differs", "reset_phase", "after fmi2Reset in the initialization, x is "),
        ("instances-differ", "shared", "two instances that take turns, x is "),
        ("instances-differ", "second", "the second instance of a process, x is "),
        ("logging-differs", "logged", "x is "),
        ("array-bounds", "array", "fmi2GetReal with arrays that end at memory without access"),
        ("array-bounds", "references", "references and values to set can only be read"),
        ("floating-point-mode", "rounding", "fmi2DoStep at 0 s changes how floating point"),
        ("signal-handlers", "handler", "fmi2Instantiate changes who handles SIGFPE"),
        ("writes-files", "file", "notes.txt"),
        ("memory-growth", "leak", "grows by 1"),
        ("memory-growth", "leak_pages", "grows by 8192"),
        ("prints", "prints", "hello \\u{1b}[31m from"),
        ("crash", "crash", "fmi2DoStep at 0 s (SIGSEGV)"),
        ("crash", "crash_at_load", "loading of the library (SIGABRT)"),
        ("crash", "crash_at_exit", "unloading of the library (SIGABRT)"),
        ("free-null", "free_null", "fmi2FreeInstance(NULL)"),
        ("crash", "null_crash", "NULL for the memory callbacks"),
        ("exit", "exit", "fmi2DoStep at 0 s (exit code 3)"),
        ("leaves-processes", "fork", "leaves a process"),
        ("leaves-processes", "daemon", "leaves a process"),
    ] {
        let flag = format!("-DFAULT_{fault}");
        let fmu = with_library(library(&[&flag]));
        // A difference after restoring a state may also come from its serialized copy.
        let fmu = if fault.starts_with("state") {
            fmu.edit(" canSerializeFMUstate=\"true\"", "")
        } else {
            fmu
        };
        let printed = assert_breaks(rule, &fmu.pack(), &[]);
        assert!(printed.contains(words), "{fault}: {printed}");
        assert_eq!(printed.lines().count(), 1, "{printed}");
    }
}

/// The model with its derivative as an output, which follows the input at once, and with a capability flag.
fn with_ability(flags: &[&str], ability: &str) -> Files {
    with_library(library(flags))
        .edit("<CoSimulation ", &format!("<CoSimulation {ability} "))
        .edit(
            r#"name="der(x)" valueReference="2" causality="local""#,
            r#"name="der(x)" valueReference="2" causality="output""#,
        )
        .edit(
            r#"<Unknown index="6"/>
      <Unknown index="8" dep"#,
            r#"<Unknown index="3" dependencies="2 4"/>
      <Unknown index="6"/>
      <Unknown index="8" dep"#,
        )
}

#[test]
fn a_promised_derivative_is_that_of_the_outputs_and_changes_nothing() {
    for (rule, fault, ability, words) in [
        (
            "directional-derivative",
            "directional",
            "providesDirectionalDerivative",
            "der(x) by module[1].u is stated as 0.275",
        ),
        (
            "directional-derivative",
            "direction",
            "providesDirectionalDerivative",
            "in a direction of all its inputs is 0.25; the derivatives by each of them give 0.5",
        ),
        (
            "output-derivative",
            "output_derivative",
            "maxOutputDerivativeOrder",
            "the output x by time",
        ),
        ("input-derivative", "input_derivative", "canInterpolateInputs", "that are zero, x is "),
    ] {
        let value = if ability.starts_with("max") { "1" } else { "true" };
        let ability = format!("{ability}=\"{value}\"");
        assert_eq!(
            check(&with_ability(&[], &ability).pack(), &[]),
            (0, String::new()),
            "{ability}"
        );
        let fmu = with_ability(&[&format!("-DFAULT_{fault}")], &ability);
        let printed = assert_breaks(rule, &fmu.pack(), &[]);
        assert!(printed.contains(words), "{fault}: {printed}");
        assert_eq!(printed.lines().count(), 1, "{printed}");
    }
}

/// All capability flags of co-simulation that are not in the model's description.
const ABILITIES: &str = r#"providesDirectionalDerivative="true" maxOutputDerivativeOrder="1" canInterpolateInputs="true""#;

#[test]
fn no_call_is_made_that_the_state_machine_forbids() {
    for flags in [
        &["-DSTRICT"][..],
        // A library may refuse a value, at once or in a step, if it says why.
        &["-DSTRICT", "-DREFUSES"],
        &["-DSTRICT", "-DREFUSES_INPUT"],
        &["-DSTRICT", "-DREFUSES_STEP"],
        // It may keep its own value if it warns.
        &["-DSTRICT", "-DCLAMPS"],
        // It may end its run.
        &["-DSTRICT", "-DDISCARDS"],
    ] {
        let (code, printed) = check(&with_ability(flags, ABILITIES).pack(), &[]);
        let findings = printed.lines().filter(|line| !line.starts_with("note: ")).count();
        assert_eq!((code, findings), (0, 0), "{flags:?}: {printed}");
    }
}

#[test]
fn what_the_standard_allows_is_no_fault() {
    // A helper process may outlive the library briefly.
    let fmu = with_library(library(&["-DBRIEF_HELPER"]));
    assert_eq!(check(&fmu.pack(), &[]), (0, String::new()));
    // Parameters and inputs need not be readable before initialization ends.
    let fmu = with_library(library(&["-DSTRICT_MODES"]));
    assert_eq!(check(&fmu.pack(), &[]), (0, String::new()));
    // An enumeration may be held to one of its items.
    let one = r#"<Enumeration declaredType="Mode" min="2" max="2" start="2"/>"#;
    let fmu = with_library(library(&["-DSTRICT", "-DMODES"]))
        .edit(r#"<Enumeration declaredType="Mode" start="2"/>"#, one);
    assert_eq!(check(&fmu.pack(), &[]), (0, String::new()));
}

#[test]
fn runs_of_a_model_that_is_random_are_not_compared() {
    for flag in ["-DRANDOM", "-DRANDOM_UNSEEDED"] {
        let (code, printed) = check(&with_library(library(&[flag])).pack(), &[]);
        assert_eq!((code, printed.lines().count()), (0, 1), "{flag}: {printed}");
        assert!(printed.starts_with("note: each process gives other outputs"), "{printed}");
    }
}

#[test]
fn an_fmu_of_one_instance_a_process_is_tried_in_many_processes() {
    let once = r#"<CoSimulation canBeInstantiatedOnlyOncePerProcess="true" "#;
    let fmu = with_library(library(&["-DFAULT_shared"])).edit("<CoSimulation ", once);
    let (code, printed) = check(&fmu.pack(), &[]);
    assert_eq!((code, printed.lines().count()), (0, 1), "{printed}");
    assert!(printed.starts_with("note: canBeInstantiatedOnlyOncePerProcess"), "{printed}");
    // With all that its flags promise, of which none needs a second instance.
    let fmu = with_ability(
        &["-DSTRICT", "-DONCE"],
        &format!("{ABILITIES} canBeInstantiatedOnlyOncePerProcess=\"true\""),
    );
    let (code, printed) = check(&fmu.pack(), &[]);
    assert_eq!((code, printed.lines().count()), (0, 1), "{printed}");
    // Two runs of one instance, however, are tried.
    let fmu = with_library(library(&["-DFAULT_reset_phase"])).edit("<CoSimulation ", once);
    let (_, printed) = check(&fmu.pack(), &[]);
    assert!(printed.starts_with("defect: reset-differs"), "{printed}");
}

#[test]
#[ignore = "needs valgrind"]
fn valgrind_finds_what_no_run_shows() {
    let (code, printed) = check_with(&with_library(library(&["-DFAULT_unset"])).pack(), &[]);
    assert_eq!(rules(&printed), BTreeSet::from(["memory-errors"]), "{printed}");
    assert!(
        printed.contains("in fmi2DoStep: Conditional jump or move depends on uninit"),
        "{printed}"
    );
    assert_eq!((code, printed.lines().count()), (3, 1), "{printed}");
    let sound = with_library(library(&[])).pack();
    assert_eq!(check_with(&sound, &[]), (0, String::new()));
}

#[test]
fn a_library_that_does_not_come_back_is_ended() {
    let fmu = with_library(library(&["-DFAULT_hang"])).pack();
    let printed = assert_breaks("time-limit", &fmu, &["--timeout", "1"]);
    assert!(
        printed.contains("does not finish within 1 s; stopped during fmi2DoStep at 0 s"),
        "{printed}"
    );
}

#[test]
#[ignore = "fills 2 GiB of memory"]
fn a_library_that_takes_all_memory_is_ended() {
    let printed =
        assert_breaks("memory-limit", &with_library(library(&["-DFAULT_memory"])).pack(), &[]);
    assert!(printed.contains("2 GiB"), "{printed}");
}
