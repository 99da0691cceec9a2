//! Ranges as people write them: `A:B:N` and `A:B:STEP`.

/// The most values of a range.
pub const MAX_VALUES: f64 = 1e6;

/// A number.
///
/// # Errors
/// It is none, or not finite.
pub fn number(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("{text} is not a number")),
    }
}

/// Three numbers with colons between them, the first below the second.
///
/// # Errors
/// What is wrong with them; `wish` where they are not three.
pub fn three(text: &str, wish: &str) -> Result<[f64; 3], String> {
    let parts: Vec<&str> = text.split(':').collect();
    let [first, last, third] = parts[..] else { return Err(wish.to_owned()) };
    let [first, last, third] = [number(first)?, number(last)?, number(third)?];
    if first < last {
        Ok([first, last, third])
    } else {
        Err("the first value must be below the last".into())
    }
}

/// A number without the last digits, which rounding made: 0.3, not 0.30000000000000004.
#[must_use]
pub fn decimal(value: f64) -> f64 {
    format!("{value:.13e}").parse().unwrap_or(value)
}

/// The values of `A:B:N`: first, last, how many, from 2 to 10 000.
///
/// # Errors
/// It is no such range.
#[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss)]
pub fn grid(text: &str) -> Result<Vec<f64>, String> {
    let [first, last, count] = three(text, "write it as A:B:N, such as 0:3.5:100")?;
    if count.fract() != 0.0 || !(2.0..=10_000.0).contains(&count) {
        return Err("N must be a whole number from 2 to 10000".to_owned());
    }
    let at = |i: usize| decimal(first + (last - first) * (i as f64 / (count - 1.0)));
    Ok((0..count as usize).map(at).collect())
}

/// The values of `A:B:STEP`, counted from the first, never accumulated, and the last, on the grid or not.
///
/// # Errors
/// It is no such range, or one of more than a million values.
#[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss)]
pub fn steps(text: &str) -> Result<Vec<f64>, String> {
    let [first, last, step] = three(text, "write it as A:B:STEP, such as 0:3.5:0.005")?;
    let count = ((last - first) / step * (1.0 + 1e-12)).floor();
    if step <= 0.0 || count > MAX_VALUES {
        return Err(format!("the step must be above zero and give at most {MAX_VALUES:e} values"));
    }
    let mut values: Vec<f64> =
        (0..=count as usize).map(|i| decimal(first + i as f64 * step)).collect();
    if let Some(end) = values.last_mut().filter(|end| last - **end < 1e-9 * step) {
        *end = last;
    } else {
        values.push(last);
    }
    Ok(values)
}

/// A name and its range: `NAME=…`.
///
/// # Errors
/// There is no name, or what is wrong with the range.
pub fn named<T>(
    text: &str,
    parse: impl Fn(&str) -> Result<T, String>,
) -> Result<(String, T), String> {
    let (name, values) = text.split_once('=').ok_or("write it as NAME=A:B:…")?;
    Ok((name.trim().to_owned(), parse(values)?))
}
