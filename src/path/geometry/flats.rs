//! Eight flat shapes at once.

use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3A};

use crate::path::ray::{Ray, Surface};
use crate::path::shape::{Edges, Flat, inset, kept_inside};

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

/// Blocks of the given shapes in their order: `set` puts a shape into a lane of a block that is `empty` at first.
pub(super) fn blocks<'a, B: Copy, S: 'a>(
    shapes: impl Iterator<Item = &'a S>,
    empty: B,
    set: impl Fn(&mut B, usize, &S),
) -> Vec<B> {
    let mut blocks = Vec::new();
    for (place, shape) in shapes.enumerate() {
        let lane = place % LANES;
        if lane == 0 {
            blocks.push(empty);
        }
        if let Some(block) = blocks.last_mut() {
            set(block, lane, shape);
        }
    }
    blocks
}

/// Eight flat shapes, one a lane. An empty lane is all zeros: a ray's distance to it is NaN, no hit.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Flats {
    pub(super) corner: [Lanes; 3],
    pub(super) normal: [Lanes; 3],
    pub(super) first_dual: [Lanes; 3],
    pub(super) second_dual: [Lanes; 3],
    pub(super) slack: [Lanes; 2],
    pub(super) slant: Lanes,
}

impl Flats {
    /// Blocks of the given shapes in their order.
    pub(super) fn blocks<'a>(shapes: impl Iterator<Item = &'a Flat>) -> Vec<Self> {
        blocks(shapes, Self::default(), Self::set)
    }

    /// Where a ray meets the triangle in a lane, to the bit what [`Flat::surface`](crate::path::shape::Shape::surface) gives, and the coordinates
    /// along the edges there. Those are as they were before any turning, which `turned` tells of.
    #[inline]
    pub(super) fn surface(
        &self,
        lane: usize,
        edges: &Edges,
        turned: bool,
        ray: &Ray,
        distance: f32,
    ) -> (Surface, Vec2) {
        let vector = |[x, y, z]: &[Lanes; 3]| Vec3A::new(x[lane], y[lane], z[lane]);
        let normal = vector(&self.normal);
        let inside = ray.direction * distance - (edges.corner - ray.origin);
        let along = [&self.first_dual, &self.second_dual].map(|dual| inside.dot(vector(dual)));
        let slack = self.slack.each_ref().map(|slack| slack[lane]);
        let [s, t] = kept_inside(along, inset(slack), self.slant[lane]);
        let along = if turned { [t, s] } else { [s, t] };
        // The sum of two numbers does not depend on their order.
        let surface = Surface {
            point: edges.corner + (edges.first * along[0] + edges.second * along[1]),
            normal,
            margin: edges.margin(normal),
            detail: (),
        };
        (surface, Vec2::from(along))
    }

    pub(super) fn set(&mut self, lane: usize, flat: &Flat) {
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
}
