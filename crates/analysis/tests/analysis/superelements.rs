//! Analyses of superelements: unsymmetric matrices, nodes that are not shown, and modal coordinates.

use amontons::scene::{Freedom, Scene, SuperelementMatrices, read};
use amontons::simulation::{Simulation, dof_of, variables};
use amontons_analysis::orbit::{Flow, OrbitStart};
use amontons_analysis::study::transient::transient;
use amontons_analysis::study::{ObservationRequest, ObservationSettings, Watch};

const EVENT_DRIVEN: &str = "
integrator = { method = \"event-driven\", step = 1e-4 }
friction = { coefficient = 0.3 }
slider = { velocity = 0.2, angle = 0.0 }
effects = { sticking = true, detachment = true }
[[superelement]]
name = \"s\"
file = \"s.superelement\"
";

/// A node 1 with x and y of 1 kg each, a node 2 with x and y of 1 kg each, and a mode of mass 1, in a scene with this text.
/// The node 1 is on springs of 1e6 N/m, the node 2 on springs of 4e6 N/m. K has the circulatory part p and D the
/// gyroscopic part g between the axes of node 1.
fn scene([p, g]: [f64; 2], text: &str) -> Scene {
    let freedoms = [(1, 1), (1, 2), (2, 1), (2, 2), (1, 0)];
    let freedoms = freedoms.map(|(node, direction)| Freedom { node, direction });
    let diagonal = |values: [f64; 5]| {
        let mut matrix = vec![0.0; 25];
        values.into_iter().enumerate().for_each(|(i, value)| matrix[6 * i] = value);
        matrix
    };
    let mut stiffness = diagonal([1e6, 1e6, 4e6, 4e6, 9e6]);
    (stiffness[1], stiffness[5]) = (p, -p);
    let mut damping = diagonal([0.0; 5]);
    (damping[1], damping[5]) = (-g, g);
    let mass = diagonal([1.0; 5]);
    let matrices = SuperelementMatrices::new(freedoms.to_vec(), mass, stiffness, damping).unwrap();
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("s.superelement"), matrices.to_bytes()).unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, format!("{EVENT_DRIVEN}{text}")).unwrap();
    read(&path).unwrap().0
}

const PRESSED: &str = "
[[contact]]
name = \"belt\"
mass = \"s.2\"
normal = [0.0, 1.0, 0.0]
tangent = [1.0, 0.0, 0.0]
[[load]]
superelement = \"s\"
nodes = [2]
force = [0.0, -100.0, 0.0]
";

fn pressed(parts: [f64; 2], text: &str) -> Scene {
    scene(parts, &format!("{PRESSED}{text}"))
}

#[test]
fn the_equation_of_an_orbit_has_circulatory_and_gyroscopic_forces_as_the_run_does() {
    let (p, g) = (2e4, 300.0);
    let mut simulation =
        Simulation::new(pressed([p, g], "[outputs]\nnodes = [\"s.1\"]\n"), 0.0).unwrap();
    let mut motion = simulation.motion().clone();
    let ([x, y], [vx, vy]) = ([1e-4, -3e-4], [0.2, 0.5]);
    motion.displacement[..2].copy_from_slice(&[x, y]);
    motion.velocity[..2].copy_from_slice(&[vx, vy]);
    let mut flow = Flow::of(&mut simulation).unwrap();
    let state = flow.state(&motion, 0.0);
    let field = flow.field(&motion.contacts, &state).unwrap();
    let rate = Flow::rate(&field, &state);
    let expected = [-1e6 * x - p * y + g * vy, p * x - 1e6 * y - g * vx];
    for (found, expected) in rate.as_slice()[5..7].iter().zip(expected) {
        assert!((found - expected).abs() < 1e-9 * expected.abs(), "{found} {expected}");
    }
}

/// Node 2 is shown alone, so its x is the first variable and the third degree of freedom.
const SECOND_SHOWN: &str = "
[damping]
alpha = 20.0
beta = 0.0
[outputs]
nodes = [\"s.2\"]
[[initial]]
node = \"s.2\"
vx = 1e-3
";

#[test]
fn a_variable_of_a_shown_node_is_the_motion_of_that_node() {
    let scene = pressed([0.0; 2], SECOND_SHOWN);
    let names = scene.dof_names();
    let shown = variables(&scene);
    for (name, of) in [("x", "x"), ("vx", "x"), ("y", "y"), ("vy", "y")] {
        let [name, of] = [name, of].map(|last| format!("superelement.s.node[2].{last}"));
        let variable = shown.iter().find(|variable| variable.name == name).unwrap();
        assert_eq!(dof_of(&scene, variable), names.iter().position(|dof| *dof == of), "{name}");
    }
}

#[test]
fn studies_follow_a_displacement_that_is_shown_or_say_that_there_is_none() {
    let shown = pressed([0.0; 2], SECOND_SHOWN);
    let found = ObservationSettings::of(&shown, &ObservationRequest::default()).unwrap();
    assert_eq!(found.of, "superelement.s.node[2].x");

    let hidden = pressed([0.0; 2], "");
    let experiment = amontons::scene::Experiment { stop_time: 0.01, output_interval: 1e-4 };
    let of_run = transient(&hidden, experiment, None, Watch::IDLE).unwrap_err().to_string();
    let of_study = ObservationSettings::of(&hidden, &ObservationRequest::default());
    for error in [of_run, of_study.unwrap_err().to_string()] {
        assert!(error.contains("[outputs]"), "{error}");
    }
}

#[test]
fn an_orbit_gives_its_start_to_nodes_and_modes() {
    let mut scene = pressed([0.0; 2], "[outputs]\nnodes = [\"s.2\"]\n");
    let start = OrbitStart {
        period: 1e-3,
        displacement: vec![1e-4, -2e-4, 3e-4, 0.0, 5e-4],
        velocity: vec![0.1, -0.2, 0.3, 0.0, 0.5],
        states: vec![amontons::contact::ContactState::ReverseSlide],
    };
    start.give_start(&mut scene).unwrap();
    let motion = Simulation::new(scene, 0.0).unwrap().motion().clone();
    assert_eq!((motion.displacement, motion.velocity), (start.displacement, start.velocity));
}
