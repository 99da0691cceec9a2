//! Values that are possible, but look like those of another unit or of another machine: angles in degrees, stiffnesses
//! in N/mm, one slider that would have to go two ways.

use amontons::assembly::Numbering;
use amontons::decimal::to_significant;
use amontons::error::Short;
use amontons::model::Equilibrium;
use amontons::scene::{ContactDefinition, Network, Point, Scene, Superelement, direction};
use amontons::simulation::Simulation;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::f64::consts::{PI, TAU};

/// A spring whose ends the equilibrium moves apart or together by more, m, is doubtful: those of machines yield by
/// less than a millimetre, and their stiffnesses in N/mm, read in N/m, by a thousand times that.
const FAR: f64 = 0.05;
/// A node of a superelement that the load moves farther, m, is doubtful.
const FAR_NODE: f64 = 0.02;
/// Weights do hang on soft springs, so the spring's force must be more than this many times the weight of all masses.
const WEIGHTS: f64 = 10.0;
/// Preloads that press all contacts on with less than this part of the masses' weight are doubtful.
const FAINT: f64 = 0.02;
/// A superelement is doubtful beside another one that has more than the first factor times its mass, and the second
/// times its stiffness.
const LIGHT: [f64; 2] = [500.0, 100.0];
/// A superelement of less mass, kg, is doubtful if its own springs and masses make it a body of metal.
const FEATHER: f64 = 5e-3;
/// Stiffness by mass of a structure whose parts ring above some kHz, 1/s².
const RIGID: f64 = 1e8;
/// Acceleration of gravity, m/s².
const GRAVITY: f64 = 9.81;
/// Digits of a number that is proposed in place of a doubtful one.
const DIGITS: usize = 12;
/// Tangents whose product is this near to −1 are opposite.
const OPPOSITE: f64 = 1e-6;

/// The doubtful values of a scene, one sentence for each.
pub(crate) fn doubts(simulation: &Simulation) -> Vec<String> {
    let (scene, reference) = (simulation.scene(), simulation.reference());
    let mut doubts: Vec<String> = angles(scene).filter_map(doubtful_angle).collect();
    doubts.extend(strained(scene, reference));
    doubts.extend(faint(scene, reference));
    doubts.extend(far(scene, reference));
    doubts.extend(light(scene));
    doubts.extend(parted(scene));
    doubts.extend(creeping(scene));
    doubts.extend(doubled(scene));
    doubts
}

/// The doubtful values of a scene that is not run, one sentence for each. Without an equilibrium, springs that it
/// would strain are not reported.
#[must_use]
pub fn doubts_of(scene: &Scene) -> Vec<String> {
    match Simulation::new(scene.clone(), 0.0) {
        Ok(simulation) => doubts(&simulation),
        Err(_) => {
            let angles = angles(scene).filter_map(doubtful_angle);
            let others = light(scene).into_iter().chain(parted(scene));
            angles.chain(others).chain(creeping(scene)).chain(doubled(scene)).collect()
        }
    }
}

/// All angles of a scene, rad, by name.
fn angles(scene: &Scene) -> impl Iterator<Item = (String, f64)> + '_ {
    let slider = scene.has_common_angle().then(|| ("slider.angle".to_owned(), scene.slider.angle));
    let network = scene.network().into_iter();
    let own = network.flat_map(|network| {
        let masses = network.masses.iter().map(|m| (format!("mass.{}.angle", m.name), m.angle));
        let springs = network.springs.iter();
        let springs = springs.filter_map(|s| {
            s.direction.angle().map(|angle| (format!("spring.{}.direction", s.name), angle))
        });
        let dampers = network.dampers.iter();
        let dampers = dampers.filter_map(|d| {
            d.direction.angle().map(|angle| (format!("damper.{}.direction", d.name), angle))
        });
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
    let numbering = Numbering::of(network);
    let strains = network.springs.iter().map(|spring| {
        let moved = |end| displacement(network, &numbering, &reference.displacement, end);
        let [a, b] = spring.between.map(|end| end.map_or([0.0; 3], moved));
        let strain = dot(spring.direction.vector(), [a[0] - b[0], a[1] - b[1], a[2] - b[2]]);
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

/// The displacement of a point, to the right, up and towards the viewer, m.
fn displacement(network: &Network, numbering: &Numbering, free: &[f64], point: Point) -> [f64; 3] {
    let value = |dof: Option<usize>| dof.and_then(|dof| free.get(dof)).copied().unwrap_or(0.0);
    match point {
        Point::Mass(mass) => {
            let [x, y] = [0, 1].map(|axis| value(numbering.dof(mass, axis)));
            let [cos, sin] = direction(network.masses[mass].angle);
            [x * cos - y * sin, x * sin + y * cos, 0.0]
        }
        Point::Node(at) => [1, 2, 3].map(|axis| {
            let row = network.node_row(at, axis);
            value(row.and_then(|row| numbering.row(at.superelement, row)))
        }),
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Contacts that preloads alone press on, hardly.
fn faint(scene: &Scene, reference: &Equilibrium) -> Option<String> {
    let loads = scene.network().map_or(&[][..], |network| &network.masses);
    let superelements = scene.network().map_or(&[][..], |network| &network.superelements);
    let has_loads = superelements.iter().any(|one| one.load.iter().any(|load| *load != 0.0));
    if has_loads || loads.iter().any(|mass| mass.load != [0.0; 2]) {
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
    let superelements = scene.network().map_or(&[][..], |network| &network.superelements);
    let masses = modules.chain(masses.iter().map(|mass| mass.mass));
    GRAVITY * masses.chain(superelements.iter().filter_map(mass_of)).sum::<f64>()
}

/// The mass of a superelement, kg: that which a translation of its nodes moves, along the axis with most of it. `None` for
/// modal coordinates alone.
fn mass_of(superelement: &Superelement) -> Option<f64> {
    let matrices = &superelement.matrices;
    let along = |axis: u8| {
        let freedoms = matrices.freedoms().iter().enumerate();
        let rows: Vec<usize> =
            freedoms.filter(|(_, one)| one.direction == axis).map(|(row, _)| row).collect();
        let n = matrices.dofs();
        let of_row =
            |row: &usize| rows.iter().map(|column| matrices.mass()[row * n + column]).sum::<f64>();
        rows.iter().map(of_row).sum::<f64>()
    };
    Some((1..=3).map(along).fold(0.0, f64::max)).filter(|mass| *mass > 0.0)
}

/// The node that the load moves farthest, where that is farther than a structure yields.
fn far(scene: &Scene, reference: &Equilibrium) -> Option<String> {
    let network = scene.network()?;
    let numbering = Numbering::of(network);
    let mut farthest: Option<(f64, usize, u64)> = None;
    for (i, one) in network.superelements.iter().enumerate() {
        for (row, freedom) in one.matrices.freedoms().iter().enumerate() {
            let dof = numbering.row(i, row).filter(|_| matches!(freedom.direction, 1..=3));
            let moved =
                dof.and_then(|dof| reference.displacement.get(dof)).map_or(0.0, |x| x.abs());
            if moved > FAR_NODE && farthest.is_none_or(|(most, ..)| moved > most) {
                farthest = Some((moved, i, freedom.node));
            }
        }
    }
    let (moved, place, node) = farthest?;
    let name = &network.superelements[place].name;
    Some(format!(
        "the load moves node {node} of superelement {name} by {moved:.3} m in the equilibrium; if its matrices are in N, mm, t \
         and s, write `units = \"N-mm-t-s\"`"
    ))
}

/// A superelement whose matrices look like those of another system of units: light and soft by the same factor, beside
/// all others. The frequencies of a structure do not tell newton and millimetre from newton and metre.
fn light(scene: &Scene) -> Option<String> {
    let network = scene.network()?;
    let sizes: Vec<(&str, f64, f64)> = network
        .superelements
        .iter()
        .filter_map(|one| Some((&*one.name, mass_of(one)?, stiffest(one)?)))
        .collect();
    for &(name, mass, stiffness) in &sizes {
        let other = sizes
            .iter()
            .find(|(_, heavy, stiff)| *heavy > LIGHT[0] * mass && *stiff > LIGHT[1] * stiffness);
        if let Some((other, heavy, stiff)) = other {
            return Some(format!(
                "superelement {name} has 1/{:.0} of the mass and 1/{:.0} of the stiffness of {other}; if its matrices are in N, mm, t \
                 and s, write `units = \"N-mm-t-s\"`",
                heavy / mass,
                stiff / stiffness
            ));
        }
        if mass < FEATHER && stiffness / mass > RIGID {
            return Some(format!(
                "superelement {name} has a mass of {mass:.3e} kg; if its matrices are in N, mm, t and s, write \
                 `units = \"N-mm-t-s\"`"
            ));
        }
    }
    None
}

/// The largest stiffness of a displacement of a node, N/m.
fn stiffest(superelement: &Superelement) -> Option<f64> {
    let matrices = &superelement.matrices;
    let freedoms = matrices.freedoms().iter().enumerate();
    let nodes = freedoms.filter(|(_, one)| matches!(one.direction, 1..=3));
    nodes.map(|(row, _)| matrices.stiffness()[row * (matrices.dofs() + 1)]).reduce(f64::max)
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
        let [a, b] = [a, b].map(|place| place.directions(scene.slider.angle)[1]);
        dot(a, b)
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

/// A superelement with a mode that is damped so much that it does not oscillate, as percent taken for a ratio do.
fn creeping(scene: &Scene) -> Option<String> {
    let mut all = scene.network()?.superelements.iter();
    let (name, ratio) = all.find_map(|one| Some((&one.name, one.overdamped?)))?;
    Some(format!(
        "damping_ratio = {} of superelement {name} is above 1, so that modes do not oscillate; if {} % is meant, write {}",
        Short(ratio),
        Short(ratio),
        Short(to_significant(0.01 * ratio, DIGITS))
    ))
}

/// A node that slides in several contacts of one set: a line of its pairs may name the wrong node.
fn doubled(scene: &Scene) -> Option<String> {
    let network = scene.network()?;
    let mut known: HashMap<(usize, Point), &str> = HashMap::new();
    let mut twice = network.contacts.iter().filter_map(|contact| {
        let key = (contact.set?, contact.mass);
        match known.entry(key) {
            Entry::Vacant(place) => {
                place.insert(&contact.name);
                None
            }
            Entry::Occupied(first) => Some((*first.get(), contact)),
        }
    });
    let (first, contact) = twice.next()?;
    let others = twice.count();
    let more =
        if others == 0 { String::new() } else { format!("; the same holds for {others} more") };
    Some(format!(
        "{} slides in two contacts of the set {}, contact.{first} and contact.{}{more}; check the column node of its pairs, unless \
         the node touches two points",
        network.point_name(contact.mass),
        network.contact_sets[contact.set?],
        contact.name
    ))
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

    /// One node along x, with this mass (kg) and this stiffness (N/m) against the ground.
    fn lump(name: &str, mass: f64, stiffness: f64) -> Superelement {
        let freedoms = vec![amontons::scene::Freedom { node: 1, direction: 1 }];
        let matrices = amontons::scene::SuperelementMatrices::new(
            freedoms,
            vec![mass],
            vec![stiffness],
            Vec::new(),
        );
        Superelement::new(name, matrices.unwrap())
    }

    #[test]
    fn superelements_in_tonnes_and_newtons_by_millimetre_are_doubtful() {
        let doubts = |superelements: Vec<Superelement>| {
            let mut scene = builtin("disc_brake").unwrap().scene();
            let Structure::Network(network) = &mut scene.structure else { panic!("a network") };
            network.superelements = superelements;
            of(scene)
        };
        assert_eq!(doubts(vec![lump("shoe", 0.4, 1e8), lump("rotor", 6.0, 1e9)]), [""; 0]);
        assert_eq!(doubts(vec![lump("clip", 0.02, 1e6), lump("rotor", 6.0, 1e9)]), [""; 0]);
        let light = doubts(vec![lump("shoe", 0.4e-3, 1e5), lump("rotor", 6.0, 1e9)]);
        assert_eq!(light.len(), 1, "{light:?}");
        assert!(light[0].starts_with("superelement shoe has 1/15000 of the mass"), "{light:?}");
        assert!(light[0].ends_with("write `units = \"N-mm-t-s\"`"), "{light:?}");
        let alone = doubts(vec![lump("shoe", 0.4e-3, 1e5)]);
        assert!(alone[0].starts_with("superelement shoe has a mass of 4.000e-4 kg"), "{alone:?}");
        let mut pushed = lump("shoe", 0.4, 1e5);
        pushed.load[0] = 3e3;
        let far = doubts(vec![pushed]);
        assert!(
            far[0].starts_with("the load moves node 1 of superelement shoe by 0.030 m"),
            "{far:?}"
        );
    }

    #[test]
    fn a_damping_ratio_above_one_is_told_as_percent() {
        let doubts = |overdamped: Option<f64>| {
            let mut scene = builtin("disc_brake").unwrap().scene();
            let Structure::Network(network) = &mut scene.structure else { panic!("a network") };
            let shoe = lump("shoe", 0.4, 1e8);
            network.superelements = vec![Superelement { overdamped, ..shoe }];
            of(scene)
        };
        assert_eq!(doubts(None), [""; 0]);
        let said = "damping_ratio = 2.3 of superelement shoe is above 1, so that modes do not oscillate; if 2.3 % is meant, write 0.023";
        assert_eq!(doubts(Some(2.3)), [said]);
    }

    #[test]
    fn a_node_that_slides_in_two_contacts_of_a_set_is_doubtful() {
        let mut scene = builtin("disc_brake").unwrap().scene();
        let Structure::Network(network) = &mut scene.structure else { panic!("a network") };
        network.contact_sets = vec!["pads".into()];
        let [first, second] = &mut network.contacts[..] else { panic!("two contacts") };
        first.set = Some(0);
        second.set = Some(0);
        let (names, mass) = ([first.name.clone(), second.name.clone()], first.mass);
        assert_eq!(doubled(&scene), None);
        let Structure::Network(network) = &mut scene.structure else { panic!("a network") };
        network.contacts[1].mass = mass;
        let told = doubled(&scene).unwrap();
        let [first, second] = names;
        let words = format!(
            "slides in two contacts of the set pads, contact.{first} and contact.{second}; check"
        );
        assert!(told.contains(&words), "{told}");
        // In sets of their own a node may touch two surfaces.
        let Structure::Network(network) = &mut scene.structure else { panic!("a network") };
        network.contacts[1].set = Some(1);
        assert_eq!(doubled(&scene), None);
    }
}
