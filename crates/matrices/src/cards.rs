//! Cards of the bulk data of Nastran.
//!
//! A line has its fields in columns of 8 characters (small), in columns of 8, then four times 16 (large, with `*` after the
//! name or at the start of a continuation), or between commas (free). A line that begins with a blank, `+` or `*` continues
//! the card before it. The last field of a line only marks the continuation. `$` begins a comment.
//!
//! Source: Quick Reference Guide of MSC Nastran, format of bulk data entries.

use crate::{Fault, text};

/// A card with its fields after the name.
pub(crate) struct Card {
    /// The line where the card begins.
    pub(crate) line: usize,
    /// Each field without blanks around it, and its line.
    pub(crate) fields: Vec<(usize, String)>,
}

impl Card {
    /// A field, counted from 0; empty if the card is shorter.
    pub(crate) fn field(&self, at: usize) -> &str {
        self.fields.get(at).map_or("", |(_, field)| field)
    }
}

/// Hands each card of this name to `take`. Continuation lines follow their card in order.
///
/// # Errors
/// Returns the first fault of `take`, or a fault if there is no such card.
pub(crate) fn each(
    content: &[u8],
    name: &str,
    mut take: impl FnMut(Card) -> Result<(), Fault>,
) -> Result<(), Fault> {
    let mut card: Option<Card> = None;
    let mut found = false;
    for (line, text) in text::lines(content) {
        let text = text.split('$').next().unwrap_or_default();
        if text.trim().is_empty() {
            continue;
        }
        let (first, fields) = split(text);
        let first = first.trim();
        if !first.is_empty() && !first.starts_with(['+', '*']) {
            if let Some(card) = card.take() {
                take(card)?;
            }
            if first.trim_end_matches('*').trim().eq_ignore_ascii_case(name) {
                card = Some(Card { line, fields: Vec::new() });
                found = true;
            }
        }
        // An empty line that continues has no data, but would take memory.
        if let Some(card) = &mut card
            && (card.fields.is_empty() || fields.iter().any(|field| !field.is_empty()))
        {
            card.fields.extend(fields.into_iter().map(|field| (line, field)));
        }
    }
    if !found {
        return Err(Fault::whole(format!(
            "the file has no card {name}; write the matrices as {name}, for instance with EXTSEOUT(STIFFNESS,MASS,DMIGPCH)"
        )));
    }
    card.map_or(Ok(()), take)
}

/// The first field of a line, and those that hold data, four or eight of them.
fn split(text: &str) -> (String, Vec<String>) {
    let expanded = tabs(text);
    let free = expanded.contains(',');
    let chars: Vec<char> = expanded.chars().collect();
    let mut parts: Vec<String> = if free {
        expanded.split(',').map(|field| field.trim().to_owned()).collect()
    } else {
        let (start, rest) = chars.split_at(chars.len().min(8));
        let start: String = start.iter().collect();
        let width = if start.contains('*') { 16 } else { 8 };
        let field = |chars: &[char]| chars.iter().collect::<String>().trim().to_owned();
        [start].into_iter().chain(rest.chunks(width).map(field)).collect()
    };
    let count = if parts[0].contains('*') { 4 } else { 8 };
    let first = parts.remove(0);
    parts.resize(count, String::new());
    (first, parts)
}

/// A line with spaces up to the next column of 8 for each tab.
fn tabs(text: &str) -> String {
    let mut line = String::new();
    let mut width = 0;
    for character in text.chars() {
        if character == '\t' {
            let spaces = 8 - width % 8;
            line.extend(std::iter::repeat_n(' ', spaces));
            width += spaces;
        } else {
            line.push(character);
            width += 1;
        }
    }
    line
}
