//! Triangles and parallelograms.

use glam::{Vec2, Vec2Swizzles, Vec3A};

use super::near::{Near, Outline};
use super::{Shape, density_of_area};
use crate::Error;
use crate::path::ray::{Ray, Surface, gamma};
use crate::path::{Facet, Shading};

/// A triangle or a parallelogram: `corner + s * first_edge + t * second_edge` with `s, t` in `[0, 1]`, and
/// `s + t <= 1` for a triangle.
///
/// A ray finds `s` and `t` as the coordinates of its hit in the basis dual to the edges.[^baldwin] Hits
/// count up to the bound of their rounding error outside the edges, so that no ray slips between two neighbours.
///
/// [^baldwin]: Baldwin, Doug; Weber, Michael (2016). *Fast Ray-Triangle Intersections by Coordinate
///     Transformation*. <https://jcgt.org/published/0005/03/03/>
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flat {
    pub(in crate::path) corner: Vec3A,
    pub(in crate::path) normal: Vec3A,
    /// The dual basis: `first_dual . first_edge = 1`, `first_dual . second_edge = 0`, and the other way round.
    pub(in crate::path) first_dual: Vec3A,
    pub(in crate::path) second_dual: Vec3A,
    /// How far outside `[0, 1]` rounding may find the coordinates of a hit.
    pub(in crate::path) slack: [f32; 2],
    /// 1 for a triangle, 0 for a parallelogram: with it `s + slant * t <= 1` and `t + slant * s <= 1` hold
    /// inside either.
    pub(in crate::path) slant: f32,
    pub(in crate::path) first_edge: Vec3A,
    pub(in crate::path) second_edge: Vec3A,
    /// How far inside the edges points are kept: so far that a ray from there cannot miss a neighbour at the edge.
    pub(in crate::path) inset: [f32; 2],
    pub(in crate::path) margin: f32,
    pub(in crate::path) area: f32,
    /// Whether the edges have changed places, which texture coordinates do not follow.
    turned: bool,
    /// How it is drawn by solid angle; `None` if it is not.
    outline: Option<Outline>,
}

impl Flat {
    /// The parallelogram with a corner and the two edges from it.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for coordinates that are not finite and for edges that span no area.
    pub fn parallelogram(
        corner: [f32; 3],
        first_edge: [f32; 3],
        second_edge: [f32; 3],
    ) -> Result<Self, Error> {
        Self::new(
            Vec3A::from(corner),
            Vec3A::from(first_edge),
            Vec3A::from(second_edge),
            0.0,
        )
        .ok_or_else(|| {
            Error::refused(
                "parallelogram",
                "finite and of some area",
                format_args!("{corner:?} + {first_edge:?}, {second_edge:?}"),
            )
        })
    }

    /// The triangle with the given corners, counter-clockwise when seen from outside.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for coordinates that are not finite and for corners that span no area.
    pub fn triangle(corners: [[f32; 3]; 3]) -> Result<Self, Error> {
        let [a, b, c] = corners.map(Vec3A::from);
        Self::new(a, b - a, c - a, 1.0).ok_or_else(|| {
            Error::refused(
                "triangle",
                "finite and of some area",
                format_args!("{corners:?}"),
            )
        })
    }

    fn new(corner: Vec3A, first_edge: Vec3A, second_edge: Vec3A, slant: f32) -> Option<Self> {
        // In f64, so that the normal and the duals are rounded once only.
        let [first, second] = [first_edge, second_edge].map(|edge| edge.as_dvec3());
        let cross = first.cross(second);
        let squared = cross.length_squared();
        let normal = (cross / squared.sqrt()).as_vec3a();
        let first_dual = (second.cross(cross) / squared).as_vec3a();
        let second_dual = (cross.cross(first) / squared).as_vec3a();
        let edges = Edges {
            corner,
            first: first_edge,
            second: second_edge,
        };
        let margin = edges.margin(normal);
        let slack = [first_dual, second_dual].map(|dual| gamma(4) * dual.abs().dot(edges.extent()));
        let inset = inset(slack);
        let area = squared.sqrt() * if slant == 0.0 { 1.0 } else { 0.5 };
        let usable = squared > 0.0
            && (corner + first_edge + second_edge).is_finite()
            && first_dual.is_finite()
            && second_dual.is_finite();
        usable.then_some(Self {
            corner,
            normal,
            first_dual,
            second_dual,
            slack,
            slant,
            first_edge,
            second_edge,
            inset,
            margin,
            area: single(area),
            turned: false,
            outline: None,
        })
    }

    /// The solid angle that a small shape of this area in the middle would fill, seen from a point at some height above the plane;
    /// negative behind it.
    #[inline]
    pub(in crate::path) fn apparent(&self, from: Vec3A) -> f32 {
        let corner = self.corner - from;
        let edges = self.first_edge + self.second_edge;
        let to_middle = corner + edges * if self.slant > 0.0 { 1.0 / 3.0 } else { 0.5 };
        let squared = to_middle.length_squared();
        self.area * -corner.dot(self.normal) / (squared * squared.sqrt())
    }

    /// The longest edge, if it is to be drawn by solid angle where it is near.
    #[cfg(feature = "simd")]
    pub(in crate::path) fn longest_by_solid_angle(&self) -> Option<f32> {
        self.outline.map(Outline::longest)
    }

    /// The shape as `from` sees it, if it is to be drawn by solid angle.
    #[inline]
    fn near(&self, from: Vec3A) -> Option<Near> {
        self.outline?.near(self, from)
    }

    /// A point drawn by solid angle and its density, if the shape is to be drawn so from there.
    #[cfg(feature = "simd")]
    #[inline]
    pub(in crate::path) fn sample_near(&self, from: Vec3A, u: [f32; 2]) -> Option<(Vec3A, f32)> {
        let near = self.near(from)?;
        Some((self.at_near(&near, u).point, near.solid_angle().recip()))
    }

    /// The density of [`sample_near`](Self::sample_near).
    #[cfg(feature = "simd")]
    #[inline]
    pub(in crate::path) fn density_near(&self, from: Vec3A) -> Option<f32> {
        Some(self.near(from)?.solid_angle().recip())
    }

    #[inline]
    fn at_near(&self, near: &Near, u: [f32; 2]) -> Surface {
        let [s, t] = near.sample(self, u);
        self.at(s, t)
    }

    /// The point at `u`, uniform on the area.
    #[inline]
    pub(in crate::path) fn at_area(&self, [a, b]: [f32; 2]) -> Surface {
        if self.slant == 0.0 {
            return self.at(a, b);
        }
        if b > a {
            let s = 0.5 * a;
            self.at(s, b - s)
        } else {
            let t = 0.5 * b;
            self.at(a - t, t)
        }
    }

    /// The point with the coordinates `s` and `t` along the edges.
    #[inline]
    fn at(&self, s: f32, t: f32) -> Surface {
        Surface {
            point: self.corner + (self.first_edge * s + self.second_edge * t),
            normal: self.normal,
            margin: self.margin,
            detail: (),
        }
    }

    /// The coordinates of a point along the edges, in the order that they had before any turning.
    #[inline]
    fn along(&self, surface: &Surface) -> Vec2 {
        let inside = surface.point - self.corner;
        let along = Vec2::new(inside.dot(self.first_dual), inside.dot(self.second_dual));
        if self.turned { along.yx() } else { along }
    }

    /// The same points with the outer side on the other side, and the same texture coordinates.
    #[must_use]
    pub fn turned(self) -> Self {
        let turned = Self {
            normal: -self.normal,
            first_edge: self.second_edge,
            second_edge: self.first_edge,
            first_dual: self.second_dual,
            second_dual: self.first_dual,
            slack: [self.slack[1], self.slack[0]],
            inset: [self.inset[1], self.inset[0]],
            turned: !self.turned,
            ..self
        };
        match self.outline {
            None => turned,
            Some(_) => turned.by_solid_angle(),
        }
    }

    /// The same points, [drawn](Shape::sample) uniformly from the solid angle for what is near: for points on the outer side from which
    /// a small shape of this area in the middle would fill 0.2 steradians or more; straight above a square those closer than about
    /// twice its side. For others it makes no difference worth the time, and they go on drawing from the area. So do
    /// points closer to its plane than a hundredth of the longest edge, and all points in front of shapes thinner than a fiftieth of it, where `f32` has
    /// too few digits, and of parallelograms that are no rectangles.
    ///
    /// The scene does this to its lights; to those of scenes that could be traced many paths at once, and have no lights of other kinds, only if an eighth of the
    /// light that meets anything does so close to them.
    ///
    /// ```
    /// use estimand::path::shape::{Flat, Shape};
    ///
    /// let lamp = Flat::parallelogram([-1.0, -1.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0])?.by_solid_angle();
    /// // From the middle of a cube, a side fills a sixth of all directions.
    /// let middle = glam::Vec3A::Z;
    /// let point = lamp.sample(middle, [0.3, 0.8]);
    /// let all = 4.0 * std::f32::consts::PI;
    /// assert!((lamp.density(middle, &point) - 6.0 / all).abs() < 1e-6);
    /// # Ok::<(), estimand::Error>(())
    /// ```
    #[must_use]
    pub fn by_solid_angle(self) -> Self {
        Self {
            outline: Outline::of(&self),
            ..self
        }
    }
}

/// Where a triangle or parallelogram is.
#[derive(Clone, Copy, Debug)]
pub(in crate::path) struct Edges {
    pub(in crate::path) corner: Vec3A,
    pub(in crate::path) first: Vec3A,
    pub(in crate::path) second: Vec3A,
}

impl Edges {
    #[inline]
    fn extent(&self) -> Vec3A {
        self.corner.abs() + self.first.abs() + self.second.abs()
    }

    /// The margin of its points: each is rounded twice, the normal and a ray's way back to the plane a few times more.
    #[inline]
    pub(in crate::path) fn margin(&self, normal: Vec3A) -> f32 {
        gamma(8) * normal.abs().dot(self.extent())
    }
}

/// How far inside its edges points of a shape are kept, whose rays find coordinates up to `slack` outside.
#[inline]
pub(in crate::path) fn inset(slack: [f32; 2]) -> [f32; 2] {
    slack.map(|slack| (4.0 * slack).min(0.25))
}

/// Coordinates along the edges, brought back inside.
#[inline]
pub(in crate::path) fn kept_inside([s, t]: [f32; 2], inset: [f32; 2], slant: f32) -> [f32; 2] {
    let [low_s, low_t] = inset;
    let s = s.clamp(low_s, 1.0 - low_s);
    let t = t.clamp(low_t, 1.0 - low_t);
    // Past the slanted edge of a triangle: back towards the corner.
    let beyond = (slant * (s + t) + low_s.max(low_t)).max(1.0);
    [s / beyond, t / beyond]
}

#[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
fn single(x: f64) -> f32 {
    x as f32
}

impl Shape for Flat {
    fn bounds(&self) -> [Vec3A; 2] {
        let opposite = if self.slant == 0.0 {
            self.corner + (self.first_edge + self.second_edge)
        } else {
            self.corner
        };
        let corners = [
            self.corner + self.first_edge,
            self.corner + self.second_edge,
            opposite,
        ];
        corners
            .iter()
            .fold([self.corner; 2], |[low, high], &corner| {
                [low.min(corner), high.max(corner)]
            })
    }

    #[inline]
    fn intersect(&self, ray: &Ray, limit: f32) -> Option<f32> {
        let offset = self.corner - ray.origin;
        let distance = offset.dot(self.normal) * ray.direction.dot(self.normal).recip();
        let inside = ray.direction * distance - offset;
        let s = inside.dot(self.first_dual);
        let t = inside.dot(self.second_dual);
        let hit = distance > 0.0
            && distance < limit
            && s >= -self.slack[0]
            && t >= -self.slack[1]
            && s + self.slant * t <= 1.0 + self.slack[0]
            && t + self.slant * s <= 1.0 + self.slack[1];
        hit.then_some(distance)
    }

    #[inline]
    fn surface(&self, ray: &Ray, distance: f32) -> Surface {
        let inside = ray.direction * distance - (self.corner - ray.origin);
        let along = [inside.dot(self.first_dual), inside.dot(self.second_dual)];
        let [s, t] = kept_inside(along, self.inset, self.slant);
        self.at(s, t)
    }

    /// The texture coordinates are those along the edges.
    #[inline]
    fn shading(&self, surface: &Surface) -> Shading {
        let uv = self.along(surface);
        let (du, dv) = if self.turned {
            (self.second_edge, self.first_edge)
        } else {
            (self.first_edge, self.second_edge)
        };
        Shading {
            uv,
            normal: self.normal,
            du,
            dv,
            facet: Facet {
                triangle: 0,
                along: uv,
            },
        }
    }

    fn area(&self) -> f32 {
        self.area
    }

    /// Uniform on the area, or [on the solid angle](Flat::by_solid_angle). On the area a triangle takes the half of the square folded onto the other, without a
    /// square root.[^heitz]
    ///
    /// [^heitz]: Heitz, Eric (2019). *A Low-Distortion Map Between Triangle and Square*.
    ///     <https://hal.science/hal-02073696>
    #[inline]
    fn sample(&self, from: Vec3A, u: [f32; 2]) -> Surface {
        match self.near(from) {
            Some(near) => self.at_near(&near, u),
            None => self.at_area(u),
        }
    }

    #[inline]
    fn sample_with_density(&self, from: Vec3A, u: [f32; 2]) -> (Surface, f32) {
        match self.near(from) {
            Some(near) => (self.at_near(&near, u), near.solid_angle().recip()),
            None => {
                let surface = self.at_area(u);
                (surface, density_of_area(from, &surface, self.area))
            }
        }
    }

    #[inline]
    fn density(&self, from: Vec3A, surface: &Surface) -> f32 {
        match self.near(from) {
            Some(near) => near.solid_angle().recip(),
            None => density_of_area(from, surface, self.area),
        }
    }
}
