//! Classes: what a cell of a map or a stretch of a lane can be, each with a look of its own.

use super::PALETTE;
use super::legend::{Entry, Sample};
use super::palette::colour;
use amontons::contact::ContactState;
use plotters::style::RGBColor;
use serde::Serialize;

/// A class of a cell of a map, or of a stretch of a lane.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Class {
    /// Name in the legend.
    pub name: String,
    /// Place in the [palette](PALETTE).
    pub colour: usize,
    /// Places in the palette of further colours, which take turns with the first one in stripes; none is plain.
    pub stripes: Vec<usize>,
}

impl Class {
    /// A class of one colour.
    #[must_use]
    pub fn plain(name: String, colour: usize) -> Self {
        Self { name, colour, stripes: Vec::new() }
    }

    /// The class at a place among many, from 0: no two of the first 255 look alike. The first eight are plain, the next
    /// ones have stripes of two colours, then of three, and so on.
    #[must_use]
    pub fn numbered(name: String, place: usize) -> Self {
        let mut sets: Vec<usize> = (1..1 << PALETTE.len()).collect();
        // Stable, and reversed digits: sets of the first colours come first.
        sets.sort_by_key(|set| set.count_ones());
        let set = sets[place % sets.len()];
        let mut colours = (0..PALETTE.len()).filter(|colour| set >> colour & 1 == 1);
        let first = colours.next().unwrap_or_default();
        Self { name, colour: first, stripes: colours.collect() }
    }

    /// The states that a contact takes by turns: a colour for each, in stripes where they are several. Neither order
    /// nor repetition of the states matters.
    #[must_use]
    pub fn of_states(states: &[ContactState]) -> Self {
        let found = ContactState::ALL.into_iter().filter(|state| states.contains(state));
        let found: Vec<ContactState> = found.collect();
        let words: Vec<&str> = found.iter().map(|state| word(*state)).collect();
        let name = match &words[..] {
            [] => "not known".to_owned(),
            [alone] => (*alone).to_owned(),
            [others @ .., last] => format!("{} and {last} by turns", others.join(", ")),
        };
        let mut colours = found.into_iter().map(colour_of_state);
        let first = colours.next().unwrap_or(UNKNOWN);
        Self { name, colour: first, stripes: colours.collect() }
    }

    /// All colours of the class.
    pub(super) fn colours(&self) -> Vec<RGBColor> {
        std::iter::once(&self.colour).chain(&self.stripes).map(|&place| colour(place)).collect()
    }

    pub(super) fn entry(&self) -> Entry {
        Entry { label: self.name.clone(), sample: Sample::Patch(self.colours()) }
    }
}

/// The colour of unknown classes.
const UNKNOWN: usize = 6;

/// Places in the palette: a blue for either direction of sliding, dark and light, and two warm ones.
fn colour_of_state(state: ContactState) -> usize {
    match state {
        ContactState::Slide => 5,
        ContactState::ReverseSlide => 0,
        ContactState::Stick => 1,
        ContactState::Detached => 7,
    }
}

fn word(state: ContactState) -> &'static str {
    match state {
        ContactState::Slide => "slides",
        ContactState::ReverseSlide => "slides back",
        ContactState::Stick => "sticks",
        ContactState::Detached => "is detached",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All 15 sets of states that are not empty.
    fn sets() -> Vec<Vec<ContactState>> {
        let of = |set: usize| {
            let states = ContactState::ALL.into_iter().enumerate();
            states.filter(|(place, _)| set >> place & 1 == 1).map(|(_, state)| state).collect()
        };
        (1..16).map(of).collect()
    }

    #[test]
    fn no_two_sets_of_states_look_or_read_alike() {
        let classes: Vec<Class> = sets().iter().map(|set| Class::of_states(set)).collect();
        for (place, class) in classes.iter().enumerate() {
            assert_eq!(class.colours().len(), sets()[place].len(), "a stripe for each state");
            for other in &classes[..place] {
                assert_ne!(class.colours(), other.colours(), "{} and {}", class.name, other.name);
                assert_ne!(class.name, other.name);
            }
        }
        let [slide, stick] = [ContactState::Slide, ContactState::Stick];
        assert_eq!(Class::of_states(&[stick, slide, stick]), Class::of_states(&[slide, stick]));
        assert_eq!(Class::of_states(&[stick, slide]).name, "slides and sticks by turns");
    }

    /// Linear red, green and blue as an eye sees them that lacks one kind of cones (G. M. Machado and others, A
    /// physiologically-based model for simulation of color vision deficiency, 2009, severity 1).
    fn seen(RGBColor(r, g, b): RGBColor, eye: [[f64; 3]; 3]) -> [f64; 3] {
        let linear = [r, g, b].map(|byte| match f64::from(byte) / 255.0 {
            value if value <= 0.04045 => value / 12.92,
            value => ((value + 0.055) / 1.055).powf(2.4),
        });
        let [r, g, b] =
            eye.map(|row| (0..3).map(|i| row[i] * linear[i]).sum::<f64>().clamp(0.0, 1.0));
        // Oklab, where equal distances look alike.
        let cone = |parts: [f64; 3]| (parts[0] * r + parts[1] * g + parts[2] * b).cbrt();
        let l = cone([0.412_221_470_8, 0.536_332_536_3, 0.051_445_992_9]);
        let m = cone([0.211_903_498_2, 0.680_699_545_1, 0.107_396_956_6]);
        let s = cone([0.088_302_461_9, 0.281_718_837_6, 0.629_978_700_5]);
        [
            0.210_454_255_3 * l + 0.793_617_785_0 * m - 0.004_072_046_8 * s,
            1.977_998_495_1 * l - 2.428_592_205_0 * m + 0.450_593_709_9 * s,
            0.025_904_037_1 * l + 0.782_771_766_2 * m - 0.808_675_766_0 * s,
        ]
    }

    #[test]
    fn states_are_told_apart_by_any_colour_vision() {
        let eyes = [
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            [
                [0.152_286, 1.052_583, -0.204_868],
                [0.114_503, 0.786_281, 0.099_216],
                [-0.003_882, -0.048_116, 1.051_998],
            ],
            [
                [0.367_322, 0.860_646, -0.227_968],
                [0.280_085, 0.672_501, 0.047_413],
                [-0.011_820, 0.042_940, 0.968_881],
            ],
            [
                [1.255_528, -0.076_749, -0.178_779],
                [-0.078_411, 0.930_809, 0.147_602],
                [0.004_733, 0.691_367, 0.303_900],
            ],
        ];
        for eye in eyes {
            let looks = ContactState::ALL.map(|state| seen(colour(colour_of_state(state)), eye));
            for (place, a) in looks.iter().enumerate() {
                for b in &looks[..place] {
                    let far = (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt();
                    // A difference that is just seen is about 0.02.
                    assert!(far > 0.12, "{far} of {a:?} and {b:?}");
                }
            }
        }
    }

    #[test]
    fn no_two_of_many_classes_look_alike() {
        let looks: Vec<Vec<RGBColor>> =
            (0..255).map(|place| Class::numbered(String::new(), place).colours()).collect();
        for (place, look) in looks.iter().enumerate() {
            assert!(!looks[..place].contains(look), "{place}");
        }
        assert!((0..8).all(|place| Class::numbered(String::new(), place).colour == place));
        assert!(looks[..8].iter().all(|look| look.len() == 1));
    }
}
