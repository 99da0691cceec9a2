//! An order of elimination by nested dissection.

use std::collections::{HashMap, VecDeque};

/// Parts of up to as many rows are not divided.
const UNDIVIDED: usize = 60;
/// The number of averages over neighbours that make the distance along a part smooth.
const AVERAGES: usize = 60;
/// The least part of the rows on each side of a separator.
const LEAST: f64 = 0.35;

/// A graph whose vertices stand for sets of rows.
struct Graph {
    /// The rows of each vertex.
    rows: Vec<Vec<usize>>,
    neighbours: Vec<Vec<usize>>,
}

/// An order in which rows of a symmetric pattern can be eliminated with little fill: the two halves of a body come before
/// the rows that separate them, and so on in each half. For bodies of solid elements it has fewer operations than the minimum
/// degree, whose fronts grow in from all sides.
///
/// `pairs` are the entries (row, column) of a triangle without the diagonal. A half is cut by the smoothest function on it:
/// distances from an end, averaged over neighbours.
pub(crate) fn order(size: usize, pairs: &[(usize, usize)]) -> Vec<usize> {
    let graph = compressed(size, pairs);
    let count = graph.rows.len();
    let mut order = vec![];
    // Parts that are still to be ordered, the last one first; from the end, since separators come last.
    let mut parts: Vec<Vec<usize>> = vec![(0..count).collect()];
    let mut scratch = Scratch { part_of: vec![0; count], distance: vec![0; count], last: 0 };
    while let Some(part) = parts.pop() {
        let weight: usize = part.iter().map(|&vertex| graph.rows[vertex].len()).sum();
        scratch.enter(&part);
        let near = scratch.reach(&graph, part[0]);
        if near.len() < part.len() {
            let reached = scratch.part_of[near[0]];
            let far = |vertex: &usize| scratch.part_of[*vertex] != reached;
            parts.push(part.iter().copied().filter(far).collect());
            parts.push(near);
            continue;
        }
        let divided = if weight > UNDIVIDED { divide(&graph, &near, &mut scratch) } else { None };
        match divided {
            Some([first, second, separator]) => {
                order.extend(separator);
                parts.push(first);
                parts.push(second);
            }
            None => order.extend(part),
        }
    }
    order.into_iter().rev().flat_map(|vertex| graph.rows[vertex].iter().copied()).collect()
}

/// Numbers of all vertices, of which those of one part are in use.
struct Scratch {
    /// The number of the part in which a vertex is.
    part_of: Vec<usize>,
    /// The distance from the start, or the place in the part.
    distance: Vec<usize>,
    /// The last number of a part.
    last: usize,
}

impl Scratch {
    /// Gives a new number to a part.
    fn enter(&mut self, part: &[usize]) {
        self.last += 1;
        part.iter().for_each(|&vertex| self.part_of[vertex] = self.last);
    }

    /// The vertices that can be reached in the part of one of them, by distance. They get a new number.
    fn reach(&mut self, graph: &Graph, start: usize) -> Vec<usize> {
        let part = self.part_of[start];
        self.last += 1;
        (self.part_of[start], self.distance[start]) = (self.last, 0);
        let (mut queue, mut reached) = (VecDeque::from([start]), vec![]);
        while let Some(vertex) = queue.pop_front() {
            reached.push(vertex);
            for &other in &graph.neighbours[vertex] {
                if self.part_of[other] == part {
                    self.part_of[other] = self.last;
                    self.distance[other] = self.distance[vertex] + 1;
                    queue.push_back(other);
                }
            }
        }
        reached
    }
}

/// The graph of a pattern in which rows with the same neighbours are one vertex, as those of a node of a mesh are.
fn compressed(size: usize, pairs: &[(usize, usize)]) -> Graph {
    let mut neighbours: Vec<Vec<usize>> = (0..size).map(|row| vec![row]).collect();
    for &(row, column) in pairs {
        neighbours[row].push(column);
        neighbours[column].push(row);
    }
    let mut vertices: HashMap<&[usize], usize> = HashMap::new();
    neighbours.iter_mut().for_each(|list| list.sort_unstable());
    let mut rows: Vec<Vec<usize>> = vec![];
    let mut vertex_of = vec![0; size];
    for (row, list) in neighbours.iter().enumerate() {
        let vertex = *vertices.entry(list).or_insert(rows.len());
        if vertex == rows.len() {
            rows.push(vec![]);
        }
        rows[vertex].push(row);
        vertex_of[row] = vertex;
    }
    let neighbours = rows
        .iter()
        .enumerate()
        .map(|(vertex, rows)| {
            let mut list: Vec<usize> =
                neighbours[rows[0]].iter().map(|&row| vertex_of[row]).collect();
            list.sort_unstable();
            list.dedup();
            list.retain(|&other| other != vertex);
            list
        })
        .collect();
    Graph { rows, neighbours }
}

/// Two halves of a connected part without edges between them, and the vertices that separate them. The vertices of the part
/// go by distance from one of them.
fn divide(graph: &Graph, part: &[usize], scratch: &mut Scratch) -> Option<[Vec<usize>; 3]> {
    // From an end of the part the distances tell its longest direction.
    scratch.reach(graph, *part.last()?);
    let mut key: Vec<f64> = part.iter().map(|&vertex| scratch.distance[vertex] as f64).collect();
    for (place, &vertex) in part.iter().enumerate() {
        scratch.distance[vertex] = place;
    }
    let inside = |&&other: &&usize| scratch.part_of[other] == scratch.last;
    let near: Vec<Vec<usize>> = part
        .iter()
        .map(|&vertex| {
            let others = graph.neighbours[vertex].iter().filter(inside);
            others.map(|&other| scratch.distance[other]).collect()
        })
        .collect();
    let most = near.iter().map(Vec::len).max()? as f64;
    for _ in 0..AVERAGES {
        let changes: Vec<f64> = near
            .iter()
            .zip(&key)
            .map(|(near, value)| near.iter().map(|&other| key[other] - value).sum::<f64>() / most)
            .collect();
        key.iter_mut().zip(changes).for_each(|(value, change)| *value += 0.7 * change);
    }
    let mut sorted: Vec<usize> = (0..part.len()).collect();
    sorted.sort_by(|&a, &b| key[a].total_cmp(&key[b]).then(a.cmp(&b)));
    cut(graph, part, &near, &sorted)
}

/// Cuts a sorted part where fewest rows separate its halves.
fn cut(
    graph: &Graph,
    part: &[usize],
    near: &[Vec<usize>],
    sorted: &[usize],
) -> Option<[Vec<usize>; 3]> {
    let mut rank = vec![0; part.len()];
    sorted.iter().enumerate().for_each(|(number, &place)| rank[place] = number);
    let weight = |place: usize| graph.rows[part[place]].len();
    let all: usize = (0..part.len()).map(weight).sum();
    // A vertex before the cut separates if a neighbour is behind it: from its own rank to that of its last neighbour.
    let mut starts = vec![0isize; part.len() + 1];
    for place in 0..part.len() {
        let last = near[place].iter().map(|&other| rank[other]).max().unwrap_or(0);
        if last > rank[place] {
            let weight = isize::try_from(weight(place)).ok()?;
            starts[rank[place] + 1] += weight;
            starts[last + 1] -= weight;
        }
    }
    let (mut before, mut separating, mut best) = (0, 0, None);
    for number in 1..part.len() {
        before += weight(sorted[number - 1]);
        separating += starts[number];
        let share = before as f64 / all as f64;
        if (LEAST..=1.0 - LEAST).contains(&share)
            && best.is_none_or(|(least, _)| separating < least)
        {
            best = Some((separating, number));
        }
    }
    let (_, number) = best?;
    let mut parts = [vec![], vec![], vec![]];
    for place in 0..part.len() {
        let separates = || near[place].iter().any(|&other| rank[other] >= number);
        let side = if rank[place] >= number {
            1
        } else if separates() {
            2
        } else {
            0
        };
        parts[side].push(part[place]);
    }
    (!parts[0].is_empty()).then_some(parts)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_permutation(order: &[usize]) -> bool {
        let mut sorted = order.to_vec();
        sorted.sort_unstable();
        sorted.into_iter().eq(0..order.len())
    }

    #[test]
    fn all_rows_come_once_in_patterns_of_any_shape() {
        let size = 300;
        let full = (0..size).flat_map(|row| (row + 1..size).map(move |column| (row, column)));
        let line = (1..size).map(|row| (row - 1, row));
        // Several lines, and rows by themselves.
        let lines = line.clone().filter(|pair| pair.0 % 97 != 0);
        for pairs in [full.collect(), line.collect(), lines.collect(), vec![]] {
            let pairs: Vec<(usize, usize)> = pairs;
            assert!(is_permutation(&order(size, &pairs)));
        }
    }

    #[test]
    fn the_last_rows_of_a_strip_cut_it_across() {
        // 60 × 5 points with two rows each, and edges to the neighbours on the sides.
        let (length, width) = (60, 5);
        let row = |x: usize, y: usize, kind: usize| 2 * (width * x + y) + kind;
        let mut pairs = vec![];
        for x in 0..length {
            for y in 0..width {
                pairs.push((row(x, y, 0), row(x, y, 1)));
                for (first, second) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    if x > 0 {
                        pairs.push((row(x - 1, y, first), row(x, y, second)));
                    }
                    if y > 0 {
                        pairs.push((row(x, y - 1, first), row(x, y, second)));
                    }
                }
            }
        }
        let order = order(2 * length * width, &pairs);
        assert!(is_permutation(&order));
        let cut: Vec<usize> = order[order.len() - 2 * width..].iter().map(|row| row / 2).collect();
        let mut across: Vec<usize> = cut.iter().map(|point| point % width).collect();
        across.sort_unstable();
        across.dedup();
        assert_eq!(across.len(), width);
        assert!(cut.iter().all(|point| (15..45).contains(&(point / width))), "{cut:?}");
    }
}
