//! Ideally diffuse reflection on one side.

use core::f32::consts::FRAC_1_PI;

use glam::Vec3A;

use super::{Lambertian, Law, Scattered, Scattering};
use crate::path::frame::{cosine_density, cosine_hemisphere, singles};
use crate::path::texture::{self, Parameter, Uniform};
use crate::{Error, Sampler};

/// Ideally diffuse reflection on the outer side: the function is `reflectance / pi`. The inner side is black; see
/// [`TwoSided`](super::TwoSided), and [`Lambertian`](super::Lambertian) where the reflectance is the same everywhere.
///
/// Two coordinates draw a direction, with the density `cosine / pi`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Diffuse<P = Uniform> {
    reflectance: P,
}

impl<P: Parameter> Diffuse<P> {
    /// The surface that reflects the fraction `reflectance`.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a component outside `[0, 1]`.
    pub fn new(reflectance: P) -> Result<Self, Error> {
        Ok(Self {
            reflectance: texture::fraction("reflectance", reflectance)?,
        })
    }

    /// What it is at a place.
    #[inline]
    pub(super) fn lambertian(&self, place: &P::Place) -> Lambertian {
        Lambertian::known(self.reflectance.color(place)).outside()
    }
}

impl<P: Parameter> Law for Diffuse<P> {
    type Place = P::Place;

    #[inline]
    fn is_delta(&self) -> bool {
        false
    }

    #[inline]
    fn evaluate(&self, place: &P::Place, out: Vec3A, into: Vec3A) -> Scattering {
        if !(out.z > 0.0 && into.z > 0.0) {
            return Scattering::NONE;
        }
        Scattering {
            value: self.reflectance.color(place) * (FRAC_1_PI * into.z),
            density: cosine_density(into.z),
        }
    }

    #[inline]
    fn sample<S: Sampler>(&self, place: &P::Place, out: Vec3A, u: &mut S) -> Option<Scattered> {
        let direction = cosine_hemisphere(singles(u.next_2d()));
        (out.z > 0.0 && direction.z > 0.0).then(|| Scattered {
            direction,
            weight: self.reflectance.color(place),
            density: cosine_density(direction.z),
            eta: 1.0,
        })
    }
}
