//! How much light passes a rough boundary.

use glam::Vec3A;

use crate::path::bsdf::fresnel::refraction;
use crate::path::bsdf::microfacets::Microfacets;
use crate::path::frame::singles;
use crate::points::{Folded, Lattice};
use crate::{Average, Error, Estimator, cube};

/// Cosines for which transmission is tabulated, from 0 to 1.
const COSINES: u16 = 64;

/// The two numbers of Fibonacci that make the lattice by which the tables are integrated.
const FIBONACCI: [u64; 2] = [1597, 2584];

/// The fraction of light that passes a rough boundary, by the cosine at which it comes, and the fraction of diffuse light
/// that comes back from within.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Coat {
    passed: Box<[f32]>,
    internal: f32,
}

impl Coat {
    /// For a boundary of these facets, behind which the index of refraction is `eta` times that before it.
    pub(super) fn new(facets: &Microfacets, eta: f32) -> Result<Self, Error> {
        let passed = table(|out| {
            over_facets(facets, out, |m| {
                let cosine = out.dot(m).clamp(0.0, 1.0);
                let refraction = refraction(cosine, eta);
                let into = m * (cosine / eta - refraction.cosine) - out / eta;
                let below = refraction.reflected < 1.0 && into.z < 0.0;
                let unmasked = facets.unmasked(into.normalize(), m);
                if below {
                    unmasked * (1.0 - refraction.reflected)
                } else {
                    0.0
                }
            })
        })?;
        let returned = table(|out| {
            over_facets(facets, out, |m| {
                let cosine = out.dot(m).clamp(0.0, 1.0);
                let into = m * (2.0 * cosine) - out;
                let above = into.z > 0.0;
                let unmasked = facets.unmasked(into, m);
                if above {
                    unmasked * refraction(cosine, eta.recip()).reflected
                } else {
                    0.0
                }
            })
        })?;
        // The mean over the table, ends included, is 1.5 % less than the integral where nearly everything comes
        // back. Mitsuba has it so, and its pictures are to be met.
        let sum: f32 = returned
            .iter()
            .zip(0_u16..)
            .map(|(returned, i)| returned * cosine(i))
            .sum();
        Ok(Self {
            passed,
            internal: 2.0 * sum / f32::from(COSINES),
        })
    }

    /// The fraction of diffuse light from within that comes back.
    pub(super) fn internal(&self) -> f32 {
        self.internal
    }

    /// The fraction that passes of the light that comes at `cosine`, in `[0, 1]`.
    #[inline]
    pub(super) fn passed(&self, cosine: f32) -> f32 {
        let place = cosine.min(1.0) * f32::from(COSINES - 1);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "the whole part of a number within the table"
        )]
        let cell = (place as u16).min(COSINES - 2);
        let [low, high] = [cell, cell + 1].map(|cell| self.passed[usize::from(cell)]);
        low + (high - low) * (place - f32::from(cell))
    }
}

/// The cosine of an entry.
fn cosine(entry: u16) -> f32 {
    (f32::from(entry) / f32::from(COSINES - 1)).max(1e-6)
}

/// The values of `f` for directions of all cosines.
fn table(f: impl Fn(Vec3A) -> Result<f32, Error>) -> Result<Box<[f32]>, Error> {
    (0..COSINES)
        .map(|entry| {
            let cosine = cosine(entry);
            f(Vec3A::new(
                (1.0 - cosine * cosine).max(0.0).sqrt(),
                0.0,
                cosine,
            ))
        })
        .collect()
}

/// The mean over the facets that are seen from `out`.
fn over_facets(
    facets: &Microfacets,
    out: Vec3A,
    f: impl Fn(Vec3A) -> f32 + Sync,
) -> Result<f32, Error> {
    let [generator, count] = FIBONACCI;
    let points = Folded::new(Lattice::new(count, &[1, generator])?);
    let facets = cube(|u: [f64; 2]| f(facets.sample(out, singles(u))));
    let mean = Average::new(points, count).estimate(&facets)?.mean;
    #[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
    let mean = mean as f32;
    Ok(mean)
}

#[cfg(test)]
mod tests {
    use core::f32::consts::PI;

    use super::*;
    use crate::path::bsdf::Distribution;

    #[test]
    fn the_table_is_the_integral_over_all_facets() {
        const ETA: f32 = 1.49;
        for distribution in [Distribution::Beckmann, Distribution::Ggx] {
            for alpha in [0.05, 0.3] {
                let facets = Microfacets::new(distribution, [alpha; 2]);
                let coat = Coat::new(&facets, ETA).unwrap();
                for out in [0.2_f32, 0.6, 1.0] {
                    let out = Vec3A::new((1.0 - out * out).sqrt(), 0.0, out);
                    let passed = integrate(|m| {
                        let cosine = out.dot(m);
                        if !(cosine > 0.0) {
                            return 0.0;
                        }
                        let refraction = refraction(cosine, ETA);
                        let into = m * (cosine / ETA - refraction.cosine) - out / ETA;
                        let unmasked = facets.unmasked(into, m) * f32::from(u8::from(into.z < 0.0));
                        let seen = facets.area(m) * cosine / facets.seen(out);
                        seen * unmasked * (1.0 - refraction.reflected)
                    });
                    let error = (f64::from(coat.passed(out.z)) - passed).abs();
                    // The table is interpolated.
                    assert!(error < 1e-3, "{facets:?} {out}: {passed} {error}");
                }
            }
        }
    }

    /// The midpoint rule over the upper hemisphere, dense towards the pole.
    fn integrate(f: impl Fn(Vec3A) -> f32) -> f64 {
        const RINGS: u16 = 600;
        const SECTORS: u16 = 100;
        let mut sum = 0.0;
        for i in 0..RINGS {
            let t = (f32::from(i) + 0.5) / f32::from(RINGS);
            let theta = 0.5 * PI * t * t * t;
            let ring = 1.5 * PI * t * t * theta.sin() / f32::from(RINGS);
            for j in 0..SECTORS {
                let phi = 2.0 * PI * (f32::from(j) + 0.5) / f32::from(SECTORS);
                let (x, y) = (theta.sin() * phi.cos(), theta.sin() * phi.sin());
                sum += f64::from(f(Vec3A::new(x, y, theta.cos())) * ring);
            }
        }
        sum * 2.0 * core::f64::consts::PI / f64::from(SECTORS)
    }
}
