//! The Signorini–Coulomb law of one contact against its own block of the Delassus matrix.

use super::{ContactState, FrictionRange};

/// Block of the Delassus matrix G M⁻¹ Gᵀ that belongs to one contact, 1/kg: normal–normal,
/// normal–tangential, tangential–tangential.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalProblem {
    /// W_NN.
    pub nn: f64,
    /// W_NT.
    pub nt: f64,
    /// W_TT.
    pub tt: f64,
}

/// The multipliers of one contact, and the state that they belong to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalSolution {
    /// (N, T), N.
    pub force: [f64; 2],
    /// Dt where N is zero.
    pub state: ContactState,
}

impl LocalSolution {
    /// Of a contact that carries nothing.
    pub const OPEN: Self = Self { force: [0.0; 2], state: ContactState::Detached };
}

impl LocalProblem {
    /// The multipliers (N, T), in N, of the law
    ///
    /// 0 ≤ a_N ⊥ N ≥ 0, T/N in `range` with a_T = 0, or at its end against a_T, with
    /// a = W (N, T) + `free`,
    ///
    /// where `free` holds the normal and tangential accelerations (m/s²) without this contact.
    /// The cases are tried in turn: open, stick, slide. W is positive definite, so one of them holds.
    #[inline]
    #[must_use]
    pub fn solve(&self, free: [f64; 2], range: &FrictionRange) -> LocalSolution {
        let [free_normal, free_tangential] = free;
        if free_normal >= 0.0 {
            return LocalSolution::OPEN;
        }
        if let Some(held) = self.stick(free, range) {
            return held;
        }
        // A mass that lags behind the slider (a_T < 0) is dragged along (T > 0), and the other way
        // round. Where rounding lets neither pass, friction opposes what the free motion would do.
        let slides = |direction: f64| {
            let solution = self.slide(free_normal, range.limit(direction), direction)?;
            let [normal, tangential] = solution.force;
            let acceleration = free_tangential + self.nt * normal + self.tt * tangential;
            (acceleration * direction <= 0.0).then_some(solution)
        };
        let against = if free_tangential > 0.0 { -1.0 } else { 1.0 };
        slides(1.0)
            .or_else(|| slides(-1.0))
            .or_else(|| self.slide(free_normal, range.limit(against), against))
            .unwrap_or(LocalSolution { force: [f64::NAN; 2], state: ContactState::Stick })
    }

    /// The multipliers of a contact that does slip, with `friction` = µ_k in the given direction (±1);
    /// `None` where it wedges (Painlevé): friction then presses the mass on more than it is
    /// pressed, W_NN ± µ W_NT ≤ 0.
    #[inline]
    #[must_use]
    pub fn slide(&self, free_normal: f64, friction: f64, direction: f64) -> Option<LocalSolution> {
        let slope = direction * friction;
        let stiffness = self.nn + slope * self.nt;
        if free_normal >= 0.0 {
            return Some(LocalSolution::OPEN);
        }
        (stiffness > 0.0).then(|| {
            let normal = -free_normal / stiffness;
            LocalSolution { force: [normal, slope * normal], state: slipping(direction) }
        })
    }

    /// As [`solve`](Self::solve), of a contact that holds in both directions: a_N = 0, N of either sign, and
    /// friction follows |N|. `None` where it wedges.
    #[must_use]
    pub fn solve_held(&self, free: [f64; 2], range: &FrictionRange) -> Option<LocalSolution> {
        let force = self.hold(free);
        let [normal, tangential] = force;
        if range.holds(tangential, normal.abs()) {
            return Some(LocalSolution { force, state: ContactState::Stick });
        }
        let slides = |direction: f64| {
            let solution = self.slide_held(free[0], range.limit(direction), direction)?;
            let [normal, tangential] = solution.force;
            let acceleration = free[1] + self.nt * normal + self.tt * tangential;
            (direction * acceleration <= 0.0).then_some(solution)
        };
        // What would hold it says where it goes, but for rounding.
        let direction = tangential.signum();
        slides(direction)
            .or_else(|| slides(-direction))
            .or_else(|| self.slide_held(free[0], range.limit(direction), direction))
    }

    /// As [`slide`](Self::slide), of a contact that holds in both directions.
    #[must_use]
    pub fn slide_held(
        &self,
        free_normal: f64,
        friction: f64,
        direction: f64,
    ) -> Option<LocalSolution> {
        let state = slipping(direction);
        let sign = if free_normal > 0.0 { -1.0 } else { 1.0 };
        self.guide(free_normal, sign * direction * friction, state)
    }

    /// The multipliers of a contact that holds in both directions, with T = `slope` N; `None` where it wedges.
    #[must_use]
    pub fn guide(
        &self,
        free_normal: f64,
        slope: f64,
        state: ContactState,
    ) -> Option<LocalSolution> {
        let stiffness = self.nn + slope * self.nt;
        let normal = -free_normal / stiffness;
        (stiffness > 0.0).then_some(LocalSolution { force: [normal, slope * normal], state })
    }

    /// The multipliers of a contact that is held along normal and tangent, whatever that takes.
    #[must_use]
    pub fn fix(&self, free: [f64; 2]) -> LocalSolution {
        LocalSolution { force: self.hold(free), state: ContactState::Stick }
    }

    /// (N, T) that keep the contact closed and stuck.
    fn hold(&self, [free_normal, free_tangential]: [f64; 2]) -> [f64; 2] {
        let determinant = self.nn * self.tt - self.nt * self.nt;
        let normal = (self.nt * free_tangential - self.tt * free_normal) / determinant;
        [normal, (self.nt * free_normal - self.nn * free_tangential) / determinant]
    }

    /// The multipliers that hold the contact, if friction can.
    fn stick(&self, free: [f64; 2], range: &FrictionRange) -> Option<LocalSolution> {
        let [normal, tangential] = self.hold(free);
        let state = if normal > 0.0 { ContactState::Stick } else { ContactState::Detached };
        let held = normal >= 0.0 && range.holds(tangential, normal);
        held.then_some(LocalSolution { force: [normal, tangential], state })
    }
}

fn slipping(direction: f64) -> ContactState {
    if direction > 0.0 { ContactState::Slide } else { ContactState::ReverseSlide }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ContactState::{ReverseSlide, Slide, Stick};

    const W: LocalProblem = LocalProblem { nn: 2.0, nt: 0.0, tt: 4.0 };

    fn coulomb(friction: f64) -> FrictionRange {
        FrictionRange { backward: friction, forward: friction, kinetic: friction }
    }

    #[test]
    fn a_contact_that_opens_carries_nothing() {
        assert_eq!(W.solve([0.1, 5.0], &coulomb(0.3)), LocalSolution::OPEN);
    }

    #[test]
    fn stick_where_friction_can_hold_and_slide_where_it_cannot() {
        for (free, force, state) in [
            ([-4.0, 1.0], [2.0, -0.25], Stick),
            ([-4.0, 8.0], [2.0, -1.0], ReverseSlide),
            ([-4.0, -8.0], [2.0, 1.0], Slide),
        ] {
            assert_eq!(W.solve(free, &coulomb(0.5)), LocalSolution { force, state });
        }
    }

    #[test]
    fn what_static_friction_lets_go_is_at_its_limit() {
        let range = FrictionRange { kinetic: 0.25, ..coulomb(0.5) };
        let held = LocalSolution { force: [2.0, -1.0], state: Stick };
        assert_eq!(W.solve([-4.0, 4.0], &range), held);
        let slips = LocalSolution { force: [2.0, -1.0], state: ReverseSlide };
        assert_eq!(W.solve([-4.0, 4.1], &range), slips);
    }

    #[test]
    fn a_mass_that_slips_can_wedge_but_one_that_is_free_to_stick_cannot() {
        let wedge = LocalProblem { nn: 1.0, nt: 0.9, tt: 1.0 };
        assert_eq!(wedge.slide(-1.0, 2.0, -1.0), None);
        // For every free motion the law has a solution, and its forces give what it says.
        for angle in 0..360 {
            let angle = f64::from(angle).to_radians();
            let free = [angle.cos(), angle.sin()];
            let LocalSolution { force: [normal, tangential], state } =
                wedge.solve(free, &coulomb(2.0));
            let normal_acceleration = free[0] + wedge.nn * normal + wedge.nt * tangential;
            let tangential_acceleration = free[1] + wedge.nt * normal + wedge.tt * tangential;
            assert!(normal >= 0.0 && normal_acceleration > -1e-12);
            assert!(normal * normal_acceleration < 1e-10);
            assert!(tangential.abs() <= 2.0 * normal + 1e-12);
            assert!(tangential_acceleration * tangential <= 1e-10);
            assert!(state != Stick || tangential_acceleration.abs() < 1e-12);
            assert_eq!(state == ContactState::Detached, normal == 0.0);
            if let Some(direction) = state.sliding_direction() {
                assert!((tangential - direction * 2.0 * normal).abs() <= 1e-12);
            }
        }
    }
}
