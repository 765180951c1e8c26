//! How many samples there are, in which passes.

use std::ops::Range;
use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::Arguments;
use crate::points::Points;

/// How many samples there are, in which passes over the picture, whose spread gives the error.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Plan {
    passes: Passes,
    /// Whether passes whose number is not known go on with the points of those before.
    goes_on: bool,
    /// Whether every pass is to tell of the errors of pixels.
    independent: bool,
    /// Points in each of the two sets of one pixel of nine that decide beforehand how all samples are dealt to the pixels; 0 if none
    /// do.
    pub(crate) pilot: u64,
}

#[derive(Clone, Debug, PartialEq)]
enum Passes {
    /// These.
    Known(Vec<Pass>),
    /// Passes that double, until the time is over.
    Time(Duration),
    /// Passes that double, until the error is below this part of the mean.
    Noise(f64),
}

/// A part of a set of points for each pixel.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub(crate) struct Pass {
    /// The number of the set: sets of other numbers are independent of it.
    pub(crate) set: u64,
    /// A number of points, in the mean over the pixels: all that it has, or those of a part.
    pub(crate) points: u64,
    /// Which of its points, where each pixel has `points` of them.
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

    /// Whether it is one that a plan can have made.
    pub(crate) fn is_sound(&self) -> bool {
        self.points > 0 && self.part.start <= self.part.end
    }

    /// How many samples it has, in the mean over the pixels.
    pub(crate) fn samples(&self) -> u64 {
        self.part.end - self.part.start
    }

    /// Which of its points in a pixel that has another number than [`points`](Self::points) of them.
    pub(crate) fn of(&self, points: u64) -> Range<u64> {
        let at = |end: u64| {
            let place = u128::from(points) * u128::from(end) / u128::from(self.points);
            u64::try_from(place).unwrap_or(u64::MAX)
        };
        at(self.part.start)..at(self.part.end)
    }

    /// The two halves of the first set, of which the first has no more points than the second. They are told by the points of the first, so
    /// that each pixel has as many in both, however many those are, if the number of all is even.
    fn halves(points: u64) -> [Self; 2] {
        let half = points / 2;
        [0..half, half..points].map(|part| Self {
            set: 0,
            points: half,
            part,
        })
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
            independent,
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
        // A power of two for nets. Two sets in one pixel of nine: a thirtieth of all samples, more if they are few.
        let pilot = adaptive(1 << (spp / 8).clamp(1, MOST_OF_PILOT).ilog2());
        let spp = spp - (2 * pilot).div_ceil(9);
        if spp == 0 {
            return Err("--adaptive needs at least 2 samples a pixel".to_owned());
        }
        let passes = if independent || !points.go_on() {
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
            match spp {
                1 => vec![Pass::whole(0, spp)],
                // Where a pilot deals the points, pixels are to have as many in both halves.
                _ if arguments.adaptive => Pass::halves(spp & !1).into(),
                _ => Pass::halves(spp).into(),
            }
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
                (!reached).then(|| self.after(passes, done, doubled))
            }
            Passes::Time(time) => {
                let left = time.as_secs_f64() - seconds;
                let fitting = left * done as f64 / rendering.max(1e-9);
                let mut samples = doubled;
                while samples > 1 && samples as f64 > fitting {
                    samples /= 2;
                }
                (passes == 0 || fitting >= 1.0).then(|| self.after(passes, done, samples))
            }
        }
    }

    /// The pass of so many samples that comes after `passes` passes with `done`.
    fn after(&self, passes: u64, done: u64, samples: u64) -> Pass {
        if self.goes_on {
            let points = done + samples;
            return Pass {
                set: 0,
                points,
                part: done..points,
            };
        }
        Pass::whole(passes, samples)
    }

    /// Whether the error is best told by a pass and all `done` before it, not by those before it one by one: where it has as many
    /// samples. Of smaller sets the errors are larger, for as many samples in all.
    pub(crate) fn is_half(&self, pass: &Pass, done: u64) -> bool {
        !self.independent && pass.samples() == done
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

#[cfg(test)]
mod tests {
    use clap::{Parser, ValueEnum};

    use super::*;

    fn plan(arguments: &[&str], points: Points) -> Plan {
        let arguments = ["render", "scene.xml"].iter().chain(arguments);
        Plan::new(&Arguments::parse_from(arguments), points, 16).unwrap()
    }

    fn known(plan: Plan) -> Vec<Pass> {
        match plan.passes {
            Passes::Known(passes) => passes,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn passes_have_all_samples_and_parts_all_points() {
        for &points in Points::value_variants() {
            for spp in (1..300).chain([1024, 12_345, 1 << 33]) {
                let text = spp.to_string();
                for more in [&[][..], &["--std-error", "x.exr"], &["--replicates", "3"]] {
                    let passes = known(plan(&[&["--spp", &text], more].concat(), points));
                    assert_eq!(passes.iter().map(Pass::samples).sum::<u64>(), spp);
                    assert!(passes.iter().all(|pass| pass.samples() > 0));
                    for (number, pass) in passes.iter().enumerate() {
                        let mut before = passes[..number].iter().rev();
                        let before = before.find(|other| other.set == pass.set);
                        let end = before.map_or(0, |other| other.part.end);
                        assert_eq!(pass.part.start, end, "{points} {spp}");
                        // Finite sets are not parted.
                        assert!(
                            points.go_on() || pass.part == (0..pass.points),
                            "{points} {spp}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn both_parts_of_an_adaptive_picture_have_as_many_points_in_every_pixel() {
        for spp in 2..600 {
            let plan = plan(
                &["--adaptive", "--spp", &spp.to_string()],
                Points::Rescrambled,
            );
            let pilot = (2 * plan.pilot).div_ceil(9);
            let passes = known(plan);
            let samples: u64 = passes.iter().map(Pass::samples).sum();
            assert!((spp - pilot - 1..=spp - pilot).contains(&samples), "{spp}");
            for count in [1, 2, 3, 64, 1 << 40] {
                match &passes[..] {
                    [one] => assert_eq!(one.of(count), 0..count),
                    [one, other] => {
                        assert_eq!(one.points, other.points);
                        assert_eq!(
                            (one.of(count), other.of(count)),
                            (0..count, count..2 * count)
                        );
                    }
                    _ => panic!("{passes:?}"),
                }
            }
        }
        let arguments = Arguments::parse_from(["render", "scene.xml", "--adaptive", "--spp", "1"]);
        assert!(Plan::new(&arguments, Points::Rescrambled, 16).is_err());
    }

    #[test]
    fn what_is_rendered_by_time_goes_on_with_one_set() {
        let plan = plan(&["--time", "10"], Points::Rescrambled);
        let (mut passes, mut done) = (0, 0);
        // A sample a second hundredth.
        while let Some(pass) = plan.next(passes, done, [done as f64 / 100.0; 2], None) {
            assert_eq!((pass.set, pass.part.start), (0, done));
            done += pass.samples();
            passes += 1;
        }
        assert_eq!(done, 1000);
        let independent = |more: &[&str], points| {
            let plan = self::plan(&[&["--time", "10"], more].concat(), points);
            let pass = plan.next(3, 4, [0.1; 2], None).unwrap();
            assert_eq!(pass, Pass::whole(3, 4));
            assert_eq!(plan.is_half(&pass, 4), more.is_empty());
        };
        independent(&["--std-error", "x.exr"], Points::Sobol);
        independent(&[], Points::NRooks);
    }
}
