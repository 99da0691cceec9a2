//! Pictures: what their files hold, and what is refused.

use amontons::Error;
use amontons_pictures::picture::{
    Band, Chart, Class, Lane, LaneInterval, Link, LinkKind, Map, Mark, Marker, MassMark, ModeShape,
    ModeShapes, Panel, Raster, Series, SliderMark, Structure, Style,
};
use nalgebra::Complex;
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use std::fs;
use std::path::Path;

/// An element of an SVG: its name, attributes and text.
struct Element {
    name: String,
    attributes: Vec<(String, String)>,
    text: String,
}

impl Element {
    fn new(start: &BytesStart<'_>) -> Self {
        let attributes = start.attributes().map(|attribute| {
            let attribute = attribute.unwrap();
            (attribute.key.as_ref().to_owned(), attribute.value.into_owned())
        });
        let attributes = attributes.collect();
        Self { name: start.name().as_ref().to_owned(), attributes, text: String::new() }
    }

    fn get(&self, key: &str) -> &str {
        let found = self.attributes.iter().find(|(name, _)| name == key);
        found.map_or("", |(_, value)| value)
    }

    fn points(&self) -> usize {
        self.get("points").split_whitespace().count()
    }
}

/// All elements of a well-formed document, in order.
fn elements(path: &Path) -> Vec<Element> {
    let text = fs::read_to_string(path).unwrap();
    let mut reader = Reader::from_str(&text);
    let (mut found, mut open): (Vec<Element>, Vec<usize>) = (Vec::new(), Vec::new());
    loop {
        match reader.read_event().unwrap() {
            Event::Start(start) => {
                open.push(found.len());
                found.push(Element::new(&start));
            }
            Event::Empty(start) => found.push(Element::new(&start)),
            Event::End(_) => {
                open.pop().unwrap();
            }
            Event::Text(part) => {
                if let Some(&place) = open.last() {
                    found[place].text += &part;
                }
            }
            Event::GeneralRef(part) => {
                let place = *open.last().unwrap();
                found[place].text += &format!("&{};", &*part);
            }
            Event::Eof => break,
            _ => {}
        }
    }
    assert!(open.is_empty(), "all elements are closed");
    found.iter_mut().for_each(|element| element.text = element.text.trim().to_owned());
    found
}

fn drawn(write: impl Fn(&Path) -> Result<(), Error>) -> Vec<Element> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("picture.svg");
    write(&path).unwrap();
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is left beside it");
    elements(&path)
}

/// Width and height of a PNG, and its pixels, three bytes each.
type Pixels = (u32, u32, Vec<u8>);

fn decoded(path: &Path) -> Pixels {
    decoded_bytes(&fs::read(path).unwrap())
}

fn decoded_bytes(bytes: &[u8]) -> Pixels {
    let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::EXPAND);
    let mut reader = decoder.read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    assert_eq!(info.color_type, png::ColorType::Rgb);
    (info.width, info.height, pixels)
}

fn texts(elements: &[Element]) -> Vec<&str> {
    elements.iter().filter(|e| e.name == "text").map(|e| &*e.text).collect()
}

fn curves<'a>(elements: &'a [Element], colour: &str) -> Vec<&'a Element> {
    let lines = elements.iter().filter(|e| e.name == "polyline" && e.points() > 2);
    lines.filter(|e| e.get("stroke") == colour).collect()
}

const BLUE: &str = "#0072B2";
const VERMILION: &str = "#D55E00";

fn chart() -> Chart {
    let curve = |label: &str, colour, break_at: Option<i32>| Series {
        label: Some(label.into()),
        points: (0..=50)
            .map(|i| [f64::from(i), if break_at == Some(i) { f64::NAN } else { f64::from(i * i) }])
            .collect(),
        colour,
        ..Series::default()
    };
    let mark = Mark { x: 20.0, label: Some("critical µ".into()) };
    Chart {
        title: "Growth < decay & more".into(),
        x_label: "Friction coefficient µ [–]".into(),
        panels: vec![
            Panel {
                y_label: "Growth rate [1/s]".into(),
                series: vec![curve("whole", 0, None), curve("broken", 1, Some(25))],
                marks: vec![mark.clone()],
                zero_line: true,
                ..Panel::default()
            },
            Panel {
                y_label: "Frequency [Hz]".into(),
                series: vec![curve("whole", 0, None)],
                marks: vec![Mark { label: None, ..mark }],
                zero_line: false,
                ..Panel::default()
            },
        ],
        ..Chart::default()
    }
}

/// Colours of values from 0 to 5 over 4 × 3 cells, one of which has none.
fn raster() -> Raster {
    Raster {
        x: [0.0, 4.0],
        y: [0.0, 30.0],
        rows: vec![
            vec![0.0, 1.0, 2.0, 3.0],
            vec![1.0, f64::NAN, 3.0, 4.0],
            vec![2.0, 3.0, 4.0, 9.0],
        ],
        range: [0.0, 5.0],
        label: "Level <dB>".into(),
    }
}

fn spectrogram() -> Chart {
    let panel =
        Panel { y_label: "Frequency [Hz]".into(), raster: Some(raster()), ..Panel::default() };
    Chart {
        title: "Spectrogram".into(),
        x_label: "t [s]".into(),
        panels: vec![panel],
        ..Chart::default()
    }
}

/// Two contacts over 8 s: one slips from 0 to 4 and sticks from 4 to 8, of the other nothing is known until 6.
fn states() -> Chart {
    let class = |name: &str, colour| Class::plain(name.into(), colour);
    let lane = |name: &str, stretches: &[(f64, f64, usize)]| Lane {
        name: name.into(),
        stretches: stretches
            .iter()
            .map(|&(from, to, class)| LaneInterval { from, to, class })
            .collect(),
    };
    let panel = Panel {
        y_label: "Contact state".into(),
        lanes: vec![lane("left", &[(0.0, 4.0, 0), (4.0, 8.0, 1)]), lane("right", &[(6.0, 8.0, 0)])],
        classes: vec![class("slip", 1), class("stick", 0)],
        ..Panel::default()
    };
    Chart {
        title: "States".into(),
        x_label: "t [s]".into(),
        panels: vec![panel],
        ..Chart::default()
    }
}

fn map() -> Map {
    let class = |name: &str, colour| Class::plain(name.into(), colour);
    Map {
        title: "Stability".into(),
        x_label: "µ [–]".into(),
        y_label: "k6 [kN/m]".into(),
        x: [0.0, 3.0],
        y: [100.0, 300.0],
        cells: vec![vec![0, 0, 1], vec![0, 1, 1]],
        classes: vec![class("stable", 0), class("flutter", 1)],
    }
}

fn mode_shapes() -> ModeShapes {
    let shape = (0..8).map(|i| Complex::from_polar(1.0, f64::from(i))).collect();
    let second = ModeShape { title: "Mode 2: 66 Hz".into(), shape };
    let mut first = ModeShape { title: "Mode 1: 34 Hz".into(), ..second.clone() };
    // The second mass of the first module is at rest.
    first.shape[2..4].fill(Complex::new(0.0, 0.0));
    ModeShapes { title: "Modes".into(), angle: 0.5, modes: vec![first, second] }
}

/// A block on a belt, held by a spring and a dashpot, with a second block above.
fn structure() -> Structure {
    let mass = |name: &str| MassMark { name: name.into(), ..MassMark::default() };
    let link = |name: &str, ends, direction, kind| Link {
        name: name.into(),
        label: "5 <units>".into(),
        ends,
        direction,
        kind,
        preload: 0.0,
    };
    Structure {
        title: "Two blocks & a belt".into(),
        masses: vec![MassMark { locked: [true, false], ..mass("upper") }, mass("lower")],
        links: vec![
            link("k1", [Some(0), Some(1)], 1.57, LinkKind::Spring),
            link("k2", [None, Some(1)], 0.0, LinkKind::Spring),
            link("d2", [None, Some(1)], 0.0, LinkKind::Damper),
        ],
        sliders: vec![SliderMark {
            name: "belt".into(),
            mass: 1,
            velocity: 0.1,
            ..SliderMark::default()
        }],
        ..Structure::default()
    }
}

#[test]
fn logarithmic_axes_have_powers_of_ten_and_leave_out_what_has_no_logarithm() {
    let points = [[1.0, 1e-2], [10.0, 1e-4], [20.0, 0.0], [100.0, 1e-6], [1e3, 1e-8], [1e4, 1e-10]];
    let labels = (0..points.len()).map(|i| format!("no. {i}")).collect();
    let series = Series { points: points.to_vec(), labels, ..Series::default() };
    let panel = Panel { y_label: "error".into(), series: vec![series], ..Panel::default() };
    let chart = Chart { panels: vec![panel], logarithmic: true, ..Chart::default() };
    let elements = drawn(|path| chart.write(path));
    let texts = texts(&elements);
    for text in ["1", "1000", "1e−4", "1e−8", "no. 0", "no. 1", "no. 3", "no. 5"] {
        assert!(texts.contains(&text), "{text}: {texts:?}");
    }
    assert!(!texts.contains(&"no. 2"));
    let dots = elements.iter().filter(|e| e.name == "circle").count();
    assert_eq!(dots, 5);
    // A straight line, as powers are; its second part has three points.
    let line = curves(&elements, BLUE)[0];
    let places: Vec<[f64; 2]> = line.get("points").split_whitespace().map(place).collect();
    let slope = |a: [f64; 2], b: [f64; 2]| (b[1] - a[1]) / (b[0] - a[0]);
    assert!((slope(places[0], places[1]) / slope(places[1], places[2]) - 1.0).abs() < 0.01);
}

/// A point of a polyline.
fn place(text: &str) -> [f64; 2] {
    let (x, y) = text.split_once(',').unwrap();
    [x, y].map(|number| number.parse().unwrap())
}

#[test]
fn a_structure_names_all_its_parts_and_what_their_symbols_mean() {
    let elements = drawn(|path| structure().write(path));
    let texts = texts(&elements);
    for label in [
        "Two blocks &amp; a belt",
        "upper",
        "lower",
        "k1 5 &lt;units&gt;",
        "k2 5 &lt;units&gt;",
        "d2 5 &lt;units&gt;",
        "belt",
        "spring",
        "damper",
        "fixed",
        "slider and its motion",
        "guide: no motion towards it",
    ] {
        assert_eq!(texts.iter().filter(|text| **text == label).count(), 1, "{label}: {texts:?}");
    }
    let named = |name: &str| elements.iter().find(|e| e.name == name).unwrap();
    assert_eq!(named("title").text, "Two blocks &amp; a belt");
    let words = &named("desc").text;
    assert!(words.contains("damper d2 5 &lt;units&gt; from ground to lower at 0°"), "{words}");
    // A zigzag has many corners; both springs and the sample have theirs.
    assert_eq!(curves(&elements, BLUE).len(), 3);
}

#[test]
fn structures_of_what_is_not_there_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("picture.svg");
    let refused = |change: &dyn Fn(&mut Structure), words: &[&str]| {
        let mut structure = structure();
        change(&mut structure);
        let error = structure.write(&path).unwrap_err();
        let text = error.to_string();
        assert!(error.is_picture() && text.contains("picture.svg"), "{text}");
        for word in words {
            assert!(text.contains(word), "{word}: {text}");
        }
        assert!(!path.exists());
    };
    refused(&|s| s.masses.clear(), &["at least one mass"]);
    let many = |s: &mut Structure| s.masses.resize(41, MassMark::default());
    refused(&many, &["41 masses", "up to 40 masses"]);
    refused(&|s| s.links[1].ends[1] = Some(2), &["link 1 (k2)", "mass 2", "from 0 to 1"]);
    refused(&|s| s.links[0].ends = [Some(1), Some(1)], &["link 0 (k1)", "two different ends"]);
    refused(&|s| s.links[1].ends = [None, None], &["link 1 (k2)", "two different ends"]);
    refused(&|s| s.links[2].direction = f64::NAN, &["direction of link 2 (d2)", "finite"]);
    refused(&|s| s.masses[0].angle = f64::INFINITY, &["angle of mass 0 (upper)", "finite"]);
    refused(&|s| s.sliders[0].mass = 7, &["slider 0 (belt)", "mass 7"]);
    refused(&|s| s.sliders[0].on = Some(2), &["slider 0 (belt)", "mass 2"]);
    refused(&|s| s.sliders[0].on = Some(1), &["slider 0 (belt)", "another mass"]);
    refused(&|s| s.sliders[0].angle = f64::NAN, &["angle of slider 0 (belt)"]);
    refused(&|s| s.sliders[0].velocity = f64::NAN, &["velocity of slider 0 (belt)"]);
    structure().write(&path).unwrap();
}

#[test]
fn a_chart_has_one_line_a_curve_and_one_more_after_a_break() {
    let elements = drawn(|path| chart().write(path));
    let blue = curves(&elements, BLUE);
    assert_eq!(blue.iter().map(|line| line.points()).collect::<Vec<_>>(), [51, 51]);
    let vermilion = curves(&elements, VERMILION);
    assert_eq!(vermilion.iter().map(|line| line.points()).collect::<Vec<_>>(), [25, 25]);
}

#[test]
fn a_chart_has_its_labels_once_and_escapes_them() {
    let elements = drawn(|path| chart().write(path));
    let texts = texts(&elements);
    for label in [
        "Growth &lt; decay &amp; more",
        "Friction coefficient µ [–]",
        "Growth rate [1/s]",
        "Frequency [Hz]",
        "whole",
        "broken",
        "critical µ",
    ] {
        assert_eq!(texts.iter().filter(|text| **text == label).count(), 1, "{label}: {texts:?}");
    }
    let named = |name: &str| elements.iter().find(|e| e.name == name).unwrap();
    assert_eq!(named("title").text, "Growth &lt; decay &amp; more");
    assert!(named("desc").text.contains("“critical µ”"), "{}", named("desc").text);
    assert_eq!(named("svg").get("width"), "900");
}

#[test]
fn a_mark_is_a_dashed_line_over_its_panel() {
    let dashes = |chart: &Chart| {
        let elements = drawn(|path| chart.write(path));
        elements.iter().filter(|e| e.name == "polyline" && e.get("stroke") == "#666666").count()
    };
    let with = chart();
    let mut without = chart();
    without.panels.iter_mut().for_each(|panel| panel.marks.clear());
    assert_eq!(dashes(&without), 0);
    // Two panels of 260 px, dashes of 5 px after each 9, and the line to the label.
    assert_eq!(dashes(&with), 2 * 29 + 1);
}

#[test]
fn a_map_has_a_legend_and_the_colours_of_its_cells() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.png");
    map().write(&path).unwrap();
    let (width, height, pixels) = decoded(&path);
    assert_eq!(width, 1800);
    // The plane is between 84 and 876 px across and 480 px up, above 60 px of the x axis.
    let at = |column: u32, row: u32| {
        let x = 2 * (84 + 792 * (2 * column + 1) / 6);
        let y = height - 2 * (60 + 480 * (2 * row + 1) / 4);
        let place = 3 * (y * width + x) as usize;
        [pixels[place], pixels[place + 1], pixels[place + 2]]
    };
    let (stable, flutter) = ([0x00, 0x72, 0xB2], [0xD5, 0x5E, 0x00]);
    assert_eq!([at(0, 0), at(1, 0), at(2, 0)], [stable, stable, flutter]);
    assert_eq!([at(0, 1), at(1, 1), at(2, 1)], [stable, flutter, flutter]);
    let elements = drawn(|path| map().write(path));
    let texts = texts(&elements);
    for label in ["stable", "flutter", "µ [–]", "k6 [kN/m]"] {
        assert!(texts.contains(&label), "{label}: {texts:?}");
    }
}

#[test]
fn modes_move_without_scripts_and_stand_still_where_that_is_preferred() {
    let elements = drawn(|path| mode_shapes().write(path));
    let count = |name: &str| elements.iter().filter(|e| e.name == name).count();
    assert_eq!(count("script"), 0);
    // Springs once a mode; eight masses, of which seven have a hand.
    assert_eq!(count("animate"), 2);
    assert_eq!(count("animateTransform"), 8 + 7);
    assert_eq!(count("circle"), 2 * 7);
    for element in elements.iter().filter(|e| e.name.starts_with("animate")) {
        assert_eq!(element.get("dur"), "2s");
        let values: Vec<&str> = element.get("values").split(';').collect();
        assert_eq!(values.first(), values.last(), "a cycle ends where it began");
    }
    let style = elements.iter().find(|e| e.name == "style").unwrap();
    assert!(style.text.contains("prefers-reduced-motion"));
    let texts = texts(&elements);
    assert!(texts.contains(&"Mode 1: 34 Hz") && texts.contains(&"Mode 2: 66 Hz"));
}

#[test]
fn bitmaps_are_twice_as_wide_as_drawn_and_show_something() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("picture.PNG");
    for write in [|path: &Path| chart().write(path), |path: &Path| mode_shapes().write(path)] {
        write(&path).unwrap();
        let (width, height, pixels) = decoded(&path);
        assert!(width == 1800 && height > 400, "{width} × {height}");
        assert!(pixels.chunks(3).any(|pixel| pixel == [0x00, 0x72, 0xB2]));
    }
}

#[test]
fn the_same_data_give_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    for ending in ["svg", "png"] {
        let [a, b] = ["a", "b"].map(|name| folder.path().join(format!("{name}.{ending}")));
        for path in [&a, &b] {
            map().write(path).unwrap();
        }
        assert_eq!(fs::read(&a).unwrap(), fs::read(&b).unwrap());
        for chart in [spectrogram(), states()] {
            for path in [&a, &b] {
                chart.write(path).unwrap();
            }
            assert_eq!(fs::read(&a).unwrap(), fs::read(&b).unwrap());
        }
        for path in [&a, &b] {
            structure().write(path).unwrap();
        }
        assert_eq!(fs::read(a).unwrap(), fs::read(b).unwrap());
    }
}

#[test]
fn another_ending_is_refused_with_the_right_ones() {
    for name in ["chart.pdf", "chart", "svg"] {
        let error = chart().write(Path::new(name)).unwrap_err();
        let text = error.to_string();
        assert!(error.is_picture() && text.contains(name), "{text}");
        assert!(text.contains(".svg or .png"), "{text}");
        assert!(!Path::new(name).exists());
    }
}

#[test]
fn what_cannot_be_written_is_named_and_leaves_what_was_there() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("missing").join("chart.svg");
    let error = chart().write(&missing).unwrap_err();
    assert!(error.is_file() && error.to_string().contains(&*missing.to_string_lossy()));

    // The partial file cannot be made where a folder has its name: so even for a superuser.
    let path = folder.path().join("chart.svg");
    fs::write(&path, "old").unwrap();
    fs::create_dir(folder.path().join("chart.svg.partial")).unwrap();
    let error = chart().write(&path).unwrap_err();
    assert!(error.to_string().contains(&*path.to_string_lossy()), "{error}");
    assert_eq!(fs::read_to_string(&path).unwrap(), "old");

    let taken = folder.path().join("folder.svg");
    fs::create_dir(&taken).unwrap();
    assert!(chart().write(&taken).unwrap_err().is_file());
    assert!(!folder.path().join("folder.svg.partial").exists());
}

#[test]
fn pictures_of_nothing_or_of_the_wrong_shape_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("picture.svg");
    let refused = |result: Result<(), Error>, word: &str| {
        let text = result.unwrap_err().to_string();
        assert!(text.contains(word) && text.contains("picture.svg"), "{text}");
        assert!(!path.exists());
    };
    refused(Chart::default().write(&path), "finite point");
    let mut chart = chart();
    chart.panels[1].series.clear();
    refused(chart.write(&path), "Frequency [Hz]");
    refused(Map { cells: vec![], ..map() }.write(&path), "at least one cell");
    refused(Map { cells: vec![vec![0, 1], vec![0]], ..map() }.write(&path), "row 1");
    refused(Map { cells: vec![vec![0, 2]], ..map() }.write(&path), "class 2");
    refused(Map { y: [2.0, 2.0], ..map() }.write(&path), "y axis");
    refused(ModeShapes::default().write(&path), "no mode");
    let mut modes = mode_shapes();
    modes.modes[1].shape.pop();
    refused(modes.write(&path), "Mode 2");
    let mut modes = mode_shapes();
    modes.modes[0].shape[3].im = f64::NAN;
    refused(modes.write(&path), "Mode 1");
}

fn description(elements: &[Element]) -> &str {
    &elements.iter().find(|e| e.name == "desc").unwrap().text
}

/// The pixel at a place of a picture, px.
fn pixel((width, _, pixels): &Pixels, x: u32, y: u32) -> [u8; 3] {
    let place = 3 * (2 * y * width + 2 * x) as usize;
    [pixels[place], pixels[place + 1], pixels[place + 2]]
}

fn written(chart: &Chart) -> Pixels {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("chart.png");
    chart.write(&path).unwrap();
    decoded(&path)
}

#[test]
fn a_band_is_a_pale_range_of_its_panel_behind_the_curves() {
    let mut chart = chart();
    let band = |from, to| Band { from, to, label: Some("two <states>".into()), colour: 2 };
    chart.panels[0].bands = vec![band(10.0, 20.0), band(40.0, f64::INFINITY)];
    let elements = drawn(|path| chart.write(path));
    // A fifth of the colour, four fifths of white; x from 0 to 50 is from 84 to 876 px, in tenths.
    let pale: Vec<usize> =
        (0..elements.len()).filter(|&i| elements[i].get("fill") == "#CCECE3").collect();
    let [legend, first, second] = pale[..] else { panic!("{} pale areas", pale.len()) };
    let sides = |element: &Element| {
        let x = element.get("points").split_whitespace().map(|point| place(point)[0]);
        [x.clone().fold(f64::INFINITY, f64::min), x.fold(0.0, f64::max)]
    };
    assert_eq!(sides(&elements[first]), [840.0 + 1584.0, 840.0 + 2.0 * 1584.0]);
    assert_eq!(sides(&elements[second]), [840.0 + 4.0 * 1584.0, 8760.0]);
    let curve = elements.iter().position(|e| e.points() == 51).unwrap();
    assert!(legend < first && second < curve);
    assert_eq!(texts(&elements).iter().filter(|t| **t == "two &lt;states&gt;").count(), 1);
    let words = description(&elements);
    assert!(words.contains("shaded: “two &lt;states&gt;” from 10 to 20"), "{words}");
    // A panel that ends at 50 shows up to 60 if a range ends there.
    chart.panels[0].bands = vec![band(10.0, 60.0)];
    assert!(texts(&drawn(|path| chart.write(path))).contains(&"60"));
}

#[test]
fn a_raster_has_the_colours_of_its_scale() {
    let picture = written(&spectrogram());
    let (_, height, _) = picture;
    // The scale is from 576 to 876 px, below the title; the plane as that of a map, but 400 px up.
    let scale = |value: f64| pixel(&picture, 577 + (value / 5.0 * 298.0) as u32, 38 + 8 + 4 + 6);
    let cell = |column: u32, row: u32| {
        pixel(&picture, 84 + 198 * column + 99, height / 2 - 60 - 66 - 133 * row)
    };
    let near = |a: [u8; 3], b: [u8; 3]| a.iter().zip(b).all(|(a, b)| a.abs_diff(b) <= 4);
    for (column, row, value) in [(0, 0, 0.0), (3, 0, 3.0), (0, 1, 1.0), (3, 1, 4.0), (2, 2, 4.0)] {
        let (found, expected) = (cell(column, row), scale(value));
        assert!(near(found, expected), "{column}, {row}: {found:?} and {expected:?}");
    }
    // Values above the scale have its last colour; values that are not a number have none.
    assert!(near(cell(3, 2), scale(5.0)));
    assert_eq!(cell(1, 1), [255; 3]);
    let sum = |value: f64| scale(value).map(u32::from).iter().sum::<u32>();
    assert!((0..5).all(|i| sum(f64::from(i)) < sum(f64::from(i + 1))), "dark to light");
}

/// Bytes of base64.
fn bytes(text: &str) -> Vec<u8> {
    let digit = |c: u8| match c {
        b'A'..=b'Z' => c - b'A',
        b'a'..=b'z' => c - b'a' + 26,
        b'0'..=b'9' => c - b'0' + 52,
        b'+' => 62,
        _ => 63,
    };
    let bits = text.bytes().filter(|c| *c != b'=');
    let bits: Vec<u8> = bits.flat_map(|c| (0..6).rev().map(move |i| digit(c) >> i & 1)).collect();
    bits.chunks_exact(8).map(|byte| byte.iter().fold(0, |all, bit| 2 * all + bit)).collect()
}

/// The images of an SVG, each with its place and its content.
fn images(elements: &[Element]) -> Vec<([f64; 4], Pixels)> {
    let found = elements.iter().filter(|e| e.name == "image");
    let sides = ["x", "y", "width", "height"];
    found
        .map(|e| {
            let data = e.get("href").strip_prefix("data:image/png;base64,").unwrap();
            (sides.map(|side| e.get(side).parse().unwrap()), decoded_bytes(&bytes(data)))
        })
        .collect()
}

#[test]
fn a_raster_is_an_image_within_an_svg_and_is_told_in_words() {
    let elements = drawn(|path| spectrogram().write(path));
    let images = images(&elements);
    let [([x, _, width, height], (columns, rows, cells)), ([.., length, _], (colours, 1, scale))] =
        &images[..]
    else {
        panic!("{} images", images.len())
    };
    assert_eq!([*x, *width, *height, *length], [840.0, 7920.0, 4000.0, 3000.0]);
    assert_eq!([*columns, *rows, *colours], [4, 3, 255]);
    // The highest row is first: 2 is there at the left, beyond the scale at the right; 0 is below.
    assert_eq!(cells[..3], scale[3 * 102..3 * 103]);
    assert_eq!(cells[9..12], scale[3 * 254..]);
    assert_eq!(cells[15..18], [255; 3]);
    assert_eq!(cells[24..27], scale[..3]);
    // Behind the axes, on the ground.
    let first = |name: &str| elements.iter().position(|e| e.name == name).unwrap();
    assert!(first("rect") < first("image") && first("image") < first("polyline"));
    let texts = texts(&elements);
    for label in ["Level &lt;dB&gt;", "Frequency [Hz]", "30", "5"] {
        assert!(texts.contains(&label), "{label}: {texts:?}");
    }
    let words = description(&elements);
    assert!(words.contains("dark blue for 0 to yellow for 5 of “Level &lt;dB&gt;”"), "{words}");
}

#[test]
fn a_raster_of_a_million_values_is_reduced_to_what_is_seen() {
    let mut chart = spectrogram();
    let even = |i: u32| if i.is_multiple_of(2) { 1.0 } else { 4.0 };
    let raster = chart.panels[0].raster.as_mut().unwrap();
    raster.rows = (0..1584).map(|row| vec![even(row); 1000]).collect();
    let elements = drawn(|path| chart.write(path));
    let images = images(&elements);
    let (width, height, cells) = &images[0].1;
    assert_eq!([*width, *height], [792, 400]);
    // The mean of 1 and 4 is in the middle of the scale, here and there a little off it.
    let scale = &images[1].1.2;
    assert!(cells.chunks(3).all(|cell| scale[3 * 110..3 * 145].chunks(3).any(|c| c == cell)));
}

#[test]
fn lanes_have_the_colours_of_their_classes() {
    let picture = written(&states());
    let (_, height, _) = picture;
    // Two lanes of 26 px above 60 px of the x axis; a second is 99 px.
    let at = |lane: u32, second: u32| {
        pixel(&picture, 84 + 99 * second + 50, height / 2 - 99 + 26 * lane)
    };
    let (slip, stick) = ([0xD5, 0x5E, 0x00], [0x00, 0x72, 0xB2]);
    assert_eq!([at(0, 0), at(0, 3), at(0, 4), at(0, 7)], [slip, slip, stick, stick]);
    assert_eq!([at(1, 0), at(1, 5), at(1, 6), at(1, 7)], [[255; 3], [255; 3], slip, slip]);
    let elements = drawn(|path| states().write(path));
    let texts = texts(&elements);
    for label in ["Contact state", "left", "right", "slip", "stick", "t [s]", "8"] {
        assert_eq!(texts.iter().filter(|text| **text == label).count(), 1, "{label}: {texts:?}");
    }
    let words = description(&elements);
    assert!(words.contains("lanes “left”, “right”, each divided into “slip”, “stick”"), "{words}");
}

#[test]
fn frames_begin_where_the_names_of_lanes_end() {
    let mut chart = states();
    let curve = Series { points: vec![[0.0, 1.0], [8.0, 2.0]], ..Series::default() };
    chart.panels.insert(0, Panel { series: vec![curve], ..Panel::default() });
    let start = |chart: &Chart| {
        let elements = drawn(|path| chart.write(path));
        let curve = elements.iter().find(|e| e.get("stroke") == BLUE).unwrap();
        place(curve.get("points").split_whitespace().next().unwrap())[0]
    };
    assert_eq!(start(&chart), 840.0);
    chart.panels[1].lanes[0].name = "guide with the left pad".into();
    let start = start(&chart);
    assert!((1200.0..2500.0).contains(&start), "{start}");
}

#[test]
fn dots_are_not_joined_and_stand_once_at_a_place() {
    let mut chart = chart();
    let points = vec![[0.0, 0.0], [50.0, 2500.0], [f64::NAN, 1.0], [50.0, 2500.01], [25.0, 0.0]];
    let label = Some("peaks".to_owned());
    chart.panels[0].series =
        vec![Series { points, label, style: Style::Dots, ..Series::default() }];
    chart.panels.pop();
    let elements = drawn(|path| chart.write(path));
    // And one in the legend.
    let dots = elements.iter().filter(|e| e.name == "circle" && e.get("fill") == BLUE);
    assert_eq!(dots.count(), 3 + 1);
    assert!(!elements.iter().any(|e| e.name == "polyline" && e.get("stroke") == BLUE));
}

#[test]
fn a_closed_loop_keeps_off_the_frame() {
    let angle = |i: i32| std::f64::consts::TAU * f64::from(i) / 200.0;
    let points = (0..=200).map(|i| [angle(i).cos(), angle(i).sin()]).collect();
    let panel = Panel { series: vec![Series { points, ..Series::default() }], ..Panel::default() };
    let elements =
        drawn(|path| Chart { panels: vec![panel.clone()], ..Chart::default() }.write(path));
    let lines = curves(&elements, BLUE);
    let places: Vec<[f64; 2]> = lines[0].get("points").split_whitespace().map(place).collect();
    assert_eq!((lines.len(), places.len(), places[0]), (1, 201, places[200]));
    // A twentieth of the range is free at both sides.
    let x = places.iter().map(|place| place[0]);
    let ends = [x.clone().fold(f64::INFINITY, f64::min), x.fold(0.0, f64::max)];
    assert_eq!(ends, [840.0 + 360.0, 8760.0 - 360.0]);
}

#[test]
fn rasters_and_lanes_of_the_wrong_shape_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("picture.svg");
    let refused = |mut chart: Chart, change: &dyn Fn(&mut Panel), words: &[&str]| {
        change(&mut chart.panels[0]);
        let text = chart.write(&path).unwrap_err().to_string();
        for word in words.iter().chain(&["picture.svg"]) {
            assert!(text.contains(word), "{word}: {text}");
        }
        assert!(!path.exists());
    };
    let raster = |change: &dyn Fn(&mut Raster), words: &[&str]| {
        refused(spectrogram(), &|panel| change(panel.raster.as_mut().unwrap()), words);
    };
    raster(&|r| r.rows.clear(), &["Frequency [Hz]", "no values"]);
    raster(&|r| r.rows[1].push(1.0), &["5 values in row 1 and 4 in row 0"]);
    raster(&|r| r.x = [1.0, 1.0], &["from 1 to 1 in x", "ascend"]);
    raster(&|r| r.y[1] = f64::NAN, &["in y", "ascend"]);
    raster(&|r| r.range = [5.0, 0.0], &["colours from 5 to 0", "ascend"]);
    refused(Chart { logarithmic: true, ..spectrogram() }, &|_| {}, &["linear axes"]);
    let both = |panel: &mut Panel| panel.series = vec![Series::default()];
    refused(states(), &both, &["Contact state", "neither series nor a raster"]);
    let class = |panel: &mut Panel| panel.lanes[0].stretches[1].class = 2;
    refused(states(), &class, &["stretch 1", "left", "class 2, but there are 2 classes"]);
    let turned = |panel: &mut Panel| panel.lanes[1].stretches[0].to = 5.0;
    refused(states(), &turned, &["stretch 0", "right", "from 6 to 5", "ascend"]);
}

#[test]
fn charts_and_maps_are_written_as_data_under_the_names_of_their_fields() {
    let mut chart = spectrogram();
    chart.panels.extend(states().panels);
    chart.panels[0].series = vec![Series { style: Style::Dots, ..Series::default() }];
    chart.panels[0].bands = vec![Band { from: 1.0, ..Band::default() }];
    let data = serde_json::to_value(&chart).unwrap();
    assert_eq!(data["panels"][0]["raster"]["rows"][2][3], 9.0);
    assert_eq!(data["panels"][0]["series"][0]["style"], "dots");
    assert_eq!(data["panels"][0]["bands"][0]["from"], 1.0);
    assert_eq!(data["panels"][1]["lanes"][0]["stretches"][1]["class"], 1);
    assert_eq!(data["panels"][1]["classes"][1]["name"], "stick");
    assert_eq!(serde_json::to_value(map()).unwrap()["cells"][0][2], 1);
}

/// Two points, a place where nothing is known, a point between two such places, and two points more.
fn marked(marker: Option<Marker>) -> Chart {
    let points = [0.0, 1.0, f64::NAN, 3.0, f64::NAN, 5.0, 6.0]
        .iter()
        .zip(0..)
        .map(|(y, x)| [f64::from(x), *y]);
    let label = Some("found".to_owned());
    let series = vec![Series { points: points.collect(), label, marker, ..Series::default() }];
    Chart {
        title: "Gaps".into(),
        x_label: "x".into(),
        panels: vec![Panel { y_label: "y".into(), series, ..Panel::default() }],
        ..Chart::default()
    }
}

#[test]
fn a_gap_stays_open_and_a_point_within_it_is_seen() {
    let elements = drawn(|path| marked(None).write(path));
    let blue = |name: &str, key: &str| -> Vec<&Element> {
        elements.iter().filter(|e| e.name == name && e.get(key) == BLUE).collect()
    };
    // Two lines of two points, and the legend's.
    assert_eq!(
        blue("polyline", "stroke").iter().map(|line| line.points()).collect::<Vec<_>>(),
        [2; 3]
    );
    assert_eq!(blue("circle", "fill").len(), 1, "the point alone");
    let picture = written(&marked(None));
    let coloured =
        |x: u32| (100..picture.1 / 2 - 70).any(|y| pixel(&picture, x, y) == [0x00, 0x72, 0xB2]);
    // Six units of x are 792 px from 84 on.
    let found =
        [0.5, 1.5, 2.5, 3.0, 3.5, 4.5, 5.5].map(|x: f64| coloured((84.0 + 132.0 * x) as u32));
    assert_eq!(found, [true, false, false, true, false, false, true]);
}

#[test]
fn each_point_has_the_marker_of_its_series_and_so_has_the_legend() {
    let count = |marker: Marker, style: Style, name: &str| {
        let mut chart = marked(Some(marker));
        chart.panels[0].series[0].style = style;
        let elements = drawn(|path| chart.write(path));
        elements
            .iter()
            .filter(|e| e.name == name && [e.get("fill"), e.get("stroke")].contains(&BLUE))
            .count()
    };
    // Five points and the legend's.
    assert_eq!(count(Marker::Disc, Style::Dots, "circle"), 6);
    assert_eq!(count(Marker::Ring, Style::Dots, "circle"), 6);
    let heads = [Marker::Right, Marker::Left, Marker::Up, Marker::Down];
    for marker in [Marker::Square, Marker::Triangle, Marker::Diamond].into_iter().chain(heads) {
        assert_eq!(count(marker, Style::Dots, "polygon"), 6, "{marker:?}");
        assert_eq!(count(marker, Style::Line, "polygon"), 6, "{marker:?}");
    }
    assert_eq!(count(Marker::Cross, Style::Dots, "polyline"), 12);
    // Two lines and the legend's more.
    assert_eq!(count(Marker::Cross, Style::Line, "polyline"), 15);
    let forms = Marker::ALL.map(|marker| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture.svg");
        marked(Some(marker)).write(&path).unwrap();
        fs::read_to_string(path).unwrap()
    });
    for (place, form) in forms.iter().enumerate() {
        assert!(!forms[..place].contains(form), "{:?} looks like another", Marker::ALL[place]);
    }
}

#[test]
fn the_shortest_stretch_shows_all_colours_of_its_class() {
    let mut chart = states();
    chart.panels[0].lanes[0].stretches[1] = LaneInterval { from: 4.0, to: 4.02, class: 2 };
    chart.panels[0].classes.push(Class { stripes: vec![0], ..Class::plain("both".into(), 1) });
    let picture = written(&chart);
    let middle = picture.1 / 2 - 99;
    let at = |y: u32| pixel(&picture, 84 + 99 * 4, y);
    assert_eq!([at(middle - 5), at(middle + 5)], [[0xD5, 0x5E, 0x00], [0x00, 0x72, 0xB2]]);
}
