//! The double sum over all pairs of points, in tiles that the first-level cache holds.

use super::compensated::Compensated;
use super::kernel::Kernel;
use crate::discrepancy::Points;
use crate::reduce;

/// Points in a tile.
const TILE: usize = 64;
/// Pairs whose products grow side by side. A constant, so that every machine adds in the same order.
const LANES: usize = 32;

/// One feature of the coordinates of all points in a tile.
type Column = [f64; TILE];

/// The features of the points' coordinates, tile by tile, dimension by dimension. The last tile is padded with points that
/// count nothing.
pub(super) struct Tiles {
    columns: Vec<[Column; 2]>,
    /// 1 for a point, 0 for padding.
    counts: Vec<Column>,
    dimensions: usize,
}

impl Tiles {
    pub(super) fn new<K: Kernel>(points: &Points<'_>) -> Self {
        let dimensions = points.dimensions();
        let count = points.count().div_ceil(TILE);
        let mut columns = vec![[[0.0; TILE]; 2]; count * dimensions];
        let mut counts = vec![[0.0; TILE]; count];
        for (index, row) in points.rows().enumerate() {
            let (tile, place) = (index / TILE, index % TILE);
            counts[tile][place] = 1.0;
            for (columns, &x) in columns[tile * dimensions..].iter_mut().zip(row) {
                [columns[0][place], columns[1][place]] = K::features(x);
            }
        }
        Self {
            columns,
            counts,
            dimensions,
        }
    }

    fn columns(&self, tile: usize) -> &[[Column; 2]] {
        &self.columns[tile * self.dimensions..][..self.dimensions]
    }

    /// The sum over all ordered pairs of points of the product over the dimensions of `factor`, which is given the
    /// dimension and what [`Kernel::pair`] says.
    pub(super) fn sum<K: Kernel>(
        &self,
        factor: impl Fn(usize, f64) -> f64 + Copy + Sync,
    ) -> Compensated {
        let mut total = Compensated::ZERO;
        let taken: Result<(), core::convert::Infallible> = reduce::in_order(
            self.counts.len() as u64,
            |job| {
                let tile = usize::try_from(job).expect("a tile is in memory");
                dispatch(|| self.row::<K>(tile, factor))
            },
            |part| {
                total.merge(part);
                Ok(())
            },
        );
        let Ok(()) = taken;
        total
    }

    /// The pairs of the points of one tile with those of it, and with those of all later tiles, which count twice.
    #[inline(always)]
    fn row<K: Kernel>(
        &self,
        here: usize,
        factor: impl Fn(usize, f64) -> f64 + Copy,
    ) -> Compensated {
        let (mut once, mut twice) = (Compensated::ZERO, Compensated::ZERO);
        let mut point = vec![[0.0; 2]; self.dimensions];
        for there in here..self.counts.len() {
            let sum = if there == here { &mut once } else { &mut twice };
            for (place, &count) in self.counts[here].iter().enumerate() {
                if count == 0.0 {
                    break;
                }
                for (coordinate, columns) in point.iter_mut().zip(self.columns(here)) {
                    *coordinate = [columns[0][place], columns[1][place]];
                }
                let columns = self.columns(there);
                sum.add(with_tile::<K>(&point, columns, &self.counts[there], factor));
            }
        }
        once.merge(twice.times(2.0));
        once
    }
}

/// The sum over the pairs of one point with those of a tile.
#[inline(always)]
fn with_tile<K: Kernel>(
    point: &[[f64; 2]],
    columns: &[[Column; 2]],
    counts: &Column,
    factor: impl Fn(usize, f64) -> f64,
) -> f64 {
    let mut sums = [0.0; LANES];
    for first in [0, LANES] {
        let mut products = [0.0; LANES];
        products.copy_from_slice(&counts[first..first + LANES]);
        for (dimension, (&here, there)) in point.iter().zip(columns).enumerate() {
            for lane in 0..LANES {
                let there = [there[0][first + lane], there[1][first + lane]];
                products[lane] *= factor(dimension, K::pair(here, there));
            }
        }
        for lane in 0..LANES {
            sums[lane] += products[lane];
        }
    }
    let mut width = LANES / 2;
    while width > 0 {
        for lane in 0..width {
            sums[lane] += sums[lane + width];
        }
        width /= 2;
    }
    sums[0]
}

/// Runs `job` compiled for the vector instructions of the machine at hand. They change nothing in the result: no product is
/// fused with a sum, and the lanes are [`LANES`] everywhere.
#[cfg(feature = "simd")]
fn dispatch<T>(job: impl FnOnce() -> T) -> T {
    pulp::Arch::new().dispatch(job)
}

#[cfg(not(feature = "simd"))]
fn dispatch<T>(job: impl FnOnce() -> T) -> T {
    job()
}
