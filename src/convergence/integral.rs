//! A study of one integrand whose integral is known.

use core::fmt;
use std::hint::black_box;
use std::time::Instant;

use super::{Convergence, Study, Trial};
use crate::points::{Independent, PointSet};
use crate::{Cursor, Error, Estimate, Estimator, Integrand, Value};

/// A [`Study`] of one integrand whose integral is known, made by [`Study::integral`].
#[must_use]
pub struct Integral<'a, I: Integrand> {
    pub(super) study: Study<'a>,
    pub(super) integrand: &'a I,
    pub(super) truth: <I::Value as Value>::Wide,
}

impl<'a, I: Integrand> Integral<'a, I> {
    /// Adds a method: `estimator` makes it for a count and a seed.
    pub fn method<E: Estimator>(
        mut self,
        name: impl Into<String>,
        estimator: impl Fn(u64, u64) -> E + 'a,
    ) -> Self {
        let (integrand, truth) = (self.integrand, self.truth);
        self.study = self.study.trials(name, move |count, seed| {
            let estimate = estimator(count, seed)
                .estimate(integrand)
                .map_err(Error::from)?;
            Ok(trial::<<I::Value as Value>::Wide>(&estimate, truth))
        });
        self
    }

    /// Runs everything: see [`Study::run`].
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a truth that is not finite; see also [`Study::run`].
    pub fn run(&self) -> Result<Convergence, Error> {
        if !self.truth.is_finite() {
            let truth = format_args!("{:?}", self.truth);
            return Err(Error::refused("truth of a study", "finite", truth));
        }
        self.study.run()
    }
}

impl<I: Integrand> fmt::Debug for Integral<'_, I> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Integral")
            .field("study", &self.study)
            .field("truth", &self.truth)
            .finish_non_exhaustive()
    }
}

/// What an estimate has given, compared with the truth: component by component, then in the mean over them.
fn trial<V: Value>(estimate: &Estimate<V>, truth: V) -> Trial {
    let mean_of = |value: V| {
        let (mut sum, mut components) = (0.0, 0.0);
        value.for_each(|component| {
            sum += component;
            components += 1.0;
        });
        sum / components
    };
    let squared_error = mean_of(
        estimate
            .mean
            .zip(truth, |mean, truth| (mean - truth) * (mean - truth)),
    );
    let squared_claim = estimate
        .std_error
        .map(|error| mean_of(error.map(|error| error * error)));
    let covered = estimate.interval(0.95).map(|interval| {
        let above = interval
            .low
            .zip(truth, |low, truth| f64::from(u8::from(low <= truth)));
        mean_of(
            above.zip(
                interval
                    .high
                    .zip(truth, |high, truth| f64::from(u8::from(truth <= high))),
                f64::min,
            ),
        )
    });
    Trial {
        evaluations: estimate.used,
        squared_error,
        squared_claim,
        covered,
    }
}

/// How long one evaluation of the integrand takes by itself, in seconds, on one thread, at points that are
/// already in the cache.
pub(super) fn seconds_per_evaluation<I: Integrand>(integrand: &I) -> f64 {
    const POINTS: usize = 256;
    const SHORTEST: f64 = 2e-3;
    let points = Independent::new(0);
    let dimensions = integrand.dimensions().clamp(1, 64);
    let width = dimensions as usize;
    let mut coordinates = vec![0.0; POINTS * width];
    points.fill(0, 0..dimensions, &mut coordinates);
    let start = Instant::now();
    let mut fastest = f64::INFINITY;
    // The fastest of many rounds: whatever else the machine does only adds to a time.
    while start.elapsed().as_secs_f64() < SHORTEST || fastest == f64::INFINITY {
        let round = Instant::now();
        for (index, row) in (0..).zip(coordinates.chunks_exact(width)) {
            black_box(integrand.evaluate(&mut Cursor::with_prefix(&points, index, row)));
        }
        fastest = fastest.min(round.elapsed().as_secs_f64());
    }
    fastest / POINTS as f64
}
