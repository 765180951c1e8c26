//! Independent points, and an interval that needs no normal distribution.

use std::time::Instant;

use rand::rngs::Xoshiro256PlusPlus;

use super::monte_carlo::Streams;
use crate::evaluate::{Tail, evaluate};
use crate::tally::Tally;
use crate::{
    Error, ErrorBar, Estimate, Estimator, Incomplete, Integrand, NonFinite, Outcome, Value,
};

/// The mean over independent points of an integrand between known limits, with an interval that holds for every
/// number of points: the empirical Bernstein bound.
///
/// Other intervals rely on the mean being nearly normal, which rare events make it only after many points. This
/// one relies on nothing but the limits. The price is width: beyond the first hundreds of points it is some 1.4 times as
/// wide as Student's at 95 %, plus a term that falls as `1 / count`.
///
/// ```
/// use estimand::{Estimator, cube, estimators::Bounded};
///
/// // An event of probability 1e-4 that 1000 points will mostly miss.
/// let rare = cube(|[x]| if x < 1e-4 { 1.0 } else { 0.0 });
/// let estimate = Bounded::new(1000, 1, 0.0, 1.0)?.estimate(&rare)?;
/// let interval = estimate.interval(0.95).unwrap();
/// assert!(interval.contains(1e-4) && interval.high < 0.02);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// # Errors of the estimate
///
/// [`Error::Refused`] if a value lies outside the limits; see [`Estimator::estimate`].
#[derive(Clone, Copy, Debug)]
#[must_use]
pub struct Bounded {
    count: u64,
    seed: u64,
    low: f64,
    high: f64,
}

impl Bounded {
    /// `count` independent points, selected by `seed`, for an integrand whose components all lie in `[low, high]`.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for fewer than two points, and for limits that are not finite or not in order.
    pub fn new(count: u64, seed: u64, low: f64, high: f64) -> Result<Self, Error> {
        if count < 2 {
            return Err(Error::refused("count", "at least 2", count));
        }
        if !(low < high && (high - low).is_finite()) {
            let limits = format!("{low} and {high}");
            return Err(Error::refused("limits", "finite and in order", limits));
        }
        Ok(Self {
            count,
            seed,
            low,
            high,
        })
    }
}

impl Estimator for Bounded {
    fn estimate<I: Integrand>(&self, integrand: &I) -> Outcome<I::Value> {
        let clock = Instant::now();
        let mut tallies = [Tally::EMPTY];
        let source = Streams::<Xoshiro256PlusPlus>::new(self.seed);
        let outcome = evaluate(
            &[source],
            &mut tallies,
            &[self.count],
            Tail::Closed,
            integrand,
            NonFinite::Fail,
        );
        let [tally] = tallies.map(|tally| tally.closed());
        let mut outside = None;
        let mut check = |x: f64| {
            if !(self.low..=self.high).contains(&x) {
                outside = Some(x);
            }
        };
        if let (Some(high), Some(low)) = (tally.highest().first(), tally.lowest().first()) {
            high.for_each(&mut check);
            low.for_each(|x| check(-x));
        }
        if let Some(value) = outside {
            let domain = "within the limits that were stated";
            return Err(Error::refused("value of the integrand", domain, value).into());
        }
        let moments = tally.moments();
        let std_error = moments.std_error();
        let estimate = (moments.count() > 0).then(|| Estimate {
            std_error,
            error_bar: ErrorBar::Bounded {
                low: self.low,
                high: self.high,
            },
            requested: self.count,
            seconds: clock.elapsed().as_secs_f64(),
            ..Estimate::new(moments.mean(), tally.used())
        });
        match outcome {
            Ok(()) => estimate.ok_or_else(|| Error::NothingLeft { rejected: 0 }.into()),
            Err(reason) => Err(Incomplete {
                reason,
                so_far: estimate.map(Box::new),
            }),
        }
    }
}
