//! How many samples there are, in which passes.

use std::time::Duration;

use crate::Arguments;
use crate::points::Points;

/// How many samples there are, in which passes over the picture. Each pass has points of its own; the spread between passes
/// gives the error.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Plan {
    passes: Passes,
    /// Points in each of the two sets of one pixel of nine that decide beforehand how all samples are dealt to the pixels; 0 if there are none.
    pub(crate) pilot: u64,
}

#[derive(Clone, Debug, PartialEq)]
enum Passes {
    /// Passes of the given numbers of samples.
    Samples(Vec<u64>),
    /// Passes that double, until the time is over.
    Time(Duration),
    /// Passes that double, until the error is below this part of the mean.
    Noise(f64),
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
        if let Some(seconds) = arguments.time {
            return Ok(Self {
                passes: Passes::Time(Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX)),
                pilot: adaptive(PILOT),
            });
        }
        if let Some(noise) = arguments.noise {
            return Ok(Self {
                passes: Passes::Noise(noise),
                pilot: adaptive(PILOT),
            });
        }
        let spp = arguments.spp.unwrap_or(of_the_file);
        // A power of two for nets. Two sets in one pixel of nine: less than a thirtieth of all samples.
        let pilot = adaptive(1 << (spp / 8).clamp(1, MOST_OF_PILOT).ilog2());
        let spp = spp - (2 * pilot).div_ceil(9);
        if spp == 0 {
            return Err("--adaptive needs at least 2 samples a pixel".to_owned());
        }
        let replicates = arguments.replicates.unwrap_or(match arguments.std_error {
            Some(_) => 16,
            None => 2,
        });
        let replicates = replicates.min(spp);
        let of_replicate = |number: u64| spp / replicates + u64::from(number < spp % replicates);
        let samples = (0..replicates).map(of_replicate);
        Ok(Self {
            passes: Passes::Samples(match points.are_powers_of_two() {
                true => samples.flat_map(powers).collect(),
                false => samples.collect(),
            }),
            pilot,
        })
    }

    /// Whether there is time left after so much.
    pub(crate) fn has_time(&self, spent: Duration) -> bool {
        match &self.passes {
            Passes::Time(time) => spent < *time,
            Passes::Samples(_) | Passes::Noise(_) => true,
        }
    }

    /// How many samples the next pass has; `None` if there is none. `done` is how many samples there are in `passes` passes
    /// that took `rendering` of the `seconds` so far, and `noise` their error relative to the mean.
    pub(crate) fn next(
        &self,
        passes: u64,
        done: u64,
        [seconds, rendering]: [f64; 2],
        noise: Option<f64>,
    ) -> Option<u64> {
        // A power of two, so that passes are nets.
        let doubled = 1 << done.clamp(1, MOST).ilog2();
        match &self.passes {
            Passes::Samples(samples) => samples.get(usize::try_from(passes).ok()?).copied(),
            Passes::Noise(target) => {
                let reached = passes >= FEWEST && noise.is_some_and(|noise| noise <= *target);
                (!reached).then_some(doubled)
            }
            Passes::Time(time) => {
                let left = time.as_secs_f64() - seconds;
                if passes == 0 {
                    return Some(1);
                }
                let fitting = left * done as f64 / rendering.max(1e-9);
                let mut samples = doubled;
                while samples > 1 && samples as f64 > fitting {
                    samples /= 2;
                }
                (fitting >= 1.0).then_some(samples)
            }
        }
    }

    /// How much of the work is done, in `[0, 1]`, if that can be told.
    pub(crate) fn fraction(&self, done: f64, seconds: f64, noise: Option<f64>) -> Option<f64> {
        let fraction = match &self.passes {
            Passes::Samples(samples) => done / samples.iter().sum::<u64>() as f64,
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
