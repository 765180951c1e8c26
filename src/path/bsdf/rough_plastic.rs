//! Rough plastics.

use core::f32::consts::FRAC_1_PI;

use glam::Vec3A;

use super::fresnel::{self, refraction};
use super::microfacets::Microfacets;
use super::plastic::Coated;
use super::{Distribution, Law, Saturation, Scattered, Scattering};
use crate::path::frame::{cosine_density, cosine_hemisphere, single, singles};
use crate::path::texture::{Parameter, Uniform};
use crate::{Error, Sampler};

mod coat;

use coat::Coat;

/// A diffuse base under a rough transparent coat: as [`Plastic`](super::Plastic), with facets in the place of the
/// mirror. The inner side is black.
///
/// One coordinate chooses between coat and base, with the probability of what both do to the light, then two draw
/// a facet among those that are seen, or a direction.
///
/// How much of the light passes the coat is tabulated for 64 cosines, and interpolated linearly, when the law is made,
/// which takes a few hundredths of a second.
#[derive(Clone, Debug, PartialEq)]
pub struct RoughPlastic<P = Uniform> {
    eta: f32,
    facets: Microfacets,
    coat: Coat,
    coated: Coated<P>,
}

impl<P: Parameter> RoughPlastic<P> {
    /// The `base` that reflects a fraction of the light, in a medium with the index of refraction `inside`, while it
    /// is `outside` around it; `alpha` is the roughness, less than 1e-4 is taken as that.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a component of the base outside `[0, 1]`, for indices as
    /// [`Dielectric::new`](super::Dielectric::new), and for a roughness that is negative or not finite.
    pub fn new(
        base: P,
        inside: f32,
        outside: f32,
        distribution: Distribution,
        alpha: f32,
    ) -> Result<Self, Error> {
        if !(alpha >= 0.0 && alpha.is_finite()) {
            let domain = "finite and not negative";
            return Err(Error::refused("roughness", domain, alpha));
        }
        let eta = fresnel::quotient(inside, outside)?;
        let facets = Microfacets::new(distribution, [alpha; 2]);
        let coat = Coat::new(&facets, eta)?;
        Ok(Self {
            eta,
            facets,
            coated: Coated::new(base, eta, coat.internal())?,
            coat,
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
}

impl<P: Parameter> Law for RoughPlastic<P> {
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
        let m = (out + into).normalize();
        let reflected = refraction(out.dot(m), self.eta).reflected;
        let facet = self.facets.area(m) / (4.0 * self.facets.seen(out));
        let mirror = facet * reflected * self.facets.unmasked(into, m);
        let [here, there] = [out, into].map(|v| self.coat.passed(v.z));
        let choice = self.coated.choice(1.0 - here);
        let base = FRAC_1_PI * into.z * here * there;
        Scattering {
            value: self.coated.mirrored(place) * mirror + self.coated.diffuse(place) * base,
            density: choice * facet + (1.0 - choice) * cosine_density(into.z),
        }
    }

    #[inline]
    fn sample<S: Sampler>(&self, place: &P::Place, out: Vec3A, u: &mut S) -> Option<Scattered> {
        let lobe = single(u.next_1d());
        let u = singles(u.next_2d());
        if !(out.z > 0.0) {
            return None;
        }
        let direction = if lobe < self.coated.choice(1.0 - self.coat.passed(out.z)) {
            let m = self.facets.sample(out, u);
            (m * (2.0 * out.dot(m)) - out).normalize()
        } else {
            cosine_hemisphere(u)
        };
        let Scattering { value, density } = self.evaluate(place, out, direction);
        (density > 0.0).then(|| Scattered {
            direction,
            weight: value / density,
            density,
            eta: 1.0,
        })
    }
}
