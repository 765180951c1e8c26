//! How blocks of coordinates are laid out, and computed with the vector instructions of the machine at hand.

use core::ops::Range;

use super::Independent;

/// Runs `job`, compiled for the machine at hand where the feature `simd` is on. The results are the same bits
/// everywhere: nothing in a job is reordered or fused.
#[inline(always)]
pub(crate) fn vectorised<R>(job: impl FnOnce() -> R) -> R {
    #[cfg(feature = "simd")]
    return pulp::Arch::new().dispatch(job);
    #[cfg(not(feature = "simd"))]
    job()
}

/// The block that a call of `fill` writes.
pub(super) struct Block<'a> {
    pub(super) first: u64,
    pub(super) dimensions: Range<u32>,
    /// One row of `width` coordinates for each point.
    pub(super) out: &'a mut [f64],
    pub(super) width: usize,
}

impl<'a> Block<'a> {
    /// The block of a call of `fill`, with the dimensions past `last` already written: they continue with the
    /// independent coordinates of `seed`.
    ///
    /// # Panics
    ///
    /// As [`PointSet::fill`](super::PointSet::fill) does.
    pub(super) fn new(
        first: u64,
        dimensions: Range<u32>,
        out: &'a mut [f64],
        last: u32,
        seed: u64,
    ) -> Self {
        let width = dimensions.len();
        super::check(first, &dimensions, out);
        let mut block = Self {
            first,
            dimensions,
            out,
            width,
        };
        let inside = block.dimensions.start..block.dimensions.end.min(last);
        if inside.len() < width && width > 0 {
            let past = block.dimensions.start.max(last)..block.dimensions.end;
            let start = width - past.len();
            Independent::past(seed).fill_columns(&mut block, past, start);
            block.dimensions = inside;
        }
        block
    }

    /// How many points there are.
    pub(super) fn count(&self) -> usize {
        self.out.len().checked_div(self.width).unwrap_or(0)
    }
}

/// Dimensions whose coordinates are computed before they are put in their places: those of one line of the cache, so that no
/// line is written twice.
pub(super) const TOGETHER: usize = 8;

/// Begins with a line of the cache, so that no vector of an array is in two.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(super) struct Aligned<T>(pub(super) T);

/// Where coordinates are put side by side: those of `POINTS` points in the first and in the last half of the dimensions.
#[repr(align(64))]
pub(super) struct Rows<const POINTS: usize> {
    left: [[f64; TOGETHER / 2]; POINTS],
    right: [[f64; TOGETHER / 2]; POINTS],
}

impl<const POINTS: usize> Rows<POINTS> {
    pub(super) const fn new() -> Self {
        Self {
            left: [[0.0; TOGETHER / 2]; POINTS],
            right: [[0.0; TOGETHER / 2]; POINTS],
        }
    }

    /// Writes the coordinates of the points from the one at `place` on, as many as there are `rows`, into `columns` of the rows. They
    /// come dimension by dimension, of which the first `columns.len()` have a meaning.
    #[inline(always)]
    pub(super) fn write<'a>(
        &mut self,
        [a, b, c, d, e, f, g, h]: [&[f64; POINTS]; TOGETHER],
        place: usize,
        rows: impl Iterator<Item = &'a mut [f64]>,
        columns: Range<usize>,
    ) {
        for (place, four) in self.left.iter_mut().enumerate() {
            *four = [a[place], b[place], c[place], d[place]];
        }
        for (place, four) in self.right.iter_mut().enumerate() {
            *four = [e[place], f[place], g[place], h[place]];
        }
        let coordinates = self.left[place..]
            .iter()
            .zip(&self.right[place..])
            .zip(rows);
        if columns.len() == TOGETHER {
            for ((left, right), row) in coordinates {
                let row = &mut row[columns.start..][..TOGETHER];
                row[..TOGETHER / 2].copy_from_slice(left);
                row[TOGETHER / 2..].copy_from_slice(right);
            }
        } else {
            for ((left, right), row) in coordinates {
                let coordinates = left.iter().chain(right);
                for (u, &coordinate) in row[columns.clone()].iter_mut().zip(coordinates) {
                    *u = coordinate;
                }
            }
        }
    }
}
