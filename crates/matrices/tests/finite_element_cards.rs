//! Variants of the text formats of programs of finite elements that are short enough to be read here.

use amontons_matrices::{Freedom, Matrix, Symmetry, abaqus, calculix, dmig, output4};

/// Row, column and value of each entry, by column.
fn entries(matrix: &Matrix) -> Vec<(usize, usize, f64)> {
    matrix.entries.iter().map(|entry| (entry.row, entry.column, entry.value)).collect()
}

/// Node and direction of each row.
fn freedoms(matrix: &Matrix) -> Vec<(u64, u8)> {
    let freedoms = matrix.freedoms.as_deref().unwrap();
    freedoms.iter().map(|&Freedom { node, direction }| (node, direction)).collect()
}

fn only(matrices: Vec<Matrix>) -> Matrix {
    let [matrix] = matrices.try_into().unwrap();
    matrix
}

#[test]
fn dmig_is_read_from_fields_of_all_widths() {
    let small = "\
$ A comment.
SPOINT         5
DMIG    K              0       6       2       0
DMIG    K              7       1               7       1   1.5+3
               7       3   -25.0               5       0  1.D+2        $ the second row of two in a line
DMIG    K              7       3               7       3     4.0
ENDDATA
";
    let named = small
        .replace("        $ the second row of two in a line", "         +K1")
        .replace("\n               7", "\n+K1            7");
    let large = "\
DMIG    K              0       6       2       0
DMIG*   K                              7               1
*                      7               1 1.500000000D+03
*                      7               3-2.500000000D+01
*                      5               0 1.000000000D+02
DMIG*   K                              7               3
*                      7               3 4.000000000D+00
";
    let free = "\
DMIG,K,0,6,2,0,,,3
dmig,k,7,1,,7,1,1.5+3,,+K1
+K1,7,3,-25.,,5,,100.
DMIG*,K,7,3,,
*,7,3,4.0
";
    let tabs = "DMIG\tK\t0\t6\t2\t0\nDMIG\tK\t7\t1\t\t7\t1\t1500.\n\t7\t3\t-25.\t\t5\t0\t100.\nDMIG\tK\t7\t3\t\t7\t3\t4.\n";
    let lines = small.replace('\n', "\r\n");
    for text in [small, &named, large, free, tabs, &lines] {
        let matrix = only(dmig::read(text.as_bytes()).unwrap());
        assert_eq!(matrix.name.as_deref(), Some("K"));
        assert_eq!(matrix.symmetry, Symmetry::Symmetric);
        assert_eq!(freedoms(&matrix), [(5, 0), (7, 1), (7, 3)], "{text}");
        let expected = [
            (1, 0, 100.0),
            (0, 1, 100.0),
            (1, 1, 1500.0),
            (2, 1, -25.0),
            (1, 2, -25.0),
            (2, 2, 4.0),
        ];
        assert_eq!(entries(&matrix), expected, "{text}");
    }
}

#[test]
fn dmig_of_several_names_and_forms_is_read_from_one_file() {
    let text = "\
DMIG,B,1,1,,2,1,3.
DMIG,B,0,1,1,0
DMIG,P,0,9,2,0,,,2
DMIG,P,2,0,,4,1,5.
DMIG,R,0,2,2,0
DMIG,R,8,1,,4,1,6.
DMIG,R,9,1,,4,2,7.
";
    let [square, numbered, labelled] = dmig::read(text.as_bytes()).unwrap().try_into().unwrap();
    assert_eq!(square.symmetry, Symmetry::General);
    assert_eq!((freedoms(&square), entries(&square)), (vec![(1, 1), (2, 1)], vec![(1, 0, 3.0)]));
    assert_eq!((numbered.rows, numbered.columns, entries(&numbered)), (1, 2, vec![(0, 1, 5.0)]));
    assert_eq!((labelled.rows, labelled.columns), (2, 2));
    assert_eq!(entries(&labelled), [(0, 0, 6.0), (1, 1, 7.0)]);
    assert_eq!((numbered.freedoms, labelled.freedoms), (None, None));
    let large = "\
DMIG*   P                              0               9               2*P1
*P1                    0               0                               2
DMIG*   P                              2               0                *P2
*P2                    4               1 5.000000000D+00                *P3
*P3                    4               2 6.000000000D+00
";
    let matrix = only(dmig::read(large.as_bytes()).unwrap());
    assert_eq!((matrix.rows, matrix.columns), (2, 2));
    assert_eq!(entries(&matrix), [(0, 1, 5.0), (1, 1, 6.0)]);
}

#[test]
fn matrices_of_a_structure_by_abaqus_have_nodes_or_numbers() {
    let nodes = "** A comment.\n9,1, 9,1,  2.5e+01\n4,2, 9,1, -1.0D+00\n\n4 2 4 2 3\n";
    let matrix = only(abaqus::read(nodes.as_bytes()).unwrap());
    assert_eq!((&matrix.name, matrix.symmetry), (&None, Symmetry::Symmetric));
    assert_eq!(freedoms(&matrix), [(4, 2), (9, 1)]);
    let expected = [(0, 0, 3.0), (1, 0, -1.0), (0, 1, -1.0), (1, 1, 25.0)];
    assert_eq!(entries(&matrix), expected);

    let both = format!("{nodes}9,1, 4,2, -2.0\n");
    let matrix = only(abaqus::read(both.as_bytes()).unwrap());
    assert_eq!(matrix.symmetry, Symmetry::General);
    assert_eq!(entries(&matrix), [(0, 0, 3.0), (1, 0, -2.0), (0, 1, -1.0), (1, 1, 25.0)]);

    let mixed = "1 1 4.0\n2 1 5.0\n2 2 7.0\n2 3 6.0\n3 3 8.0\n";
    let matrix = only(abaqus::read(mixed.as_bytes()).unwrap());
    assert_eq!(matrix.symmetry, Symmetry::Symmetric);
    let expected =
        [(0, 0, 4.0), (1, 0, 5.0), (0, 1, 5.0), (1, 1, 7.0), (2, 1, 6.0), (1, 2, 6.0), (2, 2, 8.0)];
    assert_eq!(entries(&matrix), expected);

    // Friction turns the normal motion of a node into tangential forces alone; a mirrored entry would undo its work.
    let friction = "5,1, 5,3, 0.4\n6,1, 6,3, 0.4\n";
    let matrix = only(abaqus::read(friction.as_bytes()).unwrap());
    assert_eq!(matrix.symmetry, Symmetry::General);
    assert_eq!(entries(&matrix), [(0, 1, 0.4), (2, 3, 0.4)]);

    let numbers = "1,1, 4.0\n2 1 -1.5\r\n2 2 3\n";
    let matrix = only(abaqus::read(numbers.as_bytes()).unwrap());
    assert_eq!((matrix.rows, &matrix.freedoms), (2, &None));
    assert_eq!(entries(&matrix), [(0, 0, 4.0), (1, 0, -1.5), (0, 1, -1.5), (1, 1, 3.0)]);
}

#[test]
fn headers_of_an_input_deck_name_matrices_and_tell_their_symmetry() {
    let text = "\
*Matrix Input, Name=K1, Type=Unsymmetric
1,1, 1,1, 2.
1,1, 1,2, 3.
*MATRIX INPUT, NAME=M1
1,1, 1,1, 4.
*MATRIX ASSEMBLE, STIFFNESS=K1, MASS=M1
";
    let [stiffness, mass] = abaqus::read(text.as_bytes()).unwrap().try_into().unwrap();
    assert_eq!((stiffness.name.as_deref(), mass.name.as_deref()), (Some("K1"), Some("M1")));
    assert_eq!((stiffness.symmetry, mass.symmetry), (Symmetry::General, Symmetry::Symmetric));
    assert_eq!(entries(&stiffness), [(0, 0, 2.0), (0, 1, 3.0)]);
}

/// Two springs in a row: along direction 1 between nodes 5 and 7 (2 N/m), and 7 and 9 (3 N/m).
const ELEMENTS: &str = "\
**
** ELEMENT NUMBER 12 STEP NUMBER 1 INCREMENT NUMBER 1
*USER ELEMENT, NODES=         2, LINEAR, UNSYM
** ELEMENT NODES
**          7,          9
          1
*MATRIX,TYPE=STIFFNESS
  3.0000000000000    , -4.0000000000000    ,
 -3.0000000000000    ,  3.0000000000000    
** ELEMENT NUMBER 11 STEP NUMBER 1 INCREMENT NUMBER 1
** ELEMENT TYPE SPRINGA
*USER ELEMENT, NODES=         2, LINEAR
** ELEMENT NODES
**          5,          7
          1
*MATRIX,TYPE=STIFFNESS
  2.0000000000000    ,
 -2.0000000000000    ,  2.0000000000000    \n*MATRIX,TYPE=MASS
 0.5,
 0., 0.5
";

#[test]
fn elements_are_added_up() {
    let [mass, stiffness] = abaqus::read(ELEMENTS.as_bytes()).unwrap().try_into().unwrap();
    assert_eq!(
        (stiffness.name.as_deref(), mass.name.as_deref()),
        (Some("STIFFNESS"), Some("MASS"))
    );
    assert_eq!((stiffness.symmetry, mass.symmetry), (Symmetry::General, Symmetry::Symmetric));
    assert_eq!(freedoms(&stiffness), [(5, 1), (7, 1), (9, 1)]);
    // The values of an unsymmetric element go down its columns.
    let expected = [
        (0, 0, 2.0),
        (1, 0, -2.0),
        (0, 1, -2.0),
        (1, 1, 5.0),
        (2, 1, -4.0),
        (1, 2, -3.0),
        (2, 2, 3.0),
    ];
    assert_eq!(entries(&stiffness), expected);
    assert_eq!(freedoms(&mass), [(5, 1), (7, 1)]);
    assert_eq!(entries(&mass), [(0, 0, 0.5), (1, 1, 0.5)]);
}

#[test]
fn directions_of_an_element_change_at_nodes_and_modes_have_none() {
    let text = "\
*USER ELEMENT, NODES=4, LINEAR
** ELEMENT NODES
** 2, 3, 8, -1
** NODE NUMBERS WHICH ARE NOT POSITIVE INDICATE INTERNAL NODES.
1, 3
3, 6
4, 1
*MATRIX,TYPE=STIFFNESS
1.,
0., 2.,
0., 0., 3.
0., 0., 0., 4.
0., 0., 0., 0.
5.,
7., 0., 0., 0.
0., 6.
";
    let matrix = only(abaqus::read(text.as_bytes()).unwrap());
    assert_eq!(freedoms(&matrix), [(1, 0), (2, 1), (2, 3), (3, 1), (3, 3), (8, 6)]);
    let expected = [
        (0, 0, 6.0),
        (1, 0, 7.0),
        (0, 1, 7.0),
        (1, 1, 1.0),
        (2, 2, 2.0),
        (3, 3, 3.0),
        (4, 4, 4.0),
        (5, 5, 5.0),
    ];
    assert_eq!(entries(&matrix), expected);
}

#[test]
fn both_triangles_in_a_file_of_calculix_are_a_general_matrix() {
    let matrix = calculix::read(b"1 1 2.\r\n1 2 3.\r\n2 1 4.\r\n").unwrap();
    assert_eq!(matrix.symmetry, Symmetry::General);
    assert_eq!(entries(&matrix), [(0, 0, 2.0), (1, 0, 4.0), (0, 1, 3.0)]);
}

#[test]
fn output4_counts_words_or_values() {
    let head = |count| {
        format!("       1       3       2       2M       1P,3E12.5\n       1       1{count:8}\n")
    };
    let rest = " 1.00000E+00 0.00000D+00-3.00000+100\n       2       1       1\n 1.00000E+00\n";
    for count in [3, 6] {
        let text = head(count) + rest;
        let matrix = only(output4::read(text.as_bytes()).unwrap());
        assert_eq!(entries(&matrix), [(0, 0, 1.0), (2, 0, -3e100)]);
    }
}

#[test]
fn strings_of_output4_have_two_words_where_rows_are_many() {
    let text = "       1   70000       2       1M       1P,2E16.9
       1       0       5
       3   69999
 1.500000000E+00 2.500000000E+00
       2       1       1
 1.000000000E+00
";
    let matrix = only(output4::read(text.as_bytes()).unwrap());
    assert_eq!((matrix.rows, matrix.columns), (70000, 1));
    assert_eq!(entries(&matrix), [(69998, 0, 1.5), (69999, 0, 2.5)]);
}

#[test]
fn symmetric_matrices_of_output4_may_differ_by_rounding() {
    let text = |lower: &str| {
        format!(
            "       2       2       6       2K       1P,2E23.16\n       1       1       2\n \
             4.0000000000000000E+00{lower}\n       2       1       2\n 1.0000000000000000E+00 \
             9.0000000000000000E+00\n       3       1       1\n 1.0000000000000000E+00\n"
        )
    };
    let mean = 1.0 + 2f64.powi(-29);
    let matrix = only(output4::read(text(" 1.0000000037252903E+00").as_bytes()).unwrap());
    assert_eq!(entries(&matrix), [(0, 0, 4.0), (1, 0, mean), (0, 1, mean), (1, 1, 9.0)]);
    let fault = output4::read(text(" 1.0000000070000000E+00").as_bytes()).unwrap_err();
    assert_eq!(
        fault.message,
        "the file says that the matrix is symmetric, but row 2 and column 1 hold 1.000000007, and row 1 and column 2 hold 1; \
         say that it is general, or correct one of them"
    );
}
