//! Ideally diffuse reflection.

use core::f32::consts::FRAC_1_PI;

use glam::Vec3A;

use super::{Bsdf, Law, Scattered, Scattering};
use crate::path::frame::{Frame, cosine_density, cosine_hemisphere, singles};
use crate::path::{Surface, color};
use crate::{Error, Sampler};

/// Ideally diffuse reflection on both sides, or on the [outer](Self::outside) one: the function is `albedo / pi` where both directions are on the same
/// side.
///
/// Two coordinates draw a direction, with the density `cosine / pi`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lambertian {
    pub(in crate::path) albedo: Vec3A,
    sides: Sides,
}

impl Lambertian {
    /// The surface that reflects the fraction `albedo` of red, green and blue.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a component outside `[0, 1]`.
    pub fn new(albedo: [f32; 3]) -> Result<Self, Error> {
        Ok(Self {
            albedo: color::fraction("albedo", albedo)?,
            sides: Sides::Both,
        })
    }

    /// That of an albedo which is known to be in range.
    #[inline]
    pub(super) fn known(albedo: Vec3A) -> Self {
        Self {
            albedo,
            sides: Sides::Both,
        }
    }

    /// The same on both sides.
    #[inline]
    pub(super) fn both(mut self) -> Self {
        self.sides = Sides::Both;
        self
    }

    /// The same on the outer side alone. The inner side is black.
    #[must_use]
    pub fn outside(mut self) -> Self {
        self.sides = Sides::Outer;
        self
    }

    /// Whether the inner side scatters as the outer one does.
    #[cfg(feature = "simd")]
    pub(in crate::path) fn has_inside(&self) -> bool {
        self.sides == Sides::Both
    }

    /// Whether light is scattered towards `out`, given its cosine.
    #[inline]
    pub(in crate::path) fn is_seen(&self, cosine: f32) -> bool {
        self.sides == Sides::Both || cosine > 0.0
    }
}

/// Which sides scatter light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sides {
    Both,
    Outer,
}

impl Lambertian {
    /// For two directions on one side.
    #[inline]
    fn reflected(&self, cosine: f32) -> Scattering {
        Scattering {
            value: self.albedo * (FRAC_1_PI * cosine),
            density: cosine_density(cosine),
        }
    }

    /// A direction on the side of the third axis.
    #[inline]
    fn draw<S: Sampler>(&self, u: &mut S) -> Option<Scattered> {
        let direction = cosine_hemisphere(singles(u.next_2d()));
        (direction.z > 0.0).then(|| Scattered {
            direction,
            weight: self.albedo,
            density: cosine_density(direction.z),
            eta: 1.0,
        })
    }
}

impl Law for Lambertian {
    type Place = ();

    #[inline]
    fn is_delta(&self) -> bool {
        false
    }

    #[inline]
    fn evaluate(&self, (): &(), out: Vec3A, into: Vec3A) -> Scattering {
        if out.z * into.z <= 0.0 || !self.is_seen(out.z) {
            return Scattering::NONE;
        }
        self.reflected(into.z.abs())
    }

    #[inline]
    fn sample<S: Sampler>(&self, (): &(), out: Vec3A, u: &mut S) -> Option<Scattered> {
        let scattered = self.draw(u).filter(|_| self.is_seen(out.z))?;
        let mut direction = scattered.direction;
        direction.z = direction.z.copysign(out.z);
        Some(Scattered {
            direction,
            ..scattered
        })
    }
}

impl Bsdf for Lambertian {
    type Detail = ();

    fn as_lambertian(&self) -> Option<&Self> {
        Some(self)
    }

    #[inline]
    fn is_delta(&self) -> bool {
        false
    }

    #[inline]
    fn evaluate(&self, at: &Surface, out: Vec3A, into: Vec3A) -> Scattering {
        let cosine = at.normal.dot(into);
        let facing = at.normal.dot(out);
        if cosine * facing <= 0.0 || !self.is_seen(facing) {
            return Scattering::NONE;
        }
        self.reflected(cosine.abs())
    }

    #[inline]
    fn sample<S: Sampler>(&self, at: &Surface, out: Vec3A, u: &mut S) -> Option<Scattered> {
        let facing = at.normal.dot(out);
        let scattered = self.draw(u).filter(|_| self.is_seen(facing))?;
        let normal = at.normal * 1.0_f32.copysign(facing);
        Some(Scattered {
            direction: Frame::around(normal).out(scattered.direction),
            ..scattered
        })
    }
}
