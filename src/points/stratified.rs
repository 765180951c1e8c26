//! One random point in every cell of a grid.

use core::ops::Range;

use super::PointSet;
use super::finite::{self, CHUNK, Column, Finite};
use super::permutation::Permutation;
use super::strata::{Divisor, within, write_within};
use crate::Error;
use crate::hash::{hash, permute, prepare, unit};

/// Stratified points, also called jittered: one uniform point in every cell of a regular grid.[^cook]
///
/// The grid has `dimensions` axes, whose numbers of cells differ by at most one; of all such grids it is the one
/// whose number of cells is nearest to what was asked for, and the smaller of two. [`size`](PointSet::size) tells what
/// it is. Dimensions past the grid's are filled with further grids of the same shape, each with its points in an
/// order of its own: so a path that reads coordinates in pairs has every pair stratified.
///
/// In `d` dimensions the error of a smooth integrand falls as `count^(-1/2 - 1/d)`: much in one or two, next to nothing
/// in ten. Within one grid the variance is never above that of independent points; where further grids are shuffled against
/// it, at most `count / (count - 1)` times that.
///
/// An index at or past the size belongs to another, independent set.
///
/// ```
/// use estimand::points::{PointSet, Stratified};
///
/// let grid = Stratified::new(1000, 2, 1)?;
/// assert_eq!(grid.size(), Some(31 * 32));
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^cook]: Cook, Robert (1986). *Stochastic Sampling in Computer Graphics*. <https://doi.org/10.1145/7529.8927>
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub struct Stratified {
    /// Cells along the short axes.
    cells: u64,
    /// How many axes, the first ones, have one cell more.
    longer: u32,
    dimensions: u32,
    count: u64,
    seed: u64,
}

impl Stratified {
    /// The grid in `dimensions` dimensions with about `count` cells, with the points that `seed` selects.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for no points or no dimensions.
    pub fn new(count: u64, dimensions: u32, seed: u64) -> Result<Self, Error> {
        if count == 0 {
            return Err(Error::refused(
                "count of stratified points",
                "at least 1",
                count,
            ));
        }
        if dimensions == 0 {
            return Err(Error::refused(
                "number of stratified dimensions",
                "at least 1",
                dimensions,
            ));
        }
        // The largest cube of cells that is no larger than what was asked for.
        #[expect(
            clippy::cast_possible_truncation,
            reason = "a root of a u64; mended below"
        )]
        let mut cells = (count as f64).powf(1.0 / f64::from(dimensions)).round() as u64;
        while cells > 1 && product(cells, 0, dimensions).is_none_or(|product| product > count) {
            cells -= 1;
        }
        while product(cells, dimensions, dimensions).is_some_and(|product| product <= count) {
            cells += 1;
        }
        let (count, longer) = (0..=dimensions.min(64))
            .filter_map(|longer| Some((product(cells, longer, dimensions)?, longer)))
            .min_by_key(|&(product, _)| (product.abs_diff(count), product))
            .expect("the cube itself is among them");
        Ok(Self {
            cells,
            longer,
            dimensions,
            count,
            seed,
        })
    }

    /// How many cells the grid has along the axis `dimension`.
    pub fn cells(&self, dimension: u32) -> u64 {
        self.cells + u64::from(dimension % self.dimensions < self.longer)
    }

    /// From one cell to the next along an axis: they are numbered with the first axis running fastest.
    #[inline]
    fn stride(&self, axis: u32) -> u64 {
        let longer = axis.min(self.longer);
        (self.cells + 1).pow(longer) * self.cells.pow(axis - longer)
    }
}

/// Cells of a grid with `cells + 1` along `longer` axes and `cells` along the others.
fn product(cells: u64, longer: u32, dimensions: u32) -> Option<u64> {
    let more = cells.checked_add(1)?.checked_pow(longer)?;
    cells.checked_pow(dimensions - longer)?.checked_mul(more)
}

impl PointSet for Stratified {
    #[inline]
    fn coordinate(&self, index: u64, dimension: u32) -> f64 {
        let (set, index) = (index / self.count, index % self.count);
        let (grid, axis) = (dimension / self.dimensions, dimension % self.dimensions);
        let key = hash(self.seed, set);
        let cell = if grid == 0 {
            index
        } else {
            permute(index, self.count, hash(key, u64::from(grid)))
        };
        let cells = self.cells(axis);
        within(
            cell / self.stride(axis) % cells,
            cells,
            unit(hash(hash(!key, u64::from(dimension)), index)),
        )
    }

    fn size(&self) -> Option<u64> {
        Some(self.count)
    }

    fn fill(&self, first: u64, dimensions: Range<u32>, out: &mut [f64]) {
        finite::fill(self, first, dimensions, out);
    }
}

impl Finite for Stratified {
    type Column = Axis;

    fn column(&self, set: u64, dimension: u32) -> Axis {
        let (grid, axis) = (dimension / self.dimensions, dimension % self.dimensions);
        let key = hash(self.seed, set);
        let order = || Permutation::new(self.count, hash(key, u64::from(grid)));
        Axis {
            order: (grid > 0).then(order),
            stride: Divisor::new(self.stride(axis)),
            cells: self.cells(axis),
            offsets: prepare(hash(!key, u64::from(dimension))),
        }
    }

    fn seed(&self) -> u64 {
        self.seed
    }
}

/// What the points of one set have in common in one dimension.
pub(super) struct Axis {
    order: Option<Permutation>,
    stride: Divisor,
    cells: u64,
    offsets: u64,
}

impl Column for Axis {
    #[inline(always)]
    fn write(&self, places: &[u32; CHUNK], out: &mut [f64; CHUNK]) {
        let mut cells = *places;
        if let Some(order) = &self.order {
            order.apply(&mut cells);
        }
        let along = Divisor::new(self.cells);
        let strata = cells.map(|cell| along.divide(self.stride.divide(cell).whole).rest);
        write_within(&strata, self.cells, self.offsets, places, out);
    }
}
