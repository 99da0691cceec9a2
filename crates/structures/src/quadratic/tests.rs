use super::analysis::Analysis;
use super::factors::Factors;
use crate::{Quadratic, Sparse};
use faer::c64;
use std::time::Instant;

/// reads "rows cols nnz" then lines
fn read(path: &str) -> Sparse {
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let n: usize = lines.next().unwrap().trim().parse().unwrap();
    let entries = lines.map(|line| {
        let mut words = line.split_whitespace();
        let row: usize = words.next().unwrap().parse().unwrap();
        let column: usize = words.next().unwrap().parse().unwrap();
        (row, column, words.next().unwrap().parse().unwrap())
    });
    Sparse::from_entries(n, n, entries).unwrap()
}

#[test]
#[ignore]
fn speed() {
    let base = std::env::var("BRAKE").unwrap();
    let [m, c, k] = ["M", "C", "K"].map(|name| read(&format!("{base}/{name}.txt")));
    let problem = Quadratic::new(m, c, k).unwrap();
    let start = Instant::now();
    let analysis = Analysis::new(&problem).unwrap();
    println!(
        "n {} analysis {:?} size {} supernodes {}",
        problem.size(),
        start.elapsed(),
        analysis.size,
        analysis.supernodes.len()
    );
    let flops: f64 = analysis
        .supernodes
        .iter()
        .map(|s| {
            let (w, b) = (s.width() as f64, s.below.len() as f64);
            8.0 * (w * w * w / 3.0 + w * w * b + w * b * b)
        })
        .sum();
    let largest = analysis.supernodes.iter().map(|s| s.width() + s.below.len()).max();
    let lambda = c64::new(10.0, 2.0e4);
    for _ in 0..3 {
        let start = Instant::now();
        let factors = Factors::new(&analysis, lambda).unwrap();
        let t = start.elapsed();
        println!(
            "factor {:?} GFlops {} of {:.3e} largest {:?} det {:?}",
            t,
            flops / t.as_secs_f64() * 1e-9,
            flops,
            largest,
            factors.determinant
        );
        for transposed in [false, true] {
            let b: Vec<c64> =
                (0..problem.size()).map(|i| c64::new((i as f64).sin(), 1.0)).collect();
            let mut x = b.clone();
            let start = Instant::now();
            factors.solve(transposed, &mut x);
            let t = start.elapsed();
            let r = problem.apply(lambda, transposed, &x);
            let norm = |x: &[c64]| x.iter().map(|x| x.norm_sqr()).sum::<f64>().sqrt();
            let d: Vec<c64> = r.iter().zip(&b).map(|(r, b)| r - b).collect();
            println!(
                "solve {:?} backward {:e}",
                t,
                norm(&d) / (problem.norm(lambda) * norm(&x) + norm(&b))
            );
        }
    }
}

#[test]
#[ignore]
fn brake() {
    use crate::quadratic::{Options, Rectangle, count, eigenvalues};
    use amontons_analysis::watch::Watch;
    let base = std::env::var("BRAKE").unwrap();
    let number = |name: &str, default: f64| {
        std::env::var(name).map_or(default, |text| text.parse().unwrap())
    };
    let [m, c, k] = ["M", "C", "K"].map(|name| read(&format!("{base}/{name}.txt")));
    let problem = Quadratic::new(m, c, k).unwrap();
    let rectangle = Rectangle::new(
        [-number("LEFT", 2000.0), number("RIGHT", 2000.0)],
        [number("LOW", 1000.0), number("HIGH", 2.0e5)],
    )
    .unwrap();
    let options = Options {
        bounds: number("BOUNDS", 1.0) > 0.0,
        dimension: number("DIM", 100.0) as usize,
        ..Options::default()
    };
    let start = Instant::now();
    let work = || eigenvalues(&problem, &rectangle, &options, Watch::IDLE).unwrap();
    let found = if number("ALONE", 1.0) > 0.0 {
        amontons_analysis::stability::on_this_thread(work)
    } else {
        work()
    };
    println!(
        "search {:?} {} inside of {}, factorizations {} solves {}",
        start.elapsed(),
        found.inside().count(),
        found.modes.len(),
        found.factorizations,
        found.solves
    );
    for t in &found.trusted {
        println!("  {:?}", t);
    }
    let most = |f: fn(&super::Mode) -> f64| found.inside().map(f).fold(0.0, f64::max);
    println!(
        "backward {:e} bound {:e} relative {:e} unknown {}",
        most(|m| m.backward),
        most(|m| m.bound.unwrap_or(0.0)),
        most(|m| m.bound.unwrap_or(0.0) / m.eigenvalue.norm()),
        found.inside().filter(|m| m.bound.is_none()).count()
    );
    if number("LIST", 0.0) > 0.0 {
        for m in found.inside() {
            println!("{} {:e} {:?}", m.eigenvalue, m.backward, m.bound);
        }
    }
    let start = Instant::now();
    let work = || {
        count(
            &problem,
            &found.edges,
            &found.found(),
            if number("ROUGH", 1.0) > 0.0 { &found.rough } else { &[] },
            Watch::IDLE,
        )
        .unwrap()
    };
    let c = if number("ALONE", 1.0) > 0.0 {
        amontons_analysis::stability::on_this_thread(work)
    } else {
        work()
    };
    println!("count {:?} {:?}", start.elapsed(), c);
}

#[test]
#[ignore]
fn evd() {
    for n in [20, 40, 60, 80, 100] {
        let v = super::random::vector(3, n * n);
        let a =
            faer::Mat::from_fn(n, n, |i, j| if i > j + 1 { c64::default() } else { v[i + n * j] });
        let start = Instant::now();
        let _ = a.eigen().unwrap();
        println!("evd {n} {:?}", start.elapsed());
        let start = Instant::now();
        let _ = a.eigenvalues().unwrap();
        println!("values {n} {:?}", start.elapsed());
    }
    let rows = 10500;
    let v = super::random::vector(3, rows * 100);
    let basis = faer::MatRef::from_column_major_slice(&v, rows, 100);
    let mut z = super::random::vector(4, rows);
    let mut p = vec![c64::default(); 100];
    for _ in 0..2 {
        let start = Instant::now();
        faer::linalg::matmul::matmul(
            faer::ColMut::from_slice_mut(&mut p).as_mat_mut(),
            faer::Accum::Replace,
            basis.adjoint(),
            faer::ColRef::from_slice(&z).as_mat(),
            c64::new(1.0, 0.0),
            faer::Par::Seq,
        );
        println!("adjoint {:?}", start.elapsed());
        let start = Instant::now();
        faer::linalg::matmul::matmul(
            faer::ColMut::from_slice_mut(&mut z).as_mat_mut(),
            faer::Accum::Add,
            basis,
            faer::ColRef::from_slice(&p).as_mat(),
            c64::new(-1.0, 0.0),
            faer::Par::Seq,
        );
        println!("forward {:?}", start.elapsed());
    }
}
