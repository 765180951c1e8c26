//! Error against run time, as data: methods side by side, over growing counts, with several seeds each.
//!
//! A [`Study`] runs them and returns a [`Convergence`]: one [`Curve`] a method, one [`Sample`] a count. What a run's
//! error is, the caller says ([`Study::trials`]), so that the same type serves integrals, vectors and images;
//! for an [`Integrand`] with a known integral, [`Study::integral`] says it.
//!
//! ```
//! use estimand::convergence::{Study, Truth};
//! use estimand::{Average, MonteCarlo, cube, points::Stratified};
//!
//! let f = cube(|[x, y]| (x * y).exp());
//! let convergence = Study::new([64, 256, 1024], 8)?
//!     .integral(&f, Truth::exact(1.317_902_151_454_404))
//!     .method("plain", MonteCarlo::new)
//!     .method("stratified", |count, seed| {
//!         Average::new(Stratified::new(count, 2, seed).expect("a positive count"), count)
//!     })
//!     .run()?;
//! let [plain, stratified] = &convergence.curves[..] else { unreachable!() };
//! assert!(stratified.slope.unwrap().value < plain.slope.unwrap().value);
//! # Ok::<(), estimand::Error>(())
//! ```
//!
//! Where the integral is not known, a much longer estimate with an error bar stands in for it: [`Truth::of`]. Without
//! either there is no error to be studied; such a study does not compile:
//!
//! ```compile_fail
//! use estimand::{MonteCarlo, convergence::Study};
//!
//! Study::new([64, 256], 8)?.method("plain", MonteCarlo::new).run()?;
//! # Ok::<(), estimand::Error>(())
//! ```
//!
//! The feature `serde` saves and restores what a study has found; [`Convergence::rows`] is the same as a flat table. The
//! feature `report` writes files and pages: see `report`.

use core::fmt;
use std::hint::black_box;
use std::time::Instant;

use crate::{Error, Integrand, Value, hash};

mod curve;
mod integral;
mod row;
mod truth;

pub use curve::{Convergence, Curve, Run, Sample, Slope};
pub use integral::Integral;
pub use row::Row;
pub use truth::Truth;

/// What one run of a method has given; how long it took is measured around it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trial {
    /// How many evaluations of the integrand were made.
    pub evaluations: u64,
    /// The square of the error; of many values, as an image has them, the mean of the squares.
    pub squared_error: f64,
    /// The square of the standard error that the method claims, if it claims one; of many values their mean.
    pub squared_claim: Option<f64>,
    /// How many of the values, as a fraction in `[0, 1]`, lie within the 95 % interval that the method claims.
    pub covered: Option<f64>,
}

type Method<'a> = Box<dyn Fn(u64, u64) -> Result<Trial, Error> + 'a>;

/// Methods to be run side by side over growing counts.
///
/// Times mean something: every method is run once before it is measured, short runs are repeated until their
/// sum can be measured, methods take turns so that a slow minute of the machine hits all of them, and of the
/// seeds' times the median is taken.
#[must_use]
pub struct Study<'a> {
    counts: Vec<u64>,
    seeds: u64,
    first_seed: u64,
    shortest: f64,
    noise: f64,
    scale: Option<f64>,
    evaluation_seconds: Option<f64>,
    methods: Vec<(String, Method<'a>)>,
    progress: Option<Box<dyn Fn(u64, u64) + 'a>>,
}

impl<'a> Study<'a> {
    /// A study over `counts` evaluations, with `seeds` runs of each method at each count.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] if there are no counts, for counts that are zero or do not grow, and for fewer than two
    /// seeds.
    pub fn new(counts: impl IntoIterator<Item = u64>, seeds: u64) -> Result<Self, Error> {
        let counts: Vec<u64> = counts.into_iter().collect();
        if counts.first().is_none_or(|&first| first == 0) || !counts.is_sorted_by(|a, b| a < b) {
            return Err(Error::refused(
                "list of counts",
                "a growing list of positive numbers",
                format_args!("{counts:?}"),
            ));
        }
        if seeds < 2 {
            return Err(Error::refused("number of seeds", "at least 2", seeds));
        }
        Ok(Self {
            counts,
            seeds,
            first_seed: 0,
            shortest: 2e-3,
            noise: 0.0,
            scale: None,
            evaluation_seconds: None,
            methods: Vec::new(),
            progress: None,
        })
    }

    /// The same with other seeds: `first`, `first + 1`, and so on. Each run gets a well mixed word made from its own.
    pub const fn first_seed(mut self, first: u64) -> Self {
        self.first_seed = first;
        self
    }

    /// The same with another least time, in seconds, over which a run is repeated to be timed; 0.002 by default.
    pub const fn shortest(mut self, seconds: f64) -> Self {
        self.shortest = seconds;
        self
    }

    /// The same with a reference that is itself an estimate, with this root-mean-square error.
    pub const fn noise(mut self, noise: f64) -> Self {
        self.noise = noise;
        self
    }

    /// The same with what errors are relative to: the size of the result, in its own unit.
    pub const fn scale(mut self, scale: f64) -> Self {
        self.scale = Some(scale);
        self
    }

    /// The same, calling `progress` after every run with how many runs are done and how many there are.
    pub fn progress(mut self, progress: impl Fn(u64, u64) + 'a) -> Self {
        self.progress = Some(Box::new(progress));
        self
    }

    /// Adds a method: `run` gets a count and a seed, and says how far off the run was.
    pub fn trials(
        mut self,
        name: impl Into<String>,
        run: impl Fn(u64, u64) -> Result<Trial, Error> + 'a,
    ) -> Self {
        self.methods.push((name.into(), Box::new(run)));
        self
    }

    /// Goes on with an integrand whose integral is known: methods are then [estimators](crate::Estimator).
    pub fn integral<I: Integrand>(
        mut self,
        integrand: &'a I,
        truth: Truth<<I::Value as Value>::Wide>,
    ) -> Integral<'a, I> {
        self.noise = truth.noise();
        self.scale = Some(truth.scale());
        self.evaluation_seconds = Some(integral::seconds_per_evaluation(integrand));
        Integral {
            study: self,
            integrand,
            truth: truth.value(),
        }
    }

    /// Runs everything.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] if there is no method, and the first error of a method's run.
    pub fn run(&self) -> Result<Convergence, Error> {
        if self.methods.is_empty() {
            return Err(Error::refused(
                "number of methods of a study",
                "at least 1",
                0,
            ));
        }
        let runs = self.counts.len() as u64 * self.seeds * self.methods.len() as u64;
        let mut done = 0;
        let mut of_method: Vec<Vec<Run>> = vec![Vec::new(); self.methods.len()];
        for &count in &self.counts {
            for (_, run) in &self.methods {
                run(count, hash::hash(self.first_seed, 0))?;
            }
            for seed in 0..self.seeds {
                let seed = hash::hash(self.first_seed.wrapping_add(seed), 1);
                for ((_, run), runs_of_it) in self.methods.iter().zip(&mut of_method) {
                    runs_of_it.push(timed(count, || run(count, seed), self.shortest)?);
                    done += 1;
                    if let Some(progress) = &self.progress {
                        progress(done, runs);
                    }
                }
            }
        }
        let curves: Result<Vec<Curve>, Error> = self
            .methods
            .iter()
            .zip(of_method)
            .map(|((name, _), runs)| Curve::of_runs(name, runs, self.noise))
            .collect();
        Ok(Convergence {
            seeds: self.seeds,
            noise: self.noise,
            scale: self.scale,
            evaluation_seconds: self.evaluation_seconds,
            curves: curves?,
        })
    }
}

impl fmt::Debug for Study<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<&str> = self.methods.iter().map(|(name, _)| name.as_str()).collect();
        f.debug_struct("Study")
            .field("counts", &self.counts)
            .field("seeds", &self.seeds)
            .field("methods", &names)
            .finish_non_exhaustive()
    }
}

/// Runs at least once and for at least `shortest` seconds.
fn timed(count: u64, run: impl Fn() -> Result<Trial, Error>, shortest: f64) -> Result<Run, Error> {
    let start = Instant::now();
    let mut runs = 0_u32;
    loop {
        let trial = black_box(run()?);
        runs += 1;
        // Clocks tick: a run shorter than that took no time, but is not to be divided by.
        let seconds = start.elapsed().as_secs_f64().max(1e-9);
        if seconds >= shortest {
            let seconds = seconds / f64::from(runs);
            return Ok(Run {
                count,
                trial,
                seconds,
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{MonteCarlo, cube};

    /// A method whose error is `count^-slope` times a number that depends on the seed.
    fn synthetic(slope: f64) -> impl Fn(u64, u64) -> Result<Trial, Error> {
        move |count, seed| {
            let factor = 0.5 + hash::unit(seed);
            let error = factor * (count as f64).powf(slope);
            Ok(Trial {
                evaluations: count,
                squared_error: error * error,
                squared_claim: None,
                covered: None,
            })
        }
    }

    #[test]
    fn the_slope_of_a_power_law_is_its_exponent() {
        let study = Study::new((4..14).map(|k| 1 << k), 64)
            .unwrap()
            .shortest(0.0);
        let result = study
            .trials("half", synthetic(-0.5))
            .trials("three halves", synthetic(-1.5))
            .run()
            .unwrap();
        for (curve, exponent) in result.curves.iter().zip([-0.5, -1.5]) {
            let slope = curve.slope.unwrap();
            // All counts see the same seeds, so that the power law is exact.
            assert!(
                (slope.value - exponent).abs() < 1e-12,
                "{}: {slope:?}",
                curve.method
            );
            assert!(slope.interval.unwrap().contains(slope.value));
        }
        // The mean square of 1/2 + u is 13/12; the band holds it.
        let first = &result.curves[0].samples[0];
        let truth = (13.0_f64 / 12.0).sqrt() * 16_f64.powf(-0.5);
        assert!(
            first.rmse_low < truth && truth < first.rmse_high,
            "{first:?}"
        );
    }

    #[test]
    fn a_reference_with_noise_of_its_own_is_told_apart() {
        let study = Study::new((4..14).map(|k| 1 << k), 16)
            .unwrap()
            .shortest(0.0)
            .noise(0.05);
        let curve = &study.trials("half", synthetic(-0.5)).run().unwrap().curves[0];
        let limited: Vec<bool> = curve.samples.iter().map(|sample| sample.limited).collect();
        assert!(!limited[0] && limited[9], "{limited:?}");
        assert!(curve.slope.unwrap().samples < 10);
    }

    #[test]
    fn plain_monte_carlo_converges_as_it_should_and_knows_it() {
        let f = cube(|[x, y]| x * y);
        let study = Study::new([64, 256, 1024, 4096], 64).unwrap().shortest(0.0);
        let result = study
            .integral(&f, Truth::exact(0.25))
            .method("plain", MonteCarlo::new)
            .run()
            .unwrap();
        let curve = &result.curves[0];
        // The variance of x y is 7/144; an RMSE of 64 runs is uncertain by 9 %, a coverage by 3 %: five of each.
        for sample in &curve.samples {
            let expected = (7.0 / 144.0 / sample.count as f64).sqrt();
            assert!((sample.rmse / expected - 1.0).abs() < 0.45, "{sample:?}");
            assert!(
                (sample.claimed.unwrap() / expected - 1.0).abs() < 0.2,
                "{sample:?}"
            );
            assert!(sample.coverage.unwrap() > 0.8, "{sample:?}");
            assert!(sample.seconds > 0.0 && sample.evaluations == sample.count);
        }
        assert!(result.evaluation_seconds.unwrap() > 0.0);
    }

    #[test]
    fn studies_that_make_no_sense_are_refused() {
        let message = |result: Result<Study<'_>, Error>| result.unwrap_err().to_string();
        assert_eq!(
            message(Study::new([], 4)),
            "the list of counts must be a growing list of positive numbers; it was []"
        );
        assert!(Study::new([0, 1], 4).is_err() && Study::new([4, 4], 4).is_err());
        assert_eq!(
            message(Study::new([4], 1)),
            "the number of seeds must be at least 2; it was 1"
        );
        assert!(Study::new([4], 2).unwrap().run().is_err());
        let f = cube(|[x]| x);
        let nan = Study::new([4], 2)
            .unwrap()
            .integral(&f, Truth::exact(f64::NAN));
        let error = nan.method("plain", MonteCarlo::new).run().unwrap_err();
        assert_eq!(
            error.to_string(),
            "the truth of a study must be finite; it was NaN"
        );
    }
}
