//! Lemke's algorithm: w = q + M z with 0 ≤ w ⊥ z ≥ 0.
//!
//! Pivots are chosen in lexicographic order, so they end: in a solution, or in a ray, which proves nothing unless M has
//! a property such as copositivity.

/// Ratios within this part of the least are tied.
const TIE: f64 = 1e-12;
/// An entry below this part of the largest in its column is rounding.
const NOTHING: f64 = 1e-13;
/// Largest number of pivots for each variable; one or two are usual.
const MOST_PIVOTS: usize = 50;

/// The variable of a row or a column of the tableau.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Name {
    /// The condition w of this place.
    W(usize),
    /// The unknown z of this place.
    Z(usize),
    /// The artificial unknown that lets all conditions hold at the start.
    Cover,
}

/// The tableau: each row expresses its basic variable as a constant plus multiples of the others. It keeps its memory from problem to problem.
pub(crate) struct Lemke {
    size: usize,
    rows: Vec<Name>,
    columns: Vec<Name>,
    /// The entries by rows; the constant comes first.
    entries: Vec<f64>,
    pivot_row: Vec<f64>,
}

impl Lemke {
    /// Allocates memory for problems of up to this many unknowns.
    pub(crate) fn with_room(places: usize) -> Self {
        Self {
            size: 0,
            rows: Vec::with_capacity(places),
            columns: Vec::with_capacity(places + 2),
            entries: Vec::with_capacity(places * (places + 2)),
            pivot_row: Vec::with_capacity(places + 2),
        }
    }

    /// Begins a problem with this many unknowns, and returns the list for its rows: each is q, the entries of M, and
    /// the entry of the artificial unknown, which is above zero.
    pub(crate) fn begin(&mut self, size: usize) -> &mut Vec<f64> {
        self.size = size;
        self.rows.clear();
        self.rows.extend((0..size).map(Name::W));
        self.columns.clear();
        self.columns.extend((0..size).map(Name::Z));
        self.columns.push(Name::Cover);
        self.entries.clear();
        &mut self.entries
    }

    /// Pivots until the artificial unknown has left the basis; `false` where a ray comes first.
    pub(crate) fn run(&mut self) -> bool {
        let width = self.size + 2;
        let constant = |entries: &[f64], row: usize| entries[row * width];
        let least = (0..self.size)
            .min_by(|&a, &b| constant(&self.entries, a).total_cmp(&constant(&self.entries, b)));
        let Some(least) = least else { return true };
        if constant(&self.entries, least) >= 0.0 {
            return true;
        }
        // In the order of the perturbation εᵏ the last of equal rows is the lowest.
        let lowest = constant(&self.entries, least);
        let row = (0..self.size).rev().find(|&row| constant(&self.entries, row) <= lowest);
        let mut leaving = self.pivot(row.unwrap_or(least), width - 1);
        for _ in 0..MOST_PIVOTS * width {
            let entering = match leaving {
                Name::Cover => return true,
                Name::W(place) => Name::Z(place),
                Name::Z(place) => Name::W(place),
            };
            let Some(column) = self.columns.iter().position(|name| *name == entering) else {
                return false;
            };
            let Some(row) = self.leaving_row(column + 1) else { return false };
            leaving = self.pivot(row, column + 1);
        }
        false
    }

    /// The row whose variable falls to zero first when the variable of this column grows; among ties the artificial
    /// unknown, else the lexicographic least.
    fn leaving_row(&self, column: usize) -> Option<usize> {
        let width = self.size + 2;
        let entry = |row: usize, column: usize| self.entries[row * width + column];
        let largest =
            (0..self.size).fold(0.0, |most, row| f64::max(most, entry(row, column).abs()));
        let falls = |row: &usize| entry(*row, column) < -NOTHING * largest;
        let ratio = |row: usize| entry(row, 0).max(0.0) / -entry(row, column);
        let least = (0..self.size).filter(falls).map(ratio).fold(f64::INFINITY, f64::min);
        let is_least = |row: &usize| falls(row) && ratio(*row) <= least * (1.0 + TIE);
        let tied = || (0..self.size).filter(is_least);
        if let Some(cover) = tied().find(|&row| self.rows[row] == Name::Cover) {
            return Some(cover);
        }
        tied().reduce(|a, b| if self.is_before(b, a, column) { b } else { a })
    }

    /// `true` if row `a` precedes row `b` in the order of the perturbation εᵏ of each constant.
    fn is_before(&self, a: usize, b: usize, column: usize) -> bool {
        let width = self.size + 2;
        let factor = |row: usize, place: usize| {
            let by = -self.entries[row * width + column];
            let coefficient = match self.columns.iter().position(|name| *name == Name::W(place)) {
                Some(column) => -self.entries[row * width + column + 1],
                None if self.rows[row] == Name::W(place) => 1.0,
                None => 0.0,
            };
            coefficient / by
        };
        let differs = (0..self.size).map(|place| (factor(a, place), factor(b, place)));
        differs.into_iter().find(|(a, b)| a != b).is_some_and(|(a, b)| a < b)
    }

    /// Exchanges the variables of a row and a column (0 is the constant's); returns the one that leaves the rows.
    fn pivot(&mut self, row: usize, column: usize) -> Name {
        let width = self.size + 2;
        let Self { entries, pivot_row, .. } = self;
        let own = &mut entries[row * width..][..width];
        let pivot = own[column];
        // From basic = … + pivot · entering to entering = (basic − …) / pivot.
        for entry in own.iter_mut() {
            *entry /= -pivot;
        }
        own[column] = 1.0 / pivot;
        pivot_row.clear();
        pivot_row.extend_from_slice(own);
        for (other, entries) in entries.chunks_exact_mut(width).enumerate() {
            let factor = entries[column];
            if other == row || factor == 0.0 {
                continue;
            }
            entries[column] = 0.0;
            for (entry, own) in entries.iter_mut().zip(&*pivot_row) {
                *entry += factor * own;
            }
        }
        std::mem::swap(&mut self.rows[row], &mut self.columns[column - 1]);
        self.columns[column - 1]
    }

    /// The value of an unknown; `None` where it is not basic, and so zero.
    pub(crate) fn value(&self, place: usize) -> Option<f64> {
        let row = self.rows.iter().position(|name| *name == Name::Z(place))?;
        Some(self.entries[row * (self.size + 2)])
    }
}

#[cfg(test)]
mod tests {
    use super::Lemke;

    /// w = q + M z; returns z, or `None` after a ray.
    fn solved(matrix: &[[f64; 2]; 2], q: [f64; 2]) -> Option<[f64; 2]> {
        let mut lemke = Lemke::with_room(2);
        let rows = lemke.begin(2);
        for (row, q) in matrix.iter().zip(q) {
            rows.extend([q, row[0], row[1], 1.0]);
        }
        lemke.run().then(|| [0, 1].map(|place| lemke.value(place).unwrap_or(0.0)))
    }

    #[test]
    fn complementary_solutions_are_found_and_rays_are_told() {
        // The first unknown alone: w₂ = −1 + 2 · 1 = 1.
        assert_eq!(solved(&[[2.0, 1.0], [2.0, 3.0]], [-2.0, -1.0]), Some([1.0, 0.0]));
        // Both: 2 z₁ + z₂ = 4 and z₁ + 3 z₂ = 7.
        let [a, b] = solved(&[[2.0, 1.0], [1.0, 3.0]], [-4.0, -7.0]).unwrap();
        assert!((a - 1.0).abs() < 1e-14 && (b - 2.0).abs() < 1e-14, "{a} {b}");
        // w₁ = −1 − z₁ − z₂ is never above zero.
        assert_eq!(solved(&[[-1.0, -1.0], [0.0, 1.0]], [-1.0, 1.0]), None);
    }
}
