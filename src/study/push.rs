//! A small push out of an equilibrium: friction lets even an unstable one rest for ever.

use crate::Error;
use crate::model::{Contact, LumpedModel};
use crate::scene::Scene;
use crate::simulation::assign;
use std::fmt;

/// The push's part of the largest velocity that contacts slide with: far below what makes one stick, far above
/// rounding.
const PART: f64 = 1e-3;
/// Where none slides, m/s.
const SMALLEST: f64 = 1e-6;

/// Another velocity of one degree of freedom.
#[derive(Clone, Debug, PartialEq)]
pub struct Push {
    /// The degree of freedom, from 0.
    pub dof: usize,
    /// The variable that has its initial velocity.
    pub name: String,
    /// m/s.
    pub velocity: f64,
}

impl fmt::Display for Push {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} = {:?} m/s", self.name, self.velocity)
    }
}

impl Push {
    /// The usual push of a scene: the first degree of freedom that lies along no contact, else the first that lies
    /// along no normal, gets a thousandth of the largest velocity that contacts slide with, or 1e-6 m/s where none
    /// slides.
    ///
    /// # Errors
    /// Everything lies along normals.
    pub fn of(scene: &Scene) -> Result<Self, Error> {
        let model = LumpedModel::from(scene);
        let names = scene.dof_names();
        let lies_along = |dof: usize, normals_only: bool| {
            model.contacts.iter().any(|contact| {
                let has = |direction: &[(usize, f64)]| {
                    direction.iter().any(|&(other, part)| other == dof && part != 0.0)
                };
                has(&contact.normal.0) || (!normals_only && has(&contact.tangent.0))
            })
        };
        let free = |normals_only| (0..names.len()).find(|&dof| !lies_along(dof, normals_only));
        let dof = free(false).or_else(|| free(true)).ok_or_else(|| {
            Error::scene(format!(
                "nothing in {} can be pushed out of its equilibrium: all that moves lies along normals of \
                 contacts; give an initial value",
                scene.name
            ))
        })?;
        let speed = |contact: &Contact| contact.velocity(scene.slider.velocity).abs();
        let largest = model.contacts.iter().map(speed).fold(0.0, f64::max);
        let velocity = if largest > 0.0 { PART * largest } else { SMALLEST };
        // Displacements x1, x and y have the velocities v1, vx and vy.
        let (part, axis) = names[dof].rsplit_once('.').unwrap_or(("", &names[dof]));
        let number = axis.trim_start_matches('x');
        let name = format!("initial.{part}.v{}", if number.is_empty() { axis } else { number });
        Ok(Self { dof, name, velocity })
    }
}

/// Pushes a scene that has neither an initial perturbation nor signals; `None` for one that moves anyway, or that
/// cannot be pushed.
///
/// # Errors
/// None of a scene that is possible.
pub fn push(scene: &mut Scene) -> Result<Option<Push>, Error> {
    let initial = scene.initial_displacements().chain(scene.initial_velocities());
    let starts_moving = initial.fold(false, |moves, value| moves || value != 0.0);
    if starts_moving || !scene.signals.is_empty() {
        return Ok(None);
    }
    let Ok(push) = Push::of(scene) else { return Ok(None) };
    assign(scene, &push.name, push.velocity)?;
    Ok(Some(push))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{builtin, parse};

    /// A built-in scene without its initial perturbation.
    fn still(name: &str) -> Scene {
        let text = builtin(name).unwrap().text;
        let mut parts = text.split("[[initial]]");
        let before = parts.next().unwrap();
        let after: String = parts.map(|part| &part[part.find("\n[").unwrap_or(0)..]).collect();
        parse(name, &format!("{before}{after}")).unwrap()
    }

    #[test]
    fn what_rests_is_pushed_where_no_contact_holds_it() {
        let mut set1 = still("set1");
        let pushed = push(&mut set1).unwrap().unwrap();
        assert_eq!((&*pushed.name, pushed.velocity), ("initial.module[1].v1", 2.5e-5));
        assert_eq!(set1.initial_velocities().collect::<Vec<_>>()[..2], [2.5e-5, 0.0]);
        assert_eq!(push(&mut set1).unwrap(), None);
        set1 = still("set1");
        set1.slider.velocity = 0.0;
        assert_eq!(push(&mut set1).unwrap().unwrap().velocity, 1e-6);
        // Its one mass moves along the contact only.
        let pushed = push(&mut still("stick_slip")).unwrap().unwrap();
        assert_eq!((&*pushed.name, pushed.velocity), ("initial.mass.block.vx", 1e-4));
    }

    #[test]
    fn what_moves_is_left_alone() {
        for name in ["set1", "stick_slip", "den_hartog"] {
            let mut scene = builtin(name).unwrap().scene();
            let before = scene.clone();
            assert_eq!(push(&mut scene).unwrap(), None);
            assert_eq!(scene, before);
        }
    }
}
