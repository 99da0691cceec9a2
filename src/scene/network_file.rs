//! `[[mass]]`, `[[spring]]`, `[[damper]]` and `[[contact]]` of a scene file, and `[[initial]]` of its masses. This
//! module replaces the names of masses by their indices.

#[cfg(feature = "schema")]
use super::Rule;
use super::nearest::nearest;
use super::network_check::{NO_SUCH_MASS, quoted};
use super::{ContactDefinition, Damper, GROUND, Mass, Network, Problem, Spring};
use serde::Deserialize;
use std::collections::HashMap;
use std::f64::consts::FRAC_PI_2;

/// A mass of a network, which moves in the plane along its own axes.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct MassTable {
    /// Name of the mass: a letter, then letters, digits and _.
    name: String,
    /// Mass, kg.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::MASS.bounds()))]
    mass: f64,
    /// Counterclockwise rotation of the mass's axes x (right) and y (up), rad.
    #[serde(default)]
    angle: f64,
    /// Axes along which the mass cannot move.
    #[serde(default)]
    locked: Vec<Axis>,
    /// Constant load along the mass's axes, which is part of the equilibrium, N.
    #[serde(default)]
    force: [f64; 2],
}

/// An axis of a mass.
#[derive(Clone, Copy, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
enum Axis {
    /// Axis x, to the right.
    X,
    /// Axis y, upwards.
    Y,
}

/// A direction in space: "x", "y", or its angle against the horizontal in rad.
#[derive(Clone, Copy, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(untagged)]
enum DirectionValue {
    /// Direction along an axis.
    Along(Axis),
    /// Angle against the horizontal, counterclockwise, rad.
    At(f64),
}

impl DirectionValue {
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
    /// Name of the spring: a letter, then letters, digits and _.
    name: String,
    /// Names of the two masses that it joins, or of one mass and "ground".
    between: [String; 2],
    /// Direction in which the spring acts: "x", "y", or an angle against the horizontal in rad.
    direction: DirectionValue,
    /// Stiffness, N/m.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::STIFFNESS.bounds()))]
    stiffness: f64,
    /// Preload: displacement of the spring's second end along the direction, m; none by default.
    preload: Option<f64>,
}

/// A damper between two masses, or a mass and the ground.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct DamperTable {
    /// Name of the damper: a letter, then letters, digits and _.
    name: String,
    /// Names of the two masses that it joins, or of one mass and "ground".
    between: [String; 2],
    /// Direction in which the damper acts: "x", "y", or an angle against the horizontal in rad.
    direction: DirectionValue,
    /// Damping coefficient: force per velocity, N s/m.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::DAMPING.bounds()))]
    damping: f64,
}

/// A frictional contact of a mass with the slider, or with another mass.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct ContactTable {
    /// Name of the contact: a letter, then letters, digits and _.
    name: String,
    /// Name of the mass that slides.
    mass: String,
    /// Name of the mass that carries the sliding surface; the slider by default.
    on: Option<String>,
    /// Angle of the contact's tangent against the horizontal, rad; the slider's by default.
    angle: Option<f64>,
    /// Gap in the unloaded position, m; 0 by default.
    #[serde(default)]
    #[cfg_attr(feature = "schema", schemars(transform = Rule::OPENING.bounds()))]
    gap: f64,
    /// Velocity of the sliding surface along the tangent, m/s; the slider's by default.
    velocity: Option<f64>,
    /// Friction coefficient µ; the common one by default.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::FRICTION.bounds()))]
    friction: Option<f64>,
    /// Static friction coefficient µ_s ≥ µ while the contact does not slip; by default its own µ, or else the common µ_s.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::FRICTION.bounds()))]
    static_friction: Option<f64>,
}

impl ContactTable {
    /// `true` if the contact takes a value from the table: `[slider]`, or else `[friction]`.
    pub(super) fn needs(&self, table: &str) -> bool {
        match table {
            "slider" => self.angle.is_none() || self.velocity.is_none(),
            _ => self.friction.is_none(),
        }
    }
}

/// Initial displacement and velocity of one mass along its axes, relative to the equilibrium.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct MassInitial {
    /// Name of the mass, in a network.
    pub(super) mass: String,
    /// Displacement along the mass's axis x, m.
    #[serde(default)]
    x: f64,
    /// Displacement along the mass's axis y, m.
    #[serde(default)]
    y: f64,
    /// Velocity along the mass's axis x, m/s.
    #[serde(default)]
    vx: f64,
    /// Velocity along the mass's axis y, m/s.
    #[serde(default)]
    vy: f64,
}

impl MassInitial {
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
    /// Makes the network; a reference to an unknown mass becomes the index of a mass with a similar name, or
    /// `NOWHERE`.
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
            ContactDefinition {
                name: contact.name.clone(),
                mass: find("mass", &contact.mass),
                on: contact.on.as_deref().map(|on| find("on", on)),
                angle: contact.angle,
                gap: contact.gap,
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

/// Index of a mass that does not exist.
const NOWHERE: usize = usize::MAX;
/// Largest number of names that a help lists.
const MAX_LISTED: usize = 12;

/// Indices of the masses by name, and the problems of unknown names.
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

    /// Index of the mass of this name. If there is none, a problem is added and the index of the mass with a similar
    /// name is returned.
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

    /// Lists the names of the masses, for a help.
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

    /// Indices of the ends of a spring or damper; `None` for the ground.
    fn ends(&mut self, kind: &str, part: usize, names: &[String; 2]) -> [Option<usize>; 2] {
        let mut ends = [None; 2];
        for (j, name) in names.iter().enumerate().filter(|(_, name)| *name != GROUND) {
            let path = || format!("{kind}[{}].between[{}]", part + 1, j + 1);
            ends[j] = Some(self.place(path, name).unwrap_or(NOWHERE));
        }
        ends
    }
}
