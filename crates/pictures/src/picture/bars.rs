//! Horizontal bars in groups, one group below the other.

use super::axes::{LARGE, MEDIUM, RIGHT, SMALL};
use super::canvas::{self, Align, Canvas, Drawing, Failure, WIDTH, text_width};
use super::number::{significant, typeset};
use super::palette::{INK, colour};
use amontons::Error;
use plotters::backend::DrawingBackend;
use std::path::Path;

/// Groups of bars.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bars {
    /// Title of the picture.
    pub title: String,
    /// Groups from top to bottom, each with an axis of its own.
    pub groups: Vec<BarGroup>,
}

/// Bars of one quantity.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BarGroup {
    /// Title of the group.
    pub title: String,
    /// The quantity, with its unit.
    pub axis: String,
    /// Bars from top to bottom.
    pub bars: Vec<Bar>,
}

/// A bar from zero to a value.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bar {
    /// Name beside the bar.
    pub label: String,
    /// Where the bar ends; one that is not finite has no bar.
    pub value: f64,
}

/// Left edge of texts, px.
const EDGE: f64 = 16.0;
/// Height of the title, px.
const HEAD: f64 = 44.0;
/// Height of a group's title and of the text of its axis, px.
const TITLE: f64 = 30.0;
/// Height of a bar with the space to the next one, and of the bar alone, px.
const ROW: f64 = 22.0;
const BAR: f64 = 14.0;
/// Space between two groups, px.
const APART: f64 = 14.0;
/// Space between a bar and its texts, px.
const BESIDE: f64 = 6.0;
/// Places of the palette for values above and below zero.
const ABOVE: usize = 1;
const BELOW: usize = 0;

impl Bars {
    /// Writes the bars as the path's ending asks, `.svg` or `.png`.
    ///
    /// # Errors
    /// Returns an error for another ending, if there is no bar, or if the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        self.check().map_err(|failure| canvas::cannot_draw(path, &failure))?;
        canvas::write(self, path)
    }

    /// The text of an SVG, as [`write`](Self::write) writes it.
    ///
    /// # Errors
    /// Returns an error if there is no bar.
    pub fn svg(&self) -> Result<String, Error> {
        self.check().map_err(|failure| canvas::cannot_draw_titled(&self.title, &failure))?;
        canvas::svg_text(self)
    }

    fn check(&self) -> Result<(), Failure> {
        if self.groups.iter().all(|group| group.bars.is_empty()) {
            return Err(Failure("there is no bar".into()));
        }
        Ok(())
    }
}

impl BarGroup {
    fn height(&self) -> f64 {
        2.0 * TITLE + ROW * rows(self.bars.len())
    }
}

#[allow(clippy::cast_precision_loss)]
fn rows(count: usize) -> f64 {
    count as f64
}

/// The number at a bar's end.
fn number(value: f64) -> String {
    let digits = significant(value, 3);
    digits.parse().map_or(digits, |short: f64| {
        typeset(short, short == 0.0 || (1e-3..1e6).contains(&short.abs()))
    })
}

impl Drawing for Bars {
    fn title(&self) -> &str {
        &self.title
    }

    fn description(&self) -> String {
        let groups = self.groups.iter().map(|group| {
            let bars = group.bars.iter().map(|bar| format!("{} {}", bar.label, number(bar.value)));
            format!("{}. {}: {}.", group.title, group.axis, bars.collect::<Vec<_>>().join(", "))
        });
        groups.collect::<Vec<_>>().join(" ")
    }

    fn width(&self) -> f64 {
        let titles = self.groups.iter().map(|group| text_width(&group.title, MEDIUM));
        let widest = titles.fold(text_width(&self.title, LARGE), f64::max);
        WIDTH.max((widest + 2.0 * EDGE).ceil())
    }

    fn height(&self) -> f64 {
        let groups = self.groups.iter().map(|group| group.height() + APART);
        HEAD + groups.sum::<f64>()
    }

    fn paint<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Result<(), Failure> {
        canvas.text(&self.title, [EDGE, 0.5 * HEAD], LARGE, Align::Left)?;
        let labels = self.groups.iter().flat_map(|group| &group.bars);
        let widest = labels.map(|bar| 1.1 * text_width(&bar.label, SMALL)).fold(0.0_f64, f64::max);
        let mut top = HEAD;
        for group in &self.groups {
            paint(group, [EDGE + widest + BESIDE, top], canvas)?;
            top += group.height() + APART;
        }
        Ok(())
    }
}

/// Paints a group whose bars begin at a left edge, px, below a height.
fn paint<B: DrawingBackend>(
    group: &BarGroup,
    [left, top]: [f64; 2],
    canvas: &Canvas<B>,
) -> Result<(), Failure> {
    canvas.text(&group.title, [EDGE, top + 0.5 * TITLE], MEDIUM, Align::Left)?;
    let values = || group.bars.iter().map(|bar| bar.value).filter(|value| value.is_finite());
    let numbers = values().map(|value| 1.1 * text_width(&number(value), SMALL));
    let room = numbers.fold(0.0_f64, f64::max) + 2.0 * BESIDE;
    let [least, most] = [values().fold(0.0, f64::min), values().fold(0.0, f64::max)];
    let span = if most > least { most - least } else { 1.0 };
    // Each side that has bars has room for their numbers.
    let start = left + if least < 0.0 { room } else { 0.0 };
    let end = RIGHT - if most > 0.0 { room } else { 0.0 };
    let at = |value: f64| start + (value - least) / span * (end - start);
    for (place, bar) in group.bars.iter().enumerate() {
        let middle = top + TITLE + ROW * (rows(place) + 0.5);
        canvas.text(&bar.label, [left - BESIDE, middle], SMALL, Align::Right)?;
        if !bar.value.is_finite() {
            continue;
        }
        let (from, to) = (at(bar.value.min(0.0)), at(bar.value.max(0.0)));
        let fill = colour(if bar.value < 0.0 { BELOW } else { ABOVE });
        canvas.rectangle([from, middle - 0.5 * BAR, to, middle + 0.5 * BAR], fill)?;
        let text = number(bar.value);
        if bar.value < 0.0 {
            canvas.text(&text, [from - BESIDE, middle], SMALL, Align::Right)?;
        } else {
            canvas.text(&text, [to + BESIDE, middle], SMALL, Align::Left)?;
        }
    }
    let bottom = top + TITLE + ROW * rows(group.bars.len());
    canvas.line(&[[at(0.0), top + TITLE], [at(0.0), bottom]], INK, 1.0, &[])?;
    let middle = 0.5 * (left + RIGHT);
    canvas.text(&group.axis, [middle, bottom + 0.5 * TITLE], SMALL, Align::Centre)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bar_has_its_name_and_its_number() {
        let bar = |label: &str, value| Bar { label: label.into(), value };
        let group = BarGroup {
            title: "Mode at 219.8 Hz".into(),
            axis: "Change [1/s]".into(),
            bars: vec![bar("damping.beta", -0.25), bar("module[1].k6", 1.5e-7), bar("m", f64::NAN)],
        };
        let bars = Bars { title: "set1".into(), groups: vec![group] };
        let svg = canvas::svg_text(&bars).unwrap();
        for text in ["set1", "Mode at 219.8 Hz", "damping.beta", "−0.25", "1.5e−7", "module[1].k6"]
        {
            assert!(svg.contains(text), "{text}");
        }
        assert!(Bars::default().write(Path::new("none.svg")).is_err());
    }
}
