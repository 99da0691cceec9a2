//! A value given once for all modules, or as a list with one number for each module.

use serde::de::{Deserializer, SeqAccess, Visitor};
use serde::{Deserialize, de};
use std::fmt;

#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(untagged))]
pub(super) enum PerModule {
    /// One number for all modules.
    Same(f64),
    /// A list with one number for each module.
    Each(Vec<f64>),
}

impl PerModule {
    /// The value of module `i` (from 0); `None` if a list is too short.
    pub(super) fn of(&self, i: usize) -> Option<f64> {
        match self {
            Self::Same(value) => Some(*value),
            Self::Each(values) => values.get(i).copied(),
        }
    }

    /// Length of the list; `None` for one number.
    pub(super) fn length(&self) -> Option<usize> {
        match self {
            Self::Same(_) => None,
            Self::Each(values) => Some(values.len()),
        }
    }
}

impl<'de> Deserialize<'de> for PerModule {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct NumberOrList;

        impl<'de> Visitor<'de> for NumberOrList {
            type Value = PerModule;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number, or a list with one number for each module")
            }

            fn visit_f64<E: de::Error>(self, value: f64) -> Result<PerModule, E> {
                Ok(PerModule::Same(value))
            }

            fn visit_i64<E: de::Error>(self, value: i64) -> Result<PerModule, E> {
                number(value).map(PerModule::Same)
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<PerModule, A::Error> {
                let mut values = Vec::new();
                while let Some(value) = list.next_element()? {
                    values.push(value);
                }
                Ok(PerModule::Each(values))
            }
        }

        deserializer.deserialize_any(NumberOrList)
    }
}

/// Accepts a whole number as a number if a double holds it exactly.
#[allow(clippy::cast_precision_loss)]
fn number<E: de::Error>(value: i64) -> Result<f64, E> {
    if value.unsigned_abs() <= 1 << 53 {
        Ok(value as f64)
    } else {
        Err(E::custom("this whole number is too large to be held exactly; write it as 1.0e16"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Deserialize)]
    struct Document {
        value: PerModule,
    }

    fn parse(value: &str) -> Result<PerModule, toml::de::Error> {
        toml::from_str::<Document>(&format!("value = {value}")).map(|document| document.value)
    }

    #[test]
    fn one_number_serves_all_modules() {
        assert_eq!(parse("55e3"), Ok(PerModule::Same(55e3)));
        assert_eq!(parse("55000"), Ok(PerModule::Same(55e3)));
    }

    #[test]
    fn a_list_gives_each_module_its_own() {
        assert_eq!(parse("[1, 2.5]"), Ok(PerModule::Each(vec![1.0, 2.5])));
    }

    #[test]
    fn anything_else_says_what_would_be_right() {
        let message = parse("\"55e3\"").unwrap_err().to_string();
        assert!(
            message.contains("a number, or a list with one number for each module"),
            "{message}"
        );
    }
}
