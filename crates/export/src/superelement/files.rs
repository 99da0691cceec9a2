//! The matrices of a superelement's files, their rows numbered alike.

use amontons::scene::{Freedom, MAX_FREEDOMS, Problem, SuperelementFiles};
use amontons_matrices::{Location, Matrix, align, name_rows, open, read_freedoms};
use std::path::Path;

/// The files that `amontons reduce` writes into its folder.
const REDUCED: [&str; 3] = ["stiffness.mtx", "mass.mtx", "freedoms.csv"];
/// The keys of matrices, the first two of which a superelement needs.
const KEYS: [&str; 5] = ["stiffness", "mass", "damping", "gyroscopic", "circulatory"];

/// The matrices in the units of their files, n × n by rows.
pub(super) struct Parts {
    pub(super) freedoms: Vec<Freedom>,
    pub(super) mass: Vec<f64>,
    pub(super) stiffness: Vec<f64>,
    pub(super) damping: Option<Vec<f64>>,
    pub(super) gyroscopic: Option<Vec<f64>>,
    pub(super) circulatory: Option<Vec<f64>>,
}

/// A matrix with its key and the name that the scene gives its file.
struct Read {
    key: &'static str,
    name: String,
    matrix: Matrix,
}

/// Reads all matrices of a superelement whose files lie in or below the folder of its scene.
///
/// # Errors
/// Returns all files that cannot be read, or the first reason for which they do not belong together.
pub(super) fn read(folder: &Path, files: &SuperelementFiles) -> Result<Parts, Vec<Problem>> {
    let SuperelementFiles { stiffness, mass, freedoms, damping, .. } = files;
    let of_folder = |name: &str| {
        files.folder.as_ref().map(|own| format!("{}/{name}", own.trim_end_matches('/')))
    };
    let [own_stiffness, own_mass, own_freedoms] = REDUCED.map(of_folder);
    let names = [
        own_stiffness.or_else(|| stiffness.clone()),
        own_mass.or_else(|| mass.clone()),
        damping.clone(),
        files.gyroscopic.clone(),
        files.circulatory.clone(),
    ];
    let mut all = Vec::new();
    let mut problems = Vec::new();
    for ((key, name), place) in KEYS.into_iter().zip(names).zip(0..) {
        // The folder is the key of what lies in it.
        let key = if files.folder.is_some() && place < 2 { "folder" } else { key };
        match name.map(|name| (read_matrix(folder, &name), name)) {
            Some((Ok(matrix), name)) => all.push(Read { key, name, matrix }),
            Some((Err(fault), name)) => problems.push(Problem::new(key, fault).of(name)),
            None if place < 2 => problems.push(
                Problem::new(key, "is missing")
                    .help("give files of both `stiffness` and `mass`, or the `folder` of both"),
            ),
            None => {}
        }
    }
    if !problems.is_empty() {
        return Err(problems);
    }
    if let Some(problem) = not_reduced(&all) {
        return Err(vec![problem]);
    }
    let given = freedoms.clone();
    name_all(folder, given.as_ref().or(own_freedoms.as_ref()), given.is_some(), &mut all)
        .map_err(|problem| vec![problem])?;
    let sizes = |read: &Read| (read.matrix.rows, read.matrix.columns);
    let n = all[0].matrix.rows;
    if let Some(other) = all.iter().find(|read| sizes(read) != (n, n)) {
        let (rows, columns) = sizes(other);
        let message =
            format!("has {rows} rows and {columns} columns, but the stiffness matrix {n} rows");
        let help = "all matrices of a superelement are square and of one size";
        return Err(vec![Problem::new(other.key, message).of(&other.name).help(help)]);
    }
    if n > MAX_FREEDOMS {
        let message =
            format!("has {n} degrees of freedom, but a superelement has at most {MAX_FREEDOMS}");
        let help = "reduce the structure first, with `amontons reduce`";
        return Err(vec![Problem::new(all[0].key, message).of(&all[0].name).help(help)]);
    }
    let named = all[0].matrix.freedoms.clone().unwrap_or_default();
    let freedoms =
        named.into_iter().map(|one| Freedom { node: one.node, direction: one.direction });
    let mut found = [damping.is_some(), files.gyroscopic.is_some(), files.circulatory.is_some()];
    let mut rest = all.iter().map(|read| dense(&read.matrix));
    let mut next = || rest.next().unwrap_or_default();
    let (stiffness, mass) = (next(), next());
    let [damping, gyroscopic, circulatory] =
        found.each_mut().map(|is_there| is_there.then(&mut next));
    Ok(Parts { freedoms: freedoms.collect(), mass, stiffness, damping, gyroscopic, circulatory })
}

fn read_matrix(folder: &Path, name: &str) -> Result<Matrix, String> {
    let Ok(Location { path, name }) = name.parse::<Location>();
    let location = Location { path: folder.join(path), name };
    open(&location).map_err(|error| message(&error))
}

/// The message of an error without its path, which the problem has as its value.
fn message(error: &amontons_matrices::Error) -> String {
    use amontons_matrices::Place::{Line, Offset, Whole};
    let fault = error.fault();
    match fault.place {
        Line(line) => format!("line {line}: {}", fault.message),
        Offset(offset) => format!("byte {offset}: {}", fault.message),
        Whole => fault.message.clone(),
    }
}

/// Gives the rows of all matrices names and one order: by their files, or by a table for those that have none.
fn name_all(
    folder: &Path,
    table: Option<&String>,
    is_given: bool,
    all: &mut [Read],
) -> Result<(), Problem> {
    let key = if is_given { "freedoms" } else { "folder" };
    let mut unnamed = all.iter_mut().filter(|read| read.matrix.freedoms.is_none()).peekable();
    match (table, unnamed.peek()) {
        (Some(name), None) if is_given => {
            return Err(Problem::new(key, "the files of the matrices name their rows themselves")
                .of(name)
                .help("leave out `freedoms`"));
        }
        (None, Some(Read { name, .. })) => {
            let message =
                format!("needs `freedoms`, since {name} does not name the nodes of its rows");
            return Err(Problem::new("", message).help(
                "give a CSV file with the columns node,direction and one line for each row",
            ));
        }
        (Some(name), Some(_)) => {
            let path = folder.join(name);
            let fault = |error| Problem::new(key, message(&error)).of(name);
            let freedoms = read_freedoms(&path).map_err(fault)?;
            for read in unnamed {
                name_rows(&mut read.matrix, &freedoms, &path)
                    .map_err(|error| Problem::new(read.key, message(&error)).of(&read.name))?;
            }
        }
        (_, None) => {}
    }
    let files: Vec<String> = all.iter().map(|read| read.name.clone()).collect();
    let mut matrices: Vec<&mut Matrix> = all.iter_mut().map(|read| &mut read.matrix).collect();
    align(&mut matrices, &files).map_err(|message| Problem::new("", message))
}

/// Reports a further matrix with more rows than stiffness and mass, the first two, have: that of the structure before its reduction.
fn not_reduced(all: &[Read]) -> Option<Problem> {
    let [stiffness, mass, others @ ..] = all else { return None };
    let most = stiffness.matrix.rows.max(mass.matrix.rows);
    let other = others.iter().find(|read| read.matrix.rows > most)?;
    let Read { key, name, matrix } = other;
    let message = format!(
        "has {} rows, but {} has {}, and {} has {}: it is of the structure before its reduction",
        matrix.rows, stiffness.name, stiffness.matrix.rows, mass.name, mass.matrix.rows
    );
    let help = format!(
        "reduce it together with them by `amontons reduce --also {key}={name}`, and give the file {key}.mtx of the results"
    );
    Some(Problem::new(*key, message).of(name).help(help))
}

fn dense(matrix: &Matrix) -> Vec<f64> {
    let mut values = vec![0.0; matrix.rows * matrix.columns];
    for entry in &matrix.entries {
        values[entry.row * matrix.columns + entry.column] = entry.value;
    }
    values
}
