//! Shapes that are not flat rectangles or triangles: as [`Shape::intersect`](crate::path::shape::Shape::intersect) of each, and without
//! coordinates.

use glam::Vec3A;
use pulp::Simd;

use super::Meeting;
use crate::path::gamma;
use crate::path::lanes::{Real, Vector};
use crate::path::shape::{Cylinder, Disk, Sphere};

/// A sphere.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ball {
    center: Vec3A,
    squared_radius: f32,
}

impl Ball {
    pub(super) fn new(sphere: &Sphere) -> Self {
        Self {
            center: sphere.center(),
            squared_radius: sphere.squared_radius(),
        }
    }

    #[inline(always)]
    pub(super) fn meet<S: Simd>(
        &self,
        simd: S,
        origin: Vector<S>,
        direction: Vector<S>,
    ) -> Meeting<S> {
        let zero = Real::splat(simd, 0.0);
        let squared_radius = Real::splat(simd, self.squared_radius);
        let offset = Vector::splat(simd, self.center) - origin;
        let middle = offset.dot(direction);
        let apart = offset - direction * middle;
        let discriminant = squared_radius - apart.dot(apart);
        let far = middle + discriminant.sqrt().copysign(middle);
        let near = (offset.dot(offset) - squared_radius) / far;
        let ordered = near.lt(far);
        let (first, second) = (ordered.select(near, far), ordered.select(far, near));
        let distance = first.gt(zero).select(first, second);
        Meeting {
            distance,
            s: zero,
            t: zero,
            inside: discriminant.ge(zero) & distance.gt(zero),
        }
    }
}

impl Disk {
    #[inline(always)]
    pub(super) fn meet<S: Simd>(
        &self,
        simd: S,
        origin: Vector<S>,
        direction: Vector<S>,
    ) -> Meeting<S> {
        let zero = Real::splat(simd, 0.0);
        let normal = Vector::splat(simd, self.normal);
        let offset = Vector::splat(simd, self.center) - origin;
        let distance = offset.dot(normal) / direction.dot(normal);
        let inside = direction * distance - offset;
        let s = inside.dot(Vector::splat(simd, self.first_dual));
        let t = inside.dot(Vector::splat(simd, self.second_dual));
        let most = zero.all((1.0 + self.slack) * (1.0 + self.slack));
        Meeting {
            distance,
            s: zero,
            t: zero,
            inside: distance.gt(zero) & (s * s + t * t).le(most),
        }
    }
}

impl Cylinder {
    #[inline(always)]
    pub(super) fn meet<S: Simd>(
        &self,
        simd: S,
        origin: Vector<S>,
        direction: Vector<S>,
    ) -> Meeting<S> {
        let zero = Real::splat(simd, 0.0);
        let [first, second, along] = self.axes;
        let (first, second) = (Vector::splat(simd, first), Vector::splat(simd, second));
        let along = Vector::splat(simd, along);
        let offset = origin - Vector::splat(simd, self.start);
        let (x, y, z) = (first.dot(offset), second.dot(offset), along.dot(offset));
        let (dx, dy) = (first.dot(direction), second.dot(direction));
        let dz = along.dot(direction);
        // Along the axis it is zero, and all that follows is no number.
        let speed = (dx * dx + dy * dy).sqrt();
        let (dx, dy) = (dx / speed, dy / speed);
        let middle = -(x * dx + y * dy);
        let apart = [x + dx * middle, y + dy * middle];
        let squared_radius = zero.all(self.radius * self.radius);
        let discriminant = squared_radius - (apart[0] * apart[0] + apart[1] * apart[1]);
        let far = middle + discriminant.sqrt().copysign(middle);
        let near = (x * x + y * y - squared_radius) / far;
        let ordered = near.lt(far);
        let (near, far) = (ordered.select(near, far), ordered.select(far, near));
        let (near, far) = (near / speed, far / speed);
        let (low, high) = (z + near * dz, z + far * dz);
        let length = zero.all(self.length);
        let slack = gamma(8) * (length + z.abs());
        let most = length + slack;
        let enters = near.gt(zero) & low.ge(-slack) & low.le(most);
        let leaves = far.gt(zero) & high.ge(-slack) & high.le(most);
        Meeting {
            distance: enters.select(near, far),
            s: zero,
            t: zero,
            inside: discriminant.ge(zero) & (enters | leaves),
        }
    }
}
