//! The kinds of scene that every analysis is tried with.

/// A kind of scene.
pub struct Case {
    pub name: &'static str,
    pub file: String,
    /// Two friction coefficients that are looked at, and another parameter with two values.
    pub friction: [f64; 2],
    pub other: (&'static str, [f64; 2]),
    /// An initial value that is varied, another one, and how large they are.
    pub initial: [&'static str; 2],
    pub push: f64,
    /// Time for which the oracle runs until a motion has settled, and its step, s.
    pub time: f64,
    pub step: f64,
    /// Limit of the relative difference of amplitudes: the error of the oracle's step, more if a motion is irregular.
    pub near: f64,
}

/// A pad pressed on a belt by a holder, joined by two springs that are not at right angles.
const BRAKE: &str = r#"
[slider]
velocity = 0.2
angle = 0.0
[friction]
coefficient = 0.5
[damping]
alpha = 0.2
beta = 1e-4
[[mass]]
name = "holder"
mass = 1.0
force = [0.0, -20.0]
[[mass]]
name = "pad"
mass = 1.0
[[spring]]
name = "along"
between = ["holder", "ground"]
direction = "x"
stiffness = 800.0
[[spring]]
name = "up"
between = ["holder", "ground"]
direction = "y"
stiffness = 900.0
[[spring]]
name = "left"
between = ["pad", "holder"]
direction = 0.8
stiffness = 2000.0
[[spring]]
name = "right"
between = ["pad", "holder"]
direction = 2.0
stiffness = 2000.0
[[contact]]
name = "lining"
mass = "pad"
[[initial]]
mass = "pad"
vx = 1e-3
[integrator]
step = 1e-4
[experiment]
stop_time = 40.0
output_interval = 0.01
"#;

/// A second pad on the same belt, which the holder carries too.
const SECOND_PAD: &str = r#"
[[mass]]
name = "second"
mass = 1.5
[[spring]]
name = "far"
between = ["second", "holder"]
direction = 1.2
stiffness = 3000.0
[[spring]]
name = "near"
between = ["second", "holder"]
direction = 2.6
stiffness = 1500.0
[[contact]]
name = "second"
mass = "second"
"#;

/// Writes a scene with this number of the paper's modules.
fn ring(modules: usize) -> String {
    format!(
        "[slider]\nvelocity = 0.025\nangle = 0.5\n[friction]\ncoefficient = 1.5\n[damping]\nbeta = 3e-5\n\
         [ring]\nmodules = {modules}\nm1 = 0.3\nm2 = 0.7\nk1 = 55e3\nk2 = 60e3\nk3 = 22e3\nk4 = 60e3\n\
         k5 = 300e3\nk6 = 250e3\npreload = 5e-3\n[[initial]]\nmodule = 1\nv1 = 1e-3\n\
         [integrator]\nstep = 1e-6\n[experiment]\nstop_time = 4.0\noutput_interval = 2e-4\n"
    )
}

fn brake(name: &'static str, from: &str, to: &str) -> Case {
    assert!(BRAKE.contains(from), "{name}: {from}");
    Case {
        name,
        file: BRAKE.replacen(from, to, 1),
        friction: [0.25, 0.5],
        other: ("spring.along.stiffness", [600.0, 1000.0]),
        initial: ["initial.mass.pad.vx", "initial.mass.holder.vy"],
        push: 0.3,
        time: 60.0,
        step: 1e-4,
        near: 0.02,
    }
}

fn of_ring(name: &'static str, modules: usize, friction: [f64; 2], near: f64) -> Case {
    Case {
        file: ring(modules)
            .replace("coefficient = 1.5", &format!("coefficient = {:?}", friction[1])),
        friction,
        other: ("module[1].k2", [50e3, 70e3]),
        initial: ["initial.module[1].v1", "initial.module[1].v2"],
        push: 0.05,
        time: 4.0,
        step: 1e-5,
        near,
        ..brake(name, "", "")
    }
}

pub fn cases() -> Vec<Case> {
    let friction = "coefficient = 0.5";
    let effects = |lines: &str| format!("[effects]\n{lines}\n[slider]");
    let more = |parts: &str| format!("{parts}\n[integrator]");
    let turned = SECOND_PAD.replace("[[contact]]", "[[contact]]\nfriction = 0.7\nvelocity = -0.3");
    let twice = "[[contact]]\nname = \"twin\"\nmass = \"pad\"\n";
    let loops = "[[spring]]\nname = \"bridge\"\nbetween = [\"pad\", \"ground\"]\ndirection = 0.3\nstiffness = 300.0\n";
    let damper = "[[damper]]\nname = \"d\"\nbetween = [\"pad\", \"ground\"]\ndirection = \"x\"\ndamping = 1.0\n";
    let sine =
        "[[signal]]\ninput = \"slider.velocity\"\nsine = { amplitude = 0.02, frequency = 1.0 }\n";
    let force =
        "[[signal]]\ninput = \"mass.pad.fx\"\npulse = { value = 5.0, start = 0.5, end = 0.6 }\n";
    vec![
        brake("Coulomb's law", "", ""),
        brake("no friction", friction, "law = \"none\""),
        brake("static friction", friction, "coefficient = 0.5\nstatic = 0.7"),
        brake(
            "Stribeck's law",
            friction,
            "coefficient = 0.3\nstatic = 0.6\nstribeck_velocity = 0.2",
        ),
        brake("a contact with friction and velocity of its own", "[integrator]", &more(&turned)),
        Case {
            friction: [0.25, 0.4],
            ..brake("without sticking", "[slider]", &effects("sticking = false"))
        },
        brake("without detachment", "[slider]", &effects("detachment = false")),
        brake("without both", "[slider]", &effects("sticking = false\ndetachment = false")),
        brake("undamped", "alpha = 0.2\nbeta = 1e-4", "alpha = 0.0\nbeta = 0.0"),
        brake("a single damper", "[integrator]", &more(damper)),
        brake("a slider that stands still", "velocity = 0.2", "velocity = 0.0"),
        brake("a slider that moves back", "velocity = 0.2", "velocity = -0.2"),
        Case {
            // Below 0.4 some motions converge so slowly that a continuation takes many minutes.
            friction: [0.4, 0.5],
            ..brake("a signal on the slider", "[integrator]", &more(sine))
        },
        brake("a pulse of force", "[integrator]", &more(force)),
        brake("a network with a loop", "[integrator]", &more(loops)),
        brake("two pads", "[integrator]", &more(SECOND_PAD)),
        brake("two contacts that say the same", "[integrator]", &more(twice)),
        of_ring("a ring of 1 module", 1, [0.5, 1.5], 0.02),
        of_ring("a ring of 2 modules", 2, [0.5, 1.5], 0.02),
        of_ring("a ring of 8 modules", 8, [0.5, 1.0], 0.3),
        Case { time: 0.5, ..of_ring("a ring of 30 modules", 30, [0.5, 1.0], 0.3) },
    ]
}

/// Each law of friction, with and without a contact that has values of its own.
pub fn of_laws() -> Vec<Case> {
    let laws = [
        (
            ["Coulomb's law", "Coulomb's law and own values"],
            "coefficient = 0.5",
            "friction = 0.7\nvelocity = -0.3",
        ),
        (
            ["static friction", "static friction and own values"],
            "coefficient = 0.5\nstatic = 0.7",
            "friction = 0.4\nstatic_friction = 0.6\nvelocity = 0.3",
        ),
        (
            ["Stribeck's law", "Stribeck's law and own values"],
            "coefficient = 0.3\nstatic = 0.6\nstribeck_velocity = 0.2",
            "friction = 0.2\nstatic_friction = 0.5\nvelocity = 0.1",
        ),
    ];
    let mut all = Vec::new();
    for ([name, with_own], law, own) in laws {
        let pad = SECOND_PAD.replace("[[contact]]", &format!("[[contact]]\n{own}"));
        let common = brake(name, "coefficient = 0.5", law);
        let file = common.file.replace("[integrator]", &format!("{pad}\n[integrator]"));
        all.extend([common, Case { file, ..brake(with_own, "", "") }]);
    }
    all
}
