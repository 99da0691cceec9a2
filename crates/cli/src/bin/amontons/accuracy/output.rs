//! The table of `amontons accuracy`, as text, CSV and JSON.

use super::{AccuracyReport, Timed};
use amontons::scene::Method;
use amontons_analysis::accuracy::{COLUMNS, Errors, LEGEND};
use amontons_cli::arguments::Format;
use serde_json::{Map, Value, json};
use std::io::{self, Write};

/// Widths of the columns; the first column is flush left.
const WIDTHS: [usize; COLUMNS.len()] = [17, 9, 10, 14, 11, 12, 9, 9, 11, 6];

impl AccuracyReport<'_> {
    pub(super) fn print(&self, out: &mut dyn Write) -> io::Result<()> {
        match self.arguments.format {
            Format::Table => self.print_table(out)?,
            Format::Csv => self.print_csv(out)?,
            Format::Json => writeln!(out, "{:#}", self.as_json())?,
        }
        out.flush()
    }

    fn print_table(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "{}", self.study.title())?;
        for (what, text) in self.study.facts() {
            writeln!(out, "  {what:13}  {text}")?;
        }
        writeln!(out)?;
        print_row(out, &COLUMNS.map(str::to_owned), "ms per s")?;
        for Timed { row, order, seconds } in &self.rows {
            let time = seconds.map_or_else(|| "-".to_owned(), |time| milliseconds(1e3 * time));
            print_row(out, &self.study.cells(row, *order), &time)?;
        }
        writeln!(out)?;
        for note in &self.notes {
            writeln!(out, "note: {note}")?;
        }
        writeln!(
            out,
            "{LEGEND} ms per s: computing time of a simulated\nsecond on one thread without set-up, best of several \
             runs."
        )
    }

    fn print_csv(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(
            out,
            "method,step,steps,events,events_more,touch_downs,rms_error,amplitude_error,\
             frequency_error,event_time_error,largest_event_time_error,order,seconds_per_second"
        )?;
        let study = &self.study;
        let number =
            |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:?}"));
        let errors = |errors: &Errors| {
            let Errors { rms, amplitude, frequency, event_time, largest_event_time } = *errors;
            let all = [rms, amplitude, frequency, event_time, largest_event_time];
            all.map(number).join(",")
        };
        let statistics = study.reference_statistics();
        writeln!(
            out,
            "reference,{:?},{},{},0,{},{},,",
            study.reference_step(),
            statistics.steps,
            statistics.state_changes(),
            statistics.touch_downs,
            errors(&study.floor())
        )?;
        for Timed { row, order, seconds } in &self.rows {
            writeln!(
                out,
                "{},{:?},{},{},{},{},{},{},{}",
                row.candidate.method,
                row.candidate.step,
                row.statistics.steps,
                row.statistics.state_changes(),
                row.events_more,
                row.statistics.touch_downs,
                errors(&row.errors),
                number(*order),
                number(*seconds)
            )?;
        }
        Ok(())
    }

    fn as_json(&self) -> Value {
        let study = &self.study;
        let errors = |errors: &Errors| {
            json!({
                "rms": errors.rms,
                "amplitude": errors.amplitude,
                "frequency": errors.frequency,
                "event_time": errors.event_time,
                "largest_event_time": errors.largest_event_time,
            })
        };
        let rows = self.rows.iter().map(|Timed { row, order, seconds }| {
            json!({
                "method": row.candidate.method.to_string(),
                "step": row.candidate.step,
                "steps": row.statistics.steps,
                "events": row.statistics.state_changes(),
                "events_more": row.events_more,
                "touch_downs": row.statistics.touch_downs,
                "ended_hops": row.statistics.ended_hops,
                "errors": errors(&row.errors),
                "out_of_phase": row.is_out_of_phase(),
                "order": order,
                "seconds_per_second": seconds,
            })
        });
        let values = self.arguments.set.iter().map(|(name, value)| (name.clone(), json!(value)));
        let statistics = study.reference_statistics();
        json!({
            "program": "amontons",
            "version": env!("CARGO_PKG_VERSION"),
            "scene": self.arguments.scene,
            "values": values.collect::<Map<_, _>>(),
            "stop_time": study.scene().experiment.stop_time,
            "interval": study.grid().interval,
            "critical_step": study.critical_step().ok().map(|critical| critical.step),
            "reference": {
                "method": Method::EventDriven.to_string(),
                "step": study.reference_step(),
                "steps": statistics.steps,
                "events": statistics.state_changes(),
                "touch_downs": statistics.touch_downs,
                "ended_hops": statistics.ended_hops,
                "deviation": study.scale(),
                "cycle_of": study.scene().dof_names()[study.dof()],
                "amplitude": study.cycle().amplitude,
                "frequency": study.cycle().frequency,
                "errors": errors(&study.floor()),
            },
            "rows": rows.collect::<Vec<_>>(),
            "notes": self.notes,
            "complete": self.complete,
        })
    }
}

fn print_row(out: &mut dyn Write, cells: &[String; COLUMNS.len()], time: &str) -> io::Result<()> {
    let [first, others @ ..] = cells;
    write!(out, "{first:0$}", WIDTHS[0])?;
    for (cell, width) in others.iter().zip(&WIDTHS[1..]) {
        write!(out, " {cell:>width$}")?;
    }
    writeln!(out, " {time:>9}")
}

/// Formats a time to three digits.
fn milliseconds(time: f64) -> String {
    match time {
        100.0.. => format!("{time:.0}"),
        10.0.. => format!("{time:.1}"),
        1.0.. => format!("{time:.2}"),
        _ => format!("{time:.3}"),
    }
}
