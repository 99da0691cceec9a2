//! Calls of `fmi2Instantiate` that a library must refuse, and other valid forms of its arguments.

use super::library::{Arguments, Library};
use super::location::uri;
use super::plan::Plan;
use super::{Ended, Subject, said};
use crate::rules::Rule;

impl Subject<'_> {
    pub(super) fn free_null(&self, library: &Library) {
        self.at_risk(Rule::FreeNull, "fmi2FreeInstance(NULL)");
        library.free_null();
    }

    pub(super) fn wrong_guid(&self, library: &Library) {
        self.at("fmi2Instantiate with a wrong guid");
        let location = self.location();
        let guid = "{00000000-dead-4bad-8bad-000000000000}";
        if library.instantiate(&Arguments { guid, ..self.arguments(&location) }).is_some() {
            let message = "fmi2Instantiate accepts a guid that is not the model description's; it must return NULL";
            self.journal.finding(Rule::WrongGuid, message);
        }
    }

    pub(super) fn one_slash(&self, library: &Library) -> Result<(), Ended> {
        self.locate(library, &uri(&self.resources(), "/"))
    }

    #[cfg(unix)]
    pub(super) fn space(&self, library: &Library) -> Result<(), Ended> {
        let spaced = self.fmu.with_file_name("with space");
        if std::os::unix::fs::symlink(&self.fmu, &spaced).is_err() {
            return Ok(());
        }
        self.locate(library, &uri(&spaced.join("resources"), "///"))
    }

    fn locate(&self, library: &Library, location: &str) -> Result<(), Ended> {
        let with = format!("with the resource location {location}");
        self.comes_up(library, &self.arguments(location), &with, Rule::ResourceLocation)
    }

    pub(super) fn null_callbacks(&self, library: &Library) -> Result<(), Ended> {
        let location = self.location();
        let arguments = Arguments { memory_callbacks: false, ..self.arguments(&location) };
        let with = "with NULL for the memory callbacks, although canNotUseMemoryManagementFunctions is true";
        self.comes_up(library, &arguments, with, Rule::NullCallbacks)
    }

    /// Reports an instance that is made with these arguments, `with` in words, and cannot be initialized.
    fn comes_up(
        &self,
        library: &Library,
        arguments: &Arguments<'_>,
        with: &str,
        rule: Rule,
    ) -> Result<(), Ended> {
        let failed = |what: String| {
            self.journal.finding(rule, &format!("{what} {with}{}", said()));
            Ended::Failed
        };
        self.at(&format!("fmi2Instantiate {with}"));
        let instance = library
            .instantiate(arguments)
            .ok_or_else(|| failed("fmi2Instantiate returns NULL".to_owned()))?;
        let Plan { tolerance, start, stop, .. } = self.plan;
        let words = format!(" {with}");
        self.staged("fmi2SetupExperiment", &words, || instance.setup(tolerance, start, stop))
            .and_then(|()| {
                let enter = || instance.enter_initialization();
                self.staged("fmi2EnterInitializationMode", &words, enter)
            })
            .and_then(|()| {
                let exit = || instance.exit_initialization();
                self.staged("fmi2ExitInitializationMode", &words, exit)
            })
            .map_err(|(name, refused)| failed(format!("{name} returns {refused}")))
    }
}
