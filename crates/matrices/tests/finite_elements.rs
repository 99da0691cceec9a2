//! One structure through the formats of programs of finite elements gives the same matrices, to the digits that each prints.
//! The files come from CalculiX, pyNastran, pyYeti and SciPy, and those in the layouts of Abaqus from `data/make_fe.py`, which
//! writes them all.

use amontons_matrices::{Freedom, Location, Matrix, Symmetry, open};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

fn read(location: &str) -> Matrix {
    let location: Location = data(location).to_str().unwrap().parse().unwrap();
    open(&location).unwrap_or_else(|error| panic!("{error}"))
}

/// The degrees of freedom of the structure: three directions of each node.
fn freedoms() -> Vec<Freedom> {
    let nodes = [1, 3, 5, 12, 20, 21, 34, 50, 101];
    let directions = |node| (1..=3).map(move |direction| Freedom { node, direction });
    nodes.into_iter().flat_map(directions).collect()
}

/// The entries that are not zero, by row and column.
type Entries = BTreeMap<(usize, usize), f64>;

/// What CalculiX has stored, read as plain columns of numbers.
fn stored(name: &str) -> Entries {
    let mut entries = Entries::new();
    for line in fs::read_to_string(data(name)).unwrap().lines() {
        let words: Vec<_> = line.split_whitespace().collect();
        let [row, column] = [0, 1].map(|at| words[at].parse::<usize>().unwrap() - 1);
        let value: f64 = words[2].parse().unwrap();
        if value != 0.0 {
            entries.extend([((row, column), value), ((column, row), value)]);
        }
    }
    entries
}

fn nonzero(matrix: &Matrix) -> Entries {
    let entries = matrix.entries.iter().filter(|entry| entry.value != 0.0);
    entries.map(|entry| ((entry.row, entry.column), entry.value)).collect()
}

/// Both have entries in the same places, and each value differs by at most this part of itself.
fn assert_equal(found: &Entries, expected: &Entries, part: f64, name: &str) {
    assert!(found.keys().eq(expected.keys()), "{name}");
    for (place, &value) in found {
        let error = (value - expected[place]).abs();
        assert!(error <= part * value.abs(), "{name}: {place:?}: {value} and {}", expected[place]);
    }
}

#[test]
fn files_of_all_programs_agree_to_their_digits() {
    let [stiffness, mass] = ["tets.sti", "tets.mas"].map(stored);
    // Half a unit of the last digit for the smallest mantissa.
    let files = [
        ("tets.sti", &stiffness, 0.0, true),
        ("tets.mas", &mass, 0.0, true),
        ("tets_nodes.mtx", &mass, 0.0, true),
        ("tets_numbers.mtx", &mass, 0.0, false),
        ("tets_small.bdf", &mass, 5e-4, true),
        ("tets_large.pch#KAAX", &stiffness, 5e-10, true),
        ("tets_large.pch#MAAX", &mass, 5e-10, true),
        ("tets_text.op4", &stiffness, 0.0, false),
        ("tets_text_strings.op4", &stiffness, 5e-10, false),
        ("tets_text_bigmat.op4", &stiffness, 5e-10, false),
        ("tets_dense.op4", &mass, 0.0, false),
        ("tets_strings.op4#KAAX", &stiffness, 0.0, false),
        ("tets_strings.op4#MAAX", &mass, 0.0, false),
        ("tets_bigmat.op4", &stiffness, 0.0, false),
        ("tets_single.op4", &mass, f64::from(f32::EPSILON) / 2.0, false),
    ];
    for (file, expected, part, tells) in files {
        let matrix = read(file);
        assert_eq!((matrix.rows, matrix.columns), (27, 27), "{file}");
        assert_eq!(matrix.symmetry, Symmetry::Symmetric, "{file}");
        assert_eq!(matrix.freedoms, tells.then(freedoms), "{file}");
        assert_equal(&nonzero(&matrix), expected, part, file);
        // Only CalculiX lists zeros as entries.
        let zeros = matrix.entries.len() > expected.len();
        assert_eq!(zeros, file == "tets.mas", "{file}");
    }
}

#[test]
fn a_substructure_has_the_block_of_its_nodes() {
    let matrix = read("tets_substructure.mtx");
    assert_eq!(matrix.name.as_deref(), Some("STIFFNESS"));
    assert_eq!(matrix.symmetry, Symmetry::Symmetric);
    assert_eq!(matrix.freedoms.as_deref(), Some(&freedoms()[12..]));
    let block = stored("tets.sti").into_iter().filter(|&((row, column), _)| row.min(column) >= 12);
    let block = block.map(|((row, column), value)| ((row - 12, column - 12), value)).collect();
    assert_equal(&nonzero(&matrix), &block, 5e-13, "tets_substructure.mtx");
}

#[test]
fn a_rectangular_matrix_has_numbered_columns() {
    let matrix = read("tets_large.pch#PAX");
    let stiffness = stored("tets.sti");
    let rows: Vec<usize> = (0..27)
        .filter(|&row| stiffness.contains_key(&(row, 0)) || stiffness.contains_key(&(row, 1)))
        .collect();
    assert_eq!((matrix.rows, matrix.columns), (rows.len(), 2));
    assert_eq!((matrix.symmetry, &matrix.freedoms), (Symmetry::General, &None));
    let columns = stiffness.into_iter().filter(|&((_, column), _)| column < 2);
    let place = |row| rows.binary_search(&row).unwrap();
    let expected = columns.map(|((row, column), value)| ((place(row), column), value)).collect();
    assert_equal(&nonzero(&matrix), &expected, 5e-10, "PAX");
}

#[test]
fn a_file_of_several_matrices_needs_a_name() {
    let message = |location: &str| {
        let location: Location = data(location).to_str().unwrap().parse().unwrap();
        open(&location).unwrap_err().fault().message.clone()
    };
    assert_eq!(
        message("tets_large.pch"),
        "there are several matrices: `KAAX`, `MAAX`, `PAX`; choose one by its name after #, as in FILE#NAME"
    );
    assert_eq!(message("tets_strings.op4#K"), "there is no matrix `K`; there are `KAAX`, `MAAX`");
    assert_eq!(message("tets.sti#K"), "the file holds one matrix, which has no name; leave out #K");
}

#[test]
fn a_name_that_two_matrices_of_a_file_have_is_told() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("twice.op4");
    fs::write(&path, fs::read(data("tets_dense.op4")).unwrap().repeat(2)).unwrap();
    let error = open(&Location { path, name: Some("MAAX".into()) }).unwrap_err();
    assert_eq!(
        error.fault().message,
        "there are several matrices of the name `MAAX`; leave one of them in the file"
    );
}
