//! Harwell–Boeing files and their mappings: what is read, and what is told of wrong ones.

use amontons_matrices::{Entry, Fault, Matrix, Place, harwell_boeing, mapping};
use std::fmt::Debug;

/// The entries as triples, rows and columns counted from 1.
fn entries(matrix: &Matrix) -> Vec<(usize, usize, f64)> {
    let triple = |&Entry { row, column, value }: &Entry| (row + 1, column + 1, value);
    matrix.entries.iter().map(triple).collect()
}

#[track_caller]
fn refused<T: Debug>(read: Result<T, Fault>, place: Place, message: &str) {
    let fault = read.unwrap_err();
    assert_eq!((fault.place, &*fault.message), (place, message));
}

/// A Harwell–Boeing file of a symmetric matrix of two rows: 3, 1.5 and 1.5e103.
fn harwell_boeing(type_and_sizes: &str, formats: &str, numbers: &str) -> Vec<u8> {
    format!("title\n 3 1 1 1\n{type_and_sizes}\n{formats}\n{numbers}").into_bytes()
}

const SIZES: &str = "RSA                        2             2             3             0";
const FORMATS: &str = "(3I2)           (3I3)           (2E7.1)             ";
const NUMBERS: &str = " 1 3 4\n  1  2  2\n 3.0000 1.5000\n1.5+103\n";

#[test]
fn columns_of_fortran_are_read_with_or_without_spaces_between() {
    let expected = [(1, 1, 3.0), (2, 1, 1.5), (1, 2, 1.5), (2, 2, 1.5e103)];
    for (formats, numbers) in [
        (FORMATS, NUMBERS),
        ("(3i2) (3I3) (2d7.1)", " 1 3 4\r\n  1  2  2\r\n 3.0000 1.5000\r\n1.5+103\r\n"),
        ("(1I2) (I3) (1P,2E10.4)", " 1\n 3\n 4\n  1\n  2\n  2\n3.0000E+001.5000D+00\n  1.5D+103"),
        ("(3I1) (3I1) (1P2E10.4E3)", "134\n122\n3.0000E+001.5000D+00\n  1.5D+103\n"),
        // As SciPy does: fewer characters than stated.
        ("(3I2) (3I3) (2E25.16)", " 1 3 4\n  1  2  2\n 3.0000 1.5000\n1.5+103\n 9.0 9.0\n"),
    ] {
        let matrix = harwell_boeing::read(&harwell_boeing(SIZES, formats, numbers)).unwrap();
        assert_eq!(entries(&matrix), expected, "{formats}");
    }
}

#[test]
fn types_of_harwell_boeing_files_say_the_symmetry() {
    let read = |name: &str| {
        let sizes = SIZES.replace("RSA", name);
        let numbers = " 1 2 3\n  2  1\n 3.0000-3.0000\n";
        let sizes = sizes.replace("            3 ", "            2 ");
        entries(&harwell_boeing::read(&harwell_boeing(&sizes, FORMATS, numbers)).unwrap())
    };
    let expected = [(2, 1, 3.0), (1, 2, -3.0)];
    assert_eq!(read("RUA"), expected);
    assert_eq!(read("rza"), expected);
}

#[test]
fn wrong_harwell_boeing_files_are_told_with_their_line() {
    let refused = |sizes: &str, formats: &str, numbers: &str, place, message: &str| {
        let content = harwell_boeing(sizes, formats, numbers);
        refused(harwell_boeing::read(&content), place, message);
    };
    let of_type = |name: &str, message: &str| {
        refused(&SIZES.replace("RSA", name), FORMATS, NUMBERS, Place::Line(3), message);
    };
    let of_formats = |formats: &str, message: &str| {
        refused(SIZES, formats, NUMBERS, Place::Line(4), message);
    };
    let of_numbers =
        |numbers: &str, place, message: &str| refused(SIZES, FORMATS, numbers, place, message);

    of_type(
        "CSA",
        "the values are complex, but a real matrix is needed; write the real part of the matrix alone",
    );
    of_type(
        "PSA",
        "the file has the pattern of a matrix without its values; write the matrix with its values",
    );
    of_type("RHA", "the matrix is Hermitian, but a real matrix is needed; write it as RSA");
    of_type("RSE", "the matrix is in elements; write it assembled");
    of_type(
        "XYZ",
        "the type `XYZ` is unknown; known are RUA (unsymmetric), RSA (symmetric), RZA (skew-symmetric) and RRA (rectangular)",
    );
    refused(
        "RSA 2 2",
        FORMATS,
        NUMBERS,
        Place::Line(3),
        "numbers of rows, columns and entries must follow the type",
    );
    refused(
        "RSA 2 3 3 0",
        FORMATS,
        NUMBERS,
        Place::Line(3),
        "the type RSA needs a square matrix, but this one has 2 rows and 3 columns; write it as RRA",
    );

    of_formats(
        "(3I2) (3I3)",
        "`(3I2) (3I3)` must be three or four Fortran formats, such as `(16I5) (16I5) (3E25.16)`",
    );
    of_formats(
        "(3I2) (3A3) (2E7.1)",
        "the format `3A3` is unknown; one of whole numbers is needed, such as `(16I5)`",
    );
    of_formats(
        "(3I2) (3I3) (2P,2F7.1)",
        "the format `2P,2F7.1` is unknown; write the values with one such as `(3E25.16)` or `(1P,5D16.8)`",
    );

    of_numbers(
        " 1 3 4\n  1  2  2\n 3.0000\n",
        Place::Line(7),
        "`` is no value; this line needs 2 numbers with a decimal point, each of 7 characters, as line 4 says",
    );
    of_numbers(
        " 1 3 4\n  1  2  2\n 3.0000 1.5000\n",
        Place::Line(7),
        "the file ends after 2 of 3 values; it may have been cut off: write it again",
    );
    of_numbers(
        " 1 3 4\n  1  2  2\n 3.0000      2\n1.0\n",
        Place::Line(7),
        "`2` is no value; this line needs 2 numbers with a decimal point, each of 7 characters, as line 4 says",
    );
    of_numbers(
        " 1 3 4\n  1  2  2  2\n 3.0000 1.5000\n1.0\n",
        Place::Line(6),
        "`2  2` is no row; this line needs 3 whole numbers, each of 3 characters, as line 4 says",
    );
    of_numbers(
        " 1 3 4\n  0  2  2\n 3.0000 1.5000\n1.0\n",
        Place::Line(7),
        "an entry of column 1 has the row 0; rows are counted from 1",
    );
    of_numbers(
        " 1 3 4\n  1  2  3\n 3.0000 1.5000\n1.0\n",
        Place::Line(8),
        "the entry in row 3 and column 2 is outside of the matrix, which has 2 rows and 2 columns; state larger numbers of \
         rows and columns, or remove the entry",
    );
    of_numbers(
        " 1 3 4\n  1  1  2\n 3.0000 1.5000\n1.0\n",
        Place::Line(7),
        "row 1 and column 1 have a second entry (the first is in line 7); add the two up, or remove one",
    );
    of_numbers(
        " 1 3 4\n  1  2  1\n 3.0000 1.5000\n1.0\n",
        Place::Line(7),
        "the file says that the matrix is symmetric, but row 2 and column 1 hold 1.5, and row 1 and column 2 hold 1; say \
         that it is general, or correct one of them",
    );
    of_numbers(
        " 1 3 4\n  1  2  2\n 3.0000 1.5000\nNaN\n",
        Place::Line(8),
        "the value of row 2 and column 2 is NaN; a matrix needs finite numbers",
    );
    of_numbers(
        " 1 5 4\n  1  2  2\n 3.0000 1.5000\n1.0\n",
        Place::Whole,
        "column 1 ends at entry 5, but there are 3 entries; the file may have been cut off: write it again",
    );
    of_numbers(
        " 1 4 3\n  1  2  2\n 3.0000 1.5000\n1.0\n",
        Place::Whole,
        "the last column pointer is 3; with 3 entries it must be 4",
    );
    of_numbers(
        " 2 3 4\n  1  2  2\n 3.0000 1.5000\n1.0\n",
        Place::Whole,
        "the first column pointer is 2; it must be 1",
    );
    refused(
        "RSA 9000000000000000000 9000000000000000000 9000000000000000000",
        FORMATS,
        NUMBERS,
        Place::Line(7),
        "`.0` is no pointer; this line needs 3 whole numbers, each of 2 characters, as line 4 says",
    );
}

#[test]
fn harwell_boeing_files_without_text_or_header_are_refused() {
    refused(
        harwell_boeing::read(b"title\n\0\0"),
        Place::Whole,
        "the file is binary; write it as text (in Ansys: HBMAT with Form = ASCII)",
    );
    refused(
        harwell_boeing::read(b"title\n1 1 1 1 0\n"),
        Place::Whole,
        "the file ends before line 3, which is of its header; write it again",
    );
    refused(
        harwell_boeing::read(b""),
        Place::Whole,
        "the file ends before line 1, which is of its header; write it again",
    );
}

#[test]
fn wrong_mapping_files_are_told_with_their_line() {
    let head = "  Matrix Eqn   Node  DOF\n";
    let refused = |text: &str, line, message: &str| {
        refused(mapping::read(format!("{head}{text}").as_bytes()), Place::Line(line), message);
    };
    refused("1 10 UX\n2 10\n", 3, "`2 10` must be `row node label`");
    refused(
        "1 10 UX\n3 10 UY\n",
        3,
        "the row is `3`; the rows must follow one another, so it must be 2",
    );
    refused("1 x UX\n", 2, "the node `x` is no whole number");
    refused(
        "1 10 TEMP\n",
        2,
        "the label `TEMP` is unknown; known are UX, UY, UZ, ROTX, ROTY, ROTZ. Leave the other degrees of freedom out of the \
         matrix, or remove this file to read the matrix without nodes",
    );
}
