//! Spheres.

use core::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3A};

use super::{Shape, density_of_area};
use crate::Error;
use crate::path::frame::{Frame, turn, turns};
use crate::path::ray::{Ray, Surface, gamma};
use crate::path::{Facet, Shading};

/// A sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    center: Vec3A,
    radius: f32,
    squared_radius: f32,
    /// The axes of its texture coordinates.
    axes: [Vec3A; 3],
    /// 1, or -1 if the outer side is inside.
    side: f32,
}

impl Sphere {
    /// The sphere with the given centre and radius.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a centre that is not finite, and for a radius whose square is not positive and
    /// finite.
    pub fn new(center: [f32; 3], radius: f32) -> Result<Self, Error> {
        let squared_radius = radius * radius;
        if !(radius > 0.0 && squared_radius > 0.0 && squared_radius.is_finite()) {
            return Err(Error::refused(
                "radius of a sphere",
                "positive, with a square that is neither zero nor infinite",
                radius,
            ));
        }
        let center_ = Vec3A::from(center);
        if !center_.is_finite() {
            return Err(Error::refused(
                "centre of a sphere",
                "finite",
                format_args!("{center:?}"),
            ));
        }
        Ok(Self {
            center: center_,
            radius,
            squared_radius,
            axes: [Vec3A::X, Vec3A::Y, Vec3A::Z],
            side: 1.0,
        })
    }

    /// The same with texture coordinates that are turned: around `pole` in place of the z axis, from `start` in place of the x
    /// axis.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for two vectors that are not finite or that have one direction.
    pub fn with_axes(self, start: Vec3A, pole: Vec3A) -> Result<Self, Error> {
        let (start_64, pole_64) = (start.as_dvec3(), pole.as_dvec3().normalize());
        let across = (start_64 - pole_64 * pole_64.dot(start_64)).normalize();
        if !across.is_finite() {
            return Err(Error::refused(
                "axes of a sphere",
                "finite, of two directions",
                format_args!("{start} and {pole}"),
            ));
        }
        Ok(Self {
            axes: [across, pole_64.cross(across), pole_64].map(|axis| axis.as_vec3a()),
            ..self
        })
    }

    /// The same points with texture coordinates that go round the other way.
    #[must_use]
    pub fn mirrored(mut self) -> Self {
        self.axes[1] = -self.axes[1];
        self
    }

    /// The same points with the outer side inside, and the same texture coordinates.
    #[must_use]
    pub fn turned(self) -> Self {
        Self {
            side: -self.side,
            ..self
        }
    }

    /// The centre.
    pub fn center(&self) -> Vec3A {
        self.center
    }

    /// The radius.
    pub fn radius(&self) -> f32 {
        self.radius
    }

    #[inline]
    pub(in crate::path) fn squared_radius(&self) -> f32 {
        self.squared_radius
    }

    /// Whether a point at this squared distance from the centre is inside, or on the sphere up to rounding: there
    /// is no cone that the sphere fills.
    #[inline]
    fn holds(&self, squared: f32) -> bool {
        let margin = gamma(8) * (self.center.abs().element_sum() + 2.0 * self.radius);
        let reach = self.radius + margin;
        squared <= reach * reach
    }

    #[inline]
    fn toward(&self, outward: Vec3A) -> Surface {
        Surface {
            point: self.center + outward * self.radius,
            normal: outward * self.side,
            margin: gamma(8) * (outward.abs().dot(self.center.abs()) + 2.0 * self.radius),
            detail: (),
        }
    }
}

impl Shape for Sphere {
    fn bounds(&self) -> [Vec3A; 2] {
        [self.center - self.radius, self.center + self.radius]
    }

    /// The quadratic equation, in the form that keeps its digits for small and far spheres.[^haines]
    ///
    /// [^haines]: Haines, Eric; Günther, Johannes; Akenine-Möller, Tomas (2019). *Precision Improvements for
    ///     Ray/Sphere Intersection*. <https://doi.org/10.1007/978-1-4842-4427-2_7>
    #[inline]
    fn intersect(&self, ray: &Ray, limit: f32) -> Option<f32> {
        let offset = self.center - ray.origin;
        let middle = offset.dot(ray.direction);
        let apart = offset - ray.direction * middle;
        let discriminant = self.squared_radius - apart.length_squared();
        if discriminant < 0.0 {
            return None;
        }
        let far = middle + discriminant.sqrt().copysign(middle);
        let near = (offset.length_squared() - self.squared_radius) / far;
        let (first, second) = if near < far { (near, far) } else { (far, near) };
        let distance = if first > 0.0 { first } else { second };
        (distance > 0.0 && distance < limit).then_some(distance)
    }

    #[inline]
    fn surface(&self, ray: &Ray, distance: f32) -> Surface {
        self.toward((ray.at(distance) - self.center).normalize())
    }

    /// The texture coordinates are the azimuth around the z axis and the angle from it, over `2 pi` and `pi`, unless
    /// [turned](Sphere::with_axes).
    fn shading(&self, surface: &Surface) -> Shading {
        let outward = surface.normal * self.side;
        let [first, second, pole] = self.axes;
        let [x, y, z] = self.axes.map(|axis| axis.dot(outward));
        let radius = (x * x + y * y).sqrt();
        // The azimuth of a pole is that of the first axis.
        let [cosine, sine] = if radius > 0.0 {
            [x / radius, y / radius]
        } else {
            [1.0, 0.0]
        };
        let around = second * cosine - first * sine;
        let away = first * cosine + second * sine;
        Shading {
            uv: Vec2::new(turns(y, x), 2.0 * turns(radius, z)),
            normal: surface.normal,
            du: around * (TAU * radius * self.radius),
            dv: (away * z - pole * radius) * (PI * self.radius),
            facet: Facet::default(),
        }
    }

    fn area(&self) -> f32 {
        4.0 * PI * self.squared_radius
    }

    /// From outside uniform in the cone that the sphere fills,[^shirley] from inside and on it uniform on the area.
    ///
    /// [^shirley]: Shirley, Peter; Wang, Changyaw; Zimmerman, Kurt (1996). *Monte Carlo Techniques for Direct
    ///     Lighting Calculations*. <https://doi.org/10.1145/226150.226151>
    #[inline]
    fn sample(&self, from: Vec3A, [a, b]: [f32; 2]) -> Surface {
        let offset = from - self.center;
        let squared = offset.length_squared();
        let [cosine, sine] = turn(b);
        if self.holds(squared) {
            let z = 1.0 - 2.0 * a;
            let r = (1.0 - z * z).max(0.0).sqrt();
            return self.toward(Vec3A::new(r * cosine, r * sine, z));
        }
        // The angle `theta` at `from`, of the cone's half angle; then `alpha` at the centre.
        let squared_sine_max = self.squared_radius / squared;
        let one_minus_cosine = a * one_minus_cosine(squared_sine_max);
        let squared_sine = one_minus_cosine * (2.0 - one_minus_cosine);
        let cosine_alpha = squared_sine / squared_sine_max.sqrt()
            + (1.0 - one_minus_cosine) * (1.0 - squared_sine / squared_sine_max).max(0.0).sqrt();
        let sine_alpha = (1.0 - cosine_alpha * cosine_alpha).max(0.0).sqrt();
        let local = Vec3A::new(sine_alpha * cosine, sine_alpha * sine, cosine_alpha);
        self.toward(Frame::around(offset / squared.sqrt()).out(local))
    }

    #[inline]
    fn density(&self, from: Vec3A, surface: &Surface) -> f32 {
        let squared = (from - self.center).length_squared();
        if self.holds(squared) {
            return density_of_area(from, surface, self.area());
        }
        0.5 / (PI * one_minus_cosine(self.squared_radius / squared))
    }
}

/// `1 - cos` of the angle with the given squared sine, below a right angle, without cancellation.
#[inline]
fn one_minus_cosine(squared_sine: f32) -> f32 {
    squared_sine / (1.0 + (1.0 - squared_sine).max(0.0).sqrt())
}
