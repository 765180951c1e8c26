//! A sweep over few shapes, eight flat ones or eight spheres at a time.

use glam::Vec3A;

use super::Found;
use super::balls::Balls;
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
    /// Those of them that can be between two points of the scene.
    dividing: Vec<Flats>,
    /// Which shape each of the flats is: those of simple equations come first.
    pub(in crate::path) flat_shapes: Vec<usize>,
    /// Which of them can be between two points of the scene.
    #[cfg(feature = "simd")]
    pub(in crate::path) divides: Vec<bool>,
    balls: Vec<Balls>,
    /// Which shape each of the spheres is.
    pub(in crate::path) ball_shapes: Vec<usize>,
    /// The other shapes, disks before cylinders, and which they are.
    pub(in crate::path) round: Vec<(usize, Primitive)>,
    #[cfg(all(feature = "simd", target_arch = "x86_64"))]
    simd: Option<pulp::x86::V3>,
}

impl Sweep {
    /// The sweep over `shapes`, in a scene of them and of what is in `boxes`.
    pub(super) fn new(shapes: &[Primitive], boxes: &[[Vec3A; 2]]) -> Self {
        let (mut flats, mut balls, mut round) = (Vec::new(), Vec::new(), Vec::new());
        for (index, shape) in shapes.iter().enumerate() {
            match shape {
                Primitive::Flat(flat) => flats.push((index, flat)),
                Primitive::Sphere(sphere) => balls.push((index, sphere)),
                other => round.push((index, *other)),
            }
        }
        flats.sort_by_key(|(_, flat)| Kind::of(flat));
        round.sort_by_key(|(_, other)| matches!(other, Primitive::Cylinder(_)));
        let in_order = flats.iter().map(|&(_, flat)| flat);
        let divides = in_order.clone().map(|flat| divides(flat, shapes, boxes));
        let divides: Vec<_> = divides.collect();
        let dividing = in_order.clone().zip(&divides);
        let dividing = dividing.filter_map(|(flat, &divides)| divides.then_some(flat));
        Self {
            flats: Flats::blocks(in_order.clone()),
            dividing: Flats::blocks(dividing),
            #[cfg(feature = "simd")]
            divides,
            flat_shapes: flats.iter().map(|&(index, _)| index).collect(),
            balls: Balls::blocks(balls.iter().map(|&(_, sphere)| sphere)),
            ball_shapes: balls.iter().map(|&(index, _)| index).collect(),
            round,
            #[cfg(all(feature = "simd", target_arch = "x86_64"))]
            simd: pulp::x86::V3::try_new(),
        }
    }

    #[inline]
    pub(super) fn nearest(&self, ray: &Ray) -> Option<Found> {
        let nearest = self.nearest_in_blocks(ray);
        let limit = nearest.map_or(f32::INFINITY, |found| found.distance);
        self.nearest_round(ray, limit).or(nearest)
    }

    /// The nearest shape before `limit` that is neither flat nor a sphere.
    #[inline]
    fn nearest_round(&self, ray: &Ray, mut limit: f32) -> Option<Found> {
        let mut nearest = None;
        for &(shape, other) in &self.round {
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
        self.any_in_blocks(flats, ray, limit) || self.occluded_by_round(ray, limit)
    }

    /// Whether the ray meets a shape nearer than `limit` that is neither flat nor a sphere.
    #[inline]
    fn occluded_by_round(&self, ray: &Ray, limit: f32) -> bool {
        let mut round = self.round.iter();
        round.any(|(_, other)| other.intersect(ray, limit).is_some())
    }

    /// The nearest shape that is flat or a sphere; of several at the same distance the first.
    #[inline]
    fn nearest_in_blocks(&self, ray: &Ray) -> Option<Found> {
        #[cfg(all(feature = "simd", target_arch = "x86_64"))]
        if let Some(simd) = self.simd {
            return simd.vectorize(
                #[inline(always)]
                || self.nearest_of(&Vectors::new(simd, ray)),
            );
        }
        self.nearest_of(&Plain::new(ray))
    }

    #[inline]
    fn any_in_blocks(&self, flats: &[Flats], ray: &Ray, limit: f32) -> bool {
        #[cfg(all(feature = "simd", target_arch = "x86_64"))]
        if let Some(simd) = self.simd {
            return simd.vectorize(
                #[inline(always)]
                || self.any_of(flats, &Vectors::new(simd, ray), limit),
            );
        }
        self.any_of(flats, &Plain::new(ray), limit)
    }

    #[inline(always)]
    fn nearest_of(&self, probe: &impl Probe) -> Option<Found> {
        let mut limit = f32::INFINITY;
        let mut nearest = None;
        for (block, flats) in self.flats.iter().enumerate() {
            if let Some((lane, distance)) = probe.meet(flats, limit).nearest() {
                limit = distance;
                nearest = Some(self.flat_shapes[block * LANES + lane]);
            }
        }
        for (block, balls) in self.balls.iter().enumerate() {
            if let Some((lane, distance)) = probe.strike(balls, limit).nearest() {
                limit = distance;
                nearest = Some(self.ball_shapes[block * LANES + lane]);
            }
        }
        nearest.map(|shape| Found {
            shape,
            distance: limit,
        })
    }

    // Loops, not `any`: its closure would not be compiled for the machine at hand.
    #[inline(always)]
    fn any_of(&self, flats: &[Flats], probe: &impl Probe, limit: f32) -> bool {
        for flats in flats {
            if probe.meet(flats, limit).which != 0 {
                return true;
            }
        }
        for balls in &self.balls {
            if probe.strike(balls, limit).which != 0 {
                return true;
            }
        }
        false
    }
}
