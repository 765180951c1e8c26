//! How blocks of coordinates are laid out, and computed with the vector instructions of the machine at hand.

use core::ops::Range;

use super::Independent;

/// Runs `job`, compiled for the machine at hand where the feature `simd` is on. The results are the same bits
/// everywhere: nothing in a job is reordered or fused.
#[inline(always)]
pub(super) fn vectorised<R>(job: impl FnOnce() -> R) -> R {
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
