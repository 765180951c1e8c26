//! Blocks of finite sets: one dimension after the other, many points at once.

use core::ops::Range;

use super::block::{Aligned, Block, Rows, TOGETHER, vectorised};
use super::{PointSet, fill_singly};

/// Points whose coordinates in one dimension are computed together.
pub(super) const CHUNK: usize = 64;

/// Fewer points are not worth preparing a column for.
const FEWEST: u64 = 16;

/// A finite set, past the size of which further sets follow.
pub(super) trait Finite: PointSet {
    type Column: Column;

    /// What the points of the set number `set` have in common in `dimension`. The size is at most 2^32.
    fn column(&self, set: u64, dimension: u32) -> Self::Column;

    /// What selects the coordinates past the last dimension.
    fn seed(&self) -> u64;
}

/// The coordinates in one dimension of the points of one set.
pub(super) trait Column {
    /// Writes those of the points `places`, which are below the size.
    fn write(&self, places: &[u32; CHUNK], out: &mut [f64; CHUNK]);
}

/// [`PointSet::fill`] for a finite set.
pub(super) fn fill<P: Finite>(points: &P, first: u64, dimensions: Range<u32>, out: &mut [f64]) {
    let size = points.size().unwrap_or(u64::MAX);
    let count = out.len().checked_div(dimensions.len()).unwrap_or(0);
    if size.min(count as u64) < FEWEST || size > 1 << 32 {
        return fill_singly(points, first, dimensions, out);
    }
    let block = Block::new(first, dimensions, out, points.dimensions(), points.seed());
    let (mut index, mut out) = (first, block.out);
    while !out.is_empty() {
        let (set, place) = (index / size, index % size);
        let left = usize::try_from(size - place).unwrap_or(usize::MAX);
        let (now, later) = out.split_at_mut(out.len().min(left.saturating_mul(block.width)));
        for start in (0..block.dimensions.len()).step_by(TOGETHER) {
            let mut columns = [const { None }; TOGETHER];
            for (column, dimension) in columns.iter_mut().zip(block.dimensions.clone().skip(start))
            {
                *column = Some(points.column(set, dimension));
            }
            vectorised(
                #[inline(always)]
                || write(&columns, place, size, now, block.width, start),
            );
        }
        index = index.wrapping_add(left as u64);
        out = later;
    }
}

/// Writes the coordinates of the points from `place` on into the columns of `out` from `start` on.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "places are below 2^32")]
fn write<C: Column>(
    columns: &[Option<C>; TOGETHER],
    place: u64,
    size: u64,
    out: &mut [f64],
    width: usize,
    start: usize,
) {
    let last = (size - 1) as u32;
    let mut room = Aligned([[0.0; CHUNK]; TOGETHER]);
    let mut side_by_side = Rows::new();
    for (place, out) in (place..).step_by(CHUNK).zip(out.chunks_mut(CHUNK * width)) {
        let mut places = [0; CHUNK];
        for (next, lane) in places.iter_mut().zip(0..) {
            // There may be more room than points.
            *next = (place as u32).saturating_add(lane).min(last);
        }
        let mut count = 0;
        for (column, room) in columns.iter().flatten().zip(&mut room.0) {
            column.write(&places, room);
            count += 1;
        }
        let rows = out.chunks_exact_mut(width);
        side_by_side.write(room.0.each_ref(), 0, rows, start..start + count);
    }
}
