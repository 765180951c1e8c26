//! One set for the first dimensions, another for the rest.

use core::ops::Range;

use super::PointSet;
use crate::Error;

/// One set for the first dimensions, another for all that follow.
///
/// Where a few coordinates matter most: Sobol' points for them, [`NRooks`](super::NRooks) or
/// [`Independent`](super::Independent) coordinates for the rest, which cost less or can be had in any number. The two
/// must be independent of one another, which random sets with different seeds are: two plain deterministic sets would be
/// correlated.
///
/// ```
/// use estimand::points::{HashedOwen, NRooks, Padded, PointSet, Sobol};
///
/// let first = Sobol::new(4)?.scrambled(HashedOwen { seed: 1 });
/// let points = Padded::new(first, 4, NRooks::new(1024, 2)?)?;
/// assert_eq!(points.size(), Some(1024));
/// # Ok::<(), estimand::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub struct Padded<P, Q> {
    first: P,
    dimensions: u32,
    rest: Q,
}

impl<P: PointSet, Q: PointSet> Padded<P, Q> {
    /// `dimensions` dimensions of `first`, then those of `rest`, which start at its first one.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for two finite sets of different sizes.
    pub fn new(first: P, dimensions: u32, rest: Q) -> Result<Self, Error> {
        match (first.size(), rest.size()) {
            (Some(a), Some(b)) if a != b => Err(Error::refused(
                "size of the rest",
                "that of the first set, if both are finite",
                format_args!("{b}, and the other's {a}"),
            )),
            _ => Ok(Self {
                first,
                dimensions,
                rest,
            }),
        }
    }
}

/// Coordinates that are computed at once, to be copied to their places.
const ROOM: usize = 1024;

impl<P: PointSet, Q: PointSet> PointSet for Padded<P, Q> {
    #[inline]
    fn coordinate(&self, index: u64, dimension: u32) -> f64 {
        match dimension.checked_sub(self.dimensions) {
            None => self.first.coordinate(index, dimension),
            Some(dimension) => self.rest.coordinate(index, dimension),
        }
    }

    fn size(&self) -> Option<u64> {
        self.first.size().or(self.rest.size())
    }

    /// That of the first set.
    fn radix(&self) -> Option<u32> {
        self.first.radix()
    }

    fn dimensions(&self) -> u32 {
        self.dimensions.saturating_add(self.rest.dimensions())
    }

    fn fill(&self, first: u64, dimensions: Range<u32>, out: &mut [f64]) {
        super::check(first, &dimensions, out);
        let seam = self.dimensions;
        if dimensions.end <= seam {
            return self.first.fill(first, dimensions, out);
        }
        if dimensions.start >= seam {
            let dimensions = dimensions.start - seam..dimensions.end - seam;
            return self.rest.fill(first, dimensions, out);
        }
        let (left, right) = (dimensions.start..seam, 0..dimensions.end - seam);
        let (width, cut) = (dimensions.len(), left.len());
        let rows = (ROOM / width).max(1);
        let mut room = vec![0.0; rows * cut.max(width - cut)];
        let mut index = first;
        for out in out.chunks_mut(rows * width) {
            let rows = out.len() / width;
            for (dimensions, columns) in [(&left, 0..cut), (&right, cut..width)] {
                let block = &mut room[..rows * columns.len()];
                match columns.start {
                    0 => self.first.fill(index, dimensions.clone(), block),
                    _ => self.rest.fill(index, dimensions.clone(), block),
                }
                let blocks = block.chunks_exact(columns.len());
                for (row, coordinates) in out.chunks_exact_mut(width).zip(blocks) {
                    row[columns.clone()].copy_from_slice(coordinates);
                }
            }
            index = index.wrapping_add(rows as u64);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::points::{Independent, NRooks, Stratified};

    #[test]
    fn sizes_must_agree() {
        let rooks = |count| NRooks::new(count, 1).unwrap();
        assert!(Padded::new(rooks(5), 1, rooks(6)).is_err());
        let padded = Padded::new(rooks(5), 1, rooks(5)).unwrap();
        assert_eq!(padded.size(), Some(5));
        let padded = Padded::new(Independent::new(1), 1, rooks(6)).unwrap();
        assert_eq!(padded.size(), Some(6));
    }

    #[test]
    fn dimensions_start_again_at_the_seam() {
        let (first, rest) = (
            Stratified::new(9, 2, 1).unwrap(),
            NRooks::new(9, 2).unwrap(),
        );
        let padded = Padded::new(first, 2, rest).unwrap();
        for index in 0..9 {
            assert_eq!(padded.coordinate(index, 1), first.coordinate(index, 1));
            assert_eq!(padded.coordinate(index, 2), rest.coordinate(index, 0));
        }
    }
}
