//! Disks.

use core::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3A};

use super::{Shape, density_of_area};
use crate::Error;
use crate::path::frame::{single, turns};
use crate::path::ray::{Ray, Surface, gamma};
use crate::path::{Facet, Shading};
use crate::warp::{Disk as UnitDisk, Warp};

/// A disk or an ellipse: `center + s * first + t * second` with `s^2 + t^2 <= 1`.
///
/// The texture coordinates are the distance from the centre and the azimuth, both in `[0, 1]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disk {
    pub(in crate::path) center: Vec3A,
    pub(in crate::path) normal: Vec3A,
    first: Vec3A,
    second: Vec3A,
    /// `first_dual . first = 1`, `first_dual . second = 0`, and the other way round.
    pub(in crate::path) first_dual: Vec3A,
    pub(in crate::path) second_dual: Vec3A,
    /// How far outside 1 rounding may find the distance of a hit from the centre.
    pub(in crate::path) slack: f32,
    margin: f32,
    area: f32,
}

impl Disk {
    /// The ellipse around `center` with two half axes; the outer side is that of `first x second`.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for coordinates that are not finite and for half axes that span no area.
    pub fn new(center: [f32; 3], first: [f32; 3], second: [f32; 3]) -> Result<Self, Error> {
        let [c, a, b] = [center, first, second].map(Vec3A::from);
        let [first_64, second_64] = [a, b].map(|axis| axis.as_dvec3());
        let cross = first_64.cross(second_64);
        let squared = cross.length_squared();
        let normal = (cross / squared.sqrt()).as_vec3a();
        let first_dual = (second_64.cross(cross) / squared).as_vec3a();
        let second_dual = (cross.cross(first_64) / squared).as_vec3a();
        let extent = c.abs() + a.abs() + b.abs();
        let usable = squared > 0.0
            && extent.is_finite()
            && first_dual.is_finite()
            && second_dual.is_finite();
        if !usable {
            return Err(Error::refused(
                "disk",
                "finite and of some area",
                format_args!("{center:?} + {first:?}, {second:?}"),
            ));
        }
        #[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
        let area = (f64::from(PI) * squared.sqrt()) as f32;
        Ok(Self {
            center: c,
            normal,
            first: a,
            second: b,
            first_dual,
            second_dual,
            slack: gamma(8) * (first_dual.abs() + second_dual.abs()).dot(extent),
            margin: gamma(8) * normal.abs().dot(extent),
            area,
        })
    }

    /// The same points with the outer side on the other side, and the same texture coordinates.
    #[must_use]
    pub fn turned(self) -> Self {
        Self {
            normal: -self.normal,
            ..self
        }
    }

    #[inline]
    fn at(&self, s: f32, t: f32) -> Surface {
        Surface {
            point: self.center + (self.first * s + self.second * t),
            normal: self.normal,
            margin: self.margin,
            detail: (),
        }
    }

    /// The coordinates along the half axes of a point relative to the centre.
    #[inline]
    fn along(&self, inside: Vec3A) -> [f32; 2] {
        [inside.dot(self.first_dual), inside.dot(self.second_dual)]
    }
}

impl Shape for Disk {
    fn bounds(&self) -> [Vec3A; 2] {
        let squares = self.first * self.first + self.second * self.second;
        let half = squares.map(f32::sqrt) * (1.0 + gamma(8));
        [self.center - half, self.center + half]
    }

    #[inline]
    fn intersect(&self, ray: &Ray, limit: f32) -> Option<f32> {
        let offset = self.center - ray.origin;
        let distance = offset.dot(self.normal) / ray.direction.dot(self.normal);
        let [s, t] = self.along(ray.direction * distance - offset);
        let hit = distance > 0.0
            && distance < limit
            && s * s + t * t <= (1.0 + self.slack) * (1.0 + self.slack);
        hit.then_some(distance)
    }

    #[inline]
    fn surface(&self, ray: &Ray, distance: f32) -> Surface {
        let [s, t] = self.along(ray.direction * distance - (self.center - ray.origin));
        let beyond = (s * s + t * t).sqrt().max(1.0);
        self.at(s / beyond, t / beyond)
    }

    fn shading(&self, surface: &Surface) -> Shading {
        let [s, t] = self.along(surface.point - self.center);
        let radius = (s * s + t * t).sqrt();
        let [cosine, sine] = if radius > 0.0 {
            [s / radius, t / radius]
        } else {
            [1.0, 0.0]
        };
        Shading {
            uv: Vec2::new(radius, turns(t, s)),
            normal: self.normal,
            du: self.first * cosine + self.second * sine,
            dv: (self.second * cosine - self.first * sine) * (TAU * radius),
            facet: Facet::default(),
        }
    }

    fn area(&self) -> f32 {
        self.area
    }

    /// Uniform on the area.
    #[inline]
    fn sample(&self, _: Vec3A, u: [f32; 2]) -> Surface {
        let [s, t] = UnitDisk.sample(u.map(f64::from)).map(single);
        self.at(s, t)
    }

    #[inline]
    fn density(&self, from: Vec3A, surface: &Surface) -> f32 {
        density_of_area(from, surface, self.area)
    }
}
