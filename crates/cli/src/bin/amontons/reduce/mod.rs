//! `amontons reduce`.

mod modes;
mod table;

use crate::arguments::Reduce;
use amontons::Error;
use amontons_analysis::output;
use amontons_analysis::watch::Watch;
use amontons_cli::interrupt::watched;
use amontons_cli::progress::Progress;
use amontons_cli::say;
use amontons_matrices::{
    Matrix, align, name_rows, open, read_freedoms, write_freedoms, write_matrix_market, write_npy,
};
use amontons_pictures::picture::check_name;
use amontons_structures::nodes::open_mesh;
use amontons_structures::shapes::{ROWS, SHAPES};
use amontons_structures::symmetric::{Request, Structure, Superelement, certify, reduce};
use std::fmt;
use std::fs;
use std::io::ErrorKind;
use table::{Certified, Report};

/// The name of the file with the report.
const CERTIFICATE: &str = "certificate.json";
/// Shares of the work at which the reduction and the first certificate end.
const SHARES: [f64; 2] = [0.4, 0.8];

pub fn run(arguments: &Reduce) -> Result<(), Box<dyn std::error::Error>> {
    let mut stiffness = open(&arguments.stiffness)?;
    let mut mass = open(&arguments.mass)?;
    let mut also = Vec::new();
    for (label, location) in &arguments.also {
        if also.iter().any(|(other, _): &(&String, Matrix)| other.eq_ignore_ascii_case(label)) {
            return Err(Error::argument(format!("--also {label} is given twice")).into());
        }
        also.push((label, open(location)?));
    }
    if arguments.freedoms.is_some() {
        // The table of freedoms is not to blame for a matrix that is unlike the others.
        let unnamed = also.iter().filter(|(_, matrix)| matrix.freedoms.is_none());
        check_sizes(unnamed, stiffness.rows)?;
    }
    let locations = arguments.also.iter().map(|(_, location)| location);
    let locations = [&arguments.stiffness, &arguments.mass].into_iter().chain(locations);
    let files: Vec<String> = locations.map(ToString::to_string).collect();
    let others = also.iter_mut().map(|(_, matrix)| matrix);
    let mut all: Vec<&mut Matrix> = [&mut stiffness, &mut mass].into_iter().chain(others).collect();
    if let Some(path) = &arguments.freedoms {
        let freedoms = read_freedoms(path)?;
        let unnamed = all.iter_mut().filter(|matrix| matrix.freedoms.is_none());
        let mut unnamed = unnamed.peekable();
        if unnamed.peek().is_none() {
            return Err(Error::argument(
                "the files of the matrices name their rows themselves; leave out --freedoms",
            )
            .into());
        }
        for matrix in unnamed {
            name_rows(matrix, &freedoms, path)?;
        }
    }
    align(&mut all, &files).map_err(Error::argument)?;
    check_sizes(&also, stiffness.rows)?;
    if stiffness.freedoms.is_none() {
        eprintln!(
            "note: the files name no nodes: --contacts and --retain take numbers of rows; give --freedoms for nodes and directions"
        );
    }
    let structure = Structure::new(&stiffness, &mass)?;
    if arguments.output.join(CERTIFICATE).exists() {
        return Err(Error::argument(format!(
            "{} holds another superelement; remove it, or give another folder",
            arguments.output.display()
        ))
        .into());
    }
    let mesh = arguments.mesh.as_deref().map(|path| open_mesh(path, structure.freedoms()));
    let mesh = mesh.transpose()?;
    if let Some(path) = &arguments.picture {
        check_name(path)?;
    }
    let contacts = structure.rows_of(&arguments.contacts.0)?;
    let mut retained = arguments.contacts.0.clone();
    retained.extend(arguments.retain.iter().flat_map(|nodes| &nodes.0));
    let request = Request {
        retained: structure.rows_of(&retained)?,
        modes_to: arguments.modes_to.unwrap_or(2.0 * arguments.frequency),
        memory: bytes(arguments.memory),
    };
    let progress = Progress::in_uneven_parts("the reduction");
    let found = watched(&progress, |watch| -> Result<_, Error> {
        let part = |first: f64, last: f64| {
            move |part: f64| (watch.progress)(first + (last - first) * part)
        };
        let [reduced, free] = SHARES;
        let superelement =
            reduce(&structure, &request, Watch { progress: &part(0.0, reduced), ..watch })?;
        progress.say("the certificate of the free structure");
        let frequency = arguments.frequency;
        let memory = request.memory;
        let watch_free = Watch { progress: &part(reduced, free), ..watch };
        let free_modes = certify(&structure, &superelement, &[], frequency, memory, watch_free)?;
        progress.say("the certificate with contacts stuck");
        let watch_stuck = Watch { progress: &part(free, 1.0), ..watch };
        let stuck_modes =
            certify(&structure, &superelement, &contacts, frequency, memory, watch_stuck)?;
        Ok((superelement, free_modes, stuck_modes))
    });
    let (superelement, free, stuck) = found?;
    let report = Report::new(
        &structure,
        &superelement,
        &request,
        Certified::new(&free),
        Certified::new(&stuck),
    );
    write_results(arguments, &structure, &superelement, &also, &report)?;
    if let Some(mesh) = &mesh {
        modes::write(arguments, mesh, &structure, &superelement)?;
    }
    match report.print(&mut std::io::stdout().lock()) {
        // The files are written, and whether the certificate is complete shows in the exit code.
        Err(error) if error.kind() == ErrorKind::BrokenPipe => {}
        printed => printed?,
    }
    say!("\nwritten to {}", arguments.output.display());
    if report.is_complete() { Ok(()) } else { Err(NotShown.into()) }
}

/// Refuses a further matrix that has not as many rows and columns as the stiffness matrix.
fn check_sizes<'a>(
    also: impl IntoIterator<Item = &'a (&'a String, Matrix)>,
    order: usize,
) -> Result<(), Error> {
    for (label, matrix) in also {
        if [matrix.rows, matrix.columns] != [order; 2] {
            return Err(Error::argument(format!(
                "--also {label} has {} rows and {} columns, and the stiffness matrix {order} rows; all must be square and of one size",
                matrix.rows, matrix.columns
            )));
        }
    }
    Ok(())
}

/// The superelement is written, but it was not shown that no mode is missing.
#[derive(Debug)]
pub struct NotShown;

impl fmt::Display for NotShown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the certificate is not complete: see above")
    }
}

impl std::error::Error for NotShown {}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn bytes(gigabytes: f64) -> usize {
    (gigabytes * 1e9) as usize
}

fn write_results(
    arguments: &Reduce,
    structure: &Structure,
    superelement: &Superelement,
    also: &[(&String, Matrix)],
    report: &Report,
) -> Result<(), Error> {
    let folder = &arguments.output;
    fs::create_dir_all(folder).map_err(|error| Error::file(folder, &error))?;
    let put = |name: &str, content: &[u8]| output::write(&folder.join(name), content);
    let [stiffness, mass] = superelement.matrices(structure);
    put("stiffness.mtx", write_matrix_market(&stiffness).as_bytes())?;
    put("mass.mtx", write_matrix_market(&mass).as_bytes())?;
    for (label, full) in also {
        let reduced = superelement.reduced(structure, full)?;
        put(&format!("{label}.mtx"), write_matrix_market(&reduced).as_bytes())?;
    }
    let freedoms = stiffness.freedoms.unwrap_or_default();
    put("freedoms.csv", write_freedoms(&freedoms).as_bytes())?;
    if arguments.shapes {
        let basis = &superelement.basis;
        let values = (0..basis.ncols()).flat_map(|column| basis.col(column).iter().copied());
        put(SHAPES, &write_npy(basis.nrows(), basis.ncols(), values))?;
        put(ROWS, write_freedoms(structure.freedoms()).as_bytes())?;
    }
    put(CERTIFICATE, report.json().as_bytes())
}
