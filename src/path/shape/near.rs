//! Flat shapes seen from nearby, whose points are drawn uniformly from the solid angle that they fill.

use core::f32::consts::TAU;

use glam::Vec3A;

#[cfg(feature = "simd")]
pub(super) mod lanes;

use super::Flat;
use crate::path::frame::{turn, turns};

/// How a [`Flat`] may be drawn by solid angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Outline {
    /// With edges at right angles, of these lengths.
    Rectangle { lengths: [f32; 2] },
    /// Whose longest edge has this length.
    Triangle { longest: f32 },
}

impl Outline {
    /// `None` for a parallelogram that is no rectangle, since there is no closed form, and for thin shapes, which lose too many
    /// digits.
    pub(super) fn of(flat: &Flat) -> Option<Self> {
        let [first, second] = [flat.first_edge, flat.second_edge];
        let lengths = [first, second].map(Vec3A::length);
        let outline = if flat.slant > 0.0 {
            Self::Triangle {
                longest: lengths[0].max(lengths[1]).max(first.distance(second)),
            }
        } else {
            Self::Rectangle { lengths }
        };
        let longest = outline.longest();
        let width = flat.area / (longest * if flat.slant > 0.0 { 0.5 } else { 1.0 });
        let skew = first.dot(second).abs();
        let closed = flat.slant > 0.0 || skew <= 1e-6 * lengths[0] * lengths[1];
        (closed && width > THINNEST * longest).then_some(outline)
    }

    /// The longest edge.
    #[inline]
    pub(super) fn longest(self) -> f32 {
        match self {
            Self::Rectangle { lengths } => lengths[0].max(lengths[1]),
            Self::Triangle { longest } => longest,
        }
    }

    /// The shape as `from` sees it, if that is on its outer side and near: from afar, and from beside it, the solid angle is small,
    /// so that nothing is to be gained and digits are to be lost. They are lost in its plane as well.
    #[inline]
    pub(super) fn near(self, flat: &Flat, from: Vec3A) -> Option<Near> {
        let corner = flat.corner - from;
        let height = -corner.dot(flat.normal);
        if !(flat.apparent(from) > SMALLEST && height > LOWEST * self.longest()) {
            return None;
        }
        Some(match self {
            Self::Rectangle { lengths } => {
                Near::Rectangle(Rectangle::new(flat, lengths, corner, height))
            }
            Self::Triangle { .. } => Near::Triangle(Triangle::new(flat, corner, height)),
        })
    }
}

/// The solid angle, as that of a small shape in the same place, from which on a shape is near.
const SMALLEST: f32 = 0.2;

/// The width and the height above the shape, over its longest edge, from which on it is drawn by solid angle. There the solid angle is
/// known to 1e-4 of it, and so is the mean of the directions.
const THINNEST: f32 = 0.02;
const LOWEST: f32 = 0.01;

/// A shape seen from nearby.
#[derive(Clone, Copy, Debug)]
pub(super) enum Near {
    Rectangle(Rectangle),
    Triangle(Triangle),
}

impl Near {
    /// In steradians.
    #[inline]
    pub(super) fn solid_angle(&self) -> f32 {
        match self {
            Self::Rectangle(rectangle) => rectangle.solid_angle,
            Self::Triangle(triangle) => triangle.solid_angle,
        }
    }

    /// The coordinates along the edges of the point at `u`, in [0, 1].
    #[inline]
    pub(super) fn sample(&self, flat: &Flat, u: [f32; 2]) -> [f32; 2] {
        match self {
            Self::Rectangle(rectangle) => rectangle.sample(u),
            Self::Triangle(triangle) => triangle.sample(flat, u),
        }
    }
}

/// A number of length 1 in the plane of complex numbers: an angle that can be added to others without a look at how large it is.
#[derive(Clone, Copy, Debug)]
struct Angle {
    cosine: f32,
    sine: f32,
}

impl Angle {
    /// `part` of a full turn.
    #[inline]
    fn of_turn(part: f32) -> Self {
        let [cosine, sine] = turn(part);
        Self { cosine, sine }
    }

    #[inline]
    fn plus(self, other: Self) -> Self {
        Self {
            cosine: self.cosine * other.cosine - self.sine * other.sine,
            sine: self.sine * other.cosine + self.cosine * other.sine,
        }
    }

    #[inline]
    fn negative(self) -> Self {
        Self {
            sine: -self.sine,
            ..self
        }
    }

    /// In `[0, 2 pi]`, for a number of any length.
    #[inline]
    fn radians(self) -> f32 {
        TAU * turns(self.sine, self.cosine)
    }
}

/// A rectangle, as [`SphericalRectangle`](crate::warp::SphericalRectangle) has it, with sums of angles as products of
/// complex numbers: one arc tangent for all four of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rectangle {
    /// The rectangle in the axes of its edges, seen from the origin.
    x: [f32; 2],
    y: [f32; 2],
    height: f32,
    lengths: [f32; 2],
    /// The third components of the normals of the planes through the two long sides, and what is left to 1 of the square of the first.
    b: [f32; 2],
    left: f32,
    /// What the angles on the far side leave.
    rest: Angle,
    solid_angle: f32,
}

impl Rectangle {
    #[inline]
    fn new(flat: &Flat, lengths: [f32; 2], corner: Vec3A, height: f32) -> Self {
        let [width, depth] = lengths;
        let x = corner.dot(flat.first_edge) / width;
        let y = corner.dot(flat.second_edge) / depth;
        let (x, y) = ([x, x + width], [y, y + depth]);
        // Sine and cosine of the angle between the plane through the origin and a side, and the rectangle's plane.
        let side = |at: f32| {
            let length = (at * at + height * height).sqrt();
            [at / length, height / length]
        };
        let ([x0, x1], [y0, y1]) = (x.map(side), y.map(side));
        let between = |[a, below_a]: [f32; 2], [b, below_b]: [f32; 2], sign: f32| Angle {
            cosine: sign * (a * b),
            // 1 - a^2 b^2 without cancellation.
            sine: (below_a * below_a + a * a * (below_b * below_b)).sqrt(),
        };
        // As the normals of those planes have them, side after side.
        let near = between(y0, x1, 1.0).plus(between(x1, y1, -1.0));
        let far = between(y1, x0, 1.0).plus(between(x0, y0, -1.0));
        Self {
            x,
            y,
            height,
            lengths,
            b: [-y0[0], y1[0]],
            left: y0[1] * y0[1],
            rest: far.negative(),
            solid_angle: near.plus(far).radians(),
        }
    }

    #[inline]
    fn sample(&self, [u, v]: [f32; 2]) -> [f32; 2] {
        let angle = Angle::of_turn(u * (self.solid_angle / TAU)).plus(self.rest);
        let [b0, b1] = self.b;
        let f = (angle.cosine * b0 - b1) / angle.sine;
        let [x0, x1] = self.x;
        let [y0, y1] = self.y;
        let x = self.height.copysign(f) / (f * f - self.left).max(0.0).sqrt();
        // NaN, of angles without a sine, becomes a side.
        let x = x.max(x0).min(x1);
        let squared = x * x + self.height * self.height;
        let [low, high] = [y0, y1].map(|y| y / (squared + y * y).sqrt());
        let h = low + v * (high - low);
        let y = h * (squared / (1.0 - h * h).max(f32::MIN_POSITIVE)).sqrt();
        let y = y.max(y0).min(y1);
        let [width, depth] = self.lengths;
        [
            ((x - x0) / width).clamp(0.0, 1.0),
            ((y - y0) / depth).clamp(0.0, 1.0),
        ]
    }
}

/// A triangle, as [`SphericalTriangle`](crate::warp::SphericalTriangle) has it; its solid angle by one arc
/// tangent.[^oosterom] Of formulas that are the same without rounding these keep their digits near the plane.
///
/// [^oosterom]: van Oosterom, Adriaan; Strackee, Jan (1983). *The Solid Angle of a Plane Triangle*.
///     <https://doi.org/10.1109/TBME.1983.325207>
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle {
    /// Where its corner is, seen from the origin.
    corner: Vec3A,
    /// The directions to the corners.
    directions: [Vec3A; 3],
    /// The angle at the first of them.
    alpha: Angle,
    solid_angle: f32,
}

impl Triangle {
    #[inline]
    fn new(flat: &Flat, corner: Vec3A, height: f32) -> Self {
        let corners = [corner, corner + flat.first_edge, corner + flat.second_edge];
        let lengths = corners.map(Vec3A::length);
        let [a, b, c] = core::array::from_fn(|k| corners[k] / lengths[k]);
        // That of the parallelepiped of the directions: their own product would cancel where they are in one plane nearly.
        let volume = 2.0 * flat.area * height / (lengths[0] * lengths[1] * lengths[2]);
        let half = Angle {
            cosine: 1.0 + a.dot(b) + b.dot(c) + c.dot(a),
            sine: volume,
        };
        let cosine = a.cross(b).dot(a.cross(c));
        let length = (cosine * cosine + volume * volume).sqrt();
        Self {
            corner,
            directions: [a, b, c],
            alpha: Angle {
                cosine: cosine / length,
                sine: volume / length,
            },
            solid_angle: 2.0 * half.radians(),
        }
    }

    #[inline]
    fn sample(&self, flat: &Flat, [u, v]: [f32; 2]) -> [f32; 2] {
        let [a, b, c] = self.directions;
        // The corner of the triangle with the share u of the solid angle, on the side from a to c: the tangents of half the sides and
        // of half the solid angle tell how far.
        let half = Angle::of_turn(u * (self.solid_angle / (2.0 * TAU)));
        let tangent = ((a - b).length_squared() / (a + b).length_squared()).sqrt();
        let rest = tangent * half.negative().plus(self.alpha).sine;
        let square = rest * rest + half.sine * half.sine;
        let corner = beside(
            a,
            c,
            Angle {
                cosine: (rest - half.sine) * (rest + half.sine) / square,
                sine: 2.0 * rest * half.sine / square,
            },
        );
        // 1 less the cosine, which would lose it.
        let less = v * (0.5 * (corner - b).length_squared());
        let direction = beside(
            b,
            corner,
            Angle {
                cosine: 1.0 - less,
                sine: (less * (2.0 - less)).max(0.0).sqrt(),
            },
        );
        // Where it meets the plane of the triangle.
        let distance = self.corner.dot(flat.normal) / direction.dot(flat.normal);
        let inside = direction * distance - self.corner;
        let s = inside.dot(flat.first_dual).clamp(0.0, 1.0);
        let t = inside.dot(flat.second_dual).clamp(0.0, 1.0);
        let beyond = (s + t).max(1.0);
        [s / beyond, t / beyond]
    }
}

/// The direction at an angle from `axis`, in the plane of `axis` and `toward`.
#[inline]
fn beside(axis: Vec3A, toward: Vec3A, angle: Angle) -> Vec3A {
    let across = toward - axis * toward.dot(axis);
    axis * angle.cosine + across.try_normalize().unwrap_or(Vec3A::ZERO) * angle.sine
}
