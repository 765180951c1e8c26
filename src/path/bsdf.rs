//! How surfaces scatter light: one law a file.
//!
//! | law | light goes | coordinates per direction |
//! |---|---|---|
//! | [`Lambertian`] | everywhere on the side it came from | 2 |
//! | [`Mirror`] | one way | 0 |
//! | [`Dielectric`] | one of two ways | 1 |
//! | [`Material`] | as any of them | as they do |
//!
//! # Writing your own
//!
//! Implement [`Bsdf`]. A scene has one type of them: an enum of its own, as [`Material`] is, where it mixes
//! several.

mod dielectric;
mod lambertian;
mod material;
mod mirror;

use glam::Vec3A;

use super::{Detail, Surface};
use crate::Sampler;

pub use dielectric::Dielectric;
pub use lambertian::Lambertian;
pub use material::Material;
pub use mirror::Mirror;

/// A bidirectional scattering distribution function.
///
/// All directions have length 1 and point away from the surface: `out` to where the light is seen from, `into` to
/// where it comes from. The normals are those of the outer side.
pub trait Bsdf: Sync {
    /// What the law needs to know of a surface beyond point and normal: `()`, or [`Shading`](super::Shading) if it
    /// looks up textures or heeds interpolated normals. What no law of a scene needs is not computed.
    type Detail: Detail;

    /// Whether light is scattered to single directions only, wherever the surface is hit, so that
    /// [`evaluate`](Self::evaluate) is zero and no light is worth sampling.
    fn is_delta(&self) -> bool;

    /// The value for a pair of directions, times the cosine of `into`, and the density with which
    /// [`sample`](Self::sample) draws `into`. Single directions do not count.
    fn evaluate(&self, at: &Surface<Self::Detail>, out: Vec3A, into: Vec3A) -> Scattering;

    /// A direction, drawn from the coordinates of `u`; `None` where nothing is scattered.
    fn sample<S: Sampler>(
        &self,
        at: &Surface<Self::Detail>,
        out: Vec3A,
        u: &mut S,
    ) -> Option<Scattered>;
}

/// What a [`Bsdf`] does for a pair of directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scattering {
    /// The function times the cosine between the normal and the direction that light comes from.
    pub value: Vec3A,
    /// The density, per solid angle, with which that direction is drawn.
    pub density: f32,
}

impl Scattering {
    /// Nothing is scattered.
    pub const NONE: Self = Self {
        value: Vec3A::ZERO,
        density: 0.0,
    };
}

/// A direction drawn by a [`Bsdf`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scattered {
    /// Where the light comes from; of length 1.
    pub direction: Vec3A,
    /// The function times the cosine over the density.
    pub weight: Vec3A,
    /// The density per solid angle; infinite for a single direction.
    pub density: f32,
    /// The index of refraction on the side of `direction` over that on the side light is seen from; 1 unless
    /// it is refracted.
    pub eta: f32,
}
