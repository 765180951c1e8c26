//! Angles, one a lane, with the bits of single ones.

use core::f32::consts::FRAC_PI_2;

use pulp::Simd;

use super::arc_tangent;
use crate::path::lanes::Real;

/// As [`turn`](super::turn).
#[inline(always)]
pub(in crate::path) fn turn<S: Simd>(u: Real<S>) -> [Real<S>; 2] {
    let quarters = 4.0 * u;
    let up = quarters + 0.5;
    let (zero, one) = (u.all(0.0), u.all(1.0));
    let (first, second) = (up.ge(one), up.ge(u.all(2.0)));
    let (third, fourth) = (up.ge(u.all(3.0)), up.ge(u.all(4.0)));
    let nearest = first.select(one, zero)
        + second.select(one, zero)
        + third.select(one, zero)
        + fourth.select(one, zero);
    let angle = (quarters - nearest) * FRAC_PI_2;
    let [cosine, sine] = eighth(angle);
    // A quarter further for each that is past.
    let odd = (first & !second) | (third & !fourth);
    let (x, y) = (odd.select(sine, cosine), odd.select(cosine, sine));
    let (left, below) = (first & !third, second & !fourth);
    [left.select(-x, x), below.select(-y, y)]
}

/// Cosine and sine, as in [`turn`](super::turn).
#[inline(always)]
pub(in crate::path) fn eighth<S: Simd>(angle: Real<S>) -> [Real<S>; 2] {
    let x = angle * angle;
    let cosine = 1.0 + x * (-0.5 + x * (1.0 / 24.0 + x * (-1.0 / 720.0 + x * (1.0 / 40320.0))));
    let sine = angle * (1.0 + x * (-1.0 / 6.0 + x * (1.0 / 120.0 + x * (-1.0 / 5040.0))));
    [cosine, sine]
}

/// As [`turns`](super::turns).
#[inline(always)]
pub(in crate::path) fn turns<S: Simd>(y: Real<S>, x: Real<S>) -> Real<S> {
    let (zero, one) = (x.all(0.0), x.all(1.0));
    let (wide, high) = (x.abs(), y.abs());
    let steep = high.gt(wide);
    let (low, large) = (steep.select(wide, high), steep.select(high, wide));
    let some = large.gt(zero);
    let q = some.select(low / some.select(large, one), zero);
    let s = q * q;
    let eighth = q * arc_tangent(s);
    let quarter = steep.select(0.25 - eighth, eighth);
    let half = x.lt(zero).select(0.5 - quarter, quarter);
    y.lt(zero).select(1.0 - half, half)
}
