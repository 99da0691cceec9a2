//! `modelDescription.xml` as a tree of elements with their line numbers.
//!
//! The tree is made here, from quick-xml's events, because a file may be an attack. roxmltree 0.21 limits only the
//! number of nodes: it takes some 10 s for one element of 80,000 attributes (0.8 MB), or for 2000 namespaces with as
//! many elements that declare one more (70 kB). Its time grows with the square of the file or faster, and in an archive
//! such files are small. It does not give the encoding that a file states either.

use super::PATH;
use crate::report::{Place, Report};
use crate::rules::Rule;
use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};
use std::fmt;

pub(crate) const MOST_BYTES: u64 = 256 << 20;
const MOST_ELEMENTS: usize = 4_000_000;
const MOST_ATTRIBUTES: usize = 16_000_000;
/// Limit of the attributes of one element; each is compared with all others.
const MOST_ATTRIBUTES_EACH: usize = 256;
const DEEPEST: usize = 64;

/// An element without its text; the elements of a model description have none.
#[derive(Debug)]
pub(crate) struct Element {
    pub(crate) name: String,
    pub(crate) line: usize,
    pub(crate) attributes: Vec<(String, String)>,
    pub(crate) children: Vec<Element>,
    pub(crate) has_text: bool,
}

impl Element {
    pub(crate) fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    }

    pub(crate) fn child(&self, name: &str) -> Option<&Element> {
        self.children.iter().find(|child| child.name == name)
    }

    /// Returns the children of the child of this name.
    pub(crate) fn below(&self, name: &str) -> &[Element] {
        self.child(name).map_or(&[], |child| &child.children)
    }

    /// Path of the file and line of the element.
    pub(crate) fn place(&self) -> Place {
        Place::line(PATH, self.line)
    }
}

/// Reads the file. Returns `None` if it is not well-formed XML within the limits.
pub(crate) fn read(bytes: &[u8], report: &mut Report) -> Option<Element> {
    if bytes.len() as u64 > MOST_BYTES {
        let message = format!("has {} bytes; the limit is {MOST_BYTES}", bytes.len());
        report.add(Rule::XmlLimits, PATH, message);
        return None;
    }
    let text = match std::str::from_utf8(bytes) {
        Ok(text) => text.strip_prefix('\u{feff}').unwrap_or(text),
        Err(error) => {
            let place = Place::line(PATH, line(&bytes[..error.valid_up_to()]));
            report.add(Rule::XmlEncoding, place, "is not in UTF-8 from this line on");
            return None;
        }
    };
    let illegal = |c: char| {
        c.is_ascii_control() && !matches!(c, '\t' | '\n' | '\r')
            || matches!(c, '\u{fffe}' | '\u{ffff}')
    };
    if let Some(at) = text.find(illegal) {
        let place = Place::line(PATH, line(&text.as_bytes()[..at]));
        report.add(Rule::XmlMalformed, place, "contains a character that XML 1.0 does not allow");
        return None;
    }
    let mut parser =
        Parser { text, counted: (0, 1), elements: 0, attributes: 0, root: None, open: Vec::new() };
    match parser.run(report) {
        Ok(()) => parser.root,
        Err((rule, message)) => {
            let place = Place::line(PATH, parser.counted.1);
            report.add(rule, place, message);
            None
        }
    }
}

fn line(before: &[u8]) -> usize {
    1 + before.iter().filter(|&&byte| byte == b'\n').count()
}

type Problem = (Rule, String);

struct Parser<'a> {
    text: &'a str,
    /// Number of bytes whose lines are counted, and the line in which they end.
    counted: (usize, usize),
    elements: usize,
    attributes: usize,
    root: Option<Element>,
    open: Vec<Element>,
}

impl Parser<'_> {
    fn run(&mut self, report: &mut Report) -> Result<(), Problem> {
        let mut reader = Reader::from_str(self.text);
        reader.config_mut().check_comments = true;
        let mut declares_encoding = false;
        loop {
            let before = usize::try_from(reader.buffer_position()).unwrap_or(usize::MAX);
            self.count_to(before);
            let event = reader.read_event().map_err(|error| {
                let place = usize::try_from(reader.error_position()).unwrap_or(usize::MAX);
                self.count_to(place);
                malformed(error)
            })?;
            match event {
                Event::Start(start) => {
                    let element = self.element(&start)?;
                    if self.open.len() == DEEPEST {
                        return Err((
                            Rule::XmlLimits,
                            format!("elements are nested deeper than {DEEPEST} levels"),
                        ));
                    }
                    self.open.push(element);
                }
                Event::Empty(start) => {
                    let element = self.element(&start)?;
                    self.close(element)?;
                }
                Event::End(_) => {
                    let element =
                        self.open.pop().ok_or_else(|| malformed("an end tag has no start tag"))?;
                    self.close(element)?;
                }
                Event::Text(text) => {
                    if text.contains("]]>") {
                        return Err(malformed("text contains ]]>"));
                    }
                    if !text.trim_ascii().is_empty() {
                        self.text()?;
                    }
                }
                Event::CData(_) => self.text()?,
                Event::GeneralRef(reference) => {
                    let predefined = matches!(&*reference, "lt" | "gt" | "amp" | "apos" | "quot");
                    if !predefined && !matches!(reference.resolve_char_ref(), Ok(Some(_))) {
                        return Err(malformed(format!(
                            "the entity &{}; is not declared",
                            &*reference
                        )));
                    }
                    self.text()?;
                }
                Event::Decl(declaration) => {
                    if before != 0 {
                        return Err(malformed(
                            "the XML declaration is not at the beginning of the file",
                        ));
                    }
                    if let Some(encoding) = declaration.encoding() {
                        let encoding = encoding.map_err(malformed)?;
                        declares_encoding = true;
                        if !encoding.eq_ignore_ascii_case("UTF-8") {
                            let message =
                                format!("declares the encoding {encoding}; FMI requires UTF-8");
                            report.add(Rule::XmlEncoding, Place::line(PATH, 1), message);
                        }
                    }
                }
                Event::DocType(_) => {
                    return Err((
                        Rule::XmlDtd,
                        "has a document type declaration (DTD), which is not read; remove it"
                            .to_owned(),
                    ));
                }
                Event::PI(_) | Event::Comment(_) => {}
                Event::Eof => break,
            }
        }
        if let Some(element) = self.open.last() {
            return Err(malformed(format!(
                "<{}> of line {} has no end tag",
                element.name, element.line
            )));
        }
        if self.root.is_none() {
            return Err(malformed("the file contains no element"));
        }
        if !declares_encoding {
            let message = "declares no encoding; the first line must be <?xml version=\"1.0\" encoding=\"UTF-8\"?>";
            report.add(Rule::XmlEncoding, Place::line(PATH, 1), message);
        }
        Ok(())
    }

    fn count_to(&mut self, place: usize) {
        let place = place.min(self.text.len());
        if place > self.counted.0 {
            self.counted.1 += line(&self.text.as_bytes()[self.counted.0..place]) - 1;
            self.counted.0 = place;
        }
    }

    fn element(&mut self, start: &BytesStart<'_>) -> Result<Element, Problem> {
        self.elements += 1;
        if self.elements > MOST_ELEMENTS {
            return Err((Rule::XmlLimits, format!("has more than {MOST_ELEMENTS} elements")));
        }
        if self.root.is_some() {
            return Err(malformed("there is more than one root element"));
        }
        let name = start.name().as_ref().to_owned();
        if !is_name(&name) {
            return Err(malformed(format!("<{name}> is not a valid element name")));
        }
        let mut attributes = Vec::new();
        for attribute in start.attributes() {
            self.attributes += 1;
            if attributes.len() == MOST_ATTRIBUTES_EACH || self.attributes > MOST_ATTRIBUTES {
                let message = format!(
                    "has more than {MOST_ATTRIBUTES_EACH} attributes in one element, or {MOST_ATTRIBUTES} in all"
                );
                return Err((Rule::XmlLimits, message));
            }
            let attribute = attribute.map_err(malformed)?;
            if attribute.value.contains('<') {
                return Err(malformed("an attribute value contains <"));
            }
            let value = attribute.normalized_value(XmlVersion::Implicit1_0).map_err(malformed)?;
            attributes.push((attribute.key.as_ref().to_owned(), value.into_owned()));
        }
        Ok(Element {
            name,
            line: self.counted.1,
            attributes,
            children: Vec::new(),
            has_text: false,
        })
    }

    fn close(&mut self, element: Element) -> Result<(), Problem> {
        match self.open.last_mut() {
            // The annotations of tools are not examined.
            Some(parent) if parent.name == "Tool" => {}
            Some(parent) => parent.children.push(element),
            None => self.root = Some(element),
        }
        Ok(())
    }

    fn text(&mut self) -> Result<(), Problem> {
        let element = self
            .open
            .last_mut()
            .ok_or_else(|| malformed("there is text outside the root element"))?;
        element.has_text = true;
        Ok(())
    }
}

fn malformed(error: impl fmt::Display) -> Problem {
    (Rule::XmlMalformed, format!("{error}"))
}

fn is_name(name: &str) -> bool {
    let first = |c: char| c.is_alphabetic() || matches!(c, '_' | ':');
    name.starts_with(first)
        && name.chars().all(|c| first(c) || c.is_numeric() || matches!(c, '-' | '.' | '·'))
}
