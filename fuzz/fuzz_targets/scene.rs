//! Scene files of any bytes. Nothing panics, hangs or fills the memory; what is refused is refused by line or
//! key, and what is taken is checked, listed, described and, where it is small, run for a few steps.
#![no_main]

use amontons::scene::{Scene, Selection};
use amontons::simulation::catalogue::{Causality, fmu_variables};
use amontons::simulation::{Simulation, variables};
use amontons_export::package::model_description;
use amontons_export::scene::{parse, read};
use libfuzzer_sys::fuzz_target;
use std::path::PathBuf;
use std::sync::OnceLock;

/// Scenes of up to this many degrees of freedom and contacts are run.
const MOST_DOFS: usize = 32;
const MOST_CONTACTS: usize = 6;
/// And those of up to this many are described, which is a matter of a hundred bytes a variable.
const MOST_DESCRIBED: usize = 2_000;
const STEPS: i32 = 20;

fuzz_target!(|bytes: &[u8]| {
    let scene = match std::str::from_utf8(bytes) {
        Ok(text) => parse("any", text),
        // What is no text is for the reader of files to refuse.
        Err(_) => read_file(bytes),
    };
    match scene {
        Err(error) => assert!(names_a_place(&error.to_string()), "{error}"),
        Ok(scene) => use_scene(scene, bytes),
    }
});

fn read_file(bytes: &[u8]) -> Result<Scene, amontons::Error> {
    static PATH: OnceLock<PathBuf> = OnceLock::new();
    let path = PATH.get_or_init(|| {
        let folder = std::env::temp_dir().join(format!("amontons-fuzz-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("there is a folder for temporary files");
        folder.join("any.toml")
    });
    std::fs::write(path, bytes).expect("it can be written to");
    read(path).map(|(scene, _)| scene)
}

/// Does the message say where: by file, line and column, or that the file as a whole is none?
fn names_a_place(message: &str) -> bool {
    let mut after = message.match_indices(':').map(|(at, _)| &message[at + 1..]);
    let is_line = |rest: &str| rest.starts_with(|c: char| c.is_ascii_digit());
    after.any(is_line) || message.contains("not a text file") || message.contains("UTF-16")
}

fn use_scene(mut scene: Scene, bytes: &[u8]) {
    // Whoever parses has checked; the check that a simulation makes says the same.
    scene.check().expect("a scene that was read is possible");
    let (dofs, contacts) = (scene.external_forces().count(), scene.contact_count());
    if dofs + contacts > MOST_DESCRIBED {
        return;
    }
    let all = variables(&scene);
    let text = String::from_utf8_lossy(bytes);
    let xml = model_description(&scene, &(&*text).into(), None);
    let described = xml.matches("<ScalarVariable ").count();
    assert!(described == fmu_variables(&scene).len(), "each variable is described");
    if dofs > MOST_DOFS || contacts > MOST_CONTACTS {
        return;
    }
    if scene.selection != Selection::Given {
        // How far ahead a choice has to look is the scene's wish.
        let most = 1e6 * scene.experiment.output_interval;
        scene.experiment.stop_time = scene.experiment.stop_time.min(most);
    }
    let mut simulation = match Simulation::new(scene, 0.0) {
        Ok(simulation) => simulation,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    let step = simulation.scene().step;
    for count in 1..=STEPS {
        if let Err(error) = simulation.advance_to(f64::from(count) * step) {
            return assert!(error.to_string().contains(" s"), "no time: {error}");
        }
        assert!(
            simulation.displacement().iter().chain(simulation.velocity()).all(|x| x.is_finite())
        );
        for variable in &all {
            let value = simulation.read(variable);
            if variable.causality != Causality::Output {
                assert!(value.expect("a given value can be read").is_finite());
            }
        }
    }
}
