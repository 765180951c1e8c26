//! A vector a lane.

use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub};

use glam::Vec3A;
use pulp::Simd;

use super::{Mask, Real, Row};

/// A vector a lane.
#[derive(Clone, Copy)]
pub(in crate::path) struct Vector<S: Simd> {
    pub(in crate::path) x: Real<S>,
    pub(in crate::path) y: Real<S>,
    pub(in crate::path) z: Real<S>,
}

impl<S: Simd> Vector<S> {
    /// The same vector in all lanes.
    #[inline(always)]
    pub(in crate::path) fn splat(simd: S, vector: Vec3A) -> Self {
        Self {
            x: Real::splat(simd, vector.x),
            y: Real::splat(simd, vector.y),
            z: Real::splat(simd, vector.z),
        }
    }

    #[inline(always)]
    pub(in crate::path) fn load(simd: S, [x, y, z]: &[Row<f32>; 3]) -> Self {
        Self {
            x: Real::load(simd, x),
            y: Real::load(simd, y),
            z: Real::load(simd, z),
        }
    }

    #[inline(always)]
    pub(in crate::path) fn store(self, [x, y, z]: &mut [Row<f32>; 3]) {
        self.x.store(x);
        self.y.store(y);
        self.z.store(z);
    }

    /// The vectors, to be read lane by lane.
    #[inline(always)]
    pub(in crate::path) fn rows(self) -> [Row<f32>; 3] {
        [self.x.row(), self.y.row(), self.z.row()]
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(Real<S>, Real<S>) -> Real<S>) -> Self {
        Self {
            x: f(self.x, other.x),
            y: f(self.y, other.y),
            z: f(self.z, other.z),
        }
    }

    #[inline(always)]
    pub(in crate::path) fn dot(self, other: Self) -> Real<S> {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// The components from that of `axis` on, in turn.
    #[inline(always)]
    pub(in crate::path) fn turned(self, axis: usize) -> Self {
        let Self { x, y, z } = self;
        match axis {
            0 => self,
            1 => Self { x: y, y: z, z: x },
            _ => Self { x: z, y: x, z: y },
        }
    }

    #[inline(always)]
    pub(in crate::path) fn lerp(self, other: Self, u: Real<S>) -> Self {
        self * (1.0 - u) + other * u
    }

    #[inline(always)]
    pub(in crate::path) fn length(self) -> Real<S> {
        self.dot(self).sqrt()
    }

    #[inline(always)]
    pub(in crate::path) fn max_element(self) -> Real<S> {
        self.x.max(self.z).max(self.y.max(self.z))
    }
}

impl<S: Simd> Mask<S> {
    /// `yes` where it holds, `no` elsewhere.
    #[inline(always)]
    pub(in crate::path) fn choose(self, yes: Vector<S>, no: Vector<S>) -> Vector<S> {
        // Not by a closure: compilers do not always make it part of the loop, and then it is a call.
        Vector {
            x: self.select(yes.x, no.x),
            y: self.select(yes.y, no.y),
            z: self.select(yes.z, no.z),
        }
    }
}

impl<S: Simd> Add for Vector<S> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl<S: Simd> AddAssign for Vector<S> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<S: Simd> Sub for Vector<S> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl<S: Simd> Mul for Vector<S> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}

impl<S: Simd> MulAssign for Vector<S> {
    #[inline(always)]
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl<S: Simd> Mul<Real<S>> for Vector<S> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: Real<S>) -> Self {
        Self {
            x: self.x * factor,
            y: self.y * factor,
            z: self.z * factor,
        }
    }
}

impl<S: Simd> Div<Real<S>> for Vector<S> {
    type Output = Self;

    #[inline(always)]
    fn div(self, divisor: Real<S>) -> Self {
        Self {
            x: self.x / divisor,
            y: self.y / divisor,
            z: self.z / divisor,
        }
    }
}

impl<S: Simd> Neg for Vector<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self {
            x: -self.x,
            y: -self.y,
            z: -self.z,
        }
    }
}
