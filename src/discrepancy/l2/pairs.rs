//! The double sum over all pairs of points, in tiles that the first-level cache holds.

use super::compensated::Compensated;
use super::kernel::Kernel;
use crate::discrepancy::Points;
use crate::reduce;

/// Points in a tile.
const TILE: usize = 64;
/// Pairs whose products grow side by side. A constant, so that every machine adds in the same order.
const LANES: usize = 16;

/// The features of the points' coordinates, tile by tile: for each dimension the first ones of all points of the tile,
/// then the second ones. The last tile is padded with points of weight 0.
struct Tiles {
    features: Vec<f64>,
    /// 1 for a point, 0 for padding.
    weights: Vec<[f64; TILE]>,
    dimensions: usize,
}

impl Tiles {
    fn new<K: Kernel>(points: &Points<'_>) -> Self {
        let dimensions = points.dimensions();
        let count = points.count().div_ceil(TILE);
        let mut features = vec![0.0; count * dimensions * 2 * TILE];
        let mut weights = vec![[0.0; TILE]; count];
        for (index, row) in points.rows().enumerate() {
            let (tile, place) = (index / TILE, index % TILE);
            weights[tile][place] = 1.0;
            for (dimension, &x) in row.iter().enumerate() {
                let at = ((tile * dimensions + dimension) * 2) * TILE + place;
                [features[at], features[at + TILE]] = K::features(x);
            }
        }
        Self {
            features,
            weights,
            dimensions,
        }
    }

    fn tile(&self, tile: usize) -> &[f64] {
        let length = self.dimensions * 2 * TILE;
        &self.features[tile * length..][..length]
    }
}

/// The sum over all ordered pairs of points of the product of [`Kernel::pair`] over the dimensions.
pub(super) fn sum<K: Kernel>(points: &Points<'_>) -> Compensated {
    let tiles = Tiles::new::<K>(points);
    let count = tiles.weights.len();
    let mut total = Compensated::ZERO;
    let taken: Result<(), core::convert::Infallible> = reduce::in_order(
        count as u64,
        |job| {
            let tile = usize::try_from(job).expect("a tile is in memory");
            dispatch(|| row_of_tiles::<K>(&tiles, tile))
        },
        |part| {
            total.merge(part);
            Ok(())
        },
    );
    let Ok(()) = taken;
    total
}

/// The pairs of the points of one tile with those of it and of all later tiles, which count twice.
#[inline(always)]
fn row_of_tiles<K: Kernel>(tiles: &Tiles, here: usize) -> Compensated {
    let (mut once, mut twice) = (Compensated::ZERO, Compensated::ZERO);
    let mut point = vec![[0.0; 2]; tiles.dimensions];
    for there in here..tiles.weights.len() {
        let sum = if there == here { &mut once } else { &mut twice };
        for (place, &weight) in tiles.weights[here].iter().enumerate() {
            if weight == 0.0 {
                break;
            }
            for (coordinate, columns) in point
                .iter_mut()
                .zip(tiles.tile(here).chunks_exact(2 * TILE))
            {
                *coordinate = [columns[place], columns[TILE + place]];
            }
            sum.add(point_with_tile::<K>(
                &point,
                tiles.tile(there),
                &tiles.weights[there],
            ));
        }
    }
    once.merge(twice.times(2.0));
    once
}

#[inline(always)]
fn point_with_tile<K: Kernel>(point: &[[f64; 2]], tile: &[f64], weights: &[f64; TILE]) -> f64 {
    let mut sums = [0.0; LANES];
    for lane in (0..TILE).step_by(LANES) {
        let mut products: [f64; LANES] = weights[lane..][..LANES]
            .try_into()
            .expect("a tile is a multiple of the lanes");
        for (&coordinate, columns) in point.iter().zip(tile.chunks_exact(2 * TILE)) {
            let first = &columns[lane..][..LANES];
            let second = &columns[TILE + lane..][..LANES];
            for ((product, &first), &second) in products.iter_mut().zip(first).zip(second) {
                *product *= K::pair(coordinate, [first, second]);
            }
        }
        for (sum, product) in sums.iter_mut().zip(products) {
            *sum += product;
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

/// Runs `job` compiled for the vector instructions of the machine at hand. The instructions change nothing in the
/// result: no product is fused with a sum, and the lanes are those of [`LANES`] everywhere.
#[cfg(feature = "simd")]
fn dispatch<T>(job: impl FnOnce() -> T) -> T {
    pulp::Arch::new().dispatch(job)
}

#[cfg(not(feature = "simd"))]
fn dispatch<T>(job: impl FnOnce() -> T) -> T {
    job()
}
