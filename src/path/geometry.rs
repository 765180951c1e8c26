//! All shapes of a scene, and which of them a ray meets.

use std::time::Duration;

use glam::Vec3A;
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh;
use obvhs::ray::RayHit;

use super::ray::{Ray, Surface, gamma};
use super::shape::{Primitive, Shape};

/// The shapes of a scene in a bounding volume hierarchy.
pub(in crate::path) struct Geometry {
    shapes: Vec<Primitive>,
    tree: CwBvh,
}

/// The nearest shape that a ray meets.
#[derive(Clone, Copy, Debug)]
pub(in crate::path) struct Hit {
    pub(in crate::path) shape: usize,
    pub(in crate::path) surface: Surface,
}

impl Geometry {
    pub(in crate::path) fn new(shapes: Vec<Primitive>) -> Self {
        let boxes: Vec<Aabb> = shapes.iter().map(bounds).collect();
        let tree = if shapes.is_empty() {
            CwBvh::default()
        } else {
            build_cwbvh(
                &boxes,
                BvhBuildParams::very_slow_build(),
                &mut Duration::default(),
            )
        };
        Self { shapes, tree }
    }

    /// The first shape that the ray meets.
    #[inline]
    pub(in crate::path) fn nearest(&self, ray: &Ray) -> Option<Hit> {
        let mut hit = RayHit::none();
        let whole = obvhs::ray::Ray::new_inf(ray.origin, ray.direction);
        let found = self.tree.ray_traverse(whole, &mut hit, |so_far, slot| {
            let shape = &self.shapes[self.tree.primitive_indices[slot] as usize];
            shape.intersect(ray, so_far.tmax).unwrap_or(f32::INFINITY)
        });
        found.then(|| {
            let shape = self.tree.primitive_indices[hit.primitive_id as usize] as usize;
            let surface = self.shapes[shape].surface(ray, hit.t);
            Hit { shape, surface }
        })
    }

    /// Whether any shape is between two points of surfaces.
    #[inline]
    pub(in crate::path) fn occluded(&self, ray: &Ray, limit: f32) -> bool {
        let segment = obvhs::ray::Ray::new(ray.origin, ray.direction, 0.0, limit);
        !self.tree.ray_traverse_miss(segment, |_, slot| {
            let shape = &self.shapes[self.tree.primitive_indices[slot] as usize];
            shape.intersect(ray, limit).unwrap_or(f32::INFINITY)
        })
    }
}

/// A box around the shape, widened by what rounding does to a ray's way to it.
fn bounds(shape: &Primitive) -> Aabb {
    let [low, high] = shape.bounds();
    let margin = gamma(8) * low.abs().max(high.abs()).max(high - low).max_element();
    Aabb::new(low - Vec3A::splat(margin), high + Vec3A::splat(margin))
}

impl core::fmt::Debug for Geometry {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Geometry")
            .field("shapes", &self.shapes)
            .finish_non_exhaustive()
    }
}
