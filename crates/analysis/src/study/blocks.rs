//! Blocks of a plane of points, which find where its basins meet without a run of each point.
//!
//! The plane is covered with blocks of 4 by 4 spacings, whose corners are run: every fourth point along both axes. A
//! block whose points that were run do not all end in one attractor is halved along both axes, down to neighbouring
//! points, and the corners of the halves are run. All other points are filled in. A basin that covers four by four points
//! somewhere has a point there that is run; an island, or a tongue, that is narrower can lie between the points that are
//! run and be missed.

use amontons::Error;
use std::collections::BTreeSet;
use std::ops::RangeInclusive;

/// The most spacings along a side of a block.
const LARGEST: usize = 4;

/// The end of a point of the plane, if it was run: a known attractor, or none that is known.
pub(super) type End = Option<Option<usize>>;

/// Runs the points at these places; the end of each point of the plane then, or `None` if the watch ended it.
type Runner<'a> = &'a mut dyn FnMut(&[usize]) -> Result<Option<Vec<End>>, Error>;

/// The points from a first to a last one along both axes.
#[derive(Clone, Debug, PartialEq)]
struct Block {
    columns: RangeInclusive<usize>,
    rows: RangeInclusive<usize>,
}

/// Finds the end of each point of a plane without a run of each.
///
/// `run` is given the places of points, row by row from 0 on, runs those that were not run before, and tells the end of
/// each point of the plane; it is called until no block is left to be halved. For each point that was not run the
/// result has the attractor with which it is filled in. `None` if `run` gives `None`.
///
/// # Errors
/// Returns an error of `run`.
pub(super) fn trace(
    [columns, rows]: [usize; 2],
    run: Runner<'_>,
) -> Result<Option<Vec<Option<usize>>>, Error> {
    let place = |[column, row]: [usize; 2]| row * columns + column;
    let mut blocks = cover(columns, rows);
    loop {
        let corners: BTreeSet<usize> = blocks.iter().flat_map(Block::corners).map(place).collect();
        let corners: Vec<usize> = corners.into_iter().collect();
        let Some(ends) = run(&corners)? else { return Ok(None) };
        let end = |point: [usize; 2]| ends[place(point)];
        let parts: Vec<_> = blocks
            .iter()
            .map(|block| if block.attractor(&end).is_some() { None } else { block.halved() })
            .collect();
        if parts.iter().all(Option::is_none) {
            let mut filled = vec![None; columns * rows];
            for block in &blocks {
                let attractor = block.attractor(&end);
                for point in block.points().filter(|point| end(*point).is_none()) {
                    filled[place(point)] = attractor;
                }
            }
            return Ok(Some(filled));
        }
        let parted = blocks.into_iter().zip(parts);
        blocks = parted.flat_map(|(block, parts)| parts.unwrap_or_else(|| vec![block])).collect();
    }
}

/// Blocks that cover the plane.
fn cover(columns: usize, rows: usize) -> Vec<Block> {
    let sides = |count: usize| {
        let last = count.saturating_sub(1);
        let starts = (0..last.max(1)).step_by(LARGEST);
        starts.map(move |start| start..=(start + LARGEST).min(last))
    };
    sides(rows)
        .flat_map(|rows| sides(columns).map(move |columns| Block { columns, rows: rows.clone() }))
        .collect()
}

impl Block {
    /// The corners, each as column and row.
    fn corners(&self) -> [[usize; 2]; 4] {
        let [left, right] = [*self.columns.start(), *self.columns.end()];
        let [lower, upper] = [*self.rows.start(), *self.rows.end()];
        [[left, lower], [right, lower], [left, upper], [right, upper]]
    }

    /// All its points with those on its border, each as column and row.
    fn points(&self) -> impl Iterator<Item = [usize; 2]> {
        let columns = self.columns.clone();
        self.rows.clone().flat_map(move |row| columns.clone().map(move |column| [column, row]))
    }

    /// The attractor in which all of its points end that were run; `None` if they do not end in one.
    fn attractor(&self, end: &dyn Fn([usize; 2]) -> End) -> Option<usize> {
        let mut ends = self.points().filter_map(end);
        let first = ends.next().flatten();
        first.filter(|_| ends.all(|end| end == first))
    }

    /// The blocks that it is halved into; `None` if it has no points but its corners.
    fn halved(&self) -> Option<Vec<Self>> {
        let halves = |side: &RangeInclusive<usize>| {
            let middle = middle(side);
            if side.end() - side.start() > 1 {
                vec![*side.start()..=middle, middle..=*side.end()]
            } else {
                vec![side.clone()]
            }
        };
        let (columns, rows) = (halves(&self.columns), halves(&self.rows));
        let all = rows.iter().flat_map(|rows| {
            columns.iter().map(|columns| Self { columns: columns.clone(), rows: rows.clone() })
        });
        (columns.len() + rows.len() > 2).then(|| all.collect())
    }
}

fn middle(side: &RangeInclusive<usize>) -> usize {
    usize::midpoint(*side.start(), *side.end())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Number of points of a plane that are run, and the attractor of each as it is traced.
    fn traced(
        size: [usize; 2],
        end: &dyn Fn([usize; 2]) -> Option<usize>,
    ) -> (usize, Vec<Option<usize>>) {
        let mut run = BTreeSet::new();
        let known = |run: &BTreeSet<usize>, place: usize| {
            run.contains(&place).then(|| end([place % size[0], place / size[0]]))
        };
        let places = 0..size[0] * size[1];
        let filled = trace(size, &mut |corners| {
            run.extend(corners);
            Ok(Some(places.clone().map(|place| known(&run, place)).collect()))
        });
        let filled = filled.unwrap().unwrap();
        let found = places.map(|place| known(&run, place).unwrap_or(filled[place]));
        (run.len(), found.collect())
    }

    fn all(size: [usize; 2], end: &dyn Fn([usize; 2]) -> Option<usize>) -> Vec<Option<usize>> {
        let [columns, rows] = size;
        (0..rows).flat_map(|row| (0..columns).map(move |column| end([column, row]))).collect()
    }

    #[test]
    fn a_disc_in_a_ring_is_found_by_a_fraction_of_the_points() {
        let end = |[column, row]: [usize; 2]| {
            let squared = (column as f64 - 60.0).powi(2) + (row as f64 - 55.0).powi(2);
            Some(usize::from((12.0..50.0).contains(&squared.sqrt())))
        };
        let (run, found) = traced([121, 113], &end);
        assert_eq!(found, all([121, 113], &end));
        assert!(run < 121 * 113 / 4, "{run}");
    }

    #[test]
    fn planes_of_any_size_are_covered() {
        for size in [[1, 1], [1, 9], [2, 2], [8, 3], [9, 17], [10, 18], [3, 40]] {
            let end = |[column, row]: [usize; 2]| Some(usize::from(2 * column > row));
            assert_eq!(traced(size, &end).1, all(size, &end), "{size:?}");
        }
    }

    #[test]
    fn a_basin_as_large_as_a_block_is_not_missed_wherever_it_lies() {
        let size = [25, 22];
        for (left, lower) in (0..22).flat_map(|left| (0..19).map(move |lower| (left, lower))) {
            let is_in = |place: usize, first: usize| (first..first + LARGEST).contains(&place);
            let end = |[column, row]: [usize; 2]| {
                Some(usize::from(is_in(column, left) && is_in(row, lower)))
            };
            assert_eq!(traced(size, &end).1, all(size, &end), "{left} {lower}");
        }
    }

    #[test]
    fn points_without_an_attractor_have_neighbours_that_are_run() {
        let end = |[column, _]: [usize; 2]| (column < 20).then_some(0);
        let (run, found) = traced([41, 9], &end);
        assert_eq!(found, all([41, 9], &end));
        assert!(run > 20 * 9 && run < 41 * 9, "{run}");
    }
}
