//! Values that are possible, but look like those of another unit or of another machine: angles in degrees, stiffnesses
//! in N/mm, one slider that would have to go two ways.

use amontons::model::Equilibrium;
use amontons::scene::{ContactDefinition, Network, Scene, direction};
use amontons::simulation::Simulation;
use std::f64::consts::{PI, TAU};

/// A spring whose ends the equilibrium moves apart or together by more, m, is doubtful: those of machines yield by
/// less than a millimetre, and their stiffnesses in N/mm, read in N/m, by a thousand times that.
const FAR: f64 = 0.05;
/// Weights do hang on soft springs, so the spring's force must be more than this many times the weight of all masses.
const WEIGHTS: f64 = 10.0;
/// Preloads that press all contacts on with less than this part of the masses' weight are doubtful.
const FAINT: f64 = 0.02;
/// Acceleration of gravity, m/s².
const GRAVITY: f64 = 9.81;
/// Tangents whose product is this near to −1 are opposite.
const OPPOSITE: f64 = 1e-6;

/// The doubtful values of a scene, one sentence for each.
pub(crate) fn doubts(simulation: &Simulation) -> Vec<String> {
    let (scene, reference) = (simulation.scene(), simulation.reference());
    let mut doubts: Vec<String> = angles(scene).filter_map(doubtful_angle).collect();
    doubts.extend(strained(scene, reference));
    doubts.extend(faint(scene, reference));
    doubts.extend(parted(scene));
    doubts
}

/// The doubtful values of a scene that is not run, one sentence for each. Without an equilibrium, springs that it
/// would strain are not reported.
#[must_use]
pub fn doubts_of(scene: &Scene) -> Vec<String> {
    match Simulation::new(scene.clone(), 0.0) {
        Ok(simulation) => doubts(&simulation),
        Err(_) => angles(scene).filter_map(doubtful_angle).chain(parted(scene)).collect(),
    }
}

/// All angles of a scene, rad, by name.
fn angles(scene: &Scene) -> impl Iterator<Item = (String, f64)> + '_ {
    let slider = scene.has_common_angle().then(|| ("slider.angle".to_owned(), scene.slider.angle));
    let network = scene.network().into_iter();
    let own = network.flat_map(|network| {
        let masses = network.masses.iter().map(|m| (format!("mass.{}.angle", m.name), m.angle));
        let springs = network.springs.iter();
        let springs = springs.map(|s| (format!("spring.{}.direction", s.name), s.direction));
        let dampers = network.dampers.iter();
        let dampers = dampers.map(|d| (format!("damper.{}.direction", d.name), d.direction));
        let contacts = network.contacts.iter();
        let contacts = contacts
            .filter_map(|c| c.angle.map(|angle| (format!("contact.{}.angle", c.name), angle)));
        masses.chain(springs).chain(dampers).chain(contacts)
    });
    slider.into_iter().chain(own)
}

fn doubtful_angle((name, angle): (String, f64)) -> Option<String> {
    let what = if angle.abs() > TAU {
        "is more than a turn"
    } else if angle.abs() > PI && angle.fract() == 0.0 {
        "is a whole number and more than half a turn"
    } else {
        return None;
    };
    let meant = angle.to_radians();
    Some(format!("{name} = {angle} rad {what}; if {angle}° is meant, write {meant}"))
}

/// The spring that the equilibrium strains most, where that is doubtful.
fn strained(scene: &Scene, reference: &Equilibrium) -> Option<String> {
    let network = scene.network()?;
    let moved = displacements(network, &reference.displacement);
    let strains = network.springs.iter().map(|spring| {
        let [a, b] = spring.between.map(|end| end.map_or([0.0; 2], |mass| moved[mass]));
        let [cos, sin] = direction(spring.direction);
        let strain = cos * (a[0] - b[0]) + sin * (a[1] - b[1]);
        (spring, strain.abs(), spring.stiffness * (strain - spring.preload.unwrap_or(0.0)).abs())
    });
    let heavy = WEIGHTS * weight(scene);
    let doubtful = strains.filter(|(_, strain, force)| *strain > FAR && *force > heavy);
    let (spring, strain, force) = doubtful.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let (stiffness, meant) = (spring.stiffness, 1e3 * spring.stiffness);
    Some(format!(
        "spring.{} deflects by {strain:.3} m under {force:.1} N in the equilibrium; if its stiffness of {stiffness} is in \
         N/mm, write {meant:e}, in N/m",
        spring.name
    ))
}

/// The displacements of a network's masses, to the right and up, m.
fn displacements(network: &Network, free: &[f64]) -> Vec<[f64; 2]> {
    let mut free = free.iter().copied();
    let moved = network.masses.iter().map(|mass| {
        let [x, y] =
            mass.locked.map(|locked| if locked { 0.0 } else { free.next().unwrap_or(0.0) });
        let [cos, sin] = direction(mass.angle);
        [x * cos - y * sin, x * sin + y * cos]
    });
    moved.collect()
}

/// Contacts that preloads alone press on, hardly.
fn faint(scene: &Scene, reference: &Equilibrium) -> Option<String> {
    let loads = scene.network().map_or(&[][..], |network| &network.masses);
    if loads.iter().any(|mass| mass.load != [0.0; 2]) {
        return None;
    }
    let (pressed, weight) = (reference.normal_force.iter().sum::<f64>(), weight(scene));
    (pressed > 0.0 && pressed < FAINT * weight).then(|| {
        format!(
            "the preloads give the contacts a total normal force of only {pressed:.3} N, but the masses weigh {weight:.3} \
             N; check that each stiffness is in N/m (1 N/mm is 1000 N/m)"
        )
    })
}

/// The weight of all masses, N.
fn weight(scene: &Scene) -> f64 {
    let modules = scene.modules().iter().flat_map(|module| module.mass);
    let masses = scene.network().map_or(&[][..], |network| &network.masses);
    GRAVITY * modules.chain(masses.iter().map(|mass| mass.mass)).sum::<f64>()
}

/// Two contacts on opposite sides of what the common slider moves, which then goes two ways. With a third one at
/// another angle it is taken to be round.
fn parted(scene: &Scene) -> Option<String> {
    let network = scene.network()?;
    let velocity = scene.slider.velocity;
    if velocity == 0.0 {
        return None;
    }
    let common = || network.contacts.iter().filter(|place| place.velocity.is_none());
    let along = |a: &ContactDefinition, b: &ContactDefinition| {
        let [a, b] = [a, b].map(|place| direction(place.angle.unwrap_or(scene.slider.angle)));
        a[0] * b[0] + a[1] * b[1]
    };
    common().find_map(|one| {
        let mut beside = common().filter(|other| other.on == one.on);
        if beside.clone().any(|other| along(one, other).abs() < 1.0 - OPPOSITE) {
            return None;
        }
        let other = beside.find(|other| along(one, other) < 0.0)?;
        Some(format!(
            "slider.velocity moves the surfaces of contact.{} and contact.{} in opposite directions, as a rotating \
             shaft does between two blocks; if they are the two sides of one moving body, such as a disc between its \
             pads, give them `velocity = {velocity:?}` and `velocity = {:?}`",
            one.name, other.name, -velocity
        ))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use amontons::scene::{BUILTIN, Slider, Structure, builtin, parse};

    fn of(scene: Scene) -> Vec<String> {
        doubts(&Simulation::new(scene, 0.0).unwrap())
    }

    #[test]
    fn nothing_is_doubtful_in_the_scenes_that_the_program_brings() {
        for builtin in BUILTIN {
            assert_eq!(of(builtin.scene()), Vec::<String>::new(), "{}", builtin.name);
        }
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/effects");
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let text = std::fs::read_to_string(&path).unwrap();
            let scene = parse("mine", &text).unwrap();
            assert_eq!(of(scene), Vec::<String>::new(), "{}", path.display());
        }
    }

    #[test]
    fn angles_that_look_like_degrees_are_told_with_their_radians() {
        let with = |angles: [&str; 4]| {
            let [mass, spring, damper, contact] = angles;
            let text = format!(
                "[slider]\nvelocity = 0.1\nangle = 0.0\n[friction]\ncoefficient = 0.1\n[integrator]\nstep = 1e-6\n\
                 [[mass]]\nname = \"a\"\nmass = 1.0\nangle = {mass}\n\
                 [[spring]]\nname = \"k\"\nbetween = [\"a\", \"ground\"]\ndirection = {spring}\nstiffness = 1e4\n\
                 [[spring]]\nname = \"l\"\nbetween = [\"a\", \"ground\"]\ndirection = \"x\"\nstiffness = 1e4\n\
                 [[spring]]\nname = \"m\"\nbetween = [\"a\", \"ground\"]\ndirection = \"y\"\nstiffness = 1e4\n\
                 [[damper]]\nname = \"d\"\nbetween = [\"a\", \"ground\"]\ndirection = {damper}\ndamping = 1.0\n\
                 [[contact]]\nname = \"c\"\nmass = \"a\"\nangle = {contact}\n"
            );
            of(parse("mine", &text).unwrap())
        };
        assert_eq!(
            with(["45.0", "1.0", "1.0", "1.0"]),
            [
                "mass.a.angle = 45 rad is more than a turn; if 45° is meant, write 0.7853981633974483"
            ]
        );
        assert_eq!(
            with(["1.0", "-90", "1.0", "1.0"]),
            [
                "spring.k.direction = -90 rad is more than a turn; if -90° is meant, write -1.5707963267948966"
            ]
        );
        assert!(with(["1.0", "1.0", "7.5", "1.0"])[0].starts_with("damper.d.direction = 7.5 rad"));
        assert!(with(["1.0", "1.0", "1.0", "5.0"])[0].contains("whole number and more than half"));
        // Radians: a turn, three quarters of one, and half of one.
        let turns = ["6.283185307179586", "4.71238898038469", "-3.141592653589793", "3.0"];
        assert_eq!(with(turns), Vec::<String>::new());
    }

    /// The closed form of `scenes/README.md`: each pad yields by µN/15 MN/m along the disc, N = 2500 N; here by a
    /// thousand times that.
    #[test]
    fn stiffnesses_in_newtons_a_millimetre_are_told_by_how_far_they_yield() {
        let mut scene = builtin("disc_brake").unwrap().scene();
        let Structure::Network(network) = &mut scene.structure else { panic!("it is a network") };
        for spring in &mut network.springs {
            spring.stiffness *= 1e-3;
        }
        let told = of(scene);
        let words = "deflects by 0.100 m under 1000.0 N in the equilibrium; if its stiffness of 10000 is in N/mm, write 1e7";
        assert!(told.len() == 1 && told[0].contains(words), "{told:?}");
        assert!(told[0].contains("_guide"), "{told:?}");
        // 110 N of Set 1's preload of 5 mm on 22 N/mm, a module; its masses are 1 kg each.
        let mut scene = builtin("set1").unwrap().scene();
        for module in scene.modules_mut() {
            module.stiffness = module.stiffness.map(|stiffness| 1e-3 * stiffness);
        }
        let told = of(scene);
        assert!(told.len() == 1 && told[0].contains("the masses weigh 19.620 N"), "{told:?}");
    }

    #[test]
    fn a_common_slider_between_two_pads_is_told_what_would_be_meant() {
        let text = builtin("disc_brake").unwrap().text;
        let slider = "\n[slider]\nvelocity = 0.05\nangle = 0.0\n";
        let common = text.replace("velocity = 0.05 ", "").replace("velocity = -0.05 ", "");
        assert_ne!(common, text);
        let scene = parse("mine", &format!("{common}{slider}")).unwrap();
        let told = of(scene.clone());
        assert_eq!(told.len(), 1, "{told:?}");
        let words = [
            "contact.upper_lining and contact.lower_lining in opposite directions",
            "`velocity = 0.05` and `velocity = -0.05`",
        ];
        assert!(words.iter().all(|word| told[0].contains(word)), "{told:?}");
        // A slider at rest moves nothing apart, and a single side moves in one direction only.
        let slider = Slider { velocity: 0.0, ..scene.slider };
        assert_eq!(of(Scene { slider, ..scene.clone() }), Vec::<String>::new());
        let mut alone = scene.clone();
        let Structure::Network(network) = &mut alone.structure else { panic!("it is a network") };
        network.contacts[1].velocity = Some(-0.05);
        assert_eq!(of(alone), Vec::<String>::new());
        // With a shoe at a third angle it is a drum.
        let mut drum = scene;
        let Structure::Network(network) = &mut drum.structure else { panic!("it is a network") };
        let shoe = ContactDefinition { angle: Some(1.5), ..network.contacts[0].clone() };
        network.contacts.push(shoe);
        assert_eq!(parted(&drum), None);
    }
}
