//! The bounding volume hierarchy of many shapes.

use std::time::Duration;

use glam::Vec3A;
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh;
use obvhs::ray::{Ray as TreeRay, RayHit};

use super::Found;
use crate::path::ray::{Ray, gamma};
use crate::path::shape::{Primitive, Shape};

/// An eight-way tree of boxes around the shapes.
///
/// The tree is built of the shapes scaled up by a power of two, which is exact, to an extent of about
/// [`EXTENT`]: its traversal ignores boxes within 1e-4 of the origin of the ray, which is nothing there.
pub(super) struct Tree {
    tree: CwBvh,
    scale: f32,
}

/// The logarithm of the extent of the scaled scene: its square and its product with the largest inverse of a
/// direction, 2^23, stay in the range of `f32`.
const EXTENT: f32 = 40.0;

impl Tree {
    /// The tree of at least one shape.
    pub(super) fn new(shapes: &[Primitive]) -> Self {
        let extent = shapes
            .iter()
            .flat_map(Shape::bounds)
            .fold(f32::MIN_POSITIVE, |extent, corner| {
                extent.max(corner.abs().max_element())
            });
        let scale = (EXTENT - extent.log2().round()).clamp(-120.0, 120.0).exp2();
        let boxes: Vec<Aabb> = shapes.iter().map(|shape| bounds(shape, scale)).collect();
        let parameters = BvhBuildParams::slow_build();
        Self {
            tree: build_cwbvh(&boxes, parameters, &mut Duration::default()),
            scale,
        }
    }

    #[inline]
    pub(super) fn nearest(&self, shapes: &[Primitive], ray: &Ray) -> Option<Found> {
        let mut hit = RayHit::none();
        let whole = TreeRay::new_inf(ray.origin * self.scale, ray.direction);
        let found = self.tree.ray_traverse(whole, &mut hit, |so_far, slot| {
            self.meet(shapes, ray, so_far.tmax, slot)
        });
        found.then(|| Found {
            shape: self.tree.primitive_indices[hit.primitive_id as usize] as usize,
            distance: hit.t / self.scale,
        })
    }

    #[inline]
    pub(super) fn occluded(&self, shapes: &[Primitive], ray: &Ray, limit: f32) -> bool {
        let limit = limit * self.scale;
        let segment = TreeRay::new(ray.origin * self.scale, ray.direction, 0.0, limit);
        !self
            .tree
            .ray_traverse_miss(segment, |_, slot| self.meet(shapes, ray, limit, slot))
    }

    /// The scaled distance of the shape in a slot of the tree; infinite if it is not met within `limit`.
    #[inline]
    fn meet(&self, shapes: &[Primitive], ray: &Ray, limit: f32, slot: usize) -> f32 {
        shapes[self.tree.primitive_indices[slot] as usize]
            .intersect(ray, limit / self.scale)
            .map_or(f32::INFINITY, |distance| distance * self.scale)
    }
}

/// A box around the scaled shape, widened by what rounding does to a ray's way to it.
fn bounds(shape: &Primitive, scale: f32) -> Aabb {
    let [low, high] = shape.bounds().map(|corner| corner * scale);
    let margin = gamma(8) * low.abs().max(high.abs()).max_element();
    Aabb::new(low - Vec3A::splat(margin), high + Vec3A::splat(margin))
}

impl core::fmt::Debug for Tree {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Tree")
            .field("nodes", &self.tree.nodes.len())
            .finish_non_exhaustive()
    }
}
