//! Scenes with superelements: from matrix files into an FMU, and the scene that its library reads.

use amontons::scene::{Scene, Source};
use amontons::simulation::{Simulation, fingerprint};
use amontons::stability::Spectrum;
use amontons_analysis::stability::Linearised;
use amontons_export::package::fmu;
use amontons_export::scene::read;
use std::fmt::Write;
use std::fs;
use std::io::{Cursor, Read};
use std::path::Path;

/// A symmetric matrix in Matrix Market's format.
fn matrix_market(rows: &[[f64; 3]; 3]) -> String {
    let mut text = "%%MatrixMarket matrix array real general\n3 3\n".to_owned();
    for column in 0..3 {
        rows.iter().for_each(|row| writeln!(text, "{:e}", row[column]).unwrap());
    }
    text
}

/// A pad of 2 kg on a stiff holder with one mode of its own, in N, mm, t and s or in SI units: displacements x and y of node 7, and a
/// modal coordinate.
fn folder(units: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).unwrap();
    // Tonnes and N/mm of what is given in kg and N/m; the modal coordinate has the unit √kg m or √t mm.
    let (kilogram, coupling) =
        if units == "N-mm-t-s" { (1e-3, f64::sqrt(1e-3)) } else { (1.0, 1.0) };
    let couple = 0.3 * coupling;
    let mass =
        [[2.0 * kilogram, 0.0, couple], [0.0, 2.0 * kilogram, -couple], [couple, -couple, 1.0]];
    let stiffness = [
        [2e6 * kilogram, -5e5 * kilogram, 0.0],
        [-5e5 * kilogram, 3e6 * kilogram, 0.0],
        [0.0, 0.0, 4e6],
    ];
    let put = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    fs::create_dir(folder.path().join("pad")).unwrap();
    put("pad/mass.mtx", &matrix_market(&mass));
    put("pad/stiffness.mtx", &matrix_market(&stiffness));
    put("pad/freedoms.csv", "node,direction\n7,1\n7,2\n8,0\n");
    put(
        "brake.toml",
        &format!(
            r#"
slider = {{ velocity = 0.1, angle = 0.0 }}
friction = {{ coefficient = 0.3 }}
integrator = {{ method = "event-driven", step = 1e-4 }}
experiment = {{ stop_time = 0.01, output_interval = 1e-3 }}
# The pad.
[[superelement]]
name = "pad"
folder = "pad"
units = "{units}"
damping_ratio = 0.01
[[contact]]
name = "face"
mass = "pad.7"
normal = [0.0, 1.0, 0.0]
tangent = [1.0, 0.0, 0.0]
[[load]]
superelement = "pad"
nodes = [7]
force = [0.0, -10.0, 0.0]
[[initial]]
node = "pad.7"
vx = 0.02
[outputs]
nodes = ["pad.7"]
"#
        ),
    );
    folder
}

fn brake(folder: &tempfile::TempDir) -> (Scene, Source) {
    read(&folder.path().join("brake.toml")).unwrap_or_else(|error| panic!("{error}"))
}

fn at_end(scene: &Scene) -> Vec<f64> {
    let mut simulation = Simulation::new(scene.clone(), 0.0).unwrap();
    simulation.advance_to(0.01).unwrap();
    let forces = simulation.contact_forces().unwrap()[0];
    let [x, y] = [0, 1].map(|dof| simulation.displacement()[dof]);
    vec![x, y, simulation.velocity()[0], forces.normal_force, forces.friction_force]
}

#[test]
fn a_superelement_in_millimetres_moves_as_that_in_metres() {
    let [millimetres, metres] = ["N-mm-t-s", "N-m-kg-s"].map(folder);
    let scenes = [&millimetres, &metres].map(|folder| brake(folder).0);
    let found = scenes.each_ref().map(at_end);
    for (a, b) in found[0].iter().zip(&found[1]) {
        assert!((a - b).abs() <= 1e-9 * b.abs(), "{found:?}");
    }
    assert!(found[0][0] < -1e-5, "{found:?}");
    let spectra = scenes.each_ref().map(|scene| {
        let here = Linearised::of(scene);
        Spectrum::of(here.linear().unwrap(), &here.uniform_sliding().unwrap()).unwrap()
    });
    let [a, b] = &spectra;
    assert_eq!(a.oscillating.len(), b.oscillating.len());
    for (a, b) in a.oscillating.iter().zip(&b.oscillating) {
        assert!((a - b).norm() < 1e-10 * b.norm(), "{spectra:?}");
    }
}

/// Unpacks the resources of an FMU.
fn resources(fmu: Vec<u8>, folder: &Path) -> String {
    let mut archive = zip::ZipArchive::new(Cursor::new(fmu)).unwrap();
    let names: Vec<String> = archive.file_names().map(|name| name.unwrap().into_owned()).collect();
    for name in names {
        let mut bytes = Vec::new();
        archive.by_name(&name).unwrap().read_to_end(&mut bytes).unwrap();
        if let Some(name) = name.strip_prefix("resources/") {
            fs::write(folder.join(name), bytes).unwrap();
        } else if name == "modelDescription.xml" {
            fs::write(folder.join(name), bytes).unwrap();
        }
    }
    fs::read_to_string(folder.join("modelDescription.xml")).unwrap()
}

#[test]
fn an_fmu_carries_the_packed_matrices_and_reads_the_same_scene_from_them() {
    let folder = folder("N-mm-t-s");
    let (scene, source) = brake(&folder);
    assert_eq!(source.binaries[0].0, "pad.superelement");
    assert!(source.text.contains("file = \"pad.superelement\""), "{}", source.text);
    assert!(
        source.text.contains("# The pad.") && !source.text.contains("units"),
        "{}",
        source.text
    );
    let unpacked = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).unwrap();
    let description = resources(fmu(&scene, &source, None, &[]).unwrap(), unpacked.path());
    // As the library of the FMU reads it, without a reader of matrix files.
    let (again, carried) = amontons::scene::read(&unpacked.path().join("scene.toml")).unwrap();
    assert_eq!(Scene { name: scene.name.clone(), ..again }, scene);
    assert_eq!(carried, source);
    assert!(description.contains(&fingerprint(&carried)), "{description}");
    // With another matrix, another FMU: a library of one refuses the description of the other.
    let mut other = source.clone();
    other.binaries[0].1[60] ^= 1;
    assert_ne!(fingerprint(&other), fingerprint(&source));
}

#[test]
fn a_damping_ratio_above_one_stays_known_for_a_warning() {
    let folder = folder("N-m-kg-s");
    let overdamped = |ratio: &str| {
        let path = folder.path().join("brake.toml");
        let text = fs::read_to_string(&path).unwrap();
        fs::write(&path, text.replace("damping_ratio = 0.01", ratio)).unwrap();
        let network = brake(&folder).0.network().unwrap().clone();
        fs::write(&path, text).unwrap();
        network.superelements[0].overdamped
    };
    assert_eq!(overdamped("damping_ratio = 1.0"), None);
    assert_eq!(overdamped("damping_ratio = [0.01, 2.0, 1.5]"), Some(2.0));
}
