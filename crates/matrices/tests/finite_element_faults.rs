//! Wrong files of CalculiX and Abaqus: each is told with its place and its remedy.

use amontons_matrices::Place::{self, Line, Whole};
use amontons_matrices::{Fault, Location, abaqus, calculix, open};
use std::fs;

fn assert_fault<T: std::fmt::Debug>(found: Result<T, Fault>, place: Place, message: &str) {
    assert_eq!(found.unwrap_err(), Fault { place, message: message.into() });
}

#[test]
fn faults_of_calculix() {
    let cases = [
        ("", Whole, "the file has no entries; run CalculiX with *FREQUENCY, SOLVER=MATRIXSTORAGE"),
        (
            "1 1 2.0\n1 2\n",
            Line(2),
            "`1 2` is no entry; write a row, a column and a value, such as 1 2 -3.5e+08",
        ),
        (
            "0 1 2.0\n",
            Line(1),
            "`0 1 2.0` is no entry; write a row, a column and a value, such as 1 2 -3.5e+08",
        ),
        (
            "1 1 2.0\n1 2 3.0\n1 2 3.0\n",
            Line(3),
            "row 1 and column 2 have a second entry (the first is in line 2); add the two up, or remove one",
        ),
        (
            "1 1 NaN\n",
            Line(1),
            "the value of row 1 and column 1 is NaN; a matrix needs finite numbers",
        ),
    ];
    for (text, place, message) in cases {
        assert_fault(calculix::read(text.as_bytes()), place, message);
    }
}

#[test]
fn faults_of_degrees_of_freedom_of_calculix() {
    let direction =
        "is no degree of freedom; write a node and a direction from 1 to 3, such as 12.3";
    let cases = [
        ("1.1\n2\n", Line(2), format!("`2` {direction}")),
        ("1.4\n", Line(1), format!("`1.4` {direction}")),
        ("0.1\n", Line(1), format!("`0.1` {direction}")),
        (
            "1.1\n1.1\n",
            Line(2),
            "node 1 has direction 1 a second time: shells and beams, which CalculiX expands into solids, and cyclic sectors, \
             whose matrices are complex, cannot be read; store the matrices of the whole structure, made of solids"
                .into(),
        ),
    ];
    for (text, place, message) in cases {
        assert_fault(calculix::freedoms(text.as_bytes()), place, &message);
    }
}

#[test]
fn a_file_of_degrees_of_freedom_with_too_few_lines_is_told() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("block.sti");
    fs::write(&path, "1 1 2.0\n1 2 0.5\n2 2 3.0\n").unwrap();
    fs::write(path.with_extension("dof"), "1.1\n").unwrap();
    let error = open(&Location { path, name: None }).unwrap_err();
    assert_eq!(
        error.fault().message,
        "the file of degrees of freedom beside has 1 of them, but the matrix has 2 rows and 2 columns; write both files again \
         from one model"
    );
}

#[test]
fn faults_of_abaqus() {
    let cases = [
        (
            "1,1, 1,1, 2.\n1,1, 1\n",
            Line(2),
            "a line of 3 numbers is no entry of this matrix; write the matrix of the whole structure with *MATRIX OUTPUT, \
             FORMAT=MATRIX INPUT (five numbers) or COORDINATE (three)",
        ),
        (
            "3, 1,1, 1,2, 4.\n",
            Line(1),
            "a line of 6 numbers is no entry of this matrix; write the matrix of the whole structure with *MATRIX OUTPUT, \
             FORMAT=MATRIX INPUT (five numbers) or COORDINATE (three)",
        ),
        (
            "1,1, 1,x, 2.\n",
            Line(1),
            "`1,1, 1,x, 2.` is no entry; write node, direction, node, direction, value, or row, column, value",
        ),
        (
            "1,0, 2.\n",
            Line(1),
            "`1,0, 2.` is no entry; write node, direction, node, direction, value, or row, column, value",
        ),
        (
            "1,1, 1,1, 2.\n-1,1, 1,1, 3.\n",
            Line(2),
            "node -1 is internal: Abaqus adds nodes of numbers below 1 for Lagrange multipliers, hybrid elements and modes of \
             substructures; use elements and constraints without them (penalty instead of Lagrange multipliers), or write a \
             substructure of the nodes that matter",
        ),
        (
            "1,11, 1,11, 2.\n",
            Line(1),
            "degree of freedom 11 of node 1 is neither a displacement (1 to 3) nor a rotation (4 to 6); write the matrix of a \
             structure without temperatures, pressures and potentials",
        ),
        (
            "1,1, 2,1, 3.\n1,1, 2,1, 3.\n",
            Line(2),
            "node 1 direction 1 and node 2 direction 1 have a second entry (the first is in line 1); add the two up, or remove \
             one",
        ),
        (
            "*MATRIX INPUT, NAME=K, TYPE=SYMMETRIC\n1,1, 2,1, 3.\n2,1, 1,1, 4.\n",
            Line(3),
            "the file says that the matrix is symmetric, but node 2 direction 1 and node 1 direction 1 hold 4, and node 1 \
             direction 1 and node 2 direction 1 hold 3; say that it is general, or correct one of them",
        ),
        (
            "*MATRIX INPUT, NAME=K, TYPE=MASS\n",
            Line(1),
            "the type `MASS` of the matrix is unknown; write SYMMETRIC or UNSYMMETRIC, or *USER ELEMENT before it",
        ),
        (
            "** Loads\n*CLOAD, REAL\n2,3, 5.\n",
            Line(2),
            "`*CLOAD, REAL` begins no matrix; keep *MATRIX INPUT or *USER ELEMENT, and their lines of numbers",
        ),
        ("** nothing\n", Whole, "the file has no entries; write a matrix with *MATRIX OUTPUT"),
    ];
    for (text, place, message) in cases {
        assert_fault(abaqus::read(text.as_bytes()), place, message);
    }
}

#[test]
fn faults_of_elements() {
    let element =
        "*USER ELEMENT, NODES=2, LINEAR\n** ELEMENT NODES\n** 5, 7\n1\n*MATRIX, TYPE=MASS\n";
    let twice = "** ELEMENT NUMBER 3 STEP 1\n*USER ELEMENT, NODES=1\n** ELEMENT NODES\n** 5\n1\n*MATRIX, TYPE=MASS\n2.\n";
    let cases = [
        (
            format!("{element}1.,\n0.,\n"),
            Line(5),
            "the matrix has 2 values, but an element of 2 degrees of freedom needs 3, or 4 if it is unsymmetric; write the whole \
             file again",
        ),
        (format!("{element}1.,\n0., x\n"), Line(7), "`x` is no number; write one such as -3.5E+08"),
        (
            format!("{element}1.,\n0., 1e999\n"),
            Line(7),
            "the value of node 7 direction 1 and node 7 direction 1 is inf; a matrix needs finite numbers",
        ),
        (
            element.replace("NODES=2", "NODES=1000000000"),
            Line(1),
            "the element states 1000000000 nodes, but has 2 in the comments after ** ELEMENT NODES; write the whole file again",
        ),
        (
            element.replace("NODES=2", "NODES"),
            Line(1),
            "the element states no number of nodes; write NODES=8, for instance",
        ),
        (
            element.replace("\n1\n", "\n"),
            Line(1),
            "the element has no line of directions, such as 1, 2, 3; add one",
        ),
        (
            element.replace("\n1\n", "\n1\n3, 1\n"),
            Line(5),
            "the directions change at node 3 of the element; state nodes from 2 to 2, in order",
        ),
        (
            element.replace("\n1\n", "\n1\n,\n"),
            Line(5),
            "the directions change at node 0 of the element; state nodes from 2 to 2, in order",
        ),
        (
            element.replace("\n1\n", "\nx\n"),
            Line(4),
            "`x` is no whole number; write a node or a direction",
        ),
        (
            element.replace("5, 7", "5, 5"),
            Line(1),
            "the element has direction 1 of node 5 a second time; state each once",
        ),
        (
            element.replace("5, 7", "5, -7").replace("\n1\n", "\n1, 2\n"),
            Line(1),
            "node -7 is internal: Abaqus adds nodes of numbers below 1 for Lagrange multipliers, hybrid elements and modes of \
             substructures; use elements and constraints without them (penalty instead of Lagrange multipliers), or write a \
             substructure of the nodes that matter",
        ),
        (
            format!("{twice}{twice}"),
            Line(13),
            "element 3 has a second matrix of type `MASS`; write the matrices of one increment of one step",
        ),
        (
            format!("{element}1.\n0., 1.\n** ELEMENT NUMBER 3\n1, 2\n"),
            Line(9),
            "numbers stand before *USER ELEMENT; remove them, or put the keyword before them",
        ),
        (
            element.replace("*MATRIX, TYPE=MASS", "*ELEMENT"),
            Line(5),
            "`ELEMENT` is not of a file of elements; keep *USER ELEMENT, and *MATRIX with TYPE=STIFFNESS or MASS",
        ),
    ];
    for (text, place, message) in cases {
        assert_fault(abaqus::read(text.as_bytes()), place, message);
    }
}
