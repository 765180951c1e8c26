//! An estimate of an integral, with what is known about its error.

use core::fmt;

use crate::quantile::student;
use crate::{Value, Warning};

/// An estimate of an integral, with what is known about its error.
///
/// Two estimates are equal if the same was computed; how long it took does not count.
///
/// ```
/// use estimand::{ErrorBar, Estimator, MonteCarlo, Stop, cube};
///
/// let estimate = MonteCarlo::new(10_000, 1).estimate(&cube(|[x]| x * x))?;
/// assert_eq!(estimate.error_bar, ErrorBar::SampleVariance);
/// assert_eq!(estimate.stop, Stop::Count);
/// assert!(estimate.warnings.is_empty());
/// let interval = estimate.interval(0.999).unwrap();
/// assert!(interval.low < 1.0 / 3.0 && 1.0 / 3.0 < interval.high);
/// # Ok::<(), estimand::Error>(())
/// ```
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[must_use]
#[non_exhaustive]
pub struct Estimate<V> {
    /// The estimate of the integral.
    pub mean: V,
    /// The standard error of the mean, where the estimator has one to give.
    pub std_error: Option<V>,
    /// Where the error bar comes from: it decides how wide an [interval](Self::interval) is.
    pub error_bar: ErrorBar,
    /// The means of the replicates or iterations that the mean was formed of, in their order; empty where
    /// there are none.
    pub replicates: Vec<V>,
    /// How many evaluations of the integrand were asked for.
    pub requested: u64,
    /// How many evaluations were made: another number than `requested` where the points come only in some
    /// numbers, as those of a grid do. Rejected ones are among them.
    pub used: u64,
    /// How many of the values were not finite and left out.
    pub rejected: u64,
    /// Why no more evaluations were made.
    pub stop: Stop,
    /// How long it took, in seconds; 0 where the estimator did not measure it.
    pub seconds: f64,
    /// Why the error bar may be wrong; empty if nothing speaks against it.
    pub warnings: Vec<Warning>,
}

/// Where an error bar comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum ErrorBar {
    /// There is none: a deterministic rule does not know its error.
    #[default]
    None,
    /// The sample variance of independent values; intervals are Student's.
    SampleVariance,
    /// The spread of independent replicates; intervals are Student's, with one degree of freedom less than
    /// replicates.
    Replicates,
    /// The sample variances within strata, or within the strata of several iterations; intervals are
    /// Student's.
    Strata {
        /// Degrees of freedom, by Welch's and Satterthwaite's formula.
        freedom: f64,
    },
    /// A bound that holds for any number of independent values between two limits, with no condition on their
    /// distribution: the empirical Bernstein bound.
    Bounded {
        /// No value is below.
        low: f64,
        /// No value is above.
        high: f64,
    },
    /// The order statistics of independent replicates around their median.
    Median,
}

impl fmt::Display for ErrorBar {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::None => "none",
            Self::SampleVariance => "sample variance",
            Self::Replicates => "replicates",
            Self::Strata { .. } => "strata",
            Self::Bounded { .. } => "bounded",
            Self::Median => "median",
        })
    }
}

/// Why an estimator made no more evaluations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Stop {
    /// All evaluations that it was set up for were made. If there was a tolerance, it was not reached.
    #[default]
    Count,
    /// The tolerance was reached.
    Tolerance,
    /// The time was up.
    Time,
    /// The caller cancelled it.
    Cancelled,
    /// A value was not finite, or the estimate is one of a run that goes on.
    Unfinished,
}

impl fmt::Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Count => "count",
            Self::Tolerance => "tolerance",
            Self::Time => "time",
            Self::Cancelled => "cancelled",
            Self::Unfinished => "unfinished",
        })
    }
}

/// An interval of confidence, component by component.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Interval<V> {
    /// The lower ends.
    pub low: V,
    /// The upper ends.
    pub high: V,
}

impl<V: Value> Interval<V> {
    /// Whether `value` lies in the interval, ends included, in every component.
    pub fn contains(&self, value: V) -> bool {
        let mut inside = true;
        let _ = self.low.zip(value, |low, x| {
            inside &= low <= x;
            x
        });
        let _ = self.high.zip(value, |high, x| {
            inside &= x <= high;
            x
        });
        inside
    }
}

impl<V> Estimate<V> {
    /// An estimate without an error bar, from `evaluations` evaluations.
    pub fn new(mean: V, evaluations: u64) -> Self {
        Self {
            mean,
            std_error: None,
            error_bar: ErrorBar::None,
            replicates: Vec::new(),
            requested: evaluations,
            used: evaluations,
            rejected: 0,
            stop: Stop::Count,
            seconds: 0.0,
            warnings: Vec::new(),
        }
    }
}

impl<V: Value> Estimate<V> {
    /// The interval that holds the integral with probability `level`, as far as the
    /// [error bar](ErrorBar) can be trusted; each component on its own.
    ///
    /// `None` without an error bar, if `level` is not in `(0, 1)`, or if there are too few replicates around a
    /// median for that level.
    pub fn interval(&self, level: f64) -> Option<Interval<V>> {
        if !(level > 0.0 && level < 1.0) {
            return None;
        }
        let error = self.std_error?;
        let count = self.used.saturating_sub(self.rejected) as f64;
        let freedom = match self.error_bar {
            ErrorBar::None => return None,
            ErrorBar::SampleVariance => count - 1.0,
            ErrorBar::Replicates => self.replicates.len() as f64 - 1.0,
            ErrorBar::Strata { freedom } => freedom,
            ErrorBar::Median => return self.around_median(level),
            ErrorBar::Bounded { low, high } => {
                let half = error.map(|error| bernstein(error, count, high - low, 1.0 - level));
                let interval = self.around_mean(half);
                return Some(Interval {
                    low: interval.low.map(|end| end.max(low)),
                    high: interval.high.map(|end| end.min(high)),
                });
            }
        };
        if freedom.is_nan() || freedom <= 0.0 {
            return None;
        }
        let quantile = student(level, freedom);
        Some(self.around_mean(error.map(|error| error * quantile)))
    }

    fn around_mean(&self, half: V) -> Interval<V> {
        Interval {
            low: self.mean.zip(half, |mean, half| mean - half),
            high: self.mean.zip(half, |mean, half| mean + half),
        }
    }

    /// Order statistics that the median of the distribution lies between with probability `level` at least.
    fn around_median(&self, level: f64) -> Option<Interval<V>> {
        let count = self.replicates.len();
        // The probability that at most `rank` of them fall on one side.
        let (mut rank, mut term, mut below) = (0, 0.5_f64.powi(i32::try_from(count).ok()?), 0.0);
        while 2.0 * (below + term) <= 1.0 - level {
            below += term;
            rank += 1;
            term *= (count - rank + 1) as f64 / rank as f64;
        }
        let rank = rank.checked_sub(1)?;
        Some(Interval {
            low: order_statistic(&self.replicates, rank),
            high: order_statistic(&self.replicates, count - 1 - rank),
        })
    }

    /// The width of the interval at `level` on either side of the mean, the larger of the two.
    pub(crate) fn half_width(&self, level: f64) -> Option<V> {
        let interval = self.interval(level)?;
        let above = interval.high.zip(self.mean, |high, mean| high - mean);
        Some(
            self.mean
                .zip(interval.low, |mean, low| mean - low)
                .zip(above, f64::max),
        )
    }
}

/// The `rank`-th smallest value, counted from 0, in every component.
pub(crate) fn order_statistic<V: Value>(values: &[V], rank: usize) -> V {
    let mut sorted = values.to_vec();
    // Insertion: the lists are short, and components have an order where values have none.
    for end in 1..sorted.len() {
        for place in (0..end).rev() {
            let (a, b) = (sorted[place], sorted[place + 1]);
            sorted[place] = a.zip(b, f64::min);
            sorted[place + 1] = a.zip(b, f64::max);
        }
    }
    sorted[rank]
}

/// Half the width of the two-sided empirical Bernstein interval.[^maurer]
///
/// [^maurer]: Maurer, Andreas; Pontil, Massimiliano (2009). *Empirical Bernstein Bounds and Sample Variance
///     Penalization*, theorem 4. <https://arxiv.org/abs/0907.3740>
fn bernstein(std_error: f64, count: f64, range: f64, doubt: f64) -> f64 {
    let logarithm = (4.0 / doubt).ln();
    std_error * (2.0 * logarithm).sqrt() + 7.0 * range * logarithm / (3.0 * (count - 1.0))
}

impl<V: PartialEq> PartialEq for Estimate<V> {
    fn eq(&self, other: &Self) -> bool {
        self.mean == other.mean
            && self.std_error == other.std_error
            && self.error_bar == other.error_bar
            && self.replicates == other.replicates
            && self.requested == other.requested
            && self.used == other.used
            && self.rejected == other.rejected
            && self.stop == other.stop
            && self.warnings == other.warnings
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_replicates(error_bar: ErrorBar, replicates: Vec<f64>) -> Estimate<f64> {
        Estimate {
            std_error: Some(1.0),
            error_bar,
            replicates,
            ..Estimate::new(10.0, 100)
        }
    }

    #[test]
    fn no_error_bar_or_no_level_is_no_interval() {
        let mut estimate = Estimate::new(1.0, 10);
        assert_eq!(estimate.interval(0.95), None);
        estimate.std_error = Some(1.0);
        assert_eq!(estimate.interval(0.95), None);
        estimate.error_bar = ErrorBar::SampleVariance;
        for level in [0.0, 1.0, -1.0, f64::NAN] {
            assert_eq!(estimate.interval(level), None);
        }
        estimate.used = 1;
        assert_eq!(estimate.interval(0.95), None);
    }

    #[test]
    fn replicates_are_students() {
        // Student's quantile for 7 degrees of freedom, from any table.
        let estimate = of_replicates(ErrorBar::Replicates, vec![10.0; 8]);
        let interval = estimate.interval(0.95).unwrap();
        assert!((interval.high - 12.364_624).abs() < 1e-6);
        assert!((interval.low - 7.635_376).abs() < 1e-6);
    }

    #[test]
    fn order_statistics_around_a_median() {
        // For 9 values the second and the eighth: 1 - 2 (1 + 9) / 512 = 0.961. For 5 values the outermost
        // hold the median with 1 - 2 / 32 = 0.9375, and 0.95 is not to be had.
        let nine = vec![9.0, 1.0, 8.0, 2.0, 7.0, 3.0, 6.0, 4.0, 5.0];
        let estimate = of_replicates(ErrorBar::Median, nine);
        let interval = estimate.interval(0.95).unwrap();
        assert_eq!((interval.low, interval.high), (2.0, 8.0));
        let five = of_replicates(ErrorBar::Median, vec![1.0, 2.0, 3.0, 4.0, 5.0]);
        assert_eq!(five.interval(0.95), None);
        assert_eq!(five.interval(0.93).unwrap().high, 5.0);
    }

    #[test]
    fn bounded_intervals_stay_within_the_bounds() {
        let (low, high) = (9.5, 10.5);
        let estimate = of_replicates(ErrorBar::Bounded { low, high }, Vec::new());
        assert_eq!(estimate.interval(0.95), Some(Interval { low, high }));
    }
}
