//! The critical step of the forward increment scheme with lagged damping.
//!
//! An eigenvalue s of M̃⁻¹ K̃ gives the mode λ² + c λ + s = 0 with c = α + β s, of which the scheme
//! makes z² − (2 − h² s − h c) z + (1 − h c) = 0. A real mode, s = ω² and c = 2 ζ ω, leaves the unit
//! circle through −1 at h_c = (2/ω)(√(1 + ζ²) − ζ). A complex s belongs to two modes that friction
//! has made coalesce: one may grow, because the physics does, and it must not be asked to stay inside
//! the circle; but the scheme may make them grow where they do not. Their limit is the step up to
//! which ln |z| / h ≤ max(0, Re λ) + |λ|/1000: squeal that the step invents stays below a thousandth
//! of the frequency.

use crate::Error;
use crate::contact::{ContactState, Joined, all_states};
use crate::model::LumpedModel;
use crate::scene::Damping;
use nalgebra::{Complex, Schur};

/// Up to this many contacts all contact states are looked at; beyond, a bound stands in.
const MAX_ENUMERATED_CONTACTS: usize = 4;
/// How much faster than the physics a complex mode may grow, in parts of |λ|.
const INVENTED_GROWTH: f64 = 1e-3;

/// The largest step, s, at which the scheme makes no mode of any contact state grow that does not.
#[derive(Clone, Debug, PartialEq)]
pub struct CriticalStep {
    /// h_c, s.
    pub step: f64,
    /// Where it comes from.
    pub origin: Origin,
}

/// Where a critical step comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum Origin {
    /// A mode of this contact state.
    State {
        /// The state.
        states: Vec<ContactState>,
        /// Has the mode coalesced with another (or is it real)?
        coalesced: bool,
    },
    /// A norm that no eigenvalue of any contact state exceeds: the true limit is not smaller.
    Bound,
}

impl std::fmt::Display for CriticalStep {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match &self.origin {
            Origin::State { states, coalesced } => {
                let mode = if *coalesced { ", coalesced modes" } else { "" };
                write!(f, "{:.4e} s (state {}{mode})", self.step, Joined(states))
            }
            Origin::Bound => write!(f, "at least {:.4e} s (a bound for all states)", self.step),
        }
    }
}

/// The critical step of a model, over all its contact states.
///
/// # Errors
/// A state whose eigenvalues are not found; more than four contacts that are coupled through their
/// masses, for which no bound is known.
pub fn critical_step(
    model: &LumpedModel,
    friction_coefficient: f64,
) -> Result<CriticalStep, Error> {
    let contacts = model.contacts.len();
    if contacts > MAX_ENUMERATED_CONTACTS {
        let bound = FrequencyBound::new(model, friction_coefficient).ok_or_else(|| {
            Error::step_too_large(format!(
                "no critical step is known for {contacts} contacts that are coupled through \
                 their masses; up to {MAX_ENUMERATED_CONTACTS} are possible"
            ))
        })?;
        let square = bound.square(friction_coefficient);
        let step = largest(real_limit(model.damping, square), |step| {
            all_admissible(step, model.damping, square, friction_coefficient)
        });
        return Ok(CriticalStep { step, origin: Origin::Bound });
    }
    let mut critical = CriticalStep { step: f64::INFINITY, origin: Origin::Bound };
    for states in all_states(u32::try_from(contacts).expect("at most four")) {
        for square in squares(model, &states, friction_coefficient)? {
            let step = mode_limit(model.damping, square);
            if step < critical.step {
                let origin = Origin::State { states: states.clone(), coalesced: square.im != 0.0 };
                critical = CriticalStep { step, origin };
            }
        }
    }
    Ok(critical)
}

/// The eigenvalues s of M̃⁻¹ K̃, 1/s²; real ones with an exact zero for their imaginary part.
fn squares(
    model: &LumpedModel,
    states: &[ContactState],
    friction: f64,
) -> Result<Vec<Complex<f64>>, Error> {
    let failed = || {
        Error::step_too_large(format!(
            "no critical step is known: the eigenvalues of state {} were not found",
            Joined(states)
        ))
    };
    // A state that determines no motion sets no limit.
    let Some(reduced) = model.reduced(states, friction) else { return Ok(Vec::new()) };
    let size = reduced.mass.nrows();
    if size == 0 {
        return Ok(Vec::new());
    }
    let matrix = reduced.mass.lu().solve(&reduced.stiffness).ok_or_else(failed)?;
    // The iteration has no exceptional shifts: once in some ten thousand matrices it goes in circles.
    // The transpose, which has the same eigenvalues, and a looser criterion lead out.
    let transposed = matrix.transpose();
    let attempts = [1.0, 64.0, 4096.0].map(|looser| looser * f64::EPSILON).into_iter();
    let schur = attempts
        .flat_map(|precision| [(&matrix, precision), (&transposed, precision)])
        .find_map(|(matrix, precision)| Schur::try_new(matrix.clone(), precision, 100 * size))
        .ok_or_else(failed)?;
    // Rounding parts a double real eigenvalue into a pair by the root of the precision.
    let cleaned = |value: &Complex<f64>| {
        let is_real = value.im.abs() <= 1e-7 * value.re.abs();
        if is_real { Complex::new(value.re, 0.0) } else { *value }
    };
    Ok(schur.complex_eigenvalues().iter().map(cleaned).collect())
}

/// The step at which a real mode with this ω² (1/s²) leaves the unit circle.
fn real_limit(damping: Damping, square: f64) -> f64 {
    let rate = damping.alpha + damping.beta * square;
    // Without a frequency and without damping this is infinite, as it should be.
    4.0 / (rate + (rate * rate + 4.0 * square).sqrt())
}

/// The largest step of one mode.
fn mode_limit(damping: Damping, square: Complex<f64>) -> f64 {
    if square.im == 0.0 {
        // A real mode that diverges grows at any step, as the physics does.
        return if square.re > 0.0 { real_limit(damping, square.re) } else { f64::INFINITY };
    }
    largest(2.0 / square.norm().sqrt(), |step| is_admissible(step, damping, square))
}

/// The largest step below `end` up to which all steps fulfil a condition: on a grid, then refined.
fn largest(end: f64, holds: impl Fn(f64) -> bool) -> f64 {
    const GRID: u32 = 256;
    if !end.is_finite() {
        return end;
    }
    let grid = |i: u32| end * f64::from(i) / f64::from(GRID);
    let Some(first_bad) = (1..=GRID).find(|&i| !holds(grid(i))) else { return end };
    let (mut good, mut bad) = (grid(first_bad - 1), grid(first_bad));
    while bad - good > 1e-6 * bad {
        let middle = 0.5 * (good + bad);
        if holds(middle) { good = middle } else { bad = middle }
    }
    good
}

/// Does the scheme make a mode with this s grow as the physics does, or not at all?
fn is_admissible(step: f64, damping: Damping, square: Complex<f64>) -> bool {
    let rate = square * damping.beta + damping.alpha;
    let physical = roots(rate, square);
    let numerical =
        roots(square * (step * step) + rate * step - 2.0, Complex::new(1.0, 0.0) - rate * step);
    let growth = physical.iter().fold(0.0, |growth, lambda| f64::max(growth, lambda.re));
    let size = physical.iter().fold(0.0, |size, lambda| f64::max(size, lambda.norm()));
    let factor = numerical.iter().fold(0.0, |factor, z| f64::max(factor, z.norm()));
    factor.ln() <= step * (growth + INVENTED_GROWTH * size)
}

/// The roots of x² + b x + c = 0.
fn roots(b: Complex<f64>, c: Complex<f64>) -> [Complex<f64>; 2] {
    let root = (b * b - c * 4.0).sqrt();
    [(-b + root) * 0.5, (-b - root) * 0.5]
}

/// Is the step admissible for every eigenvalue, real or complex, of up to this size? Without
/// friction all are real.
fn all_admissible(step: f64, damping: Damping, square: f64, friction: f64) -> bool {
    const ANGLES: u32 = 32;
    const SIZES: u32 = 12;
    if step > real_limit(damping, square) {
        return false;
    }
    friction == 0.0
        || (0..SIZES).all(|size| {
            let size = square * 0.5_f64.powi(size.cast_signed());
            (1..=ANGLES).all(|angle| {
                let angle = std::f64::consts::PI * f64::from(angle) / f64::from(ANGLES);
                is_admissible(step, damping, Complex::from_polar(size, angle))
            })
        })
}

/// Refuses steps above the critical one, again and again as µ and the damping change. A bound is
/// asked first, which costs one pass over the degrees of freedom and allocates nothing; the contact
/// states are looked at only where it does not suffice.
#[derive(Clone, Debug)]
pub struct StepGuard {
    step: f64,
    bound: Option<FrequencyBound>,
    /// The damping that `admissible` belongs to.
    damping: Damping,
    /// The largest bound of the eigenvalues at which the step is admissible, 1/s².
    admissible: f64,
}

impl StepGuard {
    /// A guard of this step (s) for this model; sharpest near the given µ.
    #[must_use]
    pub fn new(model: &LumpedModel, friction_coefficient: f64, step: f64) -> Self {
        let bound = FrequencyBound::new(model, friction_coefficient);
        let mut guard = Self { step, bound, damping: model.damping, admissible: 0.0 };
        guard.set_damping(model.damping);
        guard
    }

    fn set_damping(&mut self, damping: Damping) {
        // No real mode above (2/h)² is admissible.
        let end = 4.0 / (self.step * self.step);
        self.admissible = largest(end, |square| all_admissible(self.step, damping, square, 1.0));
        self.damping = damping;
    }

    /// Is the step below the critical one? `model` is the one that the guard was made for, but for
    /// its damping.
    ///
    /// # Errors
    /// The step, the limit, and the state that sets it.
    pub fn check(&mut self, model: &LumpedModel, friction: f64) -> Result<(), Error> {
        if self.damping != model.damping {
            self.set_damping(model.damping);
        }
        if self.bound.as_ref().is_some_and(|bound| bound.square(friction) <= self.admissible) {
            return Ok(());
        }
        let critical = critical_step(model, friction)?;
        if self.step <= critical.step {
            return Ok(());
        }
        let step = self.step;
        Err(Error::step_too_large(match critical.origin {
            Origin::State { .. } => format!(
                "integrator.step = {step:e} s is above the critical step, {critical}; \
                 choose a smaller step"
            ),
            Origin::Bound => format!(
                "integrator.step = {step:e} s may be above the critical step: it is known to be \
                 {critical}; choose a step up to that"
            ),
        }))
    }
}

/// A bound of |s| over all contact states of uncoupled contacts (diagonal mass, contact directions
/// along degrees of freedom).
///
/// In every contact state the entries of M̃⁻¹ K̃ are in size at most those of the non-negative
/// matrix B: the rows of M⁻¹ |K|, the tangential rows with µ times the normal row added. Its
/// spectral radius is at most maxᵢ (B d)ᵢ / dᵢ for any positive d (Collatz and Wielandt); a few
/// powers of B make a good d.
#[derive(Clone, Debug)]
struct FrequencyBound {
    /// (B d)ᵢ / dᵢ, as the part without µ and the factor of µ.
    rows: Vec<[f64; 2]>,
}

impl FrequencyBound {
    fn new(model: &LumpedModel, friction: f64) -> Option<Self> {
        let mass = model.mass.as_diagonal()?;
        let dofs = model.dofs();
        let mut dragged_by = vec![None; dofs];
        let mut used = vec![false; dofs];
        for contact in &model.contacts {
            let (tangent, normal) = (contact.tangent.as_unit()?, contact.normal.as_unit()?);
            for dof in [tangent, normal] {
                if std::mem::replace(&mut used[dof], true) {
                    return None;
                }
            }
            dragged_by[tangent] = Some(normal);
        }
        let row = |dof: usize, d: &[f64]| {
            model.stiffness.row(dof).fold(0.0, |sum, (column, value)| sum + value.abs() * d[column])
        };
        let apply = |d: &[f64]| -> Vec<[f64; 2]> {
            let drag = |dof: usize| dragged_by[dof].map_or(0.0, |normal| row(normal, d));
            (0..dofs).map(|dof| [row(dof, d) / mass[dof], drag(dof) / mass[dof]]).collect()
        };
        let mut d = vec![1.0; dofs];
        for _ in 0..30 {
            let next: Vec<f64> =
                apply(&d).iter().map(|[own, drag]| own + friction * drag).collect();
            let largest = next.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
            // The floor keeps d positive, as the theorem wants it, where a row is zero.
            d = next.into_iter().map(|value| (value / largest).max(1e-6)).collect();
        }
        let rows = apply(&d).iter().zip(&d).map(|([own, drag], d)| [own / d, drag / d]).collect();
        Some(Self { rows })
    }

    /// The bound of |s|, 1/s², at this µ.
    fn square(&self, friction: f64) -> f64 {
        self.rows.iter().fold(0.0, |largest, [own, drag]| f64::max(largest, own + friction * drag))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Contact, Direction, SparseMatrix};
    use crate::scene::builtin;

    fn set1() -> LumpedModel {
        LumpedModel::from(&builtin("set1").unwrap().scene())
    }

    #[test]
    fn one_mass_has_the_closed_form() {
        let (m, k, beta, alpha) = (2.0, 8e4, 3e-4, 5.0);
        let model = LumpedModel {
            mass: SparseMatrix::diagonal(&[m]),
            stiffness: SparseMatrix::diagonal(&[k]),
            damping: Damping { alpha, beta },
            load: vec![0.0],
            contacts: vec![],
        };
        let omega = (k / m).sqrt();
        let zeta = 0.5 * (alpha / omega + beta * omega);
        let expected = 2.0 / omega * ((1.0 + zeta * zeta).sqrt() - zeta);
        let found = critical_step(&model, 0.0).unwrap();
        assert!((found.step - expected).abs() < 1e-14 * expected);
    }

    #[test]
    fn set_1_at_low_friction_is_limited_by_the_highest_mode_of_the_detached_state() {
        // Dt–Dt has the same modes at every µ; Table 2: −5.08 ± 232.00i Hz.
        let found = critical_step(&set1(), 0.5).unwrap();
        let states = vec![ContactState::Detached; 2];
        assert_eq!(found.origin, Origin::State { states, coalesced: false });
        let omega = 2.0 * std::f64::consts::PI * 232.00_f64.hypot(5.08);
        let zeta = 5.08 / 232.00_f64.hypot(5.08);
        let expected = 2.0 / omega * ((1.0 + zeta * zeta).sqrt() - zeta);
        // The last printed digit of 5.08 is a thousandth of the damping.
        assert!((found.step - expected).abs() < 5e-5 * expected, "{found}");
    }

    #[test]
    fn coalesced_modes_limit_set_1_where_it_squeals() {
        let found = critical_step(&set1(), 1.96).unwrap();
        let states = vec![ContactState::Slide; 2];
        assert_eq!(found.origin, Origin::State { states, coalesced: true });
    }

    #[test]
    fn a_step_above_the_limit_is_refused_with_the_limit_and_its_state() {
        let model = set1();
        let limit = critical_step(&model, 1.96).unwrap().step;
        assert!(StepGuard::new(&model, 1.96, 0.999 * limit).check(&model, 1.96).is_ok());
        let mut above = StepGuard::new(&model, 1.96, 1.001 * limit);
        let error = above.check(&model, 1.96).unwrap_err();
        assert!(error.is_step_too_large() && error.to_string().contains("Sl-Sl"), "{error}");
        // Without friction no modes coalesce, and the same step is fine.
        assert!(above.check(&model, 0.0).is_ok());
    }

    #[test]
    fn a_structure_with_redundant_contacts_has_a_critical_step() {
        let mut model = set1();
        model.contacts[1] = model.contacts[0].clone();
        assert!(critical_step(&model, 0.5).unwrap().step > 1e-5);
    }

    #[test]
    fn five_contacts_get_a_bound_and_five_coupled_ones_an_error() {
        let mut scene = builtin("set1").unwrap().scene();
        scene.modules = vec![scene.modules[0]; 5];
        let mut model = LumpedModel::from(&scene);
        assert_eq!(critical_step(&model, 1.96).unwrap().origin, Origin::Bound);
        model.contacts[0] =
            Contact { normal: Direction::unit(3), tangent: Direction(vec![(2, 0.6), (6, 0.8)]) };
        assert!(critical_step(&model, 1.96).is_err());
    }
}
