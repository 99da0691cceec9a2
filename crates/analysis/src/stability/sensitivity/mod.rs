//! Derivatives of growth rates, frequencies and critical friction coefficients by the parameters of a scene.
//!
//! | file | what it holds |
//! | --- | --- |
//! | `change` | the derivative of a scene's model by a parameter |
//! | `bordered` | the eigenvalue problem with the contact forces as unknowns, and its derivatives |
//! | `nullspace` | shapes, left and right, of a known eigenvalue |
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

pub use critical::{CriticalFriction, critical_friction};

use super::parallel::collect;
use super::{Linearised, modes};
use crate::assign::FRICTION;
use amontons::Error;
use amontons::contact::ContactState;
use amontons::simulation::catalogue::Kind;
use amontons::simulation::{Parameters, Variable};
use bordered::{Bordered, BorderedChange, Problem, Vector};
use change::ModelChange;
use merging::{DoublePoint, double_point};
use nalgebra::{Complex, DMatrix};
use nullspace::null_space;
use std::f64::consts::TAU;

/// Eigenvalues that differ by less than this part of themselves are one that comes several times. Rounding splits a
/// multiple eigenvalue by parts of 1e-13, and one that has merged by parts of 1e-8.
const SAME: f64 = 1e-10;
/// A mode whose eigenvalue merges with another one within this part of µ is near a merging.
const NEAR: f64 = 0.01;
/// Mergings are sought from estimates within this part of µ.
const SEARCHED: f64 = 0.1;

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
    /// `None` where the eigenvalue has merged with another one and has no derivatives.
    pub derivatives: Option<Vec<Vec<Complex<f64>>>>,
    /// The merging with another eigenvalue, if there is one within a hundredth of µ. The derivatives then hold for much
    /// smaller changes than a hundredth of a parameter.
    pub merging: Option<Merging>,
}

/// A value of the common friction coefficient µ at which two eigenvalues merge.
#[derive(Clone, Debug, PartialEq)]
pub struct Merging {
    /// This µ; where damping keeps the two from merging, the µ at which they come nearest.
    pub friction: f64,
    /// The distance to it, of the size of a change of µ; at least the distance of this µ to that of the scene.
    pub distance: f64,
    /// The common eigenvalue there, 1/s.
    pub eigenvalue: Complex<f64>,
    /// ∂µ/∂p of this µ by each parameter; `None` for µ itself.
    pub derivatives: Vec<Option<f64>>,
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
/// Returns an error if the model is not that of a scene, if the state cannot be analysed, if contacts hold one motion twice, or if the equilibrium has no
/// derivative.
pub fn sensitivities(
    here: &Linearised,
    states: &[ContactState],
    frequencies: [f64; 2],
    done: &(dyn Fn(usize, usize) + Sync),
) -> Result<Sensitivities, Error> {
    let state = StateDerivatives::of(here, states)?;
    let all = multiple(modes(here.linear()?, states)?.all().map(|mode| mode.eigenvalue));
    let [low, high] = frequencies;
    let chosen: Vec<&Multiple> =
        all.iter().filter(|it| (low..=high).contains(&(it.eigenvalue.im / TAU))).collect();
    let shaped =
        collect(all.len(), &|i| state.shapes(all[i]), &|count| done(count, 2 * all.len()))?;
    let is_chosen = |one: &&Shaped| chosen.iter().any(|it| it.eigenvalue == one.eigenvalue);
    let of: Vec<&Shaped> = shaped.iter().filter(is_chosen).collect();
    let found = collect(of.len(), &|i| Ok(state.mode(of[i], &shaped)), &|count| {
        done(all.len() + count, all.len() + of.len());
    })?;
    Ok(Sensitivities {
        parameters: state.parameters,
        without_effect: state.without_effect,
        modes: found,
    })
}

/// An eigenvalue and the number of times that it comes.
#[derive(Clone, Copy, Debug)]
struct Multiple {
    eigenvalue: Complex<f64>,
    copies: usize,
}

/// Takes eigenvalues that are equal but for rounding together.
fn multiple(eigenvalues: impl Iterator<Item = Complex<f64>>) -> Vec<Multiple> {
    let mut found: Vec<Multiple> = Vec::new();
    for eigenvalue in eigenvalues {
        let is_same =
            |it: &&mut Multiple| (it.eigenvalue - eigenvalue).norm() <= SAME * eigenvalue.norm();
        match found.iter_mut().find(is_same) {
            Some(one) => one.copies += 1,
            None => found.push(Multiple { eigenvalue, copies: 1 }),
        }
    }
    found
}

/// An eigenvalue with its shapes as columns, and its mean derivative by µ.
#[derive(Clone, Debug)]
struct Shaped {
    eigenvalue: Complex<f64>,
    copies: usize,
    left: DMatrix<Complex<f64>>,
    right: DMatrix<Complex<f64>>,
    /// Yᵀ (∂Q/∂λ) Z; `None` where it is singular, since the eigenvalue has merged with another one.
    weight: Option<DMatrix<Complex<f64>>>,
    by_friction: Complex<f64>,
}

/// The matrices of a contact state with their derivatives.
struct StateDerivatives {
    matrices: Bordered,
    parameters: Vec<Parameter>,
    /// One for each parameter.
    changes: Vec<BorderedChange>,
    without_effect: Vec<String>,
    /// The place of the common µ among the parameters.
    friction: Option<usize>,
}

impl StateDerivatives {
    fn of(here: &Linearised, states: &[ContactState]) -> Result<Self, Error> {
        let scene = here.scene().ok_or_else(|| {
            Error::analysis(
                "derivatives are those by the parameters of a scene, and the model has none",
            )
        })?;
        let problem = Problem::of(here, states)?;
        let (mut parameters, mut changes) = (Vec::new(), Vec::new());
        let mut without_effect = Vec::new();
        let values = Parameters::of(scene.clone());
        for (variable, value) in values.iter() {
            let Some(change) = ModelChange::by(scene, variable)? else { continue };
            let change = problem.change(&change)?;
            if change.is_zero() {
                without_effect.push(variable.name.clone());
                continue;
            }
            let (name, unit) = (variable.name.clone(), unit(variable));
            parameters.push(Parameter { name, value, unit });
            changes.push(change);
        }
        let friction = parameters.iter().position(|it| it.name == FRICTION);
        Ok(Self { matrices: problem.matrices(), parameters, changes, without_effect, friction })
    }

    /// The shapes of an eigenvalue.
    fn shapes(&self, Multiple { eigenvalue, copies }: Multiple) -> Result<Shaped, Error> {
        let q = self.matrices.at(eigenvalue);
        let both = |count| Ok((null_space(&q, count)?, null_space(&q.transpose(), count)?));
        let (right, left, copies, is_merged) = match both(copies)? {
            (Some(right), Some(left)) => (right, left, copies, false),
            // A double eigenvalue with one shape: two have merged.
            _ => match both(1)? {
                (Some(right), Some(left)) => (right, left, 1, true),
                _ => return Err(Error::analysis("the shapes of a mode were not found")),
            },
        };
        let sloped = DMatrix::from_columns(
            &right
                .column_iter()
                .map(|column| self.matrices.slope_times(eigenvalue, &column.into_owned()))
                .collect::<Vec<_>>(),
        );
        let weight = left.tr_mul(&sloped);
        let is_regular = !is_merged && is_regular(&weight, &sloped);
        let mut shaped = Shaped {
            eigenvalue,
            copies,
            left,
            right,
            weight: is_regular.then_some(weight),
            by_friction: Complex::ZERO,
        };
        if let Some(friction) = self.friction {
            let all = shaped.derivatives(&self.changes[friction]);
            #[allow(clippy::cast_precision_loss)]
            let count = copies as f64;
            shaped.by_friction =
                all.map_or(Complex::ZERO, |all| all.iter().sum::<Complex<f64>>() / count);
        }
        Ok(shaped)
    }

    fn mode(&self, one: &Shaped, all: &[Shaped]) -> ModeSensitivity {
        let derivatives = one.weight.as_ref().map(|_| {
            self.changes.iter().map(|by| one.derivatives(by).unwrap_or_default()).collect()
        });
        let merging = self.double_point(one, all, NEAR).map(|point| self.merging(&point));
        let Shaped { eigenvalue, copies, .. } = *one;
        ModeSensitivity { eigenvalue, copies, derivatives, merging }
    }

    /// The merging of an eigenvalue with another one, if there is one within a part of µ.
    fn double_point(&self, one: &Shaped, all: &[Shaped], within: f64) -> Option<DoublePoint> {
        let friction = self.friction?;
        let scale = self.parameters[friction].value;
        if one.copies > 1 {
            return None;
        }
        // With λ = s ± √d and d linear in µ, the two merge after a change of −d / d′.
        let estimate = |other: Complex<f64>, by: Complex<f64>| {
            -(one.eigenvalue - other) / (2.0 * (one.by_friction - by))
        };
        let others = all.iter().filter(|it| it.eigenvalue != one.eigenvalue && it.copies == 1);
        let pairs = others.map(|it| (it.eigenvalue, it.by_friction));
        let own = [(one.eigenvalue.conj(), one.by_friction.conj())];
        let own = own.into_iter().filter(|it| it.0 != one.eigenvalue);
        let mut starts: Vec<(Complex<f64>, Complex<f64>)> = pairs
            .chain(own)
            .map(|(other, by)| (0.5 * (one.eigenvalue + other), estimate(other, by)))
            .filter(|start| start.1.norm() <= SEARCHED * scale)
            .collect();
        if one.weight.is_none() {
            starts.insert(0, (one.eigenvalue, Complex::ZERO));
        }
        starts.sort_by(|a, b| a.1.norm().total_cmp(&b.1.norm()));
        let shapes = [&one.left, &one.right].map(|shapes| shapes.column(0).into_owned());
        let found = starts.into_iter().filter_map(|start| {
            let [left, right] = &shapes;
            double_point(&self.matrices, &self.changes[friction], scale, start, [left, right])
        });
        let mut near = found.filter(|point| point.change.norm() <= within * scale);
        near.next()
    }

    fn merging(&self, point: &DoublePoint) -> Merging {
        let friction = self.friction.expect("there is no merging without a common µ");
        let by = &self.changes[friction];
        let derivatives = self
            .changes
            .iter()
            .enumerate()
            .map(|(i, change)| (i != friction).then(|| point.moves(change, by).re));
        Merging {
            friction: self.parameters[friction].value + point.change.re,
            distance: point.change.norm(),
            eigenvalue: point.eigenvalue,
            derivatives: derivatives.collect(),
        }
    }
}

impl Shaped {
    /// ∂λ/∂p of each copy, the largest real part first; `None` at a merging.
    fn derivatives(&self, by: &BorderedChange) -> Option<Vec<Complex<f64>>> {
        let weight = self.weight.as_ref()?;
        let columns = |matrix: &DMatrix<Complex<f64>>| -> Vec<Vector> {
            matrix.column_iter().map(|column| column.into_owned()).collect()
        };
        let (left, right) = (columns(&self.left), columns(&self.right));
        if let ([left], [right]) = (&left[..], &right[..]) {
            return Some(vec![-by.form(left, self.eigenvalue, right) / weight[(0, 0)]]);
        }
        let projected = DMatrix::from_fn(left.len(), right.len(), |row, column| {
            -by.form(&left[row], self.eigenvalue, &right[column])
        });
        let mut found = eigenvalues(weight.clone().lu().solve(&projected)?);
        found.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
        Some(found)
    }
}

/// The eigenvalues of a small complex matrix.
fn eigenvalues(matrix: DMatrix<Complex<f64>>) -> Vec<Complex<f64>> {
    if matrix.nrows() == 2 {
        // Exact where the two are equal, which an iteration would split.
        let half = 0.5 * (matrix[(0, 0)] + matrix[(1, 1)]);
        let apart = 0.5 * (matrix[(0, 0)] - matrix[(1, 1)]);
        let root = (apart * apart + matrix[(0, 1)] * matrix[(1, 0)]).sqrt();
        return vec![half + root, half - root];
    }
    matrix.schur().unpack().1.diagonal().iter().copied().collect()
}

/// `false` if left shapes are orthogonal to the derivative by λ of right shapes, but for rounding.
fn is_regular(weight: &DMatrix<Complex<f64>>, sloped: &DMatrix<Complex<f64>>) -> bool {
    let least = weight.clone().singular_values().min();
    least > 1e-12 * sloped.norm()
}

/// The unit of a variable.
fn unit(variable: &Variable) -> &'static str {
    match variable.template.kind {
        Kind::Real { unit, .. } if unit != "1" => unit,
        _ => "",
    }
}

#[cfg(test)]
mod tests;
