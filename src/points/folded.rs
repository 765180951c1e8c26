//! The baker's transformation of any set.

use core::ops::Range;

use super::PointSet;
use super::radical_inverse::BELOW_ONE;

/// Any set, each axis stretched to twice its length and folded back: the baker's transformation, or tent
/// map.[^hickernell]
///
/// A coordinate `u` becomes `1 - |2 u - 1|`. The integrand then looks periodic, so that averages over randomly
/// [shifted](super::Shifted) lattices converge as fast for smooth integrands that are not periodic as for
/// those that are: the error falls nearly as `count^(-2)`. On other sets it gains little, and it undoes the
/// strata of the axis.
///
/// ```
/// use estimand::points::{Folded, Halton, PointSet};
///
/// let points = Folded::new(Halton::new(1)?);
/// assert_eq!(points.coordinate(2, 0), 0.5);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^hickernell]: Hickernell, Fred (2002). *Obtaining O(N^(-2+e)) Convergence for Lattice Quadrature Rules*.
///     <https://doi.org/10.1007/978-3-642-56046-0_18>
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub struct Folded<P> {
    points: P,
}

impl<P: PointSet> Folded<P> {
    /// `points`, folded.
    pub const fn new(points: P) -> Self {
        Self { points }
    }
}

/// Doubling is exact, and so is the difference from 2 of a number in `[1, 2)`; only `u = 1/2` reaches 1.
#[inline]
fn fold(u: f64) -> f64 {
    let twice = 2.0 * u;
    twice.min(2.0 - twice).min(BELOW_ONE)
}

impl<P: PointSet> PointSet for Folded<P> {
    #[inline]
    fn coordinate(&self, index: u64, dimension: u32) -> f64 {
        fold(self.points.coordinate(index, dimension))
    }

    fn size(&self) -> Option<u64> {
        self.points.size()
    }

    fn radix(&self) -> Option<u32> {
        self.points.radix()
    }

    fn dimensions(&self) -> u32 {
        self.points.dimensions()
    }

    fn fill(&self, first: u64, dimensions: Range<u32>, out: &mut [f64]) {
        self.points.fill(first, dimensions, out);
        for u in out {
            *u = fold(*u);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_stays_below_one() {
        assert_eq!(fold(0.0), 0.0);
        assert_eq!(fold(0.25), 0.5);
        assert_eq!(fold(0.75), 0.5);
        assert_eq!(fold(0.5), BELOW_ONE);
        assert_eq!(fold(BELOW_ONE), f64::EPSILON);
    }
}
