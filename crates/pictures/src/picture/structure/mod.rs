//! Structures: masses, the springs and dashpots between them, and what they rub on.
//!
//! `layout` says where masses stand and how links run; `plot` and `links` draw symbols of that, and `labels` finds places
//! for names and values. In all of them each thing takes the first place of a list that keeps off what stands already.

mod labels;
mod layout;
mod legend;
mod links;
mod plane;
mod plot;
mod scene;
mod sheet;
mod symbols;
mod text;

use super::canvas::{self, Failure};
use amontons::Error;
use sheet::{Icon, Sheet};
use std::path::Path;

/// Masses and what joins them. Masses have no places of their own: they are found from the
/// directions of what joins them, so lengths in the picture mean nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Structure {
    /// Title of the picture.
    pub title: String,
    /// The masses, at most 40.
    pub masses: Vec<MassMark>,
    /// Springs and dashpots. Links of one pair of masses stand side by side.
    pub links: Vec<Link>,
    /// Surfaces that the masses rub on.
    pub sliders: Vec<SliderMark>,
    /// Forces on the masses.
    pub forces: Vec<ForceMark>,
    /// `true` if signals drive something. Their mark "~" is in the labels of the driven parts.
    pub signals: bool,
}

/// A force on a mass: an arrow.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ForceMark {
    /// Short name, as "F".
    pub name: String,
    /// Value of the force, as "2 kN"; may be empty.
    pub label: String,
    /// The place in the masses of the one that it pushes.
    pub mass: usize,
    /// The way in which it pushes, rad from the horizontal, anticlockwise.
    pub angle: f64,
}

/// A mass: a square.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MassMark {
    /// Short name, as it stands in the square if there is room.
    pub name: String,
    /// Value of the mass, as "0.3 kg"; may be empty.
    pub label: String,
    /// Angle from the axes of the picture to the mass's own, rad, anticlockwise.
    pub angle: f64,
    /// `true` for each of its own two axes that it cannot move along.
    pub locked: [bool; 2],
}

/// A spring or a dashpot.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// Short name, as "k1".
    pub name: String,
    /// Value of the link, as "55 kN/m"; may be empty. A crowded picture lists values below.
    pub label: String,
    /// Places in the masses; None is ground.
    pub ends: [Option<usize>; 2],
    /// The line along which it acts, rad from the horizontal, anticlockwise; where there is a
    /// choice, the second end lies from the first along (cos, sin).
    pub direction: f64,
    /// The symbol of the link.
    pub kind: LinkKind,
    /// Initial displacement of the second end along the direction, m: above zero it pulls the first end along
    /// `direction`. Only its sign is shown, and zero is no preload.
    pub preload: f64,
}

/// The kind of a link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinkKind {
    /// A zigzag.
    Spring,
    /// A dashpot.
    Damper,
}

/// A surface at the foot of a mass, on which it rubs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SliderMark {
    /// Short name, as "c1"; may be empty.
    pub name: String,
    /// Values of the contact, as "µ = 0.4, v = 0.1 m/s"; may be empty.
    pub label: String,
    /// The place in the masses of the one that rubs.
    pub mass: usize,
    /// The mass whose surface it rubs on; None is a rigid slider.
    pub on: Option<usize>,
    /// θ, rad: the tangent is t = (cos θ, sin θ), the normal n = (−sin θ, cos θ); the mass is on
    /// the side of +n.
    pub angle: f64,
    /// Velocity of the slider along t, m/s; only its sign is shown.
    pub velocity: f64,
}

impl Structure {
    /// Draws and writes, as the path's ending asks: `.svg` or `.png`.
    ///
    /// # Errors
    /// Another ending, no masses or more than 40, links and sliders of masses that are not there,
    /// values that are not finite, or a file that cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        self.check().map_err(|failure| canvas::cannot_draw(path, &failure))?;
        canvas::write(&Sheet::of(self), path)
    }

    /// The text of an SVG, as [`write`](Self::write) writes it.
    ///
    /// # Errors
    /// No masses or more than 40, links and sliders of masses that are not there, or values that are not finite.
    pub fn svg(&self) -> Result<String, Error> {
        self.check().map_err(|failure| canvas::cannot_draw_titled(&self.title, &failure))?;
        canvas::svg_text(&Sheet::of(self))
    }

    /// A square PNG of 450 pixels without any text, which shows what there is as an icon.
    ///
    /// # Errors
    /// No masses or more than 40, links and sliders of masses that are not there, or values that are not finite.
    pub fn icon(&self) -> Result<Vec<u8>, Error> {
        self.check().map_err(|failure| canvas::cannot_draw_titled(&self.title, &failure))?;
        canvas::small_png(&Icon::of(self))
    }

    /// The most masses that one picture tells apart.
    pub const MOST_MASSES: usize = 40;

    fn check(&self) -> Result<(), Failure> {
        let (count, most) = (self.masses.len(), Self::MOST_MASSES);
        let holds = |holds: bool, reason: &dyn Fn() -> String| {
            if holds { Ok(()) } else { Err(Failure(reason())) }
        };
        holds(count > 0, &|| "a structure has at least one mass".into())?;
        holds(count <= most, &|| {
            format!("the structure has {count} masses, but a picture shows up to {most} masses")
        })?;
        let there = |what: &str, mass: usize| {
            holds(mass < count, &|| {
                let last = count - 1;
                format!("{what} is at mass {mass}, but the masses are numbered from 0 to {last}")
            })
        };
        let finite = |what: &str, of: &str, value: f64| {
            holds(value.is_finite(), &|| format!("{of} of {what} is {value}, but must be finite"))
        };
        for (place, mass) in self.masses.iter().enumerate() {
            finite(&named("mass", &mass.name, place), "the angle", mass.angle)?;
        }
        for (place, link) in self.links.iter().enumerate() {
            let what = named("link", &link.name, place);
            finite(&what, "the direction", link.direction)?;
            finite(&what, "the preload", link.preload)?;
            link.ends.into_iter().flatten().try_for_each(|mass| there(&what, mass))?;
            let differ = link.ends[0] != link.ends[1];
            holds(differ, &|| format!("{what} must have two different ends"))?;
        }
        for (place, force) in self.forces.iter().enumerate() {
            let what = named("force", &force.name, place);
            finite(&what, "the angle", force.angle)?;
            there(&what, force.mass)?;
        }
        for (place, slider) in self.sliders.iter().enumerate() {
            let what = named("slider", &slider.name, place);
            finite(&what, "the angle", slider.angle)?;
            finite(&what, "the velocity", slider.velocity)?;
            there(&what, slider.mass)?;
            slider.on.map_or(Ok(()), |on| there(&what, on))?;
            holds(slider.on != Some(slider.mass), &|| {
                format!("{what} is on the mass that rubs on it, but must be on another mass")
            })?;
        }
        Ok(())
    }
}

/// "link 3 (k1)", for messages.
fn named(what: &str, name: &str, place: usize) -> String {
    if name.is_empty() { format!("{what} {place}") } else { format!("{what} {place} ({name})") }
}

#[cfg(test)]
mod examples;
#[cfg(test)]
mod tests;
