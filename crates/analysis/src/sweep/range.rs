//! Numbers, values and ranges as people write them on a command line.
//!
//! One grammar for all commands: `A:B:STEP` counts from A in steps and ends with B, `A:B/N` has N values. In commands
//! that once read `A:B:N` a whole third number is refused with both of its meanings ([`grid`]); where a step is a whole
//! number it is written with a point there, as `0:10:2.0`. They are to read [`steps`] too from the next release on.

use amontons::Error;
use amontons::decimal::to_significant;

/// The most values of a range.
pub const MAX_VALUES: f64 = 1e6;

/// The notation of a range.
const WISH: &str =
    "write it as A:B:STEP, such as 0:3.5:0.005, or as A:B/N for N values, such as 0:3.5/100";

/// A number.
///
/// # Errors
/// Returns an error if the text is no finite number; it gives the number that is meant, where a comma stands for its
/// point.
pub fn number(text: &str) -> Result<f64, String> {
    finite(text).ok_or_else(|| match with_point(text) {
        Some(meant) => format!("{text} is not a number; write {meant}"),
        None => format!("{text} is not a number"),
    })
}

fn finite(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|value: &f64| value.is_finite())
}

/// The possible meanings of a number with a comma: a decimal point, or thousands apart.
fn with_point(text: &str) -> Option<String> {
    let text = text.trim();
    let (whole, rest) = text.split_once(',')?;
    let decimal = format!("{whole}.{rest}");
    finite(&decimal)?;
    let digits = |text: &str| !text.is_empty() && text.chars().all(|c| c.is_ascii_digit());
    let are_thousands = rest.len() == 3 && digits(rest) && whole != "0" && digits(whole);
    Some(if are_thousands { format!("{decimal} or {whole}{rest}") } else { decimal })
}

/// A name and its value: `NAME=VALUE`.
///
/// # Errors
/// Returns an error if there is no name or no number; it gives the number that is meant.
pub fn assignment(text: &str) -> Result<(String, f64), String> {
    let (name, value) = text.split_once('=').ok_or("write it as NAME=VALUE")?;
    let (name, value) = (name.trim(), value.trim());
    match (finite(value), with_point(value)) {
        (Some(number), _) => Ok((name.to_owned(), number)),
        (None, Some(meant)) => Err(format!(
            "{value} is not a number; write it as {name}={meant}, with a decimal point"
        )),
        (None, None) => Err(format!(
            "{value} is not a number; write only the number, in SI units, such as {name}=0.5"
        )),
    }
}

/// Refuses a name that has two values.
///
/// # Errors
/// Returns an error that gives the name and both values.
pub fn check_once(values: &[(String, f64)]) -> Result<(), Error> {
    let twice = |(place, (name, second)): (usize, &(String, f64))| {
        let (_, first) = values[..place].iter().find(|(before, _)| before == name)?;
        Some(Error::argument(format!(
            "--set gives {name} twice, as {first} and as {second}; give it once"
        )))
    };
    values.iter().enumerate().find_map(twice).map_or(Ok(()), Err)
}

/// A number without the last digits, which rounding made: 0.3, not 0.30000000000000004.
#[must_use]
pub fn decimal(value: f64) -> f64 {
    to_significant(value, 14)
}

/// The parts of a range.
struct Range<'a> {
    ends: [f64; 2],
    rest: Rest<'a>,
}

enum Rest<'a> {
    /// STEP of `A:B:STEP`, as it is written.
    Third(&'a str),
    /// N of `A:B/N`, as it is written.
    Number(&'a str),
}

fn parsed(text: &str) -> Result<Range<'_>, String> {
    let (first, after) = text.split_once(':').ok_or(WISH)?;
    let (last, rest) = match (after.split_once(':'), after.split_once('/')) {
        (Some((last, step)), None) if !step.contains(':') => (last, Rest::Third(step)),
        (None, Some((last, count))) => (last, Rest::Number(count)),
        _ => return Err(WISH.to_owned()),
    };
    Ok(Range { ends: ascending(first, last)?, rest })
}

fn ascending(first: &str, last: &str) -> Result<[f64; 2], String> {
    let (first, last) = (number(first)?, number(last)?);
    if first < last {
        Ok([first, last])
    } else {
        Err("the first value must be below the last".into())
    }
}

/// Both ends of `A:B`.
///
/// # Errors
/// Returns an error if the text is not two numbers, the first below the last.
pub fn ends(text: &str) -> Result<[f64; 2], String> {
    match text.split_once(':') {
        Some((first, last)) if !last.contains([':', '/']) => ascending(first, last),
        _ => Err("write it as A:B, such as 0:2.5".to_owned()),
    }
}

/// The values of `A:B:STEP` or `A:B/N`.
///
/// Steps are counted from the first, never accumulated, and the last is there, on the grid or not.
///
/// # Errors
/// Returns an error if the text is no such range, or one of more than a million values.
pub fn steps(text: &str) -> Result<Vec<f64>, String> {
    match parsed(text)? {
        Range { ends, rest: Rest::Third(step) } => stepped(ends, number(step)?),
        Range { ends, rest: Rest::Number(count) } => spread(ends, count),
    }
}

/// The values of `A:B:STEP` or `A:B/N` in a command that once read `A:B:N`.
///
/// # Errors
/// Returns an error if the text is no such range, one of more than a million values, or one whose third number may be
/// either.
#[allow(clippy::cast_possible_truncation)]
pub fn grid(text: &str) -> Result<Vec<f64>, String> {
    if let Range { rest: Rest::Third(third), .. } = parsed(text)? {
        let value = number(third)?;
        if value >= 2.0 && value.fract() == 0.0 && !third.contains('.') {
            let ends = text.trim_end_matches(third).trim_end_matches(':');
            return Err(format!(
                "{text} is ambiguous, since {third} was the number of values in earlier versions: write {ends}/{value} for \
                 {value} values, or {ends}:{value}.0 for steps of {value}"
            ));
        }
    }
    steps(text)
}

#[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn stepped([first, last]: [f64; 2], step: f64) -> Result<Vec<f64>, String> {
    let count = ((last - first) / step * (1.0 + 1e-12)).floor();
    if step <= 0.0 || count > MAX_VALUES {
        return Err(format!("the step must be above zero and give at most {MAX_VALUES:e} values"));
    }
    if step > (last - first) * (1.0 + 1e-9) {
        return Err(format!(
            "the step {step} is longer than the range from {first} to {last}: write {first}:{last}/N for N values"
        ));
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

#[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn spread([first, last]: [f64; 2], count: &str) -> Result<Vec<f64>, String> {
    let count = number(count)?;
    if count.fract() != 0.0 || !(2.0..=MAX_VALUES).contains(&count) {
        return Err(format!("N must be a whole number from 2 to {MAX_VALUES}"));
    }
    let at = |i: usize| decimal(first + (last - first) * (i as f64 / (count - 1.0)));
    Ok((0..count as usize).map(at).collect())
}

/// A name and its range: `NAME=…`.
///
/// # Errors
/// Returns an error if there is no name, or if the range is invalid.
pub fn named<T>(
    text: &str,
    parse: impl Fn(&str) -> Result<T, String>,
) -> Result<(String, T), String> {
    let (name, values) =
        text.split_once('=').ok_or("write it as NAME=A:B:STEP, or as NAME=A:B/N for N values")?;
    Ok((name.trim().to_owned(), parse(values)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_and_numbers_of_values_are_written_alike_everywhere() {
        for read in [steps, grid] {
            assert_eq!(read("0:1:0.25").unwrap(), [0.0, 0.25, 0.5, 0.75, 1.0]);
            assert_eq!(read("0:1/5").unwrap(), [0.0, 0.25, 0.5, 0.75, 1.0]);
            assert_eq!(read("-1:0:0.4").unwrap(), [-1.0, -0.6, -0.2, 0.0]);
            assert_eq!(read("0:10:2.0").unwrap(), [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]);
            assert_eq!(read("0:3:1").unwrap(), [0.0, 1.0, 2.0, 3.0]);
            for (wrong, word) in [
                ("0", "A:B:STEP"),
                ("0:1", "A:B/N"),
                ("0:1:0.1/5", "A:B/N"),
                ("0/5:1", "A:B/N"),
                ("1:0:0.1", "below the last"),
                ("0:1/1", "from 2 to 1000000"),
                ("0:1/2.5", "whole number"),
                ("0:1:0", "above zero"),
                ("0:1:20.5", "longer than the range from 0 to 1: write 0:1/N"),
                ("0:1:1e-9", "at most 1e6 values"),
                ("0,5:1:0.1", "0,5 is not a number; write 0.5"),
                ("0:1:x", "x is not a number"),
                ("0:inf/3", "inf is not a number"),
            ] {
                let error = read(wrong).unwrap_err();
                assert!(error.contains(word), "{wrong}: {error}");
            }
        }
    }

    #[test]
    fn a_third_number_that_once_counted_values_is_not_taken_for_a_step() {
        assert_eq!(steps("0:10:2").unwrap().len(), 6);
        let error = grid("0:10:2").unwrap_err();
        assert!(error.contains("write 0:10/2 for 2 values, or 0:10:2.0 for steps of 2"), "{error}");
        assert_eq!(grid("0:10/2").unwrap(), [0.0, 10.0]);
        let error = grid("-0.3:0.3:1e3").unwrap_err();
        assert!(error.contains("-0.3:0.3/1000 for 1000 values, or -0.3:0.3:1000.0 "), "{error}");
    }

    #[test]
    fn a_comma_for_a_point_is_answered_by_the_number_that_is_meant() {
        for (text, meant) in [
            ("0,45", "0.45"),
            ("-1,5e-3", "-1.5e-3"),
            ("0,450", "0.450"),
            ("1,000", "1.000 or 1000"),
        ] {
            assert_eq!(number(text).unwrap_err(), format!("{text} is not a number; write {meant}"));
        }
        for text in ["1,000.5", "1,2,3", ",", "x,5"] {
            assert_eq!(number(text).unwrap_err(), format!("{text} is not a number"));
        }
        let error = assignment("friction.coefficient=0,45").unwrap_err();
        assert!(error.contains("write it as friction.coefficient=0.45"), "{error}");
        assert!(assignment("module[1].m1=5kg").unwrap_err().contains("write only the number"));
        assert_eq!(assignment(" a = 2 "), Ok(("a".to_owned(), 2.0)));
        assert!(ends("0:1:0.1").unwrap_err().contains("A:B, such as"));
        assert_eq!(ends("0:2.5"), Ok([0.0, 2.5]));
    }

    #[test]
    fn a_name_has_one_value() {
        let values = |second: &str| [("a".to_owned(), 1.0), (second.to_owned(), 2.5)];
        assert_eq!(check_once(&values("b")), Ok(()));
        let error = check_once(&values("a")).unwrap_err();
        assert!(error.is_argument() && error.to_string().contains("a twice, as 1 and as 2.5"));
    }
}
