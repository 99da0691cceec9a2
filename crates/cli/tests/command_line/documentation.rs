//! Tests of the documentation of every FMU: its page, its icon, and the reference run beside it.

use crate::program::{assert_refused, folder, run, text};
use amontons::scene::{BUILTIN, Scene, builtin, parse};
use amontons::simulation::catalogue::fmu_variables;
use amontons_analysis::watch::Watch;
use amontons_export::documentation::{cross_check, reference_run};
use amontons_pictures::picture::Structure;
use std::fs;
use std::io::{Cursor, Read};
use std::ops::ControlFlow::{Break, Continue};
use std::path::Path;
use std::sync::atomic::{AtomicU32, Ordering};

const PROGRAM: &str = env!("CARGO_BIN_EXE_amontons");

/// The files in an FMU.
struct Fmu(zip::ZipArchive<Cursor<Vec<u8>>>);

impl Fmu {
    fn bytes(&mut self, name: &str) -> Vec<u8> {
        let mut content = Vec::new();
        self.0.by_name(name).unwrap().read_to_end(&mut content).unwrap();
        content
    }

    fn text(&mut self, name: &str) -> String {
        String::from_utf8(self.bytes(name)).unwrap()
    }

    fn page(&mut self) -> String {
        self.text("documentation/index.html")
    }

    fn has(&self, name: &str) -> bool {
        self.0.file_names().any(|found| found.unwrap() == name)
    }
}

/// Exports a scene, a file or a built-in one, into a folder.
fn export(folder: &Path, scene: &str, arguments: &[&str]) -> Fmu {
    amontons(folder, &[&["export", scene, "-o", "made.fmu"], arguments].concat());
    let bytes = fs::read(folder.join("made.fmu")).unwrap();
    Fmu(zip::ZipArchive::new(Cursor::new(bytes)).unwrap())
}

fn amontons(folder: &Path, arguments: &[&str]) -> String {
    let output = run(PROGRAM, folder, arguments);
    assert!(output.status.success(), "{arguments:?}\n{}", text(&output.stderr));
    text(&output.stdout)
}

/// The documentation of a scene's text.
fn page_of(scene: &str) -> String {
    let folder = folder();
    fs::write(folder.path().join("mine.toml"), scene).unwrap();
    export(folder.path(), "mine.toml", &[]).page()
}

/// Texts of the cells of a table, row by row.
fn cells(page: &str, table: &str) -> Vec<Vec<String>> {
    let start =
        page.find(&format!("<caption id=\"{table}\">")).unwrap_or_else(|| panic!("{table}"));
    let body = &page[start..];
    let body = &body[body.find("<tbody>").unwrap()..body.find("</tbody>").unwrap()];
    let row = |line: &str| {
        let parts = line
            .split(['<', '>'])
            .skip(1)
            .step_by(2)
            .zip(line.split(['<', '>']).skip(2).step_by(2));
        let cell = |tag: &str| tag.starts_with("th ") || tag == "td";
        parts.filter(|(tag, _)| cell(tag)).map(|(_, text)| unescaped(text)).collect()
    };
    body.lines().filter(|line| line.starts_with("<tr>")).map(row).collect()
}

fn unescaped(text: &str) -> String {
    let plain = text.replace("&lt;", "<").replace("&gt;", ">").replace("&quot;", "\"");
    plain.replace("&apos;", "'").replace("&amp;", "&")
}

const FREE: &str = r#"
description = "a <mass> & a spring"
[[mass]]
name = "a"
mass = 0.5
locked = ["y"]
[[spring]]
name = "k"
between = ["a", "ground"]
direction = "x"
stiffness = 200.0
[[initial]]
mass = "a"
vx = 0.1
[integrator]
step = 1e-4
"#;

/// A foot that is pressed on a surface which moves under it without friction.
const GUIDED: &str = r#"
[slider]
velocity = 0.1
angle = 0.0
[friction]
law = "none"
[[mass]]
name = "a"
mass = 0.5
force = [0.0, -5.0]
[[spring]]
name = "k"
between = ["a", "ground"]
direction = "x"
stiffness = 200.0
[[contact]]
name = "foot"
mass = "a"
[integrator]
step = 1e-4
"#;

#[test]
fn every_fmu_has_a_page_that_needs_nothing_else_and_an_icon() {
    let folder = folder();
    for builtin in BUILTIN {
        let mut fmu = export(folder.path(), builtin.name, &[]);
        let page = fmu.page();
        assert!(page.len() < 400_000, "{}: {} bytes", builtin.name, page.len());
        assert!(!page.contains("<script") && !page.contains(" src="), "{}", builtin.name);
        for link in page.split("href=\"").skip(1).map(|rest| rest.split_once('"').unwrap().0) {
            let known = match link.strip_prefix('#') {
                Some(id) => page.contains(&format!("id=\"{id}\"")),
                None => link == "data:," || fmu.has(&format!("documentation/{link}")),
            };
            assert!(known, "{}: {link} leads nowhere", builtin.name);
        }
        // Pictures: the structure, the locus where there is friction, the run.
        let scene = builtin.scene();
        let drawn = Structure::from(&scene).svg().unwrap();
        let description = drawn.split_once("<desc>").unwrap().1.split_once("</desc>").unwrap().0;
        assert!(page.contains(description), "{} is not drawn", builtin.name);
        assert!(page.contains("id=\"run-figure\""), "{}", builtin.name);
        let icon = fmu.bytes("model.png");
        let mut decoder = png::Decoder::new(Cursor::new(&icon)).read_info().unwrap();
        let info = decoder.info();
        assert_eq!((info.width, info.height), (450, 450));
        let mut pixels = vec![0; decoder.output_buffer_size().unwrap()];
        decoder.next_frame(&mut pixels).unwrap();
        let inked = pixels.chunks(3).filter(|pixel| *pixel != [255; 3]).count();
        assert!((2_000..120_000).contains(&inked), "{}: {inked} pixels", builtin.name);
        assert!(icon.len() < 60_000, "{}: {} bytes", builtin.name, icon.len());
    }
}

#[test]
fn every_variable_is_in_the_page_with_what_the_model_description_says() {
    let folder = folder();
    for name in ["set1", "ring12", "disc_brake"] {
        let mut fmu = export(folder.path(), name, &[]);
        let (page, description) = (fmu.page(), fmu.text("modelDescription.xml"));
        let rows = cells(&page, "all-variables");
        let variables = fmu_variables(&builtin(name).unwrap().scene());
        assert_eq!(rows.len(), variables.len());
        for (place, (row, variable)) in rows.iter().zip(&variables).enumerate() {
            let [name, reference, causality, unit, when, start, least, words] = &row[..] else {
                panic!("{row:?}")
            };
            assert_eq!((name, reference), (&variable.name, &place.to_string()));
            let says = |key: &str, value: &str| match value {
                "" | "integer" | "Boolean" => String::new(),
                _ => format!(" {key}=\"{value}\""),
            };
            let start_tag = format!("<ScalarVariable name=\"{name}\" ");
            let xml = description.split_once(&*start_tag).unwrap().1;
            let xml = unescaped(xml.split_once("</ScalarVariable>").unwrap().0);
            let kind = if xml.contains("<Enumeration") { "declaredType" } else { "unit" };
            for (key, value) in [
                ("causality", causality),
                ("variability", when),
                (kind, unit),
                ("start", start),
                ("min", least),
                ("description", words),
            ] {
                let said = says(key, value);
                assert!(format!(" {xml}").contains(&said), "{name}: {said} is not in {xml}");
                assert_eq!(said.is_empty(), !xml.contains(&format!("{key}=\"")), "{name}: {key}");
            }
        }
        // By kind each is there too: as many as the captions say.
        let counted: usize = ["inputs", "parameters", "outputs"]
            .iter()
            .map(|table| {
                let caption =
                    page.split_once(&format!("<caption id=\"{table}\"><span>")).unwrap().1;
                let count = caption.split_once(": ").unwrap().1.split_once('<').unwrap().0;
                count.parse::<usize>().unwrap()
            })
            .sum();
        assert_eq!(counted, variables.len());
    }
    let rows = cells(&export(folder.path(), "ring12", &[]).page(), "outputs");
    assert!(rows.len() < 30, "twelve modules are read at once");
    assert!(rows.iter().any(|row| row[0] == "module[1 … 12].x1"), "{rows:?}");
}

#[test]
fn the_values_of_the_reference_run_are_the_doubles_of_the_program() {
    let folder = folder();
    for scene in ["set1", "disc_brake", "stick_slip", "den_hartog"] {
        let page = export(folder.path(), scene, &[]).page();
        let csv = amontons(folder.path(), &["simulate", scene]);
        let mut lines = csv.lines();
        let names: Vec<&str> = lines.next().unwrap().split(',').collect();
        let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
        let head = page.split_once("<caption id=\"run-values\">").unwrap().1;
        let head = head.split_once("</thead>").unwrap().0;
        let columns: Vec<&str> = head
            .split("<th scope=\"col\">")
            .skip(1)
            .map(|rest| rest.split([' ', '<']).next().unwrap())
            .collect();
        let places: Vec<usize> = columns
            .iter()
            .map(|column| names.iter().position(|name| name == column).unwrap())
            .collect();
        assert!(places.len() >= 3, "{columns:?}");
        let shown = cells(&page, "run-values");
        assert_eq!(shown.len(), 9);
        for cells in &shown {
            let row = rows.iter().find(|row| row[0] == cells[0]);
            let row = row.unwrap_or_else(|| panic!("{scene} has no row at {}", cells[0]));
            for (cell, place) in cells.iter().zip(&places) {
                assert_eq!(cell, row[*place], "{scene}: {} at {}", names[*place], cells[0]);
            }
        }
        let last = [&shown[0][0], &shown[8][0]];
        assert_eq!(last, [rows[0][0], rows[rows.len() - 1][0]], "{scene}: the whole run");
    }
}

/// Values of µ and the frequencies there are the paper's (`docs/tutorials/squeal.md`), and those of closed forms that
/// `scenes/README.md` derives: Hoffmann's µ, and 3 − √6, where modes of the disc brake merge.
#[test]
fn the_page_says_whether_a_scene_squeals_and_from_which_friction_on() {
    let folder = folder();
    let page = |scene: &str| export(folder.path(), scene, &[]).page();
    let has = |page: &str, words: &[&str]| {
        words.iter().for_each(|word| assert!(page.contains(word), "{word} is not in the page"));
    };
    for (scene, verdict, friction, hertz) in [
        ("set1", "Yes, it squeals", "1.18361", 220.0),
        ("set2", "Small disturbances of this state decay", "2.06257", 172.0),
    ] {
        let page = page(scene);
        has(&page, &[verdict, "both contacts slide (state Sl-Sl)", "mode 6\n", "this scene\n"]);
        let begins = page.split_once(&format!("µ = {friction} (begins at ")).unwrap().1;
        let frequency: f64 = begins.split_once(" Hz").unwrap().0.parse().unwrap();
        assert_eq!(frequency.round(), hertz, "{scene}");
    }
    has(&page("hoffmann"), &["Yes, it squeals", "the contact slides", "µ = 0.2559"]);
    let merging = format!("1–3: {:.5}", 3.0 - 6.0_f64.sqrt());
    has(&page("disc_brake"), &["Yes, it squeals", "(state Sl-R-Sl)", &merging]);
    has(
        &page("den_hartog"),
        &["the surface under the contact stands still", "not all contacts slide"],
    );
    has(&page("belt"), &["the contact slides", "no mode grows"]);
    has(&page("corner"), &["no degree of freedom can move"]);
}

/// The connections that `examples/coupled.rs` makes; the velocity of its drive is relative to a nut that moves, so the
/// slip of the drive is the velocity that a slider takes.
#[test]
fn the_page_says_what_to_couple_and_what_contact_states_mean() {
    let folder = folder();
    let page = |scene: &str| unescaped(&export(folder.path(), scene, &[]).page());
    let set1 = page("set1");
    assert!(set1.contains("a drive gives slider.velocity and takes slider.tangential_reaction. "));
    assert!(set1.contains(
        "ContactState: 1 Sl (sliding: the slider overtakes the mass), \
         2 R-Sl (reverse sliding: the mass overtakes the slider), \
         3 St (sticking: the mass moves with the slider), 4 Dt (detached)."
    ));
    // 2 µN with µ = 0.6 and N = 2500 N: each pad's strut, which turns a fifth of µN back, presses 2000 N that much
    // more on. Both linings brake the one disc.
    let disc = page("disc_brake");
    assert!(
        disc.contains(
            "a drive gives contact.upper_lining.velocity = v and contact.lower_lining.velocity = −v, and takes \
             −contact.upper_lining.friction_force + contact.lower_lining.friction_force. In the equilibrium this force \
             is −3000.0 N, against its velocity. "
        ),
        "{disc}"
    );
    assert!(disc.contains(
        "contact.upper_lining.velocity (now 0.05) with contact.lower_lining.velocity (now -0.05), friction"
    ));
    assert!(disc.contains("Normal forces in the equilibrium</dt>"));
    let hoffmann = page("hoffmann");
    assert!(
        hoffmann.contains("a drive gives slider.velocity and takes slider.tangential_reaction. ")
    );
    let drive = page("drive");
    assert!(drive.contains(
        "another FMU gives mass.table.fx and takes contact.guide.slip_velocity. While contacts slide"
    ));
}

/// Three blocks of 100 N each on one plate, two on its upper side and one under it, at µ = 0.2, and one on a plate of its
/// own: what brakes the first plate is three times 20 N.
#[test]
fn contacts_are_summed_by_the_body_that_moves_their_surfaces() {
    let mut text = "[friction]\ncoefficient = 0.2\n[[mass]]\nname = \"plate\"\nmass = 5.0\nlocked = [\"x\"]\n\
        [[spring]]\nname = \"bed\"\nbetween = [\"plate\", \"ground\"]\ndirection = \"y\"\nstiffness = 1e7\n\
        [integrator]\nstep = 1e-6\n[experiment]\nstop_time = 0.01\noutput_interval = 1e-4\n"
        .to_owned();
    for (name, on, force, angle, velocity) in [
        ("one", "on = \"plate\"", -100.0, 0.0, 0.3),
        ("two", "on = \"plate\"", -100.0, 0.0, 0.3),
        ("under", "on = \"plate\"", 100.0, std::f64::consts::PI, -0.3),
        ("alone", "", -100.0, 0.0, -0.3),
    ] {
        text += &format!(
            "[[mass]]\nname = \"{name}\"\nmass = 1.0\nforce = [0.0, {force:?}]\n[[spring]]\nname = \"{name}\"\n\
             between = [\"{name}\", \"ground\"]\ndirection = \"x\"\nstiffness = 1e6\n[[contact]]\n\
             name = \"{name}\"\nmass = \"{name}\"\n{on}\nangle = {angle:?}\nvelocity = {velocity:?}\n"
        );
    }
    let page = unescaped(&page_of(&text));
    for words in [
        "a drive gives contact.one.velocity = v, contact.two.velocity = v and contact.under.velocity = −v, and takes \
         −contact.one.friction_force − contact.two.friction_force + contact.under.friction_force. In the equilibrium \
         this force is −60.000 N, against its velocity. ",
        "Another drive gives contact.alone.velocity and takes −contact.alone.friction_force. In the equilibrium this \
         force is 20.000 N, against its velocity. ",
    ] {
        assert!(page.contains(words), "{words} is not in {page}");
    }
}

#[test]
fn what_makes_no_sense_for_a_scene_is_said_in_a_sentence() {
    let page = page_of(FREE);
    assert!(page.contains("a &lt;mass&gt; &amp; a spring"));
    assert!(page.contains("nothing can squeal") && page.contains("The scene has no friction"));
    // ω = √(200 / 0.5) = 20 rad/s.
    assert!(page.contains("at 3.1831 Hz"), "its frequency");
    assert!(!page.contains("id=\"locus\"") && page.contains("id=\"drawing\""));
    let page = page_of(GUIDED);
    assert!(page.contains("without friction: the scene cannot squeal"), "{page}");
    assert!(page.contains("5 N at contact.foot"));
    // Force times velocity is power: slip counts against the mass's velocity, from a floor that nothing ties it to.
    assert!(page.contains("another FMU gives mass.a.fx and takes mass.a.vx. "));
}

#[test]
fn a_ring_too_large_for_pictures_and_eigenvalues_says_so() {
    let text = builtin("ring12").unwrap().text.replacen("modules = 12", "modules = 70", 1);
    let folder = folder();
    fs::write(folder.path().join("large.toml"), text).unwrap();
    let mut fmu =
        export(folder.path(), "large.toml", &["--integrator", "event-driven", "--step", "1e-3"]);
    let page = fmu.page();
    assert!(page.contains("There is no drawing of this scene") && !fmu.has("model.png"));
    assert!(page.contains("With 280 degrees of freedom"));
    assert!(cells(&page, "all-variables").len() > 1000);
}

fn whole(scene: &Scene) -> amontons_export::documentation::ReferenceRun {
    reference_run(scene, Watch::IDLE).unwrap().unwrap()
}

/// An operation is about a nanosecond: a degree of freedom of a ring takes 2.1 of them a step.
#[test]
fn a_long_experiment_is_run_as_far_as_a_count_goes_and_that_is_said() {
    let set1 = builtin("set1").unwrap().text;
    let over = |stop: &str, interval: &str| {
        let text = set1.replacen("stop_time = 6.0", &format!("stop_time = {stop}"), 1);
        let text =
            text.replacen("output_interval = 2.0e-4", &format!("output_interval = {interval}"), 1);
        whole(&parse("set1", &text).unwrap())
    };
    let long = over("1e5", "2e-3");
    assert!(!long.whole);
    let intervals = (5e8 / (2.1 * 8.0 / 1e-6) / 2e-3_f64).floor();
    assert_eq!(long.rows.len(), intervals as usize + 1);
    assert_eq!(long.rows.last().unwrap().0, intervals * 2e-3);
    // Both runs are equal over their common time.
    let short = over("6.0", "2e-3");
    assert!(short.whole && short.experiment.stop_time == 6.0 && short.rows.len() == 3001);
    assert_eq!(long.rows[..3001], short.rows[..]);
    // Nor are there more rows than an export may hold.
    let fine = over("6.0", "1e-5");
    assert!(!fine.whole && fine.rows.len() == 100_001 && fine.rows[100_000].0 == 1.0);
    // A person may end it.
    let heard = AtomicU32::new(0);
    let progress = |_| {
        heard.fetch_add(1, Ordering::Relaxed);
    };
    let go_on = || if heard.load(Ordering::Relaxed) > 3 { Break(()) } else { Continue(()) };
    let watch = Watch { go_on: &go_on, progress: &progress };
    let ended = reference_run(&builtin("set1").unwrap().scene(), watch);
    assert!(ended.unwrap().is_none() && heard.into_inner() == 4);
}

#[test]
fn a_run_that_fails_is_told_up_to_where_it_came() {
    // A negative µ is impossible; a signal leads there half way.
    let text = builtin("belt").unwrap().text.to_owned()
        + "\n[[signal]]\ninput = \"friction.coefficient\"\npulse = { value = -1.0, start = 1.5 }\n";
    let run = whole(&parse("falling", &text).unwrap());
    assert!(run.failure.is_some());
    let last = run.rows.last().unwrap().0;
    assert!((1.4..=1.5).contains(&last), "{last}");
    let page = page_of(&text);
    assert!(page.contains("The run ends at 1."), "it is said");
}

#[test]
fn the_files_of_a_cross_check_keep_its_rules() {
    let folder = folder();
    for scene in ["set1", "ring12", "den_hartog"] {
        export(folder.path(), scene, &["--with-reference"]);
        let read =
            |end: &str| fs::read_to_string(folder.path().join(format!("made{end}"))).unwrap();
        let (reference, options, inputs) = (read("_ref.csv"), read("_ref.opt"), read("_in.csv"));
        assert!(reference.len() <= 1_000_000, "{scene}: {} bytes", reference.len());
        let option = |name: &str| -> f64 {
            let line = options.lines().find_map(|line| line.strip_prefix(&format!("{name}, ")));
            line.unwrap_or_else(|| panic!("{name} in {options}")).parse().unwrap()
        };
        let built = builtin(scene).unwrap().scene();
        assert_eq!(option("StartTime"), 0.0);
        assert_eq!(option("StopTime"), built.experiment.stop_time);
        let ratio = option("StepSize") / built.experiment.output_interval;
        assert!(ratio >= 1.0 && (ratio - ratio.round()).abs() < 1e-9, "{scene}: {ratio}");
        assert!(option("RelTol") > 0.0);
        for (csv, causality) in [(&reference, "output"), (&inputs, "input")] {
            let mut lines = csv.lines();
            let head = lines.next().unwrap();
            let names: Vec<&str> = head.split(',').map(|name| name.trim_matches('"')).collect();
            assert_eq!(head, format!("\"{}\"", names.join("\",\"")));
            assert_eq!(names[0], "time");
            let times: Vec<f64> =
                lines.map(|line| line.split(',').next().unwrap().parse().unwrap()).collect();
            assert!(times.is_sorted() && times[0] == 0.0);
            // One row of inputs is held; outputs go from the start to the end.
            let end = if causality == "input" { 0.0 } else { option("StopTime") };
            assert_eq!(times[times.len() - 1], end);
            let known = fmu_variables(&built);
            let of =
                known.iter().filter(|v| format!("{:?}", v.causality).to_lowercase() == causality);
            assert!(of.map(|v| &*v.name).eq(names[1..].iter().copied()), "{scene}: {causality}");
        }
    }
    // Whoever cannot have the one does not get the others.
    let output =
        run(PROGRAM, folder.path(), &["export", "set1", "--with-reference", "-o", "no/a.fmu"]);
    assert_refused(&output, 1, &["there is no folder no"]);
    // Without inputs there is nothing to give.
    let text = format!("{FREE}[inputs]\nforces = \"none\"\n");
    let none = cross_check(&parse("free", &text).unwrap(), Watch::IDLE);
    assert_eq!(none.unwrap().unwrap().inputs, None);
}
