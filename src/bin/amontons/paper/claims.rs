//! Claims and their verdicts.

use amontons::report::{Claim, Page, Verdict};

/// A claim that holds if a condition does; why it does not, where that is known.
pub fn claim(paper: &str, found: String, holds: bool, reason: Option<&str>) -> Claim {
    let verdict =
        if holds { Verdict::Holds } else { Verdict::Differs { reason: reason.map(str::to_owned) } };
    Claim { paper: paper.to_owned(), found, verdict }
}

/// What the paper calls “about” is within this part: it reads off plots.
pub const ABOUT: f64 = 0.1;

/// Is a value about what the paper says?
pub fn is_about(value: f64, paper: f64) -> bool {
    (value / paper - 1.0).abs() <= ABOUT
}

/// All claims on standard output.
pub fn print(page: &Page) {
    let claims = || page.sections.iter().flat_map(|section| &section.claims);
    for claim in claims() {
        let verdict = if claim.verdict.holds() { "holds  " } else { "differs" };
        println!("{verdict}  {}", claim.paper);
        println!("         {}", claim.found);
    }
    let hold = claims().filter(|claim| claim.verdict.holds()).count();
    println!("\n{hold} of {} claims hold", claims().count());
}
