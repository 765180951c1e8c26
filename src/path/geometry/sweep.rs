//! A sweep over few shapes, eight flat ones at a time.

use super::Found;
use super::kind::{Kind, divides};
use crate::path::ray::Ray;
use crate::path::shape::{Flat, Primitive, Shape};

/// The shapes, laid out for vector code.
///
/// The arithmetic is plain `f32`, lane by lane: vectors of any width, and none, give the same bits.
#[derive(Debug)]
pub(in crate::path) struct Sweep {
    flats: Vec<Flats>,
    /// Those of them that can be between two points of the scene, if the shapes are all there is.
    dividing: Vec<Flats>,
    /// Which shape each of the flats is: those of simple equations come first.
    pub(in crate::path) flat_shapes: Vec<usize>,
    /// The shapes that are not flat, and which they are.
    others: Vec<(usize, Primitive)>,
    #[cfg(feature = "simd")]
    arch: pulp::Arch,
}

const LANES: usize = 8;

type Lanes = [f32; LANES];

/// Eight flat shapes, one a lane. An empty lane is all zeros: a ray's distance to it is NaN, no hit.
#[derive(Clone, Copy, Debug, Default)]
struct Flats {
    corner: [Lanes; 3],
    normal: [Lanes; 3],
    first_dual: [Lanes; 3],
    second_dual: [Lanes; 3],
    slack: [Lanes; 2],
    slant: Lanes,
}

impl Flats {
    /// Blocks of the given shapes in their order.
    fn blocks<'a>(shapes: impl Iterator<Item = &'a Flat>) -> Vec<Self> {
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

    /// The distances at which the ray meets each of them, as [`Flat::intersect`]; infinite where it does not.
    #[inline(always)]
    fn distances(&self, origin: [f32; 3], direction: [f32; 3], limit: f32) -> Lanes {
        let mut distances = [0.0; LANES];
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
            let hit = (distance > 0.0)
                & (distance < limit)
                & (s >= -self.slack[0][lane])
                & (t >= -self.slack[1][lane])
                & (s + self.slant[lane] * t <= 1.0 + self.slack[0][lane])
                & (t + self.slant[lane] * s <= 1.0 + self.slack[1][lane]);
            distances[lane] = if hit { distance } else { f32::INFINITY };
        }
        distances
    }
}

/// The place, in the order of the flat shapes, of a lane of a block.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "a few blocks")]
fn slot(block: f32, lane: usize) -> usize {
    block as usize * LANES + lane
}

impl Sweep {
    pub(super) fn new(shapes: &[Primitive]) -> Self {
        let (mut flats, mut others) = (Vec::new(), Vec::new());
        for (index, shape) in shapes.iter().enumerate() {
            match shape {
                Primitive::Flat(flat) => flats.push((index, flat)),
                other => others.push((index, *other)),
            }
        }
        flats.sort_by_key(|(_, flat)| Kind::of(flat));
        let in_order = flats.iter().map(|&(_, flat)| flat);
        let dividing = in_order.clone().filter(|flat| divides(flat, shapes));
        Self {
            flats: Flats::blocks(in_order.clone()),
            dividing: Flats::blocks(dividing),
            flat_shapes: flats.iter().map(|&(index, _)| index).collect(),
            others,
            #[cfg(feature = "simd")]
            arch: pulp::Arch::new(),
        }
    }

    #[inline]
    pub(super) fn nearest(&self, ray: &Ray) -> Option<Found> {
        #[cfg(feature = "simd")]
        let flat = self.arch.dispatch(Nearest(self, ray));
        #[cfg(not(feature = "simd"))]
        let flat = self.nearest_flat(ray);
        let mut limit = flat.map_or(f32::INFINITY, |found| found.distance);
        let mut nearest = flat;
        for &(shape, other) in &self.others {
            if let Some(distance) = other.intersect(ray, limit) {
                limit = distance;
                nearest = Some(Found { shape, distance });
            }
        }
        nearest
    }

    #[inline]
    pub(super) fn occluded(&self, ray: &Ray, limit: f32) -> bool {
        self.any(&self.flats, ray, limit)
    }

    /// The same for a ray from one point of the scene to another.
    #[inline]
    pub(super) fn divided(&self, ray: &Ray, limit: f32) -> bool {
        self.any(&self.dividing, ray, limit)
    }

    #[inline]
    fn any(&self, flats: &[Flats], ray: &Ray, limit: f32) -> bool {
        #[cfg(feature = "simd")]
        let flat = self.arch.dispatch(Occluded(flats, ray, limit));
        #[cfg(not(feature = "simd"))]
        let flat = any_occludes(flats, ray, limit);
        let mut others = self.others.iter();
        flat || others.any(|(_, other)| other.intersect(ray, limit).is_some())
    }

    /// The nearest flat shape; of several at the same distance the first.
    #[inline(always)]
    fn nearest_flat(&self, ray: &Ray) -> Option<Found> {
        let (origin, direction) = (ray.origin.to_array(), ray.direction.to_array());
        let mut nearest = [f32::INFINITY; LANES];
        // The block of each, as a number of the same width and kind: so both are selected alike.
        let mut blocks = [0.0_f32; LANES];
        let mut block = 0.0;
        for flats in &self.flats {
            let distances = flats.distances(origin, direction, f32::INFINITY);
            for lane in 0..LANES {
                let nearer = distances[lane] < nearest[lane];
                nearest[lane] = if nearer {
                    distances[lane]
                } else {
                    nearest[lane]
                };
                blocks[lane] = if nearer { block } else { blocks[lane] };
            }
            block += 1.0;
        }
        let distance = nearest
            .iter()
            .fold(f32::INFINITY, |least, &d| if d < least { d } else { least });
        if distance == f32::INFINITY {
            return None;
        }
        (0..LANES)
            .filter(|&lane| nearest[lane] == distance)
            .map(|lane| slot(blocks[lane], lane))
            .min()
            .map(|slot| Found {
                shape: self.flat_shapes[slot],
                distance,
            })
    }
}

#[inline(always)]
fn any_occludes(blocks: &[Flats], ray: &Ray, limit: f32) -> bool {
    let (origin, direction) = (ray.origin.to_array(), ray.direction.to_array());
    // A loop, not `any`: its closure would not be compiled for the machine at hand.
    for flats in blocks {
        let distances = flats.distances(origin, direction, limit);
        let mut met = false;
        for distance in distances {
            met |= distance < f32::INFINITY;
        }
        if met {
            return true;
        }
    }
    false
}

/// [`Sweep::nearest_flat`] in the vector code of the machine at hand.
#[cfg(feature = "simd")]
struct Nearest<'a>(&'a Sweep, &'a Ray);

#[cfg(feature = "simd")]
impl pulp::NullaryFnOnce for Nearest<'_> {
    type Output = Option<Found>;

    #[inline(always)]
    fn call(self) -> Option<Found> {
        self.0.nearest_flat(self.1)
    }
}

/// [`any_occludes`] in the vector code of the machine at hand.
#[cfg(feature = "simd")]
struct Occluded<'a>(&'a [Flats], &'a Ray, f32);

#[cfg(feature = "simd")]
impl pulp::NullaryFnOnce for Occluded<'_> {
    type Output = bool;

    #[inline(always)]
    fn call(self) -> bool {
        any_occludes(self.0, self.1, self.2)
    }
}
