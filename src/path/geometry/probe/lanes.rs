//! Boxes, asked for a ray a lane.

use glam::Vec3A;
use pulp::Simd;

use super::WIDER;
use crate::path::lanes::{Mask, Real, Vector};

/// Rays with what it takes to ask boxes.
pub(in crate::path) struct Inverted<S: Simd> {
    origin: Vector<S>,
    inverse: Vector<S>,
    backwards: [Mask<S>; 3],
}

impl<S: Simd> Inverted<S> {
    #[inline(always)]
    pub(in crate::path) fn new(origin: Vector<S>, direction: Vector<S>) -> Self {
        let (zero, one) = (origin.x.all(0.0), origin.x.all(1.0));
        let inverse = Vector {
            x: one / direction.x,
            y: one / direction.y,
            z: one / direction.z,
        };
        Self {
            origin,
            inverse,
            backwards: [inverse.x.lt(zero), inverse.y.lt(zero), inverse.z.lt(zero)],
        }
    }

    /// Where each ray enters the box of two corners, and whether it does before `limit`: the arithmetic of single rays.
    #[inline(always)]
    pub(in crate::path) fn enter(
        &self,
        [low, high]: [Vec3A; 2],
        limit: Real<S>,
    ) -> (Real<S>, Mask<S>) {
        let simd = limit.simd();
        let low = (Vector::splat(simd, low) - self.origin) * self.inverse;
        let high = (Vector::splat(simd, high) - self.origin) * self.inverse;
        let (mut start, mut end) = (limit.all(0.0), limit);
        let axes = [(low.x, high.x), (low.y, high.y), (low.z, high.z)];
        // No closures: compilers do not always make them part of the function that is compiled for a machine.
        for ((low, high), backwards) in axes.into_iter().zip(self.backwards) {
            // NaN, of a ray within the plane of a side, tells nothing.
            start = backwards.select(high, low).max(start);
            end = backwards.select(low, high).min(end);
        }
        (start, start.le(end * WIDER))
    }
}
