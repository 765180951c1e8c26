//! Correlated multi-jittered points.

use core::ops::Range;

use super::PointSet;
use super::finite::{self, CHUNK, Column, Finite};
use super::permutation::Permutation;
use super::strata::{Divisor, within, write_within};
use crate::Error;
use crate::hash::{hash, permute, prepare, unit};

/// Correlated multi-jittered points: in two dimensions one point in every cell of a grid, and at the same time one in every
/// one of `count` strata of each axis.[^kensler]
///
/// A [`Stratified`](super::Stratified) grid and [`NRooks`](super::NRooks) at once, with the points pushed apart by
/// shuffling all columns alike, and all rows. Any grid, constant memory. Every further pair of dimensions holds
/// another such set, in an order of its own.
///
/// Use it for integrands of two coordinates, or of several pairs that do little together, where the count is no power
/// of two; scrambled Sobol' pairs ([`Rescrambled`](super::Rescrambled)) are better where it is.
///
/// An index at or past the size belongs to another, independent set.
///
/// ```
/// use estimand::points::{MultiJittered, PointSet};
///
/// let points = MultiJittered::new(1000, 1)?;
/// assert_eq!(points.size(), Some(32 * 31));
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^kensler]: Kensler, Andrew (2013). *Correlated Multi-Jittered Sampling*. Pixar Technical Memo 13-01.
///     <https://graphics.pixar.com/library/MultiJitteredSampling/>
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub struct MultiJittered {
    columns: u64,
    rows: u64,
    seed: u64,
}

impl MultiJittered {
    /// About `count` points, as many as the nearest grid has that is as square as can be, with the points that
    /// `seed` selects.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for no points.
    pub fn new(count: u64, seed: u64) -> Result<Self, Error> {
        let columns = rounded_root(count);
        let rows = (count / columns.max(1)..=count.div_ceil(columns.max(1)))
            .filter(|&rows| rows.checked_mul(columns).is_some())
            .min_by_key(|rows| count.abs_diff(rows * columns))
            .unwrap_or(0);
        Self::grid(columns, rows, seed)
            .map_err(|_| Error::refused("count of multi-jittered points", "at least 1", count))
    }

    /// The points on a grid of `columns` by `rows` cells.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a grid without cells, or with more than [`u64::MAX`].
    pub fn grid(columns: u64, rows: u64, seed: u64) -> Result<Self, Error> {
        for (name, number) in [("number of columns", columns), ("number of rows", rows)] {
            if number == 0 {
                return Err(Error::refused(name, "at least 1", number));
            }
        }
        if columns.checked_mul(rows).is_none() {
            return Err(Error::refused(
                "number of columns",
                "at most 2^64 - 1 over the number of rows",
                columns,
            ));
        }
        Ok(Self {
            columns,
            rows,
            seed,
        })
    }

    /// How many cells the grids have along the axis `dimension`.
    pub fn cells(&self, dimension: u32) -> u64 {
        if dimension.is_multiple_of(2) {
            self.columns
        } else {
            self.rows
        }
    }
}

/// The whole number nearest to the square root.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a root of a u64 is below 2^32 + 1"
)]
pub(super) fn rounded_root(count: u64) -> u64 {
    (count as f64).sqrt().round() as u64
}

impl PointSet for MultiJittered {
    #[inline]
    fn coordinate(&self, index: u64, dimension: u32) -> f64 {
        let (columns, rows, count) = (self.columns, self.rows, self.columns * self.rows);
        let (set, index) = (index / count, index % count);
        let (pair, axis) = (dimension / 2, dimension % 2);
        let key = hash(hash(self.seed, set), u64::from(pair));
        let index = if pair == 0 {
            index
        } else {
            permute(index, count, hash(key, 0))
        };
        let (column, row) = (index % columns, index / columns);
        let offset = unit(hash(hash(!key, u64::from(axis)), index));
        // Every cell holds the cell of a finer grid: its column is that of the row's place, its row that of the column's,
        // both shuffled.
        let (stratum, strata) = if axis == 0 {
            (column * rows + permute(row, rows, hash(key, 1)), count)
        } else {
            (
                row * columns + permute(column, columns, hash(key, 2)),
                count,
            )
        };
        within(stratum, strata, offset)
    }

    fn size(&self) -> Option<u64> {
        Some(self.columns * self.rows)
    }

    fn fill(&self, first: u64, dimensions: Range<u32>, out: &mut [f64]) {
        finite::fill(self, first, dimensions, out);
    }
}

impl Finite for MultiJittered {
    type Column = Axis;

    fn column(&self, set: u64, dimension: u32) -> Axis {
        let (columns, rows, count) = (self.columns, self.rows, self.columns * self.rows);
        let (pair, axis) = (dimension / 2, dimension % 2);
        let key = hash(hash(self.seed, set), u64::from(pair));
        let order = || Permutation::new(count, hash(key, 0));
        let upright = axis == 0;
        Axis {
            count,
            order: (pair > 0).then(order),
            columns,
            rows,
            fine: if upright {
                Permutation::new(rows, hash(key, 1))
            } else {
                Permutation::new(columns, hash(key, 2))
            },
            upright,
            offsets: prepare(hash(!key, u64::from(axis))),
        }
    }

    fn seed(&self) -> u64 {
        self.seed
    }
}

/// What the points of one set have in common in one dimension.
pub(super) struct Axis {
    count: u64,
    order: Option<Permutation>,
    columns: u64,
    rows: u64,
    /// Inside the cells.
    fine: Permutation,
    /// Whether this is the first axis of a pair.
    upright: bool,
    offsets: u64,
}

impl Column for Axis {
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "the count is at most 2^32")]
    fn write(&self, places: &[u32; CHUNK], out: &mut [f64; CHUNK]) {
        let mut cells = *places;
        if let Some(order) = &self.order {
            order.apply(&mut cells);
        }
        let columns = Divisor::new(self.columns);
        let mut fine = cells.map(|cell| columns.divide(cell).whole);
        let mut coarse = cells.map(|cell| columns.divide(cell).rest);
        let mut finer = self.rows as u32;
        if !self.upright {
            core::mem::swap(&mut fine, &mut coarse);
            finer = self.columns as u32;
        }
        self.fine.apply(&mut fine);
        for (stratum, fine) in coarse.iter_mut().zip(fine) {
            *stratum = stratum.wrapping_mul(finer).wrapping_add(fine);
        }
        write_within(&coarse, self.count, self.offsets, &cells, out);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_grid_is_taken() {
        for (count, size) in [(1, 1), (2, 2), (9, 9), (10, 9), (11, 12), (1000, 992)] {
            assert_eq!(MultiJittered::new(count, 1).unwrap().size(), Some(size));
        }
        assert!(MultiJittered::new(u64::MAX, 1).is_ok());
    }

    #[test]
    fn bad_grids_are_refused() {
        assert!(MultiJittered::new(0, 1).is_err());
        assert!(MultiJittered::grid(0, 3, 1).is_err());
        assert!(MultiJittered::grid(3, 0, 1).is_err());
        assert!(MultiJittered::grid(1 << 32, 1 << 32, 1).is_err());
    }
}
