//! The scenes that several hard cases share.

use super::Run;
use amontons::contact::ContactState;
use std::fmt::Write;

/// A block of 1 kg on a spring of 100 N/m along the slider, ω = 10 rad/s, pressed with 10 N.
pub fn block(mu: f64, velocity: f64, step: f64, more: &str) -> String {
    format!(
        "[slider]\nvelocity = {velocity:?}\nangle = 0.0\n[friction]\ncoefficient = {mu:?}\n\
         [integrator]\nstep = {step:?}\n[[mass]]\nname = \"block\"\nmass = 1.0\n\
         force = [0.0, -10.0]\n[[spring]]\nname = \"hold\"\nbetween = [\"block\", \"ground\"]\n\
         direction = \"x\"\nstiffness = 100.0\n[[contact]]\nname = \"c\"\nmass = \"block\"\n{more}"
    )
}

pub const OMEGA: f64 = 10.0;

pub const PRESSING: f64 = 10.0;

pub const STIFFNESS: f64 = 100.0;

/// `[[initial]]` of the block, from the equilibrium.
pub fn start(values: &str) -> String {
    format!("[[initial]]\nmass = \"block\"\n{values}\n")
}

/// Judged steps up to `end` (s); the times at which the only contact takes another state, and which. Of the
/// paper's scheme the time is the end of the step.
pub fn changes(run: &mut Run, end: f64) -> Vec<(f64, ContactState)> {
    let mut now = run.states()[0];
    let mut found = Vec::new();
    while run.time() < end - 0.5 * run.h() {
        run.step();
        run.judge_step();
        run.judge_report();
        let state = run.states()[0];
        if state != now {
            found.push((run.changes.last().map_or(run.time(), |change| change.time), state));
        }
        now = state;
    }
    found
}

/// A block on an oblique spring that friction draws into the slider: K = [[400, 100], [100, 100]].
pub fn wedge(mu: f64, velocity: f64, more: &str) -> String {
    let springs = "[[spring]]\nname = \"oblique\"\nbetween = [\"block\", \"ground\"]\n\
        direction = 0.7853981633974483\nstiffness = 200.0\n[[spring]]\nname = \"along\"\n\
        between = [\"block\", \"ground\"]\ndirection = \"x\"\nstiffness = 200.0\n";
    block(mu, velocity, 1e-3, &format!("{springs}{more}"))
}

/// Pads on links, each with its own contact, and a damper, which no ring has.
pub fn pads(copies: usize, damping: f64, step: f64) -> String {
    let mut text = format!(
        "[slider]\nvelocity = 0.2\nangle = 0.3\n[friction]\ncoefficient = 0.7\n\
         [damping]\nbeta = 1e-5\n[integrator]\nstep = {step:?}\n"
    );
    for i in 0..copies {
        let _ = write!(
            text,
            "[[mass]]\nname = \"arm{i}\"\nmass = 0.4\nforce = [3.0, -60.0]\n\
             [[mass]]\nname = \"pad{i}\"\nmass = 0.2\nangle = 0.3\n\
             [[contact]]\nname = \"c{i}\"\nmass = \"pad{i}\"\n\
             [[initial]]\nmass = \"pad{i}\"\ny = 1e-4\nvx = 0.4\nvy = 0.6\n"
        );
        let _ = write!(
            text,
            "[[damper]]\nname = \"e{i}\"\nbetween = [\"arm{i}\", \"ground\"]\n\
             direction = \"x\"\ndamping = {damping:?}\n"
        );
        for (name, other, direction, k) in [
            ("a", "ground".to_owned(), 0.2, 4e4),
            ("b", "ground".to_owned(), 1.4, 2e4),
            ("c", format!("pad{i}"), 0.1, 1e5),
            ("d", format!("pad{i}"), 1.7, 2e5),
        ] {
            let _ = write!(
                text,
                "[[spring]]\nname = \"{name}{i}\"\nbetween = [\"arm{i}\", \"{other}\"]\n\
                 direction = {direction:?}\nstiffness = {k:?}\n"
            );
        }
    }
    text
}
