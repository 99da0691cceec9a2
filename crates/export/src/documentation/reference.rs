//! The reference run as a chart, and as a table with all digits.

use super::markup;
use super::run::ReferenceRun;
use amontons::Error;
use amontons::scene::Scene;
use amontons::simulation::Variable;
use amontons::simulation::catalogue::Kind;
use amontons_pictures::picture::{Chart, Panel, Series};
use amontons_pictures::report::{add, envelope, evenly_spaced, plain_table, text};

/// Parts of the time of which a curve keeps its lowest and its highest point: a picture 900 px wide has no more.
const PARTS: f64 = 700.0;
/// Rows of the table, at equal parts of the run.
const TABLE_ROWS: usize = 9;

/// `true` if values are those of the start, but for rounding.
fn is_still(values: &[f64], start: &[f64]) -> bool {
    values.iter().zip(start).all(|(value, start)| (value - start).abs() <= 1e-12 * start.abs())
}

/// # Errors
/// Returns an error if the chart cannot be drawn.
pub(super) fn section(scene: &Scene, run: &ReferenceRun) -> Result<String, Error> {
    let mut html = String::new();
    let (experiment, rows) = (run.experiment, &run.rows);
    let interval = experiment.output_interval;
    let mut words = format!(
        "A run of this scene by Amontons itself, without an importer and with the start values of all variables: from \
         0 to {} s, one row every {interval} s.",
        experiment.stop_time
    );
    if !run.whole {
        words += &format!(
            " The whole experiment of the scene is {} s long; this run ends earlier, after a fixed number of \
             operations, to keep the export quick.",
            scene.experiment.stop_time
        );
    }
    if rows.iter().all(|(_, values)| is_still(values, &rows[0].1)) {
        words += " With its start values this scene stays at rest: for a comparison, set an input that moves it in \
                  both programs.";
    }
    words += " An importer that steps through the same times gets the same doubles, to the last bit; each row below is \
              at one of these times.";
    markup::paragraphs(&mut html, &[words]);
    if let Some(failure) = &run.failure {
        let last = rows.last().map_or(0.0, |row| row.0);
        markup::paragraphs(&mut html, &[format!("The run ends at {last} s: {failure}.")]);
    }
    // If all is locked and nothing touches, nothing moves.
    if rows.len() > 1 && !run.variables.is_empty() {
        let svg = chart(scene, run).svg()?;
        markup::figure(
            &mut html,
            "run-figure",
            &svg,
            "Lowest and highest value in each 700th part of the run.",
        );
    }
    let columns: Vec<String> =
        std::iter::once("time [s]".to_owned()).chain(run.variables.iter().map(label)).collect();
    let cells = evenly_spaced(rows.len(), TABLE_ROWS).into_iter().map(|place| {
        let (time, values) = &rows[place];
        let values = run.variables.iter().zip(values).map(|(variable, value)| match variable {
            Variable { template, .. } if matches!(template.kind, Kind::Real { .. }) => {
                format!("{value:?}")
            }
            _ => format!("{value}"),
        });
        std::iter::once(format!("{time:?}")).chain(values).collect::<Vec<_>>().into_iter()
    });
    plain_table(
        &mut html,
        "run-values",
        "Values with all their digits: each is the shortest decimal that reads back as the same double",
        &columns,
        cells,
    );
    add(
        &mut html,
        format_args!(
            "<p class=\"hint\"><code>amontons simulate</code> writes all rows and outputs; <code>amontons export \
             --with-reference</code> writes a file of them beside the FMU, with the settings for an importer \
             ({}).</p>\n",
            text("FMI cross-check: _ref.csv, _ref.opt, _in.csv")
        ),
    );
    Ok(html)
}

/// A variable with its unit.
fn label(variable: &Variable) -> String {
    match variable.template.kind {
        Kind::Real { unit, .. } if unit != "1" => format!("{} [{unit}]", variable.name),
        _ => variable.name.clone(),
    }
}

fn chart(scene: &Scene, run: &ReferenceRun) -> Chart {
    let panel = |(column, variable): (usize, &Variable)| {
        let points: Vec<[f64; 2]> =
            run.rows.iter().map(|(time, values)| [*time, values[column]]).collect();
        Panel {
            y_label: label(variable),
            series: vec![Series {
                points: envelope(&points, PARTS),
                colour: column,
                ..Series::default()
            }],
            ..Panel::default()
        }
    };
    Chart {
        title: format!("{}: reference run", scene.name),
        x_label: "Time [s]".into(),
        panels: run.variables.iter().enumerate().map(panel).collect(),
        ..Chart::default()
    }
}
