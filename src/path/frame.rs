//! Directions around a normal, and the maps of the square that draw them.

#[cfg(feature = "simd")]
pub(in crate::path) mod lanes;

use core::f32::consts::{FRAC_1_PI, FRAC_PI_4};
use core::ops::{Add, Mul};

use glam::Vec3A;

/// A right-handed orthonormal basis: the frame in which [laws of scattering](super::bsdf::Law) work.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    tangent: Vec3A,
    bitangent: Vec3A,
    normal: Vec3A,
}

impl Frame {
    /// A basis whose third vector is `normal`, of length 1.[^duff]
    ///
    /// [^duff]: Duff, Tom; et al. (2017). *Building an Orthonormal Basis, Revisited*.
    ///     <https://jcgt.org/published/0006/01/01/>
    #[inline]
    pub fn around(normal: Vec3A) -> Self {
        let sign = 1.0_f32.copysign(normal.z);
        let a = -1.0 / (sign + normal.z);
        let b = normal.x * normal.y * a;
        Self {
            tangent: Vec3A::new(
                1.0 + sign * normal.x * normal.x * a,
                sign * b,
                -sign * normal.x,
            ),
            bitangent: Vec3A::new(b, sign + normal.y * normal.y * a, -normal.y),
            normal,
        }
    }

    /// The basis whose third vector is `normal`, of length 1, and whose first one is as near as can be to `tangent`; any
    /// such basis where the tangent is parallel to the normal or none.
    #[inline]
    pub fn along(normal: Vec3A, tangent: Vec3A) -> Self {
        let across = tangent - normal * normal.dot(tangent);
        let Some(tangent) = across.try_normalize() else {
            return Self::around(normal);
        };
        Self {
            tangent,
            bitangent: normal.cross(tangent),
            normal,
        }
    }

    /// The third vector of the basis.
    #[inline]
    pub fn normal(&self) -> Vec3A {
        self.normal
    }

    /// The coordinates of a vector in this basis.
    #[inline]
    pub fn local(&self, vector: Vec3A) -> Vec3A {
        Vec3A::new(
            self.tangent.dot(vector),
            self.bitangent.dot(vector),
            self.normal.dot(vector),
        )
    }

    /// The vector with the given coordinates in this basis.
    #[inline]
    pub fn out(&self, local: Vec3A) -> Vec3A {
        self.tangent * local.x + self.bitangent * local.y + self.normal * local.z
    }
}

/// [`f32::floor`], in a few instructions: without those that round, as on the least of x86-64, that is a call of a function.
#[inline]
#[expect(
    clippy::cast_possible_truncation,
    reason = "of numbers that have a fraction"
)]
pub(in crate::path) fn floor(number: f32) -> f32 {
    // From here on numbers are whole.
    const WHOLE: f32 = (1 << 23) as f32;
    if !(number.abs() < WHOLE) {
        return number;
    }
    let toward_zero = number as i32 as f32;
    if toward_zero > number {
        toward_zero - 1.0
    } else {
        toward_zero
    }
}

/// A coordinate in `f32`, truncated where it would round to 1.
#[inline]
#[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
pub(in crate::path) fn single(u: f64) -> f32 {
    (u as f32).min(1.0 - 0.5 * f32::EPSILON)
}

/// Two coordinates as [`single`].
#[inline]
pub(in crate::path) fn singles([a, b]: [f64; 2]) -> [f32; 2] {
    [single(a), single(b)]
}

/// Cosine and sine of an angle in `[-pi/4, pi/4]`, by the first terms of their series: the rest is below the
/// rounding of `f32`.
#[inline]
fn eighth(angle: f32) -> [f32; 2] {
    let x = angle * angle;
    let cosine = 1.0 + x * (-0.5 + x * (1.0 / 24.0 + x * (-1.0 / 720.0 + x * (1.0 / 40320.0))));
    let sine = angle * (1.0 + x * (-1.0 / 6.0 + x * (1.0 / 120.0 + x * (-1.0 / 5040.0))));
    [cosine, sine]
}

/// Cosine and sine of `u` turns, `u` in `[0, 1)`.
#[inline]
pub(in crate::path) fn turn(u: f32) -> [f32; 2] {
    let quarters = 4.0 * u;
    let nearest = floor(quarters + 0.5);
    let [cosine, sine] = eighth((quarters - nearest) * (2.0 * FRAC_PI_4));
    match nearest {
        1.0 => [-sine, cosine],
        2.0 => [-cosine, -sine],
        3.0 => [sine, -cosine],
        _ => [cosine, sine],
    }
}

/// The arc tangent of a number in `[0, 1]` in turns, over the number, as a polynomial of its square: a fit of least relative error, 1e-7.
const ARC_TANGENT: [f32; 8] = [
    0.159_154_92,
    -0.053_049_512,
    0.031_782_817,
    -0.022_312_757,
    0.015_779_234,
    -0.009_467_746,
    0.003_860_018_2,
    -0.000_746_992_36,
];

/// The value of the polynomial [`ARC_TANGENT`] at a square, for single numbers and one a lane. The terms go in pairs, which do not wait for one another.
#[inline(always)]
fn arc_tangent<T>(square: T) -> T
where
    T: Copy + Mul<Output = T> + Mul<f32, Output = T> + Add<Output = T> + Add<f32, Output = T>,
{
    let [a, b, c, d, e, f, g, h] = ARC_TANGENT;
    let fourth = square * square;
    let low = (square * b + a) + (square * d + c) * fourth;
    let high = (square * f + e) + (square * h + g) * fourth;
    low + high * (fourth * fourth)
}

/// The angle of the point `(x, y)` in turns, counted from the x axis towards the y axis: in `[0, 1]`, within 2e-7, and 0 for the
/// origin. The inverse of [`turn`].
#[inline]
pub(in crate::path) fn turns(y: f32, x: f32) -> f32 {
    let (wide, high) = (x.abs(), y.abs());
    let (low, large) = if high > wide {
        (wide, high)
    } else {
        (high, wide)
    };
    let q = if large > 0.0 { low / large } else { 0.0 };
    let s = q * q;
    let eighth = q * arc_tangent(s);
    let quarter = if high > wide { 0.25 - eighth } else { eighth };
    let half = if x < 0.0 { 0.5 - quarter } else { quarter };
    if y < 0.0 { 1.0 - half } else { half }
}

/// A direction of the upper hemisphere with density `cos / pi`: the square is mapped to the disk by
/// concentric squares,[^shirley] the disk lifted to the hemisphere.[^malley]
///
/// [^shirley]: Shirley, Peter; Chiu, Kenneth (1997). *A Low Distortion Map Between Disk and Square*.
///     <https://doi.org/10.1080/10867651.1997.10487479>
/// [^malley]: Malley, Thomas (1988). *A Shading Method for Computer Generated Images*. Master's thesis,
///     University of Utah.
#[inline]
pub(in crate::path) fn cosine_hemisphere([u, v]: [f32; 2]) -> Vec3A {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    let wide = a.abs() > b.abs();
    let (radius, other) = if wide { (a, b) } else { (b, a) };
    // A radius of zero has `other` zero too.
    let angle = FRAC_PI_4 * other / if radius == 0.0 { 1.0 } else { radius };
    let [cosine, sine] = eighth(angle);
    let (x, y) = if wide { (cosine, sine) } else { (sine, cosine) };
    Vec3A::new(
        radius * x,
        radius * y,
        (1.0 - radius * radius).max(0.0).sqrt(),
    )
}

/// The density of [`cosine_hemisphere`] at a direction with this cosine.
#[inline]
pub(in crate::path) fn cosine_density(cosine: f32) -> f32 {
    FRAC_1_PI * cosine
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_floor_is_that_of_the_standard_library() {
        let ends = [
            0.0,
            0.5,
            1.0,
            1.5,
            8_388_607.5,
            8_388_608.0,
            3e9,
            f32::INFINITY,
        ];
        let near = |x: f32| [x.next_down(), x, x.next_up()];
        for number in ends.into_iter().flat_map(near).flat_map(|x| [x, -x]) {
            assert_eq!(floor(number), number.floor(), "{number}");
        }
        assert!(floor(f32::NAN).is_nan());
    }

    #[test]
    fn turns_are_those_of_the_arc_tangent() {
        for step in 0..=100_000_u32 {
            let expected = f64::from(step) / 100_000.0;
            let (sine, cosine) = (core::f64::consts::TAU * expected).sin_cos();
            let found = turns(single_or_one(sine), single_or_one(cosine));
            let off = (f64::from(found) - expected).abs();
            assert!(
                off < 2e-7 || (off - 1.0).abs() < 2e-7,
                "{found}, not {expected}"
            );
        }
        assert_eq!(
            [turns(0.0, 0.0), turns(0.0, 2.0), turns(3.0, 0.0)],
            [0.0, 0.0, 0.25]
        );
        assert_eq!([turns(0.0, -2.0), turns(-1e30, 0.0)], [0.5, 0.75]);
        assert!((turns(1e30, 1e30) - 0.125).abs() < 1e-7);
        assert!((turns(-1e-30, -1e-30) - 0.625).abs() < 1e-7);
    }

    #[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
    fn single_or_one(x: f64) -> f32 {
        x as f32
    }
}
