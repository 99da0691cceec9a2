//! The critical step of the forward increment scheme with lagged damping.
//!
//! A real mode with ω² and 2 ζ ω = α + β ω² leaves the unit circle through −1 where
//! h² ω² + 2 h (α + β ω²) = 4, that is at h_c = (2/ω)(√(1 + ζ²) − ζ). A mode that flutters grows
//! at every step, because the physics does, and so sets no limit.

use crate::Error;
use crate::contact::{ContactState, Joined, all_states};
use crate::model::LumpedModel;
use nalgebra::Schur;

/// Up to this many contacts all contact states are looked at; beyond, a bound stands in.
const MAX_ENUMERATED_CONTACTS: usize = 4;

/// The largest step, s, at which no contact state is numerically unstable.
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
    /// The highest real mode of all contact states, found in this one.
    State(Vec<ContactState>),
    /// A norm that no frequency of any contact state exceeds: the true limit is not smaller.
    Bound,
}

impl std::fmt::Display for CriticalStep {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match &self.origin {
            Origin::State(states) => write!(f, "{:.4e} s (state {})", self.step, Joined(states)),
            Origin::Bound => write!(f, "at least {:.4e} s (a bound for all states)", self.step),
        }
    }
}

/// The critical step of a model, over all its contact states.
///
/// # Errors
/// More than four contacts that are coupled through their masses: no bound is known for them.
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
        let step = limit(model, bound.square(friction_coefficient));
        return Ok(CriticalStep { step, origin: Origin::Bound });
    }
    let count = u32::try_from(contacts).expect("at most four");
    let highest = all_states(count)
        .filter_map(|states| {
            let square = highest_real_square(model, &states, friction_coefficient)?;
            Some((square, states))
        })
        .max_by(|a, b| a.0.total_cmp(&b.0));
    Ok(match highest {
        Some((square, states)) => {
            CriticalStep { step: limit(model, square), origin: Origin::State(states) }
        }
        None => CriticalStep { step: f64::INFINITY, origin: Origin::Bound },
    })
}

/// The step at which a mode with this ω² (1/s²) becomes unstable.
fn limit(model: &LumpedModel, square: f64) -> f64 {
    let rate = model.damping.alpha + model.damping.beta * square;
    // Without a frequency and without damping this is infinite, as it should be.
    4.0 / (rate + (rate * rate + 4.0 * square).sqrt())
}

/// The largest real positive eigenvalue of M̃⁻¹ K̃, 1/s².
fn highest_real_square(model: &LumpedModel, states: &[ContactState], friction: f64) -> Option<f64> {
    let reduced = model.reduced(states, friction);
    let matrix = reduced.mass.lu().solve(&reduced.stiffness)?;
    if matrix.is_empty() {
        return None;
    }
    let size = matrix.nrows();
    let schur = Schur::try_new(matrix, f64::EPSILON, 1000 * size)?;
    // Rounding parts a double real eigenvalue into a pair by the root of the precision.
    let real = |value: &nalgebra::Complex<f64>| value.im.abs() <= 1e-7 * value.re.abs();
    let values = schur.complex_eigenvalues();
    values.iter().filter(|v| real(v) && v.re > 0.0).map(|v| v.re).max_by(f64::total_cmp)
}

/// Refuses steps above the critical one, again and again as µ and the damping change. A bound is
/// asked first, which costs one pass over the degrees of freedom and allocates nothing; the contact
/// states are looked at only where it does not suffice.
#[derive(Clone, Debug)]
pub struct StepGuard {
    bound: Option<FrequencyBound>,
}

impl StepGuard {
    /// A guard for this model; sharpest near the given µ.
    #[must_use]
    pub fn new(model: &LumpedModel, friction_coefficient: f64) -> Self {
        Self { bound: FrequencyBound::new(model, friction_coefficient) }
    }

    /// Is `step` (s) below the critical one? `model` is the one that the guard was made for, but
    /// for its damping.
    ///
    /// # Errors
    /// The step, the limit, and the state that sets it.
    pub fn check(&self, model: &LumpedModel, friction: f64, step: f64) -> Result<(), Error> {
        if self.bound.as_ref().is_some_and(|bound| step <= limit(model, bound.square(friction))) {
            return Ok(());
        }
        let critical = critical_step(model, friction)?;
        if step <= critical.step {
            return Ok(());
        }
        Err(Error::step_too_large(format!(
            "integrator.step = {step:e} s is above the critical step, {critical}; \
             choose a smaller step"
        )))
    }
}

/// A bound of ω² over all contact states of uncoupled contacts (diagonal mass, contact directions
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

    /// The bound of ω², 1/s², at this µ.
    fn square(&self, friction: f64) -> f64 {
        self.rows.iter().fold(0.0, |largest, [own, drag]| f64::max(largest, own + friction * drag))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Contact, Direction, SparseMatrix};
    use crate::scene::{Damping, builtin};

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
    fn set_1_is_limited_by_the_highest_frequency_of_table_2() {
        // R-Sl–R-Sl has the highest mode of Table 2: −5.09 ± 232.35i Hz.
        let found = critical_step(&set1(), 1.96).unwrap();
        assert_eq!(found.origin, Origin::State(vec![ContactState::ReverseSlide; 2]));
        let omega = 2.0 * std::f64::consts::PI * (232.35_f64.powi(2) + 5.09_f64.powi(2)).sqrt();
        let zeta = 5.09 / 232.35_f64.hypot(5.09);
        let expected = 2.0 / omega * ((1.0 + zeta * zeta).sqrt() - zeta);
        // The table's last printed digit is 4e-5 of the damping that enters here.
        assert!((found.step - expected).abs() < 5e-5 * expected, "{found}");
    }

    #[test]
    fn the_bound_is_below_the_limit_and_not_far_below() {
        for mu in [0.0, 0.5, 1.96, 5.0] {
            let exact = critical_step(&set1(), mu).unwrap().step;
            let bound = FrequencyBound::new(&set1(), 1.96).unwrap().square(mu);
            let bound = limit(&set1(), bound);
            assert!(bound <= exact && bound > 0.4 * exact, "{mu}: {bound} {exact}");
        }
    }

    #[test]
    fn a_step_above_the_limit_is_refused_with_the_limit_and_its_state() {
        let model = set1();
        let limit = critical_step(&model, 1.96).unwrap().step;
        let guard = StepGuard::new(&model, 1.96);
        assert!(guard.check(&model, 1.96, 0.999 * limit).is_ok());
        let error = guard.check(&model, 1.96, 1.001 * limit).unwrap_err();
        assert!(error.is_step_too_large() && error.to_string().contains("R-Sl-R-Sl"), "{error}");
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
