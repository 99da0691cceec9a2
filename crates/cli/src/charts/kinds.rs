//! Marks of motions by kind.

use amontons_analysis::study::{Kind, LongTermMotion};
use amontons_pictures::picture::{Marker, Series, Style};

/// The mark of each kind of motion that has an amplitude.
const MARKS: [(Kind, Marker); 6] = [
    (Kind::Equilibrium, Marker::Disc),
    (Kind::Periodic, Marker::Ring),
    (Kind::QuasiPeriodic, Marker::Square),
    (Kind::Irregular, Marker::Triangle),
    (Kind::Undecided, Marker::Diamond),
    (Kind::Unsettled, Marker::Cross),
];

/// A mark for each value of each curve, at the amplitude of its motion and by its kind; the legend lists each kind
/// once.
pub fn marks(curves: &[Vec<(f64, &LongTermMotion)>]) -> Vec<Series> {
    let mut series: Vec<Series> = Vec::new();
    for (colour, curve) in curves.iter().enumerate() {
        for (kind, marker) in MARKS {
            let is_kind = |ending: &LongTermMotion| {
                if ending.rests() { kind == Kind::Equilibrium } else { ending.kind == kind }
            };
            let of_kind = curve.iter().filter(|(_, ending)| is_kind(ending));
            let points: Vec<[f64; 2]> =
                of_kind.map(|(value, ending)| [*value, amplitude(ending)]).collect();
            let is_new = series.iter().all(|series| series.marker != Some(marker));
            if !points.is_empty() {
                let label = is_new.then(|| kind.name().to_owned());
                let marker = Some(marker);
                let style = Style::Dots;
                series.push(Series { label, points, colour, style, marker, ..Series::default() });
            }
        }
    }
    series
}

/// The amplitude that a picture shows: zero for motions at rest or decaying to rest.
pub fn amplitude(ending: &LongTermMotion) -> f64 {
    if ending.rests() { 0.0 } else { ending.amplitude }
}
