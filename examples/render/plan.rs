//! How many samples there are, in which passes.

use std::ops::Range;
use std::time::Duration;

use crate::Arguments;
use crate::points::Points;

/// How many samples there are, in which passes over the picture, whose spread gives the error.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Plan {
    passes: Passes,
    /// Whether passes of which only the time is known go on with the points of those before.
    goes_on: bool,
    /// Points in each of the two sets of one pixel of nine that decide beforehand how all samples are dealt to the pixels; 0 if there are none.
    pub(crate) pilot: u64,
}

#[derive(Clone, Debug, PartialEq)]
enum Passes {
    Known(Vec<Pass>),
    /// Passes that double, until the time is over.
    Time(Duration),
    /// Passes that double, until the error is below this part of the mean.
    Noise(f64),
}

/// A part of a set of points for each pixel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Pass {
    /// The number of the set: sets of other numbers are independent of it.
    pub(crate) set: u64,
    /// How many points it has, in the mean over the pixels.
    pub(crate) points: u64,
    /// Which of them.
    pub(crate) part: Range<u64>,
}

impl Pass {
    /// All points of a set.
    fn whole(set: u64, points: u64) -> Self {
        Self {
            set,
            points,
            part: 0..points,
        }
    }

    /// How many samples it has, in the mean over the pixels.
    pub(crate) fn samples(&self) -> u64 {
        self.part.end - self.part.start
    }

    /// Its points in a pixel whose set has `points` of them.
    pub(crate) fn of(&self, points: u64) -> Range<u64> {
        let at = |end: u64| {
            let place = u128::from(points) * u128::from(end) / u128::from(self.points);
            u64::try_from(place).expect("no more than there are")
        };
        at(self.part.start)..at(self.part.end)
    }

    /// The two halves of a set, of which the first has no points more than the second.
    fn halves(set: u64, points: u64) -> [Self; 2] {
        let middle = points / 2;
        [0..middle, middle..points].map(|part| Self { set, points, part })
    }
}

/// The most samples of a pass where their number is not known beforehand.
const MOST: u64 = 64;

/// Points of a set of the pilot where the number of samples is not known beforehand, and the most where it is.
const PILOT: u64 = 16;
const MOST_OF_PILOT: u64 = 64;

/// The fewest passes that tell of an error.
const FEWEST: u64 = 4;

impl Plan {
    pub(crate) fn new(
        arguments: &Arguments,
        points: Points,
        of_the_file: u64,
    ) -> Result<Self, String> {
        let adaptive = |pilot| if arguments.adaptive { pilot } else { 0 };
        // Errors of pixels are those of independent sets.
        let independent = arguments.std_error.is_some() || arguments.replicates.is_some();
        let plan = |passes, pilot| Self {
            passes,
            goes_on: points.go_on() && !independent && !arguments.adaptive,
            pilot,
        };
        if let Some(seconds) = arguments.time {
            let time = Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX);
            return Ok(plan(Passes::Time(time), adaptive(PILOT)));
        }
        if let Some(noise) = arguments.noise {
            return Ok(plan(Passes::Noise(noise), adaptive(PILOT)));
        }
        let spp = arguments.spp.unwrap_or(of_the_file);
        // A power of two for nets. Two sets in one pixel of nine: less than a thirtieth of all samples.
        let pilot = adaptive(1 << (spp / 8).clamp(1, MOST_OF_PILOT).ilog2());
        let spp = spp - (2 * pilot).div_ceil(9);
        if spp == 0 {
            return Err("--adaptive needs at least 2 samples a pixel".to_owned());
        }
        let passes = if independent || !points.come_in_parts() {
            let replicates = arguments.replicates.unwrap_or(match arguments.std_error {
                Some(_) => 16,
                None => 2,
            });
            let replicates = replicates.min(spp);
            let of_replicate =
                |number: u64| spp / replicates + u64::from(number < spp % replicates);
            let samples = (0..replicates).map(of_replicate);
            let samples: Vec<u64> = match points.are_powers_of_two() {
                true => samples.flat_map(powers).collect(),
                false => samples.collect(),
            };
            let whole = |(set, points)| Pass::whole(set, points);
            (0..).zip(samples).map(whole).collect()
        } else {
            // Of an adaptive picture each pixel has an eighth of the mean or more, which is to have two halves.
            let least = if arguments.adaptive { 16 } else { 2 };
            let mut sets = match points.are_powers_of_two() {
                true => powers(spp).collect(),
                false => vec![spp],
            }
            .into_iter();
            let first = sets.next().unwrap_or(spp);
            let first = match first < least {
                true => vec![Pass::whole(0, first)],
                false => Pass::halves(0, first).into(),
            };
            let others = (1..).zip(sets);
            let others = others.map(|(set, points)| Pass::whole(set, points));
            first.into_iter().chain(others).collect()
        };
        Ok(plan(Passes::Known(passes), pilot))
    }

    /// Whether there is time left after so much.
    pub(crate) fn has_time(&self, spent: Duration) -> bool {
        match &self.passes {
            Passes::Time(time) => spent < *time,
            Passes::Known(_) | Passes::Noise(_) => true,
        }
    }

    /// The next pass; `None` if there is none. `done` is how many samples there are in `passes` passes
    /// that took `rendering` of the `seconds` so far, and `noise` their error relative to the mean.
    pub(crate) fn next(
        &self,
        passes: u64,
        done: u64,
        [seconds, rendering]: [f64; 2],
        noise: Option<f64>,
    ) -> Option<Pass> {
        // A power of two, so that passes are nets.
        let doubled = 1 << done.clamp(1, MOST).ilog2();
        match &self.passes {
            Passes::Known(known) => known.get(usize::try_from(passes).ok()?).cloned(),
            Passes::Noise(target) => {
                let reached = passes >= FEWEST && noise.is_some_and(|noise| noise <= *target);
                (!reached).then(|| Pass::whole(passes, doubled))
            }
            Passes::Time(time) => {
                let left = time.as_secs_f64() - seconds;
                let fitting = left * done as f64 / rendering.max(1e-9);
                let mut samples = doubled;
                while samples > 1 && samples as f64 > fitting {
                    samples /= 2;
                }
                (passes == 0 || fitting >= 1.0).then(|| match self.goes_on {
                    true => Pass {
                        set: 0,
                        points: done + samples,
                        part: done..done + samples,
                    },
                    false => Pass::whole(passes, samples),
                })
            }
        }
    }

    /// How much of the work is done, in `[0, 1]`, if that can be told.
    pub(crate) fn fraction(&self, done: f64, seconds: f64, noise: Option<f64>) -> Option<f64> {
        let fraction = match &self.passes {
            Passes::Known(passes) => done / passes.iter().map(Pass::samples).sum::<u64>() as f64,
            Passes::Time(time) => seconds / time.as_secs_f64(),
            Passes::Noise(target) => (target / noise?).powi(2),
        };
        Some(fraction.clamp(0.0, 1.0))
    }
}

/// The powers of two that add up to a number, the largest first.
fn powers(number: u64) -> impl Iterator<Item = u64> {
    (0..u64::BITS)
        .rev()
        .map(|bit| 1 << bit)
        .filter(move |power| number & power != 0)
}
