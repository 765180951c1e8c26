//! Iterations, and what they say together.

use crate::stratum::Stratified;
use crate::{Moments, Value};

/// What one iteration of a [`Vegas`](super::Vegas) gave.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Iteration<V> {
    /// The estimate of the iteration alone.
    pub mean: V,
    /// Its standard error.
    pub std_error: V,
    /// Degrees of freedom of the standard error.
    pub freedom: f64,
    /// The largest share of one value in the variance.
    pub share: f64,
    /// The share of one stratum in the variance if it came from strata of equal shares; 0 unless most strata have none.
    pub stratum_share: f64,
    /// How many evaluations it made.
    pub used: u64,
    /// How many of the values were not finite and left out.
    pub rejected: u64,
    /// Whether it only trained, and is not part of the estimate.
    pub training: bool,
}

/// What iterations say together.
pub(super) struct Together<V> {
    /// As strata of the one integral, each with the error that it claims.
    pub(super) strata: Stratified<V>,
    /// The standard error, and its degrees of freedom: those of the iterations' spread where it contradicts the claims.
    pub(super) std_error: V,
    pub(super) freedom: f64,
    /// How much the iterations differ, per degree of freedom; the largest of the components. `None` for one.
    pub(super) chi_square: Option<f64>,
    /// The chi-square per degree of freedom from which on they contradict their errors.
    limit: f64,
}

impl<V: Value> Together<V> {
    /// Of one iteration at least, of values no larger than `size`.
    pub(super) fn of(main: &[Iteration<V>], size: V) -> Self {
        // All iterations have nearly the same number of points.
        let number = main.len();
        let share = 1.0 / number as f64;
        let mean = main.iter().fold(V::ZERO, |sum, one| {
            sum.zip(one.mean, |sum, mean| sum + share * mean)
        });
        let std_error = main.iter().fold(V::ZERO, |sum, one| {
            sum.zip(one.std_error, |sum, error| sum.hypot(share * error))
        });
        // Each iteration's part in the variance, the largest of the components.
        let (mut below, mut largest_share) = (0.0, 0.0_f64);
        for one in main {
            let mut part = 0.0_f64;
            let _ = one.std_error.zip(std_error, |own, error| {
                if error > 0.0 {
                    part = part.max((share * own / error).powi(2));
                }
                own
            });
            below += part * part / one.freedom;
            largest_share = largest_share.max(part * one.share);
        }
        let strata = Stratified {
            mean,
            std_error,
            freedom: if below > 0.0 {
                (1.0 / below).min(1e9)
            } else {
                1e9
            },
            share: largest_share,
            stratum_share: main.iter().map(|one| one.stratum_share).fold(0.0, f64::max),
            size,
            visited: 1,
            strata: 1,
        };
        // Each component's own; largest of all reported.
        let per_freedom = 1.0 / (number as f64 - 1.0).max(1.0);
        let consistency = main.iter().fold(V::ZERO, |sum, one| {
            one.mean
                .zip(mean, |x, mean| x - mean)
                .zip(one.std_error, |off, error| match error {
                    0.0 => 0.0,
                    error => (off / error).powi(2),
                })
                .zip(sum, |part, sum| sum + part * per_freedom)
        });
        let chi_square = (number > 1).then(|| {
            let mut largest = 0.0_f64;
            consistency.for_each(|x| largest = largest.max(x));
            largest
        });
        // Three standard deviations of chi-square per degree of freedom: errors that the iterations contradict give way to the
        // spread of the iterations.
        let limit = 1.0 + 3.0 * (2.0 * per_freedom).sqrt();
        let contradicted = chi_square.is_some_and(|chi_square| chi_square > limit);
        let means: Moments<V> = main.iter().map(|one| one.mean).collect();
        let spread = means.std_error().unwrap_or(V::ZERO);
        let spread = consistency.zip(
            spread,
            |chi_square, spread| {
                if chi_square > limit { spread } else { 0.0 }
            },
        );
        let freedom = if contradicted {
            strata.freedom.min(number as f64 - 1.0)
        } else {
            strata.freedom
        };
        Self {
            strata,
            std_error: std_error.zip(spread, f64::max),
            freedom,
            chi_square,
            limit,
        }
    }

    /// The chi-square, if it is too large for the errors to hold.
    pub(super) fn contradiction(&self) -> Option<f64> {
        self.chi_square
            .filter(|&chi_square| chi_square > self.limit)
    }
}
