//! The guard that refuses steps above the critical one during a run.

use super::alike_states;
use super::critical_step::{
    Origin, all_admissible, can_be_enumerated, critical_step, has_friction, is_reached,
    state_admits,
};
use super::frequency_bound::{FrequencyBound, Sizes};
use super::step_search::largest;
use crate::Error;
use crate::contact::ContactState;
use crate::model::{Contact, Damping, LinearModel, LumpedModel, SlidingFriction};

/// Check of a step against the critical one, repeated as µ and the damping change. A check with unchanged friction and
/// damping costs nothing. A bound is evaluated first. It costs one pass over the degrees of freedom where contacts
/// share no masses, and allocates nothing there. After it has failed it is left out for some checks, and the states are
/// examined at once. Of these only those are examined in which a contact slides whose friction has changed since all
/// states last admitted the step. Each is examined for this step alone; its limit is found only for the message of a
/// refusal.
///
/// ```
/// use amontons::model::LumpedModel;
/// use amontons::stability::StepGuard;
///
/// let scene = amontons::scene::builtin("set1").expect("a built-in scene").scene();
/// let model = LumpedModel::from(&scene);
/// assert!(StepGuard::new(&model, 1e-6).check(&model).is_ok());
/// assert!(StepGuard::new(&model, 1.0).check(&model).is_err());
/// ```
#[derive(Clone, Debug)]
pub struct StepGuard {
    step: f64,
    bound: Option<FrequencyBound>,
    /// The damping for which `admissible` was computed.
    damping: Damping,
    /// The largest bound of the eigenvalues at which the step is admissible with friction, 1/s². That of discrete
    /// dampers grows in proportion with it.
    admissible: f64,
    /// The friction of each contact and the damping when all states were last found to admit the step.
    admitted: Option<(Vec<SlidingFriction>, Damping)>,
    /// The friction of each contact with which the step was last admitted; valid while `is_known`.
    last: Vec<SlidingFriction>,
    is_known: bool,
    /// Number of checks without the bound since it failed, and the number after which the bound is evaluated again.
    left_out: u32,
    to_leave_out: u32,
}

/// Largest number of successive checks that leave out the bound after it has failed.
const MOST_LEFT_OUT: u32 = 63;

/// Rounding may move a limit by this part of itself. A step that is nearer to it is compared with the printed limit.
const ROUNDING: f64 = 1e-5;

/// Friction and damping beyond the present ones for which the states of a full mass matrix are examined ahead, as a part of them, and
/// friction added to that.
const ROOM: f64 = 0.1;
const LEAST_ROOM: f64 = 0.01;

impl StepGuard {
    /// A guard of this step (s) for this model; sharpest near its present µ.
    #[must_use]
    pub fn new(model: &LumpedModel, step: f64) -> Self {
        let bound = FrequencyBound::new(model.with_greatest_friction());
        let damping = model.damping;
        let mut guard = Self {
            step,
            bound,
            damping,
            admissible: 0.0,
            admitted: None,
            last: Vec::with_capacity(model.contacts.len()),
            is_known: false,
            left_out: 0,
            to_leave_out: 0,
        };
        guard.set_damping(model.damping);
        guard
    }

    fn set_damping(&mut self, damping: Damping) {
        // No real mode above (2/h)² is admissible.
        let end = 4.0 / (self.step * self.step);
        (self.damping, self.is_known) = (damping, false);
        let Some(bound) = &self.bound else { return };
        let dampers = bound.dampers_against_stiffness();
        let admits = |square: f64| {
            all_admissible(
                self.step,
                damping,
                Sizes { square, dampers: dampers * square, ellipse: None },
                true,
            )
        };
        // Discrete dampers make the check some dozens of times longer: a search from above rejects most sizes quickly,
        // and the first admissible size covers all smaller ones.
        self.admissible = match dampers {
            0.0 => largest(end, admits),
            _ => {
                let sizes = std::iter::successors(Some(end), |square| Some(0.9 * square));
                sizes.take(200).find(|square| admits(*square)).unwrap_or(0.0)
            }
        };
    }

    /// Makes sure that the step is at most the critical one, with the greatest µ that each contact can have in slip.
    /// `model` is the one that the guard was made for, but for its damping and its friction.
    ///
    /// # Errors
    /// Returns an error with the step, the limit, and the state that sets it.
    pub fn check(&mut self, model: &LumpedModel) -> Result<(), Error> {
        let linear = model.with_greatest_friction();
        if self.damping != model.damping {
            self.set_damping(model.damping);
        }
        if self.is_known && linear.friction().eq(self.last.iter().copied()) {
            return Ok(());
        }
        // If states are not examined one by one, their bound is the only answer.
        let is_first = self.bound_is_due() || !can_be_enumerated(model);
        if (is_first && self.bound_suffices(linear))
            || self.states_admit(linear)
            || (!is_first && self.bound_suffices(linear))
        {
            self.note(linear);
            return Ok(());
        }
        let critical = critical_step(model)?;
        if self.step <= critical.step {
            self.note(linear);
            return Ok(());
        }
        let step = self.step;
        Err(Error::step_too_large(match critical.origin {
            Origin::State { .. } | Origin::Alike => format!(
                "integrator.step = {step:e} s is above the critical step, {critical}; \
                 choose a smaller step"
            ),
            Origin::Bound => format!(
                "integrator.step = {step:e} s may be above the critical step, which is {critical}; \
                 choose a step of at most that value"
            ),
        }))
    }

    /// Stores that the step is admitted with this friction.
    fn note(&mut self, model: LinearModel<'_>) {
        self.last.clear();
        self.last.extend(model.friction());
        self.is_known = true;
    }

    /// `true` if the bound is evaluated before the states this time; counts the checks without it. Where contacts share
    /// masses it takes as long as some states. So each failure makes it rarer.
    fn bound_is_due(&mut self) -> bool {
        let is_due = self.left_out == self.to_leave_out;
        self.left_out = if is_due { 0 } else { self.left_out + 1 };
        is_due
    }

    /// `true` if the bound is enough to admit the step.
    fn bound_suffices(&mut self, model: LinearModel<'_>) -> bool {
        let suffices = self.bound.as_ref().is_some_and(|bound| {
            let sizes = bound.at(model);
            let friction = has_friction(model);
            sizes.square <= self.admissible
                || ((!friction || sizes.ellipse.is_some())
                    && all_admissible(self.step, model.model().damping, sizes, friction))
        });
        let more = (2 * self.to_leave_out + 1).min(MOST_LEFT_OUT);
        (self.left_out, self.to_leave_out) = (0, if suffices { 0 } else { more });
        suffices
    }

    /// `true` if the states of a model with a full mass matrix admit the step. Each examination takes a good part of a second, so it
    /// looks ahead to somewhat more friction and damping, and holds for less. More friction may have an equilibrium with other open
    /// contacts, so the state of the present one is examined with both.
    fn full_states_admit(&mut self, linear: LinearModel<'_>) -> bool {
        let is_less = |(now, before): (SlidingFriction, &SlidingFriction)| {
            now.coefficient <= before.coefficient
        };
        let Damping { alpha, beta } = linear.model().damping;
        if self.admitted.as_ref().is_some_and(|(friction, damping)| {
            let is_less_damped = alpha <= damping.alpha && beta <= damping.beta;
            is_less_damped && linear.friction().zip(friction).all(is_less)
        }) {
            return true;
        }
        let mut rougher = linear.model().clone();
        rougher.damping = Damping { alpha: (1.0 + ROOM) * alpha, beta: (1.0 + ROOM) * beta };
        let more = |coefficient: f64| (1.0 + ROOM) * coefficient + LEAST_ROOM;
        for Contact { friction, .. } in &mut rougher.contacts {
            (friction.kinetic, friction.static_) = (more(friction.kinetic), more(friction.static_));
        }
        let step = (1.0 + ROUNDING) * self.step;
        let mut models = [rougher.with_greatest_friction(), linear].into_iter();
        let at_rest = alike_states::at_rest(linear.model());
        let admits_rest = |model: LinearModel<'_>| {
            at_rest.iter().all(|states| state_admits(step, model, states).unwrap_or(false))
        };
        let admitted =
            models.find(|model| is_reached(step, *model, |_| true) && admits_rest(*model));
        self.admitted = admitted.map(|it| (it.friction().collect(), it.model().damping));
        admitted.is_some()
    }

    /// `true` if all states admit the step; their friction is then stored.
    fn states_admit(&mut self, model: LinearModel<'_>) -> bool {
        if model.model().mass.as_diagonal().is_none() && !can_be_enumerated(model.model()) {
            return self.full_states_admit(model);
        }
        let damping = model.model().damping;
        let before = self.admitted.as_ref().filter(|(_, before)| *before == damping);
        let before = before.map(|(friction, _)| &**friction);
        let is_new =
            |(i, now): (usize, SlidingFriction)| before.is_none_or(|before| before[i] != now);
        let new: Vec<bool> = model.friction().enumerate().map(is_new).collect();
        let concerns = |states: &[ContactState]| {
            let slides = |state: &ContactState| state.sliding_direction().is_some();
            before.is_none()
                || states.iter().zip(&new).any(|(state, is_new)| *is_new && slides(state))
        };
        let admit = is_reached((1.0 + ROUNDING) * self.step, model, concerns);
        if admit {
            self.admitted = Some((model.friction().collect(), damping));
        }
        admit
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::SparseMatrix;
    use crate::scene::builtin;
    use crate::stability::bound_tests::{ContactShape, any_numbers, model};
    use proptest::prelude::*;

    fn set1() -> LumpedModel {
        LumpedModel::from(&builtin("set1").unwrap().scene())
    }

    #[test]
    fn a_step_above_the_limit_is_refused_with_the_limit_and_its_state() {
        let model = set1();
        let limit = critical_step(&model).unwrap().step;
        assert!(StepGuard::new(&model, 0.999 * limit).check(&model).is_ok());
        let mut above = StepGuard::new(&model, 1.001 * limit);
        let error = above.check(&model).unwrap_err();
        assert!(error.is_step_too_large() && error.to_string().contains("Sl-Sl"), "{error}");
        // Without friction no modes coalesce, and the same step is fine.
        assert!(above.check(&model.with_friction(0.0)).is_ok());
    }

    /// A model, with dampers or without, and the friction of its contacts, `None` where it is the common one.
    fn any_model() -> impl Strategy<Value = (LumpedModel, Vec<Option<f64>>)> {
        let shapes = vec![
            ContactShape::Disc,
            ContactShape::Tangled,
            ContactShape::Chain,
            ContactShape::OneMass,
        ];
        let damping = (0.0..30.0_f64, 0.0..1e-4_f64, prop::option::of(0.1..100.0_f64));
        let own = prop::collection::vec(prop::option::of(0.0..1.0_f64), 3);
        let shape = prop::sample::select(shapes);
        (shape, 1_usize..=2, any_numbers(), damping, own).prop_map(
            |(shape, contacts, numbers, (alpha, beta, damper), own)| {
                let mut model = model(shape, contacts, &numbers);
                model.damping = Damping { alpha, beta };
                if let Some(damper) = damper {
                    let entries = [(0, 0, damper), (1, 1, 0.3 * damper)].to_vec();
                    model.dampers = SparseMatrix::from_entries(model.dofs(), entries);
                }
                (model, own)
            },
        )
    }

    fn set_friction(model: &mut LumpedModel, common: f64, own: &[Option<f64>]) {
        for (contact, own) in model.contacts.iter_mut().zip(own) {
            contact.friction = own.unwrap_or(common).into();
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn a_step_is_refused_where_it_is_above_the_limit_of_the_present_friction(
            (mut model, mut own) in any_model(),
            frictions in prop::collection::vec((0.0..1.0_f64, 0_usize..4, prop::option::of(0.0..1.0_f64)), 8),
            part in prop_oneof![0.3..1.3_f64, 1.0 - 1e-5..1.0 + 1e-5, Just(1.0)],
        ) {
            // Where a state jams there is none.
            set_friction(&mut model, frictions[0].0, &own);
            let first = critical_step(&model).map_or(1e-4, |critical| critical.step);
            let step = part * first;
            let mut guard = StepGuard::new(&model, step);
            for (common, contact, value) in frictions {
                if let Some(own) = own.get_mut(contact) {
                    *own = value;
                }
                set_friction(&mut model, common, &own);
                let critical = critical_step(&model);
                let admits = critical.as_ref().is_ok_and(|critical| step <= critical.step);
                let said = critical.map_or_else(|error| error.to_string(), |critical| critical.to_string());
                for _ in 0..2 {
                    match guard.check(&model) {
                        Ok(()) => prop_assert!(admits, "{} {}", step, said),
                        Err(error) => {
                            prop_assert!(!admits && error.to_string().contains(&said), "{} {}", error, said);
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn friction_that_changes_at_each_step_is_checked_in_little_time() {
        let numbers: Vec<f64> = (1..200).map(|i| (0.618_034 * f64::from(i)).fract()).collect();
        let mut model = model(ContactShape::Disc, 3, &numbers);
        model.dampers = SparseMatrix::from_entries(model.dofs(), vec![(0, 0, 10.0)]);
        let rubbing = |i: u32| model.clone().with_friction(0.3 + 1e-4 * f64::from(i));
        let models: Vec<LumpedModel> = (0..20).map(rubbing).collect();
        let limit = critical_step(&models[0]).unwrap().step;
        let mut guard = StepGuard::new(&models[0], 0.2 * limit);
        let begun = std::time::Instant::now();
        models.iter().for_each(|model| guard.check(model).unwrap());
        let changing = begun.elapsed().as_secs_f64();
        (0..1000).for_each(|_| guard.check(&models[19]).unwrap());
        let constant = begun.elapsed().as_secs_f64() - changing;
        println!("{changing} s for 20 values, {constant} s for the same one 1000 times");
        assert!(changing < 2.0 && constant < 0.5, "{changing} s, {constant} s");
    }
}
