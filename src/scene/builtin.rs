//! The scenes built into the program, which are the files under `scenes/`.

use super::{Scene, parse};
use crate::Error;

/// A scene built into the program.
///
/// ```
/// use amontons::scene::builtin;
///
/// let set1 = builtin("set1").expect("a built-in scene").scene();
/// assert_eq!(set1.contact_count(), 2);
/// assert!(builtin("no such scene").is_none());
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Builtin {
    /// Name of the scene on the command line.
    pub name: &'static str,
    /// Text of the scene's file.
    pub text: &'static str,
}

impl Builtin {
    /// Makes the scene.
    #[must_use]
    pub fn scene(&self) -> Scene {
        parse(self.name, self.text).expect("built-in scenes are checked by a test")
    }
}

/// All built-in scenes.
pub const BUILTIN: &[Builtin] = &[
    Builtin { name: "set1", text: include_str!("../../scenes/set1.toml") },
    Builtin { name: "set2", text: include_str!("../../scenes/set2.toml") },
    Builtin { name: "ring12", text: include_str!("../../scenes/ring12.toml") },
    Builtin { name: "belt", text: include_str!("../../scenes/belt.toml") },
    Builtin { name: "stick_slip", text: include_str!("../../scenes/stick_slip.toml") },
    Builtin { name: "den_hartog", text: include_str!("../../scenes/den_hartog.toml") },
    Builtin { name: "hoffmann", text: include_str!("../../scenes/hoffmann.toml") },
    Builtin { name: "corner", text: include_str!("../../scenes/corner.toml") },
    Builtin { name: "disc_brake", text: include_str!("../../scenes/disc_brake.toml") },
    Builtin { name: "drive", text: include_str!("../../scenes/drive.toml") },
];

/// Returns the built-in scene with this name; `None` if there is none.
#[must_use]
pub fn builtin(name: &str) -> Option<Builtin> {
    BUILTIN.iter().copied().find(|builtin| builtin.name == name)
}

/// Returns the built-in scene that a command line names.
///
/// # Errors
/// Returns an error that lists the built-in scenes if there is none with this name.
pub fn named(name: &str) -> Result<Builtin, Error> {
    builtin(name).ok_or_else(|| {
        Error::argument(format!("there is no built-in scene {name}; {}", builtin_names()))
    })
}

/// Lists the names of the built-in scenes, for a message.
#[must_use]
pub fn builtin_names() -> String {
    let names: Vec<&str> = BUILTIN.iter().map(|builtin| builtin.name).collect();
    format!("the built-in scenes are {}", names.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_builtin_scene_is_valid() {
        for builtin in BUILTIN {
            parse(builtin.name, builtin.text).unwrap();
        }
    }
}
