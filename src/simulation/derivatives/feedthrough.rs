//! Which inputs act on an output at the instant at which they are given.

use crate::scene::Scene;
use crate::simulation::catalogue::{Causality, Quantity, Variable};

/// The places in `variables` (all of the scene's) of the inputs that `output` depends on at once, in whatever states
/// the contacts are; none where it may depend on all of them. Importers ask for it to find loops.
#[must_use]
pub fn feedthrough(scene: &Scene, variables: &[Variable], output: &Variable) -> Option<Vec<usize>> {
    match output.template.quantity {
        // What the steps have led to.
        Quantity::Displacement | Quantity::Velocity => Some(Vec::new()),
        // A contact that may stick has no slip then, and forces decide of that.
        Quantity::SlipVelocity if scene.contact_law().is_frozen() => {
            let surface = |quantity| {
                variables.iter().position(|variable| {
                    let Variable { causality, template, index, .. } = variable;
                    let of_contact = quantity == Quantity::SliderVelocity || *index == output.index;
                    template.quantity == quantity && *causality == Causality::Input && of_contact
                })
            };
            let own = scene
                .network()
                .is_some_and(|network| network.contacts[output.index].velocity.is_some());
            let quantity = if own { Quantity::OwnVelocity } else { Quantity::SliderVelocity };
            Some(surface(quantity).into_iter().collect())
        }
        _ => None,
    }
}
