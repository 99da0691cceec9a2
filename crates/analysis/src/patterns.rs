//! Patterns of contact states: those that a run went through, in a file and back, and their names for people.

use crate::output;
use amontons::Error;
use amontons::contact::{ContactState, JoinedStates};
use amontons::integrator::{MOST_VISITED, Visit, VisitLog};
use amontons::scene::{Scene, did_you_mean};
use std::collections::{HashMap, HashSet};
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// The states of more contacts than this are counted, not listed, where people read them.
const LISTED: usize = 8;
/// The most contacts that are named as exceptions.
const MOST_NAMED: usize = 6;
/// The first columns of a file; one column for each contact follows.
const COLUMNS: [&str; 4] = ["share", "time", "entered", "first"];

/// A pattern of contact states with the part of a run's time that it took.
#[derive(Clone, Debug, PartialEq)]
pub struct Pattern {
    /// The states and stays; times in s.
    pub visit: Visit,
    /// Part of the run's time, 0 to 1.
    pub share: f64,
}

/// The patterns of a run, the longest first; of equally long ones the earlier first.
#[must_use]
pub fn patterns(log: &VisitLog) -> Vec<Pattern> {
    let share = |visit: &Visit| Pattern { share: visit.time / log.time(), visit: visit.clone() };
    let mut patterns: Vec<Pattern> = log.visits().iter().map(share).collect();
    patterns.sort_by(|a, b| b.visit.time.total_cmp(&a.visit.time));
    patterns
}

/// Writes the patterns of a run as CSV, the longest first: share of the time, time (s), number of stays, time of the first
/// (s), and the state of each contact. Time in patterns that the log does not hold is a last row without states.
///
/// # Errors
/// Returns an error if the file cannot be written.
pub fn write(path: &Path, scene: &Scene, log: &VisitLog) -> Result<(), Error> {
    let mut text = COLUMNS.join(",");
    for contact in 0..scene.contact_count() {
        text.push(',');
        text.push_str(&scene.contact_name(contact));
    }
    text.push('\n');
    for Pattern { visit: Visit { states, time, entered, first }, share } in patterns(log) {
        let _ = write!(text, "{share:?},{time:?},{entered},{first:?}");
        for state in states {
            let _ = write!(text, ",{state}");
        }
        text.push('\n');
    }
    if log.left_out() > 0.0 {
        let _ = write!(text, "{:?},{:?},,", log.left_out() / log.time(), log.left_out());
        text.extend(std::iter::repeat_n(',', scene.contact_count()));
        text.push('\n');
    }
    output::write(path, text.as_bytes())
}

/// A sentence on the time in patterns that a log does not hold; `None` if it holds all.
#[must_use]
pub fn left_out(log: &VisitLog) -> Option<String> {
    (log.left_out() > 0.0).then(|| {
        let percent = 100.0 * log.left_out() / log.time();
        format!(
            "the run went through more than {MOST_VISITED} patterns of contact states; those that came later took {percent:.3} % \
             of the time and are not listed"
        )
    })
}

/// Reads the patterns that [`write()`] has written for a scene with these contacts, and returns the longest first. Columns may be in any order, and only those of
/// the contacts and `share` are needed.
///
/// # Errors
/// Returns an error with the line if the file cannot be read, or names other contacts or unknown states.
pub fn read(path: &Path, scene: &Scene) -> Result<Vec<Pattern>, Error> {
    let text = fs::read_to_string(path).map_err(|error| Error::file(path, &error))?;
    parse(&text, scene).map_err(|fault| Error::argument(format!("{}, {fault}", path.display())))
}

fn parse(text: &str, scene: &Scene) -> Result<Vec<Pattern>, String> {
    let mut lines = (1..).zip(text.lines());
    let (_, head) = lines.next().unwrap_or((1, ""));
    let head: Vec<&str> = head.split(',').map(str::trim).collect();
    let contacts: Vec<String> =
        (0..scene.contact_count()).map(|contact| scene.contact_name(contact)).collect();
    let is_known = |name: &str| COLUMNS.contains(&name) || contacts.iter().any(|it| it == name);
    if let Some(other) = head.iter().find(|name| !is_known(name)) {
        let help = did_you_mean(other, contacts.iter().map(|name| &**name));
        let help = help.map_or_else(String::new, |help| format!("{help} Or "));
        return Err(format!(
            "line 1: {} has no contact `{other}`; {help}{}",
            scene.name,
            again(scene)
        ));
    }
    let column = |wanted: &str| {
        head.iter()
            .position(|name| *name == wanted)
            .ok_or_else(|| format!("line 1: the column {wanted} is missing; {}", again(scene)))
    };
    let share = column(COLUMNS[0])?;
    let places: Vec<usize> =
        contacts.iter().map(|name| column(name)).collect::<Result<_, String>>()?;
    let mut patterns = Vec::new();
    for (line, row) in lines.filter(|(_, row)| !row.trim().is_empty()) {
        let cells: Vec<&str> = row.split(',').map(str::trim).collect();
        if cells.len() != head.len() {
            return Err(format!(
                "line {line}: there are {} values for {} columns; give one for each",
                cells.len(),
                head.len()
            ));
        }
        if places.iter().all(|place| cells[*place].is_empty()) {
            continue;
        }
        let number = |column: Option<usize>| match column.map(|column| cells[column]) {
            None | Some("") => Ok(0.0),
            Some(text) => match text.parse::<f64>() {
                Ok(number) if number.is_finite() => Ok(number),
                _ => Err(format!("line {line}: {text} is no number")),
            },
        };
        let state = |place: &usize| {
            let known = ContactState::ALL.into_iter();
            known.into_iter().find(|state| state.to_string() == cells[*place]).ok_or_else(|| {
                let cell = cells[*place];
                format!("line {line}: {cell} is not a contact state: give Sl, R-Sl, St or Dt")
            })
        };
        let states = places.iter().map(state).collect::<Result<_, String>>()?;
        let [time, entered, first] = [1, 2, 3].map(|other| number(column(COLUMNS[other]).ok()));
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let entered = entered? as u64;
        let visit = Visit { states, time: time?, entered, first: first? };
        let share = number(Some(share))?;
        if !(0.0..=1.0).contains(&share) {
            return Err(format!("line {line}: the share {share:?} is not from 0 to 1"));
        }
        patterns.push(Pattern { visit, share });
    }
    patterns.sort_by(|a, b| b.share.total_cmp(&a.share));
    Ok(patterns)
}

/// The remedy for a file of other contacts.
fn again(scene: &Scene) -> String {
    format!(
        "run `amontons simulate {} --patterns` for this scene if the file is of another one",
        scene.name
    )
}

/// The states of contacts for people: joined as in the paper for a few contacts, else counted, with the names of the
/// contacts that differ from most if these are few.
///
/// ```
/// use amontons_analysis::patterns::in_words;
///
/// let scene = amontons::scene::builtin("set2").expect("a built-in scene").scene();
/// let states = amontons::contact::parse_states("Sl-St", 2)?;
/// assert_eq!(in_words(&states, &scene), "Sl-St");
/// # Ok::<(), amontons::Error>(())
/// ```
#[must_use]
pub fn in_words(states: &[ContactState], scene: &Scene) -> String {
    words(states, scene, MOST_NAMED)
}

/// Patterns [in words](in_words) that differ as the patterns do: in those that would read alike, all contacts that differ from most are
/// named.
#[must_use]
pub fn told_apart(patterns: &[&[ContactState]], scene: &Scene) -> Vec<String> {
    let short: Vec<String> = patterns.iter().map(|states| in_words(states, scene)).collect();
    let mut first = HashMap::new();
    let mut alike = HashSet::new();
    for (states, text) in patterns.iter().zip(&short) {
        if first.entry(text).or_insert(states) != &states {
            alike.insert(text);
        }
    }
    let named = |(states, text): (&&[ContactState], &String)| match alike.contains(text) {
        true => words(states, scene, states.len()),
        false => text.clone(),
    };
    patterns.iter().zip(&short).map(named).collect()
}

/// States in words, in which up to `most_named` contacts of a state that differs from most are named.
fn words(states: &[ContactState], scene: &Scene, most_named: usize) -> String {
    if states.len() <= LISTED {
        return JoinedStates(states).to_string();
    }
    let count = |wanted: ContactState| states.iter().filter(|state| **state == wanted).count();
    let mut counts = ContactState::ALL.map(|state| (state, count(state)));
    counts.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    let most = counts[0].0;
    let parts = counts.iter().filter(|(_, count)| *count > 0).map(|(state, count)| {
        let named = *state != most && *count <= most_named;
        let names = (0..states.len()).filter(|contact| named && states[*contact] == *state);
        let names: Vec<String> = names.map(|contact| scene.contact_name(contact)).collect();
        let names = if named { format!(" ({})", names.join(", ")) } else { String::new() };
        format!("{count} {state}{names}")
    });
    parts.collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use amontons::contact::ContactState::{Detached, Slide, Stick};
    use amontons::scene::builtin;

    #[test]
    fn a_file_with_other_contacts_or_states_is_refused_with_its_line() {
        let scene = builtin("set2").unwrap().scene();
        let faults = [
            (
                "share,contact[1],contact[3]\n",
                "line 1: set2 has no contact `contact[3]`; run `amontons simulate set2 --patterns` for this scene",
            ),
            (
                "share,contact[1]\n",
                "line 1: the column contact[2] is missing; run `amontons simulate set2 --patterns` for this scene",
            ),
            ("contact[1],contact[2]\n", "line 1: the column share is missing"),
            ("share,contact[1],contact[2]\n1,Sl\n", "line 2: there are 2 values for 3 columns"),
            ("share,contact[1],contact[2]\n1,Sl,sl\n", "line 2: sl is not a contact state"),
            ("share,contact[1],contact[2]\nx,Sl,Sl\n", "line 2: x is no number"),
            ("share,contact[1],contact[2]\n2,Sl,Sl\n", "line 2: the share 2.0 is not from 0 to 1"),
        ];
        for (text, fault) in faults {
            let found = parse(text, &scene).unwrap_err();
            assert!(found.starts_with(fault), "{found}");
        }
        let read = parse("contact[2],share,contact[1]\nSt,0.25,Dt\n,0.75,\n", &scene).unwrap();
        let states = vec![Detached, Stick];
        let visit = Visit { states, time: 0.0, entered: 0, first: 0.0 };
        assert_eq!(read, [Pattern { visit, share: 0.25 }]);
    }

    #[test]
    fn many_states_are_counted_and_the_few_that_differ_are_named() {
        let mut scene = builtin("set2").unwrap().scene();
        let module = scene.modules()[0];
        scene.modules_mut().resize(12, module);
        let mut states = vec![Slide; 12];
        assert_eq!(in_words(&states, &scene), "12 Sl");
        states[3] = Stick;
        states[7] = Stick;
        assert_eq!(in_words(&states, &scene), "10 Sl, 2 St (contact[4], contact[8])");
    }

    #[test]
    fn patterns_that_would_read_alike_name_the_contacts_that_differ_from_most() {
        let mut scene = builtin("set2").unwrap().scene();
        let module = scene.modules()[0];
        scene.modules_mut().resize(16, module);
        let with = |stuck: std::ops::Range<usize>| {
            let mut states = vec![Slide; 16];
            states[stuck].fill(Stick);
            states
        };
        let (first, second, third) = (with(0..7), with(1..8), with(0..8));
        let found = told_apart(&[&first, &third, &second, &first], &scene);
        let names = |range: std::ops::RangeInclusive<usize>| {
            range.map(|i| format!("contact[{i}]")).collect::<Vec<_>>().join(", ")
        };
        let expected = [
            format!("9 Sl, 7 St ({})", names(1..=7)),
            "8 Sl, 8 St".to_owned(),
            format!("9 Sl, 7 St ({})", names(2..=8)),
            format!("9 Sl, 7 St ({})", names(1..=7)),
        ];
        assert_eq!(found, expected);
    }
}
