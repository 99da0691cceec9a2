//! Gauss–Seidel over the contacts (paper, eqs. 19–24).

use super::delassus::Delassus;
use super::freedom::Freedom;
use crate::contact::{ContactState, LocalProblem, LocalSolution};
use crate::integrator::StepFailure;

/// Convergence check (24): the largest change of a multiplier in a sweep against the largest one.
const TOLERANCE: f64 = 1e-13;
/// More sweeps than a well-posed problem of any size met in practice takes.
const MAX_SWEEPS: u64 = 10_000;

/// The contact problem a = W λ + free under the Signorini–Coulomb law of every contact.
///
/// λ holds (N, T) of each contact, N. W = G M⁻¹ Gᵀ is the Delassus matrix, 1/kg.
pub(super) struct Multipliers {
    pub(super) delassus: Delassus,
    /// The accelerations that the contacts would have without their forces, m/s².
    pub(super) free: Vec<[f64; 2]>,
    /// What each contact may do.
    pub(super) freedom: Vec<Freedom>,
    /// The solution λ.
    pub(super) forces: Vec<[f64; 2]>,
    /// The states that belong to it.
    pub(super) states: Vec<ContactState>,
    /// The contacts that share no mass with others, and those that do; both ascending.
    alone: Vec<usize>,
    coupled: Vec<usize>,
}

impl Multipliers {
    pub(super) fn new(delassus: Delassus) -> Self {
        let contacts = delassus.contacts();
        let (alone, coupled) = (0..contacts).partition(|&i| delassus.others(i).is_empty());
        Self {
            alone,
            coupled,
            delassus,
            free: vec![[0.0; 2]; contacts],
            freedom: vec![Freedom::Open; contacts],
            forces: vec![[0.0; 2]; contacts],
            states: vec![ContactState::Detached; contacts],
        }
    }

    /// Solves for λ from zero, so that a result depends on nothing but the present; returns the
    /// number of sweeps. Redundant contacts (two that stick on one mass) have many solutions; the
    /// one reached from zero is taken, and the motion is the same for all.
    ///
    /// What a contact holds while others let go depends on them, so static friction comes first: all are
    /// solved with their ranges as the limit, then those that slip even so with µ_k against it, and all again.
    /// They may then hold, or slip the other way: what they let go of loads others, which push them back.
    #[inline]
    pub(super) fn solve(&mut self) -> Result<u64, StepFailure> {
        let mut sweeps = self.relax()?;
        while self.let_go() {
            sweeps += self.relax()?;
        }
        Ok(sweeps)
    }

    /// Gives those that slip at a static limit their kinetic friction in that direction; whether there were
    /// any. Each has two limits, so this ends.
    fn let_go(&mut self) -> bool {
        let mut any = false;
        for (freedom, state) in self.freedom.iter_mut().zip(&self.states) {
            if let (Freedom::Law(range) | Freedom::Held(range), Some(direction)) =
                (freedom, state.sliding_direction())
                && range.limit(direction) > range.kinetic
            {
                *range.limit_mut(direction) = range.kinetic;
                any = true;
            }
        }
        any
    }

    /// One solution, with the limits as they are. Contacts that share no mass with others are solved once;
    /// sweeps go over the others.
    #[inline]
    fn relax(&mut self) -> Result<u64, StepFailure> {
        for place in 0..self.alone.len() {
            let contact = self.alone[place];
            (self.forces[contact], self.states[contact]) = self.solve_one(contact, 1)?;
        }
        if self.coupled.is_empty() { Ok(1) } else { self.sweep() }
    }

    /// Solves the contacts that are coupled; those that are not are solved already.
    fn sweep(&mut self) -> Result<u64, StepFailure> {
        for &contact in &self.coupled {
            self.forces[contact] = [0.0; 2];
        }
        let size = |largest: f64, force: &f64| largest.max(force.abs());
        let alone = self.forces.iter().flatten().fold(f64::MIN_POSITIVE, size);
        for sweep in 1..=MAX_SWEEPS {
            let (mut change, mut largest) = (0.0_f64, alone);
            for place in 0..self.coupled.len() {
                let contact = self.coupled[place];
                let (force, state) = self.solve_one(contact, sweep)?;
                self.states[contact] = state;
                for (old, new) in self.forces[contact].iter_mut().zip(force) {
                    change = change.max((new - *old).abs());
                    largest = largest.max(new.abs());
                    *old = new;
                }
            }
            if change <= TOLERANCE * largest {
                return Ok(sweep);
            }
        }
        Err(self.unsettled())
    }

    /// Which contact has not settled: one more sweep looks, so that those that converge need not.
    #[cold]
    fn unsettled(&mut self) -> StepFailure {
        let (mut unsettled, mut change) = (0, 0.0_f64);
        for place in 0..self.coupled.len() {
            let contact = self.coupled[place];
            let force = match self.solve_one(contact, MAX_SWEEPS) {
                Ok((force, _)) => force,
                Err(failure) => return failure,
            };
            for (old, new) in self.forces[contact].iter_mut().zip(force) {
                if (new - *old).abs() > change {
                    (unsettled, change) = (contact, (new - *old).abs());
                }
                *old = new;
            }
        }
        let size = |largest: f64, force: &f64| largest.max(force.abs());
        let largest = self.forces.iter().flatten().fold(f64::MIN_POSITIVE, size);
        StepFailure::NoConvergence {
            sweeps: MAX_SWEEPS,
            contact: unsettled,
            change: change / largest,
            tolerance: TOLERANCE,
        }
    }

    /// Eqs. (19)–(21) for one contact in this sweep: its force, those of the others held, and its state.
    #[inline]
    fn solve_one(
        &self,
        contact: usize,
        sweep: u64,
    ) -> Result<([f64; 2], ContactState), StepFailure> {
        let own = self.delassus.own(contact);
        let local = LocalProblem { nn: own[0], nt: own[1], tt: own[3] };
        let [mut normal, mut tangential] = self.free[contact];
        for &(other, w) in self.delassus.others(contact) {
            let [n, t] = self.forces[other];
            normal += w[0] * n + w[1] * t;
            tangential += w[2] * n + w[3] * t;
        }
        let solution = match &self.freedom[contact] {
            Freedom::Law(range) => Some(local.solve([normal, tangential], range)),
            Freedom::Open => Some(LocalSolution::OPEN),
            &Freedom::Slipping { direction, friction } => local.slide(normal, friction, direction),
            Freedom::Held(range) => local.solve_held([normal, tangential], range),
            &Freedom::HeldSlipping { direction, friction } => {
                local.slide_held(normal, friction, direction)
            }
            Freedom::Fixed => Some(local.fix([normal, tangential])),
            &Freedom::Guided { slope, state } => local.guide(normal, slope, state),
        };
        let LocalSolution { force, state } = solution.ok_or(StepFailure::Wedged { contact })?;
        if !force.iter().all(|force| force.is_finite()) {
            return Err(self.out_of_range(contact, sweep));
        }
        Ok((force, state))
    }

    /// Why a force is no finite number: what acts on the contact is none, or the sweeps diverge.
    #[cold]
    fn out_of_range(&self, contact: usize, sweeps: u64) -> StepFailure {
        if !self.free[contact].iter().all(|free| free.is_finite()) {
            return StepFailure::NotFinite { contact };
        }
        let (change, tolerance) = (f64::INFINITY, TOLERANCE);
        StepFailure::NoConvergence { sweeps, contact, change, tolerance }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::FrictionRange;

    /// Two contacts with µ = 0.5.
    fn with_law(delassus: &[f64]) -> Multipliers {
        let mut problem = Multipliers::new(Delassus::from_rows(2, delassus));
        let range = FrictionRange { backward: 0.5, forward: 0.5, kinetic: 0.5 };
        problem.freedom.fill(Freedom::Law(range));
        problem
    }

    /// Two contacts whose normals are coupled: W_NN = [[2, 1], [1, 2]], tangents alone.
    fn coupled() -> Multipliers {
        #[rustfmt::skip]
        let delassus = vec![
            2.0, 0.0, 1.0, 0.0,
            0.0, 1.0, 0.0, 0.0,
            1.0, 0.0, 2.0, 0.0,
            0.0, 0.0, 0.0, 1.0,
        ];
        with_law(&delassus)
    }

    #[test]
    fn coupled_contacts_converge_to_the_direct_solution() {
        let mut problem = coupled();
        problem.free = vec![[-3.0, 0.1], [-3.6, -9.0]];
        let sweeps = problem.solve().unwrap();
        // [[2, 1], [1, 2]] N = (3, 3.6): N = (0.8, 1.4); the first sticks, the second slips.
        let expected = [[0.8, -0.1], [1.4, 0.7]];
        for (found, expected) in problem.forces.iter().flatten().zip(expected.iter().flatten()) {
            assert!((found - expected).abs() < 1e-12);
        }
        assert!(sweeps > 2);
    }

    #[test]
    fn a_contact_that_its_neighbour_lifts_opens() {
        let mut problem = coupled();
        // Alone the second would press with 0.5; the first's 2 N lift it.
        problem.free = vec![[-4.0, 0.0], [-1.0, 0.0]];
        problem.solve().unwrap();
        assert!((problem.forces[0][0] - 2.0).abs() < 1e-12);
        assert_eq!(problem.forces[1], [0.0, 0.0]);
    }

    #[test]
    fn redundant_sticking_contacts_share_the_load() {
        // Two contacts at the same place of one mass: W has rank two, not four.
        #[rustfmt::skip]
        let delassus = vec![
            1.0, 0.0, 1.0, 0.0,
            0.0, 1.0, 0.0, 1.0,
            1.0, 0.0, 1.0, 0.0,
            0.0, 1.0, 0.0, 1.0,
        ];
        let mut problem = with_law(&delassus);
        problem.free = vec![[-2.0, 0.3]; 2];
        problem.solve().unwrap();
        let total: f64 = problem.forces.iter().map(|force| force[0]).sum();
        let friction: f64 = problem.forces.iter().map(|force| force[1]).sum();
        assert!((total - 2.0).abs() < 1e-12 && (friction + 0.3).abs() < 1e-12);
    }

    #[test]
    fn what_does_not_converge_is_reported_with_its_sweeps() {
        // Friction couples the two contacts in a ring with a gain above one.
        #[rustfmt::skip]
        let delassus = vec![
            1.0, 0.0, 0.0, 3.0,
            0.0, 9.0, 3.0, 0.0,
            0.0, 3.0, 1.0, 0.0,
            3.0, 0.0, 0.0, 9.0,
        ];
        let mut problem = with_law(&delassus);
        problem.freedom = vec![Freedom::Slipping { direction: -1.0, friction: 0.5 }; 2];
        problem.free = vec![[-1.0, 0.0]; 2];
        let failure = problem.solve().unwrap_err();
        // The forces grow by 1.5² a sweep, beyond the range of numbers.
        assert!(
            matches!(failure, StepFailure::NoConvergence { sweeps: 2..1000, change, .. } if change.is_infinite())
        );
    }

    #[test]
    fn what_converges_too_slowly_is_reported_with_the_contact_that_changed_most() {
        let r = 1.0 - 1e-5;
        #[rustfmt::skip]
        let delassus = vec![
            1.0, 0.0, r, 0.0,
            0.0, 1.0, 0.0, 0.0,
            r, 0.0, 1.0, 0.0,
            0.0, 0.0, 0.0, 1.0,
        ];
        let mut problem = with_law(&delassus);
        problem.free = vec![[-1.0, 0.0]; 2];
        let failure = problem.solve().unwrap_err();
        // From zero N₁ = (1 + r r²ᵏ)/(1 + r) after k + 1 sweeps; N₂ = 1 − r N₁ changes by less.
        let left = r * r.powf(2e4);
        let expected = left * (1.0 - r * r) / (1.0 + left);
        let StepFailure::NoConvergence { sweeps: 10_000, contact: 0, change, tolerance } = failure
        else {
            panic!("{failure:?}");
        };
        assert!((change / expected - 1.0).abs() < 1e-3, "{change} {expected}");
        assert_eq!(tolerance, 1e-13);
    }

    #[test]
    fn what_acts_on_a_contact_and_is_no_finite_number_is_reported_with_it() {
        let mut problem = coupled();
        problem.free = vec![[-3.0, 0.1], [f64::NEG_INFINITY, 0.0]];
        assert_eq!(problem.solve(), Err(StepFailure::NotFinite { contact: 1 }));
    }
}
