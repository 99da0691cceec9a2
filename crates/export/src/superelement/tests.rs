use super::*;
use amontons::scene::{Freedom, UnitFactors};
use std::fs;

/// A beam between two nodes in mm, t and s: displacement y and rotation about z of nodes 1 and 2, and one modal coordinate that
/// is coupled with them. By hand: E I = 1.75e8 N mm², length 40 mm, ρ A = 1.5e-6 t/mm (consistent mass), the mode at 900 Hz.
const LENGTH: f64 = 40.0;

fn beam(to_si: bool) -> [Vec<f64>; 2] {
    // In SI the same beam has E I = 175 N m², length 0.04 m and ρ A = 1.5 kg/m.
    let (ei, rho_a, l) = if to_si { (175.0, 1.5, LENGTH / 1e3) } else { (1.75e8, 1.5e-6, LENGTH) };
    let k = [
        [12.0, 6.0 * l, -12.0, 6.0 * l],
        [6.0 * l, 4.0 * l * l, -6.0 * l, 2.0 * l * l],
        [-12.0, -6.0 * l, 12.0, -6.0 * l],
        [6.0 * l, 2.0 * l * l, -6.0 * l, 4.0 * l * l],
    ];
    let m = [
        [156.0, 22.0 * l, 54.0, -13.0 * l],
        [22.0 * l, 4.0 * l * l, 13.0 * l, -3.0 * l * l],
        [54.0, 13.0 * l, 156.0, -22.0 * l],
        [-13.0 * l, -3.0 * l * l, -22.0 * l, 4.0 * l * l],
    ];
    let rate = 900.0 * std::f64::consts::TAU;
    let coupling = 0.1 * (rho_a * l).sqrt();
    let mut matrices = [vec![0.0; 25], vec![0.0; 25]];
    for i in 0..4 {
        for j in 0..4 {
            matrices[0][i * 5 + j] = ei / (l * l * l) * k[i][j];
            matrices[1][i * 5 + j] = rho_a * l / 420.0 * m[i][j];
        }
    }
    for i in [0, 2] {
        matrices[1][i * 5 + 4] = coupling;
        matrices[1][20 + i] = coupling;
    }
    matrices[0][24] = rate * rate;
    matrices[1][24] = 1.0;
    matrices
}

fn matrix_market(values: &[f64]) -> String {
    let n = values.len().isqrt();
    let mut text = format!("%%MatrixMarket matrix array real general\n{n} {n}\n");
    for column in 0..n {
        for row in 0..n {
            text.push_str(&format!("{:e}\n", values[row * n + column]));
        }
    }
    text
}

const FREEDOMS: &str = "node,direction\n1,2\n1,6\n2,2\n2,6\n3,0\n";
const MILLIMETRES: UnitFactors = UnitFactors { length: 1e-3, mass: 1e3, time: 1.0 };

/// A folder with the beam in mm, t and s, and these files besides.
fn folder(others: &[(&str, String)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let [stiffness, mass] = beam(false);
    let put = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    put("stiffness.mtx", &matrix_market(&stiffness));
    put("mass.mtx", &matrix_market(&mass));
    put("freedoms.csv", FREEDOMS);
    others.iter().for_each(|(name, text)| put(name, text));
    folder
}

fn named() -> SuperelementFiles {
    SuperelementFiles {
        name: "beam".into(),
        folder: Some(".".into()),
        units: MILLIMETRES,
        ..Default::default()
    }
}

fn read(folder: &tempfile::TempDir, files: &SuperelementFiles) -> SuperelementMatrices {
    Files.read(folder.path(), files).unwrap()
}

fn refused(folder: &tempfile::TempDir, files: &SuperelementFiles) -> String {
    let problems = Files.read(folder.path(), files).unwrap_err();
    problems.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}

fn are_near(found: &[f64], expected: &[f64], part: f64) -> bool {
    found.len() == expected.len()
        && found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= part * b.abs())
}

#[test]
fn a_beam_in_millimetres_and_tonnes_is_the_beam_in_si_units() {
    let folder = folder(&[]);
    let found = read(&folder, &named());
    let [stiffness, mass] = beam(true);
    assert!(are_near(found.stiffness(), &stiffness, 1e-14), "{:?}", found.stiffness());
    assert!(are_near(found.mass(), &mass, 1e-14), "{:?}", found.mass());
    assert_eq!(found.freedoms()[4], Freedom { node: 3, direction: 0 });
    assert!(found.damping().is_empty());
    // With the files one by one, too.
    let single = SuperelementFiles {
        folder: None,
        stiffness: Some("stiffness.mtx".into()),
        mass: Some("mass.mtx".into()),
        freedoms: Some("freedoms.csv".into()),
        ..named()
    };
    assert_eq!(read(&folder, &single), found);
}

#[test]
fn a_unit_of_time_scales_stiffness_and_damping_by_its_powers() {
    let [stiffness, mass] = beam(false);
    let folder = folder(&[("c.mtx", matrix_market(&stiffness))]);
    let units = UnitFactors { length: 1.0, mass: 1.0, time: 1e-3 };
    let found =
        read(&folder, &SuperelementFiles { damping: Some("c.mtx".into()), units, ..named() });
    let times = |factor: f64| stiffness.iter().map(|k| factor * k).collect::<Vec<_>>();
    assert!(are_near(found.stiffness(), &times(1e6), 1e-14));
    assert!(are_near(found.damping(), &times(1e3), 1e-14));
    assert!(are_near(found.mass(), &mass, 0.0));
}

/// With D = Σ 2 ζ ω (M φ)(M φ)ᵀ each φ of the undamped modes gives φᵀ D φ = 2 ζ ω, and rigid motions have no damping forces.
#[test]
fn modal_damping_gives_each_mode_its_ratio_and_rigid_motions_none() {
    let folder = folder(&[]);
    let undamped = read(&folder, &named());
    let (k, m) = (undamped.stiffness(), undamped.mass());
    let times = |matrix: &[f64], x: &[f64]| -> Vec<f64> {
        matrix.chunks(5).map(|row| row.iter().zip(x).map(|(a, b)| a * b).sum()).collect()
    };
    let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let rigid = [[1.0, 0.0, 1.0, 0.0, 0.0], [0.0, 1.0, LENGTH / 1e3, 1.0, 0.0]];
    // D M⁻¹ K and K M⁻¹ D agree, and D M⁻¹ D = 4 ζ² K, since D = 2 ζ M √(M⁻¹ K).
    let damped = read(&folder, &SuperelementFiles { damping_ratio: vec![0.02], ..named() });
    let d = damped.damping();
    let m = nalgebra::DMatrix::from_row_slice(5, 5, m);
    let dense = nalgebra::DMatrix::from_row_slice(5, 5, d);
    let product = &dense * m.try_inverse().unwrap() * &dense;
    let expected = nalgebra::DMatrix::from_row_slice(5, 5, k) * (4.0 * 0.02 * 0.02);
    let most = |matrix: &nalgebra::DMatrix<f64>| matrix.amax();
    assert!(most(&(&product - &expected)) < 1e-11 * most(&expected), "{product} {expected}");
    let largest = d.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    for motion in &rigid {
        let force = times(d, motion);
        assert!(force.iter().all(|force| force.abs() < 1e-11 * largest), "{force:?}");
    }
    // Of three modes that oscillate, ratios for the first and the third damp these alone: their sum is that of 2 ζ ω.
    let few = read(&folder, &SuperelementFiles { damping_ratio: vec![0.01, 0.0, 0.03], ..named() });
    let alone = |ratios: Vec<f64>| {
        read(&folder, &SuperelementFiles { damping_ratio: ratios, ..named() }).damping().to_vec()
    };
    let (first, third) = (alone(vec![0.01, 0.0]), alone(vec![0.0, 0.0, 0.03]));
    let sum: Vec<f64> = first.iter().zip(&third).map(|(a, b)| a + b).collect();
    assert!(are_near(few.damping(), &sum, 1e-12));
    assert!(dot(&first, &first) > 0.0 && dot(&third, &third) > 0.0);
    let many = SuperelementFiles { damping_ratio: vec![0.01; 4], ..named() };
    assert!(
        refused(&folder, &many).contains("has 4 values, but 3 modes"),
        "{}",
        refused(&folder, &many)
    );
}

#[test]
fn damping_of_mass_and_stiffness_leaves_the_circulatory_part_out() {
    let mut circulatory = vec![0.0; 25];
    circulatory[2] = 5e3;
    let folder = folder(&[("h.mtx", matrix_market(&circulatory))]);
    let plain = read(&folder, &named());
    let files =
        SuperelementFiles { circulatory: Some("h.mtx".into()), alpha: 3.0, beta: 1e-6, ..named() };
    let found = read(&folder, &files);
    let sum = plain.mass().iter().zip(plain.stiffness()).map(|(m, k)| 3.0 * m + 1e-6 * k);
    assert!(are_near(found.damping(), &sum.collect::<Vec<_>>(), 1e-14));
    // 5000 N/mm in N/m.
    assert!((found.stiffness()[2] - plain.stiffness()[2] - 5e6).abs() < 1e-6);
    assert_eq!(found.stiffness()[10], plain.stiffness()[10]);
    assert!(!found.is_conservative() && plain.is_conservative());
}

#[test]
fn rounding_of_a_file_is_taken_out_and_larger_asymmetry_is_refused_with_its_entry() {
    let [mut stiffness, _] = beam(false);
    let largest = stiffness.iter().fold(0.0_f64, |most, k| most.max(k.abs()));
    stiffness[3] += 1e-10 * largest;
    let near = folder(&[("stiffness.mtx", matrix_market(&stiffness))]);
    assert!(read(&near, &named()).is_conservative());
    stiffness[3] += 1e-8 * largest;
    let far = folder(&[("stiffness.mtx", matrix_market(&stiffness))]);
    let found = refused(&far, &named());
    assert!(found.starts_with("stiffness: must be symmetric, but row 4, column 1 is"), "{found}");
    assert!(found.ends_with("give the part that is not symmetric as `circulatory`"), "{found}");
    let [symmetric, _] = beam(false);
    let wrong = folder(&[("g.mtx", matrix_market(&symmetric))]);
    let found = refused(&wrong, &SuperelementFiles { gyroscopic: Some("g.mtx".into()), ..named() });
    assert!(found.starts_with("gyroscopic: gyroscopic forces do no work"), "{found}");
}

#[test]
fn files_that_are_wrong_are_named_with_the_remedy() {
    let small = matrix_market(&[1.0, 0.0, 0.0, 1.0]);
    let folder = folder(&[("small.mtx", small), ("one.csv", "node,direction\n1,1\n".into())]);
    let some = |name: &str| Some(name.to_owned());
    let single = SuperelementFiles {
        folder: None,
        stiffness: some("stiffness.mtx"),
        mass: some("mass.mtx"),
        freedoms: some("freedoms.csv"),
        ..named()
    };
    let cases = [
        (
            SuperelementFiles { folder: some("none"), ..named() },
            "folder = none/mass.mtx: cannot read the file",
        ),
        (
            SuperelementFiles { mass: None, ..single.clone() },
            "mass: is missing; give files of both",
        ),
        (
            SuperelementFiles { freedoms: None, ..single.clone() },
            ": needs `freedoms`, since stiffness.mtx does not name",
        ),
        (
            SuperelementFiles { freedoms: some("one.csv"), ..single.clone() },
            "stiffness = stiffness.mtx: the table names 1 rows",
        ),
        (
            SuperelementFiles { mass: some("small.mtx"), ..single.clone() },
            "mass = small.mtx: the table names 5 rows, and a matrix has 2",
        ),
        (
            SuperelementFiles { mass: some("mass.xyz"), ..single },
            "mass = mass.xyz: cannot read the file",
        ),
    ];
    for (files, expected) in cases {
        let found = refused(&folder, &files);
        assert!(found.contains(expected), "{found}");
    }
}

#[test]
fn a_damping_matrix_of_the_structure_before_its_reduction_is_told_the_way_to_reduce_it() {
    let mut full = vec![0.0; 36];
    (0..6).for_each(|row| full[7 * row] = 1.0);
    let folder = folder(&[("full.mtx", matrix_market(&full))]);
    let files = SuperelementFiles { damping: Some("full.mtx".into()), ..named() };
    let found = refused(&folder, &files);
    let words = "damping = full.mtx: has 6 rows, but ./stiffness.mtx has 5, and ./mass.mtx has 5: it is of the structure before";
    assert!(found.starts_with(words), "{found}");
    assert!(found.contains("`amontons reduce --also damping=full.mtx`"), "{found}");
}

#[test]
fn matrices_of_two_models_are_named_with_the_remedy() {
    let calculix = |nodes: &[u64]| {
        let dof: String = nodes.iter().map(|node| format!("{node}.1\n")).collect();
        let entries: String = (1..=nodes.len()).map(|row| format!("{row} {row} 1.0\n")).collect();
        [dof, entries]
    };
    let ([disc_dof, disc], [pad_dof, pad]) = (calculix(&[1, 2, 3]), calculix(&[2, 9]));
    let files =
        [("disc.dof", disc_dof), ("disc.sti", disc), ("pad.dof", pad_dof), ("pad.mas", pad)];
    let folder = folder(&files);
    let of_two = SuperelementFiles {
        folder: None,
        stiffness: Some("disc.sti".into()),
        mass: Some("pad.mas".into()),
        ..named()
    };
    let found = refused(&folder, &of_two);
    let words = "disc.sti and pad.mas are of different models: direction 1 of node 9 is in pad.mas, and not in disc.sti";
    assert!(found.contains(words), "{found}");
    assert!(found.contains("give files that were written for one model"), "{found}");
}
