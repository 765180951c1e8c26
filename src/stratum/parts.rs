//! What strata have in the variance of the mean of all, block by block.

use super::Stratum;
use crate::Value;

/// What some strata have in the mean of all, and in its variance: sums over squares of errors that are relative to the largest,
/// so that there is no overflow and no underflow.
pub(super) struct Parts<V> {
    /// The part in the mean.
    pub(super) mean: V,
    /// The largest absolute value.
    pub(super) size: V,
    /// The largest error.
    pub(super) largest: V,
    /// The sum of the squares.
    pub(super) squares: V,
    /// That of their squares.
    pub(super) fourths: V,
    /// That of their squares by degrees of freedom.
    pub(super) by_freedom: V,
    /// The largest that one value has in a square.
    pub(super) peak: V,
    /// How many strata have no error.
    pub(super) alike: V,
}

impl<V: Value> Parts<V> {
    pub(super) const NONE: Self = Self {
        mean: V::ZERO,
        size: V::ZERO,
        largest: V::ZERO,
        squares: V::ZERO,
        fourths: V::ZERO,
        by_freedom: V::ZERO,
        peak: V::ZERO,
        alike: V::ZERO,
    };

    /// `None` if a stratum has fewer than two values.
    pub(super) fn of(strata: &[Stratum<V>], weight: f64) -> Option<Self> {
        // In one piece: to grow is to wait for other threads that allocate.
        let mut errors = Vec::with_capacity(strata.len());
        for stratum in strata {
            errors.push(stratum.moments.std_error()?.map(|error| error * weight));
        }
        let largest = errors
            .iter()
            .fold(V::ZERO, |largest: V, error| largest.zip(*error, f64::max));
        let mut all = Self {
            largest,
            ..Self::NONE
        };
        for (stratum, &error) in strata.iter().zip(&errors) {
            let moments = stratum.moments;
            let less = moments.count() as f64 - 1.0;
            let square = error.zip(largest, relative);
            let share = stratum
                .high
                .zip(moments.mean(), |high, mean| high - mean)
                .zip(
                    moments.mean().zip(stratum.low, |mean, low| mean - low),
                    f64::max,
                )
                .zip(moments.root(), relative);
            all = all.plus(Self {
                mean: moments.mean().map(|mean| weight * mean),
                size: stratum.size(),
                largest,
                squares: square,
                fourths: square.map(|square| square * square),
                by_freedom: square.map(|square| square * square / less),
                peak: square.zip(share, |square, share| square * share),
                alike: square.map(|square| f64::from(u8::from(square == 0.0))),
            });
        }
        Some(all)
    }

    /// These strata and others.
    pub(super) fn and(self, others: Self) -> Self {
        let largest = self.largest.zip(others.largest, f64::max);
        self.below(largest).plus(others.below(largest))
    }

    /// With squares relative to the `largest` error of more strata.
    fn below(self, largest: V) -> Self {
        let square = self.largest.zip(largest, relative);
        let twice = square.map(|square| square * square);
        let product = |sum: V, factor: V| sum.zip(factor, |sum, factor| sum * factor);
        Self {
            largest,
            squares: product(self.squares, square),
            fourths: product(self.fourths, twice),
            by_freedom: product(self.by_freedom, twice),
            peak: product(self.peak, square),
            ..self
        }
    }

    /// These strata and others, with squares relative to the same error.
    #[inline]
    fn plus(self, others: Self) -> Self {
        let sum = |here: V, there: V| here.zip(there, |here, there| here + there);
        Self {
            mean: sum(self.mean, others.mean),
            size: self.size.zip(others.size, f64::max),
            largest: self.largest,
            squares: sum(self.squares, others.squares),
            fourths: sum(self.fourths, others.fourths),
            by_freedom: sum(self.by_freedom, others.by_freedom),
            peak: self.peak.zip(others.peak, f64::max),
            alike: sum(self.alike, others.alike),
        }
    }
}

/// The square of a part of the `largest`; zero if that is.
fn relative(part: f64, largest: f64) -> f64 {
    match largest {
        0.0 => 0.0,
        largest => (part / largest).powi(2),
    }
}
