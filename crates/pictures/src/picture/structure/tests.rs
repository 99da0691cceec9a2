//! Labels, links and masses of structures of many kinds keep apart and show directions.

use super::examples::{all, chain, corner, disc, mass, oblique, random, ring, slider, spring};
use super::labels::Label;
use super::layout::{End, Run, places, runs};
use super::plane::{apart, length, sub, unit};
use super::sheet::Sheet;
use super::symbols::{Shape, force_colour, slider_colour, spring_colour};
use super::text::values;
use super::*;
use crate::picture::canvas::{Drawing, Point, WIDTH};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// `true` if a segment passes through the box of a label.
fn passes(label: &Label, [from, to]: [Point; 2]) -> bool {
    // The part of the segment that is within both strips, if any.
    let (mut start, mut end) = (0.0_f64, 1.0_f64);
    for axis in [0, 1] {
        let (at, step) = (from[axis] - label.middle[axis], to[axis] - from[axis]);
        let half = label.half[axis];
        if step.abs() < 1e-9 {
            if at.abs() >= half {
                return false;
            }
            continue;
        }
        let [a, b] = [(-half - at) / step, (half - at) / step];
        start = start.max(a.min(b));
        end = end.min(a.max(b));
    }
    start < end
}

/// The way from one mass to another, of any length.
fn between(structure: &Structure, from: usize, to: usize) -> Point {
    let places = places(structure);
    sub(places[to], places[from])
}

fn close(a: Point, b: Point) -> bool {
    length(sub(a, b)) < 1e-9
}

fn assert_labels_keep_apart(name: &str, labels: &[Label]) {
    for (place, label) in labels.iter().enumerate() {
        for other in &labels[..place] {
            let apart = |axis: usize| {
                let between = (label.middle[axis] - other.middle[axis]).abs();
                // Their corners are round: letters do not fill them.
                between >= label.half[axis] + other.half[axis] - 3.0
            };
            assert!(apart(0) || apart(1), "{name}: {:?} and {:?}", label.lines, other.lines);
        }
    }
}

#[test]
fn no_label_is_over_another_nor_beyond_the_picture() {
    for (name, structure) in all() {
        let sheet = Sheet::of(&structure);
        assert_labels_keep_apart(name, &sheet.labels);
        for label in &sheet.labels {
            let [x, wide] = [label.middle[0], label.half[0]];
            assert!(x - wide > 0.0 && x + wide < WIDTH, "{name}: {:?}", label.lines);
        }
    }
}

#[test]
fn all_of_a_random_network_is_drawn_and_named() {
    for seed in 1..=16 {
        let structure = random(seed, 2 + usize::try_from(seed % 9).unwrap());
        let name = &*structure.title;
        let places = places(&structure);
        for (mass, place) in places.iter().enumerate() {
            let taken = places[..mass].iter().any(|other| length(sub(*place, *other)) < 0.99);
            assert!(!taken, "{name}: m{mass} at {place:?}");
        }
        let runs = runs(&structure, &places);
        for place in 0..structure.links.len() {
            let of = runs.iter().filter(|run| run.links.contains(&place));
            let ends: Vec<End> = of.map(|run| run.end).collect();
            let named = matches!(ends[..], [End::Name(_), End::Name(_)]);
            assert!(ends.len() == 1 || named, "{name}: link {place} at {ends:?}");
        }
        let sheet = Sheet::of(&structure);
        assert_labels_keep_apart(name, &sheet.labels);
        let named = |name: &str| {
            sheet.labels.iter().any(|label| label.lines[0].split(' ').next() == Some(name))
        };
        let masses = structure.masses.iter().map(|mass| &*mass.name);
        let links = structure.links.iter().map(|link| &*link.name);
        let sliders = structure.sliders.iter().map(|slider| &*slider.name);
        masses.chain(links).chain(sliders).for_each(|own| assert!(named(own), "{name}: {own}"));
    }
}

#[test]
fn straight_links_keep_off_masses_that_they_do_not_join() {
    let random = (1..=16).map(|seed| random(seed, 8));
    for structure in all().into_iter().map(|(_, structure)| structure).chain(random) {
        let places = places(&structure);
        for run in runs(&structure, &places) {
            let End::Mass(end) = run.end else { continue };
            let line = [places[run.mass], places[end]];
            let met = (0..places.len()).find(|&mass| {
                mass != run.mass && mass != end && apart(line, [places[mass]; 2]) < 0.35
            });
            assert_eq!(met, None, "{}: {run:?}", structure.title);
        }
    }
}

#[test]
fn no_line_leads_through_a_label_and_labels_stand_at_what_they_name() {
    for (name, structure) in all() {
        let sheet = Sheet::of(&structure);
        for label in &sheet.labels {
            assert_eq!(label.leader, None, "{name}: {:?}", label.lines);
            for shape in &sheet.shapes {
                let line = if shape.width.is_some() { &shape.points[..] } else { &[] };
                for line in line.windows(2) {
                    let through = passes(label, [line[0], line[1]]);
                    assert!(!through, "{name}: {:?}", label.lines);
                }
            }
        }
    }
}

#[test]
fn no_two_springs_touch() {
    for (name, structure) in all() {
        let sheet = Sheet::of(&structure);
        let springs: Vec<&Vec<Point>> = sheet
            .shapes
            .iter()
            .filter(|shape| shape.width.is_some() && shape.colour == spring_colour())
            .map(|shape| &shape.points)
            .collect();
        assert!(springs.len() >= structure.links.len() / 2, "{name}");
        for (place, spring) in springs.iter().enumerate() {
            for other in &springs[..place] {
                for a in spring.windows(2) {
                    let near = other.windows(2).any(|b| apart([a[0], a[1]], [b[0], b[1]]) < 2.0);
                    assert!(!near, "{name}: {spring:?} {other:?}");
                }
            }
        }
    }
}

#[test]
fn masses_stand_along_the_directions_of_their_springs() {
    let eighths = [0.0, 1.0, 2.0, 4.0, -3.0].map(|turn| turn * FRAC_PI_4);
    // The nearest of the eight ways of the grid; an arrow tells what is turned by more than a little.
    for (direction, shown) in
        eighths.map(|turn| (turn, turn)).into_iter().chain([(-2.5, -0.75 * PI)])
    {
        let structure = Structure {
            masses: vec![mass("a", ""), mass("b", "")],
            links: vec![spring("k", "", [Some(0), Some(1)], direction)],
            ..Structure::default()
        };
        let way = unit(between(&structure, 0, 1));
        assert!(close(way, [shown.cos(), shown.sin()]), "{direction}: {way:?}");
        let labels = Sheet::of(&structure).labels;
        let link = labels.iter().find(|label| label.lines == ["k"]).unwrap();
        assert_eq!(link.acts.is_some(), direction != shown, "{direction}");
    }
    let chain = chain(12);
    for (place, [x, y]) in (0..).zip(places(&chain)) {
        assert!(close([x, y], [f64::from(place), 0.0]), "in a row: {place} at {x}, {y}");
    }
}

#[test]
fn what_rubs_is_below_what_it_hangs_on_though_springs_of_two_directions_join_them() {
    let ring = ring(5);
    let places = places(&ring);
    for module in 0..5 {
        assert!(close(sub(places[2 * module + 1], places[2 * module]), [0.0, -1.0]));
        assert!((places[2 * module][1] - places[0][1]).abs() < 1e-9, "one row");
    }
}

#[test]
fn pads_stand_on_the_sides_of_a_disc_that_they_rub_on() {
    let disc = disc();
    let [upper, lower] = [1, 2].map(|pad| between(&disc, 0, pad));
    assert!(upper[0].abs() < 1e-9 && upper[1] > 0.5, "{upper:?}");
    assert!(lower[0].abs() < 1e-9 && lower[1] < -0.5, "{lower:?}");
}

#[test]
fn a_ring_is_closed_by_links_that_name_their_other_end() {
    for (modules, closing) in [(2, 0), (3, 1), (12, 1)] {
        let ring = ring(modules);
        let runs = runs(&ring, &places(&ring));
        let (named, straight): (Vec<&Run>, Vec<&Run>) =
            runs.iter().partition(|run| matches!(run.end, End::Name(_)));
        assert_eq!(
            named.len(),
            2 * closing,
            "{modules} modules: one run from each of the two masses"
        );
        let mut links: Vec<usize> = straight.iter().flat_map(|run| run.links.clone()).collect();
        named.iter().step_by(2).for_each(|run| links.extend(&run.links));
        links.sort_unstable();
        assert!(links.into_iter().eq(0..ring.links.len()), "each link once");
    }
    let ring = ring(3);
    let texts: Vec<String> = Sheet::of(&ring).labels.iter().map(|l| l.lines.join(" ")).collect();
    assert!(texts.contains(&"to m1[1]".into()) && texts.contains(&"to m1[3]".into()), "{texts:?}");
}

#[test]
fn ground_lies_in_a_links_direction_unless_that_is_taken() {
    let ways = |structure: &Structure| -> Vec<Point> {
        let runs = runs(structure, &places(structure));
        runs.iter().filter(|run| run.end == End::Ground).map(|run| run.way).collect()
    };
    let (sin, cos) = (PI / 6.0).sin_cos();
    let found = ways(&oblique());
    assert!(close(found[0], [cos, sin]) && close(found[1], [-cos, sin]), "{found:?}");
    // To the left and below there are sliders.
    let mut corner = corner();
    corner.links.truncate(2);
    corner.links.iter_mut().for_each(|link| link.ends.reverse());
    let found = ways(&corner);
    assert!(close(found[0], [1.0, 0.0]) && close(found[1], [0.0, 1.0]), "{found:?}");
}

#[test]
fn an_arrow_tells_a_link_that_acts_in_another_direction_than_it_is_drawn() {
    let arrows = |ring: &Structure, name: &str| -> usize {
        let sheet = Sheet::of(ring);
        let labels = sheet.labels.iter().filter(|label| label.lines[0].starts_with(name));
        labels.filter(|label| label.acts.is_some()).count()
    };
    let ring = ring(2);
    assert_eq!(["k1", "k2", "k3", "k4", "k5", "k6"].map(|k| arrows(&ring, k)), [0, 2, 0, 0, 0, 2]);
}

#[test]
fn the_arrow_of_a_slider_shows_the_way_that_it_moves() {
    // Tip against foot of the one arrow head, px with y downwards.
    let head = |angle: f64, velocity: f64| -> Option<Point> {
        let structure = Structure {
            masses: vec![mass("m", "")],
            sliders: vec![slider("c", 0, None, angle, velocity)],
            ..Structure::default()
        };
        let shapes = Sheet::of(&structure).shapes;
        let is_head = |shape: &&Shape| shape.width.is_none() && shape.colour == slider_colour();
        shapes.iter().find(is_head).map(|head| sub(head.points[0], head.points[1]))
    };
    assert_eq!(head(0.0, 0.0), None);
    assert!(head(0.0, 0.1).unwrap()[0] > 5.0 && head(0.0, -0.1).unwrap()[0] < -5.0);
    assert!(head(FRAC_PI_2, 0.1).unwrap()[1] < -5.0, "upwards");
    assert!(head(PI, 0.1).unwrap()[0] < -5.0);
}

#[test]
fn values_that_have_no_room_are_listed_with_all_their_names() {
    let mut chain = chain(5);
    chain.links.clear();
    chain.masses[2].label = "2 kg".into();
    chain.sliders.truncate(2);
    assert_eq!(
        values(&chain),
        ["m1, m2, m4, m5: 0.5 kg", "m3: 2 kg", "c1, c2: µ = 0.4, v = 0.1 m/s"]
    );
    chain.masses[2].label = "0.5 kg".into();
    assert_eq!(values(&chain)[0], "m1 … m5: 0.5 kg");
    // Names without numbers are no range.
    for (mass, name) in chain.masses.iter_mut().zip(["a", "b", "c"]) {
        mass.name = name.into();
    }
    assert_eq!(values(&chain)[0], "a, b, c, m4, m5: 0.5 kg");
}

#[test]
fn words_say_what_is_joined() {
    let structure = disc();
    let text = Sheet::of(&structure).description();
    assert!(text.contains("mass pad a 0.2 kg, locked along its first axis"), "{text}");
    assert!(text.contains("spring ka 1 MN/m from pad a to ground at 90°"), "{text}");
    assert!(text.contains("contact lower") && text.contains("of pad b on disc at 180°"), "{text}");
}

/// Left, top, right and bottom of all that is written and drawn in a file, px, and the size of its picture.
fn boxes_of(svg: &str) -> (Vec<(String, [f64; 4])>, Point) {
    let value = |element: &str, key: &str| -> f64 {
        let found = element.split_once(&format!(" {key}=\"")).map(|(_, rest)| rest);
        found
            .and_then(|rest| rest.split_once('"'))
            .map_or(f64::NAN, |(text, _)| text.parse().unwrap())
    };
    let (_, view) = svg.split_once("viewBox=\"0 0 ").unwrap();
    let mut view =
        view.split_once('"').unwrap().0.split(' ').map(|text| text.parse::<f64>().unwrap());
    let size = [view.next().unwrap(), view.next().unwrap()];
    let mut found = Vec::new();
    for part in svg.split("<text ").skip(1) {
        let element = format!(" {part}");
        let (x, y) = (value(&element, "x"), value(&element, "y"));
        // The font's letters reach less than one of its sizes above and below the middle.
        let (wide, high) = (value(&element, "textLength"), value(&element, "font-size"));
        let left = match () {
            () if part.contains("text-anchor=\"middle\"") => x - 0.5 * wide,
            () if part.contains("text-anchor=\"end\"") => x - wide,
            () => x,
        };
        let text = part.split_once('>').unwrap().1.split_once('<').unwrap().0.trim().to_owned();
        found.push((text, [left, y - 0.7 * high, left + wide, y + 0.7 * high]));
    }
    (found, size)
}

fn assert_within(name: &str, structure: &Structure) {
    let (boxes, [wide, high]) = boxes_of(&structure.svg().unwrap());
    assert!(!boxes.is_empty(), "{name}");
    for (text, [left, top, right, bottom]) in boxes {
        let inside = left >= 0.0 && top >= 0.0 && right <= wide && bottom <= high;
        assert!(
            inside,
            "{name}: {text:?} at {left} … {right} of {wide}, {top} … {bottom} of {high}"
        );
    }
}

#[test]
fn all_text_of_all_scenes_is_within_the_picture() {
    for builtin in amontons::scene::BUILTIN {
        assert_within(builtin.name, &Structure::from(&builtin.scene()));
    }
    let effects = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/effects");
    for entry in std::fs::read_dir(effects).unwrap() {
        let path = entry.unwrap().path();
        let (scene, _) = amontons::scene::read(&path).unwrap();
        assert_within(&path.display().to_string(), &Structure::from(&scene));
    }
}

#[test]
fn all_text_is_within_the_picture_however_long_names_are() {
    for modules in 1..=12 {
        let mut ring = ring(modules);
        assert_within(&format!("{modules} modules"), &ring);
        let long = |name: &str| format!("{name}{}", "x".repeat(60 - name.len()));
        ring.title = long("title");
        for (place, mass) in ring.masses.iter_mut().enumerate() {
            mass.name = long(&format!("mass{place}"));
        }
        for (place, link) in ring.links.iter_mut().enumerate() {
            link.name = long(&format!("link{place}"));
        }
        for (place, slider) in ring.sliders.iter_mut().enumerate() {
            slider.name = long(&format!("contact{place}"));
        }
        ring.forces = (0..ring.masses.len())
            .map(|mass| ForceMark {
                name: long(&format!("force{mass}")),
                label: "2 kN ~ sine".into(),
                mass,
                angle: FRAC_PI_4,
            })
            .collect();
        assert_within(&format!("{modules} modules with long names"), &ring);
    }
}

#[test]
fn forces_and_preloads_are_arrows_that_point_as_they_push() {
    // Tip against foot of each head in the colour of forces, px with y downwards.
    let heads = |structure: &Structure| -> Vec<Point> {
        let shapes = Sheet::of(structure).shapes;
        let is_head = |shape: &&Shape| shape.width.is_none() && shape.colour == force_colour();
        let heads = shapes.iter().filter(is_head).map(|head| {
            let foot = [0, 1].map(|axis| 0.5 * (head.points[1][axis] + head.points[2][axis]));
            sub(head.points[0], foot)
        });
        heads.collect()
    };
    let force = |angle| ForceMark { name: "F".into(), mass: 0, angle, ..ForceMark::default() };
    let with = |angle: f64| Structure {
        masses: vec![mass("m", "")],
        forces: vec![force(angle)],
        ..Structure::default()
    };
    assert!(heads(&with(0.0))[0][0] > 5.0 && heads(&with(PI))[0][0] < -5.0);
    assert!(heads(&with(FRAC_PI_2))[0][1] < -5.0, "upwards");
    // A spring upwards to ground whose end is moved up pulls its mass up, whichever end is named first.
    for (ends, preload, up) in [
        ([Some(0), None], 1e-3, true),
        ([Some(0), None], -1e-3, false),
        ([None, Some(0)], 1e-3, false),
        ([None, Some(0)], -1e-3, true),
    ] {
        let structure = Structure {
            masses: vec![mass("m", "")],
            links: vec![Link { preload, ..spring("k", "", ends, FRAC_PI_2) }],
            ..Structure::default()
        };
        let found = heads(&structure);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0][1] < -5.0, up, "{ends:?} {preload}: {found:?}");
    }
}

#[test]
fn scenes_show_their_loads_preloads_and_signals() {
    let disc = Structure::from(&amontons::scene::builtin("disc_brake").unwrap().scene());
    let found: Vec<(usize, &str, f64)> =
        disc.forces.iter().map(|force| (force.mass, &*force.label, force.angle)).collect();
    assert_eq!(found, [(0, "2 kN", -FRAC_PI_2), (1, "2 kN", FRAC_PI_2)]);
    let ring = Structure::from(&amontons::scene::builtin("set1").unwrap().scene());
    let pushed: Vec<&Link> = ring.links.iter().filter(|link| link.preload != 0.0).collect();
    assert_eq!(pushed.len(), ring.sliders.len(), "each module has its own");
    assert!(pushed.iter().all(|link| link.preload < 0.0 && link.label.contains("preload")));
    let driven = Structure::from(&amontons::scene::builtin("den_hartog").unwrap().scene());
    assert!(driven.signals);
    let force = driven.forces.iter().find(|force| force.name == "mass.block.fx").unwrap();
    assert_eq!((&*force.label, force.angle), ("~ sine", 0.0));
}
