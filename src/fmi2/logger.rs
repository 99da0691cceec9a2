//! Log messages to the importer.

use super::types::{
    fmi2CallbackFunctions, fmi2CallbackLogger, fmi2ComponentEnvironment, fmi2Status,
};
use std::ffi::{CStr, CString};

/// The categories that the model description declares; `logAll` stands for all of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Category {
    Error,
    Warning,
    Events,
}

/// Names and descriptions of the categories, as the model description lists them.
pub const CATEGORIES: [(&str, &str); 4] = [
    ("logStatusError", "Reasons why a call was refused or failed; always on"),
    (
        "logStatusWarning",
        "Calls that FMI forbids but the FMU answers; violated assumptions of the scene, a tolerance that may not be kept, \
         several solutions of the law of contact",
    ),
    (
        "logEvents",
        "Initialization, the method and step that a tolerance chose, changes of contact state",
    ),
    ("logAll", "All of these"),
];

impl Category {
    fn name(self) -> &'static CStr {
        match self {
            Self::Error => c"logStatusError",
            Self::Warning => c"logStatusWarning",
            Self::Events => c"logEvents",
        }
    }
}

/// The importer's logger, if it has given one, and the categories that it has enabled.
pub(super) struct Logger {
    callback: Option<fmi2CallbackLogger>,
    environment: fmi2ComponentEnvironment,
    instance_name: CString,
    enabled: [bool; 3],
}

impl Logger {
    pub(super) fn new(
        callbacks: Option<&fmi2CallbackFunctions>,
        instance_name: &CStr,
        logging_on: bool,
    ) -> Self {
        Self {
            callback: callbacks.and_then(|callbacks| callbacks.logger),
            environment: callbacks
                .map_or(std::ptr::null_mut(), |callbacks| callbacks.componentEnvironment),
            instance_name: instance_name.to_owned(),
            enabled: [logging_on; 3],
        }
    }

    /// The first name that is not a category; `None` if all are.
    pub(super) fn unknown<'a>(names: &[&'a CStr]) -> Option<&'a CStr> {
        let known =
            |name: &CStr| CATEGORIES.iter().any(|(known, _)| known.as_bytes() == name.to_bytes());
        names.iter().copied().find(|name| !known(name))
    }

    /// Turns categories on or off; without names, all of them.
    pub(super) fn enable(&mut self, on: bool, names: &[&CStr]) {
        let all = names.is_empty() || names.contains(&c"logAll");
        for (category, enabled) in
            [Category::Error, Category::Warning, Category::Events].iter().zip(&mut self.enabled)
        {
            if all || names.contains(&category.name()) {
                *enabled = on;
            }
        }
    }

    /// `true` if messages of this category are logged. Errors always are: a refusal is useless without its reason,
    /// and FMI's `loggingOn` concerns debug logging.
    pub(super) fn wants(&self, category: Category) -> bool {
        self.callback.is_some() && (category == Category::Error || self.enabled[category as usize])
    }

    #[allow(unsafe_code)]
    pub(super) fn log(&self, status: fmi2Status, category: Category, message: &str) {
        let Some(callback) = self.callback.filter(|_| self.wants(category)) else { return };
        let message = CString::new(message.replace('\0', "")).expect("the zeros were taken out");
        // SAFETY: the callback is the importer's, of the type that FMI prescribes; the importer
        // guarantees that it may be called while the instance lives. All strings are terminated
        // and outlive the call; "%s" takes the one variadic argument given.
        unsafe {
            callback(
                self.environment,
                self.instance_name.as_ptr(),
                status,
                category.name().as_ptr(),
                c"%s".as_ptr(),
                message.as_ptr(),
            );
        }
    }
}
