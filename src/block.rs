//! Sums and extremes of one short block of values, without divisions.

use crate::tally::Piece;
use crate::{Moments, Value};

/// The smaller of two numbers; the first if the second is NaN. One instruction, as `f64::min` is not.
#[inline]
pub(crate) fn smaller(a: f64, b: f64) -> f64 {
    if b < a { b } else { a }
}

/// The larger of two numbers; the first if the second is NaN.
#[inline]
pub(crate) fn larger(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

/// Sums of one short block of values, each relative to the block's first: two additions and one
/// multiplication a component, no division.
///
/// The shift costs few digits because it is one of the values: with `m` the sum of squared deviations
/// from the mean, `(first - mean)^2 <= m`, hence `squares = m + n (first - mean)^2 <= (n + 1) m`, and
/// for a block of 1024 the subtraction in [`moments`](Self::moments) loses at most three of sixteen
/// digits.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Block<V> {
    count: u64,
    first: V,
    sum: V,
    squares: V,
    low: V,
    high: V,
}

impl<V: Value> Block<V> {
    pub(crate) const EMPTY: Self = Self {
        count: 0,
        first: V::ZERO,
        sum: V::ZERO,
        squares: V::ZERO,
        low: V::ZERO,
        high: V::ZERO,
    };

    #[inline]
    pub(crate) fn push(&mut self, value: V) {
        if self.count == 0 {
            self.first = value;
            self.low = value;
            self.high = value;
        }
        self.count += 1;
        self.low = self.low.zip(value, smaller);
        self.high = self.high.zip(value, larger);
        let shifted = value.zip(self.first, |x, first| x - first);
        self.sum = self.sum.zip(shifted, |sum, d| sum + d);
        self.squares = self.squares.zip(shifted, |squares, d| squares + d * d);
    }

    /// Whether all sums are finite; once they are not, they stay so.
    pub(crate) fn is_finite(&self) -> bool {
        self.first.is_finite() && self.sum.is_finite() && self.squares.is_finite()
    }

    /// What the block has given, or `None` if plain arithmetic does not do: a value that is not finite,
    /// or deviations whose squares leave the range of `f64`.
    #[inline]
    pub(crate) fn piece(&self) -> Option<Piece<V>> {
        const ORDINARY: core::ops::Range<f64> = 1e-250..1e300;
        let count = self.count as f64;
        let mut ordinary = self.first.is_finite();
        let mean = self.first.zip(self.sum, |first, sum| first + sum / count);
        let root = self.squares.zip(self.sum, |squares, sum| {
            (squares - sum * (sum / count)).max(0.0).sqrt()
        });
        let range = self.high.zip(self.low, |high, low| high - low);
        let _ = range.zip(self.squares, |range, squares| {
            // NaN among equal values is in the squares alone, spread too small for its squares in the range alone.
            let constant = range == 0.0 && squares == 0.0;
            ordinary &= constant || ORDINARY.contains(&squares);
            range
        });
        ordinary.then(|| Piece {
            moments: Moments::from_parts(self.count, mean, root),
            rejected: 0,
            low: self.low,
            high: self.high,
        })
    }
}
