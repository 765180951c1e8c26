//! The directions to a rectangle.

use core::f64::consts::TAU;

use super::vector::{Vector, along, cross, dot, length, minus, unit};
use super::{Warp, coordinate, is_unit};
use crate::Error;

/// The directions from a point to a rectangle, uniform in solid angle.[^urena]
///
/// Rectangles that look smaller than about 1e-7 steradians lose digits to the angles' rounding.
///
/// ```
/// use estimand::warp::{SphericalRectangle, Warp};
///
/// // One side of a cube, seen from its centre.
/// let side = SphericalRectangle::new([-1.0, -1.0, 1.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0; 3])?;
/// assert!((side.solid_angle() - 4.0 * std::f64::consts::PI / 6.0).abs() < 1e-14);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^urena]: Ureña, Carlos; Fajardo, Marcos; King, Alan (2013). *An Area-Preserving Parametrization for
///     Spherical Rectangles*. <https://doi.org/10.1111/cgf.12151>
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphericalRectangle {
    /// Along the edges and away from the rectangle's plane.
    axes: [Vector; 3],
    /// The rectangle in these axes, seen from the origin: `x0..x1`, `y0..y1`, at `z0 < 0`.
    x: [f64; 2],
    y: [f64; 2],
    z: f64,
    /// The third components of the normals of the planes through the two long sides.
    b: [f64; 2],
    /// What the angles on the far side leave.
    k: f64,
    solid_angle: f64,
}

impl SphericalRectangle {
    /// The directions from `from` to the rectangle with a corner and two edges, which must be at a right angle.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] if the edges are not at a right angle, or if the rectangle has no solid angle as seen from
    /// there.
    pub fn new(
        corner: [f64; 3],
        edge_x: [f64; 3],
        edge_y: [f64; 3],
        from: [f64; 3],
    ) -> Result<Self, Error> {
        let (width, height) = (length(edge_x), length(edge_y));
        let skew = dot(edge_x, edge_y).abs() / (width * height);
        if skew.is_nan() || skew > 1e-6 {
            let domain = "at a right angle";
            let edges = format!("{edge_x:?} and {edge_y:?}");
            return Err(Error::refused("edges of a rectangle", domain, edges));
        }
        let (axis_x, axis_y) = (unit(edge_x), unit(edge_y));
        let mut axis_z = cross(axis_x, axis_y);
        let offset = minus(corner, from);
        if dot(offset, axis_z) > 0.0 {
            axis_z = axis_z.map(|component| -component);
        }
        let (x0, y0, z) = (
            dot(offset, axis_x),
            dot(offset, axis_y),
            dot(offset, axis_z),
        );
        let (x, y) = ([x0, x0 + width], [y0, y0 + height]);
        // The third components of the normals of the planes through the origin and each side.
        let slope = |side: f64| side / side.hypot(z);
        let ([x0, x1], [y0, y1]) = (x.map(slope), y.map(slope));
        let normals = [-y0, x1, y1, -x0];
        let angle = |i: usize, j: usize| (-normals[i] * normals[j]).clamp(-1.0, 1.0).acos();
        let [g0, g1, g2, g3] = [angle(0, 1), angle(1, 2), angle(2, 3), angle(3, 0)];
        let solid_angle = g0 + g1 + g2 + g3 - TAU;
        if !(solid_angle > 0.0 && z < 0.0) {
            return Err(Error::refused(
                "spherical rectangle",
                "a rectangle with a solid angle",
                format!("{corner:?} + {edge_x:?}, {edge_y:?} from {from:?}"),
            ));
        }
        Ok(Self {
            axes: [axis_x, axis_y, axis_z],
            x,
            y,
            z,
            b: [normals[0], normals[2]],
            k: TAU - g2 - g3,
            solid_angle,
        })
    }

    /// The solid angle in steradians.
    pub fn solid_angle(&self) -> f64 {
        self.solid_angle
    }

    /// Where `direction` meets the plane of the rectangle.
    fn meet(&self, direction: Vector) -> Option<[f64; 2]> {
        let [x, y, z] = self.axes.map(|axis| dot(axis, direction));
        let rounding = 1e-9 * (self.x[1] - self.x[0] + self.y[1] - self.y[0]);
        let (x, y) = (x * self.z / z, y * self.z / z);
        let within = |t: f64, [low, high]: [f64; 2]| t >= low - rounding && t <= high + rounding;
        (z < 0.0 && within(x, self.x) && within(y, self.y)).then_some([x, y])
    }
}

impl Warp<2> for SphericalRectangle {
    type Point = [f64; 3];

    fn sample(&self, [u, v]: [f64; 2]) -> [f64; 3] {
        let [b0, b1] = self.b;
        let (sin, cos) = (u * self.solid_angle + self.k).sin_cos();
        let f = (cos * b0 - b1) / sin;
        let cos_u = (1.0 / f.hypot(b0)).copysign(f).clamp(-1.0, 1.0);
        let x = -cos_u * self.z / (1.0 - cos_u * cos_u).max(f64::MIN_POSITIVE).sqrt();
        let x = x.clamp(self.x[0], self.x[1]);
        let square = x * x + self.z * self.z;
        let [h0, h1] = self.y.map(|y| y / (square + y * y).sqrt());
        let h = h0 + v * (h1 - h0);
        let y = if h * h < 1.0 - 1e-15 {
            h * square.sqrt() / (1.0 - h * h).sqrt()
        } else {
            self.y[1]
        };
        let y = y.clamp(self.y[0], self.y[1]);
        let [axis_x, axis_y, axis_z] = self.axes;
        let point = along(along(axis_z.map(|a| a * self.z), x, axis_x), y, axis_y);
        unit(point)
    }

    fn density(&self, direction: [f64; 3]) -> f64 {
        self.meet(direction).map_or(0.0, |_| 1.0 / self.solid_angle)
    }

    fn invert(&self, direction: [f64; 3]) -> Option<[f64; 2]> {
        let [x, y] = self.meet(direction).filter(|_| is_unit(direction))?;
        let square = x * x + self.z * self.z;
        let [h0, h1] = self.y.map(|y| y / (square + y * y).sqrt());
        let v = (y / (square + y * y).sqrt() - h0) / (h1 - h0);
        // The share of the solid angle up to x is that of the narrower rectangle.
        let [axis_x, axis_y, axis_z] = self.axes;
        let corner = along(
            along(axis_z.map(|a| a * self.z), self.x[0], axis_x),
            self.y[0],
            axis_y,
        );
        let edge_x = axis_x.map(|a| a * (x - self.x[0]));
        let edge_y = axis_y.map(|a| a * (self.y[1] - self.y[0]));
        let part = Self::new(corner, edge_x, edge_y, [0.0; 3]).map_or(0.0, |part| part.solid_angle);
        Some([coordinate(part / self.solid_angle), coordinate(v)])
    }
}
