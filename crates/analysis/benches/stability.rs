//! The cost of the stability analysis: `cargo bench --bench stability` prints four small tables, all
//! from one run, against LAPACK as NumPy and SciPy bring it, on the same problems (`stability_lapack.py`
//! in the Python environment of the tests, which is made at the first run).
//!
//! * Eigenvalues of one contact state: rings of unequal modules in uniform sliding, several values of
//!   µ each.
//! * A thousand equal modules in uniform sliding, wave by wave; it must take less than a second.
//! * All 65,536 contact states of eight equal modules.
//! * A million draws of Set 1 with scattering parameters, from the values to every eigenvalue; it must take less than a
//!   minute.
//!
//! Each side uses one thread; a time is that of the quickest of several turns, which the two sides
//! take one after the other, and Python measures its own, without the exchange between the programs.
//! The run fails where an eigenvalue differs from LAPACK's by more than 1e-9 of itself. Beside
//! defective eigenvalues, of which rounding leaves half of the digits in any program, what is well
//! conditioned must agree as closely instead: [`assert_clusters_agree`] says what that is.

use amontons::contact::ContactState;
use amontons::model::{LinearModel, LumpedModel, ReducedMatrices};
use amontons::scene::{Scene, builtin};
use amontons::stability::{Spectrum, eigenvalues};
use amontons_analysis::journal::Journal;
use amontons_analysis::robustness::{Design, Uncertain, parameters, robustness, scene_with};
use amontons_analysis::stability::StateClasses;
use amontons_analysis::watch::Watch;
use nalgebra::{Complex, DMatrix};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::hint::black_box;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::Instant;

#[path = "../../../tests/support/python/mod.rs"]
mod python;

/// The paper's µ of its Set 1.
const FRICTION: f64 = 1.96;
/// How far an eigenvalue may be from LAPACK's, in parts of itself.
const TOLERANCE: f64 = 1e-9;
/// Eigenvalues nearer to each other than this part of themselves are a cluster.
const CLUSTER: f64 = 1e-4;
/// Scramblings and points of a million draws, and what they may take, s.
const DRAWS: [u64; 2] = [16, 1 << 16];
const DRAWS_LIMIT: f64 = 60.0;
/// What a thousand modules may take, s.
const WAVES_LIMIT: f64 = 1.0;

type Values = Vec<Complex<f64>>;

fn main() {
    let mut lapack = Lapack::start();
    println!("LAPACK is that of {}; one thread on each side.\n", lapack.about);
    one_state(&mut lapack);
    waves(&mut lapack);
    all_states(&mut lapack);
    draws(&mut lapack);
}

fn one_state(lapack: &mut Lapack) {
    // Modules, values of µ, turns.
    let rings = [(2, 500, 100), (8, 60, 100), (32, 4, 50), (128, 1, 20)];
    let problems = rings.map(|(modules, values_of_mu, turns)| {
        let model = LumpedModel::from(&unequal(modules));
        let mu = |i: usize| FRICTION * (i + 1) as f64 / values_of_mu as f64;
        let states = vec![ContactState::Slide; modules];
        let case = |i: usize| (states.clone(), model.clone().with_friction(mu(i)));
        (Problem::new((0..values_of_mu).map(case).collect()), turns)
    });

    println!("Eigenvalues of the same matrix M⁻¹ K, µs a matrix");
    println!("            Amontons   NumPy, all at once   SciPy, one by one   furthest apart");
    for (problem, turns) in &problems {
        let theirs = lapack.values("numpy_stack", problem.request());
        let ours: Vec<_> = problem.operators.iter().map(solve).collect();
        let apart = assert_values_agree(&ours, &theirs);
        let [own, numpy, scipy] = shortest(
            *turns,
            lapack,
            [
                &mut |_| {
                    seconds(|| problem.operators.iter().for_each(|a| drop(black_box(solve(a)))))
                },
                &mut |lapack| lapack.seconds("numpy_stack", problem.request()),
                &mut |lapack| lapack.seconds("scipy_each", problem.request()),
            ],
        )
        .map(|time| 1e6 * time / problem.cases.len() as f64);
        let name = format!("{0} × {0}", problem.size());
        println!(
            "{name:>9} {own:10.1} {numpy:12.1} = {:.2} × {scipy:11.1} = {:.2} × {apart:16.0e}",
            numpy / own,
            scipy / own
        );
    }

    println!("\nEigenvalues λ of a state, µs a state");
    println!(
        "            Amontons, from the model   SciPy, eq. (6) from M, C and K   furthest apart"
    );
    for (problem, turns) in &problems {
        let theirs = lapack.values("first_order", problem.request());
        let spectrum =
            |(states, model): &Case| Spectrum::of(linear(model), states).expect("it is possible");
        let ours: Vec<_> = problem.cases.iter().map(|case| all(&spectrum(case))).collect();
        let apart = assert_values_agree(&ours, &theirs);
        let [own, scipy] = shortest(
            turns / 5,
            lapack,
            [
                &mut |_| {
                    seconds(|| problem.cases.iter().for_each(|c| drop(black_box(spectrum(c)))))
                },
                &mut |lapack| lapack.seconds("first_order", problem.request()),
            ],
        )
        .map(|time| 1e6 * time / problem.cases.len() as f64);
        println!(
            "{:>9} {own:26.1} {scipy:23.1} = {:.2} × {apart:16.0e}",
            problem.size(),
            scipy / own
        );
    }
    println!();
}

fn waves(lapack: &mut Lapack) {
    let modules = 1000;
    let model = LumpedModel::from(&equal(modules));
    let entries: Vec<_> =
        (0..4).flat_map(|row| model.stiffness.row(row).map(move |(j, k)| (row, j, k))).collect();
    let request = json!({
        "modules": modules,
        "friction": FRICTION,
        "mass": model.mass.as_diagonal(),
        "stiffness": entries,
        "alpha": model.damping.alpha,
        "beta": model.damping.beta,
    });
    let sliding = vec![ContactState::Slide; model.contacts.len()];
    let spectrum = || Spectrum::of(linear(&model), &sliding).expect("it is possible");
    let theirs = lapack.values("waves", request.clone()).concat();
    let ours = all(&spectrum());
    let apart = assert_values_agree(&[ours], &[theirs]);
    let [own, numpy] = shortest(
        20,
        lapack,
        [&mut |_| seconds(|| drop(black_box(spectrum()))), &mut |lapack| {
            lapack.seconds("waves", request.clone())
        }],
    );
    assert!(own < WAVES_LIMIT, "{modules} modules take {own} s");
    println!("{modules} equal modules in uniform sliding, all {} λ, ms", 6 * modules);
    println!("            Amontons   NumPy, eq. (6) of each wave   furthest apart");
    println!("{:20.2} {:18.2} = {:.2} × {apart:20.0e}\n", 1e3 * own, 1e3 * numpy, numpy / own);
}

fn all_states(lapack: &mut Lapack) {
    let model = LumpedModel::from(&equal(8));
    let classes = StateClasses::of(&model).expect("eight contacts are few enough");
    let mut by_size: BTreeMap<usize, Vec<Case>> = BTreeMap::new();
    for states in &classes.representatives {
        let size = reduced(&model, states).mass.nrows();
        by_size.entry(size).or_default().push((states.clone(), model.clone()));
    }
    let problems: Vec<_> = by_size.into_values().map(Problem::new).collect();
    let (mut apart, mut clustered) = (0.0_f64, [0; 2]);
    for problem in &problems {
        let theirs = lapack.values("numpy_stack", problem.request());
        for (operator, theirs) in problem.operators.iter().zip(&theirs) {
            let ours = solve(operator);
            let (worst, count) = assert_clusters_agree(&ours, theirs);
            apart = apart.max(worst);
            clustered = [clustered[0] + count, clustered[1] + ours.len()];
        }
    }
    let all_spectra = || {
        let classes = StateClasses::of(&model).expect("few");
        classes.spectra(linear(&model), Watch::IDLE).expect("they are possible")
    };
    let solved = classes.representatives.len();
    let [whole, own, numpy] = shortest(
        10,
        lapack,
        [
            &mut |_| seconds(|| drop(black_box(all_spectra()))),
            &mut |_| {
                let operators = problems.iter().flat_map(|problem| &problem.operators);
                seconds(|| operators.for_each(|a| drop(black_box(solve(a)))))
            },
            &mut |lapack| {
                let time = |problem: &Problem| lapack.seconds("numpy_stack", problem.request());
                problems.iter().map(time).sum()
            },
        ],
    );
    let each = |time: f64| 1e6 * time / solved as f64;
    println!("All {} states of eight equal modules", classes.states.len());
    println!("  {solved} are solved, symmetry gives the others");
    println!("  from the model to every λ, on all cores: {whole:.2} s");
    println!("  eigenvalues of the same matrices, µs a state solved");
    println!("            Amontons   NumPy, all at once   furthest apart");
    println!("{:20.1} {:12.1} = {:.2} × {apart:16.0e}", each(own), each(numpy), numpy / own);
    println!(
        "  Of {} eigenvalues {} lie in clusters narrower than {CLUSTER:e}, compared by power sums.",
        clustered[1], clustered[0]
    );
}

fn draws(lapack: &mut Lapack) {
    let scene = builtin("set1").expect("it is built in").scene();
    let given = ["friction.coefficient=normal(±10%)", "module[*].k6=uniform(±10%)"];
    let given = given.map(|text| Uncertain::parse(text).expect("it is a distribution"));
    let parameters = parameters(&scene, &given).expect("the scene has them");
    let [scramblings, points] = DRAWS;
    let count = (scramblings * points) as f64;
    let has_indices = false;
    let parameters = &parameters[..];
    let design = Design {
        scene: &scene,
        parameters,
        state: None,
        scramblings,
        points,
        seed: 1,
        has_indices,
    };
    let all = || robustness(&design, None, &Journal::forgotten(), Watch::IDLE).expect("possible");
    let whole = seconds(|| drop(black_box(all())));
    assert!(whole < DRAWS_LIMIT, "a million draws take {whole} s");
    // Values at probabilities without a common step stand for draws.
    let case = |i: usize| {
        let at = |place: usize| (0.5 + i as f64 * [0.618, 0.755, 0.569][place]).fract().max(1e-9);
        let values: Vec<f64> =
            parameters.iter().enumerate().map(|(place, one)| one.at(at(place))).collect();
        let drawn = scene_with(&scene, parameters, &values).expect("it is possible");
        (vec![ContactState::Slide; 2], LumpedModel::from(&drawn))
    };
    let problem = Problem::new((0..20_000).map(case).collect());
    let theirs = lapack.values("numpy_stack", problem.request());
    let ours: Vec<_> = problem.operators.iter().map(solve).collect();
    let apart = assert_values_agree(&ours, &theirs);
    let [own, numpy] = shortest(
        10,
        lapack,
        [
            &mut |_| seconds(|| problem.operators.iter().for_each(|a| drop(black_box(solve(a))))),
            &mut |lapack| lapack.seconds("numpy_stack", problem.request()),
        ],
    )
    .map(|time| 1e6 * time / problem.cases.len() as f64);
    println!("\n{count} draws of Set 1 with three scattering parameters");
    println!(
        "  from the values to P(unstable), on all cores: {whole:.1} s, {:.1} µs a draw",
        1e6 * whole / count
    );
    println!("  eigenvalues of matrices of such draws, µs a matrix, one thread");
    println!("            Amontons   NumPy, all at once   furthest apart");
    println!("{own:20.1} {numpy:12.1} = {:.2} × {apart:16.0e}", numpy / own);
}

fn equal(modules: usize) -> Scene {
    let mut scene = builtin("set1").expect("it is built in").scene();
    let module = scene.modules()[0];
    *scene.modules_mut() = vec![module; modules];
    scene
}

/// Every mass and spring is up to two in a hundred off.
fn unequal(modules: usize) -> Scene {
    let mut scene = equal(modules);
    let mut turn = 0.0_f64;
    for module in scene.modules_mut() {
        for value in module.mass.iter_mut().chain(&mut module.stiffness) {
            turn += 1.0;
            *value *= 1.0 + 0.02 * turn.sin();
        }
    }
    scene
}

fn linear(model: &LumpedModel) -> LinearModel<'_> {
    model.linear().expect("µ is constant")
}

fn reduced(model: &LumpedModel, states: &[ContactState]) -> ReducedMatrices {
    linear(model).reduced(states).expect("one contact a mass cannot contradict itself")
}

fn solve(operator: &DMatrix<f64>) -> Values {
    eigenvalues(operator.clone()).expect("it converges")
}

/// Both of each pair, and the real ones.
fn all(spectrum: &Spectrum) -> Values {
    let pairs = spectrum.oscillating.iter().flat_map(|value| [*value, value.conj()]);
    pairs.chain(spectrum.real.iter().map(|value| Complex::from(*value))).collect()
}

/// States, and the model with its friction.
type Case = (Vec<ContactState>, LumpedModel);

/// Cases with matrices of one size, which are in a file too.
struct Problem {
    cases: Vec<Case>,
    /// M̃⁻¹ K̃ of each.
    operators: Vec<DMatrix<f64>>,
    file: PathBuf,
}

impl Problem {
    fn new(cases: Vec<Case>) -> Self {
        let reduced: Vec<_> = cases.iter().map(|(states, model)| reduced(model, states)).collect();
        let operator = |r: &ReducedMatrices| r.mass.clone().lu().solve(&r.stiffness);
        let operators: Vec<_> =
            reduced.iter().map(|r| operator(r).expect("masses are positive")).collect();
        let parts = [
            operators.iter().collect::<Vec<_>>(),
            reduced.iter().map(|r| &r.mass).collect(),
            reduced.iter().map(|r| &r.damping).collect(),
            reduced.iter().map(|r| &r.stiffness).collect(),
        ];
        // By rows, as NumPy reads them.
        let bytes: Vec<u8> = parts
            .iter()
            .flatten()
            .flat_map(|matrix| {
                matrix.transpose().iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<_>>()
            })
            .collect();
        let name = format!("stability-{}-{}.f64", cases[0].0.len(), operators[0].nrows());
        let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        std::fs::write(&file, bytes).expect("the target folder can be written");
        Self { cases, operators, file }
    }

    fn size(&self) -> usize {
        self.operators[0].nrows()
    }

    fn request(&self) -> Value {
        json!({ "stack": [self.file, 4, self.cases.len(), self.size(), self.size()] })
    }
}

/// Pairs each eigenvalue with the nearest of LAPACK's that is left, and gives the largest distance in
/// a pair, in parts of the eigenvalue.
fn assert_values_agree(ours: &[Values], theirs: &[Values]) -> f64 {
    assert_eq!(ours.len(), theirs.len(), "as many matrices on both sides");
    let mut worst = 0.0_f64;
    for (ours, theirs) in ours.iter().zip(theirs) {
        assert_eq!(ours.len(), theirs.len(), "as many eigenvalues on both sides");
        let mut left = theirs.clone();
        for value in ours {
            let distance = |i: &usize| (left[*i] - value).norm();
            let nearest = (0..left.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
            let nearest = left.swap_remove(nearest.expect("as many on both sides"));
            let apart = (nearest - value).norm() / nearest.norm();
            assert!(apart <= TOLERANCE, "{value} is not LAPACK's {nearest}: {apart:e}");
            worst = worst.max(apart);
        }
    }
    worst
}

/// Compares eigenvalues in clusters, where [`assert_values_agree`] compares single ones: LAPACK's eigenvalues that a chain of neighbours nearer
/// than [`CLUSTER`] joins, and ours that are nearest to one of these. One of them alone must agree to
/// [`TOLERANCE`]. Of m together, where one value may be uncertain by a root of the precision, both must
/// have as many, and the means of (σ − c)^p for p from 1 to m, c being LAPACK's mean, must agree to
/// [`TOLERANCE`] in parts of |c|^p: these sums, and so the polynomial that has the cluster for its
/// roots, change no more than the matrix does. Gives the largest such difference and how many
/// eigenvalues are in clusters of two or more.
fn assert_clusters_agree(ours: &[Complex<f64>], theirs: &[Complex<f64>]) -> (f64, usize) {
    let joined = |a: Complex<f64>, b: Complex<f64>| (a - b).norm() <= CLUSTER * a.norm();
    let mut cluster_of: Vec<usize> = (0..theirs.len()).collect();
    for i in 0..theirs.len() {
        for j in 0..i {
            let (from, to) = (cluster_of[i], cluster_of[j]);
            if from != to && joined(theirs[i], theirs[j]) {
                cluster_of.iter_mut().filter(|c| **c == from).for_each(|c| *c = to);
            }
        }
    }
    let cluster_of_ours = ours.iter().map(|value| {
        let distance = |i: &usize| (theirs[*i] - value).norm();
        let nearest = (0..theirs.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        cluster_of[nearest.expect("as many on both sides")]
    });
    let cluster_of_ours: Vec<usize> = cluster_of_ours.collect();
    let (mut worst, mut clustered) = (0.0_f64, 0);
    for cluster in 0..theirs.len() {
        let members = |values: &[Complex<f64>], places: &[usize]| -> Values {
            let of_it = values.iter().zip(places).filter(|(_, place)| **place == cluster);
            of_it.map(|(value, _)| *value).collect()
        };
        let [a, b] = [members(ours, &cluster_of_ours), members(theirs, &cluster_of)];
        assert_eq!(a.len(), b.len(), "{a:?} is not LAPACK's {b:?}");
        clustered += if b.len() > 1 { b.len() } else { 0 };
        let count = b.len() as f64;
        let centre = b.iter().sum::<Complex<f64>>() / count;
        for power in 1..=i32::try_from(b.len()).expect("few") {
            let sum = |values: &Values| -> Complex<f64> {
                values.iter().map(|value| ((value - centre) / centre.norm()).powi(power)).sum()
            };
            let apart = (sum(&a) - sum(&b)).norm() / count;
            assert!(apart <= TOLERANCE, "{a:?} is not LAPACK's {b:?}: {apart:e}, power {power}");
            worst = worst.max(apart);
        }
    }
    (worst, clustered)
}

fn seconds(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
}

/// The shortest time of each candidate, s, who take so many turns.
fn shortest<const N: usize>(
    turns: usize,
    lapack: &mut Lapack,
    mut candidates: [&mut dyn FnMut(&mut Lapack) -> f64; N],
) -> [f64; N] {
    let mut shortest = [f64::INFINITY; N];
    for _ in 0..turns {
        for (candidate, shortest) in candidates.iter_mut().zip(&mut shortest) {
            *shortest = shortest.min(candidate(lapack));
        }
    }
    shortest
}

/// `stability_lapack.py`, running.
struct Lapack {
    about: String,
    process: Child,
    requests: ChildStdin,
    answers: BufReader<ChildStdout>,
}

impl Lapack {
    fn start() -> Self {
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/stability_lapack.py");
        let mut command = Command::new(python::interpreter());
        command.arg("-B").arg(script).stdin(Stdio::piped()).stdout(Stdio::piped());
        for threads in ["OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"] {
            command.env(threads, "1");
        }
        let mut process = command.spawn().expect("the interpreter was just made");
        let requests = process.stdin.take().expect("it is piped");
        let answers = BufReader::new(process.stdout.take().expect("it is piped"));
        let mut lapack = Self { about: String::new(), process, requests, answers };
        lapack.about = lapack.read()["about"].as_str().expect("it says what it is").to_owned();
        lapack
    }

    fn ask(&mut self, work: &str, mut request: Value, values: bool) -> Value {
        request["work"] = work.into();
        request["values"] = values.into();
        writeln!(self.requests, "{request}").expect("stability_lapack.py reads on");
        self.read()
    }

    fn read(&mut self) -> Value {
        let mut line = String::new();
        self.answers.read_line(&mut line).expect("it can be read");
        serde_json::from_str(&line).expect("stability_lapack.py answers in JSON, or says why not")
    }

    /// The eigenvalues of each matrix.
    fn values(&mut self, work: &str, request: Value) -> Vec<Values> {
        let mut answer = self.ask(work, request, true);
        let parts: Vec<Vec<f64>> =
            serde_json::from_value(answer["values"].take()).expect("numbers, matrix by matrix");
        let values =
            |parts: &Vec<f64>| parts.chunks_exact(2).map(|v| Complex::new(v[0], v[1])).collect();
        parts.iter().map(values).collect()
    }

    fn seconds(&mut self, work: &str, request: Value) -> f64 {
        self.ask(work, request, false)["seconds"].as_f64().expect("a number")
    }
}

impl Drop for Lapack {
    fn drop(&mut self) {
        // It would end by itself with its input; where a check fails, nobody waits for it.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
