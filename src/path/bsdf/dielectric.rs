//! Smooth boundaries between transparent media.

use glam::Vec3A;

use super::mirror::reflect;
use super::{Bsdf, Scattered, Scattering};
use crate::path::Surface;
use crate::path::frame::single;
use crate::{Error, Sampler};

/// A smooth boundary between two transparent media, as that of a glass ball is.
///
/// One coordinate chooses reflection, with the probability that Fresnel's formula gives for unpolarised
/// light,[^born] or refraction. Radiance that is refracted scales with the square of the index of refraction:
/// it leaves the denser medium `eta^2` times weaker than it is inside.[^veach]
///
/// [^born]: Born, Max; Wolf, Emil (1999). *Principles of Optics*, 7th edition, section 1.5.2.
///     <https://doi.org/10.1017/CBO9781139644181>
/// [^veach]: Veach, Eric (1997). *Robust Monte Carlo Methods for Light Transport Simulation*, section 5.2.
///     <https://graphics.stanford.edu/papers/veach_thesis/>
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dielectric {
    eta: f32,
}

impl Dielectric {
    /// The boundary with the index of refraction `inside`, on the inner side, and `outside`.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for an index that is not positive and finite, and for two so far apart that the square of
    /// their quotient, or of its inverse, is none of `f32`.
    pub fn new(inside: f32, outside: f32) -> Result<Self, Error> {
        for index in [inside, outside] {
            if !(index > 0.0 && index.is_finite()) {
                return Err(Error::refused(
                    "index of refraction",
                    "positive and finite",
                    index,
                ));
            }
        }
        let eta = inside / outside;
        // What weights are made of, on the way in and out.
        let square = eta * eta;
        if !(square > 0.0 && square.is_finite() && square.recip().is_finite()) {
            return Err(Error::refused(
                "quotient of the indices of refraction",
                "positive and finite, its square and that of its inverse too",
                format_args!("{inside} / {outside}"),
            ));
        }
        Ok(Self { eta })
    }
}

/// What Fresnel's formula and Snell's law say of a ray.
struct Refraction {
    /// The fraction that is reflected.
    reflected: f32,
    /// The cosine of the refracted ray, zero or more.
    cosine: f32,
}

/// For a ray with the given cosine in `[0, 1]`, passing to a medium whose index of refraction is `eta` times
/// the one it comes from.
#[inline]
fn refraction(cosine: f32, eta: f32) -> Refraction {
    let squared_sine = (1.0 - cosine * cosine) / (eta * eta);
    if squared_sine >= 1.0 {
        return Refraction {
            reflected: 1.0,
            cosine: 0.0,
        };
    }
    let refracted = (1.0 - squared_sine).sqrt();
    let perpendicular = (cosine - eta * refracted) / (cosine + eta * refracted);
    let parallel = (eta * cosine - refracted) / (eta * cosine + refracted);
    Refraction {
        reflected: 0.5 * (perpendicular * perpendicular + parallel * parallel),
        cosine: refracted,
    }
}

impl Bsdf for Dielectric {
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
        let normal = at.normal;
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
            return Some(Scattered {
                direction: reflect(normal, out),
                weight: Vec3A::ONE,
                density: f32::INFINITY,
                eta: 1.0,
            });
        }
        let direction = normal * (side * (cosine / eta - refraction.cosine)) - out / eta;
        Some(Scattered {
            direction: direction.normalize(),
            weight: Vec3A::splat((eta * eta).recip()),
            density: f32::INFINITY,
            eta,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fresnel_at_normal_incidence_and_brewsters_angle() {
        // ((n - 1) / (n + 1))^2 at normal incidence; at Brewster's angle, tan = n, half of
        // ((n^2 - 1) / (n^2 + 1))^2: Born and Wolf, section 1.5.
        let n = 1.5_f32;
        assert!((refraction(1.0, n).reflected - 0.04).abs() < 1e-7);
        let brewster = (1.0 + n * n).sqrt().recip();
        let expected = 0.5 * ((n * n - 1.0) / (n * n + 1.0)).powi(2);
        assert!((refraction(brewster, n).reflected - expected).abs() < 1e-6);
        assert_eq!(refraction(0.0, n).reflected, 1.0);
        // Total reflection from inside past sin = 1 / n.
        assert_eq!(refraction(0.7, 1.0 / n).reflected, 1.0);
        assert!(refraction(0.8, 1.0 / n).reflected < 1.0);
    }

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
            let at = Surface {
                point: Vec3A::ZERO,
                normal,
                margin: 0.0,
                detail: (),
            };
            let out = Vec3A::new(0.28, 0.0, 0.96);
            let there = glass.sample(&at, out, &mut Last).unwrap();
            let sines = [out, there.direction].map(|v| normal.cross(v).length());
            assert!((sines[0] - there.eta * sines[1]).abs() < 1e-6);
            assert!(normal.dot(out) * normal.dot(there.direction) < 0.0);
            // The way back is the same way.
            let back = glass.sample(&at, there.direction, &mut Last).unwrap();
            assert!((back.direction - out).length() < 1e-6);
            assert!((back.weight * there.weight - Vec3A::ONE).length() < 1e-6);
        }
    }
}
