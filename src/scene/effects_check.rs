//! Checks of the effects: combinations that contradict each other or the rest of the scene.

use super::check::{Checks, Owner};
use super::{Method, Problem, Scene, Selection, Structure};
use crate::contact::Law;
use crate::contact::friction::LawInfo;

/// Reports effects that contradict each other, or the rest of the scene.
pub(super) fn check(scene: &Scene, checks: &mut Checks<'_>) {
    let law = scene.contact_law().friction;
    let about = law.info();
    let problem = |path: &str, message: String, help: &str| Problem::new(path, message).help(help);
    report_own_friction(scene, about, checks);
    if scene.effects.has_fixed_direction(law) && law == Law::StaticKinetic {
        let message = "contacts that do not stick have no static friction".to_owned();
        let help = "leave `static` or `static_friction` out, or let contacts stick";
        checks.problems.push(problem("effects.sticking", message, help).of(false));
    }
    if !scene.effects.detachment {
        report_open_contacts(scene, checks);
    }
    let exact = match scene.selection {
        Selection::Given if scene.method != Method::EventDriven => return,
        Selection::Given => "the event-driven method".to_owned(),
        selection => format!("integrator.{selection} relies on the event-driven method, which"),
    };
    if !about.is_constant() {
        let name = about.name;
        let message = format!(
            "{exact} does not support the law \"{name}\": friction that depends on the slip velocity \
             makes the motion between events nonlinear"
        );
        let help =
            "give method = \"forward-increment\" and a step, or a law with constant coefficients";
        checks.problems.push(problem("friction.law", message, help));
    }
    if scene.contact_law().follows_size() && scene.contact_count() > 0 {
        let message = format!(
            "{exact} does not support contacts that can stick but cannot open: their friction is \
             proportional to |N|, which is nonlinear where N changes sign"
        );
        let help = "give method = \"forward-increment\" and a step, or sticking = false";
        checks.problems.push(problem("effects.detachment", message, help).of(false));
    }
}

/// Reports contacts that have a friction coefficient of their own which the scene's law of friction does not use.
fn report_own_friction(scene: &Scene, about: LawInfo, checks: &mut Checks<'_>) {
    let contacts = scene.network().map_or(&[][..], |network| &network.contacts);
    for (i, place) in contacts.iter().enumerate() {
        let own = [
            ("friction", "coefficient", place.friction),
            ("static_friction", "static", place.static_friction),
        ];
        let unused = own.into_iter().filter(|(_, of_law, _)| !about.keys.contains(of_law));
        for (key, value) in unused.filter_map(|(key, _, value)| Some((key, value?))) {
            let message = format!("the scene's law \"{}\" does not use this key", about.name);
            let problem = checks.problem(Owner::Contact(i), key, message).of(value);
            checks.problems.push(problem.help("leave it out, or give [friction] another law"));
        }
    }
}

/// Reports modules that start with a contact that is open or opens. A network cannot be checked without the
/// directions of its contacts, so the model refuses it.
fn report_open_contacts(scene: &Scene, checks: &mut Checks<'_>) {
    let Structure::Ring(modules) = &scene.structure else { return };
    for (i, module) in modules.iter().enumerate() {
        for (key, value) in [("x4", module.displacement[3]), ("v4", module.velocity[3])] {
            if value != 0.0 {
                let message = "must be zero, since contacts cannot open in this scene";
                let problem = checks.problem(Owner::InitialOfModule(i), key, message).of(value);
                checks
                    .problems
                    .push(problem.help("leave it out, or let contacts open by effects.detachment"));
            }
        }
    }
}
