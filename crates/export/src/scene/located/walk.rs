//! A document held against a schema.

use super::kind::{self, alternatives, found, quoted, takes};
use super::object::{Choice, Keys, choose, properties};
use super::wording::{addition, no_such_word, table_name, wrong_kind};
use super::{Located, MOST_PROBLEMS, number};
use amontons::scene::Problem;
use amontons::scene::nearest;
use serde_json::Value;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeArray, DeString, DeTable, DeValue};

/// A problem that the walk has met.
pub(super) struct Walked {
    pub(super) problem: Located,
    /// `true` if something is missing. It may stand in a part that could not be read.
    pub(super) is_lack: bool,
}

/// Everything in which the document is not as the schema wants it. Keys that the schema does not
/// know are taken out of the document, or renamed where it is clear what they mean. `end` is the
/// place for what the document as a whole lacks.
pub(super) fn problems(
    document: &mut Spanned<DeTable<'_>>,
    schema: &Value,
    end: usize,
) -> Vec<Walked> {
    let mut walk = Walk { root: schema, met: Vec::new() };
    walk.table(document.get_mut(), end..end, &[schema], "");
    walk.met
}

struct Walk<'s> {
    root: &'s Value,
    met: Vec<Walked>,
}

impl<'s> Walk<'s> {
    fn report(&mut self, span: Range<usize>, problem: &Problem) {
        let problem = Located { span, title: problem.title(), help: problem.help.clone() };
        self.met.push(Walked { problem, is_lack: false });
    }

    fn value(&mut self, value: &mut Spanned<DeValue<'_>>, schema: &'s Value, path: &str) {
        if self.met.len() >= MOST_PROBLEMS {
            return;
        }
        let span = value.span();
        let kind = found(value.get_ref());
        let parts: Vec<&Value> =
            alternatives(schema).into_iter().filter(|part| takes(part, kind)).collect();
        if parts.is_empty() {
            let problem = wrong_kind(value.get_ref(), schema, path);
            return self.report(span, &problem);
        }
        let faults = |check: &dyn Fn(&Value) -> Result<(), number::Fault>| {
            parts.iter().map(|part| check(part)).collect::<Result<Vec<_>, _>>().err()
        };
        match value.get_mut() {
            DeValue::Float(float) => {
                if let Some((message, help)) = faults(&|part| number::float(float, part)) {
                    let shown = Problem::new(path, message).of(float.as_str()).help(help);
                    self.report(span, &shown);
                }
            }
            DeValue::Integer(integer) => {
                let is_real = !parts.iter().any(|part| kind::taken(part).contains(&"integer"));
                let check = |part: &Value| number::integer(integer, part, is_real);
                if let Some((message, help)) = faults(&check) {
                    let shown = Problem::new(path, message).of(&*integer).help(help);
                    self.report(span, &shown);
                }
            }
            DeValue::String(text) => {
                let words: Vec<&str> = parts.iter().flat_map(|part| kind::words(part)).collect();
                if !words.is_empty() && !words.contains(&&**text) {
                    self.report(span, &no_such_word(path, text, &words, Some(schema)));
                }
            }
            DeValue::Array(list) => self.list(list, span, parts[0], path),
            DeValue::Table(table) => self.table(table, span, &parts, path),
            DeValue::Boolean(_) | DeValue::Datetime(_) => {}
        }
    }

    fn list(&mut self, list: &mut DeArray<'_>, span: Range<usize>, schema: &'s Value, path: &str) {
        let limit = |keyword: &str| schema.get(keyword).and_then(Value::as_u64);
        let (least, most) = (limit("minItems"), limit("maxItems"));
        let length = list.len() as u64;
        if least.is_some_and(|least| length < least) || most.is_some_and(|most| length > most) {
            let wish = match (least, most) {
                (Some(least), Some(most)) if least == most => least.to_string(),
                (Some(least), Some(most)) => format!("{least} to {most}"),
                (Some(least), None) => format!("at least {least}"),
                (_, most) => format!("at most {}", most.unwrap_or(0)),
            };
            let items = if length == 1 { "item" } else { "items" };
            let message = format!("has {length} {items}, must have {wish}");
            let help = kind::meaning(schema).unwrap_or_default();
            self.report(span, &Problem::new(path, message).help(help));
        }
        for (i, item) in list.iter_mut().enumerate() {
            // One schema for all items, or one for each.
            let items = match schema.get("items") {
                Some(Value::Array(each)) => each.get(i),
                items => items,
            };
            if let Some(items) = items {
                self.value(item, items, &format!("{path}[{}]", i + 1));
            }
        }
    }

    fn table(
        &mut self,
        table: &mut DeTable<'_>,
        span: Range<usize>,
        parts: &[&'s Value],
        path: &str,
    ) {
        // An object with keys of its own and alternatives beside them, or alternatives alone.
        let beside = match parts {
            [one] => one.get("oneOf").or_else(|| one.get("anyOf")).and_then(Value::as_array),
            _ => None,
        };
        let (base, choices): (&[&Value], Vec<&Value>) = match beside {
            Some(choices) => (parts, choices.iter().collect()),
            None => (&[], parts.to_vec()),
        };
        let together = |more: &[&'s Value]| Keys::of(&[base, more].concat());
        let mut known = together(&choices);
        self.unknown_keys(table, &known, path);
        match choose(table, &choices) {
            Choice::One(chosen) => {
                known = together(&[chosen]);
                self.unknown_keys(table, &known, path);
            }
            choice => {
                // The other keys depend on the choice.
                known = Keys::of(base);
                self.no_choice(table, &span, (choice, &together(&choices)), path);
            }
        }
        self.missing_keys(table, &span, &known, path);
        for (key, value) in table.iter_mut() {
            if let Some(schema) = known.schema(key.get_ref()).or(known.others) {
                self.value(value, schema, &join(path, key.get_ref()));
            }
        }
    }

    /// Reports a key that is unknown here, and drops it, or renames it to the key that it is likely to mean.
    fn unknown_keys(&mut self, table: &mut DeTable<'_>, known: &Keys<'s>, path: &str) {
        if !known.is_closed || known.others.is_some() {
            return;
        }
        let is_unknown = |key: &&Spanned<DeString<'_>>| known.schema(key.get_ref()).is_none();
        let unknown = table.keys().filter(is_unknown).take(MOST_PROBLEMS);
        let unknown: Vec<_> = unknown.cloned().collect();
        for key in unknown {
            let keys = known.properties.iter().map(|(key, _)| *key);
            let meant = nearest(key.get_ref(), keys.clone());
            let help = match (meant, self.table_of(key.get_ref(), path)) {
                (Some(meant), _) => format!("did you mean `{meant}`?"),
                (None, Some(home)) => home,
                (None, None) => match keys.map(|key| format!("`{key}`")).collect::<Vec<_>>() {
                    keys if keys.len() == 1 => format!("its only key is {}", keys[0]),
                    keys => format!("its keys are {}", keys.join(", ")),
                },
            };
            let title = format!("`{}` is not a key of {}", key.get_ref(), table_name(path));
            let problem = Located { span: key.span(), title, help };
            self.met.push(Walked { problem, is_lack: false });
            let value = table.remove(&**key.get_ref());
            if let (Some(meant), Some(value)) = (meant, value)
                && !table.contains_key(meant)
            {
                table.insert(Spanned::new(key.span(), meant.to_owned().into()), value);
            }
        }
    }

    /// The other place in the file where this key belongs.
    fn table_of(&self, key: &str, path: &str) -> Option<String> {
        if !path.is_empty() && properties(self.root).any(|(known, _)| known == key) {
            return Some(format!(
                "`{key}` belongs to the whole file: write it above the first table"
            ));
        }
        properties(self.root).find_map(|(table, schema)| {
            let items = schema.get("items").filter(|items| items.is_object());
            let mut keys = alternatives(items.unwrap_or(schema)).into_iter().flat_map(properties);
            let name = if items.is_some() { format!("[[{table}]]") } else { format!("[{table}]") };
            let is_other = table_name(path) != name;
            (is_other && keys.any(|(known, _)| known == key))
                .then(|| format!("it is a key of {name}"))
        })
    }

    fn missing_keys(
        &mut self,
        table: &DeTable<'_>,
        span: &Range<usize>,
        known: &Keys<'s>,
        path: &str,
    ) {
        let required_by = known.required_by.iter().filter(|(key, _)| table.contains_key(*key));
        let required = required_by.flat_map(|(_, others)| others).chain(&known.required);
        let missing: Vec<&str> =
            required.filter(|key| !table.contains_key(**key)).copied().collect();
        let help: Vec<String> =
            missing.iter().map(|key| addition(path, key, known.schema(key))).collect();
        self.report_missing(span, &missing, &help, path);
    }

    fn report_missing(
        &mut self,
        span: &Range<usize>,
        missing: &[&str],
        help: &[String],
        path: &str,
    ) {
        if missing.is_empty() {
            return;
        }
        let keys: Vec<String> = missing.iter().map(|key| format!("`{key}`")).collect();
        let word = if keys.len() == 1 { "key" } else { "keys" };
        let title = format!("{} is missing the {word} {}", table_name(path), keys.join(", "));
        let problem =
            Located { span: span.clone(), title, help: format!("add {}", help.join("\n")) };
        self.met.push(Walked { problem, is_lack: true });
    }

    fn no_choice(
        &mut self,
        table: &DeTable<'_>,
        span: &Range<usize>,
        (choice, known): (Choice<'_>, &Keys<'s>),
        path: &str,
    ) {
        let listed = |keys: &[&str], word: &str| {
            let keys: Vec<String> = keys.iter().map(|key| format!("`{key}`")).collect();
            keys.join(word)
        };
        match choice {
            Choice::One(_) => {}
            Choice::Neither(keys) => {
                let title = format!("{} has neither {}", table_name(path), listed(&keys, " nor "));
                let with = |key: &&str| {
                    let mut added = addition(path, key, known.schema(key));
                    for (_, others) in known.required_by.iter().filter(|(by, _)| by == key) {
                        added += &format!(", with {}", listed(others, " and "));
                    }
                    added
                };
                let additions: Vec<String> = keys.iter().map(with).collect();
                let help = format!("give one of them: {}", additions.join("\nor "));
                let problem = Located { span: span.clone(), title, help };
                self.met.push(Walked { problem, is_lack: true });
            }
            Choice::Several(keys) => {
                let title = format!("{} has both {}", table_name(path), listed(&keys, " and "));
                let help = "give one of them and remove the other".to_owned();
                let last = keys.iter().filter_map(|key| table.get_key_value(*key));
                let last = last.map(|(key, _)| key.span()).max_by_key(|span| span.start);
                let problem = Located { span: last.unwrap_or(span.clone()), title, help };
                self.met.push(Walked { problem, is_lack: false });
            }
            Choice::NoSuch(tag, names) => match table.get(tag) {
                Some(value) => {
                    let given = value.get_ref().as_str().unwrap_or_default();
                    let problem = no_such_word(&join(path, tag), given, &names, None);
                    self.report(value.span(), &problem);
                }
                None => {
                    let help = format!("`{tag}` = {}", quoted(&names));
                    self.report_missing(span, &[tag], &[help], path);
                }
            },
        }
    }
}

fn join(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}
