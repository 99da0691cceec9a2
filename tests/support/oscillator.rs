//! A mass on two inclined springs, as a scene and written down by hand.

use amontons::model::LumpedModel;
use amontons::scene::parse;
use amontons::simulation::Simulation;
use std::array::from_fn;
use std::hint::black_box;

/// The scene: n = 2, K is full.
pub const SCENE: &str = r#"
[slider]
velocity = 0.1
angle = 0.0
[integrator]
step = 1e-5
[[mass]]
name = "m"
mass = 0.4
force = [0.0, -50.0]
[[spring]]
name = "a"
between = ["m", "ground"]
direction = 0.5
stiffness = 5e4
[[spring]]
name = "b"
between = ["m", "ground"]
direction = 2.2
stiffness = 3e4
[[initial]]
mass = "m"
vx = 1e-3
"#;

/// Takes steps of a scene; the displacements at the end.
pub fn simulated(text: &str, steps: u64) -> Vec<f64> {
    let scene = parse("counted", text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let step = scene.step;
    let mut simulation = Simulation::new(scene, 0.0).unwrap();
    simulation.advance_to(steps as f64 * step).unwrap();
    assert_eq!(simulation.statistics().steps, steps);
    simulation.displacement().to_vec()
}

/// ẋ ← ẋ + h M⁻¹ (F − K x), x ← x + h ẋ for [`SCENE`], from its equilibrium.
pub fn by_hand(steps: u64) -> [f64; 2] {
    let scene = parse("by hand", SCENE).unwrap();
    let model = LumpedModel::from(&scene);
    let stiffness: [[f64; 2]; 2] = from_fn(|i| from_fn(|j| model.stiffness.get(i, j)));
    let inverse_mass: [f64; 2] = from_fn(|i| 1.0 / model.mass.get(i, i));
    let (k, w, f, h) = black_box((stiffness, inverse_mass, [0.0; 2], scene.step));
    let (mut x, mut v) = black_box(([0.0; 2], [1e-3, 0.0]));
    for _ in 0..steps {
        let a = [
            (f[0] - (k[0][0] * x[0] + k[0][1] * x[1])) * w[0],
            (f[1] - (k[1][0] * x[0] + k[1][1] * x[1])) * w[1],
        ];
        for i in 0..2 {
            v[i] += h * a[i];
            x[i] += h * v[i];
        }
    }
    x
}
