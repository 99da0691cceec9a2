//! `[[superelement]]` of a scene file.

use super::source::Folder;
use super::{Problem, Rule, Superelement, SuperelementFiles, UnitFactors};
use serde::Deserialize;

/// A structure as matrices, such as a finite-element model that has been reduced.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(extend("oneOf" = [
    { "required": ["folder"] },
    { "required": ["stiffness", "mass"] },
    { "required": ["file"] },
])))]
#[serde(deny_unknown_fields)]
pub(super) struct SuperelementTable {
    /// Name of the superelement: a letter, then letters, digits and _.
    name: String,
    /// Folder with `stiffness.mtx`, `mass.mtx` and `freedoms.csv`, as `amontons reduce` writes it.
    folder: Option<String>,
    /// File of the stiffness matrix, symmetric.
    stiffness: Option<String>,
    /// File of the mass matrix, symmetric and positive definite.
    mass: Option<String>,
    /// CSV file with the columns `node` and `direction`, one line for each row of the matrices.
    freedoms: Option<String>,
    /// File of a damping matrix.
    damping: Option<String>,
    /// File of a gyroscopic matrix, which is added to the damping.
    gyroscopic: Option<String>,
    /// File of a circulatory matrix, which is added to the stiffness.
    circulatory: Option<String>,
    /// Mass-proportional damping coefficient α of the superelement, 1/s.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::DAMPING.bounds()))]
    alpha: Option<f64>,
    /// Stiffness-proportional damping coefficient β of the superelement, s.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::DAMPING.bounds()))]
    beta: Option<f64>,
    /// Damping ratio of all modes of the free superelement, or a list with one for each of the first modes.
    damping_ratio: Option<DampingRatio>,
    /// Units of the matrix files: a system by name, or factors to m, kg and s; SI units by default.
    units: Option<Units>,
    /// Packed file NAME.superelement beside the scene, which holds all of this.
    file: Option<String>,
}

/// Damping ratio of all modes, or of each.
#[derive(Clone, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(untagged)]
enum DampingRatio {
    /// One for all modes.
    All(f64),
    /// One for each of the first modes, by frequency.
    Each(Vec<f64>),
}

/// Units of matrix files.
#[derive(Clone, Copy, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(untagged)]
enum Units {
    /// A system of units by name.
    Named(UnitSystem),
    /// Factors to SI units.
    Factors(Factors),
}

/// A consistent system of units: force, length, mass and time.
#[derive(Clone, Copy, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
enum UnitSystem {
    /// SI units: newton, metre, kilogram, second.
    #[serde(rename = "N-m-kg-s")]
    Si,
    /// Newton, millimetre, tonne, second.
    #[serde(rename = "N-mm-t-s")]
    MillimetreTonne,
    /// Millinewton, millimetre, kilogram, second.
    #[serde(rename = "mN-mm-kg-s")]
    MillimetreKilogram,
    /// Kilonewton, millimetre, kilogram, millisecond.
    #[serde(rename = "kN-mm-kg-ms")]
    Millisecond,
    /// Pound-force, inch, lbf s²/in, second.
    #[serde(rename = "lbf-in-lbf.s2/in-s")]
    Inch,
}

/// Units as factors to SI units.
#[derive(Clone, Copy, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
struct Factors {
    /// The unit of length, m.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::Positive.bounds()))]
    length: f64,
    /// The unit of mass, kg.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::Positive.bounds()))]
    mass: f64,
    /// The unit of time, s.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::Positive.bounds()))]
    time: f64,
}

impl Units {
    fn factors(self) -> UnitFactors {
        let [length, mass, time] = match self {
            Self::Factors(Factors { length, mass, time }) => [length, mass, time],
            Self::Named(UnitSystem::Si) => [1.0, 1.0, 1.0],
            Self::Named(UnitSystem::MillimetreTonne) => [1e-3, 1e3, 1.0],
            Self::Named(UnitSystem::MillimetreKilogram) => [1e-3, 1.0, 1.0],
            Self::Named(UnitSystem::Millisecond) => [1e-3, 1.0, 1e-3],
            // 1 lbf = 4.4482216152605 N and 1 in = 0.0254 m exactly.
            Self::Named(UnitSystem::Inch) => [0.0254, 4.448_221_615_260_5 / 0.0254, 1.0],
        };
        UnitFactors { length, mass, time }
    }
}

impl SuperelementTable {
    /// Reports a table that does not say in one way where its matrices are.
    pub(super) fn unlike_schema(&self, place: usize) -> Option<Problem> {
        let ways = [
            self.folder.is_some(),
            self.stiffness.is_some() || self.mass.is_some(),
            self.file.is_some(),
        ];
        let is_half = self.stiffness.is_some() != self.mass.is_some();
        if ways.iter().filter(|is_given| **is_given).count() == 1 && !is_half {
            return None;
        }
        let message = "needs exactly one of `folder`, `file`, and `stiffness` with `mass`";
        Some(Problem::new(path(place), message))
    }

    /// Keys that a packed file has already taken into account.
    fn beside_packed(&self) -> Option<&'static str> {
        let given = [
            ("freedoms", self.freedoms.is_some()),
            ("damping", self.damping.is_some()),
            ("gyroscopic", self.gyroscopic.is_some()),
            ("circulatory", self.circulatory.is_some()),
            ("alpha", self.alpha.is_some()),
            ("beta", self.beta.is_some()),
            ("damping_ratio", self.damping_ratio.is_some()),
            ("units", self.units.is_some()),
        ];
        given.into_iter().find(|(_, is_given)| *is_given).map(|(key, _)| key)
    }

    fn files(&self) -> SuperelementFiles {
        SuperelementFiles {
            name: self.name.clone(),
            folder: self.folder.clone(),
            stiffness: self.stiffness.clone(),
            mass: self.mass.clone(),
            freedoms: self.freedoms.clone(),
            damping: self.damping.clone(),
            gyroscopic: self.gyroscopic.clone(),
            circulatory: self.circulatory.clone(),
            alpha: self.alpha.unwrap_or(0.0),
            beta: self.beta.unwrap_or(0.0),
            damping_ratio: match &self.damping_ratio {
                None => Vec::new(),
                Some(DampingRatio::All(ratio)) => vec![*ratio],
                Some(DampingRatio::Each(ratios)) => ratios.clone(),
            },
            units: self.units.map(Units::factors).unwrap_or_default(),
        }
    }

    /// Numbers of the table that break their rules.
    fn bad_numbers(&self, place: usize, files: &SuperelementFiles) -> Vec<Problem> {
        let UnitFactors { length, mass, time } = files.units;
        let ratios =
            files.damping_ratio.iter().map(|ratio| ("damping_ratio", *ratio, Rule::DAMPING));
        let all = [
            ("alpha", files.alpha, Rule::DAMPING),
            ("beta", files.beta, Rule::DAMPING),
            ("units.length", length, Rule::Positive),
            ("units.mass", mass, Rule::Positive),
            ("units.time", time, Rule::Positive),
        ];
        let broken = |(key, value, rule): (&str, f64, Rule)| {
            let wish = rule.broken_by(value)?;
            Some(Problem::new(format!("{}.{key}", path(place)), wish).of(value))
        };
        all.into_iter().chain(ratios).filter_map(broken).collect()
    }

    fn read(&self, place: usize, folder: &mut Folder<'_>) -> Result<Superelement, Vec<Problem>> {
        let files = self.files();
        let problems = self.bad_numbers(place, &files);
        if !problems.is_empty() {
            return Err(problems);
        }
        let matrices = match &self.file {
            Some(file) => {
                if let Some(key) = self.beside_packed() {
                    let message =
                        format!("belongs to matrix files, but {} has a packed `file`", self.name);
                    let help = format!("leave `{key}` out: the packed file takes it into account");
                    return Err(vec![
                        Problem::new(format!("{}.{key}", path(place)), message).help(help),
                    ]);
                }
                folder.packed(file).map_err(|message| {
                    vec![
                        Problem::new(format!("{}.file", path(place)), message)
                            .of(format!("{file:?}")),
                    ]
                })?
            }
            None => folder.matrices(&files).map_err(|problems| {
                let placed = |problem: Problem| match &*problem.path {
                    "" => Problem { path: path(place), ..problem },
                    key => Problem { path: format!("{}.{key}", path(place)), ..problem },
                };
                problems.into_iter().map(placed).collect::<Vec<_>>()
            })?,
        };
        let overdamped = files.damping_ratio.iter().copied().filter(|ratio| *ratio > 1.0);
        let overdamped = overdamped.max_by(f64::total_cmp);
        Ok(Superelement { overdamped, ..Superelement::new(&*self.name, matrices) })
    }
}

fn path(place: usize) -> String {
    format!("superelement[{}]", place + 1)
}

/// Reads all superelements.
///
/// # Errors
/// Returns all that is wrong with any of them.
pub(super) fn superelements(
    tables: &[SuperelementTable],
    folder: &mut Folder<'_>,
) -> Result<Vec<Superelement>, Vec<Problem>> {
    let (mut superelements, mut problems) = (Vec::new(), Vec::new());
    for (place, table) in tables.iter().enumerate() {
        match table.read(place, folder) {
            Ok(superelement) => superelements.push(superelement),
            Err(found) => problems.extend(found),
        }
    }
    if problems.is_empty() { Ok(superelements) } else { Err(problems) }
}
