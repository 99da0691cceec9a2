//! One model in all formats gives one matrix.

use amontons_matrices::{Entry, Freedom, Location, Matrix, Symmetry, open};
use std::fs;
use std::path::{Path, PathBuf};

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

fn read(location: &str) -> Matrix {
    let location: Location = data(location).to_str().unwrap().parse().unwrap();
    open(&location).unwrap_or_else(|error| panic!("{error}"))
}

/// The entries that the program which wrote the files has listed: row, column and value.
fn expected(name: &str) -> Vec<Entry> {
    let text = fs::read_to_string(data(name)).unwrap();
    let entry = |line: &str| {
        let words: Vec<_> = line.split(' ').collect();
        let [row, column, value] = &*words else { panic!("{line}") };
        Entry {
            row: row.parse().unwrap(),
            column: column.parse().unwrap(),
            value: value.parse().unwrap(),
        }
    };
    let mut entries: Vec<_> = text.lines().map(entry).collect();
    entries.sort_by_key(|entry| (entry.column, entry.row));
    entries
}

#[test]
fn files_of_the_unsymmetric_matrix_agree() {
    let entries = expected("A.txt");
    for file in [
        "A.mtx",
        "A_array.mtx",
        "A.rua",
        "A.npy",
        "A_fortran.npy",
        "A_csc.npz",
        "A_csr.npz",
        "A_coo.npz",
        "A_csr.npz#data",
        "dense.npz#A",
        "v7.mat#A",
        "v7.mat#D",
        "v6.mat#A",
        "big_endian.mat",
        "v73.mat#A",
        "v73.mat#D",
    ] {
        let matrix = read(file);
        assert_eq!((matrix.rows, matrix.columns), (12, 12), "{file}");
        assert_eq!(matrix.symmetry, Symmetry::General, "{file}");
        assert_eq!(matrix.freedoms, None, "{file}");
        assert_eq!(matrix.entries, entries, "{file}");
    }
}

#[test]
fn files_of_the_symmetric_matrix_agree() {
    let entries = expected("K.txt");
    for (file, symmetry) in [
        ("K.mtx", Symmetry::Symmetric),
        ("K_array.mtx", Symmetry::Symmetric),
        ("K.matrix", Symmetry::Symmetric),
        ("dense.npz#K", Symmetry::General),
        ("v7.mat#K", Symmetry::General),
        ("v73.mat#K", Symmetry::General),
    ] {
        let matrix = read(file);
        assert_eq!((matrix.rows, matrix.columns), (12, 12), "{file}");
        assert_eq!(matrix.symmetry, symmetry, "{file}");
        assert_eq!(matrix.entries, entries, "{file}");
    }
}

#[test]
fn the_mapping_beside_a_matrix_gives_its_degrees_of_freedom() {
    let freedoms =
        (0..12).map(|row| Freedom { node: 10 * (row / 2 + 1), direction: (row % 2) as u8 + 1 });
    assert_eq!(read("K.matrix").freedoms, Some(freedoms.collect()));
}

#[test]
fn numbers_of_other_kinds_are_read() {
    let matrix = read("v6.mat#n");
    assert_eq!(matrix.name.as_deref(), Some("n"));
    assert_eq!(matrix.entries, [Entry { row: 0, column: 0, value: 12.0 }]);
}
