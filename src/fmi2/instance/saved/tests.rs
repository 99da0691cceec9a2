//! Forged saved instances: their bytes are well-formed, but their content is not.

use super::*;
use crate::fmi2::instance::{Number, SCENE_FILE};
use crate::fmi2::logger::Logger;
use crate::scene::builtin;
use crate::simulation::fingerprint;

fn instance() -> Instance {
    let folder = tempfile::tempdir().unwrap();
    let text = builtin("set1").unwrap().text;
    std::fs::write(folder.path().join(SCENE_FILE), text).unwrap();
    let made =
        Instance::new(folder.path(), &fingerprint(&text.into()), Logger::new(None, c"one", false));
    made.unwrap_or_else(|(error, _)| panic!("{error}"))
}

fn running() -> Instance {
    let mut instance = instance();
    instance.setup_experiment(None, 0.0, Some(1.0)).unwrap();
    instance.enter_initialization_mode().unwrap();
    instance.exit_initialization_mode().unwrap();
    instance.do_step(0.0, 1e-3).unwrap();
    instance
}

/// Result of reading an instance's own bytes with a change in them.
fn forged(instance: &Instance, change: impl FnOnce(&mut Setup)) -> Result<(), Error> {
    let bytes = instance.serialize(&instance.save()).unwrap();
    let mut record: Record = from_bytes(&bytes, &instance.guid).unwrap();
    change(&mut record.0);
    instance.deserialize(&to_bytes(&record, &instance.guid)).map(|_| ())
}

#[track_caller]
fn assert_refused(result: Result<(), Error>, words: &str) {
    let error = result.unwrap_err();
    assert!(error.is_saved_state() && error.to_string().contains(words), "{error}");
}

/// A phase that allows steps, without a motion to advance, once ended in a panic.
#[test]
fn a_phase_without_what_belongs_to_it_is_refused() {
    let (new, running) = (instance(), running());
    for phase in [Phase::StepComplete, Phase::Terminated] {
        assert_refused(forged(&new, |setup| setup.phase = phase), "without a motion");
        forged(&running, |setup| setup.phase = phase).unwrap();
    }
    for phase in [Phase::Instantiated, Phase::InitializationMode] {
        assert_refused(forged(&running, |setup| setup.phase = phase), "with a motion");
        forged(&new, |setup| setup.phase = phase).unwrap();
    }
    for instance in [&new, &running] {
        forged(instance, |setup| setup.phase = Phase::Error).unwrap();
        assert_refused(forged(instance, |setup| setup.phase = Phase::Poisoned), "Poisoned");
    }
}

/// A stop time that is not a number once let every step pass it.
#[test]
fn times_between_which_no_run_can_be_are_refused() {
    let running = running();
    for start in [f64::NAN, f64::INFINITY, 2.0] {
        assert_refused(forged(&running, |setup| setup.start_time = start), "start time");
    }
    for stop in [f64::NAN, -1.0] {
        assert_refused(forged(&running, |setup| setup.stop_time = Some(stop)), "stop time");
    }
    forged(&running, |setup| setup.stop_time = None).unwrap();
}

#[test]
fn a_reset_instance_is_as_good_as_a_new_one() {
    let (mut used, mut new) = (running(), instance());
    let beta = used.variables.iter().position(|variable| variable.name == "damping.beta").unwrap();
    used.set(u32::try_from(beta).unwrap(), 1e-4, Number::Real).unwrap();
    used.do_step(1e-3, 1e-3).unwrap();
    used.fail(false);
    used.reset();
    let saved = |instance: &Instance| instance.serialize(&instance.save()).unwrap();
    assert_eq!(saved(&used), saved(&new));
    assert!(!used.setup.is_experiment_set_up && used.last_successful_time() == 0.0);
    for instance in [&mut used, &mut new] {
        instance.setup_experiment(None, 0.0, None).unwrap();
        instance.enter_initialization_mode().unwrap();
        instance.exit_initialization_mode().unwrap();
        instance.do_step(0.0, 5e-3).unwrap();
    }
    assert_eq!(saved(&used), saved(&new));
}
