//! The grid of corners that can attain a star discrepancy.

use super::{AnchoredBox, Boundary};
use crate::discrepancy::Points;

/// The corners of one kind of box: along every dimension the coordinates of the points, and 1.
///
/// A corner is a list of indices, one a dimension. The point of rank `r` along a dimension is inside a box with the
/// index `k` there if and only if `r < k`, for both kinds of boxes: so one algorithm serves both.
pub(super) struct Grid {
    boundary: Boundary,
    dimensions: usize,
    count: usize,
    /// Along every dimension, for every index, where the box ends.
    ends: Vec<Vec<f64>>,
    /// The ranks of the points, one point after the other.
    ranks: Vec<u32>,
}

impl Grid {
    pub(super) fn new(points: &Points<'_>, boundary: Boundary) -> Self {
        let dimensions = points.dimensions();
        let mut ranks = vec![0; points.count() * dimensions];
        let ends = (0..dimensions)
            .map(|dimension| {
                let mut axis: Vec<f64> = points.column(dimension).collect();
                axis.sort_unstable_by(f64::total_cmp);
                axis.dedup();
                let column = ranks.iter_mut().skip(dimension).step_by(dimensions);
                for (rank, x) in column.zip(points.column(dimension)) {
                    let below = axis.partition_point(|&y| y < x);
                    *rank = u32::try_from(below).expect("fewer than 2^32 points");
                }
                match boundary {
                    // An open box that ends at a point excludes it; the last one ends at 1.
                    Boundary::Open if axis[axis.len() - 1] < 1.0 => axis.push(1.0),
                    Boundary::Open => {}
                    // A closed box that ends at a point includes it; there is none of index 0.
                    Boundary::Closed => axis.insert(0, f64::NAN),
                }
                axis
            })
            .collect();
        Self {
            boundary,
            dimensions,
            count: points.count(),
            ends,
            ranks,
        }
    }

    pub(super) fn boundary(&self) -> Boundary {
        self.boundary
    }

    pub(super) fn dimensions(&self) -> usize {
        self.dimensions
    }

    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// The rank of a point along a dimension.
    #[inline]
    pub(super) fn rank(&self, point: u32, dimension: usize) -> u32 {
        self.ranks[point as usize * self.dimensions + dimension]
    }

    /// The ranks of a point.
    #[inline]
    pub(super) fn row(&self, point: u32) -> &[u32] {
        &self.ranks[point as usize * self.dimensions..][..self.dimensions]
    }

    /// The least index along every dimension.
    pub(super) fn first(&self) -> u32 {
        match self.boundary {
            Boundary::Open => 0,
            Boundary::Closed => 1,
        }
    }

    /// The greatest index along a dimension.
    pub(super) fn last(&self, dimension: usize) -> u32 {
        u32::try_from(self.ends[dimension].len() - 1).expect("fewer than 2^32 points")
    }

    /// Where a box of an index ends.
    #[inline]
    pub(super) fn end(&self, dimension: usize, index: u32) -> f64 {
        self.ends[dimension][index as usize]
    }

    /// The volume of the box with a corner.
    #[inline]
    pub(super) fn volume(&self, corner: &[u32]) -> f64 {
        let mut volume = 1.0;
        for (ends, &index) in self.ends.iter().zip(corner) {
            volume *= ends[index as usize];
        }
        volume
    }

    /// The local discrepancy of a box of a volume with so many points inside, signed so that it is what this
    /// kind of box is good for.
    #[inline]
    pub(super) fn excess(&self, volume: f64, inside: u32) -> f64 {
        let share = f64::from(inside) / self.count as f64;
        match self.boundary {
            Boundary::Open => volume - share,
            Boundary::Closed => share - volume,
        }
    }

    /// The box with a corner.
    pub(super) fn anchored(&self, points: &Points<'_>, corner: &[u32]) -> AnchoredBox {
        let corner = (0..).zip(corner).map(|(j, &index)| self.end(j, index));
        AnchoredBox::new(points, corner.collect(), self.boundary)
    }
}
