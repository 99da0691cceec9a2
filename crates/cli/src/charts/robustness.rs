//! The pictures of robustness: the histogram of growth rates, and bars of Sobol indices.

use amontons::scene::Scene;
use amontons_analysis::robustness::{Index, Parameter, Robustness};
use amontons_pictures::picture::{Chart, Class, Lane, LaneInterval, Mark, Panel, Series};

/// The part of the draws in each class of the largest growth rate.
#[must_use]
#[allow(clippy::cast_precision_loss)]
pub fn histogram(scene: &Scene, found: &Robustness) -> Chart {
    let mut stairs = Vec::new();
    for class in &found.histogram {
        let [from, to] = class.ends;
        let part = 100.0 * class.count as f64 / found.draws as f64;
        stairs.extend([[from, part], [to, part]]);
    }
    if let (Some([first, _]), Some([last, _])) = (stairs.first().copied(), stairs.last().copied()) {
        stairs.insert(0, [first, 0.0]);
        stairs.push([last, 0.0]);
    }
    let zero = Mark { x: 0.0, label: Some("unstable from here on".to_owned()) };
    Chart {
        title: format!("{}: the largest growth rate of the draws", scene.name),
        x_label: "Largest growth rate [1/s]".to_owned(),
        panels: vec![Panel {
            y_label: "Draws [%]".to_owned(),
            series: vec![Series { points: stairs, ..Series::default() }],
            marks: vec![zero],
            zero_line: true,
            ..Panel::default()
        }],
        logarithmic: false,
    }
}

/// A bar for each parameter: the part of the variance that it causes by itself, and that with others. `None` without indices.
#[must_use]
pub fn indices(scene: &Scene, parameters: &[Parameter], found: &Robustness) -> Option<Chart> {
    let panel = |of: &str, indices: &Option<Vec<Index>>| {
        let lane = |(parameter, index): (&Parameter, &Index)| {
            let own = index.first.value.clamp(0.0, 1.0);
            let all = index.total.value.clamp(own, f64::max(own, 1.0));
            let stretches = vec![
                LaneInterval { from: 0.0, to: own, class: 0 },
                LaneInterval { from: own, to: all, class: 1 },
            ];
            Lane { name: parameter.name().to_owned(), stretches }
        };
        let lanes = parameters.iter().zip(indices.as_ref()?).map(lane).collect();
        let names = ["by itself", "with other parameters"];
        let classes =
            names.iter().zip(0..).map(|(name, place)| Class::plain((*name).to_owned(), place));
        Some(Panel {
            y_label: of.to_owned(),
            lanes,
            classes: classes.collect(),
            ..Panel::default()
        })
    };
    let panels: Vec<Panel> = [
        panel("Largest growth rate", &found.of_growth),
        panel("Instability", &found.of_instability),
    ]
    .into_iter()
    .flatten()
    .collect();
    (!panels.is_empty()).then(|| Chart {
        title: format!("{}: Sobol indices", scene.name),
        x_label: "Part of the variance".to_owned(),
        panels,
        logarithmic: false,
    })
}
