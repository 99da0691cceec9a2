//! `[[mass]]`, `[[spring]]`, `[[damper]]` and `[[contact]]` of a scene file: names become places.

use super::file::Initial;
use super::rule::Problems;
use super::{Damper, GROUND, Mass, Network, RubbingPlace, Spring};
use crate::Error;
use serde::de::{self, Deserializer, Visitor};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::f64::consts::FRAC_PI_2;
use std::fmt;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MassTable {
    name: String,
    mass: f64,
    #[serde(default)]
    angle: f64,
    #[serde(default)]
    locked: Vec<Axis>,
    #[serde(default)]
    force: [f64; 2],
}

/// An axis of a mass.
#[derive(Clone, Copy, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
enum Axis {
    X,
    Y,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SpringTable {
    name: String,
    between: [String; 2],
    direction: Direction,
    stiffness: f64,
    #[serde(default)]
    preload: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DamperTable {
    name: String,
    between: [String; 2],
    direction: Direction,
    damping: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ContactTable {
    name: String,
    mass: String,
    on: Option<String>,
    angle: Option<f64>,
    velocity: Option<f64>,
    friction: Option<f64>,
}

/// A direction's angle, rad: `"x"`, `"y"`, or a number.
#[derive(Clone, Copy)]
struct Direction(f64);

impl<'de> Deserialize<'de> for Direction {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct AxisOrAngle;

        impl Visitor<'_> for AxisOrAngle {
            type Value = Direction;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("\"x\", \"y\", or an angle in rad")
            }

            fn visit_str<E: de::Error>(self, text: &str) -> Result<Direction, E> {
                match text {
                    "x" => Ok(Direction(0.0)),
                    "y" => Ok(Direction(FRAC_PI_2)),
                    _ => Err(E::invalid_value(de::Unexpected::Str(text), &self)),
                }
            }

            fn visit_f64<E: de::Error>(self, angle: f64) -> Result<Direction, E> {
                Ok(Direction(angle))
            }

            fn visit_i64<E: de::Error>(self, angle: i64) -> Result<Direction, E> {
                let angle = i32::try_from(angle).map_err(|_| E::custom("too large an angle"))?;
                Ok(Direction(f64::from(angle)))
            }
        }

        deserializer.deserialize_any(AxisOrAngle)
    }
}

/// The tables of a network.
type Tables<'a> = (&'a [MassTable], &'a [SpringTable], &'a [DamperTable], &'a [ContactTable]);

/// The network of a file; all names that stand for no mass are listed.
pub(super) fn network(tables: Tables<'_>, initial: &[Initial]) -> Result<Network, Error> {
    let (masses, springs, dampers, contacts) = tables;
    let mut names = Names { places: HashMap::new(), problems: Problems::default() };
    for (place, mass) in masses.iter().enumerate() {
        names.places.entry(&mass.name).or_insert(place);
    }
    let mut network = Network {
        masses: masses.iter().map(MassTable::mass).collect(),
        springs: springs
            .iter()
            .map(|spring| Spring {
                name: spring.name.clone(),
                between: names.ends("spring", &spring.name, &spring.between),
                direction: spring.direction.0,
                stiffness: spring.stiffness,
                preload: spring.preload,
            })
            .collect(),
        dampers: dampers
            .iter()
            .map(|damper| Damper {
                name: damper.name.clone(),
                between: names.ends("damper", &damper.name, &damper.between),
                direction: damper.direction.0,
                damping: damper.damping,
            })
            .collect(),
        contacts: contacts
            .iter()
            .map(|contact| {
                let key = |key: &str| format!("contact.{}.{key}", contact.name);
                RubbingPlace {
                    name: contact.name.clone(),
                    mass: names.mass(|| key("mass"), &contact.mass).unwrap_or(0),
                    on: contact.on.as_ref().and_then(|on| names.mass(|| key("on"), on)),
                    angle: contact.angle,
                    velocity: contact.velocity,
                    friction: contact.friction,
                }
            })
            .collect(),
    };
    for values in initial {
        if values.module.is_some() || values.of_module().iter().flatten().any(Option::is_some) {
            names
                .problems
                .add("[[initial]] of a network gives its mass, and any of x, y, vx, vy".to_owned());
            continue;
        }
        let name = values.mass.as_deref().unwrap_or_default();
        if let Some(place) = names.mass(|| "initial.mass".to_owned(), name) {
            let [x, y, vx, vy] = values.along_axes().map(Option::unwrap_or_default);
            network.masses[place].displacement = [x, y];
            network.masses[place].velocity = [vx, vy];
        }
    }
    names.problems.into_result()?;
    Ok(network)
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

/// Where the masses stand, by name.
struct Names<'a> {
    places: HashMap<&'a str, usize>,
    problems: Problems,
}

impl Names<'_> {
    /// The place of a mass.
    fn mass(&mut self, key: impl FnOnce() -> String, name: &str) -> Option<usize> {
        let place = self.places.get(name).copied();
        if place.is_none() {
            self.problems.add(format!("{} = \"{name}\": there is no mass of that name", key()));
        }
        place
    }

    /// The ends of a spring or damper.
    fn ends(&mut self, kind: &str, part: &str, names: &[String; 2]) -> [Option<usize>; 2] {
        let mut ends = [None; 2];
        for (end, name) in ends.iter_mut().zip(names).filter(|(_, name)| *name != GROUND) {
            *end = self.mass(|| format!("{kind}.{part}.between"), name);
        }
        ends
    }
}
