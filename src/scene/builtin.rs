//! The scenes that the program carries; the same files stand under `scenes/`.

use super::{Scene, parse};

/// A scene that the program carries.
#[derive(Clone, Copy, Debug)]
pub struct Builtin {
    /// Its name on the command line.
    pub name: &'static str,
    /// Its file, word for word.
    pub text: &'static str,
}

impl Builtin {
    /// The scene itself.
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
];

/// The built-in scene of that name.
#[must_use]
pub fn builtin(name: &str) -> Option<Builtin> {
    BUILTIN.iter().copied().find(|builtin| builtin.name == name)
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
