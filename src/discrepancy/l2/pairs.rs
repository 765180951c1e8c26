//! The double sum over all pairs of points, in tiles that the first-level cache holds.

use core::marker::PhantomData;

use super::compensated::Compensated;
use super::kernel::Kernel;
use crate::discrepancy::Points;
use crate::reduce;

/// Points in a tile.
const TILE: usize = 64;
/// Dimensions whose factors are multiplied in one pass over a tile.
const TOGETHER: usize = 4;

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
                let row = Row::<K, _> {
                    tiles: self,
                    tile,
                    factor,
                    kernel: PhantomData,
                };
                row.run()
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
    factor: impl Fn(usize, f64) -> f64 + Copy,
) -> f64 {
    let mut products = *counts;
    let (fours, ones) = point.as_chunks::<TOGETHER>();
    let (columns_of_fours, columns_of_ones) = columns.as_chunks::<TOGETHER>();
    let mut dimension = 0;
    for (point, columns) in fours.iter().zip(columns_of_fours) {
        multiply::<K, TOGETHER>(&mut products, point, columns, |k, pair| {
            factor(dimension + k, pair)
        });
        dimension += TOGETHER;
    }
    for (point, columns) in ones.iter().zip(columns_of_ones) {
        multiply::<K, 1>(&mut products, &[*point], &[*columns], |_, pair| {
            factor(dimension, pair)
        });
        dimension += 1;
    }
    let mut width = TILE / 2;
    while width > 0 {
        let (here, there) = products.split_at_mut(width);
        for (sum, &term) in here.iter_mut().zip(&*there) {
            *sum += term;
        }
        width /= 2;
    }
    products[0]
}

/// Multiplies the products of one point with those of a tile by the factors of some dimensions.
#[inline(always)]
fn multiply<K: Kernel, const N: usize>(
    products: &mut Column,
    point: &[[f64; 2]; N],
    columns: &[[Column; 2]; N],
    factor: impl Fn(usize, f64) -> f64,
) {
    for (lane, product) in products.iter_mut().enumerate() {
        for k in 0..N {
            let there = [columns[k][0][lane], columns[k][1][lane]];
            *product *= factor(k, K::pair(point[k], there));
        }
    }
}

/// [`Tiles::row`], compiled for the vector instructions of the machine at hand. They change nothing in the result: no
/// product is fused with a sum, and the order of the sums is the same everywhere.
struct Row<'a, K, F> {
    tiles: &'a Tiles,
    tile: usize,
    factor: F,
    kernel: PhantomData<K>,
}

impl<K: Kernel, F: Fn(usize, f64) -> f64 + Copy> Row<'_, K, F> {
    #[cfg(feature = "simd")]
    fn run(self) -> Compensated {
        pulp::Arch::new().dispatch(self)
    }

    #[cfg(not(feature = "simd"))]
    fn run(self) -> Compensated {
        self.tiles.row::<K>(self.tile, self.factor)
    }
}

#[cfg(feature = "simd")]
impl<K: Kernel, F: Fn(usize, f64) -> f64 + Copy> pulp::WithSimd for Row<'_, K, F> {
    type Output = Compensated;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Compensated {
        self.tiles.row::<K>(self.tile, self.factor)
    }
}
