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
    /// How many points there are in the one set that the passes are parts of, if they are; of a sequence it may be any number.
    pub(crate) one_set: Option<u64>,
    /// Whether every pass is to tell of the errors of pixels.
    independent: bool,
    /// How many samples every pixel gets before the others are dealt, if they are.
    pub(crate) first: Option<u64>,
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

/// Some samples of each pixel.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub(crate) struct Pass {
    /// How many passes there were before it.
    pub(crate) number: u64,
    /// How many samples a pixel has before and after it, in the mean over the pixels.
    pub(crate) samples: Range<u64>,
    /// Whether those within the first half of all that a pixel has after it are told apart from the others.
    pub(crate) halved: bool,
}

impl Pass {
    /// Whether it is one that a plan can have made.
    pub(crate) fn is_sound(&self) -> bool {
        self.samples.start <= self.samples.end
    }

    /// How many of its samples are told apart, in a pixel that has so many before and after it.
    pub(crate) fn cut(&self, samples: Range<u64>) -> u64 {
        match self.halved {
            true => (samples.end / 2).saturating_sub(samples.start),
            false => 0,
        }
    }

    /// How many samples it has, in the mean over the pixels.
    pub(crate) fn count(&self) -> u64 {
        self.samples.end - self.samples.start
    }
}

/// The most samples of a pass where their number is not known beforehand.
const MOST: u64 = 64;

/// How many samples every pixel gets before the others are dealt where their number is not known beforehand, and the most where it is.
const FIRST: u64 = 16;
const MOST_OF_FIRST: u64 = 64;

/// Up to so many samples of one set are rendered in one pass, or in two where samples are dealt: a pixel is visited once, in the place of twice.
const AT_ONCE: u64 = 256;

/// The fewest passes that tell of an error.
const FEWEST: u64 = 4;

impl Plan {
    pub(crate) fn new(
        arguments: &Arguments,
        points: Points,
        of_the_file: u64,
    ) -> Result<Self, String> {
        // Errors of pixels are those of independent sets.
        let independent = arguments.std_error.is_some() || arguments.replicates.is_some();
        let spp = arguments.spp.unwrap_or(of_the_file);
        let known = arguments.time.is_none() && arguments.noise.is_none();
        let goes_on = points.go_on(known.then_some(spp)) && !independent;
        let plan = |passes, first| Self {
            passes,
            one_set: goes_on.then_some(spp),
            independent,
            first: arguments.adaptive.then_some(first),
        };
        if let Some(seconds) = arguments.time {
            let time = Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX);
            return Ok(plan(Passes::Time(time), FIRST));
        }
        if let Some(noise) = arguments.noise {
            return Ok(plan(Passes::Noise(noise), FIRST));
        }
        // An eighth; a power of two, for nets.
        let first = 1 << (spp / 8).clamp(2, MOST_OF_FIRST).ilog2();
        if arguments.adaptive && spp < first {
            return Err("--adaptive needs at least 2 samples a pixel".to_owned());
        }
        let replicates = arguments.replicates.unwrap_or(match arguments.std_error {
            Some(_) => 16,
            None => 2,
        });
        let mut sizes = Vec::new();
        let dealt = match arguments.adaptive {
            // Two parts of the first samples tell of their errors.
            true => {
                match goes_on {
                    true => sizes.push(first),
                    false => sizes.extend([first / 2; 2]),
                }
                spp - first
            }
            false => spp,
        };
        let halved = goes_on && spp <= AT_ONCE;
        sizes.extend(match (arguments.adaptive, goes_on) {
            (_, true) if halved => vec![dealt],
            // The first half of all, of which the first samples are a part.
            (_, true) => vec![spp / 2 - (spp - dealt), spp.div_ceil(2)],
            (true, false) => parts(dealt, replicates.saturating_sub(2).max(1)),
            (false, false) if points.are_powers_of_two() => {
                let parts = parts(dealt, replicates);
                parts.into_iter().flat_map(powers).collect()
            }
            (false, false) => parts(dealt, replicates),
        });
        sizes.retain(|&size| size > 0);
        let mut done = 0;
        let pass = |(number, size)| {
            let before = done;
            done += size;
            Pass {
                number,
                samples: before..done,
                // The first samples always tell of their errors.
                halved: halved || goes_on && arguments.adaptive && done == first,
            }
        };
        let passes = (0..).zip(sizes).map(pass).collect();
        Ok(plan(Passes::Known(passes), first))
    }

    /// The next pass; `None` if there is none. `done` is how many samples there are in `passes` passes
    /// that took so many `seconds`, and `noise` their error relative to the mean.
    pub(crate) fn next(
        &self,
        passes: u64,
        done: u64,
        seconds: f64,
        noise: Option<f64>,
    ) -> Option<Pass> {
        let after = |samples| Pass {
            number: passes,
            samples: done..done + samples,
            halved: false,
        };
        // A power of two, so that passes are nets.
        let doubled = 1 << done.clamp(1, MOST).ilog2();
        match &self.passes {
            Passes::Known(known) => known.get(usize::try_from(passes).ok()?).cloned(),
            Passes::Noise(target) => {
                let reached = passes >= FEWEST && noise.is_some_and(|noise| noise <= *target);
                (!reached).then(|| after(doubled))
            }
            Passes::Time(time) => {
                let left = time.as_secs_f64() - seconds;
                let fitting = left * done as f64 / seconds.max(1e-9);
                let mut samples = doubled;
                // Not beyond those after which the others are dealt.
                if let Some(more) = self
                    .first
                    .and_then(|first| first.checked_sub(done))
                    .filter(|&more| more > 0)
                {
                    samples = samples.min(more);
                }
                while samples > 1 && samples as f64 > fitting {
                    samples /= 2;
                }
                (passes == 0 || fitting >= 1.0).then(|| after(samples))
            }
        }
    }

    /// Whether the error of a pixel is best told by a pass and all before it, not by those before it one by one, where it has as many
    /// samples. Of smaller sets the errors are larger, for as many samples in all.
    pub(crate) fn tells_by_halves(&self) -> bool {
        !self.independent
    }

    /// How much of the work is done, in `[0, 1]`, if that can be told.
    pub(crate) fn fraction(&self, done: f64, seconds: f64, noise: Option<f64>) -> Option<f64> {
        let fraction = match &self.passes {
            Passes::Known(passes) => done / passes.iter().map(Pass::count).sum::<u64>() as f64,
            Passes::Time(time) => seconds / time.as_secs_f64(),
            Passes::Noise(target) => (target / noise?).powi(2),
        };
        Some(fraction.clamp(0.0, 1.0))
    }
}

/// As many parts of a number, as equal as can be, some of nothing if it is smaller.
fn parts(number: u64, count: u64) -> Vec<u64> {
    let part = |which: u64| number / count + u64::from(which < number % count);
    (0..count.min(number)).map(part).collect()
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
    fn passes_have_all_samples() {
        for &points in Points::value_variants() {
            for spp in (1..300).chain([1024, 12_345, 1 << 33]) {
                let text = spp.to_string();
                for more in [
                    &[][..],
                    &["--std-error", "x.exr"],
                    &["--replicates", "3"],
                    &["--adaptive"],
                    &["--adaptive", "--replicates", "7"],
                ] {
                    let adaptive = more.contains(&"--adaptive");
                    if spp == 1 && adaptive {
                        continue;
                    }
                    let plan = plan(&[&["--spp", &text], more].concat(), points);
                    let (first, goes_on) = (plan.first, plan.one_set.is_some());
                    assert!(plan.one_set.is_none_or(|all| all == spp));
                    assert_eq!(
                        goes_on,
                        points.go_on(Some(spp))
                            && !more.contains(&"--replicates")
                            && !more.contains(&"--std-error")
                    );
                    let passes = known(plan);
                    let mut done = 0;
                    for (number, pass) in (0..).zip(&passes) {
                        assert_eq!((pass.number, pass.samples.start), (number, done));
                        assert!(pass.count() > 0, "{points} {spp}");
                        done = pass.samples.end;
                    }
                    assert_eq!(done, spp, "{points}");
                    assert_eq!(first.is_some(), adaptive);
                    if goes_on {
                        // Halves, as near as can be.
                        let last = passes.last().unwrap();
                        let other = last.count() - last.cut(last.samples.clone());
                        assert!(
                            other == spp.div_ceil(2) || spp < 4,
                            "{points} {spp} {passes:?}"
                        );
                    }
                    if let Some(first) = first {
                        // Two parts, of which errors are told.
                        if goes_on {
                            assert_eq!(
                                (passes[0].count(), passes[0].cut(0..first)),
                                (first, first / 2)
                            );
                        } else {
                            assert_eq!(
                                [0, 1].map(|pass: usize| passes[pass].count()),
                                [first / 2; 2]
                            );
                        }
                        assert!(first == 2 || 8 * first <= spp && first.is_power_of_two());
                    }
                }
            }
        }
        let arguments = Arguments::parse_from(["render", "scene.xml", "--adaptive", "--spp", "1"]);
        assert!(Plan::new(&arguments, Points::Rescrambled, 16).is_err());
    }

    #[test]
    fn what_is_rendered_by_time_goes_on() {
        let plan = plan(&["--time", "10"], Points::Rescrambled);
        let (mut passes, mut done) = (0, 0);
        // A sample a second hundredth.
        while let Some(pass) = plan.next(passes, done, done as f64 / 100.0, None) {
            assert_eq!((pass.number, pass.samples.start), (passes, done));
            done = pass.samples.end;
            passes += 1;
        }
        assert_eq!(done, 1000);
        let plan = self::plan(&["--time", "10", "--std-error", "x.exr"], Points::Sobol);
        assert!(plan.one_set.is_none() && !plan.tells_by_halves());
        let plan = self::plan(&["--time", "10", "--adaptive"], Points::Rescrambled);
        // A cut pass is not to lead past the first samples.
        let pass = plan.next(4, 9, 5.0, None).unwrap();
        assert_eq!(pass.samples, 9..16);
        assert_eq!(plan.next(4, 15, 5.0, None).unwrap().samples, 15..16);
        assert_eq!(plan.next(4, 16, 5.0, None).unwrap().samples, 16..32);
        let plan = self::plan(&["--time", "10", "--adaptive"], Points::NRooks);
        assert!(plan.one_set.is_none() && plan.tells_by_halves());
        assert_eq!(plan.first, Some(FIRST));
    }
}
