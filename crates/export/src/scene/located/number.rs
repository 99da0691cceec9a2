//! Numbers against their schema.

use serde_json::Value;
use toml::de::{DeFloat, DeInteger};

/// The largest integer up to which a double holds every whole number.
const EXACT: u64 = 1 << 53;

/// The problem with a number, and a valid alternative.
pub(super) type Fault = (String, String);

pub(super) fn float(number: &DeFloat<'_>, schema: &Value) -> Result<(), Fault> {
    let written = number.as_str();
    let value: f64 = written.parse().unwrap_or(f64::NAN);
    if !value.is_finite() {
        let is_literal = written.contains("inf") || written.contains("nan");
        let help = if is_literal { "" } else { "the largest double is about 1.8e308" };
        return Err(("must be a finite number".to_owned(), help.to_owned()));
    }
    bounds(value, schema)
}

#[allow(clippy::cast_precision_loss)]
pub(super) fn integer(number: &DeInteger<'_>, schema: &Value, is_real: bool) -> Result<(), Fault> {
    let Ok(value) = i64::from_str_radix(number.as_str(), number.radix()) else {
        // A bound that is broken too is the better explanation.
        let near = number.as_str().parse().ok().filter(|_| number.radix() == 10);
        return near
            .map_or(Ok(()), |near| bounds(near, schema))
            .and(Err(too_large(number, is_real)));
    };
    if is_real && value.unsigned_abs() > EXACT {
        return Err(too_large(number, is_real));
    }
    bounds(value as f64, schema)
}

fn too_large(number: &DeInteger<'_>, is_real: bool) -> Fault {
    let help = match is_real {
        true if number.radix() == 10 => format!("write it as {number}.0"),
        true => "write it as a decimal number, such as 1.0e16".to_owned(),
        false => "write a smaller one".to_owned(),
    };
    ("this whole number is too large to be held exactly".to_owned(), help)
}

/// Holds a number to the schema's bounds, in the schema's own words if it has any.
fn bounds(value: f64, schema: &Value) -> Result<(), Fault> {
    let bound = |keyword: &str| schema.get(keyword).and_then(Value::as_f64);
    let (least, above) = (bound("minimum"), bound("exclusiveMinimum"));
    let (most, below) = (bound("maximum"), bound("exclusiveMaximum"));
    let kept = least.is_none_or(|bound| value >= bound)
        && above.is_none_or(|bound| value > bound)
        && most.is_none_or(|bound| value <= bound)
        && below.is_none_or(|bound| value < bound);
    if kept {
        return Ok(());
    }
    if let Some(words) = schema.get("errorMessage").and_then(Value::as_str) {
        return Err((words.to_owned(), String::new()));
    }
    let low = least
        .map(|least| format!("at least {least}"))
        .or(above.map(|above| format!("above {above}")));
    let high =
        most.map(|most| format!("at most {most}")).or(below.map(|below| format!("below {below}")));
    if let (Some(least), Some(most)) = (least, most) {
        return Err((format!("must be from {least} to {most}"), String::new()));
    }
    let words: Vec<String> = low.into_iter().chain(high).collect();
    Err((format!("must be {}", words.join(" and ")), String::new()))
}
