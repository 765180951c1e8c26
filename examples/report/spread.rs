//! Means of repeated measurements with their intervals, and ratios of them.

use estimand::Moments;
use estimand::report::number::significant;

/// A number with its 95 % interval.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spread {
    pub(crate) value: f64,
    pub(crate) low: f64,
    pub(crate) high: f64,
}

impl Spread {
    /// The mean of independent values, give or take twice its standard error.
    pub(crate) fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let moments: Moments<f64> = values.into_iter().collect();
        Self::around(moments.mean(), moments.std_error().unwrap_or(f64::INFINITY))
    }

    /// The median of independent times, between the order statistics that hold the true one with at least 95 % where there
    /// are six or more: what else a machine does makes a few of them very long.
    pub(crate) fn of_times(mut times: Vec<f64>) -> Self {
        times.sort_by(f64::total_cmp);
        let count = times.len();
        // The probability that so many of them or fewer lie below the median.
        let mut rank = 0;
        let (mut term, mut tail) = (0.5_f64.powf(count as f64), 0.5_f64.powf(count as f64));
        while tail + term * (count - rank) as f64 / (rank + 1) as f64 <= 0.025
            && 2 * rank + 2 < count
        {
            term *= (count - rank) as f64 / (rank + 1) as f64;
            rank += 1;
            tail += term;
        }
        Self {
            value: 0.5 * (times[(count - 1) / 2] + times[count / 2]),
            low: times[rank],
            high: times[count - 1 - rank],
        }
    }

    pub(crate) fn around(value: f64, std_error: f64) -> Self {
        Self {
            value,
            low: value - 2.0 * std_error,
            high: value + 2.0 * std_error,
        }
    }

    /// The ratio of two positive numbers that were measured independently.
    pub(crate) fn over(self, other: Self) -> Self {
        let value = self.value / other.value;
        // Distances on the logarithmic scale, which ends at zero.
        let up = |s: Self| (s.high / s.value).ln();
        let down = |s: Self| (s.value / s.low.max(0.0)).ln();
        Self {
            value,
            low: value / down(self).hypot(up(other)).exp(),
            high: value * up(self).hypot(down(other)).exp(),
        }
    }

    /// The product, likewise.
    pub(crate) fn times(self, other: Self) -> Self {
        let one = Self {
            value: 1.0,
            low: 1.0,
            high: 1.0,
        };
        self.over(one.over(other))
    }

    /// Whether all of the interval is above `limit`.
    pub(crate) fn is_above(self, limit: f64) -> bool {
        self.low > limit
    }

    /// Whether all of the interval is below `limit`.
    pub(crate) fn is_below(self, limit: f64) -> bool {
        self.high < limit
    }

    /// The number alone.
    pub(crate) fn text(self) -> String {
        significant(self.value, 3)
    }

    /// The interval.
    pub(crate) fn interval(self) -> String {
        format!(
            "[{}, {}]",
            significant(self.low, 3),
            significant(self.high, 3)
        )
    }

    /// The number as a share in per cent.
    pub(crate) fn percent(self) -> String {
        format!("{} %", significant(100.0 * self.value, 2))
    }

    pub(crate) fn percent_interval(self) -> String {
        let percent = |x: f64| significant(100.0 * x, 2);
        format!("[{}, {}] %", percent(self.low), percent(self.high))
    }
}
