//! Places in the document of problems that are given by a path.

use super::{Located, Problem};
use std::ops::Range;
use toml::de::{DeArray, DeTable, DeValue};

/// Finds a problem's place: its path, or as much of it as the document has (a number that stands for
/// a whole list has no items). The title then names what was found. `end` is the place of what is not
/// there at all.
pub(super) fn locate(document: &DeTable<'_>, problem: Problem, end: usize) -> Located {
    let mut span = end..end;
    let mut found = String::new();
    let mut table = Some(document);
    for part in problem.path.split('.') {
        let (key, indices) = part.split_once('[').unwrap_or((part, ""));
        let Some((known, mut value)) = table.and_then(|table| table.get_key_value(key)) else {
            break;
        };
        let separator = if found.is_empty() { "" } else { "." };
        found += &format!("{separator}{key}");
        span = place(&known.span(), value);
        for index in indices.trim_end_matches(']').split("][") {
            let item = |list: &DeArray<'_>| -> Option<usize> {
                index.parse::<usize>().ok()?.checked_sub(1).filter(|&index| index < list.len())
            };
            let DeValue::Array(list) = value.get_ref() else { break };
            let Some(item) = item(list) else { break };
            value = &list[item];
            found += &format!("[{index}]");
            span = value.span();
        }
        table = match value.get_ref() {
            DeValue::Table(table) => Some(table),
            _ => None,
        };
    }
    let problem = if found.is_empty() { problem } else { Problem { path: found, ..problem } };
    Located { span, title: problem.title(), help: problem.help }
}

/// The place at which a value is shown: itself, or its key where the value is a table without a header.
fn place(key: &Range<usize>, value: &toml::Spanned<DeValue<'_>>) -> Range<usize> {
    if value.span().is_empty() { key.clone() } else { value.span() }
}
