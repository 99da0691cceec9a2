//! This module computes the program's physics a second time, for tests alone: matrices, equilibrium, eigenvalues and time
//! steps follow from the elements of a scene. It takes nothing from the program but the values that a scene file gives.
//!
//! Motion is by Moreau and Jean's scheme: trapezoidal rule, inelastic impacts, Gauss–Seidel over the contacts. It is of
//! first order at changes of contact state, so every comparison halves the step to know its error.

use amontons::contact::Law;
use amontons::scene::{Line, Network, Point, Scene, Shape, Signal, Structure};
use nalgebra::{Complex, DMatrix, DVector};

/// The state of a contact, which the program abbreviates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    Slides,
    SlidesBack,
    Sticks,
    Open,
}

impl State {
    pub fn named(name: &str) -> Self {
        match name {
            "Sl" => Self::Slides,
            "R-Sl" => Self::SlidesBack,
            "St" => Self::Sticks,
            "Dt" => Self::Open,
            _ => panic!("{name} is no contact state"),
        }
    }
}

/// A scene as matrices. Displacements are from unloaded springs.
#[derive(Clone, Debug)]
pub struct Oracle {
    mass: DMatrix<f64>,
    damping: DMatrix<f64>,
    stiffness: DMatrix<f64>,
    load: DVector<f64>,
    /// One column a contact: the gap is normalᵀ u, the slip velocity v − tangentᵀ u̇.
    normal: DMatrix<f64>,
    tangent: DMatrix<f64>,
    velocity: DVector<f64>,
    /// Kinetic and static coefficient of each contact, and whether they are the common ones.
    friction: Vec<[f64; 2]>,
    is_common: Vec<bool>,
    stribeck_velocity: Option<f64>,
    sticking: bool,
    detachment: bool,
    /// The signals, each added to the velocity of contacts without one of their own or to the load along a degree of
    /// freedom.
    signals: Vec<(Driven, Shape)>,
    /// Displacements from the equilibrium, m, and velocities, m/s.
    pub start: [DVector<f64>; 2],
}

/// The quantity to which a signal adds.
#[derive(Clone, Debug)]
enum Driven {
    Velocity(Vec<bool>),
    Load(usize),
}

/// The motion in which a long run ends.
#[derive(Clone, Copy, Debug)]
pub struct End {
    pub rests: bool,
    /// `true` where no contact changes its state and no mode grows or decays.
    pub is_neutral: bool,
    /// Half of the range of the first displacement over the last part of the run, m.
    pub amplitude: f64,
}

fn unit(angle: f64) -> [f64; 2] {
    [angle.cos(), angle.sin()]
}

/// The part of each degree of freedom of a network in one displacement along a direction of space.
struct Row<'a> {
    network: &'a Network,
    /// The place of each mass's two degrees of freedom.
    places: Vec<[Option<usize>; 2]>,
    count: usize,
}

impl Row<'_> {
    fn of(&self, mass: Option<usize>, direction: [f64; 2]) -> DVector<f64> {
        let mut row = DVector::zeros(self.count);
        if let Some(index) = mass {
            let angle = self.network.masses[index].angle;
            for (axis, place) in self.places[index].iter().enumerate() {
                let along = unit(angle + axis as f64 * std::f64::consts::FRAC_PI_2);
                if let Some(place) = place {
                    row[*place] = along[0] * direction[0] + along[1] * direction[1];
                }
            }
        }
        row
    }
}

impl Oracle {
    pub fn of(scene: &Scene) -> Self {
        let mut oracle = match &scene.structure {
            Structure::Ring(_) => Self::ring(scene),
            Structure::Network(network) => Self::network(scene, network),
        };
        let rayleigh = &oracle.mass * scene.damping.alpha + &oracle.stiffness * scene.damping.beta;
        oracle.damping += rayleigh;
        oracle
    }

    fn empty(count: usize, contacts: usize, scene: &Scene) -> Self {
        let kinetic =
            if scene.friction_law == Law::Frictionless { 0.0 } else { scene.friction_coefficient };
        let zero = || DMatrix::zeros(count, count);
        Self {
            mass: zero(),
            damping: zero(),
            stiffness: zero(),
            load: DVector::zeros(count),
            normal: DMatrix::zeros(count, contacts),
            tangent: DMatrix::zeros(count, contacts),
            velocity: DVector::from_element(contacts, scene.slider.velocity),
            friction: vec![[kinetic, scene.static_friction.unwrap_or(kinetic)]; contacts],
            is_common: vec![true; contacts],
            stribeck_velocity: scene.stribeck_velocity,
            sticking: scene.effects.sticking,
            detachment: scene.effects.detachment,
            signals: Vec::new(),
            start: [DVector::zeros(count), DVector::zeros(count)],
        }
    }

    fn network(scene: &Scene, network: &Network) -> Self {
        let mut count = 0;
        let places = network.masses.iter().map(|mass| {
            mass.locked.map(|locked| {
                count += usize::from(!locked);
                (!locked).then(|| count - 1)
            })
        });
        let places: Vec<_> = places.collect();
        let rows = Row { network, places, count };
        let mut all = Self::empty(count, network.contacts.len(), scene);
        for (mass, places) in network.masses.iter().zip(&rows.places) {
            for (axis, place) in places.iter().enumerate() {
                let Some(place) = *place else { continue };
                all.mass[(place, place)] = mass.mass;
                all.load[place] += mass.load[axis];
                all.start[0][place] = mass.displacement[axis];
                all.start[1][place] = mass.velocity[axis];
            }
        }
        let mass = |end: Option<Point>| end.and_then(Point::mass);
        let between = |ends: [Option<Point>; 2], line: Line| {
            let along = unit(line.angle().expect("directions are angles here"));
            rows.of(mass(ends[0]), along) - rows.of(mass(ends[1]), along)
        };
        for spring in &network.springs {
            let row = between(spring.between, spring.direction);
            all.stiffness += spring.stiffness * &row * row.transpose();
            all.load += spring.stiffness * spring.preload.unwrap_or(0.0) * &row;
        }
        for damper in &network.dampers {
            let row = between(damper.between, damper.direction);
            all.damping += damper.damping * &row * row.transpose();
        }
        for (i, contact) in network.contacts.iter().enumerate() {
            let [c, s] = unit(contact.angle.unwrap_or(scene.slider.angle));
            let relative =
                |along| rows.of(contact.mass.mass(), along) - rows.of(mass(contact.on), along);
            all.normal.set_column(i, &relative([-s, c]));
            all.tangent.set_column(i, &relative([c, s]));
            all.velocity[i] = contact.velocity.unwrap_or(scene.slider.velocity);
            if let Some(own) = contact.friction {
                (all.friction[i], all.is_common[i]) = ([own; 2], false);
            }
            if let Some(own) = contact.static_friction {
                all.friction[i][1] = own;
            }
        }
        let driven = |signal: &Signal| match signal.input.split('.').collect::<Vec<_>>()[..] {
            ["slider", "velocity"] => Driven::Velocity(
                network.contacts.iter().map(|contact| contact.velocity.is_none()).collect(),
            ),
            ["mass", name, axis @ ("fx" | "fy")] => {
                let mass = network.masses.iter().position(|mass| mass.name == name).unwrap();
                Driven::Load(rows.places[mass][usize::from(axis == "fy")].unwrap())
            }
            _ => panic!("the oracle does not know signals on {}", signal.input),
        };
        all.signals =
            scene.signals.iter().map(|signal| (driven(signal), signal.shape.clone())).collect();
        all
    }

    /// The paper's ring: x1 and x2 are along the horizontal and the vertical, x3 and x4 along the slider and away from it.
    fn ring(scene: &Scene) -> Self {
        let Structure::Ring(modules) = &scene.structure else { unreachable!() };
        let n = modules.len();
        let mut all = Self::empty(4 * n, n, scene);
        let [c, s] = unit(scene.slider.angle);
        let axis = |place: usize| {
            let mut row = DVector::zeros(4 * n);
            row[place] = 1.0;
            row
        };
        for (i, module) in modules.iter().enumerate() {
            let own: [DVector<f64>; 4] = [0, 1, 2, 3].map(|j| axis(4 * i + j));
            let horizontal = &own[2] * c - &own[3] * s;
            let vertical = &own[2] * s + &own[3] * c;
            let next = 4 * ((i + 1) % n);
            let k = module.stiffness;
            let mut springs = vec![
                (k[2], own[1].clone()),
                (k[3], own[0].clone()),
                (k[4], &own[1] - vertical),
                (k[5], &own[0] - horizontal),
            ];
            if n > 1 {
                springs.push((k[0], &own[0] - axis(next)));
                springs.push((k[1], &own[1] - axis(next + 1)));
            }
            for (stiffness, row) in springs {
                all.stiffness += stiffness * &row * row.transpose();
            }
            all.load[4 * i + 1] -= k[2] * module.preload;
            for j in 0..4 {
                all.mass[(4 * i + j, 4 * i + j)] = module.mass[j / 2];
                all.start[0][4 * i + j] = module.displacement[j];
                all.start[1][4 * i + j] = module.velocity[j];
            }
            all.normal.set_column(i, &own[3]);
            all.tangent.set_column(i, &own[2]);
        }
        all
    }

    /// The coefficient at a slip velocity, and its derivative by the amount of that velocity.
    fn coefficient(&self, contact: usize, slip: f64) -> [f64; 2] {
        let [kinetic, at_rest] = self.friction[contact];
        self.stribeck_velocity.map_or([kinetic, 0.0], |scale| {
            let falls = (at_rest - kinetic) * (-slip.abs() / scale).exp();
            [kinetic + falls, -falls / scale]
        })
    }

    /// Displacements and normal forces of uniform sliding; a contact whose surface stands still carries no friction.
    fn equilibrium(&self) -> (DVector<f64>, DVector<f64>) {
        let (n, contacts) = (self.load.len(), self.velocity.len());
        let scale = self.stiffness.amax();
        let mut matrix = DMatrix::zeros(n + contacts, n + contacts);
        matrix.view_mut((0, 0), (n, n)).copy_from(&self.stiffness);
        for i in 0..contacts {
            let [mu, _] = self.coefficient(i, self.velocity[i]);
            let sign = if self.velocity[i] == 0.0 { 0.0 } else { self.velocity[i].signum() };
            let pushes = self.normal.column(i) + sign * mu * self.tangent.column(i);
            matrix.view_mut((0, n + i), (n, 1)).copy_from(&(-scale * pushes));
            matrix
                .view_mut((n + i, 0), (1, n))
                .copy_from(&(scale * self.normal.column(i).transpose()));
        }
        let mut load = DVector::zeros(n + contacts);
        load.rows_mut(0, n).copy_from(&self.load);
        // Contacts that say the same thing twice share their force in the least-squares sense.
        let found = matrix.svd(true, true).solve(&load, 1e-12 * scale).unwrap();
        (found.rows(0, n).into_owned(), scale * found.rows(n, contacts))
    }

    /// `true` if contacts in these states push along as many directions as they hold. Two contacts that hold the same
    /// motion twice do not if they slide in opposite directions.
    pub fn is_a_state(&self, states: &[State]) -> bool {
        let (free, seen, _) = self.reduction(states);
        free.ncols() == seen.ncols()
    }

    /// The motions that contacts leave free, the directions along which they do not push, and the damping matrix.
    fn reduction(&self, states: &[State]) -> (DMatrix<f64>, DMatrix<f64>, DMatrix<f64>) {
        let (_, forces) = self.equilibrium();
        let mut damping = self.damping.clone();
        let (mut held, mut pushed) = (Vec::new(), Vec::new());
        for (i, state) in states.iter().enumerate() {
            let (normal, tangent) = (self.normal.column(i), self.tangent.column(i));
            let sign = match state {
                State::Open => continue,
                State::Sticks => {
                    held.extend([normal.into_owned(), tangent.into_owned()]);
                    pushed.extend([normal.into_owned(), tangent.into_owned()]);
                    continue;
                }
                State::Slides => 1.0,
                State::SlidesBack => -1.0,
            };
            let [mu, slope] = self.coefficient(i, self.velocity[i]);
            held.push(normal.into_owned());
            pushed.push(normal + sign * mu * tangent);
            damping += forces[i] * slope * tangent * tangent.transpose();
        }
        let free = complement(&held, self.load.len());
        let seen = complement(&pushed, self.load.len());
        (free, seen, damping)
    }

    /// All eigenvalues, 1/s, of small motions in these contact states.
    pub fn eigenvalues(&self, states: &[State]) -> Vec<Complex<f64>> {
        let (free, seen, damping) = self.reduction(states);
        let reduced = |matrix: &DMatrix<f64>| seen.transpose() * matrix * &free;
        let m = free.ncols();
        if m == 0 {
            return Vec::new();
        }
        let lu = reduced(&self.mass).lu();
        let mut matrix = DMatrix::zeros(2 * m, 2 * m);
        matrix.view_mut((0, m), (m, m)).fill_with_identity();
        matrix.view_mut((m, 0), (m, m)).copy_from(&-lu.solve(&reduced(&self.stiffness)).unwrap());
        matrix.view_mut((m, m), (m, m)).copy_from(&-lu.solve(&reduced(&damping)).unwrap());
        matrix.complex_eigenvalues().iter().copied().collect()
    }

    /// The largest growth rate in these states, 1/s.
    pub fn growth(&self, states: &[State]) -> f64 {
        self.eigenvalues(states).iter().map(|value| value.re).fold(f64::NEG_INFINITY, f64::max)
    }

    /// The largest growth rate in these states, 1/s, unless rounding might feign it.
    pub fn clear_growth(&self, states: &[State]) -> Option<f64> {
        let largest = self.eigenvalues(states).iter().map(|value| value.norm()).fold(0.0, f64::max);
        Some(self.growth(states)).filter(|growth| growth.abs() > 1e-6 * largest)
    }

    /// Each contact slides as its surface moves.
    pub fn sliding(&self) -> Vec<State> {
        let state = |v: &f64| match *v {
            v if v > 0.0 => State::Slides,
            v if v < 0.0 => State::SlidesBack,
            _ => State::Sticks,
        };
        self.velocity.iter().map(state).collect()
    }

    /// Follows the motion over `count` rows that are `interval` (s) apart, and gives displacements from the equilibrium, m.
    pub fn rows(&self, count: usize, interval: f64, steps: usize) -> Vec<DVector<f64>> {
        let mut motion = Motion::of(self, interval / steps as f64);
        (0..count)
            .map(|_| {
                (0..steps).for_each(|_| motion.step());
                &motion.u - &motion.equilibrium
            })
            .collect()
    }

    /// Runs over `time` (s) and tells, from the last tenth, what the motion ends in.
    pub fn end(&self, time: f64, step: f64) -> End {
        Motion::of(self, step).end(time)
    }
}

/// Value of a signal at a time (s).
fn signal(shape: &Shape, time: f64) -> f64 {
    match shape {
        Shape::Sine(sine) if time >= sine.start && sine.end.is_none_or(|end| time < end) => {
            let turns = sine.frequency * (time - sine.start);
            sine.amplitude * (std::f64::consts::TAU * turns + sine.phase).sin()
        }
        Shape::Pulse(pulse) if time >= pulse.start && pulse.end.is_none_or(|end| time < end) => {
            pulse.value
        }
        Shape::Sine(_) | Shape::Pulse(_) => 0.0,
        shape => panic!("the oracle does not know {shape:?}"),
    }
}

/// An orthonormal basis of what is perpendicular to some vectors.
fn complement(vectors: &[DVector<f64>], n: usize) -> DMatrix<f64> {
    if vectors.is_empty() {
        return DMatrix::identity(n, n);
    }
    // The eigenvectors of a projector: zero on the span, one on the complement.
    let span = DMatrix::from_columns(vectors);
    let svd = span.svd(true, false);
    let rank = svd.singular_values.iter().filter(|s| **s > 1e-10).count();
    let u = svd.u.unwrap();
    let basis = u.columns(0, rank);
    let projector = DMatrix::identity(n, n) - basis * basis.transpose();
    let eigen = projector.symmetric_eigen();
    let kept: Vec<usize> = (0..n).filter(|i| eigen.eigenvalues[*i] > 0.5).collect();
    eigen.eigenvectors.select_columns(&kept)
}

/// A motion on its way.
pub struct Motion {
    /// With the velocities of now.
    scene: Oracle,
    /// The scene without signals.
    undriven: Oracle,
    steps: u64,
    equilibrium: DVector<f64>,
    u: DVector<f64>,
    v: DVector<f64>,
    h: f64,
    /// (M + h C/2 + h² K/4)⁻¹, and what it makes of unit impulses at the contacts: normals, then tangents.
    inverse: DMatrix<f64>,
    moved: DMatrix<f64>,
    /// Change of the velocity along each of these directions by each of these impulses.
    compliance: DMatrix<f64>,
    directions: DMatrix<f64>,
    late: DMatrix<f64>,
    impulse: DVector<f64>,
    stuck: Vec<bool>,
    states: Vec<State>,
    changes: usize,
}

impl Motion {
    pub fn of(scene: &Oracle, h: f64) -> Self {
        let (equilibrium, _) = scene.equilibrium();
        let contacts = scene.velocity.len();
        let u = &equilibrium + &scene.start[0];
        let v = scene.start[1].clone();
        let slip = &scene.velocity - scene.tangent.transpose() * &v;
        let mut motion = Self {
            stuck: slip.iter().map(|slip| *slip == 0.0).collect(),
            scene: scene.clone(),
            undriven: scene.clone(),
            steps: 0,
            equilibrium,
            u,
            v,
            h,
            inverse: DMatrix::zeros(0, 0),
            moved: DMatrix::zeros(0, 0),
            compliance: DMatrix::zeros(0, 0),
            directions: DMatrix::zeros(0, 0),
            late: DMatrix::zeros(0, 0),
            impulse: DVector::zeros(2 * contacts),
            states: scene.sliding(),
            changes: 0,
        };
        let matrix = &scene.mass + 0.5 * h * &scene.damping + 0.25 * h * h * &scene.stiffness;
        motion.inverse = matrix.try_inverse().unwrap();
        motion.late = &scene.damping + 0.5 * h * &scene.stiffness;
        let columns = scene.normal.column_iter().chain(scene.tangent.column_iter());
        let columns: Vec<_> = columns.map(|column| column.into_owned()).collect();
        motion.directions = if contacts == 0 {
            DMatrix::zeros(scene.load.len(), 0)
        } else {
            DMatrix::from_columns(&columns)
        };
        motion.moved = &motion.inverse * &motion.directions;
        motion.compliance = motion.directions.transpose() * &motion.moved;
        motion
    }

    /// Goes on with another common friction coefficient; a static coefficient above it stays.
    pub fn with_friction(&mut self, mu: f64) {
        for (friction, is_common) in self.scene.friction.iter_mut().zip(&self.scene.is_common) {
            let [kinetic, at_rest] = *friction;
            if *is_common {
                *friction = [mu, if at_rest > kinetic { at_rest.max(mu) } else { mu }];
            }
        }
        (self.equilibrium, _) = self.scene.equilibrium();
    }

    /// Sets the velocities at the end of a step and the loads in its middle.
    fn drive(&mut self) {
        let start = self.steps as f64 * self.h;
        self.steps += 1;
        self.scene.velocity.copy_from(&self.undriven.velocity);
        self.scene.load.copy_from(&self.undriven.load);
        for (driven, shape) in &self.undriven.signals {
            match driven {
                Driven::Velocity(contacts) => {
                    let value = signal(shape, start + self.h);
                    for (contact, _) in
                        contacts.iter().enumerate().filter(|(_, is_driven)| **is_driven)
                    {
                        self.scene.velocity[contact] += value;
                    }
                }
                Driven::Load(place) => {
                    self.scene.load[*place] += signal(shape, start + 0.5 * self.h);
                }
            }
        }
    }

    fn step(&mut self) {
        let h = self.h;
        let slip = &self.scene.velocity - self.scene.tangent.transpose() * &self.v;
        self.drive();
        let scene = &self.scene;
        let force = &scene.load - &scene.stiffness * &self.u - &self.late * &self.v;
        let free = &self.v + h * (&self.inverse * force);
        let contacts = scene.velocity.len();
        let gap = scene.normal.transpose() * (&self.u + 0.5 * h * &self.v);
        let is_closed: Vec<bool> =
            gap.iter().map(|gap| !scene.detachment || *gap <= 1e-15).collect();
        for (i, is_closed) in is_closed.iter().enumerate() {
            if !is_closed {
                (self.impulse[i], self.impulse[contacts + i]) = (0.0, 0.0);
            }
        }
        let unheld = self.directions.transpose() * &free;
        let mut along = &unheld + &self.compliance * &self.impulse;
        for _ in 0..5000 {
            let mut change = 0.0_f64;
            for i in (0..contacts).filter(|i| is_closed[*i]) {
                let t = contacts + i;
                let wanted = self.impulse[i] - along[i] / self.compliance[(i, i)];
                let normal = if scene.detachment { wanted.max(0.0) } else { wanted };
                let moved = normal - self.impulse[i];
                self.impulse[i] = normal;
                along += moved * self.compliance.column(i);
                let [kinetic, _] = scene.coefficient(i, slip[i]);
                let tangential = if scene.sticking {
                    let most = if self.stuck[i] { scene.friction[i][1] } else { kinetic };
                    let wanted =
                        self.impulse[t] - (along[t] - scene.velocity[i]) / self.compliance[(t, t)];
                    if wanted.abs() > most * normal.abs() {
                        wanted.signum() * kinetic * normal.abs()
                    } else {
                        wanted
                    }
                } else {
                    scene.velocity[i].signum() * kinetic * normal
                };
                let rubbed = tangential - self.impulse[t];
                self.impulse[t] = tangential;
                along += rubbed * self.compliance.column(t);
                change = change.max(moved.abs()).max(rubbed.abs());
            }
            if change <= 1e-14 * self.impulse.amax() {
                break;
            }
        }
        let v = free + &self.moved * &self.impulse;
        self.u += 0.5 * h * (&self.v + &v);
        self.v = v;
        let slip = &scene.velocity - scene.tangent.transpose() * &self.v;
        for (i, is_closed) in is_closed.iter().enumerate() {
            let is_open = !is_closed || scene.detachment && self.impulse[i] <= 0.0;
            let nearly = 1e-9 * (scene.velocity[i].abs() + 1e-6);
            let state = match slip[i] {
                _ if is_open => State::Open,
                slip if scene.sticking && slip.abs() <= nearly => State::Sticks,
                slip if slip > 0.0 => State::Slides,
                _ => State::SlidesBack,
            };
            self.changes += usize::from(state != self.states[i]);
            self.stuck[i] = state == State::Sticks;
            self.states[i] = state;
        }
    }

    /// Goes on for `time` (s) and tells, from the last tenth, what the motion ends in.
    pub fn end(&mut self, time: f64) -> End {
        let steps = (time / self.h).round() as usize;
        let last = steps - steps / 10;
        let (mut low, mut high, mut changes) = (f64::INFINITY, f64::NEG_INFINITY, 0);
        for step in 0..steps {
            if step == last {
                changes = self.changes;
            }
            self.step();
            if step >= last {
                let x = self.u[0] - self.equilibrium[0];
                (low, high) = (low.min(x), high.max(x));
            }
        }
        // If no contact changes its state, the motion is linear, and eigenvalues decide its end.
        let is_linear = changes == self.changes;
        let growth = self.scene.growth(&self.states);
        let is_neutral = is_linear && growth.abs() <= 1e-9;
        let rests = is_linear && growth < 0.0 && !is_neutral;
        End { rests, is_neutral, amplitude: 0.5 * (high - low) }
    }
}
