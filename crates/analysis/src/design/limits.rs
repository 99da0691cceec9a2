//! Growth rates over a range of friction coefficients, with their derivatives by the changes of a design.

use super::vary::{Varied, scene_at};
use crate::stability::parallel::collect;
use crate::stability::{Linearised, group_derivatives};
use crate::watch::Watch;
use amontons::Error;
use amontons::contact::ContactState;
use amontons::error::Rounded;
use amontons::model::LinearModel;
use amontons::scene::Scene;
use amontons::stability::Spectrum;
use nalgebra::Complex;
use std::cmp::Ordering;
use std::sync::atomic::{AtomicU64, Ordering as Access};

/// The part of a range over which differences are taken.
const SECANT: f64 = 1e-4;

/// The spectra and derivatives that a search has taken. Nobody knows their number before the search ends, so the part that is done
/// rises ever more slowly: half of it stands for the usual number.
pub(super) struct Effort<'a> {
    count: AtomicU64,
    usual: f64,
    progress: &'a (dyn Fn(f64) + Sync),
}

impl<'a> Effort<'a> {
    /// No effort so far; `progress` receives the part, from 0 to 1.
    pub(super) fn new(usual: f64, progress: &'a (dyn Fn(f64) + Sync)) -> Self {
        Self { count: AtomicU64::new(0), usual, progress }
    }

    #[allow(clippy::cast_precision_loss)]
    fn add(&self) {
        let count = (self.count.fetch_add(1, Access::Relaxed) + 1) as f64;
        (self.progress)(count / (count + self.usual));
    }
}

/// The scene, its changes, and the contact states in which no mode may grow.
#[derive(Clone, Copy)]
pub(super) struct Structure<'a> {
    /// The scene, without signals.
    pub(super) scene: &'a Scene,
    pub(super) varied: &'a [Varied],
    /// The contact states, one entry for each contact.
    pub(super) patterns: &'a [Vec<ContactState>],
    /// `true` if the one contact state is uniform sliding: there must then be an equilibrium in it.
    pub(super) is_uniform: bool,
    pub(super) watch: Watch<'a>,
    pub(super) effort: &'a Effort<'a>,
}

/// A contact state at a friction coefficient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    /// The place of the contact state.
    pub(super) pattern: usize,
    pub(super) friction: f64,
}

/// A mode at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Found {
    pub(super) place: Place,
    /// λ, 1/s, with Im λ ≥ 0.
    pub(super) eigenvalue: Complex<f64>,
}

/// A mode's growth rate with its derivatives.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Row {
    /// Re λ, 1/s.
    pub(super) growth: f64,
    /// ∂ Re λ / ∂x by each change, 1/s.
    pub(super) by: Vec<f64>,
}

impl Structure<'_> {
    /// The model after these changes at a friction coefficient.
    ///
    /// # Errors
    /// Returns an error if values are impossible together, if the equilibrium is not in uniform sliding, where it has to be, or if
    /// the watch has ended the work.
    pub(super) fn model(&self, changes: &[f64], friction: f64) -> Result<Linearised, Error> {
        self.watch.check()?;
        let mut scene = self.scene.clone();
        scene.friction_coefficient = friction;
        let scene = scene_at(&scene, self.varied, changes)?;
        let here = Linearised::of(&scene);
        if self.is_uniform {
            let at =
                |error: Error| Error::equilibrium(format!("at µ = {}: {error}", Rounded(friction)));
            here.equilibrium_in(&self.patterns[0]).map_err(at)?;
        }
        Ok(here)
    }

    /// The mode that grows fastest at a place after these changes; `None` if there is no mode.
    ///
    /// # Errors
    /// Returns an error if the state cannot be analysed.
    pub(super) fn fastest_at(&self, changes: &[f64], place: Place) -> Result<Option<Found>, Error> {
        Ok(fastest(&self.spectrum(changes, place)?))
    }

    /// All modes at a place after these changes.
    ///
    /// # Errors
    /// Returns an error if the state cannot be analysed.
    pub(super) fn spectrum(&self, changes: &[f64], place: Place) -> Result<Vec<Found>, Error> {
        self.modes_of(self.model(changes, place.friction)?.linear()?, place)
    }

    /// All modes of a model at its place.
    fn modes_of(&self, model: LinearModel<'_>, place: Place) -> Result<Vec<Found>, Error> {
        self.watch.check()?;
        self.effort.add();
        let Spectrum { oscillating, real } = Spectrum::of(model, &self.patterns[place.pattern])?;
        let all = oscillating.into_iter().chain(real.into_iter().map(Complex::from));
        Ok(all.map(|eigenvalue| Found { place, eigenvalue }).collect())
    }

    /// All modes of all contact states at these friction coefficients, in the order of these.
    ///
    /// # Errors
    /// Returns an error if values are impossible together, if a state cannot be analysed, or if the watch has ended the work.
    pub(super) fn modes(&self, changes: &[f64], frictions: &[f64]) -> Result<Vec<Found>, Error> {
        let at = |i: usize| {
            let friction = frictions[i];
            let here = self.model(changes, friction)?;
            let linear = here.linear()?;
            let mut found = Vec::new();
            for pattern in 0..self.patterns.len() {
                found.extend(self.modes_of(linear, Place { pattern, friction })?);
            }
            Ok(found)
        };
        Ok(collect(frictions.len(), &at, &|_| {})?.into_iter().flatten().collect())
    }

    /// The growth rates of some modes with their derivatives. Modes of one place stand together.
    ///
    /// # Errors
    /// Returns an error if a state has no derivatives, or if the watch has ended the work.
    pub(super) fn rows(&self, changes: &[f64], modes: &[Found]) -> Result<Vec<Row>, Error> {
        let groups: Vec<Vec<(&str, f64)>> = self
            .varied
            .iter()
            .map(|one| one.parts.iter().map(|part| (&*part.name, part.scale)).collect())
            .collect();
        let places: Vec<&[Found]> = modes.chunk_by(|a, b| a.place == b.place).collect();
        let at = |i: usize| {
            let Place { pattern, friction } = places[i][0].place;
            let here = self.model(changes, friction)?;
            let values: Vec<Complex<f64>> = places[i].iter().map(|it| it.eigenvalue).collect();
            // Shapes of modes that are about to merge may not be told apart.
            let may_begin = || self.watch.check();
            let all =
                group_derivatives(&here, &self.patterns[pattern], &groups, &values, &may_begin)
                    .unwrap_or_else(|_| vec![None; values.len()]);
            let rows = values.iter().zip(all).map(|(value, by)| {
                let by = match by {
                    Some(by) => by.iter().map(|by| by.re).collect(),
                    None => self.secants(changes, places[i][0].place, *value)?,
                };
                self.effort.add();
                Ok(Row { growth: value.re, by })
            });
            rows.collect::<Result<Vec<Row>, Error>>()
        };
        Ok(collect(places.len(), &at, &|_| {})?.into_iter().flatten().collect())
    }

    /// Differences of a mode's growth rate over small changes, 1/s for a change of 1. They stand for derivatives where modes merge.
    fn secants(
        &self,
        changes: &[f64],
        place: Place,
        from: Complex<f64>,
    ) -> Result<Vec<f64>, Error> {
        let by = |i: usize| {
            let [low, high] = self.varied[i].bounds;
            let step =
                if changes[i] < 0.5 * (low + high) { SECANT } else { -SECANT } * (high - low);
            let mut moved = changes.to_vec();
            moved[i] += step;
            let all = self.spectrum(&moved, place)?;
            let near = |it: &&Found| (it.eigenvalue - from).norm();
            let nearest = all.iter().map(|it| near(&it)).fold(f64::INFINITY, f64::min);
            // Of two modes that part from a merging both are equally near.
            let to = all.iter().filter(|it| near(it) <= 1.5 * nearest).map(|it| it.eigenvalue.re);
            Ok((to.fold(f64::NEG_INFINITY, f64::max) - from.re) / step)
        };
        (0..self.varied.len()).map(by).collect()
    }
}

/// The mode that grows fastest; `None` if there is no mode.
pub(super) fn fastest(modes: &[Found]) -> Option<Found> {
    modes.iter().copied().max_by(by_growth)
}

/// The order of growth rates.
pub(super) fn by_growth(a: &Found, b: &Found) -> Ordering {
    a.eigenvalue.re.total_cmp(&b.eigenvalue.re)
}
