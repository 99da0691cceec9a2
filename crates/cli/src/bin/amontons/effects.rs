//! `amontons effects`.

use crate::arguments::Effects;
use amontons::scene::Scene;
use amontons::simulation::Simulation;
use amontons_analysis::effects::{Effect, effects};
use amontons_export::scene;
use std::error::Error;
use std::io::{Write, stdout};
use std::time::{Duration, Instant};

/// Number of slices whose shortest gives a time; the scenes take turns. Other work on the machine only lengthens a
/// slice.
const SLICES: u32 = 60;
/// Duration of a slice, equal for all scenes; a longer one would be interrupted more often.
const SLICE: Duration = Duration::from_micros(500);
/// Limit of the variables of an effect that are named; of further ones only the number is given.
const NAMED: usize = 8;

pub fn run(arguments: &Effects) -> Result<(), Box<dyn Error>> {
    let (scene, _) = scene::find(&arguments.scene)?;
    let all = effects(&scene);
    let others = all.iter().map(|effect| if effect.is_on { &effect.without } else { &effect.with });
    let times = measure(&scene, others)?;
    print(&scene, &all, &times, &mut stdout().lock())?;
    Ok(())
}

/// Duration of a step of the scene and of each other scene, s; `None` if that scene cannot be run.
struct Times {
    own: f64,
    others: Vec<Option<f64>>,
}

fn measure<'a>(
    scene: &'a Scene,
    others: impl Iterator<Item = &'a Scene>,
) -> Result<Times, Box<dyn Error>> {
    let mut own = EndlessRun::of(scene)?;
    let mut others: Vec<Option<EndlessRun>> =
        others.map(|scene| EndlessRun::of(scene).ok()).collect();
    own.choose_steps();
    others.iter_mut().flatten().for_each(EndlessRun::choose_steps);
    for _ in 0..SLICES {
        own.take_slice();
        others.iter_mut().flatten().for_each(EndlessRun::take_slice);
    }
    let time = |course: Option<EndlessRun>| course.map(|course| course.shortest);
    let others = others.into_iter().map(|course| time(course).filter(|time| time.is_finite()));
    Ok(Times { own: own.shortest, others: others.collect() })
}

/// A run of a scene without an end.
struct EndlessRun {
    simulation: Simulation,
    /// Number of steps in a slice.
    steps: u32,
    /// Shortest duration of a step, s.
    shortest: f64,
}

impl EndlessRun {
    fn of(scene: &Scene) -> Result<Self, amontons::Error> {
        let simulation = Simulation::new(scene.clone(), 0.0)?;
        Ok(Self { simulation, steps: 1, shortest: f64::INFINITY })
    }

    /// Doubles the number of steps until a slice lasts [`SLICE`].
    fn choose_steps(&mut self) {
        while self.time().is_some_and(|time| time * f64::from(self.steps) < SLICE.as_secs_f64()) {
            self.steps *= 2;
        }
    }

    /// Advances by the steps of a slice. Returns the duration of one step, s; `None` if the run fails.
    fn time(&mut self) -> Option<f64> {
        let steps = f64::from(self.steps);
        let target = self.simulation.time() + steps * self.simulation.scene().step;
        let start = Instant::now();
        self.simulation.advance_to(target).ok()?;
        Some(start.elapsed().as_secs_f64() / steps)
    }

    fn take_slice(&mut self) {
        self.shortest = self.shortest.min(self.time().unwrap_or(f64::INFINITY));
    }
}

fn print(scene: &Scene, all: &[Effect], times: &Times, out: &mut dyn Write) -> std::io::Result<()> {
    writeln!(
        out,
        "{}: a step of {:e} s takes {:.3} µs on this machine\n\n\
         cost: part of that step that is saved without an effect that is on, or added by an effect that is off\n\
         (a friction law replaces the present one); a few percent are noise; – marks an effect that \
         this scene cannot have\n",
        scene.name,
        scene.step,
        1e6 * times.own
    )?;
    let width = all.iter().map(|effect| effect.name.len()).max().unwrap_or(0);
    for (effect, other) in all.iter().zip(&times.others) {
        let Effect { name, equation, is_on, .. } = effect;
        let cost = other.map_or_else(
            || "–".to_owned(),
            |other| {
                let more = if *is_on { times.own - other } else { other - times.own };
                format!("{:+.0} %", 100.0 * more / times.own)
            },
        );
        let state = if *is_on { "on" } else { "off" };
        writeln!(out, "{name:width$}  {state:3}  {cost:>7}  {equation}")?;
        let variables = effect.variables();
        let named = variables.iter().take(NAMED).map(String::as_str).collect::<Vec<_>>().join(", ");
        let blank = "";
        match variables.len() {
            0 => {}
            count if count <= NAMED => writeln!(out, "{blank:width$}               {named}")?,
            count => writeln!(out, "{blank:width$}               {named}, … ({count} in all)")?,
        }
    }
    Ok(())
}
