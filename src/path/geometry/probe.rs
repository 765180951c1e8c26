//! Rays, as eight boxes or eight flat shapes are asked for them.

#[cfg(feature = "simd")]
mod lanes;
#[cfg(all(feature = "simd", target_arch = "x86_64"))]
mod vectors;

use super::balls::Balls;
use super::flats::{Bits, Flats, LANES, Lanes, bit, word};
use super::node::Node;
use crate::path::ray::{Ray, gamma};

#[cfg(feature = "simd")]
pub(in crate::path) use lanes::Inverted;
#[cfg(all(feature = "simd", target_arch = "x86_64"))]
pub(super) use vectors::Vectors;

/// A ray with what it takes to ask many boxes and flat shapes, eight at a time.
///
/// Distances are computed in plain `f32`, lane by lane: vectors of any width, and none, give the same bits.
pub(super) trait Probe {
    /// The boxes of a node that the ray enters before `limit`.
    fn enter(&self, node: &Node, limit: f32) -> Met;

    /// The flat shapes that the ray meets before `limit`, as [`Flat::intersect`](crate::path::shape::Shape::intersect) has it.
    fn meet(&self, flats: &Flats, limit: f32) -> Met;

    /// The spheres that the ray meets before `limit`, as [`Sphere::intersect`](crate::path::shape::Shape::intersect) has it.
    fn strike(&self, balls: &Balls, limit: f32) -> Met;
}

/// Which of eight things a ray meets, and where.
///
/// Aligned, so that the distances are in one line of a cache: they are read one by one just after they are written.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Met {
    /// Of those that are met.
    pub(super) distances: Lanes,
    /// Which are met, the first in the lowest bit.
    pub(super) which: u32,
}

impl Met {
    /// The nearest lane and its distance; of several the first.
    #[inline(always)]
    pub(super) fn nearest(&self) -> Option<(usize, f32)> {
        let mut nearest = None;
        let mut limit = f32::INFINITY;
        for lane in self.lanes() {
            if self.distances[lane] < limit {
                limit = self.distances[lane];
                nearest = Some((lane, limit));
            }
        }
        nearest
    }

    /// The lanes that are met.
    #[inline(always)]
    pub(super) fn lanes(&self) -> impl Iterator<Item = usize> + use<> {
        let mut left = self.which;
        core::iter::from_fn(move || {
            (left != 0).then(|| {
                let lane = left.trailing_zeros() as usize;
                left &= left - 1;
                lane % LANES
            })
        })
    }
}

/// What rounding does to the distance of a box.[^ize]
///
/// [^ize]: Ize, Thiago (2013). *Robust BVH Ray Traversal*. <https://jcgt.org/published/0002/02/02/>
pub(super) const WIDER: f32 = 1.0 + 2.0 * gamma(3);

/// Which of the bounds of a box a ray enters through along each axis, as their place in [`Node::bounds`].
#[inline(always)]
fn near_sides(inverse: [f32; 3]) -> [usize; 3] {
    core::array::from_fn(|axis| axis + 3 * usize::from(inverse[axis] < 0.0))
}

/// Which of them it leaves through.
#[inline(always)]
fn far_sides(near: [usize; 3]) -> [usize; 3] {
    core::array::from_fn(|axis| 2 * axis + 3 - near[axis])
}

/// In loops over the lanes, for compilers to make vectors of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plain {
    origin: [f32; 3],
    direction: [f32; 3],
    inverse: [f32; 3],
    near: [usize; 3],
    far: [usize; 3],
}

impl Plain {
    #[inline(always)]
    pub(super) fn new(ray: &Ray) -> Self {
        let inverse = ray.direction.recip().to_array();
        let near = near_sides(inverse);
        Self {
            origin: ray.origin.to_array(),
            direction: ray.direction.to_array(),
            inverse,
            near,
            far: far_sides(near),
        }
    }
}

impl Probe for Plain {
    #[inline(always)]
    fn enter(&self, node: &Node, limit: f32) -> Met {
        let near = self.near.map(|side| &node.bounds[side]);
        let far = self.far.map(|side| &node.bounds[side]);
        let mut distances = [0.0; LANES];
        let mut inside: Bits = [0; LANES];
        for lane in 0..LANES {
            let (mut start, mut end) = (0.0, limit);
            for axis in 0..3 {
                // NaN, of a ray within the plane of a side, tells nothing.
                let enters = (near[axis][lane] - self.origin[axis]) * self.inverse[axis];
                let leaves = (far[axis][lane] - self.origin[axis]) * self.inverse[axis];
                start = if enters > start { enters } else { start };
                end = if leaves < end { leaves } else { end };
            }
            distances[lane] = start;
            inside[lane] = bit(lane, start <= end * WIDER);
        }
        Met {
            distances,
            which: word(inside),
        }
    }

    #[inline(always)]
    fn meet(&self, flats: &Flats, limit: f32) -> Met {
        let Self {
            origin, direction, ..
        } = *self;
        let mut distances = [0.0; LANES];
        let mut met: Bits = [0; LANES];
        for lane in 0..LANES {
            let offset: [f32; 3] = [
                flats.corner[0][lane] - origin[0],
                flats.corner[1][lane] - origin[1],
                flats.corner[2][lane] - origin[2],
            ];
            let dot = |a: [f32; 3], b: &[Lanes; 3]| {
                a[0] * b[0][lane] + a[1] * b[1][lane] + a[2] * b[2][lane]
            };
            let distance = dot(offset, &flats.normal) * dot(direction, &flats.normal).recip();
            let inside = [
                direction[0] * distance - offset[0],
                direction[1] * distance - offset[1],
                direction[2] * distance - offset[2],
            ];
            let s = dot(inside, &flats.first_dual);
            let t = dot(inside, &flats.second_dual);
            distances[lane] = distance;
            let inside = (distance > 0.0)
                & (distance < limit)
                & (s >= -flats.slack[0][lane])
                & (t >= -flats.slack[1][lane])
                & (s + flats.slant[lane] * t <= 1.0 + flats.slack[0][lane])
                & (t + flats.slant[lane] * s <= 1.0 + flats.slack[1][lane]);
            met[lane] = bit(lane, inside);
        }
        Met {
            distances,
            which: word(met),
        }
    }

    #[inline(always)]
    fn strike(&self, balls: &Balls, limit: f32) -> Met {
        let Self {
            origin, direction, ..
        } = *self;
        let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let mut distances = [0.0; LANES];
        let mut met: Bits = [0; LANES];
        for lane in 0..LANES {
            let squared_radius = balls.squared_radius[lane];
            let offset: [f32; 3] = [
                balls.center[0][lane] - origin[0],
                balls.center[1][lane] - origin[1],
                balls.center[2][lane] - origin[2],
            ];
            let middle = dot(offset, direction);
            let apart = [
                offset[0] - direction[0] * middle,
                offset[1] - direction[1] * middle,
                offset[2] - direction[2] * middle,
            ];
            let discriminant = squared_radius - dot(apart, apart);
            let far = middle + discriminant.sqrt().copysign(middle);
            let near = (dot(offset, offset) - squared_radius) / far;
            let (first, second) = if near < far { (near, far) } else { (far, near) };
            let distance = if first > 0.0 { first } else { second };
            distances[lane] = distance;
            let inside = (discriminant >= 0.0) & (distance > 0.0) & (distance < limit);
            met[lane] = bit(lane, inside);
        }
        Met {
            distances,
            which: word(met),
        }
    }
}
