//! Eight flat shapes at once.

use crate::path::ray::Ray;
use crate::path::shape::Flat;

/// How many shapes there are in a block.
pub(super) const LANES: usize = 8;

/// A number for each of them.
pub(super) type Lanes = [f32; LANES];

/// A bit for each lane, the first the lowest.
pub(super) type Bits = [u32; LANES];

/// The bit of a lane where `set` holds. Numbers as wide as the distances, which vectors keep in lanes.
#[inline(always)]
pub(super) fn bit(lane: usize, set: bool) -> u32 {
    if set { 1 << lane } else { 0 }
}

/// All bits in one word.
#[inline(always)]
pub(super) fn word(bits: Bits) -> u32 {
    bits.iter().fold(0, |word, bit| word | bit)
}

/// Eight flat shapes, one a lane. An empty lane is all zeros: a ray's distance to it is NaN, no hit.
///
/// The arithmetic is plain `f32`, lane by lane: vectors of any width, and none, give the same bits.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Flats {
    corner: [Lanes; 3],
    normal: [Lanes; 3],
    first_dual: [Lanes; 3],
    second_dual: [Lanes; 3],
    slack: [Lanes; 2],
    slant: Lanes,
}

/// Where a ray meets the plane of each shape.
struct Meeting {
    distances: Lanes,
    /// Whether that is within the shape, in front of the ray and before the limit.
    inside: Bits,
}

impl Flats {
    /// Blocks of the given shapes in their order.
    pub(super) fn blocks<'a>(shapes: impl Iterator<Item = &'a Flat>) -> Vec<Self> {
        let mut blocks = Vec::new();
        for (place, flat) in shapes.enumerate() {
            let lane = place % LANES;
            if lane == 0 {
                blocks.push(Self::default());
            }
            if let Some(block) = blocks.last_mut() {
                block.set(lane, flat);
            }
        }
        blocks
    }

    fn set(&mut self, lane: usize, flat: &Flat) {
        for axis in 0..3 {
            self.corner[axis][lane] = flat.corner[axis];
            self.normal[axis][lane] = flat.normal[axis];
            self.first_dual[axis][lane] = flat.first_dual[axis];
            self.second_dual[axis][lane] = flat.second_dual[axis];
        }
        self.slack[0][lane] = flat.slack[0];
        self.slack[1][lane] = flat.slack[1];
        self.slant[lane] = flat.slant;
    }

    /// As [`Flat::intersect`](crate::path::shape::Shape::intersect).
    #[inline(always)]
    fn meet(&self, ray: &Ray, limit: f32) -> Meeting {
        let (origin, direction) = (ray.origin.to_array(), ray.direction.to_array());
        let mut meeting = Meeting {
            distances: [0.0; LANES],
            inside: [0; LANES],
        };
        for lane in 0..LANES {
            let offset: [f32; 3] = [
                self.corner[0][lane] - origin[0],
                self.corner[1][lane] - origin[1],
                self.corner[2][lane] - origin[2],
            ];
            let dot = |a: [f32; 3], b: &[Lanes; 3]| {
                a[0] * b[0][lane] + a[1] * b[1][lane] + a[2] * b[2][lane]
            };
            let distance = dot(offset, &self.normal) * dot(direction, &self.normal).recip();
            let inside = [
                direction[0] * distance - offset[0],
                direction[1] * distance - offset[1],
                direction[2] * distance - offset[2],
            ];
            let s = dot(inside, &self.first_dual);
            let t = dot(inside, &self.second_dual);
            meeting.distances[lane] = distance;
            let inside = (distance > 0.0)
                & (distance < limit)
                & (s >= -self.slack[0][lane])
                & (t >= -self.slack[1][lane])
                & (s + self.slant[lane] * t <= 1.0 + self.slack[0][lane])
                & (t + self.slant[lane] * s <= 1.0 + self.slack[1][lane]);
            meeting.inside[lane] = bit(lane, inside);
        }
        meeting
    }

    /// The distances at which the ray meets each of them; infinite where it does not.
    #[inline(always)]
    pub(super) fn distances(&self, ray: &Ray, limit: f32) -> Lanes {
        let Meeting {
            mut distances,
            inside,
        } = self.meet(ray, limit);
        for lane in 0..LANES {
            distances[lane] = if inside[lane] != 0 {
                distances[lane]
            } else {
                f32::INFINITY
            };
        }
        distances
    }

    /// The lane of the nearest one that the ray meets before `limit`, and its distance; of several the first.
    #[inline(always)]
    pub(super) fn nearest(&self, ray: &Ray, limit: f32) -> Option<(usize, f32)> {
        let Meeting { distances, inside } = self.meet(ray, limit);
        let mut nearest = None;
        let mut limit = f32::INFINITY;
        let mut left = word(inside);
        while left != 0 {
            let lane = left.trailing_zeros() as usize;
            left &= left - 1;
            if distances[lane] < limit {
                limit = distances[lane];
                nearest = Some((lane, limit));
            }
        }
        nearest
    }

    /// Whether the ray meets any before `limit`.
    #[inline(always)]
    pub(super) fn occlude(&self, ray: &Ray, limit: f32) -> bool {
        word(self.meet(ray, limit).inside) != 0
    }
}
