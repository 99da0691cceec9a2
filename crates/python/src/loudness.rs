//! The study of loudness.

use amontons::Error;
use amontons_analysis::study::loudness::{
    LoudnessQuestion, check_undriven, loudness, measured_points, ways,
};
use amontons_analysis::study::{Journal, ObservationSettings, Push, Watch};
use serde::Deserialize;
use serde_json::{Value, json};

/// All that a user asks of a study of loudness.
#[derive(Clone, Debug, Deserialize)]
pub struct Loudness {
    /// The largest velocity of a start along a growing mode, m/s.
    push: Option<f64>,
    /// Names of the points that are measured.
    points: Vec<String>,
    /// The largest number of candidates that are pushed.
    candidates: usize,
}

impl Loudness {
    /// The result; `None` if the watch ended the study, or where pieces are missing. The scene is ready to run.
    pub fn found(
        &self,
        given: &amontons::scene::Scene,
        observation: &ObservationSettings,
        journal: &Journal,
        watch: Watch<'_>,
    ) -> Result<Option<Value>, Error> {
        check_undriven(given)?;
        let mut scene = given.clone();
        scene.rest();
        let points = measured_points(&scene, &self.points)?;
        // Candidates are found in much less time than motions settle.
        let found = ways(&scene, self.candidates, Watch { progress: &|_| {}, ..watch })?;
        let push = self.push.unwrap_or_else(|| Push::of(&scene).velocity);
        let question = LoudnessQuestion { push, points };
        let results = loudness(&scene, &found, &question, observation, journal, watch)?;
        Ok(results.map(|results| json!({ "push": push, "found": results })))
    }
}
