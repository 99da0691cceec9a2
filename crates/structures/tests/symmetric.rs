//! Reduction and bounds of symmetric structures, held against closed forms of chains of equal masses and springs.

use amontons_analysis::watch::Watch;
use amontons_matrices::{Entry, Location, Matrix, Symmetry, open};
use amontons_structures::symmetric::{Certificate, Request, Structure, certify, reduce};
use std::f64::consts::{PI, TAU};
use std::fs;
use std::ops::ControlFlow;

const MEMORY: usize = 1 << 30;
/// N/m and kg.
const SPRING: f64 = 3e6;
const MASS: f64 = 0.02;

/// What holds the first mass and the last.
#[derive(Clone, Copy)]
enum Ends {
    Springs,
    Nothing,
}

fn matrix(order: usize, entries: impl IntoIterator<Item = (usize, usize, f64)>) -> Matrix {
    let mut entries: Vec<Entry> =
        entries.into_iter().map(|(row, column, value)| Entry { row, column, value }).collect();
    entries.sort_by_key(|entry| (entry.column, entry.row));
    Matrix {
        name: None,
        rows: order,
        columns: order,
        entries,
        symmetry: Symmetry::General,
        freedoms: None,
    }
}

/// Equal chains side by side: stiffness and mass.
fn chains(copies: usize, masses: usize, ends: Ends) -> [Matrix; 2] {
    let order = copies * masses;
    let mut stiffness = Vec::new();
    for row in 0..order {
        let at = row % masses;
        let held = match ends {
            Ends::Springs => 2,
            Ends::Nothing => u8::from(at > 0) + u8::from(at + 1 < masses),
        };
        stiffness.push((row, row, SPRING * f64::from(held)));
        if at + 1 < masses {
            stiffness.extend([(row, row + 1, -SPRING), (row + 1, row, -SPRING)]);
        }
    }
    [matrix(order, stiffness), matrix(order, (0..order).map(|row| (row, row, MASS)))]
}

/// Frequencies of one chain, Hz, ascending.
#[allow(clippy::cast_precision_loss)]
fn frequencies(masses: usize, ends: Ends) -> Vec<f64> {
    let angle = |mode: usize| match ends {
        Ends::Springs => (mode + 1) as f64 * PI / (2.0 * (masses + 1) as f64),
        Ends::Nothing => mode as f64 * PI / (2.0 * masses as f64),
    };
    (0..masses).map(|mode| 2.0 * (SPRING / MASS).sqrt() * angle(mode).sin() / TAU).collect()
}

/// Reduces a structure to the nodes given and certifies it while nothing is held.
fn certified(matrices: &[Matrix; 2], retained: &[u64], limit: f64, modes_to: f64) -> Certificate {
    let structure = Structure::new(&matrices[0], &matrices[1]).unwrap();
    let retained = structure.rows_of(retained).unwrap();
    let request = Request { retained, modes_to, memory: MEMORY };
    let superelement = reduce(&structure, &request, Watch::IDLE).unwrap();
    certify(&structure, &superelement, &[], limit, MEMORY, Watch::IDLE).unwrap()
}

fn message(stiffness: &Matrix, mass: &Matrix) -> String {
    let structure = match Structure::new(stiffness, mass) {
        Ok(structure) => structure,
        Err(error) => return error.to_string(),
    };
    let request = Request { retained: vec![0], modes_to: 500.0, memory: MEMORY };
    let superelement = match reduce(&structure, &request, Watch::IDLE) {
        Ok(superelement) => superelement,
        Err(error) => return error.to_string(),
    };
    certify(&structure, &superelement, &[], 250.0, MEMORY, Watch::IDLE).unwrap_err().to_string()
}

#[test]
fn every_mode_of_a_chain_lies_in_its_interval_and_none_is_missing() {
    let exact = frequencies(200, Ends::Springs);
    // Between modes 40 and 41.
    let limit = f64::midpoint(exact[39], exact[40]);
    let certificate = certified(&chains(1, 200, Ends::Springs), &[1, 77, 200], limit, 3.0 * limit);
    assert_eq!((certificate.full, certificate.reduced), (40, 40));
    assert!(certificate.is_complete());
    for (mode, interval) in certificate.intervals.iter().enumerate() {
        let [low, high] = interval.frequencies();
        assert!(low <= exact[mode] && exact[mode] <= high, "{low} {} {high}", exact[mode]);
        assert!((high - low) / low < 1e-9, "mode {mode} is known to {}", high - low);
        assert!(certificate.frequencies[mode] >= low, "a superelement is never softer");
        assert!(certificate.error(mode).unwrap() < 0.02);
    }
}

/// A vector at a time finds one copy of an eigenvalue; the count tells how many there are. Ten copies are more than are found
/// in one block.
#[test]
fn all_copies_of_a_multiple_eigenvalue_are_found() {
    let exact = frequencies(30, Ends::Springs);
    let limit = f64::midpoint(exact[3], exact[4]);
    let ends: Vec<u64> = (0..10).map(|copy| 30 * copy + 1).collect();
    let certificate = certified(&chains(10, 30, Ends::Springs), &ends, limit, 4.0 * limit);
    assert_eq!((certificate.full, certificate.reduced), (40, 40));
    assert!(certificate.is_complete());
    for (mode, interval) in certificate.intervals.iter().enumerate() {
        let [low, high] = interval.frequencies();
        assert!(low <= exact[mode / 10] && exact[mode / 10] <= high, "mode {mode}");
    }
}

/// Thirty equal chains leave the first block within the space of eight of them.
#[test]
fn copies_that_no_start_vector_reaches_are_found_from_new_ones() {
    let limit = 1.2 * frequencies(2, Ends::Springs)[0];
    let nodes: Vec<u64> = (0..30).map(|copy| 2 * copy + 1).collect();
    let certificate = certified(&chains(30, 2, Ends::Springs), &nodes, limit, 10.0 * limit);
    assert!(certificate.is_complete());
    assert_eq!(certificate.full, 30);
}

#[test]
fn a_free_structure_has_its_rigid_mode_and_the_others_are_exact() {
    let exact = frequencies(60, Ends::Nothing);
    let limit = f64::midpoint(exact[9], exact[10]);
    let certificate = certified(&chains(1, 60, Ends::Nothing), &[1, 60], limit, 4.0 * limit);
    assert!(certificate.is_complete() && certificate.full == 10);
    assert!(certificate.is_rigid(0) && !certificate.is_rigid(1));
    for (interval, exact) in certificate.intervals.iter().zip(exact).skip(1) {
        let [low, high] = interval.frequencies();
        assert!(low <= exact && exact <= high);
    }
}

#[test]
fn modes_are_counted_beside_any_frequency_and_also_at_one_of_them() {
    let exact = frequencies(25, Ends::Springs);
    let chain = chains(1, 25, Ends::Springs);
    for (mode, &exact) in exact.iter().enumerate().take(20).skip(1) {
        let limit = exact * (1.0 + 1e-5);
        assert_eq!(certified(&chain, &[1, 25], limit, 1e4).full, mode + 1);
        let limit = exact * (1.0 - 1e-5);
        assert_eq!(certified(&chain, &[1, 25], limit, 1e4).full, mode);
        // The limit moves off the mode.
        let moved = certified(&chain, &[1, 25], exact, 1e4);
        assert!(moved.full == mode + 1 && moved.limit > exact && moved.is_complete());
    }
}

/// n springs in a row are k / n between the ends, whatever modes are kept.
#[test]
fn forces_at_retained_nodes_move_the_superelement_as_they_move_the_structure() {
    let [stiffness, mass] = chains(1, 50, Ends::Nothing);
    let structure = Structure::new(&stiffness, &mass).unwrap();
    let request = Request { retained: vec![0, 49], modes_to: 100.0, memory: MEMORY };
    let superelement = reduce(&structure, &request, Watch::IDLE).unwrap();
    let soft = SPRING / 49.0;
    for (at, expected) in [((0, 0), soft), ((0, 1), -soft), ((1, 0), -soft), ((1, 1), soft)] {
        let own = superelement.stiffness[at];
        assert!((own - expected).abs() < 1e-9 * SPRING, "{own} {expected}");
    }
    // A superelement that moves as a whole has all of the mass.
    let total: f64 = [(0, 0), (0, 1), (1, 0), (1, 1)].map(|at| superelement.mass[at]).iter().sum();
    assert!((total - 50.0 * MASS).abs() < 1e-12);
}

#[test]
fn a_superelement_that_keeps_too_little_is_not_certified() {
    let exact = frequencies(200, Ends::Springs);
    let limit = f64::midpoint(exact[39], exact[40]);
    let certificate = certified(&chains(1, 200, Ends::Springs), &[1, 200], limit, 0.8 * limit);
    assert!(certificate.full == 40 && certificate.reduced < 40);
    assert!(!certificate.is_complete());
}

#[test]
fn wrong_structures_are_refused_with_the_place_and_the_remedy() {
    let [stiffness, mass] = chains(1, 5, Ends::Springs);
    let changed = |matrix: &Matrix, at: usize, value: f64| {
        let mut matrix = matrix.clone();
        matrix.entries[at].value = value;
        matrix
    };
    let holds = |message: String, words: &str| assert!(message.contains(words), "{message}");
    let unsymmetric = message(&changed(&stiffness, 1, -2.9e6), &mass);
    holds(unsymmetric, "row 2 (point 2) and column 1 (point 1) hold -2900000");
    let massless = message(&stiffness, &changed(&mass, 2, 0.0));
    holds(massless, "the first is row 3, point 3; remove them by static condensation");
    holds(message(&changed(&stiffness, 0, -9e6), &mass), "has a negative eigenvalue");
    let fixed = message(&changed(&stiffness, 0, 1e36), &mass);
    holds(fixed, "row 1 and column 1 hold 1e36, which stands for a held degree of freedom");
    let indefinite = [(0, 1, 0.03), (1, 0, 0.03)];
    let masses = (0..5).map(|row| (row, row, MASS)).chain(indefinite);
    holds(message(&stiffness, &matrix(5, masses)), "mass matrix is not positive definite");
    let smaller = message(&stiffness, &chains(1, 4, Ends::Springs)[1]);
    holds(smaller, "has 4 rows and 4 columns, and the stiffness matrix 5 rows");
    // Two chains, of which one is not retained.
    let [stiffness, mass] = chains(2, 5, Ends::Nothing);
    holds(message(&stiffness, &mass), "can still move freely; retain at least three nodes");
}

/// The spring between the last mass and the ground pulls a little more than the chain holds: the lowest λ is a small part of the
/// limit below 0. It once counted as the motion of a rigid body.
#[test]
fn a_structure_that_falls_away_slowly_is_refused() {
    let [mut stiffness, mass] = chains(1, 30, Ends::Nothing);
    stiffness.entries.last_mut().unwrap().value -= 1e-5 * SPRING;
    let structure = Structure::new(&stiffness, &mass).unwrap();
    let request = Request { retained: vec![0, 29], modes_to: 500.0, memory: MEMORY };
    let superelement = reduce(&structure, &request, Watch::IDLE).unwrap();
    let error = certify(&structure, &superelement, &[], 250.0, MEMORY, Watch::IDLE).unwrap_err();
    assert!(error.to_string().contains("has a negative eigenvalue, ω² = -5"), "{error}");
}

/// A suspension that is far softer than the structure is no rigid body.
#[test]
fn a_soft_suspension_is_told_from_a_free_body() {
    let [mut stiffness, mass] = chains(1, 30, Ends::Nothing);
    stiffness.entries[0].value += 1e-7 * SPRING;
    let certificate = certified(&[stiffness, mass], &[1, 30], 250.0, 500.0);
    assert!(certificate.is_complete() && !certificate.is_rigid(0));
    // The whole chain on the soft spring.
    let expected = (1e-7 * SPRING / (30.0 * MASS)).sqrt() / TAU;
    let [low, high] = certificate.intervals[0].frequencies();
    assert!((low / expected - 1.0).abs() < 1e-5 && (high / low - 1.0) < 1e-4, "{low} {high}");
}

#[test]
fn memory_is_asked_for_before_it_is_taken() {
    let [stiffness, mass] = chains(1, 500, Ends::Springs);
    let structure = Structure::new(&stiffness, &mass).unwrap();
    let request = Request { retained: vec![0], modes_to: 100.0, memory: 1000 };
    let Err(error) = reduce(&structure, &request, Watch::IDLE) else { panic!("no place for it") };
    assert!(error.to_string().contains("allow more with --memory"), "{error}");
}

#[test]
fn work_that_is_ended_gives_no_result() {
    let [stiffness, mass] = chains(1, 500, Ends::Springs);
    let structure = Structure::new(&stiffness, &mass).unwrap();
    let request = Request { retained: vec![0, 499], modes_to: 1000.0, memory: MEMORY };
    let watch = Watch { go_on: &|| ControlFlow::Break(()), progress: &|_| {} };
    assert!(reduce(&structure, &request, watch).is_err());
}

#[test]
fn stiffness_and_mass_in_each_others_place_are_told() {
    let read = |name: &str| {
        let path = format!("{}/tests/data/{name}", env!("CARGO_MANIFEST_DIR"));
        let Ok(location) = path.parse::<Location>();
        open(&location).unwrap()
    };
    let [stiffness, mass] = ["block.sti", "block.mas"].map(read);
    assert!(Structure::new(&stiffness, &mass).is_ok());
    let message = Structure::new(&mass, &stiffness).unwrap_err().to_string();
    assert!(message.contains("in each other's place"), "{message}");
}

/// CalculiX prints seven digits. With 7, 8 and 9 modes wanted, its first elastic frequency of this block is 4326.818, 4326.817
/// and 4326.819 Hz: its own results are worth 5e-7, and its digits as much again.
#[test]
fn frequencies_of_a_block_are_those_that_the_finite_element_program_has_found() {
    let data = |name: &str| format!("{}/tests/data/{name}", env!("CARGO_MANIFEST_DIR"));
    let read = |name: &str| {
        let Ok(location) = data(name).parse::<Location>();
        open(&location).unwrap()
    };
    let structure = Structure::new(&read("block.sti"), &read("block.mas")).unwrap();
    // Corners of the lower face.
    let retained = structure.rows_of(&[1, 4, 9, 12]).unwrap();
    let request = Request { retained: retained.clone(), modes_to: 1e5, memory: MEMORY };
    let superelement = reduce(&structure, &request, Watch::IDLE).unwrap();
    let free = certify(&structure, &superelement, &[], 20e3, MEMORY, Watch::IDLE).unwrap();
    assert!(free.is_complete());
    assert_eq!((0..free.full).filter(|&mode| free.is_rigid(mode)).count(), 6);
    let printed = fs::read_to_string(data("modes.dat")).unwrap();
    let lines = printed.lines().map(|line| line.split_whitespace().collect::<Vec<_>>());
    let printed: Vec<f64> = lines
        .filter(|words| words.len() == 5 && words[0].parse::<u32>().is_ok())
        .map(|words| words[3].parse().unwrap())
        .collect();
    for (mode, printed) in printed.into_iter().enumerate().take(free.full).skip(6) {
        let [low, high] = free.intervals[mode].frequencies();
        assert!((high - low) / low < 1e-10);
        assert!((printed - low).abs() < 1e-6 * low, "{printed} and {low}");
        assert!(free.error(mode).unwrap() < 1e-4, "mode {mode}: {:?}", free.error(mode));
    }
    // With all retained nodes held, only modes that were kept are left: the superelement is exact.
    let stuck = certify(&structure, &superelement, &retained, 20e3, MEMORY, Watch::IDLE).unwrap();
    assert!(stuck.is_complete() && stuck.full > 3);
    assert!((0..stuck.full).all(|mode| stuck.error(mode).unwrap() < 1e-10));
}
