//! The pictures of a design: growth over the friction coefficient before and after, and its trade-off with the change.

use amontons::scene::Scene;
use amontons_analysis::design::{FoundDesign, Reached};
use amontons_pictures::picture::{Chart, Marker, Panel, Series, Style};

/// The largest growth rates of the scene and of the design over the friction coefficient.
#[must_use]
pub fn growth(scene: &Scene, found: &FoundDesign) -> Chart {
    let series =
        |name: &str, colour: usize, of: fn(&amontons_analysis::design::Growth) -> f64| Series {
            label: Some(name.to_owned()),
            points: found.growth.iter().map(|at| [at.friction, of(at)]).collect(),
            colour,
            ..Series::default()
        };
    Chart {
        title: format!("{}: the largest growth rate before and after the change", scene.name),
        x_label: "friction coefficient µ".to_owned(),
        panels: vec![Panel {
            y_label: "Largest growth rate [1/s]".to_owned(),
            series: vec![series("scene", 1, |at| at.before), series("design", 0, |at| at.after)],
            zero_line: true,
            ..Panel::default()
        }],
        logarithmic: false,
    }
}

/// The largest growth rate over the range against the size of the smallest change that reaches it.
#[must_use]
pub fn trade_off(scene: &Scene, found: &FoundDesign) -> Chart {
    let at = |it: &Reached| [100.0 * it.size, it.worst.growth];
    let curve = Series {
        points: found.trade_off.iter().map(at).collect(),
        marker: Some(Marker::Disc),
        ..Series::default()
    };
    let design = Series {
        label: Some("the design".to_owned()),
        points: vec![at(&found.design)],
        marker: Some(Marker::Ring),
        colour: 1,
        style: Style::Dots,
        ..Series::default()
    };
    Chart {
        title: format!("{}: growth rate against the size of the change", scene.name),
        x_label: "Size of the change [%]".to_owned(),
        panels: vec![Panel {
            y_label: "Largest growth rate [1/s]".to_owned(),
            series: vec![curve, design],
            zero_line: true,
            ..Panel::default()
        }],
        logarithmic: false,
    }
}
