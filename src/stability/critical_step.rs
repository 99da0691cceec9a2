//! The critical step of the forward increment scheme with lagged damping.
//!
//! An eigenvalue s of M̃⁻¹ K̃ gives the mode λ² + c λ + s = 0 with c = α + β s, which the scheme maps to
//! z² − (2 − h² s − h c) z + (1 − h c) = 0. A real mode, s = ω² and c = 2 ζ ω, leaves the unit circle through −1 at
//! h_c = (2/ω)(√(1 + ζ²) − ζ). A complex s belongs to two modes that friction has made coalesce. One of them may grow
//! physically, and must not be required to stay inside the circle; but the scheme may also let modes grow that decay
//! physically. Their limit is the step up to which ln |z| / h ≤ max(0, Re λ) + |λ|/1000: spurious squeal stays below a
//! thousandth of the frequency.
//!
//! With discrete dampers there are no such s: `damped_step` examines the state as a whole. Where the states are too
//! many or too large, [`FrequencyBound`] replaces them: with all s in an ellipse, or |k| and |c − α − β k| of all modes
//! bounded, the step is taken at which every one of them is admissible. Without friction that condition is
//! h² k + 2 h c ≤ 4 and a guarantee; it is also a guarantee with friction where c and k follow from each other. With
//! both friction and discrete dampers a mode of the scheme is compared to that of the physics with the same k and c,
//! whose shape may differ.

use super::complex::{from_polar, modulus, root};
use super::eigenvalues::{Solver, by_schur, eigenvalues};
use super::frequency_bound::{FrequencyBound, Sizes};
use super::{alike_states, damped_step, step_search};
use crate::Error;
use crate::contact::{ContactState, JoinedStates, all_states};
use crate::model::{Damping, LinearModel, LumpedModel};
use nalgebra::Complex;

/// Largest number of contacts for which all contact states are examined; for more, a bound replaces them.
const MAX_ENUMERATED_CONTACTS: usize = 6;
/// Largest amount of work for which all contact states are examined: n³ for each state, more with discrete dampers.
const MAX_WORK: f64 = 3e7;
const MAX_DAMPED_WORK: f64 = 3e5;
/// Spurious growth rate of a complex mode that is accepted, in parts of |λ|.
pub(super) const INVENTED_GROWTH: f64 = 1e-3;

/// The largest step, s, at which the scheme lets no mode of any contact state grow that does not grow physically.
///
/// ```
/// use amontons::model::LumpedModel;
/// use amontons::scene::parse;
/// use amontons::stability::critical_step;
///
/// let scene = parse(
///     "oscillator",
///     "[integrator]\nmethod = \"event-driven\"\nstep = 1e-3\n\
///      [[mass]]\nname = \"m\"\nmass = 1.0\nlocked = [\"y\"]\n\
///      [[spring]]\nname = \"k\"\nbetween = [\"m\", \"ground\"]\ndirection = \"x\"\nstiffness = 100.0\n\
///      [[initial]]\nmass = \"m\"\nx = 0.01\n",
/// )?;
/// // 2/ω with ω = 10 rad/s.
/// let critical = critical_step(&LumpedModel::from(&scene))?;
/// assert!((critical.step - 0.2).abs() < 1e-6);
/// # Ok::<(), amontons::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct CriticalStep {
    /// Critical step h_c, s.
    pub step: f64,
    /// Origin of the limit.
    pub origin: Origin,
}

/// The origin of a critical step.
#[derive(Clone, Debug, PartialEq)]
pub enum Origin {
    /// A mode of this contact state.
    State {
        /// The state.
        states: Vec<ContactState>,
        /// `true` if the mode has coalesced with another, `false` if it is real.
        coalesced: bool,
    },
    /// A norm that no eigenvalue of any contact state exceeds: the true limit is not smaller than the step.
    Bound,
    /// The states in which all contacts are alike and that of the equilibrium, where there are too many others and no bound is
    /// known.
    Alike,
}

impl std::fmt::Display for CriticalStep {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match &self.origin {
            Origin::State { states, coalesced } => {
                let mode = if *coalesced { ", coalesced modes" } else { "" };
                write!(f, "{:.4e} s (", self.step)?;
                match &**states {
                    [] => write!(f, "no contacts{mode})"),
                    states => write!(f, "state {}{mode})", JoinedStates(states)),
                }
            }
            Origin::Alike => {
                write!(
                    f,
                    "{:.4e} s (of the equilibrium's state and those in which all contacts are alike; no guarantee for others)",
                    self.step
                )
            }
            Origin::Bound => write!(f, "at least {:.4e} s (a bound for all states)", self.step),
        }
    }
}

/// The critical step of a model, over all its contact states, with the greatest µ that each contact can have in slip.
///
/// # Errors
/// Returns an error if the eigenvalues of a state are not found, or if many contacts share masses and have so much
/// friction that no bound is known.
pub fn critical_step(model: &LumpedModel) -> Result<CriticalStep, Error> {
    let friction = model.with_greatest_friction();
    if can_be_enumerated(model) {
        return over_all_states(friction);
    }
    if model.mass.as_diagonal().is_none() {
        return Ok(CriticalStep { step: alike_states::critical(friction)?, origin: Origin::Alike });
    }
    let step = bound(friction).ok_or_else(|| {
        Error::step_too_large(format!(
            "no critical step is known for {} contacts with this friction: those that share masses may jam in \
             some of their states, where the frequencies have no upper bound; lower the friction or use the \
             event-driven method",
            model.contacts.len()
        ))
    })?;
    Ok(CriticalStep { step, origin: Origin::Bound })
}

/// A step, s, that is known not to exceed the critical one; `None` where none is known.
pub(super) fn bound(model: LinearModel<'_>) -> Option<f64> {
    let sizes = FrequencyBound::new(model)?.at(model);
    let (most, damping) = (sizes.largest_square(), model.model().damping);
    most.is_finite().then(|| {
        step_search::largest(real_limit(damping, sizes), |step| {
            all_admissible(step, damping, sizes, has_friction(model))
        })
    })
}

/// The critical step as the least limit of all contact states.
pub(super) fn over_all_states(model: LinearModel<'_>) -> Result<CriticalStep, Error> {
    let mut critical = CriticalStep { step: f64::INFINITY, origin: Origin::Bound };
    for states in states_of(model.model()) {
        for (step, coalesced) in limits(model, &states)? {
            if step < critical.step {
                critical = CriticalStep {
                    step,
                    origin: Origin::State { states: states.clone(), coalesced },
                };
            }
        }
    }
    Ok(critical)
}

/// The contact states of a model with few contacts.
fn states_of(model: &LumpedModel) -> impl Iterator<Item = Vec<ContactState>> {
    let all = all_states(u32::try_from(model.contacts.len()).expect("few"));
    all.filter(|states| states.iter().all(|state| model.law.allows(*state)))
}

/// `true` if a step (s) is known to be at most the critical one of a model. Each state is examined for this step alone,
/// and only the states that `concerns` picks: the others are known to admit it.
pub(super) fn is_reached(
    step: f64,
    model: LinearModel<'_>,
    concerns: impl Fn(&[ContactState]) -> bool,
) -> bool {
    if can_be_enumerated(model.model()) {
        let mut asked = states_of(model.model()).filter(|states| concerns(states));
        return asked.all(|states| state_reaches(step, model, &states).unwrap_or(false));
    }
    if model.model().mass.as_diagonal().is_none() {
        return alike_states::admit(step, model);
    }
    let bound = FrequencyBound::new(model);
    let sizes = bound.map(|bound| bound.at(model));
    sizes.filter(|sizes| sizes.largest_square().is_finite()).is_some_and(|sizes| {
        let (rubs, damping) = (has_friction(model), model.model().damping);
        step_search::reaches(step, real_limit(damping, sizes), |step| {
            all_admissible(step, damping, sizes, rubs)
        })
    })
}

/// `true` if a step is at most the largest one of each mode of a state.
fn state_reaches(
    step: f64,
    model: LinearModel<'_>,
    states: &[ContactState],
) -> Result<bool, Error> {
    if !model.model().dampers.is_empty() {
        let reduced = model.reduced(states);
        return reduced.map_or(Ok(true), |reduced| damped_step::reaches(step, &reduced));
    }
    // The other eigenvalue of a pair has the same limit.
    let squares = squares(model, states, eigenvalues)?;
    let mut squares = squares.into_iter().filter(|square| square.im >= 0.0);
    Ok(squares.all(|square| mode_reaches(step, model.model().damping, square)))
}

/// `true` if a large state admits a step (s). Smaller steps are not examined: with discrete dampers each takes a good part of a
/// second.
pub(super) fn state_admits(
    step: f64,
    model: LinearModel<'_>,
    states: &[ContactState],
) -> Result<bool, Error> {
    if model.model().dampers.is_empty() {
        return state_reaches(step, model, states);
    }
    model.reduced(states).map_or(Ok(true), |reduced| damped_step::admits(step, &reduced))
}

/// A step, s, that a large state admits, at most a fifth below the largest one of those that are examined.
pub(super) fn coarse_limit(model: LinearModel<'_>, states: &[ContactState]) -> Result<f64, Error> {
    if model.model().dampers.is_empty() {
        let squares = squares(model, states, eigenvalues)?.into_iter();
        let limits = squares.map(|square| mode_limit(model.model().damping, square));
        return Ok(limits.fold(f64::INFINITY, f64::min));
    }
    model.reduced(states).map_or(Ok(f64::INFINITY), |reduced| damped_step::coarse_limit(&reduced))
}

/// `true` if the model's states are few and small enough to examine all of them.
pub(super) fn can_be_enumerated(model: &LumpedModel) -> bool {
    let contacts = model.contacts.len();
    #[allow(clippy::cast_precision_loss)]
    let work = || (model.dofs() as f64).powi(3) * f64::from(1_u32 << (2 * contacts));
    let most = if model.dampers.is_empty() { MAX_WORK } else { MAX_DAMPED_WORK };
    contacts <= MAX_ENUMERATED_CONTACTS && work() <= most
}

/// `true` if modes may grow or coalesce: some contact has friction, or forces are circulatory or gyroscopic, so that K or D is
/// not symmetric.
pub(super) fn has_friction(model: LinearModel<'_>) -> bool {
    let LumpedModel { stiffness, dampers, .. } = model.model();
    model.friction().any(|friction| friction.coefficient != 0.0)
        || !stiffness.is_symmetric()
        || !dampers.is_symmetric()
}

/// The largest steps of a state's modes, each with `true` if the mode has coalesced.
pub(super) fn limits(
    model: LinearModel<'_>,
    states: &[ContactState],
) -> Result<Vec<(f64, bool)>, Error> {
    if model.model().dampers.is_empty() {
        let squares = squares(model, states, by_schur)?.into_iter();
        return Ok(squares.map(|s| (mode_limit(model.model().damping, s), s.im != 0.0)).collect());
    }
    model.reduced(states).iter().map(damped_step::limit).collect()
}

/// The eigenvalues s of M̃⁻¹ K̃, 1/s²; real ones with an exact zero for their imaginary part.
pub(super) fn squares(
    model: LinearModel<'_>,
    states: &[ContactState],
    solver: Solver,
) -> Result<Vec<Complex<f64>>, Error> {
    let failed = || {
        Error::step_too_large(format!(
            "no critical step is known: the eigenvalues of contact state {} were not found",
            JoinedStates(states)
        ))
    };
    // A state that determines no motion sets no limit.
    let Some(reduced) = model.reduced(states) else { return Ok(Vec::new()) };
    if reduced.mass.nrows() == 0 {
        return Ok(Vec::new());
    }
    let matrix = reduced.mass.lu().solve(&reduced.stiffness).ok_or_else(failed)?;
    let found = solver(matrix).ok_or_else(failed)?;
    // Rounding parts a double real eigenvalue into a pair by the root of the precision.
    let cleaned = |value: &Complex<f64>| {
        let is_real = value.im.abs() <= 1e-7 * value.re.abs();
        if is_real { Complex::new(value.re, 0.0) } else { *value }
    };
    Ok(found.iter().map(cleaned).collect())
}

/// The step at which a real mode of these sizes leaves the unit circle.
fn real_limit(damping: Damping, sizes: Sizes) -> f64 {
    let (square, dampers) = (sizes.largest_square(), sizes.dampers);
    let rate = damping.alpha + damping.beta * square + dampers;
    // Without a frequency and without damping this is infinite, as it should be.
    4.0 / (rate + (rate * rate + 4.0 * square).sqrt())
}

/// The largest step of one mode.
fn mode_limit(damping: Damping, square: Complex<f64>) -> f64 {
    if square.im == 0.0 {
        // A real mode that diverges grows at any step, as the physics does.
        let sizes = Sizes { square: square.re, dampers: 0.0, ellipse: None };
        return if square.re > 0.0 { real_limit(damping, sizes) } else { f64::INFINITY };
    }
    let rate = square * damping.beta + damping.alpha;
    let end = end_of_complex(square);
    step_search::largest(end, |step| is_admissible(step, rate, square))
}

/// `true` if a step is at most the largest one of a mode.
fn mode_reaches(step: f64, damping: Damping, square: Complex<f64>) -> bool {
    if square.im == 0.0 {
        return step <= mode_limit(damping, square);
    }
    // Rounding decides whether modes that are about to coalesce are real: both limits are required.
    let is_nearly_real = square.im.abs() <= 1e-6 * square.re.abs();
    if is_nearly_real && step > mode_limit(damping, Complex::new(square.re, 0.0)) {
        return false;
    }
    let rate = square * damping.beta + damping.alpha;
    let end = end_of_complex(square);
    step_search::reaches(step, end, |step| is_admissible(step, rate, square))
}

/// Upper bound of the admissible steps of a complex mode, s.
fn end_of_complex(square: Complex<f64>) -> f64 {
    2.0 / modulus(square).sqrt()
}

/// `true` if the scheme lets a mode λ² + c λ + s = 0 with c = `rate` grow no faster than the physics, but for
/// [`INVENTED_GROWTH`].
fn is_admissible(step: f64, rate: Complex<f64>, square: Complex<f64>) -> bool {
    let physical = roots(rate, square);
    let numerical =
        roots(square * (step * step) + rate * step - 2.0, Complex::new(1.0, 0.0) - rate * step);
    let growth = physical.iter().fold(0.0, |growth, lambda| f64::max(growth, lambda.re));
    let size = physical.iter().fold(0.0, |size, lambda| f64::max(size, modulus(*lambda)));
    let factor = numerical.iter().fold(0.0, |factor, z| f64::max(factor, modulus(*z)));
    libm::log(factor) <= step * (growth + INVENTED_GROWTH * size)
}

/// The roots of x² + b x + c = 0.
fn roots(b: Complex<f64>, c: Complex<f64>) -> [Complex<f64>; 2] {
    let root = root(b * b - c * 4.0);
    [(-b + root) * 0.5, (-b - root) * 0.5]
}

/// `true` if the step is admissible for every mode, real or complex, of up to these sizes. Without friction all modes
/// are real.
pub(super) fn all_admissible(step: f64, damping: Damping, sizes: Sizes, friction: bool) -> bool {
    const ANGLES: u32 = 32;
    const SIZES: u32 = 12;
    if step > real_limit(damping, sizes) {
        return false;
    }
    let on_circle = |size: f64, angle: u32| {
        from_polar(size, std::f64::consts::PI * f64::from(angle) / f64::from(ANGLES))
    };
    // Discrete dampers add to c any number up to their size, in any direction.
    let added = [1.0, 0.25, 0.0625].into_iter().flat_map(|part| {
        (0..2 * ANGLES).step_by(4).map(move |angle| on_circle(part * sizes.dampers, angle))
    });
    let admits: &dyn Fn(Complex<f64>, Complex<f64>) -> bool = &|rate, square| {
        is_admissible(step, rate, square)
            && (sizes.dampers == 0.0
                || added.clone().all(|added| is_admissible(step, rate + added, square)))
    };
    let admits_all = |point: &dyn Fn(f64, u32) -> Complex<f64>| {
        (0..SIZES).all(|size| {
            let part = libm::ldexp(1.0, -size.cast_signed());
            (1..=ANGLES).all(|angle| {
                let square = point(part, angle);
                admits(square * damping.beta + damping.alpha, square)
            })
        })
    };
    let angle = |angle: u32| std::f64::consts::PI * f64::from(angle) / f64::from(ANGLES);
    !friction
        || (sizes.square.is_finite() && admits_all(&|part, i| on_circle(part * sizes.square, i)))
        || sizes.ellipse.is_some_and(|ellipse| admits_all(&|part, i| ellipse.point(part, angle(i))))
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
            dampers: SparseMatrix::zero(1),
            load: vec![0.0],
            contacts: vec![],
            law: crate::contact::ContactLaw::default(),
        };
        let omega = (k / m).sqrt();
        let zeta = 0.5 * (alpha / omega + beta * omega);
        let expected = 2.0 / omega * ((1.0 + zeta * zeta).sqrt() - zeta);
        let found = critical_step(&model).unwrap();
        assert!((found.step - expected).abs() < 1e-14 * expected);
    }

    #[test]
    fn set_1_at_low_friction_is_limited_by_the_highest_mode_of_the_detached_state() {
        // Dt–Dt has the same modes at every µ; Table 2: −5.08 ± 232.00i Hz.
        let found = critical_step(&set1().with_friction(0.5)).unwrap();
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
        let found = critical_step(&set1()).unwrap();
        let states = vec![ContactState::Slide; 2];
        assert_eq!(found.origin, Origin::State { states, coalesced: true });
    }

    #[test]
    fn a_structure_with_redundant_contacts_has_a_critical_step() {
        let mut model = set1().with_friction(0.5);
        model.contacts[1] = model.contacts[0].clone();
        assert!(critical_step(&model).unwrap().step > 1e-5);
    }

    #[test]
    fn many_contacts_get_a_bound_whether_they_share_masses_or_not() {
        let mut scene = builtin("set1").unwrap().scene();
        let module = scene.modules()[0];
        *scene.modules_mut() = vec![module; 7];
        let mut model = LumpedModel::from(&scene).with_friction(0.3);
        let free = critical_step(&model).unwrap();
        assert_eq!(free.origin, Origin::Bound);
        // A normal that all share leaves each contact no coordinate of its own, but a few of them have a bound.
        let first = model.contacts[0].clone();
        let shared = |dof| Contact {
            normal: Direction::unit(dof),
            tangent: Direction(vec![(2, 0.6), (6, 0.8)]),
            ..first.clone()
        };
        model.contacts[..1].clone_from_slice(&[3].map(shared));
        let found = critical_step(&model).unwrap();
        assert!(found.origin == Origin::Bound && found.step > 0.1 * free.step, "{found}");
        model.contacts = [3, 7, 11, 15, 19, 23, 27].map(shared).to_vec();
        assert!(critical_step(&model).is_ok());
        // So much friction may jam them.
        let said = critical_step(&model.with_friction(4.0)).unwrap_err().to_string();
        assert!(said.contains("may jam"), "{said}");
    }

    /// Set 1 with dampers from each m2 along the tangent to the ground, and one between the m1.
    fn damped(strength: f64) -> LumpedModel {
        let mut model = set1();
        let links = [(0, 0, 1.0), (4, 4, 1.0), (0, 4, -1.0), (4, 0, -1.0)];
        let entries = [(2, 2, 1.0), (6, 6, 0.5)].into_iter().chain(links);
        let entries = entries.map(|(i, j, d)| (i, j, strength * d)).collect();
        model.dampers = SparseMatrix::from_entries(model.dofs(), entries);
        model
    }

    /// The spectral radius of one step of a contact state, from the printed equations.
    fn radius(model: &LumpedModel, states: &[ContactState], h: f64) -> f64 {
        let reduced = model.linear().unwrap().reduced(states).unwrap();
        let n = reduced.mass.nrows();
        let inverse = reduced.mass.clone().try_inverse().unwrap();
        let (k, c) = (&inverse * reduced.stiffness * h, &inverse * reduced.damping * h);
        let one = nalgebra::DMatrix::identity(n, n);
        let mut step = nalgebra::DMatrix::zeros(2 * n, 2 * n);
        step.view_mut((0, 0), (n, n)).copy_from(&(&one - &k * h));
        step.view_mut((0, n), (n, n)).copy_from(&((&one - &c) * h));
        step.view_mut((n, 0), (n, n)).copy_from(&-&k);
        step.view_mut((n, n), (n, n)).copy_from(&(&one - &c));
        step.complex_eigenvalues().iter().fold(0.0, |r, z| f64::max(r, z.norm()))
    }

    #[test]
    fn single_dampers_set_the_limit_where_the_step_leaves_the_unit_circle() {
        for strength in [1.0, 300.0, 1e4] {
            let model = damped(strength).with_friction(0.0);
            let found = critical_step(&model).unwrap();
            let Origin::State { states, coalesced: false } = &found.origin else {
                panic!("{found}")
            };
            assert!(radius(&model, states, 0.999 * found.step) <= 1.0 + 1e-9, "{found}");
            assert!(radius(&model, states, 1.001 * found.step) > 1.0 + 1e-9, "{found}");
            for states in all_states(2) {
                assert!(radius(&model, &states, 0.999 * found.step) <= 1.0 + 1e-9);
            }
            // The bound is never above the critical step, and more than 0.3 of it.
            let linear = model.linear().unwrap();
            let bound = FrequencyBound::new(linear).unwrap().at(linear);
            let bound = real_limit(model.damping, bound);
            assert!(bound <= found.step && bound > 0.3 * found.step, "{bound} {found}");
        }
    }

    #[test]
    fn a_damper_that_is_rayleigh_damping_in_disguise_has_the_same_limit() {
        // D = α M in place of α: the two ways to the limit have little in common.
        for mu in [0.3, 1.96] {
            let (mut rayleigh, mut single) = (set1().with_friction(mu), set1().with_friction(mu));
            rayleigh.damping.alpha = 40.0;
            let entries = rayleigh.mass.entries().map(|(i, j, m)| (i, j, 40.0 * m)).collect();
            single.dampers = SparseMatrix::from_entries(8, entries);
            let [a, b] = [&rayleigh, &single].map(|model| critical_step(model).unwrap());
            assert!((a.step / b.step - 1.0).abs() < 0.05, "{a} {b}");
            let linear = single.linear().unwrap();
            let sizes = FrequencyBound::new(linear).unwrap().at(linear);
            let bound = step_search::largest(real_limit(single.damping, sizes), |h| {
                all_admissible(h, single.damping, sizes, true)
            });
            assert!(bound <= a.step, "{bound} {a}");
        }
    }
}
