//! A saved simulation, in memory or as bytes that another process can resume from.
//!
//! Method and step are among the values: a snapshot includes those that a tolerance has chosen.
//!
//! The bytes hold a magic number, the version of the format, the fingerprint of the FMU to which they belong, the
//! values (little-endian), and a CRC-32 of all that precedes it. They contain no pointers and do not depend on the
//! machine. The fingerprint stands for the scene, of which only the values of parameters and inputs are saved.

use super::clock::Clock;
use super::rates::{SavedRate, belong_to};
use super::signals::DrivenInputs;
use super::{Parameters, ReferencePosition, Simulation, are_finite};
use crate::Error;
use crate::integrator::{Ledger, Motion};
use crate::model::{Equilibrium, LumpedModel};
use crate::scene::Scene;
use serde::{Deserialize, Serialize};

/// Everything that a simulation needs to continue with the same doubles.
///
/// ```
/// use amontons::scene::builtin;
/// use amontons::simulation::Simulation;
///
/// let scene = builtin("set1").expect("a built-in scene").scene();
/// let mut simulation = Simulation::new(scene, 0.0)?;
/// simulation.advance_to(1e-3)?;
/// let saved = simulation.save();
/// simulation.advance_to(2e-3)?;
/// let first = simulation.displacement().to_vec();
/// simulation.restore(&saved)?;
/// simulation.advance_to(2e-3)?;
/// assert_eq!(simulation.displacement(), first);
/// # Ok::<(), amontons::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    nominal: Parameters,
    progress: Progress,
}

/// Progress of a run: all of a snapshot except the values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Progress {
    reference: ReferencePosition,
    motion: Motion,
    clock: Clock,
    rates: Vec<SavedRate>,
}

impl Snapshot {
    /// The nominal values at the time of saving.
    pub(crate) fn nominal(&self) -> &Parameters {
        &self.nominal
    }

    /// A run of a scene with these values and this progress. The progress must come from this scene, up to its
    /// values: [`Simulation::restore`] checks it.
    #[must_use]
    pub fn new(nominal: Parameters, progress: Progress) -> Self {
        Self { nominal, progress }
    }

    /// Progress of the run, without the values.
    #[must_use]
    pub fn into_progress(self) -> Progress {
        self.progress
    }

    /// Progress of the run.
    pub(crate) fn progress(&self) -> &Progress {
        &self.progress
    }

    /// Refuses a snapshot that no run of the scene leads to: values that break a rule, lists of another length,
    /// states that the law of contact excludes, counts and times that do not match. `failed` is `true` after a step
    /// that failed, when the motion may have any value.
    ///
    /// # Errors
    /// Returns an error that says what is wrong; only a forged snapshot causes one.
    pub(crate) fn check(&self, failed: bool) -> Result<(), Error> {
        self.nominal.check()?;
        let refuse = |what: &str| {
            Err(Error::saved_state(format!("the saved state contradicts itself: {what}")))
        };
        let scene = self.nominal.scene();
        if !self.is_consistent(&scene) {
            return refuse("its lists do not have the lengths that the scene requires");
        }
        let Progress { reference, motion, clock, rates } = &self.progress;
        let Equilibrium { displacement, normal_force, friction_force, gap } =
            &reference.equilibrium;
        if [displacement, normal_force, friction_force, gap, &reference.load]
            .into_iter()
            .any(|list| !are_finite(list))
        {
            return refuse("its equilibrium has a number that is not finite");
        }
        let is_finite = are_finite(&motion.displacement) && are_finite(&motion.velocity);
        if !failed && !is_finite {
            return refuse("its motion has a number that is not finite");
        }
        let law = scene.contact_law();
        if let Some(i) = motion.contacts.iter().position(|state| !law.allows(*state)) {
            let name = scene.contact_name(i);
            return refuse(&format!(
                "{name} is in state {}, which the law of contact excludes",
                motion.contacts[i]
            ));
        }
        if gap.iter().any(|gap| *gap < 0.0) {
            return refuse("a contact is inside its surface in its equilibrium");
        }
        if !law.detachment && gap.iter().any(|gap| *gap > 0.0) {
            return refuse(
                "a contact is open in its equilibrium, but contacts cannot open in this scene",
            );
        }
        if !law.follows_size() && motion.pulls.contains(&true) {
            return refuse("a contact pulls, which the law of contact excludes");
        }
        if !motion.statistics.are_countable() {
            return refuse("its counters are larger than a run can make them");
        }
        if !belong_to(rates, &self.nominal) {
            return refuse("its rates do not belong to inputs");
        }
        if !clock.is_possible(scene.step) {
            return refuse("its time does not match its number of steps");
        }
        Ok(())
    }

    /// `true` if all lists have the lengths that the scene requires.
    fn is_consistent(&self, scene: &Scene) -> bool {
        let contacts = scene.contact_count();
        let dofs = scene.external_forces().count();
        let Progress { reference, motion, .. } = &self.progress;
        motion.displacement.len() == dofs
            && motion.velocity.len() == dofs
            && motion.contacts.len() == contacts
            && motion.pulls.len() == contacts
            && motion.ledger.as_ref().map(Ledger::dofs) == scene.effects.energy.then_some(dofs)
            && reference.load.len() == dofs
            && reference.equilibrium.displacement.len() == dofs
            && reference.equilibrium.normal_force.len() == contacts
            && reference.equilibrium.friction_force.len() == contacts
            && reference.equilibrium.gap.len() == contacts
    }
}

impl Simulation {
    /// Saves everything that is needed to continue from here.
    #[must_use]
    pub fn save(&self) -> Snapshot {
        Snapshot {
            nominal: self.nominal.clone(),
            progress: Progress {
                reference: self.reference.clone(),
                motion: self.motion.clone(),
                clock: self.clock,
                rates: self.saved_rates(),
            },
        }
    }

    /// Restores a snapshot. If it has the same structure, only the motion and the values are copied, since hosts that
    /// repeat steps restore often.
    ///
    /// # Errors
    /// Returns an error if the snapshot cannot be resumed ([`resume`](Self::resume)); the simulation is then unchanged.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<(), Error> {
        let can_take = snapshot.nominal.differ_in_motion_alone(&self.nominal)
            && snapshot.is_consistent(&self.scene)
            && snapshot.progress.reference.equilibrium.gap == self.reference.equilibrium.gap;
        if !can_take {
            *self = Self::resume(snapshot.clone())?;
            return Ok(());
        }
        self.nominal.clone_from(&snapshot.nominal);
        self.nominal.write_to(&mut self.scene);
        let Progress { reference, motion, clock, rates } = &snapshot.progress;
        self.reference.clone_from(reference);
        self.motion.clone_from(motion);
        self.clock = *clock;
        self.take_over_rates(rates);
        self.stale = super::Stale { inputs: true, limit: true, contact_forces: true };
        Ok(())
    }

    /// Makes a simulation that continues from a snapshot.
    ///
    /// # Errors
    /// Returns an error if the snapshot's values are impossible, which only a forged one can have.
    pub fn resume(snapshot: Snapshot) -> Result<Self, Error> {
        let mut scene = snapshot.nominal.scene();
        scene.check()?;
        if !snapshot.is_consistent(&scene) {
            return Err(Error::saved_state(
                "the saved state contradicts itself: its lists do not have the lengths that the scene requires",
            ));
        }
        let Snapshot { nominal, progress } = snapshot;
        let Progress { reference, motion, clock, rates } = progress;
        // If signals make a value impossible, the next step returns the error.
        let mut driven = DrivenInputs::of(&scene, &nominal);
        if let Some(driven) = &mut driven {
            let _ = driven.bring_to([clock.time(); 2], &nominal, &mut scene, |_| {});
        }
        let mut model = LumpedModel::from(&scene);
        model.count_from(&reference.equilibrium);
        let mut resumed = Self::assemble(scene, nominal, driven, model, reference, motion, clock)?;
        resumed.take_over_rates(&rates);
        Ok(resumed)
    }
}

const MARK: [u8; 4] = *b"AMTN";
const VERSION: u8 = 12;
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

/// Reads a value that [`to_bytes`] wrote for the same fingerprint.
///
/// # Errors
/// Returns an error that says whether the bytes are damaged, of another version, or of another FMU.
pub(crate) fn from_bytes<T: for<'a> Deserialize<'a>>(bytes: &[u8], guid: &str) -> Result<T, Error> {
    let damaged = || Error::saved_state("the saved state is damaged or cut short");
    let end = bytes.len().checked_sub(CHECKSUM).filter(|&end| end >= HEADER).ok_or_else(damaged)?;
    let (content, checksum) = bytes.split_at(end);
    if crc32fast::hash(content).to_le_bytes() != checksum || !content.starts_with(&MARK) {
        return Err(damaged());
    }
    if content[MARK.len()] != VERSION {
        return Err(Error::saved_state(format!(
            "the saved state has version {}, but this FMU reads version {VERSION}",
            content[MARK.len()]
        )));
    }
    if &content[MARK.len() + 1..HEADER] != guid.as_bytes() {
        return Err(Error::saved_state("the saved state belongs to another FMU"));
    }
    let (value, rest) = postcard::take_from_bytes(&content[HEADER..]).map_err(|_| damaged())?;
    if rest.is_empty() { Ok(value) } else { Err(damaged()) }
}

#[cfg(test)]
mod tests {
    use super::super::{ParameterValues, variables};
    use super::*;
    use crate::scene::{BUILTIN, Builtin, ForceRole, Selection, builtin};
    use std::collections::BTreeSet;

    fn set1() -> Scene {
        builtin("set1").unwrap().scene()
    }

    fn running() -> Simulation {
        let mut scene = set1();
        scene.modules_mut()[0].velocity[0] = 0.05;
        let mut simulation = Simulation::new(scene, 0.0).unwrap();
        simulation.advance_to(0.05).unwrap();
        simulation
    }

    /// Changes a nominal value of a snapshot.
    fn set(snapshot: &mut Snapshot, name: &str, value: f64) {
        let place = snapshot.nominal.iter().position(|(variable, _)| variable.name == name);
        *snapshot.nominal.number_mut(place.unwrap()) = value;
    }

    fn guid() -> String {
        super::super::fingerprint(&"scene".into())
    }

    /// A snapshot as bytes of the FMU of a scene.
    fn write(snapshot: &Snapshot) -> Vec<u8> {
        to_bytes(&(snapshot.nominal.values(), &snapshot.progress), &guid())
    }

    /// Reads a snapshot from bytes of the FMU of a scene.
    fn read(bytes: &[u8], original: &Scene) -> Result<Snapshot, Error> {
        let (values, progress) = from_bytes(bytes, &guid())?;
        Ok(Snapshot::new(Parameters::of(original.clone()).with_values(values)?, progress))
    }

    #[test]
    fn a_resumed_run_takes_the_same_doubles() {
        let mut straight = running();
        let bytes = write(&straight.save());
        let mut resumed = Simulation::resume(read(&bytes, &set1()).unwrap()).unwrap();
        for time in [0.0503, 0.0777, 0.1] {
            straight.advance_to(time).unwrap();
            resumed.advance_to(time).unwrap();
        }
        assert!(straight.statistics().state_changes() > 10);
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
    fn what_no_run_leads_to_is_refused_with_its_reason() {
        use crate::contact::ContactState;
        use crate::scene::Method;

        type Forge = fn(&mut Snapshot);
        let forgeries: &[(Forge, &str)] = &[
            (|s| set(s, "module[2].m1", -0.3), "module[2].m1 = -0.3: must be above zero"),
            (
                |s| set(s, "friction.coefficient", f64::NAN),
                "friction.coefficient = NaN: must be a finite",
            ),
            (|s| set(s, "damping.beta", -1.0), "damping.beta = -1: must not be negative"),
            (|s| set(s, "integrator.step", 0.0), "integrator.step = 0: must be above zero"),
            (|s| s.progress.motion.displacement.push(0.0), "its lists do not have the lengths"),
            (|s| s.progress.motion.velocity.clear(), "its lists do not have the lengths"),
            (|s| s.progress.reference.load.truncate(1), "its lists do not have the lengths"),
            (|s| s.progress.motion.contacts.truncate(1), "its lists do not have the lengths"),
            (
                |s| s.progress.motion.velocity[3] = f64::INFINITY,
                "its motion has a number that is not finite",
            ),
            (
                |s| s.progress.reference.load[0] = f64::NAN,
                "its equilibrium has a number that is not finite",
            ),
            (
                |s| s.progress.motion.statistics.entered[2] = u64::MAX,
                "larger than a run can make them",
            ),
            (|s| s.progress.motion.statistics.steps = u64::MAX, "larger than a run can make them"),
            (
                |s| s.progress.clock = Clock::at(f64::NAN),
                "its time does not match its number of steps",
            ),
            // A thousand million steps would have to be made up for.
            (|s| set(s, "integrator.step", 1e-9), "its time does not match its number of steps"),
        ];
        let good = running().save();
        good.check(false).unwrap();
        for (forge, words) in forgeries {
            let mut forged = good.clone();
            forge(&mut forged);
            let error = forged.check(false).unwrap_err();
            assert!(error.is_saved_state() && error.to_string().contains(words), "{error}");
        }
        // A motion after a failed step may have any value.
        let mut failed = good;
        failed.progress.motion.displacement[0] = f64::NAN;
        failed.check(true).unwrap();
        // Without sticking this state does not exist.
        let mut scene = set1();
        scene.effects.sticking = false;
        for method in [Method::ForwardIncrement, Method::EventDriven] {
            let scene = Scene { method, ..scene.clone() };
            let mut forged = Simulation::new(scene.clone(), 0.0).unwrap().save();
            forged.check(false).unwrap();
            forged.progress.motion.contacts[1] = ContactState::Stick;
            let error = forged.check(false).unwrap_err().to_string();
            assert!(
                error.contains("contact[2] is in state St, which the law of contact excludes"),
                "{error}"
            );
        }
    }

    #[test]
    fn every_flipped_bit_and_every_truncation_is_refused() {
        let bytes = write(&running().save());
        let scene = set1();
        let read = |bytes: &[u8]| read(bytes, &scene);
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
        let bytes = write(&running().save());
        let other = super::super::fingerprint(&"other".into());
        let error = from_bytes::<(ParameterValues, Progress)>(&bytes, &other).unwrap_err();
        assert!(error.to_string().contains("another FMU"), "{error}");
    }

    /// Number of bytes of a scene's saved state at the start, when all counters are zero.
    fn size_at_start(scene: &Scene) -> usize {
        const NUMBER: usize = 8;
        // A length has seven bits in each byte; a count of zero, a choice, and the tag of an optional value take one byte.
        let length = |count: usize| if count < 1 << 7 { 1 } else { 2 };
        let list = |count| length(count) + NUMBER * count;
        let (dofs, contacts) = (scene.dof_names().len(), scene.contact_count());
        let values = variables(scene).iter().filter(|variable| variable.is_settable()).count();
        let chosen = if scene.selection == Selection::Given { 1 } else { 1 + NUMBER + 1 + NUMBER };
        let reference = 2 * list(dofs) + 3 * list(contacts);
        // Entries into the four states, and nine other counters.
        let counts = 4 + 9;
        // For each contact: its state, and whether it pulls.
        let motion = 2 * list(dofs) + 2 * (length(contacts) + contacts) + counts;
        let ledger = 1 + if scene.effects.energy { list(dofs) + 6 * NUMBER } else { 0 };
        let clock = 2 * NUMBER + 1;
        let rates = length(0);
        let content = list(values) + chosen + reference + motion + ledger + clock + rates;
        HEADER + content + CHECKSUM
    }

    /// Name of an effect of a scene, and the function that turns it on or off.
    type Switch = (&'static str, fn(&mut Scene, bool));
    const SWITCHES: [Switch; 9] = [
        ("energy", |scene, on| scene.effects.energy = on),
        ("stability", |scene, on| scene.effects.stability = on),
        ("sticking", |scene, on| scene.effects.sticking = on),
        ("detachment", |scene, on| scene.effects.detachment = on),
        ("damping by mass", |scene, on| scene.effects.mass_damping = on),
        ("damping by stiffness", |scene, on| scene.effects.stiffness_damping = on),
        ("preload", |scene, on| scene.effects.preload = on),
        ("forces", |scene, on| {
            scene.roles.forces = if on { ForceRole::Input } else { ForceRole::None };
        }),
        ("static friction", |scene, on| {
            scene.static_friction = on.then_some(scene.friction_coefficient);
        }),
    ];

    /// Names and the scene's description take no bytes either. The tag of the energy ledger exists without a ledger,
    /// and the counters of violated idealisations exist in every scene: one byte each.
    #[test]
    fn what_is_off_is_nothing_in_the_bytes_and_what_is_on_has_its_values_there() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/effects");
        let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        let files = files.filter(|path| path.extension().is_some_and(|end| end == "toml"));
        let of_effects = files.map(|path| crate::scene::read(&path).unwrap().0);
        let scenes = BUILTIN.iter().map(Builtin::scene).chain(of_effects);
        let mut seen = BTreeSet::new();
        for scene in scenes {
            for (name, turn) in SWITCHES {
                for on in [false, true] {
                    let mut scene = scene.clone();
                    turn(&mut scene, on);
                    // Some scenes are impossible without some effects.
                    let Ok(simulation) = Simulation::new(scene.clone(), 0.0) else { continue };
                    let bytes = write(&simulation.save());
                    assert_eq!(bytes.len(), size_at_start(&scene), "{}, {name}", scene.name);
                    assert_eq!(read(&bytes, &scene).unwrap(), simulation.save());
                    seen.insert((name, on));
                }
            }
        }
        assert_eq!(seen.len(), 2 * SWITCHES.len(), "each is seen on and off: {seen:?}");
    }
}
