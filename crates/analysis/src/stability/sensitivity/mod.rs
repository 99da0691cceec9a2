//! Derivatives of growth rates, frequencies and critical friction coefficients by the parameters of a scene.
//!
//! | file | what it holds |
//! | --- | --- |
//! | `change` | the derivative of a scene's model by a parameter |
//! | `bordered` | the eigenvalue problem with the contact forces as unknowns, and its derivatives |
//! | `nullspace` | vectors that a nearly singular matrix turns to zero |
//! | `shapes` | eigenvalues with their shapes, left and right; which of them are equal |
//! | `merging` | where two eigenvalues merge |
//! | `critical` | derivatives of critical friction coefficients |
//!
//! With right and left shapes z and y of a simple eigenvalue, Q(λ) z = 0 and yᵀ Q(λ) = 0, and ∂λ/∂p = −yᵀ (∂Q/∂p) z /
//! yᵀ (∂Q/∂λ) z. Of an eigenvalue that comes several times, with shapes as columns of Z and Y, the derivatives are the
//! eigenvalues of −(Yᵀ (∂Q/∂λ) Z)⁻¹ Yᵀ (∂Q/∂p) Z (Lancaster, Numer. Math. 6, 1964, 377–387).

mod bordered;
mod change;
mod critical;
mod merging;
mod nullspace;
mod shapes;

pub use critical::{CriticalFriction, critical_at, critical_friction};

use super::parallel::collect;
use super::{Linearised, modes};
use crate::assign::FRICTION;
use amontons::Error;
use amontons::contact::ContactState;
use amontons::scene::Scene;
use amontons::simulation::{Parameters, variables, write_scene};
use bordered::{Bordered, BorderedChange, Matrix, Problem};
use change::ModelChange;
use merging::{DoublePoint, Search};
use nalgebra::{Complex, Schur};
use shapes::{Shaped, groups};
use std::f64::consts::TAU;

/// A mode whose eigenvalue merges with another one within this part of µ is near a merging.
const NEAR: f64 = 0.01;
/// Mergings are sought from estimates within this part of µ, among eigenvalues that are not further apart than this part of
/// themselves.
const SEARCHED: f64 = 0.1;
/// An imaginary part of a place below this part of µ is rounding: the eigenvalues merge exactly.
const EXACT: f64 = 1e-9;

/// A parameter on which eigenvalues depend.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Its name, as in the FMU.
    pub name: String,
    /// Its value in the scene.
    pub value: f64,
    /// Its unit; empty for a number without one.
    pub unit: &'static str,
}

/// The derivatives of a contact state's eigenvalues.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensitivities {
    /// The parameters on which eigenvalues depend, in the order of the FMU's variables.
    pub parameters: Vec<Parameter>,
    /// Names of parameters of the model on which no eigenvalue of this state depends.
    pub without_effect: Vec<String>,
    /// Names of velocities of surfaces that stand still: friction turns round there, so that there is no derivative.
    pub without_derivative: Vec<String>,
    /// Modes that oscillate, by frequency, then the others, by growth rate.
    pub modes: Vec<ModeSensitivity>,
}

/// The derivatives of one eigenvalue.
#[derive(Clone, Debug, PartialEq)]
pub struct ModeSensitivity {
    /// λ, 1/s, with Im λ ≥ 0.
    pub eigenvalue: Complex<f64>,
    /// Number of modes with this eigenvalue.
    pub copies: usize,
    /// ∂λ/∂p, 1/s per unit of the parameter, of each parameter: as many values as copies, the largest real part first.
    /// `None` where the eigenvalue has merged with another one, or belongs to a free motion, and has no derivatives.
    pub derivatives: Option<Vec<Vec<Complex<f64>>>>,
    /// The relative change of the most effective parameter that moves λ by half of the distance to the next eigenvalue, as far as
    /// derivatives tell. They may cease to hold before that.
    pub holds_within: f64,
    /// The merging with another eigenvalue, if there is one within a hundredth of µ. The derivatives then hold for much
    /// smaller changes than a hundredth of a parameter.
    pub merging: Option<Merging>,
}

/// A value of the common friction coefficient µ at which an eigenvalue merges with another one, or with its own conjugate.
#[derive(Clone, Debug, PartialEq)]
pub struct Merging {
    /// This µ; where damping keeps the two from merging, the real part of the complex µ at which they are equal.
    pub friction: f64,
    /// The distance of the complex µ to that of the scene.
    pub distance: f64,
    /// `true` if the two merge; `false` if damping keeps them apart, so that they only come near each other.
    pub is_exact: bool,
    /// `true` if the common eigenvalue is real: the mode merges with its conjugate and ceases to oscillate.
    pub is_real: bool,
    /// The common eigenvalue there, 1/s.
    pub eigenvalue: Complex<f64>,
    /// ∂µ/∂p of this µ by each parameter, the largest first: one for each copy; none for µ itself.
    pub derivatives: Vec<Vec<f64>>,
}

impl ModeSensitivity {
    /// Re λ, 1/s.
    #[must_use]
    pub fn growth_rate(&self) -> f64 {
        self.eigenvalue.re
    }

    /// Im λ / 2π, Hz.
    #[must_use]
    pub fn frequency_hz(&self) -> f64 {
        self.eigenvalue.im / TAU
    }
}

/// The derivatives of the eigenvalues with frequencies between two bounds (Hz) in a contact state by all parameters of the
/// model. The contact forces of the equilibrium, about which friction is linear, move with the parameters.
///
/// `done` hears how many modes are done, and of how many.
///
/// ```
/// use amontons_analysis::stability::{Linearised, sensitivities};
///
/// let scene = amontons::scene::builtin("set1").expect("a built-in scene").scene();
/// let here = Linearised::of(&scene);
/// let found = sensitivities(&here, &here.uniform_sliding()?, [0.0, 1e4], &|_, _| {})?;
/// let beta = found.parameters.iter().position(|it| it.name == "damping.beta").expect("a parameter");
/// // The mode that grows fastest decays with more damping.
/// let fastest = found.modes.iter().max_by(|a, b| a.growth_rate().total_cmp(&b.growth_rate()));
/// let derivatives = fastest.and_then(|mode| mode.derivatives.as_ref()).expect("a simple eigenvalue");
/// assert!(derivatives[beta][0].re < 0.0);
/// # Ok::<(), amontons::Error>(())
/// ```
///
/// # Errors
/// Returns an error if the model is not that of a scene, if the state has no modes or cannot be analysed, if contacts hold one
/// motion twice, or if the equilibrium has no derivative.
pub fn sensitivities(
    here: &Linearised,
    states: &[ContactState],
    frequencies: [f64; 2],
    done: &(dyn Fn(usize, usize) + Sync),
) -> Result<Sensitivities, Error> {
    let state = StateDerivatives::of(here, states, &|_| true)?;
    let all: Vec<Complex<f64>> =
        modes(here.linear()?, states)?.all().map(|mode| mode.eigenvalue).collect();
    if all.is_empty() {
        return Err(Error::analysis("contacts hold all motions in this state, so it has no modes"));
    }
    let [low, high] = frequencies;
    let is_chosen = |value: &Complex<f64>| (low..=high).contains(&(value.im / TAU));
    let chosen: Vec<Complex<f64>> = all.iter().copied().filter(is_chosen).collect();
    let shaped =
        state.shaped(&neighbours(&all, &chosen), &|| Ok(()), &|part, of| done(part, 2 * of))?;
    let of: Vec<&Shaped> = shaped.iter().filter(|one| is_chosen(&one.eigenvalue)).collect();
    let found = collect(of.len(), &|i| Ok(state.mode(of[i], &shaped, &all)), &|count| {
        done(of.len() + count, 2 * of.len());
    })?;
    Ok(Sensitivities {
        parameters: state.parameters,
        without_effect: state.without_effect,
        without_derivative: state.without_derivative,
        modes: found,
    })
}

/// The derivatives of some eigenvalues of a contact state by named parameters, each as the effect of a change of all parameters
/// of one group: Σ cᵢ ∂λ/∂pᵢ over the names pᵢ of the group with their factors cᵢ. One row for each eigenvalue, with one value
/// for each group; `None` where the eigenvalue has merged with another one, or belongs to a free motion.
///
/// An eigenvalue that comes several times has the mean of the derivatives of its copies: by one parameter they part, and none of
/// them has a derivative by several parameters at once.
///
/// # Errors
/// Returns the errors of [`sensitivities`] and of `may_begin`, which is asked before each eigenvalue, and an error if a parameter has no
/// derivative.
pub(crate) fn group_derivatives(
    here: &Linearised,
    states: &[ContactState],
    groups: &[Vec<(&str, f64)>],
    eigenvalues: &[Complex<f64>],
    may_begin: &(dyn Fn() -> Result<(), Error> + Sync),
) -> Result<Vec<Option<Vec<Complex<f64>>>>, Error> {
    let of = |name: &str| {
        let of_group =
            |group: &Vec<(&str, f64)>| group.iter().find(|it| it.0 == name).map(|it| it.1);
        groups.iter().enumerate().find_map(|(place, group)| Some((place, of_group(group)?)))
    };
    let state = StateDerivatives::of(here, states, &|name| of(name).is_some())?;
    if let Some(name) = state.without_derivative.first() {
        return Err(Error::argument(format!(
            "there is no derivative by {name}: the surface stands still, and friction turns round there"
        )));
    }
    let mut changes = vec![BorderedChange::default(); groups.len()];
    for (parameter, change) in state.parameters.iter().zip(&state.changes) {
        if let Some((place, factor)) = of(&parameter.name) {
            changes[place].add(factor, change);
        }
    }
    let shaped = state.shaped(eigenvalues, may_begin, &|_, _| {})?;
    let derivatives = |one: &Shaped| -> Option<Vec<Complex<f64>>> {
        changes.iter().map(|change| one.is_regular().then(|| one.mean_derivative(change))).collect()
    };
    let apart = |one: &Shaped, value: Complex<f64>| (one.eigenvalue - value).norm();
    let nearest = |value: Complex<f64>| {
        shaped.iter().min_by(|a, b| apart(a, value).total_cmp(&apart(b, value)))
    };
    Ok(eigenvalues.iter().map(|value| nearest(*value).and_then(derivatives)).collect())
}

/// The eigenvalues that may merge with some that are chosen, and these themselves.
fn neighbours(all: &[Complex<f64>], chosen: &[Complex<f64>]) -> Vec<Complex<f64>> {
    let is_near = |value: &&Complex<f64>| {
        chosen.iter().any(|one| (*one - **value).norm() <= SEARCHED * one.norm())
    };
    all.iter().filter(is_near).copied().collect()
}

/// The matrices of a contact state with their derivatives.
struct StateDerivatives<'a> {
    here: &'a Linearised,
    states: &'a [ContactState],
    matrices: Bordered,
    parameters: Vec<Parameter>,
    /// One for each parameter.
    changes: Vec<BorderedChange>,
    without_effect: Vec<String>,
    without_derivative: Vec<String>,
    /// The place of the common µ among the parameters.
    friction: Option<usize>,
}

impl<'a> StateDerivatives<'a> {
    /// The derivatives by those parameters whose names are wanted.
    fn of(
        here: &'a Linearised,
        states: &'a [ContactState],
        is_wanted: &dyn Fn(&str) -> bool,
    ) -> Result<Self, Error> {
        let scene = here.scene().ok_or_else(|| {
            Error::analysis(
                "derivatives are those by the parameters of a scene, and the model has none",
            )
        })?;
        let problem = Problem::of(here, states)?;
        let (mut parameters, mut changes) = (Vec::new(), Vec::new());
        let (mut without_effect, mut without_derivative) = (Vec::new(), Vec::new());
        let values = Parameters::of(scene.clone());
        for (variable, value) in values.iter().filter(|(variable, _)| is_wanted(&variable.name)) {
            let Some(change) = ModelChange::by(scene, variable)? else { continue };
            let name = variable.name.clone();
            if problem.turns_round(&change) {
                without_derivative.push(name);
                continue;
            }
            let change = problem.change(&change)?;
            if change.is_zero() {
                without_effect.push(name);
                continue;
            }
            parameters.push(Parameter { name, value, unit: variable.unit() });
            changes.push(change);
        }
        let friction = parameters.iter().position(|it| it.name == FRICTION);
        let matrices = problem.matrices();
        Ok(Self {
            here,
            states,
            matrices,
            parameters,
            changes,
            without_effect,
            without_derivative,
            friction,
        })
    }

    /// Eigenvalues with their shapes; those that are equal but for rounding are one. `may_begin` is asked before each, and its error ends the
    /// work.
    fn shaped(
        &self,
        eigenvalues: &[Complex<f64>],
        may_begin: &(dyn Fn() -> Result<(), Error> + Sync),
        done: &(dyn Fn(usize, usize) + Sync),
    ) -> Result<Vec<Shaped>, Error> {
        let mut found = groups(&self.matrices, eigenvalues, may_begin, done)?;
        if let Some(friction) = self.friction {
            for one in &mut found {
                one.by_friction = one.mean_derivative(&self.changes[friction]);
            }
        }
        Ok(found)
    }

    fn mode(&self, one: &Shaped, near: &[Shaped], all: &[Complex<f64>]) -> ModeSensitivity {
        let derivatives: Option<Vec<Vec<Complex<f64>>>> =
            self.changes.iter().map(|by| one.derivatives(by)).collect();
        let largest = derivatives.iter().flatten().zip(&self.parameters).map(|(by, parameter)| {
            by.iter().map(|by| by.norm()).fold(0.0, f64::max) * parameter.value.abs()
        });
        let conjugate = [one.eigenvalue.conj()];
        let others = all.iter().chain(&conjugate).map(|it| (it - one.eigenvalue).norm());
        let apart = others.filter(|apart| *apart > one.error).fold(f64::INFINITY, f64::min);
        let holds_within = 0.5 * apart / largest.fold(0.0, f64::max);
        let merging = self.double_point(one, near, all, NEAR).and_then(|it| self.merging(it));
        let Shaped { eigenvalue, copies, .. } = *one;
        ModeSensitivity { eigenvalue, copies, derivatives, holds_within, merging }
    }

    /// The value of the common µ; 0 if there is none.
    fn friction_value(&self) -> f64 {
        self.friction.map_or(0.0, |friction| self.parameters[friction].value)
    }

    /// The double eigenvalue next to a start, an eigenvalue and a change of µ.
    fn search(
        &self,
        start: (Complex<f64>, Complex<f64>),
        shapes: [&Matrix; 2],
    ) -> Option<DoublePoint> {
        let by = &self.changes[self.friction?];
        let sizes = [start.0.norm().max(shapes::size(&self.matrices)), self.friction_value()];
        Search { matrices: &self.matrices, by, sizes }.double_point(start, shapes)
    }

    /// The nearest merging of an eigenvalue with another one, or with its conjugate, if there is one within a part of µ.
    fn double_point(
        &self,
        one: &Shaped,
        near: &[Shaped],
        all: &[Complex<f64>],
        within: f64,
    ) -> Option<DoublePoint> {
        self.friction?;
        let scale = self.friction_value();
        let shapes = [&one.left, &one.right];
        let is_within = |point: &DoublePoint| point.change.norm() <= within * scale;
        if one.is_merged {
            return self.search((one.eigenvalue, Complex::ZERO), shapes).filter(is_within);
        }
        let partners = near.iter().filter(|it| it.eigenvalue != one.eigenvalue);
        let partners = partners.filter(|it| it.copies == one.copies && !it.is_merged);
        let partners = partners.map(|it| (it.eigenvalue, it.by_friction));
        let own = [(one.eigenvalue.conj(), one.by_friction.conj())];
        let own = own.into_iter().filter(|it| it.0 != one.eigenvalue);
        let estimates = partners.chain(own).map(|(other, by)| {
            // With λ = s ± √d and d linear in µ, the two merge after a change of −d / d′.
            let change = -(one.eigenvalue - other) / (2.0 * (one.by_friction - by));
            (0.5 * (one.eigenvalue + other), change)
        });
        let starts = estimates.filter(|start| start.1.norm() <= SEARCHED * scale);
        let found = starts.filter_map(|start| self.search(start, shapes));
        let found = found.filter(|point| is_within(point) && is_of(point, one, all));
        found.min_by(|a, b| a.change.norm().total_cmp(&b.change.norm()))
    }

    /// A merging with its derivatives, both at the µ of the merging; `None` if the state cannot be analysed there.
    fn merging(&self, mut point: DoublePoint) -> Option<Merging> {
        const MOST_STEPS: usize = 8;
        let start = self.friction_value();
        let mut friction = start + point.change.re;
        for _ in 0..MOST_STEPS {
            let here = Linearised::of(&with_friction(self.here, friction)?);
            let there = StateDerivatives::of(&here, self.states, &|_| true).ok()?;
            let from = (point.eigenvalue, Complex::new(0.0, point.change.im));
            point = there.search(from, [&point.left, &point.right])?;
            if point.change.re.abs() > EXACT * start {
                friction += point.change.re;
                continue;
            }
            let by = &there.changes[there.friction?];
            let derivatives = self.parameters.iter().enumerate().map(|(i, parameter)| {
                let place = there.parameters.iter().position(|it| it.name == parameter.name);
                let own = place.filter(|_| Some(i) != self.friction);
                own.and_then(|place| point.moves(&there.changes[place], by)).unwrap_or_default()
            });
            let derivatives = derivatives.collect();
            let friction = friction + point.change.re;
            return Some(Merging {
                friction,
                distance: (friction - start).hypot(point.change.im),
                is_exact: point.change.im.abs() <= EXACT * start,
                is_real: point.eigenvalue.im.abs() <= 1e-6 * shapes::size(&there.matrices),
                eigenvalue: point.eigenvalue,
                derivatives,
            });
        }
        None
    }
}

/// The scene of a model with another common friction coefficient.
fn with_friction(here: &Linearised, value: f64) -> Option<Scene> {
    let mut scene = here.scene()?.clone();
    let all = variables(&scene);
    let variable = all.iter().find(|variable| variable.name == FRICTION)?;
    write_scene(&mut scene, variable, value).ok()?;
    Some(scene)
}

/// `true` if an eigenvalue is one of the two that merge at a place, among all eigenvalues and their conjugates.
fn is_of(point: &DoublePoint, one: &Shaped, all: &[Complex<f64>]) -> bool {
    let both = || all.iter().flat_map(|value| [*value, value.conj()]);
    point.pair(-point.change).into_iter().any(|expected| {
        let apart = |value: &Complex<f64>| (value - expected).norm();
        let nearest = both().min_by(|a, b| apart(a).total_cmp(&apart(b)));
        let is_one = |value: Complex<f64>| (value - one.eigenvalue).norm() <= one.error;
        nearest.is_some_and(|nearest| is_one(nearest) || is_one(nearest.conj()))
    })
}

/// The eigenvalues of a small complex matrix.
fn eigenvalues(matrix: Matrix) -> Vec<Complex<f64>> {
    if let [only] = matrix.as_slice() {
        return vec![*only];
    }
    if matrix.nrows() == 2 {
        // Exact where the two are equal, which an iteration would split.
        let half = 0.5 * (matrix[(0, 0)] + matrix[(1, 1)]);
        let apart = 0.5 * (matrix[(0, 0)] - matrix[(1, 1)]);
        let root = (apart * apart + matrix[(0, 1)] * matrix[(1, 0)]).sqrt();
        return vec![half + root, half - root];
    }
    // An iteration that compares with neighbours on the diagonal has no end where these are zero; after a shift by the size of
    // the matrix they are not.
    let size = Complex::from(matrix.norm());
    let count = matrix.nrows();
    let shifted = matrix + Matrix::from_diagonal_element(count, count, size);
    match Schur::try_new(shifted, f64::EPSILON, 1000) {
        Some(schur) => schur.unpack().1.diagonal().iter().map(|value| value - size).collect(),
        None => vec![Complex::new(f64::NAN, f64::NAN); count],
    }
}

#[cfg(test)]
mod tests;
