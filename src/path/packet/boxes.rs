//! The boxes around what is found lane by lane.

use glam::Vec3A;
use pulp::Simd;

use crate::path::geometry::WIDER;
use crate::path::lanes::{Mask, Real, Vector};

/// Boxes, given by two corners each.
#[derive(Debug)]
pub(super) struct Boxes(pub(super) Vec<[Vec3A; 2]>);

impl Boxes {
    /// Where rays enter any of them before `limit`, up to rounding: the same arithmetic as that of a node of a tree.
    #[inline(always)]
    pub(super) fn entered<S: Simd>(
        &self,
        origin: Vector<S>,
        direction: Vector<S>,
        limit: Real<S>,
    ) -> Mask<S> {
        let simd = limit.simd();
        let nowhere = limit.lt(limit);
        if self.0.is_empty() {
            return nowhere;
        }
        let (zero, one) = (limit.all(0.0), limit.all(1.0));
        let inverse = Vector {
            x: one / direction.x,
            y: one / direction.y,
            z: one / direction.z,
        };
        // No closures: compilers do not always make them part of the function that is compiled for a machine.
        let mut entered = nowhere;
        let backwards = [inverse.x.lt(zero), inverse.y.lt(zero), inverse.z.lt(zero)];
        for [low, high] in &self.0 {
            let low = (Vector::splat(simd, *low) - origin) * inverse;
            let high = (Vector::splat(simd, *high) - origin) * inverse;
            let (mut start, mut end) = (zero, limit);
            let axes = [(low.x, high.x), (low.y, high.y), (low.z, high.z)];
            for ((low, high), backwards) in axes.into_iter().zip(backwards) {
                // NaN, of a ray within the plane of a side, tells nothing.
                start = backwards.select(high, low).max(start);
                end = backwards.select(low, high).min(end);
            }
            entered = entered | start.le(end * WIDER);
        }
        entered
    }
}
