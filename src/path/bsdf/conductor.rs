//! Smooth metals.

use glam::Vec3A;

use super::law::mirrored;
use super::{Law, Scattered, Scattering, fresnel};
use crate::path::texture::{self, Parameter, Uniform};
use crate::{Error, Sampler};

/// A smooth metal: it reflects as a mirror does, as much as Fresnel's formulas for a complex index of refraction
/// say. The inner side is black.
///
/// Draws no coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conductor<P = Uniform> {
    eta: P,
    k: P,
    reflectance: P,
}

impl<P: Parameter> Conductor<P> {
    /// The metal with the index of refraction `eta + i k` for red, green and blue, relative to what is outside.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a component that is negative or not finite.
    pub fn new(eta: P, k: P) -> Result<Self, Error> {
        Ok(Self {
            eta: texture::finite("index of refraction", eta)?,
            k: texture::finite("coefficient of extinction", k)?,
            reflectance: Uniform::ONE.into(),
        })
    }

    /// The same, reflecting only the fraction `reflectance` of what a metal does.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a component outside `[0, 1]`.
    pub fn tinted(mut self, reflectance: P) -> Result<Self, Error> {
        self.reflectance = texture::fraction("specular reflectance", reflectance)?;
        Ok(self)
    }

    /// The fraction that a mirror of this metal reflects at `cosine`.
    #[inline]
    pub(super) fn reflected(&self, place: &P::Place, cosine: f32) -> Vec3A {
        let (eta, k) = (self.eta.color(place), self.k.color(place));
        self.reflectance.color(place) * fresnel::conductor(cosine, eta, k)
    }
}

impl<P: Parameter> Law for Conductor<P> {
    type Place = P::Place;

    #[inline]
    fn is_delta(&self) -> bool {
        true
    }

    #[inline]
    fn evaluate(&self, _: &P::Place, _: Vec3A, _: Vec3A) -> Scattering {
        Scattering::NONE
    }

    #[inline]
    fn sample<S: Sampler>(&self, place: &P::Place, out: Vec3A, _: &mut S) -> Option<Scattered> {
        (out.z > 0.0).then(|| Scattered::single(mirrored(out), self.reflected(place, out.z)))
    }
}
