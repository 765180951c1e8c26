//! Independent uniform points.

use core::ops::Range;

use super::PointSet;
use super::block::{Block, vectorised};
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
    /// "columns" in ASCII.
    const COLUMNS: u64 = 0x63_6f6c_756d_6e73;

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

/// Coordinates that are mixed at once.
const LANES: usize = 256;

impl Independent {
    /// What the coordinates of the point `index` have in common.
    #[inline]
    fn row(&self, index: u64) -> u64 {
        hash(self.seed, index)
    }

    /// What the coordinates in `dimension` have in common.
    #[inline]
    fn column(&self, dimension: u32) -> u64 {
        // Not a key that is made from the seed as the row's is: rows and columns would be interchangeable.
        hash(hash(self.seed, Self::COLUMNS), u64::from(dimension))
    }

    /// Writes the coordinates in `dimensions` into the columns of the block from `start` on.
    pub(super) fn fill_columns(&self, block: &mut Block<'_>, dimensions: Range<u32>, start: usize) {
        for start_of_tile in (0..dimensions.len()).step_by(LANES) {
            let width = LANES.min(dimensions.len() - start_of_tile);
            let start = start + start_of_tile;
            vectorised(
                #[inline(always)]
                || {
                    let mut columns = [0; LANES];
                    let dimensions = dimensions.clone().skip(start_of_tile);
                    for (column, dimension) in columns[..width].iter_mut().zip(dimensions) {
                        *column = self.column(dimension);
                    }
                    let stride = block.width;
                    if stride < 16 {
                        narrow(self, block, &columns[..width], start);
                        return;
                    }
                    for (place, row) in (0..).zip(block.out.chunks_exact_mut(stride)) {
                        let common = self.row(block.first.wrapping_add(place));
                        for (u, &column) in row[start..start + width].iter_mut().zip(&columns) {
                            *u = unit(mix(common.wrapping_add(column)));
                        }
                    }
                },
            );
        }
    }
}

/// Rows too narrow to be worth a vector each: many at once.
#[inline(always)]
fn narrow(points: &Independent, block: &mut Block<'_>, columns: &[u64], start: usize) {
    let rows = LANES / columns.len();
    let (mut common, mut words) = ([0; LANES], [0; LANES]);
    let mut index = block.first;
    for out in block.out.chunks_mut(rows * block.width) {
        let rows = out.len() / block.width;
        for (common, row) in common[..rows].iter_mut().zip(0..) {
            *common = points.row(index.wrapping_add(row));
        }
        for (words, common) in words.chunks_exact_mut(columns.len()).zip(&common[..rows]) {
            for (word, column) in words.iter_mut().zip(columns) {
                *word = common.wrapping_add(*column);
            }
        }
        let words = &mut words[..rows * columns.len()];
        for word in &mut *words {
            *word = mix(*word);
        }
        if columns.len() == block.width {
            for (u, &word) in out.iter_mut().zip(&*words) {
                *u = unit(word);
            }
        } else {
            let rows = out.chunks_exact_mut(block.width);
            for (row, words) in rows.zip(words.chunks_exact(columns.len())) {
                for (u, &word) in row[start..].iter_mut().zip(words) {
                    *u = unit(word);
                }
            }
        }
        index = index.wrapping_add(rows as u64);
    }
}

impl PointSet for Independent {
    #[inline]
    fn coordinate(&self, index: u64, dimension: u32) -> f64 {
        unit(mix(self.row(index).wrapping_add(self.column(dimension))))
    }

    fn fill(&self, first: u64, dimensions: Range<u32>, out: &mut [f64]) {
        let mut block = Block::new(first, dimensions.clone(), out, u32::MAX, 0);
        if block.width > 0 {
            self.fill_columns(&mut block, dimensions, 0);
        }
    }
}
