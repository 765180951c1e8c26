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

/// How many sums a block keeps side by side: values go to them in turn, so that the machine adds several at once.
const LANES: usize = 2;

/// Sums of one short block of values, each relative to the block's first: two additions and one
/// multiplication a component, no division.
///
/// The shift costs few digits because it is one of the values: with `m` the sum of squared deviations
/// from the mean, `(first - mean)^2 <= m`, hence `squares = m + n (first - mean)^2 <= (n + 1) m`, and
/// for a block of 1024 the subtraction in [`piece`](Self::piece) loses at most three of sixteen
/// digits.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Block<V> {
    count: u64,
    first: V,
    sums: [V; LANES],
    squares: [V; LANES],
    lows: [V; LANES],
    highs: [V; LANES],
}

impl<V: Value> Block<V> {
    pub(crate) const EMPTY: Self = Self {
        count: 0,
        first: V::ZERO,
        sums: [V::ZERO; LANES],
        squares: [V::ZERO; LANES],
        lows: [V::ZERO; LANES],
        highs: [V::ZERO; LANES],
    };

    /// Adds a value.
    pub(crate) fn push(&mut self, value: V) {
        self.extend(&[value], |value| value);
    }

    /// Adds values one after the other, made of `values` by `widen`.
    pub(crate) fn extend<N: Copy>(&mut self, values: &[N], widen: impl Fn(N) -> V) {
        let Some(&first) = values.first() else { return };
        if self.count == 0 {
            self.first = widen(first);
            self.lows = [self.first; LANES];
            self.highs = self.lows;
        }
        // As many as make the lanes even, then all of them at once, then the rest.
        #[expect(clippy::cast_possible_truncation, reason = "below the number of lanes")]
        let odd = (self.count.wrapping_neg() % LANES as u64) as usize;
        let (before, values) = values.split_at(odd.min(values.len()));
        let (groups, after) = values.as_chunks::<LANES>();
        for (value, lane) in before.iter().zip(LANES - odd..) {
            self.add(lane, widen(*value));
        }
        self.add_groups(groups, &widen);
        for (lane, value) in after.iter().enumerate() {
            self.add(lane, widen(*value));
        }
        self.count += (before.len() + values.len()) as u64;
    }

    #[inline]
    fn add(&mut self, lane: usize, value: V) {
        self.lows[lane] = value.zip(self.lows[lane], smaller);
        self.highs[lane] = value.zip(self.highs[lane], larger);
        let shifted = value.zip(self.first, |x, first| x - first);
        self.sums[lane] = self.sums[lane].zip(shifted, |sum, d| sum + d);
        self.squares[lane] = self.squares[lane].zip(shifted, |squares, d| squares + d * d);
    }

    /// Adds a value to every lane, group after group; all in vector registers, where a value of three components
    /// just has room.
    #[inline]
    fn add_groups<N: Copy>(&mut self, groups: &[[N; LANES]], widen: impl Fn(N) -> V) {
        let first = [self.first; LANES];
        let (mut sums, mut squares) = (self.sums, self.squares);
        let (mut lows, mut highs) = (self.lows, self.highs);
        for group in groups {
            let values = group.map(&widen);
            lows = values.zip(lows, smaller);
            highs = values.zip(highs, larger);
            let shifted = values.zip(first, |x, first| x - first);
            sums = sums.zip(shifted, |sum, d| sum + d);
            squares = squares.zip(shifted, |squares, d| squares + d * d);
        }
        (self.sums, self.squares, self.lows, self.highs) = (sums, squares, lows, highs);
    }

    /// Whether all sums are finite; once they are not, they stay so.
    pub(crate) fn is_finite(&self) -> bool {
        let [sum, squares] = [self.sums, self.squares].map(|lanes| fold(lanes, |a, b| a + b));
        self.first.is_finite() && sum.is_finite() && squares.is_finite()
    }

    /// What the block has given, or `None` if plain arithmetic does not do: a value that is not finite,
    /// or deviations whose squares leave the range of `f64`. A function of its own: within the loop that adds values up it would
    /// take the lanes apart.
    #[inline(never)]
    pub(crate) fn piece(&self) -> Option<Piece<V>> {
        const ORDINARY: core::ops::Range<f64> = 1e-250..1e300;
        let count = self.count as f64;
        let mut ordinary = self.first.is_finite();
        let [sum, squares] = [self.sums, self.squares].map(|lanes| fold(lanes, |a, b| a + b));
        let (low, high) = (fold(self.lows, smaller), fold(self.highs, larger));
        let mean = self.first.zip(sum, |first, sum| first + sum / count);
        let root = squares.zip(sum, |squares, sum| {
            (squares - sum * (sum / count)).max(0.0).sqrt()
        });
        let range = high.zip(low, |high, low| high - low);
        let _ = range.zip(squares, |range, squares| {
            // NaN among equal values is in the squares alone, spread too small for its squares in the range alone.
            let constant = range == 0.0 && squares == 0.0;
            ordinary &= constant || ORDINARY.contains(&squares);
            range
        });
        ordinary.then(|| Piece {
            moments: Moments::from_parts(self.count, mean, root),
            rejected: 0,
            low,
            high,
        })
    }
}

/// What the lanes are together.
fn fold<V: Value>(lanes: [V; LANES], mut join: impl FnMut(f64, f64) -> f64) -> V {
    let [first, rest @ ..] = lanes;
    rest.into_iter()
        .fold(first, |all, lane| all.zip(lane, &mut join))
}
