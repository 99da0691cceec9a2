//! Reading a file with everything that is wrong with it at once, each problem at its place.
//!
//! Nothing here knows what a scene is: the keys, what they may hold and what they mean come from the
//! JSON Schema that the types of the file derive. In order:
//!
//! 1. the text is parsed, going on after errors ([`syntax`]);
//! 2. the document is walked against the schema ([`walk`]); misspelt keys are read as what they
//!    are likely to mean, others dropped, so that the rest can be looked at;
//! 3. what is left becomes the type, if it can, and the type says what else is wrong; the paths of
//!    those problems are looked up in the document ([`place`]);
//! 4. all of it is printed with its lines ([`render`]).

mod kind;
mod number;
mod object;
mod place;
mod render;
mod syntax;
mod walk;
mod wording;

use amontons::Error;
use amontons::scene::Problem;
use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::collections::HashSet;
use std::ops::Range;
use toml::de::DeTable;

/// Length of a text (bytes) beyond which only the first error is reported: each of its lines may be one.
const MOST_RECOVERED: usize = 1_000_000;
/// The most problems that are looked for; a message lists far fewer.
const MOST_PROBLEMS: usize = 1000;

/// A problem with its place in the text, in bytes.
#[derive(Clone, Debug, PartialEq)]
struct Located {
    span: Range<usize>,
    title: String,
    help: String,
}

/// The schema of a type as a file holds it: JSON Schema draft 7, which editors understand best,
/// without references.
pub(super) fn schema<T: JsonSchema>() -> Value {
    let settings = SchemaSettings::draft07().with(|settings| settings.inline_subschemas = true);
    settings.into_generator().into_root_schema_for::<T>().to_value()
}

/// Reads a text as a `T` and makes it into what is wanted; `place` names the file in messages.
/// Whatever `finish` finds wrong has paths through the file.
///
/// # Errors
/// Returns all errors of the text.
pub(super) fn read<T: JsonSchema + DeserializeOwned, S>(
    place: &str,
    text: &str,
    finish: impl FnOnce(T) -> Result<S, Vec<Problem>>,
) -> Result<S, Error> {
    let (mut document, errors) = if text.len() <= MOST_RECOVERED {
        DeTable::parse_recoverable(text)
    } else {
        match DeTable::parse(text) {
            Ok(document) => (document, Vec::new()),
            Err(error) => {
                let problem = syntax::problem(text, &error);
                return Err(Error::scene(render::report(place, text, &[problem], true)));
            }
        }
    };
    let lines = syntax::Lines::of(text);
    let unread = lines.with(&errors);
    let mut problems = syntax::problems(text, &lines, &errors);
    let is_whole = problems.is_empty();
    let end = text.trim_end().len();
    let walked = walk::problems(&mut document, &schema::<T>(), end);
    let mut are_all = walked.len() < MOST_PROBLEMS;
    problems.extend(
        walked
            .into_iter()
            .filter(|walked| is_whole || !walked.may_follow(&lines, &unread))
            .map(|walked| walked.problem),
    );
    // If a file is full of problems, the meaning of its values is of no interest.
    if is_whole && are_all {
        // A document without problems is unchanged and can be parsed anew: a copy would take as much memory.
        let is_touched = !problems.is_empty();
        let copy = is_touched.then(|| document.clone());
        match T::deserialize(toml::Deserializer::from(document)) {
            Ok(file) => match finish(file) {
                Ok(made) if problems.is_empty() => return Ok(made),
                Ok(_) => {}
                Err(mut found) => {
                    are_all = found.len() <= MOST_PROBLEMS;
                    found.truncate(MOST_PROBLEMS);
                    let document = copy.unwrap_or_else(|| DeTable::parse_recoverable(text).0);
                    let mut known: HashSet<Range<usize>> =
                        problems.iter().map(|problem| problem.span.clone()).collect();
                    for problem in found {
                        let problem = place::locate(document.get_ref(), problem, end);
                        // A place that the walk has reported is not reported again.
                        if known.insert(problem.span.clone()) {
                            problems.push(problem);
                        }
                    }
                }
            },
            Err(error) if problems.is_empty() => problems.push(syntax::problem(text, &error)),
            Err(_) => {}
        }
    }
    problems.sort_by_key(|problem| problem.span.start);
    Err(Error::scene(render::report(place, text, &problems, are_all)))
}

#[cfg(test)]
mod tests;
