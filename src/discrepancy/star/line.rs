//! The star discrepancy in one dimension: the points in order.

use super::{AnchoredBox, Boundary};
use crate::discrepancy::Points;

/// The box of the largest local discrepancy.
///
/// With the points in order it is the maximum over `i` of `x_i - i / n` and of `(i + 1) / n - x_i`, counting from 0, and
/// of the interval `[0, 1)`, which has points missing only if some are at 1.
pub(super) fn attained(points: &Points<'_>) -> AnchoredBox {
    let mut sorted: Vec<f64> = points.column(0).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let count = sorted.len() as f64;
    let mut largest = f64::NEG_INFINITY;
    let mut at = (0.0, Boundary::Open);
    for (i, &x) in sorted.iter().enumerate() {
        let open = x - i as f64 / count;
        let closed = (i + 1) as f64 / count - x;
        if open > largest {
            (largest, at) = (open, (x, Boundary::Open));
        }
        if closed > largest {
            (largest, at) = (closed, (x, Boundary::Closed));
        }
    }
    let (corner, boundary) = at;
    AnchoredBox::new(points, vec![corner], boundary)
}
