//! The mean over the points of one set, without an error bar.

use crate::points::PointSet;
use crate::tallied::{Tallied, tallied};
use crate::tally::Tally;
use crate::warning::Warning;
use crate::{Error, Estimate, NonFinite, Value};

/// The mean over the first points of one point set; no error bar.
///
/// A set on its own cannot tell how good it is: the spread of the values says nothing about the error
/// of points that are not independent. [`Replicated`](crate::Replicated) gives an error bar.
///
/// A set that only has a meaning as a whole ([`PointSet::size`]) is used as a whole: the estimate then tells
/// what was [requested](Estimate::requested) and what was [used](Estimate::used).
///
/// ```
/// use estimand::{Average, Estimator, cube, points::Stratified};
///
/// let square = cube(|[x]| x * x);
/// let estimate = Average::new(Stratified::new(1000, 1, 7)?, 1000).estimate(&square)?;
/// assert!((estimate.mean - 1.0 / 3.0).abs() < 1e-4);
/// assert_eq!(estimate.std_error, None);
/// # Ok::<(), estimand::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
#[must_use]
pub struct Average<P> {
    points: P,
    count: u64,
    non_finite: NonFinite,
}

impl<P: PointSet> Average<P> {
    /// The mean over the first `count` points of `points`, or over all if it is a finite set.
    pub const fn new(points: P, count: u64) -> Self {
        Self {
            points,
            count,
            non_finite: NonFinite::Fail,
        }
    }

    /// The same with another rule for values that are not finite.
    pub const fn non_finite(mut self, rule: NonFinite) -> Self {
        self.non_finite = rule;
        self
    }
}

impl<P: PointSet> Tallied for Average<P> {
    type Source<'a>
        = &'a P
    where
        P: 'a;

    fn sources(&self) -> Result<Vec<&P>, Error> {
        if self.count == 0 {
            return Err(Error::refused("count", "at least 1", 0));
        }
        Ok(vec![&self.points])
    }

    fn counts(&self, _: &[&P], evaluations: u64) -> Vec<u64> {
        vec![whole(&self.points, evaluations)]
    }

    fn requested(&self) -> u64 {
        self.count
    }

    fn policy(&self) -> NonFinite {
        self.non_finite
    }

    fn summary<V: Value>(&self, tallies: &[Tally<V>]) -> Option<Estimate<V>> {
        let [tally] = tallies else { return None };
        let moments = tally.moments();
        let rejected = tally.rejected();
        let mut warnings = Warning::of_rejected(rejected);
        warnings.extend(Warning::of_power(&self.points, tally.used()));
        (moments.count() > 0).then(|| Estimate {
            requested: self.count,
            rejected,
            warnings,
            ..Estimate::new(moments.mean(), tally.used())
        })
    }
}

tallied!([P: PointSet] Average<P>);

/// How many points of `points` to take for `count`: all of a finite set.
pub(crate) fn whole(points: &impl PointSet, count: u64) -> u64 {
    points.size().filter(|_| count > 0).unwrap_or(count)
}
