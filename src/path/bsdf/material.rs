//! Scenes of several laws of scattering.

use glam::Vec3A;

use super::{Bsdf, Dielectric, Lambertian, Mirror, Scattered, Scattering};
use crate::Sampler;
use crate::path::Surface;

/// Any of the laws of this module, for scenes that mix them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Material {
    /// Ideally diffuse.
    Lambertian(Lambertian),
    /// An ideal mirror.
    Mirror(Mirror),
    /// A smooth boundary between transparent media.
    Dielectric(Dielectric),
}

impl From<Lambertian> for Material {
    fn from(law: Lambertian) -> Self {
        Self::Lambertian(law)
    }
}

impl From<Mirror> for Material {
    fn from(law: Mirror) -> Self {
        Self::Mirror(law)
    }
}

impl From<Dielectric> for Material {
    fn from(law: Dielectric) -> Self {
        Self::Dielectric(law)
    }
}

impl Bsdf for Material {
    type Detail = ();

    #[inline]
    fn is_delta(&self) -> bool {
        match self {
            Self::Lambertian(law) => law.is_delta(),
            Self::Mirror(law) => law.is_delta(),
            Self::Dielectric(law) => law.is_delta(),
        }
    }

    #[inline]
    fn evaluate(&self, at: &Surface, out: Vec3A, into: Vec3A) -> Scattering {
        match self {
            Self::Lambertian(law) => law.evaluate(at, out, into),
            Self::Mirror(law) => law.evaluate(at, out, into),
            Self::Dielectric(law) => law.evaluate(at, out, into),
        }
    }

    #[inline]
    fn sample<S: Sampler>(&self, at: &Surface, out: Vec3A, u: &mut S) -> Option<Scattered> {
        match self {
            Self::Lambertian(law) => law.sample(at, out, u),
            Self::Mirror(law) => law.sample(at, out, u),
            Self::Dielectric(law) => law.sample(at, out, u),
        }
    }
}
