//! The numbers of branches of a locus: those of the modes that they pass at one value of the parameter.

use nalgebra::Complex;

/// For each branch the number of the mode, from 1, that its root belongs to, where `modes` are the eigenvalues of the modes in
/// their order. The nearest pairs come first, and no two branches have one mode. Branches beyond the modes have the numbers after
/// theirs.
pub fn numbers(roots: &[Complex<f64>], modes: &[Complex<f64>]) -> Vec<usize> {
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for (branch, root) in roots.iter().enumerate() {
        pairs.extend(modes.iter().enumerate().map(|(mode, at)| ((root - at).norm(), branch, mode)));
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut of_branch, mut is_taken) = (vec![None; roots.len()], vec![false; modes.len()]);
    for (_, branch, mode) in pairs {
        if of_branch[branch].is_none() && !is_taken[mode] {
            of_branch[branch] = Some(mode + 1);
            is_taken[mode] = true;
        }
    }
    let mut beyond = modes.len();
    let number = |known: Option<usize>| {
        known.unwrap_or_else(|| {
            beyond += 1;
            beyond
        })
    };
    of_branch.into_iter().map(number).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_branch_has_the_number_of_the_mode_that_it_passes() {
        let at = |re: f64, im: f64| Complex::new(re, im);
        // Two modes that have merged, one that does not oscillate with two eigenvalues, and one more branch.
        let modes = [at(-3.0, 50.0), at(2.0, 50.0), at(-9.0, 0.0), at(-1.0, 0.0)];
        let roots = [at(-1.1, 0.0), at(2.2, 50.1), at(-2.8, 50.1), at(0.0, 900.0), at(5.0, 800.0)];
        assert_eq!(numbers(&roots, &modes), [4, 2, 1, 5, 3]);
    }
}
