//! The study of designs.

use amontons::Error;
use amontons_analysis::design::{DesignRequest, ReadyDesign, Vary, design};
use amontons_analysis::instant::signals_left_out;
use amontons_analysis::robustness::Distribution;
use amontons_analysis::study::{Journal, Prepare, Watch};
use serde::Deserialize;
use serde_json::{Map, Value, json};

/// All that a user asks of a design.
#[derive(Clone, Debug, Deserialize)]
pub struct Design {
    /// Names or patterns, each with its range.
    vary: Vec<(String, String)>,
    together: bool,
    costs: Vec<(String, f64)>,
    friction: [f64; 2],
    states: Vec<String>,
    margin: Option<f64>,
    starts: usize,
    points: usize,
    seed: u64,
    /// The distribution of the largest velocity of pushes, m/s.
    pushes: Option<String>,
    runs: u64,
}

impl Design {
    /// The request, whose texts are read.
    pub fn request(&self) -> Result<DesignRequest, Error> {
        let vary = |(name, range): &(String, String)| {
            Vary::parse(&format!("{name}={range}"))
                .map_err(|why| Error::argument(format!("{range} of {name}: {why}")))
        };
        let pushes = |text: &String| {
            Distribution::parse(text).map_err(|why| Error::argument(format!("pushes: {why}")))
        };
        Ok(DesignRequest {
            vary: self.vary.iter().map(vary).collect::<Result<_, Error>>()?,
            together: self.together,
            costs: self.costs.clone(),
            friction: self.friction,
            states: self.states.clone(),
            margin: self.margin,
            starts: self.starts,
            points: self.points,
            seed: self.seed,
            pushes: self.pushes.as_ref().map(pushes).transpose()?,
            runs: self.runs,
        })
    }
}

/// The result; `None` if the watch ended the study, or where pieces are missing. `prepare` makes the scene of a run ready.
pub fn found(
    ready: &ReadyDesign<'_>,
    given: &amontons::scene::Scene,
    prepare: Prepare<'_>,
    journal: &Journal,
    watch: Watch<'_>,
) -> Result<Option<Value>, Error> {
    let found = design(&ready.question(prepare), journal, watch)?;
    Ok(found.map(|found| {
        let values = ready.values(&found.design.changes).into_iter();
        let values: Map<String, Value> =
            values.map(|(name, value)| (name.to_owned(), json!(value))).collect();
        json!({
            "margin": ready.margin,
            "vary": ready.varied,
            "states": ready.states(),
            "values": values,
            "found": found,
            "note": signals_left_out(given, 0.0),
        })
    }))
}
