//! Exploration.

#[path = "../tests/support/brake_pad.rs"]
mod brake_pad;

use amontons::contact::{ContactForce, ContactState};
use amontons::integrator::{Inputs, Method, Motion, choose};
use amontons::stability::Spectrum;
use brake_pad::{Size, VELOCITY, pad};
use std::time::Instant;

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let get = |i: usize, d: f64| args.get(i).and_then(|a| a.parse().ok()).unwrap_or(d);
    let size = if get(1, 0.0) > 0.0 { Size::LARGE } else { Size::SMALL };
    for mu in [get(2, 0.5)] {
        let start = Instant::now();
        let model = pad(size, mu);
        let made = start.elapsed().as_secs_f64();
        let start = Instant::now();
        let equilibrium = match model.equilibrium(&|i| format!("{i}")) {
            Ok(e) => e,
            Err(e) => {
                println!("{mu} {e}");
                continue;
            }
        };
        let eq = start.elapsed().as_secs_f64();
        let least = equilibrium.normal_force.iter().copied().fold(f64::INFINITY, f64::min);
        let start = Instant::now();
        let states = vec![ContactState::Slide; size.contacts()];
        if get(4, 0.0) == 0.0 {
            let spectrum = Spectrum::of(model.linear_about(&equilibrium), &states).unwrap();
            let seconds = start.elapsed().as_secs_f64();
            let f = spectrum.fastest_growing().unwrap();
            println!(
                "mu {mu} made {made:.2} eq {eq:.2} least {least:.3} n {} spectrum {seconds:.2} s growth {:.1} at {:.1} Hz, highest {:.0} Hz",
                model.dofs(),
                f.re,
                f.im / std::f64::consts::TAU,
                spectrum.oscillating.last().unwrap().im / std::f64::consts::TAU
            );
        }
        if (mu - get(2, 0.5)).abs() > 1e-9 {
            continue;
        }
        for (method, step, name) in
            [(Method::ForwardIncrement, 5e-7, "fi"), (Method::EventDriven, 1e-5, "ed")]
        {
            let start = Instant::now();
            let mut integrator = choose(&model, method).unwrap();
            println!("{name}: made in {:.2} s", start.elapsed().as_secs_f64());
            let mut motion = Motion::new(
                equilibrium.displacement.clone(),
                vec![0.0; model.dofs()],
                vec![ContactState::Slide; size.contacts()],
            );
            for i in 3 * size.contacts()..model.dofs() {
                motion.velocity[i] = 1e-4;
            }
            let inputs = Inputs::uniform(model.load.clone(), size.contacts(), VELOCITY, mu);
            let start = Instant::now();
            let mut at = 0.0;
            let end = get(3, 1.0) * 1e-3;
            while at < end {
                let count = (end / 10.0 / step) as u64;
                let r = integrator.advance(&mut motion, &inputs, step, count);
                at += end / 10.0;
                let mut forces = vec![ContactForce::detached(0.0); size.contacts()];
                let c = integrator.contact_forces(&motion, &inputs, &mut forces);
                let count = |s| motion.contacts.iter().filter(|x| **x == s).count();
                let v = motion.velocity.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
                println!(
                    "{name} t {at:.5} {:?} {:?} {:.2} s vmax {v:.3e} d {} s {} sl {} r {} {:?}",
                    r,
                    c.is_ok(),
                    cpu(),
                    count(ContactState::Detached),
                    count(ContactState::Stick),
                    count(ContactState::Slide),
                    count(ContactState::ReverseSlide),
                    motion.statistics
                );
                if r.is_err() {
                    break;
                }
            }
        }
    }
}

/// Seconds of the processor that this program has used.
fn cpu() -> f64 {
    let text = std::fs::read_to_string("/proc/self/schedstat").unwrap_or_default();
    text.split(' ').next().and_then(|ns| ns.parse::<f64>().ok()).unwrap_or(0.0) * 1e-9
}
