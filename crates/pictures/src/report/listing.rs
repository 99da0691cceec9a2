//! The data of a figure as tables, for those who cannot see it drawn: some 50 rows, evenly taken.

use super::Content;
use super::thin::evenly_spaced;
use crate::picture::number::typeset;
use crate::picture::{Bar, BarGroup, Chart, Lane, Map, Panel, Raster, Series, Structure};
use amontons::decimal::to_significant;

/// Rows of all tables of curves of a figure together.
const ROWS: usize = 50;
/// Rows that each of them has in any case.
const LEAST: usize = 6;
/// Rows and columns of a map's table.
const MAP: [usize; 2] = [20, 12];

pub(super) struct Listings {
    pub(super) tables: Vec<Listing>,
    /// The marks and bands beside the curves, in words.
    pub(super) notes: Vec<String>,
}

pub(super) struct Listing {
    title: String,
    pub(super) head: Vec<String>,
    pub(super) rows: Vec<Vec<String>>,
    /// Number of rows there are to take from, and their name.
    whole: (usize, &'static str),
}

impl Listing {
    /// The title, and whether the table is thinned.
    pub(super) fn caption(&self) -> String {
        let Self { title, rows, whole: (count, what), .. } = self;
        if rows.len() < *count {
            format!("{title} ({} of {count} {what}, evenly selected)", rows.len())
        } else {
            title.clone()
        }
    }
}

pub(super) fn listings(content: &Content) -> Listings {
    match content {
        Content::Chart(chart) => of_chart(chart),
        Content::Map(map) => Listings { tables: vec![of_map(map)], notes: Vec::new() },
        Content::Structure(structure) => {
            Listings { tables: of_structure(structure), notes: Vec::new() }
        }
        Content::Bars(bars) => {
            Listings { tables: bars.groups.iter().map(of_bars).collect(), notes: Vec::new() }
        }
    }
}

fn of_bars(group: &BarGroup) -> Listing {
    let row = |bar: &Bar| vec![bar.label.clone(), number(bar.value)];
    Listing {
        title: group.title.clone(),
        head: vec!["Name".to_owned(), group.axis.clone()],
        rows: group.bars.iter().map(row).collect(),
        whole: (0, "bars"),
    }
}

/// The parts of a structure with their values; a kind of which there is none has no table.
fn of_structure(structure: &Structure) -> Vec<Listing> {
    let mass = |place: usize| structure.masses[place].name.clone();
    let masses = structure.masses.iter().map(|one| vec![one.name.clone(), one.label.clone()]);
    let links = structure.links.iter().map(|one| {
        let ends = one.ends.map(|end| end.map_or_else(|| "ground".to_owned(), mass));
        vec![one.name.clone(), one.label.clone(), ends.join(" to ")]
    });
    let sliders = structure.sliders.iter().map(|one| {
        let on = one.on.map_or_else(|| "a rigid surface".to_owned(), mass);
        vec![one.name.clone(), one.label.clone(), format!("{} on {on}", mass(one.mass))]
    });
    let forces = structure.forces.iter();
    let forces = forces.map(|one| vec![one.name.clone(), one.label.clone(), mass(one.mass)]);
    let listing = |title: &str, head: &[&str], rows: Vec<Vec<String>>| Listing {
        title: title.to_owned(),
        head: head.iter().map(|&name| name.to_owned()).collect(),
        rows,
        whole: (0, "parts"),
    };
    let all = [
        listing("Masses", &["Name", "Value"], masses.collect()),
        listing("Springs and dampers", &["Name", "Value", "Between"], links.collect()),
        listing("Contacts", &["Name", "Values", "Between"], sliders.collect()),
        listing("Forces", &["Name", "Value", "On"], forces.collect()),
    ];
    all.into_iter().filter(|listing| !listing.rows.is_empty()).collect()
}

fn of_chart(chart: &Chart) -> Listings {
    let mut tables = Vec::new();
    let groups = same_x(chart);
    let rows = (ROWS / groups.len().max(1)).max(LEAST);
    tables.extend(groups.iter().map(|group| of_curves(chart, group, rows)));
    for panel in &chart.panels {
        tables.extend(panel.raster.as_ref().map(|raster| of_raster(chart, panel, raster)));
        if !panel.lanes.is_empty() {
            tables.push(of_lanes(panel));
        }
    }
    Listings { tables, notes: notes(chart) }
}

/// Curves that share their x: one table can have them all.
fn same_x(chart: &Chart) -> Vec<Vec<(&Panel, &Series)>> {
    let mut groups: Vec<Vec<(&Panel, &Series)>> = Vec::new();
    let all =
        chart.panels.iter().flat_map(|panel| panel.series.iter().map(move |one| (panel, one)));
    for (panel, series) in all.filter(|(_, series)| !series.points.is_empty()) {
        let is_same = |group: &&mut Vec<(&Panel, &Series)>| {
            let known = &group[0].1.points;
            known.len() == series.points.len()
                && known.iter().zip(&series.points).all(|(a, b)| a[0].to_bits() == b[0].to_bits())
        };
        match groups.iter_mut().find(is_same) {
            Some(group) => group.push((panel, series)),
            None => groups.push(vec![(panel, series)]),
        }
    }
    groups
}

fn of_curves(chart: &Chart, group: &[(&Panel, &Series)], rows: usize) -> Listing {
    let name = |panel: &Panel, series: &Series| match &series.label {
        Some(label) => format!("{label}: {}", panel.y_label),
        None => panel.y_label.clone(),
    };
    let labelled = group.iter().find(|(_, series)| !series.labels.is_empty());
    let mut head = vec![chart.x_label.clone()];
    head.extend(group.iter().map(|(panel, series)| name(panel, series)));
    head.extend(labelled.map(|_| "Label".to_owned()));
    let count = group[0].1.points.len();
    let rows = evenly_spaced(count, rows).into_iter().map(|place| {
        let mut row = vec![number(group[0].1.points[place][0])];
        row.extend(group.iter().map(|(_, series)| number(series.points[place][1])));
        row.extend(
            labelled.map(|(_, series)| series.labels.get(place).cloned().unwrap_or_default()),
        );
        row
    });
    let title = match group {
        [(panel, series)] => name(panel, series),
        _ => format!("Curves over {}", chart.x_label),
    };
    Listing { title, head, rows: rows.collect(), whole: (count, "points") }
}

/// Table of the place at which each column of a raster is largest.
#[allow(clippy::cast_precision_loss)]
fn of_raster(chart: &Chart, panel: &Panel, raster: &Raster) -> Listing {
    let columns = raster.rows.first().map_or(0, Vec::len);
    let middle = |[from, to]: [f64; 2], place: usize, count: usize| {
        from + (to - from) * (place as f64 + 0.5) / count as f64
    };
    let value =
        |row: usize, column: usize| raster.rows[row].get(column).copied().unwrap_or(f64::NAN);
    let rows = evenly_spaced(columns, ROWS).into_iter().map(|column| {
        let finite = (0..raster.rows.len()).filter(|&row| value(row, column).is_finite());
        let most = finite.max_by(|&a, &b| value(a, column).total_cmp(&value(b, column)));
        let x = number(middle(raster.x, column, columns));
        match most {
            Some(row) => {
                let y = number(middle(raster.y, row, raster.rows.len()));
                vec![x, y, number(value(row, column))]
            }
            None => vec![x, number(f64::NAN), number(f64::NAN)],
        }
    });
    Listing {
        title: format!("Maximum of {} over {}", raster.label, chart.x_label),
        head: vec![chart.x_label.clone(), panel.y_label.clone(), raster.label.clone()],
        rows: rows.collect(),
        whole: (columns, "columns"),
    }
}

/// The share that each class has of each lane, which also thousands of stretches have.
fn of_lanes(panel: &Panel) -> Listing {
    let row = |lane: &Lane| {
        let length = |class: Option<usize>| {
            let of_class =
                lane.stretches.iter().filter(|one| class.is_none_or(|class| one.class == class));
            of_class.map(|one| one.to - one.from).filter(|length| length.is_finite()).sum::<f64>()
        };
        let whole = length(None);
        let shares = (0..panel.classes.len()).map(|class| match whole > 0.0 {
            true => format!("{} %", number(1e-1 * (1e3 * length(Some(class)) / whole).round())),
            false => number(f64::NAN),
        });
        std::iter::once(lane.name.clone()).chain(shares).collect()
    };
    let classes = panel.classes.iter().map(|class| class.name.clone());
    Listing {
        title: format!(
            "{}: share of the whole",
            if panel.y_label.is_empty() { "States" } else { &panel.y_label }
        ),
        head: std::iter::once("Lane".to_owned()).chain(classes).collect(),
        rows: panel.lanes.iter().map(row).collect(),
        whole: (0, "lanes"),
    }
}

/// The highest row first, as it is drawn.
#[allow(clippy::cast_precision_loss)]
fn of_map(map: &Map) -> Listing {
    let counts = [map.cells.len(), map.cells.first().map_or(0, Vec::len)];
    let at = |[from, to]: [f64; 2], place: usize, count: usize| {
        number(from + (to - from) * place as f64 / (count.max(2) - 1) as f64)
    };
    let across = evenly_spaced(counts[1], MAP[1]);
    let mut head = vec![format!("{} \\ {}", map.y_label, map.x_label)];
    head.extend(across.iter().map(|&column| at(map.x, column, counts[1])));
    let rows = evenly_spaced(counts[0], MAP[0]).into_iter().rev().map(|row| {
        let class = |column: &usize| map.classes[map.cells[row][*column]].name.clone();
        std::iter::once(at(map.y, row, counts[0])).chain(across.iter().map(class)).collect()
    });
    Listing { title: map.title.clone(), head, rows: rows.collect(), whole: (counts[0], "rows") }
}

fn notes(chart: &Chart) -> Vec<String> {
    let mut notes = Vec::new();
    let mut note = |text: String| {
        if !notes.contains(&text) {
            notes.push(text);
        }
    };
    for panel in &chart.panels {
        for mark in &panel.marks {
            if let Some(label) = &mark.label {
                note(format!("Marked: {label}, at {}.", number(mark.x)));
            }
        }
        for band in &panel.bands {
            if let Some(label) = &band.label {
                note(format!(
                    "Shaded: {label}, from {} to {}.",
                    number(band.from),
                    number(band.to)
                ));
            }
        }
    }
    notes
}

/// Five significant digits, with a minus sign that is one.
fn number(value: f64) -> String {
    let short = to_significant(value, 5);
    match short {
        f64::INFINITY => "∞".to_owned(),
        f64::NEG_INFINITY => "−∞".to_owned(),
        _ if short.is_nan() => "–".to_owned(),
        _ => typeset(short, short == 0.0 || (1e-4..1e6).contains(&short.abs())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!(number(0.1 + 0.2), "0.3");
        assert_eq!(number(-1.0 / 3.0), "−0.33333");
        assert_eq!(number(2.5e-7), "2.5e−7");
        assert_eq!(number(-0.0), "0");
        assert_eq!([number(f64::NAN), number(f64::NEG_INFINITY)], ["–", "−∞"]);
    }
}
