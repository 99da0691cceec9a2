//! A report with every kind of figure, from closed forms.

use amontons::contact::ContactState;
use amontons_pictures::picture::{
    Band, Bar, BarGroup, Bars, Chart, Class, Lane, LaneInterval, Link, LinkKind, Map, Mark, Marker,
    MassMark, Panel, Raster, Series, SliderMark, Structure, Style,
};
use amontons_pictures::report::{
    Answer, Cell, Claim, Content, Figure, Line, Page, Section, Table, Verdict,
};
use std::f64::consts::TAU;

/// A text that HTML would take for markup.
pub const HOSTILE: &str = "a < b & \"c\" 'd' </script><script>alert(1)</script> <!-- e";

fn curve(label: &str, colour: usize, points: impl Iterator<Item = [f64; 2]>) -> Series {
    Series { label: Some(label.into()), points: points.collect(), colour, ..Series::default() }
}

fn mark(x: f64, label: &str) -> Mark {
    Mark { x, label: Some(label.into()) }
}

fn grid(count: u32, [from, to]: [f64; 2]) -> impl Iterator<Item = f64> + Clone {
    (0..=count).map(move |i| from + (to - from) * f64::from(i) / f64::from(count))
}

fn figure(caption: &str, content: Content) -> Figure {
    Figure {
        caption: caption.into(),
        command: Some(
            "amontons study transient set1 --set friction.coefficient=1.96 -o figure4".into(),
        ),
        content,
    }
}

fn squares() -> Chart {
    let x = || grid(50, [0.0, 50.0]);
    Chart {
        title: "Squares, and a straight line".into(),
        x_label: "Number".into(),
        panels: vec![Panel {
            y_label: "Value".into(),
            series: vec![
                curve("square", 0, x().map(|x| [x, x * x])),
                Series { style: Style::Dashed, ..curve("line", 1, x().map(|x| [x, 20.0 * x])) },
            ],
            ..Panel::default()
        }],
        ..Chart::default()
    }
}

/// A curve with a gap and a point alone, all marked, over lanes of which one class is striped.
pub fn marked() -> Chart {
    let points = [0.0, 1.0, f64::NAN, 3.0, f64::NAN, 5.0, 6.0];
    let points = points.iter().zip(0..).map(|(y, x)| [f64::from(x), *y]);
    let series = vec![Series { marker: Some(Marker::Triangle), ..curve("found", 1, points) }];
    let lane = Lane {
        name: "contact".into(),
        stretches: vec![
            LaneInterval { from: 0.0, to: 4.0, class: 0 },
            LaneInterval { from: 4.0, to: 6.0, class: 1 },
        ],
    };
    let states = [
        Class::of_states(&[ContactState::Slide]),
        Class::of_states(&[ContactState::Slide, ContactState::Stick]),
    ];
    Chart {
        title: "Values that were found, with gaps".into(),
        x_label: "Number".into(),
        panels: vec![
            Panel { y_label: "Value".into(), series, ..Panel::default() },
            Panel {
                y_label: "States".into(),
                lanes: vec![lane],
                classes: states.into(),
                ..Panel::default()
            },
        ],
        ..Chart::default()
    }
}

/// Modes that coalesce in pairs: growth rates and frequencies.
fn loci() -> Chart {
    let pair = |mean: f64, apart: f64, critical: f64, mu: f64, sign: f64| {
        let split: f64 = 1.0 - mu / critical;
        let frequency = mean + sign * apart * split.max(0.0).sqrt();
        [-3.0 + sign * 12.0 * (-split).max(0.0).sqrt(), frequency]
    };
    let pairs = [(175.0, 11.0, 2.21), (219.0, 6.0, 1.37)];
    let curves = |part: usize| {
        let mut all = vec![
            curve("mode 1", 0, grid(350, [0.0, 3.5]).map(|mu| [mu, [-0.2, 34.0 + 5.0 * mu][part]])),
            curve("mode 2", 1, grid(350, [0.0, 3.5]).map(|mu| [mu, [-0.4, 66.0 - 0.5 * mu][part]])),
        ];
        for (i, (mean, apart, critical)) in pairs.into_iter().enumerate() {
            for (j, sign) in [(0, -1.0), (1, 1.0)] {
                let points = grid(350, [0.0, 3.5])
                    .map(|mu| [mu, pair(mean, apart, critical, mu, sign)[part]]);
                all.push(curve(&format!("mode {}", 3 + 2 * i + j), 2 + 2 * i + j, points));
            }
        }
        all
    };
    let marks = || vec![mark(1.37, "modes 5 and 6 coalesce"), mark(2.21, "modes 3 and 4 coalesce")];
    let unmarked = || marks().into_iter().map(|mark| Mark { label: None, ..mark }).collect();
    Chart {
        title: "Eigenvalues of Set 1 in uniform sliding".into(),
        x_label: "Friction coefficient µ [–]".into(),
        panels: vec![
            Panel {
                y_label: "Real part (growth rate) [1/s]".into(),
                series: curves(0),
                marks: marks(),
                zero_line: true,
                bands: vec![Band {
                    from: 1.37,
                    to: f64::INFINITY,
                    label: Some("unstable".into()),
                    colour: 1,
                }],
                ..Panel::default()
            },
            Panel {
                y_label: "Frequency [Hz]".into(),
                series: curves(1),
                marks: unmarked(),
                ..Panel::default()
            },
        ],
        ..Chart::default()
    }
}

fn envelope(t: f64) -> f64 {
    let first = 0.02 / (1.0 + (-(t - 0.8) / 0.08).exp());
    let second = 0.05 / (1.0 + (-(t - 2.4) / 0.2).exp());
    first + second
}

fn wave(t: f64) -> f64 {
    envelope(t) * ((TAU * 219.0 * t).sin() + 0.5 * (TAU * 168.0 * t).sin())
}

/// A velocity with 100,001 points, its spectrogram, and the states of two contacts.
fn transient() -> Chart {
    let level = |t: f64, f: f64| {
        let peak = |at: f64, size: f64| size * (-((f - at) / 4.0).powi(2)).exp();
        let first = peak(219.0, envelope(t).min(0.02) + 1e-4);
        let second = peak(168.0, (envelope(t) - 0.02).max(0.0) + 1e-5);
        20.0 * (first + second + 1e-6).log10()
    };
    let rows =
        grid(120, [100.0, 300.0]).map(|f| grid(400, [0.0, 5.0]).map(|t| level(t, f)).collect());
    let states = |phase: f64| {
        let mut stretches = vec![LaneInterval { from: 0.0, to: 0.8, class: 0 }];
        let mut t = 0.8;
        while t < 5.0 {
            let (slip, stick) = (0.004 + 0.001 * phase, if t > 2.4 { 0.0025 } else { 0.0008 });
            stretches.push(LaneInterval { from: t, to: t + slip, class: 0 });
            stretches.push(LaneInterval { from: t + slip, to: t + slip + stick, class: 1 });
            t += slip + stick;
        }
        stretches
    };
    let class = |name: &str, colour| Class::plain(name.into(), colour);
    Chart {
        title: "Response to a small perturbation, µ = 1.96".into(),
        x_label: "Time [s]".into(),
        panels: vec![
            Panel {
                y_label: "Velocity of m1 of module 1, ẋ1 [m/s]".into(),
                series: vec![curve("ẋ1", 0, grid(100_000, [0.0, 5.0]).map(|t| [t, wave(t)]))],
                marks: vec![mark(0.8, "first contact sticks"), mark(2.4, "second growth ends")],
                zero_line: true,
                ..Panel::default()
            },
            Panel {
                y_label: "Frequency [Hz]".into(),
                raster: Some(Raster {
                    x: [0.0, 5.0],
                    y: [100.0, 300.0],
                    rows: rows.collect(),
                    range: [-120.0, -25.0],
                    label: "Level of ẋ1 [dB re 1 m/s]".into(),
                }),
                ..Panel::default()
            },
            Panel {
                y_label: "State of each contact".into(),
                lanes: vec![
                    Lane { name: "contact 1".into(), stretches: states(0.0) },
                    Lane { name: "contact 2".into(), stretches: states(1.0) },
                ],
                classes: vec![class("sliding", 0), class("sticking", 1), class("detached", 2)],
                ..Panel::default()
            },
        ],
        ..Chart::default()
    }
}

fn limit_cycles() -> Chart {
    let cycle = |label: &str, colour, v: f64| {
        let orbit = grid(1500, [0.0, 3.0 * TAU]).map(move |angle| {
            [1e-4 * v * (1.4 * angle.sin() + 0.3 * (3.0 * angle).sin()), v * angle.cos().min(0.55)]
        });
        curve(label, colour, orbit)
    };
    Chart {
        title: "Limit cycles, µ = 1.5".into(),
        x_label: "Displacement x3 [m]".into(),
        panels: vec![Panel {
            y_label: "Velocity ẋ3 [m/s]".into(),
            series: vec![
                cycle("v = 0.05 m/s", 0, 0.09),
                cycle("v = 0.15 m/s", 1, 0.25),
                cycle("v = 0.25 m/s", 2, 0.42),
            ],
            ..Panel::default()
        }],
        ..Chart::default()
    }
}

/// Amplitudes for rising and falling µ; the falling branch is given backwards, as it is found.
fn continuation() -> Chart {
    let amplitude =
        |mu: f64, jump: f64| if mu < jump { 1e-7 } else { 2.4e-4 + 3e-4 * (mu - 1.6).sqrt() };
    let branch = |label: &str, colour, [from, to]: [f64; 2], jump: f64| {
        curve(label, colour, grid(100, [from, to]).map(move |mu| [mu, amplitude(mu, jump)]))
    };
    Chart {
        title: "Amplitude of the limit cycle, Set 2".into(),
        x_label: "Friction coefficient µ [–]".into(),
        panels: vec![Panel {
            y_label: "Amplitude of x1 [m]".into(),
            series: vec![
                branch("µ rises", 0, [1.5, 2.5], 2.21),
                Series { style: Style::Dots, ..branch("µ falls", 1, [2.5, 1.5], 1.72) },
            ],
            bands: vec![Band { from: 1.72, to: 2.21, label: Some("bistable".into()), colour: 4 }],
            ..Panel::default()
        }],
        ..Chart::default()
    }
}

fn accuracy() -> Chart {
    let method = |label: &str, colour, order: i32, size: f64| {
        let steps: Vec<f64> = (0..7).map(|i| 1e-6 * 2_f64.powi(i)).collect();
        Series {
            labels: steps.iter().map(|h| format!("{:.0} µs", 1e6 * h)).collect(),
            ..curve(
                label,
                colour,
                steps.into_iter().map(|h| [0.04 / h * 1e-4, size * (h * 1e5).powi(order)]),
            )
        }
    };
    Chart {
        title: "What accuracy costs".into(),
        x_label: "Computing time per second of motion [s]".into(),
        panels: vec![Panel {
            y_label: "Relative error [–]".into(),
            series: vec![
                method("forward increment", 0, 1, 1e-3),
                method("event-driven", 1, 2, 1e-6),
            ],
            ..Panel::default()
        }],
        logarithmic: true,
    }
}

fn basin() -> Map {
    let class = |x: f64, v: f64| {
        let r = (x * x + v * v).sqrt() + 0.1 * (5.0 * v.atan2(x)).sin();
        if r < 0.5 {
            0
        } else if r < 1.1 {
            1
        } else {
            2
        }
    };
    let rows = grid(80, [-1.0, 1.0]).map(|v| grid(120, [-1.5, 1.5]).map(|x| class(x, v)).collect());
    let named = |name: &str, colour| Class::plain(name.into(), colour);
    Map {
        title: "Where perturbations lead".into(),
        x_label: "Initial displacement x1 [mm]".into(),
        y_label: "Initial velocity ẋ1 [m/s]".into(),
        x: [-1.5, 1.5],
        y: [-1.0, 1.0],
        cells: rows.collect(),
        classes: vec![
            named("equilibrium", 2),
            named("limit cycle at 168 Hz", 1),
            named("limit cycle at 219 Hz", 0),
        ],
    }
}

fn states() -> Table {
    let cell = |values: &[&str]| Cell {
        lines: values
            .iter()
            .map(|value| Line { text: (*value).into(), emphasised: !value.starts_with('−') })
            .collect(),
    };
    let one = cell(&["−0.18 ± 43.52 i", "−1.70 ± 172.41 i", "2.68 ± 219.38 i"]);
    let two = cell(&["−0.28 ± 54.57 i", "1.74 ± 167.81 i", "1.00 ± 217.45 i"]);
    let row = |name: &str| vec![name.into(), one.clone(), two.clone(), two.clone(), one.clone()];
    Table {
        caption: "Eigenvalues [Hz] of the contact states of both modules, µ = 1.96; those that grow stand out".into(),
        head: ["Module 2", "sliding", "reverse sliding", "sticking", "detached"].map(String::from).into(),
        rows: vec![row("sliding"), row("sticking")],
    }
}

/// Four claims hold, of six.
fn answers() -> Vec<Answer> {
    vec![Answer {
        question: "Is it bi-stable?".into(),
        text: vec!["Between two values of µ it is.".into(), HOSTILE.into()],
        section: "Bistability (Figures 5 to 7)".into(),
    }]
}

/// Two masses on springs, one of which rubs.
fn structure() -> Structure {
    let mass =
        |name: &str| MassMark { name: name.into(), label: "0.3 kg".into(), ..MassMark::default() };
    Structure {
        title: "Two masses".into(),
        masses: vec![mass("pad"), mass("disc")],
        links: vec![Link {
            name: "k1".into(),
            label: "55 kN/m".into(),
            ends: [Some(0), None],
            direction: 0.0,
            kind: LinkKind::Spring,
            preload: 0.0,
        }],
        sliders: vec![SliderMark {
            name: "lining".into(),
            mass: 0,
            on: Some(1),
            ..SliderMark::default()
        }],
        ..Structure::default()
    }
}

fn bars() -> Bars {
    let bar = |label: &str, value| Bar { label: label.into(), value };
    let group = BarGroup {
        title: "Mode at 219.4 Hz".into(),
        axis: "Change of the growth rate for +1 % [1/s]".into(),
        bars: vec![bar("module[1].k5", 1.375), bar("module[1].m2", -0.75)],
    };
    Bars { title: "Most effective parameters".into(), groups: vec![group] }
}

pub fn page() -> Page {
    let claim = |paper: &str, found: &str, verdict| Claim {
        paper: paper.into(),
        found: found.into(),
        verdict,
    };
    let differs = |reason: Option<&str>| Verdict::Differs { reason: reason.map(String::from) };
    let text = "Friction makes modes coalesce; one of the two then grows. What follows is made up from closed forms, \
                with the sizes that real studies have.";
    let section = |heading: &str, claims, figures| Section {
        heading: heading.into(),
        text: vec![text.into()],
        claims,
        figures,
        ..Section::default()
    };
    Page {
        answers: answers(),
        title: "Bi-stable friction: figures and claims of a paper".into(),
        lead: vec!["A paper studies a ring of masses that slide in frictional contact. This page repeats its studies and says of each \
             of its statements what came out.".into()],
        sections: vec![
            section(
                "Eigenvalues over the friction coefficient (Figure 2)",
                vec![
                    claim("Two pairs of modes coalesce for µ up to 3.5: modes 3 and 4, and modes 5 and 6.",
                          "Modes 5 and 6 coalesce at µ = 1.37, modes 3 and 4 at µ = 2.21.", Verdict::Holds),
                    claim("The unstable modes are at about 170 Hz and 215 Hz.", "175.0 Hz and 219.0 Hz.",
                          differs(Some("the frequency at µ = 2 is given, not that at the onset"))),
                ],
                vec![
                    figure("Growth rates and frequencies of the six modes, and where two of them meet.", Content::Chart(loci())),
                    figure(HOSTILE, Content::Chart(squares())),
                ],
            ),
            section(
                "Limit cycles (Figures 3 and 4)",
                vec![
                    claim("Up to v = 0.1 m/s masses stick and slip and never detach.", "No detachment in 20 s.", Verdict::Holds),
                    claim("A second growth begins when a contact sticks.", "It begins 0.02 s after the first sticking.", Verdict::Holds),
                ],
                vec![
                    figure("The velocity grows twice; the spectrogram shows the second frequency from then on.", Content::Chart(transient())),
                    figure("Limit cycles for three velocities of the slider.", Content::Chart(limit_cycles())),
                    figure("What was not found is left open.", Content::Chart(marked())),
                ],
            ),
            Section {
                heading: "Structure and changes".into(),
                figures: vec![
                    figure("The parts.", Content::Structure(structure())),
                    figure("What each parameter changes.", Content::Bars(bars())),
                ],
                points: vec!["Small starts only.".into(), HOSTILE.into()],
                commands: vec!["amontons study loudness set1".into(), HOSTILE.into()],
                ..Section::default()
            },
            Section {
                tables: vec![states()],
                ..section(
                    "Bistability (Figures 5 to 7)",
                    vec![
                        claim("Between two values of µ both rest and a limit cycle are stable.", "From µ = 1.72 to 2.21.", Verdict::Holds),
                        claim(HOSTILE, "Nothing of the kind.", differs(None)),
                    ],
                    vec![
                        figure("The amplitude jumps at different values of µ when it rises and when it falls.", Content::Chart(continuation())),
                        figure("Which perturbations lead where.", Content::Map(basin())),
                        figure("Errors of two methods over what they cost, with their steps.", Content::Chart(accuracy())),
                    ],
                )
            },
        ],
        footer: "Made by Amontons.".into(),
    }
}
