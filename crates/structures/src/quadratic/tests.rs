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
    println!("n {} analysis {:?} size {} supernodes {}", problem.size(), start.elapsed(), analysis.size, analysis.supernodes.len());
    let flops: f64 = analysis.supernodes.iter().map(|s| { let (w, b) = (s.width() as f64, s.below.len() as f64); 8.0 * (w * w * w / 3.0 + w * w * b + w * b * b) }).sum();
    let largest = analysis.supernodes.iter().map(|s| s.width() + s.below.len()).max();
    let lambda = c64::new(10.0, 2.0e4);
    for _ in 0..3 {
        let start = Instant::now();
        let factors = Factors::new(&analysis, lambda).unwrap();
        let t = start.elapsed();
        println!("factor {:?} GFlops {} of {:.3e} largest {:?} det {:?}", t, flops / t.as_secs_f64() * 1e-9, flops, largest, factors.determinant);
        for transposed in [false, true] {
            let b: Vec<c64> = (0..problem.size()).map(|i| c64::new((i as f64).sin(), 1.0)).collect();
            let mut x = b.clone();
            let start = Instant::now();
            factors.solve(transposed, &mut x);
            let t = start.elapsed();
            let r = problem.apply(lambda, transposed, &x);
            let norm = |x: &[c64]| x.iter().map(|x| x.norm_sqr()).sum::<f64>().sqrt();
            let d: Vec<c64> = r.iter().zip(&b).map(|(r, b)| r - b).collect();
            println!("solve {:?} backward {:e}", t, norm(&d) / (problem.norm(lambda) * norm(&x) + norm(&b)));
        }
    }
}
