//! Shapes that few scenes have, in functions of their own: within the loop of paths they would only make it longer.

use pulp::{NullaryFnOnce, Simd};

use super::Hit;
use crate::path::lanes::{Mask, Real, Vector};
use crate::path::shape::{Cylinder, Disk};

/// The disks and cylinders.
#[derive(Debug, Default)]
pub(super) struct Rare {
    pub(super) disks: Vec<(u32, Disk)>,
    pub(super) cylinders: Vec<(u32, Cylinder)>,
}

impl Rare {
    #[inline(always)]
    pub(super) fn is_empty(&self) -> bool {
        self.disks.is_empty() && self.cylinders.is_empty()
    }
}

/// The nearest of them and of what is met already.
pub(super) struct Nearest<'a, S: Simd> {
    pub(super) rare: &'a Rare,
    /// Where rays start, and where they go.
    pub(super) rays: [Vector<S>; 2],
    pub(super) hit: Hit<S>,
}

impl<S: Simd> NullaryFnOnce for Nearest<'_, S> {
    type Output = Hit<S>;

    #[inline(always)]
    fn call(self) -> Hit<S> {
        let ([origin, direction], mut hit) = (self.rays, self.hit);
        let simd = hit.distance.simd();
        for (shape, disk) in &self.rare.disks {
            hit = hit.nearer(*shape, disk.meet(simd, origin, direction));
        }
        for (shape, cylinder) in &self.rare.cylinders {
            hit = hit.nearer(*shape, cylinder.meet(simd, origin, direction));
        }
        hit
    }
}

/// Whether any of them is nearer than a limit, or the way is blocked already.
pub(super) struct Occluded<'a, S: Simd> {
    pub(super) rare: &'a Rare,
    pub(super) rays: [Vector<S>; 2],
    pub(super) limit: Real<S>,
    pub(super) blocked: Mask<S>,
}

impl<S: Simd> NullaryFnOnce for Occluded<'_, S> {
    type Output = Mask<S>;

    #[inline(always)]
    fn call(self) -> Mask<S> {
        let ([origin, direction], mut blocked) = (self.rays, self.blocked);
        let simd = self.limit.simd();
        for (_, disk) in &self.rare.disks {
            let met = disk.meet(simd, origin, direction);
            blocked = blocked | (met.inside & met.distance.lt(self.limit));
        }
        for (_, cylinder) in &self.rare.cylinders {
            let met = cylinder.meet(simd, origin, direction);
            blocked = blocked | (met.inside & met.distance.lt(self.limit));
        }
        blocked
    }
}
