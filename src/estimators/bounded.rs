//! Independent points, and an interval that needs no normal distribution.

use rand::rngs::Xoshiro256PlusPlus;

use super::monte_carlo::Streams;
use crate::tallied::{Tallied, Tallies, tallied};
use crate::tally::Tally;
use crate::{Error, ErrorBar, Estimate, NonFinite, Value, Warning};

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
/// [`Error::Refused`] if a value lies outside the limits, with a mean that has no error bar; see also
/// [`Estimator::estimate`](crate::Estimator::estimate).
#[derive(Clone, Copy, Debug)]
#[must_use]
pub struct Bounded {
    count: u64,
    seed: u64,
    low: f64,
    high: f64,
    non_finite: NonFinite,
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
            non_finite: NonFinite::Fail,
        })
    }

    /// The same with another rule for values that are not finite.
    pub const fn non_finite(mut self, rule: NonFinite) -> Self {
        self.non_finite = rule;
        self
    }

    /// A value outside the limits, if there was one.
    fn outside<V: Value>(&self, tally: &Tally<V>) -> Option<f64> {
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
        outside
    }
}

impl Tallied for Bounded {
    type Source<'a> = Streams<Xoshiro256PlusPlus>;

    fn sources(&self) -> Result<Vec<Streams<Xoshiro256PlusPlus>>, Error> {
        Ok(vec![Streams::new(self.seed)])
    }

    fn counts(&self, _: &[Streams<Xoshiro256PlusPlus>], evaluations: u64) -> Vec<u64> {
        vec![evaluations]
    }

    fn requested(&self) -> u64 {
        self.count
    }

    fn policy(&self) -> NonFinite {
        self.non_finite
    }

    fn check<V: Value>(&self, state: &Tallies<V>) -> Result<(), Error> {
        let tallies = state.closed();
        match tallies.iter().find_map(|tally| self.outside(tally)) {
            Some(value) => {
                let domain = "within the limits that were stated";
                Err(Error::refused("value of the integrand", domain, value))
            }
            None => Ok(()),
        }
    }

    fn summary<V: Value>(&self, tallies: &[Tally<V>]) -> Option<Estimate<V>> {
        let [tally] = tallies else { return None };
        let moments = tally.moments();
        let rejected = tally.rejected();
        let (low, high) = (self.low, self.high);
        // Without the limits there is no bound.
        let holds = self.outside(tally).is_none();
        (moments.count() > 0).then(|| Estimate {
            std_error: moments.std_error().filter(|_| holds),
            error_bar: if holds {
                ErrorBar::Bounded { low, high }
            } else {
                ErrorBar::None
            },
            requested: self.count,
            rejected,
            warnings: Warning::of_rejected(rejected),
            ..Estimate::new(moments.mean(), tally.used())
        })
    }
}

tallied!([] Bounded);
