//! Damaged files of all formats: no reader panics, gives an entry outside of its matrix, or takes more memory than the file
//! justifies.
//!
//! `cargo test --release -p amontons-matrices --test mutated -- --ignored --nocapture` reads 100,000 of each format.
//! `AMONTONS_SEED` chooses them; it is printed, and is the seconds since 1970 unless given, so that each run has files of its
//! own. The short test has the same files at each run.
#![expect(unsafe_code, reason = "an allocator that counts")]

mod damage;
mod memory;

use amontons_matrices::{Fault, Matrix, Place, Symmetry};
use amontons_matrices::{
    abaqus, calculix, dmig, harwell_boeing, mapping, mat, mat73, matrix_market, mesh, npy, npz,
    output4,
};
use damage::{Random, damage};
use memory::{Counting, peak};
use std::io::{Cursor, Read, Write};
use std::panic::catch_unwind;
use std::path::Path;
use std::sync::Mutex;
use std::time::{SystemTime, UNIX_EPOCH};
use std::{env, fs};
use zip::CompressionMethod;
use zip::write::SimpleFileOptions;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// A reader that is tried, and the files in `tests/data` that are damaged for it.
struct Reader {
    name: &'static str,
    files: &'static [&'static str],
    read: fn(&[u8]) -> Result<Vec<Matrix>, Fault>,
}

const READERS: &[Reader] = &[
    Reader {
        name: "Matrix Market",
        files: &["A.mtx", "K.mtx", "A_array.mtx", "K_array.mtx"],
        read: |content| matrix_market::read(content).map(|matrix| vec![matrix]),
    },
    Reader {
        name: "Harwell–Boeing",
        files: &["A.rua", "K.matrix"],
        read: |content| harwell_boeing::read(content).map(|matrix| vec![matrix]),
    },
    Reader {
        name: "mesh of Abaqus",
        files: &["tets.inp"],
        read: |content| {
            let mesh = mesh::inp::read(content)?;
            let count = mesh.nodes.len();
            assert!(mesh.nodes.is_sorted_by(|a, b| a < b) && mesh.points.len() == count);
            assert!(mesh.surface().iter().flatten().all(|&corner| corner < count));
            Ok(Vec::new())
        },
    },
    Reader {
        name: "mapping of Ansys",
        files: &["K.mapping"],
        read: |content| mapping::read(content).map(|_| Vec::new()),
    },
    Reader {
        name: "NumPy",
        files: &["A.npy", "A_fortran.npy"],
        read: |content| npy::read(content).map(|matrix| vec![matrix]),
    },
    Reader {
        name: "NumPy archive",
        files: &["A_csc.npz", "A_csr.npz", "A_coo.npz", "A_bsr.npz", "dense.npz"],
        read: read_archive,
    },
    Reader {
        name: "members of a NumPy archive",
        files: &["A_csc.npz", "A_csr.npz", "A_coo.npz", "A_bsr.npz", "dense.npz"],
        read: |content| read_archive(&with_checksums(content)),
    },
    Reader {
        name: "MATLAB, level 5",
        files: &["v6.mat", "v7.mat", "big_endian.mat"],
        read: |content| {
            let file = mat::File::new(content)?;
            file.names().iter().map(|name| file.read(name)).collect()
        },
    },
    Reader {
        name: "MATLAB, version 7.3",
        files: &["v73.mat"],
        read: |content| {
            let file = mat73::File::new(content)?;
            file.names().iter().map(|name| file.read(name)).collect()
        },
    },
    Reader {
        name: "CalculiX",
        files: &["tets.sti", "tets.mas"],
        read: |content| calculix::read(content).map(|matrix| vec![matrix]),
    },
    Reader {
        name: "degrees of freedom of CalculiX",
        files: &["tets.dof"],
        read: |content| calculix::freedoms(content).map(|_| Vec::new()),
    },
    Reader {
        name: "Abaqus",
        files: &["tets_nodes.mtx", "tets_numbers.mtx", "tets_substructure.mtx"],
        read: abaqus::read,
    },
    Reader { name: "DMIG", files: &["tets_small.bdf", "tets_large.pch"], read: dmig::read },
    Reader {
        name: "OUTPUT4 as text",
        files: &["tets_text.op4", "tets_text_strings.op4", "tets_text_bigmat.op4"],
        read: output4::read,
    },
    Reader {
        name: "OUTPUT4 in records",
        files: &["tets_dense.op4", "tets_strings.op4", "tets_bigmat.op4", "tets_single.op4"],
        read: output4::read,
    },
];

fn read_archive(content: &[u8]) -> Result<Vec<Matrix>, Fault> {
    let mut archive = npz::Archive::new(content)?;
    let names = archive.names().to_owned();
    names.iter().map(|name| archive.read(name)).collect()
}

/// The content of all members of an archive, one after another, each after its name and length in lines of text: damage to it
/// has no checksum to pass.
fn without_checksums(content: &[u8]) -> Vec<u8> {
    let mut zip = zip::ZipArchive::new(Cursor::new(content)).unwrap();
    let mut plain = Vec::new();
    for index in 0..zip.len() {
        let mut file = zip.by_index(index).unwrap();
        let mut member = Vec::new();
        file.read_to_end(&mut member).unwrap();
        writeln!(plain, "{}\n{}", file.name().unwrap(), member.len()).unwrap();
        plain.extend(member);
    }
    plain
}

/// An archive of these members, as far as their names and lengths can be read.
fn with_checksums(mut plain: &[u8]) -> Vec<u8> {
    fn line<'a>(plain: &mut &'a [u8]) -> Option<&'a str> {
        let end = plain.iter().position(|&byte| byte == b'\n')?;
        let line = std::str::from_utf8(&plain[..end]).ok()?;
        *plain = &plain[end + 1..];
        Some(line)
    }
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    while let Some(name) = line(&mut plain) {
        let Some(length) = line(&mut plain).and_then(|length| length.parse::<usize>().ok()) else {
            break;
        };
        let (member, rest) = plain.split_at(length.min(plain.len()));
        plain = rest;
        let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
        if zip.start_file(name, options).is_err() {
            break;
        }
        zip.write_all(member).unwrap();
    }
    zip.finish().unwrap().into_inner()
}

/// Reads a damaged content and judges the result.
fn try_once(reader: &Reader, content: &[u8]) {
    let (result, taken) = peak(|| (reader.read)(content));
    assert!(
        taken <= (64 << 20) + 64 * content.len(),
        "{taken} bytes for a file of {}",
        content.len()
    );
    match result {
        Ok(matrices) => matrices.iter().for_each(judge),
        Err(Fault { place, message }) => {
            assert!(!message.is_empty() && message.len() < 1000, "a message of {}", message.len());
            match place {
                Place::Line(line) => {
                    assert!(line >= 1 && line <= content.len() + 1, "line {line}: {message}");
                }
                Place::Offset(offset) => {
                    assert!(offset <= content.len(), "byte {offset}: {message}");
                }
                Place::Whole => {}
            }
        }
    }
}

fn judge(matrix: &Matrix) {
    for entry in &matrix.entries {
        assert!(entry.row < matrix.rows && entry.column < matrix.columns, "{entry:?}");
        assert!(entry.value.is_finite(), "{entry:?}");
    }
    let order = matrix.entries.is_sorted_by(|a, b| (a.column, a.row) < (b.column, b.row));
    assert!(order, "entries are out of order, or twice");
    let sign = match matrix.symmetry {
        Symmetry::General => return,
        Symmetry::Symmetric => 1.0,
        Symmetry::SkewSymmetric => -1.0,
    };
    assert_eq!(matrix.rows, matrix.columns);
    for entry in &matrix.entries {
        let place = (entry.row, entry.column);
        let mirrored = matrix.entries.binary_search_by_key(&place, |e| (e.column, e.row));
        assert_eq!(matrix.entries[mirrored.unwrap()].value, sign * entry.value);
    }
}

/// Damages files for each reader so many times. The environment can give another seed.
fn mutate(count: u64, seed: u64) {
    static ALONE: Mutex<()> = Mutex::new(());
    // The memory of one test is counted at a time.
    let _alone = ALONE.lock();
    let seed = match env::var("AMONTONS_SEED") {
        Ok(seed) => seed.parse().unwrap(),
        Err(_) => seed,
    };
    println!("AMONTONS_SEED={seed}");
    for reader in READERS {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
        let mut contents: Vec<_> =
            reader.files.iter().map(|file| fs::read(folder.join(file)).unwrap()).collect();
        if reader.name.starts_with("members") {
            contents = contents.iter().map(|content| without_checksums(content)).collect();
        }
        for content in &contents {
            try_once(reader, content);
        }
        for index in 0..count {
            let mut random = Random(seed ^ index.wrapping_mul(0xd134_2543_de82_ef95));
            let mut content = contents[random.below(contents.len())].clone();
            let other = &contents[random.below(contents.len())];
            for _ in 0..=random.below(3) {
                damage(&mut content, other, &mut random);
            }
            let outcome = catch_unwind(|| try_once(reader, &content));
            assert!(
                outcome.is_ok(),
                "{}: AMONTONS_SEED={seed} makes damaged file {index} fail",
                reader.name
            );
        }
    }
}

#[test]
fn damaged_files_are_read_or_refused() {
    mutate(300, 1);
}

#[test]
#[ignore = "long"]
fn many_damaged_files_are_read_or_refused() {
    mutate(100_000, SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_secs());
}
