//! What the loops over single paths compute, a path a lane.

use core::f32::consts::FRAC_PI_4;

use pulp::Simd;

use crate::path::frame::lanes::eighth;
use crate::path::lanes::{Real, Vector};

/// The vector with the given coordinates in the [frame](crate::path::frame::Frame) around a normal.
#[inline(always)]
pub(super) fn around<S: Simd>(normal: Vector<S>, local: Vector<S>) -> Vector<S> {
    let one = normal.z.all(1.0);
    let sign = one.copysign(normal.z);
    let a = -1.0 / (sign + normal.z);
    let b = normal.x * normal.y * a;
    let tangent = Vector {
        x: 1.0 + sign * normal.x * normal.x * a,
        y: sign * b,
        z: -sign * normal.x,
    };
    let bitangent = Vector {
        x: b,
        y: sign + normal.y * normal.y * a,
        z: -normal.y,
    };
    tangent * local.x + bitangent * local.y + normal * local.z
}

/// As [`cosine_hemisphere`](crate::path::frame::cosine_hemisphere).
#[inline(always)]
pub(super) fn cosine_hemisphere<S: Simd>(u: Real<S>, v: Real<S>) -> Vector<S> {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    let (zero, one) = (u.all(0.0), u.all(1.0));
    let wide = a.abs().gt(b.abs());
    let (radius, other) = (wide.select(a, b), wide.select(b, a));
    let angle = FRAC_PI_4 * other / radius.eq(zero).select(one, radius);
    let [cosine, sine] = eighth(angle);
    Vector {
        x: radius * wide.select(cosine, sine),
        y: radius * wide.select(sine, cosine),
        z: (1.0 - radius * radius).max(zero).sqrt(),
    }
}

/// As the `power` of the loop over single paths.
#[inline(always)]
pub(super) fn power<S: Simd>(own: Real<S>, other: Real<S>) -> Real<S> {
    let (zero, one) = (own.all(0.0), own.all(1.0));
    let ratio = own.eq(other).select(one, other / own);
    own.gt(zero).select(1.0 / (1.0 + ratio * ratio), zero)
}
