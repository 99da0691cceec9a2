//! The types of attributes in the schema.

/// The type of an attribute's value.
#[derive(Clone, Copy, Debug)]
pub(super) enum Type {
    Text,
    Boolean,
    Integer,
    Count,
    Double,
    Word(&'static [&'static str]),
    Counts,
    Words(&'static [&'static str]),
}

/// The mistake in a value.
pub(super) enum InvalidValue {
    Value(String),
    NotFinite,
}

impl Type {
    pub(super) fn check(self, value: &str) -> Result<(), InvalidValue> {
        let is = |right: bool, what: &str| {
            if right { Ok(()) } else { Err(InvalidValue::Value(what.to_owned())) }
        };
        match self {
            Self::Text => Ok(()),
            Self::Boolean => is(boolean(value).is_some(), "true or false"),
            Self::Integer => is(integer(value).is_some(), "a 32-bit integer"),
            Self::Count => is(count(value).is_some(), "a whole number from 0 to 4294967295"),
            Self::Double => match value.trim_ascii().parse::<f64>() {
                Ok(number) if !number.is_finite() => Err(InvalidValue::NotFinite),
                Ok(_) => Ok(()),
                Err(_) => is(false, "a number"),
            },
            Self::Word(words) => {
                is(words.contains(&value.trim_ascii()), &format!("one of {}", words.join(", ")))
            }
            Self::Counts => is(
                value.split_ascii_whitespace().all(|part| count(part).is_some()),
                "a list of whole numbers",
            ),
            Self::Words(words) => is(
                value.split_ascii_whitespace().all(|part| words.contains(&part)),
                &format!("a list of the words {}", words.join(", ")),
            ),
        }
    }
}

pub(crate) fn boolean(value: &str) -> Option<bool> {
    match value.trim_ascii() {
        "true" | "1" => Some(true),
        "false" | "0" => Some(false),
        _ => None,
    }
}

pub(crate) fn integer(value: &str) -> Option<i32> {
    value.trim_ascii().parse().ok()
}

pub(crate) fn count(value: &str) -> Option<u32> {
    value.trim_ascii().parse().ok()
}

/// Parses a finite number.
pub(crate) fn double(value: &str) -> Option<f64> {
    value.trim_ascii().parse().ok().filter(|number: &f64| number.is_finite())
}
