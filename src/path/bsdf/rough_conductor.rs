//! Rough metals.

use glam::Vec3A;

use super::{Conductor, Law, Roughness, Scattered, Scattering};
use crate::Sampler;
use crate::path::frame::singles;
use crate::path::texture::{Parameter, Uniform};

/// A rough metal: facets that are mirrors, of which those that others hide do not shine.[^cook] The inner side is black.
///
/// Two coordinates draw a facet among those that are seen.[^visible] Light that would be reflected more than once among
/// the facets is lost.
///
/// [^cook]: Cook, Robert; Torrance, Kenneth (1982). *A Reflectance Model for Computer Graphics*.
///     <https://doi.org/10.1145/357290.357293>
/// [^visible]: Heitz, Eric; d'Eon, Eugene (2014). *Importance Sampling Microfacet-Based BSDFs using the Distribution of
///     Visible Normals*. <https://doi.org/10.1111/cgf.12417>
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughConductor<P = Uniform> {
    metal: Conductor<P>,
    roughness: Roughness<P>,
}

impl<P: Parameter> RoughConductor<P> {
    /// The `metal` with a rough surface.
    ///
    /// ```
    /// use estimand::path::bsdf::{Conductor, Distribution, RoughConductor, Roughness};
    /// use estimand::path::texture::Uniform;
    ///
    /// let eta = Uniform::from([0.2, 0.92, 1.1]);
    /// let k = Uniform::from([3.91, 2.45, 2.14]);
    /// let roughness = Roughness::new(Distribution::Ggx, Uniform::from(0.2))?;
    /// let copper = RoughConductor::new(Conductor::new(eta, k)?, roughness);
    /// # Ok::<(), estimand::Error>(())
    /// ```
    pub fn new(metal: Conductor<P>, roughness: Roughness<P>) -> Self {
        Self { metal, roughness }
    }
}

impl<P: Parameter> Law for RoughConductor<P> {
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
        let facets = self.roughness.at(place);
        let m = (out + into).normalize();
        let density = facets.area(m) / (4.0 * facets.seen(out));
        let weight = facets.unmasked(into, m) * self.metal.reflected(place, out.dot(m));
        Scattering {
            value: weight * density,
            density,
        }
    }

    #[inline]
    fn sample<S: Sampler>(&self, place: &P::Place, out: Vec3A, u: &mut S) -> Option<Scattered> {
        let u = singles(u.next_2d());
        if !(out.z > 0.0) {
            return None;
        }
        let facets = self.roughness.at(place);
        let m = facets.sample(out, u);
        let cosine = out.dot(m);
        let direction = (m * (2.0 * cosine) - out).normalize();
        let density = facets.area(m) / (4.0 * facets.seen(out));
        (direction.z > 0.0 && cosine > 0.0 && density > 0.0).then(|| Scattered {
            direction,
            weight: facets.unmasked(direction, m) * self.metal.reflected(place, cosine),
            density,
            eta: 1.0,
        })
    }
}
