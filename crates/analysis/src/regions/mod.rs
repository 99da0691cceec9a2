//! Regions of a plane of points: the class of each point, without finding it for each.
//!
//! First the points on some lines are found: columns and rows so close that an island of a given width and height has
//! one of them. Their distances are powers of two, and are halved until every column and row is a line. New points lie
//! between pairs of known ones: those midway along both axes along diagonals, then the others in rows and columns. Where
//! a pair is of one class and no other pair is of another, the point is filled in with that class; otherwise it is
//! found.
//!
//! Then every point is found that is filled in and has a neighbour of another class, until there is none. So a connected
//! region is exact if any point of it was found: were another point of it filled in wrongly, then somewhere between the
//! two a wrong point would be beside a right one, and would have been found.

use amontons::Error;

/// The class of a point of the plane, if it was found: one, or none, which no other point is filled in with.
pub(crate) type Found<T> = Option<Option<T>>;

/// Finds the points at these places; the class of each point of the plane then, or `None` if the watch ended it.
type Finder<'a, T> = &'a mut dyn FnMut(&[usize]) -> Result<Option<Vec<Found<T>>>, Error>;

/// New points, by the number of axes along which they lie midway between lines, and the directions to one line of each
/// pair that they lie between; the other one is opposite.
const TURNS: [(usize, [[isize; 2]; 2]); 2] = [(2, [[1, 1], [1, -1]]), (1, [[1, 0], [0, 1]])];

/// Width and height, in points, of the islands that are found wherever they lie, unless others are asked for: eight,
/// and fewer along an axis that would have less than six of them side by side.
#[must_use]
pub fn usual_islands(size: [usize; 2]) -> [usize; 2] {
    size.map(|count| [8, 4, 2].into_iter().find(|island| count > 6 * island).unwrap_or(1))
}

/// The first lines along an axis of `count` points: any `island` points side by side have one of them, and the distance
/// between neighbours is a power of two.
pub(crate) fn lines(count: usize, island: usize) -> Vec<usize> {
    let largest = 1 << island.max(1).ilog2();
    let next = |line: &usize| {
        let left = count - 1 - line;
        (left > 0).then(|| line + largest.min(1 << left.ilog2()))
    };
    std::iter::successors((count > 0).then_some(0), next).collect()
}

/// Finds the class of each point of a plane without finding each.
///
/// `find` is given the places of points, row by row from 0 on, finds those that were not found before, and tells the
/// class of each point of the plane that has been found. For each point that was not found the result has the class
/// with which it is filled in. `None` if `find` gives `None`.
///
/// # Errors
/// Returns an error of `find`.
pub(crate) fn trace<T: Copy + PartialEq>(
    size: [usize; 2],
    islands: [usize; 2],
    find: Finder<'_, T>,
) -> Result<Option<Vec<Option<T>>>, Error> {
    let points = size[0] * size[1];
    let mut plane = Plane { size, find, found: vec![None; points], sources: vec![None; points] };
    let mut known = [0, 1].map(|axis| lines(size[axis], islands[axis]));
    let [columns, rows] = &known;
    let first =
        rows.iter().flat_map(|row| columns.iter().map(move |column| row * size[0] + column));
    let Some(()) = plane.find(&first.collect::<Vec<_>>())? else { return Ok(None) };
    loop {
        let finer = known.each_ref().map(|lines| halved(lines));
        if finer == known {
            break;
        }
        for turn in &TURNS {
            let wanted = plane.fill(&known, &finer, turn);
            let Some(()) = plane.find(&wanted)? else { return Ok(None) };
        }
        known = finer;
    }
    loop {
        let wanted = plane.beside_boundaries();
        if wanted.is_empty() {
            let filled =
                |place: usize| plane.found[place].is_none().then(|| plane.class(place)).flatten();
            return Ok(Some((0..points).map(filled).collect()));
        }
        let Some(()) = plane.find(&wanted)? else { return Ok(None) };
    }
}

/// These lines, and one midway between any two that are not neighbours.
fn halved(lines: &[usize]) -> Vec<usize> {
    let mut finer: Vec<usize> =
        lines.windows(2).map(|pair| usize::midpoint(pair[0], pair[1])).collect();
    finer.extend(lines);
    finer.sort_unstable();
    finer.dedup();
    finer
}

/// A plane with the classes of its points, as far as they are found or filled in.
struct Plane<'a, T> {
    size: [usize; 2],
    find: Finder<'a, T>,
    found: Vec<Found<T>>,
    /// The place of the found point whose class each point has: its own, or the one that it is filled in from.
    sources: Vec<Option<usize>>,
}

impl<T: Copy + PartialEq> Plane<'_, T> {
    /// The class of the point at this place, found or filled in; `None` if it has none, or is not known yet.
    fn class(&self, place: usize) -> Option<T> {
        self.sources[place].and_then(|source| self.found[source].flatten())
    }

    /// Finds the points at these places; `None` if the watch ended it.
    fn find(&mut self, places: &[usize]) -> Result<Option<()>, Error> {
        if places.is_empty() {
            return Ok(Some(()));
        }
        let Some(found) = (self.find)(places)? else { return Ok(None) };
        for (place, source) in self.sources.iter_mut().enumerate() {
            if found[place].is_some() {
                *source = Some(place);
            }
        }
        self.found = found;
        Ok(Some(()))
    }

    /// Fills in those new points of the finer lines whose turn it is and whose class pairs of known ones say; the places
    /// of the others.
    fn fill(
        &mut self,
        known: &[Vec<usize>; 2],
        finer: &[Vec<usize>; 2],
        (along, pairs): &(usize, [[isize; 2]; 2]),
    ) -> Vec<usize> {
        let is_new = |axis: usize, line: usize| known[axis].binary_search(&line).is_err();
        let (mut filled, mut wanted) = (Vec::new(), Vec::new());
        for (j, &row) in finer[1].iter().enumerate() {
            for (i, &column) in finer[0].iter().enumerate() {
                let place = row * self.size[0] + column;
                let new = usize::from(is_new(0, column)) + usize::from(is_new(1, row));
                if new != *along || self.sources[place].is_some() {
                    continue;
                }
                match self.source([i, j], finer, pairs) {
                    Some(source) => filled.push((place, source)),
                    None => wanted.push(place),
                }
            }
        }
        for (place, source) in filled {
            self.sources[place] = Some(source);
        }
        wanted
    }

    /// The source of the class that pairs of points on opposite sides of a crossing of the lines have; `None` if none
    /// has one, or two have different ones.
    fn source(
        &self,
        [i, j]: [usize; 2],
        [columns, rows]: &[Vec<usize>; 2],
        pairs: &[[isize; 2]],
    ) -> Option<usize> {
        let of_pair = |[right, up]: &[isize; 2]| {
            let at = |sign: isize| {
                let column = columns.get(i.checked_add_signed(sign * right)?)?;
                let row = rows.get(j.checked_add_signed(sign * up)?)?;
                Some(row * self.size[0] + column)
            };
            let [one, other] = [at(-1)?, at(1)?];
            let class = self.class(one)?;
            (self.class(other) == Some(class)).then_some(one)
        };
        let mut pairs = pairs.iter().filter_map(of_pair);
        let first = pairs.next()?;
        let agree = pairs.all(|pair| self.class(pair) == self.class(first));
        self.sources[first].filter(|_| agree)
    }

    /// The place of the point so far to the right and up from another, if it lies in the plane.
    fn beside(&self, place: usize, [right, up]: [isize; 2]) -> Option<usize> {
        let [columns, rows] = self.size;
        let column = (place % columns).checked_add_signed(right)?;
        let row = (place / columns).checked_add_signed(up)?;
        (column < columns && row < rows).then_some(row * columns + column)
    }

    /// The places of the points that were not found and have a neighbour of another class.
    fn beside_boundaries(&self) -> Vec<usize> {
        let has_other = |place: usize| {
            let mut beside = [[1, 0], [-1, 0], [0, 1], [0, -1]].into_iter();
            beside.any(|step| {
                self.beside(place, step).is_some_and(|at| self.class(at) != self.class(place))
            })
        };
        (0..self.found.len()).filter(|&at| self.found[at].is_none() && has_other(at)).collect()
    }
}

#[cfg(test)]
mod tests;
