//! Structures of many kinds, for tests.

use super::{Link, LinkKind, MassMark, SliderMark, Structure};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_6, PI};

pub(super) fn mass(name: &str, label: &str) -> MassMark {
    MassMark { name: name.into(), label: label.into(), ..MassMark::default() }
}

pub(super) fn spring(name: &str, label: &str, ends: [Option<usize>; 2], direction: f64) -> Link {
    let (name, label) = (name.into(), label.into());
    Link { name, label, ends, direction, kind: LinkKind::Spring, preload: 0.0 }
}

pub(super) fn damper(name: &str, label: &str, ends: [Option<usize>; 2], direction: f64) -> Link {
    Link { kind: LinkKind::Damper, ..spring(name, label, ends, direction) }
}

pub(super) fn slider(
    name: &str,
    mass: usize,
    on: Option<usize>,
    angle: f64,
    velocity: f64,
) -> SliderMark {
    let label = format!("µ = 0.4, v = {velocity} m/s");
    SliderMark { name: name.into(), label, mass, on, angle, velocity }
}

/// The ring of the scenes.
pub(super) fn ring(modules: usize) -> Structure {
    let mut structure = Structure { title: format!("A ring of {modules}"), ..Structure::default() };
    for module in 0..modules {
        let number = module + 1;
        for (name, label) in [("m1", "0.3 kg"), ("m2", "0.7 kg")] {
            structure.masses.push(mass(&format!("{name}[{number}]"), label));
        }
        structure.masses[2 * module + 1].angle = 0.5;
        let (upper, lower) = (Some(2 * module), Some(2 * module + 1));
        let next = Some(2 * (number % modules));
        let slope = slider(&format!("c[{number}]"), 2 * module + 1, None, 0.5, 0.025);
        structure.sliders.push(slope);
        if modules > 1 {
            structure.links.push(spring("k1", "55 kN/m", [upper, next], 0.0));
            structure.links.push(spring("k2", "60 kN/m", [upper, next], FRAC_PI_2));
        }
        structure.links.extend([
            spring("k3", "22 kN/m", [upper, None], FRAC_PI_2),
            spring("k4", "60 kN/m", [upper, None], 0.0),
            spring("k5", "300 kN/m", [upper, lower], FRAC_PI_2),
            spring("k6", "250 kN/m", [upper, lower], 0.0),
        ]);
    }
    structure
}

pub(super) fn chain(count: usize) -> Structure {
    let masses = (1..=count).map(|number| mass(&format!("m{number}"), "0.5 kg"));
    let links = (0..count - 1).flat_map(|at| {
        let (ends, number) = ([Some(at), Some(at + 1)], at + 1);
        [
            spring(&format!("k{number}"), "20 kN/m", ends, 0.0),
            damper(&format!("d{number}"), "5 N s/m", ends, 0.0),
        ]
    });
    Structure {
        title: format!("A chain of {count} modules"),
        masses: masses.collect(),
        links: [spring("k0", "20 kN/m", [None, Some(0)], 0.0)].into_iter().chain(links).collect(),
        sliders: (0..count).map(|at| slider(&format!("c{}", at + 1), at, None, 0.0, 0.1)).collect(),
        ..Structure::default()
    }
}

pub(super) fn belt() -> Structure {
    Structure {
        title: "A mass on a belt".into(),
        masses: vec![mass("block", "0.3 kg")],
        links: vec![
            spring("k1", "55 kN/m", [None, Some(0)], 0.0),
            damper("d1", "2 N s/m", [None, Some(0)], 0.0),
            spring("k2", "22 kN/m", [Some(0), None], FRAC_PI_2),
        ],
        sliders: vec![slider("c1", 0, None, 0.0, 0.1)],
        ..Structure::default()
    }
}

pub(super) fn disc() -> Structure {
    let pad = |name| MassMark { locked: [true, false], ..mass(name, "0.2 kg") };
    Structure {
        title: "Two pads on both sides of a disc".into(),
        masses: vec![mass("disc", "3 kg"), pad("pad a"), pad("pad b")],
        links: vec![
            spring("ka", "1 MN/m", [Some(1), None], FRAC_PI_2),
            spring("kb", "1 MN/m", [Some(2), None], FRAC_PI_2),
            spring("kd", "40 kN/m", [None, Some(0)], 0.0),
            damper("dd", "3 N s/m", [None, Some(0)], 0.0),
            spring("kv", "700 kN/m", [Some(0), None], FRAC_PI_2),
        ],
        sliders: vec![slider("upper", 1, Some(0), 0.0, -0.5), slider("lower", 2, Some(0), PI, 0.5)],
        ..Structure::default()
    }
}

pub(super) fn corner() -> Structure {
    Structure {
        title: "A mass in a corner".into(),
        masses: vec![mass("m", "0.7 kg")],
        links: vec![
            spring("k1", "55 kN/m", [Some(0), None], 0.0),
            spring("k2", "60 kN/m", [Some(0), None], FRAC_PI_2),
            spring("k3", "10 kN/m", [Some(0), None], 0.25 * PI),
        ],
        sliders: vec![slider("floor", 0, None, 0.0, 0.1), slider("wall", 0, None, -FRAC_PI_2, 0.0)],
        ..Structure::default()
    }
}

pub(super) fn oblique() -> Structure {
    Structure {
        title: "A mass that two oblique springs press on a belt".into(),
        masses: vec![mass("m", "1 kg")],
        links: vec![
            spring("k1", "12 kN/m", [Some(0), None], FRAC_PI_6),
            spring("k2", "12 kN/m", [Some(0), None], 5.0 * FRAC_PI_6),
        ],
        sliders: vec![slider("c", 0, None, 0.0, -1.5)],
        ..Structure::default()
    }
}

/// A frame with a brace, a part of its own, and masses that are guided.
pub(super) fn mixed() -> Structure {
    let guided = |name: &str, angle, locked| MassMark { angle, locked, ..mass(name, "2 kg") };
    Structure {
        title: "A braced frame and a guided pair".into(),
        masses: vec![
            mass("a", "1 kg"),
            mass("b", "1 kg"),
            mass("c", "1 kg"),
            mass("d", "1 kg"),
            guided("caliper bracket", 0.0, [false, true]),
            guided("pin", 0.4, [true, true]),
        ],
        links: vec![
            spring("ab", "5 kN/m", [Some(0), Some(1)], 0.0),
            spring("ac", "5 kN/m", [Some(0), Some(2)], FRAC_PI_2),
            spring("cd", "5 kN/m", [Some(2), Some(3)], 0.0),
            spring("bd", "5 kN/m", [Some(1), Some(3)], FRAC_PI_2),
            spring("brace", "9 kN/m", [Some(0), Some(3)], 0.25 * PI),
            spring("foot", "80 kN/m", [Some(0), None], -FRAC_PI_2),
            spring("foot", "80 kN/m", [Some(1), None], -FRAC_PI_2),
            spring("arm", "2 kN/m", [Some(4), Some(5)], FRAC_PI_6),
            damper("arm damper", "1 N s/m", [Some(4), Some(5)], FRAC_PI_6),
            spring("stop", "3 kN/m", [Some(4), None], PI),
        ],
        sliders: vec![],
        ..Structure::default()
    }
}

/// A star, a triangle and a tower in one picture, with names of many lengths.
pub(super) fn crowd() -> Structure {
    let mut structure = Structure { title: "A star of eight, a triangle and a tower: what a structure may be that nobody has drawn before".into(), ..Structure::default() };
    structure.masses.push(mass("hub", "4 kg"));
    for arm in 0..8 {
        structure.masses.push(mass(&format!("arm {arm}"), "0.5 kg"));
        let direction = f64::from(arm) * 0.25 * PI;
        let ends = [Some(0), Some(usize::try_from(arm).unwrap() + 1)];
        structure.links.push(spring(&format!("ka{arm}"), "3 kN/m", ends, direction));
    }
    for (at, name) in ["p", "q", "r"].into_iter().enumerate() {
        structure.masses.push(mass(name, ""));
        let ends = [Some(9 + at), Some(9 + (at + 1) % 3)];
        structure.links.push(spring(
            &format!("t{name}"),
            "",
            ends,
            2.0 / 3.0 * PI * [0.0, 1.0, 2.0][at],
        ));
    }
    for floor in 0..4 {
        structure.masses.push(mass(&format!("floor {floor}"), "10 t"));
        let below = if floor == 0 { None } else { Some(11 + floor) };
        structure.links.push(spring(
            &format!("column {floor}"),
            "1 MN/m",
            [below, Some(12 + floor)],
            FRAC_PI_2,
        ));
        structure.links.push(damper(
            &format!("shear {floor}"),
            "1 kN s/m",
            [below, Some(12 + floor)],
            0.0,
        ));
    }
    structure
}

/// One mass with ground all around, and another that it cannot be joined to straight.
pub(super) fn spider() -> Structure {
    let mut structure = Structure { title: "Ground all around".into(), ..Structure::default() };
    structure.masses.push(mass("body", "4 kg"));
    for leg in 0..10 {
        let direction = f64::from(leg) * 0.1 * PI;
        structure.links.push(spring(&format!("leg {leg}"), "3 kN/m", [Some(0), None], direction));
    }
    structure
}

pub(super) fn grid() -> Structure {
    let mut structure = Structure { title: "Forty masses".into(), ..Structure::default() };
    for at in 0..40 {
        structure.masses.push(mass(&format!("m{at}"), "1 kg"));
        if at % 8 > 0 {
            structure.links.push(spring(
                &format!("h{at}"),
                "1 kN/m",
                [Some(at - 1), Some(at)],
                0.0,
            ));
        }
        if at >= 8 {
            structure.links.push(spring(
                &format!("v{at}"),
                "1 kN/m",
                [Some(at - 8), Some(at)],
                FRAC_PI_2,
            ));
        }
    }
    structure
}

/// A mass with springs along six ways: two to other masses, and four to ground.
pub(super) fn six_springs() -> Structure {
    let name = |number: usize| format!("k{number}");
    let ends = [Some(1), Some(2), None, None, None, None];
    let springs = (1..=6).zip(ends).map(|(number, end)| {
        let direction = [0.0, PI, FRAC_PI_2, -FRAC_PI_2, 0.25 * PI, 0.75 * PI][number - 1];
        spring(&name(number), "20 kN/m", [Some(0), end], direction)
    });
    Structure {
        title: "Six springs at one mass".into(),
        masses: vec![mass("m", "0.5 kg"), mass("right", "1 kg"), mass("left", "1 kg")],
        links: springs.collect(),
        ..Structure::default()
    }
}

/// Rows of masses, each joined to its neighbours by a spring and a damper, the lowest ones on sliders.
pub(super) fn small_grid(rows: usize, columns: usize) -> Structure {
    let mut structure =
        Structure { title: format!("A grid of {rows} × {columns}"), ..Structure::default() };
    for at in 0..rows * columns {
        structure.masses.push(mass(&format!("m{at}"), "1 kg"));
        let mut join = |other: usize, name: &str, direction: f64| {
            let ends = [Some(other), Some(at)];
            structure.links.push(spring(&format!("k{name}{at}"), "1 kN/m", ends, direction));
            structure.links.push(damper(&format!("d{name}{at}"), "5 N s/m", ends, direction));
        };
        if at % columns > 0 {
            join(at - 1, "h", 0.0);
        }
        if at >= columns {
            join(at - columns, "v", -FRAC_PI_2);
        }
        if at / columns + 1 == rows {
            structure.sliders.push(slider(&format!("c{at}"), at, None, 0.0, 0.1));
        }
    }
    structure
}

/// Masses on surfaces and on each other, as chance has it: a spring to ground presses each on what it rubs on, and
/// others join it to ground or to another mass.
pub(super) fn random(seed: u64, count: usize) -> Structure {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    // Random numbers of xorshift, from 0 to below the limit.
    let mut below = move |limit: usize| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        usize::try_from(state >> 33).unwrap() % limit
    };
    let angle = |step: usize| PI / 12.0 * f64::from(u8::try_from(step).unwrap());
    let mut structure =
        Structure { title: format!("Random network {seed}"), ..Structure::default() };
    for at in 0..count {
        let leaning = [0.0, angle(below(6)) - 0.6][below(2)];
        let locked = [below(8) == 0, false];
        structure.masses.push(MassMark {
            angle: leaning,
            locked,
            ..mass(&format!("m{at}"), "2.5 kg")
        });
        let on = if at > 0 && below(3) == 0 { Some(below(at)) } else { None };
        structure.sliders.push(slider(&format!("c{at}"), at, on, leaning, 0.5));
        let up = leaning + FRAC_PI_2;
        structure.links.push(spring(&format!("n{at}"), "40 kN/m", [Some(at), None], up));
        for number in 0..1 + below(2) {
            let end = if at > 0 && below(4) > 0 { Some(below(at)) } else { None };
            let name = format!("h{at}_{number}");
            structure.links.push(spring(&name, "12 kN/m", [Some(at), end], angle(below(24))));
            if below(3) == 0 {
                let name = format!("d{at}_{number}");
                structure.links.push(damper(&name, "3 N s/m", [Some(at), end], angle(below(24))));
            }
        }
    }
    structure
}

/// All, with short names.
pub(super) fn all() -> Vec<(&'static str, Structure)> {
    vec![
        ("ring1", ring(1)),
        ("ring2", ring(2)),
        ("ring3", ring(3)),
        ("ring5", ring(5)),
        ("ring12", ring(12)),
        ("chain3", chain(3)),
        ("chain12", chain(12)),
        ("belt", belt()),
        ("disc", disc()),
        ("corner", corner()),
        ("oblique", oblique()),
        ("mixed", mixed()),
        ("crowd", crowd()),
        ("spider", spider()),
        ("grid", grid()),
        ("six_springs", six_springs()),
        ("grid2x4", small_grid(2, 4)),
    ]
}
