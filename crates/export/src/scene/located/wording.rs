//! Wording of the walk's problems.

use super::kind::{self, alternatives, quoted, spoken, takes, wishes};
use amontons::scene::Problem;
use amontons::scene::nearest;
use serde_json::Value;
use toml::de::DeValue;

/// A table as its header names it.
pub(super) fn table_name(path: &str) -> String {
    if path.is_empty() {
        return "the file".to_owned();
    }
    let (is_item, mut name, mut inside) = (path.ends_with(']'), String::new(), false);
    for c in path.chars() {
        inside = c == '[' || inside && c != ']';
        if !inside && c != ']' {
            name.push(c);
        }
    }
    if is_item { format!("[[{name}]]") } else { format!("[{name}]") }
}

/// A text that is none of the words that are possible; what the schema takes, if it is not these alone.
pub(super) fn no_such_word(
    path: &str,
    text: &str,
    words: &[&str],
    schema: Option<&Value>,
) -> Problem {
    let wish = schema.map_or_else(|| quoted(words), |schema| wishes(schema).join(", or "));
    let problem = Problem::new(path, format!("must be {wish}")).of(format!("{text:?}"));
    match nearest(text, words.iter().copied()) {
        Some(meant) => problem.help(format!("did you mean \"{meant}\"?")),
        None => problem.help(schema.and_then(kind::meaning).unwrap_or_default()),
    }
}

/// The text to add for a key that is missing in the table at `path`, with its meaning.
pub(super) fn addition(path: &str, key: &str, schema: Option<&Value>) -> String {
    let example = schema.and_then(|schema| kind::example(key, schema, !path.is_empty()));
    let written = match example {
        Some(table) if table.starts_with('[') || table.ends_with('}') => table,
        _ => format!("{key} = …"),
    };
    match schema.and_then(kind::meaning) {
        Some(meaning) => format!("`{written}` ({meaning})"),
        None => format!("`{written}`"),
    }
}

/// A value of another kind than the schema wants.
pub(super) fn wrong_kind(value: &DeValue<'_>, schema: &Value, path: &str) -> Problem {
    let key = path.rsplit('.').next().unwrap_or(path).split('[').next().unwrap_or(path);
    let is_item = path.ends_with(']');
    let wishes = wishes(schema).join(", or ");
    let takes = |kind: &str| alternatives(schema).into_iter().any(|part| takes(part, kind));
    let write =
        |value: &str| if is_item { format!("`{value}`") } else { format!("`{key} = {value}`") };
    let help = match value {
        DeValue::String(text) if takes("number") || takes("integer") => {
            let number = text.trim().replace(',', ".");
            let begins_as_one =
                number.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
            if number.parse::<f64>().is_ok() {
                Some(format!("write it without quotes: {}", write(&number)))
            } else if begins_as_one {
                let meaning = kind::meaning(schema);
                let unit = meaning.map_or_else(String::new, |meaning| format!(" ({meaning})"));
                // The number depends on the unit that stands there.
                Some(format!("write the number alone, without its unit: {}{unit}", write("…")))
            } else {
                None
            }
        }
        DeValue::Float(float) if takes("integer") => {
            let whole = float.as_str().parse::<f64>().ok().filter(|value| value.fract() == 0.0);
            whole.map(|value| format!("write it without a point: {}", write(&value.to_string())))
        }
        DeValue::Table(_) if takes("array") && wishes == "a list of tables" => {
            Some(format!("write `[[{key}]]`, with two brackets"))
        }
        DeValue::Array(_) if takes("object") && !path.contains('.') => {
            Some(format!("write `[{key}]`, once and with single brackets"))
        }
        DeValue::Integer(_) | DeValue::Float(_) if takes("string") => {
            Some("write it in quotes".to_owned())
        }
        _ => None,
    };
    let help = help.or_else(|| {
        let example = kind::example(key, schema, path.contains('.')).filter(|_| !is_item)?;
        let meaning =
            kind::meaning(schema).map_or_else(String::new, |meaning| format!(" ({meaning})"));
        Some(format!("write it as in `{example}`{meaning}"))
    });
    Problem::new(path, format!("must be {wishes}, not {}", spoken(value)))
        .help(help.unwrap_or_default())
}
