//! Direct feedthrough: the inputs that act on an output at the instant at which they are given.

use amontons::scene::Scene;
use amontons::simulation::catalogue::{Causality, Quantity, Variable};

/// The places in `variables` (all of the scene's) of the inputs that `output` depends on at once, in whatever states
/// the contacts are; none where it may depend on all of them. Importers ask for it to find loops.
#[must_use]
pub fn feedthrough(scene: &Scene, variables: &[Variable], output: &Variable) -> Option<Vec<usize>> {
    match output.template.quantity {
        // The steps have determined these values before.
        Quantity::Displacement | Quantity::Velocity => Some(Vec::new()),
        // A contact that may stick has no slip then, and forces decide of that.
        Quantity::SlipVelocity if scene.contact_law().has_fixed_state() => {
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

#[cfg(test)]
mod tests {
    use super::*;
    use amontons::scene::parse;
    use amontons::simulation::variables;

    /// The names of the inputs that the slips of two contacts depend on: one on the common slider, one on a surface
    /// of its own.
    fn of_slips(effects: &str) -> Vec<Option<Vec<String>>> {
        let scene = parse(
            "two",
            &format!(
                "[slider]\nvelocity = 0.1\nangle = 0.0\n[friction]\ncoefficient = 0.5\n[effects]\n{effects}\n\
                 [[mass]]\nname = \"a\"\nmass = 0.5\nforce = [0.0, -5.0]\n\
                 [[mass]]\nname = \"b\"\nmass = 0.7\nforce = [0.0, -5.0]\n\
                 [[spring]]\nname = \"ka\"\nbetween = [\"a\", \"ground\"]\ndirection = \"x\"\nstiffness = 200.0\n\
                 [[spring]]\nname = \"kb\"\nbetween = [\"b\", \"ground\"]\ndirection = \"x\"\nstiffness = 200.0\n\
                 [[contact]]\nname = \"common\"\nmass = \"a\"\n\
                 [[contact]]\nname = \"own\"\nmass = \"b\"\nvelocity = 0.2\nfriction = 0.3\n\
                 [integrator]\nstep = 1e-4\n"
            ),
        )
        .unwrap();
        let all = variables(&scene);
        let slips = all.iter().filter(|one| one.template.quantity == Quantity::SlipVelocity);
        let names = |places: Vec<usize>| places.iter().map(|&i| all[i].name.clone()).collect();
        slips.map(|slip| feedthrough(&scene, &all, slip).map(names)).collect()
    }

    #[test]
    fn a_slip_that_cannot_stop_depends_on_the_velocity_of_its_own_surface() {
        let velocities = ["slider.velocity", "contact.own.velocity"];
        let each = velocities.map(|name| Some(vec![name.to_owned()]));
        assert_eq!(of_slips("sticking = false"), each);
        assert_eq!(of_slips("sticking = true"), [None, None]);
    }
}
