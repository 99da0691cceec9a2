//! Signals of a scene that is taken at one instant, by analyses that know no time: eigenvalues and equilibria.

use amontons::Error;
use amontons::error::Short;
use amontons::scene::{Scene, Shape};

/// A sentence on the signals that an analysis at time `t` (s) leaves out; `None` where the scene has none.
#[must_use]
pub fn signals_left_out(scene: &Scene, t: f64) -> Option<String> {
    if scene.signals.is_empty() {
        return None;
    }
    let of = |signal: &amontons::scene::Signal| {
        let (shape, value) = (shape_name(&signal.shape), signal.shape.at(t, 0.0));
        format!("{} to {} ({shape})", Short(value), signal.input)
    };
    let all: Vec<String> = scene.signals.iter().map(of).collect();
    let added = match &all[..] {
        [one] => one.clone(),
        [others @ .., last] => format!("{} and {last}", others.join(", ")),
        [] => String::new(),
    };
    Some(format!(
        "the scene is analysed at t = {} s, where its signals add {added}; their change over time is ignored",
        Short(t)
    ))
}

/// Makes sure that no signal drives a parameter whose values an analysis goes through: each value would be another one
/// than the analysis says.
///
/// # Errors
/// Returns an error if a signal drives it.
pub fn require_undriven(scene: &Scene, name: &str) -> Result<(), Error> {
    let Some(place) = scene.signals.iter().position(|signal| signal.input == name) else {
        return Ok(());
    };
    Err(Error::argument(format!(
        "signal[{}] of {} drives {name}, so the analysis cannot vary {name}: remove the signal from the scene, or vary \
         another parameter",
        place + 1,
        scene.name
    )))
}

/// The shape of a signal, as a scene file names it.
fn shape_name(shape: &Shape) -> &'static str {
    match shape {
        Shape::Constant(_) => "constant",
        Shape::Ramp(_) => "ramp",
        Shape::Pulse(_) => "pulse",
        Shape::Sine(_) => "sine",
        Shape::Table(_) => "table",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use amontons::scene::{builtin, parse};
    use amontons::simulation::at_instant;

    #[test]
    fn a_scene_at_an_instant_has_what_its_signals_add_and_no_signals() {
        let text = builtin("belt").unwrap().text;
        let signals = "[[signal]]\ninput = \"friction.coefficient\"\n\
                       ramp = { from = 0.0, to = 1.0, start = 0.0, end = 2.0 }\n\
                       [[signal]]\ninput = \"slider.velocity\"\n\
                       sine = { amplitude = 0.5, frequency = 0.25 }\n";
        let scene = parse("mine", &format!("{text}{signals}")).unwrap();
        let (mu, v) = (scene.friction_coefficient, scene.slider.velocity);
        for (t, added) in [(0.0, [0.0, 0.0]), (1.0, [0.5, 0.5]), (3.0, [1.0, -0.5])] {
            let found = at_instant(&scene, t).unwrap();
            assert!((found.friction_coefficient - mu - added[0]).abs() < 1e-12);
            assert!((found.slider.velocity - v - added[1]).abs() < 1e-12);
            assert!(found.signals.is_empty());
        }
        let words = signals_left_out(&scene, 1.0).unwrap();
        assert!(words.contains("t = 1 s") && words.contains("0.5 to friction.coefficient (ramp)"));
        let error = require_undriven(&scene, "friction.coefficient").unwrap_err();
        assert!(error.is_argument() && error.to_string().contains("signal[1] of mine"), "{error}");
        assert_eq!(require_undriven(&scene, "slider.angle"), Ok(()));
        let plain = builtin("set1").unwrap().scene();
        assert_eq!(
            (at_instant(&plain, 1.0), signals_left_out(&plain, 1.0)),
            (Ok(plain.clone()), None)
        );
    }
}
