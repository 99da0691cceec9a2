//! The claims on Fig. 4, each judged from the motion itself.

use super::claims::{claim, half_digit, is_about, unknown};
use super::measures::{
    Growth, Turns, first_plateau, growth, half_ranges, spread, strongest, turns,
};
use super::motion::{INTERVAL, Motion};
use amontons::Error;
use amontons::contact::ContactState::{self, Slide, Stick};
use amontons::model::LumpedModel;
use amontons::scene::Scene;
use amontons::stability::Spectrum;
use amontons_analysis::spectral::{Line, lines};
use amontons_analysis::study::Watch;
use amontons_pictures::report::Claim;
use nalgebra::Complex;
use std::f64::consts::TAU;

/// Frequencies of the modes that couple without friction, Hz: a line between them belongs to the pair.
const PAIRS: [[f64; 2]; 2] = [[163.90, 186.56], [215.24, 225.79]];
/// End of the observation of the last orbit, at which it is pushed, and duration of the observation after the push, s.
const END: f64 = 8.0;
const AFTER_PUSH: f64 = 2.0;
/// Beginning of the fit of the first growth, when other modes have decayed, s.
const FIRST_FROM: f64 = 0.3;
/// The paper's time of the second growth, s.
const SECOND: [f64; 2] = [1.0, 3.0];
/// The paper's beginning of the band at 220 Hz, s.
const BAND: f64 = 0.6;
/// Lengths of the windows for the first and the second growth, s; lines further apart than 4 / window are resolved.
const WINDOWS: [f64; 2] = [0.05, 0.1];
/// Limit of the relative difference between a fitted rate and an eigenvalue that belong to the same growth.
const SAME_RATE: f64 = 0.01;
/// Limit of the deviation of the logarithm of an amplitude from a straight line for exponential growth.
const STRAIGHT: f64 = 0.05;
/// An orbit is reached when half ranges, period by period, stay within this part of their mean for [`STAYS`] (s).
const REACHED: f64 = 0.05;
const STAYS: f64 = 0.5;
/// Limit of the relative deviation from their mean of half ranges of a stable orbit, over pieces of [`PIECE`] (s).
const STEADY: f64 = 0.01;
const PIECE: f64 = 0.1;

/// The states of both contacts, their share of the time, and the eigenvalue of the lower pair that decays least.
type Share = ([ContactState; 2], f64, Option<Complex<f64>>);

/// The quantities measured from the motion of Fig. 4.
struct Measured {
    /// The growing mode of uniform sliding.
    sliding: Option<Complex<f64>>,
    /// The first growth, until a contact first changes its state.
    first: Option<Growth>,
    first_change: Option<f64>,
    /// Time at which an orbit is first reached, s.
    reached: Option<f64>,
    /// Turns of sticking and changes hidden between rows, from `reached` to the end of [`SECOND`].
    turns: Turns,
    hidden: u64,
    /// The growth of the strongest line of the lower pair within [`SECOND`].
    second: Option<Growth>,
    /// The contact states within [`SECOND`].
    shares: Vec<Share>,
    /// The strongest lines of pieces from [`BAND`] to the end of [`SECOND`], Hz.
    band: Vec<Option<f64>>,
    /// The amplitude of the upper line at [`BAND`] against that of the first orbit.
    level: f64,
    /// Half ranges of the first orbit, of the last one before a push and of that after it, m.
    orbits: [Vec<f64>; 3],
    /// The lines of the last second before the push, strongest first.
    last: Vec<Line>,
}

/// The claims on a scene of two contacts; `None` where the watch ended the work.
///
/// # Errors
/// Returns an error if the scene is invalid or the run fails.
pub fn claims(scene: &Scene, watch: Watch<'_>) -> Result<Option<Vec<Claim>>, Error> {
    let mut motion = Motion::new(scene)?;
    let is_recorded = motion.record(END, watch)? && {
        motion.push();
        motion.record(END + AFTER_PUSH, watch)?
    };
    if !is_recorded {
        return Ok(None);
    }
    let measured = measure(&motion, &LumpedModel::from(scene))?;
    let mut claims = of_the_first_growth(&measured);
    claims.extend(of_the_band(&measured));
    claims.extend(of_the_second_growth(&measured));
    claims.push(of_the_last_orbit(&measured));
    Ok(Some(claims))
}

fn measure(motion: &Motion, model: &LumpedModel) -> Result<Measured, Error> {
    let linear = model.linear()?;
    let spectrum = |states: &[ContactState; 2]| Spectrum::of(linear, states);
    let sliding = spectrum(&[Slide; 2])?.fastest_growing().filter(|value| value.re > 0.0);
    let first_change = motion.first_change();
    let hz = sliding.map_or(PAIRS[1][0], |value| value.im / TAU);
    let first_end = first_change.unwrap_or(SECOND[0]);
    let first = growth(motion.between(FIRST_FROM, first_end), INTERVAL, hz, WINDOWS[0]);
    let period = (1.0 / (hz * INTERVAL)).round() as usize;
    let ranges = half_ranges(&motion.history, period);
    let stays = (STAYS / (period as f64 * INTERVAL)) as usize;
    let begins = first_change.map_or(0, |time| (time / (period as f64 * INTERVAL)) as usize);
    let plateau = first_plateau(&ranges[begins.min(ranges.len())..], stays, REACHED);
    let reached = plateau.map(|place| (begins + place) as f64 * period as f64 * INTERVAL);
    let from = reached.unwrap_or(SECOND[0]);
    let sticks = |states: &[ContactState; 2]| states.map(|state| state == Stick);
    let rows: Vec<[bool; 2]> = motion.states_between(from, SECOND[1]).iter().map(sticks).collect();
    let during = motion.between(SECOND[0], SECOND[1]);
    // The line is strongest at the end of the growth.
    let line = strongest(motion.between(SECOND[1] - 1.0, SECOND[1]), INTERVAL, PAIRS[0]);
    let mut shares: Vec<Share> = Vec::new();
    let states = motion.states_between(SECOND[0], SECOND[1]);
    for row in states {
        match shares.iter_mut().find(|(known, ..)| known == row) {
            Some((_, share, _)) => *share += 1.0 / states.len() as f64,
            None => shares.push((*row, 1.0 / states.len() as f64, lower_mode(&spectrum(row)?))),
        }
    }
    let pieces = motion.between(BAND, SECOND[1]).chunks_exact(Motion::row(2.0 * PIECE));
    let amplitude = |time: f64| {
        let around = motion.between(time - WINDOWS[0], time + WINDOWS[0]);
        let seen = growth(around, INTERVAL, hz, 0.5 * WINDOWS[0]);
        seen.map_or(f64::NAN, |seen| (seen.amplitude[0] * seen.amplitude[1]).sqrt())
    };
    let orbit = |from: f64, to: f64| half_ranges(motion.between(from, to), Motion::row(PIECE));
    Ok(Measured {
        sliding,
        first,
        first_change,
        reached,
        turns: turns(&rows),
        hidden: motion.hidden_changes(from, SECOND[1]),
        second: line.and_then(|line| growth(during, INTERVAL, line, WINDOWS[1])),
        shares,
        band: pieces.map(|piece| strongest(piece, INTERVAL, [20.0, 1000.0])).collect(),
        level: amplitude(BAND) / amplitude(SECOND[0] + 0.5 * STAYS),
        orbits: [
            orbit(from, from + STAYS),
            orbit(END - 1.0, END),
            orbit(END + AFTER_PUSH - 0.5, END + AFTER_PUSH),
        ],
        last: lines(motion.between(END - 1.0, END), INTERVAL, 0.01).lines,
    })
}

/// The eigenvalue of the lower pair that decays least, or grows most.
fn lower_mode(spectrum: &Spectrum) -> Option<Complex<f64>> {
    let inside = |value: &&Complex<f64>| (PAIRS[0][0]..=PAIRS[0][1]).contains(&(value.im / TAU));
    spectrum.oscillating.iter().filter(inside).max_by(|a, b| a.re.total_cmp(&b.re)).copied()
}

fn of_the_first_growth(measured: &Measured) -> Vec<Claim> {
    let Measured { sliding, first, first_change, reached, turns, .. } = measured;
    let ratio = first.zip(*sliding).map(|(first, value)| first.rate / value.re - 1.0);
    let of_mode = sliding.map_or("no mode of uniform sliding grows".to_owned(), |value| {
        format!(
            "the growing mode of uniform sliding has {:.2} Hz and a growth rate of {:+.2} 1/s",
            value.im / TAU,
            value.re
        )
    });
    let first_told = first.map_or("no growth was seen".to_owned(), |first| {
        format!(
            "the amplitude grows at {:.2} Hz with {:+.2} 1/s from {FIRST_FROM} s until a contact first sticks; its \
             logarithm is straight to {:.4}",
            first.frequency, first.rate, first.bend
        )
    });
    let earlier = sliding.map_or(f64::NAN, |value| std::f64::consts::LN_10 / value.re);
    vec![
        claim(
            "A small perturbation of Set 1 at µ = 1.96 grows exponentially, as uniform sliding is unstable.",
            format!(
                "{first_told}; {of_mode} (holds if the rates agree within {} % and the logarithm is straight to \
                 {STRAIGHT})",
                100.0 * SAME_RATE
            ),
            first_change.is_some()
                && ratio.is_some_and(|ratio| ratio.abs() <= SAME_RATE)
                && first.is_some_and(|first| first.bend <= STRAIGHT),
            None,
        ),
        claim(
            "The small perturbation of Set 1 reaches a first orbit at about 1 s.",
            format!(
                "{}, after the push of 1e-7 m/s of set1, and {earlier:.3} s earlier after a push ten times as \
                 large (holds from 0.5 to 1.5 s; the orbit is reached when amplitudes, period by period, stay within \
                 {} % for {STAYS} s)",
                reached.map_or("no orbit is reached".to_owned(), |time| format!(
                    "the orbit is reached at {time:.2} s"
                )),
                100.0 * REACHED
            ),
            reached.is_some_and(|time| is_about(time, "1")),
            Some("the time depends on how small the push is, which the paper does not print"),
        ),
        claim(
            "On the first orbit the two modules stick in turn.",
            format!(
                "from {:.2} to {} s contacts stick {} times, {} times the same contact twice in a row, and both together in \
                 {} rows, {INTERVAL} s apart; {} changes of state lie between rows (holds if the last three are 0)",
                reached.unwrap_or(SECOND[0]),
                SECOND[1],
                turns.count,
                turns.repeated,
                turns.together,
                measured.hidden
            ),
            reached.is_some()
                && turns.count >= 10
                && turns.repeated == 0
                && turns.together == 0
                && measured.hidden == 0,
            None,
        ),
    ]
}

fn of_the_band(measured: &Measured) -> Vec<Claim> {
    let known: Vec<f64> = measured.band.iter().copied().flatten().collect();
    let least = known.iter().copied().fold(f64::INFINITY, f64::min);
    let most = known.iter().copied().fold(0.0, f64::max);
    let holds = !known.is_empty()
        && known.len() == measured.band.len()
        && [least, most].iter().all(|hz| is_about(*hz, "220"))
        && measured.first.is_some_and(|first| first.rate > 0.0);
    vec![
        claim(
            "From 0.6 s on the spectrogram has a band at about 220 Hz.",
            format!(
                "in each piece of {} s from {BAND} to {} s the strongest line lies between {least:.2} and {most:.2} Hz \
                 (holds within {} Hz of 220 Hz)",
                2.0 * PIECE,
                SECOND[1],
                half_digit("220")
            ),
            holds,
            None,
        ),
        unknown(
            "The band at about 220 Hz begins at 0.6 s.",
            format!(
                "it grows from the beginning; at {BAND} s it is {:.0} dB below that of the first orbit",
                -20.0 * measured.level.log10()
            ),
            "the range of colours of the paper's spectrogram, which its text does not give: the band becomes visible \
             when it leaves the lowest colour",
        ),
    ]
}

fn of_the_second_growth(measured: &Measured) -> Vec<Claim> {
    let Measured { second, shares, .. } = measured;
    let told = second.map_or("no second line grows".to_owned(), |second| {
        format!(
            "from {} to {} s the amplitude at {:.2} Hz grows from {:.2e} to {:.2e} m with {:+.2} 1/s; its logarithm is \
             straight to {:.4}",
            SECOND[0],
            SECOND[1],
            second.frequency,
            second.amplitude[0],
            second.amplitude[1],
            second.rate,
            second.bend
        )
    });
    let orbits = measured.orbits.each_ref();
    let [first, last, pushed] =
        orbits.map(|ranges| ranges.iter().sum::<f64>() / ranges.len() as f64);
    let returns = (pushed / last - 1.0).abs();
    vec![
        claim(
            "The first orbit is not stable: a second exponential growth follows.",
            format!(
                "{told} (holds if it grows tenfold and the logarithm is straight to {STRAIGHT})"
            ),
            second.is_some_and(|second| {
                second.amplitude[1] >= 10.0 * second.amplitude[0] && second.bend <= STRAIGHT
            }),
            None,
        ),
        claim(
            "The second growth leads to another orbit, which is stable.",
            format!(
                "half ranges of the first orbit are {first:.3e} m; from {} to {END} s they are {last:.3e} m, with a \
                 spread of {:.1e}; {AFTER_PUSH} s after a push of 1 % of the largest velocity they differ by {returns:.1e} (holds \
                 if the last orbit is another one and both are below {STEADY})",
                END - 1.0,
                spread(&measured.orbits[1])
            ),
            (last / first - 1.0).abs() > 10.0 * STEADY
                && spread(&measured.orbits[1]) <= STEADY
                && returns <= STEADY,
            None,
        ),
        claim(
            "The second band lies at about 180 Hz.",
            format!(
                "its frequency is {:.2} Hz (holds within {} Hz)",
                second.map_or(f64::NAN, |second| second.frequency),
                half_digit("180")
            ),
            second.is_some_and(|second| is_about(second.frequency, "180")),
            Some(
                "not known; the paper itself gives about 168 Hz for the mode that it regards as the origin, and about \
                 170 Hz for this band in the end",
            ),
        ),
        origin(second.as_ref(), shares),
    ]
}

fn origin(second: Option<&Growth>, shares: &[Share]) -> Claim {
    let mean = |wanted: &dyn Fn(usize) -> bool| {
        let stuck = |states: &[ContactState; 2]| states.iter().filter(|s| **s == Stick).count();
        let parts = shares.iter().filter(|(states, ..)| wanted(stuck(states)));
        parts.fold((0.0, Complex::new(0.0, 0.0)), |(all, sum), (_, share, value)| {
            let value = value.unwrap_or(Complex::new(f64::NAN, f64::NAN));
            (all + share, sum + value * *share)
        })
    };
    let (share, stuck) = mean(&|count| count == 1);
    let (rest, sliding) = mean(&|count| count == 0);
    let all = mean(&|_| true).1;
    let off = second.map_or(f64::NAN, |second| second.frequency - all.im / TAU);
    claim(
        "The second growth comes from the states with one contact stuck.",
        format!(
            "from {} to {} s one contact sticks for {:.0} % of the time and none for {:.0} %. The mode of the lower pair has \
             {:+.2} 1/s at {:.2} Hz in the first and {:+.2} 1/s at {:.2} Hz in the second; their mean over time is {:+.2} 1/s \
             at {:.2} Hz, {:.2} Hz from that of the growth (holds if only the stuck states grow, so does the mean, and the \
             frequencies agree within 0.5 Hz)",
            SECOND[0],
            SECOND[1],
            100.0 * share,
            100.0 * rest,
            stuck.re / share,
            stuck.im / share / TAU,
            sliding.re / rest,
            sliding.im / rest / TAU,
            all.re,
            all.im / TAU,
            off.abs()
        ),
        second.is_some_and(|second| second.rate > 0.0)
            && stuck.re > 0.0
            && sliding.re < 0.0
            && all.re > 0.0
            && off.abs() <= 0.5,
        None,
    )
}

fn of_the_last_orbit(measured: &Measured) -> Claim {
    let told: Vec<String> = measured
        .last
        .iter()
        .take(4)
        .map(|line| format!("{:.2} Hz (±{:.2e} m)", line.frequency, line.amplitude))
        .collect();
    let has = |printed: &str| measured.last.iter().any(|line| is_about(line.frequency, printed));
    claim(
        "In the limit cycle frequencies of about 170 and 215 Hz appear together.",
        format!(
            "strongest lines from {} to {END} s: {} (holds if there are lines within {} Hz of 170 and {} Hz of 215 Hz)",
            END - 1.0,
            told.join(", "),
            half_digit("170"),
            half_digit("215")
        ),
        has("170") && has("215"),
        Some(
            "both bands are there, but the upper one is not at 215 Hz, which is mode 5 without friction; the paper's own \
             Table 2 has 219.38 Hz for the mode that grows in sliding, and 217.45 Hz with one contact stuck",
        ),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use amontons_pictures::report::Verdict;

    fn judged(name: &str, values: &[(&str, f64)]) -> Vec<(String, Verdict, String)> {
        let (scene, _) = super::super::scene(name, values).unwrap();
        let claims = claims(&scene, Watch::IDLE).unwrap().unwrap();
        claims.into_iter().map(|claim| (claim.paper, claim.verdict, claim.found)).collect()
    }

    /// Claims that cannot fail would prove nothing: neither rest nor the large motion of Set 2 shows what Fig. 4 shows.
    #[test]
    fn no_claim_on_fig_4_holds_where_nothing_grows_or_all_is_one_orbit() {
        for push in [1e-4, 0.3] {
            for (paper, verdict, found) in judged("set2", &[("initial.module[1].v2", push)]) {
                assert!(!verdict.holds(), "{push}: {paper} {found}");
            }
        }
    }
}
