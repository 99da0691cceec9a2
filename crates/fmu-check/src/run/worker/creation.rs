//! Calls of `fmi2Instantiate` that a library must refuse, and other valid forms of its arguments.

use super::library::Library;
use super::location::uri;
use super::plan::Plan;
use super::{ReportedFailure, Subject, said};
use crate::rules::Rule;

impl Subject<'_> {
    pub(super) fn free_null(&self, library: &Library) -> Result<(), ReportedFailure> {
        self.at_risk(Rule::FreeNull, "fmi2FreeInstance(NULL)");
        library.free_null();
        Ok(())
    }

    pub(super) fn wrong_guid(&self, library: &Library) -> Result<(), ReportedFailure> {
        self.at("fmi2Instantiate with a wrong guid");
        let guid = "{00000000-dead-4bad-8bad-000000000000}";
        if library.instantiate(guid, &self.location(), true, false).is_some() {
            let message = "fmi2Instantiate accepts a guid that is not the model description's; it must return NULL";
            self.journal.finding(Rule::WrongGuid, message);
        }
        Ok(())
    }

    pub(super) fn one_slash(&self, library: &Library) -> Result<(), ReportedFailure> {
        self.locate(library, &uri(&self.resources(), "/"))
    }

    pub(super) fn space(&self, library: &Library) -> Result<(), ReportedFailure> {
        #[cfg(unix)]
        {
            let spaced = self.fmu.with_file_name("with space");
            if std::os::unix::fs::symlink(&self.fmu, &spaced).is_ok() {
                self.locate(library, &uri(&spaced.join("resources"), "///"))?;
            }
        }
        #[cfg(not(unix))]
        let _ = library;
        Ok(())
    }

    fn locate(&self, library: &Library, location: &str) -> Result<(), ReportedFailure> {
        self.at(&format!("fmi2Instantiate with the resource location {location}"));
        if self.comes_up(library, location, true) {
            return Ok(());
        }
        let message = format!(
            "no instance can be initialized with the resource location {location}{}",
            said()
        );
        self.journal.finding(Rule::ResourceLocation, &message);
        Err(ReportedFailure)
    }

    pub(super) fn null_callbacks(&self, library: &Library) -> Result<(), ReportedFailure> {
        self.at("fmi2Instantiate with NULL for the memory callbacks");
        if self.comes_up(library, &self.location(), false) {
            return Ok(());
        }
        let message = format!(
            "no instance can be initialized with NULL for the memory callbacks, although canNotUseMemoryManagementFunctions is true{}",
            said()
        );
        self.journal.finding(Rule::NullCallbacks, &message);
        Err(ReportedFailure)
    }

    /// `true` if an instance made with these arguments can be initialized.
    fn comes_up(&self, library: &Library, location: &str, memory_callbacks: bool) -> bool {
        let guid = &self.plan.guid;
        let Some(instance) = library.instantiate(guid, location, memory_callbacks, false) else {
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
