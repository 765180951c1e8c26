//! A sweep over few shapes, eight flat ones at a time.

use super::Found;
use super::flats::{Flats, LANES};
use super::kind::{Kind, divides};
use crate::path::ray::Ray;
use crate::path::shape::{Primitive, Shape};

/// The shapes, laid out for vector code.
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
        let mut nearest = [f32::INFINITY; LANES];
        // The block of each, as a number of the same width and kind: so both are selected alike.
        let mut blocks = [0.0_f32; LANES];
        let mut block = 0.0;
        for flats in &self.flats {
            let distances = flats.distances(ray, f32::INFINITY);
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
    // A loop, not `any`: its closure would not be compiled for the machine at hand.
    for flats in blocks {
        if flats.occlude(ray, limit) {
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
