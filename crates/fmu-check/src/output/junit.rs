//! Reports in JUnit's XML, which services that run tests read: one suite for each FMU, one test case for each rule.

use super::{Examined, fails};
use crate::report::{Finding, Report, printable};
use crate::rules::{Class, Rule};
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesEnd, BytesStart, BytesText, Event};
use std::io;

type Xml = Writer<Vec<u8>>;

pub(super) fn document(all: &[Examined<'_>], strict: bool) -> String {
    let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
    write(&mut xml, all, strict).expect("memory can be written to");
    String::from_utf8_lossy(&xml.into_inner()).into_owned()
}

fn write(xml: &mut Xml, all: &[Examined<'_>], strict: bool) -> io::Result<()> {
    xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    within(xml, BytesStart::new("testsuites"), |xml| {
        for examined in all {
            let name = printable(&examined.file.to_string_lossy());
            match &examined.result {
                Ok(report) => suite(xml, &name, report, strict)?,
                Err(error) => unreadable(xml, &name, &printable(&error.to_string()))?,
            }
        }
        Ok(())
    })
}

/// Writes an element with what `content` writes in it.
fn within(
    xml: &mut Xml,
    start: BytesStart<'_>,
    content: impl FnOnce(&mut Xml) -> io::Result<()>,
) -> io::Result<()> {
    let end = BytesEnd::new(start.name().as_ref().to_owned());
    xml.write_event(Event::Start(start))?;
    content(xml)?;
    xml.write_event(Event::End(end))
}

fn text(xml: &mut Xml, tag: &str, attributes: &[(&str, &str)], lines: &[String]) -> io::Result<()> {
    let start = BytesStart::new(tag).with_attributes(attributes.iter().copied());
    within(xml, start, |xml| xml.write_event(Event::Text(BytesText::new(&lines.join("\n")))))
}

/// The findings of a rule that let the check fail, and those that do not.
fn of_rule(report: &Report, rule: Rule, strict: bool) -> (Vec<&Finding>, Vec<&Finding>) {
    let findings = report.findings.iter().filter(|finding| finding.rule == rule);
    findings.partition(|finding| fails(finding.class, strict))
}

fn suite(xml: &mut Xml, name: &str, report: &Report, strict: bool) -> io::Result<()> {
    let is_examined = |rule: Rule| rule.part() <= report.reached();
    let skipped = Rule::ALL.iter().filter(|rule| !is_examined(**rule)).count();
    let failures =
        Rule::ALL.iter().filter(|rule| !of_rule(report, **rule, strict).0.is_empty()).count();
    let counts = [Rule::ALL.len(), failures, skipped].map(|count| count.to_string());
    let start = BytesStart::new("testsuite").with_attributes([
        ("name", name),
        ("tests", &counts[0]),
        ("failures", &counts[1]),
        ("errors", "0"),
        ("skipped", &counts[2]),
    ]);
    within(xml, start, |xml| {
        for rule in Rule::ALL {
            case(xml, *rule, of_rule(report, *rule, strict), is_examined(*rule))?;
        }
        let notes: Vec<_> = report.notes.iter().map(|note| printable(note)).collect();
        if notes.is_empty() { Ok(()) } else { text(xml, "system-out", &[], &notes) }
    })
}

fn case(
    xml: &mut Xml,
    rule: Rule,
    (failing, others): (Vec<&Finding>, Vec<&Finding>),
    is_examined: bool,
) -> io::Result<()> {
    let class_name = format!("{}.{}", env!("CARGO_PKG_NAME"), rule.class());
    let start = BytesStart::new("testcase")
        .with_attributes([("classname", class_name.as_str()), ("name", rule.id())]);
    let lines = |findings: &[&Finding]| -> Vec<String> {
        findings.iter().map(ToString::to_string).collect()
    };
    within(xml, start, |xml| {
        if let [first, ..] = failing[..] {
            let class = if failing.iter().any(|finding| finding.class == Class::Violation) {
                Class::Violation
            } else {
                first.class
            };
            let attributes = [("type", class.word()), ("message", rule.line())];
            text(xml, "failure", &attributes, &lines(&failing))?;
        } else if !is_examined {
            xml.write_event(Event::Empty(BytesStart::new("skipped")))?;
        }
        if others.is_empty() { Ok(()) } else { text(xml, "system-out", &[], &lines(&others)) }
    })
}

/// Writes the suite of an FMU that could not be examined: one test case with an error.
fn unreadable(xml: &mut Xml, name: &str, error: &str) -> io::Result<()> {
    let start = BytesStart::new("testsuite").with_attributes([
        ("name", name),
        ("tests", "1"),
        ("failures", "0"),
        ("errors", "1"),
        ("skipped", "0"),
    ]);
    within(xml, start, |xml| {
        let case = BytesStart::new("testcase")
            .with_attributes([("classname", env!("CARGO_PKG_NAME")), ("name", "readable")]);
        within(xml, case, |xml| text(xml, "error", &[("message", error)], &[]))
    })
}
