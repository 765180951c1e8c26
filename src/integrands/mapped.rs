//! A map that sends points where the integrand is large, axis by axis.

use crate::block::smaller;
use crate::{Error, Integrand, Sampler, Value, reduce};

/// A map of the unit cube onto itself that sends more points where an integrand is large: VEGAS' importance map.[^lepage]
///
/// Each axis is cut into bins of unequal width that all get the same share of the points. It is learned by a
/// [`Vegas`](crate::estimators::Vegas) and can then be used with any points and any estimator, by way of [`Mapped`];
/// with the feature `serde` it can be saved.
///
/// It knows nothing of how the axes belong together: peaks along a diagonal stay hidden from it.
///
/// ```
/// use estimand::estimators::Vegas;
/// use estimand::integrands::Mapped;
/// use estimand::points::{Owen, Sobol};
/// use estimand::{Estimator, Replicated, cube};
///
/// let peak = cube(|x: [f64; 4]| {
///     let square: f64 = x.iter().map(|x| ((x - 0.3) / 0.01).powi(2)).sum();
///     (-0.5 * square).exp()
/// });
/// let truth = (2.0 * std::f64::consts::PI).powi(2) * 1e-8;
///
/// let map = Vegas::new(4, 50_000, 1)?.train(&peak)?;
/// let sobol = Sobol::new(4)?;
/// let estimate = Replicated::new(8, 1 << 12, |seed| sobol.clone().scrambled(Owen { seed }))
///     .estimate(&Mapped::new(&peak, &map))?;
/// assert!((estimate.mean / truth - 1.0).abs() < 1e-3);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^lepage]: Lepage, Peter (2021). *Adaptive Multidimensional Integration: VEGAS Enhanced*.
///     <https://doi.org/10.1016/j.jcp.2021.110386>
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ImportanceMap {
    /// The ends of the bins of each axis, rising from 0 to 1.
    axes: Vec<Vec<f64>>,
}

/// One bin of an axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bin {
    start: f64,
    width: f64,
    pub(crate) jacobian: f64,
}

impl Bin {
    /// The point of the bin at the part `within` of its width.
    #[inline]
    pub(crate) fn image(&self, within: f64) -> f64 {
        const ALMOST_ONE: f64 = 1.0 - f64::EPSILON / 2.0;
        smaller(ALMOST_ONE, self.start + within * self.width)
    }
}

impl ImportanceMap {
    /// The map that changes nothing, of `dimensions` axes with `bins` bins each. Further coordinates are not mapped.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for no bins.
    pub fn identity(dimensions: u32, bins: usize) -> Result<Self, Error> {
        if bins == 0 {
            return Err(Error::refused("number of bins", "at least 1", bins));
        }
        let axis: Vec<f64> = (0..=bins).map(|end| end as f64 / bins as f64).collect();
        Ok(Self {
            axes: vec![axis; dimensions as usize],
        })
    }

    /// The ends of the bins of the axis `dimension`, rising from 0 to 1; `None` past the last axis.
    pub fn axis(&self, dimension: usize) -> Option<&[f64]> {
        self.axes.get(dimension).map(Vec::as_slice)
    }

    /// How many axes are mapped.
    pub fn dimensions(&self) -> usize {
        self.axes.len()
    }

    /// How many bins each axis has.
    pub fn bins(&self) -> usize {
        self.axes.first().map_or(1, |axis| axis.len() - 1)
    }

    /// The bins of all axes, one axis after the other.
    pub(crate) fn table(&self) -> Vec<Bin> {
        let bins = |axis: &Vec<f64>| {
            let number = axis.len() as f64 - 1.0;
            let bin = move |ends: &[f64]| Bin {
                start: ends[0],
                width: ends[1] - ends[0],
                jacobian: (ends[1] - ends[0]) * number,
            };
            axis.windows(2).map(bin).collect::<Vec<_>>()
        };
        self.axes.iter().flat_map(bins).collect()
    }

    /// The map with ends of bins moved so that each holds the same part of `weights`, the mean square of the integrand in each bin,
    /// as far as `damping` lets it: shares follow the weights to this power, all the way at 1/2, and not at all at 0. Weights
    /// that are all zero or not finite change nothing.
    ///
    /// In the long run no bin is more than twice as wide as its neighbours.
    pub(crate) fn refined(&self, weights: &[Vec<f64>], damping: f64) -> Self {
        let refined = |place: usize, axis: &Vec<f64>| refined(axis, &weights[place], damping);
        Self {
            axes: reduce::at_each(&self.axes, refined),
        }
    }
}

/// The ends of the bins of one axis, moved as their `weights` want them.
fn refined(axis: &[f64], weights: &[f64], damping: f64) -> Vec<f64> {
    let mut ends = axis.to_vec();
    let sum: f64 = weights.iter().sum();
    if weights.len() < 2 || !(sum > 0.0 && sum.is_finite()) {
        return ends;
    }
    let last = weights.len() - 1;
    let smooth: Vec<f64> = (0..=last)
        .map(|bin| {
            let left = weights[bin.saturating_sub(1)];
            let right = weights[(bin + 1).min(last)];
            (left + 6.0 * weights[bin] + right) / (8.0 * sum)
        })
        .collect();
    let mut damped: Vec<f64> = smooth.iter().map(|share| share.powf(damping)).collect();
    grade(&mut damped, axis);
    let total: f64 = damped.iter().sum();
    let share = total / damped.len() as f64;
    let (mut bin, mut before) = (0, 0.0);
    for (place, end) in ends.iter_mut().enumerate().take(last + 1).skip(1) {
        let target = share * place as f64;
        while bin < last && before + damped[bin] < target {
            before += damped[bin];
            bin += 1;
        }
        let within = if damped[bin] > 0.0 {
            ((target - before) / damped[bin]).clamp(0.0, 1.0)
        } else {
            1.0
        };
        *end = axis[bin] + within * (axis[bin + 1] - axis[bin]);
    }
    ends
}

/// Raises the `shares` of the bins of `axis` so far that, as they are repeated, no bin stays more than twice as wide as its
/// neighbours.
///
/// Where an integrand ends within a bin, or where all points of a bin missed it, the bin's few hits have the weight of its
/// width: much wider than the next bin, they are the rare events that make error bars lie.
fn grade(shares: &mut [f64], axis: &[f64]) {
    let width = |bin: usize| axis[bin + 1] - axis[bin];
    let mut raise = |bin: usize, neighbour: usize| {
        // So many bins, each twice as wide as the one before, lead from the neighbour across the bin.
        let ratio = width(bin) / width(neighbour).max(f64::MIN_POSITIVE);
        // Mostly they are not: the logarithm is below 0.73 of the ratio.
        if shares[neighbour] * (0.73 * ratio) <= shares[bin] {
            return;
        }
        shares[bin] = shares[bin].max(shares[neighbour] * (1.0 + 0.5 * ratio).log2());
    };
    let last = axis.len() - 2;
    (1..=last).for_each(|bin| raise(bin, bin - 1));
    (0..last).rev().for_each(|bin| raise(bin, bin + 1));
}

/// An integrand at the images of the points under an [`ImportanceMap`], weighted so that its integral stays the same.
#[derive(Clone, Debug)]
#[must_use]
pub struct Mapped<I> {
    integrand: I,
    bins: Vec<Bin>,
    /// How many bins an axis has.
    number: usize,
}

impl<I: Integrand> Mapped<I> {
    /// `integrand` under `map`.
    pub fn new(integrand: I, map: &ImportanceMap) -> Self {
        Self {
            integrand,
            bins: map.table(),
            number: map.bins(),
        }
    }
}

impl<I: Integrand> Integrand for Mapped<I> {
    type Value = I::Value;

    #[inline]
    fn evaluate<S: Sampler>(&self, u: &mut S) -> I::Value {
        let mut u = Images {
            inner: u,
            bins: &self.bins,
            number: self.number,
            jacobian: 1.0,
        };
        let value = self.integrand.evaluate(&mut u);
        let jacobian = u.jacobian;
        value.map(|value| value * jacobian)
    }

    fn dimensions(&self) -> u32 {
        self.integrand.dimensions()
    }
}

/// The images of coordinates.
struct Images<'a, S> {
    inner: &'a mut S,
    /// The bins of the axes that are left.
    bins: &'a [Bin],
    number: usize,
    jacobian: f64,
}

impl<S: Sampler> Sampler for Images<'_, S> {
    #[inline]
    fn next_1d(&mut self) -> f64 {
        let u = self.inner.next_1d();
        let Some((axis, left)) = self.bins.split_at_checked(self.number) else {
            return u;
        };
        self.bins = left;
        let scaled = u * axis.len() as f64;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "below the number of bins"
        )]
        let bin = (scaled as usize).min(axis.len() - 1);
        self.jacobian *= axis[bin].jacobian;
        axis[bin].image(scaled - bin as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_learns_a_density_of_one_axis() {
        // Weights proportional to the square of the density 2 x: without damping's compression the ends tend to the
        // square roots of equal steps.
        let mut map = ImportanceMap::identity(1, 64).unwrap();
        for _ in 0..60 {
            let axis = map.axis(0).unwrap().to_vec();
            let weights = axis
                .windows(2)
                .map(|ends| ((ends[0] + ends[1]) * (ends[1] - ends[0])).powi(2))
                .collect();
            map = map.refined(&[weights], 0.7);
        }
        for (place, end) in map.axis(0).unwrap().iter().enumerate() {
            let expected = (place as f64 / 64.0).sqrt();
            assert!((end - expected).abs() < 0.02, "{end} at {place}");
        }
    }

    #[test]
    fn an_edge_has_no_bin_much_wider_than_the_next() {
        // 1 up to 0.3 and 0 beyond: without grading one bin reaches from the edge to the end, a hundred times as wide as
        // the next.
        let mut map = ImportanceMap::identity(1, 64).unwrap();
        for _ in 0..60 {
            let axis = map.axis(0).unwrap().to_vec();
            let weights = axis
                .windows(2)
                .map(|ends| (0.3 - ends[0]).clamp(0.0, ends[1] - ends[0]) * (ends[1] - ends[0]))
                .collect();
            map = map.refined(&[weights], 0.5);
        }
        let axis = map.axis(0).unwrap();
        let widths: Vec<f64> = axis.windows(2).map(|ends| ends[1] - ends[0]).collect();
        for pair in widths.windows(2) {
            let ratio = (pair[0] / pair[1]).max(pair[1] / pair[0]);
            assert!(ratio < 2.2, "{pair:?}");
        }
        let beyond = axis.iter().filter(|&&end| end > 0.3).count();
        assert!(beyond < 16, "{beyond} of 64 bins are where nothing is");
    }

    #[test]
    fn nothing_learned_is_nothing_changed() {
        let identity = ImportanceMap::identity(2, 8).unwrap();
        for weights in [0.0, f64::NAN, f64::INFINITY] {
            let mut map = identity.clone();
            map = map.refined(&vec![vec![weights; 8]; 2], 0.5);
            assert_eq!(map, identity);
        }
        let mut single = ImportanceMap::identity(2, 1).unwrap();
        single = single.refined(&vec![vec![3.0]; 2], 0.5);
        assert_eq!(single, ImportanceMap::identity(2, 1).unwrap());
    }

    #[test]
    fn bins_stay_in_order_when_all_weight_is_in_one() {
        let mut map = ImportanceMap::identity(1, 8).unwrap();
        for hot in [0, 3, 7] {
            for _ in 0..200 {
                let mut weights = vec![0.0; 8];
                weights[hot] = 1e300;
                map = map.refined(&[weights], 1.5);
                let axis = map.axis(0).unwrap();
                assert!(axis.windows(2).all(|ends| ends[0] <= ends[1]), "{axis:?}");
                assert_eq!((axis[0], axis[8]), (0.0, 1.0));
            }
        }
    }
}
