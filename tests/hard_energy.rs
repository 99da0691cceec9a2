//! Hard cases of energy: what is kept without damping, where work goes, what stiff springs beside soft ones
//! do, and the critical step; with the law of contact judged after every step.
#![cfg(feature = "tools")]

mod judge;

use amontons::contact::ContactForce;
use amontons::contact::ContactState::{self, Detached, Stick};
use amontons::model::LumpedModel;
use amontons::scene::{Method, Module, Scene, builtin, parse};
use amontons::simulation::Simulation;
use amontons::stability::critical_step;
use judge::blocks::{OMEGA, block, pads, start};
use judge::{Acting, METHODS, Run, assert_near, off, scene};
use nalgebra::{DMatrix, DVector, SymmetricEigen};

#[test]
fn a_block_that_slides_at_99_hundredths_of_the_critical_step_stays_bounded_and_at_101_is_refused() {
    let far = 1e-3;
    for (alpha, beta) in [(0.0, 0.0), (1.5, 0.02)] {
        let ratio = 0.5 * (alpha / OMEGA + beta * OMEGA);
        let critical = 2.0 / OMEGA * (ratio.hypot(1.0) - ratio);
        let text = |part: f64| {
            let more = format!(
                "[damping]\nalpha = {alpha:?}\nbeta = {beta:?}\n{}",
                start(&format!("x = {far:?}"))
            );
            block(0.4, 1.0, part * critical, &more)
        };
        let Err(error) = Simulation::new(parse("above", &text(1.01)).unwrap(), 0.0) else {
            panic!("taken")
        };
        assert!(error.is_step_too_large(), "{error}");
        let mut run = Run::new(parse("below", &text(0.99)).unwrap(), Method::ForwardIncrement);
        let mut largest = 0.0_f64;
        for _ in 0..20_000 {
            run.step();
            run.judge_step();
            largest = largest.max(run.of_dof("mass.block.x")[0].abs());
        }
        if ratio == 0.0 {
            // The widest point of the ellipse, seven times as far.
            let widest = far / (1.0 - (0.5 * OMEGA * run.h()).powi(2)).sqrt();
            assert!(largest <= widest * (1.0 + 1e-9), "{largest} {widest}");
            assert!(largest > 0.99 * widest, "the bound proves nothing: {largest} {widest}");
        } else {
            // Its roots are inside the unit circle: it decays.
            assert!(largest < 10.0 * far && run.of_dof("mass.block.x")[0].abs() < 1e-9);
        }
        assert_eq!(run.simulation.statistics().state_changes, 0);
    }
}

#[test]
fn without_damping_the_scheme_keeps_its_own_energy_but_for_slip_and_impact() {
    // U − ½ h ẋ·∇U in place of U; what contact forces f add in a step is ½ h f·(ẋ + ẋ'). At rest the
    // slider does no work, so slip and impact only take.
    let text =
        pads(2, 0.0, 1e-5).replace("velocity = 0.2", "velocity = 0.0").replace("beta = 1e-5", "");
    let mut run = Run::new(parse("undamped", &text).unwrap(), Method::ForwardIncrement);
    let load = DVector::from_column_slice(&run.model.load);
    let energy = |run: &Run| {
        let gradient = &run.stiffness * run.total(&run.now[0]) - &load;
        run.energy() - load.dot(&run.total(&run.now[0])) - 0.5 * run.h() * run.now[1].dot(&gradient)
    };
    let first = energy(&run);
    let [mut last, mut old] = [(); 2].map(|()| (first, run.states()));
    let (mut quiet, mut slips, mut landed) = (0, 0, false);
    for _ in 0..40_000 {
        run.step();
        last = (energy(&run), run.states());
        let forces = run.judge_step().unwrap();
        let is_quiet = |state: &ContactState| matches!(state, Stick | Detached);
        // A landing takes two steps, of which the first leads to the slider.
        let lands = std::mem::replace(&mut landed, run.has_landed()) || landed;
        if last.1 == old.1 && last.1.iter().all(is_quiet) && !lands {
            quiet += 1;
            // Rounding of the elastic energy of the load.
            assert!((last.0 - old.0).abs() < 1e-14, "{} {}", last.0, old.0);
        } else {
            slips += 1;
            // In the step in which a slip turns round friction acts for a part of it along the old
            // velocity, which it stops within the step.
            let turned: f64 = forces
                .iter()
                .zip(&run.model.contacts)
                .map(|(force, contact)| {
                    let [old, new] =
                        [&run.before, &run.now].map(|m| contact.tangent.dot(m[1].as_slice()));
                    if old * new < 0.0 { 0.5 * run.h() * force[1].abs() * old.abs() } else { 0.0 }
                })
                .sum();
            assert!(last.0 <= old.0 + turned + 1e-14, "{} {} at {}", last.0, old.0, run.time());
        }
        old = last.clone();
    }
    assert!(quiet > 1000 && slips > 1000, "{quiet} {slips}");
    assert!(last.0 < first - 0.01, "{} {first}", last.0);
}

#[test]
fn masses_and_springs_a_million_times_apart_move_as_their_modes() {
    // A slow mass of 1 kg on 1 N/m drags a fast one by a stiff spring over a slider; both slide, so
    // friction is constant and the motion that of two modes.
    let pairs: [(f64, f64, f64); 4] =
        [(1.0, 1e6, 1e-4), (1e-3, 1e3, 2e-4), (1e-6, 1e-3, 1e-3), (1e-6, 1.0, 1e-4)];
    for (mass, stiffness, h) in pairs {
        let text = format!(
            "[slider]\nvelocity = 100.0\nangle = 0.0\n[friction]\ncoefficient = 0.5\n\
             [integrator]\nstep = {h:?}\n\
             [[mass]]\nname = \"slow\"\nmass = 1.0\nforce = [0.0, -1.0]\n\
             [[mass]]\nname = \"fast\"\nmass = {mass:?}\nforce = [0.0, {:?}]\n\
             [[spring]]\nname = \"soft\"\nbetween = [\"slow\", \"ground\"]\ndirection = \"x\"\n\
             stiffness = 1.0\n[[spring]]\nname = \"stiff\"\nbetween = [\"slow\", \"fast\"]\n\
             direction = \"x\"\nstiffness = {stiffness:?}\n\
             [[contact]]\nname = \"a\"\nmass = \"slow\"\n[[contact]]\nname = \"b\"\nmass = \"fast\"\n\
             [[initial]]\nmass = \"slow\"\nx = 0.1\n[[initial]]\nmass = \"fast\"\nx = 0.1\n",
            -mass
        );
        for method in METHODS {
            let mut run = Run::new(scene(&text), method);
            // M^-½ K M^-½ = Q Ω² Qᵀ.
            let root = [1.0, mass.sqrt()];
            let k = [[1.0 + stiffness, -stiffness], [-stiffness, stiffness]];
            let scaled = DMatrix::from_fn(2, 2, |i, j| k[i][j] / (root[i] * root[j]));
            let modes = SymmetricEigen::new(scaled);
            let fastest = modes.eigenvalues.amax().sqrt();
            if method == Method::ForwardIncrement {
                let critical = critical_step(&run.model, 0.5).unwrap().step;
                assert_near(critical * fastest, 2.0, 1e-6);
            }
            run.judged_until(1000.0 * h);
            run.jump((2.0 / h) as u64 - run.steps);
            run.judged_until(run.time() + 1000.0 * h);
            let time = run.time();
            let start = DVector::from_fn(2, |i, _| 0.1 * root[i]);
            let amplitudes = modes.eigenvectors.transpose() * start;
            let (mut slow, mut first) = (0.0, 0.0);
            for (i, amplitude) in amplitudes.iter().enumerate() {
                let omega = modes.eigenvalues[i].max(0.0).sqrt();
                let part: f64 = modes.eigenvectors[(0, i)] * amplitude;
                slow += part * (omega * time).cos();
                // Half a step of phase, and the frequency of the scheme, (ωh)²/24 too high.
                let phase = omega * h + (omega * h).powi(2) / 12.0 * omega * time;
                first += part.abs() * phase.min(2.0);
            }
            // What rounding of λ leaves of a mode whose frequency is a thousandth of the largest.
            let [x, _] = run.of_dof("mass.slow.x");
            assert_near(x, slow, off(method, first, 0.0) + 1e-9);
            assert_eq!(run.simulation.statistics().state_changes, 0);
        }
    }
}

/// Where the energy of a run went, J. Quadratures are of what is reported at both ends of a step, and
/// impacts follow their law from the velocities before them: nothing here is what the masses got.
#[derive(Clone, Copy, Debug, Default)]
struct Work {
    slider: f64,
    damping: f64,
    friction: f64,
    impact: f64,
}

impl Work {
    /// What an impact takes from a contact that lands on the slider alone: perfectly inelastic, with
    /// friction as long as it lasts.
    fn add_landing(&mut self, run: &Run, contact: usize, before: &DVector<f64>, acting: &Acting) {
        let place = &run.model.contacts[contact];
        let dof = place.normal.as_unit().unwrap();
        let mass = run.model.mass.get(dof, dof);
        let approach = place.normal.dot(before.as_slice()).abs();
        let surface = acting.slider_velocity[contact];
        let slip = surface - place.tangent.dot(before.as_slice());
        let limit = acting.friction[contact].kinetic * mass * approach;
        let impulse = (mass * slip).clamp(-limit, limit);
        self.impact += 0.5 * mass * approach * approach;
        self.friction += impulse * slip - 0.5 * impulse * impulse / mass;
        self.slider += impulse * surface;
    }

    /// A step of the paper's scheme: the forces reported at both its ends, and the velocities at its
    /// beginning.
    fn add_step(&mut self, run: &mut Run, old: &(Vec<ContactForce>, f64)) {
        let new = (run.forces(), run.damping_power());
        let h = run.h();
        let acting = run.acting(run.time());
        self.damping += 0.5 * h * (old.1 + new.1);
        for (i, (a, b)) in old.0.iter().zip(&new.0).enumerate() {
            let gap = |x: &DVector<f64>| run.model.contacts[i].normal.dot(x.as_slice());
            if gap(&run.before[0]) > 0.0 && gap(&run.now[0]) <= 0.0 {
                self.add_landing(run, i, &run.before[1], &acting);
            } else {
                let power = |force: f64, velocity: f64| force * velocity;
                self.slider +=
                    0.5 * h * acting.slider_velocity[i] * (a.friction_force + b.friction_force);
                self.friction += 0.5
                    * h
                    * (power(a.friction_force, a.slip_velocity)
                        + power(b.friction_force, b.slip_velocity));
            }
        }
    }

    /// A step of exact motion: integrals between changes of state, and the landings among these.
    fn add_exact_step(&mut self, run: &mut Run) {
        let acting = run.acting(run.time());
        let [slider, damping, friction] = run.integral(|run, [_, velocity], forces| {
            let of = |power: &dyn Fn(usize) -> f64| (0..forces.len()).map(power).sum();
            [
                of(&|i| forces[i].friction_force * acting.slider_velocity[i]),
                run.power_of_damping(velocity),
                of(&|i| forces[i].friction_force * forces[i].slip_velocity),
            ]
        });
        self.slider += slider;
        self.damping += damping;
        self.friction += friction;
        for change in run.changes.iter().filter(|change| change.has_landed) {
            for (i, contact) in run.model.contacts.iter().enumerate() {
                let along = |velocity: &DVector<f64>| contact.normal.dot(velocity.as_slice());
                let [before, after] = [&change.before, &change.after].map(|place| along(&place[1]));
                if before < 0.0 && after.abs() < -1e-6 * before {
                    self.add_landing(run, i, &change.before[1], &acting);
                }
            }
        }
    }
}

/// The largest amount of energy, J, that a run up to `end` (s) has won or lost unaccounted for, and the
/// energy turned over.
fn imbalance(run: &mut Run, end: f64) -> (f64, Work, bool) {
    let load = DVector::from_column_slice(&run.model.load);
    let stored = |run: &Run| run.energy() - load.dot(&run.total(&run.now[0]));
    let first = stored(run);
    let mut work = Work::default();
    let (mut worst, mut all_open) = (0.0_f64, false);
    let mut old = (run.forces(), run.damping_power());
    while run.time() < end - 0.5 * run.h() {
        run.step();
        run.judge_step();
        match run.method {
            Method::ForwardIncrement => work.add_step(run, &old),
            Method::EventDriven => work.add_exact_step(run),
        }
        old = (run.forces(), run.damping_power());
        all_open |= old.0.iter().all(|force| force.state == Detached);
        let missing =
            stored(run) - first - work.slider + work.damping + work.friction + work.impact;
        // A landing of the scheme takes two steps, of which the first leads to the slider.
        if run.method == Method::EventDriven || !run.has_landed() {
            worst = worst.max(missing.abs());
        }
    }
    (worst, work, all_open)
}

#[test]
fn the_work_balance_closes_when_all_contacts_are_thrown_off_and_land_again() {
    let end = 0.05;
    let set1 = || builtin("set1").unwrap().scene();
    let thrown = |velocities: &[[f64; 4]]| {
        let mut scene = set1();
        let module = scene.modules()[0];
        *scene.modules_mut() =
            velocities.iter().map(|&velocity| Module { velocity, ..module }).collect();
        scene
    };
    let together = thrown(&[[0.5, 0.2, 0.4, 1.5]; 3]);
    let apart = thrown(&[[0.5, 0.2, -0.4, 1.5], [-0.3, 0.0, 1.4, 0.7], [0.0, -0.8, 0.2, 2.0]]);
    let mut frictionless = apart.clone();
    frictionless.friction_coefficient = 0.0;
    let mut backwards = apart.clone();
    (backwards.slider.velocity, backwards.friction_coefficient) = (-0.6, 0.7);
    // Through the integrator for any structure.
    let network = parse("pads", &pads(3, 2.0, 1e-5)).unwrap();
    for scene in [together, apart, frictionless, backwards, network] {
        for method in METHODS {
            for h in [1e-5, 1e-6] {
                let scene = Scene { step: h, ..scene.clone() };
                let limit = critical_step(&LumpedModel::from(&scene), 0.0).unwrap().step;
                let mut run = Run::new(scene, method);
                let given = 0.5
                    * run.now[1]
                        .iter()
                        .enumerate()
                        .map(|(i, v)| run.model.mass.get(i, i) * v * v)
                        .sum::<f64>();
                let (worst, work, all_open) = imbalance(&mut run, end);
                let statistics = run.simulation.statistics();
                assert!(all_open && statistics.touch_downs >= 3, "{statistics:?}");
                assert!(
                    work.friction >= 0.0 && work.impact > 0.0 && work.damping > 0.0,
                    "{work:?}"
                );
                // Of all energy E the scheme's own differs by up to ½ ωh E, with ωh = 2 h/h_c of its
                // fastest mode; each quadrature and each event adds up to as much of what it counts.
                let turned = given + work.slider.abs() + work.friction + work.damping;
                let allowed = off(method, 2.0 * h / limit * turned, 1e-12 * turned);
                assert!(worst <= allowed, "{worst} J of {work:?}, allowed {allowed} J");
            }
        }
    }
}
