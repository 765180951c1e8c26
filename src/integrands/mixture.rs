//! Several densities at once: one sample of the mixture, or some samples of each.

use core::fmt;

use super::importance::weighted;
use crate::warp::{AliasTable, Warp};
use crate::{Error, Integrand, Sampler, Value};

/// How the samples of several densities share the weight of a point: multiple importance sampling.[^veach]
///
/// ```
/// use estimand::integrands::Heuristic;
///
/// let weight = Heuristic::Power.weight(3.0, &[1.0]);
/// assert!((weight - 0.9).abs() < 1e-15);
/// // Not even infinite densities, or ones whose squares are infinite, break the sum of 1.
/// assert_eq!(Heuristic::Power.weight(1e200, &[1e200]), 0.5);
/// assert_eq!(Heuristic::Balance.weight(0.0, &[0.0]), 0.0);
/// ```
///
/// [^veach]: Veach, Eric; Guibas, Leonidas (1995). *Optimally Combining Sampling Techniques for Monte Carlo
///     Rendering*. <https://doi.org/10.1145/218380.218498>
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Heuristic {
    /// In proportion to the expected number of samples: never much worse than the best choice of weights.
    #[default]
    Balance,
    /// In proportion to its square: better where one density is nearly proportional to the function.
    Power,
}

impl Heuristic {
    /// The weight of a sample, in `[0, 1]`, from a technique with `density` where the others have `others`.
    ///
    /// Densities are multiplied by the number of samples of their technique beforehand. A density of zero has weight
    /// zero. The weights of all techniques at one point add up to 1.
    #[inline]
    pub fn weight(self, density: f64, others: &[f64]) -> f64 {
        if density.is_nan() || density <= 0.0 {
            return 0.0;
        }
        // As ratios, whose squares overflow only where the weight is zero anyway.
        let rest: f64 = others
            .iter()
            .map(|&other| {
                let ratio = if other == density {
                    1.0
                } else {
                    other / density
                };
                match self {
                    Self::Balance => ratio,
                    Self::Power => ratio * ratio,
                }
            })
            .sum();
        1.0 / (1.0 + rest)
    }
}

/// A mixture of densities on one domain: a choice among warps, then a sample of the chosen.
///
/// The density is that of the mixture, so that [`Importance`](super::Importance) with it is multiple importance sampling with
/// one sample and the balance heuristic. The first coordinate chooses, and what is left of it is used
/// again.
///
/// ```
/// use estimand::integrands::{Importance, Mixture};
/// use estimand::warp::{Normal, Warp};
/// use estimand::{Estimator, MonteCarlo};
///
/// let (left, right) = (Normal::new(-3.0, 0.1)?, Normal::new(4.0, 1.0)?);
/// let both = Mixture::new(&[0.5, 0.5], [left, right])?;
/// let f = Importance::new(&both, |x: f64| 2.0 * left.density(x) + right.density(x));
/// let estimate = MonteCarlo::new(10_000, 1).estimate(&f)?;
/// assert!((estimate.mean - 3.0).abs() < 4.0 * estimate.std_error.unwrap());
/// # Ok::<(), estimand::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Mixture<W, const N: usize> {
    table: AliasTable,
    warps: [W; N],
}

impl<W, const N: usize> Mixture<W, N> {
    /// The mixture of `warps` with probabilities proportional to `weights`.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] as [`AliasTable::new`], and for another number of weights than of warps.
    pub fn new(weights: &[f64], warps: [W; N]) -> Result<Self, Error> {
        if weights.len() != N {
            let domain = "one for each warp";
            return Err(Error::refused("number of weights", domain, weights.len()));
        }
        let table = AliasTable::new(weights)?;
        Ok(Self { table, warps })
    }
}

impl<const D: usize, W: Warp<D>, const N: usize> Warp<D> for Mixture<W, N> {
    type Point = W::Point;

    #[inline]
    fn sample(&self, mut u: [f64; D]) -> W::Point {
        let choice = self.table.choose(u[0]);
        u[0] = choice.u;
        self.warps[choice.index].sample(u)
    }

    #[inline]
    fn density(&self, point: W::Point) -> f64 {
        (0..N)
            .map(|index| self.table.probability(index) * self.warps[index].density(point))
            .sum()
    }

    /// `None` always: several `u` lead to each point.
    fn invert(&self, _: W::Point) -> Option<[f64; D]> {
        None
    }
}

/// A function on the domain that several warps share, integrated with some samples of each: multiple importance
/// sampling with more than one sample.
///
/// One evaluation takes all the samples, and asks the function that many times. For warps of different types
/// use references `&dyn Warp<D, Point = P>`.
///
/// ```
/// use estimand::integrands::{Heuristic, MultiSample};
/// use estimand::warp::{Exponential, Normal, Warp};
/// use estimand::{Estimator, MonteCarlo};
///
/// let (normal, tail) = (Normal::new(0.0, 0.1)?, Exponential::new(1.0)?);
/// let warps: [&dyn Warp<1, Point = f64>; 2] = [&normal, &tail];
/// let f = MultiSample::new(warps, [1, 2], Heuristic::Power, |x: f64| {
///     normal.density(x) + tail.density(x)
/// })?;
/// let estimate = MonteCarlo::new(10_000, 1).estimate(&f)?;
/// assert!((estimate.mean - 2.0).abs() < 4.0 * estimate.std_error.unwrap());
/// # Ok::<(), estimand::Error>(())
/// ```
#[derive(Clone, Copy)]
#[must_use]
pub struct MultiSample<const D: usize, W, F, const N: usize> {
    warps: [W; N],
    counts: [u32; N],
    heuristic: Heuristic,
    function: F,
}

impl<const D: usize, V: Value, W: Warp<D>, F: Fn(W::Point) -> V + Sync, const N: usize>
    MultiSample<D, W, F, N>
{
    /// `counts[k]` samples of `warps[k]`, weighted by `heuristic`.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] if all counts are zero.
    pub fn new(
        warps: [W; N],
        counts: [u32; N],
        heuristic: Heuristic,
        function: F,
    ) -> Result<Self, Error> {
        if counts.iter().all(|&count| count == 0) {
            return Err(Error::refused("counts", "at least one above zero", 0));
        }
        Ok(Self {
            warps,
            counts,
            heuristic,
            function,
        })
    }
}

impl<const D: usize, V: Value, W: Warp<D>, F: Fn(W::Point) -> V + Sync, const N: usize> Integrand
    for MultiSample<D, W, F, N>
{
    type Value = V;

    fn evaluate<S: Sampler>(&self, u: &mut S) -> V {
        let mut sum = V::ZERO;
        for technique in 0..N {
            for _ in 0..self.counts[technique] {
                let point = self.warps[technique].sample(core::array::from_fn(|_| u.next_1d()));
                let mut others: [f64; N] = core::array::from_fn(|k| match self.counts[k] {
                    0 => 0.0,
                    count => f64::from(count) * self.warps[k].density(point),
                });
                let density = core::mem::replace(&mut others[technique], 0.0);
                let weight = self.heuristic.weight(density, &others);
                let value = weighted(&self.function, point, density);
                sum = sum.zip(value, |sum, value| sum + weight * value);
            }
        }
        sum
    }

    #[expect(clippy::cast_possible_truncation, reason = "a handful of coordinates")]
    fn dimensions(&self) -> u32 {
        self.counts
            .iter()
            .fold(0_u32, |sum, &count| sum.saturating_add(count))
            .saturating_mul(D as u32)
    }
}

impl<const D: usize, W, F, const N: usize> fmt::Debug for MultiSample<D, W, F, N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("MultiSample")
            .field("counts", &self.counts)
            .field("heuristic", &self.heuristic)
            .finish_non_exhaustive()
    }
}
