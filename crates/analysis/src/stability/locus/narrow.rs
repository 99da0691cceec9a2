//! Values of a parameter between those looked at, at which two modes have merged, or one grows, though that shows at none of
//! the neighbours.
//!
//! Two roots near each other are z = s ± √d. Half of their sum s and the square d of half of their difference are smooth
//! functions of the parameter where the roots are not. A parabola through d at three neighbouring values foretells where d comes
//! nearest to zero; there the roots are found, the parabola is renewed, and so on, until the two modes have changed, or until
//! the error of the parabola leaves no room for that. One real σ on its way to zero and back is sought in the same way.
//!
//! | two roots | d | a change |
//! | --- | --- | --- |
//! | σ of a state without single dampers | real | of its sign: the two merge, or part |
//! | λ | complex | of the number of modes above a growth rate |
//!
//! The roots must be followed from value to value, so that d is that of the same two modes.

use super::Root;
use amontons::Error;
use nalgebra::Complex;

/// The most evaluations for one approach.
const MOST_STEPS: usize = 24;
/// The distance from zero of what may pass through it, by its last fall; for a parabola it is a quarter.
const MOST_FALLS: f64 = 2.0;
/// The error of a parabola is taken to be this many times as large as the next term of the series.
const DOUBT: f64 = 4.0;
/// The first evaluation is at least this part of the distance to a neighbour away from known values, so that it shows the
/// error of the parabola.
const APART: f64 = 0.05;
/// Values closer than this part of the distance of neighbours are not told apart.
const RESOLUTION: f64 = 1e-13;
/// Roots closer than this part of themselves are double ones, whichever is which.
pub(super) const DOUBLE: f64 = 1e-8;
/// Growth by less than this part of |λ| is not sought.
const LEAST_GROWTH: f64 = 1e-9;

/// The roots at a value of the parameter, one for each branch.
pub(crate) type Point = (f64, Vec<Root>);

/// A search between the values of a trace.
pub(crate) struct Between<'a> {
    /// The roots at a value.
    pub(crate) evaluate: &'a dyn Fn(f64) -> Result<Vec<Root>, Error>,
    /// `true` if σ can merge; then mergings are sought, and else changes of growth.
    pub(crate) merge: bool,
    /// The growth rate that counts, 1/s.
    pub(crate) level: f64,
    /// `true` for roots that matter.
    pub(crate) is_watched: &'a dyn Fn(Root) -> bool,
}

/// The two roots that are compared.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    /// Two σ, both real or conjugates.
    Stiffness,
    /// Two λ that oscillate.
    Eigenvalues,
    /// One real σ.
    Single,
}

/// A property that the roots have at all known values.
#[derive(Clone, Copy, PartialEq)]
enum Pattern {
    /// The sign of d: σ are real where it is positive.
    Positive(bool),
    /// The number of roots above the growth rate.
    Growing(usize),
}

/// Two roots at a value.
#[derive(Clone, Copy)]
struct Pair {
    value: f64,
    /// Half of their sum.
    middle: Complex<f64>,
    /// The square of half of their difference.
    d: Complex<f64>,
    pattern: Pattern,
}

/// A polynomial of the second degree through three values: its terms in powers of the distance from the middle one.
#[derive(Clone, Copy)]
struct Parabola {
    from: f64,
    terms: [Complex<f64>; 3],
}

impl Parabola {
    fn through(three: &[Pair; 3], of: impl Fn(&Pair) -> Complex<f64>) -> Self {
        let [left, middle, right] = three;
        let [before, after] = [left, right].map(|it| it.value - middle.value);
        let slope = |it: &Pair, by: f64| (of(it) - of(middle)) / by;
        let [low, high] = [slope(left, before), slope(right, after)];
        let bend = (high - low) / (after - before);
        Self { from: middle.value, terms: [of(middle), low - bend * before, bend] }
    }

    fn at(&self, value: f64) -> Complex<f64> {
        let by = value - self.from;
        self.terms[0] + (self.terms[1] + self.terms[2] * by) * by
    }

    /// The value at which the derivative comes nearest to zero; not finite for a line.
    fn vertex(&self) -> f64 {
        let [_, slope, bend] = self.terms;
        self.from - (bend.conj() * slope).re / (2.0 * bend.norm_sqr())
    }
}

impl Between<'_> {
    /// Values, ascending, at which two modes are in another way than at the neighbours among the points.
    ///
    /// # Errors
    /// Returns an error if roots cannot be found.
    pub(crate) fn values(&self, points: &[Point]) -> Result<Vec<f64>, Error> {
        let mut found: Vec<f64> = Vec::new();
        let count = points.first().map_or(0, |point| point.1.len());
        for (place, three) in points.windows(3).enumerate() {
            let is_end = [place == 0, place + 3 == points.len()];
            // Equal parts of a structure have the same pairs of modes.
            let mut seen: Vec<Pair> = Vec::new();
            for i in 0..count {
                for j in i..count {
                    let kind = match (i == j, self.merge) {
                        (true, _) => Kind::Single,
                        (false, true) => Kind::Stiffness,
                        (false, false) => Kind::Eigenvalues,
                    };
                    let watched = |root: Root| (self.is_watched)(root);
                    if !watched(three[1].1[i]) && !watched(three[1].1[j]) {
                        continue;
                    }
                    let pair = |k: usize| {
                        let (value, roots) = &three[k];
                        self.pair(kind, *value, [roots[i], roots[j]])
                    };
                    let (Some(left), Some(middle), Some(right)) = (pair(0), pair(1), pair(2))
                    else {
                        continue;
                    };
                    let around = [left, middle, right];
                    if !is_approach(&around, is_end) || seen.iter().any(|it| is_same(it, &middle)) {
                        continue;
                    }
                    seen.push(middle);
                    found.extend(self.between(kind, around)?);
                }
            }
        }
        found.sort_by(f64::total_cmp);
        found.dedup();
        Ok(found)
    }

    /// Two roots as a pair; `None` if they are none of this kind.
    fn pair(&self, kind: Kind, value: f64, [a, b]: [Root; 2]) -> Option<Pair> {
        let apart = |a: Complex<f64>, b: Complex<f64>| {
            let half = 0.5 * (a - b);
            (0.5 * (a + b), half * half)
        };
        let ((middle, d), pattern) = match kind {
            Kind::Stiffness => {
                let both_real = a.is_real() && b.is_real();
                if !both_real && a.sigma != b.sigma.conj() {
                    return None;
                }
                (apart(a.sigma, b.sigma), Pattern::Positive(both_real))
            }
            Kind::Eigenvalues => {
                if a.lambda.im <= 0.0 || b.lambda.im <= 0.0 {
                    return None;
                }
                let growing = [a, b].iter().filter(|it| it.lambda.re > self.level).count();
                (apart(a.lambda, b.lambda), Pattern::Growing(growing))
            }
            Kind::Single => {
                let sigma = Complex::from(a.sigma.re);
                // Where dampers act σ has an imaginary part.
                if self.merge && !a.is_real() {
                    return None;
                }
                ((sigma, sigma), Pattern::Positive(sigma.re > 0.0))
            }
        };
        Some(Pair { value, middle, d, pattern })
    }

    /// The pair among the roots at a value that is nearest to the expected one.
    fn nearest(
        &self,
        kind: Kind,
        value: f64,
        expected: [Complex<f64>; 2],
    ) -> Result<Option<Pair>, Error> {
        let roots = (self.evaluate)(value)?;
        let mut best: Option<(f64, Pair)> = None;
        for (i, &a) in roots.iter().enumerate() {
            let others = if kind == Kind::Single { i..i + 1 } else { i + 1..roots.len() };
            for &b in &roots[others] {
                let Some(pair) = self.pair(kind, value, [a, b]) else { continue };
                let off = (pair.middle - expected[0]).norm_sqr() + (pair.d - expected[1]).norm();
                if best.as_ref().is_none_or(|best| off < best.0) {
                    best = Some((off, pair));
                }
            }
        }
        Ok(best.map(|best| best.1))
    }

    /// A value between three at which two roots are in another way than at these; `None` if there is no room for one.
    fn between(&self, kind: Kind, mut three: [Pair; 3]) -> Result<Option<f64>, Error> {
        let pattern = three[1].pattern;
        let [first, last] = [three[0].value, three[2].value];
        let is_within = |value: f64| first < value && value < last;
        // The error of the first parabola is unknown.
        let mut error = fall(&three);
        for step in 0..MOST_STEPS {
            let d = Parabola::through(&three, |it| it.d);
            let middle = Parabola::through(&three, |it| it.middle);
            let mut value = self.target(pattern, &d, &middle);
            if !is_within(value) || !self.has_room(pattern, &d, &middle, value, error) {
                return Ok(None);
            }
            if step == 0 {
                value = apart(value, &three);
            }
            let resolution = RESOLUTION * (last - first) + f64::EPSILON * value.abs();
            if three.iter().any(|it| (it.value - value).abs() <= resolution) {
                return Ok(None);
            }
            let Some(next) = self.nearest(kind, value, [middle.at(value), d.at(value)])? else {
                return Ok(None);
            };
            if next.pattern != pattern {
                return Ok(Some(value));
            }
            // The next term of the series, by the four values.
            let beside: f64 = three.iter().map(|it| value - it.value).product();
            let next_term = (next.d - d.at(value)) / beside;
            three = nearest_three(three, next);
            let renewed = Parabola::through(&three, |it| it.d);
            let vertex = renewed.vertex();
            let beside: f64 = three.iter().map(|it| vertex - it.value).product();
            error = DOUBT * (next_term * beside).norm();
        }
        Ok(None)
    }

    /// The value at which the two roots most likely are in another way.
    fn target(&self, pattern: Pattern, d: &Parabola, middle: &Parabola) -> f64 {
        let vertex = d.vertex();
        let Pattern::Growing(growing) = pattern else { return vertex };
        if growing == 1 || !vertex.is_finite() {
            return vertex;
        }
        // Damping that is not alike moves the extremum of growth beside the vertex.
        let width = (d.at(vertex).norm() / d.terms[2].norm()).sqrt();
        let sign = if growing == 0 { 1.0 } else { -1.0 };
        let height = |value: f64| sign * middle.at(value).re + d.at(value).sqrt().re.abs();
        let beside = [0.0, -0.25, 0.25, -0.5, 0.5, -1.0, 1.0, -2.0, 2.0];
        let values = beside.map(|part| vertex + part * width);
        values
            .into_iter()
            .reduce(|a, b| if height(b) > height(a) { b } else { a })
            .unwrap_or(vertex)
    }

    /// `true` if the roots may be in another way at a value, where d is known but for an error.
    fn has_room(
        &self,
        pattern: Pattern,
        d: &Parabola,
        middle: &Parabola,
        value: f64,
        error: f64,
    ) -> bool {
        match pattern {
            Pattern::Positive(is_positive) => {
                let sign = if is_positive { 1.0 } else { -1.0 };
                sign * d.at(value).re <= error
            }
            Pattern::Growing(growing) => {
                let middle = middle.at(value);
                let above = middle.re - self.level;
                let least = LEAST_GROWTH * middle.norm();
                let apart = d.at(value).sqrt().re.abs();
                let doubt = error.sqrt();
                match growing {
                    0 => above + apart + doubt > least,
                    1 => above.abs() + doubt > apart + least,
                    _ => above - apart - doubt < -least,
                }
            }
        }
    }
}

/// The largest fall of |d| from a neighbour to the middle.
fn fall(three: &[Pair; 3]) -> f64 {
    let [left, middle, right] = three.map(|it| it.d.norm());
    f64::max(left - middle, right - middle)
}

/// `true` if d may come to zero beside the middle of three values, at which the roots are alike in their pattern.
fn is_approach(three: &[Pair; 3], [is_first, is_last]: [bool; 2]) -> bool {
    let [left, middle, right] = three.map(|it| it.d.norm());
    if three.iter().any(|it| it.pattern != three[1].pattern) {
        return false;
    }
    let is_least = (middle <= left || is_first) && (middle <= right || is_last);
    let size = three[1].middle.norm_sqr();
    let is_double = left.max(right).max(middle) <= DOUBLE * DOUBLE * size;
    let fall = fall(three).abs().max((left - right).abs());
    is_least && !is_double && left.min(middle).min(right) <= MOST_FALLS * fall
}

/// `true` if two pairs at one value are equal but for rounding.
fn is_same(a: &Pair, b: &Pair) -> bool {
    let size = a.middle.norm();
    (a.middle - b.middle).norm() <= DOUBLE * size
        && (a.d - b.d).norm() <= DOUBLE * a.d.norm().max(DOUBLE * size * size)
}

/// A value beside one that is known.
fn apart(value: f64, three: &[Pair; 3]) -> f64 {
    let [left, middle, right] = three.map(|it| it.value);
    let near = if value < middle { middle - left } else { right - middle };
    let least = APART * near;
    let outer = if value < middle { left } else { right };
    if (value - middle).abs() < least {
        middle + least.copysign(value - middle)
    } else if (value - outer).abs() < least {
        outer + least.copysign(middle - outer)
    } else {
        value
    }
}

/// Of four values the three about the least |d|.
fn nearest_three(three: [Pair; 3], next: Pair) -> [Pair; 3] {
    let mut four = [three[0], three[1], three[2], next];
    four.sort_by(|a, b| a.value.total_cmp(&b.value));
    let sizes = four.map(|it| it.d.norm());
    let least = (0..4).min_by(|&a, &b| sizes[a].total_cmp(&sizes[b])).unwrap_or(1);
    let from = usize::from(least >= 2);
    [four[from], four[from + 1], four[from + 2]]
}

/// Roots at ascending values in the order of branches, by continuity; a list for each range of values in which their number
/// stays the same.
pub(crate) fn in_branches(points: Vec<Point>) -> Vec<Vec<Point>> {
    let mut found: Vec<Vec<Point>> = Vec::new();
    for (value, mut roots) in points {
        roots.sort_by(super::by_number);
        match found.last_mut() {
            Some(list) if list.last().is_some_and(|last| last.1.len() == roots.len()) => {
                let order = assign(&foretold(list, value), &roots);
                list.push((value, order.into_iter().map(|place| roots[place]).collect()));
            }
            _ => found.push(vec![(value, roots)]),
        }
    }
    found
}

/// σ at a value, by the line through the last two points.
fn foretold(points: &[Point], value: f64) -> Vec<Complex<f64>> {
    let (last_value, last) = &points[points.len() - 1];
    let Some((before_value, before)) = points.len().checked_sub(2).map(|place| &points[place])
    else {
        return last.iter().map(|root| root.sigma).collect();
    };
    let part = (value - last_value) / (last_value - before_value);
    let both = last.iter().zip(before);
    both.map(|(last, before)| {
        // Across a merging the rate is that of a root: it foretells nothing.
        let is_smooth = last.is_real() == before.is_real();
        last.sigma + (last.sigma - before.sigma) * if is_smooth { part } else { 0.0 }
    })
    .collect()
}

/// Assignment of found roots to branches, which no swap of two improves.
pub(super) fn assign(predicted: &[Complex<f64>], found: &[Root]) -> Vec<usize> {
    let cost = |branch: usize, place: usize| (predicted[branch] - found[place].sigma).norm_sqr();
    let mut order: Vec<usize> = (0..found.len()).collect();
    let mut improved = true;
    while improved {
        improved = false;
        for i in 0..order.len() {
            for j in i + 1..order.len() {
                let kept = cost(i, order[i]) + cost(j, order[j]);
                let swapped = cost(i, order[j]) + cost(j, order[i]);
                if swapped < kept * (1.0 - 1e-12) {
                    order.swap(i, j);
                    improved = true;
                }
            }
        }
    }
    order
}
