//! What strata of equal weight say together: mean, error, and how far the error can be trusted.

use super::parts::Parts;
use super::{Stratum, Visited};
use crate::warning::Warning;
use crate::{ErrorBar, Estimate, Moments, Value, reduce};

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
    /// The share of one stratum in the variance if it came from strata of equal shares; 0 unless most strata have none.
    pub(crate) stratum_share: f64,
    /// The largest absolute value.
    pub(crate) size: V,
    /// How many of the strata have points.
    pub(crate) visited: u64,
    pub(crate) strata: u64,
}

impl<V: Value> Stratified<V> {
    /// `None` if there is no value.
    ///
    /// Values that were left out are taken to have been the mean of the others. That gives the mean over the part of the
    /// domain where there are values, and an error, that of a ratio, which is right to first order.
    pub(crate) fn new(visited: &Visited<V>) -> Option<Self> {
        if visited.left_out.is_empty() {
            return Self::of(&visited.strata);
        }
        let (mut sum, mut number, mut missing) = (V::ZERO, 0.0, 0.0);
        for (place, stratum) in visited.strata.iter().enumerate() {
            let left_out = visited.left_out.get(&place).copied().unwrap_or_default();
            let points = stratum.moments.count() + left_out.count();
            if points > 0 {
                let share = stratum.moments.count() as f64 / points as f64;
                sum = sum.zip(stratum.moments.mean(), |sum, mean| sum + share * mean);
                missing += (1.0 - share) * left_out.mean();
                number += 1.0;
            }
        }
        // What the domain would weigh if it had values everywhere is 1.
        let weight = 1.0 - missing / number;
        if !(weight > 0.0) {
            return None;
        }
        let mean: V = sum.map(|sum| sum / number / weight);
        let mut strata = visited.strata.clone();
        for (&place, left_out) in &visited.left_out {
            let (stratum, value) = (&mut strata[place], mean.map(|mean| mean * left_out.mean()));
            if stratum.moments.count() == 0 {
                (stratum.low, stratum.high) = (value, value);
            }
            stratum.moments.merge(Moments::from_parts(
                left_out.count(),
                value,
                mean.map(|mean| mean.abs() * left_out.root()),
            ));
        }
        let together = Self::of(&strata)?;
        Some(Self {
            mean,
            std_error: together.std_error.map(|error| error / weight),
            ..together
        })
    }

    fn of(strata: &[Stratum<V>]) -> Option<Self> {
        Self::of_all(strata).or_else(|| Self::of_some(strata))
    }

    /// From a random sample of the strata: their means are independent values of one distribution.
    fn of_some(strata: &[Stratum<V>]) -> Option<Self> {
        let visited = || strata.iter().filter(|stratum| stratum.moments.count() > 0);
        let means: Moments<V> = visited().map(|stratum| stratum.moments.mean()).collect();
        let share = visited().fold(V::ZERO, |share, stratum| {
            let off = stratum.moments.mean().zip(means.mean(), |x, mean| x - mean);
            let own = off.zip(means.root(), |off, root| match root {
                0.0 => 0.0,
                root => (off / root).powi(2),
            });
            share.zip(own, f64::max)
        });
        let mut largest = 0.0_f64;
        share.for_each(|share| largest = largest.max(share));
        (means.count() > 0).then(|| Self {
            mean: means.mean(),
            std_error: means.std_error().unwrap_or(V::ZERO),
            freedom: means.count() as f64 - 1.0,
            share: largest,
            stratum_share: 0.0,
            size: size(strata),
            visited: means.count(),
            strata: strata.len() as u64,
        })
    }

    /// `None` if a stratum has fewer than two values, or if there is none.
    fn of_all(strata: &[Stratum<V>]) -> Option<Self> {
        if strata.is_empty() {
            return None;
        }
        let weight = 1.0 / strata.len() as f64;
        let parts = reduce::in_blocks(strata, |_, block| Parts::of(block, weight));
        let parts: Vec<Parts<V>> = parts.into_iter().collect::<Option<_>>()?;
        let Parts {
            mean,
            size,
            largest,
            squares,
            fourths,
            by_freedom,
            peak,
            alike,
        } = parts.into_iter().fold(Parts::NONE, Parts::and);
        let std_error = squares.zip(largest, |squares, largest| largest * squares.sqrt());
        // No more than can be told from infinitely many.
        let (mut freedom, mut share) = (1e9_f64, 0.0_f64);
        let _ = squares.zip(by_freedom, |squares, by_freedom| {
            if by_freedom > 0.0 {
                freedom = freedom.min(squares * squares / by_freedom);
            }
            0.0
        });
        let _ = peak.zip(squares, |peak, squares| {
            if squares > 0.0 {
                share = share.max(peak / squares);
            }
            0.0
        });
        let mut stratum_share = 0.0_f64;
        let shares = fourths.zip(squares, |fourths, squares| fourths / (squares * squares));
        let _ = shares.zip(alike, |share, alike| {
            if alike * weight > 0.5 {
                // NaN, where no stratum has a variance, is no larger.
                stratum_share = stratum_share.max(share);
            }
            0.0
        });
        Some(Self {
            mean,
            std_error,
            freedom,
            share,
            stratum_share,
            size,
            visited: strata.len() as u64,
            strata: strata.len() as u64,
        })
    }

    /// The error, if anything is known about it.
    pub(crate) fn error(&self) -> Option<V> {
        (self.freedom > 0.0).then_some(self.std_error)
    }

    /// The estimate from `used` evaluations, of which `rejected` gave no finite value.
    pub(crate) fn estimate(&self, used: u64, rejected: u64) -> Estimate<V> {
        let mut warnings = self.warnings();
        warnings.extend(Warning::of_rejected(rejected));
        Estimate {
            std_error: self.error(),
            error_bar: ErrorBar::Strata {
                freedom: self.freedom,
            },
            rejected,
            warnings,
            ..Estimate::new(self.mean, used)
        }
    }

    /// What the values themselves say against the error.
    pub(crate) fn warnings(&self) -> Vec<Warning> {
        let mut warnings = Vec::new();
        let (visited, strata) = (self.visited, self.strata);
        if visited < strata {
            warnings.push(Warning::Unvisited { visited, strata });
        }
        if self.freedom <= 0.0 {
            return warnings;
        }
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
        if self.stratum_share > 0.05 {
            let deciding = 1.0 / self.stratum_share;
            warnings.push(Warning::FewStrata { deciding });
        }
        warnings.extend(Warning::of_rounding(self.std_error, self.size));
        warnings
    }
}

fn size<V: Value>(strata: &[Stratum<V>]) -> V {
    strata
        .iter()
        .fold(V::ZERO, |size, stratum| size.zip(stratum.size(), f64::max))
}
