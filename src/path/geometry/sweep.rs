//! A sweep over few shapes, eight flat ones at a time.

use super::Found;
use super::flats::{Flats, LANES};
use super::kind::{Kind, divides};
#[cfg(all(feature = "simd", target_arch = "x86_64"))]
use super::probe::Vectors;
use super::probe::{Plain, Probe};
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
    #[cfg(all(feature = "simd", target_arch = "x86_64"))]
    simd: Option<pulp::x86::V3>,
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
            #[cfg(all(feature = "simd", target_arch = "x86_64"))]
            simd: pulp::x86::V3::try_new(),
        }
    }

    #[inline]
    pub(super) fn nearest(&self, ray: &Ray) -> Option<Found> {
        let mut nearest = self.nearest_flat(ray);
        let mut limit = nearest.map_or(f32::INFINITY, |found| found.distance);
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
        let mut others = self.others.iter();
        self.any_flat(flats, ray, limit)
            || others.any(|(_, other)| other.intersect(ray, limit).is_some())
    }

    /// The nearest flat shape; of several at the same distance the first.
    #[inline]
    fn nearest_flat(&self, ray: &Ray) -> Option<Found> {
        #[cfg(all(feature = "simd", target_arch = "x86_64"))]
        if let Some(simd) = self.simd {
            return simd.vectorize(
                #[inline(always)]
                || self.nearest_of(&self.flats, &Vectors::new(simd, ray)),
            );
        }
        self.nearest_of(&self.flats, &Plain::new(ray))
    }

    #[inline]
    fn any_flat(&self, flats: &[Flats], ray: &Ray, limit: f32) -> bool {
        #[cfg(all(feature = "simd", target_arch = "x86_64"))]
        if let Some(simd) = self.simd {
            return simd.vectorize(
                #[inline(always)]
                || any_of(flats, &Vectors::new(simd, ray), limit),
            );
        }
        any_of(flats, &Plain::new(ray), limit)
    }

    #[inline(always)]
    fn nearest_of(&self, blocks: &[Flats], probe: &impl Probe) -> Option<Found> {
        let mut limit = f32::INFINITY;
        let mut nearest = None;
        for (block, flats) in blocks.iter().enumerate() {
            if let Some((lane, distance)) = probe.meet(flats, limit).nearest() {
                limit = distance;
                nearest = Some(block * LANES + lane);
            }
        }
        nearest.map(|place| Found {
            shape: self.flat_shapes[place],
            distance: limit,
        })
    }
}

#[inline(always)]
fn any_of(blocks: &[Flats], probe: &impl Probe, limit: f32) -> bool {
    // A loop, not `any`: its closure would not be compiled for the machine at hand.
    for flats in blocks {
        if probe.meet(flats, limit).which != 0 {
            return true;
        }
    }
    false
}
