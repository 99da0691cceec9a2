//! Modes of a scene of two superelements on their meshes. Both are one bar, in N, mm, t and s and in SI units; all modes are kept, so that
//! the superelements are exact.

use crate::program::{assert_refused, folder, run, text};
use nalgebra::{Complex, DMatrix, DVector};
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::Output;

/// Nodes 1 to 5 of the bar stand on the x-axis; the bar is held before node 1.
const NODES: usize = 5;
const NAMES: [&str; 2] = ["millimetres", "metres"];
/// Distance of the nodes, and width of the mesh, m.
const SIDES: [f64; 2] = [0.02, 0.01];
/// Stiffness of the springs between neighbours along x, y and z, N/m.
const SPRINGS: [f64; 3] = [3e5, 5.3e5, 1e5];
/// A spring of this stiffness (N/m) stretches with the difference of nodes 5 and 4 along z less this lever (m) times the rotation of node
/// 5 about y, which has this inertia (kg m²).
const LEVER: [f64; 3] = [4e4, 0.03, 7e-5];
/// The spring between both bars along z, N/m.
const BETWEEN: f64 = 2e4;

const SCENE: &str = r#"
slider = { velocity = 0.1, angle = 0.0 }
friction = { coefficient = 0.3 }
integrator = { method = "event-driven", step = 1e-4 }
[[superelement]]
name = "millimetres"
folder = "mm"
units = "N-mm-t-s"
[[superelement]]
name = "metres"
folder = "m"
[[spring]]
name = "between"
between = ["millimetres.5", "metres.5"]
direction = "z"
stiffness = 2e4
[[contact]]
name = "face"
mass = "millimetres.5"
normal = [0.0, 1.0, 0.0]
tangent = [1.0, 0.0, 0.0]
[[load]]
superelement = "millimetres"
nodes = [5]
force = [0.0, -10.0, 0.0]
"#;

/// Stiffness and mass of a bar by rows: x, y and z of each node, then the rotation. Lengths in `length` m, masses in `mass` kg.
fn bar(length: f64, mass: f64) -> [DMatrix<f64>; 2] {
    let size = 3 * NODES + 1;
    let (mut k, mut m) = (DMatrix::zeros(size, size), DMatrix::zeros(size, size));
    let mut stretch = |stiffness: f64, parts: &[(usize, f64)]| {
        for (i, a) in parts {
            for (j, b) in parts {
                k[(*i, *j)] += stiffness / mass * a * b;
            }
        }
    };
    for node in 0..NODES {
        for (axis, stiffness) in SPRINGS.into_iter().enumerate() {
            let row = 3 * node + axis;
            let both = [(row, 1.0), (row.wrapping_sub(3), -1.0)];
            stretch(stiffness, if node == 0 { &both[..1] } else { &both });
            m[(row, row)] = (0.1 + 0.02 * node as f64) / mass;
        }
    }
    let [stiffness, lever, inertia] = LEVER;
    let z = 3 * NODES - 1;
    stretch(stiffness, &[(z, 1.0), (z - 3, -1.0), (z + 1, -lever / length)]);
    m[(z + 1, z + 1)] = inertia / (mass * length * length);
    [k, m]
}

fn matrix_market(matrix: &DMatrix<f64>) -> String {
    let mut text = format!(
        "%%MatrixMarket matrix array real general\n{} {}\n",
        matrix.nrows(),
        matrix.ncols()
    );
    matrix.iter().for_each(|value| writeln!(text, "{value:e}").unwrap());
    text
}

/// The mesh: shells beside the axis, whose other side is held.
fn mesh(length: f64) -> String {
    let mut text = String::from("*NODE\n");
    let [along, across] = SIDES.map(|side| side / length);
    for node in 1..=NODES {
        let x = along * node as f64;
        text += &format!("{node}, {x}, 0, 0\n{}, {x}, {across}, 0\n", node + 10);
    }
    text += "*ELEMENT, TYPE=S4\n";
    for node in 1..NODES {
        text += &format!("{node}, {node}, {}, {}, {}\n", node + 1, node + 11, node + 10);
    }
    text
}

/// A folder with both superelements, their meshes and the scene.
fn bars(more: &str) -> tempfile::TempDir {
    let folder = folder();
    let put = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    put("bars.toml", &format!("{SCENE}{more}"));
    let mut rows = String::from("node,direction\n");
    (1..=NODES).for_each(|node| rows += &format!("{node},1\n{node},2\n{node},3\n"));
    put("rows.csv", &(rows + "5,5\n"));
    for (name, [length, mass]) in [("mm", [1e-3, 1e3]), ("m", [1.0, 1.0])] {
        let [k, m] = bar(length, mass);
        put("k.mtx", &matrix_market(&k));
        put("m.mtx", &matrix_market(&m));
        put(&format!("{name}.inp"), &mesh(length));
        let files = ["--stiffness", "k.mtx", "--mass", "m.mtx", "--freedoms", "rows.csv"];
        let rest = ["--contacts", "5", "--frequency", "100", "--modes-to", "1e4", "--shapes"];
        let all = [&["reduce"], &files[..], &rest, &["-o", name]].concat();
        let output = run(env!("CARGO_BIN_EXE_amontons"), folder.path(), &all);
        assert!(output.status.success(), "{}", text(&output.stderr));
        assert!(
            text(&output.stdout).contains("4 retained and 12 modes"),
            "{}",
            text(&output.stdout)
        );
    }
    folder
}

const MESHES: [&str; 4] = ["--mesh", "millimetres=mm.inp", "--mesh", "metres=m.inp"];

fn modes(folder: &Path, arguments: &[&str]) -> Output {
    let all = [&["modes", "bars.toml"], arguments].concat();
    run(env!("CARGO_BIN_EXE_amontons-stability"), folder, &all)
}

fn printed(folder: &Path, arguments: &[&str]) -> String {
    let output = modes(folder, arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    text(&output.stdout)
}

/// The numbers of an array of a file of VTK.
fn array(file: &str, name: &str) -> Vec<f64> {
    let (_, rest) = file.split_once(&format!("Name=\"{name}\"")).unwrap();
    let (_, rest) = rest.split_once('>').unwrap();
    let (inside, _) = rest.split_once('<').unwrap();
    inside.split_whitespace().map(|number| number.parse().unwrap()).collect()
}

/// A mode in a folder for ParaView: its frequency and its number, and of each superelement places and complex amplitudes.
struct Shown {
    frequency: f64,
    number: String,
    places: [Vec<f64>; 2],
    motion: [Vec<Complex<f64>>; 2],
}

fn shown(folder: &Path) -> Vec<Shown> {
    let list = fs::read_to_string(folder.join("modes.pvd")).unwrap();
    let lines: Vec<&str> = list.lines().filter(|line| line.contains("<DataSet")).collect();
    let read = |pair: &[&str]| {
        let key = |line: &str, key: &str| {
            let (_, rest) = line.split_once(&format!(" {key}=\"")).unwrap();
            rest.split_once('"').unwrap().0.to_owned()
        };
        let frequency = key(pair[0], "timestep");
        let number = key(pair[0], "file")[5..8].to_owned();
        let files = [0, 1].map(|part| {
            assert_eq!(key(pair[part], "timestep"), frequency);
            assert_eq!(key(pair[part], "part"), part.to_string());
            let file = key(pair[part], "file");
            assert_eq!(file, format!("mode_{number}_{}.vtu", NAMES[part]));
            fs::read_to_string(folder.join(file)).unwrap()
        });
        let motion = files.each_ref().map(|file| {
            let [a, b] =
                ["displacement", "displacement_quarter_earlier"].map(|name| array(file, name));
            a.into_iter().zip(b).map(|(a, b)| Complex::new(a, b)).collect()
        });
        let places = files.each_ref().map(|file| array(file, "place"));
        Shown { frequency: frequency.parse().unwrap(), number, places, motion }
    };
    lines.chunks(2).map(read).collect()
}

/// Frequencies (Hz) and shapes of both bars along z, from their full matrices: z of nodes 1 to 5 and the rotation, twice.
fn along_z() -> Vec<(f64, DVector<f64>)> {
    let [k, m] = bar(1.0, 1.0);
    let rows = [2, 5, 8, 11, 14, 15];
    let size = rows.len();
    let both = |one: &DMatrix<f64>| {
        DMatrix::from_fn(2 * size, 2 * size, |i, j| {
            if i / size == j / size { one[(rows[i % size], rows[j % size])] } else { 0.0 }
        })
    };
    let (mut k, roots) = (both(&k), both(&m).map_diagonal(f64::sqrt));
    let ends = [4, 4 + size];
    for i in ends {
        for j in ends {
            k[(i, j)] += if i == j { BETWEEN } else { -BETWEEN };
        }
    }
    let scaled = DMatrix::from_fn(2 * size, 2 * size, |i, j| k[(i, j)] / (roots[i] * roots[j]));
    let eigen = scaled.symmetric_eigen();
    let shape = |column: usize| eigen.eigenvectors.column(column).component_div(&roots);
    let frequency = |value: f64| value.sqrt() / std::f64::consts::TAU;
    (0..2 * size).map(|column| (frequency(eigen.eigenvalues[column]), shape(column))).collect()
}

/// Retained displacements, a retained rotation and modal coordinates, in two systems of units, add up to the motion of the full matrices.
#[test]
fn nodes_move_as_the_eigenvectors_of_the_full_matrices_say() {
    let folder = bars("");
    printed(folder.path(), &[&MESHES[..], &["--vtk", "vtk"]].concat());
    let shown = shown(&folder.path().join("vtk"));
    // 16 degrees of freedom each, one of which the contact holds.
    assert_eq!(shown.len(), 31);
    let extent = f64::hypot(4.0 * SIDES[0], SIDES[1]);
    for (frequency, shape) in along_z() {
        let close = |mode: &&Shown| (mode.frequency - frequency).abs() < 1e-6 * frequency;
        let found: Vec<&Shown> = shown.iter().filter(close).collect();
        let &[mode] = &found[..] else { panic!("{} modes at {frequency} Hz", found.len()) };
        for places in &mode.places {
            let expected = (0..30).map(|at| {
                [SIDES[0] * (at % 15 / 3 + 1) as f64, if at < 15 { 0.0 } else { SIDES[1] }, 0.0]
                    [at % 3]
            });
            assert!(places.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{places:?}");
        }
        let all = mode.motion.concat();
        let largest = all.iter().map(|value| value.norm()).fold(0.0, f64::max);
        assert!((largest - 0.05 * extent).abs() < 1e-12, "a twentieth of the extent: {largest}");
        let expected: Vec<f64> = (0..60)
            .map(|at| match (at / 30, at % 30 / 3, at % 3) {
                (part, node @ ..NODES, 2) => shape[6 * part + node],
                _ => 0.0,
            })
            .collect();
        let norm: f64 = expected.iter().map(|value| value * value).sum();
        let scale = all.iter().zip(&expected).map(|(a, b)| a * b).sum::<Complex<f64>>() / norm;
        for (found, expected) in all.iter().zip(&expected) {
            assert!((found - scale * expected).norm() < 1e-7 * largest, "{frequency} Hz: {all:?}");
        }
    }
}

/// With a damper at one bar the nodes do not move in phase.
#[test]
fn the_quarter_of_a_cycle_and_both_superelements_are_in_the_phase_of_the_printed_mode() {
    let damper = "[[damper]]\nname = \"d\"\nbetween = [\"metres.5\", \"ground\"]\ndirection = \"z\"\ndamping = 30.0\n";
    let folder = bars(damper);
    let all = printed(folder.path(), &[&MESHES[..], &["--vtk", "vtk"]].concat());
    let mut turned = 0;
    for mode in shown(&folder.path().join("vtk")) {
        let head = format!("\nmode {}: ", mode.number.trim_start_matches('0'));
        let (_, lines) = all.split_once(&head).unwrap();
        let ratios = [0, 1].map(|part| {
            let name = format!("superelement.{}.node[5].z", NAMES[part]);
            let (_, rest) = lines.split_once(&name).unwrap();
            let mut words = rest.split_whitespace();
            let amplitude: f64 = words.next().unwrap().parse().unwrap();
            let phase: f64 = words.next().unwrap().trim_end_matches('°').parse().unwrap();
            let printed = Complex::from_polar(amplitude, phase.to_radians());
            (printed, mode.motion[part][3 * (NODES - 1) + 2])
        });
        let [(a, _), (b, _)] = ratios;
        // Four digits and a tenth of a degree are printed.
        if a.norm() < 0.05 || b.norm() < 0.05 || ((a / b).im / (a / b).norm()).abs() < 0.1 {
            continue;
        }
        turned += 1;
        let [first, second] = ratios.map(|(printed, shown)| shown / printed);
        assert!(first.re > 0.0 && first.im.abs() < 0.01 * first.re, "{first}");
        assert!((first - second).norm() < 0.01 * first.re, "{first} and {second}");
    }
    assert!(turned > 0, "{all}");
}

#[test]
fn a_range_of_frequencies_chooses_modes_which_keep_their_numbers() {
    let folder = bars("");
    let all = printed(folder.path(), &[]);
    let parts: Vec<&str> = all.split("\nmode ").collect();
    let frequency = |part: &str| -> f64 {
        part.split_once(": ").unwrap().1.split_once(" Hz").unwrap().0.parse().unwrap()
    };
    let between = |a: usize, b: usize| 0.5 * (frequency(parts[a]) + frequency(parts[b]));
    let range = format!("{}:{}", between(6, 7), between(8, 9));
    let arguments = [&MESHES[..], &["--vtk", "vtk", "--frequencies", &range]].concat();
    let chosen = printed(folder.path(), &arguments);
    assert_eq!(chosen.trim_end(), [parts[0], parts[7], parts[8]].join("\nmode ").trim_end());
    let numbers: Vec<String> =
        shown(&folder.path().join("vtk")).into_iter().map(|mode| mode.number).collect();
    assert_eq!(numbers, ["007", "008"]);
    let (low, high) = (frequency(parts[7]), frequency(parts[8]));
    let empty = format!("{}:{}", low + 0.1 * (high - low), high - 0.1 * (high - low));
    let places = [format!("mode 7 at {low:.4} Hz"), format!("mode 8 at {high:.4} Hz")];
    let output = modes(folder.path(), &["--frequencies", &empty]);
    assert_refused(&output, 2, &["no mode of the state Sl", &places[0], &places[1]]);
    let ring = folder.path().join("none.svg");
    let ring = ring.to_str().unwrap();
    let set1 = ["modes", "set1", "--frequencies", "150:200", "--plot", ring];
    let output = run(env!("CARGO_BIN_EXE_amontons-stability"), folder.path(), &set1);
    let drawn = fs::read_to_string(ring).unwrap();
    let printed = text(&output.stdout);
    assert_eq!(drawn.matches(">Mode ").count(), printed.matches("\nmode ").count());
    assert!(drawn.matches(">Mode ").count() < 8, "{printed}");
}

#[test]
fn a_picture_shows_up_to_twelve_modes_on_all_meshes() {
    let folder = bars("");
    let output = modes(folder.path(), &[&MESHES[..], &["--plot", "modes.svg"]].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let note = text(&output.stderr);
    assert!(note.contains("12 of 31 modes are drawn") && note.contains("--frequencies"), "{note}");
    let picture = fs::read_to_string(folder.path().join("modes.svg")).unwrap();
    let title = |number: usize| picture.find(&format!("Mode {number}: "));
    assert!((1..=12).all(|number| title(number).is_some()) && title(13).is_none());
    let arguments = ["--mesh", "metres=m.inp", "--plot", "one.png", "--frequencies", "1:100"];
    printed(folder.path(), &arguments);
    assert!(fs::read(folder.path().join("one.png")).unwrap().starts_with(b"\x89PNG"));
}

#[test]
fn wrong_meshes_and_shapes_are_refused_with_the_remedy() {
    let folder = bars("");
    let path = folder.path();
    let refused = |arguments: &[&str], code: i32, words: &[&str]| {
        let output = modes(path, &[arguments, &["--vtk", "vtk"]].concat());
        assert_refused(&output, code, words);
        assert!(!path.join("vtk").exists());
    };
    let put = |name: &str, text: &str| fs::write(path.join(name), text).unwrap();
    refused(&["--mesh", "metre=m.inp"], 2, &["names metre", "did you mean metres?"]);
    refused(&["--mesh", "pad=m.inp"], 2, &["its superelements are millimetres, metres"]);
    refused(&["--mesh", "m.inp"], 2, &["NAME=FILE.inp"]);
    let twice = ["--mesh", "metres=m.inp", "--mesh", "metres=mm.inp"];
    refused(&twice, 2, &["given twice for the superelement metres"]);
    refused(&["--mesh", "metres=none.inp"], 1, &["none.inp", "cannot read the file"]);
    put("short.inp", "*NODE\n1, 0, 0\n2, 1, 0\n3, 0, 1\n*ELEMENT, TYPE=S3\n1, 1, 2, 3\n");
    refused(&["--mesh", "metres=short.inp"], 2, &["short.inp", "have node 4", "from 1 to 3"]);
    assert_refused(&modes(path, &MESHES), 2, &["--mesh alone", "--vtk DIR or --plot FILE"]);
    let plot = modes(path, &["--plot", "modes.svg"]);
    assert_refused(&plot, 2, &["--mesh NAME=FILE.inp", "millimetres, metres"]);
    let none = ["modes", "hoffmann", "--mesh", "pad=m.inp", "--plot", "modes.svg"];
    let output = run(env!("CARGO_BIN_EXE_amontons-stability"), path, &none);
    assert_refused(&output, 2, &["the scene has no superelement"]);

    let scene = |text: &str| put("bars.toml", text);
    let metres = ["--mesh", "metres=m.inp"];
    let single =
        "stiffness = \"m/stiffness.mtx\"\nmass = \"m/mass.mtx\"\nfreedoms = \"m/freedoms.csv\"";
    scene(&SCENE.replace("folder = \"m\"", single));
    refused(&metres, 2, &["metres has single files of matrices", "folder", "--shapes"]);
    scene(SCENE);
    let (_, source) = amontons_export::scene::read(&path.join("bars.toml")).unwrap();
    let (name, bytes) = &source.binaries[1];
    assert_eq!(name, "metres.superelement");
    fs::write(path.join(name), bytes).unwrap();
    scene(&SCENE.replace("folder = \"m\"", "file = \"metres.superelement\""));
    refused(&metres, 2, &["metres is a packed file", "--shapes"]);
    scene(SCENE);

    let rows = fs::read_to_string(path.join("m/shapes.csv")).unwrap();
    put("m/shapes.csv", rows.trim_end().rsplit_once('\n').unwrap().0);
    refused(&metres, 1, &["shapes.npy", "has 16 rows, and shapes.csv names 15"]);
    put("m/shapes.csv", &rows.replace("5,3", "6,3"));
    refused(&metres, 1, &["does not move node 5 by 1 in direction 3"]);
    fs::remove_file(path.join("m/shapes.npy")).unwrap();
    refused(&metres, 1, &["has no shapes.npy; run amontons reduce with --shapes"]);
}
