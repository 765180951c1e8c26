//! Cylinders.

use core::f32::consts::TAU;

use glam::{Vec2, Vec3A};

use super::{Shape, density_of_area};
use crate::Error;
use crate::path::frame::{Frame, turn, turns};
use crate::path::ray::{Ray, Surface, gamma};
use crate::path::{Facet, Shading};

/// The side of a cylinder, without lids.
///
/// The texture coordinates are the azimuth and the height, both in `[0, 1]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    pub(in crate::path) start: Vec3A,
    /// Across, across, and along, of length 1.
    pub(in crate::path) axes: [Vec3A; 3],
    pub(in crate::path) radius: f32,
    pub(in crate::path) length: f32,
    /// 1, or -1 if the outer side is inside.
    side: f32,
    /// What the margin follows from.
    extent: Vec3A,
}

impl Cylinder {
    /// The cylinder from one point to another; the azimuth is counted from a direction that is as good as any.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for points that are not finite or coincide, and for a radius whose square is not positive and
    /// finite.
    pub fn new(start: [f32; 3], end: [f32; 3], radius: f32) -> Result<Self, Error> {
        let [a, b] = [start, end].map(|point| Vec3A::from(point).as_dvec3());
        let along = (b - a).normalize_or_zero().as_vec3a();
        let frame = Frame::around(along);
        Self::placed(start, end, radius, frame.out(Vec3A::X))
    }

    /// The same, with the azimuth counted from the direction `across`, or the nearest that is at right angles to the axis.
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new), and for a direction along the axis.
    pub fn placed(
        start: [f32; 3],
        end: [f32; 3],
        radius: f32,
        across: Vec3A,
    ) -> Result<Self, Error> {
        if !(radius > 0.0 && radius * radius > 0.0 && (radius * radius).is_finite()) {
            return Err(Error::refused(
                "radius of a cylinder",
                "positive, with a square that is neither zero nor infinite",
                radius,
            ));
        }
        let [a, b] = [start, end].map(|point| Vec3A::from(point).as_dvec3());
        let length = a.distance(b);
        let along = (b - a) / length;
        let across = across.as_dvec3();
        let first = (across - along * along.dot(across)).normalize();
        let axes = [first, along.cross(first), along].map(|axis| axis.as_vec3a());
        if !(length > 0.0 && axes.iter().all(|axis| axis.is_finite())) {
            return Err(Error::refused(
                "cylinder",
                "finite and of some length",
                format_args!("from {start:?} to {end:?}"),
            ));
        }
        #[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
        let length = length as f32;
        let start = Vec3A::from(start);
        let extent =
            start.abs() + (axes[0].abs() + axes[1].abs()) * (2.0 * radius) + axes[2].abs() * length;
        Ok(Self {
            start,
            axes,
            radius,
            length,
            side: 1.0,
            extent,
        })
    }

    /// The same points with the outer side on the other side, and the same texture coordinates.
    #[must_use]
    pub fn turned(self) -> Self {
        Self {
            side: -self.side,
            ..self
        }
    }

    /// The same points with texture coordinates that go round the other way.
    #[must_use]
    pub fn mirrored(mut self) -> Self {
        self.axes[1] = -self.axes[1];
        self
    }

    /// A vector in the axes of the cylinder.
    #[inline]
    fn local(&self, vector: Vec3A) -> [f32; 3] {
        self.axes.map(|axis| axis.dot(vector))
    }

    /// The point at a height, in the direction with the given cosine and sine.
    #[inline]
    fn at(&self, [cosine, sine]: [f32; 2], height: f32) -> Surface {
        let outward = self.axes[0] * cosine + self.axes[1] * sine;
        Surface {
            point: self.start + (outward * self.radius + self.axes[2] * height),
            normal: outward * self.side,
            margin: gamma(16) * outward.abs().dot(self.extent),
            detail: (),
        }
    }
}

impl Shape for Cylinder {
    fn bounds(&self) -> [Vec3A; 2] {
        let end = self.start + self.axes[2] * self.length;
        let squares = self.axes[0] * self.axes[0] + self.axes[1] * self.axes[1];
        let reach = squares.map(f32::sqrt) * self.radius + self.extent * gamma(16);
        [self.start.min(end) - reach, self.start.max(end) + reach]
    }

    /// The quadratic equation in the plane across, as [`Sphere`](super::Sphere) has it in space.
    #[inline]
    fn intersect(&self, ray: &Ray, limit: f32) -> Option<f32> {
        let [x, y, z] = self.local(ray.origin - self.start);
        let [dx, dy, dz] = self.local(ray.direction);
        let speed = (dx * dx + dy * dy).sqrt();
        // Along the axis there is nothing to be hit.
        if speed == 0.0 {
            return None;
        }
        let (dx, dy) = (dx / speed, dy / speed);
        let middle = -(x * dx + y * dy);
        let apart = [x + dx * middle, y + dy * middle];
        let discriminant = self.radius * self.radius - (apart[0] * apart[0] + apart[1] * apart[1]);
        if discriminant < 0.0 {
            return None;
        }
        let far = middle + discriminant.sqrt().copysign(middle);
        let near = (x * x + y * y - self.radius * self.radius) / far;
        let (first, second) = if near < far { (near, far) } else { (far, near) };
        let slack = gamma(8) * (self.length + z.abs());
        [first / speed, second / speed]
            .into_iter()
            .find(|&distance| {
                let height = z + distance * dz;
                distance > 0.0 && height >= -slack && height <= self.length + slack
            })
            .filter(|&distance| distance < limit)
    }

    #[inline]
    fn surface(&self, ray: &Ray, distance: f32) -> Surface {
        let [x, y, z] = self.local(ray.at(distance) - self.start);
        let radius = (x * x + y * y).sqrt();
        self.at([x / radius, y / radius], z.clamp(0.0, self.length))
    }

    fn shading(&self, surface: &Surface) -> Shading {
        let [x, y, z] = self.local(surface.point - self.start);
        Shading {
            uv: Vec2::new(turns(y, x), z / self.length),
            normal: surface.normal,
            du: (self.axes[1] * x - self.axes[0] * y) * TAU,
            dv: self.axes[2] * self.length,
            facet: Facet::default(),
        }
    }

    fn area(&self) -> f32 {
        TAU * self.radius * self.length
    }

    /// Uniform on the area.
    #[inline]
    fn sample(&self, _: Vec3A, [a, b]: [f32; 2]) -> Surface {
        self.at(turn(a), b * self.length)
    }

    #[inline]
    fn density(&self, from: Vec3A, surface: &Surface) -> f32 {
        density_of_area(from, surface, self.area())
    }
}
