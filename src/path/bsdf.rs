//! How surfaces scatter light: one law a file.
//!
//! | law | light goes | coordinates per direction, in order |
//! |---|---|---|
//! | [`Lambertian`], [`Diffuse`] | everywhere on the side it came from | 2 |
//! | [`Mirror`], [`Conductor`] | one way | 0 |
//! | [`RoughConductor`] | around one way | 2 |
//! | [`Dielectric`], [`ThinDielectric`] | one of two ways | 1 |
//! | [`RoughDielectric`] | around one of two ways | 2, 1 |
//! | [`Plastic`] | one way, or everywhere | 1, then 2 if it is everywhere |
//! | [`RoughPlastic`] | around one way, and everywhere | 1, 2 |
//! | [`Null`] | straight on | 0 |
//! | [`TwoSided`], [`BumpMap`], [`NormalMap`] | as another law has it | as the other law |
//! | [`Mask`] | straight on, or as another law has it | 1, then as the other law |
//! | [`Blend`] | as one of two laws has it | 1, then as the one |
//! | [`Material`] | as any of them | as they do |
//!
//! # Writing your own
//!
//! Implement [`Law`], in the frame of the surface, and render it with [`Framed`]; or, where that is slower than need be,
//! [`Bsdf`]. A scene has one type of them: an enum of its own, as [`Material`] is, where it mixes several.

mod blend;
mod bump_map;
mod conductor;
mod dielectric;
mod diffuse;
mod fresnel;
mod lambertian;
mod law;
mod mask;
mod material;
mod microfacets;
mod mirror;
mod normal_map;
mod null;
mod plastic;
mod relief;
mod rough_conductor;
mod rough_dielectric;
mod rough_plastic;
mod thin_dielectric;
mod two_sided;

use glam::Vec3A;

use super::{Detail, Surface};
use crate::Sampler;

pub use blend::Blend;
pub use bump_map::BumpMap;
pub use conductor::Conductor;
pub use dielectric::{Dielectric, Tint};
pub use diffuse::Diffuse;
pub use lambertian::Lambertian;
pub use law::{Framed, Law};
pub use mask::Mask;
pub use material::Material;
pub use microfacets::{Distribution, Roughness};
pub use mirror::Mirror;
pub use normal_map::NormalMap;
pub use null::Null;
pub use plastic::{Plastic, Saturation};
pub use relief::Relief;
pub use rough_conductor::RoughConductor;
pub use rough_dielectric::RoughDielectric;
pub use rough_plastic::RoughPlastic;
pub use thin_dielectric::ThinDielectric;
pub use two_sided::TwoSided;

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

    /// The law as [`Lambertian`], if it is that: where many paths are traced at once, other laws are asked one by one. It scatters
    /// by the interpolated normal if and only if its [`Detail`](Self::Detail) is [`Shading`](super::Shading). `None` unless
    /// implemented.
    fn as_lambertian(&self) -> Option<&Lambertian> {
        None
    }

    /// Whether it is [`Lambertian`] wherever the surface is hit, the same everywhere or not: then [`lambertian_at`](Self::lambertian_at) tells
    /// which, at every point, and where many paths are traced at once the law is asked for that alone. So [`evaluate`](Self::evaluate) and
    /// [`sample`](Self::sample) must do what that does, by the normal that [`as_lambertian`](Self::as_lambertian) says.
    fn is_lambertian(&self) -> bool {
        self.as_lambertian().is_some()
    }

    /// What it is at a point, if it [is](Self::is_lambertian) [`Lambertian`] everywhere.
    fn lambertian_at(&self, at: &Surface<Self::Detail>) -> Option<Lambertian> {
        let _ = at;
        self.as_lambertian().copied()
    }

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

impl Scattered {
    /// Whether light passes as if there were no surface, of the given true normal, that is seen from the direction `out`: through a hole, or through
    /// thin glass. What is mirrored at a grazing angle is nearly as straight, but stays on its side.
    #[inline]
    pub(in crate::path) fn passes(&self, normal: Vec3A, out: Vec3A) -> bool {
        self.density == f32::INFINITY
            && self.eta == 1.0
            && self.direction.dot(out) < -1.0 + 1e-6
            && (normal.dot(self.direction) < 0.0) != (normal.dot(out) < 0.0)
    }
}
