//! Independent uniform points.

use super::PointSet;
use crate::hash::{hash, mix, unit};

/// Independent uniform points: the coordinates are hashes of `(index, dimension, seed)`.
///
/// Any index and any dimension. The error of an average falls as `count^(-1/2)`.
///
/// Use it where every other set is to be compared with plain Monte Carlo on equal terms, and for coordinates
/// that need random access. For plain Monte Carlo itself [`MonteCarlo`](crate::MonteCarlo) is faster.
///
/// ```
/// use estimand::points::{Independent, PointSet};
///
/// let points = Independent::new(1);
/// assert_eq!(points.coordinate(5, 2), points.coordinate(5, 2));
/// assert_ne!(points.coordinate(5, 2), Independent::new(2).coordinate(5, 2));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub struct Independent {
    seed: u64,
}

impl Independent {
    /// The points that `seed` selects.
    pub const fn new(seed: u64) -> Self {
        Self { seed }
    }

    /// What a set that `seed` randomises continues with past its last dimension.
    #[inline]
    pub(super) const fn past(seed: u64) -> Self {
        // "past" in ASCII, so that the coordinates differ from those of a set made with the seed itself.
        Self::new(hash(seed, 0x7061_7374))
    }
}

impl PointSet for Independent {
    #[inline]
    fn coordinate(&self, index: u64, dimension: u32) -> f64 {
        unit(mix(
            hash(self.seed, index).wrapping_add(hash(!self.seed, u64::from(dimension)))
        ))
    }
}
