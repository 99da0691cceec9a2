//! Suggestions for misspelt words: "did you mean …?"

use strsim::damerau_levenshtein;

/// Returns the candidate that `word` most likely means: up to a third of its letters wrong, left out, added or
/// swapped. `None` if there is none, or if several are equally near.
#[must_use]
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let lower = word.to_lowercase();
    let allowed = word.chars().count() / 3;
    let mut best: Option<(usize, &str)> = None;
    let mut tied = false;
    for candidate in candidates {
        let distance = damerau_levenshtein(&lower, &candidate.to_lowercase());
        if distance > allowed {
            continue;
        }
        match best {
            Some((least, _)) if distance > least => {}
            Some((least, _)) if distance == least => tied = true,
            _ => {
                best = Some((distance, candidate));
                tied = false;
            }
        }
    }
    best.filter(|_| !tied).map(|(_, candidate)| candidate)
}

/// Returns "did you mean pad?" for the candidate that is [`nearest`] to a word.
pub fn did_you_mean<'a>(
    word: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<String> {
    nearest(word, candidates).map(|meant| format!("did you mean {meant}?"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_of_the_pen_are_seen_through_and_guesses_are_not_made() {
        let keys = ["modules", "m1", "m2", "k1", "k2", "preload"];
        for (word, expected) in [
            ("preloat", Some("preload")),
            ("Preload", Some("preload")),
            ("perload", Some("preload")),
            ("module", Some("modules")),
            ("M1", Some("m1")),
            ("k3", None),
            ("stiffness", None),
            ("", None),
        ] {
            assert_eq!(nearest(word, keys), expected, "{word}");
        }
    }
}
