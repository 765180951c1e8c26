//! Rectangles seen from nearby, one a lane, with the bits of single ones.

use core::f32::consts::TAU;

use pulp::Simd;

use super::{LOWEST, SMALLEST};
use crate::path::frame::lanes::{turn, turns};
use crate::path::lanes::{Mask, Real, Vector};

/// As the [`near`](super::Outline::near) of shapes with the given middles, areas, heights of `from` above them and longest edges.
#[inline(always)]
pub(in crate::path) fn are_near<S: Simd>(
    to_middle: Vector<S>,
    area: Real<S>,
    height: Real<S>,
    longest: Real<S>,
) -> Mask<S> {
    let squared = to_middle.dot(to_middle);
    let apparent = area * height / (squared * squared.sqrt());
    apparent.gt(area.all(SMALLEST)) & height.gt(LOWEST * longest)
}

/// As [`Angle`](super::Angle).
#[derive(Clone, Copy)]
struct Angle<S: Simd> {
    cosine: Real<S>,
    sine: Real<S>,
}

impl<S: Simd> Angle<S> {
    #[inline(always)]
    fn of_turn(part: Real<S>) -> Self {
        let [cosine, sine] = turn(part);
        Self { cosine, sine }
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        Self {
            cosine: self.cosine * other.cosine - self.sine * other.sine,
            sine: self.sine * other.cosine + self.cosine * other.sine,
        }
    }

    #[inline(always)]
    fn radians(self) -> Real<S> {
        TAU * turns(self.sine, self.cosine)
    }
}

/// Sine and cosine of the angle between the plane through the origin and a side, and the rectangle's plane.
#[inline(always)]
fn side<S: Simd>(at: Real<S>, height: Real<S>) -> [Real<S>; 2] {
    let length = (at * at + height * height).sqrt();
    [at / length, height / length]
}

/// The angle between two such planes.
#[inline(always)]
fn between<S: Simd>([a, below_a]: [Real<S>; 2], [b, below_b]: [Real<S>; 2], sign: f32) -> Angle<S> {
    Angle {
        cosine: sign * (a * b),
        sine: (below_a * below_a + a * a * (below_b * below_b)).sqrt(),
    }
}

/// As [`Rectangle`](super::Rectangle).
#[derive(Clone, Copy)]
pub(in crate::path) struct Rectangle<S: Simd> {
    x: [Real<S>; 2],
    y: [Real<S>; 2],
    height: Real<S>,
    lengths: [Real<S>; 2],
    b: [Real<S>; 2],
    left: Real<S>,
    rest: Angle<S>,
    solid_angle: Real<S>,
}

impl<S: Simd> Rectangle<S> {
    #[inline(always)]
    pub(in crate::path) fn new(
        corner: Vector<S>,
        edges: [Vector<S>; 2],
        lengths: [Real<S>; 2],
        height: Real<S>,
    ) -> Self {
        let [width, depth] = lengths;
        let x = corner.dot(edges[0]) / width;
        let y = corner.dot(edges[1]) / depth;
        let (x, y) = ([x, x + width], [y, y + depth]);
        let [x0, x1] = [side(x[0], height), side(x[1], height)];
        let [y0, y1] = [side(y[0], height), side(y[1], height)];
        let near = between(y0, x1, 1.0).plus(between(x1, y1, -1.0));
        let far = between(y1, x0, 1.0).plus(between(x0, y0, -1.0));
        Self {
            x,
            y,
            height,
            lengths,
            b: [-y0[0], y1[0]],
            left: y0[1] * y0[1],
            rest: Angle {
                sine: -far.sine,
                ..far
            },
            solid_angle: near.plus(far).radians(),
        }
    }

    /// Per solid angle, of what is [drawn](Self::sample).
    #[inline(always)]
    pub(in crate::path) fn density(&self) -> Real<S> {
        1.0 / self.solid_angle
    }

    /// The coordinates along the edges of the points at `u`, in [0, 1].
    #[inline(always)]
    pub(in crate::path) fn sample(&self, [u, v]: [Real<S>; 2]) -> [Real<S>; 2] {
        let (zero, one) = (u.all(0.0), u.all(1.0));
        let angle = Angle::of_turn(u * (self.solid_angle / TAU)).plus(self.rest);
        let [b0, b1] = self.b;
        let f = (angle.cosine * b0 - b1) / angle.sine;
        let [x0, x1] = self.x;
        let [y0, y1] = self.y;
        let x = self.height.copysign(f) / (f * f - self.left).max(zero).sqrt();
        let x = x.max(x0).min(x1);
        let squared = x * x + self.height * self.height;
        let low = y0 / (squared + y0 * y0).sqrt();
        let high = y1 / (squared + y1 * y1).sqrt();
        let h = low + v * (high - low);
        let y = h * (squared / (1.0 - h * h).max(u.all(f32::MIN_POSITIVE))).sqrt();
        let y = y.max(y0).min(y1);
        let [width, depth] = self.lengths;
        [
            ((x - x0) / width).max(zero).min(one),
            ((y - y0) / depth).max(zero).min(one),
        ]
    }
}

#[cfg(test)]
mod tests {
    use core::array::from_fn;

    use glam::Vec3A;
    use pulp::{Arch, WithSimd};

    use super::super::{Near, Outline};
    use super::*;
    use crate::hash::{hash, unit_f32};
    use crate::path::shape::Flat;

    /// One look at a rectangle.
    struct Look {
        flat: Flat,
        from: Vec3A,
        u: [f32; 2],
    }

    impl WithSimd for Look {
        /// The bits of the coordinates and of the density, if it is near.
        type Output = Option<[u32; 3]>;

        fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
            let Self { flat, from, u } = self;
            let real = |number| Real::splat(simd, number);
            let vector = |vector| Vector::splat(simd, vector);
            let corner = vector(flat.corner) - vector(from);
            let height = -corner.dot(vector(flat.normal));
            let edges = [flat.first_edge, flat.second_edge];
            let lengths = edges.map(Vec3A::length);
            let to_middle = corner + (vector(edges[0]) + vector(edges[1])) * real(0.5);
            let longest = real(lengths[0].max(lengths[1]));
            if !are_near(to_middle, real(flat.area), height, longest).any() {
                return None;
            }
            let rectangle = Rectangle::new(corner, edges.map(vector), lengths.map(real), height);
            let [s, t] = rectangle.sample(u.map(real));
            Some([s, t, rectangle.density()].map(|number| number.row().0[0].to_bits()))
        }
    }

    #[test]
    fn lanes_have_the_bits_of_single_rectangles() {
        let mut near = [0; 2];
        for seed in 0..4000 {
            let unit = |word| unit_f32(hash(seed, word));
            let flat = Flat::parallelogram(
                [unit(0), unit(1), unit(2)],
                [0.1 + unit(3), 0.0, 0.0],
                [0.0, 0.1 + unit(4), 0.0],
            );
            // A half of the points close to the plane, about where it becomes too close.
            let (flat, close) = (flat.unwrap(), seed % 2 == 0);
            let over = flat.corner
                + flat.first_edge * (2.0 * unit(5) - 0.5)
                + flat.second_edge * (2.0 * unit(6) - 0.5);
            let height = if close { 0.02 } else { 2.0 } * (unit(7) - 0.1);
            let from = over + flat.normal * height;
            let u = from_fn(|axis| unit(8 + axis as u64));
            let expected = Outline::of(&flat).unwrap().near(&flat, from).map(|seen| {
                let Near::Rectangle(rectangle) = seen else {
                    panic!("{seen:?} is no rectangle");
                };
                let [s, t] = rectangle.sample(u);
                [s, t, rectangle.solid_angle.recip()].map(f32::to_bits)
            });
            let look = || Look { flat, from, u };
            assert_eq!(
                Arch::new().dispatch(look()),
                expected,
                "{flat:?} {from} {u:?}"
            );
            assert_eq!(look().with_simd(pulp::Scalar), expected);
            near[usize::from(close)] += usize::from(expected.is_some());
        }
        assert!(
            near.iter().all(|count| (100..1900).contains(count)),
            "{near:?}"
        );
    }
}
