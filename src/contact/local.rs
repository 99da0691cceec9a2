//! The Signorini–Coulomb law of one contact against its own block of the Delassus matrix.

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

impl LocalProblem {
    /// The multipliers (N, T), in N, of the law
    ///
    /// 0 ≤ a_N ⊥ N ≥ 0, |T| ≤ µN, a_T = 0 or T = −sign(a_T) µN, with a = W (N, T) + `free`,
    ///
    /// where `free` holds the normal and tangential accelerations (m/s²) without this contact.
    /// The cases are tried in turn: open, stick, slide. W is positive definite, so one of them holds.
    #[must_use]
    pub fn solve(&self, free: [f64; 2], friction_coefficient: f64) -> [f64; 2] {
        let [free_normal, free_tangential] = free;
        if free_normal >= 0.0 {
            return [0.0, 0.0];
        }
        if let Some(held) = self.stick(free, friction_coefficient) {
            return held;
        }
        // A mass that lags behind the slider (a_T < 0) is dragged along (T > 0), and the other way
        // round. Where rounding lets neither pass, friction opposes what the free motion would do.
        let slides = |direction: f64| {
            let [normal, tangential] = self.slide(free_normal, friction_coefficient, direction)?;
            let acceleration = free_tangential + self.nt * normal + self.tt * tangential;
            (acceleration * direction <= 0.0).then_some([normal, tangential])
        };
        let against = if free_tangential > 0.0 { -1.0 } else { 1.0 };
        slides(1.0)
            .or_else(|| slides(-1.0))
            .or_else(|| self.slide(free_normal, friction_coefficient, against))
            .unwrap_or([f64::NAN; 2])
    }

    /// The multipliers of a contact that does slip, with friction in the given direction (±1);
    /// `None` where it wedges (Painlevé): friction then presses the mass on more than it is
    /// pressed, W_NN ± µ W_NT ≤ 0.
    #[must_use]
    pub fn slide(&self, free_normal: f64, friction: f64, direction: f64) -> Option<[f64; 2]> {
        let slope = direction * friction;
        let stiffness = self.nn + slope * self.nt;
        if free_normal >= 0.0 {
            return Some([0.0, 0.0]);
        }
        (stiffness > 0.0).then(|| {
            let normal = -free_normal / stiffness;
            [normal, slope * normal]
        })
    }

    /// The multipliers that hold the contact, if friction can.
    fn stick(&self, [free_normal, free_tangential]: [f64; 2], friction: f64) -> Option<[f64; 2]> {
        let determinant = self.nn * self.tt - self.nt * self.nt;
        let normal = (self.nt * free_tangential - self.tt * free_normal) / determinant;
        let tangential = (self.nt * free_normal - self.nn * free_tangential) / determinant;
        (normal >= 0.0 && tangential.abs() <= friction * normal).then_some([normal, tangential])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const W: LocalProblem = LocalProblem { nn: 2.0, nt: 0.0, tt: 4.0 };

    #[test]
    fn a_contact_that_opens_carries_nothing() {
        assert_eq!(W.solve([0.1, 5.0], 0.3), [0.0, 0.0]);
    }

    #[test]
    fn stick_where_friction_can_hold_and_slide_where_it_cannot() {
        assert_eq!(W.solve([-4.0, 1.0], 0.5), [2.0, -0.25]);
        assert_eq!(W.solve([-4.0, 8.0], 0.5), [2.0, -1.0]);
        assert_eq!(W.solve([-4.0, -8.0], 0.5), [2.0, 1.0]);
    }

    #[test]
    fn a_mass_that_slips_can_wedge_but_one_that_is_free_to_stick_cannot() {
        let wedge = LocalProblem { nn: 1.0, nt: 0.9, tt: 1.0 };
        assert_eq!(wedge.slide(-1.0, 2.0, -1.0), None);
        // For every free motion the law has a solution, and its forces give what it says.
        for angle in 0..360 {
            let angle = f64::from(angle).to_radians();
            let free = [angle.cos(), angle.sin()];
            let [normal, tangential] = wedge.solve(free, 2.0);
            let normal_acceleration = free[0] + wedge.nn * normal + wedge.nt * tangential;
            let tangential_acceleration = free[1] + wedge.nt * normal + wedge.tt * tangential;
            assert!(normal >= 0.0 && normal_acceleration > -1e-12);
            assert!(normal * normal_acceleration < 1e-10);
            assert!(tangential.abs() <= 2.0 * normal + 1e-12);
            assert!(tangential_acceleration * tangential <= 1e-10);
            let holds = tangential.abs() < 2.0 * normal - 1e-12;
            assert!(!holds || tangential_acceleration.abs() < 1e-12);
        }
    }
}
