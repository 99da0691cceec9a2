//! Finds mistakes in FMUs for co-simulation by FMI 2.0, from any program. [`Rule::ALL`] lists the rules.
//!
//! ```no_run
//! use fmu_check::{Class, Options, check};
//! use std::ops::ControlFlow;
//! use std::path::Path;
//!
//! // Without `run` in the options, nothing of the FMU is run.
//! let report = check(Path::new("model.fmu"), &Options::default(), &mut |_stage| ControlFlow::Continue(()))?;
//! let report = report.expect("the closure never ends the examination");
//! for finding in &report.findings {
//!     println!("{finding}");
//! }
//! assert_eq!(report.count(Class::Violation), 0);
//! # Ok::<(), fmu_check::Error>(())
//! ```
//!
//! [`command`] holds the command line as a module, for a program that offers it among other commands.
//!
//! ## How an examination proceeds
//!
//! [`check`] reads the archive header by header (`archive`), then `modelDescription.xml` as a tree that is held against the
//! schema (`xml`), then the rules that the schema cannot express (`declarations`, `variables`, `structure`), then the
//! libraries as files (`binaries`), and at last it runs the library for this host (`run`). `output` writes the reports. Nothing in an FMU is trusted: sizes
//! are limited before anything is unpacked, files are written into a private folder only, and a library runs in a process of
//! its own that ends with its time.

mod archive;
mod binaries;
pub mod command;
mod declarations;
mod description;
mod error;
mod options;
mod output;
mod report;
mod rules;
mod run;
mod structure;
mod variables;
mod xml;

pub use error::Error;
pub use options::{Glibc, Options, Run};
pub use output::Format;
pub use report::{Finding, Place, Report};
pub use rules::{Class, Part, Rule};
pub use run::{COMMAND, Watch};

use archive::Archive;
use description::Description;
use std::collections::BTreeSet;
use std::fs::File;
use std::io::Read as _;
use std::path::Path;

/// Limit of the size of an FMU that is read, bytes.
const MOST_BYTES: u64 = 2 << 30;

/// Examines an FMU. Returns `None` if `watch` has ended the examination.
///
/// # Errors
/// Returns an error if the file cannot be read or is not a zip archive.
pub fn check(path: &Path, options: &Options, watch: Watch<'_>) -> Result<Option<Report>, Error> {
    let failed = |error| Error::file(path, &error);
    let mut bytes = Vec::new();
    // The file may hold more bytes than its metadata states.
    File::open(path)
        .and_then(|file| file.take(MOST_BYTES + 1).read_to_end(&mut bytes))
        .map_err(failed)?;
    if bytes.len() as u64 > MOST_BYTES {
        return Err(Error::new(format!(
            "{} has more than {MOST_BYTES} bytes, the limit for an FMU",
            path.display()
        )));
    }
    let archive = Archive::read(bytes)
        .map_err(|reason| Error::new(format!("{} is not an FMU: {reason}", path.display())))?;
    let mut report = Report::default();
    if !archive::examine(&archive, &mut report) {
        report.note(
            "only the headers of the archive are examined: it is not unpacked (see zip-bomb)",
        );
        return Ok(Some(report));
    }
    let library = files(&archive, options.glibc, &mut report);
    if let (Some(library), Some(run)) = (library, &options.run) {
        report.reach(Part::Run);
        if run::examine(&archive, &library, run, watch, &mut report)?.is_none() {
            return Ok(None);
        }
    }
    Ok(Some(report))
}

/// Returns the reason why the archive has no library to run on this host, whose folder is `folder`.
fn missing(archive: &Archive, folder: &str) -> String {
    let folders: BTreeSet<&str> = (archive.entries.iter())
        .filter(|entry| !entry.is_folder())
        .filter_map(|entry| Some(entry.name.strip_prefix("binaries/")?.split_once('/')?.0))
        .collect();
    if folders.is_empty() || folders.contains(folder) {
        return format!("there is no usable library in binaries/{folder}/");
    }
    let folders = Vec::from_iter(folders).join(", ");
    format!("there is no library for this host ({folder}), only for {folders}")
}

/// Examines the model description and the libraries. Returns the path of the library to run.
fn files(archive: &Archive, floor: Option<Glibc>, report: &mut Report) -> Option<String> {
    let entry = archive.find(xml::PATH)?;
    // Damaged entries have been reported with the archive.
    let content = archive.content(entry, xml::MOST_BYTES).ok()?;
    report.reach(Part::Description);
    let root = xml::read(&content, report)?;
    let description = Description::new(&root);
    declarations::examine(&description, archive, report);
    variables::examine(&description, report);
    structure::examine(&description, report);
    if description.simulation.is_none() {
        report.note("modelDescription.xml has no CoSimulation element: libraries are not examined");
        return None;
    }
    report.reach(Part::Libraries);
    let library = binaries::examine(&description, archive, floor, report);
    let note = match (&library, binaries::HOST) {
        (Some(_), _) if description.can("needsExecutionTool") => {
            "the library needs another program (needsExecutionTool)"
        }
        (Some(_), _) => return library,
        (None, [folder, ..]) => &missing(archive, folder),
        (None, []) => "FMI 2.0 defines no platform folder for this host",
    };
    report.note(format!("nothing is run: {note}"));
    None
}
