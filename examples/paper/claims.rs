//! Claims and their verdicts.

use amontons_cli::say;
use amontons_pictures::report::{Claim, Page, Verdict};

/// A claim that holds if `holds` is `true`; `reason` explains a failure if it is known.
pub fn claim(paper: &str, found: String, holds: bool, reason: Option<&str>) -> Claim {
    let verdict =
        if holds { Verdict::Holds } else { Verdict::Differs { reason: reason.map(str::to_owned) } };
    Claim { paper: paper.to_owned(), found, verdict }
}

/// A claim that the computed results cannot decide; `decided_by` names the data that would.
pub fn unknown(paper: &str, found: String, decided_by: &str) -> Claim {
    let verdict = Verdict::Unknown { decided_by: decided_by.to_owned() };
    Claim { paper: paper.to_owned(), found, verdict }
}

/// Half of the last digit of a number as the paper prints it: 0.5 of "168", 5 of "170", 0.05 of "0.6". Zeros that
/// end a whole number are no digits, as such numbers are read off a plot.
pub fn half_digit(printed: &str) -> f64 {
    let power = |places: usize| 10_f64.powf(places as f64);
    match printed.split_once('.') {
        Some((_, decimals)) => 0.5 / power(decimals.len()),
        None => 0.5 * power(printed.len() - printed.trim_end_matches('0').len()),
    }
}

/// `true` if a value is within half of the last digit of a number that the paper prints.
pub fn is_about(value: f64, printed: &str) -> bool {
    let number: f64 = printed.parse().expect("the text is a number");
    // A value on the edge still rounds to the number.
    (value - number).abs() <= half_digit(printed) * (1.0 + 1e-9)
}

/// Prints all claims on standard output.
pub fn print(page: &Page) {
    let claims = || page.sections.iter().flat_map(|section| &section.claims);
    for claim in claims() {
        let verdict = match claim.verdict {
            Verdict::Holds => "holds  ",
            Verdict::Differs { .. } => "differs",
            Verdict::Unknown { .. } => "unknown",
        };
        say!("{verdict}  {}", claim.paper);
        say!("         {}", claim.found);
    }
    let hold = claims().filter(|claim| claim.verdict.holds()).count();
    say!("\n{hold} of {} claims hold", claims().count());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn about_is_half_of_the_last_digit_printed() {
        for (printed, least, most) in [
            ("168", 167.5, 168.5),
            ("170", 165.0, 175.0),
            ("0.6", 0.55, 0.65),
            ("2.0", 1.95, 2.05),
            ("1", 0.5, 1.5),
        ] {
            assert!(is_about(least, printed) && is_about(most, printed), "{printed}");
            let step = 0.01 * (most - least);
            assert!(
                !is_about(least - step, printed) && !is_about(most + step, printed),
                "{printed}"
            );
        }
        assert!(!is_about(f64::NAN, "168"));
    }
}
