//! A sequence from one of its points on.

use core::ops::Range;

use super::{PointSet, check, fill_singly};

/// The points of a set from one of them on.
///
/// To go on with a sequence where an estimate of its first points ended: both together are an estimate of all of them. What a set promises
/// of its first points it does not promise of others, so that these have neither [`size`](PointSet::size) nor
/// [`radix`](PointSet::radix): of a finite set take no more than are left. The mean over both weighs them by their numbers, and
/// they differ by more than the error of that mean. Past the last index the points begin anew.
///
/// ```
/// use estimand::points::{Halton, PointSet, Skipped};
///
/// let halton = Halton::new(2)?;
/// let rest = Skipped::new(halton.clone(), 10);
/// assert_eq!(rest.coordinate(5, 1), halton.coordinate(15, 1));
/// # Ok::<(), estimand::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub struct Skipped<P> {
    points: P,
    skip: u64,
}

impl<P: PointSet> Skipped<P> {
    /// `points` without the first `skip` of them.
    pub const fn new(points: P, skip: u64) -> Self {
        Self { points, skip }
    }
}

impl<P: PointSet> PointSet for Skipped<P> {
    #[inline]
    fn coordinate(&self, index: u64, dimension: u32) -> f64 {
        self.points
            .coordinate(index.wrapping_add(self.skip), dimension)
    }

    fn dimensions(&self) -> u32 {
        self.points.dimensions()
    }

    fn fill(&self, first: u64, dimensions: Range<u32>, out: &mut [f64]) {
        check(first, &dimensions, out);
        let rows = (out.len() / dimensions.len().max(1)) as u64;
        let inner = first.wrapping_add(self.skip);
        match inner.checked_add(rows) {
            Some(_) => self.points.fill(inner, dimensions, out),
            None => fill_singly(self, first, dimensions, out),
        }
    }
}
