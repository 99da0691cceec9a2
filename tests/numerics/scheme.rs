//! The integrator against the paper's equations, written down once more without regard to speed.
//!
//! The implementation here shares nothing with the library's: its matrices are written out from
//! the wiring, it works in total displacements with x_n and x_{n−1}, and its Gauss–Seidel is
//! eqs. (19)–(24) as printed.

use amontons::scene::{Scene, builtin};
use amontons::simulation::{Simulation, Variable, variables};

/// M, C, K, F of a ring of n modules, dense, by rows.
struct Written {
    dofs: usize,
    mass: Vec<f64>,
    damping: Vec<Vec<f64>>,
    stiffness: Vec<Vec<f64>>,
    load: Vec<f64>,
}

impl Written {
    fn new(scene: &Scene) -> Self {
        let n = scene.modules().len();
        let dofs = 4 * n;
        let (s, c) = scene.slider.angle.sin_cos();
        let mut k = vec![vec![0.0; dofs]; dofs];
        let (mut mass, mut load) = (vec![0.0; dofs], vec![0.0; dofs]);
        for (i, module) in scene.modules().iter().enumerate() {
            let [k1, k2, k3, k4, k5, k6] = module.stiffness;
            let at = |j: usize| 4 * i + j;
            let next = 4 * ((i + 1) % n);
            for (j, link) in [k1, k2].into_iter().enumerate() {
                if n > 1 {
                    k[at(j)][at(j)] += link;
                    k[next + j][next + j] += link;
                    k[at(j)][next + j] -= link;
                    k[next + j][at(j)] -= link;
                }
            }
            // Elastic energy ½ k4 x1² + ½ k3 x2² + ½ k6 (x1 − c x3 + s x4)² + ½ k5 (x2 − s x3 − c x4)².
            #[rustfmt::skip]
            let own = [
                [k4 + k6, 0.0,     -k6 * c,                   k6 * s],
                [0.0,     k3 + k5, -k5 * s,                  -k5 * c],
                [-k6 * c, -k5 * s, k6 * c * c + k5 * s * s,  (k5 - k6) * s * c],
                [k6 * s,  -k5 * c, (k5 - k6) * s * c,        k6 * s * s + k5 * c * c],
            ];
            for (row, values) in own.iter().enumerate() {
                for (column, value) in values.iter().enumerate() {
                    k[at(row)][at(column)] += value;
                }
            }
            let [m1, m2] = module.mass;
            mass[at(0)..=at(3)].copy_from_slice(&[m1, m1, m2, m2]);
            load[at(1)] = -k3 * module.preload;
        }
        let mut damping = k.clone();
        for (i, row) in damping.iter_mut().enumerate() {
            row.iter_mut().for_each(|value| *value *= scene.damping.beta);
            row[i] += scene.damping.alpha * mass[i];
        }
        Self { dofs, mass, damping, stiffness: k, load }
    }

    /// One step, eqs. (13)–(24): from x_{n−1} and x_n to x_{n+1}. Contact forces are Fc = −Gᵀ λ.
    fn step(&self, before: &[f64], now: &[f64], scene: &Scene) -> Vec<f64> {
        let h = scene.step;
        let mut x: Vec<f64> = (0..self.dofs)
            .map(|i| {
                let dot = |row: &[f64], f: &dyn Fn(usize) -> f64| -> f64 {
                    row.iter().enumerate().map(|(j, value)| value * f(j)).sum()
                };
                let damping = dot(&self.damping[i], &|j| (now[j] - before[j]) / h);
                let springs = dot(&self.stiffness[i], &|j| now[j]);
                h * h * (self.load[i] - damping - springs) / self.mass[i] + 2.0 * now[i] - before[i]
            })
            .collect();
        for contact in 0..self.dofs / 4 {
            let (tangent, normal) = (4 * contact + 2, 4 * contact + 3);
            let (mut normal_lambda, mut tangent_lambda) = (0.0_f64, 0.0_f64);
            for sweep in 0.. {
                assert!(sweep < 100, "Gauss–Seidel does not converge");
                let penetration = x[normal];
                let new = (normal_lambda + penetration * self.mass[normal] / (h * h)).min(0.0);
                let normal_change = new - normal_lambda;
                normal_lambda = new;
                x[normal] -= h * h / self.mass[normal] * normal_change;

                let slip = x[tangent] - (now[tangent] + scene.slider.velocity * h);
                let limit = -scene.friction_coefficient * normal_lambda;
                let wanted = tangent_lambda + slip * self.mass[tangent] / (h * h);
                let new = wanted.clamp(-limit, limit);
                let tangent_change = new - tangent_lambda;
                tangent_lambda = new;
                x[tangent] -= h * h / self.mass[tangent] * tangent_change;

                let change = normal_change.abs().max(tangent_change.abs());
                if change <= 1e-9 * normal_lambda.abs().max(tangent_lambda.abs()) {
                    break;
                }
            }
        }
        x
    }
}

/// Displacements after `steps` steps, from the equilibrium, by the equations as printed.
fn by_the_book(scene: &Scene, equilibrium: &[f64], steps: usize) -> Vec<f64> {
    let written = Written::new(scene);
    let initial = scene.modules().iter().flat_map(|module| module.displacement);
    let velocity = scene.modules().iter().flat_map(|module| module.velocity);
    let mut now: Vec<f64> = equilibrium.iter().zip(initial).map(|(a, b)| a + b).collect();
    let mut before: Vec<f64> = now.iter().zip(velocity).map(|(x, v)| x - scene.step * v).collect();
    for _ in 0..steps {
        let next = written.step(&before, &now, scene);
        before = std::mem::replace(&mut now, next);
    }
    now.iter().zip(equilibrium).map(|(x, start)| x - start).collect()
}

fn displacements(simulation: &mut Simulation) -> Vec<f64> {
    let is_displacement = |v: &Variable| {
        let (_, last) = v.name.rsplit_once('.').unwrap();
        v.name.starts_with("module") && last.starts_with('x')
    };
    let variables = variables(simulation.scene());
    let wanted = variables.iter().filter(|variable| is_displacement(variable));
    wanted.map(|variable| simulation.read(variable).unwrap()).collect()
}

fn assert_same_path(scene: &Scene, steps: u32, changes: u64, touch_downs: u64) {
    let end = f64::from(steps) * scene.step;
    let mut simulation = Simulation::new(scene.clone(), 0.0).unwrap();
    simulation.advance_to(end).unwrap();
    let found = displacements(&mut simulation);
    let expected = by_the_book(scene, &simulation.reference().displacement, steps as usize);
    let statistics = simulation.statistics();
    assert!(statistics.state_changes() >= changes, "{statistics:?}");
    assert!(statistics.touch_downs >= touch_downs, "{statistics:?}");
    assert_eq!((statistics.steps, statistics.most_sweeps), (u64::from(steps), 1));
    let largest = expected.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    // Differences x_n − x_{n−1} of displacements near 10 mm lose 1e-18 m a step, in a random walk.
    let rounding = 1e-18 * f64::from(steps).sqrt() * f64::from(steps);
    for (a, b) in found.iter().zip(&expected) {
        assert!((a - b).abs() < rounding, "{found:?}\n{expected:?}");
    }
    assert!(rounding < 1e-6 * largest, "the comparison would prove nothing");
}

fn set1(step: f64) -> Scene {
    let mut scene = builtin("set1").unwrap().scene();
    scene.step = step;
    scene.modules_mut()[0].velocity[0] = 0.3;
    scene
}

#[test]
fn stick_and_slip_of_set_1_follow_the_equations_as_printed() {
    assert_same_path(&set1(1e-5), 5_000, 20, 0);
}

#[test]
fn detachment_and_touch_down_follow_the_equations_as_printed() {
    let mut scene = set1(1e-5);
    scene.modules_mut()[1].velocity[3] = 0.4;
    scene.modules_mut()[0].displacement[3] = 1e-4;
    assert_same_path(&scene, 5_000, 20, 2);
}

#[test]
fn a_ring_of_three_different_modules_follows_the_equations_as_printed() {
    let mut scene = set1(1e-5);
    scene.modules_mut().extend_from_within(..1);
    scene.damping.alpha = 2.0;
    scene.modules_mut()[1].stiffness = [40e3, 70e3, 30e3, 50e3, 280e3, 260e3];
    scene.modules_mut()[2].mass = [0.4, 0.5];
    scene.modules_mut()[2].preload = 7e-3;
    scene.modules_mut()[2].velocity[2] = -0.3;
    assert_same_path(&scene, 5_000, 20, 0);
}

#[test]
fn a_slider_that_moves_backwards_turns_everything_round() {
    let mut scene = set1(1e-5);
    scene.slider.velocity = -0.025;
    scene.friction_coefficient = 0.4;
    scene.modules_mut()[0].velocity[2] = 0.2;
    assert_same_path(&scene, 5_000, 4, 0);
}
