//! The modes of uniform sliding over friction: where they begin to grow, and their picture.

use super::{NAMED, can_squeal};
use amontons::contact::{ContactState, JoinedStates};
use amontons::decimal::to_significant;
use amontons::model::LumpedModel;
use amontons::numerics::range;
use amontons::scene::{Scene, Structure};
use amontons_analysis::stability::Linearised;
use amontons_analysis::stability::candidates::equilibrium_ranges;
use amontons_analysis::stability::locus::{ALL_FREQUENCIES, Crossing, Locus, locus};
use amontons_pictures::picture::{Chart, Mark, PALETTE, locus_chart, significant};

/// The most degrees of freedom of which modes are followed in an export: a second of work.
const MOST_FOLLOWED: usize = 64;
/// Number of steps of a curve of a mode.
const STEPS: u32 = 200;
/// End of the curve in parts of the scene's own friction.
const BEYOND: f64 = 1.5;

/// The quantity along the chart's axis.
#[derive(Clone, Copy, PartialEq)]
enum LocusAxis {
    /// The common µ.
    Friction,
    /// All friction coefficients, as multiples of themselves.
    Factor,
}

impl LocusAxis {
    fn label(self) -> &'static str {
        match self {
            Self::Friction => "friction coefficient µ",
            Self::Factor => "all friction coefficients, as multiples of their start values",
        }
    }

    fn caption(self) -> &'static str {
        match self {
            Self::Friction => {
                "Root locus of uniform sliding: growth (above) and frequency (below) of all modes over the friction \
                 coefficient. A mode above the zero line grows."
            }
            Self::Factor => {
                "Root locus of uniform sliding: growth (above) and frequency (below) of all modes over a factor that \
                 multiplies all friction coefficients (1 in this scene). A mode above the zero line grows."
            }
        }
    }
}

/// The modes of uniform sliding over friction.
pub(super) struct Followed {
    axis: LocusAxis,
    locus: Locus,
    /// The scene's own place.
    here: f64,
    equilibrium: Vec<[f64; 2]>,
}

/// Follows the modes of uniform sliding, or says why that makes no sense.
pub(super) fn followed(
    scene: &Scene,
    model: &LumpedModel,
    states: &[ContactState],
) -> Result<Followed, String> {
    if !can_squeal(scene) {
        return Err("The scene has no friction, so there is no root locus over friction.".into());
    }
    let about = scene.friction_law.info();
    if !about.is_constant() {
        return Err(format!(
            "With the friction law {} µ depends on the slip velocity, so there is no root locus over a single µ.",
            about.name
        ));
    }
    if states.contains(&ContactState::Stick) {
        return Err(
            "A root locus over friction needs uniform sliding, but not all contacts slide in this state.".into()
        );
    }
    if model.dofs() > MOST_FOLLOWED {
        return Err(format!(
            "With {} degrees of freedom the modes are not followed during an export; `amontons-stability locus` \
             follows them.",
            model.dofs()
        ));
    }
    let common = scene.has_common_friction() && !has_own_friction(scene);
    let axis = if common { LocusAxis::Friction } else { LocusAxis::Factor };
    let here = if common { scene.friction_coefficient } else { 1.0 };
    let last = if here == 0.0 { 1.0 } else { BEYOND * here };
    let values: Vec<f64> =
        (0..=STEPS).map(|step| last * (f64::from(step) / f64::from(STEPS))).collect();
    let at = |value: f64| with_friction(scene, axis, value);
    let locus = locus(
        &|value| Ok(Linearised::of(&at(value))),
        states,
        &values,
        ALL_FREQUENCIES,
        &|_, _| {},
    )
    .map_err(|error| format!("The modes cannot be followed over friction: {error}."))?;
    let has_equilibrium =
        |value: f64| Linearised::of(&at(value)).equilibrium_in(states).map(|_| ());
    if locus.branches.is_empty() {
        return Err(
            "In uniform sliding no degree of freedom can move, whatever the friction.".into()
        );
    }
    let equilibrium = equilibrium_ranges(&has_equilibrium, &values);
    Ok(Followed { axis, locus, here, equilibrium })
}

fn has_own_friction(scene: &Scene) -> bool {
    let contacts = scene.network().map_or(&[][..], |network| &network.contacts);
    contacts.iter().any(|place| place.friction.is_some())
}

/// The scene with another friction, of which static friction knows nothing: nothing sticks here.
fn with_friction(scene: &Scene, axis: LocusAxis, value: f64) -> Scene {
    let mut scene = scene.clone();
    match axis {
        LocusAxis::Friction => scene.friction_coefficient = value,
        LocusAxis::Factor => {
            scene.friction_coefficient *= value;
            if let Structure::Network(network) = &mut scene.structure {
                for place in &mut network.contacts {
                    place.friction = place.friction.map(|own| own * value);
                }
            }
        }
    }
    scene
}

impl Followed {
    pub(super) fn caption(&self) -> &'static str {
        self.axis.caption()
    }

    fn name(&self) -> &'static str {
        match self.axis {
            LocusAxis::Friction => "µ =",
            LocusAxis::Factor => "a factor of",
        }
    }

    /// Values at which modes begin to grow, and values without an equilibrium, in words.
    pub(super) fn words(&self) -> Vec<String> {
        let number = |value: f64| significant(value, 6);
        let (first, last) = (self.locus.values[0], self.locus.values[self.locus.values.len() - 1]);
        let name = self.name();
        let turn = |crossing: &Crossing| {
            let how = match crossing.frequency_hz {
                0.0 => "without oscillating".to_owned(),
                frequency => format!("at {} Hz", significant(frequency, 5)),
            };
            let turns = if crossing.becomes_unstable { "begins" } else { "ceases" };
            format!("{name} {} ({turns} {how})", number(crossing.value))
        };
        let mut turns: Vec<String> = self.locus.crossings.iter().map(turn).collect();
        // One of two double modes is enough.
        turns.dedup();
        let mut words = vec![match turns.is_empty() {
            true => {
                let grows =
                    (0..self.locus.branches.len()).any(|mode| self.locus.grows_at_first(mode));
                let verdict = if grows { "some mode grows" } else { "no mode grows" };
                format!("Over the whole range from {name} {first} to {} {verdict}.", number(last))
            }
            false => format!("A mode begins or ceases to grow at {}.", turns.join(", ")),
        }];
        let whole =
            self.equilibrium.first().is_some_and(|[from, to]| *from <= first && *to >= last);
        if !whole {
            let ranges = self
                .equilibrium
                .iter()
                .map(|[from, to]| format!("from {} to {}", number(*from), number(*to)));
            let ranges: Vec<String> = ranges.collect();
            words.push(match ranges.is_empty() {
                true => "Uniform sliding has no equilibrium anywhere in this range.".to_owned(),
                false => {
                    format!("Uniform sliding has an equilibrium {} only.", ranges.join(" and "))
                }
            });
        }
        words
    }

    pub(super) fn chart(&self, scene: &Scene, states: &[ContactState]) -> Chart {
        let state = match states.len() {
            0..=NAMED => format!("state {}", JoinedStates(states)),
            _ => "uniform sliding".to_owned(),
        };
        let title = format!("{}: eigenvalues in {state}", scene.name);
        let mut chart = locus_chart(title, self.axis.label().to_owned(), &[(None, &self.locus)]);
        for panel in &mut chart.panels {
            // Modes of equal modules come twice, and of many no legend tells which is which.
            let mut distinct: Vec<Vec<[f64; 2]>> = Vec::new();
            let many = panel.series.len() > NAMED;
            panel.series.retain_mut(|series| {
                if many {
                    series.label = None;
                    // Colours that come again would be dashed: thousands of strokes.
                    series.colour %= PALETTE.len();
                }
                series.points = straightened(&series.points);
                let new = !distinct.contains(&series.points);
                distinct.push(series.points.clone());
                new
            });
        }
        if let Some(panel) = chart.panels.first_mut() {
            let label = match self.axis {
                LocusAxis::Friction => "this scene",
                LocusAxis::Factor => "this scene: 1",
            };
            let mark = Mark { x: self.here, label: Some(label.to_owned()) };
            panel.marks.push(mark);
        }
        chart
    }
}

/// A curve without the points that lie on the line between their neighbours, as far as a picture shows: it keeps
/// the ends, and between two points that stay what is farther than a part of the curve's height from their line
/// (Ramer, 1972; Douglas and Peucker, 1973).
fn straightened(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let seven = |point: &[f64; 2]| point.map(|value| to_significant(value, 7));
    let points: Vec<[f64; 2]> = points.iter().map(seven).collect();
    let [low, high] = range(points.iter().map(|[_, y]| *y));
    let near = 1e-3 * (high - low);
    let mut kept = vec![false; points.len()];
    let mut open = vec![(0, points.len() - 1)];
    while let Some((from, to)) = open.pop() {
        kept[from] = true;
        kept[to] = true;
        let ([x, y], [to_x, to_y]) = (points[from], points[to]);
        let away = |place: usize| {
            let part = (points[place][0] - x) / (to_x - x);
            (points[place][1] - (y + part * (to_y - y))).abs()
        };
        let farthest = (from + 1..to).max_by(|&a, &b| away(a).total_cmp(&away(b)));
        if let Some(place) = farthest.filter(|&place| away(place) > near) {
            open.extend([(from, place), (place, to)]);
        }
    }
    points.into_iter().zip(kept).filter(|(_, kept)| *kept).map(|(point, _)| point).collect()
}
