//! How much light a smooth boundary reflects, and where the rest goes.

use glam::Vec3A;

use crate::Error;

/// What Fresnel's formula and Snell's law say of a ray.
pub(super) struct Refraction {
    /// The fraction that is reflected.
    pub(super) reflected: f32,
    /// The cosine of the refracted ray, zero or more.
    pub(super) cosine: f32,
}

/// For a ray with the given cosine in `[0, 1]` up to rounding, passing to a medium whose index of refraction is `eta` times
/// the one it comes from.[^born]
///
/// [^born]: Born, Max; Wolf, Emil (1999). *Principles of Optics*, 7th edition, section 1.5.2.
///     <https://doi.org/10.1017/CBO9781139644181>
#[inline]
pub(super) fn refraction(cosine: f32, eta: f32) -> Refraction {
    let cosine = cosine.clamp(0.0, 1.0);
    // eta^2 - sine^2, without the cancellation where the indices are nearly the same.
    let squared = (eta - 1.0) * (eta + 1.0) + cosine * cosine;
    if squared <= 0.0 {
        return Refraction {
            reflected: 1.0,
            cosine: 0.0,
        };
    }
    let refracted = squared.sqrt() / eta;
    let perpendicular = (cosine - eta * refracted) / (cosine + eta * refracted);
    let parallel = (eta * cosine - refracted) / (eta * cosine + refracted);
    Refraction {
        reflected: 0.5 * (perpendicular * perpendicular + parallel * parallel),
        cosine: refracted,
    }
}

/// The fraction of red, green and blue that a conductor with the index of refraction `eta + i k` reflects, relative to
/// what is outside, at the given cosine in `[0, 1]` up to rounding.[^moller]
///
/// [^moller]: Möller, Karl Dieter (2007). *Optics: Learning by Computing*, 2nd edition, chapter 8.
///     <https://doi.org/10.1007/978-0-387-69492-4>
#[inline]
pub(super) fn conductor(cosine: f32, eta: Vec3A, k: Vec3A) -> Vec3A {
    let cosine = cosine.clamp(0.0, 1.0);
    let squared_cosine = cosine * cosine;
    let squared_sine = 1.0 - squared_cosine;
    // (a + i b)^2 = (eta + i k)^2 - sine^2.
    let difference = eta * eta - k * k - squared_sine;
    let product = 2.0 * eta * k;
    let modulus = (difference * difference + product * product).map(f32::sqrt);
    let a = (0.5 * (modulus + difference))
        .max(Vec3A::ZERO)
        .map(f32::sqrt);
    let sum = modulus + squared_cosine;
    let twice = 2.0 * cosine * a;
    let perpendicular = (sum - twice) / (sum + twice);
    let sum = modulus * squared_cosine + squared_sine * squared_sine;
    let twice = twice * squared_sine;
    // Both are zero where there is no boundary and light comes from above.
    let ratio = (sum - twice) / (sum + twice).max(Vec3A::splat(f32::MIN_POSITIVE));
    0.5 * perpendicular * (1.0 + ratio)
}

/// The fraction of diffuse light that a boundary to a medium of `eta` times the index of refraction reflects, by
/// fits that are within 0.2 % for `eta` in `[0.5, 1]`[^egan] and from 1 to 10.[^deon]
///
/// They are used, not the integral itself, because Mitsuba's pictures are to be met to less than that.
///
/// [^egan]: Egan, Walter; Hilgeman, Theodore (1973). *Spectral Reflectance of Particulate Materials*. Applied Optics 12,
///     1816. <https://doi.org/10.1364/AO.12.001816>
/// [^deon]: d'Eon, Eugene; Irving, Geoffrey (2011). *A Quantized-Diffusion Model for Rendering Translucent Materials*.
///     <https://doi.org/10.1145/1964921.1964951>
pub(super) fn diffuse_reflectance(eta: f32) -> f32 {
    let x = eta.recip();
    if eta < 1.0 {
        return 0.6681 + eta * (0.7099 - 1.4399 * eta) + 0.0636 * x;
    }
    let tail = 6.753_35 + x * (-7.809_89 + x * (4.985_54 - 1.368_81 * x));
    0.919_317 + x * (-3.4793 + x * tail)
}

/// The quotient of the indices of refraction `inside` and `outside`.
///
/// # Errors
///
/// [`Error::Refused`] for an index that is not positive and finite, and for two so far apart that the square of
/// their quotient, or of its inverse, is none of `f32`.
pub(super) fn quotient(inside: f32, outside: f32) -> Result<f32, Error> {
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
    Ok(eta)
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
    fn equal_indices_are_no_boundary() {
        for cosine in [1.0, 0.5, 1e-3, 1e-6] {
            let refraction = refraction(cosine, 1.0);
            assert_eq!(refraction.reflected, 0.0, "{cosine}");
            assert!((refraction.cosine / cosine - 1.0).abs() < 1e-6, "{cosine}");
        }
    }

    #[test]
    fn nearly_equal_indices_keep_their_digits() {
        // The formulas in f64, with the quotient that f32 holds.
        let eta = 1.000_001_f32;
        for cosine in [0.5_f32, 0.01, 1e-3] {
            let (n, c) = (f64::from(eta), f64::from(cosine));
            let refracted = (1.0 - (1.0 - c * c) / (n * n)).sqrt();
            let s = (c - n * refracted) / (c + n * refracted);
            let p = (n * c - refracted) / (n * c + refracted);
            let expected = 0.5 * (s * s + p * p);
            let reflected = f64::from(refraction(cosine, eta).reflected);
            // Amplitudes lose up to seven of the 24 bits against one another.
            assert!((reflected - expected).abs() < 1e-13 + 1e-2 * expected);
        }
    }

    /// Fresnel's formulas with complex numbers in f64.
    fn complex(cosine: f64, eta: f64, k: f64) -> f64 {
        type C = [f64; 2];
        let mul = |a: C, b: C| [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]];
        let square = |a: C| a[0] * a[0] + a[1] * a[1];
        let n = [eta, k];
        let inner = mul(n, n);
        let inner = [inner[0] - (1.0 - cosine * cosine), inner[1]];
        // The root in the first quadrant: n cos t.
        let modulus = square(inner).sqrt().sqrt();
        let angle = 0.5 * inner[1].atan2(inner[0]);
        let root = [modulus * angle.cos(), modulus * angle.sin()];
        let s = square([cosine - root[0], -root[1]]) / square([cosine + root[0], root[1]]);
        let n2 = mul(n, n);
        let scaled = [n2[0] * cosine, n2[1] * cosine];
        let p = square([scaled[0] - root[0], scaled[1] - root[1]])
            / square([scaled[0] + root[0], scaled[1] + root[1]]);
        0.5 * (s + p)
    }

    #[test]
    fn conductors_reflect_as_complex_formulas_say() {
        // Such as metals have, and without absorption.
        let materials = [
            ([0.200, 0.924, 1.102], [3.912, 2.452, 2.142]),
            ([0.143, 0.375, 1.442], [3.983, 2.386, 1.603]),
            ([1.5, 1.3, 2.4], [0.0, 1e-3, 0.0]),
        ];
        for (eta, k) in materials {
            for i in 0..=20_u8 {
                let cosine = f32::from(i) / 20.0;
                let ours = conductor(cosine, Vec3A::from(eta), Vec3A::from(k));
                for (channel, ours) in ours.to_array().into_iter().enumerate() {
                    let theirs = complex(
                        f64::from(cosine),
                        f64::from(eta[channel]),
                        f64::from(k[channel]),
                    );
                    assert!((f64::from(ours) - theirs).abs() < 2e-6, "{cosine} {eta:?}");
                }
            }
        }
    }

    #[test]
    fn conductors_at_normal_incidence_and_perfect_mirrors() {
        // ((n - 1)^2 + k^2) / ((n + 1)^2 + k^2): Born and Wolf, section 14.2.
        for (n, k) in [(0.21_f32, 3.67_f32), (1.44, 7.5), (2.9, 3.0)] {
            let expected = ((n - 1.0).powi(2) + k * k) / ((n + 1.0).powi(2) + k * k);
            let reflected = conductor(1.0, Vec3A::splat(n), Vec3A::splat(k)).x;
            assert!((reflected - expected).abs() < 1e-6);
        }
        for cosine in [0.0, 0.3, 1.0] {
            let reflected = conductor(cosine, Vec3A::ZERO, Vec3A::ONE).x;
            assert!((reflected - 1.0).abs() < 1e-6);
            assert!(conductor(cosine, Vec3A::ZERO, Vec3A::ZERO).is_finite());
        }
    }

    #[test]
    fn diffuse_reflectance_is_near_its_integral() {
        for eta in [0.55_f32, 0.67, 0.9, 1.1, 1.33, 1.49, 2.0, 3.0] {
            let count = 100_000_u32;
            let integral: f64 = (0..count)
                .map(|i| {
                    // The density of the cosine is twice the cosine: its square is uniform.
                    let square = (f64::from(i) + 0.5) / f64::from(count);
                    #[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
                    let cosine = square.sqrt() as f32;
                    f64::from(refraction(cosine, eta).reflected)
                })
                .sum::<f64>()
                / f64::from(count);
            let fit = f64::from(diffuse_reflectance(eta));
            assert!((fit - integral).abs() < 4e-3, "{eta}: {fit} {integral}");
        }
    }
}
