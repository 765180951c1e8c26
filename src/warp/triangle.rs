//! A triangle in space.

use super::vector::{Vector, along, cross, dot, length, minus};
use super::{Warp, coordinate};
use crate::Error;

/// A triangle in space, uniform in area.
///
/// ```
/// use estimand::warp::{Triangle, Warp};
///
/// let triangle = Triangle::new([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]])?;
/// assert_eq!(triangle.density([0.1, 0.1, 0.0]), 1.0);
/// # Ok::<(), estimand::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    corner: Vector,
    edges: [Vector; 2],
    normal: Vector,
    area: f64,
}

impl Triangle {
    /// The triangle with three corners.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for corners that are not finite or that lie in a line.
    pub fn new(corners: [[f64; 3]; 3]) -> Result<Self, Error> {
        let [a, b, c] = corners;
        let edges = [minus(b, a), minus(c, a)];
        let normal = cross(edges[0], edges[1]);
        let area = 0.5 * length(normal);
        if !(area > 0.0 && area.is_finite()) {
            let domain = "corners of a triangle with an area";
            return Err(Error::refused("triangle", domain, format!("{corners:?}")));
        }
        Ok(Self {
            corner: a,
            edges,
            normal,
            area,
        })
    }

    /// The weights of the edges at a point in the plane of the triangle.
    fn weights(&self, point: Vector) -> [f64; 2] {
        let offset = minus(point, self.corner);
        let square = dot(self.normal, self.normal);
        [
            dot(cross(offset, self.edges[1]), self.normal) / square,
            dot(cross(self.edges[0], offset), self.normal) / square,
        ]
    }
}

impl Warp<2> for Triangle {
    type Point = [f64; 3];

    #[inline]
    fn sample(&self, [u, v]: [f64; 2]) -> [f64; 3] {
        let root = (1.0 - u).sqrt();
        let point = along(self.corner, 1.0 - root, self.edges[0]);
        along(point, v * root, self.edges[1])
    }

    /// The reciprocal of the area; the point is taken to lie in the plane of the triangle.
    #[inline]
    fn density(&self, point: [f64; 3]) -> f64 {
        let [a, b] = self.weights(point);
        let rounding = 1e-12;
        if a >= -rounding && b >= -rounding && a + b <= 1.0 + rounding {
            1.0 / self.area
        } else {
            0.0
        }
    }

    fn invert(&self, point: [f64; 3]) -> Option<[f64; 2]> {
        if self.density(point) == 0.0 {
            return None;
        }
        let [a, b] = self.weights(point);
        let root = 1.0 - a;
        let v = if root > 0.0 { b / root } else { 0.0 };
        Some([coordinate(1.0 - root * root), coordinate(v)])
    }
}
