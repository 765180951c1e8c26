//! What there is to be hit: one shape a file.
//!
//! | shape | outer side |
//! |---|---|
//! | [`Flat::triangle`] | where its corners run counter-clockwise |
//! | [`Flat::parallelogram`] | that of `first_edge x second_edge` |
//! | [`cuboid`]: six parallelograms | outside |
//! | [`Sphere`], [`Cylinder`] | outside |
//! | [`Disk`] | that of `first x second` |
//! | [`Mesh`] | where the corners of its triangles run counter-clockwise |
//!
//! Each can be [`turned`](Flat::turned).
//!
//! Unlike materials, lights and cameras, shapes cannot be added from outside for now: see [`Primitive`].

mod cuboid;
mod cylinder;
mod disk;
mod flat;
mod mesh;
mod near;
mod sphere;

use glam::Vec3A;

use super::{Ray, Shading, Surface};

pub use cuboid::cuboid;
pub use cylinder::Cylinder;
pub use disk::Disk;
pub use flat::Flat;
pub(in crate::path) use flat::{Edges, inset, kept_inside};
pub use mesh::Mesh;
#[cfg(feature = "simd")]
pub(in crate::path) use near::lanes::{Rectangle, are_near};
pub use sphere::Sphere;

/// A surface that rays can hit and whose points can be drawn.
pub trait Shape {
    /// The corners of an axis-aligned box around the shape.
    fn bounds(&self) -> [Vec3A; 2];

    /// The distance, in `(0, limit)`, at which the ray first meets the shape.
    fn intersect(&self, ray: &Ray, limit: f32) -> Option<f32>;

    /// The point of the surface at a `distance` that [`intersect`](Self::intersect) has returned for the ray.
    fn surface(&self, ray: &Ray, distance: f32) -> Surface;

    /// The parametrisation of the surface at a point of it.
    fn shading(&self, surface: &Surface) -> Shading;

    /// The area of the surface.
    fn area(&self) -> f32;

    /// A point of the surface, drawn from the coordinates `u` in `[0, 1)` so as to light the point `from` well.
    fn sample(&self, from: Vec3A, u: [f32; 2]) -> Surface;

    /// The density, per solid angle seen from `from`, with which [`sample`](Self::sample) draws the point of
    /// `surface`: positive, and [`f32::MAX`] at most, which stands for a point seen edge-on.
    fn density(&self, from: Vec3A, surface: &Surface) -> f32;

    /// What [`sample`](Self::sample) draws, with its [`density`](Self::density): in one go, where both need the same.
    #[inline]
    fn sample_with_density(&self, from: Vec3A, u: [f32; 2]) -> (Surface, f32) {
        let surface = self.sample(from, u);
        let density = self.density(from, &surface);
        (surface, density)
    }
}

/// Any of the shapes of this module: all that a scene can be made of.
///
/// It is closed for now: a [`Shape`] of your own can be intersected and drawn from, but is no part of a
/// [`Scene`](super::Scene), whose sweep and tree know these alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Primitive {
    /// A triangle or a parallelogram.
    Flat(Flat),
    /// A sphere.
    Sphere(Sphere),
    /// A disk or an ellipse.
    Disk(Disk),
    /// The side of a cylinder.
    Cylinder(Cylinder),
}

impl From<Flat> for Primitive {
    fn from(flat: Flat) -> Self {
        Self::Flat(flat)
    }
}

impl From<Sphere> for Primitive {
    fn from(sphere: Sphere) -> Self {
        Self::Sphere(sphere)
    }
}

impl From<Disk> for Primitive {
    fn from(disk: Disk) -> Self {
        Self::Disk(disk)
    }
}

impl From<Cylinder> for Primitive {
    fn from(cylinder: Cylinder) -> Self {
        Self::Cylinder(cylinder)
    }
}

impl Shape for Primitive {
    fn bounds(&self) -> [Vec3A; 2] {
        match self {
            Self::Flat(flat) => flat.bounds(),
            Self::Sphere(sphere) => sphere.bounds(),
            Self::Disk(disk) => disk.bounds(),
            Self::Cylinder(cylinder) => cylinder.bounds(),
        }
    }

    #[inline]
    fn intersect(&self, ray: &Ray, limit: f32) -> Option<f32> {
        match self {
            Self::Flat(flat) => flat.intersect(ray, limit),
            Self::Sphere(sphere) => sphere.intersect(ray, limit),
            Self::Disk(disk) => disk.intersect(ray, limit),
            Self::Cylinder(cylinder) => cylinder.intersect(ray, limit),
        }
    }

    #[inline]
    fn surface(&self, ray: &Ray, distance: f32) -> Surface {
        match self {
            Self::Flat(flat) => flat.surface(ray, distance),
            Self::Sphere(sphere) => sphere.surface(ray, distance),
            Self::Disk(disk) => disk.surface(ray, distance),
            Self::Cylinder(cylinder) => cylinder.surface(ray, distance),
        }
    }

    fn shading(&self, surface: &Surface) -> Shading {
        match self {
            Self::Flat(flat) => flat.shading(surface),
            Self::Sphere(sphere) => sphere.shading(surface),
            Self::Disk(disk) => disk.shading(surface),
            Self::Cylinder(cylinder) => cylinder.shading(surface),
        }
    }

    fn area(&self) -> f32 {
        match self {
            Self::Flat(flat) => flat.area(),
            Self::Sphere(sphere) => sphere.area(),
            Self::Disk(disk) => disk.area(),
            Self::Cylinder(cylinder) => cylinder.area(),
        }
    }

    #[inline]
    fn sample(&self, from: Vec3A, u: [f32; 2]) -> Surface {
        match self {
            Self::Flat(flat) => flat.sample(from, u),
            Self::Sphere(sphere) => sphere.sample(from, u),
            Self::Disk(disk) => disk.sample(from, u),
            Self::Cylinder(cylinder) => cylinder.sample(from, u),
        }
    }

    #[inline]
    fn sample_with_density(&self, from: Vec3A, u: [f32; 2]) -> (Surface, f32) {
        match self {
            Self::Flat(flat) => flat.sample_with_density(from, u),
            Self::Sphere(sphere) => sphere.sample_with_density(from, u),
            Self::Disk(disk) => disk.sample_with_density(from, u),
            Self::Cylinder(cylinder) => cylinder.sample_with_density(from, u),
        }
    }

    #[inline]
    fn density(&self, from: Vec3A, surface: &Surface) -> f32 {
        match self {
            Self::Flat(flat) => flat.density(from, surface),
            Self::Sphere(sphere) => sphere.density(from, surface),
            Self::Disk(disk) => disk.density(from, surface),
            Self::Cylinder(cylinder) => cylinder.density(from, surface),
        }
    }
}

/// The density per solid angle, seen from `from`, of a point drawn uniformly from `area`: the area measure times
/// the squared distance, over the cosine.
#[inline]
fn density_of_area(from: Vec3A, surface: &Surface, area: f32) -> f32 {
    let offset = surface.point - from;
    let squared = offset.length_squared();
    let density = squared * squared.sqrt() / (surface.normal.dot(offset).abs() * area);
    // Also where it is NaN, as it is for a point seen from itself.
    density.min(f32::MAX)
}
