//! The process that runs a library: a plain run, the same run after other beginnings, and many instances.

use super::journal::Journal;
use super::library::{Instance, Library, Refused, State, heard};
use super::location::uri;
use super::plan::{Plan, Start};
use super::{growth, process};
use crate::check::description::Description;
use crate::check::report::Report;
use crate::check::rules::Rule;
use crate::check::xml;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Runs the FMU that is unpacked in `folder`; what comes of it goes into the journal there.
pub(super) fn run(
    folder: &Path,
    library: &str,
    timeout: Duration,
    journal: &Journal,
) -> Option<()> {
    let description = std::fs::read(folder.join("fmu").join(xml::PATH)).ok()?;
    let root = xml::read(&description, &mut Report::default())?;
    let plan = Plan::new(&Description::new(&root));
    process::limit(timeout);
    Rounds { folder, path: folder.join("fmu").join(library), plan, journal, timeout }.run()
}

pub(super) struct Rounds<'a> {
    folder: &'a Path,
    path: PathBuf,
    plan: Plan,
    pub(super) journal: &'a Journal,
    pub(super) timeout: Duration,
}

/// Values of all outputs after each step, as bits.
type Course = Vec<Vec<u64>>;

/// A call that failed has been told; there is nothing to go on with.
struct Told;

impl Rounds<'_> {
    /// None where it ended early, which has been told.
    fn run(&self) -> Option<()> {
        let Self { plan, journal, .. } = self;
        let library = self.load()?;
        self.answers(&library);
        journal.at("fmi2FreeInstance(NULL)");
        library.free_null();
        if !plan.once_per_process {
            self.wrong_guid(&library);
        }
        let first = self.plain(&library).ok()?;
        if plan.once_per_process {
            journal.note("only one instance may be made: no other runs, and memory is not watched");
            return Some(());
        }
        self.repeated(&library, &first);
        self.locations(&library);
        journal.at("unloading it");
        drop(library);
        growth::watch(self);
        Some(())
    }

    pub(super) fn load(&self) -> Option<Library> {
        self.journal.at("loading it");
        match Library::load(&self.path) {
            Ok(library) => Some(library),
            Err(error) => {
                let folder = format!("{}/", self.folder.join("fmu").display());
                let error = error.replace(&folder, "");
                self.journal.finding(Rule::Load, &format!("cannot be loaded: {error}"));
                None
            }
        }
    }

    fn answers(&self, library: &Library) {
        for (rule, name, right) in [
            (Rule::TypesPlatform, "fmi2GetTypesPlatform", "default"),
            (Rule::Version, "fmi2GetVersion", "2.0"),
        ] {
            self.journal.at(name);
            let answer = library.answer(name);
            if answer != right {
                self.journal.finding(rule, &format!("{name} answers {answer}, not {right}"));
            }
        }
    }

    /// The folder of the resources, written in one of the ways that URIs have.
    fn location(&self, slashes: &str) -> String {
        uri(&self.folder.join("fmu").join("resources"), slashes)
    }

    fn wrong_guid(&self, library: &Library) {
        self.journal.at("fmi2Instantiate with a wrong guid");
        let guid = "{00000000-dead-4bad-8bad-000000000000}";
        if library.instantiate(guid, &self.location("///"), true).is_some() {
            let message = "makes an instance with a guid that is not the model description's; it should answer NULL";
            self.journal.finding(Rule::WrongGuid, message);
        }
    }

    fn instance<'a>(&self, library: &'a Library) -> Option<Instance<'a>> {
        heard();
        self.journal.at("fmi2Instantiate");
        let instance = library.instantiate(&self.plan.guid, &self.location("///"), true);
        if instance.is_none() {
            let message =
                format!("fmi2Instantiate answers NULL to the guid {}{}", self.plan.guid, said());
            self.journal.finding(Rule::Instantiate, &message);
        }
        instance
    }

    /// Tells of a call that failed.
    fn called<T>(&self, name: &str, result: Result<T, Refused>) -> Result<T, Told> {
        result.map_err(|refused| {
            let message = format!("{name} answers {}{}", refused.name(), said());
            self.journal.finding(Rule::CallFailed, &message);
            Told
        })
    }

    fn initialize(&self, instance: &Instance<'_>, look: bool) -> Result<(), Told> {
        let Plan { tolerance, start, stop, .. } = self.plan;
        self.journal.at("fmi2SetupExperiment");
        self.called("fmi2SetupExperiment", instance.setup(tolerance, start, stop))?;
        self.journal.at("fmi2EnterInitializationMode");
        self.called("fmi2EnterInitializationMode", instance.enter_initialization())?;
        if look {
            self.starts(instance)?;
        }
        self.journal.at("fmi2ExitInitializationMode");
        self.called("fmi2ExitInitializationMode", instance.exit_initialization())
    }

    fn starts(&self, instance: &Instance<'_>) -> Result<(), Told> {
        self.journal.at("reading start values");
        for (name, reference, start) in &self.plan.exact {
            let reference = [*reference];
            let get = |kind| format!("fmi2Get{kind} of {name} in initialization mode");
            let (found, stated) = match start {
                Start::Real(start) => {
                    let found = self.called(&get("Real"), instance.reals(&reference))?[0];
                    (found != *start)
                        .then_some((format!("{found:?}"), format!("{start:?}")))
                        .unzip()
                }
                Start::Integer(start) => {
                    let found = self.called(&get("Integer"), instance.integers(&reference))?[0];
                    (found != *start).then_some((found.to_string(), start.to_string())).unzip()
                }
                Start::Boolean(start) => {
                    let found = self.called(&get("Boolean"), instance.booleans(&reference))?[0];
                    (found != i32::from(*start))
                        .then_some((found.to_string(), start.to_string()))
                        .unzip()
                }
                Start::String(start) => {
                    let found =
                        self.called(&get("String"), instance.strings(&reference))?.remove(0);
                    (found != *start).then_some((found, start.clone())).unzip()
                }
            };
            if let (Some(found), Some(stated)) = (found, stated) {
                let message = format!(
                    "{name} begins with {found}; the model description's start is {stated}"
                );
                self.journal.finding(Rule::StartDiffers, &message);
            }
        }
        Ok(())
    }

    /// Steps from one communication point to another; the outputs after each.
    fn steps(&self, instance: &Instance<'_>, from: u32, to: u32) -> Result<Course, Told> {
        let mut course = Vec::new();
        for number in from..to {
            let time = self.plan.start + f64::from(number) * self.plan.step;
            let name = format!("fmi2DoStep at {time} s");
            self.journal.at(&name);
            match instance.step(time, self.plan.step) {
                Err(refused) if refused.is_discard() || refused.is_pending() => {
                    self.journal
                        .note(&format!("{name} answers {}: the run ends there", refused.name()));
                    break;
                }
                result => self.called(&name, result)?,
            }
            course.push(self.outputs(instance)?);
        }
        Ok(course)
    }

    fn outputs(&self, instance: &Instance<'_>) -> Result<Vec<u64>, Told> {
        self.journal.at("reading outputs");
        let Plan { reals, integers, booleans, .. } = &self.plan;
        let mut values = Vec::new();
        if !reals.is_empty() {
            let references: Vec<u32> = reals.iter().map(|(_, reference)| *reference).collect();
            let found = self.called("fmi2GetReal of the outputs", instance.reals(&references))?;
            values.extend(found.iter().map(|value| value.to_bits()));
        }
        if !integers.is_empty() {
            let found =
                self.called("fmi2GetInteger of the outputs", instance.integers(integers))?;
            values.extend(found.iter().map(|value| u64::from(value.cast_unsigned())));
        }
        if !booleans.is_empty() {
            let found =
                self.called("fmi2GetBoolean of the outputs", instance.booleans(booleans))?;
            values.extend(found.iter().map(|value| u64::from(*value != 0)));
        }
        Ok(values)
    }

    /// The run that every importer makes, and the same again after a reset.
    fn plain(&self, library: &Library) -> Result<Course, Told> {
        let instance = self.instance(library).ok_or(Told)?;
        self.initialize(&instance, true)?;
        let first = self.steps(&instance, 0, self.plan.steps)?;
        self.finite(&first);
        self.journal.at("fmi2Terminate");
        self.called("fmi2Terminate", instance.terminate())?;
        self.journal.at("fmi2Reset");
        self.called("fmi2Reset", instance.reset())?;
        self.initialize(&instance, false)?;
        let again = self.steps(&instance, 0, self.plan.steps)?;
        self.journal.at("fmi2FreeInstance");
        drop(instance);
        if again == first {
            return Ok(first);
        }
        // Some models are random by intent: a reset is wrong only where a new instance is right.
        let fresh = if self.plan.once_per_process { again.clone() } else { self.fresh(library)? };
        if fresh == first {
            let message = format!("after fmi2Reset {}", self.difference(&first, &again));
            self.journal.finding(Rule::ResetDiffers, &message);
        }
        Ok(first)
    }

    fn fresh(&self, library: &Library) -> Result<Course, Told> {
        let instance = self.instance(library).ok_or(Told)?;
        self.initialize(&instance, false)?;
        self.steps(&instance, 0, self.plan.steps)
    }

    fn finite(&self, course: &Course) {
        for (step, values) in (1..).zip(course) {
            for ((name, _), bits) in self.plan.reals.iter().zip(values) {
                let value = f64::from_bits(*bits);
                if !value.is_finite() {
                    let time = self.plan.start + f64::from(step) * self.plan.step;
                    self.journal
                        .finding(Rule::OutputNotFinite, &format!("{name} is {value} at {time} s"));
                    return;
                }
            }
        }
    }

    /// The first difference between two runs, in words.
    fn difference(&self, one: &Course, other: &Course) -> String {
        for (step, (one, other)) in one.iter().zip(other).enumerate() {
            let Some(at) = one.iter().zip(other).position(|(one, other)| one != other) else {
                continue;
            };
            if let Some((name, _)) = self.plan.reals.get(at) {
                let [one, other] = [one[at], other[at]].map(f64::from_bits);
                return format!(
                    "{name} is {other:?} after step {} of the run, and was {one:?}",
                    step + 1
                );
            }
            return format!(
                "an output is {} after step {} of the run, and was {}",
                other[at],
                step + 1,
                one[at]
            );
        }
        "the run has another length".to_owned()
    }

    /// Runs that must give the same as the first.
    fn repeated(&self, library: &Library, first: &Course) {
        let Ok(again) = self.fresh(library) else { return };
        if again != *first {
            self.journal.note(
                "two instances give two courses: whether saved states are right cannot be judged",
            );
        } else if self.plan.saves_states {
            // What failed has been told.
            let _ = self.states(library, first);
        }
    }

    fn states(&self, library: &Library, first: &Course) -> Result<(), Told> {
        let middle = self.plan.steps / 2;
        let instance = self.instance(library).ok_or(Told)?;
        self.initialize(&instance, false)?;
        self.steps(&instance, 0, middle)?;
        self.journal.at("fmi2GetFMUstate");
        let state = self.called("fmi2GetFMUstate", instance.save())?;
        self.steps(&instance, middle, self.plan.steps)?;
        self.resume(&instance, &state, first, Rule::StateDiffers)?;
        if self.plan.serializes_states {
            self.journal.at("fmi2SerializeFMUstate");
            let bytes = self.called("fmi2SerializeFMUstate", instance.serialize(&state))?;
            self.journal.at("fmi2DeSerializeFMUstate");
            let copy = self.called("fmi2DeSerializeFMUstate", instance.deserialize(&bytes))?;
            self.resume(&instance, &copy, first, Rule::SerializedStateDiffers)?;
            self.journal.at("fmi2FreeFMUstate");
            self.called("fmi2FreeFMUstate", instance.free(copy))?;
        }
        self.journal.at("fmi2FreeFMUstate");
        self.called("fmi2FreeFMUstate", instance.free(state))
    }

    fn resume(
        &self,
        instance: &Instance<'_>,
        state: &State,
        first: &Course,
        rule: Rule,
    ) -> Result<(), Told> {
        let middle = self.plan.steps / 2;
        self.journal.at("fmi2SetFMUstate");
        self.called("fmi2SetFMUstate", instance.restore(state))?;
        let again = self.steps(instance, middle, self.plan.steps)?;
        let rest = first[(middle as usize).min(first.len())..].to_vec();
        if again != rest {
            let message = format!("after fmi2SetFMUstate {}", self.difference(&rest, &again));
            self.journal.finding(rule, &message);
        }
        Ok(())
    }

    /// Does an instance come to its first step, made this way?
    fn comes_up(&self, library: &Library, location: &str, memory_callbacks: bool) -> bool {
        let Some(instance) = library.instantiate(&self.plan.guid, location, memory_callbacks)
        else {
            return false;
        };
        let Plan { tolerance, start, stop, .. } = self.plan;
        instance
            .setup(tolerance, start, stop)
            .and_then(|()| instance.enter_initialization())
            .and_then(|()| instance.exit_initialization())
            .is_ok()
    }

    /// Other ways to say the same to `fmi2Instantiate`.
    fn locations(&self, library: &Library) {
        let resources = self.folder.join("fmu").join("resources");
        if resources.is_dir() {
            self.locate(library, &uri(&resources, "/"));
            let spaced = self.folder.join("with space");
            #[cfg(unix)]
            if std::os::unix::fs::symlink(self.folder.join("fmu"), &spaced).is_ok() {
                self.locate(library, &uri(&spaced.join("resources"), "///"));
            }
            #[cfg(not(unix))]
            drop(spaced);
        }
        if self.plan.needs_no_memory_callbacks {
            heard();
            self.journal.at("fmi2Instantiate with NULL for the memory callbacks");
            if !self.comes_up(library, &self.location("///"), false) {
                let message = format!(
                    "with NULL for the memory callbacks no instance comes up, though canNotUseMemoryManagementFunctions is true{}",
                    said()
                );
                self.journal.finding(Rule::NullCallbacks, &message);
            }
        }
    }

    fn locate(&self, library: &Library, location: &str) {
        heard();
        self.journal.at(&format!("fmi2Instantiate with the resource location {location}"));
        if !self.comes_up(library, location, true) {
            let message =
                format!("with the resource location {location} no instance comes up{}", said());
            self.journal.finding(Rule::ResourceLocation, &message);
        }
    }

    /// One instance from the library's loading to its end, as far as it goes.
    pub(super) fn round(&self) -> Option<()> {
        let library = Library::load(&self.path).ok()?;
        let instance = library.instantiate(&self.plan.guid, &self.location("///"), true)?;
        let Plan { tolerance, start, stop, step, .. } = self.plan;
        instance.setup(tolerance, start, stop).ok()?;
        instance.enter_initialization().ok()?;
        instance.exit_initialization().ok()?;
        instance.step(start, step).ok()?;
        instance.terminate().ok()
    }
}

/// What the library said of it to its logger.
fn said() -> String {
    let heard = heard();
    if heard.is_empty() { String::new() } else { format!(" and says: {heard}") }
}
