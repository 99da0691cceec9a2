//! Made-up planes: the picture, and the number of points that it takes.

use super::*;
use std::collections::BTreeSet;

/// The class of a point, by its column and row.
type Classes<'a> = &'a dyn Fn([usize; 2]) -> Option<usize>;

/// The places of the points that are found, and the class of each point as it is traced.
fn traced(
    size: [usize; 2],
    islands: [usize; 2],
    class: Classes<'_>,
) -> (BTreeSet<usize>, Vec<Option<usize>>) {
    let mut found = BTreeSet::new();
    let known = |found: &BTreeSet<usize>, place: usize| {
        found.contains(&place).then(|| class([place % size[0], place / size[0]]))
    };
    let places = 0..size[0] * size[1];
    let filled = trace(size, islands, &mut |wanted| {
        for place in wanted {
            assert!(found.insert(*place), "{place} is found twice");
        }
        Ok(Some(places.clone().map(|place| known(&found, place)).collect()))
    });
    let filled = filled.unwrap().unwrap();
    let all = places.map(|place| known(&found, place).unwrap_or(filled[place])).collect();
    (found, all)
}

fn all(size: [usize; 2], class: Classes<'_>) -> Vec<Option<usize>> {
    (0..size[0] * size[1]).map(|place| class([place % size[0], place / size[0]])).collect()
}

/// The points whose class is not as it is traced.
fn wrong(traced: &[Option<usize>], size: [usize; 2], class: Classes<'_>) -> Vec<[usize; 2]> {
    let places = (0..size[0] * size[1]).map(|place| [place % size[0], place / size[0]]);
    let both = places.zip(traced);
    both.filter(|(at, traced)| class(*at) != **traced).map(|(at, _)| at).collect()
}

const SIZE: [usize; 2] = [121, 113];

#[test]
fn half_planes_are_exact_by_a_few_points_in_a_hundred() {
    for degrees in (0..180).step_by(7) {
        for shift in [-31.3, 0.2, 17.9] {
            let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
            let class = |[column, row]: [usize; 2]| {
                let along = (column as f64 - 60.0) * cos + (row as f64 - 56.0) * sin;
                Some(usize::from(along > shift))
            };
            for (size, islands) in [(SIZE, [4, 16]), ([100, 118], [8, 8]), ([80, 64], [5, 7])] {
                let picture = traced(size, islands, &class).1;
                let wrong = wrong(&picture, size, &class);
                assert!(wrong.is_empty(), "{degrees} {shift} {size:?} {wrong:?}");
            }
            let (found, picture) = traced(SIZE, [8, 8], &class);
            assert!(picture == all(SIZE, &class), "{degrees} {shift}");
            assert!(found.len() * 1000 < 55 * SIZE[0] * SIZE[1], "{} {degrees}", found.len());
        }
    }
}

#[test]
fn a_disc_in_a_ring_is_exact() {
    for (x, y) in [(60.0, 55.0), (60.3, 55.9), (58.1, 54.4)] {
        let class = |[column, row]: [usize; 2]| {
            let radius = f64::hypot(column as f64 - x, row as f64 - y);
            Some(usize::from((12.0..50.0).contains(&radius)))
        };
        let (found, picture) = traced(SIZE, [8, 8], &class);
        let wrong = wrong(&picture, SIZE, &class);
        assert!(wrong.is_empty(), "{wrong:?}");
        assert!(found.len() * 1000 < 90 * SIZE[0] * SIZE[1], "{}", found.len());
    }
}

/// Straight edges of a rectangle once had notches, one point deep and some points long: bends of the boundary were looked
/// for in the picture, and the notch was straight enough to hide its own.
#[test]
fn rectangles_and_ellipses_of_any_size_and_place_are_exact() {
    for number in 0..400_u32 {
        // Numbers without a pattern.
        let part = |step: f64| (f64::from(number) * step).fract();
        let size = [0.618, 0.414].map(|step| 50 + (50.0 * part(step)) as usize);
        let sides = [0.732, 0.236].map(|step| 8 + (14.0 * part(step)) as usize);
        let begin = [0, 1].map(|axis| {
            let room = size[axis] - sides[axis];
            (room as f64 * part([0.303, 0.577][axis])) as usize
        });
        let is_in = |at: [usize; 2], axis: usize| {
            (begin[axis]..begin[axis] + sides[axis]).contains(&at[axis])
        };
        let rectangle = |at: [usize; 2]| Some(usize::from(is_in(at, 0) && is_in(at, 1)));
        let ellipse = |at: [usize; 2]| {
            let (sin, cos) = (3.0 * part(0.707)).sin_cos();
            let [x, y] = [0, 1].map(|axis| at[axis] as f64 - 0.5 * size[axis] as f64 - part(0.9));
            let [along, across] = [x * cos + y * sin, y * cos - x * sin];
            let [a, b] = [0.61, 0.43].map(|step| 6.0 + 18.0 * part(step));
            Some(usize::from(f64::hypot(along / a, across / b) < 1.0))
        };
        for class in [&rectangle as Classes<'_>, &ellipse] {
            let picture = traced(size, [8, 8], class).1;
            let wrong = wrong(&picture, size, class);
            assert!(wrong.is_empty(), "{number} {size:?} {wrong:?}");
        }
    }
}

#[test]
fn planes_of_any_size_are_covered() {
    for size in [[1, 1], [1, 9], [2, 2], [8, 3], [9, 17], [10, 18], [3, 40], [40, 1]] {
        for islands in [[1, 1], [2, 2], [3, 5], [8, 8], [100, 100], usual_islands(size)] {
            let class = |[column, row]: [usize; 2]| Some(usize::from(2 * column > row));
            assert_eq!(traced(size, islands, &class).1, all(size, &class), "{size:?} {islands:?}");
        }
    }
    assert_eq!(traced([0, 5], [8, 8], &|_| Some(0)).1, []);
}

#[test]
fn an_island_of_four_points_is_found_wherever_it_lies_if_it_is_asked_for() {
    islands(&[2]);
}

#[test]
fn islands_are_found_wherever_they_lie() {
    islands(&[1, 3, 4, 8, 16]);
}

/// Looks for islands of these sizes at every place.
fn islands(sides: &[usize]) {
    let size = [25, 22];
    for &side in sides {
        for (left, lower) in (0..=25 - side).flat_map(|x| (0..=22 - side).map(move |y| (x, y))) {
            let is_in = |place: usize, first: usize| (first..first + side).contains(&place);
            let class = |[column, row]: [usize; 2]| {
                Some(usize::from(is_in(column, left) && is_in(row, lower)))
            };
            let picture = traced(size, [side, side], &class).1;
            assert!(picture == all(size, &class), "{side} {left} {lower}");
        }
    }
}

#[test]
fn an_island_smaller_than_asked_for_can_be_missed() {
    let class = |[column, row]: [usize; 2]| {
        Some(usize::from((9..16).contains(&column) && (9..16).contains(&row)))
    };
    assert_eq!(traced([25, 25], [8, 8], &class).1, vec![Some(0); 625]);
}

#[test]
fn a_tongue_that_is_found_anywhere_is_followed_to_its_tip() {
    // Two points wide, along a diagonal; lines of the tracing cross it here and there only.
    let class = |[column, row]: [usize; 2]| {
        Some(usize::from((10..90).contains(&column) && (row == column || row == column + 1)))
    };
    let (found, picture) = traced(SIZE, [8, 8], &class);
    assert!(picture == all(SIZE, &class), "{:?}", wrong(&picture, SIZE, &class));
    assert!(found.len() * 100 < 8 * SIZE[0] * SIZE[1], "{}", found.len());
}

#[test]
fn a_chequered_plane_of_squares_is_exact() {
    for side in [8, 11] {
        let class = |[column, row]: [usize; 2]| Some((column / side + row / side) % 2);
        let picture = traced(SIZE, [8, 8], &class).1;
        let wrong = wrong(&picture, SIZE, &class);
        assert!(wrong.is_empty(), "{side} {wrong:?}");
    }
}

#[test]
fn a_point_between_pairs_that_contradict_each_other_is_found() {
    let class = |[column, row]: [usize; 2]| Some(usize::from((column < 2) == (row < 2)));
    let mut wanted = Vec::new();
    let mut found = vec![None; 25];
    trace([5, 5], [4, 4], &mut |places| {
        wanted.push(places.to_vec());
        for place in places {
            found[*place] = Some(class([place % 5, place / 5]));
        }
        Ok(Some(found.clone()))
    })
    .unwrap();
    assert_eq!(wanted[..2], [vec![0, 4, 20, 24], vec![12]]);
}

#[test]
fn three_classes_meet_in_one_point() {
    let class = |[column, row]: [usize; 2]| {
        let angle = f64::atan2(row as f64 - 50.3, column as f64 - 63.7);
        Some(if angle < -1.2 {
            0
        } else if angle < 0.7 {
            1
        } else {
            2
        })
    };
    let picture = traced(SIZE, [8, 8], &class).1;
    assert!(picture == all(SIZE, &class), "{:?}", wrong(&picture, SIZE, &class));
}

#[test]
fn no_point_is_filled_in_with_no_class() {
    let class = |[column, _]: [usize; 2]| (column < 20).then_some(0);
    let (found, picture) = traced([41, 9], [4, 4], &class);
    assert_eq!(picture, all([41, 9], &class));
    assert!(found.len() > 20 * 9 && found.len() < 41 * 9, "{}", found.len());
}

/// Points that were found before, as those that a basin follows first.
#[test]
fn an_island_that_was_found_before_is_traced() {
    let size = [41, 41];
    let class = |at: [usize; 2]| Some(usize::from(at == [13, 11] || at == [14, 11]));
    let mut found: BTreeSet<usize> = [11 * 41 + 13].into();
    let filled = trace(size, [8, 8], &mut |wanted| {
        found.extend(wanted);
        let known = |place| found.contains(&place).then(|| class([place % 41, place / 41]));
        Ok(Some((0..41 * 41).map(known).collect()))
    });
    assert!(filled.unwrap().unwrap().iter().all(|class| *class != Some(1)));
    assert!(found.contains(&(11 * 41 + 14)));
    assert!(found.len() < 60, "{}", found.len());
}

#[test]
fn work_that_is_ended_has_no_picture_and_an_error_is_passed_on() {
    assert_eq!(trace::<usize>([9, 9], [4, 4], &mut |_| Ok(None)), Ok(None));
    let failed = || Error::analysis("no disk");
    assert_eq!(trace::<usize>([9, 9], [4, 4], &mut |_| Err(failed())), Err(failed()));
}

#[test]
fn usual_islands_leave_six_of_them_side_by_side() {
    assert_eq!(usual_islands([121, 113]), [8, 8]);
    assert_eq!(usual_islands([49, 48]), [8, 4]);
    assert_eq!(usual_islands([24, 12]), [2, 1]);
    assert_eq!(usual_islands([1, 0]), [1, 1]);
}
