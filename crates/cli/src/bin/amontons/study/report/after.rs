//! The scene after the changes that the answers name: the probability that it is unstable, and the motion from the same start.

use super::answers::loudest;
use super::assumptions::{Assumptions, Plan};
use super::changes::{Change, MOST_NAMED, best, together};
use super::{Motions, known};
use amontons::Error;
use amontons::scene::Scene;
use amontons_analysis::robustness::{
    Design, Estimate, FEWEST_SCRAMBLINGS, Parameter, Uncertain, parameters, robustness,
};
use amontons_analysis::study::loudness::{Loudness, Row, Ways, loudness};
use amontons_analysis::study::{Journal, Kind, LongTermMotion, ObservationSettings, Watch};
use serde::Serialize;
use serde_json::{Value, json};

/// Part of the work of draws, beside which one motion is followed.
const DRAWS: f64 = 0.5;

/// The scene after changes.
#[derive(Default)]
pub struct After {
    /// Places of changes with the probability that the changed scene is unstable under the same scatter, or the reason why it is
    /// unknown.
    pub unstable: Vec<(usize, Result<Estimate, String>)>,
    /// The motion after the change that helps most; `None` if none helps, or no motion was measured before.
    pub motion: Option<ChangedMotion>,
}

/// The motion from the start that led to the loudest one.
pub struct ChangedMotion {
    /// Name of the start.
    pub start: String,
    /// Place of the change.
    pub change: usize,
    /// The largest speed before, m/s rms.
    pub before: f64,
    /// The motion after the change, or the reason why it is unknown.
    pub after: Result<Outcome, String>,
}

/// The motion from a start.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// It comes to rest.
    Rests,
    /// It lasts, with this speed of its fastest point, m/s rms.
    Lasts(f64),
}

impl After {
    /// An unknown value is null, with the reason beside it.
    pub fn as_json(&self) -> Value {
        let unstable = self.unstable.iter().map(|(change, found)| {
            json!({
                "change": change,
                "probability": found.as_ref().ok(),
                "unknown": found.as_ref().err(),
            })
        });
        let motion = self.motion.as_ref().map(|motion| {
            json!({
                "start": motion.start,
                "change": motion.change,
                "before": motion.before,
                "after": motion.after.as_ref().ok(),
                "unknown": motion.after.as_ref().err(),
            })
        });
        json!({ "unstable": unstable.collect::<Vec<Value>>(), "motion": motion })
    }
}

/// All that changed scenes are analysed with.
pub struct Changed<'a> {
    pub scene: &'a Scene,
    /// The scene at t = 0, without signals.
    pub still: &'a Scene,
    pub changes: &'a [Change],
    /// The scatter that the user gives.
    pub given: &'a [Uncertain],
    pub plan: Plan,
    pub seed: u64,
    pub motions: Option<&'a Motions>,
    pub observation: &'a ObservationSettings,
}

impl Changed<'_> {
    /// `None` if the watch ended the work, or if pieces of other workers are missing.
    ///
    /// # Errors
    /// Returns an error if the journal cannot be written.
    #[allow(clippy::cast_precision_loss)]
    pub fn found(
        &self,
        loud: Option<&Loudness>,
        journal: &Journal,
        watch: Watch<'_>,
    ) -> Result<Option<After>, Error> {
        let mut named = best(self.changes);
        named.truncate(MOST_NAMED - 1);
        named.extend(together(self.changes));
        let named: Vec<usize> = if self.plan.has_changes { named } else { Vec::new() };
        let mut unstable = Some(Vec::new());
        for (number, place) in (0_u32..).zip(&named) {
            let progress = |part: f64| {
                (watch.progress)(DRAWS * (f64::from(number) + part) / named.len() as f64);
            };
            let watch = Watch { progress: &progress, ..watch };
            // Workers share the pieces of all changes in one round.
            match known(self.unstable(&self.changes[*place], journal, watch), watch)? {
                Some(found) => unstable = unstable.map(|all| [all, vec![(*place, found)]].concat()),
                None => unstable = None,
            }
        }
        let progress = |part: f64| (watch.progress)(DRAWS + (1.0 - DRAWS) * part);
        let motion = self.motion(loud, journal, Watch { progress: &progress, ..watch })?;
        Ok(unstable.zip(motion).map(|(unstable, motion)| After { unstable, motion }))
    }

    /// The probability that the changed scene is unstable.
    fn unstable(
        &self,
        change: &Change,
        journal: &Journal,
        watch: Watch<'_>,
    ) -> Result<Option<Estimate>, Error> {
        let uncertain = Assumptions::of(&change.scene(self.scene)?, self.given)?.uncertain;
        let still = change.scene(self.still)?;
        let parameters: Vec<Parameter> = parameters(&still, &uncertain)?;
        if parameters.is_empty() {
            return Err(Error::analysis("no parameter scatters"));
        }
        let is_moved = |name: &str| {
            let own = |one: &&Uncertain| one.is_of(name);
            self.given.iter().find(own).is_none_or(|one| one.distribution.is_relative())
        };
        if let Some((name, _)) = change.parameters.iter().find(|one| !is_moved(&one.0)) {
            return Err(Error::analysis(format!(
                "{name} scatters about a value that is given for it, which the change does not move"
            )));
        }
        let design = Design {
            scene: &still,
            parameters: &parameters,
            state: None,
            scramblings: FEWEST_SCRAMBLINGS,
            points: self.plan.points,
            seed: self.seed,
            has_indices: false,
        };
        let found = robustness(&design, None, &journal.named(&change.name()), watch)?;
        Ok(found.map(|found| found.unstable))
    }

    /// The motion after the change that helps most, from the start that led to the loudest motion.
    fn motion(
        &self,
        loud: Option<&Loudness>,
        journal: &Journal,
        watch: Watch<'_>,
    ) -> Result<Option<Option<ChangedMotion>>, Error> {
        let Some(motions) = self.motions else { return Ok(Some(None)) };
        // Pieces of other workers tell which motion is the loudest.
        let Some(loud) = loud else { return Ok(None) };
        let Some(&place) = best(self.changes).first() else { return Ok(Some(None)) };
        let Some((row, before)) = loudest_row(loud) else { return Ok(Some(None)) };
        let change = &self.changes[place];
        let way = Ways { grows: loud.grows, ways: vec![row.way.clone()], unexamined: None };
        let run = || {
            let scene = change.scene(&motions.scene)?;
            let journal = journal.named(&change.name());
            loudness(&scene, &way, &motions.question, self.observation, &journal, watch)
        };
        let Some(found) = known(run(), watch)? else { return Ok(None) };
        let after = found.and_then(|found| outcome(&found));
        Ok(Some(Some(ChangedMotion { start: row.way.name(), change: place, before, after })))
    }
}

/// The row that leads to the loudest motion, and the speed of its fastest point, m/s rms.
fn loudest_row(loud: &Loudness) -> Option<(&Row, f64)> {
    let (motion, measured) = loudest(loud)?;
    let is_it = |row: &&Row| row.attempt().motion.is_some_and(|it| loud.motions[it] == *motion);
    Some((loud.rows.iter().find(is_it)?, measured.loudest().rms))
}

/// The motion that a start leads to, or the reason why it is unknown.
fn outcome(found: &Loudness) -> Result<Outcome, String> {
    if let Some((_, measured)) = loudest(found) {
        return Ok(Outcome::Lasts(measured.loudest().rms));
    }
    let Some(row) = found.rows.first() else {
        return Err(
            "the contact states of the candidate have no growing mode after the change".into()
        );
    };
    let rests = |ending: Option<&LongTermMotion>| ending.is_some_and(LongTermMotion::rests);
    if row.attempts.iter().all(|attempt| rests(attempt.ending.as_ref())) {
        return Ok(Outcome::Rests);
    }
    let unbounded = |ending: &LongTermMotion| ending.kind == Kind::Unbounded;
    let attempts = || row.attempts.iter();
    Err(match attempts().find_map(|attempt| attempt.failure.clone()) {
        Some(failure) => format!("the run failed: {failure}"),
        None if attempts().any(|it| it.ending.as_ref().is_some_and(unbounded)) => {
            "the motion grows without bound".to_owned()
        }
        None => "the motion had not settled".to_owned(),
    })
}
