//! The derivative of a scene's model by one parameter.
//!
//! Masses, stiffnesses and the like enter the matrices linearly. The derivative by one of them is the model of the scene in
//! which it is 1 and all others are 0, so it has no error but that of the assembly itself. The matrices are trigonometric
//! polynomials of the second degree in the slider's angle: four other angles give their derivative without an error of
//! truncation (Mitarai et al., Phys. Rev. A 98, 032309, 2018).

use amontons::Error;
use amontons::contact::Friction;
use amontons::model::{Contact, Damping, Direction, LumpedModel, SparseMatrix};
use amontons::scene::{Scene, Structure};
use amontons::simulation::catalogue::Quantity;
use amontons::simulation::{Variable, write_scene};
use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, SQRT_2};

/// The derivative of a model; each part in its own unit per unit of the parameter.
#[derive(Clone, Debug)]
pub(super) struct ModelChange {
    pub(super) mass: SparseMatrix,
    pub(super) stiffness: SparseMatrix,
    pub(super) dampers: SparseMatrix,
    pub(super) damping: Damping,
    /// Constant loads and external forces.
    pub(super) load: Vec<f64>,
    pub(super) contacts: Vec<ContactChange>,
}

/// The derivative of a contact.
#[derive(Clone, Debug)]
pub(super) struct ContactChange {
    pub(super) normal: Direction,
    pub(super) tangent: Direction,
    pub(super) transverse: Option<Direction>,
    pub(super) friction: Friction,
    pub(super) velocity: f64,
}

impl ModelChange {
    /// The derivative of the model of a scene by a variable; `None` for variables that a model does not have, as initial
    /// values.
    ///
    /// # Errors
    /// Returns an error if the variable is an output.
    pub(super) fn by(scene: &Scene, variable: &Variable) -> Result<Option<Self>, Error> {
        match variable.template.quantity {
            Quantity::Mass | Quantity::Stiffness | Quantity::DamperDamping => {
                let mut bare = scene.clone();
                keep(&mut bare, Kept::Preloads);
                let found = model_at(bare, variable, 1.0)?;
                let LumpedModel { mass, stiffness, dampers, load, .. } = found;
                let none = Self::none(scene);
                Ok(Some(Self { mass, stiffness, dampers, load, ..none }))
            }
            Quantity::Preload | Quantity::ExternalForce => {
                let mut bare = scene.clone();
                keep(&mut bare, Kept::Stiffnesses);
                let load = model_at(bare, variable, 1.0)?.load;
                Ok(Some(Self { load, ..Self::none(scene) }))
            }
            Quantity::DampingAlpha => {
                let damping = Damping { alpha: 1.0, beta: 0.0 };
                Ok(Some(Self { damping, ..Self::none(scene) }))
            }
            Quantity::DampingBeta => {
                let damping = Damping { alpha: 0.0, beta: 1.0 };
                Ok(Some(Self { damping, ..Self::none(scene) }))
            }
            Quantity::SliderAngle => Self::by_angle(scene, variable).map(Some),
            Quantity::SliderVelocity
            | Quantity::OwnVelocity
            | Quantity::FrictionCoefficient
            | Quantity::StaticFriction
            | Quantity::StribeckVelocity
            | Quantity::OwnFriction
            | Quantity::OwnStaticFriction => {
                let [zero, one] = [0.0, 1.0].map(|value| model_at(scene.clone(), variable, value));
                let (zero, one) = (zero?, one?);
                let mut change = Self::none(scene);
                for (i, contact) in change.contacts.iter_mut().enumerate() {
                    contact.set_conditions(&zero.contacts[i], &one.contacts[i]);
                }
                Ok(Some(change))
            }
            _ => Ok(None),
        }
    }

    /// No change of a scene's model.
    fn none(scene: &Scene) -> Self {
        let dofs = scene.dof_names().len();
        let zero = || SparseMatrix::zero(dofs);
        let contact = ContactChange {
            normal: Direction(vec![]),
            tangent: Direction(vec![]),
            transverse: None,
            friction: Friction { kinetic: 0.0, static_: 0.0, stribeck_velocity: 0.0 },
            velocity: 0.0,
        };
        Self {
            mass: zero(),
            stiffness: zero(),
            dampers: zero(),
            damping: Damping::default(),
            load: vec![0.0; dofs],
            contacts: vec![contact; scene.contact_count()],
        }
    }

    /// The derivative by the angle θ of the slider. With f₁ and f₂ the parts of the first and second degree of f,
    /// f(θ + π/2) − f(θ − π/2) = 2 f₁′ and f(θ + π/4) − f(θ − π/4) = √2 f₁′ + f₂′.
    fn by_angle(scene: &Scene, variable: &Variable) -> Result<Self, Error> {
        let angle = scene.slider.angle;
        let whole = 0.5 - 0.5 * SQRT_2;
        let turns =
            [(1.0, FRAC_PI_4), (-1.0, -FRAC_PI_4), (whole, FRAC_PI_2), (-whole, -FRAC_PI_2)];
        let mut models = Vec::new();
        for (factor, turn) in turns {
            models.push((factor, model_at(scene.clone(), variable, angle + turn)?));
        }
        let matrix = |part: fn(&LumpedModel) -> &SparseMatrix| {
            let entries = models.iter().flat_map(|(factor, model)| {
                part(model).entries().map(move |(row, column, value)| (row, column, factor * value))
            });
            SparseMatrix::from_entries(models[0].1.dofs(), entries.collect())
        };
        let direction = |i: usize, part: &dyn Fn(&Contact) -> Option<&Direction>| {
            let mut sum = BTreeMap::new();
            for (factor, model) in &models {
                for &(dof, value) in part(&model.contacts[i]).iter().flat_map(|it| &it.0) {
                    *sum.entry(dof).or_insert(0.0) += factor * value;
                }
            }
            Direction(sum.into_iter().collect())
        };
        let mut change = Self::none(scene);
        change.mass = matrix(|model| &model.mass);
        change.stiffness = matrix(|model| &model.stiffness);
        change.dampers = matrix(|model| &model.dampers);
        for (dof, load) in change.load.iter_mut().enumerate() {
            *load = models.iter().map(|(factor, model)| factor * model.load[dof]).sum();
        }
        for (i, contact) in change.contacts.iter_mut().enumerate() {
            contact.normal = direction(i, &|it| Some(&it.normal));
            contact.tangent = direction(i, &|it| Some(&it.tangent));
            contact.transverse = Some(direction(i, &|it| it.transverse.as_ref()));
        }
        Ok(change)
    }
}

impl ContactChange {
    /// Takes the differences of friction and velocity between two values of a parameter that are 1 apart.
    fn set_conditions(&mut self, zero: &Contact, one: &Contact) {
        // Two infinite Stribeck velocities, of laws without one, do not differ.
        let difference = |zero: f64, one: f64| if zero == one { 0.0 } else { one - zero };
        let [from, to] = [zero.friction, one.friction];
        self.friction = Friction {
            kinetic: difference(from.kinetic, to.kinetic),
            static_: difference(from.static_, to.static_),
            stribeck_velocity: difference(from.stribeck_velocity, to.stribeck_velocity),
        };
        self.velocity = one.surface_velocity - zero.surface_velocity;
    }
}

/// The model of a scene with a value of a variable; external forces are part of its load.
fn model_at(mut scene: Scene, variable: &Variable, value: f64) -> Result<LumpedModel, Error> {
    write_scene(&mut scene, variable, value)?;
    let mut model = LumpedModel::from(&scene);
    model.load.iter_mut().zip(scene.external_forces()).for_each(|(load, force)| *load += force);
    Ok(model)
}

/// The values that a scene keeps where its other masses, stiffnesses, dampers and loads become 0.
#[derive(Clone, Copy, PartialEq)]
enum Kept {
    Preloads,
    Stiffnesses,
}

fn keep(scene: &mut Scene, kept: Kept) {
    match &mut scene.structure {
        Structure::Ring(modules) => {
            for module in modules {
                module.mass = [0.0; 2];
                module.force = [0.0; 4];
                match kept {
                    Kept::Preloads => module.stiffness = [0.0; 6],
                    Kept::Stiffnesses => module.preload = 0.0,
                }
            }
        }
        Structure::Network(network) => {
            for mass in &mut network.masses {
                (mass.mass, mass.load, mass.force) = (0.0, [0.0; 2], [0.0; 2]);
            }
            for spring in &mut network.springs {
                match (kept, &mut spring.preload) {
                    (Kept::Preloads, _) => spring.stiffness = 0.0,
                    (Kept::Stiffnesses, Some(preload)) => *preload = 0.0,
                    (Kept::Stiffnesses, None) => {}
                }
            }
            network.dampers.iter_mut().for_each(|damper| damper.damping = 0.0);
            for one in &mut network.superelements {
                one.matrices = one.matrices.emptied();
                one.load.fill(0.0);
                one.force.fill(0.0);
            }
        }
    }
}
