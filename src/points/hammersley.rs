//! Hammersley's points.

use core::ops::Range;

use super::block::Block;
use super::radical_inverse::{BELOW_ONE, ratio};
use super::scramble::{DigitScramble, Plain};
use super::{Halton, Independent, PointSet, fill_singly};
use crate::Error;

/// Hammersley's points: one axis holds `(index + offset) / count`, the others are
/// [`Halton`]'s.[^hammersley]
///
/// Sources differ in which axis that is and in the offset. Here the axis is the first one, 0, and the offset 0, unless
/// set otherwise; an offset of 1/2 centres the points in their strata. The other axes, in order, have Halton's
/// bases 2, 3, 5 and so on.
///
/// A finite set: only all `count` points together are evenly spread, but those more evenly than the same number of
/// Halton's, by a factor of the order of the logarithm of the count. Use it when the count is known beforehand.
///
/// An index at or past the count has its place modulo the count on the axis, and goes on with Halton's points
/// on the others. Dimensions past those asked for are independent hashed coordinates. On the axis the value is the number
/// nearest to the exact fraction, or the largest one below 1.
///
/// ```
/// use estimand::points::{Hammersley, PointSet};
///
/// let points = Hammersley::new(8, 2)?;
/// let third = [points.coordinate(3, 0), points.coordinate(3, 1)];
/// assert_eq!(third, [3.0 / 8.0, 0.75]);
///
/// let other = Hammersley::new(8, 2)?.axis(1)?.offset(0.5)?;
/// let third = [other.coordinate(3, 0), other.coordinate(3, 1)];
/// assert_eq!(third, [0.75, 3.5 / 8.0]);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^hammersley]: Hammersley, John (1960). *Monte Carlo methods for solving multivariable problems*.
///     <https://doi.org/10.1111/j.1749-6632.1960.tb42846.x>
#[derive(Clone, Debug)]
#[must_use]
pub struct Hammersley<S = Plain> {
    count: u64,
    dimensions: u32,
    axis: u32,
    offset: f64,
    halton: Halton<S>,
}

impl Hammersley {
    /// The plain set of `count` points in `dimensions` dimensions.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for no points, no dimensions, or more than 65536.
    pub fn new(count: u64, dimensions: u32) -> Result<Self, Error> {
        if count == 0 {
            return Err(Error::refused(
                "count of Hammersley points",
                "at least 1",
                count,
            ));
        }
        if !(1..=1 << 16).contains(&dimensions) {
            return Err(Error::refused(
                "number of Hammersley dimensions",
                "1 to 65536",
                dimensions,
            ));
        }
        Ok(Self {
            count,
            dimensions,
            axis: 0,
            offset: 0.0,
            halton: Halton::new((dimensions - 1).max(1))?,
        })
    }
}

impl<S> Hammersley<S> {
    /// The same points, those of Halton randomised by `scramble` instead. The axis stays as it is: move it with
    /// [`Shifted`](super::Shifted) if every point must be uniform on its own.
    pub fn scrambled<T: DigitScramble>(self, scramble: T) -> Hammersley<T> {
        Hammersley {
            count: self.count,
            dimensions: self.dimensions,
            axis: self.axis,
            offset: self.offset,
            halton: self.halton.scrambled(scramble),
        }
    }

    /// The same points with `(index + offset) / count` in the dimension `axis`.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for an axis at or past the number of dimensions.
    pub fn axis(self, axis: u32) -> Result<Self, Error> {
        if axis >= self.dimensions {
            return Err(Error::refused(
                "axis of Hammersley points",
                "below the number of dimensions",
                axis,
            ));
        }
        Ok(Self { axis, ..self })
    }

    /// The same points with another `offset` in the stratum, in `[0, 1)`.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for an offset outside `[0, 1)`.
    pub fn offset(self, offset: f64) -> Result<Self, Error> {
        if !(0.0..1.0).contains(&offset) {
            return Err(Error::refused(
                "offset of Hammersley points",
                "in [0, 1)",
                offset,
            ));
        }
        Ok(Self { offset, ..self })
    }
}

impl<S: DigitScramble> PointSet for Hammersley<S> {
    #[inline]
    fn coordinate(&self, index: u64, dimension: u32) -> f64 {
        if dimension == self.axis {
            return fraction(index % self.count, self.offset, self.count);
        }
        if dimension >= self.dimensions {
            return Independent::past(self.halton.seed()).coordinate(index, dimension);
        }
        // Halton's dimensions are counted without the axis.
        let skipped = u32::from(dimension > self.axis);
        self.halton.coordinate(index, dimension - skipped)
    }

    fn size(&self) -> Option<u64> {
        Some(self.count)
    }

    fn dimensions(&self) -> u32 {
        self.dimensions
    }

    fn fill(&self, first: u64, dimensions: Range<u32>, out: &mut [f64]) {
        let Some(start) = self.halton.start_of_block(first, out.len()) else {
            return fill_singly(self, first, dimensions, out);
        };
        let seed = self.halton.seed();
        let mut block = Block::new(start, dimensions, out, self.dimensions, seed);
        let Range { start, end } = block.dimensions;
        // Halton's dimensions, before the axis and after it.
        let before = start..end.min(self.axis).max(start);
        let after = start.max(self.axis + 1)..end;
        self.halton.fill_columns(&mut block, before, 0);
        if !after.is_empty() {
            let column = (after.start - start) as usize;
            let after = after.start - 1..after.end - 1;
            self.halton.fill_columns(&mut block, after, column);
        }
        if (start..end).contains(&self.axis) {
            let column = (self.axis - start) as usize;
            for (row, index) in block.out.chunks_exact_mut(block.width).zip(first..) {
                row[column] = fraction(index % self.count, self.offset, self.count);
            }
        }
    }
}

/// The number in `[0, 1)` nearest to `(index + offset) / count`, for an index below the count.
#[inline]
fn fraction(index: u64, offset: f64, count: u64) -> f64 {
    if offset == 0.0 && count > 1 << 53 {
        return ratio(index.into(), count.into());
    }
    ((index as f64 + offset) / count as f64).min(BELOW_ONE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::points::DigitPermutation;

    #[test]
    fn the_axis_is_exact_for_any_count() {
        for count in [1, 7, 1 << 32, 1 << 53, (1 << 53) + 1, u64::MAX] {
            let points = Hammersley::new(count, 1).unwrap();
            assert_eq!(points.coordinate(0, 0), 0.0);
            let last = points.coordinate(count - 1, 0);
            assert!(last < 1.0);
            // 2^64 - 1 = 3 * 5 * 17 * 257 * 641 * 65537 * 6700417.
            if count == u64::MAX {
                assert_eq!(points.coordinate(count / 3, 0), 1.0 / 3.0);
                assert_eq!(points.coordinate(count / 5 * 4, 0), 0.8);
            }
        }
    }

    #[test]
    fn bad_arguments_are_refused() {
        assert!(Hammersley::new(0, 2).is_err());
        assert!(Hammersley::new(2, 0).is_err());
        let points = || Hammersley::new(4, 2).unwrap();
        assert!(points().axis(2).is_err());
        for offset in [-0.1, 1.0, f64::NAN] {
            assert!(points().offset(offset).is_err());
        }
    }

    #[test]
    fn every_axis_keeps_the_bases_in_order() {
        let halton = Halton::new(3).unwrap();
        for axis in 0..4 {
            let points = Hammersley::new(10, 4).unwrap().axis(axis).unwrap();
            let others = (0..4).filter(|&dimension| dimension != axis);
            for (base, dimension) in (0..).zip(others) {
                assert_eq!(points.coordinate(6, dimension), halton.coordinate(6, base));
            }
            assert_eq!(points.coordinate(6, axis), 0.6);
        }
    }

    #[test]
    fn scrambles_reach_halton_only() {
        let points = Hammersley::new(10, 2)
            .unwrap()
            .scrambled(DigitPermutation { seed: 1 });
        assert_eq!(points.coordinate(3, 0), 0.3);
        assert_ne!(points.coordinate(0, 1), 0.0);
    }
}
