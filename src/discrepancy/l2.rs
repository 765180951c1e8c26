//! The L2 discrepancies: root mean squares of local discrepancies, in closed form.

mod compensated;
mod kernel;
mod pairs;

use self::compensated::Compensated;
use self::kernel::{Centred, Extreme, Kernel, Mixture, Star, Symmetric, WrapAround};
use self::pairs::Tiles;
use super::Points;

/// The discrepancies that are root mean squares over a family of boxes, each a double sum over the points.
///
/// All have the form
///
/// `D^2 = c^d - 2/n sum_i prod_k h(x_ik) + 1/n^2 sum_ij prod_k K(x_ik, x_jk)`
///
/// with a kernel `K` of one coordinate of two points, `h(x)` its integral over the one and `c` its integral over both.
/// Time `O(d n^2)`, memory `O(d n)`.
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
    /// `K(x, y) = 1 - max(x, y)`, `h(x) = (1 - x^2) / 2`, `c = 1/3`.
    ///
    /// [^warnock]: Warnock, Tony (1972). *Computational Investigations of Low-Discrepancy Point Sets*.
    ///     <https://doi.org/10.1016/B978-0-12-775950-0.50015-7>
    Star,
    /// Boxes anchored at the corner of the cube that is nearest, in all projections.[^hickernell]
    ///
    /// With `a = |x - 1/2|` and `b = |y - 1/2|`: `K = 1 + (a + b - |x - y|) / 2`, `h = 1 + (a - a^2) / 2`, `c = 13/12`.
    ///
    /// [^hickernell]: Hickernell, Fred (1998). *A Generalized Discrepancy and Quadrature Error Bound*.
    ///     <https://doi.org/10.1090/S0025-5718-98-00894-1>
    Centred,
    /// Boxes with any two corners, wrapped around the torus, in all projections.[^wrap]
    ///
    /// With `t = |x - y|`: `K = 3/2 - t (1 - t)`, `h = c = 4/3`.
    ///
    /// [^wrap]: Hickernell, Fred (1998). *Lattice Rules: How Well Do They Measure Up?*
    ///     <https://doi.org/10.1007/978-1-4612-1702-2_3>
    WrapAround,
    /// A mixture of the centred and the wrap-around one that has the faults of neither.[^zhou]
    ///
    /// With `a = |x - 1/2|`, `b = |y - 1/2|`, `t = |x - y|`: `K = 15/8 - (a + b + 3 t - 2 t^2) / 4`,
    /// `h = 5/3 - (a + a^2) / 4`, `c = 19/12`.
    ///
    /// [^zhou]: Zhou, Yong-Dao; Fang, Kai-Tai; Ning, Jian-Hui (2013). *Mixture Discrepancy for Quasi-Random Point
    ///     Sets*. <https://doi.org/10.1016/j.jco.2012.11.006>
    Mixture,
    /// Unions of boxes anchored at an even number of steps from a corner, in all projections.[^symmetric]
    ///
    /// `K = 2 - 2 |x - y|`, `h = 1 + 2 x - 2 x^2`, `c = 4/3`.
    ///
    /// [^symmetric]: Hickernell (1998), as for [`Centred`](Self::Centred), section 5.
    Symmetric,
    /// Boxes with any two corners inside the cube, also called unanchored.[^morokoff]
    ///
    /// `K = min(x, y) - x y`, `h = (x - x^2) / 2`, `c = 1/12`.
    ///
    /// [^morokoff]: Morokoff, William; Caflisch, Russel (1994). *Quasi-Random Sequences and Their Discrepancies*.
    ///     <https://doi.org/10.1137/0915077>
    Extreme,
}

impl L2 {
    /// The square of the discrepancy.
    pub fn squared(self, points: &Points<'_>) -> f64 {
        match self {
            Self::Star => squared::<Star>(points),
            Self::Centred => squared::<Centred>(points),
            Self::WrapAround => squared::<WrapAround>(points),
            Self::Mixture => squared::<Mixture>(points),
            Self::Symmetric => squared::<Symmetric>(points),
            Self::Extreme => squared::<Extreme>(points),
        }
    }

    /// The discrepancy: the root of the [square](Self::squared).
    pub fn root(self, points: &Points<'_>) -> f64 {
        self.squared(points).sqrt()
    }
}

fn squared<K: Kernel>(points: &Points<'_>) -> f64 {
    let (count, dimensions) = (points.count() as f64, points.dimensions());
    let power = |base: f64| {
        let mut power = Compensated::from(1.0);
        for _ in 0..dimensions {
            power = power.times(base);
        }
        power
    };
    let (numerator, denominator) = K::MEAN;
    let mut squared = (0..dimensions).fold(Compensated::from(1.0), |power, _| {
        power.times(numerator).over(denominator)
    });
    let mut singles = Compensated::default();
    for row in points.rows() {
        singles.add(row.iter().map(|&x| K::single(x)).product());
    }
    squared.merge(singles.times(-2.0).over(count));
    let scale = power(K::SCALE).value();
    squared.merge(
        Tiles::new::<K>(points)
            .sum::<K>(|_, k| k)
            .times(scale)
            .over(count)
            .over(count),
    );
    // What is left of the sum may be smaller than the rounding of the products in it.
    squared.value().max(0.0)
}
