//! The few operations on vectors of three components that the warps need.

pub(super) type Vector = [f64; 3];

pub(super) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross(a: Vector, b: Vector) -> Vector {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// `a + s b`.
pub(super) fn along(a: Vector, s: f64, b: Vector) -> Vector {
    [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]]
}

pub(super) fn minus(a: Vector, b: Vector) -> Vector {
    along(a, -1.0, b)
}

pub(super) fn length(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

/// `a` with length 1; not finite for a vector of length 0.
pub(super) fn unit(a: Vector) -> Vector {
    let length = length(a);
    a.map(|component| component / length)
}
