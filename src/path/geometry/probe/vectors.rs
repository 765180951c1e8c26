//! The same in vectors of eight, which machines with AVX2 have.
//!
//! Compilers make the same of the loops but for the bits, which they gather one by one.

use glam::Vec3A;
use pulp::x86::V3;

use super::{Met, Probe, WIDER, far_sides, near_sides};
use crate::path::geometry::balls::Balls;
use crate::path::geometry::flats::{Flats, Lanes};
use crate::path::geometry::node::Node;
use crate::path::lanes::{Mask, Real, Vector};
use crate::path::ray::Ray;

/// In vectors.
pub(in crate::path::geometry) struct Vectors {
    simd: V3,
    origin: Vector<V3>,
    direction: Vector<V3>,
    inverse: Vector<V3>,
    near: [usize; 3],
    far: [usize; 3],
}

impl Vectors {
    #[inline(always)]
    pub(in crate::path::geometry) fn new(simd: V3, ray: &Ray) -> Self {
        let inverse: Vec3A = ray.direction.recip();
        let near = near_sides(inverse.to_array());
        Self {
            simd,
            origin: Vector::splat(simd, ray.origin),
            direction: Vector::splat(simd, ray.direction),
            inverse: Vector::splat(simd, inverse),
            near,
            far: far_sides(near),
        }
    }

    #[inline(always)]
    fn vector(&self, [x, y, z]: [&Lanes; 3]) -> Vector<V3> {
        let [x, y, z] = [x, y, z].map(|lanes| Real::of(self.simd, lanes));
        Vector { x, y, z }
    }

    #[inline(always)]
    fn met(&self, distances: Real<V3>, which: Mask<V3>) -> Met {
        Met {
            distances: distances.eight(),
            which: which.bits(),
        }
    }
}

impl Probe for Vectors {
    #[inline(always)]
    fn enter(&self, node: &Node, limit: f32) -> Met {
        let near = self.vector(self.near.map(|side| &node.bounds[side]));
        let far = self.vector(self.far.map(|side| &node.bounds[side]));
        let enters = (near - self.origin) * self.inverse;
        let leaves = (far - self.origin) * self.inverse;
        // NaN, of a ray within the plane of a side, tells nothing.
        let start = enters.x.max(Real::splat(self.simd, 0.0));
        let start = enters.z.max(enters.y.max(start));
        let end = leaves.x.min(Real::splat(self.simd, limit));
        let end = leaves.z.min(leaves.y.min(end));
        self.met(start, start.le(end * WIDER))
    }

    #[inline(always)]
    fn meet(&self, flats: &Flats, limit: f32) -> Met {
        let offset = self.vector(flats.corner.each_ref()) - self.origin;
        let normal = self.vector(flats.normal.each_ref());
        let distance = offset.dot(normal) * (1.0 / self.direction.dot(normal));
        let inside = self.direction * distance - offset;
        let s = inside.dot(self.vector(flats.first_dual.each_ref()));
        let t = inside.dot(self.vector(flats.second_dual.each_ref()));
        let slant = Real::of(self.simd, &flats.slant);
        let [slack_s, slack_t] = flats
            .slack
            .each_ref()
            .map(|slack| Real::of(self.simd, slack));
        let inside = distance.gt(distance.all(0.0))
            & distance.lt(distance.all(limit))
            & s.ge(-slack_s)
            & t.ge(-slack_t)
            & (s + slant * t).le(1.0 + slack_s)
            & (t + slant * s).le(1.0 + slack_t);
        self.met(distance, inside)
    }

    #[inline(always)]
    fn strike(&self, balls: &Balls, limit: f32) -> Met {
        let squared_radius = Real::of(self.simd, &balls.squared_radius);
        let offset = self.vector(balls.center.each_ref()) - self.origin;
        let middle = offset.dot(self.direction);
        let apart = offset - self.direction * middle;
        let discriminant = squared_radius - apart.dot(apart);
        let zero = middle.all(0.0);
        let far = middle + discriminant.sqrt().copysign(middle);
        let near = (offset.dot(offset) - squared_radius) / far;
        let ordered = near.lt(far);
        let (first, second) = (ordered.select(near, far), ordered.select(far, near));
        let distance = first.gt(zero).select(first, second);
        let inside = discriminant.ge(zero) & distance.gt(zero) & distance.lt(distance.all(limit));
        self.met(distance, inside)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash::{hash, unit_f32};
    use crate::path::geometry::node::Child;
    use crate::path::geometry::probe::Plain;
    use crate::path::shape::{Flat, Shape, Sphere};

    fn random(seed: u64, k: u64) -> f32 {
        unit_f32(hash(seed, k)) - 0.5
    }

    fn vector(seed: u64, k: u64) -> [f32; 3] {
        core::array::from_fn(|axis| random(seed, 3 * k + axis as u64))
    }

    #[test]
    fn vectors_have_the_bits_of_the_loops() {
        let Some(simd) = V3::try_new() else {
            return;
        };
        let (mut entered, mut met, mut met_spheres) = (0, 0, 0);
        for seed in 0..6000 {
            // Some lanes stay empty; some rays run along an axis, within the planes of sides.
            let lanes = 1 + hash(seed, 100) % 8;
            let mut node = Node::EMPTY;
            let mut flats = Vec::new();
            for lane in 0..lanes {
                let [a, b] = [vector(seed, lane), vector(seed, 10 + lane)].map(Vec3A::from);
                let bounds = [a.min(b), a.max(b)].map(|corner| corner.to_array());
                node.set(usize::try_from(lane).unwrap(), bounds, Child::leaf(0));
                let corners = [20, 30, 40].map(|k| vector(seed, k + lane));
                flats.push(if lane % 2 == 0 {
                    Flat::triangle(corners).unwrap()
                } else {
                    Flat::parallelogram(corners[0], corners[1], corners[2]).unwrap()
                });
            }
            let block = Flats::blocks(flats.iter())[0];
            let spheres: Vec<_> = (0..lanes)
                .map(|lane| Sphere::new(vector(seed, 60 + lane), 0.5 + random(seed, 300 + lane)))
                .collect::<Result<_, _>>()
                .unwrap();
            let balls = Balls::blocks(spheres.iter())[0];
            let origin = Vec3A::from(vector(seed, 50));
            let ray = match seed % 4 {
                0 => Ray {
                    origin: origin.with_x(node.bounds[0][0]),
                    direction: -Vec3A::Y,
                },
                _ => Ray {
                    origin,
                    direction: Vec3A::from(vector(seed, 51)).normalize(),
                },
            };
            let (plain, vectors) = (Plain::new(&ray), Vectors::new(simd, &ray));
            for limit in [0.2, f32::INFINITY] {
                for (expected, found) in [
                    (plain.enter(&node, limit), vectors.enter(&node, limit)),
                    (plain.meet(&block, limit), vectors.meet(&block, limit)),
                    (plain.strike(&balls, limit), vectors.strike(&balls, limit)),
                ] {
                    assert_eq!(found.which, expected.which, "{ray:?} {limit}");
                    for lane in expected.lanes() {
                        let [a, b] = [&found, &expected].map(|met| met.distances[lane].to_bits());
                        assert_eq!(a, b, "{ray:?} {limit} {lane}");
                    }
                }
                entered += plain.enter(&node, limit).which.count_ones();
                met += plain.meet(&block, limit).which.count_ones();
                let struck = vectors.strike(&balls, limit);
                for (lane, sphere) in spheres.iter().enumerate() {
                    let hit = (struck.which >> lane & 1 == 1).then_some(struck.distances[lane]);
                    assert_eq!(hit, sphere.intersect(&ray, limit), "{ray:?} {limit} {lane}");
                }
                met_spheres += struck.which.count_ones();
            }
        }
        assert!(
            entered > 3000 && met > 1000 && met_spheres > 3000,
            "{entered} {met} {met_spheres}"
        );
    }
}
