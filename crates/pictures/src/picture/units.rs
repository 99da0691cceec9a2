//! Units on axes: values of a quantity that is far from one unit are shown with a prefix, as µm or kHz.

use super::Chart;
use super::map::Map;
use std::borrow::Cow;

/// Units that take a prefix. Others, such as "1/s", "dB" or "–", stay.
const UNITS: [&str; 19] = [
    "m", "m/s", "m/s²", "m/s2", "s", "Hz", "N", "N/m", "N s/m", "N.s/m", "N·s/m", "J", "W", "Pa",
    "rad", "V", "A", "N m", "N.m",
];

/// Prefixes with what values in the bare unit are multiplied by.
const PREFIXES: [(&str, f64); 8] = [
    ("p", 1e12),
    ("n", 1e9),
    ("µ", 1e6),
    ("m", 1e3),
    ("", 1.0),
    ("k", 1e-3),
    ("M", 1e-6),
    ("G", 1e-9),
];

/// Masses go from gram to tonne.
const MASSES: [(&str, f64); 4] = [("mg", 1e6), ("g", 1e3), ("kg", 1.0), ("t", 1e-3)];

/// The unit that a label ends with, in brackets, and what stands before it: "Time [s]".
pub(super) fn unit_of(label: &str) -> Option<(&str, &str)> {
    label.strip_suffix(']')?.rsplit_once('[').filter(|(_, unit)| !unit.is_empty())
}

/// The factor of the values on an axis, and the axis's label that goes with it. `None` for values whose largest is
/// from a tenth to ten thousand units, or is nothing, and for those without a unit that takes a prefix.
pub(super) fn prefixed_axis(label: &str, range: [f64; 2]) -> Option<(f64, String)> {
    let (name, unit) = unit_of(label)?;
    let largest = range[0].abs().max(range[1].abs());
    if !largest.is_finite() || largest == 0.0 || (0.1..1e4).contains(&largest) {
        return None;
    }
    let fits = |factor: f64| (1.0 - 1e-9..1e3).contains(&(largest * factor));
    let found = if unit == "kg" {
        MASSES
            .iter()
            .find(|(_, factor)| fits(*factor))
            .map(|(unit, factor)| ((*unit).to_owned(), *factor))
    } else if UNITS.contains(&unit) {
        let prefix = PREFIXES.iter().find(|(_, factor)| fits(*factor));
        prefix.map(|(prefix, factor)| (format!("{prefix}{unit}"), *factor))
    } else {
        None
    };
    found
        .filter(|(_, factor)| *factor != 1.0)
        .map(|(unit, factor)| (factor, format!("{name}[{unit}]")))
}

impl Chart {
    /// `true` if there is no mark whose label gives its place without a unit. Such a number would not be that of an
    /// axis with a prefix.
    fn marks_have_units(&self) -> bool {
        let unit = unit_of(&self.x_label).map_or("", |(_, unit)| unit);
        let mut labels =
            self.panels.iter().flat_map(|p| &p.marks).filter_map(|m| m.label.as_deref());
        labels.all(|label| !label.contains(|c: char| c.is_ascii_digit()) || label.ends_with(unit))
    }

    /// The chart with values and labels in units with prefixes where those make numbers short. Logarithmic axes stay,
    /// whose ticks are powers of ten.
    pub(crate) fn in_prefixed_units(&self) -> Cow<'_, Self> {
        if self.logarithmic {
            return Cow::Borrowed(self);
        }
        let across = self.x_range().ok().and_then(|range| prefixed_axis(&self.x_label, range));
        let across = across.filter(|_| self.marks_have_units());
        let up: Vec<Option<(f64, String)>> = self
            .panels
            .iter()
            .map(|panel| {
                let range = self.y_range(panel).ok().filter(|_| panel.lanes.is_empty())?;
                prefixed_axis(&panel.y_label, range)
            })
            .collect();
        if across.is_none() && up.iter().all(Option::is_none) {
            return Cow::Borrowed(self);
        }
        let mut chart = self.clone();
        let x = across.as_ref().map_or(1.0, |(factor, _)| *factor);
        if let Some((_, label)) = across {
            chart.x_label = label;
        }
        for (panel, up) in chart.panels.iter_mut().zip(up) {
            let y = up.as_ref().map_or(1.0, |(factor, _)| *factor);
            if let Some((_, label)) = up {
                panel.y_label = label;
            }
            for point in panel.series.iter_mut().flat_map(|series| &mut series.points) {
                *point = [point[0] * x, point[1] * y];
            }
            panel.marks.iter_mut().for_each(|mark| mark.x *= x);
            for band in &mut panel.bands {
                (band.from, band.to) = (band.from * x, band.to * x);
            }
            if let Some(raster) = &mut panel.raster {
                (raster.x, raster.y) = (raster.x.map(|end| end * x), raster.y.map(|end| end * y));
            }
            for stretch in panel.lanes.iter_mut().flat_map(|lane| &mut lane.stretches) {
                (stretch.from, stretch.to) = (stretch.from * x, stretch.to * x);
            }
        }
        Cow::Owned(chart)
    }
}

impl Map {
    /// The map with units that have prefixes, by the rules of a [`Chart`].
    pub(crate) fn in_prefixed_units(&self) -> Cow<'_, Self> {
        let [across, up] = [(&self.x_label, self.x), (&self.y_label, self.y)]
            .map(|(label, range)| prefixed_axis(label, range));
        let mut map = Cow::Borrowed(self);
        if let Some((factor, label)) = across {
            let map = map.to_mut();
            (map.x, map.x_label) = (map.x.map(|end| end * factor), label);
        }
        if let Some((factor, label)) = up {
            let map = map.to_mut();
            (map.y, map.y_label) = (map.y.map(|end| end * factor), label);
        }
        map
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::{Mark, Panel, Series};

    fn axis(label: &str, range: [f64; 2]) -> Option<(f64, String)> {
        prefixed_axis(label, range)
    }

    #[test]
    fn a_prefix_makes_the_largest_number_lie_between_one_and_a_thousand() {
        assert_eq!(axis("x [m]", [-1e-4, 5e-5]), Some((1e6, "x [µm]".into())));
        assert_eq!(axis("v [m/s]", [0.0, 0.02]), Some((1e3, "v [mm/s]".into())));
        assert_eq!(axis("Frequency [Hz]", [0.0, 25e3]), Some((1e-3, "Frequency [kHz]".into())));
        assert_eq!(axis("k [N/m]", [1e6, 5.5e6]), Some((1e-6, "k [MN/m]".into())));
        assert_eq!(axis("mass [kg]", [0.0, 0.02]), Some((1e3, "mass [g]".into())));
    }

    #[test]
    fn short_numbers_and_other_units_stay() {
        for (label, range) in [
            ("Time [s]", [0.0, 0.5]),
            ("Frequency [Hz]", [0.0, 5000.0]),
            ("Growth rate [1/s]", [-2e4, 2e4]),
            ("Friction coefficient µ [–]", [0.0, 0.01]),
            ("friction coefficient µ", [0.0, 0.01]),
            ("mass [kg]", [0.1, 0.3]),
            ("x [m]", [0.0, 0.0]),
            ("x [m]", [0.0, 1e-30]),
        ] {
            assert_eq!(axis(label, range), None, "{label} {range:?}");
        }
    }

    #[test]
    fn all_that_lies_on_an_axis_is_in_its_unit() {
        let chart = Chart {
            x_label: "Time [s]".into(),
            panels: vec![Panel {
                y_label: "x [m]".into(),
                series: vec![Series {
                    points: vec![[0.0, 0.0], [0.02, 4e-6], [0.04, f64::NAN]],
                    ..Series::default()
                }],
                marks: vec![Mark { x: 0.01, label: None }],
                ..Panel::default()
            }],
            ..Chart::default()
        };
        let shown = chart.in_prefixed_units();
        let panel = &shown.panels[0];
        assert_eq!((&*shown.x_label, &*panel.y_label), ("Time [ms]", "x [µm]"));
        assert_eq!((panel.series[0].points[1], panel.marks[0].x), ([20.0, 4.0], 10.0));
        assert!(panel.series[0].points[2][1].is_nan());
        // A number without a unit is read on the axis.
        let mut marked = chart;
        marked.panels[0].marks[0].label = Some("begins at 0.01".into());
        assert_eq!(marked.in_prefixed_units().x_label, "Time [s]");
        marked.panels[0].marks[0].label = Some("begins at 10 ms".into());
        assert_eq!(marked.in_prefixed_units().x_label, "Time [ms]");
    }
}
