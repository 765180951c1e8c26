//! Numbers and vectors, one a lane, with the arithmetic of single ones.
//!
//! Every operation is that of `f32` in each lane, none is fused: a lane has the bits that a loop over single
//! numbers has, whatever the width of the vectors.

mod vector;

use core::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use glam::Vec3A;
use pulp::Simd;

pub(in crate::path) use vector::Vector;

/// The widest vectors there are.
pub(in crate::path) const WIDEST: usize = 16;

/// Whether one instruction for the larger or smaller of two numbers gives the second of them unless the first is
/// larger, or smaller, also where one is NaN or both are zeros. Those of other machines differ there.
const PICKS_OTHER: bool = cfg!(target_arch = "x86_64");

/// Room for a number for each lane, to be written and read lane by lane.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(in crate::path) struct Row<T>(pub(in crate::path) [T; WIDEST]);

impl Row<f32> {
    pub(in crate::path) const ZERO: Self = Self([0.0; WIDEST]);

    /// The vector of a lane of three rows.
    #[inline(always)]
    pub(in crate::path) fn vector([x, y, z]: &[Self; 3], lane: usize) -> Vec3A {
        Vec3A::new(x.0[lane], y.0[lane], z.0[lane])
    }

    /// Sets the vector of a lane of three rows.
    #[inline(always)]
    pub(in crate::path) fn set_vector(rows: &mut [Self; 3], lane: usize, vector: Vec3A) {
        Self::set_numbers(rows, lane, vector.to_array());
    }

    /// The same as [`vector`](Self::vector), number by number.
    #[inline(always)]
    pub(in crate::path) fn numbers([x, y, z]: &[Self; 3], lane: usize) -> [f32; 3] {
        [x.0[lane], y.0[lane], z.0[lane]]
    }

    #[inline(always)]
    pub(in crate::path) fn set_numbers(rows: &mut [Self; 3], lane: usize, numbers: [f32; 3]) {
        for (row, number) in rows.iter_mut().zip(numbers) {
            row.0[lane] = number;
        }
    }
}

impl Row<u32> {
    pub(in crate::path) const ZERO: Self = Self([0; WIDEST]);

    /// The same number in all lanes.
    #[inline(always)]
    pub(in crate::path) fn splat(number: u32) -> Self {
        Self([number; WIDEST])
    }
}

/// A number a lane.
#[derive(Clone, Copy)]
pub(in crate::path) struct Real<S: Simd> {
    simd: S,
    lanes: S::f32s,
}

/// A truth value a lane.
#[derive(Clone, Copy)]
pub(in crate::path) struct Mask<S: Simd> {
    simd: S,
    lanes: S::m32s,
}

/// An index a lane.
#[derive(Clone, Copy)]
pub(in crate::path) struct Index<S: Simd> {
    lanes: S::u32s,
}

impl<S: Simd> Index<S> {
    #[inline(always)]
    pub(in crate::path) fn splat(simd: S, number: u32) -> Self {
        Self {
            lanes: simd.splat_u32s(number),
        }
    }

    /// Where it is as large as another.
    #[inline(always)]
    pub(in crate::path) fn ge(self, simd: S, other: u32) -> Mask<S> {
        Mask {
            simd,
            lanes: simd.greater_than_or_equal_u32s(self.lanes, simd.splat_u32s(other)),
        }
    }

    #[inline(always)]
    pub(in crate::path) fn load(_: S, row: &Row<u32>) -> Self {
        Self {
            lanes: S::as_simd_u32s(&row.0).0[0],
        }
    }

    /// The numbers, to be read lane by lane.
    #[inline(always)]
    pub(in crate::path) fn row(self) -> Row<u32> {
        let mut row = Row::<u32>::ZERO;
        self.store(&mut row);
        row
    }

    #[inline(always)]
    pub(in crate::path) fn store(self, row: &mut Row<u32>) {
        S::as_mut_simd_u32s(&mut row.0).0[0] = self.lanes;
    }
}

impl<S: Simd> Real<S> {
    #[inline(always)]
    pub(in crate::path) fn splat(simd: S, number: f32) -> Self {
        Self {
            simd,
            lanes: simd.splat_f32s(number),
        }
    }

    #[inline(always)]
    pub(in crate::path) fn load(simd: S, row: &Row<f32>) -> Self {
        Self {
            simd,
            lanes: S::as_simd_f32s(&row.0).0[0],
        }
    }

    /// As many of the first numbers as there are lanes.
    #[inline(always)]
    pub(in crate::path) fn first_of(simd: S, numbers: &[f32]) -> Self {
        Self {
            simd,
            lanes: S::as_simd_f32s(numbers).0[0],
        }
    }

    /// To the first numbers.
    #[inline(always)]
    pub(in crate::path) fn store_first(self, numbers: &mut [f32]) {
        S::as_mut_simd_f32s(numbers).0[0] = self.lanes;
    }

    #[inline(always)]
    pub(in crate::path) fn store(self, row: &mut Row<f32>) {
        S::as_mut_simd_f32s(&mut row.0).0[0] = self.lanes;
    }

    /// The numbers, to be read lane by lane.
    #[inline(always)]
    pub(in crate::path) fn row(self) -> Row<f32> {
        let mut row = Row::<f32>::ZERO;
        self.store(&mut row);
        row
    }

    #[inline(always)]
    fn make(self, lanes: S::f32s) -> Self {
        Self {
            simd: self.simd,
            lanes,
        }
    }

    #[inline(always)]
    fn mask(self, lanes: S::m32s) -> Mask<S> {
        Mask {
            simd: self.simd,
            lanes,
        }
    }

    #[inline(always)]
    pub(in crate::path) fn simd(self) -> S {
        self.simd
    }

    /// The same number in all lanes.
    #[inline(always)]
    pub(in crate::path) fn all(self, number: f32) -> Self {
        Self::splat(self.simd, number)
    }

    #[inline(always)]
    pub(in crate::path) fn abs(self) -> Self {
        self.make(self.simd.abs_f32s(self.lanes))
    }

    #[inline(always)]
    pub(in crate::path) fn sqrt(self) -> Self {
        self.make(self.simd.sqrt_f32s(self.lanes))
    }

    /// The size of this number with the sign of another.
    #[inline(always)]
    pub(in crate::path) fn copysign(self, sign: Self) -> Self {
        let simd = self.simd;
        let bit = simd.splat_f32s(-0.0);
        let size = simd.and_f32s(simd.not_f32s(bit), self.lanes);
        self.make(simd.or_f32s(size, simd.and_f32s(bit, sign.lanes)))
    }

    #[inline(always)]
    pub(in crate::path) fn lt(self, other: Self) -> Mask<S> {
        self.mask(self.simd.less_than_f32s(self.lanes, other.lanes))
    }

    #[inline(always)]
    pub(in crate::path) fn le(self, other: Self) -> Mask<S> {
        self.mask(self.simd.less_than_or_equal_f32s(self.lanes, other.lanes))
    }

    #[inline(always)]
    pub(in crate::path) fn gt(self, other: Self) -> Mask<S> {
        other.lt(self)
    }

    #[inline(always)]
    pub(in crate::path) fn ge(self, other: Self) -> Mask<S> {
        other.le(self)
    }

    #[inline(always)]
    pub(in crate::path) fn eq(self, other: Self) -> Mask<S> {
        self.mask(self.simd.equal_f32s(self.lanes, other.lanes))
    }

    /// The least number of all lanes, none of which is NaN.
    #[inline(always)]
    pub(in crate::path) fn least(self) -> f32 {
        self.simd.reduce_min_f32s(self.lanes)
    }

    /// The larger number; the other if this one is NaN.
    #[inline(always)]
    pub(in crate::path) fn max(self, other: Self) -> Self {
        if PICKS_OTHER && !S::IS_SCALAR {
            return self.make(self.simd.max_f32s(self.lanes, other.lanes));
        }
        self.gt(other).select(self, other)
    }

    /// The smaller number; the other if this one is NaN.
    #[inline(always)]
    pub(in crate::path) fn min(self, other: Self) -> Self {
        if PICKS_OTHER && !S::IS_SCALAR {
            return self.make(self.simd.min_f32s(self.lanes, other.lanes));
        }
        self.lt(other).select(self, other)
    }
}

impl<S: Simd> Mask<S> {
    /// `yes` where it holds, `no` elsewhere.
    #[inline(always)]
    pub(in crate::path) fn select(self, yes: Real<S>, no: Real<S>) -> Real<S> {
        yes.make(self.simd.select_f32s(self.lanes, yes.lanes, no.lanes))
    }

    /// `yes` where it holds, `no` elsewhere.
    #[inline(always)]
    pub(in crate::path) fn index(self, yes: Index<S>, no: Index<S>) -> Index<S> {
        Index {
            lanes: self.simd.select_u32s(self.lanes, yes.lanes, no.lanes),
        }
    }

    /// 1 where it holds, 0 elsewhere, to be read lane by lane.
    #[inline(always)]
    pub(in crate::path) fn row(self, simd: S) -> Row<f32> {
        let (yes, no) = (Real::splat(simd, 1.0), Real::splat(simd, 0.0));
        self.select(yes, no).row()
    }

    #[inline(always)]
    pub(in crate::path) fn simd(self) -> S {
        self.simd
    }

    /// Whether it holds in one lane, no more.
    #[inline(always)]
    pub(in crate::path) fn is_one(self) -> bool {
        let simd = self.simd;
        let ones = simd.select_f32s(self.lanes, simd.splat_f32s(1.0), simd.splat_f32s(0.0));
        simd.reduce_sum_f32s(ones) == 1.0
    }

    /// Whether it holds in any lane.
    #[inline(always)]
    pub(in crate::path) fn any(self) -> bool {
        self.simd.first_true_m32s(self.lanes) < S::F32_LANES
    }
}

#[cfg(target_arch = "x86_64")]
impl Real<pulp::x86::V3> {
    #[inline(always)]
    pub(in crate::path) fn of(simd: pulp::x86::V3, numbers: &[f32; 8]) -> Self {
        Self {
            simd,
            lanes: pulp::cast(*numbers),
        }
    }

    #[inline(always)]
    pub(in crate::path) fn eight(self) -> [f32; 8] {
        pulp::cast(self.lanes)
    }
}

#[cfg(target_arch = "x86_64")]
impl Mask<pulp::x86::V3> {
    /// A bit for each lane, the first the lowest.
    #[inline(always)]
    pub(in crate::path) fn bits(self) -> u32 {
        let bits = self.simd.avx._mm256_movemask_ps(pulp::cast(self.lanes));
        bits.cast_unsigned()
    }
}

impl<S: Simd> BitAnd for Mask<S> {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        let lanes = self.simd.and_m32s(self.lanes, other.lanes);
        Self { lanes, ..self }
    }
}

impl<S: Simd> BitOr for Mask<S> {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        let lanes = self.simd.or_m32s(self.lanes, other.lanes);
        Self { lanes, ..self }
    }
}

impl<S: Simd> Not for Mask<S> {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        let lanes = self.simd.not_m32s(self.lanes);
        Self { lanes, ..self }
    }
}

/// The operators between two numbers, and between one and the same number in all lanes.
macro_rules! operators {
    ($($operator:ident $method:ident $simd:ident),+ $(,)?) => {$(
        impl<S: Simd> $operator for Real<S> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.make(self.simd.$simd(self.lanes, other.lanes))
            }
        }

        impl<S: Simd> $operator<f32> for Real<S> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: f32) -> Self {
                self.$method(self.all(other))
            }
        }

        impl<S: Simd> $operator<Real<S>> for f32 {
            type Output = Real<S>;

            #[inline(always)]
            fn $method(self, other: Real<S>) -> Real<S> {
                other.all(self).$method(other)
            }
        }
    )+};
}

operators! {
    Add add add_f32s,
    Sub sub sub_f32s,
    Mul mul mul_f32s,
    Div div div_f32s,
}

impl<S: Simd> Neg for Real<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.make(self.simd.neg_f32s(self.lanes))
    }
}

#[cfg(test)]
mod tests {
    use pulp::{Arch, WithSimd};

    use super::*;

    /// The larger and the smaller of numbers of all kinds.
    struct Extremes;

    impl WithSimd for Extremes {
        type Output = ();

        fn with_simd<S: Simd>(self, simd: S) {
            let numbers = [
                f32::NAN,
                -0.0,
                0.0,
                1.0,
                -1.0,
                f32::INFINITY,
                -f32::INFINITY,
            ];
            let bits = |number: Real<S>| number.row().0.map(f32::to_bits);
            for (a, b) in numbers.iter().flat_map(|&a| numbers.map(|b| (a, b))) {
                let (first, second) = (Real::splat(simd, a), Real::splat(simd, b));
                let larger = first.gt(second).select(first, second);
                let smaller = first.lt(second).select(first, second);
                assert_eq!(bits(first.max(second)), bits(larger), "{a} {b}");
                assert_eq!(bits(first.min(second)), bits(smaller), "{a} {b}");
            }
        }
    }

    /// Lanes of which some are set.
    struct Set(u32);

    impl WithSimd for Set {
        type Output = ();

        fn with_simd<S: Simd>(self, simd: S) {
            let set = |lane: usize| self.0 >> lane & 1 == 1;
            let row = Row(core::array::from_fn(|lane| f32::from(u8::from(set(lane)))));
            let mask = Real::load(simd, &row).gt(Real::splat(simd, 0.0));
            let lanes = || 0..S::F32_LANES;
            let number = lanes().filter(|&lane| set(lane)).count();
            assert_eq!((mask.any(), mask.is_one()), (number > 0, number == 1));
            let numbers = Row([7.0, 3.0, 9.0, 1.0, 8.0, 2.0, 6.0, 5.0]
                .repeat(2)
                .try_into()
                .unwrap());
            let numbers = mask.select(Real::load(simd, &numbers), Real::splat(simd, f32::INFINITY));
            let least = numbers.row().0[lanes()]
                .iter()
                .copied()
                .fold(f32::INFINITY, f32::min);
            assert_eq!(numbers.least(), least);
        }
    }

    #[test]
    fn lanes_are_looked_at_together() {
        for lanes in 0..1 << WIDEST {
            Arch::new().dispatch(Set(lanes));
            Set(lanes).with_simd(pulp::Scalar);
            #[cfg(target_arch = "x86_64")]
            if let Some(simd) = pulp::x86::V3::try_new() {
                Set(lanes).with_simd(simd);
            }
        }
    }

    #[test]
    fn the_larger_of_two_is_the_other_where_neither_is_larger() {
        Arch::new().dispatch(Extremes);
        Extremes.with_simd(pulp::Scalar);
        #[cfg(target_arch = "x86_64")]
        if let Some(simd) = pulp::x86::V3::try_new() {
            Extremes.with_simd(simd);
        }
    }
}
