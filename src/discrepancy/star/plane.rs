//! The star discrepancy in two dimensions: one sweep from left to right.

use super::sweep::Slab;
use super::{AnchoredBox, Boundary};
use crate::discrepancy::Points;
use crate::reduce;

/// Points whose columns one job sweeps; each job begins with all points to the left of its own.
const STRIPE: usize = 8192;

/// The box of the largest local discrepancy.
pub(super) fn attained(points: &Points<'_>) -> AnchoredBox {
    let slab = slab(points);
    let stripes = stripes(&slab);
    let jobs = 2 * stripes.len() as u64;
    let mut best: Option<(f64, [f64; 2], Boundary)> = None;
    let taken: Result<(), core::convert::Infallible> = reduce::in_order(
        jobs,
        |job| {
            let boundary = match job % 2 {
                0 => Boundary::Open,
                _ => Boundary::Closed,
            };
            let stripe = usize::try_from(job / 2).expect("a stripe is in memory");
            let range = stripes[stripe].clone();
            (slab.peak(range, boundary), boundary)
        },
        |(peak, boundary)| {
            if best.is_none_or(|(excess, ..)| peak.excess > excess) {
                best = Some((peak.excess, peak.corner, boundary));
            }
            Ok(())
        },
    );
    let Ok(()) = taken;
    let (_, corner, boundary) = best.expect("there is at least one stripe");
    AnchoredBox::new(points, corner.to_vec(), boundary)
}

fn slab(points: &Points<'_>) -> Slab {
    let mut heights: Vec<f64> = points.column(1).collect();
    heights.sort_unstable_by(f64::total_cmp);
    heights.dedup();
    let mut ranked: Vec<(f64, u32)> = points
        .rows()
        .map(|row| {
            let rank = heights.partition_point(|&height| height < row[1]);
            (row[0], u32::try_from(rank).expect("fewer than 2^32 points"))
        })
        .collect();
    ranked.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    Slab {
        points: ranked,
        heights,
    }
}

/// Ranges of about [`STRIPE`] points that do not divide a column.
fn stripes(slab: &Slab) -> Vec<core::ops::Range<usize>> {
    let mut stripes = Vec::new();
    let mut start = 0;
    let count = slab.points.len();
    while start < count {
        let mut end = count.min(start + STRIPE);
        while end < count && slab.points[end].0 == slab.points[end - 1].0 {
            end += 1;
        }
        stripes.push(start..end);
        start = end;
    }
    stripes
}
