//! Static equilibrium in uniform sliding.

use super::banded::{self, Singular};
use super::{Entry, LumpedModel, ring};
use crate::Error;
use crate::numerics::bisect;
use serde::{Deserialize, Serialize};

/// A static equilibrium with every contact closed.
///
/// ```
/// use amontons::assembly::equilibrium;
/// use amontons::model::LumpedModel;
///
/// let scene = amontons::scene::builtin("set1").expect("a built-in scene").scene();
/// let model = LumpedModel::from(&scene);
/// let equilibrium = equilibrium(&scene, &model)?;
/// for (normal, friction) in equilibrium.normal_force.iter().zip(&equilibrium.friction_force) {
///     // The surface moves along the tangent, and T = µ N.
///     assert!((friction - scene.friction().kinetic * normal).abs() < 1e-9 * normal);
/// }
/// # Ok::<(), amontons::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Equilibrium {
    /// Displacement X, m, from the unloaded position; one value for each degree of freedom.
    pub displacement: Vec<f64>,
    /// Normal force N ≥ 0 of each contact, N.
    pub normal_force: Vec<f64>,
    /// Friction force T of each contact, on the mass along the tangent, N.
    pub friction_force: Vec<f64>,
    /// Gap of each contact, m: exactly 0 where it is closed.
    pub gap: Vec<f64>,
}

impl LumpedModel {
    /// The equilibrium in uniform sliding, K X = F + Σ (G_N + s µ G_T)ᵀ N, G_N X = 0, where s is
    /// the sign of the velocity of the contact's surface: with v > 0 it is in Sl, with v < 0 in R-Sl. With
    /// v = 0 it does not slide; it starts stuck, without friction force (s = 0).
    ///
    /// Equal modules of a ring move as one, so one is solved for all: they then are in equal states to the last bit,
    /// which a solution of the whole, with its rounding, would not give.
    ///
    /// # Errors
    /// Returns an error with the contact, as `name` calls it, that opens under the load; or with the friction
    /// coefficient above which the structure jams; or with a motion that no spring holds.
    pub fn equilibrium(&self, name: &dyn Fn(usize) -> String) -> Result<Equilibrium, Error> {
        let Some(one) = ring::one_of_equal_modules(self) else {
            return self.sliding_equilibrium(name);
        };
        let count = self.contacts.len();
        let alone = one.sliding_equilibrium(name)?;
        Ok(Equilibrium {
            displacement: alone.displacement.repeat(count),
            normal_force: alone.normal_force.repeat(count),
            friction_force: alone.friction_force.repeat(count),
            gap: alone.gap.repeat(count),
        })
    }

    fn sliding_equilibrium(&self, name: &dyn Fn(usize) -> String) -> Result<Equilibrium, Error> {
        let slopes: Vec<f64> = self.sliding_ratios().collect();
        match self.solve(&slopes, &self.load) {
            // Friction that can stick follows |N|, which this linear solution does not include.
            Ok(found) if found.pulled_contact().is_none() || self.may_pull(&slopes) => Ok(found),
            found => Err(self.explain_missing_equilibrium(&slopes, &found, name)),
        }
    }

    /// `true` if contacts may pull in the equilibrium, with these signed coefficients of friction.
    fn may_pull(&self, slopes: &[f64]) -> bool {
        let has_friction = slopes.iter().any(|slope| *slope != 0.0);
        let drives = self.law.follows_size() && has_friction;
        !(self.law.detachment || drives)
    }

    /// Changes of the contact forces of the equilibrium in uniform sliding: (dN, dT) of each contact, N, for changes of
    /// the load, N, and of the signed friction coefficients `slopes` = T/N, where the contacts press with
    /// `normal_force`, N. The map is linear: K dX = dF + Σ (G_N + s µ G_T)ᵀ dN + G_Tᵀ N d(s µ), G_N dX = 0.
    ///
    /// # Errors
    /// Returns an error if there is no equilibrium.
    pub fn equilibrium_change(
        &self,
        mut load: Vec<f64>,
        slopes: &[f64],
        slope_changes: &[f64],
        normal_force: &[f64],
    ) -> Result<Vec<[f64; 2]>, Error> {
        let weakened = || normal_force.iter().zip(slope_changes).map(|(force, by)| force * by);
        for (contact, change) in self.contacts.iter().zip(weakened()) {
            contact.tangent.add_to(&mut load, change);
        }
        let found = self.solve(slopes, &load).map_err(|_| {
            Error::equilibrium("the equilibrium has no derivative where a structure jams")
        })?;
        let forces = found.normal_force.into_iter().zip(found.friction_force);
        Ok(forces.zip(weakened()).map(|((n, t), own)| [n, t + own]).collect())
    }

    /// Solves for the equilibrium with all contacts closed and sliding, with the signed friction coefficients `slopes`
    /// = T/N, under this load, N.
    fn solve(&self, slopes: &[f64], load: &[f64]) -> Result<Equilibrium, Singular> {
        let dofs = self.dofs();
        let size = dofs + self.contacts.len();
        let mut entries: Vec<Entry> = self.stiffness.entries().collect();
        // In the unit of a stiffness the border is of the size of the rest, which pivoting needs.
        let unit = entries.iter().fold(0.0_f64, |unit, entry| unit.max(entry.2.abs()));
        for (i, (contact, slope)) in self.contacts.iter().zip(slopes).enumerate() {
            let multiplier = dofs + i;
            for &(dof, value) in &contact.normal.0 {
                entries.push((multiplier, dof, unit * value));
                entries.push((dof, multiplier, -unit * value));
            }
            for &(dof, value) in &contact.tangent.0 {
                entries.push((dof, multiplier, -unit * (slope * value)));
            }
        }
        let mut load = load.to_vec();
        load.resize(size, 0.0);
        let mut displacement = banded::solve(size, &entries, &load)?;
        let normal_force: Vec<f64> =
            displacement.split_off(dofs).into_iter().map(|multiplier| unit * multiplier).collect();
        let friction_force = slopes.iter().zip(&normal_force).map(|(slope, n)| slope * n).collect();
        let gap = vec![0.0; normal_force.len()];
        Ok(Equilibrium { displacement, normal_force, friction_force, gap })
    }

    /// Explains why there is no equilibrium at these µ. Looks for the largest part of them that has one: where the
    /// equilibrium is lost, a normal force that falls to zero is a contact that opens, one that grows without bound is
    /// jamming.
    fn explain_missing_equilibrium(
        &self,
        slopes: &[f64],
        found: &Result<Equilibrium, Singular>,
        name: &dyn Fn(usize) -> String,
    ) -> Error {
        const GRID: u32 = 256;
        let solve = |part: f64| {
            let part: Vec<f64> = slopes.iter().map(|slope| part * slope).collect();
            self.solve(&part, &self.load)
        };
        if solve(0.0).is_err() {
            return Error::equilibrium(
                "no equilibrium: the structure can move without straining a spring, or its contacts \
                 are redundant; restrain every motion by a stiffness above zero, and only once",
            );
        }
        let exists = |part: f64| solve(part).ok().filter(|found| found.pulled_contact().is_none());
        let below = (0..GRID).rev().map(|i| f64::from(i) / f64::from(GRID));
        let Some(known) = below.into_iter().find(|&part| exists(part).is_some()) else {
            let pulled = found.as_ref().ok().and_then(Equilibrium::pulled_contact);
            let (contact, force) = pulled.unwrap_or((0, 0.0));
            return Error::equilibrium(format!(
                "no equilibrium in sliding: {} opens under the load \
                 (it would have to pull with {:.4} N); press it on by a preload or a force",
                name(contact),
                -force
            ));
        };
        let start = exists(known).expect("just found");
        let [good, _] = bisect(known, 1.0, |part| exists(part).is_some());
        let last = exists(good).expect("an equilibrium exists on this side");
        let grown = last.normal_force.iter().zip(&start.normal_force);
        let grown = grown.map(|(last, start)| last / start).enumerate();
        let grown = grown.max_by(|a, b| a.1.total_cmp(&b.1));
        let lightest = last.normal_force.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1));
        let jams = grown.filter(|&(_, growth)| growth > 1e6).map(|(contact, _)| contact);
        let contact = jams.or(lightest.map(|(contact, _)| contact)).unwrap_or(0);
        let friction = slopes.get(contact).map_or(0.0, |slope| slope.abs());
        let (limit, name) = (good * friction, name(contact));
        // Contacts of different µ share a limit only where they keep their proportions.
        let differ = slopes.iter().any(|slope| slope.abs() != friction);
        let common = if differ { " (and the others in proportion)" } else { "" };
        Error::equilibrium(match jams {
            Some(_) => format!(
                "no equilibrium in sliding with a friction coefficient of {friction}{common}: {name} jams \
                 from {limit:.6} on, where friction draws it into the slider; \
                 lower the coefficient or turn slider.angle"
            ),
            None => format!(
                "no equilibrium in sliding with a friction coefficient of {friction}{common}: friction \
                 lifts {name} off from {limit:.6} on; press it on, or lower the \
                 coefficient"
            ),
        })
    }
}

impl Equilibrium {
    /// The first contact that would have to pull, with its normal force.
    fn pulled_contact(&self) -> Option<(usize, f64)> {
        let mut normal = self.normal_force.iter().copied().enumerate();
        normal.find(|&(_, force)| force.is_nan() || force < 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Contact, Direction, SparseMatrix};
    use crate::scene::{Scene, builtin};

    fn number(contact: usize) -> String {
        format!("contact[{}]", contact + 1)
    }

    fn set1() -> Scene {
        builtin("set1").unwrap().scene()
    }

    fn equilibrium(scene: &Scene) -> Result<Equilibrium, Error> {
        crate::assembly::equilibrium(scene, &LumpedModel::from(scene))
    }

    #[test]
    fn forces_balance_and_contacts_are_closed() {
        let mut scene = set1();
        scene.modules_mut()[1].preload *= 1.3;
        let model = LumpedModel::from(&scene);
        let found = equilibrium(&scene).unwrap();
        let mut contact = vec![0.0; model.dofs()];
        for (i, c) in model.contacts.iter().enumerate() {
            assert!(found.normal_force[i] > 0.0);
            assert_eq!(found.friction_force[i], 1.96 * found.normal_force[i]);
            c.normal.add_to(&mut contact, found.normal_force[i]);
            c.tangent.add_to(&mut contact, found.friction_force[i]);
        }
        for (dof, contact) in contact.iter().enumerate() {
            let residual =
                model.load[dof] + contact - model.stiffness.row_times(dof, &found.displacement);
            assert!(residual.abs() < 1e-9, "{dof}: {residual}");
        }
        for module in 0..2 {
            assert!(found.displacement[4 * module + 3].abs() < 1e-16);
        }
    }

    #[test]
    fn one_module_solved_for_all_is_the_equilibrium_of_the_whole() {
        let scene = set1();
        let whole = LumpedModel::from(&scene).sliding_equilibrium(&number).unwrap();
        let one = equilibrium(&scene).unwrap();
        for (a, b) in whole.normal_force.iter().zip(&one.normal_force) {
            assert!((a - b).abs() < 1e-12 * b.abs());
        }
    }

    #[test]
    fn the_sign_of_the_velocity_turns_friction() {
        let mut scene = set1();
        scene.slider.velocity = -0.025;
        assert!(equilibrium(&scene).unwrap().friction_force[0] < 0.0);
        scene.slider.velocity = 0.0;
        assert_eq!(equilibrium(&scene).unwrap().friction_force[0], 0.0);
    }

    /// A mass with K = [[a, b], [b, c]] in (x_t, x_n), pushed down by P: N (a − µ b) = P a for
    /// x_n = 0, so it jams from µ = a/b on if b > 0.
    fn wedge(friction: f64, surface_velocity: f64) -> LumpedModel {
        let contact = Contact {
            friction: friction.into(),
            surface_velocity,
            ..Contact::new(Direction::unit(1), Direction::unit(0))
        };
        LumpedModel {
            mass: SparseMatrix::diagonal(&[1.0, 1.0]),
            stiffness: SparseMatrix::from_entries(
                2,
                vec![(0, 0, 4.0), (0, 1, 1.0), (1, 0, 1.0), (1, 1, 2.0)],
            ),
            damping: super::super::Damping::default(),
            dampers: SparseMatrix::zero(2),
            load: vec![0.0, -3.0],
            contacts: vec![contact],
            law: crate::contact::ContactLaw::default(),
        }
    }

    #[test]
    fn normal_force_follows_the_closed_form_up_to_jamming() {
        for mu in [0.0, 1.0, 3.9] {
            let normal = wedge(mu, 1.0).sliding_equilibrium(&number).unwrap().normal_force[0];
            assert!((normal - 3.0 * 4.0 / (4.0 - mu)).abs() < 1e-12 * normal);
        }
    }

    #[test]
    fn jamming_is_told_with_the_coefficient_from_which_on_it_happens() {
        let message = wedge(5.0, 1.0).sliding_equilibrium(&number).unwrap_err().to_string();
        assert!(message.contains("contact[1] jams from 4.000000 on"), "{message}");
        // Pulled the other way the same wedge opens itself: it never jams.
        assert!(wedge(5.0, -1.0).sliding_equilibrium(&number).is_ok());
    }

    #[test]
    fn a_contact_that_the_load_opens_is_named() {
        let mut scene = set1();
        scene.modules_mut()[1].preload = -5e-3;
        let message = equilibrium(&scene).unwrap_err().to_string();
        assert!(message.contains("contact[2] opens under the load"), "{message}");
    }

    #[test]
    fn a_contact_that_only_friction_presses_on_is_an_equilibrium() {
        // Without friction the load would open contact 2; with it the slider's drag closes it.
        let mut scene = set1();
        scene.slider.angle = -0.5;
        scene.modules_mut()[1].preload = -2e-3;
        scene.friction_coefficient = 0.0;
        let message = equilibrium(&scene).unwrap_err().to_string();
        assert!(message.contains("contact[2] opens under the load"), "{message}");
        scene.friction_coefficient = 1.96;
        assert!(equilibrium(&scene).unwrap().normal_force[1] > 10.0);
    }

    #[test]
    fn a_mechanism_is_told_apart() {
        let mut scene = set1();
        for module in scene.modules_mut() {
            module.stiffness[3] = 0.0;
            module.stiffness[5] = 0.0;
            module.stiffness[0] = 0.0;
        }
        let message = equilibrium(&scene).unwrap_err().to_string();
        assert!(message.contains("without straining a spring"), "{message}");
    }
}
