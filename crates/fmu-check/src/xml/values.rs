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
    Moment,
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
            Self::Moment => {
                is(moment(value).is_some(), "a date and time, such as 2024-12-31T23:59:59Z")
            }
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

/// Parses a date and time as XML schemas define it (`xs:dateTime`). Returns what follows the seconds: a fraction of a
/// second and the time zone, both of which may be absent.
pub(crate) fn moment(value: &str) -> Option<&str> {
    let value = value.trim_ascii();
    let (head, tail) = value.split_at_checked(19)?;
    let shape: String = head.chars().map(|c| if c.is_ascii_digit() { '0' } else { c }).collect();
    if shape != "0000-00-00T00:00:00" {
        return None;
    }
    let number = |at: usize| head[at..at + 2].parse().unwrap_or(99_u32);
    let is_day = (1..=12).contains(&number(5)) && (1..=31).contains(&number(8));
    let is_time =
        number(11) < 24 && number(14) < 60 && number(17) < 60 || &head[11..] == "24:00:00";
    let zone = match tail.strip_prefix('.') {
        Some(fraction) => {
            let zone = fraction.trim_start_matches(|c: char| c.is_ascii_digit());
            (zone.len() < fraction.len()).then_some(zone)?
        }
        None => tail,
    };
    (is_day && is_time && is_zone(zone)).then_some(tail)
}

fn is_zone(zone: &str) -> bool {
    let Some(offset) = zone.strip_prefix(['+', '-']) else { return matches!(zone, "" | "Z") };
    let digits = |text: &str| text.len() == 2 && text.bytes().all(|byte| byte.is_ascii_digit());
    offset.split_once(':').is_some_and(|(hours, minutes)| {
        digits(hours) && digits(minutes) && hours <= "14" && minutes <= "59"
    })
}

#[cfg(test)]
mod tests {
    use super::moment;

    #[test]
    fn moments_are_those_of_xml_schemas() {
        for (text, tail) in [
            ("2024-12-31T23:59:59Z", "Z"),
            ("2024-12-31T23:59:59", ""),
            ("2024-12-31T24:00:00.25+01:00", ".25+01:00"),
        ] {
            assert_eq!(moment(text), Some(tail), "{text}");
        }
        for text in [
            "",
            "2024-12-31",
            "2024-13-31T23:59:59Z",
            "2024-12-31 23:59:59Z",
            "2024-12-31T23:60:00Z",
            "2024-12-31T23:59:59.Z",
            "2024-12-31T23:59:59+1",
            "2024-12-31T23:59:5é",
        ] {
            assert_eq!(moment(text), None, "{text}");
        }
    }
}
