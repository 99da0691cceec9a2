//! Texts of a structure: lists of values, and its description.

use super::{Link, LinkKind, Structure};
use crate::picture::canvas::text_width;

/// Texts of one line that are set one after the other, in rows of a width; also words of a title.
pub(super) fn rows(texts: &[String], between: &str, size: f64, width: f64) -> Vec<String> {
    let mut rows: Vec<String> = Vec::new();
    for text in texts {
        match rows.last_mut() {
            Some(row) if text_width(&format!("{row}{between}{text}"), size) < width => {
                *row += between;
                *row += text;
            }
            _ => rows.push(text.clone()),
        }
    }
    rows
}

/// A name and its value, as one line.
fn full(name: &str, label: &str) -> String {
    if name.is_empty() || label.is_empty() {
        return format!("{name}{label}");
    }
    format!("{name} {label}")
}

/// The text at a link when values are listed below.
fn short<'a>(name: &'a str, label: &'a str) -> &'a str {
    if name.is_empty() { label } else { name }
}

/// A name, with its value or without, in one line or two.
pub(super) fn written(name: &str, label: &str, values: bool) -> Vec<Vec<String>> {
    if !values || name.is_empty() || label.is_empty() {
        let text = if values { full(name, label) } else { short(name, label).into() };
        return if text.is_empty() { Vec::new() } else { vec![vec![text]] };
    }
    vec![vec![full(name, label)], vec![name.into(), label.into()]]
}

/// All values with the names that have them, masses first.
pub(super) fn values(structure: &Structure) -> Vec<String> {
    let masses = structure.masses.iter().map(|mass| (0, &*mass.name, &*mass.label));
    let links = structure.links.iter().map(|link| (1, &*link.name, &*link.label));
    let sliders = structure.sliders.iter().map(|slider| (2, &*slider.name, &*slider.label));
    let mut groups: Vec<(i32, Vec<&str>, &str)> = Vec::new();
    let forces = structure.forces.iter().map(|force| (3, &*force.name, &*force.label));
    for (kind, name, label) in masses.chain(links).chain(sliders).chain(forces) {
        if name.is_empty() || label.is_empty() {
            continue;
        }
        match groups.iter_mut().find(|(other, _, value)| *other == kind && *value == label) {
            Some((_, names, _)) if names.contains(&name) => {}
            Some((_, names, _)) => names.push(name),
            None => groups.push((kind, vec![name], label)),
        }
    }
    groups.iter().map(|(_, names, label)| format!("{}: {label}", ranges(names))).collect()
}

/// Names one after the other; from three on, those that only count up are a range.
fn ranges(names: &[&str]) -> String {
    let mut parts: Vec<String> = Vec::new();
    let mut start = 0;
    while start < names.len() {
        let counts_up = |pair: &[&str]| {
            counted(pair[0]).is_some_and(|first| counted(pair[1]) == Some(following(first)))
        };
        let more = names[start..].windows(2).take_while(|pair| counts_up(pair)).count();
        if more > 1 {
            parts.push(format!("{} … {}", names[start], names[start + more]));
            start += more + 1;
        } else {
            parts.push(names[start].into());
            start += 1;
        }
    }
    parts.join(", ")
}

/// The text before and after the last number in a name, and the number.
fn counted(name: &str) -> Option<(&str, &str, u64)> {
    let end = name.rfind(|c: char| c.is_ascii_digit())? + 1;
    let digits = name[..end].bytes().rev().take_while(u8::is_ascii_digit).count();
    Some((&name[..end - digits], &name[end..], name[end - digits..end].parse().ok()?))
}

fn following<'a>((before, after, number): (&'a str, &'a str, u64)) -> (&'a str, &'a str, u64) {
    (before, after, number.saturating_add(1))
}

/// Description of the structure in words.
pub(super) fn description(structure: &Structure) -> String {
    let mut parts = Vec::new();
    let name = |mass: usize| &*structure.masses[mass].name;
    for mass in &structure.masses {
        let locked = match mass.locked {
            [true, true] => ", locked along both of its axes",
            [true, false] => ", locked along its first axis",
            [false, true] => ", locked along its second axis",
            [false, false] => "",
        };
        parts.push(format!("mass {}{locked}", full(&mass.name, &mass.label)));
    }
    for Link { name: own, label, ends, direction, kind, .. } in &structure.links {
        let kind = match kind {
            LinkKind::Spring => "spring",
            LinkKind::Damper => "damper",
        };
        let [from, to] = ends.map(|end| end.map_or("ground", name));
        let degrees = direction.to_degrees().round() + 0.0;
        parts.push(format!("{kind} {} from {from} to {to} at {degrees}°", full(own, label)));
    }
    for slider in &structure.sliders {
        let on = slider.on.map_or("a slider", name);
        let degrees = slider.angle.to_degrees().round() + 0.0;
        let what = full(&slider.name, &slider.label);
        parts.push(format!("contact {what} of {} on {on} at {degrees}°", name(slider.mass)));
    }
    for force in &structure.forces {
        let degrees = force.angle.to_degrees().round() + 0.0;
        let what = full(&force.name, &force.label);
        parts.push(format!("force {what} on {} towards {degrees}°", name(force.mass)));
    }
    parts.join("; ") + "."
}
