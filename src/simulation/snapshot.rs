//! A saved simulation, in memory or as bytes that another process can resume from.
//!
//! Method and step are among the values: where a tolerance has chosen them, a snapshot brings its choice along.
//!
//! The bytes: a mark, the format's version, the fingerprint of the FMU they belong to, the values
//! (little-endian), and a CRC-32 of all that precedes it. No pointers, nothing of this machine.

use super::clock::Clock;
use super::signals::{self, Driven};
use super::{Reference, Simulation};
use crate::Error;
use crate::integrator::{Ledger, Motion};
use crate::model::LumpedModel;
use crate::scene::{Module, Scene, Signal, Structure};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Everything that a simulation needs to go on with the same doubles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Snapshot {
    scene: Scene,
    reference: Reference,
    motion: Motion,
    clock: Clock,
}

impl Snapshot {
    /// The values at the time of saving.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Gives it the signals of the scene that it belongs to, which its bytes go without.
    pub(crate) fn set_signals(&mut self, signals: &Arc<[Signal]>) {
        self.scene.signals.clone_from(signals);
    }

    /// Do all lists have the lengths that the scene asks for?
    fn is_consistent(&self) -> bool {
        let contacts = self.scene.contact_count();
        let dofs = self.scene.external_forces().count();
        self.motion.displacement.len() == dofs
            && self.motion.velocity.len() == dofs
            && self.motion.contacts.len() == contacts
            && self.motion.ledger.as_ref().map(Ledger::dofs)
                == self.scene.effects.energy.then_some(dofs)
            && self.reference.load.len() == dofs
            && self.reference.equilibrium.displacement.len() == dofs
            && self.reference.equilibrium.normal_force.len() == contacts
            && self.reference.equilibrium.friction_force.len() == contacts
    }
}

impl Simulation {
    /// Saves everything that is needed to go on from here.
    #[must_use]
    pub fn save(&self) -> Snapshot {
        Snapshot {
            scene: self.scene.clone(),
            reference: self.reference.clone(),
            motion: self.motion.clone(),
            clock: self.clock,
        }
    }

    /// Goes back to a snapshot. Where it has the same structure only the motion and the values
    /// are copied, as hosts that repeat steps do this often.
    ///
    /// # Errors
    /// As [`resume`](Self::resume); the simulation is then as it was.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<(), Error> {
        if !same_structure(&self.scene, &snapshot.scene) || !snapshot.is_consistent() {
            *self = Self::resume(snapshot.clone())?;
            return Ok(());
        }
        self.scene.clone_from(&snapshot.scene);
        self.reference.clone_from(&snapshot.reference);
        self.motion.clone_from(&snapshot.motion);
        self.clock = snapshot.clock;
        if let Some(driven) = &mut self.driven {
            driven.restart(&self.scene);
        }
        self.stale = super::Stale { drive: true, limit: true, contact_forces: true };
        Ok(())
    }

    /// Makes a simulation that goes on from a snapshot.
    ///
    /// # Errors
    /// The snapshot's values are impossible, which only a forged one can have.
    pub fn resume(snapshot: Snapshot) -> Result<Self, Error> {
        snapshot.scene.check()?;
        if !snapshot.is_consistent() {
            return Err(Error::saved_state("the saved state contradicts itself"));
        }
        let Snapshot { scene, reference, motion, clock } = snapshot;
        // Where signals make a value impossible, the next step says so.
        let mut driven = Driven::of(&scene);
        if let Some(driven) = &mut driven {
            let _ = driven.bring_to([clock.time(); 2], &scene, |_| {});
        }
        let model = LumpedModel::from(signals::acting(driven.as_ref(), &scene));
        Self::assemble(scene, driven, model, reference, motion, clock)
    }
}

/// Do two scenes differ at most in values that may change during a run, or that matter only at
/// its start?
fn same_structure(a: &Scene, b: &Scene) -> bool {
    let same = match (&a.structure, &b.structure) {
        (Structure::Ring(a), Structure::Ring(b)) => {
            let fixed = |module: &Module| (module.mass, module.stiffness);
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| fixed(a) == fixed(b))
        }
        (Structure::Network(a), Structure::Network(b)) => a.has_structure_of(b),
        _ => false,
    };
    let same_signals = Arc::ptr_eq(&a.signals, &b.signals) || a.signals == b.signals;
    same && same_signals
        && a.slider.angle == b.slider.angle
        && a.step == b.step
        && a.method == b.method
        && (a.effects, a.roles) == (b.effects, b.roles)
        && a.friction_law == b.friction_law
}

const MARK: [u8; 4] = *b"AMTN";
const VERSION: u8 = 4;
const GUID: usize = 38;
const HEADER: usize = MARK.len() + 1 + GUID;
const CHECKSUM: usize = 4;

/// Writes any saved value as bytes that belong to the FMU with this fingerprint.
pub(crate) fn to_bytes<T: Serialize>(value: &T, guid: &str) -> Vec<u8> {
    let mut bytes = Vec::from(MARK);
    bytes.push(VERSION);
    bytes.extend_from_slice(guid.as_bytes());
    let mut bytes = postcard::to_extend(value, bytes).expect("a vector takes all bytes");
    bytes.extend_from_slice(&crc32fast::hash(&bytes).to_le_bytes());
    bytes
}

/// Reads what [`to_bytes`] wrote for the same fingerprint.
///
/// # Errors
/// Says whether the bytes are damaged, of another version, or of another FMU.
pub(crate) fn from_bytes<T: for<'a> Deserialize<'a>>(bytes: &[u8], guid: &str) -> Result<T, Error> {
    let damaged = || Error::saved_state("the saved state is damaged or cut short");
    let end = bytes.len().checked_sub(CHECKSUM).filter(|&end| end >= HEADER).ok_or_else(damaged)?;
    let (content, checksum) = bytes.split_at(end);
    if crc32fast::hash(content).to_le_bytes() != checksum || !content.starts_with(&MARK) {
        return Err(damaged());
    }
    if content[MARK.len()] != VERSION {
        return Err(Error::saved_state(format!(
            "the saved state has version {}, this FMU reads version {VERSION}",
            content[MARK.len()]
        )));
    }
    if &content[MARK.len() + 1..HEADER] != guid.as_bytes() {
        return Err(Error::saved_state("the saved state is of another FMU"));
    }
    let (value, rest) = postcard::take_from_bytes(&content[HEADER..]).map_err(|_| damaged())?;
    if rest.is_empty() { Ok(value) } else { Err(damaged()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Selection, builtin};

    fn running() -> Simulation {
        let mut scene = builtin("set1").unwrap().scene();
        scene.modules_mut()[0].velocity[0] = 0.05;
        let mut simulation = Simulation::new(scene, 0.0).unwrap();
        simulation.advance_to(0.05).unwrap();
        simulation
    }

    fn guid() -> String {
        super::super::fingerprint(&"scene".into())
    }

    #[test]
    fn a_resumed_run_takes_the_same_doubles() {
        let mut straight = running();
        let bytes = to_bytes(&straight.save(), &guid());
        let mut resumed = Simulation::resume(from_bytes(&bytes, &guid()).unwrap()).unwrap();
        for time in [0.0503, 0.0777, 0.1] {
            straight.advance_to(time).unwrap();
            resumed.advance_to(time).unwrap();
        }
        assert!(straight.statistics().state_changes > 10);
        assert_eq!(straight.save(), resumed.save());
    }

    #[test]
    fn a_snapshot_brings_along_what_its_tolerance_chose() {
        let scene = |tolerance| {
            let mut scene = running().scene().clone();
            scene.selection = Selection::Auto { tolerance };
            (scene.experiment.stop_time, scene.experiment.output_interval) = (1e-3, 1e-4);
            scene
        };
        let mut coarse = Simulation::new(scene(0.1), 0.0).unwrap();
        coarse.advance_to(5e-4).unwrap();
        let mut other = Simulation::new(scene(1e-8), 0.0).unwrap();
        let chosen = |simulation: &Simulation| (simulation.scene().method, simulation.scene().step);
        assert_ne!(chosen(&coarse), chosen(&other));
        other.restore(&coarse.save()).unwrap();
        assert_eq!(chosen(&coarse), chosen(&other));
        for run in [&mut coarse, &mut other] {
            run.advance_to(1e-3).unwrap();
        }
        assert_eq!(coarse.save(), other.save());
    }

    #[test]
    fn going_back_to_a_snapshot_gives_the_same_doubles_again() {
        let mut simulation = running();
        let start = simulation.save();
        simulation.advance_to(0.08).unwrap();
        let end = simulation.save();
        assert_ne!(start, end);
        simulation.restore(&start).unwrap();
        assert_eq!(simulation.save(), start);
        simulation.advance_to(0.08).unwrap();
        assert_eq!(simulation.save(), end);
    }

    #[test]
    fn a_snapshot_of_other_masses_and_damping_brings_them_along() {
        let mut scene = running().scene().clone();
        scene.modules_mut()[0].mass[0] = 0.4;
        scene.damping.beta = 6e-5;
        let mut other = Simulation::new(scene, 0.0).unwrap();
        other.advance_to(0.02).unwrap();
        let mut simulation = running();
        simulation.restore(&other.save()).unwrap();
        for run in [&mut simulation, &mut other] {
            run.advance_to(0.04).unwrap();
        }
        assert_eq!(simulation.save(), other.save());
    }

    #[test]
    fn every_flipped_bit_and_every_truncation_is_refused() {
        let bytes = to_bytes(&running().save(), &guid());
        let read = |bytes: &[u8]| from_bytes::<Snapshot>(bytes, &guid());
        assert!(read(&bytes).is_ok());
        for length in 0..bytes.len() {
            assert!(read(&bytes[..length]).unwrap_err().is_saved_state());
        }
        for bit in 0..8 * bytes.len() {
            let mut flipped = bytes.clone();
            flipped[bit / 8] ^= 1 << (bit % 8);
            assert!(read(&flipped).unwrap_err().is_saved_state(), "bit {bit}");
        }
    }

    #[test]
    fn the_state_of_another_fmu_is_refused() {
        let bytes = to_bytes(&running().save(), &guid());
        let other = super::super::fingerprint(&"other".into());
        let error = from_bytes::<Snapshot>(&bytes, &other).unwrap_err();
        assert!(error.to_string().contains("another FMU"), "{error}");
    }
}
