//! What a peer hands over: runs to be timed, and what came out of one.

/// One simulated second, made once more each time that it is called.
pub type Run = Box<dyn FnMut() -> Outcome>;

/// A program with one setting.
pub struct Candidate {
    pub who: &'static str,
    pub setting: String,
    pub run: Run,
}

/// What came out of a run.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// The displacements, m, row by row, one row a millisecond.
    pub displacements: Vec<f64>,
    /// Changes of a contact's state; `None` where the peer does not say.
    pub events: Option<u64>,
    /// How many of them closed a gap.
    pub touch_downs: Option<u64>,
    /// Time without set-up, s.
    pub seconds: f64,
}
