//! Root loci: the modes of a contact state followed while a parameter changes.
//!
//! The followed quantities are the eigenvalues σ of M̃⁻¹ K̃, whose number never changes; each has one
//! eigenvalue λ with Im λ ≥ 0, or two real ones. Real σ may cross (symmetric structures) or merge
//! into a pair; the merging is exact, damped or not, because C̃ = α M̃ + β K̃ has the same
//! eigenvectors. With single dampers there are no such σ, and modes come near each other instead of
//! merging. Parts of a problem that do not couple, as the waves around a ring of equal modules,
//! are followed one by one: their roots cross without a trace.
//!
//! | file | what it does |
//! | --- | --- |
//! | `follow` | tells roots apart from value to value |
//! | `narrow` | finds values between two others where modes have merged, or grow, in a narrow range |
//! | `rounding` | tells growth from rounding |
//! | `events` | locates where they merge, come nearest and begin to grow |

mod events;
mod follow;
mod narrow;
mod rounding;

use crate::stability::Linearised;
use amontons::Error;
use amontons::contact::ContactState;
use amontons::model::{LinearModel, LumpedModel};
use amontons::stability::Spectrum;
use amontons::stability::reduced_problem::quadratic_roots;
use amontons::stability::symmetry::{SymmetrySector, all_stiffness_eigenvalues};
use nalgebra::Complex;
use std::cmp::Ordering;
use std::f64::consts::TAU;

use follow::{FollowedRoots, Watched, follow};
pub(crate) use narrow::{Between, in_branches};
pub use rounding::{is_growing, is_neutral};

/// One eigenvalue of a contact state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Root {
    /// σ, 1/s².
    pub sigma: Complex<f64>,
    /// λ, 1/s: the one of σ's two with the larger imaginary or, if both are real, real part.
    pub lambda: Complex<f64>,
}

impl Root {
    /// `true` if Re λ > 0. With single dampers that may be rounding: [`Locus::grows`] knows.
    pub(super) fn grows(self) -> bool {
        self.lambda.re > 0.0
    }

    fn is_real(self) -> bool {
        self.sigma.im == 0.0
    }
}

/// The quantity that is followed of a contact state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Followable {
    /// The eigenvalues σ of a part that does not couple with the others.
    Stiffness(SymmetrySector),
    /// All modes at once, because some model has damping that couples them. Where the damping vanishes at one value of
    /// the parameter, as that of friction does where it ceases to fall, what stands for σ must stay the same.
    Damped,
}

/// All roots of the followed quantity of a contact state, by σ.
///
/// # Errors
/// Returns an error if the state cannot be analysed.
fn roots(
    model: LinearModel<'_>,
    states: &[ContactState],
    what: Followable,
) -> Result<Vec<Root>, Error> {
    let Followable::Stiffness(part) = what else { return damped_roots(model, states) };
    let sigmas = part.stiffness_eigenvalues(model, states)?;
    let mut roots: Vec<Root> =
        sigmas.into_iter().map(|sigma| rayleigh_root(model.model(), sigma)).collect();
    roots.sort_by(by_number);
    Ok(roots)
}

/// All modes of a contact state.
///
/// # Errors
/// Returns an error if the state cannot be analysed.
pub(super) fn all_roots(
    model: LinearModel<'_>,
    states: &[ContactState],
) -> Result<Vec<Root>, Error> {
    if model.has_single_damping_in(states) {
        return damped_roots(model, states);
    }
    let sigmas = all_stiffness_eigenvalues(model, states)?;
    Ok(sigmas.into_iter().map(|sigma| rayleigh_root(model.model(), sigma)).collect())
}

fn rayleigh_root(model: &LumpedModel, sigma: Complex<f64>) -> Root {
    Root { sigma, lambda: upper(quadratic_roots(model, sigma)) }
}

/// With single dampers: what stands for σ is made of the product and the sum of a mode's two λ, which
/// are smooth where a mode ceases to oscillate.
fn damped_roots(model: LinearModel<'_>, states: &[ContactState]) -> Result<Vec<Root>, Error> {
    let root = |[a, b]: [Complex<f64>; 2]| {
        let product = (a * b).re;
        let sigma = Complex::new(product, (a + b).re * product.abs().sqrt());
        Root { sigma, lambda: upper([a, b]) }
    };
    let Spectrum { oscillating, real } = Spectrum::of(model, states)?;
    let pairs = oscillating.into_iter().map(|value| root([value, value.conj()]));
    // A mode that does not oscillate has a fast λ and a slow one, of which the slow one may grow: no pair takes both from one half.
    let half = real.len() / 2;
    let (fast, slow) = (real[..half].iter(), real[half..].iter().rev());
    let real = fast.zip(slow).map(|(&a, &b)| root([a.into(), b.into()]));
    let mut roots: Vec<Root> = pairs.chain(real).collect();
    roots.sort_by(by_number);
    Ok(roots)
}

/// The one of a mode's two λ with the larger imaginary or, if both are real, real part.
fn upper([a, b]: [Complex<f64>; 2]) -> Complex<f64> {
    if (a.im, a.re) >= (b.im, b.re) { a } else { b }
}

/// The order in which modes are numbered.
fn by_number(a: &Root, b: &Root) -> Ordering {
    let by_part = a.sigma.re.total_cmp(&b.sigma.re);
    let by_size = || a.sigma.im.abs().total_cmp(&b.sigma.im.abs());
    by_part.then_with(by_size).then_with(|| order_of_merged(a, b))
}

/// Order of a pair that has merged: first the mode with the lower frequency or, without damping, where both have the
/// same, the one that decays. So the higher of them is the one that grows, as the paper numbers them.
fn order_of_merged(a: &Root, b: &Root) -> Ordering {
    let apart = (a.lambda.im - b.lambda.im).abs() > 1e-12 * a.lambda.norm();
    let frequency = a.lambda.im.total_cmp(&b.lambda.im);
    if apart { frequency } else { a.lambda.re.total_cmp(&b.lambda.re) }
}

/// The modes of a contact state over the values of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Locus {
    /// The values of the parameter, ascending.
    pub values: Vec<f64>,
    /// One branch for each mode, numbered by σ at the first value; one root for each value of the parameter.
    pub branches: Vec<Vec<Root>>,
    /// Values at which two modes merge or part.
    pub coalescences: Vec<Coalescence>,
    /// Values at which a mode begins or ceases to grow.
    pub crossings: Vec<Crossing>,
    /// Values at which one mode that grows and oscillates becomes two that grow without oscillating, or the other way round: the
    /// branch of the second one changes the sign of its growth rate, but growth neither begins nor ceases.
    pub splits: Vec<Crossing>,
    /// Values at which two modes that single dampers keep from merging come nearest to each other.
    pub approaches: Vec<Approach>,
    /// Values near which modes could not be told apart: there they may have changed their numbers.
    pub undecided: Vec<f64>,
    /// `true` where damping other than α M + β K couples the modes: they come near each other and do not merge.
    pub is_damped: bool,
    /// Bounds of the frequencies of the modes that were followed, Hz. Modes outside of them may have changed places.
    pub frequencies: [f64; 2],
}

impl Locus {
    /// The followed branches with their numbers, from 0: those with a root between the bounds of the frequencies.
    pub fn followed(&self) -> impl Iterator<Item = (usize, &[Root])> {
        let branches = self.branches.iter().map(Vec::as_slice).enumerate();
        branches.filter(|(_, branch)| branch.iter().any(|root| self.contains(*root)))
    }

    /// The changes of the sign of the growth rate of all branches, ascending: crossings, and those at splits.
    pub fn turns(&self) -> impl Iterator<Item = &Crossing> {
        let mut all: Vec<&Crossing> = self.crossings.iter().chain(&self.splits).collect();
        all.sort_by(|a, b| a.value.total_cmp(&b.value));
        all.into_iter()
    }

    /// `true` if a branch grows at the first value, by more than rounding.
    #[must_use]
    pub fn grows_at_first(&self, mode: usize) -> bool {
        match self.turns().find(|turn| turn.mode == mode) {
            Some(turn) => !turn.becomes_unstable,
            None => self.grows(self.branches[mode][0]),
        }
    }

    /// `true` if a root grows, by more than rounding.
    #[must_use]
    pub fn grows(&self, root: Root) -> bool {
        if self.is_damped { is_growing(root.lambda) } else { root.grows() }
    }

    /// `true` if the frequency of a root lies between the bounds.
    #[must_use]
    pub fn contains(&self, root: Root) -> bool {
        let [from, to] = self.frequencies;
        (from..=to).contains(&(root.lambda.im / TAU))
    }
}

/// Two modes with one eigenvalue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coalescence {
    /// The value of the parameter.
    pub value: f64,
    /// The two modes, from 0.
    pub modes: [usize; 2],
    /// Their common frequency, Hz.
    pub frequency_hz: f64,
    /// `true` if they merge as the parameter grows; `false` if they part.
    pub merge: bool,
}

/// Two modes that come near each other without merging.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approach {
    /// The value of the parameter.
    pub value: f64,
    /// The two modes, from 0.
    pub modes: [usize; 2],
    /// |λ_i − λ_j| / 2π, Hz.
    pub distance_hz: f64,
    /// The mean of their frequencies, Hz.
    pub frequency_hz: f64,
}

/// A mode whose growth rate changes its sign.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// The value of the parameter: with Re λ ≤ 0 to its stable side.
    pub value: f64,
    /// The mode, from 0.
    pub mode: usize,
    /// Its frequency where it grows, Hz; zero where it diverges.
    pub frequency_hz: f64,
    /// `true` if the mode grows above the value; `false` if it grows below.
    pub becomes_unstable: bool,
}

/// The model that belongs to a value of the parameter.
pub type ModelAt<'a> = dyn Fn(f64) -> Result<Linearised, Error> + Sync + 'a;

/// All frequencies, Hz.
pub const ALL_FREQUENCIES: [f64; 2] = [0.0, f64::INFINITY];

/// Follows all modes of a contact state over ascending values of a parameter, of which there are at
/// least two, in steps of at most a two-hundredth of the range. Events are those of modes with a
/// frequency between two bounds (Hz); other modes may change places with each other. Between two values events are sought where
/// two modes come near each other, or σ near zero, or a growth rate near zero; two that show at no neighbouring value in one
/// of these ways are missed.
///
/// `done` hears how many pieces of the work are done, and of how many.
///
/// # Errors
/// Returns an error if `model_at` fails, or if a state cannot be analysed.
pub fn locus(
    model_at: &ModelAt<'_>,
    states: &[ContactState],
    values: &[f64],
    frequencies: [f64; 2],
    done: &dyn Fn(usize, usize),
) -> Result<Locus, Error> {
    let [first, .., last] = values else {
        return Err(Error::analysis("a root locus needs at least two values of its parameter"));
    };
    let ends = [*first, 0.5 * (first + last), *last].map(model_at);
    let ends: Vec<Linearised> = ends.into_iter().collect::<Result<_, Error>>()?;
    let ends: Vec<LinearModel<'_>> =
        ends.iter().map(Linearised::linear).collect::<Result<_, Error>>()?;
    let is_damped = ends.iter().any(|model| model.has_single_damping_in(states));
    let parts: Vec<(Followable, usize)> = if is_damped {
        vec![(Followable::Damped, 1)]
    } else {
        let parts = SymmetrySector::all(ends, states);
        parts.into_iter().map(|part| (Followable::Stiffness(part), part.copies())).collect()
    };
    let watched = Watched { frequencies: frequencies.map(|bound| TAU * bound), merge: !is_damped };
    // The events of a part are one more piece of work.
    let all = parts.len() * (values.len() + 1);
    let count = std::cell::Cell::new(0);
    let mut followed = Vec::new();
    for &(part, copies) in &parts {
        let evaluate = |value: f64| roots(model_at(value)?.linear()?, states, part);
        let one_done = || {
            count.set(count.get() + 1);
            done(count.get(), all);
        };
        followed.push((follow(&evaluate, values, watched, &one_done)?, copies));
    }
    Ok(Locus { is_damped, frequencies, ..together(values, followed) })
}

/// Joins parts, each with its multiplicity, into one locus, and numbers its modes.
fn together(values: &[f64], parts: Vec<(FollowedRoots, usize)>) -> Locus {
    let mut branches = Vec::new();
    let (mut coalescences, mut crossings, mut splits) = (Vec::new(), Vec::new(), Vec::new());
    let (mut approaches, mut undecided) = (Vec::new(), Vec::new());
    for (part, copies) in parts {
        undecided.extend(part.undecided);
        for _ in 0..copies {
            let place = |mode: usize| branches.len() + mode;
            coalescences.extend(
                part.coalescences.iter().map(|c| Coalescence { modes: c.modes.map(place), ..*c }),
            );
            approaches.extend(
                part.approaches.iter().map(|a| Approach { modes: a.modes.map(place), ..*a }),
            );
            crossings.extend(part.crossings.iter().map(|c| Crossing { mode: place(c.mode), ..*c }));
            splits.extend(part.splits.iter().map(|c| Crossing { mode: place(c.mode), ..*c }));
            branches.extend(part.branches.iter().cloned());
        }
    }
    let mut order: Vec<usize> = (0..branches.len()).collect();
    order.sort_by(|&a: &usize, &b: &usize| by_number(&branches[a][0], &branches[b][0]));
    let mut number = vec![0; order.len()];
    for (new, &old) in order.iter().enumerate() {
        number[old] = new;
    }
    for event in &mut coalescences {
        event.modes = event.modes.map(|mode| number[mode]);
        event.modes.sort_unstable();
    }
    for event in &mut approaches {
        event.modes = event.modes.map(|mode| number[mode]);
        event.modes.sort_unstable();
    }
    for event in crossings.iter_mut().chain(&mut splits) {
        event.mode = number[event.mode];
    }
    coalescences.sort_by(|a, b| a.value.total_cmp(&b.value).then(a.modes.cmp(&b.modes)));
    for events in [&mut crossings, &mut splits] {
        events.sort_by(|a, b| a.value.total_cmp(&b.value).then(a.mode.cmp(&b.mode)));
    }
    approaches.sort_by(|a, b| a.value.total_cmp(&b.value).then(a.modes.cmp(&b.modes)));
    undecided.sort_by(f64::total_cmp);
    let branches = order.iter().map(|&old| branches[old].clone()).collect();
    Locus {
        values: values.to_vec(),
        branches,
        coalescences,
        crossings,
        splits,
        approaches,
        undecided,
        is_damped: false,
        frequencies: ALL_FREQUENCIES,
    }
}

#[cfg(test)]
mod tests;
