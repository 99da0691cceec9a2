//! The trial under valgrind, a memory checker, where it is installed.

use super::journal::Journal;
use crate::rules::Rule;
use quick_xml::Reader;
use quick_xml::events::Event;
use std::collections::BTreeSet;
use std::path::Path;
use std::process::{Command, Stdio};

/// File of valgrind's report.
const FILE: &str = "valgrind.xml";

/// `true` if valgrind is installed; otherwise a note is written.
pub(super) fn is_there(journal: &Journal) -> bool {
    let mut command = Command::new("valgrind");
    let silent = command.arg("--version").stdout(Stdio::null()).stderr(Stdio::null());
    let is_there = silent.status().is_ok_and(|status| status.success());
    if !is_there {
        journal.note("access to memory is not examined: valgrind is not installed");
    }
    is_there
}

/// Returns the command that runs `program` under valgrind.
pub(super) fn command(folder: &Path, program: &Path) -> Command {
    let mut command = Command::new("valgrind");
    command
        .args(["--quiet", "--leak-check=no", "--vgdb=no", "--child-silent-after-fork=yes"])
        .args(["--xml=yes", &format!("--xml-file={}", folder.join(FILE).display())])
        .arg(program);
    command
}

/// Reports the errors that valgrind found in `library`, or in functions that it calls.
pub(super) fn report(folder: &Path, library: &str, is_done: bool, journal: &Journal) {
    let text = std::fs::read_to_string(folder.join(FILE)).unwrap_or_default();
    let library = folder.join("fmu").join(library);
    let errors = errors(&text, &library.to_string_lossy());
    for error in &errors {
        journal.finding(Rule::MemoryErrors, error);
    }
    if !is_done && errors.is_empty() {
        journal.note(
            "access to memory is not examined to the end: the library does not run under valgrind as it does alone",
        );
    }
}

/// One error of valgrind's report.
#[derive(Default)]
struct Found {
    what: String,
    /// The innermost function of the library.
    function: Option<String>,
    is_in_library: bool,
}

/// Returns the errors with the library in their stack, each in words and once.
fn errors(xml: &str, library: &str) -> BTreeSet<String> {
    let mut reader = Reader::from_str(xml);
    let (mut all, mut found) = (BTreeSet::new(), Found::default());
    let (mut name, mut object, mut function) = (String::new(), String::new(), String::new());
    // Of the several stacks of an error the first shows where it happened; the others say where the memory is from.
    let mut stacks = 0;
    // A report of a process that was ended stops anywhere.
    while let Ok(event) = reader.read_event() {
        match event {
            Event::Start(start) => {
                name = start.name().as_ref().to_owned();
                match name.as_str() {
                    "error" => (found, stacks) = (Found::default(), 0),
                    "stack" => stacks += 1,
                    "frame" => (object, function) = (String::new(), String::new()),
                    _ => {}
                }
            }
            Event::Text(text) => {
                let text: &str = &text;
                match name.as_str() {
                    "what" | "text" if stacks == 0 => found.what.push_str(text),
                    "obj" => object.push_str(text),
                    "fn" => function.push_str(text),
                    _ => {}
                }
            }
            Event::End(end) => {
                name.clear();
                match end.name().as_ref() {
                    "frame" if stacks == 1 && object == library && !found.is_in_library => {
                        found.is_in_library = true;
                        found.function = Some(function.clone()).filter(|name| !name.is_empty());
                    }
                    "error" if found.is_in_library => {
                        let place = found
                            .function
                            .as_ref()
                            .map_or(String::new(), |name| format!(" in {name}"));
                        all.insert(format!("valgrind finds{place}: {}", found.what));
                    }
                    _ => {}
                }
            }
            Event::Eof => break,
            _ => {}
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    const REPORT: &str = "<valgrindoutput><error><kind>InvalidRead</kind><what>Invalid read of size 8</what><stack>\
        <frame><ip>0x1</ip><obj>/lib/libc.so</obj><fn>memcpy</fn></frame>\
        <frame><ip>0x2</ip><obj>/a/model.so</obj><fn>fmi2GetReal</fn></frame></stack>\
        <auxwhat>Address 0x3 is 0 bytes after a block</auxwhat><stack><frame><obj>/a/host</obj></frame></stack></error>\
        <error><kind>UninitCondition</kind><what>of the host</what><stack><frame><obj>/a/host</obj></frame></stack>\
        <auxwhat>made by</auxwhat><stack><frame><obj>/a/model.so</obj></frame></stack></error>\
        <error><what>cut";

    #[test]
    fn errors_are_the_librarys_if_it_is_in_the_stack_where_they_happen() {
        let told = "valgrind finds in fmi2GetReal: Invalid read of size 8".to_owned();
        assert_eq!(errors(REPORT, "/a/model.so"), BTreeSet::from([told]));
        assert_eq!(errors("", "/a/model.so"), BTreeSet::new());
    }
}
