//! Rough boundaries between transparent media.

use glam::Vec3A;

use super::fresnel::{self, refraction};
use super::law::other_side;
use super::microfacets::Microfacets;
use super::{Law, Roughness, Scattered, Scattering, Tint};
use crate::path::frame::{single, singles};
use crate::path::texture::{Parameter, Uniform};
use crate::{Error, Sampler};

/// A rough boundary between two transparent media, as that of frosted glass is: facets, each of which reflects and refracts
/// as a [`Dielectric`](super::Dielectric) does.[^walter]
///
/// Two coordinates draw a facet among those that are seen, then one chooses reflection or refraction.
///
/// Where the indices are so near to one another that rounded directions do not tell the facet that refracted them,
/// refracted light is taken to come from a single direction: light is not drawn for it, only met.
///
/// [^walter]: Walter, Bruce; et al. (2007). *Microfacet Models for Refraction through Rough Surfaces*.
///     <https://doi.org/10.2312/EGWR/EGSR07/195-206>
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughDielectric<P = Uniform> {
    eta: f32,
    roughness: Roughness<P>,
    tint: Tint<P>,
}

/// The least width of a lobe of refraction in which the facet is found again to about a hundredth of the
/// roughness.
const NARROWEST: f32 = 1e-5;

/// The boundary as it is seen from the side of `out`, which is taken to be the upper one.
struct Side {
    facets: Microfacets,
    /// The index of refraction on the other side over that on this one.
    eta: f32,
    /// Whether refracted light has a density.
    spread: bool,
}

impl<P: Parameter> RoughDielectric<P> {
    /// The boundary with the index of refraction `inside`, on the inner side, and `outside`.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] as for [`Dielectric::new`](super::Dielectric::new).
    pub fn new(inside: f32, outside: f32, roughness: Roughness<P>) -> Result<Self, Error> {
        Ok(Self {
            eta: fresnel::quotient(inside, outside)?,
            roughness,
            tint: Tint::default(),
        })
    }

    /// The same, with some of the light left out.
    pub fn tinted(mut self, tint: Tint<P>) -> Self {
        self.tint = tint;
        self
    }

    #[inline]
    fn side(&self, place: &P::Place, out: Vec3A) -> Side {
        let facets = self.roughness.at(place);
        Side {
            eta: if out.z > 0.0 {
                self.eta
            } else {
                self.eta.recip()
            },
            spread: facets.least() * (self.eta - 1.0).abs() >= NARROWEST,
            facets,
        }
    }
}

impl Side {
    /// The density of the refracted direction `into` over that of the facet `m`.
    #[inline]
    fn refracted_density(&self, out: Vec3A, into: Vec3A, m: Vec3A) -> f32 {
        let sum = out.dot(m) + self.eta * into.dot(m);
        self.eta * self.eta * into.dot(m).abs() / (sum * sum)
    }
}

impl<P: Parameter> Law for RoughDielectric<P> {
    type Place = P::Place;

    #[inline]
    fn is_delta(&self) -> bool {
        false
    }

    #[inline]
    fn evaluate(&self, place: &P::Place, out: Vec3A, into: Vec3A) -> Scattering {
        let side = self.side(place, out);
        let reflects = out.z * into.z > 0.0;
        if out.z == 0.0 || into.z == 0.0 || !(reflects || side.spread) {
            return Scattering::NONE;
        }
        let (out, into) = if out.z > 0.0 {
            (out, into)
        } else {
            (other_side(out), other_side(into))
        };
        let half = out + into * if reflects { 1.0 } else { side.eta };
        let m = half.normalize() * 1.0_f32.copysign(half.z);
        let cosine = out.dot(m);
        // A facet that is seen from one side of it and of the surface, or from different ones.
        if !(cosine > 0.0 && into.dot(m) * into.z > 0.0) {
            return Scattering::NONE;
        }
        let (facets, eta) = (side.facets, side.eta);
        let reflected = refraction(cosine, eta).reflected;
        let seen = facets.area(m) / facets.seen(out);
        let unmasked = facets.unmasked(into, m);
        let (density, weight) = if reflects {
            let weight = unmasked * self.tint.reflected(place);
            (0.25 * reflected * seen, weight)
        } else {
            let weight = unmasked / (eta * eta) * self.tint.transmitted(place);
            let density = cosine * side.refracted_density(out, into, m);
            ((1.0 - reflected) * seen * density, weight)
        };
        Scattering {
            value: weight * density,
            density,
        }
    }

    #[inline]
    fn sample<S: Sampler>(&self, place: &P::Place, out: Vec3A, u: &mut S) -> Option<Scattered> {
        let facet = singles(u.next_2d());
        let choice = single(u.next_1d());
        if out.z == 0.0 {
            return None;
        }
        let side = self.side(place, out);
        let lower = out.z < 0.0;
        let out = if lower { other_side(out) } else { out };
        let m = side.facets.sample(out, facet);
        let cosine = out.dot(m).min(1.0);
        if !(cosine > 0.0) {
            return None;
        }
        let (facets, eta) = (side.facets, side.eta);
        let refraction = refraction(cosine, eta);
        let seen = facets.area(m) / facets.seen(out);
        let reflects = choice < refraction.reflected;
        let direction = if reflects {
            m * (2.0 * cosine) - out
        } else {
            m * (cosine / eta - refraction.cosine) - out / eta
        }
        .normalize();
        let scattered = if reflects {
            Scattered {
                direction,
                weight: facets.unmasked(direction, m) * self.tint.reflected(place),
                density: 0.25 * refraction.reflected * seen,
                eta: 1.0,
            }
        } else {
            let weight = facets.unmasked(direction, m) / (eta * eta);
            let density = cosine * side.refracted_density(out, direction, m);
            Scattered {
                direction,
                weight: weight * self.tint.transmitted(place),
                density: if side.spread {
                    (1.0 - refraction.reflected) * seen * density
                } else {
                    f32::INFINITY
                },
                eta,
            }
        };
        // What is reflected downwards or refracted upwards hits another facet, and is lost.
        if (direction.z > 0.0) != reflects || !(scattered.density > 0.0) {
            return None;
        }
        Some(Scattered {
            direction: if lower {
                other_side(direction)
            } else {
                direction
            },
            ..scattered
        })
    }
}
