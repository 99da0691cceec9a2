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
    /// The three cases are tried in turn: open, stick, slide. `None` where none is consistent:
    /// the contact wedges (Painlevé), which needs |W_NT| µ ≥ W_NN.
    #[must_use]
    pub fn solve(&self, free: [f64; 2], friction_coefficient: f64) -> Option<[f64; 2]> {
        let [free_normal, free_tangential] = free;
        if free_normal >= 0.0 {
            return Some([0.0, 0.0]);
        }
        self.stick(free, friction_coefficient).or_else(|| {
            // A mass that lags behind the slider (a_T < 0) is dragged along (T > 0), and so on.
            [1.0, -1.0].into_iter().find_map(|direction| {
                let [normal, tangential] =
                    self.slide(free_normal, friction_coefficient, direction)?;
                let acceleration = free_tangential + self.nt * normal + self.tt * tangential;
                (acceleration * direction <= 0.0).then_some([normal, tangential])
            })
        })
    }

    /// The multipliers of a contact that does slip, with friction in the given direction (±1);
    /// `None` where it wedges.
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
        assert_eq!(W.solve([0.1, 5.0], 0.3), Some([0.0, 0.0]));
    }

    #[test]
    fn stick_where_friction_can_hold_and_slide_where_it_cannot() {
        assert_eq!(W.solve([-4.0, 1.0], 0.5), Some([2.0, -0.25]));
        assert_eq!(W.solve([-4.0, 8.0], 0.5), Some([2.0, -1.0]));
        assert_eq!(W.solve([-4.0, -8.0], 0.5), Some([2.0, 1.0]));
    }

    #[test]
    fn a_wedging_contact_has_no_solution() {
        let wedge = LocalProblem { nn: 1.0, nt: 0.9, tt: 1.0 };
        // Free motion pulls along −t, friction along +t presses the contact further: it can hold.
        assert!(wedge.solve([-1.0, -0.9], 2.0).is_some());
        // Slip towards +t that friction cannot stop, and friction along −t that pries it open.
        assert_eq!(wedge.slide(-1.0, 2.0, -1.0), None);
    }
}
