//! The rules of FMI 2.0.4 for each call (section 4.2.4, co-simulation), the further promises of this FMU, and the life
//! of an instance by both. Nothing here uses the library.

use std::collections::BTreeMap;

/// State of an instance. The poisoned state cannot be reached from outside, since no call panics.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Phase {
    Instantiated,
    Initialization,
    StepComplete,
    Terminated,
    Error,
}

pub const PHASES: [Phase; 5] = [
    Phase::Instantiated,
    Phase::Initialization,
    Phase::StepComplete,
    Phase::Terminated,
    Phase::Error,
];

pub const OK: i32 = 0;
pub const WARNING: i32 = 1;
pub const DISCARD: i32 = 2;
pub const ERROR: i32 = 3;

/// `x`: the standard allows it. `-`: it does not. `h`: it does not, and hosts do it: a warning, or an error where the
/// instance is strict. In brackets what a call is about, which has to be allowed besides.
const TABLE: &str = "
                                   instantiated  initialization  step-complete  terminated  error
    fmi2SetDebugLogging                 x              x               x             x        x
    (unknown-category)                  h              h               h             h        h
    fmi2SetupExperiment                 x              -               -             -        -
    fmi2EnterInitializationMode         x              -               -             -        -
    (without-experiment)                h              -               -             -        -
    fmi2ExitInitializationMode          -              x               -             -        -
    fmi2Terminate                       -              -               x             -        -
    fmi2Reset                           x              x               x             x        x
    fmi2GetReal                         h              x               x             x        x
    fmi2GetInteger                      h              x               x             x        x
    fmi2GetBoolean                      h              x               x             x        x
    fmi2GetString                       h              x               x             x        x
    fmi2SetReal                         x              x               x             -        -
    fmi2SetInteger                      x              x               x             -        -
    fmi2SetBoolean                      x              x               x             -        -
    fmi2SetString                       x              x               x             -        -
    (input)                             h              x               x             -        -
    (tunable)                           x              x               x             -        -
    (fixed)                             x              x               -             -        -
    (output)                            -              -               -             -        -
    fmi2GetFMUstate                     x              x               x             x        x
    fmi2SetFMUstate                     x              x               x             x        x
    fmi2FreeFMUstate                    x              x               x             x        x
    fmi2SerializedFMUstateSize          x              x               x             x        x
    fmi2SerializeFMUstate               x              x               x             x        x
    fmi2DeSerializeFMUstate             x              x               x             x        x
    fmi2GetDirectionalDerivative        -              x               x             x        x
    fmi2SetRealInputDerivatives         h              x               x             -        -
    fmi2GetRealOutputDerivatives        -              -               x             x        x
    fmi2DoStep                          -              -               x             -        -
    (length-zero)                       -              -               h             -        -
    fmi2CancelStep                      -              -               -             -        -
    fmi2GetStatus                       h              h               x             x        h
    fmi2GetRealStatus                   h              h               x             x        h
    fmi2GetIntegerStatus                h              h               x             x        h
    fmi2GetBooleanStatus                h              h               x             x        h
    fmi2GetStringStatus                 h              h               x             x        h
";

/// Group in which the FMU counts its warnings: one of a kind is reported once.
fn kind(row: &str) -> &str {
    match row {
        "fmi2GetReal" | "fmi2GetInteger" | "fmi2GetBoolean" | "fmi2GetString" => "reads",
        _ if row.ends_with("Status") => "status",
        _ => row,
    }
}

/// The table, read.
pub struct Standard(Vec<(&'static str, [char; PHASES.len()])>);

impl Standard {
    pub fn read() -> Self {
        let lines = TABLE.lines().filter(|line| !line.trim().is_empty()).skip(1);
        let rows = lines.map(|line| {
            let mut words = line.split_whitespace();
            let name = words.next().expect("a row has a name");
            let entry = |word: &str| word.chars().next().expect("it is not empty");
            let entries: Vec<char> = words.map(entry).collect();
            (name, entries.try_into().expect("one entry a phase"))
        });
        Self(rows.collect())
    }

    fn entry(&self, row: &str, phase: Phase) -> char {
        let found = self.0.iter().find(|(name, _)| *name == row);
        found.unwrap_or_else(|| panic!("no row {row}")).1[phase as usize]
    }

    pub fn rows(&self) -> impl Iterator<Item = &'static str> {
        self.0.iter().map(|(name, _)| *name)
    }
}

/// Validity of the arguments of a call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fit {
    Good,
    /// Not usable in any phase.
    Bad,
    /// A question that has no answer.
    NoAnswer,
}

/// State of an instance that follows from the calls made on it.
#[derive(Clone, Debug)]
pub struct Life {
    pub phase: Phase,
    pub strict: bool,
    pub is_set_up: bool,
    /// Values of parameters and inputs by value reference; those of outputs have no meaning.
    pub values: Vec<f64>,
    /// Rates at which inputs will change over the next step, per second, by value reference.
    pub rates: BTreeMap<u32, f64>,
    pub start: f64,
    /// Time until which all steps succeeded, s.
    pub time: f64,
    pub stop: Option<f64>,
    /// `true` if there is a logger; `warns` is `true` if it gets warnings.
    pub has_logger: bool,
    pub warns: bool,
    told: Vec<&'static str>,
}

/// Expected result of a call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Expected {
    pub status: i32,
    pub errors: usize,
    pub warnings: usize,
}

impl Life {
    pub fn new(values: Vec<f64>, has_logger: bool, warns: bool) -> Self {
        Self {
            phase: Phase::Instantiated,
            strict: false,
            is_set_up: false,
            values,
            rates: BTreeMap::new(),
            start: 0.0,
            time: 0.0,
            stop: None,
            has_logger,
            warns,
            told: Vec::new(),
        }
    }

    /// Expected result of a call with these rows of the table; `None` for no instance.
    pub fn expect(&self, standard: &Standard, rows: &[&str], fit: Fit) -> Expected {
        let entries = || rows.iter().map(|row| standard.entry(row, self.phase));
        let is_habit = entries().any(|entry| entry == 'h');
        let refused = entries().any(|entry| entry == '-') || is_habit && self.strict;
        let status = match fit {
            _ if refused => ERROR,
            Fit::Bad => ERROR,
            Fit::NoAnswer => DISCARD,
            Fit::Good if is_habit => WARNING,
            Fit::Good => OK,
        };
        let is_told = |row: &&&str| self.told.contains(&kind(row));
        let habits = || rows.iter().filter(|row| standard.entry(row, self.phase) == 'h');
        let is_heard = self.has_logger && self.warns && !self.strict;
        Expected {
            status,
            errors: usize::from(status == ERROR && self.has_logger),
            warnings: if is_heard { habits().filter(|row| !is_told(row)).count() } else { 0 },
        }
    }

    /// Takes note of what was told of the habits in these rows.
    pub fn note(&mut self, standard: &Standard, rows: &[&'static str]) {
        let phase = self.phase;
        self.told.extend(
            rows.iter().filter(|row| standard.entry(row, phase) == 'h').map(|row| kind(row)),
        );
    }

    pub fn reset(&mut self, values: Vec<f64>) {
        *self = Self::new(values, self.has_logger, self.warns);
    }

    /// Goes back to a saved life; who listens stays as it is.
    pub fn restore(&mut self, saved: &Self) {
        let Self { has_logger, warns, told, .. } = self.clone();
        *self = Self { has_logger, warns, told, ..saved.clone() };
    }
}
