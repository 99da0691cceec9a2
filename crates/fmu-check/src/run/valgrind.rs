//! The trial under valgrind, a memory checker, where it is installed.

use super::journal::Journal;
use crate::rules::Rule;
use quick_xml::Reader;
use quick_xml::escape::resolve_predefined_entity;
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
    // Valgrind replaces what follows a percent sign.
    let file = folder.join(FILE).to_string_lossy().replace('%', "%%");
    let mut command = Command::new("valgrind");
    command
        .args(["--quiet", "--leak-check=no", "--vgdb=no", "--child-silent-after-fork=yes"])
        .args(["--xml=yes", &format!("--xml-file={file}")])
        .arg(program);
    command
}

/// Reports the errors that valgrind found in `library`, or in functions that it calls.
pub(super) fn report(
    folder: &Path,
    library: &str,
    is_made: bool,
    is_late: bool,
    journal: &Journal,
) {
    let text = std::fs::read_to_string(folder.join(FILE)).unwrap_or_default();
    let library = folder.join("fmu").join(library);
    let errors = errors(&text, &library.to_string_lossy());
    for error in &errors {
        journal.finding(Rule::MemoryErrors, error);
    }
    if !is_made && errors.is_empty() {
        let why = if is_late {
            "the time limit ends the run under valgrind"
        } else {
            "the library does not run under valgrind as it does alone"
        };
        journal.note(&format!("access to memory is not examined to the end: {why}"));
    }
}

/// One error of valgrind's report.
#[derive(Default)]
struct Found {
    what: String,
    /// The innermost function of the library; empty if it has no name.
    function: String,
    is_in_library: bool,
    is_leak: bool,
}

/// Returns the errors with the library in their stack, each in words and once.
fn errors(xml: &str, library: &str) -> BTreeSet<String> {
    let mut reader = Reader::from_str(xml);
    let (mut all, mut found) = (BTreeSet::new(), Found::default());
    // The text of the present element, and the library and function of the present frame of a stack.
    let (mut words, mut object, mut function) = (String::new(), String::new(), String::new());
    // Of the several stacks of an error the first shows where it happened; the others say where the memory is from.
    let mut stacks = 0;
    // A report of a process that was ended stops anywhere.
    while let Ok(event) = reader.read_event() {
        match event {
            Event::Start(start) => {
                words.clear();
                match start.name().as_ref() {
                    "error" => (found, stacks) = (Found::default(), 0),
                    "stack" => stacks += 1,
                    "frame" => (object, function) = (String::new(), String::new()),
                    _ => {}
                }
            }
            Event::Text(text) => words.push_str(&text),
            Event::GeneralRef(reference) => {
                words.push_str(resolve_predefined_entity(&reference).unwrap_or_default());
            }
            Event::End(end) => match end.name().as_ref() {
                "kind" => found.is_leak = words.starts_with("Leak_"),
                "what" | "text" if stacks == 0 => found.what = std::mem::take(&mut words),
                "obj" => object = std::mem::take(&mut words),
                "fn" => function = std::mem::take(&mut words),
                "frame" if stacks == 1 && object == library && !found.is_in_library => {
                    found.is_in_library = true;
                    found.function = std::mem::take(&mut function);
                }
                // With a report in XML valgrind looks for leaks too, which another trial measures.
                "error" if found.is_in_library && !found.is_leak => {
                    let Found { what, function, .. } = &found;
                    let place = if function.is_empty() { "" } else { &format!(" in {function}") };
                    all.insert(format!("valgrind finds{place}: {what}"));
                }
                _ => {}
            },
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
        <frame><ip>0x2</ip><obj>/a/model.so</obj><fn>get&lt;int&gt;(char&amp;)</fn></frame></stack>\
        <auxwhat>Address 0x3 is 0 bytes after a block</auxwhat><stack><frame><obj>/a/host</obj></frame></stack></error>\
        <error><kind>UninitCondition</kind><what>of the host</what><stack><frame><obj>/a/host</obj></frame></stack>\
        <auxwhat>made by</auxwhat><stack><frame><obj>/a/model.so</obj></frame></stack></error>\
        <error><kind>Leak_DefinitelyLost</kind><what>8 bytes lost</what><stack><frame><obj>/a/model.so</obj></frame></stack></error>\
        <error><what>cut";

    #[test]
    fn errors_are_the_librarys_if_it_is_in_the_stack_where_they_happen() {
        let told = "valgrind finds in get<int>(char&): Invalid read of size 8".to_owned();
        assert_eq!(errors(REPORT, "/a/model.so"), BTreeSet::from([told]));
        assert_eq!(errors("", "/a/model.so"), BTreeSet::new());
    }
}
