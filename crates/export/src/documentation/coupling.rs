//! Coupling of the FMU with another one: the values that it gives, and those that it takes.
//!
//! The two values of a coupling belong together: their product is the power that goes from one FMU to the other. A
//! drive gives the velocity of a surface and takes the force on it along that velocity; contacts that rub on one body
//! are one surface, and count with the signs by which the body moves them.

use super::importing::first;
use super::{can_squeal, counted};
use amontons::model::Equilibrium;
use amontons::scene::{ContactDefinition, Network, Point, Scene, direction};
use amontons::simulation::catalogue::{Causality, Per, Quantity, Variable};
use amontons_pictures::picture::significant;

/// Conditions under which a coupling converges (`examples/importers/README.md`).
const EXCHANGE: &str = "While contacts slide, a communication step well below the period of the motion is short \
                        enough; while they stick, give values with their derivatives, since held values lose momentum \
                        at any communication step.";
/// The most drives that are described.
const MOST_DRIVES: usize = 4;
/// The most contacts of a drive that are written out.
const MOST_CONTACTS: usize = 6;
/// Velocities and tangents that differ by less than this part are one.
const SAME: f64 = 1e-9;

/// Description of the coupling with another FMU.
pub(super) fn coupling(
    scene: &Scene,
    start: &Equilibrium,
    variables: &[Variable],
) -> Option<String> {
    if can_squeal(scene) {
        let drives = drives(scene, start, variables);
        if !drives.is_empty() {
            return Some(describe_drives(&drives));
        }
    }
    let force = first(variables, Quantity::ExternalForce, Causality::Input)?;
    let velocity = velocity_along(scene, force, variables)?;
    Some(format!("another FMU gives {} and takes {}. {EXCHANGE}", force.name, velocity.name))
}

/// The velocity of what a force acts on, along the force.
fn velocity_along<'a>(
    scene: &Scene,
    force: &Variable,
    variables: &'a [Variable],
) -> Option<&'a Variable> {
    let find = |quantity: Quantity, per: Per, index: usize, component: usize| {
        variables.iter().find(|v| {
            (v.template.quantity, v.template.per, v.index, v.template.component)
                == (quantity, per, index, component)
        })
    };
    let axis = force.template.component;
    // Against its tangent the slip is the velocity over a surface that may itself move (`scenes/drive.toml`).
    let slips_along = |network: &Network| {
        let (point, along) = match force.template.per {
            Per::Mass => {
                let [cos, sin] = direction(network.masses[force.index].angle);
                let axes = [[cos, sin, 0.0], [-sin, cos, 0.0]];
                (Point::Mass(force.index), axes[axis])
            }
            _ => {
                let mut along = [0.0; 3];
                along[axis] = 1.0;
                (Point::Node(network.shown.nodes[force.index]), along)
            }
        };
        network.contacts.iter().position(|place| {
            let tangent = tangent(scene, place);
            (place.mass, place.on) == (point, None) && dot(tangent, along) < SAME - 1.0
        })
    };
    let slip = scene.network().and_then(slips_along);
    let slip = slip.and_then(|contact| find(Quantity::SlipVelocity, Per::Contact, contact, 0));
    slip.or_else(|| find(Quantity::Velocity, force.template.per, force.index, axis))
}

/// The drive of a surface.
struct SurfaceDrive {
    /// The inputs that it gives, in words.
    gives: String,
    /// The input of the drive, in words: the force of the contacts on it, along its velocity.
    takes: String,
    /// Force of the contacts on the surface in the equilibrium, N.
    force: f64,
    /// Velocity of the surface, m/s.
    velocity: f64,
}

/// The drives of a scene: that of the common slider, then those of surfaces that have velocities of their own.
fn drives(scene: &Scene, start: &Equilibrium, variables: &[Variable]) -> Vec<SurfaceDrive> {
    let mut drives = Vec::new();
    let velocity = first(variables, Quantity::SliderVelocity, Causality::Input);
    let reaction = first(variables, Quantity::TangentialReaction, Causality::Output);
    if let (Some(velocity), Some(reaction)) = (velocity, reaction) {
        let forces = start.friction_force.iter().enumerate();
        let on_slider = forces.filter(|(contact, _)| scene.is_on_slider(*contact));
        drives.push(SurfaceDrive {
            gives: velocity.name.clone(),
            takes: reaction.name.clone(),
            force: -on_slider.map(|(_, force)| force).sum::<f64>(),
            velocity: scene.slider.velocity,
        });
    }
    if let Some(network) = scene.network()
        && first(variables, Quantity::OwnVelocity, Causality::Input).is_some()
    {
        let own = surfaces(scene, network).into_iter();
        drives.extend(own.map(|surface| surface.drive(network, start)));
    }
    drives
}

/// The contacts (from 0) whose surfaces the body moves that moves the first surface with a velocity of its own.
pub(super) fn moved_with_first(scene: &Scene) -> Vec<usize> {
    let surfaces = scene.network().map(|network| surfaces(scene, network)).unwrap_or_default();
    let first = surfaces.first().map_or(&[][..], |surface| &surface.contacts);
    first.iter().take(MOST_CONTACTS).map(|(contact, _)| *contact).collect()
}

/// A body that moves the surfaces of contacts which have velocities of their own.
struct Surface {
    /// The contacts, each with the sign of its velocity where that of the first is positive.
    contacts: Vec<(usize, f64)>,
}

fn surfaces(scene: &Scene, network: &Network) -> Vec<Surface> {
    let mut surfaces: Vec<Surface> = Vec::new();
    for (i, place) in network.contacts.iter().enumerate() {
        if place.velocity.is_none() {
            continue;
        }
        let joined = surfaces.iter_mut().find_map(|surface| {
            let first = &network.contacts[surface.contacts[0].0];
            moved_together(scene, first, place).map(|sign| (surface, sign))
        });
        match joined {
            Some((surface, sign)) => surface.contacts.push((i, sign)),
            None => surfaces.push(Surface { contacts: vec![(i, 1.0)] }),
        }
    }
    surfaces
}

/// The sign of the velocity of the second contact's surface where that of the first is positive, if one body moves
/// both; `None` if it does not.
///
/// The surfaces of one mass that move equally fast are moved by one body; surfaces that belong to no mass must
/// besides move in the same direction.
fn moved_together(
    scene: &Scene,
    one: &ContactDefinition,
    other: &ContactDefinition,
) -> Option<f64> {
    let (a, b) = (one.velocity?, other.velocity?);
    let along = dot(tangent(scene, one), tangent(scene, other));
    let is_parallel = along.abs() > 1.0 - SAME;
    let is_one_body = one.on == other.on && (a.abs() - b.abs()).abs() <= SAME * a.abs();
    match (one.on.is_some(), a == 0.0) {
        // Surfaces that stand still have their signs in their tangents alone.
        (true, true) => (is_one_body && is_parallel).then_some(along.signum()),
        (true, false) => is_one_body.then_some((a * b).signum()),
        (false, true) => None,
        (false, false) => {
            let goes_along = is_parallel && a * b * along > 0.0;
            (is_one_body && goes_along).then_some(along.signum())
        }
    }
}

fn tangent(scene: &Scene, place: &ContactDefinition) -> [f64; 3] {
    place.directions(scene.slider.angle)[1]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl Surface {
    fn drive(&self, network: &Network, start: &Equilibrium) -> SurfaceDrive {
        let name = |contact: usize| format!("contact.{}", network.contacts[contact].name);
        let first = self.contacts[0].0;
        let mut gives = format!("{}.velocity", name(first));
        let mut takes = format!("−{}.friction_force", name(first));
        if self.contacts.len() > MOST_CONTACTS {
            gives = format!(
                "{gives} = v and v or −v to the {} other contacts that it moves, with the signs of their velocities \
                 in the scene,",
                self.contacts.len() - 1
            );
            takes = "−friction_force of each, summed with these signs".to_owned();
        } else if self.contacts.len() > 1 {
            gives += " = v";
            for (place, (contact, sign)) in self.contacts.iter().enumerate().skip(1) {
                let is_last = place + 1 == self.contacts.len();
                let minus = if *sign < 0.0 { "−" } else { "" };
                let (and, end) = if is_last { (" and ", ",") } else { (", ", "") };
                gives += &format!("{and}{}.velocity = {minus}v{end}", name(*contact));
                let operator = if *sign < 0.0 { "+" } else { "−" };
                takes += &format!(" {operator} {}.friction_force", name(*contact));
            }
        }
        let forces = self.contacts.iter();
        let force =
            -forces.map(|(contact, sign)| sign * start.friction_force[*contact]).sum::<f64>();
        SurfaceDrive {
            gives,
            takes,
            force,
            velocity: network.contacts[first].velocity.unwrap_or(0.0),
        }
    }
}

fn describe_drives(drives: &[SurfaceDrive]) -> String {
    let mut words = Vec::new();
    for (place, drive) in drives.iter().take(MOST_DRIVES).enumerate() {
        let who = if place == 0 { "a drive" } else { "Another drive" };
        words.push(format!("{who} gives {} and takes {}.", drive.gives, drive.takes));
        if drive.force != 0.0 {
            let which = if drive.force * drive.velocity < 0.0 { "against" } else { "along" };
            let force = significant(drive.force, 5).replace('-', "−");
            words
                .push(format!("In the equilibrium this force is {force} N, {which} its velocity."));
        }
    }
    if drives.len() > MOST_DRIVES {
        let more = counted(drives.len() - MOST_DRIVES, "more surface", "more surfaces");
        words.push(format!("The scene has {more}; each has a drive of its own."));
    }
    words.push(EXCHANGE.to_owned());
    words.join(" ")
}
