//! How many samples there are, in which passes.

use std::time::Duration;

use crate::Arguments;

/// How many samples there are, in which passes over the picture. Each pass has points of its own; the spread between passes
/// gives the error.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Plan {
    /// Passes of the given numbers of samples.
    Samples(Vec<u64>),
    /// Passes that double, until the time is over.
    Time(Duration),
    /// Passes that double, until the error is below this part of the mean.
    Noise(f64),
}

/// The most samples of a pass where their number is not known beforehand.
const MOST: u64 = 64;

/// The fewest passes that tell of an error.
const FEWEST: u64 = 4;

impl Plan {
    pub(crate) fn new(arguments: &Arguments, of_the_file: u64) -> Self {
        if let Some(seconds) = arguments.time {
            return Self::Time(Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX));
        }
        if let Some(noise) = arguments.noise {
            return Self::Noise(noise);
        }
        let spp = arguments.spp.unwrap_or(of_the_file);
        let replicates = arguments.replicates.unwrap_or(match arguments.std_error {
            Some(_) => 16,
            None => 2,
        });
        let replicates = replicates.min(spp);
        let of_replicate = |number: u64| spp / replicates + u64::from(number < spp % replicates);
        let samples = (0..replicates).map(of_replicate);
        Self::Samples(match arguments.points.are_powers_of_two() {
            true => samples.flat_map(powers).collect(),
            false => samples.collect(),
        })
    }

    /// How many samples the next pass has; `None` if there is none. `done` is how many samples there are in `passes` passes
    /// that took `seconds` so far, and `noise` their error relative to the mean.
    pub(crate) fn next(
        &self,
        passes: u64,
        done: u64,
        seconds: f64,
        noise: Option<f64>,
    ) -> Option<u64> {
        // A power of two, so that passes are nets.
        let doubled = 1 << done.clamp(1, MOST).ilog2();
        match self {
            Self::Samples(samples) => samples.get(usize::try_from(passes).ok()?).copied(),
            Self::Noise(target) => {
                let reached = passes >= FEWEST && noise.is_some_and(|noise| noise <= *target);
                (!reached).then_some(doubled)
            }
            Self::Time(time) => {
                let left = time.as_secs_f64() - seconds;
                if passes == 0 {
                    return Some(1);
                }
                let fitting = left * done as f64 / seconds.max(1e-9);
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
        let fraction = match self {
            Self::Samples(samples) => done / samples.iter().sum::<u64>() as f64,
            Self::Time(time) => seconds / time.as_secs_f64(),
            Self::Noise(target) => (target / noise?).powi(2),
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
