//! Smooth boundaries between transparent media.

use glam::Vec3A;

use super::fresnel::{self, refraction};
use super::mirror::reflect;
use super::{Bsdf, Law, Scattered, Scattering};
use crate::path::Surface;
use crate::path::frame::single;
use crate::path::texture::{self, Parameter, Uniform};
use crate::{Error, Sampler};

/// A smooth boundary between two transparent media, as that of a glass ball is.
///
/// One coordinate chooses reflection, with the probability that Fresnel's formula gives for unpolarised
/// light, or refraction. Radiance that is refracted scales with the square of the index of refraction:
/// it leaves the denser medium `eta^2` times weaker than it is inside.[^veach]
///
/// [^veach]: Veach, Eric (1997). *Robust Monte Carlo Methods for Light Transport Simulation*, section 5.2.
///     <https://graphics.stanford.edu/papers/veach_thesis/>
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dielectric<P = Uniform> {
    eta: f32,
    tint: Tint<P>,
}

/// What is left of the light that a transparent boundary reflects and of that which it lets through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tint<P> {
    reflectance: P,
    transmittance: P,
}

impl<P: Parameter> Tint<P> {
    /// The fractions of red, green and blue: 1 for what physics says.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a component outside `[0, 1]`.
    pub fn new(reflectance: P, transmittance: P) -> Result<Self, Error> {
        Ok(Self {
            reflectance: texture::fraction("specular reflectance", reflectance)?,
            transmittance: texture::fraction("specular transmittance", transmittance)?,
        })
    }

    /// Of the light that is reflected.
    #[inline]
    pub(super) fn reflected(&self, place: &P::Place) -> Vec3A {
        self.reflectance.color(place)
    }

    /// Of the light that is let through.
    #[inline]
    pub(super) fn transmitted(&self, place: &P::Place) -> Vec3A {
        self.transmittance.color(place)
    }
}

impl<P: Parameter> Default for Tint<P> {
    fn default() -> Self {
        Self {
            reflectance: Uniform::ONE.into(),
            transmittance: Uniform::ONE.into(),
        }
    }
}

impl Dielectric {
    /// The boundary with the index of refraction `inside`, on the inner side, and `outside`.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for an index that is not positive and finite, and for two so far apart that the square of
    /// their quotient, or of its inverse, is none of `f32`.
    pub fn new(inside: f32, outside: f32) -> Result<Self, Error> {
        Ok(Self {
            eta: fresnel::quotient(inside, outside)?,
            tint: Tint::default(),
        })
    }
}

impl<P: Parameter> Dielectric<P> {
    /// The same, with some of the light left out.
    pub fn tinted<Q: Parameter>(self, tint: Tint<Q>) -> Dielectric<Q> {
        Dielectric {
            eta: self.eta,
            tint,
        }
    }

    /// A direction around any normal.
    #[inline]
    pub(super) fn scatter<S: Sampler>(
        &self,
        place: &P::Place,
        normal: Vec3A,
        out: Vec3A,
        u: &mut S,
    ) -> Option<Scattered> {
        let cosine = normal.dot(out);
        let side = 1.0_f32.copysign(cosine);
        let eta = if cosine > 0.0 {
            self.eta
        } else {
            self.eta.recip()
        };
        let cosine = cosine.abs().min(1.0);
        let refraction = refraction(cosine, eta);
        if single(u.next_1d()) < refraction.reflected {
            let weight = self.tint.reflected(place);
            return Some(Scattered::single(reflect(normal, out), weight));
        }
        let direction = normal * (side * (cosine / eta - refraction.cosine)) - out / eta;
        Some(Scattered {
            eta,
            ..Scattered::single(
                direction.normalize(),
                self.tint.transmitted(place) / (eta * eta),
            )
        })
    }
}

impl<P: Parameter> Law for Dielectric<P> {
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
    fn sample<S: Sampler>(&self, place: &P::Place, out: Vec3A, u: &mut S) -> Option<Scattered> {
        self.scatter(place, Vec3A::Z, out, u)
    }
}

impl<P: Parameter<Place = ()>> Bsdf for Dielectric<P> {
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
    fn sample<S: Sampler>(&self, at: &Surface, out: Vec3A, u: &mut S) -> Option<Scattered> {
        self.scatter(&(), at.normal, out, u)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_too_far_apart_are_refused() {
        for (inside, outside) in [
            (f32::MAX, f32::MIN_POSITIVE),
            (f32::MIN_POSITIVE, f32::MAX),
            (1e20, 1.0),
            (1.0, 1e20),
            (1e-20, 1.0),
            (0.0, 1.0),
            (1.0, f32::NAN),
        ] {
            assert!(
                Dielectric::new(inside, outside).is_err(),
                "{inside} in {outside}"
            );
        }
        assert!(Dielectric::new(4.0, 1.0).is_ok());
    }

    #[test]
    fn refraction_obeys_snells_law_both_ways() {
        struct Last;
        impl Sampler for Last {
            fn next_1d(&mut self) -> f64 {
                1.0 - f64::EPSILON
            }
        }
        let glass = Dielectric::new(1.5, 1.0).unwrap();
        for normal in [Vec3A::Z, Vec3A::NEG_Z, Vec3A::new(0.6, 0.0, 0.8)] {
            let out = Vec3A::new(0.28, 0.0, 0.96);
            let there = glass.scatter(&(), normal, out, &mut Last).unwrap();
            let sines = [out, there.direction].map(|v| normal.cross(v).length());
            assert!((sines[0] - there.eta * sines[1]).abs() < 1e-6);
            assert!(normal.dot(out) * normal.dot(there.direction) < 0.0);
            // The way back is the same way.
            let back = glass.scatter(&(), normal, there.direction, &mut Last);
            let back = back.unwrap();
            assert!((back.direction - out).length() < 1e-6);
            assert!((back.weight * there.weight - Vec3A::ONE).length() < 1e-6);
        }
    }
}
