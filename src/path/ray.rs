//! Rays and the points where they meet a surface.

use glam::Vec3A;

/// A half-line. The direction has length 1, so that the parameter of a point on it is its distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: Vec3A,
    /// Where it goes; of length 1.
    pub direction: Vec3A,
}

impl Ray {
    /// The point at `distance` from the origin.
    #[inline]
    pub fn at(&self, distance: f32) -> Vec3A {
        self.origin + self.direction * distance
    }
}

/// A point on a surface, known up to rounding, and how to leave it.
///
/// `D` is what a [law of scattering](super::bsdf::Bsdf::Detail) needs to know beyond that; nothing unless it is
/// named.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface<D = ()> {
    /// The point, as near to the surface as rounding allows.
    pub point: Vec3A,
    /// The normal of length 1, on the outer side of the shape.
    pub normal: Vec3A,
    /// A bound of the error of the point along the normal, and of the error with which a ray finds the surface
    /// again.
    pub margin: f32,
    /// What else is known of it.
    pub detail: D,
}

impl Surface {
    /// The same point with more known of it.
    #[inline]
    pub fn with<D>(self, detail: D) -> Surface<D> {
        Surface {
            point: self.point,
            normal: self.normal,
            margin: self.margin,
            detail,
        }
    }
}

impl<D> Surface<D> {
    /// Where a ray that leaves the surface in `direction` must start so as not to meet it again: a
    /// [`margin`](Self::margin) off the surface, on the side that the ray goes to.
    ///
    /// The margin follows from the rounding errors of the coordinates involved, nothing else: it scales and
    /// moves with the scene.[^pbrt]
    ///
    /// [^pbrt]: Pharr, Matt; Jakob, Wenzel; Humphreys, Greg (2023). *Physically Based Rendering*, 4th edition, section
    ///     6.8. <https://pbr-book.org/4ed/Shapes/Managing_Rounding_Error>
    #[inline]
    pub fn leave(&self, direction: Vec3A) -> Vec3A {
        self.point + self.normal * self.margin.copysign(self.normal.dot(direction))
    }
}

/// A bound of the relative error of `operations` roundings to `f32` in a row.[^higham]
///
/// [^higham]: Higham, Nicholas (2002). *Accuracy and Stability of Numerical Algorithms*, 2nd edition, section 3.1.
///     <https://doi.org/10.1137/1.9780898718027>
pub const fn gamma(operations: u16) -> f32 {
    let error = operations as f32 * (0.5 * f32::EPSILON);
    error / (1.0 - error)
}
