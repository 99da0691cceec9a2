//! All contact states of a model at once, those that symmetry makes equal solved once.

use super::parallel;
use crate::watch::Watch;
use amontons::Error;
use amontons::contact::{ContactState, all_states};
use amontons::model::{LinearModel, LumpedModel};
use amontons::stability::{Spectrum, Symmetry};
use std::collections::HashMap;

/// The most contacts with which all states are analysed.
pub const MAX_CONTACTS: usize = 8;

/// All contact states of a model, in classes that symmetry makes equal.
#[derive(Clone, Debug, PartialEq)]
pub struct StateClasses {
    /// One state for each class.
    pub representatives: Vec<Vec<ContactState>>,
    /// Each state that the law of contact allows, with its class, in the order of [`all_states`].
    pub states: Vec<(Vec<ContactState>, usize)>,
}

impl StateClasses {
    /// The classes of a model's states.
    ///
    /// # Errors
    /// Returns an error if there are more contacts than [`MAX_CONTACTS`].
    pub fn of(model: &LumpedModel) -> Result<Self, Error> {
        let contacts = model.contacts.len();
        if contacts > MAX_CONTACTS {
            return Err(Error::analysis(format!(
                "{contacts} contacts have 4^{contacts} states, but all states are analysed only for up to \
                 {MAX_CONTACTS} contacts: use a scene with fewer contacts, or analyse single states \
                 with `states --state` and `locus --state`"
            )));
        }
        let symmetry = Symmetry::of(model);
        let mut classes = Self { representatives: Vec::new(), states: Vec::new() };
        let mut places = HashMap::new();
        let is_allowed = |states: &Vec<_>| states.iter().all(|state| model.law.allows(*state));
        for states in all_states(u32::try_from(contacts).expect("few")).filter(is_allowed) {
            let next = classes.representatives.len();
            let class = *places.entry(symmetry.representative(&states)).or_insert(next);
            if class == next {
                classes.representatives.push(states.clone());
            }
            classes.states.push((states, class));
        }
        Ok(classes)
    }

    /// The states of a class.
    pub fn members(&self, class: usize) -> impl Iterator<Item = &Vec<ContactState>> {
        self.states.iter().filter(move |(_, other)| *other == class).map(|(states, _)| states)
    }

    /// The spectrum of each class, on all cores. The watch receives the part that is done, and can end the work.
    ///
    /// # Errors
    /// Returns an error if a class has no spectrum ([`Spectrum::of`]), or if the watch has ended the work.
    pub fn spectra(
        &self,
        model: LinearModel<'_>,
        watch: Watch<'_>,
    ) -> Result<Vec<Spectrum>, Error> {
        spectra_of(&self.representatives, model, watch)
    }
}

/// The spectrum of each of these patterns of contact states, on all cores. The watch receives the part that is done, and can
/// end the work.
///
/// # Errors
/// Returns an error if one has no spectrum ([`Spectrum::of`]), or if the watch has ended the work.
pub fn spectra_of(
    patterns: &[impl AsRef<[ContactState]> + Sync],
    model: LinearModel<'_>,
    watch: Watch<'_>,
) -> Result<Vec<Spectrum>, Error> {
    let work = |place: usize| {
        watch.check()?;
        Spectrum::of(model, patterns[place].as_ref())
    };
    parallel::collect(patterns.len(), &work, &watch.parts(patterns.len()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use amontons::scene::builtin;

    #[test]
    fn symmetry_leaves_ten_of_the_sixteen_states_of_two_equal_modules() {
        let mut scene = builtin("set2").unwrap().scene();
        let classes = StateClasses::of(&LumpedModel::from(&scene)).unwrap();
        assert_eq!((classes.representatives.len(), classes.states.len()), (10, 16));
        assert_eq!((0..10).map(|class| classes.members(class).count()).sum::<usize>(), 16);
        scene.modules_mut()[0].mass[0] *= 1.5;
        let classes = StateClasses::of(&LumpedModel::from(&scene)).unwrap();
        assert_eq!(classes.representatives.len(), 16);
    }

    #[test]
    fn the_spectrum_of_a_class_is_that_of_each_of_its_states() {
        let mut scene = builtin("set1").unwrap().scene();
        scene.modules_mut().extend_from_within(..1);
        let model = LumpedModel::from(&scene);
        let classes = StateClasses::of(&model).unwrap();
        let model = model.linear().unwrap();
        let spectra = classes.spectra(model, Watch::IDLE).unwrap();
        assert_eq!(spectra.len(), 20);
        for (states, class) in &classes.states {
            let own = Spectrum::of(model, states).unwrap();
            assert_eq!(own.oscillating.len(), spectra[*class].oscillating.len());
            for (a, b) in own.oscillating.iter().zip(&spectra[*class].oscillating) {
                // Double eigenvalues may coalesce, where half of the digits are rounding.
                assert!((a - b).norm() < 1e-6 * a.norm(), "{states:?} {a} {b}");
            }
        }
    }
}
