//! Keys that a table may hold: those of a schema, and those of the alternative that a table chooses.

use super::kind::words;
use serde_json::{Map, Value};
use toml::de::{DeTable, DeValue};

/// The keys of a table, from one schema or several that hold together.
pub(super) struct Keys<'s> {
    /// Every key with the schema of its value.
    pub(super) properties: Vec<(&'s str, &'s Value)>,
    /// Keys that must be there.
    pub(super) required: Vec<&'s str>,
    /// Keys that must be there beside another key.
    pub(super) required_by: Vec<(&'s str, Vec<&'s str>)>,
    /// The schema of values under other keys, if those may be there.
    pub(super) others: Option<&'s Value>,
    /// `true` if there may be no other keys.
    pub(super) is_closed: bool,
}

impl<'s> Keys<'s> {
    pub(super) fn of(schemas: &[&'s Value]) -> Self {
        let mut keys = Self {
            properties: Vec::new(),
            required: Vec::new(),
            required_by: Vec::new(),
            others: None,
            is_closed: false,
        };
        for schema in schemas {
            keys.properties.extend(properties(schema));
            keys.required.extend(required(schema));
            keys.required_by.extend(dependencies(schema));
            match schema.get("additionalProperties") {
                Some(Value::Bool(false)) => keys.is_closed = true,
                other => keys.others = keys.others.or(other.filter(|other| other.is_object())),
            }
        }
        keys
    }

    pub(super) fn schema(&self, key: &str) -> Option<&'s Value> {
        self.properties.iter().find(|(known, _)| *known == key).map(|(_, schema)| *schema)
    }
}

pub(super) fn properties(schema: &Value) -> impl Iterator<Item = (&str, &Value)> {
    let properties = schema.get("properties").and_then(Value::as_object);
    properties.into_iter().flat_map(Map::iter).map(|(key, schema)| (&**key, schema))
}

fn required(schema: &Value) -> impl Iterator<Item = &str> {
    let required = schema.get("required").and_then(Value::as_array);
    required.into_iter().flatten().filter_map(Value::as_str)
}

fn dependencies(schema: &Value) -> impl Iterator<Item = (&str, Vec<&str>)> {
    let dependencies = schema.get("dependencies").and_then(Value::as_object);
    dependencies.into_iter().flat_map(Map::iter).map(|(key, others)| {
        let others = others.as_array().into_iter().flatten().filter_map(Value::as_str);
        (&**key, others.collect())
    })
}

/// The one of several alternatives that a table chooses.
pub(super) enum Choice<'s> {
    One(&'s Value),
    /// None of these keys is there, and one of them must be.
    Neither(Vec<&'s str>),
    /// Several of these keys are there, of which there may be one only.
    Several(Vec<&'s str>),
    /// This key, which names the alternative, has none of these values.
    NoSuch(&'s str, Vec<&'s str>),
}

/// Chooses by a key whose value names the alternative, or else by the keys that only one
/// alternative asks for.
pub(super) fn choose<'s>(table: &DeTable<'_>, alternatives: &[&'s Value]) -> Choice<'s> {
    if let [only] = alternatives {
        return Choice::One(only);
    }
    let tag =
        |schema: &'s Value| properties(schema).find(|(_, value)| value.get("const").is_some());
    if let Some((tag, _)) = alternatives.first().and_then(|first| tag(first)) {
        let name = |schema: &'s Value| {
            properties(schema)
                .find(|(key, _)| *key == tag)
                .and_then(|(_, value)| words(value).first().copied())
        };
        let given = table.get(tag).and_then(|value| match value.get_ref() {
            DeValue::String(text) => Some(&**text),
            _ => None,
        });
        let chosen = alternatives.iter().find(|schema| given.is_some() && name(schema) == given);
        return match chosen {
            Some(schema) => Choice::One(schema),
            None => {
                Choice::NoSuch(tag, alternatives.iter().filter_map(|schema| name(schema)).collect())
            }
        };
    }
    let own = |schema: &'s Value| -> Vec<&'s str> {
        let is_shared =
            |key: &str| alternatives.iter().all(|other| required(other).any(|known| known == key));
        required(schema).filter(|key| !is_shared(key)).collect()
    };
    let all: Vec<Vec<&str>> = alternatives.iter().map(|schema| own(schema)).collect();
    let is_there = |key: &&&str| table.contains_key(**key);
    let mut given: Vec<&str> = all.iter().flatten().filter(is_there).copied().collect();
    given.sort_unstable();
    given.dedup();
    // The alternative that accounts for every such key, and asks for the fewest others.
    let fitting =
        alternatives.iter().zip(&all).filter(|(_, own)| given.iter().all(|key| own.contains(key)));
    let lacking = |own: &[&str]| own.iter().filter(|key| !given.contains(key)).count();
    match fitting.min_by_key(|(_, own)| lacking(own)) {
        Some((schema, own)) if !given.is_empty() || own.is_empty() => Choice::One(schema),
        Some(_) => {
            let mut firsts: Vec<&str> = all.iter().filter_map(|own| own.first().copied()).collect();
            firsts.dedup();
            Choice::Neither(firsts)
        }
        None => Choice::Several(given),
    }
}
