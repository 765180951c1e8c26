//! Rough surfaces: how the normals of their facets are distributed, and how much of the facets is seen.

use core::f32::consts::{FRAC_1_PI, PI};

use glam::Vec3A;

use crate::Error;
use crate::path::frame::turn;
use crate::path::texture::{self, Parameter};

mod beckmann;

/// How the normals of facets are distributed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Distribution {
    /// Slopes are normally distributed, with the variance `alpha^2 / 2`.[^beckmann]
    ///
    /// [^beckmann]: Beckmann, Petr; Spizzichino, André (1963). *The Scattering of Electromagnetic Waves from Rough
    ///     Surfaces*. Pergamon Press.
    #[default]
    Beckmann,
    /// Normals are those of an ellipsoid: long tails.[^walter]
    ///
    /// [^walter]: Walter, Bruce; et al. (2007). *Microfacet Models for Refraction through Rough Surfaces*.
    ///     <https://doi.org/10.2312/EGWR/EGSR07/195-206>
    Ggx,
}

/// The least roughness: less is taken as this.
pub(super) const SMOOTHEST: f32 = 1e-4;

/// How rough a surface is: the distribution of its facets, and the roughness `alpha` along both tangents.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roughness<P> {
    distribution: Distribution,
    along_u: P,
    /// None where it is the same.
    along_v: Option<P>,
}

impl<P: Parameter> Roughness<P> {
    /// The roughness `alpha` in all directions; less than 1e-4 is taken as that.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a roughness that is negative or not finite.
    pub fn new(distribution: Distribution, alpha: P) -> Result<Self, Error> {
        Ok(Self {
            distribution,
            along_u: texture::finite("roughness", alpha)?,
            along_v: None,
        })
    }

    /// The roughness along the directions in which the texture coordinates `u` and `v` grow; less than 1e-4 is
    /// taken as that.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a roughness that is negative or not finite.
    pub fn anisotropic(distribution: Distribution, along_u: P, along_v: P) -> Result<Self, Error> {
        Ok(Self {
            distribution,
            along_u: texture::finite("roughness along u", along_u)?,
            along_v: Some(texture::finite("roughness along v", along_v)?),
        })
    }

    /// The facets at a place.
    #[inline]
    pub(super) fn at(&self, place: &P::Place) -> Microfacets {
        let u = self.along_u.number(place);
        let v = self.along_v.as_ref().map_or(u, |v| v.number(place));
        Microfacets::new(self.distribution, [u, v])
    }
}

/// A surface of many small mirrors, seen in the frame of the whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Microfacets {
    distribution: Distribution,
    alpha: [f32; 2],
}

impl Microfacets {
    #[inline]
    pub(super) fn new(distribution: Distribution, alpha: [f32; 2]) -> Self {
        Self {
            distribution,
            alpha: alpha.map(|alpha| alpha.max(SMOOTHEST)),
        }
    }

    /// The lesser roughness of the two.
    #[inline]
    pub(super) fn least(&self) -> f32 {
        self.alpha[0].min(self.alpha[1])
    }

    /// The area of facets with the normal `m`, per solid angle and area of the surface; `m.z > 0`.
    #[inline]
    pub(super) fn area(&self, m: Vec3A) -> f32 {
        let [u, v] = self.alpha;
        let (x, y) = (m.x / u, m.y / v);
        let squared = m.z * m.z;
        let area = match self.distribution {
            Distribution::Beckmann => {
                let slope = (x * x + y * y) / squared;
                (-slope).exp() / (PI * u * v * squared * squared)
            }
            Distribution::Ggx => {
                let length = x * x + y * y + squared;
                FRAC_1_PI / (u * v * length * length)
            }
        };
        // Far out in the tail, where the exponential and the cosine are both zero too.
        if area * m.z > 1e-20 { area } else { 0.0 }
    }

    /// The area of facets that are seen from `v`, projected to its direction, per area of the surface: the cosine
    /// of `v` over the fraction of facets that no other one hides, as Smith has it.[^heitz]
    ///
    /// It is the same from below.
    ///
    /// [^heitz]: Heitz, Eric (2014). *Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs*.
    ///     <https://jcgt.org/published/0003/02/03/>
    #[inline]
    pub(super) fn seen(&self, v: Vec3A) -> f32 {
        let cosine = v.z.abs();
        let (x, y) = (self.alpha[0] * v.x, self.alpha[1] * v.y);
        let rough = x * x + y * y;
        match self.distribution {
            Distribution::Beckmann => beckmann::seen(cosine, rough.sqrt()),
            Distribution::Ggx => 0.5 * (cosine + (cosine * cosine + rough).sqrt()),
        }
    }

    /// The fraction of facets with the normal `m` that no other one hides from `v`; zero where `v` is on the
    /// other side of the facet than of the surface.
    #[inline]
    pub(super) fn unmasked(&self, v: Vec3A, m: Vec3A) -> f32 {
        if v.dot(m) * v.z <= 0.0 {
            return 0.0;
        }
        (v.z.abs() / self.seen(v)).min(1.0)
    }

    /// The normal of a facet that is seen from `v`, `v.z > 0`: drawn with the density
    /// [`area`](Self::area)`(m) * v.dot(m) / `[`seen`](Self::seen)`(v)`.
    #[inline]
    pub(super) fn sample(&self, v: Vec3A, u: [f32; 2]) -> Vec3A {
        let [along_u, along_v] = self.alpha;
        // Where both roughnesses are 1.
        let stretched = Vec3A::new(along_u * v.x, along_v * v.y, v.z).normalize();
        let normal = match self.distribution {
            Distribution::Beckmann => beckmann::sample(stretched, u),
            Distribution::Ggx => ellipsoid(stretched, u),
        };
        Vec3A::new(along_u * normal.x, along_v * normal.y, normal.z).normalize()
    }
}

/// A vector along the normal of a facet of the hemisphere that is seen from `v`: the half vector of `v` and a point of the
/// spherical cap above `-v`.[^dupuy]
///
/// [^dupuy]: Dupuy, Jonathan; Benyoub, Anis (2023). *Sampling Visible GGX Normals with Spherical Caps*.
///     <https://doi.org/10.1111/cgf.14867>
#[inline]
fn ellipsoid(v: Vec3A, [a, b]: [f32; 2]) -> Vec3A {
    let [cosine, sine] = turn(a);
    let height = (1.0 - b) * (1.0 + v.z);
    let z = height - v.z;
    let radius = (1.0 - z * z).max(0.0).sqrt();
    Vec3A::new(radius * cosine + v.x, radius * sine + v.y, height)
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOTH: [Distribution; 2] = [Distribution::Beckmann, Distribution::Ggx];

    /// The midpoint rule over the normals of the upper hemisphere.
    fn integrate(f: impl Fn(Vec3A) -> f32) -> f64 {
        const RINGS: u16 = 700;
        const SECTORS: u16 = 160;
        let mut sum = 0.0;
        for i in 0..RINGS {
            // Dense towards the pole.
            let t = (f32::from(i) + 0.5) / f32::from(RINGS);
            let theta = 0.5 * PI * t * t * t;
            let measure = 1.5 * PI * t * t / f32::from(RINGS) * theta.sin();
            for j in 0..SECTORS {
                let phi = 2.0 * PI * (f32::from(j) + 0.5) / f32::from(SECTORS);
                let m = Vec3A::new(
                    theta.sin() * phi.cos(),
                    theta.sin() * phi.sin(),
                    theta.cos(),
                );
                sum += f64::from(measure * f(m));
            }
        }
        sum * 2.0 * core::f64::consts::PI / f64::from(SECTORS)
    }

    #[test]
    fn facets_cover_the_surface_from_above_and_from_the_side() {
        for distribution in BOTH {
            for alpha in [[0.05, 0.05], [0.3, 0.3], [1.0, 1.0], [0.1, 0.6]] {
                let facets = Microfacets::new(distribution, alpha);
                let above = integrate(|m| facets.area(m) * m.z);
                assert!((above - 1.0).abs() < 2e-3, "{facets:?}: {above}");
                for cosine in [1.0_f32, 0.7, 0.2, 0.02] {
                    let v = Vec3A::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
                    let seen = integrate(|m| facets.area(m) * v.dot(m).max(0.0));
                    let expected = f64::from(facets.seen(v));
                    assert!((seen / expected - 1.0).abs() < 3e-3, "{facets:?} {cosine}");
                }
            }
        }
    }

    #[test]
    fn normals_are_unit_vectors_above_the_surface_that_are_seen() {
        let tiny = f32::MIN_POSITIVE;
        for distribution in BOTH {
            for alpha in [
                [0.0, 0.0],
                [1e-4, 1e-4],
                [0.01, 1.0],
                [1.0, 1.0],
                [5.0, 5.0],
            ] {
                let facets = Microfacets::new(distribution, alpha);
                for cosine in [1.0_f32, 0.999_999_9, 0.5, 1e-3, 1e-7, 1e-30] {
                    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
                    let v = Vec3A::new(0.6 * sine, -0.8 * sine, cosine);
                    for a in [0.0, tiny, 0.5, 1.0 - 0.5 * f32::EPSILON] {
                        for b in [0.0, tiny, 0.5, 1.0 - 0.5 * f32::EPSILON] {
                            let m = facets.sample(v, [a, b]);
                            let case = format!("{facets:?} {cosine} {a} {b}: {m}");
                            assert!((m.length() - 1.0).abs() < 1e-6, "{case}");
                            assert!(m.z >= 0.0, "{case}");
                            assert!(m.dot(v) >= -1e-6, "{case}");
                        }
                    }
                }
            }
        }
    }
}
