//! Matrix Market files: what is read, and what is told of wrong ones.

use amontons_matrices::{Entry, Fault, Matrix, Place, matrix_market};

/// The entries as triples, rows and columns counted from 1.
fn entries(matrix: &Matrix) -> Vec<(usize, usize, f64)> {
    let triple = |&Entry { row, column, value }: &Entry| (row + 1, column + 1, value);
    matrix.entries.iter().map(triple).collect()
}

#[track_caller]
fn refused(read: Result<Matrix, Fault>, place: Place, message: &str) {
    let fault = read.unwrap_err();
    assert_eq!((fault.place, &*fault.message), (place, message));
}

#[test]
fn wrong_matrix_market_files_are_told_with_their_line() {
    let real = "%%MatrixMarket matrix coordinate real";
    let general = format!("{real} general\n");
    let symmetric = format!("{real} symmetric\n");
    let skew = format!("{real} skew-symmetric\n");
    let array = "%%MatrixMarket matrix array real";
    let line = |text: &str, line, message: &str| {
        refused(matrix_market::read(text.as_bytes()), Place::Line(line), message);
    };
    let whole = |text: &str, message: &str| {
        refused(matrix_market::read(text.as_bytes()), Place::Whole, message);
    };

    whole("", "the file is empty");
    whole(&general, "the line of sizes is missing after the header");
    line(
        "1 1 3.0\n",
        1,
        "`1 1 3.0` must be `%%MatrixMarket matrix LAYOUT FIELD SYMMETRY`, such as `%%MatrixMarket matrix coordinate real \
         symmetric`",
    );
    line(
        "%%MatrixMarket matrix coordinate complex general\n",
        1,
        "the values are complex, but a real matrix is needed; write the real part of the matrix alone",
    );
    line(
        "%%MatrixMarket matrix coordinate pattern general\n",
        1,
        "the file has the pattern of a matrix without its values; write the matrix with its values (`real`)",
    );
    line(
        &format!("{real} hermitian\n"),
        1,
        "the matrix is Hermitian, but a real matrix is needed; write `symmetric`, if the values are real",
    );
    line(
        &format!("{real} other\n"),
        1,
        "the symmetry `other` is unknown; write `general`, `symmetric` or `skew-symmetric`",
    );
    line(
        "%%MatrixMarket matrix coordinate whole general\n",
        1,
        "the field `whole` is unknown; write `real` or `integer`",
    );
    line(
        "%%MatrixMarket matrix dense real general\n",
        1,
        "the layout `dense` is unknown; write `coordinate` or `array`",
    );
    line(&format!("{general}% c\n2 2\n"), 3, "the line of sizes must be `rows columns entries`");
    line(&format!("{array} general\n2 2 4\n"), 2, "the line of sizes must be `rows columns`");
    line(
        &format!("{symmetric}2 3 1\n1 1 1\n"),
        2,
        "a symmetric or skew-symmetric matrix must be square, but this one has 2 rows and 3 columns; correct the sizes, or \
         write `general` in the header",
    );
    line(
        &format!("{general}2 2 3\n1 1 1.0\n2 2 1.0\n"),
        4,
        "the file ends after 2 of 3 entries; it may have been cut off: write it again, or correct the sizes",
    );
    line(
        &format!("{general}9223372036854775807 9223372036854775807 9223372036854775807\n1 1 1\n"),
        3,
        "the file ends after 1 of 9223372036854775807 entries; it may have been cut off: write it again, or correct the sizes",
    );
    line(
        &format!("{general}2 2 1\n1 1 1.0\n\n% c\n2 2 1.0\n"),
        6,
        "the line follows after all 1 entries that line 3 completes; remove it, or correct the sizes",
    );
    line(
        &format!("{general}2 2 1\n0 1 1.0\n"),
        3,
        "the row is `0`; rows and columns are counted from 1",
    );
    line(
        &format!("{general}2 2 1\n1 x 1.0\n"),
        3,
        "the column `x` is no whole number; write `row column value`",
    );
    line(&format!("{general}2 2 1\n1 2\n"), 3, "`1 2` must be `row column value`");
    line(&format!("{general}2 2 1\n1 2 3 4\n"), 3, "`1 2 3 4` must be `row column value`");
    line(&format!("{array} general\n1 1\n1 2\n"), 3, "`1 2` must be one number");
    line(
        &format!("{general}2 3 1\n3 1 1.0\n"),
        3,
        "the entry in row 3 and column 1 is outside of the matrix, which has 2 rows and 3 columns; state larger numbers of \
         rows and columns, or remove the entry",
    );
    line(
        &format!("{general}2 2 1\n1 2 NaN\n"),
        3,
        "the value of row 1 and column 2 is NaN; a matrix needs finite numbers",
    );
    line(
        &format!("{general}2 2 2\n1 2 1.0\n1 2 1.0\n"),
        4,
        "row 1 and column 2 have a second entry (the first is in line 3); add the two up, or remove one",
    );
    line(
        &format!("{symmetric}2 2 2\n1 2 1.0\n2 1 2.0\n"),
        4,
        "the file says that the matrix is symmetric, but row 2 and column 1 hold 2, and row 1 and column 2 hold 1; say that \
         it is general, or correct one of them",
    );
    line(
        &format!("{skew}2 2 1\n1 1 1.0\n"),
        3,
        "the file says that the matrix is skew-symmetric, but row 1 and column 1 hold 1; it must be 0",
    );
}

#[test]
fn matrix_market_files_of_other_systems_and_fortran_are_read() {
    let text = "%%matrixmarket MATRIX Coordinate Integer General\r\n% comment\r\n\r\n 2 3 3 \r\n1 1 1.5D+03\r\n2 3 1.5+103\r\n1 2 -7";
    let matrix = matrix_market::read(text.as_bytes()).unwrap();
    assert_eq!((matrix.rows, matrix.columns), (2, 3));
    assert_eq!(entries(&matrix), [(1, 1, 1500.0), (1, 2, -7.0), (2, 3, 1.5e103)]);
}

#[test]
fn an_array_gives_columns_and_of_a_symmetric_matrix_the_lower_triangle() {
    let read = |text: &str| entries(&matrix_market::read(text.as_bytes()).unwrap());
    let array = "%%MatrixMarket matrix array real";
    assert_eq!(
        read(&format!("{array} general\n2 2\n1\n2\n0\n4\n")),
        [(1, 1, 1.0), (2, 1, 2.0), (2, 2, 4.0)]
    );
    assert_eq!(
        read(&format!("{array} symmetric\n2 2\n1\n2\n3\n")),
        [(1, 1, 1.0), (2, 1, 2.0), (1, 2, 2.0), (2, 2, 3.0)]
    );
    assert_eq!(
        read(&format!("{array} skew-symmetric\n3 3\n1\n2\n3\n")),
        [(2, 1, 1.0), (3, 1, 2.0), (1, 2, -1.0), (3, 2, 3.0), (1, 3, -2.0), (2, 3, -3.0)]
    );
}
