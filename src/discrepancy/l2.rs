//! The L2 discrepancies: root mean squares of local discrepancies, in closed form.

mod compensated;
mod division;
mod kernel;
mod pairs;
mod updatable;

use self::compensated::Compensated;
use self::kernel::{Centred, Diaphony, Extreme, Kernel, Mixture, Star, Symmetric, WrapAround};
use self::pairs::Tiles;
use super::Points;
use crate::Error;

pub use updatable::UpdatableL2;

/// The discrepancies that are root mean squares over a family of boxes, each a double sum over the points.
///
/// All have the form
///
/// `D^2 = c^d - 2/n sum_i prod_k h(x_ik) + 1/n^2 sum_ij prod_k K(x_ik, x_jk)`
///
/// with a kernel `K` of one coordinate of two points, `h(x)` its integral over the one and `c` its integral over both.
/// Time `O(d n^2)`, memory `O(d n)`; where it is less, [`Star`](Self::Star) takes `O(n log^(d-1) n)` by divide and
/// conquer.
///
/// # Accuracy
///
/// The three terms cancel to a number far below each of them. The sums are compensated, so that what is lost is
/// what the products themselves have lost to rounding, which averages out; the square is never below zero.
///
/// ```
/// use estimand::discrepancy::{L2, Points};
///
/// // Van der Corput's first eight points: the square is 1 / (3 * 8^2).
/// let points = [0.0, 0.5, 0.25, 0.75, 0.125, 0.625, 0.375, 0.875];
/// let points = Points::from_rows(&points, 1)?;
/// assert!((L2::Star.squared(&points) - 1.0 / 192.0).abs() < 1e-15);
/// assert!((L2::Star.root(&points) - (1.0_f64 / 192.0).sqrt()).abs() < 1e-14);
/// # Ok::<(), estimand::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum L2 {
    /// Boxes anchored at the origin; the integral of the squared local discrepancy over all corners.[^warnock]
    ///
    /// `D^2 = int (vol [0, y) - #{x in [0, y)} / n)^2 dy`: `K(x, y) = 1 - max(x, y)`, `h(x) = (1 - x^2) / 2`,
    /// `c = 1/3`.
    ///
    /// The point 1/2: the mean of `y^2` below it and of `(1 - y)^2` above is `1/3 - 2 * 3/8 + 1/2 = 1/12`.
    ///
    /// ```
    /// # use estimand::discrepancy::{L2, Points};
    /// let half = Points::from_rows(&[0.5], 1)?;
    /// assert!((L2::Star.squared(&half) - 1.0 / 12.0).abs() < 1e-15);
    /// # Ok::<(), estimand::Error>(())
    /// ```
    ///
    /// [^warnock]: Warnock, Tony (1972). *Computational Investigations of Low-Discrepancy Point Sets*.
    ///     <https://doi.org/10.1016/B978-0-12-775950-0.50015-7>
    Star,
    /// Boxes anchored at the corner of the cube that is nearest, in all projections.[^hickernell]
    ///
    /// `D^2 = sum_u int (vol J(y) - #{x in J(y)} / n)^2 dy`, over all sets `u` of dimensions but the empty one, with `J(y)`
    /// between `y` and the corner nearest to it, and points projected onto `u`.
    ///
    /// With `a = |x - 1/2|` and `b = |y - 1/2|`: `K = 1 + (a + b - |x - y|) / 2`, `h = 1 + (a - a^2) / 2`, `c = 13/12`.
    ///
    /// The point 1/2: no box holds it inside, and the mean of the squared length is `13/12 - 2 + 1 = 1/12`.
    ///
    /// ```
    /// # use estimand::discrepancy::{L2, Points};
    /// let half = Points::from_rows(&[0.5], 1)?;
    /// assert!((L2::Centred.squared(&half) - 1.0 / 12.0).abs() < 1e-15);
    /// # Ok::<(), estimand::Error>(())
    /// ```
    ///
    /// [^hickernell]: Hickernell, Fred (1998). *A Generalized Discrepancy and Quadrature Error Bound*.
    ///     <https://doi.org/10.1090/S0025-5718-98-00894-1>
    Centred,
    /// Boxes with any two corners, wrapped around the torus, in all projections.[^wrap]
    ///
    /// `D^2 = sum_u int int (vol J(y, z) - #{x in J(y, z)} / n)^2 dy dz` over all sets `u` of dimensions but the empty one, with
    /// `J(y, z)` from `y` up to `z`, through 1 if `z` is below `y`.
    ///
    /// With `t = |x - y|`: `K = 3/2 - t (1 - t)`, `h = c = 4/3`.
    ///
    /// A single point anywhere in one dimension: `4/3 - 2 * 4/3 + 3/2 = 1/6`.
    ///
    /// ```
    /// # use estimand::discrepancy::{L2, Points};
    /// let half = Points::from_rows(&[0.5], 1)?;
    /// assert!((L2::WrapAround.squared(&half) - 1.0 / 6.0).abs() < 1e-15);
    /// # Ok::<(), estimand::Error>(())
    /// ```
    ///
    /// [^wrap]: Hickernell, Fred (1998). *Lattice Rules: How Well Do They Measure Up?*
    ///     In *Random and Quasi-Random Point Sets*, Springer, 109-166.
    WrapAround,
    /// A mixture of the centred and the wrap-around one that has the faults of neither.[^zhou]
    ///
    /// With `a = |x - 1/2|`, `b = |y - 1/2|`, `t = |x - y|`: `K = 15/8 - (a + b + 3 t - 2 t^2) / 4`,
    /// `h = 5/3 - (a + a^2) / 4`, `c = 19/12`.
    ///
    /// The point 1/2: `19/12 - 2 * 5/3 + 15/8 = 1/8`, the mean of 1/12 and 1/6.
    ///
    /// ```
    /// # use estimand::discrepancy::{L2, Points};
    /// let half = Points::from_rows(&[0.5], 1)?;
    /// assert!((L2::Mixture.squared(&half) - 1.0 / 8.0).abs() < 1e-15);
    /// # Ok::<(), estimand::Error>(())
    /// ```
    ///
    /// [^zhou]: Zhou, Yong-Dao; Fang, Kai-Tai; Ning, Jian-Hui (2013). *Mixture Discrepancy for Quasi-Random Point
    ///     Sets*. <https://doi.org/10.1016/j.jco.2012.11.006>
    Mixture,
    /// Unions of boxes anchored at an even number of steps from a corner, in all projections.[^symmetric]
    ///
    /// `D^2 = sum_u 4 int (vol J(y) - #{x in J(y)} / n)^2 dy` over all sets `u` of dimensions but the empty one, with `J(y)`
    /// the points at or above `y` along an even number of the dimensions.
    ///
    /// `K = 2 - 2 |x - y|`, `h = 1 + 2 x - 2 x^2`, `c = 4/3`.
    ///
    /// The point 1/2: `4/3 - 2 * 3/2 + 2 = 1/3`, four times the square of the star.
    ///
    /// ```
    /// # use estimand::discrepancy::{L2, Points};
    /// let half = Points::from_rows(&[0.5], 1)?;
    /// assert!((L2::Symmetric.squared(&half) - 1.0 / 3.0).abs() < 1e-15);
    /// # Ok::<(), estimand::Error>(())
    /// ```
    ///
    /// [^symmetric]: Hickernell (1998), as for [`Centred`](Self::Centred), section 5.
    Symmetric,
    /// Boxes with any two corners inside the cube, also called unanchored.[^morokoff]
    ///
    /// `D^2 = int int (vol [y, z) - #{x in [y, z)} / n)^2 dy dz` over all `y <= z`: `K = min(x, y) - x y`,
    /// `h = (x - x^2) / 2`, `c = 1/12`.
    ///
    /// The point 1/2: `1/12 - 2 * 1/8 + 1/4 = 1/12`.
    ///
    /// ```
    /// # use estimand::discrepancy::{L2, Points};
    /// let half = Points::from_rows(&[0.5], 1)?;
    /// assert!((L2::Extreme.squared(&half) - 1.0 / 12.0).abs() < 1e-15);
    /// # Ok::<(), estimand::Error>(())
    /// ```
    ///
    /// [^morokoff]: Morokoff, William; Caflisch, Russel (1994). *Quasi-Random Sequences and Their Discrepancies*.
    ///     <https://doi.org/10.1137/0915077>
    Extreme,
    /// The diaphony: no boxes but waves, `D^2 = sum_f prod_k max(1, |f_k|)^-2 |1/n sum_i exp(2 pi j f x_i)|^2` over all whole
    /// frequencies `f` but 0.[^zinterhof]
    ///
    /// With `t = |x - y|`: `K = 1 + 2 pi^2 (t^2 - t + 1/6)`, `h = c = 1`. Not normalised: a single point has a square of
    /// `(1 + pi^2 / 3)^d - 1`: in one dimension twice the sum of all `f^-2`, which is `pi^2 / 6`.
    ///
    /// ```
    /// # use estimand::discrepancy::{L2, Points};
    /// let half = Points::from_rows(&[0.5], 1)?;
    /// assert!((L2::Diaphony.squared(&half) - std::f64::consts::PI.powi(2) / 3.0).abs() < 1e-14);
    /// # Ok::<(), estimand::Error>(())
    /// ```
    ///
    /// [^zinterhof]: Zinterhof, Peter (1976). *Über einige Abschätzungen bei der Approximation von Funktionen mit
    ///     Gleichverteilungsmethoden*. Sitzungsberichte der Österreichischen Akademie der Wissenschaften II 185.
    Diaphony,
}

/// Evaluates an expression with `$K` the kernel of a kind.
macro_rules! with_kernel {
    ($kind:expr, $K:ident => $value:expr) => {
        match $kind {
            L2::Star => {
                type $K = Star;
                $value
            }
            L2::Centred => {
                type $K = Centred;
                $value
            }
            L2::WrapAround => {
                type $K = WrapAround;
                $value
            }
            L2::Mixture => {
                type $K = Mixture;
                $value
            }
            L2::Symmetric => {
                type $K = Symmetric;
                $value
            }
            L2::Extreme => {
                type $K = Extreme;
                $value
            }
            L2::Diaphony => {
                type $K = Diaphony;
                $value
            }
        }
    };
}

impl L2 {
    /// The square of the discrepancy.
    pub fn squared(self, points: &Points<'_>) -> f64 {
        let (singles, pairs) = self.sums(points);
        assemble(
            points.count(),
            self.mean(points.dimensions()),
            singles,
            pairs,
        )
    }

    /// The discrepancy: the root of the [square](Self::squared).
    pub fn root(self, points: &Points<'_>) -> f64 {
        self.squared(points).sqrt()
    }

    /// The square of the weighted discrepancy: the sum over all sets of dimensions but the empty one of the product of their
    /// weights times the squared discrepancy of the points' projection onto them.[^sloan]
    ///
    /// The kernel is `prod_k (1 + w_k k(x_k, y_k))`, with `k` the kernel above, less 1 for those "in all projections". So for
    /// these all weights 1 give [`squared`](Self::squared); for [`Star`](Self::Star) and [`Extreme`](Self::Extreme) they give
    /// the sum over all projections, where `squared` is that of all dimensions together alone.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for another number of weights than dimensions, and a weight that is negative, infinite or NaN.
    ///
    /// [^sloan]: Sloan, Ian; Woźniakowski, Henryk (1998). *When Are Quasi-Monte Carlo Algorithms Efficient for High
    ///     Dimensional Integrals?* Journal of Complexity 14.
    pub fn squared_weighted(self, points: &Points<'_>, weights: &[f64]) -> Result<f64, Error> {
        if weights.len() != points.dimensions() {
            return Err(Error::refused(
                "number of weights",
                "that of the dimensions",
                format_args!("{}, not {}", weights.len(), points.dimensions()),
            ));
        }
        for (dimension, &weight) in weights.iter().enumerate() {
            if !(weight >= 0.0 && weight.is_finite()) {
                return Err(Error::refused(
                    "weight of a dimension",
                    "finite and at least 0",
                    format_args!("{weight}, of dimension {dimension}"),
                ));
            }
        }
        Ok(with_kernel!(self, K => weighted::<K>(points, weights)))
    }

    /// The weighted discrepancy: the root of its [square](Self::squared_weighted).
    ///
    /// # Errors
    ///
    /// As for [`squared_weighted`](Self::squared_weighted).
    pub fn root_weighted(self, points: &Points<'_>, weights: &[f64]) -> Result<f64, Error> {
        self.squared_weighted(points, weights).map(f64::sqrt)
    }

    /// The integral of the kernel.
    fn mean(self, dimensions: usize) -> Compensated {
        let (numerator, denominator) = with_kernel!(self, K => K::MEAN);
        (0..dimensions).fold(Compensated::from(1.0), |power, _| {
            power.times(numerator).over(denominator)
        })
    }

    /// The sums over all points and over all ordered pairs of points.
    fn sums(self, points: &Points<'_>) -> (Compensated, Compensated) {
        let pairs = if self == Self::Star && division::pays(points.count(), points.dimensions()) {
            division::sum(points)
        } else {
            with_kernel!(self, K => {
                let scale = (0..points.dimensions()).map(|_| K::SCALE).product();
                Tiles::new::<K>(points).sum::<K>(|_, pair| pair).times(scale)
            })
        };
        let mut singles = Compensated::ZERO;
        with_kernel!(self, K => {
            for row in points.rows() {
                singles.add(row.iter().map(|&x| K::single(x)).product());
            }
        });
        (singles, pairs)
    }

    /// What one point adds to the sum over all points, what its pair with itself adds to the sum over the pairs, and what its
    /// pairs with others add to it in one of their two orders.
    fn sums_with<'a>(
        self,
        point: &[f64],
        others: impl Iterator<Item = &'a [f64]>,
    ) -> (f64, f64, Compensated) {
        with_kernel!(self, K => {
            let single = point.iter().map(|&x| K::single(x)).product();
            let pair = |other: &[f64]| -> f64 {
                point
                    .iter()
                    .zip(other)
                    .map(|(&x, &y)| K::SCALE * K::pair(K::features(x), K::features(y)))
                    .product()
            };
            let mut pairs = Compensated::ZERO;
            others.for_each(|other| pairs.add(pair(other)));
            (single, pair(point), pairs)
        })
    }
}

/// The square of a discrepancy from its three terms.
fn assemble(count: usize, mean: Compensated, singles: Compensated, pairs: Compensated) -> f64 {
    let count = count as f64;
    let mut squared = mean;
    squared.merge(singles.times(-2.0).over(count));
    squared.merge(pairs.over(count).over(count));
    // What is left of the sum may be smaller than the rounding of the products in it.
    squared.value().max(0.0)
}

fn weighted<K: Kernel>(points: &Points<'_>, weights: &[f64]) -> f64 {
    let offset = |weight: f64| if K::PROJECTIONS { 1.0 - weight } else { 1.0 };
    let offsets: Vec<f64> = weights.iter().map(|&weight| offset(weight)).collect();
    let slopes: Vec<f64> = weights.iter().map(|&weight| weight * K::SCALE).collect();
    let (numerator, denominator) = K::MEAN;
    let mean = weights
        .iter()
        .fold(Compensated::from(1.0), |mean, &weight| {
            let numerator = offset(weight) * denominator + weight * numerator;
            mean.times(numerator).over(denominator)
        });
    let mut singles = Compensated::ZERO;
    for row in points.rows() {
        let factors = row.iter().zip(weights);
        singles.add(
            factors
                .map(|(&x, &weight)| offset(weight) + weight * K::single(x))
                .product(),
        );
    }
    let pairs = Tiles::new::<K>(points)
        .sum::<K>(|dimension, pair| offsets[dimension] + slopes[dimension] * pair);
    assemble(points.count(), mean, singles, pairs)
}
