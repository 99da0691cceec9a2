//! Random networks: masses on surfaces and on each other, locked and inclined.

use crate::apart;
use crate::random::Random;
use crate::ring::{Initial, Sizes};
use amontons::contact::Law;
use amontons::scene::{
    ContactDefinition, Damper, Line, Mass, Network, Point, Scene, Spring, Structure, direction,
};
use std::f64::consts::FRAC_PI_2;

/// Arrangement of the contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// Each mass has a surface of its own.
    OnSurfaces,
    /// Each mass rubs on the one before.
    Stack,
    /// All masses rub on the first.
    Disc,
    /// Each mass rubs on a surface, or on any mass before it.
    Mixed,
    /// Each mass lies between two surfaces that lean.
    Groove,
}

/// Properties that the parts of one network share.
struct Style {
    kind: Kind,
    sizes: Sizes,
    has_locks: bool,
    has_dampers: bool,
    has_own_values: bool,
    has_preloads: bool,
    /// Size of the inclination of tangents.
    leaning: f64,
    /// The chance that a mass has its axes along its contact.
    aligned: f64,
    initial: Initial,
}

impl Style {
    fn drawn(random: &mut Random) -> Self {
        let kinds = [Kind::OnSurfaces, Kind::Stack, Kind::Disc, Kind::Mixed, Kind::Groove];
        Self {
            kind: kinds[random.whole(0, 4)],
            sizes: Sizes::drawn(random),
            has_locks: random.chance(0.4),
            has_dampers: random.chance(0.4),
            has_own_values: random.chance(0.4),
            has_preloads: random.chance(0.3),
            leaning: if random.chance(0.2) { 0.0 } else { random.between(0.0, 1.5) },
            aligned: [0.0, 0.5, 1.0][random.whole(0, 2)],
            initial: Initial::drawn(random),
        }
    }
}

/// Makes the scene a network with that many contacts.
pub fn fill(random: &mut Random, scene: &mut Scene, contacts: usize) {
    let style = Style::drawn(random);
    scene.slider.angle = if random.chance(0.3) { 0.0 } else { random.between(-3.0, 3.0) };
    let mut network = Network::default();
    if style.kind == Kind::Disc {
        add_mass(random, &mut network, &style, 0.0, false);
        hold(random, &mut network, &style, 0, 0.0);
    }
    while network.contacts.len() < contacts {
        add_rubbing_mass(random, scene, &mut network, &style, contacts);
    }
    start(random, scene, &mut network, &style);
    scene.structure = Structure::Network(network);
}

fn add_rubbing_mass(
    random: &mut Random,
    scene: &Scene,
    network: &mut Network,
    style: &Style,
    contacts: usize,
) {
    let mass = network.masses.len();
    let leaning = style.leaning;
    let angle = random.sometimes(0.8, |random| random.between(-leaning, leaning));
    let tangent = angle.unwrap_or(scene.slider.angle);
    let is_locked = style.has_locks && random.chance(0.3);
    add_mass(random, network, style, tangent, is_locked);
    let on = match style.kind {
        Kind::OnSurfaces | Kind::Groove => None,
        Kind::Stack => mass.checked_sub(1),
        Kind::Disc => Some(0),
        Kind::Mixed if mass > 0 => random.sometimes(0.6, |random| random.whole(0, mass - 1)),
        Kind::Mixed => None,
    };
    add_contact(random, scene, network, style, (mass, on, angle));
    press(random, network, style, mass, tangent);
    let has_room = network.contacts.len() < contacts;
    if has_room && (style.kind == Kind::Groove || random.chance(0.1)) {
        let other = tangent + random.signed(0.1, 1.2);
        add_contact(random, scene, network, style, (mass, None, Some(other)));
        press(random, network, style, mass, other);
    }
    hold(random, network, style, mass, tangent);
}

fn add_mass(
    random: &mut Random,
    network: &mut Network,
    style: &Style,
    tangent: f64,
    is_locked: bool,
) {
    let mut locked = [false; 2];
    let mut angle = if random.chance(style.aligned) { tangent } else { random.between(-3.0, 3.0) };
    if is_locked {
        // The free axis still leads off the surface.
        let axis = random.whole(0, 1);
        locked[axis] = true;
        angle = tangent + random.signed(0.05, 1.4) + if axis == 1 { FRAC_PI_2 } else { 0.0 };
    }
    network.masses.push(Mass {
        name: format!("m{}", network.masses.len()),
        mass: style.sizes.mass(random),
        angle,
        locked,
        load: [0.0; 2],
        force: [0.0; 2],
        displacement: [0.0; 2],
        velocity: [0.0; 2],
    });
}

fn add_contact(
    random: &mut Random,
    scene: &Scene,
    network: &mut Network,
    style: &Style,
    (mass, on, angle): (usize, Option<usize>, Option<f64>),
) {
    let has_own = |random: &mut Random| style.has_own_values && random.chance(0.4);
    let velocity = has_own(random).then(|| random.signed(1e-3, 3.0));
    let has_friction = scene.friction_law != Law::Frictionless;
    let most = 3.0 * random.unit();
    let friction = (has_own(random) && has_friction).then(|| random.between(0.0, most));
    let may_drop = scene.effects.sticking && has_friction;
    let static_friction = (has_own(random) && may_drop)
        .then(|| friction.unwrap_or(scene.friction_coefficient) * random.between(1.0, 3.0));
    network.contacts.push(ContactDefinition {
        name: format!("c{}", network.contacts.len()),
        set: None,
        mass: Point::Mass(mass),
        on: on.map(Point::Mass),
        angle,
        axes: None,
        gap: 0.0,
        velocity,
        friction,
        static_friction,
        is_shown: true,
    });
}

/// Presses a mass on a surface with this tangent.
fn press(random: &mut Random, network: &mut Network, style: &Style, mass: usize, tangent: f64) {
    let mass = &mut network.masses[mass];
    let [cos, sin] = direction(tangent - mass.angle);
    let force = style.sizes.load * random.between(0.1, 1.0);
    mass.load[0] += force * sin;
    mass.load[1] -= force * cos;
}

/// Springs and dampers from a mass to the ground and to masses before it.
fn hold(random: &mut Random, network: &mut Network, style: &Style, mass: usize, tangent: f64) {
    let first = random.between(-1.5, 1.5);
    add_spring(random, network, style, [mass, usize::MAX], tangent + first);
    if mass == 0 || random.chance(0.8) {
        // Two that are not along one line hold a mass.
        let second = tangent + first + random.between(0.8, 2.2);
        add_spring(random, network, style, [mass, usize::MAX], second);
    }
    if mass > 0 && random.chance(0.5) {
        let other = random.whole(0, mass - 1);
        let angle = random.between(-1.5, 1.5);
        add_spring(random, network, style, [mass, other], angle);
    }
    if style.has_dampers && random.chance(0.5) {
        let Sizes { mass: [lightest, _], stiffness: [softest, _], .. } = style.sizes;
        let other = random.sometimes(0.5, |random| random.whole(0, mass));
        network.dampers.push(Damper {
            name: format!("d{}", network.dampers.len()),
            between: [Some(mass), other.filter(|other| *other != mass)]
                .map(|end| end.map(Point::Mass)),
            direction: Line::Angle(random.between(-1.5, 1.5)),
            damping: (lightest * softest).sqrt() * random.wide(1e-3, 1.0),
        });
    }
}

fn add_spring(
    random: &mut Random,
    network: &mut Network,
    style: &Style,
    [mass, other]: [usize; 2],
    angle: f64,
) {
    let stiffness = style.sizes.stiffness(random);
    let preload = style.has_preloads.then(|| {
        let part = random.between(-0.3, 0.3);
        random.sometimes(0.4, |_| part * style.sizes.load / stiffness)
    });
    network.springs.push(Spring {
        name: format!("s{}", network.springs.len()),
        between: [Some(mass), (other < network.masses.len()).then_some(other)]
            .map(|end| end.map(Point::Mass)),
        direction: Line::Angle(angle),
        stiffness,
        preload: preload.flatten(),
    });
}

/// Gives the masses their initial values; gaps stay open or closed.
fn start(random: &mut Random, scene: &Scene, network: &mut Network, style: &Style) {
    for mass in &mut network.masses {
        for axis in 0..2 {
            let values = style.initial.values(random, &style.sizes);
            if !mass.locked[axis] {
                [mass.displacement[axis], mass.velocity[axis]] = values;
            }
        }
    }
    if scene.effects.detachment {
        apart::push(network, scene.slider.angle, random.unit() * style.sizes.displacement);
    } else {
        apart::keep_closed(network, scene.slider.angle);
    }
}
