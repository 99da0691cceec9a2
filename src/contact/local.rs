//! The Signorini–Coulomb law of one contact against its own block of the Delassus matrix.

use super::{ContactState, FrictionRange};

/// A determinant of W that is smaller than this part of its first term is rounding.
const SINGULAR: f64 = 1e-13;

/// Block of the Delassus matrix G M⁻¹ Gᵀ that belongs to one contact, 1/kg: normal–normal,
/// normal–tangential, tangential–tangential.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalProblem {
    /// Normal–normal entry W_NN, 1/kg.
    pub nn: f64,
    /// Normal–tangential entry W_NT, 1/kg.
    pub nt: f64,
    /// Tangential–tangential entry W_TT, 1/kg.
    pub tt: f64,
}

/// The multipliers of one contact, and the state that they belong to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalSolution {
    /// Normal and friction force (N, T), N.
    pub force: [f64; 2],
    /// The state of the contact; `Detached` where N is zero.
    pub state: ContactState,
}

impl LocalSolution {
    /// The solution of a contact that carries no force.
    pub const OPEN: Self = Self { force: [0.0; 2], state: ContactState::Detached };
}

impl LocalProblem {
    /// The multipliers (N, T), in N, of the law
    ///
    /// 0 ≤ a_N ⊥ N ≥ 0, T/N in `range` with a_T = 0, or at its end against a_T, with
    /// a = W (N, T) + `free`,
    ///
    /// where `free` holds the normal and tangential accelerations (m/s²) without this contact.
    /// The cases are tried in turn: open, stick, slide. Where W is positive definite, one of them holds. Where W is
    /// singular (the mass has one degree of freedom), friction may jam the contact: `None`.
    #[inline]
    #[must_use]
    pub fn solve(&self, free: [f64; 2], range: &FrictionRange) -> Option<LocalSolution> {
        let [free_normal, free_tangential] = free;
        if free_normal >= 0.0 {
            return Some(LocalSolution::OPEN);
        }
        if self.is_singular() {
            return self.solve_along_line(free, range);
        }
        if let Some(held) = self.stick(free, range) {
            return Some(held);
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
    }

    /// `true` if W is singular: the mass has one degree of freedom for both normal and tangent, or none along the
    /// tangent. Forces along both directions then have the same effect, but for a factor.
    #[inline]
    #[must_use]
    pub fn is_singular(&self) -> bool {
        self.nn * self.tt - self.nt * self.nt <= SINGULAR * self.nn * self.tt
    }

    /// T/N of a contact that sticks where W is singular. Its forces are then not unique: of the equivalent forces
    /// within the cone of friction, those with the smallest N² + T² are taken.
    #[must_use]
    pub fn stuck_slope(&self, range: &FrictionRange) -> f64 {
        (self.nt / self.nn).max(-range.backward).min(range.forward)
    }

    /// Solves a contact whose W is singular. The condition a_N = 0 then determines a_T, whatever the forces are.
    fn solve_along_line(&self, free: [f64; 2], range: &FrictionRange) -> Option<LocalSolution> {
        let carried = self.nt / self.nn * free[0];
        let acceleration = free[1] - carried;
        if acceleration.abs() <= SINGULAR * (free[1].abs() + carried.abs()) {
            let slope = self.stuck_slope(range);
            return self.guide(free[0], slope, ContactState::Stick);
        }
        let direction = -acceleration.signum();
        self.slide(free[0], range.limit(direction), direction)
    }

    /// The multipliers of a contact that slips, with `friction` = µ_k in the given direction (±1); `None` where it
    /// wedges (Painlevé): W_NN ± µ W_NT ≤ 0, so the normal force and its friction together do not accelerate the mass
    /// off its surface.
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

    /// The multipliers and the state of a contact that holds in both directions of its normal: a_N = 0, N of either sign, and
    /// friction follows |N|. `None` where it wedges.
    #[must_use]
    pub fn solve_held(&self, free: [f64; 2], range: &FrictionRange) -> Option<LocalSolution> {
        if self.is_singular() {
            return self.solve_held_along_line(free, range);
        }
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
        // The direction of slip is that of the friction force that would hold the contact, but for rounding.
        let direction = tangential.signum();
        slides(direction)
            .or_else(|| slides(-direction))
            .or_else(|| self.slide_held(free[0], range.limit(direction), direction))
    }

    /// The solution of a contact that holds in both directions ([`solve_held`](Self::solve_held)), where W is singular: a_N = 0
    /// then determines a_T, whatever the forces are.
    fn solve_held_along_line(
        &self,
        free: [f64; 2],
        range: &FrictionRange,
    ) -> Option<LocalSolution> {
        let carried = self.nt / self.nn * free[0];
        let acceleration = free[1] - carried;
        if acceleration.abs() > SINGULAR * (free[1].abs() + carried.abs()) {
            let direction = -acceleration.signum();
            return self.slide_held(free[0], range.limit(direction), direction);
        }
        let range = if free[0] > 0.0 { range.pulling() } else { *range };
        self.guide(free[0], self.stuck_slope(&range), ContactState::Stick)
    }

    /// The multipliers of a contact that holds in both directions of its normal and slips, with `friction` = µ_k in the
    /// given direction (±1); `None` where it wedges.
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

    /// The multipliers of a contact that is held along normal and tangent, however large they are.
    #[must_use]
    pub fn fix(&self, free: [f64; 2]) -> LocalSolution {
        LocalSolution { force: self.hold(free), state: ContactState::Stick }
    }

    /// Returns the (N, T) that keep the contact closed and stuck.
    fn hold(&self, [free_normal, free_tangential]: [f64; 2]) -> [f64; 2] {
        if self.is_singular() {
            // The forces are not unique: the smallest ones are taken.
            let normal = -free_normal * self.nn / (self.nn * self.nn + self.nt * self.nt);
            return [normal, self.nt / self.nn * normal];
        }
        let determinant = self.nn * self.tt - self.nt * self.nt;
        let normal = (self.nt * free_tangential - self.tt * free_normal) / determinant;
        [normal, (self.nt * free_normal - self.nn * free_tangential) / determinant]
    }

    /// The multipliers that hold the contact, if friction can hold it.
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

    #[test]
    fn a_contact_that_opens_carries_nothing() {
        assert_eq!(W.solve([0.1, 5.0], &FrictionRange::of(0.3)), Some(LocalSolution::OPEN));
    }

    #[test]
    fn a_mass_on_a_line_that_cannot_open_slips_under_a_surface_that_it_cannot_follow() {
        // 1 kg that moves along (cos α, sin α) of normal and tangent, α = 0.5, and is at rest while its surface moves.
        let (sin, cos) = 0.5_f64.sin_cos();
        let line = LocalProblem { nn: cos * cos, nt: cos * sin, tt: sin * sin };
        let range = FrictionRange::of(0.4);
        for (along, surface, state, sign) in [
            (-2.0, 3.0, Slide, 1.0),
            (-2.0, -3.0, ReverseSlide, -1.0),
            (2.0, 3.0, Slide, -1.0),
            (2.0, -3.0, ReverseSlide, 1.0),
        ] {
            let free = [along * cos, along * sin - surface];
            let found = line.solve_held(free, &range).unwrap();
            let [normal, tangential] = found.force;
            // The forces along the line cancel the free acceleration there.
            assert!((normal * cos + tangential * sin + along).abs() < 1e-14);
            assert!((tangential - sign * 0.4 * normal).abs() < 1e-14);
            assert_eq!(found.state, state);
        }
        let still = line.solve_held([2.0 * cos, 2.0 * sin], &range).unwrap();
        assert_eq!(still.state, Stick);
        assert!(still.force[1].abs() <= 0.4 * still.force[0].abs() * (1.0 + 1e-15));
    }

    #[test]
    fn stick_where_friction_can_hold_and_slide_where_it_cannot() {
        for (free, force, state) in [
            ([-4.0, 1.0], [2.0, -0.25], Stick),
            ([-4.0, 8.0], [2.0, -1.0], ReverseSlide),
            ([-4.0, -8.0], [2.0, 1.0], Slide),
        ] {
            assert_eq!(
                W.solve(free, &FrictionRange::of(0.5)),
                Some(LocalSolution { force, state })
            );
        }
    }

    #[test]
    fn what_static_friction_lets_go_is_at_its_limit() {
        let range = FrictionRange { kinetic: 0.25, ..FrictionRange::of(0.5) };
        let held = LocalSolution { force: [2.0, -1.0], state: Stick };
        assert_eq!(W.solve([-4.0, 4.0], &range), Some(held));
        let slips = LocalSolution { force: [2.0, -1.0], state: ReverseSlide };
        assert_eq!(W.solve([-4.0, 4.1], &range), Some(slips));
    }

    #[test]
    fn a_mass_on_a_line_is_stopped_by_the_sum_along_the_line() {
        // 1 kg that moves along (cos α, sin α) of normal and tangent, α = 0.5, and closes with 3 m/s.
        let (cos, sin) = (0.5_f64.cos(), 0.5_f64.sin());
        let line = LocalProblem { nn: cos * cos, nt: cos * sin, tt: sin * sin };
        let free = [-3.0 * cos, -3.0 * sin];
        // On a surface at rest it sticks: the smallest forces lie along the line, or at the edge of the cone.
        let LocalSolution { force, state } = line.solve(free, &FrictionRange::of(0.6)).unwrap();
        assert_eq!(state, Stick);
        assert!((force[0] - 3.0 * cos).abs() < 1e-14 && (force[1] - 3.0 * sin).abs() < 1e-14);
        let LocalSolution { force, state } = line.solve(free, &FrictionRange::of(0.1)).unwrap();
        assert_eq!(state, Stick);
        assert!((force[1] / force[0] - 0.1).abs() < 1e-15);
        assert!((cos * force[0] + sin * force[1] - 3.0).abs() < 1e-14);
        // A surface that moves lets it slip: N = m |v| / (cos α ± µ sin α), which must be positive.
        for (surface, slope) in [(0.4, 0.6), (-0.4, -0.6)] {
            let LocalSolution { force, .. } =
                line.solve([free[0], free[1] - surface], &FrictionRange::of(0.6)).unwrap();
            assert!((force[0] - 3.0 / (cos + slope * sin)).abs() < 1e-13);
            assert!((force[1] - slope * force[0]).abs() < 1e-14);
        }
        assert_eq!(line.solve([free[0], free[1] + 0.4], &FrictionRange::of(2.0)), None);
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
                wedge.solve(free, &FrictionRange::of(2.0)).unwrap();
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
