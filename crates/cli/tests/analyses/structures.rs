//! Matrices of finite-element programs through both programs, as their user meets them.

use crate::program::{assert_refused, folder, run, text};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Output;

/// A free block of hexahedra, whose matrices CalculiX has stored: its README says how.
const BLOCK: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../structures/tests/data/block");

fn reduce(folder: &Path, arguments: &[&str]) -> Output {
    let (stiffness, mass) = (format!("{BLOCK}.sti"), format!("{BLOCK}.mas"));
    let files = ["reduce", "--stiffness", &stiffness, "--mass", &mass];
    run(env!("CARGO_BIN_EXE_amontons"), folder, &[&files, arguments].concat())
}

fn matrices(folder: &Path, arguments: &[&str]) -> Output {
    let all = [&["matrices"], arguments].concat();
    run(env!("CARGO_BIN_EXE_amontons-stability"), folder, &all)
}

fn json(output: &Output) -> Value {
    assert!(output.status.success(), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn numbers<'a>(list: &'a Value, key: &'a str) -> Vec<f64> {
    list.as_array().unwrap().iter().map(|item| item[key].as_f64().unwrap()).collect()
}

/// Two masses of 1 kg; friction µ turns the normal motion of the second into a force on the first (Hoffmann's model), C = 0.2 M.
fn write_friction(folder: &Path, head: &str) {
    let file = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
    let general = "%%MatrixMarket matrix coordinate real general\n2 2";
    file("mass.mtx", &format!("{general} 2\n1 1 1\n2 2 1\n"));
    file("springs.mtx", &format!("{general} 4\n1 1 11\n1 2 -2\n2 1 -2\n2 2 20\n"));
    file("contact.mtx", &format!("{general} 1\n1 2 10\n"));
    let part = |matrix: &str, file: &str, more: &str| {
        format!("[[part]]\nmatrix = \"{matrix}\"\nfile = \"{file}.mtx\"\n{more}\n")
    };
    let parts = [
        head.to_owned(),
        part("mass", "mass", ""),
        part("damping", "mass", "factor = 0.2"),
        part("stiffness", "springs", ""),
        part("circulatory", "contact", "power = 1"),
    ];
    file("friction.toml", &parts.concat());
}

/// The written matrices are the certified ones: the other program finds the eigenvalues of the report in them.
#[test]
fn a_superelement_has_the_frequencies_of_its_certificate() {
    let folder = folder();
    let nodes = ["--contacts", "1,4,9,12", "--retain", "13:16"];
    let rest = ["--frequency", "20000", "--modes-to", "60000", "-o", "out", "--shapes"];
    let output = reduce(folder.path(), &[&nodes[..], &rest].concat());
    let printed = text(&output.stdout);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(printed.contains("6 of them are motions of a rigid body"), "{printed}");
    let certificate = fs::read_to_string(folder.path().join("out/certificate.json")).unwrap();
    let certificate: Value = serde_json::from_str(&certificate).unwrap();
    let free = &certificate["free"];
    assert!(free["is_complete"].as_bool().unwrap());
    assert_eq!(free["full_count"], free["superelement_count"]);
    let modes = &free["modes"];
    let own = numbers(modes, "superelement_hz");
    let files = ["--mass", "out/mass.mtx", "--stiffness", "out/stiffness.mtx"];
    let range = ["--growth=-100:100", "--frequency", "1000:20000", "--format", "json"];
    let found = json(&matrices(folder.path(), &[&files[..], &range].concat()));
    let value = &found["values"][0];
    assert_eq!(value["is_complete"], true);
    let elastic: Vec<f64> = own.into_iter().filter(|&frequency| frequency > 1000.0).collect();
    let again = numbers(&value["modes"], "frequency_hz");
    assert_eq!(elastic.len(), again.len());
    for (a, b) in elastic.iter().zip(&again) {
        assert!((a - b).abs() < 1e-8 * a, "{a} and {b}");
    }
    // No damping: nothing can be said of growth, and nothing is.
    assert!(value["modes"].as_array().unwrap().iter().all(|mode| mode["grows"].is_null()));
    let rows = fs::read_to_string(folder.path().join("out/freedoms.csv")).unwrap();
    let size = found["degrees_of_freedom"].as_u64().unwrap();
    assert_eq!(rows.lines().count() as u64, size + 1);
    assert!(rows.starts_with("node,direction\n1,1\n1,2\n1,3\n4,1\n"), "{rows}");
    // 72 rows, by columns, behind a header of 128 bytes.
    let shapes = fs::read(folder.path().join("out/shapes.npy")).unwrap();
    assert_eq!(shapes.len() as u64, 128 + 8 * 72 * size);
    let named = fs::read_to_string(folder.path().join("out/shapes.csv")).unwrap();
    assert!(named.starts_with("node,direction\n1,1\n1,2\n1,3\n2,1\n"), "{named}");
    assert_eq!(named.lines().count(), 72 + 1);
}

/// The mesh of the block: nodes from 1, along x first, then y, then z.
fn block_mesh() -> String {
    let mut deck = String::from("*NODE, NSET=ALL\n");
    for node in 0..24 {
        let [i, j, k] = [node % 4, node / 4 % 3, node / 12].map(f64::from);
        deck += &format!("{}, {}, {}, {}\n", node + 1, 0.2 * i / 3.0, 0.11 * j / 2.0, 0.03 * k);
    }
    deck += "*ELEMENT, TYPE=C3D8\n";
    for (element, lower) in [1, 2, 3, 5, 6, 7].into_iter().enumerate() {
        let face = [lower, lower + 1, lower + 5, lower + 4];
        let nodes = face.into_iter().chain(face.map(|node| node + 12));
        let nodes: Vec<String> = nodes.map(|node| node.to_string()).collect();
        deck += &format!("{}, {}\n", element + 1, nodes.join(", "));
    }
    deck
}

/// The numbers of an array of a file of VTK.
fn vtk_array(file: &str, name: &str) -> Vec<f64> {
    let (_, rest) = file.split_once(&format!("Name=\"{name}\"")).unwrap();
    let (_, rest) = rest.split_once('>').unwrap();
    let (inside, _) = rest.split_once('<').unwrap();
    inside.split_whitespace().map(|number| number.parse().unwrap()).collect()
}

/// A mode of a free body moves neither its centre of mass nor turns it, and the six modes before it are motions of a rigid body.
#[test]
fn modes_on_a_mesh_are_those_of_the_superelement() {
    let folder = folder();
    fs::write(folder.path().join("block.inp"), block_mesh()).unwrap();
    let nodes = ["--contacts", "1,4,9,12", "--retain", "13:16", "--frequency", "20000"];
    let rest = ["-o", "out", "--mesh", "block.inp", "--vtk", "modes", "--picture", "modes.png"];
    let output = reduce(folder.path(), &[&nodes[..], &rest].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let png = fs::read(folder.path().join("modes.png")).unwrap();
    assert!(png.starts_with(b"\x89PNG"));
    let list = fs::read_to_string(folder.path().join("modes/modes.pvd")).unwrap();
    let certificate = fs::read_to_string(folder.path().join("out/certificate.json")).unwrap();
    let certificate: Value = serde_json::from_str(&certificate).unwrap();
    let own = numbers(&certificate["free"]["modes"], "superelement_hz");
    assert_eq!(list.matches("<DataSet").count(), own.len());
    let times = list.split("timestep=\"").skip(1).map(|rest| rest.split('"').next().unwrap());
    for (time, frequency) in times.zip(&own).skip(6) {
        let time: f64 = time.parse().unwrap();
        assert!((time - frequency).abs() < 1e-9 * frequency, "{time} and {frequency}");
    }
    for number in 1..=own.len() {
        let file = fs::read_to_string(folder.path().join(format!("modes/mode_{number:03}.vtu")));
        let file = file.unwrap();
        let moved = vtk_array(&file, "displacement");
        assert_eq!(moved.len(), 72);
        assert!((moved.iter().copied().fold(0.0, |a, b| f64::max(a, b.abs())) - 1.0).abs() < 1e-12);
        assert_eq!(vtk_array(&file, "node"), (1..=24).map(f64::from).collect::<Vec<_>>());
        assert_eq!(vtk_array(&file, "types"), [12.0; 6]);
        // The stretch of the diagonals of an element: none in the motion of a rigid body.
        let places = vtk_array(&file, "place");
        let stretch = [(0, 17), (1, 16), (5, 12), (4, 13)].map(|(a, b)| {
            let along = (0..3).map(|i| places[3 * b + i] - places[3 * a + i]);
            let apart = (0..3).map(|i| moved[3 * b + i] - moved[3 * a + i]);
            along.zip(apart).map(|(x, u)| x * u).sum::<f64>()
        });
        let most = stretch.iter().copied().fold(0.0, |a, b| f64::max(a, b.abs()));
        assert_eq!(most < 1e-7, number <= 6, "mode {number}: {most}");
    }
    let others = "*NODE\n1, 0, 0\n2, 1, 0\n3, 0, 1\n*ELEMENT, TYPE=S3\n1, 1, 2, 3\n";
    fs::write(folder.path().join("other.inp"), others).unwrap();
    let rest = ["-o", "other", "--mesh", "other.inp", "--vtk", "modes"];
    let output = reduce(folder.path(), &[&nodes[..], &rest].concat());
    assert_refused(&output, 2, &["other.inp", "the matrices have node 4", "from 1 to 3"]);
    assert!(!folder.path().join("other").exists());
}

#[test]
fn a_superelement_that_keeps_too_little_is_written_but_told_by_the_exit_code() {
    let folder = folder();
    let nodes = ["--contacts", "1,4,9,12", "--frequency", "20000", "--modes-to", "9000"];
    let output = reduce(folder.path(), &[&nodes[..], &["-o", "out"]].concat());
    assert_refused(&output, 4, &["the certificate is not complete"]);
    assert!(
        text(&output.stdout).contains("NOT COMPLETE: keep more modes (--modes-to above 9000 Hz)")
    );
}

#[test]
fn wrong_requests_of_a_reduction_are_refused_before_the_work() {
    let folder = folder();
    let refused = |arguments: &[&str], code: i32, words: &[&str]| {
        let output = reduce(folder.path(), &[arguments, &["-o", "out"]].concat());
        assert_refused(&output, code, words);
        assert!(!folder.path().join("out").exists());
    };
    let frequency = ["--frequency", "20000"];
    let with = |more: &'static [&'static str]| [&frequency[..], more].concat();
    refused(&with(&["--contacts", "1,99"]), 3, &["no node 99; their nodes go from 1 to 24"]);
    refused(&with(&["--contacts", "1,x"]), 2, &["`x` is neither the number of a node nor a range"]);
    refused(&with(&["--contacts", "5"]), 3, &["retain at least three nodes"]);
    refused(&with(&["--contacts", "1", "--also", "mass=m.mtx"]), 2, &["cannot name a file"]);
    fs::write(folder.path().join("rows.csv"), "node,direction\n1,1\n").unwrap();
    let rows = ["--contacts", "1", "--freedoms", "rows.csv"];
    refused(&[&frequency[..], &rows].concat(), 2, &["name their rows themselves"]);
    fs::write(folder.path().join("c.mtx"), "%%MatrixMarket matrix array real general\n1 1\n5\n")
        .unwrap();
    let also = ["--contacts", "1", "--also", "damping=c.mtx"];
    refused(&[&frequency[..], &also].concat(), 2, &["2 of 3 files name the nodes"]);
}

/// A free bar of three masses of 1 kg along x, in files that name no nodes.
fn bar(folder: &Path) -> [&'static str; 4] {
    let file = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
    file(
        "k.mtx",
        "%%MatrixMarket matrix array real general\n3 3\n1e6\n-1e6\n0\n-1e6\n2e6\n-1e6\n0\n-1e6\n1e6\n",
    );
    file("m.mtx", "%%MatrixMarket matrix array real general\n3 3\n1\n0\n0\n0\n1\n0\n0\n0\n1\n");
    file("c.mtx", "%%MatrixMarket matrix array real general\n1 1\n5\n");
    file("rows.csv", "node,direction\n11,1\n12,1\n13,1\n");
    ["--stiffness", "k.mtx", "--mass", "m.mtx"]
}

#[test]
fn files_without_nodes_are_told_apart_from_those_whose_nodes_a_table_names() {
    let folder = folder();
    let files = bar(folder.path());
    let reduced = |rest: &[&str]| {
        let all = [&["reduce", "--frequency", "100"][..], &files, rest].concat();
        run(env!("CARGO_BIN_EXE_amontons"), folder.path(), &all)
    };
    let output = reduced(&["--contacts", "1:3", "-o", "numbers"]);
    let said = text(&output.stderr);
    let note = "note: the files name no nodes: --contacts and --retain take numbers of rows; give --freedoms for nodes and directions";
    assert!(said.contains(note), "{said}");
    let table = ["--freedoms", "rows.csv", "--contacts", "11:13"];
    let output = reduced(&[&table[..], &["-o", "nodes"]].concat());
    assert!(!text(&output.stderr).contains("note: the files name no nodes"));
    // A further matrix of another size is to blame itself, not the table.
    let output = reduced(&[&table[..], &["--also", "damping=c.mtx", "-o", "also"]].concat());
    assert_refused(
        &output,
        2,
        &["--also damping has 1 rows and 1 columns, and the stiffness matrix 3 rows"],
    );
}

/// The stiffness of the block in Matrix Market has no names of rows, and the mass has those of CalculiX: once the orders of rows
/// were taken to be one, whatever they were.
#[test]
fn rows_with_and_without_names_are_not_mixed() {
    let folder = folder();
    let path = folder.path();
    let mass = format!("{BLOCK}.mas");
    fs::write(
        path.join("k.mtx"),
        "%%MatrixMarket matrix coordinate real general\n72 72 1\n1 1 1\n",
    )
    .unwrap();
    let range = ["--growth=-1:1", "--frequency", "1:2"];
    let files = ["--mass", &*mass, "--stiffness", "k.mtx"];
    let output = matrices(path, &[&files[..], &range].concat());
    assert_refused(&output, 2, &["1 of 2 files name the nodes and directions"]);
    let rows: String = fs::read_to_string(format!("{BLOCK}.dof")).unwrap().replace('.', ",");
    fs::write(path.join("rows.csv"), format!("node,direction\n{rows}")).unwrap();
    let output = matrices(path, &[&files[..], &range, &["--freedoms", "rows.csv"]].concat());
    assert!(!text(&output.stderr).contains("name the nodes"), "{}", text(&output.stderr));
    fs::copy(&mass, path.join("alone.mas")).unwrap();
    let files = ["--mass", "alone.mas", "--stiffness", "alone.mas"];
    let output = matrices(path, &[&files[..], &range].concat());
    assert_refused(&output, 1, &["alone.mas", "the same name with .dof; copy it beside"]);
}

#[test]
fn a_superelement_does_not_replace_another_one() {
    let folder = folder();
    let nodes = ["--contacts", "1,4,9,12", "--frequency", "9000", "-o", "out"];
    assert!(reduce(folder.path(), &nodes).status.success());
    assert_refused(&reduce(folder.path(), &nodes), 2, &["out holds another superelement"]);
}

/// Without damping both modes merge at µ = (k₁₂ + (k₁₁ − k₂₂)²/(4 k₁₂))/k₃ = 1.2125. With C = α M one grows from where the
/// imaginary part b of λ² = −a ± ib reaches α √a: µ = 1.2125 + α² (k₁₁ + k₂₂)/(2 k₁₂ k₃) = 1.2435.
#[test]
fn a_mode_begins_to_grow_at_the_friction_of_the_closed_form() {
    let folder = folder();
    write_friction(folder.path(), "[parameter]\nname = \"mu\"\nvalues = [1.0]\n");
    let range = ["friction.toml", "--growth=-5:5", "--frequency", "0:2"];
    let fine = ["--parameter", "mu=1.243:1.244/3", "--format", "json", "--plot", "mu.svg"];
    let found = json(&matrices(folder.path(), &[&range[..], &fine].concat()));
    let branches = found["branches"].as_array().unwrap();
    let turns: Vec<&Value> =
        branches.iter().flat_map(|branch| branch["crossings"].as_array().unwrap()).collect();
    assert_eq!(turns.len(), 1, "{found}");
    assert_eq!(turns[0]["begins_to_grow"], true);
    assert!((turns[0]["value"].as_f64().unwrap() - 1.2435).abs() < 1e-5, "{}", turns[0]);
    let picture = fs::read_to_string(folder.path().join("mu.svg")).unwrap();
    assert!(picture.contains("Growth rate") && picture.contains("Frequency"));
    let csv = matrices(folder.path(), &[&range[..], &["--format", "csv"]].concat());
    let csv = text(&csv.stdout);
    let mut lines = csv.lines();
    let head = lines.next().unwrap();
    assert!(head.starts_with("mu,branch,mode,frequency_hz,growth_rate,"), "{head}");
    assert!(lines.all(|line| line.starts_with("1,") && line.ends_with(",false,true")), "{csv}");
}

#[test]
fn wrong_descriptions_are_refused_with_what_would_be_right() {
    let folder = folder();
    let refused = |head: &str, change: fn(String) -> String, code: i32, words: &[&str]| {
        write_friction(folder.path(), head);
        let path = folder.path().join("friction.toml");
        fs::write(&path, change(fs::read_to_string(&path).unwrap())).unwrap();
        let range = ["friction.toml", "--growth=-5:5", "--frequency", "0:2"];
        assert_refused(&matrices(folder.path(), &range), code, words);
    };
    let parameter = "[parameter]\nname = \"mu\"\nvalues = [1.0, 2.0]\n";
    let same = |text: String| text;
    refused("", same, 3, &["friction.toml", "part 4 has a power, but there is no [parameter]"]);
    let zero = "[parameter]\nname = \"mu\"\nvalues = [1.0]\nreference = 0.0\n";
    refused(zero, same, 3, &["parameter.reference = 0 must be a number that is not 0"]);
    refused(parameter, |text| text.replace("factor", "facter"), 3, &["facter", "factor"]);
    let files = |text: String| text.replace("file = \"contact.mtx\"", "files = [\"contact.mtx\"]");
    refused(parameter, files, 3, &["part 4 has 1 files and the parameter has 2 values"]);
    let lost = |text: String| text.replace("contact.mtx", "lost.mtx");
    refused(parameter, lost, 1, &["lost.mtx", "cannot read the file"]);
    let masses = |text: String| text.replace("\"mass\"\n", "\"damping\"\n");
    refused(parameter, masses, 3, &["no part has matrix = \"mass\""]);
}
