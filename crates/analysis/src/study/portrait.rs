//! Phase portraits of a settled motion: the velocity of each contact's mass over its displacement, along the tangent
//! and along the normal (the paper's Fig. 3b and c).

use super::long_term::LongTermMotion;
use amontons::Error;
use amontons::model::LumpedModel;
use amontons::scene::Method;
use amontons::simulation::Simulation;
use serde::{Deserialize, Serialize};

/// Points for each period, and number of periods, of a periodic motion.
const PERIODIC: [f64; 2] = [400.0, 1.0];
/// Points for each period of the strongest line, and number of these periods, of any other motion.
const OTHER: [f64; 2] = [150.0, 20.0];

/// The orbits of a motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Portrait {
    /// The value of the parameter.
    pub value: f64,
    /// The ending of the motion.
    pub ending: LongTermMotion,
    /// One orbit for each contact.
    pub orbits: Vec<Orbit>,
}

/// The orbit of one contact: displacement from the equilibrium, m, and velocity, m/s, of the mass, or of one against
/// the other where two masses touch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Orbit {
    /// The contact's.
    pub name: String,
    /// The velocity of the slider there, m/s: that of a mass that sticks.
    pub slider_velocity: f64,
    /// Along the tangent.
    pub tangential: Vec<[f64; 2]>,
    /// Along the normal, away from the slider.
    pub normal: Vec<[f64; 2]>,
}

/// Goes on with a motion from where it has settled and records the orbits of the first contacts.
pub(super) fn portrait(
    simulation: &mut Simulation,
    value: f64,
    ending: &LongTermMotion,
    contacts: usize,
) -> Result<Portrait, Error> {
    let model = LumpedModel::from(simulation.scene());
    let mut orbits: Vec<Orbit> = (0..model.contacts.len().min(contacts))
        .map(|i| Orbit {
            name: simulation.scene().contact_name(i),
            slider_velocity: model.contacts[i].surface_velocity,
            tangential: Vec::new(),
            normal: Vec::new(),
        })
        .collect();
    let [points, periods] = if ending.period.is_some() { PERIODIC } else { OTHER };
    let period = ending.period.or(ending.frequency.map(|frequency| 1.0 / frequency));
    let mut interval = period.map_or(simulation.scene().step, |period| period / points);
    let step = simulation.scene().step;
    // The paper's scheme is at its best in whole steps.
    if simulation.scene().method == Method::ForwardIncrement && interval > step {
        interval = step * (interval / step).floor();
    }
    let start = simulation.time();
    let count = period.map_or(points, |period| (periods * period / interval).ceil());
    for row in (0_u32..).map(f64::from).take_while(|row| *row <= count) {
        if row > 0.0 {
            simulation.advance_to(start + row * interval)?;
        }
        let (displacement, velocity) = (simulation.displacement(), simulation.velocity());
        for (orbit, contact) in orbits.iter_mut().zip(&model.contacts) {
            let [tangent, normal] = [&contact.tangent, &contact.normal]
                .map(|direction| [direction.dot(displacement), direction.dot(velocity)]);
            orbit.tangential.push(tangent);
            orbit.normal.push(normal);
        }
    }
    Ok(Portrait { value, ending: ending.clone(), orbits })
}
