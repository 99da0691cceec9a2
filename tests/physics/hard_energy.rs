//! Hard cases of energy: what is kept without damping, where work goes, what stiff springs beside soft ones
//! do, and the critical step; with the law of contact judged after every step.

use crate::judge::blocks::{OMEGA, block, pads, start};
use crate::judge::{Acting, METHODS, Run, assert_near, off, scene};
use amontons::contact::ContactState::{self, Detached, Stick};
use amontons::contact::{ContactForce, all_states};
use amontons::model::LumpedModel;
use amontons::scene::{Method, Module, Scene, builtin, parse};
use amontons::simulation::Simulation;
use amontons::stability::critical_step;
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use std::fmt::Write;

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
        assert_eq!(run.simulation.statistics().state_changes(), 0);
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
                let critical = critical_step(&run.model).unwrap().step;
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
            // The tolerance covers the rounding of λ for a mode whose frequency is a thousandth of the largest.
            let [x, _] = run.of_dof("mass.slow.x");
            assert_near(x, slow, off(method, first, 0.0) + 1e-9);
            assert_eq!(run.simulation.statistics().state_changes(), 0);
        }
    }
}

/// A gap that is none, m: what rounding leaves of those between masses.
const GAP: f64 = 1e-13;

/// Energies of a run by destination, J. Quadratures use the values reported at both ends of a step, and impacts follow
/// their law from the velocities before them: no energy is computed from the change of the masses' motion.
#[derive(Clone, Copy, Debug, Default)]
struct Work {
    slider: f64,
    damping: f64,
    friction: f64,
    impact: f64,
}

impl Work {
    /// Adds the energy that an impact takes with these contacts closed: perfectly inelastic, with friction as long as
    /// it lasts. A contact gives as much to the one mass as it takes from the other.
    fn add_impact(&mut self, run: &Run, closed: &[usize], before: &DVector<f64>, acting: &Acting) {
        let rows: Vec<DVector<f64>> = closed.iter().flat_map(|&i| directions(run, i)).collect();
        let impulses = impulses(run, closed, &rows, before, acting);
        let give = rows.iter().zip(&impulses).map(|(row, impulse)| row * *impulse);
        let gained = divided_by_mass(run, &give.sum());
        let mean = before + 0.5 * gained;
        for (k, &i) in closed.iter().enumerate() {
            let surface = acting.slider_velocity[i];
            self.impact -= impulses[2 * k] * rows[2 * k].dot(&mean);
            self.friction += impulses[2 * k + 1] * (surface - rows[2 * k + 1].dot(&mean));
            self.slider += impulses[2 * k + 1] * surface;
        }
    }

    /// A step of the paper's scheme: the forces reported at both its ends, and the velocities at its
    /// beginning.
    fn add_step(&mut self, run: &mut Run, old: &(Vec<ContactForce>, f64)) {
        let new = (run.forces(), run.damping_power());
        let h = run.h();
        let acting = run.acting(run.time());
        self.damping += 0.5 * h * (old.1 + new.1);
        let is_open = |i: usize, place: &DVector<f64>| run.gap(i, place) > GAP;
        let lands = |i: usize| is_open(i, &run.before[0]) && !is_open(i, &run.now[0]);
        for (i, (a, b)) in old.0.iter().zip(&new.0).enumerate().filter(|(i, _)| !lands(*i)) {
            self.slider +=
                0.5 * h * acting.slider_velocity[i] * (a.friction_force + b.friction_force);
            self.friction +=
                0.5 * h * (a.friction_force * a.slip_velocity + b.friction_force * b.slip_velocity);
        }
        if (0..new.0.len()).any(lands) {
            let closed = (0..new.0.len()).filter(|&i| !is_open(i, &run.now[0])).collect::<Vec<_>>();
            self.add_impact(run, &closed, &run.before[1], &acting);
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
            // Those that land at the same time, to rounding, still approach.
            let is_closed = |i: &usize| {
                let [normal, _] = directions(run, *i);
                let speed = change.after[1].amax();
                run.gap(*i, &change.after[0]) <= GAP && normal.dot(&change.after[1]) > -1e-9 * speed
            };
            let closed: Vec<usize> = (0..run.model.contacts.len()).filter(is_closed).collect();
            self.add_impact(run, &closed, &change.before[1], &acting);
        }
    }
}

/// Normal and tangent of a contact.
fn directions(run: &Run, contact: usize) -> [DVector<f64>; 2] {
    let contact = &run.model.contacts[contact];
    [&contact.normal, &contact.tangent].map(|direction| {
        let mut dense = DVector::zeros(run.model.dofs());
        direction.0.iter().for_each(|&(dof, value)| dense[dof] = value);
        dense
    })
}

fn divided_by_mass(run: &Run, impulse: &DVector<f64>) -> DVector<f64> {
    DVector::from_fn(impulse.len(), |i, _| impulse[i] / run.model.mass.get(i, i))
}

/// (N, T) of these contacts in an impact, one after the other: of all that their states would give, those
/// that contradict none of the states.
fn impulses(
    run: &Run,
    closed: &[usize],
    rows: &[DVector<f64>],
    before: &DVector<f64>,
    acting: &Acting,
) -> Vec<f64> {
    let n = rows.len();
    let free = DVector::from_fn(n, |k, _| {
        let surface = if k % 2 == 1 { acting.slider_velocity[closed[k / 2]] } else { 0.0 };
        rows[k].dot(before) - surface
    });
    let w = DMatrix::from_fn(n, n, |k, l| rows[k].dot(&divided_by_mass(run, &rows[l])));
    let tried = all_states(u32::try_from(closed.len()).unwrap()).filter_map(|states| {
        let (mut matrix, mut right) = (DMatrix::identity(n, n), DVector::zeros(n));
        for (i, state) in states.iter().enumerate() {
            let (normal, tangent) = (2 * i, 2 * i + 1);
            let held = match state {
                Detached => continue,
                Stick => normal..=tangent,
                _ => normal..=normal,
            };
            for k in held {
                matrix.set_row(k, &w.row(k));
                right[k] = -free[k];
            }
            if let Some(direction) = state.sliding_direction() {
                matrix[(tangent, normal)] = -direction * acting.friction[closed[i]].kinetic;
            }
        }
        let found = matrix.lu().solve(&right)?;
        let after = &w * &found + &free;
        let nothing = [1e-9 * found.amax(), 1e-9 * free.amax()];
        let is_right = states.iter().enumerate().all(|(i, state)| {
            let (force, kept) = (found[2 * i], acting.friction[closed[i]].kinetic * found[2 * i]);
            let held = found[2 * i + 1].abs() <= kept + nothing[0];
            let slip = state.sliding_direction().map_or(0.0, |way| -way * after[2 * i + 1]);
            force >= -nothing[0] && after[2 * i] >= -nothing[1] && held && slip >= -nothing[1]
        });
        is_right.then(|| found.as_slice().to_vec())
    });
    tried.into_iter().next().expect("an impact that obeys the law")
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
        assert_balanced(&scene, end, 3);
    }
}

/// Asserts that a run loses no energy but where it goes, with all contacts open at some time and this many
/// touch-downs at least.
#[track_caller]
fn assert_balanced(scene: &Scene, end: f64, landings: u64) {
    for method in METHODS {
        for h in [1e-5, 1e-6] {
            let scene = Scene { step: h, ..scene.clone() };
            let limit = critical_step(&LumpedModel::from(&scene)).unwrap().step;
            let mut run = Run::new(scene, method);
            let given = 0.5
                * run.now[1]
                    .iter()
                    .enumerate()
                    .map(|(i, v)| run.model.mass.get(i, i) * v * v)
                    .sum::<f64>();
            let (worst, work, all_open) = imbalance(&mut run, end);
            let statistics = run.simulation.statistics();
            assert!(all_open && statistics.touch_downs >= landings, "{statistics:?}");
            assert!(work.friction >= 0.0 && work.impact > 0.0 && work.damping > 0.0, "{work:?}");
            // The energy of the scheme differs from E by up to ½ ωh E, with ωh = 2 h/h_c of its fastest mode; each
            // quadrature and each event adds up to as much of the energy that it counts.
            let turned = given + work.slider.abs() + work.friction + work.damping;
            let allowed = off(method, 2.0 * h / limit * turned, 1e-12 * turned);
            assert!(worst <= allowed, "{worst} J of {work:?}, allowed {allowed} J");
        }
    }
}

/// Masses that hang on springs of their own, in x and y.
fn hanging(masses: &[(&str, f64, f64)]) -> String {
    let mut text = "[slider]\nvelocity = 0.3\nangle = 0.2\n[friction]\ncoefficient = 0.4\n\
        [damping]\nbeta = 1e-5\n[integrator]\nstep = 1e-5\n"
        .to_owned();
    for (name, mass, load) in masses {
        let _ =
            write!(text, "[[mass]]\nname = \"{name}\"\nmass = {mass:?}\nforce = [0.0, {load:?}]\n");
        for (way, stiffness) in [("x", 3e4), ("y", 2e4)] {
            let _ = write!(
                text,
                "[[spring]]\nname = \"{name}_{way}\"\nbetween = [\"{name}\", \"ground\"]\n\
                 direction = \"{way}\"\nstiffness = {stiffness:?}\n"
            );
        }
    }
    text
}

#[test]
fn the_work_balance_closes_when_masses_are_thrown_off_each_other_and_land_again() {
    // One on the other and that one on the slider; and two that squeeze a third, thrown off it alike, so
    // that both land on it at once, or one after the other.
    let stack = hanging(&[("lower", 0.8, -20.0), ("upper", 0.5, -40.0)]);
    let stack = format!(
        "{stack}[[contact]]\nname = \"floor\"\nmass = \"lower\"\n\
         [[contact]]\nname = \"joint\"\nmass = \"upper\"\non = \"lower\"\nangle = -0.3\n\
         [[initial]]\nmass = \"lower\"\nvx = -0.1\nvy = 0.5\n\
         [[initial]]\nmass = \"upper\"\nvx = 0.3\nvy = 1.1\n"
    );
    let squeezed = |lower: f64| {
        let text = hanging(&[("disc", 1.2, 0.0), ("upper", 0.5, -60.0), ("lower", 0.5, 60.0)]);
        format!(
            "{text}[[contact]]\nname = \"above\"\nmass = \"upper\"\non = \"disc\"\nangle = 0.0\n\
             [[contact]]\nname = \"below\"\nmass = \"lower\"\non = \"disc\"\n\
             angle = 3.141592653589793\nvelocity = -0.3\n\
             [[initial]]\nmass = \"upper\"\nvx = 0.2\nvy = 0.9\n\
             [[initial]]\nmass = \"lower\"\nvx = 0.2\nvy = {lower:?}\n"
        )
    };
    for text in [stack, squeezed(-0.9), squeezed(-0.5)] {
        assert_balanced(&scene(&text), 0.05, 2);
    }
}
