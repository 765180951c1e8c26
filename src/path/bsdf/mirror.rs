//! Ideal mirrors.

use glam::Vec3A;

use super::law::mirrored;
use super::{Bsdf, Law, Scattered, Scattering};
use crate::path::{Surface, color};
use crate::{Error, Sampler};

/// An ideal mirror on the outer side; the inner side is black, as that of a conductor is.
///
/// Draws no coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mirror {
    reflectance: Vec3A,
}

impl Mirror {
    /// The mirror that reflects the fraction `reflectance` of red, green and blue, at every angle.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a component outside `[0, 1]`.
    pub fn new(reflectance: [f32; 3]) -> Result<Self, Error> {
        Ok(Self {
            reflectance: color::fraction("reflectance", reflectance)?,
        })
    }
}

/// `out` mirrored in the normal.
#[inline]
pub(super) fn reflect(normal: Vec3A, out: Vec3A) -> Vec3A {
    (normal * (2.0 * normal.dot(out)) - out).normalize()
}

impl Law for Mirror {
    type Place = ();

    #[inline]
    fn is_delta(&self) -> bool {
        true
    }

    #[inline]
    fn evaluate(&self, (): &(), _: Vec3A, _: Vec3A) -> Scattering {
        Scattering::NONE
    }

    #[inline]
    fn sample<S: Sampler>(&self, (): &(), out: Vec3A, _: &mut S) -> Option<Scattered> {
        (out.z > 0.0).then(|| Scattered::single(mirrored(out), self.reflectance))
    }
}

impl Bsdf for Mirror {
    type Detail = ();

    #[inline]
    fn is_delta(&self) -> bool {
        true
    }

    #[inline]
    fn evaluate(&self, _: &Surface, _: Vec3A, _: Vec3A) -> Scattering {
        Scattering::NONE
    }

    #[inline]
    fn sample<S: Sampler>(&self, at: &Surface, out: Vec3A, _: &mut S) -> Option<Scattered> {
        (at.normal.dot(out) > 0.0)
            .then(|| Scattered::single(reflect(at.normal, out), self.reflectance))
    }
}
