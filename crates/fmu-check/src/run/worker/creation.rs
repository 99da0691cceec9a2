//! Calls of `fmi2Instantiate` that a library must refuse, and other valid forms of its arguments.

use super::library::{Library, heard};
use super::location::uri;
use super::plan::Plan;
use super::{Subject, said};
use crate::rules::Rule;

impl Subject<'_> {
    pub(super) fn refusals(&self, library: &Library) {
        self.journal.at("fmi2FreeInstance(NULL)");
        library.free_null();
        if self.plan.once_per_process {
            return;
        }
        self.journal.at("fmi2Instantiate with a wrong guid");
        let guid = "{00000000-dead-4bad-8bad-000000000000}";
        if library.instantiate(guid, &self.location(), true).is_some() {
            let message = "fmi2Instantiate accepts a guid that is not the model description's; it must return NULL";
            self.journal.finding(Rule::WrongGuid, message);
        }
    }

    pub(super) fn other_beginnings(&self, library: &Library) {
        let resources = self.resources();
        if resources.is_dir() {
            self.locate(library, &uri(&resources, "/"));
            #[cfg(unix)]
            {
                let spaced = self.fmu.with_file_name("with space");
                if std::os::unix::fs::symlink(&self.fmu, &spaced).is_ok() {
                    self.locate(library, &uri(&spaced.join("resources"), "///"));
                }
            }
        }
        if self.plan.needs_no_memory_callbacks {
            heard();
            self.journal.at("fmi2Instantiate with NULL for the memory callbacks");
            if !self.comes_up(library, &self.location(), false) {
                let message = format!(
                    "no instance can be initialized with NULL for the memory callbacks, although canNotUseMemoryManagementFunctions is true{}",
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
            let message = format!(
                "no instance can be initialized with the resource location {location}{}",
                said()
            );
            self.journal.finding(Rule::ResourceLocation, &message);
        }
    }

    /// `true` if an instance made with these arguments can be initialised.
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
}
