//! The bounding volume hierarchy of many shapes.

use std::time::Duration;

use glam::Vec3A;
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh;
use obvhs::ray::{Ray as TreeRay, RayHit};

use super::{Found, around};
use crate::path::ray::{Ray, gamma};
use crate::path::shape::Shape;

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
    pub(super) fn new<S: Shape>(shapes: &[S]) -> Self {
        let boxes: Vec<_> = shapes.iter().map(Shape::bounds).collect();
        Self::around(&boxes)
    }

    /// The tree of at least one box, given by two corners.
    pub(super) fn around(boxes: &[[Vec3A; 2]]) -> Self {
        let [low, high] = around(boxes.iter().copied());
        let extent = low.abs().max(high.abs()).max_element();
        let extent = extent.max(f32::MIN_POSITIVE);
        let scale = (EXTENT - extent.log2().round()).clamp(-120.0, 120.0).exp2();
        let boxes: Vec<Aabb> = boxes
            .iter()
            .map(|&corners| scaled(corners, scale))
            .collect();
        // A slow build is for those who render long; a million boxes would take longer than many pictures.
        let parameters = if boxes.len() < SLOW {
            BvhBuildParams::slow_build()
        } else {
            BvhBuildParams::fast_build()
        };
        Self {
            tree: build_cwbvh(&boxes, parameters, &mut Duration::default()),
            scale,
        }
    }

    #[inline]
    pub(super) fn nearest<S: Shape>(&self, shapes: &[S], ray: &Ray, limit: f32) -> Option<Found> {
        self.search(ray, limit, |shape, limit| {
            shapes[shape].intersect(ray, limit)
        })
    }

    #[inline]
    pub(super) fn occluded<S: Shape>(&self, shapes: &[S], ray: &Ray, limit: f32) -> bool {
        self.meets(ray, limit, |shape, limit| {
            shapes[shape].intersect(ray, limit).is_some()
        })
    }

    /// The nearest of what is in the boxes: `meet` returns the distance of one of them if it is met before a limit.
    #[inline]
    pub(super) fn search(
        &self,
        ray: &Ray,
        limit: f32,
        mut meet: impl FnMut(usize, f32) -> Option<f32>,
    ) -> Option<Found> {
        let mut hit = RayHit::none();
        let whole = self.ray(ray, limit);
        let found = self.tree.ray_traverse(whole, &mut hit, |so_far, slot| {
            meet(self.shape(slot), so_far.tmax / self.scale)
                .map_or(f32::INFINITY, |distance| distance * self.scale)
        });
        found.then(|| Found {
            shape: self.shape(hit.primitive_id as usize),
            distance: hit.t / self.scale,
        })
    }

    /// Whether any of what is in the boxes is met before `limit`.
    #[inline]
    pub(super) fn meets(
        &self,
        ray: &Ray,
        limit: f32,
        mut meet: impl FnMut(usize, f32) -> bool,
    ) -> bool {
        let segment = self.ray(ray, limit);
        !self.tree.ray_traverse_miss(segment, |_, slot| {
            if meet(self.shape(slot), limit) {
                0.0
            } else {
                f32::INFINITY
            }
        })
    }

    /// The ray as the tree takes it: scaled, and without the zeros of negative sign, whose octant the tree takes for that of
    /// the positive ones but whose inverses it does not.
    #[inline]
    fn ray(&self, ray: &Ray, limit: f32) -> TreeRay {
        TreeRay::new(
            ray.origin * self.scale,
            ray.direction + Vec3A::ZERO,
            0.0,
            limit * self.scale,
        )
    }

    /// What is in a slot of the tree.
    #[inline]
    fn shape(&self, slot: usize) -> usize {
        self.tree.primitive_indices[slot] as usize
    }
}

/// From so many boxes on, the tree is built fast.
const SLOW: usize = 100_000;

/// A scaled box, widened by what rounding does to a ray's way to it.
fn scaled(corners: [Vec3A; 2], scale: f32) -> Aabb {
    let [low, high] = corners.map(|corner| corner * scale);
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
