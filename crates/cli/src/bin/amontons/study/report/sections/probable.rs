//! How probable: shares of unstable draws and of runs that squeal, where parameters scatter.

use super::super::Report;
use super::{cell, figure, table};
use amontons::simulation::Parameters;
use amontons_analysis::robustness::{Index, Parameter, Uncertain};
use amontons_cli::charts::robustness::{histogram, indices};
use amontons_cli::words::robustness as words;
use amontons_export::documentation::counted;
use amontons_pictures::report::{Cell, Content, Section, Table};

pub const HEADING: &str = "How probable is it?";

pub fn section(report: &Report<'_>) -> Section {
    let mut section = Section { heading: HEADING.to_owned(), ..Section::default() };
    let assumptions = report.assumptions;
    section.text.push(match (assumptions.is_assumed, report.parameters.len()) {
        (_, 0) => "No parameter scatters, so that there is no probability.".to_owned(),
        (true, _) => "How far parameters scatter is an assumption of this report, not a measurement: the friction coefficient with a \
                      standard deviation of 10 % of its value, each mass and stiffness with 5 %, all independent of each other. \
                      Probabilities below hold for this assumption alone; --uncertain replaces it."
            .to_owned(),
        (false, _) => "Parameters scatter as the command of this report says. Probabilities below hold for this scatter alone."
            .to_owned(),
    });
    if assumptions.is_together && !assumptions.is_friction_alone {
        let but = if assumptions.has_friction_apart() {
            ", but for friction, which stays below the static friction of each contact"
        } else {
            ""
        };
        section.text.push(format!(
            "There are more values than can scatter each by itself. All values of one kind, such as all masses, change by the same part of \
             themselves here: {} draws in place of one for each value{but}. Values that scatter independently may give other \
             probabilities.",
            report.parameters.len()
        ));
    }
    if assumptions.is_friction_alone {
        section.text.push(
            "There are more masses and stiffnesses than can scatter at once, so friction alone scatters here.".to_owned(),
        );
    }
    if report.scene.network().is_some_and(|network| !network.superelements.is_empty()) {
        section.text.push("Matrices of superelements do not scatter.".to_owned());
    }
    if !report.parameters.is_empty() {
        section.key_tables.push(scatter(report));
    }
    let both = match &report.robustness {
        Ok(both) => both,
        Err(reason) => {
            section.text.push(format!("Probabilities are not known: {reason}."));
            return section;
        }
    };
    if let Some(found) = &both.eigenvalues {
        section.text.push(format!(
            "Each of {} draws has eigenvalues of its own. A draw is unstable if a mode of its uniform sliding grows.",
            found.draws
        ));
        let rows = words::probabilities(found).into_iter().map(|(name, estimate)| {
            let [value, low, high] = [estimate.value, estimate.low, estimate.high]
                .map(|value| format!("{:.4} %", 100.0 * value));
            vec![name.into(), value.into(), format!("{low} to {high}").into()]
        });
        section.key_tables.push(table(
            "Probabilities with intervals of 95 %",
            &["", "Probability", "95 % interval"],
            rows.collect(),
        ));
        if !found.histogram.is_empty() {
            let caption =
                "The draws by their largest growth rate. To the right of zero they are unstable.";
            section.figures.push(figure(caption, Content::Chart(histogram(report.scene, found))));
        }
        if let Some(chart) = indices(report.scene, report.parameters, found) {
            let caption = "Sobol indices: the part of the variance that each parameter causes by itself, and the part that it causes \
                           together with others.";
            section.figures.push(figure(caption, Content::Chart(chart)));
        }
        if report.plan.has_indices {
            let why = words::growth_without_indices(found);
            add_indices(
                &mut section,
                "the largest growth rate",
                report.parameters,
                found.of_growth.as_deref(),
                why,
            );
            let why = words::INSTABILITY_WITHOUT_INDICES;
            add_indices(
                &mut section,
                "instability",
                report.parameters,
                found.of_instability.as_deref(),
                why,
            );
        } else {
            section.text.push(
                "Sobol indices, which tell whose scatter matters, were left out: for this scene they take long. --points 64 computes them."
                    .to_owned(),
            );
        }
    }
    if let Some(runs) = &both.runs {
        let pushes = report.arguments.scatter.pushes.as_ref();
        section.text.push(format!(
            "{} start with a push of {} m/s in a random direction: P(squeals) = {}.",
            counted(runs.runs.len(), "run", "runs"),
            pushes.map(ToString::to_string).unwrap_or_default(),
            words::squeal(runs)
        ));
        let rows = words::ends(runs).into_iter();
        let rows = rows.map(|(count, end)| vec![Cell::from(end), Cell::from(count.to_string())]);
        section.key_tables.push(table(
            "Ends of the runs after pushes",
            &["End", "Runs"],
            rows.collect(),
        ));
    }
    section
}

/// The parameters that scatter, as they were given.
fn scatter(report: &Report<'_>) -> Table {
    let all = Parameters::of(report.scene.clone());
    let rows = report.assumptions.uncertain.iter().map(|uncertain| {
        let Uncertain { name, .. } = uncertain;
        let of_name = report.parameters.iter().filter(|one| uncertain.is_of(one.name()));
        // Of values that scatter together a parameter has the first one.
        let own = all.iter().filter(|(variable, _)| uncertain.is_of(&variable.name));
        let [least, most] = amontons::numerics::range(own.map(|(_, value)| value));
        let values = if least == most { format!("{least}") } else { format!("{least} to {most}") };
        let count = of_name.count().to_string();
        vec![name.clone().into(), uncertain.written().into(), count.into(), values.into()]
    });
    let caption = "What scatters; ± is a standard deviation of a normal distribution about the scene's value, and half the width of a \
                   uniform one";
    table(caption, &["Parameters", "Distribution", "Number", "Values in the scene"], rows.collect())
}

fn add_indices(
    section: &mut Section,
    of: &str,
    parameters: &[Parameter],
    indices: Option<&[Index]>,
    why: &str,
) {
    let Some(indices) = indices else {
        section.text.push(format!("There are no Sobol indices of {of}: {why}."));
        return;
    };
    let rows = parameters.iter().zip(indices).map(|(parameter, Index { first, total })| {
        [parameter.name().to_owned(), words::part(first), words::part(total)]
            .map(|text| cell(text, false))
            .to_vec()
    });
    section.tables.push(table(
        format!("Sobol indices of {of}, parts of its variance, with intervals of 95 %"),
        &["Parameter", "By itself", "With all others"],
        rows.collect(),
    ));
}
