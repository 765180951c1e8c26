//! Covariances, and ratios of integrals.

use crate::quantile::student;
use crate::{ErrorBar, Estimate, Estimator, Incomplete, Integrand, Interval, Sampler};

/// The components of a vector, their sums and their differences: what covariances are made of.
///
/// Whatever estimator gives standard errors gives covariances too, by `Cov(a, b) = (Var(a + b) - Var(a - b)) / 4`:
/// estimate this, and ask the [estimate](Estimate::covariance). Replicates, strata and iterations all are
/// accounted for as in the errors themselves.
///
/// The value at row `i` and column `j` is the component `i` for `i = j`, the sum of the two for `i < j` and their
/// difference for `i > j`.
///
/// ```
/// use estimand::{Estimator, MonteCarlo, cube, integrands::Joint};
///
/// let f = cube(|[x]| [x, x * x]);
/// let count = 100_000;
/// let estimate = MonteCarlo::new(count, 1).estimate(&Joint::new(f))?;
/// let covariance = estimate.covariance().unwrap();
/// // E[x^3] - E[x] E[x^2] = 1/12, over the number of points.
/// assert!((covariance[0][1] * count as f64 - 1.0 / 12.0).abs() < 0.002);
/// # Ok::<(), estimand::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
#[must_use]
pub struct Joint<I> {
    integrand: I,
}

impl<const N: usize, I: Integrand<Value = [f64; N]>> Joint<I> {
    /// The components of `integrand` and their pairs.
    pub const fn new(integrand: I) -> Self {
        Self { integrand }
    }
}

impl<const N: usize, I: Integrand<Value = [f64; N]>> Integrand for Joint<I> {
    type Value = [[f64; N]; N];

    #[inline]
    fn evaluate<S: Sampler>(&self, u: &mut S) -> [[f64; N]; N] {
        let x = self.integrand.evaluate(u);
        core::array::from_fn(|i| {
            core::array::from_fn(|j| match i.cmp(&j) {
                core::cmp::Ordering::Equal => x[i],
                core::cmp::Ordering::Less => x[i] + x[j],
                core::cmp::Ordering::Greater => x[i] - x[j],
            })
        })
    }

    fn dimensions(&self) -> u32 {
        self.integrand.dimensions()
    }
}

impl<const N: usize> Estimate<[[f64; N]; N]> {
    /// The means of the components of a [`Joint`].
    pub fn means(&self) -> [f64; N] {
        core::array::from_fn(|i| self.mean[i][i])
    }

    /// The covariance of the means of the components of a [`Joint`]: on the diagonal are the squares of the standard
    /// errors. `None` without an error bar.
    pub fn covariance(&self) -> Option<[[f64; N]; N]> {
        let error = self.std_error?;
        Some(core::array::from_fn(|i| {
            core::array::from_fn(|j| {
                if i == j {
                    return error[i][i] * error[i][i];
                }
                let (sum, difference) = (error[i.min(j)][i.max(j)], error[i.max(j)][i.min(j)]);
                0.25 * (sum - difference) * (sum + difference)
            })
        }))
    }
}

/// A ratio of two integrals, made by [`ratio`].
#[derive(Clone, Debug, PartialEq)]
#[must_use]
#[non_exhaustive]
pub struct Ratio {
    /// The quotient of the two estimates.
    ///
    /// Its bias falls as the square of the standard error.
    pub value: f64,
    /// Its standard error, to first order; `None` without an error bar.
    pub std_error: Option<f64>,
    /// The estimates of numerator and denominator, on the diagonal, and of their sum and difference.
    pub parts: Estimate<[[f64; 2]; 2]>,
}

impl Ratio {
    /// The interval that holds the ratio of the integrals with probability `level`, by Fieller's theorem.[^fieller]
    ///
    /// `None` without an error bar, and if the denominator may be zero at that level: no interval holds the
    /// ratio then.
    ///
    /// [^fieller]: Fieller, Edgar (1954). *Some Problems in Interval Estimation*.
    ///     <https://doi.org/10.1111/j.2517-6161.1954.tb00159.x>
    pub fn interval(&self, level: f64) -> Option<Interval<f64>> {
        if !(level > 0.0 && level < 1.0) {
            return None;
        }
        let freedom = match self.parts.error_bar {
            ErrorBar::SampleVariance => (self.parts.used - self.parts.rejected) as f64 - 1.0,
            ErrorBar::Replicates => self.parts.replicates.len() as f64 - 1.0,
            ErrorBar::Strata { freedom } => freedom,
            ErrorBar::None | ErrorBar::Bounded { .. } | ErrorBar::Median => return None,
        };
        let [[aa, ab], [_, bb]] = self.parts.covariance()?;
        let [a, b] = self.parts.means();
        let t = student(level, freedom);
        // The roots in r of (a - r b)^2 = t^2 (aa - 2 r ab + r^2 bb).
        let square = b * b - t * t * bb;
        let linear = a * b - t * t * ab;
        let constant = a * a - t * t * aa;
        if square.is_nan() || square <= 0.0 {
            return None;
        }
        let root = (linear * linear - square * constant).max(0.0).sqrt();
        Some(Interval {
            low: (linear - root) / square,
            high: (linear + root) / square,
        })
    }
}

/// The ratio of the integrals of the two components of `integrand`.
///
/// ```
/// use estimand::{MonteCarlo, cube, integrands::ratio};
///
/// // The mean of x under the density proportional to exp(-x).
/// let f = cube(|[x]: [f64; 1]| [x * (-x).exp(), (-x).exp()]);
/// let mean = ratio(&MonteCarlo::new(100_000, 1), &f)?;
/// let e = std::f64::consts::E;
/// assert!(mean.interval(0.9999).unwrap().contains((e - 2.0) / (e - 1.0)));
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// # Errors
///
/// As [`Estimator::estimate`].
pub fn ratio<E: Estimator, I: Integrand<Value = [f64; 2]>>(
    estimator: &E,
    integrand: &I,
) -> Result<Ratio, Incomplete<[[f64; 2]; 2]>> {
    let parts = estimator.estimate(&Joint::new(integrand))?;
    let [above, below] = parts.means();
    let value = above / below;
    let std_error = parts.covariance().map(|[[aa, ab], [_, bb]]| {
        (aa - 2.0 * value * ab + value * value * bb).max(0.0).sqrt() / below.abs()
    });
    Ok(Ratio {
        value,
        std_error,
        parts,
    })
}
