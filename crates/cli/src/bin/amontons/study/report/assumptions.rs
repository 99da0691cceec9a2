//! The scatter of parameters: what the user gives, or what the report assumes and says so.

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
            return Ok(Self { uncertain, is_assumed: false, is_friction_alone: false });
        }
        let friction = of_friction(scene)?;
        let mut all = friction.clone();
        all.extend(of_masses_and_stiffnesses(scene)?);
        let is_friction_alone = count(scene, &all) > MOST;
        let uncertain = if is_friction_alone { friction } else { all };
        Ok(Self { uncertain, is_assumed: true, is_friction_alone })
    }

    /// `true` if friction scatters, and if masses and stiffnesses do.
    pub fn has(&self) -> [bool; 2] {
        let is_friction = |one: &Uncertain| one.name == FRICTION || one.name.ends_with(".friction");
        [true, false].map(|wanted| self.uncertain.iter().any(|one| is_friction(one) == wanted))
    }

    /// The options of the command line that say the same.
    pub fn options(&self) -> String {
        let one = |one: &Uncertain| format!(" --uncertain '{}={}'", one.name, one.distribution);
        self.uncertain.iter().map(one).collect()
    }
}

/// The number of parameters that scatter.
fn count(scene: &Scene, uncertain: &[Uncertain]) -> usize {
    let one = |one: &Uncertain| parameters(scene, std::slice::from_ref(one)).map(|all| all.len());
    uncertain.iter().map(|it| one(it).unwrap_or(MOST + 1)).sum()
}

/// The common µ and those of contacts, each below its static friction.
fn of_friction(scene: &Scene) -> Result<Vec<Uncertain>, Error> {
    let mut all = Vec::new();
    let mut add = |name: String, value: f64, most: Option<f64>| {
        if value <= 0.0 || require_undriven(scene, &name).is_err() {
            return Ok(());
        }
        let text = match most {
            Some(most) => format!("normal({value},{},0:{most})", OF_FRICTION * value),
            None => relative(OF_FRICTION),
        };
        all.push(Uncertain { name, distribution: distribution(&text)? });
        Ok::<(), Error>(())
    };
    if scene.has_common_friction() {
        add(FRICTION.to_owned(), scene.friction_coefficient, scene.greatest_friction())?;
    }
    let contacts = scene.network().map_or(&[][..], |network| &network.contacts);
    for ContactDefinition { name, friction, static_friction, .. } in contacts {
        if let Some(own) = friction {
            add(format!("contact.{name}.friction"), *own, *static_friction)?;
        }
    }
    Ok(all)
}

/// Masses and stiffnesses that are not zero; a `*` stands for all parts if each of them scatters.
fn of_masses_and_stiffnesses(scene: &Scene) -> Result<Vec<Uncertain>, Error> {
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
        let names: Vec<String> = if scattering.len() == of_kind.len() && of_kind.len() > 1 {
            vec![kind.replace("{i}", part)]
        } else {
            scattering.iter().map(|(variable, _)| variable.name.clone()).collect()
        };
        let of = |name| Uncertain { name, distribution: distribution.clone() };
        all.extend(names.into_iter().map(of));
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
}

impl Plan {
    /// The number of points that the user gives, or one that takes a short time: fewer points for many parameters and large models, and no
    /// indices where these would leave too few points.
    pub fn of(scene: &Scene, parameters: usize, given: Option<u64>) -> Self {
        if let Some(points) = given {
            return Self { points, has_indices: true };
        }
        let of_indices = parameters + 2;
        match (affordable(scene, of_indices), affordable(scene, 1)) {
            (Some(points), _) => Self { points, has_indices: true },
            (None, points) => Self { points: points.unwrap_or(POINTS[0]), has_indices: false },
        }
    }
}

/// The largest number of points with this number of evaluations each, if it is not too small.
#[allow(clippy::cast_precision_loss)]
fn affordable(scene: &Scene, evaluations: usize) -> Option<u64> {
    let [fewest, most] = POINTS;
    let size = LumpedModel::from(scene).dofs() as f64;
    let work =
        |points: u64| (FEWEST_SCRAMBLINGS * points) as f64 * evaluations as f64 * size.powi(3);
    let halves = std::iter::successors(Some(most), |points| Some(points / 2));
    halves.take_while(|points| *points >= fewest).find(|points| work(*points) <= WORK)
}

#[cfg(test)]
mod tests {
    use super::*;
    use amontons::scene::{builtin, parse};

    fn names(scene: &Scene) -> Vec<String> {
        let assumed = Assumptions::of(scene, &[]).unwrap();
        assumed.uncertain.iter().map(|it| format!("{}={}", it.name, it.distribution)).collect()
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
    fn friction_alone_scatters_in_a_ring_with_too_many_parts() {
        let mut scene = builtin("set1").unwrap().scene();
        let module = scene.modules()[0];
        scene.modules_mut().resize(20, module);
        let assumed = Assumptions::of(&scene, &[]).unwrap();
        assert!(assumed.is_friction_alone && assumed.uncertain.len() == 1);
    }

    #[test]
    fn large_scenes_have_fewer_draws_and_then_no_indices() {
        let small = builtin("set1").unwrap().scene();
        assert_eq!(Plan::of(&small, 15, None), Plan { points: POINTS[1], has_indices: true });
        let ring = builtin("ring12").unwrap().scene();
        let plan = Plan::of(&ring, 97, None);
        assert!(!plan.has_indices && (POINTS[0]..POINTS[1]).contains(&plan.points), "{plan:?}");
        assert_eq!(Plan::of(&ring, 97, Some(16)), Plan { points: 16, has_indices: true });
    }
}
