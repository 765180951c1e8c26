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

#[cfg(test)]
mod tests {
    use pulp::{Arch, WithSimd};

    use super::*;
    use crate::hash::{hash, unit_f32};
    use crate::path::Ray;
    use crate::path::lanes::{Row, WIDEST};
    use crate::path::shape::Shape;

    /// Some shapes, asked for a ray a lane.
    struct Asked<'a> {
        rays: &'a [Ray; WIDEST],
        disk: Disk,
        cylinder: Cylinder,
    }

    impl WithSimd for Asked<'_> {
        type Output = [u32; 2];

        /// How many of the rays meet each.
        fn with_simd<S: Simd>(self, simd: S) -> [u32; 2] {
            let (mut origin, mut direction) = ([Row::<f32>::ZERO; 3], [Row::<f32>::ZERO; 3]);
            for (lane, ray) in self.rays.iter().enumerate() {
                Row::set_vector(&mut origin, lane, ray.origin);
                Row::set_vector(&mut direction, lane, ray.direction);
            }
            let (origin, direction) = (Vector::load(simd, &origin), Vector::load(simd, &direction));
            let agree = |met: Meeting<S>, shape: &dyn Shape| {
                let (inside, distance) = (met.inside.row(simd), met.distance.row());
                let lanes = self.rays.iter().enumerate().take(S::F32_LANES);
                let hits = lanes.filter(|&(lane, ray)| {
                    let found = (inside.0[lane] > 0.0).then_some(distance.0[lane]);
                    let expected = shape.intersect(ray, f32::INFINITY);
                    let [found, expected] = [found, expected].map(|hit| hit.map(f32::to_bits));
                    assert_eq!(found, expected, "{ray:?}");
                    expected.is_some()
                });
                u32::try_from(hits.count()).unwrap()
            };
            [
                agree(self.disk.meet(simd, origin, direction), &self.disk),
                agree(self.cylinder.meet(simd, origin, direction), &self.cylinder),
            ]
        }
    }

    #[test]
    fn every_lane_has_the_bits_of_a_single_ray() {
        let mut met = [[0; 2]; 2];
        for seed in 0..3000 {
            let random = |k| unit_f32(hash(seed, k)) - 0.5;
            let vector = |k| [random(k), random(k + 1), random(k + 2)];
            let disk = Disk::new(vector(0), vector(3), vector(6)).unwrap();
            let cylinder = Cylinder::new(vector(9), vector(12), 0.1 + random(15).abs()).unwrap();
            let axis = cylinder.axes[2];
            let rays = core::array::from_fn(|lane| {
                let k = 20 + 6 * lane as u64;
                let (at, way) = (Vec3A::from(vector(k)), Vec3A::from(vector(k + 3)));
                let edge = disk.center + Vec3A::from(vector(3));
                let (origin, direction) = match lane {
                    // Along the axis, from it, and nearly along it.
                    0 => (at, axis),
                    1 => (cylinder.start, way),
                    2 => (at, (axis + way * 1e-7).normalize()),
                    3 => (at, axis + cylinder.axes[0] * 1e-30),
                    // To the rims, within the rounding of either side.
                    4 => (at, cylinder.start + cylinder.axes[0] * cylinder.radius - at),
                    5 => (at, edge - at),
                    // In the plane of the disk.
                    6 => (disk.center, disk.first_dual),
                    7 => (at, Vec3A::NEG_Y),
                    8 => (at, Vec3A::ZERO),
                    9 => (at, Vec3A::NAN),
                    // From a point of the cylinder, into it or away.
                    10 => (cylinder.start + cylinder.axes[1] * cylinder.radius, way),
                    _ => (at, way),
                };
                Ray {
                    origin,
                    direction: if lane == 3 {
                        direction
                    } else {
                        direction / direction.length()
                    },
                }
            });
            let asked = || Asked {
                rays: &rays,
                disk,
                cylinder,
            };
            for (met, more) in met.iter_mut().zip([
                Arch::new().dispatch(asked()),
                asked().with_simd(pulp::Scalar),
            ]) {
                *met = [met[0] + more[0], met[1] + more[1]];
            }
        }
        let [[disks, cylinders], [alone, _]] = met;
        assert!(disks > 2000 && cylinders > 2000 && alone > 20, "{met:?}");
    }
}
