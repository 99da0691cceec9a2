//! Kinds of values: names of the kind that a value has, names of the kinds that a schema takes, and examples.

use serde_json::Value;
use toml::de::DeValue;

/// The kind of a value, in the words of JSON Schema.
pub(super) fn found(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "string",
        DeValue::Integer(_) => "integer",
        DeValue::Float(_) => "number",
        DeValue::Boolean(_) => "boolean",
        DeValue::Datetime(_) => "date",
        DeValue::Array(_) => "array",
        DeValue::Table(_) => "object",
    }
}

/// The parts of a schema of which a value must fulfil one: its alternatives, or itself. That there is
/// nothing is no alternative: TOML has no null.
pub(super) fn alternatives(schema: &Value) -> Vec<&Value> {
    let parts = schema.get("oneOf").or_else(|| schema.get("anyOf")).and_then(Value::as_array);
    match parts {
        // Alternatives of an object with keys of its own go on from those.
        Some(parts) if schema.get("properties").is_none() => {
            let is_something = |part: &&Value| part["type"] != "null";
            parts.iter().filter(is_something).flat_map(alternatives).collect()
        }
        _ => vec![schema],
    }
}

/// The kinds that a schema without alternatives takes; none if it takes all.
pub(super) fn taken(schema: &Value) -> Vec<&str> {
    match schema.get("type") {
        Some(Value::String(kind)) => vec![kind],
        Some(Value::Array(kinds)) => {
            kinds.iter().filter_map(Value::as_str).filter(|&kind| kind != "null").collect()
        }
        _ if schema.get("const").is_some_and(Value::is_string) => vec!["string"],
        _ if schema.get("enum").is_some() => vec!["string"],
        _ if schema.get("properties").is_some() => vec!["object"],
        _ => Vec::new(),
    }
}

/// The kinds that a schema takes, in one or other of its alternatives.
fn kinds(schema: &Value) -> Vec<&str> {
    let mut kinds: Vec<&str> = alternatives(schema).into_iter().flat_map(taken).collect();
    kinds.dedup();
    kinds
}

/// `true` if a schema without alternatives takes a value of this kind. A whole number is a number too.
pub(super) fn takes(schema: &Value, kind: &str) -> bool {
    let kinds = taken(schema);
    kinds.is_empty()
        || kinds.iter().any(|&taken| taken == kind || (taken, kind) == ("number", "integer"))
}

/// A kind as a person would say it.
fn spoken_kind(kind: &str) -> &'static str {
    match kind {
        "string" => "a text",
        "integer" => "a whole number",
        "number" => "a number",
        "boolean" => "true or false",
        "array" => "a list",
        "object" => "a table",
        _ => "nothing",
    }
}

/// A value in plain words: its kind, or the value itself where that says more.
pub(super) fn spoken(value: &DeValue<'_>) -> String {
    match value {
        DeValue::Integer(integer) => integer.to_string(),
        DeValue::Float(float) => float.to_string(),
        DeValue::Boolean(boolean) => boolean.to_string(),
        DeValue::Datetime(_) => "a date".to_owned(),
        _ => spoken_kind(found(value)).to_owned(),
    }
}

/// The values that a schema takes, in plain words: "a number", "a list of numbers".
pub(super) fn wishes(schema: &Value) -> Vec<String> {
    let mut wishes: Vec<String> = Vec::new();
    let parts = alternatives(schema);
    let words: Vec<&str> = parts.iter().flat_map(|part| words(part)).collect();
    for part in parts {
        for kind in taken(part) {
            let items = part.get("items").filter(|_| kind == "array");
            let wish = match items.map(kinds).as_deref() {
                Some(["number"]) => "a list of numbers".to_owned(),
                Some(["integer"]) => "a list of whole numbers".to_owned(),
                Some(["string"]) => "a list of texts".to_owned(),
                Some(["object"]) => "a list of tables".to_owned(),
                None if kind == "string" && !words.is_empty() => quoted(&words),
                _ => spoken_kind(kind).to_owned(),
            };
            if !wishes.contains(&wish) {
                wishes.push(wish);
            }
        }
    }
    wishes
}

/// Words as a file has them, as a choice.
pub(super) fn quoted(words: &[&str]) -> String {
    let words: Vec<String> = words.iter().map(|word| format!("\"{word}\"")).collect();
    words.join(" or ")
}

/// A value that the schema takes, written as an example for this key of a table, or of the file itself.
pub(super) fn example(key: &str, schema: &Value, in_table: bool) -> Option<String> {
    let part = *alternatives(schema).first()?;
    let words = words(part);
    let value = match *taken(part).first()? {
        "string" => format!("\"{}\"", words.first().unwrap_or(&"text")),
        "integer" => "2".to_owned(),
        "number" => "0.5".to_owned(),
        "boolean" => "true".to_owned(),
        "array" if part.get("items").is_some_and(|items| kinds(items) == ["object"]) => {
            return Some(format!("[[{key}]]"));
        }
        "array" => {
            let items = part.get("items").and_then(|items| example("", items, true))?;
            let item = items.trim_start_matches(" = ").to_owned();
            let count = part.get("minItems").and_then(Value::as_u64).unwrap_or(1).clamp(1, 9);
            format!("[{}]", vec![item; usize::try_from(count).ok()?].join(", "))
        }
        "object" if in_table => {
            let choice = part.get("oneOf").and_then(|choices| choices.get(0)).unwrap_or(part);
            let required = choice.get("required").and_then(Value::as_array)?.iter();
            let inside = required.filter_map(Value::as_str);
            let inside = inside.filter_map(|key| example(key, &part["properties"][key], true));
            format!("{{ {} }}", inside.collect::<Vec<_>>().join(", "))
        }
        "object" => return Some(format!("[{key}]")),
        _ => return None,
    };
    Some(format!("{key} = {value}"))
}

/// The words that a text may be, if it may not be any.
pub(super) fn words(schema: &Value) -> Vec<&str> {
    let several = schema.get("enum").and_then(Value::as_array);
    let one = schema.get("const");
    several.into_iter().flatten().chain(one).filter_map(Value::as_str).collect()
}

/// The meaning of a value: the first line of its description.
pub(super) fn meaning(schema: &Value) -> Option<&str> {
    let description = schema.get("description").and_then(Value::as_str)?;
    description.lines().next().map(|line| line.trim_end_matches('.'))
}
