//! The directions to a triangle.

use core::f64::consts::PI;

use super::vector::{Vector, along, cross, dot, length, minus, unit};
use super::{Warp, coordinate, is_unit};
use crate::Error;

/// The directions from a point to a triangle, uniform in solid angle.[^arvo]
///
/// Triangles that look smaller than about 1e-7 steradians lose digits to the angles' rounding: sample their
/// [area](super::Triangle) instead.
///
/// ```
/// use estimand::warp::{SphericalTriangle, Warp};
///
/// let octant = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let octant = SphericalTriangle::new(octant, [0.0; 3])?;
/// assert!((octant.solid_angle() - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^arvo]: Arvo, James (1995). *Stratified Sampling of Spherical Triangles*. <https://doi.org/10.1145/218380.218500>
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphericalTriangle {
    corners: [Vector; 3],
    /// The angle at the first corner.
    alpha: f64,
    /// The tangent of half the side opposite the third corner.
    tan_half_side: f64,
    solid_angle: f64,
}

impl SphericalTriangle {
    /// The directions from `from` to the triangle with three corners.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] if the triangle has no solid angle as seen from there.
    pub fn new(corners: [[f64; 3]; 3], from: [f64; 3]) -> Result<Self, Error> {
        let [a, b, c] = corners.map(|corner| unit(minus(corner, from)));
        let [ab, bc, ca] = [cross(a, b), cross(b, c), cross(c, a)].map(unit);
        let angle = |n: Vector, m: Vector| length(cross(n, m)).atan2(-dot(n, m));
        let (alpha, beta, gamma) = (angle(ab, ca), angle(ab, bc), angle(bc, ca));
        let solid_angle = alpha + beta + gamma - PI;
        // To rounding none, or all of one side: the point is in the plane of the triangle.
        if !(1e-15..2.0 * PI - 1e-14).contains(&solid_angle) {
            return Err(Error::refused(
                "spherical triangle",
                "a triangle with a solid angle",
                format!("{corners:?} from {from:?}"),
            ));
        }
        Ok(Self {
            corners: [a, b, c],
            alpha,
            tan_half_side: length(minus(a, b)) / length(along(a, 1.0, b)),
            solid_angle,
        })
    }

    /// The solid angle in steradians.
    pub fn solid_angle(&self) -> f64 {
        self.solid_angle
    }
}

/// The unit vector orthogonal to `axis` in the plane of `axis` and `v`, on the side of `v`.
fn orthogonal(v: Vector, axis: Vector) -> Vector {
    unit(along(v, -dot(v, axis), axis))
}

/// The direction at the angle with this cosine and sine from `axis`, in the plane of `axis` and `toward`.
fn beside(axis: Vector, toward: Vector, cos: f64, sin: f64) -> Vector {
    along(axis.map(|x| x * cos), sin, orthogonal(toward, axis))
}

impl Warp<2> for SphericalTriangle {
    type Point = [f64; 3];

    fn sample(&self, [u, v]: [f64; 2]) -> [f64; 3] {
        let [a, b, c] = self.corners;
        // The corner of the triangle with the share u of the solid angle, on the side from a to c: the tangents of half the sides and of
        // half the solid angle tell how far, and keep their digits where the three corners are nearly in one plane.
        let half = 0.5 * u * self.solid_angle;
        let (sin_half, rest) = (half.sin(), self.tan_half_side * (self.alpha - half).sin());
        let square = rest * rest + sin_half * sin_half;
        let corner = beside(
            a,
            c,
            (rest - sin_half) * (rest + sin_half) / square,
            2.0 * rest * sin_half / square,
        );
        let away = length(minus(corner, b));
        let less = 0.5 * v * away * away;
        unit(beside(
            b,
            corner,
            1.0 - less,
            (less * (2.0 - less)).max(0.0).sqrt(),
        ))
    }

    fn density(&self, direction: [f64; 3]) -> f64 {
        let [a, b, c] = self.corners;
        // Inside all three sides, whichever way round the corners are.
        let turn = dot(cross(a, b), c).signum();
        let inside = [(a, b), (b, c), (c, a)]
            .into_iter()
            .all(|(from, to)| turn * dot(cross(from, to), direction) >= -1e-12);
        if inside { 1.0 / self.solid_angle } else { 0.0 }
    }

    fn invert(&self, direction: [f64; 3]) -> Option<[f64; 2]> {
        if !is_unit(direction) || self.density(direction) == 0.0 {
            return None;
        }
        let [a, b, c] = self.corners;
        // The corner on the side from a to c that lies behind the direction, seen from b.
        let corner = unit(cross(cross(b, direction), cross(c, a)));
        let corner = if dot(corner, along(a, 1.0, c)) < 0.0 {
            corner.map(|x| -x)
        } else {
            corner
        };
        let across = 1.0 - dot(corner, b);
        let v = if across > 0.0 {
            (1.0 - dot(direction, b)) / across
        } else {
            0.0
        };
        if length(minus(corner, a)) < 1e-12 {
            return Some([0.0, coordinate(v)]);
        }
        let part = Self::new([a, b, corner], [0.0; 3]).map_or(0.0, |part| part.solid_angle);
        Some([coordinate(part / self.solid_angle), coordinate(v)])
    }
}
