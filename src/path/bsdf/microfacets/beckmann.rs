//! Facets whose slopes are normally distributed.

use glam::Vec3A;

/// `1 / sqrt(pi)`.
const FRAC_1_SQRT_PI: f32 = 0.564_189_6;

/// `sqrt(pi) / 4`.
const QUARTER_SQRT_PI: f32 = 0.443_113_46;

/// The area of facets seen at `cosine`, where `rough` is the sine times the roughness:
/// `cosine (1 + erf(a)) / 2 + rough exp(-a^2) / (2 sqrt(pi))` with `a = cosine / rough`.
///
/// Mitsuba has Walter's rational approximation of the masking that follows from it, which is off by up to 0.35 %, and draws
/// normals by the integral itself.
#[inline]
pub(super) fn seen(cosine: f32, rough: f32) -> f32 {
    let a = cosine / rough;
    // From here on, and where there is no roughness, what is missing is below the rounding of f32.
    if !(a < 4.0) {
        return cosine;
    }
    let gauss = (-a * a).exp();
    0.5 * (cosine * (1.0 + erf(a, gauss)) + rough * FRAC_1_SQRT_PI * gauss)
}

/// The error function of `x >= 0`, given `gauss = exp(-x^2)`, to 5e-7 with its rounding.[^hastings]
///
/// [^hastings]: Hastings, Cecil (1955). *Approximations for Digital Computers*. Princeton University Press. Also formula 7.1.26 of Abramowitz,
///     Milton; Stegun, Irene (1964). *Handbook of Mathematical Functions*.
#[inline]
fn erf(x: f32, gauss: f32) -> f32 {
    const TERMS: [f32; 5] = [
        1.061_405_4,
        -1.453_152,
        1.421_413_7,
        -0.284_496_74,
        0.254_829_6,
    ];
    let t = 1.0 / (1.0 + 0.327_591_1 * x);
    // In pairs, which do not wait for one another.
    let [fourth, third, second, first, zeroth] = TERMS;
    let squared = t * t;
    let sum = (first * t + zeroth) + ((third * t + second) + fourth * squared) * squared;
    1.0 - t * sum * gauss
}

/// A vector along the normal of a facet of roughness 1 that is seen from `v`.
///
/// Its slope along `v` has the density `(cosine - x sine) exp(-x^2)` up to the slope where facets turn away; its
/// distribution function is inverted in `erf(x)`,[^jakob] by Halley's method, from between the solutions for a vertical `v` and a horizontal one:
/// over all cosines and coordinates, one step or none does in nineteen of twenty; Newton's method from the latter takes two or three.
///
/// [^jakob]: Jakob, Wenzel (2014). *An Improved Visible Normal Sampling Routine for the Beckmann Distribution*.
///     <https://www.mitsuba-renderer.org/~wenzel/files/visnormal.pdf>
#[inline]
pub(super) fn sample(v: Vec3A, u: [f32; 2]) -> Vec3A {
    // What is left of the tails is less than the coordinates resolve.
    const EDGE: f32 = 0.5 * f32::EPSILON;
    let [a, b] = u.map(|u| u.clamp(EDGE, 1.0 - EDGE));
    let cosine = v.z;
    let sine = (v.x * v.x + v.y * v.y).sqrt();
    let last = cosine / sine;
    let tail = |gauss: f32| sine * FRAC_1_SQRT_PI * gauss;
    let (greatest, total) = if last < 4.0 {
        let gauss = (-last * last).exp();
        let greatest = erf(last, gauss);
        (greatest, cosine * (1.0 + greatest) + tail(gauss))
    } else {
        (1.0, 2.0 * cosine)
    };
    let within = |erf: f32| erf.clamp(-1.0 + EDGE, greatest.min(1.0 - EDGE));
    let vertical = a * (1.0 + greatest) - 1.0;
    let horizontal = greatest - (1.0 + greatest) * erf((-a.ln()).sqrt(), a);
    let mut at = within(vertical + (horizontal - vertical) * sine);
    let mut along = inverse_erf(at);
    for _ in 0..2 {
        let gauss = (-along * along).exp();
        let excess = cosine * (1.0 + at) + tail(gauss) - a * total;
        let slope = cosine - along * sine;
        // As near as rounding lets it come, or at the edge.
        if excess.abs() < 1e-6 * total || !(slope > 0.0) {
            break;
        }
        let bent = slope + excess * (QUARTER_SQRT_PI * sine) / (gauss * slope);
        at = within(at - excess / if bent > 0.0 { bent } else { slope });
        along = inverse_erf(at);
    }
    let across = inverse_erf(2.0 * b - 1.0);
    // Below it the squares have few digits; there all directions are alike.
    let (x, y) = if sine > 1e-18 {
        (v.x / sine, v.y / sine)
    } else {
        (1.0, 0.0)
    };
    Vec3A::new(y * across - x * along, -y * along - x * across, 1.0)
}

/// The inverse of the error function on `(-1, 1)`, to some 4e-7 of itself.[^giles]
///
/// [^giles]: Giles, Mike (2012). *Approximating the erfinv Function*. GPU Computing Gems, Jade Edition, chapter 10.
///     <https://people.maths.ox.ac.uk/gilesm/files/gems_erfinv.pdf>
#[inline]
fn inverse_erf(x: f32) -> f32 {
    const CENTRE: [f32; 9] = [
        2.810_226_4e-8,
        3.432_739_4e-7,
        -3.523_387_7e-6,
        -4.391_506_5e-6,
        0.000_218_580_87,
        -0.001_253_725,
        -0.004_177_681_6,
        0.246_640_73,
        1.501_409_4,
    ];
    const TAIL: [f32; 9] = [
        -0.000_200_214_26,
        0.000_100_950_56,
        0.001_349_343_2,
        -0.003_673_428_4,
        0.005_739_507_7,
        -0.007_622_461_3,
        0.009_438_870_5,
        1.001_674,
        2.832_976_8,
    ];
    let w = -((1.0 - x) * (1.0 + x)).ln();
    let (w, terms) = if w < 5.0 {
        (w - 2.5, CENTRE)
    } else {
        (w.sqrt() - 3.0, TAIL)
    };
    // In pairs, which do not wait for one another.
    let [
        eighth,
        seventh,
        sixth,
        fifth,
        fourth,
        third,
        second,
        first,
        zeroth,
    ] = terms;
    let squared = w * w;
    let fourfold = squared * squared;
    let low = (first * w + zeroth) + (third * w + second) * squared;
    let high = (fifth * w + fourth) + (seventh * w + sixth) * squared;
    x * (low + (high + eighth * fourfold) * fourfold)
}

#[cfg(test)]
mod tests {
    use core::f32::consts::PI;

    use super::*;

    #[test]
    fn the_error_function_is_that_of_the_library() {
        for i in 0..=4000_u16 {
            let x = 0.001 * f32::from(i);
            let off = f64::from(erf(x, (-x * x).exp())) - libm::erf(f64::from(x));
            assert!(off.abs() < 5e-7, "{x}: {off}");
        }
    }

    #[test]
    fn the_inverse_undoes_the_error_function() {
        for i in 1..=3500_u16 {
            let x = 0.001 * f32::from(i);
            let u = libm::erf(f64::from(x));
            #[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
            let erf = u as f32;
            // Rounding erf moves x by so much.
            let moved = 0.5 * f32::EPSILON * 0.5 * PI.sqrt() * (x * x).exp();
            let error = (inverse_erf(erf) - x).abs();
            assert!(error < 6e-7 * x + 1.5 * moved, "{x}: {error}");
            assert_eq!(inverse_erf(-erf), -inverse_erf(erf));
        }
        assert_eq!(inverse_erf(0.0), 0.0);
    }

    #[test]
    fn the_distribution_function_is_inverted() {
        // The distribution function of the slope along `v`, in f64.
        for cosine in [1.0_f32, 0.9, 0.5, 0.1, 1e-2, 1e-4] {
            let v = Vec3A::new((1.0 - cosine * cosine).max(0.0).sqrt(), 0.0, cosine);
            let (c, s) = (f64::from(v.z), f64::from(v.x));
            let integral = |x: f64| {
                c * (1.0 + libm::erf(x)) + s * (-x * x).exp() / core::f64::consts::PI.sqrt()
            };
            let inner = (1..200_u8).map(|i| f32::from(i) / 200.0);
            let tails = [f32::EPSILON, 1e-4, 1.0 - 1e-4, 1.0 - 0.5 * f32::EPSILON];
            for a in inner.chain(tails) {
                let m = sample(v, [a, 0.5]);
                let u = integral(f64::from(-m.x)) / integral(if s > 0.0 { c / s } else { 9.0 });
                // As near as steps are asked to bring it, and the error functions.
                assert!((u - f64::from(a)).abs() < 3e-6, "{cosine} {a}: {u}");
            }
        }
    }
}
