//! Everything that there is to see of a motion, as lines of text.

use amontons::contact::{ContactForce, ContactState};
use amontons::integrator::{Energy, Statistics};
use amontons::simulation::Simulation;
use std::fmt::Write as _;

/// A double by its bits, and its first digits for people.
fn double(value: f64) -> String {
    format!("{:016x} {value:.3e}", value.to_bits())
}

/// The present instant: counts first, then a line a double. Displacements and velocities have the names of the degrees
/// of freedom.
pub fn instant(simulation: &mut Simulation) -> String {
    let mut text = String::new();
    let _ = writeln!(text, "at {} s", simulation.time());
    let _ = writeln!(text, "{}", counts(simulation.statistics()));
    let names = simulation.scene().dof_names();
    for (what, values) in [("x", simulation.displacement()), ("v", simulation.velocity())] {
        for (name, value) in names.iter().zip(values) {
            let _ = writeln!(text, "{what} {name} {}", double(*value));
        }
    }
    let over_step = simulation.contact_states().to_vec();
    match simulation.contact_forces().map(<[_]>::to_vec) {
        Ok(forces) => {
            for (contact, (before, force)) in over_step.into_iter().zip(forces).enumerate() {
                let name = simulation.scene().contact_name(contact);
                let ContactForce { state, normal_force, friction_force, slip_velocity } = force;
                let _ = writeln!(text, "{name} {before} over the step, {state} now");
                for (what, value) in
                    [("N", normal_force), ("T", friction_force), ("slip", slip_velocity)]
                {
                    let _ = writeln!(text, "{what} {name} {}", double(value));
                }
            }
        }
        Err(error) => {
            let _ = writeln!(text, "no forces: {error}");
        }
    }
    if let Some(energy) = simulation.energy() {
        let Energy { kinetic, elastic, damping, friction, impact, slider, forces, residual } =
            energy;
        for (what, value) in [
            ("kinetic", kinetic),
            ("elastic", elastic),
            ("damping", damping),
            ("friction", friction),
            ("impact", impact),
            ("slider", slider),
            ("forces", forces),
            ("residual", residual),
        ] {
            let _ = writeln!(text, "energy {what} {}", double(value));
        }
    }
    text
}

/// All counts that are not zero.
fn counts(statistics: Statistics) -> String {
    let Statistics { steps, entered, touch_downs, ended_hops, events, sweeps, .. } = statistics;
    let Statistics { most_sweeps, reversed_slips, pulled_contacts, other_solutions, .. } =
        statistics;
    let mut text = format!("steps {steps}");
    let entered =
        ContactState::ALL.map(|state| format!("entered {state}")).into_iter().zip(entered);
    let others = [
        ("touch-downs", touch_downs),
        ("ended hops", ended_hops),
        ("events", events),
        ("sweeps", sweeps),
        ("most sweeps", most_sweeps),
        ("reversed slips", reversed_slips),
        ("pulled contacts", pulled_contacts),
        ("other solutions", other_solutions),
    ];
    let others = others.into_iter().map(|(what, count)| (what.to_owned(), count));
    for (what, count) in entered.chain(others).filter(|(_, count)| *count > 0) {
        let _ = write!(text, ", {what} {count}");
    }
    text
}
