//! Where the squares of an integrand are.

use crate::points::vectorised;

/// Squares of values.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Squares {
    sum: f64,
    count: f64,
}

impl Squares {
    #[inline]
    pub(super) fn add(&mut self, other: &Self) {
        self.sum += other.sum;
        self.count += other.count;
    }

    pub(super) fn mean(&self) -> Option<f64> {
        (self.count > 0.0).then(|| self.sum / self.count)
    }
}

/// Adds the square of each point to the `axes` of the `bins` that its coordinates hit.
pub(super) fn add_up(bins: &mut [Squares], axes: usize, hits: &[u32], squares: &[f64]) {
    // Unrolled for the usual numbers of axes.
    vectorised(
        #[inline(always)]
        || match axes {
            0 => {}
            1 => add_up_along(1, bins, hits, squares),
            2 => add_up_along(2, bins, hits, squares),
            3 => add_up_along(3, bins, hits, squares),
            4 => add_up_along(4, bins, hits, squares),
            5 => add_up_along(5, bins, hits, squares),
            6 => add_up_along(6, bins, hits, squares),
            7 => add_up_along(7, bins, hits, squares),
            8 => add_up_along(8, bins, hits, squares),
            axes => add_up_along(axes, bins, hits, squares),
        },
    );
}

#[inline(always)]
fn add_up_along(axes: usize, bins: &mut [Squares], hits: &[u32], squares: &[f64]) {
    for (hits, &sum) in hits.chunks_exact(axes).zip(squares) {
        let more = Squares { sum, count: 1.0 };
        for &hit in hits {
            bins[hit as usize].add(&more);
        }
    }
}
