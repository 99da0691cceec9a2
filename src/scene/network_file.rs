//! `[[mass]]`, `[[spring]]`, `[[damper]]` and `[[contact]]` of a scene file, and `[[initial]]` of its masses. This
//! module replaces the names of points by their places.

#[cfg(feature = "schema")]
use super::Rule;
use super::names::{NOWHERE, Names};
use super::{ContactDefinition, Damper, Line, Mass, Network, Problem, Spring};
use serde::Deserialize;
use std::f64::consts::FRAC_PI_2;

/// A mass of a network, which moves in the plane along its own axes.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct MassTable {
    /// Name of the mass: a letter, then letters, digits and _.
    pub(super) name: String,
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

/// An axis of space.
#[derive(Clone, Copy, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
enum SpaceAxis {
    /// Axis x, to the right.
    X,
    /// Axis y, upwards.
    Y,
    /// Axis z, towards the viewer; masses do not move along it.
    Z,
}

/// A direction in space: "x", "y", "z", its angle against the horizontal in rad, or its components.
#[derive(Clone, Copy, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(untagged)]
enum DirectionValue {
    /// Direction along an axis.
    Along(SpaceAxis),
    /// Angle against the horizontal, counterclockwise, rad.
    At(f64),
    /// Components along x, y and z, of any length.
    Of([f64; 3]),
}

impl DirectionValue {
    fn line(self) -> Line {
        match self {
            Self::Along(SpaceAxis::X) => Line::Angle(0.0),
            Self::Along(SpaceAxis::Y) => Line::Angle(FRAC_PI_2),
            Self::Along(SpaceAxis::Z) => Line::Vector([0.0, 0.0, 1.0]),
            Self::At(angle) => Line::Angle(angle),
            Self::Of(vector) => Line::Vector(vector),
        }
    }
}

/// A spring between two points, or a point and the ground.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct SpringTable {
    /// Name of the spring: a letter, then letters, digits and _.
    name: String,
    /// Names of the two points that it joins, or of one and "ground"; a point is a mass, "pad", or a node of a superelement,
    /// "pad.17".
    between: [String; 2],
    /// Direction in which the spring acts: "x", "y", "z", an angle against the horizontal in rad, or components.
    direction: DirectionValue,
    /// Stiffness, N/m.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::STIFFNESS.bounds()))]
    stiffness: f64,
    /// Preload: displacement of the spring's second end along the direction, m; none by default.
    preload: Option<f64>,
}

/// A damper between two points, or a point and the ground.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct DamperTable {
    /// Name of the damper: a letter, then letters, digits and _.
    name: String,
    /// Names of the two points that it joins, or of one and "ground"; a point is a mass, "pad", or a node of a superelement,
    /// "pad.17".
    between: [String; 2],
    /// Direction in which the damper acts: "x", "y", "z", an angle against the horizontal in rad, or components.
    direction: DirectionValue,
    /// Damping coefficient: force per velocity, N s/m.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::DAMPING.bounds()))]
    damping: f64,
}

/// A frictional contact of a point with the slider, or with another point.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct ContactTable {
    /// Name of the contact: a letter, then letters, digits and _.
    name: String,
    /// Name of the point that slides: a mass, "pad", or a node of a superelement, "pad.17".
    mass: String,
    /// Name of the point that carries the sliding surface; the slider by default.
    on: Option<String>,
    /// Angle of the contact's tangent against the horizontal, rad; the slider's by default.
    angle: Option<f64>,
    /// Outward normal of the surface that the point slides on, of any length; with `tangent` in place of `angle`.
    normal: Option<[f64; 3]>,
    /// Tangent: direction in which the surface slides, of any length; with `normal` in place of `angle`.
    tangent: Option<[f64; 3]>,
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
            direction: spring.direction.line(),
            stiffness: spring.stiffness,
            preload: spring.preload,
        });
        let springs = springs.collect();
        let dampers = self.dampers.iter().enumerate().map(|(i, damper)| Damper {
            name: damper.name.clone(),
            between: names.ends("damper", i, &damper.between),
            direction: damper.direction.line(),
            damping: damper.damping,
        });
        let dampers = dampers.collect();
        let contacts = self.contacts.iter().enumerate().map(|(i, contact)| {
            let mut find = |key: &str, name: &str| {
                names.point(|| format!("contact[{}].{key}", i + 1), name).unwrap_or(NOWHERE)
            };
            let mass = find("mass", &contact.mass);
            let on = contact.on.as_deref().map(|on| find("on", on));
            let given = (contact.normal, contact.tangent, contact.angle);
            ContactDefinition {
                name: contact.name.clone(),
                set: None,
                mass,
                on,
                angle: contact.angle,
                axes: axes(given, || format!("contact[{}]", i + 1), &mut names.problems),
                gap: contact.gap,
                velocity: contact.velocity,
                friction: contact.friction,
                static_friction: contact.static_friction,
                is_shown: true,
            }
        });
        Network { masses, springs, dampers, contacts: contacts.collect(), ..Network::default() }
    }
}

/// Normal and tangent of a contact, which stand together and in place of an angle.
pub(super) fn axes(
    (normal, tangent, angle): (Option<[f64; 3]>, Option<[f64; 3]>, Option<f64>),
    path: impl Fn() -> String,
    problems: &mut Vec<Problem>,
) -> Option<[[f64; 3]; 2]> {
    let both = normal.zip(tangent);
    if both.is_some() && angle.is_some() {
        let message = "has both an `angle` and a `normal` with a `tangent`";
        problems.push(Problem::new(path(), message).help("leave one of them out"));
    } else if both.is_none() && (normal.is_some() || tangent.is_some()) {
        let lacking = if normal.is_none() { "normal" } else { "tangent" };
        let message = format!("needs a `{lacking}` too: normal and tangent are given together");
        problems.push(Problem::new(path(), message));
    }
    both.map(|(normal, tangent)| [normal, tangent])
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
