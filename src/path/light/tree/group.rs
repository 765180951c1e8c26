//! Groups of emitters, as points see them.

use glam::Vec3A;

use super::bound::Bound;

/// A group as points see it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Group {
    center: Vec3A,
    squared_radius: f32,
    axis: Vec3A,
    /// Of the angle that all normals are within of the axis, and [`SLACK`].
    cosine: f32,
    sine: f32,
    power: f32,
}

/// More than rounding does to an angle.
const SLACK: f32 = 1e-3;

impl Group {
    pub(super) fn of(bound: &Bound) -> Self {
        let (sine, cosine) = (bound.spread + SLACK).sin_cos();
        Self {
            center: bound.center(),
            squared_radius: 0.25 * (bound.high - bound.low).length_squared(),
            axis: bound.axis,
            cosine,
            sine,
            power: bound.power,
        }
    }

    /// A bound of the irradiance at a point, up to a factor that is the same for all; zero only where no light of the group
    /// arrives.
    #[inline]
    pub(super) fn worth(&self, from: Vec3A) -> f32 {
        let offset = from - self.center;
        let squared = offset.length_squared();
        let near = self.power / squared.max(self.squared_radius).max(f32::MIN_POSITIVE);
        if squared <= self.squared_radius || self.cosine <= 0.0 {
            return near;
        }
        // The least angle between a normal and the way to the point: that at the centre, less what the normals and the
        // size of the group can change.
        let cosine = (self.axis.dot(offset) / squared.sqrt()).clamp(-1.0, 1.0);
        let cosine = less([cosine, sine(cosine)], [self.cosine, self.sine]);
        let size = self.squared_radius / squared;
        let [cosine, _] = less(cosine, [(1.0 - size).sqrt(), size.sqrt()]);
        if cosine > 0.0 { near * cosine } else { 0.0 }
    }
}

/// The sine of an angle in `[0, pi]` of which this is the cosine.
#[inline]
fn sine(cosine: f32) -> f32 {
    (1.0 - cosine * cosine).max(0.0).sqrt()
}

/// The cosine and sine of the difference of two angles in `[0, pi]`, or of 0 if the second is larger.
#[inline]
fn less([cosine, sine]: [f32; 2], [other_cosine, other_sine]: [f32; 2]) -> [f32; 2] {
    if cosine >= other_cosine {
        return [1.0, 0.0];
    }
    [
        cosine * other_cosine + sine * other_sine,
        sine * other_cosine - cosine * other_sine,
    ]
}

#[cfg(test)]
mod tests {
    use core::f64::consts::FRAC_PI_2;

    use super::*;
    use crate::hash::{hash, unit_f32};
    use crate::path::Frame;

    /// What a group is worth that shines everywhere.
    fn near(bound: &Bound, from: Vec3A) -> f64 {
        let offset = (from - bound.center()).as_dvec3();
        let radius = 0.5 * (bound.high - bound.low).as_dvec3().length();
        f64::from(bound.power) / offset.length().max(radius).powi(2)
    }

    /// The angles themselves, which take longer.
    fn by_angles(bound: &Bound, from: Vec3A) -> f64 {
        let offset = (from - bound.center()).as_dvec3();
        let radius = 0.5 * (bound.high - bound.low).as_dvec3().length();
        let spread = f64::from(bound.spread + SLACK);
        if offset.length() <= radius || spread >= FRAC_PI_2 {
            return near(bound, from);
        }
        let angle = offset.angle_between(bound.axis.as_dvec3()) - spread;
        let least = angle.max(0.0) - (radius / offset.length()).asin();
        near(bound, from) * least.clamp(0.0, FRAC_PI_2).cos()
    }

    /// Groups of all sizes, half of them small, and of all spreads, and points near and far.
    fn groups() -> impl Iterator<Item = (u64, Bound, Vec3A)> {
        (0..20_000).map(|seed| {
            let random = |k| unit_f32(hash(seed, k)) - 0.5;
            let vector = |k| Vec3A::new(random(k), random(k + 1), random(k + 2));
            let (a, b) = (vector(0), vector(3));
            let b = a + (b - a) * [1.0, 0.01][usize::from(seed % 2 == 0)];
            let bound = Bound {
                low: a.min(b),
                high: a.max(b),
                axis: vector(6).normalize(),
                spread: (4.0 * random(9)).max(0.0),
                power: 2.0,
            };
            (seed, bound, 3.0 * vector(10))
        })
    }

    #[test]
    fn worth_is_the_cosine_of_the_least_angle() {
        let mut dark = 0;
        for (seed, bound, from) in groups() {
            let found = f64::from(Group::of(&bound).worth(from));
            let expected = by_angles(&bound, from);
            assert!(
                (found - expected).abs() < 1e-5 * near(&bound, from),
                "{seed} {bound:?} {from} {found} {expected}"
            );
            dark += u32::from(found == 0.0);
        }
        assert!((1000..10_000).contains(&dark), "{dark}");
    }

    #[test]
    fn nothing_that_shines_at_a_point_is_worthless_there() {
        let mut few = 0;
        for (seed, bound, from) in groups() {
            let random = |k| unit_f32(hash(seed, k));
            for k in 0..50 {
                let [x, y, z, a, b] = [0, 1, 2, 3, 4].map(|word| random(100 + 5 * k + word));
                // A light in the box, and a normal as far from the axis as may be.
                let light = bound.low + (bound.high - bound.low) * Vec3A::new(x, y, z).round();
                let frame = Frame::around(bound.axis);
                let angle = bound.spread * a.sqrt();
                let (sine, cosine) = angle.sin_cos();
                let (y, x) = (core::f32::consts::TAU * b).sin_cos();
                let normal = frame.out(Vec3A::new(sine * x, sine * y, cosine));
                if normal.dot(from - light) > 0.0 {
                    let worth = Group::of(&bound).worth(from);
                    assert!(worth > 0.0, "{seed} {bound:?} {from} {light} {normal}");
                    few += u32::from(f64::from(worth) < 0.1 * near(&bound, from));
                }
            }
        }
        assert!(few > 1000, "{few} close to where it ends");
    }
}
