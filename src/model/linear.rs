//! The linear model of each contact state, whose eigenvalues are sought.

use super::{Contact, Direction, Equilibrium, LumpedModel};
use crate::Error;

/// A lumped model whose friction is linear in uniform sliding. It borrows the model, so the model cannot change
/// while its eigenvalues are sought.
///
/// ```
/// use amontons::assembly::equilibrium;
/// use amontons::contact::ContactState::Slide;
/// use amontons::model::LumpedModel;
/// use amontons::stability::Spectrum;
///
/// let scene = amontons::scene::builtin("set1").expect("a built-in scene").scene();
/// let model = LumpedModel::from(&scene);
/// let equilibrium = equilibrium(&scene, &model)?;
/// let spectrum = Spectrum::of(model.linear_about(&equilibrium), &[Slide, Slide])?;
/// assert!(spectrum.unstable());
/// # Ok::<(), amontons::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct LinearModel<'a> {
    model: &'a LumpedModel,
    friction: Linearisation<'a>,
}

/// The way in which friction is made linear.
#[derive(Clone, Copy, Debug)]
enum Linearisation<'a> {
    /// About an equilibrium in which the contacts press with these normal forces, N.
    About(&'a [f64]),
    /// One coefficient, which does not depend on the slip velocity.
    Constant,
    /// The greatest coefficient that a contact can have in slip.
    Greatest,
}

/// Friction of a contact that slides, T = µ N, as it enters a linear equation of motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlidingFriction {
    /// Friction coefficient µ.
    pub coefficient: f64,
    /// N dµ/d|v_r|, N s/m: the contribution of friction to damping along the tangent; below zero where µ falls with the
    /// slip velocity.
    pub damping: f64,
    /// µ N / |v|, N s/m: the damping across the sliding direction, since friction has the direction of the slip. Zero
    /// unless the contact has a [transverse](crate::model::Contact::transverse) direction.
    pub transverse: f64,
}

impl LumpedModel {
    /// The model about an equilibrium, with µ and the slope dµ/d|v_r| of each contact at the velocity of its surface.
    #[must_use]
    pub fn linear_about<'a>(&'a self, equilibrium: &'a Equilibrium) -> LinearModel<'a> {
        let friction = Linearisation::About(&equilibrium.normal_force);
        LinearModel { model: self, friction }
    }

    /// The model without an equilibrium, where its linear equations do not need one.
    ///
    /// # Errors
    /// Returns an error if they do ([`needs_equilibrium`](Self::needs_equilibrium)).
    pub fn linear(&self) -> Result<LinearModel<'_>, Error> {
        if !self.needs_equilibrium() {
            return Ok(LinearModel { model: self, friction: Linearisation::Constant });
        }
        Err(Error::equilibrium(if self.law.friction.info().is_constant() {
            "friction across the sliding direction can be linearised only about an equilibrium, and there is none"
        } else {
            "friction that depends on the slip velocity can be linearised only about an equilibrium, and there is none"
        }))
    }

    /// `true` if the linear equations depend on the normal forces of an equilibrium: where µ depends on the slip velocity,
    /// or friction across the sliding direction is asked for.
    #[must_use]
    pub fn needs_equilibrium(&self) -> bool {
        let across = |contact: &Contact| contact.transverse.is_some();
        !self.law.friction.info().is_constant() || self.contacts.iter().any(across)
    }

    /// The model with the greatest µ that each contact can have in slip, and without a slope: for limits that hold
    /// at all slip velocities.
    #[must_use]
    pub fn with_greatest_friction(&self) -> LinearModel<'_> {
        LinearModel { model: self, friction: Linearisation::Greatest }
    }
}

impl<'a> LinearModel<'a> {
    /// The underlying lumped model.
    #[must_use]
    pub fn model(self) -> &'a LumpedModel {
        self.model
    }

    /// Friction of each contact that slides.
    pub fn friction(self) -> impl Iterator<Item = SlidingFriction> + Clone + 'a {
        (0..self.model.contacts.len()).map(move |contact| self.friction_of(contact))
    }

    /// Friction of one contact that slides.
    #[must_use]
    pub fn friction_of(self, contact: usize) -> SlidingFriction {
        let Self { model, friction } = self;
        let (law, here) = (model.law.friction, &model.contacts[contact]);
        let damping = match friction {
            Linearisation::About(normal_force) if model.rubs(here) => {
                normal_force[contact] * law.slope_at(here.friction, here.surface_velocity)
            }
            _ => 0.0,
        };
        let coefficient = match friction {
            Linearisation::Greatest => law.greatest_in_slip(here.friction),
            _ => model.sliding_friction(here),
        };
        let speed = here.surface_velocity.abs();
        let transverse = match friction {
            Linearisation::About(normal_force) if here.transverse.is_some() && speed > 0.0 => {
                coefficient * normal_force[contact] / speed
            }
            _ => 0.0,
        };
        SlidingFriction { coefficient, damping, transverse }
    }

    /// The parts that friction adds to the damping where contacts slide: the contact, a direction b and the coefficient c, N s/m, of
    /// c b bᵀ.
    pub fn friction_damping(self) -> impl Iterator<Item = (usize, &'a Direction, f64)> + 'a {
        self.model.contacts.iter().zip(self.friction()).enumerate().flat_map(
            |(i, (contact, friction))| {
                let along = Some((i, &contact.tangent, friction.damping));
                let across = contact.transverse.as_ref().map(|b| (i, b, friction.transverse));
                along.into_iter().chain(across).filter(|part| part.2 != 0.0)
            },
        )
    }

    /// The linear model of another structure with the friction of this model's contacts; it has all of them or the
    /// first ones.
    #[must_use]
    pub fn of_part<'b>(self, part: &'b LumpedModel) -> LinearModel<'b>
    where
        'a: 'b,
    {
        LinearModel { model: part, friction: self.friction }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{ContactLaw, ContactState, Friction, Law};
    use crate::model::{Damping, SparseMatrix};
    use crate::scene::builtin;
    use crate::stability::{Spectrum, critical_step};

    fn set1() -> LumpedModel {
        LumpedModel::from(&builtin("set1").unwrap().scene())
    }

    fn equilibrium() -> Equilibrium {
        Equilibrium {
            displacement: vec![0.0; 8],
            normal_force: vec![3.0; 2],
            friction_force: vec![0.0; 2],
            gap: vec![0.0; 2],
        }
    }

    /// Regression: exporter and page took µ at the velocity of the surface, and named a longer step than a run accepts.
    #[test]
    fn friction_that_falls_has_the_critical_step_of_its_greatest_coefficient() {
        let mut falling = set1();
        falling.law.friction = Law::Stribeck;
        let law = Friction { stribeck_velocity: 1e-3, ..Friction::with_static(0.4, 1.96) };
        let falling = falling.with_friction(law);
        assert!(falling.sliding_friction(&falling.contacts[0]) < 0.41);
        assert_eq!(critical_step(&falling), critical_step(&set1()));
        assert_ne!(critical_step(&falling), critical_step(&set1().with_friction(0.4)));
    }

    /// Regression: eigenvalues had friction at such contacts, and motion had none.
    #[test]
    fn friction_of_a_fixed_direction_is_none_where_the_surface_stands_still() {
        let mut model = set1();
        model.law.sticking = false;
        model.contacts[1].surface_velocity = 0.0;
        let friction: Vec<f64> =
            model.linear().unwrap().friction().map(|friction| friction.coefficient).collect();
        assert_eq!(friction, [1.96, 0.0]);
        let stands = |model: &LumpedModel| model.linear_about(&equilibrium()).friction_of(1);
        model.law.friction = Law::Stribeck;
        model = model
            .with_friction(Friction { stribeck_velocity: 0.1, ..Friction::with_static(0.4, 1.96) });
        assert_eq!(
            stands(&model),
            SlidingFriction { coefficient: 0.0, damping: 0.0, transverse: 0.0 }
        );
        model.law.sticking = true;
        assert!(stands(&model).coefficient == 1.96 && stands(&model).damping < 0.0);
    }

    #[test]
    fn friction_that_falls_is_linear_only_about_an_equilibrium() {
        let mut model = set1();
        model.law.friction = Law::Stribeck;
        assert!(model.linear().unwrap_err().is_equilibrium());
        // µ(v) and N dµ/dv at v = v_s, with N = 3 N.
        let law = Friction { stribeck_velocity: 0.025, ..Friction::with_static(0.2, 0.6) };
        let model = model.with_friction(law);
        let found = model.linear_about(&equilibrium()).friction_of(0);
        let part = 0.4 * f64::exp(-1.0);
        assert!((found.coefficient - (0.2 + part)).abs() < 1e-15);
        assert!((found.damping + 3.0 * part / 0.025).abs() < 1e-12);
    }

    /// A mass m on springs k along the sliding and across it, pressed on with P; friction across the sliding direction is
    /// the damping µ P/v of the transverse mode alone.
    #[test]
    fn friction_across_the_sliding_direction_damps_the_transverse_mode_alone() {
        let (m, k, pressed, mu, v) = (2.0, 800.0, 30.0, 0.4, 0.5);
        let contact = Contact {
            transverse: Some(Direction::unit(1)),
            friction: mu.into(),
            surface_velocity: -v,
            ..Contact::new(Direction::unit(2), Direction::unit(0))
        };
        let mut model = LumpedModel {
            mass: SparseMatrix::diagonal(&[m; 3]),
            stiffness: SparseMatrix::diagonal(&[2.0 * k, k, k]),
            damping: Damping::default(),
            dampers: SparseMatrix::zero(3),
            load: vec![0.0, 0.0, -pressed],
            contacts: vec![contact],
            law: ContactLaw::default(),
        };
        assert!(model.needs_equilibrium() && model.linear().unwrap_err().is_equilibrium());
        let found = model.equilibrium(&|_| "c".to_owned()).unwrap();
        let spectrum =
            |states: &[ContactState]| Spectrum::of(model.linear_about(&found), states).unwrap();
        let rate = -0.5 * mu * pressed / v / m;
        for state in [ContactState::Slide, ContactState::ReverseSlide] {
            let [across, along] = spectrum(&[state]).oscillating[..] else { panic!() };
            assert!((across.re - rate).abs() < 1e-9, "{across}");
            assert!((across.im - (k / m - rate * rate).sqrt()).abs() < 1e-9, "{across}");
            assert!(along.re.abs() < 1e-9 && (along.im - (2.0 * k / m).sqrt()).abs() < 1e-9);
        }
        // A contact that sticks or is open has no such damping.
        for state in [ContactState::Stick, ContactState::Detached] {
            let all = spectrum(&[state]).oscillating;
            assert!(all.iter().all(|lambda| lambda.re.abs() < 1e-9), "{all:?}");
        }
        // The motion has none, and its critical step does not change.
        let with = critical_step(&model).unwrap();
        model.contacts[0].transverse = None;
        assert_eq!(critical_step(&model).unwrap(), with);
        assert!(!model.needs_equilibrium());
    }
}
