//! What strata of equal weight say together: mean, error, and how far the error can be trusted.

use crate::tally::Tally;
use crate::warning::Warning;
use crate::{Moments, Value};

/// What the points of a stratum have given.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Stratum<V> {
    pub(crate) moments: Moments<V>,
    pub(crate) low: V,
    pub(crate) high: V,
}

impl<V: Value> Stratum<V> {
    pub(crate) const EMPTY: Self = Self {
        moments: Moments::new(),
        low: V::ZERO,
        high: V::ZERO,
    };

    /// What a closed tally has given.
    pub(crate) fn of(tally: &Tally<V>) -> Self {
        Self {
            moments: *tally.moments(),
            low: tally
                .lowest()
                .first()
                .map_or(V::ZERO, |low| -> V { low.map(|low| -low) }),
            high: tally.highest().first().copied().unwrap_or(V::ZERO),
        }
    }

    pub(crate) fn merge(&mut self, other: &Self) {
        if self.moments.count() == 0 {
            *self = *other;
        } else if other.moments.count() > 0 {
            self.moments.merge(other.moments);
            self.low = self.low.zip(other.low, f64::min);
            self.high = self.high.zip(other.high, f64::max);
        }
    }
}

/// Shares `count` points out in proportion to `scores`, two to each at the least. The rounding is carried on from one to the
/// next, so that none are lost; scores that are all zero share evenly.
///
/// There must be two points for each.
pub(crate) fn apportion(scores: &[f64], count: u64) -> Vec<u64> {
    let sum: f64 = scores.iter().sum();
    let free = count.saturating_sub(2 * scores.len() as u64);
    let even = 1.0 / scores.len() as f64;
    let (mut share, mut given) = (0.0, 0);
    scores
        .iter()
        .map(|score| {
            share += if sum > 0.0 && sum.is_finite() {
                score / sum
            } else {
                even
            };
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a part of the count"
            )]
            let end = ((share * free as f64).round() as u64).clamp(given, free);
            let here = end - given;
            given = end;
            2 + here
        })
        .collect()
}

/// What strata of equal weight say together.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stratified<V> {
    pub(crate) mean: V,
    pub(crate) std_error: V,
    /// Degrees of freedom of the error, the least of all components.[^welch]
    ///
    /// [^welch]: Satterthwaite, Franklin (1946). *An Approximate Distribution of Estimates of Variance
    ///     Components*. <https://doi.org/10.2307/3002019>
    pub(crate) freedom: f64,
    /// The largest share of one value in the variance of the mean.
    pub(crate) share: f64,
    /// The largest absolute value.
    pub(crate) size: V,
}

impl<V: Value> Stratified<V> {
    /// `None` if a stratum has fewer than two values, or if there is none.
    pub(crate) fn new(strata: &[Stratum<V>]) -> Option<Self> {
        if strata.is_empty() {
            return None;
        }
        let weight = 1.0 / strata.len() as f64;
        let errors: Vec<V> = strata
            .iter()
            .map(|stratum| Some(stratum.moments.std_error()?.map(|error| error * weight)))
            .collect::<Option<_>>()?;
        let mean = strata.iter().fold(V::ZERO, |sum, stratum| {
            sum.zip(stratum.moments.mean(), |sum, mean| sum + weight * mean)
        });
        let largest = errors
            .iter()
            .fold(V::ZERO, |largest, error| largest.zip(*error, f64::max));
        let size = strata.iter().fold(V::ZERO, |size, stratum| {
            let here = stratum
                .low
                .zip(stratum.high, |low, high| low.abs().max(high.abs()));
            size.zip(here, f64::max)
        });
        let (mut squares, mut fourths, mut peak) = (V::ZERO, V::ZERO, V::ZERO);
        for (stratum, &error) in strata.iter().zip(&errors) {
            let moments = stratum.moments;
            let less = moments.count() as f64 - 1.0;
            // Squares relative to the largest: no overflow and no underflow.
            let part = error.zip(largest, |error, largest| match largest {
                0.0 => 0.0,
                largest => (error / largest).powi(2),
            });
            squares = squares.zip(part, |sum, part| sum + part);
            fourths = fourths.zip(part, |sum, part| sum + part * part / less);
            let share = stratum
                .high
                .zip(moments.mean(), |high, mean| high - mean)
                .zip(
                    moments.mean().zip(stratum.low, |mean, low| mean - low),
                    f64::max,
                )
                .zip(moments.root(), |deviation, root| match root {
                    0.0 => 0.0,
                    root => (deviation / root).powi(2),
                });
            peak = peak.zip(part.zip(share, |part, share| part * share), f64::max);
        }
        let std_error = squares.zip(largest, |squares, largest| largest * squares.sqrt());
        // No more than can be told from infinitely many.
        let (mut freedom, mut share) = (1e9_f64, 0.0_f64);
        let _ = squares.zip(fourths, |squares, fourths| {
            if fourths > 0.0 {
                freedom = freedom.min(squares * squares / fourths);
            }
            0.0
        });
        let _ = peak.zip(squares, |peak, squares| {
            if squares > 0.0 {
                share = share.max(peak / squares);
            }
            0.0
        });
        Some(Self {
            mean,
            std_error,
            freedom,
            share,
            size,
        })
    }

    /// What the values themselves say against the error.
    pub(crate) fn warnings(&self) -> Vec<Warning> {
        let mut warnings = Vec::new();
        let mut alike = false;
        self.std_error.for_each(|error| alike |= error == 0.0);
        if alike {
            warnings.push(Warning::NoSpread);
        }
        // Few degrees of freedom are few strata, or few points in them, that decide everything.
        let share = self.share.max(1.0 / self.freedom).min(1.0);
        if share > 0.05 {
            warnings.push(Warning::FewValues { share });
        }
        warnings.extend(Warning::of_rounding(self.std_error, self.size));
        warnings
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_shared_out_to_the_last() {
        assert_eq!(apportion(&[1.0, 1.0, 1.0], 10), [3, 4, 3]);
        assert_eq!(apportion(&[0.0, 0.0], 5), [3, 2]);
        assert_eq!(apportion(&[0.0, 3.0, 1.0], 14), [2, 8, 4]);
        assert_eq!(apportion(&[f64::INFINITY, 1.0], 4), [2, 2]);
        let many = apportion(&[0.1; 1000], 12_345);
        assert_eq!(many.iter().sum::<u64>(), 12_345);
    }
}
