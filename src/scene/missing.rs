//! Explanations of variables that other scenes have and this one does not: the reason, and how to add them.

use super::names::has_node;
use super::roles::{Group, Role};
use super::{Network, Point, Scene, Spring};
use crate::contact::Law;

/// Explanation why a scene does not have a variable.
pub struct MissingFeature {
    /// The feature that the scene does not use.
    pub reason: String,
    /// The change to the scene that adds it.
    pub help: String,
}

impl MissingFeature {
    fn new(reason: impl Into<String>, help: impl Into<String>) -> Option<Self> {
        Some(Self { reason: reason.into(), help: help.into() })
    }
}

impl Scene {
    /// Explains why the scene has no variable of this name; `None` unless a missing value or effect is the reason.
    pub fn explain_missing(&self, name: &str) -> Option<MissingFeature> {
        let effects = &self.effects;
        match name {
            "damping.alpha" if !effects.mass_damping => MissingFeature::new(
                "the scene has no mass-proportional damping",
                "write `alpha = 0.0` into its [damping] to add it",
            ),
            "damping.beta" if !effects.stiffness_damping => MissingFeature::new(
                "the scene has no stiffness-proportional damping",
                "write `beta = 0.0` into its [damping] to add it",
            ),
            "friction.coefficient" | "friction.static" | "friction.stribeck_velocity"
                if self.friction_law == Law::Frictionless =>
            {
                MissingFeature::new(
                    "the scene has no friction",
                    "write `coefficient = …` in place of `law = \"none\"` into its [friction]",
                )
            }
            "slider.velocity" if !self.has_common_velocity() => self.own("velocity"),
            "slider.angle" if !self.has_common_angle() => self.own("angle"),
            "friction.coefficient" if !self.has_common_friction() => self.own("friction"),
            "friction.static"
                if self.static_friction.is_some() && !self.has_common_static_friction() =>
            {
                self.own("static_friction")
            }
            "friction.static" if self.static_friction.is_none() => MissingFeature::new(
                "the scene has no static friction",
                "write `static = …` into its [friction] to add it",
            ),
            "friction.stribeck_velocity" if self.stribeck_velocity.is_none() => {
                MissingFeature::new(
                    "the friction of the scene does not depend on the slip velocity",
                    "write `stribeck_velocity = …` beside `static` into the [friction] of the scene",
                )
            }
            _ if self.roles.of(Group::Forces).is_none() && self.is_force(name) => {
                MissingFeature::new(
                    "the scene has no external forces",
                    "write `forces = \"input\"` into its [inputs]",
                )
            }
            _ => self.explain_missing_part(name),
        }
    }

    /// Explains why the scene has no input of this name; `None` unless it could have one.
    pub fn explain_missing_input(&self, name: &str) -> Option<MissingFeature> {
        let mut given = self.may_be_driven();
        match given.find(|(_, known)| known == name) {
            Some((group, _)) if self.roles.of(group) == Some(Role::Parameter) => {
                MissingFeature::new(
                    "it is a parameter in this scene",
                    format!("write `{} = \"input\"` into its [inputs]", group.key()),
                )
            }
            _ => self.explain_missing(name),
        }
    }

    /// Explains the absence of a common value that no contact uses.
    fn own(&self, key: &str) -> Option<MissingFeature> {
        match self.network().and_then(|network| network.contacts.first()) {
            Some(first) => MissingFeature::new(
                "every contact has its own value",
                format!(
                    "use the value of one contact, such as contact.{}.{key}, with --set, --parameter, --x or --sweep",
                    first.name
                ),
            ),
            None => MissingFeature::new("the scene has no contact", "add a [[contact]] to it"),
        }
    }

    fn is_force(&self, name: &str) -> bool {
        self.may_be_driven().any(|(group, known)| group == Group::Forces && known == name)
    }

    /// Explains the absence of a module's links or preload, or of a spring's preload.
    fn explain_missing_part(&self, name: &str) -> Option<MissingFeature> {
        let (part, key) = name.rsplit_once('.')?;
        if let Some(network) = self.network() {
            if let Some(hidden) = hidden_part(network, part) {
                return Some(hidden);
            }
            let has_none = |spring: &&Spring| {
                spring.preload.is_none() && part.strip_prefix("spring.") == Some(&spring.name)
            };
            let spring = network.springs.iter().find(has_none).filter(|_| key == "preload")?;
            let reason = format!("spring {} has no preload", spring.name);
            return MissingFeature::new(
                reason,
                "write `preload = 0.0` into its [[spring]] to add one",
            );
        }
        let module = part.strip_prefix("module[")?.strip_suffix(']')?.parse().ok()?;
        if !(1..=self.modules().len()).contains(&module) {
            return None;
        }
        match key {
            "k1" | "k2" if !self.effects.links => MissingFeature::new(
                "no links join the modules",
                "write `k1` and `k2` into its [ring]",
            ),
            "preload" if !self.effects.preload => MissingFeature::new(
                "the ring has no preload",
                "write `preload = 0.0` into its [ring]",
            ),
            _ => None,
        }
    }
}

/// Explains the absence of a contact or a node that the FMU does not show.
fn hidden_part(network: &Network, part: &str) -> Option<MissingFeature> {
    let (list, name, what) = if let Some(name) = part.strip_prefix("contact.") {
        let contact = network.contacts.iter().find(|contact| contact.name == name)?;
        ("contacts", contact.name.clone(), format!("contact {name}"))
    } else {
        let (superelement, node) = part.strip_prefix("superelement.")?.split_once(".node[")?;
        let node: u64 = node.strip_suffix(']')?.parse().ok()?;
        let one = network.superelements.iter().find(|one| one.name == superelement)?;
        let what = format!("node {node} of superelement {superelement}");
        has_node(one, node).then(|| ("nodes", format!("{superelement}.{node}"), what))?
    };
    let is_shown = match list {
        "contacts" => network.contacts.iter().any(|one| one.name == name && one.is_shown),
        _ => network.shown.nodes.iter().any(|at| network.point_name(Point::Node(*at)) == name),
    };
    if is_shown {
        return None;
    }
    let help = format!("name \"{name}\" in `{list}` of its [outputs]");
    MissingFeature::new(format!("the scene does not show {what}"), help)
}
