//! Smooth plastics.

use core::f32::consts::FRAC_1_PI;

use glam::Vec3A;

use super::fresnel::{self, refraction};
use super::law::mirrored;
use super::{Law, Scattered, Scattering};
use crate::path::frame::{cosine_density, cosine_hemisphere, single, singles};
use crate::path::texture::{self, Parameter, Uniform};
use crate::{Error, Sampler};

/// A diffuse base under a smooth transparent coat. Light is mirrored by the coat, or passes it, is scattered by the base,
/// perhaps back to it by the coat, and leaves. The inner side is black.
///
/// One coordinate chooses between mirror and base, with the probability of what both do to the light, then two draw
/// a direction if it is the base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plastic<P = Uniform> {
    eta: f32,
    coated: Coated<P>,
}

/// A diffuse base and the coat over it, apart from its shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Coated<P> {
    base: P,
    reflectance: P,
    /// How much diffuse light the coat reflects back to the base.
    internal: f32,
    /// The squared quotient of the indices of refraction, outside over inside.
    compression: f32,
    saturation: Saturation,
}

/// What the light that the coat sends back to the base does to its colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Saturation {
    /// It keeps its colour: every reflection but the first counts as white.
    #[default]
    Linear,
    /// It takes on the colour of the base with every reflection: darker and more saturated.
    Nonlinear,
}

impl<P: Parameter> Coated<P> {
    pub(super) fn new(base: P, eta: f32, internal: f32) -> Result<Self, Error> {
        Ok(Self {
            base: texture::fraction("diffuse reflectance", base)?,
            reflectance: Uniform::ONE.into(),
            internal,
            compression: (eta * eta).recip(),
            saturation: Saturation::default(),
        })
    }

    pub(super) fn tinted(mut self, reflectance: P) -> Result<Self, Error> {
        self.reflectance = texture::fraction("specular reflectance", reflectance)?;
        Ok(self)
    }

    pub(super) fn saturated(mut self, saturation: Saturation) -> Self {
        self.saturation = saturation;
        self
    }

    /// What is left of the light that the coat mirrors.
    #[inline]
    pub(super) fn mirrored(&self, place: &P::Place) -> Vec3A {
        self.reflectance.color(place)
    }

    /// The reflectance of the base for light that has passed the coat and is about to pass it again.
    #[inline]
    pub(super) fn diffuse(&self, place: &P::Place) -> Vec3A {
        let base = self.base.color(place);
        let again = match self.saturation {
            Saturation::Linear => Vec3A::splat(self.internal),
            Saturation::Nonlinear => base * self.internal,
        };
        base * self.compression / (1.0 - again)
    }

    /// The probability with which the mirror is chosen where it reflects the fraction `reflected`.
    pub(super) fn choice(&self, reflected: f32) -> f32 {
        let (mirror, base) = (self.reflectance.mean(), self.base.mean());
        let mirror = reflected * mirror;
        let base = (1.0 - reflected) * base;
        if mirror + base > 0.0 {
            mirror / (mirror + base)
        } else {
            0.0
        }
    }
}

impl<P: Parameter> Plastic<P> {
    /// The `base` that reflects a fraction of the light, in a medium with the index of refraction `inside`, while it
    /// is `outside` around it.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a component of the base outside `[0, 1]`, and for indices as
    /// [`Dielectric::new`](super::Dielectric::new).
    pub fn new(base: P, inside: f32, outside: f32) -> Result<Self, Error> {
        let eta = fresnel::quotient(inside, outside)?;
        let internal = fresnel::diffuse_reflectance(eta.recip());
        Ok(Self {
            eta,
            coated: Coated::new(base, eta, internal)?,
        })
    }

    /// The same, mirroring only the fraction `reflectance` of what physics says.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a component outside `[0, 1]`.
    pub fn tinted(mut self, reflectance: P) -> Result<Self, Error> {
        self.coated = self.coated.tinted(reflectance)?;
        Ok(self)
    }

    /// The same, with another rule for the light between base and coat.
    pub fn saturated(mut self, saturation: Saturation) -> Self {
        self.coated = self.coated.saturated(saturation);
        self
    }

    #[inline]
    fn reflected(&self, cosine: f32) -> f32 {
        refraction(cosine, self.eta).reflected
    }
}

impl<P: Parameter> Law for Plastic<P> {
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
        let [here, there] = [out, into].map(|v| self.reflected(v.z));
        let passed = (1.0 - here) * (1.0 - there);
        Scattering {
            value: self.coated.diffuse(place) * (FRAC_1_PI * into.z * passed),
            density: (1.0 - self.coated.choice(here)) * cosine_density(into.z),
        }
    }

    #[inline]
    fn sample<S: Sampler>(&self, place: &P::Place, out: Vec3A, u: &mut S) -> Option<Scattered> {
        let choice = single(u.next_1d());
        if !(out.z > 0.0) {
            return None;
        }
        let reflected = self.reflected(out.z);
        let mirror = self.coated.choice(reflected);
        if choice < mirror {
            let weight = self.coated.mirrored(place) * (reflected / mirror);
            return Some(Scattered::single(mirrored(out), weight));
        }
        let direction = cosine_hemisphere(singles(u.next_2d()));
        if !(direction.z > 0.0) {
            return None;
        }
        let passed = (1.0 - reflected) * (1.0 - self.reflected(direction.z));
        Some(Scattered {
            direction,
            weight: self.coated.diffuse(place) * (passed / (1.0 - mirror)),
            density: (1.0 - mirror) * cosine_density(direction.z),
            eta: 1.0,
        })
    }
}
