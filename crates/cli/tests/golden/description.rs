//! A model description in short.

use std::fmt::Write as _;

/// The variables of a `modelDescription.xml`, a line each, then a checksum of each part: where one variable is another, the
/// first difference tells which.
pub fn shortened(xml: &str) -> String {
    let mut text = String::new();
    let mut lines = xml.lines();
    while let Some(line) = lines.next() {
        if element(line) == "ScalarVariable" {
            let kind = lines.next().unwrap();
            let [name, causality, variability] =
                ["name", "causality", "variability"].map(|name| attribute(line, name).unwrap());
            let _ = write!(text, "{name} {causality} {variability} {}", element(kind));
            if let Some(start) = attribute(kind, "start") {
                let _ = write!(text, " {start}");
            }
            text.push('\n');
        }
    }
    text.push('\n');
    // The head is one part, each element below the root another.
    let mut part = String::new();
    for line in xml.lines() {
        if indent(line) <= 2 && !part.is_empty() && !line.trim_start().starts_with("</") {
            let _ = writeln!(text, "{}: {}", element(&part), checksum(part.as_bytes()));
            part.clear();
        }
        part += line;
        part.push('\n');
    }
    let _ = writeln!(text, "{}: {}", element(&part), checksum(part.as_bytes()));
    let _ = writeln!(text, "whole: {}", checksum(xml.as_bytes()));
    text
}

pub fn checksum(bytes: &[u8]) -> String {
    format!("{} bytes, CRC-32 {:08x}", bytes.len(), crc32fast::hash(bytes))
}

fn indent(line: &str) -> usize {
    line.len() - line.trim_start().len()
}

/// The name of the element that a text begins with.
fn element(text: &str) -> &str {
    let text = text.trim_start().trim_start_matches(['<', '?']);
    text.split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default()
}

fn attribute<'a>(line: &'a str, name: &str) -> Option<&'a str> {
    let (_, rest) = line.split_once(&format!(" {name}=\""))?;
    rest.split('"').next()
}
