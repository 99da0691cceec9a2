//! `[[mass]]`, `[[spring]]`, `[[damper]]` and `[[contact]]` of a scene file, and `[[initial]]` of its
//! masses: names become places.

#[cfg(feature = "schema")]
use super::Rule;
use super::nearest::nearest;
use super::network_check::{NO_SUCH_MASS, quoted};
use super::{Damper, GROUND, Mass, Network, Problem, RubbingPlace, Spring};
use serde::Deserialize;
use std::collections::HashMap;
use std::f64::consts::FRAC_PI_2;

/// A mass of a network, which moves in the plane along axes of its own.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct MassTable {
    /// Its name: a letter, then letters, digits and _.
    name: String,
    /// How heavy it is, kg.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::MASS.bounds()))]
    mass: f64,
    /// How far its axes x (right) and y (up) are turned counterclockwise, rad.
    #[serde(default)]
    angle: f64,
    /// The axes along which it cannot move.
    #[serde(default)]
    locked: Vec<Axis>,
    /// Constant load along its axes, part of the equilibrium's, N.
    #[serde(default)]
    force: [f64; 2],
}

/// An axis.
#[derive(Clone, Copy, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
enum Axis {
    /// To the right.
    X,
    /// Up.
    Y,
}

/// A direction in space: "x", "y", or its angle against the horizontal in rad.
#[derive(Clone, Copy, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(untagged)]
enum Direction {
    /// Along an axis.
    Along(Axis),
    /// Angle against the horizontal, counterclockwise, rad.
    At(f64),
}

impl Direction {
    fn angle(self) -> f64 {
        match self {
            Self::Along(Axis::X) => 0.0,
            Self::Along(Axis::Y) => FRAC_PI_2,
            Self::At(angle) => angle,
        }
    }
}

/// A spring between two masses, or a mass and the ground.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct SpringTable {
    /// Its name: a letter, then letters, digits and _.
    name: String,
    /// What it joins: the names of two masses, or of one and "ground".
    between: [String; 2],
    /// The direction in which it acts: "x", "y", or an angle against the horizontal in rad.
    direction: Direction,
    /// Stiffness, N/m.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::STIFFNESS.bounds()))]
    stiffness: f64,
    /// How far its second end is moved along the direction, m; it has no preload unless given.
    preload: Option<f64>,
}

/// A damper between two masses, or a mass and the ground.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct DamperTable {
    /// Its name: a letter, then letters, digits and _.
    name: String,
    /// What it joins: the names of two masses, or of one and "ground".
    between: [String; 2],
    /// The direction in which it acts: "x", "y", or an angle against the horizontal in rad.
    direction: Direction,
    /// Force per velocity, N s/m.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::DAMPING.bounds()))]
    damping: f64,
}

/// A frictional contact of a mass with the slider, or with another mass.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct ContactTable {
    /// Its name: a letter, then letters, digits and _.
    name: String,
    /// The name of the mass that rubs.
    mass: String,
    /// The name of the mass on which it rubs; the slider unless given.
    on: Option<String>,
    /// Angle of its tangent against the horizontal, rad; the slider's unless given.
    angle: Option<f64>,
    /// Velocity of the sliding surface along the tangent, m/s; the slider's unless given.
    velocity: Option<f64>,
    /// Friction coefficient µ; the common one unless given.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::FRICTION.bounds()))]
    friction: Option<f64>,
    /// Static friction coefficient µ_s ≥ µ, while the contact does not slip; the common one unless given,
    /// or µ where that is given.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::FRICTION.bounds()))]
    static_friction: Option<f64>,
}

impl ContactTable {
    /// Does it take a value from the `[slider]`, or else from `[friction]`?
    pub(super) fn needs(&self, table: &str) -> bool {
        match table {
            "slider" => self.angle.is_none() || self.velocity.is_none(),
            _ => self.friction.is_none(),
        }
    }
}

/// An initial displacement or velocity of one mass along its axes, relative to the equilibrium.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct Initial {
    /// The name of the mass, in a network.
    pub(super) mass: String,
    /// Displacement along its axis x, m.
    #[serde(default)]
    x: f64,
    /// Displacement along its axis y, m.
    #[serde(default)]
    y: f64,
    /// Velocity along its axis x, m/s.
    #[serde(default)]
    vx: f64,
    /// Velocity along its axis y, m/s.
    #[serde(default)]
    vy: f64,
}

impl Initial {
    /// Gives the mass its initial displacement and velocity.
    pub(super) fn apply(&self, mass: &mut Mass) {
        mass.displacement = [self.x, self.y];
        mass.velocity = [self.vx, self.vy];
    }
}

/// The tables of a network.
pub(super) struct Tables<'a> {
    pub(super) masses: &'a [MassTable],
    pub(super) springs: &'a [SpringTable],
    pub(super) dampers: &'a [DamperTable],
    pub(super) contacts: &'a [ContactTable],
}

impl Tables<'_> {
    /// The network; names that no mass has become places where none is.
    pub(super) fn network(&self, names: &mut Names<'_>) -> Network {
        let masses = self.masses.iter().map(MassTable::mass).collect();
        let springs = self.springs.iter().enumerate().map(|(i, spring)| Spring {
            name: spring.name.clone(),
            between: names.ends("spring", i, &spring.between),
            direction: spring.direction.angle(),
            stiffness: spring.stiffness,
            preload: spring.preload,
        });
        let springs = springs.collect();
        let dampers = self.dampers.iter().enumerate().map(|(i, damper)| Damper {
            name: damper.name.clone(),
            between: names.ends("damper", i, &damper.between),
            direction: damper.direction.angle(),
            damping: damper.damping,
        });
        let dampers = dampers.collect();
        let contacts = self.contacts.iter().enumerate().map(|(i, contact)| {
            let mut find = |key: &str, name: &str| {
                names.place(|| format!("contact[{}].{key}", i + 1), name).unwrap_or(NOWHERE)
            };
            RubbingPlace {
                name: contact.name.clone(),
                mass: find("mass", &contact.mass),
                on: contact.on.as_deref().map(|on| find("on", on)),
                angle: contact.angle,
                velocity: contact.velocity,
                friction: contact.friction,
                static_friction: contact.static_friction,
            }
        });
        Network { masses, springs, dampers, contacts: contacts.collect() }
    }
}

impl MassTable {
    fn mass(&self) -> Mass {
        let mut locked = [false; 2];
        for axis in &self.locked {
            locked[*axis as usize] = true;
        }
        Mass {
            name: self.name.clone(),
            mass: self.mass,
            angle: self.angle,
            locked,
            load: self.force,
            force: [0.0; 2],
            displacement: [0.0; 2],
            velocity: [0.0; 2],
        }
    }
}

/// A place where no mass stands.
const NOWHERE: usize = usize::MAX;
/// The most names that a help lists.
const MAX_LISTED: usize = 12;

/// Where the masses stand, by name, and the names that stand for none.
pub(super) struct Names<'a> {
    places: HashMap<&'a str, usize>,
    masses: &'a [MassTable],
    pub(super) problems: Vec<Problem>,
}

impl<'a> Names<'a> {
    pub(super) fn of(masses: &'a [MassTable]) -> Self {
        let mut places = HashMap::new();
        for (place, mass) in masses.iter().enumerate() {
            places.entry(&*mass.name).or_insert(place);
        }
        Self { places, masses, problems: Vec::new() }
    }

    /// The place of a mass: where there is none of this name, of that which is likely to be meant.
    pub(super) fn place(&mut self, path: impl FnOnce() -> String, name: &str) -> Option<usize> {
        if let Some(&place) = self.places.get(name) {
            return Some(place);
        }
        let meant = self.meant(name);
        let help = match meant {
            Some(place) => format!("did you mean {}?", quoted(&self.masses[place].name)),
            None => self.list(),
        };
        self.problems.push(Problem::new(path(), NO_SUCH_MASS).of(quoted(name)).help(help));
        meant
    }

    fn meant(&self, name: &str) -> Option<usize> {
        let names = self.masses.iter().map(|mass| &*mass.name);
        nearest(name, names).map(|name| self.places[name])
    }

    /// The names that there are.
    fn list(&self) -> String {
        let mut names: Vec<(usize, &str)> =
            self.places.iter().map(|(&name, &place)| (place, name)).collect();
        names.sort_unstable();
        let names: Vec<&str> = names.into_iter().take(MAX_LISTED).map(|(_, name)| name).collect();
        let more = if self.places.len() > MAX_LISTED { ", …" } else { "" };
        match names[..] {
            [one] => format!("the only mass is {one}"),
            _ => format!("the masses are {}{more}", names.join(", ")),
        }
    }

    /// The ends of a spring or damper.
    fn ends(&mut self, kind: &str, part: usize, names: &[String; 2]) -> [Option<usize>; 2] {
        let mut ends = [None; 2];
        for (j, name) in names.iter().enumerate().filter(|(_, name)| *name != GROUND) {
            let path = || format!("{kind}[{}].between[{}]", part + 1, j + 1);
            ends[j] = Some(self.place(path, name).unwrap_or(NOWHERE));
        }
        ends
    }
}
