//! Distributions as people write them, and draws from them.
//!
//! `uniform(A,B)`, `triangular(A,MODE,B)`, `normal(MEAN,SD)` and `lognormal(MEDIAN,SIGMA)`, with SIGMA the standard deviation of
//! the natural logarithm. A normal or lognormal distribution may have bounds, `normal(MEAN,SD,MIN:MAX)`: values beyond them
//! are cut off. In place of its numbers each takes a part of the scene's value v, `(±P%)`: uniform and triangular ones reach
//! from v (1 − P/100) to v (1 + P/100), a normal one has the standard deviation v P/100, a lognormal one the median v and
//! SIGMA = ln(1 + P/100).

use super::normal;
use crate::sweep::range::{ends, number};
use amontons::decimal::to_significant;
use std::fmt;

/// The notation of a distribution.
pub const WISH: &str = "write a distribution as uniform(A,B), triangular(A,MODE,B), normal(MEAN,SD), lognormal(MEDIAN,SIGMA), or with \
                        bounds as normal(MEAN,SD,MIN:MAX), or as a part of the scene's value, such as normal(±10%)";

/// A distribution as it is written.
#[derive(Clone, Debug, PartialEq)]
pub struct Distribution {
    family: Family,
    numbers: Numbers,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Family {
    Uniform,
    Triangular,
    Normal,
    Lognormal,
}

#[derive(Clone, Debug, PartialEq)]
enum Numbers {
    /// As the family has them.
    Given(Vec<f64>),
    /// A part of the scene's value, above 0.
    Part(f64),
}

impl Family {
    const ALL: [Self; 4] = [Self::Uniform, Self::Triangular, Self::Normal, Self::Lognormal];

    fn name(self) -> &'static str {
        match self {
            Self::Uniform => "uniform",
            Self::Triangular => "triangular",
            Self::Normal => "normal",
            Self::Lognormal => "lognormal",
        }
    }

    /// The number of its numbers, and their names.
    fn takes(self) -> (usize, &'static str) {
        match self {
            Self::Uniform => (2, "(A,B)"),
            Self::Triangular => (3, "(A,MODE,B)"),
            Self::Normal => (2, "(MEAN,SD) or (MEAN,SD,MIN:MAX)"),
            Self::Lognormal => (2, "(MEDIAN,SIGMA) or (MEDIAN,SIGMA,MIN:MAX)"),
        }
    }
}

impl fmt::Display for Distribution {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = self.family.name();
        match &self.numbers {
            Numbers::Part(part) => write!(f, "{name}(±{}%)", to_significant(100.0 * part, 14)),
            Numbers::Given(numbers) => match numbers[..] {
                [first, spread, low, high] => write!(f, "{name}({first},{spread},{low}:{high})"),
                _ => {
                    let numbers: Vec<String> = numbers.iter().map(f64::to_string).collect();
                    write!(f, "{name}({})", numbers.join(","))
                }
            },
        }
    }
}

impl Distribution {
    /// Reads a distribution.
    ///
    /// # Errors
    /// Returns the mistake, for the message of the command line.
    pub fn parse(text: &str) -> Result<Self, String> {
        let inner = text.trim().strip_suffix(')').and_then(|text| text.split_once('('));
        let (name, inner) = inner.ok_or_else(|| format!("{text} is no distribution; {WISH}"))?;
        let family = Family::ALL.into_iter().find(|family| family.name() == name.trim());
        let family =
            family.ok_or_else(|| format!("there is no distribution {}; {WISH}", name.trim()))?;
        let numbers = match inner.trim().strip_suffix('%') {
            Some(part) => Numbers::Part(percent(part)?),
            None => Numbers::Given(given(family, inner)?),
        };
        Ok(Self { family, numbers })
    }

    /// `true` if it is a part of the scene's value.
    #[must_use]
    pub fn is_relative(&self) -> bool {
        matches!(self.numbers, Numbers::Part(_))
    }

    /// The draws of a value that the scene gives as `nominal`, and that must lie within `rule`. A normal or lognormal
    /// distribution that reaches beyond `rule` is cut off there.
    ///
    /// # Errors
    /// Returns the reason, as the end of a sentence on the distribution, if it has impossible values or no values.
    pub fn draws(&self, nominal: f64, rule: [f64; 2]) -> Result<Draws, String> {
        let numbers = self.numbers_at(nominal)?;
        match (self.family, &numbers[..]) {
            (Family::Uniform, &[low, high]) => bounded([low, high], rule, Curve::Uniform),
            (Family::Triangular, &[low, mode, high]) => {
                bounded([low, high], rule, Curve::Triangular { mode })
            }
            (_, &[first, spread, ref bounds @ ..]) => {
                let is_log = self.family == Family::Lognormal;
                let bounds = if let &[low, high] = bounds { [low, high] } else { EVERYWHERE };
                cut_off(Bell { middle: first, spread, is_log }, bounds, rule)
            }
            _ => Err("has too few numbers".to_owned()),
        }
    }

    /// The numbers of the family with the scene's value.
    fn numbers_at(&self, value: f64) -> Result<Vec<f64>, String> {
        let part = match &self.numbers {
            Numbers::Given(numbers) => return Ok(numbers.clone()),
            Numbers::Part(part) => *part,
        };
        if value == 0.0 {
            return Err("is a part of the scene's value, which is 0; give numbers".to_owned());
        }
        let (low, high) = (value - part * value.abs(), value + part * value.abs());
        Ok(match self.family {
            Family::Uniform => vec![low, high],
            Family::Triangular => vec![low, value, high],
            Family::Normal => vec![value, part * value.abs()],
            Family::Lognormal if value < 0.0 => {
                return Err(format!(
                    "has only values above 0, but the scene's value is {value}; take normal(±P%)"
                ));
            }
            Family::Lognormal => vec![value, libm::log1p(part)],
        })
    }
}

const EVERYWHERE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

fn percent(text: &str) -> Result<f64, String> {
    let text = text.trim();
    let bare = text.strip_prefix('±').or(text.strip_prefix("+-")).unwrap_or(text);
    let percent = number(bare)?;
    if percent > 0.0 {
        Ok(percent / 100.0)
    } else {
        Err(format!("±{percent}% leaves nothing to vary; give a part above 0, such as ±10%"))
    }
}

/// The numbers of a family as they are written: bounds are two numbers behind the others.
fn given(family: Family, inner: &str) -> Result<Vec<f64>, String> {
    let name = family.name();
    let (before, bounds) = match inner.rsplit_once(',') {
        Some((before, last)) if last.contains(':') => (before, Some(last)),
        _ => (inner, None),
    };
    let mut numbers = before.split(',').map(number).collect::<Result<Vec<f64>, String>>()?;
    let (count, names) = family.takes();
    let has_bounds = matches!(family, Family::Normal | Family::Lognormal);
    if numbers.len() != count || bounds.is_some() && !has_bounds {
        return Err(format!(
            "{name}({inner}) is not {name}{names}; write it so, with points in decimal numbers, or as {name}(±P%)"
        ));
    }
    let ascend = numbers.windows(2).all(|two| two[0] <= two[1]) && numbers[0] < numbers[count - 1];
    if has_bounds {
        let [first, spread] = [numbers[0], numbers[1]];
        if spread <= 0.0 {
            return Err(format!("{name}({inner}) has a spread of {spread}; give one above 0"));
        }
        if family == Family::Lognormal && first <= 0.0 {
            return Err(format!("{name}({inner}) has a median of {first}; give one above 0"));
        }
    } else if !ascend {
        return Err(format!("{name}({inner}) does not ascend; write {name}{names} with A below B"));
    }
    if let Some(bounds) = bounds {
        let bounds =
            ends(bounds).map_err(|why| format!("bounds {bounds} of {name}({inner}): {why}"))?;
        numbers.extend(bounds);
    }
    Ok(numbers)
}

/// Draws from a distribution.
#[derive(Clone, Debug, PartialEq)]
pub struct Draws {
    curve: Curve,
    /// The least and the largest value.
    bounds: [f64; 2],
    /// The probability of the values that were cut off because they are impossible.
    pub cut_off: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Curve {
    Uniform,
    Triangular {
        mode: f64,
    },
    Bell {
        bell: Bell,
        /// Probabilities below the bounds; above them, if the bell is seen in a mirror.
        between: [f64; 2],
        /// `true` if probabilities are counted from above, where they are smaller and have more digits.
        is_mirrored: bool,
    },
}

/// A normal or lognormal distribution.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Bell {
    /// Mean, or median of the lognormal distribution.
    middle: f64,
    /// Standard deviation of the value, or of its logarithm.
    spread: f64,
    /// `true` if the logarithm is normal.
    is_log: bool,
}

impl Bell {
    /// A value in standard deviations from the middle.
    fn standard(self, value: f64) -> f64 {
        match self.is_log {
            true if value <= 0.0 => f64::NEG_INFINITY,
            true => libm::log(value / self.middle) / self.spread,
            false => (value - self.middle) / self.spread,
        }
    }

    fn value(self, standard: f64) -> f64 {
        let apart = self.spread * standard;
        if self.is_log { self.middle * libm::exp(apart) } else { self.middle + apart }
    }

    /// The probability between two values.
    fn between(self, bounds: [f64; 2]) -> f64 {
        let [low, high] = bounds.map(|bound| self.standard(bound));
        if low > 0.0 {
            normal::distribution(-low) - normal::distribution(-high)
        } else {
            normal::distribution(high) - normal::distribution(low)
        }
    }
}

impl Draws {
    /// The value at a probability above 0 and below 1: the inverse of the distribution.
    #[must_use]
    pub fn at(&self, probability: f64) -> f64 {
        let [low, high] = self.bounds;
        let value = match self.curve {
            Curve::Uniform => low + probability * (high - low),
            Curve::Triangular { mode } => {
                let rising = (mode - low) / (high - low);
                if probability < rising {
                    low + (probability * (high - low) * (mode - low)).sqrt()
                } else {
                    high - ((1.0 - probability) * (high - low) * (high - mode)).sqrt()
                }
            }
            Curve::Bell { bell, between: [from, to], is_mirrored } => {
                let part = if is_mirrored { 1.0 - probability } else { probability };
                let standard = normal::quantile(from + part * (to - from));
                bell.value(if is_mirrored { -standard } else { standard })
            }
        };
        value.clamp(low, high)
    }
}

/// Draws of a distribution whose bounds are its own.
fn bounded(bounds: [f64; 2], rule: [f64; 2], curve: Curve) -> Result<Draws, String> {
    let [low, high] = bounds;
    if low < rule[0] || high > rule[1] {
        let beyond = if low < rule[0] { low } else { high };
        return Err(format!("reaches {beyond}, which is impossible: {}", within(rule)));
    }
    Ok(Draws { curve, bounds, cut_off: 0.0 })
}

/// The largest probability of impossible values that is cut off, and not refused.
const MOST_CUT_OFF: f64 = 1e-3;

/// Draws of a bell that is cut off at bounds of its own, and at those of impossible values.
fn cut_off(bell: Bell, bounds: [f64; 2], rule: [f64; 2]) -> Result<Draws, String> {
    let own = bell.between(bounds);
    if own <= 0.0 {
        return Err("has no values between its bounds; give bounds nearer to its middle".to_owned());
    }
    let (low, high) = (bounds[0].max(rule[0]), bounds[1].min(rule[1]));
    // One tail at a time: their sum is small, and the difference of 1 and nearly 1 would be rounding.
    let beyond = |from: f64, to: f64| if from < to { bell.between([from, to]) } else { 0.0 };
    let cut_off =
        (beyond(bounds[0], low.min(bounds[1])) + beyond(high.max(bounds[0]), bounds[1])) / own;
    if cut_off > MOST_CUT_OFF {
        return Err(format!(
            "has impossible values with a probability of {cut_off:.2e}, above 1e-3: {}; give bounds within these, \
             a smaller spread, or lognormal(MEDIAN,SIGMA)",
            within(rule)
        ));
    }
    let is_mirrored = bell.standard(low) > 0.0;
    let ends = [low, high].map(|bound| {
        let standard = bell.standard(bound);
        normal::distribution(if is_mirrored { -standard } else { standard })
    });
    let between = if is_mirrored { [ends[1], ends[0]] } else { ends };
    Ok(Draws { curve: Curve::Bell { bell, between, is_mirrored }, bounds: [low, high], cut_off })
}

fn within([low, high]: [f64; 2]) -> String {
    match (low.is_finite(), high.is_finite()) {
        (true, true) => format!("values lie between {low} and {high}"),
        (true, false) => format!("values are not below {low}"),
        _ => "values are finite".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FREE: [f64; 2] = EVERYWHERE;
    const NOT_NEGATIVE: [f64; 2] = [0.0, f64::INFINITY];

    fn draws(text: &str, nominal: f64, rule: [f64; 2]) -> Result<Draws, String> {
        Distribution::parse(text).unwrap().draws(nominal, rule)
    }

    #[test]
    fn draws_are_the_inverse_of_each_distribution() {
        let at = |text: &str, nominal: f64, p: f64| draws(text, nominal, FREE).unwrap().at(p);
        let is = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{found}");
        is(at("uniform(1,3)", 0.0, 0.25), 1.5);
        is(at("uniform(±10%)", 2.0, 0.0), 1.8);
        is(at("uniform(+-10%)", -2.0, 1.0), -1.8);
        is(at("triangular(0,1,4)", 0.0, 0.25), 1.0);
        // Above the mode, the part (4 − x)² / 12 is left: x = 3 leaves 1/12.
        is(at("triangular(0,1,4)", 0.0, 11.0 / 12.0), 3.0);
        is(at("triangular(±50%)", 2.0, 0.5), 2.0);
        is(at("normal(0.4,0.05)", 0.0, 0.975), 0.4 + 0.05 * 1.959_963_984_540_054);
        is(at("normal(10%)", -2.0, 0.975), -2.0 + 0.2 * 1.959_963_984_540_054);
        is(at("lognormal(3,0.5)", 0.0, 0.5), 3.0);
        is(at("lognormal(±10%)", 2.0, 0.841_344_746_068_543), 2.0 * 1.1);
        // Half of what is above the mean.
        is(at("normal(1,2,1:1e9)", 0.0, 0.5), 1.0 + 2.0 * 0.674_489_750_196_082);
    }

    #[test]
    fn a_far_tail_keeps_its_digits() {
        // The density of a standard normal value above 9 falls like exp(−9 x), so the median is ln 2 / 9.1 above it.
        let found = draws("normal(0,1,9:40)", 0.0, FREE).unwrap().at(0.5);
        assert!((found - 9.0 - 2_f64.ln() / 9.1).abs() < 2e-3, "{found}");
        let mirrored = draws("normal(0,1,-40:-9)", 0.0, FREE).unwrap().at(0.5);
        assert!((mirrored + found).abs() < 1e-12);
    }

    #[test]
    fn impossible_values_are_cut_off_if_they_are_rare_and_refused_if_not() {
        let error = draws("uniform(-0.1,0.5)", 0.0, NOT_NEGATIVE).unwrap_err();
        assert!(error.starts_with("reaches -0.1, which is impossible: values are not below 0"));
        let error = draws("triangular(±150%)", 1.0, NOT_NEGATIVE).unwrap_err();
        assert!(error.starts_with("reaches -0.5"), "{error}");
        let error = draws("uniform(1,2)", 0.0, [-1.5, 1.5]).unwrap_err();
        assert!(error.starts_with("reaches 2, which is impossible: values lie between"), "{error}");
        // 4 standard deviations: 3.17e-5; 3: 1.35e-3.
        let rare = draws("normal(4,1)", 0.0, NOT_NEGATIVE).unwrap();
        assert!((rare.cut_off - 3.167e-5).abs() < 1e-8 && rare.at(1e-12) >= 0.0);
        let error = draws("normal(3,1)", 0.0, NOT_NEGATIVE).unwrap_err();
        assert!(error.contains("probability of 1.35e-3"), "{error}");
        assert_eq!(draws("normal(3,1,0.5:5)", 0.0, NOT_NEGATIVE).unwrap().cut_off, 0.0);
        assert_eq!(draws("lognormal(3,1)", 0.0, NOT_NEGATIVE).unwrap().cut_off, 0.0);
        let error = draws("uniform(±10%)", 0.0, FREE).unwrap_err();
        assert!(error.contains("which is 0; give numbers"), "{error}");
        let error = draws("lognormal(±10%)", -1.0, FREE).unwrap_err();
        assert!(error.contains("take normal(±P%)"), "{error}");
        let error = draws("normal(0,1,50:60)", 0.0, FREE).unwrap_err();
        assert!(error.contains("no values between its bounds"), "{error}");
    }

    #[test]
    fn what_is_no_distribution_is_refused_with_what_would_be_one() {
        for (text, words) in [
            ("0.4", "0.4 is no distribution; write a distribution as uniform(A,B)"),
            ("gauss(0,1)", "there is no distribution gauss; write a distribution as"),
            ("normal(0.4)", "is not normal(MEAN,SD) or (MEAN,SD,MIN:MAX); write it so"),
            ("normal(0,4,0,05)", "with points in decimal numbers"),
            ("uniform(0,1,0:1)", "is not uniform(A,B)"),
            (
                "normal(0.4,0.1,2:1)",
                "bounds 2:1 of normal(0.4,0.1,2:1): the first value must be below",
            ),
            ("uniform(2,1)", "does not ascend; write uniform(A,B) with A below B"),
            ("uniform(1,1)", "does not ascend"),
            ("triangular(1,5,2)", "does not ascend; write triangular(A,MODE,B)"),
            ("normal(1,0)", "has a spread of 0; give one above 0"),
            ("lognormal(-1,0.1)", "has a median of -1; give one above 0"),
            ("normal(±0%)", "leaves nothing to vary"),
            ("normal(x,1)", "x is not a number"),
        ] {
            let error = Distribution::parse(text).unwrap_err();
            assert!(error.contains(words), "{text}: {error}");
        }
    }

    #[test]
    fn a_distribution_is_written_as_it_is_read() {
        for text in ["normal(±10%)", "uniform(1,2)", "lognormal(1,0.5,0.25:4)"] {
            assert_eq!(Distribution::parse(text).unwrap().to_string(), text);
        }
    }
}
