//! The scatter of parameters: what the user gives, or what the report assumes and says so.

use super::changes::MOST_NAMED;
use amontons::Error;
use amontons::model::LumpedModel;
use amontons::scene::{ContactDefinition, Scene};
use amontons::simulation::{Parameters, Variable};
use amontons_analysis::assign::FRICTION;
use amontons_analysis::instant::require_undriven;
use amontons_analysis::robustness::{Distribution, FEWEST_SCRAMBLINGS, Uncertain, parameters};

/// Standard deviations that are assumed, in parts of the scene's values.
const OF_FRICTION: f64 = 0.10;
const OF_OTHERS: f64 = 0.05;
/// Static friction in parts of kinetic friction that no draw reaches: ten standard deviations away.
const ROOM: f64 = 1.0 + 10.0 * OF_FRICTION;
/// More parameters cannot scatter.
const MOST: usize = 128;
/// Names of masses and stiffnesses in the catalogue of variables.
const KINDS: [&str; 10] = [
    "module{i}.m1",
    "module{i}.m2",
    "module{i}.k1",
    "module{i}.k2",
    "module{i}.k3",
    "module{i}.k4",
    "module{i}.k5",
    "module{i}.k6",
    "mass{i}.mass",
    "spring{i}.stiffness",
];
/// Work of the draws: the number of eigenvalue problems by the third power of their size. More takes longer than about half
/// a minute on two cores.
const WORK: f64 = 5e8;
/// Bounds of the number of points in a scrambling.
const POINTS: [u64; 2] = [64, 1024];

/// The parameters that scatter, and whether the user or the report chose them.
pub struct Assumptions {
    pub uncertain: Vec<Uncertain>,
    /// `true` if the user gave none of it.
    pub is_assumed: bool,
    /// `true` if there are too many values for a draw of each: those of one kind change by the same part.
    pub is_together: bool,
    /// `true` if masses and stiffnesses are too many to scatter.
    pub is_friction_alone: bool,
}

impl Assumptions {
    /// The scatter that the user gives, or else friction, masses and stiffnesses about their values in the scene.
    ///
    /// # Errors
    /// Returns an error if the scene cannot be read by names.
    pub fn of(scene: &Scene, given: &[Uncertain]) -> Result<Self, Error> {
        if !given.is_empty() {
            let uncertain = given.to_vec();
            return Ok(Self {
                uncertain,
                is_assumed: false,
                is_together: false,
                is_friction_alone: false,
            });
        }
        let all = |is_together: bool| {
            let friction = of_friction(scene, is_together)?;
            let others = of_masses_and_stiffnesses(scene, is_together)?;
            Ok::<_, Error>((friction.clone(), [friction, others].concat()))
        };
        let (_, apart) = all(false)?;
        let is_together = count(scene, &apart) > MOST;
        let (friction, together) = if is_together { all(true)? } else { (Vec::new(), apart) };
        let is_friction_alone = is_together && count(scene, &together) > MOST;
        let uncertain = if is_friction_alone { friction } else { together };
        Ok(Self { uncertain, is_assumed: true, is_together, is_friction_alone })
    }

    /// `true` if friction scatters, and if masses and stiffnesses do.
    pub fn has(&self) -> [bool; 2] {
        let is_friction = |one: &Uncertain| one.name == FRICTION || one.name.ends_with(".friction");
        [true, false].map(|wanted| self.uncertain.iter().any(|one| is_friction(one) == wanted))
    }

    /// `true` if values of one kind scatter together, but friction of several contacts does not.
    pub fn has_friction_apart(&self) -> bool {
        let is_apart = |one: &&Uncertain| !one.is_together && one.name.ends_with(".friction");
        self.is_together && self.uncertain.iter().filter(is_apart).count() > 1
    }

    /// The options of the command line that say the same.
    pub fn options(&self) -> String {
        let one = |one: &Uncertain| format!(" --uncertain '{}={}'", one.name, one.written());
        self.uncertain.iter().map(one).collect()
    }
}

/// The number of parameters that scatter.
fn count(scene: &Scene, uncertain: &[Uncertain]) -> usize {
    let one = |one: &Uncertain| parameters(scene, std::slice::from_ref(one)).map(|all| all.len());
    uncertain.iter().map(|it| one(it).unwrap_or(MOST + 1)).sum()
}

/// The distribution of a µ that stays below static friction.
fn below(value: f64, most: f64) -> String {
    format!("normal({value},{},0:{most})", OF_FRICTION * value)
}

/// The common µ and those of contacts, each below its static friction. Together those of contacts are one, if they can be: a
/// distribution has bounds for equal values only, and others need room for all draws.
fn of_friction(scene: &Scene, is_together: bool) -> Result<Vec<Uncertain>, Error> {
    let scattering = |name: String, value: f64, most: Option<f64>| {
        if value <= 0.0 || require_undriven(scene, &name).is_err() {
            return Ok(None);
        }
        let text = match most {
            Some(most) => below(value, most),
            None => relative(OF_FRICTION),
        };
        let distribution = distribution(&text)?;
        Ok::<_, Error>(Some(Uncertain { name, distribution, is_together: false }))
    };
    let mut all = Vec::new();
    if scene.has_common_friction() {
        let most = scene.greatest_friction();
        all.extend(scattering(FRICTION.to_owned(), scene.friction_coefficient, most)?);
    }
    let contacts = scene.network().map_or(&[][..], |network| &network.contacts);
    let of_contact = |contact: &ContactDefinition| {
        let name = format!("contact.{}.friction", contact.name);
        scattering(name, contact.friction?, contact.static_friction).transpose()
    };
    let own = contacts.iter().filter_map(of_contact).collect::<Result<Vec<_>, Error>>()?;
    let values: Vec<f64> = contacts.iter().filter_map(|contact| contact.friction).collect();
    let bounded = contacts.iter().filter_map(|it| Some((it.friction?, it.static_friction?)));
    let bounded: Vec<(f64, f64)> = bounded.collect();
    let has_room = bounded.iter().all(|(own, most)| *most >= ROOM * own);
    let text = match values[..] {
        [value, ..] if !has_room && values.iter().all(|other| *other == value) => {
            let most = bounded.iter().map(|it| it.1).fold(f64::INFINITY, f64::min);
            Some(below(value, most))
        }
        _ => has_room.then(|| relative(OF_FRICTION)),
    };
    let of_all = |text: String| {
        let (name, distribution) = ("contact.*.friction".to_owned(), distribution(&text)?);
        Ok::<_, Error>(Uncertain { name, distribution, is_together: true })
    };
    let all_contacts = text.map(of_all).transpose()?;
    let is_one = |it: &Uncertain| parameters(scene, std::slice::from_ref(it)).is_ok();
    match all_contacts.filter(|it| is_together && own.len() > 1 && is_one(it)) {
        Some(together) => all.push(together),
        None => all.extend(own),
    }
    Ok(all)
}

/// Masses and stiffnesses that are not zero; a `*` stands for all parts if each of them scatters. Together a kind is one, if it can
/// be.
fn of_masses_and_stiffnesses(scene: &Scene, is_together: bool) -> Result<Vec<Uncertain>, Error> {
    let values = Parameters::of(scene.clone());
    let distribution = distribution(&relative(OF_OTHERS))?;
    let mut all = Vec::new();
    for kind in KINDS {
        let of_kind: Vec<(&Variable, f64)> =
            values.iter().filter(|(variable, _)| variable.template.name == kind).collect();
        let scatters = |(variable, value): &&(&Variable, f64)| {
            *value != 0.0 && require_undriven(scene, &variable.name).is_ok()
        };
        let scattering: Vec<_> = of_kind.iter().filter(scatters).collect();
        let part = if kind.starts_with("module") { "[*]" } else { ".*" };
        let of = |name: String, is_together: bool| Uncertain {
            name,
            distribution: distribution.clone(),
            is_together,
        };
        let whole = of(kind.replace("{i}", part), is_together);
        // A part of zero is zero, so that zeros may be among values that scatter together.
        let is_whole = if is_together {
            !scattering.is_empty() && parameters(scene, std::slice::from_ref(&whole)).is_ok()
        } else {
            scattering.len() == of_kind.len()
        };
        if is_whole && of_kind.len() > 1 {
            all.push(whole);
        } else {
            all.extend(scattering.iter().map(|(variable, _)| of(variable.name.clone(), false)));
        }
    }
    Ok(all)
}

/// A normal distribution about the scene's value.
fn relative(part: f64) -> String {
    format!("normal(±{}%)", 100.0 * part)
}

fn distribution(text: &str) -> Result<Distribution, Error> {
    Distribution::parse(text).map_err(Error::argument)
}

/// The draws that are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plan {
    /// The number of points in each scrambling, a power of two.
    pub points: u64,
    /// `true` if the points are evaluated that Sobol indices need: one, and one more for each parameter.
    pub has_indices: bool,
    /// `true` if changed scenes are drawn as often as the scene itself.
    pub has_changes: bool,
}

impl Plan {
    /// The number of points that the user gives, or one that takes a short time: fewer points for many parameters and large models, and no
    /// indices where these would leave too few points.
    pub fn of(scene: &Scene, parameters: usize, given: Option<u64>) -> Self {
        let of_indices = parameters + 2;
        let (points, has_indices) = match given {
            Some(points) => (points, true),
            None => match (affordable(scene, of_indices), affordable(scene, 1)) {
                (Some(points), _) => (points, true),
                (None, points) => (points.unwrap_or(POINTS[0]), false),
            },
        };
        let has_changes = work(scene, points, MOST_NAMED + 1) <= WORK;
        Self { points, has_indices, has_changes }
    }
}

/// The largest number of points with this number of evaluations each, if it is not too small.
fn affordable(scene: &Scene, evaluations: usize) -> Option<u64> {
    let [fewest, most] = POINTS;
    let mut halves = std::iter::successors(Some(most), |points| Some(points / 2))
        .take_while(|points| *points >= fewest);
    halves.find(|points| work(scene, *points, evaluations) <= WORK)
}

/// The work of draws with this number of evaluations for each point.
#[allow(clippy::cast_precision_loss)]
fn work(scene: &Scene, points: u64, evaluations: usize) -> f64 {
    let size = LumpedModel::from(scene).dofs() as f64;
    FEWEST_SCRAMBLINGS as f64 * points as f64 * evaluations as f64 * size.powi(3)
}

#[cfg(test)]
mod tests {
    use super::*;
    use amontons::scene::{builtin, parse};

    fn names(scene: &Scene) -> Vec<String> {
        let assumed = Assumptions::of(scene, &[]).unwrap();
        assumed.uncertain.iter().map(|it| format!("{}={}", it.name, it.written())).collect()
    }

    #[test]
    fn friction_scatters_twice_as_much_as_masses_and_stiffnesses() {
        let scene = builtin("disc_brake").unwrap().scene();
        let expected = [
            "friction.coefficient=normal(±10%)",
            "mass.*.mass=normal(±5%)",
            "spring.*.stiffness=normal(±5%)",
        ];
        assert_eq!(names(&scene), expected);
        let assumed = Assumptions::of(&scene, &[]).unwrap();
        assert_eq!(parameters(&scene, &assumed.uncertain).unwrap().len(), 11);
    }

    #[test]
    fn kinetic_friction_stays_below_static_friction() {
        let text = builtin("belt").unwrap().text;
        let scene = parse("belt", &text.replace("[friction]", "[friction]\nstatic = 9.0")).unwrap();
        assert!(names(&scene)[0].ends_with(",0:9)"), "{:?}", names(&scene));
    }

    #[test]
    fn a_spring_of_zero_does_not_scatter_and_the_others_do() {
        let mut scene = builtin("set1").unwrap().scene();
        scene.modules_mut()[0].stiffness[5] = 0.0;
        let names = names(&scene);
        assert!(names.contains(&"module[2].k6=normal(±5%)".to_owned()), "{names:?}");
        assert!(!names.iter().any(|name| name.starts_with("module[1].k6")), "{names:?}");
    }

    #[test]
    fn values_of_one_kind_scatter_together_in_a_ring_with_too_many_parts() {
        let mut scene = builtin("set1").unwrap().scene();
        let module = scene.modules()[0];
        scene.modules_mut().resize(20, module);
        scene.modules_mut()[3].stiffness[4] = 0.0;
        let assumed = Assumptions::of(&scene, &[]).unwrap();
        assert!(assumed.is_together && !assumed.is_friction_alone);
        let names = names(&scene);
        assert_eq!(
            names[..2],
            ["friction.coefficient=normal(±10%)", "module[*].m1=together normal(±5%)"]
        );
        assert!(names.contains(&"module[*].k5=together normal(±5%)".to_owned()), "{names:?}");
        assert_eq!(parameters(&scene, &assumed.uncertain).unwrap().len(), names.len());
    }

    /// Blocks with friction coefficients of their own, with what else each contact has.
    fn blocks(count: u32, friction: impl Fn(f64) -> String) -> Scene {
        let part = |i: u32| {
            format!(
                "[[mass]]\nname = \"m{i}\"\nmass = 1.0\nforce = [0.0, -10.0]\n[[spring]]\nname = \"s{i}\"\nbetween = [\"m{i}\", \"ground\"]\n\
                 direction = \"x\"\nstiffness = 1e4\n[[contact]]\nname = \"c{i}\"\nmass = \"m{i}\"\nfriction = {}\n",
                friction(f64::from(i))
            )
        };
        let parts: String = (0..count).map(part).collect();
        let head = "slider = { velocity = 0.1, angle = 0.0 }\nfriction = { coefficient = 0.3 }\nintegrator = { step = 1e-5 }\n";
        parse("many", &format!("{head}{parts}")).unwrap()
    }

    /// With a draw of each there would be more than a Sobol sequence has dimensions.
    #[test]
    fn many_contacts_with_friction_of_their_own_scatter_together() {
        let scene = blocks(130, |i| format!("{}", 0.3 + 0.001 * i));
        assert_eq!(
            names(&scene),
            [
                "contact.*.friction=together normal(±10%)",
                "mass.*.mass=together normal(±5%)",
                "spring.*.stiffness=together normal(±5%)"
            ]
        );
        assert!(Assumptions::of(&scene, &[]).unwrap().is_together);
    }

    #[test]
    fn friction_that_scatters_together_stays_below_the_static_friction_of_each_contact() {
        let equal = blocks(44, |i| format!("0.3\nstatic_friction = {}", 0.33 + 0.001 * i));
        assert_eq!(names(&equal)[0], "contact.*.friction=together normal(0.3,0.03,0:0.33)");
        let far = blocks(44, |i| format!("{}\nstatic_friction = 2", 0.3 + 0.001 * i));
        assert_eq!(names(&far)[0], "contact.*.friction=together normal(±10%)");
        let near = blocks(44, |i| format!("{}\nstatic_friction = 0.35", 0.3 + 0.001 * i));
        let assumed = Assumptions::of(&near, &[]).unwrap();
        assert!(assumed.has_friction_apart() && !assumed.is_friction_alone);
        let names = names(&near);
        assert!(names.len() == 46 && names[..44].iter().all(|it| it.ends_with(",0:0.35)")));
    }

    #[test]
    fn large_scenes_have_fewer_draws_and_then_no_indices() {
        let small = builtin("set1").unwrap().scene();
        let all = Plan { points: POINTS[1], has_indices: true, has_changes: true };
        assert_eq!(Plan::of(&small, 15, None), all);
        let ring = builtin("ring12").unwrap().scene();
        let plan = Plan::of(&ring, 97, None);
        assert!(!plan.has_indices && (POINTS[0]..POINTS[1]).contains(&plan.points), "{plan:?}");
        assert!(!plan.has_changes);
        let few = Plan { points: 16, has_indices: true, has_changes: true };
        assert_eq!(Plan::of(&ring, 97, Some(16)), few);
    }
}
