//! A design as people ask for it, and the question that follows for a scene.

use super::study::DesignQuestion;
use super::vary::{Varied, Vary, varied};
use crate::instant::require_undriven;
use crate::robustness::{
    Distribution, Draws, Parameter, Pushes, Uncertain, check_runs, parameters, push_velocity,
};
use crate::stability::{Linearised, StateClasses, named_states};
use crate::study::{Prepare, Push};
use crate::sweep::FRICTION;
use amontons::Error;
use amontons::contact::{ContactState, JoinedStates};
use amontons::decimal::to_significant;
use amontons::error::Short;
use amontons::scene::Scene;
use amontons::simulation::at_instant;
use amontons::stability::Spectrum;

/// The name that stands for all contact states.
const ALL: &str = "all";
/// The most contacts of which all states are among the conditions of a design: 256 states.
const MOST_CONTACTS: usize = 4;
/// The most starts, and the most points of the trade-off.
const MOST: usize = 1000;

/// A design as people ask for it.
#[derive(Clone, Debug, PartialEq)]
pub struct DesignRequest {
    /// The values that may change, each with its range.
    pub vary: Vec<Vary>,
    /// `true` if the values of a pattern change together by the same part.
    pub together: bool,
    /// The factors by which changes of names and patterns count, 1 for those that are not named.
    pub costs: Vec<(String, f64)>,
    /// The range of the common friction coefficient; both ends may be equal.
    pub friction: [f64; 2],
    /// The names of the contact states in which no mode may grow, or `all`; none stands for uniform sliding.
    pub states: Vec<String>,
    /// The growth rate by which all modes stay below zero, 1/s; `None` for a tenth of the slowest decay without friction.
    pub margin: Option<f64>,
    /// Number of starts of the search.
    pub starts: usize,
    /// Number of points of the trade-off.
    pub points: usize,
    /// The seed of starts and pushes.
    pub seed: u64,
    /// The largest velocity of pushes, m/s; `None` for one from 0 to the velocity of the fastest surface.
    pub pushes: Option<Distribution>,
    /// Number of runs after pushes; 0 leaves them out.
    pub runs: u64,
}

/// A design that is asked of a scene, with all that the scene says about it.
pub struct ReadyDesign<'a> {
    asked: &'a DesignRequest,
    /// The scene without signals, with the friction coefficient of the range that is nearest to its own.
    pub scene: Scene,
    /// The values that may change.
    pub varied: Vec<Varied>,
    /// The contact states in which no mode may grow, one entry for each contact.
    pub patterns: Vec<Vec<ContactState>>,
    /// The growth rate by which all modes stay below zero, 1/s.
    pub margin: f64,
    /// The largest velocity of pushes, m/s.
    pub pushes: Distribution,
    velocity: Draws,
    /// The friction coefficient of runs at random places of the range; empty for a range of one value.
    scattered: Vec<Parameter>,
}

impl DesignRequest {
    /// `true` if pushed runs verify the design.
    #[must_use]
    pub fn has_runs(&self) -> bool {
        self.runs > 0
    }

    /// The design that is asked of a scene.
    ///
    /// # Errors
    /// Returns an error that says what would be right: for numbers that make no sense, for names that the scene lacks, for a
    /// range that it cannot have, and for runs of a scene with signals.
    pub fn ready(&self, scene: &Scene) -> Result<ReadyDesign<'_>, Error> {
        require_undriven(scene, FRICTION)?;
        let varied = varied(scene, &self.vary, self.together, &self.costs)?;
        self.check(scene)?;
        let range = self.friction;
        let mut scene = at_instant(scene, 0.0)?;
        // The design belongs to the range, and the scene may be impossible at other values of µ.
        scene.friction_coefficient = scene.friction_coefficient.clamp(range[0], range[1]);
        scene.check()?;
        let patterns = patterns(&scene, &self.states)?;
        let margin = match self.margin {
            Some(margin) => margin,
            None => slowest_decay(&scene, &patterns)? / 10.0,
        };
        let pushes = match &self.pushes {
            Some(pushes) => pushes.clone(),
            None => default_pushes(&scene)?,
        };
        let velocity = push_velocity(&pushes)?;
        let scattered = if range[0] < range[1] {
            let text = format!("{FRICTION}=uniform({:?},{:?})", range[0], range[1]);
            let uncertain = Uncertain::parse(&text).map_err(Error::argument)?;
            parameters(&scene, &[uncertain])?
        } else {
            Vec::new()
        };
        Ok(ReadyDesign {
            asked: self,
            scene,
            varied,
            patterns,
            margin,
            pushes,
            velocity,
            scattered,
        })
    }

    /// Refuses numbers that make no sense, and a range that the scene cannot have.
    fn check(&self, scene: &Scene) -> Result<(), Error> {
        let refused = |text: String| Err(Error::argument(text));
        let Self { starts, points, friction: [from, to], .. } = self;
        if !(1..=MOST).contains(starts) {
            return refused(format!(
                "{starts} starts are not possible; give --starts from 1 to {MOST}"
            ));
        }
        if *points > MOST {
            return refused(format!(
                "{points} points of the trade-off are too many; give --points up to {MOST}"
            ));
        }
        if self.margin.is_some_and(|margin| !(margin >= 0.0 && margin.is_finite())) {
            return refused(
                "the margin is a growth rate by which all modes stay below zero; give --margin 0 or more, 1/s"
                    .to_owned(),
            );
        }
        if let Some(wrong) = [from, to].into_iter().find(|it| !(**it >= 0.0 && it.is_finite())) {
            return refused(format!("a friction coefficient of {} is not possible", Short(*wrong)));
        }
        if from > to {
            return refused(format!(
                "the range of --friction begins at {} and ends at {}; give the smaller one first",
                Short(*from),
                Short(*to)
            ));
        }
        if let Some(greatest) = scene.greatest_friction().filter(|greatest| to > greatest) {
            return refused(format!(
                "the range of --friction ends at {}, above the static friction {}: end it there",
                Short(*to),
                Short(greatest)
            ));
        }
        if self.has_runs() && !scene.signals.is_empty() {
            return refused(format!(
                "{} has signals, which keep it in motion whether it squeals or not: give --runs 0, or remove the signals \
                 from the scene",
                scene.name
            ));
        }
        if self.has_runs() {
            return check_runs(scene, self.runs);
        }
        if self.pushes.is_some() {
            return refused(
                "--pushes is for runs that verify the design, and there are none: leave it out, or give --runs 1 or more"
                    .to_owned(),
            );
        }
        Ok(())
    }
}

impl ReadyDesign<'_> {
    /// The question of the design. `prepare` makes the scene of a run ready.
    #[must_use]
    pub fn question<'a>(&'a self, prepare: Prepare<'a>) -> DesignQuestion<'a> {
        let Self { asked, scene, varied, patterns, margin, .. } = self;
        let pushes = asked.has_runs().then_some(Pushes {
            scene,
            parameters: &self.scattered,
            velocity: &self.velocity,
            prepare,
            runs: asked.runs,
            seed: asked.seed,
            name: "run",
        });
        DesignQuestion {
            scene,
            varied,
            patterns,
            is_uniform: asked.states.is_empty(),
            range: asked.friction,
            margin: *margin,
            starts: asked.starts,
            seed: asked.seed,
            points: asked.points,
            pushes,
        }
    }

    /// The names of the contact states in which no mode may grow.
    #[must_use]
    pub fn states(&self) -> Vec<String> {
        self.patterns.iter().map(|it| JoinedStates(it).to_string()).collect()
    }

    /// Each value that changes, by its name, after these changes.
    #[must_use]
    pub fn values(&self, changes: &[f64]) -> Vec<(&str, f64)> {
        let changed = self.varied.iter().zip(changes).filter(|(_, change)| **change != 0.0);
        let parts = changed.flat_map(|(one, change)| one.parts.iter().map(move |it| (it, *change)));
        parts.map(|(part, change)| (&*part.name, part.at(change))).collect()
    }
}

/// The contact states in which no mode may grow.
fn patterns(scene: &Scene, names: &[String]) -> Result<Vec<Vec<ContactState>>, Error> {
    let here = Linearised::of(scene);
    if names.is_empty() {
        return Ok(vec![here.uniform_sliding()?]);
    }
    let mut found: Vec<Vec<ContactState>> = Vec::new();
    for name in names {
        let states = if name == ALL {
            if scene.contact_count() > MOST_CONTACTS {
                return Err(Error::argument(format!(
                    "{} contacts have 4^{} states; `--state all` is for up to {MOST_CONTACTS} contacts: name the states that \
                     matter, such as those of the candidates of `amontons-stability bistable`",
                    scene.contact_count(),
                    scene.contact_count()
                )));
            }
            StateClasses::of(here.model())?.states.into_iter().map(|(states, _)| states).collect()
        } else {
            vec![named_states(name, scene, &here)?]
        };
        for states in states {
            if !found.contains(&states) {
                found.push(states);
            }
        }
    }
    Ok(found)
}

/// The decay rate of the slowest mode of some contact states without friction, 1/s.
fn slowest_decay(scene: &Scene, patterns: &[Vec<ContactState>]) -> Result<f64, Error> {
    let mut slowest = f64::INFINITY;
    let static_friction = scene.static_friction.map(|_| 0.0);
    let here =
        Linearised::of(&Scene { friction_coefficient: 0.0, static_friction, ..scene.clone() });
    for states in patterns {
        let found = Spectrum::of(here.linear()?, states)?;
        slowest = slowest.min(-found.growth_rate());
    }
    Ok(if slowest.is_finite() { to_significant(slowest.max(0.0), 3) } else { 0.0 })
}

/// Pushes from nothing up to the velocity of the fastest surface.
fn default_pushes(scene: &Scene) -> Result<Distribution, Error> {
    let fastest = 1000.0 * Push::of(scene).velocity;
    Distribution::parse(&format!("uniform(0,{:?})", to_significant(fastest, 6)))
        .map_err(Error::argument)
}
