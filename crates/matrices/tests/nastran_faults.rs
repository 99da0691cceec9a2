//! Wrong files of Nastran: each is told with its place and its remedy.

use amontons_matrices::Place::{self, Line, Offset, Whole};
use amontons_matrices::{Fault, dmig, output4};
use std::fs;
use std::path::Path;

fn data(name: &str) -> Vec<u8> {
    fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)).unwrap()
}

fn assert_fault<T: std::fmt::Debug>(found: Result<T, Fault>, place: Place, message: &str) {
    assert_eq!(found.unwrap_err(), Fault { place, message: message.into() });
}

#[test]
fn faults_of_dmig() {
    let header = "DMIG,K,0,6,2,0\n";
    let cases = [
        (
            "GRID,1,,0.,0.,0.\n".to_owned(),
            Whole,
            "the file has no card DMIG; write the matrices as DMIG, for instance with EXTSEOUT(STIFFNESS,MASS,DMIGPCH)",
        ),
        ("DMIG,,0,6,2,0\n".into(), Line(1), "`` is no name of a matrix; write 1 to 8 characters"),
        (
            "DMIG,STIFFNESS,0,6,2,0\n".into(),
            Line(1),
            "`STIFFNESS` is no name of a matrix; write 1 to 8 characters",
        ),
        (
            format!("{header}{header}"),
            Line(2),
            "matrix K has a second header (the first is in line 1); remove one",
        ),
        (
            "DMIG,K,1,1,,1,1,2.\n".into(),
            Line(1),
            "matrix K has no header; add a card such as DMIG K 0 6 2 0 for a symmetric one",
        ),
        (
            "DMIG,K,0,6,4,0\n".into(),
            Line(1),
            "matrix K has complex numbers (TIN 4); write a real matrix",
        ),
        (
            "DMIG,K,0,6,,0\n".into(),
            Line(1),
            "the type TIN of matrix K is ``; write 1 or 2 for real numbers of single or double precision",
        ),
        (
            "DMIG,K,0,7,2,0\n".into(),
            Line(1),
            "the form IFO of matrix K is `7`; write 1 for square, 6 for symmetric, 2 or 9 for rectangular",
        ),
        (
            "DMIG,K,0,9,2,0\n".into(),
            Line(1),
            "matrix K is rectangular, but NCOL is ``; write its number of columns",
        ),
        (
            "DMIG,K,0,9,2,0,,,2\nDMIG,K,3,,,1,1,2.\n".into(),
            Line(2),
            "the entry in row 1 and column 3 is outside of the matrix, which has 1 rows and 2 columns; state larger numbers of \
             rows and columns, or remove the entry",
        ),
        (
            format!("{header}DMIG,K,1,1,,1,1,2.,\n,2,7,3.\n"),
            Line(3),
            "node 2 has the direction `7`; write 1 to 6, or 0 for a scalar point",
        ),
        (format!("{header}DMIG,K,1,1,,,1,2.\n"), Line(2), "`` is no node; write a number from 1"),
        (
            format!("{header}DMIG,K,1,1,,1,1,2.x\n"),
            Line(2),
            "`2.x` is no real number; write one such as -1.5+3 or -1.5D+3",
        ),
        (
            format!("{header}DMIG,K,1,1,,1,1,2.,3.\n"),
            Line(2),
            "the imaginary part `3.` belongs to no real matrix; leave it out",
        ),
        (
            format!("{header}DMIG*   K                              1               1\n"),
            Line(2),
            "the column of matrix K has no entry; the file is cut, or a continuation line is missing",
        ),
        (
            format!("{header}DMIG,K,1,1,,1,1,2.\nDMIG,K,1,1,,1,1,2.\n"),
            Line(3),
            "node 1 direction 1 and node 1 direction 1 have a second entry (the first is in line 2); add the two up, or remove \
             one",
        ),
        (
            format!("{header}DMIG,K,1,1,,1,2,2.\nDMIG,K,1,2,,1,1,2.5\n"),
            Line(2),
            "the file says that the matrix is symmetric, but node 1 direction 2 and node 1 direction 1 hold 2, and node 1 \
             direction 1 and node 1 direction 2 hold 2.5; say that it is general, or correct one of them",
        ),
    ];
    for (text, place, message) in cases {
        assert_fault(dmig::read(text.as_bytes()), place, message);
    }
}

#[test]
fn faults_of_output4_as_text() {
    let header = "       2       2       6       2K       1P,3E23.16\n";
    let value = " 1.0000000000000000E+00";
    let column = format!("       1       1       1\n{value}\n");
    let cases = [
        (String::new(), Whole, "the file is empty; write a matrix with OUTPUT4"),
        (
            header.replace("1P,3E23.16", "1P"),
            Line(1),
            "`       2       2       6       2K       …` is no header of a matrix; write columns, rows, form, type, name and \
             format as 4I8, 2A4, such as 1P,5E16.9",
        ),
        (
            header.replace("6       2K", "6       4K"),
            Line(1),
            "matrix K has complex numbers (type 4); write a real matrix",
        ),
        (
            header.replace("6       2K", "3       2K"),
            Line(1),
            "matrix K has the form 3; write it as form 1 (square), 2 (rectangular) or 6 (symmetric)",
        ),
        (
            header.replace("6       2K", "6       5K"),
            Line(1),
            "matrix K has the type 5; write 1 or 2 for real numbers of single or double precision",
        ),
        (
            header.replacen("       2       2", "       2       3", 1),
            Line(1),
            "matrix K is symmetric (form 6), but has 3 rows and 2 columns; write form 2",
        ),
        (
            header.replacen("       2", "      -2", 1),
            Line(1),
            "matrix K states -2 columns; write a number from 0",
        ),
        (
            format!("{header}{column}"),
            Line(3),
            "the file ends before column 3 that ends the matrix; it is cut: write it again",
        ),
        (
            format!("{header}{column}{value}\n"),
            Line(2),
            "the line states 1 words, but 2 values follow it; the file is damaged: write it again",
        ),
        (
            format!("{header}       1       2       2\n{value}{value}\n"),
            Line(3),
            "the entry in row 3 and column 1 is outside of the matrix, which has 2 rows and 2 columns; state larger numbers of \
             rows and columns, or remove the entry",
        ),
        (
            format!("{header}       1       1\n"),
            Line(2),
            "`       1       1` is no head of a column; write its number, the first row and the number of words",
        ),
        (
            format!("{header}       1       1       x\n"),
            Line(2),
            "`       1       1       x` stands where whole numbers belong; write the file again",
        ),
        (
            format!("{header}       0       1       1\n"),
            Line(2),
            "column 0 of matrix K does not exist; write numbers from 1",
        ),
        (
            format!("{header}       1       1       1\n 1.0000000000000000X+00\n"),
            Line(3),
            "` 1.0000000000000000X+00` is no number in the format of the header; write the file again",
        ),
        (
            format!("{}       1       1       2\n{value}{value}\n", header.replace("3E", "1E")),
            Line(3),
            "` 1.0000000000000000E+00` is no number in the format of the header; write the file again",
        ),
        (
            format!("{header}       1       0       3\n  -65535\n"),
            Line(3),
            "`-65535` does not begin a string of matrix K; the file is damaged, or mixes the forms of strings: write it again",
        ),
    ];
    for (text, place, message) in cases {
        assert_fault(output4::read(text.as_bytes()), place, message);
    }
}

#[test]
fn faults_of_output4_in_records() {
    // A header of 24 bytes, and column 1: strings of values in double precision.
    let strings = data("tets_strings.op4");
    let with = |at: usize, bytes: &[u8]| {
        let mut content = strings.clone();
        content[at..at + bytes.len()].copy_from_slice(bytes);
        content
    };
    let column = usize::try_from(i32::from_le_bytes(strings[32..36].try_into().unwrap())).unwrap();
    let cases = [
        (
            strings[..34].to_vec(),
            Offset(32),
            "the file ends within the length of a record; it is cut: copy or write it again".to_owned(),
        ),
        (
            strings[..60].to_vec(),
            Offset(32),
            format!("the record states {column} bytes, more than the file has; it is cut: copy or write it again"),
        ),
        (
            strings[..32].to_vec(),
            Offset(32),
            "the file ends before column 28 that ends the matrix; it is cut: write it again".into(),
        ),
        (
            with(32, &(-4i32).to_le_bytes()),
            Offset(32),
            "the record states -4 bytes, more than the file has; it is cut: copy or write it again".into(),
        ),
        (
            with(36 + column, &7i32.to_le_bytes()),
            Offset(36 + column),
            format!(
                "the record that begins at byte 32 states {column} bytes before and 7 after them; the file is damaged: copy it \
                 in binary mode, or write it again"
            ),
        ),
        (
            with(16, &3i32.to_le_bytes()),
            Offset(4),
            "matrix KAAX has complex numbers (type 3); write a real matrix".into(),
        ),
        (
            with(44, &7i32.to_le_bytes()),
            Offset(36),
            "the record is no column of the matrix: its length does not fit; write the file again".into(),
        ),
        (
            with(48, &0i32.to_le_bytes()),
            Offset(48),
            "`0` does not begin a string of matrix KAAX; the file is damaged, or mixes the forms of strings: write it again"
                .into(),
        ),
        (
            with(48, &(65536 * 4 + 1i32).to_le_bytes()),
            Offset(52),
            "3 words are no values of 2 words; write the file again".into(),
        ),
        (
            with(52, &f64::NAN.to_le_bytes()),
            Offset(52),
            "the value of row 1 and column 1 is NaN; a matrix needs finite numbers".into(),
        ),
        (
            [&48i32.to_le_bytes()[..], &[0; 48], &48i32.to_le_bytes()].concat(),
            Offset(4),
            "the file has words of 64 bits; write it with 32 bits (OP2_64=NO, or the LP-64 version of Nastran)".into(),
        ),
        (
            [&strings[..], &[8, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 8, 0, 0, 0]].concat(),
            Offset(strings.len() + 4),
            "a record of 8 bytes stands where a header of 24 belongs; the file is damaged: write it again".into(),
        ),
    ];
    for (content, place, message) in cases {
        assert_fault(output4::read(&content), place, &message);
    }
}
