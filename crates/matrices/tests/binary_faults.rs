//! What is wrong in a binary file is told with the remedy.

use amontons_matrices::{Fault, Location, Matrix, Place, mat, mat73, npy, npz, open};
use std::fmt::Debug;
use std::fs;
use std::io::{Cursor, Write};
use std::path::Path;
use zip::write::SimpleFileOptions;

fn data(name: &str) -> Vec<u8> {
    fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)).unwrap()
}

#[track_caller]
fn refused<T: Debug>(read: Result<T, Fault>, message: &str) {
    assert_eq!(read.unwrap_err().message, message);
}

/// A `.npy` file of version 1 with this header.
fn array(header: &str, numbers: &[u8]) -> Vec<u8> {
    let mut content = b"\x93NUMPY\x01\x00".to_vec();
    content.extend((header.len() as u16).to_le_bytes());
    content.extend(header.bytes());
    content.extend(numbers);
    content
}

/// The header of an array.
fn header(descr: &str, shape: &str) -> String {
    format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}")
}

/// The content of a `.npy` file of integers.
fn integers(numbers: &[i64]) -> Vec<u8> {
    let bytes: Vec<_> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
    array(&header("<i8", &format!("({},)", numbers.len())), &bytes)
}

fn archive(members: &[(&str, &[u8])]) -> Vec<u8> {
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in members {
        zip.start_file(format!("{name}.npy"), SimpleFileOptions::default()).unwrap();
        zip.write_all(content).unwrap();
    }
    zip.finish().unwrap().into_inner()
}

fn read_archive(content: &[u8]) -> Result<Matrix, Fault> {
    let mut archive = npz::Archive::new(content)?;
    let name = archive.names()[0].clone();
    archive.read(&name)
}

#[test]
fn wrong_arrays_are_refused() {
    let read = |content: &[u8]| npy::read(content);
    refused(read(b""), "the file is no NumPy array; write it with numpy.save");
    refused(read(b"\x93NUMPY\x01\x00\xff\xffx"), "the file ends within its header; write it again");
    refused(
        read(b"\x93NUMPY\x09\x00\x00\x00"),
        "the version 9 of the format is unknown; known are 1, 2 and 3",
    );
    refused(
        read(&array("{'descr': '<f8'}", &[])),
        "the header `{'descr': '<f8'}` needs the keys descr, fortran_order and shape; write the array with numpy.save",
    );
    refused(
        read(&array(&header("<f8", "(2, 2)"), &[0; 24])),
        "the values have 24 bytes, but the header states 32; the file may have been cut off: write it again",
    );
    refused(
        read(&array(&header("<f8", "(9223372036854775807, 9223372036854775807)"), &[0; 8])),
        "the values have 8 bytes, but the header states more than there can be; the file may have been cut off: write it again",
    );
    refused(
        read(&array(&header("<f8", "(1,)"), &[0; 8])),
        "the array has 1 dimensions; a matrix has two",
    );
    for descr in ["<c16", "|O", "<f2", "<M8[ns]"] {
        refused(
            read(&array(&header(descr, "(1, 1)"), &[0; 2])),
            &format!(
                "the array has numbers of the type `{descr}`; a matrix needs real numbers: convert it with astype(float)"
            ),
        );
    }
    refused(
        read(&array(&header("<f8", "(1, 2)"), &[&[0; 8][..], &f64::NAN.to_le_bytes()].concat())),
        "the value of row 1 and column 2 is NaN; a matrix needs finite numbers",
    );
}

#[test]
fn numbers_of_all_kinds_and_orders_are_read() {
    let values = |content: &[u8]| -> Vec<_> {
        npy::read(content).unwrap().entries.iter().map(|entry| entry.value).collect()
    };
    for (descr, bytes) in [
        ("|i1", &[0xfe_u8][..]),
        ("<i2", &[0xfe, 0xff]),
        (">i4", &[0xff, 0xff, 0xff, 0xfe]),
        (">i8", &[0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xfe]),
        ("<f4", &[0, 0, 0, 0xc0]),
        (">f4", &[0xc0, 0, 0, 0]),
        ("<f8", &[0, 0, 0, 0, 0, 0, 0, 0xc0]),
    ] {
        assert_eq!(values(&array(&header(descr, "(1, 1)"), bytes)), [-2.0], "{descr}");
    }
    let of_python_2 = header("<f8", "(1L, 1L)");
    assert_eq!(values(&array(&of_python_2, &2.5_f64.to_le_bytes())), [2.5]);
    for (descr, bytes) in
        [("|b1", &[1_u8][..]), ("|u1", &[1]), (">u2", &[0, 1]), ("<u4", &[1, 0, 0, 0])]
    {
        assert_eq!(values(&array(&header(descr, "(1, 1)"), bytes)), [1.0], "{descr}");
    }
}

#[test]
fn wrong_archives_are_refused() {
    let layout = |name: &str| array(&header("|S3", "()"), name.as_bytes());
    let (csc, shape) = (layout("csc"), integers(&[2, 2]));
    let values = array(&header("<f8", "(2,)"), &[1.0_f64, 2.0].map(f64::to_le_bytes).concat());
    let sparse = |indices: &[i64], pointers: &[i64]| {
        let (indices, pointers) = (integers(indices), integers(pointers));
        read_archive(&archive(&[
            ("indices", &indices),
            ("indptr", &pointers),
            ("format", &csc),
            ("shape", &shape),
            ("data", &values),
        ]))
    };
    assert_eq!(sparse(&[0, 1], &[0, 1, 2]).unwrap().entries.len(), 2);
    refused(
        sparse(&[0, 2], &[0, 1, 2]),
        "the entry in row 3 and column 2 is outside of the matrix, which has 2 rows and 2 columns; state larger numbers of \
         rows and columns, or remove the entry",
    );
    refused(
        sparse(&[0, -1], &[0, 1, 2]),
        "an entry of column 1 has the row -1; rows are counted from 0",
    );
    refused(
        sparse(&[0, 0], &[0, 2, 2]),
        "row 1 and column 1 have a second entry; add the two up, or remove one",
    );
    refused(
        sparse(&[0, 1], &[0, 2, 1]),
        "column 1 begins at entry 2 and ends at entry 1; column pointers must not decrease",
    );
    refused(
        sparse(&[0, 1], &[0, 1]),
        "there are 2 column pointers, but 2 columns need one each and one more for the end",
    );
    refused(
        sparse(&[0, 1, 1], &[0, 1, 2]),
        "there are 3 row indices, but 2 values; each entry needs one of both",
    );
    refused(
        read_archive(&data("A_bsr.npz")),
        "the sparse layout `bsr` is unknown; known are csc, csr and coo: convert the matrix with tocsc()",
    );
    refused(
        read_archive(&archive(&[("format", &csc), ("data", &values)])),
        "the member `shape` cannot be read: specified file not found in archive; write the file again",
    );
    let coo = layout("coo");
    let (row, col) = (integers(&[0, -1]), integers(&[0, 1]));
    refused(
        read_archive(&archive(&[
            ("format", &coo),
            ("shape", &shape),
            ("data", &values),
            ("row", &row),
            ("col", &col),
        ])),
        "an entry is in row -1 and column 1; both are counted from 0",
    );
    let content = data("A_csc.npz");
    let fault = npz::Archive::new(&content[..content.len() / 2]).map(|_| ()).unwrap_err();
    assert!(fault.message.starts_with("the file is no archive: "), "{}", fault.message);
}

#[test]
fn parts_that_decompress_beyond_the_limit_are_refused() {
    let message = |file: &[u8]| {
        format!(
            "the matrix needs more than {} bytes when it is decompressed, which is the limit for a file of this size; write \
             it as a sparse matrix, or without compression",
            (32 << 20) + 64 * file.len()
        )
    };
    // More bytes, and more numbers, than the limit.
    for count in [40_000_000, 6_000_000] {
        let header = header("|i1", &format!("(1, {count})"));
        let content = archive(&[("A", &array(&header, &vec![1; count]))]);
        refused(read_archive(&content), &message(&content));
    }

    // A variable of level 5: flags (of an array of the class double), dimensions, name, and zeros.
    let count = 6_000_000;
    let element = |kind: u32, data: &[u8]| {
        [&kind.to_le_bytes(), &(data.len() as u32).to_le_bytes(), data].concat()
    };
    let body = [
        element(6, &[6, 0, 0, 0, 0, 0, 0, 0]),
        element(5, &[1_u32, count].map(u32::to_le_bytes).concat()),
        element(1, b"Aaaaaaaa"),
        element(9, &vec![0; 8 * count as usize]),
    ];
    let mut zlib = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
    zlib.write_all(&element(14, &body.concat())).unwrap();
    let mut content = vec![b' '; 124];
    content.extend([0, 1, b'I', b'M']);
    content.extend(element(15, &zlib.finish().unwrap()));
    refused(
        read_mat(&content, "Aaaaaaaa"),
        &format!("in the matrix `Aaaaaaaa`: {}", message(&content)),
    );
}

fn read_mat(content: &[u8], name: &str) -> Result<Matrix, Fault> {
    mat::File::new(content)?.read(name)
}

#[test]
fn matrices_of_a_matlab_file_are_listed_without_other_variables() {
    assert_eq!(mat::File::new(&data("v7.mat")).unwrap().names(), ["A", "K", "D"]);
    assert_eq!(mat::File::new(&data("v6.mat")).unwrap().names(), ["A", "n"]);
    let mut names = mat73::File::new(&data("v73.mat")).unwrap().names().to_owned();
    names.sort();
    assert_eq!(names, ["A", "D", "K"]);
}

#[test]
fn wrong_matlab_files_are_refused() {
    let message = "the file is no MATLAB file of level 5; write it with `save -v7` in MATLAB, or with scipy.io.savemat";
    refused(read_mat(b"", "A"), message);
    let mut content = data("v6.mat");
    refused(read_mat(&content, "B"), "there is no matrix `B`");
    let fault = read_mat(&content[..content.len() - 8], "A").unwrap_err();
    // The last variable, of 64 bytes with its tag.
    assert_eq!(fault.place, Place::Offset(content.len() - 64));
    assert_eq!(fault.message, "the file ends within this variable; write it again");

    // The row of the first entry, which follows the tag of its element (miINT32, 64 entries).
    let tag = [5, 0, 0, 0, 0, 1, 0, 0];
    let at = content.windows(8).position(|window| window == tag).unwrap() + 8;
    content[at] = 12;
    let fault = read_mat(&content, "A").unwrap_err();
    assert_eq!(fault.place, Place::Offset(128));
    assert_eq!(
        fault.message,
        "in the matrix `A`: the entry in row 13 and column 1 is outside of the matrix, which has 12 rows and 12 columns; \
         state larger numbers of rows and columns, or remove the entry"
    );

    // In the middle of a compressed variable, and in its checksum.
    let content = data("v7.mat");
    let length = u32::from_le_bytes(*content[132..].first_chunk().unwrap()) as usize;
    for at in [200, 136 + length - 1] {
        let mut content = content.clone();
        content[at] ^= 0xff;
        let fault = read_mat(&content, "A").unwrap_err();
        assert_eq!(fault.place, Place::Offset(128));
        assert!(fault.message.ends_with("; write the file again"), "{}", fault.message);
    }
}

#[test]
fn wrong_files_of_version_7_3_are_refused() {
    let content = data("v73.mat");
    let fault = mat73::File::new(&content[..2000]).map(|_| ()).unwrap_err();
    assert!(fault.message.ends_with("; write it again with `save -v7`"), "{}", fault.message);
    let read = |content: &[u8]| mat73::File::new(content)?.read("K");
    // The column pointers of K, which are not compressed.
    let pointers: Vec<u8> = [0_u64, 4, 8].into_iter().flat_map(u64::to_le_bytes).collect();
    let at = content.windows(24).position(|window| window == pointers).unwrap();
    let mut content = content;
    content[at] = 1;
    refused(read(&content), "in the matrix `K`: the first column pointer is 1; it must be 0");
}

#[test]
fn a_location_is_opened_or_refused_with_its_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let message = |location: &str| {
        let location: Location = path(location).to_str().unwrap().parse().unwrap();
        open(&location).map(|_| ()).unwrap_err().to_string()
    };
    let told = |name: &str, rest: &str| format!("{}{rest}", path(name).display());
    for name in ["v7.mat", "K.matrix", "K.mapping"] {
        fs::write(path(name), data(name)).unwrap();
    }
    fs::write(path("K.txt"), "").unwrap();
    fs::write(path("K.mtx"), "%%MatrixMarket matrix array real general\n1 1\nx\n").unwrap();

    assert_eq!(
        message("v7.mat"),
        told(
            "v7.mat",
            ": there are several matrices: `A`, `K`, `D`; choose one by its name after #, as in FILE#NAME"
        )
    );
    assert_eq!(
        message("v7.mat#B"),
        told("v7.mat", ": there is no matrix `B`; there are `A`, `K`, `D`")
    );
    assert_eq!(message("K.mtx"), told("K.mtx", ", line 3: `x` must be one number"));
    assert_eq!(
        message("K.matrix#K"),
        told("K.matrix", ": the file holds one matrix, which has no name; leave out #K")
    );
    assert_eq!(
        message("K.txt"),
        told(
            "K.txt",
            ": the extension .txt belongs to no known format; known are .mtx (Matrix Market, Abaqus), .hb, .rb, .rua, .rsa, .rra, \
             .rza, .matrix, .stiff, .mass and .damp (Harwell–Boeing, as HBMAT of Ansys writes it), .npy and .npz (NumPy, \
             SciPy), .mat (MATLAB), .sti and .mas (CalculiX), .pch, .dmig and .bdf (DMIG of Nastran), .op4 (OUTPUT4 of Nastran)"
        )
    );
    assert!(message("none#1/K.npy").starts_with(&told("none#1/K.npy", ": cannot read the file: ")));

    let mapping = data("K.mapping");
    let cut = mapping.iter().rposition(|&byte| byte == b'U').unwrap();
    fs::write(path("K.mapping"), &mapping[..cut]).unwrap();
    assert_eq!(
        message("K.matrix"),
        told("K.mapping", ", line 13: `12            60` must be `row node label`")
    );
    let last = mapping[..cut].iter().rposition(|&byte| byte == b'\n').unwrap();
    fs::write(path("K.mapping"), &mapping[..last]).unwrap();
    assert_eq!(
        message("K.matrix"),
        told(
            "K.matrix",
            ": the file of degrees of freedom beside has 11 of them, but the matrix has 12 rows and 12 columns; write both \
             files again from one model"
        )
    );
}

#[test]
fn a_degree_of_freedom_that_occurs_twice_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("K.matrix");
    fs::write(&path, data("K.matrix")).unwrap();
    let mapping = String::from_utf8(data("K.mapping")).unwrap().replacen("UY", "UX", 1);
    fs::write(folder.path().join("K.mapping"), mapping).unwrap();
    let error = open(&Location { path, name: None }).unwrap_err();
    assert_eq!(
        error.fault().message,
        "node 10 has the direction 1 twice; each row needs a degree of freedom of its own"
    );
}
