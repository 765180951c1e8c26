//! The boxes around what is found lane by lane.

use glam::Vec3A;
use pulp::Simd;

use crate::path::geometry::Inverted;
use crate::path::lanes::{Mask, Real, Vector};

/// Boxes, given by two corners each.
#[derive(Debug)]
pub(super) struct Boxes(pub(super) Vec<[Vec3A; 2]>);

impl Boxes {
    /// Where rays enter any of them before `limit`, up to rounding: the same arithmetic as that of a node of a tree.
    #[inline(always)]
    pub(super) fn entered<S: Simd>(
        &self,
        origin: Vector<S>,
        direction: Vector<S>,
        limit: Real<S>,
    ) -> Mask<S> {
        let nowhere = limit.lt(limit);
        if self.0.is_empty() {
            return nowhere;
        }
        let rays = Inverted::new(origin, direction);
        let mut entered = nowhere;
        for corners in &self.0 {
            entered = entered | rays.enter(*corners, limit).1;
        }
        entered
    }
}

#[cfg(test)]
mod tests {
    use pulp::{Arch, WithSimd};

    use super::*;
    use crate::hash::{hash, unit_f32};
    use crate::path::lanes::{Row, WIDEST};
    use crate::path::{Ray, gamma};

    /// One ray, asked for in all lanes.
    struct Asked<'a>(&'a Boxes, Ray, f32);

    impl WithSimd for Asked<'_> {
        type Output = bool;

        fn with_simd<S: Simd>(self, simd: S) -> bool {
            let Self(boxes, ray, limit) = self;
            let [origin, direction] = [ray.origin, ray.direction].map(|v| Vector::splat(simd, v));
            let entered = boxes.entered(origin, direction, Real::splat(simd, limit));
            let lanes: Row<f32> = entered.row(simd);
            let all = lanes.0[..S::F32_LANES].iter().all(|&lane| lane > 0.0);
            assert!(S::F32_LANES <= WIDEST && (all || !entered.any()));
            all
        }
    }

    /// As a node of a tree has it.
    fn enters([low, high]: [Vec3A; 2], ray: &Ray, limit: f32) -> bool {
        let (mut start, mut end) = (0.0, limit);
        for axis in 0..3 {
            let inverse = 1.0 / ray.direction[axis];
            let mut sides = [low, high].map(|side| (side[axis] - ray.origin[axis]) * inverse);
            if inverse < 0.0 {
                sides.reverse();
            }
            start = if sides[0] > start { sides[0] } else { start };
            end = if sides[1] < end { sides[1] } else { end };
        }
        start <= end * (1.0 + 2.0 * gamma(3))
    }

    #[test]
    fn a_ray_enters_what_it_enters_in_a_tree() {
        let (mut entered, mut passed) = (0, 0);
        for seed in 0..4000 {
            let random = |k| unit_f32(hash(seed, k)) - 0.5;
            let vector = |k| Vec3A::new(random(k), random(k + 1), random(k + 2));
            let sides = [0, 6].map(|k| {
                let [a, b] = [vector(k), vector(k + 3)];
                [a.min(b), a.max(b)]
            });
            let (low, high) = (sides[0][0], sides[0][1]);
            let ray = |origin, direction: Vec3A| Ray { origin, direction };
            let rays = [
                ray(vector(20), vector(23).normalize()),
                // Within the planes of sides, with zeros of both signs, and along an edge.
                ray(vector(20).with_x(low.x), Vec3A::new(0.0, 0.6, -0.8)),
                ray(vector(20).with_x(high.x), Vec3A::new(-0.0, -1.0, 0.0)),
                ray(low - Vec3A::Y, Vec3A::Y),
                ray(vector(20).with_z(high.z), Vec3A::new(1.0, -0.0, -0.0)),
                // To a corner, of which rounding leaves out one side or the other.
                ray(vector(20), (high - vector(20)).normalize()),
            ];
            let boxes = Boxes(sides.to_vec());
            for ray in rays {
                for limit in [0.0, 0.3, (high - ray.origin).length(), f32::INFINITY] {
                    let expected = sides.iter().any(|&corners| enters(corners, &ray, limit));
                    let asked = || Asked(&boxes, ray, limit);
                    assert_eq!(Arch::new().dispatch(asked()), expected, "{ray:?} {limit}");
                    assert_eq!(asked().with_simd(pulp::Scalar), expected, "{ray:?} {limit}");
                    entered += u32::from(expected);
                    passed += u32::from(!expected);
                }
            }
            assert!(!Arch::new().dispatch(Asked(&Boxes(Vec::new()), rays[0], 1.0)));
        }
        assert!(entered > 10_000 && passed > 10_000, "{entered} {passed}");
    }
}
