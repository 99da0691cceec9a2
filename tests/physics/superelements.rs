//! Superelements: matrices with closed forms, and structures that are written as masses and springs too.

use amontons::assembly;
use amontons::contact::ContactState;
use amontons::model::LumpedModel;
use amontons::scene::{Freedom, Method, Scene, SuperelementMatrices, read};
use amontons::simulation::{Simulation, variables};
use std::f64::consts::PI;
use std::path::PathBuf;

/// A folder of its own with these files, in which the scene is read.
fn scene_in(
    name: &str,
    matrices: &[(&str, SuperelementMatrices)],
    text: &str,
) -> Result<Scene, String> {
    scene_beside(name, matrices, &[], text)
}

fn scene_beside(
    name: &str,
    matrices: &[(&str, SuperelementMatrices)],
    tables: &[(&str, &str)],
    text: &str,
) -> Result<Scene, String> {
    let folder: PathBuf =
        std::env::temp_dir().join(format!("amontons-superelements-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    for (name, matrices) in matrices {
        std::fs::write(folder.join(format!("{name}.superelement")), matrices.to_bytes()).unwrap();
    }
    for (name, text) in tables {
        std::fs::write(folder.join(name), text).unwrap();
    }
    let path = folder.join("scene.toml");
    std::fs::write(&path, text).unwrap();
    let scene = read(&path).map(|(scene, _)| scene).map_err(|error| error.to_string());
    std::fs::remove_dir_all(&folder).unwrap();
    scene
}

fn freedoms(all: &[(u64, u8)]) -> Vec<Freedom> {
    all.iter().map(|&(node, direction)| Freedom { node, direction }).collect()
}

/// Two nodes, x and y each, of 1 kg and 2 kg, on springs: between them, and each against the ground.
fn two_nodes() -> SuperelementMatrices {
    let springs = [
        // Ends (None is the ground), direction, stiffness.
        (0, Some(1), 0.3_f64, 4e4),
        (0, None, 1.1, 3e4),
        (1, None, 0.0, 2e4),
        (1, None, PI / 2.0, 5e4),
    ];
    let mut stiffness = vec![0.0; 16];
    for (a, b, angle, k) in springs {
        let mut row = [0.0; 4];
        let d = [angle.cos(), angle.sin()];
        for axis in 0..2 {
            row[2 * a + axis] = d[axis];
            if let Some(b) = b {
                row[2 * b + axis] = -d[axis];
            }
        }
        for i in 0..4 {
            for j in 0..4 {
                stiffness[4 * i + j] += k * row[i] * row[j];
            }
        }
    }
    let mut mass = vec![0.0; 16];
    for (row, value) in [1.0, 1.0, 2.0, 2.0].into_iter().enumerate() {
        mass[5 * row] = value;
    }
    let mut damping = vec![0.0; 16];
    damping[0] = 3.0;
    SuperelementMatrices::new(
        freedoms(&[(7, 1), (7, 2), (12, 1), (12, 2)]),
        mass,
        stiffness,
        damping,
    )
    .unwrap()
}

const COMMON: &str = "
integrator = { method = \"event-driven\", step = 1e-3 }
slider = { velocity = 0.2, angle = 0.25 }
friction = { coefficient = 0.45 }
effects = { sticking = true, detachment = true }
damping = { alpha = 1.0, beta = 1e-5 }
mass = [{ name = \"c\", mass = 0.5, angle = 0.4, force = [3.0, -20.0] }]
";

fn as_superelement() -> Scene {
    let text = "
[[superelement]]
name = \"s\"
file = \"s.superelement\"
[[spring]]
name = \"cs\"
between = [\"c\", \"s.7\"]
direction = 0.9
stiffness = 6e4
preload = 1e-4
[[spring]]
name = \"cg\"
between = [\"c\", \"ground\"]
direction = [1.0, -2.0, 0.0]
stiffness = 5e4
[[damper]]
name = \"d\"
between = [\"s.12\", \"c\"]
direction = \"x\"
damping = 2.0
[[contact]]
name = \"low\"
mass = \"s.12\"
[[contact]]
name = \"side\"
mass = \"s.7\"
normal = [0.0, 3.0, 0.0]
tangent = [2.0, 0.0, 0.0]
[[load]]
superelement = \"s\"
nodes = [7, 12]
force = [2.0, -30.0, 0.0]
[[initial]]
node = \"s.12\"
vx = 0.05
[[outputs.nodes]]
";
    let text = text.replace("[[outputs.nodes]]\n", "[outputs]\nnodes = [\"s.7\"]\n");
    scene_in("pair", &[("s", two_nodes())], &format!("{COMMON}{text}")).unwrap()
}

fn as_masses() -> Scene {
    let text = "
[[mass]]
name = \"a\"
mass = 1.0
force = [2.0, -30.0]
[[mass]]
name = \"b\"
mass = 2.0
force = [2.0, -30.0]
[[spring]]
name = \"ab\"
between = [\"a\", \"b\"]
direction = 0.3
stiffness = 4e4
[[spring]]
name = \"ag\"
between = [\"a\", \"ground\"]
direction = 1.1
stiffness = 3e4
[[spring]]
name = \"bx\"
between = [\"b\", \"ground\"]
direction = \"x\"
stiffness = 2e4
[[spring]]
name = \"by\"
between = [\"b\", \"ground\"]
direction = \"y\"
stiffness = 5e4
[[damper]]
name = \"ax\"
between = [\"a\", \"ground\"]
direction = \"x\"
damping = 3.0
[[spring]]
name = \"cs\"
between = [\"c\", \"a\"]
direction = 0.9
stiffness = 6e4
preload = 1e-4
[[spring]]
name = \"cg\"
between = [\"c\", \"ground\"]
direction = -1.1071487177940904
stiffness = 5e4
[[damper]]
name = \"d\"
between = [\"b\", \"c\"]
direction = \"x\"
damping = 2.0
[[contact]]
name = \"low\"
mass = \"b\"
[[contact]]
name = \"side\"
mass = \"a\"
angle = 0.0
[[initial]]
mass = \"b\"
vx = 0.05
";
    let text = text.replace("[[mass]]\nname = \"a\"\nmass = 1.0\nforce = [2.0, -30.0]\n[[mass]]\nname = \"b\"\nmass = 2.0\nforce = [2.0, -30.0]\n", "");
    let common = COMMON.replace(
        "-20.0] }]",
        "-20.0] },\n{ name = \"a\", mass = 1.0, force = [2.0, -30.0] },\n{ name = \"b\", mass = 2.0, force = [2.0, -30.0] }]",
    );
    amontons::scene::parse("masses", &format!("{common}{text}")).unwrap()
}

#[test]
fn a_superelement_moves_as_its_masses_and_springs_do() {
    for (method, step, tolerance) in
        [(Method::EventDriven, 1e-3, 1e-9), (Method::ForwardIncrement, 1e-5, 1e-9)]
    {
        let [mut one, mut other] = [as_superelement(), as_masses()]
            .map(|scene| Simulation::new(scene.with_integrator(method, step), 0.0).unwrap());
        let mut most = 0.0_f64;
        for instant in 1..=40 {
            let time = f64::from(instant) * 2e-3;
            one.advance_to(time).unwrap();
            other.advance_to(time).unwrap();
            assert_eq!(one.contact_states(), other.contact_states(), "{method:?} at {time} s");
            for (a, b) in one.displacement().iter().zip(other.displacement()) {
                most = most.max(b.abs());
                assert!((a - b).abs() <= tolerance * most, "{method:?} at {time} s: {a} and {b}");
            }
        }
        assert!(most > 1e-5, "they move by {most} m");
    }
}

#[test]
fn a_superelement_has_the_eigenvalues_of_its_masses_and_springs() {
    let spectrum = |scene: &Scene| {
        let model = LumpedModel::from(scene);
        let states = [ContactState::Slide, ContactState::Stick];
        let reduced = model.linear().unwrap().reduced(&states).unwrap();
        let inverse = reduced.mass.clone().try_inverse().unwrap();
        // The sum and the product of the eigenvalues of M⁻¹K and M⁻¹C stand for all of them.
        let (k, c) = (&inverse * &reduced.stiffness, &inverse * &reduced.damping);
        [k.trace(), k.determinant(), c.trace(), (&k * &c).trace(), (&k * &k).trace()]
    };
    let (one, other) = (spectrum(&as_superelement()), spectrum(&as_masses()));
    for (a, b) in one.iter().zip(other) {
        assert!((a - b).abs() <= 1e-11 * b.abs(), "{one:?} and {other:?}");
    }
}

/// A bar of two nodes along z, mass m and stiffness k: lumped masses m/2, free at ω = 2 √(k/m).
fn bar(mass: f64, stiffness: f64) -> SuperelementMatrices {
    let m = 0.5 * mass;
    let k = stiffness;
    SuperelementMatrices::new(
        freedoms(&[(1, 3), (2, 3)]),
        vec![m, 0.0, 0.0, m],
        vec![k, -k, -k, k],
        Vec::new(),
    )
    .unwrap()
}

#[test]
fn a_free_bar_vibrates_along_z_at_its_frequency() {
    let text = "
integrator = { method = \"event-driven\", step = 1e-3 }
superelement = [{ name = \"bar\", file = \"bar.superelement\" }]
spring = [{ name = \"soft\", between = [\"bar.1\", \"ground\"], direction = \"z\", stiffness = 1e-3 }]
initial = [{ node = \"bar.1\", z = 1e-3 }, { node = \"bar.2\", z = -1e-3 }]
";
    let scene = scene_in("bar", &[("bar", bar(2.0, 5e5))], text).unwrap();
    assert_eq!(scene.dof_names(), ["superelement.bar.node[1].z", "superelement.bar.node[2].z"]);
    let mut simulation = Simulation::new(scene, 0.0).unwrap();
    // Half a period of ω = 2 √(k/m) = 1000 rad/s.
    simulation.advance_to(PI / 1000.0).unwrap();
    for (moved, expected) in simulation.displacement().iter().zip([-1e-3, 1e-3]) {
        assert!((moved - expected).abs() < 1e-10, "{moved}");
    }
}

/// One node that moves along x and z, 1 kg, on springs along both.
fn post(stiffness: f64) -> SuperelementMatrices {
    let k = stiffness;
    let (mass, stiffness) = (vec![1.0, 0.0, 0.0, 1.0], vec![k, 0.0, 0.0, k]);
    SuperelementMatrices::new(freedoms(&[(1, 1), (1, 3)]), mass, stiffness, Vec::new()).unwrap()
}

#[test]
fn a_pressure_presses_a_post_on_another_across_a_gap() {
    let text = "
integrator = { method = \"event-driven\", step = 1e-3 }
slider = { velocity = 0.1, angle = 0.0 }
friction = { coefficient = 0.2 }
superelement = [{ name = \"a\", file = \"a.superelement\" }, { name = \"b\", file = \"b.superelement\" }]
contact_set = [{ name = \"face\", superelement = \"a\", on = \"b\", pairs = \"pairs.csv\" }]
load = [{ superelement = \"a\", pressure = 1e5, areas = \"areas.csv\" }]
";
    let matrices = [("a", post(1e5)), ("b", post(3e5))];
    let normal_force = |gap: &str| {
        let pairs = format!("node,on,nx,ny,nz,tx,ty,tz,gap\n1,1,0,0,2,1,0,0,{gap}\n");
        let tables = [("pairs.csv", &*pairs), ("areas.csv", "node,area,nx,ny,nz\n1,4e-4,0,0,1\n")];
        let scene = scene_beside("pressed", &matrices, &tables, text).unwrap();
        assert_eq!(scene.contact_name(0), "contact.face_1");
        let model = LumpedModel::from(&scene);
        assembly::equilibrium(&scene, &model).unwrap().normal_force[0]
    };
    // 40 N on two springs side by side, after the first has closed the gap.
    assert!((normal_force("") - 30.0).abs() < 1e-9, "{}", normal_force(""));
    assert!((normal_force("1e-4") - 22.5).abs() < 1e-9, "{}", normal_force("1e-4"));
    // One normal for all nodes in place of those in the file.
    let flat = [
        ("pairs.csv", "node,on,nx,ny,nz,tx,ty,tz\n1,1,0,0,1,1,0,0\n"),
        ("areas.csv", "node,area\n1,4e-4\n"),
    ];
    let with_normal = text.replace("areas.csv\"", "areas.csv\", normal = [0, 0, 2]");
    let scene = scene_beside("flat", &matrices, &flat, &with_normal).unwrap();
    let found = assembly::equilibrium(&scene, &LumpedModel::from(&scene)).unwrap();
    assert!((found.normal_force[0] - 30.0).abs() < 1e-9, "{found:?}");
    // The posts have no motion along y, across the sliding.
    let tables = [
        ("pairs.csv", "node,on,nx,ny,nz,tx,ty,tz\n1,1,0,0,1,1,0,0\n"),
        ("areas.csv", "node,area,nx,ny,nz\n1,4e-4,0,0,1\n"),
    ];
    let text = text.replace("0.2 }", "0.2, transverse_damping = true }");
    let message = scene_beside("across", &matrices, &tables, &text).unwrap_err();
    assert!(message.contains("no contact has a motion across its sliding"), "{message}");
}

#[test]
fn wrong_scenes_with_superelements_say_what_would_be_right() {
    let start = "
integrator = { method = \"event-driven\", step = 1e-3 }
slider = { velocity = 0.1, angle = 0.0 }
friction = { coefficient = 0.3 }
superelement = [{ name = \"s\", file = \"s.superelement\" }]
";
    let contact = |keys: &str| format!("contact = [{{ name = \"k\", mass = \"s.7\", {keys} }}]");
    let set =
        |keys: &str| format!("contact_set = [{{ name = \"f\", superelement = \"s\", {keys} }}]");
    let load = |keys: &str| format!("load = [{{ superelement = \"s\", {keys} }}]");
    let cases = [
        (
            load("nodes = [7], pressure = 1e5, area = -1e-4, normal = [0.0, 1.0, 0.0]"),
            vec!["load[1].area", "must be above zero"],
        ),
        (
            load("nodes = [7], pressure = 1e5, area = nan, normal = [0.0, 1.0, 0.0]"),
            vec!["load[1].area", "must be a finite number"],
        ),
        (load("nodes = [], force = [0.0, 1.0, 0.0]"), vec!["load[1].nodes", "names no nodes"]),
        (
            load("nodes = [7, 12, 7], force = [0.0, 1.0, 0.0]"),
            vec!["load[1].nodes[3]", "node 7 stands a second time"],
        ),
        (set("nodes = []"), vec!["contact_set[1].nodes", "names no nodes"]),
        (
            "mass = [{ name = \"s\", mass = 1.0 }]".to_owned(),
            vec!["superelement[1].name", "is the name of a mass too"],
        ),
        (
            "contact = [{ name = \"k\", mass = \"s.8\" }]".to_owned(),
            vec!["contact[1].mass", "no such node", "it has nodes 7, 12", "--retain"],
        ),
        (
            "contact = [{ name = \"k\", mass = \"t.8\" }]".to_owned(),
            vec!["there is no superelement of this name"],
        ),
        (
            "contact = [{ name = \"k\", mass = \"s\" }]".to_owned(),
            vec!["name one of its nodes", "it has nodes 7, 12"],
        ),
        (
            contact("normal = [0.0, 0.0, 0.0], tangent = [1.0, 0.0, 0.0]"),
            vec!["contact[1].normal", "has no length"],
        ),
        (contact("normal = [0.0, 1.0, 0.0]"), vec!["needs a `tangent` too"]),
        (
            contact("normal = [0.0, 1.0, 0.0], tangent = [1.0, 0.1, 0.0]"),
            vec!["perpendicular", "84.28"],
        ),
        (
            contact("normal = [0.0, 0.0, 1.0], tangent = [1.0, 0.0, 0.0]"),
            vec!["no displacement along z"],
        ),
        (
            contact("angle = 0.1, normal = [0.0, 1.0, 0.0], tangent = [1.0, 0.0, 0.0]"),
            vec!["both an `angle`"],
        ),
        (
            set("nodes = [7, 12, 7]"),
            vec!["f_7 and f_7_2 join the same points along the same normal"],
        ),
        (
            format!("{}\n{}", contact("angle = 0.0"), set("nodes = [7]")),
            vec!["contacts k and f_7 join the same points"],
        ),
        (set("nodes = [9]"), vec!["contact_set[1].nodes[1] = 9", "no such node"]),
        (
            "load = [{ superelement = \"s\", nodes = [7], force = [0.0, 0.0, 1.0] }]".to_owned(),
            vec!["load[1].nodes[1]", "no displacement along z"],
        ),
        (
            "load = [{ superelement = \"s\", nodes = [7], pressure = 1.0 }]".to_owned(),
            vec!["load[1]", "`areas`"],
        ),
        ("outputs = { nodes = [\"s.1\"] }".to_owned(), vec!["outputs.nodes[1]", "no such node"]),
        (
            "outputs = { contacts = [\"f\"] }".to_owned(),
            vec!["outputs.contacts[1]", "no contact or set"],
        ),
        ("outputs = { modes = [\"s.1\"] }".to_owned(), vec!["s has no modal coordinates"]),
        (
            "initial = [{ node = \"s.7\", z = 1.0 }]".to_owned(),
            vec!["initial[1].z = 1", "does not have this degree"],
        ),
    ];
    for (text, words) in cases {
        let error =
            scene_in("wrong", &[("s", two_nodes())], &format!("{start}{text}\n")).unwrap_err();
        for word in words {
            assert!(error.contains(word), "{text}: {error}");
        }
    }
    let unlike = start.replace("{ name = \"s\", file = \"s.superelement\" }", "{ name = \"s\" }");
    let error = scene_in("unlike", &[], &unlike).unwrap_err();
    assert!(error.contains("needs exactly one of `folder`, `file`"), "{error}");
}

/// Each mistake in a file of pairs is told with the file and the line, and alone: contacts that are missing for it are not
/// reported where `[outputs]` names them.
#[test]
fn a_mistake_in_pairs_is_told_once_with_its_file_and_line() {
    let start = "
integrator = { method = \"event-driven\", step = 1e-3 }
slider = { velocity = 0.1, angle = 0.3 }
friction = { coefficient = 0.3 }
superelement = [{ name = \"s\", file = \"s.superelement\" }, { name = \"t\", file = \"s.superelement\" }]
outputs = { contacts = [\"face_7\"] }
";
    let head = "node,on,nx,ny,nz,tx,ty,tz";
    let line = "line 3";
    let cases = [
        ("t", "12,12,0,1,0,1,0,0\n7,7,0,0,0,1,0,0", [line, "the normal has no length"]),
        ("t", "12,12,0,1,0,1,0,0\n7,7,0,1,0,0,0,0", [line, "the tangent has no length"]),
        ("t", "12,12,0,1,0,1,0,0\n7,7,0,1,0,1,0.1,0", [line, "have an angle of 84.2894°"]),
        (
            "t",
            "12,12,0,1,0,1,0,0\n7,8,0,1,0,1,0,0",
            [line, "8: there is no such node in the superelement t"],
        ),
        (
            "t",
            "7,12,0,1,0,1,0,0\n7,12,0,2,0,-1,0,0",
            [line, "the same points along the same normal as line 2"],
        ),
        ("t", "7,12,,,,,,\n7,12,,,,,,", [line, "the same normal as line 2"]),
        (
            "",
            "12,12,0,1,0,1,0,0\n7,7,0,1,0,1,0,0",
            ["line 2, column `on`: `12`", "`on` of the contact set is missing; write `on = \"t\"`"],
        ),
    ];
    for (on, rows, words) in cases {
        let on = if on.is_empty() { String::new() } else { format!("on = \"{on}\", ") };
        let set = format!(
            "contact_set = [{{ name = \"face\", superelement = \"s\", {on}pairs = \"p.csv\" }}]\n"
        );
        let tables = [("p.csv", &*format!("{head}\n{rows}\n"))];
        let matrices = [("s", two_nodes())];
        let error =
            scene_beside("pairs", &matrices, &tables, &format!("{start}{set}")).unwrap_err();
        assert!(error.contains("contact_set[1].pairs = \"p.csv\": "), "{rows}: {error}");
        assert!(words.iter().all(|word| error.contains(word)), "{rows}: {error}");
        assert!(!error.contains("face_7"), "{rows}: {error}");
    }
    // Two normals at one point, as in a corner, are two contacts.
    let set = "contact_set = [{ name = \"face\", superelement = \"s\", on = \"t\", pairs = \"p.csv\" }]\n";
    let rows = format!("{head}\n7,12,0,1,0,1,0,0\n7,12,1,0,0,0,1,0\n");
    let tables = [("p.csv", &*rows)];
    let scene = scene_beside("corner", &[("s", two_nodes())], &tables, &format!("{start}{set}"));
    assert_eq!(scene.map(|scene| scene.contact_count()), Ok(2));
}

#[test]
fn packed_matrices_read_back_to_the_last_bit_and_damage_is_seen() {
    let mut stiffness = two_nodes().stiffness().to_vec();
    stiffness[1] += 17.0;
    let circulatory = SuperelementMatrices::new(
        two_nodes().freedoms().to_vec(),
        two_nodes().mass().to_vec(),
        stiffness,
        Vec::new(),
    )
    .unwrap();
    assert!(two_nodes().is_conservative() && !circulatory.is_conservative());
    for matrices in [two_nodes(), circulatory, bar(0.1, 0.2)] {
        let bytes = matrices.to_bytes();
        assert_eq!(SuperelementMatrices::from_bytes(&bytes).as_ref(), Ok(&matrices));
        for place in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[place] ^= 0x10;
            SuperelementMatrices::from_bytes(&damaged).unwrap_err();
            SuperelementMatrices::from_bytes(&bytes[..place]).unwrap_err();
        }
    }
}

#[test]
fn matrices_that_are_no_structure_are_refused() {
    let made = |mass: &[f64], stiffness: &[f64], nodes: &[(u64, u8)]| {
        let made = SuperelementMatrices::new(
            freedoms(nodes),
            mass.to_vec(),
            stiffness.to_vec(),
            Vec::new(),
        );
        made.unwrap_err().iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
    };
    let nodes = [(1, 1), (2, 1)];
    let one = [1.0, 0.0, 0.0, 1.0];
    for (error, words) in [
        (made(&[1.0, 2.0, 2.0, 1.0], &one, &nodes), "mass: must be positive definite"),
        (
            made(&[1.0, 0.1, 0.2, 1.0], &one, &nodes),
            "row 2, column 1 is 2e-1 and row 1, column 2 is 1e-1",
        ),
        (
            made(&one, &[1.0, f64::NAN, 0.0, 1.0], &nodes),
            "stiffness = NaN: row 1, column 2 must be a finite number",
        ),
        (made(&one, &[1.0; 9], &nodes), "stiffness: has 9 values, but 2 degrees of freedom need 4"),
        (made(&one, &one, &[(1, 1), (1, 1)]), "rows 1 and 2 are both direction 1 of node 1"),
        (made(&one, &one, &[(1, 1), (1, 7)]), "row 2 is direction 7 of node 1"),
        (made(&[], &[], &[]), "there is no degree of freedom"),
    ] {
        assert!(error.contains(words), "{error}");
    }
}

/// Three nodes of 0.1 kg in a row, along x and y, on springs of 5e6 N/m and 1e6 N/m.
fn beam() -> SuperelementMatrices {
    let mut stiffness = vec![0.0; 36];
    for (left, right) in [(0, 1), (1, 2)] {
        for (axis, k) in [(0, 5e6), (1, 1e6)] {
            let [a, b] = [left, right].map(|node| 2 * node + axis);
            for (i, j, sign) in [(a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)] {
                stiffness[6 * i + j] += sign * k;
            }
        }
    }
    let mass = (0..36).map(|at| if at % 7 == 0 { 0.1 } else { 0.0 }).collect();
    let rows = [(1, 1), (1, 2), (2, 1), (2, 2), (3, 1), (3, 2)];
    SuperelementMatrices::new(freedoms(&rows), mass, stiffness, Vec::new()).unwrap()
}

#[test]
fn the_fmu_shows_the_nodes_and_contacts_that_are_chosen_and_no_others() {
    let page = include_str!("../../docs/scenes/superelements.md");
    let text = page.split("```toml").nth(1).unwrap().split("```").next().unwrap();
    let is_of_files = |line: &&str| {
        !["stiffness = \"", "mass = \"", "freedoms", "damping_ratio"]
            .iter()
            .any(|key| line.starts_with(key))
    };
    let text: Vec<&str> = text.lines().filter(is_of_files).collect();
    let text =
        text.join("\n").replace("name = \"beam\"", "name = \"beam\"\nfile = \"beam.superelement\"");
    let scene = scene_in("shown", &[("beam", beam())], &text).unwrap();
    let names = |scene: &Scene| -> Vec<String> {
        let all = variables(scene).into_iter().map(|variable| variable.name);
        all.filter(|name| name.contains("beam") || name.contains("lining")).collect()
    };
    let node =
        ["fx", "fy", "x", "y", "vx", "vy"].map(|key| format!("superelement.beam.node[2].{key}"));
    let contacts = ["1", "3"].into_iter().flat_map(|node| {
        let keys = ["state", "normal_force", "friction_force", "slip_velocity"];
        keys.map(|key| format!("contact.lining_{node}.{key}"))
    });
    let start =
        ["x", "y", "vx", "vy"].map(|key| format!("initial.superelement.beam.node[2].{key}"));
    let expected: Vec<String> = node.into_iter().chain(contacts).chain(start).collect();
    assert_eq!(names(&scene), expected);
    let hidden = text.replace("contacts = [\"lining\"]", "contacts = []");
    let hidden = scene_in("hidden", &[("beam", beam())], &hidden).unwrap();
    assert!(!names(&hidden).iter().any(|name| name.contains("lining")));
    let why = hidden.explain_missing("contact.lining_1.state").unwrap();
    assert_eq!(why.reason, "the scene does not show contact lining_1");
    // A variable of a node reads and moves its own degree of freedom.
    let mut simulation = Simulation::new(scene, 0.0).unwrap();
    let all = variables(simulation.scene());
    let find = |name: &str| all.iter().find(|variable| variable.name == name).unwrap();
    assert_eq!(simulation.read(find("superelement.beam.node[2].vx")).unwrap(), 0.01);
    simulation.write(find("superelement.beam.node[2].fy"), 10.0).unwrap();
    simulation.advance_to(1e-4).unwrap();
    let y = find("superelement.beam.node[2].y");
    assert_eq!(simulation.read(y).unwrap(), simulation.displacement()[3]);
    // ½ (F/m) t² but for the springs, of which two of 1e6 N/m and one of 1e5 N/m hold the node.
    let free = 0.5 * 10.0 / 0.1 * 1e-8;
    let moved = simulation.read(y).unwrap();
    assert!(moved > 0.97 * free && moved < free, "{moved} of {free}");
}
